/* What rows and columns of simulated scans tell: normals, ranges without noise, and nothing where
 * they are no picture. */
#include "simulated_scan.h"
#include "cloud/range_image.h"
#include "random_numbers.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* All stations of a scene as points. */
typedef struct scanned {
	mesh_scene scene;
	cell_kind *kind;
	gw_points points;
	double *position, *surface;
	uint32_t *cell, *triangle;
	gw_range_image image[MESH_STATIONS];
} scanned;

static void add_station(scanned *s, const scan_setup *setup, const station_scan *from)
{
	gw_range_image *image = &s->image[s->points.image_count++];
	*image = (gw_range_image){ .first = s->points.count,
							   .columns = (uint32_t)from->columns,
							   .rows = (uint32_t)from->rows };
	memcpy(image->scanner, from->own, sizeof image->scanner);
	for (size_t c = 0; c < from->columns * from->rows; c++) {
		size_t i = s->points.count;
		double own[3];
		if (from->cell[c].kind == CELL_EMPTY)
			continue;
		station_scan_direction(from, setup, c / from->rows, c % from->rows, own);
		for (size_t k = 0; k < 3; k++)
			own[k] *= from->cell[c].range;
		station_scan_to_world(from, own, s->position + 3 * i);
		memcpy(s->surface + 3 * i, from->cell[c].surface, 3 * sizeof *s->surface);
		s->triangle[i] = from->cell[c].triangle;
		s->kind[i] = from->cell[c].kind;
		s->cell[i] = (uint32_t)(c % from->rows * from->columns + c / from->rows);
		s->points.count++;
		image->count++;
	}
}

static scanned scan_scene(mesh_kind kind, const scan_setup *setup)
{
	scanned s = { .points = { .count = 0 } };
	simulated_scan scan;
	gw_error error = { 0 };
	if (mesh_scene_make(kind, &s.scene, &error) != GW_OK ||
		simulated_scan_make(&s.scene, setup, &scan, &error) != GW_OK)
		fail_msg("%s", error.text);
	s.position = calloc(scan.count, 3 * sizeof *s.position);
	s.surface = calloc(scan.count, 3 * sizeof *s.surface);
	s.cell = calloc(scan.count, sizeof *s.cell);
	s.triangle = calloc(scan.count, sizeof *s.triangle);
	s.kind = calloc(scan.count, sizeof *s.kind);
	assert_true(s.position && s.surface && s.cell && s.triangle && s.kind);
	for (size_t i = 0; i < scan.station_count; i++)
		add_station(&s, setup, &scan.station[i]);
	s.points.position = s.position;
	s.points.image_cell = s.cell;
	simulated_scan_clear(&scan);
	return s;
}

static void clear(scanned *s)
{
	mesh_scene_clear(&s->scene);
	free(s->position);
	free(s->surface);
	free(s->cell);
	free(s->triangle);
	free(s->kind);
}

/* The RMS distance of points from the planes of their triangles, without the worst hundredth, which
 * lies at edges. */
