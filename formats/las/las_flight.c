/* las_flight.c - see las_flight.h. */
#include "las/las_flight.h"
#include "glowworm_host.h"
#include "las/las_notes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Points that are looked at, and of them in a window at least. */
#define SAMPLES 200000u
#define WINDOW_SAMPLES 100u
#define WINDOW_LEAST 20u

/* A window lasts so many seconds at least, and there are about so many; a line ends where no point
 * comes for so many seconds. */
#define WINDOW_SECONDS 1.0
#define WINDOWS 256.0
#define PAUSE_SECONDS 2.0

/* Angles beyond this many degrees are no beams down; tangents that vary less than by this, standard
 * deviation, tell no height. */
#define ANGLE_MOST 60.0
#define SPREAD_LEAST 0.02

/* What a fit may leave of the squared distances that angles account for; and by how much tangents
 * may be off, standard deviation: an aircraft sways by two degrees, and ranks are whole ones. */
#define LEFT_MOST 0.25
#define OFF_MOST 0.05

/* Where no height is told, the sensor is taken to be so many metres above all, or so many times the
 * width: as seen from everywhere on the ground it is overhead then, to 3 degrees. */
#define ABOVE_LEAST 1000.0
#define ABOVE_WIDTHS 10.0

/* The height is found again with that of the ground below each beam. */
#define ROUNDS 3

/* scan_angle counts steps of this many degrees. */
#define ANGLE_STEP 0.006

typedef struct beam {
	double source, time, tangent;
	double place[3]; /* that it found */
} beam;

/* A stretch of a flight line, from a time on to the next one. */
typedef struct window {
	double source, from, to;
	size_t first, count; /* beams */
	double place[3];     /* of the sensor, halfway */
	uint32_t scanner;    /* or SCAN_NO_SCANNER */
	bool alike;          /* its angles, which neither tell a height nor deny one */
} window;

typedef struct flight {
	const scan_column *position[3], *angle, *time, *source; /* the last two: or NULL */
	double angle_step;
	double time_scale;  /* 1 for seconds; what makes seconds of the order in the file */
	double least, most; /* angles, degrees */
	beam *beams;
	size_t beam_count;
	window *windows;
	size_t window_count;
} flight;

/* --------------------------------------------------------------------------------------- beams */

static double time_of(const flight *f, size_t point)
{
	return f->time ? scan_value(f->time, point) : (double)point * f->time_scale;
}

static double source_of(const flight *f, size_t point)
{
	return f->source ? scan_value(f->source, point) : 0.0;
}

static bool varies(const scan_column *column, size_t count)
{
	for (size_t i = 1; column && i < count; i++)
		if (scan_value(column, i) != scan_value(column, 0))
			return true;
	return false;
}

static bool find_columns(flight *f, const scan *cloud)
{
	const char *const axis[3] = { "x", "y", "z" };
	for (int k = 0; k < 3; k++)
		f->position[k] = scan_find(cloud, axis[k]);
	f->angle = scan_find(cloud, "scan_angle");
	f->angle_step = f->angle ? ANGLE_STEP : 1.0;
	if (!f->angle)
		f->angle = scan_find(cloud, "scan_angle_rank");
	f->time = scan_find(cloud, "gps_time");
	f->source = scan_find(cloud, "point_source_id");
	if (!varies(f->time, cloud->count))
		f->time = NULL;
	f->time_scale = cloud->count ? WINDOWS * WINDOW_SECONDS / (double)cloud->count : 0.0;
	return f->position[0] && f->position[1] && f->position[2] && varies(f->angle, cloud->count);
}

static bool load_beam(flight *f, size_t point, beam *to)
{
	double degrees = scan_value(f->angle, point) * f->angle_step;
	f->least = fmin(f->least, degrees);
	f->most = fmax(f->most, degrees);
	*to = (beam){ .source = source_of(f, point),
				  .time = time_of(f, point),
				  .tangent = tan(degrees * (M_PI / 180.0)) };
	for (int k = 0; k < 3; k++)
		to->place[k] = scan_value(f->position[k], point);
	return fabs(degrees) <= ANGLE_MOST && isfinite(to->time) &&
		   isfinite(to->place[0] + to->place[1] + to->place[2]);
}

