#!/usr/bin/env bash
# What the library defines for the linker begins with gw_. Instances of C++ templates are weak and
# mangled, so they clash with nothing. Looks at BUILD/libglowworm.a, BUILD being build unless set.
# shellcheck source=tests/lint/tree_files
. "$(dirname "$0")/tree_files"
library=${BUILD:-build}/libglowworm.a

check_symbols() {
	nm -g --defined-only "$library" 2>/dev/null |
		awk 'NF == 3 && $3 !~ /^gw_/ && !($2 ~ /[WVu]/ && $3 ~ /^_Z/) && $3 !~ /^DW\.ref\./ {
			print $3 ": a global symbol of the library without gw_" }' | sort -u
}

if [ ! -f "$library" ]; then
	echo "$library is not there; build it with make"
	exit 66
fi
if ! nm -g --defined-only "$library" 2>/dev/null | grep -q ' T gw_'; then
	echo "$library: defines no function at all"
	exit 1
fi
complain < <(check_symbols)
finish
