#include "scene/file_roles.h"
#include "files/growing_table.h"
#include "files/output_file.h"
#include "meshes/mesh.h"
#include "scene/bake_journal.h"
#include "scene/scene_file.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

/* A file, or where one would be. */
typedef struct place {
	dev_t device;
	ino_t inode;      /* of the file, or of the folder */
	const char *name; /* in the folder; NULL: the file is there */
} place;

typedef struct role {
	char *path; /* owned */
	place place;
	bool written;
	size_t index; /* in the order in which they were named */
} role;

typedef struct roles {
	role *list;
	size_t count;
	bool replaces; /* an output is there already */
	const settings *settings;
	verb verb;
} roles;

/* -------------------------------------------------------------------------------- places */

/* Terminals, sockets and the like hold nothing that could be lost. */
static bool keeps_bytes(const struct stat *info)
{
	return S_ISREG(info->st_mode) || S_ISFIFO(info->st_mode) || S_ISBLK(info->st_mode);
}

/* True when the path leads to a file, or to a folder in which it would be. The place leads into
 * the path. */
static bool find_place(const char *path, bool written, place *at)
{
	struct stat info;
	bool stream = strcmp(path, "-") == 0;
	int found = stream ? fstat(written ? STDOUT_FILENO : STDIN_FILENO, &info) : stat(path, &info);
	if (found == 0) {
		*at = (place){ info.st_dev, info.st_ino, NULL };
		return keeps_bytes(&info);
	}
	const char *slash = strrchr(path, '/');
	char *folder = slash ? strndup(path, (size_t)(slash - path) + 1) : strdup(".");
	bool good = !stream && folder && stat(folder, &info) == 0;
	if (good)
		*at = (place){ info.st_dev, info.st_ino, slash ? slash + 1 : path };
	free(folder);
	return good;
}

static int compare_places(const place *a, const place *b)
{
	if (a->device != b->device)
		return a->device < b->device ? -1 : 1;
	if (a->inode != b->inode)
		return a->inode < b->inode ? -1 : 1;
	if (!a->name || !b->name)
		return (a->name != NULL) - (b->name != NULL);
	return strcmp(a->name, b->name);
}

static int compare_roles(const void *a, const void *b)
{
	const role *one = a, *other = b;
	int order = compare_places(&one->place, &other->place);
	return order ? order : one->index < other->index ? -1 : 1;
}

/* ------------------------------------------------------------------------------ the list */

/* Takes the path, which is for free(); NULL: there was no memory for it. */
static gw_status take(roles *r, char *path, bool written, gw_error *error)
{
	role *grown = path ? growing_table_room(r->list, r->count, sizeof *grown) : NULL;
	if (!grown) {
		free(path);
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the list of files");
	}
	r->list = grown;
	role *next = &grown[r->count];
	*next = (role){ .path = path, .written = written, .index = r->count };
	if (!find_place(path, written, &next->place)) {
		free(path);
		return GW_OK;
	}
	r->replaces = r->replaces || (written && !next->place.name);
	r->count++;
	return GW_OK;
}

static gw_status add(roles *r, const char *path, bool written, gw_error *error)
{
	return path ? take(r, strdup(path), written, error) : GW_OK;
}

static gw_status add_library(void *user, const char *path, gw_error *error)
{
	return add(user, path, false, error);
}

/* An input, and the materials that an OBJ file asks for. These are read from it, which is in vain
 * when nothing is there that could be lost. */
static gw_status add_input(roles *r, const settings_input *input, bool sampled, gw_error *error)
{
	struct stat info;
	size_t length = strlen(input->path);
	bool named = length > 4 && strcasecmp(input->path + length - 4, ".obj") == 0;
	GW_TRY(add(r, input->path, false, error));
	if (r->replaces && (named || input->mesh || sampled) && stat(input->path, &info) == 0 &&
		S_ISREG(info.st_mode))
		GW_TRY(mesh_obj_libraries(input->path, add_library, r, error));
	return GW_OK;
}

/* Of a scene, or what --mesh names.
 *   sampled   all inputs are meshes, whatever their names say */