static int by_size(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

static double height_of_points(const scanned *s, const double *position)
{
	size_t n = s->points.count, kept = n - n / 100;
	double *height = calloc(n, sizeof *height), sum = 0.0;
	assert_non_null(height);
	for (size_t i = 0; i < n; i++) {
		const mesh_triangle *t = &s->scene.triangle[s->triangle[i]];
		for (size_t k = 0; k < 3; k++)
			height[i] += (position[3 * i + k] - t->corner[0][k]) * t->normal[k];
		height[i] = fabs(height[i]);
	}
	qsort(height, n, sizeof *height, by_size);
	for (size_t i = 0; i < kept; i++)
		sum += height[i] * height[i];
	free(height);
	return sqrt(sum / (double)kept);
}

/* Share of all points that have a normal within some degrees of the true one. */
static double share_of_normals(const scanned *s, const float *normal, double degrees)
{
	size_t good = 0;
	double least = cos(degrees * 3.14159265358979323846 / 180.0);
	for (size_t i = 0; i < s->points.count; i++) {
		double cosine = 0.0;
		for (size_t k = 0; k < 3; k++)
			cosine += (double)normal[3 * i + k] * s->scene.triangle[s->triangle[i]].normal[k];
		good += cosine > least;
	}
	return (double)good / (double)s->points.count;
}

static gw_ranged_points use(const gw_points *points, uint32_t threads)
{
	gw_ranged_points ranged;
	gw_error error = { 0 };
	const gw_surfels_options options = { .threads = threads };
	if (gw_range_images_use(points, &options, &ranged, &error) != GW_OK)
		fail_msg("%s", error.text);
	return ranged;
}

/* Noise of 3 mm: windows of nine cells or more leave a third of it, those at edges more. */
static void noise_is_smoothed(void **state)
{
	(void)state;
	const scan_setup setup = { .count = 40000, .seed = 2, .faults = { .range_noise = 0.003 } };
	scanned s = scan_scene(MESH_ROOMS, &setup);
	s.points.image = s.image;
	gw_ranged_points ranged = use(&s.points, 1), again = use(&s.points, 3);
	double before = height_of_points(&s, s.position), after = height_of_points(&s, ranged.position);
	double normals = share_of_normals(&s, ranged.normal, 5.0);
	print_message("heights %.2f mm, smoothed %.2f mm; %.2f %% of normals within 5 degrees\n",
				  1e3 * before, 1e3 * after, 100.0 * normals);
	assert_true(after < 0.5 * before);
	/* Points within a cell of one of the edges, whose windows are small, are 5 %. */
	assert_true(normals > 0.93);
	assert_memory_equal(ranged.position, again.position, 3 * s.points.count * sizeof(double));
	assert_memory_equal(ranged.normal, again.normal, 3 * s.points.count * sizeof(float));
	gw_ranged_points_clear(&ranged);
	gw_ranged_points_clear(&again);
	clear(&s);
}

/* Without noise points stay where they are, and normals are those of the planes. */
static void clean_points_stay(void **state)
{
	(void)state;
	const scan_setup setup = { .count = 20000, .seed = 2 };
	scanned s = scan_scene(MESH_ROOMS, &setup);
	s.points.image = s.image;
	gw_ranged_points ranged = use(&s.points, 0);
	assert_memory_equal(ranged.position, s.position, 3 * s.points.count * sizeof(double));
	assert_true(share_of_normals(&s, ranged.normal, 0.5) > 0.95);
	gw_ranged_points_clear(&ranged);
	clear(&s);
}

/* A camera's steps of 3 mm at 1 m, which are 12 mm at 2 m, as wide as the cells: no stairs. */
static void steps_are_no_stairs(void **state)
{
	(void)state;
	const scan_setup setup = {
		.count = 40000, .camera = true, .seed = 2, .faults = { .step = 0.003 }
	};
	scanned s = scan_scene(MESH_CARTON, &setup);
	s.points.image = s.image;
	gw_ranged_points ranged = use(&s.points, 0);
	double before = height_of_points(&s, s.position), after = height_of_points(&s, ranged.position);
	double normals = share_of_normals(&s, ranged.normal, 5.0);
	print_message("heights %.2f mm, smoothed %.2f mm; %.2f %% of normals within 5 degrees\n",
				  1e3 * before, 1e3 * after, 100.0 * normals);
	assert_true(after < 0.5 * before);
	assert_true(normals > 0.9);
	gw_ranged_points_clear(&ranged);
	clear(&s);
}

/* Share of neighbours in a row, on one triangle, of which one stands out before the other by more
 * than they are apart on that: such steps shade each other. */
static double share_of_steps(const scanned *s, const double *position)
{
	size_t pairs = 0, steps = 0;
	for (size_t i = 0; i < s->points.count; i++)
		for (size_t j = i + 1; j < s->points.count && j < i + 1000; j++) {
			double height = 0.0, apart = 0.0;
			const mesh_triangle *t = &s->scene.triangle[s->triangle[i]];
			if (s->cell[j] != s->cell[i] + s->image[0].columns || s->triangle[j] != s->triangle[i])
				continue;
			for (size_t k = 0; k < 3; k++) {
				height += (position[3 * i + k] - position[3 * j + k]) * t->normal[k];
				apart += pow(s->surface[3 * i + k] - s->surface[3 * j + k], 2.0);
			}
			steps += fabs(height) > 0.5 * sqrt(apart);
			pairs++;
		}
	assert_true(pairs > 10000);
	return (double)steps / (double)pairs;
}

/* Steps four times as wide as the cells, flickering: where a large window ends and a small one
 * begins, the planes of these two would be such a step again. */
static void windows_leave_no_steps(void **state)
{
	(void)state;
	const scan_setup setup = {
		.count = 60000, .camera = true, .seed = 2, .faults = { .step = 0.01, .range_noise = 0.01 }
	};
	scanned s = scan_scene(MESH_CARTON, &setup);
	s.points.image = s.image;
	gw_ranged_points ranged = use(&s.points, 0);
	double before = share_of_steps(&s, s.position), after = share_of_steps(&s, ranged.position);
	print_message("%.2f %% of neighbours are steps, smoothed %.3f %%\n", 100.0 * before,
				  100.0 * after);
	assert_true(before > 0.3);
	assert_true(after < 0.006); /* without means of planes it is 0.014 */
	gw_ranged_points_clear(&ranged);
	clear(&s);
}

/* A camera that matches patterns before a slanted wall 4 to 5 m off: disparities in steps that are
 * 5 to 8 cm there, and flicker by patches of 4 x 4 cells. Share of normals within 5 degrees. */
static double share_of_wall(double flicker)
{
	enum { COLUMNS = 160, ROWS = 120 };
	static double position[3 * COLUMNS * ROWS], patch[COLUMNS * ROWS / 16];
	static uint32_t cell[COLUMNS * ROWS];
	static const double normal[3] = { 0.24, 0.06, -0.97 };
	gw_range_image image = { 0, COLUMNS * ROWS, COLUMNS, ROWS, { 0, 0, 0 } };
	uint64_t seed = 3;
	size_t good = 0;
	for (size_t i = 0; i < COLUMNS * ROWS / 16; i++)
		patch[i] = flicker * random_normal(&seed);
	for (uint32_t i = 0; i < COLUMNS * ROWS; i++) {
		uint32_t column = i % COLUMNS, row = i / COLUMNS;
		double *p = position + 3 * (size_t)i;
		const double step = 0.0029, way[3] = { (column - 79.5) / 260, (row - 59.5) / 260, 1 };
		double along = way[0] * normal[0] + way[1] * normal[1] + way[2] * normal[2];
		double inverse = along / (-0.97 * 4.5) / step + patch[row / 4 * (COLUMNS / 4) + column / 4];
		for (int k = 0; k < 3; k++)
			p[k] = way[k] / (step * round(inverse));
		cell[i] = i;
	}
	const gw_points points = { .count = image.count,
							   .position = position,
							   .image = &image,
							   .image_count = 1,
							   .image_cell = cell };
	gw_ranged_points ranged = use(&points, 0);
	assert_non_null(ranged.normal);
	for (size_t i = 0; i < image.count; i++) {
		double cosine = 0.0;
		for (size_t k = 0; k < 3; k++)
			cosine += (double)ranged.normal[3 * i + k] * normal[k];
		good += cosine > cos(5.0 * M_PI / 180.0);
	}
	gw_ranged_points_clear(&ranged);
	return (double)good / (double)image.count;
}

static void flicker_is_measured(void **state)
{
	(void)state;
	double still = share_of_wall(0.0), flickering = share_of_wall(0.6);
	print_message("normals within 5 degrees: %.1f %% by steps alone, %.1f %% flickering\n",
				  100.0 * still, 100.0 * flickering);
	assert_true(still > 0.95);
	assert_true(flickering > 0.85); /* 0.44 where all steps count as 0.42 of noise */
}

/* Mixed pixels between a carton and the floor behind it, and points anywhere along their beams:
 * most are found, and hardly any of the surface is taken for them. */
static void mixed_pixels_are_found(void **state)
{
	(void)state;
	const scan_setup setup = { .count = 60000,
							   .seed = 2,
							   .faults = {
								   .range_noise = 0.001, .beam_width = 0.008, .strays = 0.005 } };
	scanned s = scan_scene(MESH_CARTON, &setup);
	size_t found[4] = { 0 }, all[4] = { 0 };
	s.points.image = s.image;
	gw_ranged_points ranged = use(&s.points, 0);
	for (size_t i = 0; i < s.points.count; i++) {
		all[s.kind[i]]++;
		found[s.kind[i]] += ranged.stray[i] != 0;
	}
	print_message("%zu of %zu mixed pixels, %zu of %zu strays, %zu of %zu on surface\n",
				  found[CELL_MIXED], all[CELL_MIXED], found[CELL_STRAY], all[CELL_STRAY],
				  found[CELL_SURFACE], all[CELL_SURFACE]);
	/* Mixed pixels within the noise and a spacing of a surface can't be told from it, and a stray
	 * in ten is as near to it as that. */
	assert_true(found[CELL_MIXED] > all[CELL_MIXED] * 3 / 5);
	assert_true(found[CELL_STRAY] > all[CELL_STRAY] * 3 / 4);
	assert_true(found[CELL_SURFACE] < all[CELL_SURFACE] / 500);
	s.points.keep_strays = true;
	gw_ranged_points kept = use(&s.points, 0);
	assert_null(kept.points.stray);
	gw_ranged_points_clear(&kept);
	gw_ranged_points_clear(&ranged);
	clear(&s);
}

/* Of the fence's wires: neither of the floor nor of a post. */
static bool is_of_wire(const double place[3])
{
	return place[2] > 0.04 && fabs(place[1] - 0.035) < 0.004 &&
		   fabs(fmod(fabs(place[0]) + 0.6, 1.2) - 0.6) > 0.05;
}

/* Wires of 5 mm, seen by beams that are some 30 mm apart: each that meets one stands for its cell
 * and no more, and few points on walls, posts and floor do: those on edges and where they are
 * hardly wider than cells. */
static void wires_cover_what_they_cover(void **state)
{
	(void)state;
	const scan_setup setup = { .count = 40000, .seed = 2 };
	scanned s = scan_scene(MESH_FENCE, &setup);
	double covered = 0.0;
	size_t wires = 0, thin = 0, others = 0;
	s.points.image = s.image;
	gw_ranged_points ranged = use(&s.points, 0);
	for (size_t i = 0; i < s.points.count; i++) {
		const double *p = s.surface + 3 * i;
		bool wire = is_of_wire(p);
		wires += wire && ranged.stray[i] == 0;
		covered += wire ? (double)ranged.own_area[i] : 0.0;
		thin += wire && ranged.own_area[i] > 0.0f;
		others += !wire && ranged.own_area[i] > 0.0f;
	}
	print_message("%zu of %zu points on wires are thin, and %zu others; wires cover %.3f m^2\n",
				  thin, wires, others, covered / (double)s.points.image_count);
	assert_true(thin > wires * 4 / 5);
	/* Of 55 m of wires of 5 mm each scanner sees half or more, as wide as they are. */
	double wide = covered / (double)s.points.image_count / 0.005;
	assert_true(wide > 0.25 * 55.0 && wide < 55.0);
	assert_true(others < s.points.count / 40);
	gw_ranged_points_clear(&ranged);
	clear(&s);
}

/* Slats before a far wall, some columns wide and ten apart, whose faces are turned from the
 * scanner's beams; steps along columns and rows, degrees; noise in metres. */
typedef struct slats {
	uint32_t columns;
	double turned, column_step, row_step, noise;
} slats;

enum { SLAT_COLUMNS = 60, SLAT_ROWS = 200 };

/* The range of a cell. */
static double slat_range(const slats *s, uint32_t column, double up)
{
	const double degree = M_PI / 180.0;
	double turn = s->column_step * degree * (column % 10 - 0.5 * (s->columns - 1));
	double near = 4.0 * cos(s->turned * degree) / cos(s->turned * degree + turn);
	return (column % 10 < s->columns ? near : 20.0) / cos(up);
}

/* Shares of the points on slats, and on the wall, that are taken for things by themselves. */
static void share_thin(const slats *s, double *of_slats, double *of_wall)
{
	const double degree = M_PI / 180.0;
	double *position = calloc(3 * SLAT_COLUMNS * SLAT_ROWS, sizeof *position);
	uint32_t *cell = calloc(SLAT_COLUMNS * SLAT_ROWS, sizeof *cell), thin[2] = { 0 },
			 all[2] = { 0 };
	gw_range_image image = { 0, SLAT_COLUMNS * SLAT_ROWS, SLAT_COLUMNS, SLAT_ROWS, { 0, 0, 0 } };
	uint64_t seed = 5;
	assert_true(position && cell);
	for (uint32_t i = 0; i < SLAT_COLUMNS * SLAT_ROWS; i++) {
		double turn = s->column_step * degree * (i % SLAT_COLUMNS);
		double up = s->row_step * degree * (i / SLAT_COLUMNS);
		double range = slat_range(s, i % SLAT_COLUMNS, up) + s->noise * random_normal(&seed);
		position[3 * i] = range * cos(turn) * cos(up);
		position[3 * i + 1] = range * sin(turn) * cos(up);
		position[3 * i + 2] = range * sin(up);
		cell[i] = i;
	}
	const gw_points points = { .count = image.count,
							   .position = position,
							   .image = &image,
							   .image_count = 1,
							   .image_cell = cell };
	gw_ranged_points ranged = use(&points, 0);
	for (size_t i = 0; i < image.count; i++) {
		bool wall = i % SLAT_COLUMNS % 10 >= s->columns;
		all[wall]++;
		thin[wall] += ranged.own_area && ranged.own_area[i] > 0.0f;
	}
	*of_slats = (double)thin[0] / all[0];
	*of_wall = (double)thin[1] / all[1];
	gw_ranged_points_clear(&ranged);
	free(position);
	free(cell);
}

/* A surface four cells wide is none that stands for its cells, also where it is seen at 80 degrees
 * and more, so that the ranges of neighbours differ by many steps, and where rows are nearer to
 * each other than columns. Two cells are. */
static void slats_at_grazing_view_are_surface(void **state)
{
	(void)state;
	const slats row[] = {
		{ 4, 0, 0.2, 0.2, 0 },      { 4, 70, 0.2, 0.2, 0 },     { 4, 80, 0.2, 0.2, 0 },
		{ 4, 80, 0.2, 0.05, 0 },    { 4, 60, 0.4, 0.1, 0 },     { 4, 85, 0.2, 0.2, 0 },
		{ 4, 80, 0.2, 0.2, 0.003 }, { 4, 60, 0.4, 0.1, 0.003 }, { 2, 0, 0.2, 0.2, 0 },
		{ 2, 70, 0.2, 0.2, 0 },
	};
	for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
		double thin, wall;
		share_thin(&row[i], &thin, &wall);
		print_message(
			"slats of %u columns, turned by %.0f degrees, steps %.2f and %.2f, noise %.3f "
			"m: %.3f thin, and %.3f of the wall\n",
			row[i].columns, row[i].turned, row[i].column_step, row[i].row_step, row[i].noise, thin,
			wall);
		assert_true(row[i].columns == 2 ? thin > 0.99 : thin < 0.01);
		assert_true(wall < 0.01);
	}
}

