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
	grep -c 'above all: the light is .* in doubt because' notes
	grep -o 'scanner X,Y,Z, where one stood' notes | uniq
done
# Comments do not tell of 65 scanners, E57 does: a note says what is lost, by every verb that writes
# it, once.
awk 'BEGIN { for (i = 1; i <= 65; i++) {
	print "1\n1\n" i " 0.5 2\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0"
	print i " 0.5 2 1\n1 " i " 0.25 0.5 200 180 160" } }' >many.ptx
echo '{"version": 1, "frames": 2, "inputs": [{"file": "many.ptx"}],
	"lights": [{"type": "point", "position": [0,0,2], "intensity": 1, "path": [
		{"frame": 0, "position": [0,0,2]}, {"frame": 1, "position": [1,0,2]}]}]}' >many.json
lost() {
	"$@" 2>&1 | grep -c "where the input's 65 scanners stood is lost" || true
}
lost glowworm bake many.ptx --light 'sky radiance 1' --fields lights -o many.ply
lost glowworm bake many.ptx --light 'sky radiance 1' --fields lights -o many.e57
lost glowworm bake many.json --frames all -o many-%d.ply
lost glowworm albedo many.ptx --capture overcast -o albedo.ply
lost glowworm mix many.e57 --gain sky=2 -o mixed.ply
