/*
 * host_lookup.c - see host_lookup.h; what is done, and why, record_lookup.glsl says.
 */
#include "light/host_lookup.h"

#include "light/host_loop.h"
#include "light/host_trace.h"

#define CHUNK 512u /* points that a thread takes at a time */

/* What all points have in common. */
typedef struct lookup {
	gw_tracer tracer;
	gw_lookup_push push;
	float size; /* of a block, leaf cells */
	const uint32_t *level_directory, *block_first, *block_record;
	const float *position, *normal;          /* of records */
	const float *point_place, *point_normal; /* of lobes or surfels */
	const float *point_reach;                /* of all of them, or NULL */
	uint32_t *row_record;                    /* of those that are looked at */
	float *row_weight;
} lookup;

/* A point that looks for records, and the row of the heaviest that it has found. */
typedef struct seeker {
	const lookup *common;
	gw_vec3 g, normal;
	float reach;
	bool both_sides;
	uint32_t width, used; /* of its row */
	uint32_t *record;
	float *weight;
} seeker;

/* -------------------------------------------------------------------------------------- blocks */

/* Pointer plus one to the tile of a block's children: octree_tiles.glsl. */
static uint32_t find_tile(const lookup *l, const int32_t cell[3])
{
	uint32_t level = l->push.block_level, t = l->tracer.directory_level;
	t = level < t ? level : t;
	uint32_t c[3];
	for (int k = 0; k < 3; k++)
		c[k] = (uint32_t)cell[k] >> (level - t);
	uint32_t offset = ((1u << 3 * t) - 1) / 7;
	uint32_t pointer = l->level_directory[offset + c[0] + (c[1] << t) + (c[2] << 2 * t)];
	for (; t < level && pointer != 0; t++) {
		uint32_t shift = level - t - 1;
		uint32_t octant = ((uint32_t)cell[0] >> shift & 1) | ((uint32_t)cell[1] >> shift & 1) << 1 |
						  ((uint32_t)cell[2] >> shift & 1) << 2;
		pointer = l->tracer.node[8 * (size_t)(pointer - 1) + octant];
	}
	return pointer;
}

/* First and last of the records of a block; none where the octree has no such block, or all of it
 * is farther than `limit`. */
static void block_span(const seeker *s, const int32_t cell[3], float limit, uint32_t span[2])
{
	const lookup *l = s->common;
	const int32_t cells = 1 << l->push.block_level;
	const float g[3] = { s->g.x, s->g.y, s->g.z };
	float squared = 0.0f;
	span[0] = span[1] = 0;
	for (int k = 0; k < 3; k++) {
		float outside =
			gw_larger(fabsf(g[k] - ((float)cell[k] + 0.5f) * l->size) - 0.5f * l->size, 0.0f);
		squared += outside * outside;
		if (cell[k] < 0 || cell[k] >= cells)
			return;
	}
	if (squared >= limit * limit)
		return;
	uint32_t pointer = find_tile(l, cell);
	if (pointer == 0)
		return;
	const uint32_t *first = l->block_first + (pointer - 1 - l->push.tile_first);
	span[0] = first[0];
	span[1] = first[1];
}

/* What is done with the records of a block. */
typedef void visit(seeker *s, uint32_t first, uint32_t last);

/* Visits the blocks that `within` reaches into, x first, those that are not beyond `limit`. */
static void visit_blocks(seeker *s, float within, float limit, visit *look)
{
	const float size = s->common->size;
	const float g[3] = { s->g.x, s->g.y, s->g.z };
	int32_t low[3], high[3], cell[3];
	uint32_t span[2];
	for (int k = 0; k < 3; k++) {
		low[k] = (int32_t)floorf((g[k] - within) / size);
		high[k] = (int32_t)floorf((g[k] + within) / size);
	}
	for (cell[2] = low[2]; cell[2] <= high[2]; cell[2]++)
		for (cell[1] = low[1]; cell[1] <= high[1]; cell[1]++)
			for (cell[0] = low[0]; cell[0] <= high[0]; cell[0]++) {
				block_span(s, cell, limit, span);
				look(s, span[0], span[1]);
			}
}

/* ------------------------------------------------------------------------------------- records */

/* Puts a record into the row, in place of the lightest when it is full. */
static void use_record(seeker *s, uint32_t record, float weight)
{
	uint32_t at = s->used;
	if (at < s->width) {
		s->used++;
	} else {
		at = 0;
		for (uint32_t w = 1; w < s->width; w++)
			at = s->weight[w] < s->weight[at] ? w : at;
		if (s->weight[at] >= weight)
			return;
	}
	s->record[at] = record;
	s->weight[at] = weight;
}

static float record_weight(const seeker *s, gw_vec3 off, float squared, gw_vec3 facing)
{
	float alignment = gw_dot(s->normal, facing);
	if (s->both_sides)
		alignment = fabsf(alignment);
	squared /= s->reach * s->reach;
	float plane = fabsf(gw_dot(off, facing)) / (0.3f * s->reach);
	if (squared >= 1.0f || plane >= 1.0f || alignment < 0.7f)
		return 0.0f;
	float near = (1.0f - squared) * (1.0f - squared);
	float aligned = alignment * alignment;
	aligned *= aligned;
	return near * aligned * aligned * (1.0f - plane);
}

static bool is_visible(const seeker *s, const float *record, gw_vec3 facing)
{
	const lookup *l = s->common;
	gw_vec3 from = gw_plus(s->g, gw_times(s->normal, l->push.lift));
	gw_vec3 to = gw_minus(gw_plus(gw_xyz(record), gw_times(facing, l->push.lift)), from);
	float distance = sqrtf(gw_dot(to, to));
	if (l->push.visibility == 0 || distance < record[3] || distance < 1e-4f)
		return true;
	gw_ray ray = { .origin = from,
				   .direction = gw_times(to, 1.0f / distance),
				   .facing = s->normal,
				   .foot = s->g,
				   .t_max = distance,
				   .both_sides = true };
	return gw_trace(&l->tracer, &ray).lobe == GW_NONE;
}

static void weigh_block(seeker *s, uint32_t first, uint32_t last)
{
	const lookup *l = s->common;
	for (uint32_t r = first; r < last; r++) {
		uint32_t record = l->block_record[r];
		const float *position = l->position + 4 * (size_t)record;
		gw_vec3 off = gw_minus(s->g, gw_xyz(position));
		float squared = gw_dot(off, off);
		if (squared >= s->reach * s->reach)
			continue;
		gw_vec3 facing = gw_xyz(l->normal + 4 * (size_t)record);
		float weight = record_weight(s, off, squared, facing);
		if (weight > 0.0f && is_visible(s, position, facing))
			use_record(s, record, weight);
	}
}

/* The nearest record, by a cost that grows with the angle between the normals, is the row's first;
 * its weight is that cost. */
static void find_nearest(seeker *s, uint32_t first, uint32_t last)
{
	const lookup *l = s->common;
	for (uint32_t r = first; r < last; r++) {
		uint32_t record = l->block_record[r];
		gw_vec3 off = gw_minus(s->g, gw_xyz(l->position + 4 * (size_t)record));
		float cost = sqrtf(gw_dot(off, off)) *
					 (1.5f - gw_dot(s->normal, gw_xyz(l->normal + 4 * (size_t)record)));
		if (s->used == 0 ? cost < 1e30f : cost < s->weight[0]) {
			s->used = 1;
			s->record[0] = record;
			s->weight[0] = cost;
		}
	}
}

