/*
 * glowworm.h - public interface of libglowworm, the lighting baker for point clouds. Pictures of
 * points have glowworm_picture.h.
 *
 * The library takes bare points, finds out which piece of surface each one stands for, builds a
 * sparse voxel octree on a Vulkan device, and computes the light that every point sends out.
 * It reads and writes no files, prints nothing and never exits the process.
 *
 * The data's way through the library; the folders of lib/ follow it:
 *
 *   points -> cloud -> normals -> surfels -> octree -> direct light -> records -> bounces -> points
 *
 * Quantities and letters, the same everywhere in this project:
 *
 *   radiance L, emission Le   W/(sr m^2), linear RGB with Rec.709 primaries, D65
 *   irradiance E              W/m^2, on the point's oriented surface
 *   intensity I               W/sr
 *   albedo rho                1, diffuse reflectance, 0 <= rho < 1
 *
 * A photometric scene uses candela, cd/m^2 and lux instead; the numbers are treated the same.
 * A diffuse point sends out L = Le + rho/pi * E.
 *
 * Thread-safety: calls that work on different objects may run at the same time. gw_bake uses
 * several threads of its own; its callbacks are called on the thread that called gw_bake.
 *
 * Until version 1.0 structs may grow from one minor version to the next; the library's soname
 * changes with it.
 */
#ifndef GLOWWORM_H
#define GLOWWORM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#ifdef __GNUC__
#pragma GCC visibility push(default)
#endif

/* The version of this header, and of the library that is running. */
#define GW_VERSION "0.1.0"
const char *gw_version(void);

/* ---------------------------------------------------------------------------------- errors */

/* What went wrong, by class. */
typedef enum gw_status {
	GW_OK = 0,
	GW_ERROR_USAGE,     /* an option or argument that makes no sense */
	GW_ERROR_DATA,      /* the input's content is bad */
	GW_ERROR_NO_DEVICE, /* no Vulkan device that can do the work */
	GW_ERROR_MEMORY,    /* host memory, the memory budget or a device limit is too small */
	GW_ERROR_INTERNAL,  /* a fault of glowworm or of the driver */
	GW_ERROR_CANCELLED, /* a callback asked to stop */
	/* From here on to 127, what those who use the library make of it: it hands on what their own
	 * functions return (gw_transport.write) and returns none of it by itself. */
	GW_STATUS_OF_CALLER = 64,
} gw_status;

#define GW_ERROR_TEXT 1024

/* One failure: its class and one sentence that says what failed, where, and what to do. */
typedef struct gw_error {
	gw_status status;
	char text[GW_ERROR_TEXT];
} gw_error;

/*
 * Fills *error with a class and a formatted sentence and returns the class, so that a function
 * can end with `return gw_fail(error, GW_ERROR_DATA, "...")`.
 *   error   where to put it; NULL drops the sentence
 *   format  printf format of one whole sentence, without a final newline
 */
gw_status gw_fail(gw_error *error, gw_status status, const char *format, ...)
	__attribute__((format(printf, 3, 4)));

/* Calls, and returns from the calling function when the call did not succeed. */
#define GW_TRY(call)                                                                               \
	do {                                                                                           \
		gw_status gw_status_ = (call);                                                             \
		if (gw_status_ != GW_OK)                                                                   \
			return gw_status_;                                                                     \
	} while (0)

/* What clang's analyzer cannot see from outside: a failure is never GW_OK. */
#ifdef __clang_analyzer__
#define gw_fail(error, status, ...) (gw_fail((error), (status), __VA_ARGS__), (status))
#endif

/* --------------------------------------------------------------------------------- points in */

/*
 * Points that one scanner saw as a picture: rows and columns of cells, of which neighbours were
 * seen in neighbouring directions, such as a scan of a PTX or E57 file, or an organised PCD file.
 * What lies side by side in it but not at one depth is no surface, and noise is along its rays.
 */
typedef struct gw_range_image {
	size_t first, count;    /* its points among all, those from `first` on */
	uint32_t columns, rows; /* less than 2^32 cells */
	double scanner[3];      /* where all its rays begin */
} gw_range_image;

/* Points that stand as others do, moved as one: an object in one of the places where it stands.
 * Surfels of an object are made once, by themselves, and placed everywhere: what touches it alters
 * neither its discs nor the other's. */
typedef struct gw_object_instance {
	size_t first, count; /* first .. first + count - 1 */
	size_t of;           /* whose surfels it has: an instance before it with as many points in the
							same order, which is its own, or itself */
	double matrix[16];   /* row-major: from where that one stands to here. It may turn, mirror, move
							and scale evenly */
} gw_object_instance;

/* Whether a matrix turns, mirrors, moves and scales evenly, and does nothing else, to the relative
 * tolerance by which squared lengths and products of its columns may differ, above 0. Instances and
 * movers may be off by 1e-4. */
bool gw_matrix_is_even(const double matrix[16], double tolerance);

/* The points of one scene. Nothing here is modified or kept after gw_bake returns. */
typedef struct gw_points {
	size_t count;           /* number of points; 0 is an error */
	const double *position; /* 3 * count, metres, any origin; non-finite points are left out */
	const float *normal;    /* 3 * count or NULL; a length below 1 is kept as the spread of an NDF
							   (Salm 4.3.1); zero or non-finite ones are estimated */
	const float *albedo;    /* 3 * count or NULL, linear RGB; clamped to [0, GW_ALBEDO_MAX] */
	const float *emission;  /* 3 * count or NULL, radiance Le; negative and non-finite count as 0 */
	const float *opacity;   /* count or NULL: 1; 0..1, share of a point's piece of surface that is
							   covered: the rest of it lets light through, and sends out none. What
							   L and E say is of the covered part. Points of 0 are left out */
	const double *scanner;  /* 3 * scanner_count, where scanners stood: orient estimated normals */
	size_t scanner_count;   /* 0: nobody knows */
	const uint32_t *scanner_of;  /* count or NULL: which scanner saw each point; for numbers that no
									scanner has, and for NULL, nobody knows which of several */
	const gw_range_image *image; /* image_count, in ascending order; may be NULL */
	size_t image_count;
	const uint32_t *image_cell; /* count or NULL: of points of an image, row * columns + column.
								   Normals that are missing come from the neighbours there, and
								   noise along the rays is smoothed */
	const float *own_area;   /* count or NULL, m^2: of points that are a thing by themselves, such
								as a wire or a leaf that a beam met, what that covers as their
								scanner sees it; 0: a point of a surface */
	const float *beam_share; /* count or NULL: 1; above 0, at most 1: share of the beam that met a
								point which stopped there. Where beams go on behind most points and
								these lie in no plane, they are leaves */
	const uint8_t *stray;    /* count or NULL: 0, or 1 + the gw_stray_kind of points of which it is
								known that they belong to no surface */
	bool keep_strays;        /* all are taken for points of surfaces, these too, and none is looked
								for */
	char up;                 /* axis that points up: 'x', 'y', 'z', or 'X', 'Y', 'Z' for those that
								point down; 0: z. Tells sides of surface where nothing else does */
	bool normal_sideless;    /* normals may be turned around, all of them: nobody knows which way is
								the front, which is found as for those that are estimated */
	const gw_object_instance
		*instance; /* instance_count, ascending, without points in common; may be NULL.
					  All but places and scanners is the same for points that repeat
					  others. Not asked in frames, where what moves is a mover */
	size_t instance_count;
} gw_points;

