/* e57_source.c - see e57_source.h. */
#include "e57/e57_source.h"

#include "glowworm_host.h"

#include <stdlib.h>
#include <string.h>

/* Records that a thread unpacks in one go. */
#define BLOCK_RECORDS ((size_t)1 << 14)

/* A packet says its length less one in two bytes. */
#define PACKET_MOST ((size_t)1 << 16)

/* Bytes behind those of a field that unpacking a value may touch. */
#define SPARE 16u

gw_status e57_source_fail(const e57_pages *pages, size_t index, const char *what, gw_error *error)
{
	return gw_fail(error, GW_ERROR_DATA, "%s: scan %zu %s; the file is damaged", pages->in->name,
				   index + 1, what);
}

static gw_status fail_memory(const e57_source *s, gw_error *error)
{
	return gw_fail(error, GW_ERROR_MEMORY, "no memory for the points of %s", s->pages->in->name);
}

/* -------------------------------------------------------------------------------- packets */

/* A packet of data: a head, lengths of its fields' stretches, 2 bytes each, and the stretches. */
typedef struct packet {
	size_t begin, size; /* of all of it, in the pages */
} packet;

/* Whether a packet's head and the lengths of its fields, of `size` bytes in all, make sense. */
static bool makes_sense(const e57_source *s, const packet *p, size_t size)
{
	size_t fields = s->scan->field_count, sum = 6 + 2 * fields;
	uint8_t *head = s->packet;
	if (size < sum)
		return false;
	e57_pages_copy(s->pages, p->begin, 6 + 2 * fields, head);
	if (e57_load(head + 4, 2) != fields)
		return false;
	for (size_t f = 0; f < fields; f++)
		sum += (size_t)e57_load(head + 6 + 2 * f, 2);
	return sum <= size;
}

/*
 * Takes the next packet that holds data; *at moves behind it, and its head and lengths are in
 * s->packet. False at the end or when it is damaged, and then *at is before s->end.
 */
static bool next_packet(const e57_source *s, size_t *at, packet *p)
{
	enum { INDEX, DATA, EMPTY };
	while (s->end - *at >= 4) {
		uint8_t head[4];
		e57_pages_copy(s->pages, *at, sizeof head, head);
		size_t size = (size_t)e57_load(head + 2, 2) + 1;
		if (head[0] > EMPTY || size > s->end - *at || size < 4)
			return false;
		*p = (packet){ .begin = *at, .size = size };
		if (head[0] == DATA && !makes_sense(s, p, size))
			return false;
		*at += size;
		if (head[0] == DATA)
			return true;
	}
	*at = s->end;
	return false;
}

/* Finds the packets and counts the bytes of each field. */
static gw_status find_packets(e57_source *s, gw_error *error)
{
	size_t section, at, count = s->scan->field_count;
	uint8_t head[32];
	packet p;
	if (!e57_pages_locate(s->pages, s->scan->offset, &section) ||
		s->pages->length - section < sizeof head)
		return e57_source_fail(s->pages, s->index, "has records beyond the end", error);
	e57_pages_copy(s->pages, section, sizeof head, head);
	uint64_t length = e57_load(head + 8, 8);
	if (head[0] != 1 || length > s->pages->length - section ||
		!e57_pages_locate(s->pages, e57_load(head + 16, 8), &s->next) || s->next < section ||
		s->next > section + length)
		return e57_source_fail(s->pages, s->index,
							   "has a section of records whose header makes no sense", error);
	s->end = section + (size_t)length;
	for (at = s->next; next_packet(s, &at, &p);)
		for (size_t f = 0; f < count; f++)
			s->bytes[f] += e57_load(s->packet + 6 + 2 * f, 2);
	return at == s->end
			   ? GW_OK
			   : e57_source_fail(s->pages, s->index, "has a packet that makes no sense", error);
}

