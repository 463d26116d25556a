/*
 * surfel_parts.c - see surfel_parts.h.
 */
#include "surfels/surfel_parts.h"

#include "base/memory.h"
#include "cloud/range_image.h"
#include "cloud/frame.h"
#include "base/nth_element.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* How far a matrix's columns may be from equally long and perpendicular, relative to their length:
 * what numbers of six digits leave. */
#define EVEN 1e-4

/* A similarity: v goes to scale * turn v + shift. */
typedef struct similarity {
	double turn[9]; /* orthonormal; determinant 1, or -1 when it mirrors */
	double scale;
	double shift[3];
} similarity;

static const double *matrix_of(const gw_motion *motion, size_t frame, size_t mover)
{
	return motion->matrix + 16 * (frame * motion->mover_count + mover);
}

static double column_dot(const double m[16], size_t a, size_t b)
{
	return m[a] * m[b] + m[4 + a] * m[4 + b] + m[8 + a] * m[8 + b];
}

static similarity similarity_of(const double m[16])
{
	similarity s;
	double squared = (column_dot(m, 0, 0) + column_dot(m, 1, 1) + column_dot(m, 2, 2)) / 3;
	s.scale = sqrt(squared);
	for (size_t row = 0; row < 3; row++) {
		for (size_t k = 0; k < 3; k++)
			s.turn[3 * row + k] = m[4 * row + k] / s.scale;
		s.shift[row] = m[4 * row + 3];
	}
	return s;
}

static void turn(const similarity *s, const double v[3], double out[3])
{
	for (size_t row = 0; row < 3; row++)
		out[row] =
			s->turn[3 * row] * v[0] + s->turn[3 * row + 1] * v[1] + s->turn[3 * row + 2] * v[2];
}

/* ------------------------------------------------------------------------------------ checks */

bool gw_matrix_is_even(const double m[16], double tolerance)
{
	double size = (column_dot(m, 0, 0) + column_dot(m, 1, 1) + column_dot(m, 2, 2)) / 3;
	bool even = size > 0.0 && isfinite(size);
	for (size_t a = 0; a < 3 && even; a++)
		for (size_t b = 0; b < 3; b++)
			even = even && fabs(column_dot(m, a, b) - (a == b ? size : 0.0)) <= tolerance * size;
	for (size_t row = 0; row < 3; row++)
		even = even && fabs(m[4 * row + 3]) <= GW_COORDINATE_MAX;
	return even && m[12] == 0.0 && m[13] == 0.0 && m[14] == 0.0 && m[15] == 1.0;
}

/* kind   what movers are called */
static gw_status check_movers(const gw_points *points, const gw_motion *motion, const char *kind,
							  gw_error *error)
{
	size_t end = 0;
	for (size_t i = 0; i < motion->mover_count; i++) {
		const gw_mover *mover = &motion->mover[i];
		if (mover->first < end || mover->count == 0 || mover->first > points->count ||
			mover->count > points->count - mover->first)
			return gw_fail(error, GW_ERROR_USAGE,
						   "%s %zu is points %zu to %zu of %zu: %ss need points of their own, in "
						   "ascending order",
						   kind, i + 1, mover->first, mover->first + mover->count, points->count,
						   kind);
		end = mover->first + mover->count;
	}
	for (size_t f = 0; f < motion->frame_count; f++)
		for (size_t i = 0; i < motion->mover_count; i++)
			if (!gw_matrix_is_even(matrix_of(motion, f, i), EVEN))
				return gw_fail(error, GW_ERROR_DATA,
							   "%s %zu is stretched, skewed or flattened in frame %zu; it may be "
							   "moved, turned and scaled evenly",
							   kind, i + 1, f);
	return GW_OK;
}

gw_status gw_motion_check(const gw_points *points, const gw_motion *motion, gw_error *error)
{
	if (motion->frame_count == 0)
		return gw_fail(error, GW_ERROR_USAGE, "the motion has no frames; it needs at least one");
	return check_movers(points, motion, "mover", error);
}

/* ------------------------------------------------------------------------------------- making */

/* Some of the points, copied or lent. */
typedef struct some_points {
	gw_points points;
	void *owned[9];
} some_points;

static void clear_some(some_points *some)
{
	for (size_t i = 0; i < sizeof some->owned / sizeof *some->owned; i++)
		free(some->owned[i]);
}

