#include "seed_files.h"
#include "text/cloud_format.h"
#include "e57_file.h"
#include "e57/e57_format.h"
#include "glb_file.h"
#include "files/little_endian.h"
#include "meshes/mesh.h"
#include "pcd/pcd_format.h"
#include "ply/ply_format.h"
#include "text/text_formats.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void put_text(seed *s, const char *text)
{
	memcpy(s->data + s->length, text, strlen(text));
	s->length += strlen(text);
}

void seed_put_number(seed *s, uint64_t pattern, size_t size, bool big)
{
	for (size_t i = 0; i < size; i++)
		s->data[s->length++] = (uint8_t)(pattern >> 8 * (big ? size - 1 - i : i));
}

static void put_float(seed *s, float value, bool big)
{
	uint32_t pattern;
	memcpy(&pattern, &value, sizeof pattern);
	seed_put_number(s, pattern, 4, big);
}

/* Elements before and behind the vertices, lists everywhere, types of every size. */
static void make_ply(seed *s, const char *name, const char *encoding)
{
	bool big = strstr(encoding, "big") != NULL, ascii = strcmp(encoding, "ascii") == 0;
	char line[80];
	*s = (seed){ .name = name, .read = ply_read, .points = 12 };
	snprintf(line, sizeof line, "ply\nformat %s 1.0\ncomment seed 7\n", encoding);
	put_text(s, line);
	put_text(s, "obj_info 42\nelement camera 2\nproperty ushort id\nproperty list uchar short v\n"
				"element vertex 12\nproperty float x\nproperty double y\nproperty float z\n"
				"property list uchar int w\nproperty uchar red\nproperty short s16\n"
				"element face 2\nproperty list uchar int vertex_indices\nend_header\n");
	s->header = s->length;
	for (uint64_t i = 0; i < 2; i++) {
		if (ascii) {
			put_text(s, "300 2 -1 5\n");
			continue;
		}
		seed_put_number(s, 300, 2, big);
		seed_put_number(s, 2, 1, big);
		seed_put_number(s, 5, 4, big);
	}
	for (int i = 0; i < 12; i++) {
		if (ascii) {
			snprintf(line, sizeof line, "%d.5 -1.25e2 1e-3 2 7 8 255 -32768\n", i);
			put_text(s, line);
			continue;
		}
		put_float(s, (float)i, big);
		seed_put_number(s, 0x40590ccccccccccd, 8, big);
		put_float(s, -1.0f, big);
		seed_put_number(s, 2, 1, big);
		seed_put_number(s, 0x0000000700000008, 8, big);
		seed_put_number(s, 255, 1, big);
		seed_put_number(s, 0x8000, 2, big);
	}
	if (ascii)
		put_text(s, "3 0 1 2\n3 0 1 2\n");
	else
		put_text(s, "\001abcd\002abcdefgh");
}

/* As most scanners write it: vertices of one size and nothing else. */
static void make_plain_ply(seed *s)
{
	*s = (seed){ .name = "plain ply", .read = ply_read, .points = 9 };
	put_text(s, "ply\r\nformat binary_little_endian 1.0\r\nelement vertex 9\r\n"
				"property float32 x\r\nproperty float32 y\r\nproperty float32 z\r\n"
				"property uint8 red\r\nproperty uint8 green\r\nproperty uint8 blue\r\n"
				"end_header\r\n");
	s->header = s->length;
	for (int i = 0; i < 9; i++) {
		for (int k = 0; k < 3; k++)
			put_float(s, (float)(i - k), false);
		put_text(s, "rgb");
	}
}

static void make_cloud(seed *s)
{
	*s = (seed){ .name = "cloud", .read = cloud_read, .points = 10 };
	seed_put_number(s, 10, 4, false);
	for (int i = 0; i < 10; i++) {
		for (int k = 0; k < 6; k++)
			put_float(s, (float)(i * k), false);
		put_text(s, "rgb");
	}
}

/* Sampled, if it can be, with as few points as a table of the smallest file may hold. */
static gw_status sample_seed(gw_status status, mesh *m, scan *cloud, gw_error *error)
{
	*cloud = (scan){ 0 };
	if (status == GW_OK)
		status = mesh_measure(m, "seed.file", error);
	if (status == GW_OK)
		status = mesh_sample(m, 20, 1, 1, cloud, error);
	mesh_clear(m);
	return status;
}

gw_status seed_read_obj(input_file *in, scan *cloud, gw_error *error)
{
	mesh m;
	return sample_seed(mesh_obj_read(in, "-", &m, error), &m, cloud, error);
}

gw_status seed_read_mesh_ply(input_file *in, scan *cloud, gw_error *error)
{
	mesh m;
	return sample_seed(mesh_ply_read(in, &m, error), &m, cloud, error);
}

gw_status seed_read_off(input_file *in, scan *cloud, gw_error *error)
{
	mesh m;
	return sample_seed(mesh_off_read(in, &m, error), &m, cloud, error);
}

