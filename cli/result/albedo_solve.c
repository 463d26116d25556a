/* albedo_solve.c - see albedo_solve.h. */
#include "result/albedo_solve.h"
#include "points/scan_color.h"
#include "points/scan_intensity.h"
#include "program/signals.h"
#include "result/albedo_clipped.h"
#include "result/albedo_remainder.h"
#include "result/albedo_stations.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Rounds at most, and the mean change of the albedo at which they end. */
#define ROUNDS 8
#define CHANGE_SMALL 0.003

/* How far a round goes towards what it found, in logarithms: where much of the light was reflected
 * before, going all the way would swing to and fro. */
#define STEP 0.75

/* The brightest surfaces, of which so many are brighter, and their albedo. */
#define BRIGHT_SHARE 0.02
#define BRIGHT_ALBEDO 0.8

/* Points with less than this share of the median irradiance are dark: stray light of the camera and
 * of the estimate outweigh what reaches them. */
#define DARK_SHARE 0.01

/* Points with less than this share of it are dim: they say nothing of the exposure. */
#define DIM_SHARE 0.3

/* A flash lights what its scanner sees; steps of a quantised depth look more oblique than they are.
 */
#define FLASH_COSINE_LEAST 0.3

/* A black value may be so much: half a step of 8 bits, linear. */
#define BLACK_VALUE 0.002f

enum { LIT, DIM, DARK };

typedef struct solve {
	loaded_scene *scene;
	const settings *settings;
	const gw_light *light;
	size_t light_count;
	bool flash;
	float *photo;  /* 3 * count, linear colours, owned */
	float *level;  /* 3 * count: irradiance, then pi times the colour over it; owned */
	float *sorted; /* count, scratch; owned */
	float *normal; /* 3 * count, of the last bake; owned */
	uint8_t *dark; /* count: LIT, DIM or DARK; owned */
	uint8_t *ends; /* count: which values are clipped (albedo_clipped.h); owned */
	albedo_facts *facts;
	gw_error *error;
} solve;

static size_t count_of(const solve *w)
{
	return w->scene->cloud.count;
}

static float luminance(const float c[3])
{
	return (float)gw_relative_luminance((double)c[0], (double)c[1], (double)c[2]);
}

static float largest(const float c[3])
{
	return fmaxf(fmaxf(c[0], c[1]), c[2]);
}

static int compare_floats(const void *a, const void *b)
{
	float x = *(const float *)a, y = *(const float *)b;
	return (x > y) - (x < y);
}

/* The value below which a share of the points lies, of those that are above 0. */
static float quantile(const solve *w, float (*measure)(const float *), const float *values,
					  double share)
{
	size_t used = 0;
	for (size_t i = 0; i < count_of(w); i++) {
		float v = measure(values + 3 * i);
		if (v > 0.0f && isfinite(v) && !(w->dark && w->dark[i]) && !w->ends[i])
			w->sorted[used++] = v;
	}
	qsort(w->sorted, used, sizeof *w->sorted, compare_floats);
	return used ? w->sorted[(size_t)(share * (double)(used - 1))] : 0.0f;
}

static float bounded(const solve *w, float rho)
{
	(void)w;
	return fminf(fmaxf(rho, ALBEDO_SOLVE_LEAST), ALBEDO_SOLVE_MOST);
}

/* --------------------------------------------------------------------------------- one round */

/* What a lamp sends straight to a point that nothing hides from it. */
static float straight_light(const gw_light *l, const double *p, const float *n)
{
	double squared = 0.0, along = 0.0;
	for (int k = 0; k < 3; k++) {
		double d = l->position[k] - p[k];
		squared += d * d;
		along += d * (double)n[k];
	}
	double cosine = fmax(fabs(along) / sqrt(squared), FLASH_COSINE_LEAST);
	return squared > 0.0 && isfinite(squared) ? (float)(cosine / squared) : 0.0f;
}

/*
 * Irradiance of a point: of all lights, or of the flash of the scanner that saw it. What a scanner
 * saw its flash lit, whatever gaps and rims of the points say of shadows.
 */
static void take_irradiance(const solve *w, const gw_bake_result *r, size_t i, float e[3])
{
	const gw_points *p = &w->scene->points.points;
	uint32_t own = p->scanner_of ? p->scanner_of[i] : 0;
	bool seen = w->flash && (p->scanner_of ? own < w->light_count : w->light_count == 1);
	float straight =
		seen ? straight_light(&w->light[own], p->position + 3 * i, r->normal + 3 * i) : 0.0f;
	for (size_t k = 0; k < 3; k++) {
		size_t at = 3 * i + k;
		e[k] = r->direct_irradiance[at] + r->indirect_irradiance[at];
		if (seen)
			e[k] = straight * w->light[own].intensity[k] + r->indirect_irradiance[at];
		if (seen && w->light_count > 1 && r->albedo[at] > 0.0f)
			e[k] = fmaxf(straight * w->light[own].intensity[k],
						 (float)M_PI * r->lamp[own][at] / r->albedo[at]);
	}
}

