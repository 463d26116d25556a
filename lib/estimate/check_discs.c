/*
 * check_discs.c - see check_discs.h.
 */
#include "estimate/check_discs.h"

#include "light/transport_layout.h"

#include <stdlib.h>
#include <string.h>

/* Radius of the small discs, in that of the surfels, which reach to their 8th neighbours: about as
 * far as points lie apart, so that one in thirty of the rays finds a hole. And of the large ones,
 * which leave none and are not cut. */
#define SMALL 0.6f
#define LARGE 1.5f

/* Discs lie in each other, and which of them a ray meets first is chance. It counts as later the
 * further from the middle of the disc: by this share of a radius at the rim. */
#define MIDDLE 0.25f

#define ALIKE 0.5f        /* cosine between normals of one surface, within its roughness */
#define RISE 0.02f        /* radii above a disc: from there on it may be in the light's way */
#define CUT_OVERLAP 0.02f /* radii of the surfel */

#define STACK 128u /* three wait a level at most, and a level quarters the discs */

typedef gw_check_lanes float_lanes;
typedef int32_t int_lanes __attribute__((vector_size(16)));

/* ------------------------------------------------------------------------------------ opening */

gw_status gw_check_discs_open(const gw_passes *passes, const gw_octree *octree, const gw_surfels *s,
							  gw_check_discs *discs, gw_error *error)
{
	uint64_t bytes = 16 * (uint64_t)s->count;
	gw_check_tree *tree = discs->tree;
	if (discs->count > 0)
		return GW_OK;
	*discs = (gw_check_discs){ .surfels = s,
							   .tree = tree,
							   .count = s->count,
							   .cell = octree->leaf_size,
							   .sheet = s->transparency ? octree->leaf_size : 0.0f };
	gw_status status = gw_view_open(passes->gpu, &octree->surfel_disc, bytes, &discs->size, error);
	if (status == GW_OK)
		status = gw_view_open(passes->gpu, &octree->surfel_clip, bytes, &discs->clip, error);
	if (status == GW_OK)
		status = gw_check_tree_make(s, LARGE, passes->threads, tree, error);
	if (status != GW_OK)
		gw_check_discs_close(discs);
	return status;
}

void gw_check_discs_close(gw_check_discs *discs)
{
	gw_view_close(&discs->size);
	gw_view_close(&discs->clip);
	*discs = (gw_check_discs){ .tree = discs->tree };
}

/* ---------------------------------------------------------------------------------------- rays */

typedef struct walk {
	const gw_check_discs *discs;
	const gw_check_ray *ray;
	float t_small, t_large, nearest_back_face;
	gw_check_hit hit;
	/* What the ray has passed: the sheet of a surfel, GW_NONE for none, and where. */
	uint32_t passed;
	float passed_t, sheet;
} walk;

static gw_vec3 normal_of(const walk *w, size_t surfel)
{
	return gw_xyz(w->discs->surfels->normal + 3 * surfel);
}

static bool is_passed(const walk *w, gw_vec3 normal, float t)
{
	if (w->passed == GW_NONE)
		return false;
	gw_vec3 passed = normal_of(w, w->passed);
	float rise = (t - w->passed_t) * fabsf(gw_dot(passed, w->ray->direction));
	return t <= w->passed_t || (rise < w->sheet && gw_dot(normal, passed) > ALIKE);
}

/* Does a cut leave out what lies so far off a disc's middle? */
static bool is_cut_off(const gw_check_discs *discs, size_t surfel, gw_vec3 at)
{
	const gw_surfels *s = discs->surfels;
	const float *size = (const float *)discs->size.bytes + 4 * surfel,
				*clip = (const float *)discs->clip.bytes + 4 * surfel;
	const float cut[2][3] = { { size[2], size[3], clip[0] }, { clip[1], clip[2], clip[3] } };
	float tangent[3], bitangent[3];
	gw_tangent_frame(s->normal + 3 * surfel, tangent, bitangent);
	for (int c = 0; c < 2; c++) {
		gw_vec3 v =
			gw_plus(gw_times(gw_xyz(tangent), cut[c][0]), gw_times(gw_xyz(bitangent), cut[c][1]));
		if (gw_dot(v, at) > cut[c][2] * discs->cell + CUT_OVERLAP * s->radius[surfel])
			return true;
	}
	return false;
}

