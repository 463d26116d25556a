/*
 * luminance.h - what an eye makes of linear RGB: weights of BT.709, as in
 * shaders/base/sampling.glsl.
 */
#ifndef LUMINANCE_H
#define LUMINANCE_H

/* rgb: 3, any linear quantity; the result has its unit. */
static inline double gw_luminance(const float *rgb)
{
	return 0.2126 * (double)rgb[0] + 0.7152 * (double)rgb[1] + 0.0722 * (double)rgb[2];
}

#endif
