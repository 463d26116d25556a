/* shells.c - see shells.h. */
#include "normals/shells.h"

#include "base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A shell has at least this share of all surface, and of what one sees within it so much is surface
 * of its own or of what it holds. */
#define SHELL_LEAST 0.1
#define ENCLOSED_LEAST 0.75

/* So much of what a piece sees from its front is the shell around it. */
#define WITHIN 0.5
/* And so far away it is, of the distances across the shell: layers of one surface, which noise or
 * registration put apart, lie nearer. */
#define APART 0.1

/* What lies within has this share of the shell's area, and so many times what lies on the other
 * side. */
#define HELD_LEAST 0.1
#define HELD_TIMES 4.0

/* What a piece sees of one shell's sides, m^2 of its own surface, and logarithms of the distances
 * times that. */
typedef struct seen {
	double area[2], path[2];
} seen;

/* Which piece an end of a sight belongs to, and on which side. */
static uint32_t piece_of_end(const gw_pieces *p, uint32_t end, uint32_t *side)
{
	*side = p->sign[end / 2] > 0 ? end % 2 : 1 - end % 2;
	return p->piece_of[end / 2];
}

/* What all pieces see of a shell from their fronts, and the shell itself from either side: of what
 * it sees in all, too. */
static void look(const gw_pieces *p, const gw_side_sight *sights, size_t count, uint32_t shell,
				 seen *by, seen *own)
{
	memset(by, 0, p->count * sizeof *by);
	*own = (seen){ 0 };
	for (size_t i = 0; i < count; i++) {
		const gw_side_sight *s = sights + i;
		uint32_t from_side, to_side, from = piece_of_end(p, s->from, &from_side);
		uint32_t to = piece_of_end(p, s->to, &to_side);
		if (from == shell) {
			own->area[from_side] += (double)s->area;
			own->path[from_side] += (double)(s->area * s->path);
		} else if (to == shell && from_side == 0) {
			by[from].area[to_side] += (double)s->area;
			by[from].path[to_side] += (double)(s->area * s->path);
		}
	}
}

/* m^2 of pieces that lie within a side of a shell. */
static double held_within(const gw_pieces *p, const seen *by, const seen *own, int side)
{
	double held = 0, least = log(APART) + own->path[side] / own->area[side];
	for (size_t i = 0; i < p->count; i++)
		if (by[i].area[side] > WITHIN * p->area[i] && by[i].path[side] > least * by[i].area[side])
			held += p->area[i];
	return held;
}

static int8_t side_that_holds(const gw_pieces *p, const seen *by, const seen *own, uint32_t shell)
{
	double held[2] = { held_within(p, by, own, 0), held_within(p, by, own, 1) };
	int side = held[1] > held[0];
	bool encloses =
		own->area[side] > ENCLOSED_LEAST * p->area[shell] && own->area[side] > own->area[1 - side];
	bool holds =
		held[side] > HELD_LEAST * p->area[shell] && held[side] > HELD_TIMES * held[1 - side];
	return !encloses || !holds ? 0 : side == 0 ? 1 : -1;
}

gw_status gw_find_shells(const gw_pieces *pieces, const gw_side_sight *sights, size_t sight_count,
						 int8_t *holds, gw_error *error)
{
	double all = 0;
	seen own, *by = gw_allocate_array(pieces->count, sizeof *by);
	if (!by)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for what %zu pieces of surface see",
					   pieces->count);
	for (size_t i = 0; i < pieces->count; i++)
		all += pieces->area[i];
	for (uint32_t i = 0; i < pieces->count; i++) {
		holds[i] = 0;
		if (!(pieces->area[i] > SHELL_LEAST * all))
			continue;
		look(pieces, sights, sight_count, i, by, &own);
		holds[i] = side_that_holds(pieces, by, &own, i);
	}
	free(by);
	return GW_OK;
}
