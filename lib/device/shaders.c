/*
 * shaders.c - the compute shaders, compiled into the library. The Makefile writes shader_list.inc
 * from the files in shaders/.
 */
#include "device/gpu.h"

#include <assert.h>
#include <string.h>

#include "shader_list.inc"

const gw_shader *gw_shader_at(size_t i)
{
	return i < sizeof shader_list / sizeof *shader_list ? &shader_list[i] : NULL;
}

const gw_shader *gw_shader_find(const char *name)
{
	for (size_t i = 0; i < sizeof shader_list / sizeof *shader_list; i++)
		if (strcmp(shader_list[i].name, name) == 0)
			return &shader_list[i];
	assert(!"a shader of that name is in shaders/");
	return NULL;
}
