/* frame.c - local coordinates, canonical order and merged duplicates. */
#include "cloud/frame.h"
#include "glowworm_host.h"

#include "cloud/bulk_bounds.h"
#include "base/key_sort.h"
#include "base/luminance.h"
#include "base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Of clouds narrower than this, metres, not even distances fit a float32. */
#define EXTENT_MIN 1e-30

/* Of surfels: facets keep it as a fraction. */
#define TRANSPARENCY_MAX 0.9999f

#define GRID_BITS 21
#define CHUNK 16384 /* points that a thread takes at a time */

/* What became of points as they were merged. */
typedef struct repairs {
	size_t duplicates, normals_given, albedo_clamped, albedo_defaulted, emission_repaired;
	bool emits;
} repairs;

/* Some of the sorted points: no point elsewhere has the place of one of them. */
typedef struct frame_part {
	size_t first, end;            /* of the sorted points */
	size_t surfels, first_surfel; /* that are made of them */
	float low[3], high[3];        /* bounds of those in the bulk, local */
	repairs repairs;
} frame_part;

/* What all of this file's functions need to know. */
typedef struct frame {
	const gw_points *points;
	gw_surfels *surfels;
	uint32_t threads;
	double minimum[3], maximum[3]; /* of the bulk */
	double grain;            /* local coordinates are multiples of it, metres; 0: not rounded */
	double grains_per_metre; /* its inverse, exact: both are powers of two */
	double cells_per_metre;  /* of the Morton grid */
	gw_keyed *order;         /* finite points, sorted */
	size_t finite;
	frame_part *part; /* part_count */
	size_t part_count;
} frame;

/* Sums of the attributes of points that share a position. */
typedef struct merged {
	double normal[3], normal_length;
	float first_normal[3];
	double albedo[3], emission[3], transparency;
	size_t points, normals;
} merged;

static bool is_usable(const double position[3])
{
	return fabs(position[0]) <= GW_COORDINATE_MAX && fabs(position[1]) <= GW_COORDINATE_MAX &&
		   fabs(position[2]) <= GW_COORDINATE_MAX; /* false for NaN */
}

/* Points that are invisible are left out, too. */
static bool is_there(const gw_points *points, size_t i)
{
	return is_usable(points->position + 3 * i) && (!points->opacity || points->opacity[i] > 0.0f);
}

static void local_position(const frame *f, size_t point, float local[3])
{
	for (int k = 0; k < 3; k++) {
		double x = f->points->position[3 * point + (size_t)k] - f->surfels->origin[k];
		if (f->grain > 0)
			x = nearbyint(x * f->grains_per_metre) * f->grain;
		local[k] = (float)x;
	}
}

size_t gw_finite_bounds(const gw_points *points, double minimum[3], double maximum[3])
{
	size_t finite = 0;
	for (int k = 0; k < 3; k++) {
		minimum[k] = INFINITY;
		maximum[k] = -INFINITY;
	}
	for (size_t i = 0; i < points->count; i++) {
		const double *p = points->position + 3 * i;
		if (!is_there(points, i))
			continue;
		finite++;
		for (int k = 0; k < 3; k++) {
			minimum[k] = p[k] < minimum[k] ? p[k] : minimum[k];
			maximum[k] = p[k] > maximum[k] ? p[k] : maximum[k];
		}
	}
	return finite;
}

/*
 * The origin is the whole metre below the least corner (a smaller power of two for clouds under a
 * metre), so that a cloud moved by whole metres has the same local coordinates to the last bit.
 * Local coordinates are rounded to 2^-40 of the extent: finer differences mean nothing in float32,
 * but their squares would underflow near the origin and nowhere else.
 */
