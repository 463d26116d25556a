#include "verbs/verbs.h"
#include "glowworm_host.h"
#include "scene/file_roles.h"
#include "scene/stream_roles.h"
#include "files/number_text.h"
#include "pictures/octree_picture.h"
#include "pictures/octree_view.h"
#include "pictures/picture_holes.h"
#include "options/options.h"
#include "options/preview.h"
#include "options/progress.h"
#include "options/quality_preset.h"
#include "pictures/render_cameras.h"
#include "pictures/render_picture.h"
#include "scene/scene_file.h"
#include "program/signals.h"
#include "program/words.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/resource.h>

#define POINTS_RADIUS 0.2f  /* of --view points: discs that do not meet */
#define METERED_PICTURES 32 /* of several ones, which share one exposure */
#define METERED_HEIGHT 120u /* pixels */
#define CAMERA_TRIPLE CAMERA_TEXT_NUMBER "," CAMERA_TEXT_NUMBER "," CAMERA_TEXT_NUMBER
#define CAMERA_PLACE "at " CAMERA_TRIPLE " to " CAMERA_TRIPLE

/* What is told of all inputs together: with --row each is gone when the next one is read. */
typedef struct tally {
	size_t points, in_view, probes;
	double read_seconds, choose_seconds, surface_seconds;
	bool glossy, voxels, cubic, caches;
	double build_seconds, look_seconds; /* of octrees */
	uint64_t pixels;
	gw_cache_seconds cached;
	gw_lost_rays lost;
} tally;

/* All that lives as long as one run. */
typedef struct render {
	settings *settings;
	camera_plan plan;
	render_look look;
	bool exr;
	bool points; /* --view points */
	uint32_t width, height;
	bool placed; /* --row: the camera of the first input stays */
	render_scene scene;
	octree_picture octree;
	octree_view inner; /* --view cells and others that show what lies behind the light */
	tally tally;
	progress progress;
	double read_seconds, meter_seconds, draw_seconds, write_seconds; /* draw: all three */
	double geometry_seconds, shade_seconds; /* of the pictures, without metering: the surface that
											   each pixel shows, and its light */
	uint64_t pixel_bytes;                   /* that hold one picture */
	gw_error *error;
} render;

static bool on_cancelled(void *user)
{
	(void)user;
	return signals_pending() != 0;
}

/* ------------------------------------------------------------------------- before reading */

static gw_status check_size(render *r)
{
	const char *text = r->settings->render.size;
	double side[2];
	size_t length = strlen(text), used = number_read(text, length, &side[0]);
	bool good = used > 0 && (text[used] == 'x' || text[used] == 'X');
	size_t rest = good ? length - used - 1 : 0;
	good = good && rest > 0 && number_read(text + used + 1, rest, &side[1]) == rest;
	for (int k = 0; k < 2 && good; k++)
		good = side[k] >= 1.0 && side[k] <= GW_RASTER_SIZE_MAX && side[k] == floor(side[k]);
	if (!good)
		return gw_fail(r->error, GW_ERROR_USAGE,
					   "--size is '%.80s', but must be WIDTHxHEIGHT in pixels, 1 to %u each", text,
					   GW_RASTER_SIZE_MAX);
	r->width = (uint32_t)side[0];
	r->height = (uint32_t)side[1];
	return GW_OK;
}

static gw_status check_background(render *r)
{
	const char *text = r->settings->render.background;
	render_background *b = &r->look.background;
	double value[3];
	b->transparent = strcmp(text, "none") == 0;
	if (b->transparent)
		return GW_OK;
	size_t count = words_numbers(text, value);
	bool good = count == 1 || count == 3;
	for (size_t k = 0; k < count && good; k++)
		good = value[k] >= 0.0 && value[k] <= 1.0;
	if (!good)
		return gw_fail(r->error, GW_ERROR_USAGE,
					   "--background is '%.80s', but must be R,G,B or one number, 0 to 1, or none",
					   text);
	for (size_t k = 0; k < 3; k++)
		b->rgb[k] = value[count == 3 ? k : 0];
	return GW_OK;
}

/* PNG or EXR, by the name. */
static gw_status check_output(render *r)
{
	const char *path = r->settings->output;
	if (!path)
		return gw_fail(r->error, GW_ERROR_USAGE,
					   "where to write? Give -o PICTURE.png, or -o - for standard output");
	const char *slash = strrchr(path, '/'), *dot = strrchr(slash ? slash : path, '.');
	bool stream = stream_roles_nameless(path);
	r->exr = dot && strcasecmp(dot, ".exr") == 0;
	if (!r->exr && !stream && !(dot && strcasecmp(dot, ".png") == 0))
		return gw_fail(r->error, GW_ERROR_USAGE,
					   "%s: the name must end in .png, or in .exr for all numbers", path);
	if (camera_plan_count(&r->plan) > 1 && stream)
		return gw_fail(r->error, GW_ERROR_USAGE,
					   "%zu pictures need a file name, to which their numbers are added",
					   camera_plan_count(&r->plan));
	GW_TRY(
		stream_roles_check_outputs(&(stream_output){ "--output", path, "this is" }, 1, r->error));
	if (r->exr && r->settings->render.false_color)
		return gw_fail(r->error, GW_ERROR_USAGE,
					   "--false-colour is for the screen, and an EXR holds the numbers themselves; "
					   "write a PNG");
	return GW_OK;
}

