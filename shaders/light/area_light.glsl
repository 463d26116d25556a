/*
 * area_light.glsl - what spheres, discs and rectangles of even radiance send to a place, and rays
 * to them. Uses `push`, a gw_light_push of such a light: discs and rectangles shine to the side of
 * push.direction; those of luminaires have a `distribution`, by which each part of them shines.
 */
#ifndef AREA_LIGHT_GLSL
#define AREA_LIGHT_GLSL

/* Corners by which a disc is taken for a polygon of the same area. */
#define GW_DISC_CORNERS 48u

/* Lights this small beside their distance are points: their squares are lost in single precision,
 * and what they are wrong by is of that order. */
#define GW_AREA_SMALL 0.01f

/* Solid angles below this are sampled by area. */
#define GW_SPHERICAL_LEAST 1e-3f

bool is_area_light()
{
	return push.type >= GW_PUSH_SPHERE;
}

/* Projected solid angle of the sphere over pi, on a surface whose normal has that cosine to its
 * middle; distance: in radii. Known as the form factor of a sphere that the horizon may cut. */
float sphere_factor(float cosine, float distance)
{
	float h = max(distance, 1.0001f), sine = sqrt(max(1.0f - cosine * cosine, 0.0f));
	if (cosine * h >= 1.0f)
		return cosine / (h * h);
	if (cosine * h <= -1.0f || sine < 1e-6f)
		return 0.0f;
	float x = sqrt(h * h - 1.0f), y = clamp(-x * cosine / sine, -1.0f, 1.0f);
	float root = sine * sqrt(1.0f - y * y);
	return max((cosine * acos(y) - x * root) / (GW_PI * h * h) + atan(root, x) / GW_PI, 0.0f);
}

/* Part of Lambert's formula for a polygon: an edge's angle times the cosine between the normal and
 * that of the plane through the edge and the place. */
float edge_factor(vec3 a, vec3 b, vec3 normal)
{
	vec3 c = cross(a, b);
	float s = length(c);
	return s > 1e-12f ? atan(s, dot(a, b)) * dot(c, normal) / s : 0.0f;
}

/* Corner k from the middle. */
vec3 area_corner(uint k)
{
	vec3 across = push.across.xyz, up = cross(across, push.direction.xyz);
	if (push.type == GW_PUSH_RECTANGLE)
		return across * (k == 0u || k == 3u ? push.across.w : -push.across.w) +
			   up * (k < 2u ? push.half_height : -push.half_height);
	float step = 2.0f * GW_PI / float(GW_DISC_CORNERS);
	/* So far out that the polygon is as large as the disc. */
	float radius = push.position.w * sqrt(step / sin(step));
	return (across * cos(float(k) * step) + up * sin(float(k) * step)) * radius;
}

/* Twice the projected solid angle of what of the light is above the horizon; where the horizon cuts
 * edges, the part between the two cuts is an edge as well. */
float polygon_factor(vec3 middle, vec3 normal)
{
	uint corners = push.type == GW_PUSH_RECTANGLE ? 4u : GW_DISC_CORNERS;
	vec3 from = middle + area_corner(corners - 1u), leaves = vec3(0.0f, 0.0f, 0.0f);
	vec3 enters = leaves;
	float sum = 0.0f, height = dot(from, normal);
	for (uint k = 0u; k < corners; k++) {
		vec3 to = middle + area_corner(k), a = from, b = to;
		float next = dot(to, normal);
		if ((height > 0.0f) != (next > 0.0f)) {
			vec3 cut = from + (to - from) * (height / (height - next));
			if (height > 0.0f) {
				b = cut;
				leaves = cut;
			} else {
				a = cut;
				enters = cut;
			}
		}
		if (height > 0.0f || next > 0.0f)
			sum += edge_factor(a, b, normal);
		from = to;
		height = next;
	}
	return abs(sum + edge_factor(leaves, enters, normal));
}

/* Irradiance over the intensity along the axis, on one side of a surface. */
float area_factor(vec3 g, vec3 normal)
{
	vec3 to = push.position.xyz - g;
	float squared = max(dot(to, to), 1e-12f), distance = sqrt(squared);
	float cosine = dot(to, normal) / distance, radius = push.position.w;
	if (push.type == GW_PUSH_SPHERE)
		return sphere_factor(cosine, distance / radius) / (radius * radius);
	float front = -dot(to, push.direction.xyz) / distance;
	if (front <= 0.0f)
		return 0.0f;
	bool disc = push.type == GW_PUSH_DISC;
	float reach = disc ? radius : max(push.across.w, push.half_height);
	if (reach < GW_AREA_SMALL * distance)
		return max(cosine, 0.0f) * front / squared;
	float area = disc ? GW_PI * radius * radius : 4.0f * push.across.w * push.half_height;
	return 0.5f * polygon_factor(to, normal) / area;
}

