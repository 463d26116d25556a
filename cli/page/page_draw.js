/*
 * Drawing: all points and their light lie in textures. A first pass adds up what the lamps give each
 * point; it is done again when a lamp is changed. For a picture, all discs are drawn twice: first
 * only their depth, half a radius behind where they are, then the light of all that lie before that,
 * each pixel taking the mean of the discs that overlap there, heavier in their middles. The last
 * pass divides by the weights and fits the light to the screen.
 */
const LEAST_ALBEDO = 0.004; /* what reflects less does not tell what falls on it */
const BRIGHTEST = 1000;     /* white by every tone map, and small enough for sums of half floats */
const LARGEST_HALF = 65504, LARGEST_FLOAT = 3e38;
const LARGEST_PACKED = 32768; /* of light in units of its lamp's scale */

const HOLE = 48; /* samples, half of the widest hole that is closed */

const HEAD = `#version 300 es
precision highp float;
precision highp int;
precision highp usampler2D;
precision highp sampler2DArray;
#define ROW ${scene.row}
#define LAMPS ${scene.lamps.length}
#define LEAST_ALBEDO ${LEAST_ALBEDO}
#define HOLE ${HOLE}
#define LARGEST_HALF ${LARGEST_HALF}.0
`;

const ADD_UP = `${HEAD}
uniform sampler2DArray light; /* a layer a lamp */
uniform sampler2D gains;      /* a texel a lamp */
out vec4 radiance;
void main()
{
	vec3 sum = vec3(0.0);
	for (int l = 0; l < LAMPS; l++)
		sum += texelFetch(gains, ivec2(l, 0), 0).rgb *
			   texelFetch(light, ivec3(ivec2(gl_FragCoord.xy), l), 0).rgb;
	radiance = vec4(sum, 1.0);
}`;

/* What each lamp gives one point: a texel a lamp. */
const APART = `${HEAD}
uniform sampler2DArray light;
uniform sampler2D gains;
uniform ivec2 point;
out vec4 radiance;
void main()
{
	int l = int(gl_FragCoord.x);
	radiance = vec4(texelFetch(gains, ivec2(l, 0), 0).rgb *
					texelFetch(light, ivec3(point, l), 0).rgb, 1.0);
}`;

const WHOLE = `${HEAD}
void main()
{
	gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0);
}`;

