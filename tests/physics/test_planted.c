/* Faults planted in the octree, which rays through it do not notice: the bake has to say how wrong
 * they make the light, and to say nothing where there are none. */
#include "base/luminance.h"
#include "bake/lighting_error.h"
#include "bake/lighting_steps.h"
#include "bake/record_steps.h"
#include "random_numbers.h"
#include "scenes.h"
#include "expected.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define PLATE 40 /* points a side */

/* Lengths in leaf cells. */
typedef struct fault {
	uint32_t depth; /* 0: the octree's own choice */
	uint32_t holes; /* so many places lose all surface within */
	float radius;   /* of them */
	float disc;     /* above 0: surface further than that from every point is lost */
} fault;

typedef struct lit {
	gw_report report;
	size_t count;
	double *radiance; /* count, luminance of each surfel */
} lit;

/* ------------------------------------------------------------------------------------- planting */

static float distance(const float *a, const uint32_t *cell)
{
	float x = a[0] - (float)cell[0] - 0.5f, y = a[1] - (float)cell[1] - 0.5f,
		  z = a[2] - (float)cell[2] - 0.5f;
	return sqrtf(x * x + y * y + z * z);
}

/* Is any of these places within reach of a cell? */
static bool is_near(const float *place, size_t count, const uint32_t *cell, float reach)
{
	for (size_t i = 0; i < count; i++)
		if (distance(place + 4 * i, cell) < reach)
			return true;
	return false;
}

static bool is_lost(const fault *f, const float *hole, const float *place, size_t count,
					const uint32_t *cell)
{
	return is_near(hole, f->holes, cell, f->radius) ||
		   (f->disc > 0.0f && !is_near(place, count, cell, f->disc));
}

/* Takes the facets out of leaves, as rays see it. */
static void plant(gw_scene *s, const fault *f)
{
	gw_error error;
	gw_octree *o = &s->octree;
	size_t tile_bytes = 8 * (size_t)o->leaf_tile_count, leaf_bytes = 16 * (size_t)o->leaf_count;
	size_t place_bytes = 16 * s->surfels.count;
	uint32_t *tile = malloc(tile_bytes), *leaf = malloc(leaf_bytes);
	float *place = malloc(place_bytes), hole[64][4];
	assert_true(tile && leaf && place && f->holes <= 64);
	assert_ok(gw_buffer_download(s->gpu, &o->leaf_tile, 0, tile, tile_bytes, &error), &error);
	assert_ok(gw_buffer_download(s->gpu, &o->leaf_cell, 0, leaf, leaf_bytes, &error), &error);
	assert_ok(gw_buffer_download(s->gpu, &o->surfel_position, 0, place, place_bytes, &error),
			  &error);
	for (size_t i = 0; i < f->holes; i++)
		memcpy(hole[i], place + 4 * (s->surfels.count * (2 * i + 1) / (2 * (size_t)f->holes)), 16);
	for (size_t i = 0; i < o->leaf_count; i++) {
		const uint32_t *cell = leaf + 4 * i;
		uint32_t octant = (cell[0] & 1) | (cell[1] & 1) << 1 | (cell[2] & 1) << 2;
		if (is_lost(f, hole[0], place, s->surfels.count, cell))
			tile[2 * (size_t)cell[3] + 1] &= ~(0x01010101u << octant);
	}
	assert_ok(gw_buffer_upload(s->gpu, &o->leaf_tile, 0, tile, tile_bytes, &error), &error);
	free(tile);
	free(leaf);
	free(place);
}

/* -------------------------------------------------------------------------------------- baking */

static double sent_out(const gw_lighting *light, const float *direct, size_t i)
{
	const gw_surfels *s = &light->scene->surfels;
	float sum[3];
	for (size_t k = 0; k < 3; k++) {
		float irradiance = direct ? direct[4 * i + k] : 0.0f;
		if (light->plan.records)
			irradiance += light->surfel_first[4 * i + k] + light->surfel_indirect[4 * i + k];
		sum[k] = s->albedo[3 * i + k] / (float)SCENE_PI * irradiance +
				 (s->emission ? s->emission[3 * i + k] : 0.0f);
	}
	return gw_luminance(sum);
}