static void choose_frame(frame *f, double extent)
{
	double step = 1;
	f->surfels->up = f->points->up;
	if (extent > 0 && extent < 1)
		step = ldexp(1, ilogb(extent));
	for (int k = 0; k < 3; k++)
		f->surfels->origin[k] = floor(f->minimum[k] / step) * step;
	f->grain = extent > 0 ? ldexp(1, ilogb(extent) - 40) : 0;
	f->grains_per_metre = extent > 0 ? ldexp(1, 40 - ilogb(extent)) : 0;
	/* Slightly less than 2^21 cells, so that the largest coordinate has a cell. */
	f->cells_per_metre = extent > 0 ? (double)((1 << GRID_BITS) - 1) / extent : 0;
}

static uint64_t morton_key(const frame *f, const float local[3])
{
	const uint32_t last = (1u << GRID_BITS) - 1;
	uint32_t c[3];
	for (int k = 0; k < 3; k++) {
		double cell =
			floor(((double)local[k] - (double)f->surfels->minimum[k]) * f->cells_per_metre);
		c[k] = cell > 0 ? (cell < (double)last ? (uint32_t)cell : last) : 0;
	}
	return gw_morton_encode(c[0], c[1], c[2]);
}

/* Of the bulk; what lies outside is in the frame, but nothing is made for it. */
static void find_part_bounds(void *user, size_t first, size_t last, uint32_t worker)
{
	const frame *f = user;
	frame_part *part = f->part + first / CHUNK;
	(void)worker;
	for (int k = 0; k < 3; k++) {
		part->low[k] = INFINITY;
		part->high[k] = -INFINITY;
	}
	for (size_t i = first; i < last; i++) {
		float local[3];
		if (!gw_within(f->points->position + 3 * (size_t)f->order[i].item, f->minimum, f->maximum))
			continue;
		local_position(f, f->order[i].item, local);
		for (int k = 0; k < 3; k++) {
			part->low[k] = fminf(part->low[k], local[k]);
			part->high[k] = fmaxf(part->high[k], local[k]);
		}
	}
}

static void find_local_bounds(frame *f)
{
	gw_surfels *s = f->surfels;
	gw_parallel_for(f->threads, f->finite, CHUNK, find_part_bounds, f);
	for (int k = 0; k < 3; k++) {
		s->minimum[k] = INFINITY;
		s->maximum[k] = -INFINITY;
		for (size_t p = 0; p < f->part_count; p++) {
			s->minimum[k] = fminf(s->minimum[k], f->part[p].low[k]);
			s->maximum[k] = fmaxf(s->maximum[k], f->part[p].high[k]);
		}
	}
}

static void find_keys(void *user, size_t first, size_t last, uint32_t worker)
{
	const frame *f = user;
	(void)worker;
	for (size_t i = first; i < last; i++) {
		float local[3];
		local_position(f, f->order[i].item, local);
		f->order[i].key = morton_key(f, local);
	}
}

static int compare_bytes(const float *values, size_t a, size_t b)
{
	return values ? memcmp(values + 3 * a, values + 3 * b, 3 * sizeof(float)) : 0;
}

static int compare_opacity(const float *opacity, size_t a, size_t b)
{
	return opacity ? (opacity[a] > opacity[b]) - (opacity[a] < opacity[b]) : 0;
}

/* Orders points of one Morton cell by coordinates, and points of one position by their attributes:
 * sums over them then have one order, whatever the order of the input. */
static int compare_points(const void *a, const void *b, void *user)
{
	const frame *f = user;
	size_t i = ((const gw_keyed *)a)->item, j = ((const gw_keyed *)b)->item;
	float p[3], q[3];
	local_position(f, i, p);
	local_position(f, j, q);
	for (int k = 0; k < 3; k++)
		if (p[k] != q[k])
			return p[k] < q[k] ? -1 : 1;
	int order = compare_bytes(f->points->normal, i, j);
	if (!order)
		order = compare_bytes(f->points->albedo, i, j);
	if (!order)
		order = compare_bytes(f->points->emission, i, j);
	return order ? order : compare_opacity(f->points->opacity, i, j);
}

