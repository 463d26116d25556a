/*
 * octree_steps.h - the steps of building an octree, in the order of octree_build.c:
 *
 *   octree_fragments.c  surfels to the device; fragments, sorted by leaf
 *   octree_merge.c      fragments that are kept, merged with those of surfels that move
 *   octree_tiles.c      leaves, tiles of all levels with border tiles, pointers
 *   octree_leaves.c     what lies in each leaf; the directory of rays
 *   octree_numbers.c    the numbers of facets
 *   octree_large.c      the tree of discs that are too large for leaves
 *
 * Only these files include it. Every step frees what it took beyond its results when it succeeds;
 * gw_octree_build frees the rest when one fails.
 */
#ifndef OCTREE_STEPS_H
#define OCTREE_STEPS_H

#include "octree/octree.h"
#include "octree/octree_layout.h"
#include "device/radix_sort.h"

/* Sorted fragments on the CPU: low and high words of keys (high only where keys are wide),
 * surfels, weights, centroids. */
#define GW_FRAGMENT_WORDS 5u
typedef struct gw_fragment_list {
	uint32_t count;
	uint32_t *word[GW_FRAGMENT_WORDS]; /* count each, or NULL */
} gw_fragment_list;

/* What builds of surfels of which some stay have in common. */
struct gw_octree_kept {
	uint32_t depth;
	double leaf_size;       /* as of gw_octree_work */
	float wanted_leaf_size; /* as of gw_octree */
	char why_coarser[GW_OCTREE_WHY];
	gw_fragment_list still;
	gw_passes passes;
	gw_radix_sort sort;
};

/* A build on its way. */
typedef struct gw_octree_work {
	gw_gpu *gpu;
	const gw_surfels *surfels;
	gw_octree *octree;
	bool regions;         /* as of gw_octree_task */
	double leaf_size;     /* metres; leaves are at least this wide */
	uint64_t *too_many;   /* NULL, or receives how many fragments there are when the device takes
							 fewer: wider leaves are tried then */
	size_t still;         /* surfels whose fragments are kept: the first ones */
	gw_octree_kept *kept; /* NULL, or what they are kept in; not owned */
	size_t from, some;    /* surfels whose fragments are made: the first, and how many */
	gw_passes passes;
	gw_radix_sort sort;

	/* Of surfels, only while building. */
	gw_buffer surfel_albedo;   /* likewise: rgb, 0 */
	gw_buffer surfel_bend;     /* likewise: of its disc, per leaf cell; 0 */
	gw_buffer surfel_emission; /* likewise; one texel when nothing emits */
	gw_buffer surfel_offset;   /* count or first of its fragments */
	gw_buffer surfel_samples;  /* of its disc, that count */
	gw_buffer column_note;     /* GW_COLUMN_WORDS a surfel: which cells its disc meets */

	/* Of fragments, first in the order of surfels, then sorted. */
	gw_sort_list keys;
	gw_buffer fragment_place;    /* where the keys of fragments went, in the order of surfels */
	gw_buffer fragment_centroid; /* R32_UINT: three times 10 bits, place in the leaf */
	gw_buffer no_weight;         /* R32_SFLOAT, one: stands in where no weights are written */

	/* Keys, R32G32_UINT, by level of the cells. At level depth, cells are leaves. */
	gw_buffer real[GW_DEPTH_MAX + 1]; /* cells that hold leaves, or are some */
	uint32_t real_count[GW_DEPTH_MAX + 1];
	gw_buffer parent[GW_DEPTH_MAX + 1]; /* cells whose children are a tile, with border tiles */
	uint32_t parent_count[GW_DEPTH_MAX + 1];

	gw_buffer marks;              /* scratch of a search for distinct keys */
	gw_buffer first;              /* first element of each distinct key, its result */
	gw_sort_list list;            /* scratch of a level's tiles */
	gw_buffer seed;               /* of each leaf's reduction */
	gw_buffer ray_mark, distance; /* one word for each cell of the directory's level */
} gw_octree_work;

/* Bindings: a whole buffer, or a window of `stride` bytes an element. */
#define GW_WHOLE(address) ((gw_binding){ .buffer = (address) })
#define GW_WINDOW(address, bytes) ((gw_binding){ .buffer = (address), .stride = (bytes) })

/* Allocates a texel buffer of zeros. */
gw_status gw_octree_buffer(gw_octree_work *work, VkFormat format, uint64_t bytes, const char *name,
						   gw_buffer *buffer, gw_error *error);
