#!/usr/bin/env bash
# methods_table.sh - how near each way of gathering light comes to path traced truth, and what it
# takes, as a table.
#
#   tests/bench/methods_table.sh [SCENE]...
#
# SCENE is a kind that make_truth knows; without one, cornell, rooms, corridor and cave.
# Environment: GLOWWORM (build/glowworm), MAKE_TRUTH (build/tests/bench/make_truth), POINTS
# (100000), TRUTH, how many of them have one (10000), PATHS of each (4096).
#
# Columns: the scene; the options; relRMSE of the radiance against the truth, without that of the
# truth; relRMSE of the best 99 %, with it; bias and the error that the bake states, percent;
# seconds of the processor and memory of the whole process.
set -eu
export LC_ALL=C
root=$(cd "$(dirname "$0")/../.." && pwd)
glowworm=$(realpath "${GLOWWORM:-$root/build/glowworm}")
make_truth=$(realpath "${MAKE_TRUTH:-$root/build/tests/bench/make_truth}")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

settings="
--quality draft
--quality normal
--quality normal --basis scalar
--quality high
--method buffers
--method cones
--method volume --volume-cells 32
--method volume --volume-cells 64
--method volume --volume-cells 64 --volume-sh 9
--method lpv --volume-cells 8
--method lpv --volume-cells 16
--method probes --probe-size 64
--method probes --probe-size 256
"

row() { # scene options...
	local name=$1 of_truth stated
	shift
	# shellcheck disable=SC2086
	/usr/bin/time -f '%U %M' -o took "$glowworm" bake "$name.scene.json" "$@" -q -f -o lit.ply \
		--report report.json
	of_truth=$("$glowworm" compare lit.ply "$name.truth.ply" |
		awk '/^radiance +luminance/ { rest = $4 " | " $5 }
			/^the truth itself/ { print $(NF - 2) " | " rest }')
	stated=$(sed -nE 's/^ "error": \{.*"relative_rms": ([0-9.e+-]+).*/\1/p' report.json)
	awk -v name="$name" -v options="$*" -v truth="$of_truth" -v stated="$stated" \
		'{ printf "| %s | `%s` | %s | %.2g | %.1f | %d |\n", name, options, truth,
			100 * stated, $1, $2 / 1024 }' took
}

echo '| scene | options | relRMSE | best 99 % | bias | stated | processor s | MB |'
echo '|---|---|---|---|---|---|---|---|'
[ $# -gt 0 ] || set -- cornell rooms corridor cave
for scene in "$@"; do
	"$make_truth" "$scene" -o "$scene" -n "${POINTS:-100000}" -t "${TRUTH:-10000}" \
		-p "${PATHS:-4096}" >/dev/null 2>&1
	echo "$settings" | while read -r options; do
		# shellcheck disable=SC2086
		[ -z "$options" ] || row "$scene" $options
	done
done
