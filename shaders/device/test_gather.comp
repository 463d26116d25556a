/*
 * test_gather.comp - for the unit test of the device layer: reads a texel buffer and two images.
 *
 * One invocation does one element: it writes the texel (i, i / 2, i / 4) of a storage image when
 * `write` is 1, else adds up what the texel buffer, the same texel and a filtered sample hold.
 */
#version 460

layout(local_size_x_id = 0) in;

layout(binding = 0) uniform utextureBuffer words;
layout(binding = 1, rgba32f) uniform image3D store;
layout(binding = 2) uniform sampler3D smooth_image;
layout(binding = 3) writeonly buffer Output { float result[]; };

layout(push_constant) uniform Push {
	uint first, count; /* gw_span */
	uint write;
};

void main()
{
	uint local = gl_GlobalInvocationID.x, i = first + local;
	if (local >= count)
		return;
	ivec3 size = imageSize(store);
	ivec3 texel = ivec3(i % size.x, i / size.x % size.y, i / (size.x * size.y));
	if (write == 1) {
		imageStore(store, texel, vec4(i, 0, 0, 0));
		return;
	}
	/* Half way between two texels in x, so that filtering shows. */
	vec3 at = (vec3(texel) + vec3(1, 0.5, 0.5)) / vec3(size);
	result[local] = float(texelFetch(words, int(i)).r) + imageLoad(store, texel).r +
	                textureLod(smooth_image, at, 0).r;
}
