# A cloud that is lit tile by tile: all points in their order, the light of a bake of all at once
# within what both state; the same bytes by ranks and when it was killed and goes on.
# sanitize: no
. "$SOURCE/tests/cli/shared_functions"
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
make_cave --points 30000 -o cave.ply
what='bake cave.ply --rays 16 --strays keep'
lamp='point at 3.4,0,1.9 intensity 40 name lamp'
bake() { glowworm $what --light "$lamp" "$@"; }
bake -q --report all.json -o all.ply
bake -v --tiles 3 --report tiled.json --fields lights -o tiled.ply 2>said.txt
grep -c "^glowworm: tile . of .: [0-9]* points, [0-9]* around them" said.txt |
	sed "s/^[3-9]$/several/"
grep -o 'tiles are lit one after the other' said.txt
ls tiled*
places() { glowworm convert "$1" - --output-format csv | cut -d, -f1-6 | md5sum; }
[ "$(places tiled.ply)" = "$(places all.ply)" ] && echo "the points of the file, in its order"
# Lamps alone add up, whatever tile a point is in.
glowworm mix tiled.ply -q --gain lamp=1 -o mixed.ply
glowworm compare mixed.ply tiled.ply --max-relrmse 0.001 >/dev/null && echo "lamps add up"
off() { sed -nE 's/.*"luminance": *\{[^}]*"relrmse": *([0-9.e-]+).*/\1/p' "$1" | head -1; }
stated() { sed -nE 's/.*"relative_rms": ([0-9.e-]+).*/\1/p' "$1" | head -1; }
glowworm compare tiled.ply all.ply --json off.json >/dev/null
echo "$(off off.json) $(stated tiled.json) $(stated all.json)" |
	awk '{ print ($1 > 0 && $1 < sqrt($2 * $2 + $3 * $3)) ? "off as stated" : $0 }'
bake --effects lamps --tiles 1 -o one.ply 2>&1 | grep -o '1 tile .*'
# Killed when a tile is done, and gone on with; by one thread, and where they can meet by two ranks.
alone='-j 1 --effects lamps --tiles 3'
bake -q $alone -o whole.ply
rm said.txt # or its last tiles are taken for those of the next bake
glowworm $what --light "$lamp" $alone --resume -v -o lit.ply 2>said.txt &
until grep -qs 'tile 2 of' said.txt || ! kill -0 $! 2>/dev/null; do sleep 0.01; done
kill -9 $! 2>/dev/null
wait $! 2>/dev/null || ls lit.ply*
# Nothing goes on from a file of tiles that has lost points; from the whole one it does.
cp lit.ply.tiles.part kept
truncate -s 1000 lit.ply.tiles.part
bake -q $alone --resume -o lit.ply 2>&1
cp kept lit.ply.tiles.part
bake $alone --resume -v -o lit.ply 2>said.txt
grep -q 'tile 1 of' said.txt && echo "the first tile is lit again"
[ "$(body lit.ply)" = "$(body whole.ply)" ] && ls lit.ply*
if command -v mpirun >/dev/null && [ -e "$(dirname "$GLOWWORM")/libglowworm-mpi.so" ]; then
	export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 TMPDIR=$PWD
	mpirun --oversubscribe --bind-to none -n 2 glowworm $what --light "$lamp" \
		-q $alone -o ranks.ply
	[ "$(body ranks.ply)" = "$(body whole.ply)" ] || echo "other bytes by two ranks"
	# What is packed in order is by the first of them.
	mpirun --oversubscribe --bind-to none -n 2 glowworm $what --light "$lamp" \
		-q $alone -o ranks.laz
	glowworm convert ranks.ply whole.laz
	cmp ranks.laz whole.laz || echo "other bytes by two ranks"
fi
# What takes all points at once.
run 2 bake cave.ply --light 'sky radiance 1' --tiles 3 -o lit.vdb.ply --vdb grids.vdb
run 2 bake cave.ply --light 'sky radiance 1' --tiles 3 -o -
run 2 bake cave.ply --light 'sky radiance 1' --tiles 3 --region 'box 0,0,0 1,1,1' -o region.ply
run 2 bake - --light 'sky radiance 1' --tiles 3 -o pipe.ply <cave.ply
run 2 bake cave.ply --light 'sky radiance 1' --tiles 3 --memory 250M -o small.ply
ls ./*.tiles* ./*.resume ./*.part 2>/dev/null
true
