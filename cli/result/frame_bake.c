#include "result/frame_bake.h"
#include "scene/file_roles.h"
#include "program/json_writer.h"
#include "result/light_shares.h"
#include "result/lit_scan.h"
#include "files/number_text.h"
#include "table/format_table.h"
#include "options/preview.h"
#include "scene/scene_file.h"
#include "program/signals.h"
#include "glowworm_host.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static const char *const position_names[3] = { "x", "y", "z" };
static const char *const normal_names[3] = { "nx", "ny", "nz" };

static double now(void)
{
	struct timespec time;
	clock_gettime(CLOCK_MONOTONIC, &time);
	return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

/* --------------------------------------------------------------------------- which, and names */

/* "all", "7" or "10..20". */
static gw_status find_range(const settings *s, uint32_t *first, uint32_t *last, gw_error *error)
{
	const char *text = s->frames;
	char *end = NULL;
	*first = 0;
	*last = s->frame_count - 1;
	if (strcmp(text, "all") == 0)
		return GW_OK;
	unsigned long long a = *text >= '0' && *text <= '9' ? strtoull(text, &end, 10) : 0, b = a;
	bool good = end != NULL;
	if (good && strncmp(end, "..", 2) == 0 && end[2] >= '0' && end[2] <= '9')
		b = strtoull(end + 2, &end, 10);
	if (!good || *end)
		return gw_fail(error, GW_ERROR_USAGE,
					   "--frames %.60s: give all, one frame, or the first and the last as 10..20",
					   text);
	if (b < a || b >= s->frame_count)
		return gw_fail(error, GW_ERROR_USAGE,
					   "--frames %.60s: the scene has frames 0 to %u; give the first one first",
					   text, s->frame_count - 1);
	*first = (uint32_t)a;
	*last = (uint32_t)b;
	return GW_OK;
}

/* The place of the frame's number in a name, "%04d" or the like; its length, 0: there is none. */
static size_t find_number(const char *name, const char **at, unsigned *width)
{
	*at = strchr(name, '%');
	*width = 0;
	if (*at == NULL)
		return 0;
	size_t digits = strspn(*at + 1, "0123456789");
	if (digits > 2 || (*at)[1 + digits] != 'd')
		return 0;
	*width = (unsigned)strtoul(*at + 1, NULL, 10);
	return digits + 2;
}

/* FILE-0007.ply of FILE.ply, or with the number where the name says %04d. For free(). */
static char *name_frame(const char *path, uint32_t frame)
{
	const char *at;
	unsigned width;
	char *name = NULL;
	size_t length = find_number(path, &at, &width);
	int stem = (int)(format_extension(path) - path);
	int written = length ? asprintf(&name, "%.*s%0*u%s", (int)(at - path), path, (int)width, frame,
									at + length)
						 : asprintf(&name, "%.*s-%04u%s", stem, path, frame, path + stem);
	return written < 0 ? NULL : name;
}

static char *name_of_series(const void *user, size_t index)
{
	const settings *s = user;
	uint32_t first, last;
	find_range(s, &first, &last, NULL);
	return name_frame(s->output, first + (uint32_t)index);
}

/* No file is an input, or there already. */
static gw_status check_files(const settings *s, uint32_t first, uint32_t last, gw_error *error)
{
	const file_series frames = { s->output ? last - first + 1 : 0, name_of_series, s };
	gw_status status = file_roles_check(VERB_BAKE, s, &frames, error);
	for (uint32_t f = first; status == GW_OK && s->output && f <= last; f++) {
		char *name = name_frame(s->output, f);
		if (!name)
			status = gw_fail(error, GW_ERROR_MEMORY, "no memory for a name");
		else
			status = output_file_check(name, s->force, error);
		free(name);
	}
	return status;
}

gw_status frame_bake_check(const settings *s, gw_error *error)
{
	uint32_t first, last;
	const char *at;
	unsigned width;
	if (s->frames == NULL)
		return s->rebuild || s->independent ? gw_fail(error, GW_ERROR_USAGE, "--%s needs --frames",
													  s->rebuild ? "rebuild" : "independent")
											: GW_OK;
	if (s->frame_count == 0)
		return gw_fail(error, GW_ERROR_USAGE,
					   "--frames needs a scene file that says how many frames there are: "
					   "\"frames\": N");
	if (s->vdb || s->vdb_sh || s->transport || s->save_transport)
		return gw_fail(error, GW_ERROR_USAGE, "--frames writes points; leave out --%s",
					   s->vdb         ? "vdb"
					   : s->vdb_sh    ? "vdb-sh"
					   : s->transport ? "transport"
									  : "save-transport");
	if (s->output && (strcmp(s->output, "-") == 0 || !strchr(s->output, '.')))
		return gw_fail(error, GW_ERROR_USAGE,
					   "--frames needs a file name with an extension, to which numbers are added");
	if (s->output && strchr(s->output, '%') && find_number(s->output, &at, &width) == 0)
		return gw_fail(error, GW_ERROR_USAGE,
					   "%s: a frame's number is put in place of %%d or %%04d; this %% is neither",
					   s->output);
	GW_TRY(find_range(s, &first, &last, error));
	return check_files(s, first, last, error);
}

/* ------------------------------------------------------------------------------------- motion */

/* The inputs that move, as the library takes them. */
typedef struct movers {
	gw_motion motion;
	gw_mover *mover;
	double *matrix;
} movers;

static void clear_movers(movers *m)
{
	free(m->mover);
	free(m->matrix);
	*m = (movers){ 0 };
}

static gw_status make_movers(const settings *s, const loaded_scene *scene, movers *m,
							 gw_error *error)
{
	size_t count = 0, first = 0;
	for (size_t i = 0; i < s->input_count; i++)
		count += s->input[i].motion > 0;
	*m = (movers){ .mover = calloc(count + 1, sizeof *m->mover) };
	if (count == 0 || count <= SIZE_MAX / (16 * sizeof(double)) / s->frame_count)
		m->matrix = calloc(s->frame_count * count + 1, 16 * sizeof *m->matrix);
	if (!m->mover || !m->matrix) {
		clear_movers(m);
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu paths of %u frames", count,
					   s->frame_count);
	}
	size_t at = 0;
	for (size_t i = 0; i < s->input_count; i++) {
		const settings_input *input = &s->input[i];
		size_t points = scene->input[i].points;
		if (input->motion > 0) {
			m->mover[at] = (gw_mover){ first, points };
			for (uint32_t f = 0; f < s->frame_count; f++)
				motion_path_matrix(&s->path[input->motion - 1], input->matrix, f,
								   m->matrix + 16 * (f * count + at));
			at++;
		}
		first += points;
	}
	m->motion = (gw_motion){
		.mover = m->mover, .mover_count = count, .frame_count = s->frame_count, .matrix = m->matrix
	};
	return GW_OK;
}

