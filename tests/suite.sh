#!/usr/bin/env bash
# Runs groups of tests and counts. Each argument is BUILD:GROUP, such as build:unit or
# build/sanitize:cli. The groups:
#
#   unit physics hostile   every program BUILD/tests/GROUP/test_*; cmocka names its tests
#   shaders                those of physics that take seconds, by shaders alone, as on a GPU, under
#                          the validation layer; test_shaders.c has the rest
#   interop                tests/cli/run with the scripts of tests/interop
#   cli                    tests/cli/run with BUILD/glowworm; each script is a test
#   quick-unit quick-cli   those of unit and cli that tests/slow_tests does not list
#   torture                the short run of the campaign of tests/torture
#   lint                   tests/lint/check_*.sh and test_*.sh; each script is a test
#   style                  those of them that look at the sources alone, in seconds
#
# Programs and scripts of a group run beside each other, one a processor: most keep one busy.
#
# Prints one line a group, the output of what failed, what took longest, and at the end
# `N passed, N failed`. The exit status is 1 when a test failed or when there was none.
set -u
export LC_ALL=C TZ=UTC
root=$(cd "$(dirname "$0")/.." && pwd)
limit=${GLOWWORM_TEST_TIMEOUT:-600}
scratch=$(mktemp -d "${TMPDIR:-/tmp}/glowworm-suite.XXXXXX") || exit 70
trap 'kill $(jobs -p) 2>/dev/null; rm -rf "$scratch"' EXIT
trap 'exit 130' INT
trap 'exit 143' TERM
cd "$root" || exit 70

# The Vulkan loader and driver never free some of what they allocate; leaks of ours still count.
export LSAN_OPTIONS="suppressions=$root/tests/leaks_of_others.txt:print_suppressions=0"
export UBSAN_OPTIONS="print_stacktrace=1"
# Who allocated a block is told by 8 frames: to walk all of the stack each time takes long.
asan="detect_leaks=1:allocator_may_return_null=1:malloc_context_size=8"

# glibc fills memory that is allocated with 0x5a and what is freed with 0xa5, so that a value that
# was never set is wrong in every run. Sanitizers have an allocator of their own.
export MALLOC_PERTURB_=${MALLOC_PERTURB_-165}

# A line for each program and script: seconds of the processor, and its name.
# shellcheck source=tests/seconds_spent
. "$root/tests/seconds_spent"
export GLOWWORM_TEST_SECONDS=$scratch/seconds
passed=0 failed=0 skipped=0

count_lines() { # pattern file
	grep -ac -- "$1" "$2" || true
}

# Those of a list of tests that are not slow.
list_quick() { # source...
	printf '%s\n' "$@" | grep -vxFf tests/slow_tests
}

# Runs one cmocka program.
run_program() { # program
	local log
	log=$scratch/$(basename "$1").log
	timeout --kill-after=10 "$limit" "$1" >"$log" 2>&1 </dev/null &
	trap "kill $! 2>/dev/null; exit 143" TERM
	wait $!
	echo $? >"$log.status"
	note_seconds "$1"
}

# Counts what it said. A program that crashes or leaks has at least one failure, and the test it was
# in when it crashed counts as failed.
judge_program() { # program
	local name log started good skips bad status
	name=$(basename "$1")
	log=$scratch/$name.log
	status=$(cat "$log.status" 2>/dev/null || echo 137)
	started=$(count_lines '^\[ RUN      \]' "$log")
	good=$(count_lines '^\[       OK \]' "$log")
	skips=$(sed -n 's/^\[  SKIPPED \] \([0-9]*\) test(s).*/\1/p' "$log" | tail -n 1)
	skips=${skips:-0}
	bad=$((started - good - skips))
	[ "$status" -ne 0 ] && [ "$bad" -le 0 ] && bad=1
	if [ "$started" -eq 0 ]; then
		bad=1
		echo "no test ran" >>"$log"
	fi
	if [ "${GLOWWORM_NO_SKIP:-0}" = 1 ]; then
		bad=$((bad + skips))
		skips=0
	fi
	[ "$skips" -eq 0 ] || echo "   $name: $skips skipped"
	if [ "$bad" -ne 0 ]; then
		echo "FAIL $name: exit status $status"
		[ "$status" -eq 124 ] && echo "   it ran into the limit of $limit seconds"
		grep -av '^\[ RUN      \]\|^\[       OK \]' "$log" | head -n 120 | sed 's/^/   /'
	fi
	group_passed=$((group_passed + good))
	group_failed=$((group_failed + bad))
	skipped=$((skipped + skips))
}

# Runs each of a list, as many beside each other as there are processors.
run_beside() { # function item...
	local item run=$1
	shift
	for item in "$@"; do
		while [ "$(jobs -rp | wc -l)" -ge "$(nproc)" ]; do wait -n; done
		"$run" "$item" &
	done
	wait
}