static int by_time(const void *left, const void *right)
{
	const beam *a = left, *b = right;
	if (a->source != b->source)
		return a->source < b->source ? -1 : 1;
	if (a->time != b->time)
		return a->time < b->time ? -1 : 1;
	return memcmp(a->place, b->place, sizeof a->place);
}

/* Of every so many points one, not always the same, so that a mirror's rhythm is none of ours. */
static gw_status load_beams(flight *f, const scan *cloud, gw_error *error)
{
	size_t stride = 1 + cloud->count / SAMPLES;
	f->beams = reallocarray(NULL, cloud->count / stride + 1, sizeof *f->beams);
	if (!f->beams)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the flight lines of %zu points",
					   cloud->count);
	for (size_t i = 0; i + stride <= cloud->count; i += stride) {
		size_t point = i + (size_t)((i * 2654435761u) >> 8) % stride;
		f->beam_count += load_beam(f, point, f->beams + f->beam_count);
	}
	qsort(f->beams, f->beam_count, sizeof *f->beams, by_time);
	return GW_OK;
}

/* ------------------------------------------------------------------------------------- windows */

static bool is_line_end(const beam *before, const beam *next)
{
	return next->source != before->source || next->time - before->time > PAUSE_SECONDS;
}

/* Seconds that a window lasts: of all the time in which points were seen. */
static double window_seconds(const flight *f)
{
	double seen = 0.0;
	for (size_t i = 1; i < f->beam_count; i++)
		if (!is_line_end(f->beams + i - 1, f->beams + i))
			seen += f->beams[i].time - f->beams[i - 1].time;
	return fmax(WINDOW_SECONDS, seen / WINDOWS);
}

static gw_status cut_windows(flight *f, gw_error *error)
{
	double seconds = window_seconds(f);
	f->windows = reallocarray(NULL, f->beam_count + 1, sizeof *f->windows);
	if (!f->windows)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the flight lines of %zu beams",
					   f->beam_count);
	window *w = NULL;
	for (size_t i = 0; i < f->beam_count; i++) {
		const beam *b = f->beams + i;
		bool full = w && w->count >= WINDOW_SAMPLES && b->time - w->from > seconds;
		if (!w || full || is_line_end(b - 1, b)) {
			w = f->windows + f->window_count++;
			*w = (window){ .source = b->source, .from = b->time, .first = i };
		}
		w->to = b->time;
		w->count++;
	}
	return GW_OK;
}

/* ----------------------------------------------------------------------------------------- fit */

/* Sums over a window's beams, of offsets from its first place: m of 1, time and tangent with each
 * other, v of these with x and y. */
typedef struct fit {
	double m[3][3], v[3][2], squared;
	double height; /* of the sensor above `ground`; 0: not known yet */
	double ground, highest;
} fit;

static void sum_beams(const flight *f, const window *w, fit *s)
{
	const beam *first = f->beams + w->first;
	double middle = 0.5 * (w->from + w->to), half = fmax(0.5 * (w->to - w->from), 1e-9);
	memset(s->m, 0, sizeof s->m);
	memset(s->v, 0, sizeof s->v);
	s->squared = 0.0;
	for (const beam *b = first; b < first + w->count; b++) {
		double above = s->height > 0.0 ? (b->place[2] - s->ground) / s->height : 0.0;
		double by[3] = { 1.0, (b->time - middle) / half, b->tangent * fmax(1.0 - above, 0.0) };
		for (int k = 0; k < 2; k++) {
			double to = b->place[k] - first->place[k];
			s->squared += to * to;
			for (int row = 0; row < 3; row++)
				s->v[row][k] += by[row] * to;
		}
		for (int row = 0; row < 3; row++)
			for (int column = 0; column < 3; column++)
				s->m[row][column] += by[row] * by[column];
	}
}

/* Gaussian elimination without pivots, as m is positive; false where angle and time are one. */
static bool solve(const fit *s, double solution[3][2], double *spread)
{
	double m[3][3], v[3][2];
	memcpy(m, s->m, sizeof m);
	memcpy(v, s->v, sizeof v);
	for (int row = 1; row < 3; row++)
		for (int above = 0; above < row; above++) {
			double factor = m[above][above] > 0.0 ? m[row][above] / m[above][above] : 0.0;
			for (int k = above; k < 3; k++)
				m[row][k] -= factor * m[above][k];
			for (int k = 0; k < 2; k++)
				v[row][k] -= factor * v[above][k];
		}
	*spread = m[2][2];
	if (!(m[2][2] > SPREAD_LEAST * SPREAD_LEAST * s->m[0][0]))
		return false;
	for (int row = 2; row >= 0; row--)
		for (int k = 0; k < 2; k++) {
			double left = v[row][k];
			for (int below = row + 1; below < 3; below++)
				left -= m[row][below] * solution[below][k];
			solution[row][k] = m[row][row] > 1e-9 * s->m[0][0] ? left / m[row][row] : 0.0;
		}
	return true;
}

/* What a solution leaves of the squared offsets. */
static double left_over(const fit *s, double solution[3][2])
{
	double left = s->squared;
	for (int row = 0; row < 3; row++)
		for (int k = 0; k < 2; k++)
			left -= solution[row][k] * s->v[row][k];
	return left;
}

/* Whether the tangents of a window vary too little to tell anything. */
static bool are_alike(const fit *s)
{
	double n = s->m[0][0], sum = s->m[0][2];
	return s->m[2][2] - sum * sum / n < SPREAD_LEAST * SPREAD_LEAST * n;
}

/* Where the sensor was halfway through a window; false where its beams do not say. */
static bool fit_window(const flight *f, window *w)
{
	const beam *first = f->beams + w->first;
	fit s = { .highest = -INFINITY };
	double solution[3][2] = { { 0 } }, spread = 0.0;
	for (const beam *b = first; b < first + w->count; b++) {
		s.ground += b->place[2] / (double)w->count;
		s.highest = fmax(s.highest, b->place[2]);
	}
	for (int round = 0; round < ROUNDS; round++) {
		sum_beams(f, w, &s);
		w->alike = round == 0 && are_alike(&s);
		if (!solve(&s, solution, &spread))
			return false;
		s.height = hypot(solution[2][0], solution[2][1]);
	}
	for (int k = 0; k < 2; k++)
		w->place[k] = first->place[k] + solution[0][k];
	w->place[2] = s.ground + s.height;
	double most = fmin(LEFT_MOST * spread, OFF_MOST * OFF_MOST * (double)w->count);
	return w->place[2] > s.highest && left_over(&s, solution) <= most * s.height * s.height;
}

/* ------------------------------------------------------------------------------------ scanners */

/* The window of a point: the last of its line that has begun by then, or the line's first. */
static const window *window_at(const flight *f, double source, double time)
{
	size_t low = 0, high = f->window_count;
	while (high - low > 1) {
		size_t middle = low + (high - low) / 2;
		const window *w = f->windows + middle;
		bool begun = w->source < source || (w->source == source && w->from <= time);
		*(begun ? &low : &high) = middle;
	}
	const window *w = f->windows + low;
	if (w->source != source && low + 1 < f->window_count)
		w++;
	return w->source == source ? w : NULL;
}

static uint32_t scanner_at(const flight *f, size_t point)
{
	double time = time_of(f, point);
	const window *w = isfinite(time) ? window_at(f, source_of(f, point), time) : NULL;
	return w ? w->scanner : SCAN_NO_SCANNER;
}

