#include "torture_child.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <poll.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/pidfd.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

void child_start(torture_child *child)
{
	memset(child, 0, sizeof *child);
	child->limit = 120;
}

/* Prints into the child's own store and returns where. */
static const char *keep_text(torture_child *child, const char *format, va_list list)
{
	char *at = child->text + child->text_used;
	size_t room = sizeof child->text - child->text_used;
	int length = vsnprintf(at, room, format, list);
	if (length < 0 || (size_t)length >= room) {
		fprintf(stderr, "torture: arguments of more than %zu bytes\n", sizeof child->text);
		exit(70);
	}
	child->text_used += (size_t)length + 1;
	return at;
}

void child_add(torture_child *child, const char *format, ...)
{
	va_list list;
	va_start(list, format);
	if (child->count + 1 >= CHILD_ARGUMENTS)
		exit(70);
	child->argument[child->count++] = keep_text(child, format, list);
	va_end(list);
}

void child_add_words(torture_child *child, const char *words)
{
	for (const char *at = words + strspn(words, " "); *at; at += strspn(at, " ")) {
		size_t length = strcspn(at, " ");
		child_add(child, "%.*s", (int)length, at);
		at += length;
	}
}

void child_set(torture_child *child, const char *format, ...)
{
	va_list list;
	va_start(list, format);
	if (child->setting_count >= 16)
		exit(70);
	child->setting[child->setting_count++] = keep_text(child, format, list);
	va_end(list);
}

