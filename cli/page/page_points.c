#include "page/page_points.h"

#include <math.h>
#include <string.h>

#define STEPS_A_RADIUS 64.0
#define RADII_A_DOUBLING 12.0
#define NO_CUT 255u
#define CUT_MIDDLE 127.0

/* --------------------------------------------------------------------------------- values */

void page_points_scale(page_points *p)
{
	const gw_surfels *s = p->surfels;
	size_t with[512] = { 0 }, below = 0;
	double side = 0.0;
	p->radius = 0.0;
	for (size_t i = 0; i < s->count; i++) {
		p->radius = fmax(p->radius, (double)s->radius[i]);
		with[256 + ilogbf(fmaxf(s->radius[i], 1e-30f))]++;
	}
	int exponent = -256;
	while (exponent < 255 && below + with[256 + exponent] <= s->count / 100)
		below += with[256 + exponent++];
	for (int k = 0; k < 3; k++)
		side = fmax(side, (double)s->maximum[k] - (double)s->minimum[k]);
	p->step = fmax(ldexp(1.0, exponent) / STEPS_A_RADIUS, side / PAGE_STEPS);
}

uint32_t page_points_rgb9e5(const double rgb[3])
{
	double most = fmax(rgb[0], fmax(rgb[1], rgb[2]));
	if (!(most > 0.0))
		return 0;
	int exponent = ilogb(most) + 1; /* of the value that 512 of the mantissa stand for */
	exponent = exponent < -15 ? -15 : exponent;
	if (floor(ldexp(most, 9 - exponent) + 0.5) > 511.0)
		exponent++;
	uint32_t word = (uint32_t)(exponent + 15) << 27;
	for (int k = 0; k < 3; k++)
		word |= (uint32_t)fmax(floor(ldexp(rgb[k], 9 - exponent) + 0.5), 0.0) << (9 * k);
	return word;
}

/* -1 to 1 as 0 to 254. */
static uint8_t pack_signed(double x)
{
	return (uint8_t)floor(fmin(fmax(x, -1.0), 1.0) * 127.0 + 127.5);
}

static void pack_normal(const float n[3], uint8_t packed[2])
{
	double sum = fabs((double)n[0]) + fabs((double)n[1]) + fabs((double)n[2]);
	double x = (double)n[0] / sum, y = (double)n[1] / sum;
	if (n[2] < 0.0f) {
		double folded = (1.0 - fabs(y)) * copysign(1.0, x);
		y = (1.0 - fabs(x)) * copysign(1.0, y);
		x = folded;
	}
	packed[0] = pack_signed(x);
	packed[1] = pack_signed(y);
}

static void unpack_normal(const uint8_t packed[2], double n[3])
{
	n[0] = packed[0] / 127.0 - 1.0;
	n[1] = packed[1] / 127.0 - 1.0;
	n[2] = 1.0 - fabs(n[0]) - fabs(n[1]);
	double fold = fmax(-n[2], 0.0);
	n[0] += n[0] >= 0.0 ? -fold : fold;
	n[1] += n[1] >= 0.0 ? -fold : fold;
	double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
	for (int k = 0; k < 3; k++)
		n[k] /= length;
}

/* Tangents of a unit normal (Duff et al. 2017), as in surfels. */
static void make_tangents(const double n[3], double t[3], double b[3])
{
	double s = n[2] >= 0.0 ? 1.0 : -1.0, a = -1.0 / (s + n[2]), c = n[0] * n[1] * a;
	t[0] = 1.0 + s * n[0] * n[0] * a;
	t[1] = s * c;
	t[2] = -s * n[0];
	b[0] = c;
	b[1] = s + n[1] * n[1] * a;
	b[2] = -n[1];
}

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* One of a disc's cuts, whose direction is turned from its own plane into that of the packed
 * normal. */
