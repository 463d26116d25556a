#!/usr/bin/env bash
# Pictures of the three scenes of Salm's thesis, and what each effect adds: direct light alone, two
# reflections, all of them, albedo blended a third of the way to white (his section 5.1), light of
# the voxels gathered by cones instead of rays, and where light leaks or fails to arrive: faint and
# in false colours, and read from the voxels as he does. A glossy ball and cube come with their
# reflections by rays, by cones and without.
#
#   gallery.sh FOLDER [POINTS]     POINTS of each box, 400000 unless said
#
# Pictures are FOLDER/SCENE-VARIANT.png. Lit clouds stay beside them.
set -eu
GLOWWORM=${GLOWWORM:-glowworm}
MAKE_CAVE=${MAKE_CAVE:-make_cave}
folder=$1
points=${2:-400000}
here=$(cd "$(dirname "$0")" && pwd)
size=${GALLERY_SIZE:-1600x900}

# Every picture of a scene has the exposure of the one with all light, so that they compare.
exposure_of() { # lit cloud
	sed -n 's/^comment glowworm preview: .* EV \(.*\)$/\1/p;/^end_header/q' "$1"
}

bake() { # scene variant option...
	local scene=$1 variant=$2
	shift 2
	"$GLOWWORM" bake "$folder/$scene.scene.json" --force -q --estimate-points 0 \
		-o "$folder/$scene-$variant.ply" "$@"
}

picture() { # scene variant camera exposure option...
	local scene=$1 variant=$2 camera=$3 exposure=$4
	shift 4
	"$GLOWWORM" render "$folder/$scene-$variant.ply" --force -q --size "$size" \
		--camera "$camera" --exposure "$exposure" -o "$folder/$scene-$variant.png" "$@"
	echo "$folder/$scene-$variant.png"
}

show() { # scene camera option...
	local scene=$1 camera=$2 exposure variant
	shift 2
	bake "$scene" all "$@"
	exposure=$(exposure_of "$folder/$scene-all.ply")
	picture "$scene" all "$camera" "$exposure"
	bake "$scene" direct --bounces 1 "$@"
	bake "$scene" two-bounces --bounces 2 "$@"
	bake "$scene" white --albedo-white 0.33 "$@"
	bake "$scene" cones --method cones "$@"
	for variant in direct two-bounces white cones; do
		picture "$scene" "$variant" "$camera" "$exposure"
	done
	# Leaks are faint: five stops brighter they show, and in false colours they can be read.
	cp "$folder/$scene-all.ply" "$folder/$scene-faint.ply"
	picture "$scene" faint "$camera" "$(awk -v e="$exposure" 'BEGIN { print e - 5 }')"
	cp "$folder/$scene-all.ply" "$folder/$scene-luminance.ply"
	picture "$scene" luminance "$camera" "$exposure" --false-colour
	cp "$folder/$scene-all.ply" "$folder/$scene-voxels.ply"
	picture "$scene" voxels "$camera" "$exposure" --radiance trilinear
	rm "$folder/$scene-faint.ply" "$folder/$scene-luminance.ply" "$folder/$scene-voxels.ply"
}

# The one glossy bounce of Salm's section 4.6: with and without.
show_gloss() { # scene camera option...
	local scene=$1 camera=$2 exposure variant
	shift 2
	bake "$scene" rays "$@"
	exposure=$(exposure_of "$folder/$scene-rays.ply")
	for variant in rays cones off; do
		[ "$variant" = rays ] || ln -f "$folder/$scene-rays.ply" "$folder/$scene-$variant.ply"
		picture "$scene" "$variant" "$camera" "$exposure" --glossy "$variant"
	done
	rm "$folder/$scene-cones.ply" "$folder/$scene-off.ply"
}

# The yellow cube walks through its box, and a lamp swings by: every fourth of 24 frames.
frames() { # points
	local cloud exposure
	"$GLOWWORM" bake "$folder/cornell_frames.scene.json" --force -q --estimate-points 0 \
		--count "$1" --frames all -o "$folder/cornell_frames-%02d.ply"
	exposure=$(exposure_of "$folder/cornell_frames-00.ply")
	for cloud in 00 04 08 12 16 20; do
		picture cornell_frames "$cloud" 'at 0,-3.4,1 to 0,0,1 fov 45' "$exposure"
	done
}

mkdir -p "$folder"
cp "$here"/*.scene.json "$here"/*.obj "$here"/*.mtl "$folder"
[ -f "$folder/cave.ply" ] || "$MAKE_CAVE" -o "$folder/cave.ply"
show cornell 'at 0,-3.4,1 to 0,0,1 fov 45' --count "$points"
frames "$((points / 4))"
show spot_box 'at 0,-3.4,1 to 0,0,1 fov 45' --count "$points"
show_gloss glossy_box 'at 0,-3.4,1 to 0,0,1 fov 45' --count "$points"
show cave inside --depth 9
