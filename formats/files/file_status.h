/*
 * file_status.h - what can go wrong with files, beside what the library knows of.
 *
 * These are of type gw_status, so that one variable and one gw_error serve a whole program.
 */
#ifndef FILE_STATUS_H
#define FILE_STATUS_H

#include "glowworm.h"

/* Cannot be opened for reading; cannot be created. */
#define FILE_ERROR_NO_INPUT ((gw_status)(GW_STATUS_OF_CALLER + 0))
#define FILE_ERROR_CREATE ((gw_status)(GW_STATUS_OF_CALLER + 1))
/* Reading or writing failed half way: full disk, closed pipe. */
#define FILE_ERROR_IO ((gw_status)(GW_STATUS_OF_CALLER + 2))

/* Those who use formats/ have theirs from here on. */
#define FILE_STATUS_NEXT (GW_STATUS_OF_CALLER + 3)

#endif
