/*
 * make_cave.c - a cave as a laser scanner sees it.
 *
 * The cave is the zero set of a distance field, negative in the air: chambers (ellipsoids) and
 * passages (capsules) under a smooth union, roughened by four octaves of noise, with a floor of
 * sediment and with stalagmites, stalactites, columns and crystals. Nine scanners stand in it.
 * Each sends a jittered raster of rays of equal solid angle; where a ray meets rock there is a
 * point. So points lie only where a scanner sees, and their density falls with the square of the
 * distance and with the angle of incidence, as in a real scan. The same options give the same
 * bytes.
 *
 * With --grid the rays of a scanner go in equal steps of azimuth and elevation about its own axis,
 * which is a little off the vertical, as tripods are; that is what PTX and E57 files hold. With
 * --closed there are points on all of the rock, whether a scanner sees it or not.
 */
#include "sample_points.h"
#include "sample_scans.h"

#include <getopt.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define TURN 6.283185307179586

/* ------------------------------------------------------------------------------- the layout */

typedef struct vector {
	double x, y, z;
} vector;

typedef struct chamber {
	vector centre, radius;
	int formations; /* how many places to try */
} chamber;

static const chamber chambers[] = {
	{ { 4.0, 0.0, 2.2 }, { 4.2, 3.6, 2.5 }, 36 },   /* entrance */
	{ { 17.0, 3.0, 3.0 }, { 6.2, 5.2, 4.0 }, 110 }, /* hall */
	{ { 16.0, 11.0, 1.9 }, { 3.2, 3.0, 2.2 }, 30 }, /* crystal alcove */
	{ { 31.0, -4.0, 1.0 }, { 5.2, 4.6, 3.0 }, 60 }, /* lava chamber */
	{ { 37.6, -0.6, 0.9 }, { 2.8, 3.0, 2.1 }, 24 }, /* end */
};

typedef struct passage {
	vector from, to;
	double radius;
} passage;

static const passage passages[] = {
	{ { 7.0, 0.3, 1.6 }, { 12.0, 2.0, 1.5 }, 1.4 },
	{ { 16.3, 7.0, 1.4 }, { 16.0, 9.5, 1.5 }, 1.3 },
	{ { 22.0, 2.2, 1.2 }, { 27.5, -2.2, 0.9 }, 1.4 },
	{ { 34.0, -3.0, 0.7 }, { 36.6, -1.3, 0.8 }, 1.4 },
};

#define COUNT(array) ((int)(sizeof(array) / sizeof(array)[0]))

/*
 * The visitors' path, where the scanners stand. Formations keep away from it, so that these
 * places are in the air for every seed; lamps of scenes may stand there too. The rays of a
 * scanner are in proportion to its share.
 */
typedef struct station {
	const char *name;
	vector at;
	double share;
} station;

static const station stations[] = {
	{ "entrance", { 3.4, 0.0, 1.9 }, 1.0 },    { "first-passage", { 9.5, 1.2, 1.6 }, 0.6 },
	{ "hall-west", { 13.5, 2.6, 1.8 }, 1.8 },  { "hall-east", { 20.0, 2.8, 1.5 }, 0.25 },
	{ "alcove", { 16.0, 10.6, 1.4 }, 0.9 },    { "second-passage", { 24.8, 0.0, 1.1 }, 0.3 },
	{ "lava-west", { 28.6, -3.4, 1.0 }, 1.3 }, { "lava-east", { 33.4, -3.2, 0.9 }, 0.25 },
	{ "end", { 37.4, -0.8, 0.9 }, 0.8 },
};

/* The path in the order it is walked, as indices into stations, with the spur to the alcove. */
static const int path[] = { 0, 1, 2, 4, 3, 5, 6, 7, 8 };

#define PATH_CLEARANCE 0.7 /* metres of air between path and formations */
#define AIR_CLEARANCE 0.25 /* metres of air that every station must have */

/* The large emissive patch: an ellipse on the floor. */
static const vector lava_centre = { 31.0, -6.0, 0 };
static const double lava_radius[2] = { 1.9, 1.2 };
static const float lava_emission[3] = { 7.0f, 1.6f, 0.25f };

/* The small one: a cluster of crystals. */
static const vector crystal_centre = { 17.3, 11.8, 0 };
static const float crystal_emission[3] = { 1.5f, 5.0f, 6.5f };

/* ---------------------------------------------------------------------------------- vectors */

static vector add_scaled(vector a, vector b, double s)
{
	return (vector){ a.x + b.x * s, a.y + b.y * s, a.z + b.z * s };
}

