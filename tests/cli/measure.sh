# Light on a piece of surface: a lamp over a floor, by the closed form; the same however densely its
# halves were scanned; shares of lamps; and sentences for what can't be measured.
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
# 2 x 2 m, the right half four times as dense as the left one.
{
	printf 'ply\nformat ascii 1.0\nelement vertex 2000\nproperty float x\nproperty float y\n'
	printf 'property float z\nproperty float nx\nproperty float ny\nproperty float nz\nend_header\n'
	awk 'BEGIN {
		for (i = 0; i < 400; i++)
			print (i % 10 + .5) * .1 - 1, (int(i / 10) + .5) * .05 - 1, 0, 0, 0, 1
		for (i = 0; i < 1600; i++)
			print (i % 40 + .5) * .025, (int(i / 40) + .5) * .05 - 1, 0, 0, 0, 1
	}'
} >floor.ply
glowworm bake floor.ply -q --albedo constant:0.5 --bounces 1 --fields illuminance,lights \
	-o lit.ply \
	--light 'point name high at 0,0,2 intensity 300cd group visitors' \
	--light 'point name low at 0,0,-2 intensity 300cd' \
	--light 'point name far at 0,0,4 intensity 400cd group visitors'
# Below the lamps 300 / 4 + 400 / 16 = 100 lx, and 62.67 at the point that is farthest from them:
# 300 * 2 / 5.926^1.5 + 400 * 4 / 17.926^1.5.
figure() { sed -n "s/ *\"$1\": \([0-9.]*\).*/\1/p"; }
glowworm measure lit.ply --json >all.json
for figure in most least mean least_over_mean; do
	printf '%s ' "$figure"
	figure $figure <all.json | awk '{ printf "%.2f\n", $1 }'
done
# The denser half has the same mean as the other, and both that of the whole, to half a percent:
# areas of points on the rims are off by as much of their spacing.
for box in -2,-2,-1,0,2,1 0,-2,-1,2,2,1; do
	glowworm measure lit.ply --box=$box --json | figure mean
done | awk 'NR == 1 { one = $1 } END { r = one / $1; print (r > 0.995 && r < 1.005) ? "even" : r }'
glowworm measure lit.ply --path '0,0,0 0.2,0,0' --reach 0.1 |
	sed -E 's/(mean|least|most) +([0-9]+)\..*/\1 \2/; s/, [0-9]+ points on .*//; s/ +/ /g'
glowworm convert lit.ply plain.csv --output-format csv && glowworm convert floor.ply dark.ply
for bad in '--box 1,2,3' '--box 1,2,3,4,5,x' '--path 1,2' '--path=' '--box 9,9,9,10,10,10' \
	'--reach=-1'; do
	glowworm measure lit.ply $bad 2>&1
	echo "exit $?"
done
glowworm measure dark.ply 2>&1
echo "exit $?"
glowworm measure 2>&1
echo "exit $?"
glowworm measure lit.ply --path 0,0,0 0.2,0,0 2>&1
echo "exit $?"
