#include "pictures/octree_view.h"
#include "glowworm_picture.h"
#include "pictures/scene_octree.h"
#include "program/nearest_name.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Brightness of a face that is seen edge-on, of one seen squarely. */
#define AMBIENT 0.35f

/* Cells that show less of their face than this are left out. */
#define EMPTY 1e-4f

/* Side of a record's box, in spacings of the points. */
#define RECORD_SIZE 1.0f

/* Pixels that an edge is wide; cells below three times that have none. */
#define EDGE 1.2f

bool octree_view_is_boxes(settings_view view)
{
	return view == SETTINGS_VIEW_CELLS || view == SETTINGS_VIEW_BORDER ||
		   view == SETTINGS_VIEW_OCTREE || view == SETTINGS_VIEW_OPACITY ||
		   view == SETTINGS_VIEW_VOXELS || view == SETTINGS_VIEW_SAMPLES;
}

bool octree_view_is_samples(settings_view view)
{
	return view == SETTINGS_VIEW_SAMPLES;
}

bool octree_view_is_overlay(settings_view view)
{
	return view == SETTINGS_VIEW_RECORDS;
}

/* --------------------------------------------------------------------------- the name's end */

static gw_status check_side(const char *text, uint32_t *side, gw_error *error)
{
	static const char *const name[6] = { "+x", "-x", "+y", "-y", "+z", "-z" };
	for (uint32_t i = 0; i < 6; i++)
		if (strcmp(text, name[i]) == 0) {
			*side = i;
			return GW_OK;
		}
	return gw_fail(error, GW_ERROR_USAGE,
				   "--view: '%.20s' is no side of a voxel; there are +x, -x, +y, -y, +z and -z",
				   text);
}

/* LEVEL or LEVEL:SIDE. */
static gw_status check_level(const char *text, bool sided, octree_view *v, gw_error *error)
{
	char *end;
	unsigned long level = strtoul(text, &end, 10);
	bool good = *text >= '0' && *text <= '9' && level >= 1 && level <= GW_DEPTH_MAX;
	if (!good || *end != (sided ? ':' : '\0'))
		return gw_fail(error, GW_ERROR_USAGE,
					   "--view: '%.40s' must be a level of the octree, 1 to %u%s", text,
					   GW_DEPTH_MAX, sided ? ", a colon and a side, such as 6:+x" : "");
	v->level = (uint32_t)level;
	return sided ? check_side(end + 1, &v->side, error) : GW_OK;
}

static gw_status check_lamp(const settings *s, const char *text, octree_view *v, gw_error *error)
{
	const char *name[32];
	char hint[NEAREST_NAME_HINT], *end;
	size_t known = 0;
	unsigned long number = strtoul(text, &end, 10);
	for (size_t i = 0; i < s->light_count; i++) {
		const gw_light *light = &s->light[i].light;
		bool meant = strcmp(light->name, text) == 0 || (*end == '\0' && number == i + 1);
		if (meant && light->type == GW_LIGHT_ENVIRONMENT)
			return gw_fail(error, GW_ERROR_USAGE, "--view: a sky casts no shadow of its own");
		v->lamp = i;
		if (meant)
			return GW_OK;
		if (light->name[0] && known < 32)
			name[known++] = light->name;
	}
	if (s->light_count == 0)
		return gw_fail(error, GW_ERROR_USAGE,
					   "--view: there is no lamp; name the scene file, or give --light");
	return gw_fail(error, GW_ERROR_USAGE,
				   "--view: there is no lamp '%.60s'; give a name, or a number from 1 to %zu%s",
				   text, s->light_count, nearest_name_hint(hint, text, "", name, known));
}

gw_status octree_view_check(const settings *s, octree_view *v, gw_error *error)
{
	const char *detail = s->render.detail ? s->render.detail : "";
	*v = (octree_view){ .view = (settings_view)s->render.view };
	switch (v->view) {
	case SETTINGS_VIEW_CELLS:
	case SETTINGS_VIEW_BORDER:
	case SETTINGS_VIEW_OCTREE:
		return check_level(detail, false, v, error);
	case SETTINGS_VIEW_OPACITY:
	case SETTINGS_VIEW_VOXELS:
		return check_level(detail, true, v, error);
	case SETTINGS_VIEW_SHADOW:
		return check_lamp(s, detail, v, error);
	default:
		return GW_OK;
	}
}

/* ---------------------------------------------------------------------------------- boxes */

