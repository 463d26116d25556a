#include "lamps/polar_picture.h"

#include "pictures/exr_picture.h"
#include "pictures/png_picture.h"
#include "points/scan_color.h"

#include <math.h>
#include <stdlib.h>

#define DEGREE 0.017453292519943295

/* Pixels: the outermost ring, and half the width of curves and of rings and rays. */
#define RADIUS (0.46 * (double)POLAR_PICTURE)
#define CURVE 1.3
#define LINE 0.5

/* Of what is inside of a curve, how much of its colour is seen. */
#define INSIDE 0.12

/* How much of a pixel a line so far from its middle covers. */
static double coverage(double distance, double half_width)
{
	return fmin(fmax(half_width + 0.5 - fabs(distance), 0.0), 1.0);
}

static void blend(double rgb[3], const double color[3], double share)
{
	for (int k = 0; k < 3; k++)
		rgb[k] += share * (color[k] - rgb[k]);
}

/* How far a curve is from the middle on a ray, degrees from straight down, right above 0. */
static double reach(const luminaire *l, double plane, double angle)
{
	return RADIUS * luminaire_intensity(l, fabs(angle), angle < 0.0 ? plane + 180.0 : plane) /
		   l->candela;
}

/* Rings and rays. */
static double grid(double radius, double angle)
{
	double ring = radius / (RADIUS / 4.0), ray = angle / 30.0;
	double line = coverage((ring - round(ring)) * RADIUS / 4.0, LINE);
	double across = radius * sin((ray - round(ray)) * 30.0 * DEGREE);
	return radius > RADIUS + 1.0 ? 0.0 : fmax(line, coverage(across, LINE));
}

static void paint_curve(const luminaire *l, double plane, const double color[3],
						const double place[2], double rgb[3])
{
	double radius = place[0], angle = place[1], at = reach(l, plane, angle);
	/* A pixel's step around the middle, in which the curve may come nearer or go. */
	double step = fmin(1.0 / fmax(radius * DEGREE, 1e-3), 30.0);
	double slope = 0.5 * (reach(l, plane, fmin(angle + step, 180.0)) -
						  reach(l, plane, fmax(angle - step, -180.0)));
	blend(rgb, color, INSIDE * fmin(fmax(at - radius + 0.5, 0.0), 1.0));
	blend(rgb, color, coverage((radius - at) / sqrt(1.0 + slope * slope), CURVE));
}

/* Into 3 * POLAR_PICTURE * POLAR_PICTURE linear values, 0..1, rows from the top. */
static void draw_pixels(const luminaire *l, float *rgb)
{
	static const double red[3] = { 0.65, 0.03, 0.02 }, blue[3] = { 0.02, 0.09, 0.55 };
	static const double grey[3] = { 0.55, 0.55, 0.55 };
	for (unsigned y = 0; y < POLAR_PICTURE; y++)
		for (unsigned x = 0; x < POLAR_PICTURE; x++) {
			double right = x + 0.5 - 0.5 * POLAR_PICTURE, down = y + 0.5 - 0.5 * POLAR_PICTURE;
			const double place[2] = { hypot(right, down), atan2(right, down) / DEGREE };
			double color[3] = { 1.0, 1.0, 1.0 };
			blend(color, grey, grid(place[0], place[1]));
			paint_curve(l, 90.0, blue, place, color);
			paint_curve(l, 0.0, red, place, color);
			for (int k = 0; k < 3; k++)
				*rgb++ = (float)color[k];
		}
}

static gw_status draw(const luminaire *l, float **rgb, gw_error *error)
{
	*rgb = reallocarray(NULL, (size_t)POLAR_PICTURE * POLAR_PICTURE, 3 * sizeof **rgb);
	if (!*rgb)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for a picture");
	draw_pixels(l, *rgb);
	return GW_OK;
}

gw_status polar_picture_write_png(output_file *out, const luminaire *l, gw_error *error)
{
	float *rgb = NULL;
	size_t values = (size_t)POLAR_PICTURE * POLAR_PICTURE * 3;
	uint8_t *bytes = malloc(values);
	const png_picture picture = { .width = POLAR_PICTURE,
								  .height = POLAR_PICTURE,
								  .pixels = bytes };
	gw_status status =
		bytes ? draw(l, &rgb, error) : gw_fail(error, GW_ERROR_MEMORY, "no memory for a picture");
	for (size_t i = 0; i < values && status == GW_OK; i++)
		bytes[i] = (uint8_t)lround(255.0 * scan_srgb_encode((double)rgb[i]));
	if (status == GW_OK)
		status = png_picture_write(out, &picture, error);
	free(bytes);
	free(rgb);
	return status;
}

gw_status polar_picture_write_exr(output_file *out, const luminaire *l, gw_error *error)
{
	float *rgb;
	GW_TRY(draw(l, &rgb, error));
	const exr_channel channel[3] = { { "R", false, rgb, 3 },
									 { "G", false, rgb + 1, 3 },
									 { "B", false, rgb + 2, 3 } };
	const exr_picture picture = { POLAR_PICTURE, POLAR_PICTURE, channel, 3, NULL, 0 };
	gw_status status = exr_picture_write(out, &picture, error);
	free(rgb);
	return status;
}
