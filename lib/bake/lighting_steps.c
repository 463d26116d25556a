/*
 * lighting_steps.c - see lighting_steps.h.
 */
#include "bake/lighting_steps.h"

#include "bake/options_check.h"
#include "bake/report.h"
#include "bake/sampled_light.h"
#include "bake/scene_records.h"
#include "bake/volume_light.h"
#include "light/bounces.h"
#include "light/cones_apart.h"
#include "light/direct_light.h"
#include "light/gap_light.h"
#include "light/shared_rays.h"
#include "light/shut_out.h"
#include "octree/compartments.h"
#include "base/luminance.h"
#include "base/memory.h"

#include <math.h>
#include <stdlib.h>

#define PATCH_SEED 0x2c1b3c6du

/* ------------------------------------------------------------------------------ first gather */

static void report_portals(gw_report *report, const gw_portals *portals)
{
	double percent = 100.0 * (double)portals->escaped;
	if (portals->count > 0)
		gw_report_effect(report, "portals", "sampled beside the rays",
						 "%.3g %% of the rays leave the scene; %u cells let most of them through",
						 percent, portals->count);
	else
		gw_report_effect(report, "portals", NULL, "%.3g %% of the rays leave the scene%s", percent,
						 percent > 0.0 ? ", through no portal" : "");
}

static gw_status open_to_sky(gw_lighting *lighting, gw_error *error)
{
	if (!lighting->plan.sky && !lighting->plan.portals)
		return GW_OK;
	GW_TRY(gw_scene_open_to_sky(lighting->scene, error));
	if (lighting->plan.portals)
		report_portals(lighting->scene->report, &lighting->scene->portals);
	return GW_OK;
}

static gw_status first_by_rays(gw_lighting *lighting, gw_error *error)
{
	gw_scene *s = lighting->scene;
	const gw_record_context on = gw_scene_context(s, &s->records);
	const gw_record_context further = gw_scene_context(s, &s->further);
	gw_sampled_sources sources = gw_lighting_sources(lighting);
	sources.use_hits = true;
	sources.kept = lighting->plan.emitters ? &s->sampled : NULL;
	sources.moment = gw_scene_moment_of(s, &s->records.first_moment);
	sources.kept_moment = &s->sampled_moment;
	gw_status status = open_to_sky(lighting, error);
	if (status == GW_OK && s->further.count > 0 && sources.kept &&
		s->sampled.handle != VK_NULL_HANDLE)
		status = gw_ray_gather_sample_further(&further, &s->further_rays, &sources, error);
	gw_scene_forget_further(s);
	GW_TRY(status);
	return gw_ray_gather_sampled(&on, &s->rays, &sources, &s->records.first, error);
}

/* Buffers see the sky and large emitters; small emitters, the map of the sky and portals are
 * sampled. */
static gw_status first_by_buffers(gw_lighting *lighting, gw_error *error)
{
	gw_scene *s = lighting->scene;
	const gw_record_context on = gw_scene_context(s, &s->records);
	bool large = lighting->plan.emitters && lighting->emitters.area_share >= GW_SAMPLED_SHARE;
	gw_sampled_sources sources = gw_lighting_sources(lighting);
	if (large)
		sources.samples = 0;
	GW_TRY(open_to_sky(lighting, error));
	gw_ray_gather hits = s->buffers.hits; /* portals are sampled alike, whatever the rays are */
	hits.through = s->rays.through;
	GW_TRY(gw_ray_gather_sampled(&on, &hits, &sources, &s->records.first, error));
	if (!large)
		return GW_OK;
	GW_TRY(gw_micro_buffers_bounce(&on, &s->buffers, &s->octree.facet_emission, error));
	return gw_light_add(&s->passes, &s->records.gathered, &s->records.first, s->records.count,
						error);
}

static float largest_emission(const gw_surfels *surfels)
{
	float largest = 0.0f;
	for (size_t i = 0; i < 3 * surfels->count; i++)
		largest = fmaxf(largest, surfels->emission[i]);
	return largest;
}

static gw_status add_gathered(gw_scene *s, gw_error *error)
{
	return gw_light_add(&s->passes, &s->records.gathered, &s->records.first, s->records.count,
						error);
}

