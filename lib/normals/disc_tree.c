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

/* Parts of a range of discs along each axis, between which it may be split. */
#define CUTS 16u

/* Boxes are wider by these shares of the radius and of the coordinates, so that rounding makes no
 * ray miss a disc. */
#define PAD_RADIUS 1e-4f
#define PAD_PLACE 1e-6f

typedef struct box {
	float low[3], high[3];
} box;

/* A build on its way: the discs in an order in which those of a node lie together. */
typedef struct build {
	const gw_disc *discs;
	box *box; /* of each disc */
	uint32_t *order;
	uint32_t *word;
	size_t count, nodes, room; /* room: for so many nodes */
} build;

/* Of the order. */
typedef struct range {
	size_t first, last;
	uint32_t halvings; /* that it may still take down to single discs */
} range;

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

/* What is no number leaves all as it is: the order of both says so. */
static void join(box *all, const box *other)
{
	for (int k = 0; k < 3; k++) {
		all->low[k] = gw_smaller(other->low[k], all->low[k]);
		all->high[k] = gw_larger(other->high[k], all->high[k]);
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

static double surface_of(const box *b)
{
	double x = (double)b->high[0] - (double)b->low[0], y = (double)b->high[1] - (double)b->low[1],
		   z = (double)b->high[2] - (double)b->low[2];
	return x * y + y * z + z * x;
}

static box box_of_range(const build *b, const range *r)
{
	box all = empty_box();
	for (size_t i = r->first; i < r->last; i++)
		join(&all, &b->box[b->order[i]]);
	return all;
}

static float middle_of(const box *b, int axis)
{
	return 0.5f * (b->low[axis] + b->high[axis]);
}

/* Where a range is cut: before the part of the axis that has this number. */
typedef struct cut {
	int axis; /* -1: nowhere */
	uint32_t part;
	float low, scale; /* the part of a middle m is (m - low) * scale */
	double work;
} cut;

static uint32_t part_of(const box *b, const cut *c)
{
	float part = (middle_of(b, c->axis) - c->low) * c->scale;
	return part < (float)(CUTS - 1) ? (uint32_t)part : CUTS - 1;
}

/* What is in the parts of an axis. */
typedef struct parts {
	box box[CUTS];
	size_t count[CUTS];
} parts;

static void sort_into_parts(const build *b, const range *r, const cut *c, parts *p)
{
	for (uint32_t k = 0; k < CUTS; k++) {
		p->box[k] = empty_box();
		p->count[k] = 0;
	}
	for (size_t i = r->first; i < r->last; i++) {
		const box *own = &b->box[b->order[i]];
		uint32_t k = part_of(own, c);
		join(&p->box[k], own);
		p->count[k]++;
	}
}

/* The cut of an axis whose halves are the least work for rays, which is the surface of their boxes
 * times what is in them, if it is less than that of the best so far. No half has more than `most`.
 */
static void try_cuts(const parts *p, size_t most, cut c, cut *best)
{
	box right[CUTS], left = empty_box();
	size_t above[CUTS], below = 0;
	for (uint32_t k = CUTS; k-- > 0;) {
		right[k] = p->box[k];
		above[k] = p->count[k];
		if (k + 1 < CUTS) {
			join(&right[k], &right[k + 1]);
			above[k] += above[k + 1];
		}
	}
	for (uint32_t k = 1; k < CUTS; k++) {
		join(&left, &p->box[k - 1]);
		below += p->count[k - 1];
		if (below == 0 || above[k] == 0 || below > most || above[k] > most)
			continue;
		c.part = k;
		c.work = surface_of(&left) * (double)below + surface_of(&right[k]) * (double)above[k];
		if (c.work < best->work)
			*best = c;
	}
}

static cut choose_cut(const build *b, const range *r)
{
	cut best = { .axis = -1, .work = INFINITY };
	box middles = empty_box();
	size_t most = (size_t)1 << (r->halvings - 1);
	for (size_t i = r->first; i < r->last; i++)
		for (int k = 0; k < 3; k++) {
			float middle = middle_of(&b->box[b->order[i]], k);
			middles.low[k] = gw_smaller(middle, middles.low[k]);
			middles.high[k] = gw_larger(middle, middles.high[k]);
		}
	for (int axis = 0; axis < 3; axis++) {
		parts p;
		float width = middles.high[axis] - middles.low[axis];
		cut c = { .axis = axis, .low = middles.low[axis], .scale = (float)CUTS / width };
		if (!(width > 0.0f) || !isfinite(c.scale))
			continue;
		sort_into_parts(b, r, &c, &p);
		try_cuts(&p, most, c, &best);
	}
	return best;
}

/* Splits a range in two; where no cut is any good, as of discs in one place, in halves. */
static size_t split(build *b, const range *r)
{
	cut c = choose_cut(b, r);
	size_t at = r->first;
	if (c.axis < 0)
		return r->first + (r->last - r->first) / 2;
	for (size_t i = r->first; i < r->last; i++) {
		uint32_t disc = b->order[i];
		if (part_of(&b->box[disc], &c) >= c.part)
			continue;
		b->order[i] = b->order[at];
		b->order[at++] = disc;
	}
	return at;
}

/* Up to four ranges that a node has as children: single discs, or what two halvings make. */
static uint32_t list_children(build *b, const range *r, range child[4])
{
	uint32_t count = 0;
	if (r->last - r->first <= 4) {
		for (size_t i = r->first; i < r->last; i++)
			child[count++] = (range){ i, i + 1, 0 };
		return count;
	}
	size_t middle = split(b, r);
	const range half[2] = { { r->first, middle, r->halvings - 1 },
							{ middle, r->last, r->halvings - 1 } };
	for (int h = 0; h < 2; h++) {
		size_t discs = half[h].last - half[h].first, at = discs > 1 ? split(b, &half[h]) : 0;
		if (discs == 1) {
			child[count++] = half[h];
			continue;
		}
		child[count++] = (range){ half[h].first, at, half[h].halvings - 1 };
		child[count++] = (range){ at, half[h].last, half[h].halvings - 1 };
	}
	return count;
}

static void store(uint32_t *texel, float x, float y, float z, uint32_t w)
{
	texel[0] = gw_bits_of(x);
	texel[1] = gw_bits_of(y);
	texel[2] = gw_bits_of(z);
	texel[3] = w;
}

static void store_disc(const gw_disc *d, uint32_t number, uint32_t *texel)
{
	store(texel, d->place.x, d->place.y, d->place.z, gw_bits_of(d->radius));
	store(texel + 4, d->normal.x, d->normal.y, d->normal.z, d->facet);
	store(texel + 8, d->clip[0], d->clip[1], d->clip[2], number);
	store(texel + 12, d->clip[3], d->clip[4], d->clip[5], 0);
	store(texel + 16, d->bend[0], d->bend[1], d->bend[2], 0);
}

static uint32_t *node_word(const build *b, size_t node)
{
	return b->word + 4 * (1 + GW_DISC_TEXELS * b->count + GW_DISC_NODE_TEXELS * node);
}

static bool make_room(build *b)
{
	if (b->nodes < b->room)
		return true;
	size_t room = b->room + b->room / 2 + 1;
	uint64_t texels = gw_disc_tree_texels((uint32_t)b->count, (uint32_t)room);
	uint32_t *word = gw_resize_array(b->word, texels, 4 * sizeof *word);
	if (!word)
		return false;
	b->word = word;
	b->room = room;
	return true;
}

/* Adds the nodes of a range, depth first; false without memory. */
static bool add_nodes(build *b, const range *r)
{
	range child[4];
	if (!make_room(b))
		return false;
	size_t node = b->nodes++;
	uint32_t count = list_children(b, r, child);
	for (uint32_t k = 0; k < 4; k++) {
		box own = k < count ? box_of_range(b, &child[k]) : empty_box();
		bool single = k < count && child[k].last - child[k].first == 1;
		uint32_t number = k >= count ? GW_NONE
						  : single ? GW_DISC_LEAF | (uint32_t)(1 + GW_DISC_TEXELS * child[k].first)
								   : (uint32_t)b->nodes;
		uint32_t *word = node_word(b, node);
		for (uint32_t axis = 0; axis < 3; axis++) {
			word[8 * axis + k] = gw_bits_of(own.low[axis]);
			word[8 * axis + 4 + k] = gw_bits_of(own.high[axis]);
		}
		word[24 + k] = number;
		if (k < count && !single && !add_nodes(b, &child[k]))
			return false;
	}
	return true;
}

static bool build_nodes(build *b)
{
	const range all = { 0, b->count, GW_DISC_HALVINGS };
	if (!b->box || !b->order || !b->word)
		return false;
	b->room = b->count / 2 + 1;
	for (size_t i = 0; i < b->count; i++) {
		b->box[i] = box_of(b->discs + i);
		b->order[i] = (uint32_t)i;
	}
	if (!add_nodes(b, &all))
		return false;
	for (size_t i = 0; i < b->count; i++)
		store_disc(b->discs + b->order[i], b->order[i], b->word + 4 * (1 + GW_DISC_TEXELS * i));
	return true;
}

gw_status gw_disc_tree_build(const gw_disc *discs, size_t count, gw_disc_tree *tree,
							 gw_error *error)
{
	*tree = (gw_disc_tree){ 0 };
	if (count == 0)
		return GW_OK;
	if (count >= DISCS_MAX)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for a tree of %zu discs", count);
	uint64_t texels = gw_disc_tree_texels((uint32_t)count, (uint32_t)(count / 2 + 1));
	build b = { .discs = discs,
				.box = gw_allocate_array(count, sizeof *b.box),
				.order = gw_allocate_array(count, sizeof *b.order),
				.word = gw_allocate_array(texels, 4 * sizeof *b.word),
				.count = count };
	bool good = build_nodes(&b);
	free(b.box);
	free(b.order);
	if (!good) {
		free(b.word);
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for a tree of %zu discs", count);
	}
	b.word[0] = (uint32_t)b.nodes;
	b.word[1] = (uint32_t)count;
	b.word[2] = b.word[3] = 0;
	*tree = (gw_disc_tree){
		.discs = (uint32_t)count,
		.nodes = (uint32_t)b.nodes,
		.texels = (size_t)gw_disc_tree_texels((uint32_t)count, (uint32_t)b.nodes),
		.word = b.word,
	};
	return GW_OK;
}

uint64_t gw_disc_tree_texels(uint32_t discs, uint32_t nodes)
{
	return 1 + GW_DISC_TEXELS * (uint64_t)discs + GW_DISC_NODE_TEXELS * (uint64_t)nodes;
}

static const uint32_t *node_of(const uint32_t *word, uint64_t discs, uint64_t node)
{
	return word + 4 * (1 + GW_DISC_TEXELS * discs + GW_DISC_NODE_TEXELS * node);
}

bool gw_disc_tree_fits(const uint32_t *word, uint32_t discs, uint32_t nodes, uint64_t facets)
{
	if (discs >= DISCS_MAX || nodes >= DISCS_MAX || word[0] != nodes || word[1] != discs)
		return false;
	for (uint64_t i = 0; i < discs; i++)
		if (word[4 * (1 + GW_DISC_TEXELS * i) + 7] >= facets)
			return false;
	for (uint64_t at = 0; at < nodes; at++) {
		const uint32_t *child = node_of(word, discs, at) + 24;
		for (int k = 0; k < 4; k++) {
			uint32_t texel = child[k] - GW_DISC_LEAF;
			bool disc = child[k] >= GW_DISC_LEAF && child[k] != GW_NONE;
			if (disc && (texel < 1 || (texel - 1) % GW_DISC_TEXELS != 0 ||
						 (texel - 1) / GW_DISC_TEXELS >= discs))
				return false;
			if (child[k] < GW_DISC_LEAF && (child[k] <= at || child[k] >= nodes))
				return false;
		}
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

/* What a segment looks at. */
typedef struct crossing {
	const gw_disc_tree *tree;
	const gw_disc_start *from;
	const gw_disc *leaves;
	float origin[3], inverse[3];
	float length;
	uint32_t facet;
} crossing;

/* Whether a segment passes the box of a node's child. */
static bool enters(const uint32_t *node, int child, const crossing *c)
{
	float first = 0.0f, last = c->length;
	for (int k = 0; k < 3; k++) {
		float a = (gw_float_of(node[8 * k + child]) - c->origin[k]) * c->inverse[k];
		float b = (gw_float_of(node[8 * k + 4 + child]) - c->origin[k]) * c->inverse[k];
		first = gw_larger(first, gw_smaller(a, b));
		last = gw_smaller(last, gw_larger(a, b));
	}
	return first <= last;
}

static void cross_disc(uint32_t texel, crossing *c)
{
	gw_disc d = crossed_disc(c->tree->word + 4 * (size_t)texel);
	float t = c->length;
	if (!crosses(&d, c->from, &t) ||
		(c->leaves && t < c->leaves->radius && is_of_sheet(&d, c->leaves)))
		return;
	c->length = t;
	c->facet = d.facet;
}

uint32_t gw_disc_tree_cross(const gw_disc_tree *tree, const gw_disc_start *from,
							const gw_disc *leaves, float *length)
{
	const float way[3] = { from->direction.x, from->direction.y, from->direction.z };
	crossing c = { tree,  from,    leaves, { from->origin.x, from->origin.y, from->origin.z },
				   { 0 }, *length, GW_NONE };
	uint32_t waiting[GW_DISC_WAITING + 1], count = 0;
	for (int k = 0; k < 3; k++)
		c.inverse[k] = 1.0f / (fabsf(way[k]) > 1e-20f ? way[k] : copysignf(1e-20f, way[k]));
	if (tree->nodes > 0)
		waiting[count++] = 0;
	while (count > 0) {
		const uint32_t *node = node_of(tree->word, tree->discs, waiting[--count]);
		for (int k = 0; k < 4; k++) {
			uint32_t child = node[24 + k];
			if (child == GW_NONE || !enters(node, k, &c))
				continue;
			if (child >= GW_DISC_LEAF)
				cross_disc(child - GW_DISC_LEAF, &c);
			else if (count <= GW_DISC_WAITING)
				waiting[count++] = child;
		}
	}
	*length = c.length;
	return c.facet;
}

void gw_disc_tree_clear(gw_disc_tree *tree)
{
	free(tree->word);
	*tree = (gw_disc_tree){ 0 };
}
