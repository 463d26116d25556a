#include "text/text_rows.h"
#include "glowworm_host.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Long enough that threads have something to do, short enough that they end together. */
#define CHUNK_BYTES ((size_t)1 << 20)

/* Bytes at the start of a text that tell how its lines end. */
#define HEAD_BYTES (1 << 16)

/* --------------------------------------------------------------------------------- lines */

static inline bool is_blank(char c)
{
	static const bool blank[256] = {
		[' '] = true, ['\t'] = true, ['\r'] = true, ['"'] = true, ['\v'] = true, ['\f'] = true
	};
	return blank[(unsigned char)c];
}

static inline const char *skip_blanks(const char *at, const char *end)
{
	while (at < end && is_blank(*at))
		at++;
	return at;
}

const char *text_rows_begin(const uint8_t *data, size_t length)
{
	bool marked = length >= 3 && memcmp(data, "\xef\xbb\xbf", 3) == 0;
	return (const char *)data + (marked ? 3 : 0);
}

char text_rows_newline(const char *text, const char *end)
{
	size_t length = end - text < HEAD_BYTES ? (size_t)(end - text) : HEAD_BYTES;
	const char *first = memchr(text, '\r', length);
	return first && !memchr(text, '\n', length) ? '\r' : '\n';
}

char text_rows_separator(const char *line, size_t length)
{
	return memchr(line, ';', length) ? ';' : memchr(line, ',', length) ? ',' : ' ';
}

bool text_rows_next_line(const char **at, const char *end, char newline, const char **line,
						 size_t *length)
{
	if (*at >= end)
		return false;
	const char *stop = memchr(*at, newline, (size_t)(end - *at));
	*line = *at;
	*length = (size_t)((stop ? stop : end) - *at);
	*at = stop ? stop + 1 : end;
	return true;
}

bool text_rows_is_empty(const char *line, size_t length)
{
	const char *end = line + length, *at = skip_blanks(line, end);
	return at == end || *at == '#' || (*at == '/' && end - at > 1 && at[1] == '/');
}

/* Steps over one value that is zero, however it is written. NULL when it is not. */
static const char *skip_zero(const char *at, const char *end)
{
	bool digit = false;
	at = skip_blanks(at, end);
	if (at < end && (*at == '-' || *at == '+'))
		at++;
	for (; at < end && (*at == '0' || *at == '.'); at++)
		digit = digit || *at == '0';
	if (at < end && (*at == 'e' || *at == 'E')) {
		at++;
		while (at < end && (*at == '-' || *at == '+' || (*at >= '0' && *at <= '9')))
			at++;
	}
	return digit && (at == end || is_blank(*at)) ? at : NULL;
}

static bool is_origin(const char *line, const char *end)
{
	for (int k = 0; k < 3 && line; k++)
		line = skip_zero(line, end);
	return line != NULL;
}

static bool is_single(const char *line, const char *end)
{
	line = skip_blanks(line, end);
	while (line < end && !is_blank(*line))
		line++;
	return skip_blanks(line, end) == end;
}

/* Steps over what parts two values; false when there is something else. */
static inline bool skip_separator(const text_rows *rows, const char **at, const char *end)
{
	const char *after = skip_blanks(*at, end);
	bool parted = after > *at || after == end;
	if (rows->separator != ' ') {
		parted = after == end || *after == rows->separator;
		after += after < end && parted;
	}
	if (parted)
		*at = after;
	return parted;
}

/* Values that no column wants need not be numbers. */
static void skip_word(const text_rows *rows, const char **at, const char *end)
{
	while (*at < end && (rows->separator == ' ' ? !is_blank(**at) : **at != rows->separator))
		++*at;
}

/* How often a character is in a text; eight of them in one go. */
static size_t count_character(const char *at, const char *end, char c)
{
	const uint64_t ones = 0x0101010101010101u, low = 0x7f7f7f7f7f7f7f7fu;
	size_t count = 0;
	for (; end - at >= 8; at += 8) {
		uint64_t x;
		memcpy(&x, at, sizeof x);
		x ^= ones * (unsigned char)c; /* a byte that was c is 0 now, and no other is */
		count += (~(((x & low) + low) | x | low) >> 7) * ones >> 56;
	}
	for (; at < end; at++)
		count += *at == c;
	return count;
}

static bool is_long(const text_rows *rows, const char *line, const char *end)
{
	if (rows->separator != ' ' && count_character(line, end, rows->separator) < rows->width)
		return false;
	line = skip_blanks(line, end);
	for (size_t i = 0; i < rows->width && line < end; i++) {
		skip_word(rows, &line, end);
		skip_separator(rows, &line, end);
		line = skip_blanks(line, end);
	}
	return line < end;
}

typedef enum line_kind { LINE_EMPTY, LINE_SKIPPED, LINE_ROW } line_kind;

