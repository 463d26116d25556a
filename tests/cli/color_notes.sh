# What was told of colours by their values alone is said, and what is too dark or too bright as a
# whole, with the option that helps; and of a mesh that its vertices were taken. Intensities of two
# inputs are on one scale.
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
cloud() { # R G B: a floor of 100 points, all of one colour but the first, which is full
	echo 'x y z Rf Gf Bf'
	awk -v rgb="$1 $1 $1" -v full="$2" 'BEGIN {
		for (i = 0; i < 100; i++)
			print i % 10 * 0.1, int(i / 10) * 0.1, 0, i ? rgb : full " " full " " full }'
}
notes() { # FILE option...
	glowworm bake "$@" --light 'sky radiance 1' --estimate-points 0 -o lit.ply -f 2>notes.txt
	grep 'the albedo\|faces' notes.txt
	glowworm info lit.ply --stats --json | grep -o '"albedo": \[0\.[0-9][0-9]'
}
cloud 32896.5 65535.5 >words.txt
notes words.txt
cloud 0.05 1.0 >dark.txt
notes dark.txt
notes dark.txt --albedo-scale 2
cloud 0.99 1.0 >bright.txt
notes bright.txt
{
	printf 'ply\nformat ascii 1.0\nelement vertex 4\n'
	printf 'property float %s\n' x y z
	printf 'element face 1\nproperty list uchar int vertex_indices\nend_header\n'
	printf '0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n'
} >square.ply
notes square.ply
for level in 50 100; do
	echo 'x y z intensity'
	awk -v level=$level 'BEGIN {
		for (i = 0; i < 100; i++) print i % 10 * 0.1, int(i / 10) * 0.1, level / 100, level }'
done | awk '/x/ { file = "level" ++n ".txt" } { print >file }'
glowworm bake level1.txt level2.txt --albedo intensity --light 'sky radiance 1' --bounces 0 \
	--estimate-points 0 -o both.ply -f -q
glowworm convert both.ply both.csv
awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) if ($i ~ /albedo_r/) c = i; next }
	{ print $c }' both.csv | uniq -c
