#include "meshes/glb_nodes.h"
#include "files/growing_table.h"

#include <math.h>
#include <string.h>

/* A node that waits for its turn. */
typedef struct waiting {
	size_t node;
	double matrix[16]; /* of its parent */
} waiting;

typedef struct walk {
	const glb_document *document;
	waiting *stack; /* owned; a tree of nodes never needs more than there are */
	size_t depth, nodes;
	bool *seen; /* owned; nodes */
	glb_placed *placed;
	size_t placed_count;
} walk;

static const double identity[16] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 };

static void multiply(const double a[16], const double b[16], double product[16])
{
	for (int i = 0; i < 4; i++)
		for (int j = 0; j < 4; j++) {
			double sum = 0.0;
			for (int k = 0; k < 4; k++)
				sum += a[4 * i + k] * b[4 * k + j];
			product[4 * i + j] = sum;
		}
}

/* Translation, rotation by the unit quaternion x y z w, scale: the last is applied first. */
static void compose(const double t[3], const double q[4], const double s[3], double m[16])
{
	double n = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3], f = n > 0.0 ? 2.0 / n : 0.0;
	double x = q[0], y = q[1], z = q[2], w = q[3];
	const double r[9] = { 1.0 - f * (y * y + z * z), f * (x * y - z * w),
						  f * (x * z + y * w),       f * (x * y + z * w),
						  1.0 - f * (x * x + z * z), f * (y * z - x * w),
						  f * (x * z - y * w),       f * (y * z + x * w),
						  1.0 - f * (x * x + y * y) };
	memcpy(m, identity, sizeof identity);
	for (int i = 0; i < 3; i++) {
		for (int j = 0; j < 3; j++)
			m[4 * i + j] = r[3 * i + j] * s[j];
		m[4 * i + 3] = t[i];
	}
}

/* The node's own transform; a file's matrix is column-major. */
static gw_status take_matrix(const glb_document *d, json_t *node, double m[16])
{
	double t[3] = { 0 }, q[4] = { 0, 0, 0, 1 }, s[3] = { 1, 1, 1 }, columns[16];
	if (json_object_get(node, "matrix")) {
		GW_TRY(glb_numbers(d, node, "matrix", columns, 16));
		for (int i = 0; i < 16; i++)
			m[i] = columns[4 * (i % 4) + i / 4];
		if (m[12] != 0.0 || m[13] != 0.0 || m[14] != 0.0 || m[15] != 1.0)
			return glb_fail(d, "the matrix of a node is a projection, which is not read");
		return GW_OK;
	}
	GW_TRY(glb_numbers(d, node, "translation", t, 3));
	GW_TRY(glb_numbers(d, node, "rotation", q, 4));
	GW_TRY(glb_numbers(d, node, "scale", s, 3));
	compose(t, q, s, m);
	return GW_OK;
}

/* Nodes may only be reached once, so there is no circle. */
static gw_status push(walk *w, json_t *index, const double matrix[16])
{
	json_int_t node = json_is_integer(index) ? json_integer_value(index) : -1;
	if (node < 0 || (json_int_t)w->nodes <= node)
		return glb_fail(w->document, "there are %zu nodes, and a child is none of them", w->nodes);
	if (w->seen[node])
		return glb_fail(w->document, "nodes[%lld] is reached twice", (long long)node);
	w->seen[node] = true;
	w->stack[w->depth].node = (size_t)node;
	memcpy(w->stack[w->depth++].matrix, matrix, sizeof identity);
	return GW_OK;
}

static gw_status add_mesh(walk *w, size_t index, const double matrix[16])
{
	json_t *mesh = glb_entry(w->document, "meshes", index);
	if (!json_is_object(mesh))
		return glb_fail(w->document, "there is no meshes[%zu]", index);
	glb_placed *grown = growing_table_room(w->placed, w->placed_count, sizeof *grown);
	if (!grown)
		return gw_fail(w->document->error, GW_ERROR_MEMORY, "no memory for the nodes of %s",
					   w->document->in->name);
	w->placed = grown;
	w->placed[w->placed_count].mesh = mesh;
	memcpy(w->placed[w->placed_count++].matrix, matrix, sizeof identity);
	return GW_OK;
}

