#include "las/laz_points.h"
#include "las/laz_base.h"
#include "las/laz_channel.h"
#include "files/little_endian.h"

#include <assert.h>
#include <stdlib.h>

/* Statistics of what follows the base of a point; layered streams have one for each channel. */
typedef struct others {
	bool started;
	laz_time time; /* of formats 1, 3, 4 and 5; newer ones have it in the base */
	laz_color color;
	laz_infrared infrared;
	laz_wave wave;
	laz_integer byte; /* of version 1 */
	laz_model **bytes;
	uint8_t *last; /* bytes of a point; used by layered streams */
} others;

struct laz_points {
	const laz_items *items;
	laz_pool pool;
	laz_coder *coder; /* one, or one a layer */
	size_t layers;
	size_t extra;    /* bytes in the item of extra bytes */
	uint8_t *record; /* the last point */
	bool first;      /* decoding: it has not been handed out */
	uint64_t count;  /* encoding: points so far */
	uint8_t *start;  /* encoding: the first point */
	laz_base base;
	laz_channel channel[LAZ_CHANNELS];
	uint32_t current; /* channel of the last point */
	others others[LAZ_CHANNELS];
	uint32_t others_current;
	laz_model **bytes; /* of all channels */
	uint8_t *last;
};

/* ----------------------------------------------------------------------------- the struct */

static size_t layers_of(const laz_item *item)
{
	switch (item->type) {
	case LAZ_POINT14:
		return LAZ_LAYER_COUNT;
	case LAZ_RGBNIR14:
		return 2;
	case LAZ_BYTE14:
		return item->size;
	default:
		return 1;
	}
}

static size_t layer_count(const laz_items *items)
{
	size_t count = 0;
	for (size_t i = 0; items->layered && i < items->count; i++)
		count += layers_of(&items->item[i]);
	return items->layered ? count : 1;
}

laz_points *laz_points_create(const laz_items *items)
{
	laz_points *p = calloc(1, sizeof *p);
	if (!p)
		return NULL;
	p->items = items;
	p->layers = layer_count(items);
	for (size_t i = 0; i < items->count; i++)
		if (items->item[i].type == LAZ_BYTE || items->item[i].type == LAZ_BYTE14)
			p->extra = items->item[i].size;
	p->coder = calloc(p->layers, sizeof *p->coder);
	p->record = calloc(2, items->record);
	p->last = calloc(LAZ_CHANNELS, items->record);
	p->bytes = calloc(LAZ_CHANNELS * (p->extra + 1), sizeof *p->bytes);
	if (!p->coder || !p->record || !p->last || !p->bytes) {
		laz_points_destroy(&p);
		return NULL;
	}
	p->start = p->record + items->record;
	return p;
}

void laz_points_destroy(laz_points **points)
{
	laz_points *p = *points;
	if (!p)
		return;
	laz_pool_clear(&p->pool);
	for (size_t l = 0; p->coder && l < p->layers; l++)
		laz_coder_clear(&p->coder[l]);
	free(p->coder);
	free(p->record);
	free(p->last);
	free(p->bytes);
	free(p);
	*points = NULL;
}

/* Everything as at the start of a chunk. */
static void forget(laz_points *p)
{
	laz_pool_reset(&p->pool);
	p->pool.failed = false;
	memset(p->bytes, 0, LAZ_CHANNELS * (p->extra + 1) * sizeof *p->bytes);
	memset(&p->base, 0, sizeof p->base);
	memset(p->channel, 0, sizeof p->channel);
	memset(p->others, 0, sizeof p->others);
	for (size_t c = 0; c < LAZ_CHANNELS; c++) {
		p->others[c].bytes = p->bytes + c * (p->extra + 1);
		p->others[c].last = p->last + c * p->items->record;
	}
}

/* -------------------------------------------------------------------------------- starting */

size_t laz_points_least(const laz_items *items, uint64_t count)
{
	if (items->layered)
		return items->record + 4 + 4 * layer_count(items);
	return items->record + (count > 1 ? 4 : 0);
}

/* The first point, then how many there are, then the layers' lengths, then the layers. */
static bool start_layers(laz_points *p, const uint8_t *data, size_t length, uint64_t count)
{
	const uint8_t *sizes = data + p->items->record + 4;
	const uint8_t *at = sizes + 4 * p->layers, *end = data + length;
	if (load_32(sizes - 4) != count)
		return false;
	for (size_t l = 0; l < p->layers; l++) {
		size_t size = load_32(sizes + 4 * l);
		if (size > (size_t)(end - at))
			return false;
		if (size > 0 || l == LAZ_LAYER_PLACE)
			laz_coder_decode(&p->coder[l], at, size, &p->pool);
		at += size;
	}
	return true;
}

