/* far_points.c - see far_points.h. */
#include "bake/far_points.h"

#include "bake/surface_owners.h"
#include "bake/surface_points.h"
#include "bake/tiling.h"
#include "base/hash.h"
#include "base/key_sort.h"
#include "base/memory.h"
#include "base/parallel.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What a cube may take of what is seen from the tile, in angle. */
#define CUBE_ANGLE (1.0 / 16.0)

/* Levels of cubes; the widest are 2^LEVEL_MOST spacings wide. */
#define LEVEL_MOST 40

/* Points of a surface bend away from planes: lamps' light that passes so many spacings beside the
 * tile is as good as in it. */
#define BESIDE 8.0

/* Lamps are made of less than one point in so many. */
#define FEW_GLOW 8u

/* Halvings of the box around a tile, by which a few strays beside it do not make it wide. */
#define HALVINGS 4u
#define BOXES (1u << HALVINGS)

#define CHUNK 4096u

typedef struct box {
	double low[3], high[3];
} box;

typedef struct sorting_out {
	const gw_tile *tile;
	const gw_tile_lighting *lighting;
	box box[BOXES]; /* around the tile's own points */
	size_t boxes;
	double spacing;  /* between those that were kept, metres */
	uint32_t *group; /* of each that was kept, or GW_OWNER_NONE: that is in the tile or its halo */
	uint32_t groups;
	gw_keyed *keyed; /* keys: the others; sorted, group after group */
	size_t keys;
	bool few_glow;
} sorting_out;

/* ---------------------------------------------------------------------------------- how far */

static box around(const gw_points *points, const uint32_t *point, size_t count)
{
	box b;
	for (size_t k = 0; k < 3; k++) {
		b.low[k] = INFINITY;
		b.high[k] = -INFINITY;
	}
	for (size_t i = 0; i < count; i++)
		for (size_t k = 0; k < 3; k++) {
			b.low[k] = fmin(b.low[k], points->position[3 * (size_t)point[i] + k]);
			b.high[k] = fmax(b.high[k], points->position[3 * (size_t)point[i] + k]);
		}
	return b;
}

static size_t longest(const box *b)
{
	size_t axis = 0;
	for (size_t k = 1; k < 3; k++)
		if (b->high[k] - b->low[k] > b->high[axis] - b->low[axis])
			axis = k;
	return axis;
}

/* Sorts points into those below a place along an axis, of which it returns how many there are, and
 * the others. */
static size_t part_along(const gw_points *points, uint32_t *point, size_t count, size_t axis,
						 double at)
{
	size_t below = 0;
	for (size_t i = 0; i < count; i++) {
		uint32_t own = point[i];
		if (!(points->position[3 * (size_t)own + axis] < at))
			continue;
		point[i] = point[below];
		point[below++] = own;
	}
	return below;
}

/* Boxes around some of the tile's points, halved so often. */
static void add_boxes(sorting_out *s, uint32_t *point, size_t count, uint32_t halvings)
{
	const gw_points *near = s->tile->near;
	box b = around(near, point, count);
	size_t axis = longest(&b);
	size_t below = halvings > 0
					   ? part_along(near, point, count, axis, 0.5 * (b.low[axis] + b.high[axis]))
					   : count;
	if (below == 0 || below == count) {
		s->box[s->boxes++] = b;
		return;
	}
	add_boxes(s, point, below, halvings - 1);
	add_boxes(s, point + below, count - below, halvings - 1);
}

/* What has no place is nowhere. */
static bool find_boxes(sorting_out *s)
{
	const gw_points *near = s->tile->near;
	size_t count = 0;
	uint32_t *point = gw_allocate_array(near->count, sizeof *point);
	for (size_t i = 0; point && i < near->count; i++) {
		const double *at = near->position + 3 * i;
		if (s->tile->core[i] && isfinite(at[0]) && isfinite(at[1]) && isfinite(at[2]))
			point[count++] = (uint32_t)i;
	}
	if (count > 0)
		add_boxes(s, point, count, HALVINGS);
	free(point);
	return point != NULL;
}

