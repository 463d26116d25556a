/*
 * Damaged files: every reader gets every truncated length, lies in every count, and some thousands
 * of overwritten windows, each in memory of exactly the file's length, so that a sanitizer sees a
 * byte too many. A reader may accept what it gets or refuse it with a sentence that names the file;
 * it must not crash, leak, or ask for more memory than the file justifies.
 */
#include "cloud_format.h"
#include "counted_memory.h"
#include "mesh.h"
#include "e57_file.h"
#include "e57_format.h"
#include "pcd_format.h"
#include "ply_format.h"
#include "text_formats.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* ---------------------------------------------------------------------------------- seeds */

typedef gw_status (*reader)(input_file *, scan *, gw_error *);

/* A good file that is then damaged. */
typedef struct seed {
	const char *name;
	reader read;
	uint8_t data[4096];
	size_t length;
	size_t header; /* bytes of text with counts in it; 0: a binary count at the start */
	size_t points;
	size_t xml;    /* of E57, which is put into pages and sealed after it is damaged */
	bool open_end; /* nothing in the file says how much there is: cut short it may still be whole */
} seed;

static void put_text(seed *s, const char *text)
{
	memcpy(s->data + s->length, text, strlen(text));
	s->length += strlen(text);
}

static void put_pattern(seed *s, uint64_t pattern, size_t size, bool big)
{
	for (size_t i = 0; i < size; i++)
		s->data[s->length++] = (uint8_t)(pattern >> 8 * (big ? size - 1 - i : i));
}

static void put_float(seed *s, float value, bool big)
{
	uint32_t pattern;
	memcpy(&pattern, &value, sizeof pattern);
	put_pattern(s, pattern, 4, big);
}

/* Elements before and behind the vertices, lists everywhere, types of every size. */
static void make_ply(seed *s, const char *name, const char *encoding)
{
	bool big = strstr(encoding, "big") != NULL, ascii = strcmp(encoding, "ascii") == 0;
	char line[80];
	*s = (seed){ .name = name, .read = ply_read, .points = 12 };
	snprintf(line, sizeof line, "ply\nformat %s 1.0\ncomment seed 7\n", encoding);
	put_text(s, line);
	put_text(s, "obj_info 42\nelement camera 2\nproperty ushort id\nproperty list uchar short v\n"
				"element vertex 12\nproperty float x\nproperty double y\nproperty float z\n"
				"property list uchar int w\nproperty uchar red\nproperty short s16\n"
				"element face 2\nproperty list uchar int vertex_indices\nend_header\n");
	s->header = s->length;
	for (uint64_t i = 0; i < 2; i++) {
		if (ascii) {
			put_text(s, "300 2 -1 5\n");
			continue;
		}
		put_pattern(s, 300, 2, big);
		put_pattern(s, 2, 1, big);
		put_pattern(s, 5, 4, big);
	}
	for (int i = 0; i < 12; i++) {
		if (ascii) {
			snprintf(line, sizeof line, "%d.5 -1.25e2 1e-3 2 7 8 255 -32768\n", i);
			put_text(s, line);
			continue;
		}
		put_float(s, (float)i, big);
		put_pattern(s, 0x40590ccccccccccd, 8, big);
		put_float(s, -1.0f, big);
		put_pattern(s, 2, 1, big);
		put_pattern(s, 0x0000000700000008, 8, big);
		put_pattern(s, 255, 1, big);
		put_pattern(s, 0x8000, 2, big);
	}
	if (ascii)
		put_text(s, "3 0 1 2\n3 0 1 2\n");
	else
		put_text(s, "\001abcd\002abcdefgh");
}

/* As most scanners write it: vertices of one size and nothing else. */
static void make_plain_ply(seed *s)
{
	*s = (seed){ .name = "plain ply", .read = ply_read, .points = 9 };
	put_text(s, "ply\r\nformat binary_little_endian 1.0\r\nelement vertex 9\r\n"
				"property float32 x\r\nproperty float32 y\r\nproperty float32 z\r\n"
				"property uint8 red\r\nproperty uint8 green\r\nproperty uint8 blue\r\n"
				"end_header\r\n");
	s->header = s->length;
	for (int i = 0; i < 9; i++) {
		for (int k = 0; k < 3; k++)
			put_float(s, (float)(i - k), false);
		put_text(s, "rgb");
	}
}

