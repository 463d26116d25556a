# One scene lit again: from a transport, and by mixing what each lamp gave. The same lamps give the
# same bytes; what does not fit is refused, and no output is touched.
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
make_box --scene corner --points 3000 -o box.ply
lamp='point name lamp at 0.5,0.5,0.8 intensity 2'
sky='sky radiance 0.3'
bake() {
	glowworm bake box.ply -q "$@" 2>&1
	echo "status $?"
}
columns() {
	glowworm info "$1" --json | tr '{' '\n' |
		sed -n 's/.*"name": "\(scalar_[^"]*\)".*/\1/p' | xargs
}
bake --light "$lamp" --light "$sky" --save-transport t.gwt -o first.ply
bake --light "$lamp" --light "$sky" --transport t.gwt -o again.ply
cmp first.ply again.ply
bake --light "$sky" -o fresh.ply
bake --light "$sky" --transport t.gwt -o other.ply
cmp fresh.ply other.ply
echo "a transport alone, through a pipe:"
glowworm bake box.ply -q --save-transport - | cat >piped.gwt
glowworm bake box.ply -q --save-transport unlit.gwt
cmp piped.gwt unlit.gwt
bake --light "$sky" --transport - -o from-pipe.ply <piped.gwt
cmp fresh.ply from-pipe.ply

echo "lamps:"
bake --light "$lamp" --light "$sky" --light 'point at 0.4,0.4,0.5 intensity 0.1' \
	--light 'point name a/lamp at 0.4,0.4,0.5 intensity 0.1' \
	--fields lights,ao,error,normals --transport t.gwt -o parts.ply
columns parts.ply
glowworm mix parts.ply --gain lamp=2 -q -o mixed.ply
bake --light "${lamp%2}4" --light "$sky" --light 'point at 0.4,0.4,0.5 intensity 0.1' \
	--light 'point name a/lamp at 0.4,0.4,0.5 intensity 0.1' --transport t.gwt -o doubled.ply
# The bounces that are left out are the tolerance, 0.1 %.
glowworm compare mixed.ply doubled.ply --max-relrmse 0.002 >/dev/null
echo "status $?"
echo "lit once more, columns of the earlier bake are gone:"
glowworm bake parts.ply --light "$sky" -q -o once-more.ply
columns once-more.ply

echo "refused:"
head -c 5000 t.gwt >short.gwt
bake --light "$sky" --transport short.gwt -o none.ply
bake --light "$sky" --transport box.ply -o none.ply
bake --light "$sky" --transport missing.gwt -o none.ply
bake --light "$sky" --transport t.gwt --rays 32 -o none.ply
bake --light "$sky" --transport t.gwt --albedo-scale 0.5 -o none.ply
bake --light "$sky" --transport t.gwt --max-error 0.1 -o none.ply
bake --light "$sky" --transport t.gwt --vdb none.vdb -o none.ply
bake --light "$sky" --save-transport t.gwt -o none.ply
bake --light "$sky" --transport t.gwt --save-transport t.gwt -f -o none.ply
bake --save-transport new.gwt --albedo property:missing
ls none.ply none.vdb new.gwt 2>/dev/null
make_box --scene corner --points 3001 -o box.ply
bake --light "$sky" --transport t.gwt -o none.ply
ls
# An octree much deeper than its points ask for, beside which a coarser one is made again.
make_box --scene furnace --points 1500 --emission 0 -o deep.ply
. "$SOURCE/tests/cli/shared_functions"
deep() {
	glowworm bake deep.ply --normals given --depth 9 --light 'sky radiance 1' \
		--estimate-points 0 -q -f "$@"
}
deep --save-transport deep.transport -o deep.lit.ply
deep --transport deep.transport -o deep.again.ply
[ "$(body deep.lit.ply)" = "$(body deep.again.ply)" ] ||
	echo "a deep octree is lit otherwise from a transport"
# Grids of voxels, from what was saved beside some.
voxels() { glowworm bake box.ply --light "$sky" --depth 5 -q -f -o lit.ply "$@"; }
voxels --save-transport voxels.gwt --vdb first.vdb
voxels --transport voxels.gwt --vdb again.vdb
cmp first.vdb again.vdb

# Few records, to which the lamp of a transport had some added, and to which other lamps add more:
# to none that lie in the file. Where the last ones were in vain, the same lamp asks for no more.
make_box --scene cornell --points 20000 -o few.ply
few() {
	glowworm bake few.ply --least-records 100 -q -f --report few.json "$@" ||
		echo "a bake of few records ends with $?"
	sed -n 's/^ "records": \([0-9]*\).*/\1/p' few.json
}
vain='--most-records 1400 --record-spacing 1.25 --gathered-error 0.005'
spot='spot at 0.5,0.5,0.5 to 0.9,0.9,0 intensity 100 inner 10 outer 30'
# shellcheck disable=SC2086
saved=$(few $vain --save-transport few.transport --light "$spot" -o few.lit.ply)
grep '"gathered_goal"' few.json
# shellcheck disable=SC2086
again=$(few $vain --transport few.transport --light "$spot" -o few.again.ply)
[ "$(body few.lit.ply)" = "$(body few.again.ply)" ] && [ "$saved" = "$again" ] ||
	echo "the same lamp adds records in vain: $saved, then $again"
spot='spot at 0.5,0.5,0.5 to 0.9,0.9,0 intensity 10000 inner 2 outer 4'
some='--most-records 100 --gathered-error 0.4'
# shellcheck disable=SC2086
unlit=$(few $some --save-transport unlit.transport)
# shellcheck disable=SC2086
lit=$(few $some --transport unlit.transport --light "$spot" -o few.lit.ply)
[ "$lit" -gt "$unlit" ] || echo "a lamp has added none to $unlit records: $lit"
