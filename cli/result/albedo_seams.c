/* albedo_seams.c - see albedo_seams.h. */
#include "result/albedo_seams.h"

#include "result/albedo_places.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SWEEPS 200

/* A point in its place. */
typedef struct member {
	int32_t at[3];
	uint32_t input;
	size_t point;
} member;

/* Pairs of inputs: how often they meet, and by how much the first is brighter, in logarithms. */
typedef struct meeting {
	double places, more[3];
} meeting;

static int compare(const void *a, const void *b)
{
	const member *x = a, *y = b;
	for (int k = 0; k < 3; k++)
		if (x->at[k] != y->at[k])
			return x->at[k] < y->at[k] ? -1 : 1;
	if (x->input != y->input)
		return x->input < y->input ? -1 : 1;
	return (x->point > y->point) - (x->point < y->point);
}

static size_t list_members(const loaded_scene *scene, const uint8_t *ends, const float *level,
						   member *list)
{
	const gw_points *p = &scene->points.points;
	double low[3], width = albedo_place_width(p, low);
	size_t used = 0, point = 0;
	for (uint32_t input = 0; input < scene->input_count; input++)
		for (size_t end = point + scene->input[input].points; point < end; point++) {
			const float *v = level + 3 * point;
			const double *at = p->position + 3 * point;
			member m = { .input = input, .point = point };
			bool known = !ends[point] && v[0] > 0.0f && v[1] > 0.0f && v[2] > 0.0f;
			for (int k = 0; k < 3 && known; k++) {
				double cell = (at[k] - low[k]) / width;
				known = cell >= 0.0 && cell < 0x1p30;
				m.at[k] = known ? (int32_t)cell : 0;
			}
			if (known)
				list[used++] = m;
		}
	qsort(list, used, sizeof *list, compare);
	return used;
}

/* One place: the mean logarithm of each input in it, then all pairs of inputs. */
static void meet(const member *list, size_t count, const float *level, size_t inputs, double *mean,
				 meeting *meetings)
{
	memset(mean, 0, 4 * inputs * sizeof *mean);
	for (size_t i = 0; i < count; i++) {
		double *m = mean + 4 * list[i].input;
		for (size_t k = 0; k < 3; k++)
			m[k] += log((double)level[3 * list[i].point + k]);
		m[3]++;
	}
	for (size_t a = 0; a < inputs; a++)
		for (size_t b = 0; b < inputs; b++) {
			const double *x = mean + 4 * a, *y = mean + 4 * b;
			meeting *to = &meetings[a * inputs + b];
			if (a == b || x[3] < 3 || y[3] < 3)
				continue;
			to->places++;
			for (int k = 0; k < 3; k++)
				to->more[k] += x[k] / x[3] - y[k] / y[3];
		}
}

/* Gauss and Seidel: each input is moved to where those that it meets want it; the first stays. */
static void settle(const meeting *meetings, size_t inputs, double *shift)
{
	for (int sweep = 0; sweep < SWEEPS; sweep++)
		for (size_t a = 1; a < inputs; a++)
			for (size_t k = 0; k < 3; k++) {
				double sum = 0, places = 0;
				for (size_t b = 0; b < inputs; b++) {
					const meeting *m = &meetings[a * inputs + b];
					sum += m->places * shift[3 * b + k] - m->more[k];
					places += m->places;
				}
				if (places > 0)
					shift[3 * a + k] = sum / places;
			}
}

static void apply(const loaded_scene *scene, const double *shift, float *level)
{
	size_t point = 0;
	for (size_t input = 0; input < scene->input_count; input++)
		for (size_t end = point + scene->input[input].points; point < end; point++)
			for (size_t k = 0; k < 3; k++)
				level[3 * point + k] *= (float)exp(shift[3 * input + k]);
}

gw_status albedo_seams_level(const loaded_scene *scene, const uint8_t *ends, float *level,
							 gw_error *error)
{
	size_t inputs = scene->input_count, count = scene->cloud.count;
	if (inputs < 2)
		return GW_OK;
	member *list = reallocarray(NULL, count, sizeof *list);
	meeting *meetings = calloc(inputs * inputs, sizeof *meetings);
	double *mean = calloc(inputs, 4 * sizeof *mean), *shift = calloc(inputs, 3 * sizeof *shift);
	bool good = list && meetings && mean && shift;
	size_t used = good ? list_members(scene, ends, level, list) : 0;
	for (size_t first = 0, last; first < used; first = last) {
		for (last = first + 1;
			 last < used && memcmp(list[first].at, list[last].at, sizeof list->at) == 0; last++)
			continue;
		meet(list + first, last - first, level, inputs, mean, meetings);
	}
	if (good) {
		settle(meetings, inputs, shift);
		apply(scene, shift, level);
	}
	free(list);
	free(meetings);
	free(mean);
	free(shift);
	return good ? GW_OK : gw_fail(error, GW_ERROR_MEMORY, "no memory for the seams");
}
