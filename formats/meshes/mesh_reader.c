#include "meshes/mesh_reader.h"
#include "files/input_file.h"
#include "meshes/glb_document.h"
#include "ply/ply_format.h"

#include <string.h>
#include <strings.h>

bool mesh_is_name(const char *path)
{
	size_t length = strlen(path);
	const char *end = path + length - (length > 4 ? 4 : 0);
	return strcasecmp(end, ".obj") == 0 || strcasecmp(end, ".glb") == 0;
}

bool mesh_has_faces(const char *path)
{
	input_file in;
	if (input_file_open(&in, path, NULL) != GW_OK)
		return true;
	bool glb = glb_probe(in.data, in.length);
	bool faces = glb ? mesh_glb_has_faces(&in) : mesh_obj_has_faces(&in);
	input_file_close(&in);
	return faces;
}

gw_status mesh_read(const char *path, mesh *m, gw_error *error)
{
	*m = (mesh){ 0 };
	input_file in;
	GW_TRY(input_file_open(&in, path, error));
	gw_status status = GW_OK;
	if (in.length == 0)
		status = gw_fail(error, GW_ERROR_DATA, "%s is empty", in.name);
	else if (ply_format.probe(in.data, in.length))
		status = mesh_ply_read(&in, m, error);
	else if (mesh_off_probe(in.data, in.length))
		status = mesh_off_read(&in, m, error);
	else if (glb_probe(in.data, in.length))
		status = mesh_glb_read(&in, m, error);
	else
		status = mesh_obj_read(&in, path, m, error);
	status = input_file_check(&in, status, error);
	if (status != GW_OK)
		mesh_clear(m);
	input_file_close(&in);
	return status;
}
