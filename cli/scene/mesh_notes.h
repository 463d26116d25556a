/*
 * mesh_notes.h - what people should know about a mesh that was read: messages on standard error.
 */
#ifndef MESH_NOTES_H
#define MESH_NOTES_H

#include "meshes/mesh.h"

/* Prints the mesh's notes, and what of it was left out.
 *   name          of the file
 *   albedo_given  its albedo comes from elsewhere */
void mesh_notes_print(const mesh *mesh, const char *name, bool albedo_given);

#endif
