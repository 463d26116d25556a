#include "scene/loaded_scene.h"
#include "glowworm_host.h"

#include "scene/scan_move.h"
#include "scene/scene_instances.h"
#include "scene/floor_places.h"
#include "scene/sky_light.h"
#include "glowworm_picture.h"
#include "files/growing_table.h"
#include "points/scan_color.h"
#include "points/scan_opacity.h"
#include "points/scan_origin.h"
#include "points/scan_rows.h"
#include "points/scan_intensity.h"
#include "points/scan_join.h"
#include "program/signals.h"
#include "table/format_table.h"
#include "meshes/mesh_reader.h"
#include "panoramas/panorama_reader.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const emission_names[3] = { "emission_r", "emission_g", "emission_b" };

const char *loaded_scene_input_name(const char *path)
{
	return strcmp(path, "-") == 0 ? "standard input" : path;
}

/* --------------------------------------------------------------------- one input's columns */

static gw_status set_emission(scan *cloud, const float emission[3], gw_error *error)
{
	for (int k = 0; k < 3; k++) {
		scan_remove_column(cloud, emission_names[k]);
		scan_column *column = scan_add_column(cloud, emission_names[k], SCAN_FLOAT32, error);
		if (!column)
			return GW_ERROR_MEMORY;
		for (size_t i = 0; i < cloud->count; i++)
			((float *)column->data)[i] = emission[k];
	}
	return GW_OK;
}

static gw_status set_number(scan *cloud, const char *name, float value, gw_error *error)
{
	scan_remove_column(cloud, name);
	scan_column *column = scan_add_column(cloud, name, SCAN_FLOAT32, error);
	for (size_t i = 0; column && i < cloud->count; i++)
		((float *)column->data)[i] = value;
	return column ? GW_OK : GW_ERROR_MEMORY;
}

/* A glossy surface of which nobody says how rough it is is as matt as can be. */
static gw_status set_gloss(const settings_input *from, scan *cloud, gw_error *error)
{
	if (from->has_specular)
		GW_TRY(set_number(cloud, "specular", from->specular, error));
	if (from->has_roughness)
		return set_number(cloud, "roughness", from->roughness, error);
	if (from->has_specular && !scan_find(cloud, "roughness"))
		GW_TRY(set_number(cloud, "roughness", 1.0f, error));
	return GW_OK;
}

/* Columns of the input stay where they say the same. */
static gw_status set_opacity(const settings *s, const settings_input *from, scan *cloud,
							 gw_error *error)
{
	float opacity = from->has_opacity ? from->opacity : s->opacity;
	bool known = opacity >= 0.0f;
	return known && (opacity < 1.0f || scan_opacity_find(cloud))
			   ? set_number(cloud, "opacity", opacity, error)
			   : GW_OK;
}

static uint8_t to_byte(double value)
{
	return value > 0.0 ? (uint8_t)(fmin(value, 1.0) * 255.0 + 0.5) : 0;
}

/* Keeps the colours under the names by which a lit file is lit again. */
static gw_status keep_albedo(scan *cloud, const scan_points *points, bool own_colors,
							 const scan_told *told, gw_error *error)
{
	const float *albedo = points->albedo;
	scan_color color = { 0 };
	own_colors = own_colors &&
				 (scan_told_color(told, cloud, true, &color) ||
				  scan_told_color(told, cloud, false, &color)) &&
				 !color.black;
	uint8_t *kept = reallocarray(NULL, cloud->count, 3);
	if (!kept)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for colours of %zu points", cloud->count);
	for (size_t i = 0; i < cloud->count; i++)
		for (size_t k = 0; k < 3; k++)
			kept[3 * i + k] = to_byte(own_colors ? scan_color_value(&color, (int)k, i)
												 : scan_srgb_encode((double)albedo[3 * i + k]));
	gw_status status = GW_OK;
	for (size_t k = 0; k < 3 && status == GW_OK; k++) {
		scan_remove_column(cloud, scan_albedo_names[k]);
		scan_column *column = scan_add_column(cloud, scan_albedo_names[k], SCAN_UINT8, error);
		status = column ? GW_OK : GW_ERROR_MEMORY;
		for (size_t i = 0; column && i < cloud->count; i++)
			((uint8_t *)column->data)[i] = kept[3 * i + k];
	}
	free(kept);
	return status;
}

static bool is_lit(const scan *cloud)
{
	for (size_t c = 0; c < cloud->comment_count; c++)
		if (strncmp(cloud->comment[c], "glowworm ", 9) == 0)
			return true;
	return false;
}