/* Not a number of places that are none. */
static double distance_between(const box *b, const double at[3])
{
	double square = 0.0;
	for (size_t k = 0; k < 3; k++) {
		double off = at[k] < b->low[k] ? b->low[k] - at[k] : at[k] - b->high[k];
		square += off < 0.0 ? 0.0 : off * off;
	}
	return sqrt(square);
}

/* From the nearest of the tile's boxes. */
static double distance_of(const sorting_out *s, const double at[3])
{
	double distance = INFINITY;
	for (size_t i = 0; i < s->boxes; i++)
		distance = fmin(distance, distance_between(&s->box[i], at));
	return distance;
}

/* Does a ray from a place meet a box with so much around it? */
static bool meets_box(const box *b, const double at[3], const double toward[3], double more)
{
	double enter = 0.0, leave = INFINITY;
	for (size_t k = 0; k < 3; k++) {
		double near = b->low[k] - more - at[k], far = b->high[k] + more - at[k];
		if (toward[k] == 0.0) {
			leave = near > 0.0 || far < 0.0 ? -1.0 : leave;
			continue;
		}
		enter = fmax(enter, fmin(near / toward[k], far / toward[k]));
		leave = fmin(leave, fmax(near / toward[k], far / toward[k]));
	}
	return enter <= leave;
}

static bool meets_tile(const sorting_out *s, const double at[3], const double toward[3],
					   double more)
{
	bool meets = false;
	for (size_t i = 0; i < s->boxes && !meets; i++)
		meets = meets_box(&s->box[i], at, toward, more);
	return meets;
}

/* How far a light reaches to the sides of its middle, metres: seen past a place, that gives shadows
 * half of their penumbra. */
static double widest(const gw_light *light)
{
	double size = hypot((double)light->size[0], (double)light->size[1]);
	return fmax((double)light->radius, light->type == GW_LIGHT_RECTANGLE ? 0.5 * size : 0.0);
}

/* May a place cast a shadow of a light on the tile? */
static bool shades(const sorting_out *s, const gw_light *light, const double at[3], double distance)
{
	double toward[3], more = BESIDE * s->spacing;
	if (light->type == GW_LIGHT_ENVIRONMENT)
		return false;
	if (light->type == GW_LIGHT_SUN) {
		more += distance * tan(0.5 * M_PI / 180.0 * (double)light->angle);
		return meets_tile(s, at, light->direction, more);
	}
	for (size_t k = 0; k < 3; k++)
		toward[k] = at[k] - light->position[k];
	double from = sqrt(toward[0] * toward[0] + toward[1] * toward[1] + toward[2] * toward[2]);
	more += from > 0.0 ? distance * widest(light) / from : INFINITY;
	return meets_tile(s, at, toward, more);
}

/* What glows all over is taken together as well. */
static void count_glowing(sorting_out *s)
{
	size_t glowing = 0, kept = s->tile->kept->count;
	for (size_t i = 0; i < kept; i++)
		glowing += gw_point_glows(s->tile->kept, i);
	s->few_glow = glowing < kept / FEW_GLOW;
}

/* The level of the cubes that a point may be taken together with others in; 0: it stays alone. */
static uint32_t level_of(const sorting_out *s, size_t point)
{
	const gw_points *kept = s->tile->kept;
	const double *at = kept->position + 3 * point;
	double distance = distance_of(s, at), widths = CUBE_ANGLE * distance / s->spacing;
	if (!(widths >= 2.0) || !isfinite(widths) || (s->few_glow && gw_point_glows(kept, point)) ||
		(kept->stray && kept->stray[point]))
		return 0;
	for (size_t k = 0; k < s->lighting->light_count; k++)
		if (shades(s, &s->lighting->light[k], at, distance))
			return 0;
	return (uint32_t)fmin(log2(widths), LEVEL_MOST);
}

/* ----------------------------------------------------------------------------------- grouping */

static uint64_t key_of(const sorting_out *s, size_t point)
{
	uint32_t level = level_of(s, point);
	const double width = ldexp(s->spacing, (int)level);
	const double *at = s->tile->kept->position + 3 * point;
	int64_t cell[5] = { (int64_t)point, 0, 0, 0, level };
	for (size_t k = 0; level > 0 && k < 3; k++)
		cell[k] = (int64_t)floor(at[k] / width);
	if (level > 0)
		cell[3] = gw_facing_side(s->tile->light->normal + 3 * point);
	return gw_hash(0, cell, sizeof cell);
}