/* Copies the rows of an array that no mover has. */
static bool copy_still(const void *from, size_t row, size_t total, const gw_motion *motion,
					   size_t still, void **to)
{
	if (from == NULL)
		return true;
	char *out = *to = gw_allocate_array(still, row);
	size_t at = 0;
	for (size_t i = 0; out != NULL && i <= motion->mover_count; i++) {
		size_t end = i < motion->mover_count ? motion->mover[i].first : total;
		memcpy(out, (const char *)from + at * row, (end - at) * row);
		out += (end - at) * row;
		if (i < motion->mover_count)
			at = end + motion->mover[i].count;
	}
	return out != NULL;
}

static gw_status take_still(const gw_points *points, const gw_motion *motion, size_t still,
							some_points *some, gw_error *error)
{
	size_t n = points->count, vector = 3 * sizeof(float);
	*some = (some_points){ .points = *points };
	some->points.count = still;
	bool good =
		copy_still(points->position, 3 * sizeof(double), n, motion, still, &some->owned[0]) &&
		copy_still(points->normal, vector, n, motion, still, &some->owned[1]) &&
		copy_still(points->albedo, vector, n, motion, still, &some->owned[2]) &&
		copy_still(points->emission, vector, n, motion, still, &some->owned[3]) &&
		copy_still(points->scanner_of, sizeof(uint32_t), n, motion, still, &some->owned[4]) &&
		copy_still(points->stray, 1, n, motion, still, &some->owned[5]) &&
		copy_still(points->own_area, sizeof(float), n, motion, still, &some->owned[6]) &&
		copy_still(points->opacity, sizeof(float), n, motion, still, &some->owned[7]) &&
		copy_still(points->beam_share, sizeof(float), n, motion, still, &some->owned[8]);
	some->points.position = some->owned[0];
	some->points.normal = some->owned[1];
	some->points.albedo = some->owned[2];
	some->points.emission = some->owned[3];
	some->points.scanner_of = some->owned[4];
	some->points.stray = some->owned[5];
	some->points.own_area = some->owned[6];
	some->points.opacity = some->owned[7];
	some->points.beam_share = some->owned[8];
	if (good)
		return GW_OK;
	clear_some(some);
	return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu points that stand still", still);
}

static some_points take_mover(const gw_points *points, const gw_mover *mover)
{
	size_t first = mover->first;
	some_points some = { .points = *points };
	some.points.count = mover->count;
	some.points.position += 3 * first;
	some.points.normal = points->normal ? points->normal + 3 * first : NULL;
	some.points.albedo = points->albedo ? points->albedo + 3 * first : NULL;
	some.points.emission = points->emission ? points->emission + 3 * first : NULL;
	some.points.scanner_of = points->scanner_of ? points->scanner_of + first : NULL;
	some.points.stray = points->stray ? points->stray + first : NULL;
	some.points.own_area = points->own_area ? points->own_area + first : NULL;
	some.points.opacity = points->opacity ? points->opacity + first : NULL;
	some.points.beam_share = points->beam_share ? points->beam_share + first : NULL;
	return some;
}

/* Appends rows to an array of `count` rows; where there is none, NULL stays or zeros stand in. */
static bool append(void *array, size_t count, const void *from, size_t more, size_t row)
{
	void **to = array;
	if (*to == NULL && from == NULL)
		return true;
	char *grown =
		*to ? gw_resize_array(*to, count + more, row) : gw_allocate_zeros(count + more, row);
	if (grown == NULL)
		return false;
	*to = grown;
	if (from != NULL)
		memcpy(grown + count * row, from, more * row);
	else
		memset(grown + count * row, 0, more * row);
	return true;
}

/* Normals of noisy points are of two kinds, which are the same where points are clean. */
static bool give_normals(gw_surfels *s)
{
	if (s->shading_normal == NULL)
		s->shading_normal = gw_allocate_array(s->count, 3 * sizeof *s->shading_normal);
	else
		return true;
	if (s->shading_normal != NULL)
		memcpy(s->shading_normal, s->normal, 3 * s->count * sizeof *s->normal);
	return s->shading_normal != NULL;
}

static void add_counts(gw_surfels *all, const gw_surfels *part)
{
	all->given_area += part->given_area;
	all->seen_from_above &= part->seen_from_above;
	all->non_finite += part->non_finite;
	all->duplicates += part->duplicates;
	all->albedo_clamped += part->albedo_clamped;
	all->emission_repaired += part->emission_repaired;
	all->normals_given += part->normals_given;
	all->normals_estimated += part->normals_estimated;
	all->normals_untrusted += part->normals_untrusted;
	all->normals_turned += part->normals_turned;
	all->normals_doubted += part->normals_doubted;
	all->normals_lengthened += part->normals_lengthened;
	all->albedo_defaulted += part->albedo_defaulted;
}