/* As surfels, points on wires are discs hardly wider than a cell, some 40 mm, where wires
 * are 100 mm apart; and normals that come from the picture are known to be a little off. */
static void wires_are_small_discs(void **state)
{
	(void)state;
	const scan_setup setup = { .count = 40000, .seed = 2, .faults = { .range_noise = 0.002 } };
	scanned s = scan_scene(MESH_FENCE, &setup);
	const gw_surfels_options options = { .threads = 2, .memory = 1u << 28 };
	gw_surfels surfels;
	gw_error error = { 0 };
	size_t wires = 0, small = 0;
	double off = 0.0;
	s.points.image = s.image;
	if (gw_surfels_make(&s.points, &options, &surfels, &error) != GW_OK)
		fail_msg("%s", error.text);
	assert_non_null(surfels.shading_normal_off);
	for (size_t i = 0; i < s.points.count; i++) {
		uint32_t surfel = surfels.surfel_of_point[i];
		if (surfel == UINT32_MAX)
			continue;
		off += (double)surfels.shading_normal_off[surfel];
		if (!is_of_wire(s.surface + 3 * i))
			continue;
		wires++;
		small += surfels.radius[surfel] < 0.04f;
	}
	off /= (double)s.points.count;
	print_message("%zu of %zu wires' discs are small; normals are off by %.2f degrees\n", small,
				  wires, off * 57.3);
	assert_true(small > wires * 4 / 5);
	assert_true(off > 0.002 && off < 0.2);
	gw_surfels_clear(&surfels);
	clear(&s);
}

