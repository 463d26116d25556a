#include "options/options.h"
#include "table/format_table.h"
#include "program/nearest_name.h"
#include "options/preview.h"
#include "units/coordinates.h"
#include "program/text_quote.h"

#include <assert.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* --------------------------------------------------------------------------------- names */

static const char *method_name(int i)
{
	return i < GW_METHOD_COUNT ? gw_method_name((gw_method)i) : NULL;
}

static const char *shadows_name(int i)
{
	return i < GW_SHADOWS_COUNT ? gw_shadows_name((gw_shadows)i) : NULL;
}

static const char *passes_name(int i)
{
	return i < GW_PASSES_COUNT ? gw_pass_choice_name((gw_pass_choice)i) : NULL;
}

static const char *capture_name(int i)
{
	static const char *const name[] = {
		[SETTINGS_CAPTURE_AUTO] = "auto",           [SETTINGS_CAPTURE_LIGHTS] = "lights",
		[SETTINGS_CAPTURE_FLASH] = "flash",         [SETTINGS_CAPTURE_OVERCAST] = "overcast",
		[SETTINGS_CAPTURE_INTENSITY] = "intensity", [SETTINGS_CAPTURE_COUNT] = NULL
	};
	return name[i];
}

static const char *remainder_name(int i)
{
	static const char *const name[] = { [SETTINGS_REMAINDER_ALBEDO] = "albedo",
										[SETTINGS_REMAINDER_LIGHT] = "light",
										[SETTINGS_REMAINDER_COUNT] = NULL };
	return name[i];
}

static const char *normals_name(int i)
{
	static const char *const name[] = { [GW_NORMALS_AUTO] = "auto",
										[GW_NORMALS_GIVEN] = "given",
										[GW_NORMALS_ESTIMATE] = "estimate",
										[GW_NORMALS_COUNT] = NULL };
	return name[i];
}

static const char *validation_name(int i)
{
	return i < GW_VALIDATION_COUNT ? gw_validation_name((gw_validation)i) : NULL;
}

static const char *quality_name(int i)
{
	return i < GW_QUALITY_COUNT ? gw_quality_name((gw_quality)i) : NULL;
}

static const char *gamma_name(int i)
{
	static const char *const name[] = { "srgb", "linear", NULL };
	return name[i];
}

static const char *up_name(int i)
{
	if (i == SETTINGS_UP_AUTO)
		return "auto";
	return i < SETTINGS_UP_COUNT ? settings_up_name(settings_up_axis(i)) : NULL;
}

static const char *length_name(int i)
{
	return i < COORDINATES_UNIT_COUNT ? coordinates_unit_name((coordinates_unit)i) : NULL;
}

static const char *strays_name(int i)
{
	static const char *const name[] = { "light", "keep", "drop", NULL };
	return name[i];
}

static const char *colors_name(int i)
{
	static const char *const name[] = { "preview", "keep", NULL };
	return name[i];
}

static const char *las_radiance_name(int i)
{
	static const char *const name[] = {
		[SETTINGS_LAS_FLOAT] = "float",
		[SETTINGS_LAS_HALF] = "half",
		[SETTINGS_LAS_BFLOAT16] = "bfloat16",
		[SETTINGS_LAS_COUNT] = NULL,
	};
	return name[i];
}

static const char *tone_name(int i)
{
	return i < PREVIEW_TONE_COUNT ? preview_tone_name((preview_tone)i) : NULL;
}

static const char *view_name(int i)
{
	static const char *const name[] = { [SETTINGS_VIEW_AUTO] = "auto",
										[SETTINGS_VIEW_RADIANCE] = "radiance",
										[SETTINGS_VIEW_SHADED] = "shaded",
										[SETTINGS_VIEW_ALBEDO] = "albedo",
										[SETTINGS_VIEW_NORMAL] = "normal",
										[SETTINGS_VIEW_DEPTH] = "depth",
										[SETTINGS_VIEW_DIRECT] = "direct",
										[SETTINGS_VIEW_INDIRECT] = "indirect",
										[SETTINGS_VIEW_IRRADIANCE] = "irradiance",
										[SETTINGS_VIEW_ILLUMINANCE] = "illuminance",
										[SETTINGS_VIEW_ROI] = "roi",
										[SETTINGS_VIEW_NDF] = "ndf",
										[SETTINGS_VIEW_POINTS] = "points",
										[SETTINGS_VIEW_CELLS] = "cells:LEVEL",
										[SETTINGS_VIEW_BORDER] = "border:LEVEL",
										[SETTINGS_VIEW_OCTREE] = "octree:LEVEL",
										[SETTINGS_VIEW_OPACITY] = "opacity:LEVEL:SIDE",
										[SETTINGS_VIEW_VOXELS] = "radiance:LEVEL:SIDE",
										[SETTINGS_VIEW_SHADOW] = "shadow:LAMP",
										[SETTINGS_VIEW_RECORDS] = "records",
										[SETTINGS_VIEW_SAMPLES] = "samples",
										[SETTINGS_VIEW_ERROR] = "error",
										[SETTINGS_VIEW_GAPS] = "gaps",
										[SETTINGS_VIEW_COUNT] = NULL };
	return name[i];
}

static const char *glossy_name(int i)
{
	static const char *const name[] = {
		[SETTINGS_GLOSSY_OFF] = "off",       [SETTINGS_GLOSSY_RAYS] = "rays",
		[SETTINGS_GLOSSY_CONES] = "cones",   [SETTINGS_GLOSSY_CACHES] = "caches",
		[SETTINGS_GLOSSY_PROBES] = "probes", [SETTINGS_GLOSSY_COUNT] = NULL
	};
	return name[i];
}

static const char *radiance_name(int i)
{
	static const char *const name[] = { [SETTINGS_RADIANCE_POINTS] = "points",
										[SETTINGS_RADIANCE_TRILINEAR] = "trilinear",
										[SETTINGS_RADIANCE_TRICUBIC] = "tricubic",
										[SETTINGS_RADIANCE_COUNT] = NULL };
	return name[i];
}

static const char *progress_name(int i)
{
	static const char *const name[] = { "auto", "json", "none", NULL };
	return name[i];
}

static const char *basis_name(int i)
{
	return i < GW_BASIS_COUNT ? gw_basis_name((gw_basis)i) : NULL;
}

static const char *gaps_name(int i)
{
	return i < GW_GAPS_COUNT ? gw_gaps_name((gw_gaps)i) : NULL;
}

static const char *field_name(int i)
{
	static const char *const name[] = { [SETTINGS_FIELD_DIRECT] = "direct",
										[SETTINGS_FIELD_INDIRECT] = "indirect",
										[SETTINGS_FIELD_IRRADIANCE] = "irradiance",
										[SETTINGS_FIELD_DIRECT_IRRADIANCE] = "direct-irradiance",
										[SETTINGS_FIELD_INDIRECT_IRRADIANCE] =
											"indirect-irradiance",
										[SETTINGS_FIELD_LUMINANCE] = "luminance",
										[SETTINGS_FIELD_ILLUMINANCE] = "illuminance",
										[SETTINGS_FIELD_ROI] = "roi",
										[SETTINGS_FIELD_AO] = "ao",
										[SETTINGS_FIELD_BENT_NORMALS] = "bent-normals",
										[SETTINGS_FIELD_NORMALS] = "normals",
										[SETTINGS_FIELD_ERROR] = "error",
										[SETTINGS_FIELD_UNKNOWN] = "unknown",
										[SETTINGS_FIELD_LIGHTS] = "lights",
										[SETTINGS_FIELD_GROUPS] = "groups",
										[SETTINGS_FIELD_COUNT] = NULL };
	return name[i];
}

static const char *picture_effect_name(int i)
{
	return i == 0 ? settings_effect_name(SETTINGS_EFFECT_GLOSS) : NULL;
}

/* Of the formats that can be read, or else written, the i-th. */
static const char *format_name(int i, bool read)
{
	size_t f = 0;
	for (; formats[f]; f++)
		if ((read ? formats[f]->read != NULL : formats[f]->write != NULL) && i-- == 0)
			break;
	return formats[f] ? formats[f]->name : NULL;
}

static const char *format_read_name(int i)
{
	return format_name(i, true);
}

static const char *format_write_name(int i)
{
	return format_name(i, false);
}

/* -------------------------------------------------------------------------------- the table */

