/*
 * make_truth - writes a scene of known light: a cloud, its lamps, and the radiance that a path
 * tracer finds on the triangles behind the points.
 *
 *   build/tests/bench/make_truth KIND -o PREFIX [option]...
 *
 * PREFIX.ply is the cloud, PREFIX.scene.json its lamps, PREFIX.truth.ply a random part of the
 * points with scalar_radiance_*, scalar_direct_* and scalar_indirect_* (irradiance), emission_* and
 * scalar_stderr (standard error of the luminance). Both clouds have a column `index`, so that
 *
 *   glowworm bake PREFIX.scene.json -o lit.ply && glowworm compare lit.ply PREFIX.truth.ply
 *
 * says how wrong a bake is. Noise moves points and turns normals; the truth stays that of the place
 * on the surface, without noise.
 */
#include "program/exit_code.h"
#include "table/format_table.h"
#include "program/json_writer.h"
#include "files/number_text.h"
#include "files/output_file.h"
#include "reference_tracer.h"

#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

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
	uint32_t *chosen; /* truth_count points, rising */
	double *surface;
	uint32_t *triangle;
	reference_light *light;
	gw_error error;
} maker;

static const char usage[] =
	"Usage: make_truth KIND -o PREFIX [option]...\n"
	"KIND is cornell, rooms, corridor, hole, ruin or cave.\n"
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

static bool add_emission(maker *m, scan *cloud, const uint32_t *place)
{
	static const char *const name[3] = { "emission_r", "emission_g", "emission_b" };
	for (size_t k = 0; k < 3; k++) {
		float *data = add(m, cloud, name[k], SCAN_FLOAT32);
		for (size_t i = 0; data && i < cloud->count; i++)
			data[i] = m->scene.triangle[m->points.triangle[place ? place[i] : i]].emission[k];
		if (!data)
			return false;
	}
	return true;
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

/* One channel of what was traced: radiance, direct or indirect irradiance. */
static float traced_value(const maker *m, size_t i, int quantity, size_t k)
{
	const mesh_triangle *t = &m->scene.triangle[m->triangle[i]];
	const reference_light *l = &m->light[i];
	double radiance = (double)t->emission[k] + (double)t->albedo[k] / 3.14159265358979323846 *
												   (l->direct[k] + l->indirect[k]);
	return (float)(quantity == 0 ? radiance : quantity == 1 ? l->direct[k] : l->indirect[k]);
}

static bool add_light(maker *m, scan *cloud)
{
	static const char *const name[3] = { "radiance", "direct", "indirect" };
	for (int quantity = 0; quantity < 3; quantity++) {
		for (size_t k = 0; k < 3; k++) {
			char full[64];
			snprintf(full, sizeof full, "scalar_%s_%c", name[quantity], "rgb"[k]);
			float *data = add(m, cloud, full, SCAN_FLOAT32);
			for (size_t i = 0; data && i < cloud->count; i++)
				data[i] = traced_value(m, i, quantity, k);
			if (!data)
				return false;
		}
	}
	float *data = add(m, cloud, "scalar_stderr", SCAN_FLOAT32);
	for (size_t i = 0; data && i < cloud->count; i++)
		data[i] = (float)m->light[i].error;
	return data;
}

/* ---------------------------------------------------------------------------------- files */

static output_file *create(maker *m, const char *suffix)
{
	char path[4096];
	output_file *out = NULL;
	snprintf(path, sizeof path, "%s%s", m->prefix, suffix);
	output_file_create(&out, path, true, &m->error);
	return out;
}

static gw_status write_cloud(maker *m, scan *cloud, bool whole, const char *suffix)
{
	output_file *out = whole ? create(m, suffix) : NULL;
	gw_status status = out ? format_by_name("ply")->write(out, cloud, &m->error) : m->error.status;
	if (status == GW_OK)
		status = output_file_commit(&out, &m->error);
	output_file_abandon(&out);
	scan_clear(cloud);
	return status;
}

static gw_status comment(maker *m, scan *cloud)
{
	char text[256], noise[NUMBER_TEXT], turn[NUMBER_TEXT];
	number_print(noise, m->sampling.noise);
	number_print(turn, m->sampling.normal_noise);
	snprintf(text, sizeof text, "make_truth %s: noise %s spacings, normals %s degrees, seed %llu",
			 mesh_kind_name((int)m->kind), noise, turn, (unsigned long long)m->sampling.seed);
	return scan_add_comment(cloud, text, &m->error);
}

static bool has_emission(const mesh_scene *s)
{
	for (size_t t = 0; t < s->count; t++)
		if (s->triangle[t].emission[0] > 0.0f)
			return true;
	return false;
}

static gw_status write_points(maker *m)
{
	scan cloud = { .count = m->points.count, .up = 'z' };
	bool whole = comment(m, &cloud) == GW_OK && add_positions(m, &cloud, NULL) &&
				 add_surface(m, &cloud) && add_index(m, &cloud, NULL) &&
				 (!has_emission(&m->scene) || add_emission(m, &cloud, NULL));
	return write_cloud(m, &cloud, whole, ".ply");
}

static gw_status write_truth(maker *m)
{
	scan cloud = { .count = m->truth_count, .up = 'z' };
	bool whole = comment(m, &cloud) == GW_OK && add_positions(m, &cloud, m->chosen) &&
				 add_index(m, &cloud, m->chosen) && add_emission(m, &cloud, m->chosen) &&
				 add_light(m, &cloud);
	return write_cloud(m, &cloud, whole, ".truth.ply");
}

static void put_light(json_writer *json, const maker *m, const gw_light *light)
{
	double position[3];
	for (int k = 0; k < 3; k++)
		position[k] = light->position[k] + m->origin[k];
	json_put_open_flat(json, NULL, '{');
	json_put_text(json, "type", gw_light_type_name(light->type));
	if (light->type == GW_LIGHT_POINT || light->type == GW_LIGHT_SPOT) {
		json_put_reals(json, "position", position, 3);
		json_put_singles(json, "intensity", light->intensity, 3);
	}
	if (light->type == GW_LIGHT_SPOT || light->type == GW_LIGHT_SUN)
		json_put_reals(json, "direction", light->direction, 3);
	if (light->type == GW_LIGHT_SPOT) {
		json_put_single(json, "inner_angle", light->inner_angle);
		json_put_single(json, "outer_angle", light->outer_angle);
	}
	if (light->type == GW_LIGHT_SUN) {
		json_put_singles(json, "irradiance", light->irradiance, 3);
		json_put_single(json, "angle", light->angle);
	}
	if (light->type == GW_LIGHT_ENVIRONMENT)
		json_put_singles(json, "radiance", light->radiance, 3);
	json_put_close(json, '}');
}

static void put_scene(const maker *m, FILE *out)
{
	const char *slash = strrchr(m->prefix, '/');
	char file[4096];
	snprintf(file, sizeof file, "%s.ply", slash ? slash + 1 : m->prefix);
	json_writer json = { .out = out, .lines = true };
	json_put_open(&json, NULL, '{');
	json_put_count(&json, "version", 1);
	json_put_open(&json, "inputs", '[');
	json_put_open_flat(&json, NULL, '{');
	json_put_text(&json, "file", file);
	json_put_close(&json, '}');
	json_put_close(&json, ']');
	json_put_open(&json, "lights", '[');
	for (size_t i = 0; i < m->scene.light_count; i++)
		put_light(&json, m, &m->scene.light[i]);
	json_put_close(&json, ']');
	json_put_close(&json, '}');
	fputc('\n', out);
}

static gw_status write_scene(maker *m)
{
	char *text = NULL;
	size_t length;
	FILE *memory = open_memstream(&text, &length);
	if (!memory)
		return gw_fail(&m->error, GW_ERROR_MEMORY, "no memory for the scene");
	put_scene(m, memory);
	fclose(memory);
	output_file *out = create(m, ".scene.json");
	gw_status status = out ? output_file_write(out, text, length, &m->error) : m->error.status;
	if (status == GW_OK)
		status = output_file_commit(&out, &m->error);
	output_file_abandon(&out);
	free(text);
	return status;
}

/* ---------------------------------------------------------------------------------- truth */

static double now(void)
{
	struct timespec time;
	clock_gettime(CLOCK_MONOTONIC, &time);
	return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

/* Chooses points of the truth, each with the same chance, in order (Knuth's algorithm S). */
static gw_status choose(maker *m)
{
	size_t n = m->points.count, want = m->truth_count < n ? m->truth_count : n, got = 0;
	uint64_t state = m->sampling.seed + 99;
	m->truth_count = want;
	m->chosen = reallocarray(NULL, want + 1, sizeof *m->chosen);
	m->surface = reallocarray(NULL, want + 1, 3 * sizeof *m->surface);
	m->triangle = reallocarray(NULL, want + 1, sizeof *m->triangle);
	m->light = reallocarray(NULL, want + 1, sizeof *m->light);
	if (!m->chosen || !m->surface || !m->triangle || !m->light)
		return gw_fail(&m->error, GW_ERROR_MEMORY, "no memory for %zu points of truth", want);
	for (size_t i = 0; i < n && got < want; i++) {
		state = state * 6364136223846793005u + 1442695040888963407u;
		if ((double)(state >> 11) * 0x1p-53 * (double)(n - i) >= (double)(want - got))
			continue;
		m->chosen[got] = (uint32_t)i;
		memcpy(m->surface + 3 * got, m->points.surface + 3 * i, 3 * sizeof *m->surface);
		m->triangle[got++] = m->points.triangle[i];
	}
	return GW_OK;
}

static void show(double done)
{
	static int last = -1;
	int percent = (int)(100.0 * done);
	if (percent != last)
		fprintf(stderr, "\rtracing %3d %%", percent);
	last = percent;
}

/* Root of the mean square of the standard errors, and mean luminance, of points that do not emit.
 */
static void report(const maker *m, double seconds)
{
	double squares = 0.0, mean = 0.0, n = 0.0;
	for (size_t i = 0; i < m->truth_count; i++) {
		if (m->scene.triangle[m->triangle[i]].emission[0] > 0.0f)
			continue;
		squares += m->light[i].error * m->light[i].error;
		mean += 0.2126 * (double)traced_value(m, i, 0, 0) +
				0.7152 * (double)traced_value(m, i, 0, 1) +
				0.0722 * (double)traced_value(m, i, 0, 2);
		n += 1.0;
	}
	fprintf(stderr,
			"\r%s: %zu points %.4g m apart, truth of %zu; standard error %.3f %% of the "
			"mean %.5g; %.1f s\n",
			m->prefix, m->points.count, m->points.spacing, m->truth_count,
			100.0 * sqrt(squares / n) / (mean / n), mean / n, seconds);
}

static gw_status trace(maker *m)
{
	reference_tracer *tracer;
	GW_TRY(reference_tracer_create(&m->scene, &tracer, &m->error));
	double start = now();
	reference_tracer_light(tracer, m->surface, m->triangle, m->truth_count,
						   (m->paths + REFERENCE_BATCHES - 1) / REFERENCE_BATCHES, m->sampling.seed,
						   m->threads, m->light, show);
	report(m, now() - start);
	reference_tracer_destroy(&tracer);
	return GW_OK;
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
	free(m.chosen);
	free(m.surface);
	free(m.triangle);
	free(m.light);
	return exit_code_of(status, 0);
}
