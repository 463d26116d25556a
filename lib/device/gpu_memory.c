/*
 * gpu_memory.c - buffers, 3D images and copies between them and the host.
 *
 * Every resource has an allocation of its own: there are some dozens, not thousands. Memory that
 * the device is close to and the host can map (software drivers, integrated devices) is mapped
 * for copies; else copies go through one staging buffer, a part at a time.
 */
#include "device/gpu_internal.h"
#include "base/memory.h"

#include <assert.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#define STAGING_BYTES (UINT64_C(16) << 20)

/* Most that vkCmdUpdateBuffer takes. */
#define UPDATE_BYTES UINT64_C(65536)

/* Smallest buffer; holds one texel of any format. */
#define BUFFER_BYTES_MIN UINT64_C(16)

static const VkMemoryPropertyFlags mappable = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT |
											  VK_MEMORY_PROPERTY_HOST_COHERENT_BIT |
											  VK_MEMORY_PROPERTY_HOST_CACHED_BIT;

static const VkExternalMemoryHandleTypeFlagBits host_memory =
	VK_EXTERNAL_MEMORY_HANDLE_TYPE_HOST_ALLOCATION_BIT_EXT;

/* ------------------------------------------------------------------------------- formats */

/* Bytes of a texel; 0 for formats that the layer does not know. */
static uint32_t texel_bytes(VkFormat format)
{
	switch (format) {
	case VK_FORMAT_R8_UINT:
	case VK_FORMAT_R8_UNORM:
		return 1;
	case VK_FORMAT_R16_UINT:
	case VK_FORMAT_R16_SFLOAT:
	case VK_FORMAT_R8G8_UNORM:
		return 2;
	case VK_FORMAT_R32_UINT:
	case VK_FORMAT_R32_SINT:
	case VK_FORMAT_R32_SFLOAT:
	case VK_FORMAT_R16G16_UINT:
	case VK_FORMAT_R16G16_UNORM:
	case VK_FORMAT_R16G16_SFLOAT:
	case VK_FORMAT_R8G8B8A8_UINT:
	case VK_FORMAT_R8G8B8A8_UNORM:
	case VK_FORMAT_R8G8B8A8_SNORM:
		return 4;
	case VK_FORMAT_R32G32_UINT:
	case VK_FORMAT_R32G32_SINT:
	case VK_FORMAT_R32G32_SFLOAT:
	case VK_FORMAT_R16G16B16A16_UINT:
	case VK_FORMAT_R16G16B16A16_UNORM:
	case VK_FORMAT_R16G16B16A16_SFLOAT:
		return 8;
	case VK_FORMAT_R32G32B32A32_UINT:
	case VK_FORMAT_R32G32B32A32_SINT:
	case VK_FORMAT_R32G32B32A32_SFLOAT:
		return 16;
	default:
		return 0;
	}
}

/* --------------------------------------------------------------------------- allocations */

/* The type with these properties whose heap is largest, out of those in `allowed`; -1 if none. */
static int find_memory_type(const gw_gpu *gpu, uint32_t allowed, VkMemoryPropertyFlags wanted)
{
	int best = -1;
	uint64_t best_size = 0;
	for (uint32_t i = 0; i < gpu->memory.memoryTypeCount; i++) {
		VkMemoryType type = gpu->memory.memoryTypes[i];
		uint64_t size = gpu->memory.memoryHeaps[type.heapIndex].size;
		if ((allowed >> i & 1) != 0 && (type.propertyFlags & wanted) == wanted &&
			size > best_size) {
			best = (int)i;
			best_size = size;
		}
	}
	return best;
}

static int choose_memory_type(const gw_gpu *gpu, uint32_t allowed, bool staging)
{
	VkMemoryPropertyFlags wanted[] = {
		staging ? mappable : VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT | mappable,
		staging ? VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT
				: VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT,
	};
	int type = find_memory_type(gpu, allowed, wanted[0]);
	return type >= 0 ? type : find_memory_type(gpu, allowed, wanted[1]);
}

/* Whether the memory that `choose_memory_type` takes for resources can be mapped. */
static bool is_mappable(const gw_gpu *gpu, uint32_t allowed)
{
	int type = choose_memory_type(gpu, allowed, false);
	return type >= 0 && (gpu->memory.memoryTypes[type].propertyFlags & mappable) == mappable;
}

