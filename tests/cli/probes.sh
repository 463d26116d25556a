# Probes in two rooms of points: files that open, with places in the rooms and in the coordinates of
# the input; the same bytes twice; and sentences for what cannot be.
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
. "$SOURCE/tests/cli/shared_functions"
make_box --scene rooms --points 3000 -o rooms.ply
place() { glowworm probes rooms.ply --rays 16 --moves 4 -q "$@"; }
place -o one.exr --json one.json --vdb one.vdb --size 16
place -o two.exr --json two.json --vdb two.vdb --size 16
for kind in exr json vdb; do
	cmp one.$kind two.$kind
done
grep -aq probe_0 one.vdb && grep -aq probe_3 one.vdb || echo "the grids have no names"
# The picture is one that can be read as a picture: the sky of another bake.
glowworm bake rooms.ply -q --rays 16 --estimate-points 0 --light 'sky map one.exr' -o lit.ply 2>&1
# Both files agree on how many there are.
/usr/bin/python3 - one.json one.exr <<'END'
import json, math, sys
told = json.load(open(sys.argv[1]))
probes = told["probes"]
print("probes", 2 <= len(probes) <= 6, "size", told["size"], "far", told["far"])
print("seen", told["seen"] > 0.98 and told["seen"] <= 1)
low, high = told["minimum"], told["maximum"]
for p in probes:
    inside = all(l <= x <= h for l, x, h in zip(low, p["position"], high))
    good = p["radius"] > 0 and p["radius"] <= p["nearest"] * 1.5 and p["nearest"] <= p["farthest"]
    if not inside or not good or len(p["harmonics"]) != 9 or len(p["harmonics"][0]) != 3:
        print("bad probe", p)
picture = open(sys.argv[2], "rb").read()
print(picture[:4] == b"v/1\1", b"%d probes of 16 x 16" % len(probes) in picture,
      all(name in picture for name in (b"distance.least", b"normal.X", b"octahedral")))
END
# A picture, of which probe_balls.sh looks at the balls; from afar, since each pixel takes its time.
make_box --scene plane --points 1000 -o floor.ply
glowworm probes floor.ply --light 'sky radiance 1' --margin 1 --size 4 --picture floor.png \
	--camera 'at 0,-30,10 to 0,0,0 fov 40' 2>&1 | grep picture
# Coordinates in feet stay in feet, and what is far from the origin stays there.
glowworm probes rooms.ply --rays 16 --moves 0 -q --count 1 --units ft --size 4 --json feet.json
sed -n '/"position"/p' feet.json | head -1 | grep -c position
# A regular grid of eight, of which those in the wall between the rooms are left out.
place --grid 2 --size 4 --json grid.json
/usr/bin/python3 -c 'import json; t = json.load(open("grid.json")); \
print("grid", t["places"], 1 <= len(t["probes"]) <= 8, t["seen"] == t["seeable"])'
for bad in '' '-o p.exr' '-o p.exr --count 0' '-o p.exr --size 48' '-o p.exr --size 2' \
	'-o p.exr --margin=-1' '-o one.exr' '-o rooms.ply -f' '-o - --json -' '-o p.exr --moves x' \
	'--picture p.png --camera nowhere' '--picture one.exr' '--picture - -o -' \
	'--picture floor.png' '-o p.exr --grid 0' '-o p.exr --grid 65' \
	'-o p.png'; do
	input=rooms.ply
	[ "$bad" != '-o p.exr' ] || input=
	glowworm probes $input --rays 16 $bad 2>&1
	echo "exit $?"
done
printf 'ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\n' >none.ply
printf 'property float z\nend_header\n' >>none.ply
glowworm probes none.ply --light 'sky radiance 1' -o p.exr 2>&1
echo "exit $?"
# A floor has no free space within its own bounds.
glowworm probes floor.ply --light 'sky radiance 1' -o p.exr 2>&1
echo "exit $?"
glowworm probes floor.ply --light 'sky radiance 1' --margin 1 --size 4 -o p.exr 2>&1 | wc -l
rm p.exr
ls ./*.exr
