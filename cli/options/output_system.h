/*
 * output_system.h - the coordinate system of points that are written as COPC, which has to be WKT.
 */
#ifndef OUTPUT_SYSTEM_H
#define OUTPUT_SYSTEM_H

#include "points/format.h"

/* Where older keys alone say it, it becomes WKT by PROJ, or a note on standard error says that it
 * is lost to readers of COPC. Nothing in other formats. GW_ERROR_MEMORY. */
gw_status output_system_settle(const format *to, scan *cloud, bool quiet, gw_error *error);

#endif
