/* Disks that fail: each call that reads or writes a file fails in turn, and inputs are cut short
 * while they are read. Whatever ends without an error must have made every call. */
#include "program/exit_code.h"
#include "table/format_table.h"
#include "meshes/mesh.h"
#include "comparison/tradeoff_runs.h"
#include "files/output_file.h"
#include "base/parallel.h"
#include "seed_files.h"
#include "program/signals.h"
#include "verbs/health.h"
#include "options/options.h"
#include "verbs/verbs.h"
#include "meshes/mesh_reader.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdio_ext.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

#define LARGE ((size_t)3 << 20)

/* ------------------------------------------------------------------------------- faults */

typedef enum call {
	OPEN_IT,
	READ_IT,
	WRITE_IT,
	SYNC_FILE,
	SYNC_FOLDER,
	CLOSE_IT,
	RENAME_IT,
	CLOSE_STREAM /* of the C library, with text that is made in memory */
} call;

static char folder[64], input[96], output[96];

/* Which call shall fail, and how. */
static struct fault {
	call call;
	int at; /* from 1; 0: none */
	int reason;
	int count; /* calls of this kind so far */
	bool hit;
} fault;

static long blocks_left = -1;  /* on the disk; -1: as it is */
static bool cut_short;         /* reads end before the file does */
static bool no_memory_to_copy; /* for the next file that is opened */
static bool cut_when_mapped;   /* the input is emptied after it was opened, before it is read */
static size_t write_most;      /* bytes that one call writes; 0: all of them */
static bool loses_ends;        /* the second half of what is written is zeros */
static bool no_flags;          /* the file system cannot rename without replacing */
static uid_t other_user;       /* whom files seem to belong to others than; 0: nobody */
static bool not_permitted;     /* processes that live belong to somebody else */
static enum { NO_CLEANER, CLEANER_BEFORE, CLEANER_AT_IT } cleaner; /* at the next lock */

static bool fails(call c)
{
	if (c != fault.call || fault.at == 0 || ++fault.count != fault.at)
		return false;
	fault.hit = true;
	errno = fault.reason;
	return true;
}

uint64_t __real_gw_available_memory(void);
uint64_t __wrap_gw_available_memory(void);
int __real_statvfs(const char *path, struct statvfs *disk);
int __wrap_statvfs(const char *path, struct statvfs *disk);
int __real_open(const char *path, int flags, mode_t mode);
ssize_t __real_read(int descriptor, void *bytes, size_t length);
ssize_t __real_pread(int descriptor, void *bytes, size_t length, off_t at);
ssize_t __real_write(int descriptor, const void *bytes, size_t length);
int __real_fsync(int descriptor);
int __real_close(int descriptor);
int __real_fclose(FILE *stream);
int __real_flock(int descriptor, int operation);
int __real_kill(pid_t process, int number);
uid_t __real_geteuid(void);
int __real_rename(const char *from, const char *to);
int __real_renameat2(int a, const char *from, int b, const char *to, unsigned flags);
int __wrap_open(const char *path, int flags, mode_t mode);
ssize_t __wrap_read(int descriptor, void *bytes, size_t length);
ssize_t __wrap_pread(int descriptor, void *bytes, size_t length, off_t at);
ssize_t __wrap_write(int descriptor, const void *bytes, size_t length);
int __wrap_fsync(int descriptor);
int __wrap_close(int descriptor);
int __wrap_fclose(FILE *stream);
int __wrap_flock(int descriptor, int operation);
int __wrap_kill(pid_t process, int number);
uid_t __wrap_geteuid(void);
int __wrap_rename(const char *from, const char *to);
int __wrap_renameat2(int a, const char *from, int b, const char *to, unsigned flags);
void __real_tradeoff_plan(const gw_bake_options *base, tradeoff *plan);
void __wrap_tradeoff_plan(const gw_bake_options *base, tradeoff *plan);

/* What is written of three settings is lost as is that of all, which take seconds. */
void __wrap_tradeoff_plan(const gw_bake_options *base, tradeoff *plan)
{
	__real_tradeoff_plan(base, plan);
	plan->count = 3;
}

uint64_t __wrap_gw_available_memory(void)
{
	bool none = no_memory_to_copy;
	no_memory_to_copy = false;
	return none ? 1 : __real_gw_available_memory();
}

int __wrap_statvfs(const char *path, struct statvfs *disk)
{
	int status = __real_statvfs(path, disk);
	if (status == 0 && blocks_left >= 0) {
		disk->f_bfree = disk->f_bavail = (fsblkcnt_t)blocks_left;
		disk->f_frsize = 4096;
	}
	return status;
}

