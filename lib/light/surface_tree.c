/*
 * surface_tree.c - see surface_tree.h. Leaves lie in Morton order, so that those of a node follow
 * each other.
 */
#include "light/surface_tree.h"

#include "base/memory.h"
#include "base/parallel.h"
#include "base/shared_math.h"
#include "octree/octree_layout.h"
#include "octree/trace_constants.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A disc of the same area as a piece of a plane is in a cell leaves out the corners of that. */
#define DISC_REACH 1.25f

/* Of the area that a plane has across a cell, what fills it. */
#define FULL_LEAST 0.85f

/* What leaves hold, for the processor. */
typedef struct leaves {
	gw_view leaf, cell, tile, plane, centre, albedo;
	uint32_t dark_facet;
} leaves;

static void close_leaves(leaves *l)
{
	gw_view_close(&l->albedo);
	gw_view_close(&l->centre);
	gw_view_close(&l->plane);
	gw_view_close(&l->tile);
	gw_view_close(&l->cell);
	gw_view_close(&l->leaf);
}

static gw_status open_leaves(gw_gpu *gpu, const gw_octree *octree, leaves *l, gw_error *error)
{
	uint64_t facets = 16 * (uint64_t)octree->facet_count;
	*l = (leaves){ .dark_facet = octree->dark_facet };
	gw_status status =
		gw_view_open(gpu, &octree->leaf_cell, 16 * (uint64_t)octree->leaf_count, &l->cell, error);
	if (status == GW_OK)
		status = gw_view_open(gpu, &octree->facet_leaf, facets / 4, &l->leaf, error);
	if (status == GW_OK)
		status = gw_view_open(gpu, &octree->leaf_tile, 8 * (uint64_t)octree->leaf_tile_count,
							  &l->tile, error);
	if (status == GW_OK)
		status = gw_view_open(gpu, &octree->facet_plane, facets, &l->plane, error);
	if (status == GW_OK)
		status = gw_view_open(gpu, &octree->facet_centre, facets, &l->centre, error);
	if (status == GW_OK)
		status = gw_view_open(gpu, &octree->facet_albedo, facets, &l->albedo, error);
	if (status != GW_OK)
		close_leaves(l);
	return status;
}

/* ------------------------------------------------------------------------------------- facets */

/* Does the surface of a leaf's facets fill it, or come from two sides to an edge? */
static bool fills_cell(const leaves *l, size_t leaf)
{
	const uint32_t *cell = (const uint32_t *)l->cell.bytes + 4 * leaf;
	uint32_t fields = ((const uint32_t *)l->tile.bytes)[2 * cell[3] + 1];
	uint32_t octant = (cell[0] & 1u) | (cell[1] & 1u) << 1 | (cell[2] & 1u) << 2;
	return (fields >> (24 + octant) & 1u) != 0 || (fields >> (16 + octant) & 1u) != 0;
}

/* How often a direction meets it; of foliage by Beer and Lambert's law, over a cell. */
static float opacity_of(float sides, float w, float area)
{
	if (sides == GW_FACET_FOLIAGE)
		return 1.0f - expf(-0.5f * (1.0f - GW_FOLIAGE_CLEAR) * area);
	return gw_facet_opacity(w);
}

static void set_sides(const leaves *l, size_t facet, gw_surface_piece *p)
{
	float w = ((const float *)l->albedo.bytes)[4 * facet + 3], sides = floorf(w);
	p->two_sided = sides == 1.0f || sides == GW_FACET_FOLIAGE;
	p->opacity = l->dark_facet != 0 ? opacity_of(sides, w, p->area) : 1.0f;
	p->cone = w != 0.0f ? GW_CONE_ALL : 0.0f;
}

