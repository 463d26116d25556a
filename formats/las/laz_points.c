#include "las/laz_points.h"
#include "las/laz_base.h"
#include "las/laz_channel.h"
#include "files/little_endian.h"

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
	laz_decoder *decoder; /* one, or one a layer */
	size_t layers;
	size_t extra;    /* bytes in the item of extra bytes */
	uint8_t *record; /* the last point */
	bool first;      /* it has not been handed out */
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
	p->decoder = calloc(p->layers, sizeof *p->decoder);
	p->record = calloc(1, items->record);
	p->last = calloc(LAZ_CHANNELS, items->record);
	p->bytes = calloc(LAZ_CHANNELS * (p->extra + 1), sizeof *p->bytes);
	if (!p->decoder || !p->record || !p->last || !p->bytes)
		laz_points_destroy(&p);
	return p;
}

void laz_points_destroy(laz_points **points)
{
	laz_points *p = *points;
	if (!p)
		return;
	laz_pool_clear(&p->pool);
	free(p->decoder);
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
	memset(p->decoder, 0, p->layers * sizeof *p->decoder);
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
			laz_decoder_start(&p->decoder[l], at, size, &p->pool);
		at += size;
	}
	p->current = p->record[15] >> 4 & 3;
	laz_channel_start(&p->channel[p->current], p->record);
	p->others_current = p->current;
	others *o = &p->others[p->current];
	o->started = true;
	memcpy(o->last, p->record, p->items->record);
	return true;
}

bool laz_points_start(laz_points *p, const uint8_t *data, size_t length, uint64_t count)
{
	const laz_items *items = p->items;
	forget(p);
	memcpy(p->record, data, items->record);
	p->first = true;
	if (items->layered)
		return start_layers(p, data, length, count);
	for (size_t i = 0; i < items->count; i++)
		if (items->item[i].type == LAZ_GPSTIME11)
			p->others[0].time.time[0] = load_64(p->record + items->item[i].place);
	laz_decoder_start(&p->decoder[0], data + items->record, length - items->record, &p->pool);
	if (count == 1)
		p->decoder[0].over = 0; /* nothing has to follow a single point */
	return true;
}

/* ------------------------------------------------------------------------------- pointwise */

static void next_item(laz_points *p, const laz_item *item)
{
	laz_decoder *d = &p->decoder[0];
	others *o = &p->others[0];
	uint8_t *place = p->record + item->place;
	bool old = item->version == 1;
	switch (item->type) {
	case LAZ_POINT10:
		(old ? laz_base_next_1 : laz_base_next)(&p->base, d, place);
		break;
	case LAZ_GPSTIME11:
		if (old)
			laz_time_next_1(&o->time, d, place);
		else
			laz_time_next(&o->time, d, false, place);
		break;
	case LAZ_RGB12:
		(old ? laz_color_next_1 : laz_color_next)(&o->color, d, place);
		break;
	case LAZ_WAVEPACKET13:
		laz_wave_next(&o->wave, d, place);
		break;
	default:
		for (size_t i = 0; i < item->size; i++)
			place[i] = (uint8_t)(old ? laz_near(d, &o->byte, &o->bytes[i], 8, place[i])
									 : place[i] + (int32_t)laz_symbol(d, &o->bytes[i], 256));
		break;
	}
}

/* --------------------------------------------------------------------------------- layered */

/* layer: the first of the item's; those without bytes leave the values as they are. */
static void next_layered_item(const laz_item *item, others *o, laz_decoder *layer, uint8_t *place)
{
	switch (item->type) {
	case LAZ_RGB14:
	case LAZ_RGBNIR14:
		if (layer[0].at)
			laz_color_next(&o->color, &layer[0], place);
		if (item->type == LAZ_RGBNIR14 && layer[1].at)
			laz_infrared_next(&o->infrared, &layer[1], place + 6);
		break;
	case LAZ_WAVEPACKET14:
		if (layer[0].at)
			laz_wave_next(&o->wave, &layer[0], place);
		break;
	default:
		for (size_t i = 0; i < item->size; i++)
			if (layer[i].at)
				place[i] = (uint8_t)(place[i] + laz_symbol(&layer[i], &o->bytes[i], 256));
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

static void next_layered(laz_points *p)
{
	const laz_items *items = p->items;
	uint32_t before = p->current;
	others *last;
	laz_channel_next(p->channel, &p->current, p->decoder, p->record);
	others *o = choose_others(p, p->current == before, &last);
	laz_decoder *layer = p->decoder + LAZ_LAYER_COUNT;
	for (size_t i = 1; i < items->count; i++) {
		const laz_item *item = &items->item[i];
		next_layered_item(item, o, layer, last->last + item->place);
		memcpy(p->record + item->place, last->last + item->place, item->size);
		layer += layers_of(item);
	}
}

void laz_points_next(laz_points *p, uint8_t *record)
{
	if (!p->first && p->items->layered)
		next_layered(p);
	for (size_t i = 0; i < p->items->count && !p->first && !p->items->layered; i++)
		next_item(p, &p->items->item[i]);
	p->first = false;
	memcpy(record, p->record, p->items->record);
}

laz_trouble laz_points_trouble(const laz_points *p)
{
	if (p->pool.failed)
		return LAZ_NO_MEMORY;
	laz_trouble trouble = LAZ_FINE;
	for (size_t l = 0; l < p->layers; l++) {
		if (p->decoder[l].over > 0)
			return LAZ_TOO_SHORT;
		if (p->decoder[l].failed)
			trouble = LAZ_DAMAGED;
	}
	return trouble;
}

size_t laz_points_left(const laz_points *p)
{
	return p->items->layered ? 0 : (size_t)(p->decoder[0].end - p->decoder[0].at);
}
