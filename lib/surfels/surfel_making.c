/* surfel_making.c - runs the steps from points to surfels; see surfels.h. */
#include "surfels/surfel_making.h"

#include "base/memory.h"
#include "cloud/frame.h"
#include "cloud/range_image.h"
#include "cloud/strays.h"
#include "cloud/surfel_choice.h"
#include "cloud/near_duplicates.h"
#include "normals/given_normals.h"
#include "normals/normals.h"
#include "normals/plane_error.h"
#include "surfels/filled_space.h"
#include "surfels/noisy_surface.h"
#include "surfels/plane_doubt.h"
#include "surfels/surface_layers.h"
#include "surfels/surfel_backs.h"
#include "surfels/surfel_disc.h"
#include "surfels/surfel_smooth.h"

#include <stdlib.h>
#include <string.h>

/* Who chooses may want to see normals. Those that are missing need neighbours, all of them. */
static gw_status choose(const gw_points *points, const gw_surfels_options *options,
						gw_surfels *surfels, gw_error *error)
{
	gw_neighbours *search = NULL;
	gw_status status = GW_OK;
	bool complete = surfels->normals_given == surfels->count && !points->normal_sideless;
	if (!complete && !options->choose_by_place) {
		status = gw_neighbours_open(surfels, options, &search, error);
		if (status == GW_OK)
			status = gw_normals_complete(points, options, search, surfels, error);
		gw_neighbours_close(search);
	}
	return status == GW_OK ? gw_surfels_choose(options, surfels, error) : status;
}

/* Missing normals, and how far off they are; by_grid: those that are known are of range images. */
static gw_status complete_normals(const gw_points *points, const gw_surfels_options *options,
								  gw_neighbours *search, bool by_grid, gw_surfels *s,
								  gw_error *error)
{
	float of_known = by_grid ? GW_PLANE_BY_GRID : 0.0f;
	if (s->normals_given == s->count && !by_grid)
		return GW_OK;
	s->shading_normal_off = gw_allocate_zeros(s->count, sizeof *s->shading_normal_off);
	if (!s->shading_normal_off)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu missing normals", s->count);
	for (size_t i = 0; i < s->count; i++) {
		const float *n = s->normal + 3 * i;
		bool known = n[0] != 0 || n[1] != 0 || n[2] != 0;
		s->shading_normal_off[i] = known ? of_known : GW_PLANE_BY_PLACE;
	}
	if (s->normals_given < s->count)
		GW_TRY(gw_normals_complete(points, options, search, s, error));
	return gw_plane_error(search, s, error);
}

/* What is known of the points, and which of them belong to surfaces. */
typedef struct sorted_points {
	const gw_points *all;
	gw_stray_marks strays;
	gw_points rest;   /* those that are no strays */
	double *position; /* of the rest */
	bool by_grid;     /* their normals are of range images, as far as they are known */
} sorted_points;

/* Near duplicates are joined until few are left: the more scans of a place there are, the more
 * often. */
#define JOINING_ROUNDS 4

/* The frame is made anew of points that were moved. */
static gw_status make_frame_anew(const gw_surfels_options *options, sorted_points *p,
								 gw_surfels *surfels, gw_error *error)
{
	gw_surfels_clear(surfels);
	return gw_frame_make(&p->rest, options, surfels, error);
}

/* The rest of the points gets places of its own, as it has them now; those that it had before go to
 * *old, the caller's on success. */
static gw_status copy_places(sorted_points *p, double **old, gw_error *error)
{
	double *own = gw_allocate_array(p->all->count, 3 * sizeof *own);
	if (!own)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the places of %zu points",
					   p->all->count);
	memcpy(own, p->rest.position, 3 * p->all->count * sizeof *own);
	*old = p->position;
	p->rest.position = p->position = own;
	return GW_OK;
}