/* From the columns of one file to points; facts for the report. */
static gw_status make_points(const settings *s, const settings_input *from, scan *cloud,
							 scan_points *points, loaded_input *facts, gw_error *error)
{
	scan_points_options options = s->points;
	options.linear_colors = s->gamma == 1 && !facts->is_mesh;
	/* Where the albedo of scans comes from does not concern meshes, whose colours we made, black
	 * ones included. */
	if (facts->is_mesh && options.albedo != SCAN_ALBEDO_CONSTANT)
		options.albedo = SCAN_ALBEDO_COLOR;
	GW_TRY(scan_points_make(cloud, &options, points, error));
	assert(points->albedo); /* there is always one */
	for (size_t i = 0; from->has_albedo && i < 3 * cloud->count; i++)
		points->albedo[i] = from->albedo[i % 3];
	bool colors = !from->has_albedo;
	memcpy(facts->albedo_source, points->albedo_source, sizeof facts->albedo_source);
	if (from->has_albedo)
		snprintf(facts->albedo_source, sizeof facts->albedo_source,
				 "a constant, as the scene file says");
	scan_color color;
	facts->albedo_missing = !from->has_albedo && !facts->is_mesh &&
							s->points.albedo == SCAN_ALBEDO_AUTO &&
							(!(scan_color_find(cloud, scan_albedo_names, &color) ||
							   scan_color_find(cloud, scan_color_names, &color)) ||
							 color.black);
	facts->albedo_told = !from->has_albedo && points->albedo_told;
	double sum = 0.0;
	for (size_t i = 0; i < 3 * cloud->count; i++)
		sum += isfinite(points->albedo[i]) ? fmin((double)points->albedo[i], 1.0) : 0.0;
	facts->albedo_mean = sum / (3.0 * (double)cloud->count);
	facts->lit = is_lit(cloud);
	facts->points = cloud->count;
	facts->left_out = cloud->left_out;
	return keep_albedo(cloud, points, colors, options.told, error);
}

/* One input on its way into the scene. */
typedef struct part {
	scan cloud;
	scan_points points;
} part;

/* How many are read: of what comes in parts, one cloud of all inputs. */
static size_t clouds_read(const settings *s, const loaded_scene *scene)
{
	return scene->parted ? 1 : s->input_count;
}

static gw_status read_file(const settings *s, const settings_input *from, scan *cloud,
						   const format **found, gw_error *error)
{
	format_options options = { s->format, s->columns, s->bake.threads };
	GW_TRY(format_read_with(from->path, &options, cloud, found, error));
	if (cloud->count == 0)
		return gw_fail(error, GW_ERROR_DATA, "%s holds no points",
					   loaded_scene_input_name(from->path));
	/* Of several inputs, others may know better which way is up. */
	GW_TRY(scan_find_rows(cloud, from->has_matrix || s->input_count > 1, error));
	bool said = s->scanner_count > 0 || s->scanner_none;
	return said ? GW_OK : scan_find_origin(cloud, error);
}

/* Input i. A file that stands in several places is read once, and kept for the others. */
static gw_status read_cloud(const settings *s, size_t i, scan *kept, part *parts,
							loaded_scene *scene, gw_error *error)
{
	const settings_input *from = &s->input[i];
	scan *cloud = &parts[i].cloud;
	if (from->again) {
		scene->input[i].format = scene->input[i - 1].format;
		GW_TRY(scan_copy(kept, cloud, error));
	} else if (scene->parted) {
		GW_TRY(parted_cloud_thin(scene->parted, cloud, error));
	} else {
		GW_TRY(read_file(s, from, cloud, &scene->input[i].format, error));
		scan_clear(kept);
		if (i + 1 < s->input_count && s->input[i + 1].again)
			GW_TRY(scan_copy(cloud, kept, error));
	}
	return from->has_matrix && !scene->parted ? scan_move(cloud, from->matrix, error) : GW_OK;
}

/* The matrix comes before the sampling, so that the density is that of the scene. */
static gw_status read_mesh(const settings *s, const settings_input *from, loaded_input *facts,
						   gw_error *error)
{
	GW_TRY(mesh_read(from->path, &facts->mesh, error));
	facts->format = facts->mesh.format;
	mesh_stand(&facts->mesh, settings_up_axis(s->up));
	if (from->has_matrix)
		mesh_transform(&facts->mesh, from->matrix);
	return mesh_measure(&facts->mesh, loaded_scene_input_name(from->path), error);
}

/* What is the same for clouds and sampled meshes. */
static gw_status finish_part(const settings *s, const settings_input *from, part *p,
							 loaded_input *facts, gw_error *error)
{
	gw_error reason = { 0 };
	if (from->has_emission)
		GW_TRY(set_emission(&p->cloud, from->emission, error));
	GW_TRY(set_gloss(from, &p->cloud, error));
	GW_TRY(set_opacity(s, from, &p->cloud, error));
	gw_status status = make_points(s, from, &p->cloud, &p->points, facts, &reason);
	if (status != GW_OK)
		gw_fail(error, status, "%s: %.800s", loaded_scene_input_name(from->path), reason.text);
	return status;
}