static float transparency_of(const gw_check_discs *discs, size_t surfel)
{
	return discs->surfels->transparency ? discs->surfels->transparency[surfel] : 0.0f;
}

static float spacing_of(const gw_check_discs *discs, size_t surfel)
{
	return sqrtf(discs->surfels->area[surfel]);
}

/* Rays that backs stop, and that start within the reach of a disc behind it: does it stick out
 * there over the edge of something, on whose other side they start? */
static bool sticks_out(const walk *w, size_t surfel, gw_vec3 from, float t)
{
	float radius = w->discs->surfels->radius[surfel];
	return w->ray->both_sides && t < w->ray->own && gw_dot(from, from) < radius * radius;
}

/* Of surface that may face either way each side is a disc, at the same place. Is this the one that
 * the ray does not get to, since it shows its back, or is the other side of what the ray leaves?
 *   own   it is of the surface that the ray leaves */
static bool is_other_side(const walk *w, size_t surfel, gw_vec3 normal, bool own)
{
	const gw_surfels *s = w->discs->surfels;
	return s->two_sided[surfel] && gw_surfels_one_sided(s, surfel) &&
		   (gw_dot(normal, w->ray->direction) > 0.0f ||
			(own && gw_dot(normal, w->ray->facing) < 0.0f));
}

static void hit_disc(uint32_t surfel, walk *w)
{
	const gw_check_ray *ray = w->ray;
	const gw_surfels *s = w->discs->surfels;
	if (ray->unless > 0.0f && s->doubt && s->doubt[surfel] >= ray->unless)
		return;
	gw_vec3 normal = normal_of(w, surfel);
	float approach = gw_dot(normal, ray->direction);
	gw_vec3 from = gw_minus(ray->origin, gw_xyz(s->position + 3 * (size_t)surfel));
	float height = gw_dot(normal, from), t = -height / approach;
	if (!(t > 0.0f && t < w->t_small) || is_passed(w, normal, t))
		return;
	gw_vec3 at = gw_plus(from, gw_times(ray->direction, t));
	float small_radius = SMALL * s->radius[surfel], large_radius = LARGE * s->radius[surfel];
	float squared = gw_dot(at, at), small_squared = small_radius * small_radius;
	float transparency = transparency_of(w->discs, surfel);
	bool own = t < ray->own && fabsf(gw_dot(normal, ray->facing)) > ALIKE;
	bool other = transparency > 0.0f && -height >= spacing_of(w->discs, surfel);
	if (squared > large_radius * large_radius || (own && approach > 0.0f && !other) ||
		is_other_side(w, surfel, normal, own))
		return;
	bool small = !(approach > 0.0f && !other && sticks_out(w, surfel, from, t)) &&
				 squared <= (ray->whole ? small_squared / (SMALL * SMALL) : small_squared) &&
				 !is_cut_off(w->discs, surfel, at) &&
				 !(own && ray->both_sides && height < RISE * sqrtf(small_squared));
	if (approach > 0.0f && !ray->both_sides && !s->two_sided[surfel] && !(transparency > 0.0f)) {
		w->nearest_back_face = small ? gw_smaller(w->nearest_back_face, t) : w->nearest_back_face;
		return;
	}
	t += MIDDLE * squared / sqrtf(small_squared);
	if (t < w->t_large) {
		w->t_large = t;
		w->hit.large = surfel;
	}
	if (small && t < w->t_small) {
		w->t_small = t;
		w->hit.small = surfel;
	}
}

static void hit_leaf(uint32_t leaf, walk *w)
{
	size_t first = leaf & 0x0fffffffu, count = (leaf >> 28 & 7u) + 1;
	for (size_t i = first; i < first + count; i++)
		hit_disc(w->discs->tree->surfel[i], w);
}