static double dot(vector a, vector b)
{
	return a.x * b.x + a.y * b.y + a.z * b.z;
}

static vector subtract(vector a, vector b)
{
	return add_scaled(a, b, -1);
}

/* As fmin and fmax, but inline: there are no NaN here. */
static double minimum(double a, double b)
{
	return a < b ? a : b;
}

static double maximum(double a, double b)
{
	return a > b ? a : b;
}

static double clamp(double v, double lo, double hi)
{
	return v < lo ? lo : v > hi ? hi : v;
}

static double smoothstep(double lo, double hi, double v)
{
	double t = clamp((v - lo) / (hi - lo), 0, 1);

	return t * t * (3 - 2 * t);
}

/* The lower of a and b with a fillet of width k; lower than both by at most k / 4. */
static double smooth_minimum(double a, double b, double k)
{
	double h = k - fabs(a - b);

	return minimum(a, b) - (h > 0 ? h * h / (4 * k) : 0);
}

static double smooth_maximum(double a, double b, double k)
{
	return -smooth_minimum(-a, -b, k);
}

/* -------------------------------------------------------------------------------------- noise */

static float noise_value[256];
static uint8_t noise_order[256];

static void seed_noise(uint64_t *random)
{
	for (int i = 0; i < 256; i++) {
		noise_value[i] = (float)(2 * sample_random(random) - 1);
		noise_order[i] = (uint8_t)i;
	}
	for (int i = 255; i > 0; i--) {
		int j = (int)(sample_random(random) * (i + 1));
		uint8_t t = noise_order[i];
		noise_order[i] = noise_order[j];
		noise_order[j] = t;
	}
}

/* floor as an int, without the call. */
static int whole(double v)
{
	int i = (int)v;

	return i - (v < i);
}

/* Value noise in [-1, 1], with continuous second derivatives. */
static double noise(vector p)
{
	int ix = whole(p.x), iy = whole(p.y), iz = whole(p.z);
	double x = p.x - ix, y = p.y - iy, z = p.z - iz;
	double corner[4];

	x = x * x * x * (x * (x * 6 - 15) + 10);
	y = y * y * y * (y * (y * 6 - 15) + 10);
	z = z * z * z * (z * (z * 6 - 15) + 10);
	for (int i = 0; i < 4; i++) {
		int layer = noise_order[(iz + (i >> 1)) & 255];
		int row = noise_order[(layer + iy + (i & 1)) & 255];
		double a = noise_value[(row + ix) & 255];
		double b = noise_value[(row + ix + 1) & 255];
		corner[i] = a + x * (b - a);
	}
	double low = corner[0] + y * (corner[1] - corner[0]);
	double high = corner[2] + y * (corner[3] - corner[2]);
	return low + z * (high - low);
}

static double noise_at(vector p, double wavelength, double offset)
{
	double s = 1 / wavelength;

	return noise((vector){ p.x * s + offset, p.y * s + offset * 0.7, p.z * s - offset });
}

#define ROUGHNESS 0.42 /* the largest sum of the four octaves below */

/* Displacement of the walls; *fine receives the part of it that formations show too. */
static double roughness(vector p, double *fine)
{
	*fine = 0.05 * noise_at(p, 0.45, 37.1) + 0.02 * noise_at(p, 0.18, 53.9);
	return 0.23 * noise_at(p, 2.6, 11.3) + 0.12 * noise_at(p, 1.1, 23.7) + *fine;
}

/* --------------------------------------------------------------------------------- formations */

/* A body of revolution about a vertical axis: radius low at the foot, high at the top, less by
 * `waist` half way up. */
typedef struct formation {
	double x, y, z_low, z_high;
	double low, high, waist;
	bool crystal;
} formation;

#define FORMATION_MAXIMUM 400
#define CELL 0.5       /* metres, side of a cell of the map of formations */
#define CELL_REACH 0.7 /* a cell lists all formations that are nearer than this */
#define CELL_LIST 16
#define MAP_X 92
#define MAP_Y 52

static const double map_origin[2] = { -2, -10 };
static formation formations[FORMATION_MAXIMUM];
static int formation_count;
static struct {
	int count, index[CELL_LIST];
} map[MAP_Y][MAP_X];

static double widest(const formation *f)
{
	return maximum(f->low, f->high);
}

