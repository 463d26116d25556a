# --progress=json: one object a line on standard error, shares that never fall, nothing else; and
# on a pipe --progress auto shows nothing.
glowworm info --devices >/dev/null 2>&1 || { echo "there is no Vulkan device"; exit 77; }
# 16 points, 4 x 4 on the floor of a georeferenced place, with a column of their own.
make_cloud() {
	printf 'ply\nformat ascii 1.0\ncomment made by hand\nelement vertex 16\n'
	printf 'property double %s\n' x y z
	printf 'property uchar %s\n' red green blue
	printf 'property float infrared\nend_header\n'
	awk 'BEGIN { for (i = 0; i < 16; i++) printf "%.3f %.3f %.3f %d %d %d %d\n",
		500000.123 + i % 4 * 0.1, 4000000.457 + int(i / 4) * 0.1, 12.25, 200, i * 16, 255 - i, i }'
}
lamp='point at 500000.2,4000000.6,13 intensity 5'
make_cloud >a.ply
glowworm bake a.ply -q --light "$lamp" -o a.out.ply --progress=json 2>log
number='[0-9]+\.[0-9]+'
known="\"stage\": \"[a-z ]+\", \"done\": $number, \"elapsed\": $number"
grep -vE "^\{$known(, \"remaining\": $number)?\}\$" log
sed -n '1s/, "elapsed.*//p;$s/, "elapsed.*//p' log
sed 's/.*"done": \([0-9.]*\).*/\1/' log | sort -c -g && echo rising
glowworm bake a.ply -q --light "$lamp" -o b.out.ply
# On a terminal there is a line that goes away, and binary data is not written to it.
script -qefc "glowworm bake a.ply --light '$lamp' -o c.out.ply" /dev/null >terminal
grep -c 'read' terminal
script -qefc "glowworm bake a.ply --light '$lamp' -o -" /dev/null | tr -d '\r'
