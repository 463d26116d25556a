/*
 * torture_clouds.c - bakes of clouds that break other programs: one row for each way of being hard,
 * times shape, size, scale, place, turn, depth, method and lamps.
 */
#include "hard_cloud.h"
#include "lit_file.h"
#include "torture_child.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LARGEST_ALBEDO 0.99 /* what glowworm clamps to */

/* One bake and what it has to come to. */
typedef struct bake_case {
	hard_cloud cloud;
	hard_shape shape;
	double largest_albedo;
	bool refusable;   /* no cloud at all: status 65 is right, nothing else */
	bool may_refuse;  /* beyond what is promised: status 65 is right too */
	bool plain;       /* the row wants no random scale and shift */
	bool keeps_light; /* the row has lamps of its own */
	bool lampless;    /* only a sky of radiance 1 shines */
	torture_child child;
	char label[80];
} bake_case;

typedef struct cloud_row {
	const char *name;
	void (*make)(torture_case *c, bake_case *b);
} cloud_row;

/* ------------------------------------------------------------------------------------- rows */

static void shape_of(torture_case *c, bake_case *b, size_t count)
{
	b->shape = (hard_shape)case_pick(c, SHAPE_COUNT);
	hard_cloud_add(c, &b->cloud, b->shape, count);
}

static void usual(torture_case *c, bake_case *b)
{
	shape_of(c, b, (size_t)pow(10, case_between(c, 1.5, 3.7)));
}

static void make_plain(torture_case *c, bake_case *b)
{
	usual(c, b);
}

static void make_few(torture_case *c, bake_case *b)
{
	static const size_t few[] = { 1, 2, 3, 4, 5, 8, 10, 13, 20 };
	shape_of(c, b, few[case_pick(c, sizeof few / sizeof *few)]);
}

static void make_none(torture_case *c, bake_case *b)
{
	shape_of(c, b, 0);
	b->refusable = true;
}

static void make_not_finite(torture_case *c, bake_case *b)
{
	static const double bad[] = { NAN, INFINITY, -INFINITY };
	usual(c, b);
	double share = case_one_in(c, 3) ? 0.3 : 0.01;
	for (size_t i = 0; i < b->cloud.count; i++)
		if (i == 0 || case_random(c) < share)
			b->cloud.point[i].at[case_pick(c, 3)] = bad[case_pick(c, 3)];
	hard_cloud_push(&b->cloud);
}

static void make_all_not_finite(torture_case *c, bake_case *b)
{
	shape_of(c, b, 1 + (size_t)case_pick(c, 300));
	for (size_t i = 0; i < b->cloud.count; i++)
		b->cloud.point[i].at[case_pick(c, 3)] = NAN;
	b->refusable = true;
}

/* All of it twice, half of it in one place, two places, or one. */
static void make_duplicates(torture_case *c, bake_case *b)
{
	usual(c, b);
	size_t count = b->cloud.count;
	long way = case_pick(c, 4);
	for (size_t i = 0; i < count; i++) {
		if (way == 0)
			*hard_cloud_push(&b->cloud) = b->cloud.point[i];
		else if (way == 1 && i % 2)
			b->cloud.point[i] = b->cloud.point[0];
		else if (way > 1)
			b->cloud.point[i] = b->cloud.point[way == 2 ? i % 2 : 0];
	}
}

/* Pairs of points apart by less than a float can tell. */
static void make_near_duplicates(torture_case *c, bake_case *b)
{
	usual(c, b);
	double apart = pow(10, case_between(c, -16, -6));
	for (size_t i = 0, count = b->cloud.count; i < count; i++) {
		hard_point p = b->cloud.point[i];
		p.at[case_pick(c, 3)] += apart;
		*hard_cloud_push(&b->cloud) = p;
	}
}

static void make_line(torture_case *c, bake_case *b)
{
	usual(c, b);
	long axes = 1 + case_pick(c, 2); /* a line, or a plane */
	bool even = case_one_in(c, 2);
	for (size_t i = 0; i < b->cloud.count; i++) {
		double *at = b->cloud.point[i].at;
		for (int a = 0; a < 3; a++)
			at[a] = a >= axes ? 0 : even ? floor(at[a] * 16) / 16 : at[a];
	}
}

