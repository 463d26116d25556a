/*
 * From scan to points: which columns are positions, normals, albedo and emission, and in what
 * encoding. Values are handed on as they are; the library repairs and counts bad ones.
 */
#include "glowworm_picture.h"
#include "points/scan_color.h"
#include "points/scan_opacity.h"
#include "points/scan_intensity.h"
#include "points/scan_told.h"
#include "points/scan_splats.h"
#include "glowworm_host.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const normal_names[3] = { "nx", "ny", "nz" };
static const char *const emission_names[3] = { "emission_r", "emission_g", "emission_b" };

static gw_status allocate_triples(float **values, size_t count, gw_error *error)
{
	*values = reallocarray(NULL, count, 3 * sizeof **values);
	if (!*values)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for attributes of %zu points", count);
	return GW_OK;
}

/* Interleaves three columns; a missing one gives zeros. */
static gw_status gather(float **values, const scan_column *const column[3], size_t count,
						gw_error *error)
{
	GW_TRY(allocate_triples(values, count, error));
	for (size_t k = 0; k < 3; k++)
		for (size_t i = 0; i < count; i++)
			(*values)[3 * i + k] = column[k] ? (float)scan_value(column[k], i) : 0.0f;
	return GW_OK;
}

/* ---------------------------------------------------------------------------- positions */

static gw_status make_positions(const scan *cloud, scan_points *out, gw_error *error)
{
	static const char *const names[3] = { "x", "y", "z" };
	out->position = reallocarray(NULL, cloud->count, 3 * sizeof *out->position);
	if (!out->position)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for positions of %zu points",
					   cloud->count);
	for (size_t k = 0; k < 3; k++) {
		const scan_column *column = scan_find(cloud, names[k]);
		if (!column)
			return gw_fail(error, GW_ERROR_DATA, "the points have no coordinate '%s'", names[k]);
		for (size_t i = 0; i < cloud->count; i++)
			out->position[3 * i + k] = scan_value(column, i);
	}
	return GW_OK;
}

/* ------------------------------------------------------------------------------- albedo */

/* Colours to linear albedo. Integer colours have few different values: those are decoded once. */
static gw_status albedo_of_color(const scan_color *color, size_t count, bool linear, float *albedo,
								 gw_error *error)
{
	for (int k = 0; k < 3; k++) {
		scan_type type = color->column[k]->type;
		size_t entries = (size_t)color->range + 1;
		bool small = type != SCAN_FLOAT32 && type != SCAN_FLOAT64;
		float *decoded = small ? reallocarray(NULL, entries, sizeof *decoded) : NULL;
		if (small && !decoded)
			return gw_fail(error, GW_ERROR_MEMORY, "no memory for a table of colours");
		for (size_t e = 0; e < entries && small; e++) {
			double value = (double)e / color->range;
			decoded[e] = (float)(linear ? value : scan_srgb_decode(value));
		}
		for (size_t i = 0; i < count; i++) {
			double value = scan_color_value(color, k, i);
			double entry = value * color->range + 0.5;
			float *to = &albedo[3 * i + (size_t)k];
			if (small && entry >= 0.0 && entry < (double)entries)
				*to = decoded[(size_t)entry];
			else
				*to = (float)(linear ? value : scan_srgb_decode(value));
		}
		free(decoded);
	}
	return GW_OK;
}

static void fill_grey(scan_points *out, size_t count, const scan_column *column, double divisor)
{
	for (size_t i = 0; i < count; i++) {
		float value = (float)(scan_value(column, i) / divisor);
		for (size_t k = 0; k < 3; k++)
			out->albedo[3 * i + k] = value;
	}
}

