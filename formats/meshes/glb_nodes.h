/*
 * glb_nodes.h - which meshes of a glTF document stand where.
 */
#ifndef GLB_NODES_H
#define GLB_NODES_H

#include "meshes/glb_document.h"

typedef struct glb_placed {
	json_t *mesh;      /* belongs to the document */
	double matrix[16]; /* to the scene, row-major */
} glb_placed;

/*
 * Lists the meshes of the document's scene, with their nodes' transforms multiplied up; those of
 * all roots when it names no scene.
 *   placed   receives *count entries, owned by the caller, freed with free(); NULL on failure
 *   error    the document's: GW_ERROR_DATA when nodes go in a circle or lead nowhere, or when
 *            there is no mesh; GW_ERROR_MEMORY
 */
gw_status glb_list_meshes(const glb_document *document, glb_placed **placed, size_t *count);

#endif