const DISC = `
uniform usampler2D places, cuts;
uniform sampler2D mixed, albedos;
uniform vec3 eye, right, up, forward; /* metres from the corner; unit */
uniform vec4 projection;              /* x, y scale; nearest; of the logarithm of depth */
uniform float unit_step, largest, least, pixel, factor, most, behind;
uniform int cull, quantity, first;
flat out vec4 shown;
flat out uint which, cut;
out vec2 local; /* in radii */

const float PI = 3.14159265358979;
const vec3 LUMINANCE = vec3(0.2126, 0.7152, 0.0722);

vec3 normal_of(uint word)
{
	vec2 o = vec2(word & 255u, word >> 8 & 255u) / 127.0 - 1.0;
	vec3 n = vec3(o, 1.0 - abs(o.x) - abs(o.y));
	float fold = max(-n.z, 0.0);
	n.x += n.x >= 0.0 ? -fold : fold;
	n.y += n.y >= 0.0 ? -fold : fold;
	return normalize(n);
}

/* Luminance of the light that falls on a point: pi L / albedo, of the channels that tell. */
float incident(vec3 radiance, vec3 root)
{
	vec3 albedo = root * root, tells = step(LEAST_ALBEDO, albedo);
	float all = dot(tells, LUMINANCE);
	return all > 0.0 ? PI * dot(tells * radiance / max(albedo, LEAST_ALBEDO), LUMINANCE) / all : 0.0;
}

void main()
{
	int point = first + gl_InstanceID;
	ivec2 at = ivec2(point % ROW, point / ROW);
	uvec4 place = texelFetch(places, at, 0);
	vec3 middle = vec3(place.xyz) * unit_step - eye, n = normal_of(place.w);
	float depth = dot(middle, forward);
	bool two_sided = (place.w >> 24 & 1u) != 0u, glows = (place.w >> 24 & 2u) != 0u;
	which = uint(point);
	cut = texelFetch(cuts, at, 0).r;
	shown = vec4(0.0);
	local = 2.0 * vec2(gl_VertexID & 1, gl_VertexID >> 1) - 1.0;
	bool back = dot(n, middle) > 0.0 && !two_sided;
	if (cull == 1 && back) {
		gl_Position = vec4(0.0, 0.0, 2.0, 1.0);
		return;
	}

	/* The disc. Wider where not all points are drawn, or it would fall between pixels. */
	float radius = largest * exp2((float(place.w >> 16 & 255u) - 255.0) / 12.0);
	radius = max(max(radius, least), 0.7 * pixel * depth);
	float s = n.z >= 0.0 ? 1.0 : -1.0, a = -1.0 / (s + n.z), c = n.x * n.y * a;
	vec3 t = vec3(1.0 + s * n.x * n.x * a, s * c, -s * n.x), b = vec3(c, s + n.y * n.y * a, -n.y);
	vec3 corner = middle + radius * (t * local.x + b * local.y);
	/* The back of a surface lies behind a front as near. */
	corner *= 1.0 + (behind + (back ? 0.5 : 0.0)) * radius / max(length(corner), 1e-30);
	/* Depth grows as its logarithm, so that far discs are told apart as well as near ones: linear
	 * about each middle, that discs stay flat. */
	float z = dot(corner, forward), m = max(depth, projection.z);
	float at_middle = projection.w * log(m / projection.z) - 1.0;
	gl_Position = vec4(projection.x * dot(corner, right), projection.y * dot(corner, up),
					   z * at_middle + projection.w * (z - m), z);

	vec3 radiance = texelFetch(mixed, at, 0).rgb, root = texelFetch(albedos, at, 0).rgb;
	shown = vec4(quantity == 2 ? vec3(glows ? 0.0 : incident(radiance, root)) : radiance,
				 glows ? 0.5 : 1.0);
	shown.rgb = min(shown.rgb * factor, most);
}`;

/* What lies outside of the circle, or beyond a cut, is no part of a disc. */
const IN_DISC = `
flat in vec4 shown;
flat in uint which, cut;
in vec2 local;
bool beyond(uint angle, uint distance_of)
{
	float turn = float(angle) * (2.0 * 3.14159265 / 256.0);
	return distance_of != 255u &&
		   dot(vec2(cos(turn), sin(turn)), local) > float(distance_of) / 127.0 - 1.0;
}
bool is_cut()
{
	return beyond(cut & 255u, cut >> 8 & 255u) || beyond(cut >> 16 & 255u, cut >> 24);
}
float squared()
{
	float r2 = dot(local, local);
	if (r2 > 1.0)
		discard;
	return r2;
}
float squared_within()
{
	if (is_cut())
		discard;
	return squared();
}`;

const DEPTH = `${HEAD + IN_DISC}
void main() { squared_within(); }`;

/* 1 in the middle, a trace at the rim, so that what a disc covers has a weight. What glows is added
 * up by itself, and so is what lies beyond the cuts of discs. */
const BLEND = `${HEAD + IN_DISC}
layout(location = 0) out vec4 sum;
layout(location = 1) out vec4 glow;
layout(location = 2) out vec4 rest;
void main()
{
	float inner = 1.0 - squared(), weight = inner * inner * inner + 1e-4;
	bool within = !is_cut(), glows = shown.a < 1.0;
	vec4 all = vec4(shown.rgb, 1.0) * weight;
	sum = within && !glows ? all : vec4(0.0);
	glow = within && glows ? all : vec4(0.0);
	rest = within ? vec4(0.0) : all;
}`;

const PLAIN = `${HEAD + IN_DISC}
out vec4 value;
void main()
{
	squared_within();
	value = shown;
}`;

const PICK = `${HEAD + IN_DISC}
out uvec4 number;
void main()
{
	squared_within();
	number = uvec4(which + 1u, 0u, 0u, 0u);
}`;

