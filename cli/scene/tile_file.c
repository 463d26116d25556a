/* tile_file.c - see tile_file.h. */
#include "scene/tile_file.h"

#include "files/growing_table.h"
#include "points/scan_bytes.h"
#include "points/scan_join.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define PIECES_MAX (UINT64_C(1) << 32)

/* ------------------------------------------------------------------------------------- the file */

gw_status tile_file_open(const char *result, bool force, bool keep, tile_file *f, gw_error *error)
{
	*f = (tile_file){ .in = -1 };
	char *path = output_file_beside(result, BAKE_JOURNAL_TILES);
	if (!path)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the name of a file");
	gw_status status = output_file_create_lasting(&f->out, path, force, keep, error);
	free(path);
	GW_TRY(status);
	f->in = open(output_file_temporary(f->out), O_RDONLY | O_CLOEXEC);
	return f->in >= 0 ? GW_OK
					  : gw_fail(error, FILE_ERROR_IO, "cannot read %s: %s",
								output_file_temporary(f->out), strerror(errno));
}

static void forget_table(tile_file *f)
{
	free(f->piece);
	free(f->first);
	f->piece = NULL;
	f->first = NULL;
	f->piece_count = 0;
	f->tiles = 0;
	f->end = 0;
	f->sum = (checksum){ 0 };
}

void tile_file_close(tile_file *f, bool leave)
{
	if (!f->out)
		return;
	forget_table(f);
	if (f->in >= 0)
		close(f->in);
	if (leave)
		output_file_leave(&f->out);
	else
		output_file_abandon(&f->out);
	*f = (tile_file){ .in = -1 };
}

void tile_file_done(tile_file *f)
{
	unlink(output_file_temporary(f->out));
}

static gw_status read_at(const tile_file *f, uint64_t at, void *bytes, size_t length,
						 gw_error *error)
{
	uint8_t *to = bytes;
	while (length > 0) {
		ssize_t got = pread(f->in, to, length, (off_t)at);
		if (got < 0 && errno == EINTR)
			continue;
		if (got <= 0)
			return gw_fail(error, FILE_ERROR_IO, "cannot read %s: %s",
						   output_file_temporary(f->out), got < 0 ? strerror(errno) : "it ends");
		to += got;
		at += (uint64_t)got;
		length -= (size_t)got;
	}
	return GW_OK;
}

/* --------------------------------------------------------------------------------------- pieces */

gw_status tile_file_begin(tile_file *f, gw_error *error)
{
	forget_table(f);
	GW_TRY(output_file_resize(f->out, 0, error));
	return output_file_seek(f->out, 0, error);
}

static gw_status append(void *user, const void *bytes, size_t length, gw_error *error)
{
	tile_file *f = user;
	GW_TRY(output_file_write(f->out, bytes, length, error));
	checksum_add(&f->sum, bytes, length);
	f->end += length;
	return GW_OK;
}

static gw_status enter(tile_file *f, const tile_piece *piece, gw_error *error)
{
	tile_piece *grown = growing_table_room(f->piece, f->piece_count, sizeof *grown);
	if (!grown)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu pieces of tiles", f->piece_count);
	f->piece = grown;
	f->piece[f->piece_count++] = *piece;
	return GW_OK;
}

/* Rows and core come first, since they are looked at by themselves. */
gw_status tile_file_add(tile_file *f, const tile_rows *rows, const scan *points, gw_error *error)
{
	const gw_byte_sink to = { append, f };
	tile_piece piece = { f->end, points->count, 0, rows->tile, rows->part };
	for (size_t i = 0; i < points->count; i++)
		piece.core += rows->core[i] != 0;
	GW_TRY(append(f, rows->row, points->count * sizeof *rows->row, error));
	GW_TRY(append(f, rows->core, points->count, error));
	GW_TRY(scan_bytes_save(points, &to, error));
	return enter(f, &piece, error);
}

gw_status tile_file_add_kept(tile_file *f, uint32_t tile, const uint32_t *point, size_t count,
							 gw_error *error)
{
	const tile_piece piece = { f->end, count, 0, tile, TILE_FILE_KEPT };
	GW_TRY(append(f, point, count * sizeof *point, error));
	return enter(f, &piece, error);
}

static gw_status fail_damaged(const tile_file *f, gw_error *error)
{
	return gw_fail(error, GW_ERROR_DATA,
				   "%s is damaged or gone, so that nothing can go on from it; --force without "
				   "--resume begins anew",
				   output_file_temporary(f->out));
}

