# Meshes among the inputs of a scene: as dense as the scan, moved before they are sampled, with
# light and shadow like everything else.
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
# A floor of 2 m, 41 x 41 points 5 cm apart: 400 points a square metre.
{
	printf 'ply\nformat ascii 1.0\nelement vertex 1681\n'
	printf 'property float %s\n' x y z nx ny nz
	echo end_header
	awk 'BEGIN { for (i = 0; i < 1681; i++) print i % 41 * 0.05, int(i / 41) * 0.05, 0, 0, 0, 1 }'
} >floor.ply
printf 'v 0 0 0\nv 0 1 0\nv 1 1 0\nv 1 0 0\nf 1 2 3 4\n' >square.obj
# The same square, mirrored back by its matrix, 3 m a side at a height of 1 m: 9 m^2.
cat >scene.json <<'END'
{"version": 1,
 "inputs": [{"file": "floor.ply", "albedo": 0.5},
            {"file": "square.obj", "albedo": 0.25,
             "matrix": [3,0,0,0, 0,3,0,0, 0,0,-1,1, 0,0,0,1]}],
 "lights": [{"type": "point", "position": [1, 1, 3], "intensity": 40}],
 "bake": {"bounces": 1}}
END
glowworm bake scene.json -o lit.ply --report report.json
points() { sed -n 's/.*"points": \([0-9]*\).*/\1/p' report.json; }
# The scan's median density is that of its inside, 400, as far as the estimate by neighbours goes.
points | awk 'NR == 3 { print NR, ($1 > 0.9 * 3600 && $1 < 1.1 * 3600) ? "as dense" : $1 }'
# Mirrored, the square faces up: 40 / 2^2 * 0.25 / pi = 0.79577 below the light, less what a place
# beside it is off by, at most one spacing of 0.05: (1 + 0.05^2 / 2^2)^-1.5 = 0.999. The floor,
# under it, is dark.
glowworm info lit.ply | awk '$1 == "scalar_radiance_r" {
	print $3, ($4 > 0.999 * 0.79577 && $4 < 1.00001 * 0.79577) ? "as the closed form" : $4 }'
# With a density of its own, and one for all.
sed 's/"albedo": 0.25/"albedo": 0.25, "density": 100/' scene.json >own.json
glowworm bake own.json -f -o lit.ply --report report.json
points | sed -n 3p
glowworm bake scene.json --density 50 -q -f -o lit.ply --report report.json
points | sed -n 3p
# Faces of a PLY file count when the scene says so.
cat >mesh.ply <<'END'
ply
format ascii 1.0
element vertex 4
property float x
property float y
property float z
element face 1
property list uchar int vertex_indices
end_header
0 0 0
1 0 0
1 1 0
0 1 0
4 0 1 2 3
END
echo '{"version": 1, "inputs": [{"file": "mesh.ply", "mesh": true, "emission": 2}]}' >ply.json
glowworm bake ply.json --count 500 --bounces 0 -f -o lit.ply 2>/dev/null
glowworm info lit.ply | grep -E '^  (points|scalar_radiance_r)'
glowworm bake ply.json --print-scene | grep mesh
# The albedo of a scan may come from its intensity; the mesh, black here, keeps its own.
printf 'newmtl soot\nKd 0 0 0\nKe 1 1 1\n' >soot.mtl
{ printf 'mtllib soot.mtl\nusemtl soot\n'; cat square.obj; } >soot.obj
sed -e 's/property float nz/&\nproperty float intensity/' -e '/^[0-9]/s/$/ 7/' floor.ply >bright.ply
sed 's/floor.ply", "albedo": 0.5/bright.ply"/; s/square.obj", "albedo": 0.25/soot.obj"/' \
	scene.json >mixed.json
glowworm bake mixed.json --albedo intensity --bounces 0 -q -f -o lit.ply
glowworm info lit.ply | awk '$1 == "albedo_r" || $1 == "scalar_radiance_r" { print $1, $3, $4 }'
# The sample scenes: inputs with as many points as their areas have shares of 20 m^2 + 2.16 m^2.
glowworm bake "$SOURCE/samples/cornell.scene.json" --count 2216 --bounces 0 -o - \
	--report cornell.json >cornell.ply
sed -n 's/.*"points": \([0-9]*\).*/\1/p' cornell.json | sed -n 2,3p
glowworm info cornell.ply | awk '$1 == "scalar_radiance_r" { print $3, $4 }'
# What makes no sense.
refuse() {
	glowworm bake bad.json --light 'sky radiance 1' -f -o lit.ply
	[ $? -eq 65 ] || echo "accepted"
}
{
	echo '{"version": 1, "inputs": [{"file": "floor.ply", "density": 5}]}' >bad.json
	refuse
	echo '{"version": 1, "inputs": [{"file": "mesh.ply", "mesh": 1}]}' >bad.json
	refuse
	echo '{"version": 1, "inputs": [{"file": "square.obj", "density": 0}]}' >bad.json
	refuse
	sed 's/3,0,0,0, 0,3,0,0/3,6,0,0, 0.1,0.2,0,0/' scene.json >bad.json
	refuse
	echo '{"version": 1, "inputs": [{"file": "floor.ply", "mesh": true}]}' >bad.json
	refuse
} 2>&1