static gw_status check_budget(const gw_gpu *gpu, uint64_t bytes, const char *name, gw_error *error)
{
	uint64_t used = gpu->account.bytes;
	if (bytes > gpu->budget || used > gpu->budget - bytes)
		return gw_fail(error, GW_ERROR_MEMORY,
					   "\"%s\" needs %" PRIu64 " bytes of device memory, but of the %" PRIu64
					   " bytes that may be used %" PRIu64 " are taken: allow more memory, or "
					   "bake with fewer points or a coarser octree",
					   name, bytes, gpu->budget, used);
	if (bytes > gpu->largest_allocation)
		return gw_fail(error, GW_ERROR_MEMORY,
					   "\"%s\" needs %" PRIu64 " bytes in one piece, but \"%s\" allocates at most "
					   "%" PRIu64 " at once: bake with fewer points or a coarser octree",
					   name, bytes, gpu->device.info.name, gpu->largest_allocation);
	return GW_OK;
}

/* What memory is for, and where it goes. */
typedef struct allocation {
	const char *name;
	bool staging;
	const void *lent; /* NULL, or where the memory lies that is to be used in place of new one */
	VkDeviceMemory *memory;
	uint64_t *allocated; /* bytes of it */
} allocation;

static gw_status allocate(gw_gpu *gpu, VkMemoryRequirements needs, const allocation *to,
						  gw_error *error)
{
	const char *name = to->name;
	GW_TRY(check_budget(gpu, needs.size, name, error));
	int type = choose_memory_type(gpu, needs.memoryTypeBits, to->staging);
	if (type < 0)
		return gw_fail(error, GW_ERROR_INTERNAL, "\"%s\" has no memory that suits \"%s\"",
					   gpu->device.info.name, name);
	uint64_t heap = gpu->memory.memoryHeaps[gpu->memory.memoryTypes[type].heapIndex].size;
	if (needs.size > heap)
		return gw_fail(error, GW_ERROR_MEMORY,
					   "\"%s\" needs %" PRIu64 " bytes of a memory of \"%s\" that holds %" PRIu64
					   ": bake with fewer points or a coarser octree",
					   name, needs.size, gpu->device.info.name, heap);
	VkImportMemoryHostPointerInfoEXT import = {
		.sType = VK_STRUCTURE_TYPE_IMPORT_MEMORY_HOST_POINTER_INFO_EXT,
		.handleType = host_memory,
		.pHostPointer = (void *)(uintptr_t)to->lent,
	};
	VkMemoryAllocateInfo info = {
		.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
		.pNext = to->lent != NULL ? &import : NULL,
		.allocationSize = to->lent != NULL ? (needs.size + GW_LENT_ALIGNMENT - 1) /
												 GW_LENT_ALIGNMENT * GW_LENT_ALIGNMENT
										   : needs.size,
		.memoryTypeIndex = (uint32_t)type,
	};
	GW_VULKAN(gpu, error, name, vkAllocateMemory(gpu->handle, &info, NULL, to->memory));
	gw_gpu_name(gpu, VK_OBJECT_TYPE_DEVICE_MEMORY, (uint64_t)*to->memory, name);
	*to->allocated = needs.size;
	gpu->account.bytes += needs.size;
	if (gpu->account.bytes > gpu->account.peak_bytes)
		gpu->account.peak_bytes = gpu->account.bytes;
	return GW_OK;
}

/* Not of a driver that was given up: see `stuck` in gpu_internal.h. */
static void destroy_buffer(gw_gpu *gpu, VkBufferView view, VkBuffer handle)
{
	if (gpu->stuck)
		return;
	vkDestroyBufferView(gpu->handle, view, NULL);
	vkDestroyBuffer(gpu->handle, handle, NULL);
}

static void release(gw_gpu *gpu, VkDeviceMemory memory, uint64_t allocated)
{
	if (gpu->stuck)
		return;
	vkFreeMemory(gpu->handle, memory, NULL);
	assert(gpu->account.bytes >= allocated);
	gpu->account.bytes -= allocated;
}

