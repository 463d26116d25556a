/*
 * transport_blocks.c - see transport_blocks.h.
 */
#include "bake/transport_blocks.h"

#include "cloud/frame.h"
#include "normals/disc_tree.h"
#include "light/transport_layout.h"
#include "octree/compartments.h"
#include "octree/octree_layout.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* Any word is below this. */
#define WORDS_LIMIT (UINT64_C(1) << 32)

#define POINTS_MAX (UINT64_C(1) << 30)

/* Bits of gw_transport_numbers.optional. */
#define NOISY 1u         /* shading normals */
#define OFF 2u           /* how far normals are off */
#define POINTS_ALBEDO 4u /* of points that share surfels */
#define CUT 8u           /* discs are, of which a coarser octree is made or which are large */
#define BENT 16u         /* bends of discs, for the estimated error as well */
#define CREASED 32u      /* discs are, of which a coarser octree is made */
#define MOMENTS 64u      /* of what emitters brought to the records */
#define DOUBTED 128u     /* whether there is a surface, for the estimated error */
#define FROM_ABOVE 256u  /* no block: seen from above alone, for the estimated error */
#define ADDED 512u       /* records were, where these stand closer than others */
#define CHECKED 1024u    /* the tree of discs by which an estimate checks */
#define VOXELS 2048u     /* what leaves are as voxels */

/* Bits of gw_transport_numbers.apart. */
#define ROWS_APART 1u
#define HITS_APART 2u

/* What of discs an octree takes that is made from the surfels again, and what lamps do that shine
 * on large ones. */
static uint32_t discs_of(const gw_scene *scene)
{
	const gw_surfels *s = &scene->surfels;
	bool again = s->clip && gw_compartments_are_coarser(&scene->octree, s);
	return (again || scene->octree.tree_discs > 0 ? CUT : 0) | (again && s->creased ? CREASED : 0);
}

gw_transport_numbers gw_transport_numbers_of(const gw_scene *scene)
{
	const gw_surfels *s = &scene->surfels;
	const gw_octree *o = &scene->octree;
	const gw_records *r = &scene->records;
	gw_transport_numbers n;
	memset(&n, 0, sizeof n);
	n.given_area = s->given_area;
	n.spacing_ratio = scene->report->spacing_ratio;
	n.in_vain = scene->density.in_vain;
	n.narrow_share = scene->report->narrow_share;
	n.spacing = s->spacing;
	n.leaf_size = o->leaf_size;
	n.record_radius = r->radius;
	n.record_spacing = r->spacing;
	n.surfels = s->count;
	n.points = s->point_count;
	n.tree_discs = o->tree_discs;
	n.tree_nodes = o->tree_nodes;
	n.strays = s->stray_count;
	n.depth = o->depth;
	n.directory_level = o->directory_level;
	n.leaves = o->leaf_count;
	n.facets = o->facet_count;
	n.leaf_tiles = o->leaf_tile_count;
	n.tiles = o->tile_count;
	n.border_tiles = o->border_tile_count;
	n.fragments = o->fragment_count;
	n.records = r->count;
	n.facet_rows = r->row_count;
	n.block_level = r->block_level;
	n.block_count = r->block_count;
	n.block_tile_first = r->block_tile_first;
	n.rays = scene->rays.rays;
	n.ray_seed = scene->rays.seed;
	n.entries = scene->read_back.first[s->count];
	n.light_samples = scene->sampled.handle ? scene->options.light_samples : 0;
	n.looked = scene->portals.looked;
	n.portals = scene->portals.count;
	n.escaped = scene->portals.escaped;
	n.opened = scene->rays.through.handle != VK_NULL_HANDLE;
	n.emits = gw_surfels_emit(s) ? 1 : s->emission ? 2 : 0;
	n.optional = (s->shading_normal ? NOISY : 0) | (s->shading_normal_off ? OFF : 0) |
				 (s->albedo_of_point ? POINTS_ALBEDO : 0) | (s->bend ? BENT : 0) | discs_of(scene) |
				 (scene->sampled_moment.handle ? MOMENTS : 0) | (s->doubt ? DOUBTED : 0) |
				 (s->seen_from_above ? FROM_ABOVE : 0) |
				 (scene->density.facet_spacing ? ADDED : 0) |
				 (scene->check_tree.surfel ? CHECKED : 0) | (o->leaf_geometry.handle ? VOXELS : 0);
	n.check_points = scene->check_points.count;
	n.check_point_rays = scene->check_points.rays;
	n.check_points_lit = scene->check_points.emitted != NULL;
	n.dark_facet = o->dark_facet;
	n.wanted_leaf_size = o->wanted_leaf_size;
	snprintf(n.why_coarser, sizeof n.why_coarser, "%s", o->why_coarser);
	n.probes = scene->probes.numbers;
	n.compartments = gw_compartments_numbers_of(o);
	n.space = gw_space_numbers_of(&scene->space);
	n.apart = (scene->read_back.parted == r->count ? ROWS_APART : 0) |
			  (scene->rays.shut_out == r->count ? HITS_APART : 0);
	memcpy(n.origin, s->origin, sizeof n.origin);
	memcpy(n.minimum, s->minimum, sizeof n.minimum);
	memcpy(n.maximum, s->maximum, sizeof n.maximum);
	memcpy(n.cube_minimum, o->cube_minimum, sizeof n.cube_minimum);
	memcpy(n.repaired, &s->non_finite, sizeof n.repaired);
	memcpy(n.tile_first, o->tile_first, sizeof n.tile_first);
	return n;
}

