/*
 * shared_places.h - which of several points of a cloud at one place is which of those that another
 * cloud has there: their order does not say, which some programs and formats change.
 */
#ifndef SHARED_PLACES_H
#define SHARED_PLACES_H

#include "points/scan.h"

/* A place, or a number, at which one of the clouds has more than one point. */
typedef struct shared_place {
	size_t *truth, *found; /* the points there; put into other orders */
	size_t truth_count, found_count;
} shared_place;

typedef struct shared_places {
	const scan *truth, *found;
	shared_place *place;
	size_t count;
	bool in_order; /* both clouds have the same places in one order */
	size_t
		*in_found; /* of each point of the truth, its partner: of these places, to be filled in */
	size_t untold; /* receives how many points of the truth nothing but their light told apart
					  from others at their place, where it matters which of them they are */
} shared_places;

/*
 * Pairs the points of each place. They are told apart by all columns of both clouds that have the
 * same values at all of these places, those that are no light first. What these leave equal is
 * paired as it stands, where clouds are in one order, else in the order of its radiance, so that
 * what differs is the least that may; where one cloud has more, by those in the middle of that.
 * GW_ERROR_MEMORY.
 */
gw_status shared_places_pair(shared_places *places, gw_error *error);

#endif
