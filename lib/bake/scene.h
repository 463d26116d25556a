/*
 * scene.h - what of a bake depends on the geometry alone, so that one scene can be lit many times
 * (lighting.h).
 *
 * The steps, in this order; each needs the ones before:
 *
 *   open device -> surfels -> octree -> records, with what their rays hit and the weights by which
 *   facets and surfels interpolate between them
 *
 * A scene's light lies in a gw_lighting; gathering also uses work space of the records here.
 * Thread-safety: one thread at a time.
 */
#ifndef SCENE_H
#define SCENE_H

#include "estimate/error_estimate.h"
#include "light/gather_cones.h"
#include "light/gather_probes.h"
#include "light/micro_buffers.h"
#include "light/kept_hits.h"
#include "light/moments.h"
#include "light/propagation.h"
#include "light/read_back.h"
#include "light/volume_places.h"
#include "surfels/scanned_space.h"
#include "bake/placed_probes.h"
#include "bake/scaled_scene.h"

/* What a bake of a region needs (region.h). All zero: everything is lit. */
typedef struct gw_region_needs {
	bool *asked;          /* NULL: all; surfel count: those whose light is asked for */
	size_t count;         /* of these */
	uint8_t *point;       /* likewise, one a point: as gw_bake_result.asked */
	float spacing;        /* between the region's records, leaf cells */
	float *facet_spacing; /* facet_count: on each facet, INFINITY where none are needed; NULL
							 before records were placed, and so the next */
	bool *lit;            /* surfel count: those that lamps have to shine on */
} gw_region_needs;

/* Irradiance of points that another bake lit, and which this one is to take as it is: 3 a point, in
 * the order of the points, W/m^2; NAN of points that are to be lit. */
typedef struct gw_known_light {
	const float *all;
	float *const *lamp; /* NULL, or of each light alone, */
	const float *rest;  /* and of what emits; NULL: nothing does */
} gw_known_light;

/* Where the work is, for those who wait. All zero: nothing has begun. */
typedef struct gw_scene_stage {
	const char *name;    /* of the stage under way */
	double from, share;  /* of the whole: where it began, and how much it is */
	double start, begun; /* seconds: of the stage, of the first one */
	double asked;        /* when was last asked whether to stop */
	bool stopped;        /* the answer was yes */
} gw_scene_stage;

/* What a transport is of: a hash each. */
typedef struct gw_transport_identity {
	uint64_t position, normal, albedo, opacity, scanner, stray, emission, area;
} gw_transport_identity;

/* Where records stand closer than the spacing with which they were placed, leaf cells, or are to.
 * All NULL: nowhere. */
typedef struct gw_record_density {
	float *facet_spacing;               /* facet_count */
	float *surfel_spacing;              /* surfel count */
	bool *facet_closer, *surfel_closer; /* likewise: whose spacing has become less; NULL where a
										   transport brought the spacings */
	double in_vain; /* error of gathered light that the last added ones did not lessen, relative; 0
					   where they did */
} gw_record_density;

/* Whether a scene begins with it, and whether it is to be written. NULL: neither. */
static inline bool gw_transport_is_read(const gw_transport *transport)
{
	return transport && transport->data;
}

static inline bool gw_transport_is_written(const gw_transport *transport)
{
	return transport && transport->write;
}

/* What gw_scene of glowworm.h is. */
struct gw_scene {
	gw_bake_options options;
	gw_report *report; /* receives what the steps find out; not owned */
	gw_bake_callbacks callbacks;
	gw_scene_stage stage;

	gw_gpu *gpu;
	bool adds_records; /* where those that it places disagree: gw_bake_options.most_records */
	/* NULL, or the address of a device that is handed from bake to bake: opening takes the one
	 * there, if there is one, and closing puts it back. Not owned. */
	gw_gpu **lent;
	gw_surfels surfels;
	gw_region_needs region;
	const gw_known_light *known; /* NULL: of no point; not owned, in units of: */
	float known_unit;            /* one of these is so much */
	gw_scanned_space space;      /* what scanners saw; empty where nobody knows */
	gw_octree octree;
	gw_passes passes;
	gw_records records;
	gw_record_density density; /* where some were added */
	gw_ray_gather rays;        /* hits that serve every bounce; of a few rays where others gather */
	gw_cone_gather cones;      /* empty but for GW_METHOD_CONES */
	gw_propagation propagation; /* empty but for GW_METHOD_LPV */
	gw_radiance_volume volume;  /* empty but for these two, as are: */
	gw_volume_rows volume_rows; /* the cells that light each record */
	gw_micro_buffers buffers;   /* empty but for GW_METHOD_BUFFERS */
	gw_read_back read_back;
	/* What the points that emit brought to the records, once it is known: it depends on
	 * their emission, but not on lamps. */
	gw_buffer sampled;
	gw_buffer sampled_moment; /* the same of its moment, where records keep theirs (moments.h) */
	double turn; /* of surfels' normals from those of their records: gw_read_back_turn; 0 where that
					was not asked for, or is noise */
	gw_check_tree check_tree;         /* of the surfels, once an estimate has asked for it */
	gw_check_point_hits check_points; /* what the points see that estimates solve again */
	gw_placed_probes probes;          /* the last that were placed in it, in whatever light */
	gw_probe_maps maps;               /* that records see by; empty but for GW_METHOD_PROBES */
	gw_portals portals;               /* looked for when a sky first shines */
	gw_records further;               /* places of records that were added and are not in it yet */
	gw_ray_gather further_rays;       /* and their hits */