/* Points that belong to no surface are strays. They get the light of the surface nearest to them,
 * but shade nothing, light nothing, and bounds are without them. */
typedef enum gw_stray_kind {
	GW_STRAY_NOISE,    /* classified as noise in the file */
	GW_STRAY_WITHHELD, /* marked there as not to be used */
	GW_STRAY_ZERO,     /* at 0, 0, 0, far from the rest */
	GW_STRAY_NO_DATA,  /* at a value for no data, such as -9999, far from the rest */
	GW_STRAY_FAR,      /* far off all the rest */
	GW_STRAY_ALONE,    /* many times further from others than those around are from each other */
	GW_STRAY_MIXED,    /* between an edge and what is behind it, seen from the scanner */
	GW_STRAY_MOUNT,    /* what a scanner stood on, next to it and to nothing else */
	GW_STRAY_HAZE,     /* a splat that hardly hides what is behind it */
	GW_STRAY_KIND_COUNT
} gw_stray_kind;

/* The kind, as it is called in reports, such as "no data". */
const char *gw_stray_kind_name(gw_stray_kind kind);

/* Albedo is clamped to this, so that the sum of all bounces stays finite. */
#define GW_ALBEDO_MAX 0.99f

/* Albedo of points when gw_points.albedo is NULL. */
#define GW_ALBEDO_DEFAULT 0.5f

/* ------------------------------------------------------------------------------------- lights */

typedef enum gw_light_type {
	GW_LIGHT_POINT,       /* position, intensity, radius; distribution */
	GW_LIGHT_SPOT,        /* position, direction, intensity, inner_angle, outer_angle, radius */
	GW_LIGHT_SUN,         /* direction, irradiance, angle */
	GW_LIGHT_ENVIRONMENT, /* radiance, the same from everywhere, or map times radiance */
	GW_LIGHT_SPHERE,      /* position, intensity, radius: a ball of even radiance */
	GW_LIGHT_DISC,        /* position, direction, intensity, radius: shines to one side;
							 distribution */
	GW_LIGHT_RECTANGLE,   /* position, direction, across, intensity, size: likewise */
	GW_LIGHT_TYPE_COUNT
} gw_light_type;

/* One light. Fields that its type does not name (see gw_light_type) are ignored. */
typedef struct gw_light {
	gw_light_type type;
	char name[64];       /* for reports; may be empty */
	double position[3];  /* metres, in the coordinates of gw_points.position */
	double direction[3]; /* the way the light travels; any length above 0 */
	float intensity[3]; /* W/sr, of a point light or in the inner cone of a spot light; of a sphere,
						   disc or rectangle along its axis from afar: radiance times area */
	float irradiance[3]; /* W/m^2, on a plane that faces the sun */
	float radiance[3];   /* W/(sr m^2), of the environment */
	float inner_angle;   /* degrees from the axis, full intensity inside; 0 <= inner <= outer */
	float outer_angle;   /* degrees from the axis, dark outside; at most 180. Between the two the
							intensity falls by smoothstep in the cosine (as pbrt's spot light) */
	float radius;        /* metres, >= 0; above 0 the shadow has a penumbra; of spheres and discs
							above 0. What 32-bit numbers cannot hold beside the scene is refused */
	float angle;         /* degrees, angular diameter of the sun, >= 0; above 0: penumbra */

	/* What comes from which direction, multiplied by radiance; of one light of a bake at most.
	 * Longitude and latitude: rows go from straight up to straight down, columns from 180 degrees
	 * left of where the map's centre looks to 180 degrees right of it, seen from inside. Negative
	 * pixels and those that are no numbers count as 0; infinite ones as GW_MAP_INFINITE. Up is z,
	 * and the centre looks along y turned clockwise, seen from above, by `rotation`; with map_y_up
	 * up is y, and what is y above is -z. Read during gw_bake only. */
	const float *map; /* 3 * map_width * map_height or NULL */
	uint32_t map_width, map_height;
	float rotation; /* degrees */
	bool map_y_up;

	/* How the intensity of a point light, or of each piece of a disc or rectangle, depends on
	 * direction, as luminaires are measured, or NULL: it is the same in all, or as Lambert's
	 * cosine. First vertical_count angles from `direction`, degrees, ascending, within 0 and 180;
	 * then horizontal_count angles around it, ascending: either one, then all around is the same,
	 * or from 0, which lies toward `across`, to 360; 90 lies toward across x direction. Then for
	 * each angle around as many shares of `intensity` as there are angles from the axis, finite, at
	 * least 0. Between angles it is linear, beyond the first and last from the axis dark. The
	 * caller's; has to stay as long as the bake or the handle to which the light is given. */
	const float *distribution;
	uint32_t vertical_count;   /* 2..65536 */
	uint32_t horizontal_count; /* 1..65536; the product of both at most 2^26 */
	double across[3];          /* any length above 0; not along the direction */
	float size[2]; /* metres above 0: a rectangle's sides along `across`, and across that */
} gw_light;

/* What an infinite pixel of a map counts as: the largest number that a 16-bit float holds. */
#define GW_MAP_INFINITE 65504.0f

/* ------------------------------------------------------------------------------------ options */

typedef enum gw_method {
	GW_METHOD_RAYS,  /* records gather by rays against the planes in the leaves; hits stored once */
	GW_METHOD_CONES, /* records gather by cones in the anisotropic pyramid, anew every bounce */
	GW_METHOD_VOLUME,  /* cells of a uniform grid gather by rays and keep spherical harmonics, from
						  which records and points read (Mavridis and Papaioannou) */
	GW_METHOD_LPV,     /* light goes from cell to cell of such a grid, step by step (Kaplanyan and
						  Dachsbacher) */
	GW_METHOD_PROBES,  /* as rays, but these are followed through the maps of probes that are placed
						  for it (Wang) */
	GW_METHOD_BUFFERS, /* records draw nodes of the octree and facets into small buffers; what these
						  show is stored once (Harada) */
	GW_METHOD_COUNT
} gw_method;

/* What a record keeps of the light that it gathers. */
typedef enum gw_basis {
	GW_BASIS_AUTO,        /* directional where normals of points differ from their records' */
	GW_BASIS_SCALAR,      /* irradiance on its own normal */
	GW_BASIS_DIRECTIONAL, /* and how that changes where the normal turns; of GW_METHOD_RAYS */
	GW_BASIS_COUNT
} gw_basis;

typedef enum gw_shadows {
	GW_SHADOWS_TRACED, /* rays against the planes in the leaves */
	GW_SHADOWS_MAPS,   /* minimum of variance and exponential shadow maps (Salm 4.2) */
	GW_SHADOWS_NONE,   /* every light reaches every point that faces it */
	GW_SHADOWS_COUNT
} gw_shadows;

/* By what the compute passes of a bake run: see pass_table.h. The light is the same but for
 * roundings. */
