#!/usr/bin/env bash
# Style that a script can see: tabs for indentation, no trailing blanks, a final newline, lines of
# at most 100 columns (a tab counts 4), functions of at most 100 lines, ASCII in code, no invisible
# or direction-changing characters anywhere, and file names that are lower case and unique.
# shellcheck source=tests/lint/tree_files
. "$(dirname "$0")/tree_files"

list_text() {
	list_files |
		grep -E '\.(c|h|cpp|hpp|comp|glsl|sh|md|json|txt|[1-8])$|(^|/)(Makefile|run|tree_files)$'
}

check_lines() {
	local file
	list_text | while read -r file; do
		grep -nE '[[:blank:]]+$' "$file" | sed "s|^\([0-9]*\):.*|$file:\1: blanks at the end|"
		if [ -s "$file" ] && [ -n "$(tail -c 1 "$file")" ]; then
			echo "$file: no newline at the end"
		fi
		# Zero width, direction marks, line separators, no-break space, byte order mark, controls.
		grep -nP '[\x{00A0}\x{00AD}\x{200B}-\x{200F}\x{2028}-\x{202F}\x{2060}-\x{206F}\x{FEFF}]' \
			"$file" | sed "s|^\([0-9]*\):.*|$file:\1: an invisible character|"
		grep -nP '[\x01-\x08\x0B-\x1F\x7F]' "$file" |
			sed "s|^\([0-9]*\):.*|$file:\1: a control character|"
	done
}

# An indented line that follows the end of a statement or a brace has to begin with a tab; blanks
# only align what continues a line.
check_code() {
	local file
	list_sources | while read -r file; do
		LC_ALL=C grep -nP '[^\x00-\x7F]' "$file" |
			sed "s|^\([0-9]*\):.*|$file:\1: not ASCII|"
		expand -t 4 "$file" | awk -v file="$file" 'length($0) > 100 {
			printf "%s:%d: %d columns\n", file, NR, length($0) }'
		case $file in
		*.sh) continue ;;
		esac
		awk -v file="$file" '
			/^ +[^ *]/ && !/^ +(public|protected|private):/ && before ~ /[;{}]$/ {
				printf "%s:%d: indented with blanks\n", file, NR }
			/^\{/ { start = NR }
			/^\}/ && start {
				if (NR - start + 1 > 100)
					printf "%s:%d: a function of %d lines\n", file, start, NR - start + 1
				start = 0 }
			NF { before = $0 }' "$file"
	done
}

# README.md is in every folder. Makefile, LICENSE and the like at the root have the names that
# tools look for, as .ci/run and .github/SECURITY.md have.
check_names() {
	list_files | grep -vE '(^|/)README\.md$|^[^/]*$|^\.ci/' | sed 's|.*/||' | sort | uniq -d |
		sed 's|$|: more than one file has this name|'
	list_files | grep -vE '(^|/)README\.md$|^[^/]*$|^\.github/' | grep -E '[A-Z]' |
		sed 's|$|: a file name with upper case|'
	list_files | grep -E '[^A-Za-z0-9_./-]' | sed 's|$|: a file name with odd characters|'
}

complain < <(check_lines)
complain < <(check_code)
complain < <(check_names)
finish
