# A cloud that is mixed part by part becomes what it does all at once, as from a pipe: the same
# bytes, but for the command in its header. What is wrong in the last part alone leaves no file.
# sanitize: no
points=270000 # more than a part, which has 262,144
make_lit() { # what the radiance of the last point is off by
	printf 'ply\nformat ascii 1.0\nelement vertex %d\n' $points
	printf 'property float %s\n' x y z
	printf 'property uchar %s\n' red green blue albedo_r albedo_g albedo_b
	printf 'property float scalar_%s\n' radiance_r radiance_g radiance_b \
		light_one_r light_one_g light_one_b light_two_r light_two_g light_two_b
	echo end_header
	awk -v points=$points -v off="$1" 'BEGIN { for (i = 0; i < points; i++) {
		one = i % 7 + 1; two = i % 1100; sum = one + two + (i == points - 1) * off
		print i % 500, int(i / 500), 0, 9, 9, 9, 200, 100, 50, sum, sum, sum, one, one, one,
			two, two, two } }'
}
make_lit 0 >lit.txt.ply
glowworm convert lit.txt.ply -o lit.ply
for exposure in auto 3; do
	glowworm mix lit.ply --gain one=3 --gain two=0.5,1,2 --exposure $exposure -q -f -o parts.ply
	glowworm mix - --gain one=3 --gain two=0.5,1,2 --exposure $exposure -q -f -o whole.ply <lit.ply
	for file in parts whole; do
		grep -a '^comment glowworm preview' $file.ply
		grep -av '^comment glowworm mixed' $file.ply >$file.data
	done
	cmp parts.data whole.data
done
make_lit 1e9 >off.txt.ply
glowworm convert off.txt.ply -o off.ply
glowworm mix off.ply --gain one=3 --exposure 3 -q -o none.ply 2>&1
echo "status $?"
ls -A
