/*
 * bake_report.h - what a bake says about itself: the report file, and tables for people.
 */
#ifndef BAKE_REPORT_H
#define BAKE_REPORT_H

#include "result/bake_plan.h"
#include "scene/loaded_scene.h"
#include "files/output_file.h"

/* What the program adds to the library's report. */
typedef struct bake_facts {
	const settings *settings;
	const loaded_scene *scene; /* its cloud may be gone */
	const gw_bake_result *result;
	double exposure;
	double read_seconds, bake_seconds, write_seconds; /* wall clock */
	uint64_t vdb_clamped;
	uint32_t frames;             /* of which the result is the first; 0: none */
	bake_plan_forecast forecast; /* of --explain; no plan where there is none */
} bake_facts;

/* Writes the report as JSON; glowworm-bake(1) describes it. */
gw_status bake_report_write(const bake_facts *facts, output_file *out, gw_error *error);

/*
 * Prints time and memory of each stage to standard error, and what the octree takes, in the terms
 * of Salm's tables 5.1 to 5.4.
 *   moved   the octree is one of an earlier frame, in which only what moved was built again
 */
void bake_report_profile(const gw_report *report, bool moved);

/* Prints what was repaired or left out, to standard error. */
void bake_report_notes(const bake_facts *facts);

/* Prints to standard error how wrong the bake is, and what less would cost, in one line; nothing
 * where no error was estimated. */
void bake_report_error(const bake_facts *facts);

/* Prints a summary of the bake to standard error. */
void bake_report_summary(const bake_facts *facts);

/* Says how a bake that refines came to its end, and STATUS_MISSED with that as the sentence when
 * the error is larger than asked. */
gw_status bake_report_goal(const bake_facts *facts, gw_error *error);

#endif
