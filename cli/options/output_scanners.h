/*
 * output_scanners.h - where scanners stood, in files whose format has no place for it.
 */
#ifndef OUTPUT_SCANNERS_H
#define OUTPUT_SCANNERS_H

#include "points/format.h"

/* More scanners than the file's comments tell are lost, which a note on standard error says. None
 * are where the format has a place for them, or its readers find them again by other columns. */
void output_scanners_note(const format *to, const scan *cloud, bool quiet);

/* Adds these comments to what is written, or the note. GW_ERROR_MEMORY. */
gw_status output_scanners_settle(const format *to, scan *cloud, bool quiet, gw_error *error);

#endif
