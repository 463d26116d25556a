/*
 * record_density.c - see record_density.h.
 */
#include "bake/record_density.h"

#include "base/luminance.h"
#include "base/memory.h"
#include "light/transport_layout.h"

#include <math.h>
#include <stdlib.h>

/* Largest factor of one record at a time: what the others say of its surroundings reaches no
 * further. */
#define FACTOR_MOST 16.0f

/* Where records would become less than so many times as many, all stays as it is. */
#define FACTOR_LEAST 1.05

/* A point for which one record speaks: nothing is known of its error, but that it is rather a part
 * of what was found than all of it. */
#define LONELY_SHARE 0.25

/* Halvings of the interval in which the multiplier lies, more than a double has bits. */
#define HALVINGS 100

/* What the records of one lighting say. */
typedef struct density_work {
	double *light;                                 /* records: luminance of irradiance */
	double *mass;                                  /* records */
	float *most, *factor;                          /* records */
	gw_view facet_row, facet_record, facet_weight; /* of gw_records */
	size_t records, facets;
	float least; /* spacing, leaf cells */
} density_work;

/* ------------------------------------------------------------------------------------ factors */

typedef struct level_sums {
	double left; /* of mass that is left */
	double all;  /* of the factors */
} level_sums;

/* With factors that follow the root of mass / level. */
static level_sums try_level(const double *mass, const float *most, size_t count, double level,
							float *factor)
{
	level_sums sums = { 0.0, 0.0 };
	for (size_t i = 0; i < count; i++) {
		double f = fmin(fmax(sqrt(mass[i] / level), 1.0), (double)most[i]);
		factor[i] = (float)f;
		sums.left += mass[i] / f;
		sums.all += f;
	}
	return sums;
}

double gw_density_factors(const double *mass, const float *most, size_t count,
						  const gw_density_wish *wish, float *factor)
{
	double sum = 0.0, largest = 0.0;
	for (size_t i = 0; i < count; i++) {
		sum += mass[i];
		largest = fmax(largest, mass[i]);
		factor[i] = 1.0f;
	}
	if (!(sum > 0.0))
		return 1.0;
	/* At the largest mass all factors are 1; at the low end they are more than any can be. */
	double low = log(largest) - 80.0, high = log(largest);
	for (int i = 0; i < HALVINGS; i++) {
		double middle = 0.5 * (low + high);
		level_sums now = try_level(mass, most, count, exp(middle), factor);
		bool enough = now.left <= wish->share * sum || now.all > wish->most_growth * (double)count;
		*(enough ? &low : &high) = middle;
	}
	return try_level(mass, most, count, exp(high), factor).left / sum;
}

/* --------------------------------------------------------------------------------------- mass */

/* Every surfel's variance of radiance to the records that speak for it. Those that emit outshine
 * theirs, and of those lit from both sides at once the estimate knows nothing either. */
static void spread_mass(const gw_scene *s, density_work *w)
{
	const gw_surfels *surfels = &s->surfels;
	const gw_read_back *rows = &s->read_back;
	for (size_t i = 0; i < surfels->count; i++) {
		const float *emission = surfels->emission ? surfels->emission + 3 * i : NULL;
		if (!gw_surfels_one_sided(surfels, i) || (s->region.asked && !s->region.asked[i]) ||
			(emission && gw_luminance(emission) > 0.0))
			continue;
		double rho = gw_luminance(surfels->albedo + 3 * i);
		double variance = rho * rho * gw_read_back_variance(rows, w->light, i, LONELY_SHARE);
		for (uint32_t e = rows->first[i]; e < rows->first[i + 1]; e++)
			w->mass[rows->record[e]] += (double)rows->weight[e] * variance;
	}
}

/* ------------------------------------------------------------------------------------ spacing */

/* Whether the spacing becomes less. */
static bool come_closer(float *spacing, double factor, float least)
{
	float before = *spacing;
	if (factor > FACTOR_LEAST)
		*spacing = fminf(fmaxf(before / (float)sqrt(factor), least), before);
	return *spacing < before;
}

/* Factors between records are interpolated as light is. */
static void refine_facets(const density_work *w, gw_record_density *density)
{
	const uint32_t *row = w->facet_row.bytes;
	for (size_t facet = 0; facet < w->facets; facet++) {
		const uint32_t *record = (const uint32_t *)w->facet_record.bytes + GW_WEIGHTS * row[facet];
		const float *weight = (const float *)w->facet_weight.bytes + GW_WEIGHTS * row[facet];
		double factor = 0.0;
		for (size_t k = 0; k < GW_WEIGHTS && record[k] != GW_NONE; k++)
			factor += (double)weight[k] * (double)w->factor[record[k]];
		density->facet_closer[facet] =
			come_closer(&density->facet_spacing[facet], factor, w->least);
	}
}

