/*
 * transport_layout.h - push-constant blocks of the light transport passes, shared by C and GLSL.
 *
 * Lengths are in leaf cells and positions in grid coordinates unless said otherwise. Every block
 * starts with the span that the device layer fills (gpu.h).
 */
#ifndef TRANSPORT_LAYOUT_H
#define TRANSPORT_LAYOUT_H

#include "base/shared_types.h"
#include "octree/trace_constants.h"

/* Records that a facet's irradiance is interpolated from, at most. */
#define GW_WEIGHTS 8u

/* Records that a surfel's light is interpolated from, at most: records stand a spacing apart and
 * reach 1.6 spacings, so that about 7 speak for a place on a surface. */
#define GW_SURFEL_WEIGHTS 32u

/* Added to the facet of a record that stands on its back. */
#define GW_RECORD_BACK 0x80000000u

/* Marks of compartments of empty space: 0 where it is not known. */
#define GW_MARK_OUTSIDE 1.0f /* what lies around the scene */

/* Light counts for how irradiance changes with the normal at most as that at this tangent of an
 * angle to the normal does (63 degrees); so normals that turn by as little as its inverse as a sine
 * (30 degrees) never receive less than nothing. */
#define GW_TANGENT_MOST 2.0f

/* Samples of emitters that are compared with each other, to ask of those that matter whether they
 * are seen. */
#define GW_EMITTER_BATCH 64u

/* Samples of the portals that a record takes: one bit each of a word. */
#define GW_PORTAL_SAMPLES 32u

/* Cells of a radiance volume that a place takes light from, at most. */
#define GW_VOLUME_WEIGHTS 8u

/* Faces of a cell: towards -x, +x, -y, +y, -z and +z. */
#define GW_CELL_FACES 6u

/* Added to the facet that sends into a cell from its back. */
#define GW_SENDS_BACK 0x80000000u

/* What a ray of a cell met first, where that is asked, if no facet's front. */
#define GW_VOLUME_MET_BACK 0x80000000u
#define GW_VOLUME_MET_NOTHING 0x7fffffffu

/* Values of gw_light_push.type. */
#define GW_PUSH_POINT 0u
#define GW_PUSH_SPOT 1u
#define GW_PUSH_SUN 2u
#define GW_PUSH_SPHERE 3u /* from here on lights that are areas */
#define GW_PUSH_DISC 4u
#define GW_PUSH_RECTANGLE 5u

/* Added to a visibility, which is at most 1, where what hides the light ends at a crease. Where
 * something else hides a light of no extent, the visibility is minus how many times as far off as
 * that the shadow's edge is, at most GW_FURTHER_MOST. */
#define GW_HIDDEN_BY_CREASE 2.0f
#define GW_FURTHER_MOST 16.0f

/* The share of the light that a visibility says is seen. */
#define GW_SHARE_SEEN(visibility)                                                                  \
	((visibility) < 0.0f                   ? 0.0f                                                  \
	 : (visibility) >= GW_HIDDEN_BY_CREASE ? (visibility)-GW_HIDDEN_BY_CREASE                      \
										   : (visibility))

/* One light, for its visibility and its irradiance. */
SHARED_STRUCT(gw_light_push)
{
	uint first, count;
	uint type;
	uint samples;   /* shadow rays a point: 1 for a sharp shadow */
	vec4 position;  /* grid coordinates; w: radius */
	vec4 direction; /* unit, the way light travels; w: tangent of the sun's angular radius */
	vec4 intensity; /* intensity / leaf_size^2, or irradiance; w: unused */
	float cos_inner, cos_outer;
	uint seed;
	uint shadows; /* 1: multiply by the visibility buffer */
	vec4 across;  /* unit, at right angles to direction: where angles around it count from; w: half
					 the width of a rectangle that way */
	uint verticals, horizontals; /* of the distribution of the intensity; 0: there is none */
	float half_height;           /* of a rectangle, across the other two */
	uint unused;
};
SHARED_SIZE(gw_light_push, 112);
SHARED_OFFSET(gw_light_push, position, 16);
SHARED_OFFSET(gw_light_push, direction, 32);
SHARED_OFFSET(gw_light_push, intensity, 48);
SHARED_OFFSET(gw_light_push, cos_inner, 64);
SHARED_OFFSET(gw_light_push, shadows, 76);
SHARED_OFFSET(gw_light_push, across, 80);

