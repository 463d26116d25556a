/*
 * motion_path.h - where inputs and lamps are in each frame: keyframes, and what lies between them.
 */
#ifndef MOTION_PATH_H
#define MOTION_PATH_H

#include "lamps/light_text.h"

/* What keyframes of an input hold; those of a lamp hold its keys, light_key_id. */
typedef enum motion_value {
	MOTION_MOVE,   /* metres, from where the input's matrix puts it */
	MOTION_ROTATE, /* degrees about x, then y, then z */
	MOTION_SCALE,  /* 1: as it is */
	MOTION_VALUES
} motion_value;

typedef struct motion_key {
	uint32_t frame;
	unsigned given;                   /* 1 << light_key_id, or motion_value */
	double value[LIGHT_KEY_COUNT][3]; /* by the same */
} motion_key;

/* The way of one input or lamp: keyframes in ascending order, or a matrix a frame. */
typedef struct motion_path {
	motion_key *key; /* owned; key_count */
	size_t key_count;
	double *matrix; /* owned; 16 * matrix_count; of an input */
	size_t matrix_count;
	bool smooth; /* cubic between keyframes, else linear */
	bool has_pivot;
	double pivot[3]; /* about which an input turns and grows; else where its own origin is put */
} motion_path;

void motion_path_clear(motion_path *path);

/*
 * From where an input is read to where it is in a frame, row-major.
 *   matrix   16, of the input; with a matrix a frame, the first of these
 */
void motion_path_matrix(const motion_path *path, const double *matrix, uint32_t frame,
						double result[16]);

/* The lamp as it is in a frame; numbers that must not be negative stay at 0 or above. */
gw_status motion_path_lamp(const motion_path *path, uint32_t frame, lamp *light, gw_error *error);

#endif
