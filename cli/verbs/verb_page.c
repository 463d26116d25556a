#include "verbs/verbs.h"
#include "options/output_name.h"
#include "options/progress.h"
#include "page/page_file.h"
#include "scene/file_roles.h"
#include "scene/stream_roles.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* A name that says what else the file would be is one that was meant for another verb. */
static gw_status check_name(const char *path, gw_error *error)
{
	const char *slash = strrchr(path, '/'), *dot = strrchr(slash ? slash + 1 : path, '.');
	if (output_name_is_stream(path) || !dot || strcasecmp(dot, ".html") == 0 ||
		strcasecmp(dot, ".htm") == 0)
		return GW_OK;
	return gw_fail(error, GW_ERROR_USAGE,
				   "%s: a page is HTML, and that name says something else; give -o PAGE.html",
				   path);
}

static gw_status check(const settings *s, gw_error *error)
{
	if (s->input_count != 1)
		return gw_fail(error, GW_ERROR_USAGE, "a page of what? Name one lit cloud, or -");
	if (!s->output)
		return gw_fail(error, GW_ERROR_USAGE,
					   "where to write? Give -o PAGE.html, or -o - for standard output");
	GW_TRY(
		stream_roles_check_outputs(&(stream_output){ "--output", s->output, "page is" }, 1, error));
	GW_TRY(file_roles_check(VERB_PAGE, s, NULL, error));
	return check_name(s->output, error);
}

/* What was asked for, or the input's name without folders and its last extension. For free(). */
static char *make_title(const settings *s)
{
	const char *path = loaded_scene_input_name(s->input[0].path), *slash = strrchr(path, '/');
	const char *name = slash && slash[1] ? slash + 1 : path, *dot = strrchr(name, '.');
	if (s->title)
		return strdup(s->title);
	return dot && dot > name ? strndup(name, (size_t)(dot - name)) : strdup(name);
}

/* What the page is, and what would make it better. */
static void note(const settings *s, const page_scene *page, uint64_t bytes)
{
	if (s->quiet)
		return;
	fprintf(stderr,
			"glowworm: note: the page shows %zu of %" PRIu64 " points and %zu %s, %.1f MB\n",
			page->order.count, page->points, page->lamp_count,
			page->lamp_count == 1 ? "lamp" : "lamps", (double)bytes * 1e-6);
	if (page->outside > 0)
		fprintf(stderr,
				"glowworm: note: points far off all the rest, which are left out: %" PRIu64 "\n",
				page->outside);
	if (page->whole)
		fprintf(stderr,
				"glowworm: note: the points do not say which lamp their light comes from, so that "
				"the page has one slider for all; bake with --fields lights for one a lamp\n");
}

static gw_status write(const settings *s, const page_scene *page, gw_error *error)
{
	output_file *out = NULL;
	uint64_t bytes = 0;
	char *title = make_title(s);
	if (!title)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for a title");
	gw_status status = output_file_create(&out, s->output, s->force, error);
	if (status == GW_OK)
		status = page_file_write(out, s, page, title, &bytes, error);
	if (status == GW_OK)
		status = output_file_commit(&out, error);
	output_file_abandon(&out);
	free(title);
	if (status == GW_OK)
		note(s, page, bytes);
	return status;
}

gw_status verb_page(const settings *s, gw_error *error)
{
	page_scene page;
	GW_TRY(check(s, error));
	GW_TRY(output_file_check(s->output, s->force, error));
	progress shown = progress_start((settings_progress)s->progress, s->quiet);
	progress_show(&shown, "read", 0.0);
	gw_status status = page_scene_read(s, &page, error);
	if (status == GW_OK) {
		progress_show(&shown, "write", 0.0);
		status = write(s, &page, error);
		page_scene_clear(&page);
	}
	progress_end(&shown);
	return status;
}
