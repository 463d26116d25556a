/*
 * glowworm_picture.h - public interface of libglowworm for pictures of points: from points to discs
 * of surface, what a camera sees of them, what glossy ones reflect, and the octree to look at; and
 * how far two lightings of the same points are apart.
 *
 * It reads and writes no files either. What is not said otherwise is as in glowworm.h.
 */
#ifndef GLOWWORM_PICTURE_H
#define GLOWWORM_PICTURE_H

#include "glowworm.h"

#ifdef __cplusplus
extern "C" {
#endif

#ifdef __GNUC__
#pragma GCC visibility push(default)
#endif

/* -------------------------------------------------------------------------------------- surfels */

/*
 * The surfels of a cloud. Arrays hold `count` elements (times 3 where said).
 *
 * Order is canonical: by Morton key of the position on a 2^21 grid over the bounds, then by the
 * exact coordinates, so that it does not depend on the order of the input.
 */

/* A point that belongs to no surface and is no surfel. */
typedef struct gw_stray {
	uint32_t point;  /* which */
	uint32_t surfel; /* the one that is nearest, whose light it gets */
	uint32_t kind;   /* a gw_stray_kind */
	float albedo[3], emission[3];
} gw_stray;

/* Of surface of which nobody knows which side is the front: either side is lit by itself, if the
 * backs have surfels, which come behind all others, in the same order. */
#define GW_SIDE_UNCLEAR 2
#define GW_SIDE_BACK 3

/* Foliage: small things that fill space, such as leaves, of which nobody knows how each lies. Lit
 * from both sides at once. Its disc is twice as large as the thing, half of it is clear, and only
 * the sum of them counts (shaders/octree/opacity.glsl). */
#define GW_SIDE_FOLIAGE 4
#define GW_FOLIAGE_TRANSPARENCY 0.5f

typedef struct gw_surfels {
	size_t count;     /* distinct finite positions, and backs */
	char up;          /* as gw_points has it */
	double origin[3]; /* of the local frame: whole metres (a power of two below a metre for clouds
						 under a metre), chosen from the bounds */
	float minimum[3], maximum[3]; /* bounds in the local frame, without what is far off all the rest
								   */
	float *position;              /* 3 * count, metres in the local frame; of noisy points their
									 place on the surface that they scatter around */
	float *normal;                /* 3 * count, unit; of noisy points that of this surface */
	float *shading_normal;     /* NULL when no point is noisy, else 3 * count, unit, the points' own
							   without what of them is noise: lamps shine on these */
	float *shading_normal_off; /* NULL when no point is noisy and all normals were given, else
						count, radians, RMS angle by which the normals that lamps shine on are
						expected to be off */
	float *normal_length;      /* count, length of the given normal in (0, 1]: spread of the NDF */
	float *albedo;       /* 3 * count, linear, in [0, GW_ALBEDO_MAX]; the mean of merged points */
	float *emission;     /* 3 * count, >= 0; NULL when nothing emits */
	bool emission_alone; /* what emits shows itself and lights nothing: emitters are forbidden */
	float *transparency; /* count, 1 - opacity, below 1; NULL when all are opaque */
	float *nearest;      /* count, maximum-norm distance to the nearest other surfel, metres
							(Salm 4.3.4); infinity for a cloud of one */
	float *radius;    /* count, metres, of the disc: distance to the 8th neighbour on the surface,
						 or half that to the furthest where scan lines are far apart */
	float *area;      /* count, m^2, that the surfel stands for: its Voronoi cell on the surface */
	float *clip;      /* 6 * count: two half-planes in the disc's plane that cut it at edges:
						 direction x, y in the disc's tangent frame  and the
						 distance beyond which nothing of it lies; (0, 0, 0): none */
	float *bend;      /* 3 * count or NULL, per metre: how the surface curves away from the disc,
						 which is bent by it: at (x, y) of the tangent frame it is
						 (bend[0] x^2 + 2 bend[1] x y + bend[2] y^2) / 2 above its plane */
	uint8_t *creased; /* count or NULL, 1 where all cuts are at creases with other surfaces, whose
						 place is known from both sides */
	uint8_t *two_sided; /* count, 1 where the normal cannot be trusted: lit from both sides at once;
						   or GW_SIDE_UNCLEAR, GW_SIDE_BACK or GW_SIDE_FOLIAGE; else 0 */
	float *doubt; /* count or NULL, chance that the disc is a plate in the air, in [0, 1], where
					 narrow things have no normals */
	float *noise; /* count, metres, RMS distance of the neighbours as they were given to the
					 fitted plane */
	uint32_t *surfel_of_point; /* point_count: surfel of each point, UINT32_MAX: left out, or not
								  chosen */
	float *albedo_of_point; /* 3 * point_count, in [0, GW_ALBEDO_MAX]; NULL where each point has its
							   surfel's. Points that share a surfel share its light, and each
							   reflects it by its own albedo */
	size_t point_count;
	gw_stray *stray; /* stray_count; NULL when there is none */
	size_t stray_count;
	float spacing;     /* metres, median of sqrt(area): width of a surfel's share of surface */
	double given_area; /* m^2, sum of area */
	float disc_most;   /* leaf cells, 1 or more: octrees hold discs of larger radii in a tree of
						  their own; 0: as is usual */
	const void *lent;  /* arrays that lie in these lent_bytes are not its own; or NULL */
	size_t lent_bytes;
	float noise_taken; /* metres, RMS: noise that was taken out of the places of bare points before
						  planes were put through them; 0: none was looked for, or found */
	bool seen_from_above; /* normals were missing, and it is ground that was seen from above alone:
							 what of these faces up does so rightly */
	/* What was repaired, for the report. Normals count surfels, the others points. */
	uint64_t non_finite, duplicates, albedo_clamped, emission_repaired, normals_given,
		normals_estimated, normals_untrusted, albedo_defaulted;
	/* Of given normals that were mended: those turned round, and those found so wrong that none
	 * was taken, and those of no sensible length. */
	uint64_t normals_turned, normals_doubted, normals_lengthened;
} gw_surfels;

/*
 * Chooses surfels before their neighbours are looked for: those that nobody asks for cost nothing.
 *   surfels   all of them, with their frame, positions, normals, albedo, emission, two_sided and
 *             surfel_of_point; area, radius and spacing are rough, the rest is NULL
 *   chosen    surfels->count, all 0; receives 1 for those to keep
 */
typedef gw_status gw_surfels_chooser(void *user, const gw_surfels *surfels, uint8_t *chosen,
									 gw_error *error);

typedef struct gw_surfels_options {
	uint32_t threads;       /* 0: one a core */
	const gw_light *lights; /* light_count; orient estimated normals when there is no scanner */
	size_t light_count;
	gw_normals_choice normals;
	uint64_t memory; /* bytes the step may use beyond its result; chunks follow from it */
	gw_surfels_chooser *choose; /* NULL: all. What surrounds the chosen ones is to be chosen too,
								   about twice as far as their neighbours are. At least some
								   16 are kept, so that there is something to make */
	void *chooser;              /* for choose */
	bool choose_by_place;       /* choose does not look at normals: those of the others that are
								   missing need not be made */
	bool rough_area;            /* area is the disc's, shared among the points that it reaches to;
								   a picture needs no better */
	bool backs;                 /* what may face either way has surfels of both sides */
	uint32_t effects_forced, effects_forbidden; /* of gw_bake_options: what of the surface is made
												   whatever the points call for */
	bool (*cancelled)(void *user);
	void *user;
} gw_surfels_options;

/*
 * Makes the surfels of a cloud.
 *   surfels   on success owned by the caller, freed with gw_surfels_clear; zeroed on failure
 * Fails with GW_ERROR_DATA when no point is finite, GW_ERROR_MEMORY, GW_ERROR_CANCELLED.
 * The result does not depend on the order of the points nor on the number of threads.
 */
gw_status gw_surfels_make(const gw_points *points, const gw_surfels_options *options,
						  gw_surfels *surfels, gw_error *error);
void gw_surfels_clear(gw_surfels *surfels);

/*
 * Finds where the scanner of a range image stood: the place that the image says, if its rows and
 * columns are seen at even angles from there, or else the place from which they are. Noise, mixed
 * pixels and strays are along the rays, and so do no harm; but where a picture shows nothing
 * except one flat wall, no place is better than any other.
 *   points    with image_cell
 *   scanner   receives it on success, and may be the image's own
 * Returns false when there is none, and when memory is short.
 */
bool gw_range_image_find_scanner(const gw_points *points, const gw_range_image *image,
								 double scanner[3]);

/*
 * Finds where a scanner or a depth camera stood that took all of some points, of which no more is
 * known than where they are: the place from which they lie as densely as its beams do, which are
 * spread evenly over directions, or over those of a scanner that turns about the axis that points
 * up, or about a level one, x, y or z, as lasers that nod and fans that roll do. Where the surface
 * is flat each point has r^2 / cos of it. What several stations took, what was thinned by a grid,
 * and samples of meshes lie otherwise, and so nothing is found.
 *   points    position and up; strays do no harm
 *   scanner   receives the place on success, metres
 * Returns false when there is none, and when memory is short. The same points in the same order
 * give the same place.
 */
bool gw_points_find_scanner(const gw_points *points, double scanner[3]);

/* -------------------------------------------------------------------------------------- cameras */

/*
 * A pinhole camera: where it stands, where it looks, and how wide.
 *
 * A camera is in double precision and in the coordinates of gw_points.position. In its own frame x
 * points right, y up and z the way it looks; a point (x, y, z) there is seen at (x / z, y / z) on
 * the image plane, whose half height is `tangent`.
 */

typedef struct gw_camera {
	double position[3];                 /* metres */
	double right[3], up[3], forward[3]; /* unit, orthogonal */
	double tangent;                     /* of half the vertical angle of view, above 0 */
	double near;                        /* metres along `forward`; nothing nearer is seen */
} gw_camera;

/* The widest vertical angle of view, degrees: a pinhole's picture grows without bound to 180. */
#define GW_CAMERA_ANGLE_MAX 175.0

/*
 * Sets a camera up.
 *   camera   receives it; its near distance is 0, to be set by the caller
 *   at, to   metres; where it stands and a point in the middle of its picture
 *   up       which way is up in the picture; any length above 0
 *   angle    degrees, vertical angle of view, above 0 and at most GW_CAMERA_ANGLE_MAX
 * Fails with GW_ERROR_USAGE when the angle is outside of that, a number is not finite, `at` is `to`
 * or so near to it that doubles cannot tell the direction, or it looks straight along `up`.
 */
gw_status gw_camera_look(gw_camera *camera, const double at[3], const double to[3],
						 const double up[3], double angle, gw_error *error);

/*
 * The axis that a letter names: 'x', 'y' or 'z', and 'X', 'Y' or 'Z' for the same ones downwards.
 *   axis  receives it, unit
 */
void gw_camera_up(char up, double axis[3]);

/*
 * Whether points of which nobody said so look as if y pointed up, where z is the custom: they have
 * a floor and a ceiling across y, or stand on a base there, or are open there alone, as a thing is
 * whose base was not scanned, or are a box with things that stand there alone.
 *   position   3 * count, of any unit
 *   sure       receives whether it is a base; floor and ceiling may be the walls of a corridor,
 *              what is open may be a niche, and what stands in a box may hang on its wall
 * Returns 'y', or 0: nothing speaks against z.
 */
char gw_likely_up(const double *position, size_t count, bool *sure);

/*
 * A right-handed frame for such an axis: x for 'z', and y for it, are to the right and to the back
 * of who looks straight at a cloud, and for 'Y', as depth cameras have it, that is x and z.
 *   right, back, up  receive unit vectors
 */
void gw_camera_stand(char axis, double right[3], double back[3], double up[3]);

/* Turns a vector from the world's axes to the camera's. */
void gw_camera_turn(const gw_camera *camera, const double world[3], double view[3]);

/*
 * Whether something of a ball may be in the picture; also true for some that are just outside.
 *   aspect   width of the picture by its height
 *   centre   metres
 *   radius   metres, 0 or more
 */
bool gw_camera_sees(const gw_camera *camera, double aspect, const double centre[3], double radius);

/*
 * Turns a camera by an angle around an axis through a point, counterclockwise as seen from the
 * tip of the axis.
 *   centre   metres
 *   axis     unit
 *   radians  any
 */
void gw_camera_orbit(gw_camera *camera, const double centre[3], const double axis[3],
					 double radians);

/* ----------------------------------------------------------------------------------- viewpoints */

/*
 * From where to look at a cloud when nobody says it.
 */

/* What is asked of a viewpoint. */
typedef enum gw_viewpoint_kind {
	GW_VIEWPOINT_AUTO,    /* inside when the surface encloses a space, else outside */
	GW_VIEWPOINT_INSIDE,  /* from within the space that the surface encloses */
	GW_VIEWPOINT_OUTSIDE, /* from without, all of the cloud in the picture */
	GW_VIEWPOINT_COUNT
} gw_viewpoint_kind;

/* What viewpoint is looked for. */
typedef struct gw_viewpoint_wish {
	gw_viewpoint_kind kind; /* GW_VIEWPOINT_INSIDE falls back to outside when no cell is enclosed */
	const float *luminance; /* count of the surfels, or NULL: all count as lit */
	char up;                /* as gw_camera_up has it */
	double angle;           /* degrees, vertical angle of view; 0: the one that suits */
	double aspect;          /* width of the picture by its height */
	bool around;            /* from outside, all has to be in the picture from every side */
	const double *scanner;  /* 3 * scanner_count, as in gw_points, or NULL */
	size_t scanner_count;
} gw_viewpoint_wish;

/* Vertical angles of view that suit them, degrees. */
#define GW_VIEWPOINT_ANGLE_INSIDE 55.0
#define GW_VIEWPOINT_ANGLE_OUTSIDE 40.0

typedef struct gw_viewpoint {
	double at[3], to[3]; /* metres, in the coordinates of gw_points.position */
	double angle;        /* degrees, vertical angle of view */
	double near;         /* metres; what is nearer than this is in the way of what counts */
	bool inside;
	bool from_scanner; /* where the only one stood, which did not turn around */
	char flat; /* as gw_camera_up has it, 0 as a rule: much of the surface is flat across this axis,
				  as ground is, and not across `up` */
} gw_viewpoint;

/*
 * How much of the surface looks inwards, -1 (a closed object seen from outside) to 1 (a closed room
 * with normals into it): by the divergence theorem the sum of area * normal * position is three
 * times the volume that the surface encloses; it is divided by the sum of its terms' magnitudes.
 * Surfels whose normals cannot be trusted do not count. About 0 for terrain.
 */
double gw_viewpoint_enclosure(const gw_surfels *surfels);

/*
 * Finds a viewpoint. Points far from the rest, and small groups of such, do not count.
 *
 * Space is cut into coarse cells, and rays go out from the free ones in all directions. Where most
 * of them meet a surface the cell is enclosed. A cloud is seen from inside when it encloses space,
 * most of its surface is seen from there, and its fronts are: by its normals if they were given,
 * else because scanners stood there, or else because there is a floor to stand on, of a size for
 * people. A space that is open on a side, such as a stage, is looked at from outside. But where
 * fronts and light are known, it is seen from inside, too, when most of the light is there, and
 * less than a quarter of it where the view from outside shows it.
 *
 * Inside: where there is floor, at the height of eyes, or in the air when there is none; the view
 * is best that sees far, and lit surfaces. Outside: slightly from above, where most surface is seen
 * by its front and lit, which is three quarters from the front for boxes and steeper for terrain,
 * as near as the picture holds all that counts. When one scanner is known, and it did not turn
 * around, as depth cameras do not: from its place, without what other places show to be missing.
 * Fails with GW_ERROR_MEMORY.
 */
gw_status gw_viewpoint_find(const gw_surfels *surfels, const gw_viewpoint_wish *wish,
							gw_viewpoint *viewpoint, gw_error *error);

/* --------------------------------------------------------------------------------- what is seen */

/*
 * Surfels and triangles seen by a camera: a G-buffer, made on the CPU.
 *
 * Deferred, as in Salm 4.1 and 4.6: geometry is drawn once into a buffer of attributes, and a later
 * pass turns those into colours. A surfel is a flat disc, drawn with exact perspective: along each
 * ray the depth of its plane. Where discs of one surface overlap, their attributes are blended with
 * a weight that falls from the centre to the rim (surface splatting after Zwicker et al. 2001, in
 * the two passes of Botsch et al. 2005):
 *
 *   1. the nearest depth of every sample;
 *   2. the weighted mean over all fragments that belong to the surface there: not much further
 *      than the nearest, and facing the same way.
 *
 * The back of a disc gives way to a front within half a radius, so that of a sheet with two sides,
 * or a box on a floor, the side is seen that looks at the camera.
 *
 * Where the nearest surface is thin, which is the rim of a disc or two that stick out over an edge,
 * both passes are repeated behind it, and solid surface found there is shown instead. Where nothing
 * is, they are repeated without the half-planes at which discs are cut, and what that brings is
 * shown if it closes a hole: with surface on both sides.
 *
 * Where discs that glow lie among others, a sample shows the kind that weighs more, so that a lamp
 * ends where its points end, not where the last of its discs does.
 *
 * Where the nearest surface lets light through, all of that is repeated behind it, until no more
 * than 1/256 of what lies behind is seen: each surface once, in the order of their depth.
 *
 * A disc smaller than a sample is widened until it meets one, and weighs as much less as it grew,
 * so that points below a sample's size neither vanish nor outweigh others.
 *
 * The picture is cut into tiles, each of which goes over its own list of primitives from near to
 * far, in an order that depends on nothing else; so the result is the same for any number of
 * threads.
 */

/* Limits of gw_raster_options. */
#define GW_RASTER_SIZE_MAX 16384u
#define GW_RASTER_SAMPLES_MAX 8u
#define GW_RASTER_CHANNELS_MAX 32u

/* The id of a pixel that shows nothing. */
#define GW_RASTER_NOTHING UINT32_MAX

/* Discs to draw; all arrays belong to the caller and stay unchanged. */
typedef struct gw_raster_discs {
	size_t count;
	const float *position;     /* 3 * count, metres in the local frame */
	const float *normal;       /* 3 * count, unit */
	const float *radius;       /* count, metres; 0: not drawn */
	const float *clip;         /* 6 * count or NULL: half-planes as in gw_surfels.clip */
	const uint8_t *two_sided;  /* count or NULL: 1 where the normal's sign means nothing */
	const uint8_t *glows;      /* count or NULL: 1 for those that are not blended with others */
	const float *transparency; /* count or NULL: 0; share of what lies behind that is seen */
	const float *channel;      /* channel_count * count, what is blended */
} gw_raster_discs;

/* Triangles to draw, as an indexed mesh; all arrays belong to the caller and stay unchanged. */
typedef struct gw_raster_triangles {
	size_t count; /* triangles */
	size_t vertex_count;
	const uint32_t *index; /* 3 * count, below vertex_count; counterclockwise from the front */
	const float *position; /* 3 * vertex_count, metres in the local frame */
	const float *normal;   /* 3 * vertex_count, unit; or NULL: the triangles' own */
	const float *channel;  /* channel_count * vertex_count, interpolated linearly */
} gw_raster_triangles;

typedef struct gw_raster_scene {
	double origin[3]; /* of the local frame, metres */
	gw_raster_discs discs;
	gw_raster_triangles triangles;
	uint32_t channel_count; /* floats a disc or vertex, at most GW_RASTER_CHANNELS_MAX */
} gw_raster_scene;

typedef struct gw_raster_options {
	uint32_t width, height; /* pixels, 1..GW_RASTER_SIZE_MAX */
	uint32_t samples;       /* a side of the grid in every pixel, 1..GW_RASTER_SAMPLES_MAX */
	float radius_scale;     /* every disc's radius times this; 1 draws the surface */
	bool cull;              /* leave out what is seen from behind */
	uint32_t threads;       /* 0: one a processor */
	bool (*cancelled)(void *user);
	void *user;
} gw_raster_options;

/* What is seen in each pixel. Rows run from the top to the bottom of the picture. */
typedef struct gw_gbuffer {
	uint32_t width, height, channel_count;
	float *coverage; /* width * height, share of the pixel that something covers, 0..1; times its
						opacity, with all that is behind it */
	float *depth;    /* width * height, metres along the camera's forward axis, of the nearest
						sample; infinity where there is nothing */
	float *facing;  /* width * height, mean of the covered samples' |cosine| between normal and ray:
					   more than the mean normal tells where surfaces meet; 0 for nothing */
	float *normal;  /* 3 * width * height, unit, in the world's axes; 0, 0, 0 for nothing */
	float *channel; /* channel_count * width * height, mean over what is covered (not multiplied
					   by the coverage), each surface by how much of it is seen; 0 for nothing.
					   All else is of the nearest */
	uint32_t *id;   /* width * height, of the nearest primitive: a disc's index, or the number of
					   discs plus a triangle's index; GW_RASTER_NOTHING */
	uint64_t drawn; /* primitives that reach into the picture */
} gw_gbuffer;

/*
 * Draws a scene.
 *   gbuffer   on success owned by the caller, freed with gw_gbuffer_clear; zeroed on failure
 * Fails with GW_ERROR_USAGE when a size is out of its limits, GW_ERROR_MEMORY, GW_ERROR_CANCELLED.
 * A scene of which nothing is in view gives an empty picture with drawn = 0.
 * Thread-safe: draws with threads of its own.
 */
gw_status gw_raster_draw(const gw_raster_scene *scene, const gw_camera *camera,
						 const gw_raster_options *options, gw_gbuffer *gbuffer, gw_error *error);
void gw_gbuffer_clear(gw_gbuffer *gbuffer);

/* --------------------------------------------------------------------------------------- meshes */

/*
 * Triangles that take their light from the points on them.
 *
 * A mesh that was sampled and lit is drawn as what it is: its triangles are cut into smaller ones,
 * as small as the points are dense, each corner of a triangle takes what the points around it on
 * the same side have, and the points on the mesh are not drawn themselves.
 */

/* Triangles cut small, three corners of their own each. Zeroed: none. */
typedef struct gw_tessellation {
	float *position; /* owned; 9 * count, metres in the surfels' frame */
	float *normal;   /* owned; 9 * count, unit */
	float *channel;  /* owned; 3 * channel_count * count, from gw_mesh_light; NULL before */
	size_t count, capacity;
	/* Set before the first triangle is added: */
	float longest;                /* metres, of an edge */
	float minimum[3], maximum[3]; /* bounds; triangles that are wholly outside are left out */
	size_t most;                  /* no more triangles than this are added */
} gw_tessellation;

/*
 * Adds a triangle, cut by halving its longest edge until none is longer than `longest`. Edges that
 * triangles share are cut at the same places, so that no gaps arise.
 *   corner   9, metres in the surfels' frame, finite
 *   normal   9, unit
 * Fails with GW_ERROR_MEMORY.
 */
gw_status gw_tessellation_add(gw_tessellation *triangles, const float corner[9],
							  const float normal[9], gw_error *error);
void gw_tessellation_clear(gw_tessellation *triangles);

/* Numbers that surfels have. */
typedef struct gw_surfel_channels {
	const float *channel; /* count * surfels */
	uint32_t count;       /* a surfel */
} gw_surfel_channels;

/*
 * Finds the points on the triangles and lights these by them. Those with no point near are taken
 * off: nobody knows their light.
 *   channels  what the surfels have, and triangles get
 *   on_mesh   surfels->count; receives 1 for each that lies on a triangle
 * Fails with GW_ERROR_MEMORY. The result does not depend on the number of threads.
 */
gw_status gw_mesh_light(gw_tessellation *triangles, const gw_surfels *surfels,
						gw_surfel_channels channels, uint32_t threads, uint8_t *on_mesh,
						gw_error *error);

/* -------------------------------------------------------------------------------------- octrees */

/*
 * An octree with radiance that is known, ready to be read at the pixels of a
 * picture: what they see reflected, and what the bricks hold where they are (Salm 4.6).
 *
 * The glossy bounce is traced by rays against the planes in the leaves. The thesis's one cone a
 * pixel is there, too: free of noise and some five times as quick as 32 rays, but it does not come
 * nearer to the truth with more work. Against 1024 rays a pixel, in a Cornell box with a metal ball
 * and a painted cube, the RMS error in a picture's 255 steps is 5.0 with 32 rays and 2.6 with 128,
 * and 8.5 with the cone, most of it where the lamp's reflection ends.
 */

typedef struct gw_render_octree_options {
	const char *device; /* as gw_bake_options, like the next */
	gw_pass_choice passes;
	gw_validation validate;
	uint64_t memory;    /* bytes; 0: most of what is free */
	uint32_t depth;     /* of the octree, or GW_DEPTH_AUTO */
	float leaf_spacing; /* as gw_bake_options, of GW_DEPTH_AUTO */
	bool regions;       /* leaves that only regions of influence reach, and border tiles, too: for
						   lists of cells. Rays do without them */
	bool bricks;        /* fill the brick pools: for cones, gw_render_octree_read and levels; with
						   regions in any case */
} gw_render_octree_options;

/* Opaque. */
typedef struct gw_render_octree gw_render_octree;

/* Places at which something is read; arrays belong to the caller. */
typedef struct gw_pixels {
	size_t count;
	const float *position; /* 4 * count: metres in the surfels' local frame; roughness, 0..1 */
	const float *normal;   /* 4 * count: unit; reflectance at normal incidence, 0..1 */
	float eye[3];          /* metres in the local frame */
	/* Where they stand in their picture, for caches; else NULL and 0. */
	const uint32_t *place; /* count: row * width + column, ascending */
	uint32_t width, height;
	float step; /* width of a pixel at a distance of 1 */
} gw_pixels;

typedef struct gw_reflection {
	uint32_t rays; /* a pixel whose surface is rough, at least 1; a mirror takes one */
	bool cone;     /* one cone instead; needs bricks */
	bool caches;   /* rough pixels share radiance caches instead; needs gw_pixels.place */
	float sky[3];  /* even radiance of what meets nothing, besides gw_render_octree_set_sky */
	uint32_t seed;
	bool (*cancelled)(void *user); /* NULL or asked between rays */
	void *user;
	/* Of gw_probes_reflect: traces the rays that no probe serves. NULL: they see what the best one
	 * sees in their direction */
	struct gw_render_octree *octree;
} gw_reflection;

/* Rays whose noise a rough pixel has: caches leave less than few rays. */
uint32_t gw_reflection_rays(const gw_reflection *reflection, float roughness);

/*
 * Builds the octree and puts the radiance into it.
 *   radiance   3 * surfels->count
 *   made       on success freed with gw_render_octree_destroy; NULL on failure
 * Fails as gw_gpu_create and gw_octree_build.
 */
gw_status gw_render_octree_create(const gw_surfels *surfels, const float *radiance,
								  const gw_render_octree_options *options, gw_render_octree **made,
								  gw_error *error);
void gw_render_octree_destroy(gw_render_octree **octree);

/*
 * What is seen where nothing else is met: the map of an environment light, times its radiance.
 *   light   read now; its map may go afterwards. NULL: no map, as at first
 * GW_ERROR_MEMORY.
 */
gw_status gw_render_octree_set_sky(gw_render_octree *octree, const gw_light *light,
								   gw_error *error);

/*
 * The glossy bounce.
 *   reflected   4 * pixels->count: radiance reflected towards the eye, and the share of all light
 *               that is reflected so, 0..1; the rest, 1 minus that, is left to the diffuse surface.
 *               Surroundings of one radiance L give exactly share * L.
 * The result does not depend on how the pixels are divided between calls but for the noise.
 */
gw_status gw_render_octree_reflect(gw_render_octree *octree, const gw_pixels *pixels,
								   const gw_reflection *reflection, float *reflected,
								   gw_error *error);

/* What an octree's radiance caches took so far, as Rehfeld, Zirr and Dachsbacher 2014 have it. */
typedef struct gw_cache_seconds {
	uint64_t caches, readers;                  /* and the pixels that read them */
	double distribution, creation, evaluation; /* seconds: placed, filled, read */
} gw_cache_seconds;

gw_cache_seconds gw_render_octree_cache_seconds(const gw_render_octree *octree);

struct gw_probes; /* glowworm_probes.h */

/*
 * The same by the maps of probes (Wang 2018, section 4.3): rays leave the pixels alike, and see
 * what gw_probes_look says: as fine as the texels of the maps. Those that it finds no probe for are
 * traced in the octree of the reflection, or are wrong if that is NULL.
 *
 *   probes      of the same points, lit
 *   origin      gw_surfels.origin of the frame that the pixels are in, metres
 *   reflected   as of gw_render_octree_reflect
 *
 * Of the reflection `rays`, `seed`, `octree` and `cancelled` count, and for rays that are traced
 * the sky. GW_ERROR_CANCELLED, GW_ERROR_MEMORY. Thread-safe without an octree.
 */
gw_status gw_probes_reflect(const struct gw_probes *probes, const double origin[3],
							const gw_pixels *pixels, const gw_reflection *reflection,
							float *reflected, gw_error *error);

/* Rays that gw_probes_reflect sent so far with this octree. */
typedef struct gw_lost_rays {
	uint64_t rays, traced;   /* and those that no probe serves */
	double looking, tracing; /* seconds: in the maps, and in the octree */
} gw_lost_rays;

gw_lost_rays gw_render_octree_lost_rays(const gw_render_octree *octree);

/*
 * Radiance sampled from the bricks of the leaves.
 *   cubic      by a B-spline over 4x4x4 voxels, else linear over 2x2x2
 *   radiance   4 * pixels->count: rgb, and 0 where the bricks hold nothing that faces the eye
 */
gw_status gw_render_octree_read(gw_render_octree *octree, const gw_pixels *pixels, bool cubic,
								float *radiance, gw_error *error);

/* How wide an octree's leaves are. */
typedef struct gw_octree_width {
	double leaf_size, wanted_leaf_size; /* metres; 0, or what leaf_size was to be */
	const char *why_coarser;            /* then, a sentence; valid as long as the octree */
} gw_octree_width;

gw_octree_width gw_render_octree_width(const gw_render_octree *octree);

/*
 * Where a bake with such an octree would gather light first.
 *   surfels    those that the octree was built of
 *   bake       of these record_spacing, least_records, seed and threads
 *   position   on success 3 * *count, metres in the surfels' local frame, for free(); NULL on
 * failure
 */
gw_status gw_render_octree_records(gw_render_octree *octree, const gw_surfels *surfels,
								   const gw_bake_options *bake, float **position, size_t *count,
								   gw_error *error);

/*
 * The share of one light that each surfel sees, whichever way it faces.
 *   surfels   those that the octree was built of
 *   options   for shadows and light_samples
 *   share     surfels->count, 0..1
 */
gw_status gw_render_octree_shadow(gw_render_octree *octree, const gw_surfels *surfels,
								  const gw_light *light, const gw_bake_options *options,
								  float *share, gw_error *error);

/* ---------------------------------------------------------------------------------------- cells */

/*
 * The octree's cells on the CPU, level by level, for those who want to see them
 * (Salm, figure 5.1).
 */

/* Cells of one size, in Morton order. */
typedef struct gw_cells {
	size_t count;
	uint64_t *key;   /* count, Morton keys */
	float size;      /* metres */
	float corner[3]; /* of cell 0, 0, 0; metres in the surfels' local frame */
} gw_cells;

/*
 * The cells of a level that hold surface; in an octree without regions, of discs alone.
 *   level   1 to the octree's depth, whose cells are the leaves
 *   cells   on success freed with gw_cells_clear; zeroed on failure
 * Fails with GW_ERROR_USAGE when there is no such level, GW_ERROR_MEMORY.
 */
gw_status gw_cells_list(gw_render_octree *octree, uint32_t level, gw_cells *cells, gw_error *error);

/* The border tiles of a level, each as the cell that its eight nodes share, of the level above:
 * tiles without surface, of which filtering across bricks takes zeros; none in an octree without
 * regions. As gw_cells_list. */
gw_status gw_cells_list_borders(gw_render_octree *octree, uint32_t level, gw_cells *cells,
								gw_error *error);
void gw_cells_clear(gw_cells *cells);

/* The place of a key, or SIZE_MAX. */
size_t gw_cells_find(const gw_cells *cells, uint64_t key);

/*
 * What each cell shows to one side. Needs bricks.
 *   cells   of gw_cells_list
 *   level   theirs
 *   side    0..5: +x -x +y -y +z -z
 *   shown   4 * cells->count: mean radiance, and area in faces of the cell (its opacity, which may
 *           exceed 1)
 */
gw_status gw_cells_show(gw_render_octree *octree, const gw_cells *cells, uint32_t level,
						uint32_t side, float *shown, gw_error *error);

/* Morton key of a cell and back; coordinates below 2^21. */
uint64_t gw_morton_encode(uint32_t x, uint32_t y, uint32_t z);
void gw_morton_decode(uint64_t key, uint32_t cell[3]);

/* ----------------------------------------------------------------------------------- comparison */

/*
 * How far one lighting of a cloud is from another one, and which points are the same.
 *
 * The measure of this project: relRMSE is the root of the mean square of the difference over the
 * points, divided by the mean of the truth. A mean square is decided by a few points that touch a
 * lamp or a hard shadow's edge, so the same figure without the worst hundredth stands beside it;
 * bias is what is left when errors of both signs have cancelled.
 *
 * Everything here only reads its arguments. Thread-safe.
 */

/* Which share of the points gw_comparison.best_99 leaves out: count / GW_COMPARE_WORST, rounded
 * down. */
#define GW_COMPARE_WORST 100u

/* The difference of one quantity. All but the means are shares of truth_mean, 1 meaning 100 %;
 * they are infinite when the truth is dark and the other is not. */
typedef struct gw_comparison {
	uint64_t points;
	double mean, truth_mean; /* in the quantity's unit */
	double rel_rmse;         /* RMS of the difference / truth_mean */
	double best_99;          /* the same over all points but the worst hundredth, and still divided
								by the mean of all */
	double bias;             /* mean / truth_mean - 1 */
	double percentile_50;    /* of the difference without its sign: nearest-rank percentiles */
	double percentile_95, percentile_99;
	double maximum;
} gw_comparison;

/*
 * Compares `count` values with their truths.
 *
 *   found, truth  count values; not finite is GW_ERROR_DATA
 *   count         0 is GW_ERROR_DATA
 *   comparison    receives the figures; left alone on failure
 */
gw_status gw_compare(const double *found, const double *truth, size_t count,
					 gw_comparison *comparison, gw_error *error);

/* Keys that points are matched by. */
typedef struct gw_compare_keys {
	const double *key; /* as many numbers each as gw_compare_order is told */
	size_t count;
} gw_compare_keys;

/*
 * Puts keys of `width` numbers (3 for positions, 1 for an index) in order, so that two clouds are
 * matched by going through both together. Equal ones stay as they stood; -0 is 0. A key with a NaN
 * equals none and is left out. Which of several points with one key is which of several of another
 * cloud, their order does not say: some programs and formats change it.
 *
 *   width       1 to 3
 *   order       receives the places of the keys, at most keys.count
 *   count       receives how many
 *   error       GW_ERROR_MEMORY
 */
gw_status gw_compare_order(gw_compare_keys keys, size_t width, size_t *order, size_t *count,
						   gw_error *error);

/*
 * The places of the `wanted` largest magnitudes, largest first; among equal ones the smaller place
 * is first.
 *
 *   value   count of them, without NaN
 *   place   receives min(wanted, count) places
 */
gw_status gw_compare_worst(const double *value, size_t count, size_t wanted, size_t *place,
						   gw_error *error);

#ifdef __GNUC__
#pragma GCC visibility pop
#endif

#ifdef __cplusplus
}
#endif

#endif