static gw_status join_near(const gw_surfels_options *options, sorted_points *p,
						   const gw_surfels *surfels, size_t *moved, gw_error *error)
{
	gw_neighbours *search = NULL;
	gw_status status = gw_neighbours_open(surfels, options, &search, error);
	if (status == GW_OK)
		status =
			gw_near_duplicates_join(surfels, search, GW_NEAR_DUPLICATES, p->position, moved, error);
	gw_neighbours_close(search);
	return status;
}

/* Makes points one that stand hardly off each other, where there are many. */
static gw_status join_near_duplicates(const gw_surfels_options *options, sorted_points *p,
									  gw_surfels *surfels, gw_error *error)
{
	size_t moved = 1;
	double *old;
	for (int round = 0; round < JOINING_ROUNDS && moved > 0 && gw_near_duplicates_are_many(surfels);
		 round++) {
		if (!p->position)
			GW_TRY(copy_places(p, &old, error));
		GW_TRY(join_near(options, p, surfels, &moved, error));
		if (moved > 0)
			GW_TRY(make_frame_anew(options, p, surfels, error));
	}
	return GW_OK;
}

static gw_status go_on(const gw_surfels_options *options, gw_error *error)
{
	return options->cancelled && options->cancelled(options->user)
			   ? gw_fail(error, GW_ERROR_CANCELLED, "stopped while sorting the points")
			   : GW_OK;
}

/* The rest is looked at by other cells; each time there are fewer strays. */
#define STRAY_ROUNDS 8

/* The frame is made anew when strays are found in it, so that they have no part in it. */
static gw_status take_strays_out(const gw_surfels_options *options, sorted_points *p,
								 gw_surfels *surfels, gw_error *error)
{
	for (int round = 0; round < STRAY_ROUNDS; round++) {
		size_t known = p->strays.count;
		GW_TRY(gw_strays_mark_alone(&p->rest, options, surfels, &p->strays, error));
		GW_TRY(go_on(options, error));
		if (p->strays.count == known)
			break;
		free(p->position);
		p->position = NULL;
		GW_TRY(gw_strays_hide(p->all, &p->strays, &p->position, &p->rest, error));
		GW_TRY(make_frame_anew(options, p, surfels, error));
	}
	return GW_OK;
}

/* The frame of the points that are no strays. */
static gw_status sort_points(const gw_surfels_options *options, sorted_points *p,
							 gw_surfels *surfels, gw_error *error)
{
	GW_TRY(gw_strays_mark_known(p->all, &p->strays, error));
	GW_TRY(gw_strays_hide(p->all, &p->strays, &p->position, &p->rest, error));
	GW_TRY(go_on(options, error));
	GW_TRY(gw_frame_make(&p->rest, options, surfels, error));
	GW_TRY(go_on(options, error));
	GW_TRY(take_strays_out(options, p, surfels, error));
	return join_near_duplicates(options, p, surfels, error);
}

/* Noise is taken out where the surface is thicker than this, and where that does not help, layers
 * are joined until it is thinner than that, so many times at most; what is not half as thick then
 * is none in layers. Few points have none to lose. Where it is thicker yet, noise is as wide as
 * points are apart (noisy_surface.h). */
#define LAYERS_THICK 0.02
#define NOISE_THICK 0.05
#define LAYERS_THIN 0.008
#define LAYERS_ROUNDS 5
#define LAYERS_POINTS 10000u

/* Points whose surface may be too thick. */
typedef struct thick_points {
	sorted_points *p;
	const gw_surfels_options *options;
	gw_neighbours **search; /* is opened anew when they are moved */
	gw_surfels *surfels;
	double thickness;
	double noise; /* metres: what was taken out of all places */
} thick_points;

static gw_status open_anew(thick_points *t, gw_error *error)
{
	gw_neighbours_close(*t->search);
	*t->search = NULL;
	GW_TRY(make_frame_anew(t->options, t->p, t->surfels, error));
	GW_TRY(gw_neighbours_open(t->surfels, t->options, t->search, error));
	t->thickness = gw_surface_thickness(t->surfels, *t->search);
	return GW_OK;
}

