/*
 * gpu_instance.c - the Vulkan instance, what the validation layer says, and the list of devices.
 */
#include "device/gpu_internal.h"
#include "base/memory.h"
#include "base/parallel.h"

#include <assert.h>
#include <ctype.h>
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define VALIDATION_LAYER "VK_LAYER_KHRONOS_validation"
/* Where less can be taken, drivers may not load: a software one and its compiler take about that.
 */
#define DRIVER_BYTES (UINT64_C(384) << 20)
#define VULKAN_VERSION VK_API_VERSION_1_2

/* ---------------------------------------------------------------------------- messages */

static VKAPI_ATTR VkBool32 VKAPI_CALL receive_message(
	VkDebugUtilsMessageSeverityFlagBitsEXT severity, VkDebugUtilsMessageTypeFlagsEXT types,
	const VkDebugUtilsMessengerCallbackDataEXT *data, void *user)
{
	gw_messages *messages = user;
	(void)severity;
	(void)types;
	/* The layer also talks about its own setup, which is no fault of ours. */
	const char *id = data->pMessageIdName != NULL ? data->pMessageIdName : "";
	if (strstr(data->pMessage, "Setup Warning") != NULL || strstr(id, "Setup Warning") != NULL)
		return VK_FALSE;
	snprintf(messages->latest, sizeof messages->latest, "%s", data->pMessage);
	if (messages->count++ == 0)
		memcpy(messages->first, messages->latest, sizeof messages->first);
	return VK_FALSE;
}

static const VkDebugUtilsMessengerCreateInfoEXT messenger_template = {
	.sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
	.messageSeverity = VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT |
					   VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
	.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT,
	.pfnUserCallback = receive_message,
};

/* ---------------------------------------------------------------------------- instance */

static bool has_layer(const char *name)
{
	uint32_t count = 0;
	if (vkEnumerateInstanceLayerProperties(&count, NULL) != VK_SUCCESS || count == 0)
		return false;
	VkLayerProperties *layer = gw_allocate_zeros(count, sizeof *layer);
	bool found = false;
	if (layer != NULL && vkEnumerateInstanceLayerProperties(&count, layer) == VK_SUCCESS)
		for (uint32_t i = 0; i < count; i++)
			found = found || strcmp(layer[i].layerName, name) == 0;
	free(layer);
	return found;
}

static bool has_instance_extension(const char *layer, const char *name)
{
	uint32_t count = 0;
	if (vkEnumerateInstanceExtensionProperties(layer, &count, NULL) != VK_SUCCESS || count == 0)
		return false;
	VkExtensionProperties *extension = gw_allocate_zeros(count, sizeof *extension);
	bool found = false;
	if (extension != NULL &&
		vkEnumerateInstanceExtensionProperties(layer, &count, extension) == VK_SUCCESS)
		for (uint32_t i = 0; i < count; i++)
			found = found || strcmp(extension[i].extensionName, name) == 0;
	free(extension);
	return found;
}

static bool wants_validation(const gw_gpu_options *options)
{
	return options->validate || options->validate_synchronization || options->validate_gpu_assisted;
}

