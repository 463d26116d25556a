# PLY files of Gaussian splats: a room with a ball in it, haze in its air, as trainers write them.
# The walls' splats are flat and of either side, thin along x, y or z of their own by turns, and
# their quaternions have any length; of the ball no axis is the thinnest.
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }

# splats SCALES HAZE: 4800 of the walls, 1500 of the ball, 0.4 m, and of haze.
splats() {
	awk -v scales="$1" -v haze="$2" '
	function splat(x, y, z, red, opacity, a, b, c, w, i, j, k) {
		printf "%.5f %.5f %.5f 0 0 0", x, y, z
		printf " %.7f 0 0 9 9 9 %.6f", (red - 0.5) / h, log(opacity / (1 - opacity))
		printf " %.5f %.5f", a, b
		if (scales == 3)
			printf " %.5f", c
		s = 0.5 + rand()
		printf " %.7f %.7f %.7f %.7f\n", s * w, s * i, s * j, s * k
	}
	# Turns z of a splat to axis k: its third scale is the thin one, as where there are two.
	function wall(k, side,    p, r) {
		p[0] = 3 * rand(); p[1] = 2 * rand(); p[2] = 3 * rand()
		p[k] = side * (k == 1 ? 2 : 3)
		r = sqrt(0.5) * (rand() < 0.5 ? -1 : 1)
		splat(p[0], p[1], p[2], k == 1 ? 0.9 : 0.2, 0.9, -3, -3.2, -6,
			k == 2 ? 1 : sqrt(0.5), k == 1 ? r : 0, k == 0 ? r : 0, 0)
	}
	BEGIN {
		srand(1); h = 0.28209479177387814
		print "ply\nformat ascii 1.0\nelement vertex " 6300 + haze
		n = split("x y z nx ny nz f_dc_0 f_dc_1 f_dc_2 f_rest_0 f_rest_1 f_rest_2" \
			" opacity scale_0 scale_1" (scales == 3 ? " scale_2" : "") " rot_0 rot_1 rot_2 rot_3",
			name, " ")
		for (i = 1; i <= n; i++) print "property float " name[i]
		print "end_header"
		for (i = 0; i < 4800; i++) wall(i % 3, int(i / 3) % 2)
		for (i = 0; i < 1500; i++) {
			z = 2 * rand() - 1; angle = 6.2831853 * rand(); r = 0.4 * sqrt(1 - z * z)
			splat(1.5 + r * cos(angle), 1.2 + 0.4 * z, 1.5 + r * sin(angle), 0.5, 0.8,
				-4, -4.1, -4.2, 1, 0, 0, 0)
		}
		for (i = 0; i < haze; i++)
			splat(0.2 + 2.6 * rand(), 0.2 + 1.6 * rand(), 0.2 + 2.6 * rand(),
				1, 0.05 + 0.4 * rand(), -2, -2, -2, 1, 0, 0, 0)
	}'
}

# Bakes are compared byte for byte, which any number of rays shows.
bake() { # name, input, options
	name=$1
	shift
	glowworm bake "$@" --estimate-points 0 --rays 16 --colors keep --fields normals \
		--report "$name.json" --force -o "$name.csv" 2>"$name.notes" || cat "$name.notes"
}

# Points whose normal leads out of the room or into the ball, which is 0.4 m wide.
turned() {
	awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) c[$i] = i; next }
		$c["splat_opacity"] < 0.5 { next }
		{ x = $c["x"] - 1.5; y = $c["y"] - 1.2; z = $c["z"] - 1.5; r = sqrt(x * x + y * y + z * z)
			s = r < 0.41 ? 1 : -1; y += r < 0.41 ? 0 : 0.2; n++
			out += s * (x * $c["nx"] + y * $c["ny"] + z * $c["nz"]) < 0 }
		END { print n, "points,", (out < 0.005 * n ? "less" : "more") " than 0.5 % turned" }' "$1"
}

lamp='point at 1.5,0.3,1.5 intensity 5'
splats 3 2000 >haze.ply
splats 3 0 >clean.ply
splats 2 0 >flat.ply
glowworm convert haze.ply haze.csv 2>notes
grep -o "note: its .*" notes
head -n 1 haze.csv
# Red of a splat of 0.9 is 229 or 230 of 255; f_dc of 0 is the middle.
awk -F, 'NR > 1 && NR < 4802 { print $4, $5, $6 }' haze.csv | sort | uniq -c
# Each wall has its own axis, of no side; the ball has none.
awk -F, 'NR > 1 && NR < 6302 {
	for (k = 8; k <= 10; k++) c[k] += $k * $k > 0.9999; none += $8 == 0 && $9 == 0 && $10 == 0 }
	END { print c[8], c[9], c[10], none }' haze.csv

bake haze haze.ply --light "$lamp"
bake clean clean.ply --light "$lamp"
bake flat flat.ply --light "$lamp"
bake keep haze.ply --light "$lamp" --strays keep
turned haze.csv
turned flat.csv
grep -o '"kind": "haze", "points": [0-9]*' haze.json keep.json
# Haze is lit and changes nothing of the rest.
points() { awk -F, 'NR > 1 && NR < 6302' "$1"; }
points haze.csv >a
points clean.csv >b
points keep.csv >c
cmp a b && echo "haze changes no light"
cmp -s a c || echo "kept, it does"
# A lit file is lit again as it was.
glowworm bake haze.ply --light "$lamp" --estimate-points 0 --fields normals -o lit.ply 2>/dev/null
bake again lit.ply --light "$lamp"
grep -o '"kind": "haze", "points": [0-9]*' again.json
grep -c Gaussian again.notes || :
turned again.csv
# Beside what has normals, axes are given up; and another way up is what --up says.
echo '{"version": 1, "inputs": [{"file": "clean.ply"},
	{"file": "lit.ply", "matrix": [1,0,0,9, 0,1,0,0, 0,0,1,0, 0,0,0,1]}],
	"lights": [{"type": "point", "position": [1.5, 0.3, 1.5], "intensity": 5}]}' >pair.scene.json
bake two pair.scene.json --up z
grep -o '[0-9]* whose normal was missing or bad' two.notes
# Opacity that is none of a splat's is still refused.
sed 's/property float rot_0/property float spin/' clean.ply >other.ply
glowworm bake other.ply --light "$lamp" -o other.csv 2>&1 || echo "exit $?"