/* Tiles have colours of their own, of which their cells have shades. */
static void color_of(uint64_t key, float color[3])
{
	uint64_t mixed = (key >> 3) * 0x9e3779b97f4a7c15u;
	float shade = 0.6f + 0.4f * (float)(key & 7u) / 7.0f;
	for (int k = 0; k < 3; k++)
		color[k] = shade * (0.25f + 0.75f * (float)(mixed >> (40 + 8 * k) & 255u) / 255.0f);
}

/* Faces between two cells that are both drawn are never seen. */
static unsigned open_faces(const gw_cells *cells, uint64_t key)
{
	uint32_t cell[3];
	unsigned faces = 0;
	gw_morton_decode(key, cell);
	for (unsigned face = 0; face < 6; face++) {
		uint32_t other[3] = { cell[0], cell[1], cell[2] };
		other[face / 2] += face % 2 ? UINT32_MAX : 1u;
		if (other[face / 2] >= 1u << GW_DEPTH_MAX ||
			gw_cells_find(cells, gw_morton_encode(other[0], other[1], other[2])) == SIZE_MAX)
			faces |= 1u << face;
	}
	return faces;
}

/* The corner of a cell. */
static void corner_of(const gw_cells *cells, const uint32_t cell[3], float low[3])
{
	for (size_t k = 0; k < 3; k++)
		low[k] = cells->corner[k] + (float)cell[k] * cells->size;
}

/* shown: 4 a cell, or NULL. */
static gw_status add_cells(octree_view *v, const gw_cells *cells, const float *shown,
						   gw_error *error)
{
	v->size = cells->size;
	for (size_t i = 0; i < cells->count; i++) {
		float low[3], color[3];
		uint32_t cell[3];
		gw_morton_decode(cells->key[i], cell);
		corner_of(cells, cell, low);
		for (size_t k = 0; k < 3 && shown; k++)
			color[k] =
				v->view == SETTINGS_VIEW_OPACITY ? fminf(shown[4 * i + 3], 1.0f) : shown[4 * i + k];
		if (!shown)
			color_of(cells->key[i], color);
		if (shown && shown[4 * i + 3] < EMPTY)
			continue;
		/* What is left out opens the faces beside it. */
		GW_TRY(box_mesh_add(&v->boxes, low, cells->size, color,
							shown ? 63u : open_faces(cells, cells->key[i]), error));
		v->shown++;
	}
	return GW_OK;
}

/* An edge is drawn by the first of the cells that share it. */
static bool owns_edge(const gw_cells *cells, const uint32_t cell[3], unsigned edge)
{
	unsigned axis = edge / 4, u = (axis + 1) % 3, v = (axis + 2) % 3;
	for (unsigned other = 0; other < 4; other++) {
		uint32_t at[3] = { cell[0], cell[1], cell[2] };
		at[u] += (edge & 1u) + (other & 1u) - 1u;
		at[v] += (edge >> 1 & 1u) + (other >> 1) - 1u;
		if (at[u] >= 1u << GW_DEPTH_MAX || at[v] >= 1u << GW_DEPTH_MAX)
			continue;
		uint64_t key = gw_morton_encode(at[0], at[1], at[2]);
		if (key < gw_morton_encode(cell[0], cell[1], cell[2]) &&
			gw_cells_find(cells, key) != SIZE_MAX)
			return false;
	}
	return true;
}

/* The border tiles of a level as frames, through which its cells are seen. */
static gw_status add_border_frames(octree_view *v, gw_render_octree *octree, gw_error *error)
{
	static const float grey[3] = { 0.9f, 0.9f, 0.9f };
	gw_cells tiles;
	gw_status status = gw_cells_list_borders(octree, v->level, &tiles, error);
	for (size_t i = 0; i < tiles.count && status == GW_OK; i++) {
		uint32_t cell[3];
		float low[3];
		gw_morton_decode(tiles.key[i], cell);
		corner_of(&tiles, cell, low);
		for (unsigned edge = 0; edge < 12 && status == GW_OK; edge++)
			if (owns_edge(&tiles, cell, edge))
				status = box_mesh_add_edge(&v->boxes, low, tiles.size, edge, grey, error);
	}
	v->shown += tiles.count;
	gw_cells_clear(&tiles);
	return status;
}

