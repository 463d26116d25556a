/*
 * probe_places.c - see probe_places.h.
 */
#include "light/probe_places.h"

#include "base/memory.h"
#include "base/shader_math.h"

#include <stdlib.h>

/* Half the side of the cube of support probes, of the probe's distance to the surface: its corners
 * stay in the free ball around the probe, sqrt(3) / 2 < 1. */
#define SUPPORT 0.5f

#define CORNERS 8

/* Probes under way: places, and how well each sees. */
typedef struct probes {
	size_t count;
	float *place; /* 4 a probe */
	float *value; /* a row of places->count a probe */
} probes;

/* All that is worked on. */
typedef struct work {
	const gw_probe_task *task;
	size_t width;      /* places that are looked at */
	const float *area; /* of each */
	float *value;      /* a row a candidate */
	uint8_t *seeable;  /* width, 1: some candidate sees it */
	float *others;     /* width: how well the other probes see each place */
	uint32_t *seers;   /* width: how many probes see it */
	float *look;       /* rows of support probes */
	probes now, best, kept;
	uint32_t counter; /* of random numbers */
} work;

static float random_of(work *w)
{
	return unit_float(pcg_hash2(w->counter++, w->task->seed));
}

/* What a place is worth that is seen so well. */
static double worth(float value)
{
	return value > 0.0f ? 1.0 + (double)value : 0.0;
}

/* What a row adds to what others see. */
static double gain_of(const work *w, const float *value)
{
	double gain = 0.0;
	for (size_t t = 0; t < w->width; t++)
		if (value[t] > w->others[t])
			gain += (double)w->area[t] * (worth(value[t]) - worth(w->others[t]));
	return gain;
}

/* Takes a row into what is seen. */
static void see(const work *w, const float *value)
{
	for (size_t t = 0; t < w->width; t++)
		w->others[t] = gw_larger(w->others[t], value[t]);
}

/* What all probes but one see; but == count: all. */
static void see_others(const work *w, const probes *p, size_t but)
{
	memset(w->others, 0, w->width * sizeof *w->others);
	for (size_t k = 0; k < p->count; k++)
		if (k != but)
			see(w, p->value + k * w->width);
}

/* The area that somebody could see and w->others do not. */
static double unseen_area(const work *w)
{
	double area = 0.0;
	for (size_t t = 0; t < w->width; t++)
		if (w->seeable[t] && !(w->others[t] > 0.0f))
			area += (double)w->area[t];
	return area;
}

/* ------------------------------------------------------------------------------- candidates */

static void to_grid(const gw_octree *octree, const float metres[3], float grid[4])
{
	for (int k = 0; k < 3; k++)
		grid[k] = (metres[k] - octree->cube_minimum[k]) / octree->leaf_size;
	grid[3] = 0.0f;
}

static gw_status look_from_candidates(work *w, float *viewer, gw_error *error)
{
	const gw_probe_task *task = w->task;
	for (size_t i = 0; i < task->candidate_count; i++)
		to_grid(task->sight.octree, task->candidate[i].centre, viewer + 4 * i);
	GW_TRY(gw_sight_look(&task->sight, viewer, task->candidate_count, w->value, error));
	for (size_t i = 0; i < task->candidate_count; i++)
		for (size_t t = 0; t < w->width; t++)
			w->seeable[t] |= w->value[i * w->width + t] > 0.0f;
	return GW_OK;
}

static void copy_probe(const work *w, const float *place, const float *value, probes *to, size_t k)
{
	memcpy(to->place + 4 * k, place, 4 * sizeof *place);
	memcpy(to->value + k * w->width, value, w->width * sizeof *value);
}

/* Adds the candidate that adds most, again and again, until all is seen or there are enough. What a
 * candidate adds only becomes less, so that most of what was reckoned earlier need not be again. */
