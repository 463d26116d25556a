/*
 * facet_weights.comp - the records each facet's irradiance is interpolated from, once for all
 * bounces: the GW_WEIGHTS heaviest, with weights that sum to 1.
 */
#include "light/transport_layout.h"
#include "octree/octree_walk.glsl"

TEXELS(0, uint, ray_directory);
TEXELS(1, uint, node);
TEXELS(2, uvec2, leaf_tile);
TEXELS(3, vec4, facet_plane);
TEXELS(4, vec4, facet_centre);
TEXELS(5, uint, level_directory);
TEXELS(6, vec4, record_position);
TEXELS(7, vec4, record_normal);
TEXELS(8, uint, block_first);
TEXELS(9, uint, block_record);
BUFFER(10, readwrite, uint, row_record);
BUFFER(11, readwrite, float, row_weight);
TEXELS(12, float, facet_reach);
TEXELS(13, uvec4, disc_tree);
BUFFER(14, readonly, uint, row_facet); /* whose row that is */
PUSH(gw_lookup_push);

#define ROW_WIDTH GW_WEIGHTS
#include "light/record_lookup.glsl"

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	row = i * ROW_WIDTH;
	used = 0u;
	int facet = int(row_facet[i]);
	reach = push.radius;
	if (push.own_reach != 0u && row_facet[i] != GW_NONE)
		reach = texelFetch(facet_reach, facet).x;
	if (reach == 0.0f)
		return; /* the row stays */
	for (uint w = row; w < row + ROW_WIDTH; w++) {
		row_weight[w] = 0.0f;
		row_record[w] = GW_NONE;
	}
	if (row_facet[i] == GW_NONE)
		return;
	vec4 centre = texelFetch(facet_centre, facet);
	Seeker seeker = { centre.xyz, texelFetch(facet_plane, facet).xyz, false };
	if (centre.w > 0.0f)
		find_records(seeker);
}