bool gw_transport_has_voxels(const gw_transport_numbers *n)
{
	return (n->optional & VOXELS) != 0;
}

bool gw_transport_numbers_fit(const gw_transport_numbers *n)
{
	uint32_t directory =
		n->depth - 1 < GW_DIRECTORY_LEVEL_MAX ? n->depth - 1 : GW_DIRECTORY_LEVEL_MAX;
	for (int k = 0; k < 3; k++)
		if (!isfinite(n->origin[k]) || !isfinite(n->cube_minimum[k]))
			return false;
	return gw_probe_numbers_fit(&n->probes) &&
		   gw_space_numbers_fit(&n->space, n->minimum, n->maximum) &&
		   n->apart <= (ROWS_APART | HITS_APART) &&
		   gw_compartments_numbers_fit(&n->compartments, n->tiles, n->leaf_tiles) &&
		   n->surfels > 0 && n->tree_discs <= n->surfels && n->surfels <= 2 * n->points &&
		   n->points <= POINTS_MAX && n->strays <= n->points && n->depth >= 1 &&
		   n->depth <= GW_DEPTH_MAX && n->directory_level == directory && n->rays > 0 &&
		   n->rays <= 4096 && (uint64_t)n->rays * n->records <= UINT32_MAX && n->emits <= 2 &&
		   n->looked <= 1 && n->portals <= GW_PORTALS_MOST && n->opened == (n->portals > 0) &&
		   n->optional <= (NOISY | OFF | POINTS_ALBEDO | CUT | BENT | CREASED | MOMENTS | DOUBTED |
						   FROM_ABOVE | ADDED | CHECKED | VOXELS) &&
		   (n->tree_discs == 0 ? n->tree_nodes == 0 : n->optional & CUT) &&
		   n->tree_nodes <= n->tree_discs && (!(n->optional & MOMENTS) || n->light_samples > 0) &&
		   n->check_points <= n->surfels && n->check_point_rays <= 4096 &&
		   n->check_points_lit <= (n->emits == 1 && n->check_points > 0) &&
		   n->spacing_ratio >= 1.0 && n->narrow_share >= 0.0 && n->narrow_share <= 1.0 &&
		   n->in_vain >= 0.0 && isfinite(n->leaf_size) && n->leaf_size > 0.0f &&
		   n->block_level < n->depth && n->leaves > 0 && n->leaves <= INT32_MAX / 2 &&
		   n->facets > n->leaves && n->facets <= 2 * n->leaves + 1 &&
		   n->dark_facet <= GW_FACET_EMPTY + 1 && n->facet_rows > 0 && n->facet_rows <= n->facets &&
		   isfinite(n->wanted_leaf_size) &&
		   memchr(n->why_coarser, 0, sizeof n->why_coarser) != NULL &&
		   (uint64_t)n->tiles * 8 < UINT32_MAX && (uint64_t)n->leaf_tiles * 8 < UINT32_MAX;
}

