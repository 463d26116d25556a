/*
 * keep_loaded.c - linked into test programs and all sanitized ones, so that libraries stay loaded
 * to the end.
 *
 * Vulkan's loader closes drivers and layers when their instance goes. What such a library never
 * freed is then reported without its name, and leaks_of_others.txt cannot tell it from ours. And
 * tests that bake many times would load them as often, which is mostly to relocate addresses.
 */
#include <dlfcn.h>

int dlclose(void *library)
{
	(void)library;
	return 0;
}