static gw_status check_inputs(const render *r)
{
	const settings *s = r->settings;
	if (s->input_count == 0)
		return gw_fail(r->error, GW_ERROR_USAGE,
					   "what to show? Name an input, or - for standard input");
	return stream_roles_check_inputs(s, r->error);
}

/* The name of a picture: FILE.png, or FILE-0001.png when there are several. For free(). */
static char *name_picture(const void *user, size_t picture)
{
	const render *r = user;
	const char *path = r->settings->output;
	char *name = NULL;
	if (camera_plan_count(&r->plan) == 1)
		return strdup(path);
	int stem = (int)(strrchr(path, '.') - path);
	if (asprintf(&name, "%.*s-%04zu%s", stem, path, picture + 1, path + stem) < 0)
		return NULL;
	return name;
}

/* Before reading, it has to be clear that all pictures can be put down. */
static gw_status probe_outputs(const render *r)
{
	gw_status status = GW_OK;
	for (size_t i = 0; i < camera_plan_count(&r->plan) && status == GW_OK; i++) {
		char *name = name_picture(r, i);
		if (!name)
			return gw_fail(r->error, GW_ERROR_MEMORY, "no memory for a name");
		output_file *probe = NULL;
		if (!stream_roles_nameless(name))
			status = output_file_create(&probe, name, r->settings->force, r->error);
		output_file_abandon(&probe);
		free(name);
	}
	return status;
}

static gw_status check_row(const render *r)
{
	const settings *s = r->settings;
	if (!s->render.row)
		return GW_OK;
	if (s->input_count < 2)
		return gw_fail(r->error, GW_ERROR_USAGE,
					   "--row shows inputs side by side, and there is one; name two or more");
	if (camera_plan_count(&r->plan) > 1)
		return gw_fail(r->error, GW_ERROR_USAGE,
					   "--row takes one camera, not %zu: leave out --orbit, or have one line in "
					   "--path",
					   camera_plan_count(&r->plan));
	if (r->exr || s->render.mesh)
		return gw_fail(r->error, GW_ERROR_USAGE, "--row %s",
					   r->exr ? "makes a PNG, because an EXR holds the numbers of one picture"
							  : "shows points, and no --mesh");
	return GW_OK;
}

/* Colours that stand for numbers, and lines. */
static gw_status check_numbers(render *r)
{
	const settings_render *s = &r->settings->render;
	bool colors = s->false_color || render_view_is_number((settings_view)s->view);
	if (r->exr && (s->scale || s->isolux))
		return gw_fail(r->error, GW_ERROR_USAGE,
					   "--%s is for the screen, and an EXR holds the numbers themselves; write a "
					   "PNG",
					   s->scale ? "scale" : "isolux");
	if (s->scale && !colors)
		return gw_fail(r->error, GW_ERROR_USAGE,
					   "--scale is for colours that stand for numbers: --view illuminance, or "
					   "--false-colour with another view");
	if (s->isolux && s->view != SETTINGS_VIEW_ILLUMINANCE)
		return gw_fail(r->error, GW_ERROR_USAGE, "--isolux needs --view illuminance");
	r->look.scaled = s->scale != NULL;
	if (s->scale)
		GW_TRY(false_color_read(s->scale, &r->look.scale, r->error));
	return s->isolux ? isolux_read(s->isolux, &r->look.lines, r->error) : GW_OK;
}

static gw_status check_gloss(const render *r)
{
	bool forced = r->settings->render.effects.forced & 1u << SETTINGS_EFFECT_GLOSS;
	if (forced && r->settings->render.glossy == SETTINGS_GLOSSY_OFF)
		return gw_fail(r->error, GW_ERROR_USAGE,
					   "the effect 'gloss' is forced, but --glossy off forbids it");
	return GW_OK;
}

static gw_status check(render *r)
{
	GW_TRY(check_gloss(r));
	GW_TRY(check_inputs(r));
	GW_TRY(check_size(r));
	GW_TRY(check_background(r));
	GW_TRY(camera_plan_read(r->settings, &r->plan, r->error));
	GW_TRY(octree_view_check(r->settings, &r->inner, r->error));
	GW_TRY(check_output(r));
	GW_TRY(check_numbers(r));
	GW_TRY(check_row(r));
	const file_series pictures = { camera_plan_count(&r->plan), name_picture, r };
	GW_TRY(file_roles_check(VERB_RENDER, r->settings, &pictures, r->error));
	return probe_outputs(r);
}

/* -------------------------------------------------------------------------------- reading */

