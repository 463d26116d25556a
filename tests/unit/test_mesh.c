/*
 * Meshes: even sampling against closed forms, faces as triangles, readers, matrices, attributes.
 */
#include "glb_file.h"
#include "files/input_file.h"
#include "meshes/mesh.h"
#include "meshes/mesh_sample.h"
#include "points/scan_color.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static gw_status read_text(const char *text, mesh *m, gw_error *error)
{
	input_file in = { .name = "seed.obj", .data = (const uint8_t *)text, .length = strlen(text) };
	if (strncmp(text, "ply", 3) == 0)
		return mesh_ply_read(&in, m, error);
	if (mesh_off_probe(in.data, in.length))
		return mesh_off_read(&in, m, error);
	return mesh_obj_read(&in, "-", m, error);
}

/* Reads and measures what has to be good. */
static mesh read_good(const char *text)
{
	mesh m;
	gw_error error = { 0 };
	if (read_text(text, &m, &error) != GW_OK || mesh_measure(&m, "seed.obj", &error) != GW_OK)
		fail_msg("%s", error.text);
	return m;
}

static void assert_refused(const char *text, const char *sentence)
{
	mesh m;
	gw_error error = { 0 };
	assert_int_equal(read_text(text, &m, &error), GW_ERROR_DATA);
	if (!strstr(error.text, sentence) || !strstr(error.text, "seed.obj"))
		fail_msg("'%s' does not say '%s'", error.text, sentence);
	assert_null(m.position);
}

static double value(const scan *cloud, const char *name, size_t i)
{
	const scan_column *column = scan_find(cloud, name);
	assert_non_null(column);
	return scan_value(column, i);
}

/* --------------------------------------------------------------------------- even sampling */

/* Four triangles with areas 0.3, 0.5, 0, 1.7. */
#define AREAS                                                                                      \
	"v 0 0 0\nv 1 0 0\nv 0 0.6 0\nv 0 1 0\nv 0 3.4 0\nv 2 0 0\n"                                   \
	"f 1 2 3\nf 1 2 4\nf 1 2 6\nf 1 2 5\n"

static void areas_are_summed(void **state)
{
	(void)state;
	static const double expected[] = { 0.3, 0.8, 0.8, 2.5 };
	mesh m = read_good(AREAS);
	assert_int_equal(m.triangle_count, 4);
	assert_int_equal(m.degenerate, 1);
	/* Three sums of doubles. */
	for (int t = 0; t < 4; t++)
		assert_true(fabs(m.area_sum[t] - expected[t]) < 4 * 0x1p-52 * 2.5);
	mesh_clear(&m);
}

/* The density of every face is that of the whole to less than two points: the strata inside of its
 * stretch of area hold one each, and the two at its ends at most one. */
static void every_face_has_its_share(void **state)
{
	(void)state;
	mesh m = read_good(AREAS);
	for (uint64_t seed = 0; seed < 50; seed++) {
		size_t count = 1000 + seed, found[4] = { 0 };
		for (size_t i = 0; i < count; i++)
			found[gw_mesh_place_of(m.area_sum, 4, count, seed, i).triangle]++;
		assert_int_equal(found[2], 0);
		for (int t = 0; t < 4; t++) {
			double before = t ? m.area_sum[t - 1] : 0.0;
			double share = (m.area_sum[t] - before) / m.area * (double)count;
			assert_true(fabs((double)found[t] - share) < 2.0);
		}
	}
	mesh_clear(&m);
}

/*
 * With 7 strata the second face's stretch of area, 0.84 to 2.24 strata, holds all of the stratum 1,
 * 0.16 of the stratum 0 and 0.24 of the stratum 2. So it has 1 + B(0.16) + B(0.24) points:
 * mean 1.4, variance 0.16 * 0.84 + 0.24 * 0.76.
 */
