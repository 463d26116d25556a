#include "page/page_file.h"
#include "glowworm_host.h"
#include "page/page_json.h"
#include "program/signals.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#define BATCH 16 /* blocks that are packed at once */

/* The document and what is put into it, as bytes of the program. */
static const unsigned char document[] = {
#include "page/page.html.inc"
};
static const unsigned char style[] = {
#include "page/page.css.inc"
};
static const unsigned char program[] = {
#include "page/page.js.inc"
};

/* A block of points, packed, deflated and in base64. */
typedef struct block {
	char *text; /* owned; NULL: memory was short */
	size_t length;
} block;

typedef struct packing {
	const page_points *points;
	size_t count;       /* points of all blocks */
	size_t first_block; /* of the batch */
	block block[BATCH];
} packing;

/* -------------------------------------------------------------------------------- blocks */

static size_t base64_length(size_t bytes)
{
	return (bytes + 2) / 3 * 4;
}

static void base64(const uint8_t *bytes, size_t count, char *to)
{
	static const char digit[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
	for (size_t i = 0; i < count; i += 3) {
		size_t left = count - i;
		uint32_t word = (uint32_t)bytes[i] << 16 | (left > 1 ? (uint32_t)bytes[i + 1] << 8 : 0u) |
						(left > 2 ? bytes[i + 2] : 0u);
		*to++ = digit[word >> 18];
		*to++ = digit[word >> 12 & 63];
		*to++ = left > 1 ? digit[word >> 6 & 63] : '=';
		*to++ = left > 2 ? digit[word & 63] : '=';
	}
}

/* Bytes without zlib's frame, which browsers inflate by themselves. NULL when memory is short; for
 * free(). */
static uint8_t *deflate_raw(const uint8_t *bytes, size_t count, size_t *made)
{
	z_stream z = { .next_in = (uint8_t *)(uintptr_t)bytes, /* which is only read */
				   .avail_in = (uInt)count };
	if (deflateInit2(&z, Z_DEFAULT_COMPRESSION, Z_DEFLATED, -MAX_WBITS, MAX_MEM_LEVEL,
					 Z_DEFAULT_STRATEGY) != Z_OK)
		return NULL;
	uLong room = deflateBound(&z, (uLong)count);
	uint8_t *to = malloc(room);
	z.next_out = to;
	z.avail_out = to ? (uInt)room : 0;
	bool whole = to && deflate(&z, Z_FINISH) == Z_STREAM_END;
	*made = z.total_out;
	deflateEnd(&z);
	if (whole)
		return to;
	free(to);
	return NULL;
}

static void pack_block(const packing *p, size_t first, size_t count, block *to)
{
	size_t bytes = page_points_bytes(p->points, count), made = 0;
	uint8_t *plain = malloc(bytes);
	if (!plain)
		return;
	page_points_pack(p->points, first, count, plain);
	uint8_t *packed = deflate_raw(plain, bytes, &made);
	free(plain);
	to->length = base64_length(made);
	to->text = packed ? malloc(to->length) : NULL;
	if (to->text)
		base64(packed, made, to->text);
	free(packed);
}

static void pack_blocks(void *user, size_t first, size_t last, uint32_t worker)
{
	(void)worker;
	packing *p = user;
	for (size_t b = first; b < last; b++) {
		size_t at = (p->first_block + b) * PAGE_BLOCK, left = p->count - at;
		pack_block(p, at, left < PAGE_BLOCK ? left : PAGE_BLOCK, &p->block[b]);
	}
}

/* ---------------------------------------------------------------------------------- file */

typedef struct writer {
	output_file *out;
	uint64_t bytes;
	gw_error *error;
} writer;

static gw_status put(writer *w, const void *text, size_t length)
{
	w->bytes += length;
	return output_file_write(w->out, text, length, w->error);
}

static gw_status put_text(writer *w, const char *text)
{
	return put(w, text, strlen(text));
}

static gw_status write_batch(writer *w, const packing *p, size_t count)
{
	for (size_t b = 0; b < count; b++) {
		if (!p->block[b].text)
			return gw_fail(w->error, GW_ERROR_MEMORY, "no memory for a block of points");
		GW_TRY(put_text(w, "<script>glowworm.add(\""));
		GW_TRY(put(w, p->block[b].text, p->block[b].length));
		GW_TRY(put_text(w, "\")</script>\n"));
	}
	return signals_check(w->error);
}

static gw_status write_blocks(writer *w, const page_points *points, size_t count, uint32_t threads)
{
	size_t blocks = (count + PAGE_BLOCK - 1) / PAGE_BLOCK;
	gw_status status = GW_OK;
	for (size_t first = 0; first < blocks && status == GW_OK; first += BATCH) {
		packing p = { .points = points, .count = count, .first_block = first };
		size_t together = blocks - first < BATCH ? blocks - first : BATCH;
		gw_parallel_for(threads, together, 1, pack_blocks, &p);
		status = write_batch(w, &p, together);
		for (size_t b = 0; b < together; b++)
			free(p.block[b].text);
	}
	return status;
}

/* What a name in the document stands for. */
typedef struct part {
	const char *name;
	const void *text;
	size_t length;
} part;

/* Writes the document up to @POINTS@, with its parts put in, and returns what follows. */
static gw_status write_head(writer *w, const part *parts, size_t count, const unsigned char **rest)
{
	const unsigned char *at = document, *end = document + sizeof document;
	*rest = end;
	while (at < end) {
		const unsigned char *mark = memchr(at, '@', (size_t)(end - at));
		GW_TRY(put(w, at, (size_t)((mark ? mark : end) - at)));
		if (!mark)
			break;
		const unsigned char *last = memchr(mark + 1, '@', (size_t)(end - mark - 1));
		assert(last);
		size_t length = (size_t)(last - mark - 1);
		at = last + 1;
		if (length == 6 && memcmp(mark + 1, "POINTS", 6) == 0) {
			*rest = at;
			return GW_OK;
		}
		for (size_t p = 0; p < count; p++)
			if (strlen(parts[p].name) == length && memcmp(mark + 1, parts[p].name, length) == 0)
				GW_TRY(put(w, parts[p].text, parts[p].length));
	}
	return GW_OK;
}

static gw_status write_all(writer *w, const page_points *points, const char *scene,
						   uint32_t threads)
{
	const unsigned char *rest;
	const part parts[] = { { "STYLE", style, sizeof style },
						   { "PROGRAM", program, sizeof program },
						   { "SCENE", scene, strlen(scene) } };
	GW_TRY(write_head(w, parts, sizeof parts / sizeof *parts, &rest));
	GW_TRY(write_blocks(w, points, points->count, threads));
	return put(w, rest, (size_t)(document + sizeof document - rest));
}

gw_status page_file_write(output_file *out, const settings *s, const page_scene *page,
						  const char *title, uint64_t *bytes, gw_error *error)
{
	writer w = { .out = out, .error = error };
	char *scene = NULL;
	page_points points = { .surfels = &page->scene.surfels,
						   .glows = page->scene.glows,
						   .order = page->order.point,
						   .count = page->order.count,
						   .lamps = page->lamp_count,
						   .light = reallocarray(NULL, page->lamp_count, sizeof *points.light) };
	if (!points.light)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu lamps", page->lamp_count);
	for (size_t l = 0; l < page->lamp_count; l++)
		points.light[l] = page->lamp[l].light;
	page_points_scale(&points);
	gw_status status = page_json_make(s, page, &points, title, &scene, error);
	if (status == GW_OK)
		status = write_all(&w, &points, scene, s->bake.threads);
	*bytes = w.bytes;
	free(scene);
	free(points.light);
	return status;
}