/* A buffer with memory bound to it. */
static gw_status create_buffer(gw_gpu *gpu, VkBufferUsageFlags usage, uint64_t bytes,
							   const allocation *to, VkBuffer *handle, gw_error *error)
{
	VkExternalMemoryBufferCreateInfo external = {
		.sType = VK_STRUCTURE_TYPE_EXTERNAL_MEMORY_BUFFER_CREATE_INFO,
		.handleTypes = host_memory,
	};
	VkBufferCreateInfo info = {
		.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO,
		.pNext = to->lent != NULL ? &external : NULL,
		.size = bytes,
		.usage = usage | VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT,
		.sharingMode = VK_SHARING_MODE_EXCLUSIVE,
	};
	GW_VULKAN(gpu, error, to->name, vkCreateBuffer(gpu->handle, &info, NULL, handle));
	gw_gpu_name(gpu, VK_OBJECT_TYPE_BUFFER, (uint64_t)*handle, to->name);
	VkMemoryRequirements needs;
	vkGetBufferMemoryRequirements(gpu->handle, *handle, &needs);
	GW_TRY(allocate(gpu, needs, to, error));
	GW_VULKAN(gpu, error, to->name, vkBindBufferMemory(gpu->handle, *handle, *to->memory, 0));
	return GW_OK;
}

/* ------------------------------------------------------------------------------- staging */

/* Makes the staging buffer on first use. */
static gw_status need_staging(gw_gpu *gpu, gw_error *error)
{
	gw_staging *staging = &gpu->staging;
	if (staging->mapped != NULL)
		return GW_OK;
	const allocation to = { .name = "staging buffer",
							.staging = true,
							.memory = &staging->memory,
							.allocated = &staging->allocated };
	gw_status status = create_buffer(gpu, 0, STAGING_BYTES, &to, &staging->handle, error);
	VkResult result = VK_SUCCESS;
	if (status == GW_OK)
		result = vkMapMemory(gpu->handle, staging->memory, 0, VK_WHOLE_SIZE, 0, &staging->mapped);
	if (result != VK_SUCCESS)
		status = gw_vulkan_fail(gpu, error, "vkMapMemory", "the staging buffer", result);
	staging->bytes = STAGING_BYTES;
	if (status != GW_OK)
		gw_staging_destroy(gpu);
	return status;
}

void gw_staging_destroy(gw_gpu *gpu)
{
	gw_staging *staging = &gpu->staging;
	destroy_buffer(gpu, VK_NULL_HANDLE, staging->handle);
	release(gpu, staging->memory, staging->allocated);
	*staging = (gw_staging){ 0 };
}

/* ------------------------------------------------------------------------------- buffers */

static gw_status check_texel_buffer(const gw_gpu *gpu, VkFormat format, uint64_t bytes,
									const char *name, gw_error *error)
{
	uint32_t texel = texel_bytes(format);
	VkFormatProperties properties;
	vkGetPhysicalDeviceFormatProperties(gpu->device.handle, format, &properties);
	if (texel == 0 || !(properties.bufferFeatures & VK_FORMAT_FEATURE_UNIFORM_TEXEL_BUFFER_BIT))
		return gw_fail(error, GW_ERROR_INTERNAL,
					   "\"%s\" cannot be a texel buffer of format %d on \"%s\"", name, (int)format,
					   gpu->device.info.name);
	if (bytes % texel != 0)
		return gw_fail(error, GW_ERROR_INTERNAL,
					   "\"%s\" of %" PRIu64 " bytes is not a whole number of texels of %u bytes",
					   name, bytes, texel);
	uint32_t most = gw_gpu_limits(gpu)->maxTexelBufferElements;
	if (bytes / texel > most)
		return gw_fail(error, GW_ERROR_MEMORY,
					   "\"%s\" needs %" PRIu64 " bytes, %" PRIu64 " texels, but \"%s\" reads at "
					   "most %u texels of a buffer: bake with fewer points or a coarser octree",
					   name, bytes, bytes / texel, gpu->device.info.name, most);
	return GW_OK;
}

/* All formats that passes write texels of can be written; others may be. */
static VkBufferUsageFlags texel_usage(const gw_gpu *gpu, VkFormat format)
{
	VkFormatProperties properties;
	vkGetPhysicalDeviceFormatProperties(gpu->device.handle, format, &properties);
	bool written = properties.bufferFeatures & VK_FORMAT_FEATURE_STORAGE_TEXEL_BUFFER_BIT;
	return VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT |
		   (written ? VK_BUFFER_USAGE_STORAGE_TEXEL_BUFFER_BIT : 0u);
}

static gw_status create_view(gw_gpu *gpu, VkFormat format, gw_buffer *buffer, gw_error *error)
{
	VkBufferViewCreateInfo info = {
		.sType = VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO,
		.buffer = buffer->handle,
		.format = format,
		.range = VK_WHOLE_SIZE,
	};
	GW_VULKAN(gpu, error, buffer->name,
			  vkCreateBufferView(gpu->handle, &info, NULL, &buffer->view));
	gw_gpu_name(gpu, VK_OBJECT_TYPE_BUFFER_VIEW, (uint64_t)buffer->view, buffer->name);
	return GW_OK;
}

