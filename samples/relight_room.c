/*
 * relight_room.c - libglowworm in one page: a room is prepared once, and lit by a lamp that moves.
 *
 *   cc relight_room.c $(pkg-config --cflags --libs libglowworm) -lm -o relight_room
 *
 * Of each lighting it prints the mean radiance of all points and that of the floor. The first is
 * the same wherever the lamp is: light that goes into a closed room is absorbed in the end, so that
 * the mean of albedo 1/2 is 4 I / area = 0.741 W/(sr m^2).
 */
#include <glowworm.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define POINTS 60000
#define SIDE 3.0 /* metres */
#define FRAMES 8

static double position[3 * POINTS];
static float normal[3 * POINTS], radiance[3 * POINTS];

/* Points spread evenly over six walls, the floor being every sixth from the fifth on. */
static void make_room(void)
{
	for (int i = 0; i < POINTS; i++) {
		int wall = i % 6, axis = wall / 2;
		double u = i * 0.7548776662466927, v = i * 0.5698402909980532;
		position[3 * i + axis] = wall % 2 ? SIDE : 0.0;
		position[3 * i + (axis + 1) % 3] = SIDE * (u - floor(u));
		position[3 * i + (axis + 2) % 3] = SIDE * (v - floor(v));
		normal[3 * i + axis] = wall % 2 ? -1.0f : 1.0f;
	}
}

static double mean_radiance(int first, int step)
{
	double sum = 0.0;
	int count = 0;
	for (int i = first; i < POINTS; i += step, count++)
		sum += radiance[3 * i];
	return sum / count;
}

static int check(gw_status status, const gw_error *error)
{
	if (status != GW_OK)
		fprintf(stderr, "relight_room: %s\n", error->text);
	return status == GW_OK;
}

int main(void)
{
	gw_points points = { .count = POINTS, .position = position, .normal = normal };
	gw_scene_description room = { .points = &points };
	gw_light lamp = { .type = GW_LIGHT_POINT, .intensity = { 10.0f, 10.0f, 10.0f } };
	gw_scene *scene = NULL;
	gw_lighting *lighting = NULL;
	gw_error_estimate estimate;
	gw_error error;

	make_room();
	int good = check(gw_scene_create(&room, NULL, NULL, &scene, &error), &error);
	for (int i = 0; i < FRAMES && good; i++) {
		double turn = 2.0 * 3.14159265358979324 * i / FRAMES;
		lamp.position[0] = 1.5 + cos(turn);
		lamp.position[1] = 1.5 + sin(turn);
		lamp.position[2] = 0.6 + 0.25 * i;
		good = lighting ? check(gw_lighting_change(lighting, &lamp, 1, &error), &error)
						: check(gw_lighting_create(scene, &lamp, 1, &lighting, &error), &error);
		good = good && check(gw_lighting_radiance(lighting, radiance, &error), &error);
		if (good)
			printf("lamp at %.2f %.2f %.2f: mean %.3f, floor %.3f\n", lamp.position[0],
				   lamp.position[1], lamp.position[2], mean_radiance(0, 1), mean_radiance(4, 6));
	}
	good = good && check(gw_lighting_error(lighting, &estimate, &error), &error);
	if (good)
		printf("estimated error of the last one: %.2f %%\n", 100.0 * estimate.relative_rms);
	gw_lighting_destroy(&lighting);
	gw_scene_destroy(&scene);
	return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