static double formation_distance(const formation *f, vector p)
{
	double t = clamp((p.z - f->z_low) / (f->z_high - f->z_low), 0, 1);
	double radius = f->low + (f->high - f->low) * t - f->waist * 4 * t * (1 - t);
	double dx = p.x - f->x, dy = p.y - f->y, across = sqrt(dx * dx + dy * dy);

	double side = across - radius;

	/* Rings, where they can be seen; a bound elsewhere. */
	if (side < 0.25)
		side -= radius * 0.07 * sin(9 * p.z + 5 * f->x);
	else
		side -= radius * 0.07;
	return maximum(0.9 * side, maximum(f->z_low - p.z, p.z - f->z_high));
}

/* Whether cell (column, row) has to list a formation. */
static bool is_near_cell(const formation *f, int column, int row)
{
	double x = fabs(f->x - (map_origin[0] + (column + 0.5) * CELL));
	double y = fabs(f->y - (map_origin[1] + (row + 0.5) * CELL));

	return maximum(x, y) < CELL / 2 + CELL_REACH + widest(f) * 1.1;
}

/* Adds a formation to the list and the map, unless one of them is full there. */
static bool add_formation(const formation *f)
{
	for (int row = 0; row < MAP_Y; row++) {
		for (int column = 0; column < MAP_X; column++) {
			if (is_near_cell(f, column, row) && map[row][column].count == CELL_LIST)
				return false;
		}
	}
	if (formation_count == FORMATION_MAXIMUM)
		return false;
	for (int row = 0; row < MAP_Y; row++) {
		for (int column = 0; column < MAP_X; column++) {
			if (is_near_cell(f, column, row))
				map[row][column].index[map[row][column].count++] = formation_count;
		}
	}
	formations[formation_count++] = *f;
	return true;
}

/* Distance to the nearest formation, at most CELL_REACH; *nearest receives it or NULL. */
static double formations_distance(vector p, const formation **nearest)
{
	int column = whole((p.x - map_origin[0]) / CELL);
	int row = whole((p.y - map_origin[1]) / CELL);
	double distance = CELL_REACH;

	*nearest = NULL;
	if (column < 0 || row < 0 || column >= MAP_X || row >= MAP_Y)
		return distance;
	for (int i = 0; i < map[row][column].count; i++) {
		const formation *f = &formations[map[row][column].index[i]];
		double d = formation_distance(f, p);
		if (d < distance) {
			distance = d;
			*nearest = f;
		}
	}
	return distance;
}

/* -------------------------------------------------------------------------- the distance field */

static double chamber_distance(const chamber *c, vector p)
{
	vector q = subtract(p, c->centre);
	double least = minimum(c->radius.x, minimum(c->radius.y, c->radius.z));

	q = (vector){ q.x / c->radius.x, q.y / c->radius.y, q.z / c->radius.z };
	return (sqrt(dot(q, q)) - 1) * least; /* never more than the true distance */
}

static double segment_distance(vector p, vector from, vector to)
{
	vector axis = subtract(to, from);
	double t = clamp(dot(subtract(p, from), axis) / dot(axis, axis), 0, 1);
	vector q = subtract(p, add_scaled(from, axis, t));

	return sqrt(dot(q, q));
}

/* Chambers and passages without roughness. */
static double hollow_distance(vector p)
{
	double d = 1e9;

	/* What is further away than the width of the union has no part in the air here. */
	for (int i = 0; i < COUNT(chambers); i++) {
		if (fabs(p.x - chambers[i].centre.x) < 1.6 * chambers[i].radius.x)
			d = smooth_minimum(d, chamber_distance(&chambers[i], p), 1.0);
	}
	for (int i = 0; i < COUNT(passages); i++) {
		const passage *tube = &passages[i];
		double middle = 0.5 * (tube->from.x + tube->to.x);
		double half = 0.5 * fabs(tube->to.x - tube->from.x) + tube->radius;
		if (fabs(p.x - middle) < half + 1.1)
			d = smooth_minimum(d, segment_distance(p, tube->from, tube->to) - tube->radius, 1.0);
	}
	return d;
}

static double floor_height(vector p)
{
	return 0.25 - 0.028 * p.x;
}

#define FLOOR_FILLET 0.4
#define FORMATION_FILLET 0.12

/* The cave without formations; *fine receives the fine part of the roughness. Where no rock is
 * near, a bound that is nearer to 0 than the truth, without the cost of the noise. */
static double bare_distance(vector p, double *fine)
{
	double hollow = hollow_distance(p);
	double ground = floor_height(p) - p.z;
	double bound = maximum(hollow, ground) + ROUGHNESS + FLOOR_FILLET / 4;

	*fine = 0;
	if (bound < -0.5)
		return bound;
	double rough = roughness(p, fine);
	return smooth_maximum(hollow + rough, ground + 0.3 * rough, FLOOR_FILLET);
}

