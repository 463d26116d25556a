/*
 * free_balls.c - see free_balls.h.
 */
#include "light/free_balls.h"

#include "base/memory.h"
#include "base/parallel.h"
#include "base/shader_math.h"

#include <stdlib.h>

/* Steps of shrinking: each but the last few halves what is left to go, about. */
#define STEPS 40

/* Of the radius: what a ball may hold of another surfel's distance and count as empty. */
#define ENOUGH 1e-3f

/* Cosine of the angle at the centre between two surfels of one surface: 20 degrees, as in
 * implementations of the algorithm. */
#define SAME_SURFACE 0.94f

/* A centre within this share of a larger ball's radius from that one's centre is left out. */
#define WITHIN 0.4f

#define CHUNK 64u /* seeds that a thread takes at a time */

typedef struct growth {
	const gw_free_ball_task *task;
	gw_free_ball *ball; /* two a seed: in front, and behind a surfel with two sides; radius 0: none
						 */
	size_t seeds;
} growth;

/* The largest radius with which the centre of a ball that touches a place stays in the bounds. */
static float largest_radius(const gw_free_ball_task *task, const float place[3], gw_vec3 normal)
{
	const float along[3] = { normal.x, normal.y, normal.z };
	float radius = INFINITY;
	for (int k = 0; k < 3; k++) {
		float room = along[k] > 0.0f ? task->maximum[k] - place[k] : place[k] - task->minimum[k];
		if (fabsf(along[k]) > 1e-6f)
			radius = gw_smaller(radius, gw_larger(room, 0.0f) / fabsf(along[k]));
	}
	return radius;
}

static gw_neighbour_list nearest_to(gw_neighbours *search, gw_vec3 place)
{
	gw_neighbour_list list;
	gw_neighbours_at(search, (const double[3]){ (double)place.x, (double)place.y, (double)place.z },
					 &list);
	return list;
}

float gw_free_distance(gw_neighbours *search, const float place[3])
{
	gw_neighbour_list list = nearest_to(search, gw_xyz(place));
	return list.count > 0 ? list.distance[0] : 0.0f;
}

bool gw_free_is_behind(const gw_surfels *s, gw_neighbours *search, const float place[3])
{
	gw_neighbour_list list = nearest_to(search, gw_xyz(place));
	if (list.count == 0 || s->two_sided[list.index[0]] != 0)
		return false;
	const size_t nearest = list.index[0];
	return gw_dot(gw_minus(gw_xyz(place), gw_xyz(s->position + 3 * nearest)),
				  gw_xyz(s->normal + 3 * nearest)) < 0.0f;
}

/* The ball in front of a surfel; without radius where there is none. */
static gw_free_ball shrink(const gw_free_ball_task *task, size_t surfel, float side)
{
	const gw_surfels *s = task->surfels;
	gw_vec3 place = gw_xyz(s->position + 3 * surfel);
	gw_vec3 normal = gw_times(gw_xyz(s->normal + 3 * surfel), side);
	float radius = largest_radius(task, s->position + 3 * surfel, normal), free = 0.0f;
	gw_vec3 centre = place;
	for (int step = 0; step < STEPS && radius >= task->least; step++) {
		centre = gw_plus(place, gw_times(normal, radius));
		gw_neighbour_list list = nearest_to(task->search, centre);
		free = list.count > 0 ? list.distance[0] : 0.0f;
		if (list.count == 0 || list.index[0] == surfel || free >= radius * (1.0f - ENOUGH))
			break;
		gw_vec3 other = gw_minus(gw_xyz(s->position + 3 * (size_t)list.index[0]), place);
		float along = gw_dot(other, normal);
		float next = along > 0.0f ? gw_dot(other, other) / (2.0f * along) : 0.0f;
		gw_vec3 from = gw_times(normal, -1.0f), to = gw_minus(other, gw_times(normal, next));
		if (!(next < radius) || gw_dot(from, to) > SAME_SURFACE * sqrtf(gw_dot(to, to)))
			break;
		radius = next;
	}
	gw_free_ball ball = { { centre.x, centre.y, centre.z }, 0.0f };
	if (radius >= task->least && free >= task->least)
		ball.radius = gw_smaller(free, radius);
	return ball;
}

static void grow(void *user, size_t first, size_t last, uint32_t worker)
{
	const growth *g = user;
	const gw_surfels *s = g->task->surfels;
	(void)worker;
	for (size_t i = first; i < last; i++) {
		size_t surfel = (size_t)((double)i * (double)s->count / (double)g->seeds);
		g->ball[2 * i] = shrink(g->task, surfel, 1.0f);
		if (s->two_sided[surfel] != 0)
			g->ball[2 * i + 1] = shrink(g->task, surfel, -1.0f);
	}
}

/* The largest first; of equal ones by their place, so that the order is the same everywhere. */
static int compare(const void *left, const void *right)
{
	const gw_free_ball *a = left, *b = right;
	if (a->radius != b->radius)
		return a->radius > b->radius ? -1 : 1;
	for (int k = 0; k < 3; k++)
		if (a->centre[k] != b->centre[k])
			return a->centre[k] < b->centre[k] ? -1 : 1;
	return 0;
}

static bool is_within(const gw_free_ball *ball, const gw_free_ball *larger)
{
	gw_vec3 off = gw_minus(gw_xyz(ball->centre), gw_xyz(larger->centre));
	float reach = WITHIN * larger->radius;
	return gw_dot(off, off) < reach * reach;
}

/* Keeps the first of those that lie in each other; returns how many. */
static size_t thin(gw_free_ball *ball, size_t count, size_t most)
{
	size_t kept = 0;
	for (size_t i = 0; i < count && kept < most && ball[i].radius > 0.0f; i++) {
		bool within = false;
		for (size_t k = 0; k < kept && !within; k++)
			within = is_within(&ball[i], &ball[k]);
		if (!within)
			ball[kept++] = ball[i];
	}
	return kept;
}

gw_status gw_free_balls_find(const gw_free_ball_task *task, gw_free_ball **balls, size_t *count,
							 gw_error *error)
{
	growth g = { .task = task,
				 .seeds = task->seeds < task->surfels->count ? task->seeds : task->surfels->count };
	*balls = NULL;
	*count = 0;
	g.ball = gw_allocate_zeros(g.seeds, 2 * sizeof *g.ball);
	if (!g.ball)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu balls of free space", g.seeds);
	gw_parallel_for(task->threads, g.seeds, CHUNK, grow, &g);
	qsort(g.ball, 2 * g.seeds, sizeof *g.ball, compare);
	*count = thin(g.ball, 2 * g.seeds, task->most);
	*balls = g.ball;
	if (*count == 0) {
		free(g.ball);
		*balls = NULL;
	}
	return GW_OK;
}