void gw_transport_numbers_restore(const gw_transport_numbers *n, gw_scene *scene)
{
	gw_surfels *s = &scene->surfels;
	gw_octree *o = &scene->octree;
	scene->report->spacing_ratio = n->spacing_ratio;
	scene->density.in_vain = n->in_vain;
	scene->report->narrow_share = n->narrow_share;
	*s = (gw_surfels){ .count = (size_t)n->surfels,
					   .point_count = (size_t)n->points,
					   .stray_count = (size_t)n->strays,
					   .emission_alone = n->emits == 2,
					   .spacing = n->spacing,
					   .given_area = n->given_area,
					   .seen_from_above = (n->optional & FROM_ABOVE) != 0 };
	*o = (gw_octree){ .depth = n->depth,
					  .leaf_size = n->leaf_size,
					  .wanted_leaf_size = n->wanted_leaf_size,
					  .dark_facet = n->dark_facet,
					  .directory_level = n->directory_level,
					  .leaf_count = n->leaves,
					  .facet_count = n->facets,
					  .leaf_tile_count = n->leaf_tiles,
					  .tile_count = n->tiles,
					  .border_tile_count = n->border_tiles,
					  .fragment_count = n->fragments,
					  .tree_discs = (uint32_t)n->tree_discs,
					  .tree_nodes = (uint32_t)n->tree_nodes };
	memcpy(o->why_coarser, n->why_coarser, sizeof o->why_coarser);
	scene->records = (gw_records){ .count = n->records,
								   .spacing = n->record_spacing,
								   .radius = n->record_radius,
								   .block_level = n->block_level,
								   .block_count = n->block_count,
								   .block_tile_first = n->block_tile_first,
								   .row_count = n->facet_rows };
	scene->rays = (gw_ray_gather){ .rays = n->rays,
								   .seed = n->ray_seed,
								   .shut_out = n->apart & HITS_APART ? n->records : 0 };
	scene->portals =
		(gw_portals){ .looked = n->looked, .count = n->portals, .escaped = n->escaped };
	scene->check_tree = (gw_check_tree){
		.nodes = n->optional & CHECKED ? (uint32_t)gw_check_tree_nodes((size_t)n->surfels) : 0
	};
	scene->check_points =
		(gw_check_point_hits){ .count = n->check_points, .rays = n->check_point_rays };
	gw_probe_numbers_restore(&n->probes, &scene->probes);
	gw_space_numbers_restore(&n->space, &scene->space);
	scene->read_back = (gw_read_back){ .count = (size_t)n->surfels,
									   .parted = n->apart & ROWS_APART ? n->records : 0 };
	memcpy(s->origin, n->origin, sizeof n->origin);
	memcpy(s->minimum, n->minimum, sizeof n->minimum);
	memcpy(s->maximum, n->maximum, sizeof n->maximum);
	memcpy(o->cube_minimum, n->cube_minimum, sizeof n->cube_minimum);
	memcpy(&s->non_finite, n->repaired, sizeof n->repaired);
	memcpy(o->tile_first, n->tile_first, sizeof n->tile_first);
}

typedef struct list {
	gw_transport_block *block;
	size_t count;
} list;

/* An array on the host. */
static gw_transport_block *host(list *l, const char *name, void *array, uint64_t bytes)
{
	assert(l->count < GW_TRANSPORT_BLOCKS);
	gw_transport_block *block = &l->block[l->count++];
	*block = (gw_transport_block){ .name = name, .host = array, .bytes = bytes };
	return block;
}

/* The same, which is used where it lies, if it lies there well. */
static gw_transport_block *lent(list *l, const char *name, void *array, uint64_t bytes)
{
	gw_transport_block *block = host(l, name, array, bytes);
	block->stays = true;
	return block;
}