/* Parts that a luminaire's area is taken for. */
#define GW_LUMINAIRE_PARTS 64u

bool is_luminaire_area()
{
	return is_area_light() && push.verticals > 0u;
}

/* The middle of a part, from the middle of all: of a disc four rings, of a rectangle rows of
 * parts that are about as long as wide. All are as large. */
vec3 luminaire_part(uint s)
{
	vec3 across = push.across.xyz, up = cross(across, push.direction.xyz);
	if (push.type == GW_PUSH_DISC) {
		uint ring = uint(0.5f * sqrt(float(s) + 0.25f));
		float r = float(ring), count = 8.0f * r + 4.0f;
		float turn = 2.0f * GW_PI * (float(s) - 4.0f * r * r + 0.5f) / count;
		float radius = 0.25f * push.position.w * sqrt(r * r + r + 0.5f);
		return (across * cos(turn) + up * sin(turn)) * radius;
	}
	uint columns = 8u;
	float ratio = push.across.w / push.half_height;
	for (; ratio > 2.0f && columns < GW_LUMINAIRE_PARTS; ratio *= 0.25f)
		columns *= 2u;
	for (; ratio < 0.5f && columns > 1u; ratio *= 4.0f)
		columns /= 2u;
	uint rows = GW_LUMINAIRE_PARTS / columns;
	float x = (2.0f * float(s % columns) + 1.0f) / float(columns) - 1.0f;
	float y = (2.0f * float(s / columns) + 1.0f) / float(rows) - 1.0f;
	return across * (x * push.across.w) + up * (y * push.half_height);
}

/* Share of its intensity that a luminaire sends that way, over the squared distance. `aim` leads
 * from the place to a part of it. */
float luminaire_sends(vec3 aim, float part)
{
	vec3 axis = push.direction.xyz, across = push.across.xyz, up = cross(across, axis);
	float squared = max(dot(aim, aim), max(part, 1e-12f));
	vec3 way = aim * (-1.0f / sqrt(squared));
	return distribution_share(push.verticals, push.horizontals,
							  vec3(dot(way, across), dot(way, up), dot(way, axis))) /
		   squared;
}

/* As area_received, of a luminaire: the sum over its parts. Nearer than a part is wide, the
 * distance stops falling. */
float luminaire_received(vec3 g, vec4 normal)
{
	vec3 to = push.position.xyz - g;
	float radius = push.position.w, sum = 0.0f;
	float area = push.type == GW_PUSH_DISC ? GW_PI * radius * radius
										   : 4.0f * push.across.w * push.half_height;
	for (uint s = 0u; s < GW_LUMINAIRE_PARTS; s++) {
		vec3 aim = to + luminaire_part(s);
		float cosine = dot(normal.xyz, aim) / max(length(aim), 1e-6f);
		cosine = normal.w > 0.5f ? abs(cosine) : max(cosine, 0.0f);
		if (cosine > 0.0f)
			sum += cosine * luminaire_sends(aim, area / float(GW_LUMINAIRE_PARTS));
	}
	return sum / float(GW_LUMINAIRE_PARTS);
}

/* Both sides of a surface whose normal is not trusted. */
float area_received(vec3 g, vec4 normal)
{
	if (is_luminaire_area())
		return luminaire_received(g, normal);
	float front = area_factor(g, normal.xyz);
	return normal.w > 0.5f ? front + area_factor(g, normal.xyz * -1.0f) : front;
}

/* A place on the rectangle, u and v from 0 to 1, even in solid angle: C. Urena, M. Fajardo, A.
 * King, An Area-Preserving Parametrization for Spherical Rectangles, 2013. to: its middle. */
