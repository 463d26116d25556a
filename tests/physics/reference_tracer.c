#include "reference_tracer.h"
#include "base/parallel.h"

#include <embree3/rtcore.h>
#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846

/* Rays begin this far in front of the surface and end as much before a lamp. */
#define OFFSET 1e-4

/* From this vertex on, paths end by chance and directions are plain random numbers. */
#define FIRST_ROULETTE 3u

/* Surface is cut into about so many patches, to learn which of it lamps and emitters light. */
#define PATCHES 40000.0

/* Places at which a patch is tried. */
#define TRIES 4u

/* A part of a triangle. */
typedef struct patch {
	double corner[3], u[3], v[3]; /* u and v lead to the other corners */
	uint32_t triangle;
	double density; /* probability of being aimed at, a square metre */
} patch;

/* Places on surface to aim at, more often where more light comes from. */
typedef struct targets {
	uint32_t *item; /* owned; triangles or patches */
	double *share;  /* owned; cumulative, the last is 1 */
	size_t count;
} targets;

struct reference_tracer {
	const mesh_scene *scene;
	RTCDevice device;
	RTCScene rays;
	patch *patch; /* owned */
	size_t patch_count;
	targets emitters;        /* triangles */
	targets lit;             /* patches that lamps or emitters light */
	double *emitter_density; /* of each triangle: probability a square metre; owned */
	float sky[3];
};

/* ------------------------------------------------------------------------- random numbers */

typedef struct sampler {
	uint64_t seed;
	uint32_t index, mask; /* of the sample among its batch, a power of two less one */
	uint32_t pair;        /* pairs drawn for this sample */
} sampler;

static uint64_t mix(uint64_t z)
{
	z += 0x9e3779b97f4a7c15u;
	z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
	z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
	return z ^ (z >> 31);
}

static uint32_t reverse_bits(uint32_t x)
{
	x = __builtin_bswap32(x);
	x = (x >> 4 & 0x0f0f0f0fu) | (x & 0x0f0f0f0fu) << 4;
	x = (x >> 2 & 0x33333333u) | (x & 0x33333333u) << 2;
	return (x >> 1 & 0x55555555u) | (x & 0x55555555u) << 1;
}

/* Owen's scrambling of a number whose bits are reversed, by a hash in which each bit depends on
 * lower ones only (Laine and Karras 2011, constants of Burley 2020). */
static uint32_t scramble_reversed(uint32_t x, uint32_t seed)
{
	x ^= x * 0x3d20adeau;
	x += seed;
	x *= (seed >> 16) | 1u;
	x ^= x * 0x05526c56u;
	x ^= x * 0x53a22864u;
	return x;
}

static uint32_t scramble(uint32_t x, uint32_t seed)
{
	return reverse_bits(scramble_reversed(reverse_bits(x), seed));
}

/* The second dimension of Sobol's sequence; the first is the reversed index. */
static uint32_t sobol_second(uint32_t index)
{
	uint32_t sum = 0;
	for (uint32_t v = 1u << 31; index; index >>= 1, v ^= v >> 1)
		if (index & 1u)
			sum ^= v;
	return sum;
}

/* The next pair of numbers in [0, 1): each pair is a two-dimensional sequence of its own, in an
 * order of its own. */
static void draw_pair(sampler *s, double out[2])
{
	uint64_t h = mix(s->seed + 0x632be59bd9b4e019u * ++s->pair);
	if (s->pair > 12) {
		h = mix(h ^ s->index);
		out[0] = (double)(h >> 32) * 0x1p-32;
		out[1] = (double)(h & 0xffffffffu) * 0x1p-32;
		return;
	}
	uint64_t g = mix(h);
	uint32_t shuffled = scramble(s->index, (uint32_t)g) & s->mask;
	out[0] = scramble(reverse_bits(shuffled), (uint32_t)h) * 0x1p-32;
	out[1] = scramble(sobol_second(shuffled), (uint32_t)(h >> 32)) * 0x1p-32;
}

/* -------------------------------------------------------------------------------- vectors */

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double luminance(const double rgb[3])
{
	return 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
}

