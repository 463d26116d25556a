/*
 * read_back.comp - the records each surfel's light is interpolated from, once for all lights:
 * GW_SURFEL_WEIGHTS at most, the heaviest, with weights that sum to 1. A row ends at GW_NONE.
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
TEXELS(10, vec4, surfel_position);
TEXELS(11, vec4, surfel_normal);
BUFFER(12, readwrite, uint, row_record);
BUFFER(13, readwrite, float, row_weight);
TEXELS(14, float, surfel_reach);
TEXELS(15, uvec4, disc_tree);
PUSH(gw_lookup_push);

#define ROW_WIDTH GW_SURFEL_WEIGHTS
#include "light/record_lookup.glsl"

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	row = i * ROW_WIDTH;
	used = 0u;
	int surfel = int(push.surfel_first + push.first + i);
	vec4 normal = texelFetch(surfel_normal, surfel);
	Seeker seeker = { texelFetch(surfel_position, surfel).xyz, normal.xyz, normal.w > 0.5f };
	reach = push.own_reach != 0u ? texelFetch(surfel_reach, surfel).x : push.radius;
	if (reach > 0.0f)
		find_records(seeker);
	if (used < ROW_WIDTH)
		row_record[row + used] = GW_NONE;
}
