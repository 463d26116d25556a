/*
 * brick_pool.glsl - where a brick's voxels lie in a pool.
 *
 * A pool is one 3D image. Bricks of 3x3x3 voxels stand in rows and layers; the six directional
 * faces (+x -x +y -y +z -z) are six such stacks one behind the other in z. A voxel's face holds
 * F (rgb), the radiance-weighted area that it shows to a ray along the face's inward direction, and
 * G (alpha), that area, both per cell area: light-transport uses only the side that faces the ray.
 */
#ifndef BRICK_POOL_GLSL
#define BRICK_POOL_GLSL

ivec3 brick_corner(uint brick, uint row, uint rows)
{
	uint layer = row * rows;
	return 3 * ivec3(brick % row, brick % layer / row, brick / layer);
}

const vec3 FACE_NORMAL[6] = vec3[6](vec3(1, 0, 0), vec3(-1, 0, 0), vec3(0, 1, 0), vec3(0, -1, 0),
									vec3(0, 0, 1), vec3(0, 0, -1));

#endif
