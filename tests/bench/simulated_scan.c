/* simulated_scan.c - see simulated_scan.h */
#include "simulated_scan.h"
#include "glowworm_host.h"
#include "random_numbers.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846
#define LOWEST (-62.0 * PI / 180.0) /* below, a scanner sees its tripod */
#define HIGHEST (89.0 * PI / 180.0)
#define CAMERA_HALF 0.554 /* tangent of half of 58 degrees */
#define RING 6            /* rays around the middle of a beam */
#define MIDDLE 0.25       /* weight of the one in the middle */
#define MIXED 4.0         /* standard deviations of noise that a mixed pixel is off at least */
#define MIXED_LEAST 0.002 /* metres, as well */
#define HOLE_SIZE 0.04    /* radius of a hole, of the scene's diagonal */
#define HOLES 64

#define BEAMS 16                     /* of a scanner that is carried */
#define BEAMS_HALF (15 * PI / 180.0) /* up and down from its equator */
#define WAY_FREE 0.8                 /* of a way that ends at a wall */
#define DRIFT_WAVES 4                /* of a drift, and twice as many of there and back */

typedef struct job {
	const mesh_scene *scene;
	const reference_tracer *tracer;
	const scan_setup *setup;
	station_scan *station;
	size_t index; /* of the station */
	double hole[HOLES][3];
	size_t hole_count;
	double hole_radius, diagonal;
} job;

/* ------------------------------------------------------------------------- random numbers */

static void random_direction(uint64_t *state, double out[3])
{
	double z = 2.0 * random_number(state) - 1.0, turn = 2.0 * PI * random_number(state);
	out[0] = sqrt(1.0 - z * z) * cos(turn);
	out[1] = sqrt(1.0 - z * z) * sin(turn);
	out[2] = z;
}

/* The sequence of one cell, or of a station when the cell is SIZE_MAX. */
static uint64_t cell_state(const job *j, size_t cell)
{
	uint64_t state = j->setup->seed * 0xd1342543de82ef95u + j->index * 0xaf251af3b0f025b5u;
	random_number(&state);
	state += (uint64_t)cell * 0x9fb21c651e98df25u;
	random_number(&state);
	return state;
}

/* -------------------------------------------------------------------------------- frames */

static void turn_vector(const double axes[9], const double v[3], double out[3])
{
	for (size_t k = 0; k < 3; k++)
		out[k] = axes[3 * k] * v[0] + axes[3 * k + 1] * v[1] + axes[3 * k + 2] * v[2];
}

void station_scan_to_world(const station_scan *s, const double own[3], double world[3])
{
	turn_vector(s->axes, own, world);
	for (size_t k = 0; k < 3; k++)
		world[k] += s->own[k];
}

void station_scan_direction(const station_scan *s, const scan_setup *setup, size_t column,
							size_t row, double d[3])
{
	double across = s->left + s->column_step * (double)column;
	double up = s->low + s->row_step * (double)row;
	d[0] = setup->camera ? 1.0 : cos(up) * cos(across);
	d[1] = setup->camera ? across : cos(up) * sin(across);
	d[2] = setup->camera ? up : sin(up);
	double length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
	for (size_t k = 0; k < 3; k++)
		d[k] /= length;
}

/* A rotation by a small angle about an axis (Rodrigues). */
static void make_rotation(const double axis[3], double angle, double out[9])
{
	double c = cos(angle), s = sin(angle);
	for (size_t i = 0; i < 3; i++)
		for (size_t k = 0; k < 3; k++)
			out[3 * i + k] = (1.0 - c) * axis[i] * axis[k] + (i == k ? c : 0.0);
	for (size_t k = 0; k < 3; k++) {
		size_t a = (k + 1) % 3, b = (k + 2) % 3;
		out[3 * a + b] -= s * axis[k];
		out[3 * b + a] += s * axis[k];
	}
}

static void multiply(const double a[9], const double b[9], double out[9])
{
	for (size_t i = 0; i < 3; i++)
		for (size_t k = 0; k < 3; k++)
			out[3 * i + k] = a[3 * i] * b[k] + a[3 * i + 1] * b[3 + k] + a[3 * i + 2] * b[6 + k];
}

/* A drift of standard deviation 1 along each axis at a share of the way: some waves. */
static void drift_at(const job *j, uint64_t seed, double share, double out[3])
{
	uint64_t state = j->setup->seed * 0x9fb21c651e98df25u + seed;
	for (size_t k = 0; k < 3; k++) {
		out[k] = 0.0;
		for (int wave = 1; wave <= DRIFT_WAVES; wave++)
			out[k] +=
				sqrt(2.0 / DRIFT_WAVES) * cos(2.0 * PI * (wave * share + random_number(&state)));
	}
}

