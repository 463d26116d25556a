// Reads a LAS, LAZ or COPC file with the npm package copc, an implementation that shares nothing
// with ours, and compares every value with a CSV file of the same points in the same order. Of a
// COPC file it goes through the nodes, whose points have to lie in their cubes.
//
//   npm install copc; node las_reader.mjs lit.laz lit.csv
//
// A line for each dimension; exit code 1 when a value is further off than the shortest text of a
// float32: 2^-24 of it.
import fs from "fs";
import { createRequire } from "module";

const { Copc, Hierarchy, Key, Las } = createRequire(process.cwd() + "/")("copc");
const [las, csv] = process.argv.slice(2).map((path) => fs.readFileSync(path));
const rows = csv.toString().trim().split("\n").map((row) => row.split(","));
const names = rows.shift();

const read = async (begin, end) => las.subarray(begin, end);
const header = Las.Header.parse(las);
const records = await Las.Vlr.walk(read, header);
const description = Las.Vlr.find(records, "LASF_Spec", 4);
const extra = description ? Las.ExtraBytes.parse(await Las.Vlr.fetch(read, description)) : [];
let good = header.pointCount === rows.length;

// Says which nodes there are; returns a view of each.
const readNodes = async () => {
	const copc = await Copc.create(read);
	const { nodes } = await Copc.loadHierarchyPage(read, copc.info.rootHierarchyPage);
	const views = [];
	for (const [name, node] of Object.entries(nodes)) {
		const view = await Copc.loadPointDataView(read, copc, node);
		const [level, ...place] = name.split("-").map(Number);
		const side = (copc.info.cube[3] - copc.info.cube[0]) / 2 ** level;
		const within = ["X", "Y", "Z"].every((axis, k) => {
			const get = view.getter(axis), low = copc.info.cube[k] + place[k] * side;
			return rows.slice(0, view.pointCount).every((_, i) =>
				get(i) >= low - 1e-9 && get(i) <= low + side + 1e-9);
		});
		good = good && within;
		views.push(view);
	}
	console.log(`COPC of ${views.length} nodes`);
	return views;
};

const readPoints = async () => {
	const bytes = header.pointCount * header.pointDataRecordLength;
	const packed = Las.Vlr.find(records, "laszip encoded", 22204);
	const points = packed ? await Las.PointData.decompressFile(las) :
		las.subarray(header.pointDataOffset, header.pointDataOffset + bytes);
	console.log(packed ? "LAZ" : "LAS");
	return [Las.View.create(points, header, extra)];
};

const views = await (Las.Vlr.find(records, "copc", 1) ? readNodes() : readPoints());
console.log(`version ${header.majorVersion}.${header.minorVersion}, format`,
	header.pointDataRecordFormat, `${header.pointCount} points`);
for (const dimension of Object.keys(views[0].dimensions)) {
	const snake = dimension.replace(/\B[A-Z]/g, (letter) => "_" + letter).toLowerCase();
	const column = names.findIndex((name) => name === dimension || name === snake);
	if (column < 0)
		continue;
	let worst = 0, first = 0;
	for (const view of views) {
		const get = view.getter(dimension);
		for (let i = 0; i < view.pointCount; i++) {
			const value = Number(rows[first + i][column]);
			worst = Math.max(worst, Math.abs(get(i) - value) / Math.max(Math.abs(value), 1e-30));
		}
		first += view.pointCount;
	}
	good = good && worst <= 2 ** -24 && first === rows.length;
	console.log(`${dimension}: ${worst <= 2 ** -24 ? "same" : "off by " + worst}`);
}
process.exit(good ? 0 : 1);