/* A direction about an axis: z is the cosine, turn goes once around from 0 to 1. */
static void direct_about(const double n[3], double z, double turn, double out[3])
{
	/* Duff et al. 2017: an orthonormal basis without branches. */
	double sign = copysign(1.0, n[2]), a = -1.0 / (sign + n[2]), b = n[0] * n[1] * a;
	const double u[3] = { 1.0 + sign * n[0] * n[0] * a, sign * b, -sign * n[0] };
	const double v[3] = { b, sign + n[1] * n[1] * a, -n[1] };
	double r = sqrt(fmax(0.0, 1.0 - z * z)), x = r * cos(2 * PI * turn), y = r * sin(2 * PI * turn);
	for (size_t k = 0; k < 3; k++)
		out[k] = x * u[k] + y * v[k] + z * n[k];
}

/* ------------------------------------------------------------------------------ lamps */

/* One place on a surface where light arrives. */
typedef struct vertex {
	double p[3];          /* in front of the surface */
	const double *normal; /* unit */
} vertex;

static vertex make_vertex(const double place[3], const double *normal)
{
	vertex v = { .normal = normal };
	for (size_t k = 0; k < 3; k++)
		v.p[k] = place[k] + OFFSET * normal[k];
	return v;
}

static bool is_free(const reference_tracer *t, const vertex *v, const double direction[3],
					double distance)
{
	struct RTCIntersectContext context;
	rtcInitIntersectContext(&context);
	struct RTCRay ray = { .org_x = (float)v->p[0],
						  .org_y = (float)v->p[1],
						  .org_z = (float)v->p[2],
						  .dir_x = (float)direction[0],
						  .dir_y = (float)direction[1],
						  .dir_z = (float)direction[2],
						  .tfar = (float)distance,
						  .mask = 0xffffffffu };
	rtcOccluded1(t->rays, &context, &ray);
	return ray.tfar >= 0.0f;
}

/* Share of a spot light's intensity in a direction. */
static double spot_share(const gw_light *light, const double travel[3])
{
	if (light->type != GW_LIGHT_SPOT)
		return 1.0;
	double axis = sqrt(dot(light->direction, light->direction));
	double cosine = dot(light->direction, travel) / axis;
	double inner = cos((double)light->inner_angle * PI / 180.0);
	double outer = cos((double)light->outer_angle * PI / 180.0);
	double x = fmin(1.0, fmax(0.0, (cosine - outer) / (inner - outer)));
	return x * x * (3.0 - 2.0 * x);
}

static void add_lamp(const reference_tracer *t, const gw_light *light, const vertex *v,
					 double sum[3])
{
	double to[3], travel[3];
	for (size_t k = 0; k < 3; k++)
		to[k] = light->position[k] - v->p[k];
	double distance = sqrt(dot(to, to));
	for (size_t k = 0; k < 3; k++) {
		to[k] /= distance;
		travel[k] = -to[k];
	}
	double cosine = dot(v->normal, to);
	double share = cosine > 0.0 ? spot_share(light, travel) : 0.0;
	if (share <= 0.0 || !is_free(t, v, to, distance))
		return;
	for (size_t k = 0; k < 3; k++)
		sum[k] += (double)light->intensity[k] * share * cosine / (distance * distance);
}

/* The sun as an even disc in the sky: irradiance on a plane that faces it, spread over its
 * directions. */
static void add_sun(const reference_tracer *t, const gw_light *light, const vertex *v,
					const double random[2], double sum[3])
{
	double axis[3], to[3], length = sqrt(dot(light->direction, light->direction));
	double edge = cos((double)light->angle * 0.5 * PI / 180.0);
	for (size_t k = 0; k < 3; k++)
		axis[k] = -light->direction[k] / length;
	direct_about(axis, 1.0 - random[0] * (1.0 - edge), random[1], to);
	double cosine = dot(v->normal, to);
	if (cosine <= 0.0 || !is_free(t, v, to, INFINITY))
		return;
	/* The mean of the cosine over the disc, which a plane that faces it sees. */
	double mean = 0.5 * (1.0 + edge);
	for (size_t k = 0; k < 3; k++)
		sum[k] += (double)light->irradiance[k] * cosine / mean;
}

