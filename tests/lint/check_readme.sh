#!/usr/bin/env bash
# Each folder's README.md names every source file of the folder, and no file that is gone. A
# folder below tests/ may be described in its own README.md or in that of tests/; a shell test in
# tests/cli says itself what it is for, in its first comment.
# shellcheck source=tests/lint/tree_files
. "$(dirname "$0")/tree_files"

# The README that has to name a file, into `readme`: in its folder, or the nearest one above that is
# not the root. And what it says, which is read once.
declare -A text_of=()
readme_of() { # file
	local folder=${1%/*}
	while [ ! -f "$folder/README.md" ]; do
		case $folder in
		*/*) folder=${folder%/*} ;;
		*) break ;;
		esac
	done
	readme=$folder/README.md
	if [ -z "${text_of[$readme]+read}" ]; then
		text_of[$readme]=$(cat "$readme" 2>/dev/null)
	fi
}

check_named() {
	local file readme
	while read -r file; do
		[[ $file = */* && $file != tests/cli/*.sh ]] || continue
		readme_of "$file"
		if [ ! -f "$readme" ]; then
			echo "$file: there is no $readme to name it"
		elif [[ ${text_of[$readme]} != *"\`${file##*/}\`"* ]]; then
			echo "$readme: does not name ${file##*/}"
		fi
	done < <(list_sources)
}

check_scripts_comment() {
	list_sources | grep '^tests/cli/.*\.sh$' | tr '\n' '\0' | xargs -0r awk '
		FNR == 1 { seen[FILENAME] = 0 }
		FNR <= 12 && /^# ../ { seen[FILENAME] = 1 }
		END { for (file in seen) if (!seen[file]) print file ": begins with no comment" }'
}

# Names in back quotes that look like source files have to be files below the README's folder.
check_stale() {
	local file folder readme name
	local -A below=()
	while read -r file; do
		folder=$file
		while [[ $folder = */* ]]; do
			folder=${folder%/*}
			below[$folder/${file##*/}]=yes
		done
	done < <(list_files)
	while IFS=: read -r readme name; do
		[ -n "${below[${readme%/*}/$name]:-}" ] ||
			echo "$readme: names $name, which is not in ${readme%/*}/"
	done < <(list_files | grep -E '^(cli|lib|formats|shaders|samples|tests|man)/(.*/)?README\.md$' |
		tr '\n' '\0' |
		xargs -0r grep -HoE '`[A-Za-z0-9_.-]+\.(c|h|cpp|hpp|comp|glsl|sh)`' | tr -d '`')
}

complain < <(check_named)
complain < <(check_scripts_comment)
complain < <(check_stale)
finish
