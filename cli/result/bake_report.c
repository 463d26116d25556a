#include "result/bake_report.h"
#include "result/light_shares.h"
#include "program/exit_code.h"
#include "program/json_writer.h"
#include "scene/octree_note.h"
#include "scene/parted_cloud.h"
#include "options/options.h"
#include "options/preview.h"
#include "scene/scene_file.h"
#include "program/text_quote.h"
#include "glowworm_host.h"
#include "glowworm_parts.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MEGABYTE 1e6
#define PART_LEAST 0.003  /* share of the mean radiance from which on errors are worth a word, */
#define PART_SHARE 0.25   /* and of the whole error */
#define DOUBT_LEAST 0.1   /* share of the mean radiance that hangs on guesses: is said first */
#define PARTS_TOLD 2      /* so many of them */
#define DARK 0.001        /* of the mean radiance: less is dark, */
#define DARK_SHARE 0.75   /* and worth a word from this share of the points on */
#define GAPS_LEAST 0.01   /* share of the light through gaps, from which on they are told */
#define GUESSED_LEAST 0.1 /* of the mean radiance: more in doubt is told */
#define WRONG_LEAST 0.001 /* of the points: of fewer, those lit from both sides are what counts */

/* ------------------------------------------------------------------------------ the file */

static void write_inputs(json_writer *json, const bake_facts *f)
{
	json_put_open(json, "inputs", '[');
	for (size_t i = 0; i < f->scene->input_count; i++) {
		const loaded_input *input = &f->scene->input[i];
		json_put_open_flat(json, NULL, '{');
		json_put_text(json, "file", input->path);
		json_put_text(json, "format", input->format->name);
		json_put_count(json, "points", input->points);
		json_put_count(json, "left_out", input->left_out);
		json_put_text(json, "albedo", input->albedo_source);
		json_put_close(json, '}');
	}
	json_put_close(json, ']');
}

static void write_counts(json_writer *json, const gw_report *r)
{
	json_put_open(json, "counts", '[');
	for (uint32_t i = 0; i < r->count_count; i++) {
		json_put_open_flat(json, NULL, '{');
		json_put_text(json, "name", r->count[i].name);
		json_put_count(json, "points", r->count[i].points);
		json_put_text(json, "meaning", r->count[i].meaning);
		json_put_close(json, '}');
	}
	json_put_close(json, ']');
}

static void write_strays(json_writer *json, const gw_report *r)
{
	json_put_open(json, "strays", '[');
	for (int kind = 0; kind < GW_STRAY_KIND_COUNT; kind++) {
		const gw_stray_count *count = &r->stray[kind];
		if (count->points == 0)
			continue;
		json_put_open_flat(json, NULL, '{');
		json_put_text(json, "kind", gw_stray_kind_name((gw_stray_kind)kind));
		json_put_count(json, "points", count->points);
		json_put_count(json, "example", count->example);
		json_put_reals(json, "position", count->position, 3);
		json_put_close(json, '}');
	}
	json_put_close(json, ']');
}

static void write_stages(json_writer *json, const bake_facts *f)
{
	const gw_report *r = &f->result->report;
	json_put_open(json, "stages", '[');
	for (uint32_t i = 0; i < r->stage_count; i++) {
		json_put_open_flat(json, NULL, '{');
		json_put_text(json, "name", r->stage[i].name);
		json_put_real(json, "seconds", r->stage[i].seconds);
		json_put_real(json, "device_seconds", r->stage[i].device_seconds);
		json_put_real(json, "compile_seconds", r->stage[i].compile_seconds);
		json_put_count(json, "bytes", r->stage[i].bytes);
		json_put_count(json, "dispatches", r->stage[i].dispatches);
		json_put_count(json, "submissions", r->stage[i].submissions);
		json_put_count(json, "uploaded_bytes", r->stage[i].uploaded_bytes);
		json_put_count(json, "downloaded_bytes", r->stage[i].downloaded_bytes);
		json_put_close(json, '}');
	}
	json_put_close(json, ']');
	json_put_open(json, "pass_runs", '[');
	for (uint32_t i = 0; i < r->pass_count; i++) {
		json_put_open_flat(json, NULL, '{');
		json_put_text(json, "name", r->pass[i].name);
		json_put_count(json, "runs", r->pass[i].runs);
		json_put_count(json, "compiled", r->pass[i].compiled);
		json_put_close(json, '}');
	}
	json_put_close(json, ']');
	json_put_open_flat(json, "seconds", '{');
	json_put_real(json, "read", f->read_seconds);
	json_put_real(json, "bake", f->bake_seconds);
	json_put_real(json, "write", f->write_seconds);
	json_put_close(json, '}');
}

/* With what reading and writing take; 0 stays 0. */
static double whole_seconds(const bake_facts *f, double seconds)
{
	return seconds > 0.0 ? seconds + f->read_seconds + f->write_seconds : 0.0;
}

/* Points that no one asked for are dark and say nothing. */
static bool is_written(const gw_bake_result *result, size_t point)
{
	return !result->asked || result->asked[point];
}

static void write_region(json_writer *json, const gw_report *r)
{
	if (r->region_points == 0)
		return;
	json_put_open_flat(json, "region", '{');
	json_put_count(json, "points", r->region_points);
	json_put_count(json, "records", r->region_records);
	json_put_count(json, "facets_needed", r->region_facets);
	json_put_count(json, "facets", r->facets);
	json_put_close(json, '}');
}

