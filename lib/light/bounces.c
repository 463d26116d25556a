/*
 * bounces.c - see bounces.h.
 *
 * With T the transport of one bounce (interpolate at the facets, reflect, gather at the records),
 * the irradiance of all bounces is sum T^n E. Rows of T sum to at most the mean albedo of what a
 * record sees, so gathering the albedo itself gives q, the largest row sum, and what is left after
 * a bounce of energy e is at most e q / (1 - q). q < 1 because albedo is clamped below 1: bounces
 * always converge.
 *
 * Bounces may begin with a guess c at the facets' irradiance of all reflected light (Salm 4.5: what
 * a frame leaves to the next). If W interpolates at the facets and G gathers what they reflect, the
 * records' irradiance is y = b + G W y with b of the first reflection. One step from the guess
 * gives y = b + G c, what is missing is G (W y - c) and all that it becomes by further bounces:
 * small where the guess was good, of both signs, and under the same bound.
 */
#include "light/bounces.h"

#include "glowworm_host.h"
#include "light/hit_facets.h"
#include "light/light_sums.h"
#include "light/record_powers.h"
#include "base/luminance.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "light/transport_layout.h"

#include <math.h>
#include <stdlib.h>

/* More reflections than this are never needed: 0.99^2000 is 2e-9. */
#define BOUNCE_CEILING 2000u

#define SUM_CHUNK 4096u /* facets whose light is added up at a time */

gw_status gw_facets_shade(const gw_record_context *on, const gw_buffer *records_irradiance,
						  const gw_buffer *facet_direct, float direct_share,
						  gw_buffer *facet_radiance, gw_error *error)
{
	bool lamps = facet_direct->handle != VK_NULL_HANDLE;
	const gw_binding bindings[] = { gw_window(&on->octree->facet_albedo, 16),
									gw_window(lamps ? facet_direct : &on->octree->facet_albedo, 16),
									gw_whole(&on->records->facet_record),
									gw_whole(&on->records->facet_weight),
									gw_whole(records_irradiance),
									gw_window(facet_radiance, 16),
									gw_window(&on->records->facet_row, 4) };
	return gw_passes_run(on->passes, GW_PASS_FACET_SHADE, bindings,
						 &(gw_record_push){ .direct_share = lamps ? direct_share : 0.0f },
						 on->octree->facet_count, error);
}

/* Sums over facets: on the device where they are shaded there; else a chunk at a time, so that the
 * order does not depend on threads. */
typedef struct facet_sums {
	bool on_device;
	gw_light_sums device;
	gw_light_sum records;     /* on the device: that was read with the facets' */
	gw_view centre, radiance; /* 4 floats a facet, area in w of the centre */
	gw_view albedo;           /* likewise, with transparency; only where something has some */
	size_t facets;
	double *power; /* a chunk: area * |luminance(L)| */
	float *largest;
} facet_sums;

static gw_status sums_create(const gw_bounces_task *task, facet_sums *sums, gw_error *error)
{
	sums->on_device = gw_passes_way(task->on.passes, GW_PASS_FACET_SHADE) == GW_WAY_DEVICE;
	if (sums->on_device)
		return gw_light_sums_create(&task->on, &sums->device, error);
	sums->facets = task->on.octree->facet_count;
	size_t chunks = sums->facets / SUM_CHUNK + 1;
	sums->power = gw_allocate_array(chunks, sizeof *sums->power);
	sums->largest = gw_allocate_array(chunks, sizeof *sums->largest);
	if (!sums->power || !sums->largest)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for sums over %zu facets", sums->facets);
	GW_TRY(gw_view_open(task->on.passes->gpu, &task->on.octree->facet_centre, 16 * sums->facets,
						&sums->centre, error));
	if (task->on.octree->dark_facet == 0)
		return GW_OK;
	return gw_view_open(task->on.passes->gpu, &task->on.octree->facet_albedo, 16 * sums->facets,
						&sums->albedo, error);
}

static void sums_destroy(gw_gpu *gpu, facet_sums *sums)
{
	gw_light_sums_destroy(gpu, &sums->device);
	gw_view_close(&sums->albedo);
	gw_view_close(&sums->centre);
	free(sums->power);
	free(sums->largest);
}

