/*
 * record_share.comp - light of records by the rays of those around them beside their own: what a
 * ray of one meets, most of its neighbours see as well, from another place and in another
 * direction. What changes by that is added to what their own rays brought.
 *
 * A ray of record j that meets the place y is a sample of what record i sees. Any record m around
 * could have drawn it, at y as densely as d_m = cos_m cos_y / |y - g_m|^2, and in a direction to
 * the sky as d_m = cos_m. If samples of m count w_m times, by the balance heuristic (Veach) it
 * brings i w_j d_i / sum_m w_m d_m times what a ray of its own brings. So a record gathers along
 * the rays of all, from its own place and with its own normal. That it sees y is taken for granted;
 * where that is wrong it is as wrong as a mean over the records that light a point.
 */
#include "base/pass.glsl"
#include "light/transport_layout.h"

TEXELS(0, uint, hit_facet);
TEXELS(1, vec4, facet_radiance);
TEXELS(2, vec4, record_position);
TEXELS(3, vec4, record_normal); /* w: below 1 if buried */
TEXELS(4, vec4, facet_plane);
TEXELS(5, float, hit_distance);
TEXELS(6, uint, record_facet); /* where each was placed */
TEXELS(7, uint, facet_row);
TEXELS(8, uvec4, facet_record); /* four a texel, GW_WEIGHTS a row: the records around a facet */
TEXELS(9, vec4, sky_texel);
BUFFER(10, readonly, vec4, record_mark); /* w: of its compartment */
BUFFER(11, readwrite, vec4, record_first);
BUFFER(12, readwrite, vec4, first_moment); /* 2 a record */
BUFFER(13, readwrite, vec4, record_indirect);
BUFFER(14, readwrite, vec4, indirect_moment);
PUSH(gw_record_push);

#include "light/record_moment.glsl"
#include "light/sky_map.glsl"

/* What is nearer than this, leaf cells, is as near as can be told. */
#define NEAREST 0.5f

/* The records whose rays are shared: its own first. */
#define MEMBERS 8u
uint member[MEMBERS], members;
vec3 place[MEMBERS], facing[MEMBERS];
float often[MEMBERS]; /* how many times samples of each count */

/* Neighbours count the less the nearer what a record sees is beside how far they are apart, because
 * from there it looks different, and the more rays a record has, because that weighs against their
 * noise. Returns how much they do for each leaf cell^2, by the mean inverse distance of what the
 * rays met, as in Ward's harmonic mean. */
float unlikeness(uint record)
{
	float sum = 0.0f;
	for (uint k = 0u; k < push.rays; k++) {
		int hit = int(record * push.rays + k);
		if (texelFetch(hit_facet, hit).x != GW_NONE)
			sum += 1.0f / max(abs(texelFetch(hit_distance, hit).x), NEAREST);
	}
	return sum * sum / float(push.rays);
}

void add_member(uint record, float unlike)
{
	vec4 normal = texelFetch(record_normal, int(record));
	if (normal.w < 1.0f || members == MEMBERS)
		return;
	member[members] = record;
	place[members] = texelFetch(record_position, int(record)).xyz;
	facing[members] = normal.xyz;
	vec3 off = place[members] - place[0];
	often[members] = 1.0f / (1.0f + unlike * dot(off, off));
	members++;
}

/* The record and those that light its facet; none if it stands on the back of that, or is buried.
 */
void list_members(uint record)
{
	uint facet = texelFetch(record_facet, int(record)).x;
	members = 0u;
	if ((facet & GW_RECORD_BACK) != 0u)
		return;
	add_member(record, 0.0f);
	float unlike = members > 0u ? unlikeness(record) : 0.0f;
	int row = int(texelFetch(facet_row, int(facet)).x * (GW_WEIGHTS / 4u));
	for (int t = row; t < row + int(GW_WEIGHTS / 4u) && members > 0u; t++) {
		uvec4 others = texelFetch(facet_record, t);
		for (int k = 0; k < 4; k++)
			if (others[k] != GW_NONE && others[k] != record)
				add_member(others[k], unlike);
	}
}

/* What a ray brings. */
struct Brought {
	vec3 direction; /* from the record that gathers */
	vec3 y, plane;  /* what it met, and its normal */
	vec3 radiance;
	bool sky; /* it met nothing */
};

/* What the sky sends from a direction, as far as rays stand for it beside samples of its map. */
vec3 sky_at(vec3 direction)
{
	vec3 sum = push.sky.xyz;
	if (push.sky_hits == 0u)
		return sum;
	vec3 radiance = texelFetch(sky_texel, sky_texel_at(direction)).xyz;
	float by_samples = float(push.sky_samples) * luminance(radiance) / push.sky_total;
	float by_rays = float(push.rays) * max(dot(facing[0], direction), 0.0f) / GW_PI;
	return sum + radiance * (by_rays / max(by_rays + by_samples, 1e-30f));
}

/* Ray k of member j; sky: whether it may see that. */
Brought follow(uint j, uint k, bool sky)
{
	int hit = int(member[j] * push.rays + k);
	uint facet = texelFetch(hit_facet, hit).x;
	float cosine;
	vec3 way = record_ray(place[j], facing[j], k, cosine);
	if (facet == GW_NONE) {
		Brought far = { way, way, way, sky ? sky_at(way) : vec3(0.0f), true };
		return far;
	}
	vec3 y = place[j] + way * abs(texelFetch(hit_distance, hit).x), radiance = vec3(0.0f);
	if (push.use_hits != 0u)
		radiance = texelFetch(facet_radiance, int(facet)).xyz;
	Brought near = { normalize(y - place[0]), y, texelFetch(facet_plane, int(facet)).xyz, radiance,
					 false };
	return near;
}