/* What a view cannot do without. */
static uint32_t needed_channels(settings_view view)
{
	return view == SETTINGS_VIEW_VOXELS ? 1u << RENDER_RADIANCE : render_view_channels(view);
}

static gw_status fail_channel(const render *r, render_channel channel)
{
	if (channel == RENDER_RADIANCE)
		return gw_fail(r->error, GW_ERROR_DATA,
					   "there is no baked light in the input; light it with glowworm bake");
	if (channel == RENDER_ERROR)
		return gw_fail(r->error, GW_ERROR_DATA,
					   "there is no column error in the input; glowworm compare writes clouds that "
					   "have one with --worst");
	if (channel == RENDER_UNKNOWN)
		return gw_fail(r->error, GW_ERROR_DATA,
					   "there is no column unknown in the input; bake it with --fields unknown");
	if (channel == RENDER_IRRADIANCE)
		return gw_fail(r->error, GW_ERROR_DATA,
					   "there is no irradiance in the input; bake it with --fields irradiance");
	if (channel == RENDER_ILLUMINANCE && r->scene.offset[RENDER_RADIANCE] >= 0 &&
		!r->scene.photometric)
		return gw_fail(
			r->error, GW_ERROR_DATA,
			"the light in the input is not in lx: its lamps were in watts, or in no unit; "
			"say cd, lm or lx behind their numbers, or look at --view irradiance");
	if (channel == RENDER_ILLUMINANCE)
		return gw_fail(r->error, GW_ERROR_DATA,
					   "there is no illuminance in the input; bake it with --fields illuminance");
	return gw_fail(r->error, GW_ERROR_DATA,
				   "there is no %s light in the input; bake it with --fields direct,indirect",
				   render_channel_name(channel));
}

/* What a view needs, or everything for an EXR. Which of the two an automatic one will be is not
 * known yet. */
static uint32_t wanted_channels(const render *r)
{
	settings_view view = (settings_view)r->settings->render.view;
	uint32_t shadow = view == SETTINGS_VIEW_SHADOW ? 0u : 1u << RENDER_SHADOW;
	if (r->exr)
		return ((1u << RENDER_CHANNEL_COUNT) - 1u) & ~shadow;
	if (view == SETTINGS_VIEW_AUTO || view == SETTINGS_VIEW_POINTS)
		return 1u << RENDER_ALBEDO | 1u << RENDER_RADIANCE | 1u << RENDER_EMISSION |
			   octree_picture_channels(r->settings);
	if (view == SETTINGS_VIEW_RADIANCE)
		return 1u << RENDER_RADIANCE | 1u << RENDER_EMISSION | octree_picture_channels(r->settings);
	if (view == SETTINGS_VIEW_ILLUMINANCE) /* a lit cloud without it is told why */
		return needed_channels(view) | 1u << RENDER_RADIANCE;
	return needed_channels(view);
}

static gw_status choose_view(render *r)
{
	settings_view view = (settings_view)r->settings->render.view;
	r->points = view == SETTINGS_VIEW_POINTS;
	bool lit = r->scene.offset[RENDER_RADIANCE] >= 0;
	if (view == SETTINGS_VIEW_AUTO || view == SETTINGS_VIEW_POINTS)
		view = lit ? SETTINGS_VIEW_RADIANCE : SETTINGS_VIEW_SHADED;
	r->look.view = view;
	if (r->settings->render.radiance != SETTINGS_RADIANCE_POINTS && !lit)
		view = SETTINGS_VIEW_RADIANCE; /* which is missing */
	for (int c = 0; c < RENDER_CHANNEL_COUNT; c++)
		if (needed_channels(view) & 1u << c && r->scene.offset[c] < 0)
			return fail_channel(r, (render_channel)c);
	return GW_OK;
}

static render_octree needs_octree(const render *r)
{
	settings_view view = (settings_view)r->settings->render.view;
	if (octree_view_needs_octree(view) || r->settings->render.radiance != SETTINGS_RADIANCE_POINTS)
		return RENDER_OCTREE_YES;
	return octree_picture_channels(r->settings) ? RENDER_OCTREE_GLOSSY : RENDER_OCTREE_NO;
}

/* Only what is in some picture needs a surface. */
static gw_status choose_points(void *user, const render_scene *scene, const gw_surfels *surfels,
							   uint8_t *chosen, gw_error *error)
{
	render *r = user;
	double aspect = (double)r->width / (double)r->height;
	if (!r->placed)
		GW_TRY(camera_plan_place(&r->plan, scene, surfels, aspect, error));
	r->placed = r->settings->render.row;
	return camera_plan_choose(&r->plan, surfels, aspect, chosen, error);
}