int __wrap_open(const char *path, int flags, mode_t mode)
{
	return fails(OPEN_IT) ? -1 : __real_open(path, flags, mode);
}

ssize_t __wrap_read(int descriptor, void *bytes, size_t length)
{
	return fails(READ_IT) ? -1 : __real_read(descriptor, bytes, length);
}

ssize_t __wrap_pread(int descriptor, void *bytes, size_t length, off_t at)
{
	if (cut_short)
		return 0;
	return fails(READ_IT) ? -1 : __real_pread(descriptor, bytes, length, at);
}

ssize_t __wrap_write(int descriptor, const void *bytes, size_t length)
{
	if (fails(WRITE_IT))
		return -1;
	if (loses_ends) {
		char *bad = calloc(1, length);
		memcpy(bad, bytes, length / 2);
		ssize_t written = __real_write(descriptor, bad, length);
		free(bad);
		return written;
	}
	size_t most = write_most > 0 && write_most < length ? write_most : length;
	return __real_write(descriptor, bytes, most);
}

int __wrap_fsync(int descriptor)
{
	struct stat info;
	bool is_folder = fstat(descriptor, &info) == 0 && S_ISDIR(info.st_mode);
	return fails(is_folder ? SYNC_FOLDER : SYNC_FILE) ? -1 : __real_fsync(descriptor);
}

/* Only files that were written: what fails to close after reading was read. */
int __wrap_close(int descriptor)
{
	struct stat info;
	bool written = fstat(descriptor, &info) == 0 && S_ISREG(info.st_mode) &&
				   (fcntl(descriptor, F_GETFL) & O_ACCMODE) != O_RDONLY;
	bool failed = written && fails(CLOSE_IT);
	if (cut_when_mapped) {
		cut_when_mapped = false;
		assert_int_equal(truncate(input, 0), 0);
	}
	int status = __real_close(descriptor);
	errno = failed ? fault.reason : errno;
	return failed ? -1 : status;
}

int __wrap_rename(const char *from, const char *to)
{
	return fails(RENAME_IT) ? -1 : __real_rename(from, to);
}

int __wrap_renameat2(int a, const char *from, int b, const char *to, unsigned flags)
{
	if (no_flags && flags != 0) {
		errno = EINVAL;
		return -1;
	}
	return fails(RENAME_IT) ? -1 : __real_renameat2(a, from, b, to, flags);
}

/* Only what was written has anything to lose. */
int __wrap_fclose(FILE *stream)
{
	bool failed = __fwritable(stream) && fails(CLOSE_STREAM);
	int status = __real_fclose(stream);
	errno = failed ? fault.reason : errno;
	return failed ? EOF : status;
}

int __wrap_kill(pid_t process, int number)
{
	int status = __real_kill(process, number);
	if (status == 0 && number == 0 && not_permitted) {
		errno = EPERM;
		return -1;
	}
	return status;
}

uid_t __wrap_geteuid(void)
{
	return __real_geteuid() + other_user;
}

/* ------------------------------------------------------------------------------- folder */

static int make_folder(void **state)
{
	(void)state;
	strcpy(folder, "/tmp/glowworm-test-XXXXXX");
	if (!mkdtemp(folder))
		return -1;
	snprintf(input, sizeof input, "%s/in.xyz", folder);
	snprintf(output, sizeof output, "%s/out.ply", folder);
	return 0;
}

/* Empties the folder but for inputs; the number of names that were there beside them. */
static int others_in_folder(void)
{
	int count = 0;
	DIR *open_folder = opendir(folder);
	assert_non_null(open_folder);
	for (struct dirent *entry; (entry = readdir(open_folder));)
		if (entry->d_type == DT_REG && strncmp(entry->d_name, "in.", 3) != 0) {
			count++;
			unlinkat(dirfd(open_folder), entry->d_name, 0);
		}
	closedir(open_folder);
	return count;
}

static const char *in_folder(const char *name)
{
	static char path[4][128];
	static int next;
	next = (next + 1) % 4;
	snprintf(path[next], sizeof path[next], "%s/%s", folder, name);
	return path[next];
}

static int remove_folder(void **state)
{
	static const char *const inputs[] = { "in.xyz", "in.csv", "in.obj",
										  "in.ply", "in.ies", "in.scene.json" };
	(void)state;
	others_in_folder();
	for (size_t i = 0; i < sizeof inputs / sizeof *inputs; i++)
		unlink(in_folder(inputs[i]));
	return rmdir(folder);
}

