# --progress=json: one object a line on standard error, shares that never fall, nothing else; and
# on a pipe --progress auto shows nothing.
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
. "$SOURCE/tests/cli/shared_functions"
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
