# CloudCompare loads a lit PLY file, with colours, normals and all scalar fields, and what it writes
# as PLY and as text is read here with the same numbers.
. "$SOURCE/tests/interop/other_programs"
need CloudCompare
make_lit
convert() { # extension format and its options...
	theirs=theirs.$1
	shift
	timeout 100 CloudCompare -SILENT -AUTO_SAVE OFF -NO_TIMESTAMP -C_EXPORT_FMT "$@" -O lit.ply \
		-SAVE_CLOUDS FILE "$theirs" >log 2>&1
	[ -s "$theirs" ] || cat log
}
convert ply PLY
convert asc ASC -PREC 12 -ADD_HEADER
# It computes in single precision, and so do its files: 2^-24 of a value, 6e-8.
for theirs in theirs.ply theirs.asc; do
	same_columns lit.ply "$theirs" 1e-7 x y z radiance_r radiance_g radiance_b moisture
	same_columns lit.ply "$theirs" 0 red green blue
	# It keeps a normal in 21 bits: triangles of an octahedron whose edges are cut into 512, the
	# largest of which have their corners 0.0028 from their centres.
	same_columns lit.ply "$theirs" 0.003 nx ny nz
done
