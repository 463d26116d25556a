# Meshes in pictures: triangles instead of the points on them, from a mesh and from a scene with a
# mirrored one; faces without area; the same bytes for any number of threads; what cannot be drawn.
cp "$SOURCE/samples/cornell_cube.obj" .
printf '{"version": 1, "inputs": [{"file": "cornell_cube.obj", "matrix":\n' >mirror.json
printf '[-1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]}]}\n' >>mirror.json
cp "$SOURCE/samples/cornell.mtl" .
glowworm sample cornell_cube.obj --count 4000 -o cubes.ply
# Pictures without their comments, which hold the command.
pixels() { tail -c +"$(grep -abo IDAT "$1" | head -n 1 | cut -d: -f1)" "$1" | cksum; }
same() { [ "$(pixels "$1")" = "$(pixels "$2")" ] || echo "$1 and $2 differ"; }
small='--size 200x120 --camera outside --view normal --samples 1'
. "$SOURCE/tests/cli/shared_functions"
# shellcheck disable=SC2086
{
	run 0 render cubes.ply -o points.png $small
	run 0 render cubes.ply --mesh mirror.json -o one.png $small -j 1
	run 0 render cubes.ply --mesh mirror.json -o two.png $small -j 2
	cmp one.png two.png
	[ "$(pixels points.png)" = "$(pixels one.png)" ] && echo 'no triangle was drawn'
	# Faces without area, and a mesh without points on it, change nothing.
	printf 'v 0 0 9\nv 1 0 9\nv 2 0 9\nv 0 1 9\nf 1 2 3\nf 1 2 4\n' >far.obj
	run 0 render cubes.ply --mesh far.obj -o far.png $small
	same points.png far.png
	run 0 render cubes.ply --mesh cornell_cube.obj -o cube.png $small
	cat cornell_cube.obj >flat.obj
	printf 'f 1 1 2\nf 1 2 1\n' >>flat.obj
	run 0 render cubes.ply --mesh flat.obj -o flat.png $small
	same flat.png cube.png

	echo == bad wishes
	run 66 render cubes.ply --mesh missing.obj -o x.png
	run 65 render cubes.ply --mesh cubes.ply -o x.png
	printf '{"version": 1, "inputs": [{"file": "cubes.ply"}]}\n' >points.json
	run 65 render cubes.ply --mesh points.json -o x.png
	printf 'v 0 0 0\nf 1 1 1\n' >none.obj
	run 65 render cubes.ply --mesh none.obj -o x.png
	ls x.* 2>/dev/null
}
true
