#!/usr/bin/env bash
# What `make demo` shows: makes the cave, lights it with the lamps of cave.scene.json at depth 8 and
# its own glowing patches, makes a picture of it and a page on which the lamps can be dimmed, and
# prints how long that took and where the results are.
#
#   demo.sh FOLDER
set -eu
GLOWWORM=${GLOWWORM:-glowworm}
MAKE_CAVE=${MAKE_CAVE:-make_cave}
folder=$1
here=$(cd "$(dirname "$0")" && pwd)

# Runs a command and sets `seconds` to what it took.
measure() {
	local begin
	begin=$(date +%s%N)
	"$@"
	seconds=$(awk -v ns=$(($(date +%s%N) - begin)) 'BEGIN { printf "%.1f", ns / 1e9 }')
}

row() { # step seconds file
	printf '%-10s %8s s %7s MB  %s\n' "$1" "$2" $(($(stat -c %s "$3") / 1000000)) "$3"
}

mkdir -p "$folder"
cp "$here/cave.scene.json" "$folder/cave.scene.json" # beside cave.ply, where its inputs are sought
measure "$MAKE_CAVE" -o "$folder/cave.ply"
make_seconds=$seconds

rm -f "$folder/cave_lit.ply" "$folder/report.json"
measure "$GLOWWORM" bake "$folder/cave.scene.json" --depth 8 --report "$folder/report.json" \
	--fields lights -o "$folder/cave_lit.ply"
bake_seconds=$seconds

rm -f "$folder/cave.png"
measure "$GLOWWORM" render "$folder/cave_lit.ply" -o "$folder/cave.png"
render_seconds=$seconds

rm -f "$folder/cave.html"
measure "$GLOWWORM" page "$folder/cave_lit.ply" --title 'The sample cave' --points 500000 \
	--setup 'hall alone: *=0 hall=1' --setup 'passage alone: *=0 passage=1' \
	--setup 'without lava: rest=0' -o "$folder/cave.html"
page_seconds=$seconds

row 'make cave' "$make_seconds" "$folder/cave.ply"
row bake "$bake_seconds" "$folder/cave_lit.ply"
row picture "$render_seconds" "$folder/cave.png"
row page "$page_seconds" "$folder/cave.html"
echo
"$GLOWWORM" info "$folder/cave_lit.ply"
echo
echo "Open $folder/cave.html in a browser and turn the lamps up and down, or $folder/cave_lit.ply"
echo "in CloudCompare, MeshLab or Blender; $folder/report.json says what the bake did."
echo "samples/relight_cave.sh $folder lights the cave twenty other ways."
