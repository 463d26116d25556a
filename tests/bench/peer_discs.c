#include "peer_discs.h"

#include "base/memory.h"
#include "cloud/neighbour_index.h"
#include "base/parallel.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265f

#define CHUNK 4096u

static float dot(const float a[3], const float b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static float luminance(const float c[3])
{
	return 0.2126f * c[0] + 0.7152f * c[1] + 0.0722f * c[2];
}

float peer_random_next(peer_random *random)
{
	uint64_t old = random->state;
	random->state = old * 6364136223846793005u + 1442695040888963407u;
	uint32_t shifted = (uint32_t)((old >> 18 ^ old) >> 27), turn = (uint32_t)(old >> 59);
	uint32_t drawn = shifted >> turn | shifted << (-turn & 31u);
	return (float)(drawn >> 8) * 0x1p-24f;
}

/* ------------------------------------------------------------------------------ neighbours */

typedef struct search {
	peer_discs *discs;
	const gw_neighbour_index *index;
	float *position;
	size_t k;
	bool failed[GW_THREADS_MAX];
} search;

static void search_some(void *user, size_t first, size_t last, uint32_t worker)
{
	search *s = user;
	size_t count = last - first, each = s->discs->neighbours;
	int *found = gw_allocate_array(count, s->k * sizeof *found);
	float *squared = gw_allocate_array(count, s->k * sizeof *squared);
	if (found && squared &&
		gw_neighbour_index_search(s->index, s->position + 3 * first, count, s->k, found, squared))
		for (size_t i = 0; i < count * each; i++) {
			size_t j = i % each, row = i / each;
			s->discs->neighbour[first * each + i] =
				(uint32_t)found[s->k * row + (j < s->k ? j : 0)];
		}
	else
		s->failed[worker] = true;
	free(found);
	free(squared);
}

gw_status peer_discs_neighbours(peer_discs *d, size_t neighbours, gw_error *error)
{
	size_t count = d->surfels.count;
	search s = { .discs = d, .k = count < neighbours ? count : neighbours };
	d->neighbours = neighbours;
	d->neighbour = gw_allocate_array(count, neighbours * sizeof *d->neighbour);
	if (!d->neighbour)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for neighbours");
	s.position = d->surfels.position;
	gw_neighbour_index *index = gw_neighbour_index_build(s.position, count, 0);
	s.index = index;
	if (index)
		gw_parallel_for(0, count, CHUNK, search_some, &s);
	bool failed = !index;
	for (uint32_t i = 0; i < GW_THREADS_MAX; i++)
		failed = failed || s.failed[i];
	if (index)
		gw_neighbour_index_free(index);
	return failed ? gw_fail(error, GW_ERROR_MEMORY, "no memory for neighbours") : GW_OK;
}

bool peer_discs_alike(const peer_discs *d, size_t i, size_t j)
{
	return dot(d->surfels.normal + 3 * i, d->surfels.normal + 3 * j) > 0.7f;
}

/* Discs overlap: the nearest centre, of those that face the same way, owns a place. */
static uint32_t owner_of(const peer_discs *d, uint32_t disc, const float place[3])
{
	const gw_surfels *s = &d->surfels;
	uint32_t best = disc;
	float least = INFINITY;
	for (size_t k = 0; k < d->neighbours; k++) {
		uint32_t i = d->neighbour[(size_t)disc * d->neighbours + k];
		const float *p = s->position + 3 * (size_t)i;
		const float to[3] = { p[0] - place[0], p[1] - place[1], p[2] - place[2] };
		float off = dot(to, to);
		if (off < least && peer_discs_alike(d, i, disc)) {
			least = off;
			best = i;
		}
	}
	return best;
}

/* ------------------------------------------------------------------------------- geometry */

/* Rejects what lies beyond the edges of a disc. */
static void filter(const struct RTCFilterFunctionNArguments *a)
{
	const peer_discs *d = a->geometryUserPtr;
	const struct RTCRay *ray = (const struct RTCRay *)(const void *)a->ray;
	const struct RTCHit *hit = (const struct RTCHit *)(const void *)a->hit;
	const gw_surfels *s = &d->surfels;
	size_t i = hit->primID;
	const float *clip = s->clip + 6 * i;
	const float *frame = d->frame + 6 * i;
	if (clip[0] == 0.0f && clip[1] == 0.0f && clip[3] == 0.0f && clip[4] == 0.0f)
		return;
	const float to[3] = { ray->org_x + ray->tfar * ray->dir_x - s->position[3 * i],
						  ray->org_y + ray->tfar * ray->dir_y - s->position[3 * i + 1],
						  ray->org_z + ray->tfar * ray->dir_z - s->position[3 * i + 2] };
	float x = dot(to, frame), y = dot(to, frame + 3);
	for (int k = 0; k < 6; k += 3)
		if ((clip[k] != 0.0f || clip[k + 1] != 0.0f) && x * clip[k] + y * clip[k + 1] > clip[k + 2])
			a->valid[0] = 0;
}

gw_status peer_discs_index(peer_discs *d, gw_error *error)
{
	const gw_surfels *s = &d->surfels;
	GW_TRY(peer_discs_neighbours(d, PEER_NEIGHBOURS, error));
	d->device = rtcNewDevice(NULL);
	d->scene = d->device ? rtcNewScene(d->device) : NULL;
	if (!d->scene)
		return gw_fail(error, GW_ERROR_INTERNAL, "Embree does not start");
	RTCGeometry g = rtcNewGeometry(d->device, RTC_GEOMETRY_TYPE_ORIENTED_DISC_POINT);
	float *disc =
		rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, 16, s->count);
	float *normal =
		rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_NORMAL, 0, RTC_FORMAT_FLOAT3, 12, s->count);
	if (!disc || !normal)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu discs", s->count);
	for (size_t i = 0; i < s->count; i++) {
		memcpy(disc + 4 * i, s->position + 3 * i, 12);
		disc[4 * i + 3] = s->radius[i];
		memcpy(normal + 3 * i, s->normal + 3 * i, 12);
	}
	rtcSetGeometryUserData(g, d);
	rtcSetGeometryIntersectFilterFunction(g, filter);
	rtcSetGeometryOccludedFilterFunction(g, filter);
	rtcCommitGeometry(g);
	rtcAttachGeometry(d->scene, g);
	rtcReleaseGeometry(g);
	rtcCommitScene(d->scene);
	return GW_OK;
}

