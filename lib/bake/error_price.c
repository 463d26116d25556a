/*
 * error_price.c - see error_price.h. What is measured here was measured on scenes of 100,000 points
 * with known answers.
 */
#include "bake/error_price.h"

#include <math.h>

/* Where refining begins (gw_bake_options_set_start). */
#define START_RAYS 64.0
#define START_SPACING 5.0

#define RAYS_MOST 4096.0

/* The number of records goes with this power of their spacing: less than the square where rooms
 * are narrow. */
#define RECORDS_POWER 1.7

/* A target has to hold with the spread, and rounds end a little below it. */
#define MARGIN 0.85

/* Share of the mean square error that noise is left. */
#define NOISE_SHARE 0.5

/* As many records, put where they disagree, leave this share of the square error of even ones; and
 * that falls with this power of their number. */
#define PLACED_SHARE 0.4
#define REST_POWER 1.5

/* The square error of even records falls with this power of their number, and so far off that is:
 * with 12 times as many in rooms, boxes and a yard 0.8 to 1.4, in rough caves 0.4, and 0.6 in boxes
 * of a million points, where what is left lies in corners that no record reaches. */
#define EVEN_POWER 0.9
#define EVEN_POWER_SPREAD 0.5

/* By how much rounds make records more, and how much more than what would do they end with, because
 * they go in steps. */
#define ROUND_GROWTH 3.0
#define OVERSHOOT 1.25

/* Less than this share of the error taken off is not worth a word. */
#define WORTH 0.07

/* More than that cannot be asked for as max_error. */
#define ERROR_MOST 0.99

double gw_error_floor(const gw_error_estimate *e)
{
	const double part[] = { e->shadows, e->normals, e->emission, e->geometry,
							e->gaps,    e->sides,   e->narrow,   e->between };
	double square = 0.0;
	for (size_t i = 0; i < sizeof part / sizeof *part; i++)
		square += part[i] * part[i];
	return sqrt(square);
}

double gw_error_with_records(const gw_error_estimate *e, double times, double *spread)
{
	double noise = fmin(e->noise * e->noise, e->gathered * e->gathered);
	double rest = (e->gathered * e->gathered - noise) * pow(times, -EVEN_POWER);
	*spread = 0.5 * EVEN_POWER_SPREAD * fabs(log(times)) * sqrt(rest);
	return sqrt(noise + rest);
}

gw_price gw_price_of(const gw_price_task *t, double error)
{
	const gw_error_estimate *e = &t->error;
	gw_price price = { .error = error };
	double square = MARGIN * MARGIN * error * error - gw_error_floor(e) * gw_error_floor(e);
	if (!(square > 0.0) || !(t->records > 0.0) || !(t->ray_seconds > 0.0))
		return price;
	double noise = e->noise * e->noise * t->rays; /* of one ray a record */
	double rest = fmax(e->gathered * e->gathered - e->noise * e->noise, 0.0);
	double rays = fmax(noise / (NOISE_SHARE * square), START_RAYS);
	if (rays > RAYS_MOST)
		return price;
	if (!t->refined)
		rest *= PLACED_SHARE;
	/* What noise does not take up is left to the rest. */
	double left = fmax(square - noise / rays, (1.0 - NOISE_SHARE) * square);
	double start = t->records;
	if (!t->refined && t->spacing > 0.0)
		start *= pow(t->spacing / START_SPACING, RECORDS_POWER);
	double records =
		fmax(OVERSHOOT * t->records * pow(rest / left, 1.0 / REST_POWER), fmin(start, t->records));
	double rounds = 1.0 + (rays > START_RAYS ? 1.0 : 0.0);
	if (records > start)
		rounds += ceil(log(records / start) / log(ROUND_GROWTH));
	price.seconds =
		t->fixed_seconds + rounds * t->round_seconds +
		t->ray_seconds * (records * rays + (rays > START_RAYS ? start * START_RAYS : 0));
	return price;
}

/* Two digits, as people read it and type it again; not less than it is. */
static double two_digits(double value)
{
	double unit = pow(10.0, floor(log10(value)) - 1.0);
	return ceil(value / unit - 1e-9) * unit;
}

gw_price gw_price_of_less(const gw_price_task *t)
{
	const gw_error_estimate *e = &t->error;
	if (!(e->gathered > 0.0))
		return (gw_price){ 0 };
	/* Beside edges of shadows and errors of normals there has to be room for what is gathered. */
	double least = hypot(gw_error_floor(e) / MARGIN, 0.5 * e->gathered);
	double wanted = fmin(two_digits(fmax(0.5 * e->relative_rms, least)), ERROR_MOST);
	gw_price price = gw_price_of(t, wanted);
	bool worth = wanted <= (1.0 - WORTH) * e->relative_rms;
	return worth && price.seconds > 0.0 ? price : (gw_price){ 0 };
}
