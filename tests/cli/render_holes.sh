# Where no points are amid the points, a black background looks like shadow, and that is said; not
# of other backgrounds, of a gap that is open to the side, or of what is no light.
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
. "$SOURCE/tests/cli/shared_functions"
make_floor() { # awk's condition for what is missing, of x and y from 0 to 59
	awk "BEGIN { for (y = 0; y < 60; y++) for (x = 0; x < 60; x++)
		if (!($1)) print x, y, 0, 0, 0, 1 }" >floor.txt
	printf 'ply\nformat ascii 1.0\nelement vertex %d\n' "$(wc -l <floor.txt)"
	printf 'property float %s\n' x y z nx ny nz
	echo end_header
	cat floor.txt
}
above='at 29.5,29.5,90 to 29.5,30,0 fov 45'
see() { # options...
	run 0 render lit.ply --camera "$above" --size 200x200 -o seen.png --force "$@"
}
make_floor 'x > 19 && x < 39 && y > 19 && y < 39' >hole.ply
make_floor 'x > 19 && x < 39 && y > 19' >bay.ply
run 0 bake hole.ply -q --light 'sky radiance 1' -o lit.ply
see
see --background 0.3
see --background none
see --view depth
run 0 bake bay.ply -q --light 'sky radiance 1' -o lit.ply --force
see
