/*
 * make_box.c - scenes whose light has a closed form, as points sampled uniformly by area.
 *
 *   furnace  a closed sphere of radius 1 about the origin, normals inward; all of it emits
 *   cornell  an open box of side 1 with a red and a green wall, two blocks, a lamp in the ceiling
 *   rooms    two closed rooms of 2 m, a 5 cm wall between them; the ceiling of the first emits
 *   corner   two unit squares that meet at a right angle; the horizontal one emits
 *   plane    a unit square at z = 0, normal up; all of it emits
 */
#include "sample_points.h"

#include <assert.h>
#include <getopt.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* A parallelogram: corner, two edges; its normal is along edge a x edge b. */
typedef struct patch {
	double corner[3], a[3], b[3];
	float tint[3]; /* times the albedo asked for */
	bool emits;
} patch;

#define PATCH_MAXIMUM 24

typedef struct scene {
	const char *name;
	void (*build)(struct scene *scene);
	float emission; /* default radiance */
	patch patch[PATCH_MAXIMUM];
	int patch_count;
	bool sphere;
} scene;

static const float white[3] = { 1, 1, 1 };
static const float red[3] = { 1, 0.1f, 0.1f };
static const float green[3] = { 0.1f, 1, 0.1f };

static void cross(double out[3], const double a[3], const double b[3])
{
	out[0] = a[1] * b[2] - a[2] * b[1];
	out[1] = a[2] * b[0] - a[0] * b[2];
	out[2] = a[0] * b[1] - a[1] * b[0];
}

static void add_patch(scene *s, const double corner[3], const double a[3], const double b[3],
					  const float tint[3], bool emits)
{
	patch *p = &s->patch[s->patch_count++];

	memcpy(p->corner, corner, sizeof p->corner);
	memcpy(p->a, a, sizeof p->a);
	memcpy(p->b, b, sizeof p->b);
	memcpy(p->tint, tint, sizeof p->tint);
	p->emits = emits;
}

/* Bounds of a room, metres. */
typedef struct box {
	double low[3], high[3];
} box;

/* The side of a room that lies at the low or the high end of an axis; its normal points inward. */
static void add_side(scene *s, const box *room, int axis, bool high, const float tint[3],
					 bool emits)
{
	double corner[3] = { room->low[0], room->low[1], room->low[2] };
	double a[3] = { 0 }, b[3] = { 0 };
	int u = (axis + 1) % 3, v = (axis + 2) % 3;

	corner[axis] = high ? room->high[axis] : room->low[axis];
	a[u] = room->high[u] - room->low[u];
	b[v] = room->high[v] - room->low[v];
	/* a x b is along +axis, which is outward on the high side. */
	if (high)
		add_patch(s, corner, b, a, tint, emits);
	else
		add_patch(s, corner, a, b, tint, emits);
}

static void build_furnace(scene *s)
{
	s->sphere = true;
}

static void build_plane(scene *s)
{
	add_patch(s, (double[]){ 0, 0, 0 }, (double[]){ 1, 0, 0 }, (double[]){ 0, 1, 0 }, white, true);
}

static void build_corner(scene *s)
{
	add_patch(s, (double[]){ 0, 0, 0 }, (double[]){ 1, 0, 0 }, (double[]){ 0, 1, 0 }, white, true);
	add_patch(s, (double[]){ 0, 0, 0 }, (double[]){ 0, 1, 0 }, (double[]){ 0, 0, 1 }, white, false);
}

/* A block that stands on z = 0 and is turned about z: four sides and a top. */
static void add_block(scene *s, double x, double y, double width, double height, double degrees)
{
	double angle = degrees * 3.141592653589793 / 180;
	double c = cos(angle) * width, n = sin(angle) * width;
	double a[3] = { c, n, 0 }, b[3] = { -n, c, 0 }, up[3] = { 0, 0, height };
	double a_back[3] = { -c, -n, 0 }, b_back[3] = { n, -c, 0 };
	double base[3] = { x - (c - n) / 2, y - (n + c) / 2, 0 };
	double opposite[3] = { base[0] + c - n, base[1] + n + c, 0 };
	double top[3] = { base[0], base[1], height };

	add_patch(s, base, a, up, white, false);
	add_patch(s, base, up, b, white, false);
	add_patch(s, opposite, a_back, up, white, false);
	add_patch(s, opposite, up, b_back, white, false);
	add_patch(s, top, a, b, white, false);
}

