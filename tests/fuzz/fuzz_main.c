/*
 * fuzz_main.c - libFuzzer's way to the readers. GLOWWORM_FUZZ_READER names the one to feed.
 */
#include "fuzz_reader.h"

#include <stdio.h>
#include <stdlib.h>

int LLVMFuzzerInitialize(int *count, char ***arguments);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t length);

static fuzz_reader fed;

int LLVMFuzzerInitialize(int *count, char ***arguments)
{
	(void)count, (void)arguments;
	const char *name = getenv("GLOWWORM_FUZZ_READER");
	if (name && fuzz_reader_find(name, &fed))
		return 0;
	fprintf(stderr, "GLOWWORM_FUZZ_READER has to be one of:");
	for (size_t i = 0; fuzz_reader_at(i, &fed); i++)
		fprintf(stderr, " %s", fed.name);
	fprintf(stderr, "\n");
	exit(2);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t length)
{
	char complaint[GW_ERROR_TEXT];
	fuzz_reader_attempt(&fed, data, length, complaint);
	if (complaint[0]) {
		fprintf(stderr, "%s: %s\n", fed.name, complaint);
		abort();
	}
	return 0;
}
