#include "las/laz_values.h"
#include "files/little_endian.h"

void laz_median_add(laz_median *median, int32_t value)
{
	int32_t *sorted = median->sorted, middle = sorted[2];
	int place;
	if (median->drop_smallest) {
		for (place = 0; place < 4 && sorted[place + 1] < value; place++)
			sorted[place] = sorted[place + 1];
		median->drop_smallest = value > middle;
	} else {
		for (place = 4; place > 0 && sorted[place - 1] > value; place--)
			sorted[place] = sorted[place - 1];
		median->drop_smallest = value >= middle;
	}
	sorted[place] = value;
}

/* ------------------------------------------------------------------------------------ time */

/* Codes of a time after a difference is known: a multiple of it up to 500, then -1 to -10 times,
 * then these. */
enum { MULTIPLE_MAX = 500, CODE_SAME = 511, CODE_FAR = 512 };

static int32_t near_time(laz_time *t, laz_decoder *d, uint32_t context, int64_t prediction)
{
	return laz_near(d, &t->integer, &t->context[context], 32, (int32_t)(uint32_t)prediction);
}

static void add_difference(laz_time *t, int32_t difference)
{
	t->time[t->current] += (uint64_t)(int64_t)difference;
}

/* When extremes come four times in a row, the usual difference has changed. */
static void count_extreme(laz_time *t, int32_t difference)
{
	if (++t->extreme[t->current] > 3) {
		t->difference[t->current] = difference;
		t->extreme[t->current] = 0;
	}
}

/* A time far from all sequences starts one in place of the oldest. */
static void take_far(laz_time *t, laz_decoder *d)
{
	uint32_t high = (uint32_t)near_time(t, d, 8, (int64_t)(t->time[t->current] >> 32));
	t->newest = (t->newest + 1) & 3;
	t->current = t->newest;
	t->time[t->current] = (uint64_t)high << 32 | laz_bits(d, 32);
	t->difference[t->current] = 0;
	t->extreme[t->current] = 0;
}

static void take_multiple(laz_time *t, laz_decoder *d, uint32_t code)
{
	int64_t last = t->difference[t->current];
	if (code == 1) {
		add_difference(t, near_time(t, d, 1, last));
		t->extreme[t->current] = 0;
		return;
	}
	int64_t factor = code <= MULTIPLE_MAX ? (int64_t)code : MULTIPLE_MAX - (int64_t)code;
	uint32_t context = code == 0              ? 7
					   : code < 10            ? 2
					   : code < MULTIPLE_MAX  ? 3
					   : code == MULTIPLE_MAX ? 4
					   : factor > -10         ? 5
											  : 6;
	int32_t difference = near_time(t, d, context, factor * last);
	if (context == 7 || context == 4 || context == 6)
		count_extreme(t, difference);
	add_difference(t, difference);
}

/* One code. Returns false when it only chose another sequence. */
static bool take_code(laz_time *t, laz_decoder *d, bool layered)
{
	/* Layered streams say elsewhere that a time is the same, and lack that code. */
	uint32_t lacks = layered, current = t->current, code;
	if (t->difference[current] == 0) {
		code = laz_symbol(d, &t->start, 6 - lacks) + lacks;
		if (code == 1) {
			t->difference[current] = near_time(t, d, 0, 0);
			add_difference(t, t->difference[current]);
			t->extreme[current] = 0;
		} else if (code == 2) {
			take_far(t, d);
		} else if (code > 2) {
			t->current = (current + code - 2) & 3;
		}
		return code <= 2;
	}
	code = laz_symbol(d, &t->multiple, 516 - lacks);
	code += code >= CODE_SAME ? lacks : 0;
	if (code < CODE_SAME)
		take_multiple(t, d, code);
	else if (code == CODE_FAR)
		take_far(t, d);
	else if (code > CODE_FAR)
		t->current = (current + code - CODE_FAR) & 3;
	return code <= CODE_FAR;
}

void laz_time_next(laz_time *t, laz_decoder *d, bool layered, uint8_t *item)
{
	/* Coders choose a sequence at most once a point. */
	bool taken = take_code(t, d, layered) || take_code(t, d, layered) || take_code(t, d, layered);
	d->failed = d->failed || !taken;
	store_64(item, t->time[t->current]);
}

