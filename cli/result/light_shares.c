#include "result/light_shares.h"
#include "program/text_quote.h"
#include "glowworm_host.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LINES 4u          /* for lamps that shine, and for those that do not; the report has all */
#define PLANNED_LINES 12u /* of a plan */
#define FAR_EXTENTS 3.0   /* extents of the cloud from which on a lamp is called far away */
#define NOTHING 1e-6      /* share of the light that is as good as none */
#define DOUBTFUL 0.01 /* of what such a lamp gives: more is no leak, however wrong the light is */
#define DOUBTFUL_BEHIND 0.05 /* likewise of one that is behind the surface nearest to it */
#define NEAREST 16u          /* points that tell whether it is */
#define NAME 96

/* Box around the points that are part of a surface, and its diagonal. */
typedef struct extent {
	double low[3], high[3], diagonal;
} extent;

static extent find_extent(const light_shares *f)
{
	extent e = { { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY }, 0.0 };
	const double *position = f->scene->points.points.position;
	for (size_t i = 0; position && i < f->scene->points.points.count; i++) {
		const double *p = position + 3 * i;
		if ((f->result->stray && f->result->stray[i]) ||
			!(isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2])))
			continue;
		for (int k = 0; k < 3; k++) {
			e.low[k] = fmin(e.low[k], p[k]);
			e.high[k] = fmax(e.high[k], p[k]);
		}
	}
	for (int k = 0; k < 3; k++)
		e.diagonal += (e.high[k] - e.low[k]) * (e.high[k] - e.low[k]);
	e.diagonal = sqrt(e.diagonal);
	return e;
}

/* How far a lamp stands from the box; 0 within, and for what has no place. */
static double outside(const extent *e, const gw_light *light)
{
	double squared = 0.0;
	if (light->type == GW_LIGHT_SUN || light->type == GW_LIGHT_ENVIRONMENT)
		return 0.0;
	for (int k = 0; k < 3; k++) {
		double off = fmax(fmax(e->low[k] - light->position[k], light->position[k] - e->high[k]), 0);
		squared += off * off;
	}
	return sqrt(squared);
}

static const gw_light *light_of(const light_shares *f, size_t i)
{
	return f->scene->light ? &f->scene->light[i] : &f->settings->light[i].light;
}

static const char *type_of(const gw_light *light)
{
	return light->type == GW_LIGHT_ENVIRONMENT ? "sky" : gw_light_type_name(light->type);
}

/* "lamp 'torch'", or "light 2, a spot". */
static void name_light(const light_shares *f, size_t i, char name[NAME])
{
	const gw_light *light = light_of(f, i);
	if (light->name[0])
		snprintf(name, NAME, "light '%s'", light->name);
	else
		snprintf(name, NAME, "light %zu, a %s", i + 1, type_of(light));
}

/* Is it one that gives light? A millionth of all is none. */
static bool shines(const gw_light_given *given)
{
	return given->fate == GW_LIGHT_SHINES && !(given->share < NOTHING);
}

/* Why one gives nothing.
 *   closed   gaps that no scanner looked at are */
static const char *reason(const gw_light *light, gw_light_fate fate, double away, bool closed)
{
	bool placed = light->type != GW_LIGHT_SUN && light->type != GW_LIGHT_ENVIRONMENT;
	if (fate == GW_LIGHT_BLACK)
		return "it has no power";
	if (fate == GW_LIGHT_SHINES)
		return "hardly any surface in its beam faces it and sees it";
	if (light->type == GW_LIGHT_ENVIRONMENT)
		return "no surface sees the sky";
	if (fate == GW_LIGHT_AVERTED && away > 0.0)
		return "it stands outside, and no surface in its beam faces it: it is behind walls or "
			   "under the floor, or shines past everything";
	if (fate == GW_LIGHT_AVERTED)
		return placed ? "no surface in its beam faces it: it is behind walls or under the floor"
					  : "no surface faces it";
	if (closed)
		return placed
				   ? "surface, or what no scanner looked at and --gaps closes, hides all that it "
					 "would reach"
				   : "all that faces it lies in shadow, or behind what --gaps closes";
	if (away > 0.0)
		return "it stands outside, and surface hides all that it would reach";
	return placed ? "surface hides all that it would reach: it is within rock, or shut in"
				  : "all that faces it lies in shadow";
}

static bool are_gaps_closed(const light_shares *f)
{
	return f->settings->bake.gaps != GW_GAPS_OPEN && f->result->report.gaps.scanners > 0;
}

static void print_nothing(const light_shares *f, const extent *e, size_t i)
{
	const gw_light_given *given = &f->result->given[i];
	char name[NAME];
	double away = outside(e, light_of(f, i));
	name_light(f, i, name);
	if (given->fate == GW_LIGHT_SHINES && away > FAR_EXTENTS * e->diagonal)
		text_message(
			stderr,
			"glowworm: note: %s, lights next to nothing: it is %.*f m away from the points\n", name,
			away < 10.0 ? 2 : 0, away);
	else
		text_message(stderr, "glowworm: note: %s, lights %snothing: %s\n", name,
					 given->fate == GW_LIGHT_SHINES ? "next to " : "",
					 reason(light_of(f, i), given->fate, away, are_gaps_closed(f)));
}

static void print_dark(const light_shares *f, const extent *e)
{
	size_t dark = 0;
	for (size_t i = 0; i < f->result->given_count; i++) {
		bool left_out = f->result->given[i].fate == GW_LIGHT_LEFT_OUT;
		if (!left_out && !shines(&f->result->given[i]) && ++dark <= LINES)
			print_nothing(f, e, i);
	}
	if (dark > LINES)
		fprintf(stderr, "glowworm: note: so %s %zu more; --report names %s\n",
				gw_plural(dark - LINES, "does", "do"), dark - LINES,
				gw_plural(dark - LINES, "it", "them"));
}

/* Flux of a lamp that stands somewhere; 0 where it is not known by its intensity alone. */
static double flux_of(const gw_light *l)
{
	double degree = acos(-1.0) / 180.0, inner = (double)l->inner_angle * degree;
	double outer = (double)l->outer_angle * degree, share = 2.0;
	if (l->type == GW_LIGHT_SUN || l->type == GW_LIGHT_ENVIRONMENT || l->distribution)
		return 0.0;
	if (l->type == GW_LIGHT_SPOT)
		share = 1.0 - 0.5 * (cos(inner) + cos(outer));
	else if (l->type == GW_LIGHT_DISC || l->type == GW_LIGHT_RECTANGLE)
		share = 0.5;
	return share * gw_relative_luminance((double)l->intensity[0], (double)l->intensity[1],
										 (double)l->intensity[2]);
}

/* Does all of the surface nearest to a lamp show it its back, but for a point? Then it stands
 * within rock or under the floor, or outside. */
static bool is_behind(const light_shares *f, const gw_light *light)
{
	const gw_points *points = &f->scene->points.points;
	struct {
		double squared, facing;
	} near[NEAREST + 1];
	size_t count = 0, backs = 0;
	for (size_t i = 0; f->result->normal && i < points->count; i++) {
		const float *n = f->result->normal + 3 * i;
		double squared = 0.0, facing = 0.0;
		for (int k = 0; k < 3; k++) {
			double to = light->position[k] - points->position[3 * i + (size_t)k];
			squared += to * to;
			facing += to * (double)n[k];
		}
		if (!isfinite(squared) || (count == NEAREST && squared >= near[count - 1].squared))
			continue;
		size_t at = count < NEAREST ? count++ : count - 1;
		for (; at > 0 && near[at - 1].squared > squared; at--)
			near[at] = near[at - 1];
		near[at].squared = squared;
		near[at].facing = facing;
	}
	for (size_t i = 0; i < count; i++)
		backs += near[i].facing < 0.0;
	return count == NEAREST && backs + 1 >= count;
}

/* Whether a lamp gives so little, beside what others give for their flux, that it may be the error
 * alone: light that leaks to it from under the floor. */
static bool is_doubtful(const light_shares *f, size_t i)
{
	const gw_bake_result *r = f->result;
	double flux = 0.0, share = 0.0, own = flux_of(light_of(f, i));
	for (size_t k = 0; k < r->given_count; k++) {
		double other = flux_of(light_of(f, k));
		flux += other;
		share += other > 0.0 && r->given[k].share > 0.0 ? r->given[k].share : 0.0;
	}
	/* A region may lie wherever the lamp does not shine. */
	if (!(own > 0.0) || !shines(&r->given[i]) || r->asked)
		return false;
	double given = r->given[i].share / share * flux / own;
	bool behind = given < DOUBTFUL_BEHIND && is_behind(f, light_of(f, i));
	return given < fmin(r->report.error.relative_rms, behind ? DOUBTFUL_BEHIND : DOUBTFUL);
}

/* Whether a lamp that there is no other to compare with is behind the surface nearest to it. */
static bool is_lost(const light_shares *f, size_t i)
{
	const gw_bake_result *r = f->result;
	for (size_t k = 0; k < r->given_count; k++)
		if (k != i && flux_of(light_of(f, k)) > 0.0)
			return false;
	return flux_of(light_of(f, i)) > 0.0 && shines(&r->given[i]) && !r->asked &&
		   is_behind(f, light_of(f, i));
}

/* A line's share of the light, and over how many frames. */
static void print_percent(const light_shares *f, double share)
{
	char percent[TEXT_PERCENT];
	fprintf(stderr, "%s %% of the light before it is reflected", text_percent(share, percent));
	if (f->frames > 1)
		fprintf(stderr, ", in the mean of %" PRIu32 " frames", f->frames);
}

/* A line of one that shines. */
static void print_share(const light_shares *f, const extent *e, size_t i)
{
	char name[NAME];
	double away = outside(e, light_of(f, i));
	name_light(f, i, name);
	text_message(stderr, "glowworm: %s: ", name);
	print_percent(f, f->result->given[i].share);
	if (away > FAR_EXTENTS * e->diagonal)
		fprintf(stderr, "; it is %.*f m away from the points", away < 10.0 ? 2 : 0, away);
	else if (is_doubtful(f, i))
		fprintf(stderr, "; so little for its power is within the error: it may light nothing%s",
				is_behind(f, light_of(f, i)) ? ", as it is behind the surface nearest to it" : "");
	else if (is_lost(f, i))
		fprintf(stderr, "; it is behind the surface nearest to it: if it is in rock or under "
						"the floor, all that it lights is error");
	fputc('\n', stderr);
}

typedef struct ranked {
	double share;
	size_t light;
} ranked;

/* The strongest first; of the same strength in their order. */
static int compare_ranks(const void *a, const void *b)
{
	const ranked *x = a, *y = b;
	if (x->share != y->share)
		return x->share < y->share ? 1 : -1;
	return (x->light > y->light) - (x->light < y->light);
}

static void print_shining(const light_shares *f, const extent *e)
{
	const gw_bake_result *r = f->result;
	ranked *rank = calloc(r->given_count + 1, sizeof *rank);
	size_t count = 0;
	double rest = 0.0, gathered = r->gathered_share;
	for (size_t i = 0; rank && i < r->given_count; i++) {
		if (!shines(&r->given[i]) || isnan(r->given[i].share))
			continue;
		gathered -= light_of(f, i)->type == GW_LIGHT_ENVIRONMENT ? r->given[i].share : 0.0;
		rank[count++] = (ranked){ r->given[i].share, i };
	}
	if (rank)
		qsort(rank, count, sizeof *rank, compare_ranks);
	for (size_t i = 0; i < count; i++) {
		if (i < LINES)
			print_share(f, e, rank[i].light);
		else
			rest += rank[i].share;
	}
	if (count > LINES) {
		fprintf(stderr, "glowworm: %zu more lights: together ", count - LINES);
		print_percent(f, rest);
		fputc('\n', stderr);
	}
	/* Where a sky shines on what glows by itself, nobody knows which is which. */
	if (gathered > 1e-9 && r->given_count > 0) {
		fprintf(stderr, "glowworm: skies and what glows: ");
		print_percent(f, gathered);
		fputc('\n', stderr);
	}
	free(rank);
}

void light_shares_print(const light_shares *f)
{
	const gw_bake_result *r = f->result;
	if (r->given_count == 0)
		return;
	extent e = find_extent(f);
	/* Of one lamp alone there is nothing to say, unless it stands far away or in rock. */
	if (r->given_count == 1 && shines(r->given) && !(r->given->share < 1.0) &&
		!(outside(&e, light_of(f, 0)) > FAR_EXTENTS * e.diagonal) && !is_lost(f, 0))
		return;
	print_shining(f, &e);
	print_dark(f, &e);
}

/* "called for" or not, and why, of a light in a plan. */
static void print_planned(const light_shares *f, const extent *e, size_t i, FILE *out)
{
	const gw_light *light = light_of(f, i);
	const gw_light_given *given = &f->result->given[i];
	char number[32], percent[TEXT_PERCENT];
	snprintf(number, sizeof number, "light %zu", i + 1);
	text_message(out, "%-12s %-14s %7s  %s%s%sa %s", number,
				 shines(given) ? "called for" : "not called for", "", light->name[0] ? "'" : "",
				 light->name, light->name[0] ? "', " : "", type_of(light));
	if (given->fate == GW_LIGHT_LEFT_OUT)
		fprintf(out, ": it is forbidden\n");
	else if (!shines(given))
		fprintf(out, ": %s\n", reason(light, given->fate, outside(e, light), are_gaps_closed(f)));
	else if (isnan(given->share))
		fprintf(out, ": gathered with the other skies, or with what glows\n");
	else
		fprintf(out, ": %s %% of the light before it is reflected\n",
				text_percent(given->share, percent));
}

void light_shares_print_plan(const light_shares *f, FILE *out)
{
	extent e = find_extent(f);
	size_t count = f->result->given_count;
	for (size_t i = 0; i < count && i < PLANNED_LINES; i++)
		print_planned(f, &e, i, out);
	if (count > PLANNED_LINES)
		fprintf(out, "%-12s %zu more; --json has them all\n", "", count - PLANNED_LINES);
}

void light_shares_write(json_writer *json, const light_shares *f)
{
	static const char *const fate[] = { [GW_LIGHT_SHINES] = "shines",
										[GW_LIGHT_BLACK] = "no power",
										[GW_LIGHT_AVERTED] = "nothing faces it",
										[GW_LIGHT_HIDDEN] = "hidden",
										[GW_LIGHT_LEFT_OUT] = "left out" };
	extent e = find_extent(f);
	json_put_open(json, "light_shares", '[');
	for (size_t i = 0; i < f->result->given_count; i++) {
		const gw_light *light = light_of(f, i);
		json_put_open_flat(json, NULL, '{');
		json_put_text(json, "name", light->name);
		json_put_text(json, "type", type_of(light));
		json_put_real(json, "share", f->result->given[i].share);
		json_put_text(json, "fate", fate[f->result->given[i].fate]);
		json_put_real(json, "outside", outside(&e, light));
		json_put_bool(json, "doubtful", is_doubtful(f, i) || is_lost(f, i));
		json_put_close(json, '}');
	}
	json_put_close(json, ']');
	json_put_real(json, "gathered_share", f->result->gathered_share);
}