static gw_status lights_at(const settings *s, const loaded_scene *scene, uint32_t frame,
						   gw_light *lights, gw_error *error)
{
	for (size_t i = 0; i < s->light_count; i++) {
		lamp light = s->light[i];
		gw_error reason = { 0 };
		gw_status status = GW_OK;
		if (light.motion > 0)
			status = motion_path_lamp(&s->path[light.motion - 1], frame, &light, &reason);
		if (status != GW_OK)
			return gw_fail(error, status, "light %zu in frame %u: %.600s", i + 1, frame,
						   reason.text);
		loaded_scene_place(&scene->place, scene->up, &light);
		lights[i] = light.light;
		loaded_scene_put_map(scene, &light, i, &lights[i]);
	}
	return GW_OK;
}

/* The same in an array for free(). */
static gw_status make_lights(const settings *s, const loaded_scene *scene, uint32_t frame,
							 gw_light **lights, gw_error *error)
{
	*lights = calloc(s->light_count + 1, sizeof **lights);
	if (!*lights)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu lights", s->light_count);
	return lights_at(s, scene, frame, *lights, error);
}

/* Three columns of the points of a mover, times a matrix. */
static void move_rows(scan *cloud, const char *const name[3], const gw_mover *mover,
					  const double m[16], bool normals)
{
	scan_column *column[3];
	for (int k = 0; k < 3; k++) {
		column[k] = scan_find(cloud, name[k]);
		if (!column[k] || (column[k]->type != SCAN_FLOAT32 && column[k]->type != SCAN_FLOAT64))
			return;
	}
	double scale =
		normals
			? cbrt(fabs(m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8]) +
						m[2] * (m[4] * m[9] - m[5] * m[8])))
			: 1.0;
	for (size_t i = mover->first; i < mover->first + mover->count; i++) {
		double v[3];
		for (int k = 0; k < 3; k++)
			v[k] = scan_value(column[k], i);
		for (int k = 0; k < 3; k++) {
			const double *row = m + 4 * k;
			double moved = (row[0] * v[0] + row[1] * v[1] + row[2] * v[2]) / scale;
			scan_store(column[k], i, normals ? moved : moved + row[3]);
		}
	}
}

