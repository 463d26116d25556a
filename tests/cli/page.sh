# A page in a browser: the light that it adds up against the points' columns and against `mix`, its
# picture against that of `render`; sliders, set-ups, keys, what is under the pointer, few points.
${LOOK_FOR_DEVICE:-glowworm info --devices} >/dev/null 2>&1 ||
	{ echo "there is no Vulkan device"; exit 77; }
. "$SOURCE/tests/cli/shared_functions"
make_box --scene cornell --points 12000 -o box.ply
glowworm bake box.ply --light 'point at 0.3,0.4,0.7 intensity 60,50,40cd name warm group desk' \
	--light 'spot at 0.7,0.6,0.9 to 0.7,0.6,0 intensity 90cd name cold' --rays 16 \
	--estimate-points 50 --fields lights,illuminance -q -o lit.ply
glowworm page lit.ply -o page.html --title 'A box <b>' --setup 'warm: *=0 desk=1' \
	--setup 'dim: warm=1,0.5,0.25 cold=0.5' -c 'front: at 0.5,-1.4,0.5 to 0.5,0.5,0.5 fov 45' -q
# A lamp whose name is another's own in its group, as columns of other programs may have it, and a
# file whose name a shell would take apart.
glowworm bake box.ply --light 'point at 0.3,0.4,0.7 intensity 60cd name side' --units ft \
	--light 'point at 0.7,0.6,0.3 intensity 5e7cd name side group desk' --rays 16 \
	--estimate-points 0 --fields lights -q -o sides.ply
LC_ALL=C sed 's/_desk.side_2_\([rgb]\)$/_desk.side_\1/' sides.ply >"lamps' light.ply"
glowworm page "lamps' light.ply" -o sides.html --units ft --points 3000 -q
glowworm page lit.ply -o few.html --points 3000 -q
glowworm mix lit.ply -g warm=1,0.5,0.25 -g cold=0.5 -q -o dim.ply
glowworm render lit.ply -c 'at 0.5,-1.4,0.5 to 0.5,0.5,0.5 fov 45' --size 400x160 -v \
	-o seen.png 2>seen.txt
write_png_reader
cat >look.py <<'END'
import os, struct, subprocess, sys
sys.path.append(os.environ["SOURCE"] + "/tests/cli")
import numpy
from browser import Browser
from png_reader import pixels

def read(name):
    """The columns of a binary PLY file."""
    data = open(name, "rb").read()
    head, _, body = data.partition(b"end_header\n")
    kinds = {b"float": "<f4", b"double": "<f8", b"uchar": "u1"}
    fields = [line.split() for line in head.splitlines() if line.startswith(b"property")]
    return numpy.frombuffer(body, [(f[2].decode(), kinds[f[1]]) for f in fields])

def triples(cloud, prefix):
    return numpy.stack([cloud[prefix + c].astype(float) for c in "rgb"], 1)

lit = read("lit.ply")
browser = Browser(720, 160, patience=240)
browser.open("page.html")
said = "document.getElementById('message').textContent"
print("whole", browser.wait(), browser.run(said) or "without complaint")
scene = browser.run("glowworm.scene")
print(scene["title"], [lamp["column"] for lamp in scene["lamps"]],
      [lamp["group"] for lamp in scene["lamps"]], [camera["name"] for camera in scene["cameras"]])

# Which point of the file each of the page is, by the cell of its grid, or the one beside it.
places = numpy.frombuffer(browser.bytes("glowworm.places()"), numpy.uint32).reshape(-1, 4)
at = numpy.stack([lit[axis] for axis in "xyz"], 1).astype(float)
cells = numpy.floor((at - scene["corner"]) / scene["step"] + 0.5).astype(int)
known = {tuple(cell + [x, y, z]): i for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1)
         for i, cell in enumerate(cells)}
known.update({tuple(cell): i for i, cell in enumerate(cells)})
which = numpy.array([known[tuple(place)] for place in places[:, :3].astype(int)])
print("points", len(places), "of which once", len(set(which)))

def check(what, prefix, cloud):
    """RGB9E5 keeps the largest channel to 1/512 of itself at most, 0.2 %, and the others to as
    much of that."""
    got = numpy.frombuffer(browser.bytes("glowworm.radiance()"), numpy.float32)
    got = got.reshape(-1, 4)[:, :3].astype(float)
    true = triples(cloud, prefix)
    off = numpy.sqrt(numpy.mean((got - true[which]) ** 2)) / numpy.mean(true)
    print(what, "within 1 %" if off < 0.01 else f"is off by {100 * off:.2f} %")

check("as baked", "scalar_radiance_", lit)

