/*
 * COPC files that are written: every point in one node, in whose cube it lies, of a tree that the
 * table of nodes describes; the root a thinned cloud of all; columns as by way of LAS.
 */
#include "las/copc_tree.h"
#include "las/las_format.h"
#include "las/las_header.h"
#include "las/las_notes.h"
#include "laz_clouds.h"
#include "files/little_endian.h"
#include "table/format_table.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

enum { INFO = LAS_HEADER_BYTES_1_4 + LAS_VLR_BYTES, ENTRY = 32 };

static char las_path[64], copc_path[64];

static int make_paths(void **state)
{
	(void)state;
	snprintf(las_path, sizeof las_path, "/tmp/glowworm-copc-%ld.las", (long)getpid());
	snprintf(copc_path, sizeof copc_path, "/tmp/glowworm-%ld.copc.laz", (long)getpid());
	return 0;
}

static int remove_paths(void **state)
{
	(void)state;
	unlink(las_path);
	unlink(copc_path);
	return 0;
}

static double id_of(size_t i)
{
	return (double)i;
}

/* Every point is there once, with its values. */
static void same_points(const scan *plain, const scan *nodes)
{
	const scan_column *id = scan_find(nodes, "id");
	assert_int_equal(plain->count, nodes->count);
	assert_int_equal(plain->column_count, nodes->column_count);
	bool *seen = calloc(plain->count + 1, sizeof *seen);
	for (size_t i = 0; i < nodes->count; i++) {
		size_t row = (size_t)scan_value(id, i);
		assert_true(row < plain->count && !seen[row]);
		seen[row] = true;
	}
	free(seen);
	for (size_t c = 0; c < plain->column_count; c++) {
		const scan_column *one = &plain->column[c], *other = scan_find(nodes, one->name);
		assert_non_null(other);
		size_t size = scan_type_size(one->type);
		assert_int_equal(one->type, other->type);
		for (size_t i = 0; i < nodes->count; i++) {
			size_t row = (size_t)scan_value(id, i);
			if (memcmp((const char *)one->data + row * size, (const char *)other->data + i * size,
					   size) != 0)
				fail_msg("%s of point %zu differs", one->name, row);
		}
	}
}

/* An entry of the table of nodes. */
typedef struct node {
	int32_t key[4];
	uint64_t place;
	int32_t length, count;
} node;

static node take_node(const uint8_t *entry)
{
	node n = { .place = load_64(entry + 16),
			   .length = (int32_t)load_32(entry + 24),
			   .count = (int32_t)load_32(entry + 28) };
	for (int k = 0; k < 4; k++)
		n.key[k] = (int32_t)load_32(entry + 4 * k);
	return n;
}

/* A node of a level above 0 has a parent in the table. */
static bool has_parent(const uint8_t *page, size_t nodes, const node *child)
{
	for (size_t n = 0; n < nodes; n++) {
		node parent = take_node(page + n * ENTRY);
		bool same = parent.key[0] == child->key[0] - 1;
		for (int k = 1; k < 4; k++)
			same = same && parent.key[k] == child->key[k] >> 1;
		if (same)
			return true;
	}
	return child->key[0] == 0;
}

/* Points [first, first + count) lie in the node's cube. */
static void lie_within(const scan *cloud, size_t first, const node *n, const uint8_t *info)
{
	static const char *const axes[3] = { "x", "y", "z" };
	double side = 2.0 * load_double(info + 24) / (1 << n->key[0]);
	for (size_t k = 0; k < 3; k++) {
		const scan_column *column = scan_find(cloud, axes[k]);
		double low = load_double(info + 8 * k) - load_double(info + 24) + side * n->key[1 + k];
		/* Some roundings of the largest coordinate, 2e6, and of the cube's side. */
		for (size_t i = first; i < first + (size_t)n->count; i++)
			if (!(scan_value(column, i) >= low - 1e-8 &&
				  scan_value(column, i) <= low + side + 1e-8))
				fail_msg("point %zu, %s %.17g, is not in node %d-%d-%d-%d", i, axes[k],
						 scan_value(column, i), n->key[0], n->key[1], n->key[2], n->key[3]);
	}
}