static void refine_surfels(const gw_read_back *rows, const density_work *w,
						   gw_record_density *density)
{
	for (size_t i = 0; i < rows->count; i++) {
		double factor = 0.0;
		for (uint32_t e = rows->first[i]; e < rows->first[i + 1]; e++)
			factor += (double)rows->weight[e] * (double)w->factor[rows->record[e]];
		density->surfel_closer[i] = come_closer(&density->surfel_spacing[i], factor, w->least);
	}
}

/* The spacings of all records, where none of their own are known yet. */
static void begin_spacings(gw_scene *s, size_t facets)
{
	const gw_region_needs *region = &s->region;
	float spacing = region->facet_spacing ? region->spacing : s->records.spacing;
	for (size_t i = 0; i < facets; i++)
		s->density.facet_spacing[i] = region->facet_spacing ? region->facet_spacing[i] : spacing;
	for (size_t i = 0; i < s->surfels.count; i++)
		s->density.surfel_spacing[i] = spacing;
}

static bool make_density(gw_scene *s, size_t facets)
{
	gw_record_density *d = &s->density;
	bool first = d->facet_spacing == NULL;
	if (first) {
		d->facet_spacing = gw_allocate_array(facets, sizeof(float));
		d->surfel_spacing = gw_allocate_array(s->surfels.count, sizeof(float));
	}
	if (!d->facet_closer) {
		d->facet_closer = gw_allocate_array(facets, sizeof(bool));
		d->surfel_closer = gw_allocate_array(s->surfels.count, sizeof(bool));
	}
	if (!d->facet_spacing || !d->surfel_spacing || !d->facet_closer || !d->surfel_closer)
		return false;
	if (first)
		begin_spacings(s, facets);
	return true;
}

static gw_status begin(gw_scene *s, density_work *w, gw_error *error)
{
	*w = (density_work){ .records = s->records.count, .facets = s->octree.facet_count };
	uint64_t bytes = 4 * GW_WEIGHTS * (uint64_t)s->records.row_count;
	w->light = gw_allocate_zeros(w->records, sizeof *w->light);
	w->mass = gw_allocate_zeros(w->records, sizeof *w->mass);
	w->most = gw_allocate_array(w->records, sizeof *w->most);
	w->factor = gw_allocate_array(w->records, sizeof *w->factor);
	if (!w->light || !w->mass || !w->most || !w->factor || !make_density(s, w->facets))
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to refine %zu records", w->records);
	GW_TRY(
		gw_view_open(s->gpu, &s->records.facet_row, 4 * (uint64_t)w->facets, &w->facet_row, error));
	GW_TRY(gw_view_open(s->gpu, &s->records.facet_record, bytes, &w->facet_record, error));
	return gw_view_open(s->gpu, &s->records.facet_weight, bytes, &w->facet_weight, error);
}

gw_status gw_record_density_refine(const gw_lighting *lighting, const gw_density_wish *wish,
								   double *growth, gw_error *error)
{
	gw_scene *s = lighting->scene;
	gw_record_density *density = &s->density;
	density_work w;
	*growth = 1.0;
	gw_status status = begin(s, &w, error);
	w.least = wish->least;
	if (status == GW_OK)
		status = gw_records_light(s->gpu, &s->records, w.light, error);
	if (status == GW_OK) {
		double sum = 0.0;
		spread_mass(s, &w);
		for (size_t i = 0; i < w.records; i++) {
			uint32_t facet = s->records.facet[i] & ~GW_RECORD_BACK;
			float room = density->facet_spacing[facet] / wish->least;
			w.most[i] = fminf(fmaxf(room * room, 1.0f), FACTOR_MOST);
		}
		gw_density_factors(w.mass, w.most, w.records, wish, w.factor);
		for (size_t i = 0; i < w.records; i++)
			sum += (double)w.factor[i];
		*growth = w.records > 0 ? sum / (double)w.records : 1.0;
		refine_facets(&w, density);
		refine_surfels(&s->read_back, &w, density);
	}
	free(w.light);
	free(w.mass);
	free(w.most);
	free(w.factor);
	gw_view_close(&w.facet_row);
	gw_view_close(&w.facet_record);
	gw_view_close(&w.facet_weight);
	return status;
}
