/* The scanner of tests/bench: beams meet the surface where they should, and faults are as large as
 * asked for. */
#include "simulated_scan.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>

#include <cmocka.h>

static simulated_scan scan_kind(mesh_kind kind, const scan_setup *setup, mesh_scene *scene)
{
	simulated_scan scan;
	gw_error error = { 0 };
	if (mesh_scene_make(kind, scene, &error) != GW_OK ||
		simulated_scan_make(scene, setup, &scan, &error) != GW_OK)
		fail_msg("%s", error.text);
	return scan;
}

/* A cell's place in the world as its station says. */
static void place_of(const simulated_scan *scan, const scan_setup *setup, size_t station,
					 size_t cell, double world[3])
{
	const station_scan *s = &scan->station[station];
	double own[3];
	station_scan_direction(s, setup, cell / s->rows, cell % s->rows, own);
	for (size_t k = 0; k < 3; k++)
		own[k] *= s->cell[cell].range;
	station_scan_to_world(s, own, world);
}

/* Without faults every point is on the surface, for scanners that stand and cameras, and for one
 * that is carried. */
static void points_are_on_the_surface(void **state)
{
	(void)state;
	for (int kind = 0; kind < 3; kind++) {
		const scan_setup setup = {
			.count = 3000, .camera = kind == 1, .poses = kind == 2 ? 20 : 0, .seed = 3
		};
		mesh_scene scene;
		simulated_scan scan = scan_kind(MESH_CARTON, &setup, &scene);
		assert_in_range(scan.count, 2500, 3500);
		for (size_t s = 0; s < scan.station_count; s++) {
			for (size_t c = 0; c < scan.station[s].columns * scan.station[s].rows; c++) {
				const scan_cell *cell = &scan.station[s].cell[c];
				if (cell->kind == CELL_EMPTY)
					continue;
				const mesh_triangle *t = &scene.triangle[cell->triangle];
				double world[3], height = 0.0, apart = 0.0, facing = 0.0;
				place_of(&scan, &setup, s, c, world);
				for (size_t k = 0; k < 3; k++) {
					height += (world[k] - t->corner[0][k]) * t->normal[k];
					facing += (scan.station[s].place[k] - world[k]) * t->normal[k];
					apart = fmax(apart, fabs(world[k] - cell->surface[k]));
				}
				/* Embree's rays are floats: 1e-6 of some metres. */
				assert_true(fabs(height) < 1e-5 && apart < 1e-5 && facing > 0.0);
				assert_int_equal(cell->kind, CELL_SURFACE);
			}
		}
		simulated_scan_clear(&scan);
		mesh_scene_clear(&scene);
	}
}

/* Shares of kinds, and the RMS of how far off points on surface are. */
static double measure(const scan_setup *setup, size_t kind[4])
{
	mesh_scene scene;
	simulated_scan scan = scan_kind(MESH_FENCE, setup, &scene);
	double squares = 0.0;
	for (size_t s = 0; s < scan.station_count; s++) {
		for (size_t c = 0; c < scan.station[s].columns * scan.station[s].rows; c++) {
			const scan_cell *cell = &scan.station[s].cell[c];
			double world[3];
			kind[cell->kind]++;
			if (cell->kind != CELL_SURFACE)
				continue;
			place_of(&scan, setup, s, c, world);
			for (size_t k = 0; k < 3; k++)
				squares += pow(world[k] - cell->surface[k], 2);
		}
	}
	simulated_scan_clear(&scan);
	mesh_scene_clear(&scene);
	return sqrt(squares / (double)kind[CELL_SURFACE]);
}

static void faults_are_as_asked_for(void **state)
{
	(void)state;
	scan_setup setup = { .count = 10000, .seed = 5, .faults = { .range_noise = 0.004 } };
	size_t noisy[4] = { 0 }, off[4] = { 0 }, wide[4] = { 0 }, stray[4] = { 0 };
	/* The RMS of 10,000 is known to 0.7 %; five times that. */
	assert_true(fabs(measure(&setup, noisy) / 0.004 - 1.0) < 0.035);
	setup.faults = (scan_faults){ .registration = 0.005 };
	assert_true(fabs(measure(&setup, off) / 0.005 - 1.0) < 0.01);
	/* Each axis drifts by its whole standard deviation along the way; by how many points a pose has
	 * it counts half as much or twice. */
	size_t drifted[4] = { 0 };
	setup.poses = 40;
	double drift = measure(&setup, drifted) / (sqrt(3.0) * 0.005);
	assert_true(drift > M_SQRT1_2 && drift < M_SQRT2);
	setup.poses = 0;
	/* Beams twice as wide as the wires meet them and what is behind. */
	setup.faults = (scan_faults){ .beam_width = 0.01 };
	measure(&setup, wide);
	assert_int_equal(noisy[CELL_MIXED] + off[CELL_MIXED] + drifted[CELL_MIXED], 0);
	assert_true(wide[CELL_MIXED] > (wide[CELL_MIXED] + wide[CELL_SURFACE]) / 20);
	/* 200 of them, give or take 4.5 times their root. */
	setup.faults = (scan_faults){ .strays = 0.02 };
	measure(&setup, stray);
	assert_in_range(stray[CELL_STRAY], 135, 265);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(points_are_on_the_surface),
		cmocka_unit_test(faults_are_as_asked_for),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
