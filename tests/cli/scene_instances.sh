# What stands in several places is named once: the light is that of inputs with these matrices, to
# the byte, of clouds and of meshes. A cloud is read once, from a pipe too.
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
. "$SOURCE/tests/cli/shared_functions"
make_box --scene furnace --points 400 -o ball.ply
printf 'v %s\n' '-1 -1 -2' '1 -1 -2' '0 1 -2' >floor.obj
echo 'f 1 2 3' >>floor.obj
half='0.5,0,0,0, 0,0.5,0,0, 0,0,0.5,0, 0,0,0,1'
here='1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1' there='0,-1,0,3, 1,0,0,0, 0,0,1,0, 0,0,0,1'
turned='0,-0.5,0,3, 0.5,0,0,0, 0,0,0.5,0, 0,0,0,1'
scene() {
	printf '{"version": 1, "inputs": [%s],\n "lights": [{"type": "point",' "$1"
	printf '"position": [1, 0, 3], "intensity": 5}], "bake": {"count": 300}}\n'
}
scene "{\"file\": \"ball.ply\", \"matrix\": [$half], \"instances\": [[$here], [$there]]},
	{\"file\": \"floor.obj\", \"instances\": [[$here], [$there]]}" >instances.json
scene "{\"file\": \"ball.ply\", \"matrix\": [$half]},
	{\"file\": \"ball.ply\", \"matrix\": [$turned]},
	{\"file\": \"floor.obj\"}, {\"file\": \"floor.obj\", \"matrix\": [$there]}" >inputs.json
sed 's/ball.ply/-/' instances.json >pipe.json
run 0 bake instances.json -q -o instances.ply
run 0 bake inputs.json -q -o inputs.ply
run 0 bake pipe.json -q -o pipe.ply <ball.ply
[ "$(body instances.ply)" = "$(body inputs.ply)" ] && echo "as by inputs"
[ "$(body instances.ply)" = "$(body pipe.ply)" ] && echo "as from a pipe"
glowworm info instances.ply --json | grep -o '"points": [0-9]*' | head -n 1

# What is wrong is said with its place.
scene '{"file": "ball.ply", "instances": []}' >empty.json
scene "{\"file\": \"ball.ply\", \"instances\": [[$here], [0]]}" >short.json
still='[{"frame": 0, "move": [0, 0, 0]}]'
scene "{\"file\": \"ball.ply\", \"instances\": [[$here]], \"path\": $still}" >moving.json
scene "{\"file\": \"-\", \"mesh\": true, \"instances\": [[$here], [$there]]}" >mesh.json
for wrong in empty short moving; do
	run 65 bake $wrong.json -q -o bad.ply
done
run 2 bake mesh.json -q -o bad.ply <floor.obj
