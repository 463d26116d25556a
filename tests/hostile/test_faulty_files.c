/* Disks that fail: each call that reads or writes a file fails in turn, and inputs are cut short
 * while they are read. Whatever ends without an error must have made every call. */
#include "program/exit_code.h"
#include "table/format_table.h"
#include "meshes/mesh.h"
#include "files/output_file.h"
#include "base/parallel.h"
#include "seed_files.h"
#include "program/signals.h"
#include "verbs/verbs.h"
#include "meshes/mesh_reader.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
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

typedef enum call { OPEN_IT, READ_IT, WRITE_IT, SYNC_FILE, SYNC_FOLDER, CLOSE_IT, RENAME_IT } call;

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
int __real_rename(const char *from, const char *to);
int __real_renameat2(int a, const char *from, int b, const char *to, unsigned flags);
int __wrap_open(const char *path, int flags, mode_t mode);
ssize_t __wrap_read(int descriptor, void *bytes, size_t length);
ssize_t __wrap_pread(int descriptor, void *bytes, size_t length, off_t at);
ssize_t __wrap_write(int descriptor, const void *bytes, size_t length);
int __wrap_fsync(int descriptor);
int __wrap_close(int descriptor);
int __wrap_rename(const char *from, const char *to);
int __wrap_renameat2(int a, const char *from, int b, const char *to, unsigned flags);

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
	return fails(WRITE_IT) ? -1 : __real_write(descriptor, bytes, length);
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
	return fails(RENAME_IT) ? -1 : __real_renameat2(a, from, b, to, flags);
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

/* Empties the folder but for the input; the number of names that were there beside it. */
static int others_in_folder(void)
{
	int count = 0;
	DIR *open_folder = opendir(folder);
	assert_non_null(open_folder);
	for (struct dirent *entry; (entry = readdir(open_folder));)
		if (entry->d_type == DT_REG && strcmp(entry->d_name, "in.xyz") != 0) {
			count++;
			unlinkat(dirfd(open_folder), entry->d_name, 0);
		}
	closedir(open_folder);
	return count;
}

static int remove_folder(void **state)
{
	(void)state;
	others_in_folder();
	unlink(input);
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
	/* Not every file system has it. */
	fault = (struct fault){ .call = SYNC_FOLDER, .at = 1, .reason = EINVAL };
	assert_int_equal(write_one(false, NULL), GW_OK);
	assert_true(fault.hit);
	assert_int_equal(others_in_folder(), 1);
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
	assert_int_equal(symlink("in.xyz", strange), 0);
	write_in_folder();
	assert_false(there(part_of(dead, 1)));
	assert_true(there(part_of(dead, 2)));
	assert_true(there(part_of(getppid(), 1)));
	put_input(1);
	assert_true(there(part_of(dead, 4)));
	assert_true(there(strange));
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
	unlink(strange);
	others_in_folder();
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
			/* A folder is opened and synced when the file has its name. */
			bool folders = c == SYNC_FOLDER || (c == OPEN_IT && at == 3);
			assert_int_equal(left, status == GW_OK || folders);
		} while (at < 20 && fault.hit);
		assert_true(at > 1);
	}
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
		cmocka_unit_test(outputs_on_a_failing_disk),  cmocka_unit_test(outputs_in_a_failing_folder),
		cmocka_unit_test(outputs_on_a_small_disk),    cmocka_unit_test(outputs_left_by_the_dead),
		cmocka_unit_test(verbs_on_a_failing_disk),    cmocka_unit_test(inputs_on_a_failing_disk),
		cmocka_unit_test(inputs_cut_after_reading),   cmocka_unit_test(inputs_cut_while_mapped),
		cmocka_unit_test(readers_of_vanishing_files), cmocka_unit_test(inputs_changed_while_mapped),
		cmocka_unit_test(inputs_mapped_many_times),   cmocka_unit_test(inputs_without_an_end),
	};
	return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
