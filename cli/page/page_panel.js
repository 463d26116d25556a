/*
 * The panel: lamps, exposure, colours, cameras.
 */
const byId = (id) => document.getElementById(id);
const LUMINANCE_OF = (rgb) => 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
const LARGEST_FACTOR = 8;

/* A slider's place, 0 to 1, and the factor that it stands for: 1 in its middle, 8 at its end. */
const factorOf = (place) => LARGEST_FACTOR * place * place * place;
const placeOf = (factor) => Math.cbrt(Math.min(factor, LARGEST_FACTOR) / LARGEST_FACTOR);

/* Three digits, without exponents where people do not expect them. */
function digits(value) {
	if (!Number.isFinite(value))
		return "-";
	return value !== 0 && (Math.abs(value) >= 1e6 || Math.abs(value) < 1e-3)
		? value.toExponential(2) : String(Number(value.toPrecision(3)));
}

function element(name, properties, ...children) {
	const made = Object.assign(document.createElement(name), properties);
	made.append(...children);
	return made;
}

/* sRGB, as colour inputs have it, to linear and back. */
const decode = (c) => c <= 0.04045 ? c / 12.92 : Math.pow((c + 0.055) / 1.055, 2.4);
const encode = (c) => c <= 0.0031308 ? 12.92 * c : 1.055 * Math.pow(c, 1 / 2.4) - 0.055;

/* A slider with its number, a switch and a colour: of a lamp, or of a group. */
class Dimmer {
	constructor(name, changed) {
		this.on = element("input", { type: "checkbox", checked: true, id: `on-${Dimmer.count}` });
		this.slider = element("input", { type: "range", min: 0, max: 1, step: 0.005 });
		this.shown = element("output", {});
		this.shown.setAttribute("aria-hidden", "true"); /* the slider says it */
		this.color = element("input", { type: "color", value: "#ffffff" });
		this.slider.setAttribute("aria-label", `strength of ${name}`);
		this.color.setAttribute("aria-label", `colour of ${name}`);
		const label = element("label", { htmlFor: this.on.id, textContent: name });
		this.row = element("div", { className: "lamp" }, this.on, label, this.slider, this.shown,
			this.color);
		Dimmer.count++;
		this.set([1, 1, 1]);
		this.slider.addEventListener("input", () => {
			this.strength = factorOf(Number(this.slider.value));
			this.show();
			changed();
		});
		for (const input of [this.on, this.color])
			input.addEventListener("input", () => changed());
	}
	/* Its factors: strength times colour, whose brightest channel is 1. */
	get() {
		const c = [1, 3, 5].map((at) => decode(parseInt(this.color.value.substr(at, 2), 16) / 255));
		const tint = this.tint && this.color.value === this.tint.text ? this.tint.rgb : c;
		return tint.map((x) => (this.on.checked ? this.strength * x : 0));
	}
	set(factors) {
		const most = Math.max(...factors), rgb = factors.map((x) => (most > 0 ? x / most : 1));
		this.strength = most > 0 ? most : 1;
		this.on.checked = most > 0;
		this.slider.value = placeOf(this.strength);
		this.color.value = "#" + rgb.map((x) => Math.round(encode(x) * 255).toString(16)
			.padStart(2, "0")).join("");
		this.tint = { text: this.color.value, rgb }; /* exactly, until another is chosen */
		this.show();
	}
	show() {
		this.shown.textContent = `${digits(100 * this.strength)} %`;
		this.slider.setAttribute("aria-valuetext", this.shown.textContent);
	}
}
Dimmer.count = 0;

