# Lamps in units, by colour temperature, the sun by place and time, skies by name: what they come
# to, the same from the command line and from a scene file, and again from what was printed.
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
{
	printf 'ply\nformat ascii 1.0\nelement vertex 400\nproperty float x\nproperty float y\n'
	printf 'property float z\nproperty float nx\nproperty float ny\nproperty float nz\nend_header\n'
	awk 'BEGIN { for (i = 0; i < 400; i++) print i % 20 * 0.1, int(i / 20) * 0.1, 0, 0, 0, 1 }'
} >floor.ply
. "$SOURCE/tests/cli/shared_functions"
print_lights floor.ply --light 'point at 0,0,1 lumens 12.566370614' \
	--light 'spot at 0,0,1 to 0,0,0 intensity 40cd kelvin 2700' \
	--light 'sun place 47.05,8.3 time 2026-06-21T14:30+02:00 north 10 illuminance 90000lx' \
	--light 'sphere at 0,0,1 radius 0.1 lumens 12.566370614' \
	--light 'disc at 0,0,1 toward 1,0,0 radius 0.5 radiance 2cd/m^2' \
	--light 'rectangle at 0,0,1 size 0.6,1.2 roll 30 lumens 3.1415926536'
print_lights floor.ply \
	--light 'sky model clear place 47.05,8.3 time 2026-06-21T14:30+02:00 illuminance 15000'
cat >sky.json <<'END'
{"version": 1, "units": "photometric", "inputs": [{"file": "floor.ply"}], "lights": [
  {"type": "point", "position": [0, 0, 1], "lumens": 400, "kelvin": 3000},
  {"type": "point", "position": [0, 0, 1], "intensity": "3,2,1cd"},
  {"type": "sky", "model": "gradient", "radiance": 2, "horizon": [3, 2, 1]},
  {"type": "sky", "model": "physical", "from": [120, 30], "turbidity": 4},
  {"type": "rectangle", "position": [0, 0, 1], "size": [0.5, 2], "radiance": 3,
   "direction": [0, 1, 0]},
  {"type": "sun", "place": [47.05, 8.3], "time": "2026-06-21T14:30+02:00", "illuminance": 9}]}
END
print_lights sky.json | tee second.txt
# What is printed is read as the same.
glowworm bake sky.json --albedo constant:0.5 --print-scene -o lit.ply >again.json
print_lights again.json | cmp - second.txt
# Level ground gets what the sky is asked for; sampled: within a percent.
for light in 'sky model overcast illuminance 10000' 'sky illuminance 10000' \
	'sky model clear from 120,35 illuminance 10000'; do
	glowworm bake floor.ply -q --light "$light" --light-samples 512 --albedo constant:0.5 \
		--fields irradiance -o lit.ply --force
	glowworm convert lit.ply - --output-format csv | awk -F , '
		NR == 1 { for (i = 1; i <= NF; i++) if ($i ~ /irradiance_g$/) c = i }
		NR > 1 { sum += $c; n++ }
		END { printf "%.2f\n", sum / n / 10000 }'
done
# A sky with a map shines in frames too.
cat >frames.json <<'END'
{"version": 1, "frames": 2, "inputs": [{"file": "floor.ply"}], "lights": [
  {"type": "sky", "model": "overcast", "illuminance": 10000},
  {"type": "point", "position": [0, 0, 1], "intensity": 0,
   "path": [{"frame": 0, "intensity": 0}, {"frame": 1, "intensity": 0}]}]}
END
glowworm bake frames.json -q --light-samples 512 --albedo constant:0.5 --fields irradiance \
	--frames 1 -o 'frame-%04d.ply' 2>&1
glowworm convert frame-0001.ply - --output-format csv | awk -F , '
	NR == 1 { for (i = 1; i <= NF; i++) if ($i ~ /irradiance_g$/) c = i }
	NR > 1 { sum += $c; n++ }
	END { printf "%.2f\n", sum / n / 10000 }'
