#!/usr/bin/env bash
# Dependencies point one way: cli -> formats -> lib, and shaders share headers with lib; within each
# of them a room uses only itself and the rooms before it. Of lib the others use the public headers.
# What lib and formats call neither prints to a standard stream nor ends the process.
# shellcheck source=tests/lint/tree_files
. "$(dirname "$0")/tree_files"

# The rooms of each folder, in the order of the data's way.
declare -A rooms=(
	[lib]="base device surfels octree light estimate picture bake"
	[formats]="files points ply text pcd e57 las meshes panoramas grids pictures table"
	[cli]="program options scene result pictures comparison verbs"
	[shaders]="base device octree light picture"
)

# Rooms that are not in the list, which the list would not hold to anything.
check_rooms() {
	local folder room
	for folder in "${!rooms[@]}"; do
		list_sources | sed -n "s|^$folder/\([^/]*\)/.*|\1|p" | sort -u | while read -r room; do
			case " ${rooms[$folder]} " in
			*" $room "*) ;;
			*) echo "$folder/$room: is not in the list of rooms of check_layers.sh" ;;
			esac
		done
	done
}

# The paths below which a file may include: its room and those before it, and other folders whole.
allowed_of() { # folder room others...
	local folder=$1 own=$2 room
	shift 2
	for room in ${rooms[$folder]}; do
		echo "$folder/$room"
		[ "$room" != "$own" ] || break
	done
	printf '%s\n' "$folder" "$@"
}

# Includes in quotes of a folder's files that are found in none of the places allowed.
check_includes() { # folder others...
	local folder=$1 file name place found allowed room
	shift
	list_sources | grep -E "^$folder/.*\.(c|h|cpp|hpp|comp|glsl)$" | while read -r file; do
		room=$(cut -d / -f 2 <<<"$file")
		allowed=$(allowed_of "$folder" "$room" "$@")
		sed -n 's/^[ \t]*#[ \t]*include[ \t]*"\([^"]*\)".*/\1/p' "$file" | while read -r name; do
			case $name in
			*.inc) continue ;; # built from shaders/
			esac
			found=no
			for place in "$folder" "$@"; do
				[ -f "$place/$name" ] || continue
				case $place:$name in
				"$folder":*/*) grep -qxF "$folder/${name%/*}" <<<"$allowed" && found=yes ;;
				lib:*/*) ;;
				*) found=yes ;;
				esac
			done
			[ $found = yes ] || echo "$file: includes $name, which is not in its room," \
				"one before it, or ${*:-nothing}"
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

complain < <(check_rooms)
complain < <(check_includes shaders)
complain < <(check_includes lib shaders)
complain < <(check_includes formats lib shaders)
complain < <(check_includes cli formats lib shaders)
complain < <(check_silence)
finish
