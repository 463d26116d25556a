#!/usr/bin/env bash
# directional_table.sh - what records that know from where their light comes gain, and what they
# take, as a table.
#
#   tests/bench/directional_table.sh [SCENE]... [-- BAKE-OPTION...]
#
# SCENE is a kind that make_truth knows, or a pattern, of cave, terrain, tree, torus, ball, cornell,
# ruin and carton; none means all of them.
# Environment: GLOWWORM (build/glowworm), POINTS (100000), TRUTH, how many of them have one (2000),
# PATHS of each (4096).
#
# Columns: the scene; the share of indirect light in what points get; relRMSE of the indirect
# irradiance with --basis scalar and directional against the truth, with what the truth is off, and
# that of the best 99 %; what the second changes; seconds of the processor and peak memory of both
# processes; records, and KB of the device that directional ones take more.
. "$(dirname "$0")/bench_folder"
# shellcheck source=tests/bench/wanted_rows
. "$root/tests/bench/wanted_rows"

# A figure of what light of that kind is off.
figure() { # kind figure
	sed -nE "/\"$1_irradiance\"/,/}/ s/.*\"luminance\": .*\"$2\": ([0-9.e+-]+).*/\1/p" compared.json
}

# A bake; its errors, seconds and MB go to `came`.
bake() { # scene basis
	/usr/bin/time -f '%U %S %M' -o took "$glowworm" bake "$1.scene.json" --basis "$2" -q -f \
		--fields direct-irradiance,indirect-irradiance -o lit.ply --report "$2.json" "${options[@]}"
	"$glowworm" compare lit.ply "$1.truth.ply" -f --json compared.json >/dev/null
	came="$(figure indirect relrmse) $(figure indirect best99)"
	came="$came $(awk '{ print $1 + $2, $3 / 1024 }' took)"
}

# Bytes of the device while points read the records.
read_bytes() { sed -nE 's/.*"name": "read back".* "bytes": ([0-9]+).*/\1/p' "$1.json" | head -1; }

row() { # scene
	local scalar
	bake "$1" scalar
	scalar=$came
	bake "$1" directional
	echo "$scalar $came $(figure direct truth_mean) $(figure indirect truth_mean)" \
		"$(sed -nE 's/^ "records": ([0-9]+).*/\1/p' directional.json)" \
		$(($(read_bytes directional) - $(read_bytes scalar))) |
		awk -v name="$1" '{
			printf "| %s | %.1f | %.2f, %.2f | %.2f, %.2f | %+.1f, %+.1f %% |", name,
				100 * $10 / ($9 + $10), 100 * $1, 100 * $2, 100 * $5, 100 * $6,
				100 * ($5 / $1 - 1), 100 * ($6 / $2 - 1)
			printf " %.1f, %.1f | %.0f, %.0f | %d | %.0f |\n", $3, $7, $4, $8, $11, $12 / 1024
		}'
}

echo '| scene | indirect, % | scalar, % | directional, % | change | processor, s | memory, MB |' \
	'records | more, KB |'
echo '|---|---|---|---|---|---|---|---|---|'
for scene in cave terrain tree torus ball cornell ruin carton; do
	is_wanted "$scene" || continue
	"$root/build/tests/bench/make_truth" "$scene" -o "$scene" -n "${POINTS:-100000}" \
		-t "${TRUTH:-2000}" -p "${PATHS:-4096}" >/dev/null 2>&1
	row "$scene"
done
