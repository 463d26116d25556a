/*
 * tile_light.c - the light of one tile of a cloud that memory does not hold; see gw_tile in
 * glowworm_parts.h.
 *
 * A tile is baked as a region of a scene that is small enough: all points of the tile and its halo,
 * and beyond it those few that were kept of the whole cloud, taken together with distance
 * (far_points.h). So what stands near is as fine as it was scanned, and what is far, whose light
 * comes from many places at once, is coarse.
 */
#include "bake/bake.h"
#include "bake/far_points.h"
#include "bake/options_check.h"
#include "bake/report.h"
#include "bake/scene.h"
#include "bake/surface_light.h"
#include "base/luminance.h"
#include "base/memory.h"
#include "cloud/neighbour_index.h"
#include "device/gpu.h"
#include "glowworm_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* No more can be asked for. */
#define ERROR_MOST 0.9

struct gw_tile_device {
	gw_gpu *gpu; /* NULL until the first tile is lit */
};

/* The points of a tile's scene: first those that are given, then those beyond. */
typedef struct tile_scene {
	gw_points points;
	gw_far_points far;
	uint8_t *asked;
	double *position;
	float *normal, *albedo, *emission, *opacity, *beam_share;
	uint8_t *stray;
	uint32_t *scanner_of;
	gw_known_light known;
	float *known_all, **known_lamp, *known_rest; /* of these */
} tile_scene;

static void clear(tile_scene *s)
{
	void *rows[] = { s->asked,   s->position,   s->normal, s->albedo,    s->emission,
					 s->opacity, s->beam_share, s->stray,  s->scanner_of };
	for (size_t k = 0; k < sizeof rows / sizeof *rows; k++)
		free(rows[k]);
	for (size_t k = 0; s->known_lamp && k < s->far.lamps; k++)
		free(s->known_lamp[k]);
	free(s->known_lamp);
	free(s->known_all);
	free(s->known_rest);
	gw_far_points_clear(&s->far);
}

/* --------------------------------------------------------------------------------- the points */

/* Values of both clouds, of `bytes` each; those of one that has none are `none`. */
typedef struct tile_values {
	const void *near, *far, *none;
	size_t bytes;
} tile_values;

static void add_rows(unsigned char *to, const void *values, size_t count, const tile_values *r)
{
	if (values)
		memcpy(to, values, count * r->bytes);
	for (size_t i = 0; !values && i < count; i++)
		memcpy(to + i * r->bytes, r->none, r->bytes);
}

/* Of the tile's points, then of those beyond. NULL where both clouds have none, or without memory,
 * which *good tells. */
static void *join_values(const tile_scene *s, size_t near, const tile_values *r, bool *good)
{
	size_t far = s->far.subset.points.count;
	if (!r->near && !r->far)
		return NULL;
	unsigned char *joined = gw_allocate_array(near + far, r->bytes);
	*good = *good && joined;
	if (joined) {
		add_rows(joined, r->near, near, r);
		add_rows(joined + near * r->bytes, r->far, far, r);
	}
	return joined;
}

/* Nobody noted which scanner saw the points of a tile: it is that of the nearest point of which it
 * is known. */
static bool find_scanners(const gw_tile *tile, tile_scene *s)
{
	const gw_points *kept = tile->kept, *near = tile->near;
	size_t rows = 0;
	float *place = gw_allocate_array(3 * kept->count, sizeof *place);
	uint32_t *row = gw_allocate_array(kept->count, sizeof *row);
	bool good = place && row;
	for (size_t i = 0; good && i < kept->count; i++) {
		const double *at = kept->position + 3 * i;
		if (!isfinite(at[0]) || !isfinite(at[1]) || !isfinite(at[2]))
			continue;
		for (size_t c = 0; c < 3; c++)
			place[3 * rows + c] = (float)(at[c] - kept->position[c]);
		row[rows++] = (uint32_t)i;
	}
	gw_neighbour_index *index = good && rows > 0 ? gw_neighbour_index_build(place, rows, 1) : NULL;
	for (size_t i = 0; index && i < near->count; i++) {
		float query[3], squared;
		int found;
		for (size_t c = 0; c < 3; c++)
			query[c] = (float)(near->position[3 * i + c] - kept->position[c]);
		if (gw_neighbour_index_search(index, query, 1, 1, &found, &squared))
			s->scanner_of[i] = kept->scanner_of[row[found]];
	}
	good = good && (index || rows == 0);
	gw_neighbour_index_free(index);
	free(place);
	free(row);
	return good;
}

