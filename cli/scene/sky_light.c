#include "scene/sky_light.h"
#include "panoramas/panorama_reader.h"

/* The light is scaled to what it is to give. */
static gw_status read_map(lamp *light, panorama *map, gw_error *error)
{
	if (light->model)
		return light_sky(light, map, error);
	GW_TRY(panorama_read(light->map, map, error));
	gw_status status = light_scale_map(light, map, error);
	if (status != GW_OK)
		panorama_clear(map);
	return status;
}

gw_status sky_light_map(lamp *light, char up, panorama *map, gw_error *error)
{
	if (up != 'y' && up != 'z')
		return gw_fail(error, GW_ERROR_USAGE,
					   "%s, a map of the sky, needs y or z to point up, not %s; turn the points, "
					   "with \"matrix\" of an input in a scene file",
					   light->model ? sky_model_name(light->model) : light->map,
					   settings_up_name(up));
	return read_map(light, map, error);
}

static gw_status add_sky(lamp *light, char up, sky_light *sky, gw_error *error)
{
	light_resolve(light, up);
	if (!light->map[0] && !light->model) {
		for (int k = 0; k < 3; k++)
			sky->radiance[k] += light->light.radiance[k];
		return GW_OK;
	}
	if (sky->has_map)
		return gw_fail(error, GW_ERROR_USAGE,
					   "two lights have maps of the sky, of which a picture reflects one");
	GW_TRY(sky_light_map(light, up, &sky->map, error));
	sky->has_map = true;
	sky->light = light->light;
	sky->light.map = sky->map.pixels;
	sky->light.map_width = sky->map.width;
	sky->light.map_height = sky->map.height;
	return GW_OK;
}

gw_status sky_light_find(const settings *s, char up, sky_light *sky, gw_error *error)
{
	gw_status status = GW_OK;
	*sky = (sky_light){ .has_map = false };
	for (size_t i = 0; i < s->light_count && status == GW_OK; i++) {
		lamp light = s->light[i];
		if (light.light.type == GW_LIGHT_ENVIRONMENT)
			status = add_sky(&light, up, sky, error);
	}
	if (status != GW_OK)
		sky_light_clear(sky);
	return status;
}

void sky_light_clear(sky_light *sky)
{
	if (sky->has_map)
		panorama_clear(&sky->map);
	*sky = (sky_light){ .has_map = false };
}
