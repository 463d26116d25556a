/*
 * page_points.h - the points of a page in bytes: as few as the eye needs.
 *
 * Points are packed in blocks of PAGE_BLOCK, each by itself, byte after byte of all its points
 * ("planes"), so that what hardly varies lies together and deflates to nothing:
 *
 *   12  x, y, z: steps from the point before in the block, the first from 0; 4 bytes each, lowest
 *       first, with the sign in the lowest bit (2d, or -2d - 1 below 0)
 *    2  normal: octahedral, 0 to 254 for -1 to 1
 *    1  radius of the disc: the largest times 2^((b - 255) / 12)
 *    1  flags: PAGE_TWO_SIDED, PAGE_GLOWS
 *    4  two cuts: the angle of its direction in the disc's plane, in 1/256 of a turn from the
 *       tangent of the normal as packed (Duff et al. 2017), and its distance from the middle, in
 *       1/127 of the radius from 127 at the middle on; 255: none
 *    3  albedo: the square roots of red, green, blue, in 1/255
 *    4  for each lamp: its radiance as RGB9E5 (OpenGL ES 3.0, 3.8.3.2), in units of its scale
 */
#ifndef PAGE_POINTS_H
#define PAGE_POINTS_H

#include "glowworm_picture.h"

#define PAGE_BLOCK 32768u /* points; a multiple of PAGE_ROW */
#define PAGE_ROW 2048u    /* points in a row of a texture: what every WebGL 2 has */
#define PAGE_PLANES 23    /* bytes a point, without lamps */
#define PAGE_LAMP_PLANES 4

/* Layers that an array of textures has at least (WebGL 2.0, MAX_ARRAY_TEXTURE_LAYERS). */
#define PAGE_LAMPS_MAX 256u

enum { PAGE_TWO_SIDED = 1, PAGE_GLOWS = 2 };

/* The finest grid that single precision holds, steps along a side. */
#define PAGE_STEPS 16777215.0

/* What is packed. */
typedef struct page_points {
	const gw_surfels *surfels;
	const uint8_t *glows;  /* surfels->count, or NULL: none */
	const uint32_t *order; /* count: the surfels that are packed */
	size_t count;
	double step;            /* metres, of the grid of places */
	double radius;          /* metres, of the largest disc */
	const uint32_t **light; /* lamps; of each, surfels->count as RGB9E5 */
	size_t lamps;
} page_points;

/* Sets step and radius by the surfels: a 64th of the radius that all but a hundredth of the discs
 * have at least. */
void page_points_scale(page_points *points);

/* Three values, 0 to 65408, as RGB9E5. */
uint32_t page_points_rgb9e5(const double rgb[3]);

/* Bytes of a block of `count` points before they are deflated. */
size_t page_points_bytes(const page_points *points, size_t count);

/*
 * Packs the points first .. first + count - 1 of the order.
 *   count   at most PAGE_BLOCK
 *   bytes   page_points_bytes
 * Thread-safety: calls for different blocks may run at the same time.
 */
void page_points_pack(const page_points *points, size_t first, size_t count, uint8_t *bytes);

#endif
