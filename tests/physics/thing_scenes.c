/* thing_scenes.c - scenes that are seen from outside: things on a floor, hills, a fence, a tree. */
#include "mesh_builder.h"

#include <math.h>
#include <string.h>

#define PI 3.14159265358979323846

/* A floor at height 0, around the origin, and bounds that hold all that stands on it. */
static void add_floor(mesh_builder *b, double half, double height)
{
	const double low[3] = { -half, -half, 0.0 }, high[3] = { half, half, height };
	mesh_set_color(b, 150, 140, 125);
	mesh_add_side(b, low, high, 4);
	memcpy(b->scene->low, low, sizeof low);
	memcpy(b->scene->high, high, sizeof high);
}

static void add_sky(mesh_builder *b, float level)
{
	mesh_set_color3(mesh_add_light(b, GW_LIGHT_ENVIRONMENT)->radiance, level, 1.3f * level,
					1.8f * level);
}

static void add_sun(mesh_builder *b, double x, double y, double z)
{
	gw_light *sun = mesh_add_light(b, GW_LIGHT_SUN);
	mesh_set_place(sun->direction, x, y, z);
	mesh_set_color3(sun->irradiance, 3.0f, 2.7f, 2.2f);
	sun->angle = 0.53f;
}

/* Stations around the origin, at one height. */
static void set_stations_around(mesh_builder *b, double distance, double height)
{
	double place[MESH_STATIONS][3];
	for (size_t i = 0; i < MESH_STATIONS; i++) {
		double turn = 2.0 * PI * ((double)i + 0.3) / MESH_STATIONS;
		mesh_set_place(place[i], distance * cos(turn), distance * sin(turn), height);
	}
	mesh_set_stations(b, place, MESH_STATIONS);
}

/* ------------------------------------------------------------------------------------- things */

#define AROUND 64 /* corners around a ball or a ring */

/* The quadrilateral with these corners, counterclockwise; triangles without area are left out. */
static void add_quad(mesh_builder *b, const double p[4][3])
{
	if (memcmp(p[1], p[2], sizeof p[1]) != 0)
		mesh_add_triangle(b, p[0], p[1], p[2]);
	if (memcmp(p[3], p[0], sizeof p[0]) != 0)
		mesh_add_triangle(b, p[0], p[2], p[3]);
}

/* A place on a ring of tube `tube` about the vertical; a ball is one of radius 0. */
static void place_on_ring(double radius, double tube, double u, double v, double out[3])
{
	double across = radius + tube * sin(v);
	mesh_set_place(out, across * cos(u), across * sin(u), tube - tube * cos(v));
}

static void add_ring(mesh_builder *b, double radius, double tube, int sections)
{
	double step = 2.0 * PI / AROUND;
	for (int i = 0; i < AROUND; i++) {
		for (int j = 0; j < sections; j++) {
			double p[4][3];
			int next = (i + 1) % AROUND;
			place_on_ring(radius, tube, i * step, j * step, p[0]);
			place_on_ring(radius, tube, next * step, j * step, p[1]);
			place_on_ring(radius, tube, next * step, (j + 1) * step, p[2]);
			place_on_ring(radius, tube, i * step, (j + 1) * step, p[3]);
			/* The poles of a ball are one place each. */
			if (radius == 0.0 && j == 0)
				memcpy(p[1], p[0], sizeof p[1]);
			if (radius == 0.0 && j == 0)
				mesh_add_triangle(b, p[0], p[2], p[3]);
			else if (radius == 0.0 && j == sections - 1)
				mesh_add_triangle(b, p[0], p[1], p[3]);
			else
				add_quad(b, p);
		}
	}
}

void mesh_make_ball(mesh_builder *b)
{
	add_floor(b, 1.5, 3.0);
	mesh_set_color(b, 190, 90, 70);
	add_ring(b, 0.0, 0.4, AROUND / 2);
	add_sun(b, 0.6, 0.35, -0.75);
	add_sky(b, 0.3f);
	set_stations_around(b, 1.6, 1.1);
}

void mesh_make_carton(mesh_builder *b)
{
	add_floor(b, 1.5, 3.0);
	mesh_set_color(b, 185, 150, 105);
	mesh_add_solid(b, (double[3]){ 0, 0, 0.25 }, (double[3]){ 0.3, 0.2, 0.25 }, 0.4);
	gw_light *lamp = mesh_add_light(b, GW_LIGHT_POINT);
	mesh_set_place(lamp->position, 0.9, -0.8, 1.6);
	mesh_set_color3(lamp->intensity, 4.0f, 3.6f, 3.0f);
	add_sky(b, 0.05f);
	set_stations_around(b, 1.6, 1.1);
}

