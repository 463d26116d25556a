# Vertices of OBJ, OFF and GLB files as points: files without faces are clouds for every verb, and
# of those with faces the vertices are read where they are asked for.
set -eu
# A square of 20 x 20 points at height 1, with colours and normals, as OBJ and as OFF.
awk 'BEGIN { for (i = 0; i < 400; i++) {
	printf "v %g %g 1 0.5 0.25 1\n", i % 20 / 8, int(i / 20) / 8 > "square.obj"
	print "vn 0 0 1" > "square.obj"
	printf "%g %g 1 0 0 1 128 64 255 255\n", i % 20 / 8, int(i / 20) / 8 > "rows" } }'
{ echo 'CNOFF'; echo '400 0 0'; cat rows; } >square.off
for format in obj off; do
	glowworm convert square.$format $format.csv
	glowworm bake square.$format -q --light 'point at 1,1,2 intensity 1' -o $format.ply
	glowworm convert $format.ply lit_$format.csv
done
cmp obj.csv off.csv
cmp lit_obj.csv lit_off.csv
head -n 3 obj.csv
# Straight below the lamp, in the middle of four points, E = 1 / 1.0078 and L = albedo E / pi; with
# all points on one plane nothing comes back. 64 of 255 is 0.0513 linear.
awk -F , 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
	$at["x"] == 1 && $at["y"] == 1 { print ($at["scalar_radiance_g"] > 0.0513 / 3.1416 * 0.99 &&
		$at["scalar_radiance_g"] < 0.0513 / 3.1416 * 1.01) ? "lit" : $0 }' lit_obj.csv

# A binary glTF file of two points with colours; y is up there, z here.
number() { # value: 0, 1 or 2 as float32
	case $1 in 0) printf '\000\000\000\000' ;; 1) printf '\000\000\200\077' ;;
	2) printf '\000\000\000\100' ;; esac
}
glb() { # mode
	json='{"asset":{"version":"2.0"},"meshes":[{"primitives":[{"mode":'$1',"attributes":'
	json=$json'{"POSITION":0,"COLOR_0":1}}]}],"accessors":[{"bufferView":0,"componentType":5126,'
	json=$json'"count":3,"type":"VEC3"},{"bufferView":1,"componentType":5126,"count":3,'
	json=$json'"type":"VEC3"}],"bufferViews":[{"buffer":0,"byteLength":36},{"buffer":0,'
	json=$json'"byteOffset":36,"byteLength":36}],"buffers":[{"byteLength":72}]}'
	while [ $((${#json} % 4)) -ne 0 ]; do json="$json "; done
	length=$((20 + ${#json} + 8 + 72))
	printf 'glTF\002\000\000\000'
	printf "\\$(printf %03o $((length % 256)))\\$(printf %03o $((length / 256)))\000\000"
	printf "\\$(printf %03o $((${#json} % 256)))\\$(printf %03o $((${#json} / 256)))\000\000"
	printf 'JSON%s' "$json"
	printf '\110\000\000\000BIN\000'
	for v in 0 1 2 2 0 1 1 1 0 0 1 1 1 0 0 1 1 1; do number $v; done
}
glb 0 >points.glb
glb 4 >triangle.glb
glb 1 >lines.glb
glowworm convert points.glb -  --output-format csv
glowworm info --stats triangle.glb 2>&1 | grep -E '^  (points|note)'
glowworm convert lines.glb - --output-format csv || echo $?

# Faces: bake samples them, --format or "mesh": false takes the vertices.
printf 'v 0 0 0 1 1 1\nv 1 0 0 1 1 1\nv 0 1 0 1 1 1\nvn 0 0 1\nf 1//1 2//1 3//1\n' >face.obj
count() { glowworm info "$1" | sed -n 's/^  points  *\([0-9]*\).*/\1/p'; }
count face.obj
glowworm info face.obj 2>&1 | grep note
lamp='point at 0.3,0.3,1 intensity 1'
glowworm bake face.obj -q --count 50 --light "$lamp" -o sampled.ply
glowworm bake face.obj -q --format obj --light "$lamp" -o vertices.ply 2>/dev/null
echo '{"version": 1, "inputs": [{"file": "face.obj", "mesh": false}]}' >scene.json
glowworm bake scene.json -q --light "$lamp" -o scene.ply 2>/dev/null
glowworm bake scene.json -q --light "$lamp" --print-scene | grep mesh
count sampled.ply
count vertices.ply
count scene.ply
# What is no such file, and what holds nothing.
printf 'f 1 2 3\n' >none.obj
glowworm info none.obj || echo $?