/* Leaves to the caller to destroy what there is when it fails. */
static gw_status make_buffer(gw_gpu *gpu, const gw_buffer_description *description,
							 const void *lent, gw_buffer *buffer, gw_error *error)
{
	GW_TRY(gw_gpu_check(gpu, error));
	const char *name = buffer->name;
	bool texel = description->kind == GW_BUFFER_TEXEL;
	uint64_t size = buffer->bytes > BUFFER_BYTES_MIN ? buffer->bytes : BUFFER_BYTES_MIN;
	/* Checked before the driver sees the size: some wrap large ones around. */
	GW_TRY(check_budget(gpu, size, name, error));
	if (texel)
		GW_TRY(check_texel_buffer(gpu, description->format, size, name, error));
	size = (size + 3) / 4 * 4;
	VkBufferUsageFlags usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT;
	if (texel)
		usage |= texel_usage(gpu, description->format);
	const allocation to = {
		.name = name, .lent = lent, .memory = &buffer->memory, .allocated = &buffer->allocated
	};
	GW_TRY(create_buffer(gpu, usage, size, &to, &buffer->handle, error));
	if (texel)
		GW_TRY(create_view(gpu, description->format, buffer, error));
	buffer->mapped = (void *)(uintptr_t)lent;
	/* Stays mapped until the memory is freed. */
	if (lent == NULL && gpu->device.properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU &&
		is_mappable(gpu, UINT32_MAX)) {
		GW_VULKAN(gpu, error, name,
				  vkMapMemory(gpu->handle, buffer->memory, 0, VK_WHOLE_SIZE, 0, &buffer->mapped));
		gw_wish_huge_pages(buffer->mapped, size);
	}
	return GW_OK;
}

static gw_status begin_buffer(gw_gpu *gpu, const gw_buffer_description *description,
							  const void *lent, gw_buffer *buffer, gw_error *error)
{
	assert(description->name != NULL);
	*buffer = (gw_buffer){ .bytes = description->bytes,
						   .lent = lent != NULL,
						   .format = description->format,
						   .name = description->name };
	gw_status status = make_buffer(gpu, description, lent, buffer, error);
	if (status != GW_OK)
		gw_buffer_destroy(gpu, buffer);
	return status;
}

gw_status gw_buffer_create_unset(gw_gpu *gpu, const gw_buffer_description *description,
								 gw_buffer *buffer, gw_error *error)
{
	return begin_buffer(gpu, description, NULL, buffer, error);
}

bool gw_buffer_may_borrow(const gw_gpu *gpu, const void *bytes)
{
	return gpu->imports && gw_gpu_shares_memory(gpu) && (uintptr_t)bytes % GW_LENT_ALIGNMENT == 0;
}

gw_status gw_buffer_borrow(gw_gpu *gpu, const gw_buffer_description *description, const void *lent,
						   bool fleeting, gw_buffer *buffer, gw_error *error)
{
	assert(description->kind == GW_BUFFER_TEXEL && gw_buffer_may_borrow(gpu, lent));
	GW_TRY(begin_buffer(gpu, description, lent, buffer, error));
	buffer->fleeting = fleeting;
	return GW_OK;
}

gw_status gw_buffer_create(gw_gpu *gpu, const gw_buffer_description *description, gw_buffer *buffer,
						   gw_error *error)
{
	gw_status status = gw_buffer_create_unset(gpu, description, buffer, error);
	if (status == GW_OK)
		status = gw_buffer_fill(gpu, buffer, 0, error);
	if (status != GW_OK)
		gw_buffer_destroy(gpu, buffer);
	return status;
}

void gw_buffer_destroy(gw_gpu *gpu, gw_buffer *buffer)
{
	if (gw_commands_used(gpu, (uint64_t)buffer->handle))
		gw_gpu_settle(gpu);
	destroy_buffer(gpu, buffer->view, buffer->handle);
	release(gpu, buffer->memory, buffer->allocated);
	*buffer = (gw_buffer){ 0 };
}

/* The same on the CPU, for what nothing uses: the software driver's fill goes word by word through
 * a copy. */
static void fill_mapped(gw_buffer *buffer, uint32_t word)
{
	uint64_t bytes = buffer->bytes > BUFFER_BYTES_MIN ? buffer->bytes : BUFFER_BYTES_MIN;
	bytes = (bytes + 3) / 4 * 4;
	assert(buffer->mapped != NULL);
	if (word == 0)
		memset(buffer->mapped, 0, (size_t)bytes);
	for (uint32_t *at = buffer->mapped, *end = at + bytes / 4; word != 0 && at < end; at++)
		*at = word;
}

