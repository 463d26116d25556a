/*
 * torture_light.c - whether the light is what it has to be, and stays so: whatever the depth, the
 * density, the place, the size, the number of bounces, and however thin a closed wall.
 *
 * Closed forms: in an enclosure that emits Le everywhere L = Le / (1 - rho). A lamp I in the centre
 * of a sphere of radius 1 gives L = rho I / (pi (1 - rho)) everywhere. Between endless plates
 * L1 = Le1 / (1 - rho1 rho2) and L2 = rho2 L1. Nothing gets into what is closed.
 *
 * Bars are in percent of the mean and say what is promised: half a percent where light is even
 * (rays through random numbers over hundreds of records average below 0.3), one percent at albedo
 * 0.98, where the same error is multiplied by 50 reflections, 1.5 percent where 600 points have to
 * stand for a sphere, whose discs lie up to 0.7 percent off it.
 */
#include "hard_cloud.h"
#include "lit_file.h"
#include "torture_child.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846

/* The largest that glowworm takes as it is. */
#define ALBEDO_HIGH 0.99

typedef struct light_row {
	const char *name;
	void (*measure)(torture_case *c, int variant);
	int variants;
	int in_slice; /* every in_slice-th variant is in the slice; 0: none */
} light_row;

/* Bakes the cloud that is in in.ply; false after a failure. The report may be NULL. */
static bool bake(torture_case *c, const char *row, const char *lamp, const char *options,
				 lit_file *lit, lit_report *report)
{
	torture_child child;
	child_start(&child);
	child_add_words(
		&child, "bake in.ply -o out.ply --report report.json --input-gamma linear --normals given "
				"--albedo rgb --force");
	child_add_words(&child, options);
	if (lamp) {
		child_add(&child, "--light");
		child_add(&child, "%s", lamp);
	}
	child.limit = 120;
	child_run(c, &child);
	if (!child_check(c, &child, row))
		return false;
	if (child.code != 0) {
		char name[100];
		snprintf(name, sizeof name, "%s/refused", row);
		case_fail(c, name, "status %d: %s", child.code, child.message);
		return false;
	}
	return lit_file_read(c, row, "out.ply", lit) && lit_report_read(c, row, "report.json", report);
}

/* Percent that the mean of the points [first, end) is off the truth. */
static double off(const lit_file *lit, size_t first, size_t end, double truth)
{
	return 100 * (lit_file_mean(lit, first, end) / truth - 1);
}

static const double origin[3] = { 0, 0, 0 };

/* A sphere of radius `scale` about `centre`, the first `count` points of which are measured. */
typedef struct measured_sphere {
	size_t count;
	double scale;
	const double *centre; /* NULL: the origin */
	const char *options;  /* NULL: none */
	const char *row;
	double bar; /* percent */
} measured_sphere;

/* A lamp of scale^2 W/sr in the centre, albedo 0.5: L = 1 / pi. */
static void measure_sphere(torture_case *c, hard_cloud *cloud, measured_sphere s, const char *what)
{
	const double *centre = s.centre ? s.centre : origin;
	char lamp[200];
	lit_file lit;
	lit_report report;
	hard_cloud_place(cloud, s.scale, centre);
	hard_cloud_write(c, cloud, "in.ply");
	snprintf(lamp, sizeof lamp, "point at %.17g,%.17g,%.17g intensity %.17g", centre[0], centre[1],
			 centre[2], s.scale * s.scale);
	if (bake(c, s.row, lamp, s.options ? s.options : "", &lit, &report)) {
		case_measure(c, s.row, off(&lit, 0, s.count, 1 / PI), s.bar, "%s (stated %.2g %%)", what,
					 100 * report.error);
		lit_file_clear(&lit);
	}
	hard_cloud_clear(cloud);
}

/* ------------------------------------------------------------------- reflections without end */