/* The verbs that an option is for, as FOR(BAKE | RENDER). */
enum {
	BAKE = 1u << VERB_BAKE,
	PLAN = 1u << VERB_PLAN,
	SAMPLE = 1u << VERB_SAMPLE,
	INFO = 1u << VERB_INFO,
	COMPARE = 1u << VERB_COMPARE,
	TRADEOFF = 1u << VERB_TRADEOFF,
	MIX = 1u << VERB_MIX,
	CONVERT = 1u << VERB_CONVERT,
	RENDER = 1u << VERB_RENDER,
	DOCTOR = 1u << VERB_DOCTOR,
	ALBEDO = 1u << VERB_ALBEDO,
	LAMP = 1u << VERB_LAMP,
	MEASURE = 1u << VERB_MEASURE,
	PROBES = 1u << VERB_PROBES,
	METHODS = 1u << VERB_METHODS,
	PAGE = 1u << VERB_PAGE,
	EVERY_VERB = (1u << VERB_COUNT) - 1
};

#define AT(member) .offset = offsetof(settings, member)
#define FOR(mask) .verbs = (mask)
#define OFTEN(mask) .common = (mask)
#define QUIETLY .effect = OPTION_LEAVES_POINTS
#define RANGE(low, high) .minimum = (low), .maximum = (high)
#define LIMIT RANGE(0.0, 1e6), .automatic = "none", .automatic_value = (NAN)
#define AUTOMATIC(value) .automatic = "auto", .automatic_value = (value)

static_assert(sizeof(gw_method) == sizeof(int) && sizeof(gw_shadows) == sizeof(int) &&
				  sizeof(gw_pass_choice) == sizeof(int) && sizeof(gw_validation) == sizeof(int),
			  "choices are stored as int");

