#!/usr/bin/env bash
# The checks in this folder find what they look for: a clean small tree passes each of them, and
# the same tree with one fault put in fails the check that is meant for it, with the right words.
set -u
here=$(cd "$(dirname "$0")" && pwd)
scratch=$(mktemp -d "${TMPDIR:-/tmp}/glowworm-lint.XXXXXX") || exit 70
trap 'rm -rf "$scratch"' EXIT
bad=0

make_tree() {
	rm -rf "$scratch/tree"
	mkdir -p "$scratch"/tree/{lib,formats,cli,shaders,tests/cli,build}
	cd "$scratch/tree" || exit 70
	cp "$here/../../.clang-format" .
	printf 'int gw_one(void);\n' >lib/one.h
	printf '#include "one.h"\n\n/* exit(1) */\nint gw_one(void)\n{\n\treturn 1;\n}\n' >lib/one.c
	printf '# lib\n- `one.h` `one.c` one\n' >lib/README.md
	printf '#include "one.h"\n\nint two(void);\n' >formats/two.h
	printf '# formats\n- `two.h` two\n' >formats/README.md
	printf '# Prints one.\necho 1\n' >tests/cli/prints.sh
	printf '#!/bin/sh\necho 1\n' >tests/cli/run
	mkdir -p build/analysis/lib && : >build/analysis/lib/one.c.txt
	chmod +x tests/cli/run
}

build_library() {
	gcc -fPIC -c -o build/one.o lib/one.c && rm -f build/libglowworm.a &&
		ar rcs build/libglowworm.a build/one.o &&
		gcc -shared -o build/libglowworm.so build/one.o
}

# A program and a plugin that are built as the real ones are; flags that follow undo one.
safe='-g -O2 -fPIC -fstack-protector-strong -fstack-clash-protection -fcf-protection'
safe+=' -U_FORTIFY_SOURCE -D_FORTIFY_SOURCE=3'
linked='-Wl,-z,relro,-z,now,-z,noexecstack'
build_program() { # compiling linking
	cat >cli/main.c <<-'END'
		#include <stdio.h>
		#include <string.h>
		int main(int count, char **argument)
		{
			char text[16];
			strcpy(text, argument[count - 1]);
			return puts(text) + puts(FLAGS);
		}
	END
	# shellcheck disable=SC2086
	gcc -DFLAGS="\"$safe $1\"" $safe $1 -pie $linked $2 -o build/glowworm cli/main.c 2>/dev/null &&
		gcc -DFLAGS='""' $safe $linked -shared -o build/libglowworm-vdb.so cli/main.c &&
		cp build/libglowworm-vdb.so build/libglowworm-proj.so
}

run_check() { # check
	BUILD=build bash "$here/check_$1.sh" "$scratch/tree" >"$scratch/found" 2>&1
}

expect_clean() { # check
	if ! run_check "$1"; then
		echo "check_$1.sh complains about a clean tree:"
		cat "$scratch/found"
		bad=1
	fi
}

# Puts a fault into a clean tree and wants the check to fail and to say so.
expect_fault() { # check words command...
	local check=$1 words=$2
	shift 2
	make_tree
	eval "$*"
	if [ "$check" = symbols ]; then build_library; fi
	if run_check "$check"; then
		echo "check_$check.sh does not see: $*"
		bad=1
	elif ! grep -qF -- "$words" "$scratch/found"; then
		echo "check_$check.sh fails without saying '$words' after: $*"
		cat "$scratch/found"
		bad=1
	fi
}

make_tree
build_library
for check in readme layers style format symbols scripts banned analysis; do
	expect_clean "$check"
done
build_program '' ''
expect_clean hardening

expect_fault readme 'does not name three.c' 'echo "int x;" >lib/three.c'
expect_fault readme 'names one.c, which is not' 'rm lib/one.c'
expect_fault readme 'there is no cli/README.md' 'echo "int x;" >cli/three.c'
expect_fault readme 'begins with no comment' 'echo "echo 1" >tests/cli/prints.sh'

expect_fault layers 'includes two.h' 'echo "#include \"two.h\"" >>lib/one.c'
expect_fault layers 'includes light/up.h' 'mkdir lib/base lib/light
	echo "int x;" >lib/light/up.h; echo "#include \"light/up.h\"" >lib/base/low.c'
expect_fault layers 'includes base/low.h' 'mkdir lib/base; echo "int x;" >lib/base/low.h
	echo "#include \"base/low.h\"" >>formats/two.h'
expect_fault layers 'lib/up: its source is in a circle' 'echo "#include \"up.h\"" >>lib/one.c
	: >lib/up.h; echo "#include \"one.h\"" >lib/up.c'
