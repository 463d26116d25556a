/* normal_orientation.c - see normal_orientation.h. */
#include "surfels/normal_orientation.h"

#include "base/memory.h"
#include "base/nth_element.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Agreement of two normals as it is stored, and from which on a pair is smooth surface. Pairs are
 * taken in steps, the surest first. */
#define AGREED 127
#define SMOOTH 102
#define SMOOTH_STEP 8

/* Least share of the agreement across a border that has to point one way. */
#define BORDER_LEAST 0.5

/* Evidence counts where at least this share of it points one way: of lamps, sky and ground, which
 * two floors of a house may see differently, and of the space that is enclosed. */
#define CLEAR 0.3
#define CLEAR_SPACE 0.15
/* Of surface that lies across a direction as a whole, least area projected to it. */
#define SLOPING 0.3
/* Or where the fronts fill at least this solid angle around a lamp. */
#define CLEAR_ANGLE 1.0
#define AREA_MOST 16.0f
/* Emitting points that stand for all. */
#define EMITTERS 16
/* Part of the scene's diagonal from which on a closed component is a room, not a body within one.
 */
#define ROOM_LEAST 0.5

/* A pair of components and what their pairs of points say: > 0 for the same sign. */
typedef struct border {
	uint32_t a, b; /* a < b */
	float says;    /* sum of agreements */
	float weight;  /* sum of their sizes */
} border;

/* What is known of a component, for its sign as it is. */
typedef struct component {
	double given;           /* normals */
	double lamp, lamp_size; /* steradians */
	double up, up_size;     /* square metres */
	double sun, sun_size;
	double inwards, inwards_size; /* cubic metres, three times */
	double middle, middle_size;
	double low[3], high[3], centre[3], area;
	int sign; /* chosen */
	bool doubtful;
} component;

typedef struct orientation_work {
	const gw_surfels_options *options;
	gw_surfels *surfels;
	uint32_t *near;         /* GW_NEIGHBOURS * count; the surfel itself where there is none */
	int8_t *agreement;      /* GW_NEIGHBOURS * count, in 1 / AGREED */
	float *area;            /* count, m^2, rough */
	uint32_t *parent;       /* count: of the trees of components */
	uint8_t *opposite;      /* count: sign against that of the parent */
	uint32_t *component_of; /* count: number among the components */
	border *borders;
	size_t border_count;
	component *components;
	size_t component_count;
	double (*lamp)[3]; /* lamp_count, local */
	size_t lamp_count;
	double to_sun[3]; /* 0, 0, 0 when there is none */
	double middle[3];
} orientation_work;

/* ------------------------------------------------------------------------------------ agreement */

/*
 * Whether two normals show the same side, in [-1, 1]: one of them reflected as the surface turns
 * from one place to the other, against the other. Surface that lies across the normals rather than
 * along says nothing: it may be another sheet, or noise.
 */
static float agree(const float *p, const float *n, const float *q, const float *m)
{
	float d[3], length = 0, a = 0, b = 0, cosine = 0;
	for (int k = 0; k < 3; k++) {
		d[k] = q[k] - p[k];
		length += d[k] * d[k];
		a += n[k] * d[k];
		b += m[k] * d[k];
		cosine += n[k] * m[k];
	}
	if (!(length > 0))
		return 0;
	float across = fmaxf(a * a, b * b) / length;
	return (cosine - 2 * a * b / length) * fmaxf(1 - across, 0);
}

static void find_pairs(void *user, size_t surfel, const gw_neighbour_list *list)
{
	orientation_work *w = user;
	const float *position = w->surfels->position, *normal = w->surfels->normal;
	for (uint32_t j = 0; j < GW_NEIGHBOURS; j++) {
		size_t other = j < list->count ? list->index[j] : surfel, at = GW_NEIGHBOURS * surfel + j;
		float both = agree(position + 3 * surfel, normal + 3 * surfel, position + 3 * other,
						   normal + 3 * other);
		w->near[at] = (uint32_t)other;
		w->agreement[at] = (int8_t)lrintf(AGREED * fminf(fmaxf(both, -1), 1));
	}
	/* The circle to the last neighbour holds them all, if they lie on one surface. */
	float reach = list->count ? list->distance[list->count - 1] : 0;
	w->area[surfel] = 3.14159265f * reach * reach / (float)(list->count + 1);
}

