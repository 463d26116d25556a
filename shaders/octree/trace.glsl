/*
 * trace.glsl - rays through the octree and the tree of its large discs, which is how scenes are
 * traced.
 */
#ifndef TRACE_GLSL
#define TRACE_GLSL

#include "octree/octree_trace.glsl"
#include "octree/disc_tree.glsl"

/* Whether the tree holds anything: mostly it does not, and costs nothing. */
CONSTANT(4, uint, has_discs, 0u);

/* The nearest facet that the ray meets, or GW_NONE. Where both have the surface that is hit, the
 * octree's is the finer one. */
Hit trace(IN(Ray) ray)
{
	if (has_discs == 0u)
		return trace_octree(ray);
	DiscHit disc = trace_discs(ray);
	Ray nearer = ray;
	nearer.t_max = min(disc.yields, ray.t_max);
	Hit hit = trace_octree(nearer);
	if (hit.facet == GW_NONE) {
		hit.facet = disc.facet;
		hit.t = disc.t;
	}
	hit.passed_back_face = hit.passed_back_face || disc.nearest_back_face < hit.t;
	return hit;
}

#endif
