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

static int32_t near_time(laz_time *t, laz_coder *c, uint32_t context, int64_t prediction,
						 int32_t value)
{
	return laz_near(c, &t->integer, &t->context[context], 32, (int32_t)(uint32_t)prediction, value);
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
static void code_far(laz_time *t, laz_coder *c, uint64_t next)
{
	int64_t before = (int64_t)(t->time[t->current] >> 32);
	uint32_t high = (uint32_t)near_time(t, c, 8, before, (int32_t)(uint32_t)(next >> 32));
	t->newest = (t->newest + 1) & 3;
	t->current = t->newest;
	t->time[t->current] = (uint64_t)high << 32 | laz_bits(c, 32, (uint32_t)next);
	t->difference[t->current] = 0;
	t->extreme[t->current] = 0;
}

/* change: the difference to be */
static void code_multiple(laz_time *t, laz_coder *c, uint32_t code, int32_t change)
{
	int64_t last = t->difference[t->current];
	if (code == 1) {
		add_difference(t, near_time(t, c, 1, last, change));
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
	int32_t difference = near_time(t, c, context, factor * last, change);
	if (context == 7 || context == 4 || context == 6)
		count_extreme(t, difference);
	add_difference(t, difference);
}

/* Whether a time is as near to a sequence's last one as 32 bits can say. */
static bool is_near(const laz_time *t, uint32_t sequence, uint64_t next)
{
	int64_t change = (int64_t)(next - t->time[sequence]);
	return change >= INT32_MIN && change <= INT32_MAX;
}

/* The code for a time which is `near` or not: the nearest multiple, else a sequence to which it is
 * near, else that it is far. The last two are counted from `far` on. */
static uint32_t choose_code(const laz_time *t, uint64_t next, bool layered, uint32_t far)
{
	uint64_t last = t->time[t->current];
	int32_t usual = t->difference[t->current];
	if (next == last && !layered)
		return usual == 0 ? 0 : CODE_SAME;
	for (uint32_t i = 1; !is_near(t, t->current, next) && i < 4; i++)
		if (is_near(t, (t->current + i) & 3, next))
			return far + i;
	if (!is_near(t, t->current, next))
		return far;
	if (usual == 0)
		return 1;
	float ratio = (float)(int32_t)(next - last) / (float)usual;
	if (ratio >= 0.0f)
		return ratio < (float)MULTIPLE_MAX ? (uint32_t)(ratio + 0.5f) : MULTIPLE_MAX;
	uint32_t negative = ratio > -10.0f ? (uint32_t)(0.5f - ratio) : 10;
	return negative ? MULTIPLE_MAX + negative : 0;
}

/* One code. Returns false when it only chose another sequence. */
static bool code_step(laz_time *t, laz_coder *c, bool layered, uint64_t next)
{
	/* Layered streams say elsewhere that a time is the same, and lack that code. */
	uint32_t lacks = layered, current = t->current, far = t->difference[current] ? CODE_FAR : 2;
	uint32_t code = c->encodes ? choose_code(t, next, layered, far) : lacks;
	int32_t change = (int32_t)(uint32_t)(next - t->time[current]);
	if (t->difference[current] == 0) {
		code = laz_symbol(c, &t->start, 6 - lacks, code - lacks) + lacks;
		if (code == 1) {
			t->difference[current] = near_time(t, c, 0, 0, change);
			add_difference(t, t->difference[current]);
			t->extreme[current] = 0;
		}
	} else {
		code = laz_symbol(c, &t->multiple, 516 - lacks, code - (code > CODE_SAME ? lacks : 0));
		code += code >= CODE_SAME ? lacks : 0;
		if (code < CODE_SAME)
			code_multiple(t, c, code, change);
	}
	if (code == far)
		code_far(t, c, next);
	else if (code > far)
		t->current = (current + code - far) & 3;
	return code <= far;
}

void laz_time_next(laz_time *t, laz_coder *c, bool layered, uint8_t *item, const uint8_t *next)
{
	uint64_t time = load_64(next);
	/* Coders choose a sequence at most once a point. */
	bool taken = false;
	for (int step = 0; step < 3 && !taken; step++)
		taken = code_step(t, c, layered, time);
	c->failed = c->failed || !taken;
	store_64(item, t->time[t->current]);
}

void laz_time_next_1(laz_time *t, laz_coder *c, uint8_t *item)
{
	int64_t last = t->difference[0];
	if (last == 0) {
		uint32_t code = laz_symbol(c, &t->start, 3, 0);
		if (code == 1) {
			t->difference[0] = near_time(t, c, 0, 0, 0);
			add_difference(t, t->difference[0]);
		} else if (code == 2) {
			t->time[0] = laz_bits_64(c, 0);
		}
		store_64(item, t->time[0]);
		return;
	}
	uint32_t code = laz_symbol(c, &t->multiple, 512, 0);
	if (code == 510) {
		t->time[0] = laz_bits_64(c, 0);
	} else if (code == 1) {
		t->difference[0] = near_time(t, c, 1, last, 0);
		add_difference(t, t->difference[0]);
		t->extreme[0] = 0;
	} else if (code < 510) {
		uint32_t context = code == 0 ? 2 : code < 10 ? 3 : code < 50 ? 4 : 5;
		int32_t difference = near_time(t, c, context, code == 0 ? last / 4 : code * last, 0);
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

/* Bits of what is not as before: low and high byte of red, green, blue; and that of a point that
 * is not grey. */
static uint32_t color_changes(const uint8_t *last, const uint8_t *next)
{
	uint32_t used = 0;
	for (uint32_t b = 0; b < 6; b++)
		used |= (last[b] != next[b] ? 1u : 0u) << b;
	bool gray = memcmp(next, next + 2, 2) == 0 && memcmp(next, next + 4, 2) == 0;
	return used | (gray ? 0 : 64);
}

/* Low and high bytes apart: what changed in red is expected of green, and both of blue. */
void laz_color_next(laz_color *color, laz_coder *c, uint8_t *item, const uint8_t *next)
{
	uint8_t last[6];
	memcpy(last, item, sizeof last);
	uint32_t used = laz_symbol(c, &color->used, 128, color_changes(last, next));
	for (uint32_t b = 0; b < 2; b++)
		if (used & 1u << b)
			item[b] = laz_byte_near(c, &color->byte[b], last[b], next[b]);
	if (!(used & 64)) {
		memcpy(item + 2, item, 2);
		memcpy(item + 4, item, 2);
		return;
	}
	for (uint32_t b = 0; b < 2; b++) {
		int change = item[b] - last[b];
		if (used & 4u << b)
			item[2 + b] =
				laz_byte_near(c, &color->byte[2 + b], clamp(last[2 + b] + change), next[2 + b]);
		if (used & 16u << b) {
			change = (change + item[2 + b] - last[2 + b]) / 2;
			item[4 + b] =
				laz_byte_near(c, &color->byte[4 + b], clamp(last[4 + b] + change), next[4 + b]);
		}
	}
}

void laz_color_next_1(laz_color *color, laz_coder *c, uint8_t *item)
{
	uint32_t used = laz_symbol(c, &color->used, 64, 0);
	for (uint32_t b = 0; b < 6; b++)
		if (used & 1u << b)
			item[b] = (uint8_t)laz_near(c, &color->integer, &color->byte[b], 8, item[b], 0);
}

void laz_infrared_next(laz_infrared *infrared, laz_coder *c, uint8_t *item, const uint8_t *next)
{
	uint32_t changes = (item[0] != next[0] ? 1 : 0) | (item[1] != next[1] ? 2 : 0);
	uint32_t used = laz_symbol(c, &infrared->used, 4, changes);
	for (uint32_t b = 0; b < 2; b++)
		if (used & 1u << b)
			item[b] = laz_byte_near(c, &infrared->byte[b], item[b], next[b]);
}

/* -------------------------------------------------------------------------------- waveforms */

static void near_32(laz_coder *c, laz_integer *integer, laz_model **context, uint8_t *place,
					const uint8_t *next)
{
	int32_t value = (int32_t)load_32(next);
	store_32(place, (uint32_t)laz_near(c, integer, context, 32, (int32_t)load_32(place), value));
}

/* Where the next packet is: as before, behind the last packet, near, anywhere. */
static uint32_t offset_kind(const uint8_t *item, const uint8_t *next)
{
	int64_t change = (int64_t)(load_64(next + 1) - load_64(item + 1));
	if (change < INT32_MIN || change > INT32_MAX)
		return 3;
	return change == 0 ? 0 : change == (int32_t)load_32(item + 9) ? 1 : 2;
}

void laz_wave_next(laz_wave *w, laz_coder *c, uint8_t *item, const uint8_t *next)
{
	uint64_t offset = load_64(item + 1), wanted = load_64(next + 1);
	uint32_t kind = offset_kind(item, next);
	item[0] = (uint8_t)laz_symbol(c, &w->index, 256, next[0]);
	w->kind = laz_symbol(c, &w->next_kind[w->kind], 4, kind);
	if (w->kind == 1) {
		offset += load_32(item + 9);
	} else if (w->kind == 2) {
		int32_t change = (int32_t)(uint32_t)(wanted - offset);
		w->difference = laz_near(c, &w->offset, &w->offset_context, 32, w->difference, change);
		offset += (uint64_t)(int64_t)w->difference;
	} else if (w->kind == 3) {
		offset = laz_bits_64(c, wanted);
	}
	store_64(item + 1, offset);
	near_32(c, &w->size, &w->size_context, item + 9, next + 9);
	near_32(c, &w->point, &w->point_context, item + 13, next + 13);
	for (size_t k = 0; k < 3; k++)
		near_32(c, &w->direction, &w->direction_context[k], item + 17 + 4 * k, next + 17 + 4 * k);
}