gw_status gw_buffer_fill(gw_gpu *gpu, gw_buffer *buffer, uint32_t word, gw_error *error)
{
	if (gw_gpu_shares_memory(gpu) && !gw_commands_used(gpu, (uint64_t)buffer->handle)) {
		fill_mapped(buffer, word);
		return gw_gpu_check(gpu, error);
	}
	GW_TRY(gw_commands_begin(gpu, error));
	gw_commands_use(gpu, (uint64_t)buffer->handle, buffer->name);
	vkCmdFillBuffer(gpu->commands, buffer->handle, 0, VK_WHOLE_SIZE, word);
	return gw_gpu_check(gpu, error);
}

/* ------------------------------------------------------------------------------ transfers */

/* A copy between a part of a buffer and the host. Of to and from exactly one is NULL, and stands
 * for the buffer. */
typedef struct transfer {
	uint64_t offset, bytes; /* of the part */
	char *to;
	const char *from;
} transfer;

/* A few bytes travel with the commands. */
static gw_status record_bytes(gw_gpu *gpu, const gw_buffer *buffer, transfer c, gw_error *error)
{
	GW_TRY(gw_commands_begin(gpu, error));
	gw_commands_use(gpu, (uint64_t)buffer->handle, buffer->name);
	vkCmdUpdateBuffer(gpu->commands, buffer->handle, c.offset, c.bytes, c.from);
	return gw_gpu_check(gpu, error);
}

static gw_status copy_mapped(gw_gpu *gpu, const gw_buffer *buffer, transfer c, gw_error *error)
{
	void *mapped;
	if (gw_commands_used(gpu, (uint64_t)buffer->handle))
		GW_TRY(gw_gpu_finish(gpu, error));
	if (buffer->mapped != NULL)
		mapped = (char *)buffer->mapped + c.offset;
	else
		GW_VULKAN(gpu, error, buffer->name,
				  vkMapMemory(gpu->handle, buffer->memory, c.offset, c.bytes, 0, &mapped));
	memcpy(c.to != NULL ? c.to : mapped, c.from != NULL ? c.from : mapped, (size_t)c.bytes);
	if (buffer->mapped == NULL)
		vkUnmapMemory(gpu->handle, buffer->memory);
	return GW_OK;
}

static gw_status copy_staged(gw_gpu *gpu, const gw_buffer *buffer, transfer c, gw_error *error)
{
	GW_TRY(need_staging(gpu, error));
	gw_staging *staging = &gpu->staging;
	for (uint64_t done = 0; done < c.bytes;) {
		uint64_t part = c.bytes - done < staging->bytes ? c.bytes - done : staging->bytes;
		VkBufferCopy region = { .size = part };
		if (c.from != NULL) {
			memcpy(staging->mapped, c.from + done, (size_t)part);
			region.dstOffset = c.offset + done;
		} else {
			region.srcOffset = c.offset + done;
		}
		GW_TRY(gw_commands_begin(gpu, error));
		gw_commands_use(gpu, (uint64_t)buffer->handle, buffer->name);
		vkCmdCopyBuffer(gpu->commands, c.from != NULL ? staging->handle : buffer->handle,
						c.from != NULL ? buffer->handle : staging->handle, 1, &region);
		GW_TRY(gw_commands_submit(gpu, error));
		if (c.to != NULL)
			memcpy(c.to + done, staging->mapped, (size_t)part);
		done += part;
	}
	return GW_OK;
}

static gw_status copy_buffer(gw_gpu *gpu, const gw_buffer *buffer, transfer c, gw_error *error)
{
	GW_TRY(gw_gpu_check(gpu, error));
	if (c.offset > buffer->bytes || c.bytes > buffer->bytes - c.offset)
		return gw_fail(error, GW_ERROR_INTERNAL,
					   "copying %" PRIu64 " bytes at %" PRIu64 " does not fit \"%s\" of %" PRIu64
					   " bytes",
					   c.bytes, c.offset, buffer->name, buffer->bytes);
	assert(c.offset % 4 == 0 && c.bytes % 4 == 0);
	if (c.bytes == 0)
		return GW_OK;
	*(c.to != NULL ? &gpu->account.downloaded_bytes : &gpu->account.uploaded_bytes) += c.bytes;
	VkMemoryRequirements needs;
	vkGetBufferMemoryRequirements(gpu->handle, buffer->handle, &needs);
	bool maps = gpu->may_map && is_mappable(gpu, needs.memoryTypeBits);
	bool waits = !maps || gw_commands_used(gpu, (uint64_t)buffer->handle);
	bool in_words = c.bytes % 4 == 0 && c.offset % 4 == 0; /* as vkCmdUpdateBuffer wants them */
	if (waits && c.from != NULL && in_words && c.bytes <= UPDATE_BYTES)
		return record_bytes(gpu, buffer, c, error);
	return maps ? copy_mapped(gpu, buffer, c, error) : copy_staged(gpu, buffer, c, error);
}