/* Records: rays, samples of emitters, gathers. */
SHARED_STRUCT(gw_record_push)
{
	uint first, count;
	uint rays;          /* gather rays a record, K */
	uint light_samples; /* samples of the emitters a record, M */
	uint batch_first;   /* of the light samples taken in this run */
	uint batch_count;
	uint emitters; /* entries of the emitter table */
	uint seed;
	float emitter_power; /* sum over emitters of luminance(Le) * area, leaf cells^2 */
	float spacing;       /* record spacing */
	float direct_share;  /* shade: how much of the facets' direct irradiance is added */
	uint use_hits;       /* first gather: emitters seen by rays count (by the balance heuristic) */
	vec4 sky;            /* radiance of the environment */
	uint sky_width, sky_height; /* of the map; 0: there is none */
	uint sky_samples;           /* of the map, a record */
	uint sky_hits;              /* first gather: rays that leave the scene see the map as well */
	float sky_total;            /* its luminance, summed over solid angle */
	float sky_turn;             /* of its centre, in turns clockwise from y */
	uint sky_y_up;
	uint looked;  /* first gather: what lies nearest and who is buried is known */
	uint portals; /* to the sky, of which a record takes GW_PORTAL_SAMPLES samples; 0: none */
	uint moments; /* 1: how irradiance changes with the normal is gathered, too */
	float share;  /* adding: what is added is multiplied by this */
	uint unused;
};
SHARED_SIZE(gw_record_push, 112);
SHARED_OFFSET(gw_record_push, sky, 48);
SHARED_OFFSET(gw_record_push, sky_total, 80);

/* Rays of records that keep their hits, or are traced again. */
SHARED_STRUCT(gw_keep_push)
{
	uint first, count;
	uint rays; /* a record */
	uint seed;
	uint boxes; /* around what has changed */
};
SHARED_SIZE(gw_keep_push, 20);

/* Elements that one invocation adds up, and values of gw_sum_push.kind. */
#define GW_SUM_RUN 64u
#define GW_SUM_FACETS 0u  /* luminance times area, leaf cells^2, that facets send out */
#define GW_SUM_RECORDS 1u /* the same, that the irradiance of records makes them send out */
#define GW_SUM_PARTS 2u   /* sums that were made before */

/* Adding up light. */
SHARED_STRUCT(gw_sum_push)
{
	uint first, count;
	uint kind;
	uint total;  /* of what is added up */
	uint parts;  /* that are made of it, one every so many elements */
	uint source; /* first of the parts that are added up */
	uint target; /* and of those that are made */
};
SHARED_SIZE(gw_sum_push, 28);

/* Probes and what they see. */
SHARED_STRUCT(gw_probe_push)
{
	uint first, count;
	uint rays; /* places or directions a probe */
	uint seed;
	float orientation, distance; /* weights of the cosine and of the distance */
	float reach;                 /* distance from which on more is no better */
	uint unused;
};
SHARED_SIZE(gw_probe_push, 32);

/* Finding records near a point. */
SHARED_STRUCT(gw_lookup_push)
{
	uint first, count;
	uint block_level;  /* octree level of the blocks that records are listed by */
	float radius;      /* of influence of a record, R */
	float ray_offset;  /* both ends of a visibility test are moved this far off the surface */
	uint visibility;   /* 1: test it where a record's surroundings are nearer than the point */
	uint tile_first;   /* first tile whose parent cells are of block_level */
	uint surfel_first; /* of the surfels looked at in this run */
	uint own_reach;    /* 1: points look as far as a buffer says, not `radius` */
};
SHARED_SIZE(gw_lookup_push, 36);

