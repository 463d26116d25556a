#include "preview.h"
#include "scan_color.h"

#include <math.h>

#define MID_GREY 0.18
#define METER (12.5 / 100.0) /* K / ISO */

double preview_luminance(const float rgb[3])
{
	return 0.2126 * (double)rgb[0] + 0.7152 * (double)rgb[1] + 0.0722 * (double)rgb[2];
}

double preview_exposure(const float *radiance, size_t count)
{
	double sum = 0.0, logarithms = 0.0;
	size_t used = 0;
	for (size_t i = 0; i < count; i++)
		sum += preview_luminance(radiance + 3 * i);
	double least = sum / (double)count * 1e-4;
	for (size_t i = 0; i < count && sum > 0.0; i++) {
		double luminance = preview_luminance(radiance + 3 * i);
		if (luminance > least) {
			logarithms += log2(luminance);
			used++;
		}
	}
	return used ? logarithms / (double)used - log2(METER) : 0.0;
}

double preview_scale(double exposure)
{
	return MID_GREY / (METER * exp2(exposure));
}

/* https://github.com/KhronosGroup/ToneMapping, PBR Neutral: below `start` only the reflection of
 * the surface (F90 0.04) is taken off; above it, the peak approaches 1 and colours approach white.
 */
void preview_tone_map(double c[3])
{
	const double reflection = 0.04, start = 0.8 - reflection, desaturation = 0.15;
	double least = fmin(c[0], fmin(c[1], c[2]));
	double offset =
		least < 2.0 * reflection ? least - least * least / (4.0 * reflection) : reflection;
	for (int k = 0; k < 3; k++)
		c[k] -= offset;
	double peak = fmax(c[0], fmax(c[1], c[2]));
	if (peak < start)
		return;
	double room = 1.0 - start;
	double new_peak = 1.0 - room * room / (peak + room - start);
	double white = 1.0 - 1.0 / (desaturation * (peak - new_peak) + 1.0);
	for (int k = 0; k < 3; k++)
		c[k] = c[k] * new_peak / peak * (1.0 - white) + new_peak * white;
}

void preview_color(const float radiance[3], double scale, uint8_t rgb[3])
{
	double c[3];
	for (int k = 0; k < 3; k++)
		c[k] = fmin(fmax((double)radiance[k], 0.0) * scale, 1e30);
	preview_tone_map(c);
	for (int k = 0; k < 3; k++) {
		double encoded = scan_srgb_encode(fmin(fmax(c[k], 0.0), 1.0));
		rgb[k] = (uint8_t)(encoded * 255.0 + 0.5);
	}
}