expect_fault layers 'lib/attic: is not in the list' \
	'mkdir lib/attic; echo "int x;" >lib/attic/old.c'
expect_fault layers 'includes four.h' \
	'echo "int x;" >cli/four.h; echo "#include \"four.h\"" >>formats/two.h'
expect_fault layers 'lib/one.c:8: prints' 'echo "void f(void) { printf(\"x\"); }" >>lib/one.c'
expect_fault layers 'prints' 'echo "void f(void) { fprintf(stderr, \"x\"); }" >>lib/one.c'
expect_fault layers 'prints' 'echo "void f(void) { exit(1); }" >>formats/two.h'

expect_fault style 'blanks at the end' 'printf "int x; \n" >>lib/one.h'
expect_fault style 'no newline' 'printf "int x;" >>lib/one.h'
expect_fault style '101 columns' 'printf "/* %95s */\n" x | tr " " - >>lib/one.h'
expect_fault style 'indented with blanks' 'printf "int f(void)\n{\n    return 1;\n}\n" >>lib/one.c'
expect_fault style 'not ASCII' 'printf "/* \303\251 */\n" >>lib/one.h'
expect_fault style 'an invisible character' 'printf "a\342\200\213b\n" >>lib/README.md'
expect_fault style 'a control character' 'printf "a\rb\n" >>lib/README.md'
expect_fault style 'more than one file' 'cp lib/one.h formats/one.h'
expect_fault style 'upper case' 'echo "int x;" >lib/Three.h'
expect_fault style 'odd characters' 'echo "int x;" >"lib/a b.h"'
expect_fault style 'a function of 103 lines' \
	'{ echo "void f(void)"; echo "{"; yes "	;" | head -n 101; echo "}"; } >>lib/one.c'
expect_fault style 'lib/one.c:8: a function of 7 parameters' \
	'echo "int f(int a, int b, int (*c)(int, int), int d, int e, int g, int h);" >>lib/one.c'

expect_fault format 'lib/one.c:8' 'echo "int  two(void);" >>lib/one.c'

expect_fault symbols 'two: a global' 'echo "int two(void) { return 2; }" >>lib/one.c'
expect_fault symbols 'no function' 'echo "static int x;" >lib/one.c'
expect_fault symbols 'gw_two: the shared library shows it' \
	'echo "int gw_two(void) { return 2; }" >>lib/one.c'
expect_fault symbols 'gw_two: a public header declares it' 'echo "int gw_two(void);" >>lib/one.h'
expect_fault symbols 'counter: a global' 'echo "int counter = 1;" >>lib/one.c'

expect_fault hardening 'not position independent' 'build_program "" -no-pie'
expect_fault hardening 'no read-only relocations' 'build_program "" -Wl,-z,norelro'
expect_fault hardening 'binds lazily' 'build_program "" -Wl,-z,lazy'
expect_fault hardening 'an executable stack' 'build_program "" -Wl,-z,execstack'
for flag in -fstack-protector-strong -fstack-clash-protection -fcf-protection; do
	expect_fault hardening "code without $flag" \
		"whole=\$safe; safe=\${safe/$flag/}; build_program '' ''; safe=\$whole"
done
expect_fault hardening 'no guarded stacks' 'build_program -fno-stack-protector ""'
expect_fault hardening 'calls no checked copies' 'build_program -D_FORTIFY_SOURCE=0 ""'
expect_fault hardening 'less than -D_FORTIFY_SOURCE=3' \
	'safe=${safe/=3/=2}; build_program "" ""; safe=${safe/=2/=3}'
expect_fault hardening 'how it was compiled' 'build_program -g0 ""'
expect_fault hardening 'loads libproj' 'build_program "" "-Wl,--no-as-needed -lproj"'
expect_fault hardening 'is not there' 'rm -f build/glowworm'

expect_fault banned 'lib/one.c:8' 'echo "void f(char *a, char *b) { strcpy(a, b); }" >>lib/one.c'
expect_fault banned 'banned' 'echo "int f(void) { return system(\"ls\"); }" >>cli/three.c'
expect_fault banned 'a product as a size' \
	'echo "void *f(int a, int b) { return malloc(a * b); }" >>formats/three.c'

expect_fault analysis 'Division by zero' 'echo "lib/one.c:6:10: warning: Division by zero" \
	>build/analysis/lib/one.c.txt'
expect_fault analysis 'lib/two.c: was not analysed' 'echo "int x;" >lib/two.c'

expect_fault scripts 'not executable' 'chmod -x tests/cli/run'
expect_fault scripts 'unexpected' 'echo "if true; then" >>tests/cli/prints.sh'

[ "$bad" -eq 0 ]
