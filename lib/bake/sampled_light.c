/*
 * sampled_light.c - see sampled_light.h.
 */
#include "bake/sampled_light.h"

#include "bake/scene_records.h"

gw_buffer *gw_scene_moment_of(const gw_scene *scene, gw_buffer *moment)
{
	return gw_scene_keeps_moments(scene) ? moment : NULL;
}

gw_sampled_sources gw_lighting_sources(gw_lighting *lighting)
{
	gw_scene *s = lighting->scene;
	return (gw_sampled_sources){ .emitters = &lighting->emitters,
								 .samples = s->options.light_samples,
								 .sky = lighting->plan.sky_radiance,
								 .map = &lighting->map,
								 .map_samples = s->options.light_samples,
								 .map_hits = true,
								 .portals = &s->portals,
								 .looked = true,
								 .seed = (uint32_t)s->options.seed };
}

gw_status gw_lighting_sample_small(gw_lighting *lighting, bool *large, gw_error *error)
{
	const float black[3] = { 0 };
	gw_scene *s = lighting->scene;
	const gw_record_context on = gw_scene_context(s, &s->records);
	*large = lighting->plan.emitters && lighting->emitters.area_share >= GW_SAMPLED_SHARE;
	const gw_sampled_sources sources = { .emitters = &lighting->emitters,
										 .samples = *large ? 0 : s->options.light_samples,
										 .sky = black,
										 .map = &lighting->map,
										 .map_samples = s->options.light_samples,
										 .looked = true,
										 .seed = (uint32_t)s->options.seed };
	return gw_ray_gather_sampled(&on, &s->rays, &sources, &s->records.first, error);
}
