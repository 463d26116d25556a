/*
 * option_text.h - the table of options as text: help, manual pages, completions.
 */
#ifndef OPTION_TEXT_H
#define OPTION_TEXT_H

#include "options/options.h"

#include <stdio.h>

/* A line for each verb. */
void option_text_usage(FILE *out);

/* What a verb is for, examples, and its options in 80 columns: all of them, or the common ones. */
void option_text_help(verb verb, bool all, FILE *out);

/*
 * Writes what is generated: "man-glowworm", "man-glowworm-VERB" (the part of the page that repeats
 * the tables, in roff), "bash", "zsh", "fish". GW_ERROR_USAGE when there is no such thing.
 */
gw_status option_text_generate(const char *what, FILE *out, gw_error *error);

#endif
