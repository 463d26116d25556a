#!/usr/bin/env bash
# Shell scripts parse, and those that people run can be executed.
# shellcheck source=tests/lint/tree_files
. "$(dirname "$0")/tree_files"

check_scripts() {
	local file
	list_files | grep -E '\.sh$|(^|/)run$' | while read -r file; do
		if head -n 1 "$file" | grep -q bash; then
			bash -n "$file" 2>&1
		else
			sh -n "$file" 2>&1
		fi
		case $file in
		samples/* | tests/*/run | .ci/run | tests/*.sh)
			case $file in
			tests/*/*.sh) continue ;;
			esac
			[ -x "$file" ] || echo "$file: is not executable"
			;;
		esac
	done
}

complain < <(check_scripts)
finish