/* Looks at header, tree and table of nodes. Returns how many nodes there are. */
static size_t is_a_tree(const scan *cloud)
{
	size_t length;
	uint8_t *file = load_bytes(copc_path, &length);
	const uint8_t *info = file + INFO;
	uint64_t page = load_64(info + 40), bytes = load_64(info + 48);
	assert_in_range(file[104], 0x86, 0x88);
	assert_true(load_16(file + 6) & 16);
	assert_memory_equal(file + LAS_HEADER_BYTES_1_4 + 2, "copc", 5);
	assert_int_equal(load_32(file + 243), 1);
	assert_int_equal(load_64(file + 235), page - 60);
	assert_int_equal(page + bytes, length);
	size_t nodes = bytes / ENTRY, first = 0;
	uint64_t at = load_32(file + 96) + 8;
	for (size_t n = 0; n < nodes && cloud->count > 0; n++) {
		node one = take_node(file + page + n * ENTRY);
		assert_int_equal(one.place, at);
		assert_true(one.count > 0 && has_parent(file + page, n, &one));
		lie_within(cloud, first, &one, info);
		first += (size_t)one.count;
		at += (uint64_t)one.length;
	}
	assert_int_equal(first, cloud->count);
	assert_int_equal(load_64(file + load_32(file + 96)), at);
	free(file);
	return nodes;
}

/* Writes a cloud both ways and compares. Returns how many nodes there are. */
static size_t good_as_copc(scan *cloud)
{
	add_values(cloud, "id", SCAN_UINT32, id_of);
	write_cloud(&las_format, las_path, cloud);
	write_cloud(&copc_format, copc_path, cloud);
	scan plain = read_cloud(las_path), nodes = read_cloud(copc_path);
	same_points(&plain, &nodes);
	size_t count = is_a_tree(&nodes);
	scan_clear(&plain);
	scan_clear(&nodes);
	scan_clear(cloud);
	return count;
}

static double nowhere(size_t i)
{
	(void)i;
	return 3.25;
}

static double far_stray(size_t i)
{
	return i == 7 ? 2e6 : round(1e5 * hashed(i, 1)) / 1e4;
}

static void clouds_of_all_sizes(void **state)
{
	(void)state;
	static const size_t counts[] = { 0, 1, 2, 100000, 100001, 300000 };
	size_t nodes[6];
	for (size_t c = 0; c < 6; c++) {
		scan cloud = make_cloud(counts[c], false);
		nodes[c] = good_as_copc(&cloud);
	}
	assert_int_equal(nodes[0], 1);
	assert_int_equal(nodes[3], 1);
	assert_true(nodes[5] > 4);
}

static void points_that_lie_together(void **state)
{
	(void)state;
	scan same = { .count = 120000 }, stray = { .count = 120000 };
	static const char *const axes[3] = { "x", "y", "z" };
	for (int k = 0; k < 3; k++) {
		add_values(&same, axes[k], SCAN_FLOAT64, nowhere);
		add_values(&stray, axes[k], SCAN_FLOAT64, far_stray);
	}
	assert_true(good_as_copc(&same) > 0);
	assert_true(good_as_copc(&stray) > 2);
}

/* Formats 6 to 8, also of points that came from an older one. */
static void every_format_and_type(void **state)
{
	(void)state;
	for (int wild = 0; wild < 2; wild++)
		for (int kind = 0; kind < 3; kind++) {
			scan cloud = make_cloud(3000, wild);
			add_pulses(&cloud, wild);
			if (kind > 0)
				add_colors(&cloud);
			if (kind > 1)
				add_infrared(&cloud);
			add_extra(&cloud);
			assert_int_equal(good_as_copc(&cloud), 1);
		}
	scan cloud = make_cloud(3000, false);
	add_rank(&cloud);
	write_cloud(&copc_format, copc_path, &cloud);
	scan nodes = read_cloud(copc_path);
	assert_int_equal(is_a_tree(&nodes), 1);
	assert_non_null(scan_find(&nodes, "scan_angle_rank"));
	scan_clear(&nodes);
	scan_clear(&cloud);
}

