#include "mesh_builder.h"
#include "files/growing_table.h"
#include "points/scan_color.h"
#include "random_numbers.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#define PI 3.14159265358979323846

/* Surface counts as hidden when the place this far in front of it is within a solid. */
#define PROBE 1e-3

void mesh_set_color(mesh_builder *b, int red, int green, int blue)
{
	b->color[0] = (uint8_t)red;
	b->color[1] = (uint8_t)green;
	b->color[2] = (uint8_t)blue;
}

/* ------------------------------------------------------------------------------- geometry */

static void cross(const double a[3], const double b[3], double out[3])
{
	out[0] = a[1] * b[2] - a[2] * b[1];
	out[1] = a[2] * b[0] - a[0] * b[2];
	out[2] = a[0] * b[1] - a[1] * b[0];
}

static double length_of(const double v[3])
{
	return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

void mesh_add_triangle(mesh_builder *b, const double p[3], const double q[3], const double r[3])
{
	mesh_scene *s = b->scene;
	mesh_triangle *grown = growing_table_room(s->triangle, s->count, sizeof *grown);
	if (!grown) {
		b->failed = true;
		return;
	}
	s->triangle = grown;
	mesh_triangle *t = &s->triangle[s->count++];
	double u[3], v[3];
	for (size_t k = 0; k < 3; k++) {
		t->corner[0][k] = p[k];
		t->corner[1][k] = q[k];
		t->corner[2][k] = r[k];
		u[k] = q[k] - p[k];
		v[k] = r[k] - p[k];
		t->color[k] = b->color[k];
		t->albedo[k] = (float)scan_srgb_decode(b->color[k] / 255.0);
		t->emission[k] = b->emission[k];
	}
	cross(u, v, t->normal);
	double length = length_of(t->normal);
	t->area = 0.5 * length;
	for (size_t k = 0; k < 3; k++)
		t->normal[k] /= length;
}

/* A parallelogram whose normal is along u x v. */
void mesh_add_patch(mesh_builder *b, const double corner[3], const double u[3], const double v[3])
{
	double p[4][3];
	for (size_t k = 0; k < 3; k++) {
		p[0][k] = corner[k];
		p[1][k] = corner[k] + u[k];
		p[2][k] = corner[k] + u[k] + v[k];
		p[3][k] = corner[k] + v[k];
	}
	mesh_add_triangle(b, p[0], p[1], p[2]);
	mesh_add_triangle(b, p[0], p[2], p[3]);
}

/* One side of a box from `low` to `high`, seen from inside; side: 0 to 5 for -x +x -y +y -z +z. */
void mesh_add_side(mesh_builder *b, const double low[3], const double high[3], int side)
{
	size_t axis = (size_t)side / 2, a = (axis + 1) % 3, c = (axis + 2) % 3;
	double corner[3] = { low[0], low[1], low[2] }, u[3] = { 0 }, v[3] = { 0 };
	u[a] = high[a] - low[a];
	v[c] = high[c] - low[c];
	if (side % 2 == 0) {
		mesh_add_patch(b, corner, u, v);
	} else {
		corner[axis] = high[axis];
		mesh_add_patch(b, corner, v, u);
	}
}

static void set_bounds(mesh_builder *b, double x, double y, double z)
{
	const double high[3] = { x, y, z };
	memcpy(b->scene->high, high, sizeof high);
	memset(b->scene->low, 0, sizeof b->scene->low);
}

/* A solid block, seen from outside. */
void mesh_add_solid(mesh_builder *b, const double centre[3], const double half[3], double turn)
{
	mesh_scene *s = b->scene;
	mesh_solid *solid = &s->solid[s->solid_count++];
	*solid = (mesh_solid){ .cosine = cos(turn), .sine = sin(turn) };
	memcpy(solid->centre, centre, sizeof solid->centre);
	memcpy(solid->half, half, sizeof solid->half);
	for (size_t side = 0; side < 6; side++) {
		size_t axis = side / 2, a = (axis + 1) % 3, c = (axis + 2) % 3;
		double corner[3], u[3] = { 0 }, v[3] = { 0 }, turned[3][3];
		for (size_t k = 0; k < 3; k++)
			corner[k] = -half[k];
		corner[axis] = side % 2 ? half[axis] : -half[axis];
		u[a] = side % 2 ? 2 * half[a] : 0.0;
		u[c] = side % 2 ? 0.0 : 2 * half[c];
		v[a] = side % 2 ? 0.0 : 2 * half[a];
		v[c] = side % 2 ? 2 * half[c] : 0.0;
		const double *const from[3] = { corner, u, v };
		for (size_t i = 0; i < 3; i++) {
			turned[i][0] = solid->cosine * from[i][0] - solid->sine * from[i][1];
			turned[i][1] = solid->sine * from[i][0] + solid->cosine * from[i][1];
			turned[i][2] = from[i][2];
		}
		for (size_t k = 0; k < 3; k++)
			turned[0][k] += centre[k];
		mesh_add_patch(b, turned[0], turned[1], turned[2]);
	}
}

/* Between two opposite corners. */
static void add_block(mesh_builder *b, const double low[3], const double high[3])
{
	double centre[3], half[3];
	for (size_t k = 0; k < 3; k++) {
		centre[k] = 0.5 * (low[k] + high[k]);
		half[k] = 0.5 * (high[k] - low[k]);
	}
	mesh_add_solid(b, centre, half, 0.0);
}

gw_light *mesh_add_light(mesh_builder *b, gw_light_type type)
{
	gw_light *light = &b->scene->light[b->scene->light_count++];
	*light = (gw_light){ .type = type };
	return light;
}

void mesh_set_stations(mesh_builder *b, const double (*place)[3], size_t count)
{
	assert(count <= MESH_STATIONS);
	memcpy(b->scene->station, place, count * sizeof *place);
	b->scene->station_count = count;
}

void mesh_set_color3(float to[3], float x, float y, float z)
{
	to[0] = x;
	to[1] = y;
	to[2] = z;
}

void mesh_set_place(double to[3], double x, double y, double z)
{
	to[0] = x;
	to[1] = y;
	to[2] = z;
}

/* A ceiling at the top of the bounds with a rectangle in it: eight pieces, the ninth is left to the
 * caller. */
static void add_ceiling_around(mesh_builder *b, double x0, double x1, double y0, double y1)
{
	const double *high = b->scene->high;
	const double x[4] = { 0, x0, x1, high[0] }, y[4] = { 0, y0, y1, high[1] };
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			if (i != 1 || j != 1)
				mesh_add_side(b, (double[3]){ x[i], y[j], 0 },
							  (double[3]){ x[i + 1], y[j + 1], high[2] }, 5);
}

/* --------------------------------------------------------------------------------- scenes */

static void make_cornell(mesh_builder *b)
{
	set_bounds(b, 3.0, 3.0, 2.7);
	const double *low = b->scene->low, *high = b->scene->high;
	mesh_set_color(b, 220, 215, 205);
	mesh_add_side(b, low, high, 4);
	mesh_add_side(b, low, high, 3);
	add_ceiling_around(b, 1.1, 1.9, 1.2, 1.9);
	mesh_set_color(b, 200, 40, 35);
	mesh_add_side(b, low, high, 0);
	mesh_set_color(b, 50, 180, 60);
	mesh_add_side(b, low, high, 1);
	mesh_set_color(b, 215, 210, 220);
	mesh_add_solid(b, (double[3]){ 0.95, 2.0, 0.75 }, (double[3]){ 0.4, 0.4, 0.75 }, 0.3);
	mesh_add_solid(b, (double[3]){ 2.05, 1.0, 0.4 }, (double[3]){ 0.4, 0.4, 0.4 }, -0.3);
	mesh_set_color(b, 120, 120, 120);
	mesh_set_color3(b->emission, 12.0f, 10.0f, 7.0f);
	mesh_add_side(b, (double[3]){ 1.1, 1.2, 0 }, (double[3]){ 1.9, 1.9, 2.7 }, 5);
	static const double place[][3] = { { 1.5, 0.4, 1.4 },
									   { 0.5, 0.5, 1.0 },
									   { 2.5, 0.4, 1.2 },
									   { 2.5, 2.5, 1.6 },
									   { 0.4, 1.2, 1.5 } };
	mesh_set_stations(b, place, sizeof place / sizeof *place);
}

/* All six sides of the bounds. */
static void add_room(mesh_builder *b)
{
	for (int side = 0; side < 6; side++) {
		if (side == 4)
			mesh_set_color(b, 170, 150, 130);
		mesh_add_side(b, b->scene->low, b->scene->high, side);
		if (side == 4)
			mesh_set_color(b, 215, 215, 210);
	}
}

static void make_rooms(mesh_builder *b)
{
	set_bounds(b, 6.0, 4.0, 2.5);
	mesh_set_color(b, 225, 205, 180);
	add_room(b);
	mesh_set_color(b, 190, 205, 220);
	add_block(b, (double[]){ 2.95, 0.0, 0.0 }, (double[]){ 3.05, 1.5, 2.5 });
	add_block(b, (double[]){ 2.95, 2.4, 0.0 }, (double[]){ 3.05, 4.0, 2.5 });
	add_block(b, (double[]){ 2.95, 1.5, 2.0 }, (double[]){ 3.05, 2.4, 2.5 });
	mesh_set_color(b, 200, 120, 80);
	mesh_add_solid(b, (double[3]){ 4.6, 2.2, 0.375 }, (double[3]){ 0.5, 0.35, 0.375 }, 0.5);
	gw_light *lamp = mesh_add_light(b, GW_LIGHT_POINT);
	mesh_set_place(lamp->position, 1.3, 2.7, 1.7);
	mesh_set_color3(lamp->intensity, 9.0f, 8.0f, 6.0f);
	static const double place[][3] = { { 1.0, 1.0, 1.3 },
									   { 1.3, 3.3, 1.3 },
									   { 2.2, 2.0, 1.3 },
									   { 4.0, 1.0, 1.3 },
									   { 5.3, 3.2, 1.3 } };
	mesh_set_stations(b, place, sizeof place / sizeof *place);
}

static void make_corridor(mesh_builder *b)
{
	set_bounds(b, 5.0, 3.6, 2.2);
	mesh_set_color(b, 225, 215, 195);
	add_room(b);
	mesh_set_color(b, 205, 190, 170);
	add_block(b, (double[]){ 0.0, 1.0, 0.0 }, (double[]){ 4.0, 1.3, 2.2 });
	add_block(b, (double[]){ 1.0, 2.3, 0.0 }, (double[]){ 5.0, 2.6, 2.2 });
	gw_light *lamp = mesh_add_light(b, GW_LIGHT_POINT);
	mesh_set_place(lamp->position, 2.6, 0.5, 1.3);
	mesh_set_color3(lamp->intensity, 4.0f, 3.6f, 3.0f);
	static const double place[][3] = { { 0.5, 0.5, 1.3 },
									   { 1.7, 0.5, 1.3 },
									   { 4.5, 1.1, 1.3 },
									   { 2.5, 1.8, 1.3 },
									   { 3.5, 3.1, 1.3 } };
	mesh_set_stations(b, place, sizeof place / sizeof *place);
}

static void make_hole(mesh_builder *b)
{
	set_bounds(b, 4.0, 3.0, 2.5);
	mesh_set_color(b, 225, 215, 200);
	for (int side = 0; side < 5; side++) {
		if (side == 1)
			mesh_set_color(b, 190, 90, 70);
		mesh_add_side(b, b->scene->low, b->scene->high, side);
		mesh_set_color(b, 225, 215, 200);
	}
	add_ceiling_around(b, 1.2, 1.8, 1.2, 1.8);
	b->scene->opening = (mesh_opening){ .corner = { 1.2, 1.2, 2.5 },
										.u = { 0.6, 0, 0 },
										.v = { 0, 0.6, 0 },
										.normal = { 0, 0, -1 },
										.area = 0.36 };
	mesh_set_color(b, 160, 170, 180);
	mesh_add_solid(b, (double[3]){ 2.9, 1.9, 0.45 }, (double[3]){ 0.35, 0.35, 0.45 }, 0.4);
	gw_light *sun = mesh_add_light(b, GW_LIGHT_SUN);
	mesh_set_place(sun->direction, 0.5, -0.15, -1.0);
	mesh_set_color3(sun->irradiance, 12.0f, 11.0f, 9.5f);
	sun->angle = 0.53f;
	mesh_set_color3(mesh_add_light(b, GW_LIGHT_ENVIRONMENT)->radiance, 1.5f, 2.0f, 3.0f);
	static const double place[][3] = { { 0.7, 0.7, 1.3 },
									   { 3.3, 0.7, 1.3 },
									   { 0.7, 2.3, 1.3 },
									   { 3.5, 2.6, 1.3 },
									   { 2.0, 1.0, 1.2 } };
	mesh_set_stations(b, place, sizeof place / sizeof *place);
}

static void make_ruin(mesh_builder *b)
{
	set_bounds(b, 12.0, 12.0, 6.0);
	mesh_set_color(b, 150, 145, 105);
	mesh_add_side(b, b->scene->low, b->scene->high, 4);
	mesh_set_color(b, 205, 185, 150);
	add_block(b, (double[]){ 3.0, 3.0, 0.0 }, (double[]){ 3.5, 9.0, 3.2 });
	add_block(b, (double[]){ 3.5, 8.5, 0.0 }, (double[]){ 5.5, 9.0, 2.4 });
	add_block(b, (double[]){ 6.6, 8.5, 0.0 }, (double[]){ 9.0, 9.0, 2.4 });
	add_block(b, (double[]){ 5.2, 8.5, 2.4 }, (double[]){ 7.0, 9.0, 2.9 });
	add_block(b, (double[]){ 8.5, 5.5, 0.0 }, (double[]){ 9.0, 8.5, 1.3 });
	add_block(b, (double[]){ 3.5, 3.0, 0.0 }, (double[]){ 6.0, 3.5, 0.7 });
	mesh_set_color(b, 180, 150, 120);
	mesh_add_solid(b, (double[3]){ 6.2, 6.0, 1.2 }, (double[3]){ 0.25, 0.25, 1.2 }, 0.2);
	mesh_add_solid(b, (double[3]){ 7.6, 3.8, 0.35 }, (double[3]){ 0.5, 0.7, 0.35 }, 0.7);
	gw_light *sun = mesh_add_light(b, GW_LIGHT_SUN);
	mesh_set_place(sun->direction, 0.6, 0.35, -0.55);
	mesh_set_color3(sun->irradiance, 3.0f, 2.7f, 2.2f);
	sun->angle = 0.53f;
	mesh_set_color3(mesh_add_light(b, GW_LIGHT_ENVIRONMENT)->radiance, 0.25f, 0.35f, 0.5f);
	static const double place[][3] = { { 1.2, 6.0, 1.6 },
									   { 6.5, 1.5, 1.6 },
									   { 10.5, 7.0, 1.6 },
									   { 6.0, 10.8, 1.6 },
									   { 7.3, 6.6, 1.6 } };
	mesh_set_stations(b, place, sizeof place / sizeof *place);
}

/* ----------------------------------------------------------------------------------- cave */

static double lattice_value(int64_t x, int64_t y, int64_t z)
{
	uint64_t h = (uint64_t)x * 0x9e3779b97f4a7c15u ^ (uint64_t)y * 0xc2b2ae3d27d4eb4fu ^
				 (uint64_t)z * 0x165667b19e3779f9u;
	h = (h ^ (h >> 30)) * 0xbf58476d1ce4e5b9u;
	h = (h ^ (h >> 27)) * 0x94d049bb133111ebu;
	return (double)((h ^ (h >> 31)) >> 11) * 0x1p-52 - 1.0;
}

/* Smooth noise in [-1, 1]: random values on a lattice, interpolated by smoothstep. */
double mesh_smooth_noise(const double p[3])
{
	double base[3], weight[3], sum = 0.0;
	for (size_t k = 0; k < 3; k++) {
		base[k] = floor(p[k]);
		double t = p[k] - base[k];
		weight[k] = t * t * (3.0 - 2.0 * t);
	}
	for (int c = 0; c < 8; c++) {
		double w = 1.0;
		for (int k = 0; k < 3; k++)
			w *= c >> k & 1 ? weight[k] : 1.0 - weight[k];
		sum += w * lattice_value((int64_t)base[0] + (c & 1), (int64_t)base[1] + (c >> 1 & 1),
								 (int64_t)base[2] + (c >> 2 & 1));
	}
	return sum;
}

/* The place on the cave's wall in a direction from its middle. */
static void cave_wall(const double direction[3], double out[3])
{
	static const double radius[3] = { 4.0, 2.6, 1.7 };
	double length = length_of(direction), bump = 1.0, strength = 0.35;
	for (double frequency = 2.0; frequency < 30.0; frequency *= 2.1) {
		double p[3];
		for (size_t k = 0; k < 3; k++)
			p[k] = direction[k] / length * radius[k] * frequency * 0.4 + 17.3;
		bump += strength * mesh_smooth_noise(p);
		strength *= 0.45;
	}
	for (size_t k = 0; k < 3; k++)
		out[k] = direction[k] / length * radius[k] * bump;
}

/* One triangle of the cave; its colour follows noise at its middle. */
static void add_cave_triangle(mesh_builder *b, const double p[3], const double q[3],
							  const double r[3])
{
	double a[3], c[3], d[3], middle[3];
	cave_wall(p, a);
	cave_wall(q, c);
	cave_wall(r, d);
	for (size_t k = 0; k < 3; k++)
		middle[k] = (a[k] + c[k] + d[k]) * 0.4 + 5.0;
	double grey = 165.0 + 45.0 * mesh_smooth_noise(middle);
	mesh_set_color(b, (int)(grey + 15.0), (int)grey, (int)(grey - 20.0));
	mesh_add_triangle(b, a, d, c); /* turned inwards */
}

/* Splits a face of the octahedron into n x n triangles. */
static void add_cave_face(mesh_builder *b, const double p[3], const double q[3], const double r[3],
						  int n)
{
	for (int i = 0; i < n; i++) {
		for (int j = 0; j < 2 * (n - i) - 1; j++) {
			/* Rows from p; even ones point to p, odd ones away. */
			int column = j / 2, odd = j % 2;
			const int grid[2][3][2] = {
				{ { i, column }, { i + 1, column }, { i, column + 1 } },
				{ { i + 1, column }, { i + 1, column + 1 }, { i, column + 1 } }
			};
			double corner[3][3];
			for (size_t c = 0; c < 3; c++) {
				double u = (double)grid[odd][c][0] / n, v = (double)grid[odd][c][1] / n;
				for (size_t k = 0; k < 3; k++)
					corner[c][k] = p[k] + u * (q[k] - p[k]) + v * (r[k] - p[k]);
			}
			add_cave_triangle(b, corner[0], corner[1], corner[2]);
		}
	}
}

static void make_cave(mesh_builder *b)
{
	static const double x[3] = { 1, 0, 0 }, y[3] = { 0, 1, 0 }, z[3] = { 0, 0, 1 };
	for (int octant = 0; octant < 8; octant++) {
		double a[3], c[3], d[3];
		for (size_t k = 0; k < 3; k++) {
			a[k] = octant & 1 ? -x[k] : x[k];
			c[k] = octant & 2 ? -y[k] : y[k];
			d[k] = octant & 4 ? -z[k] : z[k];
		}
		bool mirrored = (octant & 1) ^ (octant >> 1 & 1) ^ (octant >> 2 & 1);
		add_cave_face(b, a, mirrored ? d : c, mirrored ? c : d, 56);
	}
	for (size_t k = 0; k < 3; k++) {
		b->scene->low[k] = -10.0;
		b->scene->high[k] = 10.0;
	}
	gw_light *lamp = mesh_add_light(b, GW_LIGHT_POINT);
	mesh_set_place(lamp->position, 1.6, 0.4, -0.2);
	mesh_set_color3(lamp->intensity, 7.0f, 5.5f, 3.5f);
	gw_light *spot = mesh_add_light(b, GW_LIGHT_SPOT);
	mesh_set_place(spot->position, -0.6, -0.3, 0.2);
	mesh_set_place(spot->direction, -1.0, 0.25, -0.2);
	mesh_set_color3(spot->intensity, 20.0f, 22.0f, 26.0f);
	spot->inner_angle = 20.0f;
	spot->outer_angle = 35.0f;
	static const double place[][3] = { { 0.0, 0.0, -0.3 },
									   { 1.8, 0.3, -0.2 },
									   { -1.8, -0.2, -0.2 },
									   { 0.5, 0.9, -0.3 },
									   { -0.5, -0.9, 0.0 } };
	mesh_set_stations(b, place, sizeof place / sizeof *place);
}

const char *mesh_kind_name(int kind)
{
	static const char *const name[] = {
		[MESH_CORNELL] = "cornell", [MESH_ROOMS] = "rooms",   [MESH_CORRIDOR] = "corridor",
		[MESH_HOLE] = "hole",       [MESH_RUIN] = "ruin",     [MESH_CAVE] = "cave",
		[MESH_BALL] = "ball",       [MESH_CARTON] = "carton", [MESH_TORUS] = "torus",
		[MESH_TERRAIN] = "terrain", [MESH_FENCE] = "fence",   [MESH_TREE] = "tree",
		[MESH_KINDS] = NULL,
	};
	return name[kind];
}

gw_status mesh_scene_make(mesh_kind kind, mesh_scene *scene, gw_error *error)
{
	static void (*const make[MESH_KINDS])(mesh_builder *) = {
		make_cornell,    make_rooms,        make_corridor,   make_hole,
		make_ruin,       make_cave,         mesh_make_ball,  mesh_make_carton,
		mesh_make_torus, mesh_make_terrain, mesh_make_fence, mesh_make_tree,
	};
	*scene = (mesh_scene){ 0 };
	mesh_builder b = { .scene = scene };
	make[kind](&b);
	if (!b.failed)
		return GW_OK;
	mesh_scene_clear(scene);
	return gw_fail(error, GW_ERROR_MEMORY, "no memory for the scene's triangles");
}

void mesh_scene_clear(mesh_scene *scene)
{
	free(scene->triangle);
	*scene = (mesh_scene){ 0 };
}

/* ------------------------------------------------------------------------------- sampling */

static bool is_inside(const mesh_solid *solid, const double p[3])
{
	double x = p[0] - solid->centre[0], y = p[1] - solid->centre[1];
	double local[3] = { solid->cosine * x + solid->sine * y, solid->cosine * y - solid->sine * x,
						p[2] - solid->centre[2] };
	return fabs(local[0]) < solid->half[0] && fabs(local[1]) < solid->half[1] &&
		   fabs(local[2]) < solid->half[2];
}

static bool is_hidden(const mesh_scene *s, const double p[3], const double normal[3])
{
	double probe[3];
	for (size_t k = 0; k < 3; k++) {
		probe[k] = p[k] + PROBE * normal[k];
		if (probe[k] < s->low[k] || probe[k] > s->high[k])
			return true;
	}
	for (size_t i = 0; i < s->solid_count; i++)
		if (is_inside(&s->solid[i], probe))
			return true;
	return false;
}

/* A place on a triangle for two numbers in [0, 1). */
static void place_on(const mesh_triangle *t, double a, double b, double out[3])
{
	if (a + b > 1.0) {
		a = 1.0 - a;
		b = 1.0 - b;
	}
	for (size_t k = 0; k < 3; k++)
		out[k] = t->corner[0][k] + a * (t->corner[1][k] - t->corner[0][k]) +
				 b * (t->corner[2][k] - t->corner[0][k]);
}

/* The share of points that a scanner in the middle of the scene finds at a place: they thin out
 * with the square of the distance and the cosine; what it cannot see is seen from elsewhere. */
static double scanned_share(const mesh_scene *s, double uneven, const double p[3],
							const double normal[3])
{
	double across = 0.0, square = 0.0, facing = 0.0;
	for (size_t k = 0; k < 3; k++) {
		double side = s->high[k] - s->low[k], to = 0.5 * (s->low[k] + s->high[k]) - p[k];
		across += side * side;
		square += to * to;
		facing += to * normal[k];
	}
	/* Whole at a fifth of the scene's diagonal. */
	double share = 0.04 * across * facing / (square * sqrt(square));
	return share > 1.0 ? 1.0 : share > 1.0 / uneven ? share : 1.0 / uneven;
}

/* Places on all triangles, `density` a square metre before hidden ones are left out. With out NULL
 * they are only counted. */
static size_t place_points(const mesh_scene *s, const mesh_sampling *how, double density,
						   mesh_points *out)
{
	uint64_t state = how->seed * 0x2545f4914f6cdd1du + 1;
	double due = random_number(&state);
	size_t n = 0;
	for (size_t t = 0; t < s->count; t++) {
		const mesh_triangle *triangle = &s->triangle[t];
		double turn[2] = { random_number(&state), random_number(&state) };
		due += triangle->area * density;
		for (size_t i = 1; due >= 1.0; due -= 1.0, i++) {
			/* The sequence of the plastic number (Roberts 2018), or independent numbers. */
			double a = how->even ? turn[0] + 0.7548776662466927 * (double)i : random_number(&state);
			double b = how->even ? turn[1] + 0.5698402909980532 * (double)i : random_number(&state);
			double place[3];
			place_on(triangle, a - floor(a), b - floor(b), place);
			if (is_hidden(s, place, triangle->normal))
				continue;
			if (how->uneven > 0.0 &&
				random_number(&state) >= scanned_share(s, how->uneven, place, triangle->normal))
				continue;
			if (out && n == out->count)
				return n;
			if (out) {
				memcpy(out->surface + 3 * n, place, sizeof place);
				out->triangle[n] = (uint32_t)t;
			}
			n++;
		}
	}
	return n;
}

/* Two unit vectors at right angles to a unit vector and to each other. */
static void make_axes(const double n[3], double u[3], double v[3])
{
	double other[3] = { fabs(n[0]) < 0.6, fabs(n[0]) >= 0.6, 0 };
	cross(n, other, u);
	double length = length_of(u);
	for (size_t k = 0; k < 3; k++)
		u[k] /= length;
	cross(n, u, v);
}

/* Moves points along their normals and turns the normals. */
static void add_noise(const mesh_scene *s, const mesh_sampling *how, mesh_points *points)
{
	uint64_t state = how->seed ^ 0x6a09e667f3bcc908u;
	for (size_t i = 0; i < points->count; i++) {
		const double *n = s->triangle[points->triangle[i]].normal;
		double u[3], v[3], turned[3];
		make_axes(n, u, v);
		double shift = how->noise * points->spacing * random_normal(&state);
		double tilt_u = tan(how->normal_noise * PI / 180.0) * random_normal(&state);
		double tilt_v = tan(how->normal_noise * PI / 180.0) * random_normal(&state);
		for (size_t k = 0; k < 3; k++) {
			points->position[3 * i + k] = points->surface[3 * i + k] + shift * n[k];
			turned[k] = n[k] + tilt_u * u[k] + tilt_v * v[k];
		}
		double length = length_of(turned);
		for (size_t k = 0; k < 3; k++)
			points->normal[3 * i + k] = (float)(turned[k] / length);
	}
}

gw_status mesh_points_make(const mesh_scene *s, const mesh_sampling *how, mesh_points *points,
						   gw_error *error)
{
	double area = 0.0;
	for (size_t t = 0; t < s->count; t++)
		area += s->triangle[t].area;
	/* How much of the surface is visible is not known before it is sampled. */
	double density = 4.0 * (double)how->count / area;
	size_t trial = place_points(s, how, density, NULL);
	double visible = (double)trial / density;
	density = (double)how->count / visible;
	*points = (mesh_points){ .spacing = sqrt(1.0 / density) };
	points->count = place_points(s, how, density, NULL);
	size_t n = points->count + 1;
	points->position = reallocarray(NULL, n, 3 * sizeof *points->position);
	points->surface = reallocarray(NULL, n, 3 * sizeof *points->surface);
	points->normal = reallocarray(NULL, n, 3 * sizeof *points->normal);
	points->triangle = reallocarray(NULL, n, sizeof *points->triangle);
	if (!points->position || !points->surface || !points->normal || !points->triangle) {
		mesh_points_clear(points);
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu points", n);
	}
	place_points(s, how, density, points);
	add_noise(s, how, points);
	return GW_OK;
}

void mesh_points_clear(mesh_points *points)
{
	free(points->position);
	free(points->surface);
	free(points->normal);
	free(points->triangle);
	*points = (mesh_points){ 0 };
}
