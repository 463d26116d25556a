# A lit file says where the scanner stood: it is read again as a scan from there, and looked at from
# there.
glowworm info --devices >/dev/null 2>&1 || { echo "there is no Vulkan device"; exit 77; }
awk 'BEGIN {
	srand(4); print "x y z"
	for (i = 0; i < 2000; i++) print 3, rand() * 4 - 2, rand() * 3 }' >wall.txt
glowworm bake wall.txt --scanner 0,0.25,1.5 --light 'point at 1,0,2 intensity 20' -o lit.ply -q
glowworm info lit.ply | grep scanner
glowworm render lit.ply --size 32x24 -o lit.png 2>&1 | grep -o "the camera is.*at 0,0.25,1.5"
# And once more, by a bake that is told nothing; what is no place is not one.
glowworm bake lit.ply --light 'point at 1,0,2 intensity 20' -o again.ply -q
LC_ALL=C sed 's/^\(comment glowworm scanner: 0 0.25 \)1.5$/\1nan/' again.ply >bad.ply
glowworm info again.ply | grep scanner
glowworm info bad.ply | grep -c scanner || true
