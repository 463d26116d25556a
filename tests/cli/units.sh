# Coordinates in feet and in degrees: the light is that of the same place in metres, lamps stand in
# the file's coordinates, and so do points and cameras that are written; degrees that nobody names
# are refused.
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
floor() { # factors of x, y, z and what is added to x and y
	echo 'x y z'
	awk -v fx="$1" -v fy="$2" -v fz="$3" -v x0="$4" -v y0="$5" 'BEGIN {
		for (i = 0; i < 2500; i++)
			printf "%.12f %.12f %.9f\n", x0 + fx * (i % 50), y0 + fy * int(i / 50), \
				fz * (i % 50 < 25 ? 0 : 20) }'
}
floor 0.5 0.5 1 0 0 >metres.txt
floor 1.640419947506562 1.640419947506562 3.280839895013123 0 0 >feet.txt
# At 50 degrees a degree is 111,229 m of latitude and 71,696 m of longitude.
floor 0.0000069739 0.0000044953 1 10 50 >degrees.txt
sum() { # FILE: sum of the luminance, and the last place
	glowworm convert "$1.ply" "$1.csv" -f
	awk -F, -v name="$1" 'NR == 1 { for (i = 1; i <= NF; i++) if ($i ~ /radiance_r/) c = i; next }
		{ s += $c } END { printf "%s %.2f %.4f\n", name, s, $1 }' "$1.csv"
}
bake() { # NAME LAMP option...
	name=$1 lamp=$2
	shift 2
	glowworm bake "$name.txt" -o "$name.ply" --light "$lamp" --bounces 1 --estimate-points 0 "$@" \
		2>said.txt
	grep 'the coordinates are' said.txt
	sum "$name"
}
bake metres 'point at 5,12,4 intensity 100'
bake feet 'point at 16.4041995,39.3700787,13.1233596 intensity 100' --units ft
bake degrees 'point at 10.000069739,50.000107887,4 intensity 100' --units degrees
glowworm bake degrees.txt -o x.ply --light 'sky radiance 1' 2>&1
echo "status $?"
# A step of degrees is a length that nobody means.
glowworm bake degrees.txt -o x.laz --light 'sky radiance 1' --units degrees --las-step 0.0001 2>&1
echo "status $?"
{
	echo '# las geokeys 1 1 0 1 2048 0 1 4326'
	echo '# x y z'
	sed 1d degrees.txt
} >keys.xyz
for step in 0.0001 1e-9; do
	glowworm convert keys.xyz x.laz --las-step $step 2>&1
	echo "status $?"
done
# Nor where they only look like it: of all points, a part of which does not, and mixed.
glowworm convert degrees.txt w.laz --las-step 0.0001 2>&1
echo "status $?"
glowworm convert degrees.txt plain.ply
glowworm convert plain.ply w.laz --las-step 0.0001 2>&1
echo "status $?"
glowworm bake degrees.txt -q --units degrees --fields lights --rays 8 -o lamps.ply \
	--light 'point name a at 10,50,9 intensity 9'
glowworm mix lamps.ply --gain a=2 --las-step 0.0001 -o y.laz 2>&1
echo "status $?"
glowworm convert plain.ply z.laz --las-step 1e-9
# The same camera, said in the coordinates of either.
for name in metres feet; do
	units=m
	[ $name = feet ] && units=ft
	glowworm render $name.txt -o $name.png --size 20x10 --units $units 2>&1 |
		sed -n "s/.*--camera 'at \([^,]*\),\([^,]*\),.*/\1 \2/p"
done | awk 'NR == 1 { x = $1; y = $2 } NR == 2 { printf "%.4f %.4f\n", $1 / x, $2 / y }'