/* Parts end where a cell of the Morton grid does. */
static void part_points(frame *f)
{
	size_t end = 0;
	for (size_t p = 0; p < f->part_count; p++) {
		f->part[p] = (frame_part){ .first = end };
		end = end > (p + 1) * CHUNK ? end : (p + 1) * CHUNK;
		end = end < f->finite ? end : f->finite;
		while (end > f->part[p].first && end < f->finite &&
			   f->order[end].key == f->order[end - 1].key)
			end++;
		f->part[p].end = end;
	}
}

/* The first sorted point after one that has another place. */
static size_t find_next_place(const frame *f, size_t first, size_t end, float local[3])
{
	float next[3];
	local_position(f, f->order[first].item, local);
	for (size_t i = first + 1; i < end; i++) {
		if (f->order[i].key != f->order[first].key)
			return i;
		local_position(f, f->order[i].item, next);
		if (memcmp(local, next, sizeof next) != 0)
			return i;
	}
	return end;
}

/* Sorts the points of each cell of a part, and counts places. */
static void sort_part(frame *f, frame_part *part)
{
	float local[3];
	for (size_t first = part->first, last; first < part->end; first = last) {
		for (last = first + 1; last < part->end && f->order[last].key == f->order[first].key;)
			last++;
		if (last - first > 1)
			qsort_r(f->order + first, last - first, sizeof *f->order, compare_points, f);
	}
	for (size_t i = part->first; i < part->end; i = find_next_place(f, i, part->end, local))
		part->surfels++;
}

static void sort_parts(void *user, size_t first, size_t last, uint32_t worker)
{
	frame *f = user;
	(void)worker;
	for (size_t p = first; p < last; p++)
		sort_part(f, f->part + p);
}

/* Sorts the finite points, in parts, and knows the first surfel of each. */
static gw_status sort_points(frame *f, gw_error *error)
{
	gw_parallel_for(f->threads, f->finite, CHUNK, find_keys, f);
	if (!gw_sort_keyed(&f->order, f->finite, 3 * GRID_BITS, f->threads))
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to sort %zu points; %zu bytes are needed",
					   f->finite, f->finite * GW_KEY_SORT_BYTES);
	part_points(f);
	gw_parallel_for(f->threads, f->part_count, 1, sort_parts, f);
	for (size_t p = 0; p < f->part_count; p++) {
		f->part[p].first_surfel = f->surfels->count;
		f->surfels->count += f->part[p].surfels;
	}
	return GW_OK;
}

double gw_normal_length(const float n[3])
{
	double length = sqrt((double)n[0] * n[0] + (double)n[1] * n[1] + (double)n[2] * n[2]);
	return length > 1e-20 && isfinite(length) ? length : 0;
}

static void add_normal(const frame *f, size_t point, merged *sum)
{
	if (!f->points->normal)
		return;
	const float *n = f->points->normal + 3 * point;
	double length = gw_normal_length(n);
	if (length <= 0)
		return;
	double given = fmin(length, 1), along = 0;
	for (int k = 0; k < 3; k++)
		along += sum->normals ? (double)sum->first_normal[k] * n[k] : 0;
	double sign = f->points->normal_sideless && along < 0 ? -1 : 1;
	for (int k = 0; k < 3; k++) {
		double component = sign * n[k] / length * given;
		if (sum->normals == 0)
			sum->first_normal[k] = (float)(n[k] / length);
		sum->normal[k] += component;
	}
	sum->normal_length += given;
	sum->normals++;
}

/* What was done to a point's albedo. */
typedef struct albedo_repair {
	bool clamped, defaulted;
} albedo_repair;

/* Albedo outside [0, GW_ALBEDO_MAX] is clamped; NaN, and all of it when there is none, becomes the
 * default. */
static albedo_repair albedo_of(const gw_points *points, size_t point, float albedo[3])
{
	albedo_repair repair = { .defaulted = !points->albedo };
	for (size_t k = 0; k < 3; k++) {
		float a = points->albedo ? points->albedo[3 * point + k] : GW_ALBEDO_DEFAULT;
		albedo[k] = fminf(fmaxf(a, 0.0f), GW_ALBEDO_MAX);
		if (isnan(a)) {
			albedo[k] = GW_ALBEDO_DEFAULT;
			repair.defaulted = true;
		} else if (albedo[k] != a) {
			repair.clamped = true;
		}
	}
	return repair;
}

