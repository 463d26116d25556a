/*
 * Vulkan's devices: what they say, what they do, and whether a bake on them comes out right. Every
 * step runs in a process of its own, because a driver may end the one that it is in.
 */
#include "program/child_process.h"
#include "verbs/health.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define DEVICES 16

/* Seconds after which a step is given up. A driver compiles for some seconds when it has no cache.
 */
#define LIST_SECONDS 60.0
#define TRIAL_SECONDS 120.0
#define BAKE_SECONDS 300.0

/* ---------------------------------------------------------------------- the closed sphere */

#define POINTS 3000
#define ALBEDO 0.5
#define EMISSION 1.0
#define INTENSITY 2.0
/*
 * Between points of a sphere there are creases through which a ray in some hundreds slips: bounces
 * are lost. Measured are 0.4 % of the mean and 1 % at the worst point; allowed is five times that,
 * because a driver that does something wrong, such as to leave out a lamp or a bounce, is off by a
 * sixth or more.
 */
#define MEAN_ALLOWED 0.02
#define WORST_ALLOWED 0.05

/* A sphere of radius 1 seen from inside, as a golden-angle spiral. */
static void make_sphere(double *position, float *normal, float *albedo, float *emission)
{
	for (size_t i = 0; i < POINTS; i++) {
		double z = 1.0 - (2.0 * (double)i + 1.0) / POINTS, across = sqrt(1.0 - z * z);
		double turn = M_PI * (3.0 - sqrt(5.0)) * (double)i;
		const double at[3] = { across * cos(turn), across * sin(turn), z };
		for (size_t k = 0; k < 3; k++) {
			position[3 * i + k] = at[k];
			normal[3 * i + k] = (float)-at[k];
			albedo[3 * i + k] = (float)ALBEDO;
			emission[3 * i + k] = (float)EMISSION;
		}
	}
}

/* Every point sees every other alike, and the lamp in the middle as each does: what they send out
 * by themselves, Le + rho/pi I/r^2, grows by the sum of all bounces, 1 / (1 - rho). */
static double closed_form(void)
{
	return (EMISSION + ALBEDO / M_PI * INTENSITY) / (1.0 - ALBEDO);
}

static void compare(const gw_bake_result *result, health_canary *canary)
{
	double sum = 0.0;
	for (size_t i = 0; i < 3 * result->count; i++) {
		double off = fabs((double)result->radiance[i] / canary->expected - 1.0);
		/* Also when it is not a number. */
		if (!(off <= canary->worst))
			canary->worst = off;
		sum += (double)result->radiance[i];
	}
	canary->mean = sum / (3.0 * (double)result->count);
}

/* What a child is told, and what it hands back. */
typedef struct step {
	const settings *asked;
	char device[256]; /* for gw_bake_options.device */
	size_t count;
	uint32_t loader[3];
	gw_status status;
	gw_error error;
	gw_device_info info[DEVICES];
	gw_device_trial trial;
	health_canary canary;
} step;

static void bake_sphere(void *user)
{
	static double position[3 * POINTS];
	static float normal[3 * POINTS], albedo[3 * POINTS], emission[3 * POINTS];
	step *s = user;
	health_canary *canary = &s->canary;
	make_sphere(position, normal, albedo, emission);
	const gw_points points = { .count = POINTS,
							   .position = position,
							   .normal = normal,
							   .albedo = albedo,
							   .emission = emission };
	const gw_light light = { .type = GW_LIGHT_POINT,
							 .intensity = { (float)INTENSITY, (float)INTENSITY,
											(float)INTENSITY } };
	gw_bake_options options = gw_bake_options_default();
	options.device = s->device;
	options.memory = s->asked->bake.memory;
	options.threads = s->asked->bake.threads;
	options.tolerance = 1e-4f;
	options.estimate_points = 0;
	gw_bake_result *result = NULL;
	canary->expected = closed_form();
	canary->status = gw_bake(&(gw_scene_description){ &points, &light, 1 }, &options, NULL, &result,
							 &canary->error);
	if (canary->status == GW_OK)
		compare(result, canary);
	gw_bake_result_destroy(&result);
}

