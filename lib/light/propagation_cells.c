/*
 * propagation_cells.c - gw_propagation_make of propagation.h: what sends light into which cell, and
 * which cells see each other. What surface sends goes into the cells that it would read, by the
 * same weights.
 */
#include "light/propagation.h"

#include "base/harmonic_values.h"
#include "base/memory.h"
#include "light/volume_places.h"
#include "octree/compartments.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define FACES GW_CELL_FACES
#define WEIGHTS GW_VOLUME_WEIGHTS

/* Sides of surface that are looked at in a run. */
#define CHUNK 65536u

/* A side of surface that sends light. */
typedef struct senders {
	size_t count;
	uint32_t *word;           /* facet, + GW_SENDS_BACK */
	float *area;              /* in faces of a cell */
	float *position, *normal; /* 4 each */
	uint32_t *cell;           /* WEIGHTS each: cells that it sends into, up to GW_NONE */
	float *weight;            /* likewise: its share; together 1 */
} senders;

/* All that lasts as long as a propagation is made. */
typedef struct making {
	const gw_record_context *on;
	const gw_radiance_volume *volume;
	gw_propagation *p;
	senders from;
	uint32_t *neighbour; /* FACES a cell: number, GW_NONE, or END where the grid ends */
	float *through;      /* likewise: share of light that gets there */
} making;

/* What lies behind a face at the grid's end. */
#define END (GW_NONE - 1u)

static gw_status no_memory(const making *m, gw_error *error)
{
	return gw_fail(error, GW_ERROR_MEMORY, "no memory for the light of %u cells", m->volume->count);
}

/* ---------------------------------------------------------------------------------- surface */

/* Host copies of what the facets are; 4 floats a facet. */
typedef struct facets {
	size_t count;
	gw_view centre, plane, albedo;
} facets;

static gw_status open_facets(const making *m, facets *f, gw_error *error)
{
	gw_gpu *gpu = m->on->passes->gpu;
	const gw_octree *o = m->on->octree;
	f->count = o->facet_count;
	GW_TRY(gw_view_open(gpu, &o->facet_centre, 16 * f->count, &f->centre, error));
	GW_TRY(gw_view_open(gpu, &o->facet_plane, 16 * f->count, &f->plane, error));
	return gw_view_open(gpu, &o->facet_albedo, 16 * f->count, &f->albedo, error);
}

/* Sides of a facet that send light: none, one or both. */
static int sides_of(const facets *f, size_t facet)
{
	if (!(((const float *)f->centre.bytes)[4 * facet + 3] > 0.0f))
		return 0;
	return floorf(((const float *)f->albedo.bytes)[4 * facet + 3]) > 0.0f ? 2 : 1;
}

static void take(making *m, const facets *f, size_t facet, bool back)
{
	senders *s = &m->from;
	const float *centre = (const float *)f->centre.bytes + 4 * facet;
	const float *plane = (const float *)f->plane.bytes + 4 * facet;
	const float size = m->volume->size;
	for (size_t k = 0; k < 3; k++) {
		s->position[4 * s->count + k] = centre[k];
		s->normal[4 * s->count + k] = back ? -plane[k] : plane[k];
	}
	s->area[s->count] = centre[3] / (size * size);
	s->word[s->count++] = (uint32_t)facet + (back ? GW_SENDS_BACK : 0u);
}

static gw_status list_senders(making *m, const facets *f, gw_error *error)
{
	senders *s = &m->from;
	size_t count = 0;
	for (size_t facet = 0; facet < f->count; facet++)
		count += (size_t)sides_of(f, facet);
	s->word = gw_allocate_array(count, sizeof *s->word);
	s->area = gw_allocate_array(count, sizeof *s->area);
	s->position = gw_allocate_zeros(count, 4 * sizeof *s->position);
	s->normal = gw_allocate_zeros(count, 4 * sizeof *s->normal);
	s->cell = gw_allocate_array(count, WEIGHTS * sizeof *s->cell);
	s->weight = gw_allocate_array(count, WEIGHTS * sizeof *s->weight);
	if (!s->word || !s->area || !s->position || !s->normal || !s->cell || !s->weight)
		return no_memory(m, error);
	for (size_t facet = 0; facet < f->count; facet++)
		for (int side = 0; side < sides_of(f, facet); side++)
			take(m, f, facet, side == 1);
	return GW_OK;
}

