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
#   chosen-unit chosen-hostile chosen-cli
#                          those that tests/not_sanitized does not list
#   other-hostile other-cli
#                          those that chosen-hostile and chosen-cli leave out, which may be none, so
#                          that both together run each once
#
# All programs and scripts of all groups are one queue, the longest first (tests/slow_tests), of
# which one more runs beside each other than there are processors: most keep one busy, but wait for
# files and the device now and then. Scripts of cli that measure time (`# alone: yes`) run after the
# others, one by one.
#
# Prints the output of what failed when it fails; at the end one line a group with the seconds of
# the processor that it took, what took longest, and `N passed, N failed`. The exit status is 1 when
# a test failed or when there was none.
#
# Environment: GLOWWORM_TEST_TIMEOUT seconds a test (600; scripts of cli 300), GLOWWORM_TEST_SECONDS
# a file that gets a line for each test: seconds of the processor, build, source.
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
# Who allocated a block is told by 8 frames: to walk all of the stack each time takes long.
asan="detect_leaks=1:allocator_may_return_null=1:malloc_context_size=8"
# What is freed is kept from being used again until 16 MB more are freed, not 256, which is more
# than these programs allocate in all, so that all that they touch would be pages never touched
# before; and freed pages are not given back to the system on the way: each page that is touched
# anew costs more than what the test does with it.
asan+=":quarantine_size_mb=16:thread_local_quarantine_size_kb=64"
asan+=":allocator_release_to_os_interval_ms=-1"
# Undefined behaviour ends in an illegal instruction, whose line is told, also where a test has a
# handler of its own.
asan+=":handle_sigill=2"

# glibc fills memory that is allocated with 0x5a and what is freed with 0xa5, so that a value that
# was never set is wrong in every run. Sanitizers have an allocator of their own.
export MALLOC_PERTURB_=${MALLOC_PERTURB_-165}

# Half of the scripts are skipped where no Vulkan device is: asked once, not by each of them. Where
# Mesa's software device is the only one, Vulkan's loader is told to open its driver alone, not each
# one that is installed and then finds no hardware.
for item in "$@"; do
	if [ -z "${LOOK_FOR_DEVICE:-}" ] &&
		devices=$("${item%:*}/glowworm" info --devices 2>/dev/null); then
		export LOOK_FOR_DEVICE=true
		if ! grep -qv llvmpipe <<<"$devices"; then
			export VK_LOADER_DRIVERS_SELECT='*lvp*' VK_LOADER_LAYERS_DISABLE='~implicit~'
		fi
	fi
done

# Programs that call a reader thousands of times keep what is freed below 64 MB: to give the end of
# the heap back to the system after each call and take it again was two thirds of test_damaged_las.
# The program itself runs as its users run it.
# Pages of 2 MB, where the system has them, save a tenth of the faults' time.
keep_heap=glibc.malloc.trim_threshold=67108864:glibc.malloc.mmap_threshold=33554432
keep_heap+=:glibc.malloc.hugetlb=1

# shellcheck source=tests/seconds_spent
. "$root/tests/seconds_spent"
passed=0 failed=0 skipped=0

count_lines() { # pattern file
	grep -ac -- "$1" "$2" || true
}

# ---------------------------------------------------------------------------- what there is to do

# The sources of the tests of a group.
list_tests() { # build group
	case $2 in
	unit | physics | hostile) compgen -G "tests/$2/test_*.c*" ;;
	shaders)
		printf 'tests/physics/test_%s.c\n' boundaries leaks shadow_map portals glossy gloss_caches
		;;
	cli)
		case $1 in
		*sanitize*) grep -L '^# sanitize: no$' tests/cli/*.sh ;;
		*) ls tests/cli/*.sh ;;
		esac
		;;
	interop) ls tests/interop/*.sh ;;
	torture) echo tests/torture/torture_main.c ;;
	lint) ls tests/lint/{test,check}_*.sh ;;
	style)
		printf 'tests/lint/check_%s.sh\n' banned format layers readme scripts style symbols
		;;
	quick-*) list_tests "$1" "${2#*-}" | grep -vxFf tests/slow_tests ;;
	chosen-*) list_tests "$1" "${2#*-}" | grep -vxFf tests/not_sanitized ;;
	other-*)
		list_tests "$1" "${2#*-}" | grep -vxFf <(list_tests build/sanitize "chosen-${2#*-}")
		;;
	*) return 1 ;;
	esac
}

# What runs a test of a group.
runner_of() { # group
	case ${1#*-} in
	cli | interop) echo run_cli ;;
	torture) echo run_torture ;;
	lint | style) echo run_lint ;;
	shaders) echo run_shaders ;;
	*) echo run_program ;;
	esac
}

# A line for each test: when it is its turn, its number and group's, runner, build and source.
# Those that measure time come last.
list_jobs() { # BUILD:GROUP...
	local item number=0
	for item in "$@"; do
		list_tests "${item%:*}" "${item##*:}" |
			sed "s|^|$number $(runner_of "${item##*:}") ${item%:*} |"
		number=$((number + 1))
	done | awk -v alone=" $(grep -l '^# alone: yes$' tests/cli/*.sh | tr '\n' ' ')" '
		FILENAME != "-" { if (!/^#/) turn[$1] = ++slow; next }
		{ print index(alone, " " $4 " ") ? "alone" : $4 in turn ? turn[$4] : slow + 1, FNR, $0 }
		' tests/slow_tests - | sort -s -n -k 1,1
}

# ------------------------------------------------------------------------------- how it is done

# Runs a command so that it ends when this job does; what it says goes to the job's log.
watch() { # seconds command...
	timeout --kill-after=10 "$@" >"$log" 2>&1 </dev/null &
	trap "kill $! 2>/dev/null; exit 143" TERM
	wait $!
	status=$?
	[ "$status" -eq 124 ] && echo "it ran into the limit of $1 seconds" >>"$log"
}

# The closing line of another runner, `N passed, N failed`; without one it has failed.
read_closing() {
	local closing
	closing=$(tail -n 1 "$log" | sed -n 's/^\([0-9]*\) passed, \([0-9]*\) failed.*/\1 \2/p')
	[ -n "$closing" ] || tail -n 5 "$log"
	read -r good bad <<<"${closing:-0 1}"
	[ "$status" -ne 0 ] && [ "$bad" -eq 0 ] && bad=1
}

