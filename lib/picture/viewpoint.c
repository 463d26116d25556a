/* viewpoint.c - from where to look at a cloud; see glowworm_picture.h. */
#include "glowworm_picture.h"

#include "base/memory.h"

#include <math.h>
#include <stdlib.h>

#define ENCLOSES 0.1      /* least enclosure of a surface that is looked at from inside */
#define CELLS 56.0        /* along the longest side of the bounds */
#define CELL_SPACINGS 2.5 /* least width of a cell in spacings, so that surfaces have no holes */
#define RAYS 192          /* from a free cell */
#define CANDIDATES 4000   /* free cells that are tried */
#define LEAST_DEPTH 1.5   /* cells, free around a viewpoint */
#define LEAST_HITS 0.7    /* share of rays that have to meet something */
#define CLOSED 0.97       /* the same, of a place from which there is no way out */
#define CLOSED_PLACES 0.5 /* share of closed ones among all places, of a cave or room */
#define LEAST_FRONT 0.9   /* share of those that have to meet a front */
#define DARK 0.15         /* what an unlit surface in view is worth */
#define AZIMUTHS 16
#define MARGIN 1.05    /* of a picture that holds all */
#define ELEVATION 25.0 /* degrees, of an outside view */

/* A coarse cell of space: sums over the surfels in it. */
typedef struct cell {
	float normal[3]; /* area * normal */
	float light;     /* area * luminance */
	float area;
} cell;

typedef struct grid {
	const gw_surfels *surfels;
	cell *cell;
	int32_t size[3];
	double width;          /* of a cell, metres */
	double least[3];       /* corner of cell 0, local frame */
	size_t places, closed; /* cells from which the view is good, and of them the closed ones */
	double light;          /* geometric mean of the luminance, so that lamps do not decide it */
	double (*ray)[3];      /* RAYS directions */
	double (*view)[3];     /* view directions that are tried */
	int views;
} grid;

/* What one ray met. */
typedef struct sight {
	double depth; /* cells; 0: nothing */
	double value; /* of seeing it; negative from behind */
} sight;

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double luminance_of(const float *luminance, size_t i)
{
	return luminance ? fmax((double)luminance[i], 0.0) : 1.0;
}

/* ----------------------------------------------------------------------------- enclosure */

double gw_viewpoint_enclosure(const gw_surfels *s)
{
	double centre[3] = { 0, 0, 0 }, area = 0, sum = 0, magnitude = 0;
	for (size_t i = 0; i < s->count; i++) {
		double a = s->two_sided[i] ? 0.0 : (double)s->area[i];
		for (size_t k = 0; k < 3; k++)
			centre[k] += a * (double)s->position[3 * i + k];
		area += a;
	}
	for (size_t i = 0; i < s->count && area > 0.0; i++) {
		double term = 0;
		for (size_t k = 0; k < 3; k++)
			term +=
				((double)s->position[3 * i + k] - centre[k] / area) * (double)s->normal[3 * i + k];
		term *= s->two_sided[i] ? 0.0 : (double)s->area[i];
		sum -= term;
		magnitude += fabs(term);
	}
	return magnitude > 0.0 ? sum / magnitude : 0.0;
}

/* ------------------------------------------------------------------------------- outside */

/* A direction by azimuth and elevation, radians; azimuth 0 looks from the front. */
static void direction_of(char up, double azimuth, double elevation, double d[3])
{
	double side = sin(azimuth) * cos(elevation), front = cos(azimuth) * cos(elevation);
	d[0] = side;
	d[1] = up == 'y' ? sin(elevation) : -front;
	d[2] = up == 'y' ? front : sin(elevation);
}

