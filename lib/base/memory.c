/*
 * memory.c - host memory for arrays, and how much of it there is.
 */
#include "base/memory.h"

#include <inttypes.h>
#include <malloc.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#define HUGE_PAGE ((uintptr_t)2 << 20) /* bytes, of x86-64 and of most others */
#define HUGE_LEAST ((size_t)128 << 10) /* bytes; for less it is not worth a call of the system */

/* Memory below the break is malloc's own heap: there the pages around an array are advised whole,
 * up to the break, as the next array will lie beside it. Elsewhere only pages that the array fills.
 */
void gw_wish_huge_pages(void *memory, size_t bytes)
{
	if (memory == NULL || bytes < HUGE_LEAST)
		return;
	uintptr_t from = (uintptr_t)memory, to = from + bytes, top = (uintptr_t)sbrk(0);
	if (to <= top) {
		from = from / HUGE_PAGE * HUGE_PAGE;
		to = top;
	} else {
		from = (from + HUGE_PAGE - 1) / HUGE_PAGE * HUGE_PAGE;
		to = to / HUGE_PAGE * HUGE_PAGE;
	}
	if (to > from)
		(void)madvise((void *)from, to - from, MADV_HUGEPAGE);
}

static void *wish(void *memory, size_t bytes)
{
	gw_wish_huge_pages(memory, bytes);
	return memory;
}

void *gw_allocate_array(size_t count, size_t size)
{
	size_t bytes;
	if (__builtin_mul_overflow(count, size, &bytes) || bytes > PTRDIFF_MAX)
		return NULL;
	return wish(malloc(bytes > 0 ? bytes : 1), bytes);
}

void *gw_allocate_zeros(size_t count, size_t size)
{
	size_t bytes;
	if (__builtin_mul_overflow(count, size, &bytes) || bytes > PTRDIFF_MAX)
		return NULL;
	return wish(calloc(bytes > 0 ? bytes : 1, 1), bytes);
}

void *gw_resize_array(void *array, size_t count, size_t size)
{
	size_t bytes;
	if (__builtin_mul_overflow(count, size, &bytes) || bytes > PTRDIFF_MAX)
		return NULL;
	return wish(realloc(array, bytes > 0 ? bytes : 1), bytes);
}

void gw_free_unless_lent(void *array, const void *lent, size_t bytes)
{
	uintptr_t at = (uintptr_t)array, from = (uintptr_t)lent;
	if (lent == NULL || at < from || at - from >= bytes)
		free(array);
}

/* Reads one number from a file such as the kernel writes; false for "max" or when it isn't there.
 */
static bool read_number(const char *path, uint64_t *value)
{
	FILE *file = fopen(path, "re");
	if (file == NULL)
		return false;
	bool good = fscanf(file, "%" SCNu64, value) == 1;
	fclose(file);
	return good;
}

static uint64_t memory_of_the_system(void)
{
	FILE *file = fopen("/proc/meminfo", "re");
	if (file == NULL)
		return 0;
	char line[256];
	uint64_t kibibytes = 0;
	while (fgets(line, sizeof line, file) != NULL)
		if (sscanf(line, "MemAvailable: %" SCNu64, &kibibytes) == 1)
			break;
	fclose(file);
	return kibibytes * 1024;
}

/* What one control group leaves; UINT64_MAX when it sets no limit. */
static uint64_t memory_of_group(const char *folder, const char *limit_name, const char *used_name)
{
	char path[512];
	uint64_t limit, used = 0;
	snprintf(path, sizeof path, "%s/%s", folder, limit_name);
	if (!read_number(path, &limit))
		return UINT64_MAX;
	snprintf(path, sizeof path, "%s/%s", folder, used_name);
	if (!read_number(path, &used) || used > limit)
		return limit;
	return limit - used;
}

/* The tightest limit from the process's control group (version 2) up to the root. */
static uint64_t memory_of_groups(void)
{
	uint64_t least = memory_of_group("/sys/fs/cgroup", "memory.max", "memory.current");
	uint64_t old =
		memory_of_group("/sys/fs/cgroup/memory", "memory.limit_in_bytes", "memory.usage_in_bytes");
	least = old < least ? old : least;

	FILE *file = fopen("/proc/self/cgroup", "re");
	if (file == NULL)
		return least;
	char line[256], folder[320];
	while (fgets(line, sizeof line, file) != NULL) {
		if (strncmp(line, "0::", 3) != 0)
			continue;
		line[strcspn(line, "\n")] = '\0';
		snprintf(folder, sizeof folder, "/sys/fs/cgroup%s", line + 3);
		while (strlen(folder) > strlen("/sys/fs/cgroup")) {
			uint64_t group = memory_of_group(folder, "memory.max", "memory.current");
			least = group < least ? group : least;
			*strrchr(folder, '/') = '\0';
		}
	}
	fclose(file);
	return least;
}

/* What the limit of the address space (ulimit -v) leaves; UINT64_MAX when there is none. */
static uint64_t memory_of_addresses(void)
{
	struct rlimit limit;
	uint64_t pages = 0, used;
	if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY)
		return UINT64_MAX;
	read_number("/proc/self/statm", &pages);
	used = pages * (uint64_t)sysconf(_SC_PAGESIZE);
	return used < limit.rlim_cur ? limit.rlim_cur - used : 1; /* 0 would be unknown */
}

void gw_give_back_memory(void)
{
#ifdef __GLIBC__
	malloc_trim(0);
#endif
}

uint64_t gw_resident_memory(void)
{
	uint64_t pages = 0;
	FILE *file = fopen("/proc/self/statm", "re");
	if (file == NULL)
		return 0;
	bool good = fscanf(file, "%*u %" SCNu64, &pages) == 1;
	fclose(file);
	return good ? pages * (uint64_t)sysconf(_SC_PAGESIZE) : 0;
}

uint64_t gw_available_memory(void)
{
	uint64_t system = memory_of_the_system(), least = memory_of_groups();
	uint64_t addresses = memory_of_addresses();
	least = addresses < least ? addresses : least;
	if (system == 0)
		return least == UINT64_MAX ? 0 : least;
	return least < system ? least : system;
}