static gw_status no_memory(const sorting_out *s, gw_error *error)
{
	return gw_fail(error, GW_ERROR_MEMORY, "no memory to take %zu points together",
				   s->tile->kept->count);
}

static void find_keys(void *user, size_t first, size_t last, uint32_t worker)
{
	const sorting_out *s = user;
	(void)worker;
	for (size_t i = first; i < last; i++)
		s->keyed[i].key = key_of(s, s->keyed[i].item);
}

/* Sorts the points by group; those that are in the tile or its halo are in none. */
static gw_status find_groups(sorting_out *s, gw_error *error)
{
	size_t kept = s->tile->kept->count;
	uint32_t threads = s->lighting->options->threads;
	s->group = gw_allocate_zeros(kept, sizeof *s->group);
	s->keyed = gw_allocate_array(kept, sizeof *s->keyed);
	if (!s->group || !s->keyed)
		return no_memory(s, error);
	for (size_t i = 0; i < s->tile->replaced_count; i++)
		if (s->tile->replaced[i] < kept)
			s->group[s->tile->replaced[i]] = GW_OWNER_NONE;
	for (size_t i = 0; i < kept; i++)
		if (s->group[i] != GW_OWNER_NONE)
			s->keyed[s->keys++] = (gw_keyed){ .item = (uint32_t)i };
	gw_parallel_for(threads, s->keys, CHUNK, find_keys, s);
	return gw_sort_keyed(&s->keyed, s->keys, 64, threads) ? GW_OK : no_memory(s, error);
}

/* One behind the last of the group that begins there. */
static size_t end_of(const sorting_out *s, size_t first)
{
	size_t last = first + 1;
	while (last < s->keys && s->keyed[last].key == s->keyed[first].key)
		last++;
	return last;
}

/* Which point of a group is nearest to its middle; of those that are as near the first one. */
static uint32_t nearest_to_middle(const sorting_out *s, size_t first, size_t last)
{
	const double *position = s->tile->kept->position;
	double middle[3] = { 0 }, least = INFINITY;
	uint32_t nearest = s->keyed[first].item;
	for (size_t j = first; j < last; j++)
		for (size_t k = 0; k < 3; k++)
			middle[k] += position[3 * (size_t)s->keyed[j].item + k] / (double)(last - first);
	for (size_t j = first; j < last; j++) {
		const double *at = position + 3 * (size_t)s->keyed[j].item;
		double square = 0.0;
		for (size_t k = 0; k < 3; k++)
			square += (at[k] - middle[k]) * (at[k] - middle[k]);
		nearest = square < least ? s->keyed[j].item : nearest;
		least = fmin(least, square);
	}
	return nearest;
}

/* Which points stand for others: 1 for each that does. Each other point has its number as its
 * group. */
static uint8_t *choose(sorting_out *s)
{
	uint8_t *chosen = gw_allocate_zeros(s->tile->kept->count, 1);
	for (size_t first = 0, last; chosen && first < s->keys; first = last) {
		last = end_of(s, first);
		uint32_t own = nearest_to_middle(s, first, last);
		for (size_t j = first; j < last; j++)
			s->group[s->keyed[j].item] = own;
		chosen[own] = 1;
	}
	return chosen;
}

static bool is_chosen(const void *chosen, size_t point)
{
	return ((const uint8_t *)chosen)[point] != 0;
}

/* Numbers groups by the order of the points that stand for them. */
static bool number_groups(sorting_out *s, const gw_point_subset *subset)
{
	uint32_t *row = gw_allocate_array(s->tile->kept->count, sizeof *row);
	s->groups = (uint32_t)subset->points.count;
	for (uint32_t g = 0; row && g < s->groups; g++)
		row[subset->from[g]] = g;
	for (size_t j = 0; row && j < s->keys; j++)
		s->group[s->keyed[j].item] = row[s->group[s->keyed[j].item]];
	free(row);
	return row != NULL;
}

/* ------------------------------------------------------------------------------- what they send */

/* A part of the light of the points that were kept, and what it takes to find it. */
typedef struct part {
	const float *radiance, *less; /* what they send, W/(sr m^2); NULL, or what is none of it */
	const float *irradiance[2];   /* or what they receive, W/m^2, in two parts */
} part;