void mesh_make_torus(mesh_builder *b)
{
	add_floor(b, 1.5, 3.0);
	mesh_set_color(b, 90, 130, 190);
	add_ring(b, 0.45, 0.16, AROUND);
	add_sky(b, 1.0f);
	set_stations_around(b, 1.6, 1.1);
}

/* -------------------------------------------------------------------------------------- hills */

#define HILLS 40.0    /* metres across */
#define HILL_CELLS 64 /* triangles a side, in pairs */

static double hill_height(double x, double y)
{
	const double p[3] = { 0.11 * x + 3.1, 0.11 * y + 7.7, 0.5 };
	const double q[3] = { 0.4 * x, 0.4 * y, 4.5 };
	double away = hypot(x, y) / 7.0, level = fmin(1.0, away * away * away);
	return level * (1.6 * mesh_smooth_noise(p) + 0.25 * mesh_smooth_noise(q));
}

static void add_hills(mesh_builder *b)
{
	static const int corner[4][2] = { { 0, 0 }, { 1, 0 }, { 1, 1 }, { 0, 1 } };
	double step = HILLS / HILL_CELLS;
	for (int i = 0; i < HILL_CELLS; i++) {
		for (int j = 0; j < HILL_CELLS; j++) {
			double p[4][3];
			for (int c = 0; c < 4; c++) {
				double x = step * (i + corner[c][0]) - 0.5 * HILLS;
				double y = step * (j + corner[c][1]) - 0.5 * HILLS;
				mesh_set_place(p[c], x, y, hill_height(x, y));
			}
			add_quad(b, p);
		}
	}
}

/* Two slopes with a thickness, on a block; they stand out a little. */
static void add_roof(mesh_builder *b, double x, double y, double low, double high)
{
	const double eave[2][2][3] = { { { -x, -y, low }, { x, -y, low } },
								   { { x, y, low }, { -x, y, low } } };
	const double ridge[2][3] = { { -x, 0, high }, { x, 0, high } };
	mesh_add_triangle(b, eave[0][0], eave[0][1], ridge[1]);
	mesh_add_triangle(b, eave[0][0], ridge[1], ridge[0]);
	mesh_add_triangle(b, eave[1][0], eave[1][1], ridge[0]);
	mesh_add_triangle(b, eave[1][0], ridge[0], ridge[1]);
	mesh_add_triangle(b, eave[0][0], ridge[0], eave[1][1]);
	mesh_add_triangle(b, eave[0][1], eave[1][0], ridge[1]);
	mesh_add_patch(b, eave[0][0], (double[3]){ 0, 2 * y, 0 }, (double[3]){ 2 * x, 0, 0 });
}

void mesh_make_terrain(mesh_builder *b)
{
	mesh_set_color(b, 120, 130, 80);
	add_hills(b);
	mesh_set_color(b, 210, 200, 185);
	mesh_add_solid(b, (double[3]){ 0, 0, 1.2 }, (double[3]){ 3.0, 2.0, 1.6 }, 0.0);
	mesh_set_color(b, 150, 70, 55);
	add_roof(b, 3.3, 2.3, 2.8, 4.4);
	mesh_set_place(b->scene->low, -0.5 * HILLS, -0.5 * HILLS, -5.0);
	mesh_set_place(b->scene->high, 0.5 * HILLS, 0.5 * HILLS, 8.0);
	add_sun(b, 0.6, 0.35, -0.55);
	add_sky(b, 0.3f);
	set_stations_around(b, 8.0, 2.6);
}

/* --------------------------------------------------------------------------- wires and branches */

/* A rod with a regular cross-section from one place to another, without its ends. */
static void add_rod(mesh_builder *b, const double from[3], const double to[3],
					const double radius[2], int sides)
{
	double axis[3], u[3], v[3], length = 0.0;
	for (size_t k = 0; k < 3; k++) {
		axis[k] = to[k] - from[k];
		length += axis[k] * axis[k];
	}
	for (size_t k = 0; k < 3; k++)
		axis[k] /= sqrt(length);
	bool upright = fabs(axis[2]) > 0.7;
	const double other[3] = { upright, 0, !upright };
	for (size_t k = 0; k < 3; k++)
		u[k] = other[(k + 1) % 3] * axis[(k + 2) % 3] - other[(k + 2) % 3] * axis[(k + 1) % 3];
	double across = sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
	for (size_t k = 0; k < 3; k++)
		u[k] /= across;
	for (size_t k = 0; k < 3; k++)
		v[k] = axis[(k + 1) % 3] * u[(k + 2) % 3] - axis[(k + 2) % 3] * u[(k + 1) % 3];
	for (int i = 0; i < sides; i++) {
		double p[4][3];
		for (int c = 0; c < 4; c++) {
			double turn = 2.0 * PI * ((i + (c == 1 || c == 2)) % sides) / sides;
			for (size_t k = 0; k < 3; k++)
				p[c][k] =
					(c < 2 ? from : to)[k] + radius[c / 2] * (cos(turn) * u[k] + sin(turn) * v[k]);
		}
		add_quad(b, p);
	}
}