/* Cones see the sky and large emitters; small emitters and the map of the sky are sampled. */
static gw_status first_by_cones(gw_lighting *lighting, gw_error *error)
{
	const float black[3] = { 0 };
	gw_scene *s = lighting->scene;
	const gw_record_context on = gw_scene_context(s, &s->records);
	const gw_plan *plan = &lighting->plan;
	bool in_voxels;
	GW_TRY(gw_lighting_sample_small(lighting, &in_voxels, error));
	const float *sky = plan->sky_radiance;
	bool seen = plan->sky && (sky[0] > 0.0f || sky[1] > 0.0f || sky[2] > 0.0f);
	if (!in_voxels && !seen)
		return GW_OK;
	const gw_facet_radiance radiance = {
		.facets = in_voxels ? &s->octree.facet_emission : &lighting->facet_radiance,
		.largest = in_voxels ? largest_emission(&s->surfels) : 1.0f
	};
	GW_TRY(gw_cones_apart_bounce(&on, &s->cones, radiance, seen ? sky : black, &s->records.gathered,
								 error));
	return add_gathered(s, error);
}

/* The map serves all rounds. */
static gw_status make_map(gw_lighting *lighting, gw_error *error)
{
	gw_scene *s = lighting->scene;
	if (!lighting->plan.map || lighting->map_made)
		return GW_OK;
	gw_status status = gw_sky_map_make(s->gpu, lighting->plan.map, &lighting->map, error);
	lighting->map_made = status == GW_OK;
	if (lighting->whole)
		return status;
	gw_report_count(s->report, "map_pixels_repaired", lighting->map.repaired,
					"pixel{|s} of the sky's map that {is|are} negative or no number: taken as 0");
	gw_report_count(
		s->report, "map_pixels_infinite", lighting->map.infinite,
		"pixel{|s} of the sky's map that {is|are} infinite or over 1e12: taken as 65504 or 1e12");
	return status;
}

/* What records see through gaps, which are closed if that is asked for. */
static gw_status see_gaps(gw_lighting *lighting, gw_error *error)
{
	gw_scene *s = lighting->scene;
	const gw_record_context on = gw_scene_context(s, &s->records);
	const float fill[3] = { s->options.gap_radiance, s->options.gap_radiance,
							s->options.gap_radiance };
	const gw_gap_task task = { .on = &on,
							   .rays = &s->rays,
							   .space = &s->space,
							   .sky = lighting->plan.sky_radiance,
							   .map = &lighting->map,
							   .threads = s->options.threads,
							   .surfels = &s->surfels };
	free(lighting->gap);
	lighting->gap = NULL;
	if (!gw_scanned_space_known(&s->space))
		return GW_OK;
	GW_TRY(gw_gap_light_find(&task, &lighting->gap, error));
	if (s->options.gaps == GW_GAPS_OPEN)
		return GW_OK;
	return gw_gap_light_close(&on, lighting->gap, s->options.gaps == GW_GAPS_BLACK ? fill : NULL,
							  !lighting->plan.emitters, &s->records.first, error);
}

/* After records gathered from surfaces. */
static gw_status fill_gaps(gw_lighting *lighting, gw_error *error)
{
	gw_scene *s = lighting->scene;
	const gw_record_context on = gw_scene_context(s, &s->records);
	return lighting->gap && s->options.gaps == GW_GAPS_MEAN
			   ? gw_gap_light_fill(&on, lighting->gap, &s->records.gathered, error)
			   : GW_OK;
}

/* Does every light that has power shine from without? The octree has several compartments. */
static bool all_shine_outside(const gw_lighting *lighting)
{
	const gw_scene *s = lighting->scene;
	bool any = false;
	for (size_t i = 0; i < lighting->light_count; i++) {
		const gw_light *light = &lighting->lights[i];
		bool sky = light->type == GW_LIGHT_ENVIRONMENT;
		if (!(sky ? gw_luminance(light->radiance) > 0.0 : gw_light_shines(light)))
			continue;
		const gw_lamp lamp = gw_lamp_of(light, &s->octree, &s->surfels, &s->options);
		any = true;
		if (!sky && !gw_shut_out_is_outside(&s->octree, &lamp.push))
			return false;
	}
	return any && !lighting->plan.emitters;
}

