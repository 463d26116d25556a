/*
 * seed_files.h - small good files, one for each way in which a reader can go, to be damaged by
 * tests and to begin fuzzing with.
 */
#ifndef SEED_FILES_H
#define SEED_FILES_H

#include "files/input_file.h"
#include "points/scan.h"

typedef gw_status (*seed_reader)(input_file *, scan *, gw_error *);

/* A good file that is then damaged. */
typedef struct seed {
	const char *name;
	const char *format; /* what reads it, as fuzz_reader.h calls it */
	seed_reader read;
	uint8_t data[4096];
	size_t length;
	size_t header; /* bytes of text with counts in it; 0: a binary count at the start */
	size_t points;
	size_t xml;    /* of E57, which is put into pages and sealed after it is damaged */
	bool open_end; /* nothing in the file says how much there is: cut short it may still be whole */
} seed;

enum { SEEDS = 20, SEED_CLOUD = 4 };

/* Makes them all. */
void seed_files_make(seed seeds[SEEDS]);

/* Appends a number of `size` bytes in either order. */
void seed_put_number(seed *s, uint64_t number, size_t size, bool big);

/* Meshes, sampled if they can be; materials are put on a triangle. */
gw_status seed_read_obj(input_file *in, scan *cloud, gw_error *error);
gw_status seed_read_mesh_ply(input_file *in, scan *cloud, gw_error *error);
gw_status seed_read_off(input_file *in, scan *cloud, gw_error *error);
gw_status seed_read_glb(input_file *in, scan *cloud, gw_error *error);
gw_status seed_read_mtl(input_file *in, scan *cloud, gw_error *error);

#endif
