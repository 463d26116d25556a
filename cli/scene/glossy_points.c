#include "scene/glossy_points.h"
#include "points/scan_color.h"

#include <math.h>

float glossy_points_share(double value, float otherwise)
{
	return isfinite(value) ? (float)fmin(fmax(value, 0.0), 1.0) : otherwise;
}

float glossy_points_albedo(float albedo, float specular)
{
	/* The mean of F0 + (1 - F0) (1 - cos)^5 over a hemisphere, by the cosine. */
	float gloss = specular > 0.0f ? specular + (1.0f - specular) / 21.0f : 0.0f;
	return fminf(albedo + gloss * (1.0f - albedo), fmaxf(albedo, GW_ALBEDO_MAX));
}

void glossy_points_apply(const settings *s, loaded_scene *scene)
{
	if (!settings_bakes_gloss(s)) {
		scan_remove_column(&scene->cloud, "specular");
		scan_remove_column(&scene->cloud, "roughness");
	}
	const scan_column *specular = scan_find_scalar(&scene->cloud, "specular");
	for (size_t i = 0; specular && i < scene->cloud.count; i++) {
		float share = glossy_points_share(scan_value(specular, i), 0.0f);
		float *albedo = scene->points.albedo + 3 * i;
		for (int k = 0; k < 3; k++)
			albedo[k] = glossy_points_albedo(albedo[k], share);
	}
}
