/*
 * torture_scenes.c - scene files with mutations: whatever they say, the program does it or says
 * what is wrong with it.
 */
#include "hard_cloud.h"
#include "torture_child.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const seeds[] = {
	"{\"version\": 1, \"units\": \"radiometric\",\n"
	" \"inputs\": [{\"file\": \"in.ply\", \"emission\": [5, 4, 3], \"albedo\": 0.25}],\n"
	" \"lights\": [{\"type\": \"environment\", \"radiance\": 1},\n"
	"  {\"type\": \"point\", \"position\": [0.1, 0, 0], \"intensity\": [3, 2, 1], \"radius\": "
	"0.1},\n"
	"  {\"type\": \"spot\", \"position\": [0, 0, 0], \"direction\": [0, 0, -1], \"intensity\": 3,\n"
	"   \"inner_angle\": 10, \"outer_angle\": 30, \"name\": \"lamp\"},\n"
	"  {\"type\": \"sun\", \"direction\": [0, 0.5, -1], \"irradiance\": 2, \"angle\": 0.53}],\n"
	" \"bake\": {\"bounces\": 2, \"rays\": 16, \"depth\": 4, \"estimate_points\": 0,\n"
	"  \"albedo\": \"constant:0.5\", \"tolerance\": 0.01, \"seed\": 3, \"memory\": \"2G\"}}\n",
	"{\"version\": 1, \"frames\": 3,\n"
	" \"inputs\": [{\"file\": \"in.ply\", \"matrix\": [0.6, 0, 0, 0.3, 0, 0.6, 0, 0.1,\n"
	"   0, 0, 0.6, 0.3, 0, 0, 0, 1], \"interpolation\": \"smooth\",\n"
	"   \"path\": [{\"frame\": 0, \"move\": [0, 0, 0], \"rotate\": [0, 0, 0]},\n"
	"    {\"frame\": 2, \"move\": [-0.7, 0.2, 0.3], \"rotate\": [0, 0, 50]}]}],\n"
	" \"lights\": [{\"type\": \"point\", \"position\": [-0.6, -0.5, 1], \"intensity\": 1,\n"
	"   \"path\": [{\"frame\": 0, \"position\": [-0.6, -0.5, 1]},\n"
	"    {\"frame\": 2, \"position\": [0.6, -0.5, 1]}]}],\n"
	" \"bake\": {\"bounces\": 1, \"estimate_points\": 0}}\n",
};
#define SEED_COUNT 2

/* What numbers and words are replaced by. */
static const char *const values[] = {
	"0",
	"-1",
	"1e308",
	"-1e308",
	"1e-320",
	"1e999",
	"4294967296",
	"18446744073709551616",
	"0.5",
	"null",
	"true",
	"[]",
	"{}",
	"\"\"",
	"[[[[[]]]]]",
	"\"\\u0000\"",
	"\"in.ply\"",
	"[1,2]",
	"[1,2,3,4,5]",
	"\"../in.ply\"",
	"\"sky\"",
	"\"/dev/zero\"",
	"NaN",
	"{\"file\": \"in.ply\"}",
	"\"\\ud800\"",
	"\"%s%n\"",
	"[1e38,1e38,1e38]",
};
#define VALUE_COUNT ((long)(sizeof values / sizeof *values))

#define TEXT_BYTES 8192

/* Puts `with` where [begin, end) was. */
static void replace(char *text, size_t begin, size_t end, const char *with)
{
	size_t length = strlen(text), more = strlen(with);
	if (length - (end - begin) + more + 1 > TEXT_BYTES)
		return;
	memmove(text + begin + more, text + end, length - end + 1);
	memcpy(text + begin, with, more);
}

/* The end of the value that begins there: a number, a word, a string, or what brackets hold. */
static size_t end_of_value(const char *text, size_t begin)
{
	size_t i = begin;
	if (text[i] == '"') {
		for (i++; text[i] && text[i] != '"'; i++)
			;
		return text[i] ? i + 1 : i;
	}
	if (text[i] == '[' || text[i] == '{') {
		int depth = 0;
		for (; text[i]; i++) {
			depth += (text[i] == '[' || text[i] == '{') - (text[i] == ']' || text[i] == '}');
			if (depth == 0)
				return i + 1;
		}
		return i;
	}
	return i + strcspn(text + i, ",]} \n");
}

