#!/usr/bin/env bash
# coverage.sh - chooses the tests that `make test` runs under sanitizers as well, and writes those
# of unit, hostile and cli that it leaves out into tests/not_sanitized. `make coverage` builds what
# it takes.
#
# Sanitizers look for faults of memory and for undefined behaviour, which depend on the lines and
# branches that are reached, hardly on how often. Each test runs by itself in a build that counts
# them. All of hostile are taken, and those of less than a second; then whichever adds the most
# lines and branches a second of the processor, until 99.5 % of the lines are reached that all tests
# reach. What takes long and reaches little that others do not is left out. Those that the list has
# `by hand` are neither run nor counted, and stay there.
#
# What each test reached is kept in build/coverage/reached, a file a test, until the test or the
# program is made anew; when one fails, which is then not kept, the list stays as it is. Takes some
# 900 seconds of the processor.
set -u
export LC_ALL=C TZ=UTC
cd "$(dirname "$0")/.." || exit 70
root=$PWD kept=$PWD/build/coverage/reached
# shellcheck source=tests/seconds_spent
. tests/seconds_spent

# The notes of the compiler lie beside the counters, so that gcov finds them.
link_notes() { # folder
	(cd "$1" && find . -name '*.gcda' | while read -r counters; do
		ln -s "$root/${counters%.gcda}.gcno" "${counters%.gcda}.gcno"
	done)
}

# FILE:LINE and FILE:LINE:BRANCH of what was reached of ours, from what gcov prints.
list_reached() {
	awk '
		/^ *-: *0:Source:/ { source = $0; sub(/.*Source:/, "", source); next }
		source !~ /^(lib|formats|cli|shaders)\// { next }
		/^branch/ { if (/taken [1-9]/ && !/\(throw\)/) print source ":" line ":" $2; next }
		/^ *([0-9]+[*]?|-|[#=]+): *[0-9]+:/ {
			split($0, part, ":")
			line = part[2] + 0
			if (part[1] ~ /[1-9]/)
				print source ":" line
		}' | sort -u
}

# Runs a test and keeps what it reached; the first line is its source and seconds.
count_one() { # source
	local name counters program=build/coverage/${1%.*}
	name=$(basename "$1")
	[ "${1##*.}" = sh ] && program=build/coverage/glowworm
	[ "$kept/$name" -nt "$program" ] && [ "$kept/$name" -nt "$1" ] && return
	rm -f "$kept/$name"
	counters=$(mktemp -d "${TMPDIR:-/tmp}/glowworm-coverage.XXXXXX") || exit 70
	# The root's folders are left out of the counters' paths.
	export GCOV_PREFIX=$counters GCOV_PREFIX_STRIP
	GCOV_PREFIX_STRIP=$(tr -cd / <<<"$root" | wc -c)
	case $1 in
	*.sh) GLOWWORM=$program timeout 1200 tests/cli/run "$1" ;;
	*) timeout 1200 "$program" ;;
	esac </dev/null >"$counters/log" 2>&1
	if [ $? -ne 0 ]; then
		echo "$1 failed where lines are counted:"
		tail -n 40 "$counters/log" | sed 's/^/   /'
		rm -rf "$counters"
		return
	fi
	seconds_spent
	link_notes "$counters"
	{
		echo "$1 $spent"
		find "$counters" -name '*.gcda' ! -path '*/tests/*' ! -path '*/samples/*' |
			xargs -r gcov --stdout --branch-probabilities --branch-counts --relative-only |
			list_reached
	} >"$kept/$name.new"
	mv "$kept/$name.new" "$kept/$name"
	rm -rf "$counters"
}

# Prints those of the tests that are left out, and how much the others reach to standard error.
choose() { # file...
	awk '
		function take(t, k, j, item, user, reaches, users) {
			taken[t] = 1
			sum += seconds[t]
			reaches = split(reached_by[t], item, " ")
			for (k = 1; k <= reaches; k++) {
				if (item[k] in got)
					continue
				got[item[k]] = 1
				reached[is_line[item[k]]]++
				users = split(users_of[item[k]], user, " ")
				for (j = 1; j <= users; j++)
					gain[user[j]]--
			}
		}
		function best(t, b) {
			for (t = 1; t <= tests; t++)
				if (!(t in taken) && gain[t] * seconds[b] > gain[b] * seconds[t])
					b = t
			return b
		}
		FNR == 1 { test[++tests] = $1; seconds[tests] = $2 + 0.1; total += $2; next }
		{
			if (!($1 in number)) {
				number[$1] = ++items
				is_line[items] = split($1, part, ":") == 2
				all[is_line[items]]++
			}
			users_of[number[$1]] = users_of[number[$1]] " " tests
			reached_by[tests] = reached_by[tests] " " number[$1]
			gain[tests]++
		}
		END {
			seconds[0] = 1
			gain[0] = 0
			for (t = 1; t <= tests; t++)
				if (test[t] ~ /^tests\/hostile\// || seconds[t] < 1)
					take(t)
			while (reached[1] < 0.995 * all[1] && (t = best(0, 0)))
				take(t)
			for (t = 1; t <= tests; t++)
				if (!(t in taken))
					print test[t]
			printf "%.0f of %.0f seconds reach %.1f %% of %d lines, %.1f %% of %d branches\n", sum,
				total, 100 * reached[1] / all[1], all[1], 100 * reached[0] / all[0],
				all[0] >"/dev/stderr"
		}' "$@"
}

mkdir -p "$kept"
mapfile -t sources < <(ls tests/unit/test_*.c* tests/hostile/test_*.c* &&
	grep -L '^# sanitize: no$' tests/cli/*.sh |
	grep -vxFf <(sed '1,/^# By hand/d' tests/not_sanitized))
for source in "${sources[@]}"; do
	while [ "$(jobs -rp | wc -l)" -ge "$(nproc)" ]; do wait -n; done
	count_one "$source" &
done
wait
for source in "${sources[@]}"; do
	[ -f "$kept/$(basename "$source")" ] || exit 1
done
{
	sed '/^[^#]/,$d' tests/not_sanitized
	choose "${sources[@]/#*\//$kept/}"
	sed -n '/^# By hand/,$p' tests/not_sanitized
} >"$kept/../not_sanitized" && cp "$kept/../not_sanitized" tests/not_sanitized
