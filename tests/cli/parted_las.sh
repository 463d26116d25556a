# A cloud that memory does not hold goes to LAS, LAZ, E57, PCD and .cloud part by part: the bytes
# that the PLY of the same bake becomes at once, by any number of threads, in tiles too, and mixed
# part by part.
# sanitize: no
. "$SOURCE/tests/cli/shared_functions"
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
make_cave --points 90000 -o cave.ply
glowworm convert cave.ply cave.laz
lamp='point at 3.4,0,1.9 intensity 40 name lamp'
bake() { bake_all "$@" --memory 150M; }
bake_all() { glowworm bake "$@" --strays keep --effects lamps --light "$lamp"; }
# Floats, which LAS has no grid for but a fine one; and what was LAZ, whose grid it keeps.
for input in cave.ply cave.laz; do
	bake $input -q -f -o lit.ply
	for output in las laz e57 pcd cloud; do
		bake $input -f -o lit.$output 2>&1 | grep -c 'others make'
		glowworm convert -f lit.ply whole.$output
		cmp lit.$output whole.$output && echo "$input to $output: the same"
	done
done
bake cave.laz -q -j 1 -o one.laz && cmp one.laz lit.laz
bake cave.laz -q --resume -o resumed.las && cmp resumed.las lit.las
# Places in LAZ are not known before; of tiles they need not be.
run 2 bake cave.laz --strays keep --memory 150M --light "$lamp" --resume -o resumed.laz
make_cave --points 30000 -o small.ply
for output in ply laz e57 pcd cloud; do
	bake_all small.ply -q -j 1 --tiles 3 --rays 16 --resume -o tiled.$output
done
for output in laz e57 pcd cloud; do
	glowworm convert tiled.ply whole-tiled.$output
	cmp tiled.$output whole-tiled.$output && echo "tiles to $output: the same"
done
# To a pipe LAZ is written at once.
bake cave.laz -q -o - --output-format laz | glowworm info - | grep -c 90000
# As half floats, which is known of each part.
bake cave.laz -q --las-radiance half -o half.laz
[ "$(stat -c %s half.laz)" -lt "$(stat -c %s lit.laz)" ] && echo "half: less"
# Rounded in all ways: the grid is known of each part, too.
small() { "$@" --las-radiance bfloat16 --las-step 0.0001; }
small bake cave.laz -q -o small.laz
small glowworm convert lit.ply -o whole-small.laz
cmp small.laz whole-small.laz && echo "rounded: the same"
small bake_all small.ply -q -j 1 --tiles 3 --rays 16 -o tiled-small.laz
small glowworm convert tiled.ply -o whole-tiled-small.laz
cmp tiled-small.laz whole-tiled-small.laz && echo "rounded tiles: the same"
ls ./*.part ./*.resume ./*.tiles* 2>/dev/null
true
