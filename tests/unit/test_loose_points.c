/* What points on leaves stand for: handed on from the floor below, by any number of threads, until
 * somebody wants to stop. */
#include "cloud/frame.h"
#include "expected.h"
#include "surfels/loose_points.h"
#include "surfels/surfel_plane.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* A floor of even points, and above it a crown of points that face all ways. */
#define SIDE 60
#define FLOOR ((size_t)SIDE * SIDE)
#define COUNT (FLOOR + 20000)
#define LOW 2.0 /* the crown: from here to HIGH, as wide as the floor; both in spacings of it */
#define HIGH 20.0
#define WIDE 100.0f /* radius of the crown's discs before */
#define EVEN 1.5f   /* of the floor's */
#define PI 3.14159265358979323846

static double position[3 * COUNT];
static float normal[3 * COUNT], albedo[3 * COUNT];

static double next_random(uint64_t *state)
{
	*state = *state * 6364136223846793005u + 1442695040888963407u;
	return (double)(*state >> 11) * 0x1p-53;
}

/* A row of points that face one way, upright over the floor, as far apart as its discs are wide. */
#define ROW 7
#define ROW_STEP 2.0
#define ROW_WIDE 8.0f

static gw_points make_tree(void)
{
	uint64_t state = 1;
	for (size_t i = 0; i < COUNT; i++) {
		double *p = position + 3 * i, turn = 2.0 * PI * next_random(&state);
		double z = i < FLOOR ? 1.0 : 2.0 * next_random(&state) - 1.0, wide = sqrt(1.0 - z * z);
		normal[3 * i] = (float)(wide * cos(turn));
		normal[3 * i + 1] = (float)(wide * sin(turn));
		normal[3 * i + 2] = (float)z;
		p[0] = i < FLOOR ? (double)(i % SIDE) : SIDE * next_random(&state);
		p[1] = i < FLOOR ? (double)(i / SIDE) : SIDE * next_random(&state);
		p[2] = i < FLOOR ? 0.0 : LOW + (HIGH - LOW) * next_random(&state);
	}
	return (gw_points){ .count = COUNT, .position = position, .normal = normal, .albedo = albedo };
}

/* The floor of the tree, and the row instead of its crown. */
static gw_points make_row(void)
{
	gw_points points = make_tree();
	points.count = FLOOR + ROW;
	for (size_t k = 0; k < ROW; k++) {
		const size_t i = FLOOR + k;
		const double middle = 0.5 * SIDE + 0.5;
		memcpy(position + 3 * i, (double[]){ middle, middle, LOW + ROW_STEP * (double)k },
			   3 * sizeof *position);
		memcpy(normal + 3 * i, (float[]){ 1.0f, 0.0f, 0.0f }, 3 * sizeof *normal);
	}
	return points;
}

/* The floor, with a hole in it if that is asked for, and one point above its middle that faces up.
 */
static gw_points make_stray(double height, double hole)
{
	gw_points points = make_tree();
	const double middle[3] = { 0.5 * SIDE + 0.5, 0.5 * SIDE + 0.5, height };
	points.count = 0;
	for (size_t i = 0; i < FLOOR; i++)
		if (hypot(position[3 * i] - middle[0], position[3 * i + 1] - middle[1]) >= hole)
			memmove(position + 3 * points.count++, position + 3 * i, 3 * sizeof *position);
	memcpy(position + 3 * points.count, middle, sizeof middle);
	memcpy(normal + 3 * points.count++, (float[]){ 0.0f, 0.0f, 1.0f }, 3 * sizeof *normal);
	return points;
}

/* How often somebody was asked whether to stop, and from which time on they want to. */
typedef struct patience {
	int asked, most;
} patience;

static bool is_at_end(void *user)
{
	patience *p = user;
	return ++p->asked > p->most;
}

static bool is_of_floor(const gw_surfels *s, size_t i)
{
	return (double)s->position[3 * i + 2] + s->origin[2] < 0.5 * LOW;
}

/* The surfels of the tree, or the row: all discs but the floor's wide, and areas that grow from 1
 * to 2 along the floor. */
typedef struct tree {
	gw_surfels_options options;
	gw_surfels surfels;
	gw_neighbours *search;
	patience patience;
	uint8_t *fixed;
} tree;

static void open_points(tree *t, const gw_points *points, float wide, uint32_t threads)
{
	gw_error error;
	*t = (tree){ .patience.most = 1 << 30 };
	t->options = (gw_surfels_options){ .threads = threads };
	assert_ok(gw_frame_make(points, &t->options, &t->surfels, &error), &error);
	gw_surfels *s = &t->surfels;
	s->radius = malloc(s->count * sizeof *s->radius);
	s->area = malloc(s->count * sizeof *s->area);
	t->fixed = calloc(s->count, 1);
	assert_true(s->radius && s->area && t->fixed);
	for (size_t i = 0; i < s->count; i++) {
		s->radius[i] = is_of_floor(s, i) ? EVEN : wide;
		s->area[i] = 1.0f + s->position[3 * i] / (s->maximum[0] - s->minimum[0]);
	}
	assert_ok(gw_neighbours_open(s, &t->options, &t->search, &error), &error);
	t->options.cancelled = is_at_end;
	t->options.user = &t->patience;
}

static void open_tree(tree *t, uint32_t threads)
{
	const gw_points points = make_tree();
	open_points(t, &points, WIDE, threads);
}

static void close_tree(tree *t)
{
	gw_neighbours_close(t->search);
	gw_surfels_clear(&t->surfels);
	free(t->fixed);
}

/* Most of the crown gets discs of an area between those of the floor, the same for any number of
 * threads. */
