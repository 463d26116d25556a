# A cloud that memory does not hold: some of its points are baked, and all are lit by these and
# written part by part, in the order of the file; the same bytes by any number of threads.
# sanitize: no
. "$SOURCE/tests/cli/shared_functions"
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
make_cave --points 200000 -o cave.ply
bake() { glowworm bake "$@" -f --rays 8 --light 'sky radiance 1' --strays keep; }
# Where nobody looks at the error that is stated.
quick() { bake "$@" --estimate-points 0; }
bake cave.ply --memory 181M --explain --report parted.json -o parted.ply >said.txt 2>&1
grep 'others make' said.txt | sed -E 's/[0-9.e-]+ m apart/D m apart/; s/[0-9]{4,}/N/g'
sed -nE 's/^came .* ([0-9]+) MB of the host.*/\1/p' said.txt |
	awk '{ print ($1 < 190) ? "below the limit" : $1 }'
grep -o '^ "points": [0-9]*' parted.json
awk -F'[:,]' '/^ "surface_points"/ { print ($2 > 20000 && $2 < 63000) ? "a part" : $2 }' parted.json
bake cave.ply -q -j 1 --memory 181M --explain -o one.ply 2>/dev/null
[ "$(body one.ply)" = "$(body parted.ply)" ] && echo "by one thread: the same"
# A transport keeps the points that were chosen, however much memory the next bake may take. What is
# foretold may add records, so that it is no part of this.
quick cave.ply -q --memory 181M -o parted.ply
quick cave.ply -q --memory 340M --save-transport kept -o saved.ply
quick cave.ply -q --transport kept -o again.ply
[ "$(body again.ply)" = "$(body saved.ply)" ] && echo "again: the same"
head -c 60 kept >short
bake cave.ply -q --transport short -o short-lit.ply 2>&1
# All points, in their order, with what they brought.
table() { glowworm convert "$1" - --output-format csv | cut -d, -f1-6,13-15 | tail -n +2 | md5sum; }
quick cave.ply -q --surface-points 20000 -o thin.ply
[ "$(table parted.ply)" = "$(table thin.ply)" ] &&
	echo "the points of the file, in its order"
# LAS is read in parts, too; what holds nothing, as withheld, is no column then either.
glowworm convert cave.ply cave.las
quick cave.las --memory 181M -o las.ply 2>&1 | grep -c 'others make'
places() { glowworm convert "$1" - --output-format csv | cut -d, -f1-3 | md5sum; }
[ "$(places cave.las)" = "$(places las.ply)" ] && echo "LAS: in its order"
grep -ac withheld las.ply
# The light is that of all points within what both state.
bake cave.ply -q --report all.json -o all.ply
off() { sed -nE 's/.*"luminance": *\{[^}]*"relrmse": *([0-9.e-]+).*/\1/p' "$1" | head -1; }
glowworm compare parted.ply all.ply --json off.json >/dev/null
stated() { sed -nE 's/.*"relative_rms": ([0-9.e-]+).*/\1/p' "$1" | head -1; }
echo "$(off off.json) $(stated parted.json) $(stated all.json)" |
	awk '{ print ($1 > 0 && $1 < 1.5 * sqrt($2 * $2 + $3 * $3)) ? "off as stated" : $0 }'
# What cannot be read twice, or needs all points at once, is read as it always was.
glowworm convert cave.ply cave.csv
head -15001 cave.csv >some.csv
quick some.csv -q --surface-points 6000 -o csv.ply
glowworm convert csv.ply - --output-format csv | awk "END { print NR - 1 }"
# A file that is cut short leaves nothing.
head -c 5000000 cave.ply >short.ply
bake short.ply --memory 181M -o short-lit.ply 2>&1 | sed 's/byte.*//'
[ -e short-lit.ply ] || echo "nothing written"