static void measure_bounces(torture_case *c, int variant)
{
	static const char *const method[] = { "rays", "cones" };
	hard_cloud cloud = { 0 };
	lit_file lit;
	lit_report report;
	char options[200];
	hard_cloud_add(c, &cloud, variant / 2 ? ROOM : SPHERE, 1000);
	hard_cloud_albedo(&cloud, ALBEDO_HIGH);
	hard_cloud_emission(&cloud, 1);
	hard_cloud_write(c, &cloud, "in.ply");
	hard_cloud_clear(&cloud);
	snprintf(options, sizeof options, "--bounces 2000 --estimate-points 0 --method %s",
			 method[variant % 2]);
	if (!bake(c, "bounces", NULL, options, &lit, &report))
		return;
	double growth = 0, sum = 0;
	for (size_t i = 0; i < report.bounces; i++) {
		sum += report.energy[i];
		if (i > 0 && report.energy[i - 1] > 1e-30)
			growth = fmax(growth, report.energy[i] / report.energy[i - 1]);
	}
	case_measure(c, "bounces/growth", growth, ALBEDO_HIGH + 1e-3, "%s, %zu bounces: largest ratio",
				 options, report.bounces);
	case_measure(c, "bounces/sum", sum / report.energy[0], 1.001 / (1 - ALBEDO_HIGH),
				 "%s, %zu bounces: all over the first", options, report.bounces);
	lit_file_clear(&lit);
}

/* ----------------------------------------------------------------------------------- furnaces */

static void measure_furnace(torture_case *c, int variant)
{
	static const double albedo[] = { 0.2, 0.5, 0.8, 0.9, 0.95, 0.98 };
	static const double bar[] = { 0.5, 0.5, 0.5, 0.5, 0.5, 1 };
	static const size_t count[] = { 3000, 30000 };
	double rho = albedo[variant % 6];
	hard_shape shape = variant / 6 % 2 ? ROOM : SPHERE;
	size_t points = count[variant / 12];
	hard_cloud cloud = { 0 };
	lit_file lit;
	lit_report report;
	char row[60];
	hard_cloud_add(c, &cloud, shape, points);
	hard_cloud_albedo(&cloud, rho);
	hard_cloud_emission(&cloud, 1);
	hard_cloud_write(c, &cloud, "in.ply");
	hard_cloud_clear(&cloud);
	snprintf(row, sizeof row, "furnace/%s %g", hard_shape_name(shape), rho);
	if (!bake(c, row, NULL, "", &lit, &report))
		return;
	case_measure(c, row, off(&lit, 0, lit.count, 1 / (1 - (double)(float)rho)), bar[variant % 6],
				 "%s of %zu points, albedo %g (stated %.2g %%)", hard_shape_name(shape), points,
				 rho, 100 * report.error);
	lit_file_clear(&lit);
}

/* ------------------------------------------------------------------------------------- slabs */

#define RINGS 300
#define PLATE_RADIUS 10.0

/*
 * Two discs, 1 apart, the lower one emits 1. What a point at r of one gets from the ring at s of
 * the other is 2 a s ds / (a^2 - b^2)^1.5, a = 1 + r^2 + s^2, b = 2 r s: the radiosity equation in
 * one variable, solved by reflecting until nothing changes. Gives the radiance that the upper disc
 * sends out, as a mean over r < 3.
 */
static double upper_plate(const double rho[2])
{
	static double kernel[RINGS][RINGS];
	double lower[RINGS], upper[RINGS], step = PLATE_RADIUS / RINGS, sum = 0, area = 0;
	for (int i = 0; i < RINGS; i++) {
		double r = (i + 0.5) * step;
		for (int k = 0; k < RINGS; k++) {
			double s = (k + 0.5) * step, a = 1 + r * r + s * s, b = 2 * r * s;
			kernel[i][k] = 2 * a * s * step / pow(a * a - b * b, 1.5);
		}
		lower[i] = 1;
	}
	for (int bounce = 0; bounce < 200; bounce++) {
		double *to = bounce % 2 ? lower : upper, *from = bounce % 2 ? upper : lower;
		for (int i = 0; i < RINGS; i++) {
			double in = 0;
			for (int k = 0; k < RINGS; k++)
				in += kernel[i][k] * from[k];
			to[i] = bounce % 2 ? 1 + rho[0] * in : rho[1] * in;
		}
	}
	for (int i = 0; (i + 0.5) * step < 3; i++) {
		sum += upper[i] * (i + 0.5);
		area += i + 0.5;
	}
	return sum / area;
}

/*
 * What cones may find too much, in percent. Between plates that lean against the axes they are
 * filled before they get out past the rim; at most plates look as if they had none, which makes rho
 * / (1 - rho rho').
 */
