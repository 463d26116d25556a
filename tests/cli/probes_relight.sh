# Probes lit again from a transport: the same files as without, in any light, and what does not fit
# is refused before any output is touched.
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
make_box --scene rooms --points 3000 -o rooms.ply
sky='sky radiance 0.3'
place() {
	glowworm probes rooms.ply --rays 16 --moves 4 --size 8 -q "$@" 2>&1
	echo "status $?"
}
files() { echo "-o $1.exr --json $1.json --vdb $1.vdb"; }
place $(files plain)
place $(files first) --save-transport t.gwt
place $(files again) --transport t.gwt
place $(files fresh) --light "$sky"
place $(files other) --light "$sky" --transport t.gwt
for kind in exr vdb; do
	cmp plain.$kind first.$kind
	cmp plain.$kind again.$kind
	cmp fresh.$kind other.$kind
	! cmp -s plain.$kind fresh.$kind || [ $kind = vdb ] || echo "the sky is not seen"
done
for pair in 'plain first' 'plain again' 'fresh other'; do
	set -- $pair
	diff $1.json $2.json
done
echo "through a pipe, and by a bake:"
glowworm probes rooms.ply --rays 16 --moves 4 --size 8 -q --vdb saved.vdb --save-transport - |
	cat >piped.gwt
place $(files piped) --light "$sky" --transport - <piped.gwt
cmp fresh.exr piped.exr
glowworm bake rooms.ply --rays 16 --light "$sky" -q -o fresh.ply
glowworm bake rooms.ply --rays 16 --light "$sky" -q --transport t.gwt -o other.ply
cmp fresh.ply other.ply

echo "refused:"
head -c 5000 t.gwt >short.gwt
cp t.gwt bad.gwt
printf 'x' | dd of=bad.gwt bs=1 seek=$(($(wc -c <t.gwt) - 3000)) conv=notrunc 2>/dev/null
glowworm bake rooms.ply --rays 16 -q --save-transport bake.gwt
for bad in '--transport short.gwt' '--transport bad.gwt' '--transport rooms.ply' \
	'--transport bake.gwt' '--transport missing.gwt' '--transport t.gwt --rays 32' \
	'--transport t.gwt --size 32' '--transport t.gwt --moves 5' '--transport t.gwt --grid 2' \
	'--transport t.gwt --albedo-scale 0.5' '--transport t.gwt --save-transport t.gwt -f'; do
	place $bad -o none.exr
done
place --save-transport t.gwt
place -o - --save-transport -
make_box --scene rooms --points 3001 -o rooms.ply
place --transport t.gwt -o none.exr
[ ! -e none.exr ] || echo 'an output was written'
