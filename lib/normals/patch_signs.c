/* patch_signs.c - see patch_signs.h. */
#include "normals/patch_signs.h"

#include "base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Least share of a border that has to say the same, for groups to be joined along it. */
#define BORDER_LEAST 0.5

/* Rounds in which groups may turn. */
#define TURNS 32

/* No group, and no border. */
#define NONE UINT32_MAX

/* The groups of one round: each is made of groups of the round before. */
typedef struct level {
	uint32_t *parent; /* of each group, its group in the next round, or NONE */
	size_t count;
} level;

#define LEVELS 32 /* each halves the number of groups that are joined, and there are below 2^32 */

struct gw_patch_groups {
	size_t count;
	gw_patch_border *all;     /* borders of patches */
	gw_patch_border *borders; /* of the groups of the round */
	size_t all_count, border_count;
	int8_t *sign;
	uint32_t *group; /* of a patch, in this round */
	uint32_t *best;  /* of a group, the border that says most */
	uint32_t *root;  /* of a group, one of those that it is joined to */
	int8_t *against; /* of a group, its sign against its root's */
	level levels[LEVELS];
	size_t level_count;
	double *gain;   /* of the groups of a level */
	uint32_t *turn; /* of the groups of the next one, that of its groups which gains most */
};

/* ------------------------------------------------------------------------------------- borders */

static int by_patches(const void *left, const void *right)
{
	const gw_patch_border *a = left, *b = right;
	return a->a != b->a ? (a->a < b->a ? -1 : 1) : a->b != b->b ? (a->b < b->b ? -1 : 1) : 0;
}

size_t gw_patch_borders_merge(gw_patch_border *borders, size_t count)
{
	size_t kept = 0;
	if (count == 0)
		return 0;
	qsort(borders, count, sizeof *borders, by_patches);
	for (size_t i = 0; i < count; i++) {
		gw_patch_border s = borders[i];
		if (kept > 0 && by_patches(borders + kept - 1, &s) == 0) {
			borders[kept - 1].says += s.says;
			borders[kept - 1].weight += s.weight;
		} else {
			borders[kept++] = s;
		}
	}
	return kept;
}

/* ------------------------------------------------------------------------------------- joining */

static uint32_t find_root(gw_patch_groups *w, uint32_t group, int8_t *against)
{
	*against = 1;
	while (w->root[group] != group) {
		*against = (int8_t)(*against * w->against[group]);
		group = w->root[group];
	}
	return group;
}

static void join(gw_patch_groups *w, const gw_patch_border *s)
{
	int8_t of_a, of_b;
	uint32_t a = find_root(w, s->a, &of_a), b = find_root(w, s->b, &of_b);
	if (a == b)
		return;
	w->root[a < b ? b : a] = a < b ? a : b;
	w->against[a < b ? b : a] = (int8_t)(of_a * of_b * (s->says < 0 ? -1 : 1));
}

/* Of each group the border that says most, where it says anything. */
static void choose_borders(gw_patch_groups *w, size_t groups)
{
	for (size_t i = 0; i < groups; i++)
		w->best[i] = NONE;
	for (uint32_t i = 0; i < w->border_count; i++) {
		const gw_patch_border *s = w->borders + i;
		if (s->says == 0 || fabs(s->says) < BORDER_LEAST * s->weight)
			continue;
		for (int side = 0; side < 2; side++) {
			uint32_t *b = w->best + (side ? s->b : s->a);
			if (*b == NONE || fabs(s->says) > fabs(w->borders[*b].says))
				*b = i;
		}
	}
}

/* Numbers the groups that were joined; patches and borders go over to them. */
static size_t enter_level(gw_patch_groups *w, level *l)
{
	size_t groups = 0, kept = 0;
	for (uint32_t i = 0; i < l->count; i++)
		if (w->root[i] == i)
			l->parent[i] = (uint32_t)groups++;
	for (uint32_t i = 0; i < l->count; i++) {
		int8_t against;
		uint32_t root = find_root(w, i, &against);
		if (root != i)
			l->parent[i] = l->parent[root];
		w->best[i] = against < 0; /* no longer needed for borders */
	}
	for (size_t i = 0; i < w->count; i++) {
		w->sign[i] = w->best[w->group[i]] ? (int8_t)-w->sign[i] : w->sign[i];
		w->group[i] = l->parent[w->group[i]];
	}
	for (size_t i = 0; i < w->border_count; i++) {
		gw_patch_border s = w->borders[i];
		s.says = w->best[s.a] != w->best[s.b] ? -s.says : s.says;
		uint32_t a = l->parent[s.a], b = l->parent[s.b];
		s.a = a < b ? a : b;
		s.b = a < b ? b : a;
		w->borders[kept] = s;
		kept += a != b;
	}
	w->border_count = gw_patch_borders_merge(w->borders, kept);
	return groups;
}

