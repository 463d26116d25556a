/*
 * test_journal.c - what long work keeps of itself: sections and slots, whole, torn and damaged; and
 * what is kept in them: scans, and the light of points.
 */
#include "expected.h"
#include "own_folder.h"
#include "files/checksum.h"
#include "files/journal_file.h"
#include "files/output_file.h"
#include "points/scan_bytes.h"

#include <fcntl.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

/* However bytes are cut, they have one sum; each bit and the length tell on it. */
static void sums_tell(void **state)
{
	(void)state;
	uint8_t bytes[64] = { 0 };
	checksum whole = { 0 }, shorter = { 0 };
	checksum_add(&whole, bytes, sizeof bytes);
	checksum_add(&shorter, bytes, sizeof bytes - 1);
	assert_true(checksum_value(&whole) != checksum_value(&shorter));
	for (size_t cut = 0; cut <= sizeof bytes; cut++) {
		checksum cut_up = { 0 };
		checksum_add(&cut_up, bytes, cut / 3);
		checksum_add(&cut_up, bytes + cut / 3, cut - cut / 3);
		checksum_add(&cut_up, bytes + cut, sizeof bytes - cut);
		assert_true(checksum_value(&cut_up) == checksum_value(&whole));
	}
	for (size_t bit = 0; bit < 8 * sizeof bytes; bit++) {
		checksum other = { 0 };
		bytes[bit / 8] ^= (uint8_t)(1u << bit % 8);
		checksum_add(&other, bytes, sizeof bytes);
		assert_true(checksum_value(&other) != checksum_value(&whole));
		bytes[bit / 8] ^= (uint8_t)(1u << bit % 8);
	}
}

static journal_file *open_journal(void)
{
	gw_error error;
	journal_file *journal;
	assert_ok(journal_file_open(&journal, "journal", true, true, &error), &error);
	return journal;
}

static void put_section(journal_file *journal, const char *tag, const char *text)
{
	gw_error error;
	bool there;
	assert_ok(journal_file_begin(journal, tag, &there, &error), &error);
	assert_false(there);
	assert_ok(journal_file_write(journal, text, strlen(text), &error), &error);
	assert_ok(journal_file_end(journal, &error), &error);
}

/* What its reader says of a section: that of journal_file_begin, else of the bytes. */
static gw_status get_section(journal_file *journal, const char *tag, const char *text, bool *there)
{
	gw_error error;
	char got[64] = "";
	gw_status status = journal_file_begin(journal, tag, there, &error);
	if (status != GW_OK || !*there)
		return status;
	status = journal_file_read(journal, got, strlen(text), &error);
	if (status == GW_OK)
		status = journal_file_end(journal, &error);
	assert_true(status != GW_OK || strcmp(got, text) == 0);
	return status;
}

static void write_journal(void)
{
	gw_error error;
	journal_file *journal = open_journal();
	put_section(journal, "one", "what it is");
	put_section(journal, "two", "what was kept");
	assert_ok(journal_file_slots(journal, 4, &error), &error);
	assert_ok(journal_file_put(journal, 2, &(journal_slot){ 7, 8, 9 }, &error), &error);
	journal_file_close(&journal, false);
}

static void reads_what_it_wrote(void **state)
{
	(void)state;
	gw_error error;
	journal_slot slot;
	bool there;
	write_journal();
	journal_file *journal = open_journal(), *other;
	assert_int_equal(get_section(journal, "one", "what it is", &there), GW_OK);
	assert_int_equal(get_section(journal, "two", "what was kept", &there), GW_OK);
	assert_true(there);
	assert_ok(journal_file_slots(journal, 4, &error), &error);
	for (uint64_t part = 0; part < 4; part++)
		assert_int_equal(journal_file_get(journal, part, &slot), part == 2);
	assert_true(journal_file_get(journal, 2, &slot) && slot.offset == 7 && slot.value == 9);
	/* Two owners there are not. */
	assert_int_equal(journal_file_open(&other, "journal", true, true, &error), FILE_ERROR_CREATE);
	assert_null(other);
	journal_file_close(&journal, true);
	assert_int_equal(access("journal", F_OK), -1);
}

/* Reads all of it; what is said of it before is the same. */
static gw_status read_journal(bool there[2], unsigned *slots)
{
	gw_error error;
	journal_slot slot;
	journal_file *journal = open_journal();
	const char *const tag[] = { "one", "two" };
	gw_status checked = journal_file_check(journal, tag, 2, &error);
	*slots = 0;
	there[1] = false;
	gw_status status = get_section(journal, "one", "what it is", &there[0]);
	if (status == GW_OK && there[0])
		status = get_section(journal, "two", "what was kept", &there[1]);
	assert_int_equal(checked, status);
	if (status == GW_OK && there[1]) {
		assert_ok(journal_file_slots(journal, 4, &error), &error);
		for (uint64_t part = 0; part < 4; part++)
			*slots += journal_file_get(journal, part, &slot);
	}
	journal_file_close(&journal, false);
	return status;
}