/* Light that goes out towards a far camera. */
static double seen_from(const gw_surfels *s, const float *luminance, const double d[3])
{
	double sum = 0;
	for (size_t i = 0; i < s->count; i++) {
		const float *n = s->normal + 3 * i;
		double cosine = (double)n[0] * d[0] + (double)n[1] * d[1] + (double)n[2] * d[2];
		cosine = s->two_sided[i] ? fabs(cosine) : fmax(cosine, 0.0);
		sum += cosine * (double)s->area[i] * luminance_of(luminance, i);
	}
	return sum;
}

/*
 * Where a camera has to stand to see all, as near as it can. In the camera's frame around the
 * middle of the bounds, a point (x, y, z) is in the picture of a camera at (s, ., -d) when |x - s|
 * <= t (d + z). Over all points that is d >= a - s / t and d >= b + s / t with the largest a = x /
 * t - z and b = -x / t - z, so d = (a + b) / 2 and s = t (a - b) / 2; y likewise.
 */
static void fit_picture(const gw_surfels *s, const gw_camera *camera, const double middle[3],
						double aspect, double *distance, double shift[2])
{
	double tangent[2] = { camera->tangent * aspect / MARGIN, camera->tangent / MARGIN };
	double a[2] = { -INFINITY, -INFINITY }, b[2] = { -INFINITY, -INFINITY };
	for (size_t i = 0; i < s->count; i++) {
		double world[3], view[3], radius = (double)s->radius[i];
		for (size_t k = 0; k < 3; k++)
			world[k] = (double)s->position[3 * i + k] - middle[k];
		gw_camera_turn(camera, world, view);
		for (int k = 0; k < 2; k++) {
			a[k] = fmax(a[k], (radius + view[k]) / tangent[k] - view[2]);
			b[k] = fmax(b[k], (radius - view[k]) / tangent[k] - view[2]);
		}
	}
	*distance = fmax(a[0] + b[0], a[1] + b[1]) / 2;
	for (int k = 0; k < 2; k++)
		shift[k] = tangent[k] * (a[k] - b[k]) / 2;
}

static gw_status find_outside(const gw_surfels *s, const gw_viewpoint_wish *wish, gw_viewpoint *v,
							  gw_error *error)
{
	double best[3] = { 0, 0, 1 }, most = -1, middle[3],
		   upright[3] = { 0, wish->up == 'y', wish->up != 'y' };
	for (int a = 0; a < 8; a++) {
		double d[3];
		/* Starting at the front right, where equal views are drawn from. */
		direction_of(wish->up, M_PI / 4 * (double)a + M_PI / 8, ELEVATION * M_PI / 180, d);
		double seen = seen_from(s, wish->luminance, d);
		if (seen > most * (1 + 1e-3)) {
			most = seen;
			for (int k = 0; k < 3; k++)
				best[k] = d[k];
		}
	}
	gw_camera camera;
	const double nowhere[3] = { 0, 0, 0 };
	double backwards[3] = { -best[0], -best[1], -best[2] };
	v->angle = wish->angle > 0 ? wish->angle : GW_VIEWPOINT_ANGLE_OUTSIDE;
	GW_TRY(gw_camera_look(&camera, nowhere, backwards, upright, v->angle, error));
	for (int k = 0; k < 3; k++)
		middle[k] = 0.5 * ((double)s->minimum[k] + (double)s->maximum[k]);
	double distance, shift[2];
	fit_picture(s, &camera, middle, wish->aspect, &distance, shift);
	for (int k = 0; k < 3; k++) {
		v->to[k] = s->origin[k] + middle[k] + shift[0] * camera.right[k] + shift[1] * camera.up[k];
		v->at[k] = v->to[k] + distance * best[k];
	}
	v->inside = false;
	return GW_OK;
}

/* -------------------------------------------------------------------------------- inside */

static size_t cell_index(const grid *g, const int32_t at[3])
{
	return ((size_t)at[2] * (size_t)g->size[1] + (size_t)at[1]) * (size_t)g->size[0] +
		   (size_t)at[0];
}

static gw_status make_grid(grid *g, const float *luminance, gw_error *error)
{
	const gw_surfels *s = g->surfels;
	double longest = 0, logarithms = 0, area = 0;
	for (int k = 0; k < 3; k++)
		longest = fmax(longest, (double)s->maximum[k] - (double)s->minimum[k]);
	g->width = fmax(fmax(longest / CELLS, CELL_SPACINGS * (double)s->spacing), 1e-30);
	size_t cells = 1;
	for (int k = 0; k < 3; k++) {
		g->least[k] = (double)s->minimum[k] - 0.5 * g->width;
		g->size[k] = (int32_t)(((double)s->maximum[k] - g->least[k]) / g->width) + 1;
		cells *= (size_t)g->size[k];
	}
	g->cell = gw_allocate_zeros(cells, sizeof *g->cell);
	if (!g->cell)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to look for a viewpoint");
	for (size_t i = 0; i < s->count; i++) {
		int32_t at[3];
		for (size_t k = 0; k < 3; k++)
			at[k] = (int32_t)(((double)s->position[3 * i + k] - g->least[k]) / g->width);
		cell *c = g->cell + cell_index(g, at);
		for (size_t k = 0; k < 3; k++)
			c->normal[k] += s->area[i] * s->normal[3 * i + k];
		c->area += s->area[i];
		c->light += s->area[i] * (float)luminance_of(luminance, i);
		if (luminance_of(luminance, i) > 0) {
			logarithms += (double)s->area[i] * log(luminance_of(luminance, i));
			area += (double)s->area[i];
		}
	}
	g->light = area > 0 ? exp(logarithms / area) : 0;
	return GW_OK;
}

/* Directions spread evenly over the sphere, on a spiral with the golden angle. */
static void make_rays(double (*ray)[3])
{
	for (int i = 0; i < RAYS; i++) {
		double z = 1 - (2 * i + 1) / (double)RAYS, r = sqrt(1 - z * z);
		double turn = M_PI * (3 - sqrt(5)) * i;
		ray[i][0] = r * cos(turn);
		ray[i][1] = r * sin(turn);
		ray[i][2] = z;
	}
}

/* Follows a ray from the middle of a cell to the first one that is not free. */
static sight look_along(const grid *g, const int32_t from[3], const double ray[3])
{
	int32_t at[3] = { from[0], from[1], from[2] };
	double next[3];
	for (int k = 0; k < 3; k++)
		next[k] = fabs(ray[k]) > 1e-9 ? 0.5 / fabs(ray[k]) : INFINITY;
	for (;;) {
		int k = next[0] < next[1] ? (next[0] < next[2] ? 0 : 2) : (next[1] < next[2] ? 1 : 2);
		double depth = next[k];
		at[k] += ray[k] > 0 ? 1 : -1;
		next[k] += 1 / fabs(ray[k]);
		if (at[k] < 0 || at[k] >= g->size[k])
			return (sight){ 0, 0 };
		const cell *c = g->cell + cell_index(g, at);
		if (!(c->area > 0.0f))
			continue;
		double facing = -((double)c->normal[0] * ray[0] + (double)c->normal[1] * ray[1] +
						  (double)c->normal[2] * ray[2]);
		double light = (double)(c->light / c->area), lit = light / (light + g->light);
		double value = log1p(depth) * (DARK + (g->light > 0 ? lit : 0.5));
		return (sight){ depth, facing > 0 ? value : -value };
	}
}

/* Looks around; false when the cell is not within the enclosed space. */
static bool look_around(grid *g, const int32_t at[3], sight *seen)
{
	int hits = 0, fronts = 0;
	for (int r = 0; r < RAYS; r++) {
		seen[r] = look_along(g, at, g->ray[r]);
		if (seen[r].depth > 0 && seen[r].depth < LEAST_DEPTH)
			return false;
		hits += seen[r].depth > 0;
		fronts += seen[r].value > 0;
	}
	if (hits < LEAST_HITS * RAYS || fronts < LEAST_FRONT * hits)
		return false;
	g->places++;
	g->closed += hits >= CLOSED * RAYS;
	return true;
}

