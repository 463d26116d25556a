/*
 * record_cones.comp - trace and shade step by cones: gathers the radiance in the brick pools over
 * each record's hemisphere (Salm 4.4.3, Crassin). The hemisphere is cut into strata of equal
 * cosine-weighted size; each is a cone of half the stratum's aperture. Along a cone, extinction is
 * the area that the voxels show to it, one-sided and per cell size, and it is composited additively
 * until the cone is full, which makes a flat wall opaque exactly once at any angle; what is left
 * sees the sky.
 */
#version 460

#include "octree_walk.glsl"
#include "sampling.glsl"

layout(local_size_x_id = 0) in;
layout(binding = 0) uniform usamplerBuffer level_directory;
layout(binding = 1) uniform usamplerBuffer node;
layout(binding = 2) uniform sampler3D leaf_pool;
layout(binding = 3) uniform sampler3D mip_pool;
layout(binding = 4) readonly buffer Position
{
	vec4 record_position[];
};
layout(binding = 5) readonly buffer Normal
{
	vec4 record_normal[];
};
layout(binding = 6) writeonly buffer Gathered
{
	vec4 record_gathered[];
};
layout(push_constant) uniform Push
{
	gw_cone_push push;
};

#include "octree_tiles.glsl"
#include "brick_pool.glsl"

vec4 sample_face(bool leaves, vec3 at, int face)
{
	at.z += float(face * int(leaves ? push.leaf_face_depth : push.mip_face_depth));
	return leaves ? textureLod(leaf_pool, at / vec3(textureSize(leaf_pool, 0)), 0.0)
				  : textureLod(mip_pool, at / vec3(textureSize(mip_pool, 0)), 0.0);
}

/* F and G per leaf cell of path that voxels of size 2^up leaf cells show to a ray. */
vec4 sample_level(vec3 g, vec3 direction, uint up)
{
	float size = exp2(float(up));
	float cells = exp2(float(depth - up));
	/* Beyond the outermost voxels' centres they fade to nothing over one voxel. */
	vec3 v = clamp(g / size, vec3(0.5), vec3(cells - 0.5));
	vec3 inside = max(vec3(0.0), 1.0 - abs(g / size - v));
	uvec3 base = uvec3(v - 0.5) >> 1;
	uint tile = find_tile(base, depth - up - 1u);
	if (tile == 0u)
		return vec4(0.0);
	bool leaves = up == 0u;
	vec3 at = vec3(brick_corner(tile - 1u, leaves ? push.leaf_bricks[0] : push.mip_bricks[0],
								leaves ? push.leaf_bricks[1] : push.mip_bricks[1])) +
			  v - 2.0 * vec3(base);
	vec3 weight = abs(direction);
	vec4 sum = weight.x * sample_face(leaves, at, direction.x < 0.0 ? 0 : 1) +
			   weight.y * sample_face(leaves, at, direction.y < 0.0 ? 2 : 3) +
			   weight.z * sample_face(leaves, at, direction.z < 0.0 ? 4 : 5);
	return sum * (inside.x * inside.y * inside.z / size);
}

vec3 trace_cone(vec3 origin, vec3 direction, float tangent)
{
	float side = exp2(float(depth));
	vec3 radiance = vec3(0.0);
	float filled = 0.0;
	float t = push.start;
	for (uint step = 0u; step < 256u && filled < 0.995; step++) {
		float width = max(1.0, 2.0 * t * tangent);
		vec3 g = origin + direction * (t + 0.5 * width);
		if (any(lessThan(g, vec3(-width))) || any(greaterThan(g, vec3(side + width))))
			break;
		float level = min(log2(width), float(depth - 1u));
		uint up = uint(level);
		vec4 shown = sample_level(g, direction, up);
		float between = level - float(up);
		if (between > 1e-3 && up + 1u < depth)
			shown = mix(shown, sample_level(g, direction, up + 1u), between);
		float opacity = width * shown.w;
		if (opacity > 1e-6) {
			float taken = min(opacity, 1.0 - filled);
			radiance += shown.xyz * (width * taken / opacity);
			filled += taken;
		}
		t += width;
	}
	return radiance / push.scale + (1.0 - min(filled, 1.0)) * push.sky.xyz;
}

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	vec3 normal = record_normal[i].xyz;
	float open = record_normal[i].w; /* 0 inside something solid */
	vec3 origin = record_position[i].xyz + 0.5 * normal;
	float turn = unit_float(hash2(push.first + i, push.seed));
	vec3 sum = vec3(0.0);
	for (uint c = 0u; c < push.cones; c++) {
		float cosine;
		vec3 direction = disc_to_hemisphere(spiral_disc(c, push.cones, 0.5, turn), normal, cosine);
		/* A stratum is pi / cones of projected solid angle. */
		float solid_angle = min(PI / (float(push.cones) * max(cosine, 0.05)), 2.0 * PI * 0.9);
		float c_half = 1.0 - solid_angle / (2.0 * PI);
		float tangent = 0.5 * sqrt(max(0.0, 1.0 - c_half * c_half)) / c_half;
		sum += trace_cone(origin, direction, tangent);
	}
	record_gathered[i] = vec4(sum * open * (PI / float(push.cones)), 0.0);
}
