/*
 * preview.h - radiance as colours that a viewer can show.
 *
 * The exposure value follows cameras at ISO 100 with the reflected-light constant K = 12.5: a
 * luminance of 2^EV * 0.125 becomes mid grey, 0.18. The tone map is Khronos PBR Neutral, which
 * leaves hues alone; then comes the sRGB curve.
 */
#ifndef PREVIEW_H
#define PREVIEW_H

#include <stddef.h>
#include <stdint.h>

/* Bins a doubling, and the first of the doublings that a meter has. */
#define PREVIEW_METER_FINE 32
#define PREVIEW_METER_LEAST (-152)
#define PREVIEW_METER_BINS ((130 - PREVIEW_METER_LEAST) * PREVIEW_METER_FINE)

/* Luminance of linear Rec.709 RGB (IEC 61966-2-1). */
double preview_luminance(const float rgb[3]);

/*
 * The exposure value that suits a picture: the larger, that is the darker, of two, but no more than
 * a doubling above the first.
 *
 *   mid grey     the geometric mean of the luminances becomes mid grey
 *   highlights   at most one in fifty of them is exposed above 1, what a white surface in full
 *                light sends out: beyond, a screen has no more room, and colours go white
 *
 * The first is right for scenes that are lit all over. Where most is dark, as in a cave with a
 * lamp, it takes the dark for mid grey and burns out what the lamp shines at; then the second
 * holds. A jamb or a leg beside the lamp may be burnt out, where all else would be too dark to see:
 * the geometric mean stays at half of mid grey or above.
 *
 * With mid grey m = 0.18 and the meter's 0.125, L98 the luminance that one in fifty exceeds:
 * m / (0.125 2^EV) L98 <= 1, so EV >= log2(m L98 / 0.125). L98 is rounded up to the next 1/32 of a
 * doubling.
 *
 * Only luminances above 1/10000 of their arithmetic mean count, or traces of light in the dark
 * would decide. Light that surfaces make themselves is taken off, or a lamp in the picture would
 * leave everything else dark; unless there is no other. 0 when there is no light.
 *   radiance  3 * count, linear
 *   emission  3 * count, of that what they make themselves, or NULL; bad values count as 0
 */
double preview_exposure(const float *radiance, const float *emission, size_t count);

/* The same where points come in parts, each of them twice: first all are added, then all are looked
 * at. Begins as zeros. */
typedef struct preview_meter {
	uint64_t count, used; /* points that were added, and that count */
	double sum, logarithms;
	uint64_t bin[PREVIEW_METER_BINS]; /* of `used`, over the doublings of all floats */
} preview_meter;

void preview_meter_add(preview_meter *meter, const float *radiance, const float *emission,
					   size_t count);
void preview_meter_look(preview_meter *meter, const float *radiance, const float *emission,
						size_t count);
double preview_meter_exposure(const preview_meter *meter);

/* What radiance is multiplied by before the tone map. */
double preview_scale(double exposure);

/* Tone-maps an exposed colour in place: Khronos PBR Neutral, result 0..1. */
void preview_tone_map(double rgb[3]);

/* Ways to fit exposed colours into 0..1. */
typedef enum preview_tone {
	PREVIEW_TONE_PBR_NEUTRAL, /* preview_tone_map */
	PREVIEW_TONE_REINHARD,    /* divided by 1 + luminance */
	PREVIEW_TONE_NONE,        /* cut off at 1 */
	PREVIEW_TONE_COUNT
} preview_tone;

const char *preview_tone_name(preview_tone tone);

/* Tone-maps an exposed colour in place; the result is cut to 0..1. */
void preview_tone_apply(preview_tone tone, double rgb[3]);

/* The preview of one colour. scale: from preview_scale. */
void preview_color(const float radiance[3], double scale, uint8_t rgb[3]);

#endif
