/*
 * tile_file.h - the points of a cloud that memory does not hold, sorted by tiles (gw_tiling), and
 * what becomes of them, in a file beside the output.
 *
 * It begins with pieces: the points that one part of the input has in one tile or its halo, with
 * their rows in that part. A share for each tile comes next, which says how right its light is;
 * then the lit points of one tile after the other, as rows of the result. Of these the table of
 * pieces knows where each belongs.
 */
#ifndef TILE_FILE_H
#define TILE_FILE_H

#include "files/journal_file.h"
#include "files/output_file.h"
#include "glowworm_parts.h"
#include "points/format.h"
#include "points/scan.h"
#include "scene/bake_journal.h"

/* Points of one tile in one part of the input. */
typedef struct tile_piece {
	uint64_t at;           /* in the file */
	uint64_t points, core; /* of the tile and its halo; of the tile alone */
	uint32_t tile, part;   /* TILE_FILE_KEPT: numbers of points that were kept */
} tile_piece;
#define TILE_FILE_KEPT UINT32_MAX

typedef struct tile_file {
	output_file *out;
	int in;            /* the same file, to read from; -1: not open */
	uint64_t end;      /* of the pieces that are written, and */
	checksum sum;      /* of all their bytes */
	tile_piece *piece; /* piece_count, in the order of their parts */
	size_t piece_count;
	uint32_t tiles;  /* 0: not settled yet */
	uint64_t *first; /* tiles + 1: points of the tiles before each */
} tile_file;

/* Points of a tile that were found in a part. */
typedef struct tile_rows {
	uint32_t tile, part;
	const uint32_t *row; /* scan.count: where in the part each is, ascending */
	const uint8_t *core; /* scan.count: 0 for those of the halo */
} tile_rows;

/*
 * Opens the file, or creates it.
 *   result   the name of the result
 *   keep     it outlasts the process unless tile_file_done was called
 *   file     to be closed with tile_file_close, also on failure
 * Fails like output_file_create_lasting.
 */
gw_status tile_file_open(const char *result, bool force, bool keep, tile_file *file,
						 gw_error *error);
void tile_file_close(tile_file *file, bool leave); /* leave: others work with it */

/* It is needed no more: closing it removes it. */
void tile_file_done(tile_file *file);

/* Begins it anew, then adds pieces, parts in order; and which of the kept points a tile has. */
gw_status tile_file_begin(tile_file *file, gw_error *error);
gw_status tile_file_add(tile_file *file, const tile_rows *rows, const scan *points,
						gw_error *error);
gw_status tile_file_add_kept(tile_file *file, uint32_t tile, const uint32_t *point, size_t count,
							 gw_error *error);

/* All pieces are there: the disk has them. */
gw_status tile_file_settle(tile_file *file, uint32_t tiles, gw_error *error);

/* The table of pieces as bytes, and from bytes. GW_ERROR_DATA where they are no table, or the file
 * has other pieces. */
gw_status tile_file_save(const tile_file *file, const gw_byte_sink *to, gw_error *error);
gw_status tile_file_load(tile_file *file, const gw_byte_source *from, gw_error *error);

/*
 * The points of a tile and its halo, in the order of the input.
 *   cloud   to be freed with scan_clear; empty on failure
 *   core    one each, 0 for those of the halo; for free(), NULL on failure
 */
gw_status tile_file_points(const tile_file *file, uint32_t tile, scan *cloud, uint8_t **core,
						   gw_error *error);
/* Which of the kept points are in a tile or its halo. point: for free(), NULL on failure */
gw_status tile_file_kept(const tile_file *file, uint32_t tile, uint32_t **point, size_t *count,
						 gw_error *error);

/* What becomes of a tile. */
typedef struct tile_outcome {
	const gw_tile_share *share;
	const scan *lit;      /* the points of the core, in order */
	const format *format; /* of the result, and what it knows of all points */
	const format_whole *whole;
} tile_outcome;

/*
 * Writes it.
 *   slot   receives where the points are, and their checksum
 */
gw_status tile_file_put(tile_file *file, uint32_t tile, const tile_outcome *outcome,
						journal_slot *slot, gw_error *error);
gw_status tile_file_share(const tile_file *file, uint32_t tile, gw_tile_share *share,
						  gw_error *error);

/* Whether it holds what a slot says. */
bool tile_file_holds(const tile_file *file, const journal_slot *slot);
gw_status tile_file_sync(tile_file *file, gw_error *error);

/* The lit points of a part of the input. */
typedef struct tile_part {
	uint32_t part;
	size_t row, count; /* bytes of a point; points */
	uint8_t *bytes;    /* row * count; in the order of the input */
} tile_part;

/* Takes them out of all tiles. GW_ERROR_INTERNAL where some are in no tile. */
gw_status tile_file_part(const tile_file *file, const tile_part *part, gw_error *error);

#endif
