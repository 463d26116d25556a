#!/usr/bin/env bash
# A scan between programs: CloudCompare thins it and computes its normals, glowworm lights it, and
# MeshLab and Blender get what they read: PLY with colours and quality, and OpenVDB grids.
#
#   pipe_programs.sh SCAN.ply [folder]
set -eu -o pipefail
GLOWWORM=${GLOWWORM:-glowworm}
export QT_QPA_PLATFORM=offscreen
scan=$1 folder=${2:-lit}
mkdir -p "$folder"

CloudCompare -SILENT -AUTO_SAVE OFF -NO_TIMESTAMP -C_EXPORT_FMT PLY -O "$scan" -SS SPATIAL 0.02 \
	-OCTREE_NORMALS auto -SAVE_CLOUDS FILE "$folder/thin.ply" >"$folder/cloudcompare.log" 2>&1

# Text through a pipe: any program that writes numbers can stand before the bar.
"$GLOWWORM" convert "$folder/thin.ply" --output-format csv - |
	"$GLOWWORM" bake - --light "${LIGHT:-sky radiance 1}" -o "$folder/lit.ply" \
		--vdb "$folder/lit.vdb" --force
"$GLOWWORM" convert "$folder/lit.ply" "$folder/lit.las" --force
