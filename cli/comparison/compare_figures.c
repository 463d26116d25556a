#include "comparison/compare_figures.h"
#include "program/exit_code.h"
#include "program/json_writer.h"
#include "options/preview.h"
#include "points/scan_color.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *const row_name[COMPARE_ROWS] = { "luminance", "red", "green", "blue" };

/* The pairs' values of one quantity. */
typedef struct values {
	double *found, *truth;
} values;

static gw_status allocate(values *v, size_t count, gw_error *error)
{
	v->found = reallocarray(NULL, count, sizeof *v->found);
	v->truth = reallocarray(NULL, count, sizeof *v->truth);
	if (!v->found || !v->truth)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to compare %zu points", count);
	return GW_OK;
}

static double row_value(const scan_column *const column[3], compare_row row, size_t i)
{
	if (row != COMPARE_LUMINANCE)
		return scan_value(column[row - COMPARE_RED], i);
	float rgb[3];
	for (int k = 0; k < 3; k++)
		rgb[k] = (float)scan_value(column[k], i);
	return preview_luminance(rgb);
}

static void fill_values(const matched_scans *m, const scan_column *const found[3],
						const scan_column *const truth[3], compare_row row, const values *v)
{
	for (size_t i = 0; i < m->count; i++) {
		v->found[i] = row_value(found, row, m->in_found[i]);
		v->truth[i] = row_value(truth, row, m->in_truth[i]);
	}
}

/* Radiance that is not finite is no light; say where it is. */
static gw_status check_finite(const scan_column *const column[3], const size_t *place, size_t count,
							  const char *file, gw_error *error)
{
	size_t bad = 0, first = 0;
	for (size_t i = 0; i < count; i++) {
		bool finite = true;
		for (int k = 0; k < 3; k++)
			finite = finite && isfinite(scan_value(column[k], place[i]));
		if (!finite && bad++ == 0)
			first = place[i];
	}
	if (bad == 0)
		return GW_OK;
	return gw_fail(
		error, GW_ERROR_DATA,
		"%s: %zu of the %zu points to compare have a %s that is not finite, the first at "
		"place %zu; there is no figure for that",
		file, bad, count, column[0]->name, first);
}

static gw_status compare_rows(const matched_scans *m, const scan_column *const found[3],
							  const scan_column *const truth[3], values *v,
							  compare_component *component, gw_error *error)
{
	GW_TRY(check_finite(found, m->in_found, m->count, m->found_name, error));
	GW_TRY(check_finite(truth, m->in_truth, m->count, m->truth_name, error));
	GW_TRY(allocate(v, m->count, error));
	for (int row = 0; row < COMPARE_ROWS; row++) {
		fill_values(m, found, truth, (compare_row)row, v);
		GW_TRY(gw_compare(v->found, v->truth, m->count, &component->row[row], error));
	}
	return GW_OK;
}

static gw_status compare_columns(const matched_scans *m, const scan_column *const found[3],
								 const scan_column *const truth[3], compare_component *component,
								 gw_error *error)
{
	values v = { 0 };
	gw_status status = compare_rows(m, found, truth, &v, component, error);
	free(v.found);
	free(v.truth);
	return status;
}

/* ------------------------------------------------------------------------------ quantities */

static gw_status find_radiance(const scan *cloud, const char *file, const scan_column *column[3],
							   gw_error *error)
{
	static const char *const name[3] = { "radiance_r", "radiance_g", "radiance_b" };
	if (scan_find_triple(cloud, name, column))
		return GW_OK;
	return gw_fail(error, GW_ERROR_DATA,
				   "%s has no columns scalar_radiance_r, scalar_radiance_g and scalar_radiance_b; "
				   "light it with glowworm bake",
				   file);
}

/* The columns of one more quantity, under one name in both: what `direct` means without the prefix
 * is not ours to say. */
static bool find_common(const matched_scans *m, const char *name, const scan_column *found[3],
						const scan_column *truth[3])
{
	for (int k = 0; k < 3; k++) {
		char full[64];
		snprintf(full, sizeof full, "scalar_%s_%c", name, "rgb"[k]);
		found[k] = scan_find(m->found, full);
		truth[k] = scan_find(m->truth, full);
		if (!found[k] || !truth[k])
			return false;
	}
	return true;
}