static bool join_rows(const gw_tile *tile, tile_scene *s)
{
	static const double origin[3] = { 0 };
	static const float zero[3] = { 0 }, one = 1.0f;
	static const float plain[3] = { GW_ALBEDO_DEFAULT, GW_ALBEDO_DEFAULT, GW_ALBEDO_DEFAULT };
	const gw_points *near = tile->near, *far = &s->far.subset.points;
	const uint32_t nobody = UINT32_MAX;
	const uint8_t no = 0;
	size_t n = near->count, triple = 3 * sizeof(float);
	bool good = true;
	const tile_values of[] = { { near->position, far->position, origin, 3 * sizeof(double) },
							   { near->normal, far->normal, zero, triple },
							   { near->albedo, far->albedo, plain, triple },
							   { near->emission, far->emission, zero, triple },
							   { near->opacity, far->opacity, &one, sizeof one },
							   { near->beam_share, far->beam_share, &one, sizeof one },
							   { near->stray, far->stray, &no, 1 },
							   { NULL, far->scanner_of, &nobody, sizeof nobody } };
	s->position = join_values(s, n, &of[0], &good);
	s->normal = join_values(s, n, &of[1], &good);
	s->albedo = join_values(s, n, &of[2], &good);
	s->emission = join_values(s, n, &of[3], &good);
	s->opacity = join_values(s, n, &of[4], &good);
	s->beam_share = join_values(s, n, &of[5], &good);
	s->stray = join_values(s, n, &of[6], &good);
	s->scanner_of = join_values(s, n, &of[7], &good);
	return good && (!s->scanner_of || find_scanners(tile, s));
}

static bool join(const gw_tile *tile, tile_scene *s)
{
	if (!join_rows(tile, s))
		return false;
	size_t count = tile->near->count + s->far.subset.points.count;
	s->asked = gw_allocate_zeros(count, sizeof *s->asked);
	for (size_t i = 0; s->asked && i < tile->near->count; i++)
		s->asked[i] = tile->core[i];
	s->points = *tile->kept;
	s->points.count = count;
	s->points.position = s->position;
	s->points.normal = s->normal;
	s->points.albedo = s->albedo;
	s->points.emission = s->emission;
	s->points.opacity = s->opacity;
	s->points.beam_share = s->beam_share;
	s->points.stray = s->stray;
	s->points.scanner_of = s->scanner_of;
	return s->asked != NULL;
}

/* ------------------------------------------------------------------------------ what is known */

/* The irradiance of all points; that of the tile's is not known. */
static float *known(const gw_tile *tile, const tile_scene *s, const float *far)
{
	size_t near = 3 * tile->near->count;
	float *room = gw_allocate_array(s->points.count, 3 * sizeof *room);
	for (size_t i = 0; room && i < near; i++)
		room[i] = NAN;
	if (room)
		memcpy(room + near, far, 3 * s->far.subset.points.count * sizeof *room);
	return room;
}

/* The light of what lies beyond the tile, as all points that were kept have it. */
static bool take_known(const gw_tile *tile, tile_scene *s)
{
	const gw_far_points *far = &s->far;
	s->known_all = known(tile, s, far->all);
	s->known_rest = far->rest ? known(tile, s, far->rest) : NULL;
	s->known_lamp = gw_allocate_zeros(far->lamps + 1, sizeof *s->known_lamp);
	bool good = s->known_all && (s->known_rest || !far->rest) && s->known_lamp;
	for (size_t k = 0; good && k < far->lamps; k++) {
		s->known_lamp[k] = known(tile, s, far->lamp[k]);
		good = s->known_lamp[k] != NULL;
	}
	s->known = (gw_known_light){ s->known_all, far->lamp ? s->known_lamp : NULL, s->known_rest };
	return good;
}

/* ---------------------------------------------------------------------------------- the light */