static void choose_first(work *w, const float *viewer, double *gain, size_t most)
{
	size_t count = w->task->candidate_count;
	memset(w->others, 0, w->width * sizeof *w->others);
	for (size_t i = 0; i < count; i++)
		gain[i] = gain_of(w, w->value + i * w->width);
	while (w->now.count < most && unseen_area(w) > 0.0) {
		size_t chosen = 0;
		double largest = 0.0;
		for (size_t i = 0; i < count; i++) {
			if (gain[i] <= largest)
				continue;
			gain[i] = gain_of(w, w->value + i * w->width);
			if (gain[i] > largest) {
				largest = gain[i];
				chosen = i;
			}
		}
		if (!(largest > 0.0))
			break;
		copy_probe(w, viewer + 4 * chosen, w->value + chosen * w->width, &w->now, w->now.count++);
		see(w, w->value + chosen * w->width);
	}
}

/* ------------------------------------------------------------------------------- fewer of them */

static void remove_probe(const work *w, probes *p, size_t k)
{
	size_t after = p->count - 1 - k;
	memmove(p->place + 4 * k, p->place + 4 * (k + 1), 4 * after * sizeof *p->place);
	memmove(p->value + k * w->width, p->value + (k + 1) * w->width,
			after * w->width * sizeof *p->value);
	p->count--;
}

static void copy_probes(const work *w, const probes *from, probes *to)
{
	to->count = from->count;
	memcpy(to->place, from->place, 4 * from->count * sizeof *to->place);
	memcpy(to->value, from->value, from->count * w->width * sizeof *to->value);
}

/* The probe without which least is left unseen of what all see together; area receives how much. */
static size_t least_needed(const work *w, const probes *p, double *area)
{
	size_t least = 0;
	*area = INFINITY;
	memset(w->seers, 0, w->width * sizeof *w->seers);
	for (size_t k = 0; k < p->count; k++)
		for (size_t t = 0; t < w->width; t++)
			w->seers[t] += p->value[k * w->width + t] > 0.0f;
	for (size_t k = 0; k < p->count; k++) {
		double own = 0.0;
		for (size_t t = 0; t < w->width; t++)
			if (w->seers[t] == 1 && w->seeable[t] && p->value[k * w->width + t] > 0.0f)
				own += (double)w->area[t];
		if (own < *area) {
			*area = own;
			least = k;
		}
	}
	return least;
}

/* Removes probes that see nothing that no other sees. */
static void remove_needless(work *w)
{
	double area;
	while (w->now.count > 1) {
		size_t k = least_needed(w, &w->now, &area);
		if (area > 0.0)
			return;
		remove_probe(w, &w->now, k);
	}
}

/* ------------------------------------------------------------------------------ Gibbs sampling */

/* A number in [0, 1] with a density that goes from one value to another linearly: the inverse of
 * its cumulative distribution (section 3.2.4). */
static float draw_linear(double from, double to, float number)
{
	double sum = from + to;
	if (!(sum > 0.0))
		return number;
	double aim = (double)number * sum / 2.0;
	double root = sqrt(fmax(0.0, from * from + 2.0 * (to - from) * aim));
	return from + root > 0.0 ? (float)fmin(1.0, 2.0 * aim / (from + root)) : number;
}

/* A place drawn between the corners of the cube: along x on four edges, along y between pairs of
 * these, along z between the last two. Halves places and gains, corner by corner, bit 0 being x. */
static void draw_place(work *w, float place[CORNERS][4], double gain[CORNERS], float drawn[4])
{
	for (int left = CORNERS / 2; left > 0; left /= 2)
		for (int i = 0; i < left; i++) {
			const float *a = place[2 * i], *b = place[2 * i + 1];
			float at = draw_linear(gain[2 * i], gain[2 * i + 1], random_of(w));
			gain[i] = gain[2 * i] + (gain[2 * i + 1] - gain[2 * i]) * (double)at;
			for (int k = 0; k < 4; k++)
				place[i][k] = a[k] + (b[k] - a[k]) * at;
		}
	memcpy(drawn, place[0], 4 * sizeof *drawn);
}

/* The corners around a probe; half the side of their cube in leaf cells. */
static void put_corners(float place[CORNERS][4], const float *probe, float half)
{
	for (int i = 0; i < CORNERS; i++) {
		for (int k = 0; k < 3; k++)
			place[i][k] = probe[k] + (i >> k & 1 ? half : -half);
		place[i][3] = 0.0f;
	}
}