static line_kind kind_of(const text_rows *rows, const char *line, size_t length)
{
	if (text_rows_is_empty(line, length))
		return LINE_EMPTY;
	bool skipped = (rows->skip == TEXT_ROWS_SKIP_ORIGIN && is_origin(line, line + length)) ||
				   (rows->skip == TEXT_ROWS_SKIP_SINGLE && is_single(line, line + length)) ||
				   (rows->skip == TEXT_ROWS_SKIP_LONG && is_long(rows, line, line + length));
	return skipped ? LINE_SKIPPED : LINE_ROW;
}

bool text_rows_first(const text_rows *rows, const char **line, size_t *length)
{
	const char *at = rows->begin;
	while (text_rows_next_line(&at, rows->end, rows->newline, line, length))
		if (kind_of(rows, *line, *length) == LINE_ROW)
			return true;
	return false;
}

/* ------------------------------------------------------------------------------- first pass */

/* Offset of the first line that begins in chunk i or later. */
static size_t chunk_begin(const text_rows *rows, size_t i)
{
	size_t length = (size_t)(rows->end - rows->begin), at = i * CHUNK_BYTES;
	if (i == 0 || at >= length)
		return i == 0 ? 0 : length;
	const char *stop = memchr(rows->begin + at - 1, rows->newline, length - at + 1);
	return stop ? (size_t)(stop - rows->begin) + 1 : length;
}

/* Counts into the chunk itself; the sums come later. */
static void count_chunks(void *user, size_t first, size_t last, uint32_t worker)
{
	(void)worker;
	const text_rows *rows = user;
	for (size_t i = first; i < last; i++) {
		text_chunk *chunk = &rows->chunk[i];
		*chunk = (text_chunk){ .begin = chunk_begin(rows, i) };
		const char *at = rows->begin + chunk->begin, *line;
		const char *stop = rows->begin + chunk_begin(rows, i + 1);
		size_t length;
		while (text_rows_next_line(&at, stop, rows->newline, &line, &length)) {
			line_kind kind = kind_of(rows, line, length);
			chunk->row += kind == LINE_ROW;
			chunk->skipped += kind == LINE_SKIPPED;
			chunk->line++;
		}
		input_file_release(rows->in, rows->begin + chunk->begin, stop);
	}
}

gw_status text_rows_count(text_rows *rows, gw_error *error)
{
	size_t length = (size_t)(rows->end - rows->begin);
	rows->chunk_count = length / CHUNK_BYTES + 1;
	rows->chunk = calloc(rows->chunk_count + 1, sizeof *rows->chunk);
	if (!rows->chunk) {
		text_rows_clear(rows);
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to read %s", rows->in->name);
	}
	gw_parallel_for(rows->in->threads, rows->chunk_count, 1, count_chunks, rows);
	size_t row = 0, line = 0;
	rows->skipped = 0;
	for (size_t i = 0; i < rows->chunk_count; i++) {
		text_chunk own = rows->chunk[i];
		rows->chunk[i].row = row;
		rows->chunk[i].line = line;
		rows->chunk[i].cell = row + rows->skipped;
		row += own.row;
		line += own.line;
		rows->skipped += own.skipped;
	}
	rows->chunk[rows->chunk_count] = (text_chunk){ .begin = length, .row = row, .line = line };
	rows->count = row;
	return GW_OK;
}

void text_rows_clear(text_rows *rows)
{
	free(rows->chunk);
	rows->chunk = NULL;
	rows->chunk_count = rows->count = rows->skipped = 0;
}

/* ------------------------------------------------------------------------------ second pass */

typedef enum fault { FAULT_NONE, FAULT_MISSING, FAULT_NUMBER, FAULT_RANGE, FAULT_MORE } fault;

/* Where reading a row stopped. */
typedef struct place {
	const char *at;
	size_t column;
} place;

typedef struct reading {
	const text_rows *rows;
	text_column *column;
	atomic_size_t bad; /* the first chunk with a fault */
} reading;

static bool store_integer(const text_column *column, size_t row, double value)
{
	static const double limit[SCAN_TYPE_COUNT][2] = {
		[SCAN_INT8] = { INT8_MIN, INT8_MAX },    [SCAN_UINT8] = { 0, UINT8_MAX },
		[SCAN_INT16] = { INT16_MIN, INT16_MAX }, [SCAN_UINT16] = { 0, UINT16_MAX },
		[SCAN_INT32] = { INT32_MIN, INT32_MAX }, [SCAN_UINT32] = { 0, UINT32_MAX },
	};
	if (!(value >= limit[column->type][0] && value <= limit[column->type][1]) ||
		value != trunc(value))
		return false;
	scan_store(&(scan_column){ .type = column->type, .data = column->data }, row, value);
	return true;
}

