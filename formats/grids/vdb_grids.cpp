/*
 * Builds and checks OpenVDB files. This file and OpenVDB are one shared object, which takes nothing
 * from the program but the functions' arguments; no exception leaves it.
 */
#include "grids/vdb_grids.h"

#include <openvdb/openvdb.h>
#include <openvdb/io/Stream.h>
#include <openvdb/points/PointConversion.h>
#include <openvdb/points/PointCount.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <memory>
#include <new>
#include <ostream>
#include <stdexcept>
#include <streambuf>
#include <string>
#include <vector>

/*
 * OpenVDB's library has the grids of these types compiled, since it registers them, but its headers
 * do not say so, and to compile them here once more takes three quarters of a minute. What the
 * library of another version has is not known, nor what another compiler leaves to it: there all is
 * compiled here. So is the one function that the library has inlined everywhere. Clang's analyzer
 * links nothing, and looks at what is ours.
 */
#if OPENVDB_LIBRARY_MAJOR_VERSION_NUMBER == 10 && OPENVDB_LIBRARY_MINOR_VERSION_NUMBER == 0 &&     \
	((defined(__OPTIMIZE__) && !defined(__clang__)) || defined(__clang_analyzer__)) &&             \
	!defined(VDB_OWN_TEMPLATES)
template <typename Tree> using upper_node = typename Tree::RootNodeType::ChildNodeType;
template <typename Tree> using lower_node = typename upper_node<Tree>::ChildNodeType;
#define COMPILED_ELSEWHERE(type)                                                                   \
	extern template class openvdb::Grid<type>;                                                     \
	extern template class openvdb::tree::Tree<type::RootNodeType>;                                 \
	extern template class openvdb::tree::RootNode<upper_node<type>>;                               \
	extern template class openvdb::tree::InternalNode<lower_node<type>, 5>;                        \
	extern template class openvdb::tree::InternalNode<type::LeafNodeType, 4>;                      \
	template void openvdb::tree::InternalNode<lower_node<type>, 5>::getNodeLog2Dims(               \
		std::vector<openvdb::Index> &);                                                            \
	template void openvdb::tree::InternalNode<type::LeafNodeType, 4>::getNodeLog2Dims(             \
		std::vector<openvdb::Index> &);
COMPILED_ELSEWHERE(openvdb::FloatTree)
COMPILED_ELSEWHERE(openvdb::Vec3STree)
COMPILED_ELSEWHERE(openvdb::Int32Tree)
COMPILED_ELSEWHERE(openvdb::tools::PointIndexTree)
COMPILED_ELSEWHERE(openvdb::points::PointDataTree)
#endif

namespace
{

/* Of voxels, then of the harmonics of a volume, then of numbers. */
enum { HARMONIC_NAME = 5, NUMBER_NAME = 14 };
const char *const grid_names[VDB_GRIDS] = { "density", "radiance", "color",  "emission", "normal",
											"sh_0",    "sh_1",     "sh_2",   "sh_3",     "sh_4",
											"sh_5",    "sh_6",     "sh_7",   "sh_8",     "probe_0",
											"probe_1", "probe_2",  "probe_3" };
const char *const point_grid_name = "points";

/* Attributes of a point but for its position: what is lit, then in Houdini's names. */
enum { ATTRIBUTES = 3 };
const char *const attribute_names[ATTRIBUTES] = { "radiance", "Cd", "N" };

__attribute__((format(printf, 3, 4))) gw_status fail(gw_error *error, gw_status status,
													 const char *format, ...)
{
	if (error) {
		va_list arguments;
		va_start(arguments, format);
		error->status = status;
		std::vsnprintf(error->text, sizeof error->text, format, arguments);
		va_end(arguments);
	}
	return status;
}

/* ------------------------------------------------------------------------------ the bytes */

/* FNV-1a, in two lanes that start differently. */
struct fingerprint {
	uint64_t lane[2] = { 0xcbf29ce484222325u, 0x84222325cbf29ce4u };