/* All but surfel_of_point; positions are the mover's own until it is moved. */
static bool append_part(gw_surfels *all, gw_surfels *part)
{
	size_t n = all->count, m = part->count, v = 3 * sizeof(float);
	if (n == 0) {
		all->up = part->up;
		all->seen_from_above = part->seen_from_above;
		memcpy(all->origin, part->origin, sizeof all->origin);
		memcpy(all->minimum, part->minimum, sizeof all->minimum);
		memcpy(all->maximum, part->maximum, sizeof all->maximum);
	}
	if ((n > 0 && part->shading_normal && !give_normals(all)) ||
		(all->shading_normal && !give_normals(part)))
		return false;
	bool good = append(&all->position, n, part->position, m, v) &&
				append(&all->normal, n, part->normal, m, v) &&
				append(&all->shading_normal, n, part->shading_normal, m, v) &&
				append(&all->shading_normal_off, n, part->shading_normal_off, m, sizeof(float)) &&
				append(&all->normal_length, n, part->normal_length, m, sizeof(float)) &&
				append(&all->albedo, n, part->albedo, m, v) &&
				append(&all->emission, n, part->emission, m, v) &&
				append(&all->transparency, n, part->transparency, m, sizeof(float)) &&
				append(&all->nearest, n, part->nearest, m, sizeof(float)) &&
				append(&all->radius, n, part->radius, m, sizeof(float)) &&
				append(&all->area, n, part->area, m, sizeof(float)) &&
				append(&all->clip, n, part->clip, m, 2 * v) &&
				append(&all->bend, n, part->bend, m, v) &&
				append(&all->two_sided, n, part->two_sided, m, 1) &&
				append(&all->creased, n, part->creased, m, 1) &&
				append(&all->doubt, n, part->doubt, m, sizeof(float)) &&
				append(&all->noise, n, part->noise, m, sizeof(float));
	all->count = good ? n + m : n;
	add_counts(all, part);
	return good;
}

/* Surfels of the points that some part has: `of` are the part's own, `base` its first surfel. */
static void number_points(uint32_t *all, const uint32_t *of, size_t count, size_t base)
{
	assert(of != NULL || count == 0);
	for (size_t i = 0; i < count; i++)
		all[i] = of[i] == UINT32_MAX ? UINT32_MAX : (uint32_t)(base + of[i]);
}

/* The surfels that a mover has, as they were made. */
static gw_surfels *own_of(const gw_surfel_parts *parts, size_t mover)
{
	return &parts->own[parts->of[mover]];
}

static bool number_all(const gw_points *points, const gw_motion *motion, const uint32_t *still,
					   const gw_surfel_parts *parts, gw_surfels *all)
{
	all->point_count = points->count;
	all->surfel_of_point = gw_allocate_array(points->count, sizeof *all->surfel_of_point);
	if (all->surfel_of_point == NULL)
		return false;
	size_t at = 0, base = parts->still;
	for (size_t i = 0; i <= motion->mover_count; i++) {
		size_t end = i < motion->mover_count ? motion->mover[i].first : points->count;
		number_points(all->surfel_of_point + at, still, end - at, 0);
		still += end - at;
		if (i == motion->mover_count)
			break;
		const gw_surfels *own = own_of(parts, i);
		number_points(all->surfel_of_point + end, own->surfel_of_point, own->point_count, base);
		base += own->count;
		at = end + motion->mover[i].count;
	}
	return true;
}

/* The bounds hold the box of every mover in every frame. */
static void widen_bounds(const gw_surfel_parts *parts, const gw_motion *motion, gw_surfels *all)
{
	for (size_t job = 0; job < motion->frame_count * motion->mover_count; job++) {
		const gw_surfels *own = own_of(parts, job % motion->mover_count);
		similarity s = similarity_of(motion->matrix + 16 * job);
		for (unsigned corner = 0; corner < 8; corner++) {
			double at[3], to[3];
			for (size_t k = 0; k < 3; k++)
				at[k] =
					own->origin[k] + (double)(corner >> k & 1 ? own->maximum[k] : own->minimum[k]);
			turn(&s, at, to);
			for (size_t k = 0; k < 3; k++) {
				float local = (float)(s.scale * to[k] + s.shift[k] - all->origin[k]);
				all->minimum[k] = fminf(all->minimum[k], local);
				all->maximum[k] = fmaxf(all->maximum[k], local);
			}
		}
	}
}

