#!/usr/bin/env bash
# region_table.sh - what the light of a region takes beside that of the whole scene, as a table.
#
#   tests/bench/region_table.sh
#
# A cave of 1.4 million points with a tenth of it by a box and with what a camera in it sees, and a
# Cornell box with one wall and with what a camera before it sees. Environment: GLOWWORM
# (build/glowworm).
. "$(dirname "$0")/bench_folder"
cp "$root"/samples/cave.scene.json .
"$root/build/samples/make_cave" --points 1400000 -o cave.ply
"$root/build/samples/make_box" --scene cornell --points 500000 -o box.ply
printf '{"version": 1, "inputs": [{"file": "box.ply"}]}\n' >box.scene.json

# A number of a report.
figure() { sed -nE "s/.*\"$1\": ([0-9.e+-]+).*/\1/p" "$2" | head -1; }

# Of all, not of the region.
count_records() { sed -nE 's/^ "records": ([0-9]+).*/\1/p' "$1"; }

percent() { awk -v x="$1" 'BEGIN { printf "%.3g", 100 * x }'; }

# Difference of the luminance of two lightings, relative to the mean.
off() {
	"$glowworm" compare "$1" "$2" --json - | sed -nE 's/.*"relrmse": ([0-9.e+-]+).*/\1/p' |
		head -1
}

# A bake; its seconds of the processor go to OUTPUT.seconds.
bake() { # scene output
	local scene=$1 to=$2 TIMEFORMAT='%U %S'
	shift 2
	{
		time "$glowworm" bake "$scene.scene.json" -q -f -o "$to.ply" --report "$to.json" "$@" 2>&3
	} 3>&2 2>"$to.seconds"
}

seconds() { awk '{ print $1 + $2 }' "$1.seconds"; }

row() { # scene name region
	bake "$1" part --region "$3"
	all=$(count_records part.json)
	own=$(sed -nE 's/.*"region": .*"records": ([0-9]+).*/\1/p' part.json)
	needed=$(figure facets_needed part.json)
	facets=$(sed -nE 's/.*"facets_needed".*"facets": ([0-9]+).*/\1/p' part.json)
	printf '| %s | %s | %s | %s | %s | %s %% | %.1f | %.1f | %s %% | %s +- %s %% |\n' "$2" \
		"$(figure points part.json)" "$own" $((all - own)) "$(count_records "$1-whole.json")" \
		"$(percent "$(awk "BEGIN { print $needed / $facets }")")" \
		"$(seconds part)" "$(seconds "$1-whole")" "$(percent "$(off "$1-whole.ply" part.ply)")" \
		"$(percent "$(figure gathered part.json)")" "$(percent "$(figure spread part.json)")"
}

echo "| region | points | primary records | secondary | of the whole | surface needed |" \
	"processor, s | whole, s | apart | gathered, stated |"
echo '|---|---|---|---|---|---|---|---|---|---|'
bake cave cave-whole
row cave 'cave, a tenth of it' 'box 21,-10,-2 27,15,8'
row cave 'cave, a camera' 'camera at 27.1,-4.5,1.1 to 32.5,-6.7,1.1 fov 55'
bake box box-whole
row box 'Cornell box, a wall' 'box 0,0,0 0.001,1,1'
row box 'Cornell box, a camera' 'camera at 0.5,0.5,0.5 to 1,0.5,0.5 fov 60'