	void add(const void *bytes, size_t length)
	{
		for (size_t i = 0; i < length; i++)
			for (uint64_t &l : lane)
				l = (l ^ static_cast<const uint8_t *>(bytes)[i]) * 0x100000001b3u;
	}
};

/*
 * Hands bytes to the sink. OpenVDB puts a random UUID into each header; a file of the same content
 * shall have the same bytes, so the UUID is replaced by one made from the content.
 */
struct sink_buffer : std::streambuf {
	sink_buffer(vdb_sink sink, void *user, const std::string &uuid)
		: sink_(sink), user_(user), uuid_(uuid)
	{
	}

	std::streamsize xsputn(const char *bytes, std::streamsize length) override
	{
		std::streamsize done = 0;
		for (; done < length && position_ < UUID_END; done++)
			if (!take_header_byte(bytes[done]))
				return done;
		if (done < length && !sink_(user_, bytes + done, static_cast<size_t>(length - done)))
			return done;
		position_ += length - done;
		return length;
	}

	uint64_t position() const
	{
		return static_cast<uint64_t>(position_);
	}

	int_type overflow(int_type c) override
	{
		char byte = traits_type::to_char_type(c);
		return xsputn(&byte, 1) == 1 ? c : traits_type::eof();
	}

	/* Only tells the position. */
	pos_type seekoff(off_type off, std::ios_base::seekdir way, std::ios_base::openmode) override
	{
		bool tells = off == 0 && way == std::ios_base::cur;
		return tells ? pos_type(position_) : pos_type(off_type(-1));
	}

	/* The header: 8 bytes of magic, three uint32 of versions, one flag, and the UUID as text. */
	static constexpr std::streamoff UUID_START = 21, UUID_END = UUID_START + 36;

	bool take_header_byte(char byte)
	{
		if (position_ >= UUID_START) {
			char ours = uuid_[static_cast<size_t>(position_ - UUID_START)];
			if ((byte == '-') != (ours == '-'))
				throw std::runtime_error("this version of OpenVDB has another header");
			byte = ours;
		}
		position_++;
		return sink_(user_, &byte, 1);
	}