void mesh_make_fence(mesh_builder *b)
{
	static const double wire[2] = { 0.0025, 0.0025 };
	add_floor(b, 1.6, 3.0);
	mesh_set_color(b, 205, 190, 160);
	mesh_add_solid(b, (double[3]){ 0, 0.9, 0.5 }, (double[3]){ 1.4, 0.1, 0.5 }, 0.0);
	mesh_set_color(b, 110, 85, 60);
	for (int i = -1; i <= 1; i++)
		mesh_add_solid(b, (double[3]){ 1.2 * i, 0, 0.65 }, (double[3]){ 0.03, 0.03, 0.65 }, 0.0);
	mesh_set_color(b, 160, 165, 170);
	for (int i = 0; i < 12; i++) {
		double z = 0.1 + 0.1 * i;
		add_rod(b, (double[3]){ -1.2, 0.035, z }, (double[3]){ 1.2, 0.035, z }, wire, 6);
	}
	for (int i = -11; i <= 11; i++)
		add_rod(b, (double[3]){ 0.1 * i, 0.035, 0.05 }, (double[3]){ 0.1 * i, 0.035, 1.25 }, wire,
				6);
	add_sun(b, 0.35, 0.6, -0.6);
	add_sky(b, 0.3f);
	set_stations_around(b, 1.9, 1.2);
}

/* A number in [-1, 1) that belongs to a counter. */
static double scatter(int i)
{
	double x = 0.7548776662466927 * i;
	return 2.0 * (x - floor(x)) - 1.0;
}

/* A leaf: two sheets half a millimetre apart, each seen from its side. */
static void add_leaf(mesh_builder *b, const double middle[3], double turn, double tilt)
{
	const double u[3] = { 0.09 * cos(turn), 0.09 * sin(turn), 0.0 };
	const double v[3] = { -0.06 * sin(turn) * cos(tilt), 0.06 * cos(turn) * cos(tilt),
						  0.06 * sin(tilt) };
	const double n[3] = { sin(turn) * sin(tilt), -cos(turn) * sin(tilt), cos(tilt) };
	double corner[2][3];
	for (size_t k = 0; k < 3; k++) {
		corner[0][k] = middle[k] - 0.5 * (u[k] + v[k]) + 0.00025 * n[k];
		corner[1][k] = corner[0][k] - 0.0005 * n[k];
	}
	mesh_add_patch(b, corner[0], u, v);
	mesh_add_patch(b, corner[1], v, u);
}

void mesh_make_tree(mesh_builder *b)
{
	add_floor(b, 2.0, 4.0);
	mesh_set_color(b, 105, 85, 65);
	add_rod(b, (double[3]){ 0, 0, 0 }, (double[3]){ 0, 0, 2.6 }, (double[2]){ 0.1, 0.03 }, 16);
	for (int i = 0; i < 10; i++) {
		double turn = 2.4 * i, z = 1.3 + 0.12 * i, reach = 0.9 - 0.04 * i;
		add_rod(b, (double[3]){ 0, 0, z },
				(double[3]){ reach * cos(turn), reach * sin(turn), z + 0.35 },
				(double[2]){ 0.025, 0.008 }, 8);
	}
	mesh_set_color(b, 85, 130, 50);
	for (int i = 0, n = 0; n < 700; i++) {
		const double p[3] = { scatter(i), scatter(3 * i + i / 7), scatter(7 * i + i / 11) };
		if (p[0] * p[0] + p[1] * p[1] + p[2] * p[2] > 1.0)
			continue;
		add_leaf(b, (double[3]){ 1.0 * p[0], 1.0 * p[1], 2.1 + 0.8 * p[2] }, 2.4 * i,
				 1.2 * scatter(5 * i));
		n++;
	}
	add_sun(b, 0.35, 0.5, -0.7);
	add_sky(b, 0.3f);
	set_stations_around(b, 2.4, 1.5);
}
