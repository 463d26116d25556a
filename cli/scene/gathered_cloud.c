/* gathered_cloud.c - see gathered_cloud.h. */
#include "scene/gathered_cloud.h"

#include "files/output_file.h"
#include "points/scan_origin.h"
#include "points/scan_rows.h"
#include "program/signals.h"
#include "program/text_quote.h"
#include "scene/loaded_scene.h"
#include "scene/scan_move.h"
#include "table/format_pieces.h"
#include "units/coordinates.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* Points of a piece. */
#define PIECE ((size_t)1 << 20)

/* Bytes of a point while it is read with all others, and of the program; and which share of what
 * memory has beside it points may take: what is left is for the light. */
#define READ_BYTES 220u
#define FIXED_BYTES (UINT64_C(64) << 20)
#define READ_SHARE 3u

/* Where points are gathered of which no file is made. */
#define ELSEWHERE "/var/tmp/"

/* A path in whose folder they are: the output, if that is to be a file. */
static const char *room_beside(const char *output)
{
	struct stat info;
	bool stream =
		!output || strcmp(output, "-") == 0 || (stat(output, &info) == 0 && !S_ISREG(info.st_mode));
	return stream ? ELSEWHERE : output;
}

/* Of which nothing is said that is not of all inputs, but where it stands. */
static bool is_plain(const settings *s, const settings_input *from)
{
	struct stat info;
	bool file = stat(from->path, &info) == 0 && S_ISREG(info.st_mode) && info.st_size > 0;
	return file && !from->has_emission && !from->has_albedo && !from->has_opacity &&
		   !from->has_specular && !from->has_roughness && from->motion == 0 &&
		   !loaded_scene_is_mesh(s, from);
}

static format_options options_of(const settings *s)
{
	return (format_options){ s->format, s->columns, s->bake.threads };
}

/* How many points there are, about; *readable receives whether all files are of a known format. */
static gw_status guess_points(const settings *s, uint64_t *points, bool *readable, gw_error *error)
{
	const format_options options = options_of(s);
	*points = 0;
	*readable = true;
	for (size_t i = 0; i < s->input_count && *readable; i++) {
		format_pieces pieces;
		gw_status status = format_pieces_open(s->input[i].path, &options, &pieces, error);
		*readable = pieces.found && pieces.found->read;
		*points += pieces.guess;
		format_pieces_close(&pieces);
		GW_TRY(status);
	}
	return GW_OK;
}

static gw_status is_wanted(const settings *s, const gathered_cloud_use *use, bool *wanted,
						   gw_error *error)
{
	uint64_t points;
	*wanted = false;
	for (size_t i = 0; i < s->input_count; i++)
		if (!is_plain(s, &s->input[i]))
			return GW_OK;
	GW_TRY(guess_points(s, &points, wanted, error));
	uint64_t left = use->memory > FIXED_BYTES ? use->memory - FIXED_BYTES : 0;
	bool many = points > use->fit && points > left / READ_SHARE / READ_BYTES;
	*wanted = *wanted && (use->always || many);
	return GW_OK;
}

/* ------------------------------------------------------------------------------- one input */

/* Inputs on their way. */
typedef struct gathering {
	const settings *settings;
	const gathered_cloud_use *use;
	gathered_points *points;
	gathered_input *input;
	char up;           /* of those before */
	coordinates place; /* likewise */
	gw_error *error;
} gathering;

static gw_status check_up(gathering *g, size_t i, char up)
{
	const settings *s = g->settings;
	if (i > 0 && s->up == SETTINGS_UP_AUTO && up != g->up)
		return gw_fail(g->error, GW_ERROR_USAGE,
					   "%s has %s up, but the inputs before it %s; say which holds with --up",
					   s->input[i].path, settings_up_name(up), settings_up_name(g->up));
	g->up = up;
	return GW_OK;
}

/* Coordinates are in what those of the inputs before it are. */
static gw_status check_place(gathering *g, size_t i, scan *piece)
{
	const settings *s = g->settings;
	coordinates own;
	gw_error reason = { 0 };
	gw_status status = coordinates_find(piece, (coordinates_unit)s->length, &own, &reason);
	if (status != GW_OK)
		return gw_fail(g->error, status, "%s: %.900s", s->input[i].path, reason.text);
	if (i > 0 && !coordinates_agree(&own, &g->place))
		status = gw_fail(g->error, GW_ERROR_USAGE,
						 "%s has coordinates in %s, but the inputs before it in %s; say which "
						 "holds with --units",
						 s->input[i].path, own.name, g->place.name);
	coordinates_clear(&g->place);
	g->place = own;
	return status;
}