const option options[] = {
	{ "output", 'o', "FILE", OPTION_TEXT, QUIETLY,
	  FOR(BAKE | PLAN | SAMPLE | MIX | CONVERT | ALBEDO),
	  OFTEN(BAKE | SAMPLE | MIX | CONVERT | ALBEDO), AT(output), .group = "Output",
	  .help = "write the points there; - is standard output. The name's extension chooses the "
			  "format" },
	{ "output-format", 0, NULL, OPTION_TEXT, QUIETLY, FOR(BAKE | SAMPLE | MIX | CONVERT | ALBEDO),
	  OFTEN(CONVERT), AT(output_format), .choice = format_write_name, .group = "Output",
	  .help = "write the points as this format, whatever the name's extension says" },
	{ "shift", 0, "auto|X,Y,Z", OPTION_TEXT, FOR(BAKE | MIX | CONVERT | ALBEDO), AT(shift),
	  .group = "Output",
	  .help = "write coordinates of a map as floats: less X,Y,Z, which the header of the PLY file "
			  "says; auto takes the middle of the points, to a kilometre, of each axis on which "
			  "some are 10,000 or more. Lamps, scanners and cameras keep the input's coordinates, "
			  "and reading such a file adds X,Y,Z again" },
	{ "las-radiance", 0, NULL, OPTION_CHOICE, QUIETLY, FOR(BAKE | MIX | CONVERT), AT(las_radiance),
	  .choice = las_radiance_name, .group = "Output",
	  .help = "how exactly LAS, LAZ and COPC keep the columns of light: as they are, or rounded to "
			  "the 11 bits of a half float, up to 0.05 % off, or the 8 of a bfloat16, up to 0.4 % "
			  "off. LAZ gets smaller, readers see floats all the same" },
	{ "las-step", 0, "X", OPTION_REAL, QUIETLY, FOR(BAKE | MIX | CONVERT), AT(las_step),
	  RANGE(0.0, 1e-3), AUTOMATIC(-1.0), .group = "Output",
	  .help = "let LAS, LAZ and COPC round coordinates to a grid of this step, in their own units, "
			  "and normals to multiples of 1/2048, up to 0.025 degrees off; 0 gives both back as "
			  "they are, wherever LAS can. For most scans 0.0001, a tenth of a millimetre, is "
			  "finer than what the scanner saw. auto takes the step of LAS that came in, else the "
			  "coarsest power of ten, up to 0.001, that moves no point by more than a hundredth of "
			  "the median distance between neighbours" },
	{ "force", 'f', NULL, OPTION_FLAG, QUIETLY,
	  FOR(BAKE | SAMPLE | COMPARE | TRADEOFF | MIX | CONVERT | RENDER | ALBEDO | LAMP | PROBES |
		  PAGE),
	  OFTEN(BAKE | SAMPLE | MIX | CONVERT | RENDER | ALBEDO | PROBES | COMPARE | PAGE), AT(force),
	  .group = "Output", .help = "overwrite files that exist" },
	{ "resume", 0, NULL, OPTION_FLAG, QUIETLY, FOR(BAKE), OFTEN(BAKE), AT(resume),
	  .group = "Output",
	  .help =
		  "of a cloud that is baked by parts (--memory): keep what is done beside the output, in "
		  "FILE.part and FILE.resume, when the bake is stopped or killed, and go on with it when "
		  "the same command is given again" },
	{ "vdb", 0, "FILE", OPTION_TEXT, QUIETLY, FOR(BAKE | PLAN), OFTEN(BAKE), AT(vdb),
	  .group = "Output",
	  .help = "write the voxels as OpenVDB grids: density, radiance, color, emission, normal" },
	{ "vdb-half", 0, NULL, OPTION_FLAG, QUIETLY, FOR(BAKE | PLAN), AT(vdb_half), .group = "Output",
	  .help = "store 16-bit floats in the grids" },
	{ "vdb-points", 0, NULL, OPTION_FLAG, QUIETLY, FOR(BAKE | PLAN), AT(vdb_points),
	  .group = "Output",
	  .help = "put the points beside the grids, as a point grid: P, radiance, Cd (albedo), N" },
	{ "vdb-voxel", 0, "SIZE", OPTION_REAL, QUIETLY, FOR(BAKE | PLAN), AT(vdb_voxel),
	  RANGE(0.0, 1e9), .group = "Output",
	  .help = "metres a voxel of the grids is wide, wider than the octree's cells; 0: as wide" },
	{ "vdb-sh", 0, "FILE", OPTION_TEXT, QUIETLY, FOR(BAKE | PLAN), AT(vdb_sh), .group = "Output",
	  .help = "write the radiance that arrives in free space as OpenVDB grids of spherical "
			  "harmonics, sh_0 to sh_3 or sh_8; --volume-cells and --volume-sh say how fine" },
	{ "report", 0, "FILE", OPTION_TEXT, QUIETLY, FOR(BAKE), OFTEN(BAKE), AT(report),
	  .group = "Output", .help = "write what was done, left out and measured, as JSON" },
	{ "save-transport", 0, "FILE", OPTION_TEXT, QUIETLY, FOR(BAKE | PROBES), AT(save_transport),
	  .group = "Output",
	  .help = "write what does not depend on the light, for --transport; with --vdb also what its "
			  "grids are made of" },
	{ "fields", 0, "LIST", OPTION_FIELDS, FOR(BAKE | PLAN), OFTEN(BAKE), .scene = true, AT(fields),
	  .choice = field_name, .group = "Output",
	  .help = "more columns for the points, with commas between them" },
	{ "ao-distance", 0, "X", OPTION_REAL, FOR(BAKE | PLAN), .scene = true,
	  AT(bake.ambient_occlusion_distance), RANGE(0.0, 1e9), .automatic = "none",
	  .automatic_value = 0.0, .open = true, .group = "Output",
	  .help = "metres beyond which surfaces do not count for --fields ao; none is any distance" },
	{ "colors", 0, NULL, OPTION_CHOICE, FOR(BAKE | MIX), .scene = true, AT(colors),
	  .choice = colors_name, .group = "Output",
	  .help = "what red, green and blue hold: a tone-mapped preview, or what came in" },
	{ "exposure", 0, "EV", OPTION_REAL, FOR(BAKE | MIX), OFTEN(BAKE | MIX), .scene = true,
	  AT(exposure), RANGE(-100.0, 100.0), AUTOMATIC(NAN), .group = "Output",
	  .help = "of the preview, as a camera's exposure value at ISO 100: a larger one is darker" },

	{ "output", 'o', "FILE", OPTION_TEXT, QUIETLY, FOR(PROBES), OFTEN(PROBES), AT(output),
	  .group = "Output",
	  .help = "write the maps of all probes there, as one OpenEXR picture; - is standard output" },
	{ "json", 0, "FILE", OPTION_TEXT, QUIETLY, FOR(PROBES), OFTEN(PROBES), AT(json_file),
	  .group = "Output",
	  .help = "write places, free balls and spherical harmonics of the probes as JSON; - is "
			  "standard output" },
	{ "vdb", 0, "FILE", OPTION_TEXT, QUIETLY, FOR(PROBES), AT(vdb), .group = "Output",
	  .help = "write which probes serve each cell of a grid as OpenVDB grids: probe_0 to probe_3" },
	{ "picture", 0, "FILE", OPTION_TEXT, QUIETLY, FOR(PROBES), OFTEN(PROBES), AT(picture),
	  .group = "Output",
	  .help = "write a picture of the lit scene with a ball at each probe, white and diffuse in "
			  "the light that the probe's harmonics hold, as PNG" },
	{ "camera", 'c', "CAMERA", OPTION_TEXT, QUIETLY, FOR(PROBES), AT(render.camera),
	  .group = "Output",
	  .help = "of --picture: 'at X,Y,Z to X,Y,Z fov DEGREES', or auto, inside or outside, which "
			  "choose a place" },
	{ "size", 0, "N", OPTION_COUNT, FOR(PROBES), OFTEN(PROBES), AT(probes.size),
	  RANGE(GW_PROBE_SIZE_LEAST, GW_PROBE_SIZE_MOST), .group = "Probes",
	  .help = "texels a side of each probe's maps, a power of two" },
	{ "count", 0, "N", OPTION_COUNT, FOR(PROBES), OFTEN(PROBES), AT(probes.count), RANGE(1.0, 1e6),
	  AUTOMATIC(0.0), .group = "Probes",
	  .help = "probes at most; auto is as many as see all that any place for one sees" },
	{ "moves", 0, "N", OPTION_COUNT, FOR(PROBES), AT(probes.moves), RANGE(0.0, 1e6),
	  .group = "Probes",
	  .help =
		  "how often it is tried to move a probe, so that fewer see as much, or so that they see "
		  "more, from in front and from afar" },
	{ "grid", 0, "N", OPTION_COUNT, FOR(PROBES), AT(probes.grid), RANGE(1.0, GW_PROBE_GRID_MOST),
	  .automatic = "none", .automatic_value = 0.0, .group = "Probes",
	  .help = "put N x N x N probes in a regular grid, as engines do, to compare with: at the "
			  "middles of its cells, but for those at surface or behind it" },
	{ "margin", 0, "X", OPTION_REAL, FOR(PROBES), AT(probes.margin), RANGE(0.0, 1e9),
	  .group = "Probes",
	  .help = "metres by which probes may stand outside the bounds of the points" },

	{ "worst", 0, "FILE", OPTION_TEXT, QUIETLY, FOR(COMPARE), OFTEN(COMPARE), AT(worst),
	  .group = "Output",
	  .help = "write the points with the largest errors there, the worst first, with the columns "
			  "scalar_error and scalar_truth_radiance_*" },
	{ "worst-count", 0, "N", OPTION_COUNT, QUIETLY, FOR(COMPARE), AT(worst_count), RANGE(1.0, 4e9),
	  .group = "Output", .help = "how many those are" },
	{ "json", 0, "FILE", OPTION_TEXT, QUIETLY, FOR(COMPARE), OFTEN(COMPARE), AT(json_file),
	  .group = "Output", .help = "write the figures as JSON; - prints them instead of the table" },

	{ "csv", 0, "FILE", OPTION_TEXT, QUIETLY, FOR(TRADEOFF), OFTEN(TRADEOFF), AT(csv),
	  .group = "Output",
	  .help = "write the table as comma-separated values; - prints them instead of the table" },
	{ "svg", 0, "FILE", OPTION_TEXT, QUIETLY, FOR(TRADEOFF), OFTEN(TRADEOFF), AT(svg),
	  .group = "Output", .help = "draw error against seconds and against memory" },

	{ "max-relrmse", 0, "X", OPTION_REAL, QUIETLY, FOR(COMPARE), OFTEN(COMPARE), AT(max_rel_rmse),
	  LIMIT, .group = "Limits",
	  .help = "largest relRMSE of the radiance's luminance, 0.05 being 5 %" },
	{ "max-best99", 0, "X", OPTION_REAL, QUIETLY, FOR(COMPARE), AT(max_best_99), LIMIT,
	  .group = "Limits", .help = "the same without the hundredth of the points that is worst" },
	{ "max-bias", 0, "X", OPTION_REAL, QUIETLY, FOR(COMPARE), AT(max_bias), LIMIT,
	  .group = "Limits",
	  .help = "largest difference of the means, to either side, as a share of the truth's" },

	{ "gain", 'g', "NAME=FACTOR", OPTION_GAIN, FOR(MIX), OFTEN(MIX), .group = "Lamps",
	  .help = "make a lamp so many times as strong as it is; 0 switches it off, R,G,B dyes it. May "
			  "be given many times; the name rest is all light that belongs to no lamp" },
	{ "group", 0, "NAME=FACTOR", OPTION_GROUP, FOR(MIX), OFTEN(MIX), .group = "Lamps",
	  .help = "the same for all lamps of a group" },
	{ "setup", 0, "NAME: LAMP=FACTOR ...", OPTION_SETUP, FOR(PAGE), OFTEN(PAGE), .group = "Lamps",
	  .help = "put a button on the page that makes lamps so many times as strong as they were "
			  "baked, and all others as strong as they were: 'evening: sun=0 hall=0.3 "
			  "torch=1,0.6,0.3'. Groups go by their names, and all by *. May be given many times" },
	{ "output", 'o', "FILE", OPTION_TEXT, QUIETLY, FOR(PAGE), OFTEN(PAGE), AT(output),
	  .group = "Output", .help = "write the page there; - is standard output" },
	{ "points", 0, "N", OPTION_COUNT, FOR(PAGE), OFTEN(PAGE), AT(page_points), RANGE(1.0, 16e6),
	  .group = "Output",
	  .help = "show at most so many points, spread evenly over the cloud, by wider discs; a page "
			  "has some 20 bytes a point and 5 for each lamp" },
	{ "title", 0, "TEXT", OPTION_TEXT, FOR(PAGE), OFTEN(PAGE), AT(title), .group = "Output",
	  .help = "what the page is called; the input's name otherwise" },
	{ "output", 'o', "FILE", OPTION_TEXT, QUIETLY, FOR(LAMP), AT(output), .group = "Output",
	  .help = "draw its light there as a polar picture, PNG or EXR by the name's extension" },
	{ "output", 'o', "FILE", OPTION_TEXT, QUIETLY, FOR(RENDER), OFTEN(RENDER), AT(output),
	  .group = "Output",
	  .help = "write the picture there, as PNG or EXR by the name's extension; - is a PNG on "
			  "standard output. Several pictures are numbered: FILE-0001.png" },
	{ "size", 0, "WxH", OPTION_TEXT, FOR(RENDER), OFTEN(RENDER), AT(render.size), .group = "Output",
	  .help = "width and height of the picture in pixels, 1 to 16384 each" },
	{ "samples", 0, "N", OPTION_COUNT, FOR(RENDER), AT(render.samples), RANGE(1.0, 8.0),
	  .group = "Output", .help = "take N by N samples in every pixel" },
	{ "background", 0, "COLOR", OPTION_TEXT, FOR(RENDER), AT(render.background), .group = "Output",
	  .help =
		  "behind the points: R,G,B or one number, linear, 0 to 1; none leaves it transparent" },
	{ "exposure", 0, "EV", OPTION_REAL, FOR(RENDER | PAGE), OFTEN(RENDER), AT(exposure),
	  RANGE(-100.0, 100.0), AUTOMATIC(NAN), .group = "Output",
	  .help = "as a camera's exposure value at ISO 100: a larger one is darker; auto meters what "
			  "is in view" },
	{ "tone", 0, NULL, OPTION_CHOICE, FOR(RENDER | PAGE), AT(render.tone), .choice = tone_name,
	  .group = "Output", .help = "how light is fitted into the range of a screen" },
	{ "false-colour", 0, NULL, OPTION_FLAG, FOR(RENDER), OFTEN(RENDER), AT(render.false_color),
	  .group = "Output", .help = "show the luminance by colours, with a scale" },
	{ "row", 0, NULL, OPTION_FLAG, FOR(RENDER), OFTEN(RENDER), AT(render.row), .group = "Output",
	  .help = "show each input by itself, side by side in one picture, by one camera, one exposure "
			  "and one scale, to compare set-ups of lamps" },
	{ "scale", 0, "LOW,HIGH", OPTION_TEXT, FOR(RENDER), AT(render.scale), .group = "Output",
	  .help = "values that the darkest and the lightest colour stand for, the same in every "
			  "picture, where colours are numbers; LOW,HIGH,log has powers of ten alike. Without "
			  "it they are fitted to each picture" },
	{ "isolux", 0, "LIST", OPTION_TEXT, FOR(RENDER), AT(render.isolux), .group = "Output",
	  .help = "draw lines where the illuminance has these values, such as 50,100,200 (lx), for "
			  "--view illuminance" },
	{ "camera", 'c', "CAMERA", OPTION_TEXT, FOR(RENDER), OFTEN(RENDER), AT(render.camera),
	  .group = "Camera",
	  .help = "'at X,Y,Z to X,Y,Z fov DEGREES': where it stands, where it looks, and its vertical "
			  "angle of view; or auto, inside or outside, which choose a place" },
	{ "camera", 'c', "CAMERA", OPTION_CAMERA, FOR(PAGE), OFTEN(PAGE), .group = "Camera",
	  .help = "'NAME: at X,Y,Z to X,Y,Z fov DEGREES', or the same without a name: a button that "
			  "shows the cloud from there, beside that of the camera that is chosen "
			  "automatically; or auto, inside or outside. May be given many times" },
	{ "orbit", 0, "N", OPTION_COUNT, FOR(RENDER), OFTEN(RENDER), AT(render.orbit),
	  RANGE(1.0, 10000.0), .group = "Camera",
	  .help = "make N pictures all around what the camera looks at; a camera that was placed "
			  "inside automatically turns on the spot" },
	{ "path", 0, "FILE", OPTION_TEXT, FOR(RENDER), AT(render.path), .group = "Camera",
	  .help = "make a picture for every line of a text file; a line is what --camera takes" },
	{ "mesh", 0, "FILE", OPTION_TEXT, FOR(RENDER), OFTEN(RENDER), AT(render.mesh), .group = "Scene",
	  .help = "draw the triangles of a mesh, or of all meshes of a scene file, in the light of the "
			  "points on them, and not these points" },
	{ "box", 0, "BOX", OPTION_TEXT, FOR(MEASURE), AT(measure_box), .group = "Where",
	  .help = "'X,Y,Z,X,Y,Z': measure what lies between two opposite corners, metres" },
	{ "path", 0, "PLACES", OPTION_TEXT, FOR(MEASURE), AT(measure_path), .group = "Where",
	  .help = "'X,Y,Z X,Y,Z ...': measure what lies near the straight ways between these places" },
	{ "reach", 0, "X", OPTION_REAL, FOR(MEASURE), AT(measure_reach), RANGE(0.0, 1e9),
	  .group = "Where", .help = "how near, metres" },
	{ "cull", 0, NULL, OPTION_FLAG, FOR(RENDER), AT(render.cull), .group = "Camera",
	  .help = "leave out what is seen from behind, to look into a cave from outside" },
	{ "view", 0, "VIEW", OPTION_VIEW, FOR(RENDER), OFTEN(RENDER), AT(render.view),
	  .choice = view_name, .group = "Camera",
	  .help = "what to show; auto is the radiance of a lit cloud, else its albedo in the light of "
			  "a lamp at the camera" },

	{ "glossy", 0, NULL, OPTION_CHOICE, FOR(RENDER), AT(render.glossy), .choice = glossy_name,
	  .group = "Light",
	  .help = "how glossy points (column specular) of a lit cloud reflect what is around them: by "
			  "rays; by one cone a pixel, free of noise but blurred and leaky; by radiance caches "
			  "that rough pixels share, many times as quick (roughness 0.3 and above; the rest by "
			  "rays); by the maps of placed probes, as an engine would that has those which "
			  "`glowworm probes` writes; or not" },
	{ "effects", 0, "LIST", OPTION_EFFECTS, FOR(RENDER), AT(render.effects),
	  .choice = picture_effect_name, .group = "Picture",
	  .help = "-gloss shows glossy points by the light that a bake gave them, as `--glossy off` "
			  "does; +gloss shows their gloss although a scene file forbids it" },
	{ "glossy-rays", 0, "N", OPTION_COUNT, FOR(RENDER), AT(render.glossy_rays), RANGE(1.0, 1024.0),
	  .group = "Light",
	  .help = "rays a pixel that shows a rough glossy point; a mirror takes one" },
	{ "radiance", 0, NULL, OPTION_CHOICE, FOR(RENDER), AT(render.radiance), .choice = radiance_name,
	  .group = "Light",
	  .help = "where light is read: at the points, or from the octree's voxels by linear or cubic "
			  "sampling" },

	{ "light", 'l', "LIGHT", OPTION_LIGHT, FOR(BAKE | PLAN | TRADEOFF | RENDER | ALBEDO | PROBES),
	  OFTEN(BAKE | PLAN | TRADEOFF | ALBEDO | PROBES), .group = "Scene",
	  .help = "add a light: its type, then pairs of key and value; may be given many times" },
	{ "scanner", 0, "X,Y,Z|@FILE|none", OPTION_SCANNER,
	  FOR(BAKE | PLAN | TRADEOFF | RENDER | ALBEDO | PROBES), OFTEN(BAKE | ALBEDO),
	  .group = "Scene",
	  .help =
		  "where a scanner stood, in metres, whatever the inputs say: normals that are missing "
		  "face it where it saw the point. May be given many times; @FILE holds one place a "
		  "line. Where neither the inputs nor this option say, the place is taken from which the "
		  "points lie as densely as one scanner's beams do, if there is one; none takes none" },
	{ "capture", 0, NULL, OPTION_CHOICE, FOR(ALBEDO), OFTEN(ALBEDO), AT(capture),
	  .choice = capture_name, .group = "Scene",
	  .help = "in what light the photographs were taken: that of --light, a flash at the scanner, "
			  "an overcast sky; intensity takes the level from the laser and only the chroma from "
			  "the photographs. auto is --light where that is given, else the laser's intensity" },
	{ "capture-scale", 0, "X", OPTION_REAL, FOR(ALBEDO), AT(capture_scale), RANGE(0.0, 1e9),
	  .open = true, AUTOMATIC(0.0), .group = "Scene",
	  .help = "colour, linear and up to 1, that radiance 1 has in the photographs; auto finds it: "
			  "the brightest surfaces then have an albedo of 0.8" },
	{ "remainder", 0, NULL, OPTION_CHOICE, FOR(ALBEDO), OFTEN(ALBEDO), AT(remainder),
	  .choice = remainder_name, .group = "Scene",
	  .help = "what still varies smoothly along a surface when the light of the capture is divided "
			  "out: albedo leaves it in the albedo; light takes it for light that nobody named and "
			  "divides it out too, and with it what paint and stone vary slowly; edges and "
			  "patterns stay" },
	{ "normals", 0, NULL, OPTION_CHOICE, FOR(BAKE | PLAN | TRADEOFF | RENDER | ALBEDO | PROBES),
	  .scene = true, AT(bake.normals), .choice = normals_name, .group = "Scene",
	  .help = "given takes the inputs' normals as they are, estimate none of them; auto takes "
			  "them unless many cannot be right: mixed signs, normals that are not perpendicular "
			  "to the surface, a closed body inside out" },
	{ "transport", 0, "FILE", OPTION_TEXT, QUIETLY, FOR(BAKE | PROBES), AT(transport),
	  .group = "Scene",
	  .help = "begin with what --save-transport kept of an earlier run for the same points; "
			  "lights, emission, shadows and bounces may be others" },
	{ "albedo", 0, NULL, OPTION_ALBEDO, FOR(BAKE | PLAN | TRADEOFF | RENDER | PROBES), OFTEN(BAKE),
	  .scene = true, .group = "Scene", .help = "where the diffuse reflectance comes from" },
	{ "albedo-scale", 0, "X", OPTION_REAL, FOR(BAKE | PLAN | TRADEOFF | PROBES), .scene = true,
	  AT(points.scale), RANGE(0.0, 1000.0), .group = "Scene",
	  .help = "multiply every albedo by this" },
	{ "albedo-white", 0, "X", OPTION_REAL, FOR(BAKE | PLAN | TRADEOFF | PROBES), .scene = true,
	  AT(points.white), RANGE(0.0, 1.0), .group = "Scene",
	  .help = "blend every albedo towards white: rho + X (1 - rho)" },
	{ "opacity", 0, "SHARE", OPTION_REAL, FOR(BAKE | PLAN | TRADEOFF | RENDER | ALBEDO | PROBES),
	  .scene = true, AT(opacity), RANGE(0.0, 1.0), AUTOMATIC(-1.0), .group = "Scene",
	  .help = "share of each point's piece of surface that is covered: the rest lets light "
			  "through; auto takes the columns opacity or alpha" },
	{ "input-gamma", 0, NULL, OPTION_CHOICE, FOR(BAKE | PLAN | TRADEOFF | RENDER | ALBEDO | PROBES),
	  .scene = true, AT(gamma), .choice = gamma_name, .group = "Scene",
	  .help = "how the input's colours are encoded" },
	{ "up", 0, NULL, OPTION_CHOICE,
	  FOR(BAKE | PLAN | INFO | TRADEOFF | RENDER | ALBEDO | PROBES | PAGE), OFTEN(BAKE | RENDER),
	  .scene = true, AT(up), .choice = up_name, .group = "Scene",
	  .help =
		  "which axis points up, for suns with azimuth and elevation, for floor and cameras; -y is "
		  "that "
		  "of a depth camera's own frame; auto asks the format and, where that does not say, takes "
		  "z, or y if the points stand on it" },
	{ "units", 0, NULL, OPTION_CHOICE,
	  FOR(BAKE | PLAN | INFO | TRADEOFF | RENDER | ALBEDO | PROBES | PAGE), OFTEN(BAKE | ALBEDO),
	  .scene = true, AT(length), .choice = length_name, .group = "Scene",
	  .help =
		  "what the coordinates are in, and with them the places of lamps and cameras; auto "
		  "asks the file (WKT or GeoTIFF keys of LAS), else it is metres. All other lengths are "
		  "metres, and what is written keeps the coordinates" },
	{ "strays", 0, NULL, OPTION_CHOICE, FOR(BAKE | PLAN | TRADEOFF | RENDER | PROBES),
	  .scene = true, AT(strays), .choice = strays_name, .group = "Scene",
	  .help = "points of no surface, such as those far from all others or that a LAS file calls "
			  "noise: light lights them like the nearest surface, of which they are no part; keep "
			  "takes them for surface; drop also leaves them out of the result" },
	{ "format", 0, NULL, OPTION_TEXT,
	  FOR(BAKE | PLAN | INFO | COMPARE | TRADEOFF | MIX | CONVERT | RENDER | ALBEDO | PROBES |
		  PAGE),
	  OFTEN(CONVERT), AT(format), .choice = format_read_name, .group = "Scene",
	  .help = "read the inputs as this format, whatever they look like" },
	{ "columns", 0, "LIST", OPTION_TEXT,
	  FOR(BAKE | PLAN | INFO | COMPARE | TRADEOFF | MIX | CONVERT | RENDER | ALBEDO | PROBES |
		  PAGE),
	  OFTEN(CONVERT), AT(columns), .group = "Scene",
	  .help = "names for the columns of inputs that are tables of text, with commas between them, "
			  "x, y and z among them; - leaves one out" },

	{ "density", 0, "X", OPTION_REAL, FOR(BAKE | PLAN | SAMPLE | TRADEOFF | PROBES), OFTEN(SAMPLE),
	  .scene = true, AT(density), RANGE(0.0, 1e12), .open = true, AUTOMATIC(0.0), .group = "Scene",
	  .help = "points on a square metre of a mesh; auto is the median of the largest cloud among "
			  "the inputs, or what --count comes to when there is none" },
	{ "count", 0, "N", OPTION_COUNT, FOR(BAKE | PLAN | SAMPLE | TRADEOFF), OFTEN(SAMPLE),
	  .scene = true, AT(count), RANGE(1.0, 4e9), .group = "Scene",
	  .help = "points on all meshes together, when nothing says their density" },

	{ "region", 0, "REGION", OPTION_TEXT, FOR(BAKE), OFTEN(BAKE), .scene = true, AT(region),
	  .group = "Light",
	  .help = "light only a part of the scene and write its points alone: 'box X,Y,Z X,Y,Z', what "
			  "lies between two opposite corners, or 'camera at X,Y,Z to X,Y,Z fov DEGREES', what "
			  "that sees in a picture of 16:9. Only what its light depends on is computed, and the "
			  "estimated error is that of the region" },
	{ "method", 'm', NULL, OPTION_CHOICE, FOR(BAKE | PLAN | ALBEDO | PROBES), .scene = true,
	  AT(bake.method), .choice = method_name, .group = "Light",
	  .help = "how light between surfaces is gathered" },
	{ "basis", 0, NULL, OPTION_CHOICE, FOR(BAKE | PLAN | ALBEDO | PROBES), .scene = true,
	  AT(bake.basis), .choice = basis_name, .group = "Light",
	  .help =
		  "what is kept where light is gathered: how much there is, or also from where it comes, "
		  "by which points read it with their own normals; auto does so where these differ, as "
		  "on rough rock" },
	{ "quality", 0, NULL, OPTION_CHOICE, FOR(BAKE | PLAN | ALBEDO | PROBES),
	  OFTEN(BAKE | PLAN | PROBES), .scene = true, AT(quality), .choice = quality_name,
	  .group = "Light",
	  .help = "values for --record-spacing, --least-records, --rays, --light-samples, --cones and "
			  "--leaf-spacing that go together; those that are given by themselves win" },
	{ "max-error", 'e', "X", OPTION_REAL, FOR(BAKE | PLAN | TRADEOFF), OFTEN(BAKE | PLAN),
	  .scene = true, AT(bake.max_error), RANGE(0.0, 1.0), .open = true, .automatic = "none",
	  .automatic_value = 0.0, .group = "Light",
	  .help =
		  "refine until the estimated error is at most this, 0.05 being 5 % of the mean "
		  "radiance; starts from --quality or, when that is not given, from few records, and in "
		  "large clouds from few --surface-points" },
	{ "time", 't', "S", OPTION_REAL, FOR(BAKE | PLAN), .scene = true, AT(bake.time_limit),
	  RANGE(0.0, 1e9), .open = true, .automatic = "none", .automatic_value = 0.0, .group = "Light",
	  .help = "refine as long as reading and baking are done in so many seconds; the "
			  "result then depends on the machine" },
	{ "shadows", 0, NULL, OPTION_CHOICE, FOR(BAKE | PLAN | TRADEOFF | RENDER | ALBEDO | PROBES),
	  .scene = true, AT(bake.shadows), .choice = shadows_name, .group = "Light",
	  .help = "how lights are hidden by surfaces" },
	{ "effects", 0, "LIST", OPTION_EFFECTS, FOR(BAKE | PLAN), OFTEN(PLAN), .scene = true,
	  AT(effects), .choice = settings_effect_name, .group = "Light",
	  .help =
		  "which effects are computed, with commas between them: auto is those that the scene "
		  "calls for, as `glowworm plan` tells; all is every one that leaves the light as it is; "
		  "names alone are those and none else that is of light; +NAME forces one, -NAME "
		  "forbids one. Of light are lamps, shadows, emitters, sky, portals, bounces, gaps, "
		  "error and octree; of the surface transmission, normals (+ estimates all, - takes "
		  "the given ones), noise and gloss (- takes glossy points for matt ones); columns are "
		  "those of `--fields lights`; -motion leaves everything where it is without its path" },
	{ "gaps", 0, NULL, OPTION_CHOICE, FOR(BAKE | PLAN | PROBES), OFTEN(BAKE), .scene = true,
	  AT(bake.gaps), .choice = gaps_name, .group = "Light",
	  .help = "what gathered light finds where no scanner looked, because something stood in front "
			  "of it: the sky, nothing, or as much as from all around. Where no scanner is known, "
			  "holes of surfaces are gaps" },
	{ "gap-radiance", 0, "X", OPTION_REAL, FOR(BAKE | PLAN | PROBES), .scene = true,
	  AT(bake.gap_radiance), RANGE(0.0, 1e30), .group = "Light",
	  .help = "radiance that gaps send with --gaps black, instead of none" },
	{ "depth", 'd', "N", OPTION_COUNT, FOR(BAKE | PLAN | TRADEOFF | RENDER | ALBEDO | PROBES),
	  .scene = true, AT(bake.depth), RANGE(1.0, GW_DEPTH_MAX), AUTOMATIC(GW_DEPTH_AUTO),
	  .group = "Light",
	  .help = "of the octree, 2^N cells a side; auto follows the spacing of the points" },
	{ "leaf-spacing", 0, "X", OPTION_REAL, FOR(BAKE | PLAN | RENDER | ALBEDO | PROBES),
	  .scene = true, AT(bake.leaf_spacing), RANGE(0.25, 64.0), AUTOMATIC(GW_LEAF_SPACING_AUTO),
	  .group = "Light",
	  .help = "width of the octree's cells in spacings of the points, for --depth auto; narrower "
			  "ones see finer shapes and need more memory. auto is 1.25, and for rays wider by the "
			  "fourth root of how many times more than 250,000 points there are" },
	{ "bounces", 'b', "N", OPTION_COUNT, FOR(BAKE | PLAN | TRADEOFF | ALBEDO | PROBES),
	  .scene = true, AT(bake.bounces), RANGE(0.0, 10000.0), AUTOMATIC(GW_BOUNCES_AUTO),
	  .group = "Light",
	  .help = "how often light is reflected: 0 leaves emission alone, 1 is direct light; auto "
			  "goes on until the rest is below the tolerance" },
	{ "tolerance", 0, "X", OPTION_REAL, FOR(BAKE | PLAN | TRADEOFF | ALBEDO | PROBES),
	  .scene = true, AT(bake.tolerance), RANGE(0.0, 1.0), .open = true, .group = "Light",
	  .help = "share of the light that --bounces auto may leave out; at most a quarter of "
			  "--max-error" },
	{ "rays", 0, "N", OPTION_COUNT, FOR(BAKE | PLAN | ALBEDO | PROBES), .scene = true,
	  AT(bake.rays), RANGE(1.0, 4096.0), .group = "Light",
	  .help = "gather rays a record, for --method rays, probes and buffers; "
			  "a cell, for --method volume" },
	{ "light-samples", 0, "N", OPTION_COUNT, FOR(BAKE | PLAN | ALBEDO | PROBES), .scene = true,
	  AT(bake.light_samples), RANGE(1.0, 4096.0), .group = "Light",
	  .help = "samples of the points that emit light, a record" },
	{ "cones", 0, "N", OPTION_COUNT, FOR(BAKE | PLAN | ALBEDO | PROBES), .scene = true,
	  AT(bake.cones), RANGE(1.0, 256.0), .group = "Light",
	  .help = "gather cones a record, for --method cones" },
	{ "volume-cells", 0, "N", OPTION_COUNT, FOR(BAKE | PLAN | ALBEDO | PROBES), .scene = true,
	  AT(bake.volume_cells), RANGE(2.0, 512.0), AUTOMATIC(0.0), .group = "Light",
	  .help =
		  "cells along the longest side of the scene, for --method volume and lpv, and --vdb-sh; "
		  "auto is 16 for lpv, which finer ones make worse, and else 64" },
	{ "volume-sh", 0, "N", OPTION_COUNT, FOR(BAKE | PLAN | ALBEDO | PROBES), .scene = true,
	  AT(bake.volume_harmonics), RANGE(4.0, 9.0), .group = "Light",
	  .help = "spherical harmonics that each of these cells keeps of its light: 4 or 9, by which "
			  "--method volume is less wrong in about as much time" },
	{ "probe-size", 0, "N", OPTION_COUNT, FOR(BAKE | PLAN | RENDER | ALBEDO | PROBES),
	  .scene = true, AT(bake.probe_size), RANGE(GW_PROBE_SIZE_LEAST, GW_PROBE_SIZE_MOST),
	  .group = "Light",
	  .help = "texels a side of a probe's maps, a power of two, for --method probes and --glossy "
			  "probes" },
	{ "record-spacing", 0, "X", OPTION_REAL, FOR(BAKE | PLAN | RENDER | ALBEDO | PROBES),
	  .scene = true, AT(bake.record_spacing), RANGE(0.0, 64.0), .group = "Light",
	  .help = "leaf cells between records; 0 puts one on every surface of every leaf" },
	{ "least-records", 0, "N", OPTION_COUNT, FOR(BAKE | PLAN | RENDER | ALBEDO | PROBES),
	  .scene = true, AT(bake.least_records), RANGE(0.0, 1e9), .group = "Light",
	  .help =
		  "records of which a small cloud has at least so many: they stand closer than "
		  "--record-spacing where that leaves fewer, unless that is given by itself; up to four "
		  "times as many where surface is white" },
	{ "most-records", 0, "N", OPTION_COUNT, FOR(BAKE | PLAN | ALBEDO | PROBES), .scene = true,
	  AT(bake.most_records), RANGE(0.0, 1e9), .group = "Light",
	  .help = "records with which a large cloud begins at most, farther apart than "
			  "--record-spacing: more are put where they disagree, until --gathered-error is "
			  "reached; 0, or a --record-spacing that is given by itself, places all at once" },
	{ "gathered-error", 0, "X", OPTION_REAL, FOR(BAKE | PLAN | ALBEDO | PROBES), .scene = true,
	  AT(bake.gathered_error), RANGE(0.0, 1.0), .group = "Light",
	  .help = "error of gathered light, relative to the mean, that is small enough where "
			  "--most-records left some out" },
	{ "shadow-map-size", 0, "N", OPTION_COUNT, FOR(BAKE | PLAN | TRADEOFF | PROBES), .scene = true,
	  AT(bake.shadow_map_size), RANGE(16.0, 8192.0), .group = "Light",
	  .help = "texels a side of a shadow map, for --shadows maps" },
	{ "estimate-points", 0, "N", OPTION_COUNT, FOR(BAKE | PLAN | TRADEOFF), .scene = true,
	  AT(bake.estimate_points), RANGE(0.0, 1e6), .group = "Light",
	  .help = "points that are solved again, to say how wrong the result is; where records are "
			  "many, one for 20 of them, up to four times as many; 0 leaves it out" },
	{ "seed", 0, "N", OPTION_SEED, FOR(BAKE | PLAN | SAMPLE | TRADEOFF | ALBEDO | PROBES),
	  .scene = true, AT(bake.seed), .group = "Light", .help = "of all random numbers" },

	{ "frames", 0, "RANGE", OPTION_TEXT, QUIETLY, FOR(BAKE | PLAN), AT(frames), .group = "Frames",
	  .help = "bake these frames of a scene in which inputs or lamps move: all, 7, or 10..20. Each "
			  "gets a file of its own: FILE-0007.ply, or the number where FILE has %04d. Without "
			  "this, frame 0 is baked" },
	{ "independent", 0, NULL, OPTION_FLAG, FOR(BAKE | PLAN), AT(independent), .group = "Frames",
	  .help = "let no frame begin with the light of the one before: slower, but the same bytes "
			  "whichever frames are asked for" },

	{ "threads", 'j', "N", OPTION_COUNT, QUIETLY,
	  FOR(BAKE | PLAN | SAMPLE | INFO | COMPARE | TRADEOFF | MIX | CONVERT | RENDER | PAGE |
		  DOCTOR | ALBEDO | PROBES),
	  .scene = true, AT(bake.threads), RANGE(1.0, 256.0), AUTOMATIC(0.0), .group = "Machine",
	  .help = "that work; auto is one a core. The result is the same for any number" },
	{ "memory", 0, "SIZE", OPTION_SIZE, QUIETLY,
	  FOR(BAKE | PLAN | TRADEOFF | RENDER | MEASURE | PAGE | DOCTOR | ALBEDO | PROBES),
	  OFTEN(BAKE | PLAN), .scene = true, AT(bake.memory), AUTOMATIC(0.0), .group = "Machine",
	  .help = "bytes that a bake may use, with K, M, G or T behind the number; auto is most of "
			  "what is free. Where they do not hold all points, as many make the surface as "
			  "fit; of clouds from files, baked to PLY, LAS, LAZ, E57 or PCD, the others are never "
			  "all in memory; pictures, measures and probes are of as many as fit" },
	{ "surface-points", 0, "N", OPTION_COUNT, FOR(BAKE | PLAN), .scene = true,
	  AT(bake.surface_points), RANGE(1.0, 1e9), AUTOMATIC(0.0), .group = "Machine",
	  .help = "points that the surface is made of at most, thinned most where they are densest; "
			  "the others are lit by it, each with its own albedo and normal. A surface of fewer "
			  "takes less time and memory, and the estimated error says what it loses; auto is "
			  "all, or as many as --memory holds" },
	{ "tiles", 0, "N", OPTION_COUNT, FOR(BAKE), .scene = true, AT(tiles), RANGE(1.0, 1e6),
	  .automatic = "none", .automatic_value = 0.0, .group = "Machine",
	  .help = "of a cloud that memory does not hold, light all points by surfaces of all of them, "
			  "place by place, where otherwise as many as memory holds make the surface: nearer to "
			  "the light of all at once, in several times its time. So many tiles at least; more "
			  "where --memory asks for them. Of clouds from files, to PLY, LAS, LAZ, E57 or PCD" },
	{ "device", 0, "NAME", OPTION_TEXT,
	  FOR(BAKE | PLAN | TRADEOFF | RENDER | DOCTOR | ALBEDO | PROBES), .scene = true,
	  AT(bake.device), .group = "Machine",
	  .help = "Vulkan device: its number, its type, or part of its name, as `glowworm info "
			  "--devices` lists them" },

	{ "rebuild", 0, NULL, OPTION_FLAG, FOR(BAKE | PLAN), AT(rebuild), .group = "For developers",
	  .help = "bake every frame from scratch, to check and to compare" },
	{ "validate", 0, NULL, OPTION_CHOICE, QUIETLY, FOR(BAKE | PLAN | TRADEOFF | RENDER | PROBES),
	  AT(bake.validate), .choice = validation_name, .group = "For developers",
	  .help = "run under Vulkan's validation layer; any message is an error. calls looks at "
			  "each call and at what has to wait for what; accesses at each access of shaders to "
			  "memory" },
	{ "passes", 0, NULL, OPTION_CHOICE, FOR(BAKE | PLAN | TRADEOFF | RENDER | PROBES),
	  .scene = true, AT(bake.passes), .choice = passes_name, .group = "For developers",
	  .help = "by what the light is computed: device is shaders alone, as on a GPU; cpu is loops "
			  "of the processor where there are some, which takes the software driver; auto is "
			  "whatever is quicker. The light is the same but for roundings" },

	{ "devices", 0, NULL, OPTION_FLAG, QUIETLY, FOR(INFO), AT(devices), .group = "Messages",
	  .help = "list the Vulkan devices instead of files" },
	{ "stats", 0, NULL, OPTION_FLAG, QUIETLY, FOR(INFO), AT(stats), .group = "Messages",
	  .help = "also say what all points and their neighbours have to be looked at for: spacing, "
			  "density, duplicates, strays, ranges of all columns, the mean albedo, the depth and "
			  "memory of a bake, where the scanner seems to have stood" },
	{ "places", 0, NULL, OPTION_FLAG, QUIETLY, FOR(INFO), AT(places), .group = "Messages",
	  .help = "list the places that lamps can be at by name: scanners, and floor that is free to "
			  "head height, the most open first. They are those of a scene with this one input" },
	{ "json", 0, NULL, OPTION_FLAG, QUIETLY, FOR(INFO), AT(json), .group = "Messages",
	  .help = "print JSON, one object a line" },
	{ "json", 0, NULL, OPTION_FLAG, QUIETLY, FOR(DOCTOR | PLAN | LAMP | MEASURE | METHODS),
	  OFTEN(PLAN), AT(json), .group = "Messages", .help = "print JSON" },
	{ "progress", 0, NULL, OPTION_CHOICE, QUIETLY,
	  FOR(BAKE | PLAN | TRADEOFF | RENDER | PROBES | PAGE), AT(progress), .choice = progress_name,
	  .group = "Messages",
	  .help = "auto shows it on a terminal; json writes one object a line to standard error" },
	{ "explain", 0, NULL, OPTION_FLAG, QUIETLY, FOR(BAKE), AT(explain), .group = "Messages",
	  .help = "say which effects the scene calls for, why, and what the bake will take; and in the "
			  "end what it took. Foretelling takes a while of its own" },
	{ "profile", 0, NULL, OPTION_FLAG, QUIETLY, FOR(BAKE | RENDER), AT(profile),
	  .group = "Messages",
	  .help =
		  "show time and memory of each stage, and the rows of Salm's thesis, where shadows are "
		  "all of direct light" },
	{ "print-scene", 0, NULL, OPTION_FLAG, QUIETLY, FOR(BAKE), AT(print_scene), .group = "Messages",
	  .help = "print the scene with all values in effect, as a scene file, and stop" },
	{ "quiet", 'q', NULL, OPTION_FLAG, QUIETLY,
	  FOR(BAKE | PLAN | SAMPLE | TRADEOFF | MIX | CONVERT | RENDER | ALBEDO | PROBES | PAGE),
	  AT(quiet), .group = "Messages", .help = "print errors only" },
	{ "verbose", 'v', NULL, OPTION_FLAG, QUIETLY, FOR(BAKE | SAMPLE | RENDER), AT(verbose),
	  .group = "Messages", .help = "say what was read, made and written" },
	{ "help", 'h', NULL, OPTION_FLAG, QUIETLY, FOR(EVERY_VERB), AT(help), .group = "Messages",
	  .help = "print the options that most people need, and stop; --help all prints every one" },
	{ .name = NULL },
};

