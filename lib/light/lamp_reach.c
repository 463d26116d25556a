/*
 * lamp_reach.c - see lamp_reach.h.
 */
#include "light/lamp_reach.h"

#include "base/distribution.h"
#include "base/parallel.h"

#include <math.h>
#include <stdatomic.h>

#define CHUNK 65536u

/* The cone is taken for wider by so much, so that passes in float32 find nothing beyond it: the
 * cosine of a direction between coordinates of 24 bits is good to a few 1e-6 once the cell next to
 * the lamp is left out (NEAR). */
#define WIDER 1e-4

/* Surfels nearer than this, in widths of the cloud, count as reached: their direction is not
 * certain. */
#define NEAR 1e-3

typedef struct cone {
	const gw_surfels *surfels;
	double from[3]; /* the lamp, in the surfels' frame */
	double axis[3]; /* of length 1 */
	double cosine;  /* of the widest angle */
	double near;    /* metres */
	atomic_bool reached;
} cone;

static bool is_inside(const cone *c, const float position[3])
{
	double along = 0.0, square = 0.0;
	for (int k = 0; k < 3; k++) {
		double to = (double)position[k] - c->from[k];
		along += to * c->axis[k];
		square += to * to;
	}
	return square < c->near * c->near || along >= c->cosine * sqrt(square);
}

static void look(void *user, size_t first, size_t last, uint32_t worker)
{
	cone *c = user;
	(void)worker;
	for (size_t i = first; i < last && !atomic_load_explicit(&c->reached, memory_order_relaxed);
		 i++)
		if (is_inside(c, c->surfels->position + 3 * i))
			atomic_store_explicit(&c->reached, true, memory_order_relaxed);
}

bool gw_lamp_reaches(const gw_light *light, const gw_surfels *surfels, uint32_t threads)
{
	if (!gw_light_shines(light) || surfels->count == 0)
		return false;
	if (light->type != GW_LIGHT_SPOT || light->outer_angle >= 180.0f)
		return true;
	cone c = { .surfels = surfels,
			   .cosine = cos((double)light->outer_angle * (M_PI / 180.0)) - WIDER };
	double length = 0.0;
	for (int k = 0; k < 3; k++) {
		c.from[k] = light->position[k] - surfels->origin[k];
		length = hypot(length, light->direction[k]);
		c.near = fmax(c.near, (double)surfels->maximum[k] - (double)surfels->minimum[k]);
	}
	c.near = NEAR * c.near;
	for (int k = 0; k < 3; k++)
		c.axis[k] = light->direction[k] / length;
	gw_parallel_for(gw_thread_count(threads), surfels->count, CHUNK, look, &c);
	return atomic_load(&c.reached);
}
