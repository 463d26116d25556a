# Glossy points: from a scene to columns to a picture; what the gloss takes is missing from nothing,
# so a room of one radiance looks the same with and without; light read from voxels; bad wishes.
. "$SOURCE/tests/cli/shared_functions"
make_box --scene cornell --points 3000 -o box.ply
cat >box.scene.json <<'END'
{"version": 1, "inputs": [{"file": "box.ply", "specular": 0.5, "roughness": 0.25}]}
END
run 0 bake box.scene.json -o lit.ply -q --rays 16 --estimate-points 0 --bounces 2
sed -n '/^property float \(specular\|roughness\)$/p; /^end_header$/q' lit.ply

# For what bounces, a black mirror is as good as white.
for surface in '"albedo": 0, "specular": 1' '"albedo": 1'; do
	echo "{\"version\": 1, \"inputs\": [{\"file\": \"box.ply\", $surface}]}" >some.scene.json
	run 0 bake some.scene.json -o some.ply -q --rays 16 --estimate-points 0 --bounces 2 --force
	[ -f first.ply ] || mv some.ply first.ply
done
run 0 compare first.ply some.ply --max-relrmse 0 >figures.txt

small='--size 64x48 --exposure 0 --samples 1'
# shellcheck disable=SC2086
for how in off rays cones caches; do
	run 0 render lit.ply -o $how.png $small --glossy $how
done
data() { # the pixels of a PNG, without what it says of itself
	tail -c +"$(($(grep -abo IDAT "$1" | head -n 1 | cut -d: -f1) + 1))" "$1" >"$1.data"
}
run 0 render lit.ply -o again.png $small --glossy rays -j 1
cmp rays.png again.png || echo "not the same picture again"
for how in off rays cones; do
	data $how.png
done
cmp -s off.png.data rays.png.data && echo "no gloss to be seen"
cmp -s rays.png.data cones.png.data && echo "no cones to be seen"
# Points of roughness 0.25 take rays, those of 0.5 do not; and an orbit by caches is the same for
# any number of threads, its first picture that of one alone.
data caches.png
cmp rays.png.data caches.png.data && echo "0.25 is too smooth for caches"
sed 's/0.25/0.5/' box.scene.json >rough.scene.json
run 0 bake rough.scene.json -o rough.ply -q --rays 16 --estimate-points 0 --bounces 2
around="$small --camera 'at 0,-3.4,1 to 0,0,1 fov 46'"
for threads in 1 2; do
	# shellcheck disable=SC2086
	eval run 0 render rough.ply -o orbit$threads.png -q $around --glossy caches -j $threads \
		--orbit 3
done
# shellcheck disable=SC2086
eval run 0 render rough.ply -o rough.png $around --glossy caches
# What they take is told.
# shellcheck disable=SC2086
eval run 0 render rough.ply -o told.png $around --glossy caches --profile |
	awk '/^(distribution|creation|evaluation|placed|pixels) / { print $1, ($2 > 0 ? "some" : $2) }'
# shellcheck disable=SC2086
eval run 0 render rough.ply -o rough-rays.png $around --glossy rays
# Of rays in the maps of probes some are served by none, and traced: the same for any number of
# threads.
for threads in 1 2; do
	# shellcheck disable=SC2086
	run 0 render lit.ply -o probes$threads.png -q $small --glossy probes --probe-size 16 \
		-j $threads --profile |
		awk '/^(looking|tracing|placed|rays|traced) / { print $1, ($2 > 0 ? "some" : $2) }'
	data probes$threads.png
done
cmp probes1.png.data probes2.png.data
for name in orbit1-0001 orbit1-0002 orbit1-0003 orbit2-0001 orbit2-0002 orbit2-0003 \
	rough rough-rays; do
	data $name.png
done
for picture in 1 2 3; do
	cmp orbit1-000$picture.png.data orbit2-000$picture.png.data
done
cmp orbit1-0001.png.data rough.png.data && echo "the first of an orbit"
cmp -s orbit1-0001.png.data orbit1-0002.png.data && echo "does not turn"
cmp -s rough.png.data rough-rays.png.data && echo "no caches to be seen"
for how in trilinear tricubic; do
	run 0 render lit.ply -o $how.png $small --glossy off --radiance $how
	data $how.png
	cmp -s off.png.data $how.png.data && echo "no voxels to be seen"
done

