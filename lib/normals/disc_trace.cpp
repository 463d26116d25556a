/*
 * disc_trace.cpp - gw_disc_tree_trace: disc_tree.glsl for C. As in kernel.cpp its text becomes the
 * body of a struct.
 */
#include "normals/disc_tree.h"

#include "base/shared_math.h"
#include "octree/trace_constants.h"
#include "light/transport_layout.h"

namespace glsl
{
namespace
{

struct discs {
	texels<uvec4> disc_tree;
	explicit discs(const void *words) : disc_tree(words)
	{
	}
#include "octree/disc_tree.glsl"
};

vec3 from_c(gw_vec3 v)
{
	return vec3(v.x, v.y, v.z);
}

} // namespace
} // namespace glsl

gw_disc_hit gw_disc_tree_trace(const gw_disc_tree *tree, const gw_disc_ray *ray)
{
	alignas(16) static const uint32_t empty[4] = { 0 };
	glsl::discs::Ray aimed = { glsl::from_c(ray->origin),
							   glsl::from_c(ray->direction),
							   glsl::from_c(ray->facing),
							   glsl::from_c(ray->foot),
							   ray->t_max,
							   ray->both_sides };
	glsl::discs::DiscHit hit = glsl::discs(tree->word ? tree->word : empty).trace_discs(aimed);
	return gw_disc_hit{ hit.disc, hit.facet, hit.t, hit.yields, hit.nearest_back_face };
}
