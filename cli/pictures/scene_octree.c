#include "pictures/scene_octree.h"
#include "scene/octree_note.h"

#include <stdlib.h>

float *scene_octree_radiance(const render_scene *scene)
{
	size_t stride = scene->raster.channel_count;
	float *radiance = calloc(scene->surfels.count, 3 * sizeof *radiance);
	int offset = scene->offset[RENDER_RADIANCE];
	for (size_t i = 0; radiance && offset >= 0 && i < 3 * scene->surfels.count; i++)
		radiance[i] = scene->channel[i / 3 * stride + (size_t)offset + i % 3];
	return radiance;
}

gw_status scene_octree_create(const settings *s, const render_scene *scene, scene_octree_use use,
							  gw_render_octree **octree, gw_error *error)
{
	const gw_render_octree_options options = { .device = s->bake.device,
											   .passes = s->bake.passes,
											   .validate = s->bake.validate,
											   .memory = s->bake.memory,
											   .depth = s->bake.depth,
											   .leaf_spacing = s->bake.leaf_spacing,
											   .regions = use >= SCENE_OCTREE_CELLS,
											   .bricks = use >= SCENE_OCTREE_BRICKS };
	float *radiance = scene_octree_radiance(scene);
	if (!radiance)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the light of %zu points",
					   scene->surfels.count);
	gw_status status = gw_render_octree_create(&scene->surfels, radiance, &options, octree, error);
	free(radiance);
	if (status != GW_OK || s->quiet)
		return status;
	gw_octree_width width = gw_render_octree_width(*octree);
	octree_note_print(width.leaf_size, width.wanted_leaf_size, width.why_coarser);
	return GW_OK;
}
