/*
 * sky_map.c - see sky_map.h.
 */
#include "light/sky_map.h"

#include "base/alias_table.h"
#include "base/luminance.h"
#include "base/memory.h"
#include "base/shared_math.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Finite pixels are limited to this, so that sums of them stay finite. */
#define LARGEST 1e12f

/* A pixel as it counts. */
static float mend(float value, gw_sky_map *map)
{
	if (isnan(value) || value < 0.0f) {
		map->repaired++;
		return 0.0f;
	}
	if (value <= LARGEST)
		return value;
	map->infinite++;
	return isinf(value) ? GW_MAP_INFINITE : LARGEST;
}

/* Share of the sphere's height that lies above a row's upper edge, times 2. */
static double height_of(size_t row, size_t rows)
{
	return 1.0 - cos(M_PI * (double)row / (double)rows);
}

/* Adds one row of the light's map to one of the texels' rows: each pixel to the texels that it
 * overlaps. weight: solid angle of what the rows have in common, over that of the texels' row. */
static void add_row(const float *pixel, size_t pixels, double weight, double *sum, size_t texels)
{
	for (size_t x = 0; x < pixels; x++) {
		double left = (double)x * (double)texels / (double)pixels;
		double right = (double)(x + 1) * (double)texels / (double)pixels;
		for (size_t t = (size_t)left; t < texels && (double)t < right; t++) {
			double from = left > (double)t ? left : (double)t;
			double to = right < (double)(t + 1) ? right : (double)(t + 1);
			for (size_t c = 0; c < 3 && to > from; c++)
				sum[3 * t + c] += weight * (to - from) * (double)pixel[3 * x + c];
		}
	}
}

/* Pixels, mended and multiplied by the light's radiance, averaged by solid angle into 4 * width *
 * height floats. row, sum: scratch of a row of pixels and of texels. */
static void shrink(const gw_light *light, gw_sky_map *map, float *row, double *sum, float *texel)
{
	size_t w = light->map_width, h = light->map_height, tw = map->width, th = map->height;
	size_t y = 0, mended = SIZE_MAX;
	for (size_t ty = 0; ty < th; ty++) {
		double top = height_of(ty, th), bottom = height_of(ty + 1, th);
		for (size_t i = 0; i < 3 * tw; i++)
			sum[i] = 0.0;
		for (; y < h; y++) {
			double from = fmax(height_of(y, h), top), to = fmin(height_of(y + 1, h), bottom);
			for (size_t i = 0; i < 3 * w && mended != y; i++)
				row[i] =
					fminf(mend(light->map[3 * w * y + i], map) * light->radiance[i % 3], LARGEST);
			mended = y;
			if (to > from)
				add_row(row, w, (to - from) / (bottom - top), sum, tw);
			/* A row that reaches into the next texels' row is needed again. */
			if (height_of(y + 1, h) > bottom)
				break;
		}
		for (size_t i = 0; i < tw; i++)
			for (size_t c = 0; c < 4; c++)
				texel[4 * (tw * ty + i) + c] = c < 3 ? (float)sum[3 * i + c] : 0.0f;
	}
}

/* Luminance times solid angle of every texel; returns the sum. */
static double weigh(const gw_sky_map *map, const float *texel, double *weight)
{
	double total = 0.0;
	for (size_t y = 0; y < map->height; y++) {
		double angle = 2.0 * M_PI / (double)map->width *
					   (height_of(y + 1, map->height) - height_of(y, map->height));
		for (size_t i = y * map->width; i < (y + 1) * map->width; i++) {
			const float *l = texel + 4 * i;
			weight[i] = angle * gw_luminance(l);
			total += weight[i];
		}
	}
	return total;
}