static void put_input(size_t rows)
{
	FILE *file = fopen(input, "w");
	assert_non_null(file);
	for (size_t i = 0; i < rows; i++)
		fprintf(file, "%zu 2 3\n", i);
	assert_int_equal(fclose(file), 0);
}

/* -------------------------------------------------------------------------------- outputs */

static gw_status write_one(bool force, gw_error *error)
{
	output_file *out;
	GW_TRY(output_file_create(&out, output, force, error));
	output_file_write(out, "0123456789", 10, NULL);
	return output_file_commit(&out, error);
}

static void expect_failure(call c, int reason, bool force)
{
	gw_error error = { 0 };
	fault = (struct fault){ .call = c, .at = 1, .reason = reason };
	gw_status status = write_one(force, &error);
	bool hit = fault.hit;
	fault.at = 0;
	assert_true(hit);
	assert_int_equal(exit_code_of(status, 0), EXIT_CODE_IO);
	assert_non_null(strstr(error.text, "out.ply"));
	assert_non_null(strstr(error.text, strerror(reason)));
}

/* Each of the calls without which a file might be lost is made, and its failure is one. */
static void outputs_on_a_failing_disk(void **state)
{
	(void)state;
	static const call calls[] = { WRITE_IT, SYNC_FILE, CLOSE_IT, RENAME_IT };
	for (size_t i = 0; i < sizeof calls / sizeof *calls; i++) {
		expect_failure(calls[i], EIO, false);
		assert_int_equal(others_in_folder(), 0);
		/* What is to be replaced stays. */
		assert_int_equal(write_one(false, NULL), GW_OK);
		expect_failure(calls[i], ENOSPC, true);
		assert_int_equal(access(output, F_OK), 0);
		assert_int_equal(others_in_folder(), 1);
	}
}

/* The file is there, whole, but nobody knows for how long. */
static void outputs_in_a_failing_folder(void **state)
{
	(void)state;
	struct stat info;
	expect_failure(SYNC_FOLDER, EIO, false);
	assert_int_equal(stat(output, &info), 0);
	assert_int_equal(info.st_size, 10);
	assert_int_equal(others_in_folder(), 1);
	/* Not every file system has it, and not every
	 * folder may be read, which is the second file that is opened. */
	static const struct fault excused[] = { { SYNC_FOLDER, 1, EINVAL, 0, false },
											{ SYNC_FOLDER, 1, ENOTSUP, 0, false },
											{ OPEN_IT, 2, EACCES, 0, false } };
	for (size_t i = 0; i < sizeof excused / sizeof *excused; i++) {
		fault = excused[i];
		assert_int_equal(write_one(false, NULL), GW_OK);
		assert_true(fault.hit);
		assert_int_equal(others_in_folder(), 1);
	}
}

static void outputs_on_a_small_disk(void **state)
{
	(void)state;
	gw_error error = { 0 };
	blocks_left = 10;
	assert_int_equal(output_file_check_room(output, 40960, &error), GW_OK);
	assert_int_equal(output_file_check_room(output, 40961, &error), FILE_ERROR_IO);
	assert_non_null(strstr(error.text, "at least 40961 bytes"));
	assert_int_equal(output_file_check_room("-", 40961, &error), GW_OK);
	assert_int_equal(output_file_check_room("/dev/null", 40961, &error), GW_OK);
	blocks_left = -1;
	assert_int_equal(output_file_check_room(output, 40961, &error), GW_OK);
}

/* Some systems write less than they are asked to, and say so. */
static void outputs_written_in_pieces(void **state)
{
	(void)state;
	char text[11] = "";
	for (write_most = 1; write_most < 12; write_most++) {
		assert_int_equal(write_one(true, NULL), GW_OK);
		FILE *file = fopen(output, "r");
		assert_non_null(file);
		size_t length = fread(text, 1, 11, file);
		fclose(file);
		assert_int_equal(length, 10);
		assert_memory_equal(text, "0123456789", 10);
	}
	write_most = 0;
	assert_int_equal(others_in_folder(), 1);
}

/* Where nothing can be renamed without replacing, what is there still stays. */
static void outputs_on_a_simple_file_system(void **state)
{
	(void)state;
	output_file *out;
	gw_error error = { 0 };
	no_flags = true;
	assert_int_equal(write_one(false, NULL), GW_OK);
	assert_int_equal(others_in_folder(), 1);
	assert_int_equal(output_file_create(&out, output, false, NULL), GW_OK);
	FILE *quicker = fopen(output, "w");
	assert_non_null(quicker);
	fclose(quicker);
	assert_int_equal(output_file_commit(&out, &error), FILE_ERROR_CREATE);
	assert_non_null(strstr(error.text, "exists already"));
	assert_int_equal(others_in_folder(), 1);
	expect_failure(RENAME_IT, EIO, false);
	assert_int_equal(others_in_folder(), 0);
	no_flags = false;
}