/*
 * Whoever changes the JSON changes its length: where the file's length is not what its head says,
 * the lengths of the file and of the JSON are made true first.
 */
gw_status seed_read_glb(input_file *in, scan *cloud, gw_error *error)
{
	mesh m;
	input_file mended = *in;
	uint8_t *copy = malloc(in->length + 1);
	const uint8_t *tag = in->length > 24 ? memmem(in->data, in->length, "BIN", 4) : NULL;
	*cloud = (scan){ 0 };
	if (!copy)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for a seed");
	memcpy(copy, in->data, in->length);
	if (tag && tag - in->data >= 24 && load_32(copy + 8) != in->length) {
		store_32(copy + 8, (uint32_t)in->length);
		store_32(copy + 12, (uint32_t)(tag - in->data - 24));
	}
	mended.data = copy;
	gw_status status = mesh_glb_read(&mended, &m, error);
	free(copy);
	return sample_seed(status, &m, cloud, error);
}

/* The materials on a triangle. */
gw_status seed_read_mtl(input_file *in, scan *cloud, gw_error *error)
{
	static const char triangle[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
	input_file obj = { .name = "seed.file",
					   .data = (const uint8_t *)triangle,
					   .length = sizeof triangle - 1 };
	mesh m;
	gw_status status = mesh_obj_read(&obj, "-", &m, error);
	if (status == GW_OK)
		status = mesh_mtl_read(in, &m, error);
	return sample_seed(status, &m, cloud, error);
}

/* Colours, normals, a concave face, indices of both signs, joined lines. */
static void make_obj(seed *s)
{
	*s = (seed){ .name = "obj", .read = seed_read_obj, .open_end = true };
	put_text(s, "# seed\nmtllib \nv 2 1 0 0.1 0.2 0.3\nv 1 1 0 1 1 1\nv 1 2 0 1 1 1\n"
				"v 0 2 0 0 0 0\nv 0 0 0 0 0 1\nv 2 0 0 1e-1 .5 0\nvt 0 0\nvn 0 0 1\n"
				"vn 0 1e2 1\nusemtl red\nf 1 2 3 4 5 6\nf -1/1/-1 -2//2 \\\n -3/1 4\n"
				"f 5//1 6//1 4//2\nl 1 2\nusemtl none\nf 1 2 3\n");
	s->header = s->length;
}

/* Colours and normals, faces of three and four corners. */
static void make_off(seed *s)
{
	*s = (seed){ .name = "off", .read = seed_read_off, .open_end = true };
	put_text(s, "CNOFF # seed\n5 3 0\n");
	s->header = s->length;
	put_text(s, "0 0 0 0 0 1 255 0 0 255\n1 0 0 0 0 1 0 1e2 0\n1 1 0 0 0 1 0.5 .5 1 1\n"
				"0 1 0 0 0 2 0 0 0 0\n\n2 2 .5 1 0 0 9 9 9\n"
				"4 0 1 2 3\n3 2 1 4 255 0 0\n3 0 0 0\n");
}

/* Nodes with matrices, views with strides, indices, colours, materials. */
static void make_glb(seed *s)
{
	*s = (seed){ .name = "glb", .read = seed_read_glb };
	s->length = glb_file_square(s->data);
	s->header = 20 + load_32(s->data + 12);
}

static void make_mtl(seed *s)
{
	*s = (seed){ .name = "mtl", .read = seed_read_mtl, .open_end = true };
	put_text(s, "newmtl red\nKa 0 0 0\nKd 0.5 .25 1\nKe 10 0 1e2\nKs 0.5\nNs 100\n"
				"newmtl a b\nPr 0.5\nNs 9\nmap_Kd x.png\nillum 2\n");
	s->header = s->length;
}

/* Faces before and behind other lists. */
static void make_mesh_ply(seed *s, bool ascii)
{
	*s = (seed){ .name = ascii ? "ascii mesh" : "binary mesh", .read = seed_read_mesh_ply };
	put_text(s, ascii ? "ply\nformat ascii 1.0\n" : "ply\nformat binary_big_endian 1.0\n");
	put_text(s, "element vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
				"property list uchar short w\nproperty float nx\nproperty float ny\n"
				"property float nz\nproperty uchar red\nproperty uchar green\n"
				"property uchar blue\nelement camera 1\nproperty int id\nelement face 3\n"
				"property uchar tag\nproperty list uchar int vertex_indices\n"
				"property list uint float st\nend_header\n");
	s->header = s->length;
	for (int i = 0; i < 5; i++) {
		const float v[7] = { (float)(i % 2), (float)(i / 2), 0, 0, 0, 1, (float)i };
		char line[80];
		snprintf(line, sizeof line, "%d %d 0 1 7 0 0 1 %d 20 30\n", i % 2, i / 2, i);
		if (ascii)
			put_text(s, line);
		for (int k = 0; k < 6 && !ascii; k++) {
			put_float(s, v[k], true);
			if (k == 2)
				seed_put_number(s, 0x010007, 3, true);
		}
		if (!ascii)
			seed_put_number(s, 0x0a141e, 3, true);
	}
	if (ascii) {
		put_text(s, "9\n1 3 0 1 2 0\n1 4 0 1 3 2 2 0.5 0.25\n2 3 2 3 4 0\n");
		return;
	}
	seed_put_number(s, 9, 4, true);
	for (uint64_t f = 0; f < 3; f++) {
		seed_put_number(s, 0x0103, 2, true);
		for (uint64_t c = 0; c < 3; c++)
			seed_put_number(s, f + c, 4, true);
		seed_put_number(s, 0, 4, true);
	}
}

/* Fields of several sizes, packed colours, padding. */
static void make_pcd(seed *s, const char *name, const char *encoding)
{
	char line[80];
	*s = (seed){ .name = name, .read = pcd_read, .points = 7 };
	put_text(s, "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n"
				"FIELDS x y z rgb _ n\nSIZE 4 8 4 4 1 2\nTYPE F F F F U I\nCOUNT 1 1 1 1 3 2\n"
				"WIDTH 7\nHEIGHT 1\nVIEWPOINT 0 0 1 1 0 0 0\nPOINTS 7\n");
	snprintf(line, sizeof line, "DATA %s\n", encoding);
	put_text(s, line);
	s->header = s->length;
	if (strcmp(encoding, "binary_compressed") == 0) {
		/* 189 bytes: the first as it is, 188 like it, in steps back of at most 264. */
		seed_put_number(s, 5, 4, false);
		seed_put_number(s, 7 * 27, 4, false);
		seed_put_number(s, 0x3f00, 2, false);
		seed_put_number(s, 7 << 5 | (188 - 2 - 7) << 8, 3, false);
		return;
	}
	for (int i = 0; i < 7; i++) {
		if (strcmp(encoding, "ascii") == 0) {
			snprintf(line, sizeof line, "%d.5 -1.25e2 nan 4.2e6 1 2 3 -32768 7\n", i);
			put_text(s, line);
			continue;
		}
		put_float(s, (float)i, false);
		seed_put_number(s, 0x40590ccccccccccd, 8, false);
		put_float(s, -1.0f, false);
		put_text(s, "bgrxabc1234");
	}
}

static void make_tables(seed *pts, seed *ptx, seed *xyz)
{
	char line[80];
	*pts = (seed){ .name = "pts", .read = pts_read, .points = 11 };
	*xyz = (seed){ .name = "xyz", .read = xyz_read, .points = 11, .open_end = true };
	*ptx = (seed){ .name = "ptx", .read = ptx_read, .points = 11 };
	put_text(pts, "11\n");
	pts->header = pts->length;
	put_text(xyz, "# a comment\n# x y z \"a\" red,1\nx;y;z;w;red;green;blue\n");
	put_text(ptx, "4\n3\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
				  "0 1 0 0\n-1 0 0 0\n0 0 1 0\n10 20 30 1\n0 0 0 0.5\n");
	ptx->header = ptx->length;
	for (int i = 0; i < 11; i++) {
		snprintf(line, sizeof line, "%d.5 1e2 -0.001 -77 %d 2 255\r\n", i, i);
		put_text(pts, line);
		put_text(ptx, line);
		for (char *c = line; *c; c++)
			*c = *c == ' ' ? ';' : *c;
		put_text(xyz, line);
	}
}

static void make_e57(seed *s)
{
	*s = (seed){ .name = "e57", .read = e57_read, .points = 6 };
	s->length = e57_file_content(s->data, &s->xml);
	s->header = s->length;
}

static const char *const format_of[SEEDS] = {
	"ply", "ply", "ply", "ply", "cloud", "mesh-obj", "mtl",      "mesh-ply", "mesh-ply", "pcd",
	"pcd", "pcd", "pts", "ptx", "xyz",   "e57",      "mesh-off", "mesh-glb", "obj",      "glb",
};

void seed_files_make(seed seeds[SEEDS])
{
	make_ply(&seeds[0], "ascii ply", "ascii");
	make_ply(&seeds[1], "little-endian ply", "binary_little_endian");
	make_ply(&seeds[2], "big-endian ply", "binary_big_endian");
	make_plain_ply(&seeds[3]);
	make_cloud(&seeds[SEED_CLOUD]);
	make_obj(&seeds[5]);
	make_mtl(&seeds[6]);
	make_mesh_ply(&seeds[7], true);
	make_mesh_ply(&seeds[8], false);
	make_pcd(&seeds[9], "ascii pcd", "ascii");
	make_pcd(&seeds[10], "binary pcd", "binary");
	make_pcd(&seeds[11], "compressed pcd", "binary_compressed");
	make_tables(&seeds[12], &seeds[13], &seeds[14]);
	make_e57(&seeds[15]);
	make_off(&seeds[16]);
	make_glb(&seeds[17]);
	make_obj(&seeds[18]);
	make_glb(&seeds[19]);
	seeds[18].read = obj_read;
	seeds[19].read = glb_read;
	for (int i = 0; i < SEEDS; i++)
		seeds[i].format = format_of[i];
}