static gw_status upload(gw_gpu *gpu, gw_sky_map *map, const float *texel, const gw_alias_row *alias,
						gw_error *error)
{
	uint64_t count = (uint64_t)map->width * map->height;
	GW_TRY(
		gw_buffer_create(gpu,
						 &(gw_buffer_description){ GW_BUFFER_TEXEL, VK_FORMAT_R32G32B32A32_SFLOAT,
												   16 * count, "map of the sky" },
						 &map->texel, error));
	GW_TRY(gw_buffer_create(gpu,
							&(gw_buffer_description){ GW_BUFFER_TEXEL, VK_FORMAT_R32G32_UINT,
													  8 * count, "table of the sky" },
							&map->alias, error));
	GW_TRY(gw_buffer_upload(gpu, &map->texel, 0, texel, 16 * count, error));
	return gw_buffer_upload(gpu, &map->alias, 0, alias, 8 * count, error);
}

/* What a map is made from. */
typedef struct map_room {
	float *row, *texel; /* of the light's map, and of this */
	double *sum, *weight;
	gw_alias_row *alias;
} map_room;

/* A map of nothing but black becomes empty. */
static gw_status fill_map(gw_gpu *gpu, const gw_light *light, const map_room *room, gw_sky_map *map,
						  gw_error *error)
{
	uint32_t count = map->width * map->height;
	if (!room->row || !room->sum || !room->texel || !room->weight || !room->alias)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for a map of %u texels", count);
	shrink(light, map, room->row, room->sum, room->texel);
	double total = weigh(map, room->texel, room->weight);
	map->total = (float)total;
	if (!(total > 0.0)) {
		map->width = 0;
		return GW_OK;
	}
	GW_TRY(gw_alias_table_fill(room->alias, room->weight, count, error));
	return upload(gpu, map, room->texel, room->alias, error);
}

gw_status gw_sky_map_make(gw_gpu *gpu, const gw_light *light, gw_sky_map *map, gw_error *error)
{
	*map = (gw_sky_map){ .width = light->map_width < GW_SKY_WIDTH ? light->map_width : GW_SKY_WIDTH,
						 .height =
							 light->map_height < GW_SKY_HEIGHT ? light->map_height : GW_SKY_HEIGHT,
						 .turn = (float)fmod((double)light->rotation / 360.0, 1.0),
						 .y_up = light->map_y_up };
	uint32_t count = map->width * map->height;
	const map_room room = { .row = gw_allocate_array(light->map_width, 3 * sizeof *room.row),
							.texel = gw_allocate_array(count, 4 * sizeof *room.texel),
							.sum = gw_allocate_array(map->width, 3 * sizeof *room.sum),
							.weight = gw_allocate_array(count, sizeof *room.weight),
							.alias = gw_allocate_array(count, sizeof *room.alias) };
	gw_status status = fill_map(gpu, light, &room, map, error);
	if (status != GW_OK)
		map->width = 0;
	free(room.row);
	free(room.texel);
	free(room.sum);
	free(room.weight);
	free(room.alias);
	return status;
}

void gw_sky_map_destroy(gw_gpu *gpu, gw_sky_map *map)
{
	gw_buffer_destroy(gpu, &map->texel);
	gw_buffer_destroy(gpu, &map->alias);
	*map = (gw_sky_map){ 0 };
}

void gw_sky_radiance(const gw_sky_view *sky, gw_vec3 d, float radiance[3])
{
	const gw_sky_map *m = sky->map;
	memcpy(radiance, sky->radiance, 3 * sizeof *radiance);
	if (!sky->texel)
		return;
	float height = m->y_up ? d.y : d.z, north = m->y_up ? -d.z : d.y;
	float u = atan2f(d.x, north) / (2.0f * GW_PI) + 0.5f - m->turn;
	float v = acosf(gw_smaller(gw_larger(height, -1.0f), 1.0f)) / GW_PI;
	uint32_t column = (uint32_t)((u - floorf(u)) * (float)m->width);
	uint32_t row = (uint32_t)(v * (float)m->height);
	column = column < m->width ? column : m->width - 1;
	row = row < m->height ? row : m->height - 1;
	for (size_t c = 0; c < 3; c++)
		radiance[c] += sky->texel[4 * ((size_t)row * m->width + column) + c];
}
