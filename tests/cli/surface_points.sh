# A surface of some of the points, by their number or because memory holds no more: the others are
# lit by it, note and report say so, and with --memory the process stays below that.
# sanitize: no
. "$SOURCE/tests/cli/shared_functions"
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
make_box --scene cornell --points 60000 -o box.ply
bake() { glowworm bake "$@" -f --rays 16 --least-records 100; }
short() { grep 'others make' | sed -E 's/[0-9.e-]+ m apart/D m apart/; s/[0-9]{4,}/N/g'; }
bake box.ply --surface-points 6000 --report few.json -o few.ply 2>&1 | short
surface() {
	awk -F'[:,]' '/^ "surface_points"/ { print ($2 > low && $2 <= high) ? "as asked" : $2 }' \
		low="$2" high="$3" "$1"
}
surface few.json 5500 6060
grep -o '"between": 0\.0*' few.json
glowworm convert few.ply - --output-format csv | awk 'END { print NR - 1 }'
# By a key of a scene file and by one thread, the same bytes; more than there are is all of them.
printf '{"version": 1, "inputs": [{"file": "box.ply"}],
"bake": {"surface_points": 6000}}\n' >few.json
bake few.json -q -j 1 -o key.ply
[ "$(body few.ply)" = "$(body key.ply)" ] && echo "by a key: the same"
bake box.ply -q --surface-points 70000 -o many.ply
bake box.ply -q -o all.ply
[ "$(body many.ply)" = "$(body all.ply)" ] && echo "of more than there are: all"
# In 165 MiB, of which the program takes some by itself, there is room for about a half.
bake box.ply --memory 165M --explain --report some.json -o some.csv >said.txt 2>&1
short <said.txt
surface some.json 10000 59000
sed -nE 's/^came .* ([0-9]+) MB of the host.*/\1/p' said.txt |
	awk '{ print ($1 < 174) ? "below" : $1 }'
glowworm plan box.ply --memory 165M -o plan.csv 2>&1 | grep -c 'half of the points baked'
# What is explained is the same light, also where surface keeps something apart.
make_cave --points 6000 -o cave.ply
in_cave() {
	bake cave.ply --surface-points 3000 --light 'sky radiance 1' --strays keep -o lit.ply "$@" \
		>/dev/null 2>&1
	body lit.ply
}
[ "$(in_cave)" = "$(in_cave --explain)" ] && echo "explained: the same"
# What is of all points is refused, and what no bake is.
bake box.ply -q --surface-points 6000 --save-transport t.gwt -o t.ply
bake box.ply -q --surface-points 6000 --region 'camera at 0.5,0.5,0.5 to 1,0.5,0.5 fov 40' -o t.ply
bake box.ply -q --surface-points 0 -o t.ply
[ -e t.ply ] || echo "nothing written"
