/*
 * transport.h - a prepared solver as bytes, and from bytes: what gw_transport in glowworm.h holds.
 *
 * The bytes, lowest byte of each number first:
 *
 *   head      magic, version, length of the whole, what was baked (hashes of positions, normals,
 *             albedo, emission, scanners), the settings that have to be the same, the solver's
 *             numbers (transport_blocks.h), and a hash of all that
 *   blocks    the arrays in the order of gw_transport_list
 *   tail      a hash of the hashes of all pieces that the blocks are cut into, 1 MiB each
 *
 * Head and blocks are filled up with zeros to multiples of GW_LENT_ALIGNMENT bytes, so that a
 * device that is the host can use the blocks where they lie, as in a file that is mapped.
 *
 * Every length follows from the head, so the whole is refused before anything is allocated when its
 * length differs. Indices are checked, so that no bytes make a pass or a loop leave its arrays.
 */
#ifndef TRANSPORT_H
#define TRANSPORT_H

#include "bake/solver.h"

/* Writes the solver of these points with transport->write. Its records have to be placed. */
gw_status gw_transport_save(gw_solver *solver, const gw_points *points,
							const gw_transport *transport, gw_error *error);

/*
 * Fills a solver whose device is open from transport->data, in place of the steps that make
 * surfels, octree and records. Emission is taken from the points. On failure the caller closes the
 * solver. GW_ERROR_DATA when the bytes are damaged or belong to other points, GW_ERROR_USAGE when
 * settings differ that have to be the same.
 */
gw_status gw_transport_load(gw_solver *solver, const gw_points *points,
							const gw_transport *transport, gw_error *error);

#endif
