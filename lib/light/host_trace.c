/*
 * host_trace.c - see host_trace.h. What is done, and why, octree_trace.glsl and octree_discs.glsl
 * say.
 */
#include "light/host_trace.h"

#include "octree/trace_constants.h"
#include "light/transport_layout.h"

gw_tracer gw_tracer_of(const gw_passes *passes, const gw_octree *octree)
{
	float side = exp2f((float)octree->depth);
	return (gw_tracer){ .depth = octree->depth,
						.directory_level = octree->directory_level,
						.slack = gw_float_of(passes->constant[2]),
						.side = side,
						.nudge = 1e-5f + side * 4e-7f,
						.ray_directory = octree->ray_directory.mapped,
						.node = octree->node.mapped,
						.leaf_tile = octree->leaf_tile.mapped,
						.leaf_fragment = octree->leaf_fragment.mapped,
						.fragment_surfel = octree->fragment_surfel.mapped,
						.lobe_plane = octree->lobe_plane.mapped,
						.lobe_centre = octree->lobe_centre.mapped,
						.place = octree->surfel_position.mapped,
						.facing = octree->surfel_normal.mapped,
						.disc = octree->surfel_disc.mapped,
						.clip = octree->surfel_clip.mapped,
						.large = { .discs = octree->tree_discs,
								   .nodes = octree->tree_discs ? 2 * octree->tree_discs - 1 : 0,
								   .word = octree->disc_tree.mapped } };
}

typedef float float_lanes __attribute__((vector_size(16)));
typedef int32_t int_lanes __attribute__((vector_size(16)));

/* --------------------------------------------------------------------------------------- discs */

/* Share of a disc that a cut leaves. */
static float share_left(float x, float y, float distance)
{
	if (!(x * x + y * y > 0.0f))
		return 1.0f;
	float u = gw_smaller(gw_larger(distance, -1.0f), 1.0f);
	return 1.0f - (acosf(u) - u * sqrtf(1.0f - u * u)) / GW_PI;
}

static float disc_density(const float *size, const float *clip)
{
	float left = share_left(size[2], size[3], clip[0] / size[0]) +
				 share_left(clip[1], clip[2], clip[3] / size[0]) - 1.0f;
	return size[1] / (GW_PI * size[0] * size[0] * gw_larger(left, GW_SHARE_LEAST));
}

/* What a disc says about a place: its vote, and how much it adds to the cover; 0 where it does not
 * reach. */
static int disc_vote(const gw_tracer *tracer, size_t surfel, gw_vec3 at, float *cover)
{
	const float *size = tracer->disc + 4 * surfel, *clip = tracer->clip + 4 * surfel;
	gw_vec3 off = gw_minus(at, gw_xyz(tracer->place + 4 * surfel));
	gw_vec3 normal = gw_xyz(tracer->facing + 4 * surfel), t, b;
	off = gw_minus(off, gw_times(normal, gw_dot(normal, off)));
	float radius = size[0] + GW_DISC_SLACK;
	if (gw_dot(off, off) > radius * radius)
		return 0;
	gw_frame_of(normal, &t, &b);
	float x = gw_dot(t, off), y = gw_dot(b, off);
	if (gw_larger(size[2] * x + size[3] * y - clip[0], clip[1] * x + clip[2] * y - clip[3]) >
		GW_DISC_SLACK)
		return -1;
	*cover += disc_density(size, clip);
	return 2;
}