# What is in view is metered alike, but that discs are not blended for it: 0.1 doublings are 3 % of
# the range in mid grey. Then, at one exposure, the same discs and tone map: pictures differ where
# discs end, within a pixel, and where one shows through between others: on less than 3 % of the
# pixels by a tenth of the range. RGB9E5 and bytes add 1 of 255 at most.
browser.run("glowworm.chooseCamera(1)")
said = next(line for line in open("seen.txt") if line.startswith("exposure"))
exposure = float(said.split()[2])
print("exposure", abs(browser.run("glowworm.look.exposure") - exposure) < 0.1)
browser.run(f"glowworm.look.exposure = {exposure}")
mine = numpy.frombuffer(browser.bytes("glowworm.picture(400, 160)"), numpy.uint8)
mine = mine.reshape(160, 400, 4)[::-1, :, :3].astype(int)
seen = numpy.array([list(row) for row in pixels("seen.png")]).reshape(160, 400, 3)
off = abs(mine - seen).max(2)
print("picture", numpy.mean(off > 25) < 0.03 and numpy.mean(off) < 1, numpy.mean(seen) > 20)

# A set-up's button; then the same by hand: the slider's middle is 1, half as strong lies at
# (0.5/8)^(1/3) of it.
press = "document.querySelectorAll('#setups button')[%d].click()"
browser.run(press % 2)
check("a set-up", "scalar_radiance_", read("dim.ply"))
browser.run(press % 1)
check("one lamp alone", "scalar_light_desk.warm_", lit)
browser.run(press % 0)
browser.run("""(() => { const rows = [...document.querySelectorAll('.lamp')];
    const row = rows.find((r) => r.textContent.startsWith('cold'));
    row.querySelector('input[type=range]').focus(); })()""")
before = browser.run("document.activeElement.value")
browser.key("ArrowRight")
browser.run("new Promise(requestAnimationFrame)")
after = browser.run("document.activeElement.value")
print("a key moves the slider", round(float(after) - float(before), 6))
print(browser.run("document.querySelectorAll('#setups button')[0].getAttribute('aria-pressed')"))
browser.run("document.getElementById('copy').click()")
print(browser.run("document.getElementById('command').value").split(" ")[:4])
browser.run(press % 0)

# Under the pointer: the point in the middle of the picture, its light, and its lamps.
browser.run("document.getElementById('toggle').click()")
browser.run("document.getElementById('quantity').value = 2,"
            "document.getElementById('quantity').dispatchEvent(new Event('input'))")
browser.mouse("mouseMoved", 360, 80)
READ = """new Promise((done) => { const look = () => {
    const text = document.getElementById('readout').textContent;
    text ? done(text) : setTimeout(look, 20); }; look(); })"""
text = browser.run(READ)
index = browser.run("glowworm.pick(360, 80)")
lux = float(text.split(" \u00b7 ")[2].split(" ")[0])
true = lit["scalar_illuminance"][which[index]]
# Three digits, RGB9E5, and an albedo of 8 bits, by its root: 2/255 of the box's 0.5 and less.
print("under the pointer", ascii([part.split(" ")[-1] for part in text.split(" \u00b7 ")[:3]]),
      abs(lux - true) < 0.03 * true, "warm" in text and "cold" in text)

# A scale suits light however strong, as strong as half floats cannot hold, too.
high = browser.run("panel.fit(), glowworm.look.high")
strong = browser.run("drawing.setGains(panel.gains().map((g) => g.map((x) => 1e4 * x))),"
                     "panel.fit(), glowworm.look.high")
print("scale of strong light", strong > 65504, abs(strong / high - 1e4) < 1)
browser.run(press % 0)

# A picture for saving, of another size, amid one on the screen, which is drawn again then.
browser.run("frames.rest = drawing.draw(drawing.ready, 1000), frames.rest.next(),"
            "frames.request(), glowworm.picture(240, 160), 0")
browser.run("new Promise(requestAnimationFrame).then(() => new Promise(requestAnimationFrame))")
print("amid a picture", browser.run("[drawing.gl.getError(), drawing.sums.width === canvas.width]"))

# The camera moves, and comes back.
eye = "glowworm.camera.eye.map((x) => x.toFixed(4)).join()"
browser.run("document.getElementById('view').focus()")
home = browser.run(eye)
browser.key("KeyW")
away = browser.run(eye)
browser.mouse("mousePressed", 100, 80, button="left", buttons=1, clickCount=1)
browser.mouse("mouseMoved", 130, 90, button="left", buttons=1)
browser.mouse("mouseReleased", 130, 90, button="left", clickCount=1)
yaw = "glowworm.camera.yaw.toFixed(4)"
turned = browser.run(yaw)
browser.key("Digit2")
browser.run("document.getElementById('view').focus()")
pitch = browser.run("glowworm.camera.pitch")
browser.key("ArrowUp")
near = browser.run("glowworm.camera.pitch") - pitch
browser.key("ArrowDown")
browser.key("ArrowUp", modifiers=8)
far = browser.run("glowworm.camera.pitch") - pitch
print("with shift further", round(far / near, 3))
browser.key("Digit2")
print("moved", home != away, "turned", browser.run(yaw) != turned, "back",
      browser.run(eye) == home)

# From the middle of the box, come to from the overview, it is all around; a hundred metres off,
# where discs are a hundred times as wide, they are not swallowed by their own depth.
def covered(width, height):
    mine = numpy.frombuffer(browser.bytes(f"glowworm.picture({width}, {height})"), numpy.uint8)
    return numpy.mean(mine.reshape(-1, 4)[:, :3].max(1) > 0)