static gw_status make_cells(octree_view *v, gw_render_octree *octree, gw_error *error)
{
	gw_cells cells;
	float *shown = NULL;
	bool border = v->view == SETTINGS_VIEW_BORDER;
	bool plain = border || v->view == SETTINGS_VIEW_CELLS || v->view == SETTINGS_VIEW_OCTREE;
	gw_status status =
		(border ? gw_cells_list_borders : gw_cells_list)(octree, v->level, &cells, error);
	if (status == GW_OK && !plain) {
		shown = calloc(cells.count, 4 * sizeof *shown);
		status = shown ? gw_cells_show(octree, &cells, v->level, v->side, shown, error)
					   : gw_fail(error, GW_ERROR_MEMORY, "no memory for %zu cells", cells.count);
	}
	if (status == GW_OK)
		status = add_cells(v, &cells, shown, error);
	if (status == GW_OK && v->view == SETTINGS_VIEW_OCTREE)
		status = add_border_frames(v, octree, error);
	if (status == GW_OK && v->shown == 0)
		status = gw_fail(error, GW_ERROR_DATA,
						 border ? "level %u of the octree has no border tiles"
								: "no voxel of level %u shows anything to that side",
						 v->level);
	free(shown);
	gw_cells_clear(&cells);
	return status;
}

/* A frame as wide as the region of influence, and in it a disc across the normal, which fills it
 * where all of the surface faces one way and is smaller by the spread of the NDF. */
static gw_status add_sample(octree_view *v, const gw_surfels *s, size_t i, float side,
							gw_error *error)
{
	static const float grey[3] = { 0.8f, 0.8f, 0.8f };
	const float *centre = s->position + 3 * i, *normal = s->normal + 3 * i;
	float low[3], color[3];
	for (size_t k = 0; k < 3; k++) {
		low[k] = centre[k] - 0.5f * side;
		color[k] = 0.5f + 0.5f * normal[k];
	}
	for (unsigned edge = 0; edge < 12; edge++)
		GW_TRY(box_mesh_add_edge(&v->boxes, low, side, edge, grey, error));
	return box_mesh_add_disc(&v->boxes, centre, normal, 0.5f * side * s->normal_length[i], color,
							 error);
}

/* The region is as wide as it is to the next sample, and at most a leaf (Salm 4.3.4). */
static gw_status make_samples(const render_scene *scene, octree_view *v, gw_render_octree *o,
							  gw_error *error)
{
	const gw_surfels *s = &scene->surfels;
	float leaf = (float)gw_render_octree_width(o).leaf_size;
	for (size_t i = 0; i < s->count; i++) {
		float side = fminf(s->nearest[i], leaf);
		if (!v->seen[i] || !(side > 0.0f))
			continue;
		v->size = fmaxf(v->size, side);
		GW_TRY(add_sample(v, s, i, side, error));
		v->shown++;
	}
	return v->shown ? GW_OK
					: gw_fail(error, GW_ERROR_DATA,
							  "no point is in view; --camera auto finds a camera that sees some");
}

static gw_status make_records(const settings *s, const render_scene *scene, octree_view *v,
							  gw_render_octree *o, gw_error *error)
{
	static const float cyan[3] = { 0.0f, 0.7f, 1.0f };
	float *position;
	v->size = RECORD_SIZE * scene->surfels.spacing;
	gw_status status =
		gw_render_octree_records(o, &scene->surfels, &s->bake, &position, &v->shown, error);
	for (size_t i = 0; i < v->shown && status == GW_OK; i++) {
		float low[3];
		for (size_t k = 0; k < 3; k++)
			low[k] = position[3 * i + k] - 0.5f * v->size;
		status = box_mesh_add(&v->boxes, low, v->size, cyan, 63u, error);
	}
	free(position);
	return status;
}

/* --------------------------------------------------------------------------------- shadows */

static gw_status make_shadow(settings *s, render_scene *scene, const octree_view *v,
							 gw_render_octree *o, gw_error *error)
{
	lamp light = s->light[v->lamp];
	size_t count = scene->surfels.count, stride = scene->raster.channel_count;
	if (light.stand.kind || light.aim.kind)
		return gw_fail(error, GW_ERROR_USAGE,
					   "where scanners and floors are is not known here; give the light's X,Y,Z, "
					   "which glowworm info --places prints");
	float *share = calloc(count, sizeof *share);
	if (!share)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for shadows on %zu points", count);
	loaded_scene_place(&scene->place, scene->up, &light);
	gw_status status =
		gw_render_octree_shadow(o, &scene->surfels, &light.light, &s->bake, share, error);
	for (size_t i = 0; i < count && status == GW_OK; i++)
		scene->channel[i * stride + (size_t)scene->offset[RENDER_SHADOW]] = share[i];
	free(share);
	return status;
}

/* ------------------------------------------------------------------------------------ open */