/* Doubles are kept with how they were written, because their column may become a smaller type. */
static inline size_t take_double(text_column *column, size_t row, const char *at, size_t length)
{
	double *to = (double *)column->data + row;
	bool whole = atomic_load_explicit(&column->whole, memory_order_relaxed);
	bool single = atomic_load_explicit(&column->single, memory_order_relaxed);
	if (!whole && !single)
		return number_read(at, length, to);
	number_form form = { 0 };
	size_t used = number_read_form(at, length, to, &form);
	if (used && whole && !form.whole)
		atomic_store_explicit(&column->whole, false, memory_order_relaxed);
	if (used && single && !form.single)
		atomic_store_explicit(&column->single, false, memory_order_relaxed);
	return used;
}

/* end: of the whole text, as no number reaches over the end of a line. */
static inline fault take_value(text_column *column, size_t row, const char **at, const char *end)
{
	size_t length = (size_t)(end - *at), used;
	double value = 0.0;
	fault found = FAULT_NONE;
	if (!column->data) {
		used = number_read(*at, length, &value);
	} else if (column->type == SCAN_FLOAT64) {
		used = take_double(column, row, *at, length);
	} else if (column->type == SCAN_FLOAT32) {
		used = number_read_float(*at, length, (float *)column->data + row);
	} else {
		used = number_read(*at, length, &value);
		found = used && !store_integer(column, row, value) ? FAULT_RANGE : FAULT_NONE;
	}
	if (!used)
		return FAULT_NUMBER;
	if (found == FAULT_NONE)
		*at += used;
	return found;
}

/* Nothing between two separators. */
static fault take_nothing(text_column *column, size_t row)
{
	if (!column->data)
		return FAULT_NONE;
	if (column->type == SCAN_FLOAT64) {
		((double *)column->data)[row] = NAN;
		atomic_store_explicit(&column->whole, false, memory_order_relaxed);
	} else if (column->type == SCAN_FLOAT32) {
		((float *)column->data)[row] = NAN;
	} else {
		return FAULT_RANGE;
	}
	return FAULT_NONE;
}

/* Values parted by blanks alone, which is the usual case. */
static fault take_plain_row(const text_rows *rows, text_column *column, size_t row, const char *end,
							place *p)
{
	p->at = skip_blanks(p->at, end);
	for (p->column = 0; p->column < rows->width; p->column++) {
		text_column *to = &column[p->column];
		fault found = FAULT_NONE;
		if (p->at == end)
			return FAULT_MISSING;
		if (!to->data)
			skip_word(rows, &p->at, end);
		else
			found = take_value(to, row, &p->at, rows->end);
		if (found == FAULT_NONE && p->at < end && !is_blank(*p->at))
			found = FAULT_NUMBER;
		if (found != FAULT_NONE)
			return found;
		p->at = skip_blanks(p->at, end);
	}
	return p->at < end && !rows->open ? FAULT_MORE : FAULT_NONE;
}

static fault take_row(const text_rows *rows, text_column *column, size_t row, const char *end,
					  place *p)
{
	if (rows->separator == ' ')
		return take_plain_row(rows, column, row, end, p);
	p->at = skip_blanks(p->at, end);
	for (p->column = 0; p->column < rows->width; p->column++) {
		text_column *to = &column[p->column];
		bool last = p->column > 0 && p->column + 1 == rows->width;
		bool nothing = last && rows->separator != ' ' && p->at[-1] == rows->separator;
		if (p->at == end && !nothing)
			return FAULT_MISSING;
		fault found = FAULT_NONE;
		if (p->at == end || *p->at == rows->separator)
			found = take_nothing(to, row);
		else if (!to->data)
			skip_word(rows, &p->at, end);
		else
			found = take_value(to, row, &p->at, rows->end);
		if (found != FAULT_NONE)
			return found;
		const char *before = p->at;
		if (!skip_separator(rows, &p->at, end))
			return FAULT_NUMBER;
		/* Behind a separator, blanks belong to the next value. */
		p->at = p->at > before ? skip_blanks(p->at, end) : p->at;
	}
	return p->at < end && !rows->open ? FAULT_MORE : FAULT_NONE;
}

/* Reads one chunk up to the first fault; *line becomes the number of the last line taken. */
static fault read_chunk(const text_rows *rows, text_column *column, size_t i, place *p,
						const char **end, size_t *line_number)
{
	const text_chunk *chunk = &rows->chunk[i];
	const char *at = rows->begin + chunk->begin, *stop = rows->begin + chunk[1].begin, *line;
	size_t row = chunk->row, length, cell = chunk->cell;
	*line_number = rows->first_line + chunk->line;
	for (; text_rows_next_line(&at, stop, rows->newline, &line, &length); ++*line_number) {
		line_kind kind = chunk->skipped                     ? kind_of(rows, line, length)
						 : text_rows_is_empty(line, length) ? LINE_EMPTY
															: LINE_ROW;
		cell += kind != LINE_EMPTY;
		if (kind != LINE_ROW)
			continue;
		if (rows->cell)
			rows->cell[row] = (uint32_t)(cell - 1);
		*end = line + length;
		p->at = line;
		fault found = take_row(rows, column, row++, *end, p);
		if (found != FAULT_NONE)
			return found;
	}
	return FAULT_NONE;
}

