/*
 * How the program was built, what it runs on, and which libraries it found.
 */
#include "program/build_facts.h"
#include "program/child_process.h"
#include "program/ranks.h"
#include "verbs/health.h"
#include "panoramas/panorama.h"
#include "grids/vdb_grids.h"
#include "units/coordinates.h"

#include <stdlib.h>
#include <string.h>
#include <sys/utsname.h>
#include <unistd.h>

/* The value behind a name in a file of lines such as "model name : X" or NAME="X". */
static void read_value(const char *path, const char *name, char *text, size_t size)
{
	char line[320];
	FILE *file = fopen(path, "re");
	snprintf(text, size, "not known");
	if (!file)
		return;
	while (fgets(line, sizeof line, file)) {
		if (strncmp(line, name, strlen(name)) != 0)
			continue;
		const char *value = line + strlen(name);
		value += strspn(value, " \t:=\"");
		snprintf(text, size, "%.*s", (int)strcspn(value, "\"\n"), value);
		break;
	}
	fclose(file);
}

static void check_locale(health *h)
{
	static const char *const name[] = { "LC_ALL", "LC_NUMERIC", "LANG" };
	const char *from = "", *value = "C";
	for (size_t i = 0; i < 3 && !*from; i++) {
		const char *given = getenv(name[i]);
		if (given && *given) {
			from = name[i];
			value = given;
		}
	}
	char text[8];
	snprintf(text, sizeof text, "%g", 0.5);
	bool good = strcmp(text, "0.5") == 0;
	health_add(h, good ? HEALTH_GOOD : HEALTH_BAD, "locale", "%.60s%s%s%s; a half is written %s",
			   value, *from ? " (" : "", from, *from ? ")" : "", text);
}

void health_of_program(health *h)
{
	struct utsname system = { 0 };
	char text[160];
	health_begin(h, "program");
	health_add(h, HEALTH_GOOD, "version", "glowworm " GW_VERSION);
	health_add(h, HEALTH_GOOD, "compiler", "%s", build_facts_compiler());
	health_add(h, HEALTH_GOOD, "flags", "%s", build_facts_flags());
	uname(&system);
	read_value("/etc/os-release", "PRETTY_NAME", text, sizeof text);
	health_add(h, HEALTH_GOOD, "system", "%s, %s %s, %s", text, system.sysname, system.release,
			   system.machine);
	read_value("/proc/cpuinfo", "model name", text, sizeof text);
	health_add(h, HEALTH_GOOD, "processor", "%s, %ld of them", text, sysconf(_SC_NPROCESSORS_ONLN));
	check_locale(h);
}

/* ----------------------------------------------------------------------------- libraries */

/* Below this the library has known holes that a hostile picture can use. */
static const int openexr_good[3] = { 3, 2, 11 };

void health_judge_openexr(health *h, const int version[3])
{
	int order = 0;
	for (int k = 0; k < 3 && order == 0; k++)
		order = (version[k] > openexr_good[k]) - (version[k] < openexr_good[k]);
	if (order >= 0)
		health_add(h, HEALTH_GOOD, "OpenEXR", "%d.%d.%d", version[0], version[1], version[2]);
	else
		health_add(h, HEALTH_WARNING, "OpenEXR",
				   "%d.%d.%d has known holes, mended in %d.%d.%d: read maps of the sky (.exr) only "
				   "from those you trust",
				   version[0], version[1], version[2], openexr_good[0], openexr_good[1],
				   openexr_good[2]);
}

typedef struct plugin_trial {
	gw_status (*load)(gw_error *error);
	gw_status status;
	gw_error error;
} plugin_trial;

static void load_plugin(void *user)
{
	plugin_trial *trial = user;
	trial->status = trial->load(&trial->error);
}

/* without: what it is where the plugin does not load. */
static gw_status try_plugin(health *h, const char *name, gw_status (*load)(gw_error *),
							health_verdict without, const char *good, gw_error *error)
{
	plugin_trial *trial = child_memory_create(sizeof *trial);
	if (!trial)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory to try a library");
	trial->load = load;
	child_end end;
	char text[300];
	gw_status status = child_run(load_plugin, trial, 60.0, &end, error);
	child_end_text(&end, text, sizeof text);
	if (status == GW_OK && !end.finished)
		health_add(h, HEALTH_BAD, name, "loading its plugin: %s", text);
	else if (status == GW_OK && trial->status != GW_OK)
		health_add(h, without, name, "%.300s", trial->error.text);
	else if (status == GW_OK)
		health_add(h, HEALTH_GOOD, name, "%s", good);
	child_memory_destroy(trial, sizeof *trial);
	return status;
}

gw_status health_of_libraries(health *h, gw_error *error)
{
	int version[3];
	health_begin(h, "libraries");
	panorama_openexr_version(version);
	health_judge_openexr(h, version);
	GW_TRY(try_plugin(h, "OpenVDB", vdb_load, HEALTH_BAD, "libglowworm-vdb.so is there, for --vdb",
					  error));
	GW_TRY(try_plugin(h, "PROJ", coordinates_try, HEALTH_BAD,
					  "libglowworm-proj.so is there, for files that name a coordinate system",
					  error));
	/* It is built only where Open MPI is. */
	return try_plugin(h, "MPI", ranks_try, HEALTH_WARNING,
					  "libglowworm-mpi.so is there, for several processes under mpirun", error);
}