/* All on corners and faces of cells. */
static void make_lattice(torture_case *c, bake_case *b)
{
	usual(c, b);
	double cell = pow(2, (double)case_pick(c, 7));
	for (size_t i = 0; i < b->cloud.count; i++)
		for (int a = 0; a < 3; a++)
			b->cloud.point[i].at[a] = floor(b->cloud.point[i].at[a] * cell) / cell;
}

static void make_stray(torture_case *c, bake_case *b)
{
	usual(c, b);
	double distance = pow(10, case_between(c, 3, 7));
	for (long i = 1 + case_pick(c, 5); i > 0; i--)
		hard_cloud_push(&b->cloud)->at[case_pick(c, 3)] = case_one_in(c, 2) ? distance : -distance;
}

static void make_far_stray(torture_case *c, bake_case *b)
{
	usual(c, b);
	hard_cloud_push(&b->cloud)->at[case_pick(c, 3)] = pow(10, case_between(c, 7, 30));
}

/* A patch of the room, or a half of what it is, many times as dense. */
static void make_uneven(torture_case *c, bake_case *b)
{
	static const size_t ratio[] = { 5, 25, 36, 89, 360, 1000 };
	shape_of(c, b, 100 + (size_t)case_pick(c, 500));
	size_t count = b->cloud.count, more = ratio[case_pick(c, 6)];
	for (size_t i = 0; i < count / 20; i++) {
		for (size_t k = 1; k < more && b->cloud.count < 20000; k++) {
			hard_point p = b->cloud.point[i];
			for (int a = 0; a < 3; a++)
				p.at[a] += p.normal[a] == 0 ? case_between(c, -0.05, 0.05) : 0;
			*hard_cloud_push(&b->cloud) = p;
		}
	}
}

/* Scan lines: many points along, few across. */
static void make_stretched(torture_case *c, bake_case *b)
{
	usual(c, b);
	double by = pow(10, case_between(c, 1, 4));
	long axis = case_pick(c, 3);
	for (size_t i = 0; i < b->cloud.count; i++)
		b->cloud.point[i].at[axis] *= by;
}

static void place(torture_case *c, bake_case *b, double low, double high)
{
	double scale = pow(10, case_between(c, low, high));
	hard_cloud_place(&b->cloud, scale, (double[3]){ 0, 0, 0 });
	b->plain = true;
}

static void make_tiny(torture_case *c, bake_case *b)
{
	usual(c, b);
	place(c, b, -12, -3);
}

static void make_vanishing(torture_case *c, bake_case *b)
{
	usual(c, b);
	place(c, b, -320, -12);
}

static void make_huge(torture_case *c, bake_case *b)
{
	usual(c, b);
	place(c, b, 3, 12);
}

static void make_boundless(torture_case *c, bake_case *b)
{
	usual(c, b);
	place(c, b, 12, 37);
	b->may_refuse = true;
}

static void make_georeferenced(torture_case *c, bake_case *b)
{
	static const double shift[][3] = {
		{ 5e5, 5.4e6, 100 }, { 1e7, -1e7, 1e7 }, { -3e6, 4.1e6, 5e3 }, { 148376, 1234, -223423 }
	};
	usual(c, b);
	hard_cloud_place(&b->cloud, 1, shift[case_pick(c, 4)]);
	b->plain = true;
}

static void make_bad_normals(torture_case *c, bake_case *b)
{
	static const double bad[] = { 0, 1e-40, 1e-320, 1e20, 1e38, NAN, INFINITY, -0.0 };
	usual(c, b);
	double share = case_one_in(c, 2) ? 1 : 0.2;
	for (size_t i = 0; i < b->cloud.count; i++) {
		double factor = bad[case_pick(c, 8)];
		for (int a = 0; a < 3 && case_random(c) < share; a++)
			b->cloud.point[i].normal[a] *= factor;
	}
}

static void make_no_normals(torture_case *c, bake_case *b)
{
	usual(c, b);
	b->cloud.has_normals = false;
}

static void make_wrong_normals(torture_case *c, bake_case *b)
{
	usual(c, b);
	double share = case_between(c, 0, 1);
	for (size_t i = 0; i < b->cloud.count; i++)
		for (int a = 0; a < 3 && case_random(c) < share; a++)
			b->cloud.point[i].normal[a] = case_between(c, -1, 1);
}

