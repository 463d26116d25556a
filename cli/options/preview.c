#include "options/preview.h"
#include "points/scan_color.h"

#include <math.h>

#define MID_GREY 0.18
#define METER (12.5 / 100.0) /* K / ISO */
#define DARKENED 1.0         /* doublings by which highlights darken all else at most */

double preview_luminance(const float rgb[3])
{
	return gw_relative_luminance((double)rgb[0], (double)rgb[1], (double)rgb[2]);
}

/* The upper end of the bin above which at most one in fifty lies. */
static double find_highlight(const preview_meter *m)
{
	uint64_t above = 0, most = m->used / 50;
	int b = PREVIEW_METER_BINS - 1;
	while (b > 0 && above + m->bin[b] <= most)
		above += m->bin[b--];
	return exp2((double)(b + 1) / PREVIEW_METER_FINE + PREVIEW_METER_LEAST);
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

void preview_meter_add(preview_meter *m, const float *radiance, const float *emission, size_t count)
{
	for (size_t i = 0; i < count; i++)
		m->sum += reflected(radiance, emission, i);
	m->count += count;
}

void preview_meter_look(preview_meter *m, const float *radiance, const float *emission,
						size_t count)
{
	double least = m->sum / (double)m->count * 1e-4;
	for (size_t i = 0; i < count && m->sum > 0.0; i++) {
		double luminance = reflected(radiance, emission, i);
		if (luminance > least) {
			double doublings = log2(luminance);
			/* What lies on a bin's upper end belongs to it. */
			double b = ceil((doublings - PREVIEW_METER_LEAST) * PREVIEW_METER_FINE) - 1.0;
			m->bin[(int)fmin(fmax(b, 0.0), PREVIEW_METER_BINS - 1.0)]++;
			m->logarithms += doublings;
			m->used++;
		}
	}
}

double preview_meter_exposure(const preview_meter *m)
{
	if (m->used == 0)
		return 0.0;
	double middle = m->logarithms / (double)m->used - log2(METER);
	double highlight = log2(MID_GREY * find_highlight(m) / METER);
	return fmax(middle, fmin(highlight, middle + DARKENED));
}

double preview_exposure(const float *radiance, const float *emission, size_t count)
{
	preview_meter m = { .count = 0 };
	preview_meter_add(&m, radiance, emission, count);
	preview_meter_look(&m, radiance, emission, count);
	if (m.used == 0 && emission)
		return preview_exposure(radiance, NULL, count);
	return preview_meter_exposure(&m);
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