gw_status gw_buffer_upload(gw_gpu *gpu, gw_buffer *buffer, uint64_t offset, const void *data,
						   uint64_t bytes, gw_error *error)
{
	return copy_buffer(gpu, buffer, (transfer){ .offset = offset, .bytes = bytes, .from = data },
					   error);
}

gw_status gw_buffer_download(gw_gpu *gpu, const gw_buffer *buffer, uint64_t offset, void *data,
							 uint64_t bytes, gw_error *error)
{
	return copy_buffer(gpu, buffer, (transfer){ .offset = offset, .bytes = bytes, .to = data },
					   error);
}

/* --------------------------------------------------------------------------- on the CPU */

bool gw_gpu_shares_memory(const gw_gpu *gpu)
{
	return gpu->may_map && gpu->device.properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU &&
		   is_mappable(gpu, UINT32_MAX);
}

gw_status gw_view_open(gw_gpu *gpu, const gw_buffer *buffer, uint64_t bytes, gw_view *view,
					   gw_error *error)
{
	*view = (gw_view){ 0 };
	GW_TRY(gw_gpu_check(gpu, error));
	if (gw_gpu_shares_memory(gpu) && bytes <= buffer->bytes) {
		if (gw_commands_used(gpu, (uint64_t)buffer->handle))
			GW_TRY(gw_gpu_finish(gpu, error));
		gpu->account.downloaded_bytes += bytes;
		view->bytes = buffer->mapped;
		return GW_OK;
	}
	void *copy = gw_allocate_array((size_t)bytes, 1);
	if (copy == NULL)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for a copy of the %s", buffer->name);
	gw_status status = gw_buffer_download(gpu, buffer, 0, copy, bytes, error);
	if (status == GW_OK)
		*view = (gw_view){ .bytes = copy, .copy = copy };
	else
		free(copy);
	return status;
}

void gw_view_close(gw_view *view)
{
	free(view->copy);
	*view = (gw_view){ 0 };
}

gw_status gw_buffer_own(gw_gpu *gpu, gw_buffer *buffer, gw_error *error)
{
	gw_buffer own;
	if (!buffer->lent)
		return GW_OK;
	GW_TRY(gw_buffer_create_unset(
		gpu,
		&(gw_buffer_description){ GW_BUFFER_TEXEL, buffer->format, buffer->bytes, buffer->name },
		&own, error));
	gw_status status = gw_buffer_upload(gpu, &own, 0, buffer->mapped, buffer->bytes, error);
	gw_buffer_destroy(gpu, status == GW_OK ? buffer : &own);
	if (status == GW_OK)
		*buffer = own;
	return status;
}

gw_status gw_edit_open(gw_gpu *gpu, gw_buffer *buffer, gw_edit *edit, gw_error *error)
{
	*edit = (gw_edit){ 0 };
	GW_TRY(gw_buffer_own(gpu, buffer, error));
	gw_view view;
	GW_TRY(gw_view_open(gpu, buffer, buffer->bytes, &view, error));
	*edit = (gw_edit){ view.copy ? view.copy : buffer->mapped, buffer, view.copy };
	return GW_OK;
}

gw_status gw_edit_close(gw_gpu *gpu, gw_edit *edit, bool changed, gw_error *error)
{
	gw_status status = GW_OK;
	if (edit->copy == NULL && changed && edit->buffer != NULL)
		gpu->account.uploaded_bytes += edit->buffer->bytes;
	else if (edit->copy != NULL && changed)
		status = gw_buffer_upload(gpu, edit->buffer, 0, edit->copy, edit->buffer->bytes, error);
	free(edit->copy);
	*edit = (gw_edit){ 0 };
	return status;
}

/* -------------------------------------------------------------------------------- images */