static void build_cornell(scene *s)
{
	static const box room = { { 0, 0, 0 }, { 1, 1, 1 } };

	add_side(s, &room, 2, false, white, false);
	add_side(s, &room, 2, true, white, false);
	add_side(s, &room, 1, true, white, false);
	add_side(s, &room, 0, false, red, false);
	add_side(s, &room, 0, true, green, false);
	add_patch(s, (double[]){ 0.375, 0.375, 0.999 }, (double[]){ 0, 0.25, 0 },
			  (double[]){ 0.25, 0, 0 }, white, true);
	add_block(s, 0.32, 0.65, 0.30, 0.60, 18);
	add_block(s, 0.67, 0.33, 0.28, 0.28, -16);
}

static void build_rooms(scene *s)
{
	static const box rooms[2] = { { { 0, 0, 0 }, { 2, 2, 2 } },
								  { { 2.05, 0, 0 }, { 4.05, 2, 2 } } };

	for (int room = 0; room < 2; room++) {
		for (int axis = 0; axis < 3; axis++) {
			for (int high = 0; high < 2; high++) {
				bool emits = room == 0 && axis == 2 && high;
				add_side(s, &rooms[room], axis, high, white, emits);
			}
		}
	}
}

static scene scenes[] = {
	{ .name = "furnace", .build = build_furnace, .emission = 1 },
	{ .name = "cornell", .build = build_cornell, .emission = 15 },
	{ .name = "rooms", .build = build_rooms, .emission = 1 },
	{ .name = "corner", .build = build_corner, .emission = 1 },
	{ .name = "plane", .build = build_plane, .emission = 0 },
};

#define SCENE_COUNT (sizeof scenes / sizeof scenes[0])

static void sample_sphere(uint64_t *random, sample_point *point)
{
	double z = 2 * sample_random(random) - 1;
	double angle = 6.283185307179586 * sample_random(random);
	double radius = sqrt(1 - z * z);
	double at[3] = { radius * cos(angle), radius * sin(angle), z };

	for (int i = 0; i < 3; i++) {
		point->position[i] = (float)at[i];
		point->normal[i] = (float)-at[i];
	}
}

static void sample_patch(const patch *p, uint64_t *random, sample_point *point)
{
	double u = sample_random(random), v = sample_random(random), n[3];

	cross(n, p->a, p->b);
	double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
	for (int i = 0; i < 3; i++) {
		point->position[i] = (float)(p->corner[i] + u * p->a[i] + v * p->b[i]);
		point->normal[i] = (float)(n[i] / length);
	}
}

/* Sums of the patches' areas, so that sum[i] - sum[i - 1] is the area of patch i. */
static void sum_areas(const scene *s, double *sum)
{
	double total = 0;

	for (int i = 0; i < s->patch_count; i++) {
		double n[3];
		cross(n, s->patch[i].a, s->patch[i].b);
		total += sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
		sum[i] = total;
	}
}

static void sample_scene(const scene *s, size_t count, uint64_t seed, const float albedo[3],
						 const float emission[3], sample_list *list)
{
	double sum[PATCH_MAXIMUM];
	uint64_t random = seed;

	sum_areas(s, sum);
	for (size_t i = 0; i < count; i++) {
		sample_point point = { 0 };
		const float *tint = white;
		bool emits = true;
		if (s->sphere) {
			sample_sphere(&random, &point);
		} else {
			assert(s->patch_count > 0);
			double at = sample_random(&random) * sum[s->patch_count - 1];
			int chosen = 0;
			while (chosen < s->patch_count - 1 && at >= sum[chosen])
				chosen++;
			tint = s->patch[chosen].tint;
			emits = s->patch[chosen].emits;
			sample_patch(&s->patch[chosen], &random, &point);
		}
		for (int c = 0; c < 3; c++) {
			point.albedo[c] = albedo[c] * tint[c];
			point.emission[c] = emits ? emission[c] : 0;
		}
		sample_add(list, &point);
	}
}