static void write_bounces(json_writer *json, const bake_facts *f)
{
	const gw_report *r = &f->result->report;
	json_put_open(json, "bounces", '[');
	for (uint32_t i = 0; i < r->bounce_count; i++) {
		json_put_open_flat(json, NULL, '{');
		json_put_real(json, "energy", r->bounce[i].energy);
		json_put_real(json, "seconds", r->bounce[i].seconds);
		json_put_real(json, "carriers", r->bounce[i].carriers);
		json_put_real(json, "largest_irradiance", r->bounce[i].largest_irradiance);
		json_put_close(json, '}');
	}
	json_put_close(json, ']');
	json_put_real(json, "remaining", r->remaining);
	json_put_open_flat(json, "error", '{');
	json_put_count(json, "points", r->error.points);
	json_put_real(json, "relative_rms", r->error.relative_rms);
	json_put_real(json, "gathered", r->error.gathered);
	json_put_real(json, "spread", r->error.spread);
	json_put_real(json, "bias", r->error.bias);
	json_put_real(json, "noise", r->error.noise);
	json_put_real(json, "shadows", r->error.shadows);
	json_put_real(json, "normals", r->error.normals);
	json_put_real(json, "emission", r->error.emission);
	json_put_real(json, "geometry", r->error.geometry);
	json_put_real(json, "gaps", r->error.gaps);
	json_put_real(json, "sides", r->error.sides);
	json_put_real(json, "sides_share", r->error.sides_share);
	json_put_real(json, "narrow", r->error.narrow);
	json_put_real(json, "between", r->error.between);
	json_put_real(json, "halves", r->error.halves);
	json_put_bool(json, "halves_left_out", r->halves_left_out);
	json_put_close(json, '}');
	json_put_bool(json, "unlit_space", r->unlit_space);
	json_put_open_flat(json, "gaps", '{');
	json_put_count(json, "scanners", r->gaps.scanners);
	json_put_count(json, "holes", r->gaps.holes);
	json_put_real(json, "hole_width", r->gaps.hole_width);
	json_put_real(json, "share", r->gaps.share);
	json_put_real(json, "sky", r->gaps.sky);
	json_put_real(json, "lamps", r->gaps.lamps);
	json_put_real(json, "black", r->gaps.black);
	json_put_real(json, "bright", r->gaps.bright);
	json_put_close(json, '}');
	json_put_open_flat(json, "price", '{');
	json_put_real(json, "error", r->price.error);
	json_put_real(json, "seconds", whole_seconds(f, r->price.seconds));
	json_put_close(json, '}');
}

static void write_rounds(json_writer *json, const gw_report *r)
{
	json_put_open(json, "rounds", '[');
	for (uint32_t i = 0; i < r->round_count; i++) {
		const gw_round *round = &r->round[i];
		json_put_open_flat(json, NULL, '{');
		json_put_single(json, "record_spacing", round->record_spacing);
		json_put_single(json, "leaf_spacing", round->leaf_spacing);
		json_put_count(json, "rays", round->rays);
		json_put_count(json, "light_samples", round->light_samples);
		json_put_count(json, "cones", round->cones);
		json_put_count(json, "records", round->records);
		json_put_real(json, "relative_rms", round->error.relative_rms);
		json_put_real(json, "gathered", round->error.gathered);
		json_put_real(json, "spread", round->error.spread);
		json_put_real(json, "noise", round->error.noise);
		json_put_real(json, "shadows", round->error.shadows);
		json_put_real(json, "normals", round->error.normals);
		json_put_real(json, "emission", round->error.emission);
		json_put_real(json, "geometry", round->error.geometry);
		json_put_real(json, "gaps", round->error.gaps);
		json_put_real(json, "sides", round->error.sides);
		json_put_real(json, "narrow", round->error.narrow);
		json_put_real(json, "seconds", round->seconds);
		json_put_text(json, "why", round->why);
		json_put_close(json, '}');
	}
	json_put_close(json, ']');
	json_put_open_flat(json, "goal", '{');
	json_put_text(json, "end", gw_goal_name(r->goal));
	json_put_bool(json, "missed", r->missed);
	json_put_close(json, '}');
	if (r->gathered_goal == GW_GOAL_NONE)
		return;
	json_put_open_flat(json, "gathered_goal", '{');
	json_put_text(json, "end", gw_goal_name(r->gathered_goal));
	json_put_bool(json, "missed", r->gathered_goal != GW_GOAL_REACHED);
	json_put_close(json, '}');
}

static void write_octree(json_writer *json, const gw_report *r)
{
	json_put_open_flat(json, "octree", '{');
	json_put_count(json, "depth", r->depth);
	json_put_real(json, "leaf_size", r->leaf_size);
	if (r->wanted_leaf_size > 0.0) {
		json_put_real(json, "wanted_leaf_size", r->wanted_leaf_size);
		json_put_text(json, "why_coarser", r->why_coarser);
	}
	json_put_reals(json, "origin", r->origin, 3);
	json_put_count(json, "leaves", r->leaves);
	json_put_count(json, "tiles", r->tiles);
	json_put_count(json, "leaf_tiles", r->leaf_tiles);
	json_put_count(json, "border_tiles", r->border_tiles);
	json_put_count(json, "octree_bytes", r->octree_bytes);
	json_put_count(json, "brick_bytes", r->brick_bytes);
	json_put_close(json, '}');
	json_put_open_flat(json, "profile", '{');
	json_put_real(json, "inject_seconds", r->inject_seconds);
	json_put_real(json, "trace_seconds", r->trace_seconds);
	json_put_real(json, "gather_seconds", r->gather_seconds);
	json_put_close(json, '}');
	json_put_count(json, "records", r->records);
	json_put_text(json, "basis",
				  gw_basis_name(r->directional ? GW_BASIS_DIRECTIONAL : GW_BASIS_SCALAR));
	if (r->volume_cells > 0)
		json_put_count(json, "volume_cells", r->volume_cells);
	if (r->buffer_pieces > 0)
		json_put_count(json, "buffer_pieces", r->buffer_pieces);
	json_put_single(json, "record_spacing", r->record_spacing);
	json_put_real(json, "spacing", r->spacing);
	json_put_count(json, "surface_points", r->surface_points);
	json_put_real(json, "spacing_ratio", r->spacing_ratio);
	json_put_real(json, "narrow_share", r->narrow_share);
	json_put_count(json, "peak_bytes", r->peak_bytes);
}