static void strata_have_the_closed_form(void **state)
{
	(void)state;
	const double p[2] = { 0.16, 0.24 };
	const size_t turns = 100000;
	mesh m = read_good(AREAS);
	double sum = 0.0, squares = 0.0, v[2], fourth[2];
	for (size_t seed = 0; seed < turns; seed++) {
		double found = 0.0;
		for (size_t i = 0; i < 7; i++)
			found += gw_mesh_place_of(m.area_sum, 4, 7, seed, i).triangle == 1;
		sum += found;
		squares += (found - 1.4) * (found - 1.4);
	}
	for (int k = 0; k < 2; k++) {
		v[k] = p[k] * (1.0 - p[k]);
		fourth[k] = v[k] * (1.0 - 3.0 * v[k]);
	}
	double variance = v[0] + v[1], n = (double)turns;
	double fourth_moment = fourth[0] + fourth[1] + 6.0 * v[0] * v[1];
	/* Four standard errors each: one in 16,000 right programs would fail, and ours always or
	 * never, as the seeds are fixed. */
	assert_true(fabs(sum / n - 1.4) < 4.0 * sqrt(variance / n));
	assert_true(fabs(squares / n - variance) <
				4.0 * sqrt((fourth_moment - variance * variance) / n));
	mesh_clear(&m);
}

/*
 * Within a triangle: mean weights 1/3, mean squares 1/6. Independent points would be off by their
 * standard deviation over sqrt(n), sqrt(1/18 / n); a lattice is off by about log(n) / n, of which
 * the bound leaves no doubt: 10 / n.
 */
static void triangles_are_covered_evenly(void **state)
{
	(void)state;
	const size_t n = 20000;
	mesh m = read_good("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
	double mean[3] = { 0 }, square[3] = { 0 };
	for (size_t i = 0; i < n; i++) {
		gw_mesh_place place = gw_mesh_place_of(m.area_sum, 1, n, 3, i);
		double total = 0.0;
		for (int c = 0; c < 3; c++) {
			assert_true(place.weight[c] >= 0.0 && place.weight[c] <= 1.0);
			total += place.weight[c];
			mean[c] += place.weight[c] / (double)n;
			square[c] += place.weight[c] * place.weight[c] / (double)n;
		}
		/* Three roundings. */
		assert_true(fabs(total - 1.0) <= 4 * 0x1p-53);
	}
	for (int c = 0; c < 3; c++) {
		assert_true(fabs(mean[c] - 1.0 / 3.0) < 10.0 / (double)n);
		assert_true(fabs(square[c] - 1.0 / 6.0) < 10.0 / (double)n);
	}
	mesh_clear(&m);
}

static void threads_do_not_matter(void **state)
{
	(void)state;
	gw_error error;
	scan a, b, c;
	mesh m = read_good(AREAS);
	assert_int_equal(mesh_sample(&m, 20000, 5, 1, &a, &error), GW_OK);
	assert_int_equal(mesh_sample(&m, 20000, 5, 7, &b, &error), GW_OK);
	assert_int_equal(mesh_sample(&m, 20000, 6, 7, &c, &error), GW_OK);
	bool other = false;
	for (size_t k = 0; k < a.column_count; k++) {
		size_t bytes = a.count * scan_type_size(a.column[k].type);
		assert_memory_equal(a.column[k].data, b.column[k].data, bytes);
		other = other || memcmp(a.column[k].data, c.column[k].data, bytes) != 0;
	}
	assert_true(other);
	scan_clear(&a);
	scan_clear(&b);
	scan_clear(&c);
	mesh_clear(&m);
}

/* ---------------------------------------------------------------------------------- faces */

/* Areas are exact in binary, so a wrong triangle shows. */
static void polygons_are_cut(void **state)
{
	(void)state;
	static const struct {
		const char *text;
		size_t triangles, crossed;
		double area;
	} cases[] = {
		{ "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nf 1 2 3 4\n", 2, 0, 4 },
		/* An L, whose fan from its first corner would be wrong, in each of the three planes. */
		{ "v 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nv 0 0 0\nv 2 0 0\nf 1 2 3 4 5 6\n", 4, 0, 3 },
		{ "v 2 0 1\nv 1 0 1\nv 1 0 2\nv 0 0 2\nv 0 0 0\nv 2 0 0\nf 6 5 4 3 2 1\n", 4, 0, 3 },
		{ "v 0 2 1\nv 0 1 1\nv 0 1 2\nv 0 0 2\nv 0 0 0\nv 0 2 0\nf 1 2 3 4 5 6\n", 4, 0, 3 },
		/* An arrow whose notch lies on the diagonal of its fan's side. */
		{ "v 4 4 0\nv 1 2 0\nv 4 0 0\nv 0 2 0\nf 1 2 3 4\n", 2, 0, 2 },
		/* A ring with a slit, as exporters write holes: corners are there twice. */
		{ "v 0 0 0\nv 4 0 0\nv 4 4 0\nv 0 4 0\nv 1 1 0\nv 1 3 0\nv 3 3 0\nv 3 1 0\n"
		  "f 1 2 3 4 1 5 6 7 8 5\n",
		  8, 0, 12 },
		/* Edges that cross: said so, not lost. */
		{ "v 0 0 0\nv 2 2 0\nv 2 0 0\nv 0 2 0\nv 0 1 0\nf 1 2 3 4 5\nf 1 2 3\n", 4, 1, -1 },
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		mesh m = read_good(cases[i].text);
		assert_int_equal(m.triangle_count, cases[i].triangles);
		assert_int_equal(m.faces_crossed, cases[i].crossed);
		if (cases[i].area > 0 && m.area != cases[i].area)
			fail_msg("case %zu: area %g, not %g", i, m.area, cases[i].area);
		mesh_clear(&m);
	}
}

static void indices_lead_back_and_forth(void **state)
{
	(void)state;
	mesh m = read_good("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\n"
					   "f -3//-1 -2//-1 \\\n -1//1 # a comment\nf 1/9/1 2/9/1 3/9/1\nf 1 2\n");
	assert_int_equal(m.faces, 4);
	assert_int_equal(m.faces_flat, 1);
	assert_int_equal(m.triangle_count, 3);
	for (uint32_t i = 0; i < 9; i++) {
		assert_int_equal(m.corner[i], i % 3);
		assert_int_equal(m.corner_normal[i], i < 3 ? MESH_NONE : 0);
	}
	mesh_clear(&m);
}

#define PLY                                                                                        \
	"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"                \
	"property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"       \
	"0 0 0\n1 0 0\n0 1 0\n"

static void bad_meshes_are_refused(void **state)
{
	(void)state;
	assert_refused("v 0 0 0\nv 1 0 0\nf 1 2 3\n", "line 3: '3' leads to no vertex; there are 2");
	assert_refused("v 0 0 0\nf 0 0 0\n", "line 2: '0' leads to no vertex");
	assert_refused("v 0 0 0\nf -1 -2 -1\nv 1 1 1\n", "'-2' leads to no vertex; there are 1 above");
	assert_refused("v 0 0 0\nf 1//1 1 1\n", "'1//1' leads to no normal");
	assert_refused("v 0 0 0\nf 1x 1 1\n", "'1x' where the indices of a corner");
	assert_refused("v 0 0 0\nf 99999999999999999999 1 1\n", "line 2: '99999999999999999999'");
	assert_refused("v 0 zero 0\n", "line 1: 'zero' where a coordinate");
	assert_refused("v 0 0\n", "line 1: a vertex needs");
	assert_refused("v 0 0 0\n", "holds no faces");
	assert_refused("", "holds no faces");
	assert_refused(PLY "3 0 1 3\n", "face number 0 leads to vertex 3; there are 3");
	assert_refused(PLY "3 0 1 -1\n", "leads to vertex -1");
	assert_refused(PLY "3 0 1\n", "face number 0 is missing or cut short");
	assert_refused(PLY "200 0 1 2\n", "longer than the file");
	mesh m = read_good(PLY "3 0 1 2\n");
	assert_true(m.area == 0.5);
	mesh_clear(&m);
	gw_error error = { 0 };
	assert_int_equal(read_text("v 0 0 0\nv nan 0 0\nv 2 0 0\nf 1 1 3\nf 1 2 3\n", &m, &error),
					 GW_OK);
	assert_int_equal(mesh_measure(&m, "seed.obj", &error), GW_ERROR_DATA);
	assert_non_null(strstr(error.text, "none of its 2 triangles has an area"));
	mesh_clear(&m);
}

/* ----------------------------------------------------------------------------- attributes */

static void colors_and_normals_are_interpolated(void **state)
{
	(void)state;
	gw_error error;
	scan cloud;
	/* Red grows with x in linear light; the normals spread. */
	mesh m = read_good("v 0 0 0 0 0 0\nv 1 0 0 1 0 0\nv 0 1 0 0 0 1\n"
					   "vn -1 0 1\nvn 2 0 2\nvn 0 0 7\nf 1//1 2//2 3//3\n");
	assert_int_equal(mesh_sample(&m, 500, 1, 1, &cloud, &error), GW_OK);
	for (size_t i = 0; i < cloud.count; i++) {
		double x = value(&cloud, "x", i), y = value(&cloud, "y", i);
		double red = scan_srgb_decode(value(&cloud, "red", i) / 255.0);
		/* Half a step of 8 bits, where the curve is steepest: 2.3 linear a unit encoded. */
		assert_true(fabs(red - x) < 2.3 * 0.5 / 255.0 + 1e-6);
		assert_true(value(&cloud, "green", i) == 0.0);
		double w = sqrt(0.5), nx = w * (x - (1.0 - x - y)), nz = w * (1.0 - y) + y;
		double length = sqrt(nx * nx + nz * nz);
		/* Positions and normals are float32. */
		assert_true(fabs(value(&cloud, "nx", i) - nx / length) < 4e-7);
		assert_true(fabs(value(&cloud, "nz", i) - nz / length) < 4e-7);
	}
	scan_clear(&cloud);
	mesh_clear(&m);
}

/* Scaling counts in the area; mirroring leaves the normals of a closed surface outside. */
static void matrices_move_meshes(void **state)
{
	(void)state;
	static const char cube[] = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\n"
							   "v 0 1 1\nf 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\n"
							   "vn -1 0 0\nf 4//1 1//1 5//1 8//1\n";
	static const double matrix[16] = { -2, 0, 0, 10, 0, 3, 0, 20, 0, 0, 1, 5000, 0, 0, 0, 1 };
	const double centre[3] = { 9, 21.5, 5000.5 };
	static const char *const names[6] = { "x", "y", "z", "nx", "ny", "nz" };
	gw_error error;
	scan cloud;
	mesh m;
	assert_int_equal(read_text(cube, &m, &error), GW_OK);
	mesh_transform(&m, matrix);
	assert_int_equal(mesh_measure(&m, "seed.obj", &error), GW_OK);
	assert_true(m.area == 2 * (2 * 3 + 2 * 1 + 3 * 1));
	assert_int_equal(mesh_sample(&m, 1000, 1, 1, &cloud, &error), GW_OK);
	assert_int_equal(scan_find(&cloud, "x")->type, SCAN_FLOAT64);
	for (size_t i = 0; i < cloud.count; i++) {
		double outward = 0.0;
		for (int k = 0; k < 3; k++)
			outward += (value(&cloud, names[k], i) - centre[k]) * value(&cloud, names[3 + k], i);
		/* Half an edge: 1, 1.5 or 0.5. */
		assert_true(outward > 0.49);
	}
	scan_clear(&cloud);
	mesh_clear(&m);
}

static void materials_become_columns(void **state)
{
	(void)state;
	static const char text[] = "newmtl shiny # one\nKd 0.25\nKs 0.5 0.5 0.5\nNs 30\n"
							   "newmtl hot #25\nKd 0 1 0\nKe 3 2 1\nmap_Kd bricks.png\n";
	input_file in = { .name = "seed.mtl", .data = (const uint8_t *)text, .length = strlen(text) };
	gw_error error;
	scan cloud;
	mesh m = read_good("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 3\nf 1 2 3\n");
	assert_int_equal(mesh_mtl_read(&in, &m, &error), GW_OK);
	assert_int_equal(mesh_find_material(&m, "hot #25", 7), 1);
	assert_int_equal(mesh_find_material(&m, "hot", 3), MESH_NONE);
	assert_non_null(strstr(m.note[m.note_count - 1], "seed.mtl names 1 texture,"));
	m.face_material[0] = 0;
	m.face_material[1] = 1;
	assert_int_equal(mesh_sample(&m, 3, 1, 1, &cloud, &error), GW_OK);
	/* One point on each face. sRGB codes of 0.25, 0 and 1, 0.5: 137, 0 and 255, 188. */
	static const double expected[6][3] = { { 137, 0, 188 }, { 137, 255, 188 }, { 0, 3, 0 },
										   { 0, 1, 0 },     { 0.5, 0, 0 },     { 0.5, 1, 1 } };
	static const char *const name[6] = { "red",        "green",    "emission_r",
										 "emission_b", "specular", "roughness" };
	for (int k = 0; k < 6; k++)
		for (size_t i = 0; i < 3; i++)
			/* Three float32 weights of the luminance. */
			assert_true(fabs(value(&cloud, name[k], i) - expected[k][i]) < 1e-7);
	scan_clear(&cloud);
	mesh_clear(&m);
}

/* Vertices with colours and normals, comments, counts on the first line, faces of three, four and
 * two corners, colours behind a face. */
static void off_files_are_read(void **state)
{
	(void)state;
	mesh m = read_good("OFF 4 3 0\n# comment\n0 0 0\n2 0 0\n\n2 3 0\n0 3 0\n"
					   "4 0 1 2 3 # a square\n2 0 1\n3 0 1 2  255 0 0\n");
	assert_int_equal(m.triangle_count, 3);
	assert_int_equal(m.faces_flat, 1);
	assert_true(fabs(m.area - 9.0) < 1e-12 && m.bare);
	mesh_clear(&m);
	m = read_good("CNOFF\n3 1 0\n0 0 0 0 0 1 255 0 0 255\n1 0 0 0 0 1 0 255 0 255\n"
				  "0 1 0 0 1 0 0.5 0.5 0.5 1\n3 0 1 2\n");
	assert_true(!m.bare && m.color[0] == 1.0f && m.color[1] == 0.0f && m.color[4] == 1.0f);
	assert_true(m.color[6] == (float)scan_srgb_decode(0.5));
	assert_true(m.normal[2] == 1.0f && m.normal[7] == 1.0f && m.corner_normal[2] == 2);
	mesh_clear(&m);
	/* Vertices as points. */
	static const char points[] = "COFF\n2 0 0\n1.5 2 3 255 0 128\n0 0 0.1 1 2 3\n";
	input_file in = { .name = "p", .data = (const uint8_t *)points, .length = sizeof points - 1 };
	scan cloud;
	assert_int_equal(off_read(&in, &cloud, NULL), GW_OK);
	assert_true(cloud.count == 2 && value(&cloud, "x", 0) == 1.5 && value(&cloud, "z", 1) == 0.1);
	assert_true(value(&cloud, "red", 0) == 255 && value(&cloud, "blue", 0) == 128 &&
				value(&cloud, "green", 1) == 2);
	assert_null(scan_find(&cloud, "nx"));
	scan_clear(&cloud);
	assert_refused("OFF\n3 1\n0 0 0\n1 0 0\n", "too early");
	assert_refused("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "no vertex");
	assert_refused("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1\n", "fewer corners");
	assert_refused("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n2 0 1\n", "no faces");
	assert_refused("OFF\n3000000000000 1 0\n0 0 0\n", "too short");
	assert_refused("OFF\n1e300 1e300 0\n0 0 0\n", "too short");
	assert_refused("OFF\n1.5 1 0\n0 0 0\n1 1 1\n3 0 0 0\n", "whole");
	assert_refused("OFF BINARY\n123", "binary");
	assert_refused("NOFF\n1 1 0\n0 0 0\n", "too few numbers");
	assert_refused("OFF\n1 1 0\n0 0 0 5\n3 0 0 0\n", "more numbers");
}

/* The mirrored square, the triangle, the turned square; after the turn to z up. */
static void glb_files_are_read(void **state)
{
	(void)state;
	uint8_t file[GLB_FILE_ROOM];
	input_file in = { .name = "seed.glb", .data = file, .length = glb_file_square(file) };
	mesh m;
	gw_error error = { 0 };
	if (mesh_glb_read(&in, &m, &error) != GW_OK || mesh_measure(&m, "seed.glb", &error) != GW_OK)
		fail_msg("%s", error.text);
	assert_int_equal(m.triangle_count, 5);
	/* 1 m^2 mirrored, 4 m^2 twice as large, half a square metre. Rotations by the rounded sine of
	 * 45 degrees are off by 1e-16. */
	assert_true(fabs(m.area - 5.5) < 1e-12 && m.up == 'z' && !m.bare);
	assert_int_equal(m.note_count, 1);
	/* Corner 1 of the mirrored square, (1, 0, 0), lies at x = -1, and its corners go round so that
	 * the face still looks along the normal: +z, which is -y now. */
	double cross[3];
	gw_mesh_cross(m.position, m.corner, cross);
	assert_true(m.position[3] == -1.0 && cross[1] < 0.0 && m.normal[1] == -1.0f);
	/* Its children are mirrored with it: (1, 1, 3) to (-1, 1, 3) and (-1, -3, 1). */
	size_t at = 4 + 2;
	assert_true(m.position[3 * at] == -1.0 && m.position[3 * at + 1] == -3.0 &&
				m.position[3 * at + 2] == 1.0);
	assert_int_equal(m.corner_normal[3 * 2], MESH_NONE);
	/* Corner 2 of the turned one, (1, 1, 0): doubled, y to z, one up along y, then z up. */
	at = 4 + 3 + 2;
	assert_true(fabs(m.position[3 * at] - 2.0) < 1e-12 &&
				fabs(m.position[3 * at + 1] + 2.0) < 1e-12 &&
				fabs(m.position[3 * at + 2] - 1.0) < 1e-12);
	/* Its normal, +z, turned about x to -y, which is -z now. */
	assert_true(fabs((double)m.normal[3 * 4 + 2] + 1.0) < 1e-6);
	/* The material's colour times 255 or 51 of 255. */
	assert_true(m.color[0] == 0.5f && fabs((double)m.color[1] - 0.05) < 1e-7);
	assert_true(m.material[m.face_material[2]].emission[0] == 5.0f &&
				m.material[m.face_material[2]].emission[1] == 2.5f);
	mesh_stand(&m, 'y');
	assert_true(m.position[3] == -1.0 && fabs((double)m.normal[2] - 1.0) < 1e-6 && m.up == 'y');
	mesh_clear(&m);
}

#define GLB_HEAD "{\"asset\":{\"version\":\"2.0\"},"
#define GLB_MESH "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],"
#define GLB_VIEW                                                                                   \
	"\"bufferViews\":[{\"buffer\":0,\"byteLength\":60}],\"buffers\":[{\"byteLength\":60}]}"
#define GLB_FIVE                                                                                   \
	"\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":5,\"type\":\"VEC3\"}],"

/* Five corners of a fan or strip in the plane z = 0. */
static gw_status read_five(const char *json, mesh *m, gw_error *error)
{
	static const float corners[15] = { 0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0 };
	uint8_t file[GLB_FILE_ROOM];
	input_file in = { .name = "seed.obj", .data = file };
	in.length = glb_file_make(json, corners, sizeof corners, file);
	return mesh_glb_read(&in, m, error);
}

static void glb_strips_and_fans(void **state)
{
	(void)state;
	static const char *const json[2] = {
		GLB_HEAD
		"\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"mode\":5}]}]," GLB_FIVE
			GLB_VIEW,
		GLB_HEAD
		"\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"mode\":6}]}]," GLB_FIVE
			GLB_VIEW,
	};
	gw_error error = { 0 };
	mesh m;
	for (int i = 0; i < 2; i++) {
		if (read_five(json[i], &m, &error) != GW_OK)
			fail_msg("%s", error.text);
		assert_true(m.triangle_count == 3 && m.bare);
		double cross[3];
		/* The strip's triangles all go round the same way: +z, now -y. */
		for (size_t t = 0; t < 3 && i == 0; t++) {
			gw_mesh_cross(m.position, m.corner + 3 * t, cross);
			assert_true(cross[1] < 0.0);
		}
		/* The fan's all hold the first corner. */
		for (size_t t = 0; t < 3 && i == 1; t++)
			assert_int_equal(m.corner[3 * t + 2], 0);
		mesh_clear(&m);
	}
}

static void glb_files_that_are_refused(void **state)
{
	(void)state;
	static const char *const bad[][2] = {
		{ "{\"asset\":{\"version\":\"1.0\"}}", "asset.version" },
		{ "[]", "no object" },
		{ "{\"a\":}", "line 1" },
		{ GLB_HEAD "\"extensionsRequired\":[\"KHR_draco_mesh_compression\"]}",
		  "without compression" },
		{ GLB_HEAD GLB_FIVE GLB_VIEW, "no mesh" },
		{ GLB_HEAD GLB_MESH GLB_VIEW, "accessors[0]" },
		{ GLB_HEAD GLB_MESH "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":6,"
							"\"type\":\"VEC3\"}]," GLB_VIEW,
		  "reaches out of bufferViews[0]" },
		{ GLB_HEAD GLB_MESH
		  "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":1e15,"
		  "\"type\":\"VEC3\"}]," GLB_VIEW,
		  "reaches out of bufferViews[0]" },
		{ GLB_HEAD GLB_MESH "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,"
							"\"byteOffset\":60,\"type\":\"VEC3\"}]," GLB_VIEW,
		  "reaches out" },
		{ GLB_HEAD GLB_MESH "\"accessors\":[{\"componentType\":5126,\"count\":3,\"sparse\":{},"
							"\"type\":\"VEC3\"}]," GLB_VIEW,
		  "sparse" },
		{ GLB_HEAD GLB_MESH GLB_FIVE "\"bufferViews\":[{\"buffer\":0,\"byteLength\":64}]}",
		  "out of the binary chunk" },
		{ GLB_HEAD GLB_MESH GLB_FIVE "\"bufferViews\":[{\"buffer\":0,\"byteLength\":60}],"
									 "\"buffers\":[{\"uri\":\"x.bin\"}]}",
		  "another file" },
		{ GLB_HEAD GLB_MESH GLB_FIVE
		  "\"nodes\":[{\"mesh\":0,\"children\":[1]},{\"children\":[1]}]," GLB_VIEW,
		  "reached twice" },
		{ GLB_HEAD GLB_MESH GLB_FIVE "\"nodes\":[{\"mesh\":7}]," GLB_VIEW, "meshes[7]" },
		{ GLB_HEAD GLB_MESH GLB_FIVE "\"nodes\":[{\"mesh\":0,\"scale\":[1,2]}]," GLB_VIEW,
		  "3 numbers" },
		{ GLB_HEAD
		  "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"mode\":1}]}]," GLB_FIVE
			  GLB_VIEW,
		  "only points or lines" },
		{ GLB_HEAD "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"material\":0}]}"
				   "]," GLB_FIVE GLB_VIEW,
		  "materials[0]" },
		{ GLB_HEAD
		  "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":1}]}],"
		  "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":1,"
		  "\"type\":\"VEC3\"},{\"bufferView\":0,\"componentType\":5121,\"count\":30,"
		  "\"type\":\"SCALAR\"}]," GLB_VIEW,
		  "leads to vertex 128" },
	};
	for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
		mesh m;
		gw_error error = { 0 };
		if (read_five(bad[i][0], &m, &error) != GW_ERROR_DATA || !strstr(error.text, bad[i][1]) ||
			!strstr(error.text, "seed.obj") || m.position)
			fail_msg("%zu: '%s' does not say '%s'", i, error.text, bad[i][1]);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(off_files_are_read),
		cmocka_unit_test(glb_files_are_read),
		cmocka_unit_test(glb_strips_and_fans),
		cmocka_unit_test(glb_files_that_are_refused),
		cmocka_unit_test(areas_are_summed),
		cmocka_unit_test(every_face_has_its_share),
		cmocka_unit_test(strata_have_the_closed_form),
		cmocka_unit_test(triangles_are_covered_evenly),
		cmocka_unit_test(threads_do_not_matter),
		cmocka_unit_test(polygons_are_cut),
		cmocka_unit_test(indices_lead_back_and_forth),
		cmocka_unit_test(bad_meshes_are_refused),
		cmocka_unit_test(colors_and_normals_are_interpolated),
		cmocka_unit_test(matrices_move_meshes),
		cmocka_unit_test(materials_become_columns),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
