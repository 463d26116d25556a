/*
 * trace_constants.h - numbers by which rays are traced and samples drawn, the same for passes and
 * for the CPU loops that stand in for them.
 */
#ifndef TRACE_CONSTANTS_H
#define TRACE_CONSTANTS_H

/* A facet, record or surfel that there is not. */
#define GW_NONE 0xffffffffu

/* Cells that a ray visits, at most. */
#define GW_WALK_STEPS 4096u

/* Within so many leaf cells of its start a ray may meet the surface that it leaves; planes that
 * rise less than that height over it are its own. */
#define GW_NEAR 2.0f
#define GW_NEAR_HEIGHT 0.1f

/* Of that height, what a plane across that surface needs; and what one like its other side does:
 * less than one like itself, as a ring begins to rise over the floor where it lies on it. */
#define GW_LIKE_LEAST 0.1f
#define GW_LIKE_OTHER 0.75f

/* Leaf cells by which planes reach beyond their cells for rays that come from in front: surface
 * that cuts off but a corner of a cell may leave nothing in it. For rays from behind it is less,
 * since planes that stick out over convex edges would shadow what lies before them. */
#define GW_PLANE_FRONT_OVERLAP 0.5f
#define GW_PLANE_BACK_OVERLAP 0.05f

/* Facets with at least this cosine between their normals are pieces of one surface; a ray that has
 * left one goes on along it within so many cells. */
#define GW_LIKE_COSINE 0.5f
#define GW_GAP_MOST 1.75f

/* Leaf cells: how far noise may put a point behind a surface that meets its own; and how far each
 * of two facets lies in front of the other where they meet as a floor and a wall do. */
#define GW_NOISE_DEPTH 0.25f
#define GW_CONCAVE_HEIGHT 0.02f

/* Leaf cells: a ray may pass between two discs that were cut at the same crease. */
#define GW_DISC_OVERLAP 0.02f

/* Discs of a leaf that a ray out of the scene passes beside: radii, squared, within which they stop
 * it in voids of a surface, and in corners where two surfaces meet; the largest cosine between the
 * normals of such; and leaf cells by which one may lie behind the other for noise. */
#define GW_VOID_REACH_SQUARED 1.5625f
#define GW_CORNER_REACH_SQUARED 2.25f
#define GW_ACROSS_COSINE 0.6f
#define GW_CONCAVE_DOUBT 0.05f

/* Leaves with more fragments than this, which much coarser octrees have, count as covered. */
#define GW_DISC_FRAGMENTS 256u

/* Inside a surface the densities of the discs at a place add up to about 1. Where one of some eight
 * is alone, it sticks out over a ridge, and there is no surface. */
#define GW_COVER_LEAST 0.2f

/* Radii of a disc: a place that lies further in front of it is not on its surface. Radii^2 about
 * its middle: of its inner part, to most of which no other disc is nearer. Leaf cells: what bends
 * away beneath a place lies there, if not in its leaf. */
#define GW_STICK_OUT 0.01f
#define GW_INNER_SQUARED 0.25f
#define GW_BENEATH 0.6f

/* A place has discs all around it when so many of eight half-planes hold one. */
#define GW_SEEN_AROUND 7
#define GW_SQRT_HALF 0.70710678f

/* Two cuts leave no less of a disc than this. */
#define GW_SHARE_LEAST 0.05f

/* Of a tree of discs: texels of a disc and of a node; what says that a child is a disc; nodes that
 * a ray visits, at most; levels of halving, and so levels of nodes, each of which leaves at most
 * three children waiting. */
#define GW_DISC_TEXELS 5u
#define GW_DISC_NODE_TEXELS 7u
#define GW_DISC_LEAF 0x80000000u
#define GW_DISC_STEPS 16384u
#define GW_DISC_HALVINGS 40u
#define GW_DISC_WAITING 60u

/* A ray meets a bent disc within this times its radius, squared, of its centre. */
#define GW_DISC_REACH_SQUARED 1.1f

/* Radii of a disc: how near a ray's start it may be one of the surface that the ray leaves; how far
 * above that surface its centre has to lie to be none; and how far it reaches beyond its cuts, so
 * that no ray passes between two discs that were cut at the same crease. */
#define GW_DISC_NEAR 1.25f
#define GW_DISC_HEIGHT 0.02f
#define GW_CUT_OVERLAP 0.02f

/* Of the discs of one surface that a ray meets the one is taken whose centre is nearest: they count
 * as dished, by this share of the radius at the rim. Finer surface takes precedence over them where
 * it lies up to so much, and this share of the radius, behind. Seen at least at this sine. */
#define GW_DISC_DISH 0.1f
#define GW_DISC_YIELD 0.02f
#define GW_DISC_GRAZING 0.05f

/* Rays to the rim of a light. The outermost points of the spiral lie less than a quarter of a turn
 * apart, so that a straight edge that all of them miss cuts at most 9 % off the disc. */
#define GW_LIGHT_RIM 5u

/* Leaf cells^2: a facet with more area than planes have in a cell is one of large discs. */
#define GW_FACET_LARGE 8.0f

/* Surface that lets light through: a ray passes so many sheets at most, and stops where no more
 * than that share of it is left. What faces alike is of the same sheet within so many leaf cells of
 * where a ray has passed that, measured across it, or so many of the points' spacings there. */
#define GW_SHEETS_MOST 128u
#define GW_THROUGH_LEAST 1e-3f
#define GW_SHEET_CELLS 1.0f
#define GW_SHEET_SPACINGS 1.5f

/* And near its start a ray meets backs of what lies so many leaf cells over that at least, and the
 * distance between points there. */
#define GW_OVER_CELLS 0.5f

/* What w of the albedo of a facet that is foliage is, without its clear share, which all foliage
 * has: its area is so much more than that of its leaves. In cells that have other surface, too, it
 * weighs so little that it does not turn or move that, unless the facet is all foliage. */
#define GW_FACET_FOLIAGE 3.0f
#define GW_FOLIAGE_CLEAR 0.5f
#define GW_FOLIAGE_WEIGHT 1e-3f

/* Set the random numbers of a record's samples apart from those of its rays. */
#define GW_EMITTER_SEED 0x68bc21ebu
#define GW_ROULETTE_SEED 0x5bd1e995u
#define GW_SKY_SEED 0x5851f42du
#define GW_OPACITY_SEED 0x3c6ef372u

#endif