/* The item whose share of 0..1 holds a number, which becomes a number of 0..1 within that share. */
static uint32_t pick(const targets *t, double *number)
{
	size_t low = 0, high = t->count - 1;
	while (low < high) {
		size_t middle = (low + high) / 2;
		if (t->share[middle] > *number)
			high = middle;
		else
			low = middle + 1;
	}
	double before = low ? t->share[low - 1] : 0.0;
	*number = fmin((*number - before) / (t->share[low] - before), 1.0 - 0x1p-52);
	return t->item[low];
}

/* A line from a vertex to a place on some surface. */
typedef struct connection {
	double to[3], distance;
	double cosine, leaving; /* at the vertex and at the place */
} connection;

/* False when they do not see each other. */
static bool connect(const reference_tracer *t, const vertex *v, const double place[3],
					const double normal[3], connection *c)
{
	for (size_t k = 0; k < 3; k++)
		c->to[k] = place[k] - v->p[k];
	c->distance = sqrt(dot(c->to, c->to));
	for (size_t k = 0; k < 3; k++)
		c->to[k] /= c->distance;
	c->cosine = dot(v->normal, c->to);
	c->leaving = -dot(normal, c->to);
	return c->cosine > 0.0 && c->leaving > 0.0 && c->distance > 2 * OFFSET &&
		   is_free(t, v, c->to, c->distance - OFFSET);
}

static void place_on(const double corner[3], const double u[3], const double v[3],
					 const double random[2], double out[3])
{
	double root = sqrt(random[0]), a = root * (1.0 - random[1]), b = root * random[1];
	for (size_t k = 0; k < 3; k++)
		out[k] = corner[k] + a * u[k] + b * v[k];
}

/* Weight of aiming, with this density an area, against meeting by a cosine-distributed direction.
 */
static double aimed_weight(const connection *c, double density)
{
	double angular = density * c->distance * c->distance / c->leaving;
	return angular / (angular + c->cosine / PI);
}

/* Light of one place on the emitters. weighed: they are also met by chance. */
static void add_emitter(const reference_tracer *t, const vertex *v, double random[2], bool weighed,
						double sum[3])
{
	const mesh_triangle *e = &t->scene->triangle[pick(&t->emitters, &random[0])];
	double density = t->emitter_density[e - t->scene->triangle], p[3], edge[2][3];
	connection c;
	for (size_t k = 0; k < 3; k++) {
		edge[0][k] = e->corner[1][k] - e->corner[0][k];
		edge[1][k] = e->corner[2][k] - e->corner[0][k];
	}
	place_on(e->corner[0], edge[0], edge[1], random, p);
	if (!connect(t, v, p, e->normal, &c))
		return;
	double share = c.cosine * c.leaving / (c.distance * c.distance * density);
	if (weighed)
		share *= aimed_weight(&c, density);
	for (size_t k = 0; k < 3; k++)
		sum[k] += (double)e->emission[k] * share;
}

/* Irradiance straight from lamps, sun and emitters. */
static void add_sources(const reference_tracer *t, const vertex *v, sampler *random, bool weighed,
						double sum[3])
{
	double pair[2];
	draw_pair(random, pair);
	for (size_t i = 0; i < t->scene->light_count; i++) {
		const gw_light *light = &t->scene->light[i];
		if (light->type == GW_LIGHT_SUN)
			add_sun(t, light, v, pair, sum);
		else if (light->type != GW_LIGHT_ENVIRONMENT)
			add_lamp(t, light, v, sum);
	}
	if (t->emitters.count > 0)
		add_emitter(t, v, pair, weighed, sum);
}