/* Each byte that is another is noticed, or is one that nothing was written to. */
static void notices_damage(void **state)
{
	(void)state;
	struct stat info;
	bool there[2];
	unsigned slots, noticed = 0;
	write_journal();
	assert_int_equal(stat("journal", &info), 0);
	int file = open("journal", O_RDWR);
	for (off_t at = 0; at < info.st_size; at++) {
		uint8_t byte, other;
		assert_int_equal(pread(file, &byte, 1, at), 1);
		other = byte ^ 0x10;
		assert_int_equal(pwrite(file, &other, 1, at), 1);
		gw_status status = read_journal(there, &slots);
		assert_true(status == GW_OK || status == GW_ERROR_DATA);
		noticed += status == GW_ERROR_DATA || slots == 0;
		assert_int_equal(pwrite(file, &byte, 1, at), 1);
	}
	/* Two heads of 32 bytes, texts of 10 and 13, a slot of 32. */
	assert_int_equal(noticed, 2 * 32 + 10 + 13 + 32);
	close(file);
	assert_int_equal(read_journal(there, &slots), GW_OK);
	assert_int_equal(slots, 1);
	unlink("journal");
}

/* Wherever a write ended, the rest is read or begun again. */
static void goes_on_after_torn_writes(void **state)
{
	(void)state;
	struct stat info;
	unsigned slots, whole = 0, torn = 0;
	write_journal();
	assert_int_equal(stat("journal", &info), 0);
	unlink("journal");
	for (off_t length = 0; length <= info.st_size; length += 4) {
		bool there[2];
		write_journal();
		assert_int_equal(truncate("journal", length), 0);
		/* A head is written by one write within a sector, when its bytes are there. */
		gw_status status = read_journal(there, &slots);
		whole += status == GW_OK && slots == 1;
		torn += status == GW_OK && slots == 0;
		unlink("journal");
	}
	/* From the end of the slot on, of which the last of the four is missing; at length 0 nothing
	 * is there, and between the sections and without the slot there is what is there. */
	assert_int_equal(whole, 1 + 32 / 4);
	assert_true(torn > 100);
}

/* Bytes at their places, in any order, by two who write; and what of them is not there. */
static void parts_in_place(void **state)
{
	(void)state;
	gw_error error;
	checksum sum;
	output_file *one, *other;
	assert_ok(output_file_create_lasting(&one, "result", false, true, &error), &error);
	assert_ok(output_file_create_lasting(&other, "result", false, true, &error), &error);
	assert_ok(output_file_resize(one, 8, &error), &error);
	assert_ok(output_file_seek(one, 4, &error), &error);
	assert_ok(output_file_write(one, "last", 4, &error), &error);
	assert_ok(output_file_written(one, &sum, &error), &error);
	assert_true(output_file_holds(other, 4, 4, checksum_value(&sum)));
	assert_false(output_file_holds(other, 3, 4, checksum_value(&sum)));
	assert_false(output_file_holds(other, 4, 5, checksum_value(&sum)));
	assert_ok(output_file_seek(other, 0, &error), &error);
	assert_ok(output_file_write(other, "head", 4, &error), &error);
	assert_ok(output_file_written(other, &sum, &error), &error);
	output_file_leave(&other);
	output_file_abandon(&one);
	assert_ok(output_file_create_lasting(&one, "result", false, false, &error), &error);
	assert_true(output_file_holds(one, 0, 4, checksum_value(&sum)));
	assert_ok(output_file_commit(&one, &error), &error);
	char text[9] = "";
	FILE *file = fopen("result", "r");
	assert_non_null(file);
	assert_int_equal(fread(text, 1, 8, file), 8);
	assert_string_equal(text, "headlast");
	fclose(file);
	assert_int_equal(access("result" OUTPUT_FILE_PART, F_OK), -1);
	assert_int_equal(output_file_create_lasting(&one, "/dev/null", true, true, &error),
					 FILE_ERROR_CREATE);
	unlink("result");
}

/* --------------------------------------------------------------------------- what is kept there */

/* Bytes in memory; reading ends where they do. */
typedef struct bytes {
	uint8_t data[1 << 18];
	size_t length, at;
} bytes;

static gw_status put(void *user, const void *from, size_t length, gw_error *error)
{
	bytes *b = user;
	(void)error;
	assert_true(length <= sizeof b->data - b->length);
	memcpy(b->data + b->length, from, length);
	b->length += length;
	return GW_OK;
}

static gw_status get(void *user, void *to, size_t length, gw_error *error)
{
	bytes *b = user;
	if (length > b->length - b->at)
		return gw_fail(error, GW_ERROR_DATA, "it ends");
	memcpy(to, b->data + b->at, length);
	b->at += length;
	return GW_OK;
}

