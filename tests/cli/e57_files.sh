# E57 written: nine scans stay nine scans, with their poses, rows and columns; lit ones are mixed
# and looked at as those in PLY are; the same bytes every time.
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
make_cave --points 3000 --format e57 -o cave.e57
glowworm convert cave.e57 again.e57
glowworm info cave.e57 | grep -v -e left -e cave.e57 >one
glowworm info again.e57 | grep -v again.e57 | cmp one -
for file in cave again; do
	glowworm convert -q $file.e57 $file.csv
done
cmp cave.csv again.csv
glowworm convert cave.e57 - --output-format e57 | cmp again.e57 -
# The light of a lamp, its comments and its columns, as in PLY.
bake() { glowworm bake cave.e57 --light 'point at 3.4,0,1.9 intensity 40cd name a.lamp' --rays 8 \
	--fields lights --estimate-points 0 -q -o "$1"; }
bake lit.ply && bake lit.e57
for lit in lit.ply lit.e57; do
	glowworm mix $lit --gain a_lamp=0.5 -o mixed-$lit -q
	for file in $lit mixed-$lit; do
		glowworm info $file | grep -v -e "$lit" -e format >said-$file
		glowworm convert -q $file $file.csv
	done
done
for file in lit mixed-lit; do
	cmp $file.ply.csv $file.e57.csv
	cmp said-$file.ply said-$file.e57
done
grep -e exposure -e lamps said-mixed-lit.e57 | sed 's/EV.*/EV/'
# A PTX file's pictures have rows and columns in E57, and so has its lit cloud.
make_cave --points 3000 --format ptx -o cave.ptx
glowworm convert cave.ptx ptx.e57
glowworm info ptx.e57 | grep -c Index
glowworm bake cave.ptx --light 'sky radiance 1' --rays 8 --estimate-points 0 -q -o sky.e57
glowworm info sky.e57 | grep -c Index
# A full disk.
glowworm convert cave.e57 /dev/full --output-format e57 2>&1 || echo $?
