#include "meshes/mesh_vertices.h"
#include "points/scan_color.h"

#include <math.h>
#include <stdio.h>

static gw_status put_columns(const mesh *m, scan *cloud, gw_error *error)
{
	static const char *const names[9] = { "x", "y", "z", "nx", "ny", "nz", "red", "green", "blue" };
	static const scan_type types[3] = { SCAN_FLOAT64, SCAN_FLOAT32, SCAN_UINT8 };
	bool normals = m->normal && m->normal_count == m->position_count;
	cloud->count = m->position_count;
	for (size_t c = 0; c < 9; c++) {
		size_t kind = c / 3, k = c % 3;
		if ((kind == 1 && !normals) || (kind == 2 && !m->color))
			continue;
		scan_column *column = scan_add_column(cloud, names[c], types[kind], error);
		if (!column)
			return GW_ERROR_MEMORY;
		for (size_t i = 0; i < cloud->count; i++)
			scan_store(column, i,
					   kind == 0   ? m->position[3 * i + k]
					   : kind == 1 ? (double)m->normal[3 * i + k]
								   : round(255.0 * scan_srgb_encode((double)m->color[3 * i + k])));
	}
	return GW_OK;
}

gw_status mesh_vertices_put(const mesh *m, bool faces, scan *cloud, gw_error *error)
{
	*cloud = (scan){ .up = 'z' };
	GW_TRY(put_columns(m, cloud, error));
	for (size_t i = 0; i < m->note_count; i++) {
		char text[560];
		snprintf(text, sizeof text, SCAN_NOTE "%s", m->note[i]);
		GW_TRY(scan_add_comment(cloud, text, error));
	}
	if (faces)
		GW_TRY(scan_add_comment(cloud,
								SCAN_NOTE "its vertices were read, not its faces; `glowworm "
										  "sample` puts points on them",
								error));
	return GW_OK;
}