/* Counts points that look into a closed space. */
static size_t count_shut_in(const gw_scene *scene)
{
	const gw_surfels *s = &scene->surfels;
	uint32_t outside = gw_compartment_outside(&scene->octree);
	size_t count = 0;
	for (size_t i = 0; i < s->point_count; i++) {
		uint32_t surfel = s->surfel_of_point[i];
		bool within = false;
		for (int back = 0; back < 2 && surfel != UINT32_MAX; back++)
			within |= gw_compartments_apart(
				outside, gw_compartment_of_surfel(&scene->octree, surfel, back == 1));
		count += within;
	}
	return count;
}

/* A room with its doors shut under the sun is black, or lit on the outside of its walls. */
static void report_shut_in(const gw_lighting *lighting)
{
	gw_scene *s = lighting->scene;
	bool shut = gw_compartments_several(&s->octree) && all_shine_outside(lighting);
	gw_report_count(
		s->report, "shut_in", shut ? count_shut_in(s) : 0,
		"of the points {closes|close} off a space while all lights are outside of it: nothing of "
		"them gets in, and what is lit are its outer sides; a light inside shows the space");
}

gw_status gw_lighting_gather_first(gw_lighting *lighting, gw_error *error)
{
	gw_scene *s = lighting->scene;
	uint64_t facets = s->octree.facet_count;
	GW_TRY(gw_scene_find_compartments(s, error));
	if (s->options.method != GW_METHOD_CONES && !gw_transport_is_written(s->options.transport))
		gw_octree_drop_neighbours(s->gpu, &s->octree);
	GW_TRY(gw_lighting_darken(lighting, GW_BUFFER_TEXEL, facets, "facet radiance",
							  &lighting->facet_radiance, error));
	if (!lighting->whole)
		report_shut_in(lighting);
	gw_emitters_destroy(s->gpu, &lighting->emitters);
	lighting->emitters.radiance = &s->octree.facet_emission;
	if (lighting->plan.emitters)
		GW_TRY(gw_emitters_make(s->gpu, &s->octree, &s->octree.facet_emission, true,
								&lighting->emitters, error));
	GW_TRY(make_map(lighting, error));
	s->report->directional = gw_scene_keeps_moments(s);
	if (s->report->directional)
		GW_TRY(gw_records_make_moments(s->gpu, &s->records, error));
	else
		gw_records_drop_moments(s->gpu, &s->records);
	gw_method method = s->options.method;
	GW_TRY(gw_method_keeps_hits(method)  ? first_by_rays(lighting, error)
		   : method == GW_METHOD_CONES   ? first_by_cones(lighting, error)
		   : method == GW_METHOD_BUFFERS ? first_by_buffers(lighting, error)
										 : gw_volume_light_first(lighting, error));
	return see_gaps(lighting, error);
}

/* ----------------------------------------------------------------------------------- bounces */

/* By hits that are kept, of rays or buffers. */
static gw_status gather_by_hits(void *self, const gw_buffer *facet_radiance, float largest,
								gw_error *error)
{
	gw_scene *s = ((gw_lighting *)self)->scene;
	const gw_record_context on = gw_scene_context(s, &s->records);
	(void)largest;
	if (s->options.method == GW_METHOD_BUFFERS)
		return gw_micro_buffers_bounce(&on, &s->buffers, facet_radiance, error);
	GW_TRY(gw_ray_gather_bounce(&s->passes, &s->rays, facet_radiance, &s->records, error));
	return fill_gaps(self, error);
}

/* Parts are sampled by the radiance of the whole, so it is copied. */
static gw_status keep_patches(gw_lighting *lighting, const gw_buffer *facet_radiance,
							  gw_error *error)
{
	gw_scene *s = lighting->scene;
	uint64_t facets = s->octree.facet_count;
	GW_TRY(gw_lighting_darken(lighting, GW_BUFFER_TEXEL, facets, "radiance of patches",
							  &lighting->patch_radiance, error));
	GW_TRY(gw_light_add(&s->passes, facet_radiance, &lighting->patch_radiance, facets, error));
	lighting->patches.radiance = &lighting->patch_radiance;
	return GW_OK;
}

/* Samples lit facets, half as often as what emits: patches carry less of the light, and of all that
 * is done for other lamps this takes the longest. Rays that hit them count as well; of buffers a
 * texel may show more than a patch. part is NULL, or what is gathered of their radiance. */
