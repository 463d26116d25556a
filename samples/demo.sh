#!/usr/bin/env bash
# What `make demo` shows: makes the cave, lights it with the lamps of cave.scene.json at depth 8
# and its own glowing patches, makes a picture of it, and prints how long that took and where the
# results are.
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
	-o "$folder/cave_lit.ply"
bake_seconds=$seconds

rm -f "$folder/cave.png"
measure "$GLOWWORM" render "$folder/cave_lit.ply" -o "$folder/cave.png"
render_seconds=$seconds

row 'make cave' "$make_seconds" "$folder/cave.ply"
row bake "$bake_seconds" "$folder/cave_lit.ply"
row picture "$render_seconds" "$folder/cave.png"
echo
"$GLOWWORM" info "$folder/cave_lit.ply"
echo
echo "Open $folder/cave_lit.ply in CloudCompare, MeshLab or Blender; $folder/report.json says what"
echo "the bake did. samples/relight_cave.sh $folder lights the cave twenty other ways."
