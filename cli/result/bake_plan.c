#include "result/bake_plan.h"
#include "result/light_shares.h"
#include "program/text_quote.h"
#include "points/scan_color.h"
#include "scene/glossy_points.h"
#include "glowworm_host.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#define MEGABYTE 1e6

/* Seconds of an effect that are worth a word. */
#define PRICE_LEAST 0.005

void bake_plan_apply_effects(settings *s)
{
	if (s->bake.effects_forced & 1u << GW_EFFECT_COLUMNS && !(s->fields & SETTINGS_FIELDS_OF_LAMPS))
		s->fields |= 1u << SETTINGS_FIELD_LIGHTS;
}

gw_status bake_plan_apply_motion(settings *s, gw_error *error)
{
	const uint32_t motion = 1u << SETTINGS_EFFECT_MOTION;
	if (s->effects.forced & motion && s->frame_count == 0)
		return gw_fail(error, GW_ERROR_USAGE,
					   "the effect 'motion' is forced, but there are no frames in which anything "
					   "could move: a scene file says how many, \"frames\": N");
	for (size_t i = 0; i < s->input_count && s->effects.forbidden & motion; i++)
		s->input[i].motion = 0;
	for (size_t i = 0; i < s->light_count && s->effects.forbidden & motion; i++)
		s->light[i].motion = 0;
	return GW_OK;
}

gw_bake_options bake_plan_options(const settings *s)
{
	gw_bake_options options = s->bake;
	options.voxels = s->vdb != NULL;
	options.volume = s->vdb_sh != NULL;
	options.ambient_occlusion = s->fields & 1u << SETTINGS_FIELD_AO;
	options.bent_normals = s->fields & 1u << SETTINGS_FIELD_BENT_NORMALS;
	options.errors = s->fields & 1u << SETTINGS_FIELD_ERROR;
	options.unknown = s->fields & 1u << SETTINGS_FIELD_UNKNOWN;
	options.lamps = s->fields & SETTINGS_FIELDS_OF_LAMPS;
	return options;
}

static void add(gw_report *r, const char *name, const char *method, const char *reason)
{
	if (r->effect_count >= GW_REPORT_EFFECTS)
		return;
	gw_effect *e = &r->effect[r->effect_count++];
	*e = (gw_effect){ .called_for = method != NULL };
	snprintf(e->name, sizeof e->name, "%s", name);
	snprintf(e->method, sizeof e->method, "%s", method ? method : "");
	snprintf(e->reason, sizeof e->reason, "%s", reason);
}

static size_t count_glossy(const loaded_scene *scene)
{
	const scan_column *specular = scan_find_scalar(&scene->cloud, "specular");
	size_t glossy = 0;
	for (size_t i = 0; specular && i < scene->cloud.count; i++)
		glossy += glossy_points_share(scan_value(specular, i), 0.0f) > 0.0f;
	return glossy;
}

static size_t count_moving(const settings *s)
{
	size_t moving = 0;
	for (size_t i = 0; i < s->input_count; i++)
		moving += s->input[i].motion > 0;
	for (size_t i = 0; i < s->light_count; i++)
		moving += s->light[i].motion > 0;
	return s->frame_count > 0 ? moving : 0;
}

/* One of the program's own effects; `wanted` by the scene. */
static void decide(gw_report *r, const settings *s, settings_effect effect, bool wanted,
				   const char *method, const char *reason)
{
	char text[sizeof r->effect->reason];
	bool forced = s->effects.forced & 1u << effect;
	if (s->effects.forbidden & 1u << effect) {
		add(r, settings_effect_name(effect), NULL, "it is forbidden");
		return;
	}
	snprintf(text, sizeof text, "%s%s", reason, forced && !wanted ? ", but it is forced" : "");
	add(r, settings_effect_name(effect), wanted || forced ? method : NULL, text);
}

