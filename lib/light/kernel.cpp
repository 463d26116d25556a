/*
 * kernel.cpp - a pass of shaders/ as a CPU loop; built once for each that the Makefile
 * lists, with PASS as its name and PASS_TEXT as the name of its file.
 *
 * The text becomes the body of a struct: bindings, constants, and what GLSL calls globals are
 * members of it, which the functions see. Each call makes one of its own, so that it is
 * thread-safe.
 */
#include "device/kernel.h"

#include "base/shared_math.h"
#include "device/sort_layout.h"
#include "octree/trace_constants.h"
#include "light/transport_layout.h"
#include "picture/gloss_cache.h"

#define TEXELS(slot, texel, name) const texels<texel> name = texels<texel>(bytes_of(slot))
#define BUFFER(slot, access, type, name) type *const name = static_cast<type *>(bytes_of(slot))
#define PUSH(type) const type push = push_of<type>()
#define CONSTANT(id, type, name, value) const type name = constant_of<type>(id)

namespace glsl
{
namespace
{

struct invocation {
	const gw_kernel_input *run;
	struct {
		uint x;
	} gl_GlobalInvocationID;

	void *bytes_of(int slot) const
	{
		return run->bindings[slot].buffer->mapped;
	}

	template <class Push> Push push_of() const
	{
		return *static_cast<const Push *>(run->push);
	}

	template <class Number> Number constant_of(int id) const
	{
		Number value;
		memcpy(&value, run->constant + id - 1, sizeof value);
		return value;
	}
};

struct kernel : invocation {
	explicit kernel(const gw_kernel_input *run) : invocation{ run, { 0 } }
	{
	}
#include PASS_TEXT
};

} // namespace
} // namespace glsl

extern "C" void PASS(const gw_kernel_input *run, size_t first, size_t last)
{
	glsl::kernel k(run);
	for (size_t i = first; i < last; i++) {
		k.gl_GlobalInvocationID.x = run->element ? run->element[i] : (uint)i;
		k.main();
	}
}