/* Takes the first point, which is not coded, as the last one. */
static void take_first(laz_points *p, const uint8_t *record)
{
	const laz_items *items = p->items;
	memcpy(p->record, record, items->record);
	for (size_t i = 0; i < items->count; i++)
		if (items->item[i].type == LAZ_GPSTIME11)
			p->others[0].time.time[0] = load_64(record + items->item[i].place);
	if (!items->layered)
		return;
	p->current = record[15] >> 4 & 3;
	laz_channel_start(&p->channel[p->current], record);
	p->others_current = p->current;
	others *o = &p->others[p->current];
	o->started = true;
	memcpy(o->last, record, items->record);
}

bool laz_points_start(laz_points *p, const uint8_t *data, size_t length, uint64_t count)
{
	size_t record = p->items->record;
	forget(p);
	for (size_t l = 0; l < p->layers; l++)
		laz_coder_clear(&p->coder[l]);
	take_first(p, data);
	p->first = true;
	if (p->items->layered)
		return start_layers(p, data, length, count);
	laz_coder_decode(&p->coder[0], data + record, length - record, &p->pool);
	if (count == 1)
		p->coder[0].over = 0; /* nothing has to follow a single point */
	return true;
}

/* ------------------------------------------------------------------------------- pointwise */

static void next_old_item(others *o, const laz_item *item, laz_coder *c, uint8_t *place)
{
	switch (item->type) {
	case LAZ_GPSTIME11:
		laz_time_next_1(&o->time, c, place);
		break;
	case LAZ_RGB12:
		laz_color_next_1(&o->color, c, place);
		break;
	default:
		for (size_t i = 0; i < item->size; i++)
			place[i] = (uint8_t)laz_near(c, &o->byte, &o->bytes[i], 8, place[i], 0);
		break;
	}
}

static void next_new_item(others *o, const laz_item *item, laz_coder *c, uint8_t *place,
						  const uint8_t *next)
{
	switch (item->type) {
	case LAZ_GPSTIME11:
		laz_time_next(&o->time, c, false, place, next);
		break;
	case LAZ_RGB12:
		laz_color_next(&o->color, c, place, next);
		break;
	default:
		for (size_t i = 0; i < item->size; i++)
			place[i] = laz_byte_near(c, &o->bytes[i], place[i], next[i]);
		break;
	}
}

/* record: the next point; what it is to be when encoding */
static void next_pointwise(laz_points *p, uint8_t *record)
{
	laz_coder *c = &p->coder[0];
	others *o = &p->others[0];
	for (size_t i = 0; i < p->items->count; i++) {
		const laz_item *item = &p->items->item[i];
		uint8_t *place = p->record + item->place;
		const uint8_t *next = c->encodes ? record + item->place : place;
		bool old = item->version == 1;
		if (item->type == LAZ_POINT10 && old)
			laz_base_next_1(&p->base, c, place);
		else if (item->type == LAZ_POINT10)
			laz_base_next(&p->base, c, place, next);
		else if (item->type == LAZ_WAVEPACKET13)
			laz_wave_next(&o->wave, c, place, next);
		else if (old)
			next_old_item(o, item, c, place);
		else
			next_new_item(o, item, c, place, next);
	}
	memcpy(record, p->record, p->items->record);
}

/* --------------------------------------------------------------------------------- layered */

/* Notes whether some bytes are not as before. Returns whether their layer has values. */
static bool has_values(laz_coder *layer, const uint8_t *place, const uint8_t *next, size_t size)
{
	if (layer->encodes && !layer->changed)
		layer->changed = memcmp(place, next, size) != 0;
	return laz_coder_has_values(layer);
}

/* layer: the first of the item's; those without values leave them as they are. */
static void next_layered_item(const laz_item *item, others *o, laz_coder *layer, uint8_t *place,
							  const uint8_t *next)
{
	switch (item->type) {
	case LAZ_RGB14:
	case LAZ_RGBNIR14:
		if (has_values(&layer[0], place, next, 6))
			laz_color_next(&o->color, &layer[0], place, next);
		if (item->type == LAZ_RGBNIR14 && has_values(&layer[1], place + 6, next + 6, 2))
			laz_infrared_next(&o->infrared, &layer[1], place + 6, next + 6);
		break;
	case LAZ_WAVEPACKET14:
		if (has_values(&layer[0], place, next, item->size))
			laz_wave_next(&o->wave, &layer[0], place, next);
		break;
	default:
		for (size_t i = 0; i < item->size; i++)
			if (has_values(&layer[i], &place[i], &next[i], 1))
				place[i] = laz_byte_near(&layer[i], &o->bytes[i], place[i], next[i]);
		break;
	}
}

