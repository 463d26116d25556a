/*
 * scan_bytes.h - a scan as bytes, as memory has its numbers, for another process of the same
 * program: its columns, comments, which axis is up, where scanners stood and which of them saw
 * which point. Not images.
 */
#ifndef SCAN_BYTES_H
#define SCAN_BYTES_H

#include "glowworm_parts.h"
#include "points/scan.h"

gw_status scan_bytes_save(const scan *cloud, const gw_byte_sink *to, gw_error *error);

/* Whether the bytes are whole is for the caller to know. GW_ERROR_DATA, GW_ERROR_MEMORY.
 *   cloud   to be freed with scan_clear; empty on failure */
gw_status scan_bytes_load(const gw_byte_source *from, scan *cloud, gw_error *error);

#endif
