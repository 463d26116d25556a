#!/bin/sh
# Opacity of points from files: by bytes, floats and options; and what is none.
set -eu

# cloud TYPE VALUE...: a floor of 100 points, and 100 points over it of that opacity.
cloud() {
	awk -v type="$1" -v name="$2" -v value="$3" 'BEGIN {
		print "ply\nformat ascii 1.0\nelement vertex 200"
		print "property float x\nproperty float y\nproperty float z"
		print "property float nx\nproperty float ny\nproperty float nz"
		print "property " type " " name "\nend_header"
		full = type == "uchar" ? 255 : 1
		for (k = 0; k < 2; k++)
			for (i = 0; i < 100; i++)
				print i % 10, int(i / 10), 4 * k, 0, 0, 1 - 2 * k, k ? value : full
	}'
}

# The mean of what gets to the floor, to two digits.
light() {
	glowworm bake "$@" --light 'sun toward 0,0,-1 irradiance 3.14159265' --bounces 1 \
		--albedo constant:0.5 --estimate-points 0 --force -o lit.csv 2>notes >/dev/null
	awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) if ($i ~ /radiance_g$/) c = i; next }
		NR <= 101 { sum += $c } END { printf "%.2f\n", sum / 100 / 0.5 }' lit.csv
}

cloud float opacity 0.25 >quarter.ply
cloud uchar alpha 51 >fifth.ply
cloud float alpha 0 >gone.ply
cloud float opacity nan >nan.ply
cloud float opacity 1.5 >more.ply
cloud float opacity -1 >less.ply

light quarter.ply
light fifth.ply
light gone.ply
grep -o '[0-9]* points of opacity 0' notes
# Of several counts of points one note tells.
sed 's/^9 9 0 /nan 9 0 /' gone.ply >lost.ply
light lost.ply >/dev/null
grep -o 'of all points, 100 of opacity 0: left out, written as dark; 1 without finite' notes
light quarter.ply --opacity 1
light quarter.ply --opacity 0.5
for bad in nan more less; do
	glowworm bake $bad.ply --light 'sky radiance 1' -o x.ply 2>&1 || echo "exit $?"
done
glowworm bake gone.ply --opacity 2 --light 'sky radiance 1' -o x.ply 2>&1 || echo "exit $?"
glowworm bake gone.ply --opacity 0 --light 'sky radiance 1' --force -o x.ply 2>&1 || echo "exit $?"

# What is invisible is in no picture, and what is less than opaque shows what lies behind.
picture() {
	glowworm bake "$1" --light 'sky radiance 1' --albedo constant:0.5 --estimate-points 0 \
		--bounces 1 --force -o lit.ply 2>notes >/dev/null
	glowworm render lit.ply --camera 'at 4,4,20 to 4,5,0 fov 20' --up y --size 40x40 --exposure 0 \
		--force -o "$2" 2>>notes >/dev/null
}
sed -e 's/^element vertex 200/element vertex 100/' -e '/ 4 0 0 -1 /d' gone.ply >floor.ply
picture gone.ply gone.png
picture floor.ply floor.png
picture quarter.ply quarter.png
cmp gone.png floor.png && echo same
cmp -s quarter.png floor.png || echo other
