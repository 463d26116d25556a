# The report: number of points, inputs, what is in effect, luminance; the same for a scene file, and
# options win. It is JSON that names nothing but what was typed.
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
. "$SOURCE/tests/cli/shared_functions"
lamp='point at 500000.2,4000000.6,13 intensity 5'
make_cloud >a.ply
cat >scene.json <<'EOF'
{"version": 1, "inputs": [{"file": "a.ply"}, {"file": "a.ply",
 "matrix": [1,0,0,0, 0,1,0,0, 0,0,1,2, 0,0,0,1], "emission": 3, "albedo": 0.5}],
 "bake": {"rays": 16, "bounces": 2}}
EOF
glowworm bake scene.json --light "$lamp" --rays 8 --report report.json -o lit.ply 2>/dev/null
grep -E '^ "(glowworm|command|points|units)"|^  "(rays|bounces)"|^  \{"file"' report.json
for key in device driver counts plan octree stages seconds bounces remaining luminance exposure; do
	grep -q "^ \"$key\": " report.json || echo "no $key"
done
grep -c "$PWD" report.json
# The command is a recipe: it says what gives the points, not where they go.
grep -a 'glowworm command' lit.ply
glowworm info lit.ply --json | tr '{' '\n' |
	grep -e '"name": "z"' -e '"emission_r"' -e '"name": "albedo_r"'
glowworm bake scene.json --light "$lamp" --report - -q | head -n 2
# How passes run is said as well: by an option, by the scene, or by itself.
for way in auto device 'cpu --device cpu'; do
	# shellcheck disable=SC2086
	glowworm bake scene.json --light "$lamp" --passes $way --report - -q | grep '"passes"'
done
sed 's/"rays": 16/"rays": 16, "passes": "device"/' scene.json >shaders.json
glowworm bake shaders.json --light "$lamp" --report - -q | grep '"passes"'
glowworm bake scene.json --passes gpu -o no.ply 2>&1
echo $?
