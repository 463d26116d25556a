/* parted_result.c - see parted_result.h. */
#include "result/parted_result.h"

#include "glowworm_host.h"
#include "points/format.h"
#include "options/output_columns.h"
#include "program/signals.h"
#include "result/lit_scan.h"
#include "scene/glossy_points.h"

#include <time.h>

/* Parts by which is told how far points are from those that were baked. */
#define PARTS_MEASURED 8u

/* Seconds after which what was written is handed to the disk. */
#define SYNC_SECONDS 1

/* A part, and its light once it is lit. */
typedef struct lit_part {
	uint64_t number;
	loaded_scene scene;
	gw_bake_result *light;
	gw_status status; /* of reading it */
	gw_error error;
} lit_part;

static void clear(lit_part *p)
{
	gw_bake_result_destroy(&p->light);
	loaded_scene_clear_part(&p->scene);
}

/* Reads a part. Failure is kept in it, and told when it is lit. To be cleared in any case. */
static void read_part(const parted_result *r, uint64_t number, lit_part *p)
{
	*p = (lit_part){ .number = number };
	p->status = loaded_scene_read_part(r->settings, r->scene, number, &p->scene, &p->error);
}

static gw_status light_part(const parted_result *r, lit_part *p, gw_error *error)
{
	if (p->status != GW_OK) {
		*error = p->error;
		return p->status;
	}
	glossy_points_apply(r->settings, &p->scene);
	GW_TRY(gw_lit_surface_light(r->surface, &p->scene.points.points, &p->light, error));
	return signals_check(error);
}

static gw_status make_lit_scan(const parted_result *r, lit_part *p, const settings *s, scan *lit,
							   gw_error *error)
{
	double exposure;
	*lit = (scan){ 0 };
	gw_status status = light_part(r, p, error);
	if (status == GW_OK)
		status = lit_scan_make(&p->scene, p->light, s, lit, &exposure, error);
	if (status != GW_OK)
		scan_clear(lit);
	return status;
}

gw_status parted_result_light_part(const parted_result *r, uint64_t number, const settings *s,
								   scan *lit, gw_error *error)
{
	lit_part p;
	read_part(r, number, &p);
	gw_status status = make_lit_scan(r, &p, s, lit, error);
	clear(&p);
	return status;
}

/* What is done with one part after the other. */
typedef gw_status part_use(void *user, lit_part *part, gw_error *error);

/* One part is used while the next one is read, each on whichever of two threads. */
typedef struct turn {
	const parted_result *result;
	part_use *use;
	void *user;
	lit_part own, next;
	uint64_t next_number;
	gw_status status;
	gw_error *error;
} turn;

static void take_turn(void *user, size_t first, size_t last, uint32_t worker)
{
	turn *t = user;
	(void)worker;
	for (size_t i = first; i < last; i++)
		if (i == 0)
			t->status = t->use(t->user, &t->own, t->error);
		else
			read_part(t->result, t->next_number, &t->next);
}

/* The first wanted part whose number is at least `from`; the number of parts if there is none. */
typedef uint64_t part_choice(void *user, uint64_t from);

/* Uses a part and reads the next one, if there is one: at the same time where threads are two. */
static void take_turns(turn *t, uint64_t parts)
{
	bool last = t->next_number >= parts;
	if (gw_thread_count(t->result->settings->bake.threads) > 1 && !last) {
		gw_parallel_for(2, 2, 1, take_turn, t);
		clear(&t->own);
		return;
	}
	take_turn(t, 0, 1, 0);
	clear(&t->own);
	if (!last && t->status == GW_OK)
		take_turn(t, 1, 2, 0);
}

/* Uses all parts that are wanted. */
static gw_status for_parts(const parted_result *r, part_choice *choose, part_use *use, void *user,
						   gw_error *error)
{
	uint64_t parts = parted_cloud_parts(r->scene->parted), number = choose(user, 0);
	turn t = { .result = r, .use = use, .user = user, .error = error };
	t.status = signals_check(error);
	if (number < parts && t.status == GW_OK)
		read_part(r, number, &t.own);
	while (number < parts && t.status == GW_OK) {
		t.next = (lit_part){ .light = NULL };
		t.next_number = choose(user, number + 1);
		t.status = signals_check(error);
		if (t.status != GW_OK)
			break;
		take_turns(&t, parts);
		t.own = t.next;
		number = t.next_number;
	}
	clear(&t.own);
	return t.status;
}