/* Sky through the one opening that lets it in, if the scene says where that is. */
static void add_sky(const reference_tracer *t, const vertex *v, sampler *random,
					const double throughput[3], double sum[3])
{
	const mesh_opening *o = &t->scene->opening;
	double pair[2], place[3];
	connection c;
	if (o->area <= 0.0)
		return;
	draw_pair(random, pair);
	for (size_t k = 0; k < 3; k++)
		place[k] = o->corner[k] + pair[0] * o->u[k] + pair[1] * o->v[k];
	if (!connect(t, v, place, o->normal, &c))
		return;
	double share = aimed_weight(&c, 1.0 / o->area) * c.cosine * c.leaving * o->area /
				   (c.distance * c.distance);
	for (size_t k = 0; k < 3; k++)
		sum[k] += throughput[k] * (double)t->sky[k] * share;
}

/* Light that one place reflects to the vertex, aimed at because sources light it. */
static void add_lit(const reference_tracer *t, const vertex *v, sampler *random,
					const double throughput[3], double sum[3])
{
	double pair[2], place[3], arriving[3] = { 0 };
	connection c;
	draw_pair(random, pair);
	const patch *at = &t->patch[pick(&t->lit, &pair[0])];
	const mesh_triangle *triangle = &t->scene->triangle[at->triangle];
	place_on(at->corner, at->u, at->v, pair, place);
	if (!connect(t, v, place, triangle->normal, &c))
		return;
	vertex there = make_vertex(place, triangle->normal);
	add_sources(t, &there, random, false, arriving);
	double share = aimed_weight(&c, at->density) * c.cosine * c.leaving /
				   (c.distance * c.distance * at->density);
	for (size_t k = 0; k < 3; k++)
		sum[k] += throughput[k] * (double)triangle->albedo[k] / PI * arriving[k] * share;
}

/* ---------------------------------------------------------------------------------- paths */

/* The patch that a ray meets, and where; NULL when none. */
static const patch *find_hit(const reference_tracer *t, const vertex *v, const double direction[3],
							 double place[3], double *distance)
{
	struct RTCIntersectContext context;
	rtcInitIntersectContext(&context);
	struct RTCRayHit query = { .ray = { .org_x = (float)v->p[0],
										.org_y = (float)v->p[1],
										.org_z = (float)v->p[2],
										.dir_x = (float)direction[0],
										.dir_y = (float)direction[1],
										.dir_z = (float)direction[2],
										.tfar = INFINITY,
										.mask = 0xffffffffu },
							   .hit = { .geomID = RTC_INVALID_GEOMETRY_ID } };
	rtcIntersect1(t->rays, &context, &query);
	if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID)
		return NULL;
	*distance = (double)query.ray.tfar;
	for (size_t k = 0; k < 3; k++)
		place[k] = v->p[k] + *distance * direction[k];
	return &t->patch[query.hit.primID];
}

/* Weight of having met a place by a cosine-distributed direction, against aiming at it. */
static double met_weight(double density, double cosine, double leaving, double distance)
{
	return cosine / PI / (cosine / PI + density * distance * distance / leaving);
}

bool reference_tracer_hit(const reference_tracer *t, const double origin[3],
						  const double direction[3], uint32_t *triangle, double *distance)
{
	double place[3];
	const vertex v = { .p = { origin[0], origin[1], origin[2] } };
	const patch *hit = find_hit(t, &v, direction, place, distance);
	if (hit)
		*triangle = hit->triangle;
	return hit;
}

/* Sky that a path met when it left the scene. */
static void add_met_sky(const reference_tracer *t, const vertex *v, const double direction[3],
						const double throughput[3], double sum[3])
{
	const mesh_opening *o = &t->scene->opening;
	double weight = 1.0;
	if (o->area > 0.0) {
		double leaving = -dot(o->normal, direction);
		double distance = (dot(o->normal, v->p) - dot(o->normal, o->corner)) / leaving;
		weight = met_weight(1.0 / o->area, dot(v->normal, direction), leaving, distance);
	}
	for (size_t k = 0; k < 3; k++)
		sum[k] += throughput[k] * PI * (double)t->sky[k] * weight;
}

/*
 * Follows one path from a vertex. What the sources send to the vertex is direct. Of the rest, what
 * was reflected once is found both by aiming at lit places and by the path itself, and what was
 * reflected more often by the next vertex in the same way. throughput turns what arrives further
 * on into irradiance at the first vertex.
 */
static void add_path(const reference_tracer *t, vertex v, sampler *random, double direct[3],
					 double indirect[3])
{
	double throughput[3] = { 1, 1, 1 };
	add_sources(t, &v, random, true, direct);
	for (unsigned depth = 0;; depth++) {
		double pair[2], direction[3], place[3], distance, largest = 0.0, arriving[3] = { 0 };
		double *sum = depth ? indirect : direct;
		add_sky(t, &v, random, throughput, sum);
		if (t->lit.count > 0)
			add_lit(t, &v, random, throughput, indirect);
		draw_pair(random, pair);
		double cosine = sqrt(pair[0]);
		direct_about(v.normal, cosine, pair[1], direction);
		const patch *hit = find_hit(t, &v, direction, place, &distance);
		if (!hit)
			add_met_sky(t, &v, direction, throughput, sum);
		const mesh_triangle *triangle = hit ? &t->scene->triangle[hit->triangle] : NULL;
		double leaving = hit ? -dot(triangle->normal, direction) : 0.0;
		if (leaving <= 0.0)
			return;
		double density = t->emitter_density[hit->triangle];
		for (size_t k = 0; k < 3 && depth == 0 && density > 0.0; k++)
			direct[k] +=
				PI * (double)triangle->emission[k] * met_weight(density, cosine, leaving, distance);
		double weight = met_weight(hit->density, cosine, leaving, distance);
		v = make_vertex(place, triangle->normal);
		add_sources(t, &v, random, false, arriving);
		for (size_t k = 0; k < 3; k++) {
			throughput[k] *= (double)triangle->albedo[k];
			indirect[k] += throughput[k] * arriving[k] * weight;
			largest = fmax(largest, throughput[k]);
		}
		if (depth + 1 < FIRST_ROULETTE)
			continue;
		draw_pair(random, pair);
		double stay = fmin(0.999, largest);
		if (!(pair[0] < stay))
			return;
		for (size_t k = 0; k < 3; k++)
			throughput[k] /= stay;
	}
}

/* ----------------------------------------------------------------------------- many points */

static void light_point(const reference_tracer *t, const double place[3],
						const mesh_triangle *triangle, uint32_t paths, uint64_t seed,
						reference_light *light)
{
	double sum = 0.0, squares = 0.0;
	vertex v = make_vertex(place, triangle->normal);
	*light = (reference_light){ 0 };
	for (uint32_t batch = 0; batch < REFERENCE_BATCHES; batch++) {
		double direct[3] = { 0 }, indirect[3] = { 0 }, radiance[3];
		sampler random = { .seed = mix(seed + batch), .mask = paths - 1 };
		for (random.index = 0; random.index < paths; random.index++) {
			random.pair = 0;
			add_path(t, v, &random, direct, indirect);
		}
		for (size_t k = 0; k < 3; k++) {
			light->direct[k] += direct[k] / paths / REFERENCE_BATCHES;
			light->indirect[k] += indirect[k] / paths / REFERENCE_BATCHES;
			radiance[k] = (double)triangle->albedo[k] / PI * (direct[k] + indirect[k]) / paths;
		}
		sum += luminance(radiance);
		squares += luminance(radiance) * luminance(radiance);
	}
	double n = REFERENCE_BATCHES, variance = (squares - sum * sum / n) / (n - 1.0);
	light->error = sqrt(fmax(0.0, variance) / n);
}

/* All that the threads share. */
typedef struct job {
	const reference_tracer *tracer;
	const reference_places *places;
	uint32_t paths; /* a power of two */
	reference_light *light;
	atomic_size_t done;
} job;

static void light_chunk(void *user, size_t first, size_t last, uint32_t worker)
{
	job *j = user;
	const reference_places *p = j->places;
	for (size_t i = first; i < last; i++)
		light_point(j->tracer, p->surface + 3 * i, &j->tracer->scene->triangle[p->triangle[i]],
					j->paths, mix(p->seed ^ mix(i)), &j->light[i]);
	size_t done = atomic_fetch_add(&j->done, last - first) + last - first;
	if (p->shown && worker == 0)
		p->shown((double)done / (double)p->count);
}

