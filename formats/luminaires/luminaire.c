#include "luminaires/luminaire.h"

#include <math.h>
#include <stdlib.h>

#define DEGREE (M_PI / 180.0)

/* Steps of a half circle in which widths of beams are found. */
#define BEAM_STEPS 3600

void luminaire_clear(luminaire *l)
{
	free(l->distribution);
	*l = (luminaire){ .distribution = NULL };
}

static size_t place_of(const float *angle, size_t count, double wanted, double *share)
{
	size_t low = 0, high = count - 1;
	while (high - low > 1) {
		size_t middle = (low + high) / 2;
		if ((double)angle[middle] <= wanted)
			low = middle;
		else
			high = middle;
	}
	double from = (double)angle[low], to = (double)angle[low + 1];
	*share = fmin(fmax((wanted - from) / (to - from), 0.0), 1.0);
	return low;
}

static double of_plane(const luminaire *l, size_t plane, size_t at, double share)
{
	const float *shares = l->distribution + l->verticals + l->horizontals + plane * l->verticals;
	return (1.0 - share) * (double)shares[at] + share * (double)shares[at + 1];
}

double luminaire_intensity(const luminaire *l, double gamma, double c)
{
	const float *vertical = l->distribution;
	double along, around, turn = fmod(c, 360.0);
	if (gamma < (double)vertical[0] || gamma > (double)vertical[l->verticals - 1])
		return 0.0;
	size_t at = place_of(vertical, l->verticals, gamma, &along);
	if (l->horizontals == 1)
		return l->candela * of_plane(l, 0, at, along);
	size_t plane = place_of(vertical + l->verticals, l->horizontals,
							turn < 0.0 ? turn + 360.0 : turn, &around);
	return l->candela * ((1.0 - around) * of_plane(l, plane, at, along) +
						 around * of_plane(l, plane + 1, at, along));
}

double luminaire_tilt_factor(const luminaire *l, double degrees)
{
	size_t count = l->tilts, i = 0;
	const double *tilt = l->tilt, *factor = l->tilt_factor;
	if (count == 0)
		return 1.0;
	if (count == 1 || degrees <= tilt[0])
		return factor[0];
	if (degrees >= tilt[count - 1])
		return factor[count - 1];
	while (i + 2 < count && tilt[i + 1] <= degrees)
		i++;
	double share = (degrees - tilt[i]) / (tilt[i + 1] - tilt[i]);
	return factor[i] + share * (factor[i + 1] - factor[i]);
}

/* ---------------------------------------------------------------------------------- flux */

/* Integral of intensity times sine over a stretch of a plane, between two angles, radians, where it
 * is linear: by parts. */
static double stretch(const double angle[2], const double intensity[2])
{
	double slope = (intensity[1] - intensity[0]) / (angle[1] - angle[0]);
	return intensity[0] * cos(angle[0]) - intensity[1] * cos(angle[1]) +
		   slope * (sin(angle[1]) - sin(angle[0]));
}

/* Up to a gamma, degrees. */
static double flux_of_plane(const luminaire *l, size_t plane, double most)
{
	const float *vertical = l->distribution;
	double sum = 0.0;
	for (size_t v = 0; v + 1 < l->verticals && (double)vertical[v] < most; v++) {
		double from = (double)vertical[v], to = (double)vertical[v + 1];
		double share = fmin((most - from) / (to - from), 1.0);
		const double angle[2] = { from * DEGREE, (from + share * (to - from)) * DEGREE };
		const double value[2] = { of_plane(l, plane, v, 0.0), of_plane(l, plane, v, share) };
		sum += stretch(angle, value);
	}
	return sum;
}

static double flux_below(const luminaire *l, double most)
{
	const float *horizontal = l->distribution + l->verticals;
	double sum = 0.0;
	if (l->horizontals == 1)
		return 2.0 * M_PI * l->candela * flux_of_plane(l, 0, most);
	for (size_t h = 0; h + 1 < l->horizontals; h++)
		sum += 0.5 * DEGREE * (double)(horizontal[h + 1] - horizontal[h]) *
			   (flux_of_plane(l, h, most) + flux_of_plane(l, h + 1, most));
	return l->candela * sum;
}

double luminaire_lumens(const luminaire *l)
{
	return flux_below(l, 180.0);
}

/* ---------------------------------------------------------------------------------- beams */

static void find_peak(const luminaire *l, luminaire_facts *facts)
{
	const float *vertical = l->distribution, *horizontal = vertical + l->verticals;
	const float *share = horizontal + l->horizontals;
	float most = -1.0f;
	for (uint32_t h = 0; h < l->horizontals; h++)
		for (uint32_t v = 0; v < l->verticals; v++, share++) {
			if (!(*share > most))
				continue;
			most = *share;
			facts->peak_gamma = (double)vertical[v];
			facts->peak_c = (double)horizontal[h];
		}
}

/* On the great circle of two half planes, degrees from the axis toward the first; up: from the
 * other end of the axis. */
static double on_circle(const luminaire *l, double c, bool up, double from_axis)
{
	double gamma = fabs(from_axis);
	return luminaire_intensity(l, up ? 180.0 - gamma : gamma, from_axis < 0.0 ? c + 180.0 : c);
}

/* Between the outermost directions of two half planes in which the intensity is at least a share of
 * the largest there. */
static double width(const luminaire *l, double c, bool up, double share)
{
	double most = 0.0, low = 180.0, high = -180.0;
	for (int k = -BEAM_STEPS; k <= BEAM_STEPS; k++)
		most = fmax(most, on_circle(l, c, up, 180.0 * k / BEAM_STEPS));
	for (int k = -BEAM_STEPS; k <= BEAM_STEPS && most > 0.0; k++) {
		double angle = 180.0 * k / BEAM_STEPS;
		if (on_circle(l, c, up, angle) < share * most)
			continue;
		low = fmin(low, angle);
		high = fmax(high, angle);
	}
	return fmax(high - low, 0.0);
}

luminaire_facts luminaire_measure(const luminaire *l)
{
	luminaire_facts facts = { .lumens = luminaire_lumens(l) };
	facts.downward = facts.lumens > 0.0 ? flux_below(l, 90.0) / facts.lumens : 0.0;
	find_peak(l, &facts);
	bool up = facts.peak_gamma > 90.0;
	for (int k = 0; k < 2; k++) {
		facts.beam[k] = width(l, 90.0 * k, up, 0.5);
		facts.field[k] = width(l, 90.0 * k, up, 0.1);
	}
	return facts;
}