/* ------------------------------------------------------------------------------------ the light */

gw_status parted_result_load(const loaded_scene *scene, gw_bake_result **light, gw_error *error)
{
	journal_file *journal = scene->parted->journal;
	const gw_byte_source from = { journal_file_read, journal };
	bool there;
	*light = NULL;
	GW_TRY(journal_file_begin(journal, BAKE_JOURNAL_LIGHT, &there, error));
	if (!there)
		return GW_OK;
	gw_status status = gw_bake_result_load(&from, light, error);
	if (status == GW_OK)
		status = journal_file_end(journal, error);
	if (status == GW_OK && (*light)->count != scene->cloud.count)
		status = gw_fail(error, GW_ERROR_DATA, "%s has the light of other points",
						 journal_file_name(journal));
	if (status != GW_OK)
		gw_bake_result_destroy(light);
	return status;
}

static uint64_t choose_some(void *user, uint64_t from)
{
	const parted_result *r = user;
	uint64_t parts = parted_cloud_parts(r->scene->parted);
	uint64_t step = parts > PARTS_MEASURED ? parts / PARTS_MEASURED : 1;
	return (from + step - 1) / step * step;
}

static gw_status light_only(void *user, lit_part *part, gw_error *error)
{
	return light_part(user, part, error);
}

static gw_status measure(parted_result *r, gw_error *error)
{
	GW_TRY(for_parts(r, choose_some, light_only, r, error));
	gw_lit_surface_report(r->surface, r->scene->parted->file.count, &r->light->report);
	return GW_OK;
}

gw_status parted_result_open(parted_result *r, gw_error *error)
{
	journal_file *journal = r->scene->parted->journal;
	const gw_byte_sink to = { journal_file_write, journal };
	GW_TRY(gw_lit_surface_open(&r->scene->points.points, r->light, &r->settings->bake, &r->surface,
							   error));
	if (r->loaded)
		return GW_OK;
	if (r->settings->tiles == 0)
		GW_TRY(measure(r, error));
	if (!journal)
		return GW_OK;
	GW_TRY(gw_bake_result_save(r->light, &to, error));
	return journal_file_end(journal, error);
}

void parted_result_close(parted_result *r)
{
	gw_lit_surface_close(&r->surface);
}

/* ------------------------------------------------------------------------------------ the points
 */

/* What writing a part takes. */
typedef struct writer {
	const parted_result *result;
	/* Writes a part's columns. */
	gw_status (*use)(struct writer *w, uint64_t number, const scan *lit, gw_error *error);
	settings settings; /* with the exposure; nothing of it is freed */
	output_file *out;
	uint64_t head, row;      /* bytes of the file's head and of a point; 0: not known yet */
	time_t synced;           /* when what was written went to the disk */
	uint64_t parts, written; /* parts that are to be written, and are, of all ranks */
} writer;

static gw_status start(const parted_result *r, output_file *out, double *exposure, writer *w,
					   gw_error *error)
{
	*w = (writer){ .result = r,
				   .settings = *r->settings,
				   .out = out,
				   .parts = parted_cloud_parts(r->scene->parted),
				   .synced = time(NULL) };
	GW_TRY(lit_scan_meter(r->scene, r->light, r->settings, exposure, error));
	w->settings.exposure = (float)*exposure;
	return GW_OK;
}

static gw_status write_head(const writer *w, const scan *lit, gw_error *error)
{
	const parted_result *r = w->result;
	output_columns_note(r->format, lit, r->settings->quiet);
	return r->format->parted->write_head(w->out, &r->scene->parted->whole, lit, error);
}