static gw_status join_often(thick_points *t, gw_error *error)
{
	size_t moved = 1;
	double first = t->thickness;
	for (int round = 0; round < LAYERS_ROUNDS && moved > 0 && t->thickness > LAYERS_THIN; round++) {
		if (round > 1 && t->thickness > 0.8 * first)
			return GW_OK; /* it does not get thinner */
		GW_TRY(gw_near_duplicates_join(t->surfels, *t->search, GW_NEAREST_PAIRS, t->p->position,
									   &moved, error));
		GW_TRY(open_anew(t, error));
	}
	return GW_OK;
}

static gw_status flatten_noise(thick_points *t, gw_error *error)
{
	gw_noisy_points all = { .surfels = t->surfels,
							.search = *t->search,
							.threads = t->options->threads,
							.sparse = t->thickness <= NOISE_THICK };
	size_t moved;
	GW_TRY(gw_noisy_surface_flatten(&all, t->p->position, &moved, error));
	t->noise = all.noise;
	return moved > 0 ? open_anew(t, error) : GW_OK;
}

/* Of points that are crowded alone. */
static gw_status flatten_crowded(thick_points *t, gw_error *error)
{
	gw_noisy_points crowded = { .surfels = t->surfels,
								.search = *t->search,
								.threads = t->options->threads };
	size_t moved = 0;
	double *old;
	gw_status status = gw_crowded_points_find(&crowded, error);
	if (status == GW_OK && crowded.some && !t->p->position)
		status = copy_places(t->p, &old, error);
	if (status == GW_OK && crowded.some)
		status = gw_noisy_surface_flatten(&crowded, t->p->position, &moved, error);
	free(crowded.some);
	return status == GW_OK && moved > 0 ? open_anew(t, error) : status;
}

/* Goes a way on which surface may get thin, and back where it has not become half as thick. */
static gw_status try_way(gw_status (*way)(thick_points *, gw_error *), thick_points *t,
						 gw_error *error)
{
	double *old = NULL, before = t->thickness;
	const double *places = t->p->rest.position;
	GW_TRY(copy_places(t->p, &old, error));
	gw_status status = way(t, error);
	if (status != GW_OK || t->thickness < 0.5 * before) {
		free(old);
		return status;
	}
	free(t->p->position);
	t->p->position = old;
	t->p->rest.position = places;
	t->noise = 0.0;
	return open_anew(t, error);
}

/* Of points of which no more is known than where they are. search is opened anew. */
static gw_status thin_surface(sorted_points *p, const gw_surfels_options *options,
							  gw_neighbours **search, gw_surfels *surfels, gw_error *error)
{
	if (options->choose || p->by_grid || surfels->normals_given > 0 || p->all->own_area ||
		p->all->beam_share || surfels->count < LAYERS_POINTS)
		return GW_OK;
	thick_points t = { .p = p,
					   .options = options,
					   .search = search,
					   .surfels = surfels,
					   .thickness = gw_surface_thickness(surfels, *search) };
	const double before = t.thickness;
	if (before > LAYERS_THICK)
		GW_TRY(try_way(flatten_noise, &t, error));
	if (before <= NOISE_THICK && t.thickness >= before)
		GW_TRY(flatten_crowded(&t, error));
	const double noise = t.noise; /* stays out whether layers can be joined or not */
	if (t.thickness > LAYERS_THICK)
		GW_TRY(try_way(join_often, &t, error));
	surfels->noise_taken = (float)noise;
	return GW_OK;
}