/* The cave: negative in the air. Not a true distance, but its slope is below 1 / STEP. */
static double cave_distance(vector p)
{
	const formation *nearest;
	double fine;
	double bare = bare_distance(p, &fine);
	double solid = formations_distance(p, &nearest);

	return smooth_maximum(bare, 0.4 * fine - solid, FORMATION_FILLET);
}

/* Unit vector from the rock into the air: down the field, from four samples on a tetrahedron. */
static vector air_normal(vector p)
{
	static const vector corner[4] = { { 1, -1, -1 }, { -1, -1, 1 }, { -1, 1, -1 }, { 1, 1, 1 } };
	vector sum = { 0, 0, 0 };

	for (int i = 0; i < 4; i++)
		sum = add_scaled(sum, corner[i], -cave_distance(add_scaled(p, corner[i], 0.004)));
	return add_scaled((vector){ 0, 0, 0 }, sum, 1 / sqrt(dot(sum, sum)));
}

/* -------------------------------------------------------------------------- growing formations */

static double path_distance(double x, double y)
{
	double nearest = 1e9;

	for (int i = 0; i + 1 < COUNT(path); i++) {
		vector from = stations[path[i]].at, to = stations[path[i + 1]].at;
		from.z = to.z = 0;
		nearest = minimum(nearest, segment_distance((vector){ x, y, 0 }, from, to));
	}
	return nearest;
}

static double lava_distance(vector p)
{
	return hypot((p.x - lava_centre.x) / lava_radius[0], (p.y - lava_centre.y) / lava_radius[1]);
}

/* Height of floor (step < 0) or ceiling (step > 0) over or under p, which is in the air. */
static double find_rock(vector p, double step)
{
	double fine;

	for (int i = 0; i < 2000 && bare_distance(p, &fine) < 0; i++)
		p.z += step;
	return p.z;
}

/* Grows one stalagmite, stalactite or column at a random place of a chamber, if there is room. */
static void grow_formation(const chamber *c, uint64_t *random)
{
	double radius = sqrt(sample_random(random)), angle = TURN * sample_random(random);
	double kind = sample_random(random), size = sample_random(random);
	vector p = { c->centre.x + 0.92 * radius * cos(angle) * c->radius.x,
				 c->centre.y + 0.92 * radius * sin(angle) * c->radius.y, c->centre.z };
	double fine;
	formation f = { .x = p.x, .y = p.y };

	if (bare_distance(p, &fine) > -0.4)
		return;
	double ground = find_rock(p, -0.01), ceiling = find_rock(p, 0.01), gap = ceiling - ground;
	if (gap < 0.9)
		return;
	if (kind < 0.13) { /* column */
		f.low = f.high = 0.25 + 0.3 * size;
		f.waist = 0.55 * f.low;
		f.z_low = ground - 0.3;
		f.z_high = ceiling + 0.3;
	} else {
		double height = gap * (0.12 + 0.42 * size * size);
		double foot = 0.06 + 0.16 * height * (0.6 + 0.8 * sample_random(random));
		bool hangs = kind > 0.5;
		f.low = hangs ? 0.02 : foot;
		f.high = hangs ? foot * 0.7 : 0.03;
		f.z_low = hangs ? ceiling - height : ground - 0.3;
		f.z_high = hangs ? ceiling + 0.3 : ground + height;
	}
	bool in_lava = lava_distance(p) < 1.2 + widest(&f);
	if (path_distance(p.x, p.y) > widest(&f) + PATH_CLEARANCE && !in_lava)
		add_formation(&f);
}

/* The cluster of crystals in the alcove. */
static void grow_crystals(uint64_t *random)
{
	for (int i = 0; i < 6; i++) {
		double angle = TURN * i / 6, away = i ? 0.22 + 0.08 * sample_random(random) : 0;
		double height = i ? 0.35 + 0.3 * sample_random(random) : 0.95;
		vector p = crystal_centre;
		p.x += away * cos(angle);
		p.y += away * sin(angle);
		p.z = 1.0;
		double ground = find_rock(p, -0.01);
		add_formation(&(formation){ .x = p.x,
									.y = p.y,
									.z_low = ground - 0.2,
									.z_high = ground + height,
									.low = i ? 0.12 : 0.18,
									.high = 0.03,
									.crystal = true });
	}
}

static void grow_cave(uint64_t *random)
{
	seed_noise(random);
	grow_crystals(random);
	for (int i = 0; i < COUNT(chambers); i++) {
		for (int k = 0; k < chambers[i].formations; k++)
			grow_formation(&chambers[i], random);
	}
}