/* One round: every group is joined with the neighbour about which its border says most. */
static bool join_round(gw_patch_groups *w, size_t *groups)
{
	level *l = w->levels + w->level_count;
	l->count = *groups;
	l->parent = gw_allocate_array(l->count, sizeof *l->parent);
	if (!l->parent)
		return false;
	w->level_count++;
	choose_borders(w, l->count);
	for (uint32_t i = 0; i < l->count; i++) {
		w->root[i] = i;
		w->against[i] = 1;
	}
	for (size_t i = 0; i < l->count; i++)
		if (w->best[i] != NONE)
			join(w, w->borders + w->best[i]);
	*groups = enter_level(w, l);
	return true;
}

static bool join_all(gw_patch_groups *w)
{
	size_t groups = w->count, before = 0;
	bool made = true;
	while (made && groups != before && w->level_count < LEVELS) {
		before = groups;
		made = join_round(w, &groups);
	}
	return made;
}

/* ------------------------------------------------------------------------------------- turning */

/* Of the patches, their groups at a level. */
static void climb(gw_patch_groups *w, size_t to)
{
	for (uint32_t i = 0; i < w->count; i++) {
		w->group[i] = i;
		for (size_t l = 0; l < to; l++)
			w->group[i] = w->levels[l].parent[w->group[i]];
	}
}

/* What the sum would lose, halved, if a group turned: its own part, and its borders to others. */
static void find_gains(gw_patch_groups *w, const double *own, size_t groups)
{
	memset(w->gain, 0, groups * sizeof *w->gain);
	for (size_t i = 0; i < w->count; i++)
		w->gain[w->group[i]] += own[i] * w->sign[i];
	for (size_t i = 0; i < w->all_count; i++) {
		const gw_patch_border *s = w->all + i;
		uint32_t a = w->group[s->a], b = w->group[s->b];
		double says = s->says * w->sign[s->a] * w->sign[s->b];
		w->gain[a] += a != b ? says : 0;
		w->gain[b] += a != b ? says : 0;
	}
}

/* Turns of each group of groups the one by which the sum gains most. */
static bool turn_groups(gw_patch_groups *w, const double *own, const level *l)
{
	bool any = false;
	find_gains(w, own, l->count);
	for (size_t i = 0; i < w->count; i++)
		w->turn[i] = NONE;
	for (uint32_t i = 0; i < l->count; i++) {
		uint32_t *turn = w->turn + l->parent[i];
		if (w->gain[i] < 0 && (*turn == NONE || w->gain[i] < w->gain[*turn])) {
			*turn = i;
			any = true;
		}
	}
	for (size_t i = 0; any && i < w->count; i++)
		if (w->turn[l->parent[w->group[i]]] == w->group[i])
			w->sign[i] = (int8_t)-w->sign[i];
	return any;
}

/* From the largest groups that are part of another one to single patches. The last level is the
 * one in which nothing was joined. */
void gw_patch_groups_turn(gw_patch_groups *groups, const double *own, int8_t *sign)
{
	memcpy(groups->sign, sign, groups->count * sizeof *sign);
	bool any = true;
	for (int round = 0; round < TURNS && any; round++) {
		any = false;
		for (size_t l = groups->level_count - 1; l-- > 0;) {
			climb(groups, l);
			any |= turn_groups(groups, own, groups->levels + l);
		}
	}
	memcpy(sign, groups->sign, groups->count * sizeof *sign);
}

/* ----------------------------------------------------------------------------------- all of it */

static bool allocate(gw_patch_groups *w)
{
	w->borders = gw_allocate_array(w->all_count, sizeof *w->borders);
	w->sign = gw_allocate_array(w->count, sizeof *w->sign);
	w->group = gw_allocate_array(w->count, sizeof *w->group);
	w->best = gw_allocate_array(w->count, sizeof *w->best);
	w->root = gw_allocate_array(w->count, sizeof *w->root);
	w->against = gw_allocate_array(w->count, sizeof *w->against);
	w->gain = gw_allocate_array(w->count, sizeof *w->gain);
	w->turn = gw_allocate_array(w->count, sizeof *w->turn);
	return w->borders && w->sign && w->group && w->best && w->root && w->against && w->gain &&
		   w->turn;
}

void gw_patch_groups_free(gw_patch_groups *w)
{
	if (!w)
		return;
	free(w->borders);
	free(w->sign);
	free(w->group);
	free(w->best);
	free(w->root);
	free(w->against);
	free(w->gain);
	free(w->turn);
	for (size_t l = 0; l < w->level_count; l++)
		free(w->levels[l].parent);
	free(w);
}

gw_patch_groups *gw_patch_groups_make(size_t count, gw_patch_border *borders, size_t border_count,
									  int8_t *sign, uint32_t *group)
{
	gw_patch_groups *w = gw_allocate_zeros(1, sizeof *w);
	if (!w)
		return NULL;
	w->count = count;
	w->all = borders;
	w->all_count = w->border_count = gw_patch_borders_merge(borders, border_count);
	bool made = allocate(w);
	for (uint32_t i = 0; made && i < count; i++) {
		w->sign[i] = 1;
		w->group[i] = i;
	}
	if (made && w->all_count > 0)
		memcpy(w->borders, w->all, w->all_count * sizeof *w->all);
	if (!made || !join_all(w)) {
		gw_patch_groups_free(w);
		return NULL;
	}
	memcpy(sign, w->sign, count * sizeof *sign);
	memcpy(group, w->group, count * sizeof *group);
	return w;
}