	vdb_sink sink_;
	void *user_;
	std::string uuid_;
	std::streamoff position_ = 0;
};

std::string uuid_of(const gw_voxels &v, const vdb_metadata &m)
{
	fingerprint print;
	print.add(&v.count, sizeof v.count);
	print.add(v.cell, v.count * 3 * sizeof *v.cell);
	bool voxels = !m.volume && !m.numbers;
	if (m.volume)
		print.add(m.volume->radiance,
				  v.count * 3 * m.volume->harmonics * sizeof *m.volume->radiance);
	if (m.numbers)
		print.add(m.numbers->value, v.count * VDB_NUMBERS * sizeof *m.numbers->value);
	if (voxels)
		print.add(v.density, v.count * sizeof *v.density);
	for (const float *values : { v.radiance, v.albedo, v.emission, v.normal })
		if (voxels)
			print.add(values, v.count * 3 * sizeof *values);
	print.add(v.origin, sizeof v.origin);
	print.add(&v.size, sizeof v.size);
	print.add(&m.half, sizeof m.half);
	if (m.points) {
		print.add(m.points->position, m.points->count * 3 * sizeof *m.points->position);
		for (const float *values : { m.points->radiance, m.points->albedo, m.points->normal })
			print.add(values, m.points->count * 3 * sizeof *values);
	}
	for (size_t i = 0; i < m.text_count; i++)
		for (const char *text : { m.text[i].name, m.text[i].value })
			print.add(text, std::strlen(text) + 1);
	uint64_t a = print.lane[0], b = print.lane[1];
	/* Version 8 of RFC 9562 leaves the content to the maker; the variant is 10 in binary. */
	a = (a & ~UINT64_C(0xf000)) | 0x8000;
	b = (b & ~(UINT64_C(3) << 62)) | UINT64_C(2) << 62;
	char text[40];
	std::snprintf(text, sizeof text, "%08llx-%04llx-%04llx-%04llx-%012llx",
				  (unsigned long long)(a >> 32), (unsigned long long)(a >> 16 & 0xffff),
				  (unsigned long long)(a & 0xffff), (unsigned long long)(b >> 48),
				  (unsigned long long)(b & 0xffffffffffff));
	return text;
}

/* ---------------------------------------------------------------------- before the building */

gw_status check(const gw_voxels &v, gw_error *error)
{
	if (v.count == 0)
		return fail(error, GW_ERROR_DATA, "there are no cells to write as grids");
	if (!(v.size > 0.0) || !std::isfinite(v.size))
		return fail(error, GW_ERROR_DATA, "voxels of %g m cannot be written as grids", v.size);
	for (double o : v.origin)
		if (!std::isfinite(o))
			return fail(error, GW_ERROR_DATA, "voxels at %g m cannot be written as grids", o);
	for (size_t i = 0; i < 3 * v.count; i++)
		if (v.cell[i] < -VDB_CELL_LIMIT || v.cell[i] >= VDB_CELL_LIMIT)
			return fail(error, GW_ERROR_DATA,
						"the cell coordinate %d of voxel %zu is out of the range of grids, "
						"+-%d",
						v.cell[i], i / 3, VDB_CELL_LIMIT);
	return GW_OK;
}

/* Bytes of a tree with so many nodes on its three levels. */
template <typename Tree> uint64_t tree_bytes(const uint64_t nodes[3])
{
	using Upper = typename Tree::RootNodeType::ChildNodeType;
	using Lower = typename Upper::ChildNodeType;
	using Leaf = typename Tree::LeafNodeType;
	uint64_t leaf = sizeof(Leaf) + Leaf::SIZE * sizeof(typename Tree::ValueType);
	return nodes[0] * leaf + nodes[1] * sizeof(Lower) + nodes[2] * sizeof(Upper);
}

/* Counts the nodes that cells fall into: leaves of 8^3, inner ones of 128^3 and 4096^3. */
void count_nodes(const int32_t *cells, size_t count, uint64_t nodes[3])
{
	std::vector<uint64_t> key(count);
	for (int level = 0; level < 3; level++) {
		const int shift[3] = { 3, 7, 12 };
		for (size_t i = 0; i < count; i++) {
			key[i] = 0;
			for (int k = 0; k < 3; k++) {
				auto cell = static_cast<uint64_t>(cells[3 * i + k] + VDB_CELL_LIMIT);
				key[i] = key[i] << 21 | cell >> shift[level];
			}
		}
		std::sort(key.begin(), key.end());
		nodes[level] = static_cast<uint64_t>(std::unique(key.begin(), key.end()) - key.begin());
	}
}

gw_status check_memory(const gw_voxels &v, const vdb_metadata &m, gw_error *error)
{
	uint64_t nodes[3], limit = m.memory;
	uint64_t counting = v.count * sizeof(uint64_t);
	if (limit == 0)
		return GW_OK;
	if (counting <= limit) {
		count_nodes(v.cell, v.count, nodes);
		uint64_t bytes = m.volume ? m.volume->harmonics * tree_bytes<openvdb::Vec3STree>(nodes)
								  : tree_bytes<openvdb::FloatTree>(nodes) +
										4 * tree_bytes<openvdb::Vec3STree>(nodes);
		if (bytes <= limit)
			return GW_OK;
		return fail(error, GW_ERROR_MEMORY,
					"the grids of %zu voxels in %llu leaf nodes would take %llu bytes of memory, "
					"%llu for each voxel, and %llu are allowed; ask for larger cells or allow "
					"more memory",
					v.count, (unsigned long long)nodes[0], (unsigned long long)bytes,
					(unsigned long long)(bytes / v.count), (unsigned long long)limit);
	}
	return fail(error, GW_ERROR_MEMORY,
				"counting the nodes of %zu voxels takes %llu bytes of memory, and %llu are allowed",
				v.count, (unsigned long long)counting, (unsigned long long)limit);
}

/* ------------------------------------------------------------------------------ the grids */

struct builder {
	const gw_voxels &voxels;
	const vdb_metadata &metadata;
	openvdb::math::Transform::Ptr transform;
	double origin[3] = { 0, 0, 0 }; /* what the transform leaves out */
	uint64_t clamped = 0;

	builder(const gw_voxels &v, const vdb_metadata &m) : voxels(v), metadata(m)
	{
		bool far = false;
		for (double o : v.origin)
			far = far || std::fabs(o) > VDB_LOCAL_LIMIT;
		openvdb::Vec3d start(0.5 * v.size);
		for (int k = 0; k < 3; k++) {
			if (far)
				origin[k] = v.origin[k];
			else
				start[k] += v.origin[k];
		}
		transform = openvdb::math::Transform::createLinearTransform(v.size);
		transform->postTranslate(start);
	}