/* An array on the device, of vectors of four floats unless said otherwise. */
static gw_transport_block *device(list *l, const char *name, gw_buffer *buffer, uint64_t bytes)
{
	assert(l->count < GW_TRANSPORT_BLOCKS);
	gw_transport_block *block = &l->block[l->count++];
	*block = (gw_transport_block){
		.name = name, .buffer = buffer, .format = VK_FORMAT_R32G32B32A32_SFLOAT, .bytes = bytes
	};
	return block;
}

static void scalars(list *l, const char *name, gw_buffer *buffer, uint64_t bytes)
{
	device(l, name, buffer, bytes)->format = VK_FORMAT_R32_SFLOAT;
}

static void index_below(gw_transport_block *block, VkFormat format, uint64_t limit, uint32_t mask,
						uint32_t step)
{
	block->format = format;
	block->limit = limit;
	block->mask = mask;
	block->step = step;
}

static void words(list *l, const char *name, gw_buffer *buffer, uint64_t bytes, uint64_t limit)
{
	index_below(device(l, name, buffer, bytes), VK_FORMAT_R32_UINT, limit, UINT32_MAX, 1);
}

static void list_surfels(list *l, gw_scene *scene, const gw_transport_numbers *n)
{
	gw_surfels *s = &scene->surfels;
	uint64_t count = n->surfels;
	lent(l, "positions", &s->position, 12 * count);
	lent(l, "normals", &s->normal, 12 * count);
	if (n->optional & NOISY)
		lent(l, "shading normals", &s->shading_normal, 12 * count);
	if (n->optional & OFF)
		lent(l, "errors of normals", &s->shading_normal_off, 4 * count);
	lent(l, "albedo", &s->albedo, 12 * count);
	if (n->emits)
		lent(l, "emission", &s->emission, 12 * count);
	if (n->dark_facet)
		lent(l, "transparency", &s->transparency, 4 * count);
	lent(l, "distances", &s->nearest, 4 * count);
	lent(l, "radii", &s->radius, 4 * count);
	lent(l, "areas", &s->area, 4 * count);
	lent(l, "sides", &s->two_sided, count);
	if (n->optional & CUT)
		lent(l, "cuts", &s->clip, 24 * count);
	if (n->optional & BENT)
		lent(l, "bends", &s->bend, 12 * count);
	if (n->optional & CREASED)
		lent(l, "creases", &s->creased, count);
	if (n->optional & DOUBTED)
		lent(l, "doubts", &s->doubt, 4 * count);
	index_below(lent(l, "surfels of points", &s->surfel_of_point, 4 * n->points), 0, count,
				UINT32_MAX, 1);
	if (n->optional & POINTS_ALBEDO)
		lent(l, "albedo of points", &s->albedo_of_point, 12 * n->points);
	if (n->strays > 0)
		host(l, "strays", &s->stray, sizeof(gw_stray) * n->strays);
}

static void list_tree(list *l, gw_octree *o, const gw_transport_numbers *n)
{
	const VkFormat pair = VK_FORMAT_R32G32_UINT;
	const uint32_t level = n->directory_level;
	uint64_t cells = UINT64_C(1) << 3 * level, levels = ((cells << 3) - 1) / 7;
	uint64_t pointers = 1 + (uint64_t)(n->tiles > n->leaf_tiles ? n->tiles : n->leaf_tiles);
	words(l, "tree", &o->node, 32 * (uint64_t)n->tiles, pointers);
	device(l, "keys of tiles", &o->tile_key, 8 * (uint64_t)n->tiles)->format = pair;
	words(l, "neighbours", &o->tile_neighbour, 32 * (uint64_t)n->tiles, pointers);
	device(l, "keys of leaf tiles", &o->leaf_tile_key, 8 * (uint64_t)n->leaf_tiles)->format = pair;
	words(l, "leaf neighbours", &o->leaf_tile_neighbour, 32 * (uint64_t)n->leaf_tiles, pointers);
	index_below(device(l, "leaf tiles", &o->leaf_tile, 8 * (uint64_t)n->leaf_tiles), pair,
				n->facets, UINT32_MAX, 2);
	device(l, "cells", &o->leaf_cell, 16 * (uint64_t)n->leaves)->format =
		VK_FORMAT_R32G32B32A32_UINT;
	words(l, "directory of levels", &o->level_directory, 4 * levels, pointers);
	index_below(device(l, "directory of rays", &o->ray_directory, 4 * cells), VK_FORMAT_R32_UINT,
				pointers > 256 ? pointers : 256, INT32_MAX, 1);
}

