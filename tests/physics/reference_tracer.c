#include "reference_tracer.h"
#include "parallel.h"

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

struct reference_tracer {
	const mesh_scene *scene;
	RTCDevice device;
	RTCScene rays;
	uint32_t *emitter; /* triangles that emit; owned */
	double *share;     /* emitter_count, cumulative share of the power of all emitters; owned */
	size_t emitter_count;
	double *area_density; /* of each triangle of the scene: probability a square metre; owned */
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
	if (s->pair > 2 * FIRST_ROULETTE) {
		h = mix(h ^ s->index);
		out[0] = (double)(h >> 32) * 0x1p-32;
		out[1] = (double)(h & 0xffffffffu) * 0x1p-32;
		return;
	}
	uint64_t g = mix(h);
	uint32_t shuffled = scramble_reversed(s->index, (uint32_t)g) & s->mask;
	out[0] = scramble(reverse_bits(shuffled), (uint32_t)h) * 0x1p-32;
	out[1] = scramble(sobol_second(shuffled), (uint32_t)(h >> 32)) * 0x1p-32;
}

/* -------------------------------------------------------------------------------- vectors */

static double dot(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
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

/* The first emitter whose cumulative share is above a number. */
static size_t pick_emitter(const reference_tracer *t, double *number)
{
	size_t low = 0, high = t->emitter_count - 1;
	while (low < high) {
		size_t middle = (low + high) / 2;
		if (t->share[middle] > *number)
			high = middle;
		else
			low = middle + 1;
	}
	double before = low ? t->share[low - 1] : 0.0;
	*number = fmin((*number - before) / (t->share[low] - before), 1.0 - 0x1p-52);
	return t->emitter[low];
}

/* One place on an emitter, weighed against meeting it by a cosine-distributed direction. */
static void add_emitter(const reference_tracer *t, const vertex *v, double random[2], double sum[3])
{
	const mesh_triangle *e = &t->scene->triangle[pick_emitter(t, &random[0])];
	double root = sqrt(random[0]), a = root * (1.0 - random[1]), b = root * random[1], to[3];
	for (size_t k = 0; k < 3; k++)
		to[k] = e->corner[0][k] + a * (e->corner[1][k] - e->corner[0][k]) +
				b * (e->corner[2][k] - e->corner[0][k]) - v->p[k];
	double square = dot(to, to), distance = sqrt(square);
	for (size_t k = 0; k < 3; k++)
		to[k] /= distance;
	double cosine = dot(v->normal, to), leaving = -dot(e->normal, to);
	if (cosine <= 0.0 || leaving <= 0.0 || !is_free(t, v, to, distance - OFFSET))
		return;
	double density = t->area_density[e - t->scene->triangle] * square / leaving;
	double weight = density / (density + cosine / PI);
	for (size_t k = 0; k < 3; k++)
		sum[k] += (double)e->emission[k] * cosine / density * weight;
}

/* Irradiance from all that can be aimed at: lamps, sun, emitters. */
static void add_aimed(const reference_tracer *t, const vertex *v, sampler *random, double sum[3])
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
	if (t->emitter_count > 0)
		add_emitter(t, v, pair, sum);
}

/* ---------------------------------------------------------------------------------- paths */

/* The triangle that a ray meets, and where; NULL when none. */
static const mesh_triangle *find_hit(const reference_tracer *t, const vertex *v,
									 const double direction[3], double place[3], double *distance)
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
	return &t->scene->triangle[query.hit.primID];
}

/* Emission that a cosine-distributed direction met, weighed against aiming at it. */
static double met_weight(const reference_tracer *t, const mesh_triangle *hit, double cosine,
						 double leaving, double distance)
{
	double density = t->area_density[hit - t->scene->triangle] * distance * distance / leaving;
	return cosine / PI / (cosine / PI + density);
}

/* Follows one path from a vertex. throughput turns what arrives further on into irradiance at the
 * first vertex. */
static void add_path(const reference_tracer *t, vertex v, sampler *random, double direct[3],
					 double indirect[3])
{
	double throughput[3] = { 1, 1, 1 };
	add_aimed(t, &v, random, direct);
	for (unsigned depth = 0;; depth++) {
		double pair[2], direction[3], place[3], distance, *sum = depth ? indirect : direct;
		draw_pair(random, pair);
		double cosine = sqrt(pair[0]);
		direct_about(v.normal, cosine, pair[1], direction);
		const mesh_triangle *hit = find_hit(t, &v, direction, place, &distance);
		if (!hit) {
			for (size_t k = 0; k < 3; k++)
				sum[k] += throughput[k] * PI * (double)t->sky[k];
			return;
		}
		double leaving = -dot(hit->normal, direction), largest = 0.0, aimed[3] = { 0 };
		if (leaving <= 0.0)
			return;
		bool emits = t->area_density[hit - t->scene->triangle] > 0.0;
		double weight = emits ? met_weight(t, hit, cosine, leaving, distance) : 0.0;
		v = make_vertex(place, hit->normal);
		add_aimed(t, &v, random, aimed);
		for (size_t k = 0; k < 3; k++) {
			sum[k] += throughput[k] * PI * (double)hit->emission[k] * weight;
			throughput[k] *= (double)hit->albedo[k];
			indirect[k] += throughput[k] * aimed[k];
			largest = fmax(largest, throughput[k]);
		}
		if (depth + 1 < FIRST_ROULETTE)
			continue;
		draw_pair(random, pair);
		double stay = fmin(0.95, largest);
		if (!(pair[0] < stay))
			return;
		for (size_t k = 0; k < 3; k++)
			throughput[k] /= stay;
	}
}

