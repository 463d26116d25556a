/*
 * make_truth - writes a scene of known light: a cloud, its lamps, and the radiance that a path
 * tracer finds on the triangles behind the points.
 *
 *   build/tests/bench/make_truth KIND -o PREFIX [option]...
 *
 * PREFIX.ply is the cloud, PREFIX.scene.json its lamps, PREFIX.truth.ply a random part of the
 * points with scalar_radiance_*, scalar_direct_irradiance_*, scalar_indirect_irradiance_*,
 * emission_* and scalar_stderr (standard error of the luminance). Both clouds have a column
 * `index`, so that
 *
 *   glowworm bake PREFIX.scene.json -o lit.ply && glowworm compare lit.ply PREFIX.truth.ply
 *
 * says how wrong a bake is. Noise moves points and turns normals; the truth stays that of the place
 * on the surface, without noise.
 */
#include "program/exit_code.h"
#include "files/number_text.h"
#include "truth_files.h"

#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct maker {
	mesh_kind kind;
	const char *prefix;
	mesh_sampling sampling;
	size_t truth_count;
	uint32_t paths, threads; /* paths a point, in all */
	bool single, no_normals; /* float32 positions */
	double origin[3];        /* added to all coordinates that are written */
	mesh_scene scene;
	mesh_points points;
	truth_places truth;
	gw_error error;
} maker;

static const char usage[] =
	"Usage: make_truth KIND -o PREFIX [option]...\n"
	"KIND is cornell, rooms, corridor, hole, ruin, cave, ball, carton, torus, terrain, fence or\n"
	"tree.\n"
	"  -o, --output PREFIX    write PREFIX.ply, PREFIX.scene.json and PREFIX.truth.ply\n"
	"  -n, --points N         points of the cloud, about (100000)\n"
	"  -t, --truth N          points of the truth (10000)\n"
	"  -p, --paths N          paths a point of the truth (4096)\n"
	"  -j, --threads N        (one a processor)\n"
	"      --noise X          standard deviation along the normal, in point spacings (0)\n"
	"      --normal-noise X   standard deviation of the normals' turns, degrees (0)\n"
	"      --even             spread points evenly over each triangle, not at random\n"
	"      --uneven X         densest over sparsest, as from a scanner amid the scene\n"
	"      --float            write positions as float32\n"
	"      --no-normals       write no normals\n"
	"      --origin X,Y,Z     add this to all coordinates\n"
	"      --seed N           (1)\n";

/* ------------------------------------------------------------------------------ arguments */

static bool read_number(const char *text, double low, double high, double *value)
{
	size_t length = strlen(text), used = number_read(text, length, value);
	return used > 0 && used == length && *value >= low && *value <= high;
}

static bool read_origin(const char *text, double origin[3])
{
	for (int k = 0; k < 3; k++) {
		size_t used = number_read(text, strlen(text), &origin[k]);
		if (used == 0 || !isfinite(origin[k]) || text[used] != (k < 2 ? ',' : '\0'))
			return false;
		text += used + 1;
	}
	return true;
}

static bool set_option(maker *m, int option, const char *text)
{
	double value = 0.0;
	if (option == 'o') {
		m->prefix = text;
	} else if (option == 'e') {
		m->sampling.even = true;
	} else if (option == 'f') {
		m->single = true;
	} else if (option == 'N') {
		m->no_normals = true;
	} else if (option == 'O') {
		return read_origin(text, m->origin);
	} else if (option == 'x' || option == 'd') {
		*(option == 'x' ? &m->sampling.noise : &m->sampling.normal_noise) = 0.0;
		if (!read_number(text, 0.0, 80.0, &value))
			return false;
		*(option == 'x' ? &m->sampling.noise : &m->sampling.normal_noise) = value;
	} else if (!read_number(text, option == 's' ? 0.0 : 1.0, 1e9, &value)) {
		return false;
	} else if (option == 'n') {
		m->sampling.count = (size_t)value;
	} else if (option == 't') {
		m->truth_count = (size_t)value;
	} else if (option == 'p') {
		m->paths = (uint32_t)value;
	} else if (option == 'j') {
		m->threads = (uint32_t)value;
	} else if (option == 'u') {
		m->sampling.uneven = value;
	} else {
		m->sampling.seed = (uint64_t)value;
	}
	return true;
}

static bool read_arguments(maker *m, int count, char **argument)
{
	static const struct option long_option[] = {
		{ "output", required_argument, NULL, 'o' },
		{ "points", required_argument, NULL, 'n' },
		{ "truth", required_argument, NULL, 't' },
		{ "paths", required_argument, NULL, 'p' },
		{ "threads", required_argument, NULL, 'j' },
		{ "noise", required_argument, NULL, 'x' },
		{ "normal-noise", required_argument, NULL, 'd' },
		{ "even", no_argument, NULL, 'e' },
		{ "uneven", required_argument, NULL, 'u' },
		{ "float", no_argument, NULL, 'f' },
		{ "no-normals", no_argument, NULL, 'N' },
		{ "origin", required_argument, NULL, 'O' },
		{ "seed", required_argument, NULL, 's' },
		{ NULL, 0, NULL, 0 },
	};
	int option;
	while ((option = getopt_long(count, argument, "o:n:t:p:j:", long_option, NULL)) != -1)
		if (option == '?' || !set_option(m, option, optarg))
			return false;
	int kind = 0;
	while (optind < count && mesh_kind_name(kind) &&
		   strcmp(mesh_kind_name(kind), argument[optind]) != 0)
		kind++;
	m->kind = (mesh_kind)kind;
	return m->prefix && optind == count - 1 && kind < MESH_KINDS;
}

/* -------------------------------------------------------------------------------- columns */

static void *add(maker *m, scan *cloud, const char *name, scan_type type)
{
	scan_column *column = scan_add_column(cloud, name, type, &m->error);
	return column ? column->data : NULL;
}

/* Adds x y z of the points in `place`, or of all. */
static bool add_positions(maker *m, scan *cloud, const uint32_t *place)
{
	static const char *const name[3] = { "x", "y", "z" };
	for (size_t k = 0; k < 3; k++) {
		void *data = add(m, cloud, name[k], m->single ? SCAN_FLOAT32 : SCAN_FLOAT64);
		for (size_t i = 0; data && i < cloud->count; i++) {
			double x = m->points.position[3 * (place ? place[i] : i) + k] + m->origin[k];
			if (m->single)
				((float *)data)[i] = (float)x;
			else
				((double *)data)[i] = x;
		}
		if (!data)
			return false;
	}
	return true;
}

static bool add_index(maker *m, scan *cloud, const uint32_t *place)
{
	uint32_t *data = add(m, cloud, "index", SCAN_UINT32);
	for (size_t i = 0; data && i < cloud->count; i++)
		data[i] = place ? place[i] : (uint32_t)i;
	return data;
}

static bool add_surface(maker *m, scan *cloud)
{
	static const char *const normal[3] = { "nx", "ny", "nz" };
	static const char *const color[3] = { "red", "green", "blue" };
	for (size_t k = 0; k < 3 && !m->no_normals; k++) {
		float *data = add(m, cloud, normal[k], SCAN_FLOAT32);
		for (size_t i = 0; data && i < cloud->count; i++)
			data[i] = m->points.normal[3 * i + k];
		if (!data)
			return false;
	}
	for (size_t k = 0; k < 3; k++) {
		uint8_t *data = add(m, cloud, color[k], SCAN_UINT8);
		for (size_t i = 0; data && i < cloud->count; i++)
			data[i] = m->scene.triangle[m->points.triangle[i]].color[k];
		if (!data)
			return false;
	}
	return true;
}

/* ---------------------------------------------------------------------------------- files */

static gw_status comment(maker *m, scan *cloud)
{
	char text[256], noise[NUMBER_TEXT], turn[NUMBER_TEXT];
	number_print(noise, m->sampling.noise);
	number_print(turn, m->sampling.normal_noise);
	snprintf(text, sizeof text, "make_truth %s: noise %s spacings, normals %s degrees, seed %llu",
			 mesh_kind_name((int)m->kind), noise, turn, (unsigned long long)m->sampling.seed);
	return scan_add_comment(cloud, text, &m->error);
}

static gw_status write_points(maker *m)
{
	scan cloud = { .count = m->points.count, .up = 'z' };
	bool whole = comment(m, &cloud) == GW_OK && add_positions(m, &cloud, NULL) &&
				 add_surface(m, &cloud) && add_index(m, &cloud, NULL) &&
				 (!truth_has_emission(&m->scene) ||
				  truth_add_emission(&m->scene, m->points.triangle, &cloud, &m->error) == GW_OK);
	if (whole)
		return truth_write_cloud(m->prefix, ".ply", "ply", &cloud, &m->error);
	scan_clear(&cloud);
	return m->error.status;
}

static gw_status write_truth(maker *m)
{
	scan cloud = { .count = m->truth.count, .up = 'z' };
	bool whole = comment(m, &cloud) == GW_OK && add_positions(m, &cloud, m->truth.index) &&
				 add_index(m, &cloud, m->truth.index) &&
				 truth_add_emission(&m->scene, m->truth.triangle, &cloud, &m->error) == GW_OK &&
				 truth_add_light(&m->scene, &m->truth, &cloud, &m->error) == GW_OK;
	if (whole)
		return truth_write_cloud(m->prefix, ".truth.ply", "ply", &cloud, &m->error);
	scan_clear(&cloud);
	return m->error.status;
}

static gw_status write_scene(maker *m)
{
	static const char *const suffix[] = { ".ply" };
	return truth_write_scene(m->prefix, suffix, 1, &m->scene, m->origin, &m->error);
}

/* ---------------------------------------------------------------------------------- truth */

/* Chooses points of the truth, each with the same chance, in order (Knuth's algorithm S). */
static gw_status choose(maker *m)
{
	size_t n = m->points.count, want = m->truth_count < n ? m->truth_count : n, got = 0;
	uint64_t state = m->sampling.seed + 99;
	gw_status status = truth_places_make(&m->truth, want, &m->error);
	for (size_t i = 0; status == GW_OK && i < n && got < want; i++) {
		state = state * 6364136223846793005u + 1442695040888963407u;
		if ((double)(state >> 11) * 0x1p-53 * (double)(n - i) >= (double)(want - got))
			continue;
		m->truth.index[got] = (uint32_t)i;
		memcpy(m->truth.surface + 3 * got, m->points.surface + 3 * i, 3 * sizeof(double));
		m->truth.triangle[got++] = m->points.triangle[i];
	}
	return status;
}

static gw_status trace(maker *m)
{
	const truth_tracing how = { m->paths, m->threads, m->sampling.seed };
	fprintf(stderr, "%s: %zu points %.4g m apart\n", m->prefix, m->points.count, m->points.spacing);
	return truth_trace(&m->scene, &how, m->prefix, &m->truth, &m->error);
}

static gw_status run(maker *m)
{
	GW_TRY(mesh_scene_make(m->kind, &m->scene, &m->error));
	GW_TRY(mesh_points_make(&m->scene, &m->sampling, &m->points, &m->error));
	GW_TRY(write_points(m));
	GW_TRY(write_scene(m));
	GW_TRY(choose(m));
	GW_TRY(trace(m));
	return write_truth(m);
}

int main(int count, char **argument)
{
	maker m = { .sampling = { .count = 100000, .seed = 1 }, .truth_count = 10000, .paths = 4096 };
	if (!read_arguments(&m, count, argument)) {
		fputs(usage, stderr);
		return EXIT_CODE_USAGE;
	}
	gw_status status = run(&m);
	if (status != GW_OK)
		fprintf(stderr, "make_truth: %s\n", m.error.text);
	mesh_scene_clear(&m.scene);
	mesh_points_clear(&m.points);
	truth_places_clear(&m.truth);
	return exit_code_of(status, 0);
}
