/*
 * surface_layers.c - see surface_layers.h.
 */
#include "surfels/surface_layers.h"

#include "base/nth_element.h"
#include "surfels/filled_space.h"

#include <string.h>

#define PLACES 1024u

double gw_surface_thickness(const gw_surfels *surfels, gw_neighbours *search)
{
	float thickness[PLACES];
	size_t step = surfels->count / PLACES + 1, count = 0;
	for (size_t i = 0; i < surfels->count; i += step) {
		const float *p = surfels->position + 3 * i;
		const double place[3] = { (double)p[0], (double)p[1], (double)p[2] };
		gw_neighbour_list list;
		gw_neighbours_at(search, place, &list);
		thickness[count++] = (float)gw_filled_space_thickness(surfels, place, &list);
	}
	return count > 0 ? (double)gw_nth_element(thickness, count, count / 2) : 0.0;
}