static_assert(sizeof options / sizeof *options <= SETTINGS_OPTIONS,
			  "settings.given has room for every option");

const option *option_find(verb v, const char *name, size_t length)
{
	for (const option *o = options; o->name; o++)
		if (o->verbs & 1u << v && strlen(o->name) == length && !strncmp(name, o->name, length))
			return o;
	return NULL;
}

bool option_repeats(const option *o)
{
	return o->type == OPTION_LIGHT || o->type == OPTION_GAIN || o->type == OPTION_GROUP ||
		   o->type == OPTION_SETUP || o->type == OPTION_CAMERA || o->type == OPTION_SCANNER;
}

void option_key(const option *o, char key[64])
{
	snprintf(key, 64, "%s", o->name);
	for (char *c = key; *c; c++)
		if (*c == '-')
			*c = '_';
}

const option *option_find_key(const char *key)
{
	char own[64];
	for (const option *o = options; o->name; o++) {
		option_key(o, own);
		if (o->scene && strcmp(own, key) == 0)
			return o;
	}
	return NULL;
}

/* --------------------------------------------------------------------------------- verbs */

const char *verb_name(int v)
{
	static const char *const name[] = { "bake",   "plan",    "info",    "compare",  "mix",
										"sample", "convert", "render",  "tradeoff", "albedo",
										"doctor", "lamp",    "measure", "probes",   "methods",
										"page",   NULL };
	static_assert(sizeof name / sizeof *name == VERB_COUNT + 1, "every verb has a name");
	return name[v];
}

const char *verb_summary(verb v)
{
	static const char *const summary[] = { "light a point cloud",
										   "say what a bake would compute, why, and what it takes",
										   "say what is in a point cloud, or list devices",
										   "say how far one lighting is from another",
										   "change the strength of lamps after a bake",
										   "make a point cloud of a mesh",
										   "write a point cloud in another format",
										   "make pictures of a point cloud",
										   "show what error costs in seconds and memory",
										   "take the light out of photographed colours",
										   "say whether this machine can bake, and what is wrong",
										   "show how a luminaire shines, or list lamps by name",
										   "read the light on a piece of surface",
										   "place radiance probes, and write what they see",
										   "list the ways in which light is gathered",
										   "write a page on which lamps can be dimmed" };
	return summary[v];
}

const char *verb_synopsis(verb v)
{
	static const char *const synopsis[] = {
		"bake INPUT... --light LIGHT... -o OUTPUT [option]...",
		"plan INPUT... --light LIGHT... [option]...",
		"info FILE... [--stats] [--places] [--json] | info --devices [--json]",
		"compare RESULT TRUTH [option]...",
		"mix LIT --gain NAME=FACTOR... -o OUTPUT [option]...",
		"sample MESH -o POINTS [option]...",
		"convert INPUT OUTPUT [option]...",
		"render INPUT... -o PICTURE [option]...",
		"tradeoff INPUT... --light LIGHT... [option]...",
		"albedo SCAN... -o POINTS [option]...",
		"doctor [--device NAME] [--json]",
		"lamp [LUMINAIRE] [-o PICTURE] [--json]",
		"measure LIT [--box BOX] [--path PLACES] [option]...",
		"probes INPUT... --light LIGHT... -o ATLAS [--json FILE] [option]...",
		"methods [--json]",
		"page LIT -o PAGE.html [option]..."
	};
	return synopsis[v];
}

