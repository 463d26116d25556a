#!/usr/bin/env bash
# Clang's analyzer finds nothing in the program: the build keeps what it says of each source file in
# BUILD/analysis, BUILD being build unless set. What is no fault is said in the code, with an
# assertion where something always holds. kernel.cpp is analysed with the text of each pass.
# shellcheck source=tests/lint/tree_files
. "$(dirname "$0")/tree_files"
build=${BUILD:-build}

check_findings() {
	local file
	list_sources | grep -E '^(lib|formats|cli|samples)/.*\.(c|cpp)$' | while read -r file; do
		if [ "${file##*/}" = kernel.cpp ]; then
			find "$build/analysis/kernels" -name '*.txt' -exec cat {} + ||
				echo "$file: was not analysed; run make lint"
		elif [ ! -f "$build/analysis/$file.txt" ]; then
			echo "$file: was not analysed; run make lint"
		else
			cat "$build/analysis/$file.txt"
		fi
	done
}

complain < <(check_findings)
finish
