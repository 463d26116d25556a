#include "las/laz_base.h"
#include "files/little_endian.h"

#include <stdlib.h>

/* Places of values in a point. */
enum {
	X = 0,
	Y = 4,
	Z = 8,
	INTENSITY = 12,
	RETURNS = 14,
	CLASS = 15,
	ANGLE = 16,
	USER = 17,
	SOURCE = 18
};

/* Statistics are kept apart by number of returns (row) and return number, as the LASzip
 * specification assigns them; hexadecimal. */
static const char statistics_of_return[8][9] = { "fedcba98", "e0136aa9", "d1247bba", "c3458ccb",
												 "b6789ddc", "aabcdeed", "9abcdefe", "89abcdef" };

static uint32_t hexadecimal(char digit)
{
	return (uint32_t)(digit <= '9' ? digit - '0' : digit - 'a' + 10);
}

/* Adds a difference to a coordinate. */
static void move(uint8_t *place, int32_t difference)
{
	store_32(place, load_32(place) + (uint32_t)difference);
}

/* A byte whose statistics depend on what it was. */
static void next_byte(laz_decoder *d, laz_model **model, uint8_t *byte)
{
	*byte = (uint8_t)laz_symbol(d, &model[*byte], 256);
}

static void next_source(laz_base *b, laz_decoder *d, uint8_t *point)
{
	store_16(point + SOURCE,
			 (uint16_t)laz_near(d, &b->source, &b->source_context, 16, load_16(point + SOURCE)));
}

/* ------------------------------------------------------------------------------- version 2 */

static void take_intensity(laz_base *b, laz_decoder *d, uint32_t statistics, uint8_t *point)
{
	uint32_t context = statistics < 3 ? statistics : 3;
	b->last_intensity[statistics] = (uint16_t)laz_near(
		d, &b->intensity, &b->intensity_context[context], 16, b->last_intensity[statistics]);
	store_16(point + INTENSITY, b->last_intensity[statistics]);
}

static uint32_t even_up_to(uint32_t size, uint32_t most)
{
	return size < most ? size & ~1u : most;
}

static void take_place(laz_base *b, laz_decoder *d, uint32_t statistics, uint8_t *point)
{
	uint32_t returns = point[RETURNS] >> 3 & 7, single = returns == 1;
	laz_median *mx = &b->x_median[statistics], *my = &b->y_median[statistics];
	int32_t dx = laz_near(d, &b->dx, &b->dx_context[single], 32, laz_median_value(mx));
	laz_median_add(mx, dx);
	move(point + X, dx);

	uint32_t context = even_up_to(b->dx.size, 20) + single;
	int32_t dy = laz_near(d, &b->dy, &b->dy_context[context], 32, laz_median_value(my));
	laz_median_add(my, dy);
	move(point + Y, dy);

	int32_t *last = &b->last_z[abs((int)returns - (point[RETURNS] & 7))];
	context = even_up_to((b->dx.size + b->dy.size) / 2, 18) + single;
	*last = laz_near(d, &b->height, &b->height_context[context], 32, *last);
	store_32(point + Z, (uint32_t)*last);
}

void laz_base_next(laz_base *b, laz_decoder *d, uint8_t *point)
{
	uint32_t changed = laz_symbol(d, &b->changed, 64);
	if (changed & 32)
		next_byte(d, b->returns, &point[RETURNS]);
	uint32_t returns = point[RETURNS];
	uint32_t statistics = hexadecimal(statistics_of_return[returns >> 3 & 7][returns & 7]);
	if (changed & 16)
		take_intensity(b, d, statistics, point);
	else
		store_16(point + INTENSITY, b->last_intensity[statistics]);
	if (changed & 8)
		next_byte(d, b->classes, &point[CLASS]);
	if (changed & 4)
		point[ANGLE] = (uint8_t)(point[ANGLE] + laz_symbol(d, &b->angle[returns >> 6 & 1], 256));
	if (changed & 2)
		next_byte(d, b->users, &point[USER]);
	if (changed & 1)
		next_source(b, d, point);
	take_place(b, d, statistics, point);
}

/* ------------------------------------------------------------------------------- version 1 */

static int32_t median_of_three(const int32_t v[3])
{
	int32_t low = v[0] < v[1] ? v[0] : v[1], high = v[0] < v[1] ? v[1] : v[0];
	return v[2] < low ? low : v[2] > high ? high : v[2];
}

/* Returns how many bits the correctors of x and y had on average. */
static uint32_t take_place_1(laz_base *b, laz_decoder *d, uint8_t *point)
{
	int32_t dx = laz_near(d, &b->dx, &b->dx_context[0], 32, median_of_three(b->x_difference));
	uint32_t context = b->dx.size < 19 ? b->dx.size : 19;
	int32_t dy = laz_near(d, &b->dy, &b->dy_context[context], 32, median_of_three(b->y_difference));
	uint32_t size = (b->dx.size + b->dy.size) / 2;
	context = size < 19 ? size : 19;
	int32_t z =
		laz_near(d, &b->height, &b->height_context[context], 32, (int32_t)load_32(point + Z));
	move(point + X, dx);
	move(point + Y, dy);
	store_32(point + Z, (uint32_t)z);
	b->x_difference[b->turn] = dx;
	b->y_difference[b->turn] = dy;
	b->turn = (b->turn + 1) % 3;
	return size;
}

void laz_base_next_1(laz_base *b, laz_decoder *d, uint8_t *point)
{
	uint32_t size = take_place_1(b, d, point);
	uint32_t changed = laz_symbol(d, &b->changed, 64);
	if (changed & 32)
		store_16(point + INTENSITY, (uint16_t)laz_near(d, &b->intensity, &b->intensity_context[0],
													   16, load_16(point + INTENSITY)));
	if (changed & 16)
		next_byte(d, b->returns, &point[RETURNS]);
	if (changed & 8)
		next_byte(d, b->classes, &point[CLASS]);
	if (changed & 4)
		point[ANGLE] =
			(uint8_t)laz_near(d, &b->old_angle, &b->angle_context[size < 3], 8, point[ANGLE]);
	if (changed & 2)
		next_byte(d, b->users, &point[USER]);
	if (changed & 1)
		next_source(b, d, point);
}
