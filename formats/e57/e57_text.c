/* e57_text.c - see e57_text.h. */
#include "e57/e57_text.h"
#include "e57/e57_names.h"
#include "e57/e57_sink.h"
#include "files/checksum.h"
#include "files/number_text.h"
#include "files/utf8_text.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---------------------------------------------------------------------------------- values */

/* Bytes of the character at the start of a text; 0 when it is none, or one that XML cannot have. */
static size_t character_length(const unsigned char *c)
{
	size_t length = utf8_length(c);
	return length == 3 && c[0] == 0xef && c[1] == 0xbf && c[2] >= 0xbe ? 0 : length;
}

/* Text of anybody's; what is no character of XML becomes a blank or a question mark. */
static void write_text(FILE *out, const char *text)
{
	for (const unsigned char *c = (const unsigned char *)text; *c;) {
		size_t length = character_length(c);
		if (*c < 0x20)
			fputc(' ', out);
		else if (length == 0)
			fputc('?', out);
		else if (*c == '<' || *c == '>' || *c == '&')
			fputs(*c == '<' ? "&lt;" : *c == '>' ? "&gt;" : "&amp;", out);
		else
			fwrite(c, 1, length, out);
		c += length ? length : 1;
	}
}

static void write_real(FILE *out, const char *name, double value)
{
	char number[NUMBER_TEXT];
	number_print(number, value);
	fprintf(out, "<%s type=\"Float\">%s</%s>", name, number, name);
}

static void write_integer(FILE *out, const char *name, int64_t value)
{
	fprintf(out, "<%s type=\"Integer\">%" PRId64 "</%s>", name, value, name);
}

/* A name that no other cloud has, and the same cloud always. */
static void write_guid(FILE *out, uint64_t sum, uint64_t number)
{
	checksum more = { 0 };
	checksum_add(&more, &sum, sizeof sum);
	checksum_add(&more, &number, sizeof number);
	uint64_t low = checksum_value(&more);
	fprintf(out, "<guid type=\"String\">{%08" PRIX32 "-%04X-%04X-%04X-%012" PRIX64 "}</guid>\n",
			(uint32_t)(sum >> 32), (unsigned)(sum >> 16 & 0xffff), (unsigned)(sum & 0xffff),
			(unsigned)(low >> 48), low & 0xffffffffffff);
}

/* Of values, what they are called, and comments. */
static uint64_t sum_of(const scan *cloud, uint64_t values)
{
	checksum sum = { 0 };
	checksum_add(&sum, &values, sizeof values);
	for (size_t c = 0; c < cloud->column_count; c++)
		checksum_add(&sum, cloud->column[c].name, strlen(cloud->column[c].name) + 1);
	for (size_t c = 0; c < cloud->comment_count; c++)
		checksum_add(&sum, cloud->comment[c], strlen(cloud->comment[c]) + 1);
	return checksum_value(&sum);
}

/* ----------------------------------------------------------------------------------- scans */

static const e57_out_field *find_field(const e57_out_scan *s, const char *name)
{
	for (size_t f = 0; f < s->field_count; f++)
		if (strcmp(s->field[f].field.name, name) == 0)
			return &s->field[f];
	return NULL;
}

/* A structure of limits of fields: PREFIXMinimum and PREFIXMaximum of each, if they are all there
 * and have some. */
static void write_limits(FILE *out, const e57_out_scan *s, const char *name,
						 const char *const field[], const char *const prefix[])
{
	char element[64];
	for (size_t k = 0; field[k]; k++) {
		const e57_out_field *f = find_field(s, field[k]);
		if (!f || !(f->low <= f->high))
			return;
	}
	fprintf(out, "<%s type=\"Structure\">", name);
	for (size_t k = 0; field[k]; k++) {
		const e57_out_field *f = find_field(s, field[k]);
		for (int end = 0; end < 2; end++) {
			snprintf(element, sizeof element, "%s%s", prefix[k], end ? "Maximum" : "Minimum");
			if (f->field.type == E57_INTEGER)
				write_integer(out, element, (int64_t)(end ? f->high : f->low));
			else
				write_real(out, element, end ? f->high : f->low);
		}
	}
	fprintf(out, "</%s>\n", name);
}

static void write_all_limits(FILE *out, const e57_out_scan *s)
{
	static const char *const position[] = { "cartesianX", "cartesianY", "cartesianZ", NULL };
	static const char *const axis[] = { "x", "y", "z" };
	static const char *const color[] = { "colorRed", "colorGreen", "colorBlue", NULL };
	static const char *const index[] = { "rowIndex", "columnIndex", NULL };
	static const char *const of_index[] = { "row", "column" };
	static const char *const intensity[] = { "intensity", NULL };
	write_limits(out, s, "cartesianBounds", position, axis);
	write_limits(out, s, "indexBounds", index, of_index);
	write_limits(out, s, "intensityLimits", intensity, intensity);
	write_limits(out, s, "colorLimits", color, color);
}

