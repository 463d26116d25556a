# What is converted part by part becomes the bytes that it becomes at once, as from a pipe, for all
# pairs of formats; also where only all points tell something. Cut-off input leaves no file. Packed
# files are read in parts where memory hardly holds them: of addresses there are too few for more.
# sanitize: no
points=270000 # more than a part, which has 262,144
{
	printf 'ply\nformat ascii 1.0\ncomment by hand\nelement vertex %d\n' $points
	printf 'property double %s\n' x y z
	printf 'property float %s\n' nx ny nz
	printf 'property ushort %s\n' red green blue
	printf 'property int depth\nproperty uchar classification\nend_header\n'
	# Of the colours, what they count to only the last points tell.
	awk -v points=$points 'BEGIN { for (i = 0; i < points; i++) {
		late = i >= points - 9000
		print i % 500 / 8, int(i / 500) / 8, late * 0.3, 0, 0.6, 0.8, i % 256, 7 + late * 60000, 3,
			i - 5, late * 2 } }'
} >a.txt
glowworm convert a.txt -o a.ply
glowworm convert a.txt -o a.las
glowworm convert a.txt -o a.laz
awk 'BEGIN { for (i = 0; i < 800000; i++) print i % 500, int(i / 500), i % 3 }' >b.xyz
glowworm convert b.xyz -o b.laz
glowworm convert b.xyz -o b.e57
glowworm convert a.txt -o a.cloud
# same FROM TO [OPTION ...]
same() {
	from=$1 to=$2
	shift 2
	glowworm convert "$from" "parts.$to" "$@" 2>parts.err
	glowworm convert - "whole.$to" "$@" ${input_format:+--format $input_format} <"$from" 2>whole.err
	cmp "parts.$to" "whole.$to" && cmp parts.err whole.err && echo "$from to $to${1:+ $*}: the same"
	rm -f parts.* whole.*
}
for to in ply las laz e57 pcd xyz csv cloud copc.laz; do
	same a.ply $to
	same a.las $to
done
input_format=cloud
same a.cloud ply
same a.cloud laz
input_format=
same a.ply ply --shift auto
same a.ply ply --shift 1,2,3
same a.las laz --las-step 0.001
# large FROM TO KB
large() {
	(ulimit -v "$3" && glowworm convert "$1" "parts.$2" -j 1)
	glowworm convert - "whole.$2" <"$1"
	cmp "parts.$2" "whole.$2" && echo "$1 to $2: the same"
	rm -f parts.* whole.*
}
for to in ply las laz; do
	large b.laz $to 85000
done
# Formats that have no parts are gathered on the disk first.
large b.e57 laz 90000
large b.xyz csv 78000
# Text goes to a pipe part by part, too.
glowworm convert - whole.csv <a.ply
glowworm convert a.ply - --output-format csv | cmp - whole.csv
rm whole.csv
# What all points tell: colours in one value, where several scanners stood and where one flew, that
# bounds are wrong, that places are none.
awk -v points=$points 'BEGIN { print "# x y z code"
	for (i = 0; i < points; i++) print i, 1, 2, i < points - 9 ? 7 : 1 + 65536 * 9 }' >code.xyz
glowworm convert code.xyz code.ply -q
LC_ALL=C sed 's/^property [a-z]* code/property uint rgb/' code.ply >rgb.ply
same rgb.ply csv
same rgb.ply e57
awk 'BEGIN { print "# x y z scan_angle_rank gps_time point_source_id"
	for (i = 0; i < 30000; i++) { angle = i % 41 - 20
		tangent = sin(angle * 0.0174533) / cos(angle * 0.0174533)
		print 1000 * tangent, i / 100, 0, angle, i / 1000, 1 }
	}' >flown.xyz
glowworm convert flown.xyz flown.las -q
same flown.las ply
same flown.las e57
same flown.las csv
glowworm convert flown.las flown.ply
comments='comment glowworm scanner: 1 2 3
comment glowworm scanner: 4 5 6
'
{
	printf 'ply\nformat ascii 1.0\n%selement vertex 2\n' "$comments"
	printf 'property float %s\n' x y z
	printf 'end_header\n0 0 0\n1 0 0\n'
} >scanners.txt
glowworm convert scanners.txt scanners.ply
same scanners.ply e57
same scanners.ply las
cp a.las bounds.las
printf '\0\0\0\0\0\0\0\0' | dd of=bounds.las bs=1 seek=179 conv=notrunc status=none # the largest x
glowworm convert bounds.las bounds.ply
same bounds.las ply
# Cut off, damaged behind the first part, and what a format cannot hold in the last part.
for from in ply las laz cloud; do
	head -c $(($(stat -c %s a.$from) / 2)) a.$from >cut.$from
	glowworm convert cut.$from none.ply
	echo "status $?"
done
printf '%0600d' 0 | dd of=b.laz bs=1 seek=$(($(stat -c %s b.laz) - 1000)) conv=notrunc status=none
(ulimit -v 85000 && glowworm convert b.laz none.ply -j 1)
echo "status $?"
sed '$d' a.txt >nan.txt && echo 'nan 0 0 0 0 1 1 2 3 4 5' >>nan.txt
glowworm convert nan.txt nan.ply
glowworm convert nan.ply none.laz
echo "status $?"
sed '$d' a.txt >far.txt && echo '1234567.891 0 0 0 0 1 1 2 3 4 5' >>far.txt
glowworm convert far.txt far.ply
glowworm convert far.ply none.cloud
echo "status $?"
glowworm convert nan.ply nan.e57
same nan.ply e57
ls -A
