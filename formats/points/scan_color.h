/*
 * scan_color.h - colour columns of a scan as numbers from 0 to 1, whatever type they came in.
 */
#ifndef SCAN_COLOR_H
#define SCAN_COLOR_H

#include "points/scan.h"

/* Three colour columns and the value that stands for full. */
typedef struct scan_color {
	const scan_column *column[3]; /* red, green, blue; lead into the scan */
	double range;                 /* 1, 255, 1023, 4095 or 65535 */
	bool told;                    /* only the values tell it, the type would have another */
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
 * Finds colour columns and what they count to: the least of 1 (of floats only), 255, 1023, 4095 and
 * 65535 that all values but one in a thousand fit under; floats of 1 may be somewhat larger. As
 * scan_color_names, r g b, Rf Gf Bf and diffuse_red diffuse_green diffuse_blue in any case are
 * found too. False when one is missing.
 */
bool scan_color_find(const scan *scan, const char *const name[3], scan_color *color);

#define SCAN_COLOR_FULLS 5

/* What the values of colours that come part by part tell of what they count to. Zeros begin it. */
typedef struct scan_color_tally {
	uint64_t count,
		above[SCAN_COLOR_FULLS]; /* points; values above each of the numbers that may be full */
	double largest;
	bool floats, wide; /* some column is of floats, or of more than a byte */
} scan_color_tally;

/* Adds a part, if it has such columns; *color receives them as far as parts so far tell. */
bool scan_color_tally_add(scan_color_tally *tally, const scan *part, const char *const name[3],
						  scan_color *color);

/* What all parts tell of a colour's columns. */
void scan_color_tally_settle(const scan_color_tally *tally, scan_color *color);

/*
 * Takes red, green and blue, 8 bits each, out of a column rgb or rgba that holds all of them as one
 * number, or as the bits of a float, and puts them into its place; unless there are colours
 * already, or its values are something else. GW_ERROR_MEMORY.
 */
gw_status scan_color_unpack(scan *scan, gw_error *error);

/* Whether a column of that name may be such a one, which only the values of all points tell. */
bool scan_color_may_be_packed(const char *name);

/* Channel k of point i, 0..1 and still encoded as it was; bad values come out as they are. */
double scan_color_value(const scan_color *color, int k, size_t i);

/*
 * How many points have no colour where others have one: a camera did not see them, or nobody gave
 * them a label. They are exactly black, as hardly any pixel of a photograph is. 0 unless there are
 * a hundred, more than one in a hundred, and many more than nearly black ones; and unless most of
 * the others are coloured, not grey: among grey and white walls a black one is black.
 */
size_t scan_color_count_blank(const scan_color *color, size_t count);

/* Is a point exactly black? */
bool scan_color_is_black(const scan_color *color, size_t i);

/* sRGB transfer function (IEC 61966-2-1) and its inverse, for 0..1; below 0 they go on straight. */
double scan_srgb_decode(double encoded);
double scan_srgb_encode(double linear);

#endif
