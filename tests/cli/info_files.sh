# What info says of a file, as text and as JSON, several files, standard input, and devices.
# 16 points, 4 x 4 on the floor of a georeferenced place, with a column of their own.
make_cloud() {
	printf 'ply\nformat ascii 1.0\ncomment made by hand\nelement vertex 16\n'
	printf 'property double %s\n' x y z
	printf 'property uchar %s\n' red green blue
	printf 'property float infrared\nend_header\n'
	awk 'BEGIN { for (i = 0; i < 16; i++) printf "%.3f %.3f %.3f %d %d %d %d\n",
		500000.123 + i % 4 * 0.1, 4000000.457 + int(i / 4) * 0.1, 12.25, 200, i * 16, 255 - i, i }'
}
make_cloud >a.ply
# Measured figures are the library's; its tests check them.
glowworm info a.ply | grep -vE '^  (spacing|density|bake)'
glowworm info a.ply - --json <a.ply | tr '{' '\n' |
	sed 's/"spacing.*"normals_given/"normals_given/; s/"albedo": \[.*"fields/"fields/'
glowworm info --devices --json 2>/dev/null |
	grep -vE '^\{"index": [0-9]+, "name": ".*", "type": "[a-z]+", .*\}$'
:
