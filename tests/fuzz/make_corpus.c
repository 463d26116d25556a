/*
 * make_corpus.c - between a reader's corpus and the folder of files that a fuzzer wants.
 *
 *   make_corpus unpack READER CORPUS FOLDER   the tests' own small files and the corpus as files
 *   make_corpus pack CORPUS FILE...           files as a corpus
 *   make_corpus readers                       prints the names of all readers
 */
#include "corpus_file.h"
#include "e57_file.h"
#include "fuzz_reader.h"
#include "laz_samples.h"
#include "luminaire_files.h"
#include "files/little_endian.h"
#include "panorama_files.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int written;

static int put_file(const char *folder, const uint8_t *data, size_t length)
{
	char path[4096];
	snprintf(path, sizeof path, "%s/seed-%04d", folder, written++);
	FILE *file = fopen(path, "wb");
	bool good = file && fwrite(data, 1, length, file) == length;
	if ((file && fclose(file) != 0) || !good) {
		fprintf(stderr, "make_corpus: %s cannot be written\n", path);
		return 1;
	}
	return 0;
}

/* E57 goes in as its content, with the lengths that its pages would have. */
static int put_seed(const char *folder, const seed *s)
{
	if (!s->xml)
		return put_file(folder, s->data, s->length);
	uint8_t pages[E57_FILE_PAGES(sizeof s->data)], content[sizeof s->data];
	e57_file_pages(s->data, s->length, s->xml, pages);
	memcpy(content, s->data, s->length);
	memcpy(content, pages, 48);
	return put_file(folder, content, s->length);
}

static int put_las(const char *reader, const char *folder)
{
	uint8_t file[LAZ_SAMPLE_BYTES];
	int failed = 0;
	for (int s = 0; s < LAZ_SAMPLES && strcmp(reader, "laz") == 0; s++)
		failed |= put_file(folder, file, laz_sample_packed(&laz_samples[s], file));
	for (unsigned f = 0; f <= 10 && strcmp(reader, "las") == 0; f++)
		failed |= put_file(folder, file, laz_sample_plain(f, f % 3, file));
	return failed;
}

static int put_maps(const char *reader, const char *folder)
{
	uint8_t file[PANORAMA_FILE_ROOM];
	int failed = 0;
	for (int k = 0; k < 2 && strcmp(reader, "hdr") == 0; k++)
		failed |= put_file(folder, file, panorama_file_hdr(k, file));
	for (int k = 0; k < 2 && strcmp(reader, "exr") == 0; k++)
		failed |= put_file(folder, file, panorama_file_exr(k, file));
	if (strcmp(reader, "exr") == 0)
		failed |= put_file(folder, file, panorama_file_tiles(file));
	return failed;
}

static double shape(double x, double y, double z)
{
	return 10.0 + 5.0 * x * x + fabs(y) + 2.0 * z;
}

static int put_luminaires(const char *reader, const char *folder)
{
	static char text[LUMINAIRE_FILE];
	static const luminaire_grid grid = { { 0, 90, 30 }, { 0, 90, 30 } };
	int failed = 0;
	for (int k = 0; k < 3 && strcmp(reader, "ies") == 0; k++)
		failed |=
			put_file(folder, (uint8_t *)text, luminaire_file_ies(text, "CBA"[k], &grid, shape));
	for (int k = 0; k < 5 && strcmp(reader, "ldt") == 0; k++)
		failed |= put_file(folder, (uint8_t *)text, luminaire_file_eulumdat(text, k, shape));
	return failed;
}

static int unpack(const char *reader, const char *path, const char *folder)
{
	static seed seeds[SEEDS];
	seed_files_make(seeds);
	int failed =
		put_las(reader, folder) | put_maps(reader, folder) | put_luminaires(reader, folder);
	for (int i = 0; i < SEEDS; i++) {
		bool same = strcmp(reader, "csv") == 0 && strcmp(seeds[i].format, "xyz") == 0;
		same |= strcmp(reader, "off") == 0 && strcmp(seeds[i].format, "mesh-off") == 0;
		if (same || strcmp(seeds[i].format, reader) == 0)
			failed |= put_seed(folder, &seeds[i]);
	}
	corpus c;
	if (!corpus_open(&c, path)) {
		fprintf(stderr, "make_corpus: %s cannot be read\n", path);
		return 1;
	}
	const uint8_t *data;
	size_t length;
	while (corpus_next(&c, &data, &length))
		failed |= put_file(folder, data, length);
	corpus_close(&c);
	return failed;
}

static bool append(FILE *out, const char *path)
{
	static uint8_t data[1 << 20];
	uint8_t size[4];
	FILE *in = fopen(path, "rb");
	if (!in)
		return false;
	size_t length = fread(data, 1, sizeof data, in);
	fclose(in);
	store_32(size, (uint32_t)length);
	return fwrite(size, 1, 4, out) == 4 && fwrite(data, 1, length, out) == length;
}

static int pack(const char *path, char **files)
{
	FILE *out = fopen(path, "wb");
	bool good = out != NULL;
	for (; good && *files; files++)
		good = append(out, *files);
	if ((out && fclose(out) != 0) || !good) {
		fprintf(stderr, "make_corpus: %s cannot be written from its files\n", path);
		return 1;
	}
	return 0;
}

int main(int count, char **arguments)
{
	if (count == 5 && strcmp(arguments[1], "unpack") == 0)
		return unpack(arguments[2], arguments[3], arguments[4]);
	if (count >= 3 && strcmp(arguments[1], "pack") == 0)
		return pack(arguments[2], arguments + 3);
	fuzz_reader reader;
	for (size_t i = 0; count == 2 && fuzz_reader_at(i, &reader); i++)
		puts(reader.name);
	return count == 2 ? 0 : 2;
}
