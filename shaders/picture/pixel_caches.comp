/*
 * pixel_caches.comp - read-back step of gloss caches: one invocation a pixel. The pixel looks in a
 * few directions that share its lobe, each into one of the caches near by, and takes there the
 * level whose texels are as wide as the look's share. Which directions and caches these are differs
 * from pixel to pixel, and is to be smoothed. rgb is the light reflected, w the share of all light
 * that is.
 */
#include "picture/gloss_cache.h"
#include "picture/glossy.glsl"
#include "picture/hemisphere_map.glsl"

TEXELS(0, uint, tile_first);    /* the first cache of each tile; one more */
TEXELS(1, vec4, cache_place);   /* grid coordinates, reach */
TEXELS(2, vec4, cache_facing);  /* unit */
TEXELS(3, uint, cache_pixel);   /* where it is in the picture, x and y of 16 bits */
TEXELS(4, vec4, cache_texel);
TEXELS(5, uvec2, pixel_screen); /* likewise, and the cache of the pixel's own cluster */
BUFFER(6, readonly, vec4, pixel_position); /* grid coordinates, roughness */
BUFFER(7, readonly, vec4, pixel_normal);   /* unit, reflectance */
BUFFER(8, writeonly, vec4, pixel_reflected);
PUSH(gw_cache_push);

/* Those that weigh most, in descending order, and the next one, whose weight is taken off all, so
 * that a cache comes and goes at a weight of nothing. */
uint near_cache[GW_CACHES_READ + 1u];
float near_weight[GW_CACHES_READ + 1u];
uint near_count;

/* Steps to where a cache sees what is seen from the pixel. */
#define PLACE_STEPS 2u

/* Their frames, and where the pixel is in these. */
vec3 near_tangent[GW_CACHES_READ], near_bitangent[GW_CACHES_READ], near_normal[GW_CACHES_READ];
vec3 near_off[GW_CACHES_READ];

void add_near(uint cache, float weight)
{
	uint k = min(near_count, GW_CACHES_READ);
	if (near_count > GW_CACHES_READ && !(weight > near_weight[GW_CACHES_READ]))
		return;
	for (; k > 0u && near_weight[k - 1u] < weight; k--) {
		near_cache[k] = near_cache[k - 1u];
		near_weight[k] = near_weight[k - 1u];
	}
	near_cache[k] = cache;
	near_weight[k] = weight;
	near_count = min(near_count + 1u, GW_CACHES_READ + 1u);
}

/* The lesser of two: how near in the world, and how near in the picture. */
float weight_of(uint cache, vec3 g, vec2 pixel)
{
	vec4 place = texelFetch(cache_place, int(cache));
	uint screen = texelFetch(cache_pixel, int(cache)).x;
	vec2 aside = vec2(float(screen & 0xffffu), float(screen >> 16)) - pixel;
	vec3 off = place.xyz - g;
	float reach = GW_CACHE_REACH * float(push.tile);
	return min(1.0f - dot(off, off) / (place.w * place.w),
			   1.0f - dot(aside, aside) / (reach * reach));
}

void find_near(vec3 g, uvec2 screen)
{
	uint x = screen.x & 0xffffu, y = screen.x >> 16;
	uint reach = uint(GW_CACHE_REACH * float(push.tile));
	uint left = (x - min(x, reach)) / push.tile, top = (y - min(y, reach)) / push.tile;
	uint right = min((x + reach) / push.tile, push.columns - 1u);
	uint bottom = min((y + reach) / push.tile, push.rows - 1u);
	near_count = 0u;
	for (uint row = top; row <= bottom; row++) {
		uint cache = texelFetch(tile_first, int(row * push.columns + left)).x;
		uint last = texelFetch(tile_first, int(row * push.columns + right + 1u)).x;
		for (; cache < last; cache++) {
			float weight = weight_of(cache, g, vec2(float(x), float(y)));
			if (weight > 0.0f)
				add_near(cache, weight);
		}
	}
	float least = near_count > GW_CACHES_READ ? near_weight[GW_CACHES_READ] : 0.0f;
	near_count = min(near_count, GW_CACHES_READ);
	for (uint k = 0u; k < near_count; k++)
		near_weight[k] -= least;
	if (near_count > 0u && near_weight[0] > 0.0f)
		return;
	near_cache[0] = screen.y;
	near_weight[0] = 1.0f;
	near_count = 1u;
}

/* Also sums the squares of their weights up: what is nearest sees most alike. */
void find_frames(vec3 g)
{
	for (uint k = 0u; k < near_count; k++) {
		near_weight[k] = near_weight[k] * near_weight[k] + (k > 0u ? near_weight[k - 1u] : 0.0f);
		vec3 normal = texelFetch(cache_facing, int(near_cache[k])).xyz, t, b;
		vec3 off = g - texelFetch(cache_place, int(near_cache[k])).xyz;
		tangent_frame(normal, t, b);
		near_tangent[k] = t;
		near_bitangent[k] = b;
		near_normal[k] = normal;
		near_off[k] = vec3(dot(t, off), dot(b, off), dot(normal, off));
	}
}

/* Four texels of a level, between whose middles a place is: the first of them, steps to the one on
 * the right and the one below, and how far the place is from the first towards these. */
struct Quad {
	int at, right, below;
	float across, down;
};

Quad quad_at(uint cache, uint level, vec2 place)
{
	uint side = GW_CACHE_SIDE >> level;
	float most = float(side - 1u);
	float x = clamp(place.x * float(side) - 0.5f, 0.0f, most);
	float y = clamp(place.y * float(side) - 0.5f, 0.0f, most);
	uint column = uint(x), row = uint(y);
	uint first = cache * GW_CACHE_TEXELS + cache_level_first(level);
	Quad quad = { int(first + row * side + column), column + 1u < side ? 1 : 0,
				  row + 1u < side ? int(side) : 0, x - float(column), y - float(row) };
	return quad;
}

