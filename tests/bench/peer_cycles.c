/*
 * peer_cycles.c - see peer_cycles.h.
 *
 * Files for peer_cycles.py, in the byte order of the machine: counts of surfels and of corners
 * (uint64); origin of the local frame, how far above the surface light is measured, spacing
 * (float64); corners (3 float32 each); corners of each surfel (uint32); positions, normals, albedo
 * and emission (3 float32 a surfel each). Back come seconds (2 float64) and irradiance (3 float32 a
 * surfel).
 */
#include "peer_cycles.h"

#include "base/memory.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

/* A polygon reaches as far as the surfel's 8th neighbour. What may own a part of it lies within
 * twice that, which is four times the surface. */
#define NEIGHBOURS 32u

/* A disc begins as a polygon around it of so many corners; each cut adds one at most. */
#define ROUND 12u
#define HALF_TURN 3.141592653589793
#define MOST_CORNERS (ROUND + NEIGHBOURS + 2u)

/* ------------------------------------------------------------------------------- polygons */

typedef struct polygon {
	float corner[MOST_CORNERS][2]; /* in the plane of its disc */
	size_t corners;
} polygon;

/* Leaves what lies at most `most` along (x, y), which has any length (Sutherland and Hodgman
 * 1974). */
static void cut(polygon *p, float x, float y, float most)
{
	polygon left = { .corners = 0 };
	for (size_t i = 0; i < p->corners; i++) {
		const float *a = p->corner[i], *b = p->corner[(i + 1) % p->corners];
		float off_a = x * a[0] + y * a[1] - most, off_b = x * b[0] + y * b[1] - most;
		if (off_a <= 0.0f)
			memcpy(left.corner[left.corners++], a, sizeof *left.corner);
		if ((off_a <= 0.0f) == (off_b <= 0.0f))
			continue;
		float share = off_a / (off_a - off_b);
		for (int k = 0; k < 2; k++)
			left.corner[left.corners][k] = a[k] + share * (b[k] - a[k]);
		left.corners++;
	}
	*p = left;
}

/* A surfel's disc, without what lies beyond edges or nearer to a neighbour that faces alike. */
static polygon polygon_of(const peer_discs *d, size_t i)
{
	const gw_surfels *s = &d->surfels;
	const float *frame = d->frame + 6 * i, *clip = s->clip + 6 * i;
	polygon p = { .corners = ROUND };
	for (size_t k = 0; k < ROUND; k++) {
		double turn = 2.0 * HALF_TURN * (double)k / ROUND;
		double radius = (double)s->radius[i] / cos(HALF_TURN / ROUND);
		p.corner[k][0] = (float)(radius * cos(turn));
		p.corner[k][1] = (float)(radius * sin(turn));
	}
	for (size_t k = 0; k < 6; k += 3)
		if (clip[k] != 0.0f || clip[k + 1] != 0.0f)
			cut(&p, clip[k], clip[k + 1], clip[k + 2]);
	for (size_t k = 0; k < d->neighbours; k++) {
		size_t j = d->neighbour[i * d->neighbours + k];
		float to[3], x = 0.0f, y = 0.0f, squared = 0.0f;
		for (size_t c = 0; c < 3; c++) {
			to[c] = s->position[3 * j + c] - s->position[3 * i + c];
			x += to[c] * frame[c];
			y += to[c] * frame[3 + c];
			squared += to[c] * to[c];
		}
		if (j != i && peer_discs_alike(d, i, j))
			cut(&p, x, y, 0.5f * squared);
	}
	return p;
}

/* Writes corners of all polygons, then how many each has; how many there are. */
static uint64_t write_corners(const peer_discs *d, FILE *file, uint32_t *corners)
{
	uint64_t sum = 0;
	for (size_t i = 0; i < d->surfels.count; i++) {
		polygon p = polygon_of(d, i);
		const float *middle = d->surfels.position + 3 * i, *frame = d->frame + 6 * i;
		corners[i] = p.corners < 3 ? 0 : (uint32_t)p.corners;
		for (size_t k = 0; k < corners[i]; k++) {
			float place[3];
			for (size_t c = 0; c < 3; c++)
				place[c] = middle[c] + p.corner[k][0] * frame[c] + p.corner[k][1] * frame[3 + c];
			fwrite(place, sizeof place, 1, file);
		}
		sum += corners[i];
	}
	fwrite(corners, sizeof *corners, d->surfels.count, file);
	return sum;
}

