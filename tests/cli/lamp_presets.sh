# Lamps by name: what they stand for, on the command line and in a scene file, what wins over them,
# the beam of a headlamp measured on a wall, and what is refused.
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
glowworm lamp | grep -v source
glowworm lamp --json | grep -c '"source": ".'
printf 'x y z nx ny nz\n' >wall.xyz
awk 'BEGIN {
	for (i = 0; i < 2500; i++)
		print 10, (i % 50 - 24.5) * 0.02, (int(i / 50) - 24.5) * 0.02, -1, 0, 0
}' >>wall.xyz
. "$SOURCE/tests/cli/shared_functions"
print_lights wall.xyz --light 'candle at 0,0,0' --light 'candle at 0,0,0 name left kelvin 2000' \
	--light 'carbide at 0,0,0 intensity 10' --light 'torch at 0,0,0 radius 0.1' |
	sed 's/"intensity": "\([0-9]*\)[^"]*"/"intensity": \1/'
cat >lamps.json <<'END'
{"version": 1, "inputs": [{"file": "wall.xyz"}], "lights": [
  {"type": "fat-lamp", "position": [0, 0, 0]},
  {"lumens": 100, "type": "headlamp", "position": [0, 0, 0], "direction": [1, 0, 0],
   "distance": 50}]}
END
print_lights lamps.json | tee first.txt
glowworm bake lamps.json --albedo constant:0.5 --print-scene -o lit.ply >again.json
print_lights again.json | cmp - first.txt
# 0.25 lx reach 20 m, so that a wall 10 m away has 1 lx in the middle of the beam.
glowworm bake wall.xyz --light 'headlamp at 0,0,0 to 10,0,0 lumens 60 distance 20' \
	--albedo constant:0.5 --fields illuminance -q -o lit.ply
glowworm measure lit.ply --box 9.9,-0.025,-0.025,10.1,0.025,0.025 --json |
	sed -n 's/.*"mean": \(.*\),/\1/p' | xargs printf '%.4f lx\n'
for light in 'headlamp at 0,0,0 to 1,0,0' 'headlamp at 0,0,0 to 1,0,0 lumens 300' \
	'headlamp at 0,0,0 to 1,0,0 lumens 300 distance 100 outer 30' \
	'headlamp at 0,0,0 to 1,0,0 lumens 300 distance 1' \
	'headlamp at 0,0,0 to 1,0,0 lumens 300 distance 0' \
	'spot at 0,0,0 to 1,0,0 intensity 3 distance 10' 'candle at 0,0,0 watts 3' 'candle' \
	'candel at 0,0,0' \
	'carbide at 0,0,0 lumens 3 intensity 4' 'point at 0,0,0 distance 10'; do
	print_lights wall.xyz --light "$light"
done
sed 's/fat-lamp/fatlamp/' lamps.json >bad.json
print_lights bad.json
