# A room of 2 m, of 1e-20 m and of 1e9 m: info measures it, frames have the same light where lamps
# are stronger by the square of the lengths, and a picture is made or refused with a sentence.
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
faces() { # half width, points a side, which way normals point, factor: a cube's six faces
	awk -v w="$1" -v n="$2" -v out="$3" -v f="$4" 'BEGIN {
		print "x y z nx ny nz"
		for (i = 0; i < n * n; i++) for (a = 0; a < 3; a++) for (s = -1; s <= 1; s += 2) {
			p[a] = s * w; m[a] = s * out; b = (a + 1) % 3; c = (a + 2) % 3; m[b] = m[c] = 0
			p[b] = w * ((i % n + 0.5) / n * 2 - 1); p[c] = w * ((int(i / n) + 0.5) / n * 2 - 1)
			printf "%.9g %.9g %.9g %d %d %d\n", f * p[0], f * p[1], f * p[2], m[0], m[1], m[2]
		}
	}'
}
mean() { # FILE: of the red radiance
	glowworm convert "$1" sums.csv -f
	awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) if ($i ~ /radiance_r/) c = i; next }
		{ s += $c } END { print s / (NR - 1) }' sums.csv
}
near() { # WHAT FOUND EXPECTED SHARE
	awk -v a="$2" -v b="$3" -v s="$4" 'BEGIN { exit !(b > 0 && a / b > 1 - s && a / b < 1 + s) }' ||
		echo "$1 is $2 instead of $3"
}
for f in 1 1e-20 1e9; do
	faces 1 24 -1 $f >room$f.txt
	faces 0.2 10 1 $f >cube$f.txt
	awk -v f=$f 'BEGIN { printf "{\"version\": 1, \"frames\": 2, \"inputs\": " \
		"[{\"file\": \"room%s.txt\"}, {\"file\": \"cube%s.txt\", \"path\": " \
		"[{\"frame\": 0, \"move\": [0,0,0]}, {\"frame\": 1, \"move\": [%g,%g,0]}]}], " \
		"\"lights\": [{\"type\": \"point\", \"position\": [%g,%g,%g], \"intensity\": %g}], " \
		"\"bake\": {\"estimate_points\": 0}}\n", \
		f, f, f / 2, f / 5, f / 10, 0.6 * f, 0.7 * f, f * f }' >$f.scene.json
	glowworm bake $f.scene.json -q --frames all -o f$f-%d.ply
	glowworm info --stats room$f.txt --json >$f.json
	near "density of $f" "$(sed 's/.*"density": *\([^,]*\),.*/\1/' $f.json)" \
		"$(awk -v f=$f 'BEGIN { print 144 / f / f }')" 0.001
	glowworm info --stats room$f.txt | sed -n 's/^  bake *\(depth [0-9]*\),.*/\1/p'
	# The rays' noise: 0.7 % was seen, three times that.
	for i in 0 1; do
		near "frame $i of $f" "$(mean f$f-$i.ply)" "$(mean f1-$i.ply)" 0.02
	done
	glowworm render room$f.txt -o $f.png --size 40x30 -q 2>&1
	echo "render $?"
done
