# Balls where probes stand: under the lamp of a ceiling one is brighter above than below; and the
# same picture twice.
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
. "$SOURCE/tests/cli/shared_functions"
make_box --scene rooms --points 6000 -o rooms.ply
place() { glowworm probes rooms.ply --rays 16 --moves 4 -q "$@"; }
place --json one.json --size 16
cat >at.py <<'END'
import json
x, y, z = json.load(open("one.json"))["probes"][0]["position"]
print(f"at {x - 0.5},{y},{z} to {x},{y},{z} fov 40")
END
for picture in ball twin; do
	place --camera "$(/usr/bin/python3 at.py)" --picture $picture.png
done
cmp ball.png twin.png
write_png_reader
/usr/bin/python3 - <<'END'
from png_reader import pixels
ball = pixels("ball.png")
print("ball", ball[425][2400] > ball[475][2400] + 5)
END
# In a furnace, which is equally bright to all sides, a white ball cannot be told from what
# lies behind it, but for what slips through its wall, 0.2 % of the rays, and the rounding to bytes.
make_box --scene furnace --points 20000 --albedo 0 -o furnace.ply
glowworm probes furnace.ply --rays 16 --moves 0 --camera 'at 0.6,0,0.1 to 0,0,0 fov 40' \
	--picture furnace.png 2>&1 | grep picture
/usr/bin/python3 - <<'END'
from png_reader import pixels
sphere = pixels("furnace.png")
print("furnace", max(map(max, sphere)) - min(map(min, sphere)) <= 2)
END
# A camera that is found for the scene goes to a probe that it would not have in its view.
make_cave --points 3000 -o cave.ply
glowworm probes cave.ply --rays 16 --moves 0 --size 16 --count 2 --picture cave.png 2>&1 |
	grep picture
