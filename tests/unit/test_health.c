/*
 * test_health.c - what `glowworm doctor` makes of what it measured, each judgement both ways, and
 * work in processes of their own that end in every way a process can.
 */
#include "program/child_process.h"
#include "verbs/health.h"
#include "device/shader_needs.h"
#include "expected.h"

#include <math.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#define GIGABYTE (UINT64_C(1) << 30)

/* The verdict of the one item that a judgement adds. */
static health_verdict verdict_of(const health *h)
{
	assert_int_equal(h->count, 1);
	return h->item[0].verdict;
}

/* ------------------------------------------------------------------------------ judgements */

static void check_memory(health_memory memory, size_t item, health_verdict expected)
{
	health h = { .count = 0 };
	health_judge_memory(&h, &memory);
	assert_int_equal(h.item[item].verdict, expected);
}

static void judges_memory(void **state)
{
	(void)state;
	check_memory((health_memory){ 8 * GIGABYTE, UINT64_MAX, 0 }, 0, HEALTH_GOOD);
	check_memory((health_memory){ GIGABYTE / 2, UINT64_MAX, 0 }, 0, HEALTH_WARNING);
	check_memory((health_memory){ GIGABYTE / 8, UINT64_MAX, 0 }, 0, HEALTH_BAD);
	check_memory((health_memory){ 0, UINT64_MAX, 0 }, 0, HEALTH_WARNING);
	check_memory((health_memory){ GIGABYTE, UINT64_MAX, 0 }, 1, HEALTH_GOOD);
	check_memory((health_memory){ GIGABYTE, 2 * GIGABYTE, 0 }, 1, HEALTH_WARNING);
	check_memory((health_memory){ GIGABYTE, GIGABYTE / 8, 0 }, 1, HEALTH_BAD);
	check_memory((health_memory){ GIGABYTE, UINT64_MAX, GIGABYTE }, 2, HEALTH_GOOD);
	check_memory((health_memory){ GIGABYTE, UINT64_MAX, GIGABYTE / 16 }, 2, HEALTH_BAD);
}

static void judges_threads(void **state)
{
	(void)state;
	const struct {
		uint32_t started, wanted;
		health_verdict expected;
	} check[] = { { 2, 2, HEALTH_GOOD }, { 1, 2, HEALTH_WARNING }, { 0, 2, HEALTH_BAD } };
	for (size_t i = 0; i < 3; i++) {
		health h = { .count = 0 };
		health_judge_threads(&h, check[i].started, check[i].wanted);
		assert_int_equal(verdict_of(&h), check[i].expected);
	}
}

static void judges_openexr(void **state)
{
	(void)state;
	const struct {
		int version[3];
		health_verdict expected;
	} check[] = { { { 3, 1, 5 }, HEALTH_WARNING },  { { 3, 2, 10 }, HEALTH_WARNING },
				  { { 2, 5, 20 }, HEALTH_WARNING }, { { 3, 2, 11 }, HEALTH_GOOD },
				  { { 3, 10, 0 }, HEALTH_GOOD },    { { 4, 0, 0 }, HEALTH_GOOD } };
	for (size_t i = 0; i < sizeof check / sizeof *check; i++) {
		health h = { .count = 0 };
		health_judge_openexr(&h, check[i].version);
		assert_int_equal(verdict_of(&h), check[i].expected);
	}
}

static void judges_devices(void **state)
{
	(void)state;
	health h = { .count = 0 };
	health_judge_limit(&h, &(gw_device_limit){ "texels", 100, 100 });
	assert_int_equal(verdict_of(&h), HEALTH_GOOD);
	h.count = 0;
	health_judge_limit(&h, &(gw_device_limit){ "texels", 100, 99 });
	assert_int_equal(verdict_of(&h), HEALTH_BAD);
	const struct {
		uint32_t run;
		bool reckons;
		health_verdict expected;
		const char *says;
	} check[] = { { 70000, true, HEALTH_GOOD, "70000 were run; bakes" },
				  { 65535, true, HEALTH_GOOD, "cuts loops" },
				  { 60000, true, HEALTH_BAD, "60000 were run" },
				  { 70000, false, HEALTH_BAD, "wrong outcome" } };
	for (size_t i = 0; i < 4; i++) {
		h.count = 0;
		health_judge_trial(&h, &(gw_device_trial){ .loops_asked = 70000,
												   .loops_needed = 64000,
												   .loops_run = check[i].run,
												   .reckons = check[i].reckons });
		assert_int_equal(h.item[1].verdict, check[i].expected);
		assert_non_null(strstr(h.item[1].text, check[i].says));
	}
}

static void judges_a_bake(void **state)
{
	(void)state;
	const struct {
		health_canary canary;
		bool good;
	} check[] = {
		{ { .expected = 2.0, .mean = 2.01, .worst = 0.04 }, true },
		{ { .expected = 2.0, .mean = 1.9, .worst = 0.04 }, false },
		{ { .expected = 2.0, .mean = 2.1, .worst = 0.04 }, false },
		{ { .expected = 2.0, .mean = 2.0, .worst = 0.06 }, false },
		{ { .expected = 2.0, .mean = NAN, .worst = NAN }, false },
		{ { .expected = 2.0, .mean = 2.0, .worst = NAN }, false },
		{ { .status = GW_ERROR_MEMORY, .error = { GW_ERROR_MEMORY, "none" } }, false },
	};
	for (size_t i = 0; i < sizeof check / sizeof *check; i++) {
		health h = { .count = 0 };
		health_judge_canary(&h, &check[i].canary);
		assert_int_equal(verdict_of(&h), check[i].good ? HEALTH_GOOD : HEALTH_BAD);
		assert_int_equal(h.bakes, check[i].good);
	}
}