/* ---------------------------------------------------------------------------------------
 * components */

/* The root of a surfel's tree; its sign against the root's goes to *opposite. Paths get short. */
static uint32_t find_root(orientation_work *w, uint32_t surfel, uint8_t *opposite)
{
	uint32_t root = surfel;
	uint8_t sign = 0;
	for (; w->parent[root] != root; root = w->parent[root])
		sign ^= w->opposite[root];
	*opposite = sign;
	while (w->parent[surfel] != root && surfel != root) {
		uint32_t next = w->parent[surfel];
		uint8_t own = w->opposite[surfel];
		w->parent[surfel] = root;
		w->opposite[surfel] = sign;
		sign ^= own;
		surfel = next;
	}
	return root;
}

/* Joins the trees of two surfels, whose signs are opposite or not. */
static void join(orientation_work *w, uint32_t a, uint32_t b, bool opposite)
{
	uint8_t of_a, of_b;
	uint32_t root_a = find_root(w, a, &of_a), root_b = find_root(w, b, &of_b);
	if (root_a == root_b)
		return;
	uint32_t low = root_a < root_b ? root_a : root_b, high = root_a < root_b ? root_b : root_a;
	w->parent[high] = low;
	w->opposite[high] = of_a ^ of_b ^ (uint8_t)opposite;
}

static void join_smooth(orientation_work *w)
{
	size_t pairs = GW_NEIGHBOURS * w->surfels->count;
	for (int least = AGREED - SMOOTH_STEP; least >= SMOOTH; least -= SMOOTH_STEP)
		for (size_t i = 0; i < pairs; i++)
			if (abs(w->agreement[i]) >= least && abs(w->agreement[i]) < least + SMOOTH_STEP + 1)
				join(w, (uint32_t)(i / GW_NEIGHBOURS), w->near[i], w->agreement[i] < 0);
}

static int by_components(const void *left, const void *right)
{
	const border *a = left, *b = right;
	return a->a != b->a ? (a->a < b->a ? -1 : 1) : a->b != b->b ? (a->b < b->b ? -1 : 1) : 0;
}

/* Sums the borders of the same two components; the sums are of whole numbers, so order is nothing.
 */
static void merge_borders(orientation_work *w)
{
	size_t kept = 0;
	qsort(w->borders, w->border_count, sizeof *w->borders, by_components);
	for (size_t i = 0; i < w->border_count; i++) {
		border s = w->borders[i];
		if (kept > 0 && by_components(w->borders + kept - 1, &s) == 0) {
			w->borders[kept - 1].says += s.says;
			w->borders[kept - 1].weight += s.weight;
		} else {
			w->borders[kept++] = s;
		}
	}
	w->border_count = kept;
}

/* A border between the components of two surfels, false within one component. */
static bool make_border(orientation_work *w, uint32_t i, uint32_t j, float says, float weight,
						border *out)
{
	uint8_t of_i, of_j;
	uint32_t a = find_root(w, i, &of_i), b = find_root(w, j, &of_j);
	*out = (border){ a < b ? a : b, a < b ? b : a, of_i ^ of_j ? -says : says, weight };
	return a != b;
}

static gw_status collect_borders(orientation_work *w, gw_error *error)
{
	size_t pairs = GW_NEIGHBOURS * w->surfels->count, count = 0;
	border found;
	for (int pass = 0; pass < 2; pass++) {
		count = 0;
		for (size_t i = 0; i < pairs; i++) {
			float says = w->agreement[i];
			if (says == 0 || !make_border(w, (uint32_t)(i / GW_NEIGHBOURS), w->near[i], says,
										  fabsf(says), &found))
				continue;
			if (pass)
				w->borders[count] = found;
			count++;
		}
		if (!pass && !(w->borders = gw_allocate_array(count, sizeof *w->borders)))
			return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu pairs of points", count);
	}
	w->border_count = count;
	merge_borders(w);
	return GW_OK;
}

