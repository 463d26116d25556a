# Settings that follow from a quality, an error or a time: what wins over what, what the report
# says, and that a target that is missed is said, with the points written.
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
make_box --scene corner --points 2000 -o box.ply
echo '{"version": 1, "inputs": [{"file": "box.ply"}],
	"bake": {"quality": "draft", "rays": 100}}' >a.json
show() {
	glowworm bake "$@" --print-scene |
		grep -E '"(quality|rays|light_samples|record_spacing|leaf_spacing)":'
}
echo "the scene's own rays stay, the command line's quality wins over them:"
show a.json
show a.json --quality high
show a.json --quality high --rays 7
echo "a target starts from few records:"
show box.ply --max-error 0.1
show box.ply --max-error 0.1 --quality normal
bake() {
	glowworm bake box.ply -q -f "$@"
	echo "status $?"
}
# Held against what the report says.
figures() {
	awk -F'[:,}]' '/"relative_rms"/ { for (i = 1; i < NF; i++) {
		if ($i ~ /"relative_rms"/) e = $(i + 1); if ($i ~ /"spread"/) s = $(i + 1) } }
		/^ "goal"/ { print (e + s <= limit ? "under" : "over"), $0 }' limit="$1" report.json
}
bake --max-error 0.2 -o lit.ply --report report.json
figures 0.2
# Finer than what an octree, records and rays at their limits of this small scene can give.
bake --max-error 0.00001 --quality draft --least-records 0 --depth 5 --estimate-points 50 \
	-o missed.ply --report report.json 2>err
short() {
	sed -E 's/error is .* rounds?,/error is E % after N rounds,/; s/[0-9.e+-]+ % are/N % are/
		s/about [0-9.e+]+ (s|min|h)/about T/; s/[0-9.e-]+ % (would|of)/N % \1/g
		s/alone are [0-9.]+/alone are N/; s/: [0-9.e-]+ % \+- /: N % +- /
		s/error [0-9.e-]+\)/error N)/' "$@"
}
short err
figures 0.00001
[ "$(grep -c '"record_spacing": .*"why"' report.json)" -gt 2 ] && echo "several rounds"
glowworm info missed.ply | grep -c radiance_r
# No time for a second round; without an error to reach that is no failure.
bake --time 0.001 -o timed.ply --report report.json
grep '^ "goal"' report.json
bake --time 0.001 --max-error 0.00001 -o timed.ply 2>err
short err
bake --time 0.001 --max-error 0.03 -o timed.ply 2>err
short err
# Every bake says how wrong it is and what less would cost; lamps alone, how wrong their shadows
# are.
glowworm bake box.ply -f -o lit.ply --report report.json 2>&1 | short
awk -F'[:,}]' '/^ "price"/ { print ($3 > 0 && $5 > 0 ? "a price" : "none") }' report.json
make_box --scene plane --points 4000 -o plane.ply
# Half of the plane lies in the other's shadow.
cat >shadow.json <<'EOF'
{"version": 1, "inputs": [{"file": "plane.ply"}, {"file": "plane.ply",
 "matrix": [0.5,0,0,0, 0,0.5,0,0, 0,0,0.5,0.4, 0,0,0,1]}],
 "lights": [{"type": "point", "position": [0.25, 0.25, 2], "intensity": 3}]}
EOF
glowworm bake shadow.json -f -o shadow.ply --bounces 1 --report report.json 2>&1 | short
awk -F'[:,}]' '/^ "price"/ { print ($3 > 0 && $5 > 0 ? "a price" : "none") }' report.json
glowworm bake box.ply -q -f -o lit.ply 2>&1 | short
glowworm bake box.ply -f -o lit.ply --estimate-points 0 2>&1 | short
# Of a row of points, which have no sides, none is solved again: a smaller error that is told is no
# target reached, and none that is missed either.
awk 'BEGIN { for (i = 0; i < 600; i++) print i, 0, 0 }' |
	glowworm bake - -q -f -o lit.ply --rays 8 --light 'sky radiance 1' --max-error 0.9 2>&1 |
	sed 's/of it is [0-9.]* %/of it is N %/'
# What is asked of gathered light alone, where records are few at first: how that ends is told, and
# said where it was asked for and is missed.
few() {
	glowworm bake box.ply -f -o lit.ply --report report.json --most-records 50 --least-records 0 \
		"$@" 2>&1 | sed -n 's/light is [0-9.]* % off after [0-9]* rounds/light is N % off/; /note/p'
	grep '^ "gathered_goal"' report.json
}
few --gathered-error 0.0001
few --gathered-error 0.9
few
bake --max-error 0.1 --estimate-points 0 -o none.ply
bake --max-error 5 -o none.ply
ls