vec3 rectangle_place(vec3 to, float u, float v)
{
	vec3 across = push.across.xyz, up = cross(across, push.direction.xyz);
	float x = dot(to, across), y = dot(to, up), z = -abs(dot(to, push.direction.xyz));
	float x0 = x - push.across.w, x1 = x + push.across.w, y0 = y - push.half_height;
	float y1 = y + push.half_height;
	float b0 = -y0 / sqrt(z * z + y0 * y0), b1 = y1 / sqrt(z * z + y1 * y1);
	float n1 = x1 / sqrt(z * z + x1 * x1), n3 = -x0 / sqrt(z * z + x0 * x0);
	float k = 2.0f * GW_PI - acos(clamp(-b1 * n3, -1.0f, 1.0f)) -
			  acos(clamp(-n3 * b0, -1.0f, 1.0f));
	float whole =
		acos(clamp(-b0 * n1, -1.0f, 1.0f)) + acos(clamp(-n1 * b1, -1.0f, 1.0f)) - k;
	float px = x0 + u * (x1 - x0), py = y0 + v * (y1 - y0);
	if (whole > GW_SPHERICAL_LEAST) {
		float angle = u * whole + k, sine = sin(angle);
		float f = (cos(angle) * b0 - b1) / (abs(sine) > 1e-9f ? sine : 1e-9f);
		float c = clamp((f > 0.0f ? 1.0f : -1.0f) / sqrt(f * f + b0 * b0), -1.0f, 1.0f);
		px = clamp(-(c * z) / sqrt(max(1.0f - c * c, 1e-12f)), x0, x1);
		float d = sqrt(px * px + z * z), h0 = y0 / sqrt(d * d + y0 * y0);
		float h = h0 + v * (y1 / sqrt(d * d + y1 * y1) - h0);
		py = h * h < 0.999999f ? clamp(h * d / sqrt(1.0f - h * h), y0, y1) : y1;
	}
	return to + across * (px - x) + up * (py - y);
}

/* Aims the s-th ray, of push.samples, at the light: of spheres and rectangles even in solid angle,
 * of discs and luminaires in area, for which `weight` makes up. turn: by how much places are
 * turned, in turns. */
void aim_at_area(uint s, float turn, vec3 g, INOUT(Ray) ray, OUT(float) weight)
{
	vec3 to = push.position.xyz - g, t, b, aim = to;
	float distance = max(length(to), 1e-6f), n = float(push.samples);
	weight = 1.0f;
	if (push.type == GW_PUSH_RECTANGLE && is_luminaire_area()) {
		vec3 across = push.across.xyz, up = cross(across, push.direction.xyz);
		float x = (2.0f * float(s) + 1.0f) / n - 1.0f;
		float y = 2.0f * fract((float(s) + 0.5f) * 0.618033988749895f + turn) - 1.0f;
		aim = to + across * (x * push.across.w) + up * (y * push.half_height);
		weight = luminaire_sends(aim, 0.0f);
	} else if (push.type == GW_PUSH_RECTANGLE) {
		aim = rectangle_place(to, (float(s) + 0.5f) / n,
							  fract((float(s) + 0.5f) * 0.618033988749895f + turn));
	} else if (push.type == GW_PUSH_DISC) {
		vec2 p = spiral_disc(s, push.samples, 0.5f, turn) * push.position.w;
		aim = to + push.across.xyz * p.x + cross(push.across.xyz, push.direction.xyz) * p.y;
		float squared = max(dot(aim, aim), 1e-12f);
		weight = is_luminaire_area()
					 ? luminaire_sends(aim, 0.0f)
					 : max(-dot(aim, push.direction.xyz), 0.0f) / (squared * sqrt(squared));
	} else {
		/* Within the cone that touches it; the height over its middle's direction is even. */
		float least = push.position.w / max(distance, push.position.w * 1.0001f);
		float up = sqrt(1.0f - least * least), cosine = 1.0f - (float(s) + 0.5f) / n * (1.0f - up);
		float phi = 2.0f * GW_PI * fract(float(s) * 0.618033988749895f + turn);
		float sine = sqrt(max(1.0f - cosine * cosine, 0.0f));
		vec3 middle = to * (1.0f / distance);
		tangent_frame(middle, t, b);
		aim = middle * cosine + t * (sine * cos(phi)) + b * (sine * sin(phi));
		/* As far as the sphere's surface is that way. */
		float along = distance * cosine;
		float inside = along * along - distance * distance + push.position.w * push.position.w;
		aim = aim * max(along - sqrt(max(inside, 0.0f)), 1e-6f);
	}
	float far = max(length(aim), 1e-6f);
	ray.direction = aim * (1.0f / far);
	ray.t_max = far;
}

#endif