/* The view of samples shows those that are in the pictures. */
static gw_status open_view(render *r)
{
	const gw_surfels *surfels = &r->scene.surfels;
	if (!octree_view_is_samples(r->inner.view))
		return octree_view_open(r->settings, &r->scene, &r->inner, r->error);
	uint8_t *seen = calloc(surfels->count, 1);
	gw_status status =
		seen ? GW_OK
			 : gw_fail(r->error, GW_ERROR_MEMORY, "no memory for %zu points", surfels->count);
	double aspect = (double)r->width / (double)r->height;
	if (status == GW_OK)
		status = camera_plan_choose(&r->plan, surfels, aspect, seen, r->error);
	r->inner.seen = seen;
	if (status == GW_OK)
		status = octree_view_open(r->settings, &r->scene, &r->inner, r->error);
	r->inner.seen = NULL;
	free(seen);
	return status;
}

static gw_status read_scene(render *r)
{
	double start = gw_seconds();
	progress_show(&r->progress, "read", 0.0);
	const render_scene_wish wish = { wanted_channels(r), needs_octree(r), choose_points, r };
	GW_TRY(render_scene_read(r->settings, &wish, &r->scene, r->error));
	GW_TRY(choose_view(r));
	if (r->look.view == SETTINGS_VIEW_RADIANCE)
		GW_TRY(octree_picture_open(r->settings, &r->scene, &r->octree, r->error));
	GW_TRY(open_view(r));
	r->read_seconds += gw_seconds() - start;
	return GW_OK;
}

/* -------------------------------------------------------------------------------- drawing */

/* Boxes over the points. */
static gw_status lay_over(const render *r, const gw_camera *camera, const gw_raster_options *raster,
						  const gw_gbuffer *points, float *values)
{
	gw_gbuffer boxes;
	gw_status status = gw_raster_draw(&r->inner.raster, camera, raster, &boxes, r->error);
	if (status == GW_OK)
		octree_view_lay_over(&r->inner, camera, &boxes, points, values);
	gw_gbuffer_clear(&boxes);
	return status;
}

typedef struct resolution {
	uint32_t width, height, samples; /* samples a pixel's side */
} resolution;

/* The light of a picture's pixels. */
static gw_status shade(render *r, const gw_camera *camera, const gw_raster_options *raster,
					   const gw_gbuffer *g, float *values)
{
	double start = gw_seconds();
	if (octree_view_is_boxes(r->look.view))
		octree_view_values(&r->inner, camera, g, values);
	else
		render_view_values(&r->scene, g, r->look.view, values);
	GW_TRY(octree_picture_shade(&r->octree, &r->scene, camera, g, values, r->error));
	if (octree_view_is_overlay(r->look.view))
		GW_TRY(lay_over(r, camera, raster, g, values));
	r->shade_seconds += gw_seconds() - start;
	return GW_OK;
}

/* Bytes of a picture's pixels: coverage, depth, facing, which primitive, normal, and channels. */
static uint64_t bytes_of(const gw_gbuffer *g)
{
	return (uint64_t)g->width * g->height * (4 + 3 + g->channel_count) * sizeof(float);
}

static gw_status draw(render *r, size_t picture, resolution size, gw_gbuffer *g, float **values)
{
	gw_camera camera;
	gw_raster_options raster = { .width = size.width,
								 .height = size.height,
								 .samples = size.samples,
								 .radius_scale = r->points ? POINTS_RADIUS : 1.0f,
								 .cull = r->settings->render.cull,
								 .threads = r->settings->bake.threads,
								 .cancelled = on_cancelled };
	bool boxes = octree_view_is_boxes(r->look.view);
	*values = NULL;
	*g = (gw_gbuffer){ .width = 0 };
	GW_TRY(
		camera_plan_camera(&r->plan, (double)r->scene.surfels.spacing, picture, &camera, r->error));
	const gw_raster_scene *shown = boxes ? &r->inner.raster : &r->scene.raster;
	raster.cull = raster.cull && !boxes;
	double start = gw_seconds();
	GW_TRY(gw_raster_draw(shown, &camera, &raster, g, r->error));
	r->geometry_seconds += gw_seconds() - start;
	r->pixel_bytes = bytes_of(g);
	*values = reallocarray(NULL, (size_t)size.width * size.height, 3 * sizeof **values);
	if (!*values) {
		gw_gbuffer_clear(g);
		return gw_fail(r->error, GW_ERROR_MEMORY, "no memory for a picture");
	}
	return shade(r, &camera, &raster, g, *values);
}

/* What is seen in some pictures, pixel by pixel. */
typedef struct metering {
	float *light;    /* 3 * count */
	float *emission; /* 3 * count; of the light, what surfaces make themselves */
	size_t count;
} metering;

static void meter_pixels(const render *r, const gw_gbuffer *g, const float *values, metering *m)
{
	size_t pixels = (size_t)g->width * g->height;
	int offset = r->look.view == SETTINGS_VIEW_RADIANCE ? r->scene.offset[RENDER_EMISSION] : -1;
	for (size_t i = 0; i < pixels; i++) {
		if (!(g->coverage[i] > 0.0f))
			continue;
		for (size_t k = 0; k < 3; k++) {
			m->light[3 * m->count + k] = values[3 * i + k];
			m->emission[3 * m->count + k] =
				offset >= 0 ? g->channel[g->channel_count * i + (size_t)offset + k] : 0.0f;
		}
		m->count++;
	}
}

