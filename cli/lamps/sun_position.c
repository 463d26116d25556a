#include "lamps/sun_position.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define DEGREE (3.14159265358979323846 / 180.0)
#define DAY 86400.0
#define JULIAN_1970 2440587.5 /* Julian day of the first second */
#define JULIAN_2000 2451545.0 /* of noon on the first of January 2000 */
#define CENTURY 36525.0       /* days */
#define EARTH_TIME                                                                                 \
	69.2                /* seconds by which terrestrial time is ahead of UTC today; off by         \
						   35 in 1950, in which the sun moves by 0.0004 degrees */
#define FIRST_YEAR 1901 /* between these every fourth year is a leap year */
#define LAST_YEAR 2099

/* --------------------------------------------------------------------------------- times */

static bool is_leap(int year)
{
	return year % 4 == 0;
}

static int days_of(int year, int month)
{
	static const int days[12] = { 31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31 };
	return days[month - 1] + (month == 2 && is_leap(year));
}

/* Days from the start of 1970 to that of a day, within FIRST_YEAR to LAST_YEAR. */
static double days_since_1970(int year, int month, int day)
{
	int days = 365 * (year - 1970) + (year - 1901) / 4 - (1970 - 1901) / 4 + day - 1;
	for (int m = 1; m < month; m++)
		days += days_of(year, m);
	return days;
}

/* Reads `digits` digits at *at and moves behind them; -1 when there are fewer. */
static int take_digits(const char **at, int digits)
{
	int value = 0;
	for (int i = 0; i < digits; i++, (*at)++) {
		if (**at < '0' || **at > '9')
			return -1;
		value = 10 * value + (**at - '0');
	}
	return value;
}

/* A separator and digits behind it; -1 when they are not there. */
static int take_part(const char **at, char separator, int digits)
{
	if (**at != separator)
		return -1;
	(*at)++;
	return take_digits(at, digits);
}

/* Minutes that the zone is ahead of UTC; false when none is said. */
static bool take_zone(const char *at, int *minutes)
{
	*minutes = 0;
	if (strcmp(at, "Z") == 0)
		return true;
	if (*at != '+' && *at != '-')
		return false;
	int sign = *at++ == '-' ? -1 : 1;
	int hours = take_digits(&at, 2), rest = hours < 0 ? -1 : take_part(&at, ':', 2);
	*minutes = sign * (60 * hours + rest);
	return hours >= 0 && hours <= 14 && rest >= 0 && rest < 60 && *at == '\0';
}

gw_status sun_time_read(const char *text, double *seconds, gw_error *error)
{
	const char *at = text;
	int year = take_digits(&at, 4), month = year < 0 ? -1 : take_part(&at, '-', 2);
	int day = month < 0 ? -1 : take_part(&at, '-', 2), hour = day < 0 ? -1 : take_part(&at, 'T', 2);
	int minute = hour < 0 ? -1 : take_part(&at, ':', 2), second = 0, zone;
	if (minute >= 0 && *at == ':')
		second = take_part(&at, ':', 2);
	if (minute < 0 || second < 0)
		return gw_fail(error, GW_ERROR_USAGE,
					   "a time is written as 2026-06-21T14:30+02:00, or with Z for UTC");
	if (year < FIRST_YEAR || year > LAST_YEAR)
		return gw_fail(error, GW_ERROR_USAGE, "the year must be from %d to %d", FIRST_YEAR,
					   LAST_YEAR);
	if (month < 1 || month > 12 || day < 1 || day > days_of(year, month) || hour > 23 ||
		minute > 59 || second > 59)
		return gw_fail(error, GW_ERROR_USAGE, "there is no such day or time of day");
	if (!take_zone(at, &zone))
		return gw_fail(error, GW_ERROR_USAGE,
					   "the zone is missing behind the time: +02:00 for central Europe in summer, "
					   "Z for UTC");
	*seconds =
		days_since_1970(year, month, day) * DAY + 3600.0 * hour + 60.0 * (minute - zone) + second;
	return GW_OK;
}

