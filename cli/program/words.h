/*
 * words.h - a value on the command line that consists of words: "point at 1,2,1.5 intensity 40".
 */
#ifndef WORDS_H
#define WORDS_H

#include "glowworm.h"

#define WORD_MAX 256

/* The words of a text, and where in it they stand. Start with words_of. */
typedef struct words {
	const char *option; /* for messages: "--light" */
	const char *text, *at;
	char word[WORD_MAX];
	size_t place; /* of the word, counted from 1; behind the end: length + 1 */
	gw_error *error;
} words;

words words_of(const char *option, const char *text, gw_error *error);

/* Takes the next word; false at the end. Longer words are cut, which no legal word is. */
bool words_next(words *w);

/* GW_ERROR_USAGE with a sentence behind the text and the place of the word in it. */
gw_status words_fail(const words *w, const char *sentence);

/* Up to three numbers with commas between them; 0 when the word is something else. */
size_t words_numbers(const char *word, double values[3]);

#endif
