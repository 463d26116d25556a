/* Inputs, outputs and numbers: input_file, output_file, number_text. */
#include "files/input_file.h"
#include "files/number_text.h"
#include "files/output_file.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <locale.h>
#include <math.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

static char folder[64];

static int make_folder(void **state)
{
	(void)state;
	strcpy(folder, "/tmp/glowworm-test-XXXXXX");
	return mkdtemp(folder) ? 0 : -1;
}

/* Names in the test's folder; `remove_them` empties it. */
static int files_in_folder(bool remove_them)
{
	int count = 0;
	DIR *open_folder = opendir(folder);
	assert_non_null(open_folder);
	for (struct dirent *entry; (entry = readdir(open_folder));) {
		if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0)
			continue;
		count++;
		if (remove_them)
			unlinkat(dirfd(open_folder), entry->d_name, 0);
	}
	closedir(open_folder);
	return count;
}

static int remove_folder(void **state)
{
	(void)state;
	files_in_folder(true);
	return rmdir(folder);
}

static const char *in_folder(const char *name)
{
	static char path[2][160];
	static int turn;
	turn = !turn;
	snprintf(path[turn], sizeof path[turn], "%s/%s", folder, name);
	return path[turn];
}

static void put_file(const char *path, const char *text)
{
	FILE *file = fopen(path, "w");
	assert_non_null(file);
	fputs(text, file);
	assert_int_equal(fclose(file), 0);
}

static void assert_content(const char *path, const char *text)
{
	input_file in;
	assert_int_equal(input_file_open(&in, path, NULL), GW_OK);
	assert_int_equal(in.length, strlen(text));
	assert_memory_equal(in.data, text, in.length);
	input_file_close(&in);
}

/* ------------------------------------------------------------------------------- inputs */

static void input_of_a_file(void **state)
{
	(void)state;
	put_file(in_folder("a"), "hello");
	assert_content(in_folder("a"), "hello");
	put_file(in_folder("empty"), "");
	assert_content(in_folder("empty"), "");
	files_in_folder(true);
}

static void input_that_is_not_there(void **state)
{
	(void)state;
	input_file in;
	gw_error error = { 0 };
	assert_int_equal(input_file_open(&in, in_folder("none"), &error), FILE_ERROR_NO_INPUT);
	assert_non_null(strstr(error.text, "none"));
	assert_int_equal(input_file_open(&in, folder, &error), FILE_ERROR_NO_INPUT);
	assert_non_null(strstr(error.text, "directory"));
	assert_null(in.data);
}

/* A file without a size that still has content, and a pipe of more than the first buffer. */
static void input_that_cannot_be_mapped(void **state)
{
	(void)state;
	input_file in;
	assert_int_equal(input_file_open(&in, "/proc/self/stat", NULL), GW_OK);
	assert_true(in.length > 10);
	input_file_close(&in);

	char command[200];
	snprintf(command, sizeof command, "head -c 300000 /dev/zero | tr '\\0' x > %s",
			 in_folder("fifo"));
	assert_int_equal(mkfifo(in_folder("fifo"), 0600), 0);
	FILE *writer = popen(command, "r");
	assert_int_equal(input_file_open(&in, in_folder("fifo"), NULL), GW_OK);
	assert_int_equal(in.length, 300000);
	assert_int_equal(in.data[299999], 'x');
	input_file_close(&in);
	pclose(writer);
	files_in_folder(true);
}

/* ------------------------------------------------------------------------------ outputs */

static void output_appears_when_whole(void **state)
{
	(void)state;
	output_file *out;
	assert_int_equal(output_file_create(&out, in_folder("a"), false, NULL), GW_OK);
	assert_int_equal(output_file_print(out, NULL, "%s %d", "number", 7), GW_OK);
	assert_int_not_equal(access(in_folder("a"), F_OK), 0);
	assert_int_equal(output_file_commit(&out, NULL), GW_OK);
	assert_null(out);
	assert_content(in_folder("a"), "number 7");
	assert_int_equal(files_in_folder(true), 1);
}

/* Pieces smaller and larger than the buffer come out in order. */
static void output_of_many_sizes(void **state)
{
	(void)state;
	size_t size = 3000000, at = 0, piece = 1;
	uint8_t *bytes = malloc(size);
	for (size_t i = 0; i < size; i++)
		bytes[i] = (uint8_t)(i * 2654435761u >> 13);
	output_file *out;
	assert_int_equal(output_file_create(&out, in_folder("a"), false, NULL), GW_OK);
	while (at < size) {
		size_t length = piece < size - at ? piece : size - at;
		assert_int_equal(output_file_write(out, bytes + at, length, NULL), GW_OK);
		at += length;
		piece = piece * 3 + 1;
	}
	assert_int_equal(output_file_commit(&out, NULL), GW_OK);
	input_file in;
	assert_int_equal(input_file_open(&in, in_folder("a"), NULL), GW_OK);
	assert_int_equal(in.length, size);
	assert_memory_equal(in.data, bytes, size);
	input_file_close(&in);
	free(bytes);
	files_in_folder(true);
}

