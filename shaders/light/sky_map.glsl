/*
 * sky_map.glsl - the environment's map: texels of longitude and latitude, see gw_light.map. Uses
 * `push`, a gw_record_push.
 */
#ifndef SKY_MAP_GLSL
#define SKY_MAP_GLSL

/* The texel that lies in a direction. */
int sky_texel_at(vec3 direction)
{
	float height = push.sky_y_up != 0u ? direction.y : direction.z;
	float north = push.sky_y_up != 0u ? -direction.z : direction.y;
	float u = fract(atan(direction.x, north) / (2.0f * GW_PI) + 0.5f - push.sky_turn);
	float v = acos(clamp(height, -1.0f, 1.0f)) / GW_PI;
	uint column = min(uint(u * float(push.sky_width)), push.sky_width - 1u);
	uint row = min(uint(v * float(push.sky_height)), push.sky_height - 1u);
	return int(row * push.sky_width + column);
}

/* A direction in a texel, evenly by solid angle for even (a, b) in the unit square. */
vec3 sky_direction(uint texel, float a, float b)
{
	uint row = texel / push.sky_width;
	float u = (float(texel % push.sky_width) + a) / float(push.sky_width);
	float height = mix(cos(GW_PI * float(row) / float(push.sky_height)),
					   cos(GW_PI * float(row + 1u) / float(push.sky_height)), b);
	float azimuth = 2.0f * GW_PI * (u - 0.5f + push.sky_turn);
	float level = sqrt(max(0.0f, 1.0f - height * height));
	float east = level * sin(azimuth), north = level * cos(azimuth);
	return push.sky_y_up != 0u ? vec3(east, height, -north) : vec3(east, north, height);
}

#endif
