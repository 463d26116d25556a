/* gathered_points.c - see gathered_points.h. */
#include "table/gathered_points.h"

#include "files/file_status.h"
#include "files/growing_table.h"
#include "points/scan_color.h"
#include "points/scan_join.h"
#include "points/scan_opacity.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Kinds of colours that may count differently in files: red green blue, and albedo_*. */
#define COLORS 2

/* In place of the number of a column: which scanner saw each point. */
#define OF_SCANNER UINT32_MAX

/* Values of a column in a piece. */
typedef struct stretch {
	uint32_t column; /* of all, or OF_SCANNER */
	scan_type type;
	uint64_t at; /* in the file */
} stretch;

typedef struct piece {
	uint64_t first, count;
	size_t file;
	size_t stretch, stretches; /* first and how many */
	uint32_t scanner;          /* that saw all of it, where no stretch says it */
} piece;

/* One of the files that pieces came of. */
typedef struct source {
	scan_color_tally tally[COLORS];
	double full[COLORS]; /* what these count to; 0: it has none */
	uint64_t points, left_out;
} source;

struct gathered_points {
	int file;
	uint64_t end;
	scan all;            /* of no points: the columns of all, and all else that is known of them */
	bool seen;           /* some piece says by which scanner */
	const char *opacity; /* once all are there, a column's name; NULL: all points are opaque */
	double full[COLORS]; /* likewise, what colours count to that are scaled; 0: they are not */
	source *source;      /* source_count */
	size_t source_count;
	piece *piece; /* piece_count */
	size_t piece_count;
	stretch *stretch; /* stretch_count */
	size_t stretch_count;
};

static const char *const *const color_names[COLORS] = { scan_color_names, scan_albedo_names };

static gw_status no_memory(gw_error *error)
{
	return gw_fail(error, GW_ERROR_MEMORY, "no memory to gather points");
}

/* -------------------------------------------------------------------------------- the file */

gw_status gathered_points_begin(const char *beside, gathered_points **points, gw_error *error)
{
	const char *slash = strrchr(beside, '/');
	char *path;
	*points = NULL;
	if (asprintf(&path, "%.*s.glowworm-points-XXXXXX", slash ? (int)(slash + 1 - beside) : 0,
				 beside) < 0)
		return no_memory(error);
	gathered_points *made = calloc(1, sizeof *made);
	gw_status status = made ? GW_OK : no_memory(error);
	if (made)
		made->file = mkostemp(path, O_CLOEXEC);
	if (made && made->file < 0)
		status = gw_fail(error, FILE_ERROR_CREATE, "cannot make a file for points beside %s: %s",
						 beside, strerror(errno));
	else if (made)
		unlink(path);
	free(path);
	if (status == GW_OK)
		*points = made;
	else
		free(made);
	return status;
}

/* All bytes, or what failed. */
static gw_status put(gathered_points *g, const void *bytes, uint64_t length, gw_error *error)
{
	for (const char *from = bytes; length > 0;) {
		ssize_t put = pwrite(g->file, from, length < INT32_MAX ? length : INT32_MAX, (off_t)g->end);
		if (put < 0 && errno == EINTR)
			continue;
		if (put <= 0)
			return gw_fail(error, FILE_ERROR_IO,
						   "the disk does not take the points that are gathered on it, %.1f GB so "
						   "far: %s",
						   (double)g->end * 1e-9, strerror(errno));
		from += put;
		length -= (uint64_t)put;
		g->end += (uint64_t)put;
	}
	return GW_OK;
}

static gw_status get(const gathered_points *g, void *bytes, uint64_t length, uint64_t at,
					 gw_error *error)
{
	for (char *to = bytes; length > 0;) {
		ssize_t got = pread(g->file, to, length < INT32_MAX ? length : INT32_MAX, (off_t)at);
		if (got < 0 && errno == EINTR)
			continue;
		if (got <= 0)
			return gw_fail(error, FILE_ERROR_IO, "cannot read points that were gathered: %s",
						   got < 0 ? strerror(errno) : "they end too soon");
		to += got;
		length -= (uint64_t)got;
		at += (uint64_t)got;
	}
	return GW_OK;
}

/* ------------------------------------------------------------------------- piece after piece */

