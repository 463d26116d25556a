/* Text for people: messages and percent. */
#include "program/exit_code.h"
#include "program/text_quote.h"

#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static void assert_message(const char *given, const char *expected)
{
	char *text = NULL;
	size_t length;
	FILE *out = open_memstream(&text, &length);
	assert_non_null(out);
	text_message(out, "%s", given);
	assert_int_equal(fclose(out), 0);
	assert_string_equal(text, expected);
	free(text);
}

static void messages_are_shown_not_obeyed(void **state)
{
	(void)state;
	assert_message("plain\n", "plain\n");
	assert_message("two\nlines\n", "two\\x0alines\n");
	assert_message("\033[2J\r\t\177", "\\x1b[2J\\x0d\\x09\\x7f");
	assert_message("h\303\266hle", "h\303\266hle");
	assert_message("\302\233 \233 \303", "\\xc2\\x9b \\x9b \\xc3");
	assert_message("", "");
}

static ssize_t count_piece(void *user, const char *bytes, size_t length)
{
	(void)bytes;
	++*(int *)user;
	return (ssize_t)length;
}

/* A message reaches a terminal without a buffer, as standard error is, in one piece: nothing that
 * another process writes comes into it. */
static void messages_are_written_whole(void **state)
{
	(void)state;
	const cookie_io_functions_t terminal = { .write = count_piece };
	int pieces = 0;
	FILE *out = fopencookie(&pieces, "w", terminal);
	assert_non_null(out);
	setvbuf(out, NULL, _IONBF, 0);
	text_message(out, "glowworm: %s\n", "a name with \033 in it");
	assert_int_equal(pieces, 1);
	fclose(out);
}

static void percent_has_no_exponent(void **state)
{
	(void)state;
	static const struct {
		double share;
		const char *text;
	} rows[] = {
		{ 0.0, "0" },        { 0.13, "13" },           { 0.1349, "13" },    { 0.031, "3.1" },
		{ 0.03, "3" },       { 0.00031, "0.031" },     { 0.99499, "99" },   { 0.996, "100" },
		{ 9.9, "990" },      { 9.94, "990" },          { 123.4, "12000" },  { -0.031, "-3.1" },
		{ 5e-7, "0.00005" }, { 4.9e-9, "0.00000049" }, { INFINITY, "inf" }, { 2.9e-20, "0" },
	};
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		char text[TEXT_PERCENT];
		assert_string_equal(text_percent(rows[i].share, text), rows[i].text);
	}
}

/* A terminal that takes nothing of the so-manyth piece, and all before and after it. */
static ssize_t take_piece(void *user, const char *bytes, size_t length)
{
	int *left = user;
	(void)bytes;
	if (--*left != 0)
		return (ssize_t)length;
	errno = EAGAIN;
	return 0;
}

/* Prints 60 characters through a buffer of 16, of which one write is lost, numbered from 1. False
 * where there were fewer writes: then all arrived. */
static bool lose_write(int lost)
{
	const cookie_io_functions_t terminal = { .write = take_piece };
	int left = lost;
	char buffer[16];
	gw_error error = { 0 };
	FILE *out = fopencookie(&left, "w", terminal);
	assert_non_null(out);
	setvbuf(out, buffer, _IOFBF, sizeof buffer);
	for (int i = 0; i < 3; i++)
		fputs("twenty characters...", out);
	gw_status status = exit_code_flush(out, &error);
	bool hit = left <= 0;
	assert_int_equal(status, hit ? FILE_ERROR_IO : GW_OK);
	assert_true(!hit || strstr(error.text, "standard output cannot be written"));
	fclose(out);
	return hit;
}

/* Whichever write is lost: of 60 characters at least one, and at most as many as characters. */
static void printed_text_has_arrived(void **state)
{
	(void)state;
	int writes = 0;
	while (writes <= 60 && lose_write(writes + 1))
		writes++;
	assert_in_range(writes, 1, 60);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(messages_are_shown_not_obeyed),
		cmocka_unit_test(messages_are_written_whole),
		cmocka_unit_test(percent_has_no_exponent),
		cmocka_unit_test(printed_text_has_arrived),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