static gw_status write_polygons(const peer_discs *d, const char *path, gw_error *error)
{
	const gw_surfels *s = &d->surfels;
	const double header[5] = { s->origin[0], s->origin[1], s->origin[2],
							   (double)(PEER_OFFSET * s->spacing), (double)s->spacing };
	uint64_t counts[2] = { s->count, 0 };
	uint32_t *corners = gw_allocate_array(s->count, sizeof *corners);
	float *dark = s->emission ? NULL : gw_allocate_zeros(s->count, 3 * sizeof *dark);
	FILE *file = corners && (dark || s->emission) ? fopen(path, "wb") : NULL;
	if (file) {
		const float *const column[4] = { s->position, s->normal, s->albedo,
										 dark ? dark : s->emission };
		fwrite(counts, sizeof counts, 1, file);
		fwrite(header, sizeof header, 1, file);
		counts[1] = write_corners(d, file, corners);
		for (int k = 0; k < 4; k++)
			fwrite(column[k], 3 * sizeof(float), s->count, file);
		rewind(file);
		fwrite(counts, sizeof counts, 1, file);
	}
	bool whole = file && !ferror(file);
	whole = file && fclose(file) == 0 && whole;
	free(corners);
	free(dark);
	return whole ? GW_OK : gw_fail(error, GW_ERROR_INTERNAL, "cannot write %s", path);
}

gw_status peer_cycles_make(peer_discs *discs, const char *script, const char *scene,
						   peer_cycles *cycles, gw_error *error)
{
	const char *root = getenv("TMPDIR");
	*cycles = (peer_cycles){ .script = script, .scene = scene, .count = discs->surfels.count };
	GW_TRY(peer_discs_neighbours(discs, NEIGHBOURS, error));
	bool named =
		asprintf(&cycles->folder, "%s/peer_cycles.XXXXXX", root && *root ? root : "/tmp") > 0 &&
		mkdtemp(cycles->folder) && asprintf(&cycles->polygons, "%s/polygons", cycles->folder) > 0 &&
		asprintf(&cycles->light, "%s/light", cycles->folder) > 0;
	if (!named)
		return gw_fail(error, GW_ERROR_INTERNAL, "no folder for files: %s", strerror(errno));
	return write_polygons(discs, cycles->polygons, error);
}

void peer_cycles_clear(peer_cycles *cycles)
{
	if (cycles->light)
		unlink(cycles->light);
	if (cycles->polygons)
		unlink(cycles->polygons);
	if (cycles->folder)
		rmdir(cycles->folder);
	free(cycles->light);
	free(cycles->polygons);
	free(cycles->folder);
	*cycles = (peer_cycles){ 0 };
}

/* -------------------------------------------------------------------------------- Blender */

/* What it says is left out: it says much. It ends with 0 even when its script fails; what the
 * script made tells. */
static gw_status run_blender(const peer_cycles *c, const char *samples, gw_error *error)
{
	/* Its Python looks for its modules beside the first python3 of PATH: that is to be Blender's.
	 */
	char *const arguments[] = { "sh",
								"-c",
								"b=$(command -v blender) && PATH=${b%/*}:$PATH exec \"$b\" \"$@\"",
								"sh",
								"-b",
								"--factory-startup",
								"--python",
								(char *)(uintptr_t)c->script,
								"--",
								(char *)(uintptr_t)c->scene,
								c->polygons,
								c->light,
								(char *)(uintptr_t)samples,
								NULL };
	posix_spawn_file_actions_t actions;
	pid_t child;
	int end = 0;
	posix_spawn_file_actions_init(&actions);
	posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
	int failed = posix_spawn(&child, "/bin/sh", &actions, NULL, arguments, environ);
	posix_spawn_file_actions_destroy(&actions);
	if (failed)
		return gw_fail(error, GW_ERROR_INTERNAL, "no shell: %s", strerror(failed));
	if (waitpid(child, &end, 0) != child || !WIFEXITED(end) || WEXITSTATUS(end) != 0)
		return gw_fail(error, GW_ERROR_INTERNAL, "Blender came to a bad end (%#x)", (unsigned)end);
	return GW_OK;
}

gw_status peer_cycles_light(const peer_cycles *cycles, uint32_t samples, float *irradiance,
							double seconds[2], gw_error *error)
{
	char text[16];
	snprintf(text, sizeof text, "%u", samples);
	unlink(cycles->light);
	GW_TRY(run_blender(cycles, text, error));
	FILE *file = fopen(cycles->light, "rb");
	bool whole = file && fread(seconds, sizeof *seconds, 2, file) == 2 &&
				 fread(irradiance, 3 * sizeof(float), cycles->count, file) == cycles->count;
	if (file)
		fclose(file);
	return whole ? GW_OK : gw_fail(error, GW_ERROR_INTERNAL, "Blender made no light");
}
