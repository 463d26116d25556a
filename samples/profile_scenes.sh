#!/usr/bin/env bash
# The tables of Salm's thesis (5.1 to 5.3) for the three scenes at depths 7 and 8: milliseconds and
# megabytes of this machine, the thesis's behind them (1600x900, GeForce GTX 560 Ti).
#
#   profile_scenes.sh FOLDER
#
# A profile that is in FOLDER already is used again; take it away to measure anew.
set -eu
GLOWWORM=${GLOWWORM:-glowworm}
MAKE_CAVE=${MAKE_CAVE:-make_cave}
folder=$1
here=$(cd "$(dirname "$0")" && pwd)

profile() { # scene depth method
	local log="$folder/$1-$2-$3.txt"
	[ -f "$log" ] || "$GLOWWORM" bake "$folder/$1.scene.json" -f --method "$3" --depth "$2" \
		--estimate-points 0 --profile -o "$folder/lit.ply" 2>"$log"
}

# The last number of a line, or the one before MB, rounded.
value() { # log name
	awk -v name="$2" 'index($0, name) == 1 { v = $NF == "MB" ? $(NF - 1) : $NF }
		END { printf(v < 10 ? "%.1f" : "%.0f", v) }' "$1"
}

row() { # title scene depth, and of the thesis: static injection gather propagation buffer pools
	local rays="$folder/$2-$3-rays.txt" cones="$folder/$2-$3-cones.txt"
	profile "$2" "$3" rays
	profile "$2" "$3" cones
	echo "| $1, $3 | $(value "$cones" static) / $4 | $(value "$cones" inj./mip.) / $5" \
		"| $(value "$cones" gather) / $6 | $(value "$cones" l.prop.) / $7" \
		"| $(value "$rays" l.prop.) | $(value "$cones" SVO-buffer) / $8" \
		"| $(value "$cones" 'brick pools') / $9 |"
}

mkdir -p "$folder"
cp "$here"/*.scene.json "$here"/*.obj "$here"/*.mtl "$folder"
[ -f "$folder/cave.ply" ] || "$MAKE_CAVE" -o "$folder/cave.ply"
echo '| scene, depth | static | inj./mip | VCT | l.prop. | by rays | SVO-buffer | brick pools |'
echo '|---|---|---|---|---|---|---|---|'
row 'Cornell box' cornell 7 20.4 2.7 5.7 9.8 2.1 64
row 'Cornell box' cornell 8 91.1 16.2 25.4 47.5 8.7 256
row 'spot box' spot_box 7 19.3 2.7 5.3 9.4 2.1 64
row 'spot box' spot_box 8 84.8 16.0 23.5 45.1 8.7 256
row cave cave 7 158 1.4 1.7 3.5 1.8 64
row cave cave 8 249 5.1 7.8 14.5 2.9 128
