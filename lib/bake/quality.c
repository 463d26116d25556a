/*
 * quality.c - settings that go together, measured on a Cornell box, two rooms and a cave of 100,000
 * points. Leaves of 1.1 spacings take a tenth off the box's error and leave the cave as it is; with
 * narrower ones the rough surface of the cave gets worse: at 0.9 spacings by 2 %. Of a million
 * points leaves 1.4 times as wide add a tenth at most to an error that is below what is asked for
 * anyway, and take a sixth off the memory: tests/bench/README.md.
 */
#include "glowworm_probes.h"

#define LEAST_RECORDS 1250

/* So many, and never less than a quarter of them, leave 2.0 % in a Cornell box, 1.4 % in a rough
 * cave of a million points, where 62,000 and 67,000 leave 1.8 % and 1.2 %: noise of the rays. */
#define MOST_RECORDS 32768

static const struct {
	const char *name;
	float record_spacing, leaf_spacing;
	uint32_t least_records, most_records, rays, light_samples, cones;
	float gathered_error;
} rows[GW_QUALITY_COUNT] = {
	[GW_QUALITY_DRAFT] = { "draft", 5.0f, GW_LEAF_SPACING_AUTO, LEAST_RECORDS / 4, MOST_RECORDS / 4,
						   16, 16, 8, 0.06f },
	[GW_QUALITY_NORMAL] = { .name = "normal" },
	[GW_QUALITY_HIGH] = { "high", 1.25f, 1.1f, LEAST_RECORDS, 4 * MOST_RECORDS, 256, 256, 32,
						  0.015f },
	[GW_QUALITY_REFERENCE] = { "reference", 0.8f, 1.1f, LEAST_RECORDS, 16 * MOST_RECORDS, 1024,
							   1024, 64, 0.007f },
};

gw_bake_options gw_bake_options_default(void)
{
	return (gw_bake_options){ .method = GW_METHOD_RAYS,
							  .shadows = GW_SHADOWS_TRACED,
							  .depth = GW_DEPTH_AUTO,
							  .leaf_spacing = GW_LEAF_SPACING_AUTO,
							  .bounces = GW_BOUNCES_AUTO,
							  .normals = GW_NORMALS_GIVEN,
							  .tolerance = 0.001f,
							  .rays = 64,
							  .light_samples = 64,
							  .cones = 16,
							  .volume_harmonics = 4,
							  .probe_size = 256,
							  .record_spacing = 2.5f,
							  .least_records = LEAST_RECORDS,
							  .most_records = MOST_RECORDS,
							  .gathered_error = 0.03f,
							  .estimate_points = 500,
							  .shadow_map_size = 1024 };
}

const char *gw_quality_name(gw_quality quality)
{
	return quality < GW_QUALITY_COUNT ? rows[quality].name : "unknown";
}

void gw_bake_options_set_quality(gw_bake_options *options, gw_quality quality)
{
	gw_bake_options set = gw_bake_options_default();
	if (quality != GW_QUALITY_NORMAL) {
		set.record_spacing = rows[quality].record_spacing;
		set.least_records = rows[quality].least_records;
		set.most_records = rows[quality].most_records;
		set.gathered_error = rows[quality].gathered_error;
		set.leaf_spacing = rows[quality].leaf_spacing;
		set.rays = rows[quality].rays;
		set.light_samples = rows[quality].light_samples;
		set.cones = rows[quality].cones;
	}
	options->record_spacing = set.record_spacing;
	options->least_records = set.least_records;
	options->most_records = set.most_records;
	options->gathered_error = set.gathered_error;
	options->leaf_spacing = set.leaf_spacing;
	options->rays = set.rays;
	options->light_samples = set.light_samples;
	options->cones = set.cones;
}

void gw_bake_options_set_start(gw_bake_options *options)
{
	gw_bake_options_set_quality(options, GW_QUALITY_NORMAL);
	options->record_spacing = rows[GW_QUALITY_DRAFT].record_spacing;
	options->least_records = rows[GW_QUALITY_DRAFT].least_records;
	options->most_records = rows[GW_QUALITY_DRAFT].most_records;
}

gw_probes_options gw_probes_options_default(void)
{
	return (gw_probes_options){ .size = 64, .moves = 100, .seed = 1 };
}
