/*
 * region_records.c - see region_records.h.
 */
#include "bake/region_records.h"

#include "bake/options_check.h"
#include "bake/scene_records.h"
#include "base/luminance.h"
#include "base/memory.h"
#include "light/needed_facets.h"
#include "light/transport_layout.h"
#include "surfels/surfel_backs.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Records that the region's depend on stand so many times as far apart. In a cave of 300,000 points
 * the light of three regions is as near to that of the whole bake with 2 as with 4 or 6. */
#define WIDER 4.0f

/* Of records with a given spacing there are about so many on a surface of area 1: random darts that
 * keep their distance cover 0.547 of a plane by discs of half of it (Renyi's parking in the
 * plane). */
#define DARTS 0.69

/* Records of a region that are being placed. */
typedef struct placing {
	gw_scene *scene;
	gw_needed_facets needed;
	float *wanted;   /* a facet: spacing on those whose records are to be placed now */
	uint32_t *hit;   /* what the rays of the newest records hit */
	uint32_t traced; /* records that there were before these */
} placing;

/* The spacing of a bake of the whole: where records would be few, they stand closer, and where they
 * would be many, farther apart at first. */
static gw_status choose_spacing(const placing *p, float *spacing, gw_error *error)
{
	gw_scene *s = p->scene;
	const gw_record_wish wish = gw_scene_wish_records(s, &s->options);
	double area = 0.0;
	*spacing = fmaxf(wish.spacing, GW_RECORD_SPACING_LEAST);
	for (size_t i = 0; i < p->needed.facets; i++)
		area += (double)p->needed.centre[4 * i + 3];
	/* A factor of 2 either way leaves room for what is not flat. */
	double expected = DARTS * area / ((double)*spacing * (double)*spacing);
	if (expected > 2.0 * wish.least && (wish.most == 0 || 2.0 * expected < wish.most))
		return GW_OK;
	const gw_record_context on = gw_scene_context(s, &s->records);
	GW_TRY(gw_records_place(&on, &wish, error));
	*spacing = fmaxf(s->records.spacing, GW_RECORD_SPACING_LEAST);
	gw_records_destroy(s->gpu, &s->records);
	return GW_OK;
}

/* The records from `first` on, by themselves, in scene->further. */
static gw_status trace_further(placing *p, gw_error *error)
{
	gw_scene *s = p->scene;
	const gw_record_context on = gw_scene_context(s, &s->records);
	const gw_record_context further = gw_scene_context(s, &s->further);
	const gw_bake_options *o = &s->options;
	if (p->traced == 0) {
		GW_TRY(gw_ray_gather_trace(&on, o->rays, (uint32_t)o->seed, &s->rays, error));
	} else {
		GW_TRY(gw_scene_list_further(s, p->traced, error));
		GW_TRY(gw_ray_gather_add(&further, &s->rays, &s->further_rays, error));
	}
	const gw_buffer *hits = p->traced == 0 ? &s->rays.facet : &s->further_rays.facet;
	size_t count = (size_t)(s->records.count - p->traced) * o->rays;
	uint32_t *grown = gw_resize_array(p->hit, count, sizeof *grown);
	if (!grown)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for what %zu rays hit", count);
	p->hit = grown;
	GW_TRY(gw_buffer_download(s->gpu, hits, 0, p->hit, 4 * (uint64_t)count, error));
	gw_scene_forget_further(s);
	return GW_OK;
}

/* Places records on the facets that have this spacing by now and had none before, and traces them.
 * widest: of all spacings so far. */
static gw_status place(placing *p, float widest, gw_error *error)
{
	gw_scene *s = p->scene;
	const gw_record_context on = gw_scene_context(s, &s->records);
	s->records.spacing = widest;
	p->traced = s->records.count;
	GW_TRY(gw_records_add(&on, s->options.seed, p->wanted, error));
	return s->records.count > p->traced ? trace_further(p, error) : GW_OK;
}

