/*
 * transport.h - a prepared scene as bytes, and from bytes: what gw_transport in glowworm.h holds.
 *
 * The bytes, lowest byte of each number first:
 *
 *   head      magic, version, length of the whole, what was baked (hashes of positions, normals,
 *             albedo, emission, scanners), the settings that have to be the same, the scene's
 *             numbers (transport_blocks.h), and a hash of all that
 *   blocks    the arrays in the order of gw_transport_list
 *   tail      a hash of all blocks: each is hashed in chunks of 1 MiB, of which its last one may be
 *             shorter, and the hashes of all chunks, in their order, are hashed into one
 *
 * Head and blocks are filled up with zeros to multiples of GW_LENT_ALIGNMENT bytes, so that a
 * device that is the host can use the blocks where they lie, as in a file that is mapped.
 *
 * Records are those that the bake which writes it had in the end: few, and more where its light
 * asked for them (refine.h). One that begins with it may add others.
 *
 * Probes are among them where some were placed (placed_probes.h).
 *
 * Every length follows from the head, so the whole is refused before anything is allocated when its
 * length differs. Indices are checked, so that no bytes make a pass or a loop leave its arrays.
 */
#ifndef TRANSPORT_H
#define TRANSPORT_H

#include "bake/lighting.h"

/* What points are told from others by. */
gw_transport_identity gw_transport_identify(const gw_points *points);

/*
 * Writes the scene of a lighting with transport->write. Its records have to be placed; what other
 * light may need of it is found first.
 *   points   those of the scene
 */
gw_status gw_transport_save(gw_lighting *lighting, const gw_transport_identity *points,
							const gw_transport *transport, gw_error *error);

/*
 * Fills a scene whose device is open from transport->data, in place of the steps that make
 * surfels, octree and records. Emission is taken from the points. On failure the caller closes the
 * scene. GW_ERROR_DATA when the bytes are damaged or belong to other points, GW_ERROR_USAGE when
 * settings differ that have to be the same.
 */
gw_status gw_transport_load(gw_scene *scene, const gw_points *points, const gw_transport *transport,
							gw_error *error);

#endif