/* --------------------------------------------------------------------------------- the sun */

/* Right ascension and declination as seen from the earth's centre, nutation of the equinox, and
 * the obliquity; radians. */
typedef struct sun_place {
	double ascension, declination, equinox, obliquity;
} sun_place;

/* By how much Venus (two terms), Jupiter and the moon pull the earth from its ellipse, and a slow
 * term, in degrees of the sun's longitude; t in centuries since 1900. */
static double perturbation(double t)
{
	return 0.00134 * cos((153.23 + 22518.7541 * t) * DEGREE) +
		   0.00154 * cos((216.57 + 45037.5082 * t) * DEGREE) +
		   0.00200 * cos((312.69 + 32964.3577 * t) * DEGREE) +
		   0.00179 * sin((350.74 + 445267.1142 * t) * DEGREE) +
		   0.00178 * sin((231.19 + 20.20 * t) * DEGREE);
}

static sun_place find_sun(double t)
{
	double mean_longitude = 280.46646 + t * (36000.76983 + t * 0.0003032);
	double anomaly = (357.52911 + t * (35999.05029 - t * 0.0001537)) * DEGREE;
	double centre = (1.914602 - t * (0.004817 + t * 0.000014)) * sin(anomaly) +
					(0.019993 - t * 0.000101) * sin(2.0 * anomaly) + 0.000289 * sin(3.0 * anomaly);
	double node = (125.04 - 1934.136 * t) * DEGREE;
	double moon = (218.3165 + 481267.8813 * t) * DEGREE, sun = mean_longitude * DEGREE;
	/* Seconds of arc; terms down to 0.2. */
	double nutation = -17.20 * sin(node) - 1.32 * sin(2.0 * sun) - 0.23 * sin(2.0 * moon) +
					  0.21 * sin(2.0 * node);
	double tilt = 9.20 * cos(node) + 0.57 * cos(2.0 * sun) + 0.10 * cos(2.0 * moon);
	/* Aberration is 20.5 seconds of arc. */
	double longitude =
		(mean_longitude + centre + perturbation(t + 1.0) + (nutation - 20.4898) / 3600.0) * DEGREE;
	sun_place place = { .equinox = nutation / 3600.0 * DEGREE };
	place.obliquity = (23.4392911 - t * (0.0130042 + t * 1.64e-7) + tilt / 3600.0) * DEGREE;
	place.ascension = atan2(cos(place.obliquity) * sin(longitude), cos(longitude));
	place.declination = asin(sin(place.obliquity) * sin(longitude));
	return place;
}

/* By how much the air lifts what stands at that true elevation; degrees. */
static double refraction(double elevation)
{
	if (elevation < -1.0)
		return 0.0;
	return 1.02 / 60.0 / tan((elevation + 10.3 / (elevation + 5.11)) * DEGREE);
}

void sun_position(const sun_moment *moment, double *azimuth, double *elevation)
{
	double days = moment->seconds / DAY + JULIAN_1970 - JULIAN_2000;
	double centuries = days / CENTURY;
	sun_place sun = find_sun(centuries + EARTH_TIME / DAY / CENTURY);
	double sidereal =
		(280.46061837 + 360.98564736629 * days + centuries * centuries * 0.000387933) * DEGREE +
		sun.equinox * cos(sun.obliquity);
	double hour = sidereal + moment->longitude * DEGREE - sun.ascension;
	double latitude = moment->latitude * DEGREE;
	double height = asin(sin(latitude) * sin(sun.declination) +
						 cos(latitude) * cos(sun.declination) * cos(hour));
	double west =
		atan2(sin(hour), cos(hour) * sin(latitude) - tan(sun.declination) * cos(latitude));
	/* Seen from the surface it stands lower than from the centre, by 8.794 seconds of arc. */
	double seen = height / DEGREE - 8.794 / 3600.0 * cos(height);
	*elevation = seen + refraction(seen);
	*azimuth = fmod(west / DEGREE + 540.0, 360.0);
}
