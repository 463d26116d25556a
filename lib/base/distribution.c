/*
 * distribution.c - see distribution.h.
 */
#include "base/distribution.h"

/* More would be no luminaire, and nobody could measure them. */
#define ANGLES_MOST 65536u
#define SHARES_MOST (1u << 26)

/* Sine of the angle between the axis and what is across it, at least. */
#define ACROSS_LEAST 1e-4

static double length_of(const double v[3])
{
	return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* In double, so that what is nearly along the axis keeps its direction. Returns the sine between
 * the two. */
static double find_frame(const gw_light *light, double axis[3], double across[3])
{
	double long_axis = length_of(light->direction), long_across = length_of(light->across);
	double along = 0.0;
	for (int k = 0; k < 3; k++) {
		axis[k] = light->direction[k] / long_axis;
		across[k] = light->across[k] / long_across;
		along += axis[k] * across[k];
	}
	for (int k = 0; k < 3; k++)
		across[k] -= along * axis[k];
	double sine = length_of(across);
	for (int k = 0; k < 3; k++)
		across[k] /= sine;
	return sine;
}

bool gw_light_has_place(const gw_light *light)
{
	return light->type != GW_LIGHT_SUN && light->type != GW_LIGHT_ENVIRONMENT;
}

bool gw_light_shines(const gw_light *light)
{
	const float *power = light->type == GW_LIGHT_SUN ? light->irradiance : light->intensity;
	return light->type != GW_LIGHT_ENVIRONMENT && (power[0] > 0 || power[1] > 0 || power[2] > 0);
}

bool gw_distribution_has_frame(const gw_light *light)
{
	double axis[3], across[3];
	return find_frame(light, axis, across) > ACROSS_LEAST && isfinite(axis[0] + across[0]);
}

void gw_distribution_frame(const gw_light *light, gw_vec3 *axis, gw_vec3 *across)
{
	double a[3], b[3];
	find_frame(light, a, b);
	*axis = (gw_vec3){ (float)a[0], (float)a[1], (float)a[2] };
	*across = (gw_vec3){ (float)b[0], (float)b[1], (float)b[2] };
}

bool gw_distribution_counts(const gw_light *light)
{
	return light->distribution && (light->type == GW_LIGHT_POINT || light->type == GW_LIGHT_DISC ||
								   light->type == GW_LIGHT_RECTANGLE);
}

size_t gw_distribution_length(const gw_light *light)
{
	size_t verticals = light->vertical_count, horizontals = light->horizontal_count;
	return light->distribution ? verticals + horizontals + verticals * horizontals : 0;
}

float gw_distribution_towards(const gw_light *light, gw_vec3 way)
{
	gw_vec3 axis, across;
	bool has = gw_distribution_counts(light);
	if (!has && (light->type == GW_LIGHT_DISC || light->type == GW_LIGHT_RECTANGLE)) {
		const double *d = light->direction;
		double along = d[0] * (double)way.x + d[1] * (double)way.y + d[2] * (double)way.z;
		return (float)fmax(along / length_of(d), 0.0);
	}
	if (!has)
		return 1.0f;
	gw_distribution_frame(light, &axis, &across);
	gw_vec3 up = { across.y * axis.z - across.z * axis.y, across.z * axis.x - across.x * axis.z,
				   across.x * axis.y - across.y * axis.x };
	return gw_distribution_share(
		light->distribution, light->vertical_count, light->horizontal_count,
		(gw_vec3){ gw_dot(way, across), gw_dot(way, up), gw_dot(way, axis) });
}

static bool ascend(const float *angle, uint32_t count, float least, float most)
{
	bool good = true;
	for (uint32_t i = 0; i < count; i++)
		good = good && angle[i] >= least && angle[i] <= most && (i == 0 || angle[i] > angle[i - 1]);
	return good;
}

const char *gw_distribution_fault(const gw_light *light)
{
	uint32_t verticals = light->vertical_count, horizontals = light->horizontal_count;
	const float *angle = light->distribution;
	if (verticals < 2 || horizontals < 1 || verticals > ANGLES_MOST || horizontals > ANGLES_MOST ||
		(uint64_t)verticals * horizontals > SHARES_MOST)
		return "it needs from 2 to 65536 angles from its axis and from 1 around it";
	if (!ascend(angle, verticals, 0.0f, 180.0f))
		return "its angles from the axis must ascend within 0 to 180 degrees";
	angle += verticals;
	if (!ascend(angle, horizontals, 0.0f, 360.0f) ||
		(horizontals > 1 && !(angle[0] == 0.0f && angle[horizontals - 1] == 360.0f)))
		return "its angles around the axis must ascend from 0 to 360 degrees";
	for (size_t i = 0, count = (size_t)verticals * horizontals; i < count; i++)
		if (!(angle[horizontals + i] >= 0.0f && isfinite(angle[horizontals + i])))
			return "its shares must be finite and 0 or more";
	if (!gw_distribution_has_frame(light))
		return "it needs a direction, and one across it";
	return NULL;
}
