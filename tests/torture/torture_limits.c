/*
 * torture_limits.c - surroundings that are short of something: files that may not grow, an address
 * space of so many megabytes, no HOME, no TMPDIR, another language, no cache of shaders.
 */
#include "hard_cloud.h"
#include "torture_child.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FILE_BYTES, ADDRESS_SPACE, MEMORY_OPTION, SURROUNDINGS, WAY_COUNT };

static const char *const output[] = { "ply", "csv", "pcd", "las", "cloud", "vdb", "png", "exr" };
#define OUTPUT_COUNT 8

static void make_input(torture_case *c)
{
	hard_cloud cloud = { 0 };
	hard_cloud_add(c, &cloud, ROOM, 2000);
	hard_cloud_write(c, &cloud, "in.ply");
	hard_cloud_clear(&cloud);
}

/* A bake, or a picture, whose last output has that ending. */
static void command(torture_child *child, const char *ending)
{
	child_start(child);
	child->limit = 100;
	if (strcmp(ending, "png") == 0 || strcmp(ending, "exr") == 0) {
		child_add_words(child, "render in.ply --size 200x100 --force -q -o");
		child_add(child, "out.%s", ending);
		return;
	}
	child_add_words(child, "bake in.ply --bounces 2 --estimate-points 0 --force -q");
	if (strcmp(ending, "vdb") == 0)
		child_add_words(child, "-o out.ply --vdb out.vdb");
	else
		child_add(child, "-oout.%s", ending);
	child_add_words(child, "--light");
	child_add(child, "sky radiance 1");
}

static bool is_there(const torture_case *c, const char *ending)
{
	char name[20];
	size_t length;
	snprintf(name, sizeof name, "out.%s", ending);
	unsigned char *bytes = child_read_file(c, name, &length);
	free(bytes);
	return bytes != NULL;
}

/* A file of more than so many bytes can't be written: status 74 and no file, or all is there. */
static void limit_file(torture_case *c)
{
	const char *ending = output[case_pick(c, OUTPUT_COUNT)];
	torture_child child;
	char name[100];
	command(&child, ending);
	child.file_bytes = (uint64_t)pow(10, case_between(c, 0, 5.7));
	child_set(&child, "MESA_SHADER_CACHE_DISABLE=1");
	child_run(c, &child);
	if (!child_check(c, &child, "file size"))
		return;
	if ((child.code == 0) != is_there(c, ending) || (child.code != 0 && child.code != 74)) {
		snprintf(name, sizeof name, "file size/%s", ending);
		case_fail(c, name, "at most %llu bytes: status %d, the file is %sthere: %s",
				  (unsigned long long)child.file_bytes, child.code,
				  is_there(c, ending) ? "" : "not ", child.message);
	}
}

static void limit_address_space(torture_case *c)
{
	torture_child child;
	const char *ending = output[case_pick(c, OUTPUT_COUNT)];
	command(&child, ending);
	child.address_bytes = (uint64_t)(1e6 * pow(10, case_between(c, 1.7, 3.3)));
	child_run(c, &child);
	/* Below 60 MB the loader can't map the libraries and says so itself. */
	if (child.code == 127 && strstr(child.message, "shared"))
		return;
	child_check(c, &child, "address space");
}

static void limit_memory(torture_case *c)
{
	torture_child child;
	char name[100];
	double megabytes = pow(10, case_between(c, 0, 3));
	command(&child, "ply");
	child_add(&child, "--memory");
	child_add(&child, "%.0fM", megabytes);
	child_run(c, &child);
	if (!child_check(c, &child, "memory"))
		return;
	if (child.code != 0 && child.code != 71) {
		snprintf(name, sizeof name, "memory/status %d", child.code);
		case_fail(c, name, "--memory %.0fM: %s", megabytes, child.message);
	}
}

/* The result is the same in all of these. */
static void change_surroundings(torture_case *c)
{
	static const char *const setting[] = {
		"HOME=/nowhere",       "TMPDIR=/nowhere",  "XDG_CACHE_HOME=/nowhere",
		"LC_ALL=de_DE.UTF-8",  "LANG=tr_TR.UTF-8", "MESA_SHADER_CACHE_DISABLE=1",
		"MALLOC_PERTURB_=165", "LP_NUM_THREADS=0", "LP_NUM_THREADS=1",
		"MALLOC_ARENA_MAX=1",  "PATH=/nowhere",    "TZ=Pacific/Kiritimati",
	};
	torture_child child;
	command(&child, "ply");
	child_run(c, &child);
	rename(case_path(c, "out.ply"), case_path(c, "plain.ply"));
	for (int i = 0; i < 3; i++)
		child_set(&child, "%s", setting[case_pick(c, 12)]);
	child_run(c, &child);
	if (!child_check(c, &child, "surroundings"))
		return;
	if (child.code != 0 || !child_same_files(c, "out.ply", "plain.ply"))
		case_fail(c, "surroundings/not the same", "status %d: %s", child.code, child_line(&child));
}

static void run(torture_case *c)
{
	/* Libraries abort in a short address space, so the slice leaves it out. */
	if (c->slice && c->number % WAY_COUNT == ADDRESS_SPACE)
		return;
	make_input(c);
	if (!case_trial(c))
		return;
	switch (c->number % WAY_COUNT) {
	case FILE_BYTES:
		limit_file(c);
		break;
	case ADDRESS_SPACE:
		limit_address_space(c);
		break;
	case MEMORY_OPTION:
		limit_memory(c);
		break;
	default:
		change_surroundings(c);
	}
}

static long count(bool slice)
{
	return WAY_COUNT * (slice ? 6 : 200);
}

const torture_part limits_part = { "limits",
								   "files that may not grow, little memory, odd surroundings",
								   count, run };
