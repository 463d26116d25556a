/*
 * probe_picture.h - a picture of balls where probes stand, in the scene that they see.
 */
#ifndef PROBE_PICTURE_H
#define PROBE_PICTURE_H

#include "files/output_file.h"
#include "pictures/render_scene.h"

/* What is shown. */
typedef struct probe_picture {
	const settings *settings; /* with the camera */
	const gw_probes *probes;
	const float *radiance; /* 3 * points of the scene: what they send out */
	/* What it was made with: */
	char camera[256]; /* the camera, as --camera takes it; "": it was given */
	size_t shown;     /* balls that are seen in some pixel */
} probe_picture;

/*
 * Writes the picture as PNG. A ball is white and diffuse: it sends out the irradiance that the
 * probe's harmonics have for its normal, divided by pi. It is a quarter as wide as the ball of free
 * space around the probe, or 2 % of the scene's diagonal where that is less. Balls that
 * the camera stands next to, within three of their radii, would hide the rest and are left out. A
 * camera that is found and has no probe in its view is turned or moved to one.
 *   loaded   whose points the probes were made for; its columns are replaced, and its place moves
 * Fails as loaded_scene_read, gw_surfels_make and gw_camera_look; GW_ERROR_DATA when nothing is in
 * view.
 */
gw_status probe_picture_write(probe_picture *picture, loaded_scene *loaded, output_file *out,
							  gw_error *error);

#endif
