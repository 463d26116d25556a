#!/usr/bin/env bash
# How fast each format is read, beside PCL and CloudCompare: puts the table into a page.
#
#   formats_table.sh BUILD PAGE [POINTS [FILE...]]     POINTS of each cloud, 2000000 unless said
#
# Scans as E57 and PTX come from make_cave; FILEs are measured too, such as a survey as LAZ.
# The table stands in PAGE between the lines `<!-- table -->` and `<!-- end of table -->`, that of
# writing between `<!-- writing -->` and `<!-- end of writing -->`.
set -eu
build=$1
page=$2
points=${3:-2000000}
shift $(($# < 3 ? $# : 3))
folder=$(mktemp -d "${TMPDIR:-/tmp}/glowworm-formats.XXXXXX")
trap 'rm -rf "$folder"' EXIT
export QT_QPA_PLATFORM=offscreen XDG_RUNTIME_DIR="$folder" HOME="$folder"
command -v CloudCompare >/dev/null || export CLOUDCOMPARE=

for format in e57 ptx; do
	"$build/samples/make_cave" --points "$points" --format $format -o "$folder/scans.$format"
done
{
	sed '/^<!-- table -->$/q' "$page"
	echo
	"$build/tests/bench/bench_formats" "$folder" "$points" "$folder"/scans.e57 "$folder"/scans.ptx \
		"$@"
	echo
	processor=$(sed -n 's/^model name.*: //p' /proc/cpuinfo | head -n 1)
	echo "Measured on $processor with others running, load $(cut -d ' ' -f 1 /proc/loadavg)."
	echo
	sed -n '/^<!-- end of table -->$/,/^<!-- writing -->$/p' "$page"
	echo
	"$build/tests/bench/bench_formats" --writing "$points"
	echo
	sed -n '/^<!-- end of writing -->$/,$p' "$page"
} >"$folder/page.new"
cp "$folder/page.new" "$page"
