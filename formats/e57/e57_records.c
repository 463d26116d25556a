/* e57_records.c - see e57_records.h. */
#include "e57/e57_records.h"

#include "files/little_endian.h"

#include <math.h>
#include <string.h>

/* ------------------------------------------------------------------------------- values */

static double real_value(const e57_out_scan *s, const e57_out_field *f, size_t p)
{
	double value = scan_value(f->column, p);
	if (f->source != E57_OF_POSITION)
		return value;
	if (!isfinite(value))
		return 0.0;
	return s->place ? e57_layout_local(value, s->place[f->axis]) : value;
}

static int64_t whole_value(const e57_layout *l, const e57_out_scan *s, const e57_out_field *f,
						   size_t p)
{
	switch (f->source) {
	case E57_OF_STATE:
		return e57_layout_is_finite(s, p) ? 0 : 2;
	case E57_OF_ROW:
		return l->cloud->image_cell[p] / s->image->columns;
	case E57_OF_CELL_COLUMN:
		return l->cloud->image_cell[p] % s->image->columns;
	case E57_OF_COLUMN:
	case E57_OF_POSITION:
		break;
	}
	return (int64_t)scan_value(f->column, p);
}

static void store_real(uint8_t *to, double value, e57_type type)
{
	uint32_t few;
	float single = (float)value;
	memcpy(&few, &single, sizeof few);
	if (type == E57_SINGLE)
		store_32(to, few);
	else
		store_double(to, value);
}

/* Bytes of a value in a row. Integers take 32 bits at most, as the columns have. */
static size_t value_bytes(const e57_out_field *f)
{
	return f->field.type == E57_DOUBLE ? 8 : 4;
}

/* ------------------------------------------------------------------------------- stretches */

/* Integers each in its bits, the lowest first. */
typedef struct packer {
	uint8_t *to;
	uint64_t kept;
	unsigned used;
} packer;

static void pack(packer *p, uint64_t value, unsigned bits)
{
	/* Not more than 32 bits, so that 7 more have room. */
	p->kept |= value << p->used;
	for (p->used += bits; p->used >= 8; p->used -= 8, p->kept >>= 8)
		*p->to++ = (uint8_t)p->kept;
}

static void pack_rest(packer *p)
{
	if (p->used > 0)
		*p->to = (uint8_t)p->kept;
}

void e57_records_stretch(const e57_layout *layout, const e57_out_scan *s, const e57_out_field *f,
						 size_t first, size_t count, uint8_t *to)
{
	packer packed = { .to = to };
	size_t size = f->field.bits / 8;
	for (size_t i = first; i < first + count; i++) {
		size_t p = e57_layout_point(layout, s, i);
		if (f->field.type != E57_INTEGER)
			store_real(to + (i - first) * size, real_value(s, f, p), f->field.type);
		else if (f->field.bits > 0)
			pack(&packed, (uint64_t)whole_value(layout, s, f, p) - (uint64_t)f->field.minimum,
				 f->field.bits);
	}
	pack_rest(&packed);
}

/* ------------------------------------------------------------------------------- rows */

size_t e57_records_row(const e57_out_scan *s)
{
	size_t bytes = 0;
	for (size_t f = 0; f < s->field_count; f++)
		bytes += value_bytes(&s->field[f]);
	return bytes;
}

/* Where in a row a field's value stands. */
static size_t place_of(const e57_out_scan *s, const e57_out_field *f)
{
	size_t at = 0;
	for (const e57_out_field *before = s->field; before < f; before++)
		at += value_bytes(before);
	return at;
}

void e57_records_rows(const e57_layout *layout, const e57_out_scan *s, size_t first, size_t count,
					  uint8_t *rows)
{
	size_t row = e57_records_row(s);
	for (const e57_out_field *f = s->field; f < s->field + s->field_count; f++) {
		uint8_t *to = rows + place_of(s, f);
		for (size_t i = first; i < first + count; i++, to += row) {
			size_t p = e57_layout_point(layout, s, i);
			if (f->field.type == E57_INTEGER)
				store_32(to, (uint32_t)((uint64_t)whole_value(layout, s, f, p) -
										(uint64_t)f->field.minimum));
			else
				store_real(to, real_value(s, f, p), f->field.type);
		}
	}
}

void e57_rows_stretch(const e57_out_scan *s, const e57_out_field *f, const uint8_t *rows,
					  size_t count, uint8_t *to)
{
	packer packed = { .to = to };
	size_t row = e57_records_row(s), size = value_bytes(f);
	const uint8_t *from = rows + place_of(s, f);
	for (size_t i = 0; i < count; i++, from += row)
		if (f->field.type != E57_INTEGER)
			memcpy(to + i * size, from, size);
		else if (f->field.bits > 0)
			pack(&packed, load_32(from), f->field.bits);
	pack_rest(&packed);
}

static double load_real(const uint8_t *from, e57_type type)
{
	float single;
	uint32_t bits = load_32(from);
	memcpy(&single, &bits, sizeof single);
	return type == E57_SINGLE ? (double)single : load_double(from);
}

void e57_rows_limits(e57_out_scan *s, const uint8_t *rows, size_t count)
{
	size_t row = e57_records_row(s), state = SIZE_MAX;
	for (const e57_out_field *f = s->field; f < s->field + s->field_count; f++)
		state = f->source == E57_OF_STATE ? place_of(s, f) : state;
	for (e57_out_field *f = s->field; f < s->field + s->field_count; f++) {
		const uint8_t *from = rows + place_of(s, f);
		for (size_t i = 0; i < count && f->field.type != E57_INTEGER; i++) {
			bool none = state != SIZE_MAX && load_32(rows + i * row + state) != 0;
			double value = load_real(from + i * row, f->field.type);
			if (!isfinite(value) || (none && f->source == E57_OF_POSITION))
				continue;
			f->low = fmin(f->low, value);
			f->high = fmax(f->high, value);
		}
	}
}