/* Lights a part and writes it. */
static gw_status write_part(void *user, lit_part *part, gw_error *error)
{
	writer *w = user;
	scan lit;
	GW_TRY(make_lit_scan(w->result, part, &w->settings, &lit, error));
	gw_status status = w->use(w, part->number, &lit, error);
	scan_clear(&lit);
	GW_TRY(status);
	w->written += w->result->ranks.count; /* the others are as far */
	double done = (double)w->written / (double)w->parts;
	progress_show(w->result->progress, "write", done < 1.0 ? done : 1.0);
	return GW_OK;
}

static uint64_t choose_all(void *user, uint64_t from)
{
	(void)user;
	return from;
}

static gw_status append(writer *w, uint64_t number, const scan *lit, gw_error *error)
{
	if (number == 0)
		GW_TRY(write_head(w, lit, error));
	const parted_result *r = w->result;
	return r->format->parted->write_rows(w->out, &r->scene->parted->whole, lit, error);
}

gw_status parted_result_write(const parted_result *r, output_file *out, double *exposure,
							  gw_error *error)
{
	writer w;
	GW_TRY(start(r, out, exposure, &w, error));
	w.use = append;
	GW_TRY(for_parts(r, choose_all, write_part, &w, error));
	return r->format->parted->write_end
			   ? r->format->parted->write_end(out, &r->scene->parted->whole, error)
			   : GW_OK;
}

/* ---------------------------------------------------------------------- those that are not written
 */

/* How long the head and a row are, by the first part of this run; and so how long the file. */
static gw_status measure_file(writer *w, const scan *lit, gw_error *error)
{
	checksum sum;
	size_t row;
	const parted_cloud *parted = w->result->scene->parted;
	GW_TRY(format_whole_row(w->result->format, &parted->whole, lit, &row, error));
	w->row = row;
	GW_TRY(output_file_seek(w->out, 0, error));
	GW_TRY(write_head(w, lit, error));
	GW_TRY(output_file_written(w->out, &sum, error));
	w->head = sum.length;
	return output_file_resize(w->out, w->head + w->row * parted->file.count, error);
}

/* What fails together with the machine is not to be more than what was written since. */
static gw_status sync_sometimes(writer *w, gw_error *error)
{
	time_t now = time(NULL);
	if (now < w->synced + SYNC_SECONDS)
		return GW_OK;
	w->synced = now;
	GW_TRY(output_file_sync(w->out, error));
	return journal_file_sync(w->result->scene->parted->journal, error);
}

/* The head belongs to the first part. */
static gw_status put_in_place(writer *w, uint64_t number, const scan *lit, gw_error *error)
{
	const parted_cloud *parted = w->result->scene->parted;
	checksum sum;
	if (w->row == 0)
		GW_TRY(measure_file(w, lit, error));
	uint64_t before = number * parted->part, at = number > 0 ? w->head + w->row * before : 0;
	GW_TRY(output_file_seek(w->out, at, error));
	GW_TRY(append(w, number, lit, error));
	GW_TRY(output_file_written(w->out, &sum, error));
	const journal_slot slot = { at, sum.length, checksum_value(&sum) };
	GW_TRY(journal_file_put(parted->journal, number, &slot, error));
	return sync_sometimes(w, error);
}

/* The next part of this rank that is not written yet. */
static uint64_t choose_unwritten(void *user, uint64_t from)
{
	writer *w = user;
	const ranks *all = &w->result->ranks;
	uint64_t number = from;
	journal_slot slot;
	while (number % all->count != all->rank)
		number++;
	for (; number < w->parts && !signals_pending(); number += all->count) {
		if (!journal_file_get(w->result->scene->parted->journal, number, &slot) ||
			!output_file_holds(w->out, slot.offset, slot.length, slot.value))
			break;
		w->written += all->count;
	}
	return number;
}

gw_status parted_result_go_on(const parted_result *r, output_file *out, double *exposure,
							  gw_error *error)
{
	writer w;
	GW_TRY(start(r, out, exposure, &w, error));
	w.use = put_in_place;
	GW_TRY(journal_file_slots(r->scene->parted->journal, w.parts, error));
	GW_TRY(for_parts(r, choose_unwritten, write_part, &w, error));
	GW_TRY(output_file_sync(out, error));
	return ranks_wait(&r->ranks, error);
}
