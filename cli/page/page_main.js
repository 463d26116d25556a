/*
 * What happens when: blocks arrive, something is changed, the camera moves.
 */
const AT_FIRST = 200000;     /* points that are drawn at once */
const FEWEST = 20000;
const STILL = 150;           /* milliseconds after which all are drawn */
const SLOW = 40, QUICK = 20; /* milliseconds a picture */
const LOOK_UNDER = 80;       /* milliseconds for which a pointer has to rest */

const canvas = byId("view");
let drawing;

/* Draws when something changed: at once as many points as a picture has time for, then, when nothing
 * changes any more, all, part after part, so that whoever changes something need not wait. */
const frames = {
	asked: false, budget: AT_FIRST, last: 0, timer: 0, rest: null,

	/* A picture is wanted. */
	ask() {
		clearTimeout(this.timer);
		this.rest = null;
		this.fresh = true;
		this.request();
	},
	request() {
		if (!this.asked)
			requestAnimationFrame((now) => this.step(now));
		this.asked = true;
	},
	step(now) {
		this.asked = false;
		if (this.last > 0)
			this.adapt(now - this.last);
		this.last = this.fresh || this.rest ? now : 0;
		if (this.fresh)
			this.drawQuickly();
		else if (this.rest)
			this.drawMore();
	},
	drawMore() {
		if (this.rest.next().done)
			this.rest = null;
		else
			this.request();
	},
	drawQuickly() {
		const count = Math.min(this.budget, drawing.ready);
		this.fresh = false;
		drawing.draw(count).next();
		if (count < drawing.ready)
			this.timer = setTimeout(() => {
				this.last = 0;
				this.rest = drawing.draw(drawing.ready, Math.floor(this.budget));
				this.request();
			}, STILL);
	},
	adapt(took) {
		if (took > SLOW)
			this.budget = Math.floor(Math.max(FEWEST, 0.8 * this.budget));
		else if (took < QUICK)
			this.budget = Math.floor(Math.min(Math.max(scene.count, FEWEST), 1.2 * this.budget + 1));
	},
};

function say(text) {
	byId("message").textContent = text;
	byId("message").hidden = false;
}

function resize() {
	const scale = Math.min(window.devicePixelRatio || 1, 2);
	canvas.width = Math.max(1, Math.round(canvas.clientWidth * scale));
	canvas.height = Math.max(1, Math.round(canvas.clientHeight * scale));
	frames.ask();
}

/* A set-up's button is pressed where the lamps are as it has them. */
function markSetups() {
	const gains = panel.gains().flat();
	panel.setups.forEach((setup, i) => byId("setups").children[i].setAttribute("aria-pressed",
		setup.gains.every((x, k) => Math.abs(x - gains[k]) <= 1e-5 * Math.max(1, x))));
}

function lampsChanged() {
	drawing.setGains(panel.gains());
	markSetups();
	frames.ask();
}

function chooseCamera(i) {
	const view = scene.cameras[i];
	camera.choose(view);
	byId("moving").value = view.inside ? "look" : "orbit";
	canvas.setAttribute("aria-label", `${scene.title}, lit, seen from ${view.name}`);
	if (scene.exposure === null)
		panel.meter();
	frames.ask();
}

/* ------------------------------------------------------------------------- under the pointer */

/* Metres as the file counts, to a millimetre or less. */
function placeText(metres) {
	const text = metres.map((x, k) => {
		const { metres: one } = scene.length[k];
		return (x / one).toFixed(Math.max(0, 3 + Math.ceil(Math.log10(one))));
	});
	const [x, , z] = scene.length.map((one) => one.name);
	return x === z ? `${text.join(", ")} ${x}` : `${text[0]}, ${text[1]} ${x}, ${text[2]} ${z}`;
}

function describe(index) {
	const point = drawing.point(index), unit = scene.units;
	const whole = LUMINANCE_OF(point.radiance);
	const shares = point.byLamp.map((rgb, l) => [scene.lamps[l].column, LUMINANCE_OF(rgb) / whole])
		.filter((one) => one[1] >= 0.005).sort((a, b) => b[1] - a[1])
		.map(([name, share]) => `${name} ${Math.round(100 * share)} %`);
	const value = look.quantity === 2 ? ` \u00b7 ${incidentAt(index)}` : "";
	return `${placeText(add(point.place, scene.corner))} \u00b7 ${digits(whole)} ${unit.radiance}${value}` +
		(whole > 0 && shares.length ? ` \u00b7 ${shares.join(", ")}` : "");
}

/* What the picture in false colours shows of a point. */
function incidentAt(index) {
	const value = drawing.incident(index);
	return value === null ? "glows" : `${digits(value)} ${scene.units.irradiance}`;
}

let resting = 0;
function lookUnder(event) {
	clearTimeout(resting);
	if (event.buttons)
		return;
	const x = Math.floor(event.offsetX), y = Math.floor(event.offsetY);
	resting = setTimeout(() => {
		const index = drawing.pick(x, y);
		byId("readout").textContent = index < 0 ? "" : describe(index);
	}, LOOK_UNDER);
}