/* All of them or, when that says too little, none. */
static gw_status take_scanners(flight *f, scan *cloud, gw_error *error)
{
	size_t known = 0;
	for (size_t i = 0; i < cloud->count; i++)
		known += scanner_at(f, i) != SCAN_NO_SCANNER;
	if (known == 0 || known < cloud->count - known)
		return GW_OK;
	GW_TRY(scan_part_scanners(cloud, error));
	double low = INFINITY, high = -INFINITY;
	for (size_t i = 0; i < f->window_count; i++) {
		window *w = f->windows + i;
		if (w->scanner == SCAN_NO_SCANNER)
			continue;
		w->scanner = scan_scanner_at(cloud, w->place);
		if (w->scanner == SCAN_NO_SCANNER)
			return gw_fail(error, GW_ERROR_MEMORY, "no memory for another scanner");
		low = fmin(low, w->place[2]);
		high = fmax(high, w->place[2]);
	}
	for (size_t i = 0; i < cloud->count; i++)
		cloud->scanner_of[i] = scanner_at(f, i);
	return las_note(cloud, error,
					"airborne: by their scan angles and times, %zu of %zu points were seen from %s "
					"to %s high",
					known, cloud->count, GW_SAID_PLACE(round(low)), GW_SAID_PLACE(round(high)));
}

/* Whether this is a piece of a flight, too small for angles that tell a height: no window tells or
 * denies one, there are times, and all beams go down. */
static bool is_piece(const flight *f)
{
	size_t alike = 0;
	for (size_t i = 0; i < f->window_count; i++) {
		const window *w = f->windows + i;
		if (w->count >= WINDOW_LEAST && !w->alike)
			return false;
		alike += w->alike ? w->count : 0;
	}
	return f->time && f->source && 2 * alike > f->beam_count && f->least >= -ANGLE_MOST &&
		   f->most <= ANGLE_MOST;
}

static gw_status take_above(const flight *f, scan *cloud, gw_error *error)
{
	double low[3] = { INFINITY, INFINITY, INFINITY }, high[3] = { -INFINITY, -INFINITY, -INFINITY };
	for (const beam *b = f->beams; b < f->beams + f->beam_count; b++)
		for (int k = 0; k < 3; k++) {
			low[k] = fmin(low[k], b->place[k]);
			high[k] = fmax(high[k], b->place[k]);
		}
	double width = hypot(high[0] - low[0], high[1] - low[1]);
	double place[3] = { 0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1]),
						round(high[2] + fmax(ABOVE_LEAST, ABOVE_WIDTHS * width)) };
	GW_TRY(scan_add_scanner(cloud, place, 0, cloud->count, error));
	return las_note(cloud, error,
					"airborne: scan angles from %g to %g degrees, too much alike in each flight "
					"line to tell from how high; taken as seen from far above",
					round(f->least), round(f->most));
}

static gw_status find(flight *f, scan *cloud, gw_error *error)
{
	GW_TRY(load_beams(f, cloud, error));
	GW_TRY(cut_windows(f, error));
	for (size_t i = 0; i < f->window_count; i++) {
		window *w = f->windows + i;
		w->scanner = w->count >= WINDOW_LEAST && fit_window(f, w) ? 0 : SCAN_NO_SCANNER;
	}
	if (f->window_count && is_piece(f))
		return take_above(f, cloud, error);
	return f->window_count ? take_scanners(f, cloud, error) : GW_OK;
}

gw_status las_flight_find(scan *cloud, gw_error *error)
{
	flight f = { .least = INFINITY, .most = -INFINITY };
	if (!find_columns(&f, cloud))
		return GW_OK;
	gw_status status = find(&f, cloud, error);
	free(f.beams);
	free(f.windows);
	return status;
}

bool las_flight_is_told(const scan *some, const format_seen *seen)
{
	const scan_column *angle = scan_find(some, "scan_angle");
	if (!angle)
		angle = scan_find(some, "scan_angle_rank");
	return angle && !seen->zero[angle - some->column];
}
