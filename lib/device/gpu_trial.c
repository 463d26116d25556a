/*
 * gpu_trial.c - what a device does, for those who look for what is wrong.
 */
#include "device/gpu_internal.h"
#include "glowworm_host.h"

#include <stdio.h>
#include <string.h>

/* More than any driver is known to let a loop run that it cuts. */
#define LOOPS 70000u

/* -------------------------------------------------------------------------------- loops */

typedef struct loop_push {
	gw_span span;
	uint32_t loops;
} loop_push;

/* What shaders/device/loop_canary.comp makes of so many steps. */
static uint32_t outcome(uint32_t steps)
{
	uint32_t state = 1;
	for (uint32_t i = 0; i < steps; i++) {
		state = state * 1664525u + 1013904223u;
		state ^= state >> 13;
	}
	return state;
}

/* Where a driver cuts the loop, its last step may be half done. */
static bool is_outcome(const gw_device_trial *trial, uint32_t state)
{
	uint32_t steps = trial->loops_run;
	if (steps > trial->loops_asked || steps == 0)
		return false;
	bool cut = steps < trial->loops_asked;
	return state == outcome(steps) ||
		   (cut && (state == outcome(steps - 1) || state == outcome(steps + 1)));
}

static gw_status run_loop(gw_gpu *gpu, gw_pass *pass, gw_buffer *counted, gw_device_trial *trial,
						  gw_error *error)
{
	uint32_t found[2];
	loop_push push = { .loops = trial->loops_asked };
	GW_TRY(gw_pass_run(gpu, pass, &(gw_binding){ .buffer = counted }, &push, 1, error));
	GW_TRY(gw_buffer_download(gpu, counted, 0, found, sizeof found, error));
	trial->loops_run = found[0];
	trial->reckons = is_outcome(trial, found[1]);
	return GW_OK;
}

/* The one pass that may loop longer than the software driver lets it: that is what it is for. */
static gw_status try_loops(gw_gpu *gpu, gw_device_trial *trial, gw_error *error)
{
	static const gw_binding_kind kind[] = { GW_BIND_STORAGE };
	const gw_shader *shader = gw_shader_find("loop_canary");
	gw_pass_description description = { .name = shader->name,
										.spirv = shader->spirv,
										.spirv_words = shader->words,
										.bindings = kind,
										.binding_count = 1,
										.push_bytes = sizeof(loop_push) };
	gw_pass *pass = NULL;
	gw_buffer counted = { 0 };
	gw_status status = gw_pass_create(gpu, &description, &pass, error);
	if (status == GW_OK)
		status = gw_buffer_create(gpu,
								  &(gw_buffer_description){ GW_BUFFER_STORAGE, VK_FORMAT_UNDEFINED,
															2 * sizeof(uint32_t), "loops" },
								  &counted, error);
	if (status == GW_OK)
		status = run_loop(gpu, pass, &counted, trial, error);
	gw_buffer_destroy(gpu, &counted);
	gw_pass_destroy(gpu, &pass);
	return status;
}

gw_status gw_device_try(const char *device, uint64_t memory, gw_device_trial *trial,
						gw_error *error)
{
	*trial = (gw_device_trial){ .loops_asked = LOOPS,
								.loops_needed = GW_LOOP_BOUND_MAX * GW_LOOP_LANES };
	gw_gpu_options options = { .device = device, .memory = memory };
	gw_gpu *gpu;
	double start = gw_seconds();
	GW_TRY(gw_gpu_create(&options, &gpu, error));
	trial->open_seconds = gw_seconds() - start;
	trial->budget = gpu->budget;
	snprintf(trial->name, sizeof trial->name, "%s", gw_gpu_device(gpu)->name);
	gw_status status = try_loops(gpu, trial, error);
	trial->compile_seconds = gw_gpu_read_account(gpu).compile_seconds;
	gw_gpu_destroy(&gpu);
	return status;
}