/* The exposure of all pictures: what is in view in them, or in some of them, drawn small. */
static gw_status meter(render *r)
{
	size_t pictures = camera_plan_count(&r->plan);
	size_t metered = pictures < METERED_PICTURES ? pictures : METERED_PICTURES;
	uint32_t height = r->height < METERED_HEIGHT ? r->height : METERED_HEIGHT;
	uint32_t width = (uint32_t)((uint64_t)r->width * height / r->height);
	width = width < 1 ? 1 : width > 16 * METERED_HEIGHT ? 16 * METERED_HEIGHT : width;
	metering m = { reallocarray(NULL, metered * width * height, 3 * sizeof *m.light),
				   reallocarray(NULL, metered * width * height, 3 * sizeof *m.emission), 0 };
	gw_status status = GW_OK;
	if (!m.light || !m.emission)
		status = gw_fail(r->error, GW_ERROR_MEMORY, "no memory to meter the light");
	for (size_t i = 0; i < metered && status == GW_OK; i++) {
		gw_gbuffer g;
		float *values;
		status = draw(r, i * pictures / metered, (resolution){ width, height, 1 }, &g, &values);
		if (status == GW_OK)
			meter_pixels(r, &g, values, &m);
		free(values);
		gw_gbuffer_clear(&g);
	}
	if (status == GW_OK)
		r->look.exposure = m.count ? preview_exposure(m.light, m.emission, m.count) : 0.0;
	free(m.light);
	free(m.emission);
	return status;
}

static gw_status choose_exposure(render *r)
{
	r->look.exposure = (double)r->settings->exposure;
	if (isnan(r->look.exposure) && render_view_is_light(r->look.view))
		return meter(r);
	return GW_OK;
}

static gw_status write_picture(const render *r, size_t picture, const gw_gbuffer *g,
							   const float *values)
{
	char *name = name_picture(r, picture);
	output_file *out = NULL;
	if (!name)
		return gw_fail(r->error, GW_ERROR_MEMORY, "no memory for a name");
	gw_status status = output_file_create(&out, name, r->settings->force, r->error);
	render_scene scene = r->scene;
	for (int c = 0; octree_view_is_boxes(r->look.view) && c < RENDER_CHANNEL_COUNT; c++)
		scene.offset[c] = -1; /* boxes have no such layers */
	if (status == GW_OK)
		status = (r->exr ? render_write_exr : render_write_png)(out, &scene, &r->look, g, values,
																r->error);
	if (status == GW_OK)
		status = output_file_commit(&out, r->error);
	output_file_abandon(&out);
	free(name);
	return status;
}

/* Holes of this share of a picture, or more, are spoken of; and so dark they look like shadow: what
 * a picture shows at 8 bits, encoded, as a tenth of white or less. */
#define HOLES_SHARE 0.003
#define HOLES_DARK 0.01

/* Where points are missing, a dark background is taken for shadow. */
static gw_status note_holes(const render *r, const gw_gbuffer *g)
{
	const render_background *b = &r->look.background;
	bool dark = !b->transparent && fmax(fmax(b->rgb[0], b->rgb[1]), b->rgb[2]) <= HOLES_DARK;
	double share;
	if (!dark || r->settings->quiet || r->exr || !render_view_is_light(r->look.view))
		return GW_OK;
	GW_TRY(picture_holes_find(g, &share, r->error));
	if (share >= HOLES_SHARE)
		fprintf(
			stderr,
			"glowworm: note: within the points %.2g %% of the picture is black because no point "
			"is there, not for shadow; --background 0.3 tells them apart\n",
			100.0 * share);
	return GW_OK;
}

/* A camera that was chosen by itself sees points, but maybe none of the boxes of a view. */
static gw_status fail_empty(const render *r)
{
	bool boxes = octree_view_is_boxes((settings_view)r->settings->render.view);
	return gw_fail(r->error, GW_ERROR_DATA,
				   boxes ? "nothing that this --view shows is in the picture; another --camera, "
						   "such as outside, or another level may show some"
						 : "no point is in view; --camera auto finds a camera that sees some");
}

static gw_status make_picture(render *r, size_t picture)
{
	gw_gbuffer g;
	float *values;
	gw_status status = draw(
		r, picture, (resolution){ r->width, r->height, r->settings->render.samples }, &g, &values);
	if (status == GW_OK && g.drawn == 0 && camera_plan_count(&r->plan) == 1)
		status = fail_empty(r);
	if (status == GW_OK && g.drawn == 0 && !r->settings->quiet)
		fprintf(stderr, "glowworm: note: no point is in view of picture %zu\n", picture + 1);
	if (status == GW_OK && picture == 0)
		status = note_holes(r, &g);
	double start = gw_seconds();
	if (status == GW_OK)
		status = write_picture(r, picture, &g, values);
	r->write_seconds += gw_seconds() - start;
	free(values);
	gw_gbuffer_clear(&g);
	return status;
}