static void light_points(gw_scene *s, const gw_light *lamp, lit *result)
{
	gw_error error;
	gw_view direct = { 0 };
	gw_lighting light = { .scene = s, .lights = lamp, .light_count = lamp ? 1 : 0 };
	gw_lighting_plan(&light);
	if (light.plan.records)
		assert_ok(gw_scene_place_records(s, &error), &error);
	assert_ok(gw_lighting_run(&light, &error), &error);
	assert_ok(gw_lighting_estimate(&light, &error), &error);
	if (light.plan.lamps)
		assert_ok(gw_lighting_view(&light, &light.surfel_direct, &direct, &error), &error);
	result->count = s->surfels.count;
	result->radiance = malloc(result->count * sizeof *result->radiance);
	assert_non_null(result->radiance);
	for (size_t i = 0; i < result->count; i++)
		result->radiance[i] = sent_out(&light, direct.bytes, i);
	gw_view_close(&direct);
	gw_lighting_clear(&light);
}

/* Lights the points through an octree with that fault, or without. */
static void bake(const scene *cloud, const gw_light *lamp, const fault *f, lit *result)
{
	gw_error error;
	gw_points points = scene_points(cloud);
	*result = (lit){ .count = 0 };
	gw_scene s = { .options = gw_bake_options_default(), .report = &result->report };
	s.options.depth = f && f->depth ? f->depth : GW_DEPTH_AUTO;
	assert_ok(gw_scene_open_device(&s, &error), &error);
	assert_ok(
		gw_scene_make_surfels(&s, &(gw_scene_description){ &points, lamp, lamp ? 1 : 0 }, &error),
		&error);
	assert_ok(gw_scene_build_octree(&s, &error), &error);
	if (f)
		plant(&s, f);
	light_points(&s, lamp, result);
	gw_scene_close(&s);
}

static void clear(lit *l)
{
	free(l->report.bounce);
	free(l->radiance);
	*l = (lit){ .count = 0 };
}

/* Root mean square of the difference, relative to the mean of what was baked, as an estimate is. */
static double true_error(const lit *found, const lit *truth, double constant)
{
	double squares = 0.0, sum = 0.0;
	for (size_t i = 0; i < found->count; i++) {
		double off = found->radiance[i] - (truth ? truth->radiance[i] : constant);
		squares += off * off;
		sum += found->radiance[i];
	}
	return sqrt(squares * (double)found->count) / sum;
}

/* A fault that matters is stated within a factor of two. */
static void assert_stated(const char *what, const lit *found, double truth, double least)
{
	const gw_error_estimate *e = &found->report.error;
	print_message("%-32s stated %6.2f %%, of it geometry %6.2f %%, true %6.2f %%\n", what,
				  100 * e->relative_rms, 100 * e->geometry, 100 * truth);
	if (!(truth >= least))
		fail_msg("%s: the fault makes no difference, %.3f %%", what, 100 * truth);
	if (!(e->relative_rms >= 0.5 * truth && e->relative_rms <= 2.0 * truth))
		fail_msg("%s: stated %.3f %%, true %.3f %%", what, 100 * e->relative_rms, 100 * truth);
}

/* --------------------------------------------------------------------------------------- tests */

static void make_sphere(scene *s, size_t points, float albedo, bool emits)
{
	*s = (scene){ 0 };
	scene_add_sphere(s, (double[3]){ 0, 0, 0 }, 1.0, points, -1, albedo);
	if (emits)
		scene_emit(s, 0, (float[3]){ 1, 1, 1 });
}

/* Light that is lost a little in each bounce, and among white walls all the time: L = Le / (1 -
 * rho).
 */
static void light_lost_in_a_white_furnace(void **state)
{
	(void)state;
	const uint32_t holes[] = { 1, 4, 16 };
	scene s;
	make_sphere(&s, 6000, 0.97f, true);
	for (size_t i = 0; i < 3; i++) {
		lit found;
		bake(&s, NULL, &(fault){ .holes = holes[i], .radius = 2.5f }, &found);
		assert_stated("white furnace with holes", &found,
					  true_error(&found, NULL, 1.0 / (1.0 - (double)0.97f)), 0.01);
		clear(&found);
	}
	scene_clear(&s);
}

/* Sun that gets into a closed sphere: all of it is wrong. */
static void sun_in_a_closed_sphere(void **state)
{
	(void)state;
	const uint32_t holes[] = { 4, 24 };
	const gw_light sun = { .type = GW_LIGHT_SUN,
						   .direction = { 0.3, 0.4, -0.8 },
						   .irradiance = { 3, 3, 3 } };
	scene s;
	make_sphere(&s, 6000, 0.5f, false);
	for (size_t i = 0; i < 2; i++) {
		lit found;
		bake(&s, &sun, &(fault){ .holes = holes[i], .radius = 3.5f }, &found);
		assert_stated("sun through holes", &found, true_error(&found, NULL, 0.0), 0.5);
		clear(&found);
	}
	scene_clear(&s);
}

static void check_room(const char *what, const fault *f, double least)
{
	const gw_light lamp = scene_point_light(0.9, 1.1, 1.2, 2.0f);
	scene s = { 0 };
	lit truth, found;
	scene_add_box(&s, (double[3]){ 0, 0, 0 }, (double[3]){ 2, 2, 2 }, 16, 0.6f);
	bake(&s, &lamp, NULL, &truth);
	bake(&s, &lamp, f, &found);
	assert_stated(what, &found, true_error(&found, &truth, 0.0), least);
	clear(&truth);
	clear(&found);
	scene_clear(&s);
}

/* Sparse walls that open, since discs are cut at so many leaf cells. Rays that slip out of a closed
 * room take what those beside them see, so that it takes wide gaps to lose a fifth of its light. */
static void discs_that_are_cut(void **state)
{
	(void)state;
	check_room("discs cut", &(fault){ .depth = 7, .disc = 1.5f }, 0.05);
	check_room("discs cut further", &(fault){ .depth = 7, .disc = 0.75f }, 0.2);
}

/* Leaves as wide as the room, as one point far away makes them. Six a wall are stated at 0.7 of
 * what they are: each facet sends the mean of the light of some 28 points, to records and to points
 * that are solved again alike, so that neither sees by how much it differs from the light where
 * rays meet it. How much of the rest that is was not measured.
 */
static void leaves_too_wide(void **state)
{
	(void)state;
	check_room("three leaves a wall", &(fault){ .depth = 3 }, 0.02);
	check_room("six leaves a wall", &(fault){ .depth = 4 }, 0.01);
}

/* Two square plates of side 8, 1 apart, that lean against the axes by `lean` each; the lower one
 * emits. */
static void make_plates(scene *s, double lean, float albedo)
{
	const double c = cos(lean), d = sin(lean), u[3] = { 8 * c, 0, -8 * d };
	const double v[3] = { 8 * d * d, 8 * c, 8 * d * c }, n[3] = { c * d, -d, c * c };
	double low[3], high[3];
	for (int k = 0; k < 3; k++) {
		low[k] = -0.5 * (u[k] + v[k]);
		high[k] = low[k] + n[k];
	}
	*s = (scene){ 0 };
	scene_add_patch(s, &(scene_patch){ high, v, u, PLATE, PLATE }, albedo);
	scene_add_patch(s, &(scene_patch){ low, u, v, PLATE, PLATE }, albedo);
	scene_emit(s, (size_t)PLATE * PLATE, (float[3]){ 1, 1, 1 });
}

/* Root mean square difference of the dark plate's light by two methods. */
static double difference(const gw_bake_result *found, const gw_bake_result *truth)
{
	double squares = 0.0, sum = 0.0;
	for (size_t i = 0; i < (size_t)PLATE * PLATE; i++) {
		double off = (double)found->radiance[3 * i] - (double)truth->radiance[3 * i];
		squares += off * off;
		sum += (double)found->radiance[3 * i];
	}
	return sqrt(squares * PLATE * PLATE) / sum;
}

