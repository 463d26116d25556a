# The npm package copc, with laz-perf in it, reads LAS, LAZ and COPC files of ours, value for value:
# of many lit points, of one, and of none.
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
# No point at all, and one.
for count in 0 1; do
	printf 'ply\nformat ascii 1.0\nelement vertex %d\n' $count >few.txt
	printf 'property float %s\n' x y z >>few.txt
	echo end_header >>few.txt
	[ $count = 0 ] || echo 1.5 2 3 >>few.txt
	for name in few.las few.laz few.copc.laz; do
		glowworm convert few.txt $name -f
		glowworm convert $name $name.csv -f
		node "$SOURCE/tests/interop/las_reader.mjs" $name $name.csv >said || echo "status $?"
		grep -v ': same$' said
		grep -c ': same$' said
	done
done
