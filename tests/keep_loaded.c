/*
 * keep_loaded.c - linked into the sanitized programs, so that libraries stay loaded to the end.
 *
 * Vulkan's loader closes drivers and layers when their instance goes. What such a library never
 * freed is then reported without its name, and leaks_of_others.txt cannot tell it from ours.
 */
#include <dlfcn.h>

int dlclose(void *library)
{
	(void)library;
	return 0;
}