const char *verb_group_name(int group)
{
	static const char *const name[] = { "Light",         "Look at it",      "Points",
										"Before a bake", "How right it is", NULL };
	return name[group];
}

int verb_group(verb v)
{
	static const int group[] = {
		[VERB_BAKE] = 0,     [VERB_PLAN] = 3,   [VERB_INFO] = 2,    [VERB_COMPARE] = 4,
		[VERB_MIX] = 0,      [VERB_SAMPLE] = 2, [VERB_CONVERT] = 2, [VERB_RENDER] = 1,
		[VERB_TRADEOFF] = 4, [VERB_ALBEDO] = 3, [VERB_DOCTOR] = 4,  [VERB_LAMP] = 3,
		[VERB_MEASURE] = 1,  [VERB_PROBES] = 0, [VERB_METHODS] = 4, [VERB_PAGE] = 1
	};
	static_assert(sizeof group / sizeof *group == VERB_COUNT, "every verb has a group");
	return group[v];
}

const char *verb_examples(verb v)
{
	static const char *const examples[] = {
		[VERB_BAKE] = "glowworm bake cave.laz --light 'point at 1,2,1.5 intensity 40' -o lit.ply\n"
					  "glowworm bake ruin.e57 --light 'sun from 135,40 irradiance 3' \\\n"
					  "      --light 'sky radiance 0.4' -o lit.ply\n"
					  "glowworm bake cave.scene.json --max-error 0.03 -o lit.ply\n"
					  "glowworm bake big.laz --light 'sky radiance 1' --memory 8G --resume "
					  "-o lit.ply",
		[VERB_PLAN] = "glowworm plan cave.ply --light 'point at 1,2,1.5 intensity 40'",
		[VERB_INFO] = "glowworm info scan.laz\n"
					  "glowworm info scan.laz --stats\n"
					  "glowworm info --places scan.laz",
		[VERB_COMPARE] = "glowworm compare lit.ply truth.ply --max-relrmse 0.05",
		[VERB_MIX] = "glowworm mix lit.ply --gain torch=0.5 --gain lamp=1,0.8,0.6 -o dimmed.ply",
		[VERB_SAMPLE] = "glowworm sample room.obj --count 1000000 -o room.ply",
		[VERB_CONVERT] = "glowworm convert scan.laz scan.ply\n"
						 "glowworm convert table.txt scan.ply --columns x,y,z,-,intensity",
		[VERB_RENDER] = "glowworm render lit.ply -o lit.png\n"
						"glowworm render lit.ply --camera 'at 1,2,1.5 to 4,2,1 fov 60' -o lit.exr\n"
						"glowworm render lit.ply --view illuminance --isolux 50,100,200 -o lux.png",
		[VERB_TRADEOFF] = "glowworm tradeoff cave.ply --light 'point at 1,2,1.5 intensity 40' "
						  "--svg t.svg",
		[VERB_ALBEDO] = "glowworm albedo scan.laz --capture overcast -o albedo.ply\n"
						"glowworm albedo cave.e57 --capture flash -o albedo.ply",
		[VERB_DOCTOR] = "glowworm doctor",
		[VERB_LAMP] = "glowworm lamp\n"
					  "glowworm lamp lamp.ies -o lamp.png",
		[VERB_MEASURE] = "glowworm measure lit.ply --path '1,2,0 4,2,0' --reach 0.5",
		[VERB_PROBES] =
			"glowworm probes cave.scene.json --count 64 -o atlas.exr --json probes.json",
		[VERB_METHODS] = "glowworm methods",
		[VERB_PAGE] =
			"glowworm page lit.ply -o page.html\n"
			"glowworm page lit.ply --setup 'evening: sky=0.05 lamp=1' --title 'The hall' \\\n"
			"      --camera 'entrance: at 4,0,1.6 to 0,0,1.2 fov 60' -o hall.html"
	};
	static_assert(sizeof examples / sizeof *examples == VERB_COUNT, "every verb has an example");
	return examples[v];
}

