/* range_image.c - see range_image.h */
#include "cloud/range_image.h"

#include "base/memory.h"
#include "cloud/frame.h"
#include "cloud/range_steps.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define NOISE_LEAST 0.01 /* spacings of noise up to which points stay where they are */
#define NOISE_MUCH 0.02  /* from which on they are moved all the way */
#define NORMAL_OFF 0.35  /* most standard deviation of a normal, radians */

static double length_of(const double v[3])
{
	return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

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