/* -------------------------------------------------------------------------------- emitters */

/* Emitters are aimed at in proportion to area and luminance. */
static gw_status find_emitters(peer_discs *d, gw_error *error)
{
	const gw_surfels *s = &d->surfels;
	float sum = 0.0f;
	double total = 0.0;
	d->density = gw_allocate_zeros(s->count, sizeof *d->density);
	d->emitter = gw_allocate_array(s->count, sizeof *d->emitter);
	d->chance = gw_allocate_array(s->count, sizeof *d->chance);
	if (!d->density || !d->emitter || !d->chance)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for emitters");
	for (size_t i = 0; s->emission && i < s->count; i++)
		if (luminance(s->emission + 3 * i) > 0.0f) {
			total += (double)(s->area[i] * luminance(s->emission + 3 * i));
			d->emitter[d->emitter_count++] = (uint32_t)i;
		}
	for (size_t k = 0; k < d->emitter_count; k++) {
		size_t i = d->emitter[k];
		d->density[i] = luminance(s->emission + 3 * i) / (float)total;
		sum += s->area[i] * d->density[i];
		d->chance[k] = k + 1 < d->emitter_count ? sum : 1.0f;
	}
	return GW_OK;
}

static gw_status check_lights(peer_discs *d)
{
	for (size_t k = 0; k < d->light_count; k++) {
		const gw_light *l = &d->lights[k];
		if (l->type == GW_LIGHT_ENVIRONMENT)
			for (int c = 0; c < 3; c++)
				d->sky[c] += l->radiance[c];
		d->soft = d->soft ||
				  (l->type == GW_LIGHT_SUN ? l->angle > 0.0f
										   : l->type != GW_LIGHT_ENVIRONMENT && l->radius > 0.0f);
	}
	return GW_OK;
}

gw_status peer_discs_make(const gw_points *points, const gw_light *lights, size_t light_count,
						  peer_discs *d, gw_error *error)
{
	const gw_surfels_options options = { .lights = lights,
										 .light_count = light_count,
										 .memory = (uint64_t)1 << 31 };
	*d = (peer_discs){ .lights = lights, .light_count = light_count };
	gw_status status = gw_surfels_make(points, &options, &d->surfels, error);
	if (status != GW_OK)
		return status;
	size_t count = d->surfels.count;
	d->frame = gw_allocate_array(count, 6 * sizeof *d->frame);
	if (!d->frame)
		status = gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu discs", count);
	for (size_t i = 0; status == GW_OK && i < count; i++)
		gw_tangent_frame(d->surfels.normal + 3 * i, d->frame + 6 * i, d->frame + 6 * i + 3);
	if (status == GW_OK)
		status = find_emitters(d, error);
	if (status == GW_OK)
		status = check_lights(d);
	if (status != GW_OK)
		peer_discs_clear(d);
	return status;
}