# A cube of radiance 0.5, white, two of its sides glossy; what rays see that slip out of it is 0.5,
# too.
awk 'BEGIN {
	print "ply\nformat ascii 1.0\nelement vertex 9600"
	n = split("x y z nx ny nz red green blue specular roughness scalar_radiance_r " \
		"scalar_radiance_g scalar_radiance_b", name, " ")
	for (i = 1; i <= n; i++) print "property float " name[i]
	print "end_header"
	for (i = 0; i < 9600; i++) {
		k = i % 3; s = int(i / 3) % 2 ? 1 : -1; j = int(i / 6)
		p[k] = s; p[(k + 1) % 3] = (j % 40 + 0.5) / 20 - 1
		p[(k + 2) % 3] = (int(j / 40) + 0.5) / 20 - 1
		m[k] = -s; m[(k + 1) % 3] = 0; m[(k + 2) % 3] = 0
		print p[0], p[1], p[2], m[0], m[1], m[2], 1, 1, 1, (k == 2) * 0.5, 0.3, 0.5, 0.5, 0.5
	}
}' >furnace.ply
view="--size 48x32 --samples 1 --exposure 0 --tone none"
camera='at 0.5,0.2,0.1 to -1,-0.3,-1 fov 90'
# shellcheck disable=SC2086
for how in off rays caches; do
	run 0 render furnace.ply -o furnace-$how.png $view --camera "$camera" --glossy $how \
		--light "sky radiance 0.5"
	data furnace-$how.png
done
cmp furnace-off.png.data furnace-rays.png.data && echo "the furnace is white"
cmp furnace-off.png.data furnace-caches.png.data && echo "by caches, too"
# An even map is as an even sky: 128.5 / 128 times 0.498 is 0.5. Other lamps are not reflected.
{
	printf '#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n'
	printf '\200\200\200\201\200\200\200\201'
} >even.hdr
# shellcheck disable=SC2086
run 0 render furnace.ply -o furnace-map.png $view --camera "$camera" \
	--light "sky map even.hdr radiance 0.49805447" --light 'point at 0,0,0 intensity 9'
data furnace-map.png
cmp furnace-rays.png.data furnace-map.png.data && echo "so it is under a map"
# A map with a red and a blue half is reflected as such: turned round it is the other way about.
halves() { # first, second half: exponents of red and blue
	printf '#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4\n'
	printf "$1$1$2$2$1$1$2$2"
}
red='\200\000\000\201' blue='\000\000\200\201'
halves "$red" "$blue" >red-blue.hdr
halves "$blue" "$red" >blue-red.hdr
awk 'BEGIN {
	print "ply\nformat ascii 1.0\nelement vertex 900"
	n = split("x y z nx ny nz specular roughness scalar_radiance_r scalar_radiance_g " \
		"scalar_radiance_b", name, " ")
	for (i = 1; i <= n; i++) print "property float " name[i]
	print "end_header"
	for (i = 0; i < 900; i++) print i % 30 * 0.1, int(i / 30) * 0.1, 0, 0, 0, 1, 1, 0, 0, 0, 0
}' >mirror.ply
for sky in 'map red-blue.hdr' 'map blue-red.hdr' 'map red-blue.hdr rotation 180' \
	'model clear from 90,40 illuminance 3'; do
	for how in rays cones; do
		# shellcheck disable=SC2086
		run 0 render mirror.ply -o sky.png -f $view --camera 'at 1.5,1.5,2 to 1.6,1.5,0 fov 70' \
			--glossy $how --light "sky $sky"
		data sky.png
		cksum <sky.png.data >>skies.txt
	done
done
awk '{ if (!($0 in seen)) seen[$0] = ++n; printf "%d ", seen[$0] }
	END { print "" }' skies.txt
# A map of one colour is reflected in it: as a sky of the radiance that its pixels stand for,
# (200.5, 0.5, 64.5) / 512.
{
	printf '#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n'
	printf '\310\000\100\177\310\000\100\177'
} >red.hdr
others=yes
case $GLOWWORM in
*sanitize*) others= ;; # skies of other colours differ in their numbers alone
esac
for how in rays cones probes; do
	for sky in 'map red.hdr' 'radiance 0.3916015625,0.0009765625,0.1259765625' \
		${others:+'radiance 0.1259765625,0.0009765625,0.3916015625' 'radiance 0.3916015625'}; do
		# shellcheck disable=SC2086
		run 0 render mirror.ply -o sky.png -f $view --glossy $how --light "sky $sky" \
			--camera 'at 1.5,1.5,2 to 1.6,1.5,0 fov 70'
		data sky.png
		[ "$sky" = 'map red.hdr' ] && mv sky.png.data red.data
		cmp -s red.data sky.png.data && echo "$how: as a sky of $sky"
	done
done

echo == bad wishes
run 2 render mirror.ply -o x.png --light 'sky map even.hdr' --light 'sky map red-blue.hdr'
run 66 render mirror.ply -o x.png --light 'sky map none.hdr'
run 2 render mirror.ply -o x.png --up x --light 'sky map even.hdr'
run 2 render lit.ply -o x.png --glossy maybe
run 2 render lit.ply -o x.png --glossy-rays 0
run 2 render lit.ply -o x.png --glossy probes --probe-size 48
run 2 render lit.ply -o x.png --radiance linear
run 69 render lit.ply -o x.png --device nothing-like-it 2>&1 | sed "s/; there are.*//"
run 65 render box.ply -o x.png --radiance tricubic
ls x.* 2>/dev/null
true
