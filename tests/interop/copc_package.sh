# The npm package copc, with laz-perf in it, reads LAS, LAZ and COPC files of ours, value for value.
. "$SOURCE/tests/interop/other_programs"
need node
[ -d "$SOURCE/build/interop/node_modules/copc" ] || {
	echo "the npm package copc is not installed (make deps-interop)"
	exit 77
}
ln -s "$SOURCE/build/interop/node_modules"
make_cave --points 120000 -o cave.ply
glowworm bake cave.ply -q --light 'point name lamp at 13.5,2.6,1.8 intensity 5' --fields lights \
	--rays 8 -o lit.las
for name in lit.laz lit.copc.laz; do
	glowworm convert lit.las $name
done
# Rounded in all ways: floats as they were, of fewer bits.
glowworm convert lit.las --las-radiance bfloat16 --las-step 0.0001 small.copc.laz
for name in lit.las lit.laz lit.copc.laz small.copc.laz; do
	glowworm convert $name $name.csv
	node "$SOURCE/tests/interop/las_reader.mjs" $name $name.csv >said || echo "status $?"
	grep -v ': same$' said
	grep -c ': same$' said
done