/* Points are turned to nothing: only the place is known. */
static void write_pose(FILE *out, const double place[3])
{
	static const char *const axis[4] = { "w", "x", "y", "z" };
	fputs("<pose type=\"Structure\"><rotation type=\"Structure\">", out);
	for (int k = 0; k < 4; k++)
		write_real(out, axis[k], k == 0 ? 1.0 : 0.0);
	fputs("</rotation><translation type=\"Structure\">", out);
	for (int k = 0; k < 3; k++)
		write_real(out, axis[k + 1], place[k]);
	fputs("</translation></pose>\n", out);
}

static void write_field(FILE *out, const e57_field *f)
{
	fprintf(out, "<%s type=\"%s\"", f->name, f->type == E57_INTEGER ? "Integer" : "Float");
	if (f->type == E57_INTEGER)
		fprintf(out, " minimum=\"%" PRId64 "\" maximum=\"%" PRId64 "\"/>\n", f->minimum,
				f->maximum);
	else
		fprintf(out, " precision=\"%s\"/>\n", f->type == E57_SINGLE ? "single" : "double");
}

static void write_scan(FILE *out, const e57_out_scan *s, uint64_t sum, size_t number)
{
	fputs("<vectorChild type=\"Structure\">\n", out);
	write_guid(out, sum, number);
	fprintf(out, "<name type=\"String\">scan %zu</name>\n", number);
	write_all_limits(out, s);
	if (s->place)
		write_pose(out, s->place);
	fprintf(out,
			"<points type=\"CompressedVector\" fileOffset=\"%" PRIu64 "\" recordCount=\"%zu\">\n"
			"<prototype type=\"Structure\">\n",
			e57_sink_place(s->at), s->count);
	for (size_t f = 0; f < s->field_count; f++)
		write_field(out, &s->field[f].field);
	fputs("</prototype>\n<codecs type=\"Vector\" allowHeterogeneousChildren=\"1\"></codecs>\n"
		  "</points>\n</vectorChild>\n",
		  out);
}

/* What readers found wrong is of that file. */
static void write_comments(FILE *out, const scan *cloud)
{
	fputs("<" E57_COMMENTS " type=\"Vector\" allowHeterogeneousChildren=\"1\">\n", out);
	for (size_t c = 0; c < cloud->comment_count; c++) {
		if (strncmp(cloud->comment[c], SCAN_NOTE, strlen(SCAN_NOTE)) == 0)
			continue;
		fputs("<vectorChild type=\"String\">", out);
		write_text(out, cloud->comment[c]);
		fputs("</vectorChild>\n", out);
	}
	fputs("</" E57_COMMENTS ">\n", out);
}

static void write_all(FILE *out, const e57_layout *layout, uint64_t values)
{
	uint64_t sum = sum_of(layout->cloud, values);
	fputs("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<e57Root type=\"Structure\" "
		  "xmlns=\"http://www.astm.org/COMMIT/E57/2010-e57-v1.0\" "
		  "xmlns:" E57_NORMALS "=\"" E57_NORMALS_URI "\" xmlns:" E57_OURS "=\"" E57_OURS_URI
		  "\">\n<formatName type=\"String\">ASTM E57 3D Imaging Data File</formatName>\n",
		  out);
	write_guid(out, sum, 0);
	fputs("<versionMajor type=\"Integer\">1</versionMajor>\n"
		  "<versionMinor type=\"Integer\">0</versionMinor>\n"
		  "<e57LibraryVersion type=\"String\">glowworm " GW_VERSION "</e57LibraryVersion>\n"
		  "<coordinateMetadata type=\"String\"></coordinateMetadata>\n"
		  "<data3D type=\"Vector\" allowHeterogeneousChildren=\"1\">\n",
		  out);
	for (size_t s = 0; s < layout->scan_count; s++)
		write_scan(out, &layout->scan[s], sum, s + 1);
	fputs("</data3D>\n<images2D type=\"Vector\" allowHeterogeneousChildren=\"1\"></images2D>\n",
		  out);
	write_comments(out, layout->cloud);
	fputs("</e57Root>\n", out);
}

gw_status e57_text_make(const e57_layout *layout, uint64_t sum, char **text, size_t *length,
						gw_error *error)
{
	*text = NULL;
	FILE *out = open_memstream(text, length);
	if (out)
		write_all(out, layout, sum);
	bool whole = out && !ferror(out);
	if (out && fclose(out) == 0 && whole && *text)
		return GW_OK;
	free(*text);
	*text = NULL;
	return gw_fail(error, GW_ERROR_MEMORY, "no memory for the description of an E57 file");
}