static void sum_chunk(void *user, size_t first, size_t last, uint32_t worker)
{
	const facet_sums *sums = user;
	const float *centre = sums->centre.bytes, *radiance = sums->radiance.bytes,
				*albedo = sums->albedo.bytes;
	double power = 0.0;
	float largest = 0.0f;
	(void)worker;
	for (size_t i = first; i < last; i++) {
		const float *l = radiance + 4 * i;
		for (int c = 0; c < 3; c++)
			largest = l[c] > largest ? l[c] : largest;
		float area = centre[4 * i + 3] * (albedo ? gw_facet_opacity(albedo[4 * i + 3]) : 1.0f);
		power += (double)area * fabs(gw_luminance(l));
	}
	sums->power[first / SUM_CHUNK] = power;
	sums->largest[first / SUM_CHUNK] = largest;
}

static gw_status measure_device(const gw_bounces_task *task, facet_sums *sums, double *power,
								float *largest, gw_error *error)
{
	gw_light_sum facets;
	GW_TRY(gw_light_sums_facets(&task->on, &sums->device, task->facet_radiance, error));
	GW_TRY(gw_light_sums_read(task->on.passes->gpu, &sums->device, &facets, &sums->records, error));
	*power = facets.power;
	*largest = facets.largest;
	return GW_OK;
}

static gw_status measure_chunks(const gw_bounces_task *task, facet_sums *sums, double *power,
								float *largest, gw_error *error)
{
	GW_TRY(gw_view_open(task->on.passes->gpu, task->facet_radiance, 16 * sums->facets,
						&sums->radiance, error));
	gw_parallel_for(task->on.passes->threads, sums->facets, SUM_CHUNK, sum_chunk, sums);
	gw_view_close(&sums->radiance);
	*power = 0.0;
	*largest = 0.0f;
	for (size_t chunk = 0; chunk * SUM_CHUNK < sums->facets; chunk++) {
		*power += sums->power[chunk];
		*largest = fmaxf(*largest, sums->largest[chunk]);
	}
	return GW_OK;
}

/* Energy that the facets reflect, pi * area * |luminance(L)|, and the largest component. */
static gw_status measure(const gw_bounces_task *task, facet_sums *sums, double *energy,
						 float *largest, gw_error *error)
{
	double power, cell = (double)task->on.octree->leaf_size;
	GW_TRY((sums->on_device ? measure_device : measure_chunks)(task, sums, &power, largest, error));
	*energy = power * M_PI * cell * cell;
	return isfinite(*energy) ? GW_OK
							 : gw_fail(error, GW_ERROR_INTERNAL, "a bounce's energy is not finite");
}

/* The largest component of what the records gathered, none of which is below 0. */
static gw_status find_largest(const gw_bounces_task *task, facet_sums *sums, double *largest,
							  gw_error *error)
{
	const gw_records *records = task->on.records;
	gw_gpu *gpu = task->on.passes->gpu;
	gw_view view = { 0 };
	*largest = 0.0;
	if (sums->on_device) {
		gw_light_sum facets;
		/* What their power is does not matter. */
		GW_TRY(gw_light_sums_records(&task->on, &sums->device, &records->gathered, error));
		GW_TRY(gw_light_sums_read(gpu, &sums->device, &facets, &sums->records, error));
		*largest = (double)sums->records.largest;
		return GW_OK;
	}
	GW_TRY(gw_view_open(gpu, &records->gathered, 16 * (uint64_t)records->count, &view, error));
	const float *gathered = view.bytes;
	for (size_t i = 0; i < records->count; i++) {
		for (int c = 0; c < 3; c++)
			*largest = fmax(*largest, (double)gathered[4 * i + (size_t)c]);
	}
	gw_view_close(&view);
	return GW_OK;
}

/* The largest row sum of a bounce: every facet sends out its albedo, the records gather it. */
static gw_status find_contraction(const gw_bounces_task *task, facet_sums *sums,
								  double *contraction, gw_error *error)
{
	const gw_trace_step *step = &task->step;
	double largest;
	GW_TRY((step->gather_apart ? step->gather_apart : step->gather)(
		step->self, &task->on.octree->facet_albedo, 1.0f, error));
	GW_TRY(find_largest(task, sums, &largest, error));
	*contraction = fmin(largest / M_PI, (double)GW_ALBEDO_MAX);
	return GW_OK;
}

static gw_status append(gw_bounces *bounces, gw_bounce bounce, gw_error *error)
{
	gw_bounce *grown =
		gw_resize_array(bounces->bounce, bounces->bounce_count + 1, sizeof *bounces->bounce);
	if (!grown)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for bounce %u",
					   bounces->bounce_count + 1);
	bounces->bounce = grown;
	bounces->bounce[bounces->bounce_count++] = bounce;
	return GW_OK;
}