/* Cones and the brick pools. */
SHARED_STRUCT(gw_cone_push)
{
	uint first, count;
	uint cones;
	uint seed;
	uint level;           /* mipmap: of the tiles that are filled; leaf level = depth */
	uint tile_first;      /* mipmap: first tile of that level */
	uint from_leaves;     /* mipmap: 1 when the children's bricks are in the leaf pool */
	float scale;          /* radiance is stored times this, so that half floats hold it */
	uint leaf_bricks[2];  /* bricks a row and rows a layer of the leaf pool */
	uint mip_bricks[2];   /* of the mipmap pool */
	uint leaf_face_depth; /* texels in z from one face's layer stack to the next, leaf pool */
	uint mip_face_depth;
	float gain;  /* over-coverage of a leaf's faces */
	float start; /* leaf cells along the normal where a cone starts */
	vec4 sky;
	vec4 eye; /* pixels: where it is, grid coordinates; w: 1 to sample tricubically */
	uint sky_width, sky_height; /* pixels: of the map, as gw_record_push has it */
	float sky_turn;
	uint sky_y_up;
	/* One of several compartments gathers: only records with its mark, from what faces it; a mark
	 * of 0 faces, and is faced by, any. 0: all do. */
	uint apart;
	uint mark;
	uint unused[2];
};
SHARED_SIZE(gw_cone_push, 128);
SHARED_OFFSET(gw_cone_push, apart, 112);
SHARED_OFFSET(gw_cone_push, scale, 28);
SHARED_OFFSET(gw_cone_push, sky, 64);
SHARED_OFFSET(gw_cone_push, eye, 80);
SHARED_OFFSET(gw_cone_push, sky_width, 96);

/* A radiance volume: rays of its cells, their spherical harmonics, places that read them. */
SHARED_STRUCT(gw_volume_push)
{
	uint first, count;
	uint rays; /* a cell */
	uint seed;
	vec4 minimum; /* grid coordinates of the corner of cell (0, 0, 0); w: side of a cell */
	uint columns, rows, layers; /* cells along x, y, z */
	uint terms;                 /* spherical harmonics a cell: 4 or 9 */
	vec4 sky;                   /* even radiance of the environment */
	uint sky_width, sky_height; /* of the map, as gw_record_push has it */
	float sky_turn;
	uint sky_y_up;
	uint looking;     /* rays: 1: what each met first, in place of the facet */
	uint place_first; /* of the places looked at in this run */
	uint marked;      /* places have marks of their compartments */
	float most;       /* irradiance that no place can have more of */
	uint both_sides;  /* places whose normal's w is above 0.5 are lit from both sides */
	uint batch_first; /* of what surface sends into each cell, in this run */
	uint batch_count;
	uint unused;
};
SHARED_SIZE(gw_volume_push, 112);
SHARED_OFFSET(gw_volume_push, minimum, 16);
SHARED_OFFSET(gw_volume_push, sky, 48);
SHARED_OFFSET(gw_volume_push, looking, 80);

/* What pixels see reflected. */
SHARED_STRUCT(gw_pixel_push)
{
	uint first, count;
	uint rays; /* a pixel whose surface is rough; a mirror takes one */
	uint seed;
	uint pixel_first;           /* number of the first pixel of this batch */
	uint ray;                   /* that this run adds */
	vec4 eye;                   /* grid coordinates */
	vec4 sky;                   /* even radiance of what rays see that meet nothing */
	uint sky_width, sky_height; /* of the map, as gw_record_push has it */
	float sky_turn;
	uint sky_y_up;
};
SHARED_SIZE(gw_pixel_push, 80);
SHARED_OFFSET(gw_pixel_push, eye, 32);
SHARED_OFFSET(gw_pixel_push, sky, 48);
SHARED_OFFSET(gw_pixel_push, sky_width, 64);

#endif