/* ----------------------------------------------------------------------------------- scanning */

#define STEP 0.6     /* share of the distance field that a ray advances */
#define RANGE 18.0   /* metres, the furthest return */
#define GRAZING 0.05 /* cosine of incidence below which a scanner gets no return */
#define NEAR 0.6     /* metres; nearer than this density no longer rises */

/* Follows a ray from the air to the rock; false when it meets none within RANGE. */
static bool meet_rock(vector origin, vector direction, double *range)
{
	double before = 0, at = 0, value = -1, value_before = -1;

	while (at < RANGE) {
		value = cave_distance(add_scaled(origin, direction, at));
		if (value >= 0)
			break;
		before = at;
		value_before = value;
		at += maximum(0.003, -value * STEP);
	}
	if (value < 0 || at == 0)
		return false;
	/* Halve by the secant, kept between the ends, to a tenth of a millimetre. */
	for (int i = 0; i < 12 && at - before > 1e-4; i++) {
		double share = clamp(value_before / (value_before - value), 0.1, 0.9);
		double middle = before + (at - before) * share;
		double v = cave_distance(add_scaled(origin, direction, middle));
		if (v < 0) {
			before = middle;
			value_before = v;
		} else {
			at = middle;
			value = v;
		}
	}
	*range = 0.5 * (before + at);
	return true;
}

static double luminance(const float c[3])
{
	return 0.2126 * (double)c[0] + 0.7152 * (double)c[1] + 0.0722 * (double)c[2];
}

/* Brown rock, paler formations, reddish sediment on the floor, dark where it is wet. */
static void paint_albedo(vector p, vector n, bool on_formation, float albedo[3])
{
	/* Luminance stays within 0.1 to 0.35 after it is rounded to 8 bits. */
	static const float rock[3] = { 0.27f, 0.21f, 0.155f };
	static const float calcite[3] = { 0.36f, 0.31f, 0.24f };
	static const float clay[3] = { 0.26f, 0.175f, 0.11f };
	double ground = n.z > 0 ? smoothstep(0.5, 0.1, p.z - floor_height(p)) * n.z : 0;
	double pale = on_formation ? 0.8 : 0;
	double strata = 1 + 0.22 * noise_at(p, 0.9, 71.3) + 0.12 * noise_at(p, 0.12, 5.5);
	double bend = 0.5 * noise_at(p, 0.7, 17.9);
	vector streak = { p.x + bend, p.y - bend, p.z * 0.25 + bend }; /* water runs down */
	double damp = noise_at(streak, 1.1, 91.7) + 0.35 * noise_at(p, 0.3, 43.3);
	double wet = smoothstep(0.1, 0.5, damp);

	for (int i = 0; i < 3; i++) {
		double c = (double)rock[i] + pale * (double)(calcite[i] - rock[i]);
		c += ground * ((double)clay[i] - c);
		albedo[i] = (float)(c * strata * (1 - 0.55 * wet));
	}
	double y = luminance(albedo), scale = clamp(y, 0.102, 0.347) / y;
	for (int i = 0; i < 3; i++)
		albedo[i] = (float)((double)albedo[i] * scale);
}

static void store(float to[3], vector v)
{
	to[0] = (float)v.x;
	to[1] = (float)v.y;
	to[2] = (float)v.z;
}

/* What a scanner records at p: colour of the rock and its own light. */
static void paint(vector p, vector n, sample_point *point)
{
	const formation *nearest;
	bool on_formation = formations_distance(p, &nearest) < 0.05 && nearest != NULL;
	double edge = 1 + 0.15 * noise_at(p, 0.5, 61.1);

	store(point->position, p);
	store(point->normal, n);
	paint_albedo(p, n, on_formation, point->albedo);
	if (on_formation && nearest->crystal) {
		memcpy(point->emission, crystal_emission, sizeof point->emission);
	} else if (lava_distance(p) < edge && n.z > 0.4 && p.z < floor_height(p) + 0.5) {
		memcpy(point->emission, lava_emission, sizeof point->emission);
	}
}

/*
 * Sends `rays` rays from a station over all directions but the cone below the tripod, in rows of
 * equal solid angle. Adds a point for each return; returns how many there were.
 *   list   NULL only counts
 *   noise  metres, standard deviation of the range
 */
