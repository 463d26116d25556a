#include "counted_memory.h"

#include <malloc.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

void *__real_malloc(size_t size);
void *__real_realloc(void *memory, size_t size);
void __real_free(void *memory);
void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *memory, size_t size);
void *__wrap_reallocarray(void *memory, size_t count, size_t size);
char *__wrap_strdup(const char *text);
char *__wrap_strndup(const char *text, size_t length);
void __wrap_free(void *memory);

counted_memory counted = { .fail_at = -1 };

void counted_memory_reset(void)
{
	counted = (counted_memory){ .fail_at = counted.fail_at };
}

long counted_memory_exhaust(gw_status (*call)(void *user, long failing), void *user)
{
	for (long failing = 0;; failing++) {
		counted.fail_at = failing;
		gw_status status = call(user, failing);
		counted.fail_at = -1;
		if (status == GW_OK)
			return failing;
		assert_int_equal(status, GW_ERROR_MEMORY);
	}
}

void *uncounted_malloc(size_t size)
{
	return __real_malloc(size);
}

void uncounted_free(void *memory)
{
	__real_free(memory);
}

static bool denied(size_t size)
{
	counted.largest = size > counted.largest ? size : counted.largest;
	return counted.calls++ == counted.fail_at;
}

static void *add(void *memory)
{
	counted.live += memory ? malloc_usable_size(memory) : 0;
	counted.peak = counted.live > counted.peak ? counted.live : counted.peak;
	return memory;
}

void *__wrap_malloc(size_t size)
{
	return denied(size) ? NULL : add(__real_malloc(size));
}

void *__wrap_calloc(size_t count, size_t size)
{
	size_t bytes;
	if (__builtin_mul_overflow(count, size, &bytes))
		bytes = SIZE_MAX;
	void *memory = bytes == SIZE_MAX ? NULL : __wrap_malloc(bytes);
	return memory ? memset(memory, 0, bytes) : NULL;
}

void *__wrap_realloc(void *memory, size_t size)
{
	if (denied(size))
		return NULL;
	size_t before = memory ? malloc_usable_size(memory) : 0;
	void *grown = __real_realloc(memory, size);
	counted.live -= grown ? before : 0;
	return add(grown);
}

void *__wrap_reallocarray(void *memory, size_t count, size_t size)
{
	size_t bytes;
	if (__builtin_mul_overflow(count, size, &bytes))
		bytes = SIZE_MAX / 2;
	return __wrap_realloc(memory, bytes);
}

char *__wrap_strndup(const char *text, size_t length)
{
	size_t size = strnlen(text, length);
	char *copy = __wrap_malloc(size + 1);
	if (copy) {
		memcpy(copy, text, size);
		copy[size] = '\0';
	}
	return copy;
}

char *__wrap_strdup(const char *text)
{
	return __wrap_strndup(text, strlen(text));
}

void __wrap_free(void *memory)
{
	counted.live -= memory ? malloc_usable_size(memory) : 0;
	__real_free(memory);
}