/* Joins every component with the neighbour about which its border says most. Returns whether any
 * was. */
static bool join_best(orientation_work *w, uint32_t *best)
{
	size_t joined = 0;
	for (size_t i = 0; i < w->surfels->count; i++)
		best[i] = UINT32_MAX;
	for (uint32_t i = 0; i < w->border_count; i++) {
		const border *s = w->borders + i;
		if (fabsf(s->says) < BORDER_LEAST * s->weight)
			continue;
		for (int side = 0; side < 2; side++) {
			uint32_t *b = best + (side ? s->b : s->a);
			if (*b == UINT32_MAX || fabsf(s->says) > fabsf(w->borders[*b].says))
				*b = i;
		}
	}
	for (size_t i = 0; i < w->surfels->count; i++) {
		if (best[i] == UINT32_MAX)
			continue;
		const border *s = w->borders + best[i];
		join(w, s->a, s->b, s->says < 0);
		joined++;
	}
	size_t kept = 0;
	for (size_t i = 0; i < w->border_count; i++) {
		border s = w->borders[i];
		kept += make_border(w, s.a, s.b, s.says, s.weight, w->borders + kept);
	}
	w->border_count = kept;
	merge_borders(w);
	return joined > 0;
}

static gw_status join_components(orientation_work *w, gw_error *error)
{
	size_t count = w->surfels->count;
	join_smooth(w);
	gw_status status = collect_borders(w, error);
	uint32_t *best = gw_allocate_array(count, sizeof *best);
	if (status == GW_OK && !best)
		status = gw_fail(error, GW_ERROR_MEMORY, "no memory for the borders of %zu points", count);
	while (status == GW_OK && join_best(w, best))
		;
	free(best);
	return status;
}

/* ------------------------------------------------------------------------------------- evidence */

static bool has_power(const float value[3])
{
	return value[0] > 0 || value[1] > 0 || value[2] > 0;
}

/* Lamps, and of points that emit some, evenly taken along the order of the surfels. */
static gw_status find_lamps(orientation_work *w, gw_error *error)
{
	const gw_surfels *s = w->surfels;
	const gw_surfels_options *o = w->options;
	size_t emitting = 0, passed = 0;
	for (size_t i = 0; s->emission && i < s->count; i++)
		emitting += has_power(s->emission + 3 * i);
	w->lamp = gw_allocate_array(o->light_count + EMITTERS + 1, sizeof *w->lamp);
	if (!w->lamp)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu lamps", o->light_count);
	for (size_t i = 0; i < o->light_count; i++) {
		const gw_light *l = o->lights + i;
		if ((l->type != GW_LIGHT_POINT && l->type != GW_LIGHT_SPOT) || !has_power(l->intensity))
			continue;
		for (size_t k = 0; k < 3; k++)
			w->lamp[w->lamp_count][k] = l->position[k] - s->origin[k];
		w->lamp_count++;
	}
	for (size_t i = 0; emitting > 0 && i < s->count; i++) {
		if (!has_power(s->emission + 3 * i))
			continue;
		if (passed * EMITTERS / emitting != (passed + 1) * EMITTERS / emitting) {
			for (size_t k = 0; k < 3; k++)
				w->lamp[w->lamp_count][k] = (double)s->position[3 * i + k];
			w->lamp_count++;
		}
		passed++;
	}
	return GW_OK;
}

static void find_sun(orientation_work *w)
{
	for (size_t i = 0; i < w->options->light_count; i++) {
		const gw_light *l = w->options->lights + i;
		if (l->type != GW_LIGHT_SUN || !has_power(l->irradiance))
			continue;
		double length = hypot(hypot(l->direction[0], l->direction[1]), l->direction[2]);
		for (size_t k = 0; k < 3; k++)
			w->to_sun[k] = -l->direction[k] / length;
		return;
	}
}

