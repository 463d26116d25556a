/*
 * verb_methods.c - the ways in which light between surfaces is gathered. All of them are records:
 * places, what these see, what is kept of it, and how points read it back.
 */
#include "verbs/verbs.h"
#include "program/json_writer.h"

#include <stdio.h>

/* One way, in words. */
typedef struct way {
	const char *name; /* of --method, or of the verb */
	const char *call;
	const char *place, *trace, *basis, *read_back, *source, *good_for;
} way;

static const way ways[] = {
	{ .name = "rays",
	  .call = "bake --method rays (taken unless another is named)",
	  .place = "on the surface, a few cells apart; closer where records disagree",
	  .trace = "rays against the planes in the octree's leaves; what they hit is kept, so that "
			   "every bounce and every other lighting is a sparse product",
	  .basis = "irradiance; where normals differ from a record's also how it changes as the normal "
			   "turns (--basis)",
	  .read_back = "by distance, normal, plane and visibility",
	  .source = "Salm 2015, Point Cloud Based Interactive Global Illumination, 4.4.3; Ward and "
				"Heckbert 1992, Irradiance Gradients",
	  .good_for = "light whose error is to be known and small" },
	{ .name = "region",
	  .call = "bake --region REGION",
	  .place = "as rays in the region; four times as far apart on what its rays meet, and on what "
			   "the rays from there meet; nowhere else",
	  .trace = "as rays",
	  .basis = "as rays",
	  .read_back = "as rays, at the points of the region",
	  .source = "the dependency analysis of Harada, A Point-based Global Illumination Rendering "
				"Pipeline for Environment Lighting",
	  .good_for = "one chamber, or one view, of a large scan" },
	{ .name = "cones",
	  .call = "bake --method cones",
	  .place = "as rays",
	  .trace = "cones through the bricks of the octree, again at every bounce",
	  .basis = "irradiance",
	  .read_back = "as rays",
	  .source = "Salm 2015, 4.4",
	  .good_for = "comparison; open scenes that are lit from all around" },
	{ .name = "buffers",
	  .call = "bake --method buffers",
	  .place = "as rays",
	  .trace =
		  "a buffer of each record, 16 x 16 texels, into which nodes of the octree are drawn, and "
		  "facets where these are too coarse; what they show is kept, as of rays",
	  .basis = "irradiance",
	  .read_back = "as rays",
	  .source =
		  "Harada, A Point-based Global Illumination Rendering Pipeline for Environment Lighting",
	  .good_for = "comparison: rays are quicker and nearer to the truth" },
	{ .name = "volume",
	  .call = "bake --method volume, bake --vdb-sh FILE",
	  .place = "in the cells of a uniform grid that are free",
	  .trace = "rays over the whole sphere, whose hits are kept",
	  .basis = "spherical harmonics, 4 or 9",
	  .read_back =
		  "half a cell before the surface, between the cells around, as far as they see it",
	  .source = "Mavridis and Papaioannou, Global Illumination using Imperfect Volumes",
	  .good_for = "light in free space, for game engines and Houdini" },
	{ .name = "lpv",
	  .call = "bake --method lpv",
	  .place = "in all cells of a uniform grid that are free",
	  .trace =
		  "none: surface sends its flux into the cells before it, and light goes on to the six "
		  "cells around, step by step; rays say once which cells see each other",
	  .basis = "spherical harmonics, 4",
	  .read_back = "as volume",
	  .source = "Kaplanyan and Dachsbacher 2010, Cascaded Light Propagation Volumes for Real-Time "
				"Indirect Illumination",
	  .good_for = "comparison with what engines do; light that spreads evenly and slowly varies" },
	{ .name = "probes",
	  .call = "probes, bake --method probes",
	  .place = "in free space, as few as see the surface: centres of the largest balls that fit, "
			   "chosen by Gibbs sampling",
	  .trace = "rays over the whole sphere",
	  .basis = "octahedral maps of radiance, normal and distance; spherical harmonics, 4 and 9",
	  .read_back =
		  "by whoever takes them: the four best for each cell of a grid are named; records "
		  "of a bake follow their rays through the maps",
	  .source = "Wang 2018, Automatic Placement of Radiance Probes",
	  .good_for = "engines that show the scan with things that move in it; as a method of baking, "
				  "to see what an engine that has but the probes makes of the light" },
	{ .name = "caches",
	  .call = "render --glossy caches",
	  .place =
		  "at pixels: one for each cluster of those that lie near each other, in a tile of the "
		  "picture and in depth, and face the same way",
	  .trace = "one ray through each texel of a hemisphere",
	  .basis = "a hemisphere of 16 x 16 texels of radiance and distance, and coarser ones",
	  .read_back = "from the caches that are near in the scene and in the picture, in directions "
				   "that share the gloss of the pixel, each as coarse as its share is wide",
	  .source = "Rehfeld, Zirr and Dachsbacher, Clustered Pre-convolved Radiance Caching",
	  .good_for = "pictures of rough glossy surfaces: a wet cave" },
};

enum { WAYS = sizeof ways / sizeof *ways, LINES = 7 };

typedef struct line {
	const char *title, *key, *text;
} line;

static void list_lines(const way *w, line lines[LINES])
{
	const line all[LINES] = { { "called by", "called_by", w->call },
							  { "place", "place", w->place },
							  { "trace", "trace", w->trace },
							  { "basis", "basis", w->basis },
							  { "read back", "read_back", w->read_back },
							  { "from", "source", w->source },
							  { "good for", "good_for", w->good_for } };
	for (int i = 0; i < LINES; i++)
		lines[i] = all[i];
}

static void print_text(FILE *out)
{
	line lines[LINES];
	fprintf(out, "Light is gathered at few places, and read back at all points; ways to do so:\n");
	for (int i = 0; i < WAYS; i++) {
		list_lines(&ways[i], lines);
		fprintf(out, "\n%s\n", ways[i].name);
		for (int k = 0; k < LINES; k++)
			fprintf(out, "  %-10s %s\n", lines[k].title, lines[k].text);
	}
}

static void print_json(FILE *out)
{
	line lines[LINES];
	json_writer json = { .out = out, .lines = true };
	json_put_open(&json, NULL, '{');
	json_put_open(&json, "methods", '[');
	for (int i = 0; i < WAYS; i++) {
		list_lines(&ways[i], lines);
		json_put_open(&json, NULL, '{');
		json_put_text(&json, "name", ways[i].name);
		for (int k = 0; k < LINES; k++)
			json_put_text(&json, lines[k].key, lines[k].text);
		json_put_close(&json, '}');
	}
	json_put_close(&json, ']');
	json_put_close(&json, '}');
	fputc('\n', out);
}

gw_status verb_methods(const settings *s, gw_error *error)
{
	if (s->input_count > 0)
		return gw_fail(error, GW_ERROR_USAGE, "methods takes no files: it lists what there is");
	if (s->json)
		print_json(stdout);
	else
		print_text(stdout);
	return GW_OK;
}