/* ------------------------------------------------------------------------------- meshes */

gw_status loaded_scene_mesh_count(const mesh *m, double density, const char *name, uint64_t *count,
								  gw_error *error)
{
	double exact = round(density * m->area);
	if (!(exact >= 1.0))
		return gw_fail(error, GW_ERROR_DATA,
					   "%s: %s m^2 with %s points a square metre hold no point; give a larger "
					   "density",
					   name, GW_SAID(m->area, 3), GW_SAID(density, 3));
	if (!(exact <= 0x1p53))
		return gw_fail(error, GW_ERROR_DATA,
					   "%s: %s m^2 with %s points a square metre are too many points; give a "
					   "smaller density",
					   name, GW_SAID(m->area, 3), GW_SAID(density, 3));
	*count = (uint64_t)exact;
	return GW_OK;
}

/* The density of meshes that say none: the scan's, else what the count comes to. */
static gw_status find_density(const settings *s, const loaded_scene *scene, const part *parts,
							  double *density, gw_error *error)
{
	const part *largest = NULL;
	double area = 0.0;
	bool needed = false;
	for (size_t i = 0; i < s->input_count; i++) {
		if (scene->input[i].is_mesh && !(s->input[i].density > 0.0f)) {
			area += scene->input[i].mesh.area;
			needed = true;
		}
		if (!scene->input[i].is_mesh && (!largest || parts[i].cloud.count > largest->cloud.count))
			largest = &parts[i];
	}
	*density = s->density > 0.0f ? (double)s->density : (double)s->count / area;
	if (!needed || s->density > 0.0f || !largest)
		return GW_OK;
	gw_statistics statistics;
	GW_TRY(gw_measure(&largest->points.points, s->bake.threads, &statistics, error));
	if (!(statistics.density > 0.0 && isfinite(statistics.density)))
		return gw_fail(error, GW_ERROR_DATA,
					   "the clouds have no density that meshes could follow; give --density");
	*density = statistics.density;
	return GW_OK;
}

static gw_status sample_mesh(const settings *s, size_t i, double density, loaded_input *facts,
							 part *p, gw_error *error)
{
	const settings_input *from = &s->input[i];
	uint64_t count;
	if (from->density > 0.0f)
		density = (double)from->density;
	gw_status status = loaded_scene_mesh_count(&facts->mesh, density,
											   loaded_scene_input_name(from->path), &count, error);
	/* Another seed each, so that copies of a mesh do not repeat its points. */
	if (status == GW_OK)
		status =
			mesh_sample(&facts->mesh, count, s->bake.seed + i, s->bake.threads, &p->cloud, error);
	mesh_clear_shape(&facts->mesh);
	return status == GW_OK ? finish_part(s, from, p, facts, error) : status;
}

/* ------------------------------------------------------------------------------- joining */

/* Appends n values to count ones; 0 stands for what is missing. */
static gw_status append_floats(float **to, size_t count, const float *from, size_t n,
							   gw_error *error)
{
	if (!*to && !from)
		return GW_OK;
	bool had = *to != NULL;
	float *grown = reallocarray(*to, count + n, sizeof *grown);
	if (!grown)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu points", (count + n) / 3);
	if (!had)
		memset(grown, 0, count * sizeof *grown);
	if (from)
		memcpy(grown + count, from, n * sizeof *grown);
	else
		memset(grown + count, 0, n * sizeof *grown);
	*to = grown;
	return GW_OK;
}

static gw_status append_strays(scan_points *to, size_t count, const scan_points *from,
							   gw_error *error)
{
	size_t n = from->points.count;
	if (!to->stray && !from->stray)
		return GW_OK;
	bool had = to->stray != NULL;
	uint8_t *grown = realloc(to->stray, count + n);
	if (!grown)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu points", count + n);
	to->stray = grown;
	if (!had)
		memset(grown, 0, count);
	if (from->stray)
		memcpy(grown + count, from->stray, n);
	else
		memset(grown + count, 0, n);
	return GW_OK;
}

/* What is 1 where it is not known. */
static gw_status append_shares(float **to, size_t count, const float *from, size_t n,
							   gw_error *error)
{
	bool any = *to || from, whole = !*to;
	GW_TRY(append_floats(to, count, from, n, error));
	for (size_t i = 0; any && whole && i < count; i++)
		(*to)[i] = 1.0f;
	for (size_t i = 0; any && !from && i < n; i++)
		(*to)[count + i] = 1.0f;
	return GW_OK;
}

static void forget_normals(scan_points *points, size_t count)
{
	for (size_t i = 0; i < 3 * count; i++)
		points->normal[i] = 0.0f;
	points->points.normal_sideless = false;
}

/* Where only one of two clouds knows sides, normals of no side are estimated anew. */
static void match_sides(scan_points *to, size_t count, scan_points *from)
{
	bool both = to->normal && from->normal;
	bool differ = to->points.normal_sideless != from->points.normal_sideless;
	if (both && differ && to->points.normal_sideless)
		forget_normals(to, count);
	else if (both && differ)
		forget_normals(from, from->points.count);
	to->points.normal_sideless |= from->points.normal_sideless;
}

static gw_status append_points(scan_points *to, size_t count, scan_points *from, gw_error *error)
{
	size_t n = 3 * from->points.count;
	double *position = reallocarray(to->position, 3 * count + n, sizeof *position);
	if (!position)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for positions");
	to->position = position;
	memcpy(position + 3 * count, from->position, n * sizeof *position);
	match_sides(to, count, from);
	GW_TRY(append_floats(&to->normal, 3 * count, from->normal, n, error));
	GW_TRY(append_floats(&to->albedo, 3 * count, from->albedo, n, error));
	GW_TRY(append_floats(&to->emission, 3 * count, from->emission, n, error));
	n = from->points.count;
	GW_TRY(append_shares(&to->opacity, count, from->opacity, n, error));
	GW_TRY(append_shares(&to->beam_share, count, from->beam_share, n, error));
	return append_strays(to, count, from, error);
}

/* Where one of two clouds has a column of opacity, points of the other are opaque in it. */
static gw_status level_opacity(const scan *has, scan *lacks, gw_error *error)
{
	const scan_column *column = scan_opacity_find(has);
	if (!column || scan_find(lacks, column->name))
		return GW_OK;
	return set_number(lacks, column->name, (float)scan_opacity_full(column, has->count), error);
}

static gw_status join(loaded_scene *scene, scan *cloud, scan_points *points, gw_error *error)
{
	if (scene->cloud.column_count == 0) {
		scene->cloud = *cloud;
		scene->points = *points;
		*cloud = (scan){ 0 };
		*points = (scan_points){ 0 };
		return GW_OK;
	}
	GW_TRY(append_points(&scene->points, scene->cloud.count, points, error));
	GW_TRY(level_opacity(&scene->cloud, cloud, error));
	GW_TRY(level_opacity(cloud, &scene->cloud, error));
	return scan_append(&scene->cloud, cloud, error);
}

static gw_status check_up(const settings *s, loaded_scene *scene, char up, const char *path,
						  gw_error *error)
{
	if (s->up != SETTINGS_UP_AUTO)
		up = settings_up_axis(s->up);
	if (scene->up && scene->up != up)
		return gw_fail(error, GW_ERROR_USAGE,
					   "%s has %s up, but the inputs before it %s; say which holds with --up",
					   loaded_scene_input_name(path), settings_up_name(up),
					   settings_up_name(scene->up));
	scene->up = up;
	return GW_OK;
}

/* The axis that is up by custom where the formats of all inputs have the same; who gives a matrix
 * knows how they lie. */
static char custom_up(const settings *s, const loaded_scene *scene)
{
	char up = scene->input[0].format->custom_up;
	for (size_t i = 0; i < s->input_count; i++)
		if (s->input[i].has_matrix || scene->input[i].format->custom_up != up)
			return 0;
	return up;
}

/* Where nothing says which axis is up: does it look like y? */
static gw_status notice_up(const settings *s, loaded_scene *scene, gw_error *error)
{
	bool said = s->up != SETTINGS_UP_AUTO || scene->says_up || s->scanner_count > 0;
	bool doubtful = false;
	if (!said)
		scene->up = scan_up(&scene->cloud, scene->points.position, custom_up(s, scene), &doubtful);
	if (doubtful)
		return scan_add_comment(&scene->cloud,
								SCAN_NOTE "nothing says which axis points up, and z is taken; the "
										  "points lie as if it were y, with a floor and a ceiling "
										  "across it, with things on a floor, or open below: if y "
										  "points up, say --up y",
								error);
	return said || scene->up == scene->cloud.up
			   ? GW_OK
			   : scan_add_comment(&scene->cloud,
								  SCAN_NOTE "nothing says which axis points up, and y is taken, "
											"by how the points lie; if that is wrong, say --up z",
								  error);
}

bool loaded_scene_is_mesh(const settings *s, const settings_input *from)
{
	bool named = mesh_is_name(from->path) && !from->vertices && !s->format;
	return from->mesh || (named && mesh_has_faces(from->path));
}

static void place_points(const loaded_scene *scene, scan_points *points, size_t count)
{
	for (size_t i = 0; i < count && scene->place.changes; i++)
		coordinates_to_metres(&scene->place, points->position + 3 * i);
}