static void move_cloud(const movers *m, uint32_t frame, scan *cloud)
{
	for (size_t i = 0; i < m->motion.mover_count; i++) {
		const double *matrix = m->matrix + 16 * (frame * m->motion.mover_count + i);
		move_rows(cloud, position_names, &m->mover[i], matrix, false);
		move_rows(cloud, normal_names, &m->mover[i], matrix, true);
	}
}

/* ------------------------------------------------------------------------------- the first one */

gw_status frame_bake_first(settings *s, loaded_scene *scene, const gw_bake_options *options,
						   const gw_bake_callbacks *callbacks, gw_bake_result **result,
						   gw_error *error)
{
	movers m;
	gw_frames *frames = NULL;
	const gw_frames_options how = { .rebuild = true };
	*result = NULL;
	GW_TRY(make_movers(s, scene, &m, error));
	gw_light *lights = NULL;
	gw_status status = make_lights(s, scene, 0, &lights, error);
	if (status == GW_OK)
		status = gw_frames_open(
			&(gw_moving_scene){ { &scene->points.points, lights, s->light_count }, &m.motion },
			options, &how, callbacks, &frames, error);
	if (status == GW_OK)
		status = gw_frames_bake(frames, 0, lights, s->light_count, result, error);
	gw_frames_close(&frames);
	if (status == GW_OK)
		move_cloud(&m, 0, &scene->cloud);
	clear_movers(&m);
	free(lights);
	return status;
}

/* ------------------------------------------------------------------------------------- a plan */

/* Which two frames stand for all. */
typedef struct frame_plan_task {
	size_t first, second;
	const gw_bake_callbacks *callbacks;
	gw_bake_result **plan;
	gw_error *error;
} frame_plan_task;

/* The frames that are asked for: those of settings->frames, else frame 0. */
static gw_status asked_frames(const settings *s, uint32_t *first, uint32_t *last, gw_error *error)
{
	*first = *last = 0;
	return s->frames ? find_range(s, first, last, error) : GW_OK;
}

uint32_t frame_bake_following(const settings *s)
{
	uint32_t first, last;
	return s->frame_count > 0 && asked_frames(s, &first, &last, NULL) == GW_OK ? last - first : 0;
}

/* lights: of the frame by which normals are oriented, and of the two that are planned. */
static gw_status plan_frames(const settings *s, const loaded_scene *scene, const movers *m,
							 gw_light *const lights[3], const frame_plan_task *task)
{
	const gw_bake_options options = bake_plan_options(s);
	const gw_frames_options how = { .rebuild = s->rebuild || !s->frames,
									.independent = s->independent };
	const gw_moving_scene moving = { { &scene->points.points, lights[0], s->light_count },
									 &m->motion };
	gw_frames *frames = NULL;
	GW_TRY(gw_frames_open(&moving, &options, &how, task->callbacks, &frames, task->error));
	gw_status status = gw_frames_plan(frames, (size_t[2]){ task->first, task->second },
									  (const gw_light *const[2]){ lights[1], lights[2] },
									  s->light_count, task->plan, task->error);
	gw_frames_close(&frames);
	return status;
}

gw_status frame_bake_plan(const settings *s, const loaded_scene *scene,
						  const gw_bake_callbacks *callbacks, gw_bake_result **plan,
						  gw_error *error)
{
	frame_plan_task task = { .callbacks = callbacks, .plan = plan, .error = error };
	uint32_t first, last;
	movers m;
	gw_light *lights[3] = { NULL };
	*plan = NULL;
	GW_TRY(asked_frames(s, &first, &last, error));
	task.first = first;
	task.second = first + (last - first + 1) / 2;
	GW_TRY(make_movers(s, scene, &m, error));
	const uint32_t at[3] = { 0, first, (uint32_t)task.second };
	gw_status status = GW_OK;
	for (int i = 0; status == GW_OK && i < 3; i++)
		status = make_lights(s, scene, at[i], &lights[i], error);
	if (status == GW_OK)
		status = plan_frames(s, scene, &m, lights, &task);
	for (int i = 0; i < 3; i++)
		free(lights[i]);
	clear_movers(&m);
	return status;
}

/* -------------------------------------------------------------------------------- all of them */

/* What one frame took, for the report. */
typedef struct frame_facts {
	uint32_t frame;
	char *file; /* owned, or NULL */
	double bake_seconds, write_seconds;
	double mean_luminance;
	gw_report report;      /* without its bounces */
	gw_light_given *given; /* owned; given_count, or NULL */
	size_t given_count;
	double gathered_share;
} frame_facts;

/* A run over frames. */
typedef struct frame_run {
	bake_facts *facts;
	settings *settings;
	loaded_scene *scene;
	const format *format;
	progress *progress;
	gw_frames *frames;
	movers movers;
	gw_light *lights;
	uint32_t first, last, at;
	frame_facts *done; /* last - first + 1, of which at - first are filled */
	double shared_seconds;
	gw_error *error;
} frame_run;

static void on_progress(void *user, const char *stage, double done)
{
	const frame_run *r = user;
	char text[80];
	snprintf(text, sizeof text, "frame %u: %s", r->at, stage);
	progress_show(r->progress, text,
				  ((double)(r->at - r->first) + done) / (double)(r->last - r->first + 1));
}

static bool on_cancelled(void *user)
{
	(void)user;
	return signals_pending() != 0;
}

static gw_status copy_scan(const scan *from, scan *to, gw_error *error)
{
	*to = (scan){ .count = from->count, .up = from->up, .left_out = from->left_out };
	for (size_t c = 0; c < from->column_count; c++) {
		const scan_column *column = &from->column[c];
		scan_column *copy = scan_add_column(to, column->name, column->type, error);
		if (!copy)
			return GW_ERROR_MEMORY;
		memcpy(copy->data, column->data, from->count * scan_type_size(column->type));
	}
	for (size_t c = 0; c < from->comment_count; c++)
		GW_TRY(scan_add_comment(to, from->comment[c], error));
	return GW_OK;
}

/* The points as they are in the frame, with their light. */
static gw_status make_lit(frame_run *r, const gw_bake_result *result, scan *lit)
{
	loaded_scene scene = *r->scene;
	char text[64];
	gw_status status = copy_scan(&r->scene->cloud, &scene.cloud, r->error);
	if (status == GW_OK) {
		move_cloud(&r->movers, r->at, &scene.cloud);
		status = lit_scan_make(&scene, result, r->settings, lit, &r->facts->exposure, r->error);
	}
	scan_clear(&scene.cloud);
	snprintf(text, sizeof text, "glowworm frame: %u of 0..%u", r->at, r->settings->frame_count - 1);
	if (status == GW_OK)
		status = scan_add_comment(lit, text, r->error);
	/* Pictures of a sequence are exposed alike. */
	if (isnan(r->settings->exposure))
		r->settings->exposure = (float)r->facts->exposure;
	return status;
}

static gw_status write_output(frame_run *r, const scan *lit, const char *name, output_file **output)
{
	GW_TRY(output_file_create(output, name, r->settings->force, r->error));
	output_file_use_threads(*output, r->settings->bake.threads);
	GW_TRY(r->format->write(*output, lit, r->error));
	GW_TRY(signals_check(r->error));
	return output_file_commit(output, r->error);
}

static gw_status write_frame(frame_run *r, const gw_bake_result *result, const char *name)
{
	scan lit = { 0 };
	output_file *output = NULL;
	gw_status status = make_lit(r, result, &lit);
	if (status == GW_OK)
		status = name ? write_output(r, &lit, name, &output) : signals_check(r->error);
	output_file_abandon(&output);
	scan_clear(&lit);
	return status;
}

static double mean_luminance(const gw_bake_result *result)
{
	double sum = 0.0;
	for (size_t i = 0; i < result->count; i++)
		sum += preview_luminance(result->radiance + 3 * i);
	return result->count > 0 ? sum / (double)result->count : 0.0;
}

static void say(const frame_run *r, const frame_facts *f)
{
	progress_clear(r->progress);
	if (r->settings->verbose && !r->settings->quiet)
		fprintf(stderr, "glowworm: frame %u: %.2f s baking, %.2f s writing, %u bounces%s%s\n",
				f->frame, f->bake_seconds, f->write_seconds, f->report.bounce_count,
				f->file ? ", " : "", f->file ? f->file : "");
	if (r->settings->profile)
		bake_report_profile(&f->report, r->at != r->first && !r->settings->rebuild);
}

/* What the first frame says of all: what is wrong with the points, and how wrong that makes the
 * light. No frame is baked to an error, and so none is offered. */
static void note_first(frame_run *r, gw_bake_result *result)
{
	if (r->at != r->first || r->settings->quiet)
		return;
	progress_clear(r->progress);
	result->report.price = (gw_price){ 0 };
	r->facts->result = result;
	r->facts->frames = r->last - r->first + 1;
	bake_report_notes(r->facts);
	bake_report_error(r->facts);
	r->facts->result = NULL;
}

static gw_status bake_frame(frame_run *r)
{
	const settings *s = r->settings;
	frame_facts *f = &r->done[r->at - r->first];
	gw_bake_result *result = NULL;
	double start = now(), shared = gw_frames_shared_seconds(r->frames);
	f->frame = r->at;
	gw_status status = lights_at(s, r->scene, r->at, r->lights, r->error);
	if (status == GW_OK)
		status = gw_frames_bake(r->frames, r->at, r->lights, s->light_count, &result, r->error);
	GW_TRY(status);
	shared = s->rebuild ? 0.0 : gw_frames_shared_seconds(r->frames) - shared;
	f->bake_seconds = now() - start - shared;
	r->shared_seconds += shared;
	f->report = result->report;
	f->report.bounce = NULL;
	f->given = result->given;
	f->given_count = result->given_count;
	f->gathered_share = result->gathered_share;
	result->given = NULL;
	f->mean_luminance = mean_luminance(result);
	start = now();
	if (s->output && !(f->file = name_frame(s->output, r->at)))
		status = gw_fail(r->error, GW_ERROR_MEMORY, "no memory for a name");
	if (status == GW_OK)
		status = write_frame(r, result, f->file);
	f->write_seconds = now() - start;
	if (status == GW_OK)
		note_first(r, result);
	gw_bake_result_destroy(&result);
	if (status == GW_OK)
		say(r, f);
	return status;
}

static void put_frame(json_writer *json, const frame_facts *f)
{
	const gw_report *r = &f->report;
	json_put_open_flat(json, NULL, '{');
	json_put_count(json, "frame", f->frame);
	if (f->file)
		json_put_text(json, "file", f->file);
	json_put_real(json, "bake_seconds", f->bake_seconds);
	json_put_real(json, "write_seconds", f->write_seconds);
	json_put_count(json, "leaves", r->leaves);
	json_put_count(json, "records", r->records);
	json_put_count(json, "rays", r->rays);
	json_put_count(json, "rays_traced", r->rays_traced);
	json_put_count(json, "bounces", r->bounce_count);
	json_put_real(json, "remaining", r->remaining);
	json_put_real(json, "mean_luminance", f->mean_luminance);
	json_put_open_flat(json, "stages", '{');
	for (uint32_t i = 0; i < r->stage_count; i++)
		json_put_real(json, r->stage[i].name, r->stage[i].seconds);
	json_put_close(json, '}');
	if (r->error.points)
		json_put_real(json, "relative_rms", r->error.relative_rms);
	json_put_open_flat(json, "light_shares", '[');
	for (size_t i = 0; i < f->given_count; i++)
		json_put_real(json, NULL, f->given[i].share);
	json_put_close(json, ']');
	json_put_close(json, '}');
}

static void put_report(const frame_run *r, json_writer *json)
{
	const settings *s = r->settings;
	const gw_report *report = &r->done[0].report;
	double seconds = 0.0;
	json_put_open(json, NULL, '{');
	json_put_text(json, "glowworm", GW_VERSION);
	json_put_text(json, "command", s->command);
	json_put_count(json, "points", r->scene->cloud.count);
	scene_write_members(json, s);
	json_put_text(json, "device", report->device);
	json_put_text(json, "driver", report->driver);
	json_put_count(json, "depth", report->depth);
	json_put_real(json, "leaf_size", report->leaf_size);
	if (report->wanted_leaf_size > 0.0) {
		json_put_real(json, "wanted_leaf_size", report->wanted_leaf_size);
		json_put_text(json, "why_coarser", report->why_coarser);
	}
	json_put_bool(json, "rebuild", s->rebuild);
	json_put_bool(json, "independent", s->independent);
	json_put_real(json, "read_seconds", r->facts->read_seconds);
	json_put_real(json, "shared_seconds", r->shared_seconds);
	for (uint32_t i = r->first; i <= r->last; i++)
		seconds += r->done[i - r->first].bake_seconds;
	json_put_real(json, "seconds_a_frame", seconds / (double)(r->last - r->first + 1));
	json_put_open(json, "frames", '[');
	for (uint32_t i = r->first; i <= r->last; i++)
		put_frame(json, &r->done[i - r->first]);
	json_put_close(json, ']');
	json_put_close(json, '}');
}

static gw_status write_report(const frame_run *r, output_file *out)
{
	char *text = NULL;
	size_t length;
	FILE *stream = open_memstream(&text, &length);
	if (!stream)
		return gw_fail(r->error, GW_ERROR_MEMORY, "no memory for the report");
	put_report(r, &(json_writer){ .out = stream, .lines = true });
	fputc('\n', stream);
	gw_status status = fclose(stream) == 0
						   ? output_file_write(out, text, length, r->error)
						   : gw_fail(r->error, GW_ERROR_MEMORY, "no memory for the report");
	free(text);
	return status;
}

/* first: the lights of frame 0. Normals are oriented as in that, whichever frames are asked for. */
static gw_status bake_frames(frame_run *r, const gw_light *first)
{
	const settings *s = r->settings;
	const gw_frames_options how = { .rebuild = s->rebuild, .independent = s->independent };
	const gw_bake_callbacks callbacks = { on_progress, on_cancelled, r, NULL };
	const gw_bake_options options = bake_plan_options(s);
	r->lights = calloc(s->light_count + 1, sizeof *r->lights);
	r->done = calloc(r->last - r->first + 1, sizeof *r->done);
	if (!r->lights || !r->done)
		return gw_fail(r->error, GW_ERROR_MEMORY, "no memory for the frames");
	GW_TRY(gw_frames_open(&(gw_moving_scene){ { &r->scene->points.points, first, s->light_count },
											  &r->movers.motion },
						  &options, &how, &callbacks, &r->frames, r->error));
	for (r->at = r->first; r->at <= r->last; r->at++)
		GW_TRY(bake_frame(r));
	return GW_OK;
}

static gw_status run(frame_run *r)
{
	gw_light *first = NULL;
	r->at = r->first;
	gw_status status = make_movers(r->settings, r->scene, &r->movers, r->error);
	if (status == GW_OK)
		status = make_lights(r->settings, r->scene, 0, &first, r->error);
	if (status == GW_OK)
		status = bake_frames(r, first);
	gw_frames_close(&r->frames);
	free(first);
	return status;
}

/* All frames together, beside what was foretold. */
static void print_outcome(const frame_run *r)
{
	gw_report all = r->done[0].report; /* it has the error */
	double seconds = r->facts->read_seconds + r->shared_seconds;
	for (uint32_t i = 0; i <= r->last - r->first; i++) {
		seconds += r->done[i].bake_seconds;
		if (r->done[i].report.peak_bytes > all.peak_bytes)
			all.peak_bytes = r->done[i].report.peak_bytes;
	}
	bake_plan_print_outcome(&all, seconds, stderr);
}

/* What each lamp gives in the mean of all frames. Of one that gives nothing in any of them it is
 * told why, by the first. */
static void print_shares(const frame_run *r)
{
	size_t count = r->done[0].given_count;
	uint32_t frames = r->last - r->first + 1;
	gw_bake_result mean = { .given = calloc(count + 1, sizeof *mean.given), .given_count = count };
	mean.report.error = r->done[0].report.error;
	if (!mean.given)
		return;
	for (size_t i = 0; i < count; i++)
		mean.given[i].fate = r->done[0].given[i].fate;
	for (uint32_t f = 0; f < frames; f++) {
		mean.gathered_share += r->done[f].gathered_share / frames;
		for (size_t i = 0; i < count && r->done[f].given; i++) {
			mean.given[i].share += r->done[f].given[i].share / frames;
			if (r->done[f].given[i].fate == GW_LIGHT_SHINES)
				mean.given[i].fate = GW_LIGHT_SHINES;
		}
	}
	light_shares_print(&(light_shares){ r->settings, r->scene, &mean, frames });
	free(mean.given);
}

gw_status frame_bake_all(bake_facts *facts, settings *s, loaded_scene *scene,
						 const frame_outputs *to, gw_error *error)
{
	frame_run r = { .facts = facts,
					.settings = s,
					.scene = scene,
					.format = to->written_as,
					.progress = to->shown,
					.error = error };
	gw_status status = find_range(s, &r.first, &r.last, error);
	if (status == GW_OK)
		status = run(&r);
	if (status == GW_OK && to->report)
		status = write_report(&r, to->report);
	if (status == GW_OK && !s->quiet && !s->verbose) {
		progress_clear(to->shown);
		uint32_t count = r.last - r.first + 1;
		fprintf(stderr, "glowworm: note: %u frame%s\n", count, gw_plural(count, "", "s"));
	}
	if (status == GW_OK && !s->quiet)
		print_shares(&r);
	if (status == GW_OK && facts->forecast.plan)
		print_outcome(&r);
	clear_movers(&r.movers);
	for (uint32_t i = 0; r.done && i <= r.last - r.first; i++) {
		free(r.done[i].file);
		free(r.done[i].given);
	}
	free(r.done);
	free(r.lights);
	return status;
}
