# What is repaired or taken for granted is said: points without a place, missing colours; --quiet
# says nothing. Points keep their number and order.
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
{
	printf 'ply\nformat ascii 1.0\nelement vertex 12\n'
	printf 'property float %s\n' x y z
	echo end_header
	awk 'BEGIN { for (i = 0; i < 9; i++) print i % 3 * 0.1, int(i / 3) * 0.1, 0 }'
	printf '%s\n' 'nan 0 0' '0 inf 0' '0 0 -inf'
} >a.ply
glowworm bake a.ply --light 'sky radiance 1' -o lit.ply 2>notes
grep albedo notes
grep 'finite' notes
glowworm info lit.ply --json | tr '{' '\n' | grep '"x"\|radiance_r' |
	sed 's/0\.5000000[0-9]*/0.5/' # the last bit of a float
glowworm bake a.ply --light 'sky radiance 1' -o quiet.ply --quiet
# A wall that is lit alike from either side: nothing is wrong, whichever is the right one.
awk 'BEGIN { for (i = 0; i < 324; i++) print i % 18 * 0.1, 0, int(i / 18) * 0.1 }' >wall.xyz
glowworm bake wall.xyz --light 'sky radiance 1' -f -o lit.ply 2>&1 |
	sed -n 's/\(estimated error: 0\.0000\)[^%]*%.* of the mean.*/\1/p'
# A row of points, which have no sides: none tells how wrong that is.
awk 'BEGIN { for (i = 0; i < 30; i++) print i, 0, 0 }' >row.xyz
glowworm bake row.xyz --light 'sky radiance 1' -f -o lit.ply 2>&1 | grep 'how wrong'
# Numbers without units beside some that have them, unless the scene file says what all are in.
glowworm bake a.ply --light 'point at 0.1,0.1,1 intensity 40cd' --light 'sky radiance 1' -f \
	-o lit.ply 2>&1 | grep units
printf '{"version": 1, "units": "photometric", "inputs": [{"file": "a.ply"}], "lights": [
	{"type": "point", "position": [0.1, 0.1, 1], "lumens": 400},
	{"type": "environment", "radiance": 1}]}' >units.json
glowworm bake units.json -f -o lit.ply 2>&1 | grep units
# An octree for which memory is too short is made coarser, and note and report say so.
make_box --scene plane --points 20000 -o plane.ply
for memory in 1G 6M; do
	glowworm bake plane.ply --albedo constant:0 --light 'point at 0.5,0.5,1 intensity 1' \
		--memory "$memory" --report "$memory.json" -o "$memory.ply" 2>notes
	sed -n 's/.*note: the octree was made coarser, .* in place of .* m: ".*" needs .*/coarser/p' \
		notes
	grep -o "memory is less than the program takes .*" notes
	grep -o '"wanted_leaf_size": 0\.0\|"why_coarser": ' "$memory.json"
done
# So does who begins with the transport of such a bake.
lamp='point at 0.5,0.5,1 intensity 1'
glowworm bake plane.ply --albedo constant:0 --light "$lamp" --memory 28M --leaf-spacing 0.3 \
	--save-transport coarse.gwt -o first.ply -q --estimate-points 0
glowworm bake plane.ply --albedo constant:0 --leaf-spacing 0.3 --transport coarse.gwt -o again.ply \
	--light "$lamp" --estimate-points 0 2>notes
sed -n 's/.*note: the octree was made coarser, .* in place of .* m: ".*" needs .*/coarser/p' notes
# What is counted is said of one as of one: a point of each sort, and a triangle of a mesh.
{
	printf 'x,y,z,nx,ny,nz,red,green,blue\n'
	awk 'BEGIN { for (i = 0; i < 100; i++) print i % 10 "," int(i / 10) ",0,0,0,1,90,90,90" }'
	echo '4,4,0,0,0,1,90,90,90'
	echo 'nan,0,0,0,0,1,90,90,90'
	echo '4.5,4.5,0,0,0,0,0,0,0'
} >one.csv
glowworm bake one.csv --light 'sky radiance 1' --estimate-points 0 -o one.ply 2>&1 |
	grep -o 'of all points.*'
glowworm bake one.csv --light 'sky radiance 1' --estimate-points 0 --albedo constant:0.5 \
	--normals given -o ones.ply --report one.json 2>/dev/null
grep -o '"meaning": "point [^"]*"' one.json
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 2\n' >one.obj
glowworm sample one.obj --count 10 -o mesh.ply 2>&1 | sed -n 's/.*: \(1 of .*\)/\1/p'
