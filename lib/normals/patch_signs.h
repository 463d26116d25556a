/*
 * patch_signs.h - signs for patches of surface, from what each says by itself and what their
 * borders say. Internal to lib/.
 *
 * Every patch gets a sign s of +1 or -1 so that
 *
 *   sum over patches of own s  +  sum over borders of says s_a s_b
 *
 * is large. Patches are joined to groups along the borders that say most, groups to larger ones and
 * so on; then each group of every size may turn against all others where that makes the sum larger.
 * So what stands on a floor turns as a whole, however it touches it, and what borders tell well is
 * not torn apart by what few patches see.
 *
 * Source: joining is Boruvka's minimum spanning tree; sums of this form are Ising's model.
 */
#ifndef PATCH_SIGNS_H
#define PATCH_SIGNS_H

#include "glowworm.h"

/* What two patches that touch say about each other. Sums of whole numbers below 2^53, so that
 * their order is nothing. */
typedef struct gw_patch_border {
	uint32_t a, b; /* patches, a < b */
	double says;   /* > 0: for the same sign, < 0: for opposite ones */
	double weight; /* what says would be if all of the border said the same; at least |says| */
} gw_patch_border;

/* Groups of patches, the smallest first. */
typedef struct gw_patch_groups gw_patch_groups;

/*
 * Joins patches along their borders.
 *   borders   border_count, in any order, also several of the same patches; is changed and has to
 *             stay until the groups are freed
 *   sign      count; receives 1 or -1, as borders alone would have it
 *   group     count; receives the number of the group of all that is joined to a patch, below count
 * Returns NULL when memory is short. The result does not depend on the order of the borders.
 */
gw_patch_groups *gw_patch_groups_make(size_t count, gw_patch_border *borders, size_t border_count,
									  int8_t *sign, uint32_t *group);
void gw_patch_groups_free(gw_patch_groups *groups);

/*
 * Turns groups within the largest ones against the rest of these, where the sum grows.
 *   own    what each patch says: > 0 for +1, < 0 for -1, in the unit of `says`
 *   sign   as they are; receives what they become
 */
void gw_patch_groups_turn(gw_patch_groups *groups, const double *own, int8_t *sign);

/* Sums the borders of the same two patches, in order of a, then b. Returns how many are left. */
size_t gw_patch_borders_merge(gw_patch_border *borders, size_t count);

#endif