/* Each record takes a bit or more, and every field has the bits that the records take. */
static gw_status check_count(const e57_source *s, gw_error *error)
{
	bool any = false;
	for (size_t f = 0; f < s->scan->field_count; f++) {
		const e57_field *field = &s->scan->field[f];
		uint64_t bits;
		if (field->type == E57_STRING)
			continue;
		any = any || field->bits > 0;
		if (__builtin_mul_overflow(s->scan->count, field->bits, &bits) ||
			bits / 8 + (bits % 8 != 0) > s->bytes[f])
			return gw_fail(error, GW_ERROR_DATA,
						   "%s: scan %zu has %llu records, but only %llu bytes of '%.40s', of %u "
						   "bits each; the file is damaged",
						   s->pages->in->name, s->index + 1, (unsigned long long)s->scan->count,
						   (unsigned long long)s->bytes[f], field->name, field->bits);
	}
	return any ? GW_OK
			   : e57_source_fail(s->pages, s->index, "has records without a single bit", error);
}

gw_status e57_source_open(e57_source *s, const e57_pages *pages, const e57_scan *scan, size_t index,
						  gw_error *error)
{
	size_t fields = scan->field_count;
	*s = (e57_source){ .pages = pages, .scan = scan, .index = index };
	s->bytes = calloc(fields + 1, sizeof *s->bytes);
	s->waiting = calloc(fields + 1, sizeof *s->waiting);
	s->packet = malloc((pages->length < PACKET_MOST ? pages->length : PACKET_MOST) + 1);
	if (!s->bytes || !s->waiting || !s->packet)
		return fail_memory(s, error);
	if (scan->count == 0)
		return GW_OK;
	GW_TRY(find_packets(s, error));
	return check_count(s, error);
}

void e57_source_clear(e57_source *s)
{
	for (size_t f = 0; s->waiting && f < s->scan->field_count; f++)
		free(s->waiting[f].bytes);
	free(s->waiting);
	free(s->bytes);
	free(s->packet);
	*s = (e57_source){ .pages = NULL };
}

/* -------------------------------------------------------------------------------- records */

/* Makes room for so many bytes of a field in all, and some more where it was too small. */
static gw_status make_room(const e57_source *s, e57_waiting *w, uint64_t length, gw_error *error)
{
	if (length + SPARE <= w->room)
		return GW_OK;
	size_t room = (size_t)length + SPARE + w->room / 2;
	uint8_t *grown = realloc(w->bytes, room);
	if (!grown)
		return fail_memory(s, error);
	w->bytes = grown;
	w->room = room;
	return GW_OK;
}

/* Forgets the records that were held. */
static void drop_held(e57_source *s)
{
	if (s->held == 0)
		return;
	for (size_t f = 0; f < s->scan->field_count; f++) {
		e57_waiting *w = &s->waiting[f];
		uint64_t bits = w->skip + (uint64_t)s->held * s->scan->field[f].bits;
		size_t gone = (size_t)(bits / 8);
		if (s->scan->field[f].type == E57_STRING || gone > w->length)
			continue;
		memmove(w->bytes, w->bytes + gone, w->length - gone);
		w->length -= gone;
		w->skip = (unsigned)(bits % 8);
	}
	s->held = 0;
}

/* Whether a field has the bytes of so many records. */
static bool has_bytes(const e57_source *s, size_t field, size_t records)
{
	const e57_waiting *w = &s->waiting[field];
	uint64_t bits = w->skip + (uint64_t)records * s->scan->field[field].bits;
	return s->scan->field[field].type == E57_STRING || bits / 8 + (bits % 8 != 0) <= w->length;
}

static bool have_bytes(const e57_source *s, size_t records)
{
	bool all = true;
	for (size_t f = 0; f < s->scan->field_count; f++)
		all = all && has_bytes(s, f, records);
	return all;
}

/* All packets made sense before. */
static gw_status fail_changed(const e57_source *s, gw_error *error)
{
	return e57_source_fail(s->pages, s->index, "is not what it was when it was opened", error);
}

