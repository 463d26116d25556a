/*
 * point_subset.c - see point_subset.h.
 */
#include "bake/point_subset.h"

#include "base/memory.h"

#include <stdlib.h>
#include <string.h>

const gw_range_image *gw_point_subset_image_of(const gw_points *points, size_t point, size_t *image)
{
	while (*image < points->image_count &&
		   point >= points->image[*image].first + points->image[*image].count)
		++*image;
	bool within = points->image_cell && *image < points->image_count &&
				  point >= points->image[*image].first && points->image[*image].columns > 0;
	return within ? &points->image[*image] : NULL;
}

static bool is_chosen(const gw_points *points, const gw_subset_choice *choice, size_t point,
					  const gw_range_image *image)
{
	if (!image)
		return choice->takes(choice->user, point);
	uint32_t cell = points->image_cell[point];
	return cell % image->columns % choice->columns == 0 &&
		   cell / image->columns % choice->rows == 0;
}

/* The instance that a point belongs to, or NULL, likewise. */
static gw_object_instance *instance_of(const gw_points *points, size_t point, size_t *instance,
									   gw_object_instance *parts)
{
	while (*instance < points->instance_count &&
		   point >= points->instance[*instance].first + points->instance[*instance].count)
		++*instance;
	bool within = *instance < points->instance_count && point >= points->instance[*instance].first;
	return within ? &parts[*instance] : NULL;
}

/* The point that a point of an instance repeats, or itself. */
static size_t repeated(const gw_points *points, size_t point, size_t instance, const void *within)
{
	if (!within)
		return point;
	const gw_object_instance *own = &points->instance[instance];
	return points->instance[own->of].first + point - own->first;
}

/* Of instances of which nothing is left, nothing is to be repeated: they are points like others. */
static void finish_instances(gw_point_subset *subset)
{
	for (size_t k = 0; k < subset->points.instance_count; k++)
		if (subset->instance[k].count == 0)
			subset->points.instance_count = 0;
}

/* Lists those chosen; images and instances keep their place among them. */
static void choose(const gw_points *points, const gw_subset_choice *choice, gw_point_subset *subset)
{
	size_t image = 0, instance = 0, count = 0;
	for (size_t k = 0; k < points->instance_count; k++) {
		subset->instance[k] = points->instance[k];
		subset->instance[k].count = 0;
	}
	for (size_t k = 0; k < points->image_count; k++) {
		gw_range_image *part = &subset->image[k];
		*part = points->image[k];
		part->columns = (part->columns + choice->columns - 1) / choice->columns;
		part->rows = (part->rows + choice->rows - 1) / choice->rows;
		part->count = 0;
	}
	for (size_t i = 0; i < points->count; i++) {
		const gw_range_image *own = gw_point_subset_image_of(points, i, &image);
		gw_object_instance *placed = instance_of(points, i, &instance, subset->instance);
		if (!is_chosen(points, choice, repeated(points, i, instance, placed), own))
			continue;
		if (placed && placed->count++ == 0)
			placed->first = count;
		gw_range_image *part = own ? &subset->image[image] : NULL;
		if (part && part->count++ == 0)
			part->first = count;
		if (part)
			subset->image_cell[count] =
				points->image_cell[i] / own->columns / choice->rows * part->columns +
				points->image_cell[i] % own->columns / choice->columns;
		subset->from[count++] = i;
	}
	subset->points.count = count;
	finish_instances(subset);
}

/* The rows of those chosen; NULL where there are none to copy, or no memory, which *good tells. */
static void *copy_rows(const gw_point_subset *subset, const void *rows, size_t bytes, bool *good)
{
	size_t count = subset->points.count;
	unsigned char *copy = rows ? gw_allocate_array(count > 0 ? count : 1, bytes) : NULL;
	const unsigned char *from = rows;
	*good = *good && (copy || !rows);
	for (size_t i = 0; copy && i < count; i++)
		memcpy(copy + i * bytes, from + subset->from[i] * bytes, bytes);
	return copy;
}

static bool copy_all(const gw_points *all, gw_point_subset *subset)
{
	gw_points *p = &subset->points;
	bool good = true;
	p->position = subset->position = copy_rows(subset, all->position, 3 * sizeof(double), &good);
	p->normal = subset->normal = copy_rows(subset, all->normal, 3 * sizeof(float), &good);
	p->albedo = subset->albedo = copy_rows(subset, all->albedo, 3 * sizeof(float), &good);
	p->emission = subset->emission = copy_rows(subset, all->emission, 3 * sizeof(float), &good);
	p->opacity = subset->opacity = copy_rows(subset, all->opacity, sizeof(float), &good);
	p->own_area = subset->own_area = copy_rows(subset, all->own_area, sizeof(float), &good);
	p->beam_share = subset->beam_share = copy_rows(subset, all->beam_share, sizeof(float), &good);
	p->scanner_of = subset->scanner_of =
		copy_rows(subset, all->scanner_of, sizeof(uint32_t), &good);
	p->stray = subset->stray = copy_rows(subset, all->stray, 1, &good);
	p->image = subset->image;
	p->instance = subset->instance;
	p->image_cell = all->image_cell ? subset->image_cell : NULL;
	return good;
}

static gw_status no_memory(const gw_point_subset *subset, gw_error *error)
{
	return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu of the points", subset->points.count);
}

gw_status gw_point_subset_make(const gw_points *points, const gw_subset_choice *choice,
							   gw_point_subset *subset, gw_error *error)
{
	gw_points given = *points;
	given.instance_count = choice->instances ? points->instance_count : 0;
	points = &given;
	*subset = (gw_point_subset){ .points = given };
	subset->from = gw_allocate_array(points->count, sizeof *subset->from);
	subset->image_cell = gw_allocate_array(points->count, sizeof *subset->image_cell);
	subset->image = gw_allocate_array(points->image_count + 1, sizeof *subset->image);
	subset->instance = gw_allocate_array(points->instance_count + 1, sizeof *subset->instance);
	bool good = subset->from && subset->image_cell && subset->image && subset->instance;
	if (good) {
		choose(points, choice, subset);
		good = copy_all(points, subset);
	}
	return good ? GW_OK : no_memory(subset, error);
}

gw_status gw_point_subset_ask(gw_point_subset *subset, const uint8_t *asked, gw_error *error)
{
	bool good = true;
	subset->asked = copy_rows(subset, asked, 1, &good);
	return good ? GW_OK : no_memory(subset, error);
}

void gw_point_subset_clear(gw_point_subset *subset)
{
	free(subset->from);
	free(subset->position);
	free(subset->normal);
	free(subset->albedo);
	free(subset->emission);
	free(subset->opacity);
	free(subset->own_area);
	free(subset->beam_share);
	free(subset->scanner_of);
	free(subset->image_cell);
	free(subset->image);
	free(subset->instance);
	free(subset->stray);
	free(subset->asked);
	*subset = (gw_point_subset){ .from = NULL };
}