static gw_status albedo_of_intensity(const scan *cloud, const scan_points_options *options,
									 scan_points *out, gw_error *error)
{
	float *value = NULL, full = options->intensity_full;
	char how[120] = "";
	gw_status status = scan_intensity_make(cloud, options->threads, &value, how, error);
	for (size_t i = 0; i < 3 * cloud->count && status == GW_OK; i++)
		out->albedo[i] = value[i / 3];
	if (status == GW_OK && !(full > 0.0f))
		full = scan_intensity_full(value, cloud->count);
	free(value);
	GW_TRY(status);
	if (!(full > 0.0f))
		return gw_fail(error, GW_ERROR_DATA,
					   "the albedo shall come from the intensity, but that is zero almost "
					   "everywhere; choose another source");
	for (size_t i = 0; i < 3 * cloud->count; i++)
		out->albedo[i] /= full;
	snprintf(out->albedo_source, sizeof out->albedo_source,
			 "the intensity, of which the 99th percentile%s, %s, counts as 1%s%s",
			 options->intensity_full > 0.0f ? " of all inputs" : "", GW_SAID((double)full, 6),
			 how[0] ? ", " : "", how);
	return GW_OK;
}

static gw_status albedo_of_property(const scan *cloud, const char *name, scan_points *out,
									gw_error *error)
{
	const scan_column *column = name ? scan_find_scalar(cloud, name) : NULL;
	if (!column)
		return gw_fail(error, GW_ERROR_USAGE,
					   "the albedo shall come from the property '%s', which the points do not "
					   "have",
					   name ? name : "");
	fill_grey(out, cloud->count, column, 1.0);
	snprintf(out->albedo_source, sizeof out->albedo_source, "the property '%.80s', taken as linear",
			 name);
	return GW_OK;
}

static void albedo_constant(scan_points *out, size_t count, float value, const char *reason)
{
	for (size_t i = 0; i < 3 * count; i++)
		out->albedo[i] = value;
	snprintf(out->albedo_source, sizeof out->albedo_source, "the constant %g, %s", (double)value,
			 reason);
}

/* Points without colour among others get what is usual. */
static void fill_blank(const scan_color *color, const scan_told *told, size_t count,
					   scan_points *out)
{
	size_t blank = told ? told->blank : scan_color_count_blank(color, count);
	size_t length = strlen(out->albedo_source);
	if (blank == 0)
		return;
	for (size_t i = 0; i < count; i++)
		for (size_t k = 0; k < 3 && scan_color_is_black(color, i); k++)
			out->albedo[3 * i + k] = GW_ALBEDO_DEFAULT;
	snprintf(out->albedo_source + length, sizeof out->albedo_source - length,
			 "; %zu point%s exactly black %s none and %s %g, but for --albedo rgb", blank,
			 gw_plural(blank, " that is", "s that are"), gw_plural(blank, "has", "have"),
			 gw_plural(blank, "gets", "get"), (double)GW_ALBEDO_DEFAULT);
	out->albedo_told = true;
}

/* albedo_* before colours; colours that are all black are a scanner without a camera. */
static gw_status albedo_of_colors(const scan *cloud, const scan_points_options *options,
								  scan_points *out, gw_error *error)
{
	bool forced = options->albedo == SCAN_ALBEDO_COLOR;
	const char *encoding = options->linear_colors ? "taken as linear" : "decoded from sRGB";
	scan_color color;
	bool own = scan_told_color(options->told, cloud, true, &color);
	bool any = own || scan_told_color(options->told, cloud, false, &color);
	if (!any && forced)
		return gw_fail(
			error, GW_ERROR_USAGE,
			"the albedo shall come from colours, but the points have none; bake --albedo "
			"intensity, property:NAME or constant:V takes it from elsewhere");
	if (!any || (color.black && !forced)) {
		albedo_constant(out, cloud->count, GW_ALBEDO_DEFAULT,
						any ? "because all colours are black"
							: "because the points have no colours");
		return GW_OK;
	}
	snprintf(out->albedo_source, sizeof out->albedo_source, "%s, %s, where %g is full%s",
			 own ? "albedo_r albedo_g albedo_b" : "red green blue", encoding, color.range,
			 color.told ? ", as the values tell" : "");
	out->albedo_told = color.told;
	GW_TRY(albedo_of_color(&color, cloud->count, options->linear_colors, out->albedo, error));
	if (!own && !forced)
		fill_blank(&color, options->told, cloud->count, out);
	return GW_OK;
}

