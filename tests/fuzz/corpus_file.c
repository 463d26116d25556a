#include "corpus_file.h"
#include "files/little_endian.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>

bool corpus_open(corpus *c, const char *path)
{
	*c = (corpus){ 0 };
	FILE *file = fopen(path, "rb");
	if (!file)
		return errno == ENOENT;
	fseek(file, 0, SEEK_END);
	long end = ftell(file);
	rewind(file);
	bool good = end >= 0;
	c->length = good ? (size_t)end : 0;
	c->bytes = malloc(c->length + 1);
	good = good && c->bytes && fread(c->bytes, 1, c->length, file) == c->length;
	fclose(file);
	if (!good)
		corpus_close(c);
	return good;
}

bool corpus_next(corpus *c, const uint8_t **data, size_t *length)
{
	if (c->length - c->next < 4)
		return false;
	size_t size = load_32(c->bytes + c->next);
	if (size > c->length - c->next - 4)
		return false;
	*data = c->bytes + c->next + 4;
	*length = size;
	c->next += 4 + size;
	return true;
}

void corpus_close(corpus *c)
{
	free(c->bytes);
	*c = (corpus){ 0 };
}