/* What the coordinates of an input are in, which has to be the same for all of them. */
static gw_status find_place(const settings *s, loaded_scene *scene, size_t input, scan *cloud,
							gw_error *error)
{
	coordinates own;
	gw_error reason = { 0 };
	const char *name = loaded_scene_input_name(s->input[input].path);
	gw_status status = coordinates_find(cloud, (coordinates_unit)s->length, &own, &reason);
	if (status != GW_OK)
		return gw_fail(error, status, "%s: %.900s", name, reason.text);
	if (own.changes && s->path_count > 0)
		status =
			gw_fail(error, GW_ERROR_USAGE,
					"%s: the coordinates are %s, but what moves by frames needs metres; convert "
					"the file, or say --units m",
					name, own.name);
	bool first = true;
	for (size_t i = 0; i < input; i++)
		first = first && scene->input[i].is_mesh;
	if (status == GW_OK && !first && !coordinates_agree(&own, &scene->place))
		status =
			gw_fail(error, GW_ERROR_USAGE,
					"%s has coordinates in %s, but the inputs before it in %s; say which holds "
					"with --units",
					name, own.name, scene->place.name);
	if (status == GW_OK && first) {
		coordinates_clear(&scene->place);
		scene->place = own;
		return GW_OK;
	}
	coordinates_clear(&own);
	return status;
}

/* What is known of inputs that come in parts. */
static void note_parted(const settings *s, loaded_scene *scene)
{
	for (size_t i = 0; i < s->input_count; i++) {
		const gathered_input *own = scene->parted->input ? &scene->parted->input[i] : NULL;
		loaded_input *facts = &scene->input[i];
		facts->path = s->input[i].path;
		facts->format = own ? own->format : scene->parted->file.found;
		facts->points = own ? own->points : scene->parted->file.count;
		facts->left_out = own ? own->left_out : facts->left_out;
		if (i == 0)
			continue;
		memcpy(facts->albedo_source, scene->input[0].albedo_source, sizeof facts->albedo_source);
		facts->albedo_missing = scene->input[0].albedo_missing;
		facts->albedo_told = scene->input[0].albedo_told;
		facts->albedo_mean = scene->input[0].albedo_mean;
		facts->lit = scene->input[0].lit;
	}
	scene->input_count = s->input_count;
}

static gw_status read_each(const settings *s, scan *kept, loaded_scene *scene, part *parts,
						   gw_error *error)
{
	for (size_t i = 0; i < clouds_read(s, scene); i++) {
		const settings_input *from = &s->input[i];
		loaded_input *facts = &scene->input[i];
		facts->path = from->path;
		facts->is_mesh = loaded_scene_is_mesh(s, from);
		scene->input_count = i + 1;
		if (facts->is_mesh)
			GW_TRY(read_mesh(s, from, facts, error));
		else
			GW_TRY(read_cloud(s, i, kept, parts, scene, error));
		if (!facts->is_mesh)
			GW_TRY(find_place(s, scene, i, &parts[i].cloud, error));
		GW_TRY(signals_check(error));
	}
	return GW_OK;
}

/* Clouds become points; meshes are read, but how densely to sample them is known only when all
 * clouds are there. */
static gw_status read_parts(const settings *s, loaded_scene *scene, part *parts, gw_error *error)
{
	scan kept = { 0 };
	gw_status status = read_each(s, &kept, scene, parts, error);
	scan_clear(&kept);
	return status;
}

/* What intensity counts to in several clouds together: so that one that is darker stays so. */
static gw_status find_full_intensity(const settings *s, const loaded_scene *scene,
									 const part *parts, float *full, gw_error *error)
{
	size_t clouds = 0, count = 0;
	float *all = NULL;
	gw_status status = GW_OK;
	*full = 0.0f;
	for (size_t i = 0; i < s->input_count; i++)
		clouds += !scene->input[i].is_mesh;
	bool needed = s->points.albedo == SCAN_ALBEDO_INTENSITY && clouds > 1;
	for (size_t i = 0; i < s->input_count && needed && status == GW_OK; i++) {
		const scan *cloud = &parts[i].cloud;
		if (scene->input[i].is_mesh || !scan_find_scalar(cloud, "intensity"))
			continue;
		char how[120];
		float *own;
		status = scan_intensity_make(cloud, s->bake.threads, &own, how, error);
		if (status == GW_OK)
			status = append_floats(&all, count, own, cloud->count, error);
		count += cloud->count;
		free(own);
	}
	if (status == GW_OK && all)
		*full = scan_intensity_full(all, count);
	free(all);
	return status;
}

/* From the clouds' columns to points. */
static gw_status finish_clouds(const settings *s, loaded_scene *scene, part *parts, gw_error *error)
{
	settings scaled = *s; /* nothing of it is freed */
	GW_TRY(find_full_intensity(s, scene, parts, &scaled.points.intensity_full, error));
	scaled.points.threads = s->bake.threads;
	scaled.points.told = scene->parted ? &scene->parted->told : NULL;
	for (size_t i = 0; i < clouds_read(s, scene); i++) {
		if (scene->input[i].is_mesh)
			continue;
		GW_TRY(finish_part(&scaled, &s->input[i], &parts[i], &scene->input[i], error));
		if (scene->parted)
			note_parted(s, scene);
		place_points(scene, &parts[i].points, parts[i].cloud.count);
		GW_TRY(signals_check(error));
	}
	return GW_OK;
}