/* The root alone shows the whole cloud: from end to end, and no two points in one cell of 128 along
 * its side but for the few of children that are too small. */
static void root_is_thinned(void **state)
{
	(void)state;
	gw_error error = { 0 };
	scan cloud = { .count = 200000 };
	static const char *const axes[3] = { "x", "y", "z" };
	for (int k = 0; k < 3; k++) {
		add_values(&cloud, axes[k], SCAN_FLOAT64, nowhere);
		for (size_t i = 0; i < cloud.count; i++)
			scan_store(&cloud.column[k], i,
					   k < 2 ? floor(1e4 * hashed(i, (uint64_t)k)) / 1e3 : 0.0);
	}
	las_records records;
	copc_tree tree;
	assert_int_equal(las_records_make(&records, &cloud, "cloud", true, &error), GW_OK);
	assert_int_equal(copc_tree_make(&tree, &records, &error), GW_OK);
	/* 200000 points in 128 x 128 cells leave e^-12 of them empty. */
	assert_int_equal(tree.node[0].count, 128 * 128);
	assert_true(tree.spacing == 2.0 * tree.half_size / 128.0);
	size_t cells[128][128] = { 0 };
	for (size_t i = 0; i < tree.node[0].count; i++) {
		size_t row = tree.order[i], cell[2];
		for (size_t k = 0; k < 2; k++) {
			double from = scan_value(&cloud.column[k], row) - tree.center[k] + tree.half_size;
			cell[k] = (size_t)fmin(from / tree.spacing, 127.0);
		}
		assert_int_equal(cells[cell[0]][cell[1]]++, 0);
	}
	copc_tree_clear(&tree);
	las_records_clear(&records);
	scan_clear(&cloud);
}

static double axis_of(size_t i, size_t k)
{
	return (double)(i >> 5 * k & 31);
}

/* The points of a grid of 32 along each axis, in one node. */
static void order_grid(scan *cloud, copc_tree *tree)
{
	static const char *const axes[3] = { "x", "y", "z" };
	gw_error error = { 0 };
	las_records records;
	for (size_t k = 0; k < 3; k++) {
		add_values(cloud, axes[k], SCAN_FLOAT64, nowhere);
		for (size_t i = 0; i < cloud->count; i++)
			scan_store(&cloud->column[cloud->column_count - 1], i, axis_of(i, k));
	}
	assert_int_equal(las_records_make(&records, cloud, "cloud", true, &error), GW_OK);
	assert_int_equal(copc_tree_make(tree, &records, &error), GW_OK);
	assert_int_equal(tree->node_count, 1);
	las_records_clear(&records);
}

/* Points follow the Hilbert curve, which goes from cube to cube through a side that both share. */
static void neighbours_follow(void **state)
{
	(void)state;
	scan cloud = { .count = 32768 };
	copc_tree tree;
	order_grid(&cloud, &tree);
	for (size_t i = 1; i < cloud.count; i++) {
		double steps = 0.0;
		for (size_t k = 0; k < 3; k++)
			steps += fabs(axis_of(tree.order[i], k) - axis_of(tree.order[i - 1], k));
		assert_true(steps == 1.0);
	}
	copc_tree_clear(&tree);
	scan_clear(&cloud);
}

static double luminance_of(size_t i)
{
	return i % 1000 == 7 ? (double)NAN : hashed(i, 5);
}

/* Those of a run of 32 are sorted by luminance where there is one, up and down in turn: so that two
 * runs meet where both are bright, or both dark. What is no number stays where it is. */