void bake_plan_add_scene(gw_report *r, const settings *s, const loaded_scene *scene)
{
	char reason[sizeof r->effect->reason] = "no point is glossy";
	size_t glossy = count_glossy(scene), moving = count_moving(s);
	if (glossy > 0)
		snprintf(reason, sizeof reason, "%zu point%s glossy: light bounces on with all %s", glossy,
				 gw_plural(glossy, " is", "s are"),
				 gw_plural(glossy, "it reflects", "they reflect"));
	decide(r, s, SETTINGS_EFFECT_GLOSS, glossy > 0, "as matt; `render` shows reflections", reason);
	snprintf(reason, sizeof reason, "nothing moves");
	if (moving > 0)
		snprintf(reason, sizeof reason, "%zu path%s followed in %u frame%s", moving,
				 moving == 1 ? " is" : "s are", s->frame_count, s->frame_count == 1 ? "" : "s");
	decide(r, s, SETTINGS_EFFECT_MOTION, moving > 0, "what stands still is kept between frames",
		   reason);
}

/* Resident memory of this process at its highest so far. */
static uint64_t peak_bytes(void)
{
	struct rusage usage;
	return getrusage(RUSAGE_SELF, &usage) == 0 ? 1024 * (uint64_t)usage.ru_maxrss : 0;
}

/* Resident now; where nobody knows, as much as ever. */
static uint64_t resident_now(void)
{
	unsigned long long pages = 0;
	FILE *file = fopen("/proc/self/statm", "r");
	bool known = file && fscanf(file, "%*u %llu", &pages) == 1;
	if (file)
		fclose(file);
	return known ? pages * (uint64_t)sysconf(_SC_PAGESIZE) : peak_bytes();
}

bake_plan_forecast bake_plan_foretell(const settings *s, const loaded_scene *scene,
									  const gw_bake_result *plan, double read_seconds,
									  size_t row_bytes, uint32_t following)
{
	const gw_report *report = &plan->report;
	uint64_t peak = peak_bytes(), rows = (uint64_t)scene->points.points.count * row_bytes;
	uint64_t later = resident_now() + report->forecast.host_bytes + rows;
	return (bake_plan_forecast){ .settings = s,
								 .scene = scene,
								 .plan = plan,
								 .following = following,
								 .read_seconds = read_seconds,
								 .host_bytes = later > peak ? later : peak,
								 .device_bytes = report->forecast.device_bytes };
}

/* ------------------------------------------------------------------------------ for people */

static void print_effects(const gw_report *r, FILE *out)
{
	for (uint32_t i = 0; i < r->effect_count; i++) {
		const gw_effect *e = &r->effect[i];
		char price[32] = "";
		if (e->seconds >= PRICE_LEAST)
			snprintf(price, sizeof price, "%.2f s", e->seconds);
		fprintf(out, "%-12s %-14s %7s  %s%s%s%s\n", e->name,
				e->called_for ? "called for" : "not called for", price, e->reason,
				*e->method ? " [" : "", e->method, *e->method ? "]" : "");
	}
}

/* One line of figures; of what is not known nothing is said. */
static void print_figures(const char *what, double seconds, uint64_t host, uint64_t device,
						  FILE *out)
{
	fprintf(out, "%-12s %.2f s, %.0f MB of the host, %.0f MB of the device", what, seconds,
			(double)host / MEGABYTE, (double)device / MEGABYTE);
}

static void print_error(double error, double spread, FILE *out)
{
	char percent[TEXT_PERCENT], around[TEXT_PERCENT];
	if (error > 0.0)
		fprintf(out, ", error %s %% +- %s %%", text_percent(error, percent),
				text_percent(spread, around));
}

static void print_rest(uint32_t bounces, double remaining, FILE *out)
{
	char rest[TEXT_PERCENT];
	if (bounces > 1)
		fprintf(out, ", %" PRIu32 " reflections, the rest would add at most %s %%", bounces,
				text_percent(remaining, rest));
	fputc('\n', out);
}

/* Of reading and baking, all frames together. */
static double all_seconds(const bake_plan_forecast *p)
{
	const gw_forecast *f = &p->plan->report.forecast;
	return p->read_seconds + f->seconds + p->following * f->frame_seconds;
}

void bake_plan_print(const bake_plan_forecast *p, FILE *out)
{
	const gw_forecast *f = &p->plan->report.forecast;
	print_effects(&p->plan->report, out);
	light_shares_print_plan(&(light_shares){ p->settings, p->scene, p->plan, 0 }, out);
	if (!(f->seconds > 0.0))
		return;
	print_figures("foretold", all_seconds(p), p->host_bytes, p->device_bytes, out);
	print_error(f->error, f->spread, out);
	if (f->error_is_least)
		fprintf(out, f->error > 0.0 ? " or more: half of the points will tell by how much"
									: ", error not foretold: half of the points will tell it");
	print_rest(f->bounces, f->remaining, out);
	if (p->following > 0)
		fprintf(out, "%-12s the first frame by %.2f s, each of %" PRIu32 " more in %.2f s\n", "",
				p->read_seconds + f->seconds, p->following, f->frame_seconds);
	else if (f->cell_rays > 0)
		fprintf(out,
				"%-12s by cells lit with %" PRIu32 " of %" PRIu32
				" rays each, which took %.2f s; %.2f s were done by then\n",
				"", f->cell_rays, p->settings->bake.rays, f->own_seconds,
				p->read_seconds + f->done_seconds);
	else if (f->places > 0)
		fprintf(out,
				"%-12s by light gathered at %" PRIu32 " of %" PRIu64
				" places, which took %.2f s; %.2f s were done by then\n",
				"", f->places, f->records, f->own_seconds, p->read_seconds + f->done_seconds);
}

void bake_plan_print_outcome(const gw_report *came, double seconds, FILE *out)
{
	print_figures("came", seconds, peak_bytes(), came->peak_bytes, out);
	char percent[TEXT_PERCENT];
	print_error(came->error.relative_rms, came->error.spread, out);
	if (came->error.halves > 0.0)
		fprintf(out, ", of it %s %% by half of the points",
				text_percent(came->error.halves, percent));
	print_rest(came->bounce_count, came->remaining, out);
}

/* ---------------------------------------------------------------------------------- as JSON */

void bake_plan_write_effects(json_writer *json, const gw_report *r)
{
	json_put_open(json, "plan", '[');
	for (uint32_t i = 0; i < r->effect_count; i++) {
		json_put_open_flat(json, NULL, '{');
		json_put_text(json, "effect", r->effect[i].name);
		json_put_bool(json, "called_for", r->effect[i].called_for);
		json_put_text(json, "reason", r->effect[i].reason);
		json_put_text(json, "method", r->effect[i].method);
		json_put_real(json, "seconds", r->effect[i].seconds);
		json_put_close(json, '}');
	}
	json_put_close(json, ']');
}

void bake_plan_write_forecast(json_writer *json, const bake_plan_forecast *p)
{
	const gw_forecast *f = &p->plan->report.forecast;
	json_put_open_flat(json, "forecast", '{');
	json_put_real(json, "seconds", all_seconds(p));
	if (p->following > 0) {
		json_put_real(json, "first_frame_seconds", p->read_seconds + f->seconds);
		json_put_real(json, "frame_seconds", f->frame_seconds);
	}
	json_put_real(json, "done_seconds", p->read_seconds + f->done_seconds);
	json_put_real(json, "own_seconds", f->own_seconds);
	json_put_count(json, "host_bytes", p->host_bytes);
	json_put_count(json, "device_bytes", p->device_bytes);
	json_put_real(json, "error", f->error);
	json_put_real(json, "spread", f->spread);
	json_put_bool(json, "error_is_least", f->error_is_least);
	json_put_count(json, "reflections", f->bounces);
	json_put_real(json, "remaining", f->remaining);
	json_put_real(json, "rays_that_leave", f->escaped);
	json_put_count(json, "records", f->records);
	json_put_count(json, "places", f->places);
	json_put_close(json, '}');
}