void laz_time_next_1(laz_time *t, laz_decoder *d, uint8_t *item)
{
	int64_t last = t->difference[0];
	if (last == 0) {
		uint32_t code = laz_symbol(d, &t->start, 3);
		if (code == 1) {
			t->difference[0] = near_time(t, d, 0, 0);
			add_difference(t, t->difference[0]);
		} else if (code == 2) {
			t->time[0] = laz_bits_64(d);
		}
		store_64(item, t->time[0]);
		return;
	}
	uint32_t code = laz_symbol(d, &t->multiple, 512);
	if (code == 510) {
		t->time[0] = laz_bits_64(d);
	} else if (code == 1) {
		t->difference[0] = near_time(t, d, 1, last);
		add_difference(t, t->difference[0]);
		t->extreme[0] = 0;
	} else if (code < 510) {
		uint32_t context = code == 0 ? 2 : code < 10 ? 3 : code < 50 ? 4 : 5;
		int32_t difference = near_time(t, d, context, code == 0 ? last / 4 : code * last);
		if (code == 0 || code == 509)
			count_extreme(t, difference);
		add_difference(t, difference);
	}
	store_64(item, t->time[0]);
}

/* ---------------------------------------------------------------------------------- colours */

static uint8_t clamp(int value)
{
	return value < 0 ? 0 : value > 255 ? 255 : (uint8_t)value;
}

/* Low and high bytes apart: what changed in red is expected of green, and both of blue. */
void laz_color_next(laz_color *color, laz_decoder *d, uint8_t *item)
{
	uint8_t last[6];
	memcpy(last, item, sizeof last);
	uint32_t used = laz_symbol(d, &color->used, 128);
	for (uint32_t b = 0; b < 2; b++)
		if (used & 1u << b)
			item[b] = (uint8_t)(last[b] + laz_symbol(d, &color->byte[b], 256));
	if (!(used & 64)) {
		memcpy(item + 2, item, 2);
		memcpy(item + 4, item, 2);
		return;
	}
	for (uint32_t b = 0; b < 2; b++) {
		int change = item[b] - last[b];
		if (used & 4u << b)
			item[2 + b] =
				(uint8_t)(clamp(last[2 + b] + change) + laz_symbol(d, &color->byte[2 + b], 256));
		if (used & 16u << b) {
			change = (change + item[2 + b] - last[2 + b]) / 2;
			item[4 + b] =
				(uint8_t)(clamp(last[4 + b] + change) + laz_symbol(d, &color->byte[4 + b], 256));
		}
	}
}

void laz_color_next_1(laz_color *color, laz_decoder *d, uint8_t *item)
{
	uint32_t used = laz_symbol(d, &color->used, 64);
	for (uint32_t b = 0; b < 6; b++)
		if (used & 1u << b)
			item[b] = (uint8_t)laz_near(d, &color->integer, &color->byte[b], 8, item[b]);
}

void laz_infrared_next(laz_infrared *infrared, laz_decoder *d, uint8_t *item)
{
	uint32_t used = laz_symbol(d, &infrared->used, 4);
	for (uint32_t b = 0; b < 2; b++)
		if (used & 1u << b)
			item[b] = (uint8_t)(item[b] + laz_symbol(d, &infrared->byte[b], 256));
}

/* -------------------------------------------------------------------------------- waveforms */

static void near_32(laz_decoder *d, laz_integer *integer, laz_model **context, uint8_t *place)
{
	store_32(place, (uint32_t)laz_near(d, integer, context, 32, (int32_t)load_32(place)));
}

void laz_wave_next(laz_wave *w, laz_decoder *d, uint8_t *item)
{
	uint64_t offset = load_64(item + 1);
	item[0] = (uint8_t)laz_symbol(d, &w->index, 256);
	w->kind = laz_symbol(d, &w->next_kind[w->kind], 4);
	if (w->kind == 1) {
		offset += load_32(item + 9);
	} else if (w->kind == 2) {
		w->difference = laz_near(d, &w->offset, &w->offset_context, 32, w->difference);
		offset += (uint64_t)(int64_t)w->difference;
	} else if (w->kind == 3) {
		offset = laz_bits_64(d);
	}
	store_64(item + 1, offset);
	near_32(d, &w->size, &w->size_context, item + 9);
	near_32(d, &w->point, &w->point_context, item + 13);
	for (size_t k = 0; k < 3; k++)
		near_32(d, &w->direction, &w->direction_context[k], item + 17 + 4 * k);
}
