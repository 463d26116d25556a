/*
 * torture_kills.c - signals at random times. The output is absent, as it was, or whole; after
 * SIGINT and SIGTERM no temporary file stays and the status is 128 and the signal's number; after
 * SIGKILL one may, which the next run has to stand.
 */
#include "hard_cloud.h"
#include "torture_child.h"

#include <dirent.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct {
	const char *name, *arguments, *light, *output;
} commands[] = {
	{ "bake", "bake in.ply -o out.ply --force -q", "sky radiance 1", "out.ply" },
	{ "cones", "bake in.ply -o out.ply --method cones --force -q", "point at 0.1,0,0 intensity 3",
	  "out.ply" },
	{ "refine", "bake in.ply -o out.ply --max-error 0.001 --force -q", "sky radiance 1",
	  "out.ply" },
	{ "render", "render in.ply -o out.png --size 300x200 --force -q", NULL, "out.png" },
	{ "convert", "convert in.ply out.csv --force", NULL, "out.csv" },
};
#define COMMAND_COUNT 5

static const char old[] = "what was there before";

/* The file is the old one, or has the end that a whole one has. */
static bool is_whole(const torture_case *c, const char *name)
{
	size_t length, whole;
	unsigned char *bytes = child_read_file(c, name, &length);
	unsigned char *reference = child_read_file(c, "whole", &whole);
	bool good = !bytes || (length == strlen(old) && memcmp(bytes, old, length) == 0) ||
				child_same_files(c, name, "whole");
	free(bytes);
	free(reference);
	return good;
}

static void prepare(torture_case *c, int command, torture_child *child)
{
	child_start(child);
	child_add_words(child, commands[command].arguments);
	if (commands[command].light) {
		child_add(child, "--light");
		child_add(child, "%s", commands[command].light);
	}
	child_set(child, "LP_NUM_THREADS=%ld", case_pick(c, 3));
}

/* whole: the status of the command when no signal comes, which may come too late. */
static void check_killed(torture_case *c, int command, const torture_child *child, int whole)
{
	char name[100];
	int sent = child->kill_signal;
	if (!child_check(c, child, commands[command].name))
		return;
	if (!is_whole(c, commands[command].output)) {
		snprintf(name, sizeof name, "%s/partial output", commands[command].name);
		case_fail(c, name, "signal %d after %.3f s: %s", sent, child->kill_after,
				  child_line(child));
	}
	/* A signal before the program has its handlers ends it as any other; it has done nothing yet.
	 */
	bool early = child->signal == sent && child_count_files(c, ".part") == 0;
	if (sent != SIGKILL && !early && child->code != whole && child->code != 128 + sent) {
		snprintf(name, sizeof name, "%s/status", commands[command].name);
		case_fail(c, name, "signal %d after %.3f s gives status %d, signal %d", sent,
				  child->kill_after, child->code, child->signal);
	}
	double late = child->seconds - child->kill_after;
	if (sent != SIGKILL && late > 10) { /* a second, on a machine that does ten things at once */
		snprintf(name, sizeof name, "%s/late", commands[command].name);
		case_fail(c, name, "ended %.1f s after the signal", late);
	}
}

/* What SIGKILL left. */
static void remove_parts(const torture_case *c)
{
	DIR *folder = opendir(c->folder);
	for (struct dirent *e; folder && (e = readdir(folder));)
		if (strstr(e->d_name, ".part"))
			remove(case_path(c, e->d_name));
	if (folder)
		closedir(folder);
}

static void run(torture_case *c)
{
	static const int signals[] = { SIGKILL, SIGINT, SIGTERM };
	int command = (int)(c->number % COMMAND_COUNT);
	hard_cloud cloud = { 0 };
	torture_child child;
	hard_cloud_add(c, &cloud, ROOM, 1000);
	hard_cloud_write(c, &cloud, "in.ply");
	hard_cloud_clear(&cloud);
	prepare(c, command, &child);
	child_run(c, &child);
	double seconds = child.seconds;
	int whole = child.code;
	if (whole > 1) {
		case_fail(c, "inputs", "status %d: %s", child.code, child.message);
		return;
	}
	rename(case_path(c, commands[command].output), case_path(c, "whole"));
	for (int i = 0; i < (c->slice ? 6 : 20); i++) {
		remove(case_path(c, commands[command].output));
		if (case_one_in(c, 2))
			child_write_file(c, commands[command].output, old, strlen(old));
		prepare(c, command, &child);
		child.kill_signal = signals[i % 3];
		child.kill_after = case_between(c, 0.0005, 1.05 * seconds);
		if (!case_trial(c))
			continue;
		child_run(c, &child);
		check_killed(c, command, &child, whole);
		remove_parts(c);
	}
}

static long count(bool slice)
{
	return slice ? COMMAND_COUNT : 20 * COMMAND_COUNT;
}

const torture_part kills_part = { "kills", "SIGKILL, SIGINT, SIGTERM at random times", count, run };
