#include "luminaires/luminaire_planes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define DEGREE (M_PI / 180.0)

/* Grid of what is worked out from types B and A, degrees. */
#define GAMMA_STEP 0.5
#define C_STEP 2.0

static void clear_planes(luminaire_planes *planes)
{
	free(planes->vertical);
	free(planes->horizontal);
	free(planes->candela);
	*planes = (luminaire_planes){ .vertical = NULL };
}

/* ----------------------------------------------------------------------------------- checks */

static gw_status check_angles(const char *name, const char *kind, const double *angle, size_t count,
							  const double range[2], gw_error *error)
{
	for (size_t i = 0; i < count; i++) {
		if (i > 0 && !(angle[i] > angle[i - 1]))
			return gw_fail(error, GW_ERROR_DATA,
						   "%s: %s angle %zu is %g degrees, after %g; they must ascend", name, kind,
						   i + 1, angle[i], angle[i - 1]);
		if (!(angle[i] >= range[0] && angle[i] <= range[1]))
			return gw_fail(error, GW_ERROR_DATA,
						   "%s: %s angle %zu is %g degrees; it must be from %g to %g", name, kind,
						   i + 1, angle[i], range[0], range[1]);
	}
	return GW_OK;
}

static gw_status check_candela(const char *name, const luminaire_planes *p, double *most,
							   gw_error *error)
{
	*most = 0.0;
	for (size_t i = 0; i < p->verticals * p->horizontals; i++) {
		if (!(p->candela[i] >= 0.0 && isfinite((float)p->candela[i])))
			return gw_fail(error, GW_ERROR_DATA,
						   "%s: the intensity at vertical angle %g, horizontal angle %g is %g cd; "
						   "it must be 0 or more, and below 3e38",
						   name, p->vertical[i % p->verticals], p->horizontal[i / p->verticals],
						   p->candela[i]);
		*most = fmax(*most, p->candela[i]);
	}
	if (!(*most > 0.0))
		return gw_fail(error, GW_ERROR_DATA, "%s: all intensities are 0; it gives no light", name);
	return GW_OK;
}

/* ---------------------------------------------------------------------------------- symmetry */

/* A plane of all around: its angle, and whose intensities it has. */
typedef struct plane {
	double angle;
	size_t source;
} plane;

static int compare_planes(const void *left, const void *right)
{
	const plane *a = left, *b = right;
	return (a->angle > b->angle) - (a->angle < b->angle);
}

/* Adds mirror images: of each angle a, axis - a. */
static size_t mirror(plane *list, size_t count, double axis)
{
	size_t all = count;
	for (size_t i = 0; i < count; i++)
		list[all++] = (plane){ fmod(axis - list[i].angle + 720.0, 360.0), list[i].source };
	return all;
}

/* Sorted, each angle once, and the first again after a whole turn. */
static size_t close_circle(plane *list, size_t count)
{
	size_t kept = 0;
	qsort(list, count, sizeof *list, compare_planes);
	for (size_t i = 0; i < count; i++)
		if (kept == 0 || list[i].angle - list[kept - 1].angle > 1e-6)
			list[kept++] = list[i];
	while (kept > 1 && list[kept - 1].angle > 360.0 - 1e-6)
		kept--;
	if (kept > 1)
		list[kept++] = (plane){ 360.0, list[0].source };
	return kept;
}

/* list: room for four times as many planes as there are, and one. Returns how many; 0 when some are
 * missing. */
static size_t list_planes(const luminaire_planes *p, plane *list)
{
	size_t count = p->horizontals;
	double first = p->horizontal[0], last = p->horizontal[count - 1];
	for (size_t i = 0; i < count; i++)
		list[i] = (plane){ p->horizontal[i], i };
	if (count == 1)
		return 1;
	if (first == 90.0 && last == 270.0) {
		count = mirror(list, count, 180.0);
	} else if (first != 0.0) {
		return 0;
	} else if (last == 90.0 && !p->around) {
		count = mirror(list, count, 180.0);
		count = mirror(list, count, 360.0);
	} else if (last == 180.0 && !p->around) {
		count = mirror(list, count, 360.0);
	} else if (last < 270.0 && !p->around) {
		return 0;
	}
	count = close_circle(list, count);
	return count > 1 && list[0].angle == 0.0 ? count : 0;
}

/* ---------------------------------------------------------------------------------- filling */

static gw_status allocate(luminaire *to, size_t verticals, size_t horizontals, gw_error *error)
{
	to->verticals = (uint32_t)verticals;
	to->horizontals = (uint32_t)horizontals;
	to->distribution = reallocarray(NULL, verticals + horizontals + verticals * horizontals,
									sizeof *to->distribution);
	return to->distribution ? GW_OK
							: gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu x %zu intensities",
									  horizontals, verticals);
}

static gw_status fill_type_c(const char *name, const luminaire_planes *p, luminaire *to,
							 gw_error *error)
{
	const double range[2] = { 0.0, 180.0 }, around[2] = { 0.0, 360.0 };
	GW_TRY(check_angles(name, "vertical", p->vertical, p->verticals, range, error));
	GW_TRY(check_angles(name, "horizontal", p->horizontal, p->horizontals, around, error));
	plane *list = reallocarray(NULL, 4 * p->horizontals + 1, sizeof *list);
	if (!list)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu planes", p->horizontals);
	size_t count = list_planes(p, list);
	gw_status status = GW_OK;
	if (count == 0)
		status = gw_fail(error, GW_ERROR_DATA,
						 "%s: its horizontal angles go from %g to %g degrees; known are one, and "
						 "those from 0 to 90, 180 or 360 and from 90 to 270",
						 name, p->horizontal[0], p->horizontal[p->horizontals - 1]);
	if (status == GW_OK)
		status = allocate(to, p->verticals, count, error);
	float *angle = to->distribution;
	for (size_t v = 0; status == GW_OK && v < p->verticals; v++)
		*angle++ = (float)p->vertical[v];
	for (size_t h = 0; status == GW_OK && h < count; h++)
		*angle++ = count == 1 ? 0.0f : (float)list[h].angle;
	for (size_t h = 0; status == GW_OK && h < count; h++)
		for (size_t v = 0; v < p->verticals; v++)
			*angle++ = (float)(p->candela[list[h].source * p->verticals + v] / to->candela);
	free(list);
	return status;
}

