/*
 * glowworm_parts.h - public interface of libglowworm for clouds that memory does not hold: some of
 * their points, few enough, are baked as a surface, and all others are lit by it, part by part; by
 * other processes too, to which the light goes as bytes.
 *
 * It reads and writes no files either. What is not said otherwise is as in glowworm.h.
 */
#ifndef GLOWWORM_PARTS_H
#define GLOWWORM_PARTS_H

#include "glowworm.h"

#ifdef __cplusplus
extern "C" {
#endif

#ifdef __GNUC__
#pragma GCC visibility push(default)
#endif

/*
 * How many points a bake may begin with so that the process takes no more than so much memory, as
 * far as can be told of most clouds. Where these take more than most, gw_bake makes the surface of
 * fewer of them. What the process holds just now is not asked, which is never twice the same: the
 * points that are kept are to be.
 *   memory    bytes, of the program and its drivers as well
 *   normals   whether the points have some
 *   lamps     whether any point light, spot or sun shines
 *   options   of the bake: method, normals, leaf_spacing and voxels are looked at
 * Thread-safe. Returns 0 where there is room for none.
 */
uint64_t gw_points_in_memory(uint64_t memory, bool normals, bool lamps,
							 const gw_bake_options *options);

typedef struct gw_lit_surface gw_lit_surface;

/*
 * Makes a surface ready to light points beside it.
 *   points    of the surface; they are referred to until it is closed, as is lit
 *   lit       what gw_bake made of them
 *   options   it was baked with: of these normals, threads and max_error are
 *             looked at
 *   surface   receives it, to be given back with gw_lit_surface_close; NULL on failure
 * Fails with GW_ERROR_MEMORY.
 */
gw_status gw_lit_surface_open(const gw_points *points, const gw_bake_result *lit,
							  const gw_bake_options *options, gw_lit_surface **surface,
							  gw_error *error);

/*
 * Lights points by the surface: each takes the irradiance of the points of the surface around it
 * that face its way, weighed by how near they are (modified Shepard interpolation, Franke and
 * Nielson 1980), and reflects it by its own albedo.
 *   part     any number of points, in any order; of them position, normal, albedo, emission,
 *            opacity and stray are looked at
 *   light    receives their light, to be given back with gw_bake_result_destroy; NULL on failure.
 *            Its report has the numbers of that of the surface
 * Fails with GW_ERROR_MEMORY. The light does not depend on how points are parted. Not to be called
 * by two threads with the same surface; it uses threads of its own.
 */
gw_status gw_lit_surface_light(gw_lit_surface *surface, const gw_points *part,
							   gw_bake_result **light, gw_error *error);

/*
 * Completes the report of the surface's light: how many of all points are lit by it, what lies
 * between its points, as far as the parts tell that were lit so far (gw_error_estimate.between),
 * and whether that misses gw_bake_options.max_error. To be called once.
 *   all   points of the cloud, those of the surface among them
 */
void gw_lit_surface_report(const gw_lit_surface *surface, uint64_t all, gw_report *report);

/* Frees it; *surface becomes NULL. NULL is accepted. */
void gw_lit_surface_close(gw_lit_surface **surface);

/* -------------------------------------------------------------------------------------- tiles */

/*
 * A cloud that memory does not hold, parted by place into tiles of about as many points, each of
 * which is lit by itself: by a surface of all its points, of those of its halo, which is what
 * stands around it, and beyond that of points that were kept of the whole cloud, far fewer, whose
 * light a bake of theirs has found. So what is near is as fine as it was scanned.
 *
 * Built by reading the cloud once to count its points, and used while it is read once more to sort
 * them by tiles.
 */
typedef struct gw_tiling gw_tiling;

/*
 *   kept     points that are spread over the cloud; not referred to afterwards
 *   width    metres, above 0: of the cubes that tiles are made of; a halo is two of them wide. Some
 *            eight spacings of what was kept
 *   tiling   receives it, to be given back with gw_tiling_end; NULL on failure
 * Fails with GW_ERROR_MEMORY.
 */
gw_status gw_tiling_begin(const gw_points *kept, double width, gw_tiling **tiling, gw_error *error);

/* Counts the points of a part of the cloud; of all parts it is to be called once. Positions are
 * looked at alone. Fails with GW_ERROR_MEMORY. */
gw_status gw_tiling_count(gw_tiling *tiling, const gw_points *part, gw_error *error);

/*
 * Makes tiles, once all points were counted.
 *   most    points of a tile with its halo; or as many as the fullest cube has with its own
 *   least   tiles that there are to be, where there are as many cubes
 * Fails with GW_ERROR_MEMORY; with GW_ERROR_DATA where no points were counted.
 */
gw_status gw_tiling_form(gw_tiling *tiling, uint64_t most, uint32_t least, gw_error *error);
uint32_t gw_tiling_tiles(const gw_tiling *tiling);

/* The points of a part of a cloud, tile by tile; a point is in several: in the core of one, which
 * gives it its light, and in halos. */
typedef struct gw_tile_members {
	uint64_t *first; /* tiles + 1: of each tile its first entry in: */
	uint32_t *point; /* numbers within the part, ascending within a tile */
	uint8_t *core;   /* 1: of the tile itself, 0: of its halo */
} gw_tile_members;

/*
 * Finds them. Points that were not counted are in no tile.
 *   part      fewer than 2^32 points
 *   members   to be freed with gw_tile_members_clear; empty on failure
 * Fails with GW_ERROR_MEMORY. Thread-safe, like gw_tiling_tiles, once tiles were formed.
 */
gw_status gw_tiling_members(const gw_tiling *tiling, const gw_points *part,
							gw_tile_members *members, gw_error *error);
void gw_tile_members_clear(gw_tile_members *members);

void gw_tiling_end(gw_tiling **tiling); /* *tiling becomes NULL, which is accepted */

/* What a tile is lit with. */
typedef struct gw_tile {
	const gw_points *near; /* the points of the tile and of its halo; what is said of scanners,
							  images, instances and axes is taken from `kept` */
	const uint8_t *core;   /* one each: 1 for those of the tile, which are lit */
	const gw_points *kept; /* of the whole cloud */
	const gw_bake_result *light; /* of these, as gw_bake made it with the same lights and options:
									what lies beyond the halo sends it to the tile */
	const uint32_t *replaced;    /* replaced_count: which of these are in the tile or its halo */
	size_t replaced_count;
	bool checked; /* bakes of half of the points say how wrong it is, which takes as long again */
} gw_tile;

/* A device that one tile after the other is lit on. */
typedef struct gw_tile_device gw_tile_device;
gw_status gw_tile_device_open(gw_tile_device **device, gw_error *error); /* GW_ERROR_MEMORY */
void gw_tile_device_close(gw_tile_device **device); /* *device becomes NULL, which is accepted */

/* How tiles are lit, all of one cloud alike. */
typedef struct gw_tile_lighting {
	const gw_light *light; /* light_count; as of gw_scene_description */
	size_t light_count;
	const gw_bake_options *options; /* as of gw_bake, of GW_METHOD_RAYS; without region, transport,
									   voxels and volume */
	const gw_bake_callbacks *callbacks; /* or NULL */
	gw_tile_device *device;             /* NULL: one that is opened for each tile */
} gw_tile_lighting;

/* How right a tile is, for gw_tiles_report; plain numbers, which may be kept as bytes. */
typedef struct gw_tile_share {
	uint64_t points;         /* lit ones that do not emit */
	double radiance;         /* W/(sr m^2), mean luminance of these */
	bool checked;            /* as of the tile */
	gw_error_estimate error; /* of it alone */
} gw_tile_share;

/*
 * Lights a tile.
 *   share   receives how right it is
 *   light   receives the light of `near`, of which the points of the core are asked for and all
 *           else is 0; to be given back with gw_bake_result_destroy, NULL on failure
 * Fails as gw_bake does with a region. The light depends on what is given alone, not on what the
 * device lit before.
 */
gw_status gw_tile_light(const gw_tile *tile, const gw_tile_lighting *lighting, gw_tile_share *share,
						gw_bake_result **light, gw_error *error);

/*
 * Puts into the report of the points that were kept how right the light of all tiles is, and says
 * how many they are.
 *   share    count of them, 1 or more, at least one of them of a tile that was checked
 *   wanted   gw_bake_options.max_error
 */
void gw_tiles_report(const gw_tile_share *share, size_t count, double wanted, gw_report *report);

/* -------------------------------------------------------------------------------------- bytes */

/* Where bytes go, and where they come from, in order; what the calls return is handed on. */
typedef struct gw_byte_sink {
	gw_status (*write)(void *user, const void *bytes, size_t length, gw_error *error);
	void *user;
} gw_byte_sink;

typedef struct gw_byte_source {
	gw_status (*read)(void *user, void *bytes, size_t length, gw_error *error);
	void *user;
} gw_byte_source;

/*
 * Hands on the light of points as bytes, for another process of the same version on the same kind
 * of machine: that of gw_bake, or of a surface, with its report, but without voxels and volume.
 */
gw_status gw_bake_result_save(const gw_bake_result *result, const gw_byte_sink *to,
							  gw_error *error);

/*
 * Makes of such bytes the result that they were. Whether they are whole is for the caller to know,
 * who keeps a checksum of them: of numbers of points only the sizes are looked at.
 *   result   to be given back with gw_bake_result_destroy; NULL on failure
 * Fails with GW_ERROR_DATA where they are of another version, with GW_ERROR_MEMORY.
 */
gw_status gw_bake_result_load(const gw_byte_source *from, gw_bake_result **result, gw_error *error);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#ifdef __cplusplus
}
#endif

#endif
