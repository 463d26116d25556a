/*
 * result_bytes.c - the light of points as bytes, and from bytes: see glowworm_parts.h.
 */
#include "base/memory.h"
#include "glowworm_parts.h"

#include <stdlib.h>
#include <string.h>

/* Arrays of points, in this order; as many as are there. */
enum { ARRAYS = 11 };

/* What goes before the arrays. Numbers are as memory has them: the version and the sizes of structs
 * say whether whoever reads has them alike. */
typedef struct head {
	char version[16];
	uint64_t report_bytes, count, lamps, lights, bounces;
	uint32_t arrays; /* 1 << its place in the list, of those that are there */
	uint32_t stray, asked, given;
	double gathered_share;
} head;

typedef struct array {
	float **values;
	size_t width; /* numbers a point */
} array;

static void list_arrays(gw_bake_result *r, array list[ARRAYS])
{
	const array all[ARRAYS] = { { &r->radiance, 3 },
								{ &r->direct_irradiance, 3 },
								{ &r->indirect_irradiance, 3 },
								{ &r->normal, 3 },
								{ &r->albedo, 3 },
								{ &r->rest, 3 },
								{ &r->bent_normal, 3 },
								{ &r->ambient_occlusion, 1 },
								{ &r->error, 1 },
								{ &r->unknown, 1 },
								{ &r->roi, 1 } };
	memcpy(list, all, sizeof all);
}

static head head_of(const gw_bake_result *r, const array list[ARRAYS])
{
	head h;
	memset(&h, 0, sizeof h);
	memcpy(h.version, GW_VERSION, sizeof GW_VERSION);
	h.report_bytes = sizeof r->report;
	h.count = r->count;
	h.lamps = r->lamp ? r->lamp_count : 0;
	h.lights = r->given ? r->given_count : 0;
	h.bounces = r->report.bounce_count;
	for (uint32_t k = 0; k < ARRAYS; k++)
		h.arrays |= *list[k].values ? 1u << k : 0;
	h.stray = r->stray != NULL;
	h.asked = r->asked != NULL;
	h.given = r->given != NULL;
	h.gathered_share = r->gathered_share;
	return h;
}

/* ------------------------------------------------------------------------------------ to bytes */

static gw_status put(const gw_byte_sink *to, const void *bytes, size_t count, size_t size,
					 gw_error *error)
{
	return count > 0 ? to->write(to->user, bytes, count * size, error) : GW_OK;
}

static gw_status put_numbers(const gw_bake_result *r, const head *h, const gw_byte_sink *to,
							 gw_error *error)
{
	gw_report report = r->report;
	report.bounce = NULL;
	GW_TRY(put(to, h, 1, sizeof *h, error));
	GW_TRY(put(to, &report, 1, sizeof report, error));
	GW_TRY(put(to, r->report.bounce, h->bounces, sizeof *r->report.bounce, error));
	return put(to, r->given, h->lights, sizeof *r->given, error);
}

gw_status gw_bake_result_save(const gw_bake_result *result, const gw_byte_sink *to, gw_error *error)
{
	gw_bake_result r = *result; /* nothing of it is freed */
	array list[ARRAYS];
	list_arrays(&r, list);
	const head h = head_of(&r, list);
	GW_TRY(put_numbers(&r, &h, to, error));
	for (size_t k = 0; k < ARRAYS; k++)
		if (*list[k].values)
			GW_TRY(put(to, *list[k].values, r.count, list[k].width * sizeof(float), error));
	for (size_t k = 0; k < h.lamps; k++)
		GW_TRY(put(to, r.lamp[k], r.count, 3 * sizeof(float), error));
	if (r.stray)
		GW_TRY(put(to, r.stray, r.count, 1, error));
	return r.asked ? put(to, r.asked, r.count, 1, error) : GW_OK;
}

/* ---------------------------------------------------------------------------------- from bytes */

/* Points that a result can have, and lights: what is more is damage. */
#define POINTS_MAX (UINT64_C(1) << 31)
#define LIGHTS_MAX (UINT64_C(1) << 20)

static gw_status check_head(const head *h, gw_error *error)
{
	if (strncmp(h->version, GW_VERSION, sizeof h->version) != 0 ||
		h->report_bytes != sizeof(gw_report))
		return gw_fail(error, GW_ERROR_DATA, "the light is of another version of glowworm");
	if (h->count == 0 || h->count > POINTS_MAX || h->lamps > LIGHTS_MAX || h->lights > LIGHTS_MAX ||
		h->bounces > LIGHTS_MAX || h->arrays >> ARRAYS != 0)
		return gw_fail(error, GW_ERROR_DATA, "the light is damaged");
	return GW_OK;
}

/* Room for what comes, and what comes. */
static gw_status take(const gw_byte_source *from, size_t count, size_t size, void *made,
					  gw_error *error)
{
	void *room = gw_allocate_array(count + 1, size);
	memcpy(made, &room, sizeof room);
	if (!room)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the light of %zu points", count);
	return count > 0 ? from->read(from->user, room, count * size, error) : GW_OK;
}

static gw_status take_numbers(const gw_byte_source *from, head *h, gw_bake_result *r,
							  gw_error *error)
{
	GW_TRY(from->read(from->user, h, sizeof *h, error));
	GW_TRY(check_head(h, error));
	GW_TRY(from->read(from->user, &r->report, sizeof r->report, error));
	r->report.bounce = NULL;
	r->report.bounce_count = (uint32_t)h->bounces;
	r->count = (size_t)h->count;
	r->gathered_share = h->gathered_share;
	if (h->bounces > 0)
		GW_TRY(take(from, (size_t)h->bounces, sizeof *r->report.bounce, &r->report.bounce, error));
	r->given_count = (size_t)h->lights;
	return h->given ? take(from, (size_t)h->lights, sizeof *r->given, &r->given, error) : GW_OK;
}

static gw_status take_lamps(const gw_byte_source *from, const head *h, gw_bake_result *r,
							gw_error *error)
{
	if (h->lamps == 0)
		return GW_OK;
	r->lamp = gw_allocate_zeros((size_t)h->lamps, sizeof *r->lamp);
	if (!r->lamp)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu lights", (size_t)h->lamps);
	r->lamp_count = (size_t)h->lamps;
	for (size_t k = 0; k < r->lamp_count; k++)
		GW_TRY(take(from, r->count, 3 * sizeof(float), &r->lamp[k], error));
	return GW_OK;
}

static gw_status take_all(const gw_byte_source *from, gw_bake_result *r, gw_error *error)
{
	head h;
	array list[ARRAYS];
	list_arrays(r, list);
	GW_TRY(take_numbers(from, &h, r, error));
	for (uint32_t k = 0; k < ARRAYS; k++)
		if (h.arrays & 1u << k)
			GW_TRY(take(from, r->count, list[k].width * sizeof(float), list[k].values, error));
	GW_TRY(take_lamps(from, &h, r, error));
	if (h.stray)
		GW_TRY(take(from, r->count, 1, &r->stray, error));
	return h.asked ? take(from, r->count, 1, &r->asked, error) : GW_OK;
}

gw_status gw_bake_result_load(const gw_byte_source *from, gw_bake_result **result, gw_error *error)
{
	*result = gw_allocate_zeros(1, sizeof **result);
	if (!*result)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the light of points");
	gw_status status = take_all(from, *result, error);
	if (status != GW_OK)
		gw_bake_result_destroy(result);
	return status;
}