/* Bytes that are still in the buffer, and some that are with the system. */
static void output_is_patched(void **state)
{
	(void)state;
	output_file *out;
	assert_int_equal(output_file_create(&out, in_folder("a"), true, NULL), GW_OK);
	output_file_write(out, "0123456789", 10, NULL);
	assert_int_equal(output_file_patch(out, 2, "xyz", 3, NULL), GW_OK);
	output_file_write(out, "abc", 3, NULL);
	assert_int_equal(output_file_patch(out, 0, "-", 1, NULL), GW_OK);
	output_file_write(out, "d", 1, NULL);
	assert_int_equal(output_file_commit(&out, NULL), GW_OK);
	assert_content(in_folder("a"), "-1xyz56789abcd");
	unlink(in_folder("a"));
}

static void output_abandoned_leaves_nothing(void **state)
{
	(void)state;
	output_file *out;
	assert_int_equal(output_file_create(&out, in_folder("a"), false, NULL), GW_OK);
	output_file_write(out, "x", 1, NULL);
	assert_int_equal(files_in_folder(false), 1);
	output_file_abandon(&out);
	assert_null(out);
	output_file_abandon(&out);
	assert_int_equal(files_in_folder(false), 0);
}

static void output_overwrites_only_by_force(void **state)
{
	(void)state;
	output_file *out;
	gw_error error = { 0 };
	put_file(in_folder("a"), "old");
	assert_int_equal(chmod(in_folder("a"), 0640), 0);
	assert_int_equal(output_file_create(&out, in_folder("a"), false, &error), FILE_ERROR_CREATE);
	assert_non_null(strstr(error.text, "exists already"));
	assert_null(out);

	assert_int_equal(symlink("a", in_folder("link")), 0);
	assert_int_equal(output_file_create(&out, in_folder("link"), true, NULL), GW_OK);
	output_file_print(out, NULL, "new");
	assert_content(in_folder("a"), "old");
	assert_int_equal(output_file_commit(&out, NULL), GW_OK);
	assert_content(in_folder("a"), "new");
	struct stat info;
	assert_int_equal(lstat(in_folder("link"), &info), 0);
	assert_true(S_ISLNK(info.st_mode));
	assert_int_equal(stat(in_folder("a"), &info), 0);
	assert_int_equal(info.st_mode & 0777, 0640);
	files_in_folder(true);
}

/* The name was free at the start and is not at the end. */
static void output_does_not_win_a_race(void **state)
{
	(void)state;
	output_file *out;
	assert_int_equal(output_file_create(&out, in_folder("a"), false, NULL), GW_OK);
	output_file_print(out, NULL, "late");
	put_file(in_folder("a"), "early");
	assert_int_equal(output_file_commit(&out, NULL), FILE_ERROR_CREATE);
	assert_content(in_folder("a"), "early");
	assert_int_equal(files_in_folder(true), 1);
}

static void output_without_a_place(void **state)
{
	(void)state;
	output_file *out;
	gw_error error = { 0 };
	assert_int_equal(output_file_create(&out, in_folder("no/a"), false, &error), FILE_ERROR_CREATE);
	assert_non_null(strstr(error.text, "no/a"));
	assert_int_equal(output_file_create(&out, folder, true, &error), FILE_ERROR_CREATE);
	assert_int_equal(output_file_create(&out, "", true, &error), FILE_ERROR_CREATE);
	char long_name[400];
	snprintf(long_name, sizeof long_name, "%s/%0300d", folder, 0);
	assert_int_equal(output_file_create(&out, long_name, true, &error), FILE_ERROR_CREATE);
	assert_int_equal(output_file_check(long_name, true, &error), FILE_ERROR_CREATE);
	assert_non_null(strstr(error.text, strerror(ENAMETOOLONG)));
	assert_int_equal(symlink("nowhere", in_folder("link")), 0);
	assert_int_equal(output_file_create(&out, in_folder("link"), true, &error), FILE_ERROR_CREATE);
	files_in_folder(true);
}

