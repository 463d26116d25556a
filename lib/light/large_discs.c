/*
 * large_discs.c - see large_discs.h.
 */
#include "light/large_discs.h"

#include "base/memory.h"
#include "base/parallel.h"
#include "base/shared_math.h"
#include "cloud/frame.h"
#include "light/transport_layout.h"
#include "normals/disc_tree.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Rays that look where discs are met: so many for a disc at most, of which one in eight or so finds
 * its own, and for all discs together. The surface's error falls as 1 / discs; where there would be
 * fewer than the least for a disc, it is less than a tenth of a thousandth. */
#define RAYS_A_DISC 64u
#define RAYS_LEAST 8u
#define RAYS_MOST 262144u

/* Radii over a disc from which they start. */
#define START 0.25f

#define CHUNK 64u

typedef struct search {
	const gw_lit_cloud *cloud;
	const gw_disc_tree *tree;
	const gw_disc *disc;
	gw_large_discs *found;
	uint32_t rays;
	uint8_t *met; /* rays * count: whether the ray finds its own disc */
} search;

/* The k-th of `rays` places on a disc, each for as much of it; by how much its bend turns the
 * normal there. */
static gw_vec3 place_on(const gw_disc *d, uint32_t k, uint32_t rays, gw_vec3 *turn)
{
	float tangent[3], bitangent[3], r = d->radius * sqrtf(((float)k + 0.5f) / (float)rays);
	float angle = (float)k * (float)(M_PI * (3.0 - sqrt(5.0)));
	float x = r * cosf(angle), y = r * sinf(angle);
	float along = d->bend[0] * x + d->bend[1] * y, across = d->bend[1] * x + d->bend[2] * y;
	const float normal[3] = { d->normal.x, d->normal.y, d->normal.z };
	gw_tangent_frame(normal, tangent, bitangent);
	gw_vec3 t = gw_xyz(tangent), b = gw_xyz(bitangent);
	*turn = gw_plus(gw_times(t, -along), gw_times(b, -across));
	gw_vec3 flat = gw_plus(gw_times(t, x), gw_times(b, y));
	gw_vec3 rise = gw_times(d->normal, 0.5f * (along * x + across * y));
	return gw_plus(d->place, gw_plus(flat, rise));
}

/* A ray that comes straight from in front, off a surface that faces the disc. */
static bool meets_own(const search *s, size_t disc, gw_vec3 place)
{
	const gw_disc *d = s->disc + disc;
	gw_vec3 down = gw_times(d->normal, -1.0f);
	gw_vec3 from = gw_plus(place, gw_times(d->normal, START * d->radius));
	gw_disc_ray ray = { from, down, down, from, 2.0f * START * d->radius, false };
	return gw_disc_tree_trace(s->tree, &ray).disc == (uint32_t)disc;
}

/* Is there finer surface on a disc? It takes precedence, and where it ends the tree does not say.
 */
static bool has_finer_on(const search *s, size_t surfel)
{
	const gw_surfels *surfels = s->cloud->surfels;
	size_t first = surfel > GW_ADJOIN_REACH ? surfel - GW_ADJOIN_REACH : 0;
	size_t last = surfel + GW_ADJOIN_REACH + 1;
	for (size_t j = first; j < last && j < surfels->count; j++)
		if (gw_surfels_adjoin(surfels, surfel, j) &&
			!gw_octree_disc_is_large(s->cloud->octree, surfels, j))
			return true;
	return false;
}

static void look_at(void *user, size_t first, size_t last, uint32_t worker)
{
	const search *s = user;
	gw_vec3 turn;
	(void)worker;
	for (size_t i = first; i < last; i++) {
		uint32_t surfel = s->found->surfel[i];
		bool lit = !s->cloud->lit || s->cloud->lit[surfel];
		uint32_t rays = !lit || has_finer_on(s, surfel) ? 0 : s->rays;
		for (uint32_t k = 0; k < rays; k++)
			s->met[i * s->rays + k] = meets_own(s, i, place_on(s->disc + i, k, s->rays, &turn));
	}
}

