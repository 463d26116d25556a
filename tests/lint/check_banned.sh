#!/usr/bin/env bash
# Calls that have no place in a program that reads hostile files: copies without a length, reading
# without one, names of temporary files that another may take, running other programs (there is no
# shell anywhere), numbers without a way to fail, and sizes of memory that are multiplied by hand,
# where reallocarray, calloc and lib/base/memory.h see an overflow.
# shellcheck source=tests/lint/tree_files
. "$(dirname "$0")/tree_files"

check_banned() {
	local calls='sprintf|vsprintf|strcpy|stpcpy|strcat|strncpy|strncat|gets|strtok|alloca'
	calls+='|system|popen|execl|execlp|execle|execv|execvp|execvpe|execve|fexecve|posix_spawnp?'
	calls+='|mktemp|tmpnam|tempnam|tmpfile|atoi|atol|atoll|atof'
	list_sources | grep -E '^(lib|formats|cli|samples)/.*\.(c|h|cpp)$' | code_of_files |
		awk -v calls="$calls" '
			{ gsub(/"([^"\\]|\\.)*"/, "\"\"") } # what texts say does not count
			match($0, "(^|[^A-Za-z0-9_])(" calls ") *[(]") { print $0 "   <- banned" }
			# A product as a size: an operator has blanks around it, a pointer has not.
			match($0, /(^|[^A-Za-z0-9_])(malloc|realloc)[(].* \* /) {
				print $0 "   <- a product as a size" }'
}

complain < <(check_banned)
finish
