#!/usr/bin/env bash
# Error against seconds and memory of many settings on the three sample scenes, as tables.
#
#   tradeoff.sh FOLDER PAGE [POINTS]     POINTS of each scene, 10000 unless said
#
# Writes FOLDER/SCENE.csv and FOLDER/SCENE.svg, and puts the tables into PAGE between its lines
# `<!-- tables -->` and `<!-- end of tables -->`.
set -eu
GLOWWORM=${GLOWWORM:-glowworm}
MAKE_CAVE=${MAKE_CAVE:-make_cave}
folder=$1
page=$2
points=${3:-10000}
here=$(cd "$(dirname "$0")" && pwd)

table_of() { # CSV
	echo "| setting | relRMSE | best 99 % | bias | seconds | peak MB | nothing beats it |"
	echo "|---|---|---|---|---|---|---|"
	# The names hold commas and stand in quotes; the first row is the reference.
	awk -F '"' 'NR > 1 {
		split($3, v, ",")
		error = NR == 2 ? "reference | |" : sprintf("%.1f %% | %.1f %% | %+.1f %%",
			100 * v[8], 100 * v[9], 100 * v[10])
		printf "| %s | %s | %.1f | %.0f | %s |\n", $2, error, v[12], v[13] / 1e6,
			v[15] == 1 ? "yes" : ""
	}' "$1"
}

sweep() { # scene title option...
	local scene=$1 title=$2
	shift 2
	"$GLOWWORM" tradeoff "$folder/$scene.scene.json" --csv "$folder/$scene.csv" \
		--svg "$folder/$scene.svg" --force "$@" >"$folder/$scene.txt"
	echo
	echo "### $title"
	echo
	table_of "$folder/$scene.csv"
	sed -n 's/^\(The reference estimates.*\)/\n\1/p' "$folder/$scene.txt" | fold -s -w 100 |
		sed 's/ *$//'
}

mkdir -p "$folder"
cp "$here"/*.scene.json "$here"/*.obj "$here"/*.mtl "$folder"
"$MAKE_CAVE" --points "$points" -o "$folder/cave.ply"
{
	sed '/^<!-- tables -->$/q' "$page"
	sweep cornell "Cornell box, $points points" --count "$points"
	sweep spot_box "Box lit by a spot through its ceiling, $points points" --count "$points"
	sweep cave "Cave with two spots, $points points"
	echo
	sed -n '/^<!-- end of tables -->$/,$p' "$page"
} >"$folder/page.new"
cp "$folder/page.new" "$page"