/* From sums to what a screen shows: the mean of over x over samples a pixel. */
const FIT = `${HEAD}
uniform sampler2D sums, glow, rest, ramp;
uniform int over, tone, quantity, logarithmic;
uniform vec2 range; /* in units of the sums */
out vec4 color;
const vec3 LUMINANCE = vec3(0.2126, 0.7152, 0.0722);

/* Khronos PBR Neutral; Reinhard by luminance. As glowworm render has them. */
vec3 tone_map(vec3 c)
{
	if (tone == 1)
		return c / (1.0 + dot(c, LUMINANCE));
	if (tone == 2)
		return c;
	float least_of = min(c.r, min(c.g, c.b));
	c -= least_of < 0.08 ? least_of - 6.25 * least_of * least_of : 0.04;
	float peak = max(c.r, max(c.g, c.b)), start = 0.76, room = 1.0 - start;
	if (peak < start)
		return c;
	float lower = 1.0 - room * room / (peak + room - start);
	float white = 1.0 - 1.0 / (0.15 * (peak - lower) + 1.0);
	return mix(c * (lower / peak), vec3(lower), white);
}

vec3 encode(vec3 c)
{
	c = clamp(c, 0.0, 1.0);
	return mix(12.92 * c, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c));
}

vec3 false_color(float value)
{
	float at = logarithmic == 1 ? log(max(value, 1e-30) / range.x) / log(range.y / range.x)
								: (value - range.x) / (range.y - range.x);
	return texelFetch(ramp, ivec2(clamp(at, 0.0, 1.0) * 255.0 + 0.5, 0), 0).rgb;
}

float covered(ivec2 at)
{
	return texelFetch(sums, at, 0).a + texelFetch(glow, at, 0).a;
}
/* Is a sample that nothing covers a hole: is there something to all sides, not far, or the picture's
 * end? */
bool is_hole(ivec2 at)
{
	ivec2 end = textureSize(sums, 0) - 1;
	for (int side = 0; side < 4; side++) {
		ivec2 way = ivec2(side < 2 ? 1 : 0, side < 2 ? 0 : 1) * (side % 2 == 0 ? 1 : -1);
		float found = 0.0;
		for (int step_of = 2; step_of <= HOLE && found <= 0.0; step_of += 2) {
			ivec2 there = at + way * step_of;
			found = there == clamp(there, ivec2(0), end) ? covered(there) : 1.0;
		}
		if (found <= 0.0)
			return false;
	}
	return true;
}
/* Of what glows and what does not the one that weighs more; in holes what lies beyond cuts. Linear,
 * so that samples can be averaged; colours of a scale are encoded already, and illuminance of what
 * glows is not known. */
vec3 fit(ivec2 at)
{
	vec4 sum = texelFetch(sums, at, 0), own = texelFetch(glow, at, 0);
	bool glows = own.a > sum.a;
	sum = glows ? own : sum;
	if (sum.a <= 0.0)
		sum = texelFetch(rest, at, 0);
	if (sum.a <= 0.0 || (covered(at) <= 0.0 && !is_hole(at)))
		return vec3(0.0);
	if (glows && quantity == 2)
		return vec3(0.5);
	vec3 value = min(sum.rgb, LARGEST_HALF) / sum.a;
	if (quantity == 0)
		return clamp(tone_map(value), 0.0, 1.0);
	return false_color(quantity == 1 ? dot(value, LUMINANCE) : value.r);
}
void main()
{
	vec3 mean = vec3(0.0);
	for (int y = 0; y < over; y++)
		for (int x = 0; x < over; x++)
			mean += fit(ivec2(gl_FragCoord.xy) * over + ivec2(x, y));
	mean /= float(over * over);
	color = vec4(quantity == 0 ? encode(mean) : mean, 1.0);
}`;

const TONE = ["pbr-neutral", "reinhard", "none"];
const METER_HEIGHT = 120; /* pixels */

/* How the light is shown; the panel changes it. */
const look = { quantity: 0, exposure: 0, tone: 0, low: 0.1, high: 1, logarithmic: true, cull: false };

class Drawing {
	constructor(canvas) {
		const gl = canvas.getContext("webgl2", { antialias: false, depth: false, alpha: false,
			powerPreference: "high-performance" });
		if (!gl)
			throw new Error("This browser shows no WebGL 2, which the page needs.");
		this.half = !gl.getExtension("EXT_color_buffer_float");
		if (this.half && !gl.getExtension("EXT_color_buffer_half_float"))
			throw new Error("This browser cannot add up light as floats (EXT_color_buffer_float).");
		this.gl = gl;
		this.canvas = canvas;
		this.ready = 0; /* points in the textures */
		this.makePrograms();
		this.makeTextures();
		gl.enable(gl.DEPTH_TEST);
	}

