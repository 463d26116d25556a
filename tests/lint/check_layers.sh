#!/usr/bin/env bash
# Dependencies point one way: cli -> formats -> lib, and shaders share headers with lib. What lib
# and formats call neither prints to a standard stream nor ends the process.
# shellcheck source=tests/lint/tree_files
. "$(dirname "$0")/tree_files"

# Includes in quotes of a folder's files that are found in none of the folders allowed.
check_includes() { # folder allowed...
	local folder=$1 file name allowed found
	shift
	list_sources | grep -E "^$folder/.*\.(c|h|cpp|hpp)$" | while read -r file; do
		sed -n 's/^[ \t]*#[ \t]*include[ \t]*"\([^"]*\)".*/\1/p' "$file" | while read -r name; do
			case $name in
			*.inc) continue ;; # built from shaders/
			esac
			found=no
			for allowed in "$@"; do
				if [ -f "$allowed/$name" ]; then found=yes; fi
			done
			[ $found = yes ] || echo "$file: includes $name, which is not in $*"
		done
	done
}

# Comments do not count, so the preprocessor takes them out first; line numbers stay right.
check_silence() {
	local file calls='printf|vprintf|puts|putchar|perror|exit|_exit|quick_exit|abort'
	list_sources | grep -E '^(lib|formats)/.*\.(c|h|cpp|hpp)$' | while read -r file; do
		gcc -fpreprocessed -dD -E -x c "$file" 2>/dev/null | awk -v file="$file" -v calls="$calls" '
			/^# [0-9]+ "/ { line = $2 - 1; next }
			{ line++ }
			$0 ~ "(^|[^A-Za-z0-9_])(" calls ") *[(]" ||
			/(^|[^A-Za-z0-9_])(stdout|stderr)([^A-Za-z0-9_]|$)/ ||
			/std::(cout|cerr|clog)/ {
				printf "%s:%d: prints or ends the process: %s\n", file, line, $0
			}'
	done
}

complain < <(check_includes lib lib shaders)
complain < <(check_includes formats formats lib shaders)
complain < <(check_includes cli cli formats lib shaders)
complain < <(check_silence)
finish
