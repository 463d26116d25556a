#!/usr/bin/env bash
# surface_table.sh - what a surface of some of the points takes and loses, as a table.
#
#   tests/bench/surface_table.sh
#
# A Cornell box and rooms of a million points, beside their traced truths, and a rough cave of 1.4
# million beside a bake of all of its points. Environment: GLOWWORM (build/glowworm).
. "$(dirname "$0")/bench_folder"
for kind in cornell rooms; do
	"$root/build/tests/bench/make_truth" $kind -o $kind -n 1000000 -t 4000 -p 1024 2>/dev/null
done
cp "$root"/samples/cave.scene.json .
"$root/build/samples/make_cave" --points 1400000 -o cave.ply
"$glowworm" bake cave.scene.json -q -f -o cave.truth.ply

percent() { awk -v x="$1" 'BEGIN { printf "%.2g", 100 * x }'; }

# A number of a report.
figure() { sed -nE "s/.*\"$1\": ([0-9.e+-]+).*/\1/p" lit.json | head -1; }

row() { # scene what option...
	scene=$1 what=$2
	shift 2
	TIMEFORMAT='%U %S'
	{ time "$glowworm" bake "$scene.scene.json" -f --explain -o lit.ply --report lit.json "$@" \
		2>said.txt || true; } 2>time.txt
	off=$("$glowworm" compare lit.ply "$scene.truth.ply" --json - |
		sed -nE 's/.*"relrmse": ([0-9.e+-]+).*/\1/p' | head -1)
	printf '| %s | %s | %s | %s | %s %% | %s %% |\n' "$scene" "$what" \
		"$(awk '{ printf "%.1f", $1 + $2 }' time.txt)" \
		"$(sed -nE 's/^came .* ([0-9]+) MB of the host.*/\1/p' said.txt)" \
		"$(percent "$(figure relative_rms)")" "$(percent "$off")"
}

echo '| scene | surface | processor, s | memory, MB | error stated | off |'
echo '|---|---|---|---|---|---|'
for scene in cornell rooms cave; do
	row $scene 'all points'
	row $scene '`--surface-points 200000`' --surface-points 200000
	row $scene '`--surface-points 50000`' --surface-points 50000
	row $scene '`--max-error 0.05`' --max-error 0.05
done
