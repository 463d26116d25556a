# Pipe to pipe: the same bytes as through files and for any number of threads; a closed pipe and a
# full disk end with status 74 and leave nothing behind.
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
. "$SOURCE/tests/cli/shared_functions"
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
(ulimit -S -f 1; glowworm bake a.ply a.ply -q --light "$lamp" -o limit.ply)
echo "file size limit: $?"
