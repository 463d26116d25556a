#include "comparison/tradeoff_runs.h"
#include "options/preview.h"
#include "program/signals.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

/* What a process hands back; both see the same memory. */
typedef struct handed_back {
	gw_status status;
	gw_error error;
	double seconds;
	uint64_t device_bytes;
	gw_error_estimate estimate;
	float luminance[];
} handed_back;

/* ------------------------------------------------------------------------------ the plan */

static void add(tradeoff *t, const gw_bake_options *base, gw_method method, gw_quality quality,
				double factor)
{
	tradeoff_run *run = &t->run[t->count++];
	*run = (tradeoff_run){ .bake = *base };
	run->bake.method = method;
	gw_bake_options_set_quality(&run->bake, quality);
	int name = snprintf(run->name, sizeof run->name, "%s %s", gw_method_name(method),
						gw_quality_name(quality));
	int length = snprintf(run->options, sizeof run->options, "--method %s --quality %s",
						  gw_method_name(method), gw_quality_name(quality));
	if (factor == 1.0)
		return;
	run->bake.rays = (uint32_t)((double)run->bake.rays * factor);
	run->bake.light_samples = run->bake.rays;
	snprintf(run->name + name, sizeof run->name - (size_t)name, ", %u rays", run->bake.rays);
	snprintf(run->options + length, sizeof run->options - (size_t)length,
			 " --rays %u --light-samples %u", run->bake.rays, run->bake.light_samples);
}

/* Normal quality without what records know of directions. */
static void add_scalar(tradeoff *t, const gw_bake_options *base)
{
	tradeoff_run *run = &t->run[t->count];
	add(t, base, GW_METHOD_RAYS, GW_QUALITY_NORMAL, 1.0);
	run->bake.basis = GW_BASIS_SCALAR;
	snprintf(run->name, sizeof run->name, "rays normal, scalar");
	snprintf(run->options, sizeof run->options, "--method rays --quality normal --basis scalar");
}

static void add_cells(tradeoff *t, const gw_bake_options *base, gw_method method, uint32_t cells)
{
	tradeoff_run *run = &t->run[t->count];
	const char *name = gw_method_name(method);
	add(t, base, method, GW_QUALITY_NORMAL, 1.0);
	run->bake.volume_cells = cells;
	snprintf(run->name, sizeof run->name, "%s, %u cells", name, cells);
	snprintf(run->options, sizeof run->options, "--method %s --volume-cells %u", name, cells);
}

static void add_probes(tradeoff *t, const gw_bake_options *base, uint32_t size)
{
	tradeoff_run *run = &t->run[t->count];
	add(t, base, GW_METHOD_PROBES, GW_QUALITY_NORMAL, 1.0);
	run->bake.probe_size = size;
	snprintf(run->name, sizeof run->name, "probes, %u texels", size);
	snprintf(run->options, sizeof run->options, "--method probes --probe-size %u", size);
}

void tradeoff_plan(const gw_bake_options *base, tradeoff *t)
{
	*t = (tradeoff){ 0 };
	add(t, base, GW_METHOD_RAYS, GW_QUALITY_REFERENCE, 1.0);
	add(t, base, GW_METHOD_RAYS, GW_QUALITY_DRAFT, 1.0);
	add(t, base, GW_METHOD_RAYS, GW_QUALITY_DRAFT, 4.0);
	add(t, base, GW_METHOD_RAYS, GW_QUALITY_NORMAL, 0.25);
	add(t, base, GW_METHOD_RAYS, GW_QUALITY_NORMAL, 1.0);
	add(t, base, GW_METHOD_RAYS, GW_QUALITY_NORMAL, 4.0);
	add(t, base, GW_METHOD_RAYS, GW_QUALITY_HIGH, 0.25);
	add(t, base, GW_METHOD_RAYS, GW_QUALITY_HIGH, 1.0);
	add(t, base, GW_METHOD_CONES, GW_QUALITY_DRAFT, 1.0);
	add(t, base, GW_METHOD_CONES, GW_QUALITY_NORMAL, 1.0);
	add(t, base, GW_METHOD_CONES, GW_QUALITY_HIGH, 1.0);
	add(t, base, GW_METHOD_BUFFERS, GW_QUALITY_NORMAL, 1.0);
	add_scalar(t, base);
	for (uint32_t cells = 32; cells <= 128; cells *= 2)
		add_cells(t, base, GW_METHOD_VOLUME, cells);
	for (uint32_t cells = 8; cells <= 32; cells *= 2)
		add_cells(t, base, GW_METHOD_LPV, cells);
	add_probes(t, base, 64);
	add_probes(t, base, 256);
}

/* ------------------------------------------------------------------------------- one run */