static void output_to_a_full_device(void **state)
{
	(void)state;
	struct stat before, after;
	output_file *out;
	gw_error error = { 0 };
	assert_int_equal(stat("/dev/full", &before), 0);
	assert_int_equal(output_file_create(&out, "/dev/full", true, NULL), GW_OK);
	assert_null(output_file_temporary(out));
	output_file_print(out, NULL, "x");
	assert_int_equal(output_file_flush(out, NULL), FILE_ERROR_IO);
	assert_int_equal(output_file_write(out, "y", 1, NULL), FILE_ERROR_IO);
	assert_int_equal(output_file_commit(&out, &error), FILE_ERROR_IO);
	assert_non_null(strstr(error.text, "/dev/full"));
	assert_non_null(strstr(error.text, "No space left"));
	assert_int_equal(stat("/dev/full", &after), 0);
	assert_true(before.st_ino == after.st_ino && S_ISCHR(after.st_mode));
}

static void output_to_a_closed_pipe(void **state)
{
	(void)state;
	int ends[2];
	char path[32];
	output_file *out;
	gw_error error = { 0 };
	assert_int_equal(pipe(ends), 0);
	snprintf(path, sizeof path, "/dev/fd/%d", ends[1]);
	assert_int_equal(output_file_create(&out, path, false, NULL), GW_OK);
	output_file_print(out, NULL, "x");
	close(ends[0]);
	assert_int_equal(output_file_commit(&out, &error), FILE_ERROR_IO);
	assert_non_null(strstr(error.text, "Broken pipe"));
	close(ends[1]);
}

/* A limit on the size of files stands for a disk that fills up half way. */
static void output_that_gets_too_large(void **state)
{
	(void)state;
	struct rlimit before, small = { 100000, RLIM_INFINITY };
	assert_int_equal(getrlimit(RLIMIT_FSIZE, &before), 0);
	small.rlim_max = before.rlim_max;
	output_file *out;
	gw_error error = { 0 };
	static const uint8_t bytes[400000];
	assert_int_equal(output_file_create(&out, in_folder("a"), false, NULL), GW_OK);
	assert_int_equal(setrlimit(RLIMIT_FSIZE, &small), 0);
	gw_status status = output_file_write(out, bytes, sizeof bytes, &error);
	assert_int_equal(setrlimit(RLIMIT_FSIZE, &before), 0);
	assert_int_equal(status, FILE_ERROR_IO);
	/* The failure stays, though there would be room now. */
	assert_int_equal(output_file_commit(&out, &error), FILE_ERROR_IO);
	assert_non_null(strstr(error.text, "File too large"));
	assert_int_equal(files_in_folder(true), 0);
}

static void end_cleanly(int signal_number)
{
	output_file_remove_temporaries();
	_exit(signal_number);
}

/* More outputs than one chunk of the registry has room for, in a process that a signal ends. */
static void output_temporaries_removed_by_a_signal(void **state)
{
	(void)state;
	pid_t child = fork();
	if (child == 0) {
		output_file *out[40];
		char name[16];
		signal(SIGTERM, end_cleanly);
		for (int i = 0; i < 40; i++) {
			snprintf(name, sizeof name, "%d", i);
			if (output_file_create(&out[i], in_folder(name), false, NULL) != GW_OK)
				_exit(1);
		}
		output_file_abandon(&out[3]);
		if (output_file_commit(&out[20], NULL) != GW_OK || files_in_folder(false) != 39)
			_exit(2);
		raise(SIGTERM);
		_exit(3);
	}
	int end = 0;
	assert_int_equal(waitpid(child, &end, 0), child);
	assert_true(WIFEXITED(end));
	assert_int_equal(WEXITSTATUS(end), SIGTERM);
	assert_content(in_folder("20"), "");
	assert_int_equal(files_in_folder(true), 1);
}

/* ------------------------------------------------------------------------------ numbers */

/* Reads from memory of exactly the text's length, so that a sanitizer sees a byte too many. */
static size_t read_exactly(const char *text, double *value)
{
	size_t length = strlen(text);
	char *copy = malloc(length + !length);
	memcpy(copy, text, length);
	size_t used = number_read(copy, length, value);
	free(copy);
	return used;
}

