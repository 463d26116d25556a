/*
 * torture_faults.c - every call of a few small commands that can fail, failing: the n-th, for every
 * n, alone or with all that follow.
 *
 * A case is a command, a kind of call, whose calls count, whether the later ones fail as well, and
 * a share of the numbers n. Whatever fails, the program ends with a status of its own and a
 * sentence, its outputs are absent or whole, and when it says that all went well they are what they
 * are without the fault, or a note says what is different.
 */
#include "hard_cloud.h"
#include "torture_child.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct fault_command {
	const char *name;
	const char *arguments;
	const char *light; /* or NULL */
	const char *output[3];
} fault_command;

static const fault_command commands[] = {
	{ "bake",
	  "bake in.ply -o out.ply --report out.json --threads 2 --force",
	  "sky radiance 1",
	  { "out.ply" } },
	{ "cones",
	  "bake in.ply -o out.ply --method cones --shadows maps --shadow-map-size 32 "
	  "--threads 2 --force",
	  "point at 0.1,0,0 intensity 3",
	  { "out.ply" } },
	{ "grid",
	  "bake in.ply -o out.ply --vdb out.vdb --bounces 1 --estimate-points 0 --force",
	  "sky radiance 1",
	  { "out.ply" } },
	{ "again",
	  "bake in.ply --transport in.transport -o out.ply --force",
	  "point at 0.1,0,0 intensity 3",
	  { "out.ply" } },
	{ "convert", "convert in.ply out.pcd --force", NULL, { "out.pcd" } },
	{ "render", "render lit.ply -o out.png --size 48x32 --force", NULL, { "out.png" } },
	{ "picture", "render lit.ply -o out.exr --size 48x32 --force", NULL, { "out.exr" } },
	{ "compare", "compare lit.ply lit.ply", NULL, { "stdout" } },
	{ "info", "info in.ply --json", NULL, { "stdout" } },
};
#define COMMAND_COUNT ((long)(sizeof commands / sizeof *commands))

typedef struct fault_kind {
	const char *kind, *owner;
	long shares;   /* cases that divide the numbers n between them */
	long most;     /* trials of a case; more n than that are drawn at random */
	int error;     /* FAULT_ERROR */
	bool in_slice; /* for the first commands */
} fault_kind;

/* VkResults: out of host memory, of device memory, and the device is lost. */
static const fault_kind kinds[] = {
	{ "alloc", "program", 4, 200, 0, true },  { "mmap", "program", 1, 50, 0, true },
	{ "read", "program", 1, 50, 0, true },    { "write", "program", 1, 50, 0, true },
	{ "open", "program", 1, 50, 0, true },    { "close", "program", 1, 50, 0, true },
	{ "fsync", "program", 1, 50, 0, true },   { "rename", "program", 1, 50, 0, true },
	{ "folder", "program", 1, 50, 0, true },  { "thread", "program", 1, 100, 0, true },
	{ "vulkan", "any", 4, 300, -1, true },    { "vulkan", "any", 4, 300, -2, false },
	{ "vulkan", "any", 4, 300, -4, true },    { "alloc", "library", 40, 100, 0, false },
	{ "mmap", "library", 1, 100, 0, false },  { "read", "library", 1, 150, 0, false },
	{ "open", "library", 1, 150, 0, false },  { "close", "library", 1, 100, 0, false },
	{ "thread", "library", 1, 50, 0, false },
};
#define KIND_COUNT ((long)(sizeof kinds / sizeof *kinds))

typedef struct fault_case {
	const fault_command *command;
	const fault_kind *kind;
	bool onwards;
	long share, shares;
	char row[100];
} fault_case;

/* ---------------------------------------------------------------------------- which case it is */

static bool slice_has(const fault_kind *kind, long command)
{
	return kind->in_slice && (command < 2 || (command < 7 && strcmp(kind->kind, "vulkan") != 0));
}

