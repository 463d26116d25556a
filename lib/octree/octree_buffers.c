/* octree_buffers.c - the buffers of the octree's steps; see octree_steps.h. */
#include "octree/octree_steps.h"

gw_status gw_octree_buffer(gw_octree_work *work, VkFormat format, uint64_t bytes, const char *name,
						   gw_buffer *buffer, gw_error *error)
{
	return gw_buffer_create(
		work->gpu, &(gw_buffer_description){ GW_BUFFER_TEXEL, format, bytes, name }, buffer, error);
}

gw_status gw_octree_buffer_unset(gw_octree_work *work, VkFormat format, uint64_t bytes,
								 const char *name, gw_buffer *buffer, gw_error *error)
{
	return gw_buffer_create_unset(
		work->gpu, &(gw_buffer_description){ GW_BUFFER_TEXEL, format, bytes, name }, buffer, error);
}

gw_status gw_octree_buffers(gw_octree_work *work, const gw_octree_part *parts, size_t count,
							gw_error *error)
{
	for (size_t i = 0; i < count; i++)
		GW_TRY(gw_octree_buffer(work, parts[i].format, parts[i].bytes, parts[i].name,
								parts[i].buffer, error));
	return GW_OK;
}