/* Without rows and columns, and with normals, points on wires lie in rows of one side, of which
 * there are many alike, and the next ones are on wires across: discs that reached to these would
 * close the net's meshes. Before that was looked at, 405 of 2763 had discs as wide as half a mesh.
 */
static void wires_with_normals_are_small_discs(void **state)
{
	(void)state;
	const scan_setup setup = { .count = 100000, .seed = 2 };
	scanned s = scan_scene(MESH_FENCE, &setup);
	const gw_surfels_options options = { .threads = 2, .normals = GW_NORMALS_GIVEN };
	gw_surfels surfels;
	gw_error error = { 0 };
	size_t wires = 0, wide = 0;
	float *normal = calloc(s.points.count, 3 * sizeof *normal);
	assert_non_null(normal);
	for (size_t i = 0; i < 3 * s.points.count; i++)
		normal[i] = (float)s.scene.triangle[s.triangle[i / 3]].normal[i % 3];
	s.points.normal = normal;
	s.points.image_count = 0;
	if (gw_surfels_make(&s.points, &options, &surfels, &error) != GW_OK)
		fail_msg("%s", error.text);
	for (size_t i = 0; i < s.points.count; i++) {
		uint32_t surfel = surfels.surfel_of_point[i];
		bool wire = surfel != UINT32_MAX && is_of_wire(s.surface + 3 * i);
		wires += wire;
		wide += wire && surfels.radius[surfel] > 0.05f;
	}
	print_message("%zu of %zu wires' discs are wide\n", wide, wires);
	assert_true(wires > 1000 && wide < wires / 50);
	free(normal);
	gw_surfels_clear(&surfels);
	clear(&s);
}