/* The radiance of a level of a cache at a place. */
vec3 read_radiance(uint cache, uint level, vec2 place)
{
	Quad q = quad_at(cache, level, place);
	vec3 upper = mix(vec3(texelFetch(cache_texel, q.at).xyz),
					  vec3(texelFetch(cache_texel, q.at + q.right).xyz), q.across);
	vec3 lower = mix(vec3(texelFetch(cache_texel, q.at + q.below).xyz),
					  vec3(texelFetch(cache_texel, q.at + q.below + q.right).xyz), q.across);
	return mix(upper, lower, q.down);
}

/* The inverse of the distance that it comes from. */
float read_inverse(uint cache, vec2 place)
{
	Quad q = quad_at(cache, 0u, place);
	return mix(
		mix(texelFetch(cache_texel, q.at).w, texelFetch(cache_texel, q.at + q.right).w, q.across),
		mix(texelFetch(cache_texel, q.at + q.below).w,
			texelFetch(cache_texel, q.at + q.below + q.right).w, q.across),
		q.down);
}

/* One of those near by, the more often the more it weighs; pick in [0, 1). */
uint picked(float pick)
{
	uint k = 0u;
	for (; k + 1u < near_count && near_weight[k] <= pick * near_weight[near_count - 1u]; k++) {
	}
	return k;
}

/* The radiance that the k-th of them knows of a direction. Whatever the pixel sees there is at some
 * distance, by which the cache sees it elsewhere; how far it is the cache knows where it is seen,
 * which is looked for. */
vec3 look(uint k, vec3 direction, float level)
{
	uint cache = near_cache[k];
	vec3 way = vec3(dot(near_tangent[k], direction), dot(near_bitangent[k], direction),
					dot(near_normal[k], direction));
	vec2 place = hemisphere_place(way);
	for (uint times = 0u; times < PLACE_STEPS; times++)
		place = hemisphere_place(normalize(way + near_off[k] * read_inverse(cache, place)));
	uint fine = uint(level);
	float between = level - float(fine);
	vec3 seen = read_radiance(cache, fine, place);
	return between > 0.01f ? mix(seen, read_radiance(cache, fine + 1u, place), between) : seen;
}

/* How coarse a level is for looks of a solid angle. What is read between the middles of texels is
 * half as wide again as these, so that they are to be finer. */
float level_of(float angle)
{
	float level = 0.5f * log2(angle / GW_CACHE_ANGLE) - 0.5f;
	return clamp(level, 0.0f, float(GW_CACHE_LEVELS - 1u));
}

/* What is read of the finest level was spread over a texel by its ray, and is again between four:
 * by a quarter of its solid angle, of which facets that turn half as far have a quarter. The lobe
 * is that much narrower, and as wide as it should be thereafter. */
float narrowed(float alpha)
{
	return sqrt(max(alpha * alpha - GW_CACHE_ANGLE / 16.0f, 0.001f));
}

/* A tangent that turns with the eye, so that neighbours look in the same directions around it. */
vec3 tangent_to_eye(vec3 normal, vec3 to_eye)
{
	vec3 aside = cross(normal, to_eye), t, b;
	tangent_frame(normal, t, b);
	return dot(aside, aside) > 1e-8f ? cross(normalize(aside), normal) : t;
}

void main()
{
	uint i = gl_GlobalInvocationID.x;
	if (i >= push.count)
		return;
	vec3 g = pixel_position[i].xyz;
	float roughness = pixel_position[i].w, reflectance = pixel_normal[i].w;
	float alpha = narrowed(roughness * roughness);
	vec3 to_eye = normalize(push.eye.xyz - g);
	vec3 normal = face_eye(pixel_normal[i].xyz, to_eye);
	uvec2 screen = texelFetch(pixel_screen, int(push.pixel_first + push.first + i)).xy;
	find_near(g, screen);
	find_frames(g);
	vec3 t = tangent_to_eye(normal, to_eye), b = cross(normal, t);
	vec3 eye = vec3(dot(t, to_eye), dot(b, to_eye), dot(normal, to_eye));
	uint own = pcg_hash2(screen.x, push.seed);
	float turn = unit_float(own), ring = unit_float(pcg_hash2(own, 1u));
	float shift = unit_float(pcg_hash2(own, 2u));
	vec4 sum = vec4(0.0f, 0.0f, 0.0f, 0.0f);
	for (uint k = 0u; k < GW_CACHE_LOOKS; k++) {
		/* A spiral by the golden angle. Its rings count less the further out they are, where what
		 * is bright would else be met by too few. */
		float looks = float(GW_CACHE_LOOKS), outside = 1.0f - float(k) / looks;
		float part = (2.0f * outside - 1.0f / looks) / looks;
		vec2 u = vec2(fract(float(k) * 0.618033988749895f + turn),
					  1.0f - outside * outside + ring * part);
		vec3 facet = visible_facet(eye, alpha, u);
		vec3 way = thrown_by(eye, facet);
		float level = level_of(part / facet_density(eye, alpha, facet.z));
		vec3 seen = look(picked(fract(float(k) * 0.7548776662f + shift)),
						 normalize(t * way.x + b * way.y + normal * way.z), level);
		sum += vec4(seen, 1.0f) * (part * fresnel(reflectance, dot(eye, facet)));
	}
	pixel_reflected[i] = sum;
}
