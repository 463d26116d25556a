/*
 * passes.c - see passes.h.
 */
#include "device/passes.h"

#include "device/gpu_internal.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

/* Of one pass, at most. Of textures, which texel buffers count as, every device takes 16. */
#define BINDINGS 21u

/* The specialisation constants by which a shader's pass differs: of those that it has
 * (SPIR-V specification, OpDecorate with SpecId); 0 for all others. */
static void constants_of(const gw_passes *passes, gw_pass_id id,
						 uint32_t constant[GW_PASS_CONSTANTS])
{
	enum { HEADER_WORDS = 5, OP_FUNCTION = 54, OP_DECORATE = 71, SPEC_ID = 1 };
	const gw_shader *shader = gw_shader_find(gw_pass_row_of(id)->shader);
	memset(constant, 0, GW_PASS_CONSTANTS * sizeof *constant);
	for (size_t i = HEADER_WORDS; i + 3 < shader->words;) {
		uint32_t words = shader->spirv[i] >> 16, kind = shader->spirv[i] & 0xffffu;
		uint32_t own = shader->spirv[i + 3] - 1; /* constant 0 is the workgroup's size */
		if (kind == OP_FUNCTION || words == 0)
			break;
		if (kind == OP_DECORATE && shader->spirv[i + 2] == SPEC_ID && own < GW_PASS_CONSTANTS)
			constant[own] = passes->constant[own];
		i += words;
	}
}

/* Leaves a pass to those who come after; false where nobody does, or there is no memory. */
static bool keep(gw_passes *passes, gw_pass_id id)
{
	gw_gpu *gpu = passes->gpu;
	gw_spare_pass *spare = gpu->keeps_passes && passes->pass[id] ? malloc(sizeof *spare) : NULL;
	if (!spare)
		return false;
	constants_of(passes, id, spare->constant);
	spare->pass = passes->pass[id];
	spare->next = gpu->spare[id];
	gpu->spare[id] = spare;
	return true;
}

/* Takes what others left, if it is the same; else NULL. */
static gw_pass *take_kept(gw_passes *passes, gw_pass_id id)
{
	uint32_t wanted[GW_PASS_CONSTANTS];
	constants_of(passes, id, wanted);
	for (gw_spare_pass **at = &passes->gpu->spare[id]; *at; at = &(*at)->next) {
		gw_spare_pass *spare = *at;
		if (memcmp(spare->constant, wanted, sizeof wanted) != 0)
			continue;
		gw_pass *pass = spare->pass;
		*at = spare->next;
		free(spare);
		return pass;
	}
	return NULL;
}

const double *gw_passes_seconds(gw_passes *passes)
{
	for (int i = 0; i < GW_PASS_COUNT; i++)
		if (passes->pass[i])
			passes->device_seconds[i] += gw_pass_take_seconds(passes->gpu, passes->pass[i]);
	return passes->device_seconds;
}

void gw_passes_destroy(gw_passes *passes)
{
	gw_passes_seconds(passes); /* so that nobody else has them who takes such a pass */
	for (int i = 0; i < GW_PASS_COUNT; i++)
		if (passes->pass[i] && !keep(passes, (gw_pass_id)i))
			gw_pass_destroy(passes->gpu, &passes->pass[i]);
	*passes = (gw_passes){ 0 };
}

static gw_binding_kind binding_kind(char letter)
{
	switch (letter) {
	case 't':
		return GW_BIND_TEXEL;
	case 'w':
		return GW_BIND_TEXEL_WRITTEN;
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
	const gw_pass_row *row = gw_pass_row_of(id);
	const gw_shader *shader = gw_shader_find(row->shader);
	gw_binding_kind kinds[BINDINGS];
	uint32_t count = (uint32_t)strlen(row->bindings);
	assert(count <= BINDINGS);
	passes->pass[id] = take_kept(passes, id);
	if (passes->pass[id])
		return GW_OK;
	passes->gpu->pass_compiled[id]++;
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
												  .constant_count = GW_PASS_CONSTANTS,
												  .loop_bound = row->loop_bound },
						  &passes->pass[id], error);
}

gw_pass_way gw_passes_way(const gw_passes *passes, gw_pass_id id)
{
	const gw_pass_row *row = gw_pass_row_of(id);
	if (row->cpu == NULL || passes->gpu->passes == GW_PASSES_DEVICE ||
		!gw_gpu_shares_memory(passes->gpu))
		return GW_WAY_DEVICE;
	return GW_WAY_CPU;
}

/* All samples of a pass, in runs of a batch each. */
static gw_status run_batches(gw_passes *passes, gw_pass_id id, const gw_binding *bindings,
							 const void *push, uint64_t count, gw_error *error)
{
	const gw_pass_row *row = gw_pass_row_of(id);
	unsigned char block[GW_PUSH_BYTES_MAX];
	gw_span all;
	memcpy(block, push, row->push_bytes);
	memcpy(&all, block + row->batch_at, sizeof all);
	assert(all.first == 0);
	for (uint32_t first = 0; first < all.count; first += row->batch) {
		uint32_t left = all.count - first;
		const gw_span part = { first, left < row->batch ? left : row->batch };
		memcpy(block + row->batch_at, &part, sizeof part);
		GW_TRY(gw_pass_run(passes->gpu, passes->pass[id], bindings, block, count, error));
	}
	return GW_OK;
}

gw_status gw_passes_run_shader(gw_passes *passes, gw_pass_id id, const gw_binding *bindings,
							   const void *push, uint64_t count, gw_error *error)
{
	if (passes->pass[id] == NULL)
		GW_TRY(create(passes, id, error));
	passes->gpu->pass_runs[id]++;
	return gw_pass_row_of(id)->batch > 0
			   ? run_batches(passes, id, bindings, push, count, error)
			   : gw_pass_run(passes->gpu, passes->pass[id], bindings, push, count, error);
}

void gw_passes_run_kernel(gw_passes *passes, gw_pass_id id, const gw_binding *bindings,
						  const void *push, uint64_t count)
{
	gw_gpu_settle(passes->gpu);
	passes->gpu->pass_runs[id]++;
	gw_pass_row_of(id)->cpu(passes, bindings, push, count);
}

uint64_t gw_passes_runs(const gw_gpu *gpu, gw_pass_id id, uint32_t *compiled)
{
	*compiled = gpu->pass_compiled[id];
	return gpu->pass_runs[id];
}

gw_status gw_passes_run(gw_passes *passes, gw_pass_id id, const gw_binding *bindings,
						const void *push, uint64_t count, gw_error *error)
{
	if (gw_passes_way(passes, id) == GW_WAY_DEVICE)
		return gw_passes_run_shader(passes, id, bindings, push, count, error);
	gw_passes_run_kernel(passes, id, bindings, push, count);
	return GW_OK;
}

void gw_gpu_put_aside(gw_gpu *gpu, gw_gpu_aside *aside)
{
	*aside = (gw_gpu_aside){ .account = gw_gpu_read_account(gpu),
							 .budget = gpu->budget,
							 .cancelled = gpu->cancelled,
							 .user = gpu->user,
							 .keeps_passes = gpu->keeps_passes };
	memcpy(aside->pass_runs, gpu->pass_runs, sizeof aside->pass_runs);
	memcpy(aside->pass_compiled, gpu->pass_compiled, sizeof aside->pass_compiled);
}

void gw_gpu_go_on(gw_gpu *gpu, const gw_gpu_aside *aside)
{
	gw_gpu_settle(gpu);
	gw_gpu_account *now = &gpu->account;
	const gw_gpu_account *before = &aside->account;
	now->dispatches += before->dispatches;
	now->submissions += before->submissions;
	now->uploaded_bytes += before->uploaded_bytes;
	now->downloaded_bytes += before->downloaded_bytes;
	now->device_seconds += before->device_seconds;
	now->compile_seconds += before->compile_seconds;
	now->peak_bytes = now->peak_bytes > before->peak_bytes ? now->peak_bytes : before->peak_bytes;
	gpu->budget = aside->budget;
	gpu->cancelled = aside->cancelled;
	gpu->user = aside->user;
	gpu->keeps_passes = aside->keeps_passes;
	memcpy(gpu->pass_runs, aside->pass_runs, sizeof gpu->pass_runs);
	memcpy(gpu->pass_compiled, aside->pass_compiled, sizeof gpu->pass_compiled);
}
