/*
 * viewpoint_steps.h - the ways to look at a cloud.
 */
#ifndef VIEWPOINT_STEPS_H
#define VIEWPOINT_STEPS_H

#include "picture/view_space.h"

/* Whether the space that a cloud encloses is what a person came to see. GW_ERROR_MEMORY. */
gw_status gw_viewpoint_is_inside(const view_space *space, bool *inside, gw_error *error);

/* The view of the only scanner, if it did not turn around; else viewpoint->from_scanner stays
 * false. GW_ERROR_MEMORY. */
gw_status gw_viewpoint_of_scanner(const view_space *space, gw_viewpoint *viewpoint,
								  gw_error *error);

/* The best view from within; viewpoint->inside stays false when no place is enclosed. */
void gw_viewpoint_within(const view_space *space, gw_viewpoint *viewpoint);

/* The best view from outside. */
gw_status gw_viewpoint_without(const view_space *space, gw_viewpoint *viewpoint, gw_error *error);

#endif
