/*
 * volume_inject.comp - light propagation volumes: adds what surface and sky send into a cell to its
 * light, and to the sum (Kaplanyan and Dachsbacher 2010, section 4.1). A facet sends its flux as a
 * cosine lobe about its normal; list_weight holds the facet's share times 4 over the area through
 * which light gets into the cell (propagation.c), so that a cell into which all send the same
 * radiance has that. One invocation takes a batch of a cell's list; the first one also what the sky
 * sends through faces at the grid's end.
 */
#include "base/pass.glsl"
#include "base/harmonic_values.h"
#include "light/transport_layout.h"

TEXELS(0, uint, list_first); /* a cell, and the end */
TEXELS(1, uint, list_facet); /* + GW_SENDS_BACK */
TEXELS(2, float, list_weight);
TEXELS(3, vec4, facet_plane);
TEXELS(4, vec4, facet_radiance);
TEXELS(5, vec4, cell_sky); /* harmonics of a sky of radiance 1 */
BUFFER(6, readwrite, vec4, cell_radiance);
BUFFER(7, readwrite, vec4, cell_sum);
PUSH(gw_volume_push);

/* Harmonics of the cosine lobe: light that goes along n arrives from -n. */
float lobe(uint j, vec3 n)
{
	return harmonic_cosine(j) * harmonic_value(j, -n.x, -n.y, -n.z);
}

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	uint cell = push.first + i, first = texelFetch(list_first, int(cell)).x;
	uint end = texelFetch(list_first, int(cell) + 1).x;
	vec3 sum[4];
	for (uint j = 0u; j < 4u; j++)
		sum[j] = vec3(0.0f);
	if (push.batch_first == 0u) {
		vec4 sky = texelFetch(cell_sky, int(cell));
		sum[0] = push.sky.xyz * sky.x;
		sum[1] = push.sky.xyz * sky.y;
		sum[2] = push.sky.xyz * sky.z;
		sum[3] = push.sky.xyz * sky.w;
	}
	for (uint k = first + push.batch_first;
		 k < min(end, first + push.batch_first + push.batch_count); k++) {
		uint word = texelFetch(list_facet, int(k)).x;
		int facet = int(word & ~GW_SENDS_BACK);
		float side = (word & GW_SENDS_BACK) != 0u ? -1.0f : 1.0f;
		vec3 n = texelFetch(facet_plane, facet).xyz * side;
		vec3 sent = texelFetch(facet_radiance, facet).xyz * texelFetch(list_weight, int(k)).x;
		for (uint j = 0u; j < 4u; j++)
			sum[j] += sent * lobe(j, n);
	}
	for (uint j = 0u; j < 4u; j++) {
		cell_radiance[i * 4u + j] = cell_radiance[i * 4u + j] + vec4(sum[j], 0.0f);
		cell_sum[i * 4u + j] = cell_sum[i * 4u + j] + vec4(sum[j], 0.0f);
	}
}
