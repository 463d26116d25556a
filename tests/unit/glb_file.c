#include "glb_file.h"
#include "files/little_endian.h"

#include <assert.h>
#include <string.h>

size_t glb_file_make(const char *json, const void *bytes, size_t length,
					 uint8_t file[GLB_FILE_ROOM])
{
	size_t text = strlen(json), padded = (text + 3) / 4 * 4, at = 20 + padded;
	assert(at + 8 + length + 3 <= GLB_FILE_ROOM);
	memcpy(file, "glTF", 4);
	store_32(file + 4, 2);
	store_32(file + 12, (uint32_t)padded);
	memcpy(file + 16, "JSON", 4);
	memset(file + 20, ' ', padded);
	memcpy(file + 20, json, text);
	if (bytes) {
		size_t filled = (length + 3) / 4 * 4;
		store_32(file + at, (uint32_t)filled);
		memcpy(file + at + 4, "BIN", 4);
		memset(file + at + 8, 0, filled);
		memcpy(file + at + 8, bytes, length);
		at += 8 + filled;
	}
	store_32(file + 8, (uint32_t)at);
	return at;
}

static const char square[] =
	"{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0,2]}],"
	"\"nodes\":[{\"children\":[1],\"mesh\":0,"
	"\"matrix\":[-1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]},{\"mesh\":1},"
	"{\"mesh\":0,\"translation\":[0,1,0],\"rotation\":[0.7071067811865476,0,0,"
	"0.7071067811865476],\"scale\":[2,2,2]}],"
	"\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"NORMAL\":1,\"COLOR_0\":2},"
	"\"indices\":3,\"material\":0}]},"
	"{\"primitives\":[{\"attributes\":{\"POSITION\":4},\"material\":1},"
	"{\"attributes\":{\"POSITION\":4},\"mode\":0}]}],"
	"\"materials\":[{\"name\":\"paint\",\"pbrMetallicRoughness\":"
	"{\"baseColorFactor\":[0.5,0.25,1,1]}},"
	"{\"emissiveFactor\":[1,0.5,0],\"extensions\":"
	"{\"KHR_materials_emissive_strength\":{\"emissiveStrength\":5}}}],"
	"\"accessors\":["
	"{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"},"
	"{\"bufferView\":0,\"byteOffset\":12,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"},"
	"{\"bufferView\":0,\"byteOffset\":24,\"componentType\":5121,\"normalized\":true,\"count\":4,"
	"\"type\":\"VEC4\"},"
	"{\"bufferView\":1,\"componentType\":5123,\"count\":6,\"type\":\"SCALAR\"},"
	"{\"bufferView\":2,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}],"
	"\"bufferViews\":[{\"buffer\":0,\"byteLength\":112,\"byteStride\":28},"
	"{\"buffer\":0,\"byteOffset\":112,\"byteLength\":12},"
	"{\"buffer\":0,\"byteOffset\":124,\"byteLength\":36}],"
	"\"buffers\":[{\"byteLength\":160}]}";

static uint8_t *put_float(uint8_t *to, float value)
{
	uint32_t bits;
	memcpy(&bits, &value, sizeof bits);
	store_32(to, bits);
	return to + 4;
}

size_t glb_file_square(uint8_t file[GLB_FILE_ROOM])
{
	static const uint16_t index[6] = { 0, 1, 2, 0, 2, 3 };
	static const float corner[4][2] = { { 0, 0 }, { 1, 0 }, { 1, 1 }, { 0, 1 } };
	uint8_t bytes[160], *to = bytes;
	for (int i = 0; i < 4; i++) {
		const float v[6] = { corner[i][0], corner[i][1], 0, 0, 0, 1 };
		for (int k = 0; k < 6; k++)
			to = put_float(to, v[k]);
		for (int k = 0; k < 4; k++)
			*to++ = k == i ? 255 : 51;
	}
	for (int i = 0; i < 6; i++, to += 2)
		store_16(to, index[i]);
	for (int i = 0; i < 3; i++)
		for (int k = 0; k < 3; k++)
			to = put_float(to, k == 2 ? 3.0f : corner[i][k]);
	return glb_file_make(square, bytes, sizeof bytes, file);
}
