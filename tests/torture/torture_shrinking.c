/*
 * torture_shrinking.c - inputs that become shorter while they are read. The program says so and
 * ends with the status of bad data, of failed reading, or well, when it had read all it needed.
 */
#include "hard_cloud.h"
#include "torture_child.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const format[] = { "ply", "las", "pcd", "xyz", "csv", "cloud" };
#define FORMAT_COUNT ((long)(sizeof format / sizeof *format))

static const char *const verb[] = { "info", "convert", "bake", "render", "compare", "transport" };
#define VERB_COUNT ((long)(sizeof verb / sizeof *verb))

/* The cloud is longer than a page, so that half of its pages go. */
static bool make_input(torture_case *c, const char *as)
{
	hard_cloud cloud = { 0 };
	torture_child child;
	hard_cloud_add(c, &cloud, HILLS, 2000);
	hard_cloud_write(c, &cloud, "made.ply");
	hard_cloud_clear(&cloud);
	child_start(&child);
	child_add_words(&child, "bake made.ply --bounces 1 --depth 4 --estimate-points 0 -q --force");
	child_add_words(&child, "--save-transport in.transport -o");
	child_add(&child, "in.%s", as);
	child_add(&child, "--light");
	child_add(&child, "sky radiance 1");
	child_run(c, &child);
	return child_check(c, &child, "inputs");
}

static void command(torture_child *child, const char *what, const char *as)
{
	child_start(child);
	child->limit = 60;
	if (strcmp(what, "info") == 0) {
		child_add(child, "info");
		child_add(child, "in.%s", as);
	} else if (strcmp(what, "convert") == 0) {
		child_add(child, "convert");
		child_add(child, "in.%s", as);
		child_add_words(child, "out.ply --force");
	} else if (strcmp(what, "render") == 0) {
		child_add(child, "render");
		child_add(child, "in.%s", as);
		child_add_words(child, "-o out.png --size 32x32 --force");
	} else if (strcmp(what, "compare") == 0) {
		child_add(child, "compare");
		child_add(child, "in.%s", as);
		child_add(child, "in.%s", as);
	} else {
		child_add(child, "bake");
		child_add(child, "in.%s", as);
		child_add_words(child, "-o out.ply --estimate-points 0 --depth 4 --force -q");
		if (strcmp(what, "transport") == 0)
			child_add_words(child, "--transport in.transport");
		child_add(child, "--light");
		child_add(child, "sky radiance 1");
	}
}

static void try_shrink(torture_case *c, const char *what, const char *as, long at, bool *more)
{
	torture_child child;
	char row[100];
	command(&child, what, as);
	child_set(&child, "FAULT_KIND=shrink");
	child_set(&child, "FAULT_OWNER=program");
	child_set(&child, "FAULT_AT=%ld", at);
	child_set(&child, "FAULT_REPORT=fault");
	child_set(&child, "LD_PRELOAD=%s", c->shim);
	remove(case_path(c, "fault"));
	remove(case_path(c, "out.ply"));
	child_run(c, &child);
	size_t length;
	char *fault = (char *)child_read_file(c, "fault", &length);
	*more = fault && strstr(fault, "hit");
	free(fault);
	snprintf(row, sizeof row, "%s of %s", what, as);
	child_check(c, &child, row);
}

static void run(torture_case *c)
{
	const char *what = verb[c->number % VERB_COUNT];
	const char *as = format[c->number / VERB_COUNT % FORMAT_COUNT];
	bool more = true;
	for (long at = 1; more && at <= 40; at++) {
		case_clear_folder(c);
		if (!make_input(c, as))
			return;
		if (case_trial(c))
			try_shrink(c, what, as, at, &more);
	}
}

static long count(bool slice)
{
	return slice ? 7 : VERB_COUNT * FORMAT_COUNT;
}

const torture_part shrinking_part = { "shrinking",
									  "inputs that lose half of their bytes while they are read",
									  count, run };