/* Texels of a buffer that is filled from the host. */
#define TEXELS(format, bytes, name)                                                                \
	(&(gw_buffer_description){ GW_BUFFER_TEXEL, VK_FORMAT_##format, (bytes), (name) })

static gw_status upload(gw_gpu *gpu, const gw_buffer_description *of, const void *values,
						gw_buffer *buffer, gw_error *error)
{
	gw_buffer_description room = *of;
	if (of->bytes == 0) /* where nothing is listed, there is a word all the same */
		room.bytes = 16;
	GW_TRY(gw_buffer_create(gpu, &room, buffer, error));
	return of->bytes > 0 ? gw_buffer_upload(gpu, buffer, 0, values, of->bytes, error) : GW_OK;
}

/* The front of a facet looks into what that does, as of records (shut_out.c). */
static void label_fronts(const making *m, const uint32_t *word, size_t count, uint32_t *label)
{
	const uint32_t *of = gw_compartments_of_facets(m->on->octree);
	for (size_t i = 0; i < count && of; i++)
		if ((word[i] & GW_SENDS_BACK) == 0 && of[word[i]] != GW_COMPARTMENT_UNKNOWN)
			label[i] = of[word[i]];
}

/* Compartments that senders look into; NULL where there is one. */
static gw_status label_senders(const making *m, size_t first, size_t count, uint32_t **label,
							   gw_error *error)
{
	const senders *s = &m->from;
	*label = NULL;
	if (!gw_compartments_several(m->on->octree))
		return GW_OK;
	*label = gw_allocate_array(count, sizeof **label);
	if (!*label)
		return no_memory(m, error);
	const gw_surface_places of = { count, s->position + 4 * first, s->normal + 4 * first };
	gw_status status = gw_compartments_of_places(m->on->passes, m->on->octree, &of, *label, error);
	if (status == GW_OK)
		label_fronts(m, s->word + first, count, *label);
	return status;
}

static gw_status weigh_some(making *m, size_t first, size_t count, gw_buffer place[2],
							gw_error *error)
{
	gw_gpu *gpu = m->on->passes->gpu;
	const senders *s = &m->from;
	const uint64_t bytes = 4 * (uint64_t)WEIGHTS * count;
	gw_volume_viewers viewers = { &place[0], &place[1], (uint32_t)count, NULL };
	gw_volume_rows rows = { 0 };
	GW_TRY(upload(gpu, TEXELS(R32G32B32A32_SFLOAT, 16 * count, "senders"), s->position + 4 * first,
				  &place[0], error));
	GW_TRY(upload(gpu, TEXELS(R32G32B32A32_SFLOAT, 16 * count, "their normals"),
				  s->normal + 4 * first, &place[1], error));
	gw_status status = label_senders(m, first, count, &viewers.label, error);
	if (status == GW_OK)
		status = gw_volume_weigh(m->on, m->volume, &viewers, &rows, error);
	free(viewers.label);
	GW_TRY(status);
	status = gw_buffer_download(gpu, &rows.cell, 0, s->cell + WEIGHTS * first, bytes, error);
	if (status == GW_OK)
		status =
			gw_buffer_download(gpu, &rows.weight, 0, s->weight + WEIGHTS * first, bytes, error);
	gw_volume_rows_destroy(gpu, &rows);
	return status;
}

static gw_status weigh_senders(making *m, gw_error *error)
{
	gw_gpu *gpu = m->on->passes->gpu;
	gw_status status = GW_OK;
	for (size_t first = 0; first < m->from.count && status == GW_OK; first += CHUNK) {
		gw_buffer place[2] = { { 0 }, { 0 } };
		size_t left = m->from.count - first;
		status = weigh_some(m, first, left < CHUNK ? left : CHUNK, place, error);
		gw_buffer_destroy(gpu, &place[0]);
		gw_buffer_destroy(gpu, &place[1]);
	}
	return status;
}

static gw_status find_senders(making *m, gw_error *error)
{
	facets f = { .count = 0 };
	gw_status status = open_facets(m, &f, error);
	if (status == GW_OK)
		status = list_senders(m, &f, error);
	gw_view_close(&f.centre);
	gw_view_close(&f.plane);
	gw_view_close(&f.albedo);
	return status == GW_OK ? weigh_senders(m, error) : status;
}

/* ------------------------------------------------------------------------------------ faces */

/* The number of the cell behind each face. */
static gw_status find_neighbours(making *m, gw_error *error)
{
	const gw_radiance_volume *v = m->volume;
	const size_t cells = (size_t)v->cells[0] * v->cells[1] * v->cells[2];
	const size_t step[3] = { 1, v->cells[0], (size_t)v->cells[0] * v->cells[1] };
	uint32_t *slot = gw_allocate_array(cells, sizeof *slot);
	m->neighbour = gw_allocate_array(v->count, FACES * sizeof *m->neighbour);
	if (!slot || !m->neighbour) {
		free(slot);
		return no_memory(m, error);
	}
	memset(slot, 0xff, cells * sizeof *slot); /* GW_NONE */
	for (uint32_t i = 0; i < v->count; i++)
		slot[v->cell[i]] = i;
	for (size_t i = 0; i < v->count; i++)
		for (size_t k = 0; k < 3; k++) {
			const size_t cell = v->cell[i], at = cell / step[k] % v->cells[k];
			uint32_t *to = m->neighbour + FACES * i + 2 * k;
			to[0] = at > 0 ? slot[cell - step[k]] : END;
			to[1] = at + 1 < v->cells[k] ? slot[cell + step[k]] : END;
		}
	free(slot);
	return GW_OK;
}

static gw_status look_through(making *m, gw_buffer *found, gw_error *error)
{
	gw_passes *passes = m->on->passes;
	const gw_octree *o = m->on->octree;
	const uint64_t faces = (uint64_t)FACES * m->volume->count;
	GW_TRY(gw_buffer_create(passes->gpu,
							&(gw_buffer_description){ GW_BUFFER_STORAGE, VK_FORMAT_UNDEFINED,
													  4 * faces, "light through faces" },
							found, error));
	const gw_binding bindings[] = { GW_TRACE_BINDINGS(o), gw_whole(&m->volume->centre),
									gw_window(found, 4),  GW_DISC_BINDINGS(o),
									GW_TREE_BINDING(o),   GW_OPACITY_BINDING(o),
									GW_LEAF_BINDING(o) };
	const gw_volume_push push = gw_radiance_volume_push(m->volume);
	GW_TRY(gw_passes_run(passes, GW_PASS_VOLUME_FACES, bindings, &push, faces, error));
	return gw_buffer_download(passes->gpu, found, 0, m->through, 4 * faces, error);
}

/* Does rock keep a cell apart from what lies behind its face? */
static bool is_apart(const making *m, size_t cell, uint32_t neighbour)
{
	const uint32_t *label = m->volume->label;
	if (!label)
		return false;
	return gw_compartments_apart(
		label[cell], neighbour == END ? gw_compartment_outside(m->on->octree) : label[neighbour]);
}

/* Of both ways through a face the one that is seen less counts: rays do not know the backs of what
 * is very near. */
static void agree(making *m)
{
	for (size_t i = 0; i < FACES * (size_t)m->volume->count; i++) {
		const uint32_t other = m->neighbour[i];
		const size_t back = other < END ? FACES * (size_t)other + (i % FACES ^ 1u) : i;
		if (other == GW_NONE || is_apart(m, i / FACES, other))
			m->through[i] = 0.0f;
		else if (back >= i)
			m->through[i] = m->through[back] = fminf(m->through[i], m->through[back]);
	}
}

static gw_status find_faces(making *m, gw_error *error)
{
	gw_buffer found = { 0 };
	m->through = gw_allocate_array(m->volume->count, FACES * sizeof *m->through);
	if (!m->through)
		return no_memory(m, error);
	GW_TRY(find_neighbours(m, error));
	gw_status status = look_through(m, &found, error);
	gw_buffer_destroy(m->on->passes->gpu, &found);
	if (status == GW_OK)
		agree(m);
	return status;
}

/* ----------------------------------------------------------------------------- what is kept */

/* Behind faces that are closed there is surface, too, where it sends into other cells: light in a
 * passage one cell wide would gain with every step if but its two open faces counted. Steps along
 * it gain nothing from 6 (4/9 + 1/9) faces on, of which a lobe sends 4/9 ahead and 1/9 back; around
 * a corner it sends 1/6, and gains nothing whatever is open. */
static float least_entry(const float through[FACES])
{
	float straight = 0.0f;
	for (size_t face = 0; face < FACES; face += 2)
		straight = fmaxf(straight, fminf(through[face], through[face + 1]));
	return straight * 10.0f / 3.0f;
}

/* The area through which light gets into each cell: of its faces, and of what sends into it. */
static gw_status add_areas(making *m, gw_error *error)
{
	const senders *s = &m->from;
	float *entry = m->p->entry = gw_allocate_zeros(m->volume->count, sizeof *entry);
	if (!entry)
		return no_memory(m, error);
	for (size_t i = 0; i < FACES * (size_t)m->volume->count; i++)
		entry[i / FACES] += m->through[i];
	for (size_t i = 0; i < WEIGHTS * s->count; i++) {
		if (s->cell[i] == GW_NONE)
			i |= WEIGHTS - 1; /* the row ends */
		else
			entry[s->cell[i]] += s->area[i / WEIGHTS] * s->weight[i];
	}
	for (size_t i = 0; i < m->volume->count; i++)
		entry[i] = fmaxf(entry[i], least_entry(m->through + FACES * i));
	return GW_OK;
}

/* Shares of light in its neighbours that a cell gets, and of the sky. */
static gw_status keep_faces(making *m, gw_error *error)
{
	gw_gpu *gpu = m->on->passes->gpu;
	const size_t count = m->volume->count;
	float *sky = gw_allocate_zeros(count, 4 * sizeof *sky);
	if (!sky)
		return no_memory(m, error);
	for (size_t i = 0; i < FACES * count; i++) {
		const float entry = m->p->entry[i / FACES], side = i & 1 ? 1.0f : -1.0f;
		const float share = entry > 0.0f ? m->through[i] / entry : 0.0f;
		float d[3] = { 0.0f };
		d[i % FACES / 2] = side;
		for (uint32_t j = 0; j < 4 && m->neighbour[i] == END; j++)
			sky[4 * (i / FACES) + j] +=
				4.0f * share * harmonic_cosine(j) * harmonic_value(j, d[0], d[1], d[2]);
		m->through[i] = (float)FACES * share;
		if (m->neighbour[i] == END || !(share > 0.0f))
			m->neighbour[i] = GW_NONE;
	}
	gw_status status = upload(gpu, TEXELS(R32_UINT, 4 * FACES * count, "neighbours of cells"),
							  m->neighbour, &m->p->face_cell, error);
	if (status == GW_OK)
		status = upload(gpu, TEXELS(R32_SFLOAT, 4 * FACES * count, "shares of neighbours"),
						m->through, &m->p->face_share, error);
	if (status == GW_OK)
		status = upload(gpu, TEXELS(R32G32B32A32_SFLOAT, 16 * count, "sky of cells"), sky,
						&m->p->sky, error);
	free(sky);
	return status;
}

/* Lists under way. */
typedef struct lists {
	uint32_t *first; /* a cell and the end; while they are filled, where the next one goes */
	uint32_t *facet;
	float *weight;
} lists;

/* Counts what each cell's list will hold, and where that begins. */
static void lay_out_lists(making *m, lists *l)
{
	const senders *s = &m->from;
	for (size_t i = 0; i < WEIGHTS * s->count; i++) {
		if (s->cell[i] == GW_NONE)
			i |= WEIGHTS - 1;
		else
			l->first[s->cell[i] + 1]++;
	}
	for (size_t i = 0; i < m->volume->count; i++) {
		if (l->first[i + 1] > m->p->longest)
			m->p->longest = l->first[i + 1];
		l->first[i + 1] += l->first[i];
	}
}

static void fill_lists(const making *m, lists *l)
{
	const senders *s = &m->from;
	for (size_t i = 0; i < WEIGHTS * s->count; i++) {
		if (s->cell[i] == GW_NONE) {
			i |= WEIGHTS - 1;
			continue;
		}
		const float entry = m->p->entry[s->cell[i]];
		const uint32_t at = l->first[s->cell[i]]++;
		l->facet[at] = s->word[i / WEIGHTS];
		l->weight[at] = entry > 0.0f ? 4.0f * s->area[i / WEIGHTS] * s->weight[i] / entry : 0.0f;
	}
	memmove(l->first + 1, l->first, m->volume->count * sizeof *l->first);
	l->first[0] = 0;
}

static gw_status upload_lists(const making *m, const lists *l, gw_error *error)
{
	gw_gpu *gpu = m->on->passes->gpu;
	const size_t count = m->volume->count, length = l->first[count];
	GW_TRY(upload(gpu, TEXELS(R32_UINT, 4 * (count + 1), "lists of senders"), l->first,
				  &m->p->list_first, error));
	GW_TRY(upload(gpu, TEXELS(R32_UINT, 4 * length, "senders of cells"), l->facet,
				  &m->p->list_facet, error));
	return upload(gpu, TEXELS(R32_SFLOAT, 4 * length, "weights of senders"), l->weight,
				  &m->p->list_weight, error);
}

static gw_status keep_lists(making *m, gw_error *error)
{
	const size_t most = WEIGHTS * m->from.count;
	lists l = { gw_allocate_zeros((size_t)m->volume->count + 1, sizeof *l.first),
				gw_allocate_array(most, sizeof *l.facet),
				gw_allocate_array(most, sizeof *l.weight) };
	gw_status status = l.first && l.facet && l.weight ? GW_OK : no_memory(m, error);
	if (status == GW_OK) {
		lay_out_lists(m, &l);
		fill_lists(m, &l);
		status = upload_lists(m, &l, error);
	}
	free(l.first);
	free(l.facet);
	free(l.weight);
	return status;
}

static gw_status make_moving(making *m, gw_error *error)
{
	const uint64_t bytes = 16 * (uint64_t)gw_radiance_volume_terms(m->volume) * m->volume->count;
	for (int i = 0; i < 2; i++)
		GW_TRY(gw_buffer_create(m->on->passes->gpu,
								&(gw_buffer_description){ GW_BUFFER_TEXEL,
														  VK_FORMAT_R32G32B32A32_SFLOAT, bytes,
														  "light between cells" },
								&m->p->moving[i], error));
	return GW_OK;
}

static gw_status make(making *m, gw_error *error)
{
	GW_TRY(find_senders(m, error));
	GW_TRY(find_faces(m, error));
	GW_TRY(add_areas(m, error));
	GW_TRY(keep_faces(m, error));
	GW_TRY(keep_lists(m, error));
	return make_moving(m, error);
}

gw_status gw_propagation_make(const gw_record_context *on, const gw_radiance_volume *volume,
							  gw_propagation *p, gw_error *error)
{
	making m = { .on = on, .volume = volume, .p = p };
	*p = (gw_propagation){ .plane = &on->octree->facet_plane };
	gw_status status = make(&m, error);
	free(m.from.word);
	free(m.from.area);
	free(m.from.position);
	free(m.from.normal);
	free(m.from.cell);
	free(m.from.weight);
	free(m.neighbour);
	free(m.through);
	if (status != GW_OK)
		gw_propagation_destroy(on->passes->gpu, p);
	return status;
}