/* Lamps light nothing in a picture; their shadows can be shown, and a sky is reflected. */
static void note_lamps(const render *r)
{
	const settings *s = r->settings;
	size_t idle = 0;
	for (size_t i = 0; i < s->light_count; i++)
		idle += !(r->octree.glossy && s->light[i].light.type == GW_LIGHT_ENVIRONMENT);
	if (idle > 0 && r->look.view != SETTINGS_VIEW_SHADOW && !s->quiet)
		fprintf(stderr,
				"glowworm: note: lamps that change nothing here: %zu; a picture shows the light "
				"that is in the points, which glowworm bake puts there\n",
				idle);
}

/* The first camera in the input's coordinates. */
static gw_viewpoint shown_view(const render *r)
{
	gw_viewpoint view = r->plan.view[0];
	coordinates_from_metres(&r->scene.place, view.at);
	coordinates_from_metres(&r->scene.place, view.to);
	return view;
}

/* A camera that was chosen, as the option that takes the same picture again. */
static void note_camera(const render *r)
{
	const gw_viewpoint own = shown_view(r), *v = &own;
	if (r->settings->quiet || r->plan.text[0].placed)
		return;
	fprintf(stderr,
			"glowworm: note: the camera is %s: --camera '" CAMERA_PLACE " fov %g' --up %s\n",
			v->from_scanner ? "the scanner's"
			: v->inside     ? "inside"
							: "outside",
			v->at[0], v->at[1], v->at[2], v->to[0], v->to[1], v->to[2], v->angle,
			settings_up_name(r->scene.up));
	if (v->flat && r->settings->up == SETTINGS_UP_AUTO)
		fprintf(stderr,
				"glowworm: note: most of the surface lies flat across %c, as ground does; if %c "
				"points up, say --up %c\n",
				v->flat, v->flat, v->flat);
}

/* ------------------------------------------------------------------------------ side by side */

/* Inputs side by side, and what is kept of each. */
typedef struct picture_row {
	gw_gbuffer *g;          /* owned, and each; count */
	float **values;         /* owned, and each */
	const char **name;      /* owned */
	render_values *picture; /* owned */
	size_t count;
	bool photometric;
	metering light;
} picture_row;

static void clear_row(picture_row *row)
{
	for (size_t i = 0; row->g && i < row->count; i++)
		gw_gbuffer_clear(&row->g[i]);
	for (size_t i = 0; row->values && i < row->count; i++)
		free(row->values[i]);
	free(row->g);
	free(row->values);
	free(row->name);
	free(row->picture);
	free(row->light.light);
	free(row->light.emission);
}

static gw_status open_row(const render *r, picture_row *row)
{
	size_t count = r->settings->input_count, pixels = count * r->width * r->height;
	*row = (picture_row){ .g = calloc(count, sizeof *row->g),
						  .values = calloc(count, sizeof *row->values),
						  .name = calloc(count, sizeof *row->name),
						  .picture = calloc(count, sizeof *row->picture),
						  .count = count,
						  .light = { reallocarray(NULL, pixels, 3 * sizeof *row->light.light),
									 reallocarray(NULL, pixels, 3 * sizeof *row->light.emission),
									 0 } };
	if (!row->g || !row->values || !row->name || !row->picture || !row->light.light ||
		!row->light.emission)
		return gw_fail(r->error, GW_ERROR_MEMORY, "no memory for %zu pictures", count);
	return GW_OK;
}

/* All inputs have to be of a kind, or one scale would say nothing. */
static gw_status check_alike(const render *r, const picture_row *row, size_t place,
							 settings_view first)
{
	const settings_input *input = r->settings->input;
	if (r->look.view != first)
		return gw_fail(r->error, GW_ERROR_DATA,
					   "%s is lit and %s is not, so they are not shown by one exposure; --view "
					   "shaded shows both without their light",
					   first == SETTINGS_VIEW_RADIANCE ? row->name[0] : input->path,
					   first == SETTINGS_VIEW_RADIANCE ? input->path : row->name[0]);
	if (render_view_is_light(first) && place > 0 && r->scene.photometric != row->photometric)
		return gw_fail(r->error, GW_ERROR_DATA,
					   "%s is in cd/m^2 and %s is not, so they are not shown by one exposure",
					   row->photometric ? row->name[0] : input->path,
					   row->photometric ? input->path : row->name[0]);
	return GW_OK;
}