static gw_status visit(walk *w, const waiting *from)
{
	json_t *node = glb_entry(w->document, "nodes", from->node);
	double own[16], matrix[16];
	size_t mesh;
	GW_TRY(take_matrix(w->document, node, own));
	GW_TRY(glb_size(w->document, node, "mesh", SIZE_MAX, &mesh));
	multiply(from->matrix, own, matrix);
	for (int i = 0; i < 16; i++)
		if (!isfinite(matrix[i]))
			return glb_fail(w->document, "the matrix of nodes[%zu] is too large", from->node);
	if (mesh != SIZE_MAX)
		GW_TRY(add_mesh(w, mesh, matrix));
	json_t *children = json_object_get(node, "children");
	for (size_t i = json_array_size(children); i-- > 0;)
		GW_TRY(push(w, json_array_get(children, i), matrix));
	return GW_OK;
}

static gw_status visit_all(walk *w)
{
	while (w->depth > 0) {
		waiting next = w->stack[--w->depth];
		GW_TRY(visit(w, &next));
	}
	return GW_OK;
}

static gw_status push_roots(walk *w)
{
	size_t scene;
	GW_TRY(glb_size(w->document, w->document->root, "scene", 0, &scene));
	json_t *roots = json_object_get(glb_entry(w->document, "scenes", scene), "nodes");
	for (size_t i = json_array_size(roots); i-- > 0;)
		GW_TRY(push(w, json_array_get(roots, i), identity));
	return GW_OK;
}

/* Without scenes, nodes that are nobody's children; without nodes, the meshes as they are. */
static gw_status push_orphans(walk *w)
{
	json_t *nodes = json_object_get(w->document->root, "nodes");
	bool *child = calloc(w->nodes + 1, sizeof *child);
	gw_status status = GW_OK;
	if (!child)
		return gw_fail(w->document->error, GW_ERROR_MEMORY, "no memory for %zu nodes", w->nodes);
	for (size_t i = 0; i < w->nodes; i++) {
		json_t *children = json_object_get(json_array_get(nodes, i), "children");
		for (size_t k = 0; k < json_array_size(children); k++) {
			json_int_t index = json_integer_value(json_array_get(children, k));
			if (index >= 0 && index < (json_int_t)w->nodes)
				child[index] = true;
		}
	}
	for (size_t i = w->nodes; i-- > 0 && status == GW_OK;) {
		if (child[i])
			continue;
		json_t *index = json_integer((json_int_t)i);
		status = index ? push(w, index, identity)
					   : gw_fail(w->document->error, GW_ERROR_MEMORY, "no memory for nodes");
		json_decref(index);
	}
	free(child);
	for (size_t i = 0; w->nodes == 0 && glb_entry(w->document, "meshes", i) && status == GW_OK; i++)
		status = add_mesh(w, i, identity);
	return status;
}

static gw_status walk_all(walk *w)
{
	const glb_document *d = w->document;
	w->stack = reallocarray(NULL, w->nodes + 1, sizeof *w->stack);
	w->seen = calloc(w->nodes + 1, sizeof *w->seen);
	if (!w->stack || !w->seen)
		return gw_fail(d->error, GW_ERROR_MEMORY, "no memory for %zu nodes", w->nodes);
	if (json_array_size(json_object_get(d->root, "scenes")) > 0)
		GW_TRY(push_roots(w));
	else
		GW_TRY(push_orphans(w));
	GW_TRY(visit_all(w));
	return w->placed_count > 0 ? GW_OK : glb_fail(d, "its scene holds no mesh");
}

gw_status glb_list_meshes(const glb_document *d, glb_placed **placed, size_t *count)
{
	walk w = { .document = d, .nodes = json_array_size(json_object_get(d->root, "nodes")) };
	gw_status status = walk_all(&w);
	free(w.stack);
	free(w.seen);
	if (status != GW_OK)
		free(w.placed);
	*placed = status == GW_OK ? w.placed : NULL;
	*count = status == GW_OK ? w.placed_count : 0;
	return status;
}
