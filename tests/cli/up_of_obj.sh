# OBJ files have y up by custom, which counts where their points lie as if it were so: a box that is
# open to a side, with a block on its floor across y. Where nothing lies that way, or a matrix says
# how a file lies, z is up, and of other formats a note asks.
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
box() { # which columns are y and z
	awk -v y="$1" -v z="$2" '
		function corner(x, up, back) { at[1] = x; at[2] = up; at[3] = back
			print "v", at[1], at[y], at[z] }
		function cuboid(x, up, back, wide, high, deep, i) {
			for (i = 0; i < 8; i++)
				corner(x + i % 2 * wide, up + int(i / 2) % 2 * high, back + int(i / 4) * deep) }
		BEGIN { cuboid(0, 0, 0, 2, 2, 2); cuboid(0.5, 0, 0.6, 1, 0.8, 0.9)
			print "f 1 2 6 5\nf 3 4 8 7\nf 1 3 7 5\nf 2 4 8 6\nf 5 6 8 7"
			print "f 9 11 15 13\nf 10 12 16 14\nf 9 10 12 11\nf 13 14 16 15\nf 11 12 16 15" }'
}
box 2 3 >y.obj
box 3 2 >z.obj
up_in() { # input
	glowworm render "$1" --size 16x16 -o picture.png --force 2>&1 |
		grep -o -e 'nothing says .*' -e 'up [xyz]$'
}
# Scenes of few points each; by itself a mesh is sampled with a million.
scene() { # file, what else is said of it
	echo "{\"version\": 1, \"inputs\": [{\"file\": \"$1\"$2}], \"bake\": {\"count\": 3000}}"
}
scene y.obj >y.json
scene z.obj >z.json
scene y.obj ', "matrix": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]' >placed.json
glowworm sample y.obj --count 3000 -q -o y.ply
glowworm convert y.ply - --output-format csv |
	awk -F , 'NR > 1 { print "v", $1, $2, $3 }' >points.obj
for input in y.json z.json placed.json points.obj; do
	echo "$input:"
	up_in "$input"
done
glowworm info y.ply | grep ' up'
glowworm info points.obj | grep ' up'
