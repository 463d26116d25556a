/*
 * surfels.h - from bare points to pieces of surface (surfels), on the CPU; glowworm_picture.h has
 * what they are.
 *
 * Steps, in the order of the data's way: frame (local origin, canonical order, duplicates merged),
 * neighbours (FLANN), normals (PCL where missing, oriented), the surface behind noise, region of
 * influence, and for each point the disc of surface it stands for. Everything downstream works on
 * this struct's order, not on the input's; `input` and `surfel_of_point` map between the two.
 */
#ifndef SURFELS_H
#define SURFELS_H

#include "glowworm_picture.h"

/* Neighbours a point is described by. */
#define GW_NEIGHBOURS 16u

/* Least cosine between the normals of points on one surface. */
#define GW_SAME_SURFACE 0.6

/* Least cosine between the normals of a smooth surface at places a disc apart. */
#define GW_SMOOTH_LEAST 0.9f

/* Do two surfels face about the same way? */
static inline bool gw_surfels_alike(const gw_surfels *s, size_t i, size_t j)
{
	const float *n = s->normal + 3 * i, *m = s->normal + 3 * j;
	return n[0] * m[0] + n[1] * m[1] + n[2] * m[2] > GW_SMOOTH_LEAST;
}

/* Is a surfel lit from the side alone that it faces? Of surface that may face either way each side
 * is, where the backs have surfels; what else nobody knows the side of is lit from both at once. */
static inline bool gw_surfels_one_sided(const gw_surfels *s, size_t i)
{
	uint8_t side = s->two_sided[i];
	return side == 0 || side == GW_SIDE_UNCLEAR || side == GW_SIDE_BACK;
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

/* What a point reflects of the light of its surfel, or of the surfel of the other side there. */
static inline const float *gw_albedo_of_point(const gw_surfels *s, size_t point, size_t surfel)
{
	return s->albedo_of_point ? s->albedo_of_point + 3 * point : s->albedo + 3 * surfel;
}

/*
 * Two unit tangents of a unit normal, right-handed (tangent x bitangent = normal), continuous but
 * for one pole: tangent_frame of sampling.glsl.
 */
#ifdef __cplusplus
extern "C"
#endif
	void
	gw_tangent_frame(const float normal[3], float tangent[3], float bitangent[3]);

#endif
