/* e57_names.c - see e57_names.h. */
#include "e57/e57_names.h"
#include "points/scan.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Columns that come in threes, and what they are called then. */
static const char *const threes[][3][2] = {
	{ { "x", "cartesianX" }, { "y", "cartesianY" }, { "z", "cartesianZ" } },
	{ { "red", "colorRed" }, { "green", "colorGreen" }, { "blue", "colorBlue" } },
	{ { "nx", E57_NORMALS ":normalX" },
	  { "ny", E57_NORMALS ":normalY" },
	  { "nz", E57_NORMALS ":normalZ" } },
};

/* Those of which the standard knows more than that they are numbers. */
static const struct {
	const char *name;
	bool whole; /* has to be integers */
} known[] = { { "intensity", false },         { "timeStamp", false },
			  { "rowIndex", true },           { "columnIndex", true },
			  { "returnIndex", true },        { "returnCount", true },
			  { "isIntensityInvalid", true }, { "isColorInvalid", true },
			  { "isTimeStampInvalid", true } };

/* The standard's name for a column, or NULL. */
static const char *standard_name(const scan *cloud, const scan_column *column)
{
	bool whole = column->type != SCAN_FLOAT32 && column->type != SCAN_FLOAT64;
	for (size_t k = 0; k < sizeof known / sizeof *known; k++)
		if (strcmp(column->name, known[k].name) == 0 && (whole || !known[k].whole))
			return known[k].name;
	for (size_t t = 0; t < sizeof threes / sizeof *threes; t++) {
		const char *found = NULL;
		bool all = true;
		for (int k = 0; k < 3; k++) {
			all = all && scan_find(cloud, threes[t][k][0]);
			if (strcmp(column->name, threes[t][k][0]) == 0)
				found = threes[t][k][1];
		}
		if (found && all)
			return found;
	}
	return NULL;
}

/* What a name in XML can have at its beginning, and behind it; an underline before an x is what the
 * others are told by. */
static bool is_plain(const char *c, bool first)
{
	static const char letters[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ";
	static const char others[] = "0123456789-.";
	if (*c == '_')
		return c[1] != 'x';
	return strchr(letters, *c) != NULL || (!first && strchr(others, *c) != NULL);
}

char *e57_name_write(const scan *cloud, const scan_column *column)
{
	char *text = NULL;
	size_t length;
	const char *standard = standard_name(cloud, column);
	if (standard)
		return strdup(standard);
	FILE *out = open_memstream(&text, &length);
	if (!out)
		return NULL;
	fputs(E57_OURS ":", out);
	for (const char *c = column->name; *c; c++) {
		if (is_plain(c, c == column->name))
			fputc(*c, out);
		else
			fprintf(out, "_x%02x_", (unsigned)(unsigned char)*c);
	}
	if (!column->name[0])
		fputs("unnamed", out);
	if (fclose(out) == 0)
		return text;
	free(text);
	return NULL;
}

/* The byte that "_x20_" stands for; -1: it is not that. */
static int read_byte(const char *text)
{
	static const char digits[] = "0123456789abcdef";
	if (strncmp(text, "_x", 2) != 0 || !text[2] || !text[3] || text[4] != '_')
		return -1;
	const char *high = strchr(digits, text[2]), *low = strchr(digits, text[3]);
	int byte = high && low ? (int)(16 * (high - digits) + (low - digits)) : -1;
	return byte > 0 ? byte : -1;
}

char *e57_name_read(const char *field, bool *ours)
{
	static const char prefix[] = E57_OURS ":";
	*ours = strncmp(field, prefix, sizeof prefix - 1) == 0 && field[sizeof prefix - 1];
	char *name = *ours ? malloc(strlen(field) + 1) : NULL, *end = name;
	for (const char *c = field + sizeof prefix - 1; name && *c;) {
		int byte = read_byte(c);
		*end++ = byte < 0 ? *c : (char)byte;
		c += byte < 0 ? 1 : 5;
	}
	if (name)
		*end = '\0';
	return name;
}