static void make_noisy(torture_case *c, bake_case *b)
{
	usual(c, b);
	double spacing = 4 / sqrt((double)b->cloud.count);
	hard_cloud_shake(c, &b->cloud, spacing * case_between(c, 0, 1));
}

static void make_black_white(torture_case *c, bake_case *b)
{
	static const double value[] = { 0, 1, 0.98, 1e-6 };
	usual(c, b);
	for (size_t i = 0; i < b->cloud.count; i++)
		for (int a = 0; a < 3; a++)
			b->cloud.point[i].albedo[a] = value[case_pick(c, 4)];
	b->largest_albedo = 1;
}

static void make_bad_colors(torture_case *c, bake_case *b)
{
	static const double bad[] = { NAN, INFINITY, -INFINITY, -1, -0.0, 1e38, 1e-40 };
	usual(c, b);
	b->cloud.has_emission = true;
	for (size_t i = 0; i < b->cloud.count; i++) {
		b->cloud.point[i].albedo[case_pick(c, 3)] = bad[case_pick(c, 7)];
		if (case_one_in(c, 3))
			b->cloud.point[i].emission[case_pick(c, 3)] = bad[case_pick(c, 5)];
	}
	b->largest_albedo = 1;
}

static void make_glowing(torture_case *c, bake_case *b)
{
	usual(c, b);
	hard_cloud_emission(&b->cloud, 0);
	for (size_t i = 0; i < b->cloud.count; i++)
		if (case_one_in(c, 10))
			for (int a = 0; a < 3; a++)
				b->cloud.point[i].emission[a] = pow(10, case_between(c, -9, 9));
}

static void make_blinding(torture_case *c, bake_case *b)
{
	static const double extreme[] = { 1e30, 1e38, 3e38, 1e-30, 1e-38, 1e-44 };
	usual(c, b);
	double value = extreme[case_pick(c, 6)];
	if (case_one_in(c, 2)) {
		hard_cloud_emission(&b->cloud, value);
		b->may_refuse = value * 3.15 > 3.4e38; /* irradiance, pi times as much, is no float */
	} else {
		child_add(&b->child, "--light");
		child_add(&b->child, "point at 0.1,0.2,0.3 intensity %g", value);
		b->keeps_light = true;
		b->may_refuse = value > 1e37; /* nearer than a metre that is more than a float holds */
	}
}

/* Single points far from one another, and a grid of them. */
static void make_scattered_grid(torture_case *c, bake_case *b)
{
	b->shape = CROWD;
	hard_cloud_add(c, &b->cloud, CROWD, 50 + (size_t)case_pick(c, 1000));
	child_add_words(&b->child, case_one_in(c, 2) ? "--vdb out.vdb --vdb-half" : "--vdb out.vdb");
}

static void make_deep(torture_case *c, bake_case *b)
{
	usual(c, b);
	child_add(&b->child, "--depth");
	child_add(&b->child, "%ld", 8 + case_pick(c, 3));
}

static void make_shallow(torture_case *c, bake_case *b)
{
	usual(c, b);
	child_add(&b->child, "--depth");
	child_add(&b->child, "%ld", 1 + case_pick(c, 3));
}

static void make_odd_lamps(torture_case *c, bake_case *b)
{
	static const char *const lamp[] = {
		"point at 1,0,0 intensity 3",
		"point at 0,0,0 intensity 3 radius 5",
		"point at 1e9,0,0 intensity 1e18",
		"spot at 0,0,0 toward 0,0,-1 intensity 3 inner 0 outer 0.001",
		"spot at 0,0,0 toward 0,0,-1 intensity 3 inner 89 outer 90",
		"sun toward 1e-30,0,-1e-30 irradiance 1",
		"sun toward 0,0,-1 irradiance 1 angle 89",
		"sun toward 0,0,-1 irradiance 1 angle 0",
		"point at 0,0,1e-20 intensity 1e-20",
	};
	usual(c, b);
	for (int i = 0; i < 2; i++) {
		child_add(&b->child, "--light");
		child_add(&b->child, "%s", lamp[case_pick(c, 9)]);
	}
	b->keeps_light = true;
}