/* Brings an input behind those before it. */
static gw_status join_part(const settings *s, loaded_scene *scene, size_t i, double density,
						   part *p, gw_error *error)
{
	loaded_input *facts = &scene->input[i];
	if (facts->is_mesh) {
		GW_TRY(sample_mesh(s, i, density, facts, p, error));
		place_points(scene, &p->points, p->cloud.count);
	}
	/* A mesh that does not say which way is up follows the inputs before it. */
	bool follows = facts->is_mesh && !facts->mesh.up && scene->up;
	GW_TRY(check_up(s, scene, follows ? scene->up : p->cloud.up, s->input[i].path, error));
	scene->says_up = scene->says_up || p->cloud.says_up || (facts->is_mesh && facts->mesh.up);
	return join(scene, &p->cloud, &p->points, error);
}

static gw_status join_parts(const settings *s, loaded_scene *scene, part *parts, gw_error *error)
{
	double density;
	GW_TRY(find_density(s, scene, parts, &density, error));
	for (size_t i = 0; i < clouds_read(s, scene); i++) {
		gw_status status = join_part(s, scene, i, density, &parts[i], error);
		scan_clear(&parts[i].cloud);
		scan_points_clear(&parts[i].points);
		GW_TRY(status);
		GW_TRY(signals_check(error));
	}
	return GW_OK;
}

static gw_status read_and_join(const settings *s, loaded_scene *scene, part *parts, gw_error *error)
{
	GW_TRY(read_parts(s, scene, parts, error));
	GW_TRY(finish_clouds(s, scene, parts, error));
	return join_parts(s, scene, parts, error);
}

static gw_status read_all(const settings *s, loaded_scene *scene, gw_error *error)
{
	part *parts = calloc(s->input_count, sizeof *parts);
	scene->input = calloc(s->input_count, sizeof *scene->input);
	gw_status status = parts && scene->input ? read_and_join(s, scene, parts, error)
											 : gw_fail(error, GW_ERROR_MEMORY,
													   "no memory for %zu inputs", s->input_count);
	for (size_t i = 0; parts && i < s->input_count; i++) {
		scan_clear(&parts[i].cloud);
		scan_points_clear(&parts[i].points);
	}
	free(parts);
	return status;
}

static gw_status place_scanners(loaded_scene *scene, gw_error *error)
{
	size_t count = scene->cloud.scanner_count;
	for (size_t i = 0; i < scene->cloud.image_count && scene->place.changes; i++)
		coordinates_to_metres(&scene->place, scene->cloud.image[i].scanner);
	if (!scene->place.changes || count == 0)
		return GW_OK;
	scene->scanner = reallocarray(NULL, count, 3 * sizeof *scene->scanner);
	if (!scene->scanner)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu scanners", count);
	memcpy(scene->scanner, scene->cloud.scanner, 3 * count * sizeof *scene->scanner);
	for (size_t i = 0; i < count; i++)
		coordinates_to_metres(&scene->place, scene->scanner + 3 * i);
	return GW_OK;
}

static void replace_scanners(scan *cloud, double *place, size_t count)
{
	free(cloud->scanner);
	free(cloud->scanner_of);
	cloud->scanner = place;
	cloud->scanner_count = count;
	cloud->scanner_of = NULL;
}

/* Scanners that the user names go before those of the files: who saw which point is then open. */
static gw_status take_scanners(const settings *s, scan *cloud, gw_error *error)
{
	if (s->scanner_none)
		replace_scanners(cloud, NULL, 0);
	if (s->scanner_count == 0)
		return GW_OK;
	double *place = reallocarray(NULL, s->scanner_count, 3 * sizeof *place);
	if (!place)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu scanners", s->scanner_count);
	memcpy(place, s->scanner, 3 * s->scanner_count * sizeof *place);
	replace_scanners(cloud, place, s->scanner_count);
	return GW_OK;
}

/* The points as the library takes them. */
static void point_out(const settings *s, loaded_scene *scene)
{
	scan_points *p = &scene->points;
	p->points = (gw_points){ .count = scene->cloud.count,
							 .position = p->position,
							 .normal = p->normal,
							 .normal_sideless = p->points.normal_sideless,
							 .albedo = p->albedo,
							 .emission = p->emission,
							 .opacity = p->opacity,
							 .beam_share = p->beam_share,
							 .stray = p->stray,
							 .keep_strays = s->strays == SETTINGS_STRAYS_KEEP,
							 .up = scene->up,
							 .scanner = scene->scanner ? scene->scanner : scene->cloud.scanner,
							 .scanner_count = scene->cloud.scanner_count,
							 .scanner_of = scene->cloud.scanner_of,
							 .image = scene->cloud.image,
							 .image_count = scene->cloud.image_count,
							 .image_cell = scene->cloud.image_cell,
							 .instance = scene->instance,
							 .instance_count = scene->instance_count };
}