/* The numbered case; false when there are fewer. In the slice each has one share. */
static bool find_case(long number, bool slice, fault_case *f)
{
	for (long k = 0; k < KIND_COUNT; k++) {
		for (long m = 0; m < COMMAND_COUNT; m++) {
			if (slice && !slice_has(&kinds[k], m))
				continue;
			long shares = slice ? 1 : 2 * kinds[k].shares;
			if (number >= shares) {
				number -= shares;
				continue;
			}
			*f = (fault_case){ .command = &commands[m], .kind = &kinds[k] };
			f->onwards = slice ? (k + m) % 2 == 1 : number % 2 == 1;
			f->share = slice ? 0 : number / 2;
			f->shares = kinds[k].shares;
			snprintf(f->row, sizeof f->row, "%s/%s of %s", f->command->name, f->kind->kind,
					 f->kind->owner);
			return true;
		}
	}
	return false;
}

static long count(bool slice)
{
	fault_case f;
	long n = 0;
	while (find_case(n, slice, &f))
		n++;
	return n;
}

/* ------------------------------------------------------------------------------------ inputs */

/* A closed room of few points, of which a few glow. */
static void make_new_inputs(torture_case *c)
{
	hard_cloud cloud = { 0 };
	torture_child child;
	hard_cloud_add(c, &cloud, ROOM, 150);
	hard_cloud_emission(&cloud, 0);
	for (size_t i = 0; i < 10; i++)
		cloud.point[i].emission[1] = 1;
	hard_cloud_write(c, &cloud, "in.ply");
	hard_cloud_clear(&cloud);
	child_start(&child);
	child_add_words(&child, "bake in.ply -o lit.ply --save-transport in.transport -q --light");
	child_add(&child, "sky radiance 1");
	child_run(c, &child);
	if (child.code != 0)
		case_fail(c, "inputs", "status %d: %s", child.code, child.message);
}

/* Inputs of the slice, which differ from those of another seed only: half of its time went into
 * inputs and runs without a fault of each case's own. What a worker has made it keeps. */
static struct kept_input {
	const char *name;
	unsigned char *bytes;
	size_t length;
} kept_inputs[] = { { .name = "in.ply" }, { .name = "lit.ply" }, { .name = "in.transport" } };

static void make_shared_inputs(torture_case *c)
{
	uint64_t state = c->state;
	bool whole = true;
	for (int i = 0; i < 3 && whole; i++)
		whole = kept_inputs[i].bytes != NULL;
	if (!whole) {
		c->state = c->begin;
		make_new_inputs(c);
		c->state = state;
	}
	for (int i = 0; i < 3; i++) {
		struct kept_input *k = &kept_inputs[i];
		if (whole) {
			child_write_file(c, k->name, k->bytes, k->length);
			continue;
		}
		free(k->bytes);
		k->bytes = child_read_file(c, k->name, &k->length);
	}
}

static void make_inputs(torture_case *c)
{
	if (c->slice)
		make_shared_inputs(c);
	else
		make_new_inputs(c);
}

/* The n-th call fails; 0: none does, and those of each kind are counted. */
static void prepare(torture_case *c, const fault_case *f, torture_child *child, long at)
{
	child_start(child);
	child_add_words(child, f->command->arguments);
	if (f->command->light) {
		child_add(child, "--light");
		child_add(child, "%s", f->command->light);
	}
	child_set(child, "FAULT_KIND=%s", at > 0 ? f->kind->kind : "all");
	child_set(child, "FAULT_OWNER=%s", f->kind->owner);
	child_set(child, "FAULT_AT=%ld", at);
	child_set(child, "FAULT_ONWARDS=%d", f->onwards ? 1 : 0);
	child_set(child, "FAULT_ERROR=%d", f->kind->error);
	child_set(child, "FAULT_REPORT=fault");
	child_set(child, "LD_PRELOAD=%s", c->shim);
	child->limit = 60;
}