static void print_help(void)
{
	puts("usage: make_box --scene NAME [options] -o FILE\n"
		 "Writes a scene whose light has a closed form as PLY points, sampled uniformly by area.\n"
		 "\n"
		 "  --scene NAME        furnace  sphere of radius 1 that emits everywhere\n"
		 "                      cornell  open box of side 1, lamp in the ceiling\n"
		 "                      rooms    two closed rooms, only the first has a lamp\n"
		 "                      corner   two unit squares at a right angle, the floor emits\n"
		 "                      plane    unit square\n"
		 "  --points N          number of points (100000)\n"
		 "  --albedo V|R,G,B    diffuse reflectance, linear, 0..1 (0.5); stored in 8 bits as sRGB\n"
		 "  --emission V|R,G,B  radiance of what emits (furnace, rooms, corner 1; cornell 15;\n"
		 "                      plane 0)\n"
		 "  --seed N            of the random positions (1)\n"
		 "  -o FILE             where to write; - is standard output (the default)");
}

static scene *find_scene(const char *name)
{
	for (size_t i = 0; i < SCENE_COUNT; i++) {
		if (strcmp(scenes[i].name, name) == 0)
			return &scenes[i];
	}
	fprintf(stderr, "make_box: there is no scene %s; choose one of", name);
	for (size_t i = 0; i < SCENE_COUNT; i++)
		fprintf(stderr, " %s", scenes[i].name);
	fprintf(stderr, "\n");
	exit(SAMPLE_EXIT_USAGE);
}

typedef struct box_options {
	scene *scene;
	size_t points;
	uint64_t seed;
	float albedo[3], emission[3];
	bool has_emission;
	const char *output;
} box_options;

static void parse_options(int argc, char **argv, box_options *o)
{
	static const struct option names[] = {
		{ "scene", required_argument, NULL, 's' },  { "points", required_argument, NULL, 'n' },
		{ "albedo", required_argument, NULL, 'a' }, { "emission", required_argument, NULL, 'e' },
		{ "seed", required_argument, NULL, 'r' },   { "output", required_argument, NULL, 'o' },
		{ "help", no_argument, NULL, 'h' },         { 0 },
	};
	int c;

	while ((c = getopt_long(argc, argv, "o:h", names, NULL)) != -1) {
		switch (c) {
		case 's':
			o->scene = find_scene(optarg);
			break;
		case 'n':
			o->points = sample_parse_count("--points", optarg, 100000000);
			break;
		case 'a':
			sample_parse_color("--albedo", optarg, 1, o->albedo);
			break;
		case 'e':
			sample_parse_color("--emission", optarg, 1e9, o->emission);
			o->has_emission = true;
			break;
		case 'r':
			o->seed = sample_parse_seed("--seed", optarg);
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
	if (!o->scene || optind != argc) {
		fprintf(stderr, "make_box: %s; try make_box --help\n",
				o->scene ? "too many arguments" : "--scene is missing");
		exit(SAMPLE_EXIT_USAGE);
	}
}

int main(int argc, char **argv)
{
	box_options o = { .points = 100000, .seed = 1, .albedo = { 0.5f, 0.5f, 0.5f }, .output = "-" };
	sample_list list = { 0 };
	char comment[200];

	parse_options(argc, argv, &o);
	for (int i = 0; !o.has_emission && i < 3; i++)
		o.emission[i] = o.scene->emission;
	o.scene->build(o.scene);
	sample_scene(o.scene, o.points, o.seed, o.albedo, o.emission, &list);
	snprintf(comment, sizeof comment, "make_box scene %s points %zu seed %llu", o.scene->name,
			 o.points, (unsigned long long)o.seed);
	int status = sample_write(&list, o.output, SAMPLE_PLY, comment);
	sample_clear(&list);
	return status;
}