/* Reads one input and draws it. */
static gw_status add_to_row(render *r, picture_row *row, size_t place)
{
	settings_view first = r->look.view;
	const resolution size = { r->width, r->height, r->settings->render.samples };
	row->name[place] = r->settings->input->path;
	GW_TRY(read_scene(r));
	GW_TRY(check_alike(r, row, place, place > 0 ? first : r->look.view));
	row->photometric = r->scene.photometric;
	if (place == 0) {
		note_lamps(r);
		note_camera(r);
	}
	double start = gw_seconds();
	GW_TRY(draw(r, 0, size, &row->g[place], &row->values[place]));
	r->draw_seconds += gw_seconds() - start;
	row->picture[place] = (render_values){ &row->g[place], row->values[place] };
	meter_pixels(r, &row->g[place], row->values[place], &row->light);
	if (row->g[place].drawn == 0)
		return gw_fail(r->error, GW_ERROR_DATA, "no point of %s is in view of the camera%s",
					   row->name[place], place > 0 ? ", which is that of the first input" : "");
	return GW_OK;
}

static void tally_octree(tally *t, const octree_picture *o)
{
	t->glossy = t->glossy || o->glossy;
	t->voxels = t->voxels || o->voxels;
	t->cubic = t->cubic || o->cubic;
	t->build_seconds += o->build_seconds;
	t->look_seconds += o->seconds;
	t->pixels += o->pixels;
	if (!o->octree)
		return;
	const gw_cache_seconds cached = gw_render_octree_cache_seconds(o->octree);
	const gw_lost_rays lost = gw_render_octree_lost_rays(o->octree);
	t->caches = t->caches || o->reflection.caches;
	t->cached.caches += cached.caches;
	t->cached.readers += cached.readers;
	t->cached.distribution += cached.distribution;
	t->cached.creation += cached.creation;
	t->cached.evaluation += cached.evaluation;
	t->probes += o->probes ? o->probes->count : 0;
	t->lost.rays += lost.rays;
	t->lost.traced += lost.traced;
	t->lost.looking += lost.looking;
	t->lost.tracing += lost.tracing;
}

/* Adds what is known of an input that was drawn. */
static void tally_scene(render *r)
{
	tally *t = &r->tally;
	t->points += r->scene.surfels.point_count;
	t->in_view += r->scene.surfels.count;
	t->read_seconds += r->scene.read_seconds;
	t->choose_seconds += r->scene.choose_seconds;
	t->surface_seconds += r->scene.surface_seconds;
	tally_octree(t, &r->octree);
}

static gw_status read_row(render *r, picture_row *row)
{
	settings *all = r->settings;
	gw_status status = open_row(r, row);
	for (size_t i = 0; i < all->input_count && status == GW_OK; i++) {
		settings one = *all;
		one.input = &all->input[i];
		one.input_count = 1;
		r->settings = &one;
		status = add_to_row(r, row, i);
		r->settings = all;
		tally_scene(r);
		octree_picture_clear(&r->octree);
		octree_view_clear(&r->inner);
		render_scene_clear(&r->scene);
	}
	return status;
}

static gw_status write_row(render *r, const picture_row *row)
{
	const render_scene unit = { .photometric = row->photometric };
	const render_row sheet = { row->picture, row->name, row->count };
	output_file *out = NULL;
	r->look.exposure = (double)r->settings->exposure;
	if (isnan(r->look.exposure) && render_view_is_light(r->look.view))
		r->look.exposure =
			preview_exposure(row->light.light, row->light.emission, row->light.count);
	gw_status status = output_file_create(&out, r->settings->output, r->settings->force, r->error);
	if (status == GW_OK)
		status = render_write_row(out, &unit, &r->look, &sheet, r->error);
	if (status == GW_OK)
		status = output_file_commit(&out, r->error);
	output_file_abandon(&out);
	return status;
}

static gw_status run_row(render *r)
{
	picture_row row;
	gw_status status = read_row(r, &row);
	if (status == GW_OK)
		status = write_row(r, &row);
	clear_row(&row);
	return status;
}

static gw_status run(render *r)
{
	GW_TRY(scene_read_all(r->settings, r->error));
	GW_TRY(check(r));
	if (r->settings->render.row)
		return run_row(r);
	GW_TRY(read_scene(r));
	note_lamps(r);
	note_camera(r);
	double start = gw_seconds();
	GW_TRY(choose_exposure(r));
	r->meter_seconds = gw_seconds() - start;
	r->geometry_seconds = r->shade_seconds = 0.0;
	size_t pictures = camera_plan_count(&r->plan);
	for (size_t i = 0; i < pictures; i++) {
		progress_show(&r->progress, "draw", (double)(i + 1) / (double)(pictures + 1));
		GW_TRY(make_picture(r, i));
	}
	r->draw_seconds = gw_seconds() - start;
	return GW_OK;
}

