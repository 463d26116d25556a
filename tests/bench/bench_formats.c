/*
 * bench_formats.c - how fast files are read, beside the loaders of PCL and CloudCompare.
 *
 *   bench_formats [POINTS]             points of the clouds that it makes (500000)
 *   bench_formats FOLDER POINTS FILE...
 *   bench_formats --writing POINTS     how fast they are written
 *
 * In FOLDER (a temporary one unless given) it makes a cloud in every format that can be written,
 * and PLY, PTS, OBJ and PCD in their other encodings; these files and FILEs are read, and a table
 * comes out as Markdown. Processor seconds are counted, not those on the clock, so that other
 * programs on the machine matter little; only reading with two threads is measured by the clock.
 * The best of three counts, by the clock of ten. CloudCompare is a process of its own, of whose
 * time that for a cloud of three points is taken off; set CLOUDCOMPARE to nothing to leave it out.
 */
#include "table/format_table.h"
#include "meshes/mesh.h"
#include "files/number_text.h"
#include "files/output_file.h"
#include "pcl_loaders.h"

#include <fcntl.h>
#include <math.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#define RUNS 3
#define CLOCK_RUNS 10 /* by the clock, of which one may find the machine idle */
#define PATH 512

extern char **environ;

static double now(clockid_t clock)
{
	struct timespec t;
	clock_gettime(clock, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* --------------------------------------------------------------------------------- the cloud */

static uint64_t state = 1;

/* In [0, 1), in steps of 2^-20. */
static double next(void)
{
	state = state * 6364136223846793005u + 1442695040888963407u;
	return (double)(state >> 44) * 0x1p-20;
}

/* A rough sphere, in millimetres. Coordinates are float32, as PCL and CloudCompare keep them. */
static gw_status make_cloud(size_t count, scan *cloud, gw_error *error)
{
	static const struct {
		const char *name;
		scan_type type;
	} columns[] = {
		{ "x", SCAN_FLOAT32 },         { "y", SCAN_FLOAT32 },   { "z", SCAN_FLOAT32 },
		{ "nx", SCAN_FLOAT32 },        { "ny", SCAN_FLOAT32 },  { "nz", SCAN_FLOAT32 },
		{ "red", SCAN_UINT8 },         { "green", SCAN_UINT8 }, { "blue", SCAN_UINT8 },
		{ "intensity", SCAN_FLOAT32 },
	};
	*cloud = (scan){ .count = count, .up = 'z' };
	for (size_t c = 0; c < sizeof columns / sizeof *columns; c++)
		if (!scan_add_column(cloud, columns[c].name, columns[c].type, error))
			return GW_ERROR_MEMORY;
	for (size_t i = 0; i < count; i++) {
		double z = 2.0 * next() - 1.0, a = 6.28318530718 * next(), r = sqrt(1.0 - z * z);
		const double n[3] = { r * cos(a), r * sin(a), z };
		for (size_t k = 0; k < 3; k++) {
			double at = round(1e4 * n[k] * (1.0 + 0.01 * next())) / 1e3;
			scan_store(&cloud->column[k], i, at);
			scan_store(&cloud->column[3 + k], i, n[k]);
			scan_store(&cloud->column[6 + k], i, floor(255.0 * next()));
		}
		scan_store(&cloud->column[9], i, floor(4096.0 * next()));
	}
	return GW_OK;
}

/* ------------------------------------------------------------------------------ other encodings */

typedef enum text_kind { TEXT_PLY, TEXT_PTS, TEXT_OBJ } text_kind;

static void print_head(FILE *file, const scan *cloud, text_kind kind)
{
	static const char *const types[SCAN_TYPE_COUNT] = {
		[SCAN_FLOAT32] = "float", [SCAN_UINT8] = "uchar"
	};
	if (kind == TEXT_PTS)
		fprintf(file, "%zu\n", cloud->count);
	if (kind != TEXT_PLY)
		return;
	fprintf(file, "ply\nformat ascii 1.0\nelement vertex %zu\n", cloud->count);
	for (size_t c = 0; c < cloud->column_count; c++)
		fprintf(file, "property %s %s\n", types[cloud->column[c].type], cloud->column[c].name);
	fprintf(file, "end_header\n");
}

/* Some columns of one point, as far as the order goes. */
static void print_columns(FILE *file, const scan *cloud, size_t i, const char *order)
{
	for (; *order; order++) {
		char text[NUMBER_TEXT];
		number_print_float(text, (float)scan_value(&cloud->column[*order - '0'], i));
		fprintf(file, "%s%c", text, order[1] ? ' ' : '\n');
	}
}

static bool write_text(const scan *cloud, const char *path, text_kind kind)
{
	static const char *const order[] = { "0123456789", "0129678", "012" };
	FILE *file = fopen(path, "w");
	if (!file)
		return false;
	print_head(file, cloud, kind);
	for (size_t i = 0; i < cloud->count; i++) {
		if (kind == TEXT_OBJ)
			fputs("v ", file);
		print_columns(file, cloud, i, order[kind]);
	}
	bool good = !ferror(file);
	return fclose(file) == 0 && good;
}

static gw_status write_as(const format *f, const scan *cloud, const char *path, gw_error *error)
{
	output_file *out;
	gw_status status = output_file_create(&out, path, true, error);
	if (status == GW_OK)
		status = f->write(out, cloud, error);
	if (status == GW_OK)
		status = output_file_commit(&out, error);
	output_file_abandon(&out);
	return status;
}

/* ----------------------------------------------------------------------------------- loaders */

typedef struct result {
	double seconds;
	size_t points; /* 0: it cannot */
} result;

/* Ours: with one thread by the processor's time, with more by the clock. */
static result load_here(const char *path, uint32_t threads, const format **found)
{
	format_options options = { .threads = threads };
	result best = { .seconds = INFINITY };
	clockid_t clock = threads == 1 ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_MONOTONIC;
	for (int i = 0; i < (threads == 1 ? RUNS : CLOCK_RUNS); i++) {
		scan cloud;
		gw_error error = { 0 };
		double start = now(clock);
		if (format_read_with(path, &options, &cloud, found, &error) != GW_OK) {
			fprintf(stderr, "bench_formats: %s\n", error.text);
			return (result){ 0 };
		}
		best.seconds = fmin(best.seconds, now(clock) - start);
		best.points = cloud.count;
		scan_clear(&cloud);
	}
	return best;
}

static result load_by_pcl(const char *path)
{
	result best = { .seconds = INFINITY };
	for (int i = 0; i < RUNS; i++) {
		double start = now(CLOCK_PROCESS_CPUTIME_ID);
		best.points = pcl_load(path);
		best.seconds = fmin(best.seconds, now(CLOCK_PROCESS_CPUTIME_ID) - start);
	}
	return best;
}

/* Processor seconds of a whole process, or infinity when it fails. */
static double run_cloudcompare(const char *program, const char *path)
{
	char *const arguments[] = { (char *)(uintptr_t)program, "-SILENT", "-AUTO_SAVE", "OFF", "-O",
								(char *)(uintptr_t)path,    NULL };
	posix_spawn_file_actions_t actions;
	struct rusage usage;
	pid_t child;
	int status;
	posix_spawn_file_actions_init(&actions);
	posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
	posix_spawn_file_actions_addopen(&actions, 2, "/dev/null", O_WRONLY, 0);
	int failed = posix_spawnp(&child, program, &actions, NULL, arguments, environ);
	posix_spawn_file_actions_destroy(&actions);
	if (failed || wait4(child, &status, 0, &usage) != child || !WIFEXITED(status) ||
		WEXITSTATUS(status) != 0)
		return INFINITY;
	return (double)(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
		   1e-6 * (double)(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}

static double best_of_cloudcompare(const char *program, const char *path)
{
	double best = INFINITY;
	for (int i = 0; i < RUNS; i++)
		best = fmin(best, run_cloudcompare(program, path));
	return best;
}

/* The formats that Debian's CloudCompare loads. It goes by the extension. */
static result load_by_cloudcompare(const char *folder, const char *path, size_t points)
{
	static const char *const known[] = { "ply", "xyz", "csv", "pts", "ptx", "obj" };
	const char *program = getenv("CLOUDCOMPARE") ? getenv("CLOUDCOMPARE") : "CloudCompare";
	const char *dot = strrchr(path, '.');
	bool knows = false;
	for (size_t i = 0; dot && i < sizeof known / sizeof *known; i++)
		knows = knows || strcmp(dot + 1, known[i]) == 0;
	char small[PATH];
	snprintf(small, sizeof small, "%s/small.xyz", folder);
	FILE *file = knows && *program ? fopen(small, "w") : NULL;
	if (!file)
		return (result){ 0 };
	fputs("0 0 0\n1 0 0\n0 1 0\n", file);
	fclose(file);
	double start = best_of_cloudcompare(program, small),
		   whole = best_of_cloudcompare(program, path);
	unlink(small);
	return isfinite(start) && isfinite(whole) ? (result){ whole - start, points } : (result){ 0 };
}

/* ------------------------------------------------------------------------------------- table */

static void print_speed(result r, double megabytes)
{
	if (r.points)
		printf(" %.2f / %.0f |", 1e-6 * (double)r.points / r.seconds, megabytes / r.seconds);
	else
		printf(" - |");
}

/* A row of the table. encoding: "" or what tells it from others of the format */
static void measure(const char *folder, const char *path, const char *encoding)
{
	struct stat info;
	const format *found = NULL;
	result one = load_here(path, 1, &found);
	if (!one.points || stat(path, &info) != 0)
		return;
	double megabytes = 1e-6 * (double)info.st_size;
	printf("| %s%s%s | %.2f | %.0f |", found->name, *encoding ? ", " : "", encoding,
		   1e-6 * (double)one.points, megabytes);
	print_speed(one, megabytes);
	print_speed(load_here(path, 2, &found), megabytes);
	print_speed(load_by_pcl(path), megabytes);
	print_speed(load_by_cloudcompare(folder, path, one.points), megabytes);
	printf("\n");
	fflush(stdout);
}

static const char *in_folder(char path[PATH], const char *folder, const char *name)
{
	snprintf(path, PATH, "%s/%s", folder, name);
	return path;
}

static void measure_texts(const scan *cloud, const char *folder)
{
	static const struct {
		text_kind kind;
		const char *name, *encoding;
	} texts[] = { { TEXT_PLY, "text.ply", "text" },
				  { TEXT_PTS, "text.pts", "" },
				  { TEXT_OBJ, "text.obj", "vertices" } };
	char path[PATH];
	for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
		if (write_text(cloud, in_folder(path, folder, texts[i].name), texts[i].kind))
			measure(folder, path, texts[i].encoding);
		unlink(path);
	}
}

/* PCL writes the encodings of PCD that we only read. binary: a file of the third */
static void measure_pcd(const char *folder, const char *binary)
{
	char path[PATH];
	if (pcl_save_text(binary, in_folder(path, folder, "text.pcd")))
		measure(folder, path, "text");
	if (pcl_save_compressed(binary, path))
		measure(folder, path, "compressed");
	unlink(path);
}

static gw_status measure_all(size_t count, const char *folder, gw_error *error)
{
	scan cloud;
	gw_status status = make_cloud(count, &cloud, error);
	for (size_t f = 0; formats[f] && status == GW_OK; f++) {
		char path[PATH], name[64];
		if (!formats[f]->write || !formats[f]->read)
			continue;
		snprintf(name, sizeof name, "cloud.%s", formats[f]->name);
		status = write_as(formats[f], &cloud, in_folder(path, folder, name), error);
		bool encodings = !strcmp(formats[f]->name, "ply") || !strcmp(formats[f]->name, "pcd");
		if (status == GW_OK)
			measure(folder, path, encodings ? "binary" : "");
		if (status == GW_OK && strcmp(formats[f]->name, "pcd") == 0)
			measure_pcd(folder, path);
		unlink(path);
	}
	if (status == GW_OK)
		measure_texts(&cloud, folder);
	scan_clear(&cloud);
	return status;
}

/* ------------------------------------------------------------------------------------ writing */

/* The best of some times, by the processor's and by the wall's clock: infinite when it fails. */
static double best_of_writing(const format *f, const scan *cloud, const char *path, clockid_t clock)
{
	double best = INFINITY;
	gw_error error = { 0 };
	for (int i = 0; i < RUNS; i++) {
		double start = now(clock);
		if (write_as(f, cloud, path, &error) != GW_OK) {
			fprintf(stderr, "bench_formats: %s\n", error.text);
			return INFINITY;
		}
		best = fmin(best, now(clock) - start);
	}
	return best;
}

static void measure_writing(const format *f, const scan *cloud, const char *folder)
{
	char path[PATH], name[64];
	struct stat info;
	const format *found = NULL;
	snprintf(name, sizeof name, "cloud.%s", f->name);
	in_folder(path, folder, name);
	double seconds = best_of_writing(f, cloud, path, CLOCK_PROCESS_CPUTIME_ID);
	double wall = best_of_writing(f, cloud, path, CLOCK_MONOTONIC);
	if (isfinite(seconds) && isfinite(wall) && stat(path, &info) == 0) {
		double megabytes = 1e-6 * (double)info.st_size;
		printf("| %s | %.0f |", f->name, megabytes);
		print_speed((result){ seconds, cloud->count }, megabytes);
		print_speed((result){ wall, cloud->count }, megabytes);
		print_speed(load_here(path, 1, &found), megabytes);
		printf("\n");
	}
	unlink(path);
}

static int table_of_writing(size_t points)
{
	char made[] = "/tmp/bench_formats.XXXXXX";
	const char *folder = mkdtemp(made);
	gw_error error = { 0 };
	scan cloud;
	if (!folder || make_cloud(points, &cloud, &error) != GW_OK)
		return 1;
	printf("| format | MB | written, by the processor | written, by the clock | read, one thread "
		   "|\n|---|---|---|---|---|\n");
	for (size_t f = 0; formats[f]; f++)
		if (formats[f]->write && formats[f]->read)
			measure_writing(formats[f], &cloud, folder);
	scan_clear(&cloud);
	rmdir(folder);
	return 0;
}

int main(int count, char **arguments)
{
	if (count > 2 && strcmp(arguments[1], "--writing") == 0)
		return table_of_writing(strtoul(arguments[2], NULL, 10));
	char made[] = "/tmp/bench_formats.XXXXXX";
	gw_error error = { 0 };
	size_t points = strtoul(count > 2   ? arguments[2]
							: count > 1 ? arguments[1]
										: "500000",
							NULL, 10);
	const char *folder = count > 2 ? arguments[1] : mkdtemp(made);
	if (!folder || points == 0)
		return 2;
	printf("| format | million points | MB | one thread | two threads, by the clock | PCL | "
		   "CloudCompare |\n|---|---|---|---|---|---|---|\n");
	gw_status status = measure_all(points, folder, &error);
	for (int i = 3; i < count; i++)
		measure(folder, arguments[i], "");
	if (folder == made)
		rmdir(folder);
	if (status != GW_OK)
		fprintf(stderr, "bench_formats: %s\n", error.text);
	return status != GW_OK;
}