/* Each point counts once. */
static void add_albedo(const frame *f, size_t point, merged *sum, repairs *made)
{
	float albedo[3];
	albedo_repair repair = albedo_of(f->points, point, albedo);
	for (size_t k = 0; k < 3; k++)
		sum->albedo[k] += (double)albedo[k];
	made->albedo_clamped += repair.clamped;
	made->albedo_defaulted += repair.defaulted;
}

static void add_emission(const frame *f, size_t point, merged *sum, repairs *made)
{
	bool repaired = false;
	if (!f->points->emission)
		return;
	for (size_t k = 0; k < 3; k++) {
		float e = f->points->emission[3 * point + k];
		if (isfinite(e) && e >= 0)
			sum->emission[k] += e;
		else
			repaired = true;
	}
	made->emission_repaired += repaired;
}

/* Merged normals are averaged with their lengths, which makes the mean an NDF (Salm 4.3.1). Where
 * they cancel, a sheet seen from both sides, the first one stands for both. */
static void store_normal(gw_surfels *s, size_t surfel, const merged *sum, repairs *made)
{
	double m[3], length = 0;
	float *normal = s->normal + 3 * surfel;
	s->normal_length[surfel] = 1;
	if (sum->normals == 0)
		return;
	for (int k = 0; k < 3; k++) {
		m[k] = sum->normal[k] / (double)sum->normals;
		length += m[k] * m[k];
	}
	length = sqrt(length);
	double given = sum->normal_length / (double)sum->normals;
	bool cancels = sum->normals > 1 && length < 0.1 * given;
	for (int k = 0; k < 3; k++)
		normal[k] = cancels ? sum->first_normal[k] : (float)(m[k] / length);
	s->normal_length[surfel] = (float)fmin(cancels ? given : length, 1);
	s->two_sided[surfel] = cancels;
	made->normals_given++;
}

static void store_surfel(const frame *f, size_t surfel, const float local[3], const merged *sum,
						 repairs *made)
{
	gw_surfels *s = f->surfels;
	memcpy(s->position + 3 * surfel, local, 3 * sizeof *local);
	store_normal(s, surfel, sum, made);
	for (size_t k = 0; k < 3; k++) {
		float albedo = (float)(sum->albedo[k] / (double)sum->points);
		s->albedo[3 * surfel + k] = fminf(albedo, GW_ALBEDO_MAX);
		if (s->emission) {
			s->emission[3 * surfel + k] = (float)(sum->emission[k] / (double)sum->points);
			made->emits |= s->emission[3 * surfel + k] > 0;
		}
	}
	if (s->transparency)
		s->transparency[surfel] =
			fminf((float)(sum->transparency / (double)sum->points), TRANSPARENCY_MAX);
	made->duplicates += sum->points - 1;
}

static void merge_part(const frame *f, frame_part *part)
{
	gw_surfels *s = f->surfels;
	repairs *made = &part->repairs;
	size_t surfel = part->first_surfel;
	for (size_t first = part->first, last; first < part->end; first = last, surfel++) {
		merged sum = { .points = 0 };
		float local[3];
		last = find_next_place(f, first, part->end, local);
		for (size_t i = first; i < last; i++) {
			size_t point = f->order[i].item;
			sum.points++;
			add_normal(f, point, &sum);
			add_albedo(f, point, &sum, made);
			add_emission(f, point, &sum, made);
			sum.transparency += f->points->opacity ? 1.0 - (double)f->points->opacity[point] : 0.0;
			s->surfel_of_point[point] = (uint32_t)surfel;
		}
		store_surfel(f, surfel, local, &sum, made);
	}
}