/* Fills the row, and makes its weights sum to 1. */
static void find_records(seeker *s)
{
	visit_blocks(s, s->reach, s->reach, weigh_block);
	if (s->used == 0) {
		visit_blocks(s, s->common->push.radius, 1e9f, find_nearest);
		if (s->used > 0)
			s->weight[0] = 1.0f;
	}
	float sum = 0.0f;
	for (uint32_t w = 0; w < s->used; w++)
		sum += s->weight[w];
	for (uint32_t w = 0; w < s->used; w++)
		s->weight[w] /= sum;
}

/* ------------------------------------------------------------------------------ lobes, surfels */

static seeker seeker_of(const lookup *l, size_t point, size_t row, uint32_t width)
{
	return (seeker){ .common = l,
					 .g = gw_xyz(l->point_place + 4 * point),
					 .normal = gw_xyz(l->point_normal + 4 * point),
					 .reach = l->push.own_reach ? l->point_reach[point] : l->push.radius,
					 .width = width,
					 .record = l->row_record + row * width,
					 .weight = l->row_weight + row * width };
}

static void weigh_lobes(void *user, size_t first, size_t last, uint32_t worker)
{
	const lookup *l = user;
	(void)worker;
	for (size_t slot = first; slot < last; slot++) {
		seeker s = seeker_of(l, slot, slot, GW_WEIGHTS);
		if (s.reach == 0.0f)
			continue; /* the row stays */
		memset(s.weight, 0, GW_WEIGHTS * sizeof *s.weight);
		memset(s.record, 0xff, GW_WEIGHTS * sizeof *s.record);
		if (l->point_place[4 * slot + 3] > 0.0f)
			find_records(&s);
	}
}

static void weigh_surfels(void *user, size_t first, size_t last, uint32_t worker)
{
	const lookup *l = user;
	(void)worker;
	for (size_t row = first; row < last; row++) {
		size_t surfel = l->push.surfel_first + row;
		seeker s = seeker_of(l, surfel, row, GW_SURFEL_WEIGHTS);
		s.both_sides = l->point_normal[4 * surfel + 3] > 0.5f;
		if (s.reach > 0.0f)
			find_records(&s);
		if (s.used < GW_SURFEL_WEIGHTS)
			s.record[s.used] = GW_NONE;
	}
}

static lookup lookup_of(const gw_passes *passes, const gw_octree *octree, const gw_records *records,
						const gw_buffer *reach, const gw_lookup_push *push)
{
	return (lookup){ .tracer = gw_tracer_of(passes, octree),
					 .push = *push,
					 .size = exp2f((float)(octree->depth - push->block_level)),
					 .level_directory = octree->level_directory.mapped,
					 .block_first = records->block_first.mapped,
					 .block_record = records->block_record.mapped,
					 .position = records->position.mapped,
					 .normal = records->normal.mapped,
					 .point_reach = reach ? reach->mapped : NULL };
}

void gw_host_weigh_lobes(gw_passes *passes, const gw_octree *octree, gw_records *records,
						 const gw_buffer *reach, const gw_lookup_push *push)
{
	lookup l = lookup_of(passes, octree, records, reach, push);
	l.point_place = octree->lobe_centre.mapped;
	l.point_normal = octree->lobe_plane.mapped;
	l.row_record = records->lobe_record.mapped;
	l.row_weight = records->lobe_weight.mapped;
	gw_host_loop(passes, GW_PASS_LOBE_WEIGHTS, 2 * (size_t)octree->leaf_count, CHUNK, weigh_lobes,
				 &l);
}

void gw_host_weigh_surfels(gw_passes *passes, const gw_octree *octree, const gw_records *records,
						   const gw_buffer *reach, const gw_lookup_push *push, size_t count,
						   gw_buffer *record, gw_buffer *weight)
{
	lookup l = lookup_of(passes, octree, records, reach, push);
	l.point_place = octree->surfel_position.mapped;
	l.point_normal = octree->surfel_normal.mapped;
	l.row_record = record->mapped;
	l.row_weight = weight->mapped;
	gw_host_loop(passes, GW_PASS_READ_BACK, count, CHUNK, weigh_surfels, &l);
}