void reference_tracer_light(const reference_tracer *tracer, const reference_places *places,
							reference_light *light)
{
	uint32_t power = 1;
	while (power < places->paths && power < 1u << 30)
		power *= 2;
	job j = { .tracer = tracer, .places = places, .paths = power, .light = light };
	gw_parallel_for(places->threads, places->count, 16, light_chunk, &j);
}

/* --------------------------------------------------------------------------------- making */

static bool allocate_targets(targets *t, size_t count)
{
	t->item = reallocarray(NULL, count, sizeof *t->item);
	t->share = reallocarray(NULL, count, sizeof *t->share);
	return t->item && t->share;
}

/* Adds an item whose share is `power` of the sum of all. */
static void add_target(targets *t, size_t item, double power)
{
	double before = t->count ? t->share[t->count - 1] : 0.0;
	if (!(power > 0.0))
		return;
	t->item[t->count] = (uint32_t)item;
	t->share[t->count++] = before + power;
}

/* Makes shares of powers; returns their sum. */
static double end_targets(targets *t)
{
	double power = t->count ? t->share[t->count - 1] : 1.0;
	for (size_t i = 0; i < t->count; i++)
		t->share[i] /= power;
	return power;
}

static bool find_emitters(reference_tracer *t)
{
	const mesh_scene *s = t->scene;
	t->emitter_density = calloc(s->count, sizeof *t->emitter_density);
	if (!t->emitter_density || !allocate_targets(&t->emitters, s->count))
		return false;
	for (size_t i = 0; i < s->count; i++) {
		const float *e = s->triangle[i].emission;
		t->emitter_density[i] =
			luminance((const double[3]){ (double)e[0], (double)e[1], (double)e[2] });
		add_target(&t->emitters, i, t->emitter_density[i] * s->triangle[i].area);
	}
	double power = end_targets(&t->emitters);
	for (size_t i = 0; i < s->count; i++)
		t->emitter_density[i] /= power;
	for (size_t i = 0; i < s->light_count; i++)
		if (s->light[i].type == GW_LIGHT_ENVIRONMENT)
			memcpy(t->sky, s->light[i].radiance, sizeof t->sky);
	return true;
}

/* Into how many parts each side of a triangle is cut. */
static size_t cuts_of(const mesh_triangle *triangle, double area)
{
	return (size_t)ceil(sqrt(triangle->area / area));
}

/* The j-th patch of row i of a triangle with n rows; the rows widen from the first corner on. */
static patch make_patch(const mesh_scene *s, size_t index, size_t n, size_t i, size_t j)
{
	const mesh_triangle *t = &s->triangle[index];
	double column = (double)(j / 2), row = (double)i, turned = j % 2 ? -1.0 : 1.0;
	patch p = { .triangle = (uint32_t)index };
	/* Every other patch stands on its head, at the far corner of the parallelogram. */
	double a = row + (j % 2 ? 1.0 : 0.0), b = column + (j % 2 ? 1.0 : 0.0);
	for (size_t k = 0; k < 3; k++) {
		double u = (t->corner[1][k] - t->corner[0][k]) / (double)n;
		double v = (t->corner[2][k] - t->corner[0][k]) / (double)n;
		p.corner[k] = t->corner[0][k] + a * u + b * v;
		p.u[k] = turned * u;
		p.v[k] = turned * v;
	}
	return p;
}

static bool make_patches(reference_tracer *t)
{
	const mesh_scene *s = t->scene;
	double area = 0.0;
	size_t count = 0;
	for (size_t i = 0; i < s->count; i++)
		area += s->triangle[i].area / PATCHES;
	for (size_t i = 0; i < s->count; i++)
		count += cuts_of(&s->triangle[i], area) * cuts_of(&s->triangle[i], area);
	t->patch = reallocarray(NULL, count, sizeof *t->patch);
	for (size_t index = 0; t->patch && index < s->count; index++) {
		size_t n = cuts_of(&s->triangle[index], area);
		for (size_t i = 0; i < n; i++)
			for (size_t j = 0; j < 2 * (n - i) - 1; j++)
				t->patch[t->patch_count++] = make_patch(s, index, n, i, j);
	}
	return t->patch;
}

