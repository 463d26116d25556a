/*
 * scanner_text.h - where scanners stood, from text: "1,2,1.5", "@FILE" for a list of places, or
 * "none".
 */
#ifndef SCANNER_TEXT_H
#define SCANNER_TEXT_H

#include "options/settings.h"

/*
 * Adds what a text says to settings->scanner: X,Y,Z in metres, or @ and the name of a file with one
 * place a line, its numbers with commas or blanks between them; empty lines and what stands behind
 * # do not count. none says that nobody knows, and no place is taken.
 * GW_ERROR_USAGE for a text that is no place, GW_ERROR_DATA with file and line, or as
 * input_file_open.
 */
gw_status scanner_text_add(settings *settings, const char *text, gw_error *error);

#endif
