# The cave as scans of nine stations: PTX and E57 hold the points that the PLY of the same rays has,
# in the same order, to the steps of each format; holes are left out and counted; the scanners stand
# where the stations are.
set -eu
make_cave --grid --points 20000 --noise 0.002 -o cave.ply
make_cave --points 20000 --noise 0.002 --format ptx -o cave.ptx
make_cave --points 20000 --noise 0.002 --format e57 -o cave.e57
glowworm convert cave.ply ply.csv
for format in ptx e57; do
	glowworm convert "cave.$format" "$format.csv" -q
	# Each of three coordinates is off by half a step at most (5e-7 or 5e-6 m), and so is the whole
	# by its length, however it is turned; places in a PTX file have 6 decimals. Below 64 m float32
	# is good to half of 2^-18, and so is the shortest text that stands for one.
	tolerance=$(awk -v step=$([ $format = ptx ] && echo 1e-6 || echo 1e-5) 'BEGIN {
		print sqrt(3) * step / 2 + 0.5e-6 + 2 * 2 ^ -19 }')
	paste -d , ply.csv "$format.csv" | awk -F , -v tolerance="$tolerance" -v format="$format" '
		function off(a, b) { return (a > b ? a - b : b - a) > tolerance }
		NR == 1 { for (i = 1; i <= NF; i++) { if ($i in first) second[$i] = i; else first[$i] = i }
			next }
		{ for (name in second)
			if (name ~ /^[xyz]$/ ? off($first[name], $second[name]) : $first[name] != $second[name])
				bad[name]++ }
		END { print format, (NR > 10000 ? "many" : NR), length(second) " columns"
			for (name in bad) print name ": " bad[name] " differ" }'
done

# Cells are columns times rows, and every one is a point or left out.
holes=$(grep -c '^0 0 0 0.500000 0 0 0' cave.ptx)
points=$(($(wc -l <ply.csv) - 1))
echo $(($(wc -l <cave.ptx) - 9 * 10 - holes - points))
for format in ptx e57; do
	glowworm info --json "cave.$format" >info
	grep -c "\"left_out\": $holes,\|\"left_out\": $holes\$" info
	grep -c "\"points\": $points," info
done
glowworm info cave.e57 | sed -n '/scanner/,/bounds/p' | sed '/bounds/d;s/.* at //' >scanners
make_cave --stations | awk '{ print $2 + 0, $3 + 0, $4 + 0 }' | cmp - scanners

# Standard output, the same bytes every time, and a full disk.
make_cave --points 500 --format e57 | cksum >once
make_cave --points 500 --format e57 -o again.e57
cksum <again.e57 | cmp - once
make_cave --points 5000 --format ptx -o /dev/full || echo $?
