/*
 * glossy_points.h - what glossy points reflect: the diffuse surface's part and the glossy one's.
 */
#ifndef GLOSSY_POINTS_H
#define GLOSSY_POINTS_H

#include "scene/loaded_scene.h"

/* Albedo of all light that a glossy point reflects, from evenly lit surroundings: what its gloss
 * takes, by Schlick's Fresnel term, never reaches the diffuse surface.
 *   albedo     of the diffuse surface, 0..1
 *   specular   reflectance at normal incidence, 0..1; 0: not glossy, the albedo stays */
float glossy_points_albedo(float albedo, float specular);

/* A column's value as one from 0 to 1; what is no number counts as `otherwise`. */
float glossy_points_share(double value, float otherwise);

/* Gives each glossy point of a scene that albedo, so that light bounces on with all its energy.
 * Where gloss is forbidden, forgets it instead. */
void glossy_points_apply(const settings *settings, loaded_scene *scene);

#endif
