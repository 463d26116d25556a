/*
 * scan_color.h - colour columns of a scan as numbers from 0 to 1, whatever type they came in.
 */
#ifndef SCAN_COLOR_H
#define SCAN_COLOR_H

#include "points/scan.h"

/* Three colour columns and the value that stands for full. */
typedef struct scan_color {
	const scan_column *column[3]; /* red, green, blue; lead into the scan */
	double range;                 /* 255, 65535 or 1 */
	bool black;                   /* no value is above 0 */
} scan_color;

extern const char *const scan_color_names[3];  /* red green blue */
extern const char *const scan_albedo_names[3]; /* albedo_r albedo_g albedo_b */

/*
 * A column by its canonical name, or under CloudCompare's name for it: scalar_ in front, any case
 * behind. NULL when there is none.
 */
const scan_column *scan_find_scalar(const scan *scan, const char *name);

/* Three columns by scan_find_scalar; true when all of them are there. */
bool scan_find_triple(const scan *scan, const char *const name[3], const scan_column *column[3]);

/*
 * Finds colour columns and what they count to: 8-bit types to 255; wider integers to 65535, or to
 * 255 if no value is larger; floats to 1, or to 255 if a value is over 1. False when one is
 * missing.
 */
bool scan_color_find(const scan *scan, const char *const name[3], scan_color *color);

/* Channel k of point i, 0..1 and still encoded as it was; bad values come out as they are. */
double scan_color_value(const scan_color *color, int k, size_t i);

/* sRGB transfer function (IEC 61966-2-1) and its inverse, for 0..1; below 0 they go on straight. */
double scan_srgb_decode(double encoded);
double scan_srgb_encode(double linear);

#endif