/* The distance of a probe from the surface, leaf cells. */
static float free_around(const work *w, const float *probe)
{
	const gw_octree *o = w->task->sight.octree;
	float metres[3];
	for (int k = 0; k < 3; k++)
		metres[k] = o->cube_minimum[k] + probe[k] * o->leaf_size;
	return gw_free_distance(w->task->search, metres) / o->leaf_size;
}

static bool is_in_bounds(const work *w, const float *probe)
{
	const gw_probe_task *t = w->task;
	const gw_octree *o = t->sight.octree;
	for (int k = 0; k < 3; k++) {
		float metres = o->cube_minimum[k] + probe[k] * o->leaf_size;
		if (metres < t->minimum[k] || metres > t->maximum[k])
			return false;
	}
	return true;
}

/* One move of one probe, taken or not. */
static gw_status move(work *w, size_t k, bool *taken, gw_error *error)
{
	const gw_sight *sight = &w->task->sight;
	float *probe = w->now.place + 4 * k, corner[CORNERS][4], drawn[4];
	double gain[CORNERS];
	*taken = false;
	put_corners(corner, probe, SUPPORT * free_around(w, probe));
	GW_TRY(gw_sight_look(sight, corner[0], CORNERS, w->look, error));
	see_others(w, &w->now, k);
	for (size_t i = 0; i < CORNERS; i++)
		gain[i] = gain_of(w, w->look + i * w->width);
	draw_place(w, corner, gain, drawn);
	float accept = random_of(w);
	if (!is_in_bounds(w, drawn) || free_around(w, drawn) < w->task->least)
		return GW_OK;
	GW_TRY(gw_sight_look(sight, drawn, 1, w->look, error));
	double before = gain_of(w, w->now.value + k * w->width), after = gain_of(w, w->look);
	if ((double)accept * before > after)
		return GW_OK;
	copy_probe(w, drawn, w->look, &w->now, k);
	*taken = true;
	return GW_OK;
}

/* What all probes are worth. */
static double reward_of(const work *w)
{
	double reward = 0.0;
	for (size_t t = 0; t < w->width; t++)
		reward += (double)w->area[t] * worth(w->others[t]);
	return reward;
}

/* Moves probes in turn until no more than `unseen` is left, for `moves` at most; the best that they
 * were is left. *left receives what that leaves unseen. */
static gw_status sample(work *w, uint32_t moves, double unseen, gw_probe_places *told, double *left,
						gw_error *error)
{
	double best = -1.0;
	*left = INFINITY;
	for (uint32_t i = 0;; i++) {
		see_others(w, &w->now, w->now.count);
		double area = unseen_area(w), reward = reward_of(w);
		if (area < *left || (area == *left && reward > best)) {
			*left = area;
			best = reward;
			copy_probes(w, &w->now, &w->best);
		}
		if (i == moves || *left <= unseen)
			break;
		bool taken;
		if (w->task->cancelled && w->task->cancelled(w->task->user))
			return gw_fail(error, GW_ERROR_CANCELLED, "stopped while probes were placed");
		GW_TRY(move(w, i % w->now.count, &taken, error));
		told->tried++;
		told->moved += taken;
	}
	copy_probes(w, &w->best, &w->now);
	return GW_OK;
}

/* Takes one probe away and lets the others make up for it, as often as they can in so many moves.
 */
static gw_status lessen(work *w, uint32_t moves, gw_probe_places *told, gw_error *error)
{
	double left, without;
	while (w->now.count > 1 && told->tried < moves) {
		copy_probes(w, &w->now, &w->kept);
		remove_probe(w, &w->now, least_needed(w, &w->now, &without));
		GW_TRY(sample(w, moves - told->tried, 0.0, told, &left, error));
		if (left > 0.0) {
			copy_probes(w, &w->kept, &w->now);
			break;
		}
	}
	return GW_OK;
}

/* Moves the probes: half of the moves so that there are fewer, if they see everything; the rest so
 * that they see it better, or more of it. */