static gw_status make_albedo(const scan *cloud, const scan_points_options *options,
							 scan_points *out, gw_error *error)
{
	GW_TRY(allocate_triples(&out->albedo, cloud->count, error));
	gw_status status = GW_OK;
	switch (options->albedo) {
	case SCAN_ALBEDO_CONSTANT:
		albedo_constant(out, cloud->count, options->constant, "as asked for");
		break;
	case SCAN_ALBEDO_INTENSITY:
		status = albedo_of_intensity(cloud, options, out, error);
		break;
	case SCAN_ALBEDO_PROPERTY:
		status = albedo_of_property(cloud, options->property, out, error);
		break;
	case SCAN_ALBEDO_AUTO:
	case SCAN_ALBEDO_COLOR:
	case SCAN_ALBEDO_COUNT:
		status = albedo_of_colors(cloud, options, out, error);
		break;
	}
	if (status != GW_OK || (options->scale == 1.0f && options->white == 0.0f))
		return status;
	for (size_t i = 0; i < 3 * cloud->count; i++) {
		float rho = out->albedo[i] * options->scale;
		out->albedo[i] = rho + options->white * (1.0f - rho);
	}
	return GW_OK;
}

/* ------------------------------------------------------------------------------- strays */

static bool is_noise(const scan *cloud, const scan_column *class, size_t i)
{
	double value = class ? scan_value(class, i) : 0.0;
	return value >= 0.0 && value < 32.0 && (cloud->noise_classes >> (unsigned)value & 1);
}

/* Noise is little: classes that a tenth of the points have mean something else. */
static bool classes_mean_noise(const scan *cloud, const scan_column *class)
{
	size_t noise = 0;
	for (size_t i = 0; i < cloud->count; i++)
		noise += is_noise(cloud, class, i);
	return noise < cloud->count / 10;
}

static gw_status make_strays(const scan *cloud, scan_points *out, gw_error *error)
{
	const scan_column *class = scan_find(cloud, "classification");
	const scan_column *withheld = scan_find(cloud, "withheld");
	const scan_column *splats = scan_find(cloud, SCAN_SPLAT_OPACITY);
	bool classes = cloud->noise_classes && (class || withheld);
	if (!classes && !splats)
		return GW_OK;
	out->stray = calloc(cloud->count, 1);
	if (!out->stray)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for classes of %zu points", cloud->count);
	class = classes && classes_mean_noise(cloud, class) ? class : NULL;
	for (size_t i = 0; i < cloud->count; i++) {
		if (is_noise(cloud, class, i))
			out->stray[i] = 1 + GW_STRAY_NOISE;
		else if (classes && withheld && scan_value(withheld, i) != 0.0)
			out->stray[i] = 1 + GW_STRAY_WITHHELD;
		else if (scan_is_haze(splats, i))
			out->stray[i] = 1 + GW_STRAY_HAZE;
	}
	return GW_OK;
}

/* ---------------------------------------------------------------------------- everything */

static gw_status check_options(const scan_points_options *options, gw_error *error)
{
	if (!(options->scale >= 0.0f && isfinite(options->scale)))
		return gw_fail(error, GW_ERROR_USAGE, "the albedo cannot be scaled by %g; use 0 or more",
					   (double)options->scale);
	if (!(options->white >= 0.0f && options->white <= 1.0f))
		return gw_fail(error, GW_ERROR_USAGE, "the blend towards white is %g; use 0 to 1",
					   (double)options->white);
	if (options->albedo == SCAN_ALBEDO_CONSTANT &&
		!(options->constant >= 0.0f && options->constant <= 1.0f))
		return gw_fail(error, GW_ERROR_USAGE, "the constant albedo is %g; use 0 to 1",
					   (double)options->constant);
	return GW_OK;
}

