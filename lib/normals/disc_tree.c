/*
 * disc_tree.c - see disc_tree.h; rays are in disc_tree.glsl, and in shader_functions.cpp for C.
 */
#include "normals/disc_tree.h"

#include "base/memory.h"
#include "octree/trace_constants.h"
#include "light/transport_layout.h"

#include <stdlib.h>

/* Numbers of texels stay below 2^31, which GLSL's int holds. */
#define DISCS_MAX (1u << 27)

/* Places at which a range of discs may be split. */
#define CUTS 16u

/* Boxes are wider by these shares of the radius and of the coordinates, so that rounding makes no
 * ray miss a disc. */
#define PAD_RADIUS 1e-4f
#define PAD_PLACE 1e-6f

typedef struct box {
	float low[3], high[3];
} box;

/* A build on its way. */
typedef struct build {
	const gw_disc *discs;
	uint32_t *word;
	uint32_t nodes;       /* so far */
	uint32_t first_texel; /* of disc 0 */
} build;

gw_disc gw_disc_of_surfel(const gw_surfels *surfels, size_t surfel, const gw_disc_shape *shape)
{
	gw_disc disc = { .normal = { surfels->normal[3 * surfel], surfels->normal[3 * surfel + 1],
								 surfels->normal[3 * surfel + 2] },
					 .radius =
						 (float)((double)surfels->radius[surfel] * shape->scale * shape->widen),
					 .facet = (uint32_t)surfel };
	float place[3];
	for (size_t k = 0; k < 3; k++) {
		place[k] =
			(float)(((double)surfels->position[3 * surfel + k] - shape->origin[k]) * shape->scale);
		if (surfels->bend && !shape->flat)
			disc.bend[k] = (float)((double)surfels->bend[3 * surfel + k] / shape->scale);
	}
	disc.place = (gw_vec3){ place[0], place[1], place[2] };
	for (size_t k = 0; k < 6 && !shape->uncut; k++)
		disc.clip[k] = k % 3 == 2 ? (float)((double)surfels->clip[6 * surfel + k] * shape->scale)
								  : surfels->clip[6 * surfel + k];
	return disc;
}

/* ------------------------------------------------------------------------------------ building */

static box empty_box(void)
{
	return (box){ { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY } };
}

static void join(box *all, const box *other)
{
	for (int k = 0; k < 3; k++) {
		all->low[k] = gw_smaller(all->low[k], other->low[k]);
		all->high[k] = gw_larger(all->high[k], other->high[k]);
	}
}

static box box_of(const gw_disc *d)
{
	const float place[3] = { d->place.x, d->place.y, d->place.z };
	const float normal[3] = { d->normal.x, d->normal.y, d->normal.z };
	float steep = fabsf(d->bend[0]) + 2.0f * fabsf(d->bend[1]) + fabsf(d->bend[2]);
	float height = 0.5f * d->radius * d->radius * steep;
	box b;
	for (int k = 0; k < 3; k++) {
		float reach = d->radius * sqrtf(gw_larger(0.0f, 1.0f - normal[k] * normal[k])) +
					  height * fabsf(normal[k]);
		reach += PAD_RADIUS * d->radius + PAD_PLACE * fabsf(place[k]);
		b.low[k] = place[k] - reach;
		b.high[k] = place[k] + reach;
	}
	return b;
}

static box box_of_range(const gw_disc *discs, size_t first, size_t last)
{
	box all = empty_box();
	for (size_t i = first; i < last; i++) {
		box b = box_of(discs + i);
		join(&all, &b);
	}
	return all;
}

static double surface_of(const box *b)
{
	double x = (double)b->high[0] - (double)b->low[0], y = (double)b->high[1] - (double)b->low[1],
		   z = (double)b->high[2] - (double)b->low[2];
	return x * y + y * z + z * x;
}

/* Where a range is split: of a few places evenly along it, the one whose halves are the least work
 * for rays, which is the surface of their boxes times what is in them. */
