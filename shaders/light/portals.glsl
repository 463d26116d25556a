/*
 * portals.glsl - directions towards the portals, and how densely they lie. Needs
 * push.portals, and `portal`: a texel buffer of spheres around the portals, grid coordinates and
 * radius.
 *
 * A portal is drawn in proportion to the solid angle that its sphere takes and to the cosine at
 * which it stands; a direction within the sphere's cone evenly.
 */
#ifndef PORTALS_GLSL
#define PORTALS_GLSL

/* 1 - cosine of the cone around a sphere: its solid angle over 2 pi. Inside, all directions. */
float portal_share(vec3 to, float radius)
{
	float x = radius * radius / dot(to, to);
	return x >= 1.0f ? 2.0f : x / (1.0f + sqrt(1.0f - x));
}

/* What a portal counts for at a place, over its share; 0 only where all of it lies behind. */
float portal_slant(vec3 to, float radius, vec3 normal)
{
	float height = dot(to, normal);
	if (height <= -radius)
		return 0.0f;
	return clamp(height * inversesqrt(max(dot(to, to), 1e-12f)), 0.1f, 1.0f);
}

float portals_weight(vec3 g, vec3 normal)
{
	float sum = 0.0f;
	for (int j = 0; j < int(push.portals); j++) {
		vec4 sphere = texelFetch(portal, j);
		vec3 to = sphere.xyz - g;
		sum += portal_share(to, sphere.w) * portal_slant(to, sphere.w, normal);
	}
	return sum;
}

/* Density of portals_direction over solid angle; total: portals_weight there. */
float portals_density(vec3 g, vec3 normal, vec3 direction, float total)
{
	float sum = 0.0f;
	for (int j = 0; j < int(push.portals); j++) {
		vec4 sphere = texelFetch(portal, j);
		vec3 to = sphere.xyz - g;
		float along = dot(to, direction), beside = dot(to, to) - along * along;
		bool inside = dot(to, to) <= sphere.w * sphere.w;
		if (inside || (along > 0.0f && beside <= sphere.w * sphere.w))
			sum += portal_slant(to, sphere.w, normal);
	}
	return total > 0.0f ? sum / (2.0f * GW_PI * total) : 0.0f;
}

/* What is random at a place for these samples. */
uint portals_random(vec3 g)
{
	return pcg_hash2(pcg_hash_place(g), push.seed ^ 0x7f4a7c15u);
}

/* How far the samples of a place have come in the list of portals. */
struct PortalsTurn {
	float total;  /* portals_weight */
	float passed; /* of that, what lies behind */
	int next;     /* portal */
	uint own;     /* random for the place */
};

PortalsTurn portals_begin(vec3 g, vec3 normal)
{
	PortalsTurn turn = { portals_weight(g, normal), 0.0f, 0, portals_random(g) };
	return turn;
}

/* The m-th of GW_PORTAL_SAMPLES directions of the place at g, m growing; they share the portals
 * evenly, and all of them together visit each portal but once. */
vec3 portals_direction(vec3 g, vec3 normal, uint m, INOUT(PortalsTurn) turn)
{
	uint own = turn.own;
	float n = float(GW_PORTAL_SAMPLES);
	float choice = (float(m) + unit_float(pcg_hash2(own, 3u * m))) / n * turn.total;
	vec4 sphere = texelFetch(portal, turn.next);
	vec3 to = sphere.xyz - g;
	float weight = portal_share(to, sphere.w) * portal_slant(to, sphere.w, normal);
	while (turn.passed + weight <= choice && turn.next + 1 < int(push.portals)) {
		turn.passed += weight;
		sphere = texelFetch(portal, ++turn.next);
		to = sphere.xyz - g;
		weight = portal_share(to, sphere.w) * portal_slant(to, sphere.w, normal);
	}
	float u = unit_float(pcg_hash2(own, 3u * m + 1u)) * portal_share(to, sphere.w);
	float sine = sqrt(max(0.0f, u * (2.0f - u)));
	float phi = 2.0f * GW_PI * unit_float(pcg_hash2(own, 3u * m + 2u));
	vec3 axis = to * inversesqrt(max(dot(to, to), 1e-12f)), t, b;
	tangent_frame(axis, t, b);
	return normalize(axis * (1.0f - u) + (t * cos(phi) + b * sin(phi)) * sine);
}

#endif
