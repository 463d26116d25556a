/*
 * transport.c - see transport.h.
 */
#include "bake/transport.h"
#include "glowworm_host.h"
#include "bake/lighting_error.h"
#include "bake/plan.h"
#include "bake/scene_records.h"

#include "light/direct_light.h"
#include "base/hash.h"
#include "normals/disc_tree.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "bake/transport_blocks.h"
#include "bake/record_steps.h"
#include "light/transport_layout.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#define MAGIC "glowworm transport\n"
#define VERSION 29u

/* Blocks are read and checked in chunks, by all threads. */
#define CHUNK_BYTES (UINT64_C(1) << 20)

/* Settings that change what a transport holds. */
typedef struct fixed_settings {
	double method, depth, leaf_spacing, rays, record_spacing, least_records, seed, normals, noise;
	double probe_size;
} fixed_settings;

typedef struct head {
	char magic[24];
	uint32_t version, head_bytes;
	uint64_t length; /* of the whole */
	gw_transport_identity identity;
	fixed_settings settings;
	gw_transport_numbers numbers;
	uint64_t note;
	uint64_t hash; /* of what stands before it */
} head;

_Static_assert(sizeof(head) % 8 == 0, "blocks begin at multiples of 8 bytes");

static bool lowest_byte_first(void)
{
	const uint16_t one = 1;
	return *(const unsigned char *)&one == 1;
}

static uint64_t hash_array(const void *values, size_t count, size_t size)
{
	return values ? gw_hash(1, values, count * size) : 0;
}

gw_transport_identity gw_transport_identify(const gw_points *p)
{
	uint64_t scanner = hash_array(p->scanner, p->scanner_count, 3 * sizeof *p->scanner);
	for (size_t i = 0; i < p->image_count; i++) {
		const gw_range_image *image = &p->image[i];
		const uint64_t size[4] = { image->first, image->count, image->columns, image->rows };
		scanner = gw_hash(scanner, size, sizeof size);
		scanner = gw_hash(scanner, image->scanner, sizeof image->scanner);
	}
	scanner ^= hash_array(p->image_count ? p->image_cell : NULL, p->count, sizeof *p->image_cell);
	return (gw_transport_identity){
		.position = hash_array(p->position, p->count, 3 * sizeof *p->position) ^
					hash_array(p->instance_count ? p->instance : NULL, p->instance_count,
							   sizeof *p->instance),
		.normal = hash_array(p->normal, p->count, 3 * sizeof *p->normal) ^ p->normal_sideless,
		.albedo = hash_array(p->albedo, p->count, 3 * sizeof *p->albedo),
		.opacity = hash_array(p->opacity, p->count, sizeof *p->opacity),
		.scanner = scanner ^ hash_array(p->scanner_of, p->count, sizeof *p->scanner_of),
		.stray = p->keep_strays ? 1 : hash_array(p->stray, p->count, 1),
		.emission = hash_array(p->emission, p->count, 3 * sizeof *p->emission),
		.area = hash_array(p->own_area, p->count, sizeof *p->own_area) ^
				3 * hash_array(p->beam_share, p->count, sizeof *p->beam_share),
	};
}

static fixed_settings settle(const gw_bake_options *o)
{
	return (fixed_settings){
		.method = o->method,
		.depth = o->depth,
		.leaf_spacing = o->depth == GW_DEPTH_AUTO ? (double)o->leaf_spacing : 0.0,
		.rays = gw_method_keeps_hits(o->method) ? o->rays : 0,
		.probe_size = o->method == GW_METHOD_PROBES ? o->probe_size : 0,
		.record_spacing = (double)o->record_spacing,
		.least_records = o->least_records,
		.seed = (double)o->seed,
		.normals = o->normals,
		.noise = (o->effects_forced | o->effects_forbidden << 1) >> GW_EFFECT_NOISE & 3u
	};
}

/* To where the next part begins. */
static uint64_t padded(uint64_t bytes)
{
	return (bytes + GW_LENT_ALIGNMENT - 1) / GW_LENT_ALIGNMENT * GW_LENT_ALIGNMENT;
}

static uint64_t length_of(const gw_transport_block *blocks, size_t count)
{
	uint64_t length = padded(sizeof(head)) + sizeof(uint64_t);
	for (size_t i = 0; i < count; i++)
		length += padded(blocks[i].bytes);
	return length;
}