static void read_chunks(void *user, size_t first, size_t last, uint32_t worker)
{
	(void)worker;
	reading *r = user;
	place p;
	const char *end;
	size_t line;
	for (size_t i = first; i < last && i < atomic_load(&r->bad); i++) {
		const text_chunk *chunk = &r->rows->chunk[i];
		fault found = read_chunk(r->rows, r->column, i, &p, &end, &line);
		input_file_release(r->rows->in, r->rows->begin + chunk->begin,
						   r->rows->begin + chunk[1].begin);
		if (found == FAULT_NONE)
			continue;
		size_t before = atomic_load(&r->bad);
		while (i < before && !atomic_compare_exchange_weak(&r->bad, &before, i))
			;
	}
}

/* The word at a place made fit for a message: short, and nothing that a terminal would obey. */
static void show_word(const text_rows *rows, const char *at, const char *end, char text[32])
{
	size_t length = 0;
	for (; at < end && !is_blank(*at) && (rows->separator == ' ' || *at != rows->separator); at++)
		if (length < 30)
			text[length++] = *at >= ' ' && *at <= '~' ? *at : '?';
	text[length] = '\0';
}

/* Reads the chunk with the first fault again, alone, to say what it is. */
static gw_status explain(const reading *r, gw_error *error)
{
	const text_rows *rows = r->rows;
	place p = { 0 };
	const char *end = NULL;
	size_t line = 0;
	char word[32];
	fault found = read_chunk(rows, r->column, atomic_load(&r->bad), &p, &end, &line);
	show_word(rows, p.at, end, word);
	const char *column = p.column < rows->width ? r->column[p.column].name : "";
	switch (found) {
	case FAULT_MISSING:
		return gw_fail(error, GW_ERROR_DATA,
					   "%s, line %zu has %zu values, where %zu were expected; '%.40s' is missing",
					   rows->in->name, line, p.column, rows->width, column);
	case FAULT_MORE:
		return gw_fail(error, GW_ERROR_DATA,
					   "%s, line %zu has more than %zu values; the next one is '%s'",
					   rows->in->name, line, rows->width, word);
	case FAULT_RANGE:
		return gw_fail(error, GW_ERROR_DATA,
					   "%s, line %zu: '%s' as '%.40s', where a whole number of its type was "
					   "expected",
					   rows->in->name, line, word, column);
	case FAULT_NUMBER:
	case FAULT_NONE:
		break;
	}
	if (rows->separator == ';' && p.at < end && *p.at == ',')
		return gw_fail(
			error, GW_ERROR_DATA,
			"%s, line %zu: '%s' as '%.40s' follows a decimal comma; write points instead",
			rows->in->name, line, word, column);
	return gw_fail(error, GW_ERROR_DATA,
				   "%s, line %zu: '%s' as '%.40s', where a number was expected", rows->in->name,
				   line, word, column);
}

gw_status text_rows_read(const text_rows *rows, text_column *column, gw_error *error)
{
	reading r = { .rows = rows, .column = column, .bad = SIZE_MAX };
	gw_parallel_for(rows->in->threads, rows->chunk_count, 1, read_chunks, &r);
	return atomic_load(&r.bad) == SIZE_MAX ? GW_OK : explain(&r, error);
}

/* ------------------------------------------------------------------------- single lines */

size_t text_rows_forms(const char *line, size_t length, char separator, double *value,
					   number_form *form, size_t most)
{
	text_rows rows = { .separator = separator };
	const char *end = line + length, *at = skip_blanks(line, end);
	size_t count = 0;
	while (at < end) {
		size_t used = 0;
		if (count == most)
			return 0;
		value[count] = NAN;
		form[count] = (number_form){ 0 };
		if (*at != separator)
			used = number_read_form(at, (size_t)(end - at), &value[count], &form[count]);
		if (*at != separator && !used)
			return 0;
		at += used;
		count++;
		if (!skip_separator(&rows, &at, end))
			return 0;
		at = skip_blanks(at, end);
	}
	return count;
}

size_t text_rows_numbers(const char *line, size_t length, char separator, double *value,
						 size_t most)
{
	number_form form[TEXT_ROWS_NUMBERS];
	assert(most <= TEXT_ROWS_NUMBERS);
	return text_rows_forms(line, length, separator, value, form, most);
}
