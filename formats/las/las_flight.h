/*
 * las_flight.h - where an airborne laser scanner was when it saw each point.
 *
 * A LAS file does not say that, but scan angles and times do. In a short time the sensor flies
 * straight on, and its beams leave it across, at known angles from the vertical. So the place that
 * a beam found, on the map, is the sensor's plus its height times the tangent of the angle: in
 * every window of time of every flight line (point_source_id) a straight line is fitted through
 * places over time and tangent. What no such line fits, as scans from the ground, stays unknown;
 * so does what has no angles. Without times the order in the file is taken for them.
 *
 * A piece of a flight, in each line of which all angles are much alike, tells no height. It was
 * seen from above all the same, and a place far above its middle stands for the sensor's.
 */
#ifndef LAS_FLIGHT_H
#define LAS_FLIGHT_H

#include "points/format.h"

/*
 * Adds the sensor's place in each window to the scan's scanners, and which of them saw each point,
 * where at least half of the points have one; and a note that says so.
 *   cloud   as read, with the columns x y z and, or nothing is found, scan_angle or
 *           scan_angle_rank; without scanners
 * Fails with GW_ERROR_MEMORY.
 */
gw_status las_flight_find(scan *cloud, gw_error *error);

/* As format.needs_all: whether points have angles by which it may be found. */
bool las_flight_is_told(const scan *some, const format_seen *seen);

#endif
