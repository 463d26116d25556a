/*
 * strays.h - points that belong to no surface. Internal to lib/.
 *
 * Scanners also report what is no surface: returns that never were, at 0, 0, 0 or at a value for no
 * data; dust, birds, raindrops; the mean of an edge and what is behind it. As discs they would hang
 * in the air, shade what is below, and make bounds and cells as wide as they lie far off. So they
 * are taken out before anything is made of the points, and what is made is that of a cloud that
 * never had them. Afterwards each gets the light of the surface that is nearest to it.
 */
#ifndef STRAYS_H
#define STRAYS_H

#include "cloud/neighbours.h"

/* Which points are strays: of each, 0 or 1 + its gw_stray_kind. */
typedef struct gw_stray_marks {
	uint8_t *mark; /* one a point */
	size_t count;  /* how many are marked */
	uint8_t *far; /* NULL or one a point, 1: it lay off those around at first, 2: and it is alone */
	size_t surfels; /* how many there were at first */
	size_t alone;   /* how many of them were found to be alone */
	bool sparse;    /* those were too many: the cloud is as sparse as that, and none is a stray */
} gw_stray_marks;

/*
 * Marks what is known without looking at surfaces: what points->stray says, what lies far off all
 * the rest (bulk_bounds.h), and what scanners stood on (stray_mounts.h). All of it stays unmarked
 * if nothing else were left. marks  on success owned by the caller, to be cleared with
 * gw_strays_clear Fails with GW_ERROR_MEMORY.
 */
gw_status gw_strays_mark_known(const gw_points *points, gw_stray_marks *marks, gw_error *error);
void gw_strays_clear(gw_stray_marks *marks);

/*
 * Marks those of the surfels' points that lie alone: many times further from others than those
 * around are from each other, and not on a surface that is merely sparse there, which is one where
 * enough of the nearest lie in a common plane. Without them those are alone that were in a plane
 * with them, and are marked as well, but none that lay far off nothing at first: or the outermost
 * leaves of trees would go, one layer after the other. So it is in further calls, without those
 * that were marked, which see the rest by other cells. When all calls together have found too many,
 * the marks of all of them are taken back, and further calls find none.
 *   surfels  of the points that are not marked yet, with what gw_frame_make fills
 *   marks    far is made by the first call
 * Fails with GW_ERROR_MEMORY.
 */
gw_status gw_strays_mark_alone(const gw_points *points, const gw_surfels_options *options,
							   const gw_surfels *surfels, gw_stray_marks *marks, gw_error *error);

/*
 * The points without those that are marked, which have no coordinates any more.
 *   position  receives the memory behind it, for free()
 * Fails with GW_ERROR_MEMORY.
 */
gw_status gw_strays_hide(const gw_points *points, const gw_stray_marks *marks, double **position,
						 gw_points *rest, gw_error *error);

/*
 * Lists strays in surfels->stray, each with the surfel that is nearest to it, and takes them off
 * the points without finite coordinates.
 *   search  of the surfels, while they are where points say
 * Fails with GW_ERROR_MEMORY.
 */
gw_status gw_strays_list(const gw_points *points, const gw_stray_marks *marks,
						 gw_neighbours *search, gw_surfels *surfels, gw_error *error);

/*
 * Counts the strays that are listed, by kind.
 *   points  from which the surfels were made
 *   count   receives one of each gw_stray_kind, with an example
 */
void gw_strays_count(const gw_surfels *surfels, const gw_points *points,
					 gw_stray_count count[GW_STRAY_KIND_COUNT]);

#endif