void peer_discs_clear(peer_discs *d)
{
	if (d->scene)
		rtcReleaseScene(d->scene);
	if (d->device)
		rtcReleaseDevice(d->device);
	gw_surfels_clear(&d->surfels);
	free(d->neighbour);
	free(d->frame);
	free(d->emitter);
	free(d->chance);
	free(d->density);
	*d = (peer_discs){ 0 };
}

/* ------------------------------------------------------------------------------------ rays */

static struct RTCRay ray_from(const peer_discs *d, uint32_t from, const float direction[3],
							  float most)
{
	const float *p = d->surfels.position + 3 * (size_t)from;
	const float *n = d->surfels.normal + 3 * (size_t)from;
	float offset = PEER_OFFSET * d->surfels.spacing;
	return (struct RTCRay){ .org_x = p[0] + offset * n[0],
							.org_y = p[1] + offset * n[1],
							.org_z = p[2] + offset * n[2],
							.dir_x = direction[0],
							.dir_y = direction[1],
							.dir_z = direction[2],
							.tfar = most,
							.mask = 0xffffffffu };
}

uint32_t peer_trace(const peer_discs *d, uint32_t from, const float direction[3], float *distance)
{
	struct RTCIntersectContext context;
	rtcInitIntersectContext(&context);
	struct RTCRayHit r = { .ray = ray_from(d, from, direction, INFINITY),
						   .hit = { .geomID = RTC_INVALID_GEOMETRY_ID } };
	rtcIntersect1(d->scene, &context, &r);
	if (r.hit.geomID == RTC_INVALID_GEOMETRY_ID)
		return PEER_NOTHING;
	if (dot(direction, d->surfels.normal + 3 * (size_t)r.hit.primID) >= 0.0f)
		return PEER_BACK;
	*distance = r.ray.tfar;
	const float place[3] = { r.ray.org_x + r.ray.tfar * direction[0],
							 r.ray.org_y + r.ray.tfar * direction[1],
							 r.ray.org_z + r.ray.tfar * direction[2] };
	return owner_of(d, r.hit.primID, place);
}

/* Whether a place is seen from a surfel; its cosine and distance. */
static bool sees(const peer_discs *d, uint32_t from, const float place[3], float *cosine,
				 float *distance, float direction[3])
{
	struct RTCIntersectContext context;
	struct RTCRay r = ray_from(d, from, direction, 0.0f);
	const float to[3] = { place[0] - r.org_x, place[1] - r.org_y, place[2] - r.org_z };
	*distance = sqrtf(dot(to, to));
	for (int k = 0; k < 3; k++)
		direction[k] = to[k] / *distance;
	*cosine = dot(direction, d->surfels.normal + 3 * (size_t)from);
	if (!(*cosine > 0.0f))
		return false;
	r.dir_x = direction[0];
	r.dir_y = direction[1];
	r.dir_z = direction[2];
	r.tfar = *distance;
	rtcInitIntersectContext(&context);
	rtcOccluded1(d->scene, &context, &r);
	return r.tfar >= 0.0f;
}

void peer_cosine_direction(const peer_discs *d, uint32_t surfel, float u, float v, float out[3])
{
	const float *n = d->surfels.normal + 3 * (size_t)surfel;
	const float *frame = d->frame + 6 * (size_t)surfel;
	float r = sqrtf(u), z = sqrtf(fmaxf(1.0f - u, 1e-6f));
	float x = r * cosf(2.0f * PI * v), y = r * sinf(2.0f * PI * v);
	for (int k = 0; k < 3; k++)
		out[k] = x * frame[k] + y * frame[k + 3] + z * n[k];
}

/* ----------------------------------------------------------------------------------- lamps */

static float spot_share(const gw_light *light, const float travel[3])
{
	if (light->type != GW_LIGHT_SPOT)
		return 1.0f;
	double length = 0.0, along = 0.0;
	for (int k = 0; k < 3; k++) {
		length += light->direction[k] * light->direction[k];
		along += light->direction[k] * (double)travel[k];
	}
	float cosine = (float)(along / sqrt(length));
	float inner = cosf(light->inner_angle * PI / 180.0f);
	float outer = cosf(light->outer_angle * PI / 180.0f);
	float x = fminf(1.0f, fmaxf(0.0f, (cosine - outer) / fmaxf(inner - outer, 1e-9f)));
	return x * x * (3.0f - 2.0f * x);
}

/* A random direction or offset within the size of a lamp: a place in the ball. */
static void jitter(peer_random *random, float radius, float place[3])
{
	float z = 2.0f * peer_random_next(random) - 1.0f, turn = 2.0f * PI * peer_random_next(random);
	float r = sqrtf(fmaxf(0.0f, 1.0f - z * z));
	place[0] += radius * r * cosf(turn);
	place[1] += radius * r * sinf(turn);
	place[2] += radius * z;
}