/* So many reflections further on, light matters less than the tolerance. */
static uint32_t levels_that_matter(const gw_scene *scene)
{
	const gw_surfels *s = &scene->surfels;
	const gw_bake_options *o = &scene->options;
	double area = 0.0, kept = 0.0;
	for (size_t i = 0; i < s->count; i++) {
		area += (double)s->area[i];
		kept += (double)s->area[i] * gw_luminance(s->albedo + 3 * i);
	}
	kept = fmin(fmax(kept / fmax(area, 1e-30), 1e-3), (double)GW_ALBEDO_MAX);
	double levels = ceil(log((double)gw_options_bounce_tolerance(o)) / log(kept));
	if (o->bounces != GW_BOUNCES_AUTO)
		levels = fmin(levels, o->bounces > 1 ? (double)o->bounces - 1.0 : 0.0);
	return (uint32_t)levels;
}

static void want_new(placing *p, const float *before)
{
	for (size_t i = 0; i < p->needed.facets; i++)
		p->wanted[i] = before[i] < INFINITY ? INFINITY : p->needed.spacing[i];
}

/* Level after level, until nothing new is seen. */
static gw_status place_levels(placing *p, float *before, gw_error *error)
{
	gw_scene *s = p->scene;
	float fine = s->region.spacing, wide = fine * WIDER;
	size_t facets = p->needed.facets;
	uint32_t levels = levels_that_matter(s);
	memcpy(p->wanted, p->needed.spacing, facets * sizeof *p->wanted);
	GW_TRY(place(p, fine, error));
	s->report->region_records = s->records.count;
	for (uint32_t level = 0; level < levels && s->records.count > p->traced; level++) {
		size_t more, hits = (size_t)(s->records.count - p->traced) * s->options.rays;
		memcpy(before, p->needed.spacing, facets * sizeof *before);
		GW_TRY(gw_needed_facets_hit(p->hit, hits, wide, &p->needed, &more, error));
		if (more == 0)
			break;
		if (gw_scene_stopped(s))
			return gw_fail(error, GW_ERROR_CANCELLED, "stopped while records were placed");
		want_new(p, before);
		GW_TRY(place(p, wide, error));
	}
	return GW_OK;
}

static gw_status weigh_facets(const placing *p, gw_error *error)
{
	gw_scene *s = p->scene;
	const gw_record_context on = gw_scene_context(s, &s->records);
	size_t facets = p->needed.facets;
	bool *finite = gw_allocate_array(facets, sizeof *finite);
	gw_buffer reach = { 0 };
	if (!finite)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu facets", facets);
	for (size_t i = 0; i < facets; i++)
		finite[i] = p->needed.spacing[i] < INFINITY;
	const gw_own_spacings own = { p->needed.spacing, finite, facets };
	gw_status status = gw_buffer_fill(s->gpu, &s->records.facet_record, GW_NONE, error);
	if (status == GW_OK)
		status = gw_buffer_fill(s->gpu, &s->records.facet_weight, 0, error);
	if (status == GW_OK)
		status = gw_records_reach(s->gpu, &s->records, GW_FACET_REACH, &own, &reach, error);
	if (status == GW_OK)
		status = gw_records_weigh_facets(&on, &reach, error);
	gw_buffer_destroy(s->gpu, &reach);
	free(finite);
	return status;
}

static gw_status weigh_surfels(const placing *p, gw_error *error)
{
	gw_scene *s = p->scene;
	const gw_record_context on = gw_scene_context(s, &s->records);
	size_t count = s->surfels.count;
	float *spacing = gw_allocate_array(count, sizeof *spacing);
	gw_buffer reach = { 0 };
	if (!spacing)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu surfels", count);
	for (size_t i = 0; i < count; i++)
		spacing[i] = s->region.spacing;
	const gw_own_spacings own = { spacing, s->region.asked, count };
	gw_status status = gw_records_reach(s->gpu, &s->records, GW_FACET_REACH, &own, &reach, error);
	if (status == GW_OK)
		status = gw_read_back_make_some(&on, &reach, s->region.asked, count, &s->read_back, error);
	gw_buffer_destroy(s->gpu, &reach);
	free(spacing);
	return status;
}

