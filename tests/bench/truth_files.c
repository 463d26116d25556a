/* truth_files.c - see truth_files.h */
#include "truth_files.h"
#include "files/output_file.h"
#include "program/json_writer.h"
#include "table/format_table.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

gw_status truth_places_make(truth_places *p, size_t count, gw_error *error)
{
	size_t n = count + 1;
	*p = (truth_places){ .count = count };
	p->index = reallocarray(NULL, n, sizeof *p->index);
	p->position = reallocarray(NULL, n, 3 * sizeof *p->position);
	p->surface = reallocarray(NULL, n, 3 * sizeof *p->surface);
	p->triangle = reallocarray(NULL, n, sizeof *p->triangle);
	p->light = reallocarray(NULL, n, sizeof *p->light);
	if (p->index && p->position && p->surface && p->triangle && p->light)
		return GW_OK;
	truth_places_clear(p);
	return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu points of truth", count);
}

void truth_places_clear(truth_places *p)
{
	free(p->index);
	free(p->position);
	free(p->surface);
	free(p->triangle);
	free(p->light);
	*p = (truth_places){ 0 };
}

/* -------------------------------------------------------------------------------- tracing */

static double now(void)
{
	struct timespec time;
	clock_gettime(CLOCK_MONOTONIC, &time);
	return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

static void show(double done)
{
	static int last = -1;
	int percent = (int)(100.0 * done);
	if (percent != last && isatty(2))
		fprintf(stderr, "\rtracing %3d %%", percent);
	last = percent;
}

/* One channel of what was traced: radiance, direct or indirect irradiance. */
static float traced_value(const mesh_triangle *t, const reference_light *l, int quantity, size_t k)
{
	double radiance = (double)t->emission[k] + (double)t->albedo[k] / 3.14159265358979323846 *
												   (l->direct[k] + l->indirect[k]);
	return (float)(quantity == 0 ? radiance : quantity == 1 ? l->direct[k] : l->indirect[k]);
}

/* Root of the mean square of the standard errors, and mean luminance, of points that do not emit.
 */
static void report(const mesh_scene *scene, const truth_places *p, const char *name, double seconds)
{
	double squares = 0.0, mean = 0.0, n = 0.0;
	for (size_t i = 0; i < p->count; i++) {
		const mesh_triangle *t = &scene->triangle[p->triangle[i]];
		const reference_light *l = &p->light[i];
		if (t->emission[0] > 0.0f)
			continue;
		squares += l->error * l->error;
		mean += 0.2126 * (double)traced_value(t, l, 0, 0) +
				0.7152 * (double)traced_value(t, l, 0, 1) +
				0.0722 * (double)traced_value(t, l, 0, 2);
		n += 1.0;
	}
	fprintf(stderr, "\r%s: truth of %zu points; standard error %.3f %% of the mean %.5g; %.1f s\n",
			name, p->count, 100.0 * sqrt(squares / n) / (mean / n), mean / n, seconds);
}

gw_status truth_trace(const mesh_scene *scene, const truth_tracing *how, const char *name,
					  truth_places *p, gw_error *error)
{
	reference_tracer *tracer;
	gw_status status = reference_tracer_create(scene, &tracer, error);
	if (status != GW_OK)
		return status;
	double start = now();
	const reference_places places = {
		.surface = p->surface,
		.triangle = p->triangle,
		.count = p->count,
		.paths = (how->paths + REFERENCE_BATCHES - 1) / REFERENCE_BATCHES,
		.threads = how->threads,
		.seed = how->seed,
		.shown = show,
	};
	reference_tracer_light(tracer, &places, p->light);
	report(scene, p, name, now() - start);
	reference_tracer_destroy(&tracer);
	return GW_OK;
}

/* -------------------------------------------------------------------------------- columns */

gw_status truth_add_light(const mesh_scene *scene, const truth_places *p, scan *cloud,
						  gw_error *error)
{
	static const char *const name[3] = { "radiance", "direct_irradiance", "indirect_irradiance" };
	for (int column = 0; column < 9; column++) {
		char full[64];
		int quantity = column / 3, k = column % 3;
		snprintf(full, sizeof full, "scalar_%s_%c", name[quantity], "rgb"[k]);
		scan_column *to = scan_add_column(cloud, full, SCAN_FLOAT32, error);
		if (!to)
			return error->status;
		for (size_t i = 0; i < p->count; i++)
			((float *)to->data)[i] =
				traced_value(&scene->triangle[p->triangle[i]], &p->light[i], quantity, (size_t)k);
	}
	scan_column *to = scan_add_column(cloud, "scalar_stderr", SCAN_FLOAT32, error);
	for (size_t i = 0; to && i < p->count; i++)
		((float *)to->data)[i] = (float)p->light[i].error;
	return to ? GW_OK : error->status;
}

bool truth_has_emission(const mesh_scene *s)
{
	for (size_t t = 0; t < s->count; t++)
		if (s->triangle[t].emission[0] > 0.0f)
			return true;
	return false;
}

gw_status truth_add_emission(const mesh_scene *scene, const uint32_t *triangle, scan *cloud,
							 gw_error *error)
{
	static const char *const name[3] = { "emission_r", "emission_g", "emission_b" };
	for (size_t k = 0; k < 3; k++) {
		scan_column *to = scan_add_column(cloud, name[k], SCAN_FLOAT32, error);
		if (!to)
			return error->status;
		for (size_t i = 0; i < cloud->count; i++)
			((float *)to->data)[i] = scene->triangle[triangle[i]].emission[k];
	}
	return GW_OK;
}

/* ---------------------------------------------------------------------------------- files */

static output_file *create(const char *prefix, const char *suffix, gw_error *error)
{
	char path[4096];
	output_file *out = NULL;
	snprintf(path, sizeof path, "%s%s", prefix, suffix);
	output_file_create(&out, path, true, error);
	return out;
}

gw_status truth_write_cloud(const char *prefix, const char *suffix, const char *format_name,
							scan *cloud, gw_error *error)
{
	output_file *out = create(prefix, suffix, error);
	gw_status status = out ? format_by_name(format_name)->write(out, cloud, error) : error->status;
	if (status == GW_OK)
		status = output_file_commit(&out, error);
	output_file_abandon(&out);
	scan_clear(cloud);
	return status;
}

static void put_light(json_writer *json, const gw_light *light, const double origin[3])
{
	double position[3];
	for (int k = 0; k < 3; k++)
		position[k] = light->position[k] + origin[k];
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

/* What a file of a scene is to hold. */
typedef struct scene_text {
	const char *name; /* PREFIX without its folders */
	const char *const *suffix;
	size_t count;
	const mesh_scene *scene;
	const double *origin;
} scene_text;

static void put_scene(const scene_text *s, FILE *out)
{
	char file[4096];
	json_writer json = { .out = out, .lines = true };
	json_put_open(&json, NULL, '{');
	json_put_count(&json, "version", 1);
	json_put_open(&json, "inputs", '[');
	for (size_t i = 0; i < s->count; i++) {
		snprintf(file, sizeof file, "%s%s", s->name, s->suffix[i]);
		json_put_open_flat(&json, NULL, '{');
		json_put_text(&json, "file", file);
		json_put_close(&json, '}');
	}
	json_put_close(&json, ']');
	json_put_open(&json, "lights", '[');
	for (size_t i = 0; i < s->scene->light_count; i++)
		put_light(&json, &s->scene->light[i], s->origin);
	json_put_close(&json, ']');
	json_put_close(&json, '}');
	fputc('\n', out);
}

gw_status truth_write_scene(const char *prefix, const char *const *suffix, size_t count,
							const mesh_scene *scene, const double origin[3], gw_error *error)
{
	const char *slash = strrchr(prefix, '/');
	const scene_text s = { slash ? slash + 1 : prefix, suffix, count, scene, origin };
	char *text = NULL;
	size_t length;
	FILE *memory = open_memstream(&text, &length);
	if (!memory)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the scene");
	put_scene(&s, memory);
	fclose(memory);
	output_file *out = create(prefix, ".scene.json", error);
	gw_status status = out ? output_file_write(out, text, length, error) : error->status;
	if (status == GW_OK)
		status = output_file_commit(&out, error);
	output_file_abandon(&out);
	free(text);
	return status;
}
