/*
 * shader_functions.cpp - see shader_functions.h. As in kernel.cpp the texts of shaders/ become
 * bodies of structs, whose members are what they refer to.
 */
#include "light/shader_functions.h"

#include "base/shader_vectors.h"

namespace glsl
{
namespace
{

struct directions {
#include "octree/ray.glsl"
#include "base/sampling.glsl"
};

struct light : directions {
	gw_light_push push;
	const float *distribution;
#include "light/light.glsl"
};

struct record : directions {
	gw_record_push push;
#include "light/record_ray.glsl"
};

} // namespace
} // namespace glsl

using namespace glsl;

gw_vec3 gw_record_ray(gw_vec3 g, gw_vec3 normal, uint32_t k, uint32_t rays, uint32_t seed)
{
	record of = {};
	float cosine;
	of.push.rays = rays;
	of.push.seed = seed;
	return to_c(of.record_ray(from_c(g), from_c(normal), k, cosine));
}

float gw_record_chance(gw_vec3 g, uint32_t k, uint32_t seed)
{
	record of = {};
	of.push.seed = seed;
	return of.record_chance(from_c(g), k);
}

float gw_lamp_received(const gw_lamp *lamp, gw_vec3 g, gw_vec3 normal, gw_vec3 *towards,
					   float *distance)
{
	light of = { {}, lamp->push, lamp->distribution };
	vec3 direction;
	vec4 facing = vec4(normal.x, normal.y, normal.z, 0.0f);
	float received = of.light_received(from_c(g), facing, direction, *distance);
	*towards = to_c(direction);
	return received;
}

gw_vec3 gw_lamp_aim(const gw_lamp *lamp, uint32_t s, float turn, gw_vec3 towards, float distance,
					float *range)
{
	light of = { {}, lamp->push, lamp->distribution };
	light::Ray ray = {};
	float weight;
	if (of.is_area_light()) {
		vec3 middle = vec3(lamp->push.position.x, lamp->push.position.y, lamp->push.position.z);
		of.aim_at_area(s, turn, middle - from_c(towards) * distance, ray, weight);
	} else {
		of.aim_at_light(s, turn, from_c(towards), distance, ray);
	}
	*range = ray.t_max;
	return to_c(ray.direction);
}