static size_t choose_split(const gw_disc *discs, size_t first, size_t last)
{
	size_t count = last - first, parts = count < CUTS ? count : CUTS, best = first + count / 2;
	box part[CUTS], left = empty_box(), right[CUTS + 1];
	right[parts] = empty_box();
	for (size_t p = parts; p-- > 0;) {
		part[p] = box_of_range(discs, first + count * p / parts, first + count * (p + 1) / parts);
		right[p] = right[p + 1];
		join(&right[p], &part[p]);
	}
	double least = INFINITY;
	for (size_t p = 1; p < parts; p++) {
		size_t at = first + count * p / parts;
		join(&left, &part[p - 1]);
		double work =
			surface_of(&left) * (double)(at - first) + surface_of(&right[p]) * (double)(last - at);
		if (work < least) {
			least = work;
			best = at;
		}
	}
	return best;
}

static void store(uint32_t *texel, float x, float y, float z, uint32_t w)
{
	texel[0] = gw_bits_of(x);
	texel[1] = gw_bits_of(y);
	texel[2] = gw_bits_of(z);
	texel[3] = w;
}

static void store_disc(const build *b, uint32_t number)
{
	const gw_disc *d = b->discs + number;
	uint32_t *texel = b->word + 4 * ((size_t)b->first_texel + GW_DISC_TEXELS * (size_t)number);
	store(texel, d->place.x, d->place.y, d->place.z, gw_bits_of(d->radius));
	store(texel + 4, d->normal.x, d->normal.y, d->normal.z, d->facet);
	store(texel + 8, d->clip[0], d->clip[1], d->clip[2], number);
	store(texel + 12, d->clip[3], d->clip[4], d->clip[5], 0);
	store(texel + 16, d->bend[0], d->bend[1], d->bend[2], 0);
}

/* Adds the nodes of a range, depth first. Splits leave at least a sixteenth on each side, so that
 * this goes down some hundred levels at most. */
static void add_nodes(build *b, size_t first, size_t last)
{
	uint32_t *texel = b->word + 4 * (1 + 2 * (size_t)b->nodes++);
	box all = box_of_range(b->discs, first, last);
	uint32_t disc = GW_NONE;
	if (last - first == 1) {
		disc = b->first_texel + GW_DISC_TEXELS * (uint32_t)first;
		store_disc(b, (uint32_t)first);
	} else {
		size_t split = choose_split(b->discs, first, last);
		add_nodes(b, first, split);
		add_nodes(b, split, last);
	}
	store(texel, all.low[0], all.low[1], all.low[2], b->nodes);
	store(texel + 4, all.high[0], all.high[1], all.high[2], disc);
}

gw_status gw_disc_tree_build(const gw_disc *discs, size_t count, gw_disc_tree *tree,
							 gw_error *error)
{
	*tree = (gw_disc_tree){ 0 };
	if (count == 0)
		return GW_OK;
	uint64_t nodes = 2 * (uint64_t)count - 1;
	uint64_t texels = count < DISCS_MAX ? gw_disc_tree_texels((uint32_t)count) : 0;
	uint32_t *word = texels ? gw_allocate_zeros(texels, 4 * sizeof *word) : NULL;
	if (!word)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for a tree of %zu discs", count);
	build b = { .discs = discs, .word = word, .first_texel = (uint32_t)(1 + 2 * nodes) };
	word[0] = (uint32_t)nodes;
	add_nodes(&b, 0, count);
	*tree = (gw_disc_tree){
		.discs = (uint32_t)count, .nodes = (uint32_t)nodes, .texels = (size_t)texels, .word = word
	};
	return GW_OK;
}

uint64_t gw_disc_tree_texels(uint32_t discs)
{
	return discs ? 1 + 2 * (2 * (uint64_t)discs - 1) + GW_DISC_TEXELS * (uint64_t)discs : 1;
}

