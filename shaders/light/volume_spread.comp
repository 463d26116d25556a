/*
 * volume_spread.comp - one step of a light propagation volume (Kaplanyan and Dachsbacher 2010,
 * section 4.2): each cell takes what its six neighbours send into it, and adds it to the sum.
 *
 * Light of a neighbour goes from its centre through the face that both share, by the integral of
 * its harmonics over the face's solid angle, a sixth of the sphere, and on from this cell's centre
 * as a cosine lobe along the face's normal, as light from surface does. The paper splits it among
 * the five faces beyond; then an even light before a wall is uneven, because a wall's own lobe is
 * not split. All of this is linear and the same for all cells, so that together it is a few
 * numbers, and no flux is lost or made.
 */
#include "base/pass.glsl"
#include "light/transport_layout.h"

TEXELS(0, uint, face_cell);   /* GW_CELL_FACES a cell: the neighbour, or GW_NONE */
TEXELS(1, float, face_share); /* likewise: 1 in free space */
TEXELS(2, vec4, from_radiance);
BUFFER(3, writeonly, vec4, to_radiance);
BUFFER(4, readwrite, vec4, cell_sum);
PUSH(gw_volume_push);

/*
 * With h_0 = sqrt(1 / (4 pi)) and h_1 = sqrt(3 / (4 pi)), and the integral over the solid angle of
 * the direction's part along the axis, 1.740840: a flux F makes a lobe of F h_0 and 2/3 F h_1 n.
 */
#define KEPT (1.0f / 6.0f) /* band 0 from band 0 */
#define OF_ALONG 0.239944f /* band 0 from band 1 along the axis: h_0 h_1 1.740840 */
#define TO_ALONG 0.192450f /* and back: 2/3 h_1 h_0 4 pi / 6 */
#define ALONG 0.277063f    /* 2/3 h_1^2 1.740840 */

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	uint cell = push.first + i;
	vec4 sum[4];
	for (uint j = 0u; j < 4u; j++)
		sum[j] = vec4(0.0f, 0.0f, 0.0f, 0.0f);
	for (uint face = 0u; face < GW_CELL_FACES; face++) {
		uint other = texelFetch(face_cell, int(cell * GW_CELL_FACES + face)).x;
		if (other == GW_NONE)
			continue;
		float share = texelFetch(face_share, int(cell * GW_CELL_FACES + face)).x;
		/* Harmonics are of where light comes from: from a neighbour on this side it comes from
		 * there. The harmonic along x is the last one. */
		float side = (face & 1u) != 0u ? 1.0f : -1.0f;
		uint along = face < 2u ? 3u : (face >> 1);
		vec4 all = texelFetch(from_radiance, int(other * 4u));
		vec4 ahead = texelFetch(from_radiance, int(other * 4u + along)) * side;
		sum[along] += (all * TO_ALONG + ahead * ALONG) * (share * side);
		sum[0] += (all * KEPT + ahead * OF_ALONG) * share;
	}
	for (uint j = 0u; j < 4u; j++) {
		to_radiance[i * 4u + j] = sum[j];
		cell_sum[i * 4u + j] = cell_sum[i * 4u + j] + sum[j];
	}
}
