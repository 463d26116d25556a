# Holes in a room that nobody says who scanned: what is said of them, and what closes them. Ground
# has none.
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
# A room of 4 x 3 x 2.5 m, of which a piece of a wall is missing; and hills.
awk 'BEGIN {
	srand(5); print "x,y,z,nx,ny,nz" > "room.csv"
	for (i = 0; i < 24000; i++) {
		k = int(rand() * 59 / 12); a = rand(); b = rand()
		if (k == 0) print 4 * a "," 3 * b ",0,0,0,1" > "room.csv"
		if (k == 1) print 4 * a "," 3 * b ",2.5,0,0,-1" > "room.csv"
		if (k == 2) print 4 * a ",0," 2.5 * b ",0,1,0" > "room.csv"
		if (k == 3) { x = 4 * a - 2.3; z = 2.5 * b - 1.2
			if (x * x + z * z > 0.25) print 4 * a ",3," 2.5 * b ",0,-1,0" > "room.csv" }
		if (k == 4) { if (rand() < 0.5) print "0," 3 * a "," 2.5 * b ",1,0,0" > "room.csv"
			else print "4," 3 * a "," 2.5 * b ",-1,0,0" > "room.csv" }
	}
	print "x,y,z,nx,ny,nz" > "hills.csv"
	for (i = 0; i < 8000; i++) {
		x = rand() * 40; y = rand() * 40
		print x "," y "," 2 * sin(x / 5) * cos(y / 6) "," -0.4 * cos(x / 5) * cos(y / 6) \
			"," sin(x / 5) * sin(y / 6) / 3 ",1" > "hills.csv" }
}'
# By 16 rays a record: what is said of holes comes from points that are solved again, by others.
bake() { # NAME FILE option...
	name=$1
	shift
	glowworm bake "$@" --rays 16 -o "$name.ply" --albedo constant:0.5 2>&1 |
		sed -n '/note: /p; s/.*\(holes that may be windows or not\)/\1/p' |
		sed 's/[0-9][0-9.]* %/N %/g; s/widest [0-9.]* m at [-0-9.,]*:/widest W at P:/'
}
mean() { # NAME: of the red radiance
	glowworm convert "$1.ply" sums.csv -f
	awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) if ($i ~ /radiance_r/) c = i; next }
		{ s += $c } END { printf "%.6f\n", s / (NR - 1) }' sums.csv
}
outside='sun toward 0,-0.9396926,0.3420201 irradiance 3'
bake open room.csv --light 'sky radiance 1' --light "$outside" --fields unknown
bake black room.csv --light 'sky radiance 1' --light "$outside" --gaps black
bake mean room.csv --light 'sky radiance 1' --light 'point at 1,1,1 intensity 1' --gaps mean
bake cones room.csv --light 'sky radiance 1' --method cones
bake hills hills.csv --light 'sky radiance 1'
# With another one in the floor, which of them are windows is what counts most, and comes first.
awk -F, '!($3 == 0 && ($1 - 1) * ($1 - 1) + ($2 - 2) * ($2 - 2) < 0.25)' room.csv >two.csv
bake two two.csv --light 'sky radiance 1' --light "$outside" | grep 'above all' |
	sed 's/widest [0-9.]* m at [-0-9.,]*/widest W at P/'
echo "$(mean open) $(mean black)" | awk '!($2 < 0.1 * $1) { print }'
glowworm render open.ply --view gaps -o gaps.png --size 40x30 -q
