/*
 * Memory, threads and folders of the machine.
 */
#include "program/child_process.h"
#include "verbs/health.h"
#include "glowworm_host.h"

#include <errno.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <unistd.h>

#define MEGABYTE ((uint64_t)1 << 20)

/* Driver and libraries alone take about 150 MB, and a bake of 100,000 points as much again. */
#define MEMORY_LEAST (256 * MEGABYTE)
#define MEMORY_AMPLE (1024 * MEGABYTE)

/* The software driver reserves addresses of some gigabytes, and aborts when it gets none. */
#define ADDRESSES_AMPLE (4096 * MEGABYTE)

#define ROOM_LEAST (64 * MEGABYTE)
#define ROOM_AMPLE (1024 * MEGABYTE)

static health_verdict judge(uint64_t there, uint64_t least, uint64_t ample)
{
	return there < least ? HEALTH_BAD : there < ample ? HEALTH_WARNING : HEALTH_GOOD;
}

/* -------------------------------------------------------------------------------- memory */

void health_judge_memory(health *h, const health_memory *m)
{
	if (m->available > 0)
		health_add(h, judge(m->available, MEMORY_LEAST, MEMORY_AMPLE), "memory",
				   "%.2f GB can be taken without swapping, by the system and its control groups",
				   (double)m->available * 1e-9);
	else
		health_add(h, HEALTH_WARNING, "memory", "the system does not say how much there is");
	if (m->address_space == UINT64_MAX)
		health_add(h, HEALTH_GOOD, "address space", "no limit (ulimit -v)");
	else
		health_add(h, judge(m->address_space, MEMORY_LEAST, ADDRESSES_AMPLE), "address space",
				   "limited to %.2f GB (ulimit -v); drivers may abort when they get no more",
				   (double)m->address_space * 1e-9);
	if (m->budget > 0)
		health_add(h, judge(m->budget, MEMORY_LEAST / 2, MEMORY_AMPLE / 2), "budget of a bake",
				   "%.2f GB; some 1 GB is needed for a million points", (double)m->budget * 1e-9);
}

static void check_memory(health *h)
{
	struct rlimit limit;
	health_memory memory = { .available = gw_available_memory(),
							 .address_space = UINT64_MAX,
							 .budget = h->budget };
	if (getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
		memory.address_space = limit.rlim_cur;
	health_judge_memory(h, &memory);
}

/* ------------------------------------------------------------------------------- threads */

typedef struct thread_trial {
	uint32_t wanted, started;
} thread_trial;

static void *wait_for_all(void *user)
{
	(void)user;
	pause();
	return NULL;
}

/* In a process of its own, which ends with all that it started. */
static void start_threads(void *user)
{
	thread_trial *trial = user;
	pthread_t thread;
	while (trial->started < trial->wanted && pthread_create(&thread, NULL, wait_for_all, NULL) == 0)
		trial->started++;
}

void health_judge_threads(health *h, uint32_t started, uint32_t wanted)
{
	if (started >= wanted)
		health_add(h, HEALTH_GOOD, "threads", "%u start", wanted);
	else if (started > 0)
		health_add(h, HEALTH_WARNING, "threads",
				   "%u of %u start (ulimit -u, or the control group's pids.max): slower", started,
				   wanted);
	else
		health_add(h, HEALTH_BAD, "threads",
				   "not one starts (ulimit -u, or the control group's pids.max); drivers and "
				   "libraries need some");
}

static gw_status check_threads(health *h, gw_error *error)
{
	thread_trial *trial = child_memory_create(sizeof *trial);
	if (!trial)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to try threads");
	trial->wanted = gw_thread_count(h->asked->bake.threads);
	child_end end;
	gw_status status = child_run(start_threads, trial, 60.0, &end, error);
	if (status == GW_OK)
		health_judge_threads(h, trial->started, trial->wanted);
	child_memory_destroy(trial, sizeof *trial);
	return status;
}

/* ------------------------------------------------------------------------------- folders */

/* Writes a file and takes it away again; 0, or why that failed. */
static int try_file(const char *folder)
{
	char path[4096];
	static const char text[512] = "glowworm doctor\n";
	if (snprintf(path, sizeof path, "%s/.glowworm-doctor-XXXXXX", folder) >= (int)sizeof path)
		return ENAMETOOLONG;
	int file = mkstemp(path);
	if (file < 0)
		return errno;
	int failure = 0;
	errno = 0;
	if (write(file, text, sizeof text) != (ssize_t)sizeof text)
		failure = errno ? errno : ENOSPC;
	else if (fsync(file) != 0 && errno != EINVAL)
		failure = errno;
	/* Network file systems report a full disk at the close. */
	if (close(file) != 0 && failure == 0)
		failure = errno;
	unlink(path);
	return failure;
}

void health_judge_folder(health *h, const char *name, const char *folder, bool needed)
{
	struct statvfs room;
	health_verdict worst = needed ? HEALTH_BAD : HEALTH_WARNING;
	int failure = try_file(folder);
	if (failure) {
		health_add(h, worst, name, "%.200s: no file can be written: %s", folder, strerror(failure));
		return;
	}
	if (statvfs(folder, &room) != 0) {
		health_add(h, HEALTH_WARNING, name, "%.200s: its room is not known: %s", folder,
				   strerror(errno));
		return;
	}
	uint64_t bytes = (uint64_t)room.f_bavail * room.f_frsize;
	health_verdict verdict = judge(bytes, ROOM_LEAST, ROOM_AMPLE);
	health_add(h, verdict > worst ? worst : verdict, name, "%.200s: %.2f GB free", folder,
			   (double)bytes * 1e-9);
}

/* Where Mesa, whose drivers most machines have, keeps what it compiled. */
static bool find_cache(char path[4096])
{
	const char *own = getenv("MESA_SHADER_CACHE_DIR"), *cache = getenv("XDG_CACHE_HOME"),
			   *home = getenv("HOME");
	if (own && *own)
		snprintf(path, 4096, "%s/mesa_shader_cache", own);
	else if (cache && *cache)
		snprintf(path, 4096, "%s/mesa_shader_cache", cache);
	else if (home && *home)
		snprintf(path, 4096, "%s/.cache/mesa_shader_cache", home);
	else
		return false;
	return true;
}

static void check_cache(health *h)
{
	char path[4096];
	struct stat info;
	bool found = find_cache(path);
	int failure = found ? try_file(path) : ENOENT;
	/* A cache that nobody has needed yet is made later. */
	if (found && failure == ENOENT && stat(path, &info) != 0) {
		*strrchr(path, '/') = '\0';
		failure = try_file(path);
	}
	if (!failure)
		health_add(h, HEALTH_GOOD, "shader cache", "%.200s", path);
	else
		health_add(
			h, HEALTH_WARNING, "shader cache",
			"%.160s cannot be written (%s): every bake compiles its shaders anew, which takes "
			"seconds; set MESA_SHADER_CACHE_DIR",
			found ? path : "HOME is not set, so a folder", strerror(failure));
}

gw_status health_of_machine(health *h, gw_error *error)
{
	const char *temporary = getenv("TMPDIR");
	health_begin(h, "machine");
	check_memory(h);
	gw_status status = check_threads(h, error);
	health_judge_folder(h, "current folder", ".", true);
	health_judge_folder(h, "temporary folder", temporary && *temporary ? temporary : "/tmp", false);
	check_cache(h);
	return status;
}