/* What the shim wrote: which call failed, in which library. */
static void read_fault(torture_case *c, char *hit, size_t size)
{
	size_t length;
	char *text = (char *)child_read_file(c, "fault", &length);
	char function[64] = "", owner[64] = "", object[64] = "";
	for (char *line = text ? strtok(text, "\n") : NULL; line; line = strtok(NULL, "\n"))
		sscanf(line, "hit %63s %63s %63s", function, owner, object);
	snprintf(hit, size, "%s on %s in %s", function, object, owner);
	free(text);
}

/* And how many calls there were of each kind and owner, when all were counted. */
static void read_calls(torture_case *c, long calls[KIND_COUNT])
{
	size_t length;
	char *text = (char *)child_read_file(c, "fault", &length), kind[64], owner[64];
	long n;
	memset(calls, 0, sizeof *calls * (size_t)KIND_COUNT);
	for (char *line = text ? strtok(text, "\n") : NULL; line; line = strtok(NULL, "\n")) {
		if (sscanf(line, "calls %ld %63s %63s", &n, kind, owner) != 3)
			continue;
		for (long k = 0; k < KIND_COUNT; k++)
			if (strcmp(kinds[k].kind, kind) == 0 &&
				(strcmp(kinds[k].owner, "any") == 0 || strcmp(kinds[k].owner, owner) == 0))
				calls[k] += n;
	}
	free(text);
}

static void remove_outputs(torture_case *c, const fault_command *command)
{
	remove(case_path(c, "fault"));
	for (int i = 0; i < 3 && command->output[i]; i++)
		remove(case_path(c, command->output[i]));
	remove(case_path(c, "out.json"));
	remove(case_path(c, "out.vdb"));
}

/* What a run without a fault did and wrote. In the slice, whose cases have the same inputs, a
 * worker keeps it: each case's own such run was a quarter of all launches. */
typedef struct whole_run {
	bool kept;
	long calls[KIND_COUNT];
	unsigned char *bytes[3]; /* of the outputs; NULL for one that there is not */
	size_t length[3];
} whole_run;

static void name_kept(char *name, size_t size, const char *output)
{
	snprintf(name, size, "kept-%s", output);
}

/* Runs the command twice, as the first time fills the driver's cache of shaders. */
static bool run_whole(torture_case *c, const fault_case *f, whole_run *run)
{
	torture_child child;
	char kept[100];
	for (int runs = 2; runs > 0; runs--) {
		remove_outputs(c, f->command);
		prepare(c, f, &child, 0);
		child_run(c, &child);
	}
	read_calls(c, run->calls);
	if (child.code != 0 || child.hung) {
		case_fail(c, f->row, "status %d without any fault: %s", child.code, child.message);
		return false;
	}
	for (int i = 0; i < 3 && f->command->output[i]; i++) {
		name_kept(kept, sizeof kept, f->command->output[i]);
		rename(case_path(c, f->command->output[i]), case_path(c, kept));
		free(run->bytes[i]);
		run->bytes[i] = child_read_file(c, kept, &run->length[i]);
	}
	run->kept = true;
	return true;
}

/* Without a fault: counts the calls and keeps what comes out. */
static long count_calls(torture_case *c, const fault_case *f)
{
	static whole_run runs[COMMAND_COUNT];
	whole_run *run = &runs[f->command - commands];
	char kept[100];
	if (!c->slice || !run->kept)
		return run_whole(c, f, run) ? run->calls[f->kind - kinds] : 0;
	for (int i = 0; i < 3 && run->bytes[i]; i++) {
		name_kept(kept, sizeof kept, f->command->output[i]);
		child_write_file(c, kept, run->bytes[i], run->length[i]);
	}
	return run->calls[f->kind - kinds];
}

/* ------------------------------------------------------------------------------------ checks */

static bool is_there(const torture_case *c, const char *name)
{
	size_t length;
	unsigned char *bytes = child_read_file(c, name, &length);
	free(bytes);
	return bytes != NULL;
}

