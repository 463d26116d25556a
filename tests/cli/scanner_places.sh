# Where scanners stood can be said, on the command line, in a list and in a scene file: a box
# without normals, lit from outside, shows its inside to a scanner in its middle.
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
# Text without normals; the middle of the box is at 0.5,0.5,0.5.
awk 'BEGIN { for (i = 0.5; i < 20; i++) for (j = 0.5; j < 20; j++) { a = i / 20; b = j / 20
	print a, b, 0; print a, b, 1; print a, 0, b
	print a, 1, b; print 0, a, b; print 1, a, b } }' >box.xyz
printf '# places\n\n0.5, 0.5 0.5 # the middle\n4,4,4\n' >places.txt
inwards() { # options
	glowworm bake box.xyz "$@" --light 'point at 9,0.5,0.5 intensity 1' --fields normals -q -f \
		-o lit.csv --quality draft --estimate-points 0
	awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) c[$i] = i; next }
		{ s = 0; split("x y z", a, " ")
		for (i in a) s += (0.5 - $c[a[i]]) * $c["n" a[i]]
		n += s > 0 } END { print (n > 2300 ? "in" : n < 100 ? "out" : n) }' lit.csv
}
inwards --scanner 0.5,0.5,0.5
inwards --scanner=4,0.5,0.5 --scanner -4,0.5,0.5 --scanner 0.5,-4,0.5 --scanner 0.5,4,0.5 \
	--scanner 0.5,0.5,-4 --scanner 0.5,0.5,4
inwards --scanner @places.txt
echo '{"version": 1, "inputs": [{"file": "box.xyz"}], "scanners": [[0.5, 0.5, 0.5]]}' >box.json
glowworm bake box.json --light 'sky radiance 1' --print-scene | grep -A 2 scanners
# A scan of which no more is known than its points: the place is told by their density. Of two scans
# in one file none is.
seen_from() { # x y z points
	awk -v x="$1" -v y="$2" -v z="$3" -v n="$4" 'BEGIN { e[0] = x; e[1] = y; e[2] = z
		for (i = 0; i < n; i++) { w[2] = 1 - (2 * i + 1) / n; r = sqrt(1 - w[2] * w[2]); t = 9
			w[0] = r * cos(2.399963 * i); w[1] = r * sin(2.399963 * i)
			for (k = 0; k < 3; k++) {
				s = w[k] > 0 ? (1 - e[k]) / w[k] : e[k] / -w[k]; if (s < t) t = s }
			print x + t * w[0], y + t * w[1], z + t * w[2] } }'
}
told() { # FILE, places that it was scanned from; 0.05: one neighbourhood of a thousand is wider
	glowworm info --stats "$1" | awk -v places="$2" '
		/ at / { at[++n] = $(NF - 2) "," $(NF - 1) "," $NF }
		END { m = split(places, e, " "); ok = n == m
		for (i = 1; i <= m; i++) { split(at[i], a, ","); split(e[i], b, ",")
			for (k = 1; k <= 3; k++) ok = ok && (a[k] - b[k]) ^ 2 < 0.05 ^ 2 }
		print (ok ? "found" : "not found") }'
}
seen_from 0.3 0.6 0.5 3000 >seen.xyz
told seen.xyz 0.3,0.6,0.5
# So is that of rows and columns which no one place sees at even angles.
{ printf '%s\n' 'VERSION .7' 'FIELDS x y z' 'SIZE 4 4 4' 'TYPE F F F' 'COUNT 1 1 1' 'WIDTH 60' \
	'HEIGHT 50' 'VIEWPOINT 0 0 0 1 0 0 0' 'POINTS 3000' 'DATA ascii'; cat seen.xyz; } >seen.pcd
told seen.pcd 0.3,0.6,0.5
# An organised cloud stays one, lit or converted; not by way of E57, which leaves out its one hole.
glowworm bake seen.pcd --light 'sky radiance 1' -f -q -o lit.pcd --estimate-points 0
glowworm convert lit.pcd -o again.pcd
glowworm convert lit.pcd -o lit.e57 -q
glowworm convert lit.e57 -o whole.pcd 2>&1 | grep -o 'rows and columns of 1 scan'
grep -a -h -e WIDTH -e HEIGHT lit.pcd again.pcd whole.pcd
{ seen_from 0.3 0.6 0.5 7000; seen_from 0.7 0.3 0.4 7000; } >both.xyz
told both.xyz ''
noted() { # options
	glowworm bake seen.xyz "$@" --light 'sky radiance 1' -f -o lit.ply --quality draft \
		--estimate-points 0 2>&1 | grep -c 'as densely as if one scanner'
}
noted
noted --scanner none
glowworm bake box.json --scanner none --light 'sky radiance 1' --print-scene >none.json
grep scanners none.json
glowworm bake none.json --print-scene | cmp - none.json
# What is no place.
printf '1,2,3\n1;2;3\n' >bad.txt
echo '# none' >empty.txt
for place in 1,2 1,2,3,4 some 1,2,nan @bad.txt @empty.txt @missing.txt @; do
	glowworm bake box.xyz --scanner $place --light 'sky radiance 1' -o out.ply 2>&1 &&
		echo "it was taken"
done
:
