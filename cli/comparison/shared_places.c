/* shared_places.c - see shared_places.h. */
#include "comparison/shared_places.h"

#include "options/preview.h"
#include "points/scan_color.h"
#include "result/bake_columns.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What is known of the points of one cloud: columns, in the order of their weight. */
typedef struct side {
	const scan_column **column;
	const scan_column *radiance[3];
	size_t own, count; /* the first so many are no light; all */
	bool lit;          /* the radiance tells what these do not */
} side;

/* What is no number comes last. */
static int compare_values(double a, double b)
{
	if (isnan(a) || isnan(b))
		return (isnan(a) != 0) - (isnan(b) != 0);
	return (a > b) - (a < b);
}

/* By the first `count` columns of each. */
static int compare_columns(const side *a, size_t i, const side *b, size_t j, size_t count)
{
	int order = 0;
	for (size_t c = 0; c < count && order == 0; c++)
		order = compare_values(scan_value(a->column[c], i), scan_value(b->column[c], j));
	return order;
}

static double luminance(const side *s, size_t i)
{
	float rgb[3];
	for (int k = 0; k < 3; k++)
		rgb[k] = s->lit ? (float)scan_value(s->radiance[k], i) : 0.0f;
	return preview_luminance(rgb);
}

static int by_all(const void *a, const void *b, void *user)
{
	const side *s = user;
	size_t i = *(const size_t *)a, j = *(const size_t *)b;
	int order = compare_columns(s, i, s, j, s->count);
	if (order == 0)
		order = compare_values(luminance(s, i), luminance(s, j));
	return order ? order : (i > j) - (i < j);
}

static int by_column(const void *a, const void *b, void *user)
{
	const scan_column *column = user;
	return compare_values(scan_value(column, *(const size_t *)a),
						  scan_value(column, *(const size_t *)b));
}

/* -------------------------------------------------------- what tells points from another */

/* Whether the values of the cloud that has fewer points at a place are among those of the other. */
static bool is_same_at(const shared_place *p, scan_column *truth, scan_column *found)
{
	bool fewer = p->truth_count <= p->found_count;
	const size_t *few = fewer ? p->truth : p->found, *many = fewer ? p->found : p->truth;
	size_t few_count = fewer ? p->truth_count : p->found_count;
	size_t many_count = fewer ? p->found_count : p->truth_count, j = 0;
	qsort_r(p->truth, p->truth_count, sizeof *p->truth, by_column, truth);
	qsort_r(p->found, p->found_count, sizeof *p->found, by_column, found);
	for (size_t i = 0; i < few_count; i++, j++) {
		double value = scan_value(fewer ? truth : found, few[i]);
		while (j < many_count &&
			   compare_values(scan_value(fewer ? found : truth, many[j]), value) < 0)
			j++;
		if (j == many_count ||
			compare_values(scan_value(fewer ? found : truth, many[j]), value) != 0)
			return false;
	}
	return true;
}

static bool is_same(const shared_places *places, scan_column *truth, scan_column *found)
{
	bool same = true;
	for (size_t i = 0; i < places->count && same; i++)
		same = is_same_at(&places->place[i], truth, found);
	return same;
}

/* Light, or a picture of it. */
static bool may_be_light(const char *name)
{
	bool color = false;
	for (int k = 0; k < 3; k++)
		color = color || strcmp(name, scan_color_names[k]) == 0;
	return color || bake_columns_is_light(name);
}

static void choose_columns(const shared_places *places, bool light, side *truth, side *found)
{
	for (size_t c = 0; c < places->truth->column_count; c++) {
		scan_column *its = &places->truth->column[c];
		scan_column *mine = scan_find(places->found, its->name);
		if (!mine || may_be_light(its->name) != light || !is_same(places, its, mine))
			continue;
		truth->column[truth->count++] = its;
		found->column[found->count++] = mine;
	}
}

/* --------------------------------------------------------------------------- the pairs */

/* How many sorted points, from the first on, have its values in so many columns. */
static size_t count_equal(const side *s, const size_t *point, size_t points, size_t columns)
{
	size_t count = 1;
	while (count < points && compare_columns(s, point[0], s, point[count], columns) == 0)
		count++;
	return count;
}

static bool varies(const side *s, const size_t *point, size_t count)
{
	bool same = true;
	for (size_t i = 1; i < count && same; i++)
		same = luminance(s, point[i]) == luminance(s, point[0]);
	return !same;
}

static size_t fewer_of(const shared_place *p)
{
	return p->truth_count < p->found_count ? p->truth_count : p->found_count;
}

/* The place, among `count` that are sorted, of the i-th of n that stand for all of them: of two
 * that are as near, the one towards the middle. */
static size_t rank_of(size_t i, size_t n, size_t count)
{
	size_t twice = (2 * i + 1) * count;
	return 2 * i + 1 <= n ? twice / (2 * n) : (twice + 2 * n - 1) / (2 * n) - 1;
}

/* Where one cloud has more of the points, some of them have no partner. */
static void pair_ranks(shared_places *places, const shared_place *p, const side *truth,
					   const side *found)
{
	size_t n = fewer_of(p);
	for (size_t i = 0; i < p->truth_count; i++)
		places->in_found[p->truth[i]] = SIZE_MAX;
	for (size_t i = 0; i < n; i++)
		places->in_found[p->truth[rank_of(i, n, p->truth_count)]] =
			p->found[rank_of(i, n, p->found_count)];
	if (varies(found, p->found, p->found_count) &&
		(p->found_count > p->truth_count || varies(truth, p->truth, p->truth_count)))
		places->untold += p->truth_count;
}

/* Pairs points that are equal in so many columns, by the others as far as these go; returns how
 * many. */
static size_t pair_equal(shared_places *places, const shared_place *p, size_t columns,
						 const side *truth, const side *found)
{
	size_t i = 0, j = 0, paired = 0;
	while (i < p->truth_count && j < p->found_count) {
		int order = compare_columns(truth, p->truth[i], found, p->found[j], columns);
		shared_place equal = { p->truth + i, p->found + j, order <= 0, order >= 0 };
		if (order == 0) {
			equal.truth_count = count_equal(truth, equal.truth, p->truth_count - i, columns);
			equal.found_count = count_equal(found, equal.found, p->found_count - j, columns);
			size_t n = fewer_of(&equal);
			if (columns == truth->count ||
				pair_equal(places, &equal, truth->count, truth, found) < n)
				pair_ranks(places, &equal, truth, found);
			paired += n;
		}
		i += equal.truth_count;
		j += equal.found_count;
	}
	return paired;
}

/* Where values are the same at a place, but not together, columns tell what they can. */
static void pair_place(shared_places *places, const shared_place *p, side *truth, side *found)
{
	size_t untold = places->untold;
	qsort_r(p->truth, p->truth_count, sizeof *p->truth, by_all, truth);
	qsort_r(p->found, p->found_count, sizeof *p->found, by_all, found);
	if (pair_equal(places, p, truth->own, truth, found) == fewer_of(p))
		return;
	places->untold = untold;
	pair_ranks(places, p, truth, found);
}

gw_status shared_places_pair(shared_places *places, gw_error *error)
{
	static const char *const name[3] = { "radiance_r", "radiance_g", "radiance_b" };
	size_t columns = places->truth->column_count + 1;
	side truth = { .column = calloc(columns, sizeof *truth.column) };
	side found = { .column = calloc(columns, sizeof *found.column) };
	gw_status status = GW_OK;
	truth.lit = found.lit = !places->in_order &&
							scan_find_triple(places->truth, name, truth.radiance) &&
							scan_find_triple(places->found, name, found.radiance);
	places->untold = 0;
	if (!truth.column || !found.column)
		status = gw_fail(error, GW_ERROR_MEMORY, "no memory to tell %zu columns apart", columns);
	if (status == GW_OK)
		choose_columns(places, false, &truth, &found);
	truth.own = found.own = truth.count;
	if (status == GW_OK && !places->in_order) /* else that tells */
		choose_columns(places, true, &truth, &found);
	for (size_t i = 0; i < places->count && status == GW_OK; i++)
		pair_place(places, &places->place[i], &truth, &found);
	free(truth.column);
	free(found.column);
	return status;
}
