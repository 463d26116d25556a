#include "las/las_survey.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The formats with the most fields that are written. */
static const unsigned widest[LAS_AGES] = { [LAS_OLD] = 3, [LAS_NEW] = 8 };

gw_status las_survey_begin(las_survey *s, const char *name, gw_error *error)
{
	const double zero[3] = { 0 };
	*s = (las_survey){ .name = name };
	for (int age = 0; age < LAS_AGES; age++) {
		GW_TRY(las_layout_make(&s->layout[age], widest[age], zero, zero, error));
		s->fits[age] = calloc(s->layout[age].count, 1);
		if (!s->fits[age])
			return gw_fail(error, GW_ERROR_MEMORY, "no memory to write %s", name);
	}
	return GW_OK;
}

void las_survey_clear(las_survey *s)
{
	for (int age = 0; age < LAS_AGES; age++) {
		las_layout_clear(&s->layout[age]);
		free(s->fits[age]);
	}
	for (int k = 0; k < 3; k++)
		las_grid_search_clear(&s->axis[k]);
	*s = (las_survey){ .count = 0 };
}

/* Whether the column's type alone says that its values go there. */
static bool is_same(const las_field *field, const scan_column *column)
{
	return field->bits == 0 && las_field_type(field) == column->type;
}

/* True when a field holds every value of a column exactly. */
static bool fits(const las_field *field, const scan_column *column, size_t count)
{
	if (field->kind == LAS_FLOAT64)
		return column->type == SCAN_FLOAT64;
	size_t bits = field->bits ? field->bits : 8 * las_kind_size(field->kind);
	bool negative = field->kind == LAS_INT8 || field->kind == LAS_INT16;
	double high = ldexp(1.0, (int)bits - negative) - 1.0, low = negative ? -high - 1.0 : 0.0;
	for (size_t i = 0; i < count && !is_same(field, column); i++) {
		double value = scan_value(column, i);
		if (!(value >= low && value <= high) || value != floor(value))
			return false;
	}
	return true;
}

/* Colours are another matter, and coordinates. */
static void try_fields(las_survey *s, int age, const scan *part)
{
	for (size_t f = 3; f < s->layout[age].count; f++) {
		const las_field *field = &s->layout[age].field[f];
		const scan_column *column = scan_find(part, field->name);
		if (!column || las_field_is_color(field->name))
			continue;
		s->fits[age][f] |= LAS_SURVEY_SEEN;
		if (!(s->fits[age][f] & LAS_SURVEY_UNFIT) && !fits(field, column, part->count))
			s->fits[age][f] |= LAS_SURVEY_UNFIT;
	}
}

/* How many points have each return number from 1 to 15. */
static void count_returns(las_survey *s, const scan *part)
{
	const scan_column *column = scan_find(part, "return_number");
	for (size_t i = 0; column && i < part->count; i++) {
		double number = scan_value(column, i);
		if (number >= 1.0 && number < 16.0)
			s->returns[(int)number - 1]++;
	}
}

static void add_values(las_survey *s, const scan *part)
{
	scan_color color;
	for (int age = 0; age < LAS_AGES; age++)
		try_fields(s, age, part);
	count_returns(s, part);
	(void)scan_color_tally_add(&s->color, part, scan_color_names, &color);
	s->count += part->count;
}

gw_status las_survey_add(las_survey *s, const scan *part, gw_error *error)
{
	for (int k = 0; k < 3; k++)
		if (!s->again || s->axis[k].decimal)
			GW_TRY(las_grid_search_add(&s->axis[k], part, k, s->name, error));
	if (!s->again)
		add_values(s, part);
	return GW_OK;
}

gw_status las_survey_go_on(las_survey *s, bool *again, gw_error *error)
{
	*again = false;
	for (int k = 0; k < 3; k++) {
		bool axis_again;
		GW_TRY(las_grid_search_go_on(&s->axis[k], s->name, &axis_again, error));
		*again = *again || axis_again;
	}
	s->again = true;
	return GW_OK;
}

gw_status las_survey_all(las_survey *s, const scan *cloud, gw_error *error)
{
	for (int k = 0; k < 3; k++)
		GW_TRY(las_grid_search_alone(&s->axis[k], cloud, k, s->name, error));
	add_values(s, cloud);
	return GW_OK;
}

/* Columns that came after the survey go where their type says so. */
bool las_survey_fits(const las_survey *s, unsigned age, const las_field *field,
					 const scan_column *column)
{
	const las_layout *layout = &s->layout[age];
	for (size_t f = 0; f < layout->count; f++)
		if (strcmp(layout->field[f].name, field->name) == 0 && s->fits[age][f] != 0)
			return !(s->fits[age][f] & LAS_SURVEY_UNFIT);
	return field->kind == LAS_FLOAT64 ? column->type == SCAN_FLOAT64 : is_same(field, column);
}
