"use strict";
/*
 * From blocks of text to arrays for textures. page_points.h, which packs them, says what is where.
 */
const scene = JSON.parse(document.getElementById("scene").textContent);

/* Bytes of a block that was deflated and put in base64. */
async function inflate(text) {
	const packed = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
	const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate-raw"));
	return new Uint8Array(await new Response(stream).arrayBuffer());
}

/* Little-endian words whose four bytes stand in four planes. */
function readWords(bytes, plane, count, room) {
	const words = new Uint32Array(room);
	for (let b = 0; b < 4; b++)
		for (let i = 0, from = (plane + b) * count; i < count; i++)
			words[i] |= bytes[from + i] << (8 * b);
	return words;
}

/*
 * The points of a block: four words of place (steps along x, y, z; normal, radius, flags), a word of
 * cuts, four bytes of albedo, and a word of light for each lamp. Arrays end with whole rows.
 */
function unpack(bytes, count) {
	const room = Math.ceil(count / scene.row) * scene.row;
	const place = new Uint32Array(4 * room), albedo = new Uint8Array(4 * room);
	for (let k = 0; k < 3; k++) {
		const off = readWords(bytes, 4 * k, count, room);
		for (let i = 0, at = 0; i < count; i++) {
			at += off[i] & 1 ? -((off[i] >>> 1) + 1) : off[i] >>> 1;
			place[4 * i + k] = at;
			albedo[4 * i + k] = bytes[(20 + k) * count + i];
		}
	}
	const disc = readWords(bytes, 12, count, room);
	for (let i = 0; i < count; i++)
		place[4 * i + 3] = disc[i];
	const light = scene.lamps.map((lamp, l) => readWords(bytes, 23 + 4 * l, count, room));
	return { count, rows: room / scene.row, place, albedo, cut: readWords(bytes, 16, count, room),
		light };
}
