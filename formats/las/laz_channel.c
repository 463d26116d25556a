#include "las/laz_channel.h"
#include "files/little_endian.h"

#include <stdlib.h>

/* Bits of the first symbol of a point: what is not as in the channel's last point. */
enum {
	CHANGED_NUMBER = 3, /* two bits: same, next, previous, another return number */
	CHANGED_RETURNS = 4,
	CHANGED_ANGLE = 8,
	CHANGED_TIME = 16,
	CHANGED_SOURCE = 32,
	CHANGED_CHANNEL = 64,
};

/* Statistics of coordinates are kept apart by number of returns (row) and return number, as the
 * LASzip specification assigns them. */
static const char median_of_return[16][17] = {
	"0123453445555555", "1013333333333333", "2124444444433333", "3345444444444444",
	"4344544444444444", "5344454444444444", "3344445444444444", "4344444544444444",
	"4344444454444444", "5344444445444444", "5344444444544444", "5334444444455444",
	"5334444444455544", "5334444444445554", "5334444444444555", "5334444444444455",
};

void laz_channel_start(laz_channel *c, const uint8_t *point)
{
	c->started = true;
	c->x = (int32_t)load_32(point);
	c->y = (int32_t)load_32(point + 4);
	c->z = (int32_t)load_32(point + 8);
	c->intensity = load_16(point + 12);
	c->number = point[14] & 15;
	c->returns = point[14] >> 4;
	c->flags = (uint8_t)((point[15] & 15) | (point[15] >> 2 & 0x30));
	c->classification = point[16];
	c->user = point[17];
	c->angle = (int16_t)load_16(point + 18);
	c->source = load_16(point + 20);
	for (int i = 0; i < 8; i++) {
		c->last_z[i] = c->z;
		c->last_intensity[i] = c->intensity;
	}
	c->time.time[0] = load_64(point + 22);
}

static void put_point(const laz_channel *c, uint32_t channel, uint64_t time, uint8_t *point)
{
	store_32(point, (uint32_t)c->x);
	store_32(point + 4, (uint32_t)c->y);
	store_32(point + 8, (uint32_t)c->z);
	store_16(point + 12, c->intensity);
	point[14] = (uint8_t)(c->number | c->returns << 4);
	point[15] = (uint8_t)((c->flags & 15) | channel << 4 | (c->flags & 0x30) << 2);
	point[16] = c->classification;
	point[17] = c->user;
	store_16(point + 18, (uint16_t)c->angle);
	store_16(point + 20, c->source);
	store_64(point + 22, time);
}

static void take_returns(laz_channel *c, laz_decoder *d, uint32_t changed)
{
	uint32_t returns = c->returns, number = c->number;
	if (changed & CHANGED_RETURNS)
		c->returns = (uint8_t)laz_symbol(d, &c->returns_after[returns], 16);
	switch (changed & CHANGED_NUMBER) {
	case 1:
		number += 1;
		break;
	case 2:
		number += 15;
		break;
	case 3:
		/* Within a pulse, whose points share a time, the step is never -1, 0 or 1. */
		if (changed & CHANGED_TIME)
			number = laz_symbol(d, &c->number_after[number], 16);
		else
			number += laz_symbol(d, &c->number_step, 13) + 2;
		break;
	default:
		break;
	}
	c->number = number & 15;
}

static uint32_t even_up_to(uint32_t size, uint32_t most)
{
	return size < most ? size & ~1u : most;
}

static int32_t add(int32_t a, int32_t b)
{
	return (int32_t)((uint32_t)a + (uint32_t)b);
}

