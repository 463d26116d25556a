/*
 * test_gpu.c - the device layer: copies, passes in slices and windows, refusals, and whether the
 * validation layer reports faults that are planted here.
 *
 * Integers from the device are compared exactly; so are floats, which all stay below 2^24 here.
 */
#include "device/gpu_internal.h"
#include "expected.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static gw_buffer new_buffer(gw_gpu *gpu, uint64_t bytes, const char *name)
{
	gw_error error = { 0 };
	gw_buffer buffer;
	assert_ok(gw_buffer_create(
				  gpu,
				  &(gw_buffer_description){ GW_BUFFER_STORAGE, VK_FORMAT_UNDEFINED, bytes, name },
				  &buffer, &error),
			  &error);
	return buffer;
}

static gw_pass *new_pass(gw_gpu *gpu, const char *shader_name, gw_pass_description description)
{
	gw_error error = { 0 };
	const gw_shader *shader = gw_shader_find(shader_name);
	description.name = shader_name;
	description.spirv = shader->spirv;
	description.spirv_words = shader->words;
	gw_pass *pass = NULL;
	assert_ok(gw_pass_create(gpu, &description, &pass, &error), &error);
	return pass;
}

static const gw_binding_kind two_buffers[] = { GW_BIND_STORAGE, GW_BIND_STORAGE };

/* A number for element i that has nothing to do with i's low bits. */
static uint32_t scramble(uint32_t i)
{
	return i * 2654435761u ^ i >> 7;
}

/* ------------------------------------------------------------------------------- devices */

static void test_devices(void **state)
{
	(void)state;
	gw_device_info *devices;
	size_t count;
	gw_error error = { 0 };
	assert_ok(gw_devices(&devices, &count, &error), &error);
	static const char *const order[] = { "discrete", "integrated", "virtual", "cpu", "other" };
	size_t rank = 0;
	for (size_t i = 0; i < count; i++) {
		size_t own = 0;
		while (own < 5 && strcmp(order[own], devices[i].type) != 0)
			own++;
		assert_in_range(own, rank, 4); /* never better than the one before */
		rank = own;
		assert_true(devices[i].usable == (devices[i].missing[0] == '\0'));
	}
	free(devices);
}

static gw_candidate candidate(const char *name, const char *type, bool usable)
{
	gw_candidate made = { 0 };
	snprintf(made.info.name, sizeof made.info.name, "%s", name);
	made.info.type = type;
	made.info.usable = usable;
	snprintf(made.info.missing, sizeof made.info.missing, "%s", usable ? "" : "Vulkan 1.2");
	return made;
}

static void test_choice(void **state)
{
	(void)state;
	gw_candidate list[] = { candidate("Old 4090", "discrete", false),
							candidate("Radiant 900", "discrete", true),
							candidate("Pipe (LLVM)", "cpu", true) };
	const struct {
		const char *wanted;
		int expected; /* -1: none */
	} row[] = { { NULL, 1 },   { "", 1 },     { "2", 2 },          { "cpu", 2 },   { "CPU", 2 },
				{ "llvm", 2 }, { "900", 1 },  { "discrete", 1 },   { "4090", -1 }, { "0", -1 },
				{ "3", -1 },   { "nix", -1 }, { "integrated", -1 } };
	for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
		gw_candidate chosen;
		gw_error error = { 0 };
		gw_status status = gw_candidate_choose(list, 3, row[i].wanted, &chosen, &error);
		if (row[i].expected >= 0) {
			assert_int_equal(status, GW_OK);
			assert_string_equal(chosen.info.name, list[row[i].expected].info.name);
		} else {
			assert_int_equal(status, GW_ERROR_NO_DEVICE);
			assert_non_null(strstr(error.text, "1 \"Radiant 900\" (discrete)"));
			assert_non_null(strstr(error.text, "lacks Vulkan 1.2"));
		}
	}
	gw_error error = { 0 };
	gw_candidate chosen;
	assert_int_equal(gw_candidate_choose(NULL, 0, NULL, &chosen, &error), GW_ERROR_NO_DEVICE);
	assert_non_null(strstr(error.text, "install"));
}

/* -------------------------------------------------------------------------------- copies */

/* What went to the device and back so far. */
static void assert_moved(gw_gpu *gpu, uint64_t uploaded, uint64_t downloaded)
{
	gw_gpu_account account = gw_gpu_read_account(gpu);
	assert_int_equal(account.uploaded_bytes, uploaded);
	assert_int_equal(account.downloaded_bytes, downloaded);
}

/* More than two staging buffers of 16 MiB, and not a multiple of them. */
#define COPY_WORDS (9u * 1024 * 1024 + 13)