# One cmocka program. One that crashes or leaks has at least one failure, and the test it was in
# when it crashed counts as failed.
run_program() { # build source
	local program=$1/${2%.*} started
	if [ ! -x "$program" ]; then
		echo "FAIL $program was not built"
		bad=1
		return
	fi
	GLIBC_TUNABLES=$keep_heap watch "$limit" "$program"
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
	[ "$skips" -eq 0 ] || echo "   $program: $skips skipped"
	if [ "$bad" -ne 0 ]; then
		echo "FAIL $program: exit status $status"
		grep -av '^\[ RUN      \]\|^\[       OK \]' "$log" | head -n 120 | sed 's/^/   /'
	fi
}

run_shaders() { # build source
	export GLOWWORM_TEST_PASSES=device GLOWWORM_TEST_VALIDATE=calls
	run_program "$@"
}

run_cli() { # build source
	GLOWWORM=$1/glowworm watch "$limit" tests/cli/run "$2"
	skips=$(count_lines '^SKIP ' "$log")
	[ "${GLOWWORM_NO_SKIP:-0}" = 1 ] && skips=0
	sed -e '$d' -e '/^[0-9]* skipped$/d' "$log"
	read_closing
}

# A failure's first line names it, its second the command that repeats it.
run_torture() { # build
	if [ ! -x "$1/tests/torture/torture" ]; then
		echo "FAIL $1/tests/torture/torture was not built"
		bad=1
		return
	fi
	# Hundreds of launches, each of which has a limit of its own: this one is for a busy machine.
	watch $((3 * limit)) "$1/tests/torture/torture" --slice --jobs 1 --program "$1/glowworm" \
		--folder "$scratch/torture"
	grep -a -A 1 '^FAIL' "$log" | head -n 60
	read_closing
}

run_lint() { # build source
	BUILD=$1 watch "$limit" bash "$2"
	if [ "$status" -eq 0 ]; then
		good=1
	else
		bad=1
		echo "FAIL $2"
		head -n 60 "$log" | sed 's/^/   /'
	fi
}

# Does one job and leaves a line of what came of it: group, passed, failed, skipped, seconds, what.
run_job() { # number group runner build source
	local log=$scratch/$1.log good=0 bad=0 skips=0 status spent
	case $4 in
	*sanitize*) export ASAN_OPTIONS="$asan" ;;
	*) unset ASAN_OPTIONS ;;
	esac
	"$3" "$4" "$5" >"$log.said"
	cat "$log.said"
	rm -f "$log" "$log.said"
	seconds_spent
	echo "$2 $good $bad $skips $spent $4 $5" >"$scratch/$1.result"
}

# ---------------------------------------------------------------------------------- what came of it

# The line of a group, and what it adds to the sums.
count_group() { # number name jobs
	local good bad skips seconds results
	results=$(cat "$scratch"/*.result 2>/dev/null | grep "^$1 ")
	# What left no result was killed.
	read -r good bad skips seconds < <(awk -v jobs="$3" '
		NF { g += $2; b += $3; k += $4; s += $5; jobs-- }
		END { print g + 0, b + jobs, k + 0, s + 0.5 }' <<<"$results")
	printf '%-30s %5d passed %4d failed %5d s\n' "$2" "$good" "$bad" "${seconds%.*}"
	passed=$((passed + good)) failed=$((failed + bad)) skipped=$((skipped + skips))
}

for item in "$@"; do
	if [[ $item != *:other-* ]] && [ -z "$(list_tests "${item%:*}" "${item##*:}")" ]; then
		echo "tests/suite.sh: there is no group ${item##*:}" >&2
		exit 2
	fi
done
list_jobs "$@" >"$scratch/jobs"
while read -r turn job; do
	[ "$turn" = alone ] && continue
	while [ "$(jobs -rp | wc -l)" -ge "$(($(nproc) + 1))" ]; do wait -n; done
	# shellcheck disable=SC2086
	run_job $job &
done <"$scratch/jobs"
wait
while read -r turn job; do
	[ "$turn" = alone ] || continue
	# shellcheck disable=SC2086
	run_job $job &
	wait
done <"$scratch/jobs"
number=0
for item in "$@"; do
	count_group "$number" "${item%:*} ${item##*:}" \
		"$(grep -c "^[a-z0-9]* [0-9]* $number " "$scratch/jobs")"
	number=$((number + 1))
done
sort -rn -k 5,5 "$scratch"/*.result | awk '{ print $5, $6, $7 }' >"$scratch/seconds"
echo "took longest, seconds of the processor:"
head -n 12 "$scratch/seconds" | awk '{ printf "%6.0f %s %s\n", $1, $2, $3 }'
[ -z "${GLOWWORM_TEST_SECONDS:-}" ] || cp "$scratch/seconds" "$GLOWWORM_TEST_SECONDS"
[ "$skipped" -eq 0 ] || echo "$skipped skipped"
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ] && [ "$passed" -gt 0 ]
