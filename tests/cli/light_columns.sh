# Columns of light add up: what a point sends out is what it makes itself, and what it reflects of
# direct and of indirect light; irradiance has names of its own; and lux are the luminance of it.
# Columns are 32-bit floats, of which each is rounded to 6e-8, and so are the products behind them.
make_box --scene cornell --points 4000 -o box.ply
sums() { # The columns of a CSV file by name, and what of them does not add up.
	awk -F, -v check="$2" '
		function near(a, b, what) {
			if (a - b > 2e-6 * (a + b) || b - a > 2e-6 * (a + b))
				wrong[what]++
		}
		function value(name) {
			if (!(name in at)) {
				print name " is missing"
				exit 1
			}
			return $at[name]
		}
		NR == 1 { for (i = 1; i <= NF; i++) { gsub(/^[ #]+|[" ]/, "", $i); at[$i] = i }; next }
		{
			for (k = 1; k <= 3; k++) {
				c = "_" substr("rgb", k, 1)
				own = "emission" c in at ? value("emission" c) : 0
				d = value("scalar_direct_irradiance" c)
				i = value("scalar_indirect_irradiance" c)
				sum = own + value("scalar_direct" c) + value("scalar_indirect" c)
				near(value("scalar_radiance" c), sum, "radiance")
				near(value("scalar_irradiance" c), d + i, "irradiance")
				# The reflected shares are the same: both are rho / pi.
				near(value("scalar_direct" c) * i, value("scalar_indirect" c) * d, "albedo")
				lit[c] += value("scalar_indirect" c) > 0
			}
			if (check == "photometric") {
				lux = 0.2126 * value("scalar_irradiance_r")
				lux += 0.7152 * value("scalar_irradiance_g")
				lux += 0.0722 * value("scalar_irradiance_b")
				near(value("scalar_illuminance"), lux, "illuminance")
				near(value("scalar_luminance"), value("quality"), "luminance")
			}
			own > 0 ? glowing++ : 0
		}
		END {
			for (what in wrong)
				print what, "of", wrong[what], "values"
			print NR - 1, "points,", (glowing > 0 ? "some glow," : "none glows,"),
				(lit["_r"] > NR / 2 ? "lit" : "dark")
		}' "$1"
}
fields=direct,indirect,irradiance,direct-irradiance,indirect-irradiance
glowworm bake box.ply --fields $fields -q -o box.csv
sums box.csv
# A lamp, and another unit.
glowworm bake box.ply --light 'point at 0.5,0.5,0.5 intensity 10cd' --strays drop \
	--fields $fields,illuminance,luminance -q -o lamp.csv
sums lamp.csv photometric
# Lux need a unit.
for unit in '' W/sr; do
	glowworm bake box.ply --light "point at 0.5,0.5,0.5 intensity 10$unit" --fields illuminance \
		-o none.ply 2>&1
	echo "status $?"
done
glowworm bake box.ply --light 'point at 0.5,0.5,0.5 intensity 1' --fields luminance -o none.ply 2>&1
# The columns of an earlier bake are replaced, none stays.
glowworm bake lamp.csv --light 'point at 0.5,0.5,0.5 intensity 10' --fields ao,bent-normals -q \
	-o again.csv
head -1 again.csv | tr ',' '\n' | sed -n 's/^[" ]*\(scalar_.*[a-z]\)[" ]*$/\1/p'
