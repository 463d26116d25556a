/*
 * plugin.h - shared objects of ours that are opened when they are needed, because what they are
 * linked to takes long to load. The linker's run path names the folders where they may lie.
 */
#ifndef PLUGIN_H
#define PLUGIN_H

#include "glowworm.h"

/*
 * Opens a shared object, which then stays, and finds a symbol in it; safe to call from any thread,
 * and again.
 *   purpose   what needs it, for the message: "OpenVDB grids need"
 *   address   on success becomes where the symbol is
 * GW_ERROR_INTERNAL when it is not there; GW_ERROR_MEMORY.
 */
gw_status plugin_find(const char *file, const char *symbol, const char *purpose,
					  const void **address, gw_error *error);

#endif