/* Rows and columns that are no picture, or of which the scanner stood elsewhere, tell nothing. */
static void no_pictures_tell_nothing(void **state)
{
	(void)state;
	const scan_setup setup = { .count = 40000, .seed = 2, .faults = { .range_noise = 0.01 } };
	scanned s = scan_scene(MESH_ROOMS, &setup);
	gw_ranged_points without = use(&s.points, 0);
	assert_true(without.normals == 0 || s.points.image_count > 0);
	s.points.image = s.image;
	for (size_t i = 0; i < s.points.image_count; i++)
		s.image[i].scanner[0] += 0.7;
	gw_ranged_points elsewhere = use(&s.points, 0);
	assert_memory_equal(elsewhere.position, s.position, 3 * s.points.count * sizeof(double));
	assert_int_equal(elsewhere.normals, 0);
	for (size_t i = 0; i < s.points.image_count; i++) {
		s.image[i].scanner[0] -= 0.7;
		s.image[i].columns = s.image[i].columns / 2 + 1; /* rows of the wrong length */
	}
	gw_ranged_points broken = use(&s.points, 0);
	for (size_t i = 0; i < s.points.count; i++)
		s.cell[i] = UINT32_MAX;
	gw_ranged_points empty = use(&s.points, 0);
	assert_int_equal(empty.normals, 0);
	gw_ranged_points_clear(&without);
	gw_ranged_points_clear(&elsewhere);
	gw_ranged_points_clear(&broken);
	gw_ranged_points_clear(&empty);
	clear(&s);
}

