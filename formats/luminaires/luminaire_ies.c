/*
 * luminaire_ies.c - IES LM-63 of 1986, 1991, 1995, 2002 and 2019: lines of words up to TILT=,
 * numbers behind it.
 */
#include "luminaires/luminaire_lines.h"
#include "luminaires/luminaire_planes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define FOOT 0.3048 /* metres */

/* What stands before the angles. */
typedef struct ies_head {
	double lamps, lumens; /* of one lamp; below 0: the photometry is absolute */
	double multiplier;    /* of all intensities */
	double ballast;       /* factor of it */
	double lamp_ballast;  /* likewise; from 2002 on something else stands there */
	double size[3];       /* width, length, height, in its unit */
	bool feet;
} ies_head;

/* ------------------------------------------------------------------------------------ words */

static void take_word(const char *line, const char *key, char *to)
{
	size_t length = strlen(key);
	if (strncasecmp(line, key, length) != 0 || *to)
		return;
	const char *text = line + length;
	while (*text == ' ')
		text++;
	snprintf(to, LUMINAIRE_TEXT, "%s", text);
}

/* The year of the standard, from the first line. */
static unsigned find_year(const char *line)
{
	static const struct {
		const char *text;
		unsigned year;
	} known[] = { { "IESNA91", 1991 },
				  { "IESNA:LM-63-1995", 1995 },
				  { "IESNA:LM-63-2002", 2002 },
				  { "IES:LM-63-2019", 2019 } };
	for (size_t i = 0; i < sizeof known / sizeof *known; i++)
		if (strncasecmp(line, known[i].text, strlen(known[i].text)) == 0)
			return known[i].year;
	return strncasecmp(line, "IES", 3) == 0 ? 2002 : 1986;
}

static gw_status read_words(luminaire_lines *lines, luminaire *l, unsigned *year, char *tilt)
{
	char line[LUMINAIRE_TEXT], other[LUMINAIRE_TEXT] = "";
	bool first = true;
	while (luminaire_lines_next(lines, line)) {
		if (strncasecmp(line, "TILT=", 5) == 0) {
			snprintf(tilt, LUMINAIRE_TEXT, "%s", line + 5);
			if (!l->model[0])
				memcpy(l->model, other, sizeof other);
			return GW_OK;
		}
		if (first)
			*year = find_year(line);
		take_word(line, "[MANUFAC]", l->maker);
		take_word(line, "[LUMINAIRE]", l->model);
		take_word(line, "[LUMCAT]", other);
		take_word(line, "[LAMP]", l->lamp);
		if (*year == 1986 && !other[0])
			memcpy(other, line, sizeof other);
		first = false;
	}
	return luminaire_lines_fail(lines, "the file ends before a line that begins with TILT=");
}

/* ------------------------------------------------------------------------------------- tilt */

static gw_status read_tilt_table(luminaire_lines *lines, luminaire *l)
{
	size_t geometry, count;
	GW_TRY(luminaire_lines_count(lines, "the way a lamp lies in its luminaire", 1, 3, &geometry));
	GW_TRY(luminaire_lines_count(lines, "the number of tilts", 1, LUMINAIRE_TILTS, &count));
	double *tilt = l->tilt, *factor = l->tilt_factor;
	for (size_t i = 0; i < count; i++) {
		GW_TRY(luminaire_lines_number(lines, "a tilt", &tilt[i]));
		if (tilt[i] < 0.0 || tilt[i] > 180.0 || (i > 0 && tilt[i] <= tilt[i - 1]))
			return luminaire_lines_fail(lines, "tilt %zu is %g; they must ascend from 0 to 180",
										i + 1, tilt[i]);
	}
	for (size_t i = 0; i < count; i++) {
		GW_TRY(luminaire_lines_number(lines, "a factor of a tilt", &factor[i]));
		if (factor[i] < 0.0)
			return luminaire_lines_fail(lines, "the factor of a tilt is %g; it must be 0 or more",
										factor[i]);
	}
	l->tilts = count;
	return GW_OK;
}

static gw_status read_tilt(luminaire_lines *lines, const char *tilt, luminaire *l)
{
	if (strcasecmp(tilt, "NONE") == 0)
		return GW_OK;
	if (strcasecmp(tilt, "INCLUDE") == 0)
		return read_tilt_table(lines, l);
	return luminaire_lines_fail(lines,
								"TILT=%.60s names another file, which is not read; write "
								"TILT=INCLUDE and put its lines behind it",
								tilt);
}

/* ------------------------------------------------------------------------------------- head */

static gw_status read_factor(luminaire_lines *lines, const char *what, bool zero, double *value)
{
	GW_TRY(luminaire_lines_number(lines, what, value));
	if (*value < 0.0 || (!zero && *value == 0.0))
		return luminaire_lines_fail(lines, "%s is %g; it must be %s", what, *value,
									zero ? "0 or more" : "above 0");
	return GW_OK;
}

