/* view_space.c - coarse cells to look for viewpoints in; see view_space.h. */
#include "picture/view_space.h"

#include "base/memory.h"
#include "base/nth_element.h"

#include <math.h>
#include <stdlib.h>

#define CELLS 180000.0      /* about as many, */
#define SIDE 160.0          /* at most so many along the longest side */
#define CELL_SPACINGS 2.5   /* least width of a cell in spacings, so that surfaces have no holes */
#define SAMPLES 100000      /* coordinates that quantiles are found from */
#define TAIL 100            /* one in so many lies beyond each quantile */
#define REACH 0.5           /* beyond the quantiles, in the distance between them */
#define REACH_LEAST 0.25    /* the same in the longest such distance */
#define COMPONENT_CELLS 32  /* cells along the longest side that tell components apart */
#define COMPONENT_LEAST 500 /* one in so many points is no stray component */
#define SCANNERS 64         /* of which the nearest is looked for */

/* ------------------------------------------------------------------------- what counts */

/* Bounds between which all but a few points lie, widened by as much as a tail may reach. */
static gw_status find_middle(view_space *v, gw_error *error)
{
	const gw_surfels *s = v->surfels;
	size_t step = s->count / SAMPLES + 1, count = (s->count + step - 1) / step;
	float *value = gw_allocate_array(count, sizeof *value);
	double longest = 0, low[3], high[3];
	if (!value)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to look for a viewpoint");
	for (size_t k = 0; k < 3; k++) {
		for (size_t i = 0; i < count; i++)
			value[i] = fmaxf(s->position[3 * i * step + k] - s->minimum[k], 0.0f);
		low[k] = (double)s->minimum[k] + (double)gw_nth_element(value, count, count / TAIL);
		high[k] =
			(double)s->minimum[k] + (double)gw_nth_element(value, count, count - 1 - count / TAIL);
		longest = fmax(longest, high[k] - low[k]);
	}
	free(value);
	for (size_t k = 0; k < 3; k++) {
		double reach = fmax(REACH * (high[k] - low[k]), REACH_LEAST * longest);
		v->low[k] = fmax(low[k] - reach, (double)s->minimum[k]);
		v->high[k] = fmin(high[k] + reach, (double)s->maximum[k]);
	}
	return GW_OK;
}

bool gw_view_space_holds(const view_space *v, const float position[3])
{
	for (int k = 0; k < 3; k++)
		if (!((double)position[k] >= v->low[k] && (double)position[k] <= v->high[k]))
			return false;
	return true;
}

/* A grid of counts over the bounds, and what component each of its cells belongs to. */
typedef struct components {
	const view_space *space;
	double width;
	int32_t size[3];
	uint32_t *points; /* of a cell */
	uint32_t *stack;  /* of cells that are still to be looked at */
	uint8_t *kept;    /* 1: seen, 2: of a component that counts */
} components;

static size_t component_cell(const components *p, const float position[3])
{
	size_t at[3];
	for (int k = 0; k < 3; k++)
		at[k] = (size_t)fmin(((double)position[k] - p->space->low[k]) / p->width,
							 (double)(p->size[k] - 1));
	return (at[2] * (size_t)p->size[1] + at[1]) * (size_t)p->size[0] + at[0];
}

/* Adds the cells around one to the stack. */
static size_t add_neighbours(components *p, size_t cell, size_t height)
{
	size_t row = cell / (size_t)p->size[0];
	int32_t at[3] = { (int32_t)(cell % (size_t)p->size[0]), (int32_t)(row % (size_t)p->size[1]),
					  (int32_t)(row / (size_t)p->size[1]) };
	for (int n = 0; n < 27; n++) {
		int32_t to[3] = { at[0] + n % 3 - 1, at[1] + n / 3 % 3 - 1, at[2] + n / 9 - 1 };
		bool inside = true;
		for (int k = 0; k < 3; k++)
			inside = inside && to[k] >= 0 && to[k] < p->size[k];
		size_t next =
			inside ? ((size_t)to[2] * (size_t)p->size[1] + (size_t)to[1]) * (size_t)p->size[0] +
						 (size_t)to[0]
				   : cell;
		if (p->points[next] > 0 && !p->kept[next]) {
			p->kept[next] = 1;
			p->stack[height++] = (uint32_t)next;
		}
	}
	return height;
}

/* Goes over one component; its cells then are the first of the stack, `size` of them. */
static size_t find_component(components *p, size_t first, uint64_t *points)
{
	size_t size = 1;
	p->stack[0] = (uint32_t)first;
	p->kept[first] = 1;
	*points = 0;
	for (size_t i = 0; i < size; i++) {
		*points += p->points[p->stack[i]];
		size = add_neighbours(p, p->stack[i], size);
	}
	return size;
}

