#include "verbs/verbs.h"
#include "scene/file_roles.h"
#include "files/output_file.h"
#include "options/output_name.h"
#include "options/output_scanners.h"
#include "options/output_columns.h"
#include "options/output_system.h"
#include "pcd/pcd_format.h"
#include "result/bake_columns.h"
#include "result/las_step.h"
#include "result/parted_copy.h"
#include "program/signals.h"
#include "program/text_quote.h"
#include "glowworm_host.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Where to: what -o names, or the second file. */
static const char *output_of(const settings *s)
{
	return s->output ? s->output : s->input[1].path;
}

static gw_status check(const settings *s, const format **to, output_shift *shift, gw_error *error)
{
	if (s->output && s->input_count > 1)
		return gw_fail(error, GW_ERROR_USAGE,
					   "two outputs, %s and that of -o; convert writes one, from one input",
					   s->input[1].path);
	if (s->input_count != (s->output ? 1 : 2))
		return gw_fail(error, GW_ERROR_USAGE,
					   "convert what into what? Name an input and an output; - is standard input "
					   "or output");
	const char *out = output_of(s);
	GW_TRY(file_roles_check(VERB_CONVERT, s, NULL, error));
	GW_TRY(output_name_format(out, s->output_format, to, error));
	GW_TRY(output_shift_read(s->shift, *to, shift, error));
	GW_TRY(output_name_check_rounding(*to, s, out, error));
	bool binary = strcmp((*to)->name, "xyz") != 0 && strcmp((*to)->name, "csv") != 0;
	if (binary && strcmp(out, "-") == 0 && isatty(STDOUT_FILENO))
		return gw_fail(error, GW_ERROR_USAGE,
					   "standard output is a terminal, and this is binary data; redirect it, or "
					   "name a file");
	return GW_OK;
}

/* What the reader has to say of the file. */
static void note_reading(const settings *s, const scan *cloud)
{
	for (size_t c = 0; c < cloud->comment_count && !s->quiet; c++)
		if (strncmp(cloud->comment[c], SCAN_NOTE, strlen(SCAN_NOTE)) == 0)
			text_message(stderr, "glowworm: %s\n", cloud->comment[c]);
}

/* Notes are of the file that was read; who reads the other one finds what holds for that. */
static void drop_notes(scan *cloud)
{
	size_t kept = 0;
	for (size_t c = 0; c < cloud->comment_count; c++)
		if (strncmp(cloud->comment[c], SCAN_NOTE, strlen(SCAN_NOTE)) == 0)
			free(cloud->comment[c]);
		else
			cloud->comment[kept++] = cloud->comment[c];
	cloud->comment_count = kept;
}

/* A comment says which axis points up, where it is not z, which is what readers take. */
static gw_status keep_up(scan *cloud, gw_error *error)
{
	char text[64];
	if (cloud->says_up || cloud->up == 'z' || !cloud->up)
		return GW_OK;
	snprintf(text, sizeof text, SCAN_UP "%s", settings_up_name(cloud->up));
	return scan_add_comment(cloud, text, error);
}

/* How many points have no place. */
static size_t count_holes(const scan *cloud)
{
	static const char *const name[3] = { "x", "y", "z" };
	const scan_column *axis[3];
	size_t holes = 0;
	for (int k = 0; k < 3; k++)
		axis[k] = scan_find(cloud, name[k]);
	if (!axis[0] || !axis[1] || !axis[2])
		return 0;
	for (size_t i = 0; i < cloud->count; i++)
		holes += !isfinite(scan_value(axis[0], i)) || !isfinite(scan_value(axis[1], i)) ||
				 !isfinite(scan_value(axis[2], i));
	return holes;
}

/* E57 has a state for what is no point, and readers leave it out. */
static void note_holes(const settings *s, const format *to, uint64_t holes, uint64_t count)
{
	if (!s->quiet && strcmp(to->name, "e57") == 0 && holes > 0)
		fprintf(stderr,
				"glowworm: note: %llu of %llu points are not finite, and so rows without a point, "
				"which readers of E57 leave out\n",
				(unsigned long long)holes, (unsigned long long)count);
}

/* PCD keeps rows and columns of a single picture that has all of its cells, E57 any; a bake knows
 * normals, edges and noise better by them. */
