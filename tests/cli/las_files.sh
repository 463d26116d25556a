# A georeferenced scan goes through LAS and back: lit as LAS, lit again from it, and written as PLY,
# it has the coordinates that came in, bit for bit, and its other columns.
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
{
	printf 'ply\nformat ascii 1.0\ncomment made by hand\nelement vertex 16\n'
	printf 'property double %s\n' x y z
	printf 'property uchar %s\n' red green blue
	printf 'property ushort intensity\nproperty float infrared\nend_header\n'
	awk 'BEGIN { for (i = 0; i < 16; i++) printf "%.3f %.3f %.3f %d %d %d %d %g\n",
		500000.123 + i % 4 * 0.1, 4000000.457 + int(i / 4) * 0.1, 12.25, 200, i * 16, 255 - i, i,
		i / 3 }'
} >a.ply
# The columns of a file with their ranges, but for the light.
fields() { # file
	glowworm info "$1" --json | tr '{' '\n' | grep '^"name"' |
		grep -vE '"(quality|scalar_[a-z_]*|n[xyz]|red|green|blue)"' | sed 's/}.*//'
}
glowworm bake a.ply -q --light 'sky radiance 1' -o lit.las
head -c 4 lit.las
echo
fields lit.las
# From a pipe, with the colours that came in first.
glowworm bake - -q --light 'sky radiance 1' --colors keep -o again.las <lit.las
cat again.las | glowworm bake - -q --light 'sky radiance 1' -o back.ply
for axis in x y z; do
	for file in a.ply lit.las again.las back.ply; do
		glowworm info $file --json | grep -o "\"name\": \"$axis\"[^}]*"
	done | uniq | wc -l
done
fields back.ply | grep -E 'infrared|albedo_g|intensity'
head -c 1000 lit.las >cut.las
glowworm info cut.las 2>errors
[ $? -eq 65 ] && sed 's/begin at byte [0-9]*/begin at byte N/' errors >&2
