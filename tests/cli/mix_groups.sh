# Lamps in groups: columns that say so, dimmed by group and one by one; and groups in one column.
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
make_box --scene plane --points 2000 -o plane.ply
cat >lamps.json <<'END'
{"version": 1, "inputs": [{"file": "plane.ply"}], "lights": [
  {"type": "point", "position": [0.2, 0.2, 0.5], "intensity": 1, "name": "left",
   "group": "head lamps"},
  {"type": "candle", "position": [0.8, 0.2, 0.5], "group": "head lamps"},
  {"type": "candle", "position": [0.5, 0.8, 0.5], "name": "head_lamps"}]}
END
bake() {
	glowworm bake lamps.json --estimate-points 0 -q "$@"
}
names() { # Names of lamps' columns
	glowworm info "$1" --json | tr '{}' '\n\n' |
		sed -n 's/^"name": "scalar_light_\(.*\)_r".*/\1/p' |
		tr '\n' ' '
	echo
}
bake --fields lights -o lights.ply
bake --fields groups -o groups.ply
names lights.ply
names groups.ply
# The same light, however it is told apart and added up again: 2^-23 for each lamp's rounding.
same() {
	glowworm compare "$1" "$2" --max-relrmse 4e-7 >/dev/null && echo same
}
glowworm mix lights.ply --group head_lamps=0.3 -q -o a.ply
glowworm mix lights.ply --gain left=0.3 --gain head_lamps.point=0.3 -q -o b.ply
glowworm mix groups.ply --group head_lamps=0.3 -q -o c.ply
glowworm mix groups.ply --gain head_lamps=0.3 -q -o d.ply
same a.ply b.ply
same a.ply c.ply
same c.ply d.ply
# All lamps at once are twice the light.
glowworm mix lights.ply --group head_lamps=2 --gain head_lamps_2=2 -q -o twice.ply
glowworm measure lights.ply --json | sed -n 's/.*"mean": \(.*\),/\1/p' >one.txt
glowworm measure twice.ply --json | sed -n 's/.*"mean": \(.*\),/\1/p' |
	paste - one.txt | awk '{ printf "%.6f\n", $1 / $2 }'
run() {
	glowworm mix "$@" 2>&1
	echo "status $?"
}
run lights.ply --group headlamps=2 -o e.ply
run groups.ply --group left=2 -o e.ply
run lights.ply --group head_lamps=x -o e.ply
run lights.ply --gain head_lamps=2 -o e.ply
sed 's/"head lamps"/"rest"/' lamps.json >rest.json
glowworm bake rest.json -o f.ply 2>&1
echo "status $?"
bake --print-scene | grep -c '"group": "head lamps"'
