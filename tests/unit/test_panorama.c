/* Maps of the sky, as Radiance HDR and OpenEXR, whole and damaged. */
#include "panoramas/panorama.h"
#include "panorama_files.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

#include <cmocka.h>

typedef gw_status (*reader)(const input_file *, panorama *, gw_error *);

typedef struct seed {
	const char *name;
	reader read;
	uint8_t data[PANORAMA_FILE_ROOM];
	size_t length;
	bool grey;
} seed;

enum { SEEDS = 6 };
static seed seeds[SEEDS];

static int make_seeds(void **state)
{
	(void)state;
	seeds[0] = (seed){ .name = "runs", .read = panorama_hdr_read };
	seeds[1] = (seed){ .name = "flat", .read = panorama_hdr_read };
	seeds[2] = (seed){ .name = "exr", .read = panorama_exr_read };
	seeds[3] = (seed){ .name = "grey exr", .read = panorama_exr_read, .grey = true };
	seeds[0].length = panorama_file_hdr(true, seeds[0].data);
	seeds[1].length = panorama_file_hdr(false, seeds[1].data);
	seeds[2].length = panorama_file_exr(false, seeds[2].data);
	seeds[3].length = panorama_file_exr(true, seeds[3].data);
	seeds[4] = (seed){ .name = "tiles", .read = panorama_exr_read };
	seeds[4].length = panorama_file_tiles(seeds[4].data);
	seeds[5] = (seed){ .name = "dwa", .read = panorama_exr_read };
	seeds[5].length = panorama_file_dwa(seeds[5].data);
	return seeds[4].length && seeds[2].length && seeds[3].length ? 0 : -1;
}

/* In memory of exactly that length, so that a sanitizer sees a byte too many. */
static gw_status read_bytes(const seed *s, const void *data, size_t length, panorama *map,
							gw_error *error)
{
	uint8_t *copy = malloc(length + !length);
	assert_non_null(copy);
	memcpy(copy, data, length);
	input_file in = { .name = "seed.file", .data = copy, .length = length };
	gw_status status = s->read(&in, map, error);
	free(copy);
	if (status == GW_OK)
		assert_true(map->pixels && map->width == 2 * map->height);
	else
		assert_true(!map->pixels && map->width == 0 &&
					(status != GW_ERROR_DATA || strstr(error->text, "seed.file")));
	return status;
}

/* Every pixel comes back; HDR keeps 8 bits of the largest component, and reads the middle of a
 * step, so that a value is at most half of 1/128 of the largest off. */
static void pixels_come_back(void **state)
{
	(void)state;
	for (size_t k = 0; k < SEEDS; k++) {
		const seed *s = &seeds[k];
		panorama map;
		gw_error error = { 0 };
		if (read_bytes(s, s->data, s->length, &map, &error) != GW_OK)
			fail_msg("%s: %s", s->name, error.text);
		assert_int_equal(map.width, PANORAMA_FILE_W);
		for (int i = 0; i < PANORAMA_FILE_W * PANORAMA_FILE_H; i++) {
			double expected[3] = { i, 2.0 * i, 0.25 };
			double step = s->read == panorama_hdr_read ? fmax(2.0 * i, 0.25) / 128.0 : 0.0;
			for (int c = 0; c < 3; c++) {
				double is = (double)map.pixels[3 * i + c];
				if (!(fabs(is - expected[s->grey ? 0 : c]) <= 0.5 * step))
					fail_msg("%s, pixel %d, %d: %g", s->name, i, c, is);
			}
		}
		panorama_clear(&map);
	}
}

static void every_truncation_is_refused(void **state)
{
	(void)state;
	for (size_t k = 0; k < SEEDS; k++) {
		for (size_t length = 0; length < seeds[k].length; length++) {
			panorama map;
			gw_error error = { 0 };
			assert_int_equal(read_bytes(&seeds[k], seeds[k].data, length, &map, &error),
							 GW_ERROR_DATA);
		}
	}
}

/* Lets the process have no more than a gigabyte, of which it uses a small part: who allocates what
 * a damaged file claims runs out of memory. Sanitizers reserve far more for themselves. */
static void limit_memory(void)
{
#ifndef __SANITIZE_ADDRESS__
	struct rlimit limit;
	assert_int_equal(getrlimit(RLIMIT_AS, &limit), 0);
	limit.rlim_cur = (rlim_t)1 << 30;
	assert_int_equal(setrlimit(RLIMIT_AS, &limit), 0);
#endif
}

/* One byte at a time is replaced by others: read or refused, never more. */
static void damaged_bytes_do_no_harm(void **state)
{
	(void)state;
	limit_memory();
	static const uint8_t values[] = { 0, 1, 2, 127, 128, 129, 255, '\n', '9' };
	size_t refused = 0, accepted = 0;
	for (size_t k = 0; k < SEEDS; k++) {
		for (size_t at = 0; at < seeds[k].length; at++) {
			for (size_t v = 0; v < sizeof values; v++) {
				seed damaged = seeds[k];
				damaged.data[at] = values[v];
				panorama map;
				gw_error error = { 0 };
				gw_status status = read_bytes(&damaged, damaged.data, damaged.length, &map, &error);
				assert_int_not_equal(status, GW_ERROR_MEMORY);
				accepted += status == GW_OK;
				refused += status != GW_OK;
				panorama_clear(&map);
			}
		}
	}
	assert_true(accepted > 100 && refused > 100);
}

/* What a header may not say, and what the sentence tells. */
static void headers_are_checked(void **state)
{
	(void)state;
	static const struct {
		const char *text, *tells;
	} rows[] = {
		{ "#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 8 +X 16\n", "32-bit_rle_rgbe" },
		{ "#?RADIANCE\nEXPOSURE=0\n\n-Y 8 +X 16\n", "exposure" },
		{ "#?RADIANCE\n\n+Y 8 +X 16\n", "rows from the top" },
		{ "#?RADIANCE\n\n-Y 8 +X 17\n", "twice as wide" },
		{ "#?RADIANCE\n\n-Y 16384 +X 32768\n", "more than 16384 x 8192" },
		{ "#?RADIANCE\n\n-Y 8192 +X 16384\n1234", "cannot hold" },
		{ "#?RADIANCE\n\n-Y 4 +X 8\n\001\001\001\003 123456789", "before 1991" },
		{ "#?RADIANCE\n", "no end" },
	};
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
		panorama map;
		gw_error error = { 0 };
		assert_int_equal(read_bytes(&seeds[0], rows[i].text, strlen(rows[i].text), &map, &error),
						 GW_ERROR_DATA);
		if (!strstr(error.text, rows[i].tells))
			fail_msg("'%s' does not tell '%s'", error.text, rows[i].tells);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(pixels_come_back),
		cmocka_unit_test(every_truncation_is_refused),
		cmocka_unit_test(damaged_bytes_do_no_harm),
		cmocka_unit_test(headers_are_checked),
	};
	return cmocka_run_group_tests(tests, make_seeds, NULL);
}