	/* For scenes in which some surfels move. */
	bool keeps;                  /* the octree is built with what builds before it left */
	size_t still;                /* so many surfels stay where they are */
	gw_octree_kept *kept_octree; /* owned */
	const gw_kept_hits *kept;    /* NULL, or what records saw without what moves; not owned */
	gw_changed_boxes boxes;      /* where that is; not owned */
	uint64_t traced;             /* rays of records that were traced, the last time */

	/* For scenes that are lit by those who made them (handles.c). */
	gw_report *own_report;    /* owned: report */
	gw_report prepared;       /* what of it is so for every lighting */
	gw_scaled_scene units;    /* in which all is reckoned */
	gw_transport_identity of; /* the points of one that is to be written, */
	bool saved;               /* and whether it was */
	uint64_t emissions;       /* how often the points were given other emission */
	const gw_lighting *lit;   /* whose light is in the records; not owned, maybe gone */
};

/* Records of the scene, for the steps of light/. */
static inline gw_record_context gw_scene_context(gw_scene *scene, gw_records *records)
{
	return (gw_record_context){ &scene->passes, &scene->octree, records };
}

/* Whose gaps are closed; NULL when they are open, or none is known. */
static inline const gw_scanned_space *gw_scene_closed_space(const gw_scene *scene)
{
	return scene->options.gaps != GW_GAPS_OPEN && gw_scanned_space_known(&scene->space)
			   ? &scene->space
			   : NULL;
}

/*
 * Begins a stage: tells the caller, and asks whether to stop.
 *   done    share of the whole that lies behind; 0 begins another whole
 *   share   of the stage itself
 */
gw_status gw_scene_begin(gw_scene *scene, const char *name, double done, double share,
						 gw_error *error);

/* Fails when the scene was to be validated and the layer had something to say. */
gw_status gw_scene_check_validation(const gw_scene *scene, gw_error *error);

/* Whether to stop; scene: a gw_scene. To be asked often within stages: it asks the caller, and
 * tells how far the work is, when the last time was a while ago. */
bool gw_scene_stopped(void *scene);

/* Opens the device that the options name. */
gw_status gw_scene_open_device(gw_scene *scene, gw_error *error);

/* Whether what emits shows itself alone: it is to light nothing, and no grid is to show it. */
bool gw_scene_emission_is_alone(const gw_scene *scene);

/* How surfels of the scene are made, in the light of some lights. */
gw_surfels_options gw_scene_surfels_options(gw_scene *scene, const gw_light *lights, size_t count);

/*
 * Makes the surfels of the points. The lights orient estimated normals when nobody knows where the
 * scanner stood.
 */
gw_status gw_scene_make_surfels(gw_scene *scene, const gw_scene_description *from, gw_error *error);

/* Finds out what scanners saw of the space between the surfels, or where these have holes, unless a
 * transport brought that. */
gw_status gw_scene_find_space(gw_scene *scene, const gw_points *points, gw_error *error);

/* Writes what is known of it into the report; finding does so, too. */
void gw_scene_report_space(const gw_scene *scene);

/* Writes what was repaired into a report. */
void gw_report_surfels(gw_report *report, const gw_surfels *surfels, const gw_points *points);

/* Whether leaves have to hold regions of influence, as cones and voxels do, so that they are as
 * narrow as GW_LEAF_SPACING however many points there are. */
bool gw_scene_needs_regions(const gw_bake_options *options);

/* Width of leaves in spacings of the surfels, where these are made and no depth is asked for. */
float gw_scene_leaf_spacing(const gw_scene *scene);

gw_status gw_scene_build_octree(gw_scene *scene, gw_error *error);

/* Instead: surfels on the device without a tree, for lamps that nothing hides. */
gw_status gw_scene_do_without_octree(gw_scene *scene, gw_error *error);

/* Writes what the octree is into the report; building it does so, too. */
void gw_scene_report_octree(const gw_scene *scene);

/*
 * Gives the points other emission; nothing else changes. On failure it is as it was.
 *   emission   3 * points, in the order that the scene was made from, or NULL: none
 */
gw_status gw_scene_replace_emission(gw_scene *scene, const float *emission, size_t points,
									gw_error *error);
/* The points whose emission could not be taken as it was, into a report. */
void gw_report_emission(gw_report *report, const gw_surfels *surfels);

/* To be called when the emission of surfels changes. */
void gw_scene_forget_samples(gw_scene *scene);
/* What lightings found out about the scene, which the next one can find out again. */
void gw_scene_forget_light(gw_scene *scene);

/* What the added records are, once they are among the others in all that is kept. */
void gw_scene_forget_further(gw_scene *scene);

/* Forget the records; the octree and the records; everything. Options and callbacks stay. */
void gw_scene_drop_records(gw_scene *scene);

/* Forgets records and what was traced from them, but not which ones light surfels: when all light
 * is known. */
void gw_scene_drop_traced(gw_scene *scene);
void gw_scene_drop_octree(gw_scene *scene);
void gw_scene_close(gw_scene *scene);

#endif