/* One value becomes another: any that follows a colon, a comma or a bracket. */
static void mutate_value(torture_case *c, char *text)
{
	size_t i = (size_t)case_pick(c, (long)strlen(text) + 1);
	i += strcspn(text + i, ":,[");
	if (!text[i])
		return;
	i += 1 + strspn(text + i + 1, " \n");
	replace(text, i, end_of_value(text, i), values[case_pick(c, VALUE_COUNT)]);
}

/* A number becomes one that may make sense. */
static void mutate_number(torture_case *c, char *text)
{
	static const char *const number[] = { "0",     "1",   "2",    "-1",    "0.5",
										  "0.001", "10",  "-0.7", "1e-6",  "1000",
										  "1e5",   "0.9", "3",    "1e-30", "1e20" };
	size_t i = (size_t)case_pick(c, (long)strlen(text) + 1);
	i += strcspn(text + i, "0123456789");
	if (text[i] && i > 0 && strchr(" [,", text[i - 1]))
		replace(text, i, end_of_value(text, i), number[case_pick(c, 15)]);
}

static void mutate_bytes(torture_case *c, char *text)
{
	size_t length = strlen(text), at = (size_t)case_pick(c, (long)length + 1);
	size_t more = (size_t)case_pick(c, 20);
	char byte[2] = { (char)(1 + case_pick(c, 255)), '\0' };
	if (case_one_in(c, 3))
		replace(text, at, at, byte);
	else if (case_one_in(c, 2))
		replace(text, at, at < length ? at + 1 : at, byte);
	else
		replace(text, at, at + more < length ? at + more : length, "");
}

/* A piece comes twice. */
static void mutate_twice(torture_case *c, char *text)
{
	char piece[400];
	size_t length = strlen(text), at = (size_t)case_pick(c, (long)length + 1);
	snprintf(piece, sizeof piece, "%.*s", (int)case_pick(c, 300), text + at);
	at = (size_t)case_pick(c, (long)length + 1);
	replace(text, at, at, piece);
}

/* Without a mutation each of them is lit, or the mutations would test nothing but the parser. */
static void try_seeds(torture_case *c)
{
	for (int i = 0; i < SEED_COUNT; i++) {
		torture_child child;
		child_write_file(c, "in.scene.json", seeds[i], strlen(seeds[i]));
		child_start(&child);
		child_add_words(&child, "bake in.scene.json -o out.ply --force -q");
		if (!case_trial(c))
			continue;
		child_run(c, &child);
		if (child.code != 0)
			case_fail(c, "scene/seed", "status %d: %s", child.code, child.message);
		remove(case_path(c, "out.ply"));
	}
}

static void try_scene(torture_case *c)
{
	char text[TEXT_BYTES];
	torture_child child;
	snprintf(text, sizeof text, "%s", seeds[case_pick(c, SEED_COUNT)]);
	for (long i = 1 + case_pick(c, 3); i > 0; i--) {
		long way = case_pick(c, 10);
		if (way < 7)
			mutate_number(c, text);
		else if (way == 7)
			mutate_value(c, text);
		else if (way == 8)
			mutate_bytes(c, text);
		else
			mutate_twice(c, text);
	}
	bool print = case_one_in(c, 3);
	if (!case_trial(c))
		return;
	child_write_file(c, "in.scene.json", text, strlen(text));
	child_start(&child);
	child.limit = 60;
	child.address_bytes = (uint64_t)8 << 30;
	child_add_words(&child, "bake in.scene.json -o out.ply --force -q");
	if (print)
		child_add_words(&child, "--print-scene");
	child_run(c, &child);
	if (!child_check(c, &child, "scene"))
		return;
	if (child.code != 0 && child.code != 1 && child.code != 2 && child.code != 65 &&
		child.code != 66 && child.code != 71 && child.code != 73)
		case_fail(c, "scene/status", "status %d: %s", child.code, child.message);
	if (child.code > 2 && child_count_files(c, "out.ply") > 0)
		case_fail(c, "scene/partial output", "status %d, and out.ply is there", child.code);
	remove(case_path(c, "out.ply"));
}

static void run(torture_case *c)
{
	hard_cloud cloud = { 0 };
	hard_cloud_add(c, &cloud, ROOM, 60);
	hard_cloud_write(c, &cloud, "in.ply");
	hard_cloud_clear(&cloud);
	try_seeds(c);
	for (int i = 0; i < 50; i++)
		try_scene(c);
}

static long count(bool slice)
{
	return slice ? 4 : 400;
}

const torture_part scenes_part = { "scenes", "scene files with mutations", count, run };