typedef enum gw_pass_choice {
	GW_PASSES_AUTO,   /* whatever is quickest on the device */
	GW_PASSES_DEVICE, /* shaders alone, on any device as on a GPU */
	GW_PASSES_CPU,    /* loops of the processor, where there are some for a pass; needs a device
						 that shares its memory, as the software driver's does */
	GW_PASSES_COUNT
} gw_pass_choice;

/* What becomes of normals that come with the points. */
typedef enum gw_normals_choice {
	GW_NORMALS_AUTO,     /* taken, unless many of them cannot be right: these are mended */
	GW_NORMALS_GIVEN,    /* taken as they are; missing ones are estimated */
	GW_NORMALS_ESTIMATE, /* all are estimated */
	GW_NORMALS_COUNT
} gw_normals_choice;

/* What Vulkan's validation layer looks at; it can't do both at once. */
typedef enum gw_validation {
	GW_VALIDATE_NOTHING,
	GW_VALIDATE_CALLS,    /* each call, and whether what one reads waits for what another writes */
	GW_VALIDATE_ACCESSES, /* each call, and whether shaders stay within their buffers */
	GW_VALIDATION_COUNT
} gw_validation;

/* What light comes through gaps: through what no scanner ever looked at, because something stood in
 * front of it. Where it did look, as through windows, is no gap. Where no scanner is known, gaps
 * are holes of surfaces that are closed around them, windows among them. */
typedef enum gw_gaps {
	GW_GAPS_OPEN,  /* that of the sky, as through everything that is not there */
	GW_GAPS_BLACK, /* none */
	GW_GAPS_MEAN,  /* as much as from what else is seen from where it goes */
	GW_GAPS_COUNT
} gw_gaps;

/* What a scene may call for; gw_report tells of each whether it did. */
typedef enum gw_effect_kind {
	GW_EFFECT_LAMPS,    /* light straight from point, spot and sun lights */
	GW_EFFECT_SHADOWS,  /* what hides these from the points */
	GW_EFFECT_EMITTERS, /* light of points that emit, at others */
	GW_EFFECT_SKY,      /* light of the environment */
	GW_EFFECT_PORTALS,  /* openings to the sky, sampled where they are few */
	GW_EFFECT_BOUNCES,  /* light that is reflected more than once */
	GW_EFFECT_GAPS,     /* what scanners did not see, and holes of surfaces */
	GW_EFFECT_ERROR,    /* how wrong the light is */
	GW_EFFECT_OCTREE,   /* what most of these need; it cannot be forbidden */
	/* of the surface: */
	GW_EFFECT_TRANSMISSION, /* points that are less than opaque let light through; forced where all
							   are opaque, light stays as it is, by cones but for 0.5 % */
	GW_EFFECT_NORMALS,      /* estimated; forced as with GW_NORMALS_ESTIMATE, forbidden as with
							   GW_NORMALS_GIVEN: this does change the light */
	GW_EFFECT_NOISE,        /* smoothed where points scatter about their surface */
	/* of what is asked for: */
	GW_EFFECT_COLUMNS, /* the light of each lamp by itself; forced, they are in the result */
	GW_EFFECT_KIND_COUNT
} gw_effect_kind;

#define GW_DEPTH_AUTO 0u
#define GW_DEPTH_MAX 16u
/* Width of leaves in spacings of the points, of clouds of up to 250,000. Of n points it is that
 * times the fourth root of n over 250,000: leaves are as many as the root of the points, so that
 * they get finer with the points, but the octree grows less than these. */
#define GW_LEAF_SPACING 1.25f
#define GW_LEAF_SPACING_AUTO 0.0f
#define GW_BOUNCES_AUTO UINT32_MAX

/*
 * What of a bake does not depend on the light, as a block of bytes: the surface of the points, the
 * octree, and what the places see where light is gathered and where the error was estimated, and
 * what probes see (gw_probes_make). A second bake of the same points begins with it and only lights
 * them; where its light is gathered less right than gathered_error asks for, it adds places. The
 * bytes are for the same version of the library, and stay as they are until gw_bake
 * returns: where they begin at a page of memory, as a mapped file does, the software driver uses
 * them in place.
 *
 * Lights, emission, shadows, bounces, tolerance and light_samples may differ between the two bakes;
 * positions, normals, albedo, scanners and the other settings of light have to be the same. Where
 * normals were estimated and nobody knows which scanner saw what, the first bake's lights have
 * oriented them.
 */
typedef struct gw_transport {
	const char *name; /* for messages, such as a file's name */
	const void *data; /* NULL, or what another bake wrote; any bytes are checked before use */
	size_t length;    /* of data */
	/* Reading data may raise a signal that the caller handles, as that of a file does that is
	 * mapped and cut short: threads of drivers, which have no handlers, get copies. */
	bool fleeting;
	/* NULL, or called with the bytes in order. What it fails with is what gw_bake fails with. */
	gw_status (*write)(void *user, const void *bytes, size_t length, gw_error *error);
	void *user;
	uint64_t note; /* of the caller's, kept with what is written */
} gw_transport;

/*
 * The note of a transport that another bake wrote.
 *   transport   name, data and length
 * Fails with GW_ERROR_DATA when its beginning is none of this version's.
 */
gw_status gw_transport_note(const gw_transport *transport, uint64_t *note, gw_error *error);

struct gw_camera; /* glowworm_picture.h */

/* The part of a scene whose light is asked for. Only what that light depends on is computed: light
 * is gathered there as finely as in a bake of the whole, and less finely on what that sees, and on
 * what these see. */
typedef struct gw_region {
	const uint8_t *point; /* NULL: all; or one a point of gw_points: 1 for those that are asked for,
							 else 0 */
	/* NULL, or of those the ones that this camera sees, with some just behind an edge. */
	const struct gw_camera *camera;
	double aspect; /* then, width of the picture by its height, 1/64..64 */
} gw_region;

/* Drivers that are being loaded, see gw_drivers_load. */
typedef struct gw_drivers gw_drivers;

