# LAZ and COPC out: the same columns as by way of LAS, by name, in a pipe and with one processor;
# lit, and lamps mixed.
make_points() {
	printf 'ply\nformat ascii 1.0\nelement vertex 400\nproperty double x\nproperty double y\n'
	printf 'property double z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n'
	printf 'property double gps_time\nproperty float moisture\nproperty short depth\nend_header\n'
	awk 'BEGIN { for (i = 0; i < 400; i++) printf "%.3f %.3f %.3f %d %d %d %.6f %.4f %d\n",
		500000.123 + i % 20 * 0.1, 7 + int(i / 20) * 0.1, 12.25 + 0.01 * (i % 3),
		i % 256, 128, 255 - i % 256, 1000 + i * 1e-5, i / 7, 200 - i }'
}
make_points >a.ply
glowworm convert a.ply a.las
glowworm convert a.ply a.laz
glowworm info a.laz | sed -n '/field  /,$p'
glowworm convert a.las las.csv && glowworm convert a.laz laz.csv && cmp las.csv laz.csv
[ $(wc -c <a.laz) -lt $(($(wc -c <a.las) / 2)) ] || echo "not smaller: $(wc -c <a.laz)"
# A pipe cannot be gone back in, and gets the same bytes.
glowworm convert a.ply - --output-format laz | cmp - a.laz
taskset -c 0 glowworm convert a.ply one.laz && cmp a.laz one.laz
glowworm convert a.laz again.laz && cmp a.laz again.laz
glowworm convert a.ply a.laz
echo "status $?"
head -c 1500 a.laz >cut.laz
glowworm info cut.laz 2>&1 | head -n 1 | cut -c 1-50
# COPC: the same points in another order.
make_cave --points 60000 -o cave.ply
glowworm convert cave.ply cave.laz && glowworm convert cave.ply cave.copc.laz
glowworm info cave.copc.laz | sed -n '2,3p'
glowworm convert cave.laz a.csv && glowworm convert cave.copc.laz b.csv
cmp -s a.csv b.csv && echo 'the order is as it was'
sort a.csv >a.sorted && sort b.csv | cmp - a.sorted
taskset -c 0 glowworm convert cave.ply one.copc.laz && cmp cave.copc.laz one.copc.laz
glowworm convert cave.ply - --output-format copc | cmp - cave.copc.laz
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
lamp='point name lamp at 500001,8,14 intensity 5'
glowworm bake a.ply -q --light "$lamp" --fields lights -o lit.laz
glowworm mix lit.laz -q --gain lamp=2 -o mixed.laz
glowworm info mixed.laz | grep -c scalar_light
glowworm bake a.ply -q --light "$lamp" -o lit.copc.laz
head -c 381 lit.copc.laz | tail -c 4
echo
# Light rounded to 11 bits: each value off by up to 2^-11 of itself, all other columns not at all.
# And to 8 bits, with coordinates on a coarser grid: off by half a step at most, beside the 1e-8 m
# to which the exact file has them, and normals by half of 1/2048, beside the seven digits of a
# table. Arguments: part of light, of a normal, of a coordinate, two tables. Says what is off, and
# what by too much.
off_by() {
	paste -d , "$4" "$5" | awk -F , -v light="$1" -v normal="$2" -v place="$3" '
	NR == 1 { for (i = 1; i <= NF / 2; i++) name[i] = $i; next }
	{ for (i = 1; i <= NF / 2; i++) { off = $i - $(i + NF / 2); size = $i < 0 ? -$i : $i
		off = off < 0 ? -off : off
		if (off == 0) continue
		changed[name[i]] = 1
		most = name[i] ~ /^[xyz]$/ ? place : name[i] ~ /^n[xyz]$/ ? normal : light * size
		if (off > most) print name[i] ": " $i " became " $(i + NF / 2) } }
	END { for (n in changed) print n }' | sort
}
glowworm bake a.ply -q --light "$lamp" --fields lights --las-radiance half -o half.laz
glowworm convert lit.laz lit.csv && glowworm convert half.laz half.csv
off_by 0.00048828125 0 0 lit.csv half.csv
make_cave --points 4000 -o small.ply
bake_small() {
	glowworm bake small.ply -q --light 'point name lamp at 3.4,0,1.9 intensity 40' \
		--fields lights "$@"
}
bake_small -o exact.laz
bake_small --las-radiance bfloat16 --las-step 0.0001 -o small.laz
glowworm convert exact.laz exact.csv && glowworm convert small.laz small.csv
off_by 0.00390625 0.00024419 0.00005001 exact.csv small.csv
bake_small --las-radiance bfloat16 --las-step 0.0001 -o small.copc.laz
glowworm convert small.copc.laz copc.csv && sort copc.csv >copc.sorted
sort small.csv | cmp - copc.sorted
glowworm convert exact.laz --las-radiance bfloat16 --las-step 0.0001 again.laz -f
glowworm convert again.laz again.csv && cmp small.csv again.csv
[ $(($(wc -c <small.laz) * 3)) -lt $(($(wc -c <exact.laz) * 2)) ] || echo 'not by a third smaller'
# Rounded lamps add up to the rounded radiance, but for that rounding; and points match by order.
for file in half.laz small.laz small.copc.laz; do
	glowworm mix $file -q -f --gain lamp=2 -o mixed.ply || echo "status $?: $file"
done
glowworm compare small.laz exact.laz | sed -n 1p
# In COPC's order by the grid on which the other's coordinates lie there.
bake_small -o small-lit.ply
glowworm compare small.copc.laz small-lit.ply | sed -n 1p
glowworm compare small-lit.ply small.copc.laz | sed -n 1p
# A grid that is coarser already stays, and is exact.
glowworm convert a.las --las-step 0.0001 -o kept.las && cmp a.las kept.las
glowworm convert a.las --las-step 0.002 -o coarse.las
echo "status $?"
glowworm convert lit.laz --las-radiance half -o other.laz
glowworm convert other.laz other.csv && cmp half.csv other.csv
[ $(wc -c <half.laz) -lt $(wc -c <lit.laz) ] || echo 'not smaller'
glowworm convert lit.laz --las-radiance half -o half.ply
echo "status $?"
glowworm convert lit.laz --las-step 0.0001 -o half.ply
echo "status $?"
