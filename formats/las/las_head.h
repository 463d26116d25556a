/*
 * las_head.h - what stands before the points of a LAS, LAZ or COPC file, to be written: the header
 * of LAS 1.4 and the VLRs.
 */
#ifndef LAS_HEAD_H
#define LAS_HEAD_H

#include "files/output_file.h"
#include "las/las_records.h"

/* VLRs in the order in which they are written; those without content are not. */
typedef enum las_head_vlr {
	LAS_HEAD_COPC, /* where the octree is; makes the file a COPC file */
	LAS_HEAD_WKT,
	LAS_HEAD_KEYS,
	LAS_HEAD_DOUBLES,
	LAS_HEAD_GEO_TEXT,
	LAS_HEAD_TEXT,
	LAS_HEAD_EXTRA,
	LAS_HEAD_LASZIP, /* how points are compressed; makes the file a LAZ file */
	LAS_HEAD_VLRS
} las_head_vlr;

typedef struct las_head {
	const las_records *records;
	struct {
		uint8_t *data; /* owned */
		size_t length;
	} vlr[LAS_HEAD_VLRS];
	uint64_t
		evlr; /* where the first extended VLR begins, which the caller writes behind the points */
	uint32_t evlr_count; /* 0: none */
} las_head;

/* Makes the VLRs that say what the scan knows. head: to be given back with las_head_clear, also on
 * failure; records must live as long. */
gw_status las_head_make(las_head *head, const las_records *records, gw_error *error);

/* Adds a VLR's content, or replaces it. data: copied */
gw_status las_head_set(las_head *head, las_head_vlr which, const uint8_t *data, size_t length,
					   gw_error *error);

/* Where the points will begin. */
size_t las_head_length(const las_head *head);

gw_status las_head_write(const las_head *head, output_file *out, gw_error *error);

void las_head_clear(las_head *head);

#endif