/* search is opened anew when the points are moved. */
static gw_status make_discs(const sorted_points *p, const gw_surfels_options *options,
							gw_neighbours **search, gw_surfels *surfels, float *gap,
							gw_error *error)
{
	bool smoothed = false;
	gw_lone_points lone;
	GW_TRY(gw_strays_list(p->all, &p->strays, *search, surfels, error));
	GW_TRY(gw_given_normals_mend(&p->rest, options, *search, surfels, error));
	GW_TRY(complete_normals(&p->rest, options, *search, p->by_grid, surfels, error));
	GW_TRY(gw_filled_space_find(&p->rest, *search, surfels, &lone, error));
	if (options->effects_forbidden & 1u << GW_EFFECT_TRANSMISSION)
		memset(lone.foliage, 0, surfels->count);
	gw_status status =
		options->rough_area ? GW_OK : gw_plane_doubt_find(&p->rest, *search, &lone, surfels, error);
	if (status == GW_OK)
		status = gw_surfels_smooth(options, *search, lone.filled, surfels, &smoothed, error);
	if (smoothed) {
		gw_neighbours_close(*search);
		*search = NULL;
		status = gw_neighbours_open(surfels, options, search, error);
	}
	if (status == GW_OK)
		status = gw_discs_make(*search, &lone, surfels, options->rough_area, gap, error);
	gw_lone_points_clear(&lone);
	return status;
}

static gw_status make_surface(sorted_points *p, const gw_surfels_options *options,
							  gw_surfels *surfels, float **gap, gw_error *error)
{
	gw_neighbours *search = NULL;
	if (options->choose)
		GW_TRY(choose(&p->rest, options, surfels, error));
	GW_TRY(gw_neighbours_open(surfels, options, &search, error));
	gw_status status = go_on(options, error);
	if (status == GW_OK)
		status = thin_surface(p, options, &search, surfels, error);
	if (status == GW_OK && gap) {
		*gap = gw_allocate_array(surfels->count, sizeof **gap);
		if (!*gap)
			status = gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu distances", surfels->count);
	}
	if (status == GW_OK)
		status = make_discs(p, options, &search, surfels, gap ? *gap : NULL, error);
	gw_neighbours_close(search);
	return status;
}

gw_status gw_surfels_make_with_gaps(const gw_points *points, const gw_surfels_options *options,
									gw_surfels *surfels, float **gap, gw_error *error)
{
	gw_ranged_points ranged;
	sorted_points sorted = { .all = &ranged.points };
	*surfels = (gw_surfels){ .count = 0 };
	if (gap)
		*gap = NULL;
	gw_status status = gw_range_images_use(points, options, &ranged, error);
	sorted.by_grid = !points->normal && ranged.normals > 0;
	if (status == GW_OK)
		status = sort_points(&ranged.options, &sorted, surfels, error);
	if (status == GW_OK)
		status = make_surface(&sorted, &ranged.options, surfels, gap, error);
	gw_strays_clear(&sorted.strays);
	free(sorted.position);
	surfels->normals_estimated += ranged.normals;
	gw_ranged_points_clear(&ranged);
	if (status != GW_OK) {
		gw_surfels_clear(surfels);
		if (gap) {
			free(*gap);
			*gap = NULL;
		}
	}
	return status;
}

gw_status gw_surfels_make(const gw_points *points, const gw_surfels_options *options,
						  gw_surfels *surfels, gw_error *error)
{
	GW_TRY(gw_surfels_make_with_gaps(points, options, surfels, NULL, error));
	gw_status status = options->backs ? gw_surfel_backs_add(surfels, error) : GW_OK;
	if (status != GW_OK)
		gw_surfels_clear(surfels);
	return status;
}

void gw_surfels_clear(gw_surfels *surfels)
{
	void *const array[] = { surfels->position,
							surfels->normal,
							surfels->shading_normal,
							surfels->shading_normal_off,
							surfels->normal_length,
							surfels->albedo,
							surfels->emission,
							surfels->transparency,
							surfels->nearest,
							surfels->radius,
							surfels->area,
							surfels->clip,
							surfels->bend,
							surfels->creased,
							surfels->two_sided,
							surfels->doubt,
							surfels->noise,
							surfels->surfel_of_point,
							surfels->albedo_of_point,
							surfels->stray };
	for (size_t i = 0; i < sizeof array / sizeof *array; i++)
		gw_free_unless_lent(array[i], surfels->lent, surfels->lent_bytes);
	memset(surfels, 0, sizeof *surfels);
}
