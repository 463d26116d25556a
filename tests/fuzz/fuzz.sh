#!/usr/bin/env bash
# Fuzzes one reader: fuzz.sh BUILD READER MINUTES. Inputs are the tests' own small files and
# tests/fuzz/READER.corpus. Afterwards that file holds the smallest inputs that reach what was
# reached, and every input that made the reader fail; `make test` reads them all again.
# The last line says how many inputs were tried in how many seconds, and how many failed.
set -eu
build=$1 reader=${2:-} minutes=${3:-5}
cd "$(dirname "$0")/../.."
tool=$build/tests/fuzz/make_corpus
if ! "$tool" readers | grep -qx -- "$reader"; then
	echo "READER has to be one of: $("$tool" readers | tr '\n' ' ')" >&2
	exit 2
fi
corpus=tests/fuzz/$reader.corpus
work=$build/tests/fuzz/work/$reader
rm -rf "$work"
mkdir -p "$work/found" "$work/few" "$work/failed"
"$tool" unpack "$reader" "$corpus" "$work/found"

# A failure ends libFuzzer, so it begins again until the time is over, unless it fails as before.
export GLOWWORM_FUZZ_READER=$reader ASAN_OPTIONS=allocator_may_return_null=1
begin=$(date +%s) end=$(($(date +%s) + $(awk "BEGIN { print int(60 * $minutes) }"))) tried=0
while left=$((end - $(date +%s))) && [ "$left" -gt 0 ]; do
	failed=$(find "$work/failed" -type f | wc -l) good=yes
	"$build/tests/fuzz/fuzz" -max_total_time="$left" -timeout=20 -rss_limit_mb=2000 -max_len=6000 \
		-print_final_stats=1 -artifact_prefix="$work/failed/" "$work/found" >"$work/log" 2>&1 ||
		good=no
	[ "$good" = yes ] || grep -a -m 3 'ERROR\|SUMMARY\|refused' "$work/log" || true
	tried=$((tried + $(sed -n 's/^stat::number_of_executed_units: //p' "$work/log")))
	[ "$good" = yes ] || [ "$(find "$work/failed" -type f | wc -l)" -gt "$failed" ] || break
done
seconds=$(($(date +%s) - begin))

# Few: the smallest that fit into 16 KB, then the largest up to 24 KB, which reach deepest.
find "$work/found" -type f -size +4k -delete
"$build/tests/fuzz/fuzz" -merge=1 -timeout=20 -rss_limit_mb=2000 "$work/few" "$work/found" \
	>"$work/log" 2>&1
mapfile -t chosen < <(find "$work/few" -type f -printf '%s %p\n' | sort -n |
	awk '{ size[NR] = $1 + 4; name[NR] = $2 }
		END {
			for (i = 1; i <= NR && sum + size[i] < 16000; i++) { sum += size[i]; print name[i] }
			for (k = NR; k >= i; k--) if (sum + size[k] < 24000) { sum += size[k]; print name[k] }
		}')
mapfile -t failed < <(find "$work/failed" -type f | sort)
"$tool" pack "$corpus" "${chosen[@]}" "${failed[@]}"
echo "$reader: $tried inputs in $seconds s, ${#failed[@]} failed;" \
	"$corpus holds $((${#chosen[@]} + ${#failed[@]})) in $(stat -c %s "$corpus") bytes"
[ ${#failed[@]} -eq 0 ]
