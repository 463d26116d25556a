# Normals of which half have the wrong sign are found, said and mended; --normals given takes them
# as they are, and clean ones change no byte.
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
make_box --scene cornell --points 6000 -o box.ply
glowworm convert box.ply box.csv
awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) if ($i ~ /^n[xyz]$/) n[i] = 1; print; next }
	{ for (i in n) if (NR % 2) $i = -$i; print }' OFS=, box.csv >half.csv
light() { # input options
	glowworm bake "$@" --light 'point at 0.5,0.5,0.8 intensity 1' -f --quality draft \
		--estimate-points 0 2>&1 | grep -v 'of the light before'
}
light box.csv -o clean.ply
light box.csv -o given.ply --normals given
tail -c 100000 clean.ply | cksum >a
tail -c 100000 given.ply | cksum | cmp - a
light half.csv -o mended.csv --report mended.json 2>&1 | sed 's/: [0-9]* points/: some points/'
grep -o '"normals_turned"' mended.json
light half.csv -o wrong.csv --normals given
light box.csv -o right.csv
glowworm compare mended.csv right.csv --max-relrmse 0.05 >/dev/null && echo "the same light"
glowworm compare wrong.csv right.csv --max-relrmse 0.2 >/dev/null 2>&1 || echo "another light"
# One wall faces out of the box: that its normals are in the file does not help.
awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) if ($i ~ /^n[xyz]$/) n[i] = 1; print; next }
	{ if ($1 < 0.05) for (i in n) $i = -$i; print }' OFS=, box.csv >wall.csv
glowworm bake wall.csv --normals given --light 'point at 0.5,0.5,0.8 intensity 1' --quality draft \
	-o wall.ply 2>&1 | grep -o -- '--scanner.* settle it'
light box.csv -o none.csv --normals estimate 2>&1 | grep -o 'estimated from neighbours'
glowworm bake box.csv --normals no --light 'sky radiance 1' -o no.ply 2>&1
:
