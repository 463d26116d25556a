# Several files that memory does not hold, of formats that have no parts: they are gathered on the
# disk, beside the output, and are then lit part by part as one; nothing of that is left.
# sanitize: no
. "$SOURCE/tests/cli/shared_functions"
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
make_cave --points 140000 -o cave.ply
glowworm convert cave.ply -q cave.csv
head -30001 cave.csv >a.csv
(head -1 cave.csv && sed -n '30002,70001p' cave.csv) >b.csv
(head -1 cave.csv && tail -n +70002 cave.csv) >c.csv
glowworm convert b.csv -q b.e57
glowworm convert c.csv -q c.ply
what='--rays 8 --strays keep --effects lamps,shadows --estimate-points 0'
lamp='point at 3.4,0,1.9 intensity 40'
bake() { glowworm bake "$@" -f $what --light "$lamp"; }
bake a.csv b.e57 c.ply --memory 145M --explain --report lit.json -o lit.ply >said.txt 2>&1
grep 'of 3 files' said.txt | sed 's/[0-9.]* GB/N GB/'
sed -nE 's/^came .* ([0-9]+) MB of the host.*/\1/p' said.txt |
	awk '{ print ($1 < 160) ? "below the limit" : $1 }'
grep -oE '"format": "[a-z0-9]*", "points": [0-9]*' lit.json
places() { glowworm convert "$1" - --output-format csv | cut -d, -f1-6 | md5sum; }
[ "$(places lit.ply)" = "$(places cave.ply)" ] && echo "the points of the files, in their order"
# The light is that of one file in which they are.
bake cave.csv -q --memory 145M -o one.ply
glowworm compare lit.ply one.ply --max-relrmse 0 >/dev/null && echo "its light"
# Matrices move inputs, colours are those that came, and what scanners saw is drawn as well.
cat >scene.json <<'X'
{"version": 1, "inputs": [{"file": "a.csv"}, {"file": "b.e57",
 "matrix": [1,0,0,100, 0,1,0,0, 0,0,1,0, 0,0,0,1]}, {"file": "c.ply"}]}
X
bake scene.json -q --memory 145M -o moved.ply
glowworm info moved.ply | grep -A2 bounds | head -1 | awk '{ print ($4 > 100) ? "moved" : $0 }'
glowworm render a.csv b.e57 c.ply --memory 80M -o picture.png --size 64x48 2>&1 |
	grep -cE 'of 3 files|points are drawn of 140000'
# By tiles, and gone on with; points without a place are there, too.
(head -1 cave.csv && sed -n '2,6000p' cave.csv) |
	awk -F, -v OFS=, 'NR % 1000 == 7 { $1 = $2 = $3 = "nan" } { print }' >d.csv
(head -1 cave.csv && sed -n '6001,12001p' cave.csv) >e.csv
bake d.csv e.csv -q --tiles 2 --resume -o tiled.ply
glowworm convert tiled.ply - --output-format csv | awk 'END { print NR - 1 }'
# What is said of one alone, pipes, and axes that differ.
cat >scene.json <<'X'
{"version": 1, "inputs": [{"file": "d.csv"}, {"file": "e.csv", "albedo": [0.5, 0.5, 0.5]}]}
X
run 2 bake scene.json --light 'sky radiance 1' --tiles 2 -o none.ply
glowworm convert d.csv -q d.cloud
run 2 bake d.cloud e.csv --light 'sky radiance 1' --tiles 2 -o none.ply
head -c 100000 b.e57 >short.e57
run 65 bake d.csv short.e57 --light 'sky radiance 1' --tiles 2 -o none.ply
ls -A | grep -v -E 'said|csv$|json$'