/* Gathers once and adds it to the indirect irradiance. */
static gw_status gather_once(const gw_bounces_task *task, bool first, float largest,
							 gw_error *error)
{
	gw_records *records = task->on.records;
	const gw_trace_step *step = &task->step;
	GW_TRY((first && step->gather_first ? step->gather_first : step->gather)(
		step->self, task->facet_radiance, largest, error));
	return gw_light_add(task->on.passes, &records->gathered, &records->indirect, records->count,
						error);
}

/* The first gather, a step from the guess, and the radiance of what is missing. *guessed receives
 * the energy that the guess reflects. */
static gw_status begin_carried(const gw_bounces_task *task, facet_sums *sums, float largest,
							   double *guessed, gw_error *error)
{
	gw_records *records = task->on.records;
	GW_TRY(gather_once(task, true, largest, error));
	GW_TRY(gw_buffer_fill(task->on.passes->gpu, &records->gathered, 0, error));
	GW_TRY(gw_facets_shade(&task->on, &records->gathered, task->carried, 1.0f, task->facet_radiance,
						   error));
	GW_TRY(measure(task, sums, guessed, &largest, error));
	GW_TRY(gather_once(task, false, largest, error));
	return gw_facets_shade(&task->on, &records->indirect, task->carried, -1.0f,
						   task->facet_radiance, error);
}

/* Bounces under way. */
typedef struct progress {
	const gw_bounces_task *task;
	facet_sums sums;
	gw_hit_facets hits; /* where a CPU kernel shades: facets that are not hit can be left out */
	bool by_hits;
	gw_record_powers powers; /* where records lie in the processor's memory */
	gw_buffer power;         /* the same on the device, where sums are made there */
	gw_gathered_light light; /* that the last bounce gathered */
	bool gathered;           /* records->gathered is that, and not reflected yet */
	double energy;           /* that the last bounce reflects */
	float largest;
} progress;

/* Finds what the records' irradiance makes facets reflect, and brings it up where it is needed. */
static gw_status find_powers(progress *p, gw_error *error)
{
	const gw_record_context *on = &p->task->on;
	uint64_t bytes = 16 * (uint64_t)on->records->count;
	GW_TRY(gw_record_powers_find(on, &p->powers, error));
	if (!p->sums.on_device)
		return GW_OK;
	GW_TRY(
		gw_buffer_create(on->passes->gpu,
						 &(gw_buffer_description){ GW_BUFFER_TEXEL, VK_FORMAT_R32G32B32A32_SFLOAT,
												   bytes, "power of records" },
						 &p->power, error));
	float *power = gw_allocate_zeros(on->records->count, 4 * sizeof *power);
	if (!power)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the power of %u records",
					   on->records->count);
	for (size_t i = 0; i < on->records->count; i++)
		for (size_t c = 0; c < 3; c++)
			power[4 * i + c] = p->powers.power[3 * i + c];
	gw_status status = gw_buffer_upload(on->passes->gpu, &p->power, 0, power, bytes, error);
	free(power);
	return status;
}

/* What has been gathered, as light of the records: where sums are made on the device it is there
 * when the facets are measured. */
static gw_status measure_records(progress *p, gw_error *error)
{
	const gw_record_context *on = &p->task->on;
	if (!p->powers.power)
		return GW_OK;
	return p->sums.on_device ? gw_light_sums_records(on, &p->sums.device, &p->power, error)
							 : gw_record_powers_measure(on, &p->powers, &p->light, error);
}

/* The facets, and the records where that was put off. */
static gw_status measure_both(progress *p, gw_error *error)
{
	const gw_light_sum *records = &p->sums.records;
	GW_TRY(measure(p->task, &p->sums, &p->energy, &p->largest, error));
	if (!p->powers.power || !p->sums.on_device)
		return GW_OK;
	p->light = (gw_gathered_light){
		.power = records->power,
		.carriers =
			records->squares > 0.0 ? records->power * records->power / records->squares : 0.0,
		.largest = (double)records->largest,
	};
	return GW_OK;
}

/* The energy that is reflected of what has been gathered. */
static gw_status take_energy(progress *p, gw_error *error)
{
	double cell = (double)p->task->on.octree->leaf_size;
	p->gathered = true;
	p->energy = p->light.power * M_PI * cell * cell;
	return isfinite(p->energy)
			   ? GW_OK
			   : gw_fail(error, GW_ERROR_INTERNAL, "a bounce's energy is not finite");
}

/* One more bounce. Where only facets that are hit count, they reflect before the next gather, else
 * all do after this one. */
