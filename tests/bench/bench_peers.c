/*
 * bench_peers.c - seconds and error of the bake beside two usual ways to light a cloud, on the same
 * points: path tracing at every point, and rays that read cached radiance, then a filter.
 *
 *   bench_peers [--way NAME] [--goal ERROR] [--json] [--blender peer_cycles.py]
 *               [SCENE.json TRUTH.ply [SECONDS [PREFIX]]]
 *
 * SCENE and TRUTH are what make_truth writes; without them a Cornell box of 20,000 points is lit
 * and its truth traced. Each way, or the one that is named, climbs its ladder of settings until the
 * error is the goal (0.03) or SECONDS (60) are over. PREFIX-NAME.ply receives the last light of
 * each. --json writes each row as a line of JSON, and no table. --blender: a scene of files is lit
 * by Cycles, too.
 *
 * Seconds count from bare points to light at every point, without files. Error is over the points
 * of the truth that do not emit: relRMSE, the same over the best 99 %, and bias, in % of the mean.
 */
#include "glowworm_host.h"
#include "glowworm_picture.h"
#include "table/format_table.h"
#include "scene/loaded_scene.h"
#include "comparison/matched_scans.h"
#include "files/output_file.h"
#include "peer_cycles.h"
#include "peer_light.h"
#include "reference_tracer.h"
#include "points/scan_color.h"
#include "scene/scene_file.h"

#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

#define MOST_RAYS 256u

/* Points of the scene that is made here, of its truth, and paths of each. */
#define OWN_POINTS 20000u
#define OWN_TRUTH 2000u
#define OWN_PATHS 64u

/* What is lit, and what is known of its light. */
typedef struct problem {
	settings settings;
	loaded_scene scene;
	mesh_scene mesh;
	mesh_points mesh_points;
	float *albedo, *emission; /* of a scene made here */
	gw_points points;
	const gw_light *lights;
	gw_light *own_lights;
	size_t light_count;
	size_t known;             /* points of the truth */
	size_t *which;            /* known places among the points */
	double *truth;            /* known luminances */
	double *found;            /* known */
	double goal;              /* error that ends a ladder */
	double seconds;           /* the most that it may take */
	const char *prefix, *way; /* NULL: no files, and all ways */
	const char *script;       /* peer_cycles.py; NULL: without Cycles */
	const char *scene_path;   /* NULL: made here */
	bool json;
	gw_error error;
} problem;

/* Wall clock, and time of all processors. */
typedef struct span {
	double wall, busy;
} span;

/* The best that a way of lighting has reached. */
typedef struct ladder {
	const char *name;
	span reached[2][2]; /* at 5 and 3 %, of all points and of the best 99 % */
} ladder;

static const double goals[2] = { 0.05, 0.03 };

static double luminance(const float c[3])
{
	return 0.2126 * (double)c[0] + 0.7152 * (double)c[1] + 0.0722 * (double)c[2];
}

static span now(void)
{
	struct rusage usage;
	getrusage(RUSAGE_SELF, &usage);
	return (span){ gw_seconds(),
				   (double)(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
					   1e-6 * (double)(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec) };
}

static span since(span start)
{
	span end = now();
	return (span){ end.wall - start.wall, end.busy - start.busy };
}

static span sum(span a, span b)
{
	return (span){ a.wall + b.wall, a.busy + b.busy };
}

/* ------------------------------------------------------------------------ a scene of files */

static gw_status match_truth(problem *p, const scan *truth)
{
	const scan_column *column[3];
	matched_scans match = { .found = &p->scene.cloud,
							.truth = truth,
							.found_name = "the scene",
							.truth_name = "the truth" };
	static const char *const name[3] = { "radiance_r", "radiance_g", "radiance_b" };
	if (!scan_find_triple(truth, name, column))
		return gw_fail(&p->error, GW_ERROR_DATA, "the truth has no radiance");
	GW_TRY(matched_scans_make(&match, &p->error));
	p->known = match.count;
	p->which = calloc(p->known, sizeof *p->which);
	p->truth = calloc(p->known, sizeof *p->truth);
	for (size_t i = 0; p->which && p->truth && i < p->known; i++) {
		float c[3];
		for (int k = 0; k < 3; k++)
			c[k] = (float)scan_value(column[k], match.in_truth[i]);
		p->which[i] = match.in_found[i];
		p->truth[i] = luminance(c);
	}
	matched_scans_clear(&match);
	return GW_OK;
}

static gw_status read_scene(problem *p, const char *scene, const char *truth)
{
	scan known = { 0 };
	settings_input input = { .path = (char *)(uintptr_t)scene };
	gw_status status = settings_add_input(&p->settings, &input, &p->error);
	if (status == GW_OK)
		status = scene_read_all(&p->settings, &p->error);
	if (status == GW_OK)
		status = loaded_scene_read(&p->settings, &p->scene, &p->error);
	if (status == GW_OK)
		status = loaded_scene_lights(&p->scene, &p->settings, &p->own_lights, &p->error);
	if (status == GW_OK)
		status = format_read(truth, NULL, &known, &p->error);
	if (status == GW_OK)
		status = match_truth(p, &known);
	scan_clear(&known);
	p->points = p->scene.points.points;
	p->lights = p->own_lights;
	p->light_count = p->settings.light_count;
	return status;
}

/* ------------------------------------------------------------------------ a scene made here */

static gw_status copy_surface(problem *p)
{
	size_t count = p->mesh_points.count;
	p->albedo = calloc(count, 3 * sizeof *p->albedo);
	p->emission = calloc(count, 3 * sizeof *p->emission);
	if (!p->albedo || !p->emission)
		return gw_fail(&p->error, GW_ERROR_MEMORY, "no memory for %zu points", count);
	for (size_t i = 0; i < count; i++) {
		const mesh_triangle *t = &p->mesh.triangle[p->mesh_points.triangle[i]];
		memcpy(p->albedo + 3 * i, t->albedo, sizeof t->albedo);
		memcpy(p->emission + 3 * i, t->emission, sizeof t->emission);
	}
	p->points = (gw_points){ .count = count,
							 .position = p->mesh_points.position,
							 .normal = p->mesh_points.normal,
							 .albedo = p->albedo,
							 .emission = p->emission };
	p->lights = p->mesh.light;
	p->light_count = p->mesh.light_count;
	return GW_OK;
}

/* Every so many-th point, unless it emits. */
static gw_status trace_truth(problem *p)
{
	size_t step = p->points.count / OWN_TRUTH;
	reference_tracer *tracer = NULL;
	reference_light *light = calloc(OWN_TRUTH, sizeof *light);
	double *surface = calloc(OWN_TRUTH, 3 * sizeof *surface);
	uint32_t *triangle = calloc(OWN_TRUTH, sizeof *triangle);
	p->which = calloc(OWN_TRUTH, sizeof *p->which);
	p->truth = calloc(OWN_TRUTH, sizeof *p->truth);
	gw_status status = GW_ERROR_MEMORY;
	if (light && surface && triangle && p->which && p->truth)
		status = reference_tracer_create(&p->mesh, &tracer, &p->error);
	for (size_t i = 0; status == GW_OK && i < p->points.count && p->known < OWN_TRUTH; i += step) {
		if (p->emission[3 * i] > 0.0f)
			continue;
		memcpy(surface + 3 * p->known, p->mesh_points.surface + 3 * i, 3 * sizeof *surface);
		triangle[p->known] = p->mesh_points.triangle[i];
		p->which[p->known++] = i;
	}
	const reference_places places = {
		.surface = surface, .triangle = triangle, .count = p->known, .paths = OWN_PATHS, .seed = 1
	};
	if (status == GW_OK)
		reference_tracer_light(tracer, &places, light);
	for (size_t i = 0; i < p->known; i++) {
		float c[3];
		for (size_t k = 0; k < 3; k++)
			c[k] = (float)(light[i].direct[k] + light[i].indirect[k]) *
				   p->albedo[3 * p->which[i] + k] * 0.31830988618f;
		p->truth[i] = luminance(c);
	}
	reference_tracer_destroy(&tracer);
	free(light);
	free(surface);
	free(triangle);
	return status;
}

static gw_status make_scene(problem *p)
{
	const mesh_sampling sampling = { .count = OWN_POINTS, .seed = 1 };
	GW_TRY(mesh_scene_make(MESH_CORNELL, &p->mesh, &p->error));
	GW_TRY(mesh_points_make(&p->mesh, &sampling, &p->mesh_points, &p->error));
	GW_TRY(copy_surface(p));
	return trace_truth(p);
}

/* --------------------------------------------------------------------------------- results */

/* Prints one row and books what it reached. radiance: 3 for each point. True when the ladder has
 * come to its end. */
static bool show(problem *p, ladder *l, const char *setting, span took, const float *radiance)
{
	gw_comparison c;
	for (size_t i = 0; i < p->known; i++)
		p->found[i] = luminance(radiance + 3 * p->which[i]);
	if (gw_compare(p->found, p->truth, p->known, &c, &p->error) != GW_OK)
		return true;
	double unit = p->json ? 1.0 : 100.0;
	printf(p->json ? "{\"way\": \"%s\", \"setting\": \"%s\", \"seconds\": %.3f, "
					 "\"processor_seconds\": %.3f, \"relative_rms\": %.5f, \"best_99\": %.5f, "
					 "\"bias\": %.5f}\n"
				   : "%-10s %-26s %8.2f %8.2f %8.2f %8.2f %+8.2f\n",
		   l->name, setting, took.wall, took.busy, unit * c.rel_rmse, unit * c.best_99,
		   unit * c.bias);
	fflush(stdout);
	for (int goal = 0; goal < 2; goal++)
		for (int best = 0; best < 2; best++) {
			span *s = &l->reached[goal][best];
			if ((best ? c.best_99 : c.rel_rmse) <= goals[goal] &&
				(s->busy == 0.0 || took.busy < s->busy))
				*s = took;
		}
	return c.rel_rmse <= p->goal || took.wall > p->seconds;
}

static void print_reached(const ladder *l)
{
	printf("%-10s", l->name);
	for (int goal = 0; goal < 2; goal++)
		for (int best = 0; best < 2; best++) {
			const span *s = &l->reached[goal][best];
			if (s->busy > 0.0)
				printf(" %9.2f (%7.2f)", s->wall, s->busy);
			else
				printf(" %9s %9s", "-", "");
		}
	putchar('\n');
}

static gw_status write_light(problem *p, const char *name, const float *radiance)
{
	static const char *const columns[6] = {
		"x", "y", "z", "scalar_radiance_r", "scalar_radiance_g", "scalar_radiance_b"
	};
	char path[4096];
	scan lit = { .count = p->points.count, .up = 'z' };
	output_file *out = NULL;
	gw_status status = GW_OK;
	for (size_t k = 0; k < 6 && status == GW_OK; k++) {
		scan_column *column =
			scan_add_column(&lit, columns[k], k < 3 ? SCAN_FLOAT64 : SCAN_FLOAT32, &p->error);
		for (size_t i = 0; column && i < lit.count; i++)
			scan_store(column, i,
					   k < 3 ? p->points.position[3 * i + k] : (double)radiance[3 * i + k - 3]);
		status = column ? GW_OK : p->error.status;
	}
	snprintf(path, sizeof path, "%s-%s.ply", p->prefix, name);
	if (status == GW_OK)
		status = output_file_create(&out, path, true, &p->error);
	if (status == GW_OK)
		status = format_by_name("ply")->write(out, &lit, &p->error);
	if (status == GW_OK)
		status = output_file_commit(&out, &p->error);
	output_file_abandon(&out);
	scan_clear(&lit);
	return status;
}

/* ----------------------------------------------------------------------------------- peers */

/* What both peers begin with. */
typedef struct peers {
	peer_discs discs;
	span made;       /* what the discs took */
	float *lamps;    /* 3 a surfel: irradiance */
	float *light;    /* 3 a surfel: the rest of the irradiance, or sums of it */
	float *radiance; /* 3 a point */
} peers;

/* Radiance at the points: that of their surfels. light is divided by `samples`. */
static void fill_radiance(const problem *p, peers *s, uint32_t samples)
{
	const gw_surfels *f = &s->discs.surfels;
	for (size_t i = 0; i < p->points.count; i++) {
		size_t surfel = f->surfel_of_point[i];
		for (size_t k = 0; k < 3 && surfel < f->count; k++) {
			float e = s->lamps[3 * surfel + k] + s->light[3 * surfel + k] / (float)samples;
			float own = f->emission ? f->emission[3 * surfel + k] : 0.0f;
			s->radiance[3 * i + k] = own + 0.31830988618f * f->albedo[3 * surfel + k] * e;
		}
	}
}

/* Indexed by Embree, or not. */
static gw_status make_peers(problem *p, peers *s, bool indexed)
{
	span start = now();
	GW_TRY(peer_discs_make(&p->points, p->lights, p->light_count, &s->discs, &p->error));
	if (indexed)
		GW_TRY(peer_discs_index(&s->discs, &p->error));
	size_t count = s->discs.surfels.count;
	s->lamps = calloc(count, 3 * sizeof *s->lamps);
	s->light = calloc(count, 3 * sizeof *s->light);
	s->radiance = calloc(p->points.count, 3 * sizeof *s->radiance);
	s->made = since(start);
	if (s->lamps && s->light && s->radiance)
		return GW_OK;
	return gw_fail(&p->error, GW_ERROR_MEMORY, "no memory for the light of %zu points", count);
}

static gw_status climb_paths(problem *p, peers *s, ladder *l)
{
	span took = s->made;
	bool over = false;
	for (uint32_t samples = 0, more = 1; !over && samples < 1u << 20; more = samples) {
		char setting[64];
		span start = now();
		if (samples == 0 || s->discs.soft)
			peer_light_lamps(&s->discs, 2 * more, s->lamps);
		peer_light_paths(&s->discs, samples, more, s->light);
		samples += more;
		fill_radiance(p, s, samples);
		took = sum(took, since(start));
		snprintf(setting, sizeof setting, "%u paths", samples);
		over = show(p, l, setting, took, s->radiance);
		over = over || 2.0 * took.wall > p->seconds;
	}
	return p->prefix ? write_light(p, "paths", s->radiance) : GW_OK;
}

/* One count of rays, then more and more filtering. */
static gw_status try_cached(problem *p, peers *s, ladder *l, uint32_t rays, bool *over)
{
	span start = now(), took;
	peer_light_lamps(&s->discs, rays, s->lamps);
	gw_status status = peer_light_cached(&s->discs, rays, s->lamps, s->light, &p->error);
	took = sum(s->made, since(start));
	for (int passes = 0; passes < 5 && status == GW_OK; passes++) {
		char setting[64];
		start = now();
		if (passes > 0)
			status = peer_light_filter(&s->discs, s->light, &p->error);
		fill_radiance(p, s, 1);
		took = sum(took, since(start));
		snprintf(setting, sizeof setting, "%u rays, %d filters", rays, passes);
		*over = show(p, l, setting, took, s->radiance) || *over;
	}
	return status;
}

static gw_status climb_cached(problem *p, peers *s, ladder *l)
{
	bool over = false;
	for (uint32_t rays = 4; !over && rays <= MOST_RAYS; rays *= 2)
		GW_TRY(try_cached(p, s, l, rays, &over));
	if (p->prefix)
		GW_TRY(write_light(p, "cached", s->radiance));
	return GW_OK;
}

/* More and more paths, each time from the beginning: Blender does not go on where it ended. */
static gw_status climb_samples(problem *p, peers *s, ladder *l)
{
	peer_cycles cycles = { 0 };
	bool over = false;
	span start = now();
	gw_status status = peer_cycles_make(&s->discs, p->script, p->scene_path, &cycles, &p->error);
	span made = sum(s->made, since(start));
	for (uint32_t samples = 4; !over && status == GW_OK && samples < 1u << 20; samples *= 2) {
		char setting[64];
		double seconds[2];
		status = peer_cycles_light(&cycles, samples, s->light, seconds, &p->error);
		if (status != GW_OK)
			break;
		span took = sum(made, (span){ seconds[0], seconds[1] });
		fill_radiance(p, s, 1);
		snprintf(setting, sizeof setting, "%u samples", samples);
		over = show(p, l, setting, took, s->radiance) || 2.0 * took.wall > p->seconds;
	}
	peer_cycles_clear(&cycles);
	return status == GW_OK && p->prefix ? write_light(p, "cycles", s->radiance) : status;
}

static gw_status climb_peer(problem *p, ladder *l, gw_status (*climb)(problem *, peers *, ladder *))
{
	peers s = { 0 };
	gw_status status = make_peers(p, &s, climb != climb_samples);
	if (status == GW_OK)
		status = climb(p, &s, l);
	peer_discs_clear(&s.discs);
	free(s.lamps);
	free(s.light);
	free(s.radiance);
	return status;
}

static gw_status climb_path_tracing(problem *p, ladder *l)
{
	return climb_peer(p, l, climb_paths);
}

static gw_status climb_cached_radiance(problem *p, ladder *l)
{
	return climb_peer(p, l, climb_cached);
}

static gw_status climb_cycles(problem *p, ladder *l)
{
	return p->script && p->scene_path ? climb_peer(p, l, climb_samples) : GW_OK;
}

/* -------------------------------------------------------------------------------- the bake */

static gw_status try_bake(problem *p, ladder *l, const gw_bake_options *options,
						  const char *setting, bool *over)
{
	gw_bake_result *result = NULL;
	span start = now();
	gw_status status = gw_bake(&(gw_scene_description){ &p->points, p->lights, p->light_count },
							   options, NULL, &result, &p->error);
	if (status != GW_OK)
		return status;
	*over = show(p, l, setting, since(start), result->radiance);
	if (p->prefix)
		status = write_light(p, "glowworm", result->radiance);
	gw_bake_result_destroy(&result);
	return status;
}

/* Presets with a quarter of their rays and with all, without an estimate of the error, which the
 * peers do not make either. */
static gw_status climb_presets(problem *p, ladder *l)
{
	bool over = false;
	for (int i = 0; i < 6 && !over; i++) {
		gw_bake_options options = gw_bake_options_default();
		char setting[64];
		gw_bake_options_set_quality(&options, (gw_quality)(i / 2));
		options.estimate_points = 0;
		if (i % 2 == 0)
			options.rays = options.light_samples = options.rays / 4;
		snprintf(setting, sizeof setting, "%s, %u rays", gw_quality_name((gw_quality)(i / 2)),
				 options.rays);
		GW_TRY(try_bake(p, l, &options, setting, &over));
	}
	return GW_OK;
}

/* Errors to aim at. */
static gw_status climb_targets(problem *p, ladder *l)
{
	static const float target[3] = { 0.05f, 0.03f, 0.02f };
	bool over = false;
	for (int i = 0; i < 3 && !over; i++) {
		gw_bake_options options = gw_bake_options_default();
		char setting[64];
		gw_bake_options_set_start(&options);
		options.max_error = target[i];
		snprintf(setting, sizeof setting, "--max-error %.2f", (double)target[i]);
		GW_TRY(try_bake(p, l, &options, setting, &over));
	}
	return GW_OK;
}

/* Surfaces of some of the points, and draft and normal settings for each. */
static gw_status climb_surfaces(problem *p, ladder *l)
{
	bool over = false;
	uint32_t points = 50000;
	for (int i = 0; i < 6 && !over && points < p->points.count; i++) {
		gw_bake_options options = gw_bake_options_default();
		gw_quality quality = i % 2 == 0 ? GW_QUALITY_DRAFT : GW_QUALITY_NORMAL;
		char setting[64];
		gw_bake_options_set_quality(&options, quality);
		options.estimate_points = 0;
		options.surface_points = points;
		snprintf(setting, sizeof setting, "%s, surface %u", gw_quality_name(quality), points);
		GW_TRY(try_bake(p, l, &options, setting, &over));
		points *= i % 2 == 0 ? 1 : 4;
	}
	return GW_OK;
}

/* ------------------------------------------------------------------------------------ main */

typedef struct way {
	const char *name;
	gw_status (*climb)(problem *p, ladder *l);
} way;

static const way ways[] = {
	{ "paths", climb_path_tracing }, { "cached", climb_cached_radiance },
	{ "presets", climb_presets },    { "targets", climb_targets },
	{ "surfaces", climb_surfaces },  { "cycles", climb_cycles },
};
#define WAYS (sizeof ways / sizeof *ways)

static bool is_wanted(const problem *p, size_t i)
{
	return !p->way || strcmp(p->way, ways[i].name) == 0;
}

static gw_status measure(problem *p)
{
	ladder ladders[WAYS];
	gw_status status = GW_OK;
	p->found = calloc(p->known ? p->known : 1, sizeof *p->found);
	if (!p->found)
		return gw_fail(&p->error, GW_ERROR_MEMORY, "no memory for %zu points", p->known);
	if (!p->json)
		printf("%zu points, truth of %zu\n\n%-10s %-26s %8s %8s %8s %8s %8s\n", p->points.count,
			   p->known, "", "setting", "seconds", "busy", "relRMSE", "best 99", "bias");
	for (size_t i = 0; i < WAYS && status == GW_OK; i++) {
		ladders[i] = (ladder){ .name = ways[i].name };
		if (is_wanted(p, i))
			status = ways[i].climb(p, &ladders[i]);
	}
	if (p->json || status != GW_OK)
		return status;
	printf("\nseconds (of all processors) to\n%-10s %19s %19s %19s %19s\n", "", "5 %",
		   "5 % of best 99", "3 %", "3 % of best 99");
	for (size_t i = 0; i < WAYS; i++)
		if (is_wanted(p, i))
			print_reached(&ladders[i]);
	return GW_OK;
}

static void clear(problem *p)
{
	loaded_scene_clear(&p->scene);
	settings_clear(&p->settings);
	mesh_scene_clear(&p->mesh);
	mesh_points_clear(&p->mesh_points);
	free(p->albedo);
	free(p->emission);
	free(p->own_lights);
	free(p->which);
	free(p->truth);
	free(p->found);
}

/* Takes the options; the number of arguments behind them, or -1 where one is wrong. */
static int read_options(problem *p, int count, char **argument)
{
	static const struct option long_option[] = { { "way", required_argument, NULL, 'w' },
												 { "blender", required_argument, NULL, 'b' },
												 { "goal", required_argument, NULL, 'g' },
												 { "json", no_argument, NULL, 'j' },
												 { 0 } };
	bool known = true;
	for (int c; known && (c = getopt_long(count, argument, "", long_option, NULL)) != -1;) {
		known = c == 'w' || c == 'j' || c == 'b' || c == 'g';
		p->goal = c == 'g' ? strtod(optarg, NULL) : p->goal;
		p->script = c == 'b' ? optarg : p->script;
		p->json |= c == 'j';
		p->way = c == 'w' ? optarg : p->way;
	}
	bool wanted = !p->way;
	for (size_t i = 0; i < WAYS; i++)
		wanted |= is_wanted(p, i);
	return known && wanted ? count - optind : -1;
}

int main(int count, char **argument)
{
	problem p = { .settings = settings_default(), .goal = goals[1], .seconds = 60.0 };
	int files = read_options(&p, count, argument);
	argument += optind;
	if (files < 0 || files == 1 || files > 4) {
		fputs("Usage: bench_peers [--way paths|cached|presets|targets|surfaces|cycles] [--json]\n"
			  "                   [--blender peer_cycles.py] [SCENE.json TRUTH.ply [SECONDS "
			  "[PREFIX]]]\n",
			  stderr);
		return 2;
	}
	p.scene_path = files > 0 ? argument[0] : NULL;
	if (files > 2)
		p.seconds = strtod(argument[2], NULL);
	if (files > 3)
		p.prefix = argument[3];
	gw_status status = files > 0 ? read_scene(&p, argument[0], argument[1]) : make_scene(&p);
	if (status == GW_OK)
		status = measure(&p);
	if (status != GW_OK)
		fprintf(stderr, "bench_peers: %s\n", p.error.text);
	clear(&p);
	return status == GW_OK ? 0 : 1;
}
