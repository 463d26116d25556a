# A room that the sun shines on is black inside, which a note says, with the way out; with a lamp
# it is not. That the lights are outside of a closed space is told, also where its walls are lit
# from outside, as those that have two sides; not of one that is open, nor with a light inside.
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
make_box --scene rooms --points 5000 -o rooms.ply
glowworm convert rooms.ply all.csv 2>/dev/null
# Without what glows.
awk -F, 'BEGIN { OFS = "," } { print $1, $2, $3, $4, $5, $6 }' all.csv >rooms.csv
glowworm bake rooms.csv --light 'sun direction 0,0,1 irradiance 1' --estimate-points 0 -o dark.ply \
	2>&1 | sed 's/[0-9.]* %/N %/'
glowworm bake rooms.csv --light 'point at 0.5,0.5,1 intensity 1' --estimate-points 0 -o lit.ply 2>&1
# What is black reflects nothing however much light there is, and no lamp helps.
glowworm bake rooms.csv --light 'point at 0.5,0.5,1 intensity 1' --estimate-points 0 -o black.ply \
	--albedo-scale 0 2>&1 | grep -v "^glowworm: light"
bare() { # rooms without normals, of x above $1, by the light $2
	awk -F, -v low="$1" 'NR == 1 || $1 > low { print $1 "," $2 "," $3 }' all.csv >bare.csv
	echo "$2:"
	glowworm bake bare.csv --light "$2" --estimate-points 0 -f -o bare.ply 2>&1 |
		sed -n 's/.*note: [0-9]* \(of the points close .*\)/\1/p'
}
bare -1 'sky radiance 1'
bare -1 'point at 9,9,9 intensity 100'
bare -1 'point at 0.5,0.5,0.5 intensity 1'
bare 3 'sky radiance 1'