/* How far one gets from a station towards another: half-way, or almost to a wall that is nearer. */
static double free_way(const job *j, const double from[3], const double to[3], double direction[3])
{
	double length = 0.0, distance;
	uint32_t triangle;
	for (size_t k = 0; k < 3; k++) {
		direction[k] = to[k] - from[k];
		length += direction[k] * direction[k];
	}
	length = sqrt(length);
	if (length == 0.0)
		return 0.0;
	for (size_t k = 0; k < 3; k++)
		direction[k] /= length;
	bool met = reference_tracer_hit(j->tracer, from, direction, &triangle, &distance);
	return met ? fmin(WAY_FREE * distance, 0.5 * length) : 0.5 * length;
}

/* Where on its way a scanner that is carried is: there in the first half, back in the second, from
 * one station to the next. Where a wall is between, the way ends before it and goes on behind. */
static void find_pose(const job *j, double share, double place[3])
{
	const mesh_scene *scene = j->scene;
	size_t ways = scene->station_count > 1 ? scene->station_count - 1 : 1;
	double along = (share < 0.5 ? 2.0 * share : 2.0 - 2.0 * share) * (double)ways, direction[3];
	size_t way = (size_t)fmin(along, (double)ways - 1.0);
	const double *from = scene->station[way];
	const double *to = scene->station[(way + 1) % scene->station_count];
	along -= (double)way;
	double done = 2.0 * along;
	if (along > 0.5) { /* the second half is walked from the other end */
		const double *swapped = from;
		from = to;
		to = swapped;
		done = 2.0 - 2.0 * along;
	}
	double walked = done * free_way(j, from, to, direction);
	for (size_t k = 0; k < 3; k++)
		place[k] = from[k] + walked * direction[k];
}

/* The scanner turns in the hand, and its axis with it. */
static void place_pose(job *j)
{
	const scan_faults *f = &j->setup->faults;
	station_scan *s = j->station;
	uint64_t state = cell_state(j, SIZE_MAX);
	double share = ((double)j->index + 0.5) / (double)j->setup->poses;
	double off[3], turn[3], axis[3], error[9];
	find_pose(j, share, s->place);
	random_direction(&state, axis);
	make_rotation(axis, 2.0 * PI * random_number(&state), s->true_axes);
	drift_at(j, 1, share, off);
	drift_at(j, 2, share, turn);
	double angle = sqrt(turn[0] * turn[0] + turn[1] * turn[1] + turn[2] * turn[2]);
	for (size_t k = 0; k < 3; k++) {
		turn[k] /= fmax(angle, 1e-9);
		s->own[k] = s->place[k] + f->registration * off[k];
	}
	make_rotation(turn, angle * f->registration_turn * PI / 180.0, error);
	multiply(error, s->true_axes, s->axes);
}

/* A scanner stands upright and turned at random; a camera looks at the middle of the scene. */
static void place_station(job *j)
{
	station_scan *s = j->station;
	const mesh_scene *scene = j->scene;
	uint64_t state = cell_state(j, SIZE_MAX);
	double turn = 2.0 * PI * random_number(&state), tilt = 0.0, off[3], axis[3], error[9];
	memcpy(s->place, scene->station[j->index], sizeof s->place);
	if (j->setup->camera) {
		double to[3];
		for (size_t k = 0; k < 3; k++)
			to[k] = 0.5 * (scene->low[k] + scene->high[k]) - s->place[k];
		to[2] = fmin(to[2], 0.1 - 0.6 * s->place[2]); /* things stand on the ground */
		turn = atan2(to[1], to[0]);
		tilt = atan2(to[2], hypot(to[0], to[1]));
	}
	const double about_z[9] = { cos(turn), -sin(turn), 0, sin(turn), cos(turn), 0, 0, 0, 1 };
	const double about_y[9] = { cos(tilt), 0, -sin(tilt), 0, 1, 0, sin(tilt), 0, cos(tilt) };
	multiply(about_z, about_y, s->true_axes);
	random_direction(&state, off);
	random_direction(&state, axis);
	make_rotation(axis, j->setup->faults.registration_turn * PI / 180.0 * random_normal(&state),
				  error);
	multiply(error, s->true_axes, s->axes);
	for (size_t k = 0; k < 3; k++)
		s->own[k] = s->place[k] + j->setup->faults.registration * off[k];
}

/* Cells of a station at a distance of `step` from each other: radians, or tangents of a camera. As
 * many where the number of rows is given. */
static void size_grid(station_scan *s, const scan_setup *setup, double step)
{
	double width = setup->camera ? 2.0 * CAMERA_HALF : 2.0 * PI;
	double height = setup->camera      ? 1.5 * CAMERA_HALF
					: setup->poses > 0 ? 2.0 * BEAMS_HALF
									   : HIGHEST - LOWEST;
	double rows = setup->rows > 0    ? (double)setup->rows
				  : setup->poses > 0 ? BEAMS
									 : fmax(4.0, round(height / step));
	bool as_many = setup->rows > 0 || setup->poses > 0;
	s->rows = (size_t)rows;
	s->columns =
		(size_t)fmax(4.0, round(as_many ? width * height / (step * step) / rows : width / step));
	s->column_step = width / (double)s->columns;
	s->row_step = height / (double)s->rows;
	s->left = setup->camera ? 0.5 * s->column_step - CAMERA_HALF : 0.0;
	s->low = 0.5 * s->row_step + (setup->camera      ? -0.75 * CAMERA_HALF
								  : setup->poses > 0 ? -BEAMS_HALF
													 : LOWEST);
}

/* --------------------------------------------------------------------------------- beams */

/* Two unit vectors at right angles to a unit vector and to each other. */
static void make_axes(const double n[3], double u[3], double v[3])
{
	double sign = copysign(1.0, n[2]), a = -1.0 / (sign + n[2]), b = n[0] * n[1] * a;
	const double first[3] = { 1.0 + sign * n[0] * n[0] * a, sign * b, -sign * n[0] };
	const double second[3] = { b, sign + n[1] * n[1] * a, -n[1] };
	memcpy(u, first, sizeof first);
	memcpy(v, second, sizeof second);
}

/* Sends one beam; false when less than half of it comes back. */
static bool send_beam(const job *j, const double direction[3], scan_cell *cell, double *mean)
{
	const scan_faults *f = &j->setup->faults;
	const station_scan *s = j->station;
	double u[3], v[3], distance, weight = 0.0, sum = 0.0;
	uint32_t triangle;
	if (!reference_tracer_hit(j->tracer, s->place, direction, &cell->triangle, &cell->range))
		return false;
	for (size_t k = 0; k < 3; k++)
		cell->surface[k] = s->place[k] + cell->range * direction[k];
	make_axes(direction, u, v);
	for (int i = 0; i < RING && f->beam_width + f->beam_divergence > 0.0; i++) {
		double x = 0.5 * cos(2.0 * PI * i / RING), y = 0.5 * sin(2.0 * PI * i / RING);
		double from[3], to[3];
		for (size_t k = 0; k < 3; k++) {
			double out = x * u[k] + y * v[k];
			from[k] = s->place[k] + f->beam_width * out;
			to[k] = direction[k] + f->beam_divergence * out;
		}
		if (!reference_tracer_hit(j->tracer, from, to, &triangle, &distance))
			continue;
		weight += (1.0 - MIDDLE) / RING;
		sum += (1.0 - MIDDLE) / RING * distance;
	}
	*mean = (sum + MIDDLE * cell->range) / (weight + MIDDLE);
	return true;
}

static bool is_in_hole(const job *j, const double p[3])
{
	for (size_t i = 0; i < j->hole_count; i++) {
		double x = p[0] - j->hole[i][0], y = p[1] - j->hole[i][1], z = p[2] - j->hole[i][2];
		if (x * x + y * y + z * z < j->hole_radius * j->hole_radius)
			return true;
	}
	return false;
}

/* Ranges come in steps; those of a camera are of the depth, which is along its axis. */
static double quantised(const scan_setup *setup, double range, double along)
{
	double step = setup->faults.step, depth = range * along;
	if (!(step > 0.0))
		return range;
	if (!setup->camera)
		return step * round(range / step);
	/* Steps of the inverse depth, as of a disparity. */
	return 1.0 / (step * fmax(1.0, round(1.0 / (depth * step)))) / along;
}

