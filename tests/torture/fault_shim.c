/*
 * fault_shim.c - makes the n-th call of one kind fail, ours or a library's: a shared object for
 * LD_PRELOAD. Counting begins when main does; nothing that the loader does before counts.
 *
 *   FAULT_KIND     alloc, mmap, read, write, open, close, fsync (of files), folder (fsync of
 *                  folders), rename, thread, vulkan, or shrink; all: none fails, each is counted
 *   FAULT_AT       which call fails, from 1; 0 only counts
 *   FAULT_ONWARDS  1: all calls from that one on fail
 *   FAULT_OWNER    program: only calls that the program itself makes count; library: only others
 *   FAULT_ERROR    errno, or the VkResult, that the failing call gives; by default one that fits
 *   FAULT_REPORT   file to which `hit FUNCTION OWNER OBJECT` and, at a good end, `calls N` are
 *                  appended; OBJECT is `output` for a regular file that is open for writing.
 *                  Of all, `calls N KIND OWNER`, for each kind and owner
 *
 * shrink: just after the n-th time that a regular file is mapped or read or asked for its size, the
 * file becomes half as long. It is there to be lost; that FAULT_AT counts files that are open for
 * writing too does no harm, as these are not shrunk.
 */
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <link.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>
#include <vulkan/vulkan.h>

typedef enum fault_kind {
	NO_FAULT,
	ALLOC,
	MMAP,
	READ,
	WRITE,
	OPEN,
	CLOSE,
	FSYNC,
	FOLDER,
	RENAME,
	THREAD,
	VULKAN,
	SHRINK,
	ALL
} fault_kind;

static const char *const kind_name[] = {
	"",      "alloc",  "mmap",   "read",   "write",  "open",   "close",
	"fsync", "folder", "rename", "thread", "vulkan", "shrink", "all",
};

enum { ANY_OWNER, PROGRAM_OWNER, LIBRARY_OWNER };

static struct {
	atomic_bool counting;
	fault_kind kind;
	long at;
	bool onwards;
	int owner;
	int error; /* 0: one that fits */
	const char *report;
	uintptr_t program_begin, program_end;
	atomic_long calls;
	atomic_long calls_of[SHRINK][2]; /* of all: by kind, the libraries' and the program's */
} fault;

void *__libc_malloc(size_t size);
void *__libc_calloc(size_t count, size_t size);
void *__libc_realloc(void *memory, size_t size);
void *__libc_memalign(size_t alignment, size_t size);

#define CALLER ((uintptr_t)__builtin_return_address(0))
#define EXPORT __attribute__((visibility("default")))

