/*
 * glowworm_probes.h - public interface of libglowworm for radiance probes: places in the free space
 * of a lit scene, few enough and such that together they see its surface, and maps of what each of
 * them sees (Wang 2018, Automatic Placement of Radiance Probes).
 *
 * It reads and writes no files either. What is not said otherwise is as in glowworm.h.
 */
#ifndef GLOWWORM_PROBES_H
#define GLOWWORM_PROBES_H

#include "glowworm.h"

#ifdef __cplusplus
extern "C" {
#endif

#ifdef __GNUC__
#pragma GCC visibility push(default)
#endif

/* Texels a side of a probe's maps: powers of two between these. */
#define GW_PROBE_SIZE_LEAST 4u
#define GW_PROBE_SIZE_MOST 1024u

/* Probes a side of a regular grid, at most. */
#define GW_PROBE_GRID_MOST 64u

/* Distance in directions in which nothing is, metres: the largest number that a 16-bit float holds.
 * Longer distances count as that. */
#define GW_PROBE_FAR 65504.0f

/* Numbers of a channel that stand for what comes from all directions: three bands. */
#define GW_PROBE_HARMONICS 9

typedef struct gw_probes_options {
	uint32_t size;  /* texels a side of a map, see GW_PROBE_SIZE_LEAST */
	uint32_t count; /* probes at most; 0: until they see all that any place for one sees */
	uint32_t moves; /* how often Gibbs sampling tries to move one, so that fewer do, or see better;
					   0: never */
	uint32_t grid;  /* 0; or probes a side of a regular grid over the bounds, at the middles of its
					   cells, in place of chosen ones; those at surface or behind it are left out */
	float margin;   /* metres, at least 0: how far outside the bounds of the points they may be */
	uint64_t seed;  /* of all random numbers */
} gw_probes_options;

/* 64 texels, as many probes as it takes, 100 moves, no margin, seed 1. */
gw_probes_options gw_probes_options_default(void);

typedef struct gw_probe {
	double position[3];      /* metres, in the coordinates of gw_points.position */
	float radius;            /* metres to the nearest point: a ball that is free */
	float nearest, farthest; /* metres: of the surface that is seen; 0 where none is */
	/* Radiance by real spherical harmonics, orthonormal, band by band: 1, y, z, x, xy, yz, 3z^2 -
	 * 1, xz, x^2 - y^2; red, green and blue of each. The first four are those of two bands alone.
	 */
	float harmonic[GW_PROBE_HARMONICS][3];
} gw_probe;

/* Of how many probes a cell knows. */
#define GW_PROBES_OF_CELL 4

/*
 * Which probes serve a place: a grid of cubes over the bounds of the probes, 64 along their longest
 * side. A probe sees a cell if nothing lies before its middle, but for what lies in the cell
 * itself; of those that do the nearest are best (Wang 2018, section 4.2.2, empty voxels).
 */
typedef struct gw_probe_cells {
	size_t count;   /* cells that any probe sees */
	int32_t *cell;  /* 3 * count */
	int32_t *probe; /* GW_PROBES_OF_CELL * count: numbers of probes, the best first; -1: no more */
	double
		origin[3]; /* of the corner of cell 0, metres, in the coordinates of gw_points.position */
	double size;   /* of a cell, metres */
} gw_probe_cells;

/*
 * Probes, and their octahedral maps: size * size texels each, rows one behind the other, all of one
 * probe before the next. With u to the right and v down from -1 to 1, the middle of a texel is seen
 * in the direction of (u, v, 1 - |u| - |v|), or where that z is below 0 in that of
 * ((1 - |v|) sign(u), (1 - |u|) sign(v), z).
 */
typedef struct gw_probes {
	size_t count;
	uint32_t size;
	gw_probe *probe;
	float *radiance; /* 3 a texel: of the surface there, or of the sky */
	float *normal;   /* 3 a texel: of that surface, towards the probe; 0 where there is none */
	float *distance; /* a texel, metres along its direction; GW_PROBE_FAR where there is none */
	/* Smallest and largest distances below each texel of smaller maps, of half the size, a quarter
	 * and so on to one texel: (size * size - 1) / 3 a probe. */
	float *least, *greatest;
	gw_probe_cells cells;
	double minimum[3], maximum[3]; /* metres: where probes may stand */
	double seeable;    /* share of the surface that is seen from any place that was looked at */
	double seen;       /* share that the probes see, at other spots than they were chosen by */
	size_t candidates; /* places that were looked at */
	size_t first;      /* probes that were chosen before any was moved */
} gw_probes;

/*
 * Places probes in a lit scene and traces what they see. Lamps that are no points are not seen.
 * Where the scene's last probes were placed by the same options they are lit anew, and nothing is
 * traced, also in other light; a scene that began with a transport has the probes that were made
 * before this was written, and no others.
 *   lighting   may be changed afterwards
 *   options    NULL: gw_probes_options_default
 *   probes     on success to be given back with gw_probes_destroy; NULL on failure
 * Fails with GW_ERROR_USAGE for options that make no sense or are not those of the transport, for
 * scenes without an octree
 * (gw_bake_options.effects_forced can ask for one), and where there is no free space within the
 * bounds; GW_ERROR_MEMORY, GW_ERROR_CANCELLED. The same scene, light and options give the same
 * bytes, for any number of threads.
 */
gw_status gw_probes_make(gw_lighting *lighting, const gw_probes_options *options,
						 gw_probes **probes, gw_error *error);

/* What a place sees in a direction, by the maps of probes. */
typedef struct gw_probe_look {
	float radiance[3];
	double distance; /* metres to what is seen; GW_PROBE_FAR where nothing is */
	int32_t probe;  /* whose map shows it, or -1: no probe that serves the place sees that far along
					   the ray, and the radiance is what the best of them sees in that direction */
	uint32_t steps; /* texels of all sizes that were looked at */
} gw_probe_look;

/*
 * Looks from a place along a ray, in the maps of the probes that serve its cell, the best first,
 * or of the nearest ones where none does
 * (Wang 2018, section 4.3): the ray is a straight line in each octant of an octahedral map, and is
 * followed from texel to texel until it meets the plane of one. A texel of a smaller map whose
 * least distance is beyond the ray is stepped over as a whole, and the ray is lost to a probe where
 * it goes behind what that sees: the next one takes it from there.
 *
 *   from        metres, in the coordinates of gw_points.position
 *   direction   unit
 *   mips        whether smaller maps are used; the result is the same but for roundings
 *   look        receives what is seen
 * Thread-safe.
 */
void gw_probes_look(const gw_probes *probes, const double from[3], const float direction[3],
					bool mips, gw_probe_look *look);

/* Frees probes and sets *probes to NULL; an empty handle is accepted. */
void gw_probes_destroy(gw_probes **probes);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#ifdef __cplusplus
}
#endif

#endif