	/* The value as it will read back. */
	float stored(float value)
	{
		if (!metadata.half)
			return value;
		if (std::fabs(value) > VDB_HALF_MAX) {
			clamped++;
			value = std::copysign(VDB_HALF_MAX, value);
		}
		return static_cast<float>(openvdb::math::half(value));
	}

	void describe(openvdb::MetaMap &map)
	{
		const char *const names[3] = { "gw_origin_x", "gw_origin_y", "gw_origin_z" };
		for (int k = 0; k < 3; k++)
			map.insertMeta(names[k], openvdb::DoubleMetadata(origin[k]));
	}

	template <typename Grid> typename Grid::Ptr start(const char *name)
	{
		auto grid = Grid::create();
		grid->setName(name);
		grid->setTransform(transform->copy());
		grid->setGridClass(openvdb::GRID_FOG_VOLUME);
		grid->setSaveFloatAsHalf(metadata.half);
		describe(*grid);
		return grid;
	}

	openvdb::Coord cell(size_t i) const
	{
		const int32_t *c = voxels.cell + 3 * i;
		return openvdb::Coord(c[0], c[1], c[2]);
	}

	openvdb::GridBase::Ptr scalars(const char *name, const float *values)
	{
		auto grid = start<openvdb::FloatGrid>(name);
		auto accessor = grid->getAccessor();
		for (size_t i = 0; i < voxels.count; i++)
			accessor.setValueOn(cell(i), stored(values[i]));
		return grid;
	}

	/* Values of a voxel are VDB_NUMBERS from those of the next one. */
	openvdb::GridBase::Ptr numbers(const char *name, const int32_t *values)
	{
		auto grid = openvdb::Int32Grid::create(-1);
		grid->setName(name);
		grid->setTransform(transform->copy());
		describe(*grid);
		auto accessor = grid->getAccessor();
		for (size_t i = 0; i < voxels.count; i++)
			accessor.setValueOn(cell(i), values[VDB_NUMBERS * i]);
		return grid;
	}

	/* Values of a cell are `step` vectors from those of the next one. */
	openvdb::GridBase::Ptr vectors(const char *name, const float *values, size_t step = 1)
	{
		auto grid = start<openvdb::Vec3SGrid>(name);
		auto accessor = grid->getAccessor();
		for (size_t i = 0; i < voxels.count; i++) {
			const float *v = values + 3 * step * i;
			accessor.setValueOn(cell(i), openvdb::Vec3s(stored(v[0]), stored(v[1]), stored(v[2])));
		}
		return grid;
	}
};

/* ------------------------------------------------------------------------------- the points */

/* The points that have a place, as OpenVDB's functions ask for them: in the transform's metres. */
struct placed_points {
	using PosType = openvdb::Vec3d;
	using value_type = openvdb::Vec3d;

	const vdb_points &points;
	const double *origin;
	std::vector<size_t> index;

	placed_points(const vdb_points &p, const double o[3]) : points(p), origin(o)
	{
		for (size_t i = 0; i < p.count; i++) {
			const double *at = p.position + 3 * i;
			if (std::isfinite(at[0]) && std::isfinite(at[1]) && std::isfinite(at[2]))
				index.push_back(i);
		}
	}

	size_t size() const
	{
		return index.size();
	}

	void getPos(size_t n, openvdb::Vec3d &at) const
	{
		const double *from = points.position + 3 * index[n];
		at = openvdb::Vec3d(from[0] - origin[0], from[1] - origin[1], from[2] - origin[2]);
	}

	/* For positions as an attribute. */
	template <typename T> void get(T &at, openvdb::Index n, openvdb::Index = 0) const
	{
		openvdb::Vec3d place;
		getPos(n, place);
		at = T(place);
	}
};

/* One attribute of those points. */
struct placed_values {
	using ValueType = openvdb::Vec3s;
	using value_type = openvdb::Vec3s;

	const float *values;
	const std::vector<size_t> &index;

