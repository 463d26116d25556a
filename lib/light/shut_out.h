/*
 * shut_out.h - what no light can reach, because rock lies all around it: by the compartments of
 * empty space (octree/compartments.h). Rays find the way through it at times.
 *
 * But for gw_shut_out_label they do nothing where the octree has one compartment, or was not asked.
 */
#ifndef SHUT_OUT_H
#define SHUT_OUT_H

#include "light/records.h"
#include "light/shadow_map.h"

/*
 * Normals of surfels, as passes of lamps take them, but none for those that a light is shut out
 * from: then it shines on them at no angle.
 *   normal   4 floats a surfel
 *   shut     an empty buffer; stays so where there is nothing to leave out; the caller's on success
 */
gw_status gw_shut_out_light(const gw_lit_cloud *cloud, const gw_light_push *light,
							const gw_buffer *normal, gw_buffer *shut, gw_error *error);

/* Does all that a light shines on lie around the scene's closed spaces, not in one? There are
 * several compartments. */
bool gw_shut_out_is_outside(const gw_octree *octree, const gw_light_push *light);

/* The compartments that records look into. There are several.
 *   label   receives one a record, the caller's on success */
gw_status gw_shut_out_label(const gw_record_context *on, uint32_t **label, gw_error *error);

/*
 * Marks records with the compartments that they look into, for passes that sample emitters and sky.
 *   marks   4 floats a record: the last receives gw_compartment_mark
 */
gw_status gw_shut_out_mark(const gw_record_context *on, gw_buffer *marks, gw_error *error);

/*
 * Puts right the rays that slipped through rock: out of a compartment that is closed, or to surface
 * in another one. They take what the ray of their record before them hit, or the first that did not
 * slip, so that what is closed loses no light; where all slipped through, they see none.
 *   rays    a record
 *   facet   R32_UINT, rays * records: what each ray hit
 */
gw_status gw_shut_out_hits(const gw_record_context *on, uint32_t rays, gw_buffer *facet,
						   gw_error *error);

/* Places that sent rays, in compartments. */
typedef struct gw_labelled_rays {
	const uint32_t *label; /* count */
	size_t count;
	uint32_t rays;         /* of each */
	const uint32_t *facet; /* NULL, or of what they hit, where that is more than facets */
} gw_labelled_rays;

/* The same for places that are no records; on has the octree alone. */
gw_status gw_shut_out_hits_of(const gw_record_context *on, const gw_labelled_rays *from,
							  gw_buffer *facet, gw_error *error);

#endif