/* How to bake. Start from gw_bake_options_default and change what differs. */
typedef struct gw_bake_options {
	gw_method method;
	gw_shadows shadows;
	uint32_t depth;         /* of the octree: 2^depth leaf cells a side; GW_DEPTH_AUTO derives it
							   from leaf_spacing */
	float leaf_spacing;     /* width of a leaf in spacings of the points, 0.25..64, when depth is
							   GW_DEPTH_AUTO; wider where memory is short. GW_LEAF_SPACING_AUTO: as
							   GW_LEAF_SPACING says; with GW_METHOD_CONES or voxels it itself */
	uint32_t bounces;       /* how often light is reflected; 0 leaves only emission, 1 is direct
							   light; GW_BOUNCES_AUTO stops when the bound on what the bounces left
							   out would add is under tolerance */
	float tolerance;        /* of GW_BOUNCES_AUTO, relative to the light found so far, in (0, 1);
							   less where a quarter of max_error is */
	uint32_t rays;          /* gather rays a record (GW_METHOD_RAYS, GW_METHOD_PROBES), 1..4096 */
	uint32_t light_samples; /* samples of the emitters a record, 1..4096 */
	uint32_t cones;         /* gather cones a record (GW_METHOD_CONES), 1..256 */
	uint32_t volume_cells;  /* of GW_METHOD_VOLUME, GW_METHOD_LPV and `volume`: cells along the
							   longest side of  the points' bounds, 2..512, or 0: 64, for
							   GW_METHOD_LPV 16 */
	uint32_t volume_harmonics; /* spherical harmonics a cell, 4 or 9, of GW_METHOD_VOLUME and
								  `volume`; each cell sends `rays` rays then. GW_METHOD_LPV has 4 */
	uint32_t probe_size;  /* of GW_METHOD_PROBES: texels a side of a probe's maps, a power of two as
							 gw_probes_options.size */
	float record_spacing; /* leaf cells between records, 0..64; 0 places one on every surface piece
							 of every leaf, as in Salm 4.4.3 */
	uint32_t least_records; /* where there would be fewer, records stand closer, but for this never
							   nearer than 0.8 leaf cells: light is not even between few. Up to four
							   times as many where surface reflects more than half of its light. 0:
							   as they come */
	uint32_t most_records;  /* where there would be more, records stand farther apart at first, and
							   more are put where they disagree, nowhere nearer than record_spacing,
							   until gathered_error is reached: so light costs no more where points
							   are many. 0: as they come, as they also do in frames, with a
							   transport, in prepared scenes, and where rays do not gather */
	float gathered_error;   /* of gathered light, relative, that is small enough there; 0 adds none,
							   below 1 */
	uint32_t estimate_points; /* points solved again to estimate the error; where records are many,
								 one for 20 of them, up to four times as many. Three times as many
								 anew before max_error counts as reached. 0 makes no estimate */
	float max_error;          /* above 0: refines until the estimated relative_rms and its spread
								 together are at most this; below 1. The settings above are where it
								 starts */
	float time_limit;         /* above 0: refines as long as the next round will end within so many
								 seconds of the call; the first round is made in any case */
	gw_basis basis;           /* GW_BASIS_DIRECTIONAL: of GW_METHOD_RAYS, and GW_GAPS_OPEN */
	gw_gaps gaps;       /* what gathered light finds in gaps; of GW_METHOD_RAYS. Where they are not
						   open, lamps and suns do not shine through them either */
	float gap_radiance; /* W/(sr m^2), with GW_GAPS_BLACK: what gaps send instead of nothing;
						   not together with lamps */
	uint32_t effects_forced;    /* 1 << gw_effect_kind: computed whether or not the scene calls for
								   them; the light is the same */
	uint32_t effects_forbidden; /* likewise: not computed, whatever the scene calls for. None of
								   those forced, nor GW_EFFECT_OCTREE */
	uint32_t shadow_map_size;   /* texels a side of a shadow map, 16..8192 */
	uint32_t threads;           /* 0 means one a core */
	uint64_t seed;              /* of all random directions */
	uint64_t memory; /* bytes that the bake may use, host and device together; 0 means most
						of what the machine has free */
	/* Points that the surface is made of at most: the others are lit by it. 0 means all, or as many
	 * as memory holds. Not with a transport, nor with the camera of a region; only gw_bake and
	 * gw_plan_bake can. */
	uint32_t surface_points;
	const char *device;    /* NULL, or an index, type name or part of the name of a device */
	gw_pass_choice passes; /* for those who look into a difference */
	gw_normals_choice normals;
	gw_validation validate; /* run under Vulkan's validation layer; any message is an error */
	bool voxels;            /* fill gw_bake_result.voxels */
	bool volume;            /* fill gw_bake_result.volume, whatever the method */
	bool lamps;             /* fill gw_bake_result.lamp and rest: solves again for each light */
	bool ambient_occlusion; /* fill gw_bake_result.ambient_occlusion */
	bool bent_normals;      /* fill gw_bake_result.bent_normal */
	float ambient_occlusion_distance; /* metres; 0: surfaces at any distance count */
	bool unknown;                     /* fill gw_bake_result.unknown */
	bool errors; /* fill gw_bake_result.error: in W/(sr m^2), the luminance by which the records
					around a point disagree, as a standard error of their mean. It knows the noise
					of gathered light and how fast that changes, but not the error of shadows and of
					geometry */
	const gw_region *region; /* NULL, or only this part of the scene is lit, and the error is that
								of its light. Gathers by rays; neither with a transport nor with
								voxels or a volume, nor in frames, and nothing is foretold */
	const gw_transport *transport; /* NULL, or begin with an earlier bake's and write this one's;
									  not together with max_error or time_limit. Of a scene it
									  stays as it is until gw_scene_destroy, with its data, and
									  is written by the first gw_probes_make */
	gw_drivers *drivers; /* NULL, or those that gw_drivers_load began to load, for one bake
							at a time: its device is opened sooner */
} gw_bake_options;

/* Ready to use: GW_QUALITY_NORMAL, all light, no limits. */
gw_bake_options gw_bake_options_default(void);

/* How good a bake is to be, as settings that go together. */
typedef enum gw_quality {
	GW_QUALITY_DRAFT,
	GW_QUALITY_NORMAL, /* what gw_bake_options_default has */
	GW_QUALITY_HIGH,
	GW_QUALITY_REFERENCE,
	GW_QUALITY_COUNT
} gw_quality;

/* Sets record_spacing, least_records, most_records, gathered_error, rays, light_samples, cones and
 * leaf_spacing; the rest stays. */
void gw_bake_options_set_quality(gw_bake_options *options, gw_quality quality);

/* Sets the same to those with which a bake that refines best begins: few records, which show where
 * more are needed, with as many rays as they will need in the end. */
void gw_bake_options_set_start(gw_bake_options *options);

struct gw_bake_result;

/* What to call while work runs. All may be NULL. Called when a stage begins, and within stages some
 * ten times a second. */
typedef struct gw_bake_callbacks {
	/* Progress: name of the stage and the share of the whole that is done, 0..1, which never falls.
	 * Within a stage it goes by the clock: by how long the stages before took for their shares. */
	void (*progress)(void *user, const char *stage, double done);
	/* Asked whether to stop; after true the call returns GW_ERROR_CANCELLED within half a second,
	 * where nothing else keeps the machine busy. */
	bool (*cancelled)(void *user);
	void *user;
	/* Called once, of gw_bake: what is going to be computed and why, and what it will take, as
	 * gw_plan_bake tells it. Foretelling takes time of its own; the light is the same. */
	void (*planned)(void *user, const struct gw_bake_result *plan);
} gw_bake_callbacks;

/* ------------------------------------------------------------------------------------- report */

/* One stage of a bake, in the order they ran. */
typedef struct gw_stage {
	char name[32];
	double seconds;         /* wall clock */
	double device_seconds;  /* of that, on the device by its own timestamps */
	double compile_seconds; /* of that, compiling pipelines */
	uint64_t bytes;         /* device memory that the stage left allocated */
	uint64_t dispatches;
	uint64_t submissions; /* to the device, which the host waited for */
	/* Bytes that went to the device and back: copied, or read and changed in place where it shares
	 * the host's memory. What loops of the processor do in place of passes is not counted. */
	uint64_t uploaded_bytes;
	uint64_t downloaded_bytes;
} gw_stage;

/* One compute pass that ran on the bake's device, for frames and scenes since that was opened. */
typedef struct gw_pass_count {
	char name[32];     /* of its shader */
	uint64_t runs;     /* by its shader or by the loop of the processor that does the same */
	uint32_t compiled; /* pipelines made of its shader: 0 where the processor did it all */
} gw_pass_count;