gw_status gathered_points_next_file(gathered_points *g, gw_error *error)
{
	source *grown = growing_table_room(g->source, g->source_count, sizeof *grown);
	if (!grown)
		return no_memory(error);
	g->source = grown;
	g->source[g->source_count++] = (source){ .points = 0 };
	return GW_OK;
}

/* The column of all by a name, which is made where there is none. */
static gw_status find_column(gathered_points *g, const scan_column *own, uint32_t *index,
							 gw_error *error)
{
	scan_column *column = scan_find(&g->all, own->name);
	if (column)
		column->type = scan_type_widen(column->type, own->type);
	else
		column = scan_add_column(&g->all, own->name, own->type, error);
	if (!column)
		return GW_ERROR_MEMORY;
	*index = (uint32_t)(column - g->all.column);
	return GW_OK;
}

static gw_status add_stretch(gathered_points *g, uint32_t column, scan_type type,
							 const void *values, gw_error *error)
{
	piece *p = &g->piece[g->piece_count - 1];
	stretch *grown = growing_table_room(g->stretch, g->stretch_count, sizeof *grown);
	if (!grown)
		return no_memory(error);
	g->stretch = grown;
	g->stretch[g->stretch_count++] = (stretch){ column, type, g->end };
	p->stretches++;
	return put(g, values, p->count * scan_type_size(type), error);
}

static gw_status add_columns(gathered_points *g, const scan *from, gw_error *error)
{
	for (size_t c = 0; c < from->column_count; c++) {
		uint32_t index;
		GW_TRY(find_column(g, &from->column[c], &index, error));
		GW_TRY(add_stretch(g, index, from->column[c].type, from->column[c].data, error));
	}
	return GW_OK;
}

/* Which of all scanners saw each of the points. */
static gw_status add_seen(gathered_points *g, const scan *from, const uint32_t *index,
						  gw_error *error)
{
	uint32_t *of = reallocarray(NULL, from->count, sizeof *of);
	if (!of)
		return no_memory(error);
	for (size_t i = 0; i < from->count; i++)
		of[i] = from->scanner_of[i] < from->scanner_count ? index[from->scanner_of[i]]
														  : SCAN_NO_SCANNER;
	gw_status status = add_stretch(g, OF_SCANNER, SCAN_UINT32, of, error);
	free(of);
	return status;
}

static gw_status add_scanners(gathered_points *g, const scan *from, gw_error *error)
{
	uint32_t *index = reallocarray(NULL, from->scanner_count + 1, sizeof *index);
	gw_status status = index ? GW_OK : no_memory(error);
	for (size_t s = 0; s < from->scanner_count && status == GW_OK; s++) {
		index[s] = scan_scanner_at(&g->all, from->scanner + 3 * s);
		status = index[s] == SCAN_NO_SCANNER ? no_memory(error) : GW_OK;
	}
	g->seen = g->seen || from->scanner_count > 0;
	if (status == GW_OK && from->scanner_of)
		status = add_seen(g, from, index, error);
	else if (status == GW_OK && from->scanner_count == 1)
		g->piece[g->piece_count - 1].scanner = index[0];
	free(index);
	return status;
}

static bool is_said(const scan *all, const char *comment)
{
	for (size_t c = 0; c < all->comment_count; c++)
		if (strcmp(all->comment[c], comment) == 0)
			return true;
	return false;
}

/* What a piece says of all its points. */
static gw_status add_facts(gathered_points *g, const scan *from, gw_error *error)
{
	source *s = &g->source[g->source_count - 1];
	for (size_t c = 0; c < from->comment_count; c++)
		if (!is_said(&g->all, from->comment[c]))
			GW_TRY(scan_add_comment(&g->all, from->comment[c], error));
	if (g->piece_count == 0) {
		g->all.up = from->up;
		g->all.step = from->step;
	}
	g->all.step = fmin(g->all.step, from->step);
	g->all.says_up = g->all.says_up || from->says_up;
	g->all.noise_classes |= from->noise_classes;
	g->all.left_out += from->left_out;
	s->left_out += from->left_out;
	s->points += from->count;
	for (int m = 0; m < COLORS; m++) {
		scan_color color;
		bool all = true;
		for (int k = 0; k < 3; k++)
			all = all && scan_find(from, color_names[m][k]);
		if (!all || !scan_color_tally_add(&s->tally[m], from, color_names[m], &color))
			continue;
		scan_color_tally_settle(&s->tally[m], &color);
		s->full[m] = color.range;
	}
	return GW_OK;
}