static gw_status keep_met(const search *s, gw_error *error)
{
	gw_large_discs *f = s->found;
	size_t places = 0;
	for (size_t i = 0; i < f->count * s->rays; i++)
		places += s->met[i];
	f->place = gw_allocate_array(places + 1, sizeof *f->place);
	f->turn = gw_allocate_array(places + 1, sizeof *f->turn);
	if (!f->place || !f->turn)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for places on %zu discs", f->count);
	uint32_t used = 0;
	for (size_t i = 0; i < f->count; i++) {
		f->first[i] = used;
		for (uint32_t k = 0; k < s->rays; k++)
			if (s->met[i * s->rays + k]) {
				f->place[used] = place_on(s->disc + i, k, s->rays, f->turn + used);
				used++;
			}
	}
	f->first[f->count] = used;
	return GW_OK;
}

static gw_status search_places(search *s, gw_disc *disc, gw_error *error)
{
	const gw_surfels *surfels = s->cloud->surfels;
	const gw_disc_shape shape = gw_octree_disc_shape(s->cloud->octree);
	gw_large_discs *f = s->found;
	f->surfel = gw_allocate_zeros(f->count, sizeof *f->surfel);
	f->first = gw_allocate_array(f->count + 1, sizeof *f->first);
	f->more = gw_allocate_zeros(f->count, 3 * sizeof *f->more);
	if (!f->surfel || !f->first || !f->more || !disc || !s->met)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu large discs", f->count);
	size_t used = 0;
	for (size_t i = 0; i < surfels->count && used < f->count; i++)
		if (gw_octree_disc_is_large(s->cloud->octree, surfels, i)) {
			f->surfel[used] = (uint32_t)i;
			disc[used++] = gw_disc_of_surfel(surfels, i, &shape);
		}
	s->disc = disc;
	gw_parallel_for(s->cloud->options->threads, f->count, CHUNK, look_at, s);
	return keep_met(s, error);
}

static gw_status find_in(const gw_lit_cloud *cloud, const gw_disc_tree *tree, gw_large_discs *discs,
						 gw_error *error)
{
	uint32_t rays = RAYS_MOST / tree->discs;
	search s = { .cloud = cloud, .tree = tree, .found = discs };
	s.rays = rays < RAYS_A_DISC ? rays : RAYS_A_DISC;
	discs->count = tree->discs;
	gw_disc *disc = gw_allocate_zeros(discs->count, sizeof *disc);
	s.met = gw_allocate_zeros(discs->count, s.rays);
	gw_status status = search_places(&s, disc, error);
	free(s.met);
	free(disc);
	if (status != GW_OK)
		gw_large_discs_clear(discs);
	return status;
}

gw_status gw_large_discs_find(const gw_lit_cloud *cloud, gw_large_discs *discs, gw_error *error)
{
	uint32_t count = cloud->octree->tree_discs;
	gw_view words = { 0 };
	*discs = (gw_large_discs){ 0 };
	if (count == 0 || cloud->octree->leaf_count == 0 || RAYS_MOST / count < RAYS_LEAST)
		return GW_OK;
	uint32_t nodes = cloud->octree->tree_nodes;
	gw_disc_tree tree = { .discs = count,
						  .nodes = nodes,
						  .texels = (size_t)gw_disc_tree_texels(count, nodes) };
	GW_TRY(gw_view_open(cloud->passes->gpu, &cloud->octree->disc_tree, 16 * (uint64_t)tree.texels,
						&words, error));
	/* The tree is only read. */
	memcpy(&tree.word, &words.bytes, sizeof tree.word);
	gw_status status = find_in(cloud, &tree, discs, error);
	gw_view_close(&words);
	return status;
}

void gw_large_discs_clear(gw_large_discs *discs)
{
	free(discs->surfel);
	free(discs->first);
	free(discs->place);
	free(discs->turn);
	free(discs->more);
	*discs = (gw_large_discs){ 0 };
}

/* ------------------------------------------------------------------------------------- lamps */

typedef struct lighting {
	const gw_lit_cloud *cloud;
	const gw_lamp *lamp;
	const float *normal, *visibility; /* of surfels */
	gw_large_discs *discs;
} lighting;

/* Mean of what the lamp sends to a disc's places, beyond what it sends to its centre. */
static float beyond_centre(const lighting *l, size_t disc, gw_vec3 centre, gw_vec3 normal)
{
	const gw_large_discs *d = l->discs;
	uint32_t first = d->first[disc], last = d->first[disc + 1];
	gw_vec3 towards;
	float distance, sum = 0.0f;
	for (uint32_t k = first; k < last; k++)
		sum += gw_lamp_received(l->lamp, d->place[k], gw_unit(gw_plus(normal, d->turn[k])),
								&towards, &distance);
	return sum / (float)(last - first) -
		   gw_lamp_received(l->lamp, centre, normal, &towards, &distance);
}

