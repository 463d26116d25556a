#!/usr/bin/env bash
# Dependencies point one way: cli -> formats -> lib, and shaders share headers with lib; within each
# of them a room uses only itself and the rooms before it. Of lib the others use the public headers.
# No two sources of a folder use each other, directly or through others.
# What lib and formats call neither prints to a standard stream nor ends the process.
# shellcheck source=tests/lint/tree_files
. "$(dirname "$0")/tree_files"

# The rooms of each folder, in the order of the data's way.
declare -A rooms=(
	[lib]="base device cloud normals surfels octree light estimate picture bake"
	[formats]="files points ply text pcd e57 las units meshes panoramas luminaires grids \
pictures table"
	[cli]="program lamps options scene result pictures page comparison verbs"
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

# The rooms of a folder that one of them may use: those up to itself, with blanks around each. A
# file that stands in no room may use all of them. Into `allowed`, as no process is started for it.
rooms_up_to() { # folder room
	local room
	allowed=
	for room in ${rooms[$1]}; do
		allowed+=" $room "
		[ "$room" != "$2" ] || return
	done
}

# Whether a file of a folder and its rooms may include a name: one of those rooms, of other folders
# all, but of lib its public headers, or what the build writes.
may_include() { # name folder rooms others...
	local name=$1 folder=$2 allowed=$3 place
	shift 3
	case $name in
	*.inc) return 0 ;;
	*/*) [ -f "$folder/$name" ] && [[ $allowed = *" ${name%%/*} "* ]] && return 0 ;;
	*) [ -f "$folder/$name" ] && return 0 ;;
	esac
	for place in "$@"; do
		case $place:$name in
		lib:*/*) continue ;;
		esac
		[ ! -f "$place/$name" ] || return 0
	done
	return 1
}

# Includes in quotes of a folder's files that are found in none of the places allowed.
check_includes() { # folder others...
	local folder=$1 file name room known='' allowed=''
	shift
	list_sources | grep -E "^$folder/.*\.(c|h|cpp|hpp|comp|glsl)$" | tr '\n' '\0' |
		xargs -0r grep -HoE '^[ 	]*#[ 	]*include[ 	]*"[^"]*"' |
		while IFS=: read -r file name; do
			name=${name#*\"}
			name=${name%\"}
			room=${file#*/}
			room=${room%%/*}
			[ "$room" = "$known" ] || rooms_up_to "$folder" "$room"
			known=$room
			may_include "$name" "$folder" "$allowed" "$@" ||
				echo "$file: includes $name, which is not in its room, one before it," \
					"or ${*:-nothing}"
		done
}

check_silence() {
	local calls='printf|vprintf|puts|putchar|perror|exit|_exit|quick_exit|abort'
	list_sources | grep -E '^(lib|formats)/.*\.(c|h|cpp|hpp)$' | code_of_files |
		awk -v calls="$calls" '
			{ code = $0; sub(/^[^ ]* /, "", code) }
			code ~ "(^|[^A-Za-z0-9_])(" calls ") *[(]" ||
			code ~ /(^|[^A-Za-z0-9_])(stdout|stderr)([^A-Za-z0-9_]|$)/ ||
			code ~ /std::(cout|cerr|clog)/ {
				sub(/: /, ": prints or ends the process: ")
				print }'
}

# Sources whose includes lead back to them. A header may take types from one whose source uses it.
check_circles() { # folder
	list_sources | grep -E "^$1/.*\.(c|cpp)$" | tr '\n' '\0' |
		xargs -0r grep -HoE '^[ 	]*#[ 	]*include[ 	]*"[^"]*"' |
		sed -E "s|^$1/||; s|:.*\"(.*)\"| \1|; s/\.(c|cpp|h)( |$)/ /g" |
		awk '$1 != $2 { print $1, $2 }' | tsort 2>&1 >/dev/null |
		sed -n "s|^tsort: \([^-]\)|$1/\1|p" |
		sed 's/$/: its source is in a circle of sources that use each other/'
}

complain < <(check_rooms)
complain < <(check_includes shaders)
complain < <(check_includes lib shaders)
complain < <(check_includes formats lib shaders)
complain < <(check_includes cli formats lib shaders)
for folder in lib formats cli; do
	complain < <(check_circles "$folder")
done
complain < <(check_silence)
finish
