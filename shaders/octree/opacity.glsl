/*
 * opacity.glsl - surface that lets a share of the light through, for rays that are attenuated by
 * what they pass (trace_through in trace.glsl). Uses the texel buffers facet_albedo, facet_plane,
 * leaf_fragment, fragment_surfel and surfel_disc (octree.h). Only where TRACE_OPACITY is defined
 * before it, and with octree_discs.glsl; elsewhere all surface stops a ray.
 *
 * The opacity of a facet is the share of it that is covered, at whatever angle it is seen. A ray
 * goes on behind what it has passed; what is left of the same sheet does not count again: facets of
 * neighbouring cells reach beyond these, and discs lie over each other. Sheets that face alike and
 * are closer than points lie apart cannot be told from one that is rough.
 *
 * Foliage is what fills space, of which nobody knows how a single leaf lies. In a leaf cell with
 * leaves of an area A a ray is stopped over a length l with the probability 1 - exp(-A l / 2): half
 * of the area of leaves that lie at random is seen from everywhere (Beer and Lambert's law). The
 * cell that a ray starts in does not count: there it would be stopped by the leaf that it leaves.
 */
#ifndef OPACITY_GLSL
#define OPACITY_GLSL

#include "octree/octree_layout.h"
#include "octree/ray.glsl"
#include "octree/trace_constants.h"

#ifdef TRACE_OPACITY

/* One more than the facet that rays find which are stopped from behind; 0: all surface is opaque,
 * and nothing here costs anything. */
CONSTANT(5, uint, dark_facet, 0u);

/* What of the ray is left; where foliage leaves no more than `until`, it is stopped. */
float ray_left = 1.0f, ray_until = 0.0f;
bool stopped_by_foliage = false;

/* The sheet that the ray has passed last: its normal, where on the ray, and within which height of
 * that place it may lie. */
vec3 passed_normal = vec3(0.0f);
float passed_t = -1.0f, passed_height = 0.0f;

/* How much of the light a facet lets through. */
float transparency_of(uint facet)
{
	return fract(texelFetch(facet_albedo, int(facet)).w);
}

/* Is most of a facet met from both sides? One that may face either way is not (octree.h). */
bool is_two_sided(uint facet)
{
	float sides = floor(texelFetch(facet_albedo, int(facet)).w);
	return sides == 1.0f || sides == GW_FACET_FOLIAGE;
}

/* Is it foliage, and none whose leaves are larger than cells? */
bool is_foliage(uint facet)
{
	return dark_facet != 0u && floor(texelFetch(facet_albedo, int(facet)).w) == GW_FACET_FOLIAGE &&
		   texelFetch(facet_centre, int(facet)).w <= GW_FACET_LARGE;
}

/* A ray's way through the foliage of a cell, as far as it gets. */
void pass_foliage(uint facet, float enter, float leave, INOUT(Hit) hit)
{
	float length = min(leave, hit.t) - enter;
	if (enter <= 0.0f || !(length > 0.0f))
		return;
	float area = (1.0f - GW_FOLIAGE_CLEAR) * texelFetch(facet_centre, int(facet)).w;
	ray_left *= exp(-0.5f * area * length);
	if (ray_left > ray_until)
		return;
	hit.facet = facet;
	hit.t = enter;
	stopped_by_foliage = true;
}

/* What of its light a facet sends out, and stops. */
float opacity_of(uint facet)
{
	return dark_facet != 0u ? 1.0f - transparency_of(facet) : 1.0f;
}

/* Backs of surface that others see through are no inside of anything. */
bool stops_from_behind(uint facet)
{
	return dark_facet != 0u && transparency_of(facet) > 0.0f;
}

/* Is what shows its back to a ray, so near to where that starts, another sheet that lets light
 * through? Then its start lies as far behind it as points lie apart, which noise does not do. */
bool lies_over_start(IN(Ray) ray, uint facet, float behind)
{
	if (!stops_from_behind(facet))
		return false;
	uint first = texelFetch(leaf_fragment, int(leaf_of(owner_of(facet).word))).x;
	uint surfel = texelFetch(fragment_surfel, int(first)).x & GW_FRAGMENT_SURFEL;
	float least = max(GW_OVER_CELLS, sqrt(texelFetch(surfel_disc, int(surfel)).y));
	vec3 middle = texelFetch(facet_centre, int(facet)).xyz;
	return behind >= least && dot(ray.facing, middle) - dot(ray.facing, ray.foot) >= least;
}

/* Has the ray passed what it meets there already? */
bool is_passed(IN(Ray) ray, vec3 normal, float t)
{
	if (dark_facet == 0u || passed_t < 0.0f)
		return false;
	float rise = (t - passed_t) * abs(dot(passed_normal, ray.direction));
	return t <= passed_t || (rise < passed_height && dot(normal, passed_normal) > GW_LIKE_COSINE);
}

/* Where on its way the ray goes on. */
float walk_start()
{
	return max(passed_t, 0.0f);
}

/* Lets the ray go on behind what it has hit. */
void pass_sheet(IN(Hit) hit)
{
	uint first = texelFetch(leaf_fragment, int(leaf_of(owner_of(hit.facet).word))).x;
	uint surfel = texelFetch(fragment_surfel, int(first)).x & GW_FRAGMENT_SURFEL;
	passed_normal = texelFetch(facet_plane, int(hit.facet)).xyz;
	float area = texelFetch(surfel_disc, int(surfel)).y;
	passed_height = max(GW_SHEET_CELLS, GW_SHEET_SPACINGS * sqrt(area));
	passed_t = hit.t;
}

#else

bool stops_from_behind(uint)
{
	return false;
}

bool lies_over_start(IN(Ray), uint, float)
{
	return false;
}

bool is_foliage(uint)
{
	return false;
}

void pass_foliage(uint, float, float, INOUT(Hit))
{
}

bool is_passed(IN(Ray), vec3, float)
{
	return false;
}

float walk_start()
{
	return 0.0f;
}

#endif
#endif