static double cones_bar(const double rho[2], bool turned)
{
	double endless = rho[1] / (1 - rho[0] * rho[1]);
	return turned ? fmax(5, 100 * (endless / upper_plate(rho) - 1)) : 5;
}

/* Turns SHEETS, squares of side 2, into the discs. */
static void make_plates(torture_case *c, hard_cloud *cloud, const double rho[2])
{
	hard_cloud sheets = { 0 };
	hard_cloud_add(c, &sheets, SHEETS, 15000);
	for (size_t i = 0; i < sheets.count; i++) {
		hard_point p = sheets.point[i];
		bool upper = p.at[2] > 0.1;
		if (p.at[0] * p.at[0] + p.at[1] * p.at[1] > 1)
			continue;
		for (int a = 0; a < 3; a++) {
			p.at[a] *= a < 2 ? PLATE_RADIUS : 5;
			p.emission[a] = !upper;
			p.albedo[a] = rho[upper];
		}
		*hard_cloud_push(cloud) = p;
	}
	cloud->has_normals = cloud->has_emission = true;
	hard_cloud_clear(&sheets);
}

static void measure_slab(torture_case *c, int variant)
{
	static const double albedo[][2] = { { 0.5, 0.5 }, { 0.9, 0.9 }, { 0.2, 0.8 } };
	const double *rho = albedo[variant % 3];
	bool turned = variant / 3 % 2, cones = variant / 6;
	hard_cloud cloud = { 0 };
	lit_file lit;
	lit_report report;
	make_plates(c, &cloud, rho);
	if (turned)
		hard_cloud_turn(c, &cloud);
	hard_cloud_write(c, &cloud, "in.ply");
	if (bake(c, "slab", NULL, cones ? "--method cones" : "", &lit, &report)) {
		double sum = 0, n = 0;
		for (size_t i = 0; i < cloud.count; i++) {
			const double *at = cloud.point[i].at;
			double d = sqrt(at[0] * at[0] + at[1] * at[1] + at[2] * at[2]);
			bool counted = cloud.point[i].emission[0] == 0 && d * d < 9 + 1;
			sum += counted ? lit.radiance[3 * i + 1] : 0;
			n += counted;
		}
		double off = 100 * (sum / n / upper_plate(rho) - 1);
		double bar = !cones ? 0.5 : off > 0 ? cones_bar(rho, turned) : 5; /* rays as in a furnace */
		case_measure(c, cones ? "slab/cones" : "slab/rays", off, bar,
					 "plates of albedo %g and %g, %s%s (stated %.2g %%)", rho[0], rho[1],
					 cones ? "cones" : "rays", turned ? ", turned" : "", 100 * report.error);
		lit_file_clear(&lit);
	}
	hard_cloud_clear(&cloud);
}

/* ------------------------------------------------- what the brightness must not depend on */

static void measure_depth(torture_case *c, int variant)
{
	hard_cloud cloud = { 0 };
	char options[50], what[100];
	size_t points = variant / 9 ? 6000 : 600;
	hard_cloud_add(c, &cloud, SPHERE, points);
	snprintf(options, sizeof options, "--depth %d", 4 + variant % 9);
	snprintf(what, sizeof what, "sphere of %zu points, %s", points, options);
	const measured_sphere s = {
		.count = points, .scale = 1, .options = options, .row = "depth", .bar = 1.5
	};
	measure_sphere(c, &cloud, s, what);
}

static void measure_density(torture_case *c, int variant)
{
	static const size_t count[] = { 200, 600, 2000, 6000, 20000, 60000 };
	hard_cloud cloud = { 0 };
	char what[100];
	hard_cloud_add(c, &cloud, SPHERE, count[variant]);
	snprintf(what, sizeof what, "sphere of %zu points", count[variant]);
	const measured_sphere s = { .count = count[variant], .scale = 1, .row = "density", .bar = 1.5 };
	measure_sphere(c, &cloud, s, what);
}

static void measure_scale(torture_case *c, int variant)
{
	static const double power[] = { -9, -6, -3, 0, 3, 6, 9 };
	hard_cloud cloud = { 0 };
	char what[100];
	hard_cloud_add(c, &cloud, SPHERE, 3000);
	hard_cloud_turn(c, &cloud);
	snprintf(what, sizeof what, "sphere of radius 1e%g m, turned", power[variant]);
	const measured_sphere s = {
		.count = 3000, .scale = pow(10, power[variant]), .row = "scale", .bar = 0.5
	};
	measure_sphere(c, &cloud, s, what);
}

