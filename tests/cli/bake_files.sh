# File to file: the columns, in an order that no reader trips over; positions bit for bit; nothing
# is overwritten without --force; and a lit file lit again has the same columns and the same light.
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
. "$SOURCE/tests/cli/shared_functions"
lamp='point at 500000.2,4000000.6,13 intensity 5'
header() {
	sed '/^end_header/q' "$1"
}
# Bytes of a range of columns, point by point.
columns() { # file row first count
	tail -c +$(($(header "$1" | wc -c) + 1)) "$1" | od -A n -v -t u1 -w"$2" |
		awk -v f="$3" -v n="$4" '
		{ line = ""; for (i = f; i < f + n; i++) line = line " " $(i + 1); print line }'
}
make_cloud >a.ply
glowworm bake a.ply -q --light "$lamp" -o lit.ply --fields roi,direct,indirect,irradiance
header lit.ply | sed 's/EV [-0-9.]*$/EV/'
glowworm bake a.ply -q --light "$lamp" -o lit.ply
echo "exists: $?"
glowworm bake a.ply -q --light "$lamp" -o lit.ply --force && header lit.ply | grep -c '^property'
# A row: 3 doubles, 3 floats, 6 bytes, infrared, quality, 3 radiances. The 16 points are in order.
columns lit.ply 62 42 4 | awk '{ print $4 * 256 + $3 }' | tr '\n' ' '
echo
glowworm bake lit.ply -q --light "$lamp" -o again.ply
columns lit.ply 62 0 62 >one
columns again.ply 62 0 62 >other
cmp one other && echo "lit again: the same"
header again.ply | sed -n '/glowworm/s/EV [-0-9.]*$/EV/p;/^property/p'
# Positions are the doubles that 500000.123 and so on are.
columns lit.ply 62 0 8 | head -n 1
printf '\106\266\363\175\200\204\036\101' | od -A n -v -t u1 -w8 | sed 's/  */ /g'
# Colours that came in can stay, and a name that no format has is refused before the work.
glowworm bake a.ply -q --light "$lamp" --colors keep -o keep.ply
columns keep.ply 62 36 3 | head -n 1
glowworm bake a.ply -q --light "$lamp" -o lit.obj
echo "no such format: $?"
# 4 + 16 * 27 bytes; OpenVDB files begin with " BDV".
make_cloud | sed 's/^500000/1/; s/ 4000000/ 2/' >near.ply
glowworm bake near.ply -q --light 'sky radiance 1' --vdb near.vdb -o near.cloud
wc -c <near.cloud
head -c 4 near.vdb && echo
glowworm bake near.ply -q --light 'sky radiance 1' --vdb wide.vdb --vdb-voxel 0.5
head -c 4 wide.vdb && echo
glowworm bake near.ply -q --light 'sky radiance 1' --vdb no.vdb --vdb-voxel 0.01 2>&1
echo "finer than the bake: $?"
# Two inputs are one scene, with all points in order; names with odd characters are names.
cp a.ply "b c'd.ply"
glowworm bake a.ply "b c'd.ply" -q --light "$lamp" -o two.ply
header two.ply | grep -e vertex -e command
