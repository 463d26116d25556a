/*
 * shadow_layout.h - push-constant block of the shadow map passes, shared by C and GLSL.
 *
 * Lengths are in leaf cells and positions in grid coordinates. A map lies across `forward`; texel
 * (x, y) of the window that is in memory looks along
 *   forward + right * (x + 0.5 - centre_x) / scale + up * (y + 0.5 - centre_y) / scale
 * from the light's position; of a sun that term shifts the ray's origin, and all look `forward`.
 */
#ifndef SHADOW_LAYOUT_H
#define SHADOW_LAYOUT_H

#include "base/shared_types.h"

/* Texels that the filter reaches beyond the one it is centred on. */
#define GW_SHADOW_BORDER 3u

/* Side of the part of a facet's picture that one invocation draws in one run, texels. */
#define GW_SHADOW_TILE 80u

SHARED_STRUCT(gw_shadow_push)
{
	uint first, count;
	uint side;      /* texels a side of the window, with its borders */
	uint round;     /* splat: which tile of each picture is drawn */
	vec4 origin;    /* of the light, or of the sun's plane; w: 1 for a sun, else 0 */
	vec4 right;     /* unit; w: scale, texels per unit of the tangent, or per leaf cell of a sun */
	vec4 up;        /* unit; w: range, the distance that is stored as 1 */
	vec4 forward;   /* unit; w: texels a side of the whole map */
	float centre_x; /* texel coordinates of the map's middle in this window */
	float centre_y;
	float first_x; /* texel of the whole map that the window's inner part begins at */
	float first_y;
};
SHARED_SIZE(gw_shadow_push, 96);
SHARED_OFFSET(gw_shadow_push, origin, 16);
SHARED_OFFSET(gw_shadow_push, right, 32);
SHARED_OFFSET(gw_shadow_push, up, 48);
SHARED_OFFSET(gw_shadow_push, forward, 64);
SHARED_OFFSET(gw_shadow_push, centre_x, 80);

#endif
