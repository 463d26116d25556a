/*
 * output_system.h - what points that are written as COPC have otherwise there than where they came
 * from: their coordinate system, which has to be WKT, and classes of old point formats.
 */
#ifndef OUTPUT_SYSTEM_H
#define OUTPUT_SYSTEM_H

#include "options/settings.h"
#include "points/format.h"

/* Where older keys alone say the system, it becomes WKT by PROJ, or a note on standard error says
 * that it is lost to readers of COPC; others count the points of such classes. Nothing in other
 * formats. GW_ERROR_MEMORY. */
gw_status output_system_settle(const format *to, scan *cloud, bool quiet, gw_error *error);

/* output_name_check_step by what the points' file said, or by how they look; as
 * coordinates_say_degrees, whose low and high are taken. GW_ERROR_MEMORY. */
gw_status output_system_check_step(const settings *s, const scan *cloud, const double low[3],
								   const double high[3], gw_error *error);

#endif