static double now(void)
{
	struct timespec time;
	clock_gettime(CLOCK_MONOTONIC, &time);
	return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

static bool on_cancelled(void *user)
{
	(void)user;
	return signals_pending() != 0;
}

/* In the process of the run. */
static void bake_here(const loaded_scene *scene, const gw_light *lights, size_t light_count,
					  const gw_bake_options *options, handed_back *to)
{
	gw_bake_result *result = NULL;
	gw_bake_callbacks callbacks = { .cancelled = on_cancelled };
	double start = now();
	to->status = gw_bake(&(gw_scene_description){ &scene->points.points, lights, light_count },
						 options, &callbacks, &result, &to->error);
	to->seconds = now() - start;
	if (to->status != GW_OK)
		return;
	to->device_bytes = result->report.peak_bytes;
	to->estimate = result->report.error;
	for (size_t i = 0; i < result->count; i++)
		to->luminance[i] = (float)preview_luminance(result->radiance + 3 * i);
	gw_bake_result_destroy(&result);
}

static gw_status wait_for(pid_t child, const char *name, struct rusage *usage, gw_error *error)
{
	int status;
	while (wait4(child, &status, 0, usage) < 0)
		if (errno != EINTR)
			return gw_fail(error, GW_ERROR_INTERNAL, "the process of '%s' is lost: %s", name,
						   strerror(errno));
	GW_TRY(signals_check(error));
	if (WIFSIGNALED(status) && WTERMSIG(status) == SIGKILL)
		return gw_fail(error, GW_ERROR_MEMORY, "'%s' was killed, likely for want of memory", name);
	if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
		return gw_fail(error, GW_ERROR_INTERNAL, "the process of '%s' ended with status %d", name,
					   status);
	return GW_OK;
}

static gw_status run_one(const loaded_scene *scene, const gw_light *lights, size_t light_count,
						 tradeoff_run *run, handed_back *back, gw_error *error)
{
	struct rusage usage;
	fflush(NULL);
	pid_t child = fork();
	if (child < 0)
		return gw_fail(error, GW_ERROR_MEMORY, "no process for '%s': %s", run->name,
					   strerror(errno));
	if (child == 0) {
		prctl(PR_SET_PDEATHSIG, SIGTERM); /* who is asked to stop may not wait for us */
		bake_here(scene, lights, light_count, &run->bake, back);
		_exit(0);
	}
	run->status = wait_for(child, run->name, &usage, error);
	GW_TRY(run->status);
	run->status = back->status;
	run->seconds = back->seconds;
	run->host_bytes = 1024 * (uint64_t)usage.ru_maxrss;
	run->device_bytes = back->device_bytes;
	run->estimate = back->estimate;
	if (run->status != GW_OK)
		return gw_fail(error, run->status, "'%s': %.900s", run->name, back->error.text);
	return GW_OK;
}

/* ------------------------------------------------------------------------------ all runs */

static bool emits(const gw_points *points, size_t i)
{
	const float *e = points->emission ? points->emission + 3 * i : NULL;
	return e && (e[0] > 0.0f || e[1] > 0.0f || e[2] > 0.0f);
}

/* The luminance of the points that count. */
static size_t pick(const gw_points *points, const handed_back *back, double *value)
{
	size_t kept = 0;
	bool all = true;
	for (size_t i = 0; i < points->count && all; i++)
		all = emits(points, i);
	for (size_t i = 0; i < points->count; i++)
		if (all || !emits(points, i))
			value[kept++] = (double)back->luminance[i];
	return kept;
}

/* Runs that are as near beat each other by more than the seconds of the same run differ by. */
#define FASTER 0.9

static void find_front(tradeoff *t)
{
	for (size_t i = 0; i < t->count; i++) {
		tradeoff_run *a = &t->run[i];
		a->front = a->status == GW_OK;
		for (size_t j = 0; j < t->count; j++) {
			const tradeoff_run *b = &t->run[j];
			double near = b->difference.rel_rmse - a->difference.rel_rmse;
			bool better = near < 0.0 ? b->seconds <= a->seconds
									 : near <= 0.0 && b->seconds < FASTER * a->seconds;
			if (b->status == GW_OK && better)
				a->front = false;
		}
	}
}

/* What is baked, and where its light goes. */
typedef struct baking {
	const loaded_scene *scene;
	const gw_light *lights; /* light_count */
	size_t light_count;
	handed_back *back;
	double *truth, *found; /* one a point */
} baking;

static gw_status bake_all(const baking *b, tradeoff *t, progress *shown, gw_error *error)
{
	const gw_points *points = &b->scene->points.points;
	gw_status status = GW_OK;
	for (size_t i = 0; i < t->count && status == GW_OK; i++) {
		tradeoff_run *run = &t->run[i];
		progress_show(shown, run->name, (double)i / (double)t->count);
		status = run_one(b->scene, b->lights, b->light_count, run, b->back, error);
		if ((status == GW_ERROR_MEMORY || status == GW_ERROR_DATA) && i > 0)
			status = GW_OK;
		if (status != GW_OK || run->status != GW_OK)
			continue;
		size_t count = pick(points, b->back, i == 0 ? b->truth : b->found);
		status = gw_compare(i == 0 ? b->truth : b->found, b->truth, count, &run->difference, error);
	}
	progress_end(shown);
	return status;
}

gw_status tradeoff_bake(const loaded_scene *scene, const gw_light *lights, size_t light_count,
						tradeoff *t, progress *shown, gw_error *error)
{
	size_t count = scene->points.points.count;
	size_t bytes = sizeof(handed_back) + count * sizeof(float);
	handed_back *back =
		mmap(NULL, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
	double *truth = reallocarray(NULL, count, sizeof *truth);
	double *found = reallocarray(NULL, count, sizeof *found);
	gw_status status = GW_OK;
	if (back == MAP_FAILED || !truth || !found)
		status = gw_fail(error, GW_ERROR_MEMORY, "no memory to compare %zu points", count);
	else
		status =
			bake_all(&(baking){ scene, lights, light_count, back, truth, found }, t, shown, error);
	if (status == GW_OK)
		find_front(t);
	if (back != MAP_FAILED)
		munmap(back, bytes);
	free(truth);
	free(found);
	return status;
}
