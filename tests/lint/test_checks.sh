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

# Puts faults into a clean tree, each a pair of words and the command that makes it, and wants the
# check to fail and to say all the words. A check takes a second, so that faults which have nothing
# to do with each other are put in together, each into files of its own or words of its own.
expect_faults() { # check (words command)...
	local check=$1 i
	shift
	make_tree
	for ((i = 2; i <= $#; i += 2)); do
		eval "${!i}"
	done
	if [ "$check" = symbols ]; then build_library; fi
	if run_check "$check"; then
		echo "check_$check.sh sees none of: $*"
		bad=1
		return
	fi
	for ((i = 1; i <= $#; i += 2)); do
		grep -qF -- "${!i}" "$scratch/found" && continue
		echo "check_$check.sh does not say '${!i}' of: $*"
		cat "$scratch/found"
		bad=1
	done
}

make_tree
build_library
for check in readme layers style format symbols scripts banned analysis; do
	expect_clean "$check"
done
build_program '' ''
expect_clean hardening

expect_faults readme 'does not name three.c' 'echo "int x;" >lib/three.c' \
	'names one.c, which is not' 'rm lib/one.c' \
	'there is no cli/README.md' 'echo "int x;" >cli/four.c' \
	'begins with no comment' 'echo "echo 1" >tests/cli/prints.sh'

expect_faults layers \
	'lib/one.c: includes two.h' 'sed -i "2s/.*/#include \"two.h\"/" lib/one.c' \
	'includes light/up.h' 'mkdir lib/base lib/light
		echo "int x;" >lib/light/up.h; echo "#include \"light/up.h\"" >lib/base/low.c' \
	'formats/two.h: includes base/deep.h' 'echo "int x;" >lib/base/deep.h
		echo "#include \"base/deep.h\"" >>formats/two.h' \
	'lib/attic: is not in the list' 'mkdir lib/attic; echo "int x;" >lib/attic/old.c' \
	'formats/three.c: includes four.h' \
	'echo "int x;" >cli/four.h; echo "#include \"four.h\"" >formats/three.c' \
	'lib/one.c:8: prints' 'echo "void f(void) { printf(\"x\"); }" >>lib/one.c' \
	'lib/one.c:9: prints' 'echo "void f(void) { fprintf(stderr, \"x\"); }" >>lib/one.c' \
	'formats/two.h:5: prints' 'echo "void f(void) { exit(1); }" >>formats/two.h'
expect_faults layers 'lib/up: its source is in a circle' \
	'echo "#include \"up.h\"" >>lib/one.c; : >lib/up.h; echo "#include \"one.h\"" >lib/up.c'

expect_faults style \
	'lib/a.h:1: blanks at the end' 'printf "int x; \n" >lib/a.h' \
	'lib/b.h: no newline' 'printf "int x;" >lib/b.h' \
	'lib/c.h:1: 101 columns' 'printf "/* %95s */\n" x | tr " " - >lib/c.h' \
	'lib/d.c:3: indented with blanks' 'printf "int f(void)\n{\n    return 1;\n}\n" >lib/d.c' \
	'lib/e.h:1: not ASCII' 'printf "/* \303\251 */\n" >lib/e.h' \
	'lib/README.md:3: an invisible character' 'printf "a\342\200\213b\n" >>lib/README.md' \
	'lib/README.md:4: a control character' 'printf "a\rb\n" >>lib/README.md' \
	'one.h: more than one file' 'cp lib/one.h formats/one.h' \
	'lib/Three.h: a file name with upper case' 'echo "int x;" >lib/Three.h' \
	'lib/a b.h: a file name with odd characters' 'echo "int x;" >"lib/a b.h"' \
	'lib/f.c:2: a function of 103 lines' \
	'{ echo "void f(void)"; echo "{"; yes "	;" | head -n 101; echo "}"; } >lib/f.c' \
	'lib/one.c:8: a function of 7 parameters' \
	'echo "int f(int a, int b, int (*c)(int, int), int d, int e, int g, int h);" >>lib/one.c'

expect_faults format 'lib/one.c:8' 'echo "int  two(void);" >>lib/one.c'

expect_faults symbols 'two: a global' 'echo "int two(void) { return 2; }" >>lib/one.c' \
	'gw_three: the shared library shows it' 'echo "int gw_three(void) { return 3; }" >>lib/one.c' \
	'gw_four: a public header declares it' 'echo "int gw_four(void);" >>lib/one.h' \
	'counter: a global' 'echo "int counter = 1;" >>lib/one.c'
expect_faults symbols 'no function' 'echo "static int x;" >lib/one.c'

# Faults of linking, and of compiling; each has words of its own.
expect_faults hardening 'not position independent' "flags='-no-pie'" \
	'no read-only relocations' "flags+=' -Wl,-z,norelro'" \
	'binds lazily' "flags+=' -Wl,-z,lazy'" \
	'an executable stack' "flags+=' -Wl,-z,execstack'" \
	'loads libproj' "build_program '' \"\$flags -Wl,--no-as-needed -lproj\""
whole=$safe
without=${safe/-fstack-protector-strong -fstack-clash-protection -fcf-protection/}
expect_faults hardening 'code without -fstack-protector-strong' 'safe=$without' \
	'code without -fstack-clash-protection' ":" \
	'code without -fcf-protection' "build_program '' ''"
safe=$whole
expect_faults hardening 'no guarded stacks' ":" \
	'calls no checked copies' ":" \
	'less than -D_FORTIFY_SOURCE=3' "safe=\${whole/=3/=2}" \
	'how it was compiled' "build_program '-fno-stack-protector -D_FORTIFY_SOURCE=0 -g0' ''"
safe=$whole
expect_faults hardening 'is not there' 'rm -f build/glowworm'

expect_faults banned 'lib/one.c:8' 'echo "void f(char *a, char *b) { strcpy(a, b); }" >>lib/one.c' \
	'system(""); }   <- banned' 'echo "int f(void) { return system(\"ls\"); }" >>cli/three.c' \
	'a product as a size' \
	'echo "void *f(int a, int b) { return malloc(a * b); }" >>formats/three.c'

expect_faults analysis 'Division by zero' 'echo "lib/one.c:6:10: warning: Division by zero" \
	>build/analysis/lib/one.c.txt' \
	'lib/two.c: was not analysed' 'echo "int x;" >lib/two.c'

expect_faults scripts 'not executable' 'chmod -x tests/cli/run' \
	'unexpected' 'echo "if true; then" >>tests/cli/prints.sh'

[ "$bad" -eq 0 ]