run_programs() { # build source...
	local source program build=$1 list=()
	shift
	for source in "$@"; do
		[ -f "$source" ] || continue
		program=$build/${source%.*}
		if [ -x "$program" ]; then
			list+=("$program")
		else
			echo "FAIL $program was not built"
			group_failed=$((group_failed + 1))
		fi
	done
	run_beside run_program "${list[@]}"
	for program in "${list[@]}"; do
		judge_program "$program"
	done
}

run_cli() { # build script...
	local closing status build=$1
	shift
	GLOWWORM=$build/glowworm tests/cli/run "$@" >"$scratch/log" 2>&1
	status=$?
	closing=$(tail -n 1 "$scratch/log" | sed -n 's/^\([0-9]*\) passed, \([0-9]*\) failed$/\1 \2/p')
	sed '$d' "$scratch/log"
	if [ -n "$closing" ]; then
		group_passed=${closing% *}
		group_failed=${closing#* }
	else
		tail -n 1 "$scratch/log"
		group_failed=1
	fi
	[ "$status" -ne 0 ] && [ "$group_failed" -eq 0 ] && group_failed=1
}

# A failure's first line names it, its second the command that repeats it.
run_torture() { # build
	local status closing
	if [ ! -x "$1/tests/torture/torture" ]; then
		echo "FAIL $1/tests/torture/torture was not built"
		group_failed=1
		return
	fi
	timeout --kill-after=10 "$limit" "$1/tests/torture/torture" --slice --jobs "$(nproc)" \
		--program "$1/glowworm" --folder "$scratch/torture" >"$scratch/log" 2>&1
	status=$?
	closing=$(tail -n 1 "$scratch/log" | sed -n 's/^\([0-9]*\) passed, \([0-9]*\) failed.*/\1 \2/p')
	grep -a -A 1 '^FAIL' "$scratch/log" | head -n 60
	if [ -n "$closing" ]; then
		group_passed=${closing% *}
		group_failed=${closing#* }
	else
		tail -n 5 "$scratch/log"
		group_failed=1
	fi
	[ "$status" -ne 0 ] && [ "$group_failed" -eq 0 ] && group_failed=1
}

# Runs one script of a lint group; build: that of the group.
run_script() { # script
	local log
	log=$scratch/$(basename "$1").log
	BUILD=$build timeout "$limit" bash "$1" >"$log" 2>&1
	echo $? >"$log.status"
	note_seconds "$1"
}

run_lint() { # script...
	local script log
	run_beside run_script "$@"
	for script in "$@"; do
		log=$scratch/$(basename "$script").log
		if [ "$(cat "$log.status" 2>/dev/null)" = 0 ]; then
			group_passed=$((group_passed + 1))
		else
			group_failed=$((group_failed + 1))
			echo "FAIL $script"
			head -n 60 "$log" | sed 's/^/   /'
		fi
	done
}

for item in "$@"; do
	build=${item%:*} group=${item##*:}
	group_passed=0 group_failed=0
	begin=$(date +%s)
	case $build in
	*sanitize*) export ASAN_OPTIONS="$asan" ;;
	*) unset ASAN_OPTIONS ;;
	esac
	case $group in
	unit | hostile) run_programs "$build" "tests/$group"/test_*.c "tests/$group"/test_*.cpp ;;
	# The one that takes longest first, so that the others have run when it ends.
	physics)
		others=(tests/physics/test_*.c)
		run_programs "$build" tests/physics/test_shaders.c "${others[@]/*test_shaders.c/}"
		;;
	shaders)
		GLOWWORM_TEST_PASSES=device GLOWWORM_TEST_VALIDATE=calls run_programs "$build" \
			tests/physics/test_{boundaries,leaks,shadow_map,portals,glossy,gloss_caches}.c
		;;
	cli) run_cli "$build" ;;
	quick-unit)
		mapfile -t quick < <(list_quick tests/unit/test_*.c tests/unit/test_*.cpp)
		run_programs "$build" "${quick[@]}"
		;;
	quick-cli)
		mapfile -t quick < <(list_quick tests/cli/*.sh)
		run_cli "$build" "${quick[@]}"
		;;
	interop) run_cli "$build" tests/interop/*.sh ;;
	torture) run_torture "$build" ;;
	lint) run_lint tests/lint/test_*.sh tests/lint/check_*.sh ;;
	style)
		run_lint tests/lint/check_{banned,format,layers,readme,scripts,style,symbols}.sh
		;;
	*)
		echo "tests/suite.sh: there is no group $group" >&2
		exit 2
		;;
	esac
	printf '%-24s %5d passed %4d failed %5d s\n' "$build $group" "$group_passed" "$group_failed" \
		$(($(date +%s) - begin))
	passed=$((passed + group_passed))
	failed=$((failed + group_failed))
done
[ -f "$GLOWWORM_TEST_SECONDS" ] && sort -rn "$GLOWWORM_TEST_SECONDS" | head -n 12 |
	awk 'NR == 1 { print "took longest, seconds of the processor:" } { printf "%6d %s\n", $1, $2 }'
[ "$skipped" -eq 0 ] || echo "$skipped skipped"
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ] && [ "$passed" -gt 0 ]
