# A room that the sun shines on is black inside, which a note says, with the way out; with a lamp it is
# not.
glowworm info --devices >/dev/null 2>&1 || { echo "there is no Vulkan device"; exit 77; }
make_box --scene rooms --points 5000 -o rooms.ply
glowworm convert rooms.ply all.csv 2>/dev/null
# Without what glows.
awk -F, 'BEGIN { OFS = "," } { print $1, $2, $3, $4, $5, $6 }' all.csv >rooms.csv
glowworm bake rooms.csv --light 'sun direction 0,0,1 irradiance 1' --estimate-points 0 -o dark.ply \
	2>&1 | sed 's/[0-9.]* %/N %/'
glowworm bake rooms.csv --light 'point at 0.5,0.5,1 intensity 1' --estimate-points 0 -o lit.ply 2>&1