/* A name of ours with a process in it. */
static const char *part_of(long process, unsigned serial)
{
	static char path[128];
	snprintf(path, sizeof path, "%s/.glowworm-%ld-%u.part", folder, process, serial);
	return path;
}

static bool put_part(long process, unsigned serial)
{
	FILE *file = fopen(part_of(process, serial), "w");
	return file && fclose(file) == 0;
}

static bool there(const char *path)
{
	return access(path, F_OK) == 0;
}

/* Another folder comes between, so that this one is searched. */
static void write_in_folder(void)
{
	output_file *elsewhere;
	char path[64];
	snprintf(path, sizeof path, "/tmp/glowworm-elsewhere-%ld", (long)getpid());
	assert_int_equal(output_file_create(&elsewhere, path, false, NULL), GW_OK);
	output_file_abandon(&elsewhere);
	assert_int_equal(write_one(true, NULL), GW_OK);
}

/* Temporary files of the dead go, those of the living and of others stay. */
static void outputs_left_by_the_dead(void **state)
{
	(void)state;
	pid_t dead = fork();
	if (dead == 0)
		_exit(0);
	assert_int_equal(waitpid(dead, NULL, 0), dead);
	assert_true(put_part(dead, 1) && put_part(dead, 2) && put_part(getppid(), 1));
	int locked = __real_open(part_of(dead, 2), O_RDONLY, 0);
	assert_int_equal(flock(locked, LOCK_EX), 0);
	char strange[160];
	snprintf(strange, sizeof strange, "%s.ply", part_of(dead, 3));
	assert_int_equal(symlink("in.xyz", part_of(dead, 4)), 0);
	assert_int_equal(mkfifo(part_of(dead, 5), 0600), 0);
	FILE *file = fopen(strange, "w");
	assert_true(file && fclose(file) == 0);
	other_user = 1;
	write_in_folder();
	other_user = 0;
	assert_true(there(part_of(dead, 1)));
	not_permitted = true;
	write_in_folder();
	not_permitted = false;
	assert_false(there(part_of(dead, 1)));
	assert_true(there(part_of(dead, 2)));
	assert_true(there(part_of(getppid(), 1)));
	put_input(1);
	assert_true(there(part_of(dead, 4)) && there(part_of(dead, 5)) && there(strange));
	__real_close(locked);
	write_in_folder();
	assert_false(there(part_of(dead, 2)));
	/* A writer's own lock shows that it lives. */
	output_file *out;
	assert_int_equal(output_file_create(&out, output, true, NULL), GW_OK);
	int other = __real_open(output_file_temporary(out), O_RDONLY, 0);
	assert_int_not_equal(flock(other, LOCK_EX | LOCK_NB), 0);
	__real_close(other);
	output_file_abandon(&out);
	unlink(part_of(dead, 4));
	unlink(part_of(dead, 5));
	others_in_folder();
}

/* Somebody who takes the writer for dead finds its file before it is locked. */
int __wrap_flock(int descriptor, int operation)
{
	int when = cleaner;
	cleaner = NO_CLEANER;
	if (when != NO_CLEANER)
		assert_int_equal(others_in_folder(), 1);
	if (when == CLEANER_AT_IT) {
		errno = EWOULDBLOCK;
		return -1;
	}
	return __real_flock(descriptor, operation);
}

static void outputs_taken_for_left_ones(void **state)
{
	(void)state;
	for (int when = CLEANER_BEFORE; when <= CLEANER_AT_IT; when++) {
		cleaner = when;
		assert_int_equal(write_one(false, NULL), GW_OK);
		assert_int_equal(cleaner, NO_CLEANER);
		assert_true(there(output));
		assert_int_equal(others_in_folder(), 1);
	}
}

/* A file that has the next name already is somebody else's. */
static void outputs_beside_their_namesakes(void **state)
{
	(void)state;
	output_file *out;
	unsigned serial;
	assert_int_equal(output_file_create(&out, output, false, NULL), GW_OK);
	const char *name = strrchr(output_file_temporary(out), '/');
	assert_int_equal(sscanf(name, "/.glowworm-%*d-%u.part", &serial), 1);
	output_file_abandon(&out);
	assert_true(put_part(getpid(), serial + 1));
	assert_int_equal(write_one(false, NULL), GW_OK);
	assert_true(there(part_of(getpid(), serial + 1)));
	assert_int_equal(others_in_folder(), 2);
}

