#!/usr/bin/env bash
# Each folder's README.md names every source file of the folder, and no file that is gone. A
# folder below tests/ may be described in its own README.md or in that of tests/; a shell test in
# tests/cli says itself what it is for, in its first comment.
# shellcheck source=tests/lint/tree_files
. "$(dirname "$0")/tree_files"

# The README that has to name a file: in its folder, or the nearest one above that is not the root.
readme_of() { # file
	local folder=${1%/*}
	while [ ! -f "$folder/README.md" ]; do
		case $folder in
		*/*) folder=${folder%/*} ;;
		*) break ;;
		esac
	done
	echo "$folder/README.md"
}

check_named() {
	local file readme
	list_sources | while read -r file; do
		case $file in
		tests/cli/*.sh)
			sed -n 1,12p "$file" | grep -q '^# ..' || echo "$file: begins with no comment"
			continue
			;;
		*/*) ;;
		*) continue ;;
		esac
		readme=$(readme_of "$file")
		if [ ! -f "$readme" ]; then
			echo "$file: there is no $readme to name it"
		elif ! grep -q -F "\`${file##*/}\`" "$readme"; then
			echo "$readme: does not name ${file##*/}"
		fi
	done
}

# Names in back quotes that look like source files have to be files below the README's folder.
check_stale() {
	local readme folder name files
	files=$(list_files)
	grep -E '^(cli|lib|formats|shaders|samples|tests|man)/(.*/)?README\.md$' <<<"$files" |
		while read -r readme; do
			folder=${readme%/*}
			grep -oE '`[A-Za-z0-9_.-]+\.(c|h|cpp|hpp|comp|glsl|sh)`' "$readme" | tr -d '`' |
				while read -r name; do
					grep -qE "^$folder/(.*/)?$name\$" <<<"$files" ||
						echo "$readme: names $name, which is not in $folder/"
				done
		done
}

complain < <(check_named)
complain < <(check_stale)
finish
