/*
 * sun_position.h - where the sun stands, by place and time.
 */
#ifndef SUN_POSITION_H
#define SUN_POSITION_H

#include "glowworm.h"

/* Bytes of the longest time that is read, with the final zero. */
#define SUN_TIME 40

/* A place on the earth and a moment. */
typedef struct sun_moment {
	double latitude;  /* degrees north, -90..90 */
	double longitude; /* degrees east, -180..180 */
	double seconds;   /* UTC, since 1970-01-01 00:00, without leap seconds */
} sun_moment;

/*
 * Reads a time: YYYY-MM-DDTHH:MM, with :SS if wanted, and behind it Z for UTC or the zone's offset
 * as +HH:MM or -HH:MM (ISO 8601). Years from 1901 to 2099.
 * GW_ERROR_USAGE with a phrase that says what is wrong.
 */
gw_status sun_time_read(const char *text, double *seconds, gw_error *error);

/*
 * Where the middle of the sun is seen from a place, to 0.01 degrees from 1901 to 2099.
 *   azimuth    receives degrees clockwise from north, 0..360
 *   elevation  receives degrees above the horizon, raised by the refraction of air of 1010 hPa and
 *              10 degrees Celsius where it is above -1 degree
 * Source: J. Meeus, Astronomical Algorithms, 2nd edition: chapters 12 (sidereal time), 13
 * (coordinates), 16 (refraction, after Saemundsson), 22 (nutation, short form), 25 (sun, low
 * accuracy), 40 (parallax); his Astronomical Formulae for Calculators, chapter 18 (planets).
 */
void sun_position(const sun_moment *moment, double *azimuth, double *elevation);

#endif