static void copy_both_ways(bool may_map)
{
	gw_gpu *gpu = open_gpu((gw_gpu_options){ .validate = true });
	gpu->may_map = may_map;
	gw_error error = { 0 };
	gw_buffer buffer = new_buffer(gpu, COPY_WORDS * UINT64_C(4), "copied");
	uint32_t *sent = malloc(COPY_WORDS * sizeof *sent), *got = malloc(COPY_WORDS * sizeof *got);
	assert_true(sent != NULL && got != NULL);

	assert_ok(gw_buffer_download(gpu, &buffer, 0, got, COPY_WORDS * UINT64_C(4), &error), &error);
	for (uint32_t i = 0; i < COPY_WORDS; i++)
		if (got[i] != 0)
			fail_msg("word %u of a new buffer is %u", i, got[i]);

	/* All but three words at either end, which must stay what the fill made them. */
	for (uint32_t i = 0; i < COPY_WORDS; i++)
		sent[i] = i < 3 || i >= COPY_WORDS - 3 ? 0xdeadbeefu : scramble(i);
	assert_ok(gw_buffer_fill(gpu, &buffer, 0xdeadbeefu, &error), &error);
	assert_ok(gw_buffer_upload(gpu, &buffer, 12, sent + 3, (COPY_WORDS - 6) * UINT64_C(4), &error),
			  &error);
	assert_ok(gw_buffer_download(gpu, &buffer, 0, got, COPY_WORDS * UINT64_C(4), &error), &error);
	assert_memory_equal(sent, got, COPY_WORDS * sizeof *sent);

	/* Past the end: refused, also when offset + bytes wraps around. */
	assert_int_equal(gw_buffer_upload(gpu, &buffer, COPY_WORDS * UINT64_C(4), sent, 4, &error),
					 GW_ERROR_INTERNAL);
	assert_int_equal(gw_buffer_download(gpu, &buffer, 4, got, UINT64_MAX - 3, &error),
					 GW_ERROR_INTERNAL);
	assert_moved(gpu, (COPY_WORDS - 6) * UINT64_C(4), COPY_WORDS * UINT64_C(8));
	free(sent);
	free(got);
	gw_buffer_destroy(gpu, &buffer);
	assert_int_equal(gw_gpu_validation_messages(gpu, NULL), 0);
	gw_gpu_destroy(&gpu);
}

static void test_copies_mapped(void **state)
{
	(void)state;
	copy_both_ways(true);
}

static void test_copies_staged(void **state)
{
	(void)state;
	copy_both_ways(false);
}

/* The bytes themselves where they lie in the processor's memory, else a copy. */
static void look_at_view(bool may_map)
{
	gw_gpu *gpu = open_gpu((gw_gpu_options){ .validate = true });
	gpu->may_map = may_map;
	gw_error error = { 0 };
	gw_buffer buffer = new_buffer(gpu, 1600, "viewed");
	uint32_t sent[400];
	for (uint32_t i = 0; i < 400; i++)
		sent[i] = scramble(i);
	assert_ok(gw_buffer_upload(gpu, &buffer, 0, sent, 1600, &error), &error);
	gw_view view;
	assert_ok(gw_view_open(gpu, &buffer, 1600, &view, &error), &error);
	assert_memory_equal(view.bytes, sent, 1600);
	assert_true((view.copy == NULL) == gw_gpu_shares_memory(gpu));
	assert_true(may_map || !gw_gpu_shares_memory(gpu));
	gw_view_close(&view);
	assert_null(view.bytes);
	gw_view_close(&view);
	assert_int_not_equal(gw_view_open(gpu, &buffer, 1604, &view, &error), GW_OK);
	gw_view_close(&view);
	/* In place or copied, it counts the same. */
	assert_moved(gpu, 1600, 1600);
	gw_buffer_destroy(gpu, &buffer);
	gw_gpu_destroy(&gpu);
}

static void test_views(void **state)
{
	(void)state;
	look_at_view(true);
	look_at_view(false);
}

/* Written to in place or through a copy, it is the buffer's in the end, if it was changed. */
static void look_at_edit(bool may_map)
{
	gw_gpu *gpu = open_gpu((gw_gpu_options){ .validate = true });
	gpu->may_map = may_map;
	gw_error error = { 0 };
	gw_buffer buffer = new_buffer(gpu, 1600, "edited");
	for (uint32_t round = 0; round < 2; round++) {
		gw_edit edit;
		uint32_t got[400];
		assert_ok(gw_edit_open(gpu, &buffer, &edit, &error), &error);
		assert_true((edit.copy == NULL) == gw_gpu_shares_memory(gpu));
		uint32_t *word = edit.bytes;
		assert_int_equal(word[399], round == 0 ? 0 : scramble(399));
		for (uint32_t i = 0; i < 400 && round == 0; i++)
			word[i] = scramble(i);
		assert_ok(gw_edit_close(gpu, &edit, round == 0, &error), &error);
		assert_null(edit.bytes);
		assert_ok(gw_edit_close(gpu, &edit, true, &error), &error);
		assert_ok(gw_buffer_download(gpu, &buffer, 0, got, sizeof got, &error), &error);
		for (uint32_t i = 0; i < 400; i++)
			assert_int_equal(got[i], scramble(i));
	}
	/* Opened twice, changed once, read back twice. */
	assert_moved(gpu, sizeof(uint32_t[400]), 4 * sizeof(uint32_t[400]));
	gw_buffer_destroy(gpu, &buffer);
	gw_gpu_destroy(&gpu);
}

static void test_edits(void **state)
{
	(void)state;
	look_at_edit(true);
	look_at_edit(false);
}

static void test_empty_buffer(void **state)
{
	(void)state;
	gw_gpu *gpu = open_gpu((gw_gpu_options){ .validate = true });
	gw_error error = { 0 };
	gw_buffer buffer;
	assert_ok(gw_buffer_create(gpu,
							   &(gw_buffer_description){
								   GW_BUFFER_TEXEL, VK_FORMAT_R32G32B32A32_SFLOAT, 0, "empty" },
							   &buffer, &error),
			  &error);
	assert_int_equal(buffer.bytes, 0);
	assert_true(buffer.handle != VK_NULL_HANDLE && buffer.allocated > 0);
	gw_buffer_destroy(gpu, &buffer);
	gw_buffer_destroy(gpu, &buffer); /* a zeroed one is accepted */
	assert_int_equal(gw_gpu_read_account(gpu).bytes, 0);
	assert_true(gw_gpu_read_account(gpu).peak_bytes > 0);
	gw_gpu_destroy(&gpu);
	gw_gpu_destroy(&gpu);
}

