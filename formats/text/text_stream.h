/*
 * text_stream.h - a table of text, some of its rows at a time.
 */
#ifndef TEXT_STREAM_H
#define TEXT_STREAM_H

#include "text/text_columns.h"

typedef struct text_stream {
	text_rows rows;   /* where the lines that were read last begin and end, and how rows look */
	const char *end;  /* of the text */
	text_names names; /* owned; of the columns */
	scan facts;       /* owned; of no points: comments for the first piece */
	bool counted;     /* lines of one number count the rows; */
	bool some_counts; /* there were some, */
	double counts;    /* of so many rows so far; */
	uint64_t found;   /* so many came */
	size_t lines;     /* that were read last */
	bool begun;
} text_stream;

/*
 * Takes a table's lines from rows.begin on.
 *   rows    as for text_rows_count, with the text's end; its width is that of the names
 *   names   taken
 */
text_stream text_stream_make(const text_rows *rows, text_names *names);

/* format_stream.next of such a table: at most so many lines. */
gw_status text_stream_next(text_stream *stream, size_t most, scan *piece, gw_error *error);

void text_stream_clear(text_stream *stream);

/* Opens the table of a file: stream is to be given back with text_stream_clear, also on failure. */
typedef gw_status text_stream_opener(const input_file *in, text_stream *stream, gw_error *error);

/* All of a file's rows, as format.read has them. */
gw_status text_stream_read(const input_file *in, text_stream_opener *open, scan *cloud,
						   gw_error *error);

/* The same piece by piece, as format_stream has it. */
gw_status text_stream_new(const input_file *in, text_stream_opener *open, void **state,
						  gw_error *error);
gw_status text_stream_next_piece(void *state, size_t most, scan *piece, gw_error *error);
void text_stream_free(void *state);

/* format_stream.guess by how long lines are in the begin of the text. */
uint64_t text_stream_guess(input_file *in);

/* Behind how many lines, at most `most`, a text goes on; *found receives how many they were. */
const char *text_stream_skip(const text_rows *rows, const char *at, const char *end, size_t most,
							 size_t *found);

#endif