static void keep_components(components *p, size_t cells, uint64_t least)
{
	uint64_t points;
	for (size_t i = 0; i < cells; i++) {
		if (p->points[i] == 0 || p->kept[i])
			continue;
		size_t size = find_component(p, i, &points);
		for (size_t c = 0; c < size && points >= least; c++)
			p->kept[p->stack[c]] = 2;
	}
}

/* Narrows the bounds to the components that are no strays. */
static void bound_components(const components *p, view_space *v)
{
	double low[3] = { INFINITY, INFINITY, INFINITY }, high[3] = { -INFINITY, -INFINITY, -INFINITY };
	for (size_t i = 0; i < v->surfels->count; i++) {
		const float *at = v->surfels->position + 3 * i;
		if (!gw_view_space_holds(v, at) || p->kept[component_cell(p, at)] != 2)
			continue;
		for (int k = 0; k < 3; k++) {
			low[k] = fmin(low[k], (double)at[k]);
			high[k] = fmax(high[k], (double)at[k]);
		}
	}
	for (int k = 0; k < 3 && low[0] <= high[0]; k++) {
		v->low[k] = low[k];
		v->high[k] = high[k];
	}
}

static gw_status find_bounds(view_space *v, gw_error *error)
{
	GW_TRY(find_middle(v, error));
	components p = { .space = v };
	double longest = 1e-30;
	size_t cells = 1, held = 0;
	for (int k = 0; k < 3; k++)
		longest = fmax(longest, v->high[k] - v->low[k]);
	p.width = longest / COMPONENT_CELLS;
	for (int k = 0; k < 3; k++) {
		p.size[k] = (int32_t)((v->high[k] - v->low[k]) / p.width) + 1;
		cells *= (size_t)p.size[k];
	}
	p.points = gw_allocate_zeros(cells, sizeof *p.points);
	p.stack = gw_allocate_zeros(cells, sizeof *p.stack);
	p.kept = gw_allocate_zeros(cells, 1);
	bool good = p.points && p.stack && p.kept;
	for (size_t i = 0; i < v->surfels->count && good; i++)
		if (gw_view_space_holds(v, v->surfels->position + 3 * i)) {
			p.points[component_cell(&p, v->surfels->position + 3 * i)]++;
			held++;
		}
	if (good) {
		keep_components(&p, cells, held / COMPONENT_LEAST);
		bound_components(&p, v);
	}
	free(p.points);
	free(p.stack);
	free(p.kept);
	return good ? GW_OK : gw_fail(error, GW_ERROR_MEMORY, "no memory to look for a viewpoint");
}

/* ------------------------------------------------------------------------------- cells */

static double luminance_of(const view_space *v, size_t surfel)
{
	return v->wish->luminance ? fmax((double)v->wish->luminance[surfel], 0.0) : 1.0;
}

static size_t cell_at(const view_space *v, const int32_t at[3])
{
	return ((size_t)at[2] * (size_t)v->size[1] + (size_t)at[1]) * (size_t)v->size[0] +
		   (size_t)at[0];
}

static void add_surfel(view_space *v, size_t i, double *logarithms, double *lit_area)
{
	const gw_surfels *s = v->surfels;
	const float *position = s->position + 3 * i, *normal = s->normal + 3 * i;
	int32_t at[3];
	double height = 0, light = luminance_of(v, i), area = (double)s->area[i];
	for (int k = 0; k < 3; k++) {
		at[k] = (int32_t)(((double)position[k] - v->least[k]) / v->width);
		height += (double)position[k] * v->up[k];
	}
	view_cell *c = v->cell + cell_at(v, at);
	for (int k = 0; k < 3; k++)
		c->normal[k] += s->area[i] * normal[k];
	c->area += s->area[i];
	c->light += (float)(area * light);
	c->height += (float)(area * height);
	v->area += area;
	if (light > 0) {
		*logarithms += area * log(light);
		*lit_area += area;
	}
}

/* Turns the normals of a cell towards the nearest scanner, or the nearest of some of them. */
static void turn_to_scanner(const view_space *v, size_t cell)
{
	const gw_viewpoint_wish *wish = v->wish;
	float *n = v->cell[cell].normal;
	double nearest = INFINITY, facing = 0;
	int32_t at[3];
	gw_view_space_place(v, cell, at);
	for (size_t i = 0; i < wish->scanner_count; i += wish->scanner_count / SCANNERS + 1) {
		double squared = 0, towards = 0;
		for (size_t k = 0; k < 3; k++) {
			double way = wish->scanner[3 * i + k] - v->surfels->origin[k] - v->least[k] -
						 (at[k] + 0.5) * v->width;
			squared += way * way;
			towards += way * (double)n[k];
		}
		if (squared < nearest) {
			nearest = squared;
			facing = towards;
		}
	}
	for (int k = 0; k < 3 && facing < 0; k++)
		n[k] = -n[k];
}

