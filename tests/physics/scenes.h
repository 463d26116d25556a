/*
 * scenes.h - point clouds made in memory, and bakes of them, for tests that know the answer.
 *
 * All coordinates are multiples of 2^-20 m, so that a scene can be moved without rounding. The
 * functions fail the running cmocka test themselves when memory is short or a bake goes wrong;
 * a bake on a machine without a Vulkan device skips it (under CI it fails).
 */
#ifndef SCENES_H
#define SCENES_H

#include "glowworm.h"

#define SCENE_PI 3.14159265358979323846

/* A cloud under construction. emission is all zero until something emits. */
typedef struct scene {
	size_t count, capacity;
	double *position; /* 3 * count, metres */
	float *normal, *albedo, *emission;
	bool emits;
	uint64_t state; /* of the random numbers */
} scene;

/* A number in [0, 1), the next of the scene's sequence. */
double scene_random(scene *s);

/* Adds a point; albedo is the same in all channels. Returns its index. */
size_t scene_add(scene *s, const double position[3], const double normal[3], float albedo);

/* A parallelogram of n x m points. */
typedef struct scene_patch {
	const double *corner, *u, *v; /* 3 each, metres; u and v are the sides, the normal is along
									 u x v */
	size_t n, m;                  /* along u and v */
} scene_patch;

/* Adds its points, one at a random place in each of the cells. */
void scene_add_patch(scene *s, const scene_patch *patch, float albedo);

/*
 * Adds `count` points spread evenly over a sphere (golden-angle spiral).
 *   facing   -1: normals towards the centre, 1: away from it
 */
void scene_add_sphere(scene *s, const double centre[3], double radius, size_t count, int facing,
					  float albedo);

/* Adds the six walls of a box that is lit from inside; per_metre points a metre along each edge. */
void scene_add_box(scene *s, const double corner[3], const double size[3], double per_metre,
				   float albedo);

/*
 * An open hall with all that a bake can light: five walls in three colours, a ball, a lamp of
 * points that emit in the ceiling. 4 x 3 x 2.5 m, open at y = 0; about 7000 points.
 */
void scene_make_hall(scene *s);

/* The same hall of about 3000 points, for what does not ask how well they are lit: relations
 * between bakes, and what they run. */
void scene_make_small_hall(scene *s);

/* A cube of 1 m from the origin on, grey, closed but for a square hole of 0.25 m in the middle of
 * its ceiling; 32 points a metre, the 1024 of the floor first. */
void scene_make_cellar(scene *s);

/* A cube of side 2 around the origin, seen from within, of points at random places of its sides, as
 * many of each. */
void scene_make_random_room(scene *s, size_t count, float albedo);

/* All points from `first` on emit that radiance. */
void scene_emit(scene *s, size_t first, const float radiance[3]);

/* The scene as gw_bake takes it; valid as long as nothing is added. */
gw_points scene_points(const scene *s);
void scene_clear(scene *s);

/*
 * Lets a run of the tests decide by what passes run and what Vulkan's validation layer looks at:
 * by the names in GLOWWORM_TEST_PASSES and GLOWWORM_TEST_VALIDATE, if they are set.
 */
void scene_choose_passes(gw_pass_choice *passes, gw_validation *validate);

/* Whether it says that bakes are by shaders, which takes many times as long: what differs in
 * numbers alone is left to the CPU kernels then, which have the same text. */
bool scene_by_shaders(void);

/* Bakes, as scene_choose_passes says; the result is freed by the caller with
 * gw_bake_result_destroy. */
gw_bake_result *scene_bake(const gw_points *points, const gw_light *lights, size_t light_count,
						   const gw_bake_options *options);

/*
 * Bakes the small hall under a lamp, as options say and by three threads: the light has to be the
 * same to the last bit.
 *   result   receives the two bakes; each freed by the caller with gw_bake_result_destroy
 */
void scene_bake_hall_twice(const gw_bake_options *options, gw_bake_result *result[2]);

/* The area that each point stands for, m^2, as the library finds it; freed by the caller. */
double *scene_areas(const gw_points *points);

/* Mean over all points of one channel of a per-point array. */
double scene_mean(const float *values, size_t count, size_t channel);

/* The report has a stage of that name. */
bool scene_has_stage(const gw_report *report, const char *name);

/* The effect of that name; the test fails when the report has none. */
const gw_effect *scene_effect(const gw_report *report, const char *name);

/* What a transport is written into; `data` is freed by the caller. */
typedef struct scene_bytes {
	unsigned char *data;
	size_t length, limit; /* writing past the limit fails with GW_STATUS_OF_CALLER */
} scene_bytes;

/* gw_transport.write, whose user are such bytes. */
gw_status scene_keep_bytes(void *user, const void *bytes, size_t length, gw_error *error);

/* A white point light without extent: intensity in W/sr, the same in all channels. */
gw_light scene_point_light(double x, double y, double z, float intensity);

#endif