static void add_near_lamp(const peer_discs *d, uint32_t surfel, const gw_light *light,
						  peer_random *random, float sum[3])
{
	float place[3], to[3], cosine, distance;
	for (int k = 0; k < 3; k++)
		place[k] = (float)(light->position[k] - d->surfels.origin[k]);
	if (light->radius > 0.0f)
		jitter(random, light->radius, place);
	if (!sees(d, surfel, place, &cosine, &distance, to))
		return;
	const float travel[3] = { -to[0], -to[1], -to[2] };
	float share = spot_share(light, travel) * cosine / (distance * distance);
	for (int k = 0; k < 3; k++)
		sum[k] += light->intensity[k] * share;
}

static void add_sun(const peer_discs *d, uint32_t surfel, const gw_light *light,
					peer_random *random, float sum[3])
{
	struct RTCIntersectContext context;
	float to[3], frame[6], length = 0.0f;
	for (int k = 0; k < 3; k++) {
		to[k] = -(float)light->direction[k];
		length += to[k] * to[k];
	}
	for (int k = 0; k < 3; k++)
		to[k] /= sqrtf(length);
	gw_tangent_frame(to, frame, frame + 3);
	float r = sqrtf(peer_random_next(random)) * tanf(light->angle * PI / 360.0f);
	float turn = 2.0f * PI * peer_random_next(random);
	for (int k = 0; k < 3; k++)
		to[k] += r * (cosf(turn) * frame[k] + sinf(turn) * frame[k + 3]);
	float cosine = dot(to, d->surfels.normal + 3 * (size_t)surfel);
	if (!(cosine > 0.0f))
		return;
	struct RTCRay ray = ray_from(d, surfel, to, INFINITY);
	rtcInitIntersectContext(&context);
	rtcOccluded1(d->scene, &context, &ray);
	for (int k = 0; k < 3 && ray.tfar >= 0.0f; k++)
		sum[k] += light->irradiance[k] * cosine;
}

void peer_add_lamps(const peer_discs *d, uint32_t surfel, peer_random *random, float sum[3])
{
	for (size_t i = 0; i < d->light_count; i++) {
		const gw_light *light = &d->lights[i];
		if (light->type == GW_LIGHT_SUN)
			add_sun(d, surfel, light, random, sum);
		else if (light->type != GW_LIGHT_ENVIRONMENT)
			add_near_lamp(d, surfel, light, random, sum);
	}
}

static uint32_t pick_emitter(const peer_discs *d, float u)
{
	size_t low = 0, high = d->emitter_count - 1;
	while (low < high) {
		size_t middle = (low + high) / 2;
		if (d->chance[middle] > u)
			high = middle;
		else
			low = middle + 1;
	}
	return d->emitter[low];
}

/* Each emitter stands for a round piece of its own area, so that together they cover what shines
 * once. */
void peer_add_emitter(const peer_discs *d, uint32_t surfel, const float drawn[3], float others,
					  float sum[3])
{
	if (d->emitter_count == 0)
		return;
	size_t e = pick_emitter(d, drawn[0]);
	const gw_surfels *s = &d->surfels;
	const float *n = s->normal + 3 * e;
	float r = sqrtf(drawn[1] * s->area[e] / PI), turn = 2.0f * PI * drawn[2];
	float x = r * cosf(turn), y = r * sinf(turn);
	float place[3], to[3], cosine, distance;
	for (size_t k = 0; k < 3; k++)
		place[k] = s->position[3 * e + k] + x * d->frame[6 * e + k] + y * d->frame[6 * e + 3 + k] +
				   PEER_OFFSET * s->spacing * n[k];
	if (e == surfel || !sees(d, surfel, place, &cosine, &distance, to))
		return;
	float leaving = -dot(to, n);
	if (!(leaving > 0.0f))
		return;
	float angular = d->density[e] * distance * distance / leaving;
	float share = cosine / (angular + others * cosine / PI);
	for (size_t k = 0; k < 3; k++)
		sum[k] += s->emission[3 * e + k] * share;
}

float peer_met_weight(const peer_discs *d, uint32_t from, uint32_t met, const float direction[3],
					  float distance, float others)
{
	float leaving = -dot(direction, d->surfels.normal + 3 * (size_t)met);
	float cosine = dot(direction, d->surfels.normal + 3 * (size_t)from);
	float angular = d->density[met] * distance * distance / fmaxf(leaving, 1e-6f);
	return others * cosine / PI / (angular + others * cosine / PI);
}
