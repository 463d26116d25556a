#include "hard_cloud.h"
#include "torture_child.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PI 3.14159265358979323846

const char *hard_shape_name(hard_shape shape)
{
	static const char *const name[] = { "sphere", "ball",  "room", "plane",
										"sheets", "hills", "tube", "crowd" };
	return name[shape];
}

bool hard_shape_is_closed(hard_shape shape)
{
	return shape == SPHERE || shape == ROOM;
}

hard_point *hard_cloud_push(hard_cloud *cloud)
{
	if (cloud->count == cloud->capacity) {
		cloud->capacity = cloud->capacity ? 2 * cloud->capacity : 1024;
		cloud->point = realloc(cloud->point, cloud->capacity * sizeof *cloud->point);
		if (!cloud->point)
			exit(71);
	}
	hard_point *p = &cloud->point[cloud->count++];
	*p = (hard_point){ .normal = { 0, 0, 1 }, .albedo = { 0.5, 0.5, 0.5 } };
	return p;
}

static void direction(torture_case *c, double d[3])
{
	double z = case_between(c, -1, 1), angle = 2 * PI * case_random(c), r = sqrt(1 - z * z);
	d[0] = r * cos(angle);
	d[1] = r * sin(angle);
	d[2] = z;
}

static void add_to_sphere(torture_case *c, hard_point *p, double facing)
{
	direction(c, p->at);
	for (int a = 0; a < 3; a++)
		p->normal[a] = facing * p->at[a];
}

static void add_to_room(torture_case *c, hard_point *p)
{
	int axis = (int)case_pick(c, 3), side = case_one_in(c, 2) ? 1 : -1;
	for (int a = 0; a < 3; a++) {
		p->at[a] = a == axis ? side : case_between(c, -1, 1);
		p->normal[a] = a == axis ? -side : 0;
	}
}

static void add_to_sheets(torture_case *c, hard_point *p, bool two)
{
	bool upper = two && case_one_in(c, 2);
	double at[3] = { case_between(c, -1, 1), case_between(c, -1, 1), upper ? 0.2 : 0 };
	memcpy(p->at, at, sizeof at);
	p->normal[2] = upper ? -1 : 1;
}

static void add_to_hills(torture_case *c, hard_point *p)
{
	double x = case_between(c, -1, 1), y = case_between(c, -1, 1);
	double slope[3] = { -0.6 * cos(3 * x) * cos(2 * y), 0.4 * sin(3 * x) * sin(2 * y), 1 };
	double length = sqrt(slope[0] * slope[0] + slope[1] * slope[1] + 1);
	double at[3] = { x, y, 0.2 * sin(3 * x) * cos(2 * y) };
	memcpy(p->at, at, sizeof at);
	for (int a = 0; a < 3; a++)
		p->normal[a] = slope[a] / length;
}

/* A quarter of a ring, whose cross section is a circle of radius 0.25. */
static void add_to_tube(torture_case *c, hard_point *p)
{
	double bend = PI / 2 * case_random(c), around = 2 * PI * case_random(c);
	double out = 1 + 0.25 * cos(around);
	double at[3] = { out * cos(bend), out * sin(bend), 0.25 * sin(around) };
	double normal[3] = { -cos(around) * cos(bend), -cos(around) * sin(bend), -sin(around) };
	memcpy(p->at, at, sizeof at);
	memcpy(p->normal, normal, sizeof normal);
}

void hard_cloud_add(torture_case *c, hard_cloud *cloud, hard_shape shape, size_t count)
{
	for (size_t i = 0; i < count; i++) {
		hard_point *p = hard_cloud_push(cloud);
		switch (shape) {
		case SPHERE:
			add_to_sphere(c, p, -1);
			break;
		case BALL:
			add_to_sphere(c, p, 1);
			break;
		case ROOM:
			add_to_room(c, p);
			break;
		case PLANE:
			add_to_sheets(c, p, false);
			break;
		case SHEETS:
			add_to_sheets(c, p, true);
			break;
		case HILLS:
			add_to_hills(c, p);
			break;
		case TUBE:
			add_to_tube(c, p);
			break;
		default:
			for (int a = 0; a < 3; a++)
				p->at[a] = case_between(c, -1, 1);
			direction(c, p->normal);
		}
	}
	cloud->has_normals = true;
}

void hard_cloud_albedo(hard_cloud *cloud, double albedo)
{
	for (size_t i = 0; i < cloud->count; i++)
		for (int a = 0; a < 3; a++)
			cloud->point[i].albedo[a] = albedo;
}

void hard_cloud_emission(hard_cloud *cloud, double emission)
{
	for (size_t i = 0; i < cloud->count; i++)
		for (int a = 0; a < 3; a++)
			cloud->point[i].emission[a] = emission;
	cloud->has_emission = true;
}

/* Rodrigues' formula: v cos + (k x v) sin + k (k.v)(1 - cos). */
static void turn(double v[3], const double k[3], double angle)
{
	double s = sin(angle), n = cos(angle), dot = k[0] * v[0] + k[1] * v[1] + k[2] * v[2];
	double cross[3] = { k[1] * v[2] - k[2] * v[1], k[2] * v[0] - k[0] * v[2],
						k[0] * v[1] - k[1] * v[0] };
	for (int a = 0; a < 3; a++)
		v[a] = v[a] * n + cross[a] * s + k[a] * dot * (1 - n);
}

void hard_cloud_turn(torture_case *c, hard_cloud *cloud)
{
	double axis[3], angle = 2 * PI * case_random(c);
	direction(c, axis);
	for (size_t i = 0; i < cloud->count; i++) {
		turn(cloud->point[i].at, axis, angle);
		turn(cloud->point[i].normal, axis, angle);
	}
}

void hard_cloud_place(hard_cloud *cloud, double scale, const double shift[3])
{
	for (size_t i = 0; i < cloud->count; i++)
		for (int a = 0; a < 3; a++)
			cloud->point[i].at[a] = scale * cloud->point[i].at[a] + shift[a];
}

void hard_cloud_shake(torture_case *c, hard_cloud *cloud, double deviation)
{
	for (size_t i = 0; i < cloud->count; i++)
		for (int a = 0; a < 3; a++)
			cloud->point[i].at[a] += deviation * case_gaussian(c);
}

void hard_cloud_shuffle(torture_case *c, hard_cloud *cloud)
{
	for (size_t i = cloud->count; i > 1; i--) {
		size_t j = (size_t)case_pick(c, (long)i);
		hard_point kept = cloud->point[i - 1];
		cloud->point[i - 1] = cloud->point[j];
		cloud->point[j] = kept;
	}
}

static size_t put_floats(unsigned char *at, const double v[3])
{
	for (int a = 0; a < 3; a++) {
		float f = (float)v[a];
		memcpy(at + 4 * a, &f, 4);
	}
	return 12;
}

void hard_cloud_write(const torture_case *c, const hard_cloud *cloud, const char *name)
{
	unsigned char *bytes = malloc(cloud->count * 60 + 1000);
	if (!bytes)
		exit(71);
	char *header = (char *)bytes;
	size_t n = (size_t)sprintf(header,
							   "ply\nformat binary_little_endian 1.0\nelement vertex %zu\n"
							   "property double x\nproperty double y\nproperty double z\n",
							   cloud->count);
	if (cloud->has_normals)
		n += (size_t)sprintf(header + n, "property float nx\nproperty float ny\n"
										 "property float nz\n");
	n += (size_t)sprintf(header + n, "property float red\nproperty float green\n"
									 "property float blue\n");
	if (cloud->has_emission)
		n += (size_t)sprintf(header + n, "property float emission_r\nproperty float emission_g\n"
										 "property float emission_b\n");
	n += (size_t)sprintf(header + n, "end_header\n");
	for (size_t i = 0; i < cloud->count; i++) {
		const hard_point *p = &cloud->point[i];
		memcpy(bytes + n, p->at, 24);
		n += 24;
		if (cloud->has_normals)
			n += put_floats(bytes + n, p->normal);
		n += put_floats(bytes + n, p->albedo);
		if (cloud->has_emission)
			n += put_floats(bytes + n, p->emission);
	}
	child_write_file(c, name, bytes, n);
	free(bytes);
}

void hard_cloud_clear(hard_cloud *cloud)
{
	free(cloud->point);
	*cloud = (hard_cloud){ 0 };
}