static gw_status sample_patches(gw_scene *s, const gw_emitters *patches, const gw_buffer *part,
								gw_error *error)
{
	const gw_record_context on = gw_scene_context(s, &s->records);
	const float black[3] = { 0 };
	bool rays = gw_method_keeps_hits(s->options.method);
	const gw_sampled_sources sources = { .emitters = patches,
										 .part = part,
										 .samples = (s->options.light_samples + 1) / 2,
										 .use_hits = rays,
										 .sky = black,
										 .looked = true,
										 .seed = (uint32_t)s->options.seed ^ PATCH_SEED,
										 .moment =
											 gw_scene_moment_of(s, &s->records.indirect_moment) };
	return gw_ray_gather_sampled(&on, rays ? &s->rays : &s->buffers.hits, &sources,
								 &s->records.gathered, error);
}

static gw_status sample_and_fill(gw_lighting *lighting, const gw_emitters *patches,
								 const gw_buffer *part, gw_error *error)
{
	GW_TRY(sample_patches(lighting->scene, patches, part, error));
	return fill_gaps(lighting, error);
}

/* What lamps and emitters light is sampled like an emitter: rays would miss small bright patches.
 */
static gw_status gather_patches(void *self, const gw_buffer *facet_radiance, float largest,
								gw_error *error)
{
	gw_lighting *lighting = self;
	gw_scene *s = lighting->scene;
	if (lighting->whole)
		return lighting->whole->patches_sampled
				   ? sample_and_fill(lighting, &lighting->whole->patches, facet_radiance, error)
				   : gather_by_hits(self, facet_radiance, largest, error);
	gw_emitters *patches = &lighting->patches;
	gw_emitters_destroy(s->gpu, patches);
	GW_TRY(gw_emitters_make(s->gpu, &s->octree, facet_radiance, false, patches, error));
	lighting->patches_sampled = gw_emitters_are_small(patches);
	gw_status status = lighting->patches_sampled
						   ? sample_and_fill(lighting, patches, NULL, error)
						   : gather_by_hits(self, facet_radiance, largest, error);
	if (status == GW_OK && lighting->kept && lighting->patches_sampled)
		status = keep_patches(lighting, facet_radiance, error);
	else
		gw_emitters_destroy(s->gpu, patches);
	return status;
}

static gw_status gather_by_cones(void *self, const gw_buffer *facet_radiance, float largest,
								 gw_error *error)
{
	gw_scene *s = ((gw_lighting *)self)->scene;
	const float black[3] = { 0 };
	const gw_record_context on = gw_scene_context(s, &s->records);
	const gw_facet_radiance radiance = { .facets = facet_radiance, .largest = largest };
	return gw_cones_apart_bounce(&on, &s->cones, radiance, black, &s->records.gathered, error);
}

/* The guess at the surfels' light, as the mean over each facet. */
static gw_status carry(const gw_lighting *lighting, gw_buffer *facets, gw_error *error)
{
	gw_scene *s = lighting->scene;
	gw_buffer surfels = { 0 };
	uint64_t bytes = 16 * (uint64_t)s->surfels.count;
	GW_TRY(gw_buffer_create(s->gpu,
							&(gw_buffer_description){ GW_BUFFER_STORAGE, VK_FORMAT_UNDEFINED,
													  16 * (uint64_t)s->octree.facet_count,
													  "carried light of facets" },
							facets, error));
	GW_TRY(
		gw_buffer_create(s->gpu,
						 &(gw_buffer_description){ GW_BUFFER_TEXEL, VK_FORMAT_R32G32B32A32_SFLOAT,
												   bytes, "carried irradiance" },
						 &surfels, error));
	gw_status status = gw_buffer_upload(s->gpu, &surfels, 0, lighting->carried, bytes, error);
	if (status == GW_OK)
		status = gw_average_facets(&s->passes, &s->octree, &surfels, facets, error);
	gw_buffer_destroy(s->gpu, &surfels);
	return status;
}

/* What reached the records and whose reflection was gathered, by hits, into *irradiance: all, but
 * for what came last. Where the first reflection was sampled, that has its moment already; where
 * the first bounce was a guess at all others, it is what came, and nothing is left. */
