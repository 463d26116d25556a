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
static void next_byte(laz_coder *c, laz_model **model, uint8_t *byte, uint8_t next)
{
	*byte = (uint8_t)laz_symbol(c, &model[*byte], 256, next);
}

static void next_source(laz_base *b, laz_coder *c, uint8_t *point, uint16_t next)
{
	int32_t last = load_16(point + SOURCE);
	store_16(point + SOURCE, (uint16_t)laz_near(c, &b->source, &b->source_context, 16, last, next));
}

/* ------------------------------------------------------------------------------- version 2 */

/* Bits of the first symbol of a point: what is not as in the last one, or the last one of its kind.
 */
enum {
	CHANGED_SOURCE = 1,
	CHANGED_USER = 2,
	CHANGED_ANGLE = 4,
	CHANGED_CLASS = 8,
	CHANGED_INTENSITY = 16,
	CHANGED_RETURNS = 32
};

static uint32_t statistics_of(uint32_t returns)
{
	return hexadecimal(statistics_of_return[returns >> 3 & 7][returns & 7]);
}

static uint32_t find_changes(const laz_base *b, const uint8_t *last, const uint8_t *next)
{
	uint16_t intensity = b->last_intensity[statistics_of(next[RETURNS])];
	return (load_16(next + SOURCE) != load_16(last + SOURCE) ? CHANGED_SOURCE : 0u) |
		   (next[USER] != last[USER] ? CHANGED_USER : 0u) |
		   (next[ANGLE] != last[ANGLE] ? CHANGED_ANGLE : 0u) |
		   (next[CLASS] != last[CLASS] ? CHANGED_CLASS : 0u) |
		   (load_16(next + INTENSITY) != intensity ? CHANGED_INTENSITY : 0u) |
		   (next[RETURNS] != last[RETURNS] ? CHANGED_RETURNS : 0u);
}

static void code_intensity(laz_base *b, laz_coder *c, uint32_t statistics, uint16_t next)
{
	uint32_t context = statistics < 3 ? statistics : 3;
	uint16_t *last = &b->last_intensity[statistics];
	*last = (uint16_t)laz_near(c, &b->intensity, &b->intensity_context[context], 16, *last, next);
}

static uint32_t even_up_to(uint32_t size, uint32_t most)
{
	return size < most ? size & ~1u : most;
}

/* How far a coordinate moves. */
static int32_t moves(const uint8_t *point, const uint8_t *next, size_t place)
{
	return (int32_t)(load_32(next + place) - load_32(point + place));
}

static void code_place(laz_base *b, laz_coder *c, uint8_t *point, const uint8_t *next)
{
	uint32_t returns = point[RETURNS] >> 3 & 7, single = returns == 1;
	uint32_t statistics = statistics_of(point[RETURNS]);
	laz_median *mx = &b->x_median[statistics], *my = &b->y_median[statistics];
	int32_t dx = laz_near(c, &b->dx, &b->dx_context[single], 32, laz_median_value(mx),
						  moves(point, next, X));
	laz_median_add(mx, dx);
	move(point + X, dx);

	uint32_t context = even_up_to(b->dx.size, 20) + single;
	int32_t dy = laz_near(c, &b->dy, &b->dy_context[context], 32, laz_median_value(my),
						  moves(point, next, Y));
	laz_median_add(my, dy);
	move(point + Y, dy);

	int32_t *last = &b->last_z[abs((int)returns - (point[RETURNS] & 7))];
	context = even_up_to((b->dx.size + b->dy.size) / 2, 18) + single;
	*last =
		laz_near(c, &b->height, &b->height_context[context], 32, *last, (int32_t)load_32(next + Z));
	store_32(point + Z, (uint32_t)*last);
}

void laz_base_next(laz_base *b, laz_coder *c, uint8_t *point, const uint8_t *next)
{
	uint32_t changed =
		laz_symbol(c, &b->changed, 64, c->encodes ? find_changes(b, point, next) : 0);
	if (changed & CHANGED_RETURNS)
		next_byte(c, b->returns, &point[RETURNS], next[RETURNS]);
	uint32_t returns = point[RETURNS], statistics = statistics_of(returns);
	if (changed & CHANGED_INTENSITY)
		code_intensity(b, c, statistics, load_16(next + INTENSITY));
	store_16(point + INTENSITY, b->last_intensity[statistics]);
	if (changed & CHANGED_CLASS)
		next_byte(c, b->classes, &point[CLASS], next[CLASS]);
	if (changed & CHANGED_ANGLE)
		point[ANGLE] = laz_byte_near(c, &b->angle[returns >> 6 & 1], point[ANGLE], next[ANGLE]);
	if (changed & CHANGED_USER)
		next_byte(c, b->users, &point[USER], next[USER]);
	if (changed & CHANGED_SOURCE)
		next_source(b, c, point, load_16(next + SOURCE));
	code_place(b, c, point, next);
}

/* ------------------------------------------------------------------------------- version 1 */

static int32_t median_of_three(const int32_t v[3])
{
	int32_t low = v[0] < v[1] ? v[0] : v[1], high = v[0] < v[1] ? v[1] : v[0];
	return v[2] < low ? low : v[2] > high ? high : v[2];
}

/* Returns how many bits the correctors of x and y had on average. */
static uint32_t take_place_1(laz_base *b, laz_coder *c, uint8_t *point)
{
	int32_t dx = laz_near(c, &b->dx, &b->dx_context[0], 32, median_of_three(b->x_difference), 0);
	uint32_t context = b->dx.size < 19 ? b->dx.size : 19;
	int32_t dy =
		laz_near(c, &b->dy, &b->dy_context[context], 32, median_of_three(b->y_difference), 0);
	uint32_t size = (b->dx.size + b->dy.size) / 2;
	context = size < 19 ? size : 19;
	int32_t z =
		laz_near(c, &b->height, &b->height_context[context], 32, (int32_t)load_32(point + Z), 0);
	move(point + X, dx);
	move(point + Y, dy);
	store_32(point + Z, (uint32_t)z);
	b->x_difference[b->turn] = dx;
	b->y_difference[b->turn] = dy;
	b->turn = (b->turn + 1) % 3;
	return size;
}

void laz_base_next_1(laz_base *b, laz_coder *c, uint8_t *point)
{
	uint32_t size = take_place_1(b, c, point);
	uint32_t changed = laz_symbol(c, &b->changed, 64, 0);
	if (changed & 32)
		store_16(point + INTENSITY, (uint16_t)laz_near(c, &b->intensity, &b->intensity_context[0],
													   16, load_16(point + INTENSITY), 0));
	if (changed & 16)
		next_byte(c, b->returns, &point[RETURNS], 0);
	if (changed & 8)
		next_byte(c, b->classes, &point[CLASS], 0);
	if (changed & 4)
		point[ANGLE] =
			(uint8_t)laz_near(c, &b->old_angle, &b->angle_context[size < 3], 8, point[ANGLE], 0);
	if (changed & 2)
		next_byte(c, b->users, &point[USER], 0);
	if (changed & 1)
		next_source(b, c, point, 0);
}