static void measure_shift(torture_case *c, int variant)
{
	static const double place[][3] = {
		{ 5e5, 5.4e6, 100 }, { 1e7, -1e7, 1e7 }, { -1e9, 1e3, 1 }, { 0.123, 0.456, -0.789 }
	};
	hard_cloud cloud = { 0 };
	char what[100];
	hard_cloud_add(c, &cloud, SPHERE, 3000);
	snprintf(what, sizeof what, "sphere about %g,%g,%g", place[variant][0], place[variant][1],
			 place[variant][2]);
	const measured_sphere s = {
		.count = 3000, .scale = 1, .centre = place[variant], .row = "shift", .bar = 0.5
	};
	measure_sphere(c, &cloud, s, what);
}

/* A patch of the sphere that is `ratio` times as dense as the rest, which is measured. */
static void measure_uneven(torture_case *c, int variant)
{
	static const size_t ratio[] = { 5, 25, 36, 89, 360, 1000 };
	static const size_t count[] = { 600, 3000 };
	hard_cloud cloud = { 0 };
	char what[100];
	size_t points = count[variant / 6], density = ratio[variant % 6], dense = points / 30 * density;
	hard_cloud_add(c, &cloud, SPHERE, points);
	while (dense > 0) { /* a cap that is a thirtieth of the sphere */
		hard_cloud one = { 0 };
		hard_cloud_add(c, &one, SPHERE, 256);
		for (size_t i = 0; i < one.count && dense > 0; i++)
			if (one.point[i].at[2] > 1 - 2.0 / 30) {
				*hard_cloud_push(&cloud) = one.point[i];
				dense--;
			}
		hard_cloud_clear(&one);
	}
	snprintf(what, sizeof what, "sphere of %zu points, a patch %zu times as dense", points,
			 density);
	const measured_sphere s = { .count = points, .scale = 1, .row = "uneven", .bar = 1.5 };
	measure_sphere(c, &cloud, s, what);
}

static void measure_stray(torture_case *c, int variant)
{
	static const double distance[] = { 1e3, 1e5, 1e6, 1e7, 1e8, 1e10, 1e15, 1e30 };
	hard_cloud cloud = { 0 };
	char what[100];
	hard_cloud_add(c, &cloud, SPHERE, 3000);
	hard_cloud_push(&cloud)->at[0] = distance[variant];
	snprintf(what, sizeof what, "sphere of 3000 points and one at %g m", distance[variant]);
	const measured_sphere s = { .count = 3000, .scale = 1, .row = "stray", .bar = 1 };
	measure_sphere(c, &cloud, s, what);
}

/* ------------------------------------------------------------------------------------- leaks */

/* Share of the points [first, end) that have more than a hundredth of what falls in, in percent. */
static double lit_share(const lit_file *lit, size_t first, size_t end, double full)
{
	size_t n = 0;
	for (size_t i = first; i < end; i++)
		n += lit->radiance[3 * i + 1] > 0.01 * full;
	return 100 * (double)n / (double)(end - first);
}

static const char *outside_lamp(torture_case *c, int kind)
{
	static char lamp[200];
	double z = case_between(c, -1, 1), angle = 2 * PI * case_random(c), r = sqrt(1 - z * z);
	double x = r * cos(angle), y = r * sin(angle);
	if (kind == 0)
		snprintf(lamp, sizeof lamp, "sun toward %.9g,%.9g,%.9g irradiance %.9g", x, y, z, PI);
	else if (kind == 1)
		snprintf(lamp, sizeof lamp, "point at %.9g,%.9g,%.9g intensity %.9g", 5 * x, 5 * y, 5 * z,
				 25 * PI);
	else
		snprintf(lamp, sizeof lamp, "sky radiance 1");
	return lamp;
}

/* Closed surfaces, normals inward, lit from outside by what gives a radiance of 0.5: sun, point
 * and sky, 3000 and 30000 points, noise of 0, a quarter and a half of their spacing. */