static uint64_t chunk_count(const gw_transport_block *block)
{
	return (block->bytes + CHUNK_BYTES - 1) / CHUNK_BYTES;
}

/* ------------------------------------------------------------------------------------ saving */

static void hash_chunks(const gw_transport_block *block, const unsigned char *bytes, uint64_t *hash)
{
	for (uint64_t at = 0; at < block->bytes; at += CHUNK_BYTES) {
		uint64_t left = block->bytes - at;
		uint64_t chunk = gw_hash(0, bytes + at, left < CHUNK_BYTES ? left : CHUNK_BYTES);
		*hash = gw_hash(*hash, &chunk, sizeof chunk);
	}
}

/* Writes the zeros after so many bytes. */
static gw_status pad(const gw_transport *transport, uint64_t bytes, gw_error *error)
{
	static const char zeros[GW_LENT_ALIGNMENT];
	return transport->write(transport->user, zeros, (size_t)(padded(bytes) - bytes), error);
}

static gw_status write_block(gw_scene *scene, const gw_transport_block *block,
							 const gw_transport *transport, uint64_t *hash, gw_error *error)
{
	gw_view view = { 0 };
	const void *bytes = block->host ? *block->host : NULL;
	gw_status status = GW_OK;
	if (block->buffer) {
		status = gw_view_open(scene->gpu, block->buffer, block->bytes, &view, error);
		bytes = view.bytes;
	}
	if (status == GW_OK) {
		hash_chunks(block, bytes, hash);
		status = transport->write(transport->user, bytes, block->bytes, error);
	}
	if (status == GW_OK)
		status = pad(transport, block->bytes, error);
	gw_view_close(&view);
	return status;
}

static gw_status write_scene(gw_scene *scene, const gw_transport_identity *points,
							 const gw_transport *transport, gw_error *error)
{
	gw_transport_block blocks[GW_TRANSPORT_BLOCKS];
	uint64_t hash = 0;
	head h;
	if (!lowest_byte_first())
		return gw_fail(
			error, GW_ERROR_USAGE,
			"a transport cannot be kept on a machine that stores the highest byte first");
	memset(&h, 0, sizeof h);
	memcpy(h.magic, MAGIC, sizeof MAGIC);
	h.version = VERSION;
	h.head_bytes = sizeof h;
	h.identity = *points;
	h.settings = settle(&scene->options);
	h.numbers = gw_transport_numbers_of(scene);
	size_t count = gw_transport_list(scene, &h.numbers, blocks);
	h.length = length_of(blocks, count);
	h.note = transport->note;
	h.hash = gw_hash(0, &h, offsetof(head, hash));
	GW_TRY(transport->write(transport->user, &h, sizeof h, error));
	GW_TRY(pad(transport, sizeof h, error));
	for (size_t i = 0; i < count; i++)
		GW_TRY(write_block(scene, &blocks[i], transport, &hash, error));
	return transport->write(transport->user, &hash, sizeof hash, error);
}

gw_status gw_transport_save(gw_lighting *lighting, const gw_transport_identity *points,
							const gw_transport *transport, gw_error *error)
{
	/* Whatever shone this time, a sky may the next time. */
	gw_scene *scene = lighting->scene;
	gw_method method = scene->options.method;
	if (gw_method_keeps_hits(method) || method == GW_METHOD_BUFFERS)
		GW_TRY(gw_scene_open_to_sky(scene, error));
	GW_TRY(gw_lighting_foresee(lighting, error));
	return write_scene(scene, points, transport, error);
}

/* ----------------------------------------------------------------------------------- loading */

static gw_status damaged(const gw_transport *t, const char *what, gw_error *error)
{
	return gw_fail(error, GW_ERROR_DATA, "%s: %s; save it again", t->name, what);
}

static gw_status read_head(const gw_transport *t, head *h, gw_error *error)
{
	if (!lowest_byte_first())
		return gw_fail(error, GW_ERROR_USAGE,
					   "%s: a transport cannot be used on a machine that stores the highest byte "
					   "first",
					   t->name);
	if (t->length < sizeof *h || memcmp(t->data, MAGIC, sizeof MAGIC) != 0)
		return damaged(t, "this is no transport of a bake", error);
	memcpy(h, t->data, sizeof *h);
	if (h->version != VERSION || h->head_bytes != sizeof *h)
		return damaged(t, "this transport was written by another version of glowworm", error);
	if (h->hash != gw_hash(0, h, offsetof(head, hash)) || !gw_transport_numbers_fit(&h->numbers))
		return damaged(t, "this transport is damaged at its start", error);
	return GW_OK;
}

gw_status gw_transport_note(const gw_transport *transport, uint64_t *note, gw_error *error)
{
	head h;
	*note = 0;
	GW_TRY(read_head(transport, &h, error));
	*note = h.note;
	return GW_OK;
}

static gw_status check_points(const gw_transport *t, const head *h,
							  const gw_transport_identity *own, const gw_points *points,
							  gw_error *error)
{
	const gw_transport_identity *kept = &h->identity;
	const char *what = h->numbers.points != points->count ? "another number of points"
					   : kept->position != own->position  ? "other positions"
					   : kept->normal != own->normal      ? "other normals"
					   : kept->albedo != own->albedo      ? "other albedo"
					   : kept->opacity != own->opacity    ? "other opacities"
					   : kept->scanner != own->scanner    ? "other places of scanners"
					   : kept->stray != own->stray        ? "other strays"
					   : kept->area != own->area          ? "other areas or shares of pulses"
														  : NULL;
	if (what == NULL)
		return GW_OK;
	return gw_fail(error, GW_ERROR_DATA,
				   "%s: this transport belongs to a cloud with %s; save one of this cloud", t->name,
				   what);
}

static gw_status check_settings(const gw_transport *t, const head *h, const gw_bake_options *o,
								gw_error *error)
{
	const fixed_settings own = settle(o), *kept = &h->settings;
	const struct {
		const char *name;
		double kept, own;
	} rows[] = {
		{ "depth", kept->depth, own.depth },
		{ "leaf spacing", kept->leaf_spacing, own.leaf_spacing },
		{ "number of rays", kept->rays, own.rays },
		{ "record spacing", kept->record_spacing, own.record_spacing },
		{ "least number of records", kept->least_records, own.least_records },
		{ "size of probes' maps", kept->probe_size, own.probe_size },
		{ "seed", kept->seed, own.seed },
		{ "choice of normals", kept->normals, own.normals },
		{ "choice of noise", kept->noise, own.noise },
	};
	if (kept->method != own.method)
		return gw_fail(error, GW_ERROR_USAGE,
					   "%s: this transport was made with another method than this bake has",
					   t->name);
	for (size_t i = 0; i < sizeof rows / sizeof *rows; i++)
		if (rows[i].kept != rows[i].own)
			return gw_fail(
				error, GW_ERROR_USAGE,
				"%s: the %s of this transport is %s and that of this bake %s; they have to be "
				"the same (0 stands for auto)",
				t->name, rows[i].name, GW_SAID(rows[i].kept, 15), GW_SAID(rows[i].own, 15));
	if (o->voxels && !gw_transport_has_voxels(&h->numbers))
		return gw_fail(error, GW_ERROR_USAGE,
					   "%s: this transport was saved by a bake without grids of voxels, and holds "
					   "none; save one by a bake that writes them, too",
					   t->name);
	return GW_OK;
}

/* Parts are filled up with zeros. */
static bool padding_fits(uint64_t length, const unsigned char *bytes)
{
	for (uint64_t at = length; at < padded(length); at++)
		if (bytes[at] != 0)
			return false;
	return true;
}

/* A block on its way into the scene. */
typedef struct arrival {
	const gw_transport_block *block;
	const unsigned char *from;
	unsigned char *to; /* NULL: it stays, or is uploaded when it is known to be good */
	bool lent;
	size_t first_chunk;
} arrival;

/* All of them, chunk by chunk. */
typedef struct arrivals {
	arrival arrival[GW_TRANSPORT_BLOCKS];
	size_t count, chunks;
	uint64_t *hash; /* a chunk */
	atomic_bool damaged;
} arrivals;

static bool indices_fit(const gw_transport_block *block, const unsigned char *bytes,
						uint64_t length)
{
	uint32_t word;
	for (uint64_t at = 0; block->limit > 0 && at < length; at += 4 * (uint64_t)block->step) {
		memcpy(&word, bytes + at, sizeof word);
		if ((word & block->mask) >= block->limit && (block->all || word != GW_NONE))
			return false;
	}
	return true;
}

