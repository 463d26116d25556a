/*
 * stream_roles.h - standard input and standard output in a run: what comes from a pipe can be read
 * once, standard output can be written once, and no terminal is sent binary data. Before any work.
 */
#ifndef STREAM_ROLES_H
#define STREAM_ROLES_H

#include "options/settings.h"

/* An output that can be standard output. */
typedef struct stream_output {
	const char *option; /* that names it, as "--vdb" */
	const char *path;   /* NULL: not asked for */
	const char *binary; /* "this is", or "points are": binary data; NULL: a text */
} stream_output;

/* True for "-"; path may be NULL. */
bool stream_roles_standard(const char *path);

/* True for "-", and for what is there and is no ordinary file, as a device or a pipe: its name says
 * nothing of what is written. */
bool stream_roles_nameless(const char *path);

/* How many of the files that are read are standard input: "-", and the pipe that it is by another
 * name, as /dev/stdin. */
int stream_roles_inputs(const settings *settings);

/* Fails with GW_ERROR_USAGE when standard input would be read more than once. */
gw_status stream_roles_check_inputs(const settings *settings, gw_error *error);

/*
 * Fails with GW_ERROR_USAGE when several outputs are standard output, or when it is a terminal and
 * the output binary.
 *   output  [count] those that the verb has, at least one; the first is what a file is named with
 */
gw_status stream_roles_check_outputs(const stream_output *output, size_t count, gw_error *error);

#endif
