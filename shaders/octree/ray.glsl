/*
 * ray.glsl - what rays are, and what they hit; for the octree and the tree of large discs.
 */
#ifndef RAY_GLSL
#define RAY_GLSL

/* One ray, in grid coordinates. */
struct Ray {
	vec3 origin, direction; /* unit */
	vec3 facing, foot;      /* of the surface that it leaves: normal, and a place on it */
	float t_max;
	bool both_sides; /* backs of surfaces stop it */
};

struct Hit {
	uint facet;   /* its number, or GW_NONE */
	float t;     /* t_max when nothing is hit */
	bool passed_back_face;
};

/* What makes a ray that leaves the scene doubtful. */
struct Doubt {
	float from, to;     /* where it first and last came near surface that does not fill its cell */
	vec3 place, normal; /* of the disc that it last passed beside */
	float t;            /* where, or GW_FAR */
};

/* A distance at which rays have left every scene, leaf cells. */
#define GW_FAR 1e9f

float inverse_of(float d)
{
	return 1.0f / (abs(d) >= 1e-20f ? d : d >= 0.0f ? 1e-20f : -1e-20f);
}

#endif
