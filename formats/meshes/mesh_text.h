/*
 * mesh_text.h - lines and words of OBJ and MTL files.
 */
#ifndef MESH_TEXT_H
#define MESH_TEXT_H

#include "files/input_file.h"

/* Where in a text we are. Start with the bytes of the file and line 0. */
typedef struct mesh_text {
	const char *at, *end; /* what is left */
	const char *stop;     /* end of the current line */
	const char *word;     /* what is left of the current line */
	size_t line;          /* its number, from 1 */
	size_t next;          /* lines that it takes */
} mesh_text;

typedef struct mesh_word {
	const char *text;
	size_t length; /* 0: there was none */
} mesh_word;

mesh_text mesh_text_start(const input_file *in);

/* Goes to the next line; false at the end. Lines end in LF, CRLF or CR; a backslash before the end
 * joins a line with the next. */
bool mesh_text_next(mesh_text *text);

/* The next word of the line. One that begins with # is a comment, and the line ends before it. */
mesh_word mesh_text_word(mesh_text *text);

/* The rest of the line without blanks at its ends, for names, which may hold blanks and #. */
mesh_word mesh_text_rest(const mesh_text *text);

bool mesh_word_is(mesh_word word, const char *name);

/* The next word as a number; false when it is none. */
bool mesh_text_number(mesh_text *text, double *value);

/* A word fit for a message: short, and nothing that a terminal would obey. */
const char *mesh_word_show(mesh_word word, char shown[44]);

#endif