static void take_place(laz_channel *c, laz_decoder *layer, bool new_time)
{
	laz_decoder *d = &layer[LAZ_LAYER_PLACE];
	uint32_t median = (uint32_t)(median_of_return[c->returns][c->number] - '0') * 2 + new_time;
	uint32_t single = c->returns == 1;
	laz_median *mx = &c->x_median[median], *my = &c->y_median[median];

	int32_t dx = laz_near(d, &c->dx, &c->dx_context[single], 32, laz_median_value(mx));
	laz_median_add(mx, dx);
	c->x = add(c->x, dx);

	uint32_t context = even_up_to(c->dx.size, 20) + single;
	int32_t dy = laz_near(d, &c->dy, &c->dy_context[context], 32, laz_median_value(my));
	laz_median_add(my, dy);
	c->y = add(c->y, dy);

	if (!layer[LAZ_LAYER_Z].at)
		return;
	uint32_t level = (uint32_t)abs(c->returns - c->number);
	int32_t *last = &c->last_z[level < 7 ? level : 7];
	context = even_up_to((c->dx.size + c->dy.size) / 2, 18) + single;
	c->z = laz_near(&layer[LAZ_LAYER_Z], &c->height, &c->height_context[context], 32, *last);
	*last = c->z;
}

/* What has a layer of its own. kind: 3 for the only return of a pulse, 2 for the first of several,
 * 1 for the last, 0 for others. */
static void take_attributes(laz_channel *c, laz_decoder *layer, uint32_t changed, uint32_t kind)
{
	bool new_time = changed & CHANGED_TIME;
	if (layer[LAZ_LAYER_CLASS].at) {
		uint32_t context = (c->classification & 31u) * 2 + (kind == 3);
		c->classification = (uint8_t)laz_symbol(&layer[LAZ_LAYER_CLASS], &c->classes[context], 256);
	}
	if (layer[LAZ_LAYER_FLAGS].at)
		c->flags = (uint8_t)laz_symbol(&layer[LAZ_LAYER_FLAGS], &c->flag_sets[c->flags], 64);
	if (layer[LAZ_LAYER_INTENSITY].at) {
		uint16_t *last = &c->last_intensity[kind * 2 + new_time];
		*last = (uint16_t)laz_near(&layer[LAZ_LAYER_INTENSITY], &c->intensities,
								   &c->intensity_context[kind], 16, *last);
		c->intensity = *last;
	}
	if (layer[LAZ_LAYER_ANGLE].at && changed & CHANGED_ANGLE)
		c->angle = (int16_t)(uint16_t)laz_near(&layer[LAZ_LAYER_ANGLE], &c->angles,
											   &c->angle_context[new_time], 16, c->angle);
	if (layer[LAZ_LAYER_USER].at)
		c->user = (uint8_t)laz_symbol(&layer[LAZ_LAYER_USER], &c->users[c->user / 4], 256);
	if (layer[LAZ_LAYER_SOURCE].at && changed & CHANGED_SOURCE)
		c->source = (uint16_t)laz_near(&layer[LAZ_LAYER_SOURCE], &c->sources, &c->source_context,
									   16, c->source);
}

/* The channel of the next point; one that is new begins where the last channel is. */
static laz_channel *switch_channel(laz_channel channel[LAZ_CHANNELS], uint32_t *current,
								   laz_decoder *d)
{
	laz_channel *from = &channel[*current];
	uint8_t point[LAZ_POINT14_BYTES];
	*current = (*current + laz_symbol(d, &from->other_channel, 3) + 1) & 3;
	laz_channel *to = &channel[*current];
	if (!to->started) {
		put_point(from, 0, from->time.time[from->time.current], point);
		laz_channel_start(to, point);
	}
	return to;
}

void laz_channel_next(laz_channel channel[LAZ_CHANNELS], uint32_t *current, laz_decoder *layer,
					  uint8_t *point)
{
	laz_decoder *d = &layer[LAZ_LAYER_PLACE];
	laz_channel *c = &channel[*current];
	uint32_t before = (c->number == 1) + (c->number >= c->returns) * 2u + c->new_time * 4u;
	uint32_t changed = laz_symbol(d, &c->changed[before], 128);
	if (changed & CHANGED_CHANNEL)
		c = switch_channel(channel, current, d);
	take_returns(c, d, changed);
	c->new_time = changed & CHANGED_TIME;
	take_place(c, layer, c->new_time);
	take_attributes(c, layer, changed, (c->number == 1) * 2u + (c->number >= c->returns));
	uint8_t time[8];
	if (c->new_time && layer[LAZ_LAYER_TIME].at)
		laz_time_next(&c->time, &layer[LAZ_LAYER_TIME], true, time);
	put_point(c, *current, c->time.time[c->time.current], point);
}
