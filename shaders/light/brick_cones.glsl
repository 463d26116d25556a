/*
 * brick_cones.glsl - reading the brick pools, and cones through them. Uses the texel buffers
 * level_directory and node (octree.h), the images leaf_pool and mip_pool (brick_pool.glsl) and
 * `push`, a gw_cone_push.
 *
 * Along a cone, extinction is the area that the voxels show to it, one-sided but for what lets
 * light through, and per cell size, and it is composited additively until the cone is full, which
 * makes a flat wall opaque exactly once at any angle; what is left sees the sky.
 */
#ifndef BRICK_CONES_GLSL
#define BRICK_CONES_GLSL

#include "octree/octree_tiles.glsl"
#include "light/brick_pool.glsl"

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

/* Whether something lets light through: 0, or octree.h's dark_facet. */
layout(constant_id = 5) const uint dark_facet = 0u;

/* Between sheets of surface what they let through is multiplied; within one, and where all is
 * opaque, areas add up. */
void end_sheet(inout float filled, inout float through)
{
	if (dark_facet == 0u)
		return;
	through *= 1.0 - min(filled, 1.0);
	filled = 0.0;
}

/* The sheet that cones start on, if it lets light through: then its back shows to them. The normal
 * is 0 where there is none. */
vec3 own_place = vec3(0.0), own_normal = vec3(0.0);

void start_on_sheet(vec3 place, vec3 normal)
{
	own_place = place;
	own_normal = normal;
}

/* The most that the back of that sheet shows to a cone, a leaf cell of its path. Voxels' centres
 * lie within half a cell of it; samples half a cell apart find at least three quarters of it. */
float own_cover(vec3 direction)
{
	float most = 0.0;
	for (int k = -1; k <= 1 && own_normal != vec3(0.0); k++) {
		vec3 place = own_place + 0.5 * float(k) * own_normal;
		most = max(most, sample_level(place, direction, 0u).w / 0.75);
	}
	return most;
}

vec4 less_covered(vec4 a, vec4 b)
{
	return a.w < b.w ? a : b;
}

/* 1 if a sheet of a normal lies along an axis, 0 if it leans so much that beside each of its voxels
 * there are others at other heights, by 0.7 at least. */
float along_axis(vec3 normal)
{
	vec3 n = abs(normal);
	float most = max(n.x, max(n.y, n.z));
	return max(0.0, 1.0 - 3.0 * sqrt(max(0.0, dot(n, n) - most * most)) / most);
}

/*
 * sample_level() without the back of that sheet. It shows as much below itself as above: if it lies
 * along an axis, from the centres of its voxels on, else from itself. What else is near it shows on
 * one side only. Beyond two voxels of height it shows nothing.
 */
vec4 sample_others(vec3 g, vec3 direction, uint up, float own_most)
{
	vec4 shown = sample_level(g, direction, up);
	float size = exp2(float(up)), rise = dot(g - own_place, own_normal);
	if (own_most == 0.0 || shown.w == 0.0 || rise > 2.0 * size)
		return shown;
	vec3 foot = g - rise * own_normal;
	float near = max(along_axis(own_normal), min(2.0 - rise / size, 1.0));
	float centre = near * dot((floor(foot / size) + 0.5) * size - foot, own_normal);
	vec4 turned = sample_level(foot + (2.0 * centre - rise) * own_normal, direction, up);
	vec4 below = sample_level(foot - rise * own_normal, direction, up);
	vec4 own = less_covered(shown, turned.w < below.w ? below : turned);
	own *= min(1.0, own_most / (size * max(own.w, 1e-6)));
	return shown.w > 1.1 * own.w ? max(shown - own, vec4(0.0)) : vec4(0.0);
}

/* As above, between two levels. */
vec4 sample_between(vec3 g, vec3 direction, float level, float own_most)
{
	uint up = uint(level);
	float between = level - float(up);
	vec4 shown = sample_others(g, direction, up, own_most);
	if (between > 1e-3 && up + 1u < depth)
		shown = mix(shown, sample_others(g, direction, up + 1u, own_most), between);
	return shown;
}

/* open: what is left, 0..1. */
vec3 trace_cone(vec3 origin, vec3 direction, float tangent, out float open)
{
	float side = exp2(float(depth));
	vec3 radiance = vec3(0.0);
	float filled = 0.0, through = 1.0, own_most = own_cover(direction);
	float t = push.start;
	for (uint step = 0u; step < 256u && filled < 0.995 && through > 0.005; step++) {
		float width = max(1.0, 2.0 * t * tangent);
		vec3 g = origin + direction * (t + 0.5 * width);
		if (any(lessThan(g, vec3(-width))) || any(greaterThan(g, vec3(side + width))))
			break;
		float level = min(log2(width), float(depth - 1u));
		vec4 shown = sample_between(g, direction, level, own_most);
		float opacity = width * shown.w;
		if (opacity > 1e-6) {
			float taken = min(opacity, 1.0 - filled);
			radiance += shown.xyz * (width * taken / opacity * through);
			filled += taken;
		} else {
			end_sheet(filled, through);
		}
		t += width;
	}
	open = through * (1.0 - min(filled, 1.0));
	return radiance / push.scale;
}

#endif