	template <typename T> void get(T &value, openvdb::Index n, openvdb::Index = 0) const
	{
		const float *from = values + 3 * index[n];
		value = T(from[0], from[1], from[2]);
	}
};

using openvdb::points::PointDataGrid;
using openvdb::points::PointDataTree;
using openvdb::tools::PointIndexGrid;
using openvdb::tools::PointIndexTree;

/* Bytes that building the point grid takes: the tree and that of the indices, an attribute array
 * with its own heap block in every leaf, and the values. */
uint64_t point_bytes(const uint64_t nodes[3], uint64_t count)
{
	const uint64_t array = 2 * sizeof(openvdb::points::TypedAttributeArray<openvdb::Vec3s>);
	uint64_t values = (ATTRIBUTES + 1) * sizeof(openvdb::Vec3s);
	/* The list of points, their cells and keys while they are sorted, and two orders. */
	uint64_t sorting = sizeof(size_t) + 3 * sizeof(int32_t) + 4 * sizeof(uint64_t);
	return tree_bytes<PointDataTree>(nodes) + tree_bytes<PointIndexTree>(nodes) +
		   nodes[0] * (ATTRIBUTES + 1) * array + count * (values + sorting);
}

gw_status check_points(const placed_points &p, const openvdb::math::Transform &transform,
					   uint64_t limit, gw_error *error)
{
	if (p.size() == 0 || p.size() > UINT32_MAX)
		return fail(error, GW_ERROR_DATA, "%zu points cannot be written as a point grid", p.size());
	uint64_t counting = p.size() * (3 * sizeof(int32_t) + sizeof(uint64_t));
	if (limit != 0 && counting > limit)
		return fail(error, GW_ERROR_MEMORY,
					"counting the nodes of %zu points takes %llu bytes of memory, and %llu are "
					"allowed",
					p.size(), (unsigned long long)counting, (unsigned long long)limit);
	std::vector<int32_t> cells(3 * p.size());
	for (size_t i = 0; i < p.size(); i++) {
		openvdb::Vec3d at;
		p.getPos(i, at);
		at = transform.worldToIndex(at);
		for (int k = 0; k < 3; k++) {
			if (!(std::fabs(at[k]) < VDB_CELL_LIMIT - 1))
				return fail(error, GW_ERROR_DATA,
							"point %zu lies %g voxels from the grids' origin, and %d is the limit",
							p.index[i], std::fabs(at[k]), VDB_CELL_LIMIT);
			cells[3 * i + static_cast<size_t>(k)] = static_cast<int32_t>(std::lround(at[k]));
		}
	}
	uint64_t nodes[3];
	count_nodes(cells.data(), p.size(), nodes);
	uint64_t bytes = point_bytes(nodes, p.size());
	if (limit == 0 || bytes <= limit)
		return GW_OK;
	return fail(error, GW_ERROR_MEMORY,
				"the point grid of %zu points in %llu leaf nodes would take %llu bytes of memory, "
				"and %llu are allowed; leave it out or allow more memory",
				p.size(), (unsigned long long)nodes[0], (unsigned long long)bytes,
				(unsigned long long)limit);
}

/* On one thread, so that the points of a voxel keep their order. */
openvdb::GridBase::Ptr build_points(builder &build, const placed_points &p)
{
	PointDataGrid::Ptr grid;
	tbb::task_arena(1).execute([&] {
		auto &transform = *build.transform;
		auto index = openvdb::tools::createPointIndexGrid<PointIndexGrid>(p, transform);
		grid = openvdb::points::createPointDataGrid<openvdb::points::NullCodec, PointDataGrid>(
			*index, p, transform);
		const float *const values[ATTRIBUTES] = { p.points.radiance, p.points.albedo,
												  p.points.normal };
		for (int a = 0; a < ATTRIBUTES; a++) {
			openvdb::points::appendAttribute<openvdb::Vec3s>(grid->tree(), attribute_names[a]);
			openvdb::points::populateAttribute(grid->tree(), index->tree(), attribute_names[a],
											   placed_values{ values[a], p.index });
		}
	});
	grid->setName(point_grid_name);
	build.describe(*grid);
	return grid;
}

/* Sums up a point grid; an attribute that is missing or of another type makes it empty. */
void digest_points(const PointDataGrid &grid, vdb_digest &digest)
{
	using handle = openvdb::points::AttributeHandle<openvdb::Vec3s>;
	for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf) {
		const char *const names[ATTRIBUTES + 1] = { "P", attribute_names[0], attribute_names[1],
													attribute_names[2] };
		std::vector<handle> handles;
		for (const char *name : names) {
			if (!leaf->hasAttribute(name) ||
				!leaf->constAttributeArray(name).hasValueType<openvdb::Vec3s>())
				return;
			handles.emplace_back(leaf->constAttributeArray(name));
		}
		for (auto i = leaf->beginIndexOn(); i; ++i) {
			openvdb::Coord cell = i.getCoord();
			fingerprint print;
			print.add(cell.data(), 3 * sizeof(int32_t));
			for (const handle &h : handles) {
				openvdb::Vec3s value = h.get(*i);
				print.add(value.asPointer(), sizeof value);
			}
			digest.points++;
			digest.point_values += print.lane[0] ^ print.lane[0] >> 29;
		}
	}
}

