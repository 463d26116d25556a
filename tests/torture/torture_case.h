/*
 * torture_case.h - what the parts of the campaign share: cases, their random numbers, and the list
 * of what went wrong.
 *
 * A part is a family of cases, numbered from 0. A case depends on the seed, the part's name and its
 * number, on nothing else, so that any can be run again alone. It makes one or many trials, each a
 * run of the program or a comparison of runs, and each passes or fails. A failure has a class,
 * `part/row/what`, by which known ones are recognised, and a sentence.
 */
#ifndef TORTURE_CASE_H
#define TORTURE_CASE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define CASE_PATH 512

typedef struct torture_case {
	const char *program;    /* absolute path of glowworm */
	const char *shim;       /* absolute path of fault_shim.so */
	char folder[CASE_PATH]; /* empty, its own */
	const char *part;
	long number;
	bool slice;     /* the short run within make test */
	bool keep;      /* say each trial, keep the folder */
	long only;      /* the one trial to run; -1: all */
	uint64_t state; /* of the random numbers */
	uint64_t begin; /* what state is at the part's beginning, the same for all its cases */
	long trials, failures, known;
	char again[CASE_PATH]; /* the command that runs this case again */
} torture_case;

typedef struct torture_part {
	const char *name;
	const char *meaning; /* one line for the table */
	/* How many cases there are, in the slice and in all. */
	long (*count)(bool slice);
	void (*run)(torture_case *c);
} torture_part;

extern const torture_part clouds_part, faults_part, shrinking_part, kills_part, scenes_part,
	options_part, light_part, limits_part;

/* A number in [0, 1), in [low, high], an integer in [0, count), true one time in n. */
double case_random(torture_case *c);
double case_between(torture_case *c, double low, double high);
long case_pick(torture_case *c, long count);
bool case_one_in(torture_case *c, long n);
double case_gaussian(torture_case *c);

/* Begins a trial; false when it is not the one that was asked for. */
bool case_trial(torture_case *c);

/* A class of failures that is known and not mended yet; the slice leaves such rows out. */
bool case_is_known(const char *class_name);

/* Ends the trial as a failure.
 *   class_name  row/what, without the part's name */
void case_fail(torture_case *c, const char *class_name, const char *format, ...)
	__attribute__((format(printf, 3, 4)));

/* A measured figure, for the tables of the campaign. Fails when it is not within its bar.
 *   value, bar  |value| <= bar is good */
void case_measure(torture_case *c, const char *class_name, double value, double bar,
				  const char *format, ...) __attribute__((format(printf, 5, 6)));

/* Path of a file of that name in the case's folder; one of a few static buffers. */
const char *case_path(const torture_case *c, const char *name);

/* Removes all files of the case's folder. */
void case_clear_folder(const torture_case *c);

#endif