static void merge_parts(void *user, size_t first, size_t last, uint32_t worker)
{
	const frame *f = user;
	(void)worker;
	for (size_t p = first; p < last; p++)
		merge_part(f, f->part + p);
}

static void merge_points(frame *f)
{
	gw_surfels *s = f->surfels;
	bool emits = false;
	gw_parallel_for(f->threads, f->part_count, 1, merge_parts, f);
	for (size_t p = 0; p < f->part_count; p++) {
		const repairs *made = &f->part[p].repairs;
		s->duplicates += made->duplicates;
		s->normals_given += made->normals_given;
		s->albedo_clamped += made->albedo_clamped;
		s->albedo_defaulted += made->albedo_defaulted;
		s->emission_repaired += made->emission_repaired;
		emits |= made->emits;
	}
	if (!emits) {
		free(s->emission);
		s->emission = NULL;
	}
}

/* Is there a point whose albedo is not its surfel's? */
static bool albedo_differs(const gw_points *points, const gw_surfels *s)
{
	for (size_t i = 0; s->duplicates > 0 && points->albedo && i < points->count; i++) {
		float own[3];
		if (s->surfel_of_point[i] == UINT32_MAX)
			continue;
		albedo_of(points, i, own);
		if (memcmp(own, s->albedo + 3 * (size_t)s->surfel_of_point[i], sizeof own) != 0)
			return true;
	}
	return false;
}

gw_status gw_frame_keep_albedo(const gw_points *points, gw_surfels *s, gw_error *error)
{
	free(s->albedo_of_point);
	s->albedo_of_point = NULL;
	if (!albedo_differs(points, s))
		return GW_OK;
	s->albedo_of_point = gw_allocate_array(points->count, 3 * sizeof *s->albedo_of_point);
	if (!s->albedo_of_point)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the albedo of %zu points",
					   points->count);
	for (size_t i = 0; i < points->count; i++)
		albedo_of(points, i, s->albedo_of_point + 3 * i);
	return GW_OK;
}

/* Is one of the points that are there less than opaque, or is it to be made so? */
static bool is_clear_anywhere(const gw_points *points, const gw_surfels_options *options)
{
	if (options->effects_forced & 1u << GW_EFFECT_TRANSMISSION)
		return true;
	for (size_t i = 0; points->opacity && i < points->count; i++)
		if (points->opacity[i] < 1.0f && is_there(points, i))
			return true;
	return false;
}

/* Arrays are made for all finite points; merging then uses a part, and the rest is given back. */
static bool allocate_arrays(gw_surfels *s, const gw_points *points, bool clear, size_t finite)
{
	s->surfel_of_point = gw_allocate_array(points->count, sizeof *s->surfel_of_point);
	s->position = gw_allocate_array(finite, 3 * sizeof *s->position);
	s->normal = gw_allocate_zeros(finite, 3 * sizeof *s->normal);
	s->normal_length = gw_allocate_array(finite, sizeof *s->normal_length);
	s->albedo = gw_allocate_array(finite, 3 * sizeof *s->albedo);
	s->two_sided = gw_allocate_zeros(finite, sizeof *s->two_sided);
	if (points->emission)
		s->emission = gw_allocate_array(finite, 3 * sizeof *s->emission);
	if (clear)
		s->transparency = gw_allocate_array(finite, sizeof *s->transparency);
	return s->surfel_of_point && s->position && s->normal && s->normal_length && s->albedo &&
		   s->two_sided && (!points->emission || s->emission) && (!clear || s->transparency);
}

static void shrink(float **array, size_t count, size_t size)
{
	float *smaller = *array ? gw_resize_array(*array, count, size) : NULL;
	if (smaller)
		*array = smaller;
}

static void shrink_arrays(gw_surfels *s)
{
	shrink(&s->position, s->count, 3 * sizeof(float));
	shrink(&s->normal, s->count, 3 * sizeof(float));
	shrink(&s->normal_length, s->count, sizeof(float));
	shrink(&s->albedo, s->count, 3 * sizeof(float));
	shrink(&s->emission, s->count, 3 * sizeof(float));
	shrink(&s->transparency, s->count, sizeof(float));
}

