# Pages as files: what is in them, the same bytes with any number of threads, what is refused.
. "$SOURCE/tests/cli/shared_functions"
{
	printf 'ply\nformat ascii 1.0\ncomment glowworm estimated error: RMS 0.05 +- 0.01 of the mean\n'
	printf 'element vertex 100\n'
	printf 'property double %s\n' x y z nx ny nz
	printf 'property uchar %s\n' albedo_r albedo_g albedo_b
	printf 'property float scalar_%s\n' radiance_r radiance_g radiance_b light_hall.a_r \
		light_hall.a_g light_hall.a_b light_b_r light_b_g light_b_b
	echo end_header
	awk 'BEGIN { for (i = 0; i < 100; i++) { a = i / 100
		printf "%.1f %.1f 3 0 0 1 188 188 188 ", 500000 + i % 10 * 0.5, 10 + int(i / 10) * 0.5
		print a + 1, a + 2, a + 3, a, a + 1, a + 2, 1, 1, 1 } }'
} >lit.ply
page() { run 0 page lit.ply -f "$@"; }
page -o one.html --threads 1 --setup 'only a: *=0 a=2' --setup 'hall: hall=3,2,1' \
	-c 'from above: at 500002,12,9 to 500002.1,12,3'
page -o two.html --threads 2 --setup 'only a: *=0 a=2' --setup 'hall: hall=3,2,1' \
	-c 'from above: at 500002,12,9 to 500002.1,12,3' -q
cmp one.html two.html
# The scene, which is JSON; nothing in the document has an address.
sed -n '/type="application\/json"/,/^}/p' one.html |
	sed -e 's/^<script.*>{$/{/' -e 's/^}.*/}/' >scene.json
/usr/bin/python3 - <<'END'
import json
scene = json.load(open("scene.json"))
for key in ("title", "count", "inputPoints", "bakeError", "units", "setups", "exposure", "tone"):
    print(key, ascii(scene[key]))
for lamp in scene["lamps"]:
    print(lamp)
print([camera["name"] for camera in scene["cameras"]], scene["cameras"][1]["at"])
print(scene["levels"][-1]["end"], [level["end"] for level in scene["levels"][:4]])
END
grep -c 'https*:' one.html
# A name that would end the script; a page of some of the points, and of one, through a pipe.
page -o - -q --title '</script><b>' --points 10 | grep -e '^ "title"' -e '^ "count"'
sed '/end_header/q' lit.ply | sed 's/vertex 100/vertex 1/' >single.ply
echo 0 0 0 0 0 1 188 188 188 1 2 3 1 2 3 0 0 0 >>single.ply
run 65 page single.ply -o single.html
# Without columns of lamps, one slider for all of it.
sed -n '1,/end_header/p' lit.ply | sed '/light_/d' >whole.ply
sed '1,/end_header/d' lit.ply | cut -d ' ' -f 1-12 >>whole.ply
run 0 page whole.ply -o whole.html
# What is said of the input; and more lamps than a page has layers for.
sed 's/^comment .*/comment note: it is made up/' whole.ply >noted.ply
run 0 page noted.ply -o noted.html
awk 'BEGIN { print "ply\nformat ascii 1.0\nelement vertex 1"
	split("x y z nx ny nz scalar_radiance_r scalar_radiance_g scalar_radiance_b", name, " ")
	for (i = 1; i <= 9; i++) print "property float " name[i]
	for (i = 0; i < 3 * 257; i++)
		print "property float scalar_light_" int(i / 3) "_" substr("rgb", i % 3 + 1, 1)
	print "end_header"
	printf "0 0 0 0 0 1"
	for (i = 0; i < 3 + 3 * 257; i++) printf " 1"
	print "" }' >many.ply
run 2 page many.ply -o a.html
# Refused.
run 65 page whole.ply -o a.html --setup 'x: a=1'
run 2 page lit.ply -o a.html --setup 'x: c=1'
name=$(printf '%510s' '' | tr ' ' a)
sed "s/light_hall.a_/light_${name}_/" lit.ply >long.ply
run 2 page long.ply -o a.html --setup 'x: c=1'
run 2 page lit.ply -o a.html --setup 'x'
run 2 page lit.ply -o a.html --setup 'x: a'
run 2 page lit.ply -o a.html -c 'x: at 1,2'
run 2 page lit.ply -o a.html -c ': at 1,2,3 to 4,5,6'
run 2 page lit.ply -o a.html --points 0
run 2 page lit.ply
run 2 page -o a.html
run 2 page lit.ply -o lit.ply -f
run 73 page lit.ply -o one.html
sed -n '1,/end_header/p' lit.ply | sed '/scalar_/d' >unlit.ply
sed '1,/end_header/d' lit.ply | cut -d ' ' -f 1-9 >>unlit.ply
run 65 page unlit.ply -o a.html
ls a.html 2>&1 | sed "s/.*: //"