/* A pass reads what lies in memory of the test itself, which stays as it is. */
static void test_borrowed(void **state)
{
	(void)state;
	enum { WORDS = 3 * GW_LENT_ALIGNMENT / 4 - 5, BYTES = 3 * GW_LENT_ALIGNMENT };
	gw_gpu *gpu = open_gpu((gw_gpu_options){ .validate = true });
	gw_error error = { 0 };
	uint32_t *word = aligned_alloc(GW_LENT_ALIGNMENT, BYTES), got[WORDS];
	assert_non_null(word);
	assert_false(gw_buffer_may_borrow(gpu, word + 1));
	if (!gw_buffer_may_borrow(gpu, word)) {
		assert_false(gpu->imports && gw_gpu_shares_memory(gpu));
		free(word);
		gw_gpu_destroy(&gpu);
		skip();
	}
	for (uint32_t i = 0; i < BYTES / 4; i++)
		word[i] = scramble(i);
	gw_buffer in, out = new_buffer(gpu, UINT64_C(4) * WORDS, "out");
	assert_ok(gw_buffer_borrow(gpu,
							   &(gw_buffer_description){ GW_BUFFER_TEXEL, VK_FORMAT_R32_UINT,
														 4 * WORDS, "lent" },
							   word, false, &in, &error),
			  &error);
	assert_ptr_equal(in.mapped, word);
	gw_pass *pass = new_pass(gpu, "test_affine",
							 (gw_pass_description){ .bindings = two_buffers,
													.binding_count = 2,
													.push_bytes = 12,
													.constant = (uint32_t[]){ 3, 1 },
													.constant_count = 2 });
	const gw_binding bindings[] = { { .buffer = &in }, { .buffer = &out } };
	assert_ok(gw_pass_run(gpu, pass, bindings, (uint32_t[]){ 0, 0, 5 }, WORDS, &error), &error);
	assert_ok(gw_buffer_download(gpu, &out, 0, got, sizeof got, &error), &error);
	for (uint32_t i = 0; i < WORDS; i++)
		assert_int_equal(got[i], word[i] * 3 + i + 5);
	assert_ok(gw_buffer_download(gpu, &in, 0, got, sizeof got, &error), &error);
	assert_memory_equal(got, word, sizeof got);
	gw_edit edit; /* in memory of the buffer's own */
	assert_ok(gw_edit_open(gpu, &in, &edit, &error), &error);
	assert_false(in.lent);
	assert_ptr_not_equal(in.mapped, word);
	memset(edit.bytes, 0, 4);
	assert_ok(gw_edit_close(gpu, &edit, true, &error), &error);
	assert_ok(gw_pass_run(gpu, pass, bindings, (uint32_t[]){ 0, 0, 5 }, WORDS, &error), &error);
	assert_ok(gw_buffer_download(gpu, &out, 0, got, sizeof got, &error), &error);
	for (uint32_t i = 0; i < WORDS; i++)
		assert_int_equal(got[i], (i > 0 ? word[i] * 3 : 0) + i + 5);
	gw_buffer_destroy(gpu, &in);
	/* Of what may vanish, the driver reads a copy. */
	assert_ok(gw_buffer_borrow(gpu,
							   &(gw_buffer_description){ GW_BUFFER_TEXEL, VK_FORMAT_R32_UINT,
														 4 * WORDS, "fleeting" },
							   word, true, &in, &error),
			  &error);
	assert_ptr_equal(in.mapped, word);
	assert_ok(gw_pass_run(gpu, pass, bindings, (uint32_t[]){ 0, 0, 5 }, WORDS, &error), &error);
	assert_false(in.lent || in.fleeting);
	assert_ptr_not_equal(in.mapped, word);
	assert_ok(gw_buffer_download(gpu, &out, 0, got, sizeof got, &error), &error);
	for (uint32_t i = 0; i < WORDS; i++)
		assert_int_equal(got[i], word[i] * 3 + i + 5);
	gw_pass_destroy(gpu, &pass);
	gw_buffer_destroy(gpu, &in);
	gw_buffer_destroy(gpu, &out);
	assert_int_equal(gw_gpu_read_account(gpu).bytes, 0);
	for (uint32_t i = 0; i < BYTES / 4; i++)
		assert_int_equal(word[i], scramble(i));
	free(word);
	gw_gpu_destroy(&gpu);
}

/* -------------------------------------------------------------------------------- passes */

/* Not a multiple of any workgroup; many slices at the window below. */
#define ELEMENTS 100003u
#define WINDOW_BYTES 16384u

/* Runs out = 3 * in + i + 5 under the given circumstances and checks every word. Returns the
 * number of dispatches. */
