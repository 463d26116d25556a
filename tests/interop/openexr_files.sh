# OpenEXR's own tool reads the header of a picture: its channels and what it says about itself.
. "$SOURCE/tests/interop/other_programs"
need exrheader
make_lit
glowworm render lit.ply -q --size 64x48 -o picture.exr
exrheader picture.exr | sed '/^$/d;s/^\(exposureValue.*\): .*/\1/'
