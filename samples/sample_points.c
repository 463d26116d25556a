/* sample_points.c - see sample_points.h */
#include "sample_points.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

void sample_add(sample_list *list, const sample_point *point)
{
	if (list->count == list->capacity) {
		size_t capacity = list->capacity ? list->capacity * 2 : 1024;
		sample_point *grown = reallocarray(list->point, capacity, sizeof *grown);
		if (!grown) {
			fprintf(stderr, "no memory for %zu points; ask for fewer\n", capacity);
			exit(SAMPLE_EXIT_MEMORY);
		}
		list->point = grown;
		list->capacity = capacity;
	}
	list->point[list->count++] = *point;
}

void sample_thin(sample_list *list, size_t count, uint64_t *random)
{
	size_t kept = 0;
	size_t total = list->count;

	/* Selection sampling: keep with the chance (still needed) / (still to come). */
	for (size_t i = 0; i < total && kept < count; i++) {
		if (sample_random(random) * (double)(total - i) < (double)(count - kept))
			list->point[kept++] = list->point[i];
	}
	list->count = kept;
}

void sample_clear(sample_list *list)
{
	free(list->point);
	*list = (sample_list){ 0 };
}

static uint64_t next_bits(uint64_t *random)
{
	uint64_t z = (*random += 0x9e3779b97f4a7c15u);

	z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
	z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
	return z ^ (z >> 31);
}

double sample_random(uint64_t *random)
{
	return (double)(next_bits(random) >> 11) * 0x1p-53;
}

double sample_gaussian(uint64_t *random)
{
	double radius = sqrt(-2.0 * log(1.0 - sample_random(random)));

	return radius * cos(6.283185307179586 * sample_random(random));
}

uint8_t sample_srgb(float linear)
{
	double v = linear < 0 ? 0 : linear > 1 ? 1 : (double)linear;

	v = v <= 0.0031308 ? 12.92 * v : 1.055 * pow(v, 1 / 2.4) - 0.055;
	return (uint8_t)(v * 255 + 0.5);
}

/* Appends a float32 in little-endian order, whatever the machine's is. */
static uint8_t *put_float(uint8_t *to, float value)
{
	uint32_t bits;

	memcpy(&bits, &value, sizeof bits);
	for (int i = 0; i < 4; i++)
		*to++ = (uint8_t)(bits >> (8 * i));
	return to;
}

static uint8_t *put_vector(uint8_t *to, const float v[3])
{
	for (int i = 0; i < 3; i++)
		to = put_float(to, v[i]);
	return to;
}

/* z up to y up, a quarter turn about x that keeps right hands right. */
static void turn_y_up(float to[3], const float from[3])
{
	to[0] = from[0];
	to[1] = from[2];
	to[2] = -from[1];
}

static size_t encode(uint8_t *record, const sample_point *point, sample_format format)
{
	uint8_t *to = record;
	float turned[3];

	if (format == SAMPLE_CLOUD) {
		turn_y_up(turned, point->position);
		to = put_vector(to, turned);
		turn_y_up(turned, point->normal);
		to = put_vector(to, turned);
	} else {
		to = put_vector(to, point->position);
		to = put_vector(to, point->normal);
	}
	for (int i = 0; i < 3; i++)
		*to++ = sample_srgb(point->albedo[i]);
	if (format == SAMPLE_PLY)
		to = put_vector(to, point->emission);
	return (size_t)(to - record);
}

static void write_header(FILE *file, const sample_list *list, sample_format format,
						 const char *comment)
{
	if (format == SAMPLE_CLOUD) {
		for (int i = 0; i < 4; i++)
			putc((int)(list->count >> (8 * i) & 255), file);
		return;
	}
	fprintf(file,
			"ply\nformat binary_little_endian 1.0\ncomment %s\nelement vertex %zu\n"
			"property float x\nproperty float y\nproperty float z\n"
			"property float nx\nproperty float ny\nproperty float nz\n"
			"property uchar red\nproperty uchar green\nproperty uchar blue\n"
			"property float emission_r\nproperty float emission_g\nproperty float emission_b\n"
			"end_header\n",
			comment, list->count);
}

