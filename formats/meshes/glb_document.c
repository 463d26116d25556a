#include "meshes/glb_document.h"
#include "files/little_endian.h"

#include <assert.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* "glTF", "JSON" and "BIN" as numbers. */
#define MAGIC 0x46546c67u
#define CHUNK_JSON 0x4e4f534au
#define CHUNK_BIN 0x004e4942u

#define HEAD 12
#define CHUNK_HEAD 8

bool glb_probe(const uint8_t *head, size_t length)
{
	return length >= 4 && load_32(head) == MAGIC;
}

gw_status glb_fail(const glb_document *d, const char *form, ...)
{
	char text[500];
	va_list arguments;
	va_start(arguments, form);
	vsnprintf(text, sizeof text, form, arguments);
	va_end(arguments);
	return gw_fail(d->error, GW_ERROR_DATA, "%s: %s", d->in->name, text);
}

/* --------------------------------------------------------------------------------- chunks */

static gw_status parse(glb_document *d, const uint8_t *text, size_t length)
{
	json_error_t problem;
	/* Blanks fill the chunk up; some writers take zeros. */
	while (length > 0 && text[length - 1] == '\0')
		length--;
	/* jansson refuses what is nested more than 2048 deep. */
	d->root = json_loadb((const char *)text, length, JSON_REJECT_DUPLICATES, &problem);
	if (!d->root)
		return glb_fail(d, "its JSON, line %d, column %d: %s", problem.line, problem.column,
						problem.text);
	return json_is_object(d->root) ? GW_OK : glb_fail(d, "its JSON is no object");
}

static gw_status find_chunks(glb_document *d)
{
	const uint8_t *data = d->in->data;
	if (d->in->length < HEAD + CHUNK_HEAD || !glb_probe(data, d->in->length))
		return glb_fail(d, "this is no binary glTF file, or only its start");
	if (load_32(data + 4) != 2)
		return glb_fail(d, "binary glTF version %u cannot be read, only version 2",
						load_32(data + 4));
	size_t end = load_32(data + 8), at = HEAD;
	if (end > d->in->length)
		return glb_fail(d, "its head says %zu bytes, but there are %zu; the file is cut short", end,
						d->in->length);
	gw_status status = GW_OK;
	for (size_t chunk = 0; status == GW_OK && at < end; chunk++) {
		if (end - at < CHUNK_HEAD || load_32(data + at) > end - at - CHUNK_HEAD)
			return glb_fail(d, "chunk %zu is longer than the file", chunk);
		size_t length = load_32(data + at);
		uint32_t type = load_32(data + at + 4);
		if (chunk == 0 && type == CHUNK_JSON)
			status = parse(d, data + at + CHUNK_HEAD, length);
		if (chunk == 1 && type == CHUNK_BIN) {
			d->bytes = data + at + CHUNK_HEAD;
			d->length = length;
		}
		at += CHUNK_HEAD + length;
	}
	return status == GW_OK && !d->root ? glb_fail(d, "its first chunk is not JSON") : status;
}

/* Those that change nothing of what is read here, or that are read. */
static bool is_known(const char *extension)
{
	static const char *const known[] = { "KHR_mesh_quantization", "KHR_materials_emissive_strength",
										 "KHR_lights_punctual",   "KHR_texture_transform",
										 "KHR_materials_",        "KHR_texture_basisu",
										 "EXT_texture_webp" };
	for (size_t i = 0; i < sizeof known / sizeof *known; i++)
		if (strncmp(extension, known[i], strlen(known[i])) == 0)
			return true;
	return false;
}

static gw_status check_asset(const glb_document *d)
{
	const char *version =
		json_string_value(json_object_get(json_object_get(d->root, "asset"), "version"));
	if (!version || strncmp(version, "2.", 2) != 0)
		return glb_fail(d, "its asset.version is not 2.0");
	json_t *needed = json_object_get(d->root, "extensionsRequired");
	for (size_t i = 0; i < json_array_size(needed); i++) {
		const char *name = json_string_value(json_array_get(needed, i));
		if (!name || !is_known(name))
			return glb_fail(d,
							"it needs the extension '%.60s', which is not read; export it "
							"without compression",
							name ? name : "");
	}
	return GW_OK;
}

gw_status glb_open(glb_document *d, const input_file *in, gw_error *error)
{
	*d = (glb_document){ .in = in, .error = error };
	GW_TRY(find_chunks(d));
	return check_asset(d);
}

void glb_close(glb_document *d)
{
	json_decref(d->root);
	d->root = NULL;
}

/* -------------------------------------------------------------------------- members of JSON */

json_t *glb_entry(const glb_document *d, const char *list, size_t index)
{
	return json_array_get(json_object_get(d->root, list), index);
}

gw_status glb_size(const glb_document *d, json_t *object, const char *key, size_t missing,
				   size_t *value)
{
	json_t *member = json_object_get(object, key);
	*value = missing;
	if (!member)
		return GW_OK;
	/* Some writers print counts as 3.0. */
	double number = json_is_number(member) ? json_number_value(member) : -1.0;
	if (!(number >= 0.0 && number <= 0x1p53 && number == floor(number)))
		return glb_fail(d, "'%s' has to be a whole number, 0 or above", key);
	*value = (size_t)number;
	return GW_OK;
}

