# The generator of scenes with closed forms: unit normals that face the right way, emission and
# albedo where they belong, errors in words.
set -eu

# Points as text: x y z nx ny nz emission_r, one a line.
points() { # scene
	make_box --scene "$1" --points 2000 -o "$1.ply"
	header=$(sed '/^end_header$/q' "$1.ply" | wc -c)
	tail -c +$((header + 1)) "$1.ply" | od -A n -v -t u1 -w39 | awk -v OFMT=%.9g '
		function value(i, b, e, m) {
			b = $(i + 3) * 16777216 + $(i + 2) * 65536 + $(i + 1) * 256 + $i
			e = int(b / 8388608) % 256; m = b % 8388608
			if (e == 0) return 0
			return (b >= 2147483648 ? -1 : 1) * (1 + m / 8388608) * 2 ^ (e - 127)
		}
		{ print value(1), value(5), value(9), value(13), value(17), value(21), value(28), $25 }'
}

# Float32 positions on the sphere are good to 1e-7, and so are their sums of three to 1e-6.
points furnace | awk '
	{ r = $1 * $1 + $2 * $2 + $3 * $3; inward = -($1 * $4 + $2 * $5 + $3 * $6)
	  if (r < 0.999999 || r > 1.000001 || inward < 0.999999 || $7 != 1) bad++ }
	END { print "furnace", NR, bad + 0 }'
points rooms | awk '
	{ room = $1 < 2.01 ? 1 : 3.05; facing = $4 * (room - $1) + $5 * (1 - $2) + $6 * (1 - $3)
	  if (facing < 0.99) bad++
	  lamp = $1 < 2.01 && $3 > 1.99 && $6 < 0
	  if (($7 == 1) != lamp) bad++
	  second += room > 2 }
	END { print "rooms", NR, bad + 0, (second > 850 && second < 1150) ? "both" : second }'
points corner | awk '
	{ if ($6 == 1 ? $3 != 0 || $7 != 1 : $1 != 0 || $4 != 1 || $7 != 0) bad++ }
	END { print "corner", NR, bad + 0 }'
points plane | awk '{ if ($3 != 0 || $6 != 1 || $7 != 0) bad++ } END { print "plane", NR, bad + 0 }'
# The lamp of the Cornell box is 1/16 of a ceiling among 5 walls and 2 blocks; albedo 0.5 is 188.
points cornell | awk '
	$7 == 15 { lamps++; if ($6 != -1) bad++ }
	$1 == 0 && $8 != 188 { bad++ }
	END { print "cornell", NR, bad + 0, (lamps > 5 && lamps < 60) ? "lit" : lamps }'

make_box --scene plane --points 10 --albedo 1,2 || echo $?
make_box --scene castle || echo $?
make_box || echo $?
