#!/usr/bin/env bash
# Lights the same cave twenty times with lamps that move and change colour, one file each.
#
#   relight_cave.sh [FOLDER] [option of glowworm bake]...
#
# Makes FOLDER/cave.ply if it is not there (with make_cave), then FOLDER/lit/NAME.ply. Files that
# are there already are left alone, so a stopped run goes on where it was. The first bake keeps in
# FOLDER/cave.transport what does not depend on the light; the others begin with that, so they are
# quick. Remove that file when the cave or an option changes. Copy this script and put in your own
# scan and lamps.
set -eu
GLOWWORM=${GLOWWORM:-glowworm}
MAKE_CAVE=${MAKE_CAVE:-make_cave}
folder=${1:-.}
[ $# -eq 0 ] || shift

mkdir -p "$folder/lit"
transport=$folder/cave.transport
[ -e "$folder/cave.ply" ] || "$MAKE_CAVE" -o "$folder/cave.ply"

# One line a lighting: its name, then one lamp or several with / between them. The places are
# those that `make_cave --stations` prints, so each lamp hangs in the air. A line that ends with \
# goes on in the next, as `read` without -r has it.
# shellcheck disable=SC2162
while read name lamps; do
	output=$folder/lit/$name.ply
	[ ! -e "$output" ] || continue
	options=()
	IFS=/ read -r -a list <<<"$lamps"
	for lamp in "${list[@]}"; do
		options+=(--light "$(echo "$lamp" | xargs)")
	done
	if [ -e "$transport" ]; then
		options+=(--transport "$transport")
	else
		options+=(--save-transport "$transport")
	fi
	started=$(date +%s%N)
	"$GLOWWORM" bake "$folder/cave.ply" "${options[@]}" "$@" -o "$output" </dev/null
	printf '%s %d.%d s\n' "$output" $((($(date +%s%N) - started) / 1000000000)) \
		$((($(date +%s%N) - started) / 100000000 % 10)) >&2
done <<'LIGHTINGS'
entrance-warm    point at 3.4,0,1.9 intensity 40,30,18
entrance-cold    point at 3.4,0,1.9 intensity 20,28,40
passage-torch    point at 9.5,1.2,1.6 intensity 25,12,4
hall-west-warm   spot at 13.5,2.6,1.8 to 19,4.5,3.2 intensity 190,150,105 inner 22 outer 42
hall-west-blue   spot at 13.5,2.6,1.8 to 19,4.5,3.2 intensity 60,110,200 inner 22 outer 42
hall-up          spot at 13.5,2.6,1.8 to 15,3,7 intensity 150,140,120 inner 10 outer 60
hall-east        spot at 20,2.8,1.5 to 13,4,3 intensity 190,150,105 inner 22 outer 42
hall-crossed     spot at 13.5,2.6,1.8 to 19,4.5,3.2 intensity 200,60,30 inner 20 outer 40 / \
                 spot at 20,2.8,1.5 to 13,4,3 intensity 30,80,200 inner 20 outer 40
alcove           point at 16,10.6,1.4 intensity 12,10,8
headlamp-east    spot at 24.8,0,1.1 to 30,-3,1.4 intensity 80,80,76 inner 12 outer 35
lava-dimmed      point at 28.6,-3.4,1 intensity 4,5,7
entrance-dim     point at 3.4,0,1.9 intensity 4,3,2
entrance-green   point at 3.4,0,1.9 intensity 12,40,18
passage-cold     point at 9.5,1.2,1.6 intensity 10,16,25
hall-west-green  spot at 13.5,2.6,1.8 to 19,4.5,3.2 intensity 60,170,80 inner 22 outer 42
hall-up-wide     spot at 13.5,2.6,1.8 to 15,3,7 intensity 90,80,60 inner 20 outer 80
hall-east-red    spot at 20,2.8,1.5 to 13,4,3 intensity 190,60,40 inner 22 outer 42
alcove-bright    point at 16,10.6,1.4 intensity 60,50,40
headlamp-west    spot at 24.8,0,1.1 to 20,2,1.4 intensity 80,80,76 inner 12 outer 35
end-and-passage  point at 37.4,-0.8,0.9 intensity 14,11,8 / point at 9.5,1.2,1.6 intensity 10,14,20
LIGHTINGS