static void list_compartments(list *l, gw_octree *o, const gw_transport_numbers *n)
{
	gw_compartments_array arrays[GW_COMPARTMENTS_ARRAYS];
	if (n->compartments.known != GW_COMPARTMENTS_SEVERAL)
		return;
	gw_compartments_list(o, (size_t)n->surfels, arrays);
	for (size_t i = 0; i < GW_COMPARTMENTS_ARRAYS; i++)
		index_below(host(l, arrays[i].name, arrays[i].array, arrays[i].bytes), 0,
					arrays[i].labels ? n->compartments.count : 0, UINT32_MAX, 1);
}

static void list_leaves(list *l, gw_octree *o, const gw_transport_numbers *n)
{
	uint64_t facets = 16 * (uint64_t)n->facets, surfels = 16 * n->surfels;
	if (n->optional & VOXELS)
		device(l, "geometry of leaves", &o->leaf_geometry, 32 * (uint64_t)n->leaves);
	index_below(device(l, "leaves of facets", &o->facet_leaf, 4 * (uint64_t)n->facets),
				VK_FORMAT_R32_UINT, n->leaves, GW_FACET_LEAF, 1);
	device(l, "planes of facets", &o->facet_plane, facets);
	device(l, "centroids of facets", &o->facet_centre, facets);
	device(l, "albedos of facets", &o->facet_albedo, facets);
	device(l, "emission of facets", &o->facet_emission, n->emits == 1 ? facets : 16);
	words(l, "fragments of leaves", &o->leaf_fragment, 4 * ((uint64_t)n->leaves + 1),
		  (uint64_t)n->fragments + 1);
	index_below(device(l, "surfels of fragments", &o->fragment_surfel, 4 * (uint64_t)n->fragments),
				VK_FORMAT_R32_UINT, n->surfels, GW_FRAGMENT_SURFEL, 1);
	scalars(l, "weights of fragments", &o->fragment_weight, 4 * (uint64_t)n->fragments);
	device(l, "places of surfels", &o->surfel_position, surfels);
	device(l, "normals of surfels", &o->surfel_normal, surfels);
	device(l, "discs of surfels", &o->surfel_disc, surfels);
	device(l, "edges of surfels", &o->surfel_clip, surfels);
	device(l, "tree of large discs", &o->disc_tree,
		   16 * gw_disc_tree_texels((uint32_t)n->tree_discs, (uint32_t)n->tree_nodes))
		->format = VK_FORMAT_R32G32B32A32_UINT;
}

static void list_records(list *l, gw_scene *scene, const gw_transport_numbers *n)
{
	gw_records *r = &scene->records;
	uint64_t facets = n->facets, hits = (uint64_t)n->rays * n->records;
	uint64_t rows = n->facet_rows;
	device(l, "record position", &r->position, 16 * (uint64_t)n->records);
	device(l, "record normal", &r->normal, 16 * (uint64_t)n->records);
	index_below(host(l, "facets of records", &r->facet, 4 * (uint64_t)n->records), 0, facets,
				~GW_RECORD_BACK, 1);
	gw_transport_block *row = device(l, "facet row", &r->facet_row, 4 * facets);
	index_below(row, VK_FORMAT_R32_UINT, n->facet_rows, UINT32_MAX, 1);
	row->all = true;
	index_below(device(l, "facet record", &r->facet_record, 4 * GW_WEIGHTS * rows),
				VK_FORMAT_R32G32B32A32_UINT, n->records, UINT32_MAX, 1);
	device(l, "facet weight", &r->facet_weight, 4 * GW_WEIGHTS * rows);
	words(l, "hit facet", &scene->rays.facet, 4 * hits, facets);
	scalars(l, "hit distance", &scene->rays.distance, 4 * hits);
	if (n->portals)
		device(l, "portals", &scene->portals.sphere, 16 * (uint64_t)n->portals);
	if (n->opened)
		words(l, "sky through portals", &scene->rays.through, 4 * (uint64_t)n->records,
			  WORDS_LIMIT);
	index_below(lent(l, "rows of surfels", &scene->read_back.first, 4 * (n->surfels + 1)), 0,
				(uint64_t)n->entries + 1, UINT32_MAX, 1);
	index_below(lent(l, "records of surfels", &scene->read_back.record, 4 * (uint64_t)n->entries),
				0, n->records, UINT32_MAX, 1);
	lent(l, "weights of surfels", &scene->read_back.weight, 4 * (uint64_t)n->entries);
	if (n->optional & ADDED) {
		host(l, "spacing of facets", &scene->density.facet_spacing, 4 * facets);
		host(l, "spacing of surfels", &scene->density.surfel_spacing, 4 * n->surfels);
	}
}