/* Their mean luminance is what errors are relative to. */
static void take_share(const gw_tile *tile, const gw_bake_result *light, gw_tile_share *share)
{
	double sum = 0.0;
	size_t count = 0;
	for (size_t i = 0; i < tile->near->count; i++) {
		if (!tile->core[i] || gw_point_glows(tile->near, i))
			continue;
		sum += gw_luminance(light->radiance + 3 * i);
		count++;
	}
	*share = (gw_tile_share){ .points = count,
							  .radiance = count > 0 ? sum / (double)count : 0.0,
							  .checked = tile->checked,
							  .error = light->report.error };
}

gw_status gw_tile_device_open(gw_tile_device **device, gw_error *error)
{
	*device = gw_allocate_zeros(1, sizeof **device);
	return *device ? GW_OK : gw_fail(error, GW_ERROR_MEMORY, "no memory for a device");
}

void gw_tile_device_close(gw_tile_device **device)
{
	if (*device)
		gw_gpu_destroy(&(*device)->gpu);
	free(*device);
	*device = NULL;
}

/* Mean luminance of the points that were kept, or of those of them that a tile has. */
static double mean_of_kept(const gw_tile *tile, bool own)
{
	size_t count = own ? tile->replaced_count : tile->kept->count, used = 0;
	double sum = 0.0;
	for (size_t i = 0; i < count; i++) {
		size_t point = own ? tile->replaced[i] : i;
		if (point >= tile->kept->count || gw_point_glows(tile->kept, point))
			continue;
		sum += gw_luminance(tile->light->radiance + 3 * point);
		used++;
	}
	return used > 0 ? sum / (double)used : 0.0;
}

/* An error that is asked for is of the mean of the whole cloud: in a tile that is darker than that
 * it is more of the tile's own. */
static float error_for(const gw_tile *tile, float wanted)
{
	double all = mean_of_kept(tile, false), own = mean_of_kept(tile, true);
	double relative = own > 0.0 ? (double)wanted * all / own : 0.0;
	return (float)(relative > 0.0 ? fmin(relative, ERROR_MOST) : (double)wanted);
}

/* What a bake of one tile is to be, of what was asked for of the whole cloud. */
static gw_bake_options options_of(const gw_tile *tile, const gw_bake_options *options,
								  const gw_region *region)
{
	gw_bake_options own = gw_options_effective(options);
	own.region = region;
	own.surface_points = tile->checked ? (uint32_t)tile->kept->count : 0;
	if (own.max_error > 0.0f)
		own.max_error = error_for(tile, own.max_error);
	/* A dark one needs no more records than it would have in the whole cloud. */
	own.gathered_error = fmaxf(own.gathered_error, error_for(tile, own.gathered_error));
	/* Holes that scanners left are found in the whole cloud, and what they let through only where
	 * they are open and nobody asks for it. */
	if (own.gaps == GW_GAPS_OPEN && !own.unknown)
		own.effects_forbidden |= (1u << GW_EFFECT_GAPS) & ~own.effects_forced;
	return own;
}

/* Points without a place get no light, and are of the tile all the same. */
static void keep_placeless(const gw_tile *tile, gw_bake_result *light)
{
	for (size_t i = 0; light->asked && i < tile->near->count; i++)
		light->asked[i] = tile->core[i];
}

gw_status gw_tile_light(const gw_tile *tile, const gw_tile_lighting *lighting, gw_tile_share *share,
						gw_bake_result **light, gw_error *error)
{
	tile_scene s = { .asked = NULL };
	gw_gpu *own = NULL;
	*light = NULL;
	gw_status status = gw_far_points_make(tile, lighting, &s.far, error);
	if (status == GW_OK && !(join(tile, &s) && take_known(tile, &s)))
		status = gw_fail(error, GW_ERROR_MEMORY, "no memory for a tile of %zu points",
						 tile->near->count);
	const gw_region region = { .point = s.asked };
	const gw_scene_description scene = { &s.points, lighting->light, lighting->light_count };
	const gw_bake_options given = options_of(tile, lighting->options, &region);
	const gw_bake_manner manner = { .known = &s.known,
									.device = lighting->device ? &lighting->device->gpu : &own };
	if (status == GW_OK)
		status = gw_options_check(&given, &scene, error);
	if (status == GW_OK)
		status = tile->checked
					 ? gw_bake_checked(&scene, &given, manner, lighting->callbacks, light, error)
					 : gw_bake_once(&scene, &given, manner, lighting->callbacks, light, error);
	if (status == GW_OK)
		take_share(tile, *light, share);
	if (status == GW_OK)
		keep_placeless(tile, *light);
	if (status == GW_OK)
		(*light)->count = tile->near->count;
	gw_gpu_destroy(&own);
	clear(&s);
	return status;
}

