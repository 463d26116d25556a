/*
 * render_scene.h - a cloud, lit or not, as surfels with what can be seen of them.
 */
#ifndef RENDER_SCENE_H
#define RENDER_SCENE_H

#include "glowworm_picture.h"
#include "options/settings.h"
#include "scene/loaded_scene.h"

/* What a surfel can carry into a picture. */
typedef enum render_channel {
	RENDER_ALBEDO,      /* 3 */
	RENDER_RADIANCE,    /* 3, of a lit cloud */
	RENDER_DIRECT,      /* 3, radiance by direct light; when the bake was asked for it */
	RENDER_INDIRECT,    /* 3 */
	RENDER_IRRADIANCE,  /* 3; when the bake was asked for it */
	RENDER_ILLUMINANCE, /* 1, lx; likewise, or from the irradiance, of a photometric scene */
	RENDER_EMISSION,    /* 3; when something emits */
	RENDER_NDF,         /* 1, length of the normal */
	RENDER_ROI,         /* 1, metres: side of the region of influence */
	RENDER_SPECULAR,    /* 1, reflectance at normal incidence; when a point is glossy */
	RENDER_ROUGHNESS,   /* 1, 0..1; with it */
	RENDER_ERROR,       /* 1, of a cloud that compare wrote */
	RENDER_UNKNOWN,     /* 1, 0..1: share of what is gathered that comes through gaps */
	RENDER_SHADOW,      /* 1, the share of a lamp that is seen; for others to fill */
	RENDER_CHANNEL_COUNT
} render_channel;

/* How many floats one takes, and its name as a layer of an EXR file. */
uint32_t render_channel_width(render_channel channel);
const char *render_channel_name(render_channel channel);

typedef struct render_scene {
	gw_surfels surfels;
	float *channel;                   /* owned; what raster.discs.channel is */
	int offset[RENDER_CHANNEL_COUNT]; /* within a surfel's channels; -1: not there */
	uint8_t *glows;                   /* owned; of each surfel, or NULL when none do */
	float *luminance;                 /* owned; while choosing: of each surfel, or NULL when not
										 lit */
	gw_tessellation triangles;        /* owned; of --mesh */
	uint32_t *index;                  /* owned; 0, 1, 2... for the triangles' corners */
	gw_raster_scene raster;           /* leads into the above */
	const double *scanner;            /* while choosing: 3 * scanner_count, or NULL */
	size_t scanner_count;
	char up;           /* as gw_camera_up has it */
	coordinates place; /* owned; from the input's coordinates to metres */
	bool photometric;  /* cd/m^2 and lx, not W/(sr m^2) and W/m^2 */
	bool enclosed;     /* the bake found that it is to be looked at from within */
	/* What making it took, seconds. */
	double read_seconds, choose_seconds, surface_seconds;
} render_scene;

/*
 * Called when the places of the points are known, to choose which of them the pictures need.
 *   scene    with luminance, up and photometric
 *   surfels  of it, as gw_surfels_chooser has them
 */
typedef gw_status render_scene_chooser(void *user, const render_scene *scene,
									   const gw_surfels *surfels, uint8_t *chosen, gw_error *error);

/* Whether an octree will be built, for which all points count, not only those in a picture. */
typedef enum render_octree {
	RENDER_OCTREE_NO,
	RENDER_OCTREE_GLOSSY, /* if the cloud says of any point how glossy it is */
	RENDER_OCTREE_YES
} render_octree;

/* What is wanted of a scene. */
typedef struct render_scene_wish {
	uint32_t channels;            /* 1 << render_channel for each that is wanted, if the cloud has
									 it; a luminance is there whenever the cloud is lit */
	render_octree octree;         /* whether all points get a surface */
	render_scene_chooser *choose; /* what the pictures need; called with `user` */
	void *user;
} render_scene_wish;

/*
 * Reads the inputs and finds the surface that they stand for.
 *   scene   on success owned by the caller, freed with render_scene_clear; zeroed on failure
 * Fails as loaded_scene_read and gw_surfels_make; GW_ERROR_CANCELLED.
 */
gw_status render_scene_read(const settings *settings, const render_scene_wish *wish,
							render_scene *scene, gw_error *error);

/* Finds the surface that inputs stand for which were read before. Their place is the scene's then,
 * and theirs is metres; their points are read here only. Errors as above. */
gw_status render_scene_make(const settings *settings, loaded_scene *loaded,
							const render_scene_wish *wish, render_scene *scene, gw_error *error);
void render_scene_clear(render_scene *scene);

/* Prints what the readers of an input had to say of it. */
void render_scene_print_notes(const scan *cloud);

/*
 * The means of three columns over the points that each surfel stands for; what is not finite, or
 * below 0, counts as 0.
 *   to   receives 3 * surfels->count
 * Fails with GW_ERROR_MEMORY.
 */
gw_status render_scene_means(const gw_surfels *surfels, const scan_column *const column[3],
							 float *to, gw_error *error);

#endif
