/*
 * torture_main.c - runs the cases of the campaign, several at a time, remembers which are done,
 * and counts.
 *
 * A line a finished case is appended to DIR/seed-N.done, so that a run that was stopped goes on
 * where it was. Measured figures go to DIR/seed-N.figures, failures to DIR/seed-N.failures.
 */
#include "torture_case.h"

#include <errno.h>
#include <fnmatch.h>
#include <getopt.h>
#include <limits.h>
#include <math.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <dirent.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static const torture_part *const parts[] = {
	&clouds_part, &light_part,  &faults_part, &shrinking_part,
	&kills_part,  &limits_part, &scenes_part, &options_part,
};
#define PART_COUNT ((int)(sizeof parts / sizeof *parts))

typedef struct case_id {
	int part;
	long number;
} case_id;

typedef struct known_failure {
	char pattern[200];
} known_failure;

/* What the command line says; the same for all workers. */
static struct {
	char program[PATH_MAX], shim[PATH_MAX], folder[PATH_MAX];
	uint64_t seed;
	double minutes; /* 0: until all is done */
	int jobs;
	bool slice, fresh;
	const char *only_part;
	long only_case, only_trial;
} wish = { .seed = 1, .jobs = 2, .only_case = -1, .only_trial = -1 };

static known_failure *known;
static size_t known_count;

/* ----------------------------------------------------------------------------------- cases */

static uint64_t mix(uint64_t x)
{
	x += 0x9e3779b97f4a7c15u;
	x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
	x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
	return x ^ (x >> 31);
}

double case_random(torture_case *c)
{
	c->state += 0x9e3779b97f4a7c15u;
	return (double)(mix(c->state) >> 11) * 0x1p-53;
}

double case_between(torture_case *c, double low, double high)
{
	return low + (high - low) * case_random(c);
}

long case_pick(torture_case *c, long count)
{
	return (long)(case_random(c) * (double)count);
}

bool case_one_in(torture_case *c, long n)
{
	return case_pick(c, n) == 0;
}

double case_gaussian(torture_case *c)
{
	double u = 1 - case_random(c), v = case_random(c);
	return sqrt(-2 * log(u)) * cos(6.283185307179586 * v);
}

bool case_trial(torture_case *c)
{
	long number = c->trials++;
	if (c->only >= 0 && number != c->only)
		return false;
	if (c->keep)
		printf("trial %ld\n", number);
	return true;
}

const char *case_path(const torture_case *c, const char *name)
{
	static char path[4][2 * CASE_PATH + 2];
	static int turn;
	turn = (turn + 1) % 4;
	snprintf(path[turn], sizeof path[turn], "%s/%s", c->folder, name);
	return path[turn];
}

static void empty_folder(const char *path)
{
	DIR *folder = opendir(path);
	char name[PATH_MAX + 300];
	for (struct dirent *e; folder && (e = readdir(folder));) {
		if (strcmp(e->d_name, ".") == 0 || strcmp(e->d_name, "..") == 0)
			continue;
		snprintf(name, sizeof name, "%s/%s", path, e->d_name);
		if (unlink(name) != 0 && errno == EISDIR) {
			empty_folder(name);
			rmdir(name);
		}
	}
	if (folder)
		closedir(folder);
}

void case_clear_folder(const torture_case *c)
{
	empty_folder(c->folder);
}

bool case_is_known(const char *class_name)
{
	for (size_t i = 0; i < known_count; i++)
		if (fnmatch(known[i].pattern, class_name, 0) == 0)
			return true;
	return false;
}

/* Appends a line to one of the campaign's files, in one write, as workers do it at once. */
static void append(const char *end, const char *line)
{
	char path[PATH_MAX + 100];
	snprintf(path, sizeof path, "%s/%s%llu.%s", wish.folder, wish.slice ? "slice-" : "seed-",
			 (unsigned long long)wish.seed, end);
	FILE *file = fopen(path, "a");
	if (!file || fputs(line, file) < 0 || fclose(file) != 0) {
		fprintf(stderr, "torture: cannot write %s: %s\n", path, strerror(errno));
		exit(74);
	}
}

