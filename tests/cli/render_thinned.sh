# A picture of a cloud that memory does not hold is drawn of as many points as fit, and says so.
# Of 64 MB and 360 bytes a point 72 MB hold some 23,000.
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
make_cave --points 60000 -o cave.ply
draw() { glowworm render cave.ply --size 64x48 "$@" 2>&1; }
draw --memory 72M -o fewer.png |
	awk "/are drawn of 60000/ { print (\$3 > 21000 && \$3 < 23400) ? \"fewer\" : \$3 }"
draw --memory 72M -j 1 -q -o one.png
cmp fewer.png one.png
glowworm convert cave.ply cave.las
glowworm render cave.las --size 64x48 --memory 72M -o las.png 2>&1 | grep -c 'are drawn of 60000'
# Where all fit nothing is said of it.
draw --memory 1G -o all.png | grep 'are drawn'
[ $? = 1 ]