static const cloud_row rows[] = {
	{ "plain", make_plain },
	{ "few points", make_few },
	{ "no points", make_none },
	{ "not finite", make_not_finite },
	{ "none finite", make_all_not_finite },
	{ "duplicates", make_duplicates },
	{ "near duplicates", make_near_duplicates },
	{ "line or plane", make_line },
	{ "lattice", make_lattice },
	{ "stray", make_stray },
	{ "far stray", make_far_stray },
	{ "uneven density", make_uneven },
	{ "stretched", make_stretched },
	{ "tiny", make_tiny },
	{ "vanishing", make_vanishing },
	{ "huge", make_huge },
	{ "boundless", make_boundless },
	{ "georeferenced", make_georeferenced },
	{ "bad normals", make_bad_normals },
	{ "no normals", make_no_normals },
	{ "wrong normals", make_wrong_normals },
	{ "noisy", make_noisy },
	{ "black and white", make_black_white },
	{ "bad colors", make_bad_colors },
	{ "glowing", make_glowing },
	{ "blinding", make_blinding },
	{ "scattered grid", make_scattered_grid },
	{ "deep octree", make_deep },
	{ "shallow octree", make_shallow },
	{ "odd lamps", make_odd_lamps },
};
#define ROW_COUNT ((long)(sizeof rows / sizeof *rows))

/* ------------------------------------------------------------------------------ the command */

static bool has_light(const hard_cloud *cloud)
{
	for (size_t i = 0; i < cloud->count && cloud->has_emission; i++)
		if (cloud->point[i].emission[0] > 1e-9 && isfinite(cloud->point[i].emission[0]))
			return true;
	return false;
}

static void add_lamps(torture_case *c, bake_case *b)
{
	long way = case_pick(c, 5);
	bool glows = has_light(&b->cloud);
	if (b->keeps_light)
		return;
	if (way == 0 && glows)
		return;
	child_add(&b->child, "--light");
	if (way <= 1) {
		child_add(&b->child, "sky radiance 1");
		b->lampless = !b->cloud.has_emission;
	} else if (way == 2) {
		child_add(&b->child, "sun toward 0.3,-0.2,-1 irradiance 2");
	} else if (way == 3) {
		child_add(&b->child, "point at 0.1,0.05,0.12 intensity 3");
	} else {
		child_add(&b->child, "spot at 0.1,0.05,0.12 toward 0,0,-1 intensity 3 radius 0.05");
	}
}

static bool has_argument(const torture_child *child, const char *argument)
{
	for (size_t i = 0; i < child->count; i++)
		if (strcmp(child->argument[i], argument) == 0)
			return true;
	return false;
}

static void add_options(torture_case *c, torture_child *child)
{
	if (case_one_in(c, 4))
		child_add_words(child, "--method cones --cones 6");
	if (case_one_in(c, 4))
		child_add_words(child, "--shadows maps --shadow-map-size 64");
	if (case_one_in(c, 3))
		child_add_words(child, "--quality draft");
	if (case_one_in(c, 4))
		child_add_words(child, "--fields direct,indirect,irradiance,roi,ao,normals,error");
	if (case_one_in(c, 3))
		child_add_words(child, "--estimate-points 0");
	if (case_one_in(c, 6) && !has_argument(child, "--depth")) {
		child_add(child, "--depth");
		child_add(child, "%ld", 1 + case_pick(c, 9));
	}
	if (case_one_in(c, 5))
		child_add_words(child, "--bounces 3");
}

/* Fills in what the row left open. */
static void finish_case(torture_case *c, bake_case *b)
{
	if (!b->plain && case_one_in(c, 2))
		hard_cloud_turn(c, &b->cloud);
	if (!b->plain && case_one_in(c, 3)) {
		double scale = pow(10, case_between(c, -3, 3));
		double by = case_one_in(c, 2) ? 0 : pow(10, case_between(c, 1, 6)) * scale;
		hard_cloud_place(&b->cloud, scale, (double[3]){ by, -by, 0 });
	}
	hard_cloud_shuffle(c, &b->cloud);
	add_lamps(c, b);
	add_options(c, &b->child);
	child_add_words(&b->child, "in.ply -o out.ply --report report.json --input-gamma linear "
							   "--albedo rgb --force");
	hard_cloud_write(c, &b->cloud, "in.ply");
}