static void numbers_are_read(void **state)
{
	(void)state;
	static const struct {
		const char *text;
		size_t used;
		double value;
	} cases[] = {
		{ "0", 1, 0.0 },
		{ "-12.5", 5, -12.5 },
		{ "+.5", 3, 0.5 },
		{ "5.", 2, 5.0 },
		{ "1e3", 3, 1000.0 },
		{ "1E-3x", 4, 0.001 },
		{ "1e", 1, 1.0 },
		{ "1e+", 1, 1.0 },
		{ "3,5", 1, 3.0 },
		{ "0x10", 1, 0.0 },
		{ "9007199254740993", 16, 9007199254740992.0 },
		{ "9007199254740993.0000000000000000000001", 39, 9007199254740994.0 },
		{ "1e23", 4, 1e23 },
		{ "2.2250738585072011e-308", 23, 0x1.ffffffffffffep-1023 },
		{ "4.9e-324", 8, 0x1p-1074 },
		{ "1e400", 5, INFINITY },
		{ "-1e99999999999999999999", 23, -INFINITY },
		{ "1e-400", 6, 0.0 },
		{ "inf", 3, INFINITY },
		{ "-Infinity", 9, -INFINITY },
		{ "1.#INF00", 8, INFINITY },
		{ "-1.#inf", 7, -INFINITY },
		{ "", 0, 0.0 },
		{ "-", 0, 0.0 },
		{ ".", 0, 0.0 },
		{ "e5", 0, 0.0 },
		{ "in", 0, 0.0 },
		{ "1.#", 0, 0.0 },
		{ " 1", 0, 0.0 },
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		double value = 0.0;
		assert_int_equal(read_exactly(cases[i].text, &value), cases[i].used);
		assert_true(value == cases[i].value);
	}
	double value = 0.0;
	assert_int_equal(read_exactly("-nan", &value), 4);
	assert_true(isnan(value));
	assert_int_equal(read_exactly("1.#QNAN", &value), 7);
	assert_true(isnan(value));
}

/* Numbers that leave the range by their digits, not by their exponent. */
static void long_numbers_are_read(void **state)
{
	(void)state;
	char text[512];
	double value = 1.0;
	memset(text, '7', 400);
	strcpy(text + 400, "e-10");
	assert_int_equal(read_exactly(text, &value), 404);
	assert_true(value == INFINITY);
	memset(text, '0', 400);
	text[1] = '.';
	strcpy(text + 400, "7e+20");
	assert_int_equal(read_exactly(text, &value), 405);
	assert_true(value == 0.0);
	strcpy(text + 400, "7e398");
	assert_int_equal(read_exactly(text, &value), 405);
	assert_true(value == 0.7);
}

static uint64_t next_random(uint64_t *seed)
{
	*seed ^= *seed << 13;
	*seed ^= *seed >> 7;
	*seed ^= *seed << 17;
	return *seed;
}

/* The C library rounds correctly; every text must give the same bits. */
static void numbers_are_rounded_once(void **state)
{
	(void)state;
	uint64_t seed = 1;
	for (int i = 0; i < 40000; i++) {
		char text[80];
		uint64_t r = next_random(&seed);
		int digits = (int)(r % 25) + 1, power = (int)(r >> 8) % 60;
		double fraction = (double)(next_random(&seed) >> 11) * 0x1p-53;
		snprintf(text, sizeof text, "%.*fe%d", digits, fraction * 1000.0, power);
		double value;
		float single;
		assert_int_equal(number_read(text, strlen(text), &value), strlen(text));
		assert_true(value == strtod(text, NULL));
		assert_int_equal(number_read_float(text, strlen(text), &single), strlen(text));
		assert_true(single == strtof(text, NULL));
	}
	/* Just over half-way between 1 and the next float; as a double it is half-way exactly. */
	const char *half = "1.00000005960464477539062500000001";
	float single;
	number_read_float(half, strlen(half), &single);
	assert_true(single == 0x1.000002p0f);
}

/* Digits, as many as there are; bytes beside '0' and '9', and with the highest bit, are none. */
static size_t put_digits(char *to, uint64_t *seed, size_t most)
{
	size_t count = next_random(seed) % (most + 1);
	for (size_t i = 0; i < count; i++)
		to[i] = (char)('0' + next_random(seed) % 10);
	return count;
}

static void numbers_end_with_their_digits(void **state)
{
	(void)state;
	static const char other[] = { '/', ':', ' ', ',', '\n', ';', '\x80', '\xb0', '\xb9', '\xff' };
	uint64_t seed = 3;
	for (int i = 0; i < 40000; i++) {
		char text[80] = "-", copy[80];
		size_t sign = next_random(&seed) % 2, length = sign;
		size_t digits = put_digits(text + length, &seed, 23);
		length += digits;
		if (next_random(&seed) % 2) {
			text[length++] = '.';
			size_t behind = put_digits(text + length, &seed, 23);
			length += behind;
			digits += behind;
		}
		memcpy(copy, text, length);
		copy[length] = '\0';
		text[length] = other[next_random(&seed) % sizeof other];
		size_t tail = 1 + put_digits(text + length + 1, &seed, 10);
		double value = 0.0;
		assert_int_equal(number_read(text, length + tail, &value), digits ? length : 0);
		assert_true(value == (digits ? strtod(copy, NULL) : 0.0));
		assert_int_equal(read_exactly(copy, &value), digits ? length : 0);
		assert_true(value == (digits ? strtod(copy, NULL) : 0.0));
	}
}

