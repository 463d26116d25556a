/*
 * sample_e57.c - see sample_scans.h
 *
 * An E57 file (ASTM E2807) is a header, a section of packets for each scan, and XML that describes
 * them, cut into pages of 1020 bytes with a checksum of 4 behind each. It is built in memory
 * without the checksums and paged when it is written.
 */
#include "sample_points.h"
#include "sample_scans.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PAGE ((size_t)1024)
#define CONTENT ((size_t)1020) /* bytes of a page before its checksum */
#define HEADER 48
#define PACKET_RECORDS ((size_t)2048) /* a multiple of 8, so that all fields end on a byte */
#define INTENSITY 4095

/* The bytes of the file without checksums. */
typedef struct content {
	uint8_t *data; /* owned */
	size_t length, capacity;
} content;

static void need(content *c, size_t more)
{
	if (c->capacity - c->length >= more)
		return;
	size_t capacity = 2 * c->capacity + more;
	uint8_t *grown = realloc(c->data, capacity);
	if (!grown) {
		fprintf(stderr, "no memory for %zu bytes; ask for fewer points\n", capacity);
		exit(SAMPLE_EXIT_MEMORY);
	}
	c->data = grown;
	c->capacity = capacity;
}

static void store(uint8_t *to, uint64_t value, size_t size)
{
	for (size_t i = 0; i < size; i++)
		to[i] = (uint8_t)(value >> 8 * i);
}

static void put(content *c, uint64_t value, size_t size)
{
	need(c, size);
	store(c->data + c->length, value, size);
	c->length += size;
}

__attribute__((format(printf, 2, 3))) static void print(content *c, const char *text, ...)
{
	va_list list;
	char line[1024];

	va_start(list, text);
	int length = vsnprintf(line, sizeof line, text, list);
	va_end(list);
	for (int i = 0; i < length && i < (int)sizeof line - 1; i++)
		put(c, (uint8_t)line[i], 1);
}

/* Where byte `at` stands in the paged file. */
static size_t paged(size_t at)
{
	return at / CONTENT * PAGE + at % CONTENT;
}

/* -------------------------------------------------------------------------------- records */

typedef struct field {
	const char *name;
	int64_t minimum, maximum;
	double scale; /* 0 for plain integers */
	unsigned bits;
} field;

enum { X, Y, Z, STATE, ROW, COLUMN, BRIGHT, RED, GREEN, BLUE, FIELDS };

static int64_t steps(double metres)
{
	return llrint(metres / SAMPLE_E57_STEP);
}

/* Value of a field of cell i of a scan. */
static int64_t value_of(const sample_scan *s, size_t i, int which)
{
	const sample_cell *c = &s->cell[i];

	switch (which) {
	case X:
	case Y:
	case Z:
		return c->hole ? 0 : steps(c->position[which]);
	case STATE:
		return c->hole ? 2 : 0;
	case ROW:
		return (int64_t)(i % s->rows);
	case COLUMN:
		return (int64_t)(i / s->rows);
	case BRIGHT:
		return c->hole ? 0 : llrintf(c->intensity * INTENSITY);
	default:
		return c->hole ? 0 : c->color[which - RED];
	}
}

/* The fields of a scan; coordinates from the least to the greatest that are there, with 0. */
static void make_fields(const sample_scan *s, field f[FIELDS])
{
	const field plain[FIELDS] = {
		[X] = { .name = "cartesianX", .scale = SAMPLE_E57_STEP },
		[Y] = { .name = "cartesianY", .scale = SAMPLE_E57_STEP },
		[Z] = { .name = "cartesianZ", .scale = SAMPLE_E57_STEP },
		[STATE] = { .name = "cartesianInvalidState", .maximum = 2 },
		[ROW] = { .name = "rowIndex", .maximum = (int64_t)s->rows - 1 },
		[COLUMN] = { .name = "columnIndex", .maximum = (int64_t)s->columns - 1 },
		[BRIGHT] = { .name = "intensity", .maximum = INTENSITY },
		[RED] = { .name = "colorRed", .maximum = 255 },
		[GREEN] = { .name = "colorGreen", .maximum = 255 },
		[BLUE] = { .name = "colorBlue", .maximum = 255 },
	};

	for (int k = 0; k < FIELDS; k++) {
		f[k] = plain[k];
		for (size_t i = 0; k <= Z && i < s->columns * s->rows; i++) {
			int64_t v = value_of(s, i, k);
			f[k].minimum = v < f[k].minimum ? v : f[k].minimum;
			f[k].maximum = v > f[k].maximum ? v : f[k].maximum;
		}
		uint64_t range = (uint64_t)(f[k].maximum - f[k].minimum);
		while (range >> f[k].bits)
			f[k].bits++;
	}
}

