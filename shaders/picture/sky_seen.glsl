/*
 * sky_seen.glsl - what of the sky is seen in a direction: an even radiance, and the environment's
 * map (see gw_light.map), blended linearly between the middles of its texels, so that a mirror
 * shows no squares. Uses the texel buffer sky_texel and `push`, which has sky, sky_width,
 * sky_height (0: there is no map), sky_turn and sky_y_up.
 */
#ifndef SKY_SEEN_GLSL
#define SKY_SEEN_GLSL

vec3 sky_texel_of(int column, int row)
{
	int width = int(push.sky_width), height = int(push.sky_height);
	column = (column + width) % width;
	return texelFetch(sky_texel, clamp(row, 0, height - 1) * width + column).xyz;
}

vec3 sky_seen(vec3 direction)
{
	if (push.sky_width == 0u)
		return push.sky.xyz;
	float up = push.sky_y_up != 0u ? direction.y : direction.z;
	float north = push.sky_y_up != 0u ? -direction.z : direction.y;
	float turn = abs(up) < 1.0f ? atan(direction.x, north) / (2.0f * GW_PI) : 0.0f;
	float x = fract(turn + 0.5f - push.sky_turn) * float(push.sky_width) - 0.5f;
	float y = acos(clamp(up, -1.0f, 1.0f)) / GW_PI * float(push.sky_height) - 0.5f;
	int column = int(floor(x)), row = int(floor(y));
	vec3 above = mix(sky_texel_of(column, row), sky_texel_of(column + 1, row), fract(x));
	vec3 below = mix(sky_texel_of(column, row + 1), sky_texel_of(column + 1, row + 1), fract(x));
	return push.sky.xyz + mix(above, below, fract(y));
}

#endif