/* One effect: whether the scene calls for it, why, and how it was computed. */
typedef struct gw_effect {
	char name[32];
	bool called_for;
	char reason[240]; /* one sentence */
	char method[64];  /* empty when not called for */
	double seconds;   /* what a bake without it alone would save: foretold in a plan, of the first
						 round in the report of a bake. 0: nothing, or not known */
} gw_effect;

/* One reflection of light. */
typedef struct gw_bounce {
	double energy; /* reflected by it: sum over surface of area * rho * E, luminance, W */
	double seconds;
	/* By how many records that light comes, as if each brought as much: (sum of their parts)^2 over
	 * the sum of squares. Where they stand makes `energy` wrong by a standard error of
	 * 1/sqrt(carriers) at most. 0 where that is not known: in the first, whose light lamps, sky and
	 * emitters throw, and on a device with memory of its own. */
	double carriers;
	/* E of the record that gathered most of it, in any channel, W/m^2; likewise. By rays no later
	 * one exceeds rho times the one before: a record's light is a mean of what it sees. */
	double largest_irradiance;
} gw_bounce;

/* How wrong a bake's radiance is, estimated by solving some points again (error_estimate.h).
 * Relative to the mean radiance of the points that do not emit. */
typedef struct gw_error_estimate {
	uint32_t points;     /* solved again; 0 when no estimate was made, or where lamps alone shine
							and only their shadows are looked at */
	double relative_rms; /* root mean square error: of the nine below that are parts of it, of the
							light that GW_BOUNCES_AUTO leaves out (remaining), and not less than
							halves says */
	double gathered;     /* of light that was gathered, by the points that were solved again */
	double spread;       /* standard error of that, and a tenth of it that is not seen: 2.3 %
							+- 0.3 % */
	double bias;         /* mean error of that: above 0, the bake is too bright */
	double noise;        /* part of gathered that more rays would lessen, estimated */
	double shadows;      /* of misplaced edges of lamps' shadows (shadow_error.h), which only denser
							points would lessen */
	double normals;      /* of the normals that lamps shine on, where points are noisy or had none
							(normal_error.h); not of those that point the wrong way */
	double emission;     /* of the power of what emits, whose edges lie somewhere between points
							(emission_error.h); only denser points would lessen it */
	double geometry;     /* of the octree, which the points by themselves do not agree with
							(geometry_error.h) */
	double gaps;         /* of light that would come from gaps, if these were as bright as what
							surrounds them; 0 where no scanner is known */
	double sides;       /* of surfaces that may face the other way, as what points see on both sides
						   says (side_error.h) */
	double sides_share; /* of the points: those that are likely to */
	double narrow;      /* of plates that stand for things as narrow as points are apart, such as
						   leaves and wires, where nothing says how much of them is there
						   (narrow_error.h) */
	double between;     /* of points that are no part of the surface, as light changes between those
						   that are: gw_bake_options.surface_points */
	double halves; /* of the surface, whatever is wrong with it, as gw_bake finds it by bakes of
					  half of the points (half_sample.h): where more than a tenth had no
					  normal, some are strays, points are far apart or on something narrow
					  (spacing_ratio, narrow_share), or some alone make the surface. 0: nobody
					  looked, or nothing was found */
} gw_error_estimate;

/* What gaps let through (gw_gaps), as found for the light of a bake. */
typedef struct gw_gap_report {
	uint32_t scanners; /* whose view is known */
	/* Where none is: holes that the surface has, and of the widest of them its extent and its
	 * middle, metres. With neither scanners nor holes all below is 0. */
	uint32_t holes;
	double hole_width, hole_place[3];
	double share; /* of the directions that points gather light from, weighted as irradiance */
	double sky;   /* of the light that the sky brings: comes through gaps, were they open */
	double lamps; /* of the light of lamps and suns: passes them, where they are open */
	/* The mean radiance over what it is, if gaps were black, and if they were as bright as what
	 * surrounds them. */
	double black, bright;
} gw_gap_report;

/* What a smaller error would cost, predicted from what a bake measured (error_price.h). */
typedef struct gw_price {
	double error; /* relative_rms that could be asked for as max_error; 0 when none can be named */
	double seconds; /* that a bake with it would take; 0 where that is not known */
} gw_price;

/* One round of a bake that refines, or that adds to its most_records: with which settings it
 * solved, and how well. */
typedef struct gw_round {
	float record_spacing, leaf_spacing;
	uint32_t rays, light_samples, cones;
	uint64_t records; /* where more were added, they are closer than the spacing */
	gw_error_estimate error;
	double seconds;
	char why[96]; /* what led to these settings, a phrase */
} gw_round;

/* How a bake that refines came to its end. */
typedef enum gw_goal {
	GW_GOAL_NONE,      /* it was given neither an error nor a time, and had the memory it wanted */
	GW_GOAL_REACHED,   /* the error is as small as asked */
	GW_GOAL_TIME,      /* the next round would not have ended in time */
	GW_GOAL_EXHAUSTED, /* nothing is left that can be refined */
	GW_GOAL_STALLED,   /* finer settings have not lessened the error, twice in a row */
	GW_GOAL_MEMORY,    /* finer settings do not fit into memory */
	GW_GOAL_OUT_OF_REACH, /* what no setting lessens, edges of shadows above all, is more alone */
	GW_GOAL_COUNT
} gw_goal;

/* A number that a user should know about: points repaired, left out, clamped... */
typedef struct gw_count {
	char name[40];     /* snake_case, e.g. "duplicates_merged" */
	char meaning[400]; /* one sentence */
	uint64_t points;
} gw_count;

/* Strays of one kind. */
typedef struct gw_stray_count {
	uint64_t points;
	size_t example;     /* the first of them, its place in gw_points */
	double position[3]; /* and where it is */
} gw_stray_count;

/* What a bake will take, foretold when its octree stands and its lamps have been lit, from light
 * gathered at some hundred places. */
typedef struct gw_forecast {
	uint32_t places;       /* where light was gathered for it; 0: nothing is foretold */
	uint32_t cell_rays;    /* with which each cell of a volume was lit for it; 0: none was */
	uint64_t records;      /* that the bake will have */
	float record_spacing;  /* of these, leaf cells */
	double seconds;        /* of gw_bake, from its call to its return */
	double done_seconds;   /* of these, what is done by then, without the forecast itself */
	double own_seconds;    /* that the forecast took */
	double frame_seconds;  /* of frames: that each one after the first takes; else 0 */
	uint64_t device_bytes; /* device memory at its highest */
	uint64_t host_bytes;   /* of the host, on top of what the process holds by then: the light, and
							  what comes on the device where that shares the host's memory */
	double error, spread;  /* as relative_rms and spread of gw_error_estimate; 0: not known */
	uint32_t bounces;      /* reflections */
	double remaining;      /* as of gw_report */
	double escaped;        /* share of the rays that leave the scene */
	bool error_is_least;   /* bakes of half of the points will follow, and may add to the error
							  what could not be foretold; where it could, the error has the
							  middle of what it may be, and the spread half of its range */
} gw_forecast;

