# --las-step auto: the step of LAS that came in, else by how far neighbours are apart, in the units
# of the file; not of what has no neighbours, and of degrees ever finer than a millimetre.
grid() { # how many points of how many a side, how far apart
	awk -v side="$1" -v apart="$2" -v east="${3:-0}" -v north="${4:-0}" 'BEGIN {
		for (i = 0; i < side * side; i++) printf "%.10g %.10g %.10g\n", east + i % side * apart,
			north + int(i / side) * apart, (i * 7 % 11) * apart / 1000 }'
}
step_of() { glowworm convert -q "$1" - --output-format xyz | grep -a 'las scale'; }
for apart in 1 0.09 0.08 0.01 0.0001; do
	grid 40 $apart >grid.xyz
	glowworm convert grid.xyz grid.laz --las-step auto -f 2>&1
	step_of grid.laz
done
# Of parts, too: what is known of all points; points at the same place are one.
grid 20 0.01 >twice.xyz
cat twice.xyz twice.xyz twice.xyz >thrice.xyz
glowworm convert thrice.xyz thrice.ply -q
glowworm convert thrice.ply thrice.copc.laz --las-step auto 2>&1
# What came as LAS keeps its step.
glowworm convert grid.xyz own.las --las-step 0.001 -q
glowworm convert own.las kept.las --las-step auto 2>&1
cmp own.las kept.las
glowworm convert own.las own.ply -q
glowworm convert own.ply kept.las --las-step auto -f 2>&1
cmp own.las kept.las
printf '0 0 0\n0.01 0 0\n0.03 1 2\n' >coarse.xyz
glowworm convert coarse.xyz coarse.las -q
glowworm convert coarse.las kept.las --las-step auto -f 2>&1
cmp coarse.las kept.las
# No neighbours, degrees, other formats, no word for it.
echo '1 2 3' >one.xyz
glowworm convert one.xyz one.las --las-step auto 2>&1
glowworm convert one.xyz - --output-format las -q | cmp - one.las
grid 40 1e-6 10 50 | awk '{ print $1, $2, NR % 9 }' >degrees.xyz
glowworm convert degrees.xyz degrees.las --las-step auto 2>&1
step_of degrees.las
glowworm convert one.xyz one.ply --las-step auto 2>&1
echo "status $?"
glowworm convert one.xyz two.las --las-step aut 2>&1
echo "status $?"
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
# Baked, in feet as well, and mixed.
grid 40 0.01 >grid.xyz
bake() { glowworm bake "$@" --las-step auto --light 'point at 0,0,9 intensity 9' --rays 8 -f; }
bake grid.xyz -o lit.laz 2>&1 | grep step
step_of lit.laz
bake grid.xyz -o lit.laz --units ft 2>&1 | grep step
glowworm bake grid.xyz -q -o lit.ply --fields lights --rays 8 \
	--light 'point name a at 0,0,9 intensity 9'
glowworm mix lit.ply --gain a=2 --las-step auto -o mixed.laz 2>&1
step_of mixed.laz
# Of a cloud that memory does not hold, some are kept.
make_cave --points 20000 -o cave.ply
bake cave.ply -o lit.laz --strays keep --effects lamps --memory 150M 2>&1 | grep step
step_of lit.laz
