# Scene files: unknown keys, wrong values and broken JSON end with status 65, line and reason.
run() {
	printf '%s\n' "$1" >scene.json
	glowworm bake scene.json -o out.ply 2>&1
	[ $? -eq 65 ] || echo "status was not 65: $1"
}
run '{"version": 1,'
run '[]'
run '{}'
run '{"version": 2}'
run '{"version": 1, "version": 1}'
run '{"version": 1, "lihgts": []}'
run '{"version": 1, "units": "candela"}'
run '{"version": 1,
 "inputs": [{"file": "a.ply"},
  {"flie": "b.ply"}]}'
run '{"version": 1, "inputs": [{}]}'
run '{"version": 1, "inputs": [{"file": ""}]}'
run '{"version": 1, "inputs": [{"file": "a.ply", "albedo": 1.5}]}'
run '{"version": 1, "inputs": [{"file": "a.ply", "specular": 1.5}]}'
run '{"version": 1, "inputs": [{"file": "a.ply", "roughness": "smooth"}]}'
run '{"version": 1, "inputs": [{"file": "a.ply", "matrix": [1, 2, 3]}]}'
run '{"version": 1, "inputs": [{"file": "a.ply", "matrix": [1,0,0,0, 0,1,0,0, 0,0,0,0, 0,0,0,1]}]}'
run '{"version": 1, "inputs": [{"file": "a.ply", "matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 5,0,0,1]}]}'
run '{"version": 1, "lights": {}}'
run '{"version": 1, "lights": [{"position": [0, 0, 0]}]}'
run '{"version": 1, "lights": [{"type": "spott"}]}'
run '{"version": 1,
 "lights": [
  {"type": "point", "position": [0, 0, 0], "intensity": 1},
  {"type": "point", "position": [0, 0, 0],
   "intensity": "bright"}]}'
run '{"version": 1, "lights": [{"type": "point", "intensity": 1}]}'
run '{"version": 1, "lights": [{"type": "spot", "position": [0, 0, 0], "intensity": 1}]}'
run '{"version": 1, "lights": [{"type": "sun", "irradiance": -1}]}'
run '{"version": 1, "lights": [{"type": "environment", "file": "sky.exr", "map": "sky.exr"}]}'
run '{"version": 1, "lights": [{"type": "point", "outer_angle": 3}]}'
run '{"version": 1, "bake": {"light_sample": 3}}'
run '{"version": 1, "bake": {"rays": 0}}'
run '{"version": 1, "bake": {"rays": [1]}}'
run '{"version": 1, "bake": {"output": "other.ply"}}'
light() {
	run "{\"version\": 1, \"lights\": [$1]}"
}
spot='"type": "spot", "position": [0, 0, 1], "intensity": 1'
light '{"type": "point", "position": [0, 0, 1], "intensity": NaN}'
light '{"type": "point", "position": [0, 0, 1], "intensity": "nan"}'
light '{"type": "point", "position": [0, 0, 1], "intensity": 1e400}'
light '{"type": "point", "position": [0, 0, 1], "intensity": -1}'
light '{"type": "point", "position": [0, 0, 1e300], "intensity": 1}'
light '{"type": "point", "position": [0, 0, 1], "intensity": "3lx"}'
light "{$spot, \"direction\": [0, 0, 0]}"
light "{$spot, \"direction\": [1e-200, 0, 0]}"
light "{$spot, \"direction\": [0, 0, -1], \"inner_angle\": 50, \"outer_angle\": 40}"
light "{$spot, \"direction\": [0, 0, -1], \"inner_angle\": 0, \"outer_angle\": 0}"
light "{$spot, \"direction\": [0, 0, -1], \"outer_angle\": 1e9}"
light '{"type": "sun", "from": [10, -5], "irradiance": 1}'
light '{"type": "sun", "place": [91, 8], "time": "2026-06-21T14:30Z", "illuminance": 1}'
light '{"type": "sun", "place": [47, 8], "time": "2026-12-21T23:30Z", "illuminance": 1}'
light '{"type": "sphere", "position": [0, 0, 1], "radius": 1e-30, "lumens": 3}'
light '{"type": "disc", "position": [0, 0, 1], "radius": 1e30, "lumens": 3}'
light '{"type": "rectangle", "position": [0, 0, 1], "size": [1e30, 1], "lumens": 3}'
light '{"type": "point", "position": [0, 0, 1], "intensity": "3cd"},
  {"type": "sun", "from": [10, 40], "irradiance": "3W/m^2"}'
run '{"version": 1, "bake": {"effects": "shadow"}}'
run '{"version": 1, "bake": {"effects": ""}}'
# What the command line overrides still has to make sense.
printf '{"version": 1, "bake": {"rays": 0}}' >scene.json
glowworm bake scene.json --rays 8 -o out.ply 2>&1 || echo "$?"
# 3000 open brackets: refused, no crash.
awk 'BEGIN { printf "{\"version\": "; for (i = 0; i < 3000; i++) printf "["; print "" }' >deep.json
glowworm bake deep.json -o out.ply 2>&1 || echo "$?"
glowworm bake missing.json -o out.ply 2>&1 || echo "$?"
