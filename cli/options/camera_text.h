/*
 * camera_text.h - cameras from text: "at 1,2,1.5 to 4,2,1 fov 60", or what chooses one.
 */
#ifndef CAMERA_TEXT_H
#define CAMERA_TEXT_H

#include "glowworm_picture.h"

/* What a text says. */
typedef struct camera_text {
	bool placed;            /* at and to are given */
	gw_viewpoint_kind kind; /* when not placed */
	double at[3], to[3];    /* in the input's coordinates */
	double angle;           /* degrees, vertical; 0: the default */
} camera_text;

/* How a coordinate of a camera is printed. */
#define CAMERA_TEXT_NUMBER "%.10g"

/* Vertical angle of view of a camera that does not say its own, degrees. */
#define CAMERA_TEXT_ANGLE 50.0

/*
 * Reads a text: auto, inside or outside; or `at X,Y,Z to X,Y,Z`; behind either `fov DEGREES`.
 *   option   for messages: "--camera"
 * GW_ERROR_USAGE with the place in the text.
 */
gw_status camera_text_read(const char *option, const char *text, camera_text *camera,
						   gw_error *error);

/*
 * Reads a file of cameras, one a line; empty lines and those that begin with # do not count.
 *   cameras   on success owned by the caller, freed with free(); count is at least 1
 * GW_ERROR_DATA with file and line; or as input_file_open.
 */
gw_status camera_text_read_file(const char *path, camera_text **cameras, size_t *count,
								gw_error *error);

#endif