/* --------------------------------------------------------------------------------- the checks */

static const char *what(const bake_case *b, const char *claim)
{
	static char name[160];
	snprintf(name, sizeof name, "%s/%s", b->label, claim);
	return name;
}

static bool same_number(double a, double b)
{
	return memcmp(&a, &b, sizeof a) == 0;
}

/* Same points, same order, every number finite, light >= 0. */
static void check_points(torture_case *c, const bake_case *b, const lit_file *lit)
{
	if (lit->count != b->cloud.count) {
		case_fail(c, what(b, "count"), "%zu points in, %zu out", b->cloud.count, lit->count);
		return;
	}
	for (size_t i = 0; i < lit->count; i++) {
		const double *in = b->cloud.point[i].at, *out = lit->at + 3 * i;
		bool finite = isfinite(in[0]) && isfinite(in[1]) && isfinite(in[2]);
		for (int a = 0; a < 3; a++) {
			if (finite && !same_number(in[a], out[a])) {
				case_fail(c, what(b, "place"), "point %zu: %.17g became %.17g", i, in[a], out[a]);
				return;
			}
			double light = lit->radiance[3 * i + (size_t)a];
			if (!isfinite(light) || light < 0) {
				case_fail(c, what(b, "light"), "point %zu has radiance %g", i, light);
				return;
			}
		}
	}
}

/* Sums of floats below the least normal one are rounded to multiples of 1.4e-45. */
#define ENERGY_LEAST 1e-40

/* Light gathered by a record is a mean over its rays of what surface sends out, and that of surface
 * a mean over records, times its albedo: no record gathers more than the brightest did a bounce
 * before, times the largest albedo. Sums of up to 4,096 floats are right to that many of their last
 * bits. By cones what is seen is looked up between texels of a limited number of bits. */
#define SUM_ROUNDING (4096 * 6e-8)

static void check_largest(torture_case *c, const bake_case *b, const lit_report *report)
{
	double rho = fmin(b->largest_albedo, LARGEST_ALBEDO);
	if (has_argument(&b->child, "--method"))
		return;
	for (size_t i = 2; i < report->bounces; i++) {
		double most = rho * report->largest[i - 1] * (1 + SUM_ROUNDING) + ENERGY_LEAST;
		if (!(report->largest[i] <= most)) {
			case_fail(c, what(b, "record gains"),
					  "a record gathers %.9g in bounce %zu, after %.9g at most, albedo %g",
					  report->largest[i], i, report->largest[i - 1], rho);
			return;
		}
	}
}

/*
 * A bounce sends out at most the largest albedo times what the one before sent out, if light is
 * gathered everywhere. It is gathered at records, each of which speaks for a part of the surface;
 * of a sum of parts at random places the variance is the sum of their squares at most, so that it
 * is off by itself over sqrt(carriers). More rays do not lessen that: they see the same walls from
 * the same places. Four such deviations are allowed, for bounces of twelve thousand cases. Where
 * hundreds of records carry the light, that is little; on loose points, of which single ones are
 * lit, it says next to nothing, and the check above all the more. All later bounces together send
 * out at most rho / (1 - rho) times the first one.
 */
static void check_energy(torture_case *c, const bake_case *b, const lit_report *report)
{
	double rho = fmin(b->largest_albedo, LARGEST_ALBEDO), sum = 0, doubt = 0;
	for (size_t i = 0; i < report->bounces; i++) {
		double e = report->energy[i], share = 4 / sqrt(fmax(report->carriers[i], 1));
		if (!isfinite(e) || e < 0) {
			case_fail(c, what(b, "energy"), "bounce %zu sends out %g", i, e);
			return;
		}
		if (i < 2)
			continue;
		sum += e;
		doubt += e * share;
		if (e * (1 - share) > rho * report->energy[i - 1] + ENERGY_LEAST) {
			case_fail(c, what(b, "energy grows"),
					  "bounce %zu sends out %g after %g, albedo %g, by %g records", i, e,
					  report->energy[i - 1], rho, report->carriers[i]);
			return;
		}
	}
	if (sum - doubt > rho / (1 - rho) * report->energy[1])
		case_fail(c, what(b, "energy sum"),
				  "later bounces are %g together, %g of it doubtful, after %g, albedo %g", sum,
				  doubt, report->energy[1], rho);
}