static const VkImageSubresourceRange whole_image = { .aspectMask = VK_IMAGE_ASPECT_COLOR_BIT,
													 .levelCount = 1,
													 .layerCount = 1 };

static gw_status check_image(const gw_gpu *gpu, const gw_image *image, gw_error *error)
{
	VkFormatFeatureFlags needed =
		VK_FORMAT_FEATURE_STORAGE_IMAGE_BIT | VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT |
		VK_FORMAT_FEATURE_TRANSFER_SRC_BIT | VK_FORMAT_FEATURE_TRANSFER_DST_BIT;
	VkFormatProperties properties;
	vkGetPhysicalDeviceFormatProperties(gpu->device.handle, image->format, &properties);
	if (texel_bytes(image->format) == 0 || (properties.optimalTilingFeatures & needed) != needed)
		return gw_fail(error, GW_ERROR_INTERNAL, "\"%s\" cannot be an image of format %d on \"%s\"",
					   image->name, (int)image->format, gpu->device.info.name);
	uint32_t most = gw_gpu_limits(gpu)->maxImageDimension3D;
	uint64_t bytes = texel_bytes(image->format);
	for (int i = 0; i < 3; i++) {
		uint32_t side = image->extent[i];
		if (side == 0 || side > most)
			return gw_fail(error, GW_ERROR_MEMORY,
						   "\"%s\" needs an image of %u x %u x %u texels, but \"%s\" has images of "
						   "1 to %u texels a side: bake with fewer points or a coarser octree",
						   image->name, image->extent[0], image->extent[1], image->extent[2],
						   gpu->device.info.name, most);
		if (__builtin_mul_overflow(bytes, (uint64_t)side, &bytes))
			bytes = UINT64_MAX;
	}
	return check_budget(gpu, bytes, image->name, error);
}

static gw_status allocate_image(gw_gpu *gpu, gw_image *image, gw_error *error)
{
	VkImageCreateInfo info = {
		.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
		.imageType = VK_IMAGE_TYPE_3D,
		.format = image->format,
		.extent = { image->extent[0], image->extent[1], image->extent[2] },
		.mipLevels = 1,
		.arrayLayers = 1,
		.samples = VK_SAMPLE_COUNT_1_BIT,
		.tiling = VK_IMAGE_TILING_OPTIMAL,
		.usage = VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_SAMPLED_BIT |
				 VK_IMAGE_USAGE_TRANSFER_SRC_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT,
		.sharingMode = VK_SHARING_MODE_EXCLUSIVE,
		.initialLayout = VK_IMAGE_LAYOUT_UNDEFINED,
	};
	GW_VULKAN(gpu, error, image->name, vkCreateImage(gpu->handle, &info, NULL, &image->handle));
	gw_gpu_name(gpu, VK_OBJECT_TYPE_IMAGE, (uint64_t)image->handle, image->name);
	VkMemoryRequirements needs;
	vkGetImageMemoryRequirements(gpu->handle, image->handle, &needs);
	const allocation to = { .name = image->name,
							.memory = &image->memory,
							.allocated = &image->allocated };
	GW_TRY(allocate(gpu, needs, &to, error));
	GW_VULKAN(gpu, error, image->name,
			  vkBindImageMemory(gpu->handle, image->handle, image->memory, 0));
	return GW_OK;
}

static gw_status create_image_view(gw_gpu *gpu, gw_image *image, gw_error *error)
{
	VkImageViewCreateInfo info = {
		.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
		.image = image->handle,
		.viewType = VK_IMAGE_VIEW_TYPE_3D,
		.format = image->format,
		.subresourceRange = whole_image,
	};
	GW_VULKAN(gpu, error, image->name, vkCreateImageView(gpu->handle, &info, NULL, &image->view));
	gw_gpu_name(gpu, VK_OBJECT_TYPE_IMAGE_VIEW, (uint64_t)image->view, image->name);
	return GW_OK;
}

/* Brings a new image into its layout and fills it with zeros. */
static gw_status clear_image(gw_gpu *gpu, const gw_image *image, gw_error *error)
{
	GW_TRY(gw_commands_begin(gpu, error));
	gw_commands_use(gpu, (uint64_t)image->handle, image->name);
	VkImageMemoryBarrier barrier = {
		.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
		.dstAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT,
		.oldLayout = VK_IMAGE_LAYOUT_UNDEFINED,
		.newLayout = VK_IMAGE_LAYOUT_GENERAL,
		.srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
		.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
		.image = image->handle,
		.subresourceRange = whole_image,
	};
	vkCmdPipelineBarrier(gpu->commands, VK_PIPELINE_STAGE_TRANSFER_BIT,
						 VK_PIPELINE_STAGE_TRANSFER_BIT, 0, 0, NULL, 0, NULL, 1, &barrier);
	VkClearColorValue zero = { 0 };
	vkCmdClearColorImage(gpu->commands, image->handle, VK_IMAGE_LAYOUT_GENERAL, &zero, 1,
						 &whole_image);
	return gw_gpu_check(gpu, error);
}

