/*
 * progress.h - how far a bake is, on standard error: a line that is rewritten on a terminal, or one
 * JSON object a line.
 */
#ifndef PROGRESS_H
#define PROGRESS_H

#include "options/settings.h"

typedef struct progress {
	settings_progress kind; /* NONE or JSON; AUTO stands for a terminal */
	double start;           /* seconds, gw_bake_callbacks' clock */
	bool shown;             /* a line stands on the terminal */
	size_t width;           /* of it */
} progress;

/* Starts the clock. AUTO becomes NONE when standard error is no terminal or quiet is set. */
progress progress_start(settings_progress kind, bool quiet);

/* Says that `stage` runs and what share of everything is done, 0..1. */
void progress_show(progress *progress, const char *stage, double done);

/* Takes the line off the terminal, so that other messages can be written. */
void progress_clear(progress *progress);

/* Ends: nothing more is shown. */
void progress_end(progress *progress);

#endif