/* Planes over corners of walls have normals up to 90 degrees off, of one point in a hundred or so.
 * How far these are off all in all is told, to a third: it is one of several parts of an error that
 * add up by squares. */
static void errors_of_normals_are_told(void **state)
{
	(void)state;
	const scan_setup setup = { .count = 40000, .seed = 2, .faults = { .range_noise = 0.003 } };
	scanned s = scan_scene(MESH_ROOMS, &setup);
	float *albedo = calloc(s.points.count, 3 * sizeof *albedo);
	gw_surfels surfels;
	gw_error error = { 0 };
	double squared = 0.0, told = 0.0;
	s.points.image = s.image;
	s.points.albedo = albedo;
	if (gw_surfels_make(&s.points, &(gw_surfels_options){ .threads = 2 }, &surfels, &error) !=
		GW_OK)
		fail_msg("%s", error.text);
	for (size_t i = 0; i < s.points.count; i++) {
		uint32_t surfel = surfels.surfel_of_point[i];
		double cosine = 0.0;
		if (surfel == UINT32_MAX || s.kind[i] != CELL_SURFACE)
			continue;
		const float *lit = surfels.shading_normal ? surfels.shading_normal : surfels.normal;
		for (size_t k = 0; k < 3; k++)
			cosine +=
				(double)lit[3 * (size_t)surfel + k] * s.scene.triangle[s.triangle[i]].normal[k];
		squared += 2.0 - 2.0 * fabs(cosine);
		told +=
			(double)surfels.shading_normal_off[surfel] * (double)surfels.shading_normal_off[surfel];
	}
	double degrees = 180.0 / 3.14159265358979323846 / sqrt((double)s.points.count);
	print_message("normals are off by %.2f degrees, told %.2f\n", degrees * sqrt(squared),
				  degrees * sqrt(told));
	assert_true(told > squared / 2.25 && told < squared * 2.25);
	gw_surfels_clear(&surfels);
	free(albedo);
	clear(&s);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(noise_is_smoothed),
		cmocka_unit_test(clean_points_stay),
		cmocka_unit_test(steps_are_no_stairs),
		cmocka_unit_test(windows_leave_no_steps),
		cmocka_unit_test(flicker_is_measured),
		cmocka_unit_test(slats_at_grazing_view_are_surface),
		cmocka_unit_test(mixed_pixels_are_found),
		cmocka_unit_test(no_pictures_tell_nothing),
		cmocka_unit_test(wires_cover_what_they_cover),
		cmocka_unit_test(wires_are_small_discs),
		cmocka_unit_test(wires_with_normals_are_small_discs),
		cmocka_unit_test(errors_of_normals_are_told),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