/* The next definition of a function; found once, as dlsym allocates. */
#define NEXT(function)                                                                             \
	static __typeof__(function) *next;                                                             \
	if (!next)                                                                                     \
	next = (__typeof__(function) *)dlsym(RTLD_NEXT, #function)

/* ---------------------------------------------------------------------------- what is asked for */

static int find_program(struct dl_phdr_info *info, size_t size, void *unused)
{
	(void)size;
	(void)unused;
	for (int i = 0; i < info->dlpi_phnum; i++) {
		const ElfW(Phdr) *part = &info->dlpi_phdr[i];
		if (part->p_type != PT_LOAD || !(part->p_flags & PF_X))
			continue;
		fault.program_begin = info->dlpi_addr + part->p_vaddr;
		fault.program_end = fault.program_begin + part->p_memsz;
	}
	return 1; /* the program comes first */
}

static long number_of(const char *variable)
{
	const char *text = getenv(variable);
	return text ? atol(text) : 0;
}

static void __attribute__((constructor)) read_wishes(void)
{
	const char *kind = getenv("FAULT_KIND"), *owner = getenv("FAULT_OWNER");
	for (int k = ALLOC; kind && k <= ALL; k++)
		if (strcmp(kind, kind_name[k]) == 0)
			fault.kind = (fault_kind)k;
	fault.at = number_of("FAULT_AT");
	fault.onwards = number_of("FAULT_ONWARDS") != 0;
	fault.error = (int)number_of("FAULT_ERROR");
	fault.report = getenv("FAULT_REPORT");
	if (owner && strcmp(owner, "program") == 0)
		fault.owner = PROGRAM_OWNER;
	else if (owner && strcmp(owner, "library") == 0)
		fault.owner = LIBRARY_OWNER;
	dl_iterate_phdr(find_program, NULL);
}

/* Appends to the report without a library call that might be the one that fails. */
static void report(const char *line, size_t length)
{
	if (!fault.report)
		return;
	long file = syscall(SYS_openat, AT_FDCWD, fault.report, O_WRONLY | O_CREAT | O_APPEND, 0666);
	if (file >= 0) {
		syscall(SYS_write, file, line, length);
		syscall(SYS_close, file);
	}
}

static void __attribute__((destructor)) report_calls(void)
{
	char line[64];
	int length = snprintf(line, sizeof line, "calls %ld\n", atomic_load(&fault.calls));
	if (fault.kind != NO_FAULT && fault.kind != ALL)
		report(line, (size_t)length);
	for (int k = ALLOC; k < SHRINK && fault.kind == ALL; k++)
		for (int own = 0; own < 2; own++) {
			length = snprintf(line, sizeof line, "calls %ld %s %s\n",
							  atomic_load(&fault.calls_of[k][own]), kind_name[k],
							  own ? "program" : "library");
			report(line, (size_t)length);
		}
}

/* A regular file that is open for writing, and not still empty when it is closed. */
static bool is_output(int descriptor)
{
	struct stat info;
	return descriptor >= 0 && fstatat(descriptor, "", &info, AT_EMPTY_PATH) == 0 &&
		   S_ISREG(info.st_mode) && (fault.kind == WRITE || info.st_size > 0) &&
		   (fcntl(descriptor, F_GETFL) & O_ACCMODE) != O_RDONLY;
}

static void report_hit(const char *function, uintptr_t caller, int descriptor)
{
	char line[512];
	Dl_info info;
	bool found = dladdr((void *)caller, &info) != 0;
	const char *file = found ? info.dli_fname : "nobody", *slash = strrchr(file, '/');
	int length = snprintf(line, sizeof line, "hit %s %s %s\n", function, slash ? slash + 1 : file,
						  is_output(descriptor) ? "output" : "-");
	if (length > 0)
		report(line, (size_t)length < sizeof line ? (size_t)length : sizeof line - 1);
}

/* Counts a call; true when it is one that has to fail. */
static bool counts(fault_kind kind, uintptr_t caller, const char *function, int descriptor)
{
	if ((kind != fault.kind && fault.kind != ALL) || !atomic_load(&fault.counting))
		return false;
	bool own = caller >= fault.program_begin && caller < fault.program_end;
	if (fault.kind == ALL) {
		atomic_fetch_add(&fault.calls_of[kind][own], 1);
		return false;
	}
	if (fault.owner != ANY_OWNER && own != (fault.owner == PROGRAM_OWNER))
		return false;
	long call = atomic_fetch_add(&fault.calls, 1) + 1;
	if (fault.at == 0 || call < fault.at || (call > fault.at && !fault.onwards))
		return false;
	int saved = errno;
	if (call == fault.at)
		report_hit(function, caller, descriptor);
	errno = saved;
	return true;
}

static bool fails_on(fault_kind kind, uintptr_t caller, const char *function, int descriptor,
					 int reason)
{
	if (!counts(kind, caller, function, descriptor))
		return false;
	errno = fault.error ? fault.error : reason;
	return true;
}

static bool fails(fault_kind kind, uintptr_t caller, const char *function, int reason)
{
	return fails_on(kind, caller, function, -1, reason);
}

/* ------------------------------------------------------------------------------------- main */

typedef int main_function(int, char **, char **);
static main_function *real_main;

static int counted_main(int argc, char **argv, char **environment)
{
	atomic_store(&fault.counting, true);
	return real_main(argc, argv, environment);
}

EXPORT int __libc_start_main(main_function *program, int argc, char **argv, void (*init)(void),
							 void (*fini)(void), void (*end)(void), void *stack)
{
	typedef int start(main_function *, int, char **, void (*)(void), void (*)(void), void (*)(void),
					  void *);
	start *next = (start *)dlsym(RTLD_NEXT, "__libc_start_main");
	real_main = program;
	return next(counted_main, argc, argv, init, fini, end, stack);
}

/* ----------------------------------------------------------------------------------- memory */

EXPORT void *malloc(size_t size)
{
	return fails(ALLOC, CALLER, "malloc", ENOMEM) ? NULL : __libc_malloc(size);
}

EXPORT void *calloc(size_t count, size_t size)
{
	return fails(ALLOC, CALLER, "calloc", ENOMEM) ? NULL : __libc_calloc(count, size);
}

EXPORT void *realloc(void *memory, size_t size)
{
	return fails(ALLOC, CALLER, "realloc", ENOMEM) ? NULL : __libc_realloc(memory, size);
}

EXPORT void *reallocarray(void *memory, size_t count, size_t size)
{
	size_t bytes;
	if (fails(ALLOC, CALLER, "reallocarray", ENOMEM))
		return NULL;
	if (__builtin_mul_overflow(count, size, &bytes)) {
		errno = ENOMEM;
		return NULL;
	}
	return __libc_realloc(memory, bytes);
}

EXPORT void *aligned_alloc(size_t alignment, size_t size)
{
	bool failing = fails(ALLOC, CALLER, "aligned_alloc", ENOMEM);
	return failing ? NULL : __libc_memalign(alignment, size);
}

EXPORT void *memalign(size_t alignment, size_t size)
{
	bool failing = fails(ALLOC, CALLER, "memalign", ENOMEM);
	return failing ? NULL : __libc_memalign(alignment, size);
}

EXPORT int posix_memalign(void **memory, size_t alignment, size_t size)
{
	if (fails(ALLOC, CALLER, "posix_memalign", ENOMEM))
		return ENOMEM;
	void *made = __libc_memalign(alignment, size);
	if (!made)
		return ENOMEM;
	*memory = made;
	return 0;
}

/* ------------------------------------------------------------------------------------ files */

/* Halves a regular file that is open for reading; what is mapped of it is then partly gone. */
static void maybe_shrink(int descriptor, uintptr_t caller, const char *function)
{
	struct stat info;
	char path[64];
	if (fault.kind != SHRINK || fstatat(descriptor, "", &info, AT_EMPTY_PATH) != 0 ||
		!S_ISREG(info.st_mode) || (fcntl(descriptor, F_GETFL) & O_ACCMODE) != O_RDONLY ||
		!counts(SHRINK, caller, function, -1))
		return;
	int saved = errno;
	snprintf(path, sizeof path, "/proc/self/fd/%d", descriptor);
	if (truncate(path, info.st_size / 2) != 0)
		report("not shrunk\n", 11);
	errno = saved;
}

EXPORT void *mmap(void *at, size_t length, int protection, int flags, int descriptor, off_t offset)
{
	if (fails(MMAP, CALLER, "mmap", ENOMEM))
		return MAP_FAILED;
	void *memory = (void *)syscall(SYS_mmap, at, length, protection, flags, descriptor, offset);
	if (!(flags & MAP_ANONYMOUS))
		maybe_shrink(descriptor, CALLER, "mmap");
	return memory;
}

EXPORT void *mmap64(void *at, size_t length, int protection, int flags, int descriptor,
					off_t offset)
{
	if (fails(MMAP, CALLER, "mmap64", ENOMEM))
		return MAP_FAILED;
	return (void *)syscall(SYS_mmap, at, length, protection, flags, descriptor, offset);
}

EXPORT ssize_t read(int descriptor, void *bytes, size_t length)
{
	NEXT(read);
	if (fails(READ, CALLER, "read", EIO))
		return -1;
	ssize_t got = next(descriptor, bytes, length);
	maybe_shrink(descriptor, CALLER, "read");
	return got;
}

EXPORT ssize_t pread(int descriptor, void *bytes, size_t length, off_t offset)
{
	NEXT(pread);
	if (fails(READ, CALLER, "pread", EIO))
		return -1;
	ssize_t got = next(descriptor, bytes, length, offset);
	maybe_shrink(descriptor, CALLER, "pread");
	return got;
}

EXPORT int fstat(int descriptor, struct stat *info)
{
	NEXT(fstat);
	int status = next(descriptor, info);
	maybe_shrink(descriptor, CALLER, "fstat");
	return status;
}

EXPORT ssize_t write(int descriptor, const void *bytes, size_t length)
{
	NEXT(write);
	/* Messages have to be seen, and pipes between threads of a driver are no files. */
	if (descriptor != STDERR_FILENO && fails_on(WRITE, CALLER, "write", descriptor, ENOSPC))
		return -1;
	return next(descriptor, bytes, length);
}

EXPORT int close(int descriptor)
{
	NEXT(close);
	bool failing = fails_on(CLOSE, CALLER, "close", descriptor, EIO);
	int saved = errno, status = next(descriptor);
	errno = failing ? saved : errno;
	return failing ? -1 : status;
}

EXPORT int fsync(int descriptor)
{
	NEXT(fsync);
	struct stat info;
	bool folder = fstatat(descriptor, "", &info, AT_EMPTY_PATH) == 0 && S_ISDIR(info.st_mode);
	bool failing = fails_on(folder ? FOLDER : FSYNC, CALLER, "fsync", descriptor, EIO);
	return failing ? -1 : next(descriptor);
}

EXPORT int rename(const char *from, const char *to)
{
	NEXT(rename);
	return fails(RENAME, CALLER, "rename", EIO) ? -1 : next(from, to);
}

EXPORT int renameat2(int from_folder, const char *from, int to_folder, const char *to,
					 unsigned int flags)
{
	NEXT(renameat2);
	bool failing = fails(RENAME, CALLER, "renameat2", EIO);
	return failing ? -1 : next(from_folder, from, to_folder, to, flags);
}

#define OPEN_FUNCTION(name)                                                                        \
	EXPORT int name(const char *path, int flags, ...)                                              \
	{                                                                                              \
		va_list list;                                                                              \
		va_start(list, flags);                                                                     \
		mode_t mode = (flags & (O_CREAT | O_TMPFILE)) ? va_arg(list, mode_t) : 0;                  \
		va_end(list);                                                                              \
		if (fails(OPEN, CALLER, #name, EMFILE))                                                    \
			return -1;                                                                             \
		return (int)syscall(SYS_openat, AT_FDCWD, path, flags, mode);                              \
	}

OPEN_FUNCTION(open)
OPEN_FUNCTION(open64)

EXPORT FILE *fopen(const char *path, const char *mode)
{
	NEXT(fopen);
	return fails(OPEN, CALLER, "fopen", EMFILE) ? NULL : next(path, mode);
}

EXPORT FILE *fopen64(const char *path, const char *mode)
{
	NEXT(fopen64);
	return fails(OPEN, CALLER, "fopen64", EMFILE) ? NULL : next(path, mode);
}

EXPORT int pthread_create(pthread_t *thread, const pthread_attr_t *attributes,
						  void *(*begin)(void *), void *argument)
{
	NEXT(pthread_create);
	bool failing = fails(THREAD, CALLER, "pthread_create", EAGAIN);
	return failing ? EAGAIN : next(thread, attributes, begin, argument);
}

/* ----------------------------------------------------------------------------------- Vulkan */

/* The loader's functions that can fail, as the program calls them. */
#define VULKAN_FUNCTION(name, parameters, arguments)                                               \
	EXPORT VkResult name parameters                                                                \
	{                                                                                              \
		NEXT(name);                                                                                \
		if (counts(VULKAN, CALLER, #name, -1))                                                     \
			return fault.error ? fault.error : VK_ERROR_OUT_OF_HOST_MEMORY;                        \
		return next arguments;                                                                     \
	}

#define CREATE_FUNCTION(object)                                                                    \
	VULKAN_FUNCTION(vkCreate##object,                                                              \
					(VkDevice device, const Vk##object##CreateInfo *info,                          \
					 const VkAllocationCallbacks *allocator, Vk##object *made),                    \
					(device, info, allocator, made))

CREATE_FUNCTION(Buffer)
CREATE_FUNCTION(BufferView)
CREATE_FUNCTION(CommandPool)
CREATE_FUNCTION(DescriptorPool)
CREATE_FUNCTION(DescriptorSetLayout)
CREATE_FUNCTION(Fence)
CREATE_FUNCTION(Image)
CREATE_FUNCTION(ImageView)
CREATE_FUNCTION(PipelineLayout)
CREATE_FUNCTION(QueryPool)
CREATE_FUNCTION(Sampler)
CREATE_FUNCTION(ShaderModule)
VULKAN_FUNCTION(vkCreateComputePipelines,
				(VkDevice device, VkPipelineCache cache, uint32_t count,
				 const VkComputePipelineCreateInfo *info, const VkAllocationCallbacks *allocator,
				 VkPipeline *made),
				(device, cache, count, info, allocator, made))
VULKAN_FUNCTION(vkCreateInstance,
				(const VkInstanceCreateInfo *info, const VkAllocationCallbacks *allocator,
				 VkInstance *made),
				(info, allocator, made))
VULKAN_FUNCTION(vkCreateDevice,
				(VkPhysicalDevice device, const VkDeviceCreateInfo *info,
				 const VkAllocationCallbacks *allocator, VkDevice *made),
				(device, info, allocator, made))
VULKAN_FUNCTION(vkEnumeratePhysicalDevices,
				(VkInstance instance, uint32_t *count, VkPhysicalDevice *devices),
				(instance, count, devices))
VULKAN_FUNCTION(vkEnumerateDeviceExtensionProperties,
				(VkPhysicalDevice device, const char *layer, uint32_t *count,
				 VkExtensionProperties *properties),
				(device, layer, count, properties))
VULKAN_FUNCTION(vkEnumerateInstanceExtensionProperties,
				(const char *layer, uint32_t *count, VkExtensionProperties *properties),
				(layer, count, properties))
VULKAN_FUNCTION(vkEnumerateInstanceLayerProperties,
				(uint32_t * count, VkLayerProperties *properties), (count, properties))
VULKAN_FUNCTION(vkAllocateCommandBuffers,
				(VkDevice device, const VkCommandBufferAllocateInfo *info, VkCommandBuffer *made),
				(device, info, made))
VULKAN_FUNCTION(vkAllocateDescriptorSets,
				(VkDevice device, const VkDescriptorSetAllocateInfo *info, VkDescriptorSet *made),
				(device, info, made))
VULKAN_FUNCTION(vkAllocateMemory,
				(VkDevice device, const VkMemoryAllocateInfo *info,
				 const VkAllocationCallbacks *allocator, VkDeviceMemory *made),
				(device, info, allocator, made))
VULKAN_FUNCTION(vkBindBufferMemory,
				(VkDevice device, VkBuffer buffer, VkDeviceMemory memory, VkDeviceSize offset),
				(device, buffer, memory, offset))
VULKAN_FUNCTION(vkBindImageMemory,
				(VkDevice device, VkImage image, VkDeviceMemory memory, VkDeviceSize offset),
				(device, image, memory, offset))
VULKAN_FUNCTION(vkMapMemory,
				(VkDevice device, VkDeviceMemory memory, VkDeviceSize offset, VkDeviceSize size,
				 VkMemoryMapFlags flags, void **bytes),
				(device, memory, offset, size, flags, bytes))
VULKAN_FUNCTION(vkBeginCommandBuffer,
				(VkCommandBuffer commands, const VkCommandBufferBeginInfo *info), (commands, info))
VULKAN_FUNCTION(vkEndCommandBuffer, (VkCommandBuffer commands), (commands))
VULKAN_FUNCTION(vkResetCommandPool,
				(VkDevice device, VkCommandPool pool, VkCommandPoolResetFlags flags),
				(device, pool, flags))
VULKAN_FUNCTION(vkResetFences, (VkDevice device, uint32_t count, const VkFence *fences),
				(device, count, fences))
/* The work ends in any case: what a lost device was doing is over, and a driver of the host must
 * not go on with what the program takes down. */
EXPORT VkResult vkWaitForFences(VkDevice device, uint32_t count, const VkFence *fences,
								VkBool32 all, uint64_t nanoseconds)
{
	NEXT(vkWaitForFences);
	VkResult result = next(device, count, fences, all, nanoseconds);
	if (counts(VULKAN, CALLER, "vkWaitForFences", -1))
		return fault.error ? fault.error : VK_ERROR_OUT_OF_HOST_MEMORY;
	return result;
}

VULKAN_FUNCTION(vkQueueSubmit,
				(VkQueue queue, uint32_t count, const VkSubmitInfo *info, VkFence fence),
				(queue, count, info, fence))
VULKAN_FUNCTION(vkGetQueryPoolResults,
				(VkDevice device, VkQueryPool pool, uint32_t first, uint32_t count, size_t size,
				 void *bytes, VkDeviceSize stride, VkQueryResultFlags flags),
				(device, pool, first, count, size, bytes, stride, flags))
