/*
 * From a mesh to points: places by mesh_sample, attributes interpolated there.
 */
#include "glowworm_host.h"
#include "meshes/mesh.h"
#include "meshes/mesh_sample.h"
#include "points/scan_color.h"

#include <math.h>
#include <string.h>

/* Samples that a thread takes at a time. */
#define CHUNK 4096

/* Above this a float32 coordinate is off by more than 0.03 mm. */
#define FLOAT_METRES 1000.0

static const char *const position_names[3] = { "x", "y", "z" };
static const char *const normal_names[3] = { "nx", "ny", "nz" };
static const char *const emission_names[3] = { "emission_r", "emission_g", "emission_b" };

/* Columns of the scan that is filled; NULL for those that are not there. */
typedef struct sampler {
	const mesh *mesh;
	uint64_t count, seed;
	bool wide; /* positions are doubles */
	void *position[3];
	float *normal[3], *emission[3], *specular, *roughness;
	uint8_t *color[3];
} sampler;

static const mesh_material *material_of(const mesh *m, size_t triangle)
{
	uint32_t id = m->face_material[triangle];
	return id == MESH_NONE ? NULL : &m->material[id];
}

/* The face's normal, unit length. */
static void face_normal(const mesh *m, size_t triangle, double n[3])
{
	gw_mesh_cross(m->position, m->corner + 3 * triangle, n);
	double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
	for (int k = 0; k < 3; k++)
		n[k] /= length;
}

/* Weighs unit normals of the corners; the face's where a corner has none or they cancel out. */
static void interpolate_normal(const mesh *m, const gw_mesh_place *place, double n[3])
{
	double sum[3] = { 0 }, square = 0.0;
	bool all = true;
	for (size_t c = 0; c < 3; c++) {
		uint32_t id = m->corner_normal[3 * place->triangle + c];
		all = all && id != MESH_NONE;
		const float *from = all ? m->normal + 3 * (size_t)id : NULL;
		double length = 0.0;
		for (int k = 0; k < 3 && from; k++)
			length += (double)from[k] * (double)from[k];
		all = all && length > 0.0 && isfinite(length);
		for (int k = 0; k < 3 && all; k++)
			sum[k] += place->weight[c] * (double)from[k] / sqrt(length);
	}
	for (int k = 0; k < 3; k++)
		square += sum[k] * sum[k];
	if (!all || !(square > 1e-6)) {
		face_normal(m, place->triangle, n);
		return;
	}
	for (int k = 0; k < 3; k++)
		n[k] = sum[k] / sqrt(square);
}

static void put_position(const sampler *s, size_t i, const gw_mesh_place *place)
{
	const mesh *m = s->mesh;
	const uint32_t *corner = m->corner + 3 * place->triangle;
	for (size_t k = 0; k < 3; k++) {
		double value = 0.0;
		for (size_t c = 0; c < 3; c++)
			value += place->weight[c] * m->position[3 * (size_t)corner[c] + k];
		if (s->wide)
			((double *)s->position[k])[i] = value;
		else
			((float *)s->position[k])[i] = (float)value;
	}
}

static uint8_t encode(double linear)
{
	return linear > 0.0 ? (uint8_t)(scan_srgb_encode(fmin(linear, 1.0)) * 255.0 + 0.5) : 0;
}

static void put_color(const sampler *s, size_t i, const gw_mesh_place *place)
{
	const mesh *m = s->mesh;
	const mesh_material *material = material_of(m, place->triangle);
	const uint32_t *corner = m->corner + 3 * place->triangle;
	for (size_t k = 0; k < 3; k++) {
		double value = material ? (double)material->albedo[k] : (double)GW_ALBEDO_DEFAULT;
		if (m->color)
			value = 0.0;
		for (size_t c = 0; c < 3 && m->color; c++)
			value += place->weight[c] * (double)m->color[3 * (size_t)corner[c] + k];
		s->color[k][i] = encode(value);
	}
}

static void put_material(const sampler *s, size_t i, const gw_mesh_place *place)
{
	const mesh_material *material = material_of(s->mesh, place->triangle);
	for (size_t k = 0; k < 3 && s->emission[k]; k++)
		s->emission[k][i] = material ? material->emission[k] : 0.0f;
	if (s->specular)
		s->specular[i] = material ? material->specular : 0.0f;
	if (s->roughness)
		s->roughness[i] = material ? material->roughness : 1.0f;
}