/* A field's values of some records, each in its bits, the lowest first. Returns the bytes. */
static size_t put_stream(content *c, const sample_scan *s, const field *f, int which, size_t first,
						 size_t last)
{
	size_t size = ((last - first) * f->bits + 7) / 8, bit = 0;

	need(c, size);
	uint8_t *to = c->data + c->length;
	memset(to, 0, size);
	for (size_t i = first; i < last; i++) {
		uint64_t v = (uint64_t)(value_of(s, i, which) - f->minimum);
		for (unsigned k = 0; k < f->bits; k++, bit++)
			to[bit / 8] = (uint8_t)(to[bit / 8] | (v >> k & 1) << bit % 8);
	}
	c->length += size;
	return size;
}

/* A data packet: its size, the sizes of the fields' stretches, and the stretches. */
static void put_packet(content *c, const sample_scan *s, const field *f, size_t first, size_t last)
{
	size_t start = c->length;

	put(c, 1, 2);
	put(c, 0, 2);
	put(c, FIELDS, 2);
	for (int k = 0; k < FIELDS; k++)
		put(c, 0, 2);
	for (int k = 0; k < FIELDS; k++) {
		size_t size = put_stream(c, s, &f[k], k, first, last);
		store(c->data + start + 6 + 2 * (size_t)k, size, 2);
	}
	while ((c->length - start) % 4)
		put(c, 0, 1);
	store(c->data + start + 2, c->length - start - 1, 2);
}

/* The section of a scan's records; returns where it begins. */
static size_t put_section(content *c, const sample_scan *s, const field *f)
{
	size_t count = s->columns * s->rows, start = c->length;

	put(c, 1, 8);
	put(c, 0, 8);
	put(c, paged(start + 32), 8);
	put(c, 0, 8);
	for (size_t i = 0; i < count; i += PACKET_RECORDS)
		put_packet(c, s, f, i, i + PACKET_RECORDS < count ? i + PACKET_RECORDS : count);
	store(c->data + start + 8, c->length - start, 8);
	return start;
}

/* ---------------------------------------------------------------------------- description */

/* Rotation as a unit quaternion w x y z; rotations here turn less than half a turn. */
static void make_quaternion(const double r[9], double q[4])
{
	q[0] = 0.5 * sqrt(1 + r[0] + r[4] + r[8]);
	q[1] = (r[7] - r[5]) / (4 * q[0]);
	q[2] = (r[2] - r[6]) / (4 * q[0]);
	q[3] = (r[3] - r[1]) / (4 * q[0]);
}

static void print_pose(content *c, const sample_scan *s)
{
	static const char axis[4] = { 'w', 'x', 'y', 'z' };
	double q[4];

	make_quaternion(s->rotation, q);
	print(c, "<pose type=\"Structure\">\n<rotation type=\"Structure\">");
	for (int k = 0; k < 4; k++)
		print(c, "<%c type=\"Float\">%.17g</%c>", axis[k], q[k], axis[k]);
	print(c, "</rotation>\n<translation type=\"Structure\">");
	for (int k = 0; k < 3; k++)
		print(c, "<%c type=\"Float\">%.17g</%c>", axis[k + 1], s->translation[k], axis[k + 1]);
	print(c, "</translation>\n</pose>\n");
}

static void print_limits(content *c)
{
	static const char *const color[3] = { "Red", "Green", "Blue" };

	print(c,
		  "<intensityLimits type=\"Structure\"><intensityMinimum type=\"Integer\">0"
		  "</intensityMinimum><intensityMaximum type=\"Integer\">%d</intensityMaximum>"
		  "</intensityLimits>\n<colorLimits type=\"Structure\">",
		  INTENSITY);
	for (int k = 0; k < 3; k++)
		print(c,
			  "<color%sMinimum type=\"Integer\">0</color%sMinimum>"
			  "<color%sMaximum type=\"Integer\">255</color%sMaximum>",
			  color[k], color[k], color[k], color[k]);
	print(c, "</colorLimits>\n");
}

static void print_field(content *c, const field *f)
{
	print(c, "<%s type=\"%s\" minimum=\"%lld\" maximum=\"%lld\"", f->name,
		  f->scale > 0 ? "ScaledInteger" : "Integer", (long long)f->minimum, (long long)f->maximum);
	if (f->scale > 0)
		print(c, " scale=\"%.17g\" offset=\"0\"", f->scale);
	print(c, "/>\n");
}

