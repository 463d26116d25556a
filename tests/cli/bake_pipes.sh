# Pipe to pipe: the same bytes as through files and for any number of threads; a closed pipe and a
# full disk end with status 74 and leave nothing behind.
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
body() {
	sed '/^comment glowworm command/d' "$1" | cksum
}
make_cloud >a.ply
glowworm bake a.ply -q --light "$lamp" -o file.ply --threads 1
glowworm bake - -q --light "$lamp" -o - --threads 3 <a.ply | cat >pipe.ply
[ "$(body file.ply)" = "$(body pipe.ply)" ] && echo same
glowworm bake a.ply -q --light "$lamp" -o - | glowworm info - --json | tr ',' '\n' |
	grep -e '"file"' -e '"points"'
glowworm bake a.ply -q --light "$lamp" -o /dev/full
echo "full disk: $?"
glowworm bake a.ply -q --light "$lamp" -o out.ply --report /dev/full
echo "full disk for the report: $?"
glowworm info a.ply >/dev/full
echo "full disk for info: $?"
{ glowworm bake a.ply -q --light "$lamp" -o -; echo "closed pipe: $?" >&2; } | true
{ glowworm bake a.ply -q --light "$lamp" -o - >&-; echo "closed output: $?" >&2; }
(ulimit -f 1; glowworm bake a.ply a.ply -q --light "$lamp" -o limit.ply)
echo "file size limit: $?"