browser.run("glowworm.chooseCamera(0), glowworm.look.quantity = 0,"
            "glowworm.camera.eye = glowworm.scene.side.map((x) => x / 2), 0")
within = covered(60, 40)
browser.run("glowworm.camera.choose(glowworm.scene.cameras[1]),"
            "glowworm.camera.move(0, 0, -100), 0")
print("near and far", within > 0.9, covered(240, 160) > 0)

# A beginning of the points shows all of the box, by wider discs: as much of the picture as all do,
# but for a tenth, where discs end.
browser.run("glowworm.chooseCamera(0), 0")
whole = covered(60, 40)
browser.open("few.html")
print("few", browser.wait(), browser.run("glowworm.scene.count"))
print("covered", abs(covered(60, 40) - whole) < 0.1 * whole)
# Two lamps called side: the command that is copied dims the one that was dimmed.
browser.size(360, 80)
browser.open("sides.html")
browser.wait()
lit = read("lamps' light.ply")
browser.run("""(() => { const slider = document.querySelectorAll('.lamp input[type=range]')[0];
    slider.value = 0; slider.dispatchEvent(new Event('input')); })()""")
browser.run("document.getElementById('copy').click()")
command = browser.run("document.getElementById('command').value")
print(command)
subprocess.run(command + " -q", shell=True, check=True)
mixed, radiance = read("mixed.ply"), triples(read("mixed.ply"), "scalar_radiance_")
print("one lamp out", not triples(mixed, "scalar_light_side_").any(),
      numpy.array_equal(radiance, (triples(lit, "scalar_light_desk.side_") +
                                   triples(lit, "scalar_light_rest_")).astype("f4")))

# A scale that is none is said to be, and the last one stays; every slider says its value once, by
# itself, as nothing else on the panel does.
put = """(([id, value]) => { const input = document.getElementById(id);
    input.value = value; input.dispatchEvent(new Event('input')); })(%s)"""
state = """[['low', 'high'].map((id) => document.getElementById(id).getAttribute('aria-invalid')),
    document.getElementById('scaleWrong').textContent, glowworm.look.low, glowworm.look.high]"""
for id, value in (("quantity", 1), ("low", 2), ("high", 4), ("low", 4), ("low", 0), ("low", 3)):
    browser.run(put % [id, str(value)])
    if id != "quantity":
        print(id, value, browser.run(state) if value != 2 else "")
nodes = browser.call("Accessibility.getFullAXTree")["nodes"]
said = [node for node in nodes if not node.get("ignored")]
sliders = [node for node in said if node.get("role", {}).get("value") == "slider"]
values = [property["value"]["value"] for node in sliders for property in node["properties"]
          if property["name"] == "valuetext"]
texts = [node.get("name", {}).get("value", "") for node in said
         if node.get("role", {}).get("value") in ("StaticText", "status")]
print("sliders", len(sliders), len(values), [value for value in values if value in texts])

# Places under the pointer are in the file's units.
browser.run(put % ["quantity", "0"])
browser.run("document.getElementById('toggle').click()")
browser.mouse("mouseMoved", 180, 40)
place = browser.run(READ).split(" \u00b7 ")[0]
index = browser.run("glowworm.pick(180, 40)")
metres = browser.run(f"glowworm.point({index}).place.map((x, k) => x + scene.corner[k])")
print("in feet", place.endswith(" ft"), max(abs(float(a) - b / 0.3048) for a, b in zip(
    place[:-3].split(", "), metres)) < 0.001)

# A device that adds up in half floats alone shows the same: light of ten million candela, which
# half floats do not hold. Numbers are off by 2^-11 and RGB9E5's 1/512.
def fitted():
    got = []
    for quantity in (1, 2):
        browser.run(put % ["quantity", str(quantity)])
        got.append(browser.run("[glowworm.look.low, glowworm.look.high]"))
    browser.run(put % ["quantity", "0"])
    browser.run("panel.meter()")
    light = numpy.frombuffer(browser.bytes("glowworm.radiance()"), numpy.float32)
    return numpy.array(got), browser.run("glowworm.look.exposure"), light.astype(float)

browser.call("Page.reload")
print("float", browser.wait(), browser.run("drawing.half"))
whole = fitted()
browser.call("Page.addScriptToEvaluateOnNewDocument", source="""
    const own = WebGL2RenderingContext.prototype.getExtension;
    WebGL2RenderingContext.prototype.getExtension = function (name) {
        return name === "EXT_color_buffer_float" ? null : own.call(this, name); };""")
browser.call("Page.reload")
print("half", browser.wait(), browser.run("drawing.half"))
half = fitted()
print("the same light", whole[0].max() > 65504, numpy.allclose(half[0], whole[0], rtol=0.01),
      abs(half[1] - whole[1]) < 0.02, numpy.allclose(half[2], whole[2], rtol=2e-3))
print("asked for", browser.requests(), "wrong", browser.errors())
browser.close()
END
/usr/bin/python3 look.py
