#!/usr/bin/env bash
# Calls that have no place in a program that reads hostile files: copies without a length, reading
# without one, names of temporary files that another may take, running other programs (there is no
# shell anywhere), numbers without a way to fail, and sizes of memory that are multiplied by hand,
# where reallocarray, calloc and lib/base/memory.h see an overflow.
# shellcheck source=tests/lint/tree_files
. "$(dirname "$0")/tree_files"

# Comments and texts do not count; line numbers stay right.
code_of() { # file
	gcc -fpreprocessed -dD -E -x c "$1" 2>/dev/null |
		awk -v file="$1" '
			/^# [0-9]+ "/ { line = $2 - 1; next }
			{ line++; gsub(/"([^"\\]|\\.)*"/, "\"\""); print file ":" line ": " $0 }'
}

check_banned() {
	local file calls='sprintf|vsprintf|strcpy|stpcpy|strcat|strncpy|strncat|gets|strtok|alloca'
	calls+='|system|popen|execl|execlp|execle|execv|execvp|execvpe|execve|fexecve|posix_spawnp?'
	calls+='|mktemp|tmpnam|tempnam|tmpfile|atoi|atol|atoll|atof'
	list_sources | grep -E '^(lib|formats|cli|samples)/.*\.(c|h|cpp)$' | while read -r file; do
		code_of "$file" | awk -v calls="$calls" '
			match($0, "(^|[^A-Za-z0-9_])(" calls ") *[(]") { print $0 "   <- banned" }
			# A product as a size: an operator has blanks around it, a pointer has not.
			match($0, /(^|[^A-Za-z0-9_])(malloc|realloc)[(].* \* /) {
				print $0 "   <- a product as a size" }'
	done
}

complain < <(check_banned)
finish