static gw_status make(settings *s, render_scene *scene, octree_view *v, gw_render_octree *octree,
					  gw_error *error)
{
	if (v->view == SETTINGS_VIEW_SHADOW)
		return make_shadow(s, scene, v, octree, error);
	GW_TRY(v->view == SETTINGS_VIEW_RECORDS  ? make_records(s, scene, v, octree, error)
		   : octree_view_is_samples(v->view) ? make_samples(scene, v, octree, error)
											 : make_cells(v, octree, error));
	v->raster = (gw_raster_scene){ .triangles = box_mesh_triangles(&v->boxes),
								   .channel_count = BOX_MESH_CHANNELS };
	memcpy(v->raster.origin, scene->surfels.origin, sizeof v->raster.origin);
	return GW_OK;
}

bool octree_view_needs_octree(settings_view view)
{
	return octree_view_is_boxes(view) || view == SETTINGS_VIEW_RECORDS ||
		   view == SETTINGS_VIEW_SHADOW;
}

gw_status octree_view_open(settings *s, render_scene *scene, octree_view *v, gw_error *error)
{
	if (!octree_view_needs_octree(v->view))
		return GW_OK;
	gw_render_octree *octree = NULL;
	bool bricks = v->view == SETTINGS_VIEW_OPACITY || v->view == SETTINGS_VIEW_VOXELS;
	scene_octree_use use = bricks                          ? SCENE_OCTREE_BRICKS
						   : octree_view_is_boxes(v->view) ? SCENE_OCTREE_CELLS
														   : SCENE_OCTREE_RAYS;
	GW_TRY(scene_octree_create(s, scene, use, &octree, error));
	gw_status status = make(s, scene, v, octree, error);
	gw_render_octree_destroy(&octree);
	return status;
}

void octree_view_clear(octree_view *v)
{
	box_mesh_clear(&v->boxes);
	*v = (octree_view){ .shown = 0 };
}

/* ---------------------------------------------------------------------------------- values */

/* Brightness of a face in the light of a lamp at the camera, and of its dark edges. */
static float brightness(const octree_view *v, const gw_camera *camera, const gw_gbuffer *g,
						size_t pixel)
{
	double step = 2.0 * camera->tangent / (double)g->height, along = 0.0, square = 0.0;
	double x = ((double)(pixel % g->width) + 0.5 - 0.5 * (double)g->width) * step;
	double y = (0.5 * (double)g->height - (double)(pixel / g->width) - 0.5) * step;
	for (size_t k = 0; k < 3; k++) {
		double ray = x * camera->right[k] + y * camera->up[k] + camera->forward[k];
		along += ray * (double)g->normal[3 * pixel + k];
		square += ray * ray;
	}
	float lit = AMBIENT + (1.0f - AMBIENT) * (float)(fabs(along) / sqrt(square));
	float width = EDGE * (float)step * g->depth[pixel] / v->size; /* as a share of the face */
	const float *channel = g->channel + g->channel_count * pixel;
	float inside = fminf(fminf(channel[BOX_MESH_U], 1.0f - channel[BOX_MESH_U]),
						 fminf(channel[BOX_MESH_V], 1.0f - channel[BOX_MESH_V]));
	return width < 1.0f / 3.0f && inside < width ? 0.2f * lit : lit;
}

void octree_view_values(const octree_view *v, const gw_camera *camera, const gw_gbuffer *g,
						float *values)
{
	size_t pixels = (size_t)g->width * g->height;
	bool shaded = v->view != SETTINGS_VIEW_OPACITY && v->view != SETTINGS_VIEW_VOXELS;
	for (size_t i = 0; i < pixels; i++) {
		float bright = shaded && g->coverage[i] > 0.0f ? brightness(v, camera, g, i) : 1.0f;
		for (size_t k = 0; k < 3; k++)
			values[3 * i + k] =
				g->coverage[i] > 0.0f ? bright * g->channel[g->channel_count * i + k] : 0.0f;
	}
}

void octree_view_lay_over(const octree_view *v, const gw_camera *camera, const gw_gbuffer *boxes,
						  const gw_gbuffer *points, float *values)
{
	size_t pixels = (size_t)points->width * points->height;
	for (size_t i = 0; i < pixels; i++) {
		/* Boxes stand in the surface: half of one sticks out. */
		if (!(boxes->coverage[i] > 0.5f && points->coverage[i] > 0.0f) ||
			!(boxes->depth[i] < points->depth[i] + 0.25f * v->size))
			continue;
		float bright = brightness(v, camera, boxes, i);
		for (size_t k = 0; k < 3; k++)
			values[3 * i + k] = bright * boxes->channel[boxes->channel_count * i + k];
	}
}