/* Light that cones find where there is none, in each of many reflections. */
static void cones_between_leaning_plates(void **state)
{
	(void)state;
	scene s;
	make_plates(&s, 0.6, 0.9f);
	gw_points points = scene_points(&s);
	gw_bake_options options = gw_bake_options_default();
	gw_bake_result *truth = scene_bake(&points, NULL, 0, &options);
	options.method = GW_METHOD_CONES;
	gw_bake_result *found = scene_bake(&points, NULL, 0, &options);
	const lit said = { .report = found->report };
	assert_stated("cones between leaning plates", &said, difference(found, truth), 0.05);
	gw_bake_result_destroy(&found);
	gw_bake_result_destroy(&truth);
	scene_clear(&s);
}

/* Turns the normals of points that lie beyond a plane. */
static void turn_normals(scene *s, int axis, double from)
{
	for (size_t i = 0; i < s->count; i++)
		for (size_t k = 0; k < 3 && s->position[3 * i + (size_t)axis] > from; k++)
			s->normal[3 * i + k] = -s->normal[3 * i + k];
}

/* Points that face the wrong way are dark, or show what is outside, and the others lack their
 * light. */
static void sides_that_are_wrong(void **state)
{
	(void)state;
	static const struct {
		const char *what;
		int axis;
		double from, share; /* of the points, about */
	} row[] = { { "one wall of a room turned", 0, 1.999, 1.0 / 6.0 },
				{ "a third of a room turned", 2, 1.5, 1.0 / 3.0 },
				{ "half a room turned", 1, 1.0, 0.5 } };
	const size_t unclear = 2; /* which half is wrong nothing says: only that it is much */
	const gw_light lamp = scene_point_light(0.9, 1.1, 1.2, 2.0f);
	for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
		scene s = { 0 };
		lit truth, found;
		scene_add_box(&s, (double[3]){ 0, 0, 0 }, (double[3]){ 2, 2, 2 }, 16, 0.6f);
		bake(&s, &lamp, NULL, &truth);
		turn_normals(&s, row[i].axis, row[i].from);
		bake(&s, &lamp, NULL, &found);
		if (i < unclear)
			assert_stated(row[i].what, &found, true_error(&found, &truth, 0.0), 0.2);
		assert_true(found.report.error.relative_rms > 0.5);
		double share = found.report.error.sides_share;
		/* It goes by how many rays differ, as if those that are wrong were spread evenly. */
		if (i < unclear && !(share > 0.5 * row[i].share && share < 1.5 * row[i].share))
			fail_msg("%s: %.3f of the points, not %.3f", row[i].what, share, row[i].share);
		clear(&truth);
		clear(&found);
		scene_clear(&s);
	}
}

/* A ball on a floor whose lower part nobody scanned: the floor beside it sees into it. */
static void undersides_that_are_missing(void **state)
{
	(void)state;
	const gw_light sky = { .type = GW_LIGHT_ENVIRONMENT, .radiance = { 1, 1, 1 } };
	scene s = { 0 };
	scene_add_sphere(&s, (double[3]){ 0, 0, 0.3 }, 0.3, 6000, 1, 0.5f);
	scene_add_patch(&s,
					&(scene_patch){ (double[3]){ -1, -1, 0 }, (double[3]){ 2, 0, 0 },
									(double[3]){ 0, 2, 0 }, 118, 118 },
					0.5f);
	size_t kept = 0;
	for (size_t i = 0; i < s.count; i++) {
		const double *p = s.position + 3 * i;
		if (p[2] < 0.15 && (p[2] > 0.0 || hypot(p[0], p[1]) < 0.1))
			continue;
		memmove(s.position + 3 * kept, s.position + 3 * i, 3 * sizeof *s.position);
		memmove(s.normal + 3 * kept++, s.normal + 3 * i, 3 * sizeof *s.normal);
	}
	s.count = kept;
	gw_points points = scene_points(&s);
	points.normal = NULL;
	const gw_bake_options options = gw_bake_options_default();
	gw_bake_result *r = scene_bake(&points, &sky, 1, &options);
	size_t wrong = 0;
	for (size_t i = 0; i < s.count; i++)
		wrong += r->normal[3 * i + 2] < 0.0f && s.normal[3 * i + 2] > 0.9f;
	print_message("underside missing: stated for sides %.4f, of %.4f; %zu points wrong\n",
				  r->report.error.sides, r->report.error.sides_share, wrong);
	/* The floor is right, though some of it sees into the ball; asked one by one, these points say
	 * 0.077. */
	assert_int_equal(wrong, 0);
	assert_true(r->report.error.sides < 0.04);
	gw_bake_result_destroy(&r);
	scene_clear(&s);
}