bool gw_disc_tree_fits(const uint32_t *word, uint32_t discs, uint64_t facets)
{
	uint64_t nodes = discs ? 2 * (uint64_t)discs - 1 : 0, first = 1 + 2 * nodes;
	if (discs >= DISCS_MAX || word[0] != nodes)
		return false;
	for (uint64_t at = 0; at < nodes; at++) {
		const uint32_t *node = word + 4 * (1 + 2 * at);
		if (node[3] <= at || node[3] > nodes)
			return false;
		if (node[7] == GW_NONE)
			continue;
		if (node[7] < first || (node[7] - first) % GW_DISC_TEXELS != 0 ||
			(node[7] - first) / GW_DISC_TEXELS >= discs)
			return false;
		if (word[4 * ((uint64_t)node[7] + 1) + 3] >= facets)
			return false;
	}
	return true;
}

/* ------------------------------------------------------------------------------------ crossing */

/* Discs are of one sheet up to this height over each other, of the radius, and this cosine. */
#define SHEET_HEIGHT 0.25f
#define SHEET_COSINE 0.7f

/* The disc of a leaf, as far as a crossing needs it. */
static gw_disc crossed_disc(const uint32_t *texel)
{
	return (
		gw_disc){ .place = { gw_float_of(texel[0]), gw_float_of(texel[1]), gw_float_of(texel[2]) },
				  .radius = gw_float_of(texel[3]),
				  .normal = { gw_float_of(texel[4]), gw_float_of(texel[5]), gw_float_of(texel[6]) },
				  .facet = texel[7] };
}

static bool is_of_sheet(const gw_disc *d, const gw_disc *sheet)
{
	gw_vec3 off = gw_minus(d->place, sheet->place);
	return fabsf(gw_dot(d->normal, sheet->normal)) > SHEET_COSINE &&
		   fabsf(gw_dot(sheet->normal, off)) < SHEET_HEIGHT * sheet->radius;
}

static bool crosses(const gw_disc *d, const gw_disc_start *from, float *length)
{
	gw_vec3 off = gw_minus(d->place, from->origin);
	float approach = gw_dot(d->normal, from->direction), height = gw_dot(d->normal, off);
	float t = height / approach; /* infinite or not a number for a segment along the plane */
	if (!(t > 0.0f && t < *length))
		return false;
	gw_vec3 at = gw_minus(gw_times(from->direction, t), off);
	if (gw_dot(at, at) > d->radius * d->radius)
		return false;
	*length = t;
	return true;
}

static bool enters(const uint32_t *node, const float origin[3], const float inverse[3], float most)
{
	float first = 0.0f, last = most;
	for (int k = 0; k < 3; k++) {
		float a = (gw_float_of(node[k]) - origin[k]) * inverse[k];
		float b = (gw_float_of(node[4 + k]) - origin[k]) * inverse[k];
		first = gw_larger(first, gw_smaller(a, b));
		last = gw_smaller(last, gw_larger(a, b));
	}
	return first <= last;
}

uint32_t gw_disc_tree_cross(const gw_disc_tree *tree, const gw_disc_start *from,
							const gw_disc *leaves, float *length)
{
	const float origin[3] = { from->origin.x, from->origin.y, from->origin.z };
	const float way[3] = { from->direction.x, from->direction.y, from->direction.z };
	float inverse[3];
	uint32_t facet = GW_NONE;
	for (int k = 0; k < 3; k++)
		inverse[k] = 1.0f / (fabsf(way[k]) > 1e-20f ? way[k] : copysignf(1e-20f, way[k]));
	for (uint32_t at = 0; at < tree->nodes;) {
		const uint32_t *node = tree->word + 4 * (1 + 2 * (size_t)at);
		if (!enters(node, origin, inverse, *length)) {
			at = node[3];
			continue;
		}
		at++;
		if (node[7] == GW_NONE)
			continue;
		gw_disc d = crossed_disc(tree->word + 4 * (size_t)node[7]);
		float t = *length;
		if (!crosses(&d, from, &t) || (leaves && t < leaves->radius && is_of_sheet(&d, leaves)))
			continue;
		*length = t;
		facet = d.facet;
	}
	return facet;
}

void gw_disc_tree_clear(gw_disc_tree *tree)
{
	free(tree->word);
	*tree = (gw_disc_tree){ 0 };
}
