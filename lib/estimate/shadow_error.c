/*
 * shadow_error.c - see shadow_error.h.
 */
#include "estimate/shadow_error.h"

#include "base/luminance.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "light/transport_layout.h"

#include <math.h>
#include <stdlib.h>

#define EDGE_RATIO 0.5 /* light on the dark side of an edge is less than this of the other's */
#define CHUNK 4096u    /* surfels whose errors are added up at a time */

typedef struct shadow_edges {
	const gw_surfels *surfels;
	const float *direct;
	const bool *counts;
	double *square; /* a chunk, sum of squared errors */
	size_t *used;   /* a chunk, surfels that count */
} shadow_edges;

/* Luminance that a surfel would reflect of the light of lamps at another. */
static double reflected(const shadow_edges *e, size_t surfel, size_t at)
{
	const float *rho = e->surfels->albedo + 3 * surfel, *light = e->direct + 4 * at;
	return gw_luminance(
			   (const float[]){ rho[0] * light[0], rho[1] * light[1], rho[2] * light[2] }) /
		   M_PI;
}

/*
 * How far off the edge between two surfels is, in spacings: is anything hidden from the darker one,
 * and does what hides it end at a crease? What is hidden counts as many times as the edge is
 * further off than what casts it; so that is how many times the light between them it is.
 *   lost   by how much the darker one's light is less
 */
static double offset_between(const shadow_edges *e, size_t i, size_t j, double lost)
{
	const float *a = e->direct + 4 * i, *b = e->direct + 4 * j;
	float hidden = gw_luminance(a) < gw_luminance(b) ? a[3] : b[3];
	double light = gw_luminance(e->surfels->albedo + 3 * i) / M_PI * (double)hidden;
	double further = fmax(1.0, fmin(light / lost, (double)GW_FURTHER_MOST));
	return hidden > 0.0f ? further * GW_EDGE_OFFSET : hidden < 0.0f ? GW_CREASE_OFFSET : 0.0;
}

/* Mean over the neighbours of the squared difference, as far as it is a shadow's edge, times how
 * far off that is, in spacings. */
static double edge_at(const shadow_edges *e, size_t i)
{
	const gw_surfels *s = e->surfels;
	double own = reflected(e, i, i), sum = 0.0;
	uint32_t neighbours = 0;
	for (size_t j = i + 1; j < s->count && j <= i + GW_ADJOIN_REACH; j++) {
		if (!gw_surfels_adjoin(s, i, j))
			continue;
		double other = reflected(e, i, j);
		neighbours++;
		if (fmin(own, other) < EDGE_RATIO * fmax(own, other))
			sum += offset_between(e, i, j, fabs(own - other)) * (own - other) * (own - other);
	}
	return neighbours ? sum / neighbours : 0.0;
}

static void add_chunk(void *user, size_t first, size_t last, uint32_t worker)
{
	const shadow_edges *e = user;
	(void)worker;
	for (size_t i = first; i < last; i++) {
		if (!e->counts[i])
			continue;
		double width = sqrt((double)e->surfels->area[i]);
		double share = width / ((double)e->surfels->radius[i] * 4 / (3 * M_PI));
		e->square[first / CHUNK] += share * edge_at(e, i);
		e->used[first / CHUNK]++;
	}
}

gw_status gw_shadow_error(const gw_surfels *surfels, const float *direct, const bool *counts,
						  uint32_t threads, double *mean_square, gw_error *error)
{
	size_t chunks = surfels->count / CHUNK + 1, used = 0;
	shadow_edges e = { surfels, direct, counts, gw_allocate_zeros(chunks, sizeof *e.square),
					   gw_allocate_zeros(chunks, sizeof *e.used) };
	gw_status status = GW_OK;
	double sum = 0.0;
	if (e.square && e.used)
		gw_parallel_for(threads, surfels->count, CHUNK, add_chunk, &e);
	else
		status = gw_fail(error, GW_ERROR_MEMORY, "no memory for the edges of %zu surfels",
						 surfels->count);
	for (size_t c = 0; c < chunks && status == GW_OK; c++) {
		sum += e.square[c];
		used += e.used[c];
	}
	*mean_square = used ? sum / (double)used : 0.0;
	free(e.square);
	free(e.used);
	return status;
}
