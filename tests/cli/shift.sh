# Coordinates of a map as floats (--shift): what the header says, what reading again gives, what
# else writes them, and what is refused.
. "$SOURCE/tests/cli/shared_functions"
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
head_of() { LC_ALL=C sed '/^end_header/q' "$1" | grep -aE 'Global|property [a-z]* [xyz]$'; }
awk 'BEGIN { print "x y z red green blue index"
	for (i = 0; i < 400; i++)
		printf "%.3f %.3f %.3f 128 128 128 %d\n", 500123.4 + i % 20 / 10,
			4000600.7 + int(i / 20) / 10, 1234.5, i }' >map.txt

# Rounded to a kilometre; the height needs none.
glowworm convert map.txt map.ply --shift auto
head_of map.ply
# Read again, to half of the distance between floats below 1024 and 2048: 3e-5 and 6e-5.
glowworm convert -q map.ply again.xyz
grep '^[0-9]' again.xyz | awk 'BEGIN { getline <"map.txt" } {
	getline line <"map.txt"; split(line, a)
	for (k = 1; k <= 3; k++) if ((a[k] - $k) ^ 2 > 6.2e-5 ^ 2) bad++ }
	END { print NR " points, " bad + 0 " off" }'
glowworm info map.ply | sed -n '/bounds/,/note/p'
# By hand, and back to doubles without it.
glowworm convert map.ply hand.ply --shift 500000,4000600.5,-1e3 2>/dev/null
head_of hand.ply
glowworm convert -q hand.ply whole.ply
head_of whole.ply
# Bake, mix and albedo; the lamp stands in the map's coordinates, and so does the scanner.
lamp='point at 500124,4000601,1236 intensity 20 name lamp'
glowworm bake map.txt --light "$lamp" --scanner 500124,4000601,1236 --fields lights \
	--estimate-points 0 -q -o plain.ply
glowworm bake map.ply --light "$lamp" --scanner 500124,4000601,1236 --fields lights \
	--estimate-points 0 -q --shift auto -o lit.ply
head_of lit.ply
for cloud in plain lit; do
	glowworm info $cloud.ply | grep -E 'scanner|bounds'
done
# Light goes by the square of the distance, of which 6e-5 of a metre are 1.2e-4; the rest is
# roundings.
glowworm compare lit.ply plain.ply --max-relrmse 0.001 >/dev/null || echo "other light"
glowworm mix lit.ply --gain lamp=2 --shift auto -o mixed.ply 2>notes
grep -o 'less [-0-9,]*' notes
head_of mixed.ply
glowworm mix lit.ply --gain lamp=2 -q -o mixed_whole.ply
head_of mixed_whole.ply
glowworm albedo map.txt --capture overcast --shift 500000,4000000,0 -q -o albedo.ply
head_of albedo.ply
# Clouds that need none keep their columns; whoever writes doubles has added the shift.
make_cloud | sed 's/500000/5/; s/4000000/40/' >near.ply
glowworm convert near.ply near_again.ply --shift auto
head_of near_again.ply
sed 's/^comment made by hand/comment Global Shift: -7 0 0/' near.ply >double.ply
glowworm info double.ply | grep -E 'bounds|note'
sed 's/double x/float x/; s/double y/float y/; s/double z/float z/' double.ply >float.ply
glowworm info float.ply | grep -E 'bounds|note'
sed 's/Shift: -7 0 0/Shift: -7 0 nan/' float.ply >nan.ply
glowworm info nan.ply | grep -E 'bounds|note'
# Refused.
glowworm convert map.txt map.las --shift auto 2>&1 || echo $?
glowworm convert map.txt map.csv --shift auto 2>&1 || echo $?
glowworm convert map.txt other.ply --shift 1,2 2>&1 || echo $?
echo "1e300 0 0" | glowworm convert - far.ply --columns x,y,z --shift 0,0,0 2>&1 || echo $?
echo "1 0 0" | glowworm convert - far.ply --columns x,y,z --shift 1e300,0,0 -q 2>&1 || echo $?
ls other.ply far.ply 2>/dev/null
:
