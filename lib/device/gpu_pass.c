/*
 * gpu_pass.c - compute pipelines, and running them in slices.
 *
 * A run is cut twice. Steps are at most as long as the pass's measured speed fills slice_seconds
 * with, and so is what steps of several passes take that are submitted together: they keep
 * watchdogs quiet. Inside a step, slices are as long as the storage range of windowed buffers and
 * the largest number of workgroups allow. Both begin at multiples of a unit of elements that keeps
 * windows aligned. Only a run that needs more than one step, or whose pass has no measured speed,
 * makes the host wait.
 */
#include "device/gpu_internal.h"
#include "glowworm_host.h"
#include "base/memory.h"

#include <assert.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#define CONSTANTS_MAX 16u
#define BINDINGS_MAX GW_BINDINGS_MAX

/* Elements of a pass's first step, when its speed is not known; how many times as many as ever at
 * once the next may have; and how many times as long as those before they may take. */
#define FIRST_ELEMENTS 4096u
#define GROWTH 4u

struct gw_pass {
	const char *name;
	gw_binding_kind kind[BINDINGS_MAX];
	uint32_t binding_count;
	uint32_t push_bytes;
	uint32_t workgroup_size;
	uint32_t elements_per_invocation;
	VkDescriptorSetLayout set_layout;
	VkPipelineLayout layout;
	VkPipeline pipeline;
	VkDescriptorPool descriptors;
	VkDescriptorSet set[GW_SLICES_MAX];
	bool warm;          /* has run its empty span */
	double pace;        /* seconds an element, as measured; 0: not yet */
	uint64_t tried;     /* the most elements that one step had, or what stands for it at first */
	double seconds;     /* of all steps that gw_pass_take_seconds has not told of */
	uint32_t batch;     /* number of the latest that it is in, */
	uint32_t set_count; /* and how many of its descriptor sets that uses */
};

/* ------------------------------------------------------------------------------ creation */

static VkDescriptorType descriptor_type(gw_binding_kind kind)
{
	switch (kind) {
	case GW_BIND_STORAGE:
		return VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
	case GW_BIND_TEXEL:
		return VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER;
	case GW_BIND_TEXEL_WRITTEN:
		return VK_DESCRIPTOR_TYPE_STORAGE_TEXEL_BUFFER;
	case GW_BIND_STORAGE_IMAGE:
		return VK_DESCRIPTOR_TYPE_STORAGE_IMAGE;
	case GW_BIND_SAMPLED_IMAGE:
		return VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
	}
	assert(!"every kind of binding has a descriptor");
	return VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
}

static uint32_t count_kind(const gw_pass *pass, gw_binding_kind kind)
{
	uint32_t count = 0;
	for (uint32_t i = 0; i < pass->binding_count; i++)
		count += pass->kind[i] == kind;
	return count;
}

/* The device's limits on bindings, against what the pass has. */
static gw_status check_binding_counts(const gw_gpu *gpu, const gw_pass *pass, gw_error *error)
{
	const VkPhysicalDeviceLimits *limits = gw_gpu_limits(gpu);
	uint32_t texel = count_kind(pass, GW_BIND_TEXEL);
	uint32_t sampled = count_kind(pass, GW_BIND_SAMPLED_IMAGE);
	const struct {
		const char *what;
		uint32_t count, most;
	} check[] = {
		{ "storage buffers", count_kind(pass, GW_BIND_STORAGE),
		  limits->maxPerStageDescriptorStorageBuffers },
		{ "texel buffers and sampled images", texel + sampled,
		  limits->maxPerStageDescriptorSampledImages },
		{ "storage images and texel buffers that are written",
		  count_kind(pass, GW_BIND_STORAGE_IMAGE) + count_kind(pass, GW_BIND_TEXEL_WRITTEN),
		  limits->maxPerStageDescriptorStorageImages },
		{ "resources", pass->binding_count, limits->maxPerStageResources },
		{ "bytes of push constants", pass->push_bytes, limits->maxPushConstantsSize },
	};
	for (size_t i = 0; i < sizeof check / sizeof *check; i++)
		if (check[i].count > check[i].most)
			return gw_fail(error, GW_ERROR_NO_DEVICE,
						   "pass \"%s\" uses %u %s, but \"%s\" allows %u: choose another device",
						   pass->name, check[i].count, check[i].what, gpu->device.info.name,
						   check[i].most);
	return GW_OK;
}

/* Looks for instructions that declare 64-bit integers (SPIR-V specification, section 2.3). */
static gw_status check_capabilities(const gw_gpu *gpu, const gw_pass_description *description,
									gw_error *error)
{
	enum { HEADER_WORDS = 5, OP_CAPABILITY = 17, INT64 = 11, INT64_ATOMICS = 12 };
	for (size_t i = HEADER_WORDS; i + 1 < description->spirv_words;) {
		uint32_t instruction = description->spirv[i], words = instruction >> 16;
		if ((instruction & 0xffffu) != OP_CAPABILITY || words == 0)
			break; /* capabilities come first */
		uint32_t capability = description->spirv[i + 1];
		if ((capability == INT64 && !gpu->device.int64) ||
			(capability == INT64_ATOMICS && !gpu->device.int64_atomics))
			return gw_fail(error, GW_ERROR_NO_DEVICE,
						   "pass \"%s\" needs 64-bit integers%s, which \"%s\" lacks: choose "
						   "another device",
						   description->name, capability == INT64 ? "" : " in atomics",
						   gpu->device.info.name);
		i += words;
	}
	return GW_OK;
}

static gw_status check_description(const gw_gpu *gpu, const gw_pass_description *description,
								   const gw_pass *pass, gw_error *error)
{
	const VkPhysicalDeviceLimits *limits = gw_gpu_limits(gpu);
	if (description->loop_bound > GW_LOOP_BOUND_MAX)
		return gw_fail(error, GW_ERROR_INTERNAL,
					   "pass \"%s\" may loop %u times in one invocation, but software drivers end "
					   "loops silently: split it so that it stays within %u",
					   pass->name, description->loop_bound, GW_LOOP_BOUND_MAX);
	if (pass->workgroup_size > limits->maxComputeWorkGroupSize[0] ||
		pass->workgroup_size > limits->maxComputeWorkGroupInvocations)
		return gw_fail(error, GW_ERROR_NO_DEVICE,
					   "pass \"%s\" needs workgroups of %u threads, but \"%s\" allows %u: choose "
					   "another device",
					   pass->name, pass->workgroup_size, gpu->device.info.name,
					   limits->maxComputeWorkGroupInvocations);
	GW_TRY(check_capabilities(gpu, description, error));
	return check_binding_counts(gpu, pass, error);
}

static gw_status create_layouts(gw_gpu *gpu, gw_pass *pass, gw_error *error)
{
	VkDescriptorSetLayoutBinding binding[BINDINGS_MAX];
	for (uint32_t i = 0; i < pass->binding_count; i++)
		binding[i] = (VkDescriptorSetLayoutBinding){
			.binding = i,
			.descriptorType = descriptor_type(pass->kind[i]),
			.descriptorCount = 1,
			.stageFlags = VK_SHADER_STAGE_COMPUTE_BIT,
		};
	VkDescriptorSetLayoutCreateInfo set = {
		.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO,
		.bindingCount = pass->binding_count,
		.pBindings = binding,
	};
	GW_VULKAN(gpu, error, pass->name,
			  vkCreateDescriptorSetLayout(gpu->handle, &set, NULL, &pass->set_layout));
	gw_gpu_name(gpu, VK_OBJECT_TYPE_DESCRIPTOR_SET_LAYOUT, (uint64_t)pass->set_layout, pass->name);
	VkPushConstantRange push = { VK_SHADER_STAGE_COMPUTE_BIT, 0, pass->push_bytes };
	VkPipelineLayoutCreateInfo layout = {
		.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
		.setLayoutCount = 1,
		.pSetLayouts = &pass->set_layout,
		.pushConstantRangeCount = 1,
		.pPushConstantRanges = &push,
	};
	GW_VULKAN(gpu, error, pass->name,
			  vkCreatePipelineLayout(gpu->handle, &layout, NULL, &pass->layout));
	gw_gpu_name(gpu, VK_OBJECT_TYPE_PIPELINE_LAYOUT, (uint64_t)pass->layout, pass->name);
	return GW_OK;
}

static gw_status create_descriptors(gw_gpu *gpu, gw_pass *pass, gw_error *error)
{
	VkDescriptorPoolSize size[BINDINGS_MAX];
	for (uint32_t i = 0; i < pass->binding_count; i++)
		size[i] = (VkDescriptorPoolSize){ descriptor_type(pass->kind[i]), GW_SLICES_MAX };
	VkDescriptorPoolCreateInfo pool = {
		.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
		.maxSets = GW_SLICES_MAX,
		.poolSizeCount = pass->binding_count,
		.pPoolSizes = size,
	};
	GW_VULKAN(gpu, error, pass->name,
			  vkCreateDescriptorPool(gpu->handle, &pool, NULL, &pass->descriptors));
	gw_gpu_name(gpu, VK_OBJECT_TYPE_DESCRIPTOR_POOL, (uint64_t)pass->descriptors, pass->name);
	VkDescriptorSetLayout layouts[GW_SLICES_MAX];
	for (uint32_t i = 0; i < GW_SLICES_MAX; i++)
		layouts[i] = pass->set_layout;
	VkDescriptorSetAllocateInfo sets = {
		.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
		.descriptorPool = pass->descriptors,
		.descriptorSetCount = GW_SLICES_MAX,
		.pSetLayouts = layouts,
	};
	GW_VULKAN(gpu, error, pass->name, vkAllocateDescriptorSets(gpu->handle, &sets, pass->set));
	for (uint32_t i = 0; i < GW_SLICES_MAX; i++)
		gw_gpu_name(gpu, VK_OBJECT_TYPE_DESCRIPTOR_SET, (uint64_t)pass->set[i], pass->name);
	return GW_OK;
}

static gw_status create_pipeline(gw_gpu *gpu, const gw_pass_description *description, gw_pass *pass,
								 gw_error *error)
{
	VkShaderModuleCreateInfo module_info = {
		.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
		.codeSize = description->spirv_words * sizeof(uint32_t),
		.pCode = description->spirv,
	};
	VkShaderModule module;
	GW_VULKAN(gpu, error, pass->name,
			  vkCreateShaderModule(gpu->handle, &module_info, NULL, &module));
	gw_gpu_name(gpu, VK_OBJECT_TYPE_SHADER_MODULE, (uint64_t)module, pass->name);

	/* Constant 0 is the workgroup's size, the caller's follow. */
	uint32_t constant[CONSTANTS_MAX + 1] = { pass->workgroup_size };
	VkSpecializationMapEntry entry[CONSTANTS_MAX + 1];
	uint32_t count = description->constant_count + 1;
	if (count > 1)
		memcpy(constant + 1, description->constant, (count - 1) * sizeof *constant);
	for (uint32_t i = 0; i < count; i++)
		entry[i] =
			(VkSpecializationMapEntry){ i, i * (uint32_t)sizeof *constant, sizeof *constant };
	VkSpecializationInfo specialization = { count, entry, count * sizeof *constant, constant };
	VkComputePipelineCreateInfo info = {
		.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
		.stage = { .sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
				   .stage = VK_SHADER_STAGE_COMPUTE_BIT,
				   .module = module,
				   .pName = "main",
				   .pSpecializationInfo = &specialization },
		.layout = pass->layout,
	};
	VkResult result =
		vkCreateComputePipelines(gpu->handle, VK_NULL_HANDLE, 1, &info, NULL, &pass->pipeline);
	vkDestroyShaderModule(gpu->handle, module, NULL);
	if (result != VK_SUCCESS)
		return gw_vulkan_fail(gpu, error, "vkCreateComputePipelines", pass->name, result);
	gw_gpu_name(gpu, VK_OBJECT_TYPE_PIPELINE, (uint64_t)pass->pipeline, pass->name);
	return GW_OK;
}

static gw_status make_pass(gw_gpu *gpu, const gw_pass_description *description, gw_pass *pass,
						   gw_error *error)
{
	GW_TRY(gw_gpu_check(gpu, error));
	GW_TRY(check_description(gpu, description, pass, error));
	double start = gw_seconds();
	GW_TRY(create_layouts(gpu, pass, error));
	GW_TRY(create_descriptors(gpu, pass, error));
	GW_TRY(create_pipeline(gpu, description, pass, error));
	gpu->account.compile_seconds += gw_seconds() - start;
	return gw_gpu_check(gpu, error);
}

gw_status gw_pass_create(gw_gpu *gpu, const gw_pass_description *description, gw_pass **pass,
						 gw_error *error)
{
	assert(description->binding_count > 0 && description->binding_count <= BINDINGS_MAX);
	assert(description->constant_count <= CONSTANTS_MAX);
	assert(description->push_bytes >= sizeof(gw_span) && description->push_bytes % 4 == 0);
	assert(description->push_bytes <= GW_PUSH_BYTES_MAX);
	*pass = gw_allocate_zeros(1, sizeof **pass);
	if (*pass == NULL)
		return gw_fail(error, GW_ERROR_MEMORY, "not enough memory for pass \"%s\"",
					   description->name);
	uint32_t each = description->elements_per_invocation, size = description->workgroup_size;
	**pass = (gw_pass){
		.name = description->name,
		.binding_count = description->binding_count,
		.push_bytes = description->push_bytes,
		.workgroup_size = size > 0 ? size : gpu->workgroup_size,
		.elements_per_invocation = each > 0 ? each : 1,
		.tried = FIRST_ELEMENTS / GROWTH,
	};
	memcpy((*pass)->kind, description->bindings,
		   description->binding_count * sizeof *description->bindings);
	gw_status status = make_pass(gpu, description, *pass, error);
	if (status != GW_OK)
		gw_pass_destroy(gpu, pass);
	return status;
}

void gw_pass_destroy(gw_gpu *gpu, gw_pass **pass_address)
{
	gw_pass *pass = *pass_address;
	if (pass == NULL)
		return;
	gw_gpu_settle(gpu);
	if (!gpu->stuck) {
		vkDestroyPipeline(gpu->handle, pass->pipeline, NULL);
		vkDestroyDescriptorPool(gpu->handle, pass->descriptors, NULL);
		vkDestroyPipelineLayout(gpu->handle, pass->layout, NULL);
		vkDestroyDescriptorSetLayout(gpu->handle, pass->set_layout, NULL);
	}
	free(pass);
	*pass_address = NULL;
}

uint32_t gw_pass_workgroup_size(const gw_pass *pass)
{
	return pass->workgroup_size;
}

double gw_pass_take_seconds(gw_gpu *gpu, gw_pass *pass)
{
	gw_gpu_settle(gpu);
	double seconds = pass->seconds;
	pass->seconds = 0.0;
	return seconds;
}

/* ------------------------------------------------------------------------------ recording */

/* Integer formats and some others cannot be filtered: they are read at the nearest texel. */
static VkSampler choose_sampler(const gw_gpu *gpu, const gw_image *image)
{
	VkFormatProperties properties;
	vkGetPhysicalDeviceFormatProperties(gpu->device.handle, image->format, &properties);
	bool filters =
		properties.optimalTilingFeatures & VK_FORMAT_FEATURE_SAMPLED_IMAGE_FILTER_LINEAR_BIT;
	return filters ? gpu->linear : gpu->nearest;
}

static VkDescriptorBufferInfo window_of(gw_binding binding, gw_slice slice)
{
	if (binding.stride == 0)
		return (VkDescriptorBufferInfo){ binding.buffer->handle, 0, VK_WHOLE_SIZE };
	/* The empty span of a first run still needs something to be bound. */
	uint64_t count = slice.count > 0 ? slice.count : 1;
	return (VkDescriptorBufferInfo){ binding.buffer->handle, (uint64_t)slice.first * binding.stride,
									 count * binding.stride };
}

static void write_descriptors(gw_gpu *gpu, const gw_pass *pass, const gw_binding *bindings,
							  gw_slice slice)
{
	VkWriteDescriptorSet write[BINDINGS_MAX];
	VkDescriptorBufferInfo buffer[BINDINGS_MAX];
	VkDescriptorImageInfo image[BINDINGS_MAX];
	for (uint32_t i = 0; i < pass->binding_count; i++) {
		write[i] = (VkWriteDescriptorSet){
			.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
			.dstSet = pass->set[slice.set],
			.dstBinding = i,
			.descriptorCount = 1,
			.descriptorType = descriptor_type(pass->kind[i]),
			.pBufferInfo = &buffer[i],
			.pImageInfo = &image[i],
		};
		switch (pass->kind[i]) {
		case GW_BIND_STORAGE:
			buffer[i] = window_of(bindings[i], slice);
			break;
		case GW_BIND_TEXEL:
		case GW_BIND_TEXEL_WRITTEN:
			write[i].pTexelBufferView = &bindings[i].buffer->view;
			break;
		case GW_BIND_STORAGE_IMAGE:
		case GW_BIND_SAMPLED_IMAGE:
			image[i] = (VkDescriptorImageInfo){ choose_sampler(gpu, bindings[i].image),
												bindings[i].image->view, VK_IMAGE_LAYOUT_GENERAL };
			break;
		}
	}
	vkUpdateDescriptorSets(gpu->handle, pass->binding_count, write, 0, NULL);
}

static uint64_t divide_up(uint64_t value, uint64_t by)
{
	return value / by + (value % by != 0);
}

gw_status gw_pass_record(gw_gpu *gpu, gw_pass *pass, gw_slice slice, const gw_binding *bindings,
						 const void *push, gw_error *error)
{
	assert(slice.set < GW_SLICES_MAX);
	write_descriptors(gpu, pass, bindings, slice);
	unsigned char block[GW_PUSH_BYTES_MAX];
	if (push != NULL)
		memcpy(block, push, pass->push_bytes);
	else
		memset(block, 0, pass->push_bytes);
	memcpy(block, &(gw_span){ slice.first, slice.count }, sizeof(gw_span));

	uint64_t per_group = (uint64_t)pass->workgroup_size * pass->elements_per_invocation;
	uint64_t groups = slice.count > 0 ? divide_up(slice.count, per_group) : 1;
	assert(groups <= gw_gpu_limits(gpu)->maxComputeWorkGroupCount[0]);
	vkCmdBindPipeline(gpu->commands, VK_PIPELINE_BIND_POINT_COMPUTE, pass->pipeline);
	vkCmdBindDescriptorSets(gpu->commands, VK_PIPELINE_BIND_POINT_COMPUTE, pass->layout, 0, 1,
							&pass->set[slice.set], 0, NULL);
	vkCmdPushConstants(gpu->commands, pass->layout, VK_SHADER_STAGE_COMPUTE_BIT, 0,
					   pass->push_bytes, block);
	vkCmdDispatch(gpu->commands, (uint32_t)groups, 1, 1);
	gpu->account.dispatches++;
	return gw_gpu_check(gpu, error);
}

/* -------------------------------------------------------------------------------- running */

static gw_status check_storage(const gw_gpu *gpu, const gw_pass *pass, uint32_t index,
							   gw_binding binding, uint64_t count, gw_error *error)
{
	uint64_t bytes = binding.buffer->bytes;
	if (binding.stride > 0 && count > bytes / binding.stride)
		return gw_fail(error, GW_ERROR_INTERNAL,
					   "pass \"%s\": binding %u \"%s\" of %" PRIu64
					   " bytes holds fewer than %" PRIu64 " elements of %u bytes",
					   pass->name, index, binding.buffer->name, bytes, count, binding.stride);
	if (binding.stride == 0 && bytes > gpu->storage_range)
		return gw_fail(
			error, GW_ERROR_MEMORY,
			"pass \"%s\" needs all %" PRIu64 " bytes of \"%s\" at once, but \"%s\" binds "
			"at most %" PRIu64 ": bake with fewer points or a coarser octree",
			pass->name, bytes, binding.buffer->name, gpu->device.info.name, gpu->storage_range);
	return GW_OK;
}

/* Whether every binding has the resource that the pass expects, large enough. */
static gw_status check_bindings(const gw_gpu *gpu, const gw_pass *pass, const gw_binding *bindings,
								uint64_t count, gw_error *error)
{
	for (uint32_t i = 0; i < pass->binding_count; i++) {
		const gw_binding *binding = &bindings[i];
		bool there =
			pass->kind[i] == GW_BIND_STORAGE_IMAGE || pass->kind[i] == GW_BIND_SAMPLED_IMAGE
				? binding->image != NULL && binding->image->handle != VK_NULL_HANDLE
				: binding->buffer != NULL && binding->buffer->handle != VK_NULL_HANDLE;
		if (there && (pass->kind[i] == GW_BIND_TEXEL || pass->kind[i] == GW_BIND_TEXEL_WRITTEN))
			there = binding->buffer->view != VK_NULL_HANDLE;
		if (!there)
			return gw_fail(error, GW_ERROR_INTERNAL, "pass \"%s\": nothing is bound to binding %u",
						   pass->name, i);
		if (pass->kind[i] == GW_BIND_STORAGE)
			GW_TRY(check_storage(gpu, pass, i, *binding, count, error));
	}
	return GW_OK;
}

/* What the driver reads is there to stay. */
static gw_status own_fleeting(gw_gpu *gpu, const gw_pass *pass, const gw_binding *bindings,
							  gw_error *error)
{
	for (uint32_t i = 0; i < pass->binding_count; i++) {
		gw_buffer *buffer = bindings[i].buffer;
		if (buffer && buffer->fleeting)
			GW_TRY(gw_buffer_own(gpu, buffer, error));
	}
	return GW_OK;
}

static uint64_t greatest_common_divisor(uint64_t a, uint64_t b)
{
	while (b != 0) {
		uint64_t rest = a % b;
		a = b;
		b = rest;
	}
	return a;
}

static uint64_t least_common_multiple(uint64_t a, uint64_t b)
{
	return a / greatest_common_divisor(a, b) * b;
}

/* How a run may be cut: slices begin at multiples of `unit` and hold at most `most` elements. */
typedef struct cut {
	uint64_t unit, most;
} cut;

static gw_status find_cut(const gw_gpu *gpu, const gw_pass *pass, const gw_binding *bindings,
						  cut *found, gw_error *error)
{
	const VkPhysicalDeviceLimits *limits = gw_gpu_limits(gpu);
	uint64_t per_group = (uint64_t)pass->workgroup_size * pass->elements_per_invocation;
	uint64_t unit = least_common_multiple(per_group, 64);
	uint64_t most = per_group * limits->maxComputeWorkGroupCount[0];
	for (uint32_t i = 0; i < pass->binding_count; i++) {
		uint64_t stride = pass->kind[i] == GW_BIND_STORAGE ? bindings[i].stride : 0;
		if (stride == 0)
			continue;
		uint64_t align = limits->minStorageBufferOffsetAlignment;
		unit = least_common_multiple(unit, align / greatest_common_divisor(align, stride));
		uint64_t fitting = gpu->storage_range / stride;
		most = fitting < most ? fitting : most;
	}
	*found = (cut){ unit, most / unit * unit };
	if (found->most == 0)
		return gw_fail(error, GW_ERROR_NO_DEVICE,
					   "pass \"%s\" works on %" PRIu64
					   " elements at once, but \"%s\" binds or starts "
					   "only %" PRIu64 ": choose another device",
					   pass->name, unit, gpu->device.info.name, most);
	return GW_OK;
}

/* A part of a run that is one step. */
typedef struct part {
	uint64_t first, wanted; /* elements */
	uint64_t asked;         /* where the run does not end before */
	uint64_t most;          /* of a slice */
	uint64_t done;          /* elements that were recorded */
} part;

/* The descriptor sets that this submission has not used. */
static uint32_t sets_left(const gw_gpu *gpu, const gw_pass *pass)
{
	bool used = gpu->batch.open && pass->batch == gpu->batch.number;
	return GW_SLICES_MAX - (used ? pass->set_count : 0);
}

static uint32_t take_set(const gw_gpu *gpu, gw_pass *pass)
{
	if (pass->batch != gpu->batch.number)
		pass->set_count = 0;
	pass->batch = gpu->batch.number;
	return pass->set_count++;
}

/* Whether the part can be submitted with what is recorded already: with a first run's empty span it
 * is two steps. */
static bool fits_batch(const gw_gpu *gpu, const gw_pass *pass, const part *p)
{
	const gw_batch *batch = &gpu->batch;
	uint64_t slices = divide_up(p->wanted, p->most) + !pass->warm;
	return batch->step_count + 2 <= GW_STEPS_MAX &&
		   batch->expected + pass->pace * (double)p->wanted <= gpu->slice_seconds &&
		   (slices <= sets_left(gpu, pass) || sets_left(gpu, pass) == GW_SLICES_MAX);
}

static void note_uses(gw_gpu *gpu, const gw_pass *pass, const gw_binding *bindings)
{
	for (uint32_t i = 0; i < pass->binding_count; i++) {
		bool image =
			pass->kind[i] == GW_BIND_STORAGE_IMAGE || pass->kind[i] == GW_BIND_SAMPLED_IMAGE;
		gw_commands_use(
			gpu, image ? (uint64_t)bindings[i].image->handle : (uint64_t)bindings[i].buffer->handle,
			pass->name);
	}
}

/* The first dispatch makes software drivers compile; an empty span does nothing else. */
static gw_status warm_up(gw_gpu *gpu, gw_pass *pass, const gw_binding *bindings, const void *push,
						 gw_error *error)
{
	gw_commands_begin_step(gpu);
	GW_TRY(
		gw_pass_record(gpu, pass, (gw_slice){ .set = take_set(gpu, pass) }, bindings, push, error));
	gw_commands_end_step(gpu, (gw_step){ .pass = pass });
	gw_commands_barrier(gpu);
	pass->warm = true;
	return GW_OK;
}

/* Records up to so many elements, as few slices. */
static gw_status record_part(gw_gpu *gpu, gw_pass *pass, const gw_binding *bindings,
							 const void *push, part *p, gw_error *error)
{
	if (!fits_batch(gpu, pass, p))
		GW_TRY(gw_gpu_finish(gpu, error));
	GW_TRY(gw_commands_begin(gpu, error));
	note_uses(gpu, pass, bindings);
	if (!pass->warm)
		GW_TRY(warm_up(gpu, pass, bindings, push, error));
	gw_commands_begin_step(gpu);
	while (p->done < p->wanted && sets_left(gpu, pass) > 0) {
		uint64_t left = p->wanted - p->done, count = left < p->most ? left : p->most;
		gw_slice slice = { (uint32_t)(p->first + p->done), (uint32_t)count, take_set(gpu, pass) };
		if (p->done > 0)
			gw_commands_barrier(gpu);
		GW_TRY(gw_pass_record(gpu, pass, slice, bindings, push, error));
		p->done += count;
	}
	gw_commands_end_step(gpu, (gw_step){ pass, p->done, p->asked });
	gpu->batch.expected += pass->pace * (double)p->done;
	return GW_OK;
}

void gw_pass_book(gw_gpu *gpu, gw_step step, double seconds)
{
	gw_pass *pass = step.pass;
	if (step.elements == 0) {
		gpu->account.compile_seconds += seconds;
		return;
	}
	gpu->account.device_seconds += seconds;
	pass->seconds += seconds;
	/* A few elements, as the rest of a run, say more about the cost of a dispatch than about the
	 * pass. */
	bool few = step.elements < step.asked / 2 && step.elements < pass->tried / 2;
	if (pass->pace > 0.0 && few && seconds < gpu->slice_seconds)
		return;
	pass->pace = (seconds > 1e-7 ? seconds : 1e-7) / (double)step.elements;
	pass->tried = step.elements > pass->tried ? step.elements : pass->tried;
}

/* How many elements to do at once. Those of a new run may cost more than those before: it begins
 * shorter than was right then. */
static uint64_t choose_length(const gw_gpu *gpu, const gw_pass *pass, bool begins)
{
	double most = GROWTH * (double)pass->tried;
	double fitting = pass->pace > 0.0 ? gpu->slice_seconds / pass->pace : most;
	double length = fitting < most ? fitting : most;
	if (begins) {
		double least = length < FIRST_ELEMENTS ? length : FIRST_ELEMENTS;
		length = fitting / GROWTH < most ? fitting / GROWTH : most;
		length = length > least ? length : least;
	}
	return length < 1 ? 1 : length < (double)UINT32_MAX ? (uint64_t)length : UINT32_MAX;
}

gw_status gw_pass_run(gw_gpu *gpu, gw_pass *pass, const gw_binding *bindings, const void *push,
					  uint64_t count, gw_error *error)
{
	GW_TRY(gw_gpu_check(gpu, error));
	if (count == 0)
		return GW_OK;
	if (count > UINT32_MAX)
		return gw_fail(error, GW_ERROR_MEMORY,
					   "pass \"%s\" was given %" PRIu64 " elements, but takes at most %" PRIu32
					   ": bake fewer points at once",
					   pass->name, count, UINT32_MAX);
	GW_TRY(check_bindings(gpu, pass, bindings, count, error));
	GW_TRY(own_fleeting(gpu, pass, bindings, error));
	cut limit;
	GW_TRY(find_cut(gpu, pass, bindings, &limit, error));
	for (uint64_t first = 0; first < count;) {
		uint64_t left = count - first;
		uint64_t asked = divide_up(choose_length(gpu, pass, first == 0), limit.unit) * limit.unit;
		part p = { .first = first,
				   .wanted = asked < left ? asked : left,
				   .asked = asked,
				   .most = limit.most };
		gw_status status = record_part(gpu, pass, bindings, push, &p, error);
		if (status != GW_OK)
			gpu->batch.open = false; /* dropped: a step may be half recorded */
		GW_TRY(status);
		first += p.done;
		/* How long the rest may be, or the next run, is known when this has been done. */
		if (first < count || pass->pace <= 0.0 || gpu->timestamps == VK_NULL_HANDLE)
			GW_TRY(gw_gpu_finish(gpu, error));
		if (gw_gpu_stopped(gpu))
			return gw_gpu_check(gpu, error);
	}
	return GW_OK;
}