static bool find_spacing(gw_surfels *all)
{
	float *width = gw_allocate_array(all->count, sizeof *width);
	if (width == NULL)
		return false;
	for (size_t i = 0; i < all->count; i++)
		width[i] = sqrtf(all->area[i]);
	all->spacing = gw_nth_element(width, all->count, all->count / 2);
	free(width);
	return true;
}

/* Strays of what stands still, which were counted without the movers. */
static void number_still_strays(const gw_motion *motion, gw_surfels *all)
{
	for (size_t i = 0; i < all->stray_count; i++)
		for (size_t m = 0; m < motion->mover_count; m++)
			if (all->stray[i].point >= motion->mover[m].first)
				all->stray[i].point += (uint32_t)motion->mover[m].count;
}

/* Adds those of a mover, whose surfels begin at `base`. */
static bool append_strays(const gw_surfels *part, const gw_mover *mover, size_t base,
						  gw_surfels *all)
{
	if (!append(&all->stray, all->stray_count, part->stray, part->stray_count, sizeof *all->stray))
		return false;
	for (size_t i = 0; i < part->stray_count; i++) {
		gw_stray *stray = &all->stray[all->stray_count++];
		stray->point += (uint32_t)mover->first;
		stray->surfel += stray->surfel != UINT32_MAX ? (uint32_t)base : 0;
	}
	return true;
}

/* What surfels are made of. */
typedef struct source {
	const gw_points *points;
	const gw_motion *motion;
	const gw_surfels_options *options;
	const gw_object_instance *instance; /* NULL, or the movers as such: some have those of others */
} source;

/* Surfels of what stands still, without the array of points. */
static gw_status make_still(const source *from, size_t still, gw_surfels *all, uint32_t **number,
							gw_error *error)
{
	some_points some;
	*number = NULL;
	if (still == 0)
		return GW_OK;
	GW_TRY(take_still(from->points, from->motion, still, &some, error));
	gw_status status = gw_surfels_make(&some.points, from->options, all, error);
	clear_some(&some);
	*number = all->surfel_of_point;
	all->surfel_of_point = NULL;
	return status;
}

/* A mover's surfels, or those of the mover whose it has, behind all that were made before. */
static gw_status make_mover(const source *from, size_t mover, gw_surfel_parts *parts,
							gw_surfels *all, gw_error *error)
{
	const gw_mover *points = &from->motion->mover[mover];
	size_t base = all->count;
	parts->of[mover] = from->instance ? from->instance[mover].of : mover;
	if (parts->of[mover] == mover) {
		some_points some = take_mover(from->points, points);
		GW_TRY(gw_surfels_make(&some.points, from->options, &parts->own[mover], error));
	}
	parts->own_count++;
	gw_surfels *own = own_of(parts, mover);
	if (append_part(all, own) && append_strays(own, points, base, all))
		return GW_OK;
	return gw_fail(error, GW_ERROR_MEMORY, "no memory for the surfels of %zu points",
				   from->points->count);
}

static gw_status make_parts(const source *from, gw_surfel_parts *parts, gw_surfels *all,
							uint32_t **number, gw_error *error)
{
	const gw_points *points = from->points;
	const gw_motion *motion = from->motion;
	size_t still = points->count;
	for (size_t i = 0; i < motion->mover_count; i++)
		still -= motion->mover[i].count;
	GW_TRY(make_still(from, still, all, number, error));
	number_still_strays(motion, all);
	parts->still = all->count;
	parts->own = gw_allocate_zeros(motion->mover_count + 1, sizeof *parts->own);
	parts->of = gw_allocate_zeros(motion->mover_count + 1, sizeof *parts->of);
	bool good = parts->own != NULL && parts->of != NULL;
	for (size_t i = 0; i < motion->mover_count && good; i++)
		GW_TRY(make_mover(from, i, parts, all, error));
	if (good && number_all(points, motion, *number, parts, all) && find_spacing(all))
		return gw_frame_keep_albedo(points, all, error);
	return gw_fail(error, GW_ERROR_MEMORY, "no memory for the surfels of %zu points",
				   points->count);
}