/* The same without zeros, for a buffer of which every texel is written before any is read. */
gw_status gw_octree_buffer_unset(gw_octree_work *work, VkFormat format, uint64_t bytes,
								 const char *name, gw_buffer *buffer, gw_error *error);

/* One of several texel buffers to allocate. */
typedef struct gw_octree_part {
	gw_buffer *buffer;
	VkFormat format;
	uint64_t bytes;
	const char *name;
} gw_octree_part;

gw_status gw_octree_buffers(gw_octree_work *work, const gw_octree_part *parts, size_t count,
							gw_error *error);

/*
 * Picks the cube and uploads the surfels: fills depth to directory_level, surfel_position,
 * surfel_normal, surfel_disc and surfel_clip of the octree, and surfel_bend of the work.
 */
gw_status gw_octree_upload(gw_octree_work *work, uint32_t depth, gw_error *error);
/* Frees surfel_disc and surfel_clip, which facets are made without, and which take up much where
 * the memory is needed most; and makes them again. */
void gw_octree_forget_discs(gw_octree_work *work);
gw_status gw_octree_upload_discs(gw_octree_work *work, gw_error *error);
/* surfel_albedo and surfel_emission, which only facets need: they come when fragments are sorted,
 * which takes the most memory. */
gw_status gw_octree_upload_colours(gw_octree_work *work, gw_error *error);
/* Only places and normals of the surfels, which is all that lamps shine on. */
gw_status gw_octree_upload_lit(gw_octree_work *work, uint32_t depth, gw_error *error);

/* Frees what gw_octree_upload and gw_octree_count_fragments made. */
void gw_octree_forget_upload(gw_octree_work *work);

/* The most fragments whose lists a device takes. */
uint64_t gw_octree_most_fragments(gw_gpu *gpu);

/* Counts the fragments of each of work's some surfels; *total may be 2^32 or more. */
gw_status gw_octree_count_fragments(gw_octree_work *work, uint64_t *total, gw_error *error);

/* Writes and sorts the keys of fragments, and where each went. */
gw_status gw_octree_sort_fragments(gw_octree_work *work, gw_error *error);

/* Writes the rest where the keys are: fragment_surfel, fragment_weight, fragment_centroid. */
gw_status gw_octree_write_fragments(gw_octree_work *work, gw_error *error);

/* Whether keys have a high word. */
bool gw_octree_is_wide(const gw_octree_work *work);

/* Takes keys and what gw_octree_write_fragments made to the host; list is empty on failure. */
gw_status gw_octree_fetch_fragments(gw_octree_work *work, gw_fragment_list *list, gw_error *error);
void gw_fragment_list_clear(gw_fragment_list *list);

/* Puts two lists together as if they had been sorted as one, surfels of `still` before those of
 * `moving`, and back on the device. Fails when they do not fit there. */
gw_status gw_octree_merge_fragments(gw_octree_work *work, const gw_fragment_list *still,
									const gw_fragment_list *moving, gw_error *error);

/* A sorted list of keys. */
typedef struct gw_key_list {
	gw_buffer *keys, *high; /* R32G32_UINT and NULL; or R32_UINT and the high words, in a list that
							   is split */
	uint32_t count;
	uint32_t shift; /* 0, or 3: their parents' keys are meant */
} gw_key_list;

/* The leaves that sorted fragments lie in, of which no keys are left then. */
gw_status gw_octree_find_leaves(gw_octree_work *work, gw_error *error);

/* Tiles, pointers, level_directory, leaf_cell. */
gw_status gw_octree_make_tiles(gw_octree_work *work, gw_error *error);

/* Geometry, facets, ray_directory. */
gw_status gw_octree_reduce_leaves(gw_octree_work *work, gw_error *error);

/* Numbers facets, now that seeds say which leaves have two: facet_count, dark_facet, facet_leaf,
 * and what leaf tiles say of it. On the host, which does it in one go. */
gw_status gw_octree_number_facets(gw_octree_work *work, gw_error *error);

/* The largest radius of discs that leaves hold, leaf cells; larger ones are in the tree. */
float gw_octree_disc_most(const gw_surfels *surfels);

/* tree_discs, tree_nodes, disc_tree. */
gw_status gw_octree_plant_discs(gw_octree_work *work, gw_error *error);

#endif