static void areas_of_the_floor_go_up(void **state)
{
	(void)state;
	gw_error error;
	tree one, several;
	open_tree(&one, 1);
	assert_ok(gw_loose_points_bound(one.search, one.fixed, &one.surfels, &error), &error);
	size_t bounded = 0, count = one.surfels.count;
	for (size_t i = 0; i < count; i++) {
		double radius = (double)one.surfels.radius[i], area = PI * radius * radius;
		if (is_of_floor(&one.surfels, i)) {
			assert_true(radius == (double)EVEN);
			continue;
		}
		if (radius == (double)WIDE)
			continue;
		/* Those that are loose because they are wide have discs of GW_DISC_RANK areas. */
		double stood_for = area > 4.0 ? area / GW_DISC_RANK : area;
		assert_true(stood_for > 1.0 - 1e-5 && stood_for < 2.0 + 1e-5); /* of floats */
		bounded++;
	}
	assert_in_range(bounded, count / 2, count - FLOOR);
	for (uint32_t threads = 2; threads < 8; threads += 3) {
		open_tree(&several, threads);
		assert_ok(gw_loose_points_bound(several.search, several.fixed, &several.surfels, &error),
				  &error);
		assert_memory_equal(one.surfels.radius, several.surfels.radius, count * sizeof(float));
		assert_memory_equal(one.surfels.area, several.surfels.area, count * sizeof(float));
		close_tree(&several);
	}
	close_tree(&one);
}

/* Points of a row in the air are alike, but nothing solid lies on a surface with them: those that
 * are far from the floor stand for as much as one of its points, lower ones have discs as wide
 * as even ones there. */
static void rows_in_the_air_are_no_plates(void **state)
{
	(void)state;
	gw_error error;
	tree t;
	const gw_points points = make_row();
	open_points(&t, &points, ROW_WIDE, 2);
	assert_int_equal(t.surfels.count, points.count);
	assert_ok(gw_loose_points_bound(t.search, t.fixed, &t.surfels, &error), &error);
	for (size_t i = 0; i < t.surfels.count; i++) {
		double radius = (double)t.surfels.radius[i], area = PI * radius * radius;
		double height = (double)t.surfels.position[3 * i + 2] + t.surfels.origin[2];
		double ranks = height < 4.0 * (double)EVEN ? GW_DISC_RANK : 1.0;
		if (is_of_floor(&t.surfels, i))
			assert_true(radius == (double)EVEN);
		else /* areas of the floor are between 1 and 2 */
			assert_true(area > ranks * (1.0 - 1e-5) && area < ranks * (2.0 + 1e-5));
	}
	close_tree(&t);
}

/* One point above a floor faces as its neighbours do, all of which are solid, and is of no surface
 * with them all the same: where its slab is too thin for them, and where it is not, above a hole
 * that makes them as far away as three times its height. The former has a disc as wide as of even
 * points, the latter, which is far from them, stands for as much as one of them. */
static void strays_are_no_plates(void **state)
{
	(void)state;
	static const double height[] = { 4.0, 2.1 }, hole[] = { 0.0, 5.6 };
	static const float wide[] = { 8.0f, 4.0f }, ranks[] = { GW_DISC_RANK, 1.0f };
	for (int k = 0; k < 2; k++) {
		gw_error error;
		tree t;
		const gw_points points = make_stray(height[k], hole[k]);
		open_points(&t, &points, wide[k], 2);
		assert_int_equal(t.surfels.count, points.count);
		assert_ok(gw_loose_points_bound(t.search, t.fixed, &t.surfels, &error), &error);
		for (size_t i = 0; i < t.surfels.count; i++) {
			double radius = (double)t.surfels.radius[i], area = PI * radius * radius;
			double height_here = (double)t.surfels.position[3 * i + 2] + t.surfels.origin[2];
			if (height_here < 0.5 * height[k])
				assert_true(radius == (double)EVEN);
			else /* areas of the floor are between 1 and 2 */
				assert_true(area > ranks[k] * (1.0 - 1e-5) && area < ranks[k] * (2.0 + 1e-5));
		}
		close_tree(&t);
	}
}

static void visit_nothing(void *user, size_t surfel, const gw_neighbour_list *list)
{
	(void)user, (void)surfel, (void)list;
}

/* How often five visits of all points ask, which come before anything is handed on. */
static int asked_by_visits(void)
{
	gw_error error;
	tree t;
	open_tree(&t, 1);
	for (int visit = 0; visit < 5; visit++)
		assert_ok(gw_neighbours_visit_reach(t.search, visit_nothing, NULL, &error), &error);
	close_tree(&t);
	return t.patience.asked;
}

/* Whoever wants to stop is heard while areas are handed on, too, and nothing has changed then. */
static void it_stops_on_the_way_up(void **state)
{
	(void)state;
	gw_error error;
	int of_visits = asked_by_visits();
	for (int more = 0; more < 3; more++) {
		tree t;
		open_tree(&t, 1);
		t.patience.most = of_visits + more;
		assert_int_equal(gw_loose_points_bound(t.search, t.fixed, &t.surfels, &error),
						 GW_ERROR_CANCELLED);
		assert_int_equal(t.patience.asked, of_visits + more + 1);
		for (size_t i = 0; i < t.surfels.count; i++)
			assert_true(t.surfels.radius[i] == (is_of_floor(&t.surfels, i) ? EVEN : WIDE));
		close_tree(&t);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(areas_of_the_floor_go_up),
		cmocka_unit_test(rows_in_the_air_are_no_plates),
		cmocka_unit_test(strays_are_no_plates),
		cmocka_unit_test(it_stops_on_the_way_up),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