/* Do the lobe's discs lie all around a place? */
static bool is_surrounded(const gw_tracer *tracer, uint32_t slot, gw_vec3 at)
{
	static const float way[4][2] = { { 1.0f, 0.0f },
									 { GW_SQRT_HALF, GW_SQRT_HALF },
									 { 0.0f, 1.0f },
									 { -GW_SQRT_HALF, GW_SQRT_HALF } };
	uint32_t seen = 0, last = tracer->leaf_fragment[(slot >> 1) + 1];
	gw_vec3 t, b;
	gw_frame_of(gw_xyz(tracer->lobe_plane + 4 * (size_t)slot), &t, &b);
	for (uint32_t f = tracer->leaf_fragment[slot >> 1]; f < last; f++) {
		uint32_t word = tracer->fragment_surfel[f];
		if (word >> 31 != 0 || (word >> 30 & 1) != (slot & 1))
			continue;
		gw_vec3 off = gw_minus(gw_xyz(tracer->place + 4 * (size_t)(word & 0x3fffffffu)), at);
		float x = gw_dot(off, t), y = gw_dot(off, b);
		for (int d = 0; d < 4; d++) {
			float along = way[d][0] * x + way[d][1] * y;
			seen |= along > 0.0f ? 1u << d : along < 0.0f ? 16u << d : 0u;
		}
	}
	return __builtin_popcount(seen) >= GW_SEEN_AROUND;
}

/* Do the lobe's discs lie on both sides of a place, along its crease with a surface of a normal?
 * At the free end of a wall they lie on one. */
static bool is_along_crease(const gw_tracer *tracer, uint32_t slot, gw_vec3 other, gw_vec3 at)
{
	gw_vec3 own = gw_xyz(tracer->lobe_plane + 4 * (size_t)slot);
	gw_vec3 crease = { own.y * other.z - own.z * other.y, own.z * other.x - own.x * other.z,
					   own.x * other.y - own.y * other.x };
	uint32_t last = tracer->leaf_fragment[(slot >> 1) + 1];
	bool before = false, after = false;
	for (uint32_t f = tracer->leaf_fragment[slot >> 1]; f < last; f++) {
		uint32_t word = tracer->fragment_surfel[f];
		if (word >> 31 != 0 || (word >> 30 & 1) != (slot & 1))
			continue;
		gw_vec3 off = gw_minus(gw_xyz(tracer->place + 4 * (size_t)(word & 0x3fffffffu)), at);
		float along = gw_dot(crease, off);
		before |= along < 0.0f;
		after |= along > 0.0f;
	}
	return before && after;
}

static bool is_covered(const gw_tracer *tracer, uint32_t slot, gw_vec3 at)
{
	uint32_t first = tracer->leaf_fragment[slot >> 1],
			 last = tracer->leaf_fragment[(slot >> 1) + 1];
	if (last - first > GW_DISC_FRAGMENTS)
		return true;
	int votes = 0;
	float cover = 0.0f;
	bool cut = false;
	for (uint32_t f = first; f < last; f++) {
		uint32_t word = tracer->fragment_surfel[f];
		if (word >> 31 != 0 || (word >> 30 & 1) != (slot & 1))
			continue;
		int vote = disc_vote(tracer, word & 0x3fffffffu, at, &cover);
		votes += vote;
		cut |= vote < 0;
	}
	return (votes > 0 && cover > GW_COVER_LEAST) || (!cut && is_surrounded(tracer, slot, at));
}

/* -------------------------------------------------------------------------------------- planes */

/* A lobe as a ray passes it: at a distance t it is approach * t - rise above the plane. */
typedef struct passage {
	uint32_t lobe; /* slot, or GW_NONE */
	gw_vec3 normal;
	float approach, rise;
	float leave; /* distance at which the ray leaves the lobe's cell */
} passage;

/* A ray's way through a cell. */
typedef struct stretch {
	gw_vec3 centre;
	float enter, leave; /* distances */
	bool covered;       /* its lobes end nowhere in it */
	bool concave;       /* they meet as a floor and a wall do, seen from inside */
} stretch;

static float height_over(const passage *lobe, float t)
{
	return lobe->approach * t - lobe->rise;
}

static bool holds(const gw_tracer *tracer, const gw_ray *ray, const stretch *in, uint32_t slot,
				  float t)
{
	if (!ray->discs || in->covered)
		return true;
	gw_vec3 at = gw_plus(ray->origin, gw_times(ray->direction, t));
	gw_vec3 other = gw_xyz(tracer->lobe_plane + 4 * (size_t)(slot ^ 1));
	return (in->concave && is_along_crease(tracer, slot, other, at)) ||
		   is_covered(tracer, slot, at);
}

/* Does a lobe rise over the surface that the ray leaves? */
static bool rises_over_start(const gw_tracer *tracer, const gw_ray *ray, const passage *own,
							 float like_least)
{
	gw_vec3 middle = gw_xyz(tracer->lobe_centre + 4 * (size_t)own->lobe);
	float height = gw_dot(ray->facing, middle) - gw_dot(ray->facing, ray->foot);
	return height >= GW_NEAR_HEIGHT * gw_larger(like_least, GW_LIKE_LEAST);
}

/* Does the ray meet a lobe's plane in or near its cell, nearer than what it has hit? */
static bool meets_plane(const gw_tracer *tracer, const gw_ray *ray, const stretch *in,
						const passage *own, gw_ray_hit *hit)
{
	if (fabsf(own->approach) < 1e-6f)
		return false;
	float distance = own->rise / own->approach;
	if (distance < 0.0f || distance >= hit->t)
		return false;
	gw_vec3 at = gw_plus(ray->origin, gw_times(ray->direction, distance));
	gw_vec3 off = gw_minus(at, in->centre);
	float beyond = gw_larger(fabsf(off.x), gw_larger(fabsf(off.y), fabsf(off.z))) - 0.5f;
	float slack = !ray->discs            ? tracer->slack
				  : own->approach < 0.0f ? GW_FRONT_SLACK
										 : GW_BACK_SLACK;
	if (beyond > slack)
		return false;
	if (distance < GW_NEAR &&
		(own->approach > 0.0f ||
		 !rises_over_start(tracer, ray, own, gw_dot(own->normal, ray->facing))))
		return false;
	if (own->approach > 0.0f) {
		hit->behind = true;
		if (!ray->both_sides)
			return false;
	}
	stretch there = *in;
	there.covered &= beyond <= GW_BACK_SLACK;
	if (!holds(tracer, ray, &there, own->lobe, distance))
		return false;
	hit->t = distance;
	return true;
}

/* Is the ray behind the lobe where it enters its cell, though nothing stopped it? */
static bool came_through(const gw_tracer *tracer, const gw_ray *ray, const stretch *in,
						 const passage *own, const passage *last, bool like)
{
	float height = height_over(own, in->enter);
	if (!(height < 0.0f))
		return false;
	if (in->enter < GW_NEAR) {
		if (like || height < -GW_NOISE_DEPTH || own->approach >= 0.0f ||
			!rises_over_start(tracer, ray, own, 0.0f) ||
			!is_along_crease(tracer, own->lobe, ray->facing, ray->origin))
			return false;
	} else if (!like || last->lobe == GW_NONE || in->enter - last->leave > GW_GAP_MOST ||
			   height_over(last, last->leave) < 0.0f) {
		return false;
	}
	return holds(tracer, ray, in, own->lobe, in->enter);
}

static void meet_lobe(const gw_tracer *tracer, const gw_ray *ray, const stretch *in, uint32_t slot,
					  passage *last, gw_ray_hit *hit)
{
	const float *plane = tracer->lobe_plane + 4 * (size_t)slot;
	passage own = { .lobe = slot, .normal = gw_xyz(plane), .leave = in->leave };
	own.approach = gw_dot(own.normal, ray->direction);
	own.rise = plane[3] - gw_dot(own.normal, gw_minus(ray->origin, in->centre));
	if (meets_plane(tracer, ray, in, &own, hit)) {
		hit->lobe = slot;
		return;
	}
	if (!ray->discs)
		return;
	bool like = gw_dot(own.normal, last->normal) > GW_LIKE_COSINE;
	if (in->enter < hit->t && came_through(tracer, ray, in, &own, last, like)) {
		hit->lobe = slot;
		hit->t = gw_smaller(hit->t, in->leave);
	} else if (like && (in->enter >= GW_NEAR || height_over(&own, in->leave) >= 0.0f ||
						holds(tracer, ray, in, slot, in->leave))) {
		*last = own;
	}
}

