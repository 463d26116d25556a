#!/usr/bin/env bash
# sides_table.sh - how many points of public files face the right way, as a table.
#
#   tests/bench/sides_table.sh FOLDER [NAME]... [-- BAKE-OPTION...]
#
# FOLDER holds the files of the table below by these names; those that are not there are passed
# over. NAME is one of the table, or a pattern as bunny-*; none means all. Of each file the bare
# places are baked, without normals, colours, poses, rows and columns, under two suns, a sky and a
# lamp, by few rays: sides do not depend on them. README.md says where the truth is from.
#
# Environment: GLOWWORM (build/glowworm), SIDES, where clouds are kept for the next time
# (build/sides). Needs python3 with NumPy; PYTHON says which (python3).
#
# Columns: the name, points whose truth is known, percent of them that face the right way under each
# light, and seconds of the processor for all of them.
set -u
export LC_ALL=C
root=$(cd "$(dirname "$0")/../.." && pwd)
glowworm=${GLOWWORM:-$root/build/glowworm}
python=${PYTHON:-python3}
sides=${SIDES:-$root/build/sides}
lights='sun sun2 sky lamp'

# name, file, units, up, kind of truth and its arguments; FOLDER/ stands for the folder
files="
bunny            loaders.gl/bunny.ply                     m   y  vertices
bunny-laser      e57-cry-inc/bunnyDouble.e57              m   y  nearby FOLDER/loaders.gl/bunny.ply
bunny-one-scan   pcl/bun0.pcd                             m   y  view 0,0,1
kitten           cgal/kitten.xyz                          m   y  table
cube-carved      cgal/cube.pwn                            m   z  bounds
ellipsoid        loaders.gl/ellipsoid.laz                 m   z  ellipsoid
cube             assimp/cube.ply                          m   z  faces 20000
cube-unit        trimesh/cube_blender_uv.ply              m   z  faces 20000
cube-two         pcl/cube.ply                             m   z  faces 20000
ring             draco/test_pos_color.ply                 m   z  faces 20000
reference        trimesh/reference.ply                    mm  z  faces 20000
cornell          cornell-embree/cornell_box.obj           mm  y  box 40000
bones            cavewhere/bones_vertices.ply             m   y  normals
bones-dense      cavewhere/bones_300k.ply                 m   y  normals
milk             pcl/milk_color.pcd                       m   -y scanner 0,0,0
office           pcl/office1.pcd                          m   -y scanner 0,0,0
furniture        pcl-data/region_growing_rgb_tutorial.pcd m   -y scanner 0,0,0
rooms            pcl-data/room_scan1.pcd                  m   z  scanner 0,0,0
room-a601        pcl/place_recognition_A601.pcd           m   z  scanner 0,0,0.823
wood             pcl-data/samp11-utm.pcd                  m   z  terrain
town             pcl-data/CSite1_red2-utm.pcd             m   z  terrain
autzen           pdal/autzen/autzen-thin.las              m   z  terrain
autzen-few       pdal/las/1.2-with-color.las              m   z  terrain
autzen-bmx       pdal/autzen/autzen-bmx-2023.las          m   z  terrain
warsaw           pdal/las/warsaw_small.las                m   z  terrain
sample-c         pdal/las/sample_c.las                    m   z  terrain
degrees          pdal/las/epsg_4326.las                   degrees z terrain
strip            pdal/las/test1_4.las                     m   z  terrain
tile             pdal/filters/faceraster_numerical_imprecision.laz m z terrain
training         cgal/b9_training.ply                     m   z  terrain
outcrop          cloudcompare-qcompass/example_data.laz   m   z  terrain
ripple           loaders.gl/ripple.las                    m   z  terrain
"

[ $# -gt 0 ] || { sed -n '2,/^set/s/^# \{0,1\}//p' "$0" && exit 64; }
folder=$1
shift
# shellcheck source=tests/bench/wanted_rows
. "$root/tests/bench/wanted_rows"

fail() { # name, what failed
	printf '%-16s %s failed\n' "$1" "$2"
	tail -n 3 "$sides/$1.log"
}

# Meshes and tables are read as they are, of everything else the places that it stands for.
make_cloud() { # name, file, up, kind, arguments
	local prefix=$sides/$1 file=$folder/$2
	[ -f "$prefix.lights" ] && return
	case $4 in
	nearby | ellipsoid | scanner | view | terrain)
		"$glowworm" convert "$file" --force -o "$prefix.read.ply" || return
		file=$prefix.read.ply
		;;
	esac
	"$python" "$root/tests/bench/real_sides.py" make "$file" "$prefix" "${@:3}"
}

bake() { # name, light, options
	local prefix=$sides/$1 light
	light=$(sed -n "s/^$2	//p" "$prefix.lights")
	"$glowworm" bake "$prefix.ply" --light "$light" --force -o "$prefix.lit.ply" \
		--fields normals --quality draft --bounces 1 --rays 4 --estimate-points 0 "${@:3}"
}

run_file() { # name, file, units, up, kind, arguments
	local name=$1 prefix=$sides/$1 row='' known='-' light score
	local given=(--units "$3" --up "$4" "${options[@]}") TIMEFORMAT='%U %S'
	make_cloud "$1" "$2" "${@:4}" >"$prefix.log" 2>&1 || { fail "$name" make && return; }
	: >"$prefix.seconds"
	for light in $lights; do
		{ time bake "$name" "$light" "${given[@]}" >"$prefix.log" 2>&1; } 2>>"$prefix.seconds" ||
			{ fail "$name" "$light" && return; }
		score=$("$python" "$root/tests/bench/real_sides.py" score "$prefix" "$prefix.lit.ply") ||
			{ fail "$name" "$light" && return; }
		known=${score#* } row+=$(printf ' %7s' "${score% *}")
	done
	printf '%-16s %7s%s %8.1f\n' "$name" "$known" "$row" \
		"$(awk '{ sum += $1 + $2 } END { print sum }' "$prefix.seconds")"
}

mkdir -p "$sides" || exit 73
printf '%-16s %7s %7s %7s %7s %7s %8s\n' file points $lights seconds
echo "$files" | while read -r name file rest; do
	[ -n "$name" ] && is_wanted "$name" && [ -f "$folder/$file" ] || continue
	# shellcheck disable=SC2086
	run_file "$name" "$file" ${rest//FOLDER/$folder} </dev/null
done