/* The upper half of a ring, a tube of radius 0.15 m that lies on the floor; the floor within the
 * ring is a piece by itself, whose rim lies below the tube. All as scanners see it that stand
 * around. */
static void make_ring(scene *s)
{
	const double steps = 40.0, middle = 0.55, tube = 0.15;
	const double corner[3] = { -1.5, -1.5, 0 }, x[3] = { 3, 0, 0 }, y[3] = { 0, 3, 0 };
	scene_add_patch(s, &(scene_patch){ corner, x, y, 150, 150 }, 0.5f);
	size_t kept = 0, floor = s->count;
	for (size_t i = 0; i < floor; i++) {
		double r = hypot(s->position[3 * i], s->position[3 * i + 1]);
		if (r > 0.5 && r < 0.75)
			continue;
		memmove(s->position + 3 * kept, s->position + 3 * i, 3 * sizeof *s->position);
		memmove(s->normal + 3 * kept++, s->normal + 3 * i, 3 * sizeof *s->normal);
	}
	for (double i = 0; i < 3 * steps && kept + 200 < floor; i++)
		for (double k = 0; k <= steps / 2; k++, kept++) {
			double turn = 2 * M_PI * i / (3 * steps), around = 2 * M_PI * k / steps;
			double r = middle + tube * cos(around);
			s->position[3 * kept] = r * cos(turn);
			s->position[3 * kept + 1] = r * sin(turn);
			s->position[3 * kept + 2] = tube + tube * sin(around);
			s->normal[3 * kept] = (float)(cos(around) * cos(turn));
			s->normal[3 * kept + 1] = (float)(cos(around) * sin(turn));
			s->normal[3 * kept + 2] = (float)sin(around);
		}
	s->count = kept;
}

/* Of the floor in the ring most of what is below the tube meets the tube's inside alone, and no
 * other floor is there to know better; but scanners saw its upper side. */
static void sides_that_scanners_saw(void **state)
{
	(void)state;
	const gw_light sky = { .type = GW_LIGHT_ENVIRONMENT, .radiance = { 1, 1, 1 } };
	const double scanner[] = { 2.5, 0, 1.1, -1.2, 2.1, 1.1, -1.2, -2.1, 1.1 };
	scene s = { 0 };
	make_ring(&s);
	gw_points points = scene_points(&s);
	points.normal = NULL;
	points.scanner = scanner;
	points.scanner_count = 3;
	const gw_bake_options options = gw_bake_options_default();
	gw_bake_result *r = scene_bake(&points, &sky, 1, &options);
	size_t wrong = 0;
	for (size_t i = 0; i < s.count; i++)
		wrong += r->normal[3 * i] * s.normal[3 * i] + r->normal[3 * i + 1] * s.normal[3 * i + 1] +
					 r->normal[3 * i + 2] * s.normal[3 * i + 2] <
				 0.0f;
	print_message("ring: stated for sides %.4f, of %.5f; %zu of %zu points wrong\n",
				  r->report.error.sides, r->report.error.sides_share, wrong, s.count);
	/* 384 points are asked, of which one is wrong with a chance of a fifth. What the rays of the
	 * others say is 0.019. */
	assert_true((double)wrong < 1e-3 * (double)s.count);
	assert_true(r->report.error.sides_share < 2.0 / 384.0);
	gw_bake_result_destroy(&r);
	scene_clear(&s);
}

/* A town as an airborne scanner sees it, four points a square metre: roofs 5 m up, 8 m wide and 4 m
 * apart, without the walls below them and the ground there. */