/* ------------------------------------------------------------------------------- parsing */

typedef struct parser {
	verb verb;
	int count, next;
	char *const *argument;
	settings *settings;
	FILE *command;
	gw_error *error;
} parser;

static gw_status fail_unknown(const parser *p, const char *word, size_t length)
{
	const char *name[SETTINGS_OPTIONS] = { NULL };
	char hint[NEAREST_NAME_HINT], plain[64], shown[64];
	size_t count = 0;
	for (const option *o = options; o->name; o++)
		if (o->verbs & 1u << p->verb)
			name[count++] = o->name;
	snprintf(shown, sizeof shown, "%.*s", (int)(length < 60 ? length : 60), word);
	snprintf(plain, sizeof plain, "%s", shown + strspn(shown, "-"));
	nearest_name_hint(hint, plain, "--", name, count);
	return gw_fail(p->error, GW_ERROR_USAGE, "'%s' is no option of glowworm %s%s%s", shown,
				   verb_name(p->verb), hint, *hint ? "" : "; --help lists them");
}

/* Quotes what can change the points, so that a lit file says how to make it again. */
static void quote(const parser *p, const option *o, const char *value)
{
	if (o && o->effect == OPTION_LEAVES_POINTS)
		return;
	fputc(' ', p->command);
	if (o)
		fprintf(p->command, "--%s", o->name);
	if (o && value)
		fputc(' ', p->command);
	if (value)
		text_quote(p->command, value);
}

