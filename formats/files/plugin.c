/* plugin.c - shared objects that are opened when they are needed; see plugin.h. */
#include "files/plugin.h"

#include <dlfcn.h>
#include <string.h>

gw_status plugin_find(const char *file, const char *symbol, const char *purpose,
					  const void **address, gw_error *error)
{
	void *library = dlopen(file, RTLD_NOW | RTLD_LOCAL);
	*address = library ? dlsym(library, symbol) : NULL;
	if (*address)
		return GW_OK;
	const char *reason = dlerror();
	/* The loader has only words for it. */
	if (reason && (strstr(reason, "cannot allocate") || strstr(reason, "failed to map") ||
				   strstr(reason, "Cannot allocate")))
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to load %s: %s", file, reason);
	return gw_fail(error, GW_ERROR_INTERNAL,
				   "%s %s, which is installed beside glowworm or in its library folder: %s",
				   purpose, file, reason ? reason : "it is empty");
}
