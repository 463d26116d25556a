/*
 * octahedral.h - the octahedral map of directions (Engelhardt and Dachsbacher 2008; Wang 2018,
 * section 4.3): the sphere folded out to a square. Texels are not equally large on the sphere; how
 * large each is, is known exactly.
 *
 * A square of size x size texels, size even; u to the right and v down from -1 to 1. The unit
 * vector (x, y, z) is divided by |x| + |y| + |z|; where z >= 0, (u, v) = (x, y), else the corners
 * are folded out: u = (1 - |y|) sign(x), v = (1 - |x|) sign(y). So z is the middle, -z all corners.
 */
#ifndef OCTAHEDRAL_H
#define OCTAHEDRAL_H

#include "base/shader_math.h"

/* The direction of a place of the map, unit.
 *   u, v   -1 to 1 */
gw_vec3 gw_octahedral_direction(float u, float v);

/* The place of a direction; back to within the rounding of floats.
 *   direction   any length above 0 */
void gw_octahedral_place(gw_vec3 direction, float *u, float *v);

/* The direction of the middle of a texel, unit; texel: row * size + column. */
gw_vec3 gw_octahedral_texel(uint32_t size, uint32_t texel);

/* The solid angle of a texel, steradians; those of all texels add up to 4 pi but for roundings. Its
 * sides are arcs of great circles, because the map is linear on each face of the octahedron. */
double gw_octahedral_solid_angle(uint32_t size, uint32_t texel);

/* The texel beside another one: side 0 left, 1 right, 2 above, 3 below. Beyond an edge of the map
 * lies the same edge, the other way round. */
uint32_t gw_octahedral_beside(uint32_t size, uint32_t texel, uint32_t side);

/*
 * Smallest and largest values of the texels below each texel of the smaller maps of a map. A texel
 * of a map of half the size covers exactly four of the larger one, so that nothing is missed.
 *   size           of the map, a power of two
 *   value          size * size
 *   least, most    receive gw_octahedral_mip_texels(size) values each: the map of half the size,
 *                  then that of a quarter, down to one texel
 */
void gw_octahedral_mips(uint32_t size, const float *value, float *least, float *most);

/* Texels of all smaller maps together: (size * size - 1) / 3. */
uint64_t gw_octahedral_mip_texels(uint32_t size);

#endif
