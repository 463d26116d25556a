# Places by name: what info lists, lamps that are put there and aimed there, the same in feet, and
# what is refused.
{
	printf '# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n'
	printf 'WIDTH 8192\nHEIGHT 1\nVIEWPOINT 1 2 1.25 1 0 0 0\nPOINTS 8192\nDATA ascii\n'
	awk 'BEGIN {
		for (i = 0; i < 4096; i++)
			print i % 64 / 16, int(i / 64) / 16, 0 "\n" i % 64 / 16, int(i / 64) / 16, 2.75
	}'
} >room.pcd
glowworm info --places room.pcd
glowworm info --places --json room.pcd
awk 'NR > 11 { print $1 * 4, $2 * 4, $3 * 3.3 } NR < 12 && !/VIEWPOINT/' room.pcd >feet.pcd
glowworm info --places --units ft feet.pcd
printf '0 0 0\n1 0 0\n0 1 0\n' >three.xyz
glowworm info --places three.xyz
. "$SOURCE/tests/cli/shared_functions"
print_lights room.pcd --light 'candle at floor:1+0 intensity 1' \
	--light 'spot at floor:1 to scanner:1 intensity 1' \
	--light 'spot at scanner:1 to floor:1+0.25 intensity 1'
cat >lamp.json <<'END'
{"version": 1, "inputs": [{"file": "room.pcd"}], "lights": [
  {"type": "point", "position": "floor:1+1", "intensity": 2}]}
END
print_lights lamp.json
print_lights feet.pcd --units ft --light 'point at floor:1 intensity 1'
for place in floor:2 floor:0 floor:1.5 floor:1+ floor:1+-1 floor:1+x floor: scanner:2 scanner:1+1 \
	ceiling:1 scanner; do
	print_lights room.pcd --light "point at $place intensity 1"
done
print_lights three.xyz --light 'point at floor:1 intensity 1'
print_lights room.pcd --light 'spot at floor:1 to floor:1 intensity 1'
print_lights room.pcd --light 'spot at 0,0,0 toward floor:1 intensity 1'
glowworm info --places --devices 2>&1 || echo "$?"
# A room whose y points up says so when places are listed, and has floor once it is told.
awk 'BEGIN {
	for (i = 0; i < 4096; i++)
		print i % 64 / 16, 0, int(i / 64) / 16 "\n" i % 64 / 16, 2.75, int(i / 64) / 16
}' >tall.xyz
glowworm info --places tall.xyz 2>&1 | grep -o 'the points lie as if it were y: .*'
glowworm info --places --up y tall.xyz 2>&1
glowworm info --up y tall.xyz | grep format
glowworm info tall.xyz | grep format
