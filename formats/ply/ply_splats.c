/* ply_splats.c - see ply_splats.h. */
#include "ply/ply_splats.h"

#include "glowworm_host.h"
#include "points/scan_splats.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* The constant spherical harmonic, 1 / (2 sqrt pi). */
#define HARMONIC 0.28209479177387814

/* The thinnest axis is clearly so where it is less than half as long as the next: ln 2. */
#define CLEARLY_THINNER 0.69314718055994531

static const char *const color_names[3] = { "red", "green", "blue" };
static const char *const harmonic_names[3] = { "f_dc_0", "f_dc_1", "f_dc_2" };
static const char *const scale_names[3] = { "scale_0", "scale_1", "scale_2" };
static const char *const turn_names[4] = { "rot_0", "rot_1", "rot_2", "rot_3" };
static const char *const normal_names[3] = { "nx", "ny", "nz" };

bool ply_is_splats(const ply_element *vertex)
{
	static const char *const needed[] = { "f_dc_0", "opacity", "scale_0", "rot_0" };
	size_t found = 0;
	for (size_t n = 0; n < sizeof needed / sizeof *needed; n++)
		for (size_t i = 0; i < vertex->property_count; i++)
			found += !vertex->property[i].list && strcmp(vertex->property[i].name, needed[n]) == 0;
	return found == sizeof needed / sizeof *needed;
}

bool ply_is_splat_shine(const char *name)
{
	static const char prefix[] = "f_rest_";
	return strncmp(name, prefix, sizeof prefix - 1) == 0;
}

static void remove_all(scan *cloud, const char *const *name, size_t count)
{
	for (size_t n = 0; n < count; n++)
		scan_remove_column(cloud, name[n]);
}

/* ------------------------------------------------------------------------------- colours */

/* Black is a colour here, but exactly black is what scanners write where their camera saw nothing
 * (scan_color_count_blank): so it is 1 of 255. */
static double byte_of(double harmonic)
{
	double value = 0.5 + HARMONIC * harmonic;
	return isfinite(value) ? fmin(fmax(255.0 * value + 0.5, 1.0), 255.0) : 128.0;
}

/* A file that has colours beside knows why. */
static gw_status take_colors(scan *cloud, gw_error *error)
{
	for (int k = 0; k < 3; k++) {
		if (scan_find(cloud, color_names[k]))
			continue;
		scan_column *to = scan_add_column(cloud, color_names[k], SCAN_UINT8, error);
		if (!to)
			return GW_ERROR_MEMORY;
		const scan_column *from = scan_find(cloud, harmonic_names[k]);
		for (size_t i = 0; i < cloud->count; i++)
			scan_store(to, i, byte_of(from ? scan_value(from, i) : 0.0));
	}
	return GW_OK;
}

/* ------------------------------------------------------------------------------- opacity */

static gw_status take_opacity(scan *cloud, uint64_t *haze, gw_error *error)
{
	scan_column *to = scan_add_column(cloud, SCAN_SPLAT_OPACITY, SCAN_FLOAT32, error);
	if (!to)
		return GW_ERROR_MEMORY;
	const scan_column *from = scan_find(cloud, "opacity");
	for (size_t i = 0; i < cloud->count; i++) {
		double logit = scan_value(from, i);
		scan_store(to, i, isnan(logit) ? 0.0 : 1.0 / (1.0 + exp(-logit)));
		*haze += scan_is_haze(to, i);
	}
	return GW_OK;
}

/* ------------------------------------------------------------------------------- normals */

/* Trainers write normals of 0, 0, 0. */
static bool has_normals(const scan *cloud)
{
	for (int k = 0; k < 3; k++) {
		const scan_column *column = scan_find(cloud, normal_names[k]);
		for (size_t i = 0; column && i < cloud->count; i++)
			if (scan_value(column, i) != 0.0)
				return true;
	}
	return false;
}

