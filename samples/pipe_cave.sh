#!/usr/bin/env bash
# A cave goes through a pipe: made, lit and described, with no file in between.
#
#   pipe_cave.sh [number of points]
set -eu -o pipefail
GLOWWORM=${GLOWWORM:-glowworm}
MAKE_CAVE=${MAKE_CAVE:-make_cave}

"$MAKE_CAVE" --points "${1:-200000}" |
	"$GLOWWORM" bake - --light 'point at 3.4,0,1.9 intensity 40,30,18' \
		--light 'spot at 13.5,2.6,1.8 to 19,4.5,3.2 intensity 190,150,105 inner 22 outer 42' -o - |
	"$GLOWWORM" info -