static size_t scan_station(vector from, size_t rays, double noise_metres, uint64_t *random,
						   sample_list *list)
{
	double low = -0.95; /* sine of the lowest elevation */
	size_t rows = (size_t)ceil(sqrt((double)rays * (1 - low) / TURN));
	size_t columns = (rays + rows - 1) / rows, returns = 0;

	for (size_t i = 0; i < rows * columns; i++) {
		double u = ((double)(i / columns) + sample_random(random)) / (double)rows;
		double v = ((double)(i % columns) + sample_random(random)) / (double)columns;
		double chance = sample_random(random);
		double z = low + (1 - low) * u, across = sqrt(maximum(0, 1 - z * z)), range;
		vector direction = { across * cos(TURN * v), across * sin(TURN * v), z };
		if (!meet_rock(from, direction, &range))
			continue;
		vector p = add_scaled(from, direction, range);
		vector n = air_normal(p);
		double cosine = -dot(n, direction);
		/* Scans are thinned where they are densest, close to the scanner. */
		if (cosine < GRAZING || chance * NEAR * NEAR * cosine > range * range)
			continue;
		returns++;
		if (!list)
			continue;
		sample_point point = { 0 };
		paint(p, n, &point);
		if (noise_metres > 0) {
			double error = noise_metres * sample_gaussian(random);
			store(point.position, add_scaled(p, direction, error));
		}
		sample_add(list, &point);
	}
	return returns;
}

/* Scans from every station until there are exactly `count` points. */
static void scan_cave(size_t count, double noise_metres, uint64_t seed, sample_list *list)
{
	uint64_t random = seed ^ 0x5ca11ed;
	double shares = 0, returns = 0;

	for (int i = 0; i < COUNT(stations); i++) {
		size_t found = scan_station(stations[i].at, 2000, 0, &random, NULL);
		shares += stations[i].share;
		returns += stations[i].share * (double)found / 2000;
	}
	double rate = returns / shares; /* returns per ray */
	while (list->count < count) {
		double rays = 1.01 * (double)(count - list->count) / rate + 100;
		for (int i = 0; i < COUNT(stations); i++) {
			size_t share = (size_t)(rays * stations[i].share / shares) + 1;
			scan_station(stations[i].at, share, noise_metres, &random, list);
		}
	}
	sample_thin(list, count, &random);
}

/* A place in the air of the cave. */
static vector find_air(uint64_t *random)
{
	vector p;

	do {
		p.x = -1 + 42 * sample_random(random);
		p.y = -10 + 25 * sample_random(random);
		p.z = -3 + 11 * sample_random(random);
	} while (cave_distance(p) >= -0.01);
	return p;
}

/*
 * Points on all of the rock, as if scanners had stood everywhere: rays from random places in the
 * air into random directions meet every piece of surface, the more of them the deeper the air
 * before it, so that the cave is closed.
 */
static void scan_everywhere(size_t count, double noise_metres, uint64_t seed, sample_list *list)
{
	uint64_t random = seed ^ 0x5ca11ed;
	double range;

	while (list->count < count) {
		vector from = find_air(&random);
		double z = 2 * sample_random(&random) - 1, across = sqrt(maximum(0, 1 - z * z));
		double turn = TURN * sample_random(&random);
		vector direction = { across * cos(turn), across * sin(turn), z };
		if (!meet_rock(from, direction, &range))
			continue;
		vector p = add_scaled(from, direction, range);
		sample_point point = { 0 };
		paint(p, air_normal(p), &point);
		if (noise_metres > 0)
			store(point.position,
				  add_scaled(p, direction, noise_metres * sample_gaussian(&random)));
		sample_add(list, &point);
	}
}

/* ----------------------------------------------------------------------------- scans as grids */

#define LOWEST_ELEVATION (-65.0 / 360 * TURN) /* the tripod hides what is below */
#define HIGHEST_ELEVATION (TURN / 4)
#define FAINTEST 1e-3 /* albedo times cosine of incidence over metres squared; no echo below */

static vector turn_by(const double r[9], vector v)
{
	return (vector){ r[0] * v.x + r[1] * v.y + r[2] * v.z, r[3] * v.x + r[4] * v.y + r[5] * v.z,
					 r[6] * v.x + r[7] * v.y + r[8] * v.z };
}

/* A heading of its own for each station, and an axis up to 2.5 degrees off the vertical. */
static void pose_station(int index, sample_scan *s)
{
	double heading = 0.7 * index - 2.6, tilt = 0.044 * sin(2.0 * index + 1);
	double c = cos(heading), n = sin(heading), u = cos(tilt), v = sin(tilt);
	const double rows[9] = { c, -n * u, n * v, n, c * u, -c * v, 0, v, u };
	const vector *at = &stations[index].at;

	s->name = stations[index].name;
	memcpy(s->rotation, rows, sizeof rows);
	s->translation[0] = at->x;
	s->translation[1] = at->y;
	s->translation[2] = at->z;
}