static void write_luminance(json_writer *json, const bake_facts *f)
{
	const float *radiance = f->result->radiance;
	size_t n = f->result->count;
	double least = INFINITY, most = 0.0, sum = 0.0;
	size_t count = 0;
	for (size_t i = 0; i < n; i++) {
		double luminance = preview_luminance(radiance + 3 * i);
		if (!is_written(f->result, i))
			continue;
		least = luminance < least ? luminance : least;
		most = luminance > most ? luminance : most;
		sum += luminance;
		count++;
	}
	json_put_open_flat(json, "luminance", '{');
	json_put_real(json, "minimum", count ? least : 0.0);
	json_put_real(json, "mean", count ? sum / (double)count : 0.0);
	json_put_real(json, "maximum", most);
	json_put_close(json, '}');
	json_put_real(json, "exposure", f->exposure);
}

gw_status bake_report_write(const bake_facts *f, output_file *out, gw_error *error)
{
	char *text = NULL;
	size_t length;
	FILE *stream = open_memstream(&text, &length);
	if (!stream)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the report");
	const gw_report *r = &f->result->report;
	json_writer json = { .out = stream, .lines = true };
	json_put_open(&json, NULL, '{');
	json_put_text(&json, "glowworm", GW_VERSION);
	json_put_text(&json, "command", f->settings->command);
	uint64_t all = f->scene->parted ? f->scene->parted->file.count : f->result->count;
	json_put_count(&json, "points", f->result->asked ? r->region_points : all);
	write_inputs(&json, f);
	scene_write_members(&json, f->settings);
	json_put_text(&json, "device", r->device);
	json_put_text(&json, "driver", r->driver);
	write_counts(&json, r);
	write_strays(&json, r);
	bake_plan_write_effects(&json, r);
	if (f->forecast.plan)
		bake_plan_write_forecast(&json, &f->forecast);
	write_octree(&json, r);
	write_region(&json, r);
	write_stages(&json, f);
	write_bounces(&json, f);
	if (r->round_count > 0)
		write_rounds(&json, r);
	write_luminance(&json, f);
	light_shares_write(&json, &(light_shares){ f->settings, f->scene, f->result, 0 });
	if (f->settings->vdb || f->settings->vdb_sh)
		json_put_count(&json, "vdb_clamped", f->vdb_clamped);
	json_put_close(&json, '}');
	fputc('\n', stream);
	gw_status status = GW_OK;
	if (fclose(stream) != 0)
		status = gw_fail(error, GW_ERROR_MEMORY, "no memory for the report");
	else
		status = output_file_write(out, text, length, error);
	free(text);
	return status;
}

/* ------------------------------------------------------------------------------ for people */

static bool calls_for(const gw_report *r, const char *effect)
{
	for (uint32_t i = 0; i < r->effect_count; i++)
		if (strcmp(r->effect[i].name, effect) == 0)
			return r->effect[i].called_for;
	return false;
}

/* A row that the thesis has; one that this bake has nothing of shows a dash, as there. */
static void profile_row(const char *name, bool there, double seconds)
{
	if (there)
		fprintf(stderr, "%-18s %9.1f\n", name, seconds * 1e3);
	else
		fprintf(stderr, "%-18s %9s\n", name, "-");
}

/* The rows of Salm's tables 5.1 to 5.4: what is built once, what is built again for what moved, and
 * what each bounce costs. */
static void profile_bounces(const gw_report *r, bool moved)
{
	double bounces = r->bounce_count > 1 ? (double)(r->bounce_count - 1) : 1.0;
	double inject = r->inject_seconds * 1e3, gather = r->gather_seconds * 1e3;
	fprintf(stderr, "%-18s %9s %12s\n", "thesis's terms", "ms", "ms a bounce");
	profile_row("static", !moved, gw_report_seconds(r, "octree"));
	profile_row("dynamic", moved, gw_report_seconds(r, "octree"));
	fprintf(stderr, "%-18s %9.1f %12.2f\n", "inj./mip.", inject, inject / bounces);
	fprintf(stderr, "%-18s %9.1f\n", "rays, traced once", r->trace_seconds * 1e3);
	fprintf(stderr, "%-18s %9.1f %12.2f\n", "gather", gather, gather / bounces);
	fprintf(stderr, "%-18s %9.1f %12.2f\n", "l.prop.", inject + gather,
			(inject + gather) / bounces);
	profile_row("shadows", calls_for(r, "shadows"), gw_report_seconds(r, "direct light"));
	fputc('\n', stderr);
}

/* A row of the table of stages. Without bytes left on the device where these are 0. */
static void profile_stage(const gw_stage *s)
{
	char left[32] = "";
	if (s->bytes > 0)
		snprintf(left, sizeof left, "%.1f", (double)s->bytes / MEGABYTE);
	fprintf(stderr, "%-18s %9.1f %9.1f %9.1f %9s %10" PRIu64 " %9" PRIu64 " %9.1f %9.1f\n", s->name,
			s->seconds * 1e3, s->device_seconds * 1e3, s->compile_seconds * 1e3, left,
			s->dispatches, s->submissions, (double)s->uploaded_bytes / MEGABYTE,
			(double)s->downloaded_bytes / MEGABYTE);
}

static void profile_stages(const gw_report *r)
{
	gw_stage net = { .name = "net" };
	fprintf(stderr, "%-18s %9s %9s %9s %9s %10s %9s %9s %9s\n", "stage", "ms", "device ms",
			"compile ms", "MB", "dispatches", "submits", "MB up", "MB down");
	for (uint32_t i = 0; i < r->stage_count; i++) {
		const gw_stage *s = &r->stage[i];
		profile_stage(s);
		net.seconds += s->seconds;
		net.device_seconds += s->device_seconds;
		net.compile_seconds += s->compile_seconds;
		net.dispatches += s->dispatches;
		net.submissions += s->submissions;
		net.uploaded_bytes += s->uploaded_bytes;
		net.downloaded_bytes += s->downloaded_bytes;
	}
	profile_stage(&net);
	fputc('\n', stderr);
}

void bake_report_profile(const gw_report *r, bool moved)
{
	profile_stages(r);
	profile_bounces(r, moved);
	fprintf(stderr, "%-18s %9" PRIu32 "\n", "SVO depth", r->depth);
	fprintf(stderr, "%-18s %9.1f MB\n", "SVO-buffer", (double)r->octree_bytes / MEGABYTE);
	fprintf(stderr, "%-18s %9.1f MB\n", "brick pools", (double)r->brick_bytes / MEGABYTE);
	fprintf(stderr, "%-18s %9.1f MB\n", "SVO",
			(double)(r->octree_bytes + r->brick_bytes) / MEGABYTE);
	fprintf(stderr, "%-18s %9.1f MB\n", "peak", (double)r->peak_bytes / MEGABYTE);
}

/* Is a part of the error worth a word? */
static bool is_large(const gw_report *r, double part)
{
	return part > PART_LEAST && !(part < PART_SHARE * r->error.relative_rms);
}

/* What the largest doubt is about. */
typedef enum doubt {
	DOUBT_NONE,
	DOUBT_GEOMETRY,
	DOUBT_SIDES,
	DOUBT_GAPS,
	DOUBT_NARROW,
	DOUBT_SURFACE
} doubt;

/* Where one stood: what tells most, if nobody told it yet, nor the files. */
static const char *or_scanner(const bake_facts *f)
{
	return f->scene->points.points.scanner_count > 0 ? "" : "--scanner X,Y,Z, where one stood, or ";
}

static void tell_gaps(const gw_report *r, const char *lead)
{
	const double *at = r->gaps.hole_place;
	if (r->gaps.scanners > 0)
		fprintf(stderr,
				"%sof gaps that no scanner looked at; --gaps black or --gaps mean closes them, "
				"--fields unknown says where they are\n",
				lead);
	else
		fprintf(stderr,
				"%snobody knows which of %" PRIu32 " holes of the surface are windows, the widest "
				"%s m at %s,%s,%s; --scanner X,Y,Z, where one stood, tells it, --gaps "
				"black or --gaps mean closes all\n",
				lead, r->gaps.holes, GW_SAID(r->gaps.hole_width, 3), GW_SAID_PLACE(at[0]),
				GW_SAID_PLACE(at[1]), GW_SAID_PLACE(at[2]));
}

/* Of what the octree and the points disagree about; of edges of shadows, about which they do as
 * well, another octree mends nothing. */
static double geometry_doubt(const gw_report *r)
{
	return r->error.geometry > r->error.shadows ? r->error.geometry : 0.0;
}

static double doubt_size(const gw_report *r, doubt which)
{
	const gw_error_estimate *e = &r->error;
	const double part[] = { 0.0, geometry_doubt(r), e->sides, e->gaps, e->narrow, e->halves };
	return part[which];
}

static doubt largest_doubt(const gw_report *r)
{
	doubt most = DOUBT_NONE;
	for (doubt i = DOUBT_GEOMETRY; i <= DOUBT_SURFACE; i++)
		if (doubt_size(r, i) > fmax(doubt_size(r, most), DOUBT_LEAST))
			most = i;
	return is_large(r, doubt_size(r, most)) ? most : DOUBT_NONE;
}

#define WHY 120 /* bytes that why_sides needs */

static const char *why_sides(const gw_report *r, char why[WHY])
{
	char percent[TEXT_PERCENT];
	if (r->error.sides_share < WRONG_LEAST)
		snprintf(why, WHY, "nobody knows which side is seen of the points that are lit from both");
	else
		snprintf(why, WHY,
				 "about %s %% of the points may face the wrong way, by what their two sides see of "
				 "the others",
				 text_percent(r->error.sides_share, percent));
	return why;
}

/* Had any point no normal of its own? */
static bool are_estimated(const gw_report *r)
{
	for (uint32_t i = 0; i < r->count_count; i++)
		if (strcmp(r->count[i].name, "normals_estimated") == 0)
			return r->count[i].points > 0;
	return false;
}

/* What says which side is the front, where the normals in hand do not. */
static const char *better_normals(const gw_report *r)
{
	return are_estimated(r) ? "normals in the file settle it"
							: "--normals estimate, which takes none of the file's, may settle it";
}

static void tell_narrow(const char *lead)
{
	fprintf(stderr,
			"%snothing says how much there is of things as narrow as points are apart, such as "
			"leaves and wires; normals in the file tell it, or a scan in rows and columns\n",
			lead);
}

/* Before all others, what the light hangs on most, and what settles it. */
static doubt note_largest_doubt(const bake_facts *f, const gw_report *r)
{
	char lead[96], percent[TEXT_PERCENT], why[WHY];
	doubt most = largest_doubt(r);
	snprintf(lead, sizeof lead, "glowworm: note: above all: the light is %s %% in doubt because ",
			 text_percent(doubt_size(r, most), percent));
	if (most == DOUBT_GEOMETRY)
		fprintf(stderr,
				"%sthe octree and the points themselves disagree: surfaces leak or lie elsewhere "
				"in it; another --depth or --leaf-spacing may mend that\n",
				lead);
	if (most == DOUBT_SIDES)
		fprintf(stderr, "%s%s; %s%s\n", lead, why_sides(r, why), or_scanner(f), better_normals(r));
	if (most == DOUBT_GAPS)
		tell_gaps(r, lead);
	if (most == DOUBT_NARROW)
		tell_narrow(lead);
	if (most == DOUBT_SURFACE && !are_estimated(r))
		fprintf(stderr,
				"%sa bake of half of the points gives other light: in places they are too far "
				"apart, or too noisy, for what they show; more of them settle it\n",
				lead);
	else if (most == DOUBT_SURFACE)
		fprintf(stderr,
				"%sa bake of half of the points gives other light: they are few or noisy for what "
				"they show; more of them, %snormals in the file settle it\n",
				lead, or_scanner(f));
	return most;
}

static void note_geometry(const gw_report *r)
{
	char percent[TEXT_PERCENT];
	if (is_large(r, geometry_doubt(r)))
		fprintf(stderr,
				"glowworm: note: the octree and the points themselves disagree by %s %% of the "
				"mean: surfaces leak or lie elsewhere in it; another --depth or --leaf-spacing may "
				"mend that\n",
				text_percent(r->error.geometry, percent));
}

/* Where much of the light hangs on which way surfaces face. */
static void note_sides(const bake_facts *f, const gw_report *r)
{
	char why[WHY];
	if (r->error.sides > GUESSED_LEAST)
		fprintf(stderr, "glowworm: note: %s; %s%s\n", why_sides(r, why), or_scanner(f),
				better_normals(r));
}

/* Where much of it hangs on how much there is of narrow things. */
static void note_narrow(const gw_report *r)
{
	char lead[96], percent[TEXT_PERCENT];
	snprintf(lead, sizeof lead, "glowworm: note: the light is %s %% in doubt because ",
			 text_percent(r->error.narrow, percent));
	if (r->error.narrow > GUESSED_LEAST)
		tell_narrow(lead);
}

/* Share of what lamps send from which on all of them stand where no scanner looked. */
#define LAMPS_UNSEEN 0.995

static const char *how_to_close(const settings *s, const gw_report *r)
{
	if (s->bake.method == GW_METHOD_CONES)
		return "cones leave them open, --method rays --gaps mean closes them";
	if (s->bake.method == GW_METHOD_PROBES)
		return "probes leave them open, --method rays --gaps mean closes them";
	if (s->bake.method == GW_METHOD_VOLUME || s->bake.method == GW_METHOD_LPV)
		return "a volume leaves them open, --method rays --gaps mean closes them";
	if (s->bake.method == GW_METHOD_BUFFERS)
		return "buffers leave them open, --method rays --gaps mean closes them";
	if (s->bake.gaps == GW_GAPS_OPEN && r->gaps.scanners > 0 && r->gaps.lamps > LAMPS_UNSEEN)
		return "no lamp stands where a scanner looked, and none would light anything if --gaps "
			   "closed them";
	return s->bake.gaps == GW_GAPS_OPEN ? "--gaps closes them" : "--gaps has closed them";
}

/* Where light comes through holes of the surface, which may be windows. */
static void note_holes(const settings *s, const gw_report *r)
{
	char share[TEXT_PERCENT], lamps[TEXT_PERCENT], sky[TEXT_PERCENT], black[TEXT_PERCENT],
		bright[TEXT_PERCENT];
	const double *at = r->gaps.hole_place;
	fprintf(stderr,
			"glowworm: note: the surface has %" PRIu32 " hole%s, the widest %s m at %s,%s,%s: "
			"%s %% of the directions that light is gathered from, %s %% of the sky's light and "
			"%s %% of what lamps and suns send pass there; were they black, the light would be "
			"%s %% of what it is, as bright as what surrounds them, %s %%; nobody knows which of "
			"them are windows: --scanner says what was looked at, %s\n",
			r->gaps.holes, r->gaps.holes == 1 ? "" : "s", GW_SAID(r->gaps.hole_width, 3),
			GW_SAID_PLACE(at[0]), GW_SAID_PLACE(at[1]), GW_SAID_PLACE(at[2]),
			text_percent(r->gaps.share, share), text_percent(r->gaps.sky, sky),
			text_percent(r->gaps.lamps, lamps), text_percent(r->gaps.black, black),
			text_percent(r->gaps.bright, bright), how_to_close(s, r));
}

/* Where light comes through what no scanner looked at. */
static void note_gaps(const settings *s, const gw_report *r)
{
	char share[TEXT_PERCENT], lamps[TEXT_PERCENT], black[TEXT_PERCENT], bright[TEXT_PERCENT];
	if (r->gaps.share < GAPS_LEAST && r->gaps.lamps < GAPS_LEAST && r->gaps.sky < GAPS_LEAST)
		return;
	if (r->gaps.scanners == 0) {
		note_holes(s, r);
		return;
	}
	fprintf(
		stderr,
		"glowworm: note: %s %% of the directions that light is gathered from, and %s %% of what "
		"lamps and suns send, pass gaps that no scanner looked at: were they black, the light "
		"would be %s %% of what it is, as bright as what surrounds them, %s %%; %s, --fields "
		"unknown says where\n",
		text_percent(r->gaps.share, share), text_percent(r->gaps.lamps, lamps),
		text_percent(r->gaps.black, black), text_percent(r->gaps.bright, bright),
		how_to_close(s, r));
}

/* What was asked for gaps, where none can be known. */
static void note_no_scanner(const settings *s, const gw_report *r)
{
	if (s->bake.gaps != GW_GAPS_OPEN && r->gaps.scanners == 0 && r->gaps.holes == 0)
		fprintf(stderr,
				"glowworm: note: --gaps %s closes nothing: the surface has no hole that looks like "
				"one, and no scanner is known that saw a thousand points or more; --scanner says "
				"where one stood\n",
				gw_gaps_name(s->bake.gaps));
}

/* Is a count worth a line? Of what does no harm, only if it is much; the report has all. */
static bool is_notable(const gw_count *count, size_t points)
{
	static const struct {
		const char *name;
		double least; /* share of the points */
	} harmless[] = { { "duplicates_merged", 0.1 },
					 { "albedo_clamped", 0.01 },
					 { "normals_untrusted", 0.05 },
					 { "foliage", 0.001 },
					 { "shut_in", 0.1 } };
	double least = 0.0;
	for (size_t i = 0; i < sizeof harmless / sizeof *harmless; i++)
		if (strcmp(count->name, harmless[i].name) == 0)
			least = harmless[i].least;
	return count->points > 0 && (double)count->points >= least * (double)points;
}

/* Counts of points, whose meanings begin so, are told together; the length of that beginning. What
 * is lit by the surface of others is so of all points, also where not all were kept. */
static size_t is_of_points(const gw_count *count, bool kept)
{
	const char *begin = count->points == 1 ? "point " : "points ";
	if (kept && strcmp(count->name, "beside_surface") == 0)
		return 0;
	return strncmp(count->meaning, begin, strlen(begin)) == 0 ? strlen(begin) : 0;
}

/* What became of which points, in one line, and what else was counted. */
static void note_counts(const bake_facts *f)
{
	const gw_report *r = &f->result->report;
	size_t points = f->result->count;
	bool kept = f->scene->parted != NULL;
	uint32_t together = 0, told = 0, listed = kept ? 1 : 2; /* from so many on */
	char of[80] = "all points";
	if (kept)
		snprintf(of, sizeof of, "the %zu points that were kept", points);
	for (uint32_t i = 0; i < r->count_count; i++)
		together += is_of_points(&r->count[i], kept) > 0 && is_notable(&r->count[i], points);
	for (uint32_t i = 0; i < r->count_count; i++)
		if (is_notable(&r->count[i], points) &&
			(together < listed || !is_of_points(&r->count[i], kept)))
			fprintf(stderr, "glowworm: note: %" PRIu64 " %s\n", r->count[i].points,
					r->count[i].meaning);
	for (uint32_t i = 0; i < r->count_count && together >= listed; i++)
		if (is_notable(&r->count[i], points) && is_of_points(&r->count[i], kept)) {
			if (told++ == 0)
				fprintf(stderr, "glowworm: note: of %s, ", of);
			fprintf(stderr, "%s%" PRIu64 " %s", told > 1 ? "; " : "", r->count[i].points,
					r->count[i].meaning + is_of_points(&r->count[i], kept));
		}
	if (told > 0)
		fputc('\n', stderr);
}

/* Where light does not get to most of what there is: the usual first picture of a room is black. */
static void note_dark(const bake_facts *f)
{
	const gw_bake_result *result = f->result;
	char percent[TEXT_PERCENT];
	double sum = 0.0;
	size_t dark = 0, count = 0;
	for (size_t i = 0; i < result->count; i++) {
		sum += preview_luminance(result->radiance + 3 * i);
		count += is_written(result, i);
	}
	double least = DARK * sum / (double)count;
	for (size_t i = 0; i < result->count; i++)
		dark += is_written(result, i) && preview_luminance(result->albedo + 3 * i) > 0.0 &&
				!(preview_luminance(result->radiance + 3 * i) > least);
	double share = (double)dark / (double)count;
	if (share > DARK_SHARE)
		fprintf(stderr,
				"glowworm: note: %s %% of the points get no light, or less than a thousandth of "
				"the mean; where none gets in, a lamp inside helps, as --light 'point at X,Y,Z "
				"intensity 20'\n",
				text_percent(share, percent));
}

/* However much light falls on what is black. */
static void note_black(const bake_facts *f)
{
	const gw_bake_result *result = f->result;
	char percent[TEXT_PERCENT];
	size_t black = 0, count = 0;
	for (size_t i = 0; i < result->count; i++) {
		count += is_written(result, i);
		black += is_written(result, i) && !(preview_luminance(result->albedo + 3 * i) > 0.0);
	}
	double share = (double)black / (double)count;
	if (share > DARK_SHARE)
		fprintf(stderr,
				"glowworm: note: %s %% of the points reflect no light, as their albedo is 0; "
				"--albedo or --albedo-scale gives them another\n",
				text_percent(share, percent));
}

/* A room or a cave under sun and sky: a person came for its inside. */
static void note_unlit_space(const bake_facts *f)
{
	const gw_report *r = &f->result->report;
	double at[3] = { r->unlit_place[0], r->unlit_place[1], r->unlit_place[2] };
	coordinates_from_metres(&f->scene->place, at);
	fprintf(stderr,
			"glowworm: note: the points enclose a space, as a room or a cave does, and sun and sky "
			"light the outer sides of it; a lamp inside shows the space: --light 'point at "
			"%.3f,%.3f,%.3f intensity 20'\n",
			at[0], at[1], at[2]);
}

/* What was not asked of a surface in doubt, so that nobody takes the error for all of it. */
static void note_left_out(const bake_facts *f)
{
	if (f->result->report.halves_left_out)
		fprintf(
			stderr,
			"glowworm: note: the surface is in doubt, and %s leaves no time to bake half of the "
			"points, which tells by how much: the error may be larger than it is said to be\n",
			f->settings->transport ? "--transport" : "--time");
}

/* So little memory holds no surface worth it: the smallest one takes more. */
static void note_little_memory(const bake_facts *f)
{
	const gw_bake_options *o = &f->settings->bake;
	uint64_t fit = gw_points_in_memory(o->memory, true, false, o);
	if (o->memory > 0 && o->surface_points == 0 && fit < PARTED_CLOUD_LEAST &&
		fit < f->result->count)
		fprintf(stderr,
				"glowworm: note: --memory is less than the program takes with a surface of %u "
				"points, the smallest that it makes\n",
				PARTED_CLOUD_LEAST);
}

void bake_report_notes(const bake_facts *f)
{
	const gw_report *r = &f->result->report;
	doubt told = note_largest_doubt(f, r);
	note_counts(f);
	octree_note_print(r->leaf_size, r->wanted_leaf_size, r->why_coarser);
	note_little_memory(f);
	if (f->settings->bake.bounces != 0 && r->unlit_space)
		note_unlit_space(f);
	else if (f->settings->bake.bounces != 0)
		note_dark(f);
	if (f->settings->bake.bounces != 0)
		note_black(f);
	if (told != DOUBT_GEOMETRY)
		note_geometry(r);
	if (told != DOUBT_SIDES)
		note_sides(f, r);
	if (told != DOUBT_NARROW)
		note_narrow(r);
	if (told != DOUBT_GAPS)
		note_gaps(f->settings, r);
	note_no_scanner(f->settings, r);
	note_left_out(f);
	if (f->vdb_clamped)
		fprintf(stderr,
				"glowworm: note: %" PRIu64
				" value%s of the grids %s not fit 16 bits and %s clamped\n",
				f->vdb_clamped, gw_plural(f->vdb_clamped, "", "s"),
				gw_plural(f->vdb_clamped, "does", "do"), gw_plural(f->vdb_clamped, "was", "were"));
}

/* "3.1 % +- 0.4 %", or that nothing is known. */
static void error_text(const gw_report *r, char text[80])
{
	char error[TEXT_PERCENT], spread[TEXT_PERCENT];
	if (r->error.points)
		snprintf(text, 80, "%s %% +- %s %%", text_percent(r->error.relative_rms, error),
				 text_percent(r->error.spread, spread));
	else if (r->error.relative_rms > 0.0)
		snprintf(text, 80, "%s %%", text_percent(r->error.relative_rms, error));
	else
		snprintf(text, 80, "not known");
}

/* Two digits, in the unit that people count such a time in. */
static void time_text(double seconds, char text[32])
{
	if (seconds < 90.0)
		snprintf(text, 32, "%.2g s", seconds);
	else if (seconds < 5400.0)
		snprintf(text, 32, "%.0f min", seconds / 60.0);
	else
		snprintf(text, 32, "%s h", GW_SAID(seconds / 3600.0, 2));
}

/* A part of the error that no finer setting lessens. */
typedef struct error_part {
	double error;
	const char *what, *remedy;
} error_part;

/* The largest two of what no finer setting lessens; the report has all. */
static void put_parts(const gw_report *r, char *text, size_t room)
{
	const gw_error_estimate *e = &r->error;
	bool seen = r->gaps.scanners > 0;
	error_part part[] = {
		{ e->shadows, "edges of lamps' shadows", "denser points" },
		{ e->normals, "errors of the points' normals", "better ones" },
		{ e->emission, "edges of what emits", "denser points" },
		{ e->gaps, seen ? "gaps that no scanner looked at" : "holes that may be windows or not",
		  seen ? "more scans" : "--scanner or more scans" },
		{ e->sides, "surfaces that may face the wrong way", "normals or scanner positions" },
		{ e->narrow, "doubts about how much there is of narrow things",
		  "normals or a scan in rows and columns" },
		{ e->between, "changes between the points that make the surface", "more --surface-points" },
		{ e->halves, "doubts about the surface, by half of the points,",
		  "denser or better points" },
	};
	const size_t count = sizeof part / sizeof *part;
	for (int told = 0; told < PARTS_TOLD; told++) {
		size_t used = strlen(text), most = 0;
		char percent[TEXT_PERCENT];
		for (size_t i = 1; i < count; i++)
			most = part[i].error > part[most].error ? i : most;
		if (!is_large(r, part[most].error))
			return;
		snprintf(text + used, room - used, "; %s alone are %s %%, which only %s would lessen",
				 part[most].what, text_percent(part[most].error, percent), part[most].remedy);
		part[most].error = 0.0;
	}
}

/* Whether bounces are no more than so many although what further ones would bring is much. */
static bool leaves_bounces_out(const bake_facts *f)
{
	const gw_report *r = &f->result->report;
	return f->settings->bake.bounces != GW_BOUNCES_AUTO &&
		   r->remaining > 0.5 * r->error.relative_rms;
}

/* What less would cost, as the end of a sentence. */
static void price_text(const bake_facts *f, char *text, size_t room)
{
	const gw_report *r = &f->result->report;
	double seconds = whole_seconds(f, r->price.seconds);
	char time[32], percent[TEXT_PERCENT];
	*text = '\0';
	time_text(seconds, time);
	if (f->settings->bake.method == GW_METHOD_CONES && r->error.points)
		snprintf(text, room, "; part of that is what cones are off, --method rays has less");
	else if (f->settings->bake.method == GW_METHOD_PROBES && r->error.points)
		snprintf(text, room,
				 "; part of that is what maps of probes are off, --method rays has less");
	else if (f->settings->bake.method == GW_METHOD_LPV && r->error.points)
		snprintf(text, room, "; most is what light between cells is off, --method rays has less");
	else if (f->settings->bake.method == GW_METHOD_VOLUME && r->error.points)
		snprintf(text, room, "; more --volume-cells have less, and --method rays");
	else if (f->settings->bake.method == GW_METHOD_BUFFERS && r->error.points)
		snprintf(text, room, "; part of that is what buffers are off, --method rays has less");
	else if (r->price.error > 0.0 && seconds > 0.0)
		snprintf(text, room, "; %s %% would take about %s (--max-error %.2g)",
				 text_percent(r->price.error, percent), time, r->price.error);
	else if (leaves_bounces_out(f))
		snprintf(text, room,
				 "; part of that is light of bounces that are left out, which more "
				 "--bounces bring");
	else if (r->price.error > 0.0)
		snprintf(text, room, "; %s %% would take a bake without --transport (--max-error %.2g)",
				 text_percent(r->price.error, percent), r->price.error);
	put_parts(r, text, room);
}

static bool is_lit(const gw_bake_result *result)
{
	for (size_t i = 0; i < result->count; i++)
		if (preview_luminance(result->radiance + 3 * i) > 0.0)
			return true;
	return false;
}

/* Points that are lit from both sides at once are not asked how wrong that is: it is told where
 * there are no others. */
static void tell_unknown_error(const gw_report *r)
{
	for (uint32_t i = 0; i < r->count_count; i++)
		if (strcmp(r->count[i].name, "normals_untrusted") == 0 && r->count[i].points > 0 &&
			calls_for(r, gw_effect_name(GW_EFFECT_ERROR)))
			fprintf(stderr,
					"glowworm: note: how wrong the light is nobody knows: the points are lit from "
					"both sides; --scanner X,Y,Z, where one stood, or normals in the file settle "
					"it\n");
}

void bake_report_error(const bake_facts *f)
{
	const gw_report *r = &f->result->report;
	char error[80], price[512];
	if (r->error.points == 0 && !(r->error.relative_rms > 0.0)) {
		if (is_lit(f->result))
			tell_unknown_error(r);
		return;
	}
	error_text(r, error);
	price_text(f, price, sizeof price);
	fprintf(stderr, "glowworm: estimated error%s: %s of the mean%s\n",
			f->frames > 1 ? " of the first frame" : "", error, price);
}

/* Why a target was missed and what it would take, as the end of a sentence. */
static void missed_text(const bake_facts *f, char *text, size_t room)
{
	const gw_report *r = &f->result->report;
	char time[32], percent[TEXT_PERCENT];
	*text = '\0';
	if (r->goal == GW_GOAL_TIME && r->price.seconds > 0.0) {
		time_text(whole_seconds(f, r->price.seconds), time);
		snprintf(text, room, "; it would take about %s in all", time);
	} else if (r->error.points && r->goal != GW_GOAL_TIME) {
		snprintf(text, room, "; %s %% are noise of the rays",
				 text_percent(r->error.noise, percent));
	}
	put_parts(r, text, room);
}

/* What was asked of gathered light alone, where records were few and it is missed. The settings of
 * a quality ask for it as well, but only for as much as records can do. */
static void note_gathered(const bake_facts *f)
{
	static const char *const end[GW_GOAL_COUNT] = {
		[GW_GOAL_EXHAUSTED] = "records stand as close as they may",
		[GW_GOAL_STALLED] = "more records no longer lessen it",
		[GW_GOAL_MEMORY] = "more records do not fit into memory",
	};
	static const char name[] = "gathered-error";
	const gw_report *r = &f->result->report;
	const option *o = option_find(VERB_BAKE, name, sizeof name - 1);
	char gathered[TEXT_PERCENT];
	if (f->settings->quiet || f->settings->given[o - options] == SETTINGS_BY_DEFAULT ||
		!end[r->gathered_goal] || r->round_count == 0)
		return;
	const gw_error_estimate *last = &r->round[r->round_count - 1].error;
	bool noise = last->noise * last->noise > 0.5 * last->gathered * last->gathered;
	fprintf(stderr,
			"glowworm: note: gathered light is %s %% off after %" PRIu32
			" round%s, not the %.3g %% of --gathered-error: %s\n",
			text_percent(last->gathered, gathered), r->round_count,
			gw_plural(r->round_count, "", "s"), 100.0 * (double)f->settings->bake.gathered_error,
			noise ? "most of that is noise of the rays, which more --rays lessen"
				  : end[r->gathered_goal]);
}

gw_status bake_report_goal(const bake_facts *f, gw_error *error)
{
	static const char *const end[GW_GOAL_COUNT] = {
		[GW_GOAL_REACHED] = "that is as small as asked",
		[GW_GOAL_TIME] = "another round would not be done in time",
		[GW_GOAL_EXHAUSTED] = "nothing is left that can be refined",
		[GW_GOAL_STALLED] = "finer settings no longer lessen it",
		[GW_GOAL_MEMORY] = "finer settings do not fit into memory",
		[GW_GOAL_OUT_OF_REACH] = "what finer settings cannot lessen is more than that alone",
	};
	const gw_report *r = &f->result->report;
	char text[80], why[512], rounds[40] = "";
	error_text(r, text);
	missed_text(f, why, sizeof why);
	if (r->round_count > 0) /* of tiles each has its own */
		snprintf(rounds, sizeof rounds, " after %" PRIu32 " round%s", r->round_count,
				 gw_plural(r->round_count, "", "s"));
	if (r->missed && r->error.points == 0 &&
		r->error.relative_rms <= (double)f->settings->bake.max_error)
		return gw_fail(error, STATUS_MISSED,
					   "no point could be solved again, so that nothing says whether the error is "
					   "%.3g %%; what is known of it is %s%s",
					   100.0 * (double)f->settings->bake.max_error, text, why);
	if (r->missed)
		return gw_fail(error, STATUS_MISSED, "the estimated error is %s%s, not %.3g %%: %s%s", text,
					   rounds, 100.0 * (double)f->settings->bake.max_error, end[r->goal], why);
	if (r->goal != GW_GOAL_NONE && !f->settings->quiet)
		fprintf(stderr, "glowworm: note: the estimated error is %s%s: %s\n", text, rounds,
				end[r->goal]);
	note_gathered(f);
	return GW_OK;
}

void bake_report_summary(const bake_facts *f)
{
	char bias[TEXT_PERCENT];
	const gw_report *r = &f->result->report;
	for (size_t i = 0; i < f->scene->input_count; i++)
		text_message(stderr, "glowworm: %s: %s, %zu points; albedo from %s\n",
					 loaded_scene_input_name(f->scene->input[i].path),
					 f->scene->input[i].format->name, f->scene->input[i].points,
					 f->scene->input[i].albedo_source);
	fprintf(stderr, "glowworm: device: %s\n", r->device);
	fprintf(stderr, "glowworm: octree: depth %" PRIu32 ", leaves of %s m, %" PRIu64 " of them\n",
			r->depth, GW_SAID(r->leaf_size, 4), r->leaves);
	fprintf(stderr, "glowworm: %" PRIu32 " bounces; the rest would add at most %.2g of the light\n",
			r->bounce_count, r->remaining);
	if (r->region_points > 0)
		fprintf(stderr,
				"glowworm: region: %" PRIu64 " points, by %" PRIu64 " records of %" PRIu64
				"; what they depend on is %.3g %% of the surface\n",
				r->region_points, r->region_records, r->records,
				100.0 * (double)r->region_facets / fmax((double)r->facets, 1.0));
	if (r->error.points)
		fprintf(stderr,
				"glowworm: estimated error: bias %s %%, from %" PRIu32 " points solved again\n",
				text_percent(r->error.bias, bias), r->error.points);
	fprintf(stderr, "glowworm: %.1f s reading, %.1f s baking, %.1f s writing\n", f->read_seconds,
			f->bake_seconds, f->write_seconds);
}
