#include "program/crash.h"
#include "program/exit_code.h"
#include "files/output_file.h"

#include <errno.h>
#include <execinfo.h>
#include <link.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#define FRAMES 64
#define RANGES 16

/* A handler needs room of its own where the stack is what ran out. */
#define STACK_BYTES ((size_t)64 << 10)

/* Where a crash with less free address space than this counts as one for want of memory. */
#define SCARCE_BYTES ((size_t)64 << 20)

/* Sanitizers have handlers of their own, which say more. */
#ifdef __SANITIZE_ADDRESS__
#define SANITIZED true
#else
#define SANITIZED false
#endif

typedef struct range {
	uintptr_t first, last;
} range;

extern const char __executable_start, etext; /* by the linker: the program's code */

static range runtime[RANGES]; /* code of the C and C++ libraries: whoever called them is meant */
static size_t runtime_count;
static pid_t process;
static atomic_bool finished;
static atomic_flag dying = ATOMIC_FLAG_INIT;

static int note_runtime(struct dl_phdr_info *info, size_t size, void *user)
{
	static const char *const names[] = { "libc.so", "libstdc++.so", "libgcc_s.so",
										 "libm.so", "ld-linux",     "linux-vdso" };
	(void)size;
	(void)user;
	for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
		if (!strstr(info->dlpi_name, names[n]))
			continue;
		for (int i = 0; i < info->dlpi_phnum && runtime_count < RANGES; i++)
			if (info->dlpi_phdr[i].p_type == PT_LOAD && info->dlpi_phdr[i].p_flags & PF_X)
				runtime[runtime_count++] = (range){
					info->dlpi_addr + info->dlpi_phdr[i].p_vaddr,
					info->dlpi_addr + info->dlpi_phdr[i].p_vaddr + info->dlpi_phdr[i].p_memsz,
				};
	}
	return 0;
}

static bool in_runtime(uintptr_t place)
{
	for (size_t i = 0; i < runtime_count; i++)
		if (place >= runtime[i].first && place < runtime[i].last)
			return true;
	return false;
}

/* Whether the program's own code is the first one below the handler that belongs to no runtime
 * library. */
static bool is_own_fault(void)
{
	void *frame[FRAMES];
	int count = backtrace(frame, FRAMES);
	/* The first ones are the handler's, up to what the kernel has put in, which is the runtime's.
	 */
	int i = 0;
	while (i < count && !in_runtime((uintptr_t)frame[i]))
		i++;
	while (i < count && in_runtime((uintptr_t)frame[i]))
		i++;
	return i < count && (uintptr_t)frame[i] >= (uintptr_t)&__executable_start &&
		   (uintptr_t)frame[i] < (uintptr_t)&etext;
}

static bool memory_is_scarce(int reason)
{
	void *room =
		mmap(NULL, SCARCE_BYTES, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
	if (room != MAP_FAILED)
		munmap(room, SCARCE_BYTES);
	return reason == ENOMEM || reason == EAGAIN || room == MAP_FAILED;
}

static void say(const char *text)
{
	(void)!write(STDERR_FILENO, text, strlen(text));
}

static void end_for_memory(void)
{
	say("glowworm: a library, most likely the Vulkan driver, died within the program, as they do "
		"when memory or threads run out: free memory, allow more, or give the program less to "
		"do\n");
	_exit(EXIT_CODE_MEMORY);
}

static void handle(int number)
{
	int reason = errno;
	if (getpid() != process) { /* a child that has not come to its own program yet */
		signal(number, SIG_DFL);
		raise(number);
		return;
	}
	while (atomic_flag_test_and_set(&dying))
		pause(); /* another thread is at it */
	output_file_remove_temporaries();
	if (!is_own_fault() || memory_is_scarce(reason))
		end_for_memory();
	signal(number, SIG_DFL);
	raise(number);
}

/* A library has called exit. */
static void on_exit_of_others(void)
{
	if (atomic_load(&finished) || getpid() != process)
		return;
	output_file_remove_temporaries();
	end_for_memory();
}

void crash_install(void)
{
	static const int fatal[] = { SIGSEGV, SIGABRT, SIGFPE, SIGILL };
	static char room[STACK_BYTES];
	stack_t stack = { .ss_sp = room, .ss_size = sizeof room };
	struct sigaction action = { .sa_handler = handle, .sa_flags = SA_ONSTACK | SA_NODEFER };
	void *frame[1];
	if (SANITIZED)
		return;
	process = getpid();
	backtrace(frame, 1); /* loads what it needs */
	dl_iterate_phdr(note_runtime, NULL);
	sigaltstack(&stack, NULL);
	for (size_t i = 0; i < sizeof fatal / sizeof *fatal; i++)
		sigaction(fatal[i], &action, NULL);
	atexit(on_exit_of_others);
}

void crash_finish(void)
{
	atomic_store(&finished, true);
}