/* The same four at a time. */
vec4a place_x[2], place_y[2], place_z[2], facing_x[2], facing_y[2], facing_z[2], often_four[2];

void list_in_fours()
{
	for (uint m = members; m < MEMBERS; m++) {
		place[m] = place[0];
		facing[m] = facing[0];
		often[m] = 0.0f;
	}
	for (int f = 0; f < 2; f++) {
		int a = 4 * f, b = a + 1, c = a + 2, d = a + 3;
		place_x[f] = vec4a(vec4(place[a].x, place[b].x, place[c].x, place[d].x));
		place_y[f] = vec4a(vec4(place[a].y, place[b].y, place[c].y, place[d].y));
		place_z[f] = vec4a(vec4(place[a].z, place[b].z, place[c].z, place[d].z));
		facing_x[f] = vec4a(vec4(facing[a].x, facing[b].x, facing[c].x, facing[d].x));
		facing_y[f] = vec4a(vec4(facing[a].y, facing[b].y, facing[c].y, facing[d].y));
		facing_z[f] = vec4a(vec4(facing[a].z, facing[b].z, facing[c].z, facing[d].z));
		often_four[f] = vec4a(vec4(often[a], often[b], often[c], often[d]));
	}
}

/* How densely rays of four members find it, but for a factor. */
vec4a densities(int f, IN(Brought) what)
{
	vec4a zero = vec4a(0.0f);
	if (what.sky)
		return max(facing_x[f] * what.direction.x + facing_y[f] * what.direction.y +
					   facing_z[f] * what.direction.z,
				   zero);
	/* From what was met to the members. */
	vec4a x = place_x[f] - what.y.x, y = place_y[f] - what.y.y, z = place_z[f] - what.y.z;
	vec4a squared = max(x * x + y * y + z * z, vec4a(1e-8f));
	vec4a cosine = max((x * facing_x[f] + y * facing_y[f] + z * facing_z[f]) * -1.0f, zero);
	vec4a other = max(x * what.plane.x + y * what.plane.y + z * what.plane.z, zero);
	return cosine * other / (squared * squared);
}

/* How many rays of its own that stands for. */
float share_of(uint j, IN(Brought) what)
{
	vec4a near = densities(0, what);
	float own = near[0];
	if (!(own > 0.0f)) /* its own rays find what faces away, where that is not known */
		return j == 0u ? 1.0f : 0.0f;
	vec4a sum = near * often_four[0];
	if (members > 4u)
		sum = sum + densities(1, what) * often_four[1];
	return often[j] * own / (sum[0] + sum[1] + sum[2] + sum[3]);
}

/* What rays bring, and how its irradiance changes along both tangents. */
struct Light {
	vec3 sum, along, across;
};

/* Of the sky, and of what was hit; how many rays of its own they stand for. */
struct Gathered {
	Light sky, hits;
	float rays;
};

void add(INOUT(Light) to, vec3 radiance, vec2 turn)
{
	to.sum += radiance;
	to.along += radiance * turn.x;
	to.across += radiance * turn.y;
}

/* By the rays of so many members; sky: whether they may see that. */
Gathered gather(uint count, bool sky)
{
	Light dark = { vec3(0.0f), vec3(0.0f), vec3(0.0f) };
	Gathered to = { dark, dark, 0.0f };
	vec3 t, b;
	tangent_frame(facing[0], t, b);
	for (uint j = 0u; j < count; j++)
		for (uint k = 0u; k < push.rays; k++) {
			Brought what = follow(j, k, sky);
			float share = count > 1u ? share_of(j, what) : 1.0f;
			vec3 way = what.direction, radiance = what.radiance * share;
			vec2 turn =
				moment_share(vec2(dot(way, t), dot(way, b)), max(dot(way, facing[0]), 0.0f));
			to.rays += share;
			if (what.sky)
				add(to.sky, radiance, turn);
			else
				add(to.hits, radiance, turn);
		}
	return to;
}

/* By how much light differs. What all rays stand for is known, so that even light does not. */
Light change(IN(Light) by_all, float all, IN(Light) by_own, float own)
{
	float a = GW_PI / all, b = GW_PI / own;
	Light by = { by_all.sum * a - by_own.sum * b, by_all.along * a - by_own.along * b,
				 by_all.across * a - by_own.across * b };
	return by;
}

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	list_members(push.first + i);
	if (members < 2u)
		return;
	list_in_fours();
	bool sky = push.looked == 0u && !(record_mark[i].w > GW_MARK_OUTSIDE);
	Gathered all = gather(members, sky), own = gather(1u, sky);
	Light first = change(all.sky, all.rays, own.sky, own.rays);
	Light indirect = change(all.hits, all.rays, own.hits, own.rays);
	/* Rounding leaves less than nothing where all that came is taken off. */
	record_first[i].xyz = max(record_first[i].xyz + first.sum, vec3(0.0f));
	record_indirect[i].xyz = max(record_indirect[i].xyz + indirect.sum, vec3(0.0f));
	if (push.moments == 0u)
		return;
	first_moment[2u * i].xyz += first.along;
	first_moment[2u * i + 1u].xyz += first.across;
	indirect_moment[2u * i].xyz += indirect.along;
	indirect_moment[2u * i + 1u].xyz += indirect.across;
}