static void make_facet(const leaves *l, size_t facet, gw_surface_piece *p)
{
	size_t leaf = gw_facet_leaf(((const uint32_t *)l->leaf.bytes)[facet]);
	const uint32_t *cell = (const uint32_t *)l->cell.bytes + 4 * leaf;
	const float *centre = (const float *)l->centre.bytes + 4 * facet;
	const float *plane = (const float *)l->plane.bytes + 4 * facet;
	const float *albedo = (const float *)l->albedo.bytes + 4 * facet;
	float off = 0.0f;
	*p = (gw_surface_piece){ .area = centre[3], .offset = plane[3], .size = 1.0f };
	for (int k = 0; k < 3; k++) {
		p->low[k] = (float)cell[k];
		p->place[k] = centre[k];
		p->normal[k] = plane[k];
		p->albedo[k] = albedo[k];
		p->offset += plane[k] * (p->low[k] + 0.5f);
		off += (centre[k] - p->low[k] - 0.5f) * (centre[k] - p->low[k] - 0.5f);
	}
	if (!(p->area > 0.0f))
		return;
	bool large = p->area > GW_FACET_LARGE;
	float disc = DISC_REACH * sqrtf(p->area / GW_PI);
	p->size = large ? 0.0f : 1.0f;
	p->radius = large || !fills_cell(l, leaf) ? disc : sqrtf(off) + 0.87f;
	set_sides(l, facet, p);
}

/* -------------------------------------------------------------------------------------- nodes */

/* Mean place and normal of a node's children; zero where normals cancel. */
static void average(const gw_surface_piece *child, gw_surface_piece *node)
{
	double place[3] = { 0 }, normal[3] = { 0 }, albedo[3] = { 0 }, area = 0.0;
	for (uint32_t i = 0; i < node->count; i++) {
		double weight = (double)child[i].area;
		area += weight;
		for (int k = 0; k < 3; k++) {
			place[k] += weight * (double)child[i].place[k];
			normal[k] += weight * (double)child[i].normal[k];
			albedo[k] += weight * (double)child[i].albedo[k];
		}
	}
	double length = sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
	node->area = (float)area;
	for (int k = 0; k < 3 && area > 0.0; k++) {
		node->place[k] = (float)(place[k] / area);
		node->albedo[k] = (float)(albedo[k] / area);
		node->normal[k] = length > 1e-6 * area ? (float)(normal[k] / length) : 0.0f;
		node->offset += node->normal[k] * node->place[k];
	}
}

/* The sphere and the cone around a node's children. */
static void enclose(const gw_surface_piece *child, gw_surface_piece *node)
{
	for (uint32_t i = 0; i < node->count; i++) {
		const gw_surface_piece *c = &child[i];
		float squared = 0.0f, cosine = 0.0f;
		if (!(c->area > 0.0f))
			continue;
		for (int k = 0; k < 3; k++) {
			squared += (c->place[k] - node->place[k]) * (c->place[k] - node->place[k]);
			cosine += c->normal[k] * node->normal[k];
		}
		float angle = c->cone + acosf(fminf(fmaxf(cosine, -1.0f), 1.0f));
		node->radius = fmaxf(node->radius, sqrtf(squared) + c->radius);
		node->cone = fmaxf(node->cone, angle);
	}
	if (node->normal[0] == 0.0f && node->normal[1] == 0.0f && node->normal[2] == 0.0f)
		node->cone = GW_CONE_ALL;
	node->cone = fminf(node->cone, GW_CONE_ALL);
}

static void make_node(const gw_surface_tree *t, uint32_t first, uint32_t last, uint32_t level,
					  gw_surface_piece *node)
{
	float size = (float)(1u << (level + 1));
	const gw_surface_piece *child = &t->piece[first];
	*node =
		(gw_surface_piece){ .first = first, .count = last - first, .size = size, .opacity = 1.0f };
	for (int k = 0; k < 3; k++)
		node->low[k] = floorf(child->low[k] / size) * size;
	average(child, node);
	enclose(child, node);
	float along =
		fmaxf(fabsf(node->normal[0]), fmaxf(fabsf(node->normal[1]), fabsf(node->normal[2])));
	node->full = node->area * along >= FULL_LEAST * size * size;
}

static bool same_cell(const gw_surface_piece *a, const gw_surface_piece *b, float size)
{
	bool same = true;
	for (int k = 0; k < 3; k++)
		same = same && floorf(a->low[k] / size) == floorf(b->low[k] / size);
	return same;
}