static void list_finite(frame *f)
{
	size_t finite = 0;
	for (size_t i = 0; i < f->points->count; i++) {
		f->surfels->surfel_of_point[i] = UINT32_MAX;
		if (is_there(f->points, i))
			f->order[finite++].item = (uint32_t)i;
	}
}

/* What the points' bounds say of the frame; fails where there is none. */
static gw_status check_bounds(frame *f, const gw_surfels_options *options, gw_error *error)
{
	const gw_points *points = f->points;
	if (points->count > 1u << 30)
		return gw_fail(error, GW_ERROR_DATA,
					   "the scene has %zu points; at most 2^30 can be baked at once, split it",
					   points->count);
	f->finite = gw_finite_bounds(points, f->minimum, f->maximum);
	if (f->finite == 0)
		return gw_fail(error, GW_ERROR_DATA,
					   "none of the %zu points has finite coordinates within %s m of 0",
					   points->count, GW_SAID(GW_COORDINATE_MAX, 15));
	uint64_t needed = (uint64_t)f->finite * (sizeof *f->order + GW_KEY_SORT_BYTES);
	if (options->memory && needed > options->memory)
		return gw_fail(error, GW_ERROR_MEMORY,
					   "sorting %zu points takes %llu bytes, %llu may be used; allow more memory "
					   "or use fewer points",
					   f->finite, (unsigned long long)needed, (unsigned long long)options->memory);
	gw_bulk_bounds(points, f->minimum, f->maximum);
	double extent = 0;
	for (int k = 0; k < 3; k++)
		extent = fmax(extent, f->maximum[k] - f->minimum[k]);
	if (extent > 0 && extent < EXTENT_MIN)
		return gw_fail(error, GW_ERROR_DATA,
					   "all points lie within %s m, which is too little to tell them apart: check "
					   "the unit of their coordinates",
					   GW_SAID(extent, 3));
	choose_frame(f, extent);
	return GW_OK;
}

static gw_status allocate(frame *f, const gw_surfels_options *options, gw_error *error)
{
	f->part_count = (f->finite + CHUNK - 1) / CHUNK;
	f->part = gw_allocate_array(f->part_count, sizeof *f->part);
	f->order = gw_allocate_array(f->finite, sizeof *f->order);
	bool clear = is_clear_anywhere(f->points, options);
	if (!f->part || !f->order || !allocate_arrays(f->surfels, f->points, clear, f->finite))
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu points", f->finite);
	return GW_OK;
}

static gw_status fill_arrays(frame *f, gw_error *error)
{
	list_finite(f);
	find_local_bounds(f);
	GW_TRY(sort_points(f, error));
	merge_points(f);
	shrink_arrays(f->surfels);
	return gw_frame_keep_albedo(f->points, f->surfels, error);
}

gw_status gw_frame_make(const gw_points *points, const gw_surfels_options *options,
						gw_surfels *surfels, gw_error *error)
{
	frame f = { .points = points, .surfels = surfels, .threads = options->threads };
	GW_TRY(check_bounds(&f, options, error));
	surfels->point_count = points->count;
	surfels->non_finite = points->count - f.finite;
	gw_status status = allocate(&f, options, error);
	if (status == GW_OK)
		status = fill_arrays(&f, error);
	free(f.order);
	free(f.part);
	return status;
}

bool gw_surfels_emit(const gw_surfels *s)
{
	return s->emission != NULL && !s->emission_alone;
}

bool gw_surfel_emits(const gw_surfels *s, size_t surfel)
{
	return s->emission && gw_luminance(s->emission + 3 * surfel) > 0.0;
}

size_t gw_surfels_count_clear(const gw_surfels *s)
{
	size_t count = 0;
	for (size_t i = 0; s->transparency && i < s->count; i++)
		count += s->transparency[i] > 0.0f;
	return count;
}
