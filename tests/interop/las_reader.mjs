// Reads a LAS file with the npm package copc, an implementation that shares nothing with ours, and
// compares every value with a CSV file of the same points.
//
//   npm install copc; node las_reader.mjs lit.las lit.csv
//
// No Debian package reads LAS, so this is run by hand. A line for each dimension; exit code 1 when
// a value is further off than the shortest text of a float32: 2^-24 of it.
import fs from "fs";
import { createRequire } from "module";

const { Las } = createRequire(process.cwd() + "/")("copc");
const [las, csv] = process.argv.slice(2).map((path) => fs.readFileSync(path));
const rows = csv.toString().trim().split("\n").map((row) => row.split(","));
const names = rows.shift();

const read = async (begin, end) => las.subarray(begin, end);
const header = Las.Header.parse(las);
const records = await Las.Vlr.walk(read, header);
const description = Las.Vlr.find(records, "LASF_Spec", 4);
const extra = description ? Las.ExtraBytes.parse(await Las.Vlr.fetch(read, description)) : [];
const bytes = header.pointCount * header.pointDataRecordLength;
const points = las.subarray(header.pointDataOffset, header.pointDataOffset + bytes);
const view = Las.View.create(points, header, extra);

console.log(`LAS ${header.majorVersion}.${header.minorVersion}, format`,
	header.pointDataRecordFormat, `${header.pointCount} points`);
let good = header.pointCount === rows.length;
for (const dimension of Object.keys(view.dimensions)) {
	const snake = dimension.replace(/\B[A-Z]/g, (letter) => "_" + letter).toLowerCase();
	const column = names.findIndex((name) => name === dimension || name === snake);
	if (column < 0)
		continue;
	const get = view.getter(dimension);
	const worst = rows.reduce((most, row, i) => {
		const value = Number(row[column]);
		return Math.max(most, Math.abs(get(i) - value) / Math.max(Math.abs(value), 1e-30));
	}, 0);
	good = good && worst <= 2 ** -24;
	console.log(`${dimension}: ${worst <= 2 ** -24 ? "same" : "off by " + worst}`);
}
process.exit(good ? 0 : 1);
