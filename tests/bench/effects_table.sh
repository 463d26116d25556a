#!/usr/bin/env bash
# effects_table.sh - what plans foretell beside what came, and what is saved by leaving out what a
# scene does not call for, as two tables.
#
#   tests/bench/effects_table.sh [SCENE-FILE]...
#
# Without scene files it makes those of the table: a cave with two spots, a ruin under sun and sky,
# the Cornell box, a glossy box, six frames of a cube that moves in the Cornell box, hills as a
# scanner outdoors sees them with noise and strays, without normals, and a lamp over a plane of
# which light is wanted that nothing hides or reflects (--effects lamps,error).
#
# Environment: GLOWWORM (build/glowworm), TURNS, how often each is baked, in turns (3); the one that
# took least counts, with what itself foretold.
set -eu
export LC_ALL=C
root=$(cd "$(dirname "$0")/../.." && pwd)
glowworm=$(realpath "${GLOWWORM:-$root/build/glowworm}")
turns=${TURNS:-3}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

make_scenes() {
	cd "$work"
	cp "$root"/samples/*.json "$root"/samples/*.obj "$root"/samples/*.mtl .
	"$root/build/samples/make_cave" --points 200000 -o cave.ply
	"$root/build/tests/bench/make_truth" ruin -o ruin -n 100000 -t 10 -p 1 >/dev/null 2>&1
	"$root/build/tests/bench/make_scan" terrain -o hills_scan -f ptx -n 100000 -t 10 -p 1 \
		--noise 3 --noise-growth 0.2 --beam 5 --strays 0.0005 >/dev/null
	"$root/build/samples/make_box" --scene plane --points 100000 -o plane.ply >/dev/null
	cat >lamp_alone.scene.json <<-END
		{"version": 1, "inputs": [{"file": "plane.ply"}], "lights": [{"type": "spot",
		 "position": [0, 0, 2], "direction": [0, 0, -1], "intensity": 9, "inner_angle": 20,
		 "outer_angle": 40}]}
	END
	printf '%s\n' cave.scene.json ruin.scene.json cornell.scene.json glossy_box.scene.json \
		cornell_frames.scene.json hills_scan.scene.json lamp_alone.scene.json
}

# Seconds, MB of the host and of the device, error and spread, of a line of --explain.
figures() {
	sed -nE "s/^$1 +([0-9.]+) s, ([0-9]+) MB of the host, ([0-9]+) MB[^,]*(, error ([0-9.]+) % \
\+- ([0-9.]+) %)?( or more)?.*/\1 \2 \3 \5 \6\7/p" "$2"
}

# The words and figures of the bake with --effects that took least, which it leaves in $2.txt.
bake() {
	frames=
	[ "$(basename "$1")" != cornell_frames.scene.json ] || frames="--frames 0..5"
	for turn in $(seq "$turns"); do
		"$glowworm" bake "$1" --effects "$2" $frames --progress none --explain --force \
			-o "$work/lit.ply" 2>"$work/$2.$turn.txt"
	done
	for turn in $(seq "$turns"); do
		echo "$(figures came "$work/$2.$turn.txt" | cut -d ' ' -f 1) $turn"
	done | sort -n >"$work/runs"
	read -r _ turn <"$work/runs"
	mv "$work/$2.$turn.txt" "$work/$2.txt"
	figures came "$work/$2.txt"
}

one() {
	name=$(basename "$1" .scene.json)
	effects=auto
	[ "$name" != lamp_alone ] || effects=lamps,error
	read -r auto_s auto_mb auto_device error spread <<<"$(bake "$1" $effects)"
	told=$work/$effects.txt
	left=$(awk '/ not called for / { printf "%s%s", n++ ? ", " : "", $1 }' "$told")
	read -r told_s told_mb told_device told told_spread <<<"$(figures foretold "$told")"
	read -r all_s all_mb _ <<<"$(bake "$1" all)"
	printf '| %s | %s / %s | %s / %s | %s / %s | %s +- %s / %s +- %s |\n' "$name" "$told_s" \
		"$auto_s" "$told_mb" "$auto_mb" "$told_device" "$auto_device" "${told:--}" \
		"${told_spread:--}" "${error:--}" "${spread:--}" >>"$work/told.md"
	printf '| %s | %s | %s | %s | %s | %s |\n' "$name" "$left" "$auto_s" "$all_s" "$auto_mb" \
		"$all_mb" >>"$work/saved.md"
}

if [ $# -gt 0 ]; then scenes=$(printf '%s\n' "$@"); else scenes=$(make_scenes); fi
for scene in $scenes; do
	case $scene in /*) ;; *) [ -e "$scene" ] || scene=$work/$scene ;; esac
	one "$scene"
done
printf '| scene | seconds, foretold / came | MB of the host | of the device | error, %% |\n'
printf '|---|---|---|---|---|\n'
cat "$work/told.md"
printf '\n| scene | not called for | seconds | with all | MB | with all |\n'
printf '|---|---|---|---|---|---|\n'
cat "$work/saved.md"