static uint64_t run_affine(gw_gpu_options options, uint32_t each, uint64_t storage_range)
{
	gw_gpu *gpu = open_gpu(options);
	if (storage_range > 0)
		gpu->storage_range = storage_range;
	gw_error error = { 0 };
	gw_buffer in = new_buffer(gpu, ELEMENTS * 4, "in"), out = new_buffer(gpu, ELEMENTS * 4, "out");
	static uint32_t word[ELEMENTS];
	for (uint32_t i = 0; i < ELEMENTS; i++)
		word[i] = scramble(i);
	assert_ok(gw_buffer_upload(gpu, &in, 0, word, sizeof word, &error), &error);

	gw_pass *pass = new_pass(gpu, "test_affine",
							 (gw_pass_description){ .bindings = two_buffers,
													.binding_count = 2,
													.push_bytes = 12,
													.constant = (uint32_t[]){ 3, each },
													.constant_count = 2,
													.elements_per_invocation = each });
	if (options.workgroup_size > 0)
		assert_int_equal(gw_pass_workgroup_size(pass), options.workgroup_size);
	const gw_binding bindings[] = { { .buffer = &in, .stride = 4 },
									{ .buffer = &out, .stride = 4 } };
	const uint32_t push[] = { 77, 77, 5 }; /* the span is filled by the layer */
	assert_ok(gw_pass_run(gpu, pass, bindings, push, 0, &error), &error);
	assert_int_equal(gw_gpu_read_account(gpu).dispatches, 0);
	assert_ok(gw_pass_run(gpu, pass, bindings, push, ELEMENTS, &error), &error);

	static uint32_t got[ELEMENTS];
	assert_ok(gw_buffer_download(gpu, &out, 0, got, sizeof got, &error), &error);
	for (uint32_t i = 0; i < ELEMENTS; i++)
		if (got[i] != word[i] * 3 + i + 5)
			fail_msg("element %u is %u, not %u", i, got[i], word[i] * 3 + i + 5);
	gw_gpu_account account = gw_gpu_read_account(gpu);
	assert_true(account.device_seconds > 0 && account.compile_seconds > 0);
	assert_true(account.submissions > 0);
	const char *first;
	if (gw_gpu_validation_messages(gpu, &first) != 0)
		fail_msg("%s", first);
	gw_pass_destroy(gpu, &pass);
	gw_buffer_destroy(gpu, &in);
	gw_buffer_destroy(gpu, &out);
	gw_gpu_destroy(&gpu);
	return account.dispatches;
}

static void test_pass_whole(void **state)
{
	(void)state;
	run_affine((gw_gpu_options){ 0 }, 1, 0);
}

static void test_pass_windows(void **state)
{
	(void)state;
	uint64_t least = ELEMENTS * UINT64_C(4) / WINDOW_BYTES;
	assert_true(run_affine((gw_gpu_options){ .validate = true }, 1, WINDOW_BYTES) > least);
	/* 3 elements an invocation: a unit that is no power of two */
	assert_true(run_affine((gw_gpu_options){ .validate = true }, 3, WINDOW_BYTES) > least);
}

static void test_pass_short_slices(void **state)
{
	(void)state;
	/* A target that even one unit of 64 elements misses: slices shrink to it. */
	gw_gpu_options options = { .slice_seconds = 1e-9, .validate = true };
	uint64_t dispatches =
		run_affine(options, 1, 0); /* and submissions: see test_long_runs_stay_apart */
	assert_in_range(dispatches, ELEMENTS / 128, ELEMENTS / 64 + 2);
}

/* A pass that makes 3 * in + i + 5, its two buffers as made by zeros. */
typedef struct chain {
	gw_gpu *gpu;
	gw_buffer a, b;
	gw_pass *pass;
} chain;

#define LINKS 4096u

static chain open_chain(gw_gpu_options options)
{
	chain c = { .gpu = open_gpu(options) };
	c.a = new_buffer(c.gpu, LINKS * 4, "a");
	c.b = new_buffer(c.gpu, LINKS * 4, "b");
	c.pass = new_pass(c.gpu, "test_affine",
					  (gw_pass_description){ .bindings = two_buffers,
											 .binding_count = 2,
											 .push_bytes = 12,
											 .constant = (uint32_t[]){ 3, 1 },
											 .constant_count = 2 });
	return c;
}

/* From a to b, or back. */
static gw_status run_link(chain *c, bool back, gw_error *error)
{
	const gw_binding bindings[] = { { .buffer = back ? &c->b : &c->a, .stride = 4 },
									{ .buffer = back ? &c->a : &c->b, .stride = 4 } };
	return gw_pass_run(c->gpu, c->pass, bindings, (uint32_t[]){ 0, 0, 5 }, LINKS, error);
}

static void close_chain(chain *c)
{
	gw_pass_destroy(c->gpu, &c->pass);
	gw_buffer_destroy(c->gpu, &c->a);
	gw_buffer_destroy(c->gpu, &c->b);
	assert_int_equal(gw_gpu_validation_messages(c->gpu, NULL), 0);
	gw_gpu_destroy(&c->gpu);
}

/* Word i after so many runs from `word` on. */
static uint32_t chained(uint32_t word, uint32_t i, uint32_t runs)
{
	for (uint32_t n = 0; n < runs; n++)
		word = 3 * word + i + 5;
	return word;
}

/* Passes that read what those before wrote, and bytes and zeros between them, make one submission,
 * in which each has a time of its own; whether copies are work of the device or not. */