gw_status gathered_points_add(gathered_points *g, const scan *from, gw_error *error)
{
	piece *grown = growing_table_room(g->piece, g->piece_count, sizeof *grown);
	if (!grown)
		return no_memory(error);
	g->piece = grown;
	GW_TRY(add_facts(g, from, error));
	if (from->count == 0)
		return GW_OK;
	g->piece[g->piece_count] = (piece){ .first = gathered_points_count(g),
										.count = from->count,
										.file = g->source_count - 1,
										.stretch = g->stretch_count,
										.scanner = SCAN_NO_SCANNER };
	g->piece_count++;
	GW_TRY(add_columns(g, from, error));
	return add_scanners(g, from, error);
}

/* ------------------------------------------------------------------------------ all are there */

/* Colours that files count differently: to which number all do, or 0 where they agree. */
static double common_full(const gathered_points *g, int m)
{
	double one = 0.0;
	bool differ = false, floats = false;
	for (size_t s = 0; s < g->source_count; s++) {
		double full = g->source[s].full[m];
		differ = differ || (one > 0.0 && full > 0.0 && full != one);
		one = full > 0.0 ? full : one;
		floats = floats || (full > 0.0 && g->source[s].tally[m].floats);
	}
	return !differ ? 0.0 : floats ? 1.0 : 65535.0;
}

void gathered_points_settle(gathered_points *g)
{
	const scan_column *opacity = scan_opacity_find(&g->all);
	g->opacity = opacity ? opacity->name : NULL;
	for (int m = 0; m < COLORS; m++) {
		g->full[m] = common_full(g, m);
		for (int k = 0; k < 3 && g->full[m] > 0.0; k++)
			scan_find(&g->all, color_names[m][k])->type =
				g->full[m] > 1.0 ? SCAN_UINT16 : SCAN_FLOAT32;
	}
}

uint64_t gathered_points_count(const gathered_points *g)
{
	const piece *last = g->piece_count > 0 ? &g->piece[g->piece_count - 1] : NULL;
	return last ? last->first + last->count : 0;
}

uint64_t gathered_points_bytes(const gathered_points *g)
{
	return g->end;
}

uint64_t gathered_points_of_file(const gathered_points *g, size_t file, uint64_t *left_out)
{
	*left_out = g->source[file].left_out;
	return g->source[file].points;
}

/* -------------------------------------------------------------------------------- read again */

/* Points of a piece on their way into a part. */
typedef struct stay {
	const piece *from;
	uint64_t skip;    /* points of the piece before them */
	size_t to, count; /* first in the part, and how many */
} stay;

/* By how much a colour of a file is to be scaled. */
static double scale_of(const gathered_points *g, const piece *p, const char *name)
{
	const source *s = &g->source[p->file];
	for (int m = 0; m < COLORS; m++)
		for (int k = 0; k < 3 && g->full[m] > 0.0 && s->full[m] > 0.0; k++)
			if (strcmp(name, color_names[m][k]) == 0)
				return g->full[m] / s->full[m];
	return 1.0;
}

/* Values that were written in another type, or are scaled. */
static gw_status convert(const gathered_points *g, const stay *s, const stretch *from,
						 scan_column *to, gw_error *error)
{
	size_t size = scan_type_size(from->type);
	double scale = scale_of(g, s->from, to->name);
	bool whole = to->type != SCAN_FLOAT32 && to->type != SCAN_FLOAT64;
	scan_column own = { .type = from->type, .data = reallocarray(NULL, s->count, size) };
	gw_status status = own.data
						   ? get(g, own.data, s->count * size, from->at + s->skip * size, error)
						   : no_memory(error);
	for (size_t i = 0; i < s->count && status == GW_OK; i++) {
		double value = scan_value(&own, i);
		if (scale != 1.0)
			value = whole ? floor(fmin(fmax(value * scale, 0.0), 65535.0) + 0.5) : value * scale;
		scan_store(to, s->to + i, value);
	}
	free(own.data);
	return status;
}