static gw_status add_reflected(gw_lighting *lighting, bool first, bool last, gw_buffer *irradiance,
							   gw_error *error)
{
	gw_scene *s = lighting->scene;
	gw_records *r = &s->records;
	if (first)
		GW_TRY(gw_light_add(&s->passes, &r->first, irradiance, r->count, error));
	GW_TRY(gw_light_add(&s->passes, &r->indirect, irradiance, r->count, error));
	return last ? GW_OK : gw_light_take(&s->passes, &r->gathered, irradiance, r->count, error);
}

/* What facets send out of all whose reflection was gathered by hits. */
static gw_status shade_again(gw_lighting *lighting, uint32_t bounce_count, bool carried,
							 gw_error *error)
{
	gw_scene *s = lighting->scene;
	const gw_record_context on = gw_scene_context(s, &s->records);
	bool first = !(lighting->whole ? lighting->whole : lighting)->patches_sampled;
	gw_buffer irradiance = { 0 };
	GW_TRY(gw_lighting_darken(lighting, GW_BUFFER_TEXEL, s->records.count,
							  "reflected irradiance of records", &irradiance, error));
	gw_status status =
		add_reflected(lighting, first, carried && bounce_count == 2, &irradiance, error);
	if (status == GW_OK)
		status = gw_facets_shade(&on, &irradiance, &lighting->facet_direct, first ? 1.0f : 0.0f,
								 &lighting->facet_radiance, error);
	gw_buffer_destroy(s->gpu, &irradiance);
	return status;
}

/* The moment of what was gathered by hits; and this and the sky as all rays around see them: what
 * closes gaps knows of a record's own alone. */
static gw_status look_again(gw_lighting *lighting, uint32_t bounce_count, bool carried,
							gw_error *error)
{
	gw_scene *s = lighting->scene;
	const gw_record_context on = gw_scene_context(s, &s->records);
	const gw_sampled_sources sources = gw_lighting_sources(lighting);
	bool moments = gw_scene_keeps_moments(s), reflected = bounce_count > 1;
	const gw_buffer *radiance = reflected ? &lighting->facet_radiance : NULL;
	const gw_shared_rays shared = { &on, &s->rays, &sources, radiance, moments };
	/* Of records that read probes, these keep what was hit, not what lies along rays of records. */
	bool shares = s->options.method == GW_METHOD_RAYS && s->rays.rays <= GW_SHARED_RAYS_MOST &&
				  !gw_scene_closed_space(s);
	if (!gw_method_keeps_hits(s->options.method) || !(moments || shares))
		return GW_OK;
	if (reflected)
		GW_TRY(shade_again(lighting, bounce_count, carried, error));
	if (reflected && moments)
		GW_TRY(gw_ray_gather_moments(&on, &s->rays, radiance, &s->records.indirect_moment, error));
	return shares ? gw_shared_rays_see(&shared, error) : GW_OK;
}

gw_status gw_lighting_bounce(gw_lighting *lighting, gw_error *error)
{
	gw_scene *s = lighting->scene;
	gw_report *report = s->report;
	const gw_trace_step steps[GW_METHOD_COUNT] = {
		[GW_METHOD_RAYS] = { gather_by_hits, gather_patches, NULL, &s->rays, lighting },
		[GW_METHOD_PROBES] = { gather_by_hits, gather_patches, NULL, &s->rays, lighting },
		[GW_METHOD_BUFFERS] = { gather_by_hits, gather_patches, NULL, NULL, lighting },
		[GW_METHOD_CONES] = { .gather = gather_by_cones, .self = lighting },
		[GW_METHOD_VOLUME] = { .gather = gw_volume_light_gather,
							   .gather_apart = gw_volume_light_gather_apart,
							   .self = lighting },
		[GW_METHOD_LPV] = { .gather = gw_volume_light_gather,
							.gather_apart = gw_volume_light_gather_apart,
							.self = lighting },
	};
	bool rays = gw_method_keeps_hits(s->options.method);
	gw_bounces bounces;
	gw_bounces_task task = { .on = gw_scene_context(s, &s->records),
							 .facet_direct = &lighting->facet_direct,
							 .facet_radiance = &lighting->facet_radiance,
							 .step = steps[s->options.method],
							 .limit = lighting->plan.bounces ? lighting->plan.limit : 1,
							 .tolerance = gw_options_bounce_tolerance(&s->options),
							 .no_bound = lighting->whole != NULL,
							 .lit_elsewhere = s->known != NULL,
							 .cancelled = gw_scene_stopped,
							 .user = s };
	gw_buffer carried = { 0 };
	gw_status status = gw_buffer_fill(s->gpu, &s->records.indirect, 0, error);
	if (status == GW_OK && gw_scene_keeps_moments(s))
		status = gw_buffer_fill(s->gpu, &s->records.indirect_moment, 0, error);
	if (status == GW_OK && rays && lighting->carried && task.limit == GW_BOUNCES_AUTO) {
		status = carry(lighting, &carried, error);
		task.carried = &carried;
	}
	if (status == GW_OK)
		status = gw_bounces_run(&task, &bounces, error);
	gw_buffer_destroy(s->gpu, &carried);
	GW_TRY(status);
	status = look_again(lighting, bounces.bounce_count, task.carried != NULL, error);
	gw_buffer_destroy(s->gpu, &lighting->facet_radiance); /* of the last bounce */
	if (status != GW_OK) {
		free(bounces.bounce);
		return status;
	}
	if (lighting->whole) {
		free(bounces.bounce);
		return GW_OK;
	}
	free(report->bounce);
	report->bounce = bounces.bounce;
	report->bounce_count = bounces.bounce_count;
	report->remaining = bounces.remaining;
	return GW_OK;
}

