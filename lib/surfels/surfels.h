/*
 * surfels.h - from bare points to pieces of surface (surfels), on the host.
 *
 * Steps, in the order of the data's way: frame (local origin, canonical order, duplicates merged),
 * neighbours (FLANN), normals (PCL where missing, oriented), the surface behind noise, region of
 * influence, and for each point the disc of surface it stands for. Everything downstream works on
 * this struct's order, not on the input's; `input` and `surfel_of_point` map between the two.
 */
#ifndef SURFELS_H
#define SURFELS_H

#include "glowworm.h"

/* Neighbours a point is described by. */
#define GW_NEIGHBOURS 16u

/*
 * The surfels of a cloud. Arrays hold `count` elements (times 3 where said).
 *
 * Order is canonical: by Morton key of the position on a 2^21 grid over the bounds, then by the
 * exact coordinates, so that it does not depend on the order of the input.
 */
typedef struct gw_surfels {
	size_t count;     /* distinct finite positions */
	double origin[3]; /* of the local frame: whole metres (a power of two below a metre for clouds
						 under a metre), chosen from the bounds */
	float minimum[3], maximum[3]; /* bounds in the local frame, without what is far off all the rest
							  (bulk_bounds.h) */
	float *position;              /* 3 * count, metres in the local frame; of noisy points their
									 place on the surface that they scatter around */
	float *normal;                /* 3 * count, unit; of noisy points that of this surface */
	float *lamp_normal;   /* NULL when no point is noisy, else 3 * count, unit, the points' own
							 without what of them is noise: lamps shine on these */
	float *lamp_off;      /* NULL when no point is noisy and all normals were given, else count,
							 radians, RMS angle by which the normals that lamps shine on are
							 expected to be off */
	float *normal_length; /* count, length of the given normal in (0, 1]: spread of the NDF */
	float *albedo;        /* 3 * count, linear, in [0, GW_ALBEDO_MAX]; the mean of merged points */
	float *emission;      /* 3 * count, >= 0; NULL when nothing emits */
	float *nearest;       /* count, maximum-norm distance to the nearest other surfel, metres
							 (Salm 4.3.4); infinity for a cloud of one */
	float *radius;    /* count, metres, of the disc: distance to the 8th neighbour on the surface,
						 or half that to the furthest where scan lines are far apart */
	float *area;      /* count, m^2, that the surfel stands for: its Voronoi cell on the surface */
	float *clip;      /* 6 * count: two half-planes in the disc's plane that cut it at edges:
						 direction x, y in the disc's tangent frame (gw_tangent_frame) and the
						 distance beyond which nothing of it lies; (0, 0, 0): none */
	float *bend;      /* 3 * count or NULL, per metre: how the surface curves away from the disc,
						 which is bent by it: at (x, y) of the tangent frame it is
						 (bend[0] x^2 + 2 bend[1] x y + bend[2] y^2) / 2 above its plane */
	uint8_t *creased; /* count or NULL, 1 where all cuts are at creases with other surfaces, whose
						 place is known from both sides */
	uint8_t *two_sided; /* count, 1 where the normal cannot be trusted: lit from both sides */
	float *noise;       /* count, metres, RMS distance of the neighbours as they were given to the
						   fitted plane */
	uint32_t *surfel_of_point; /* point_count: surfel of each point, UINT32_MAX: left out, or not
								  chosen */
	size_t point_count;
	size_t strays;        /* surfels so far off all others that nothing is known of a surface
							 there: their discs are no larger than others' are; what lies outside
							 the bounds has no place in an octree, and only lamps light it */
	float stray_distance; /* metres, how far off the furthest of them is, about */
	float spacing;        /* metres, median of sqrt(area): width of a surfel's share of surface */
	double given_area;    /* m^2, sum of area */
	/* What was repaired, for the report. Normals count surfels, the others points. */
	uint64_t non_finite, duplicates, albedo_clamped, emission_repaired, normals_given,
		normals_estimated, normals_untrusted, albedo_defaulted;
} gw_surfels;

/*
 * Chooses surfels before their neighbours are looked for: those that nobody asks for cost nothing.
 *   surfels   all of them, with their frame, positions, normals, albedo, emission, two_sided and
 *             surfel_of_point; area, radius and spacing are rough, the rest is NULL
 *   chosen    surfels->count, all 0; receives 1 for those to keep
 */
typedef gw_status gw_surfels_chooser(void *user, const gw_surfels *surfels, uint8_t *chosen,
									 gw_error *error);

typedef struct gw_surfels_options {
	uint32_t threads;       /* 0: one a core */
	const gw_light *lights; /* light_count; orient estimated normals when there is no scanner */
	size_t light_count;
	uint64_t memory; /* bytes the step may use beyond its result; chunks follow from it */
	gw_surfels_chooser *choose; /* NULL: all. What surrounds the chosen ones is to be chosen too,
								   about twice as far as their neighbours are. At least some
								   GW_NEIGHBOURS are kept, so that there is something to make */
	void *chooser;              /* for choose */
	bool choose_by_place;       /* choose does not look at normals: those of the others that are
								   missing need not be made */
	bool rough_area;            /* area is the disc's, shared among the points that it reaches to;
								   a picture needs no better */
	bool (*cancelled)(void *user);
	void *user;
} gw_surfels_options;

/*
 * Makes the surfels of a cloud.
 *   surfels   on success owned by the caller, freed with gw_surfels_clear; zeroed on failure
 * Fails with GW_ERROR_DATA when no point is finite, GW_ERROR_MEMORY, GW_ERROR_CANCELLED.
 * The result does not depend on the order of the points nor on the number of threads.
 */
gw_status gw_surfels_make(const gw_points *points, const gw_surfels_options *options,
						  gw_surfels *surfels, gw_error *error);
void gw_surfels_clear(gw_surfels *surfels);

/* Least cosine between the normals of a smooth surface at places a disc apart. */
#define GW_SMOOTH_LEAST 0.9f

/* Do two surfels face about the same way? */
static inline bool gw_surfels_alike(const gw_surfels *s, size_t i, size_t j)
{
	const float *n = s->normal + 3 * i, *m = s->normal + 3 * j;
	return n[0] * m[0] + n[1] * m[1] + n[2] * m[2] > GW_SMOOTH_LEAST;
}

/* So many surfels after one in Morton order hold enough of those that adjoin it for a mean over
 * them.
 */
#define GW_ADJOIN_REACH 12u

/* Does surfel j lie on the disc of surfel i, on the same smooth surface? Here because it is asked
 * of millions of pairs. */
static inline bool gw_surfels_adjoin(const gw_surfels *s, size_t i, size_t j)
{
	const float *p = s->position + 3 * i, *q = s->position + 3 * j;
	float x = p[0] - q[0], y = p[1] - q[1], z = p[2] - q[2];
	return x * x + y * y + z * z < s->radius[i] * s->radius[i] && gw_surfels_alike(s, i, j);
}

/*
 * Two unit tangents of a unit normal, right-handed (tangent x bitangent = normal), continuous but
 * for one pole: tangent_frame of sampling.glsl.
 */
#ifdef __cplusplus
extern "C"
#endif
void gw_tangent_frame(const float normal[3], float tangent[3], float bitangent[3]);

#endif
