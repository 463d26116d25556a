# Where scanners stood can be said, on the command line, in a list and in a scene file: a box
# without normals, lit from outside, shows its inside to a scanner in its middle.
glowworm info --devices >/dev/null 2>&1 || { echo "there is no Vulkan device"; exit 77; }
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
# What is no place.
printf '1,2,3\n1;2;3\n' >bad.txt
echo '# none' >empty.txt
for place in 1,2 1,2,3,4 1,2,nan @bad.txt @empty.txt @missing.txt @; do
	glowworm bake box.xyz --scanner $place --light 'sky radiance 1' -o out.ply 2>&1 &&
		echo "it was taken"
done
:
