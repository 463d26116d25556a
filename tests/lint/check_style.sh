#!/usr/bin/env bash
# Style that a script can see: tabs for indentation, no trailing blanks, a final newline, lines of
# at most 100 columns (a tab counts 4), functions of at most 100 lines and six
# parameters, ASCII in code, no invisible or direction-changing characters anywhere, and file
# names that are lower case and unique.
# shellcheck source=tests/lint/tree_files
. "$(dirname "$0")/tree_files"

list_text() {
	list_files |
		grep -E '\.(c|h|cpp|hpp|comp|glsl|sh|md|json|txt|[1-8])$|(^|/)(Makefile|run|tree_files)$'
}

# Lines of files, whose names come in, that match a pattern.
find_lines() { # words grep-options...
	local words=$1
	shift
	tr '\n' '\0' | xargs -0 grep -Hn "$@" -- | sed "s|^\([^:]*:[0-9]*\):.*|\1: $words|"
}

check_lines() {
	list_text | find_lines 'blanks at the end' -E -e '[[:blank:]]+$'
	# Zero width, direction marks, line separators, no-break space, byte order mark, controls.
	list_text | find_lines 'an invisible character' -P \
		-e '[\x{00A0}\x{00AD}\x{200B}-\x{200F}\x{2028}-\x{202F}\x{2060}-\x{206F}\x{FEFF}]'
	list_text | find_lines 'a control character' -P -e '[\x01-\x08\x0B-\x1F\x7F]'
	list_text | tr '\n' '\0' |
		xargs -0 perl -0777 -ne 'print "$ARGV: no newline at the end\n" if /[^\n]\z/'
}

# An indented line that follows the end of a statement or a brace has to begin with a tab; blanks
# only align what continues a line.
check_code() {
	list_sources | LC_ALL=C find_lines 'not ASCII' -P -e '[^\x00-\x7F]'
	list_sources | tr '\n' '\0' | xargs -0 awk '
		FNR == 1 { start = 0; before = ""; code = FILENAME !~ /\.sh$/ }
		{
			columns = 0
			parts = split($0, part, "\t")
			for (i = 1; i <= parts; i++)
				columns += length(part[i]) + (i < parts ? 4 - (columns + length(part[i])) % 4 : 0)
		}
		columns > 100 { printf "%s:%d: %d columns\n", FILENAME, FNR, columns }
		!code { next }
		/^ +[^ *]/ && !/^ +(public|protected|private):/ && before ~ /[;{}]$/ {
			printf "%s:%d: indented with blanks\n", FILENAME, FNR }
		/^\{/ { start = FNR }
		/^\}/ && start {
			if (FNR - start + 1 > 100)
				printf "%s:%d: a function of %d lines\n", FILENAME, start, FNR - start + 1
			start = 0 }
		NF { before = $0 }'
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

# Declarations and definitions begin in the first column. What has a leading `__` has the parameters
# that the C library gives it.
check_parameters() {
	list_sources | grep -E '\.(c|h|cpp)$' | tr '\n' '\0' | xargs -0 awk '
		FNR == 1 { depth = 0 }
		depth == 0 && /^[A-Za-z][^=;"]*[A-Za-z0-9_]\(/ && !/__[a-z_]*\(/ { start = FNR; commas = 0 }
		start || depth {
			line = $0
			gsub(/"[^"]*"|\047[^\047]*\047|\/\*[^*]*\*\//, "", line)
			for (i = 1; i <= length(line); i++) {
				c = substr(line, i, 1)
				depth += (c == "(") - (c == ")")
				commas += depth == 1 && c == ","
			}
			if (depth > 0)
				next
			if (commas > 5)
				printf "%s:%d: a function of %d parameters\n", FILENAME, start, commas + 1
			start = depth = 0
		}'
}

complain < <(check_lines)
complain < <(check_parameters)
complain < <(check_code)
complain < <(check_names)
finish