static void measure_closed(torture_case *c, int variant)
{
	static const char *const lamp_name[] = { "sun", "point", "sky" };
	static const size_t count[] = { 3000, 30000 };
	int kind = variant % 3, noise = variant / 3 % 3;
	hard_shape shape = variant / 9 % 2 ? ROOM : SPHERE;
	size_t points = count[variant / 18];
	double area = shape == ROOM ? 24 : 4 * PI, spacing = sqrt(area / (double)points);
	hard_cloud cloud = { 0 };
	lit_file lit;
	lit_report report;
	char row[100];
	hard_cloud_add(c, &cloud, shape, points);
	if (case_one_in(c, 2))
		hard_cloud_turn(c, &cloud);
	hard_cloud_shake(c, &cloud, 0.25 * noise * spacing);
	hard_cloud_write(c, &cloud, "in.ply");
	hard_cloud_clear(&cloud);
	snprintf(row, sizeof row, "closed/%s %s noise %g", hard_shape_name(shape), lamp_name[kind],
			 0.25 * noise);
	if (!bake(c, row, outside_lamp(c, kind), "", &lit, &report))
		return;
	double brightest = 0;
	for (size_t i = 0; i < lit.count; i++)
		brightest = fmax(brightest, lit.radiance[3 * i + 1]);
	case_measure(c, row, lit_share(&lit, 0, lit.count, 0.5), 0,
				 "%s of %zu points under a %s, noise %g: percent of points lit, brightest %.2g",
				 hard_shape_name(shape), points, lamp_name[kind], 0.25 * noise, brightest / 0.5);
	lit_file_clear(&lit);
}

/* The same at depths given by hand. */
static void measure_closed_depth(torture_case *c, int variant)
{
	hard_shape shape = variant % 2 ? ROOM : SPHERE;
	hard_cloud cloud = { 0 };
	lit_file lit;
	lit_report report;
	char options[100], row[60];
	hard_cloud_add(c, &cloud, shape, 3000);
	hard_cloud_turn(c, &cloud);
	hard_cloud_write(c, &cloud, "in.ply");
	hard_cloud_clear(&cloud);
	snprintf(options, sizeof options, "--depth %d", 4 + variant / 2);
	snprintf(row, sizeof row, "closed depth/%s", hard_shape_name(shape));
	if (!bake(c, row, outside_lamp(c, 0), options, &lit, &report))
		return;
	case_measure(c, row, lit_share(&lit, 0, lit.count, 0.5), 0,
				 "%s of 3000 points under a sun, %s: percent of points lit", hard_shape_name(shape),
				 options);
	lit_file_clear(&lit);
}

/* A box in a box: outside normals outward, inside inward, the wall a number of spacings thick. */
static void measure_wall(torture_case *c, int variant)
{
	static const double thickness[] = { 0.25, 0.5, 1, 1.5, 2, 4 };
	double walls = thickness[variant % 6];
	int turn = variant / 6 % 3, lamp = variant / 18 ? 2 : 0;
	size_t inner = 6000;
	double spacing = sqrt(24.0 / (double)inner), outer = 1 + walls * spacing;
	hard_cloud cloud = { 0 }, outside = { 0 };
	lit_file lit;
	lit_report report;
	hard_cloud_add(c, &cloud, ROOM, inner);
	hard_cloud_add(c, &outside, ROOM, (size_t)((double)inner * outer * outer));
	for (size_t i = 0; i < outside.count; i++) {
		hard_point *p = hard_cloud_push(&cloud);
		*p = outside.point[i];
		for (int a = 0; a < 3; a++) {
			p->at[a] *= outer;
			p->normal[a] = -p->normal[a];
		}
	}
	hard_cloud_clear(&outside);
	for (int t = 0; t < turn; t++)
		hard_cloud_turn(c, &cloud);
	hard_cloud_write(c, &cloud, "in.ply");
	hard_cloud_clear(&cloud);
	if (!bake(c, "wall", outside_lamp(c, lamp), "", &lit, &report))
		return;
	double mean = lit_file_mean(&lit, 0, inner) / 0.5;
	case_measure(c, lamp ? "wall/sky" : "wall/sun", lit_share(&lit, 0, inner, 0.5), 0,
				 "walls of %g spacings%s: percent of points lit inside; mean light %.2g", walls,
				 turn ? ", turned" : "", mean);
	lit_file_clear(&lit);
}

/* ------------------------------------------------------------------------------------- bodies */

