# Lit LAS and LAZ are mixed part by part, to LAS, LAZ and PLY: what mixing all at once makes of
# them, but for the command that is in them; columns that hold nothing are none in the end. Parts
# are for those that memory hardly holds: of addresses there are too few for more.
# sanitize: no
points=510000 # more than two parts, of 250,000 points of LAZ
{
	printf 'ply\nformat ascii 1.0\nelement vertex %d\n' $points
	printf 'property float %s\n' x y z
	printf 'property uchar %s\n' red green blue albedo_r albedo_g albedo_b
	printf 'property float scalar_%s\n' radiance_r radiance_g radiance_b \
		light_one_r light_one_g light_one_b light_two_r light_two_g light_two_b
	echo end_header
	awk -v points=$points 'BEGIN { for (i = 0; i < points; i++) {
		one = i % 7 + 1; two = i % 1100; sum = one + two
		print i % 500, int(i / 500), 0, 9, 9, 9, 200, 100, 50, sum, sum, sum, one, one, one,
			two, two, two } }'
} >lit.txt.ply
glowworm convert lit.txt.ply -o lit.laz
mix() { from=$1; shift; glowworm mix "$from" --gain one=3 --gain two=0.5,1,2 -q -f -o "$@"; }
for output in ply las laz; do
	(ulimit -v 110000 && mix lit.laz parts.$output -j 1)
	mix - whole.$output <lit.laz
	for file in parts whole; do
		glowworm convert $file.$output - --output-format csv | md5sum >$file.sum
	done
	cmp parts.sum whole.sum && echo "$output: the same"
done
glowworm convert parts.laz - --output-format csv >parts.csv
head -1 parts.csv
