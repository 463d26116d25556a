/*
 * parted_cloud.h - inputs that memory does not hold: read once to keep as many of their points as
 * do, spread over their surface, which are baked; and once more, part by part, to light all of
 * them. Several files, and those that cannot be read in parts, are copied into one first that can.
 */
#ifndef PARTED_CLOUD_H
#define PARTED_CLOUD_H

#include "points/scan_told.h"
#include "scene/gathered_cloud.h"
#include "scene/bake_journal.h"
#include "table/format_parts.h"

/* With fewer points a bake is refused for want of memory rather than made of next to nothing. */
#define PARTED_CLOUD_LEAST 10000u

typedef struct parted_cloud {
	format_parts file;
	gathered_input *input;  /* owned; one each, where inputs were gathered; else NULL */
	size_t most;            /* points that may be kept; 0: all of them fit, and are read as usual */
	size_t tile;            /* points of a tile with its halo, where all are lit by tiles */
	uint64_t memory_wanted; /* bytes: the least that holds a tile, where less was given, or 0 */
	size_t part;            /* points that are read at once */
	scan_told told;         /* after parted_cloud_thin: what the columns' values tell */
	journal_file *journal;  /* NULL; or that of parted_cloud_keep, closed by who opened it */
	bool begun;             /* another run began it */
	format_whole whole;     /* after parted_cloud_survey: of the results */
	const format *format;   /* theirs, or NULL */
} parted_cloud;

/*
 * Looks whether the points of the inputs fit into memory, and where they do not, whether they can
 * be read in parts: clouds in files, results in a format that allows it, and nothing asked for
 * that takes all points at once. Otherwise they are read as usual.
 *   output   the format of the results, or NULL
 *   kept     NULL, or how many points another bake kept, 0 for all, whose transport this one begins
 *            with
 *   parted   to be given back with parted_cloud_close
 */
gw_status parted_cloud_open(const settings *settings, const format *output, const uint64_t *kept,
							parted_cloud *parted, gw_error *error);

/* The same to foretell such a bake, whose results may have no name yet: then they can be written.
 */
gw_status parted_cloud_open_to_plan(const settings *settings, const format *output,
									parted_cloud *parted, gw_error *error);

/* What a point takes that is only looked at. */
typedef struct parted_cloud_look {
	uint32_t bytes;        /* of memory */
	const char *column;    /* NULL, or a column of the cloud with which it takes more: */
	uint32_t column_bytes; /* so much in all */
} parted_cloud_look;

/* The same for a cloud that is looked at, and not written again. */
gw_status parted_cloud_open_to_look(const settings *settings, const parted_cloud_look *look,
									parted_cloud *parted, gw_error *error);

/*
 * Keeps account of the bake in a journal, with which parted_cloud_thin then begins: where another
 * run began it, points are kept as there. Not for a cloud that cannot be read in parts.
 * Fails like bake_journal_open.
 */
gw_status parted_cloud_keep(parted_cloud *parted, const settings *settings,
							const bake_journal_use *use, gw_error *error);

/* Keeps some of the points, or takes those of the journal. GW_ERROR_DATA, GW_ERROR_MEMORY,
 * GW_ERROR_CANCELLED. cloud   to be freed with scan_clear; empty on failure */
gw_status parted_cloud_thin(parted_cloud *parted, scan *cloud, gw_error *error);

/* What their format has to know of the results before they are written, by the points of the file:
 * after parted_cloud_thin. GW_ERROR_DATA where it cannot hold them. */
gw_status parted_cloud_survey(parted_cloud *parted, const char *output, gw_error *error);

/* The points of part number `part`, of which there are parted_cloud_parts.
 *   cloud   to be freed with scan_clear; empty on failure */
gw_status parted_cloud_read(parted_cloud *parted, uint64_t part, scan *cloud, gw_error *error);
uint64_t parted_cloud_parts(const parted_cloud *parted);

void parted_cloud_close(parted_cloud *parted);

#endif
