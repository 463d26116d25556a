# Of a surface in doubt half of the points are baked for the error, also by a bake that keeps a
# transport. One that begins with it, or has no time, leaves them out, and says so; its light is
# the same.
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
make_cave --points 1000 | glowworm convert - -o cave.csv
cut -d, -f 1-3 cave.csv >bare.csv
bake() {
	glowworm bake bare.csv --quality draft --light 'point at 3.4,0,1.9 intensity 40' "$@" 2>&1 |
		grep -o 'the surface is in doubt, and --[a-z]* leaves no time'
}
bake -o fresh.ply
bake --save-transport t.gwt --report fresh.json -o kept.ply
cmp fresh.ply kept.ply
bake --transport t.gwt --report again.json -o again.ply
bake --time 0.01 -o early.ply
for file in fresh again early; do
	glowworm info $file.ply | grep -o 'by half of the points\|half of the points not asked'
	glowworm convert $file.ply - --output-format csv | md5sum >$file.sum
done
cmp fresh.sum again.sum
for file in fresh again; do
	grep -o '"halves_left_out": [a-z]*' $file.json
	grep '"spacing_ratio"\|"narrow_share"' $file.json >$file.numbers
done
cmp fresh.numbers again.numbers