static void sample_chunk(void *user, size_t first, size_t last, uint32_t worker)
{
	const sampler *s = user;
	const mesh *m = s->mesh;
	(void)worker;
	for (size_t i = first; i < last; i++) {
		gw_mesh_place place =
			gw_mesh_place_of(m->area_sum, m->triangle_count, s->count, s->seed, i);
		double n[3];
		put_position(s, i, &place);
		interpolate_normal(m, &place, n);
		for (int k = 0; k < 3; k++)
			s->normal[k][i] = (float)n[k];
		put_color(s, i, &place);
		put_material(s, i, &place);
	}
}

/* -------------------------------------------------------------------------------- columns */

static bool is_wide(const mesh *m)
{
	for (size_t i = 0; i < 3 * m->triangle_count; i++)
		for (size_t k = 0; k < 3; k++)
			if (fabs(m->position[3 * (size_t)m->corner[i] + k]) > FLOAT_METRES)
				return true;
	return false;
}

static gw_status add_three(scan *cloud, const char *const name[3], scan_type type, void *data[3],
						   gw_error *error)
{
	for (int k = 0; k < 3; k++) {
		scan_column *column = scan_add_column(cloud, name[k], type, error);
		if (!column)
			return GW_ERROR_MEMORY;
		data[k] = column->data;
	}
	return GW_OK;
}

static gw_status add_one(scan *cloud, const char *name, float **data, gw_error *error)
{
	scan_column *column = scan_add_column(cloud, name, SCAN_FLOAT32, error);
	*data = column ? column->data : NULL;
	return column ? GW_OK : GW_ERROR_MEMORY;
}

static gw_status add_columns(sampler *s, scan *cloud, gw_error *error)
{
	const mesh *m = s->mesh;
	bool emits = false, shines = false;
	void *data[3];
	for (size_t i = 0; i < m->material_count; i++) {
		for (int k = 0; k < 3; k++)
			emits = emits || m->material[i].emission[k] > 0.0f;
		shines = shines || m->material[i].specular > 0.0f;
	}
	GW_TRY(add_three(cloud, position_names, s->wide ? SCAN_FLOAT64 : SCAN_FLOAT32, s->position,
					 error));
	GW_TRY(add_three(cloud, normal_names, SCAN_FLOAT32, data, error));
	for (int k = 0; k < 3; k++)
		s->normal[k] = data[k];
	GW_TRY(add_three(cloud, scan_color_names, SCAN_UINT8, data, error));
	for (int k = 0; k < 3; k++)
		s->color[k] = data[k];
	if (emits)
		GW_TRY(add_three(cloud, emission_names, SCAN_FLOAT32, data, error));
	for (int k = 0; k < 3 && emits; k++)
		s->emission[k] = data[k];
	if (shines)
		GW_TRY(add_one(cloud, "specular", &s->specular, error));
	if (shines)
		GW_TRY(add_one(cloud, "roughness", &s->roughness, error));
	return GW_OK;
}

/* Bytes of a point with all its columns. */
#define POINT_BYTES (3 * 8 + 3 * 4 + 3 + 3 * 4 + 2 * 4)

gw_status mesh_sample(const mesh *m, uint64_t count, uint64_t seed, uint32_t threads, scan *cloud,
					  gw_error *error)
{
	*cloud = (scan){ .count = (size_t)count, .up = 'z' };
	uint64_t available = gw_available_memory();
	if (count > SIZE_MAX / POINT_BYTES || (available && count > available / POINT_BYTES))
		return gw_fail(error, GW_ERROR_MEMORY,
					   "%llu points do not fit into memory; sample fewer with --count or --density",
					   (unsigned long long)count);
	sampler s = { .mesh = m, .count = count, .seed = seed, .wide = is_wide(m) };
	gw_status status = add_columns(&s, cloud, error);
	if (status != GW_OK) {
		scan_clear(cloud);
		return status;
	}
	gw_parallel_for(threads, (size_t)count, CHUNK, sample_chunk, &s);
	return GW_OK;
}