static void light_discs(void *user, size_t first, size_t last, uint32_t worker)
{
	const lighting *l = user;
	const gw_octree *o = l->cloud->octree;
	const gw_light_push *push = &l->lamp->push;
	(void)worker;
	for (size_t i = first; i < last; i++) {
		size_t surfel = l->discs->surfel[i];
		const float *normal = l->normal + 4 * surfel;
		float seen = push->shadows ? GW_SHARE_SEEN(l->visibility[surfel]) : 1.0f;
		bool dark = normal[0] == 0.0f && normal[1] == 0.0f && normal[2] == 0.0f;
		/* What is lit from both sides has no front that all of its places share. */
		if (dark || normal[3] > 0.5f || !(seen > 0.0f) ||
			l->discs->first[i] == l->discs->first[i + 1])
			continue;
		gw_vec3 low = gw_xyz(o->cube_minimum),
				at = gw_xyz(l->cloud->surfels->position + 3 * surfel);
		gw_vec3 centre = gw_times(gw_minus(at, low), 1 / o->leaf_size);
		float more = seen * beyond_centre(l, i, centre, gw_xyz(normal));
		l->discs->more[3 * i] += more * push->intensity.x;
		l->discs->more[3 * i + 1] += more * push->intensity.y;
		l->discs->more[3 * i + 2] += more * push->intensity.z;
	}
}

gw_status gw_large_discs_light(const gw_lit_cloud *cloud, const gw_lamp *lamp,
							   const gw_buffer *normal, const gw_buffer *visibility,
							   gw_large_discs *discs, gw_error *error)
{
	gw_gpu *gpu = cloud->passes->gpu;
	uint64_t count = cloud->surfels->count;
	gw_view normals = { 0 }, seen = { 0 };
	if (discs->count == 0)
		return GW_OK;
	gw_status status = gw_view_open(gpu, normal, 16 * count, &normals, error);
	if (status == GW_OK)
		status = gw_view_open(gpu, visibility, 4 * count, &seen, error);
	lighting l = { cloud, lamp, normals.bytes, seen.bytes, discs };
	if (status == GW_OK)
		gw_parallel_for(cloud->options->threads, discs->count, CHUNK, light_discs, &l);
	gw_view_close(&seen);
	gw_view_close(&normals);
	return status;
}

/* Adds what discs have beyond their centres; no less than nothing, whatever rounding says. */
static void add_more(const gw_large_discs *discs, float *irradiance)
{
	for (size_t i = 0; i < discs->count; i++)
		for (size_t c = 0; c < 3; c++) {
			float *e = irradiance + 4 * (size_t)discs->surfel[i] + c;
			*e = fmaxf(*e + discs->more[3 * i + c], 0.0f);
		}
}

gw_status gw_large_discs_mean(const gw_lit_cloud *cloud, const gw_large_discs *discs,
							  const gw_buffer *surfels, gw_buffer *means, gw_error *error)
{
	gw_gpu *gpu = cloud->passes->gpu;
	uint64_t bytes = 16 * (uint64_t)cloud->surfels->count;
	gw_view irradiance;
	gw_edit edit = { 0 };
	GW_TRY(gw_buffer_create_unset(gpu,
								  &(gw_buffer_description){ GW_BUFFER_TEXEL,
															VK_FORMAT_R32G32B32A32_SFLOAT, bytes,
															"mean irradiance of discs" },
								  means, error));
	gw_status status = gw_view_open(gpu, surfels, bytes, &irradiance, error);
	if (status == GW_OK)
		status = gw_buffer_upload(gpu, means, 0, irradiance.bytes, bytes, error);
	gw_view_close(&irradiance);
	if (status == GW_OK)
		status = gw_edit_open(gpu, means, &edit, error);
	if (status == GW_OK)
		add_more(discs, edit.bytes);
	if (status == GW_OK)
		status = gw_edit_close(gpu, &edit, true, error);
	if (status != GW_OK)
		gw_buffer_destroy(gpu, means);
	return status;
}