/* ------------------------------------------------------------------------------- programs */

static gw_status convert(gw_error *error)
{
	settings s = settings_default();
	s.input_count = 0;
	assert_int_equal(settings_add_input(&s, &(settings_input){ .path = input }, NULL), GW_OK);
	assert_int_equal(settings_add_input(&s, &(settings_input){ .path = output }, NULL), GW_OK);
	gw_status status = verb_convert(&s, error);
	settings_clear(&s);
	return status;
}

/* Every call of every kind fails once. A verb that ends well in spite of it did not look. */
static void verbs_on_a_failing_disk(void **state)
{
	(void)state;
	put_input(50000);
	for (call c = OPEN_IT; c <= RENAME_IT; c++) {
		int at = 0;
		do {
			gw_error error = { 0 };
			fault = (struct fault){ .call = c, .at = ++at, .reason = EIO };
			gw_status status = convert(&error);
			bool hit = fault.hit;
			fault.at = 0;
			assert_int_equal(status == GW_OK, !hit);
			int left = others_in_folder();
			/* A folder is opened and synced when the file has its name: after the output, and the
			 * input twice, whether it can be read in parts, and whole. */
			bool folders = c == SYNC_FOLDER || (c == OPEN_IT && at == 4);
			assert_int_equal(left, status == GW_OK || folders);
		} while (at < 20 && fault.hit);
		assert_true(at > 1);
	}
}

/* A verb and its words, with ; between them and a folder before /. */
typedef struct command {
	verb verb;
	int outputs; /* that it syncs */
	const char *words;
} command;

#define LAMP "--light;point at 0,0,0 intensity 1"
#define BAKED "--estimate-points;0;" LAMP

static const command commands[] = {
	{ VERB_SAMPLE, 1, "/in.obj;-q;-o;/out.ply;--count;9" },
	{ VERB_BAKE, 4,
	  "/in.csv;-q;-o;/out.ply;--vdb;/out.vdb;--save-transport;/out.bin;--report;/out.txt;" BAKED },
	{ VERB_BAKE, 3,
	  "/in.scene.json;-q;-o;/out-%d.ply;--frames;all;--report;/out.txt;--estimate-points;0" },
	{ VERB_MIX, 1, "/in.ply;-q;--gain;point=2;-o;/out.ply" },
	{ VERB_COMPARE, 2, "/in.ply;/in.ply;--worst;/out.ply;--json;/out.txt" },
	{ VERB_ALBEDO, 1, "/in.csv;-q;--capture-scale;0.5;-o;/out.ply;" LAMP },
	{ VERB_RENDER, 2, "/in.ply;-q;-o;/out.png;--size;16x16;--orbit;2" },
	{ VERB_RENDER, 1, "/in.ply;/in.ply;-q;--row;-o;/out.png;--size;16x16" },
	{ VERB_TRADEOFF, 2, "/in.csv;-q;--csv;/out.txt;--svg;/out.svg;" BAKED },
	{ VERB_LAMP, 1, "/in.ies;-o;/out.png" },
};

static gw_status run_verb(verb v, settings *s, gw_error *error)
{
	switch (v) {
	case VERB_SAMPLE:
		return verb_sample(s, error);
	case VERB_BAKE:
		return verb_bake(s, error);
	case VERB_MIX:
		return verb_mix(s, error);
	case VERB_COMPARE:
		return verb_compare(s, error);
	case VERB_ALBEDO:
		return verb_albedo(s, error);
	case VERB_RENDER:
		return verb_render(s, error);
	case VERB_TRADEOFF:
		return verb_tradeoff(s, error);
	case VERB_LAMP:
		return verb_lamp(s, error);
	default:
		fail_msg("no verb of this test");
	}
	return GW_ERROR_INTERNAL;
}

static gw_status run_words(verb v, const char *words, gw_error *error)
{
	char text[2048], *word[40];
	int count = 0;
	size_t used = 0;
	for (const char *from = words; *from; from++)
		used += (size_t)snprintf(text + used, sizeof text - used, "%s%c",
								 *from == '/' ? folder : "", *from);
	for (char *w = strtok(text, ";"); w; w = strtok(NULL, ";"))
		word[count++] = w;
	settings s = settings_default();
	gw_status status = options_parse(v, count, word, &s, error);
	if (status == GW_OK)
		status = run_verb(v, &s, error);
	settings_clear(&s);
	return status;
}

static void put_text(const char *name, const char *text)
{
	FILE *file = fopen(in_folder(name), "w");
	assert_non_null(file);
	assert_true(fputs(text, file) >= 0);
	assert_int_equal(fclose(file), 0);
}