static void brightness_changes_little(void **state)
{
	(void)state;
	scan cloud = { .count = 32768 };
	copc_tree tree, plain;
	add_values(&cloud, "quality", SCAN_FLOAT32, luminance_of);
	order_grid(&cloud, &tree);
	for (size_t i = 1; i < cloud.count; i++) {
		double before = luminance_of(tree.order[i - 1]), own = luminance_of(tree.order[i]);
		if (i % 32 != 0 && isfinite(before) && isfinite(own))
			assert_true(i / 32 % 2 ? own <= before : own >= before);
	}
	scan bare = { .count = 32768 };
	order_grid(&bare, &plain);
	bool *seen = calloc(cloud.count, sizeof *seen);
	for (size_t i = 0; i < cloud.count; i++) {
		seen[plain.order[i]] = true;
		if (i % 32 == 31)
			for (size_t k = i - 31; k <= i; k++)
				assert_true(seen[tree.order[k]]);
	}
	free(seen);
	copc_tree_clear(&tree);
	copc_tree_clear(&plain);
	scan_clear(&cloud);
	scan_clear(&bare);
}

static void any_number_of_threads(void **state)
{
	(void)state;
	scan cloud = make_cloud(100000, false);
	same_by_one_processor(&copc_format, copc_path, &cloud);
	scan_clear(&cloud);
}

static double no_class(size_t i)
{
	return (double)(i % 32);
}

/* Class 18 is noise in new formats, and in those that came from an old one as little as there. */
static void noise_of_old_formats(void **state)
{
	(void)state;
	const unsigned low = LAS_LOW_NOISE, both = LAS_LOW_NOISE | LAS_HIGH_NOISE;
	scan cloud = make_cloud(64, false);
	add_values(&cloud, "classification", SCAN_UINT8, no_class);
	write_cloud(&las_format, las_path, &cloud);
	scan read = read_cloud(las_path);
	assert_int_equal(read.noise_classes, both);
	scan_clear(&read);
	add_rank(&cloud);
	write_cloud(&las_format, las_path, &cloud);
	read = read_cloud(las_path);
	assert_int_equal(read.noise_classes, low);
	write_cloud(&copc_format, copc_path, &read);
	scan_clear(&read);
	read = read_cloud(copc_path);
	assert_int_equal(read.noise_classes, low);
	assert_non_null(scan_find(&read, "overlap"));
	scan_clear(&read);
	scan_clear(&cloud);
}

static void names_and_contents(void **state)
{
	(void)state;
	assert_ptr_equal(format_by_path("a/b.copc.laz"), &copc_format);
	assert_ptr_equal(format_by_path("B.COPC.LAZ"), &copc_format);
	assert_ptr_equal(format_by_path("a.copc/b.laz"), &laz_format);
	assert_ptr_equal(format_by_path("copc.laz"), &laz_format);
	assert_null(format_by_path("a.laz/b"));
	assert_string_equal(format_extension("x/lit.copc.laz"), ".copc.laz");
	assert_string_equal(format_extension("x.y/lit"), "");
	assert_string_equal(format_extension("lit.old.ply"), ".ply");
	assert_string_equal(format_extension("lit.new"), ".new");
	scan cloud = make_cloud(10, false), read;
	const format *found;
	gw_error error;
	write_cloud(&copc_format, copc_path, &cloud);
	assert_int_equal(format_read_with(copc_path, NULL, &read, &found, &error), GW_OK);
	assert_ptr_equal(found, &copc_format);
	scan_clear(&read);
	scan_clear(&cloud);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(clouds_of_all_sizes),   cmocka_unit_test(points_that_lie_together),
		cmocka_unit_test(every_format_and_type), cmocka_unit_test(root_is_thinned),
		cmocka_unit_test(neighbours_follow),     cmocka_unit_test(brightness_changes_little),
		cmocka_unit_test(any_number_of_threads), cmocka_unit_test(names_and_contents),
		cmocka_unit_test(noise_of_old_formats),
	};
	return cmocka_run_group_tests(tests, make_paths, remove_paths);
}