/* Does a lobe's centre lie in front of another one's plane? */
static bool rises_over(const gw_tracer *tracer, gw_vec3 centre, uint32_t slot, uint32_t over)
{
	const float *plane = tracer->lobe_plane + 4 * (size_t)over;
	gw_vec3 middle = gw_xyz(tracer->lobe_centre + 4 * (size_t)slot);
	return gw_dot(gw_xyz(plane), gw_minus(middle, centre)) - plane[3] > GW_CONCAVE_HEIGHT;
}

/* The lobes of a leaf that has some. */
static void meet_leaf(const gw_tracer *tracer, const gw_ray *ray, const uint32_t *tile,
					  uint32_t octant, stretch *in, passage *last, gw_ray_hit *hit)
{
	uint32_t leaf = tile[0] + (uint32_t)__builtin_popcount(tile[1] & ((1u << octant) - 1));
	bool second = tile[1] >> (16 + octant) & 1;
	in->covered = tile[1] >> (24 + octant) & 1;
	in->concave = second && !in->covered &&
				  rises_over(tracer, in->centre, 2 * leaf + 1, 2 * leaf) &&
				  rises_over(tracer, in->centre, 2 * leaf, 2 * leaf + 1);
	meet_lobe(tracer, ray, in, 2 * leaf, last, hit);
	if (second)
		meet_lobe(tracer, ray, in, 2 * leaf + 1, last, hit);
}

/* What a ray does that is still behind the surface it left when that should be behind it. */
static void leave_start(const passage *last, float t, gw_ray_hit *hit)
{
	if (hit->lobe == GW_NONE && last->lobe != GW_NONE && height_over(last, t) < 0.0f) {
		hit->lobe = last->lobe;
		hit->t = gw_smaller(hit->t, last->leave);
	}
}

/* ------------------------------------------------------------------------------------- walking */

/* What stays the same on a ray's way; the fourth lanes are 0. */
typedef struct walk {
	float_lanes origin, direction, inverse;
	float_lanes ahead; /* 1 where the ray goes up, -1 where it goes down */
	float_lanes far;   /* 1 where it goes up, else 0: the side on which it leaves a cell */
	int_lanes last;    /* of the octree's cells */
} walk;

static float_lanes lanes_of(gw_vec3 v)
{
	return (float_lanes){ v.x, v.y, v.z, 0.0f };
}

static float smallest(float_lanes v)
{
	return gw_smaller(v[0], gw_smaller(v[1], v[2]));
}

static float inverse_of(float d)
{
	return 1.0f / (fabsf(d) >= 1e-20f ? d : d >= 0.0f ? 1e-20f : -1e-20f);
}

static walk walk_of(const gw_tracer *tracer, const gw_ray *ray)
{
	gw_vec3 d = ray->direction;
	int32_t last = (int32_t)(1u << tracer->depth) - 1;
	walk w = { .origin = lanes_of(ray->origin),
			   .direction = lanes_of(d),
			   .inverse = { inverse_of(d.x), inverse_of(d.y), inverse_of(d.z), 0.0f },
			   .ahead = { d.x >= 0.0f ? 1.0f : -1.0f, d.y >= 0.0f ? 1.0f : -1.0f,
						  d.z >= 0.0f ? 1.0f : -1.0f, 0.0f },
			   .last = { last, last, last, 0 } };
	w.far = 0.5f * (w.ahead * w.ahead + w.ahead);
	return w;
}

/* The cell at a distance, inside the octree. */
static inline int_lanes cell_at(const walk *w, float t)
{
	int_lanes cell = __builtin_convertvector(w->origin + w->direction * t, int_lanes);
	int_lanes above = cell > w->last, below = cell < 0;
	return (cell & ~above & ~below) | (w->last & above);
}

/* Distance to where the ray leaves a cell of a level, with `reach` more around it. */
static inline float leaving(const walk *w, int_lanes cell, uint32_t shift, uint32_t reach)
{
	float_lanes corner = __builtin_convertvector(cell >> (int32_t)shift, float_lanes) + w->far +
						 w->ahead * (float)reach;
	return smallest((corner * (float)(1u << shift) - w->origin) * w->inverse);
}

