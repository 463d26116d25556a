/*
 * luminaire_eulumdat.c - EULUMDAT (.ldt): a value a line. Of several sets of lamps, which take each
 * other's place, the first counts.
 */
#include "luminaires/luminaire_lines.h"
#include "luminaires/luminaire_planes.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define MILLIMETRE 1e-3

typedef struct ldt_head {
	double symmetry;      /* 0: none, 1: all around, 2: C 0 to 180, 3: C 90 to 270, 4: both */
	double planes, steps; /* how many C planes all around, and angles in each */
	double out;           /* share of the lamps' light that leaves the luminaire, % */
	double factor;        /* of all intensities */
} ldt_head;

static gw_status skip_lines(luminaire_lines *lines, size_t count)
{
	char unused[LUMINAIRE_TEXT];
	for (size_t i = 0; i < count; i++)
		if (!luminaire_lines_next(lines, unused))
			return luminaire_lines_fail(lines, "the file ends before its angles");
	return GW_OK;
}

static gw_status read_text(luminaire_lines *lines, char *text)
{
	return luminaire_lines_next(lines, text)
			   ? GW_OK
			   : luminaire_lines_fail(lines, "the file ends before its angles");
}

/* A line's number, which has to be in a range. */
static gw_status read_within(luminaire_lines *lines, const char *what, double least, double most,
							 double *value)
{
	GW_TRY(luminaire_lines_value(lines, what, value));
	luminaire_lines before = *lines;
	before.line--;
	if (!(*value >= least && *value <= most))
		return luminaire_lines_fail(&before, "%s is %g; it must be from %g to %g", what, *value,
									least, most);
	return GW_OK;
}

static gw_status read_whole(luminaire_lines *lines, const char *what, double least, double most,
							double *value)
{
	GW_TRY(read_within(lines, what, least, most, value));
	luminaire_lines before = *lines;
	before.line--;
	return *value == floor(*value)
			   ? GW_OK
			   : luminaire_lines_fail(&before, "%s is %g; it must be whole", what, *value);
}

/* Lines 1 to 12. */
static gw_status read_names(luminaire_lines *lines, ldt_head *head, luminaire *l)
{
	double step;
	GW_TRY(read_text(lines, l->maker));
	GW_TRY(read_whole(lines, "the type of the luminaire", 0, 3, &step));
	GW_TRY(read_whole(lines, "the symmetry", 0, 4, &head->symmetry));
	GW_TRY(read_whole(lines, "the number of C planes", 1, LUMINAIRE_ANGLES, &head->planes));
	GW_TRY(read_within(lines, "the distance between C planes", 0, 360, &step));
	GW_TRY(read_whole(lines, "the number of intensities in a plane", 2, LUMINAIRE_ANGLES,
					  &head->steps));
	GW_TRY(read_within(lines, "the distance between intensities", 0, 180, &step));
	GW_TRY(skip_lines(lines, 1));
	GW_TRY(read_text(lines, l->model));
	return skip_lines(lines, 3);
}

/* Lines 13 to 25: sizes, of which those of the luminous area count; it is as long as C 90 goes. */
static gw_status read_body(luminaire_lines *lines, ldt_head *head, luminaire *l)
{
	double length, width, unused;
	for (int k = 0; k < 3; k++)
		GW_TRY(luminaire_lines_value(lines, "a size of the luminaire", &unused));
	GW_TRY(read_within(lines, "the length of the luminous area", 0, 1e6, &length));
	GW_TRY(read_within(lines, "the width of the luminous area", 0, 1e6, &width));
	for (int k = 0; k < 4; k++) {
		GW_TRY(read_within(lines, "a height of the luminous area", 0, 1e6, &unused));
		l->size[2] = fmax(l->size[2], unused * MILLIMETRE);
	}
	l->round = length > 0.0 && width == 0.0;
	l->size[0] = (l->round ? length : width) * MILLIMETRE;
	l->size[1] = length * MILLIMETRE;
	GW_TRY(luminaire_lines_value(lines, "the share of light that goes down", &unused));
	GW_TRY(read_within(lines, "the light output ratio", 0, 1000, &head->out));
	GW_TRY(read_within(lines, "the conversion factor", 0, 1e6, &head->factor));
	return luminaire_lines_value(lines, "the tilt while it was measured", &unused);
}

/* Line 26, with six for each set. Below 0 lamps are what absolute photometry has. */
static gw_status read_lamps(luminaire_lines *lines, luminaire *l)
{
	double sets, lamps;
	GW_TRY(read_whole(lines, "the number of sets of lamps", 1, 100, &sets));
	GW_TRY(read_within(lines, "the number of lamps", -1e6, 1e6, &lamps));
	GW_TRY(read_text(lines, l->lamp));
	GW_TRY(read_within(lines, "the flux of the lamps", 0, 1e12, &l->lamp_lumens));
	GW_TRY(skip_lines(lines, 2));
	GW_TRY(read_within(lines, "the watts", 0, 1e9, &l->watts));
	return skip_lines(lines, 6 * ((size_t)sets - 1));
}

/* Which of the planes all around the file has. */
static void choose_planes(const ldt_head *head, size_t *first, size_t *count)
{
	size_t all = (size_t)head->planes;
	*first = head->symmetry == 3.0 ? all / 4 : 0;
	*count = head->symmetry == 0.0   ? all
			 : head->symmetry == 1.0 ? 1
			 : head->symmetry == 4.0 ? all / 4 + 1
									 : all / 2 + 1;
	if (*first + *count > all)
		*count = all - *first;
}

static gw_status read_list(luminaire_lines *lines, const char *what, size_t count, double **values)
{
	return luminaire_lines_numbers(lines, luminaire_lines_value, what, count, values);
}

static gw_status check_end(luminaire_lines *lines)
{
	char line[LUMINAIRE_TEXT];
	while (luminaire_lines_next(lines, line))
		if (line[0] >= '0' && line[0] <= '9')
			return luminaire_lines_fail(lines,
										"there are more intensities than the file announces");
	return GW_OK;
}

static gw_status read_planes(luminaire_lines *lines, const ldt_head *head, const luminaire *of,
							 luminaire_planes *planes)
{
	size_t first;
	GW_TRY(read_list(lines, "a C angle", (size_t)head->planes, &planes->horizontal));
	planes->verticals = (size_t)head->steps;
	GW_TRY(read_list(lines, "an angle in a plane", planes->verticals, &planes->vertical));
	choose_planes(head, &first, &planes->horizontals);
	size_t count = planes->horizontals * planes->verticals;
	for (size_t i = 0; planes->horizontal && i < planes->horizontals; i++)
		planes->horizontal[i] = planes->horizontal[first + i];
	planes->around = head->symmetry == 0.0;
	planes->photometry = 'C';
	GW_TRY(read_list(lines, "an intensity", count, &planes->candela));
	for (size_t i = 0; i < count; i++) /* from candela for 1000 lumens of the lamps */
		planes->candela[i] *= head->factor * of->lamp_lumens / 1000.0;
	return check_end(lines);
}

static gw_status read_all(luminaire_lines *lines, luminaire_planes *planes, luminaire *l)
{
	ldt_head head = { .planes = 0.0 };
	GW_TRY(read_names(lines, &head, l));
	GW_TRY(read_body(lines, &head, l));
	GW_TRY(read_lamps(lines, l));
	GW_TRY(skip_lines(lines, 10)); /* the share that reaches a room's floor, for ten rooms */
	l->stated_lumens = l->lamp_lumens * head.out / 100.0;
	snprintf(l->format, sizeof l->format, "EULUMDAT");
	return read_planes(lines, &head, l, planes);
}

gw_status luminaire_eulumdat_read(const input_file *in, luminaire *l, gw_error *error)
{
	return luminaire_planes_read(in, read_all, l, error);
}