static void note_pictures(const settings *s, const format *to, const scan *cloud)
{
	size_t pictures = 0;
	for (size_t i = 0; i < cloud->image_count; i++)
		pictures += cloud->image[i].columns > 1 && cloud->image[i].rows > 1;
	bool kept =
		strcmp(to->name, "e57") == 0 || (strcmp(to->name, "pcd") == 0 && pcd_is_picture(cloud));
	if (!s->quiet && pictures > 0 && !kept)
		fprintf(stderr,
				"glowworm: note: the rows and columns of %zu scan%s are not kept: where a bake "
				"does not find them again, it knows normals, edges and noise less well; write "
				"E57 to keep them\n",
				pictures, gw_plural(pictures, "", "s"));
}

/* What there is to convert, and what is known of it. */
typedef struct conversion {
	settings *settings; /* a copy, nothing of which is freed */
	const format *to;
	output_file *out;
	output_shift shift;
	parted_copy copy; /* where points come part by part */
} conversion;

/* What becomes of points, all or a part of them. */
static gw_status change(const conversion *c, scan *cloud, gw_error *error)
{
	drop_notes(cloud);
	GW_TRY(output_scanners_settle(c->to, cloud, c->settings->quiet, error));
	GW_TRY(keep_up(cloud, error));
	GW_TRY(output_shift_apply(&c->shift, cloud, error));
	bake_columns_round(cloud, c->settings);
	return GW_OK;
}

static gw_status convert_whole(conversion *c, scan *cloud, gw_error *error)
{
	const settings *s = c->settings;
	const format_options options = { s->format, s->columns, s->bake.threads };
	GW_TRY(format_read_with(s->input[0].path, &options, cloud, NULL, error));
	GW_TRY(signals_check(error));
	note_reading(s, cloud);
	note_holes(s, c->to, count_holes(cloud), cloud->count);
	note_pictures(s, c->to, cloud);
	output_shift_settle_by(&c->shift, cloud, s->quiet);
	GW_TRY(las_step_settle(c->settings, &(las_step_points){ .said = cloud }, error));
	GW_TRY(output_system_check_step(s, cloud, NULL, NULL, error));
	GW_TRY(change(c, cloud, error));
	GW_TRY(output_system_settle(c->to, cloud, s->quiet, error));
	output_columns_note(c->to, cloud, s->quiet);
	return c->to->write(c->out, cloud, error);
}

static gw_status convert_part(conversion *c, uint64_t first, uint64_t *holes, gw_error *error)
{
	scan part;
	GW_TRY(parted_copy_read(&c->copy, first, &part, error));
	if (strcmp(c->to->name, "e57") == 0)
		*holes += count_holes(&part);
	gw_status status = change(c, &part, error);
	if (status == GW_OK)
		status = parted_copy_write(&c->copy, &part, error);
	scan_clear(&part);
	return status == GW_OK ? signals_check(error) : status;
}

static gw_status convert_parts(conversion *c, gw_error *error)
{
	uint64_t holes = 0, count = c->copy.parts.count;
	note_reading(c->settings, &c->copy.told);
	parted_copy_settle_shift(&c->copy);
	GW_TRY(las_step_settle(c->settings, &(las_step_points){ .said = &c->copy.told }, error));
	GW_TRY(parted_copy_check_step(&c->copy, error));
	for (uint64_t first = 0; first < count; first += c->copy.step)
		GW_TRY(convert_part(c, first, &holes, error));
	note_holes(c->settings, c->to, holes, count);
	return parted_copy_end(&c->copy, error);
}

static gw_status convert(conversion *c, scan *cloud, gw_error *error)
{
	const settings *s = c->settings;
	const format_options options = { s->format, s->columns, s->bake.threads };
	bool parted;
	GW_TRY(check(s, &c->to, &c->shift, error));
	GW_TRY(output_file_create(&c->out, output_of(s), s->force, error));
	output_file_use_threads(c->out, s->bake.threads);
	c->copy = (parted_copy){
		.settings = s, .path = output_of(s), .format = c->to, .output = c->out, .shift = &c->shift
	};
	GW_TRY(parted_copy_open(&c->copy, &options, &parted, error));
	if (parted)
		GW_TRY(parted_copy_settle(&c->copy, &parted, error));
	GW_TRY(parted ? convert_parts(c, error) : convert_whole(c, cloud, error));
	GW_TRY(signals_check(error));
	return output_file_commit(&c->out, error);
}

gw_status verb_convert(const settings *s, gw_error *error)
{
	settings own = *s;
	conversion c = { .settings = &own };
	scan cloud = { 0 };
	gw_status status = convert(&c, &cloud, error);
	parted_copy_close(&c.copy);
	output_file_abandon(&c.out);
	scan_clear(&cloud);
	return status;
}
