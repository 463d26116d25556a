# A room without normals under a sky is lit on its outer sides. The bake says so, and where a lamp
# shows its inside; a picture of it is taken from there. With that lamp nothing is said, nor where
# the sky shines through a window, nor where a scanner stood inside. Points that all stand at one
# place make no picture.
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
make_room() { # 8 x 4 x 3 m, a point every 0.1 m, a window as wide as $1 in a wall
	awk -v half="$1" 'BEGIN {
		for (i = 0.05; i < 8; i += 0.1)
			for (j = 0.05; j < 4; j += 0.1) { print i, j, 0; print i, j, 3 }
		for (k = 0.05; k < 3; k += 0.1) {
			for (i = 0.05; i < 8; i += 0.1) { print i, 0, k; print i, 4, k }
			for (j = 0.05; j < 4; j += 0.1) {
				print 0, j, k
				if (j < 2 - half || j > 2 + half || k < 1 || k > 1 + 2 * half) print 8, j, k
			}
		}
	}'
}
make_room 0.6 >window.xyz
make_room 0 >room.xyz
bake() {
	glowworm bake "$@" --estimate-points 0 -f -o lit.ply 2>&1 | grep 'a lamp inside'
	glowworm render lit.ply --size 64x48 -f -o lit.png 2>&1 | grep -o 'the camera is [a-z]*'
}
echo 'sky:'
bake room.xyz --light 'sky radiance 1' | sed "s/at [-0-9.]*,[-0-9.]*,\([-0-9.]*\) /at X,Y,\1 /"
place=$(glowworm bake room.xyz --light 'sky radiance 1' --estimate-points 0 -f -o lit.ply 2>&1 |
	sed -n "s/.*--light '\(point at .* intensity 20\)'/\1/p")
echo 'lamp:'
bake room.xyz --light "$place"
echo 'window:'
bake window.xyz --light 'sky radiance 1'
echo 'scanner:'
bake room.xyz --light 'sky radiance 1' --scanner 4,2,1.5
echo 'one place:'
yes '1 2 3' | head -100 >place.xyz
glowworm render place.xyz -o place.png 2>&1
echo "exit $?"
