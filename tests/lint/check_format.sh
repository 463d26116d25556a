#!/usr/bin/env bash
# C and C++ are laid out as .clang-format says: `clang-format -i FILE` does it. Shaders are not,
# since clang-format knows no GLSL.
# shellcheck source=tests/lint/tree_files
. "$(dirname "$0")/tree_files"

check_format() {
	list_sources | grep -E '\.(c|h|cpp|hpp)$' | tr '\n' '\0' |
		xargs -0r clang-format --dry-run 2>&1 |
		sed -n '/Wclang-format-violations/s|^\([^:]*:[0-9]*\):.*|\1: not as clang-format has it|p'
}

complain < <(check_format)
finish
