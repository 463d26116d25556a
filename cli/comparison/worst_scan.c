#include "comparison/worst_scan.h"
#include "points/scan_color.h"

#include <stdlib.h>
#include <string.h>

static const char *const own_name[] = { "scalar_error", "scalar_truth_radiance_r",
										"scalar_truth_radiance_g", "scalar_truth_radiance_b" };

static bool is_own(const char *name)
{
	for (size_t i = 0; i < sizeof own_name / sizeof *own_name; i++)
		if (strcmp(name, own_name[i]) == 0)
			return true;
	return false;
}

/* Copies a column for the pairs in `pair`. */
static gw_status pick_column(scan *worst, const scan_column *from, const size_t *place,
							 const size_t *pair, gw_error *error)
{
	scan_column *to = scan_add_column(worst, from->name, from->type, error);
	if (!to)
		return error && error->status ? error->status : GW_ERROR_MEMORY;
	size_t size = scan_type_size(from->type);
	for (size_t i = 0; i < worst->count; i++)
		memcpy((char *)to->data + i * size, (const char *)from->data + place[pair[i]] * size, size);
	return GW_OK;
}

static gw_status add_own(const compare_figures *f, scan *worst, const size_t *pair, gw_error *error)
{
	static const char *const radiance[3] = { "radiance_r", "radiance_g", "radiance_b" };
	const scan_column *truth[3];
	float *data[4];
	scan_find_triple(f->match->truth, radiance, truth);
	for (int k = 0; k < 4; k++) {
		scan_column *column = scan_add_column(worst, own_name[k], SCAN_FLOAT32, error);
		if (!column)
			return GW_ERROR_MEMORY;
		data[k] = column->data;
	}
	for (size_t i = 0; i < worst->count; i++) {
		data[0][i] = (float)f->error[pair[i]];
		for (int k = 0; k < 3; k++)
			data[k + 1][i] = (float)scan_value(truth[k], f->match->in_truth[pair[i]]);
	}
	return GW_OK;
}

/* pair: room for worst->count numbers. */
static gw_status fill_worst(const compare_figures *f, size_t *pair, scan *worst, gw_error *error)
{
	const matched_scans *m = f->match;
	GW_TRY(gw_compare_worst(f->error, m->count, worst->count, pair, error));
	GW_TRY(scan_add_comment(worst, "glowworm compare: the points with the largest errors", error));
	for (size_t c = 0; c < m->found->column_count; c++)
		if (!is_own(m->found->column[c].name))
			GW_TRY(pick_column(worst, &m->found->column[c], m->in_found, pair, error));
	return add_own(f, worst, pair, error);
}

gw_status worst_scan_make(const compare_figures *f, size_t wanted, scan *worst, gw_error *error)
{
	const matched_scans *m = f->match;
	size_t count = wanted < m->count ? wanted : m->count;
	*worst = (scan){ .count = count, .up = m->found->up };
	size_t *pair = reallocarray(NULL, count, sizeof *pair);
	if (!pair)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the %zu worst points", count);
	gw_status status = fill_worst(f, pair, worst, error);
	free(pair);
	if (status != GW_OK)
		scan_clear(worst);
	return status;
}
