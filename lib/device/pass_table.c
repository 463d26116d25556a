/*
 * pass_table.c - see pass_table.h.
 */
#include "device/pass_table.h"

#include "device/sort_layout.h"
#include "base/harmonic_values.h"
#include "octree/octree_layout.h"
#include "light/shadow_layout.h"
#include "light/transport_layout.h"
#include "picture/gloss_cache.h"

#include <assert.h>

/* Iterations of the octree's loops, see their shaders: a disc of 8 cells is looked at in 19 x 19
 * columns of 4 rows. Searches take 32 steps, for at most 7 neighbours. */
#define DISC_LOOPS (19u * 19u * 5u + 27u)
#define SEARCH_LOOPS (7u * 34u)

/* Samples of the sky, and rays that may have met a portal, of one invocation; of emitters it takes
 * GW_EMITTER_BATCH. */
#define SKY_BATCH 16u
#define PORTAL_BATCH 32u

/* Facets that send light into a cell, of one invocation. */
#define SENDER_BATCH 1024u

/* Reasons. */
#define OCTREE "the octree is built one way on every device, which a CPU kernel would hardly hasten"
#define PLACES "once a bake, for each record a few steps"
#define SAMPLER "the driver's sampler filters images, which a loop would have to do itself"
#define PIXELS "for glossy pictures, which few ask for"

#define BATCHES_OF(samples)                                                                        \
	.batch = (samples), .batch_at = (uint32_t)offsetof(gw_record_push, batch_first)