gw_status glb_numbers(const glb_document *d, json_t *object, const char *key, double *to,
					  size_t count)
{
	json_t *member = json_object_get(object, key);
	if (!member)
		return GW_OK;
	bool good = json_is_array(member) && json_array_size(member) == count;
	for (size_t i = 0; i < count && good; i++) {
		good = json_is_number(json_array_get(member, i));
		to[i] = json_number_value(json_array_get(member, i));
	}
	return good ? GW_OK : glb_fail(d, "'%s' has to be %zu numbers", key, count);
}

/* ------------------------------------------------------------------------------ accessors */

static size_t component_size(size_t component)
{
	switch (component) {
	case GLB_INT8:
	case GLB_UINT8:
		return 1;
	case GLB_INT16:
	case GLB_UINT16:
		return 2;
	case GLB_UINT32:
	case GLB_FLOAT:
		return 4;
	default:
		return 0;
	}
}

static unsigned type_width(const char *type)
{
	static const char *const name[] = { "SCALAR", "VEC2", "VEC3", "VEC4" };
	for (unsigned i = 0; type && i < 4; i++)
		if (strcmp(type, name[i]) == 0)
			return i + 1;
	return 0;
}

/* The bytes of a view: all of them are inside the binary chunk. */
static gw_status find_view(const glb_document *d, size_t index, const uint8_t **bytes,
						   size_t *length, size_t *stride)
{
	json_t *view = glb_entry(d, "bufferViews", index);
	size_t buffer, offset;
	if (!json_is_object(view))
		return glb_fail(d, "there is no bufferViews[%zu]", index);
	GW_TRY(glb_size(d, view, "buffer", SIZE_MAX, &buffer));
	GW_TRY(glb_size(d, view, "byteOffset", 0, &offset));
	GW_TRY(glb_size(d, view, "byteLength", 0, length));
	GW_TRY(glb_size(d, view, "byteStride", 0, stride));
	if (buffer != 0 || !d->bytes || json_object_get(glb_entry(d, "buffers", 0), "uri"))
		return glb_fail(d, "bufferViews[%zu] lies in another file; export as one GLB file", index);
	if (offset > d->length || *length > d->length - offset)
		return glb_fail(d, "bufferViews[%zu] reaches out of the binary chunk, which has %zu bytes",
						index, d->length);
	*bytes = d->bytes + offset;
	return GW_OK;
}

/* All elements have to be inside the view. */
static gw_status place_values(const glb_document *d, size_t index, size_t view, size_t offset,
							  glb_values *v)
{
	size_t size = component_size(v->component) * v->width, length = 0;
	const uint8_t *bytes = NULL;
	assert(size > 0 && v->count > 0);
	GW_TRY(find_view(d, view, &bytes, &length, &v->stride));
	v->stride = v->stride ? v->stride : size;
	if (v->stride < size || v->stride > 252)
		return glb_fail(d, "accessors[%zu]: its elements are %zu bytes apart and %zu long", index,
						v->stride, size);
	if (offset > length || size > length - offset ||
		v->count - 1 > (length - offset - size) / v->stride)
		return glb_fail(d, "accessors[%zu] reaches out of bufferViews[%zu], which has %zu bytes",
						index, view, length);
	v->first = bytes + offset;
	return GW_OK;
}

gw_status glb_find_values(const glb_document *d, size_t index, glb_values *v)
{
	json_t *accessor = glb_entry(d, "accessors", index);
	size_t view, offset, component;
	if (!json_is_object(accessor))
		return glb_fail(d, "there is no accessors[%zu]", index);
	if (json_object_get(accessor, "sparse"))
		return glb_fail(d, "accessors[%zu] is sparse, which is not read", index);
	GW_TRY(glb_size(d, accessor, "bufferView", SIZE_MAX, &view));
	GW_TRY(glb_size(d, accessor, "byteOffset", 0, &offset));
	GW_TRY(glb_size(d, accessor, "componentType", 0, &component));
	GW_TRY(glb_size(d, accessor, "count", 0, &v->count));
	v->width = type_width(json_string_value(json_object_get(accessor, "type")));
	v->component = (unsigned)component;
	v->normalized = json_is_true(json_object_get(accessor, "normalized"));
	if (component_size(component) == 0 || v->width == 0 || v->count == 0)
		return glb_fail(d, "accessors[%zu]: its type or count makes no sense", index);
	if (view == SIZE_MAX)
		return glb_fail(d, "accessors[%zu] has no bufferView", index);
	return place_values(d, index, view, offset, v);
}

double glb_value(const glb_values *v, size_t i, size_t component)
{
	const uint8_t *at = v->first + i * v->stride + component * component_size(v->component);
	float real;
	uint32_t bits;
	double full = v->normalized ? 1.0 : 0.0, value = 0.0;
	switch (v->component) {
	case GLB_INT8:
		value = (int8_t)*at;
		full *= 127.0;
		break;
	case GLB_UINT8:
		value = *at;
		full *= 255.0;
		break;
	case GLB_INT16:
		value = (int16_t)load_16(at);
		full *= 32767.0;
		break;
	case GLB_UINT16:
		value = load_16(at);
		full *= 65535.0;
		break;
	case GLB_UINT32:
		return load_32(at);
	default:
		bits = load_32(at);
		memcpy(&real, &bits, sizeof real);
		return (double)real;
	}
	return full > 0.0 ? fmax(value / full, -1.0) : value;
}