/* The library that a call failed in, as a part of the class of the failure. */
static void describe(const fault_case *f, const char *hit, char *row, size_t size)
{
	const char *in = strstr(hit, " in ");
	char owner[64];
	snprintf(owner, sizeof owner, "%s", in ? in + 4 : "nobody");
	owner[strcspn(owner, ".")] = '\0';
	snprintf(row, size, "%s/%s of %s", f->command->name, f->kind->kind,
			 strcmp(f->kind->owner, "library") == 0 ? owner : f->kind->owner);
}

static void check_outputs(torture_case *c, const fault_case *f, const torture_child *child,
						  const char *row, const char *hit)
{
	char class_name[300], kept[100];
	bool noted = strstr(child->message, "glowworm: ") && !strstr(child->message, "error: ");
	noted = noted || strstr(child->message, "memory") || strstr(child->message, "coarse");
	/* What was not written, not kept or not renamed was not done; but what a driver writes is its
	 * own cache. */
	bool lost = (strstr(hit, " on output ") && !strstr(hit, " libvulkan")) ||
				strncmp(hit, "rename", 6) == 0 || strncmp(hit, "fsync", 5) == 0;
	if (child->code == 0 && lost && strncmp(hit, "open", 4) != 0) {
		snprintf(class_name, sizeof class_name, "%s/unnoticed", row);
		case_fail(c, class_name, "status 0 though %s failed: %s", hit, child_line(child));
	}
	for (int i = 0; i < 3 && f->command->output[i]; i++) {
		const char *output = f->command->output[i];
		bool is_stdout = strcmp(output, "stdout") == 0;
		snprintf(kept, sizeof kept, "kept-%s", output);
		if (child->code > 1 && !is_stdout && is_there(c, output) &&
			!child_same_files(c, output, kept)) {
			snprintf(class_name, sizeof class_name, "%s/partial output", row);
			case_fail(c, class_name, "status %d and another %s (%s): %s", child->code, output, hit,
					  child_line(child));
		}
		if (child->code == 0 && !noted && !child_same_files(c, output, kept)) {
			snprintf(class_name, sizeof class_name, "%s/silent change", row);
			case_fail(c, class_name, "status 0, %s is another one, and no note (%s): %s", output,
					  hit, child_line(child));
		}
	}
}

static void try_fault(torture_case *c, const fault_case *f, long at)
{
	torture_child child;
	char hit[200], row[200];
	remove_outputs(c, f->command);
	prepare(c, f, &child, at);
	child_run(c, &child);
	read_fault(c, hit, sizeof hit);
	describe(f, hit, row, sizeof row);
	if (child_check(c, &child, row))
		check_outputs(c, f, &child, row, hit);
	if (child_count_files(c, ".part") > 0) {
		uint64_t state = c->state; /* what follows is the same as when this trial is left out */
		case_clear_folder(c);
		make_inputs(c);
		count_calls(c, f);
		c->state = state;
	}
}

/* A command that makes a file writes it, brings it to the disk, closes and renames it, and brings
 * the folder to the disk. */
static bool is_owed(const fault_case *f)
{
	static const char *const owed[] = { "write", "fsync", "close", "rename", "folder" };
	for (int i = 0; i < 5; i++)
		if (strcmp(f->kind->kind, owed[i]) == 0)
			return strcmp(f->kind->owner, "program") == 0 &&
				   strcmp(f->command->output[0], "stdout") != 0;
	return false;
}

static void run(torture_case *c)
{
	fault_case f;
	if (!find_case(c->number, c->slice, &f))
		return;
	make_inputs(c);
	long calls = count_calls(c, &f), own = calls / f.shares + 1;
	if (calls == 0 && is_owed(&f) && case_trial(c))
		case_fail(c, f.row, "there is no such call: an output is not made safe");
	long most = c->slice ? 4 : f.kind->most;
	for (long i = 0; i < own && i < most; i++) {
		long n = own <= most ? i : case_pick(c, own);
		long at = 1 + f.share + n * f.shares;
		if (at <= calls && case_trial(c))
			try_fault(c, &f, at);
	}
}

const torture_part faults_part = {
	"faults", "the n-th call fails: memory, files, threads, Vulkan; ours and the libraries'", count,
	run
};