static gw_status bake_light(solve *w)
{
	gw_bake_options options = w->settings->bake;
	gw_bake_result *r = NULL;
	options.estimate_points = 0;
	options.lamps = w->flash && w->light_count > 1;
	const gw_scene_description scene = { &w->scene->points.points, w->light, w->light_count };
	gw_status status =
		gw_bake(&scene, &options, &(gw_bake_callbacks){ .cancelled = NULL }, &r, w->error);
	for (size_t i = 0; status == GW_OK && i < count_of(w); i++)
		take_irradiance(w, r, i, w->level + 3 * i);
	if (status == GW_OK)
		memcpy(w->normal, r->normal, 3 * count_of(w) * sizeof *w->normal);
	gw_bake_result_destroy(&r);
	return status == GW_OK ? signals_check(w->error) : status;
}

/* Marks points without light, once, so that rounds agree which those are. */
static gw_status find_dark(solve *w)
{
	float median = quantile(w, luminance, w->level, 0.5);
	w->dark = calloc(count_of(w), 1);
	if (!w->dark)
		return gw_fail(w->error, GW_ERROR_MEMORY, "no memory for %zu points", count_of(w));
	if (!(median > 0.0f))
		return gw_fail(w->error, GW_ERROR_DATA,
					   "the light of the capture reaches no point; say where the lamps stood with "
					   "--light, or which side surfaces show with --normals or --scanner");
	for (size_t i = 0; i < count_of(w); i++) {
		float own = luminance(w->level + 3 * i) / median;
		w->dark[i] = own >= (float)DIM_SHARE ? LIT : own > (float)DARK_SHARE ? DIM : DARK;
		const double *p = w->scene->points.points.position + 3 * i;
		w->facts->dark += w->dark[i] == DARK && isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2]);
	}
	return GW_OK;
}

/* What the colours leave when the light is taken out of them: albedo, up to one factor. */
static void divide(solve *w)
{
	for (size_t i = 0; i < 3 * count_of(w); i++) {
		float e = w->level[i];
		bool black = w->ends[i / 3] & ALBEDO_BLACK(i % 3);
		float photo = black ? BLACK_VALUE : w->photo[i];
		w->level[i] = e > 0.0f && w->dark[i / 3] != DARK ? (float)M_PI * photo / e : 0.0f;
	}
}

/* What is clipped has the level of what is around. */
static gw_status fill_clipped(solve *w)
{
	uint8_t *known = calloc(count_of(w), 1);
	if (!known)
		return gw_fail(w->error, GW_ERROR_MEMORY, "no memory for %zu points", count_of(w));
	for (size_t i = 0; i < count_of(w); i++)
		known[i] = w->dark[i] != DARK;
	gw_status status =
		albedo_clipped_fill(&w->scene->points.points, w->ends, known, w->level, w->error);
	free(known);
	return status;
}

static double find_scale(solve *w)
{
	double scale = (double)w->settings->capture_scale;
	if (!(scale > 0.0))
		scale = (double)quantile(w, largest, w->level, 1.0 - BRIGHT_SHARE) / BRIGHT_ALBEDO;
	return scale > 0.0 ? scale : 1.0;
}

/* A dark point has the level of the median, and the chroma of its colour. */
static void fill_dark(solve *w)
{
	float *albedo = w->scene->points.albedo;
	float median = quantile(w, luminance, albedo, 0.5);
	for (size_t i = 0; i < count_of(w); i++) {
		const float *c = w->photo + 3 * i;
		float own = luminance(c);
		for (size_t k = 0; w->dark[i] == DARK && k < 3; k++)
			albedo[3 * i + k] = bounded(w, own > 0.0f ? median * c[k] / own : median);
	}
}

/* Moves the albedo to what was found; returns by how much, the mean of the relative changes. */
static double take_step(solve *w, double step)
{
	float *albedo = w->scene->points.albedo;
	double change = 0.0;
	size_t used = 0;
	w->facts->clipped = 0;
	for (size_t i = 0; i < 3 * count_of(w); i++) {
		if (w->dark[i / 3] == DARK)
			continue;
		float found = w->level[i] / (float)w->facts->scale, to = bounded(w, found);
		double ratio = (double)to / (double)bounded(w, albedo[i]);
		w->facts->clipped += i % 3 == 0 && found > 1.0f;
		albedo[i] = bounded(w, bounded(w, albedo[i]) * (float)pow(ratio, step));
		change += fabs(log(ratio));
		used++;
	}
	fill_dark(w);
	return used ? change / (double)used : 0.0;
}