/* Counts the points of each tile. GW_ERROR_DATA where a piece is of no tile. */
static gw_status count_tiles(tile_file *f, uint32_t tiles, gw_error *error)
{
	f->first = calloc((size_t)tiles + 1, sizeof *f->first);
	if (!f->first)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %u tiles", tiles);
	for (size_t i = 0; i < f->piece_count; i++) {
		if (f->piece[i].tile >= tiles)
			return fail_damaged(f, error);
		f->first[f->piece[i].tile + 1] += f->piece[i].core;
	}
	for (uint32_t tile = 0; tile < tiles; tile++)
		f->first[tile + 1] += f->first[tile];
	f->tiles = tiles;
	return GW_OK;
}

gw_status tile_file_settle(tile_file *f, uint32_t tiles, gw_error *error)
{
	GW_TRY(count_tiles(f, tiles, error));
	return output_file_sync(f->out, error);
}

gw_status tile_file_save(const tile_file *f, const gw_byte_sink *to, gw_error *error)
{
	const uint64_t head[] = { f->tiles, f->piece_count, f->end, checksum_value(&f->sum) };
	GW_TRY(to->write(to->user, head, sizeof head, error));
	return to->write(to->user, f->piece, f->piece_count * sizeof *f->piece, error);
}

gw_status tile_file_load(tile_file *f, const gw_byte_source *from, gw_error *error)
{
	uint64_t head[4];
	forget_table(f);
	GW_TRY(from->read(from->user, head, sizeof head, error));
	if (head[0] == 0 || head[0] >= UINT32_MAX || head[1] > PIECES_MAX ||
		!output_file_holds(f->out, 0, head[2], head[3]))
		return fail_damaged(f, error);
	f->piece = reallocarray(NULL, (size_t)head[1] + 1, sizeof *f->piece);
	if (!f->piece)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the pieces of tiles");
	f->piece_count = (size_t)head[1];
	f->end = head[2];
	GW_TRY(from->read(from->user, f->piece, f->piece_count * sizeof *f->piece, error));
	return count_tiles(f, (uint32_t)head[0], error);
}

/* ---------------------------------------------------------------------------------------- tiles */

/* Reads on from a place. */
typedef struct reading {
	const tile_file *file;
	uint64_t at;
} reading;

static gw_status read_on(void *user, void *bytes, size_t length, gw_error *error)
{
	reading *r = user;
	GW_TRY(read_at(r->file, r->at, bytes, length, error));
	r->at += length;
	return GW_OK;
}

static gw_status add_piece(const tile_file *f, const tile_piece *piece, scan *cloud, uint8_t *core,
						   gw_error *error)
{
	scan points;
	reading r = { f, piece->at + piece->points * sizeof(uint32_t) };
	const gw_byte_source from = { read_on, &r };
	GW_TRY(read_on(&r, core, (size_t)piece->points, error));
	GW_TRY(scan_bytes_load(&from, &points, error));
	if (cloud->column_count == 0) {
		*cloud = points;
		return GW_OK;
	}
	gw_status status = scan_append(cloud, &points, error);
	scan_clear(&points);
	return status;
}

static bool is_of(const tile_piece *piece, uint32_t tile, bool kept)
{
	return piece->tile == tile && (piece->part == TILE_FILE_KEPT) == kept;
}

static size_t points_of(const tile_file *f, uint32_t tile, bool kept)
{
	size_t count = 0;
	for (size_t i = 0; i < f->piece_count; i++)
		count += is_of(&f->piece[i], tile, kept) ? (size_t)f->piece[i].points : 0;
	return count;
}

gw_status tile_file_points(const tile_file *f, uint32_t tile, scan *cloud, uint8_t **core,
						   gw_error *error)
{
	gw_status status = GW_OK;
	*cloud = (scan){ 0 };
	*core = malloc(points_of(f, tile, false) + 1);
	if (!*core)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for a tile");
	for (size_t i = 0; i < f->piece_count && status == GW_OK; i++)
		if (is_of(&f->piece[i], tile, false))
			status = add_piece(f, &f->piece[i], cloud, *core + cloud->count, error);
	if (status == GW_OK)
		return GW_OK;
	scan_clear(cloud);
	free(*core);
	*core = NULL;
	return status;
}

gw_status tile_file_kept(const tile_file *f, uint32_t tile, uint32_t **point, size_t *count,
						 gw_error *error)
{
	gw_status status = GW_OK;
	*count = 0;
	*point = reallocarray(NULL, points_of(f, tile, true) + 1, sizeof **point);
	if (!*point)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for a tile");
	for (size_t i = 0; i < f->piece_count && status == GW_OK; i++) {
		const tile_piece *piece = &f->piece[i];
		if (!is_of(piece, tile, true))
			continue;
		status =
			read_at(f, piece->at, *point + *count, (size_t)piece->points * sizeof **point, error);
		*count += (size_t)piece->points;
	}
	if (status == GW_OK)
		return GW_OK;
	free(*point);
	*point = NULL;
	return status;
}