/* What --verbose says: enough to take the same picture again. */
static void summarize(const render *r)
{
	const gw_viewpoint own = shown_view(r), *v = &own;
	fprintf(stderr, "camera    " CAMERA_PLACE " fov %g\n", v->at[0], v->at[1], v->at[2], v->to[0],
			v->to[1], v->to[2], v->angle);
	if (!isnan(r->look.exposure))
		fprintf(stderr, "exposure  EV %g\n", r->look.exposure);
	fprintf(stderr, "points    %zu\n", r->tally.points);
	fprintf(stderr, "read      %.2f s\n", r->read_seconds);
	fprintf(stderr, "draw      %.2f s\n", r->draw_seconds);
	if (r->inner.shown)
		fprintf(stderr, "shown     %zu, %s m wide\n", r->inner.shown,
				GW_SAID((double)r->inner.size, 4));
	if (!r->tally.glossy && !r->tally.voxels)
		return;
	fprintf(stderr, "octree    %.2f s to build (of read), %.2f s to look up (of draw)\n",
			r->tally.build_seconds, r->tally.look_seconds);
	fprintf(stderr, "glossy    %llu pixels\n", (unsigned long long)r->tally.pixels);
}

static void show_stage(const char *name, double seconds)
{
	fprintf(stderr, "%-18s %9.1f\n", name, seconds * 1e3);
}

/* The rows of Salm's tables 5.1 to 5.4 that are of a picture, each for one of them. */
static void show_final(const render *r)
{
	bool cubic = r->tally.cubic && r->tally.voxels, glossy = r->tally.glossy;
	const char *shading = cubic ? glossy ? "ds(c/g)" : "ds(c)" : glossy ? "ds(g)" : "ds";
	size_t pictures =
		r->settings->render.row ? r->settings->input_count : camera_plan_count(&r->plan);
	double each = pictures ? 1.0 / (double)pictures : 1.0;
	fprintf(stderr, "\n%-18s %9s\n", "thesis's terms", "ms");
	show_stage("g-pass", each * r->geometry_seconds);
	show_stage(shading, each * r->shade_seconds);
	show_stage("final", each * (r->geometry_seconds + r->shade_seconds));
	fprintf(stderr, "%-18s %9.1f MB\n", "G-buffer", (double)r->pixel_bytes / (1024.0 * 1024.0));
}

/* The rows of Rehfeld's tables that are of caches, of all pictures and what metered them. */
static void show_caches(const render *r)
{
	if (!r->tally.caches)
		return;
	const gw_cache_seconds spent = r->tally.cached;
	fprintf(stderr, "\n%-18s %9s\n", "caches", "ms");
	show_stage("distribution", spent.distribution);
	show_stage("creation", spent.creation);
	show_stage("evaluation", spent.evaluation);
	fprintf(stderr, "%-18s %9llu\n", "placed", (unsigned long long)spent.caches);
	fprintf(stderr, "%-18s %9llu\n", "pixels", (unsigned long long)spent.readers);
}

/* What glossy pixels read from probes, of all pictures and what metered them. */
static void show_probes(const render *r)
{
	if (r->tally.probes == 0)
		return;
	const gw_lost_rays sent = r->tally.lost;
	const double share = sent.rays ? 100.0 * (double)sent.traced / (double)sent.rays : 0.0;
	fprintf(stderr, "\n%-18s %9s\n", "probes", "ms");
	show_stage("looking", sent.looking);
	show_stage("tracing", sent.tracing);
	fprintf(stderr, "%-18s %9zu\n", "placed", r->tally.probes);
	fprintf(stderr, "%-18s %9llu\n", "rays", (unsigned long long)sent.rays);
	fprintf(stderr, "%-18s %9.2f %%\n", "traced", share);
}

/* What --profile says. */
static void show_profile(const render *r)
{
	const tally *t = &r->tally;
	double pictures = r->draw_seconds - r->meter_seconds - r->write_seconds;
	struct rusage usage;
	fprintf(stderr, "%-18s %9s\n", "stage", "ms");
	show_stage("read", t->read_seconds);
	show_stage("camera", t->choose_seconds);
	show_stage("surface", t->surface_seconds);
	show_stage("exposure", r->meter_seconds);
	show_stage("draw", pictures);
	show_stage("write", r->write_seconds);
	show_stage("net", r->read_seconds + r->draw_seconds);
	show_final(r);
	show_caches(r);
	show_probes(r);
	fprintf(stderr, "\n%-18s %9zu\n", "points", t->points);
	fprintf(stderr, "%-18s %9zu\n", "in view", t->in_view);
	if (getrusage(RUSAGE_SELF, &usage) == 0)
		fprintf(stderr, "%-18s %9.1f MB\n", "peak", (double)usage.ru_maxrss / 1024.0);
}

gw_status verb_render(settings *s, gw_error *error)
{
	render r = { .settings = s,
				 .look = { .tone = s->render.tone,
						   .false_color = s->render.false_color,
						   .command = s->command },
				 .progress = progress_start((settings_progress)s->progress, s->quiet),
				 .error = error };
	quality_preset_apply(s);
	gw_status status = run(&r);
	progress_end(&r.progress);
	if (!s->render.row)
		tally_scene(&r);
	if (status == GW_OK && s->verbose)
		summarize(&r);
	if (status == GW_OK && s->profile)
		show_profile(&r);
	octree_picture_clear(&r.octree);
	octree_view_clear(&r.inner);
	camera_plan_clear(&r.plan);
	render_scene_clear(&r.scene);
	return status;
}