static gw_status check_validation(const gw_gpu_options *options, gw_error *error)
{
	if (options->validate_synchronization && options->validate_gpu_assisted)
		return gw_fail(error, GW_ERROR_USAGE,
					   "synchronisation and GPU-assisted validation cannot run together: ask for "
					   "one of them");
	if (!has_layer(VALIDATION_LAYER))
		return gw_fail(error, GW_ERROR_USAGE,
					   "validation was asked for, but the Vulkan layer %s is not installed: "
					   "install the package vulkan-validationlayers",
					   VALIDATION_LAYER);
	if (!has_instance_extension(VALIDATION_LAYER, VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME) ||
		!has_instance_extension(VALIDATION_LAYER, VK_EXT_DEBUG_UTILS_EXTENSION_NAME))
		return gw_fail(error, GW_ERROR_USAGE, "the installed %s is too old: it lacks %s or %s",
					   VALIDATION_LAYER, VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME,
					   VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
	return GW_OK;
}

static void load_debug_functions(gw_instance *instance,
								 PFN_vkCreateDebugUtilsMessengerEXT *create_messenger)
{
	*create_messenger = (PFN_vkCreateDebugUtilsMessengerEXT)vkGetInstanceProcAddr(
		instance->handle, "vkCreateDebugUtilsMessengerEXT");
	instance->destroy_messenger = (PFN_vkDestroyDebugUtilsMessengerEXT)vkGetInstanceProcAddr(
		instance->handle, "vkDestroyDebugUtilsMessengerEXT");
	instance->set_name = (PFN_vkSetDebugUtilsObjectNameEXT)vkGetInstanceProcAddr(
		instance->handle, "vkSetDebugUtilsObjectNameEXT");
}

/* There is no driver, or no device where the result is VK_SUCCESS: perhaps because loading drivers
 * found no memory. */
static gw_status fail_drivers(VkResult result, gw_error *error)
{
	static const char remedy[] = "install a driver, for example the package mesa-vulkan-drivers, "
								 "which also runs without a GPU";
	uint64_t available = gw_available_memory();
	if (available > 0 && available < DRIVER_BYTES)
		return gw_fail(error, GW_ERROR_MEMORY,
					   "no Vulkan driver could be loaded, most likely because no more than %llu MB "
					   "of memory may be taken (see ulimit -v): allow more",
					   (unsigned long long)(available >> 20));
	if (result == VK_SUCCESS)
		return gw_fail(error, GW_ERROR_NO_DEVICE, "there is no Vulkan device: %s", remedy);
	return gw_fail(error, GW_ERROR_NO_DEVICE,
				   "there is no working Vulkan driver (vkCreateInstance: %s): %s",
				   gw_vulkan_result_name(result), remedy);
}

static gw_status create_instance(const gw_gpu_options *options, gw_messages *messages,
								 gw_instance *instance, gw_error *error)
{
	bool validate = wants_validation(options);
	if (validate)
		GW_TRY(check_validation(options, error));
	VkDebugUtilsMessengerCreateInfoEXT messenger = messenger_template;
	messenger.pUserData = messages;
	VkValidationFeatureEnableEXT enable =
		options->validate_synchronization
			? VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT
			: VK_VALIDATION_FEATURE_ENABLE_GPU_ASSISTED_EXT;
	VkValidationFeaturesEXT features = {
		.sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT,
		.pNext = &messenger,
		.enabledValidationFeatureCount =
			options->validate_synchronization || options->validate_gpu_assisted ? 1 : 0,
		.pEnabledValidationFeatures = &enable,
	};
	const char *layers[] = { VALIDATION_LAYER };
	const char *extensions[] = { VK_EXT_DEBUG_UTILS_EXTENSION_NAME,
								 VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME };
	VkApplicationInfo application = {
		.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
		.pApplicationName = "glowworm",
		.pEngineName = "glowworm",
		.apiVersion = VULKAN_VERSION,
	};
	VkInstanceCreateInfo info = {
		.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
		.pNext = validate ? &features : NULL,
		.pApplicationInfo = &application,
		.enabledLayerCount = validate ? 1 : 0,
		.ppEnabledLayerNames = layers,
		.enabledExtensionCount = validate ? 2 : 1,
		.ppEnabledExtensionNames = extensions,
	};
	/* To ask before whether there are names for objects takes the loader as long as to try. */
	VkResult result = vkCreateInstance(&info, NULL, &instance->handle);
	bool debug = result != VK_ERROR_EXTENSION_NOT_PRESENT;
	if (!debug && !validate) {
		info.enabledExtensionCount = 0;
		result = vkCreateInstance(&info, NULL, &instance->handle);
	}
	if (result == VK_ERROR_INCOMPATIBLE_DRIVER || result == VK_ERROR_INITIALIZATION_FAILED)
		return fail_drivers(result, error);
	if (result != VK_SUCCESS)
		return gw_vulkan_fail(NULL, error, "vkCreateInstance", "the Vulkan instance", result);

	PFN_vkCreateDebugUtilsMessengerEXT create_messenger = NULL;
	if (debug)
		load_debug_functions(instance, &create_messenger);
	if (validate)
		GW_VULKAN(NULL, error, "validation messages",
				  create_messenger(instance->handle, &messenger, NULL, &instance->messenger));
	return GW_OK;
}

struct gw_drivers {
	pthread_t thread;
	bool loaded; /* and the thread gone */
	gw_messages messages;
	gw_instance instance; /* an instance keeps its drivers loaded */
};

void gw_drivers_wait(gw_drivers *drivers)
{
	if (drivers == NULL || drivers->loaded)
		return;
	pthread_join(drivers->thread, NULL);
	drivers->loaded = true;
}

/* That of drivers that were loaded before, for devices that need no validation; else NULL. */
static const gw_instance *loaded_instance(const gw_gpu_options *options)
{
	if (options->drivers == NULL || options->validate || options->validate_synchronization ||
		options->validate_gpu_assisted)
		return NULL;
	gw_drivers_wait(options->drivers);
	const gw_instance *instance = &options->drivers->instance;
	return instance->handle != VK_NULL_HANDLE ? instance : NULL;
}

gw_status gw_instance_create(const gw_gpu_options *options, gw_messages *messages,
							 gw_instance *instance, gw_error *error)
{
	const gw_instance *loaded = loaded_instance(options);
	*instance = (gw_instance){ 0 };
	if (loaded != NULL) {
		*instance = (gw_instance){ .handle = loaded->handle, .lent = true };
		return GW_OK;
	}
	gw_status status = create_instance(options, messages, instance, error);
	if (status != GW_OK)
		gw_instance_destroy(instance);
	return status;
}

void gw_instance_destroy(gw_instance *instance)
{
	if (instance->messenger != VK_NULL_HANDLE)
		instance->destroy_messenger(instance->handle, instance->messenger, NULL);
	if (instance->handle != VK_NULL_HANDLE && !instance->lent)
		vkDestroyInstance(instance->handle, NULL);
	*instance = (gw_instance){ 0 };
}

/* ----------------------------------------------------------------------------- devices */

static const char *type_name(VkPhysicalDeviceType type)
{
	switch (type) {
	case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
		return "discrete";
	case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
		return "integrated";
	case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
		return "virtual";
	case VK_PHYSICAL_DEVICE_TYPE_CPU:
		return "cpu";
	default:
		return "other";
	}
}

static int type_rank(VkPhysicalDeviceType type)
{
	switch (type) {
	case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
		return 0;
	case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
		return 1;
	case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
		return 2;
	case VK_PHYSICAL_DEVICE_TYPE_CPU:
		return 3;
	default:
		return 4;
	}
}

/* Prefers a queue family that computes without drawing: it is less in the way of a display. */
static bool find_queue_family(gw_candidate *candidate)
{
	uint32_t count = 0;
	vkGetPhysicalDeviceQueueFamilyProperties(candidate->handle, &count, NULL);
	VkQueueFamilyProperties *family = gw_allocate_zeros(count, sizeof *family);
	if (family == NULL)
		return false;
	vkGetPhysicalDeviceQueueFamilyProperties(candidate->handle, &count, family);
	bool found = false;
	for (uint32_t i = 0; i < count; i++) {
		bool computes = family[i].queueFlags & VK_QUEUE_COMPUTE_BIT;
		bool draws = family[i].queueFlags & VK_QUEUE_GRAPHICS_BIT;
		if (!computes || family[i].queueCount == 0 || (found && draws))
			continue;
		candidate->queue_family = i;
		candidate->timestamp_bits = family[i].timestampValidBits;
		found = true;
	}
	free(family);
	return found;
}

/* Image formats that passes use, and what for. */
static const struct {
	VkFormat format;
	VkFormatFeatureFlags features;
	const char *missing;
} needed_format[] = {
	{ VK_FORMAT_R32_UINT, VK_FORMAT_FEATURE_STORAGE_IMAGE_BIT | VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT,
	  "storage images of format r32ui" },
	{ VK_FORMAT_R16G16B16A16_SFLOAT,
	  VK_FORMAT_FEATURE_STORAGE_IMAGE_BIT | VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT |
		  VK_FORMAT_FEATURE_SAMPLED_IMAGE_FILTER_LINEAR_BIT,
	  "filtered storage images of format rgba16f" },
	{ VK_FORMAT_R32G32B32A32_SFLOAT,
	  VK_FORMAT_FEATURE_STORAGE_IMAGE_BIT | VK_FORMAT_FEATURE_SAMPLED_IMAGE_BIT,
	  "storage images of format rgba32f" },
};

/* NULL when the device has all that the passes need. */
static const char *find_missing(gw_candidate *candidate)
{
	if (candidate->properties.apiVersion < VULKAN_VERSION)
		return "Vulkan 1.2";
	if (!find_queue_family(candidate))
		return "a queue for compute work";
	for (size_t i = 0; i < sizeof needed_format / sizeof *needed_format; i++) {
		VkFormatProperties format;
		vkGetPhysicalDeviceFormatProperties(candidate->handle, needed_format[i].format, &format);
		if ((format.optimalTilingFeatures & needed_format[i].features) != needed_format[i].features)
			return needed_format[i].missing;
	}
	return NULL;
}

static uint64_t largest_local_heap(VkPhysicalDevice device)
{
	VkPhysicalDeviceMemoryProperties memory;
	vkGetPhysicalDeviceMemoryProperties(device, &memory);
	uint64_t largest = 0;
	for (uint32_t i = 0; i < memory.memoryHeapCount; i++)
		if (memory.memoryHeaps[i].flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT &&
			memory.memoryHeaps[i].size > largest)
			largest = memory.memoryHeaps[i].size;
	return largest;
}

static void read_features(gw_candidate *candidate)
{
	VkPhysicalDeviceVulkan12Features features12 = {
		.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES
	};
	VkPhysicalDeviceFeatures2 features = { .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2,
										   .pNext = &features12 };
	vkGetPhysicalDeviceFeatures2(candidate->handle, &features);
	candidate->int64 = features.features.shaderInt64;
	candidate->int64_atomics = candidate->int64 && features12.shaderBufferInt64Atomics;
}

static void split_version(uint32_t packed, uint32_t version[3])
{
	version[0] = VK_API_VERSION_MAJOR(packed);
	version[1] = VK_API_VERSION_MINOR(packed);
	version[2] = VK_API_VERSION_PATCH(packed);
}

static void describe(VkPhysicalDevice handle, gw_candidate *candidate)
{
	*candidate = (gw_candidate){ .handle = handle };
	vkGetPhysicalDeviceProperties(handle, &candidate->properties);
	gw_device_info *info = &candidate->info;
	snprintf(info->name, sizeof info->name, "%s", candidate->properties.deviceName);
	split_version(candidate->properties.apiVersion, info->version);
	info->type = type_name(candidate->properties.deviceType);
	info->memory = largest_local_heap(handle);
	if (candidate->properties.apiVersion >= VULKAN_VERSION) {
		VkPhysicalDeviceDriverProperties driver = {
			.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES
		};
		VkPhysicalDeviceSubgroupProperties subgroup = {
			.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_PROPERTIES, .pNext = &driver
		};
		VkPhysicalDeviceProperties2 properties = {
			.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, .pNext = &subgroup
		};
		vkGetPhysicalDeviceProperties2(handle, &properties);
		/* Two strings of 256 bytes at most go into one. */
		snprintf(info->driver, sizeof info->driver, "%.100s %.150s", driver.driverName,
				 driver.driverInfo);
		info->subgroup_size = subgroup.subgroupSize;
		read_features(candidate);
	}
	const char *missing = find_missing(candidate);
	info->usable = missing == NULL;
	snprintf(info->missing, sizeof info->missing, "%s", missing != NULL ? missing : "");
}

/* Insertion sort by rank: few devices, and equals keep the driver's order. */
static void rank(gw_candidate *list, size_t count)
{
	for (size_t i = 1; i < count; i++)
		for (size_t j = i; j > 0 && type_rank(list[j].properties.deviceType) <
										type_rank(list[j - 1].properties.deviceType);
			 j--) {
			gw_candidate other = list[j];
			list[j] = list[j - 1];
			list[j - 1] = other;
		}
}

gw_status gw_candidates_find(VkInstance instance, gw_candidate **list, size_t *count,
							 gw_error *error)
{
	*list = NULL;
	*count = 0;
	uint32_t found = 0;
	VkResult result = vkEnumeratePhysicalDevices(instance, &found, NULL);
	if (result == VK_ERROR_INITIALIZATION_FAILED || (result == VK_SUCCESS && found == 0))
		return GW_OK;
	if (result != VK_SUCCESS)
		return gw_vulkan_fail(NULL, error, "vkEnumeratePhysicalDevices", "the devices", result);
	VkPhysicalDevice *handles = gw_allocate_zeros(found, sizeof(VkPhysicalDevice));
	*list = gw_allocate_zeros(found, sizeof **list);
	if (handles == NULL || *list == NULL)
		result = VK_ERROR_OUT_OF_HOST_MEMORY;
	else
		result = vkEnumeratePhysicalDevices(instance, &found, handles);
	if (result != VK_SUCCESS && result != VK_INCOMPLETE) {
		free(handles);
		free(*list);
		*list = NULL;
		return gw_vulkan_fail(NULL, error, "vkEnumeratePhysicalDevices", "the devices", result);
	}
	for (uint32_t i = 0; i < found; i++)
		describe(handles[i], &(*list)[i]);
	free(handles);
	rank(*list, found);
	*count = found;
	return GW_OK;
}

/* Whether `wanted` means this device: its index, its type, or a part of its name. */
static bool is_wanted(const gw_candidate *candidate, size_t index, size_t count, const char *wanted)
{
	bool number = wanted[strspn(wanted, "0123456789")] == '\0';
	if (number && strtoull(wanted, NULL, 10) < count)
		return strtoull(wanted, NULL, 10) == index;
	return strcasecmp(candidate->info.type, wanted) == 0 ||
		   strcasestr(candidate->info.name, wanted) != NULL;
}

static void print_list(const gw_candidate *list, size_t count, char *text, size_t size)
{
	size_t used = 0;
	text[0] = '\0';
	for (size_t i = 0; i < count && used < size; i++) {
		const gw_device_info *info = &list[i].info;
		int length =
			snprintf(text + used, size - used, "%s%zu \"%s\" (%s%s%s)", i > 0 ? ", " : "", i,
					 info->name, info->type, info->usable ? "" : ", lacks ", info->missing);
		used += length > 0 ? (size_t)length : 0;
	}
}

gw_status gw_candidate_choose(const gw_candidate *list, size_t count, const char *wanted,
							  gw_candidate *chosen, gw_error *error)
{
	if (wanted != NULL && wanted[0] == '\0')
		wanted = NULL;
	for (size_t i = 0; i < count; i++)
		if (list[i].info.usable && (wanted == NULL || is_wanted(&list[i], i, count, wanted))) {
			*chosen = list[i];
			return GW_OK;
		}
	if (count == 0)
		return fail_drivers(VK_SUCCESS, error);
	char text[GW_ERROR_TEXT - 200];
	print_list(list, count, text, sizeof text);
	if (wanted == NULL)
		return gw_fail(error, GW_ERROR_NO_DEVICE,
					   "no Vulkan device has all that is needed; there are: %s", text);
	return gw_fail(error, GW_ERROR_NO_DEVICE,
				   "no usable Vulkan device is meant by \"%.60s\" (an index, a type or part of a "
				   "name); there are: %s",
				   wanted, text);
}

gw_status gw_devices(gw_device_info **devices, size_t *count, gw_error *error)
{
	*devices = NULL;
	*count = 0;
	gw_messages messages = { 0 };
	gw_instance instance;
	gw_status status = gw_instance_create(&(gw_gpu_options){ 0 }, &messages, &instance, error);
	if (status == GW_ERROR_NO_DEVICE)
		return GW_OK; /* no driver: an empty list */
	GW_TRY(status);
	gw_candidate *list;
	size_t found;
	status = gw_candidates_find(instance.handle, &list, &found, error);
	if (status == GW_OK && found > 0) {
		*devices = gw_allocate_zeros(found, sizeof **devices);
		if (*devices == NULL)
			status =
				gw_fail(error, GW_ERROR_MEMORY, "not enough memory to list %zu devices", found);
		for (size_t i = 0; status == GW_OK && i < found; i++) {
			(*devices)[i] = list[i].info;
			gw_limits_list(&list[i], (*devices)[i].limit);
		}
		*count = status == GW_OK ? found : 0;
	}
	free(list);
	gw_instance_destroy(&instance);
	return status;
}

void gw_vulkan_version(uint32_t version[3])
{
	uint32_t packed = 0;
	if (vkEnumerateInstanceVersion(&packed) != VK_SUCCESS)
		packed = 0;
	split_version(packed, version);
}

/* ----------------------------------------------------------------------------- drivers */

static void *load_drivers(void *user)
{
	gw_drivers *drivers = user;
	gw_candidate *list = NULL;
	size_t count;
	if (gw_instance_create(&(gw_gpu_options){ 0 }, &drivers->messages, &drivers->instance, NULL) ==
			GW_OK &&
		gw_candidates_find(drivers->instance.handle, &list, &count, NULL) == GW_OK)
		free(list);
	return NULL;
}

gw_drivers *gw_drivers_load(void)
{
	gw_drivers *drivers = gw_allocate_zeros(1, sizeof *drivers);
	if (drivers == NULL)
		return NULL;
	/* Signals belong to the program's own threads: its handlers run there. */
	sigset_t all, before;
	gw_signals_to_block(&all);
	pthread_sigmask(SIG_SETMASK, &all, &before);
	int failure = pthread_create(&drivers->thread, NULL, load_drivers, drivers);
	pthread_sigmask(SIG_SETMASK, &before, NULL);
	if (failure == 0)
		return drivers;
	free(drivers);
	return NULL;
}

void gw_drivers_release(gw_drivers **drivers)
{
	if (*drivers == NULL)
		return;
	gw_drivers_wait(*drivers);
	gw_instance_destroy(&(*drivers)->instance);
	free(*drivers);
	*drivers = NULL;
}
