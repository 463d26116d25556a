#include "comparison/matched_scans.h"
#include "comparison/shared_places.h"
#include "glowworm_picture.h"
#include "las/las_notes.h"
#include "points/scan_color.h"

#include <math.h>
#include <stdlib.h>

/* On what grid LAS keeps coordinates. */
typedef struct grid {
	double scale[3], offset[3];
} grid;

/* Interleaves columns as doubles, or as numbers of the grid's places; NULL when memory is short. */
static double *make_keys(const scan *cloud, const scan_column *const *column, size_t width,
						 const grid *on)
{
	double *key = reallocarray(NULL, cloud->count ? cloud->count : 1, width * sizeof *key);
	for (size_t i = 0; key && i < cloud->count; i++)
		for (size_t k = 0; k < width; k++) {
			double value = scan_value(column[k], i);
			key[width * i + k] = on ? rint((value - on->offset[k]) / on->scale[k]) : value;
		}
	return key;
}

/* The points of one cloud in the order of their keys. */
typedef struct sorted_points {
	double *key;   /* width each, by point */
	size_t *order; /* those that have a place */
	size_t width, count;
} sorted_points;

static gw_status sort_points(const scan *cloud, const scan_column *const *column, size_t width,
							 const grid *on, sorted_points *s, gw_error *error)
{
	*s = (sorted_points){ .width = width };
	s->key = make_keys(cloud, column, width, on);
	s->order = reallocarray(NULL, cloud->count ? cloud->count : 1, sizeof *s->order);
	if (!s->key || !s->order)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to match the points");
	const gw_compare_keys keys = { s->key, cloud->count };
	return gw_compare_order(keys, width, s->order, &s->count, error);
}

static void clear_points(sorted_points *s)
{
	free(s->key);
	free(s->order);
}

/* Below 0, 0 or above 0, as point i of the one comes before point j of the other. */
static int compare_keys(const sorted_points *a, size_t i, const sorted_points *b, size_t j)
{
	const double *x = a->key + a->width * a->order[i], *y = b->key + b->width * b->order[j];
	for (size_t k = 0; k < a->width; k++)
		if (x[k] != y[k])
			return x[k] < y[k] ? -1 : 1;
	return 0;
}

/* How many points from i on have its key. */
static size_t count_alike(const sorted_points *s, size_t i)
{
	size_t count = 1;
	while (i + count < s->count && compare_keys(s, i, s, i + count) == 0)
		count++;
	return count;
}

/* Goes through both clouds: points that are alone at their place are partners. Returns at how many
 * places there are more; place, if not NULL, receives them. */
static size_t pair_lone(const sorted_points *truth, const sorted_points *found, size_t *in_found,
						shared_place *place)
{
	size_t shared = 0;
	for (size_t i = 0, j = 0; i < truth->count && j < found->count;) {
		int order = compare_keys(truth, i, found, j);
		size_t mine = order <= 0 ? count_alike(truth, i) : 0;
		size_t other = order >= 0 ? count_alike(found, j) : 0;
		if (mine == 1 && other == 1)
			in_found[truth->order[i]] = found->order[j];
		else if (order == 0 && place)
			place[shared] = (shared_place){ truth->order + i, found->order + j, mine, other };
		shared += order == 0 && mine + other > 2;
		i += mine;
		j += other;
	}
	return shared;
}

/* Whether both clouds have the same columns in one order, but for the rounding. */
static bool is_in_order(const matched_scans *m, const scan_column *const *found,
						const scan_column *const *truth, size_t width, double rounding)
{
	bool same = m->found->count == m->truth->count;
	for (size_t i = 0; i < m->truth->count && same; i++)
		for (size_t k = 0; k < width && same; k++) {
			double one = scan_value(found[k], i), other = scan_value(truth[k], i);
			same = fabs(one - other) <= rounding || (!isfinite(one) && !isfinite(other));
		}
	return same;
}

/* Those that are not. */
static gw_status pair_shared(matched_scans *m, const sorted_points *truth,
							 const sorted_points *found, size_t count, bool in_order,
							 gw_error *error)
{
	shared_places places = { m->truth, m->found, .count = count, .in_order = in_order,
							 .in_found = m->in_found };
	places.place = reallocarray(NULL, count, sizeof *places.place);
	if (!places.place)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu places of several points", count);
	pair_lone(truth, found, m->in_found, places.place);
	gw_status status = shared_places_pair(&places, error);
	for (size_t i = 0; i < count; i++)
		m->shared += places.place[i].truth_count;
	m->untold = places.untold;
	free(places.place);
	return status;
}