	/* ------------------------------------------------------------------------------- making */

	shader(type, text) {
		const gl = this.gl, shader = gl.createShader(type);
		gl.shaderSource(shader, text);
		gl.compileShader(shader);
		return shader;
	}
	program(vertex, fragment) {
		const gl = this.gl, program = gl.createProgram();
		gl.attachShader(program, this.shader(gl.VERTEX_SHADER, vertex));
		gl.attachShader(program, this.shader(gl.FRAGMENT_SHADER, fragment));
		gl.linkProgram(program);
		if (!gl.getProgramParameter(program, gl.LINK_STATUS))
			throw new Error("The graphics driver refuses a program: " +
				gl.getProgramInfoLog(program) + gl.getAttachedShaders(program).map(
				(s) => gl.getShaderInfoLog(s)).join(" "));
		const at = {};
		for (let i = 0; i < gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); i++) {
			const name = gl.getActiveUniform(program, i).name;
			at[name] = gl.getUniformLocation(program, name);
		}
		return { program, at };
	}
	makePrograms() {
		const gl = this.gl;
		this.addUp = this.program(WHOLE, ADD_UP);
		this.apart = this.program(WHOLE, APART);
		this.depth = this.program(HEAD + DISC, DEPTH);
		this.blend = this.program(HEAD + DISC, BLEND);
		this.measure = this.program(HEAD + DISC, PLAIN);
		this.identify = this.program(HEAD + DISC, PICK);
		this.fit = this.program(WHOLE, FIT);
		this.nothing = gl.createVertexArray();
	}
	texture(unit, target, format, width, height, layers) {
		const gl = this.gl, texture = gl.createTexture();
		gl.activeTexture(gl.TEXTURE0 + unit);
		gl.bindTexture(target, texture);
		for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER])
			gl.texParameteri(target, name, gl.NEAREST);
		if (layers)
			gl.texStorage3D(target, 1, format, width, height, layers);
		else
			gl.texStorage2D(target, 1, format, width, height);
		return texture;
	}
	target(texture) {
		const gl = this.gl, frame = gl.createFramebuffer();
		gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
		gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texture, 0);
		return frame;
	}
	/* Units: 0 places, 1 cuts, 2 light, 3 gains, 4 mixed, 5 albedos, 6 ramp, 7 sums of a picture,
	 * 8 those of what glows, 9 of what lies beyond cuts. */
	makeTextures() {
		const gl = this.gl, lamps = scene.lamps.length;
		const most = Math.min(gl.getParameter(gl.MAX_TEXTURE_SIZE),
			Math.ceil(scene.count / scene.row));
		this.float = this.half ? gl.RGBA16F : gl.RGBA32F;
		this.room = most * scene.row; /* points that this device holds */
		this.placed = this.target(this.texture(0, gl.TEXTURE_2D, gl.RGBA32UI, scene.row, most));
		this.texture(1, gl.TEXTURE_2D, gl.R32UI, scene.row, most);
		this.texture(2, gl.TEXTURE_2D_ARRAY, gl.RGB9_E5, scene.row, most, lamps);
		this.texture(3, gl.TEXTURE_2D, gl.RGBA32F, lamps, 1);
		this.mixed = this.target(this.texture(4, gl.TEXTURE_2D, this.float, scene.row, most));
		this.rooted = this.target(this.texture(5, gl.TEXTURE_2D, gl.RGBA8, scene.row, most));
		this.texture(6, gl.TEXTURE_2D, gl.RGBA8, 256, 1);
		this.one = this.target(this.texture(7, gl.TEXTURE_2D, this.float, lamps, 1));
		if (gl.getError() !== gl.NO_ERROR)
			throw new Error("This device has no room for the points.");
		const ramp = new Uint8Array(1024);
		for (let i = 0; i < 768; i++)
			ramp[Math.floor(i / 3) * 4 + i % 3] = parseInt(scene.ramp.substr(2 * i, 2), 16);
		this.ramp = ramp;
		gl.activeTexture(gl.TEXTURE6);
		gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, 256, 1, gl.RGBA, gl.UNSIGNED_BYTE, ramp);
		for (const one of [this.addUp, this.apart, this.depth, this.blend, this.measure,
			this.identify, this.fit]) {
			gl.useProgram(one.program);
			["places", "cuts", "light", "gains", "mixed", "albedos", "ramp", "sums", "glow",
				"rest"].forEach(
				(name, unit) => one.at[name] && gl.uniform1i(one.at[name], unit));
		}
	}

	/* ------------------------------------------------------------------------------- light */

	/* Puts a block's points behind those that are there. */
	add(block) {
		const gl = this.gl, row = scene.row, y = this.ready / row;
		const rows = Math.min(block.rows, this.room / row - y);
		if (rows <= 0)
			return;
		const put = (unit, format, type, data) => {
			gl.activeTexture(gl.TEXTURE0 + unit);
			gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, y, row, rows, format, type, data);
		};
		put(0, gl.RGBA_INTEGER, gl.UNSIGNED_INT, block.place);
		put(1, gl.RED_INTEGER, gl.UNSIGNED_INT, block.cut);
		put(5, gl.RGBA, gl.UNSIGNED_BYTE, block.albedo);
		gl.activeTexture(gl.TEXTURE2);
		block.light.forEach((light, l) => gl.texSubImage3D(gl.TEXTURE_2D_ARRAY, 0, 0, y, l, row,
			rows, 1, gl.RGB, gl.UNSIGNED_INT_5_9_9_9_REV, light));
		this.ready = Math.min(this.ready + block.count, this.room);
		this.mix(y, rows);
	}
	/* Three factors for each lamp, without its scale. Light is kept times `exposed`. */
	setGains(gains) {
		const gl = this.gl, texels = new Float32Array(4 * scene.lamps.length);
		this.exposed = this.half ? this.exposureOf(gains) : 1;
		scene.lamps.forEach((lamp, l) => {
			for (let k = 0; k < 3; k++)
				texels[4 * l + k] = gains[l][k] * lamp.scale * this.exposed;
		});
		gl.activeTexture(gl.TEXTURE3);
		gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, scene.lamps.length, 1, gl.RGBA, gl.FLOAT, texels);
		this.mix(0, Math.ceil(this.ready / scene.row));
	}
	/* The power of two times which light is kept, so that half floats hold the brightest there can
	 * be. */
	exposureOf(gains) {
		const most = scene.lamps.reduce(
			(sum, lamp, l) => sum + LARGEST_PACKED * lamp.scale * Math.max(...gains[l]), 0);
		return most > 0 ? Math.pow(2, Math.floor(Math.log2(LARGEST_HALF / most))) : 1;
	}
	/* Adds up the lamps for some rows of points. */
	mix(y, rows) {
		const gl = this.gl;
		if (rows > 0)
			this.fill(this.addUp, this.mixed, 0, y, scene.row, rows);
	}
	fill(program, frame, x, y, width, height, whole = scene.row) {
		const gl = this.gl;
		gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
		gl.viewport(0, 0, whole, y + height);
		gl.enable(gl.SCISSOR_TEST);
		gl.scissor(x, y, width, height);
		gl.disable(gl.DEPTH_TEST);
		gl.useProgram(program.program);
		gl.bindVertexArray(this.nothing);
		gl.drawArrays(gl.TRIANGLES, 0, 3);
		gl.enable(gl.DEPTH_TEST);
		gl.disable(gl.SCISSOR_TEST);
	}
	/* Of all points: four words of place, and the radiance as it is shown, four floats. */
	places() {
		const gl = this.gl, rows = Math.ceil(this.ready / scene.row);
		const all = new Uint32Array(4 * scene.row * rows);
		gl.bindFramebuffer(gl.FRAMEBUFFER, this.placed);
		gl.readPixels(0, 0, scene.row, rows, gl.RGBA_INTEGER, gl.UNSIGNED_INT, all);
		return all.subarray(0, 4 * this.ready);
	}
	radiance() {
		const gl = this.gl, rows = Math.ceil(this.ready / scene.row);
		const all = new Float32Array(4 * scene.row * rows);
		gl.bindFramebuffer(gl.FRAMEBUFFER, this.mixed);
		gl.readPixels(0, 0, scene.row, rows, gl.RGBA, gl.FLOAT, all);
		return this.unexposed(all.subarray(0, 4 * this.ready), this.exposed);
	}
	/* Light as it is, of light that was kept times a factor: 4 floats each. */
	unexposed(values, factor) {
		for (let i = 0; i < values.length; i++)
			if (i % 4 < 3)
				values[i] /= factor;
		return values;
	}
	/* Of one point: its place in metres from the corner, radiance, and what of it each lamp gives. */
	point(index) {
		const gl = this.gl, x = index % scene.row, y = Math.floor(index / scene.row);
		const lamps = scene.lamps.length, apart = new Float32Array(4 * lamps);
		const word = new Uint32Array(4);
		gl.bindFramebuffer(gl.FRAMEBUFFER, this.placed);
		gl.readPixels(x, y, 1, 1, gl.RGBA_INTEGER, gl.UNSIGNED_INT, word);
		gl.useProgram(this.apart.program);
		gl.uniform2i(this.apart.at.point, x, y);
		this.fill(this.apart, this.one, 0, 0, lamps, 1);
		gl.readPixels(0, 0, lamps, 1, gl.RGBA, gl.FLOAT, apart);
		this.unexposed(apart, this.exposed);
		const byLamp = scene.lamps.map((lamp, l) => [...apart.subarray(4 * l, 4 * l + 3)]);
		const radiance = [0, 1, 2].map((k) => byLamp.reduce((sum, rgb) => sum + rgb[k], 0));
		const place = [...word.subarray(0, 3)].map((steps) => steps * scene.step);
		return { place, radiance, byLamp };
	}

	/* The illuminance of a point, as the shader finds it; null where it glows. */
	incident(index) {
		const gl = this.gl, x = index % scene.row, y = Math.floor(index / scene.row);
		const word = new Uint32Array(4), root = new Uint8Array(4);
		gl.bindFramebuffer(gl.FRAMEBUFFER, this.placed);
		gl.readPixels(x, y, 1, 1, gl.RGBA_INTEGER, gl.UNSIGNED_INT, word);
		gl.bindFramebuffer(gl.FRAMEBUFFER, this.rooted);
		gl.readPixels(x, y, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, root);
		const { radiance } = this.point(index), weight = [0.2126, 0.7152, 0.0722];
		let sum = 0, tells = 0;
		for (let k = 0; k < 3; k++) {
			const albedo = (root[k] / 255) ** 2;
			if (albedo >= LEAST_ALBEDO) {
				sum += weight[k] * Math.PI * radiance[k] / albedo;
				tells += weight[k];
			}
		}
		return word[3] >>> 24 & 2 ? null : tells > 0 ? sum / tells : 0;
	}

	/* ----------------------------------------------------------------------------- pictures */

	/* The radius by which the first so many points leave no holes: they are one cell apart, give or
	 * take as much. */
	leastRadius(count) {
		if (count >= scene.count)
			return 0;
		const level = Math.max(scene.levels.findIndex((l) => l.end > count), 1);
		const before = scene.levels[level - 1], after = scene.levels[level];
		const share = (count - before.end) / Math.max(after.end - before.end, 1);
		return before.cell * Math.pow(after.cell / before.cell, share);
	}
	/* Sets a program that draws discs up.
	 *   factor  of the light
	 *   most    that a channel is after it
	 *   behind  radii by which discs are put further away */
	aim(program, width, height, count, { factor = 1, most = 1, behind = 0 }) {
		const gl = this.gl, at = program.at, axes = camera.axes();
		const tangent = camera.tangent(width, height);
		const near = camera.nearest();
		const far = norm(add(camera.eye, scene.side, -0.5)) + camera.extent;
		gl.viewport(0, 0, width, height);
		gl.useProgram(program.program);
		gl.uniform3fv(at.eye, camera.eye);
		gl.uniform3fv(at.right, axes.right);
		gl.uniform3fv(at.up, axes.up);
		gl.uniform3fv(at.forward, axes.forward);
		gl.uniform4f(at.projection, height / width / tangent, 1 / tangent, near,
			2 / Math.log(far / near));
		gl.uniform1f(at.unit_step, scene.step);
		gl.uniform1f(at.largest, scene.radius);
		gl.uniform1f(at.least, this.leastRadius(count));
		gl.uniform1f(at.pixel, 2 * tangent / height);
		gl.uniform1f(at.factor, factor / this.exposed);
		gl.uniform1f(at.most, most);
		gl.uniform1f(at.behind, behind);
		gl.uniform1i(at.cull, look.cull ? 1 : 0);
		gl.uniform1i(at.quantity, look.quantity);
	}
	/* Draws points first .. end - 1 into the framebuffer that is bound, as wide as they have to be
	 * among `count`. */
	drawDiscs(program, width, height, count, part = {}) {
		const gl = this.gl, first = part.first ?? 0, end = Math.min(part.end ?? count, this.ready);
		this.aim(program, width, height, count, part);
		gl.uniform1i(program.at.first, first);
		gl.bindVertexArray(this.nothing);
		gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, Math.max(end - first, 0));
	}
	/* A framebuffer with depth, whose light is the textures of units 7 to 9. */
	surface(width, height) {
		const gl = this.gl;
		if (this.sums && this.sums.width === width && this.sums.height === height)
			return this.sums;
		if (this.sums) {
			this.sums.textures.forEach((one) => gl.deleteTexture(one));
			gl.deleteFramebuffer(this.sums.frame);
			gl.deleteRenderbuffer(this.sums.depth);
		}
		const textures = [7, 8, 9].map((unit) =>
			this.texture(unit, gl.TEXTURE_2D, gl.RGBA16F, width, height));
		const targets = textures.map((texture, i) => gl.COLOR_ATTACHMENT0 + i);
		const frame = this.target(textures[0]);
		textures.forEach((texture, i) => gl.framebufferTexture2D(gl.FRAMEBUFFER, targets[i],
			gl.TEXTURE_2D, texture, 0));
		gl.drawBuffers(targets);
		this.sums = { width, height, textures, frame, depth: this.attachDepth(width, height) };
		return this.sums;
	}
	attachDepth(width, height) {
		const gl = this.gl, depth = gl.createRenderbuffer();
		gl.bindRenderbuffer(gl.RENDERBUFFER, depth);
		gl.renderbufferStorage(gl.RENDERBUFFER, gl.DEPTH_COMPONENT24, width, height);
		gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.RENDERBUFFER, depth);
		return depth;
	}
	/* Draws a picture of the first `count` points into a framebuffer, null being the screen, with
	 * over x over samples a pixel; pauses after every so many points. */
	*drawPicture(frame, width, height, count, over, together = Infinity) {
		const gl = this.gl, sums = this.surface(width * over, height * over);
		const factor = look.quantity ? 1 / look.high : 0.18 / (0.125 * Math.pow(2, look.exposure));
		gl.bindFramebuffer(gl.FRAMEBUFFER, sums.frame);
		for (const target of [0, 1, 2])
			gl.clearBufferfv(gl.COLOR, target, [0, 0, 0, 0]);
		gl.clear(gl.DEPTH_BUFFER_BIT);
		for (const blended of [false, true])
			for (let first = 0; first < count; first += together) {
				const end = Math.min(first + together, count);
				gl.bindFramebuffer(gl.FRAMEBUFFER, sums.frame);
				this.drawPart(sums, count,
					{ first, end, factor, most: BRIGHTEST, behind: blended ? 0 : 0.5 }, blended);
				if (together < count)
					yield;
			}
		this.fitPicture(frame, width, height, over, factor);
	}
	/* The depth of some points, or their light. */
	drawPart(sums, count, part, blended) {
		const gl = this.gl;
		gl.colorMask(blended, blended, blended, blended);
		gl.depthMask(!blended);
		if (blended)
			gl.enable(gl.BLEND);
		gl.blendFunc(gl.ONE, gl.ONE);
		this.drawDiscs(blended ? this.blend : this.depth, sums.width, sums.height, count, part);
		gl.disable(gl.BLEND);
		gl.colorMask(true, true, true, true);
		gl.depthMask(true);
	}
	fitPicture(frame, width, height, over, factor) {
		const gl = this.gl, at = this.fit.at;
		gl.useProgram(this.fit.program);
		gl.uniform1i(at.over, over);
		gl.uniform1i(at.tone, look.tone);
		gl.uniform1i(at.quantity, look.quantity);
		gl.uniform1i(at.logarithmic, look.logarithmic ? 1 : 0);
		gl.uniform2f(at.range, look.low * factor, look.high * factor);
		this.fill(this.fit, frame, 0, 0, width, height, width);
	}
	/* Draws the first `count` points on the screen, pausing after every so many. */
	draw(count, together) {
		return this.drawPicture(null, this.canvas.width, this.canvas.height, count, 1, together);
	}
	/* A framebuffer for what is read back. */
	buffer(format, width, height) {
		const gl = this.gl, frame = gl.createFramebuffer(), values = gl.createRenderbuffer();
		gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
		gl.bindRenderbuffer(gl.RENDERBUFFER, values);
		gl.renderbufferStorage(gl.RENDERBUFFER, format, width, height);
		gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.RENDERBUFFER, values);
		const depth = this.attachDepth(width, height);
		gl.clear(gl.DEPTH_BUFFER_BIT);
		return { frame, free() {
			gl.deleteFramebuffer(frame);
			gl.deleteRenderbuffer(values);
			gl.deleteRenderbuffer(depth);
		} };
	}
	/* Bytes of a picture, R G B A, the lowest row first. Takes the sums of a picture that is not
	 * whole on the screen, which begins again. */
	picture(width, height) {
		const gl = this.gl, pixels = new Uint8ClampedArray(4 * width * height);
		const buffer = this.buffer(gl.RGBA8, width, height);
		const over = 2 * Math.max(width, height) <= gl.getParameter(gl.MAX_RENDERBUFFER_SIZE) ? 2 : 1;
		frames.ask();
		this.drawPicture(buffer.frame, width, height, this.ready, over).next();
		gl.bindFramebuffer(gl.FRAMEBUFFER, buffer.frame);
		gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(pixels.buffer));
		buffer.free();
		return pixels;
	}
	/* As many points as are drawn at once; to find out about the view, they are enough. */
	some() {
		return Math.min(this.ready, Math.max(frames.budget, 50000));
	}
	/* Radiance, or illuminance, of what is in view: 4 floats a pixel; the fourth is 0 where nothing
	 * is, and 0.5 where something glows. */
	inView() {
		const gl = this.gl, height = METER_HEIGHT;
		const width = Math.max(1, Math.min(16 * height,
			Math.floor(this.canvas.width * height / this.canvas.height)));
		const buffer = this.buffer(this.float, width, height);
		const values = new Float32Array(4 * width * height);
		gl.clearBufferfv(gl.COLOR, 0, [0, 0, 0, 0]);
		/* Illuminance is pi / albedo times the radiance. */
		const factor = this.exposed *
			(this.half && look.quantity === 2 ? LEAST_ALBEDO / Math.PI : 1);
		this.drawDiscs(this.measure, width, height, this.some(),
			{ factor, most: this.half ? LARGEST_HALF : LARGEST_FLOAT });
		gl.readPixels(0, 0, width, height, gl.RGBA, gl.FLOAT, values);
		buffer.free();
		return this.unexposed(values, factor);
	}
	/* The point under a place of the canvas, or -1. */
	pick(x, y) {
		const gl = this.gl, word = new Uint32Array(4);
		const width = this.canvas.clientWidth, height = this.canvas.clientHeight;
		const buffer = this.buffer(gl.RGBA32UI, width, height);
		gl.clearBufferuiv(gl.COLOR, 0, [0, 0, 0, 0]);
		gl.enable(gl.SCISSOR_TEST);
		gl.scissor(x, height - 1 - y, 1, 1);
		this.drawDiscs(this.identify, width, height, this.some());
		gl.disable(gl.SCISSOR_TEST);
		gl.readPixels(x, height - 1 - y, 1, 1, gl.RGBA_INTEGER, gl.UNSIGNED_INT, word);
		buffer.free();
		return word[0] - 1;
	}
}
