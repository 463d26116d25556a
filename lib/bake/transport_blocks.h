/*
 * transport_blocks.h - the numbers and arrays of a scene that its bytes hold, see transport.h.
 */
#ifndef TRANSPORT_BLOCKS_H
#define TRANSPORT_BLOCKS_H

#include "bake/scene.h"
#include "octree/compartments_kept.h"
#include "surfels/space_kept.h"

/* The numbers of a scene, at fixed places and of fixed size. */
typedef struct gw_transport_numbers {
	double origin[3], given_area;
	double spacing_ratio, narrow_share; /* of gw_report */
	double in_vain;                     /* of gw_record_density */
	float minimum[3], maximum[3], cube_minimum[3];
	float spacing, leaf_size, record_radius, record_spacing;
	uint64_t surfels, points;
	uint64_t repaired[8]; /* gw_surfels.non_finite and following */
	uint64_t tree_discs, tree_nodes, strays;
	uint32_t depth, directory_level, leaves, facets, leaf_tiles, tiles, border_tiles, fragments;
	uint32_t tile_first[GW_DEPTH_MAX + 2];
	uint32_t records, block_level, block_count, block_tile_first, rays, ray_seed;
	uint32_t facet_rows;      /* of gw_records */
	uint32_t entries;         /* of the way back from the records */
	uint32_t emits;           /* 1: of surfels and facets, 2: of surfels alone */
	uint32_t light_samples;   /* whose light is kept; 0: none are */
	uint32_t looked, portals; /* to the sky: whether they were looked for, how many there are */
	uint32_t opened;          /* 1: they were sampled from the records */
	float escaped;
	uint32_t optional; /* bits: 1 given normals are there besides smooth ones, 2 and their errors,
						  4 albedo of points that share surfels, and others */
	uint32_t check_points,
		check_point_rays;      /* points whose error was estimated, and rays of a gather there */
	uint32_t check_points_lit; /* 1: what emitters brought them is kept */
	uint32_t dark_facet;       /* of gw_octree; 0: all is opaque */
	float wanted_leaf_size;    /* likewise, as the next */
	char why_coarser[GW_OCTREE_WHY];
	gw_probe_numbers probes; /* that were placed */
	gw_compartments_numbers compartments;
	uint32_t apart; /* 1: no row has a record of another compartment than its own, 2: nor a ray hit
					   surface of one */
	gw_space_numbers space; /* between the surfels */
} gw_transport_numbers;

/* One array. */
typedef struct gw_transport_block {
	const char *name;
	void **host;       /* where the array on the host is, or */
	gw_buffer *buffer; /* the one on the device, of this format */
	VkFormat format;
	uint64_t bytes;
	uint64_t limit; /* of arrays of indices: they are below this or GW_NONE; 0: no such array */
	uint32_t mask;  /* bits of a word that are the index */
	uint32_t step;  /* in words, from one index to the next */
	bool all;       /* GW_NONE is none of them */
	bool stays;     /* of the host: never written to, and may be somebody else's */
} gw_transport_block;

/* As many as a scene has in which all is there that one may have (76), and some. */
#define GW_TRANSPORT_BLOCKS 80u

gw_transport_numbers gw_transport_numbers_of(const gw_scene *scene);

/* Whether these numbers can be those of a scene: no size overflows, no count is absurd. */
bool gw_transport_numbers_fit(const gw_transport_numbers *numbers);

/* Whether leaves have what grids of voxels are made of. */
bool gw_transport_has_voxels(const gw_transport_numbers *numbers);

/* Stores the numbers in a scene without arrays. */
void gw_transport_numbers_restore(const gw_transport_numbers *numbers, gw_scene *scene);

/* Lists the arrays that a scene of these numbers has; returns how many there are. */
size_t gw_transport_list(gw_scene *scene, const gw_transport_numbers *numbers,
						 gw_transport_block blocks[GW_TRANSPORT_BLOCKS]);

#endif