static gw_status bounce_once(progress *p, bool first, gw_error *error)
{
	const gw_bounces_task *task = p->task;
	if (p->gathered)
		gw_hit_facets_shade(task->on.passes, task->on.octree, task->on.records, &p->hits,
							task->facet_radiance);
	GW_TRY(gather_once(task, first, p->largest, error));
	GW_TRY(measure_records(p, error));
	if (p->by_hits)
		return take_energy(p, error);
	GW_TRY(gw_facets_shade(&task->on, &task->on.records->gathered, task->facet_direct, 0.0f,
						   task->facet_radiance, error));
	return measure_both(p, error);
}

static gw_bounce bounce_done(const progress *p, double started)
{
	return (gw_bounce){ .energy = p->energy,
						.seconds = gw_seconds() - started,
						.carriers = p->light.carriers,
						.largest_irradiance = p->light.largest };
}

/* The reflection of direct light, and what bounds the others. */
static gw_status begin(progress *p, gw_bounces *bounces, gw_error *error)
{
	const gw_bounces_task *task = p->task;
	double started = gw_seconds();
	GW_TRY(sums_create(task, &p->sums, error));
	GW_TRY(gw_facets_shade(&task->on, &task->on.records->first, task->facet_direct, 1.0f,
						   task->facet_radiance, error));
	GW_TRY(measure(task, &p->sums, &p->energy, &p->largest, error));
	GW_TRY(append(bounces, bounce_done(p, started), error));
	if (task->limit > 1 && !task->no_bound)
		GW_TRY(find_contraction(task, &p->sums, &bounces->contraction, error));
	if (task->limit > 1 && gw_gpu_shares_memory(task->on.passes->gpu))
		GW_TRY(find_powers(p, error));
	p->by_hits = task->step.hits && task->limit > 1 &&
				 gw_passes_way(task->on.passes, GW_PASS_FACET_SHADE) == GW_WAY_CPU;
	if (p->by_hits)
		GW_TRY(gw_hit_facets_find(task->on.passes, task->on.octree, task->on.records,
								  task->step.hits, &p->hits, error));
	return GW_OK;
}

/* One bounce, or what a guess makes of the first; `guessed` receives what the guess holds. */
static gw_status go_on(progress *p, bool first, bool automatic, double *guessed, gw_error *error)
{
	const gw_bounces_task *task = p->task;
	*guessed = 0.0;
	if (!first || !task->carried || !automatic)
		return bounce_once(p, first, error);
	GW_TRY(begin_carried(task, &p->sums, p->largest, guessed, error));
	GW_TRY(measure_records(p, error));
	return measure_both(p, error);
}

static gw_status run(progress *p, gw_bounces *bounces, gw_error *error)
{
	const gw_bounces_task *task = p->task;
	double total = 0.0;
	GW_TRY(begin(p, bounces, error));
	double q = bounces->contraction;
	bool automatic = task->limit == GW_BOUNCES_AUTO;
	uint32_t limit = automatic ? BOUNCE_CEILING : task->limit;
	for (uint32_t n = 1;; n++) {
		total += n > 1 || !task->lit_elsewhere ? p->energy : 0.0;
		bounces->remaining = total > 0.0 ? p->energy * q / (1.0 - q) / total : 0.0;
		bool enough = automatic && bounces->remaining <= (double)task->tolerance &&
					  (n > 1 || !task->lit_elsewhere);
		if (n >= limit || enough || p->energy <= 0.0)
			return GW_OK;
		if (task->cancelled && task->cancelled(task->user))
			return gw_fail(error, GW_ERROR_CANCELLED, "the bake was stopped at bounce %u", n + 1);
		double started = gw_seconds(), guessed;
		GW_TRY(go_on(p, n == 1, automatic, &guessed, error));
		total += guessed;
		GW_TRY(append(bounces, bounce_done(p, started), error));
	}
}

gw_status gw_bounces_run(const gw_bounces_task *task, gw_bounces *bounces, gw_error *error)
{
	*bounces = (gw_bounces){ 0 };
	progress p = { .task = task };
	gw_status status = run(&p, bounces, error);
	sums_destroy(task->on.passes->gpu, &p.sums);
	gw_buffer_destroy(task->on.passes->gpu, &p.power);
	gw_hit_facets_clear(&p.hits);
	gw_record_powers_clear(&p.powers);
	if (status != GW_OK) {
		free(bounces->bounce);
		*bounces = (gw_bounces){ 0 };
	}
	return status;
}