static gw_status run_rounds(solve *w)
{
	for (int round = 0; round < ROUNDS; round++) {
		GW_TRY(bake_light(w));
		if (round == 0)
			GW_TRY(find_dark(w));
		divide(w);
		GW_TRY(albedo_stations_level(w->scene, w->ends, w->level, w->error));
		if (w->settings->remainder == SETTINGS_REMAINDER_LIGHT)
			GW_TRY(albedo_remainder_divide(&w->scene->points.points, w->normal, w->ends, w->level,
										   &w->facts->remainder, w->error));
		w->facts->scale = find_scale(w);
		GW_TRY(fill_clipped(w));
		w->facts->change = take_step(w, round == 0 ? 1.0 : STEP);
		w->facts->rounds = round + 1;
		if (round > 0 && w->facts->change < CHANGE_SMALL)
			break;
	}
	return GW_OK;
}

/* ------------------------------------------------------------------------------- all of it */

static gw_status start(solve *w)
{
	size_t n = 3 * count_of(w);
	w->photo = reallocarray(NULL, n, sizeof *w->photo);
	w->level = reallocarray(NULL, n, sizeof *w->level);
	w->sorted = reallocarray(NULL, count_of(w), sizeof *w->sorted);
	w->normal = reallocarray(NULL, n, sizeof *w->normal);
	w->ends = calloc(count_of(w), 1);
	if (!w->photo || !w->level || !w->sorted || !w->normal || !w->ends)
		return gw_fail(w->error, GW_ERROR_MEMORY, "no memory for the light of %zu points",
					   count_of(w));
	float *albedo = w->scene->points.albedo;
	for (size_t i = 0; i < n; i++)
		w->photo[i] = isfinite(albedo[i]) && albedo[i] > 0.0f ? albedo[i] : 0.0f;
	return GW_OK;
}

static void finish(solve *w)
{
	free(w->photo);
	free(w->level);
	free(w->sorted);
	free(w->normal);
	free(w->dark);
	free(w->ends);
}

/* What a first guess of the albedo needs: colours, the brightest of which are bright surfaces. */
static void guess(solve *w)
{
	float bright = quantile(w, largest, w->photo, 1.0 - BRIGHT_SHARE);
	for (size_t i = 0; i < 3 * count_of(w); i++)
		w->scene->points.albedo[i] =
			bounded(w, bright > 0.0f ? (float)BRIGHT_ALBEDO * w->photo[i] / bright : 0.5f);
}

/* Colours of classes or of a drawing are no photographs, and say nothing of light. */
static gw_status check_photo(const solve *w)
{
	if (w->facts->ends < count_of(w))
		return GW_OK;
	return gw_fail(w->error, GW_ERROR_DATA,
				   "red, green or blue of each point is 0 or full, as in the colours of classes: "
				   "they do not say how much light fell on any; bake takes them as they are, and "
				   "with --albedo constant:V none of them");
}

gw_status albedo_solve(loaded_scene *scene, const settings *s, const albedo_setup *setup,
					   albedo_facts *facts, gw_error *error)
{
	*facts = (albedo_facts){ 0 };
	solve w = { .scene = scene,
				.settings = s,
				.light = setup->light,
				.light_count = setup->light_count,
				.flash = setup->flash,
				.facts = facts,
				.error = error };
	gw_status status = start(&w);
	if (status == GW_OK) {
		facts->ends = albedo_clipped_find(w.photo, count_of(&w), w.ends);
		status = check_photo(&w);
	}
	if (status == GW_OK) {
		guess(&w);
		status = run_rounds(&w);
	}
	finish(&w);
	return status;
}

gw_status albedo_of_laser(loaded_scene *scene, const settings *s, albedo_facts *facts,
						  gw_error *error)
{
	*facts = (albedo_facts){ 0 };
	solve w = { .scene = scene, .settings = s, .facts = facts, .error = error };
	float *echo = NULL;
	gw_status status = start(&w);
	if (status == GW_OK)
		status = scan_intensity_make(&scene->cloud, s->bake.threads, &echo, facts->how, error);
	for (size_t i = 0; status == GW_OK && i < 3 * count_of(&w); i++)
		w.level[i] = isfinite(echo[i / 3]) ? fmaxf(echo[i / 3], 0.0f) : 0.0f;
	free(echo);
	float bright = status == GW_OK ? quantile(&w, largest, w.level, 1.0 - BRIGHT_SHARE) : 0.0f;
	if (status == GW_OK && !(bright > 0.0f))
		status = gw_fail(error, GW_ERROR_DATA,
						 "the laser's intensity is zero almost everywhere; "
						 "name the light of the photographs with --capture");
	for (size_t i = 0; status == GW_OK && i < count_of(&w); i++) {
		const float *c = w.photo + 3 * i;
		float level = (float)BRIGHT_ALBEDO * w.level[3 * i] / bright, own = luminance(c);
		for (size_t k = 0; k < 3; k++)
			scene->points.albedo[3 * i + k] = bounded(&w, own > 0.0f ? level * c[k] / own : level);
	}
	facts->scale = 1.0;
	finish(&w);
	return status;
}
