#!/usr/bin/env bash
# scan_table.sh - true and stated errors of bakes of simulated scans, as a table.
#
#   tests/bench/scan_table.sh [CASE]... [-- BAKE-OPTION...]
#
# CASE is a name of the table below, or a pattern as rooms-* ; none means all of them. What stands
# behind -- goes to `glowworm bake`; STATIONS in it stands for the file of the scanners' places.
#
# Environment: GLOWWORM (build/glowworm), MAKE_SCAN (build/tests/bench/make_scan), SCANS, where
# scans are made and kept for the next time (build/scans), POINTS (40000), TRUTH, how many of them
# have one (8000).
#
# Columns: the case; relRMSE of the radiance against the truth, without what the truth itself is
# off, and its mean error; the error that the bake states, in percent, and that over relRMSE;
# percent of the points with a truth whose normal faces the right way; seconds of the bake.
set -u
export LC_ALL=C
root=$(cd "$(dirname "$0")/../.." && pwd)
glowworm=${GLOWWORM:-$root/build/glowworm}
make_scan=${MAKE_SCAN:-$root/build/tests/bench/make_scan}
scans=${SCANS:-$root/build/scans}
points=${POINTS:-40000}
truth=${TRUTH:-8000}
faults='--noise 3 --registration 3 --strays 0.0005 --beam 5 --divergence 0.5 --holes 3'
drift='--noise 10 --registration 10 --turn 0.1 --beam 8 --divergence 1 --strays 0.001'

# name, what make_scan is asked for
cases="
rooms-clean          rooms -f ply --normals
rooms-bare           rooms -f ply
rooms-noise          rooms -f ptx --noise 3
rooms-noise-grows    rooms -f ptx --noise 1 --noise-growth 2
rooms-registration   rooms -f ptx --registration 5 --turn 0.05
rooms-mixed          rooms -f ptx --beam 8 --divergence 0.5
rooms-strays         rooms -f ply --normals --strays 0.001
rooms-strays-many    rooms -f ply --normals --strays 0.02
rooms-holes          rooms -f ply --normals --holes 6
rooms-beams          rooms -f ply --rows 32 --noise 10
rooms-beams-normals  rooms -f ply --rows 32 --noise 10 --normals
rooms-normals        rooms -f ply --normals $faults
rooms-real           rooms -f ply $faults
rooms-ptx            rooms -f ptx $faults
rooms-e57            rooms -f e57 $faults
rooms-e57-world      rooms -f e57 --no-poses $faults
rooms-carried        rooms -f ply --carried 300 $drift
cornell-real         cornell -f ply $faults
corridor-real        corridor -f ply $faults
corridor-ptx         corridor -f ptx $faults
corridor-carried     corridor -f ply --carried 300 $drift
cave-clean           cave -f ply --normals
cave-real            cave -f ply $faults
cave-beams           cave -f ply --rows 32 --noise 10
cave-carried         cave -f ply --carried 300 $drift
cave-ptx             cave -f ptx $faults
ruin-clean           ruin -f ply --normals
ruin-real            ruin -f ply $faults
ruin-ptx             ruin -f ptx $faults
ruin-carried         ruin -f ply --carried 300 $drift
ball-bare            ball -f ply
ball-real            ball -f ply $faults
ball-ptx             ball -f ptx $faults
carton-real          carton -f ply $faults
carton-ptx           carton -f ptx $faults
torus-real           torus -f ply $faults
torus-ptx            torus -f ptx $faults
terrain-clean        terrain -f ply --normals
terrain-real         terrain -f ply $faults
terrain-ptx          terrain -f ptx $faults
fence-clean          fence -f ply --normals
fence-real           fence -f ply $faults
fence-ptx            fence -f ptx $faults
tree-clean           tree -f ply --normals
tree-normals         tree -f ply --normals $faults
tree-real            tree -f ply $faults
tree-ptx             tree -f ptx $faults
carton-steps         carton -f pcd --camera --step 3
carton-camera        carton -f pcd --camera --step 3 --noise 1 --beam 6
ball-camera          ball -f pcd --camera --step 3 --noise 1 --beam 6
"

# shellcheck source=tests/bench/wanted_rows
. "$root/tests/bench/wanted_rows"

fail() { # name, what failed
	printf '%-20s %s failed\n' "$1" "$2"
	tail -n 3 "$scans/$1.log"
}

run_case() { # name, arguments of make_scan
	local name=$1 prefix=$scans/$1 compared stated seconds
	shift
	if [ ! -f "$prefix.truth.ply" ]; then
		"$make_scan" "$@" -n "$points" -t "$truth" -o "$prefix" >"$prefix.log" 2>&1 ||
			fail "$name" make_scan
	fi
	seconds=$EPOCHREALTIME
	"$glowworm" bake "$prefix.scene.json" --force -o "$prefix.lit.ply" \
		"${options[@]//STATIONS/$prefix.stations.txt}" >"$prefix.log" 2>&1 ||
		{ fail "$name" bake && return; }
	seconds=$(awk "BEGIN { print $EPOCHREALTIME - $seconds }")
	compared=$("$make_scan" --errors "$prefix.lit.ply" "$prefix.truth.ply") ||
		{ fail "$name" compare && return; }
	stated=$(sed -n 's/.*estimated error: \([0-9.]*\) %.*/\1/p' "$prefix.log" | head -n 1)
	echo "$name $compared ${stated:-0} $seconds" | awk '{
		printf("%-20s %8s %8s %8s %8.2f %8s %8.1f\n", $1, $2, $3, $5, $2 > 0 ? $5 / $2 : 0, $4, $6)
	}'
}

mkdir -p "$scans" || exit 73
printf '%-20s %8s %8s %8s %8s %8s %8s\n' case relRMSE bias stated ratio sides seconds
echo "$cases" | while read -r name arguments; do
	[ -n "$name" ] && is_wanted "$name" || continue
	# shellcheck disable=SC2086
	run_case "$name" $arguments </dev/null
done