static gw_status make_image(gw_gpu *gpu, gw_image *image, gw_error *error)
{
	GW_TRY(gw_gpu_check(gpu, error));
	GW_TRY(check_image(gpu, image, error));
	GW_TRY(allocate_image(gpu, image, error));
	GW_TRY(create_image_view(gpu, image, error));
	return clear_image(gpu, image, error);
}

gw_status gw_image_create(gw_gpu *gpu, VkFormat format, const uint32_t extent[3], const char *name,
						  gw_image *image, gw_error *error)
{
	assert(name != NULL);
	*image =
		(gw_image){ .format = format, .extent = { extent[0], extent[1], extent[2] }, .name = name };
	gw_status status = make_image(gpu, image, error);
	if (status != GW_OK)
		gw_image_destroy(gpu, image);
	return status;
}

void gw_image_destroy(gw_gpu *gpu, gw_image *image)
{
	if (gw_commands_used(gpu, (uint64_t)image->handle))
		gw_gpu_settle(gpu);
	if (!gpu->stuck) {
		vkDestroyImageView(gpu->handle, image->view, NULL);
		vkDestroyImage(gpu->handle, image->handle, NULL);
	}
	release(gpu, image->memory, image->allocated);
	*image = (gw_image){ 0 };
}

/* Copies `rows` rows of `depth` layers from (0, y, z) on; they fit the staging buffer. */
static gw_status download_block(gw_gpu *gpu, const gw_image *image, VkOffset3D from,
								VkExtent3D block, gw_error *error)
{
	VkBufferImageCopy region = {
		.imageSubresource = { .aspectMask = VK_IMAGE_ASPECT_COLOR_BIT, .layerCount = 1 },
		.imageOffset = from,
		.imageExtent = block,
	};
	GW_TRY(gw_commands_begin(gpu, error));
	gw_commands_use(gpu, (uint64_t)image->handle, image->name);
	vkCmdCopyImageToBuffer(gpu->commands, image->handle, VK_IMAGE_LAYOUT_GENERAL,
						   gpu->staging.handle, 1, &region);
	return gw_commands_submit(gpu, error);
}

gw_status gw_image_download(gw_gpu *gpu, gw_image *image, void *data, uint64_t bytes,
							gw_error *error)
{
	GW_TRY(gw_gpu_check(gpu, error));
	GW_TRY(need_staging(gpu, error));
	const uint32_t *extent = image->extent;
	uint64_t row = (uint64_t)texel_bytes(image->format) * extent[0];
	uint64_t layer = row * extent[1];
	assert(layer > 0);
	if (bytes != layer * extent[2])
		return gw_fail(error, GW_ERROR_INTERNAL,
					   "\"%s\" holds %" PRIu64 " bytes, but %" PRIu64 " were asked for",
					   image->name, layer * extent[2], bytes);
	/* As many layers at once as the staging buffer holds; when not even one, then rows of it. */
	uint64_t layers = gpu->staging.bytes / layer, rows = gpu->staging.bytes / row;
	assert(rows > 0);
	uint32_t step_z = layers == 0 ? 1 : layers < extent[2] ? (uint32_t)layers : extent[2];
	uint32_t step_y = rows < extent[1] ? (uint32_t)rows : extent[1];
	char *to = data;
	gpu->account.downloaded_bytes += bytes;
	for (uint32_t z = 0; z < extent[2]; z += step_z) {
		uint32_t depth = extent[2] - z < step_z ? extent[2] - z : step_z;
		for (uint32_t y = 0; y < extent[1]; y += step_y) {
			uint32_t height = extent[1] - y < step_y ? extent[1] - y : step_y;
			GW_TRY(download_block(gpu, image, (VkOffset3D){ 0, (int32_t)y, (int32_t)z },
								  (VkExtent3D){ extent[0], height, depth }, error));
			size_t size = (size_t)(row * height * depth);
			memcpy(to, gpu->staging.mapped, size);
			to += size;
		}
	}
	return GW_OK;
}