/* A cube seen from inside, 16 points a side. */
static void put_cube(void)
{
	FILE *file = fopen(in_folder("in.csv"), "w");
	assert_non_null(file);
	fputs("x,y,z,nx,ny,nz,red,green,blue\n", file);
	for (int i = 0; i < 96; i++) {
		double place[3] = { 0 }, normal[3] = { 0 };
		int axis = i / 32, side = i / 16 % 2 ? 1 : -1;
		place[axis] = side;
		place[(axis + 1) % 3] = (i % 4 - 1.5) / 2;
		place[(axis + 2) % 3] = (i / 4 % 4 - 1.5) / 2;
		normal[axis] = -side;
		fprintf(file, "%g,%g,%g,%g,%g,%g,0.5,0.5,0.5\n", place[0], place[1], place[2], normal[0],
				normal[1], normal[2]);
	}
	assert_int_equal(fclose(file), 0);
}

/* What the commands read. False where there is no device to bake with. */
static bool put_inputs(void)
{
	gw_error error = { 0 };
	put_cube();
	put_text("in.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
	put_text("in.ies", "IESNA:LM-63-2002\nTILT=NONE\n1 100 1 2 1 1 2 0 0 0\n1 1 4\n0 90\n0\n9 0\n");
	put_text("in.scene.json",
			 "{\"version\": 1, \"frames\": 2, \"inputs\": [{\"file\": \"in.csv\"}], \"lights\": "
			 "[{\"type\": \"point\", \"position\": [0, 0, 0], \"intensity\": 1, \"path\": "
			 "[{\"frame\": 0, \"position\": [0, 0, 0]}, "
			 "{\"frame\": 1, \"position\": [0.1, 0, 0]}]}]}");
	gw_status status =
		run_words(VERB_BAKE, "/in.csv;-q;-o;/in.ply;-f;--fields;lights;" BAKED, &error);
	if (status != GW_ERROR_NO_DEVICE)
		assert_string_equal(error.text, "");
	return status == GW_OK;
}

/* More calls of a kind than any of the commands makes. */
#define CALLS_MOST 100

/* What a verb writes is lost at one call of a kind after the other, until there are no more: it
 * fails each time, and only then. Returns how many there are. */
static int count_noticed(const command *c, call kind)
{
	bool hit = true;
	int calls = 0;
	for (; hit && calls < CALLS_MOST; calls++) {
		gw_error error = { 0 };
		fault = (struct fault){ .call = kind, .at = calls + 1, .reason = EIO };
		gw_status status = run_words(c->verb, c->words, &error);
		hit = fault.hit;
		fault.at = 0;
		if ((status == GW_OK) == hit)
			fail_msg("%s: call %d %s, status %d: %s", c->words, calls + 1,
					 hit ? "failed" : "was not made", (int)status, error.text);
		others_in_folder();
	}
	assert_false(hit);
	return calls - 1;
}

/* Every verb notices that one of its outputs is not safe, or that a text that it makes in memory,
 * such as its own command line, was not made. */
static void all_verbs_on_a_failing_disk(void **state)
{
	(void)state;
	if (!put_inputs())
		skip();
	for (size_t i = 0; i < sizeof commands / sizeof *commands; i++) {
		assert_int_equal(count_noticed(&commands[i], SYNC_FILE), commands[i].outputs);
		assert_true(count_noticed(&commands[i], CLOSE_STREAM) > 0);
	}
}

/* Grids are read back before they get their name. */
static void grids_on_a_lying_disk(void **state)
{
	(void)state;
	gw_error error = { 0 };
	if (!put_inputs())
		skip();
	loses_ends = true;
	gw_status status = run_words(VERB_BAKE, "/in.csv;-q;--vdb;/out.vdb;" BAKED, &error);
	loses_ends = false;
	assert_int_equal(status, FILE_ERROR_IO);
	assert_non_null(strstr(error.text, "cannot be read back"));
	assert_int_equal(others_in_folder(), 0);
}

/* What doctor says of a folder. */
static health_verdict judge_folder(call c, int reason)
{
	static health h;
	h.count = 0;
	fault = (struct fault){ .call = c, .at = 1, .reason = reason };
	health_judge_folder(&h, "folder", folder, true);
	assert_true(fault.hit || reason == 0);
	fault.at = 0;
	assert_int_equal(others_in_folder(), 0);
	return h.item[0].verdict;
}

static void folders_on_a_failing_disk(void **state)
{
	(void)state;
	assert_int_equal(judge_folder(RENAME_IT, 0), HEALTH_GOOD);
	assert_int_equal(judge_folder(WRITE_IT, ENOSPC), HEALTH_BAD);
	assert_int_equal(judge_folder(SYNC_FILE, EIO), HEALTH_BAD);
	assert_int_equal(judge_folder(SYNC_FILE, EINVAL), HEALTH_GOOD);
	assert_int_equal(judge_folder(CLOSE_IT, EIO), HEALTH_BAD);
	write_most = 100;
	assert_int_equal(judge_folder(RENAME_IT, 0), HEALTH_BAD);
	write_most = 0;
}

/* -------------------------------------------------------------------------------- inputs */

static gw_status open_input(input_file *in, uint64_t copied, gw_error *error)
{
	return input_file_open_as(in, input, copied, 0, error);
}

static void inputs_on_a_failing_disk(void **state)
{
	(void)state;
	input_file in;
	gw_error error = { 0 };
	put_input(1000);
	fault = (struct fault){ .call = READ_IT, .at = 1, .reason = EIO };
	assert_int_equal(open_input(&in, UINT64_MAX, &error), FILE_ERROR_IO);
	assert_non_null(strstr(error.text, strerror(EIO)));
	fault.at = 0;
	cut_short = true;
	gw_status status = open_input(&in, UINT64_MAX, &error);
	cut_short = false;
	assert_int_equal(status, FILE_ERROR_IO);
	assert_non_null(strstr(error.text, "cut short"));
	assert_null(in.data);
}

/* What was copied stays, whatever happens to the file. */
static void inputs_cut_after_reading(void **state)
{
	(void)state;
	input_file in;
	put_input(LARGE / 8);
	assert_int_equal(input_file_open(&in, input, NULL), GW_OK);
	assert_int_equal(in.storage, INPUT_FILE_COPIED);
	size_t lines = 0;
	assert_int_equal(truncate(input, 0), 0);
	for (size_t i = 0; i < in.length; i++)
		lines += in.data[i] == '\n';
	assert_int_equal(lines, LARGE / 8);
	assert_int_equal(input_file_check(&in, GW_OK, NULL), GW_OK);
	input_file_close(&in);
}

typedef struct counting {
	const input_file *in;
	atomic_size_t lines;
} counting;

static void count_lines(void *user, size_t first, size_t last, uint32_t worker)
{
	counting *c = user;
	(void)worker;
	for (size_t i = first; i < last; i++)
		c->lines += c->in->data[i] == '\n';
}

/* A file too large to be copied: threads read on, and the end of it is a sentence. */
static void inputs_cut_while_mapped(void **state)
{
	(void)state;
	static const off_t cut[] = { 0, 5, 4096, 1000001, LARGE - 100 };
	signals_install(); /* cmocka has handlers of its own */
	for (size_t i = 0; i < sizeof cut / sizeof *cut; i++) {
		input_file in;
		gw_error error = { 0 };
		put_input(LARGE / 8);
		assert_int_equal(open_input(&in, 0, &error), GW_OK);
		assert_int_equal(in.storage, INPUT_FILE_MAPPED);
		assert_int_equal(input_file_check(&in, GW_OK, &error), GW_OK);
		assert_int_equal(truncate(input, cut[i]), 0);
		counting job = { .in = &in };
		gw_parallel_for(3, in.length, 50000, count_lines, &job);
		assert_true(job.lines < LARGE / 8);
		assert_int_equal(in.data[in.length - 1], 0);
		assert_int_equal(input_file_check(&in, GW_ERROR_DATA, &error), FILE_ERROR_IO);
		assert_non_null(strstr(error.text, "in.xyz was changed or cut short"));
		input_file_close(&in);
	}
}

static gw_status read_seed(const seed *s)
{
	scan cloud = { 0 };
	mesh m = { 0 };
	gw_error error = { 0 };
	bool is_mesh = strncmp(s->format, "mesh-", 5) == 0;
	gw_status status = is_mesh ? mesh_read(input, &m, &error)
							   : format_read_with(input, &(format_options){ .name = s->format },
												  &cloud, NULL, &error);
	assert_null(status == GW_OK ? NULL : cloud.column);
	scan_clear(&cloud);
	mesh_clear(&m);
	return status;
}

/* Each reader's file vanishes between its opening and the first byte that is read. */
static void readers_of_vanishing_files(void **state)
{
	(void)state;
	static seed seeds[SEEDS];
	signals_install();
	seed_files_make(seeds);
	for (size_t i = 0; i < SEEDS; i++) {
		/* Materials are no input of their own, and this E57 has no checksums yet. */
		if (strcmp(seeds[i].format, "mtl") == 0 || seeds[i].xml)
			continue;
		for (int cut = 0; cut < 2; cut++) {
			FILE *file = fopen(input, "w");
			assert_non_null(file);
			assert_int_equal(fwrite(seeds[i].data, 1, seeds[i].length, file), seeds[i].length);
			assert_int_equal(fclose(file), 0);
			no_memory_to_copy = true;
			cut_when_mapped = cut;
			assert_int_equal(read_seed(&seeds[i]), cut ? FILE_ERROR_IO : GW_OK);
			assert_false(no_memory_to_copy || cut_when_mapped);
		}
	}
}

/* Written anew with the same length: no page is missing, but what was read is a mixture. */
static void inputs_changed_while_mapped(void **state)
{
	(void)state;
	input_file in;
	struct timespec before[2] = { { .tv_sec = 1000000000 }, { .tv_sec = 1000000000 } };
	put_input(1000);
	assert_int_equal(utimensat(AT_FDCWD, input, before, 0), 0);
	assert_int_equal(open_input(&in, 0, NULL), GW_OK);
	assert_int_equal(input_file_check(&in, GW_ERROR_DATA, NULL), GW_ERROR_DATA);
	put_input(1000);
	assert_int_equal(input_file_check(&in, GW_OK, NULL), FILE_ERROR_IO);
	input_file_close(&in);
	/* Cut short, and the time put back. */
	assert_int_equal(utimensat(AT_FDCWD, input, before, 0), 0);
	assert_int_equal(open_input(&in, 0, NULL), GW_OK);
	assert_int_equal(truncate(input, (off_t)in.length - 1), 0);
	assert_int_equal(utimensat(AT_FDCWD, input, before, 0), 0);
	assert_int_equal(input_file_check(&in, GW_OK, NULL), FILE_ERROR_IO);
	input_file_close(&in);
	/* Another file under the same name is none of our business. */
	assert_int_equal(open_input(&in, 0, NULL), GW_OK);
	assert_int_equal(unlink(input), 0);
	put_input(2000);
	assert_int_equal(input_file_check(&in, GW_OK, NULL), GW_OK);
	input_file_close(&in);
}

/* More maps at once than the handler knows of: the rest is copied. */
static void inputs_mapped_many_times(void **state)
{
	(void)state;
	input_file in[80];
	size_t mapped = 0;
	put_input(1000);
	for (size_t i = 0; i < 80; i++) {
		assert_int_equal(open_input(&in[i], 0, NULL), GW_OK);
		mapped += in[i].storage == INPUT_FILE_MAPPED;
	}
	assert_in_range(mapped, 1, 79);
	for (size_t i = 0; i < 80; i++)
		input_file_close(&in[i]);
	assert_int_equal(open_input(&in[0], 0, NULL), GW_OK);
	assert_int_equal(in[0].storage, INPUT_FILE_MAPPED);
	input_file_close(&in[0]);
}

/* A stream that never ends. */
static void inputs_without_an_end(void **state)
{
	(void)state;
	input_file in;
	gw_error error = { 0 };
	assert_int_equal(input_file_open_as(&in, "/dev/zero", 0, 1000000, &error), GW_ERROR_MEMORY);
	assert_non_null(strstr(error.text, "/dev/zero brings more than the 1000000 bytes"));
	assert_null(in.data);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(outputs_on_a_failing_disk),
		cmocka_unit_test(outputs_in_a_failing_folder),
		cmocka_unit_test(outputs_on_a_small_disk),
		cmocka_unit_test(outputs_written_in_pieces),
		cmocka_unit_test(outputs_on_a_simple_file_system),
		cmocka_unit_test(outputs_left_by_the_dead),
		cmocka_unit_test(outputs_taken_for_left_ones),
		cmocka_unit_test(outputs_beside_their_namesakes),
		cmocka_unit_test(verbs_on_a_failing_disk),
		cmocka_unit_test(all_verbs_on_a_failing_disk),
		cmocka_unit_test(grids_on_a_lying_disk),
		cmocka_unit_test(folders_on_a_failing_disk),
		cmocka_unit_test(inputs_on_a_failing_disk),
		cmocka_unit_test(inputs_cut_after_reading),
		cmocka_unit_test(inputs_cut_while_mapped),
		cmocka_unit_test(readers_of_vanishing_files),
		cmocka_unit_test(inputs_changed_while_mapped),
		cmocka_unit_test(inputs_mapped_many_times),
		cmocka_unit_test(inputs_without_an_end),
	};
	return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