/* Sums up what one grid holds. */
template <typename Grid> void digest_values(const Grid &grid, uint64_t &voxels, uint64_t &values)
{
	for (auto i = grid.cbeginValueOn(); i; ++i) {
		openvdb::Vec3d place = grid.indexToWorld(i.getCoord());
		auto value = *i;
		fingerprint print;
		print.add(place.asPointer(), 3 * sizeof(double));
		print.add(&value, sizeof value);
		voxels++;
		values += print.lane[0] ^ print.lane[0] >> 29;
	}
}

/* Sums up all grids, by name. A grid that is missing or of another type counts as empty. */
vdb_digest digest_grids(const openvdb::GridPtrVec &grids)
{
	vdb_digest digest = {};
	for (int g = 0; g < VDB_GRIDS; g++) {
		for (const auto &grid : grids) {
			if (grid->getName() != grid_names[g])
				continue;
			if (auto scalar = openvdb::gridPtrCast<openvdb::FloatGrid>(grid))
				digest_values(*scalar, digest.voxels[g], digest.values[g]);
			else if (auto vector = openvdb::gridPtrCast<openvdb::Vec3SGrid>(grid))
				digest_values(*vector, digest.voxels[g], digest.values[g]);
			else if (auto number = openvdb::gridPtrCast<openvdb::Int32Grid>(grid))
				digest_values(*number, digest.voxels[g], digest.values[g]);
		}
	}
	for (const auto &grid : grids)
		if (auto points = openvdb::gridPtrCast<PointDataGrid>(grid))
			digest_points(*points, digest);
	return digest;
}

openvdb::GridPtrVec voxel_grids(builder &build)
{
	const gw_voxels &v = build.voxels;
	return { build.scalars(grid_names[0], v.density), build.vectors(grid_names[1], v.radiance),
			 build.vectors(grid_names[2], v.albedo), build.vectors(grid_names[3], v.emission),
			 build.vectors(grid_names[4], v.normal) };
}

openvdb::GridPtrVec harmonic_grids(builder &build)
{
	const gw_volume &volume = *build.metadata.volume;
	openvdb::GridPtrVec grids;
	for (uint32_t j = 0; j < volume.harmonics; j++)
		grids.push_back(build.vectors(grid_names[HARMONIC_NAME + j], volume.radiance + 3 * j,
									  volume.harmonics));
	return grids;
}

/* The cells of a volume, as voxels that have nothing else. */
gw_voxels cells_of(const gw_volume &volume)
{
	gw_voxels cells = {};
	cells.count = volume.count;
	cells.cell = volume.cell;
	cells.size = volume.size;
	std::copy(volume.origin, volume.origin + 3, cells.origin);
	return cells;
}

openvdb::GridPtrVec number_grids(builder &build)
{
	openvdb::GridPtrVec grids;
	for (size_t j = 0; j < VDB_NUMBERS; j++)
		grids.push_back(
			build.numbers(grid_names[NUMBER_NAME + j], build.metadata.numbers->value + j));
	return grids;
}