/* Surfels that are needed get light of lamps, and what their facets gather. */
static gw_status light_surfels(placing *p, gw_error *error)
{
	gw_scene *s = p->scene;
	const gw_record_context on = gw_scene_context(s, &s->records);
	size_t count = s->surfels.count;
	uint32_t *facet = gw_allocate_array(count, sizeof *facet), *back = NULL;
	s->region.lit = gw_allocate_array(count, sizeof *s->region.lit);
	gw_status status =
		facet && s->region.lit
			? gw_needed_facets_surfels(s->gpu, &s->octree, &p->needed, count, facet, error)
			: gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu surfels", count);
	for (size_t i = 0; i < count && status == GW_OK; i++)
		s->region.lit[i] = facet[i] != GW_NONE || s->region.asked[i];
	if (status == GW_OK)
		status = gw_surfel_backs_find(&s->surfels, &back, error);
	for (size_t i = 0; i < count && back; i++)
		if (s->region.lit[i] && back[i] != UINT32_MAX)
			s->region.lit[back[i]] = true;
	if (status == GW_OK)
		status = gw_read_back_take_facets(&on, facet, &s->read_back, error);
	free(back);
	free(facet);
	return status;
}

static gw_status weigh_all(placing *p, gw_error *error)
{
	gw_scene *s = p->scene;
	const gw_record_context on = gw_scene_context(s, &s->records);
	GW_TRY(gw_ray_gather_look(&on, &s->rays, error));
	GW_TRY(weigh_facets(p, error));
	GW_TRY(weigh_surfels(p, error));
	GW_TRY(gw_scene_measure_turn(s, error));
	return light_surfels(p, error);
}

static void report_needs(const placing *p)
{
	gw_report *r = p->scene->report;
	r->region_facets = r->facets = 0;
	for (size_t i = 0; i < p->needed.facets; i++) {
		r->facets += p->needed.centre[4 * i + 3] > 0.0f;
		r->region_facets += p->needed.spacing[i] < INFINITY;
	}
}

static gw_status place_all(placing *p, gw_error *error)
{
	gw_scene *s = p->scene;
	size_t facets = p->needed.facets;
	GW_TRY(choose_spacing(p, &s->region.spacing, error));
	const gw_needed_reach around = { fmaxf(GW_FACET_REACH * s->region.spacing, 2.0f),
									 s->region.spacing };
	GW_TRY(
		gw_needed_facets_around(s->gpu, &s->octree, s->region.asked, &around, &p->needed, error));
	p->wanted = gw_allocate_array(facets, sizeof *p->wanted);
	float *before = gw_allocate_array(facets, sizeof *before);
	gw_status status = p->wanted && before ? place_levels(p, before, error)
										   : gw_fail(error, GW_ERROR_MEMORY,
													 "no memory for records on %zu facets", facets);
	free(before);
	if (status == GW_OK)
		status = weigh_all(p, error);
	if (status == GW_OK)
		report_needs(p);
	return status;
}

/* What light is known beforehand needs no records. */
static gw_status leave_out_known(const gw_scene *scene, gw_needed_facets *needed, gw_error *error)
{
	const gw_surfels *s = &scene->surfels;
	if (!scene->known)
		return GW_OK;
	bool *known = gw_allocate_zeros(s->count, sizeof *known);
	if (!known)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu surfels", s->count);
	for (size_t i = 0; i < s->point_count; i++)
		if (s->surfel_of_point[i] != UINT32_MAX && !isnan(scene->known->all[3 * i]))
			known[s->surfel_of_point[i]] = true;
	gw_status status = gw_needed_facets_leave_out(scene->gpu, &scene->octree, known, needed, error);
	free(known);
	return status;
}

gw_status gw_region_place_records(gw_scene *scene, gw_error *error)
{
	placing p = { .scene = scene };
	GW_TRY(gw_needed_facets_make(scene->gpu, &scene->octree, &p.needed, error));
	gw_status status = leave_out_known(scene, &p.needed, error);
	if (status == GW_OK)
		status = place_all(&p, error);
	if (status == GW_OK) {
		scene->region.facet_spacing = p.needed.spacing;
		p.needed.spacing = NULL;
	}
	free(p.wanted);
	free(p.hit);
	gw_needed_facets_clear(&p.needed);
	return status;
}
