#include "pictures/gloss_filter.h"

#include <math.h>
#include <stdlib.h>

/* Pixels of reach at a roughness of BLURRED and more, with so many rays. Below SHARP there is none:
 * reflections on a ball of roughness 0.1 lose more by one pixel than they have noise. */
#define REACH 4.0f
#define RAYS 32.0f
#define SHARP 0.2f
#define BLURRED 0.5f

/* Neighbours belong to another surface if their normals are further apart than 18 degrees, their
 * roughness or reflectance than this, or they lie off the plane by this share of the distance. */
#define COSINE 0.95f
#define MATERIAL 0.05f
#define OFF_PLANE 0.01f

/* Neighbours of the same surface without which a bright pixel is no speck, but something small. */
#define LEAST_NEAR 5

typedef struct filter {
	const gw_pixels *pixels;
	const gw_reflection *reflection;
	uint32_t width, height;
	uint32_t *listed; /* of each pixel of the picture, its number plus one */
	float *light;     /* 3 a pixel: reflected light over the share */
} filter;

static int reach_of(const filter *f, size_t pixel)
{
	float roughness = f->pixels->position[4 * pixel + 3];
	float rough = (roughness - SHARP) / (BLURRED - SHARP);
	float reach = REACH * fminf(fmaxf(rough, 0.0f), 1.0f);
	float rays = (float)gw_reflection_rays(f->reflection, roughness);
	return (int)(reach * fminf(1.0f, RAYS / rays) + 0.5f);
}

static bool same_surface(const gw_pixels *p, size_t a, size_t b)
{
	const float *n = p->normal + 4 * a, *m = p->normal + 4 * b;
	const float *x = p->position + 4 * a, *y = p->position + 4 * b;
	float cosine = 0.0f, off = 0.0f, distance = 0.0f;
	for (int k = 0; k < 3; k++) {
		cosine += n[k] * m[k];
		off += n[k] * (y[k] - x[k]);
		distance += (x[k] - p->eye[k]) * (x[k] - p->eye[k]);
	}
	return cosine >= COSINE && fabsf(off) <= OFF_PLANE * sqrtf(distance) &&
		   fabsf(n[3] - m[3]) <= MATERIAL && fabsf(x[3] - y[3]) <= MATERIAL;
}

static void smooth(const filter *f, size_t pixel, float *reflected)
{
	int reach = reach_of(f, pixel);
	int x = (int)(f->pixels->place[pixel] % f->width),
		y = (int)(f->pixels->place[pixel] / f->width);
	float sum[3] = { 0 }, count = 0.0f;
	for (int v = y - reach; v <= y + reach; v++)
		for (int u = x - reach; u <= x + reach; u++) {
			if (u < 0 || v < 0 || u >= (int)f->width || v >= (int)f->height)
				continue;
			uint32_t other = f->listed[(size_t)v * f->width + (size_t)u];
			if (other == 0 || !same_surface(f->pixels, pixel, other - 1))
				continue;
			for (size_t k = 0; k < 3; k++)
				sum[k] += f->light[3 * (size_t)(other - 1) + k];
			count += 1.0f;
		}
	for (size_t k = 0; k < 3 && count > 0.0f; k++)
		reflected[4 * pixel + k] = reflected[4 * pixel + 3] * sum[k] / count;
}

/* A ray in many that meets a lamp makes a pixel far brighter than all around it: what it has more
 * than the brightest of those is spread over them, so that none of it is lost. */
static void spread_speck(const filter *f, size_t pixel)
{
	size_t near[8], count = 0;
	int x = (int)(f->pixels->place[pixel] % f->width),
		y = (int)(f->pixels->place[pixel] / f->width);
	float brightest[3] = { 0 };
	for (int v = y - 1; v <= y + 1; v++)
		for (int u = x - 1; u <= x + 1; u++) {
			if ((u == x && v == y) || u < 0 || v < 0 || u >= (int)f->width || v >= (int)f->height)
				continue;
			uint32_t other = f->listed[(size_t)v * f->width + (size_t)u];
			if (other == 0 || !same_surface(f->pixels, pixel, other - 1))
				continue;
			near[count++] = other - 1;
			for (size_t k = 0; k < 3; k++)
				brightest[k] = fmaxf(brightest[k], f->light[3 * near[count - 1] + k]);
		}
	for (size_t k = 0; k < 3 && count >= LEAST_NEAR; k++) {
		float part = (f->light[3 * pixel + k] - brightest[k]) / (float)(count + 1);
		if (!(part > 0.0f))
			continue;
		f->light[3 * pixel + k] = brightest[k] + part;
		for (size_t n = 0; n < count; n++)
			f->light[3 * near[n] + k] += part;
	}
}

gw_status gloss_filter_apply(const gw_pixels *pixels, const gw_reflection *reflection,
							 float *reflected, gw_error *error)
{
	filter f = { pixels, reflection, pixels->width, pixels->height, NULL, NULL };
	f.listed = calloc((size_t)f.width * f.height, sizeof *f.listed);
	f.light = calloc(pixels->count + 1, 3 * sizeof *f.light);
	bool good = f.listed && f.light;
	for (size_t i = 0; i < pixels->count && good; i++) {
		float share = reflected[4 * i + 3];
		f.listed[pixels->place[i]] = (uint32_t)i + 1;
		for (size_t k = 0; k < 3; k++)
			f.light[3 * i + k] = share > 0.0f ? reflected[4 * i + k] / share : 0.0f;
	}
	for (size_t i = 0; i < pixels->count && good; i++)
		spread_speck(&f, i);
	for (size_t i = 0; i < pixels->count && good; i++)
		smooth(&f, i, reflected);
	free(f.listed);
	free(f.light);
	return good ? GW_OK
				: gw_fail(error, GW_ERROR_MEMORY, "no memory to smooth %zu pixels", pixels->count);
}