/* Mean value of what is in a view, and how far its surfaces are, in cells. */
static double value_view(const grid *g, const sight *seen, const double view[3], double cosine,
						 double *depth)
{
	double value = 0, inside = 0;
	*depth = 0;
	for (int r = 0; r < RAYS; r++) {
		if (dot(g->ray[r], view) < cosine)
			continue;
		value += seen[r].value;
		*depth += seen[r].depth;
		inside++;
	}
	*depth /= fmax(inside, 1);
	return value / fmax(inside, 1);
}

static void find_inside(grid *g, double cosine, gw_viewpoint *v)
{
	size_t cells = (size_t)g->size[0] * (size_t)g->size[1] * (size_t)g->size[2], empty = 0;
	sight seen[RAYS];
	double best = 0;
	for (size_t i = 0; i < cells; i++)
		empty += !(g->cell[i].area > 0.0f);
	size_t every = empty / CANDIDATES + 1, counter = 0;
	for (size_t i = 0; i < cells; i++) {
		if (g->cell[i].area > 0.0f || counter++ % every != 0)
			continue;
		size_t row = i / (size_t)g->size[0];
		int32_t at[3] = { (int32_t)(i % (size_t)g->size[0]), (int32_t)(row % (size_t)g->size[1]),
						  (int32_t)(row / (size_t)g->size[1]) };
		if (!look_around(g, at, seen))
			continue;
		for (int d = 0; d < g->views; d++) {
			double depth, value = value_view(g, seen, g->view[d], cosine, &depth);
			if (!(value > best))
				continue;
			best = value;
			for (int k = 0; k < 3; k++) {
				v->at[k] = g->surfels->origin[k] + g->least[k] + (at[k] + 0.5) * g->width;
				v->to[k] = v->at[k] + depth * g->width * g->view[d][k];
			}
		}
	}
	v->inside = best > 0;
}

/* With `closed`, only within a space that is closed on all sides, but for a few places. */
static gw_status try_inside(const gw_surfels *s, const gw_viewpoint_wish *wish, gw_viewpoint *v,
							gw_error *error)
{
	double ray[RAYS][3], view[3 * AZIMUTHS][3];
	grid g = { .surfels = s, .ray = ray, .view = view };
	GW_TRY(make_grid(&g, wish->luminance, error));
	make_rays(ray);
	for (int a = 0; a < AZIMUTHS; a++)
		for (int e = -1; e <= 1; e++)
			direction_of(wish->up, 2 * M_PI * a / AZIMUTHS, e * M_PI / 12, view[g.views++]);
	v->angle = wish->angle > 0 ? wish->angle : GW_VIEWPOINT_ANGLE_INSIDE;
	/* A cone as wide as the mean of the picture's two angles. */
	double tangent = tan(v->angle * M_PI / 360);
	double cosine = cos(0.5 * (atan(tangent) + atan(tangent * wish->aspect)));
	find_inside(&g, cosine, v);
	if (wish->kind == GW_VIEWPOINT_AUTO && (double)g.closed < CLOSED_PLACES * (double)g.places)
		v->inside = false;
	free(g.cell);
	return GW_OK;
}

gw_status gw_viewpoint_find(const gw_surfels *surfels, const gw_viewpoint_wish *wish,
							gw_viewpoint *viewpoint, gw_error *error)
{
	*viewpoint = (gw_viewpoint){ .inside = false };
	bool inside = wish->kind == GW_VIEWPOINT_INSIDE ||
				  (wish->kind == GW_VIEWPOINT_AUTO && gw_viewpoint_enclosure(surfels) > ENCLOSES);
	if (inside) {
		gw_status status = try_inside(surfels, wish, viewpoint, error);
		if (status != GW_OK || viewpoint->inside)
			return status;
	}
	return find_outside(surfels, wish, viewpoint, error);
}