void health_judge_canary(health *h, const health_canary *c)
{
	if (c->status != GW_OK) {
		health_add(h, HEALTH_BAD, "canary bake", "%.300s", c->error.text);
		return;
	}
	double off = fabs(c->mean / c->expected - 1.0);
	bool good = off <= MEAN_ALLOWED && c->worst <= WORST_ALLOWED;
	health_add(h, good ? HEALTH_GOOD : HEALTH_BAD, "canary bake",
			   "a closed sphere of %d points with a lamp: radiance %.4f, closed form %.4f; error "
			   "%.2f %%, of the worst point %.1f %% (allowed %.0f and %.0f); %.1f s",
			   POINTS, c->mean, c->expected, 100.0 * off, 100.0 * c->worst, 100.0 * MEAN_ALLOWED,
			   100.0 * WORST_ALLOWED, c->seconds);
	h->bakes += good;
}

/* ---------------------------------------------------------------------- devices and limits */

static void list_devices(void *user)
{
	step *s = user;
	gw_device_info *device = NULL;
	size_t count = 0;
	gw_vulkan_version(s->loader);
	s->status = gw_devices(&device, &count, &s->error);
	s->count = count < DEVICES ? count : DEVICES;
	for (size_t i = 0; i < s->count; i++)
		s->info[i] = device[i];
	free(device);
}

static void try_device(void *user)
{
	step *s = user;
	s->status = gw_device_try(s->device, s->asked->bake.memory, &s->trial, &s->error);
}

void health_judge_limit(health *h, const gw_device_limit *limit)
{
	health_add(h, limit->there >= limit->needed ? HEALTH_GOOD : HEALTH_BAD, limit->name,
			   "%llu needed, %llu there", (unsigned long long)limit->needed,
			   (unsigned long long)limit->there);
}

void health_judge_trial(health *h, const gw_device_trial *t)
{
	health_add(h, HEALTH_GOOD, "opens",
			   "%.2f s, and %.2f s to compile a small shader; a bake may "
			   "take %.2f GB of its memory",
			   t->open_seconds, t->compile_seconds, (double)t->budget * 1e-9);
	if (!t->reckons || t->loops_run < t->loops_needed)
		health_add(h, HEALTH_BAD, "loops",
				   "of %u steps %u were run%s; bakes need %u in one invocation", t->loops_asked,
				   t->loops_run, t->reckons ? "" : ", with a wrong outcome", t->loops_needed);
	else
		health_add(h, HEALTH_GOOD, "loops", "of %u steps %u were run%s; bakes need at most %u",
				   t->loops_asked, t->loops_run,
				   t->loops_run < t->loops_asked ? ": the driver cuts loops" : "", t->loops_needed);
}

static void describe(health *h, const gw_device_info *d, size_t index)
{
	char name[48];
	snprintf(name, sizeof name, "device %zu", index);
	health_add(h, d->usable ? HEALTH_GOOD : HEALTH_WARNING, name,
			   "%.100s (%s), %.100s, Vulkan %u.%u.%u, %.1f GB, subgroups of %u%s%.60s", d->name,
			   d->type, d->driver, d->version[0], d->version[1], d->version[2],
			   (double)d->memory * 1e-9, d->subgroup_size, d->usable ? "" : "; lacks ",
			   d->usable ? "" : d->missing);
}

/* ------------------------------------------------------------------------------ one by one */

/* What a child does with a step. */
typedef struct errand {
	void (*work)(void *);
	const char *name;
	double seconds; /* at most */
} errand;

