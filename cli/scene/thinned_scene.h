/*
 * thinned_scene.h - the inputs as a scene of no more points than memory holds, for who only looks
 * at them: where it does not hold all, as many as it does, spread over the surface.
 */
#ifndef THINNED_SCENE_H
#define THINNED_SCENE_H

#include "scene/loaded_scene.h"

typedef struct thinned_scene {
	loaded_scene loaded;
	parted_cloud parted;
} thinned_scene;

/* Bytes of memory that a point takes: up to 344 of lit clouds with normals of which most is in a
 * picture, 206 where a part is, and 426 where an octree is built of all (measured; columns that
 * others add take more); and where light is solved, by records. */
#define THINNED_SCENE_SEEN_BYTES 360u
#define THINNED_SCENE_TRACED_BYTES 640u
#define THINNED_SCENE_LIT_BYTES 1270u

/*
 * Reads them. A note says how many of the points are taken where these are not all.
 *   look    what a point takes
 *   done    what becomes of points, for the note: "drawn"
 *   scene   to be given back with thinned_scene_clear, also on failure
 * Fails like parted_cloud_open_to_look and loaded_scene_read_parted.
 */
gw_status thinned_scene_read(const settings *settings, const parted_cloud_look *look,
							 const char *done, thinned_scene *scene, gw_error *error);
void thinned_scene_clear(thinned_scene *scene);

#endif
