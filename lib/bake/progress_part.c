/*
 * progress_part.c - see progress_part.h.
 */
#include "bake/progress_part.h"

static void progress_of_part(void *user, const char *stage, double done)
{
	gw_progress_part *p = user;
	double now = p->from + p->share * done;
	p->told = now > p->told ? now : p->told;
	if (p->whole->progress)
		p->whole->progress(p->whole->user, p->name ? p->name : stage, p->told);
}

static bool part_is_cancelled(void *user)
{
	const gw_progress_part *p = user;
	return p->whole->cancelled && p->whole->cancelled(p->whole->user);
}

static void whole_is_planned(void *user, const gw_bake_result *plan)
{
	const gw_progress_part *p = user;
	p->whole->planned(p->whole->user, plan);
}

gw_bake_callbacks gw_progress_part_callbacks(gw_progress_part *part)
{
	bool planned = part->whole && part->whole->planned && part->from <= 0.0;
	return part->whole ? (gw_bake_callbacks){ progress_of_part, part_is_cancelled, part,
											  planned ? whole_is_planned : NULL }
					   : (gw_bake_callbacks){ .user = NULL };
}
