#include "options/preview.h"
#include "points/scan_color.h"

#include <math.h>

#define MID_GREY 0.18
#define METER (12.5 / 100.0) /* K / ISO */

double preview_luminance(const float rgb[3])
{
	return gw_relative_luminance((double)rgb[0], (double)rgb[1], (double)rgb[2]);
}

/* A histogram over the doublings of all floats. */
#define BINS_A_DOUBLING 32
#define LEAST_DOUBLING (-152)
#define BINS ((130 - LEAST_DOUBLING) * BINS_A_DOUBLING)

/* The upper end of the bin above which at most one in fifty lies. */
static double find_highlight(const uint32_t *bin, size_t used)
{
	size_t above = 0, most = used / 50;
	int b = BINS - 1;
	while (b > 0 && above + bin[b] <= most)
		above += bin[b--];
	return exp2((double)(b + 1) / BINS_A_DOUBLING + LEAST_DOUBLING);
}

/* Luminance of the light that a surface reflects. */
static double reflected(const float *radiance, const float *emission, size_t i)
{
	float rgb[3];
	for (size_t k = 0; k < 3; k++) {
		float own = emission ? emission[3 * i + k] : 0.0f;
		rgb[k] = radiance[3 * i + k] - (own > 0.0f && isfinite(own) ? own : 0.0f);
	}
	/* What rounding leaves of a lamp's own light is no light. */
	double whole = preview_luminance(radiance + 3 * i), rest = preview_luminance(rgb);
	return rest > 1e-5 * whole ? rest : 0.0;
}

double preview_exposure(const float *radiance, const float *emission, size_t count)
{
	double sum = 0.0, logarithms = 0.0;
	uint32_t bin[BINS] = { 0 };
	size_t used = 0;
	for (size_t i = 0; i < count; i++)
		sum += reflected(radiance, emission, i);
	double least = sum / (double)count * 1e-4;
	for (size_t i = 0; i < count && sum > 0.0; i++) {
		double luminance = reflected(radiance, emission, i);
		if (luminance > least) {
			double doublings = log2(luminance);
			/* What lies on a bin's upper end belongs to it. */
			double b = ceil((doublings - LEAST_DOUBLING) * BINS_A_DOUBLING) - 1.0;
			bin[(int)fmin(fmax(b, 0.0), BINS - 1.0)]++;
			logarithms += doublings;
			used++;
		}
	}
	if (!used)
		return emission ? preview_exposure(radiance, NULL, count) : 0.0;
	return fmax(logarithms / (double)used - log2(METER),
				log2(MID_GREY * find_highlight(bin, used) / METER));
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

const char *preview_tone_name(preview_tone tone)
{
	static const char *const name[] = { "pbr-neutral", "reinhard", "none" };
	return name[tone];
}

void preview_tone_apply(preview_tone tone, double c[3])
{
	double luminance = gw_relative_luminance(c[0], c[1], c[2]);
	if (tone == PREVIEW_TONE_PBR_NEUTRAL)
		preview_tone_map(c);
	for (int k = 0; k < 3; k++) {
		if (tone == PREVIEW_TONE_REINHARD)
			c[k] /= 1.0 + luminance;
		c[k] = fmin(fmax(c[k], 0.0), 1.0);
	}
}

void preview_color(const float radiance[3], double scale, uint8_t rgb[3])
{
	double c[3];
	for (int k = 0; k < 3; k++)
		c[k] = fmin(fmax((double)radiance[k], 0.0) * scale, 1e30);
	preview_tone_apply(PREVIEW_TONE_PBR_NEUTRAL, c);
	for (int k = 0; k < 3; k++)
		rgb[k] = (uint8_t)(scan_srgb_encode(c[k]) * 255.0 + 0.5);
}