/* The identifiers need only differ from those of other scans of the file. */
static void print_scan(content *c, const sample_scan *s, const field *f, size_t index,
					   size_t section)
{
	print(c,
		  "<vectorChild type=\"Structure\">\n<guid type=\"String\">{scan-%zu}</guid>\n"
		  "<name type=\"String\">%s</name>\n",
		  index + 1, s->name);
	print(c,
		  "<indexBounds type=\"Structure\"><rowMinimum type=\"Integer\">0</rowMinimum>"
		  "<rowMaximum type=\"Integer\">%zu</rowMaximum><columnMinimum type=\"Integer\">0"
		  "</columnMinimum><columnMaximum type=\"Integer\">%zu</columnMaximum></indexBounds>\n",
		  s->rows - 1, s->columns - 1);
	print_limits(c);
	print_pose(c, s);
	print(c,
		  "<points type=\"CompressedVector\" fileOffset=\"%zu\" recordCount=\"%zu\">\n"
		  "<prototype type=\"Structure\">\n",
		  paged(section), s->columns * s->rows);
	for (int k = 0; k < FIELDS; k++)
		print_field(c, &f[k]);
	print(c, "</prototype>\n<codecs type=\"Vector\" allowHeterogeneousChildren=\"1\"></codecs>\n"
			 "</points>\n</vectorChild>\n");
}

/* ---------------------------------------------------------------------------------- pages */

/* CRC-32C; the table is made at the first call. */
static uint32_t checksum(const uint8_t *data, size_t length)
{
	static uint32_t table[256];
	uint32_t sum = UINT32_MAX;

	for (uint32_t b = 0; b < 256 && !table[255]; b++) {
		table[b] = b;
		for (int k = 0; k < 8; k++)
			table[b] = table[b] >> 1 ^ (table[b] & 1 ? 0x82f63b78u : 0);
	}
	for (size_t i = 0; i < length; i++)
		sum = sum >> 8 ^ table[(sum ^ data[i]) & 255];
	return ~sum;
}

/* The rest of the last page is blank, as the standard says. */
static int write_pages(content *c, const char *path)
{
	FILE *file;
	int status = sample_open(path, false, &file);

	while (c->length % CONTENT)
		put(c, 0, 1);
	for (size_t at = 0; !status && at < c->length && !ferror(file); at += CONTENT) {
		uint32_t sum = checksum(c->data + at, CONTENT);
		uint8_t tail[4] = { (uint8_t)(sum >> 24), (uint8_t)(sum >> 16), (uint8_t)(sum >> 8),
							(uint8_t)sum };
		fwrite(c->data + at, 1, CONTENT, file);
		fwrite(tail, 1, sizeof tail, file);
	}
	return status ? status : sample_close(file, path);
}

int sample_write_e57(const sample_scan *scan, size_t count, const char *path, const char *comment)
{
	content c = { 0 }, xml = { 0 };

	put(&c, 0, 8);
	memcpy(c.data, "ASTM-E57", 8);
	put(&c, 1, 4);
	for (size_t i = c.length; i < HEADER; i += 4)
		put(&c, i == 40 ? PAGE : 0, 4);
	print(&xml,
		  "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<e57Root type=\"Structure\" "
		  "xmlns=\"http://www.astm.org/COMMIT/E57/2010-e57-v1.0\">\n"
		  "<formatName type=\"String\">ASTM E57 3D Imaging Data File</formatName>\n"
		  "<guid type=\"String\">{%s}</guid>\n<versionMajor type=\"Integer\">1</versionMajor>\n"
		  "<versionMinor type=\"Integer\">0</versionMinor>\n"
		  "<data3D type=\"Vector\" allowHeterogeneousChildren=\"1\">\n",
		  comment);
	for (size_t i = 0; i < count; i++) {
		field f[FIELDS];
		make_fields(&scan[i], f);
		print_scan(&xml, &scan[i], f, i, put_section(&c, &scan[i], f));
	}
	print(&xml, "</data3D>\n"
				"<images2D type=\"Vector\" allowHeterogeneousChildren=\"1\"></images2D>\n"
				"</e57Root>\n");
	store(c.data + 24, paged(c.length), 8);
	store(c.data + 32, xml.length, 8);
	need(&c, xml.length);
	memcpy(c.data + c.length, xml.data, xml.length);
	c.length += xml.length;
	store(c.data + 16, (c.length + CONTENT - 1) / CONTENT * PAGE, 8);
	int status = write_pages(&c, path);
	free(xml.data);
	free(c.data);
	return status;
}
