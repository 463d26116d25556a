/*
 * tile_light.c - the light of one tile of a cloud that memory does not hold; see gw_tile in
 * glowworm_parts.h.
 *
 * A tile is baked as a region of a scene that is small enough: all points of the tile and its halo,
 * and beyond it those few that were kept of the whole cloud. So what stands near is as fine as it
 * was scanned, and what is far, whose light comes from many places at once, is coarse.
 */
#include "bake/bake.h"
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

/* The points of a tile's scene: first those that are given, then those that were kept elsewhere. */
typedef struct tile_scene {
	gw_points points;
	uint32_t *beyond; /* of the points that were kept, those that come after */
	size_t beyond_count;
	uint8_t *asked;
	double *position;
	float *normal, *albedo, *emission, *opacity, *beam_share;
	uint8_t *stray;
	uint32_t *scanner_of;
	gw_known_light known;
	float *known_all, **known_lamp, *known_rest; /* of these */
	size_t lamps;
} tile_scene;

static void clear(tile_scene *s)
{
	void *rows[] = { s->beyond,   s->asked,   s->position,   s->normal, s->albedo,
					 s->emission, s->opacity, s->beam_share, s->stray,  s->scanner_of };
	for (size_t k = 0; k < sizeof rows / sizeof *rows; k++)
		free(rows[k]);
	for (size_t k = 0; s->known_lamp && k < s->lamps; k++)
		free(s->known_lamp[k]);
	free(s->known_lamp);
	free(s->known_all);
	free(s->known_rest);
}

/* --------------------------------------------------------------------------------- the points */

static bool list_beyond(const gw_tile *tile, tile_scene *s)
{
	size_t kept = tile->kept->count;
	uint8_t *replaced = gw_allocate_zeros(kept, 1);
	s->beyond = gw_allocate_array(kept, sizeof *s->beyond);
	for (size_t i = 0; replaced && i < tile->replaced_count; i++)
		if (tile->replaced[i] < kept)
			replaced[tile->replaced[i]] = 1;
	for (size_t i = 0; replaced && s->beyond && i < kept; i++)
		if (!replaced[i])
			s->beyond[s->beyond_count++] = (uint32_t)i;
	bool good = replaced && s->beyond;
	free(replaced);
	return good;
}

/* Values of both clouds, of `bytes` each; those of one that has none are `none`. */
typedef struct tile_values {
	const void *near, *kept, *none;
	size_t near_count, bytes;
} tile_values;

static const void *row_of(const void *values, size_t row, const tile_values *r)
{
	return values ? (const unsigned char *)values + row * r->bytes : r->none;
}

/* Of the tile's points, then of those beyond. NULL where both clouds have none, or without memory,
 * which *good tells. */
static void *join_values(const tile_scene *s, const tile_values *r, bool *good)
{
	if (!r->near && !r->kept)
		return NULL;
	unsigned char *joined = gw_allocate_array(r->near_count + s->beyond_count, r->bytes);
	*good = *good && joined;
	for (size_t i = 0; joined && i < r->near_count; i++)
		memcpy(joined + i * r->bytes, row_of(r->near, i, r), r->bytes);
	for (size_t i = 0; joined && i < s->beyond_count; i++)
		memcpy(joined + (r->near_count + i) * r->bytes, row_of(r->kept, s->beyond[i], r), r->bytes);
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
	static const float zero[3] = { 0 }, one = 1.0f;
	static const float plain[3] = { GW_ALBEDO_DEFAULT, GW_ALBEDO_DEFAULT, GW_ALBEDO_DEFAULT };
	const gw_points *near = tile->near, *kept = tile->kept;
	const uint32_t nobody = UINT32_MAX;
	const uint8_t no = 0;
	size_t n = near->count, triple = 3 * sizeof(float);
	bool good = true;
	const tile_values of[] = { { near->position, kept->position, NULL, n, 3 * sizeof(double) },
							   { near->normal, kept->normal, zero, n, triple },
							   { near->albedo, kept->albedo, plain, n, triple },
							   { near->emission, kept->emission, zero, n, triple },
							   { near->opacity, kept->opacity, &one, n, sizeof one },
							   { near->beam_share, kept->beam_share, &one, n, sizeof one },
							   { near->stray, kept->stray, &no, n, 1 },
							   { NULL, kept->scanner_of, &nobody, n, sizeof nobody } };
	s->position = join_values(s, &of[0], &good);
	s->normal = join_values(s, &of[1], &good);
	s->albedo = join_values(s, &of[2], &good);
	s->emission = join_values(s, &of[3], &good);
	s->opacity = join_values(s, &of[4], &good);
	s->beam_share = join_values(s, &of[5], &good);
	s->stray = join_values(s, &of[6], &good);
	s->scanner_of = join_values(s, &of[7], &good);
	return good && (!s->scanner_of || find_scanners(tile, s));
}