/* Where an angle lies among ascending ones; false outside. What begins at 0 is mirrored there. */
static bool place_of(const double *angle, size_t count, double wanted, size_t *at, double *share)
{
	double a = angle[0] == 0.0 ? fabs(wanted) : wanted;
	if (a < angle[0] - 1e-9 || a > angle[count - 1] + 1e-9)
		return false;
	size_t i = 0;
	while (i + 2 < count && angle[i + 1] <= a)
		i++;
	*at = i;
	*share = fmin(fmax((a - angle[i]) / (angle[i + 1] - angle[i]), 0.0), 1.0);
	return true;
}

/* A direction's intensity: x right, y up, z along the beam. Type B: the planes turn about x, the
 * vertical angle is that of the plane, the horizontal one lies in it. Type A: they turn about y. */
static double look_up(const luminaire_planes *p, double x, double y, double z)
{
	bool b = p->photometry == 'B';
	double horizontal = b ? asin(fmin(fmax(x, -1.0), 1.0)) : atan2(x, z);
	double vertical = b ? atan2(y, z) : asin(fmin(fmax(y, -1.0), 1.0));
	size_t h, v;
	double sh, sv;
	if (!place_of(p->horizontal, p->horizontals, horizontal / DEGREE, &h, &sh) ||
		!place_of(p->vertical, p->verticals, vertical / DEGREE, &v, &sv))
		return 0.0;
	const double *at = p->candela + h * p->verticals + v, *next = at + p->verticals;
	return (1.0 - sh) * ((1.0 - sv) * at[0] + sv * at[1]) +
		   sh * ((1.0 - sv) * next[0] + sv * next[1]);
}

/* Beyond a right angle from the beam only where the file says something about that. */
static gw_status fill_other(const char *name, const luminaire_planes *p, luminaire *to,
							gw_error *error)
{
	const double range[2] = { -180.0, 180.0 };
	GW_TRY(check_angles(name, "vertical", p->vertical, p->verticals, range, error));
	GW_TRY(check_angles(name, "horizontal", p->horizontal, p->horizontals, range, error));
	if (p->horizontals < 2)
		return gw_fail(error, GW_ERROR_DATA,
					   "%s is of type %c and has one horizontal angle; at least two are needed",
					   name, p->photometry);
	const double *turn = p->photometry == 'B' ? p->vertical : p->horizontal;
	size_t turns = p->photometry == 'B' ? p->verticals : p->horizontals;
	double most = turn[0] < -90.0 || turn[turns - 1] > 90.0 ? 180.0 : 90.0;
	size_t gammas = (size_t)(most / GAMMA_STEP) + 1, cs = (size_t)(360.0 / C_STEP) + 1;
	GW_TRY(allocate(to, gammas, cs, error));
	float *number = to->distribution;
	for (size_t g = 0; g < gammas; g++)
		*number++ = (float)(GAMMA_STEP * (double)g);
	for (size_t c = 0; c < cs; c++)
		*number++ = (float)(C_STEP * (double)c);
	for (size_t c = 0; c < cs; c++)
		for (size_t g = 0; g < gammas; g++) {
			double gamma = GAMMA_STEP * (double)g * DEGREE, turned = C_STEP * (double)c * DEGREE;
			*number++ =
				(float)(look_up(p, sin(gamma) * cos(turned), sin(gamma) * sin(turned), cos(gamma)) /
						to->candela);
		}
	return GW_OK;
}

/*
 * Fills the distribution of a luminaire. What symmetry leaves out is mirrored: planes of one angle
 * are the same all around; from 0 to 90, mirrored on both axes; 0 to 180 and 90 to 270, on one.
 * Types B and A are worked out on a grid of half a degree by two, and what begins at 0 degrees is
 * mirrored too.
 *   name   of the file, for messages
 * GW_ERROR_DATA when angles do not ascend, are out of range, or planes are missing; when an
 * intensity is negative, or all are 0. GW_ERROR_MEMORY.
 */
static gw_status fill(const char *name, const luminaire_planes *planes, luminaire *l,
					  gw_error *error)
{
	GW_TRY(check_candela(name, planes, &l->candela, error));
	l->photometry = planes->photometry;
	return planes->photometry == 'C' ? fill_type_c(name, planes, l, error)
									 : fill_other(name, planes, l, error);
}

gw_status luminaire_planes_read(const input_file *in, luminaire_planes_body *read, luminaire *l,
								gw_error *error)
{
	luminaire_lines lines = luminaire_lines_of(in, error);
	luminaire_planes planes = { .vertical = NULL };
	*l = (luminaire){ .distribution = NULL };
	gw_status status = read(&lines, &planes, l);
	if (status == GW_OK)
		status = fill(in->name, &planes, l, error);
	clear_planes(&planes);
	if (status != GW_OK)
		luminaire_clear(l);
	return status;
}