static gw_status add_scene(roles *r, const settings *s, size_t inputs, bool sampled,
						   gw_error *error)
{
	GW_TRY(add(r, s->scene, false, error));
	for (size_t i = 0; i < inputs; i++)
		GW_TRY(add_input(r, &s->input[i], sampled, error));
	for (size_t i = 0; i < s->light_count; i++) {
		if (s->light[i].map[0])
			GW_TRY(add(r, s->light[i].map, false, error));
		if (s->light[i].ies[0])
			GW_TRY(add(r, s->light[i].ies, false, error));
	}
	return GW_OK;
}

static gw_status add_mesh(roles *r, const char *path, gw_error *error)
{
	settings list = settings_default();
	settings_input input = { .path = (char *)(uintptr_t)path }; /* which is copied */
	gw_status status = settings_add_input(&list, &input, error);
	if (status == GW_OK)
		status = scene_read_all(&list, error);
	if (status == GW_OK)
		status = add_scene(r, &list, list.input_count, true, error);
	settings_clear(&list);
	return status;
}

static gw_status add_outputs(roles *r, const file_series *series, gw_error *error)
{
	const settings *s = r->settings;
	const char *const path[] = { r->verb == VERB_CONVERT && !s->output ? s->input[1].path : NULL,
								 series ? NULL : s->output,
								 s->vdb,
								 s->vdb_sh,
								 s->report,
								 s->save_transport,
								 s->csv,
								 s->svg,
								 s->worst,
								 s->json_file,
								 s->picture };
	for (size_t i = 0; i < sizeof path / sizeof *path; i++)
		GW_TRY(add(r, path[i], true, error));
	if (s->resume && s->output) {
		GW_TRY(take(r, output_file_beside(s->output, OUTPUT_FILE_PART), true, error));
		GW_TRY(take(r, output_file_beside(s->output, BAKE_JOURNAL_NAME), true, error));
	}
	for (size_t i = 0; series && i < series->count; i++)
		GW_TRY(take(r, series->name(series->user, i), true, error));
	return GW_OK;
}

static gw_status add_inputs(roles *r, gw_error *error)
{
	const settings *s = r->settings;
	GW_TRY(add_scene(r, s, r->verb == VERB_CONVERT ? 1 : s->input_count, r->verb == VERB_SAMPLE,
					 error));
	GW_TRY(add(r, s->transport, false, error));
	GW_TRY(add(r, s->render.path, false, error));
	if (s->render.mesh)
		GW_TRY(add_mesh(r, s->render.mesh, error));
	return GW_OK;
}

/* ------------------------------------------------------------------------------ the rule */

static const char *name_of(const role *r)
{
	return strcmp(r->path, "-") != 0 ? r->path : r->written ? "standard output" : "standard input";
}

static gw_status fail_same(const role *one, const role *other, gw_error *error)
{
	const role *out = one->written ? one : other, *in = one->written ? other : one;
	bool alike = strcmp(one->path, other->path) == 0;
	if (in->written && alike)
		return gw_fail(error, GW_ERROR_USAGE, "two outputs are called %s", out->path);
	if (in->written)
		return gw_fail(error, GW_ERROR_USAGE,
					   "%s and %s are one file, and both would be written; give each output a "
					   "file of its own",
					   name_of(one), name_of(other));
	if (alike)
		return gw_fail(error, GW_ERROR_USAGE, "%s is an input; write to another name", out->path);
	return gw_fail(error, GW_ERROR_USAGE,
				   "%s is the same file as %s, which is an input; write to "
				   "another name",
				   name_of(out), name_of(in));
}

/* Of equal places the outputs come first, because they were named first. */
static gw_status find_same(const roles *r, gw_error *error)
{
	for (size_t i = 1; i < r->count; i++) {
		const role *one = &r->list[i - 1], *other = &r->list[i];
		if ((one->written || other->written) && compare_places(&one->place, &other->place) == 0)
			return fail_same(one, other, error);
	}
	return GW_OK;
}

gw_status file_roles_check(verb v, const settings *s, const file_series *series, gw_error *error)
{
	roles r = { .settings = s, .verb = v };
	gw_status status = add_outputs(&r, series, error);
	if (status == GW_OK)
		status = add_inputs(&r, error);
	if (status == GW_OK && r.count > 1) {
		qsort(r.list, r.count, sizeof *r.list, compare_roles);
		status = find_same(&r, error);
	}
	for (size_t i = 0; i < r.count; i++)
		free(r.list[i].path);
	free(r.list);
	return status;
}