/* Which axis is clearly the thinnest, or -1. Splats without a third scale are flat across it. */
static int thinnest(const scan_column *const scale[3], size_t i)
{
	if (!scale[2])
		return 2;
	int least = 0;
	double value[3], next = INFINITY;
	for (int k = 0; k < 3; k++) {
		value[k] = scan_value(scale[k], i);
		least = value[k] < value[least] ? k : least;
	}
	for (int k = 0; k < 3; k++)
		next = k == least ? next : fmin(next, value[k]);
	return next - value[least] > CLEARLY_THINNER ? least : -1;
}

/* Column k of the matrix of a quaternion, 0, 0, 0 where it is none. */
static void axis_of(const double turn[4], int k, double axis[3])
{
	double square = 0.0, w = turn[0], v[3] = { turn[1], turn[2], turn[3] };
	for (int j = 0; j < 4; j++)
		square += turn[j] * turn[j];
	bool good = square > 0.0 && isfinite(square);
	int next = (k + 1) % 3, last = (k + 2) % 3;
	axis[k] = good ? 1.0 - 2.0 * (v[next] * v[next] + v[last] * v[last]) / square : 0.0;
	axis[next] = good ? 2.0 * (v[k] * v[next] + w * v[last]) / square : 0.0;
	axis[last] = good ? 2.0 * (v[k] * v[last] - w * v[next]) / square : 0.0;
}

static bool find_columns(const scan *cloud, const scan_column *scale[3], const scan_column *turn[4])
{
	for (int k = 0; k < 3; k++)
		scale[k] = scan_find(cloud, scale_names[k]);
	for (int k = 0; k < 4; k++)
		turn[k] = scan_find(cloud, turn_names[k]);
	return scale[0] && scale[1] && turn[0] && turn[1] && turn[2] && turn[3];
}

static gw_status take_axes(scan *cloud, uint64_t *flat, gw_error *error)
{
	const scan_column *scale[3], *turn[4];
	for (int k = 0; k < 3; k++)
		if (!scan_add_column(cloud, scan_axis_names[k], SCAN_FLOAT32, error))
			return GW_ERROR_MEMORY;
	if (!find_columns(cloud, scale, turn))
		return GW_OK;
	for (size_t i = 0; i < cloud->count; i++) {
		double value[4], axis[3];
		int least = thinnest(scale, i);
		if (least < 0)
			continue;
		for (int k = 0; k < 4; k++)
			value[k] = scan_value(turn[k], i);
		axis_of(value, least, axis);
		for (int k = 0; k < 3; k++)
			scan_store(scan_find(cloud, scan_axis_names[k]), i, axis[k]);
		*flat += axis[0] != 0.0 || axis[1] != 0.0 || axis[2] != 0.0;
	}
	return GW_OK;
}

/* ------------------------------------------------------------------------------ the whole */

static gw_status note_splats(scan *cloud, uint64_t haze, uint64_t flat, bool given, gw_error *error)
{
	char text[400], normals[120];
	snprintf(normals, sizeof normals,
			 given ? "normals are the file's"
				   : "of %" PRIu64 " that are flat the thin axis is the normal, of either side",
			 flat);
	snprintf(text, sizeof text,
			 SCAN_NOTE "its Gaussian splats are read as points: colours are the mean over all "
					   "directions (f_dc); %" PRIu64 " of %zu splats are less than half opaque, "
					   "which is haze and no surface, but for --strays keep; %s; -y points up, "
					   "as trainers have it: if it does not, give --up",
			 haze, cloud->count, normals);
	return scan_add_comment(cloud, text, error);
}

gw_status ply_splats_take(scan *cloud, gw_error *error)
{
	static const char *const opacity = "opacity";
	uint64_t haze = 0, flat = 0;
	bool given = has_normals(cloud);
	if (!given)
		remove_all(cloud, normal_names, 3);
	GW_TRY(take_colors(cloud, error));
	GW_TRY(take_opacity(cloud, &haze, error));
	if (!given)
		GW_TRY(take_axes(cloud, &flat, error));
	remove_all(cloud, harmonic_names, 3);
	remove_all(cloud, &opacity, 1);
	remove_all(cloud, scale_names, 3);
	remove_all(cloud, turn_names, 4);
	cloud->up = 'Y';
	return note_splats(cloud, haze, flat, given, error);
}
