/*
 * file_roles.h - which files a run reads and which it writes. No output is an input, whatever that
 * is read for, and no two outputs are one file: by device and inode, so through links and symbolic
 * links too, and by folder and name where nothing is there yet.
 */
#ifndef FILE_ROLES_H
#define FILE_ROLES_H

#include "options/settings.h"

/* Outputs whose names come from settings->output: frames, or several pictures. */
typedef struct file_series {
	size_t count;
	char *(*name)(const void *user, size_t index); /* for free(); NULL: no memory */
	const void *user;
} file_series;

/*
 * Fails when an output is an input or another output. Before any work, for every verb, with and
 * without --force: everything that is written takes the place of what was there.
 *   settings  with the scene file read into them
 *   series    NULL: settings->output is the name of a file
 *   error     GW_ERROR_USAGE; that of reading the scene of --mesh, or an OBJ file for the names of
 *             its materials
 */
gw_status file_roles_check(verb verb, const settings *settings, const file_series *series,
						   gw_error *error);

#endif