/* What a point reflects, times pi. */
static double reflected(const part *p, const float *albedo, size_t value)
{
	if (!p->radiance)
		return (double)albedo[value] *
			   ((double)p->irradiance[0][value] + (double)p->irradiance[1][value]);
	double less = p->less && p->less[value] > 0.0f ? (double)p->less[value] : 0.0;
	return M_PI * fmax((double)p->radiance[value] - less, 0.0);
}

/* The irradiance by which those that stand for others, with the mean of their albedo, send what all
 * of these send together. What reflects nothing needs none. */
static float *irradiance_of(const sorting_out *s, const part *p)
{
	const float *albedo = s->tile->light->albedo;
	float *result = gw_allocate_array(s->groups, 3 * sizeof *result);
	double *sum = gw_allocate_zeros(s->groups, 6 * sizeof *sum);
	for (size_t j = 0; result && sum && j < s->keys; j++) {
		size_t i = s->keyed[j].item;
		double *of = sum + 6 * (size_t)s->group[i];
		for (size_t c = 0; c < 3; c++) {
			of[c] += reflected(p, albedo, 3 * i + c);
			of[3 + c] += (double)albedo[3 * i + c];
		}
	}
	for (size_t i = 0; result && sum && i < 3 * (size_t)s->groups; i++) {
		const double *of = sum + 6 * (i / 3) + i % 3;
		result[i] = of[3] > 0.0 ? (float)(of[0] / of[3]) : 0.0f;
	}
	free(sum);
	if (sum)
		return result;
	free(result);
	return NULL;
}

static bool find_light(const sorting_out *s, gw_far_points *far)
{
	const gw_bake_result *light = s->tile->light;
	const part all = { .irradiance = { light->direct_irradiance, light->indirect_irradiance } };
	const part rest = { .radiance = light->rest, .less = s->tile->kept->emission };
	size_t lamps = light->lamp ? light->lamp_count : 0;
	far->all = irradiance_of(s, &all);
	far->rest = light->rest ? irradiance_of(s, &rest) : NULL;
	far->lamp = light->lamp ? gw_allocate_zeros(lamps + 1, sizeof *far->lamp) : NULL;
	bool good = far->all && (far->rest || !light->rest) && (far->lamp || !light->lamp);
	for (size_t k = 0; good && k < lamps; k++) {
		const part one = { .radiance = light->lamp[k] };
		far->lamps = k + 1;
		far->lamp[k] = irradiance_of(s, &one);
		good = far->lamp[k] != NULL;
	}
	return good;
}

/* -------------------------------------------------------------------------------- all of it */

static gw_status make(sorting_out *s, gw_far_points *far, gw_error *error)
{
	if (!find_boxes(s))
		return no_memory(s, error);
	count_glowing(s);
	GW_TRY(find_groups(s, error));
	uint8_t *chosen = choose(s);
	if (!chosen)
		return no_memory(s, error);
	const gw_subset_choice choice = { 1, 1, is_chosen, chosen, false };
	gw_status status = gw_point_subset_make(s->tile->kept, &choice, &far->subset, error);
	free(chosen);
	GW_TRY(status);
	bool good = number_groups(s, &far->subset) && find_light(s, far) &&
				gw_surface_points_take_means(s->tile->kept, s->group, &far->subset);
	return good ? GW_OK : no_memory(s, error);
}

gw_status gw_far_points_make(const gw_tile *tile, const gw_tile_lighting *lighting,
							 gw_far_points *far, gw_error *error)
{
	sorting_out s = { .tile = tile,
					  .lighting = lighting,
					  .spacing = (double)tile->light->report.spacing };
	*far = (gw_far_points){ .all = NULL };
	gw_status status = make(&s, far, error);
	free(s.group);
	free(s.keyed);
	return status;
}

void gw_far_points_clear(gw_far_points *far)
{
	for (size_t k = 0; k < far->lamps; k++)
		free(far->lamp[k]);
	free(far->lamp);
	free(far->all);
	free(far->rest);
	gw_point_subset_clear(&far->subset);
	*far = (gw_far_points){ .all = NULL };
}
