/*
 * scene_instances.c - see scene_instances.h.
 */
#include "scene/scene_instances.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* How uneven a matrix may be, relative: points are moved by it, their surfels by one that is even,
 * so that they come apart by that much of an object's width. */
#define EVEN 1e-5

/* A third of the squared lengths of the columns of a matrix: of an even one, its squared scale. */
static double squared_scale(const double m[16])
{
	double sum = 0.0;
	for (size_t row = 0; row < 3; row++)
		for (size_t k = 0; k < 3; k++)
			sum += m[4 * row + k] * m[4 * row + k];
	return sum / 3.0;
}

/* From where an even matrix brings something to where another one does. */
static void from_to(const double from[16], const double to[16], double out[16])
{
	double size = squared_scale(from);
	memset(out, 0, 16 * sizeof *out);
	out[15] = 1.0;
	for (size_t row = 0; row < 3; row++) {
		for (size_t k = 0; k < 3; k++)
			for (size_t j = 0; j < 3; j++) /* a turn's inverse is its transpose */
				out[4 * row + k] += to[4 * row + j] * from[4 * k + j] / size;
		out[4 * row + 3] = to[4 * row + 3];
	}
	for (size_t row = 0; row < 3; row++)
		for (size_t k = 0; k < 3; k++)
			out[4 * row + 3] -= out[4 * row + k] * from[4 * k + 3];
}

/* Inputs first .. end - 1 are one cloud; do all of their matrices keep its shape? */
static bool keeps_shape(const settings *s, const loaded_scene *scene, size_t first, size_t end)
{
	bool even = end > first + 1 && !scene->input[first].is_mesh;
	for (size_t i = first; i < end && even; i++)
		even = s->input[i].has_matrix && gw_matrix_is_even(s->input[i].matrix, EVEN) &&
			   scene->input[i].points == scene->input[first].points;
	return even;
}

/* The inputs from `first` on that are one cloud. */
static size_t find_end(const settings *s, size_t first)
{
	size_t end = first + 1;
	while (end < s->input_count && s->input[end].again)
		end++;
	return end;
}

gw_status scene_instances_list(const settings *s, const loaded_scene *scene,
							   gw_object_instance **instance, size_t *count, gw_error *error)
{
	*instance = NULL;
	*count = 0;
	if (scene->place.changes || scene->parted || s->path_count > 0 || s->input_count < 2)
		return GW_OK;
	gw_object_instance *list = calloc(s->input_count, sizeof *list);
	if (!list)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu inputs", s->input_count);
	size_t at = 0;
	for (size_t first = 0, end; first < s->input_count; first = end) {
		end = find_end(s, first);
		size_t of = *count;
		bool listed = keeps_shape(s, scene, first, end);
		for (size_t i = first; i < end; at += scene->input[i++].points)
			if (listed) {
				gw_object_instance *own = &list[(*count)++];
				*own = (gw_object_instance){ at, scene->input[i].points, of, { 0 } };
				from_to(s->input[first].matrix, s->input[i].matrix, own->matrix);
			}
	}
	if (at != scene->cloud.count) /* rows without a point are in no place */
		*count = 0;
	*instance = list;
	return GW_OK;
}
