/*
 * sample_points.h - what the generators of sample scenes share: a growing list of points, random
 * numbers that are the same everywhere, and writing the list as PLY or .cloud.
 *
 * These programs stand alone: they use nothing of glowworm, so that their files test its readers.
 */
#ifndef SAMPLE_POINTS_H
#define SAMPLE_POINTS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/* Exit codes, the same as glowworm's. */
enum {
	SAMPLE_EXIT_USAGE = 2,
	SAMPLE_EXIT_MEMORY = 71,
	SAMPLE_EXIT_CREATE = 73,
	SAMPLE_EXIT_IO = 74
};

typedef struct sample_point {
	float position[3]; /* metres, z up */
	float normal[3];   /* unit length, into the air */
	float albedo[3];   /* linear RGB, 0..1 */
	float emission[3]; /* radiance, W/(sr m^2) */
} sample_point;

typedef struct sample_list {
	sample_point *point; /* owned */
	size_t count;
	size_t capacity;
} sample_list;

/* Appends a point. Ends the program with a message when memory is short. */
void sample_add(sample_list *list, const sample_point *point);

/* Thins the list to `count` points, each kept with the same chance, in order.
 *   count  at most list->count */
void sample_thin(sample_list *list, size_t count, uint64_t *random);

/* Frees the points and empties the list. */
void sample_clear(sample_list *list);

/* Next number in [0, 1) of the sequence that *random stands for (SplitMix64); any start is good. */
double sample_random(uint64_t *random);

/* Next number of the standard normal distribution. */
double sample_gaussian(uint64_t *random);

/* sRGB code 0..255 of a linear value 0..1. */
uint8_t sample_srgb(float linear);

typedef enum sample_format { SAMPLE_PLY, SAMPLE_CLOUD } sample_format;

/*
 * Writes the list and returns 0, or an exit code after a message on standard error. A file that
 * could not be written whole is removed.
 *   path     "-" is standard output
 *   format   SAMPLE_PLY: binary little-endian, z up, float x y z nx ny nz, uchar red green blue
 *            (sRGB-encoded albedo), float emission_r emission_g emission_b.
 *            SAMPLE_CLOUD: count and 27 bytes a point, y up; it has no emission.
 *   comment  one line for the PLY header
 */
int sample_write(const sample_list *list, const char *path, sample_format format,
				 const char *comment);

/* Open a file to be written, and end that; both return 0, or an exit code after a message on
 * standard error. A file that could not be written whole is removed. path  "-" is standard output
 *   text  binary data do not go to a terminal, text does */
int sample_open(const char *path, bool text, FILE **file);
int sample_close(FILE *file, const char *path);

/* Parse an argument; end the program with exit code 2 and a message when it makes no sense. */
size_t sample_parse_count(const char *option, const char *text, size_t maximum);
uint64_t sample_parse_seed(const char *option, const char *text);
double sample_parse_number(const char *option, const char *text, double minimum, double maximum);

/* One number, or three with commas between them. */
void sample_parse_color(const char *option, const char *text, double maximum, float color[3]);

#endif