static bool join(const gw_tile *tile, tile_scene *s)
{
	if (!list_beyond(tile, s) || !join_rows(tile, s))
		return false;
	size_t count = tile->near->count + s->beyond_count;
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

/* Room for the irradiance of points; that of the tile's is not known. */
static float *unknown(const tile_scene *s)
{
	float *room = gw_allocate_array(s->points.count, 3 * sizeof *room);
	for (size_t i = 0; room && i < 3 * s->points.count; i++)
		room[i] = NAN;
	return room;
}

/* The irradiance whose reflection is a part of the light that was kept; what reflects nothing needs
 * none. */
static float *reflected(const gw_tile *tile, const tile_scene *s, const float *radiance)
{
	float *known = unknown(s);
	const float *albedo = tile->light->albedo;
	for (size_t i = 0; known && i < s->beyond_count; i++)
		for (size_t c = 0; c < 3; c++) {
			size_t from = 3 * (size_t)s->beyond[i] + c;
			known[3 * (tile->near->count + i) + c] =
				albedo[from] > 0.0f ? (float)M_PI * radiance[from] / albedo[from] : 0.0f;
		}
	return known;
}

static bool take_lamps(const gw_tile *tile, tile_scene *s)
{
	const gw_bake_result *light = tile->light;
	bool good = true;
	s->lamps = light->lamp ? light->lamp_count : 0;
	s->known_lamp = gw_allocate_zeros(s->lamps + 1, sizeof *s->known_lamp);
	for (size_t k = 0; s->known_lamp && k < s->lamps && good; k++) {
		s->known_lamp[k] = reflected(tile, s, light->lamp[k]);
		good = s->known_lamp[k] != NULL;
	}
	return good && s->known_lamp;
}

/* What emits adds its emission to the columns of the rest, which no irradiance makes. */
static bool take_rest(const gw_tile *tile, tile_scene *s)
{
	const gw_bake_result *light = tile->light;
	const float *emission = tile->kept->emission;
	if (!light->rest)
		return true;
	float *sent = gw_allocate_array(tile->kept->count, 3 * sizeof *sent);
	for (size_t i = 0; sent && i < 3 * tile->kept->count; i++)
		sent[i] =
			fmaxf(light->rest[i] - (emission && emission[i] > 0.0f ? emission[i] : 0.0f), 0.0f);
	s->known_rest = sent ? reflected(tile, s, sent) : NULL;
	free(sent);
	return s->known_rest != NULL;
}

/* The light of what lies beyond the tile, as all points that were kept have it. */
static bool take_known(const gw_tile *tile, tile_scene *s)
{
	const gw_bake_result *light = tile->light;
	s->known_all = unknown(s);
	for (size_t i = 0; s->known_all && i < s->beyond_count; i++)
		for (size_t c = 0; c < 3; c++) {
			size_t from = 3 * (size_t)s->beyond[i] + c;
			s->known_all[3 * (tile->near->count + i) + c] =
				light->direct_irradiance[from] + light->indirect_irradiance[from];
		}
	if (!s->known_all || !take_lamps(tile, s) || !take_rest(tile, s))
		return false;
	s->known = (gw_known_light){ s->known_all, light->lamp ? s->known_lamp : NULL, s->known_rest };
	return true;
}

/* ---------------------------------------------------------------------------------- the light */

static bool glows(const gw_points *points, size_t point)
{
	const float *e = points->emission ? points->emission + 3 * point : NULL;
	return e && (e[0] > 0.0f || e[1] > 0.0f || e[2] > 0.0f);
}

/* Their mean luminance is what errors are relative to. */
static void take_share(const gw_tile *tile, const gw_bake_result *light, gw_tile_share *share)
{
	double sum = 0.0;
	size_t count = 0;
	for (size_t i = 0; i < tile->near->count; i++) {
		if (!tile->core[i] || glows(tile->near, i))
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
		if (point >= tile->kept->count || glows(tile->kept, point))
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

gw_status gw_tile_light(const gw_tile *tile, const gw_tile_lighting *lighting, gw_tile_share *share,
						gw_bake_result **light, gw_error *error)
{
	tile_scene s = { .beyond = NULL };
	gw_gpu *own = NULL;
	*light = NULL;
	gw_status status = join(tile, &s) && take_known(tile, &s)
						   ? GW_OK
						   : gw_fail(error, GW_ERROR_MEMORY, "no memory for a tile of %zu points",
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
	report->round_count = 0;
	report->surface_points = 0;
	gw_report_count(report, "tiles", count,
					"tile{ is|s are} lit one after the other, each by the surface of all of its "
					"points and of few beyond");
	gw_surface_light_hold_against(wanted, report);
}
