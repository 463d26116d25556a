# The light of a part of a scene: its points alone, in their order; what a camera sees; and
# sentences for what a region has not.
. "$SOURCE/tests/cli/shared_functions"
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
make_box --scene cornell --points 6000 -o box.ply
bake() { glowworm bake box.ply -q -f --rays 16 "$@"; }
bake -o part.ply --region 'box 0.3,1,1 0,0,0' --report part.json
# What lies there, of a box of 1 m: in the order of the input, and nothing else.
points() { glowworm convert "$1" - --output-format csv | awk -F, 'NR > 1 { print $1, $2, $3 }'; }
points box.ply | awk '$1 <= 0.3' >expected.txt
points part.ply | cmp - expected.txt && echo "the points of the box, in order"
wc -l <expected.txt | awk '{ print ($1 > 1000 && $1 < 4000) ? "a part of them" : $1 }'
grep '"region": {' part.json | grep -o '"[a-z_]*"' | tr '\n' ' '
echo
grep -m 1 '"points":' part.json | grep -q " $(wc -l <expected.txt)," && echo "counted as written"
# By a key of a scene file, the same bytes.
printf '{"version": 1, "inputs": [{"file": "box.ply"}],
"bake": {"region": "box 0.3,1,1 0,0,0", "rays": 16}}\n' >part.scene.json
glowworm bake part.scene.json -q -o key.ply
[ "$(body part.ply)" = "$(body key.ply)" ] && echo "by a key: the same"
# From the middle, an eighth of a metre up and down is seen of the wall 0.5 m away, and what reaches
# into that: discs are no wider than two spacings of 0.032 m. The tall box lies right before the
# camera.
bake -o seen.ply --region 'camera at 0.5,0.5,0.5 to 1,0.5,0.5 fov 28.072'
points seen.ply | awk '
	$1 < 0.51 { next }
	$1 < 0.999 || ($3 - 0.5) * ($3 - 0.5) > 0.189 * 0.189 { n++ }
	($3 - 0.5) * ($3 - 0.5) > 0.126 * 0.126 { around++ }
	END { print (NR > 50), n + 0, (around > 0) }'
# What is close together, and the light of each lamp by itself, go with it.
bake -o lamps.ply --region 'box 0,0,0 0.3,1,1' --fields lights,error --max-error 0.2 \
	--light 'point name lamp at 0.5,0.5,0.5 intensity 3'
glowworm info lamps.ply | grep -o 'scalar_light_lamp_r\|scalar_error'
for bad in 'box 1,2,3' 'box 1,2,3 4,5,x' 'box 0,0,0 1,1,1 2,2,2' 'sphere 1' 'camera auto' \
	'camera at 1,2,3' '' 'box 90,90,90 91,91,91' 'camera at 0,-90,0 to 0,-99,0'; do
	glowworm bake box.ply -o no.ply --region "$bad" 2>&1
	echo "exit $?"
done
for other in '--vdb no.vdb' '--vdb-sh no.vdb' '--save-transport no.transport' '--explain' \
	'--method cones'; do
	glowworm bake box.ply -o no.ply --region 'box 0,0,0 0.3,1,1' $other 2>&1
	echo "exit $?"
done
ls | grep -c '^no\.' | sed 's/^0$/nothing was written/'
