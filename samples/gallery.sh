#!/usr/bin/env bash
# Pictures of the three scenes of Salm's thesis, and what each effect adds. A picture is
# FOLDER/SCENE-VARIANT.png, and every picture of a scene has the exposure of the first, unless it
# says otherwise:
#
#   all          all reflections, light gathered by rays
#   direct       what lamps and glowing patches send, not reflected
#   two-bounces  reflected once more
#   white        albedo blended a third of the way to white (his section 5.1)
#   cones        all reflections, light of the voxels gathered by cones
#   voxels       the first, read from the voxels instead of the points
#   luminance    the first, in false colours
#   leaks        direct light five stops brighter: what is in shadow has to stay black
#   glossy, matte, glossy-cones   one glossy bounce by rays, without it, and by one cone a pixel
#
# cornell-emitters-sampled and -voxels are the direct light of the lamp, sampled and as mere light
# of voxels that cones look for, which brings no sharp shadows (his figure 6.1).
#
#   gallery.sh FOLDER [POINTS]     POINTS of each box, 200000 unless said
set -eu
GLOWWORM=${GLOWWORM:-glowworm}
MAKE_CAVE=${MAKE_CAVE:-make_cave}
folder=$1
points=${2:-200000}
here=$(cd "$(dirname "$0")" && pwd)

bake() { # scene variant option...
	local scene=$1 variant=$2
	shift 2
	"$GLOWWORM" bake "$folder/$scene.scene.json" -f -q --estimate-points 0 \
		-o "$folder/$scene-$variant.ply" "$@"
}

# Sets `exposure` to that of a lit cloud's preview.
expose() { # lit cloud
	exposure=$(sed -n 's/^comment glowworm preview: .* EV \(.*\)$/\1/p;/^end_header/q' "$1")
}

picture() { # lit cloud, name of the picture, option...
	local cloud=$folder/$1.ply name=$folder/$2.png
	shift 2
	"$GLOWWORM" render "$cloud" -f -q --size "$size" --camera "$camera" --exposure "$exposure" \
		-o "$name" "$@"
	echo "$name"
}

# What does not depend on light is found once and used again.
show() { # scene option...
	local scene=$1 variant faint
	shift
	bake "$scene" all --save-transport "$folder/transport" "$@"
	bake "$scene" direct --transport "$folder/transport" --bounces 1 "$@"
	bake "$scene" two-bounces --transport "$folder/transport" --bounces 2 "$@"
	rm "$folder/transport"
	bake "$scene" white --albedo-white 0.33 "$@"
	bake "$scene" cones --method cones "$@"
	expose "$folder/$scene-all.ply"
	for variant in all direct two-bounces white cones; do
		picture "$scene-$variant" "$scene-$variant"
	done
	picture "$scene-all" "$scene-voxels" --radiance trilinear
	picture "$scene-all" "$scene-luminance" --false-colour
	faint=$(awk -v ev="$exposure" 'BEGIN { print ev - 5 }')
	picture "$scene-direct" "$scene-leaks" --exposure "$faint"
}

# The one glossy bounce of Salm's section 4.6.
show_gloss() { # scene option...
	local scene=$1
	shift
	bake "$scene" glossy "$@"
	expose "$folder/$scene-glossy.ply"
	picture "$scene-glossy" "$scene-glossy"
	picture "$scene-glossy" "$scene-glossy-cones" --glossy cones
	picture "$scene-glossy" "$scene-matte" --glossy off
}

# Emitters that cover less than a tenth of the surface are sampled; so that the lamp counts as light
# of the voxels, everything else glows a millionth as bright.
show_emitters() {
	sed 's/cornell\([a-z_]*\)\.obj/emitters\1.obj/' "$here/cornell.scene.json" \
		>"$folder/cornell-emitters.scene.json"
	sed 's/^Kd .*/&\nKe 1e-5 1e-5 1e-5/' "$here/cornell.mtl" >"$folder/emitters.mtl"
	sed 's/cornell.mtl/emitters.mtl/' "$here/cornell.obj" >"$folder/emitters.obj"
	sed 's/cornell.mtl/emitters.mtl/' "$here/cornell_cube.obj" >"$folder/emitters_cube.obj"
	bake cornell-emitters voxels --method cones --bounces 1 --count "$points"
	picture cornell-emitters-voxels cornell-emitters-voxels
	cp "$folder/cornell-direct.png" "$folder/cornell-emitters-sampled.png"
}

# The same scenes with a surface that shines: the cube varnished, the cave wet.
shine() { # scene input reflectance roughness
	sed "s/\"$2\"/&, \"specular\": $3, \"roughness\": $4/" "$here/$1.scene.json"
}

# The yellow cube walks through its box, and a lamp swings by: every fourth of 24 frames.
show_frames() {
	local frame
	bake cornell_frames %02d --frames all --count $((points / 4))
	expose "$folder/cornell_frames-00.ply"
	for frame in 00 04 08 12 16 20; do
		picture "cornell_frames-$frame" "cornell_frames-$frame"
	done
}

mkdir -p "$folder"
cp "$here"/*.scene.json "$here"/*.obj "$here"/*.mtl "$folder"
shine spot_box cornell_cube.obj 0.05 0.2 >"$folder/glossy_spot_box.scene.json"
shine cave cave.ply 0.04 0.3 >"$folder/wet_cave.scene.json"
[ -f "$folder/cave.ply" ] || "$MAKE_CAVE" -o "$folder/cave.ply"
size=${GALLERY_BOX_SIZE:-900x900}
camera='at 0,-3.4,1 to 0,0,1 fov 46'
show cornell --count "$points"
show_emitters
show_frames
show spot_box --count "$points"
show_gloss glossy_box --count "$points"
show_gloss glossy_spot_box --count "$points"

size=${GALLERY_SIZE:-1280x720}
camera=inside
show cave --depth 9
show_gloss wet_cave --depth 9
