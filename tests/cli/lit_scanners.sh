# A lit file says where the scanner stood: it is read again as a scan from there, and looked at from
# there.
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
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
# Who stood where is not asked for where the file says it: of a rough wall, light is in doubt.
awk 'BEGIN {
	srand(5); print "ply\nformat ascii 1.0\ncomment glowworm scanner: 0 0.25 1.5"
	print "element vertex 1000\nproperty float x\nproperty float y\nproperty float z\nend_header"
	for (i = 0; i < 1000; i++) print 3 + rand() * 0.4, rand() * 4 - 2, rand() * 3 }' >rough.ply
sed '/scanner/d' rough.ply >unsaid.ply
for scan in rough unsaid; do
	glowworm bake $scan.ply --light 'point at 1,0,2 intensity 20' -o rough-lit.ply --force 2>notes
	grep -c 'in doubt because a bake of half' notes
	grep -o 'scanner X,Y,Z, where one stood' notes | uniq
done