/* Finds out, roughly, how much light each patch reflects that comes straight from the sources. */
static bool find_lit(reference_tracer *t)
{
	if (!allocate_targets(&t->lit, t->patch_count))
		return false;
	for (size_t i = 0; i < t->patch_count; i++) {
		patch *p = &t->patch[i];
		const mesh_triangle *triangle = &t->scene->triangle[p->triangle];
		double sum[3] = { 0 };
		sampler random = { .seed = mix(i), .mask = TRIES - 1 };
		for (random.index = 0; random.index < TRIES; random.index++) {
			double pair[2], place[3];
			random.pair = 0;
			draw_pair(&random, pair);
			place_on(p->corner, p->u, p->v, pair, place);
			vertex v = make_vertex(place, triangle->normal);
			add_sources(t, &v, &random, false, sum);
		}
		for (size_t k = 0; k < 3; k++)
			sum[k] *= (double)triangle->albedo[k];
		p->density = luminance(sum);
		double side[3] = { p->u[1] * p->v[2] - p->u[2] * p->v[1],
						   p->u[2] * p->v[0] - p->u[0] * p->v[2],
						   p->u[0] * p->v[1] - p->u[1] * p->v[0] };
		add_target(&t->lit, i, p->density * 0.5 * sqrt(dot(side, side)));
	}
	double whole = end_targets(&t->lit);
	for (size_t i = 0; i < t->patch_count; i++)
		t->patch[i].density /= whole;
	return true;
}

static bool build(reference_tracer *t)
{
	size_t n = t->patch_count;
	t->device = rtcNewDevice("threads=1");
	t->rays = t->device ? rtcNewScene(t->device) : NULL;
	RTCGeometry mesh = t->device ? rtcNewGeometry(t->device, RTC_GEOMETRY_TYPE_TRIANGLE) : NULL;
	if (!t->rays || !mesh)
		return false;
	float *corner = rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
											3 * sizeof(float), 3 * n);
	uint32_t *index = rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
											  3 * sizeof(uint32_t), n);
	for (size_t i = 0; corner && i < 9 * n; i++) {
		const patch *p = &t->patch[i / 9];
		size_t k = i % 3, at = i / 3 % 3;
		corner[i] = (float)(p->corner[k] + (at == 1 ? p->u[k] : at == 2 ? p->v[k] : 0.0));
	}
	for (size_t i = 0; index && i < 3 * n; i++)
		index[i] = (uint32_t)i;
	rtcCommitGeometry(mesh);
	rtcAttachGeometry(t->rays, mesh);
	rtcSetSceneFlags(t->rays, RTC_SCENE_FLAG_ROBUST);
	rtcCommitScene(t->rays);
	rtcReleaseGeometry(mesh);
	return corner && index && rtcGetDeviceError(t->device) == RTC_ERROR_NONE;
}

gw_status reference_tracer_create(const mesh_scene *scene, reference_tracer **tracer,
								  gw_error *error)
{
	*tracer = calloc(1, sizeof **tracer);
	if (*tracer) {
		(*tracer)->scene = scene;
		if (find_emitters(*tracer) && make_patches(*tracer) && build(*tracer) && find_lit(*tracer))
			return GW_OK;
	}
	reference_tracer_destroy(tracer);
	return gw_fail(error, GW_ERROR_INTERNAL, "Embree or memory failed for %zu triangles",
				   scene->count);
}

void reference_tracer_destroy(reference_tracer **tracer)
{
	reference_tracer *t = *tracer;
	*tracer = NULL;
	if (!t)
		return;
	if (t->rays)
		rtcReleaseScene(t->rays);
	if (t->device)
		rtcReleaseDevice(t->device);
	free(t->patch);
	free(t->emitters.item);
	free(t->emitters.share);
	free(t->emitter_density);
	free(t->lit.item);
	free(t->lit.share);
	free(t);
}