static void scan_one(const job *j, size_t index)
{
	station_scan *s = j->station;
	const scan_faults *f = &j->setup->faults;
	scan_cell *cell = &s->cell[index];
	uint64_t state = cell_state(j, index);
	double own[3], direction[3], mean;
	station_scan_direction(s, j->setup, index / s->rows, index % s->rows, own);
	turn_vector(s->true_axes, own, direction);
	double chance = random_number(&state), noise = random_normal(&state);
	if (!send_beam(j, direction, cell, &mean) || is_in_hole(j, cell->surface))
		return;
	double deviation = f->range_noise + f->noise_growth * cell->range;
	cell->kind =
		fabs(mean - cell->range) > MIXED * deviation + MIXED_LEAST ? CELL_MIXED : CELL_SURFACE;
	if (chance < f->strays) {
		cell->kind = CELL_STRAY;
		mean *= 0.2 + 1.3 * random_number(&state);
		if (random_number(&state) < 0.1)
			mean += 10.0 * j->diagonal * random_number(&state);
	}
	cell->range = fmax(0.01, quantised(j->setup, mean + deviation * noise, own[0]));
}

static void scan_chunk(void *user, size_t first, size_t last, uint32_t worker)
{
	(void)worker;
	for (size_t i = first; i < last; i++)
		scan_one(user, i);
}

static gw_status scan_station(job *j, double step, size_t *count, gw_error *error)
{
	station_scan *s = j->station;
	size_grid(s, j->setup, step);
	size_t cells = s->columns * s->rows;
	free(s->cell);
	s->cell = calloc(cells, sizeof *s->cell);
	if (!s->cell)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu cells", cells);
	gw_parallel_for(0, cells, 64, scan_chunk, j);
	for (size_t i = 0; i < cells; i++)
		*count += s->cell[i].kind != CELL_EMPTY;
	return GW_OK;
}

/* ----------------------------------------------------------------------------- all stations */

/* Scans from all stations with cells `step` apart. */
static gw_status scan_all(job *j, simulated_scan *scan, double step, gw_error *error)
{
	gw_status status = GW_OK;
	scan->count = 0;
	for (size_t i = 0; i < scan->station_count && status == GW_OK; i++) {
		j->station = &scan->station[i];
		j->index = i;
		if (j->setup->poses > 0)
			place_pose(j);
		else
			place_station(j);
		status = scan_station(j, step, &scan->count, error);
	}
	return status;
}

/* Holes are around places that a scanner sees. */
static void choose_holes(job *j, const simulated_scan *scan)
{
	uint64_t state = j->setup->seed + 77;
	size_t wanted = j->setup->faults.holes < HOLES ? j->setup->faults.holes : HOLES;
	for (int attempt = 0; attempt < 100000 && j->hole_count < wanted; attempt++) {
		const station_scan *s =
			&scan->station[(size_t)(random_number(&state) * (double)scan->station_count)];
		size_t cell = (size_t)(random_number(&state) * (double)(s->columns * s->rows));
		if (s->cell[cell].kind != CELL_EMPTY)
			memcpy(j->hole[j->hole_count++], s->cell[cell].surface, sizeof j->hole[0]);
	}
}

/* A coarse scan says how many of the beams come back, and so how many are needed. */
static gw_status make(job *j, simulated_scan *scan, gw_error *error)
{
	const double coarse = j->setup->camera ? 0.02 : 0.05;
	gw_status status = scan_all(j, scan, coarse, error);
	choose_holes(j, scan);
	if (status == GW_OK && j->hole_count > 0)
		status = scan_all(j, scan, coarse, error);
	if (status == GW_OK && scan->count == 0)
		return gw_fail(error, GW_ERROR_DATA, "no beam of any station meets the scene");
	double step = coarse * sqrt((double)scan->count / (double)j->setup->count);
	return status == GW_OK ? scan_all(j, scan, step, error) : status;
}

gw_status simulated_scan_make(const mesh_scene *scene, const scan_setup *setup,
							  simulated_scan *scan, gw_error *error)
{
	reference_tracer *tracer;
	size_t count = setup->poses > 0 ? setup->poses : scene->station_count;
	*scan = (simulated_scan){ .station = calloc(count, sizeof *scan->station) };
	if (!scan->station)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu stations", count);
	scan->station_count = count;
	gw_status status = reference_tracer_create(scene, &tracer, error);
	if (status != GW_OK)
		return status;
	job j = { .scene = scene, .tracer = tracer, .setup = setup };
	for (size_t k = 0; k < 3; k++)
		j.diagonal += pow(scene->high[k] - scene->low[k], 2);
	j.diagonal = sqrt(j.diagonal);
	j.hole_radius = HOLE_SIZE * j.diagonal;
	status = make(&j, scan, error);
	reference_tracer_destroy(&tracer);
	if (status != GW_OK)
		simulated_scan_clear(scan);
	return status;
}

void simulated_scan_clear(simulated_scan *scan)
{
	for (size_t i = 0; i < scan->station_count; i++)
		free(scan->station[i].cell);
	free(scan->station);
	*scan = (simulated_scan){ 0 };
}
