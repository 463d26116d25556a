/*
 * report.h - filling in a gw_report while a bake runs.
 */
#ifndef REPORT_H
#define REPORT_H

#include "device/gpu.h"

/* Begins a stage; what came before is booked on the stage before. gpu may be NULL. Ends the last
 * one when name is NULL. */
void gw_report_stage(gw_report *report, gw_gpu *gpu, const char *name);

/* Adds a stage that is over, after gw_report_stage has ended the last one. */
void gw_report_add_stage(gw_report *report, const gw_stage *stage);

/* Writes what the device has done until now: which passes ran, and its memory at its highest. gpu
 * may be NULL. */
void gw_report_device(gw_report *report, gw_gpu *gpu);

/* Adds an effect; method NULL: not called for. reason is a printf format. */
void gw_report_effect(gw_report *report, const char *name, const char *method, const char *reason,
					  ...) __attribute__((format(printf, 4, 5)));

/* Sets the seconds of an effect that the report has; of others it does nothing. */
void gw_report_price(gw_report *report, const char *name, double seconds);

/*
 * Adds a note that counts points, in place of one of the same name that the report has already.
 *   points    how many; 0: a note of that name is taken out, and none is added
 *   name      what the note is called in reports, a word
 *   meaning   what follows the number in the sentence. Of "{one|many}" in it the first wording is
 *             kept when points is 1, else the second: of "point{ is|s are} lost" comes "1 point is
 *             lost" or "2 points are lost"
 */
void gw_report_count(gw_report *report, const char *name, uint64_t points, const char *meaning);

#endif