function lookAway() {
	clearTimeout(resting);
	byId("readout").textContent = "";
}

function turnAbout(event) {
	const index = drawing.pick(Math.floor(event.offsetX), Math.floor(event.offsetY));
	if (index < 0)
		return;
	camera.pivot = drawing.point(index).place;
	byId("moving").value = "orbit";
}

/* ---------------------------------------------------------------------------------- buttons */

function savePicture() {
	const width = canvas.width, height = canvas.height, pixels = drawing.picture(width, height);
	const paper = element("canvas", { width, height }), image = new ImageData(width, height);
	for (let y = 0; y < height; y++)
		image.data.set(pixels.subarray(4 * width * (height - 1 - y), 4 * width * (height - y)),
			4 * width * y);
	paper.getContext("2d").putImageData(image, 0, 0);
	paper.toBlob((blob) => {
		if (!blob) {
			byId("readout").textContent = "This browser has no room for the picture.";
			return;
		}
		const link = element("a", { href: URL.createObjectURL(blob), download: `${scene.title}.png` });
		link.click();
		URL.revokeObjectURL(link.href);
	});
}

/* The command stands there, marked, where a browser lets no page copy. */
function copyCommand() {
	const shown = byId("command");
	shown.value = panel.command();
	shown.hidden = false;
	shown.select();
	if (navigator.clipboard)
		navigator.clipboard.writeText(shown.value).catch(() => {});
}

function watchButtons() {
	byId("save").addEventListener("click", savePicture);
	byId("copy").addEventListener("click", copyCommand);
	byId("toggle").addEventListener("click", () => {
		byId("panel").hidden = !byId("panel").hidden;
		document.body.classList.toggle("open", !byId("panel").hidden);
		byId("toggle").setAttribute("aria-expanded", String(!byId("panel").hidden));
	});
	document.addEventListener("keydown", (event) => {
		if (/^(INPUT|SELECT|TEXTAREA)$/.test(event.target.tagName) || event.ctrlKey ||
			event.metaKey || event.altKey)
			return;
		const number = /^Digit([1-9])$/.exec(event.code);
		if (number && scene.cameras[number[1] - 1])
			chooseCamera(number[1] - 1);
		else if (event.code === "KeyR")
			chooseCamera(0);
		else if (event.code === "KeyM")
			panel.meter();
	});
}

/* ------------------------------------------------------------------------------------ start */

/* Blocks are inflated one after the other; resolved when all are in the textures. */
let arriving = Promise.resolve(), arrived = 0, failed = null, finish;
const ready = new Promise((resolve) => { finish = resolve; });

async function take(text) {
	if (failed)
		return;
	try {
		const count = Math.min(scene.block, scene.count - arrived);
		const block = unpack(await inflate(text), count);
		const first = arrived === 0;
		arrived += count;
		drawing.add(block);
		if (first && scene.exposure === null)
			panel.meter();
		frames.ask();
	} catch (error) {
		fail(error);
	}
}

function fail(error) {
	failed = error;
	say(`This page cannot be shown: ${error.message}`);
}

function start() {
	panel.makeText();
	try {
		if (typeof DecompressionStream === "undefined")
			throw new Error("This browser is too old: it cannot inflate the points.");
		drawing = new Drawing(canvas);
	} catch (error) {
		fail(error);
		return;
	}
	panel.makeLamps(lampsChanged);
	panel.makeSetups(lampsChanged);
	panel.makeCameras(chooseCamera);
	panel.makeLook(() => frames.ask());
	look.exposure = scene.exposure ?? 0;
	panel.showExposure();
	drawing.setGains(panel.gains());
	markSetups();
	watchInput(canvas, () => frames.ask(), turnAbout);
	watchButtons();
	for (const under of ["pointermove", "click"]) /* a finger rests nowhere, but it taps */
		canvas.addEventListener(under, lookUnder);
	canvas.addEventListener("pointerleave", (event) => event.pointerType === "mouse" && lookAway());
	canvas.addEventListener("webglcontextlost", () => say("The graphics driver gave up; load the page again."));
	new ResizeObserver(resize).observe(canvas);
	resize();
	chooseCamera(0);
}

/* What the document, and whoever wants the numbers of a page, call. */
const glowworm = {
	add(text) {
		arriving = arriving.then(() => take(text));
	},
	end() {
		arriving.then(() => {
			if (!failed && scene.exposure === null && !panel.exposed)
				panel.meter();
			if (!failed && drawing.ready < scene.count)
				byId("facts").append(` This device has room for the first ${drawing.ready} points alone.`);
			finish(!failed);
		});
	},
	ready, scene, camera, look, panel,
	places: () => drawing.places(),
	radiance: () => drawing.radiance(),
	picture: (width, height) => drawing.picture(width, height),
	pick: (x, y) => drawing.pick(x, y),
	point: (index) => drawing.point(index),
	chooseCamera,
};

start();
