#!/usr/bin/env bash
# What the library defines for the linker begins with gw_. Instances of C++ templates are weak and
# mangled, so they clash with nothing. What the shared library shows are the functions that the
# public headers, lib/*.h, declare: all of them and no others. Looks at BUILD/libglowworm.a and .so,
# BUILD being build unless set.
# shellcheck source=tests/lint/tree_files
. "$(dirname "$0")/tree_files"
library=${BUILD:-build}/libglowworm.a
shared=${BUILD:-build}/libglowworm.so

check_symbols() {
	nm -g --defined-only "$library" 2>/dev/null |
		awk 'NF == 3 && $3 !~ /^gw_/ && !($2 ~ /[WVu]/ && $3 ~ /^_Z/) && $3 !~ /^DW\.ref\./ {
			print $3 ": a global symbol of the library without gw_" }' | sort -u
}

# Without what follows an @, the version of a symbol, and the versions themselves.
list_shown() {
	nm -D --defined-only "$shared" | awk '$2 != "A" { sub(/@.*/, "", $3); print $3 }' | sort -u
}

# Names before a parenthesis, in declarations that are no types.
list_declared() {
	cat lib/*.h | gcc -E -P -Ilib -x c - | awk 'BEGIN { RS = ";" } !/^[ \t\n]*typedef/' |
		grep -oE '\bgw_[a-z0-9_]+\(' | tr -d '(' | sort -u
}

check_shown() {
	comm -23 <(list_shown) <(list_declared) |
		sed 's/$/: the shared library shows it, but no public header declares it/'
	comm -13 <(list_shown) <(list_declared) |
		sed 's/$/: a public header declares it, but the shared library does not show it/'
}

for file in "$library" "$shared"; do
	if [ ! -f "$file" ]; then
		echo "$file is not there; build it with make"
		exit 66
	fi
done
if ! nm -g --defined-only "$library" 2>/dev/null | grep -q ' T gw_'; then
	echo "$library: defines no function at all"
	exit 1
fi
complain < <(check_symbols)
complain < <(check_shown)
finish