static gw_status read_stretch(const gathered_points *g, const stay *s, const stretch *from,
							  scan *part, gw_error *error)
{
	if (from->column == OF_SCANNER)
		return get(g, part->scanner_of + s->to, s->count * sizeof *part->scanner_of,
				   from->at + s->skip * sizeof *part->scanner_of, error);
	scan_column *to = &part->column[from->column];
	size_t size = scan_type_size(to->type);
	if (to->type != from->type || scale_of(g, s->from, to->name) != 1.0)
		return convert(g, s, from, to, error);
	return get(g, (char *)to->data + s->to * size, s->count * size, from->at + s->skip * size,
			   error);
}

/* What a column holds whose values mean opaque. */
static void fill_opaque(const stay *s, scan_column *to)
{
	double full = to->type == SCAN_UINT8 ? 255.0 : to->type == SCAN_UINT16 ? 65535.0 : 1.0;
	for (size_t i = 0; i < s->count; i++)
		scan_store(to, s->to + i, full);
}

static gw_status read_piece(const gathered_points *g, const stay *s, scan *part, gw_error *error)
{
	const piece *p = s->from;
	bool opaque = g->opacity != NULL;
	for (size_t i = 0; i < s->count && part->scanner_of; i++)
		part->scanner_of[s->to + i] = p->scanner;
	for (size_t k = p->stretch; k < p->stretch + p->stretches; k++) {
		const stretch *from = &g->stretch[k];
		if (opaque && from->column != OF_SCANNER)
			opaque = strcmp(part->column[from->column].name, g->opacity) != 0;
		GW_TRY(read_stretch(g, s, from, part, error));
	}
	if (opaque)
		fill_opaque(s, scan_find(part, g->opacity));
	return GW_OK;
}

/* A part of so many points, of which nothing is read yet. */
static gw_status begin_part(const gathered_points *g, size_t count, scan *part, gw_error *error)
{
	*part = (scan){ .count = count,
					.up = g->all.up,
					.says_up = g->all.says_up,
					.step = g->all.step,
					.noise_classes = g->all.noise_classes };
	for (size_t c = 0; c < g->all.comment_count; c++)
		GW_TRY(scan_add_comment(part, g->all.comment[c], error));
	for (size_t c = 0; c < g->all.column_count; c++)
		if (!scan_add_column(part, g->all.column[c].name, g->all.column[c].type, error))
			return GW_ERROR_MEMORY;
	if (g->all.scanner_count == 0)
		return GW_OK;
	size_t bytes = 3 * g->all.scanner_count * sizeof *part->scanner;
	part->scanner = malloc(bytes);
	if (!part->scanner)
		return no_memory(error);
	memcpy(part->scanner, g->all.scanner, bytes);
	part->scanner_count = g->all.scanner_count;
	return g->seen ? scan_part_scanners(part, error) : GW_OK;
}

/* Number of the piece that a point is of. */
static size_t piece_of(const gathered_points *g, uint64_t point)
{
	size_t low = 0, high = g->piece_count;
	while (high - low > 1) {
		size_t middle = low + (high - low) / 2;
		if (g->piece[middle].first <= point)
			low = middle;
		else
			high = middle;
	}
	return low;
}

static gw_status read_points(const gathered_points *g, uint64_t first, scan *part, gw_error *error)
{
	size_t done = 0;
	for (size_t k = piece_of(g, first); done < part->count; k++) {
		const piece *p = &g->piece[k];
		uint64_t skip = first + done - p->first, left = p->count - skip;
		size_t wanted = part->count - done;
		const stay s = { p, skip, done, left < wanted ? (size_t)left : wanted };
		GW_TRY(read_piece(g, &s, part, error));
		done += s.count;
	}
	return GW_OK;
}

gw_status gathered_points_read(const gathered_points *g, uint64_t first, size_t count, scan *part,
							   gw_error *error)
{
	gw_status status = begin_part(g, count, part, error);
	if (status == GW_OK && count > 0)
		status = read_points(g, first, part, error);
	if (status != GW_OK)
		scan_clear(part);
	return status;
}

void gathered_points_close(gathered_points **points)
{
	gathered_points *g = *points;
	if (!g)
		return;
	close(g->file);
	scan_clear(&g->all);
	free(g->source);
	free(g->piece);
	free(g->stretch);
	free(g);
	*points = NULL;
}
