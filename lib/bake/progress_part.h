/*
 * progress_part.h - the callbacks of a bake, for a bake that is a part of it.
 */
#ifndef PROGRESS_PART_H
#define PROGRESS_PART_H

#include "glowworm.h"

typedef struct gw_progress_part {
	const gw_bake_callbacks *whole; /* NULL: nobody listens */
	double from, share;             /* of the progress of the whole */
	const char *name;               /* NULL: that of each stage */
	double told;                    /* at most, so far: less is not told when a part begins again */
} gw_progress_part;

/* The callbacks for that part; valid as long as it is. Only one that begins with the whole tells
 * what is planned. */
gw_bake_callbacks gw_progress_part_callbacks(gw_progress_part *part);

#endif