#define GW_REPORT_STAGES 24
#define GW_REPORT_PASSES 64
#define GW_REPORT_EFFECTS 24
#define GW_REPORT_COUNTS 24
#define GW_REPORT_ROUNDS 16

/* Everything a bake says about itself. The fixed capacities count our own stages, effects and
 * counters, not the user's data. bounces is allocated and freed with the result. */
typedef struct gw_report {
	gw_stage stage[GW_REPORT_STAGES];
	uint32_t stage_count;
	gw_pass_count pass[GW_REPORT_PASSES]; /* those that ran, and no others */
	uint32_t pass_count;
	gw_effect effect[GW_REPORT_EFFECTS];
	uint32_t effect_count;
	gw_count count[GW_REPORT_COUNTS];
	uint32_t count_count;
	gw_stray_count stray[GW_STRAY_KIND_COUNT];
	gw_bounce *bounce;
	uint32_t bounce_count;
	/* Seconds on the device, over all bounces: shading the facets, which for cones are then
	 * injected and filtered; tracing rays, once; gathering what rays hit, or by cones. */
	double inject_seconds, trace_seconds, gather_seconds;
	gw_error_estimate error;
	gw_forecast forecast; /* none unless somebody asked: gw_bake_callbacks.planned, gw_plan_bake */
	gw_gap_report gaps;
	bool unlit_space; /* points without normals enclose a space to look at from within, as a room or
						 a cave, while sun and sky light its outer sides alone */
	double unlit_place[3];            /* then: where to stand in it, or to put a lamp; metres */
	gw_price price;                   /* of about half of that error, or what comes nearest to it */
	gw_round round[GW_REPORT_ROUNDS]; /* the last one is the result; none unless the bake refined */
	uint32_t round_count;
	gw_goal goal;
	bool missed;           /* max_error was given and not reached */
	gw_goal gathered_goal; /* where most_records left some out: how adding more came to its end,
							  GW_GOAL_REACHED where gathered_error was reached; else none */
	bool halves_left_out;  /* the surface is in doubt, but for a transport, or want of time, no half
							  of the points was baked: error.halves is 0, the error may be larger */
	double remaining;      /* bound on the light of the bounces not computed, relative */
	char device[256];
	char driver[256];
	uint32_t depth;          /* of the octree */
	double leaf_size;        /* metres */
	double wanted_leaf_size; /* 0; or what leaf_size was to be, but for memory or the device */
	char why_coarser[512];   /* then, a sentence */
	double origin[3];        /* of the local frame, metres */
	double spacing;          /* metres between neighbouring points, median */
	double spacing_ratio; /* of 95 % of the points over that of 5 %, by their eighth neighbours */
	double narrow_share;  /* of the points: on surface that ends on two sides, as leaves do */
	uint64_t leaves, tiles, leaf_tiles, border_tiles, records;
	/* Of a bake of a region, else 0: its points; its records, of all that there are; facets, pieces
	 * of surface in leaves, that its light depends on, and all facets. */
	uint64_t region_points, region_records, region_facets, facets;
	uint64_t surface_points; /* 0, or how many make the surface that lights the others */
	bool directional; /* whether these know from where their light comes: GW_BASIS_DIRECTIONAL */
	float record_spacing; /* with which these were placed, leaf cells; 0: one on every surface, or
							 there are none */
	uint64_t rays, rays_traced; /* of the records; the others kept their hits from other frames */
	uint64_t volume_cells;      /* of a radiance volume, that have light */
	uint64_t buffer_pieces;     /* of surface, that were drawn into buffers of records */
	uint64_t octree_bytes;      /* tiles, keys, neighbour pointers, leaves, planes */
	uint64_t brick_bytes;       /* 3D images */
	uint64_t peak_bytes;        /* device memory at its highest */
} gw_report;

/* Seconds of all stages of that name together; 0 where there are none. */
double gw_report_seconds(const gw_report *report, const char *stage);

/* ------------------------------------------------------------------------------------ results */

/* The leaves of the octree as voxels, for volume grids. */
typedef struct gw_voxels {
	size_t count;
	int32_t *cell;    /* 3 * count, leaf coordinates */
	float *density;   /* count, opacity 0..1 */
	float *radiance;  /* 3 * count, area-weighted mean L of the surface in the leaf */
	float *albedo;    /* 3 * count */
	float *emission;  /* 3 * count */
	float *normal;    /* 3 * count, mean normal (NDF), length <= 1 */
	double origin[3]; /* of cell 0, metres, in the coordinates of gw_points.position */
	double size;      /* of a cell, metres */
} gw_voxels;

/*
 * Radiance that arrives at places in free space from all surfaces and the sky, but not straight
 * from lamps, as real spherical harmonics L = sum c_j Y_j. The Y_j are orthonormal over the sphere,
 * in the order 1; y, z, x; xy, yz, 3z^2-1, xz, x^2-y^2 with positive signs. Irradiance on a plane
 * of normal n is sum A_j c_j Y_j(n) with A_j of pi, 2 pi / 3 and pi / 4 for the three bands.
 */
typedef struct gw_volume {
	size_t count;       /* cells in free space */
	int32_t *cell;      /* 3 * count */
	uint32_t harmonics; /* a cell: 4 or 9 */
	float *radiance;    /* 3 * harmonics * count: of each cell, for each harmonic, c_j as RGB */
	double
		origin[3]; /* of the corner of cell 0, metres, in the coordinates of gw_points.position */
	double size;   /* of a cell, metres */
} gw_volume;

/* Why a light gives nothing. */
typedef enum gw_light_fate {
	GW_LIGHT_SHINES,   /* it does give light; of a region perhaps none, but elsewhere */
	GW_LIGHT_BLACK,    /* it has no power */
	GW_LIGHT_AVERTED,  /* no surface that is in its beam faces it */
	GW_LIGHT_HIDDEN,   /* all that would is in shadow */
	GW_LIGHT_LEFT_OUT, /* its effect was forbidden */
} gw_light_fate;

/* What one light gives. */
typedef struct gw_light_given {
	double share; /* of the light that surfaces get before anything is reflected, luminance of E
					 times area, 0..1; NAN for an environment beside another or beside points that
					 emit: these are gathered together */
	gw_light_fate fate;
} gw_light_given;

/* What a bake found; per-point arrays are in the order of gw_points. Points that were left out
 * (non-finite or invisible) hold zeros. */