static void pack_cut(const gw_surfels *s, size_t i, const float *cut, const double packed[3],
					 uint8_t out[2])
{
	out[0] = 0;
	out[1] = NO_CUT;
	if (cut[0] == 0.0f && cut[1] == 0.0f)
		return;
	const double own[3] = { (double)s->normal[3 * i], (double)s->normal[3 * i + 1],
							(double)s->normal[3 * i + 2] };
	double t[3], b[3], direction[3];
	make_tangents(own, t, b);
	for (int k = 0; k < 3; k++)
		direction[k] = (double)cut[0] * t[k] + (double)cut[1] * b[k];
	make_tangents(packed, t, b);
	double turn = atan2(dot(direction, b), dot(direction, t)) / (2.0 * acos(-1.0));
	double distance = (double)cut[2] / (double)s->radius[i];
	out[0] = (uint8_t)((int)floor(turn * 256.0 + 0.5) & 255);
	if (distance < 1.0)
		out[1] = (uint8_t)floor(fmax(distance, -1.0) * CUT_MIDDLE + CUT_MIDDLE + 0.5);
}

/* --------------------------------------------------------------------------------- packing */

/* Where byte b of value v is put. */
typedef struct planes {
	uint8_t *bytes;
	size_t count; /* points */
} planes;

static void put(const planes *to, size_t plane, size_t i, uint8_t value)
{
	to->bytes[plane * to->count + i] = value;
}

static void put_word(const planes *to, size_t plane, size_t i, uint32_t value)
{
	for (size_t b = 0; b < 4; b++)
		put(to, plane + b, i, (uint8_t)(value >> 8 * b));
}

static void pack_place(const page_points *p, size_t surfel, int64_t before[3], const planes *to,
					   size_t i)
{
	for (size_t k = 0; k < 3; k++) {
		double metres =
			(double)p->surfels->position[3 * surfel + k] - (double)p->surfels->minimum[k];
		int64_t at = (int64_t)floor(fmin(fmax(metres / p->step, 0.0), PAGE_STEPS) + 0.5);
		int64_t off = at - before[k];
		put_word(to, 4 * k, i, (uint32_t)(off < 0 ? -2 * off - 1 : 2 * off));
		before[k] = at;
	}
}

static void pack_disc(const page_points *p, size_t surfel, const planes *to, size_t i)
{
	const gw_surfels *s = p->surfels;
	uint8_t normal[2], cut[4], flags = 0;
	double unpacked[3], radius = fmax((double)s->radius[surfel] / p->radius, 1e-30);
	pack_normal(s->normal + 3 * surfel, normal);
	unpack_normal(normal, unpacked);
	for (size_t c = 0; c < 2; c++)
		pack_cut(s, surfel, s->clip + 6 * surfel + 3 * c, unpacked, cut + 2 * c);
	if (s->two_sided && s->two_sided[surfel])
		flags |= PAGE_TWO_SIDED;
	if (p->glows && p->glows[surfel])
		flags |= PAGE_GLOWS;
	put(to, 12, i, normal[0]);
	put(to, 13, i, normal[1]);
	put(to, 14, i, (uint8_t)floor(fmax(log2(radius) * RADII_A_DOUBLING + 255.5, 0.0)));
	put(to, 15, i, flags);
	for (size_t b = 0; b < 4; b++)
		put(to, 16 + b, i, cut[b]);
	for (size_t k = 0; k < 3; k++)
		put(to, 20 + k, i,
			(uint8_t)floor(sqrt(fmin((double)s->albedo[3 * surfel + k], 1.0)) * 255.0 + 0.5));
}

size_t page_points_bytes(const page_points *p, size_t count)
{
	return count * (PAGE_PLANES + PAGE_LAMP_PLANES * p->lamps);
}

void page_points_pack(const page_points *p, size_t first, size_t count, uint8_t *bytes)
{
	const planes to = { bytes, count };
	int64_t before[3] = { 0 };
	for (size_t i = 0; i < count; i++) {
		size_t surfel = p->order[first + i];
		pack_place(p, surfel, before, &to, i);
		pack_disc(p, surfel, &to, i);
		for (size_t l = 0; l < p->lamps; l++)
			put_word(&to, PAGE_PLANES + PAGE_LAMP_PLANES * l, i, p->light[l][surfel]);
	}
}