static void scans_come_back(void **state)
{
	(void)state;
	static bytes b;
	gw_error error;
	const double place[3] = { 1, 2, 3 }, other[3] = { 4, 5, 6 };
	scan cloud = { .count = 3, .up = 'y', .says_up = true, .noise_classes = 5 }, back;
	memcpy(scan_add_column(&cloud, "x", SCAN_FLOAT64, &error)->data, (double[]){ 1.5, 2, 3 }, 24);
	memcpy(scan_add_column(&cloud, "red", SCAN_UINT8, &error)->data, "abc", 3);
	assert_ok(scan_add_comment(&cloud, "made by hand", &error), &error);
	assert_ok(scan_add_scanner(&cloud, place, 0, 3, &error), &error);
	assert_ok(scan_bytes_save(&cloud, &(gw_byte_sink){ put, &b }, &error), &error);
	assert_ok(scan_bytes_load(&(gw_byte_source){ get, &b }, &back, &error), &error);
	assert_true(back.scanner_count == 1 && back.scanner[2] == 3.0 && !back.scanner_of);
	scan_clear(&back);
	b.length = b.at = 0;
	assert_ok(scan_add_scanner(&cloud, other, 2, 1, &error), &error);
	assert_ok(scan_bytes_save(&cloud, &(gw_byte_sink){ put, &b }, &error), &error);
	assert_ok(scan_bytes_load(&(gw_byte_source){ get, &b }, &back, &error), &error);
	assert_int_equal(b.at, b.length);
	assert_true(back.count == 3 && back.up == 'y' && back.says_up && back.noise_classes == 5);
	assert_true(scan_value(scan_find(&back, "x"), 0) == 1.5);
	assert_true(scan_value(scan_find(&back, "red"), 2) == 'c');
	assert_string_equal(back.comment[0], "made by hand");
	assert_true(back.scanner_count == 2 && back.scanner[5] == 6.0);
	assert_true(back.scanner_of && back.scanner_of[1] == 0 && back.scanner_of[2] == 1);
	scan_clear(&back);
	for (size_t whole = b.length; b.length > 0; b.length = b.length * 2 / 3) {
		b.at = 0;
		gw_status status = scan_bytes_load(&(gw_byte_source){ get, &b }, &back, &error);
		assert_int_equal(status, b.length == whole ? GW_OK : GW_ERROR_DATA);
		scan_clear(&back);
	}
	scan_clear(&cloud);
}

/* A floor under a lamp, with all that can be asked for. */
static gw_bake_result *lit_floor(void)
{
	enum { SIDE = 20 };
	static double position[3 * SIDE * SIDE];
	static float normal[3 * SIDE * SIDE];
	gw_error error;
	gw_bake_result *result;
	gw_bake_options options = gw_bake_options_default();
	const gw_light lamp = { .type = GW_LIGHT_POINT,
							.position = { 0.5, 0.5, 1 },
							.intensity = { 1, 2, 3 } };
	for (size_t i = 0; i < SIDE * SIDE; i++) {
		position[3 * i] = 0.05 * (double)(i % SIDE);
		position[3 * i + 1] = 0.05 * (double)(i / SIDE);
		normal[3 * i + 2] = 1.0f;
	}
	const gw_points points = { .count = SIDE * SIDE, .position = position, .normal = normal };
	const gw_scene_description scene = { &points, &lamp, 1 };
	options.rays = 4;
	options.lamps = options.ambient_occlusion = options.bent_normals = true;
	assert_ok(gw_bake(&scene, &options, NULL, &result, &error), &error);
	return result;
}

static void light_comes_back(void **state)
{
	(void)state;
	static bytes b, again;
	gw_error error;
	gw_bake_result *result = lit_floor(), *back;
	assert_ok(gw_bake_result_save(result, &(gw_byte_sink){ put, &b }, &error), &error);
	assert_ok(gw_bake_result_load(&(gw_byte_source){ get, &b }, &back, &error), &error);
	assert_int_equal(b.at, b.length);
	assert_int_equal(back->count, result->count);
	assert_memory_equal(back->radiance, result->radiance, 12 * result->count);
	assert_memory_equal(back->lamp[0], result->lamp[0], 12 * result->count);
	assert_memory_equal(back->bent_normal, result->bent_normal, 12 * result->count);
	assert_null(back->unknown);
	assert_int_equal(back->report.bounce_count, result->report.bounce_count);
	assert_true(back->given[0].share == result->given[0].share);
	assert_ok(gw_bake_result_save(back, &(gw_byte_sink){ put, &again }, &error), &error);
	assert_int_equal(again.length, b.length);
	assert_memory_equal(again.data, b.data, b.length);
	gw_bake_result_destroy(&back);
	for (b.length--; b.length > 1; b.length = b.length * 3 / 4) {
		b.at = 0;
		assert_int_equal(gw_bake_result_load(&(gw_byte_source){ get, &b }, &back, &error),
						 GW_ERROR_DATA);
		assert_null(back);
	}
	gw_bake_result_destroy(&result);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(sums_tell),        cmocka_unit_test(reads_what_it_wrote),
		cmocka_unit_test(notices_damage),   cmocka_unit_test(goes_on_after_torn_writes),
		cmocka_unit_test(parts_in_place),   cmocka_unit_test(scans_come_back),
		cmocka_unit_test(light_comes_back),
	};
	return cmocka_run_group_tests(tests, enter_folder, leave_folder);
}
