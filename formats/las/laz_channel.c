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

static laz_point unpack(const uint8_t *from)
{
	return (laz_point){ .x = (int32_t)load_32(from),
						.y = (int32_t)load_32(from + 4),
						.z = (int32_t)load_32(from + 8),
						.intensity = load_16(from + 12),
						.number = from[14] & 15,
						.returns = from[14] >> 4,
						.flags = (uint8_t)((from[15] & 15) | (from[15] >> 2 & 0x30)),
						.channel = from[15] >> 4 & 3,
						.classification = from[16],
						.user = from[17],
						.angle = (int16_t)load_16(from + 18),
						.source = load_16(from + 20),
						.time = load_64(from + 22) };
}

static void pack(const laz_point *p, uint8_t *to)
{
	store_32(to, (uint32_t)p->x);
	store_32(to + 4, (uint32_t)p->y);
	store_32(to + 8, (uint32_t)p->z);
	store_16(to + 12, p->intensity);
	to[14] = (uint8_t)(p->number | p->returns << 4);
	to[15] = (uint8_t)((p->flags & 15) | p->channel << 4 | (p->flags & 0x30) << 2);
	to[16] = p->classification;
	to[17] = p->user;
	store_16(to + 18, (uint16_t)p->angle);
	store_16(to + 20, p->source);
	store_64(to + 22, p->time);
}

static void start(laz_channel *c, const laz_point *point)
{
	c->started = true;
	c->last = *point;
	for (int i = 0; i < 8; i++) {
		c->last_z[i] = point->z;
		c->last_intensity[i] = point->intensity;
	}
	c->time.time[0] = point->time;
}

void laz_channel_start(laz_channel *c, const uint8_t *point)
{
	laz_point unpacked = unpack(point);
	start(c, &unpacked);
}

/* What is not as in the last point of the channel of the next one, or, where that is new, of the
 * current one. */
static uint32_t find_changes(const laz_channel *current, const laz_channel *of_next,
							 const laz_point *next)
{
	const laz_channel *c = of_next->started ? of_next : current;
	uint32_t step = (next->number - c->last.number) & 15u;
	return (step == 0    ? 0
			: step == 1  ? 1u
			: step == 15 ? 2u
						 : 3u) |
		   (next->returns != c->last.returns ? CHANGED_RETURNS : 0u) |
		   (next->angle != c->last.angle ? CHANGED_ANGLE : 0u) |
		   (next->time != c->last.time ? CHANGED_TIME : 0u) |
		   (next->source != c->last.source ? CHANGED_SOURCE : 0u) |
		   (current != of_next ? CHANGED_CHANNEL : 0u);
}

static void code_returns(laz_channel *c, laz_coder *d, uint32_t changed, const laz_point *next)
{
	uint32_t returns = c->last.returns, number = c->last.number;
	if (changed & CHANGED_RETURNS)
		c->last.returns = (uint8_t)laz_symbol(d, &c->returns_after[returns], 16, next->returns);
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
			number = laz_symbol(d, &c->number_after[number], 16, next->number);
		else
			number += laz_symbol(d, &c->number_step, 13, (next->number - number - 2) & 15) + 2;
		break;
	default:
		break;
	}
	c->last.number = number & 15;
}

static uint32_t even_up_to(uint32_t size, uint32_t most)
{
	return size < most ? size & ~1u : most;
}

static int32_t add(int32_t a, int32_t b)
{
	return (int32_t)((uint32_t)a + (uint32_t)b);
}

static int32_t subtract(int32_t a, int32_t b)
{
	return (int32_t)((uint32_t)a - (uint32_t)b);
}

static void code_place(laz_channel *c, laz_coder *layer, const laz_point *next)
{
	laz_coder *d = &layer[LAZ_LAYER_PLACE];
	laz_point *last = &c->last;
	uint32_t kind = (uint32_t)(median_of_return[last->returns][last->number] - '0');
	uint32_t median = kind * 2 + c->new_time, single = last->returns == 1;
	laz_median *mx = &c->x_median[median], *my = &c->y_median[median];

	int32_t dx = laz_near(d, &c->dx, &c->dx_context[single], 32, laz_median_value(mx),
						  subtract(next->x, last->x));
	laz_median_add(mx, dx);
	last->x = add(last->x, dx);

	uint32_t context = even_up_to(c->dx.size, 20) + single;
	int32_t dy = laz_near(d, &c->dy, &c->dy_context[context], 32, laz_median_value(my),
						  subtract(next->y, last->y));
	laz_median_add(my, dy);
	last->y = add(last->y, dy);

	d = &layer[LAZ_LAYER_Z];
	if (!laz_coder_has_values(d))
		return;
	uint32_t level = (uint32_t)abs(last->returns - last->number);
	int32_t *z = &c->last_z[level < 7 ? level : 7];
	context = even_up_to((c->dx.size + c->dy.size) / 2, 18) + single;
	last->z = *z = laz_near(d, &c->height, &c->height_context[context], 32, *z, next->z);
}

