/*
 * health.h - what `glowworm doctor` finds: a list of things that are good, worth knowing, or not
 * good, in the order in which they were looked at.
 */
#ifndef HEALTH_H
#define HEALTH_H

#include "options/settings.h"

#include <stdio.h>

typedef enum health_verdict {
	HEALTH_GOOD,
	HEALTH_WARNING, /* worth knowing; bakes work */
	HEALTH_BAD,
	HEALTH_VERDICT_COUNT
} health_verdict;

typedef struct health_item {
	char group[40]; /* heading */
	char name[48];
	health_verdict verdict;
	char text[320];
} health_item;

#define HEALTH_ITEMS 256

typedef struct health {
	health_item item[HEALTH_ITEMS];
	size_t count;
	char group[40];        /* of what is added next */
	size_t bakes;          /* devices on which a bake came out right */
	uint64_t budget;       /* bytes that a bake may take on the first of them; 0: not known */
	const settings *asked; /* device, memory, threads */
} health;

/* Names the group of what is added next. */
void health_begin(health *h, const char *group);

/* Adds one; beyond HEALTH_ITEMS, which no machine has, the last one is replaced. */
void health_add(health *h, health_verdict verdict, const char *name, const char *format, ...)
	__attribute__((format(printf, 4, 5)));

/* How many have that verdict. */
size_t health_tally(const health *h, health_verdict verdict);

/* Prints all, for people or as one JSON object. */
void health_print(const health *h, FILE *out);
void health_print_json(const health *h, FILE *out);

/* ---------------------------------------------------------------------- what is looked at */

/* Program, compiler, flags, system, processor, locale. */
void health_of_program(health *h);

/* Vulkan's loader, all devices with their limits, and on each that is asked for the trials and a
 * bake whose result is known. GW_ERROR_CANCELLED when asked to stop. */
gw_status health_of_devices(health *h, gw_error *error);

/* Memory, threads, folders. */
gw_status health_of_machine(health *h, gw_error *error);

/* OpenVDB's plugin, OpenEXR. */
gw_status health_of_libraries(health *h, gw_error *error);

/* -------------------------------------------------- the judgements, from what was measured */

/* Memory in bytes; UINT64_MAX where nothing sets a limit, 0 where it is not known. */
typedef struct health_memory {
	uint64_t available;     /* without swapping, what the control group leaves taken into account */
	uint64_t address_space; /* RLIMIT_AS */
	uint64_t budget;        /* of a bake; 0: no device */
} health_memory;

void health_judge_memory(health *h, const health_memory *memory);
void health_judge_threads(health *h, uint32_t started, uint32_t wanted);
void health_judge_openexr(health *h, const int version[3]);
void health_judge_limit(health *h, const gw_device_limit *limit);
void health_judge_trial(health *h, const gw_device_trial *trial);

/* A folder: whether a file can be written there, and bytes of room. needed: bakes write there. */
void health_judge_folder(health *h, const char *name, const char *folder, bool needed);

/* A bake of something whose radiance is the same everywhere and known. */
typedef struct health_canary {
	gw_status status;
	gw_error error;
	double expected, mean, worst; /* radiance; worst: largest relative error of a point */
	double seconds;
} health_canary;

void health_judge_canary(health *h, const health_canary *canary);

#endif
