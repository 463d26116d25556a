/*
 * format_pieces.h - a file's points from the first to the last, some at a time: in parts where it
 * can be read so, as a stream where its format is one, or else all of them in one piece.
 */
#ifndef FORMAT_PIECES_H
#define FORMAT_PIECES_H

#include "table/format_parts.h"

typedef struct format_pieces {
	const char *path; /* leads to the caller's, as do the options */
	format_options options;
	format_parts parts;  /* its file is open, whether it can be read in parts or not */
	const format *found; /* NULL: no format that is known */
	void *stream;        /* of its format */
	uint64_t guess;      /* points of the file, about */
	bool together;       /* all come in one piece */
	uint64_t next;       /* point, of parts */
	bool begun;
} format_pieces;

/*
 * Opens a file, which is no pipe, and not empty: of others nothing is found.
 *   pieces   to be given back with format_pieces_close, also on failure
 * Fails like input_file_open_as.
 */
gw_status format_pieces_open(const char *path, const format_options *options, format_pieces *pieces,
							 gw_error *error);

/*
 * Reads the next points, at most so many unless they come in one piece; none: they are all read.
 *   piece   to be freed with scan_clear; empty on failure
 */
gw_status format_pieces_next(format_pieces *pieces, size_t most, scan *piece, gw_error *error);

void format_pieces_close(format_pieces *pieces);

#endif