static void take_chunk(void *user, size_t first, size_t last, uint32_t worker)
{
	arrivals *all = user;
	size_t block = 0;
	(void)worker;
	for (size_t chunk = first; chunk < last; chunk++) {
		while (block + 1 < all->count && all->arrival[block + 1].first_chunk <= chunk)
			block++;
		const arrival *a = &all->arrival[block];
		uint64_t at = (chunk - a->first_chunk) * CHUNK_BYTES, left = a->block->bytes - at;
		size_t length = (size_t)(left < CHUNK_BYTES ? left : CHUNK_BYTES);
		all->hash[chunk] = gw_hash(0, a->from + at, length);
		if (!indices_fit(a->block, a->from + at, length))
			atomic_store(&all->damaged, true);
		if (a->to)
			memcpy(a->to + at, a->from + at, length);
	}
}

/* Room for a block, and where it is if it can be reached from here. */
static gw_status make_room(gw_scene *scene, arrival *a, gw_error *error)
{
	const gw_transport_block *block = a->block;
	gw_status status = GW_OK;
	if (block->stays && scene->surfels.lent) {
		*block->host = (void *)(uintptr_t)a->from;
	} else if (block->host) {
		a->to = *block->host = gw_allocate_array(block->bytes, 1);
		if (!a->to)
			return gw_fail(error, GW_ERROR_MEMORY, "no memory for the %s", block->name);
	} else if (gw_buffer_may_borrow(scene->gpu, a->from) && block->bytes > 0) {
		a->lent = true;
		status = gw_buffer_borrow(
			scene->gpu,
			&(gw_buffer_description){ GW_BUFFER_TEXEL, block->format, block->bytes, block->name },
			a->from, scene->options.transport->fleeting, block->buffer, error);
	} else {
		status = gw_buffer_create_unset(
			scene->gpu,
			&(gw_buffer_description){ GW_BUFFER_TEXEL, block->format, block->bytes, block->name },
			block->buffer, error);
		a->to = gw_gpu_shares_memory(scene->gpu) ? block->buffer->mapped : NULL;
	}
	return status;
}

/* Checks all blocks and brings them into the scene. */
static gw_status take_blocks(gw_scene *scene, const gw_transport *t, arrivals *all, gw_error *error)
{
	gw_status status = GW_OK;
	uint64_t hash = 0, kept;
	all->hash = gw_allocate_array(all->chunks, sizeof *all->hash);
	if (!all->hash)
		status = gw_fail(error, GW_ERROR_MEMORY, "no memory to check %zu chunks", all->chunks);
	for (size_t i = 0; i < all->count && status == GW_OK; i++)
		status = make_room(scene, &all->arrival[i], error);
	if (status == GW_OK) {
		gw_parallel_for(scene->options.threads, all->chunks, 1, take_chunk, all);
		for (size_t i = 0; i < all->chunks; i++)
			hash = gw_hash(hash, &all->hash[i], sizeof hash);
		memcpy(&kept, (const char *)t->data + t->length - sizeof kept, sizeof kept);
		if (hash != kept || atomic_load(&all->damaged))
			status = damaged(t, "this transport is damaged", error);
	}
	for (size_t i = 0; i < all->count && status == GW_OK; i++) {
		const arrival *a = &all->arrival[i];
		if (!a->to && !a->lent && !a->block->host)
			status =
				gw_buffer_upload(scene->gpu, a->block->buffer, 0, a->from, a->block->bytes, error);
	}
	free(all->hash);
	return status;
}

/* What has come for a buffer of words. */
static const uint32_t *words_of(const arrivals *all, const gw_buffer *buffer)
{
	const arrival *a = all->arrival;
	while (a->block->buffer != buffer)
		a++;
	return (const uint32_t *)a->from;
}

/* What bounds of single indices do not say: facets have their numbers, and a walk through the tree
 * of large discs ends. */
static bool octree_fits(const gw_scene *scene, const arrivals *all)
{
	const gw_octree *o = &scene->octree;
	return gw_octree_numbers_fit(o, words_of(all, &o->facet_leaf), words_of(all, &o->leaf_tile)) &&
		   gw_disc_tree_fits(words_of(all, &o->disc_tree), o->tree_discs, o->tree_nodes,
							 o->facet_count);
}

