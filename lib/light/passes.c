/*
 * passes.c - table of the light transport's passes, see passes.h.
 */
#include "light/passes.h"

#include "light/shadow_layout.h"
#include "light/transport_layout.h"

#include <assert.h>
#include <string.h>

/* How far a leaf's plane reaches beyond its cell, in cells, to close the cracks between neighbours.
 * Of the rays inside a sphere 30 cells wide 0.19 % escape at 0.02, 0.08 % at 0.1; from 0.2 on,
 * planes that stick out over edges cost more light than cracks do. */
#define CELL_SLACK 0.1f

/* Of one pass, at most. Of textures, which texel buffers count as, every device takes 16. */
#define BINDINGS 18u

/* Bindings by letter, in binding order: t texel buffer, s storage buffer, i storage image,
 * m sampled image. */
typedef struct pass_row {
	const char *shader;
	const char *bindings;
	uint32_t push_bytes;
	uint32_t loop_bound; /* iterations of one invocation, at most */
} pass_row;

static const pass_row table[GW_PASS_COUNT] = {
	[GW_PASS_LIGHT_VISIBILITY] = { "light_visibility", "tttttsssttttttt", sizeof(gw_light_push),
								   4096 },
	[GW_PASS_SHADOW_MAP_SPLAT] = { "shadow_map_splat", "ttss", sizeof(gw_shadow_push),
								   (GW_SHADOW_TILE + 1) * GW_SHADOW_TILE },
	[GW_PASS_SHADOW_MAP_VISIBILITY] = { "shadow_map_visibility", "tsss", sizeof(gw_shadow_push),
										36 },
	[GW_PASS_LIGHT_IRRADIANCE] = { "light_irradiance", "ssss", sizeof(gw_light_push), 0 },
	[GW_PASS_LOBE_DIRECT] = { "lobe_direct", "tttts", sizeof(gw_record_push), 2048 },
	[GW_PASS_RECORD_PLACE] = { "record_place", "tttttsss", sizeof(gw_record_push), 2048 },
	[GW_PASS_RECORD_BLOCK] = { "record_block", "ttssst", sizeof(gw_lookup_push), 32 },
	[GW_PASS_RECORD_RAYS] = { "record_rays", "tttttttssttttttt", sizeof(gw_record_push), 4096 },
	[GW_PASS_RECORD_KEEP] = { "record_keep", "tttttttsss", sizeof(gw_keep_push), 1024 },
	[GW_PASS_RECORD_AGAIN] = { "record_again", "ttttttttssttttttt", sizeof(gw_keep_push), 4096 },
	[GW_PASS_RECORD_EMITTERS] = { "record_emitters", "tttttttssstttttttt", sizeof(gw_record_push),
								  4096 },
	[GW_PASS_RECORD_SKY] = { "record_sky", "tttttttssstttttttt", sizeof(gw_record_push), 4096 },
	[GW_PASS_RECORD_DIRECTIONS] = { "record_directions", "ttts", sizeof(gw_record_push), 0 },
	[GW_PASS_OPENING_LIGHT] = { "opening_light", "ttttsss", sizeof(gw_record_push), 4096 },
	[GW_PASS_RECORD_OPENINGS] = { "record_openings", "ttttttttsttttttt", sizeof(gw_record_push),
								  4096 },
	[GW_PASS_RECORD_FIRST] = { "record_first", "ttttsssstt", sizeof(gw_record_push), 4096 },
	[GW_PASS_RECORD_GATHER] = { "record_gather", "ttss", sizeof(gw_record_push), 4096 },
	[GW_PASS_RECORD_ADD] = { "record_add", "ss", sizeof(gw_record_push), 0 },
	[GW_PASS_LOBE_WEIGHTS] = { "lobe_weights", "ttttttttttsstt", sizeof(gw_lookup_push), 4096 },
	[GW_PASS_LOBE_SHADE] = { "lobe_shade", "ssttts", sizeof(gw_record_push), GW_WEIGHTS },
	[GW_PASS_BRICK_INJECT] = { "brick_inject", "ttttti", sizeof(gw_cone_push), 8 },
	[GW_PASS_BRICK_MIPMAP] = { "brick_mipmap", "ttii", sizeof(gw_cone_push), 48 },
	[GW_PASS_RECORD_CONES] = { "record_cones", "ttmmsss", sizeof(gw_cone_push), 4096 },
	[GW_PASS_READ_BACK] = { "read_back", "ttttttttttttsstt", sizeof(gw_lookup_push), 4096 },
	[GW_PASS_PIXEL_RAYS] = { "pixel_rays", "ttttttttttttssst", sizeof(gw_pixel_push), 4096 },
	[GW_PASS_PIXEL_CONE] = { "pixel_cone", "ttmmsss", sizeof(gw_cone_push), 256 },
	[GW_PASS_CELL_BRICKS] = { "cell_bricks", "ttmmss", sizeof(gw_cone_push), 0 },
	[GW_PASS_PIXEL_BRICKS] = { "pixel_bricks", "ttmmsss", sizeof(gw_cone_push), 64 },
};

void gw_passes_init(gw_passes *passes, gw_gpu *gpu, const gw_octree *octree)
{
	const float slack = CELL_SLACK;
	*passes = (gw_passes){ .gpu = gpu, .constant = { octree->depth, octree->directory_level } };
	memcpy(&passes->constant[2], &slack, sizeof slack);
	passes->constant[3] = octree->tree_discs > 0;
}

void gw_passes_destroy(gw_passes *passes)
{
	for (int i = 0; i < GW_PASS_COUNT; i++)
		gw_pass_destroy(passes->gpu, &passes->pass[i]);
	*passes = (gw_passes){ 0 };
}

bool gw_passes_fit(const gw_passes *passes, const gw_octree *octree)
{
	return passes->constant[3] == (octree->tree_discs > 0);
}

static gw_binding_kind binding_kind(char letter)
{
	switch (letter) {
	case 't':
		return GW_BIND_TEXEL;
	case 'i':
		return GW_BIND_STORAGE_IMAGE;
	case 'm':
		return GW_BIND_SAMPLED_IMAGE;
	default:
		assert(letter == 's');
		return GW_BIND_STORAGE;
	}
}

static gw_status create(gw_passes *passes, gw_pass_id id, gw_error *error)
{
	const pass_row *row = &table[id];
	const gw_shader *shader = gw_shader_find(row->shader);
	gw_binding_kind kinds[BINDINGS];
	uint32_t count = (uint32_t)strlen(row->bindings);
	assert(count <= BINDINGS);
	for (uint32_t i = 0; i < count; i++)
		kinds[i] = binding_kind(row->bindings[i]);
	return gw_pass_create(passes->gpu,
						  &(gw_pass_description){ .name = row->shader,
												  .spirv = shader->spirv,
												  .spirv_words = shader->words,
												  .bindings = kinds,
												  .binding_count = count,
												  .push_bytes = row->push_bytes,
												  .constant = passes->constant,
												  .constant_count = 4,
												  .loop_bound = row->loop_bound },
						  &passes->pass[id], error);
}

gw_status gw_passes_run(gw_passes *passes, gw_pass_id id, const gw_binding *bindings,
						const void *push, uint64_t count, gw_error *error)
{
	if (passes->pass[id] == NULL) {
		gw_status status = create(passes, id, error);
		if (status != GW_OK)
			return status;
	}
	double before = gw_gpu_read_account(passes->gpu).device_seconds;
	gw_status status = gw_pass_run(passes->gpu, passes->pass[id], bindings, push, count, error);
	passes->device_seconds[id] += gw_gpu_read_account(passes->gpu).device_seconds - before;
	return status;
}