/* What is convex lights nothing of itself. */
static void measure_convex(torture_case *c, int variant)
{
	hard_cloud cloud = { 0 };
	lit_file lit;
	lit_report report;
	hard_cloud_add(c, &cloud, variant % 2 ? PLANE : BALL, variant / 2 ? 3000 : 600);
	hard_cloud_turn(c, &cloud);
	hard_cloud_write(c, &cloud, "in.ply");
	hard_cloud_clear(&cloud);
	if (!bake(c, "convex", "sky radiance 1", "", &lit, &report))
		return;
	double above = 0;
	if (variant % 2 == 0) /* a plane's far side sees the sky too */
		above = off(&lit, 0, lit.count, 0.5);
	for (size_t i = 0; i < lit.count && variant % 2; i++)
		above = fmax(above, 100 * (lit.radiance[3 * i + 1] / 0.5 - 1));
	case_measure(c, "convex", above, 1, "%s of %zu points under a sky: percent off",
				 variant % 2 ? "plane" : "ball", lit.count);
	lit_file_clear(&lit);
}

/* ------------------------------------------------------------------------------- white rooms */

/* Of a lamp's flux 4 pi I walls of 24 m2 keep 1 - rho: L = rho I / (6 (1 - rho)) on the mean. */
static void measure_white(torture_case *c, int variant)
{
	static const double albedo[] = { 0.95, 0.98 }, bar[] = { 0.5, 1 };
	static const size_t count[] = { 2000, 3000, 5000, 10000 };
	double rho = albedo[variant % 2];
	size_t points = count[variant / 2 % 4];
	hard_cloud cloud = { 0 };
	lit_file lit;
	lit_report report;
	char row[60];
	hard_cloud_add(c, &cloud, ROOM, points);
	if (variant / 8)
		hard_cloud_turn(c, &cloud);
	hard_cloud_albedo(&cloud, rho);
	hard_cloud_write(c, &cloud, "in.ply");
	hard_cloud_clear(&cloud);
	snprintf(row, sizeof row, "white/%g", rho);
	if (!bake(c, row, "point at 0.3,0.2,-0.25 intensity 6", "", &lit, &report))
		return;
	rho = (double)(float)rho;
	case_measure(c, row, off(&lit, 0, lit.count, rho / (1 - rho)), bar[variant % 2],
				 "room of %zu points%s, albedo %g (stated %.2g %%)", points,
				 variant / 8 ? ", turned" : "", rho, 100 * report.error);
	lit_file_clear(&lit);
}

/* ------------------------------------------------------------------------------------ the part */

static const light_row rows[] = {
	{ "bounces", measure_bounces, 4, 2 },
	{ "furnace", measure_furnace, 24, 8 },
	{ "slab", measure_slab, 12, 0 },
	{ "depth", measure_depth, 18, 8 },
	{ "density", measure_density, 6, 2 },
	{ "scale", measure_scale, 7, 3 },
	{ "shift", measure_shift, 4, 2 },
	{ "uneven", measure_uneven, 12, 5 },
	{ "stray", measure_stray, 8, 2 },
	{ "closed", measure_closed, 36, 18 },
	{ "closed depth", measure_closed_depth, 16, 8 },
	{ "wall", measure_wall, 36, 0 },
	{ "convex", measure_convex, 4, 2 },
	{ "white", measure_white, 16, 4 },
};
#define ROW_COUNT ((int)(sizeof rows / sizeof *rows))

/* The numbered row and variant; false when there are fewer. */
static bool find(long number, bool slice, const light_row **row, int *variant)
{
	for (int r = 0; r < ROW_COUNT; r++) {
		for (int v = 0; v < rows[r].variants; v++) {
			bool wanted = !slice || (rows[r].in_slice > 0 && v % rows[r].in_slice == 0);
			if (!wanted || number-- > 0)
				continue;
			*row = &rows[r];
			*variant = v;
			return true;
		}
	}
	return false;
}

static void run(torture_case *c)
{
	const light_row *row;
	int variant;
	if (find(c->number, c->slice, &row, &variant) && case_trial(c))
		row->measure(c, variant);
}

static long count(bool slice)
{
	const light_row *row;
	int variant;
	long n = 0;
	while (find(n, slice, &row, &variant))
		n++;
	return n;
}

const torture_part light_part = { "light",
								  "light against closed forms; depth, density, scale, leaks", count,
								  run };
