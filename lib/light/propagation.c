/*
 * propagation.c - see propagation.h: light under way. propagation_cells.c has what is so for all
 * light.
 */
#include "light/propagation.h"

#include <math.h>
#include <stdlib.h>

/* Steps from one look at how much still moves to the next. */
#define LOOK_EVERY 4u

/* Steps at most, in cells along all three sides: light that is shut in where next to no surface
 * takes it up would go round for ever. */
#define STEPS_MOST 4u

void gw_propagation_destroy(gw_gpu *gpu, gw_propagation *p)
{
	gw_buffer *const buffer[] = { &p->face_cell,   &p->face_share, &p->list_first, &p->list_facet,
								  &p->list_weight, &p->sky,        &p->moving[0],  &p->moving[1] };
	for (size_t i = 0; i < sizeof buffer / sizeof *buffer; i++)
		gw_buffer_destroy(gpu, buffer[i]);
	free(p->entry);
	*p = (gw_propagation){ 0 };
}

static gw_status inject(gw_passes *passes, gw_radiance_volume *v, gw_propagation *p,
						const gw_volume_light *light, gw_error *error)
{
	gw_volume_push push = gw_radiance_volume_push(v);
	push.sky = (vec4){ light->sky[0], light->sky[1], light->sky[2], 0.0f };
	push.batch_count = p->longest > 0 ? p->longest : 1; /* the sky comes with the first */
	const gw_binding bindings[] = { gw_whole(&p->list_first),
									gw_whole(&p->list_facet),
									gw_whole(&p->list_weight),
									gw_whole(p->plane),
									gw_whole(light->facets),
									gw_whole(&p->sky),
									gw_window(&p->moving[0], 16 * push.terms),
									gw_window(&v->radiance, 16 * push.terms) };
	GW_TRY(gw_buffer_fill(passes->gpu, &v->radiance, 0, error));
	GW_TRY(gw_buffer_fill(passes->gpu, &p->moving[0], 0, error));
	return gw_passes_run(passes, GW_PASS_VOLUME_INJECT, bindings, &push, v->count, error);
}

/* Light in *from goes one step on, into *to. */
static gw_status spread(gw_passes *passes, gw_radiance_volume *v, const gw_propagation *p,
						uint32_t from, gw_error *error)
{
	const gw_volume_push push = gw_radiance_volume_push(v);
	const gw_binding bindings[] = { gw_whole(&p->face_cell), gw_whole(&p->face_share),
									gw_whole(&p->moving[from]),
									gw_window(&p->moving[1 - from], 16 * push.terms),
									gw_window(&v->radiance, 16 * push.terms) };
	return gw_passes_run(passes, GW_PASS_VOLUME_SPREAD, bindings, &push, v->count, error);
}

/* Flux that is under way, but for a factor. */
static gw_status measure(gw_gpu *gpu, const gw_radiance_volume *v, const gw_propagation *p,
						 const gw_buffer *moving, double *flux, gw_error *error)
{
	gw_view view = { 0 };
	const uint32_t terms = gw_radiance_volume_terms(v);
	GW_TRY(gw_view_open(gpu, moving, 16 * (uint64_t)terms * v->count, &view, error));
	const float *radiance = view.bytes;
	*flux = 0.0;
	for (size_t i = 0; i < v->count; i++)
		for (size_t c = 0; c < 3; c++)
			*flux += fabs((double)(p->entry[i] * radiance[4 * terms * i + c]));
	gw_view_close(&view);
	return GW_OK;
}

gw_status gw_propagation_fill(gw_passes *passes, gw_radiance_volume *v, gw_propagation *p,
							  const gw_volume_light *light, gw_error *error)
{
	const uint32_t most = STEPS_MOST * (v->cells[0] + v->cells[1] + v->cells[2]);
	double sent, left;
	GW_TRY(inject(passes, v, p, light, error));
	GW_TRY(measure(passes->gpu, v, p, &p->moving[0], &sent, error));
	left = sent;
	for (p->steps = 0; left > GW_PROPAGATION_REST * sent && p->steps < most; p->steps++) {
		GW_TRY(spread(passes, v, p, p->steps % 2, error));
		if (p->steps % LOOK_EVERY == 0)
			GW_TRY(measure(passes->gpu, v, p, &p->moving[1 - p->steps % 2], &left, error));
	}
	return GW_OK;
}
