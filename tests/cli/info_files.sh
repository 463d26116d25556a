# What info says of a file, as text and as JSON, several files, standard input, and devices.
. "$SOURCE/tests/cli/shared_functions"
make_cloud >a.ply
# Measured figures are the library's; its tests check them.
glowworm info a.ply | grep -vE '^  (spacing|density|bake)'
glowworm info a.ply - --json <a.ply | tr '{' '\n' |
	sed 's/"spacing.*"normals_given/"normals_given/; s/"albedo": \[.*"fields/"fields/'
glowworm info --devices --json 2>/dev/null |
	grep -vE '^\{"index": [0-9]+, "name": ".*", "type": "[a-z]+", .*\}$'
:
