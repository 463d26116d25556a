/*
 * options_check.c - see options_check.h.
 */
#include "bake/options_check.h"
#include "glowworm_host.h"

#include "bake/plan.h"
#include "light/direct_light.h"
#include "light/radiance_volume.h"

#include <math.h>

static gw_status check_number(const char *option, double value, double low, double high,
							  gw_error *error)
{
	if (!(value >= low && value <= high))
		return gw_fail(error, GW_ERROR_USAGE, "%s is %s; give a number from %s to %s", option,
					   GW_SAID(value, 15), GW_SAID(low, 15), GW_SAID(high, 15));
	return GW_OK;
}

bool gw_options_refine(const gw_bake_options *o)
{
	return o->max_error > 0.0f || o->time_limit > 0.0f;
}

float gw_options_bounce_tolerance(const gw_bake_options *o)
{
	return o->max_error > 0.0f ? fminf(o->tolerance, 0.25f * o->max_error) : o->tolerance;
}

bool gw_options_few_records(const gw_bake_options *o)
{
	bool known = o->estimate_points > 0 || !(o->gathered_error > 0.0f);
	return o->method == GW_METHOD_RAYS && o->record_spacing > 0.0f && known;
}

gw_bake_options gw_options_effective(const gw_bake_options *options)
{
	gw_bake_options o = *options;
	if (gw_options_forbid(&o, GW_EFFECT_SHADOWS))
		o.shadows = GW_SHADOWS_NONE;
	if (gw_options_forbid(&o, GW_EFFECT_BOUNCES) && o.bounces > 1)
		o.bounces = 1;
	if (gw_options_forbid(&o, GW_EFFECT_ERROR))
		o.estimate_points = 0;
	if (gw_effect_forced(&o, GW_EFFECT_NORMALS))
		o.normals = GW_NORMALS_ESTIMATE;
	if (gw_options_forbid(&o, GW_EFFECT_NORMALS))
		o.normals = GW_NORMALS_GIVEN;
	if (gw_effect_forced(&o, GW_EFFECT_COLUMNS))
		o.lamps = true;
	return o;
}

/* Effects that are forced or forbidden against what other options say. */
static gw_status check_effects(const gw_bake_options *o, gw_error *error)
{
	const uint32_t known = (1u << GW_EFFECT_KIND_COUNT) - 1;
	const struct {
		uint32_t effects;
		gw_effect_kind effect;
		bool contradicted;
		const char *what;
	} rows[] = {
		{ o->effects_forced, GW_EFFECT_SHADOWS, o->shadows == GW_SHADOWS_NONE,
		  "is forced, but no kind of shadows is chosen" },
		{ o->effects_forced, GW_EFFECT_BOUNCES, o->bounces < 2,
		  "is forced, but the number of bounces leaves no second reflection" },
		{ o->effects_forced, GW_EFFECT_ERROR, o->estimate_points == 0,
		  "is forced, but no points are to be solved again for it" },
		{ o->effects_forbidden, GW_EFFECT_ERROR, gw_options_refine(o),
		  "is forbidden, but the bake is to go on until an error or a time is reached" },
		{ o->effects_forbidden, GW_EFFECT_GAPS, o->gaps != GW_GAPS_OPEN || o->unknown,
		  "is forbidden, but gaps are to be closed or written" },
		{ o->effects_forbidden, GW_EFFECT_NORMALS, o->normals == GW_NORMALS_ESTIMATE,
		  "is forbidden, but all normals are to be estimated" },
		{ o->effects_forbidden, GW_EFFECT_COLUMNS, o->lamps,
		  "is forbidden, but the light of each lamp is asked for" },
		{ o->effects_forbidden, GW_EFFECT_OCTREE, true,
		  "is forbidden; there is none where shadows, emitters, sky and bounces are" },
	};
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
		if (rows[i].contradicted && rows[i].effects & 1u << rows[i].effect)
			return gw_fail(error, GW_ERROR_USAGE, "the effect '%s' %s",
						   gw_effect_name(rows[i].effect), rows[i].what);
	if (o->effects_forced & o->effects_forbidden)
		return gw_fail(error, GW_ERROR_USAGE, "an effect is both forced and forbidden");
	if ((o->effects_forced | o->effects_forbidden) & ~known)
		return gw_fail(error, GW_ERROR_USAGE, "an effect to be forced or forbidden is not known");
	return GW_OK;
}

bool gw_options_occlusion(const gw_bake_options *o)
{
	return o->ambient_occlusion || o->bent_normals;
}

bool gw_options_record_fields(const gw_bake_options *o)
{
	return gw_options_occlusion(o) || o->errors || o->unknown;
}

static gw_status check_volume(const gw_bake_options *o, gw_error *error)
{
	if (o->volume_harmonics != 4 && o->volume_harmonics != 9)
		return gw_fail(error, GW_ERROR_USAGE,
					   "a cell of a volume can have 4 or 9 spherical harmonics, not %u",
					   o->volume_harmonics);
	if (o->method == GW_METHOD_LPV && o->volume_harmonics != 4 && !o->volume)
		return gw_fail(error, GW_ERROR_USAGE,
					   "light that goes from cell to cell has 4 spherical harmonics, not %u; leave "
					   "their number out, or gather it by a volume",
					   o->volume_harmonics);
	if (gw_method_has_cells(o->method) && gw_options_refine(o))
		return gw_fail(error, GW_ERROR_USAGE,
					   "a volume is not refined until an error or a time is reached; ask for more "
					   "cells, or gather by rays");
	if (o->method == GW_METHOD_BUFFERS && gw_options_refine(o))
		return gw_fail(error, GW_ERROR_USAGE,
					   "buffers are not refined until an error or a time is reached; ask for a "
					   "higher quality, or gather by rays");
	if (gw_method_has_cells(o->method) && o->lamps)
		return gw_fail(error, GW_ERROR_USAGE,
					   "the light of single lamps does not add up where a volume gathers, which "
					   "holds each above 0; gather by rays for it");
	return GW_OK;
}

gw_status gw_probes_options_check(const gw_probes_options *o, gw_error *error)
{
	if (o->size < GW_PROBE_SIZE_LEAST || o->size > GW_PROBE_SIZE_MOST ||
		(o->size & (o->size - 1)) != 0)
		return gw_fail(error, GW_ERROR_USAGE,
					   "maps of probes are %u texels wide; give a power of two from %u to %u",
					   o->size, GW_PROBE_SIZE_LEAST, GW_PROBE_SIZE_MOST);
	if (!isfinite(o->margin) || o->margin < 0.0f)
		return gw_fail(error, GW_ERROR_USAGE,
					   "the margin of probes is %s; give metres of at least 0",
					   GW_SAID((double)o->margin, 6));
	if (o->grid > GW_PROBE_GRID_MOST)
		return gw_fail(error, GW_ERROR_USAGE,
					   "a grid of probes has %u a side; give at most %u, or 0 for none", o->grid,
					   GW_PROBE_GRID_MOST);
	return GW_OK;
}

static gw_status check_probes(const gw_bake_options *o, gw_error *error)
{
	gw_probes_options probes = gw_probes_options_default();
	probes.size = o->probe_size;
	if (gw_options_refine(o))
		return gw_fail(error, GW_ERROR_USAGE,
					   "what probes see is not refined until an error or a time is reached; ask "
					   "for larger maps, or gather by rays");
	return gw_probes_options_check(&probes, error);
}

static gw_status check_region(const gw_bake_options *o, gw_error *error)
{
	const gw_region *r = o->region;
	if (!r)
		return GW_OK;
	if (o->method != GW_METHOD_RAYS)
		return gw_fail(error, GW_ERROR_USAGE,
					   "the light of a region is gathered by rays; leave out the method '%s'",
					   gw_method_name(o->method));
	if (o->transport || o->voxels || o->volume)
		return gw_fail(error, GW_ERROR_USAGE,
					   "a region is lit alone, and %s of the whole scene; bake the whole for it",
					   o->transport ? "a transport is" : "grids are");
	if (r->camera && o->surface_points > 0)
		return gw_fail(error, GW_ERROR_USAGE,
					   "what a camera sees is lit with the surface of all points; leave their "
					   "number out, or give a box");
	if (r->camera && !(r->aspect >= 1.0 / 64.0 && r->aspect <= 64.0))
		return gw_fail(error, GW_ERROR_USAGE,
					   "the picture of a region's camera has a width of %s by its height; give "
					   "1/64 to 64",
					   GW_SAID(r->aspect, 6));
	return GW_OK;
}

gw_status gw_options_check(const gw_bake_options *o, const gw_scene_description *scene,
						   gw_error *error)
{
	const struct {
		const char *name;
		double value, low, high;
	} rows[] = {
		{ "depth", o->depth == GW_DEPTH_AUTO ? 1 : o->depth, 1, GW_DEPTH_MAX },
		{ "leaf spacing", o->leaf_spacing == GW_LEAF_SPACING_AUTO ? 1.0 : (double)o->leaf_spacing,
		  0.25, 64 },
		{ "tolerance", (double)o->tolerance, 1e-6, 0.999 },
		{ "rays", o->rays, 1, 4096 },
		{ "light samples", o->light_samples, 1, 4096 },
		{ "cones", o->cones, 1, 256 },
		{ "number of cells of a volume", o->volume_cells > 0 ? o->volume_cells : GW_VOLUME_CELLS,
		  GW_VOLUME_CELLS_LEAST, GW_VOLUME_CELLS_MOST },
		{ "record spacing", (double)o->record_spacing, 0, 64 },
		{ "shadow map size", o->shadow_map_size, 16, 8192 },
		{ "largest error", (double)o->max_error, 0, 1 },
		{ "largest error of gathered light", (double)o->gathered_error, 0, 1 },
		{ "occlusion distance", (double)o->ambient_occlusion_distance, 0, 1e9 },
		{ "time limit", (double)o->time_limit, 0, 1e9 },
		{ "method", (double)o->method, 0, GW_METHOD_COUNT - 1 },
		{ "basis", (double)o->basis, 0, GW_BASIS_COUNT - 1 },
		{ "shadows", (double)o->shadows, 0, GW_SHADOWS_COUNT - 1 },
		{ "gaps", (double)o->gaps, 0, GW_GAPS_COUNT - 1 },
		{ "radiance of gaps", (double)o->gap_radiance, 0, 1e30 },
		{ "passes", (double)o->passes, 0, GW_PASSES_COUNT - 1 },
		{ "normals", (double)o->normals, 0, GW_NORMALS_COUNT - 1 },
		{ "validation", (double)o->validate, 0, GW_VALIDATION_COUNT - 1 },
	};
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
		GW_TRY(check_number(rows[i].name, rows[i].value, rows[i].low, rows[i].high, error));
	GW_TRY(check_effects(o, error));
	if (scene->points->count == 0)
		return gw_fail(error, GW_ERROR_DATA,
					   "the cloud holds no points, so there is nothing to light");
	if (gw_options_refine(o) && o->estimate_points == 0)
		return gw_fail(error, GW_ERROR_USAGE,
					   "an error or a time to aim at needs an estimate of the error; let it have "
					   "at least one point");
	if (gw_options_refine(o) && o->transport)
		return gw_fail(error, GW_ERROR_USAGE,
					   "a bake that refines its settings cannot begin with a transport nor make "
					   "one; leave out the error or time to aim at");
	if (o->basis == GW_BASIS_DIRECTIONAL &&
		(!gw_method_keeps_hits(o->method) || o->gaps != GW_GAPS_OPEN))
		return gw_fail(error, GW_ERROR_USAGE,
					   "records know from where their light comes only if they gather by rays and "
					   "gaps are open; leave the basis to the bake");
	if (o->gaps != GW_GAPS_OPEN && o->method != GW_METHOD_RAYS)
		return gw_fail(error, GW_ERROR_USAGE,
					   "%s not know gaps; leave these open, or gather by rays",
					   o->method == GW_METHOD_CONES     ? "cones do"
					   : o->method == GW_METHOD_PROBES  ? "probes do"
					   : o->method == GW_METHOD_BUFFERS ? "buffers do"
														: "a volume does");
	if (o->surface_points > 0 && o->transport)
		return gw_fail(error, GW_ERROR_USAGE,
					   "a transport is one of all points; leave out how many of them are to make "
					   "the surface");
	GW_TRY(check_volume(o, error));
	if (o->method == GW_METHOD_PROBES)
		GW_TRY(check_probes(o, error));
	GW_TRY(check_region(o, error));
	if (o->gap_radiance > 0.0f && o->gaps != GW_GAPS_BLACK)
		return gw_fail(error, GW_ERROR_USAGE,
					   "gaps send a radiance of their own only where they are closed as black: say "
					   "black for gaps, or leave out their radiance");
	if (o->gap_radiance > 0.0f && o->lamps)
		return gw_fail(error, GW_ERROR_USAGE,
					   "the radiance that gaps send is no lamp's: leave it out, or the light of "
					   "single lamps");
	return gw_lights_check(scene->lights, scene->light_count, error);
}