void case_fail(torture_case *c, const char *class_name, const char *format, ...)
{
	char full[300], sentence[3000], line[4200];
	va_list list;
	va_start(list, format);
	vsnprintf(sentence, sizeof sentence, format, list);
	va_end(list);
	for (char *s = sentence; *s; s++)
		if ((unsigned char)*s < ' ')
			*s = ' ';
	snprintf(full, sizeof full, "%s/%s", c->part, class_name);
	bool expected = case_is_known(full);
	c->failures += !expected;
	c->known += expected;
	snprintf(line, sizeof line, "%s %s: %s\n   again: %s --trial %ld\n",
			 expected ? "KNOWN" : "FAIL", full, sentence, c->again, c->trials - 1);
	append("failures", line);
	if (!expected || c->keep) {
		fputs(line, stdout);
		fflush(stdout);
	}
}

void case_measure(torture_case *c, const char *class_name, double value, double bar,
				  const char *format, ...)
{
	char sentence[1000], line[1400];
	va_list list;
	va_start(list, format);
	vsnprintf(sentence, sizeof sentence, format, list);
	va_end(list);
	bool good = fabs(value) <= bar; /* false for NaN */
	snprintf(line, sizeof line, "%s/%s | %s | %.4g | %.4g%s\n", c->part, class_name, sentence,
			 value, bar, good ? "" : " | missed");
	append("figures", line);
	if (c->keep)
		fputs(line, stdout);
	if (!good)
		case_fail(c, class_name, "%s: %.4g, at most %.4g is right", sentence, value, bar);
}

/* --------------------------------------------------------------------------------- running */