static void make_cloud(seed *s)
{
	*s = (seed){ .name = "cloud", .read = cloud_read, .points = 10 };
	put_pattern(s, 10, 4, false);
	for (int i = 0; i < 10; i++) {
		for (int k = 0; k < 6; k++)
			put_float(s, (float)(i * k), false);
		put_text(s, "rgb");
	}
}

/* Sampled, if it can be, with as few points as a table of the smallest file may hold. */
static gw_status sample_seed(gw_status status, mesh *m, scan *cloud, gw_error *error)
{
	*cloud = (scan){ 0 };
	if (status == GW_OK)
		status = mesh_measure(m, "seed.file", error);
	if (status == GW_OK)
		status = mesh_sample(m, 20, 1, 1, cloud, error);
	mesh_clear(m);
	return status;
}

static gw_status read_obj(input_file *in, scan *cloud, gw_error *error)
{
	mesh m;
	return sample_seed(mesh_obj_read(in, "-", &m, error), &m, cloud, error);
}

static gw_status read_mesh_ply(input_file *in, scan *cloud, gw_error *error)
{
	mesh m;
	return sample_seed(mesh_ply_read(in, &m, error), &m, cloud, error);
}

/* The materials on a triangle. */
static gw_status read_mtl(input_file *in, scan *cloud, gw_error *error)
{
	static const char triangle[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
	input_file obj = { .name = "seed.file",
					   .data = (const uint8_t *)triangle,
					   .length = sizeof triangle - 1 };
	mesh m;
	gw_status status = mesh_obj_read(&obj, "-", &m, error);
	if (status == GW_OK)
		status = mesh_mtl_read(in, &m, error);
	return sample_seed(status, &m, cloud, error);
}

/* Colours, normals, a concave face, indices of both signs, joined lines. */
static void make_obj(seed *s)
{
	*s = (seed){ .name = "obj", .read = read_obj, .open_end = true };
	put_text(s, "# seed\nmtllib \nv 2 1 0 0.1 0.2 0.3\nv 1 1 0 1 1 1\nv 1 2 0 1 1 1\n"
				"v 0 2 0 0 0 0\nv 0 0 0 0 0 1\nv 2 0 0 1e-1 .5 0\nvt 0 0\nvn 0 0 1\n"
				"vn 0 1e2 1\nusemtl red\nf 1 2 3 4 5 6\nf -1/1/-1 -2//2 \\\n -3/1 4\n"
				"f 5//1 6//1 4//2\nl 1 2\nusemtl none\nf 1 2 3\n");
	s->header = s->length;
}

static void make_mtl(seed *s)
{
	*s = (seed){ .name = "mtl", .read = read_mtl, .open_end = true };
	put_text(s, "newmtl red\nKa 0 0 0\nKd 0.5 .25 1\nKe 10 0 1e2\nKs 0.5\nNs 100\n"
				"newmtl a b\nPr 0.5\nNs 9\nmap_Kd x.png\nillum 2\n");
	s->header = s->length;
}

/* Faces before and behind other lists. */
static void make_mesh_ply(seed *s, bool ascii)
{
	*s = (seed){ .name = ascii ? "ascii mesh" : "binary mesh", .read = read_mesh_ply };
	put_text(s, ascii ? "ply\nformat ascii 1.0\n" : "ply\nformat binary_big_endian 1.0\n");
	put_text(s, "element vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
				"property list uchar short w\nproperty float nx\nproperty float ny\n"
				"property float nz\nproperty uchar red\nproperty uchar green\n"
				"property uchar blue\nelement camera 1\nproperty int id\nelement face 3\n"
				"property uchar tag\nproperty list uchar int vertex_indices\n"
				"property list uint float st\nend_header\n");
	s->header = s->length;
	for (int i = 0; i < 5; i++) {
		const float v[7] = { (float)(i % 2), (float)(i / 2), 0, 0, 0, 1, (float)i };
		char line[80];
		snprintf(line, sizeof line, "%d %d 0 1 7 0 0 1 %d 20 30\n", i % 2, i / 2, i);
		if (ascii)
			put_text(s, line);
		for (int k = 0; k < 6 && !ascii; k++) {
			put_float(s, v[k], true);
			if (k == 2)
				put_pattern(s, 0x010007, 3, true);
		}
		if (!ascii)
			put_pattern(s, 0x0a141e, 3, true);
	}
	if (ascii) {
		put_text(s, "9\n1 3 0 1 2 0\n1 4 0 1 3 2 2 0.5 0.25\n2 3 2 3 4 0\n");
		return;
	}
	put_pattern(s, 9, 4, true);
	for (uint64_t f = 0; f < 3; f++) {
		put_pattern(s, 0x0103, 2, true);
		for (uint64_t c = 0; c < 3; c++)
			put_pattern(s, f + c, 4, true);
		put_pattern(s, 0, 4, true);
	}
}

/* Fields of several sizes, packed colours, padding. */
static void make_pcd(seed *s, const char *name, const char *encoding)
{
	char line[80];
	*s = (seed){ .name = name, .read = pcd_read, .points = 7 };
	put_text(s, "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n"
				"FIELDS x y z rgb _ n\nSIZE 4 8 4 4 1 2\nTYPE F F F F U I\nCOUNT 1 1 1 1 3 2\n"
				"WIDTH 7\nHEIGHT 1\nVIEWPOINT 0 0 1 1 0 0 0\nPOINTS 7\n");
	snprintf(line, sizeof line, "DATA %s\n", encoding);
	put_text(s, line);
	s->header = s->length;
	if (strcmp(encoding, "binary_compressed") == 0) {
		/* 189 bytes: the first as it is, 188 like it, in steps back of at most 264. */
		put_pattern(s, 5, 4, false);
		put_pattern(s, 7 * 27, 4, false);
		put_pattern(s, 0x3f00, 2, false);
		put_pattern(s, 7 << 5 | (188 - 2 - 7) << 8, 3, false);
		return;
	}
	for (int i = 0; i < 7; i++) {
		if (strcmp(encoding, "ascii") == 0) {
			snprintf(line, sizeof line, "%d.5 -1.25e2 nan 4.2e6 1 2 3 -32768 7\n", i);
			put_text(s, line);
			continue;
		}
		put_float(s, (float)i, false);
		put_pattern(s, 0x40590ccccccccccd, 8, false);
		put_float(s, -1.0f, false);
		put_text(s, "bgrxabc1234");
	}
}

static void make_tables(seed *pts, seed *ptx, seed *xyz)
{
	char line[80];
	*pts = (seed){ .name = "pts", .read = pts_read, .points = 11 };
	*xyz = (seed){ .name = "xyz", .read = xyz_read, .points = 11, .open_end = true };
	*ptx = (seed){ .name = "ptx", .read = ptx_read, .points = 11 };
	put_text(pts, "11\n");
	pts->header = pts->length;
	put_text(xyz, "# a comment\n# x y z \"a\" red,1\nx;y;z;w;red;green;blue\n");
	put_text(ptx, "4\n3\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
				  "0 1 0 0\n-1 0 0 0\n0 0 1 0\n10 20 30 1\n0 0 0 0.5\n");
	ptx->header = ptx->length;
	for (int i = 0; i < 11; i++) {
		snprintf(line, sizeof line, "%d.5 1e2 -0.001 -77 %d 2 255\r\n", i, i);
		put_text(pts, line);
		put_text(ptx, line);
		for (char *c = line; *c; c++)
			*c = *c == ' ' ? ';' : *c;
		put_text(xyz, line);
	}
}

static void make_e57(seed *s)
{
	*s = (seed){ .name = "e57", .read = e57_read, .points = 6 };
	s->length = e57_file_content(s->data, &s->xml);
	s->header = s->length;
}

enum { SEEDS = 16 };
static seed seeds[SEEDS];

static int make_seeds(void **state)
{
	(void)state;
	make_ply(&seeds[0], "ascii ply", "ascii");
	make_ply(&seeds[1], "little-endian ply", "binary_little_endian");
	make_ply(&seeds[2], "big-endian ply", "binary_big_endian");
	make_plain_ply(&seeds[3]);
	make_cloud(&seeds[4]);
	make_obj(&seeds[5]);
	make_mtl(&seeds[6]);
	make_mesh_ply(&seeds[7], true);
	make_mesh_ply(&seeds[8], false);
	make_pcd(&seeds[9], "ascii pcd", "ascii");
	make_pcd(&seeds[10], "binary pcd", "binary");
	make_pcd(&seeds[11], "compressed pcd", "binary_compressed");
	make_tables(&seeds[12], &seeds[13], &seeds[14]);
	make_e57(&seeds[15]);
	return 0;
}

/* -------------------------------------------------------------------------------- attempts */

/*
 * What a reader may hold at once. A column takes at most 8 bytes for 2 bytes of text; a header's
 * property of 16 bytes or more takes under 160 in tables that double; the constant pays for the
 * rounding up of small blocks.
 */
static size_t allowed(size_t length)
{
	return 16384 + 16 * length;
}

static size_t accepted, refused;

/* Uses every value of a scan, so that a sanitizer sees columns that are too short. */
static double sum_of_all(const scan *cloud)
{
	double sum = 0.0;
	for (size_t c = 0; c < cloud->column_count; c++)
		for (size_t i = 0; i < cloud->count; i++)
			sum += scan_value(&cloud->column[c], i);
	for (size_t c = 0; c < cloud->comment_count; c++)
		sum += (double)strlen(cloud->comment[c]);
	return sum;
}

static gw_status attempt(const seed *s, const void *data, size_t length, const char *what,
						 size_t at)
{
	uint8_t *copy = uncounted_malloc(s->xml ? E57_FILE_PAGES(length) : length + !length);
	if (s->xml)
		length = e57_file_pages(data, length, s->xml, copy);
	else
		memcpy(copy, data, length);
	input_file in = { .name = "seed.file", .data = copy, .length = length };
	scan cloud;
	gw_error error = { 0 };
	counted_memory_reset();
	gw_status status = s->read(&in, &cloud, &error);
	uncounted_free(copy);
	if (status == GW_OK) {
		volatile double sum = sum_of_all(&cloud);
		(void)sum;
		scan_clear(&cloud);
		accepted++;
	} else {
		refused++;
		bool empty = !cloud.column && !cloud.comment && cloud.count == 0;
		if (!empty || (status == GW_ERROR_DATA && !strstr(error.text, "seed.file")))
			fail_msg("%s, %s %zu: bad refusal: '%s'", s->name, what, at, error.text);
	}
	const counted_memory *m = &counted;
	if (m->peak > allowed(length) || m->largest > allowed(length) || m->live != 0)
		fail_msg("%s, %s %zu: took %zu bytes, asked for %zu at once, left %zu", s->name, what, at,
				 m->peak, m->largest, m->live);
	return status;
}

static void seeds_are_good(void **state)
{
	(void)state;
	for (int i = 0; i < SEEDS; i++) {
		const seed *s = &seeds[i];
		assert_true(s->length <= sizeof s->data);
		if (attempt(s, s->data, s->length, "whole", 0) != GW_OK)
			fail_msg("%s was refused", s->name);
	}
}

static void every_truncation(void **state)
{
	(void)state;
	for (int i = 0; i < SEEDS; i++) {
		const seed *s = &seeds[i];
		for (size_t length = 0; length < s->length; length++) {
			gw_status status = attempt(s, s->data, length, "cut to", length);
			/* Nothing reads as a whole scan before its last point is there. */
			assert_true(status == GW_ERROR_DATA || length > s->length - 40 || s->open_end);
		}
	}
}

/* Replaces a number in the header by a lie. */
static void lie(const seed *s, size_t start, size_t end, const char *text)
{
	uint8_t data[sizeof s->data + 32];
	size_t size = strlen(text);
	memcpy(data, s->data, start);
	memcpy(data + start, text, size);
	memcpy(data + start + size, s->data + end, s->length - end);
	attempt(s, data, start + size + s->length - end, "lie at", start);
}

static const char *const lies[] = { "0",
									"1",
									"-1",
									"2147483647",
									"2147483648",
									"4294967295",
									"4294967296",
									"9223372036854775807",
									"9223372036854775808",
									"18446744073709551615",
									"18446744073709551616",
									"1e9",
									"12.0" };

static void every_count_in_a_header_lies(void **state)
{
	(void)state;
	for (int i = 0; i < SEEDS; i++) {
		const seed *s = &seeds[i];
		char more_than_the_file[24];
		snprintf(more_than_the_file, sizeof more_than_the_file, "%zu", s->length + 1);
		for (size_t at = 0; at < s->header; at++) {
			size_t end = at;
			while (end < s->header && s->data[end] >= '0' && s->data[end] <= '9')
				end++;
			if (end == at)
				continue;
			for (size_t l = 0; l < sizeof lies / sizeof *lies; l++)
				lie(s, at, end, lies[l]);
			lie(s, at, end, more_than_the_file);
			at = end;
		}
	}
}

/* The same for numbers in bytes: at every place, in both orders, in 2, 4 and 8 bytes. */
static void every_binary_number_lies(void **state)
{
	(void)state;
	static const uint64_t numbers[] = { 0,          1,          UINT64_MAX, INT32_MAX,
										0x80000000, UINT32_MAX, INT64_MAX,  (uint64_t)1 << 63 };
	for (int i = 0; i < SEEDS; i++) {
		const seed *s = &seeds[i];
		size_t first = s->xml ? 0 : s->header, last = s->xml ? s->xml : s->length;
		for (size_t at = first; at + 8 <= last; at++) {
			for (size_t n = 0; n < 3 * 2 * sizeof numbers / sizeof *numbers; n++) {
				seed damaged = *s;
				damaged.length = at;
				put_pattern(&damaged, numbers[n / 6], (size_t)2 << n % 3, n / 3 % 2);
				attempt(s, damaged.data, s->length, "number at", at);
			}
		}
	}
}

/* For formats with a binary count the one lie that matters most: one more, one less. */
static void cloud_count_must_agree(void **state)
{
	(void)state;
	const seed *s = &seeds[4];
	for (uint64_t count = 0; count < 40; count++) {
		seed damaged = *s;
		damaged.length = 0;
		put_pattern(&damaged, count, 4, false);
		gw_status status = attempt(s, damaged.data, s->length, "count", count);
		assert_int_equal(status, count == s->points ? GW_OK : GW_ERROR_DATA);
	}
}

static uint64_t next_random(uint64_t *seed_of_sequence)
{
	uint64_t r = *seed_of_sequence;
	r ^= r << 13;
	r ^= r >> 7;
	r ^= r << 17;
	return *seed_of_sequence = r;
}

/* Overwrites 1 to 8 bytes with random ones, or with bytes that mean something to a parser. */
static void windows_of_bytes(void **state)
{
	(void)state;
	static const char special[] = "\0\n\r \t-+.e0129#plyv\x7f\x80\xff";
	uint64_t random = 12345;
	for (int i = 0; i < SEEDS; i++) {
		const seed *s = &seeds[i];
		for (size_t turn = 0; turn < 4000; turn++) {
			seed damaged = *s;
			uint64_t r = next_random(&random);
			/* Every other window lies in the header, where there is one. */
			size_t range = turn % 2 && s->header ? s->header : s->length;
			size_t at = (size_t)(r % range), size = 1 + (size_t)(r >> 32) % 8;
			for (size_t k = at; k < at + size && k < s->length; k++) {
				uint64_t pick = next_random(&random);
				damaged.data[k] =
					(uint8_t)(turn % 4 < 2 ? pick : (uint8_t)special[pick % sizeof special]);
			}
			attempt(s, damaged.data, s->length, "window", turn);
		}
	}
	/* The damage reaches the readers in both ways. */
	assert_true(accepted > 100 && refused > 100);
}

/* A header of nothing but properties, elements or comments cannot take much time or memory. */
static void headers_that_swell(void **state)
{
	(void)state;
	static const struct {
		const char *text;
		bool numbered;
	} lines[] = { { "element a 0", false },
				  { "comment", false },
				  { "", false },
				  { "property char ", true },
				  { "property list uchar char ", true } };
	static char text[2 << 20];
	for (size_t l = 0; l < sizeof lines / sizeof *lines; l++) {
		size_t length = (size_t)sprintf(text, "ply\nformat ascii 1.0\nelement vertex 1\n");
		for (size_t i = 0; length + 64 < sizeof text; i++)
			length += lines[l].numbered
						  ? (size_t)sprintf(text + length, "%s%zu\n", lines[l].text, i)
						  : (size_t)sprintf(text + length, "%s\n", lines[l].text);
		assert_int_equal(attempt(&seeds[0], text, length, "swollen", l), GW_ERROR_DATA);
	}
}

/* Every allocation fails once: the reader says so and leaves nothing behind. */
static void memory_runs_out(void **state)
{
	(void)state;
	for (int i = 0; i < SEEDS; i++) {
		const seed *s = &seeds[i];
		long failures = 0;
		for (;; failures++) {
			counted.fail_at = failures;
			gw_status status = attempt(s, s->data, s->length, "allocation", (size_t)failures);
			counted.fail_at = -1;
			if (status == GW_OK)
				break;
			assert_int_equal(status, GW_ERROR_MEMORY);
		}
		/* At least a name and the values of each column. */
		assert_true(failures >= 10);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(seeds_are_good),
		cmocka_unit_test(every_truncation),
		cmocka_unit_test(every_count_in_a_header_lies),
		cmocka_unit_test(every_binary_number_lies),
		cmocka_unit_test(cloud_count_must_agree),
		cmocka_unit_test(windows_of_bytes),
		cmocka_unit_test(headers_that_swell),
		cmocka_unit_test(memory_runs_out),
	};
	return cmocka_run_group_tests(tests, make_seeds, NULL);
}
