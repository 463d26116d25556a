/*
 * parallel.c - loops over CPU threads.
 */
#include "base/parallel.h"

#include <assert.h>
#include <dirent.h>
#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

typedef struct loop {
	size_t count, chunk, chunks;
	gw_parallel_work *work;
	void *user;
	atomic_size_t next; /* chunk that nobody has taken yet */
} loop;

typedef struct worker {
	loop *loop;
	uint32_t index;
	pthread_t thread;
} worker;

uint32_t gw_thread_count(uint32_t requested)
{
	if (requested == 0) {
		cpu_set_t set;
		int processors = sched_getaffinity(0, sizeof set, &set) == 0 ? CPU_COUNT(&set) : 1;
		requested = processors > 0 ? (uint32_t)processors : 1;
	}
	return requested < GW_THREADS_MAX ? requested : GW_THREADS_MAX;
}

static void take_chunks(loop *shared, uint32_t index)
{
	size_t taken;
	while ((taken = atomic_fetch_add_explicit(&shared->next, 1, memory_order_relaxed)) <
		   shared->chunks) {
		size_t first = taken * shared->chunk;
		size_t left = shared->count - first;
		shared->work(shared->user, first, first + (left < shared->chunk ? left : shared->chunk),
					 index);
	}
}

static void *run_worker(void *argument)
{
	worker *self = argument;
	take_chunks(self->loop, self->index);
	return NULL;
}

void gw_signals_to_block(sigset_t *set)
{
	static const int own[] = { SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL, SIGTRAP };
	sigfillset(set);
	for (size_t i = 0; i < sizeof own / sizeof *own; i++)
		sigdelset(set, own[i]);
}

static void *wait_for_end(void *user)
{
	pthread_mutex_t *running = user;
	pthread_mutex_lock(running);
	pthread_mutex_unlock(running);
	return NULL;
}

uint32_t gw_threads_startable(uint32_t wanted)
{
	pthread_t thread[GW_THREADS_MAX];
	pthread_mutex_t running = PTHREAD_MUTEX_INITIALIZER;
	uint32_t started = 0;
	wanted = wanted < GW_THREADS_MAX ? wanted : GW_THREADS_MAX;
	sigset_t blocked, before;
	gw_signals_to_block(&blocked);
	pthread_sigmask(SIG_SETMASK, &blocked, &before);
	pthread_mutex_lock(&running);
	while (started < wanted && pthread_create(&thread[started], NULL, wait_for_end, &running) == 0)
		started++;
	pthread_mutex_unlock(&running);
	for (uint32_t i = 0; i < started; i++)
		pthread_join(thread[i], NULL);
	pthread_sigmask(SIG_SETMASK, &before, NULL);
	return started;
}

/* The state of a thread as of proc(5): R for one that runs, D for one that waits for a disk; 0
 * where nobody knows. */
static char state_of_thread(const char *number)
{
	char path[64], line[512] = "";
	snprintf(path, sizeof path, "/proc/self/task/%.20s/stat", number);
	FILE *file = fopen(path, "re");
	if (file == NULL)
		return 0;
	char *name_end = fgets(line, sizeof line, file) ? strrchr(line, ')') : NULL;
	fclose(file);
	return name_end != NULL && name_end[1] == ' ' ? name_end[2] : 0;
}

bool gw_threads_any_busy(void)
{
	DIR *threads = opendir("/proc/self/task");
	bool any = false;
	if (threads == NULL)
		return false;
	for (struct dirent *entry; !any && (entry = readdir(threads)) != NULL;) {
		if (entry->d_name[0] == '.' || strtol(entry->d_name, NULL, 10) == (long)gettid())
			continue;
		char state = state_of_thread(entry->d_name);
		any = state == 'R' || state == 'D';
	}
	closedir(threads);
	return any;
}

void gw_parallel_for(uint32_t threads, size_t count, size_t chunk, gw_parallel_work *work,
					 void *user)
{
	assert(chunk > 0 && work != NULL);
	size_t chunks = count / chunk + (count % chunk != 0);
	loop shared = { .count = count, .chunk = chunk, .chunks = chunks, .work = work, .user = user };
	threads = gw_thread_count(threads);
	threads = chunks < threads ? (uint32_t)chunks : threads;

	sigset_t all, before;
	gw_signals_to_block(&all);
	pthread_sigmask(SIG_SETMASK, &all, &before);
	worker workers[GW_THREADS_MAX];
	uint32_t started = 1;
	for (; started < threads; started++) {
		workers[started] = (worker){ .loop = &shared, .index = started };
		if (pthread_create(&workers[started].thread, NULL, run_worker, &workers[started]) != 0)
			break;
	}
	pthread_sigmask(SIG_SETMASK, &before, NULL);

	take_chunks(&shared, 0);
	for (uint32_t i = 1; i < started; i++)
		pthread_join(workers[i].thread, NULL);
}
