#include "table/format_table.h"
#include "text/cloud_format.h"
#include "e57/e57_format.h"
#include "files/input_file.h"
#include "las/las_format.h"
#include "las/las_notes.h"
#include "meshes/mesh.h"
#include "pcd/pcd_format.h"
#include "ply/ply_format.h"
#include "points/scan_color.h"
#include "text/text_formats.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* In the order in which content is probed. */
const format *const formats[] = {
	&ply_format, &las_format, &laz_format, &copc_format,  &pcd_format,
	&e57_format, &off_format, &glb_format, &ptx_format,   &pts_format,
	&xyz_format, &csv_format, &obj_format, &cloud_format, NULL,
};

const format *format_by_name(const char *name)
{
	for (size_t f = 0; formats[f]; f++)
		if (strcasecmp(formats[f]->name, name) == 0)
			return formats[f];
	return NULL;
}

/* The length of an extension with its dot, when a name ends in it, else 0. */
static size_t ends_in(const char *name, const char *extension)
{
	size_t length = strlen(name), end = strlen(extension) + 1;
	return length >= end && name[length - end] == '.' &&
				   strcasecmp(name + length - end + 1, extension) == 0
			   ? end
			   : 0;
}

static const char *name_of(const char *path)
{
	const char *slash = strrchr(path, '/');
	return slash ? slash + 1 : path;
}

/* Of two extensions that a name ends in, as .laz and .copc.laz, the longer one counts. */
static const format *find_extension(const char *path, size_t *longest)
{
	const format *found = NULL;
	*longest = 0;
	for (size_t f = 0; formats[f]; f++)
		for (const char *const *e = formats[f]->extensions; *e; e++) {
			size_t length = ends_in(name_of(path), *e);
			found = length > *longest ? formats[f] : found;
			*longest = length > *longest ? length : *longest;
		}
	return found;
}

const format *format_by_path(const char *path)
{
	size_t length;
	return find_extension(path, &length);
}

const char *format_extension(const char *path)
{
	size_t length;
	const char *dot = strrchr(name_of(path), '.'), *end = path + strlen(path);
	return find_extension(path, &length) ? end - length : dot ? dot : end;
}

/* Names of all formats that can be read, for messages. */
static const char *list_formats(char text[256])
{
	text[0] = '\0';
	for (size_t f = 0; formats[f]; f++) {
		size_t used = strlen(text);
		if (formats[f]->read && used + strlen(formats[f]->name) + 3 < 256)
			snprintf(text + used, 256 - used, "%s%s", used ? ", " : "", formats[f]->name);
	}
	return text;
}

static const format *probe(const input_file *in, bool unspecific)
{
	for (size_t f = 0; formats[f]; f++)
		if (formats[f]->read && formats[f]->probe && formats[f]->unspecific == unspecific &&
			formats[f]->probe(in->data, in->length))
			return formats[f];
	return NULL;
}

/* Content before extension: a wrong name is more common than a wrong first line. */
static const format *recognise(const char *path, const input_file *in)
{
	const format *found = probe(in, false);
	if (!found)
		found = format_by_path(path);
	return found && found->read ? found : probe(in, true);
}

gw_status format_read(const char *path, const char *name, scan *cloud, gw_error *error)
{
	return format_read_with(path, &(format_options){ .name = name }, cloud, NULL, error);
}

static gw_status read_as(const format *found, input_file *in, scan *cloud, gw_error *error)
{
	char known[256];
	if (in->length == 0)
		return gw_fail(error, GW_ERROR_DATA, "%s is empty", in->name);
	if (!found)
		return gw_fail(error, GW_ERROR_DATA,
					   "%s is of no known format, by content or by name; there are %s", in->name,
					   list_formats(known));
	return found->read(in, cloud, error);
}

/* A lit file says which axis is up if its format does not. */
static void take_up(scan *cloud)
{
	size_t length = strlen(SCAN_UP);
	for (size_t c = 0; c < cloud->comment_count; c++) {
		const char *text = cloud->comment[c];
		if (strncmp(text, SCAN_UP, length) != 0)
			continue;
		bool down = text[length] == '-';
		char axis = text[length + down];
		if (axis >= 'x' && axis <= 'z' && !text[length + down + 1]) {
			cloud->up = down ? (char)(axis - 'x' + 'X') : axis;
			cloud->says_up = true;
		}
	}
}

/* Where scanners stood, by a lit file of a format that has no place for it. */
static gw_status take_scanners(scan *cloud, gw_error *error)
{
	size_t length = strlen(SCAN_SCANNER), said = 0;
	for (size_t c = 0; c < cloud->comment_count && cloud->scanner_count <= said; c++) {
		if (strncmp(cloud->comment[c], SCAN_SCANNER, length) != 0 || said == SCAN_SCANNERS_SAID)
			continue;
		double at[3];
		char *end = cloud->comment[c] + length;
		bool good = true;
		for (int k = 0; k < 3; k++) {
			const char *from = end;
			at[k] = strtod(from, &end);
			good = good && end != from && isfinite(at[k]);
		}
		if (good && !*end) {
			GW_TRY(scan_add_scanner(cloud, at, 0, cloud->count, error));
			said++;
		}
	}
	return GW_OK;
}

gw_status format_finish(scan *cloud, gw_status status, gw_error *error)
{
	if (status == GW_OK)
		status = scan_color_unpack(cloud, error);
	if (status == GW_OK)
		status = take_scanners(cloud, error);
	if (!cloud->noise_classes)
		cloud->noise_classes = las_note_noise(cloud);
	if (status != GW_OK)
		scan_clear(cloud);
	take_up(cloud);
	return status;
}

const format *format_recognise(const char *path, const char *name, const input_file *in)
{
	return name ? format_by_name(name) : recognise(path, in);
}

gw_status format_read_with(const char *path, const format_options *options, scan *cloud,
						   const format **recognised, gw_error *error)
{
	static const format_options none;
	const format_options *o = options ? options : &none;
	*cloud = (scan){ 0 };
	char known[256];
	const format *found = o->name ? format_by_name(o->name) : NULL;
	if (o->name && (!found || !found->read))
		return gw_fail(error, GW_ERROR_USAGE, "'%s' is no format that can be read; there are %s",
					   o->name, list_formats(known));
	input_file in;
	GW_TRY(input_file_open(&in, path, error));
	in.columns = o->columns;
	in.threads = o->threads;
	if (!found)
		found = recognise(path, &in);
	gw_status status = input_file_check(&in, read_as(found, &in, cloud, error), error);
	status = format_finish(cloud, status, error);
	input_file_close(&in);
	if (recognised)
		*recognised = found;
	return status;
}