typedef struct gw_bake_result {
	size_t count;
	float *radiance;            /* 3 * count, L */
	float *direct_irradiance;   /* 3 * count, E that came straight from lights, emitters and sky */
	float *indirect_irradiance; /* 3 * count, E that was reflected at least once */
	float *normal;              /* 3 * count, the unit normals that were used */
	float *albedo;              /* 3 * count, the albedo that was used, linear */
	float **lamp;               /* lamp_count arrays of 3 * count, what each light adds to L, in the
								   order of the lights; NULL unless gw_bake_options.lamps. With
								   rest they add up to radiance but for roundings, which for
								   GW_METHOD_CONES are of 16-bit numbers */
	size_t lamp_count;
	float *rest;              /* 3 * count, what points that emit add to L; NULL when none does */
	float *ambient_occlusion; /* count, 0..1: cosine-weighted share of the hemisphere in which
						nothing is nearer than ambient_occlusion_distance; NULL unless asked */
	float *bent_normal;       /* 3 * count, unit vectors: the mean direction of that share; zeros
								 where it is 0; NULL unless asked */
	float *error;             /* count, see gw_bake_options.errors; NULL unless asked */
	float *unknown;           /* count, 0..1: share of what is gathered around a point, weighted as
								 irradiance, that would come through gaps; 0 where no scanner is
								 known; NULL unless asked */
	float *roi;               /* count, side of the region of influence in leaf cells */
	uint8_t *stray;           /* NULL when there is none; count, 0 or 1 + the gw_stray_kind */
	uint8_t *asked;           /* NULL: all; count, 1 for points of gw_bake_options.region, else 0:
								 these hold zeros */
	gw_voxels voxels;         /* empty unless gw_bake_options.voxels */
	gw_volume volume;         /* empty unless gw_bake_options.volume */
	gw_light_given *given;    /* given_count, in the order of the lights; NULL with 0 bounces */
	size_t given_count;
	double gathered_share; /* of such light, what environments and points that emit give */
	gw_report report;
} gw_bake_result;

/* What is lit, and by what. All that it points to stays the caller's, and is only read. */
typedef struct gw_scene_description {
	const gw_points *points;
	const gw_light *lights; /* light_count; may be NULL when that is 0 */
	size_t light_count;
} gw_scene_description;

/*
 * Bakes the light of a scene into its points.
 *
 * Returns GW_OK and a result that the caller hands to gw_bake_result_destroy; on failure returns
 * the class, fills *error and leaves *result NULL.
 *   scene        what to light, and by what
 *   options      how to bake; NULL: gw_bake_options_default
 *   callbacks    NULL or see gw_bake_callbacks
 *   result       receives the result
 *   error        NULL or receives the failure
 *
 * What it does once, scenes and lightings below do step by step. The same input, options, device
 * and driver give the same bytes, for any number of threads.
 */
gw_status gw_bake(const gw_scene_description *scene, const gw_bake_options *options,
				  const gw_bake_callbacks *callbacks, gw_bake_result **result, gw_error *error);

/*
 * Says what gw_bake would do with the same scene and options, and what that would take. It makes
 * the octree and lights the lamps, the larger part of most bakes, and gathers at a few places.
 *   options      with a transport, nothing is foretold
 *   callbacks    NULL or see gw_bake_callbacks; planned is called, too
 *   plan         receives a result without points: its report has the effects, what the points and
 *                the octree are, and the forecast; given what each light will give, that of an
 *                environment as the few places found it. All that a bake finds out later is 0
 *
 * Returns and fails as gw_bake.
 */
gw_status gw_plan_bake(const gw_scene_description *scene, const gw_bake_options *options,
					   const gw_bake_callbacks *callbacks, gw_bake_result **plan, gw_error *error);

/* Frees a result and sets *result to NULL; an empty handle is accepted. */
void gw_bake_result_destroy(gw_bake_result **result);

/* The relative luminance of linear RGB, by BT.709: 0.2126 R + 0.7152 G + 0.0722 B, in their unit.
 */
double gw_relative_luminance(double red, double green, double blue);

/* ---------------------------------------------------------------------- scenes and lightings */

/* Points that are prepared: their surface, its octree, and the places where light is gathered with
 * what these see. All of that is there once, however often the scene is lit. */
typedef struct gw_scene gw_scene;

/*
 * Prepares a scene.
 *   description  may be changed or freed afterwards. Where nobody knows from where points were
 *                scanned, its lights orient estimated normals. They need not be those that the
 *                scene is lit by, but the brightest of those should be of about their brightness
 *                where float32 could be left
 *   options      as of gw_bake; NULL: the defaults. max_error and time_limit are refused: what is
 *                fine enough depends on the light, and a scene is there for many; bake once with
 *                the hardest light, and make the scene with the settings of the last gw_round in
 *                its report. What effects_forbidden, shadows and bounces leave no light a use for
 *                is not made, but for a transport that is to be written: no octree for lamps that
 *                nothing hides or reflects
 *   callbacks    NULL, or called during all calls for the scene and its lightings; copied
 *   scene        on success to be given back with gw_scene_destroy; NULL on failure
 * Fails as gw_bake.
 *
 * A scene with its lightings belongs to one thread at a time.
 */
gw_status gw_scene_create(const gw_scene_description *description, const gw_bake_options *options,
						  const gw_bake_callbacks *callbacks, gw_scene **scene, gw_error *error);

/* After all of its lightings. Sets *scene to NULL; an empty handle is accepted. */
void gw_scene_destroy(gw_scene **scene);

/*
 * Gives the points other emission; all else stays as it was prepared, so that lamps and screens are
 * switched at the price of a lighting; the light is that of such a scene prepared anew but for
 * roundings. Lightings have to be changed before they are read again. On failure the emission is as
 * it was.
 *   emission   3 * gw_scene_point_count, as gw_points.emission, or NULL: none; copied
 */
gw_status gw_scene_change_emission(gw_scene *scene, const float *emission, gw_error *error);

/* The number of its points: those that it was made of, in their order. */
size_t gw_scene_point_count(const gw_scene *scene);

/* What is known of the scene, and of its last lighting; stays valid and changes with every call for
 * the scene. */
const gw_report *gw_scene_report(const gw_scene *scene);

/* A scene in the light of some lamps, sky, and its own emission. */
typedef struct gw_lighting gw_lighting;

/*
 * Lights a scene. The result is that of gw_bake with the same lights, to the last bit, where
 * normals do not depend on them.
 *   lights    light_count; copied, but for maps, which have to stay as long as the lighting
 *   lighting  on success to be given back with gw_lighting_destroy; NULL on failure
 * A scene can have several, for those who compare; what they ask later than for their radiance is
 * solved again when another one was lit since.
 */
gw_status gw_lighting_create(gw_scene *scene, const gw_light *lights, size_t light_count,
							 gw_lighting **lighting, gw_error *error);

/* Lights the scene by other lights, in the same memory. On failure nothing can be read until a
 * change succeeds. */
gw_status gw_lighting_change(gw_lighting *lighting, const gw_light *lights, size_t light_count,
							 gw_error *error);

/* Writes what the points send out.
 *   radiance   3 * gw_scene_point_count, L; points that were left out are dark */
gw_status gw_lighting_radiance(gw_lighting *lighting, float *radiance, gw_error *error);

/* All that gw_bake would return, and by the scene's options. The result is the caller's. */
gw_status gw_lighting_result(gw_lighting *lighting, gw_bake_result **result, gw_error *error);

/* How wrong the radiance is, by points that are solved again: gw_bake_options.estimate_points of
 * the scene, above 0. */
gw_status gw_lighting_error(gw_lighting *lighting, gw_error_estimate *estimate, gw_error *error);

void gw_lighting_destroy(gw_lighting **lighting); /* sets *lighting to NULL; NULL is fine */

/* ------------------------------------------------------------------------------------- frames */

/* Points that move as one: first .. first + count - 1. */
typedef struct gw_mover {
	size_t first, count;
} gw_mover;