static void test_chain_is_one_submission(void **state)
{
	(void)state;
	for (int may_map = 0; may_map < 2; may_map++) {
		/* So long that no machine is too busy for it: what is asked for is not what a run takes. */
		chain c = open_chain(
			(gw_gpu_options){ .validate_synchronization = true, .slice_seconds = 1000.0 });
		gw_error error = { 0 };
		uint32_t word[LINKS];
		c.gpu->may_map = may_map == 1;
		assert_ok(run_link(&c, false, &error), &error); /* whose speed is not known */
		gw_gpu_account before = gw_gpu_read_account(c.gpu);
		for (int n = 0; n < 6; n++)
			assert_ok(run_link(&c, n % 2 == 0, &error), &error);
		assert_ok(gw_buffer_upload(c.gpu, &c.b, 8, (uint32_t[]){ 7 }, 4, &error), &error);
		assert_ok(run_link(&c, true, &error), &error);
		assert_ok(gw_buffer_fill(c.gpu, &c.b, 9, &error), &error);
		assert_int_equal(c.gpu->account.submissions, before.submissions);
		assert_ok(gw_buffer_download(c.gpu, &c.a, 0, word, sizeof word, &error), &error);
		gw_gpu_account after = gw_gpu_read_account(c.gpu);
		assert_int_equal(after.submissions, before.submissions + 1);
		assert_int_equal(after.dispatches, before.dispatches + 7);
		double seconds = gw_pass_take_seconds(c.gpu, c.pass);
		assert_true(after.device_seconds > before.device_seconds);
		assert_true(seconds > 0.0 && gw_pass_take_seconds(c.gpu, c.pass) == 0.0);
		for (uint32_t i = 0; i < LINKS; i++)
			assert_int_equal(word[i], i == 2 ? 3 * 7 + i + 5 : chained(0, i, 8));
		assert_ok(gw_buffer_download(c.gpu, &c.b, 0, word, sizeof word, &error), &error);
		for (uint32_t i = 0; i < LINKS; i++)
			assert_int_equal(word[i], 9);
		close_chain(&c);
	}
}

/* Where no time is left for two runs, each is submitted by itself. */
static void test_long_runs_stay_apart(void **state)
{
	(void)state;
	chain c = open_chain((gw_gpu_options){ .slice_seconds = 1000.0, .validate = true });
	gw_error error = { 0 };
	assert_ok(run_link(&c, false, &error), &error);
	assert_ok(gw_gpu_finish(c.gpu, &error), &error);
	/* One run is as long as a submission may be, which is then not asked about again. */
	c.gpu->slice_seconds = 1.5 * gw_pass_take_seconds(c.gpu, c.pass);
	gw_gpu_account before = gw_gpu_read_account(c.gpu);
	for (int n = 0; n < 2; n++)
		assert_ok(run_link(&c, n == 0, &error), &error);
	assert_true(gw_gpu_read_account(c.gpu).submissions >= before.submissions + 2);
	close_chain(&c);
}

/* More runs than a submission has room for, of steps, of descriptor sets and of notes of what they
 * use, give what they should. */
static void test_many_runs(void **state)
{
	(void)state;
	chain c = open_chain((gw_gpu_options){ .slice_seconds = 1000.0, .validate = true });
	gw_error error = { 0 };
	uint32_t word[LINKS];
	for (uint32_t n = 0; n < 3 * GW_STEPS_MAX; n++)
		assert_ok(run_link(&c, n % 2 == 1, &error), &error);
	for (uint32_t n = 0; n < 2 * GW_USES_MAX; n++)
		assert_ok(gw_buffer_upload(c.gpu, &c.b, 0, &n, 4, &error), &error);
	assert_ok(gw_buffer_download(c.gpu, &c.a, 0, word, sizeof word, &error), &error);
	for (uint32_t i = 0; i < LINKS; i++)
		assert_int_equal(word[i], chained(0, i, 3 * GW_STEPS_MAX));
	close_chain(&c);
}

static bool says_yes(void *user)
{
	return *(bool *)user;
}

/* What was asked for before somebody wanted to stop is there for who goes on. */
static void test_stop_keeps_what_was_done(void **state)
{
	(void)state;
	bool stop = false;
	chain c = open_chain((gw_gpu_options){
		.cancelled = says_yes, .user = &stop, .slice_seconds = 1000.0, .validate = true });
	gw_error error = { 0 };
	uint32_t word[LINKS];
	assert_ok(run_link(&c, false, &error), &error);
	assert_ok(run_link(&c, true, &error), &error);
	stop = true;
	assert_int_equal(run_link(&c, false, &error), GW_ERROR_CANCELLED);
	assert_int_equal(gw_buffer_download(c.gpu, &c.a, 0, word, sizeof word, &error),
					 GW_ERROR_CANCELLED);
	stop = false;
	gw_gpu_resume(c.gpu);
	assert_ok(gw_buffer_download(c.gpu, &c.a, 0, word, sizeof word, &error), &error);
	for (uint32_t i = 0; i < LINKS; i++)
		assert_int_equal(word[i], chained(0, i, 2));
	close_chain(&c);
}

static void test_workgroup_sizes(void **state)
{
	(void)state;
	for (uint32_t size = 1; size <= 128; size *= 8)
		run_affine((gw_gpu_options){ .workgroup_size = size, .validate = true }, 1, WINDOW_BYTES);
	run_affine((gw_gpu_options){ .workgroup_size = 128 }, 2, 0);
}

#define SIDE 6u
#define TEXELS (SIDE * SIDE * SIDE)

/* A storage image of floats that a pass fills, a filtered image that is a ramp in x made by a
 * first run of the same pass, and a texel buffer. */
