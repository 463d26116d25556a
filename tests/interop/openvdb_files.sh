# OpenVDB's own tool reads the grids of a bake: names, types, transform and origin; none is
# empty, and no density is over 1.
. "$SOURCE/tests/interop/other_programs"
need vdb_print
make_lit --vdb lit.vdb
vdb_print -l lit.vdb >listed || exit 1
grep -E '^Name:|^  Type:|voxel size|class:|gw_origin_x' listed
grep -c 'Number of active voxels: *[1-9]' listed
awk '/^Name: density/ { ours = 1 }
	ours && /Max value/ {
		print ($3 > 0 && $3 <= 1 ? "densities to 1" : "a density of " $3)
		exit }' listed
# The points beside them, with their attributes and their number.
make_lit --vdb points.vdb --vdb-points -f
vdb_print -l points.vdb | sed -n '/^Name: points/,$p' |
	grep -E '^Name:|^  Type:|voxel size'