/* Which way the surface looks is what the normals say if they were given, else where the scanner
 * stood. */
static void find_sides(view_space *v)
{
	bool given = 2 * v->surfels->normals_given > v->surfels->count;
	for (size_t i = 0; i < v->count && !given && v->wish->scanner_count; i++)
		if (v->cell[i].area > 0.0f)
			turn_to_scanner(v, i);
	v->sided = given || v->wish->scanner_count > 0;
	v->given = given;
}

gw_status gw_view_space_make(const gw_surfels *s, const gw_viewpoint_wish *wish, view_space *v,
							 gw_error *error)
{
	*v = (view_space){ .surfels = s, .wish = wish, .count = 1 };
	double longest = 0, volume = 1, logarithms = 0, lit_area = 0;
	gw_camera_stand(wish->up, v->side, v->back, v->up);
	GW_TRY(find_bounds(v, error));
	for (int k = 0; k < 3; k++)
		longest = fmax(longest, v->high[k] - v->low[k]);
	for (int k = 0; k < 3; k++)
		volume *= fmax((v->high[k] - v->low[k]) / fmax(longest, 1e-30), 1 / SIDE);
	v->width = fmax(longest / SIDE, longest * cbrt(volume / CELLS));
	v->width = fmax(fmax(v->width, CELL_SPACINGS * (double)s->spacing), 1e-30);
	for (int k = 0; k < 3; k++) {
		v->least[k] = v->low[k] - 0.5 * v->width;
		v->size[k] = (int32_t)((v->high[k] - v->least[k]) / v->width) + 1;
		v->count *= (size_t)v->size[k];
	}
	v->cell = gw_allocate_zeros(v->count, sizeof *v->cell);
	if (!v->cell)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to look for a viewpoint");
	/* Both sides of one piece of surface would cancel. */
	for (size_t i = 0; i < s->count; i++)
		if (gw_view_space_holds(v, s->position + 3 * i) && s->two_sided[i] != GW_SIDE_BACK)
			add_surfel(v, i, &logarithms, &lit_area);
	v->light = lit_area > 0 ? exp(logarithms / lit_area) : 0;
	find_sides(v);
	return GW_OK;
}

void gw_view_space_clear(view_space *v)
{
	free(v->cell);
	*v = (view_space){ .cell = NULL };
}

void gw_view_space_place(const view_space *v, size_t cell, int32_t at[3])
{
	size_t row = cell / (size_t)v->size[0];
	at[0] = (int32_t)(cell % (size_t)v->size[0]);
	at[1] = (int32_t)(row % (size_t)v->size[1]);
	at[2] = (int32_t)(row / (size_t)v->size[1]);
}

/* ------------------------------------------------------------------------------ looking */

static bool is_within(const view_space *v, const int32_t at[3])
{
	bool within = true;
	for (int k = 0; k < 3; k++)
		within = within && at[k] >= 0 && at[k] < v->size[k];
	return within;
}

view_hit gw_view_space_look(const view_space *v, const int32_t from[3], const double ray[3],
							int skipped)
{
	int32_t at[3] = { from[0], from[1], from[2] };
	double next[3];
	for (int k = 0; k < 3; k++)
		next[k] = fabs(ray[k]) > 1e-9 ? 0.5 / fabs(ray[k]) : INFINITY;
	for (int entered = 0;; entered++) {
		int k = next[0] < next[1] ? (next[0] < next[2] ? 0 : 2) : (next[1] < next[2] ? 1 : 2);
		double depth = next[k];
		at[k] += ray[k] > 0 ? 1 : -1;
		next[k] += 1 / fabs(ray[k]);
		if (ray[k] > 0 ? at[k] >= v->size[k] : at[k] < 0)
			return (view_hit){ 0, 0 };
		if (!is_within(v, at))
			continue;
		size_t cell = cell_at(v, at);
		if (entered >= skipped && v->cell[cell].area > 0.0f)
			return (view_hit){ depth, cell };
	}
}

double gw_view_space_facing(const view_space *v, size_t cell, const double d[3])
{
	const view_cell *c = v->cell + cell;
	double cosine =
		((double)c->normal[0] * d[0] + (double)c->normal[1] * d[1] + (double)c->normal[2] * d[2]) /
		(double)c->area;
	return v->sided ? cosine : fabs(cosine);
}

double gw_view_space_lit(const view_space *v, size_t cell)
{
	const view_cell *c = v->cell + cell;
	double light = (double)(c->light / c->area);
	return v->light > 0 ? light / (light + v->light) : 0.5;
}

void gw_view_space_direction(const view_space *v, double azimuth, double elevation, double d[3])
{
	double side = sin(azimuth) * cos(elevation), front = cos(azimuth) * cos(elevation);
	for (int k = 0; k < 3; k++)
		d[k] = side * v->side[k] + front * -v->back[k] + sin(elevation) * v->up[k];
}
