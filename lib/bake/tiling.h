/*
 * tiling.h - a cloud that memory does not hold, parted by place: its tiles, and which points belong
 * to each; see gw_tiling in glowworm_parts.h.
 *
 * Space is cut into cubes of one width. Those that hold points, in Morton order, are cut into runs
 * of about as many points: the tiles. What is within GW_TILE_HALO cubes of a tile is its halo.
 * Morton order keeps runs compact, so that halos hold few points beside them.
 */
#ifndef TILING_H
#define TILING_H

#include "glowworm_parts.h"

/* Cubes around a tile whose points its surface is made of, too. */
#define GW_TILE_HALO 2

#endif
