/*
 * scene_records.h - what is asked and known of the records of a scene, for the steps that place and
 * light them.
 */
#ifndef SCENE_RECORDS_H
#define SCENE_RECORDS_H

#include "bake/scene.h"

/* How close records are to stand: by options that may be others than the scene's. Where it adds
 * none, as many as these ask for. */
gw_record_wish gw_scene_wish_records(const gw_scene *scene, const gw_bake_options *options);

/* The volume that options ask for, of the cells that its surfels and records read. */
gw_volume_wish gw_scene_wish_volume(const gw_scene *scene);

/* Rays a record that are traced. */
uint32_t gw_scene_ray_count(const gw_scene *scene);

/* Writes into the report how many records there are, and rays of them. */
void gw_scene_report_records(gw_scene *scene);
void gw_scene_report_rays(gw_scene *scene);

/* Whether records keep from where their light comes (moments.h): where that is asked for, or
 * surfels' normals differ from their records' by more than noise; not where gaps are closed. */
bool gw_scene_keeps_moments(const gw_scene *scene);

/* The records from `first` on, by themselves, as scene->further. */
gw_status gw_scene_list_further(gw_scene *scene, uint32_t first, gw_error *error);

/* How much it matters that records know from where their light comes, into scene->turn. */
gw_status gw_scene_measure_turn(gw_scene *scene, gw_error *error);

/* Finds what rock keeps apart, and what records must not see through it. */
gw_status gw_scene_find_compartments(gw_scene *scene, gw_error *error);

/* Sees to it that portals to the sky are known and sampled from all records. */
gw_status gw_scene_open_to_sky(gw_scene *scene, gw_error *error);

#endif