/* Runs a step; what the child does not come back from is an item. */
static gw_status run(health *h, step *s, const errand *what, double *taken, bool *finished,
					 gw_error *error)
{
	child_end end;
	char text[300];
	gw_status status = child_run(what->work, s, what->seconds, &end, error);
	*taken = end.seconds;
	*finished = status == GW_OK && end.finished;
	if (status != GW_OK || end.finished)
		return status;
	child_end_text(&end, text, sizeof text);
	health_add(h, HEALTH_BAD, what->name, "its process was %s", text);
	return GW_OK;
}

/* Trials and a bake on the device that s->device means. */
static gw_status look_at(health *h, step *s, gw_error *error)
{
	static const errand trial = { try_device, "opens", TRIAL_SECONDS };
	static const errand canary = { bake_sphere, "canary bake", BAKE_SECONDS };
	double seconds;
	bool finished;
	GW_TRY(run(h, s, &trial, &seconds, &finished, error));
	if (finished && s->status != GW_OK)
		health_add(h, HEALTH_BAD, "opens", "%.300s", s->error.text);
	if (!finished || s->status != GW_OK)
		return GW_OK;
	health_judge_trial(h, &s->trial);
	h->budget = h->budget ? h->budget : s->trial.budget;
	s->canary = (health_canary){ 0 };
	gw_status status = run(h, s, &canary, &s->canary.seconds, &finished, error);
	if (status == GW_OK && finished)
		health_judge_canary(h, &s->canary);
	return status;
}

/* The one that was asked for, whatever it is called by, or all that can bake. */
static gw_status look_at_all(health *h, step *s, gw_error *error)
{
	char group[40];
	if (h->asked->bake.device) {
		snprintf(s->device, sizeof s->device, "%s", h->asked->bake.device);
		snprintf(group, sizeof group, "device %.30s", s->device);
		health_begin(h, group);
		return look_at(h, s, error);
	}
	for (size_t i = 0; i < s->count; i++) {
		if (!s->info[i].usable)
			continue;
		snprintf(s->device, sizeof s->device, "%zu", i);
		snprintf(group, sizeof group, "device %zu", i);
		health_begin(h, group);
		for (size_t k = 0; k < GW_DEVICE_LIMITS; k++)
			health_judge_limit(h, &s->info[i].limit[k]);
		GW_TRY(look_at(h, s, error));
	}
	return GW_OK;
}

static void describe_all(health *h, const step *s)
{
	static const char *const variable[] = { "VK_ICD_FILENAMES", "VK_DRIVER_FILES",
											"VK_INSTANCE_LAYERS", "LP_NUM_THREADS" };
	health_add(h, HEALTH_GOOD, "loader", "Vulkan %u.%u.%u", s->loader[0], s->loader[1],
			   s->loader[2]);
	for (size_t i = 0; i < sizeof variable / sizeof *variable; i++)
		if (getenv(variable[i]))
			health_add(h, HEALTH_WARNING, variable[i], "is set: %.200s", getenv(variable[i]));
	if (s->status != GW_OK)
		health_add(h, HEALTH_BAD, "devices", "%.300s", s->error.text);
	else if (s->count == 0)
		health_add(h, HEALTH_BAD, "devices",
				   "there is none; the package mesa-vulkan-drivers has one that runs on any "
				   "processor");
	for (size_t i = 0; i < s->count; i++)
		describe(h, &s->info[i], i);
}

gw_status health_of_devices(health *h, gw_error *error)
{
	static const errand listing = { list_devices, "devices", LIST_SECONDS };
	double seconds;
	bool finished;
	step *s = child_memory_create(sizeof *s);
	if (!s)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to look at devices");
	s->asked = h->asked;
	health_begin(h, "Vulkan");
	gw_status status = run(h, s, &listing, &seconds, &finished, error);
	if (status == GW_OK && finished) {
		describe_all(h, s);
		status = look_at_all(h, s, error);
	}
	child_memory_destroy(s, sizeof *s);
	return status;
}
