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
glowworm bake a.ply -q --light "$lamp" --fields lights --las-radiance half -o half.laz
glowworm convert lit.laz lit.csv && glowworm convert half.laz half.csv
paste -d , lit.csv half.csv | awk -F , '
	NR == 1 { for (i = 1; i <= NF / 2; i++) name[i] = $i; next }
	{ for (i = 1; i <= NF / 2; i++) { off = $i - $(i + NF / 2); size = $i < 0 ? -$i : $i
		off = off < 0 ? -off : off
		if (off > 0) changed[name[i]] = 1
		if (off > size / 2048) print name[i] ": " $i " became " $(i + NF / 2) } }
	END { for (n in changed) print n }' | sort
glowworm convert lit.laz --las-radiance half -o other.laz
glowworm convert other.laz other.csv && cmp half.csv other.csv
[ $(wc -c <half.laz) -lt $(wc -c <lit.laz) ] || echo 'not smaller'
glowworm convert lit.laz --las-radiance half -o half.ply
echo "status $?"
