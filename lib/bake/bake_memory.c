/*
 * bake_memory.c - see bake_memory.h.
 */
#include "bake/bake_memory.h"

#include "bake/scene.h"
#include "base/distribution.h"
#include "octree/octree.h"

#include <math.h>

/* Bytes of a bake: at all, with its passes and what the octree takes of a few points; of a surfel,
 * its columns, light and results; of a facet, with fragments, records and read-back; and of a point
 * that is a copy of one of more. Of 20 scenes with 43,000 to 860,000 surfels, by the process's
 * highest, less what it held when the bake began: 57 MB, 110, 357 and 130 fit best, within a tenth
 * but for random points, lamps and what is estimated; and 155 where leaves are wider, of clouds of
 * a million points and more. Of a copy more is counted, as it is often of
 * a surface that was chosen again: what the first one took is not all given back. */
#define FIXED_BYTES (UINT64_C(72) << 20)
#define SURFEL_BYTES 155.0
#define FACET_BYTES 355.0
#define SUBSET_BYTES 180.0

/* What a surfel takes until there are facets: more than afterwards where these are few, as where
 * leaves are wide. Of a cave of 10 million points, by the process's highest, 277. */
#define SURFEL_BYTES_LEAST 285.0

/* Of a bake of half of the points beside one of all. */
#define HALF_FIXED_BYTES (UINT64_C(12) << 20)

/* Of a surfel where lamps shine, and where its normal was estimated. */
#define LAMPS_BYTES 100.0
#define ESTIMATED_BYTES 280.0

/* Facets a point with leaves of GW_LEAF_SPACING: rooms have 0.7, caves 1.1, where sensors are noisy
 * 1.5, random points 3. Where normals are estimated many surfels have backs. */
#define FACETS_USUAL 1.15
#define SURFELS_ESTIMATED 1.3
#define FACETS_ESTIMATED 1.35

/* So much less than what is foretold bakes take at least where records are no more than at first;
 * and for each byte that these grow by, so many are taken when the next are placed. */
#define SLACK 0.05
#define GROWTH_BYTES 2.0

/* More points than that many times those that are known of are not asked for. */
#define MOST_TIMES 0x1p40

static bool leaves_are_usual(const gw_bake_options *o)
{
	return o->leaf_spacing == GW_LEAF_SPACING_AUTO || o->leaf_spacing >= GW_LEAF_SPACING;
}

bool gw_bake_memory_is_known(const gw_bake_options *o)
{
	const gw_bake_options usual = gw_bake_options_default();
	return o->method == GW_METHOD_RAYS && o->rays <= usual.rays &&
		   o->light_samples <= usual.light_samples && o->least_records <= usual.least_records &&
		   o->most_records > 0 && o->most_records <= usual.most_records &&
		   o->record_spacing > 0.0f && leaves_are_usual(o) &&
		   o->estimate_points <= usual.estimate_points && o->depth == usual.depth &&
		   !(o->max_error > 0.0f) && !(o->time_limit > 0.0f) && !o->transport && !o->region &&
		   !o->lamps && !o->voxels && !o->volume;
}

/* How many times as much surface as the narrowest leaves of the same points would hold those hold
 * that so many surfels have. */
static double leaf_area(const gw_memory_facts *f, double surfels)
{
	float spacing = gw_octree_leaf_spacing(GW_LEAF_SPACING_AUTO, (size_t)surfels, !f->widening);
	double wider = (double)spacing / (double)GW_LEAF_SPACING;
	return wider * wider;
}

gw_memory_facts gw_bake_memory_usual(uint64_t points, bool normals, bool lamps,
									 const gw_bake_options *options)
{
	bool estimated = !normals || options->normals == GW_NORMALS_ESTIMATE;
	double surfels = (estimated ? SURFELS_ESTIMATED : 1.0) * (double)points;
	gw_memory_facts facts = { .points = points,
							  .surfels = (uint64_t)surfels,
							  .lamps = lamps,
							  .estimated = estimated,
							  .widening = options->leaf_spacing == GW_LEAF_SPACING_AUTO &&
										  !gw_scene_needs_regions(options) };
	double facets = (estimated ? FACETS_ESTIMATED : FACETS_USUAL) * (double)points;
	facts.facets = (uint64_t)(facets / leaf_area(&facts, surfels));
	return facts;
}

gw_memory_facts gw_bake_memory_guess(const gw_scene_description *scene,
									 const gw_bake_options *options, bool subset)
{
	const gw_points *points = scene->points;
	bool lamps = false;
	for (size_t i = 0; i < scene->light_count; i++)
		lamps |= gw_light_shines(&scene->lights[i]);
	gw_memory_facts facts = gw_bake_memory_usual(points->count, points->normal, lamps, options);
	facts.subset = subset;
	return facts;
}

/* What goes with the number of points, of that many times as many. */
static double variable_bytes(const gw_memory_facts *f, double times)
{
	double more = (f->lamps ? LAMPS_BYTES : 0.0) + (f->estimated ? ESTIMATED_BYTES : 0.0);
	double surfels = (double)f->surfels;
	double facets = (double)f->facets * leaf_area(f, surfels) / leaf_area(f, times * surfels);
	double most = fmax(SURFEL_BYTES * surfels + FACET_BYTES * facets, SURFEL_BYTES_LEAST * surfels);
	return times * (most + more * surfels + (f->subset ? SUBSET_BYTES * (double)f->points : 0.0));
}

uint64_t gw_bake_memory(const gw_memory_facts *facts)
{
	return FIXED_BYTES + (uint64_t)variable_bytes(facts, 1.0);
}

uint64_t gw_bake_memory_of_half(const gw_memory_facts *facts)
{
	return HALF_FIXED_BYTES + (uint64_t)variable_bytes(facts, 0.5);
}

uint64_t gw_bake_memory_points(const gw_memory_facts *facts, uint64_t bytes, double given)
{
	double left = bytes > FIXED_BYTES ? (double)(bytes - FIXED_BYTES) : 0.0;
	double points = (double)facts->points, least = 0.0, most = 1.0;
	if (!(variable_bytes(facts, 1.0) > 0.0))
		return 0;
	while (most < MOST_TIMES && variable_bytes(facts, most) + most * given * points <= left)
		most *= 2.0;
	for (int halving = 0; halving < 64; halving++) {
		double times = 0.5 * (least + most);
		if (variable_bytes(facts, times) + times * given * points <= left)
			least = times;
		else
			most = times;
	}
	return (uint64_t)fmin(least * points, 0x1p62);
}

double gw_bake_memory_growth(uint64_t foretold, uint64_t bytes, uint64_t records)
{
	double left = (double)bytes - (1.0 - SLACK) * (double)foretold;
	return records > 0 ? 1.0 + fmax(left, 0.0) / (GROWTH_BYTES * (double)records) : INFINITY;
}