static void test_images(void **state)
{
	(void)state;
	gw_gpu *gpu = open_gpu((gw_gpu_options){ .validate = true });
	gw_error error = { 0 };
	const uint32_t extent[3] = { SIDE, SIDE, SIDE };
	gw_image store, ramp;
	assert_ok(gw_image_create(gpu, VK_FORMAT_R32G32B32A32_SFLOAT, extent, "store", &store, &error),
			  &error);
	assert_ok(gw_image_create(gpu, VK_FORMAT_R32G32B32A32_SFLOAT, extent, "ramp", &ramp, &error),
			  &error);
	gw_buffer words, out = new_buffer(gpu, TEXELS * 4, "out");
	assert_ok(gw_buffer_create(gpu,
							   &(gw_buffer_description){ GW_BUFFER_TEXEL, VK_FORMAT_R32_UINT,
														 TEXELS * 4, "words" },
							   &words, &error),
			  &error);
	uint32_t word[TEXELS];
	for (uint32_t i = 0; i < TEXELS; i++)
		word[i] = 1000 + 7 * i;
	assert_ok(gw_buffer_upload(gpu, &words, 0, word, sizeof word, &error), &error);

	static const gw_binding_kind kinds[] = { GW_BIND_TEXEL, GW_BIND_STORAGE_IMAGE,
											 GW_BIND_SAMPLED_IMAGE, GW_BIND_STORAGE };
	gw_pass *pass =
		new_pass(gpu, "test_gather",
				 (gw_pass_description){ .bindings = kinds, .binding_count = 4, .push_bytes = 12 });
	gw_binding bindings[] = { { .buffer = &words },
							  { .image = &ramp },
							  { .image = &store },
							  { .buffer = &out, .stride = 4 } };
	assert_ok(gw_pass_run(gpu, pass, bindings, (uint32_t[]){ 0, 0, 1 }, TEXELS, &error), &error);
	bindings[1].image = &store;
	bindings[2].image = &ramp;
	assert_ok(gw_pass_run(gpu, pass, bindings, (uint32_t[]){ 0, 0, 1 }, TEXELS, &error), &error);
	assert_ok(gw_pass_run(gpu, pass, bindings, (uint32_t[]){ 0, 0, 0 }, TEXELS, &error), &error);

	float texel[TEXELS * 4], got[TEXELS];
	assert_ok(gw_image_download(gpu, &store, texel, sizeof texel, &error), &error);
	assert_ok(gw_buffer_download(gpu, &out, 0, got, sizeof got, &error), &error);
	for (uint32_t i = 0; i < TEXELS; i++) {
		assert_true(texel[4 * i] == (float)i && texel[4 * i + 1] == 0);
		/* Half way to the next texel in x, which the edge clamps. Filters hold at least 4 bits of
		 * fraction, in which 1/2 is exact; 1e-2 allows for the rounding of coordinates. */
		float sample = (float)i + (i % SIDE < SIDE - 1 ? 0.5f : 0.0f);
		float expected = (float)word[i] + (float)i + sample;
		if (!(got[i] > expected - 1e-2f && got[i] < expected + 1e-2f))
			fail_msg("element %u is %g, not %g", i, (double)got[i], (double)expected);
	}
	assert_int_equal(gw_image_download(gpu, &store, texel, sizeof texel - 4, &error),
					 GW_ERROR_INTERNAL);
	gw_pass_destroy(gpu, &pass);
	gw_image_destroy(gpu, &store);
	gw_image_destroy(gpu, &ramp);
	gw_buffer_destroy(gpu, &words);
	gw_buffer_destroy(gpu, &out);
	assert_int_equal(gw_gpu_validation_messages(gpu, NULL), 0);
	gw_gpu_destroy(&gpu);
}

/* An image whose layers are larger than the staging buffer comes back in blocks of rows. */
static void test_large_image(void **state)
{
	(void)state;
	gw_gpu *gpu = open_gpu((gw_gpu_options){ .validate = true });
	gw_error error = { 0 };
	const uint32_t extent[3] = { 1030, 1021, 2 }; /* 16.8 MB a layer */
	gw_image image;
	assert_ok(gw_image_create(gpu, VK_FORMAT_R32G32B32A32_SFLOAT, extent, "large", &image, &error),
			  &error);
	size_t bytes = (size_t)1030 * 1021 * 2 * 16;
	unsigned char *got = malloc(bytes);
	assert_non_null(got);
	memset(got, 0xff, bytes);
	assert_ok(gw_image_download(gpu, &image, got, bytes, &error), &error);
	for (size_t i = 0; i < bytes; i++)
		if (got[i] != 0)
			fail_msg("byte %zu of a new image is %u", i, got[i]);
	free(got);
	gw_image_destroy(gpu, &image);
	gw_gpu_destroy(&gpu);
}

/* ------------------------------------------------------------------------------ refusals */

static void test_budget(void **state)
{
	(void)state;
	gw_gpu *gpu = open_gpu((gw_gpu_options){ .memory = 1 << 20 });
	gw_error error = { 0 };
	gw_buffer first = new_buffer(gpu, 700000, "first"), second;
	uint64_t before = gw_gpu_read_account(gpu).bytes;
	assert_int_equal(
		gw_buffer_create(
			gpu,
			&(gw_buffer_description){ GW_BUFFER_STORAGE, VK_FORMAT_UNDEFINED, 400000, "second" },
			&second, &error),
		GW_ERROR_MEMORY);
	assert_non_null(strstr(error.text, "400000"));
	assert_non_null(strstr(error.text, "1048576"));
	assert_non_null(strstr(error.text, "\"second\""));
	assert_true(second.handle == VK_NULL_HANDLE && second.bytes == 0);
	assert_int_equal(gw_buffer_create(gpu,
									  &(gw_buffer_description){ GW_BUFFER_TEXEL, VK_FORMAT_R32_UINT,
																UINT64_MAX - 3, "huge" },
									  &second, &error),
					 GW_ERROR_MEMORY);
	gw_image image;
	assert_int_equal(gw_image_create(gpu, VK_FORMAT_R16G16B16A16_SFLOAT, (uint32_t[]){ 64, 64, 64 },
									 "image", &image, &error),
					 GW_ERROR_MEMORY);
	assert_int_equal(gw_image_create(gpu, VK_FORMAT_R16G16B16A16_SFLOAT,
									 (uint32_t[]){ UINT32_MAX, 1, 1 }, "wide", &image, &error),
					 GW_ERROR_MEMORY);
	assert_non_null(strstr(error.text, "4294967295 x 1 x 1"));
	assert_int_equal(gw_gpu_read_account(gpu).bytes, before);
	gw_buffer_destroy(gpu, &first);
	gw_gpu_destroy(&gpu);
}