/* Follows the ray of a cell. Rock that is dark, far or met at a grazing angle gives no echo. The
 * point in the world goes to the list. */
static void scan_cell(const sample_scan *s, vector own, double noise_metres, uint64_t *random,
					  sample_cell *cell, sample_list *list)
{
	vector from = { s->translation[0], s->translation[1], s->translation[2] };
	vector direction = turn_by(s->rotation, own);
	sample_point point = { 0 };
	double range;

	cell->hole = true;
	if (!meet_rock(from, direction, &range))
		return;
	vector p = add_scaled(from, direction, range), n = air_normal(p);
	double cosine = -dot(n, direction);
	paint(p, n, &point);
	if (luminance(point.albedo) * cosine < FAINTEST * range * range)
		return;
	range += noise_metres > 0 ? noise_metres * sample_gaussian(random) : 0;
	store(point.position, add_scaled(from, direction, range));
	sample_add(list, &point);
	cell->hole = false;
	cell->position[0] = own.x * range;
	cell->position[1] = own.y * range;
	cell->position[2] = own.z * range;
	cell->intensity = (float)clamp(2 * luminance(point.albedo) * cosine, 0, 1);
	for (int k = 0; k < 3; k++)
		cell->color[k] = sample_srgb(point.albedo[k]);
}

/* Scans the whole grid of a station. */
static void scan_grid(sample_scan *s, double noise_metres, uint64_t *random, sample_list *list)
{
	size_t count = s->columns * s->rows;

	s->cell = calloc(count, sizeof *s->cell);
	if (!s->cell) {
		fprintf(stderr, "no memory for %zu cells; ask for fewer points\n", count);
		exit(SAMPLE_EXIT_MEMORY);
	}
	for (size_t i = 0; i < count; i++) {
		double azimuth = TURN * (double)(i / s->rows) / (double)s->columns;
		double share = ((double)(i % s->rows) + 0.5) / (double)s->rows;
		double elevation = LOWEST_ELEVATION + (HIGHEST_ELEVATION - LOWEST_ELEVATION) * share;
		double across = cos(elevation);
		vector own = { across * cos(azimuth), across * sin(azimuth), sin(elevation) };
		scan_cell(s, own, noise_metres, random, &s->cell[i], list);
	}
}

/* Scans grids from every station, of about `count` points together: most rays meet rock. */
static void scan_grids(size_t count, double noise_metres, uint64_t seed, sample_scan *scan,
					   sample_list *list)
{
	uint64_t random = seed ^ 0x5ca11ed;
	double shares = 0, high = HIGHEST_ELEVATION - LOWEST_ELEVATION;

	for (int i = 0; i < COUNT(stations); i++)
		shares += stations[i].share;
	for (int i = 0; i < COUNT(stations); i++) {
		double cells = (double)count * stations[i].share / shares;
		pose_station(i, &scan[i]);
		scan[i].rows = (size_t)ceil(sqrt(cells * high / TURN));
		scan[i].columns = (size_t)ceil(cells / (double)scan[i].rows);
		scan_grid(&scan[i], noise_metres, &random, list);
	}
}

/* The promise about stations; false after a message when it is broken. */
static bool check_stations(bool print)
{
	bool good = true;

	for (int i = 0; i < COUNT(stations); i++) {
		vector p = stations[i].at;
		double air = -cave_distance(p);
		if (print)
			printf("%-15s %5.1f %5.1f %5.1f\n", stations[i].name, p.x, p.y, p.z);
		if (air < AIR_CLEARANCE) {
			fprintf(stderr, "make_cave: station %s has only %.2f m of air with this seed\n",
					stations[i].name, air);
			good = false;
		}
	}
	return good;
}

/* -------------------------------------------------------------------------------- the program */

/* What is written: the formats of sample_format, then those of grids. */
enum { PTX = SAMPLE_CLOUD + 1, E57 };

static const char *const formats[] = { "ply", "cloud", "ptx", "e57" };

typedef struct cave_options {
	size_t points;
	uint64_t seed;
	double noise;
	int format;
	const char *output;
	bool stations, grid, closed;
} cave_options;

