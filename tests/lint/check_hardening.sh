#!/usr/bin/env bash
# The program and its plugins are built so that a fault of ours is hard to use: position
# independent, no code on the stack, addresses of functions read-only once it runs, guarded stacks,
# checked copies, and on x86 landing pads for indirect calls. Looks at BUILD/glowworm and
# BUILD/libglowworm-*.so, BUILD being build unless set; a sanitized build is no release. And the
# program loads at each start only what each start needs.
# shellcheck source=tests/lint/tree_files
. "$(dirname "$0")/tree_files"
build=${BUILD:-build}

# What a linked file says of itself, in words of readelf.
check_linked() { # file
	local file=$1 segments dynamic
	segments=$(readelf -hlW "$file")
	dynamic=$(readelf -dW "$file")
	grep -q 'Type: *DYN' <<<"$segments" || echo "$file: is not position independent (-pie)"
	grep -q GNU_RELRO <<<"$segments" || echo "$file: has no read-only relocations (-z relro)"
	grep -qE 'BIND_NOW|FLAGS_1.* NOW' <<<"$dynamic" || echo "$file: binds lazily (-z now)"
	grep -qE 'GNU_STACK .* RW +0x' <<<"$segments" ||
		echo "$file: has an executable stack (-z noexecstack)"
}

# The compiler writes into the debug information how each file was compiled.
check_compiled() { # file
	local file=$1 producers flag
	producers=$(readelf --debug-dump=info "$file" 2>/dev/null |
		sed -n 's/.*DW_AT_producer[^:]*: //p' | grep -v 'GNU AS')
	[ -n "$producers" ] || echo "$file: says nothing of how it was compiled (-g)"
	for flag in -fstack-protector-strong -fstack-clash-protection $cf_protection; do
		[ -z "$producers" ] || ! grep -qvF -e "$flag" <<<"$producers" ||
			echo "$file: has code without $flag"
	done
	if ! nm -D "$file" | grep -q ' __stack_chk_fail@'; then
		echo "$file: has no guarded stacks"
	fi
}

# Copies are checked when glibc's checking functions are called; level 3 is what the flags say.
check_fortified() {
	nm -D "$build/glowworm" | grep -qE ' __(mem|str|v?snprintf)[a-z]*_chk@' ||
		echo "$build/glowworm: calls no checked copies (-D_FORTIFY_SOURCE)"
	grep -qaE -e '-D_FORTIFY_SOURCE=[3-9]' "$build/glowworm" || [ "$level" != 3 ] ||
		echo "$build/glowworm: was built with less than -D_FORTIFY_SOURCE=3"
}

# Libraries that take long to load come with a plugin, when it is needed.
check_loaded() {
	local library
	for library in openvdb proj mpi; do
		! readelf -dW "$build/glowworm" | grep -q "NEEDED.*lib$library" ||
			echo "$build/glowworm: loads lib$library at each start, which a plugin is for"
	done
}

# What this compiler and processor know.
cf_protection=
level=2
if gcc -fcf-protection -fsyntax-only -x c /dev/null 2>/dev/null; then
	cf_protection=-fcf-protection
fi
if gcc -O2 -D_FORTIFY_SOURCE=3 -Werror -include stdio.h -fsyntax-only -x c /dev/null \
	2>/dev/null; then
	level=3
fi

for file in "$build"/glowworm "$build"/libglowworm-{vdb,proj}.so; do
	if [ ! -f "$file" ]; then
		echo "$file is not there; build it with make"
		exit 66
	fi
done
if nm -D "$build/glowworm" | grep -q __asan_init; then
	exit 0
fi
plugins=("$build"/libglowworm-{vdb,proj}.so)
# Built only where Open MPI is.
[ ! -f "$build/libglowworm-mpi.so" ] || plugins+=("$build/libglowworm-mpi.so")
for file in "$build"/glowworm "${plugins[@]}"; do
	complain < <(check_linked "$file")
	complain < <(check_compiled "$file")
done
complain < <(check_fortified)
complain < <(check_loaded)
finish