/* Under a sky of radiance 1 alone nothing sends out more than rho times what is around it, and by
 * that no more than rho; a quarter more is the noise of the rays of one record. */
static void check_brightest(torture_case *c, const bake_case *b, const lit_file *lit)
{
	double rho = fmin(b->largest_albedo, LARGEST_ALBEDO), brightest = 0;
	for (size_t i = 0; i < 3 * lit->count; i++)
		brightest = fmax(brightest, lit->radiance[i]);
	if (brightest > 1.25 * rho)
		case_fail(c, what(b, "too bright"), "a point sends out %g under a sky of 1", brightest);
}

/* The same with one thread, on the driver too. */
static void check_again(torture_case *c, bake_case *b)
{
	torture_child again = b->child;
	for (size_t i = 0; i < again.count; i++) {
		if (strcmp(again.argument[i], "out.ply") == 0)
			again.argument[i] = "again.ply";
		if (strcmp(again.argument[i], "--vdb") == 0 || strcmp(again.argument[i], "out.vdb") == 0)
			again.argument[i] = again.argument[i][0] == '-' ? "--vdb" : "again.vdb";
	}
	child_add_words(&again, "--threads 1");
	child_set(&again, "LP_NUM_THREADS=%d", (int)case_pick(c, 2));
	child_run(c, &again);
	if (!child_check(c, &again, b->label))
		return;
	if (again.code != b->child.code)
		case_fail(c, what(b, "not the same"), "one thread ends with %d in place of %d: %s",
				  again.code, b->child.code, child_line(&b->child));
	else if (!child_same_files(c, "out.ply", "again.ply"))
		case_fail(c, what(b, "not the same"), "one thread gives other bytes: %s",
				  child_line(&b->child));
}

/* What a bake of so many points may take here: seconds to start and compile, then for each. */
static void check_limits(torture_case *c, const bake_case *b)
{
	double megabytes = 400 + 0.02 * (double)b->cloud.count;
	if (has_argument(&b->child, "--depth") || has_argument(&b->child, "--vdb"))
		megabytes += 2000;
	if (b->child.megabytes > megabytes)
		case_fail(c, what(b, "memory"), "%zu points took %.0f MB: %s", b->cloud.count,
				  b->child.megabytes, child_line(&b->child));
}

static void check_result(torture_case *c, bake_case *b)
{
	lit_file lit;
	lit_report report;
	if (b->refusable) {
		if (b->child.code != 65)
			case_fail(c, what(b, "status"), "status %d instead of 65", b->child.code);
		return;
	}
	if (b->may_refuse && b->child.code == 65)
		return;
	if (b->child.code != 0) {
		case_fail(c, what(b, "refused"), "status %d: %s", b->child.code, b->child.message);
		return;
	}
	check_limits(c, b);
	if (lit_file_read(c, b->label, "out.ply", &lit)) {
		check_points(c, b, &lit);
		if (b->lampless)
			check_brightest(c, b, &lit);
		lit_file_clear(&lit);
	}
	if (lit_report_read(c, b->label, "report.json", &report))
		check_largest(c, b, &report);
	check_energy(c, b, &report);
	check_again(c, b);
}

/* -------------------------------------------------------------------------------- the part */

static void run(torture_case *c)
{
	const cloud_row *row = &rows[c->number % ROW_COUNT];
	bake_case *b = calloc(1, sizeof *b);
	if (!b)
		exit(71);
	snprintf(b->label, sizeof b->label, "%s", row->name);
	b->largest_albedo = 0.5;
	child_start(&b->child);
	child_add(&b->child, "bake");
	row->make(c, b);
	finish_case(c, b);
	if (case_trial(c)) {
		child_run(c, &b->child);
		if (child_check(c, &b->child, b->label))
			check_result(c, b);
	}
	hard_cloud_clear(&b->cloud);
	free(b);
}

static long count(bool slice)
{
	return ROW_COUNT * (slice ? 1 : 400);
}

const torture_part clouds_part = {
	"clouds", "bakes of hard clouds: 30 rows by shape, scale, place, turn, depth, lamps", count, run
};