/* ----------------------------------------------------------------------------- many points */

static double luminance(const double rgb[3])
{
	return 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
}

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
	const double *surface;
	const uint32_t *triangle;
	size_t count;
	uint32_t paths;
	uint64_t seed;
	reference_light *light;
	void (*shown)(double done);
	atomic_size_t done;
} job;

static void light_chunk(void *user, size_t first, size_t last, uint32_t worker)
{
	job *j = user;
	for (size_t i = first; i < last; i++)
		light_point(j->tracer, j->surface + 3 * i, &j->tracer->scene->triangle[j->triangle[i]],
					j->paths, mix(j->seed ^ mix(i)), &j->light[i]);
	size_t done = atomic_fetch_add(&j->done, last - first) + last - first;
	if (j->shown && worker == 0)
		j->shown((double)done / (double)j->count);
}

void reference_tracer_light(const reference_tracer *tracer, const double *surface,
							const uint32_t *triangle, size_t count, uint32_t paths, uint64_t seed,
							uint32_t threads, reference_light *light, void (*shown)(double done))
{
	uint32_t power = 1;
	while (power < paths && power < 1u << 30)
		power *= 2;
	job j = { .tracer = tracer,
			  .surface = surface,
			  .triangle = triangle,
			  .count = count,
			  .paths = power,
			  .seed = seed,
			  .light = light,
			  .shown = shown };
	gw_parallel_for(threads, count, 16, light_chunk, &j);
}

/* --------------------------------------------------------------------------------- making */

static bool find_emitters(reference_tracer *t)
{
	const mesh_scene *s = t->scene;
	double power = 0.0;
	t->emitter = reallocarray(NULL, s->count, sizeof *t->emitter);
	t->share = reallocarray(NULL, s->count, sizeof *t->share);
	t->area_density = calloc(s->count, sizeof *t->area_density);
	if (!t->emitter || !t->share || !t->area_density)
		return false;
	for (size_t i = 0; i < s->count; i++) {
		const float *e = s->triangle[i].emission;
		double own = luminance((const double[3]){ (double)e[0], (double)e[1], (double)e[2] });
		if (own <= 0.0)
			continue;
		power += own * s->triangle[i].area;
		t->area_density[i] = own;
		t->emitter[t->emitter_count] = (uint32_t)i;
		t->share[t->emitter_count++] = power;
	}
	for (size_t i = 0; i < t->emitter_count; i++) {
		t->share[i] /= power;
		t->area_density[t->emitter[i]] /= power;
	}
	for (size_t i = 0; i < s->light_count; i++)
		if (s->light[i].type == GW_LIGHT_ENVIRONMENT)
			memcpy(t->sky, s->light[i].radiance, sizeof t->sky);
	return true;
}

static bool build(reference_tracer *t)
{
	size_t n = t->scene->count;
	t->device = rtcNewDevice("threads=1");
	t->rays = t->device ? rtcNewScene(t->device) : NULL;
	RTCGeometry mesh = t->device ? rtcNewGeometry(t->device, RTC_GEOMETRY_TYPE_TRIANGLE) : NULL;
	if (!t->rays || !mesh)
		return false;
	float *corner = rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
											3 * sizeof(float), 3 * n);
	uint32_t *index = rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
											  3 * sizeof(uint32_t), n);
	if (corner && index) {
		for (size_t i = 0; i < 9 * n; i++)
			corner[i] = (float)t->scene->triangle[i / 9].corner[i / 3 % 3][i % 3];
		for (size_t i = 0; i < 3 * n; i++)
			index[i] = (uint32_t)i;
		rtcCommitGeometry(mesh);
		rtcAttachGeometry(t->rays, mesh);
		rtcSetSceneFlags(t->rays, RTC_SCENE_FLAG_ROBUST);
		rtcCommitScene(t->rays);
	}
	rtcReleaseGeometry(mesh);
	return corner && index && rtcGetDeviceError(t->device) == RTC_ERROR_NONE;
}

gw_status reference_tracer_create(const mesh_scene *scene, reference_tracer **tracer,
								  gw_error *error)
{
	*tracer = calloc(1, sizeof **tracer);
	if (*tracer) {
		(*tracer)->scene = scene;
		if (find_emitters(*tracer) && build(*tracer))
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
	free(t->emitter);
	free(t->share);
	free(t->area_density);
	free(t);
}