static const gw_pass_row table[GW_PASS_COUNT] = {
	[GW_PASS_PREFIX_SUM] = { "prefix_sum", "ss", sizeof(gw_prefix_push), GW_PREFIX_RUN,
							 .cpu = gw_cpu_prefix_sum },
	/* The kernels of the sort are loops of their own: they take few long runs, each with its counts
	 * in an array on its thread's stack, where shaders have thousands of short ones that count in
	 * place, which threads of a processor would wait for each other at. */
	[GW_PASS_RADIX_COUNT] = { "radix_count", "ts", sizeof(gw_radix_push),
							  GW_RADIX_DIGITS + GW_RADIX_RUN_MAX, .cpu = gw_cpu_radix_count },
	[GW_PASS_RADIX_SCATTER] = { "radix_scatter", "tttssss", sizeof(gw_radix_push), GW_RADIX_RUN_MAX,
								.cpu = gw_cpu_radix_scatter },

	[GW_PASS_OCTREE_FRAGMENTS] = { "octree_fragments", "tttttsstwwws", sizeof(gw_fragments_push),
								   DISC_LOOPS, .why = OCTREE },
	[GW_PASS_OCTREE_INVERT] = { "octree_invert", "sw", sizeof(gw_keys_push), .why = OCTREE },
	[GW_PASS_OCTREE_MARK] = { "octree_mark", "tts", sizeof(gw_keys_push), .why = OCTREE },
	[GW_PASS_OCTREE_UNIQUE] = { "octree_unique", "ttsww", sizeof(gw_keys_push), .why = OCTREE },
	[GW_PASS_OCTREE_PARENTS] = { "octree_parents", "ttss", sizeof(gw_keys_push), .why = OCTREE },
	[GW_PASS_OCTREE_BORDER] = { "octree_border", "tttsss", sizeof(gw_border_push), SEARCH_LOOPS,
								.why = OCTREE },
	[GW_PASS_OCTREE_LINK] = { "octree_link", "ttwwww", sizeof(gw_tiles_push), SEARCH_LOOPS,
							  .why = OCTREE },
	[GW_PASS_OCTREE_LEAF_TILES] = { "octree_leaf_tiles", "ttsw", sizeof(gw_leaves_push),
									SEARCH_LOOPS, .why = OCTREE },
	[GW_PASS_OCTREE_SEED] = { "octree_seed", "tttttss", sizeof(gw_leaves_push), GW_REDUCE_RUN,
							  .why = OCTREE },
	[GW_PASS_OCTREE_JOIN] = { "octree_join", "ttws", sizeof(gw_leaves_push), GW_REDUCE_RUN,
							  .why = OCTREE },
	[GW_PASS_OCTREE_FACETS] = { "octree_facets", "ttttttttttttssss", sizeof(gw_leaves_push),
								3 * GW_REDUCE_RUN, .why = OCTREE },
	[GW_PASS_OCTREE_FINISH] = { "octree_finish", "tttttssssss", sizeof(gw_leaves_push),
								.why = OCTREE },
	[GW_PASS_OCTREE_DISTANCE] = { "octree_distance", "tts", sizeof(gw_distance_push),
								  .why = OCTREE },

	[GW_PASS_LIGHT_VISIBILITY] = { "light_visibility", "tttttssstttttttsts", sizeof(gw_light_push),
								   4096, .cpu = gw_cpu_light_visibility },
	[GW_PASS_SHADOW_MAP_SPLAT] = { "shadow_map_splat", "ttsst", sizeof(gw_shadow_push),
								   (GW_SHADOW_TILE + 1) * GW_SHADOW_TILE,
								   .why = "shadow maps are there to be compared with rays" },
	[GW_PASS_SHADOW_MAP_VISIBILITY] = { "shadow_map_visibility", "tsss", sizeof(gw_shadow_push), 36,
										.why = "shadow maps are there to be compared with rays" },
	[GW_PASS_LIGHT_IRRADIANCE] = { "light_irradiance", "sssss", sizeof(gw_light_push), 64,
								   .cpu = gw_cpu_light_irradiance },
	[GW_PASS_FACET_DIRECT] = { "facet_direct", "ttttst", sizeof(gw_record_push), 2048,
							   .cpu = gw_cpu_facet_direct },
	[GW_PASS_RECORD_PLACE] = { "record_place", "tttttssst", sizeof(gw_record_push), 2048,
							   .why = PLACES },
	[GW_PASS_RECORD_BLOCK] = { "record_block", "ttssstt", sizeof(gw_lookup_push), 32,
							   .why = PLACES },
	[GW_PASS_RECORD_RAYS] = { "record_rays", "tttttttsstttttttts", sizeof(gw_record_push), 4096,
							  .cpu = gw_cpu_record_rays },
	[GW_PASS_RECORD_KEEP] = { "record_keep", "tttttttsss", sizeof(gw_keep_push), 1024,
							  .why = "once a frame, and a small part of it" },
	[GW_PASS_RECORD_AGAIN] = { "record_again", "ttttttttsstttttttts", sizeof(gw_keep_push), 4096,
							   .cpu = gw_cpu_record_again },
	[GW_PASS_RECORD_EMITTERS] = { "record_emitters", "tttttttssstttttttttss",
								  sizeof(gw_record_push), 4096, BATCHES_OF(SKY_BATCH),
								  .cpu = gw_cpu_record_emitters },
	[GW_PASS_RECORD_SKY] = { "record_sky", "tttttttssstttttttttss", sizeof(gw_record_push), 4096,
							 BATCHES_OF(SKY_BATCH), .cpu = gw_cpu_record_sky },
	[GW_PASS_RECORD_PORTALS] = { "record_portals", "ttttttttstttttttts", sizeof(gw_record_push),
								 4096, .cpu = gw_cpu_record_portals },
	[GW_PASS_PORTAL_LIGHT] = { "portal_light", "ttttssss", sizeof(gw_record_push), 4096,
							   BATCHES_OF(PORTAL_BATCH), .cpu = gw_cpu_portal_light },
	[GW_PASS_RECORD_FIRST] = { "record_first", "ttttsssstts", sizeof(gw_record_push), 4096,
							   .cpu = gw_cpu_record_first },
	[GW_PASS_RECORD_GATHER] = { "record_gather", "ttsst", sizeof(gw_record_push), 4096,
								.cpu = gw_cpu_record_gather },
	[GW_PASS_RECORD_MOMENTS] = { "record_moments", "ttssst", sizeof(gw_record_push), 4096,
								 .cpu = gw_cpu_record_moments },
	[GW_PASS_RECORD_SHARE] = { "record_share", "ttttttttttsssss", sizeof(gw_record_push), 4096,
							   .cpu = gw_cpu_record_share },
	[GW_PASS_RECORD_ADD] = { "record_add", "ss", sizeof(gw_record_push), .cpu = gw_cpu_record_add },
	[GW_PASS_FACET_WEIGHTS] = { "facet_weights", "ttttttttttsstts", sizeof(gw_lookup_push), 4096,
								.cpu = gw_cpu_facet_weights },
	[GW_PASS_FACET_SHADE] = { "facet_shade", "sstttss", sizeof(gw_record_push), GW_WEIGHTS,
							  .cpu = gw_cpu_facet_shade },
	[GW_PASS_LIGHT_SUM] = { "light_sum", "ttts", sizeof(gw_sum_push), GW_SUM_RUN,
							.why = "where kernels run, loops that add up read what they left" },
	[GW_PASS_READ_BACK] = { "read_back", "ttttttttttttsstt", sizeof(gw_lookup_push), 4096,
							.cpu = gw_cpu_read_back },
	[GW_PASS_PROBE_SIGHT] = { "probe_sight", "ttttttttstttttttts", sizeof(gw_probe_push), 4096,
							  .cpu = gw_cpu_probe_sight },
	[GW_PASS_PROBE_RAYS] = { "probe_rays", "tttttttsstttttttts", sizeof(gw_probe_push), 4096,
							 .cpu = gw_cpu_probe_rays },

	[GW_PASS_VOLUME_RAYS] = { "volume_rays", "tttttttstttttttts", sizeof(gw_volume_push), 4096,
							  .cpu = gw_cpu_volume_rays },
	[GW_PASS_VOLUME_FILL] = { "volume_fill", "ttstts", sizeof(gw_volume_push), 4096,
							  .cpu = gw_cpu_volume_fill },
	[GW_PASS_VOLUME_WEIGHTS] = { "volume_weights", "ttttttttttsst", sizeof(gw_volume_push), 4096,
								 .cpu = gw_cpu_volume_weights },
	[GW_PASS_VOLUME_READ] = { "volume_read", "sstts", sizeof(gw_volume_push),
							  GW_VOLUME_WEIGHTS *GW_HARMONICS_MOST, .cpu = gw_cpu_volume_read },
	[GW_PASS_VOLUME_FACES] = { "volume_faces", "ttttttstttttttts", sizeof(gw_volume_push), 4096,
							   .cpu = gw_cpu_volume_faces },
	[GW_PASS_VOLUME_INJECT] = { "volume_inject", "ttttttss", sizeof(gw_volume_push),
								4 * SENDER_BATCH, .batch = SENDER_BATCH,
								.batch_at = (uint32_t)offsetof(gw_volume_push, batch_first),
								.cpu = gw_cpu_volume_inject },
	[GW_PASS_VOLUME_SPREAD] = { "volume_spread", "tttss", sizeof(gw_volume_push), 4 * GW_CELL_FACES,
								.cpu = gw_cpu_volume_spread },

	[GW_PASS_RECORD_DIRECTIONS] = { "record_directions", "ttts", sizeof(gw_record_push),
									.why = PLACES },
	[GW_PASS_BRICK_INJECT] = { "brick_inject", "tttttitt", sizeof(gw_cone_push), 8,
							   .why = SAMPLER },
	[GW_PASS_BRICK_MIPMAP] = { "brick_mipmap", "ttii", sizeof(gw_cone_push), 48, .why = SAMPLER },
	[GW_PASS_RECORD_CONES] = { "record_cones", "ttmmssstttt", sizeof(gw_cone_push), 4096,
							   .why = SAMPLER },

	[GW_PASS_PIXEL_RAYS] = { "pixel_rays", "ttttttttttttsssttts", sizeof(gw_pixel_push), 4096,
							 .why = PIXELS },
	[GW_PASS_GIVEN_RAYS] = { "given_rays", "ttttttttttttsssttts", sizeof(gw_pixel_push), 4096,
							 .cpu = gw_cpu_given_rays },
	[GW_PASS_PIXEL_CONE] = { "pixel_cone", "ttmmssst", sizeof(gw_cone_push), 256, .why = SAMPLER },
	[GW_PASS_PIXEL_BRICKS] = { "pixel_bricks", "ttmmsss", sizeof(gw_cone_push), 64,
							   .why = SAMPLER },
	[GW_PASS_CELL_BRICKS] = { "cell_bricks", "ttmmss", sizeof(gw_cone_push), .why = SAMPLER },
	[GW_PASS_CACHE_RAYS] = { "cache_rays", "ttttttttttttttsttts", sizeof(gw_cache_push), 4096,
							 .cpu = gw_cpu_cache_rays },
	[GW_PASS_CACHE_MIPS] = { "cache_mips", "s", sizeof(gw_cache_push), GW_CACHE_TEXELS,
							 .cpu = gw_cpu_cache_mips },
	[GW_PASS_PIXEL_CACHES] = { "pixel_caches", "ttttttsss", sizeof(gw_cache_push), 4096,
							   .cpu = gw_cpu_pixel_caches },
};

const gw_pass_row *gw_pass_row_of(gw_pass_id id)
{
	assert((unsigned)id < GW_PASS_COUNT);
	return &table[id];
}