static double now(void)
{
	struct timespec t;
	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void limit_resource(int resource, uint64_t value)
{
	struct rlimit limit = { value, value };
	setrlimit((__rlimit_resource_t)resource, &limit);
}

/* In the new process. */
static void become_program(const torture_case *c, const torture_child *child)
{
	char *arguments[CHILD_ARGUMENTS + 1] = { (char *)(uintptr_t)c->program };
	for (size_t i = 0; i < child->count; i++)
		arguments[i + 1] = (char *)(uintptr_t)child->argument[i];
	setpgid(0, 0);
	if (chdir(c->folder) != 0)
		_exit(70);
	int out = open("stdout", O_WRONLY | O_CREAT | O_TRUNC, 0666);
	int err = open("stderr", O_WRONLY | O_CREAT | O_TRUNC, 0666);
	int in = open("/dev/null", O_RDONLY);
	dup2(in, 0);
	dup2(out, 1);
	dup2(err, 2);
	for (int i = 3; i < 64; i++)
		close(i);
	for (size_t i = 0; i < child->setting_count; i++)
		putenv((char *)(uintptr_t)child->setting[i]);
	limit_resource(RLIMIT_CORE, 0);
	if (child->file_bytes)
		limit_resource(RLIMIT_FSIZE, child->file_bytes);
	if (child->address_bytes)
		limit_resource(RLIMIT_AS, child->address_bytes);
	execv(c->program, arguments);
	_exit(71);
}

/* Sleeps until the process ends, of which `ended` is a descriptor, or some seconds have passed.
 * Where the system has no such descriptors it sleeps for a moment. */
static void sleep_until_end(int ended, double seconds)
{
	if (ended < 0 || seconds <= 0)
		seconds = 5e-4;
	struct timespec nap = { (time_t)seconds, (long)(1e9 * (seconds - floor(seconds))) };
	ppoll(&(struct pollfd){ ended, POLLIN, 0 }, 1, &nap, NULL);
}

/* Waits until it ends, sends the signal that was asked for, and ends what hangs. */
static int wait_for(torture_child *child, pid_t process, struct rusage *usage)
{
	double begin = now();
	bool signalled = child->kill_after <= 0;
	int status, ended = pidfd_open(process, 0);
	while (wait4(process, &status, WNOHANG, usage) != process) {
		double passed = now() - begin;
		if (!signalled && passed >= child->kill_after) {
			kill(process, child->kill_signal);
			signalled = true;
		}
		if (passed >= child->limit && !child->hung) {
			child->hung = true;
			kill(-process, SIGKILL);
			kill(process, SIGKILL);
		}
		double next = child->hung ? passed + 1 : child->limit;
		sleep_until_end(ended, (signalled ? next : fmin(next, child->kill_after)) - passed);
	}
	child->seconds = now() - begin;
	if (ended >= 0)
		close(ended);
	return status;
}

void child_run(torture_case *c, torture_child *child)
{
	struct rusage usage = { 0 };
	pid_t process = fork();
	if (process == 0)
		become_program(c, child);
	if (process < 0) {
		perror("torture: fork");
		exit(71);
	}
	int status = wait_for(child, process, &usage);
	kill(-process, SIGKILL); /* what it left behind */
	child->signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
	child->code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
	child->megabytes = (double)usage.ru_maxrss / 1024;
	size_t length = 0;
	unsigned char *text = child_read_file(c, "stderr", &length);
	if (length >= sizeof child->message)
		length = sizeof child->message - 1;
	if (text)
		memcpy(child->message, text, length);
	child->message[length] = '\0';
	free(text);
	if (c->keep)
		printf("  %s\n  %s: %d signal %d, %.2f s, %.0f MB\n%s", child_line(child),
			   child->hung ? "hung" : "exit status", child->code, child->signal, child->seconds,
			   child->megabytes, child->message);
}

static size_t add_quoted(char *line, size_t at, size_t size, const char *word)
{
	bool plain = *word && strspn(word, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
									   "0123456789-_./=:,+%") == strlen(word);
	at += (size_t)snprintf(line + at, size - at, plain ? " " : " '");
	for (; *word && at + 8 < size; word++) {
		if (*word == '\'')
			at += (size_t)snprintf(line + at, size - at, "'\\''");
		else
			line[at++] = *word;
	}
	line[at] = '\0';
	return at + (size_t)(plain ? 0 : snprintf(line + at, size - at, "'"));
}

const char *child_line(const torture_child *child)
{
	static char line[4096];
	size_t at = 0;
	line[0] = '\0';
	for (size_t i = 0; i < child->setting_count && at + 300 < sizeof line; i++)
		at = add_quoted(line, at, sizeof line, child->setting[i]);
	at = add_quoted(line, at, sizeof line, "glowworm");
	for (size_t i = 0; i < child->count && at + 300 < sizeof line; i++)
		at = add_quoted(line, at, sizeof line, child->argument[i]);
	return line + 1;
}

static bool is_documented(int code)
{
	static const int good[] = { 0, 1, 2, 65, 66, 69, 70, 71, 73, 74, 75, 129, 130, 143 };
	for (size_t i = 0; i < sizeof good / sizeof *good; i++)
		if (code == good[i])
			return true;
	return false;
}

/* The last line of what it said. */
static const char *last_words(const torture_child *child)
{
	static char words[200];
	size_t length = strlen(child->message);
	while (length > 0 && child->message[length - 1] == '\n')
		length--;
	size_t begin = length;
	while (begin > 0 && child->message[begin - 1] != '\n')
		begin--;
	snprintf(words, sizeof words, "%.*s", (int)(length - begin), child->message + begin);
	return words;
}

bool child_check(torture_case *c, const torture_child *child, const char *row)
{
	char class_name[200];
	if (child->hung) {
		snprintf(class_name, sizeof class_name, "%s/hang", row);
		case_fail(c, class_name, "did not end in %.0f s: %s", child->limit, child_line(child));
		return false;
	}
	if (child->signal && child->signal != child->kill_signal) {
		snprintf(class_name, sizeof class_name, "%s/signal %d", row, child->signal);
		case_fail(c, class_name, "%s | %s", last_words(child), child_line(child));
		return false;
	}
	if (!child->signal && !is_documented(child->code)) {
		snprintf(class_name, sizeof class_name, "%s/status %d", row, child->code);
		case_fail(c, class_name, "%s | %s", last_words(child), child_line(child));
		return false;
	}
	/* Where files are that small, the one that messages go to is cut off before a word is said. */
	bool mute = child->file_bytes > 0 && child->file_bytes < strlen("glowworm: ");
	if (child->code > 1 && !mute && !strstr(child->message, "glowworm: ") &&
		!strstr(child->message, "glowworm ")) {
		snprintf(class_name, sizeof class_name, "%s/no sentence", row);
		case_fail(c, class_name, "status %d without a sentence: %s", child->code,
				  child_line(child));
		return false;
	}
	if (child->signal == 0 && child_count_files(c, ".part") > 0) {
		snprintf(class_name, sizeof class_name, "%s/part left", row);
		case_fail(c, class_name, "a .part file stays: %s", child_line(child));
		return false;
	}
	return true;
}

int child_count_files(const torture_case *c, const char *end)
{
	DIR *folder = opendir(c->folder);
	int count = 0;
	for (struct dirent *e; folder && (e = readdir(folder));) {
		size_t length = strlen(e->d_name), tail = strlen(end);
		count += length >= tail && strcmp(e->d_name + length - tail, end) == 0;
	}
	if (folder)
		closedir(folder);
	return count;
}

unsigned char *child_read_file(const torture_case *c, const char *name, size_t *length)
{
	FILE *file = fopen(case_path(c, name), "rb");
	*length = 0;
	if (!file)
		return NULL;
	size_t capacity = 1 << 16;
	unsigned char *bytes = malloc(capacity + 1);
	while (bytes) {
		*length += fread(bytes + *length, 1, capacity - *length, file);
		if (*length < capacity)
			break;
		capacity *= 2;
		bytes = realloc(bytes, capacity + 1);
	}
	fclose(file);
	if (!bytes)
		exit(71);
	bytes[*length] = '\0';
	return bytes;
}

void child_write_file(const torture_case *c, const char *name, const void *bytes, size_t length)
{
	FILE *file = fopen(case_path(c, name), "wb");
	bool good = file && fwrite(bytes, 1, length, file) == length;
	if (!file || fclose(file) != 0 || !good) {
		perror("torture: cannot write a case's file");
		exit(74);
	}
}

/* Cuts the line that names the command out of a file's header. */
static size_t without_command(unsigned char *bytes, size_t length)
{
	static const char mark[] = "glowworm command";
	unsigned char *line =
		bytes ? memmem(bytes, length < 4096 ? length : 4096, mark, sizeof mark - 1) : NULL;
	if (!line)
		return length;
	unsigned char *end = memchr(line, '\n', length - (size_t)(line - bytes));
	if (!end)
		return length;
	memmove(line, end, length - (size_t)(end - bytes));
	return length - (size_t)(end - line);
}

bool child_same_files(const torture_case *c, const char *a, const char *b)
{
	size_t a_length, b_length;
	unsigned char *a_bytes = child_read_file(c, a, &a_length);
	unsigned char *b_bytes = child_read_file(c, b, &b_length);
	a_length = without_command(a_bytes, a_length);
	b_length = without_command(b_bytes, b_length);
	bool same =
		a_bytes && b_bytes && a_length == b_length && memcmp(a_bytes, b_bytes, a_length) == 0;
	free(a_bytes);
	free(b_bytes);
	return same;
}