static gw_status improve(work *w, bool all, gw_probe_places *told, gw_error *error)
{
	double left;
	if (w->now.count == 0)
		return GW_OK;
	if (all)
		GW_TRY(lessen(w, w->task->moves / 2, told, error));
	return sample(w, w->task->moves - told->tried, -1.0, told, &left, error);
}

/* ------------------------------------------------------------------------------ all of it */

static bool allocate_probes(probes *p, size_t count, size_t width)
{
	p->place = gw_allocate_zeros(count, 4 * sizeof *p->place);
	p->value = width > 0 && count > SIZE_MAX / sizeof *p->value / width
				   ? NULL
				   : gw_allocate_array(count * width, sizeof *p->value);
	return p->place && p->value;
}

static void clear_probes(probes *p)
{
	free(p->place);
	free(p->value);
}

/* As many probes as candidates at most. */
static bool allocate(work *w, size_t most, float **viewer, double **gain)
{
	size_t candidates = w->task->candidate_count;
	*viewer = gw_allocate_zeros(candidates, 4 * sizeof **viewer);
	*gain = gw_allocate_zeros(candidates, sizeof **gain);
	w->value = gw_allocate_array(candidates * w->width, sizeof *w->value);
	w->look = gw_allocate_array(CORNERS * w->width, sizeof *w->look);
	w->others = gw_allocate_zeros(w->width, sizeof *w->others);
	w->seers = gw_allocate_zeros(w->width, sizeof *w->seers);
	w->seeable = gw_allocate_zeros(w->width, sizeof *w->seeable);
	bool all = allocate_probes(&w->now, most, w->width);
	all = allocate_probes(&w->best, most, w->width) && all;
	all = allocate_probes(&w->kept, most, w->width) && all;
	return all && *viewer && *gain && w->value && w->look && w->others && w->seers && w->seeable;
}

static gw_status tell(work *w, gw_probe_places *places, gw_error *error)
{
	double seeable = 0.0, total = w->task->sight.places->total;
	for (size_t t = 0; t < w->width; t++)
		seeable += w->seeable[t] ? (double)w->area[t] : 0.0;
	see_others(w, &w->now, w->now.count);
	places->count = (uint32_t)w->now.count;
	places->seeable = total > 0.0 ? seeable / total : 0.0;
	places->seen = total > 0.0 ? (seeable - unseen_area(w)) / total : 0.0;
	places->place = gw_allocate_array(w->now.count, 4 * sizeof *places->place);
	if (!places->place)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu probes", w->now.count);
	memcpy(places->place, w->now.place, 4 * w->now.count * sizeof *places->place);
	return GW_OK;
}

static gw_status choose(work *w, size_t most, gw_probe_places *places, gw_error *error)
{
	float *viewer = NULL;
	double *gain = NULL;
	gw_status status = allocate(w, most, &viewer, &gain)
						   ? look_from_candidates(w, viewer, error)
						   : gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu places of probes",
									 w->task->candidate_count);
	if (status == GW_OK)
		choose_first(w, viewer, gain, most);
	free(viewer);
	free(gain);
	GW_TRY(status);
	see_others(w, &w->now, w->now.count);
	bool all = !(unseen_area(w) > 0.0);
	if (all)
		remove_needless(w);
	places->first = (uint32_t)w->now.count;
	GW_TRY(improve(w, all, places, error));
	return tell(w, places, error);
}

gw_status gw_probe_places_choose(const gw_probe_task *task, gw_probe_places *places,
								 gw_error *error)
{
	const gw_sight_places *seen = task->sight.places;
	work w = { .task = task, .width = seen->count, .area = seen->area };
	size_t most =
		task->most > 0 && task->most < task->candidate_count ? task->most : task->candidate_count;
	*places = (gw_probe_places){ .count = 0 };
	gw_status status = choose(&w, most, places, error);
	clear_probes(&w.now);
	clear_probes(&w.best);
	clear_probes(&w.kept);
	free(w.value);
	free(w.look);
	free(w.others);
	free(w.seers);
	free(w.seeable);
	if (status != GW_OK)
		gw_probe_places_clear(places);
	return status;
}

void gw_probe_places_clear(gw_probe_places *places)
{
	free(places->place);
	*places = (gw_probe_places){ .count = 0 };
}