/* on: of three columns, or NULL */
static gw_status match_columns(matched_scans *m, const scan_column *const *found,
							   const scan_column *const *truth, size_t width, const grid *on,
							   gw_error *error)
{
	sorted_points its, mine = { 0 };
	gw_status status = sort_points(m->truth, truth, width, on, &its, error);
	if (status == GW_OK)
		status = sort_points(m->found, found, width, on, &mine, error);
	for (size_t i = 0; i < m->truth->count; i++)
		m->in_found[i] = MATCHED_NONE;
	m->shared = m->untold = 0;
	size_t shared = status == GW_OK ? pair_lone(&its, &mine, m->in_found, NULL) : 0;
	if (shared > 0)
		status =
			pair_shared(m, &its, &mine, shared, is_in_order(m, found, truth, width, 0.0), error);
	clear_points(&its);
	clear_points(&mine);
	return status;
}

const char *matched_by_name(matched_by by)
{
	static const char *const name[] = { "index", "position", "order" };
	return name[by];
}

static gw_status find_positions(const scan *cloud, const char *file, const scan_column *column[3],
								gw_error *error)
{
	static const char *const name[3] = { "x", "y", "z" };
	for (int k = 0; k < 3; k++) {
		column[k] = scan_find(cloud, name[k]);
		if (!column[k])
			return gw_fail(error, GW_ERROR_DATA, "%s: the points have no coordinate '%s'", file,
						   name[k]);
	}
	return GW_OK;
}

/* A point without a place, which no bake lights. */
static bool is_nowhere(const scan_column *const position[3], size_t i)
{
	return !isfinite(scan_value(position[0], i)) || !isfinite(scan_value(position[1], i)) ||
		   !isfinite(scan_value(position[2], i));
}

static bool emits(const scan_column *const emission[3], size_t i)
{
	return emission[0] && (scan_value(emission[0], i) > 0.0 || scan_value(emission[1], i) > 0.0 ||
						   scan_value(emission[2], i) > 0.0);
}

/* The columns of the emission, from the truth if it has them; false when nobody has. */
static bool find_emission(const matched_scans *m, const scan_column *emission[3], bool *of_truth)
{
	static const char *const name[3] = { "emission_r", "emission_g", "emission_b" };
	*of_truth = scan_find_triple(m->truth, name, emission);
	return *of_truth || scan_find_triple(m->found, name, emission);
}

/* Whether each point of the truth that has a partner emits light; counts those that do, and says
 * how many points have no partner though they have a place. */
static size_t count_emitting(matched_scans *m, const scan_column *const position[3], bool *emitter)
{
	const scan_column *emission[3];
	bool of_truth, any = find_emission(m, emission, &of_truth);
	size_t without = 0, lit = 0;
	for (size_t i = 0; i < m->truth->count; i++) {
		size_t partner = m->in_found[i];
		bool nowhere = is_nowhere(position, i);
		emitter[i] =
			any && !nowhere && partner != MATCHED_NONE && emits(emission, of_truth ? i : partner);
		m->not_finite += nowhere;
		m->emitting += emitter[i];
		without += !nowhere && partner == MATCHED_NONE;
		lit += !nowhere && !emitter[i];
	}
	/* Where all is luminous, light that is reflected can only be told by comparing all of it. */
	for (size_t i = 0; lit == 0 && i < m->truth->count; i++)
		emitter[i] = false;
	if (lit == 0)
		m->emitting = 0;
	return without;
}

/* Keeps the pairs that are to be compared. */
static void keep_pairs(matched_scans *m, const scan_column *const position[3], const bool *emitter)
{
	for (size_t i = 0; i < m->truth->count; i++) {
		size_t partner = m->in_found[i];
		if (is_nowhere(position, i) || emitter[i])
			continue;
		m->in_found[m->count] = partner;
		m->in_truth[m->count++] = i;
	}
}

/* How far rounding may move a coordinate: no format rounds by more than a millimetre. */
#define ROUNDED_MOST 1e-3
#define ROUNDED_SHARE 1e-5 /* of the longest side of the bounds */

static double rounding_of(const scan *cloud, const scan_column *const position[3])
{
	double longest = 0.0;
	for (int k = 0; k < 3; k++) {
		double low = HUGE_VAL, high = -HUGE_VAL;
		for (size_t i = 0; i < cloud->count; i++) {
			double at = scan_value(position[k], i);
			low = isfinite(at) ? fmin(low, at) : low;
			high = isfinite(at) ? fmax(high, at) : high;
		}
		longest = fmax(longest, high - low);
	}
	return fmin(ROUNDED_MOST, ROUNDED_SHARE * longest);
}

/* Those that have the same places in one order, rounded, are partners. */
static void match_by_order(matched_scans *m, const scan_column *const found[3],
						   const scan_column *const truth[3])
{
	if (!is_in_order(m, found, truth, 3, rounding_of(m->truth, truth)))
		return;
	for (size_t i = 0; i < m->truth->count; i++)
		m->in_found[i] = i;
	m->by = MATCHED_BY_ORDER;
	m->shared = m->untold = 0;
}

/* The grid of a scan that was LAS. */
static bool find_grid(const scan *cloud, grid *on)
{
	for (size_t c = 0; c + 1 < cloud->comment_count; c++)
		if (las_note_read(cloud->comment[c], "scale", on->scale, 3) == 3 &&
			las_note_read(cloud->comment[c + 1], "offset", on->offset, 3) == 3)
			return on->scale[0] != 0.0 && on->scale[1] != 0.0 && on->scale[2] != 0.0;
	return false;
}

/* Whether a point that is somewhere has no partner. */
static bool lacks_partners(const matched_scans *m, const scan_column *const position[3])
{
	bool lacks = false;
	for (size_t i = 0; i < m->truth->count && !lacks; i++)
		lacks = m->in_found[i] == MATCHED_NONE && !is_nowhere(position, i);
	return lacks;
}

static gw_status fail_without(const matched_scans *m, size_t without, gw_error *error)
{
	if (m->by == MATCHED_BY_INDEX)
		return gw_fail(error, GW_ERROR_DATA,
					   "%zu of the %zu points of %s have an 'index' that no point of %s has; the "
					   "two are not of one cloud",
					   without, m->truth->count, m->truth_name, m->found_name);
	return gw_fail(error, GW_ERROR_DATA,
				   "%zu of the %zu points of %s are not at the place of any point of %s, to the "
				   "last digit, nor are they the same points in one order; compare lightings of "
				   "one cloud, or give both a column 'index'",
				   without, m->truth->count, m->truth_name, m->found_name);
}

static gw_status select_pairs(matched_scans *m, const scan_column *const position[3],
							  gw_error *error)
{
	bool *emitter = calloc(m->truth->count ? m->truth->count : 1, sizeof *emitter);
	if (!emitter)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to choose among %zu points",
					   m->truth->count);
	size_t without = count_emitting(m, position, emitter);
	if (without == 0)
		keep_pairs(m, position, emitter);
	free(emitter);
	if (without > 0)
		return fail_without(m, without, error);
	if (m->count == 0)
		return gw_fail(error, GW_ERROR_DATA, "%s has no point that could be compared",
					   m->truth_name);
	return GW_OK;
}

static gw_status find_partners(matched_scans *m, const scan_column *const found[3],
							   const scan_column *const truth[3], gw_error *error)
{
	size_t room = m->truth->count ? m->truth->count : 1;
	m->in_found = reallocarray(NULL, room, sizeof *m->in_found);
	m->in_truth = reallocarray(NULL, room, sizeof *m->in_truth);
	if (!m->in_found || !m->in_truth)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to match %zu points", room);
	const scan_column *mine = scan_find_scalar(m->found, "index");
	const scan_column *its = scan_find_scalar(m->truth, "index");
	m->by = mine && its ? MATCHED_BY_INDEX : MATCHED_BY_POSITION;
	if (m->by == MATCHED_BY_INDEX)
		return match_columns(m, &mine, &its, 1, NULL, error);
	GW_TRY(match_columns(m, found, truth, 3, NULL, error));
	if (lacks_partners(m, truth))
		match_by_order(m, found, truth);
	/* COPC has an order of its own. A cloud that was LAS may have been moved off its grid. */
	const scan *const of[2] = { m->found, m->truth };
	grid on;
	for (int k = 0; k < 2 && m->by == MATCHED_BY_POSITION && lacks_partners(m, truth); k++)
		if (find_grid(of[k], &on))
			GW_TRY(match_columns(m, found, truth, 3, &on, error));
	return GW_OK;
}

gw_status matched_scans_make(matched_scans *m, gw_error *error)
{
	const scan_column *found[3], *truth[3];
	GW_TRY(find_positions(m->found, m->found_name, found, error));
	GW_TRY(find_positions(m->truth, m->truth_name, truth, error));
	GW_TRY(find_partners(m, found, truth, error));
	return select_pairs(m, truth, error);
}

void matched_scans_clear(matched_scans *m)
{
	free(m->in_found);
	free(m->in_truth);
	m->in_found = m->in_truth = NULL;
	m->count = 0;
}
