/* range_image.c - see range_image.h */
#include "cloud/range_image.h"

#include "base/memory.h"
#include "base/nth_element.h"
#include "cloud/frame.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define POINTS_LEAST 64u /* of an image that tells anything */
#define CELLS_MOST 16u   /* cells a point */
#define PAIRS 4096u      /* pairs of neighbours that the angle between cells is found from */
#define REGULAR 0.8      /* share of them that have to be at even angles */
#define UNEVEN 0.2       /* that two angles in a row may differ by */
#define NOISE_LEAST 0.01 /* spacings of noise up to which points stay where they are */
#define NOISE_MUCH 0.02  /* from which on they are moved all the way */
#define NORMAL_OFF 0.35  /* most standard deviation of a normal, radians */

bool gw_range_way(const gw_range_grid *grid, size_t cell, double way[3])
{
	uint32_t point = grid->point[cell];
	if (point == GW_NO_POINT)
		return false;
	for (size_t k = 0; k < 3; k++)
		way[k] = grid->points->position[3 * (size_t)point + k] - grid->image->scanner[k];
	return true;
}

static double length_of(const double v[3])
{
	return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* ---------------------------------------------------------------------------------- grids */

/* Does a point have a place that a ray may have met? */
static bool is_met(const gw_points *points, const gw_range_image *image, size_t point)
{
	double square = 0.0;
	for (size_t k = 0; k < 3; k++) {
		double x = points->position[3 * point + k];
		if (!(fabs(x) <= GW_COORDINATE_MAX))
			return false;
		square += (x - image->scanner[k]) * (x - image->scanner[k]);
	}
	return square > 1e-12;
}

/* Sorts the image's points into its cells; the first one in a cell has it. */
static void fill_cells(gw_range_grid *grid)
{
	const gw_points *points = grid->points;
	const gw_range_image *image = grid->image;
	size_t cells = (size_t)image->columns * image->rows;
	memset(grid->point, 0xff, cells * sizeof *grid->point);
	for (size_t i = image->first; i < image->first + image->count; i++) {
		size_t cell = points->image_cell[i];
		if (cell < cells && grid->point[cell] == GW_NO_POINT && is_met(points, image, i))
			grid->point[cell] = (uint32_t)i;
	}
}

/* The angle between two cells; 0 when one of them is empty. */
static double angle_between(const gw_range_grid *grid, size_t cell, size_t other)
{
	double v[3], w[3], across[3];
	if (!gw_range_way(grid, cell, v) || !gw_range_way(grid, other, w))
		return 0.0;
	for (size_t k = 0; k < 3; k++)
		across[k] = v[(k + 1) % 3] * w[(k + 2) % 3] - v[(k + 2) % 3] * w[(k + 1) % 3];
	return atan2(length_of(across), v[0] * w[0] + v[1] * w[1] + v[2] * w[2]);
}

/* The angle between neighbours; 0 when three cells in a row are not at even angles: then rows and
 * columns are no picture, or were not seen from anywhere near. */
static double find_step(const gw_range_grid *grid)
{
	size_t columns = grid->image->columns, rows = grid->image->rows, cells = columns * rows;
	float angle[PAIRS];
	size_t count = 0, even = 0, stride = cells / PAIRS + 1;
	for (size_t i = 0; i < cells && count < PAIRS; i += stride) {
		bool down = i / stride % 2;
		size_t next = down ? columns : 1;
		if (down ? i / columns + 2 >= rows : i % columns + 2 >= columns)
			continue;
		double one = angle_between(grid, i, i + next), two = angle_between(grid, i, i + 2 * next);
		if (!(one > 0.0 && two > 0.0))
			continue;
		even += fabs(two / one - 2.0) < UNEVEN;
		angle[count++] = (float)one;
	}
	if (count < POINTS_LEAST / 4 || (double)even < REGULAR * (double)count)
		return 0.0;
	return (double)gw_nth_element(angle, count, count / 2);
}

static bool is_usable(const gw_points *points, const gw_range_image *image)
{
	uint64_t cells = (uint64_t)image->columns * image->rows;
	bool finite = true;
	for (size_t k = 0; k < 3; k++)
		finite = finite && fabs(image->scanner[k]) <= GW_COORDINATE_MAX;
	return finite && image->first <= points->count &&
		   image->count <= points->count - image->first && image->count >= POINTS_LEAST &&
		   image->columns > 4 && image->rows > 4 && cells < UINT32_MAX &&
		   cells <= (uint64_t)CELLS_MOST * image->count;
}

bool gw_range_grid_open(const gw_points *points, const gw_range_image *image, gw_range_grid *grid)
{
	*grid = (gw_range_grid){ .points = points, .image = image };
	if (!is_usable(points, image))
		return true;
	grid->point = gw_allocate_array((size_t)image->columns * image->rows, sizeof *grid->point);
	if (!grid->point)
		return false;
	fill_cells(grid);
	grid->step = find_step(grid);
	return true;
}

void gw_range_grid_close(gw_range_grid *grid)
{
	free(grid->point);
	grid->point = NULL;
}

/* -------------------------------------------------------------------------------- outcome */

/* Is a normal given? */
static bool has_normal(const gw_points *points, size_t point)
{
	return points->normal && gw_normal_length(points->normal + 3 * point) > 0.0;
}

/* The plane's normal, to the scanner, where it is known well enough. */
static void set_normal(const gw_range_plane *plane, double spread, size_t point,
					   gw_ranged_points *out)
{
	double half = (double)plane->half, cells = (2.0 * half + 1.0) * (2.0 * half + 1.0);
	const double a[3] = { (double)plane->a[0], (double)plane->a[1], (double)plane->a[2] };
	double length = length_of(a);
	if (has_normal(&out->points, point) ||
		!(spread / sqrt(cells * half * (half + 1.0) / 3.0) < NORMAL_OFF) || !(length > 0.0))
		return;
	for (size_t k = 0; k < 3; k++)
		out->normal[3 * point + k] = (float)(-a[k] / length);
	out->normals++;
}

/* What the planes say of one point. `spread` is its noise in spacings. */
static void take_plane(const gw_range_grid *grid, const gw_range_plane *plane, size_t point,
					   gw_ranged_points *out)
{
	const gw_range_image *image = grid->image;
	double way[3], direction[3];
	if (!gw_range_way(grid, grid->points->image_cell[point], way))
		return;
	double range = length_of(way), noise = (double)grid->noise[gw_range_bin(range)];
	double spread = noise / (grid->step * range);
	set_normal(plane, spread, point, out);
	for (size_t k = 0; k < 3; k++)
		direction[k] = way[k] / range;
	double share = fmin(fmax((spread - NOISE_LEAST) / (NOISE_MUCH - NOISE_LEAST), 0.0), 1.0);
	double smooth = 1.0 / gw_range_plane_dot(plane, direction);
	if (!(share > 0.0 && fabs(smooth - range) < 6.0 * noise))
		return;
	for (size_t k = 0; k < 3; k++)
		out->position[3 * point + k] =
			image->scanner[k] + (range + share * (smooth - range)) * direction[k];
}

static bool use_grid(gw_range_grid *grid, uint32_t threads, gw_ranged_points *out)
{
	const gw_range_image *image = grid->image;
	gw_range_plane *plane = gw_allocate_zeros(image->count, sizeof *plane);
	bool good = plane && gw_range_noise_find(grid) && gw_range_planes_find(grid, threads, plane) &&
				gw_range_planes_blend(grid, plane);
	for (size_t i = image->first; good && i < image->first + image->count; i++) {
		size_t cell = grid->points->image_cell[i];
		if (cell >= (size_t)image->columns * image->rows || grid->point[cell] != i)
			continue;
		uint8_t stray = out->stray ? gw_range_stray(grid, plane, cell) : 0;
		if (stray != 0) {
			out->stray[i] = out->stray[i] != 0 ? out->stray[i] : stray;
		} else if (!has_normal(&out->points, i) && gw_range_own_area(grid, plane, cell) > 0.0f) {
			out->own_area[i] = gw_range_own_area(grid, plane, cell);
		} else if (plane[i - image->first].half > 0) {
			take_plane(grid, &plane[i - image->first], i, out);
		}
	}
	free(plane);
	return good;
}

static bool use_image(const gw_points *points, const gw_range_image *image, uint32_t threads,
					  gw_ranged_points *out)
{
	gw_range_grid grid;
	bool good = gw_range_grid_open(points, image, &grid);
	if (grid.step > 0.0 && gw_range_rays_meet(&grid))
		good = use_grid(&grid, threads, out);
	gw_range_grid_close(&grid);
	return good;
}

static bool allocate(const gw_points *points, gw_ranged_points *out)
{
	size_t n = points->count;
	out->position = gw_allocate_array(n, 3 * sizeof *out->position);
	out->normal = gw_allocate_zeros(n, 3 * sizeof *out->normal);
	out->own_area = gw_allocate_zeros(n, sizeof *out->own_area);
	if (!out->position || !out->normal || !out->own_area)
		return false;
	if (!points->keep_strays) {
		out->stray = gw_allocate_zeros(n, 1);
		if (!out->stray)
			return false;
		if (points->stray)
			memcpy(out->stray, points->stray, n);
	}
	memcpy(out->position, points->position, 3 * n * sizeof *out->position);
	if (points->normal)
		memcpy(out->normal, points->normal, 3 * n * sizeof *out->normal);
	return true;
}

gw_status gw_range_images_use(const gw_points *points, const gw_surfels_options *options,
							  gw_ranged_points *out, gw_error *error)
{
	*out = (gw_ranged_points){ .points = *points, .options = *options };
	if (points->image_count == 0 || !points->image || !points->image_cell)
		return GW_OK;
	if (options->normals == GW_NORMALS_ESTIMATE)
		out->points.normal = NULL;
	if (!out->points.normal)
		out->options.normals = GW_NORMALS_GIVEN;
	bool good = allocate(&out->points, out);
	for (size_t i = 0; good && i < points->image_count; i++)
		good = use_image(points, &points->image[i], options->threads, out);
	if (!good) {
		gw_ranged_points_clear(out);
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the range images of %zu points",
					   points->count);
	}
	out->points.position = out->position;
	out->points.normal = out->normal;
	out->points.own_area = out->own_area;
	out->points.stray = out->stray;
	out->points.image_count = 0;
	return GW_OK;
}

void gw_ranged_points_clear(gw_ranged_points *out)
{
	free(out->position);
	free(out->normal);
	free(out->own_area);
	free(out->stray);
	*out = (gw_ranged_points){ .points = { .count = 0 } };
}