static void print_help(void)
{
	puts(
		"usage: make_cave [options] -o FILE\n"
		"Writes a made-up cave, 40 m long, as a laser scanner sees it: points with normals,\n"
		"albedo and emission, denser near the nine scanners. Metres; z is up in PLY, y in .cloud.\n"
		"\n"
		"  --points N          number of points (1400000)\n"
		"  --seed N            another cave with the same chambers and path (1)\n"
		"  --noise METRES      standard deviation of the scanners' range, 0..0.1 (0)\n"
		"  --format FORMAT     ply (the default), cloud, ptx or e57. cloud has no emission; ptx\n"
		"                      and e57 have neither that nor normals, but a grid for each\n"
		"                      scanner, with its pose and intensity, and holes in it\n"
		"  --grid              rays in equal steps of angle, as in ptx and e57, and only about as\n"
		"                      many points as asked for\n"
		"  --closed            points on all of the rock, also where no scanner sees it, so\n"
		"                      that no light gets in from outside; PLY and cloud only\n"
		"  --stations          print places on the visitors' path, name x y z, and stop:\n"
		"                      they are in the air for every seed, so lamps can stand there\n"
		"  -o FILE             where to write; - is standard output (the default)");
}

static int parse_format(const char *text)
{
	for (int i = 0; i < COUNT(formats); i++) {
		if (strcmp(text, formats[i]) == 0)
			return i;
	}
	fprintf(stderr, "make_cave: --format %s: choose ply, cloud, ptx or e57\n", text);
	exit(SAMPLE_EXIT_USAGE);
}

static void parse_options(int argc, char **argv, cave_options *o)
{
	static const struct option names[] = {
		{ "points", required_argument, NULL, 'n' }, { "seed", required_argument, NULL, 'r' },
		{ "noise", required_argument, NULL, 's' },  { "format", required_argument, NULL, 'f' },
		{ "stations", no_argument, NULL, 'p' },     { "output", required_argument, NULL, 'o' },
		{ "grid", no_argument, NULL, 'g' },         { "closed", no_argument, NULL, 'c' },
		{ "help", no_argument, NULL, 'h' },         { 0 },
	};
	int c;

	while ((c = getopt_long(argc, argv, "o:h", names, NULL)) != -1) {
		switch (c) {
		case 'n':
			o->points = sample_parse_count("--points", optarg, 100000000);
			break;
		case 'r':
			o->seed = sample_parse_seed("--seed", optarg);
			break;
		case 's':
			o->noise = sample_parse_number("--noise", optarg, 0, 0.1);
			break;
		case 'f':
			o->format = parse_format(optarg);
			break;
		case 'p':
			o->stations = true;
			break;
		case 'g':
			o->grid = true;
			break;
		case 'c':
			o->closed = true;
			break;
		case 'o':
			o->output = optarg;
			break;
		case 'h':
			print_help();
			exit(0);
		default:
			exit(SAMPLE_EXIT_USAGE);
		}
	}
	if (optind != argc) {
		fprintf(stderr, "make_cave: too many arguments; try make_cave --help\n");
		exit(SAMPLE_EXIT_USAGE);
	}
	if (o->closed && (o->grid || o->format >= PTX)) {
		fprintf(stderr, "make_cave: --closed has no grids of scanners; choose ply or cloud\n");
		exit(SAMPLE_EXIT_USAGE);
	}
}

/* Scans and writes; returns the exit code. */
static int make_cave(const cave_options *o)
{
	sample_list list = { 0 };
	sample_scan scan[COUNT(stations)] = { 0 };
	char comment[200];
	int status;

	snprintf(comment, sizeof comment, "make_cave points %zu seed %llu noise %g%s", o->points,
			 (unsigned long long)o->seed, o->noise, o->closed ? " closed" : "");
	if (o->grid || o->format >= PTX)
		scan_grids(o->points, o->noise, o->seed, scan, &list);
	else if (o->closed)
		scan_everywhere(o->points, o->noise, o->seed, &list);
	else
		scan_cave(o->points, o->noise, o->seed, &list);
	if (o->format == PTX)
		status = sample_write_ptx(scan, COUNT(stations), o->output);
	else if (o->format == E57)
		status = sample_write_e57(scan, COUNT(stations), o->output, comment);
	else
		status = sample_write(&list, o->output, (sample_format)o->format, comment);
	sample_scans_clear(scan, COUNT(stations));
	sample_clear(&list);
	return status;
}

int main(int argc, char **argv)
{
	cave_options o = { .points = 1400000, .seed = 1, .output = "-" };

	parse_options(argc, argv, &o);
	uint64_t random = o.seed;
	grow_cave(&random);
	if (!check_stations(o.stations))
		return 70;
	return o.stations ? 0 : make_cave(&o);
}
