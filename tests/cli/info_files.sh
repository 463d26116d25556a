# What info says of a file, quickly and with all that is measured, as text and as JSON, several
# files, standard input, and devices.
. "$SOURCE/tests/cli/shared_functions"
make_cloud >a.ply
glowworm info a.ply
# Measured figures are the library's; its tests check them.
glowworm info --stats a.ply | grep -vE '^  (spacing|density|bake)'
glowworm info a.ply - --json <a.ply | tr '{' '\n'
glowworm info a.ply --json --stats | tr '{' '\n' | sed 's/"spacing.*"normals_given/"normals_given/
	s/"albedo": \[.*"scanners/"scanners/'
# Of a large LAS file the header tells the bounds, and the first points the rest.
awk 'BEGIN { print "x y z"; for (i = 0; i < 70000; i++) print i / 1000, i % 7, 12 }' >many.xyz
glowworm convert many.xyz many.las
glowworm info many.las
glowworm info many.las --json | grep -o '"fields_of_first": [0-9]*, .*"type": "float64", "m[^}]*' |
	cut -d , -f 1-5
# One that is cut short, or whose header has bounds that are none, is looked at as a whole.
head -c 1000000 many.las >cut.las
glowworm info cut.las
# Of a lit file it says by what, how exposed, and how wrong; a command may have any quotes in it.
cat >lit.ply <<'EOF'
ply
format ascii 1.0
comment glowworm command: glowworm bake 'a b' it.scene.json --light 'point name it'\''s' --light sky
comment glowworm units: linear RGB, Rec.709; radiance in W/(sr m^2), irradiance in W/m^2
comment glowworm preview: sRGB(PBR Neutral(radiance * 0.18 / (0.125 * 2^EV))), EV 3.5
comment glowworm estimated error: RMS 0.02 +- 0.001 of the mean radiance, from 500 points
comment glowworm command: glowworm bake 'unfinished
comment glowworm command: --light
element vertex 1
property float x
property float y
property float z
property float scalar_light_lamp_r
property float scalar_light_hall.torch_r
property float scalar_light__r
end_header
1 2 3 4 5 6
EOF
glowworm info lit.ply | sed -n '/lit by/,/field/p'
glowworm info --json lit.ply | grep -o '"light": {[^}]*}'
glowworm info --devices --json 2>/dev/null |
	grep -vE '^\{"index": [0-9]+, "name": ".*", "type": "[a-z]+", .*\}$'
:
