#include "comparison/tradeoff_plot.h"
#include "program/text_quote.h"

#include <math.h>
#include <string.h>

#define PANEL_WIDTH 430.0
#define PANEL_HEIGHT 380.0
#define LEFT 70.0
#define TOP 64.0
#define GAP 90.0

/* Of labels, in pixels; a sans-serif letter of 11 pixels is about half as wide. */
#define LETTER_WIDTH 6.0
#define LABEL_HEIGHT 13.0

/* One panel: where it is, and the range of its axes, as logarithms. */
typedef struct panel {
	double x, y;
	double x_least, x_most, y_least, y_most;
	bool memory;
} panel;

/* A rectangle on the page, in pixels. */
typedef struct box {
	double left, top, right, bottom;
} box;

static bool drawn(const tradeoff *t, size_t i)
{
	return i > 0 && t->run[i].status == GW_OK && t->run[i].difference.rel_rmse > 0.0 &&
		   isfinite(t->run[i].difference.rel_rmse);
}

static double x_of(const panel *p, const tradeoff_run *run)
{
	return p->memory ? (double)run->host_bytes / 1e6 : run->seconds;
}

static double y_of(const tradeoff_run *run)
{
	return 100.0 * run->difference.rel_rmse;
}

static double place_x(const panel *p, double x)
{
	return p->x + PANEL_WIDTH * (log10(x) - p->x_least) / (p->x_most - p->x_least);
}

static double place_y(const panel *p, double y)
{
	return p->y + PANEL_HEIGHT * (p->y_most - log10(y)) / (p->y_most - p->y_least);
}

/* A tenth of a decade of room around what is drawn. */
static panel fit(const tradeoff *t, double x, bool memory)
{
	panel p = { x, TOP, INFINITY, -INFINITY, INFINITY, -INFINITY, memory };
	for (size_t i = 0; i < t->count; i++) {
		if (!drawn(t, i))
			continue;
		double a = log10(fmax(x_of(&p, &t->run[i]), 1e-6)), b = log10(y_of(&t->run[i]));
		p.x_least = fmin(p.x_least, a - 0.1);
		p.x_most = fmax(p.x_most, a + 0.1);
		p.y_least = fmin(p.y_least, b - 0.1);
		p.y_most = fmax(p.y_most, b + 0.1);
	}
	if (!(p.x_least < p.x_most))
		p.x_least = p.y_least = 0.0, p.x_most = p.y_most = 1.0;
	return p;
}

static void tick(const panel *p, FILE *out, double value, bool upright)
{
	double x = upright ? p->x : place_x(p, value), y = upright ? place_y(p, value) : p->y;
	fprintf(out, "<path class=\"grid\" d=\"M%.1f %.1f %c%.1f\"/>\n", x, y, upright ? 'h' : 'v',
			upright ? PANEL_WIDTH : PANEL_HEIGHT);
	if (upright)
		fprintf(out, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"end\">%.3g</text>\n", x - 8.0,
				y + 4.0, value);
	else
		fprintf(out, "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"middle\">%.4g</text>\n", x,
				y + PANEL_HEIGHT + 18.0, value);
}

/* Pixels between the middles of numbers that stand beside each other. */
#define NUMBER_WIDTH 30.0

/* Ticks at 1, 2 and 5; where a range is short, at every tenth of the decade's unit. */
static void draw_ticks(const panel *p, FILE *out, bool upright)
{
	double least = upright ? p->y_least : p->x_least, most = upright ? p->y_most : p->x_most;
	bool narrow = most - least < 0.6;
	double last = -INFINITY;
	for (int decade = (int)floor(least); decade <= (int)ceil(most); decade++)
		for (int k = 10; k < 100; k += narrow && k >= 20 ? 5 : 1) {
			double value = k * 0.1 * pow(10.0, decade);
			bool round = k == 10 || k == 20 || k == 50 || narrow;
			bool inside = log10(value) >= least && log10(value) <= most;
			double next = k > 90 ? place_x(p, pow(10.0, decade + 1)) : INFINITY;
			double x = place_x(p, value);
			if (!round || !inside || (!upright && fmin(x - last, next - x) < NUMBER_WIDTH))
				continue;
			last = x;
			tick(p, out, value, upright);
		}
}

static void draw_axes(const panel *p, FILE *out)
{
	draw_ticks(p, out, false);
	draw_ticks(p, out, true);
	fprintf(out, "<rect class=\"frame\" x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\"/>\n",
			p->x, p->y, PANEL_WIDTH, PANEL_HEIGHT);
	fprintf(out, "<text class=\"axis\" x=\"%.1f\" y=\"%.1f\" text-anchor=\"middle\">%s</text>\n",
			p->x + PANEL_WIDTH / 2.0, p->y + PANEL_HEIGHT + 40.0,
			p->memory ? "peak memory of the process, MB" : "seconds of the bake");
	fprintf(out,
			"<text class=\"axis\" transform=\"translate(%.1f %.1f) rotate(-90)\" "
			"text-anchor=\"middle\">difference from the reference, %%</text>\n",
			p->x - 46.0, p->y + PANEL_HEIGHT / 2.0);
}

/* Whether no other run of the panel is both as far left and as near. */
static bool on_front(const tradeoff *t, const panel *p, size_t i)
{
	double x = x_of(p, &t->run[i]), y = y_of(&t->run[i]);
	for (size_t j = 0; j < t->count; j++) {
		double off_x = drawn(t, j) ? x_of(p, &t->run[j]) - x : INFINITY;
		double off_y = drawn(t, j) ? y_of(&t->run[j]) - y : INFINITY;
		if (off_x <= 0.0 && off_y <= 0.0 && (off_x < 0.0 || off_y < 0.0))
			return false;
	}
	return drawn(t, i);
}

/* From left to right. */
static void draw_front(const tradeoff *t, const panel *p, FILE *out)
{
	double last = -INFINITY;
	bool any = false;
	for (size_t k = 0; k < t->count; k++) {
		const tradeoff_run *next = NULL;
		for (size_t i = 0; i < t->count; i++)
			if (on_front(t, p, i) && x_of(p, &t->run[i]) > last &&
				(!next || x_of(p, &t->run[i]) < x_of(p, next)))
				next = &t->run[i];
		if (!next)
			break;
		last = x_of(p, next);
		fprintf(out, "%s%.1f %.1f", any ? " L" : "<path class=\"front\" d=\"M", place_x(p, last),
				place_y(p, y_of(next)));
		any = true;
	}
	if (any)
		fputs("\"/>\n", out);
}

static box mark_box(const tradeoff *t, const panel *p, size_t i)
{
	double x = place_x(p, x_of(p, &t->run[i])), y = place_y(p, y_of(&t->run[i]));
	return (box){ x - 6.0, y - 6.0, x + 6.0, y + 6.0 };
}

static double overlap(const box *a, const box *b)
{
	double width = fmin(a->right, b->right) - fmax(a->left, b->left);
	double height = fmin(a->bottom, b->bottom) - fmax(a->top, b->top);
	return width > 0.0 && height > 0.0 ? width * height : 0.0;
}

/* How much of a label's box is taken: by marks, by labels that stand there, by the panel's edge. */
static double taken(const tradeoff *t, const panel *p, const box *label, const box *stands,
					size_t count)
{
	double sum = 0.0;
	for (size_t i = 0; i < t->count; i++) {
		box mark = drawn(t, i) ? mark_box(t, p, i) : (box){ 0 };
		sum += overlap(label, &mark);
	}
	for (size_t i = 0; i < count; i++)
		sum += overlap(label, &stands[i]);
	const box inside = { p->x, p->y, p->x + PANEL_WIDTH, p->y + PANEL_HEIGHT };
	double area = (label->right - label->left) * (label->bottom - label->top);
	return sum + area - overlap(label, &inside);
}

/* A label stands beside its mark; where something is in its way, on the other side or further up or
 * down, where least is. */
static box place_label(const tradeoff *t, const panel *p, size_t i, const box *stands, size_t count)
{
	double width = LETTER_WIDTH * (double)strlen(t->run[i].name), least = INFINITY;
	box mark = mark_box(t, p, i), best = { 0 };
	for (int k = 0; k < 24; k++) {
		double shift = LABEL_HEIGHT * (k / 4 + (k / 2 % 2)) * (k / 2 % 2 ? -0.5 : 0.5);
		double left = k % 2 ? mark.left - 3.0 - width : mark.right + 3.0;
		double top = 0.5 * (mark.top + mark.bottom - LABEL_HEIGHT) + shift * 2.0;
		box label = { left, top, left + width, top + LABEL_HEIGHT };
		double found = taken(t, p, &label, stands, count);
		if (found < least - 0.5) {
			least = found;
			best = label;
		}
	}
	return best;
}

/* A circle for rays, a square for cones, a triangle for volumes, which stands on its tip where
 * light goes from cell to cell, a rhomb for probes, a star of four tips for buffers. */
static void draw_mark(gw_method method, double x, double y, FILE *out)
{
	if (method == GW_METHOD_RAYS)
		fprintf(out, "<circle class=\"rays\" cx=\"%.1f\" cy=\"%.1f\" r=\"5\"/>\n", x, y);
	else if (method == GW_METHOD_CONES)
		fprintf(out, "<rect class=\"cones\" x=\"%.1f\" y=\"%.1f\" width=\"9\" height=\"9\"/>\n",
				x - 4.5, y - 4.5);
	else if (method == GW_METHOD_BUFFERS)
		fprintf(out, "<path class=\"buffers\" d=\"M%.1f %.1fl2 5 5 2-5 2-2 5-2-5-5-2 5-2z\"/>\n", x,
				y - 7.0);
	else if (method == GW_METHOD_LPV)
		fprintf(out, "<path class=\"lpv\" d=\"M%.1f %.1fl5.5 -10h-11z\"/>\n", x, y + 6.0);
	else if (method == GW_METHOD_PROBES)
		fprintf(out, "<path class=\"probes\" d=\"M%.1f %.1fl5.5 5.5l-5.5 5.5l-5.5 -5.5z\"/>\n", x,
				y - 5.5);
	else
		fprintf(out, "<path class=\"volume\" d=\"M%.1f %.1fl5.5 10h-11z\"/>\n", x, y - 6.0);
}

/* From a label that stands further up or down to its mark. */
static void draw_leader(const box *label, bool left, double x, double y, FILE *out)
{
	double middle = 0.5 * (label->top + label->bottom);
	if (fabs(middle - y) > 0.75 * LABEL_HEIGHT)
		fprintf(out, "<path class=\"leader\" d=\"M%.1f %.1fL%.1f %.1f\"/>\n", x, y,
				left ? label->right + 1.0 : label->left - 1.0, middle);
}

static void draw_marks(const tradeoff *t, const panel *p, FILE *out)
{
	box stands[TRADEOFF_RUNS];
	size_t count = 0;
	for (size_t i = 0; i < t->count; i++) {
		if (!drawn(t, i))
			continue;
		const tradeoff_run *run = &t->run[i];
		double x = place_x(p, x_of(p, run)), y = place_y(p, y_of(run));
		box label = place_label(t, p, i, stands, count);
		stands[count++] = label;
		bool left = label.left < x;
		draw_leader(&label, left, x, y, out);
		draw_mark(run->bake.method, x, y, out);
		fprintf(out, "<text class=\"label\" x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\">%s</text>\n",
				left ? label.right : label.left, label.bottom - 3.5, left ? "end" : "start",
				run->name);
	}
}

void tradeoff_plot_write(const tradeoff *t, FILE *out)
{
	const gw_error_estimate *e = &t->run[0].estimate;
	char error[TEXT_PERCENT];
	double width = 2.0 * PANEL_WIDTH + LEFT + GAP + 30.0, height = PANEL_HEIGHT + TOP + 60.0;
	fprintf(out,
			"<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%.0f\" height=\"%.0f\" "
			"viewBox=\"0 0 %.0f %.0f\">\n",
			width, height, width, height);
	fputs("<style>text{font:12px sans-serif;fill:#333}.axis{font-size:13px}.label{font-size:11px}"
		  ".grid{stroke:#ddd}.frame{fill:none;stroke:#333}"
		  ".front{fill:none;stroke:#888;stroke-width:1.5}.leader{stroke:#888;stroke-width:0.6}"
		  ".rays{fill:#1f6fb4}.cones{fill:#d9730d}.volume{fill:#2e7d4f}"
		  ".buffers{fill:#b03a5b}.lpv{fill:#8a9a2b}.probes{fill:#7a4fa3}</style>\n",
		  out);
	fprintf(out, "<rect width=\"%.0f\" height=\"%.0f\" fill=\"white\"/>\n", width, height);
	fprintf(
		out,
		"<text class=\"axis\" x=\"%.0f\" y=\"24\">Circles are rays, squares cones, triangles "
		"volumes (on their tips lpv), rhombs probes, stars buffers.</text>\n"
		"<text class=\"axis\" x=\"%.0f\" y=\"44\">A line joins what nothing beats in both axes of "
		"its panel. The reference took %.3g s and estimates its own error as %s %%.</text>\n",
		LEFT, LEFT, t->run[0].seconds, text_percent(e->relative_rms, error));
	for (int k = 0; k < 2; k++) {
		panel p = fit(t, k ? LEFT + PANEL_WIDTH + GAP : LEFT, k == 1);
		draw_axes(&p, out);
		draw_front(t, &p, out);
		draw_marks(t, &p, out);
	}
	fputs("</svg>\n", out);
}
