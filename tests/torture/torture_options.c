/*
 * torture_options.c - option lists with mutations: options that do not belong together, values that
 * make no sense, words that are none.
 */
#include "hard_cloud.h"
#include "torture_child.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const beginnings[] = {
	"bake in.ply -o out.ply --light L",
	"bake in.ply --light L -o -",
	"info in.ply",
	"compare lit.ply lit.ply",
	"render lit.ply -o out.png",
	"convert in.ply out.csv",
	"mix lit.ply -o out.ply",
	"sample mesh.obj -o out.ply",
	"tradeoff in.ply --light L",
	"",
	"bake in.scene.json -o out.ply",
};
#define BEGINNING_COUNT 11

/* Options of all verbs; = marks those that take a value. */
static const char *const options[] = {
	"--force",
	"--vdb=",
	"--vdb-half",
	"--vdb-points",
	"--vdb-voxel=",
	"--report=",
	"--fields=",
	"--ao-distance=",
	"--colors=",
	"--exposure=",
	"--light=",
	"--transport=",
	"--save-transport=",
	"--albedo=",
	"--albedo-scale=",
	"--albedo-white=",
	"--input-gamma=",
	"--up=",
	"--format=",
	"--columns=",
	"--density=",
	"--count=",
	"--method=",
	"--quality=",
	"--max-error=",
	"--time=",
	"--shadows=",
	"--depth=",
	"--leaf-spacing=",
	"--bounces=",
	"--tolerance=",
	"--rays=",
	"--light-samples=",
	"--cones=",
	"--record-spacing=",
	"--shadow-map-size=",
	"--estimate-points=",
	"--seed=",
	"--frames=",
	"--independent",
	"--rebuild",
	"--threads=",
	"--memory=",
	"--device=",
	"--progress=",
	"--explain",
	"--profile",
	"--print-scene",
	"-q",
	"-v",
	"--json",
	"--camera=",
	"--size=",
	"--gain=",
	"--worst=",
	"--max-relrmse=",
	"--output-format=",
	"-o=",
	"--view=",
	"--",
	"--help",
	"-",
	"in.ply",
	"--nothing",
};
#define OPTION_COUNT ((long)(sizeof options / sizeof *options))

static const char *const values[] = {
	"0",
	"1",
	"2",
	"3",
	"-1",
	"0.5",
	"1e-300",
	"1e300",
	"nan",
	"inf",
	"",
	" ",
	"auto",
	"none",
	"99999999999999999999",
	"in.ply",
	"out.ply",
	"lit.ply",
	"missing.ply",
	"/dev/null",
	"/dev/full",
	"/",
	".",
	"a b c",
	"rgb",
	"rays",
	"cones",
	"traced",
	"maps",
	"draft",
	"ply",
	"csv",
	"x,y,z",
	"direct,ao,error",
	"constant:0.5",
	"property:x",
	"all",
	"0..3",
	"3..0",
	"sky radiance 1",
	"point at 0,0,0 intensity 1",
	"sun toward 0,0,-1 irradiance 1",
	"point at 0,0",
	"sky",
	"1,2,3",
	"at 0,0,0 to 1,0,0 fov 60",
	"64x48",
	"1K",
	"50M",
	"8G",
	"%s%n",
	"\x1b[31m",
	"lamp=2",
	"\xff\xfe",
	"0x10",
	"1e",
	"+5",
	"--",
	"preview",
	"keep",
	"octree",
	"llvmpipe",
	"z",
	"linear",
};
#define VALUE_COUNT ((long)(sizeof values / sizeof *values))

static void add_option(torture_case *c, torture_child *child)
{
	char name[40];
	const char *option = options[case_pick(c, OPTION_COUNT)];
	snprintf(name, sizeof name, "%s", option);
	char *equals = strchr(name, '=');
	const char *value = values[case_pick(c, VALUE_COUNT)];
	if (equals)
		*equals = '\0';
	bool joined = equals && name[1] == '-' && case_one_in(c, 3);
	if (case_one_in(c, 40) && strlen(name) > 4) /* a slip of the finger */
		name[3 + case_pick(c, (long)strlen(name) - 4)] ^= 1;
	if (joined)
		child_add(child, "%s=%s", name, value);
	else
		child_add(child, "%s", name);
	if (!joined && equals && !case_one_in(c, 20))
		child_add(child, "%s", value);
}

static void add_beginning(torture_case *c, torture_child *child)
{
	child_add_words(child, beginnings[case_pick(c, BEGINNING_COUNT)]);
	for (size_t i = 0; i < child->count; i++)
		if (strcmp(child->argument[i], "L") == 0)
			child->argument[i] =
				case_one_in(c, 2) ? "sky radiance 1" : "point at 0,0,0 intensity 2";
}

static void make_inputs(torture_case *c)
{
	static const char scene[] = "{\"version\": 1, \"inputs\": [{\"file\": \"in.ply\"}],\n"
								" \"lights\": [{\"type\": \"sky\", \"radiance\": 1}]}\n";
	static const char mesh[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
	hard_cloud cloud = { 0 };
	torture_child child;
	case_clear_folder(c);
	hard_cloud_add(c, &cloud, ROOM, 60);
	hard_cloud_write(c, &cloud, "in.ply");
	hard_cloud_clear(&cloud);
	child_write_file(c, "in.scene.json", scene, strlen(scene));
	child_write_file(c, "mesh.obj", mesh, strlen(mesh));
	child_start(&child);
	child_add_words(&child, "bake in.ply -o lit.ply --fields lights -q --light");
	child_add(&child, "sky radiance 1");
	child_run(c, &child);
}

/* A bake at a great depth, with many samples or long bounces may take its time. */
static bool is_slow(const torture_child *child)
{
	static const char *const slow[] = { "tradeoff", "--max-error", "--time", "reference" };
	for (size_t i = 0; i < child->count; i++)
		for (int s = 0; s < 4; s++)
			if (strstr(child->argument[i], slow[s]))
				return true;
	return false;
}

static void try_options(torture_case *c)
{
	torture_child child;
	child_start(&child);
	add_beginning(c, &child);
	for (long i = case_pick(c, 6); i > 0; i--)
		add_option(c, &child);
	child.address_bytes = (uint64_t)12 << 30;
	child.file_bytes = 1 << 28;
	child.limit = 100;
	if (is_slow(&child) || !case_trial(c))
		return;
	child_run(c, &child);
	if (!child_check(c, &child, "options"))
		return;
	remove(case_path(c, "out.ply"));
	remove(case_path(c, "out.png"));
	remove(case_path(c, "out.csv"));
	size_t length;
	unsigned char *input = child_read_file(c, "in.ply", &length);
	if (!input || length < 1000)
		case_fail(c, "options/input lost", "in.ply is gone: %s", child_line(&child));
	free(input);
	if (child.code == 70)
		case_fail(c, "options/status", "status 70: %s | %s", child.message, child_line(&child));
}

static void run(torture_case *c)
{
	make_inputs(c);
	for (int i = 0; i < 50; i++)
		try_options(c);
}

static long count(bool slice)
{
	return slice ? 4 : 400;
}

const torture_part options_part = { "options", "option lists with mutations", count, run };