/* A layer, or NULL when it has no values. differs: the next value is not the last */
static laz_coder *find_layer(laz_coder *layer, laz_layer number, bool differs)
{
	laz_coder *found = &layer[number];
	found->changed = found->changed || differs;
	return laz_coder_has_values(found) ? found : NULL;
}

/* What has a layer of its own, whether it changes or not. kind: 3 for the only return of a pulse, 2
 * for the first of several, 1 for the last, 0 for others. */
static void code_attributes(laz_channel *c, laz_coder *layer, uint32_t kind, const laz_point *next)
{
	laz_point *last = &c->last;
	laz_coder *d = find_layer(layer, LAZ_LAYER_CLASS, next->classification != last->classification);
	uint32_t context = (last->classification & 31u) * 2 + (kind == 3);
	if (d)
		last->classification =
			(uint8_t)laz_symbol(d, &c->classes[context], 256, next->classification);
	d = find_layer(layer, LAZ_LAYER_FLAGS, next->flags != last->flags);
	if (d)
		last->flags = (uint8_t)laz_symbol(d, &c->flag_sets[last->flags], 64, next->flags);
	d = find_layer(layer, LAZ_LAYER_INTENSITY, next->intensity != last->intensity);
	uint16_t *intensity = &c->last_intensity[kind * 2 + c->new_time];
	if (d)
		last->intensity = *intensity = (uint16_t)laz_near(
			d, &c->intensities, &c->intensity_context[kind], 16, *intensity, next->intensity);
	d = find_layer(layer, LAZ_LAYER_USER, next->user != last->user);
	if (d)
		last->user = (uint8_t)laz_symbol(d, &c->users[last->user / 4], 256, next->user);
}

/* What is only coded when it changes. */
static void code_changes(laz_channel *c, laz_coder *layer, uint32_t changed, const laz_point *next)
{
	laz_point *last = &c->last;
	laz_coder *d = find_layer(layer, LAZ_LAYER_ANGLE, changed & CHANGED_ANGLE);
	if (d && changed & CHANGED_ANGLE)
		last->angle = (int16_t)(uint16_t)laz_near(d, &c->angles, &c->angle_context[c->new_time], 16,
												  last->angle, next->angle);
	d = find_layer(layer, LAZ_LAYER_SOURCE, changed & CHANGED_SOURCE);
	if (d && changed & CHANGED_SOURCE)
		last->source =
			(uint16_t)laz_near(d, &c->sources, &c->source_context, 16, last->source, next->source);
	d = find_layer(layer, LAZ_LAYER_TIME, changed & CHANGED_TIME);
	uint8_t time[8], time_next[8];
	store_64(time_next, next->time);
	if (d && changed & CHANGED_TIME)
		laz_time_next(&c->time, d, true, time, time_next);
}

/* The channel of the next point; one that is new begins where the last channel is. */
static laz_channel *switch_channel(laz_channel channel[LAZ_CHANNELS], uint32_t *current,
								   laz_coder *d, const laz_point *next)
{
	laz_channel *from = &channel[*current];
	uint32_t step = (next->channel - *current - 1) & 3;
	*current = (*current + laz_symbol(d, &from->other_channel, 3, step) + 1) & 3;
	laz_channel *to = &channel[*current];
	if (!to->started)
		start(to, &from->last);
	return to;
}

void laz_channel_next(laz_channel channel[LAZ_CHANNELS], uint32_t *current, laz_coder *layer,
					  uint8_t *point)
{
	laz_coder *d = &layer[LAZ_LAYER_PLACE];
	laz_channel *c = &channel[*current];
	laz_point next = { 0 };
	uint32_t changed = 0;
	if (d->encodes) {
		next = unpack(point);
		changed = find_changes(c, &channel[next.channel], &next);
	}
	uint32_t before =
		(c->last.number == 1) + (c->last.number >= c->last.returns) * 2u + c->new_time * 4u;
	changed = laz_symbol(d, &c->changed[before], 128, changed);
	if (changed & CHANGED_CHANNEL)
		c = switch_channel(channel, current, d, &next);
	code_returns(c, d, changed, &next);
	c->new_time = changed & CHANGED_TIME;
	code_place(c, layer, &next);
	code_attributes(c, layer, (c->last.number == 1) * 2u + (c->last.number >= c->last.returns),
					&next);
	code_changes(c, layer, changed, &next);
	c->last.channel = (uint8_t)*current;
	c->last.time = c->time.time[c->time.current];
	pack(&c->last, point);
}
