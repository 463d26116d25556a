/*
 * disc_tree.h - discs in a bounding volume hierarchy, and rays against them, on the CPU.
 *
 * The octree's leaves have one width; surface that is sampled much more coarsely than that lives
 * here. The tree knows nothing of octrees: lengths are in any unit, the same for discs and rays.
 *
 * It is one array of words, four to a texel, which disc_tree.glsl walks: from near to far, so that
 * what lies behind a disc that is hit is not looked at. Texel 0 is the header: the numbers of nodes
 * and of discs. Then GW_DISC_TEXELS a disc: place and radius; normal and facet; first clip and
 * number; second clip and 0; bend and 0. Then GW_DISC_NODE_TEXELS a node, which has up to four
 * children: their boxes, each texel one coordinate of all four, low and high x, y and z; and for
 * each the number of a node, above its own, or GW_DISC_LEAF and the first texel of a disc, or
 * GW_NONE.
 */
#ifndef DISC_TREE_H
#define DISC_TREE_H

#include "base/shader_math.h"
#include "cloud/surfels.h"

#include <stdbool.h>
#include <stddef.h>

/* A disc: as a surfel has it (surfels.h). */
typedef struct gw_disc {
	gw_vec3 place, normal; /* unit normal; rays meet the side that it points to */
	float radius;
	float clip[6];  /* two half-planes that cut it, in the frame of gw_tangent_frame */
	float bend[3];  /* per unit of length */
	uint32_t facet; /* whatever the caller wants to know of a disc that is hit */
} gw_disc;

/* How discs are made of surfels. */
typedef struct gw_disc_shape {
	double scale;     /* units a metre */
	double origin[3]; /* where 0 lies, metres in the surfels' frame */
	double widen;     /* factor of the radius; clips stay where they are */
	bool uncut;       /* without clips */
	bool flat;        /* without bend */
} gw_disc_shape;

/* The disc of a surfel; its facet is the surfel. */
gw_disc gw_disc_of_surfel(const gw_surfels *surfels, size_t surfel, const gw_disc_shape *shape);

typedef struct gw_disc_tree {
	uint32_t discs, nodes; /* 0: it is empty, and rays meet nothing; there are fewer nodes than
							  discs, but of one disc one */
	size_t texels;
	uint32_t *word; /* 4 * texels; NULL when empty */
} gw_disc_tree;

/*
 * Builds a tree.
 *   discs   count of them; no longer needed afterwards
 *   tree    on success to be cleared with gw_disc_tree_clear; empty on failure
 * Fails with GW_ERROR_MEMORY. The same discs give the same tree.
 */
gw_status gw_disc_tree_build(const gw_disc *discs, size_t count, gw_disc_tree *tree,
							 gw_error *error);
void gw_disc_tree_clear(gw_disc_tree *tree);

/* Texels of such a tree; 1 when there are no discs. */
uint64_t gw_disc_tree_texels(uint32_t discs, uint32_t nodes);

/*
 * Whether words from a file are a tree of so many discs and nodes whose walk ends and stays within
 * it.
 *   word     4 * gw_disc_tree_texels(discs, nodes)
 *   facets   numbers of facets are below this
 */
bool gw_disc_tree_fits(const uint32_t *word, uint32_t discs, uint32_t nodes, uint64_t facets);

/* One ray. */
typedef struct gw_disc_ray {
	gw_vec3 origin, direction; /* unit */
	gw_vec3 facing, foot;      /* of the surface that it leaves: normal, and a place on it */
	float t_max;
	bool both_sides; /* backs of discs stop it */
} gw_disc_ray;

typedef struct gw_disc_hit {
	uint32_t disc;  /* number of the disc, or GW_NONE */
	uint32_t facet; /* of the disc, or GW_NONE */
	float t;        /* t_max when nothing is hit */
	float yields;   /* what of finer surface a ray meets up to here takes precedence: t and a bit
					   more, or t_max */
	float nearest_back_face; /* distance to the nearest back of a disc before t_max, or t_max */
} gw_disc_hit;

/*
 * The nearest disc that the ray meets before t_max; where several lie about as near, as those of
 * one surface do, about the one whose centre is nearest, and of equals the first. Within
 * GW_DISC_NEAR of a disc's radii from its start a ray meets the surface that it leaves: there backs
 * of discs are not seen, and fronts only of discs whose centre rises above that surface.
 * Thread-safe.
 */
#ifdef __cplusplus
extern "C"
#endif
	gw_disc_hit
	gw_disc_tree_trace(const gw_disc_tree *tree, const gw_disc_ray *ray);

/*
 * The nearest disc that a segment crosses, from whichever side: for discs of which nobody knows yet
 * what side is their front. Discs are taken as flat and uncut.
 *   from    unit direction and where the segment starts
 *   length  of the segment; receives the distance to the disc that is crossed
 *   leaves  a disc whose sheet the segment leaves, or NULL: within its radius, those that go on in
 *           its plane are not crossed
 * Returns the disc's facet, or GW_NONE. Thread-safe.
 */
typedef struct gw_disc_start {
	gw_vec3 origin, direction;
} gw_disc_start;
uint32_t gw_disc_tree_cross(const gw_disc_tree *tree, const gw_disc_start *from,
							const gw_disc *leaves, float *length);

#endif
