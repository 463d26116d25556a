# sample: points of a mesh, as many as asked for, evenly; from files, pipes and scenes; errors.
glowworm sample "$SOURCE/samples/cornell.obj" --density 1000 -v -o a.ply 2>&1 | sed 's|/.*/||'
# Points, bounds and columns; positions of 20 m^2 + lamp.
glowworm info --stats a.ply | grep -E '^  (format|points|bounds   |normals|red|emission_r|specular)'
# The density of each wall: 4 m^2 and 1000 points/m^2, to less than 2 points, which is 0.05 %.
header=$(sed '/^end_header$/q' a.ply | wc -c)
tail -c +$((header + 1)) a.ply | od -A n -v -t u1 -w39 | awk '
	{ wall[$25 " " $26 " " $27 " " ($30 + $31 > 0 ? "lamp" : "wall")]++ }
	END { for (w in wall) { share = w ~ /lamp/ ? 250 : w ~ /^225/ ? 11750 : 4000
		print w, (wall[w] > share - 2 && wall[w] < share + 2) ? "even" : wall[w] } }' | sort
# The same bytes for the same seed and any number of threads, and through pipes.
cube=$SOURCE/samples/cornell_cube.obj
sample() { glowworm sample --count 3000 "$@"; }
points() { tail -c 81000 "$1" | cksum; }
sample "$cube" -o one.ply -j 1
sample "$cube" -o - -j 5 >two.ply
sample "$cube" -o seed.ply --seed 1
[ "$(points one.ply)" = "$(points two.ply)" ] || echo "threads matter"
[ "$(points one.ply)" = "$(points seed.ply)" ] && echo "the seed does not matter"
# Without its folder the pipe lacks the materials.
sample - -o pipe.ply <"$cube" 2>&1
glowworm info --stats pipe.ply | grep albedo
# What cannot be sampled.
refuse() { # status arguments...
	expected=$1
	shift
	glowworm sample "$@" 2>&1
	status=$?
	[ $status -eq "$expected" ] || echo "status $status, expected $expected: $*"
}
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n' >index.obj
printf 'v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n' >flat.obj
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 2\nf 1 2\nusemtl gone\nf 1 2 3\n' >notes.obj
printf 'mtllib bad.mtl\nv 0 0 0\n' >material.obj
printf 'newmtl a\nKd 1 2 3\n' >bad.mtl
: >empty.obj
refuse 65 index.obj -o out.ply
refuse 65 flat.obj -o out.ply
refuse 65 empty.obj -o out.ply
refuse 65 material.obj -o out.ply
refuse 65 a.ply -o out.ply
refuse 65 notes.obj --density 0.1 -o out.ply
refuse 66 missing.obj -o out.ply
refuse 73 notes.obj -o missing/out.ply
refuse 2 notes.obj
refuse 2 notes.obj -o out.xyz.gz
refuse 2 -o out.ply
refuse 2 notes.obj --density 0 -o out.ply
refuse 2 notes.obj --density 5 --count 5 -o out.ply
refuse 71 notes.obj --density 9e11 -o out.ply
refuse 0 notes.obj --count 10 -o out.ply
# Points are what info is about: of a mesh, its vertices.
glowworm info notes.obj 2>&1 || echo $?
ls
# A binary glTF file, by its content and by its name: a triangle, y up, emitting.
json='{"asset":{"version":"2.0"},"meshes":[{"primitives":[{"attributes":{"POSITION":0},'
json=$json'"material":0}]}],"materials":[{"emissiveFactor":[1,0,1]}],"accessors":[{"bufferView":0,'
json=$json'"componentType":5126,"count":3,"type":"VEC3"}],"bufferViews":[{"buffer":0,'
json=$json'"byteLength":36}],"buffers":[{"byteLength":36}]}  '
{
	printf 'glTF\2\0\0\0\144\1\0\0\44\1\0\0JSON%s' "$json"
	printf '\44\0\0\0BIN\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\200\77\0\0\0\0\0\0\0\0'
	printf '\0\0\0\0\0\0\200\77\0\0\0\0'
} >triangle.glb
glowworm sample triangle.glb --count 100 -o triangle.ply
glowworm info --stats triangle.ply | grep -E '^  (points|bounds  |normals|emission)'
glowworm info triangle.glb 2>&1 || echo $?