/* What the first piece tells of an input. */
static gw_status look_at_first(gathering *g, size_t i, const format_pieces *pieces, scan *piece)
{
	uint64_t row = 0;
	for (size_t c = 0; c < piece->column_count; c++)
		row += scan_type_size(piece->column[c].type);
	GW_TRY(output_file_check_room(room_beside(g->use->output), row * pieces->guess, g->error));
	GW_TRY(check_up(g, i, piece->up));
	return check_place(g, i, piece);
}

/* Where a scanner stood, all points of a file tell. */
static gw_status find_scanner(const settings *s, scan *piece, gw_error *error)
{
	if (s->scanner_count > 0 || s->scanner_none)
		return GW_OK;
	GW_TRY(scan_find_rows(piece, s->input_count > 1, error));
	return scan_find_origin(piece, error);
}

static gw_status add_piece(gathering *g, size_t i, const format_pieces *pieces, scan *piece)
{
	const settings_input *from = &g->settings->input[i];
	if (pieces->together)
		GW_TRY(find_scanner(g->settings, piece, g->error));
	if (from->has_matrix)
		GW_TRY(scan_move(piece, from->matrix, g->error));
	return gathered_points_add(g->points, piece, g->error);
}

static gw_status add_pieces(gathering *g, size_t i, format_pieces *pieces)
{
	bool more = true;
	for (bool first = true; more; first = false) {
		scan piece;
		GW_TRY(format_pieces_next(pieces, PIECE, &piece, g->error));
		more = piece.count > 0;
		gw_status status = first && more ? look_at_first(g, i, pieces, &piece) : GW_OK;
		if (status == GW_OK && more)
			status = add_piece(g, i, pieces, &piece);
		scan_clear(&piece);
		GW_TRY(status);
		GW_TRY(signals_check(g->error));
	}
	return GW_OK;
}

static gw_status add_input(gathering *g, size_t i)
{
	const format_options options = options_of(g->settings);
	const char *path = g->settings->input[i].path;
	gathered_input *input = &g->input[i];
	format_pieces pieces;
	GW_TRY(gathered_points_next_file(g->points, g->error));
	gw_status status = format_pieces_open(path, &options, &pieces, g->error);
	input->format = pieces.found;
	if (status == GW_OK)
		status = add_pieces(g, i, &pieces);
	input->points = gathered_points_of_file(g->points, i, &input->left_out);
	format_pieces_close(&pieces);
	return status == GW_OK && input->points == 0
			   ? gw_fail(g->error, GW_ERROR_DATA, "%s holds no points", path)
			   : status;
}

/* ----------------------------------------------------------------------------------- all */

static void say_gathered(const gathering *g)
{
	size_t files = g->settings->input_count;
	bool beside = strcmp(room_beside(g->use->output), ELSEWHERE) != 0;
	text_message(stderr,
				 "glowworm: note: memory does not hold all %llu points of %zu file%s at once "
				 "(--memory): until the end, the disk holds them, in %.2f GB %s\n",
				 (unsigned long long)gathered_points_count(g->points), files, files == 1 ? "" : "s",
				 (double)gathered_points_bytes(g->points) * 1e-9,
				 beside ? "beside the output" : "in " ELSEWHERE);
}

static gw_status gather(gathering *g, format_parts *parts)
{
	const settings *s = g->settings;
	GW_TRY(gathered_points_begin(room_beside(g->use->output), &g->points, g->error));
	for (size_t i = 0; i < s->input_count; i++)
		GW_TRY(add_input(g, i));
	gathered_points_settle(g->points);
	if (!s->quiet && !g->use->quiet)
		say_gathered(g);
	format_parts_of_gathered(g->points, s->input_count > 1 ? "the inputs" : s->input[0].path,
							 parts);
	parts->in.threads = s->bake.threads;
	g->points = NULL;
	return GW_OK;
}

gw_status gathered_cloud_make(const settings *s, const gathered_cloud_use *use, format_parts *parts,
							  gathered_input **input, gw_error *error)
{
	bool wanted;
	gathering g = { .settings = s, .use = use, .place = coordinates_metres(), .error = error };
	*input = NULL;
	GW_TRY(is_wanted(s, use, &wanted, error));
	if (!wanted)
		return GW_OK;
	g.input = calloc(s->input_count, sizeof *g.input);
	gw_status status =
		g.input ? gather(&g, parts)
				: gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu inputs", s->input_count);
	gathered_points_close(&g.points);
	coordinates_clear(&g.place);
	if (status == GW_OK)
		*input = g.input;
	else
		free(g.input);
	return status;
}