static void judges_folders(void **state)
{
	(void)state;
	health h = { .count = 0 };
	health_judge_folder(&h, "folder", "/tmp", true);
	assert_int_not_equal(verdict_of(&h), HEALTH_BAD);
	h.count = 0;
	health_judge_folder(&h, "folder", "/nowhere/at/all", true);
	assert_int_equal(verdict_of(&h), HEALTH_BAD);
	h.count = 0;
	health_judge_folder(&h, "folder", "/nowhere/at/all", false);
	assert_int_equal(verdict_of(&h), HEALTH_WARNING);
}

/* More than there is room for harms nothing. */
static void keeps_within_its_room(void **state)
{
	(void)state;
	health *h = calloc(1, sizeof *h);
	assert_non_null(h);
	for (int i = 0; i < HEALTH_ITEMS + 10; i++)
		health_add(h, i % 2 ? HEALTH_BAD : HEALTH_GOOD, "item", "%d", i);
	assert_int_equal(h->count, HEALTH_ITEMS);
	assert_int_equal(health_tally(h, HEALTH_BAD), HEALTH_ITEMS / 2);
	assert_string_equal(h->item[HEALTH_ITEMS - 1].text, "265");
	free(h);
}

/* ------------------------------------------------------------------------------- processes */

static void do_well(void *user)
{
	*(int *)user = 42;
}

static void do_abort(void *user)
{
	*(int *)user = 1;
	fprintf(stderr, "first line\nLLVM ERROR: no\033 memory\n");
	abort();
}

static void do_fault(void *user)
{
	(void)user;
	raise(SIGSEGV);
}

static void do_exit(void *user)
{
	(void)user;
	_exit(0);
}

static void do_hang(void *user)
{
	(void)user;
	for (;;)
		pause();
}

static child_end run(void (*work)(void *), int *shared, double seconds)
{
	child_end end;
	gw_error error = { 0 };
	if (child_run(work, shared, seconds, &end, &error) != GW_OK)
		fail_msg("%s", error.text);
	return end;
}

static void survives_its_children(void **state)
{
	(void)state;
	char text[300];
	int *shared = child_memory_create(sizeof *shared);
	assert_non_null(shared);
	child_end end = run(do_well, shared, 60.0);
	assert_true(end.finished);
	assert_int_equal(*shared, 42);

	end = run(do_abort, shared, 60.0);
	assert_false(end.finished);
	assert_int_equal(end.signal, SIGABRT);
	assert_int_equal(*shared, 1);
	child_end_text(&end, text, sizeof text);
	assert_non_null(strstr(text, "ended by signal 6, SIGABRT"));
	assert_non_null(strstr(text, ": LLVM ERROR: no? memory"));

	end = run(do_fault, shared, 60.0);
	assert_int_equal(end.signal, SIGSEGV);
	/* A library that calls exit has not done its work, whatever it says. */
	end = run(do_exit, shared, 60.0);
	assert_false(end.finished);
	end = run(do_hang, shared, 0.1);
	assert_true(end.timed_out);
	assert_false(end.finished);
	assert_true(end.seconds < 30.0);
	child_memory_destroy(shared, sizeof *shared);
}

/* --------------------------------------------------------------------------------- shaders */

/* What shaders ask of a device is what their sources say. */
static void reads_shaders(void **state)
{
	(void)state;
	gw_shader_needs needs = gw_shader_needs_of(gw_shader_find("test_affine"));
	assert_int_equal(needs.storage_buffers, 2);
	assert_int_equal(needs.resources, 2);
	needs = gw_shader_needs_of(gw_shader_find("test_gather"));
	assert_int_equal(needs.storage_buffers, 1);
	assert_int_equal(needs.sampled, 2);
	assert_int_equal(needs.storage_images, 1);
	assert_int_equal(needs.resources, 4);
	/* brick_mipmap has two texel buffers and two storage images. */
	gw_shader_needs most = gw_shader_needs_most();
	needs = gw_shader_needs_of(gw_shader_find("brick_mipmap"));
	assert_int_equal(needs.sampled, 2);
	assert_int_equal(needs.storage_images, 2);
	assert_true(most.sampled >= 2 && most.storage_images >= 2 && most.resources >= 4);
}

/* A loop of this device is run to its end, or cut where bakes are safe; every step counts. */
static void runs_the_loop(void **state)
{
	(void)state;
	gw_device_trial trial;
	gw_error error = { 0 };
	assert_ok(gw_device_try(NULL, 0, &trial, &error), &error);
	assert_true(trial.reckons);
	assert_in_range(trial.loops_run, trial.loops_needed, trial.loops_asked);
	assert_true(trial.budget > 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(judges_memory),         cmocka_unit_test(judges_threads),
		cmocka_unit_test(judges_openexr),        cmocka_unit_test(judges_devices),
		cmocka_unit_test(judges_a_bake),         cmocka_unit_test(judges_folders),
		cmocka_unit_test(keeps_within_its_room), cmocka_unit_test(survives_its_children),
		cmocka_unit_test(reads_shaders),         cmocka_unit_test(runs_the_loop),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
