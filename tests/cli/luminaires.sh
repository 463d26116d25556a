# Luminaires by the files of their makers: what they come to on a floor, read again from a printed
# scene, moved in frames, and files that are wrong.
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
{
	printf 'ply\nformat ascii 1.0\nelement vertex 400\nproperty float x\nproperty float y\n'
	printf 'property float z\nproperty float nx\nproperty float ny\nproperty float nz\nend_header\n'
	awk 'BEGIN { for (i = 0; i < 400; i++) print i % 20 * 0.1, int(i / 20) * 0.1, 0, 0, 0, 1 }'
} >floor.ply
# A Lambertian of 100 cd, tilted 90 degrees half of that, and one that is brighter toward C 0.
write_lamp() { # planes
	printf 'IES:LM-63-2019\n[MANUFAC] none\nTILT=INCLUDE\n1\n2\n0 90\n1 0.5\n1 -1 1 91 %s 1 2 ' "$1"
	printf '0 0 0\n1 1 10\n'
	seq -s ' ' 0 90
	[ "$1" = 1 ] && echo 0 || echo 0 90 180
	awk -v planes="$1" 'BEGIN {
		for (p = 0; p < planes; p++)
			for (v = 0; v <= 90; v++)
				print (p == 0 ? 100 : p == 1 ? 50 : 0) * cos(v * atan2(0, -1) / 180)
	}'
}
mkdir lamps
write_lamp 1 >lamps/even.ies
write_lamp 3 >lamps/askew.ies
tail -n 4 lamps/even.ies >cut.ies
. "$SOURCE/tests/cli/shared_functions"
cat >lamp.json <<'END'
{"version": 1, "inputs": [{"file": "floor.ply"}], "lights": [
  {"type": "point", "position": [1, 1, 2], "ies": "lamps/even.ies"},
  {"type": "point", "position": [1, 1, 2], "ies": "lamps/even.ies", "lumens": 31.4152, "roll": 30},
  {"type": "point", "position": [1, 1, 2], "ies": "lamps/askew.ies", "direction": [1, 0, 0]},
  {"type": "point", "position": [1, 1, 2], "ies": "lamps/even.ies", "scale": 0.1, "kelvin": 3000}]}
END
print_lights lamp.json | tee first.txt
glowworm bake lamp.json --albedo constant:0.5 --print-scene -o lit.ply >again.json
print_lights again.json | cmp - first.txt
# Light on the floor at two places, radiance times pi over albedo, over that of a Lambertian of 100
# cd that is 2 m above it.
at_places() { # light
	glowworm bake floor.ply -q --light "$1" --albedo constant:0.5 --fields direct -o lit.ply --force
	glowworm convert lit.ply - --output-format csv | awk -F , -v factor=6.2831853 '
		NR == 1 { for (i = 1; i <= NF; i++) if ($i == "scalar_direct_g") c = i }
		NR > 1 && ($1 == 0.2 || $1 == 1.8) && $2 == 1 {
			squared = 4 + ($1 - 1) ^ 2
			printf "%s%.3f", n++ ? " " : "", $c * factor / (100 * 4 / squared ^ 2)
		}
		END { print "" }'
}
at_places 'point at 1,1,2 ies lamps/even.ies'
at_places 'point at 1,1,2 ies lamps/askew.ies'
at_places 'point at 1,1,2 ies lamps/askew.ies roll 180'
at_places 'point at 1,1,2 ies lamps/askew.ies roll -90'
at_places 'point at 1,1,2 ies lamps/even.ies intensity 50'
# Frames turn it.
cat >frames.json <<'END'
{"version": 1, "frames": 2, "inputs": [{"file": "floor.ply"}], "lights": [
  {"type": "point", "position": [1, 1, 2], "ies": "lamps/askew.ies",
   "path": [{"frame": 0, "roll": 0}, {"frame": 1, "roll": 180}]}]}
END
glowworm bake frames.json -q --albedo constant:0.5 --fields direct --frames 0..1 -o 'frame-%04d.ply'
for frame in 0 1; do
	glowworm convert "frame-000$frame.ply" - --output-format csv | awk -F , -v factor=6.2831853 '
		NR == 1 { for (i = 1; i <= NF; i++) if ($i == "scalar_direct_g") c = i }
		NR > 1 && $1 == 1.8 && $2 == 1 { printf "%.3f\n", $c * factor }'
done
# Lamps where scanners stood.
print_lights floor.ply --scanner 1,1,2 --scanner 0,0,1 \
	--light 'spot at scanner:2 to 1,1,0 lumens 3' --light 'point at scanner:1 ies lamps/even.ies'
print_lights floor.ply --scanner 1,1,2 --light 'spot at scanner:2 to 1,1,0 lumens 3' 2>&1
print_lights floor.ply --scanner 1,1,2 --light 'spot at scanner:1 to 1,1,2 lumens 3' 2>&1
print_lights floor.ply --scanner 1,1,2 --light 'point at scanner:0 lumens 3' 2>&1
# Refused.
try() {
	glowworm bake floor.ply -o lit.ply --force "$@" 2>&1
	echo "$?"
}
try --light 'point at 1,1,2 ies none.ies'
try --light 'point at 1,1,2 ies floor.ply'
try --light 'point at 1,1,2 ies cut.ies'
try --light 'point at 1,1,2 ies lamps/even.ies' --light 'sun from 1,2 irradiance 3W/m^2'
try --light 'point at 1,1,2 ies lamps/even.ies' -o lamps/even.ies