static gw_status apply(const parser *p, const option *o, const char *value)
{
	gw_error reason = { 0 };
	p->settings->given[o - options] = SETTINGS_BY_COMMAND;
	quote(p, o, o->type == OPTION_FLAG ? NULL : value);
	gw_status status = option_set(o, p->settings, value, &reason);
	if (status == GW_OK)
		return GW_OK;
	if (o->type == OPTION_LIGHT)
		return gw_fail(p->error, status, "%s", reason.text);
	return gw_fail(p->error, status, "--%s %.900s", o->name, reason.text);
}

/* The value of an option: what is joined to it, or the next argument. */
static gw_status take(parser *p, const option *o, const char *joined)
{
	if (o->type == OPTION_FLAG && joined)
		return gw_fail(p->error, GW_ERROR_USAGE, "--%s takes no value", o->name);
	if (o->type == OPTION_FLAG)
		return apply(p, o, "");
	if (!joined && p->next == p->count) {
		char argument[OPTION_VALUE];
		option_argument(o, argument);
		return gw_fail(p->error, GW_ERROR_USAGE, "--%s needs a value: --%s %s", o->name, o->name,
					   argument);
	}
	return apply(p, o, joined ? joined : p->argument[p->next++]);
}

static gw_status take_long(parser *p, const char *word)
{
	size_t length = strcspn(word + 2, "=");
	const option *o = option_find(p->verb, word + 2, length);
	if (!o)
		return fail_unknown(p, word, length + 2);
	return take(p, o, word[2 + length] ? word + length + 3 : NULL);
}

/* -fq, -oFILE or -o FILE */
static gw_status take_letters(parser *p, const char *word)
{
	for (const char *c = word + 1; *c; c++) {
		const option *o = options;
		while (o->name && !(o->letter == *c && o->verbs & 1u << p->verb))
			o++;
		if (!o->name)
			return fail_unknown(p, word, strlen(word));
		GW_TRY(take(p, o, o->type != OPTION_FLAG && c[1] ? c + 1 : NULL));
		if (o->type != OPTION_FLAG)
			break;
	}
	return GW_OK;
}

static gw_status take_input(const parser *p, char *word)
{
	if (!*word)
		return gw_fail(p->error, GW_ERROR_USAGE, "an input's name is empty");
	quote(p, NULL, word);
	return settings_add_input(p->settings, &(settings_input){ .path = word }, p->error);
}

static gw_status parse_all(parser *p)
{
	bool names_only = false;
	while (p->next < p->count) {
		char *word = p->argument[p->next++];
		if (names_only || word[0] != '-' || !word[1])
			GW_TRY(take_input(p, word));
		else if (strcmp(word, "--") == 0)
			names_only = true;
		else if (word[1] == '-')
			GW_TRY(take_long(p, word));
		else
			GW_TRY(take_letters(p, word));
	}
	return GW_OK;
}

gw_status options_parse(verb v, int count, char *const *argument, settings *s, gw_error *error)
{
	size_t length;
	FILE *command = open_memstream(&s->command, &length);
	if (!command)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the command line");
	fprintf(command, "glowworm %s", verb_name(v));
	parser p = { v, count, 0, argument, s, command, error };
	gw_status status = parse_all(&p);
	if (fclose(command) != 0 && status == GW_OK)
		status = gw_fail(error, GW_ERROR_MEMORY, "no memory for the command line");
	return status;
}