static void test_refusals(void **state)
{
	(void)state;
	gw_gpu *gpu = open_gpu((gw_gpu_options){ 0 });
	gw_error error = { 0 };
	const gw_shader *shader = gw_shader_find("test_affine");
	gw_pass_description description = { .name = "affine",
										.spirv = shader->spirv,
										.spirv_words = shader->words,
										.bindings = two_buffers,
										.binding_count = 2,
										.push_bytes = 12,
										.loop_bound = 8001 };
	gw_pass *pass = NULL;
	assert_int_equal(gw_pass_create(gpu, &description, &pass, &error), GW_ERROR_INTERNAL);
	assert_non_null(strstr(error.text, "8001"));
	description.loop_bound = 8000;
	description.workgroup_size = 1 << 20;
	assert_int_equal(gw_pass_create(gpu, &description, &pass, &error), GW_ERROR_NO_DEVICE);
	assert_null(pass);
	description.workgroup_size = 0;
	assert_ok(gw_pass_create(gpu, &description, &pass, &error), &error);

	gw_buffer in = new_buffer(gpu, 4096, "in"), out = new_buffer(gpu, 4096, "out");
	gw_binding bindings[] = { { .buffer = &in }, { .buffer = &out, .stride = 4 } };
	assert_int_equal(gw_pass_run(gpu, pass, bindings, NULL, 1025, &error), GW_ERROR_INTERNAL);
	assert_int_equal(gw_pass_run(gpu, pass, bindings, NULL, UINT64_C(1) << 32, &error),
					 GW_ERROR_MEMORY);
	gpu->storage_range = 2048; /* `in` is bound whole */
	assert_int_equal(gw_pass_run(gpu, pass, bindings, NULL, 1024, &error), GW_ERROR_MEMORY);
	assert_non_null(strstr(error.text, "2048"));
	bindings[0].stride = 4;
	assert_ok(gw_pass_run(gpu, pass, bindings, NULL, 1024, &error), &error);
	bindings[0].buffer = NULL;
	assert_int_equal(gw_pass_run(gpu, pass, bindings, NULL, 1024, &error), GW_ERROR_INTERNAL);

	gw_pass_destroy(gpu, &pass);
	gw_buffer_destroy(gpu, &in);
	gw_buffer_destroy(gpu, &out);
	gw_gpu_destroy(&gpu);

	gw_gpu_options odd = { .workgroup_size = 48 };
	assert_int_equal(gw_gpu_create(&odd, &gpu, &error), GW_ERROR_USAGE);
	gw_gpu_options unknown = { .device = "no such device" };
	assert_int_equal(gw_gpu_create(&unknown, &gpu, &error), GW_ERROR_NO_DEVICE);
	assert_null(gpu);
	gw_gpu_options both = { .validate_synchronization = true, .validate_gpu_assisted = true };
	assert_int_equal(gw_gpu_create(&both, &gpu, &error), GW_ERROR_USAGE);
}

static void test_lost_device(void **state)
{
	(void)state;
	gw_gpu *gpu = open_gpu((gw_gpu_options){ 0 });
	gw_error error = { 0 }, later = { 0 };
	gw_buffer buffer = new_buffer(gpu, 64, "buffer"), other;
	gw_status status =
		gw_vulkan_fail(gpu, &error, "vkQueueSubmit(x)", "pass one", VK_ERROR_DEVICE_LOST);
	assert_int_equal(status, GW_ERROR_INTERNAL);
	assert_non_null(strstr(error.text, "vkQueueSubmit for pass one"));
	assert_int_equal(gw_buffer_fill(gpu, &buffer, 1, &later), GW_ERROR_INTERNAL);
	assert_string_equal(later.text, error.text);
	assert_int_equal(gw_buffer_create(gpu,
									  &(gw_buffer_description){ GW_BUFFER_STORAGE,
																VK_FORMAT_UNDEFINED, 64, "other" },
									  &other, &later),
					 GW_ERROR_INTERNAL);
	assert_string_equal(later.text, error.text);
	gw_buffer_destroy(gpu, &buffer);
	gw_gpu_destroy(&gpu);
}

/* ---------------------------------------------------------------------------- validation */

#define FAULT_ELEMENTS 256u

/* Two passes, the second reading what the first wrote, in one submission. */
static uint32_t run_pair(bool barrier)
{
	gw_gpu *gpu = open_gpu((gw_gpu_options){ .validate_synchronization = true });
	gw_error error = { 0 };
	gw_buffer a = new_buffer(gpu, FAULT_ELEMENTS * 4, "a"),
			  b = new_buffer(gpu, FAULT_ELEMENTS * 4, "b"),
			  c = new_buffer(gpu, FAULT_ELEMENTS * 4, "c");
	gw_pass *pass = new_pass(
		gpu, "test_faults",
		(gw_pass_description){ .bindings = two_buffers, .binding_count = 2, .push_bytes = 16 });
	const gw_binding write_b[] = { { .buffer = &a }, { .buffer = &b } },
					 read_b[] = { { .buffer = &b }, { .buffer = &c } };
	const gw_slice first = { 0, FAULT_ELEMENTS, 0 }, second = { 0, FAULT_ELEMENTS, 1 };
	assert_ok(gw_commands_begin(gpu, &error), &error);
	gw_pass_record(gpu, pass, first, write_b, NULL, &error);
	if (barrier)
		gw_commands_barrier(gpu);
	gw_pass_record(gpu, pass, second, read_b, NULL, &error);
	gw_status status = gw_commands_submit(gpu, &error);
	uint32_t messages = gw_gpu_validation_messages(gpu, NULL);
	assert_true(status == GW_OK || messages > 0);
	gw_pass_destroy(gpu, &pass);
	gw_buffer_destroy(gpu, &a);
	gw_buffer_destroy(gpu, &b);
	gw_buffer_destroy(gpu, &c);
	gw_gpu_destroy(&gpu);
	return messages;
}

