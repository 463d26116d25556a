/*
 * ply_splats.h - 3D Gaussian splats as points of a surface: what their trainers write as PLY files.
 *
 * Source: Kerbl et al., 3D Gaussian Splatting for Real-Time Radiance Field Rendering, ACM
 * Transactions on Graphics 42(4), 2023, and the files of the program that came with it: f_dc_* is
 * colour as the constant of spherical harmonics, opacity a logit, scale_* natural logarithms of
 * metres, rot_* a quaternion w x y z of any length.
 */
#ifndef PLY_SPLATS_H
#define PLY_SPLATS_H

#include "ply/ply_header.h"

/* Are the vertices splats? They have f_dc_0, opacity, scale_0 and rot_0. */
bool ply_is_splats(const ply_element *vertex);

/* How the colour of a splat changes with the direction, f_rest_*: of which points have no use. */
bool ply_is_splat_shine(const char *name);

/*
 * Puts what points have into the place of what splats have, with a note:
 *
 *   red green blue  of f_dc_*: the mean over all directions
 *   splat_opacity   0..1: of the middle of a splat. See scan_points_make
 *   axis_x ...      the axis of least scale of those that are clearly flat, 0 of the others; unless
 *                   the file has normals that are not all 0
 *
 * Fails with GW_ERROR_MEMORY.
 */
gw_status ply_splats_take(scan *cloud, gw_error *error);

#endif
