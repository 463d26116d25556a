#include "device/shader_needs.h"

#include <string.h>

/* Numbers of the SPIR-V specification, section 3. */
enum {
	HEADER_WORDS = 5,
	OP_TYPE_IMAGE = 25,
	OP_TYPE_SAMPLED_IMAGE = 27,
	OP_TYPE_POINTER = 32,
	OP_VARIABLE = 59,
	CLASS_UNIFORM_CONSTANT = 0,
	CLASS_STORAGE_BUFFER = 12,
	STORED = 2, /* of an image: it is not read through a sampler */
};

/* The words of the next instruction, or NULL behind the last. */
static const uint32_t *next(const gw_shader *shader, size_t *at)
{
	const uint32_t *found = shader->spirv + *at;
	if (*at >= shader->words || found[0] >> 16 == 0 || found[0] >> 16 > shader->words - *at)
		return NULL;
	*at += found[0] >> 16;
	return found;
}

static uint32_t code(const uint32_t *instruction)
{
	return instruction[0] & 0xffffu;
}

/* The type that has this number; NULL when it is none of those looked for here. */
static const uint32_t *find_type(const gw_shader *shader, uint32_t number)
{
	size_t at = HEADER_WORDS;
	for (const uint32_t *i; (i = next(shader, &at)) != NULL;)
		if ((code(i) == OP_TYPE_IMAGE || code(i) == OP_TYPE_SAMPLED_IMAGE ||
			 code(i) == OP_TYPE_POINTER) &&
			i[1] == number)
			return i;
	return NULL;
}

/* A variable is a number, a pointer to a type, and a storage class. */
static void count_variable(const gw_shader *shader, const uint32_t *variable,
						   gw_shader_needs *needs)
{
	if (variable[3] == CLASS_STORAGE_BUFFER) {
		needs->storage_buffers++;
		needs->resources++;
	}
	if (variable[3] != CLASS_UNIFORM_CONSTANT)
		return;
	const uint32_t *pointer = find_type(shader, variable[1]);
	const uint32_t *type = pointer != NULL ? find_type(shader, pointer[3]) : NULL;
	bool stored = type != NULL && code(type) == OP_TYPE_IMAGE && type[7] == STORED;
	needs->storage_images += stored;
	needs->sampled += !stored;
	needs->resources++;
}

gw_shader_needs gw_shader_needs_of(const gw_shader *shader)
{
	gw_shader_needs needs = { 0 };
	size_t at = HEADER_WORDS;
	for (const uint32_t *i; (i = next(shader, &at)) != NULL;)
		if (code(i) == OP_VARIABLE)
			count_variable(shader, i, &needs);
	return needs;
}

static uint32_t larger(uint32_t a, uint32_t b)
{
	return a > b ? a : b;
}

gw_shader_needs gw_shader_needs_most(void)
{
	gw_shader_needs most = { 0 };
	const gw_shader *shader;
	for (size_t i = 0; (shader = gw_shader_at(i)) != NULL; i++) {
		if (strncmp(shader->name, "test_", 5) == 0)
			continue;
		gw_shader_needs needs = gw_shader_needs_of(shader);
		most.storage_buffers = larger(most.storage_buffers, needs.storage_buffers);
		most.sampled = larger(most.sampled, needs.sampled);
		most.storage_images = larger(most.storage_images, needs.storage_images);
		most.resources = larger(most.resources, needs.resources);
	}
	return most;
}
