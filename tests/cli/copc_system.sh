# What COPC has otherwise than where points came from. Its coordinate system is WKT: where older
# keys alone had it, PROJ makes it of them, unless they say other units beside it or no system
# that is known; then a note says so.
cloud() { # keys
	printf 'ply\nformat ascii 1.0\ncomment las geokeys 1 1 0 9 %s\nelement vertex 2\n' "$1"
	printf 'property double %s\n' x y z
	printf 'end_header\n500000.25 5300000.5 100\n500001.25 5300001.5 101\n'
}
for keys in '3072 0 1 25832' '3072 0 1 25832 3076 0 1 9001' '3072 0 1 25832 4099 0 1 9002' \
	'3072 0 1 32767' '1024 0 1 1'; do
	echo "$keys"
	cloud "$keys" >cloud.ply
	glowworm convert -f cloud.ply lit.copc.laz 2>&1
	glowworm convert -f lit.copc.laz back.ply
	grep -ao 'las wkt PROJCS."[^"]*"' back.ply
	grep -ao 'las geokeys.*' back.ply
done
# Other formats keep the keys as they are.
cloud '3072 0 1 25832' | glowworm convert - lit.laz
glowworm convert -f lit.laz back.ply
grep -ao 'las wkt' back.ply
grep -ao 'las geokeys.*' back.ply
# Classes of old point formats: 12 becomes a flag, as other programs do it; 18 is high noise to
# others, but not to a bake, which knows by the angle in degrees where the points came from.
{
	echo '# x y z classification scan_angle_rank'
	for class in 2 12 12 18 2 2 2 2 2 2 2 2; do echo "0 0 $class $class -3"; done
} >old.xyz
glowworm convert old.xyz old.las
glowworm convert old.las new.copc.laz
glowworm convert old.las new.copc.laz -q -f
glowworm convert new.copc.laz - --output-format csv |
	awk -F , 'NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; print NF; next }
		{ print $at["z"], $at["classification"], $at["overlap"], $at["scan_angle_rank"],
			$at["scan_angle"] }' | sort | uniq -c
# Those of new formats are what they are.
glowworm convert new.copc.laz again.copc.laz