/* Adds the nodes of a level, of the pieces from `first` on. */
static gw_status add_level(gw_surface_tree *t, uint32_t first, uint32_t level, gw_error *error)
{
	float size = (float)(1u << (level + 1));
	uint32_t end = t->count;
	uint64_t nodes = 0;
	for (uint32_t i = first; i < end; i++)
		nodes += i == first || !same_cell(&t->piece[i - 1], &t->piece[i], size);
	gw_surface_piece *grown = end + nodes < GW_NONE
								  ? gw_resize_array(t->piece, (size_t)(end + nodes), sizeof *grown)
								  : NULL;
	if (!grown)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %llu pieces of surface",
					   (unsigned long long)(end + nodes));
	t->piece = grown;
	for (uint32_t i = first, last; i < end; i = last) {
		for (last = i + 1; last < end && same_cell(&grown[i], &grown[last], size);)
			last++;
		make_node(t, i, last, level, &grown[t->count++]);
	}
	return GW_OK;
}

static gw_status add_levels(const gw_octree *octree, gw_surface_tree *t, gw_error *error)
{
	uint32_t first = 0;
	for (uint32_t level = 0; level < octree->depth; level++) {
		uint32_t next = t->count;
		t->level_first[level] = next;
		GW_TRY(add_level(t, first, level, error));
		first = next;
		t->level_first[++t->level_count] = t->count;
	}
	return GW_OK;
}

gw_status gw_surface_tree_make(gw_gpu *gpu, const gw_octree *octree, gw_surface_tree *tree,
							   gw_error *error)
{
	leaves l;
	size_t facets = octree->facet_count;
	*tree = (gw_surface_tree){ .facets = octree->facet_count, .count = octree->facet_count };
	GW_TRY(open_leaves(gpu, octree, &l, error));
	tree->piece = gw_allocate_array(facets, sizeof *tree->piece);
	tree->level_first = gw_allocate_zeros(octree->depth + 2, sizeof *tree->level_first);
	gw_status status = tree->piece && tree->level_first
						   ? GW_OK
						   : gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu facets", facets);
	for (size_t i = 0; i < facets && status == GW_OK; i++)
		make_facet(&l, i, &tree->piece[i]);
	/* The empty one, which that follows, makes no node. */
	if (status == GW_OK)
		memcpy(tree->piece[GW_FACET_EMPTY].low, tree->piece[GW_FACET_EMPTY + 1].low,
			   sizeof tree->piece->low);
	close_leaves(&l);
	if (status == GW_OK)
		status = add_levels(octree, tree, error);
	if (status != GW_OK)
		gw_surface_tree_clear(tree);
	return status;
}

void gw_surface_tree_clear(gw_surface_tree *tree)
{
	free(tree->piece);
	free(tree->level_first);
	*tree = (gw_surface_tree){ 0 };
}

/* ------------------------------------------------------------------------------------- pulling */

typedef struct pulling {
	const gw_surface_tree *tree;
	uint32_t first; /* of the level */
	float *radiance;
} pulling;

static void pull_some(void *user, size_t first, size_t last, uint32_t worker)
{
	const pulling *p = user;
	(void)worker;
	for (size_t i = p->first + first; i < p->first + last; i++) {
		const gw_surface_piece *node = &p->tree->piece[i];
		double sum[3] = { 0 };
		for (uint32_t c = node->first; c < node->first + node->count; c++)
			for (int k = 0; k < 3; k++)
				sum[k] +=
					(double)p->tree->piece[c].area * (double)p->radiance[4 * (size_t)c + (size_t)k];
		for (int k = 0; k < 3; k++)
			p->radiance[4 * i + (size_t)k] =
				node->area > 0.0f ? (float)(sum[k] / (double)node->area) : 0.0f;
		p->radiance[4 * i + 3] = 0.0f;
	}
}

void gw_surface_tree_pull(const gw_surface_tree *tree, uint32_t threads, float *radiance)
{
	for (uint32_t level = 0; level < tree->level_count; level++) {
		uint32_t first = tree->level_first[level];
		pulling p = { tree, first, radiance };
		gw_parallel_for(gw_thread_count(threads), tree->level_first[level + 1] - first, 4096,
						pull_some, &p);
	}
}