static inline uint32_t octant_of(int_lanes cell, uint32_t shift)
{
	int_lanes bit = cell >> (int32_t)shift & 1;
	return (uint32_t)(bit[0] | bit[1] << 1 | bit[2] << 2);
}

/* Goes on to the far side of the largest empty box that is known around the cell; in a leaf, of
 * that, unless it is hit. */
static inline float look_around(const gw_tracer *tracer, const gw_ray *ray, const walk *w,
								int_lanes cell, float t, passage *last, gw_ray_hit *hit)
{
	uint32_t level = tracer->directory_level, shift = tracer->depth - level;
	int_lanes c = cell >> (int32_t)shift;
	uint32_t entry = tracer->ray_directory[(uint32_t)c[0] + ((uint32_t)c[1] << level) +
										   ((uint32_t)c[2] << 2 * level)];
	if (entry >> 31 == 0)
		return leaving(w, cell, shift, entry > 1 ? entry - 1 : 0);
	uint32_t pointer = (entry & 0x7fffffffu) + 1;
	for (; shift > 1 && pointer != 0; shift--)
		pointer = tracer->node[8 * (size_t)(pointer - 1) + octant_of(cell, shift - 1)];
	if (pointer == 0)
		return leaving(w, cell, shift, 0);
	const uint32_t *tile = tracer->leaf_tile + 2 * (size_t)(pointer - 1);
	uint32_t octant = octant_of(cell, 0);
	stretch in = { .centre = { (float)cell[0] + 0.5f, (float)cell[1] + 0.5f,
							   (float)cell[2] + 0.5f },
				   .enter = t,
				   .leave = leaving(w, cell, 0, 0) };
	if (tile[1] >> (8 + octant) & 1)
		meet_leaf(tracer, ray, tile, octant, &in, last, hit);
	return in.leave;
}

static gw_ray_hit trace_octree(const gw_tracer *tracer, const gw_ray *ray)
{
	gw_ray_hit hit = { .lobe = GW_NONE, .t = ray->t_max };
	const walk w = walk_of(tracer, ray);
	float_lanes side = { tracer->side, tracer->side, tracer->side };
	float_lanes enter = (side * (1.0f - w.far) - w.origin) * w.inverse;
	float t_end = gw_smaller(ray->t_max, smallest((side * w.far - w.origin) * w.inverse));
	float t = gw_larger(0.0f, gw_larger(enter[0], gw_larger(enter[1], enter[2])));
	passage last = { .lobe = GW_NONE, .normal = ray->facing };
	bool near = true;
	for (uint32_t step = 0; step < GW_WALK_STEPS && t < t_end && hit.lobe == GW_NONE; step++) {
		float next = look_around(tracer, ray, &w, cell_at(&w, t + tracer->nudge), t, &last, &hit);
		t = gw_larger(next, t + tracer->nudge);
		if (near && (t >= GW_NEAR || t >= t_end)) {
			near = false;
			leave_start(&last, gw_smaller(t_end, gw_larger(last.leave, GW_NEAR)), &hit);
		}
	}
	return hit;
}

/* Where both have the surface that is hit, the octree's is the finer one. */
gw_ray_hit gw_trace(const gw_tracer *tracer, const gw_ray *ray)
{
	if (tracer->large.nodes == 0)
		return trace_octree(tracer, ray);
	gw_disc_hit disc =
		gw_disc_tree_trace(&tracer->large, &(gw_disc_ray){ .origin = ray->origin,
														   .direction = ray->direction,
														   .facing = ray->facing,
														   .foot = ray->foot,
														   .t_max = ray->t_max,
														   .both_sides = ray->both_sides });
	gw_ray nearer = *ray;
	nearer.t_max = gw_smaller(disc.yields, ray->t_max);
	gw_ray_hit hit = trace_octree(tracer, &nearer);
	if (hit.lobe == GW_NONE) {
		hit.lobe = disc.lobe;
		hit.t = disc.t;
	}
	hit.behind |= disc.behind < hit.t;
	return hit;
}