static void test_missing_barrier_is_reported(void **state)
{
	(void)state;
	assert_int_equal(run_pair(true), 0);
	assert_true(run_pair(false) > 0);
}

/* Slices of one run that read and write the same buffer have barriers between them. */
static void test_slices_are_ordered(void **state)
{
	(void)state;
	gw_gpu *gpu = open_gpu((gw_gpu_options){ .validate_synchronization = true });
	gpu->device.properties.limits.maxComputeWorkGroupCount[0] = 4;
	gw_error error = { 0 };
	gw_buffer both = new_buffer(gpu, 4096 * 4, "both");
	gw_pass *pass = new_pass(
		gpu, "test_faults",
		(gw_pass_description){ .bindings = two_buffers, .binding_count = 2, .push_bytes = 16 });
	const gw_binding bindings[] = { { .buffer = &both }, { .buffer = &both } };
	assert_ok(gw_pass_run(gpu, pass, bindings, NULL, 4096, &error), &error);
	assert_true(gw_gpu_read_account(gpu).dispatches > 2); /* the empty one and several slices */
	assert_int_equal(gw_gpu_validation_messages(gpu, NULL), 0);
	gw_pass_destroy(gpu, &pass);
	gw_buffer_destroy(gpu, &both);
	gw_gpu_destroy(&gpu);
}

/* Reads and writes `read_shift` and `write_shift` elements too far. */
static gw_status run_fault(uint32_t read_shift, uint32_t write_shift, uint32_t *messages)
{
	gw_gpu *gpu = open_gpu((gw_gpu_options){ .validate_gpu_assisted = true });
	gw_error error = { 0 };
	gw_buffer a = new_buffer(gpu, FAULT_ELEMENTS * 4, "a"),
			  b = new_buffer(gpu, FAULT_ELEMENTS * 4, "b");
	gw_pass *pass = new_pass(
		gpu, "test_faults",
		(gw_pass_description){ .bindings = two_buffers, .binding_count = 2, .push_bytes = 16 });
	const gw_binding bindings[] = { { .buffer = &a, .stride = 4 }, { .buffer = &b, .stride = 4 } };
	const uint32_t push[] = { 0, 0, read_shift, write_shift };
	gw_status status = gw_pass_run(gpu, pass, bindings, push, FAULT_ELEMENTS, &error);
	if (status == GW_OK)
		status = gw_gpu_finish(gpu, &error);
	*messages = gw_gpu_validation_messages(gpu, NULL);
	gw_pass_destroy(gpu, &pass);
	gw_buffer_destroy(gpu, &a);
	gw_buffer_destroy(gpu, &b);
	gw_gpu_destroy(&gpu);
	return status;
}

static void test_out_of_bounds_is_reported(void **state)
{
	(void)state;
	uint32_t messages;
	assert_int_equal(run_fault(0, 0, &messages), GW_OK);
	assert_int_equal(messages, 0);
	assert_int_equal(run_fault(1, 0, &messages), GW_ERROR_INTERNAL);
	assert_true(messages > 0);
	assert_int_equal(run_fault(0, 1, &messages), GW_ERROR_INTERNAL);
	assert_true(messages > 0);
}

static void test_clean_passes_are_silent(void **state)
{
	(void)state;
	run_affine((gw_gpu_options){ .validate_synchronization = true }, 1, WINDOW_BYTES);
	run_affine((gw_gpu_options){ .validate_gpu_assisted = true }, 1, WINDOW_BYTES);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_devices),
		cmocka_unit_test(test_choice),
		cmocka_unit_test(test_copies_mapped),
		cmocka_unit_test(test_copies_staged),
		cmocka_unit_test(test_views),
		cmocka_unit_test(test_edits),
		cmocka_unit_test(test_empty_buffer),
		cmocka_unit_test(test_pass_whole),
		cmocka_unit_test(test_pass_windows),
		cmocka_unit_test(test_pass_short_slices),
		cmocka_unit_test(test_chain_is_one_submission),
		cmocka_unit_test(test_long_runs_stay_apart),
		cmocka_unit_test(test_many_runs),
		cmocka_unit_test(test_stop_keeps_what_was_done),
		cmocka_unit_test(test_workgroup_sizes),
		cmocka_unit_test(test_borrowed),
		cmocka_unit_test(test_images),
		cmocka_unit_test(test_large_image),
		cmocka_unit_test(test_budget),
		cmocka_unit_test(test_refusals),
		cmocka_unit_test(test_lost_device),
		cmocka_unit_test(test_missing_barrier_is_reported),
		cmocka_unit_test(test_slices_are_ordered),
		cmocka_unit_test(test_out_of_bounds_is_reported),
		cmocka_unit_test(test_clean_passes_are_silent),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