/* Of the processor, which repeats on a busy machine. */
static double seconds_of_children(void)
{
	struct rusage usage;
	getrusage(RUSAGE_CHILDREN, &usage);
	return (double)(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
		   1e-6 * (double)(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

/* What did not fail again when the case was run alone is told by what it left. */
static bool keep_files(const torture_case *c)
{
	char kept[PATH_MAX + 100];
	snprintf(kept, sizeof kept, "%s/failed-%s-%ld", wish.folder, c->part, c->number);
	return rename(c->folder, kept) == 0;
}

static void run_case(case_id id)
{
	const torture_part *part = parts[id.part];
	torture_case c = {
		.program = wish.program,
		.shim = wish.shim,
		.part = part->name,
		.number = id.number,
		.slice = wish.slice,
		.keep = wish.only_case >= 0,
		.only = wish.only_trial,
	};
	c.state = mix(wish.seed);
	for (const char *s = part->name; *s; s++)
		c.state = mix(c.state ^ (unsigned char)*s);
	c.begin = c.state;
	c.state = mix(c.state ^ (uint64_t)id.number);
	int length = snprintf(c.folder, sizeof c.folder, "%s/work-%ld", wish.folder, (long)getpid());
	if (length >= (int)sizeof c.folder)
		exit(73);
	snprintf(c.again, sizeof c.again, "build/tests/torture/torture --seed %llu%s --case %s:%ld",
			 (unsigned long long)wish.seed, wish.slice ? " --slice" : "", part->name, id.number);
	if (mkdir(c.folder, 0777) != 0 && errno != EEXIST) {
		fprintf(stderr, "torture: cannot create %s: %s\n", c.folder, strerror(errno));
		exit(73);
	}
	case_clear_folder(&c);
	double before = seconds_of_children();
	part->run(&c);
	double seconds = seconds_of_children() - before;
	if (wish.only_case >= 0) {
		printf("%ld trials, %ld failed, %ld known; files are in %s\n", c.trials, c.failures,
			   c.known, c.folder);
		exit(c.failures > 0);
	}
	if (c.failures == 0 || !keep_files(&c)) {
		case_clear_folder(&c);
		rmdir(c.folder);
	}
	char line[200];
	snprintf(line, sizeof line, "%s %ld %ld %ld %ld %.2f\n", part->name, id.number, c.trials,
			 c.failures, c.known, seconds);
	append("done", line);
}

/* Workers take the next case from a counter that they share. */
static void run_all(const case_id *list, long count)
{
	atomic_long *next =
		mmap(NULL, sizeof *next, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
	if (next == MAP_FAILED)
		exit(71);
	time_t end = time(NULL) + (time_t)(wish.minutes * 60);
	fflush(stdout);
	for (int j = 0; j < wish.jobs; j++) {
		if (fork() != 0)
			continue;
		for (;;) {
			long i = atomic_fetch_add(next, 1);
			if (i >= count || (wish.minutes > 0 && time(NULL) >= end))
				break;
			run_case(list[i]);
		}
		fflush(stdout);
		_exit(0);
	}
	int status, bad = 0;
	while (wait(&status) > 0)
		bad |= !WIFEXITED(status) || WEXITSTATUS(status) != 0;
	if (bad) {
		fprintf(stderr, "torture: a worker ended before its work\n");
		exit(70);
	}
}

/* --------------------------------------------------------------------------- what is done */

typedef struct part_sum {
	long cases, trials, failures, known;
	double seconds;
	long *done, done_count;
} part_sum;

static void read_done(part_sum sum[PART_COUNT])
{
	char path[PATH_MAX + 100], name[64];
	snprintf(path, sizeof path, "%s/%s%llu.done", wish.folder, wish.slice ? "slice-" : "seed-",
			 (unsigned long long)wish.seed);
	memset(sum, 0, sizeof *sum * (size_t)PART_COUNT);
	FILE *file = fopen(path, "r");
	long number, trials, failures, known_failures;
	double seconds;
	while (file && fscanf(file, "%63s %ld %ld %ld %ld %lf", name, &number, &trials, &failures,
						  &known_failures, &seconds) == 6) {
		for (int p = 0; p < PART_COUNT; p++) {
			if (strcmp(parts[p]->name, name) != 0)
				continue;
			part_sum *s = &sum[p];
			s->done = realloc(s->done, sizeof *s->done * (size_t)(s->done_count + 1));
			if (!s->done)
				exit(71);
			s->done[s->done_count++] = number;
			s->cases++;
			s->trials += trials;
			s->failures += failures;
			s->known += known_failures;
			s->seconds += seconds;
		}
	}
	if (file)
		fclose(file);
}

static bool is_done(const part_sum *sum, long number)
{
	for (long i = 0; i < sum->done_count; i++)
		if (sum->done[i] == number)
			return true;
	return false;
}

/* Cases of all parts that are to be done, shuffled, so that a run that is stopped has seen some of
 * all. */
static case_id *list_cases(const part_sum *sum, long *count)
{
	long total = 0, each[PART_COUNT];
	for (int p = 0; p < PART_COUNT; p++) {
		bool wanted = !wish.only_part || strcmp(wish.only_part, parts[p]->name) == 0;
		each[p] = wanted ? parts[p]->count(wish.slice) : 0;
		total += each[p];
	}
	case_id *list = malloc(sizeof *list * (size_t)(total + 1));
	if (!list)
		exit(71);
	*count = 0;
	for (int p = 0; p < PART_COUNT; p++)
		for (long i = 0; i < each[p]; i++)
			if (!is_done(&sum[p], i))
				list[(*count)++] = (case_id){ p, i };
	uint64_t state = wish.seed;
	for (long i = *count; i > 1; i--) {
		state = mix(state);
		long k = (long)(state % (uint64_t)i);
		case_id kept = list[i - 1];
		list[i - 1] = list[k];
		list[k] = kept;
	}
	return list;
}

/* The table of the campaign, and the closing line. */
static bool print_sums(const part_sum *sum)
{
	long trials = 0, failures = 0, known_failures = 0;
	bool whole = true;
	printf("%-10s %8s %8s %8s %8s %8s  %s\n", "part", "cases", "of", "trials", "failed", "known",
		   "what");
	for (int p = 0; p < PART_COUNT; p++) {
		long of = parts[p]->count(wish.slice);
		printf("%-10s %8ld %8ld %8ld %8ld %8ld  %s\n", parts[p]->name, sum[p].cases, of,
			   sum[p].trials, sum[p].failures, sum[p].known, parts[p]->meaning);
		trials += sum[p].trials;
		failures += sum[p].failures;
		known_failures += sum[p].known;
		whole = whole && sum[p].cases >= of;
	}
	printf("seed %llu: %s\n", (unsigned long long)wish.seed,
		   whole ? "all cases are done" : "run it again to go on");
	printf("%ld passed, %ld failed", trials - failures - known_failures, failures);
	printf(known_failures ? ", %ld known\n" : "\n", known_failures);
	return failures == 0 && trials > 0;
}

/* ------------------------------------------------------------------------------- beginning */

/* A line a pattern, up to two blanks in a row; what follows says why. # begins a comment. */
static void read_known(const char *path)
{
	char line[1000];
	FILE *file = fopen(path, "r");
	if (!file) {
		fprintf(stderr, "torture: cannot open %s\n", path);
		exit(66);
	}
	while (fgets(line, sizeof line, file)) {
		char *end = strstr(line, "  ");
		if (line[0] == '#' || line[0] == '\n' || !end)
			continue;
		known = realloc(known, sizeof *known * (known_count + 1));
		if (!known)
			exit(71);
		snprintf(known[known_count++].pattern, sizeof known->pattern, "%.*s", (int)(end - line),
				 line);
	}
	fclose(file);
}

static void find(char *place, const char *path)
{
	if (!realpath(path, place)) {
		fprintf(stderr, "torture: %s is not there\n", path);
		exit(66);
	}
}

static void parse_case(const char *text)
{
	static char name[64];
	const char *colon = strchr(text, ':');
	snprintf(name, sizeof name, "%.*s", (int)(colon ? colon - text : (long)strlen(text)), text);
	wish.only_part = name;
	if (colon)
		wish.only_case = atol(colon + 1);
}

static void usage(void)
{
	puts("usage: torture [--seed N] [--minutes M] [--jobs J] [--slice] [--fresh]\n"
		 "               [--case PART[:NUMBER]] [--trial N] [--program FILE] [--folder DIR]\n"
		 "               [--known FILE]\n"
		 "Run from the root of the source tree.");
	exit(2);
}

static const char *parse(int argc, char **argv)
{
	static const struct option options[] = {
		{ "seed", 1, NULL, 's' },  { "minutes", 1, NULL, 'm' }, { "jobs", 1, NULL, 'j' },
		{ "slice", 0, NULL, 'l' }, { "fresh", 0, NULL, 'f' },   { "case", 1, NULL, 'c' },
		{ "trial", 1, NULL, 't' }, { "program", 1, NULL, 'p' }, { "folder", 1, NULL, 'd' },
		{ "known", 1, NULL, 'k' }, { NULL, 0, NULL, 0 },
	};
	const char *program = "build/glowworm", *folder = "build/torture";
	const char *list = "tests/torture/known_failures.txt";
	char shim[PATH_MAX];
	for (int o; (o = getopt_long(argc, argv, "", options, NULL)) != -1;) {
		switch (o) {
		case 's':
			wish.seed = strtoull(optarg, NULL, 10);
			break;
		case 'm':
			wish.minutes = atof(optarg);
			break;
		case 'j':
			wish.jobs = atoi(optarg);
			break;
		case 'l':
			wish.slice = true;
			break;
		case 'f':
			wish.fresh = true;
			break;
		case 'c':
			parse_case(optarg);
			break;
		case 't':
			wish.only_trial = atol(optarg);
			break;
		case 'p':
			program = optarg;
			break;
		case 'd':
			folder = optarg;
			break;
		case 'k':
			list = optarg;
			break;
		default:
			usage();
		}
	}
	if (optind < argc || wish.jobs < 1)
		usage();
	snprintf(shim, sizeof shim, "%s", argv[0]);
	char *slash = strrchr(shim, '/');
	snprintf(slash ? slash + 1 : shim, 20, "fault_shim.so");
	find(wish.program, program);
	find(wish.shim, shim);
	mkdir(folder, 0777);
	find(wish.folder, folder);
	return list;
}

static void forget(void)
{
	static const char *const end[] = { "done", "figures", "failures" };
	char path[PATH_MAX + 100];
	for (int i = 0; i < 3; i++) {
		snprintf(path, sizeof path, "%s/%s%llu.%s", wish.folder, wish.slice ? "slice-" : "seed-",
				 (unsigned long long)wish.seed, end[i]);
		unlink(path);
	}
}

int main(int argc, char **argv)
{
	read_known(parse(argc, argv));
	if (wish.only_case >= 0) {
		for (int p = 0; p < PART_COUNT; p++)
			if (strcmp(parts[p]->name, wish.only_part) == 0)
				run_case((case_id){ p, wish.only_case });
		usage();
	}
	if (wish.fresh || wish.slice)
		forget();
	part_sum sum[PART_COUNT];
	long count;
	read_done(sum);
	case_id *list = list_cases(sum, &count);
	printf("torture: seed %llu, %ld cases to do, %d at a time\n", (unsigned long long)wish.seed,
		   count, wish.jobs);
	run_all(list, count);
	free(list);
	read_done(sum);
	return print_sums(sum) ? 0 : 1;
}
