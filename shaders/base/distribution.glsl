/*
 * distribution.glsl - how the intensity of a luminaire depends on direction, from `distribution`:
 * ascending angles from the axis and around it, degrees, then a share for each pair of them
 * (gw_light.distribution in glowworm.h).
 */
#ifndef DISTRIBUTION_GLSL
#define DISTRIBUTION_GLSL

#define GW_DEGREES 57.2957795f

/* Of the angles from `first` on, at least two, the one at or before `angle` that has another behind
 * it; share: how far between the two `angle` is. */
uint distribution_place(uint first, uint count, float angle, OUT(float) share)
{
	uint low = 0u, high = count - 1u;
	while (high - low > 1u) {
		uint middle = (low + high) / 2u;
		if (distribution[first + middle] <= angle)
			low = middle;
		else
			high = middle;
	}
	float before = distribution[first + low], behind = distribution[first + low + 1u];
	share = clamp((angle - before) / (behind - before), 0.0f, 1.0f);
	return low;
}

/* Of the angles around the axis the plane-th: the share at a place between angles from the axis. */
float distribution_of_plane(uint first, uint place, float share)
{
	return mix(distribution[first + place], distribution[first + place + 1u], share);
}

/* Share of the intensity in a direction, unit: x along `across`, z along the axis. Dark beyond the
 * angles from the axis. */
float distribution_share(uint verticals, uint horizontals, IN(vec3) way)
{
	float aside = sqrt(way.x * way.x + way.y * way.y), along, around = 0.0f;
	float vertical = min(atan(aside, way.z) * GW_DEGREES, 180.0f);
	if (vertical < distribution[0] || vertical > distribution[verticals - 1u])
		return 0.0f;
	uint place = distribution_place(0u, verticals, vertical, along);
	uint table = verticals + horizontals;
	if (horizontals < 2u)
		return distribution_of_plane(table, place, along);
	float horizontal = aside > 0.0f ? atan(way.y, way.x) * GW_DEGREES : 0.0f;
	horizontal += horizontal < 0.0f ? 360.0f : 0.0f;
	uint plane = distribution_place(verticals, horizontals, horizontal, around);
	table += plane * verticals;
	return mix(distribution_of_plane(table, place, along),
			   distribution_of_plane(table + verticals, place, along), around);
}

#endif
