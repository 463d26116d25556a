/*
 * distribution.h - how the intensity of a luminaire depends on direction.
 */
#ifndef DISTRIBUTION_H
#define DISTRIBUTION_H

#include "base/shader_math.h"
#include "glowworm.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Whether a light is somewhere: all but suns and skies. */
bool gw_light_has_place(const gw_light *light);

/* Whether a light is a lamp or a sun, and is not black. */
bool gw_light_shines(const gw_light *light);

/* The axis of a light that has a distribution, and at right angles to it where the angles around it
 * count from, both unit. */
void gw_distribution_frame(const gw_light *light, gw_vec3 *axis, gw_vec3 *across);

/* Whether a light has one, and is of a type that can. */
bool gw_distribution_counts(const gw_light *light);

/* How many numbers a light's distribution has; 0: it has none. */
size_t gw_distribution_length(const gw_light *light);

/* Share of the intensity in a direction, unit: x along `across`, z along the axis: of
 * distribution.glsl.
 *   distribution   as gw_light has it, with so many angles from the axis and around it */
float gw_distribution_share(const float *distribution, uint32_t verticals, uint32_t horizontals,
							gw_vec3 way);

/* The same of a light, in a direction in which it travels, unit: discs and rectangles send their
 * cosine; 1 of those that send the same everywhere, and of spots. */
float gw_distribution_towards(const gw_light *light, gw_vec3 way);

/* Whether a light's direction and what is across it make a frame. */
bool gw_distribution_has_frame(const gw_light *light);

/* Ascending angles in range, a whole turn, shares of at least 0, an axis and what is across it:
 * what is wrong with a light's distribution, as a phrase; NULL: nothing. */
const char *gw_distribution_fault(const gw_light *light);

#ifdef __cplusplus
}
#endif

#endif