/*
 * What follows the base is predicted from the channel's last point. Data of version 3 was written
 * with two faults, and has to be read with them: where the channel is as before, channel 0 counts
 * as it; and on a change to a channel that was seen before, the last point of the channel that is
 * left is used once more, and replaced.
 */
static others *choose_others(laz_points *p, bool same_channel, others **last)
{
	bool faults = p->items->item[0].version < 4;
	uint32_t wanted = faults && same_channel ? 0 : p->current;
	others *from = &p->others[p->others_current], *to = &p->others[wanted];
	*last = to;
	if (!to->started) {
		to->started = true;
		memcpy(to->last, from->last, p->items->record);
	} else if (faults) {
		*last = from;
	}
	p->others_current = wanted;
	return to;
}

static void next_layered(laz_points *p, uint8_t *record)
{
	const laz_items *items = p->items;
	uint32_t before = p->current;
	others *last;
	laz_channel_next(p->channel, &p->current, p->coder, record);
	others *o = choose_others(p, p->current == before, &last);
	laz_coder *layer = p->coder + LAZ_LAYER_COUNT;
	for (size_t i = 1; i < items->count; i++) {
		const laz_item *item = &items->item[i];
		uint8_t *place = last->last + item->place;
		next_layered_item(item, o, layer, place, layer->encodes ? record + item->place : place);
		memcpy(record + item->place, place, item->size);
		layer += layers_of(item);
	}
}

/* record: what the point is to be when encoding; receives what it is. */
static void next_point(laz_points *p, uint8_t *record)
{
	if (p->items->layered)
		next_layered(p, record);
	else
		next_pointwise(p, record);
}

void laz_points_next(laz_points *p, uint8_t *record)
{
	if (p->first)
		memcpy(record, p->record, p->items->record);
	else
		next_point(p, record);
	p->first = false;
}

laz_trouble laz_points_trouble(const laz_points *p)
{
	if (p->pool.failed)
		return LAZ_NO_MEMORY;
	laz_trouble trouble = LAZ_FINE;
	for (size_t l = 0; l < p->layers; l++) {
		if (p->coder[l].over > 0)
			return LAZ_TOO_SHORT;
		if (p->coder[l].failed)
			trouble = LAZ_DAMAGED;
	}
	return trouble;
}

size_t laz_points_left(const laz_points *p)
{
	return p->items->layered ? 0 : (size_t)(p->coder[0].end - p->coder[0].at);
}

/* -------------------------------------------------------------------------------- encoding */

void laz_points_begin(laz_points *p)
{
	forget(p);
	for (size_t l = 0; l < p->layers; l++)
		laz_coder_encode(&p->coder[l], &p->pool);
	p->count = 0;
}

void laz_points_add(laz_points *p, uint8_t *record)
{
	if (p->count++ == 0) {
		memcpy(p->start, record, p->items->record);
		take_first(p, record);
	} else {
		next_point(p, record);
	}
}

size_t laz_points_end(laz_points *p)
{
	assert(p->count > 0);
	size_t length = p->items->record + (p->items->layered ? 4 + 4 * p->layers : 0);
	for (size_t l = 0; l < p->layers; l++) {
		laz_coder *c = &p->coder[l];
		/* Layers of values that never change are left out; coordinates are never. */
		bool kept = !p->items->layered || c->changed || l <= LAZ_LAYER_Z;
		laz_coder_finish(c);
		c->used = kept ? c->used : 0;
		length += c->used;
	}
	return p->pool.failed ? 0 : length;
}

void laz_points_put(const laz_points *p, uint8_t *bytes)
{
	size_t record = p->items->record;
	memcpy(bytes, p->start, record);
	uint8_t *sizes = bytes + record + 4, *at = bytes + record;
	if (p->items->layered) {
		store_32(sizes - 4, (uint32_t)p->count);
		at = sizes + 4 * p->layers;
	}
	for (size_t l = 0; l < p->layers; l++) {
		if (p->items->layered)
			store_32(sizes + 4 * l, (uint32_t)p->coder[l].used);
		memcpy(at, p->coder[l].bytes, p->coder[l].used);
		at += p->coder[l].used;
	}
}