/* --------------------------------------------------------------------------------- the report */

/* Squares of the errors of tiles, by how many points they have. */
typedef struct squares {
	double weight, radiance, square;
} squares;

static void add(squares *sum, const gw_tile_share *share, double relative)
{
	double weight = (double)share->points, error = relative * share->radiance;
	sum->weight += weight;
	sum->radiance += weight * share->radiance;
	sum->square += weight * error * error;
}

static double relative_of(const squares *sum)
{
	double mean = sum->radiance / fmax(sum->weight, 1.0);
	return mean > 0.0 ? sqrt(sum->square / fmax(sum->weight, 1.0)) / mean : 0.0;
}

/* The numbers of an estimate that are square roots of means of squares. */
static double *parts_of(gw_error_estimate *e, size_t part)
{
	double *const all[] = { &e->relative_rms, &e->gathered, &e->spread,   &e->noise,
							&e->shadows,      &e->normals,  &e->emission, &e->geometry,
							&e->gaps,         &e->sides,    &e->narrow,   &e->halves };
	return part < sizeof all / sizeof *all ? all[part] : NULL;
}

/* Whether bakes of half of the points say all that they can of a number. */
static bool asks_halves(const gw_error_estimate *e, const double *number)
{
	return number == &e->halves;
}

static void add_up(const gw_tile_share *share, size_t count, gw_error_estimate *all)
{
	double points = 0.0, bias = 0.0, radiance = 0.0, sides = 0.0;
	for (size_t part = 0; parts_of(all, part); part++) {
		squares sum = { 0 };
		for (size_t i = 0; i < count; i++) {
			gw_error_estimate own = share[i].error;
			if (share[i].checked || !asks_halves(all, parts_of(all, part)))
				add(&sum, &share[i], *parts_of(&own, part));
		}
		*parts_of(all, part) = relative_of(&sum);
	}
	for (size_t i = 0; i < count; i++) {
		double weight = (double)share[i].points;
		all->points += share[i].error.points;
		points += weight;
		radiance += weight * share[i].radiance;
		bias += weight * share[i].radiance * share[i].error.bias;
		sides += weight * share[i].error.sides_share;
	}
	all->bias = radiance > 0.0 ? bias / radiance : 0.0;
	all->sides_share = points > 0.0 ? sides / points : 0.0;
	all->relative_rms = fmax(all->relative_rms, all->halves);
}

/* Of a part of the error that the points that were kept tell by themselves, a tile knows only what
 * is near: holes that scanners left, and edges of what emits, whose light comes from afar. */
static void take_larger(double kept, double *part, double *all)
{
	if (!(kept > *part))
		return;
	*all = sqrt(fmax(*all * *all - *part * *part, 0.0) + kept * kept);
	*part = kept;
}

void gw_tiles_report(const gw_tile_share *share, size_t count, double wanted, gw_report *report)
{
	gw_error_estimate kept = report->error;
	report->error = (gw_error_estimate){ 0 };
	add_up(share, count, &report->error);
	take_larger(kept.gaps, &report->error.gaps, &report->error.relative_rms);
	take_larger(kept.emission, &report->error.emission, &report->error.relative_rms);
	report->price = (gw_price){ 0 };
	report->missed = false;
	report->goal = wanted > 0.0 ? GW_GOAL_REACHED : GW_GOAL_NONE;
	report->gathered_goal = GW_GOAL_NONE;
	report->round_count = 0;
	report->surface_points = 0;
	gw_report_count(report, "tiles", count,
					"tile{ is|s are} lit{| one after the other, each} by the surface of all of its "
					"points and of few beyond");
	gw_surface_light_hold_against(wanted, report);
}