/* What moves, over all frames. */
typedef struct gw_motion {
	const gw_mover *mover; /* mover_count, ascending, without points in common */
	size_t mover_count;    /* may be 0: lamps alone move */
	size_t frame_count;    /* at least 1 */
	const double *matrix;  /* 16 * mover_count * frame_count, row-major, all movers of frame 0
							  first: from where gw_points has a mover to where the frame has it. It
							  may turn, mirror, move and scale evenly */
} gw_motion;

/* A scene in which something moves. What this points to must outlive the frames made of it. */
typedef struct gw_moving_scene {
	gw_scene_description scene; /* movers are where the motion's matrices begin; lights orient
								   estimated normals without a scanner */
	const gw_motion *motion;
} gw_moving_scene;

/* How frames are baked. */
typedef struct gw_frames_options {
	bool rebuild;     /* every frame from scratch, to check and to compare */
	bool independent; /* no frame begins with the light of the one before */
} gw_frames_options;

/* A bake of many frames; what stands still is prepared once (Salm 4.5). */
typedef struct gw_frames gw_frames;

/*
 * Begins. Every mover is a surface of its own: what touches it or passes by alters neither its
 * discs nor the other's. The octree's cube and leaves are the same in all frames.
 *   options  as of gw_bake, without max_error, time_limit and transport; an error is
 *            estimated for the first frame that is baked
 *   frames   on success to be closed with gw_frames_close; NULL on failure
 * Fails as gw_bake; GW_ERROR_DATA when a matrix does more than it may.
 */
gw_status gw_frames_open(const gw_moving_scene *scene, const gw_bake_options *options,
						 const gw_frames_options *how, const gw_bake_callbacks *callbacks,
						 gw_frames **frames, gw_error *error);

/*
 * Bakes one frame, in any order. The result is that of the same frame from scratch: the same to the
 * last bit but for rays that graze the edge of a cell, and unless `independent` for the tolerance
 * of the bounces, which begin with the light of the frame baked before.
 *   frame    below motion->frame_count
 *   lights   light_count, of this frame
 *   result   as of gw_bake
 * After a failure other than a bad argument the frames can only be closed.
 */
gw_status gw_frames_bake(gw_frames *frames, size_t frame, const gw_light *lights,
						 size_t light_count, gw_bake_result **result, gw_error *error);

/*
 * Says what bakes of frames would do and what they would take, as gw_plan_bake does for one bake:
 * bakes two of them with few records. Afterwards the frames are as when they were opened.
 *   frame    two of them: the first that will be baked, and one that stands for all others. Where
 *            they are the same, one alone will be
 *   lights   light_count lights of each of the two
 *   plan     as of gw_plan_bake for the first frame; seconds of its forecast are until that is
 *            done, frame_seconds of each one that follows
 */
gw_status gw_frames_plan(gw_frames *frames, const size_t frame[2], const gw_light *const lights[2],
						 size_t light_count, gw_bake_result **plan, gw_error *error);

/* Seconds that went into what all frames share, so far. */
double gw_frames_shared_seconds(const gw_frames *frames);
void gw_frames_close(gw_frames **frames); /* sets *frames to NULL; NULL is fine */

/* --------------------------------------------------------------------------------- statistics */

/* What a cloud looks like before baking; for `glowworm info` and the choice of settings. */
typedef struct gw_statistics {
	uint64_t points, finite, duplicates; /* duplicates: points beyond the first at a position */
	double minimum[3], maximum[3];       /* bounds of the finite points, metres */
	double spacing[3];                   /* 5th, 50th and 95th percentile of the distance to the
											nearest other point, metres; this and density are of
											a million points where there are more */
	double density;                      /* points a square metre of surface, median */
	uint64_t normals_given, normals_bad; /* usable ones; zero or non-finite ones */
	gw_stray_count stray[GW_STRAY_KIND_COUNT]; /* points that belong to no surface, by kind */
	uint32_t depth;                            /* that GW_DEPTH_AUTO would choose */
	uint64_t memory; /* bytes that a process takes at most that bakes all of them by default
						settings, of most clouds */
} gw_statistics;

/* Measures a cloud. threads: 0 means one a core. */
gw_status gw_measure(const gw_points *points, uint32_t threads, gw_statistics *statistics,
					 gw_error *error);

/* ------------------------------------------------------------------------------------- devices */

/* A limit of a device, and what a bake of a million points needs of it. */
typedef struct gw_device_limit {
	const char *name; /* "storage buffers": of a pass */
	uint64_t needed, there;
} gw_device_limit;

#define GW_DEVICE_LIMITS 9

typedef struct gw_device_info {
	char name[256];
	char driver[256];
	const char *type; /* "discrete", "integrated", "virtual", "cpu" or "other" */
	uint64_t memory;  /* bytes of the largest device-local heap */
	uint32_t subgroup_size;
	uint32_t version[3]; /* of Vulkan */
	bool usable;         /* has all that a bake needs */
	char missing[128];   /* when not usable: what it lacks */
	gw_device_limit limit[GW_DEVICE_LIMITS];
} gw_device_info;

/*
 * Lists the Vulkan devices in the order in which glowworm prefers them.
 *   devices  receives an array that the caller frees with free(); NULL when *count is 0
 */
gw_status gw_devices(gw_device_info **devices, size_t *count, gw_error *error);

/* Version of the Vulkan loader; all 0 when it does not say. */
void gw_vulkan_version(uint32_t version[3]);

/* What a device does that its description does not say. */
typedef struct gw_device_trial {
	char name[256];
	uint64_t budget;                 /* bytes of its memory that a bake may take */
	uint32_t loops_asked, loops_run; /* steps of a loop; drivers may end it before */
	uint32_t loops_needed;           /* most steps that a pass of a bake takes */
	bool reckons;                    /* the steps that were run have the right outcome */
	double open_seconds, compile_seconds;
} gw_device_trial;

/*
 * Opens a device as a bake does and runs a loop on it that software drivers are known to cut. A
 * driver may end the process: call it in one that is not needed.
 *   device, memory   as of gw_bake_options
 */
gw_status gw_device_try(const char *device, uint64_t memory, gw_device_trial *trial,
						gw_error *error);

/*
 * Begins to load the drivers of all devices on a thread of its own, which takes some 40 ms, so that
 * a bake finds them loaded that begins later (gw_bake_options.drivers): call it before reading
 * files. Nothing depends on it, so it never fails; NULL is returned where there are no threads or
 * memory.
 */
gw_drivers *gw_drivers_load(void);

/* Waits until they are loaded and gives them back; after all bakes. NULL is accepted. */
void gw_drivers_release(gw_drivers **drivers);

/* ---------------------------------------------------------------------------------------- names */

/* Names of the enum values as used on the command line and in reports ("rays", "traced", "spot").
 */
const char *gw_method_name(gw_method method);
const char *gw_shadows_name(gw_shadows shadows);
const char *gw_gaps_name(gw_gaps gaps);
const char *gw_basis_name(gw_basis basis);
const char *gw_effect_name(gw_effect_kind effect); /* "lamps": of gw_effect, too */
const char *gw_pass_choice_name(gw_pass_choice choice);
const char *gw_validation_name(gw_validation validation);
const char *gw_quality_name(gw_quality quality);
const char *gw_goal_name(gw_goal goal);
const char *gw_light_type_name(gw_light_type type);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#ifdef __cplusplus
}
#endif

#endif