static void list_space(list *l, gw_scanned_space *space, const gw_space_numbers *n)
{
	if (n->cells[0] == 0)
		return;
	host(l, "space between surfels", &space->state, gw_space_cells_of(n));
	host(l, "cells of holes", &space->hole_cell, 8 * (uint64_t)n->hole_cells);
	if (n->solid > 0)
		host(l, "blocks of solids", &space->solid_block, gw_space_blocks_of(n));
}

static void list_check_tree(list *l, gw_scene *scene, const gw_transport_numbers *n)
{
	gw_check_tree *tree = &scene->check_tree;
	if (!(n->optional & CHECKED))
		return;
	gw_transport_block *order = lent(l, "tree of discs", &tree->surfel, 4 * n->surfels);
	index_below(order, 0, n->surfels, UINT32_MAX, 1);
	order->all = true;
	lent(l, "boxes of discs", &tree->node, sizeof *tree->node * (uint64_t)tree->nodes);
}

static void list_check_points(list *l, gw_scene *scene, const gw_transport_numbers *n)
{
	gw_check_point_hits *p = &scene->check_points;
	uint64_t gathers = GW_CHECK_POINT_GATHERS * (uint64_t)n->check_points,
			 hits = gathers * n->check_point_rays;
	if (n->check_points == 0)
		return;
	index_below(host(l, "points of the estimate", &p->point, 4 * (uint64_t)n->check_points), 0,
				n->surfels, UINT32_MAX, 1);
	index_below(host(l, "what they see", &p->facet, 4 * hits), 0, n->facets, UINT32_MAX, 1);
	host(l, "how far that is", &p->distance, 4 * hits);
	if (n->check_points_lit)
		host(l, "light of emitters there", &p->emitted, 16 * gathers);
}

static void list_probes(list *l, gw_scene *scene, const gw_transport_numbers *n)
{
	gw_probe_hits *h = &scene->probes.hits;
	const uint64_t probes = n->probes.count, size = n->probes.size;
	if (probes == 0)
		return;
	host(l, "places of probes", &h->place, 16 * probes);
	host(l, "free space about probes", &scene->probes.radius, 4 * probes);
	index_below(host(l, "what probes see", &h->facet, 4 * probes * size * size), 0,
				(uint64_t)n->facets + 1, UINT32_MAX, 1);
	host(l, "how far that is from them", &h->distance, 4 * probes * size * size);
}

size_t gw_transport_list(gw_scene *scene, const gw_transport_numbers *numbers,
						 gw_transport_block blocks[GW_TRANSPORT_BLOCKS])
{
	list l = { blocks, 0 };
	list_surfels(&l, scene, numbers);
	list_tree(&l, &scene->octree, numbers);
	list_compartments(&l, &scene->octree, numbers);
	list_leaves(&l, &scene->octree, numbers);
	list_records(&l, scene, numbers);
	list_space(&l, &scene->space, &numbers->space);
	list_check_tree(&l, scene, numbers);
	list_check_points(&l, scene, numbers);
	list_probes(&l, scene, numbers);
	if (numbers->light_samples)
		device(&l, "light of emitters", &scene->sampled, 16 * (uint64_t)numbers->records);
	if (numbers->optional & MOMENTS)
		device(&l, "moment of light of emitters", &scene->sampled_moment,
			   32 * (uint64_t)numbers->records);
	return l.count;
}
