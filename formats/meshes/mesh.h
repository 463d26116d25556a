/*
 * mesh.h - triangles with normals, colours and materials, from PLY, OBJ, OFF and binary glTF files,
 * and points that are sampled on them.
 *
 * A mesh is read, moved by a matrix, measured, sampled, in this order. The points come as a scan,
 * like those of any other input.
 */
#ifndef MESH_H
#define MESH_H

#include "points/format.h"

/* Index of a normal or material that a corner or triangle does not have. */
#define MESH_NONE UINT32_MAX

/* What a surface is like; from an MTL or glTF file. */
typedef struct mesh_material {
	char *name;         /* owned */
	float albedo[3];    /* linear: Kd as it stands, GW_ALBEDO_DEFAULT without */
	float emission[3];  /* radiance: Ke */
	float specular;     /* luminance of Ks */
	float roughness;    /* Pr, else (2 / (Ns + 2))^(1/4), else 1 */
	bool has_roughness; /* the file says Pr */
} mesh_material;

/* Zeroed: an empty mesh. All pointers are owned. */
typedef struct mesh {
	double *position; /* 3 * position_count, metres */
	size_t position_count;
	float *color;  /* 3 * position_count, linear, or NULL */
	float *normal; /* 3 * normal_count, any length; NULL when there are none */
	size_t normal_count;
	uint32_t *corner;        /* 3 * triangle_count, indices of positions, counter-clockwise */
	uint32_t *corner_normal; /* 3 * triangle_count, indices of normals or MESH_NONE */
	uint32_t *face_material; /* triangle_count, indices of materials or MESH_NONE */
	size_t triangle_count, triangle_capacity;
	mesh_material *material;
	size_t material_count;
	char **note; /* sentences that the user should read */
	size_t note_count;
	const format *format; /* in the file */
	char up;              /* which axis the coordinates call up, 'y' or 'z'; 0: nobody knows */
	bool bare;            /* neither colours nor materials: GW_ALBEDO_DEFAULT stands in */
	size_t faces;         /* in the file */
	size_t faces_flat;    /* of those, left out because they have fewer than 3 corners */
	size_t faces_crossed; /* of those, concave ones that could only be cut into a fan */
	double *area_sum;     /* triangle_count, see gw_mesh_areas; from mesh_measure */
	double area;          /* m^2 */
	size_t degenerate;    /* triangles without area, left out */
} mesh;

/* Formats of meshes whose vertices are read as points unless they are asked for as meshes. */
extern const format obj_format, off_format, glb_format;
gw_status obj_read(struct input_file *in, scan *cloud, gw_error *error);
gw_status off_read(struct input_file *in, scan *cloud, gw_error *error);
gw_status glb_read(struct input_file *in, scan *cloud, gw_error *error);

/* Read one format each, from bytes; mesh_reader.h finds out which it is.
 *   path   of the OBJ file, from whose folder MTL files count; "-" for none */
gw_status mesh_obj_read(const struct input_file *in, const char *path, mesh *mesh, gw_error *error);
gw_status mesh_ply_read(struct input_file *in, mesh *mesh, gw_error *error);
gw_status mesh_off_read(const struct input_file *in, mesh *mesh, gw_error *error);

/* glTF has y up, but the mesh comes with z up. */
gw_status mesh_glb_read(const struct input_file *in, mesh *mesh, gw_error *error);

/* Whether a file that is OBJ, or GLB, has faces; true for a GLB file that is damaged. */
bool mesh_obj_has_faces(const struct input_file *in);

/*
 * Names the files of materials that an OBJ file asks for, whether they are there or not. A line
 * with blanks may be one name or several: each is named, and all of it.
 *   path    of the OBJ file
 *   named   is handed each path; ends the search with its failure
 */
typedef gw_status mesh_obj_named(void *user, const char *path, gw_error *error);
gw_status mesh_obj_libraries(const char *path, mesh_obj_named *named, void *user, gw_error *error);
bool mesh_glb_has_faces(const struct input_file *in);

/* True when the first bytes of a file are those of an OFF file. */
bool mesh_off_probe(const uint8_t *head, size_t length);

/* Frees all that a mesh holds and empties it. */
void mesh_clear(mesh *mesh);

/* Frees vertices, triangles and materials; counts, area and notes stay. */
void mesh_clear_shape(mesh *mesh);

/* Moves a mesh. A matrix that mirrors turns the corners round, so that normals stay outside.
 *   matrix   row-major, last row 0 0 0 1, with an inverse */
void mesh_transform(mesh *mesh, const double matrix[16]);

/* Turns a mesh so that `up`, as gw_camera_up has it, is up; one that does not say which axis is
 * stays as it is. */
void mesh_stand(mesh *mesh, char up);

/* Sums areas and counts what has none. GW_ERROR_DATA when no triangle has area, or the whole is too
 * large for a number. name: of the file, for messages. */
gw_status mesh_measure(mesh *mesh, const char *name, gw_error *error);

/*
 * Samples points, spread evenly over the area (mesh_sample.h). Columns: x y z, float32, or float64
 * when a coordinate is over 1000 m; nx ny nz, interpolated where the corners have normals, else the
 * face's; red green blue, uint8, the sRGB-encoded albedo; emission_* when a material emits;
 * specular and roughness when a material is specular. Colours of vertices are interpolated as
 * linear light and go before the material's.
 *   count     of points, at least 1
 *   threads   0 means one a processor; the points are the same for any number
 *   cloud     on success owned by the caller; empty on failure
 *   error     GW_ERROR_MEMORY
 */
gw_status mesh_sample(const mesh *mesh, uint64_t count, uint64_t seed, uint32_t threads,
					  scan *cloud, gw_error *error);

/* ------------------------------------------------------------------------- for the readers */

/* How much of a mesh there is at a moment. */
typedef struct mesh_mark {
	size_t position, normal, triangle;
} mesh_mark;

mesh_mark mesh_mark_now(const mesh *mesh);

/* Moves what came after the mark; as mesh_transform. A matrix without an inverse leaves triangles
 * without area. */
void mesh_transform_since(mesh *mesh, mesh_mark mark, const double matrix[16]);

/* Corners of one face, before it is cut into triangles. */
typedef struct mesh_polygon {
	uint32_t *corner, *normal; /* owned; count; capacity for the next one */
	size_t count;
	size_t capacity;
	double *flat;    /* owned scratch of mesh_add_polygon */
	uint32_t *order; /* the same */
	size_t scratch;
} mesh_polygon;

gw_status mesh_polygon_add(mesh_polygon *polygon, uint32_t corner, uint32_t normal,
						   gw_error *error);
void mesh_polygon_clear(mesh_polygon *polygon);

/* Cuts a face into triangles and adds them: a fan if it is convex, else ears. Fewer than three
 * corners are counted and left out. All corners are valid indices. */
gw_status mesh_add_polygon(mesh *mesh, mesh_polygon *polygon, uint32_t material, gw_error *error);

/* Adds a sentence to the notes. */
gw_status mesh_add_note(mesh *mesh, gw_error *error, const char *form, ...)
	__attribute__((format(printf, 3, 4)));

/* Reads the materials of an MTL file and appends them. */
gw_status mesh_mtl_read(const struct input_file *in, mesh *mesh, gw_error *error);

/* Index of a material by its name, the last one with it; MESH_NONE when there is none. */
uint32_t mesh_find_material(const mesh *mesh, const char *name, size_t length);

#endif