/* --------------------------------------------------------------------------------- read back */

/* What is downloaded of the records: 16 floats of each. */
typedef struct record_light {
	float *irradiance, *normal, *moment;
} record_light;

/* By each surfel's own normal. */
static gw_status read_directed(const gw_scene *s, const gw_buffer *moment,
							   const record_light *records, float *surfels, gw_error *error)
{
	uint64_t count = s->records.count;
	const gw_directed_light light = { .irradiance = records->irradiance,
									  .moment = records->moment,
									  .record_normal = records->normal,
									  .surfel_normal = s->surfels.normal,
									  .count = s->records.count };
	GW_TRY(gw_buffer_download(s->gpu, moment, 0, records->moment, 32 * count, error));
	GW_TRY(gw_buffer_download(s->gpu, &s->records.normal, 0, records->normal, 16 * count, error));
	return gw_read_back_apply_directed(&s->read_back, &light, s->options.threads, surfels, error);
}

/* Interpolates an irradiance of the records, which has that moment, at every surfel. */
static gw_status read_back(const gw_scene *s, const gw_buffer *irradiance, const gw_buffer *moment,
						   const record_light *records, float **surfels, gw_error *error)
{
	GW_TRY(gw_buffer_download(s->gpu, irradiance, 0, records->irradiance,
							  16 * (uint64_t)s->records.count, error));
	if (!*surfels)
		*surfels = gw_allocate_array(s->surfels.count, 4 * sizeof **surfels);
	if (!*surfels)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the light of %zu surfels",
					   s->surfels.count);
	if (gw_scene_keeps_moments(s))
		return read_directed(s, moment, records, *surfels, error);
	gw_read_back_apply(&s->read_back, records->irradiance, s->options.threads, *surfels);
	return GW_OK;
}

gw_status gw_lighting_read_back(gw_lighting *lighting, gw_error *error)
{
	const gw_scene *s = lighting->scene;
	const gw_records *r = &s->records;
	float *values =
		gw_allocate_array(r->count, (gw_scene_keeps_moments(s) ? 16 : 4) * sizeof *values);
	if (!values)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %u records", r->count);
	const record_light records = { values, values + 4 * (size_t)r->count,
								   values + 8 * (size_t)r->count };
	gw_status status =
		read_back(s, &r->first, &r->first_moment, &records, &lighting->surfel_first, error);
	if (status == GW_OK)
		status = read_back(s, &r->indirect, &r->indirect_moment, &records,
						   &lighting->surfel_indirect, error);
	if (status == GW_OK && gw_method_has_cells(s->options.method))
		status = gw_volume_light_read_back(lighting, error);
	free(values);
	return status;
}

gw_status gw_lighting_run(gw_lighting *lighting, gw_error *error)
{
	GW_TRY(gw_lighting_direct(lighting, error));
	if (lighting->plan.records)
		GW_TRY(gw_lighting_gather_first(lighting, error));
	if (lighting->plan.records)
		GW_TRY(gw_lighting_bounce(lighting, error));
	if (lighting->plan.records)
		GW_TRY(gw_lighting_read_back(lighting, error));
	return GW_OK;
}