static gw_status make_all(const gw_points *points, source from, gw_surfel_parts *parts,
						  gw_surfels *surfels, gw_error *error)
{
	gw_ranged_points ranged;
	uint32_t *number = NULL;
	*parts = (gw_surfel_parts){ 0 };
	*surfels = (gw_surfels){ 0 };
	gw_status status = gw_range_images_use(points, from.options, &ranged, error);
	from.points = &ranged.points;
	from.options = &ranged.options;
	if (status == GW_OK)
		status = make_parts(&from, parts, surfels, &number, error);
	surfels->normals_estimated += ranged.normals;
	gw_ranged_points_clear(&ranged);
	free(number);
	if (status == GW_OK) {
		widen_bounds(parts, from.motion, surfels);
		gw_surfel_parts_move(parts, from.motion, 0, surfels);
	} else {
		gw_surfel_parts_clear(parts);
		gw_surfels_clear(surfels);
	}
	return status;
}

gw_status gw_surfel_parts_make(const gw_points *points, const gw_motion *motion,
							   const gw_surfels_options *options, gw_surfel_parts *parts,
							   gw_surfels *surfels, gw_error *error)
{
	const source from = { .motion = motion, .options = options };
	return make_all(points, from, parts, surfels, error);
}

void gw_surfel_parts_clear(gw_surfel_parts *parts)
{
	for (size_t i = 0; i < parts->own_count; i++)
		gw_surfels_clear(&parts->own[i]);
	free(parts->own);
	free(parts->of);
	*parts = (gw_surfel_parts){ 0 };
}

/* --------------------------------------------------------------------------------- instances */

/* As movers of one frame. */
typedef struct instances {
	gw_motion motion;
	gw_mover *mover;
	double *matrix;
} instances;

static gw_status check_instances(const gw_points *points, gw_error *error)
{
	for (size_t i = 0; i < points->instance_count; i++) {
		const gw_object_instance *own = &points->instance[i];
		bool repeats = own->of <= i && points->instance[own->of].of == own->of &&
					   points->instance[own->of].count == own->count;
		if (!repeats)
			return gw_fail(error, GW_ERROR_USAGE,
						   "instance %zu has the surfels of instance %zu, which has to come before "
						   "it, with as many points, and to have its own",
						   i + 1, own->of + 1);
	}
	return GW_OK;
}

static gw_status list_instances(const gw_points *points, instances *placed, gw_error *error)
{
	size_t count = points->instance_count;
	placed->mover = gw_allocate_array(count, sizeof *placed->mover);
	placed->matrix = gw_allocate_array(count, 16 * sizeof *placed->matrix);
	if (!placed->mover || !placed->matrix)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu instances", count);
	for (size_t i = 0; i < count; i++) {
		const gw_object_instance *own = &points->instance[i];
		placed->mover[i] = (gw_mover){ own->first, own->count };
		memcpy(placed->matrix + 16 * i, own->matrix, sizeof own->matrix);
	}
	placed->motion = (gw_motion){ placed->mover, count, 1, placed->matrix };
	GW_TRY(check_instances(points, error));
	return check_movers(points, &placed->motion, "instance", error);
}

/* What is told of all surfels, now that they have the size of their place. */
static gw_status measure_placed(gw_surfels *s, gw_error *error)
{
	s->given_area = 0.0;
	for (size_t i = 0; i < s->count; i++)
		s->given_area += (double)s->area[i];
	if (find_spacing(s))
		return GW_OK;
	gw_surfels_clear(s);
	return gw_fail(error, GW_ERROR_MEMORY, "no memory for the spacing of the surfels");
}

gw_status gw_placed_surfels_make(const gw_points *points, const gw_surfels_options *options,
								 gw_surfels *surfels, gw_error *error)
{
	instances placed = { .mover = NULL };
	gw_surfel_parts parts = { 0 };
	if (points->instance_count == 0)
		return gw_surfels_make(points, options, surfels, error);
	*surfels = (gw_surfels){ 0 };
	gw_status status = list_instances(points, &placed, error);
	if (status == GW_OK) {
		const source from = { .motion = &placed.motion,
							  .options = options,
							  .instance = points->instance };
		status = make_all(points, from, &parts, surfels, error);
	}
	if (status == GW_OK)
		status = measure_placed(surfels, error);
	gw_surfel_parts_clear(&parts);
	free(placed.mover);
	free(placed.matrix);
	return status;
}