static gw_status read_counts(luminaire_lines *lines, ies_head *head, luminaire_planes *planes)
{
	size_t lamps, type, units;
	GW_TRY(luminaire_lines_count(lines, "the number of lamps", 1, 1e6, &lamps));
	head->lamps = (double)lamps;
	GW_TRY(luminaire_lines_number(lines, "the lumens of a lamp", &head->lumens));
	GW_TRY(read_factor(lines, "the candela multiplier", false, &head->multiplier));
	GW_TRY(luminaire_lines_count(lines, "the number of vertical angles", 2, LUMINAIRE_ANGLES,
								 &planes->verticals));
	GW_TRY(luminaire_lines_count(lines, "the number of horizontal angles", 1, LUMINAIRE_ANGLES,
								 &planes->horizontals));
	GW_TRY(
		luminaire_lines_count(lines, "the type of the photometry (1: C, 2: B, 3: A)", 1, 3, &type));
	GW_TRY(luminaire_lines_count(lines, "the unit of lengths (1: feet, 2: metres)", 1, 2, &units));
	planes->photometry = "CBA"[type - 1];
	head->feet = units == 1;
	return GW_OK;
}

static gw_status read_head(luminaire_lines *lines, ies_head *head, luminaire_planes *planes,
						   double *watts)
{
	static const char *const side[] = { "the width", "the length", "the height" };
	GW_TRY(read_counts(lines, head, planes));
	for (int k = 0; k < 3; k++)
		GW_TRY(luminaire_lines_number(lines, side[k], &head->size[k]));
	GW_TRY(read_factor(lines, "the ballast factor", false, &head->ballast));
	GW_TRY(luminaire_lines_number(lines, "the factor behind that of the ballast",
								  &head->lamp_ballast));
	GW_TRY(read_factor(lines, "the input watts", true, watts));
	return GW_OK;
}

/* Sizes below 0 are those of round openings. */
static void put_size(const ies_head *head, luminaire *l)
{
	double unit = head->feet ? FOOT : 1.0;
	l->round = head->size[0] < 0.0 || head->size[1] < 0.0;
	for (int k = 0; k < 3; k++)
		l->size[k] = fabs(head->size[k]) * unit;
	if (l->round && !(l->size[0] > 0.0))
		l->size[0] = l->size[1];
	if (l->round && !(l->size[1] > 0.0))
		l->size[1] = l->size[0];
}

/* ------------------------------------------------------------------------------------ planes */

static gw_status check_end(luminaire_lines *lines)
{
	double more;
	gw_error unused = { 0 };
	luminaire_lines ahead = *lines;
	ahead.error = &unused;
	bool any = luminaire_lines_number(&ahead, "nothing", &more) == GW_OK;
	ahead.error = lines->error;
	if (any)
		return luminaire_lines_fail(&ahead, "there are more intensities than the file announces");
	return GW_OK;
}

static gw_status read_list(luminaire_lines *lines, const char *what, size_t count, double **values)
{
	return luminaire_lines_numbers(lines, luminaire_lines_number, what, count, values);
}

static gw_status read_planes(luminaire_lines *lines, double factor, luminaire_planes *planes)
{
	size_t count = planes->verticals * planes->horizontals;
	GW_TRY(read_list(lines, "a vertical angle", planes->verticals, &planes->vertical));
	GW_TRY(read_list(lines, "a horizontal angle", planes->horizontals, &planes->horizontal));
	GW_TRY(read_list(lines, "an intensity", count, &planes->candela));
	for (size_t i = 0; i < count; i++)
		planes->candela[i] *= factor;
	return check_end(lines);
}

static gw_status read_all(luminaire_lines *lines, luminaire_planes *planes, luminaire *l)
{
	char tilt[LUMINAIRE_TEXT];
	unsigned year = 1986;
	ies_head head;
	GW_TRY(read_words(lines, l, &year, tilt));
	GW_TRY(read_tilt(lines, tilt, l));
	GW_TRY(read_head(lines, &head, planes, &l->watts));
	put_size(&head, l);
	if (year < 2002 && head.lamp_ballast <= 0.0)
		return luminaire_lines_fail(
			lines, "the factor of ballast and lamp is %g; it must be above 0", head.lamp_ballast);
	double factor = head.multiplier * head.ballast * (year < 2002 ? head.lamp_ballast : 1.0);
	l->lamp_lumens = head.lumens > 0.0 ? head.lumens * head.lamps : 0.0;
	snprintf(l->format, sizeof l->format, "IES LM-63-%u", year);
	return read_planes(lines, factor, planes);
}

gw_status luminaire_ies_read(const input_file *in, luminaire *l, gw_error *error)
{
	return luminaire_planes_read(in, read_all, l, error);
}