/* Removes a regular file that holds only a part; leaves pipes and devices alone. */
static void remove_partial(FILE *file, const char *path)
{
	struct stat status;

	if (file != stdout && fstat(fileno(file), &status) == 0 && S_ISREG(status.st_mode))
		unlink(path);
}

int sample_open(const char *path, bool text, FILE **file)
{
	bool to_stdout = strcmp(path, "-") == 0;

	*file = to_stdout ? stdout : fopen(path, "wb");
	if (!*file) {
		fprintf(stderr, "cannot create %s: %s\n", path, strerror(errno));
		return SAMPLE_EXIT_CREATE;
	}
	if (to_stdout && !text && isatty(STDOUT_FILENO)) {
		fprintf(stderr, "standard output is a terminal and the data are binary; "
						"use -o FILE or a pipe\n");
		return SAMPLE_EXIT_USAGE;
	}
	return 0;
}

int sample_close(FILE *file, const char *path)
{
	bool to_stdout = file == stdout;
	bool failed = fflush(file) != 0 || ferror(file);
	int cause = errno;

	if (failed)
		remove_partial(file, path);
	if (!to_stdout && fclose(file) != 0 && !failed) {
		failed = true;
		cause = errno;
		unlink(path);
	}
	if (failed) {
		fprintf(stderr, "cannot write %s: %s\n", to_stdout ? "standard output" : path,
				strerror(cause));
		return SAMPLE_EXIT_IO;
	}
	return 0;
}

int sample_write(const sample_list *list, const char *path, sample_format format,
				 const char *comment)
{
	uint8_t record[64];
	FILE *file;
	int status = sample_open(path, false, &file);

	if (status)
		return status;
	write_header(file, list, format, comment);
	for (size_t i = 0; i < list->count && !ferror(file); i++)
		fwrite(record, 1, encode(record, &list->point[i], format), file);
	return sample_close(file, path);
}

static void usage_error(const char *option, const char *text, const char *wanted)
{
	fprintf(stderr, "%s %s: wants %s\n", option, text, wanted);
	exit(SAMPLE_EXIT_USAGE);
}

size_t sample_parse_count(const char *option, const char *text, size_t maximum)
{
	char *end;
	char wanted[80];

	errno = 0;
	unsigned long long value = strtoull(text, &end, 10);
	if (errno || end == text || *end || text[0] == '-' || value < 1 || value > maximum) {
		snprintf(wanted, sizeof wanted, "a whole number from 1 to %zu", maximum);
		usage_error(option, text, wanted);
	}
	return (size_t)value;
}

uint64_t sample_parse_seed(const char *option, const char *text)
{
	char *end;

	errno = 0;
	unsigned long long value = strtoull(text, &end, 10);
	if (errno || end == text || *end || text[0] == '-')
		usage_error(option, text, "a whole number");
	return value;
}

double sample_parse_number(const char *option, const char *text, double minimum, double maximum)
{
	char *end;
	char wanted[80];
	double value = strtod(text, &end);

	if (end == text || *end || !(value >= minimum && value <= maximum)) {
		snprintf(wanted, sizeof wanted, "a number from %g to %g", minimum, maximum);
		usage_error(option, text, wanted);
	}
	return value;
}

void sample_parse_color(const char *option, const char *text, double maximum, float color[3])
{
	const char *from = text;
	int count = 0;
	char wanted[80];

	for (; count < 3; count++) {
		char *end;
		double value = strtod(from, &end);
		if (end == from || !(value >= 0 && value <= maximum))
			break;
		color[count] = (float)value;
		from = *end == ',' ? end + 1 : end;
		if (*end != ',') {
			count++;
			break;
		}
	}
	if ((count != 1 && count != 3) || *from || from == text || from[-1] == ',') {
		snprintf(wanted, sizeof wanted, "a number from 0 to %g, or three with commas", maximum);
		usage_error(option, text, wanted);
	}
	if (count == 1)
		color[1] = color[2] = color[0];
}
