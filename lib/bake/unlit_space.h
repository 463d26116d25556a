/*
 * unlit_space.h - rooms and caves whose outer sides alone are lit, because sun and sky are all the
 * light there is, and nobody said which side of the surface a scanner saw.
 */
#ifndef UNLIT_SPACE_H
#define UNLIT_SPACE_H

#include "bake/scene.h"

/*
 * Finds out whether points without normals enclose a space that a person would look at from within
 * (gw_viewpoint_find), while the normals that the lights gave them face outwards, and reports a
 * place to stand in it. Does nothing where most normals were given, or a lamp is no sun nor sky.
 *   scene   with its surfels; of its report unlit_space and unlit_place are set
 *   from    the points and lights that these were made for
 * Fails with GW_ERROR_MEMORY.
 */
gw_status gw_unlit_space_find(gw_scene *scene, const gw_scene_description *from, gw_error *error);

#endif