/* Pages that only hold what was read take no memory any more. */
static void release(const e57_source *s, const packet *p)
{
	const uint8_t *data = s->pages->in->data;
	input_file_release(s->pages->in, data + p->begin / E57_CONTENT * E57_PAGE,
					   data + (p->begin + p->size) / E57_CONTENT * E57_PAGE);
}

/* Puts a packet's stretches behind those that wait. */
static gw_status take_packet(e57_source *s, const packet *p, gw_error *error)
{
	size_t fields = s->scan->field_count, at = 6 + 2 * fields;
	e57_pages_copy(s->pages, p->begin, p->size, s->packet);
	for (size_t f = 0; f < fields; f++) {
		e57_waiting *w = &s->waiting[f];
		size_t length = (size_t)e57_load(s->packet + 6 + 2 * f, 2);
		if (at + length > p->size)
			return fail_changed(s, error);
		if (s->scan->field[f].type != E57_STRING) {
			GW_TRY(make_room(s, w, w->length + length, error));
			memcpy(w->bytes + w->length, s->packet + at, length);
			w->length += length;
			memset(w->bytes + w->length, 0, SPARE);
		}
		at += length;
	}
	return GW_OK;
}

gw_status e57_source_take(e57_source *s, size_t wanted, gw_error *error)
{
	packet p;
	uint64_t left = s->scan->count - s->taken;
	size_t count = wanted < left ? wanted : (size_t)left;
	drop_held(s);
	for (size_t f = 0; f < s->scan->field_count; f++) {
		uint64_t bytes = (uint64_t)count * s->scan->field[f].bits / 8 + PACKET_MOST;
		GW_TRY(make_room(s, &s->waiting[f], bytes < s->bytes[f] ? bytes : s->bytes[f], error));
		memset(s->waiting[f].bytes + s->waiting[f].length, 0, SPARE);
	}
	while (!have_bytes(s, count)) {
		if (!next_packet(s, &s->next, &p))
			return fail_changed(s, error);
		GW_TRY(take_packet(s, &p, error));
		release(s, &p);
	}
	s->held = count;
	s->taken += count;
	return GW_OK;
}

/* -------------------------------------------------------------------------------- values */

typedef struct unpacking {
	const e57_waiting *from;
	const e57_field *field;
	double *to;
} unpacking;

static double unpack_value(const e57_field *f, const e57_waiting *w, size_t i)
{
	const uint8_t *bytes = w->bytes;
	if (f->type == E57_SINGLE) {
		uint32_t bits = (uint32_t)e57_load(bytes + 4 * i, 4);
		float value;
		memcpy(&value, &bits, sizeof value);
		return (double)value;
	}
	if (f->type == E57_DOUBLE) {
		uint64_t bits = e57_load(bytes + 8 * i, 8);
		double value;
		memcpy(&value, &bits, sizeof value);
		return value;
	}
	uint64_t bits = 0;
	if (f->bits > 0) {
		size_t place = w->skip + i * f->bits, shift = place % 8;
		bits = e57_load(bytes + place / 8, 8) >> shift;
		if (shift + f->bits > 64)
			bits |= (uint64_t)bytes[place / 8 + 8] << (64 - shift);
		bits &= UINT64_MAX >> (64 - f->bits);
	}
	double whole = (double)(int64_t)((uint64_t)f->minimum + bits);
	return f->type == E57_SCALED ? whole * f->scale + f->offset : whole;
}

static void unpack_values(void *user, size_t first, size_t last, uint32_t worker)
{
	(void)worker;
	const unpacking *u = user;
	for (size_t i = first; i < last; i++)
		u->to[i] = unpack_value(u->field, u->from, i);
}

void e57_source_unpack(const e57_source *s, size_t field, uint32_t threads, double *to)
{
	unpacking u = { &s->waiting[field], &s->scan->field[field], to };
	gw_parallel_for(threads, s->held, BLOCK_RECORDS, unpack_values, &u);
}