gw_status loaded_scene_read(const settings *s, loaded_scene *scene, gw_error *error)
{
	return loaded_scene_read_parted(s, NULL, scene, error);
}

gw_status loaded_scene_read_parted(const settings *s, parted_cloud *parted, loaded_scene *scene,
								   gw_error *error)
{
	*scene = (loaded_scene){ .place = coordinates_metres(), .parted = parted };
	gw_status status = read_all(s, scene, error);
	if (status != GW_OK) {
		loaded_scene_clear(scene);
		return status;
	}
	status = take_scanners(s, &scene->cloud, error);
	if (status != GW_OK) {
		loaded_scene_clear(scene);
		return status;
	}
	status = place_scanners(scene, error);
	if (status == GW_OK)
		status = notice_up(s, scene, error);
	if (status == GW_OK)
		status = scene_instances_list(s, scene, &scene->instance, &scene->instance_count, error);
	if (status != GW_OK) {
		loaded_scene_clear(scene);
		return status;
	}
	point_out(s, scene);
	return GW_OK;
}

gw_status loaded_scene_read_part(const settings *s, const loaded_scene *whole, uint64_t number,
								 loaded_scene *scene, gw_error *error)
{
	scan cloud;
	*scene = (loaded_scene){ .place = whole->place };
	GW_TRY(parted_cloud_read(whole->parted, number, &cloud, error));
	return loaded_scene_take_part(s, whole, &cloud, scene, error);
}

gw_status loaded_scene_take_part(const settings *s, const loaded_scene *whole, scan *cloud,
								 loaded_scene *scene, gw_error *error)
{
	settings of_part = *s; /* nothing of it is freed */
	part p = { .cloud = *cloud };
	loaded_input facts = { .path = s->input[0].path };
	of_part.points.threads = s->bake.threads;
	of_part.points.told = &whole->parted->told;
	*scene = (loaded_scene){ .up = whole->up, .place = whole->place };
	*cloud = (scan){ 0 };
	gw_status status = finish_part(&of_part, &s->input[0], &p, &facts, error);
	scene->cloud = p.cloud;
	scene->points = p.points;
	if (status != GW_OK) {
		loaded_scene_clear_part(scene);
		return status;
	}
	place_points(scene, &scene->points, scene->cloud.count);
	point_out(s, scene);
	return GW_OK;
}

void loaded_scene_clear_part(loaded_scene *scene)
{
	scan_clear(&scene->cloud);
	scan_points_clear(&scene->points);
	*scene = (loaded_scene){ 0 };
}

void loaded_scene_clear(loaded_scene *scene)
{
	scan_clear(&scene->cloud);
	scan_points_clear(&scene->points);
	for (size_t i = 0; i < scene->input_count; i++)
		mesh_clear(&scene->input[i].mesh);
	for (size_t i = 0; i < scene->map_count; i++)
		panorama_clear(&scene->map[i]);
	free(scene->map);
	free(scene->light);
	free(scene->input);
	free(scene->scanner);
	free(scene->instance);
	coordinates_clear(&scene->place);
	*scene = (loaded_scene){ .place = coordinates_metres() };
}

void loaded_scene_place(const coordinates *place, char up, lamp *light)
{
	double at[3];
	memcpy(at, light->light.position, sizeof at);
	coordinates_to_metres(place, at);
	coordinates_to_metres(place, light->target);
	for (int k = 0; k < 3; k++)
		light->light.position[k] = at[k];
	light_resolve(light, up);
}

/* Places by name, found when the first light asks for one of the floor. */
typedef struct named_places {
	const loaded_scene *scene;
	double floor[3 * FLOOR_PLACES_MAX]; /* metres */
	size_t floors;
	bool looked;
} named_places;

static gw_status find_floor(named_places *p, gw_error *error)
{
	const loaded_scene *scene = p->scene;
	if (p->looked)
		return GW_OK;
	p->looked = true;
	return floor_places_find(scene->points.position, scene->cloud.count, scene->up, p->floor,
							 &p->floors, error);
}

