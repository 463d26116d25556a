# Light from cell to cell and by the maps of probes: the same bytes twice, again by a transport,
# light of single lamps where rays are followed, and what cannot be.
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
. "$SOURCE/tests/cli/shared_functions"
make_box --scene cornell --points 800 -o box.ply
# Few cells and small maps, since what is asked holds to the bit.
bake() {
	run 0 bake box.ply -q --force --rays 16 --light-samples 16 --volume-cells 8 \
		--estimate-points 0 "$@"
}
bake -o rays.ply
lamp='point at 0.5,0.5,0.7 intensity 1'
for method in lpv probes; do
	bake --method $method -o $method.ply --save-transport $method.transport
	bake --method $method -o again.ply --threads 3
	bake --method $method -o kept.ply --light "$lamp" --transport $method.transport
	bake --method $method -o lamp.ply --light "$lamp"
	bake --method $method -o stated.ply --estimate-points 20
	[ "$(body $method.ply)" = "$(body stated.ply)" ] || echo "$method: other light with an estimate"
	[ "$(body $method.ply)" = "$(body again.ply)" ] && echo "$method: the same light"
	[ "$(body lamp.ply)" = "$(body kept.ply)" ] && echo "$method: the same lamp by a transport"
	[ "$(body $method.ply)" != "$(body rays.ply)" ] && echo "$method: other light than by rays"
done
# Other maps see other things, and a transport of them is another's.
bake --method probes --probe-size 16 -o small.ply
[ "$(body small.ply)" != "$(body probes.ply)" ] && echo "other maps"
run 2 bake box.ply -q --rays 16 --light-samples 16 --method probes --probe-size 16 \
	--transport probes.transport -o bad.ply
bake --method probes --light "$lamp" --fields lights -o columns.ply
grep -ac scalar_light_ columns.ply

run 2 bake box.ply --method lpv --volume-sh 9 -o bad.ply
run 2 bake box.ply --method lpv --max-error 0.1 -o bad.ply
run 2 bake box.ply --method lpv --fields lights -o bad.ply
run 2 bake box.ply --method lpv --gaps black -o bad.ply
run 2 bake box.ply --method probes --probe-size 48 -o bad.ply
run 2 bake box.ply --method probes --probe-size 2 -o bad.ply
run 2 bake box.ply --method probes --time 9 -o bad.ply
run 2 bake box.ply --method probes --gaps mean -o bad.ply
run 2 bake box.ply --method probes --region 'box 0,0,0 1,1,1' -o bad.ply
! ls | grep bad