static void add_evidence(double *sum, double *size, double value)
{
	*sum += value;
	*size += fabs(value);
}

/* The solid angle under which lamps see a surfel, negative from behind. */
static void add_lamps(const orientation_work *w, const double p[3], const double n[3], double area,
					  component *to)
{
	for (size_t l = 0; l < w->lamp_count; l++) {
		double squared = 0, facing = 0;
		for (int k = 0; k < 3; k++) {
			double d = w->lamp[l][k] - p[k];
			squared += d * d;
			facing += d * n[k];
		}
		if (squared > 4 * area)
			add_evidence(&to->lamp, &to->lamp_size, area * facing / (squared * sqrt(squared)));
	}
}

static void add_surfel(const orientation_work *w, size_t surfel, double sign, bool given,
					   component *to)
{
	const gw_surfels *s = w->surfels;
	double p[3], n[3], sun = 0, inwards = 0, middle = 0, far = 0;
	double area = (double)w->area[surfel];
	for (size_t k = 0; k < 3; k++) {
		p[k] = (double)s->position[3 * surfel + k];
		n[k] = sign * (double)s->normal[3 * surfel + k];
		sun += n[k] * w->to_sun[k];
		inwards += n[k] * (to->centre[k] - p[k]);
		middle += n[k] * (w->middle[k] - p[k]);
		far += (w->middle[k] - p[k]) * (w->middle[k] - p[k]);
	}
	to->given += given ? sign : 0;
	add_lamps(w, p, n, area, to);
	add_evidence(&to->up, &to->up_size, area * n[2]);
	add_evidence(&to->sun, &to->sun_size, area * sun);
	add_evidence(&to->inwards, &to->inwards_size, area * inwards);
	add_evidence(&to->middle, &to->middle_size, far > 0 ? area * middle / sqrt(far) : 0);
}

/* A point far from all others stands for no more than this many times what most do. */
static void limit_areas(orientation_work *w)
{
	size_t count = w->surfels->count;
	float most = AREA_MOST * gw_nth_element(w->area, count, count / 2);
	for (size_t i = 0; i < count; i++)
		w->area[i] = fminf(w->area[i], most);
}

/* Numbers the components; their bounds and centres. */
static gw_status measure_components(orientation_work *w, gw_error *error)
{
	const gw_surfels *s = w->surfels;
	uint8_t opposite;
	for (uint32_t i = 0; i < s->count; i++)
		if (find_root(w, i, &opposite) == i)
			w->component_of[i] = (uint32_t)w->component_count++;
	w->components = gw_allocate_zeros(w->component_count, sizeof *w->components);
	if (!w->components)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu components", w->component_count);
	for (uint32_t i = 0; i < s->count; i++) {
		uint32_t root = find_root(w, i, &opposite);
		component *to = w->components + (w->component_of[i] = w->component_of[root]);
		for (size_t k = 0; k < 3; k++) {
			double x = (double)s->position[3 * (size_t)i + k];
			to->low[k] = to->area > 0 ? fmin(to->low[k], x) : x;
			to->high[k] = to->area > 0 ? fmax(to->high[k], x) : x;
			to->centre[k] += (double)w->area[i] * x;
		}
		to->area += (double)w->area[i];
	}
	for (size_t i = 0; i < w->component_count; i++)
		for (size_t k = 0; k < 3; k++)
			w->components[i].centre[k] /= w->components[i].area > 0 ? w->components[i].area : 1;
	return GW_OK;
}

/* ------------------------------------------------------------------------------------- decision */

static double diagonal(const double low[3], const double high[3])
{
	return hypot(hypot(high[0] - low[0], high[1] - low[1]), high[2] - low[2]);
}

static bool is_clear(double sum, double size)
{
	return fabs(sum) > CLEAR * size;
}

static bool is_clear_space(double sum, double size)
{
	return fabs(sum) > CLEAR_SPACE * size;
}

