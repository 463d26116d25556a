# Gaps that a scanner could not look into: what is said of them, what closes them, where they are
# seen, and what is said when no scanner is known.
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
# A floor and a wall as seen from 0,0,1.5, with what the board between them hides.
awk 'BEGIN {
	srand(3); print "x y z"
	for (i = 0; i < 10000; i++) {
		x = rand() * 8 - 4; y = rand() * 8 - 4
		if (y > 1 && x / y < 0.5 && x / y > -0.5) continue
		print x, y, 0 }
	for (i = 0; i < 6000; i++) {
		x = rand() * 8 - 4; z = rand() * 3
		if (x < 2 && x > -2 && z < 2.5) continue
		print x, 4, z }
	for (i = 0; i < 1000; i++) print rand() - 0.5, 1, rand() * 1.2 }' >room.txt
bake() { # NAME option...
	name=$1
	shift
	glowworm bake room.txt -o "$name.ply" --light 'sky radiance 1' \
		--albedo constant:0.5 "$@" 2>&1 | grep 'note: .*gaps' | sed 's/[0-9][0-9.]* %/N %/g'
}
mean() { # NAME: of the red radiance
	glowworm convert "$1.ply" sums.csv -f
	awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) if ($i ~ /radiance_r/) c = i; next }
		{ s += $c } END { printf "%.5f\n", s / (NR - 1) }' sums.csv
}
bake open --scanner 0,0,1.5 --fields unknown
bake black --scanner 0,0,1.5 --gaps black
bake none --gaps black
# Black gaps are darker; gaps as bright as the sky change nothing.
bake sky --scanner 0,0,1.5 --gaps black --gap-radiance 1
echo "$(mean open) $(mean black) $(mean sky)" |
	awk '!($2 < $1 && $2 > 0.9 * $1 && $3 - $1 < 1e-5 && $1 - $3 < 1e-5) { print }'
glowworm render open.ply --view gaps -o gaps.png --size 40x30 -q
glowworm render black.ply --view gaps -o gaps.png --size 40x30 -q -f 2>&1
echo "status $?"
# A lamp where the scanner did not look: closed gaps would leave all dark, and do.
behind() { # NAME option...
	name=$1
	shift
	glowworm bake room.txt -o "$name.ply" --light 'point at 0,2,0.3 intensity 5' \
		--albedo constant:0.5 --scanner 0,0,1.5 "$@" 2>&1 |
		sed -n 's/.*note: .* pass gaps.*; \(.*\)/\1/p; /lights nothing/p; /nobody knows/p'
}
behind unseen
behind closed --gaps black