static float inverse_of(float d)
{
	return 1.0f / (fabsf(d) >= 1e-20f ? d : d >= 0.0f ? 1e-20f : -1e-20f);
}

/* Of each lane of a, where chosen is not 0, or else of b. */
static inline float_lanes pick(int_lanes chosen, float_lanes a, float_lanes b)
{
	return (float_lanes)((chosen & (int_lanes)a) | (~chosen & (int_lanes)b));
}

typedef struct waiting {
	float t;
	uint32_t number;
} waiting;

/* Puts the children that the ray meets before t on the stack, the nearest on top. */
static uint32_t open_node(const gw_check_node *n, const float origin[3], const float inverse[3],
						  float t, waiting *stack, uint32_t top)
{
	float_lanes enter = { 0 }, leave = { t, t, t, t };
	uint32_t first = top;
	for (int k = 0; k < 3; k++) {
		float_lanes a = (n->low[k] - origin[k]) * inverse[k];
		float_lanes b = (n->high[k] - origin[k]) * inverse[k];
		float_lanes near = pick(a < b, a, b), far = pick(a < b, b, a);
		enter = pick(near > enter, near, enter);
		leave = pick(far < leave, far, leave);
	}
	for (int c = 0; c < 4; c++) {
		if (!(enter[c] <= leave[c]) || n->child[c] == GW_NONE)
			continue;
		uint32_t at = top++;
		for (; at > first && stack[at - 1].t < enter[c]; at--)
			stack[at] = stack[at - 1];
		stack[at] = (waiting){ enter[c], n->child[c] };
	}
	return top;
}

/* What the ray meets next. */
static void trace(walk *w)
{
	const gw_check_discs *discs = w->discs;
	const gw_check_ray *ray = w->ray;
	gw_vec3 d = ray->direction;
	const float origin[3] = { ray->origin.x, ray->origin.y, ray->origin.z };
	const float inverse[3] = { inverse_of(d.x), inverse_of(d.y), inverse_of(d.z) };
	waiting stack[STACK];
	uint32_t top = 1;
	w->t_small = w->t_large = w->nearest_back_face = ray->t_max;
	w->hit.small = w->hit.large = GW_NONE;
	stack[0] = (waiting){ 0.0f, discs->tree->nodes > 0
									? 0
									: GW_CHECK_LEAF | (uint32_t)(discs->count - 1) << 28 };
	while (top > 0) {
		waiting next = stack[--top];
		if (next.t > w->t_small)
			continue;
		if (next.number & GW_CHECK_LEAF)
			hit_leaf(next.number, w);
		else
			top =
				open_node(discs->tree->node + next.number, origin, inverse, w->t_small, stack, top);
	}
	w->hit.passed_back_face = w->hit.passed_back_face || w->nearest_back_face < w->t_small;
}

/* Lets the ray through discs of one size; returns how much of its light gets to *surfel. */
static float go_through(walk w, bool large, float until, uint32_t *surfel)
{
	float through = 1.0f;
	for (uint32_t sheet = 0; sheet < GW_SHEETS_MOST; sheet++) {
		*surfel = large ? w.hit.large : w.hit.small;
		if (*surfel == GW_NONE || through * transparency_of(w.discs, *surfel) <= until)
			break;
		through *= transparency_of(w.discs, *surfel);
		w.passed = *surfel;
		w.passed_t = large ? w.t_large : w.t_small;
		w.sheet = gw_larger(w.discs->sheet, GW_SHEET_SPACINGS * spacing_of(w.discs, *surfel));
		trace(&w);
	}
	return through;
}

gw_check_hit gw_check_discs_trace(const gw_check_discs *discs, const gw_check_ray *ray, float until)
{
	walk w = { .discs = discs, .ray = ray, .passed = GW_NONE };
	trace(&w);
	gw_check_hit hit = w.hit;
	hit.through[0] = hit.through[1] = 1.0f;
	if (discs->sheet > 0.0f) {
		hit.through[0] = go_through(w, false, until, &hit.small);
		hit.through[1] = go_through(w, true, until, &hit.large);
	}
	return hit;
}
