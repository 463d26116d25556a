# Blender loads the grids of a bake, under the names that it looks for, where they belong and with
# their values; the grid of points beside them; and the points of a PLY file, where they belong.
. "$SOURCE/tests/interop/other_programs"
need blender
make_lit --vdb points.vdb --vdb-points
make_lit --vdb lit.vdb -f
timeout 200 blender -b --factory-startup --python "$SOURCE/tests/interop/blender_steps.py" >log 2>&1
grep '^found' log || cat log