/* Puts the coordinates of a place into to; light: for messages, from 0. */
static gw_status name_place(named_places *p, const light_place *place, size_t light, double to[3],
							gw_error *error)
{
	const scan *cloud = &p->scene->cloud;
	double axis[3][3];
	if (place->kind == LIGHT_PLACE_NONE)
		return GW_OK;
	if (place->kind == LIGHT_PLACE_SCANNER) {
		if (place->number > cloud->scanner_count)
			return gw_fail(
				error, GW_ERROR_USAGE,
				"light %zu is to stand at, or shine to, scanner %zu, but the inputs tell "
				"of %zu; glowworm info --places lists them, --scanner adds one",
				light + 1, place->number, cloud->scanner_count);
		memcpy(to, cloud->scanner + 3 * (place->number - 1), 3 * sizeof *to);
		return GW_OK;
	}
	GW_TRY(find_floor(p, error));
	if (p->floors == 0)
		return gw_fail(error, GW_ERROR_USAGE,
					   "light %zu is to stand at, or shine to, floor %zu, but no floor is free; "
					   "give its place as X,Y,Z",
					   light + 1, place->number);
	if (place->number > p->floors)
		return gw_fail(error, GW_ERROR_USAGE,
					   "light %zu is to stand at, or shine to, floor %zu, but the last free floor "
					   "is floor:%zu; glowworm info --places lists them",
					   light + 1, place->number, p->floors);
	gw_camera_stand(p->scene->up, axis[0], axis[1], axis[2]);
	for (int k = 0; k < 3; k++)
		to[k] = p->floor[3 * (place->number - 1) + (size_t)k] + place->height * axis[2][k];
	coordinates_from_metres(&p->scene->place, to);
	return GW_OK;
}

gw_status loaded_scene_name_places(const loaded_scene *scene, settings *s, gw_error *error)
{
	named_places places = { .scene = scene };
	for (size_t i = 0; i < s->light_count; i++) {
		lamp *light = &s->light[i];
		GW_TRY(name_place(&places, &light->stand, i, light->light.position, error));
		GW_TRY(name_place(&places, &light->aim, i, light->target, error));
		light->stand.kind = light->aim.kind = LIGHT_PLACE_NONE;
		if (light->aimed && memcmp(light->target, light->light.position, sizeof light->target) == 0)
			return gw_fail(error, GW_ERROR_USAGE, "light %zu cannot shine to the place where it is",
						   i + 1);
	}
	return GW_OK;
}

static bool emits(const loaded_scene *scene)
{
	const float *emission = scene->points.emission;
	for (size_t i = 0; emission && i < 3 * scene->cloud.count; i++)
		if (emission[i] > 0.0f && isfinite(emission[i]))
			return true;
	return false;
}

/* Reads or makes the maps of environment lights; the scene owns their pixels. placed: light_count
 * resolved lamps, whose lights go into `lights`. */
static gw_status read_maps(loaded_scene *scene, const settings *s, lamp *placed, gw_light *lights,
						   gw_error *error)
{
	for (size_t i = 0; i < s->light_count; i++) {
		lights[i] = placed[i].light;
		if (!placed[i].map[0] && !placed[i].model)
			continue;
		panorama *grown = growing_table_room(scene->map, scene->map_count, sizeof *grown);
		if (!grown)
			return gw_fail(error, GW_ERROR_MEMORY, "no memory for the list of maps");
		scene->map = grown;
		GW_TRY(sky_light_map(&placed[i], scene->up, &grown[scene->map_count], error));
		const panorama *map = &grown[scene->map_count++];
		lights[i] = placed[i].light;
		lights[i].map = map->pixels;
		lights[i].map_width = map->width;
		lights[i].map_height = map->height;
	}
	return GW_OK;
}

gw_status loaded_scene_lights(loaded_scene *scene, settings *s, gw_light **lights, gw_error *error)
{
	size_t count = s->light_count ? s->light_count : 1, bytes = count * sizeof **lights;
	if (s->light_count == 0 && s->bake.bounces != 0 && !emits(scene))
		return gw_fail(error, GW_ERROR_USAGE,
					   "nothing here gives light: there is no --light, and no point has emission; "
					   "try --light 'sky radiance 1'");
	GW_TRY(loaded_scene_name_places(scene, s, error));
	*lights = calloc(count, sizeof **lights);
	free(scene->light);
	scene->light = calloc(count, sizeof **lights);
	lamp *placed = calloc(count, sizeof *placed);
	if (!*lights || !placed || !scene->light) {
		free(placed);
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu lights", s->light_count);
	}
	for (size_t i = 0; i < s->light_count; i++) {
		placed[i] = s->light[i];
		loaded_scene_place(&scene->place, scene->up, &placed[i]);
		light_resolve(&s->light[i], scene->up);
	}
	gw_status status = read_maps(scene, s, placed, *lights, error);
	if (status == GW_OK)
		memcpy(scene->light, *lights, bytes);
	free(placed);
	return status;
}

void loaded_scene_put_map(const loaded_scene *scene, const lamp *light, size_t i, gw_light *to)
{
	const gw_light *read = &scene->light[i];
	if (!read->map)
		return;
	to->map = read->map;
	to->map_width = read->map_width;
	to->map_height = read->map_height;
	if (light->model || light->measure == LIGHT_KEY_ILLUMINANCE)
		memcpy(to->radiance, read->radiance, sizeof to->radiance);
}