/* A pulse of an airborne laser that met several things has a point for each: as much of it stopped
 * at each, for want of better. None where all pulses met one. */
static gw_status make_beam_shares(const scan *cloud, scan_points *out, gw_error *error)
{
	const scan_column *returns = scan_find_scalar(cloud, "number_of_returns");
	bool several = false;
	for (size_t i = 0; returns && i < cloud->count && !several; i++)
		several = scan_value(returns, i) > 1.0;
	if (!several)
		return GW_OK;
	out->beam_share = reallocarray(NULL, cloud->count, sizeof *out->beam_share);
	if (!out->beam_share)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the beams of %zu points",
					   cloud->count);
	for (size_t i = 0; i < cloud->count; i++) {
		double count = scan_value(returns, i);
		out->beam_share[i] = count > 1.0 ? (float)(1.0 / count) : 1.0f;
	}
	return GW_OK;
}

static gw_status make_all(const scan *cloud, const scan_points_options *options, scan_points *out,
						  gw_error *error)
{
	GW_TRY(check_options(options, error));
	GW_TRY(make_positions(cloud, out, error));
	GW_TRY(make_albedo(cloud, options, out, error));
	GW_TRY(make_strays(cloud, out, error));
	const scan_column *column[3];
	bool sides = scan_find_triple(cloud, normal_names, column);
	out->points.normal_sideless = !sides && scan_find_triple(cloud, scan_axis_names, column);
	if (sides || out->points.normal_sideless)
		GW_TRY(gather(&out->normal, column, cloud->count, error));
	bool all = scan_find_triple(cloud, emission_names, column);
	if (all || column[0] || column[1] || column[2])
		GW_TRY(gather(&out->emission, column, cloud->count, error));
	GW_TRY(make_beam_shares(cloud, out, error));
	return scan_opacity_make(cloud, options->told ? &options->told->opacity : NULL, &out->opacity,
							 error);
}

gw_status scan_points_make(const scan *cloud, const scan_points_options *options, scan_points *out,
						   gw_error *error)
{
	memset(out, 0, sizeof *out);
	if (cloud->count == 0)
		return gw_fail(error, GW_ERROR_DATA, "there are no points");
	gw_status status = make_all(cloud, options, out, error);
	if (status != GW_OK) {
		scan_points_clear(out);
		return status;
	}
	out->points = (gw_points){ .count = cloud->count,
							   .position = out->position,
							   .normal = out->normal,
							   .normal_sideless = out->points.normal_sideless,
							   .albedo = out->albedo,
							   .emission = out->emission,
							   .opacity = out->opacity,
							   .beam_share = out->beam_share,
							   .stray = out->stray,
							   .scanner = cloud->scanner,
							   .scanner_count = cloud->scanner_count,
							   .scanner_of = cloud->scanner_of,
							   .image = cloud->image,
							   .image_count = cloud->image_count,
							   .image_cell = cloud->image_cell };
	return GW_OK;
}

void scan_points_clear(scan_points *points)
{
	free(points->position);
	free(points->normal);
	free(points->albedo);
	free(points->emission);
	free(points->opacity);
	free(points->beam_share);
	free(points->stray);
	memset(points, 0, sizeof *points);
}

char scan_up(const scan *cloud, const double *position, char custom, bool *doubtful)
{
	bool said = cloud->up != 'z' || cloud->says_up || cloud->scanner_count > 0, sure = false;
	bool likely = !said && gw_likely_up(position, cloud->count, &sure);
	sure = sure || custom == 'y';
	*doubtful = likely && !sure;
	return likely && sure ? 'y' : cloud->up;
}
