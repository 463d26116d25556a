/*
 * scan_join.h - two scans as one.
 */
#ifndef SCAN_JOIN_H
#define SCAN_JOIN_H

#include "points/scan.h"

/*
 * Appends the points of `tail` to `scan`. Columns that both have stay (types widen to hold both;
 * colours that count to different numbers are scaled to count to the same); the others are filled
 * with zeros for the points that lack them. tail is left as it was, and so is scan on failure:
 * GW_ERROR_MEMORY.
 */
gw_status scan_append(scan *scan, const struct scan *tail, gw_error *error);

/* The smallest type that holds every value of both. */
scan_type scan_type_widen(scan_type a, scan_type b);

/* Another scan with all that one holds; *copy is the caller's on success, and empty on failure:
 * GW_ERROR_MEMORY. */
gw_status scan_copy(const scan *from, scan *copy, gw_error *error);

#endif
