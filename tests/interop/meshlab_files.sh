# MeshLab loads a lit PLY file, with colours, normals and quality, and what it writes as PLY is read
# here with the same numbers.
. "$SOURCE/tests/interop/other_programs"
need meshlabserver xvfb-run
make_lit
unset QT_QPA_PLATFORM
timeout 100 xvfb-run -a meshlabserver -i lit.ply -o theirs.ply -m vc vn vq >log 2>&1 || cat log
# It computes in single precision: 2^-24 of a value, 6e-8.
same_columns lit.ply theirs.ply 1e-7 x y z nx ny nz quality
same_columns lit.ply theirs.ply 0 red green blue