static void assert_round_trips(void)
{
	uint64_t seed = 2;
	for (int i = 0; i < 20000; i++) {
		char text[NUMBER_TEXT];
		uint64_t bits = next_random(&seed);
		double value, back;
		memcpy(&value, &bits, sizeof value);
		size_t length = number_print(text, value);
		assert_int_equal(length, strlen(text));
		assert_int_equal(number_read(text, length, &back), length);
		assert_true(back == value || (isnan(back) && isnan(value)));

		float single, single_back;
		memcpy(&single, &bits, sizeof single);
		length = number_print_float(text, single);
		assert_int_equal(number_read_float(text, length, &single_back), length);
		assert_true(single_back == single || (isnan(single_back) && isnan(single)));
	}
}

static void numbers_round_trip(void **state)
{
	(void)state;
	char text[NUMBER_TEXT];
	assert_round_trips();
	number_print(text, 0.1);
	assert_string_equal(text, "0.1");
	number_print_float(text, 0.1f);
	assert_string_equal(text, "0.1");
	number_print(text, 5400000.125);
	assert_string_equal(text, "5400000.125");
	number_print(text, -INFINITY);
	assert_string_equal(text, "-inf");
	/* 20 digits would be shorter, but no JSON reader takes them for an integer. */
	number_print(text, 16273593426270748672.0);
	assert_string_equal(text, "1.6273593426270749e+19");
}

/* A locale with a decimal comma: one that is installed, or one made here. */
static bool set_comma_locale(void)
{
	if (setlocale(LC_ALL, "de_DE.UTF-8"))
		return true;
	char command[200];
	snprintf(command, sizeof command, "localedef -i de_DE -f UTF-8 %s 2>/dev/null",
			 in_folder("de_DE.UTF-8"));
	setenv("LOCPATH", folder, 1);
	return system(command) == 0 && setlocale(LC_ALL, "de_DE.UTF-8");
}

static void remove_comma_locale(void)
{
	char command[200];
	setlocale(LC_ALL, "C");
	unsetenv("LOCPATH");
	snprintf(command, sizeof command, "rm -rf %s", in_folder("de_DE.UTF-8"));
	assert_int_equal(system(command), 0);
}

static void numbers_ignore_the_locale(void **state)
{
	(void)state;
	if (!set_comma_locale()) {
		print_message("this system has no locale with a decimal comma and cannot make one\n");
		remove_comma_locale();
		skip();
	}
	char comma[16];
	snprintf(comma, sizeof comma, "%.1f", 1.5);
	assert_string_equal(comma, "1,5");
	char text[NUMBER_TEXT];
	double value;
	number_print(text, 1.5);
	size_t used = number_read("0.12345678901234567890123", 25, &value);
	assert_round_trips();
	remove_comma_locale();
	assert_string_equal(text, "1.5");
	assert_int_equal(used, 25);
	assert_true(value == 0.12345678901234567890123);
}

int main(void)
{
	signal(SIGPIPE, SIG_IGN);
	signal(SIGXFSZ, SIG_IGN);
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(input_of_a_file),
		cmocka_unit_test(input_that_is_not_there),
		cmocka_unit_test(input_that_cannot_be_mapped),
		cmocka_unit_test(output_appears_when_whole),
		cmocka_unit_test(output_of_many_sizes),
		cmocka_unit_test(output_is_patched),
		cmocka_unit_test(output_abandoned_leaves_nothing),
		cmocka_unit_test(output_overwrites_only_by_force),
		cmocka_unit_test(output_does_not_win_a_race),
		cmocka_unit_test(output_without_a_place),
		cmocka_unit_test(output_to_a_full_device),
		cmocka_unit_test(output_to_a_closed_pipe),
		cmocka_unit_test(output_that_gets_too_large),
		cmocka_unit_test(output_temporaries_removed_by_a_signal),
		cmocka_unit_test(numbers_are_read),
		cmocka_unit_test(long_numbers_are_read),
		cmocka_unit_test(numbers_are_rounded_once),
		cmocka_unit_test(numbers_end_with_their_digits),
		cmocka_unit_test(numbers_round_trip),
		cmocka_unit_test(numbers_ignore_the_locale),
	};
	return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