/* -------------------------------------------------------------------------------------- results */

static uint64_t share_at(const tile_file *f, uint32_t tile)
{
	return f->end + tile * sizeof(gw_tile_share);
}

static gw_status write_rows(const tile_file *f, const tile_outcome *outcome, gw_error *error)
{
	const format_parted *to = outcome->format->parted;
	return to->write_loose ? to->write_loose(f->out, outcome->whole, outcome->lit, error)
						   : to->write_rows(f->out, outcome->whole, outcome->lit, error);
}

gw_status tile_file_put(tile_file *f, uint32_t tile, const tile_outcome *outcome,
						journal_slot *slot, gw_error *error)
{
	checksum sum;
	size_t row;
	GW_TRY(format_whole_row(outcome->format, outcome->whole, outcome->lit, &row, error));
	const uint64_t at = share_at(f, f->tiles) + row * f->first[tile];
	GW_TRY(output_file_seek(f->out, share_at(f, tile), error));
	GW_TRY(output_file_write(f->out, outcome->share, sizeof *outcome->share, error));
	GW_TRY(output_file_seek(f->out, at, error));
	GW_TRY(write_rows(f, outcome, error));
	GW_TRY(output_file_written(f->out, &sum, error));
	if (sum.length != row * (f->first[tile + 1] - f->first[tile]))
		return gw_fail(error, GW_ERROR_INTERNAL, "tile %u has other points than it was given",
					   tile);
	*slot = (journal_slot){ at, sum.length, checksum_value(&sum) };
	return GW_OK;
}

gw_status tile_file_share(const tile_file *f, uint32_t tile, gw_tile_share *share, gw_error *error)
{
	return read_at(f, share_at(f, tile), share, sizeof *share, error);
}

bool tile_file_holds(const tile_file *f, const journal_slot *slot)
{
	return output_file_holds(f->out, slot->offset, slot->length, slot->value);
}

gw_status tile_file_sync(tile_file *f, gw_error *error)
{
	return output_file_sync(f->out, error);
}

/* The lit points that a piece has, which are `before` others of its tile on. */
static gw_status take_rows(const tile_file *f, const tile_piece *piece, uint64_t before,
						   const tile_part *to, gw_error *error)
{
	const size_t row = to->row;
	size_t points = (size_t)piece->points, lit = 0;
	uint32_t *place = reallocarray(NULL, points + 1, sizeof *place);
	uint8_t *core = malloc(points + 1), *rows = reallocarray(NULL, (size_t)piece->core + 1, row);
	gw_status status = place && core && rows
						   ? read_at(f, piece->at, place, points * sizeof *place, error)
						   : gw_fail(error, GW_ERROR_MEMORY, "no memory for a piece of a tile");
	if (status == GW_OK)
		status = read_at(f, piece->at + points * sizeof *place, core, points, error);
	if (status == GW_OK)
		status = read_at(f, share_at(f, f->tiles) + row * (f->first[piece->tile] + before), rows,
						 row * (size_t)piece->core, error);
	for (size_t i = 0; status == GW_OK && i < points; i++)
		if (core[i] && place[i] < to->count)
			memcpy(to->bytes + row * place[i], rows + row * lit++, row);
	free(place);
	free(core);
	free(rows);
	return status;
}

gw_status tile_file_part(const tile_file *f, const tile_part *to, gw_error *error)
{
	uint64_t lit = 0, *before = calloc(f->tiles, sizeof *before);
	gw_status status =
		before ? GW_OK : gw_fail(error, GW_ERROR_MEMORY, "no memory for %u tiles", f->tiles);
	for (size_t i = 0; i < f->piece_count && status == GW_OK; i++) {
		const tile_piece *piece = &f->piece[i];
		if (piece->part == TILE_FILE_KEPT)
			continue;
		if (piece->part == to->part) {
			status = take_rows(f, piece, before[piece->tile], to, error);
			lit += piece->core;
		}
		before[piece->tile] += piece->core;
	}
	free(before);
	if (status == GW_OK && lit != to->count)
		status = gw_fail(error, GW_ERROR_INTERNAL, "%llu of %zu points are in tiles",
						 (unsigned long long)lit, to->count);
	return status;
}
