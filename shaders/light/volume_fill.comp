/*
 * volume_fill.comp - basis step of a radiance volume: the spherical harmonics of the radiance that
 * arrives at the centre of a cell along its rays, 4 pi / N sum L Y (Mavridis and Papaioannou,
 * equation 3). Rays that left the scene see the sky, unless the cell is shut off from it.
 */
#include "base/pass.glsl"
#include "base/harmonic_values.h"
#include "light/transport_layout.h"

TEXELS(0, vec4, cell_centre); /* w: mark of its compartment */
TEXELS(1, vec4, pattern);
BUFFER(2, readonly, uint, cell_hit);
TEXELS(3, vec4, facet_radiance);
TEXELS(4, vec4, sky_texel);
BUFFER(5, writeonly, vec4, cell_radiance);
PUSH(gw_volume_push);

#include "light/volume_ray.glsl"
#include "light/sky_map.glsl"

vec3 seen(uint hit, vec3 direction, bool shut)
{
	if (hit != GW_NONE)
		return texelFetch(facet_radiance, int(hit)).xyz;
	if (shut)
		return vec3(0.0f);
	vec3 sky = push.sky.xyz;
	if (push.sky_width > 0u)
		sky += texelFetch(sky_texel, sky_texel_at(direction)).xyz;
	return sky;
}

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	vec4 centre = texelFetch(cell_centre, int(push.first + i));
	Turn turn = turn_of_cell(centre.xyz);
	vec3 sum[GW_HARMONICS_MOST];
	for (uint j = 0u; j < push.terms; j++)
		sum[j] = vec3(0.0f);
	for (uint k = 0u; k < push.rays; k++) {
		vec3 d = turned(turn, texelFetch(pattern, int(k)).xyz);
		vec3 radiance = seen(cell_hit[i * push.rays + k], d, centre.w > GW_MARK_OUTSIDE);
		for (uint j = 0u; j < push.terms; j++)
			sum[j] += radiance * harmonic_value(j, d.x, d.y, d.z);
	}
	for (uint j = 0u; j < push.terms; j++)
		cell_radiance[i * push.terms + j] = vec4(sum[j] * (4.0f * GW_PI / float(push.rays)), 0.0f);
}