static double share(double difference, double mean)
{
	return difference == 0.0 ? 0.0 : difference / fabs(mean);
}

/* Errors of the points, and how well the truth knows itself. */
static gw_status find_errors(compare_figures *f, const scan_column *const found[3],
							 const scan_column *const truth[3], gw_error *error)
{
	const matched_scans *m = f->match;
	double mean = f->component[0].row[COMPARE_LUMINANCE].truth_mean, sum = 0.0;
	const scan_column *own = scan_find_scalar(m->truth, "stderr");
	f->error = reallocarray(NULL, m->count, sizeof *f->error);
	if (!f->error)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the errors of %zu points", m->count);
	for (size_t i = 0; i < m->count; i++) {
		f->error[i] = share(row_value(found, COMPARE_LUMINANCE, m->in_found[i]) -
								row_value(truth, COMPARE_LUMINANCE, m->in_truth[i]),
							mean);
		double e = own ? scan_value(own, m->in_truth[i]) : 0.0;
		sum += e * e;
	}
	f->truth_error = own ? share(sqrt(sum / (double)m->count), mean) : NAN;
	return GW_OK;
}

gw_status compare_figures_make(const matched_scans *match, compare_figures *f, gw_error *error)
{
	static const char *const more[] = { "direct", "indirect", "irradiance", "direct_irradiance",
										"indirect_irradiance" };
	const scan_column *found[3], *truth[3];
	*f = (compare_figures){ .match = match };
	GW_TRY(find_radiance(match->found, match->found_name, found, error));
	GW_TRY(find_radiance(match->truth, match->truth_name, truth, error));
	f->component[f->component_count++].name = "radiance";
	GW_TRY(compare_columns(match, found, truth, &f->component[0], error));
	GW_TRY(find_errors(f, found, truth, error));
	for (size_t i = 0; i < sizeof more / sizeof *more; i++) {
		if (!find_common(match, more[i], found, truth))
			continue;
		compare_component *component = &f->component[f->component_count++];
		component->name = more[i];
		GW_TRY(compare_columns(match, found, truth, component, error));
	}
	return GW_OK;
}

void compare_figures_clear(compare_figures *f)
{
	free(f->error);
	f->error = NULL;
}

/* ----------------------------------------------------------------------------------- output */

/* Characters of the first column: the longest name and a space. */
static int width_of_names(const compare_figures *f)
{
	size_t longest = sizeof "irradiance" - 1;
	for (size_t i = 0; i < f->component_count; i++)
		if (strlen(f->component[i].name) > longest)
			longest = strlen(f->component[i].name);
	return (int)longest + 1;
}

static void print_row(FILE *out, int width, const char *component, const char *row,
					  const gw_comparison *c)
{
	fprintf(out, "%-*s%-10s %9.2f %9.2f %+9.2f %9.2f %9.2f %9.2f %9.2f %12.5g\n", width, component,
			row, 100.0 * c->rel_rmse, 100.0 * c->best_99, 100.0 * c->bias, 100.0 * c->percentile_50,
			100.0 * c->percentile_95, 100.0 * c->percentile_99, 100.0 * c->maximum, c->truth_mean);
}

/* relRMSE of the radiance beyond the truth's own error: the two are independent, so their squares
 * add up. */
static double beyond_truth(const compare_figures *f)
{
	double all = f->component[0].row[COMPARE_LUMINANCE].rel_rmse;
	if (isnan(f->truth_error))
		return NAN;
	return sqrt(fmax(all * all - f->truth_error * f->truth_error, 0.0));
}

void compare_figures_print(const compare_figures *f, FILE *out)
{
	const matched_scans *m = f->match;
	const int width = width_of_names(f);
	fprintf(out, "%s against %s, points matched by %s: %zu compared", m->found_name, m->truth_name,
			matched_by_name(m->by), m->count);
	if (m->untold)
		fprintf(out, ", %zu of which only their light tells from others at their %s", m->untold,
				m->by == MATCHED_BY_INDEX ? "index" : "place");
	if (m->emitting)
		fprintf(out, ", %zu left out that emit", m->emitting);
	if (m->not_finite)
		fprintf(out, ", %zu left out without a place", m->not_finite);
	fprintf(out, "\n%-*s %9s %9s %9s %9s %9s %9s %9s %12s\n", width + 10, "% of the truth's mean",
			"relRMSE", "best 99%", "bias", "50th", "95th", "99th", "largest", "mean");
	for (size_t i = 0; i < f->component_count; i++)
		for (int row = 0; row < COMPARE_ROWS; row++)
			print_row(out, width, row ? "" : f->component[i].name, row_name[row],
					  &f->component[i].row[row]);
	if (!isnan(f->truth_error))
		fprintf(out,
				"the truth itself is known to %.2f %% (RMS of its standard error); without it the "
				"radiance is %.2f %% off\n",
				100.0 * f->truth_error, 100.0 * beyond_truth(f));
}

static void put_comparison(json_writer *json, const char *name, const gw_comparison *c)
{
	json_put_open_flat(json, name, '{');
	json_put_real(json, "relrmse", c->rel_rmse);
	json_put_real(json, "best99", c->best_99);
	json_put_real(json, "bias", c->bias);
	json_put_real(json, "percentile_50", c->percentile_50);
	json_put_real(json, "percentile_95", c->percentile_95);
	json_put_real(json, "percentile_99", c->percentile_99);
	json_put_real(json, "maximum", c->maximum);
	json_put_real(json, "mean", c->mean);
	json_put_real(json, "truth_mean", c->truth_mean);
	json_put_close(json, '}');
}

void compare_figures_json(const compare_figures *f, bool missed, FILE *out)
{
	const matched_scans *m = f->match;
	json_writer json = { .out = out, .lines = true };
	json_put_open(&json, NULL, '{');
	json_put_text(&json, "result", m->found_name);
	json_put_text(&json, "truth", m->truth_name);
	json_put_text(&json, "matched_by", matched_by_name(m->by));
	json_put_count(&json, "points", m->count);
	json_put_count(&json, "emitting", m->emitting);
	json_put_count(&json, "not_finite", m->not_finite);
	json_put_count(&json, "shared", m->shared);
	json_put_count(&json, "told_by_light", m->untold);
	json_put_bool(&json, "missed", missed);
	json_put_real(&json, "truth_error", f->truth_error);
	json_put_real(&json, "beyond_truth_error", beyond_truth(f));
	for (size_t i = 0; i < f->component_count; i++) {
		json_put_open(&json, f->component[i].name, '{');
		for (int row = 0; row < COMPARE_ROWS; row++)
			put_comparison(&json, row_name[row], &f->component[i].row[row]);
		json_put_close(&json, '}');
	}
	json_put_close(&json, '}');
	fputc('\n', out);
}

/* ----------------------------------------------------------------------------------- limits */

static bool exceeds(double value, float limit)
{
	return !isnan(limit) && !(value <= (double)limit);
}

gw_status compare_figures_check(const compare_figures *f, const settings *s, gw_error *error)
{
	const gw_comparison *c = &f->component[0].row[COMPARE_LUMINANCE];
	if (exceeds(c->rel_rmse, s->max_rel_rmse))
		return gw_fail(error, STATUS_MISSED,
					   "relRMSE is %.3f %%, more than --max-relrmse %g allows", 100.0 * c->rel_rmse,
					   (double)s->max_rel_rmse);
	if (exceeds(c->best_99, s->max_best_99))
		return gw_fail(error, STATUS_MISSED,
					   "the best 99 %% are off by %.3f %%, more than --max-best99 %g allows",
					   100.0 * c->best_99, (double)s->max_best_99);
	if (exceeds(fabs(c->bias), s->max_bias))
		return gw_fail(error, STATUS_MISSED, "the bias is %+.3f %%, more than --max-bias %g allows",
					   100.0 * c->bias, (double)s->max_bias);
	return GW_OK;
}