static void make_town(scene *s)
{
	uint64_t seed = 3;
	for (size_t i = 0; i < 9600; i++) {
		double at[3] = { 48.0 * random_number(&seed), 48.0 * random_number(&seed), 0.0 };
		bool roof = fabs(fmod(at[0], 12.0) - 6.0) < 4.0 && fabs(fmod(at[1], 12.0) - 6.0) < 4.0;
		at[2] = roof ? 5.0 : 0.0;
		scene_add(s, at, (double[3]){ 0, 0, 1 }, 0.5f);
	}
}

/* Much of what the streets see is the inside of roofs, which stand on nothing. But nobody was below
 * that could have seen another side of streets or roofs. */
static void sides_that_are_seen_from_above(void **state)
{
	(void)state;
	const gw_light sky = { .type = GW_LIGHT_ENVIRONMENT, .radiance = { 1, 1, 1 } };
	scene s = { 0 };
	make_town(&s);
	gw_points points = scene_points(&s);
	points.normal = NULL;
	const gw_bake_options options = gw_bake_options_default();
	gw_bake_result *r = scene_bake(&points, &sky, 1, &options);
	print_message("town: stated for sides %.4f, of %.5f\n", r->report.error.sides,
				  r->report.error.sides_share);
	for (size_t i = 0; i < s.count; i++)
		assert_true(r->normal[3 * i + 2] > 0.0f);
	/* As above. What the rays alone say is 0.08. */
	assert_true(r->report.error.sides_share < 2.0 / 384.0);
	gw_bake_result_destroy(&r);
	scene_clear(&s);
}

static void assert_little_added(const char *what, const scene *s, const gw_light *lamp)
{
	lit found;
	bake(s, lamp, NULL, &found);
	const gw_error_estimate *e = &found.report.error;
	double others = sqrt(fmax(e->relative_rms * e->relative_rms - e->geometry * e->geometry, 0.0));
	print_message("%-32s stated %6.2f %%, of it geometry %6.2f %%\n", what, 100 * e->relative_rms,
				  100 * e->geometry);
	if (e->sides > 0.01 * e->relative_rms)
		fail_msg("%s: %.3f %% of sides that are right", what, 100 * e->sides);
	if (!(e->relative_rms <= 1.25 * others))
		fail_msg("%s: %.3f %% without geometry, with it %.3f %%", what, 100 * others,
				 100 * e->relative_rms);
	clear(&found);
}

/* Where nothing was planted the estimate is as it would be without this check. */
static void nothing_is_added_where_all_is_right(void **state)
{
	(void)state;
	const gw_light lamp = scene_point_light(0.9, 1.1, 1.2, 2.0f);
	scene s = { 0 };
	scene_add_box(&s, (double[3]){ 0, 0, 0 }, (double[3]){ 2, 2, 2 }, 40, 0.6f);
	assert_little_added("closed room, lamp", &s, &lamp);
	scene_add_sphere(&s, (double[3]){ 1.5, 0.5, 0.75 }, 0.375, 2800, 1, 0.5f);
	assert_little_added("closed room with a ball, lamp", &s, &lamp);
	scene_clear(&s);
}

/* Right under a scanner points lie close together, and their noise is more than they are apart.
 * Discs of them stand above each other, but all are one floor, as lit as it is beside them. */
static void clumps_are_no_shadows(void **state)
{
	(void)state;
	const gw_light lamp = scene_point_light(1.01, 1.02, 0.4, 2.0f);
	const double up[3] = { 0, 0, 1 };
	uint64_t seed = 5;
	scene s = { 0 };
	scene_add_box(&s, (double[3]){ 0, 0, 0 }, (double[3]){ 2, 2, 2 }, 30, 0.6f);
	for (int i = 0; i < 4000; i++) {
		double at[3] = { 1.0 + 0.02 * random_number(&seed), 1.0 + 0.02 * random_number(&seed),
						 0.001 * random_normal(&seed) };
		scene_add(&s, at, up, 0.6f);
	}
	assert_little_added("clump under a lamp", &s, &lamp);
	scene_clear(&s);
}

/* A floor in furrows with slopes of 54 degrees: over their edges stick out the discs of the other
 * side, behind which no point lies. */