/* And rows follow each other, and strays are points. */
static bool rows_fit(const gw_scene *scene, const gw_transport_numbers *n)
{
	const gw_read_back *b = &scene->read_back;
	const gw_surfels *s = &scene->surfels;
	for (size_t i = 0; i < s->stray_count; i++)
		if (s->stray[i].point >= s->point_count || s->stray[i].kind >= GW_STRAY_KIND_COUNT ||
			(s->stray[i].surfel >= s->count && s->stray[i].surfel != UINT32_MAX))
			return false;
	if (b->first[0] != 0 || b->first[b->count] != n->entries)
		return false;
	for (size_t i = 0; i < b->count; i++)
		if (b->first[i] > b->first[i + 1])
			return false;
	for (size_t i = 0; i < n->entries; i++)
		if (b->record[i] >= n->records)
			return false;
	return true;
}

/* Spacings of records are such as refining makes. */
static bool are_spacings(const gw_scene *scene, const float *spacing, size_t count)
{
	float most = scene->records.spacing, least = fminf(most, GW_RECORD_SPACING_LEAST);
	for (size_t i = 0; spacing && i < count; i++)
		if (!(spacing[i] >= least && spacing[i] <= most))
			return false;
	return true;
}

static bool density_fits(const gw_scene *scene)
{
	const gw_record_density *d = &scene->density;
	return are_spacings(scene, d->facet_spacing, scene->octree.facet_count) &&
		   are_spacings(scene, d->surfel_spacing, scene->surfels.count);
}

/* Arrays of the host are used where they lie, if the widest of their elements may lie there. */
static void lend_arrays(gw_scene *scene, const gw_transport *t)
{
	if ((uintptr_t)t->data % _Alignof(gw_check_node) != 0)
		return;
	scene->surfels.lent = t->data;
	scene->surfels.lent_bytes = t->length;
	scene->read_back.lent = scene->check_tree.lent = true;
}

static gw_status read_blocks(gw_scene *scene, const gw_transport *t, const head *h, gw_error *error)
{
	gw_transport_block blocks[GW_TRANSPORT_BLOCKS];
	gw_transport_numbers_restore(&h->numbers, scene);
	GW_TRY(gw_compartments_restore(&h->numbers.compartments, &scene->octree, error));
	size_t count = gw_transport_list(scene, &h->numbers, blocks);
	if (h->length != length_of(blocks, count) || t->length != h->length)
		return damaged(t,
					   t->length < h->length ? "this transport ends too early"
											 : "this transport has another length than it says",
					   error);
	lend_arrays(scene, t);
	arrivals all = { .count = count };
	const unsigned char *at = t->data;
	bool fits = padding_fits(sizeof *h, at);
	at += padded(sizeof *h);
	for (size_t i = 0; i < count; i++) {
		fits = fits && padding_fits(blocks[i].bytes, at);
		all.arrival[i] = (arrival){ .block = &blocks[i], .from = at, .first_chunk = all.chunks };
		all.chunks += chunk_count(&blocks[i]);
		at += padded(blocks[i].bytes);
	}
	if (!fits)
		return damaged(t, "this transport is damaged", error);
	GW_TRY(take_blocks(scene, t, &all, error));
	GW_TRY(gw_compartments_fit(&scene->octree, &fits, error));
	if (!fits || !octree_fits(scene, &all) || !rows_fit(scene, &h->numbers) ||
		!density_fits(scene) || !gw_placed_probes_fit(&scene->probes) ||
		!gw_space_fits(&scene->space) ||
		!gw_check_tree_fits(&scene->check_tree, scene->surfels.count))
		return damaged(t, "this transport is damaged", error);
	return GW_OK;
}

gw_status gw_transport_load(gw_scene *scene, const gw_points *points, const gw_transport *transport,
							gw_error *error)
{
	head h;
	GW_TRY(read_head(transport, &h, error));
	const gw_transport_identity own = gw_transport_identify(points);
	GW_TRY(check_points(transport, &h, &own, points, error));
	GW_TRY(check_settings(transport, &h, &scene->options, error));
	GW_TRY(read_blocks(scene, transport, &h, error));
	gw_octree_passes(&scene->passes, scene->gpu, &scene->octree);
	scene->passes.threads = scene->options.threads;
	if (h.numbers.light_samples != scene->options.light_samples) {
		gw_buffer_destroy(scene->gpu, &scene->sampled);
		gw_buffer_destroy(scene->gpu, &scene->sampled_moment);
	}
	bool alone = gw_scene_emission_is_alone(scene), other = alone != scene->surfels.emission_alone;
	scene->surfels.emission_alone = alone;
	if (own.emission != h.identity.emission || (other && scene->surfels.emission))
		GW_TRY(gw_scene_replace_emission(scene, points->emission, points->count, error));
	return gw_scene_complete(scene, points, error);
}