gw_status encode(const gw_voxels &v, const vdb_metadata &m, vdb_sink sink, void *user,
				 vdb_digest *digest, gw_error *error)
{
	GW_TRY(check(v, error));
	GW_TRY(check_memory(v, m, error));

	openvdb::initialize();
	builder build(v, m);
	std::unique_ptr<placed_points> points;
	if (m.points) {
		points = std::make_unique<placed_points>(*m.points, build.origin);
		GW_TRY(check_points(*points, *build.transform, m.memory, error));
	}
	openvdb::GridPtrVec grids = m.volume    ? harmonic_grids(build)
								: m.numbers ? number_grids(build)
											: voxel_grids(build);
	if (points)
		grids.push_back(build_points(build, *points));
	openvdb::MetaMap file;
	build.describe(file);
	for (size_t i = 0; i < m.text_count; i++)
		file.insertMeta(m.text[i].name, openvdb::StringMetadata(m.text[i].value));

	sink_buffer buffer(sink, user, uuid_of(v, m));
	std::ostream stream(&buffer);
	stream.exceptions(std::ios::badbit | std::ios::failbit);
	openvdb::io::Stream(stream).write(grids, file);
	*digest = digest_grids(grids);
	digest->bytes = buffer.position();
	if (m.clamped)
		*m.clamped = build.clamped;
	return GW_OK;
}

gw_status verify(const char *path, const vdb_digest &meant, gw_error *error)
{
	openvdb::initialize();
	/* OpenVDB believes lengths that it could not read, and leaks when it is stopped half way. So
	 * the length is checked first, and the stream throws at its end. */
	std::ifstream file(path, std::ios::binary | std::ios::ate);
	std::streamoff bytes = file.tellg();
	if (bytes < 0 || static_cast<uint64_t>(bytes) != meant.bytes)
		return fail(error, FILE_ERROR_IO, "the file has %lld bytes instead of %llu",
					(long long)bytes, (unsigned long long)meant.bytes);
	file.seekg(0);
	file.exceptions(std::ios::badbit | std::ios::failbit | std::ios::eofbit);
	openvdb::io::Stream stream(file, false);
	vdb_digest found = digest_grids(*stream.getGrids());
	for (int g = 0; g < VDB_GRIDS; g++) {
		if (found.voxels[g] != meant.voxels[g])
			return fail(error, FILE_ERROR_IO,
						"the grid '%s' reads back with %llu voxels instead of %llu", grid_names[g],
						(unsigned long long)found.voxels[g], (unsigned long long)meant.voxels[g]);
		if (found.values[g] != meant.values[g])
			return fail(error, FILE_ERROR_IO, "the grid '%s' reads back with other values",
						grid_names[g]);
	}
	if (found.points != meant.points || found.point_values != meant.point_values)
		return fail(error, FILE_ERROR_IO,
					"the point grid reads back with %llu points instead of %llu, or with other "
					"values",
					(unsigned long long)found.points, (unsigned long long)meant.points);
	return GW_OK;
}

/* Runs work and turns whatever it throws into an error. */
template <typename Work> gw_status guarded(const char *what, gw_error *error, Work work) noexcept
{
	try {
		return work();
	} catch (const std::bad_alloc &) {
		return fail(error, GW_ERROR_MEMORY, "no memory to %s the grids", what);
	} catch (const std::exception &e) {
		/* TBB has no type for it. */
		if (std::strstr(e.what(), "pthread_create"))
			return fail(error, GW_ERROR_MEMORY, "no thread to %s the grids: %s", what, e.what());
		return fail(error, FILE_ERROR_IO, "cannot %s the grids: %s", what, e.what());
	} catch (...) {
		return fail(error, GW_ERROR_INTERNAL, "cannot %s the grids", what);
	}
}

} // namespace

extern "C" gw_status vdb_encode(const gw_voxels *voxels, const vdb_metadata *metadata,
								vdb_sink sink, void *user, vdb_digest *digest, gw_error *error)
{
	return guarded("write", error, [&] {
		return metadata->volume
				   ? encode(cells_of(*metadata->volume), *metadata, sink, user, digest, error)
				   : encode(*voxels, *metadata, sink, user, digest, error);
	});
}

extern "C" gw_status vdb_verify(const char *path, const vdb_digest *digest, gw_error *error)
{
	return guarded("read back", error, [&] { return verify(path, *digest, error); });
}
