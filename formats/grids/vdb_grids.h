/*
 * vdb_grids.h - the octree's leaves as an OpenVDB file: the grids density (float, fog volume),
 * radiance, color (albedo), emission and normal (vec3s); on request the points themselves as the
 * point grid points, with the attributes P, radiance, Cd (albedo) and N (vec3s). Or the radiance in
 * free space as spherical harmonics: the grids sh_0 to sh_3, or to sh_8 (vec3s), see gw_volume. Or
 * numbers of what serves each voxel.
 *
 * Cell i reaches from i to i + 1 cell sizes, so the transform puts the centre of index i at
 * origin + (i + 0.5) * size. Where the origin is more than VDB_LOCAL_LIMIT metres from zero, as
 * with georeferenced scans, single precision readers would lose the voxels' places; the transform
 * then starts at 0. In both cases the double metadata gw_origin_x, gw_origin_y and gw_origin_z, on
 * the file and on each grid, say what to add to the grid's coordinates to get the scene's.
 *
 * OpenVDB's libraries take 40 ms to load, so a program linked with them would start that much
 * later; therefore they hang on libglowworm-vdb.so, which is opened when a grid is written. The
 * program calls vdb_write (vdb_plugin.c); vdb_encode and vdb_verify are what the shared object
 * exports (vdb_grids.cpp).
 */
#ifndef VDB_GRIDS_H
#define VDB_GRIDS_H

#include "files/file_status.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Metres from zero up to which grids are in the scene's own coordinates. */
#define VDB_LOCAL_LIMIT 1e5

/* The largest value that a 16-bit float holds. */
#define VDB_HALF_MAX 65504.0f

/* Cell coordinates must be from -VDB_CELL_LIMIT to VDB_CELL_LIMIT - 1. */
#define VDB_CELL_LIMIT (1 << 23)

typedef struct vdb_text {
	const char *name;
	const char *value;
} vdb_text;

/* Points for a point grid. Those whose position is not finite are left out. */
typedef struct vdb_points {
	size_t count;
	const double *position; /* 3 * count, metres, in the scene's coordinates */
	const float *radiance;  /* 3 * count */
	const float *albedo;    /* 3 * count, linear */
	const float *normal;    /* 3 * count, unit length */
} vdb_points;

/* Numbers of things that serve each voxel, such as probes: grids of 32-bit integers named probe_0
 * to probe_3. */
#define VDB_NUMBERS 4
typedef struct vdb_numbers {
	const int32_t *value; /* VDB_NUMBERS * count of the voxels; -1: none */
} vdb_numbers;

/* What a grid file says about itself, and how it is written. A zeroed struct is a good default. */
typedef struct vdb_metadata {
	const vdb_text *text; /* text_count lines for the file's metadata: units, creator... */
	size_t text_count;
	bool half;                /* store 16-bit floats; values over VDB_HALF_MAX are clamped to it */
	const gw_volume *volume;  /* NULL, or what goes into grids in place of the voxels */
	uint64_t memory;          /* bytes that building the grids may take; 0 means no limit */
	const vdb_points *points; /* NULL, or what goes into the point grid, never as 16-bit floats */
	const vdb_numbers *numbers; /* NULL, or what goes into grids in place of what the voxels hold */
	uint64_t *clamped;          /* NULL, or receives how many values were clamped for half */
} vdb_metadata;

/*
 * Writes the grids, in a child process: OpenVDB ends its process where memory or threads run out.
 * The same voxels and metadata give the same bytes.
 *
 *   path      "-" is standard output. A file is read back before it appears under its name
 *   force     overwrite an existing file
 *   voxels    at least one; all arrays present, values finite; not looked at with metadata->volume,
 *             whose cells are likewise; of metadata->numbers only the cells
 *   error     GW_ERROR_MEMORY, before anything is built, when the grids would need more than
 *             metadata->memory (isolated voxels take 50 KB each and more: the sentence holds the
 *             numbers), and so for the point grid, or when OpenVDB dies; GW_ERROR_DATA for a cell
 *             out of range or a size that is not above 0; FILE_ERROR_CREATE, FILE_ERROR_IO,
 *             GW_ERROR_CANCELLED when a signal came that has a handler, GW_ERROR_INTERNAL
 */
gw_status vdb_write(const char *path, bool force, const gw_voxels *voxels,
					const vdb_metadata *metadata, gw_error *error);

/* Loads the shared object, as vdb_write does. A library that it needs may end the process when
 * memory or threads are short. GW_ERROR_INTERNAL when it is not there. */
gw_status vdb_load(gw_error *error);

/* Takes the next bytes of the file; false when they could not be written, which ends the encoding.
 */
typedef bool (*vdb_sink)(void *user, const void *bytes, size_t length);

/* What the grids hold, to compare a file with what was meant to be in it. */
#define VDB_GRIDS 18
typedef struct vdb_digest {
	uint64_t bytes;             /* of the file */
	uint64_t voxels[VDB_GRIDS]; /* active ones */
	uint64_t values[VDB_GRIDS]; /* hash of their places, in metres, and values; in any order */
	uint64_t points;            /* of the point grid */
	uint64_t point_values;      /* hash of their places and attributes; in any order */
} vdb_digest;

/* Builds the grids and hands the file's bytes to the sink, in order. *digest receives what they
 * hold. Throws nothing. */
gw_status vdb_encode(const gw_voxels *voxels, const vdb_metadata *metadata, vdb_sink sink,
					 void *user, vdb_digest *digest, gw_error *error);

/* Reads a file back: FILE_ERROR_IO unless its grids hold just that. */
gw_status vdb_verify(const char *path, const vdb_digest *digest, gw_error *error);

#ifdef __cplusplus
}
#endif

#endif
