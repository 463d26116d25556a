/*
 * volume_read.comp - read-back step of a radiance volume: irradiance of places, by the spherical
 * harmonics of the cells in their rows and those of a cosine lobe along their normals (Ramamoorthi
 * and Hanrahan 2001, equation 8). Few harmonics swing below 0 and above what is there: irradiance
 * is held between 0 and push.most.
 */
#include "base/pass.glsl"
#include "base/harmonic_values.h"
#include "light/transport_layout.h"

BUFFER(0, readonly, uint, row_cell); /* GW_VOLUME_WEIGHTS a place: see volume_weights.comp */
BUFFER(1, readonly, float, row_weight);
TEXELS(2, vec4, place_normal);
TEXELS(3, vec4, cell_radiance);
BUFFER(4, writeonly, vec4, irradiance);
PUSH(gw_volume_push);

float held(float value)
{
	return max(0.0f, min(value, push.most));
}

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	vec4 n = texelFetch(place_normal, int(push.place_first + push.first + i));
	bool both_sides = push.both_sides != 0u && n.w > 0.5f;
	float lobe[GW_HARMONICS_MOST];
	for (uint j = 0u; j < GW_HARMONICS_MOST; j++) {
		bool odd = j > 0u && j < 4u; /* those of the other side are of the other sign */
		lobe[j] = both_sides && odd ? 0.0f : harmonic_cosine(j) * harmonic_value(j, n.x, n.y, n.z);
	}
	vec3 sum = vec3(0.0f);
	uint row = i * GW_VOLUME_WEIGHTS;
	for (uint w = row; w < row + GW_VOLUME_WEIGHTS && row_cell[w] != GW_NONE; w++) {
		vec3 e = vec3(0.0f);
		int first = int(row_cell[w] * push.terms);
		for (uint j = 0u; j < push.terms; j++)
			e += texelFetch(cell_radiance, first + int(j)).xyz * lobe[j];
		sum += e * row_weight[w];
	}
	irradiance[i] = vec4(held(sum.x), held(sum.y), held(sum.z), 0.0f);
}
