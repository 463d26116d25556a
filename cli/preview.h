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

/* Luminance of linear Rec.709 RGB (IEC 61966-2-1). */
double preview_luminance(const float rgb[3]);

/*
 * The exposure value at which the geometric mean of the luminances becomes mid grey. Of the
 * luminances only those above 1/10000 of their arithmetic mean count, or traces of light in the
 * dark would decide. 0 when there is no light.
 *   radiance  3 * count, linear
 */
double preview_exposure(const float *radiance, size_t count);

/* What radiance is multiplied by before the tone map. */
double preview_scale(double exposure);

/* Tone-maps an exposed colour in place: Khronos PBR Neutral, result 0..1. */
void preview_tone_map(double rgb[3]);

/* The preview of one colour. scale: from preview_scale. */
void preview_color(const float radiance[3], double scale, uint8_t rgb[3]);

#endif