static void decide(const orientation_work *w, double scene, component *p)
{
	double says = p->middle;
	if (p->given != 0)
		says = p->given;
	else if (fabs(p->lamp) > CLEAR_ANGLE || (w->lamp_count && is_clear(p->lamp, p->lamp_size)))
		says = p->lamp;
	else if (!w->lamp_count && is_clear(p->up, fmax(p->up_size, SLOPING * p->area)))
		says = p->up;
	else if (!w->lamp_count && is_clear(p->sun, fmax(p->sun_size, SLOPING * p->area)))
		says = p->sun;
	else if (is_clear_space(p->inwards, p->inwards_size))
		says = diagonal(p->low, p->high) > ROOM_LEAST * scene ? p->inwards : -p->inwards;
	else
		p->doubtful = !is_clear_space(p->middle, p->middle_size);
	p->sign = says < 0 ? -1 : 1;
}

static gw_status decide_components(orientation_work *w, const uint8_t *estimated, gw_error *error)
{
	const gw_surfels *s = w->surfels;
	double low[3], high[3];
	uint8_t opposite;
	for (size_t k = 0; k < 3; k++) {
		low[k] = (double)s->minimum[k];
		high[k] = (double)s->maximum[k];
		w->middle[k] = 0.5 * (low[k] + high[k]);
	}
	find_sun(w);
	limit_areas(w);
	GW_TRY(find_lamps(w, error));
	GW_TRY(measure_components(w, error));
	for (uint32_t i = 0; i < s->count; i++) {
		find_root(w, i, &opposite);
		add_surfel(w, i, opposite ? -1 : 1, !estimated[i], w->components + w->component_of[i]);
	}
	for (size_t i = 0; i < w->component_count; i++)
		decide(w, diagonal(low, high), w->components + i);
	return GW_OK;
}

static void turn_normals(orientation_work *w, const uint8_t *estimated, uint8_t *doubtful)
{
	gw_surfels *s = w->surfels;
	uint8_t opposite;
	for (uint32_t i = 0; i < s->count; i++) {
		const component *p = w->components + w->component_of[i];
		find_root(w, i, &opposite);
		doubtful[i] = estimated[i] && p->doubtful;
		for (size_t k = 0; estimated[i] && opposite != (p->sign < 0) && k < 3; k++)
			s->normal[3 * (size_t)i + k] = -s->normal[3 * (size_t)i + k];
	}
}

/* -------------------------------------------------------------------------------------- all of it
 */

static gw_status allocate(orientation_work *w, gw_error *error)
{
	size_t count = w->surfels->count;
	w->near = gw_allocate_array(count, GW_NEIGHBOURS * sizeof *w->near);
	w->agreement = gw_allocate_array(count, GW_NEIGHBOURS * sizeof *w->agreement);
	w->area = gw_allocate_array(count, sizeof *w->area);
	w->parent = gw_allocate_array(count, sizeof *w->parent);
	w->opposite = gw_allocate_zeros(count, sizeof *w->opposite);
	w->component_of = gw_allocate_array(count, sizeof *w->component_of);
	if (!w->near || !w->agreement || !w->area || !w->parent || !w->opposite || !w->component_of)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to orient %zu normals", count);
	for (uint32_t i = 0; i < count; i++)
		w->parent[i] = i;
	return GW_OK;
}

static void release(orientation_work *w)
{
	free(w->near);
	free(w->agreement);
	free(w->area);
	free(w->parent);
	free(w->opposite);
	free(w->component_of);
	free(w->borders);
	free(w->components);
	free(w->lamp);
}

gw_status gw_orient_normals(const gw_surfels_options *options, gw_neighbours *search,
							gw_surfels *surfels, const uint8_t *estimated, uint8_t *doubtful,
							gw_error *error)
{
	orientation_work w = { .options = options, .surfels = surfels };
	gw_status status = allocate(&w, error);
	if (status == GW_OK)
		status = gw_neighbours_visit(search, find_pairs, &w, error);
	if (status == GW_OK)
		status = join_components(&w, error);
	if (status == GW_OK)
		status = decide_components(&w, estimated, error);
	if (status == GW_OK)
		turn_normals(&w, estimated, doubtful);
	release(&w);
	return status;
}