const panel = {
	lamps: [], groups: new Map(),

	/* Three factors for each lamp. */
	gains() {
		return scene.lamps.map((lamp, l) => {
			const own = this.lamps[l].get(), group = this.groups.get(lamp.group);
			return group ? own.map((x, k) => x * group.get()[k]) : own;
		});
	},
	setGains(gains) {
		this.lamps.forEach((dimmer, l) => dimmer.set(gains.slice(3 * l, 3 * l + 3)));
		this.groups.forEach((dimmer) => dimmer.set([1, 1, 1]));
	},

	makeLamps(changed) {
		const boxes = new Map();
		for (const lamp of scene.lamps) {
			if (!boxes.has(lamp.group)) {
				const box = element("fieldset", {},
					element("legend", { textContent: lamp.group || "Lamps" }));
				boxes.set(lamp.group, box);
				byId("lamps").append(box);
				if (lamp.group) {
					const whole = new Dimmer(`all of ${lamp.group}`, changed);
					this.groups.set(lamp.group, whole);
					box.append(whole.row);
				}
			}
			const name = lamp.name === "rest" ? "rest (what belongs to no lamp)" : lamp.name;
			this.lamps.push(new Dimmer(name, changed));
			boxes.get(lamp.group).append(this.lamps[this.lamps.length - 1].row);
		}
	},
	makeSetups(changed) {
		byId("copy").hidden = scene.whole; /* there are no lamps to mix */
		const ones = scene.lamps.flatMap(() => [1, 1, 1]);
		const all = [{ name: "as baked", gains: ones }, ...scene.setups];
		for (const setup of all) {
			const button = element("button", { type: "button", textContent: setup.name });
			button.addEventListener("click", () => {
				this.setGains(setup.gains);
				changed();
			});
			byId("setups").append(button);
		}
		this.setups = all;
	},
	makeCameras(chosen) {
		scene.cameras.forEach((view, i) => {
			const button = element("button", { type: "button", textContent: view.name });
			button.addEventListener("click", () => chosen(i));
			byId("cameras").append(button);
		});
	},
	makeLook(changed) {
		const names = ["picture", scene.units.radianceName, scene.units.irradianceName];
		names.forEach((name, i) => byId("quantity").append(
			element("option", { textContent: name, value: i })));
		byId("tone").value = scene.tone;
		look.tone = TONE.indexOf(scene.tone);
		const read = () => {
			look.quantity = Number(byId("quantity").value);
			look.tone = TONE.indexOf(byId("tone").value);
			look.cull = byId("cull").checked;
			look.logarithmic = byId("logarithmic").checked;
			if (look.quantity !== 0)
				this.readScale();
			byId("scale").hidden = look.quantity === 0;
			byId("unit").textContent = look.quantity === 2 ? scene.units.irradiance
				: scene.units.radiance;
			changed();
		};
		for (const id of ["tone", "cull", "logarithmic", "low", "high"])
			byId(id).addEventListener("input", read);
		byId("quantity").addEventListener("input", () => {
			read();
			this.fit();
		});
		byId("fit").addEventListener("click", () => this.fit());
		byId("exposure").addEventListener("input", () => {
			look.exposure = -Number(byId("exposure").value);
			this.exposed = true; /* by hand */
			this.showExposure();
			changed();
		});
		byId("meter").addEventListener("click", () => this.meter());
		this.changed = changed;
	},
	/* To the right is brighter, as a smaller exposure value is. */
	showExposure() {
		const slider = byId("exposure"), at = -look.exposure;
		slider.min = Math.min(slider.min === "" ? at - 8 : Number(slider.min), at - 1);
		slider.max = Math.max(slider.max === "" ? at + 8 : Number(slider.max), at + 1);
		slider.value = at;
		byId("exposureValue").textContent = `EV ${look.exposure.toFixed(2)}`;
		slider.setAttribute("aria-valuetext", byId("exposureValue").textContent);
	},
	/* The exposure that suits what is in view, as glowworm render chooses it. */
	meter() {
		const was = look.quantity;
		look.quantity = 0;
		look.exposure = exposureOf(drawing.inView()) ?? look.exposure;
		look.quantity = was;
		this.showExposure();
		this.changed();
	},
	/* Takes the scale, unless it is none: then says what is wrong with it, and keeps the last. */
	readScale() {
		const low = byId("low").valueAsNumber, high = byId("high").valueAsNumber;
		const lowIs = low >= 0 && (low > 0 || !look.logarithmic);
		const text = !lowIs ? "The scale has to begin " + (look.logarithmic ? "above 0, where " +
				"powers of ten are alike." : "at 0 or above.")
			: !(high > low) ? "The scale has to end above where it begins." : "";
		byId("low").setAttribute("aria-invalid", String(text !== ""));
		byId("high").setAttribute("aria-invalid", String(text !== "" && lowIs));
		byId("scaleWrong").textContent = text && `${text} The last one that did is shown.`;
		byId("scaleWrong").hidden = text === "";
		if (text === "")
			[look.low, look.high] = [low, high];
	},
	/* The scale that suits what is in view: all but a few, at most three powers of ten. */
	fit() {
		if (look.quantity === 0)
			return;
		const seen = drawing.inView(), values = [];
		for (let i = 0; i < seen.length; i += 4)
			if (seen[i + 3] === 1)
				values.push(LUMINANCE_OF(seen.subarray(i, i + 3)));
		const lit = values.filter((x) => x > 0).sort((a, b) => a - b);
		if (lit.length > 0) {
			const high = lit[Math.floor(0.999 * (lit.length - 1))];
			const low = Math.max(lit[Math.floor(0.01 * lit.length)], high / 1000);
			look.high = high;
			look.low = look.logarithmic ? Math.min(low, high / 1.5) : 0;
		}
		byId("low").value = digits(look.low);
		byId("high").value = digits(look.high);
		const { low, high } = look; /* with all digits */
		this.readScale();
		[look.low, look.high] = [low, high];
		this.drawLegend();
		this.changed();
	},
	drawLegend() {
		const context = byId("legend").getContext("2d"), image = context.createImageData(256, 12);
		for (let i = 0; i < 256 * 12; i++) {
			image.data.set(drawing.ramp.subarray(4 * (i % 256), 4 * (i % 256) + 3), 4 * i);
			image.data[4 * i + 3] = 255;
		}
		context.putImageData(image, 0, 0);
	},
	makeText() {
		document.title = scene.title;
		byId("title").textContent = scene.title;
		const bake = scene.bakeError ? /^(\S+) \+- (\S+)/.exec(scene.bakeError) : null;
		const percent = bake ? digits(100 * Number(bake[1])) : "";
		byId("facts").textContent = bake
			? `Stated error of the light as baked: ${percent} % of its mean.`
			: "The cloud does not say how wrong its light is.";
		const shown = scene.count === scene.inputPoints ? `${scene.count}`
			: `${scene.count} of ${scene.inputPoints}`;
		byId("about").textContent = `${shown} points; ${scene.units.radianceName} in ` +
			`${scene.units.radiance}, ${scene.units.irradianceName} in ${scene.units.irradiance}. ` +
			"Light adds up: what you see is the sum of what each lamp gives, all reflections " +
			"included, times its slider. " +
			(scene.bakeError ? `The bake said of its error: RMS ${scene.bakeError}. ` : "") +
			"Written by glowworm.";
	},
	/* The command that mixes the lamps as they are set. */
	command() {
		const gains = this.gains(), quote = (text) => `'${text.replace(/'/g, "'\\''")}'`;
		const words = scene.lamps.flatMap((lamp, l) => {
			const g = gains[l].map((x) => Number(x.toPrecision(6)));
			if (g.every((x) => x === 1))
				return [];
			const factor = g[0] === g[1] && g[1] === g[2] ? `${g[0]}` : g.join(",");
			return ["--gain", quote(`${lamp.column}=${factor}`)];
		});
		return ["glowworm mix", quote(scene.input), ...words, "-o mixed.ply"].join(" ");
	},
};

/* As preview_exposure in options/preview.c has it: mid grey by the geometric mean, but highlights
 * darken by one doubling at most. null where there is no light. */
function exposureOf(seen) {
	let values = [];
	for (const least of [0.75, 0.25]) { /* what glows counts where nothing else is lit */
		for (let i = 0; i < seen.length; i += 4)
			if (seen[i + 3] > least)
				values.push(LUMINANCE_OF(seen.subarray(i, i + 3)));
		if (values.some((x) => x > 0))
			break;
		values = [];
	}
	const mean = values.reduce((sum, x) => sum + x, 0) / values.length;
	const lit = values.filter((x) => x > mean * 1e-4).sort((a, b) => a - b);
	if (lit.length === 0)
		return null;
	const middle = lit.reduce((sum, x) => sum + Math.log2(x), 0) / lit.length - Math.log2(0.125);
	const above = lit[lit.length - 1 - Math.floor(lit.length / 50)];
	const highlight = Math.log2(0.18 * Math.pow(2, Math.ceil(Math.log2(above) * 32) / 32) / 0.125);
	return Math.max(middle, Math.min(highlight, middle + 1));
}