/* ------------------------------------------------------------------------------------- moving */

static void turn_normal(const similarity *s, const float from[3], float to[3])
{
	double n[3] = { (double)from[0], (double)from[1], (double)from[2] }, out[3];
	turn(s, n, out);
	double length = sqrt(out[0] * out[0] + out[1] * out[1] + out[2] * out[2]);
	for (size_t k = 0; k < 3; k++)
		to[k] = (float)(out[k] / length);
}

/* Columns: the tangents of a normal, turned, in coordinates of the tangents of the turned normal.
 */
typedef double plane_turn[2][2];

static void find_plane_turn(const similarity *s, const float from_normal[3],
							const float to_normal[3], plane_turn q)
{
	float tangent[2][3], to_tangent[2][3];
	gw_tangent_frame(from_normal, tangent[0], tangent[1]);
	gw_tangent_frame(to_normal, to_tangent[0], to_tangent[1]);
	for (size_t c = 0; c < 2; c++) {
		double way[3], out[3];
		for (size_t k = 0; k < 3; k++)
			way[k] = (double)tangent[c][k];
		turn(s, way, out);
		for (size_t r = 0; r < 2; r++) {
			q[r][c] = 0;
			for (size_t k = 0; k < 3; k++)
				q[r][c] += out[k] * (double)to_tangent[r][k];
		}
	}
}

/* The disc's cuts keep their place on the surface, so that they get other coordinates in the frame
 * of the turned normal. */
static void turn_clips(const similarity *s, const plane_turn q, const float from[6], float to[6])
{
	for (size_t c = 0; c < 6; c += 3) {
		double x = (double)from[c], y = (double)from[c + 1];
		to[c] = (float)(q[0][0] * x + q[0][1] * y);
		to[c + 1] = (float)(q[1][0] * x + q[1][1] * y);
		to[c + 2] = (float)(s->scale * (double)from[c + 2]);
	}
}

/* The bend is a symmetric matrix, which turns from both sides. */
static void turn_bend(const similarity *s, const plane_turn q, const float from[3], float to[3])
{
	const double m[2][2] = { { (double)from[0], (double)from[1] },
							 { (double)from[1], (double)from[2] } };
	const int row[3] = { 0, 0, 1 }, column[3] = { 0, 1, 1 };
	for (size_t e = 0; e < 3; e++) {
		double sum = 0;
		for (size_t i = 0; i < 2; i++)
			for (size_t j = 0; j < 2; j++)
				sum += q[row[e]][i] * m[i][j] * q[column[e]][j];
		to[e] = (float)(sum / s->scale);
	}
}

static void move_surfel(const similarity *s, const gw_surfels *own, size_t i, gw_surfels *all,
						size_t j)
{
	double at[3], to[3];
	for (size_t k = 0; k < 3; k++)
		at[k] = own->origin[k] + (double)own->position[3 * i + k];
	turn(s, at, to);
	for (size_t k = 0; k < 3; k++)
		all->position[3 * j + k] = (float)(s->scale * to[k] + s->shift[k] - all->origin[k]);
	turn_normal(s, own->normal + 3 * i, all->normal + 3 * j);
	if (all->shading_normal)
		turn_normal(s, (own->shading_normal ? own->shading_normal : own->normal) + 3 * i,
					all->shading_normal + 3 * j);
	plane_turn q;
	find_plane_turn(s, own->normal + 3 * i, all->normal + 3 * j, q);
	turn_clips(s, q, own->clip + 6 * i, all->clip + 6 * j);
	turn_bend(s, q, own->bend + 3 * i, all->bend + 3 * j);
	all->nearest[j] = (float)((double)own->nearest[i] * s->scale);
	all->radius[j] = (float)((double)own->radius[i] * s->scale);
	all->area[j] = (float)((double)own->area[i] * s->scale * s->scale);
	if (own->noise)
		all->noise[j] = (float)((double)own->noise[i] * s->scale);
}

void gw_surfel_parts_move(const gw_surfel_parts *parts, const gw_motion *motion, size_t frame,
						  gw_surfels *surfels)
{
	size_t base = parts->still;
	for (size_t m = 0; m < parts->own_count; m++) {
		similarity s = similarity_of(matrix_of(motion, frame, m));
		const gw_surfels *own = own_of(parts, m);
		for (size_t i = 0; i < own->count; i++)
			move_surfel(&s, own, i, surfels, base + i);
		base += own->count;
	}
}