static void edges_are_no_shadows(void **state)
{
	(void)state;
	const gw_light lamp = scene_point_light(1.0, 1.0, 1.2, 2.0f);
	const double along[3] = { 0.0, 2.0, 0.0 };
	scene s = { 0 };
	for (int k = 0; k < 8; k++) {
		const double low[3] = { 0.25 * k, 0.0, 0.1 }, high[3] = { 0.25 * k + 0.125, 0.0, 0.275 };
		const double up[3] = { 0.125, 0.0, 0.175 }, down[3] = { 0.125, 0.0, -0.175 };
		scene_add_patch(&s, &(scene_patch){ low, up, along, 7, 60 }, 0.6f);
		scene_add_patch(&s, &(scene_patch){ high, down, along, 7, 60 }, 0.6f);
	}
	assert_little_added("furrows under a lamp", &s, &lamp);
	scene_clear(&s);
}

/* Bakes a closed sphere with a lamp, of which E_ind = rho Phi / (4 pi R^2 (1 - rho)) = 2 is known;
 * how far all radiance is off of its mean. */
static double lit_sphere_error(size_t count, uint64_t seed, gw_error_estimate *said)
{
	const gw_light lamp = scene_point_light(0.5, 0.3, -0.2, 2.0f);
	gw_bake_options options = gw_bake_options_default();
	double squares = 0.0, sum = 0.0;
	scene s;
	options.seed = seed;
	make_sphere(&s, count, 0.5f, false);
	gw_points points = scene_points(&s);
	gw_bake_result *result = scene_bake(&points, &lamp, 1, &options);
	for (size_t i = 0; i < s.count; i++) {
		double off = (double)result->indirect_irradiance[3 * i] - 2.0;
		squares += off * off;
		sum += 2.0 + (double)result->direct_irradiance[3 * i];
	}
	double truth = sqrt(squares * (double)s.count) / sum;
	*said = result->report.error;
	print_message("%zu points: stated %.3f +- %.3f %%, true %.3f %%\n", s.count,
				  100 * said->relative_rms, 100 * said->spread, 100 * truth);
	gw_bake_result_destroy(&result);
	scene_clear(&s);
	return truth;
}

/* There the octree's share of the error is half of it, and stated it may be as much as what is true
 * and a quarter. */
static void no_more_than_is_true(void **state)
{
	gw_error_estimate said;
	(void)state;
	double truth = lit_sphere_error(12000, gw_bake_options_default().seed, &said);
	assert_true(said.relative_rms >= 0.5 * truth && said.relative_rms <= 1.25 * truth);
}

/* The same of few points, whose leaves have the light of one or two each, from up to a spacing
 * away: what all who see these leaves are off alike. Stated and true are within two of its spreads;
 * before, of 600 points 0.75 to 0.83 was stated of 0.92, four spreads less of 2,000; and where
 * check points took lamps' light at places on planes, 0.48 of 0.62. */
static void leaves_of_few_points(void **state)
{
	(void)state;
	for (size_t count = 600; count < 6000; count *= 3)
		for (uint64_t seed = 1; seed < 4; seed++) {
			gw_error_estimate said;
			double truth = lit_sphere_error(count, seed, &said);
			assert_true(fabs(said.relative_rms - truth) <= 2.0 * said.spread);
		}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(light_lost_in_a_white_furnace),
		cmocka_unit_test(sun_in_a_closed_sphere),
		cmocka_unit_test(discs_that_are_cut),
		cmocka_unit_test(cones_between_leaning_plates),
		cmocka_unit_test(leaves_too_wide),
		cmocka_unit_test(sides_that_are_wrong),
		cmocka_unit_test(undersides_that_are_missing),
		cmocka_unit_test(sides_that_scanners_saw),
		cmocka_unit_test(sides_that_are_seen_from_above),
		cmocka_unit_test(nothing_is_added_where_all_is_right),
		cmocka_unit_test(clumps_are_no_shadows),
		cmocka_unit_test(edges_are_no_shadows),
		cmocka_unit_test(no_more_than_is_true),
		cmocka_unit_test(leaves_of_few_points),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
