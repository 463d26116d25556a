/*
 * What fuzzing found worth keeping: every reader reads its corpus again, whole and cut short. Run
 * under sanitizers, which see what a reader does wrong.
 */
#include "corpus_file.h"
#include "fuzz_reader.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* Places at which an input is cut, spread over its length. */
#define CUTS 12

static void replay(const fuzz_reader *reader, corpus *c, size_t *inputs, size_t *accepted)
{
	char complaint[GW_ERROR_TEXT];
	const uint8_t *data;
	size_t length;
	while (corpus_next(c, &data, &length)) {
		for (size_t cut = 0; cut <= CUTS; cut++) {
			size_t size = length - length * cut / (CUTS + 1);
			gw_status status = fuzz_reader_attempt(reader, data, size, complaint);
			if (complaint[0])
				fail_msg("%s, input %zu cut to %zu: %s", reader->name, *inputs, size, complaint);
			*accepted += status == GW_OK;
		}
		++*inputs;
	}
	if (c->next != c->length)
		fail_msg("the corpus of %s is cut short", reader->name);
}

/* Each has inputs, and many of them all are good files. */
static void every_corpus_is_read(void **state)
{
	(void)state;
	fuzz_reader reader;
	size_t accepted = 0;
	for (size_t i = 0; fuzz_reader_at(i, &reader); i++) {
		char path[4096];
		snprintf(path, sizeof path, "tests/fuzz/%s.corpus", reader.name);
		corpus c;
		size_t inputs = 0;
		assert_true(corpus_open(&c, path));
		replay(&reader, &c, &inputs, &accepted);
		corpus_close(&c);
		if (inputs < 5)
			fail_msg("%s has %zu inputs", path, inputs);
	}
	assert_true(accepted > 1000);
}

int main(void)
{
	const struct CMUnitTest tests[] = { cmocka_unit_test(every_corpus_is_read) };
	return cmocka_run_group_tests(tests, NULL, NULL);
}
