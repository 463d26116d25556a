/*
 * settings.h - everything that options and scene file say: what to light, how, and where to put it.
 */
#ifndef SETTINGS_H
#define SETTINGS_H

#include "options/motion_path.h"
#include "options/output_shift.h"
#include "points/scan.h"
#include "glowworm_probes.h"

typedef enum verb {
	VERB_BAKE,
	VERB_PLAN,
	VERB_INFO,
	VERB_COMPARE,
	VERB_MIX,
	VERB_SAMPLE,
	VERB_CONVERT,
	VERB_RENDER,
	VERB_TRADEOFF,
	VERB_ALBEDO,
	VERB_DOCTOR,
	VERB_LAMP,
	VERB_MEASURE,
	VERB_PROBES,
	VERB_METHODS,
	VERB_PAGE,
	VERB_COUNT,
} verb;

/* One input of the scene. */
typedef struct settings_input {
	char *path; /* owned; "-" is standard input */
	bool has_matrix;
	double matrix[16]; /* row-major; from the file's coordinates to the scene's */
	bool has_emission;
	float emission[3];
	bool has_albedo;
	float albedo[3]; /* linear */
	bool has_opacity;
	float opacity; /* 0..1 */
	bool has_specular, has_roughness;
	float specular, roughness; /* reflectance at normal incidence, and 0 a mirror to 1 matt */
	bool mesh;                 /* points are sampled on its faces */
	bool vertices;             /* its vertices are the points, even if its name is a mesh's */
	float density;             /* of a mesh, points/m^2; 0: as settings.density says */
	size_t motion;             /* 0: it stands still; else has_matrix, and its path is
								  settings.path[motion - 1] */
	bool again;                /* the file of the input before it stands here once more */
} settings_input;

/* Frames that a scene can have. */
#define SETTINGS_FRAMES_MAX 1000000

typedef enum settings_up {
	SETTINGS_UP_AUTO,
	SETTINGS_UP_Y,
	SETTINGS_UP_Z,
	SETTINGS_UP_X,
	SETTINGS_UP_MINUS_Y,
	SETTINGS_UP_MINUS_Z,
	SETTINGS_UP_MINUS_X,
	SETTINGS_UP_COUNT
} settings_up;

/* What becomes of points that belong to no surface. */
typedef enum settings_strays {
	SETTINGS_STRAYS_LIGHT, /* they get light */
	SETTINGS_STRAYS_KEEP,  /* they are points like others */
	SETTINGS_STRAYS_DROP,  /* they are not written */
	SETTINGS_STRAYS_COUNT
} settings_strays;

/* In what light photographs were taken. */
typedef enum settings_capture {
	SETTINGS_CAPTURE_AUTO,      /* the lights that are named, else the laser's intensity */
	SETTINGS_CAPTURE_LIGHTS,    /* those that are named */
	SETTINGS_CAPTURE_FLASH,     /* at the scanner */
	SETTINGS_CAPTURE_OVERCAST,  /* a sky that is even */
	SETTINGS_CAPTURE_INTENSITY, /* any: the laser says how bright a surface is */
	SETTINGS_CAPTURE_COUNT
} settings_capture;

/* What still varies smoothly along a surface when the light of the capture was divided out. */
typedef enum settings_remainder {
	SETTINGS_REMAINDER_ALBEDO, /* the albedo does */
	SETTINGS_REMAINDER_LIGHT,  /* light does that nobody named */
	SETTINGS_REMAINDER_COUNT
} settings_remainder;

/* How exactly LAS keeps light. */
typedef enum settings_las_radiance {
	SETTINGS_LAS_FLOAT,
	SETTINGS_LAS_HALF,     /* rounded to as many bits as a half float has, */
	SETTINGS_LAS_BFLOAT16, /* or as the upper half of a float */
	SETTINGS_LAS_COUNT
} settings_las_radiance;

typedef enum settings_progress {
	SETTINGS_PROGRESS_AUTO,
	SETTINGS_PROGRESS_JSON,
	SETTINGS_PROGRESS_NONE,
	SETTINGS_PROGRESS_COUNT
} settings_progress;

/* Columns that are written on request. */
typedef enum settings_field {
	SETTINGS_FIELD_DIRECT,     /* radiance by light straight from lights, emitters and sky */
	SETTINGS_FIELD_INDIRECT,   /* radiance by light that was reflected before */
	SETTINGS_FIELD_IRRADIANCE, /* of both together */
	SETTINGS_FIELD_DIRECT_IRRADIANCE,
	SETTINGS_FIELD_INDIRECT_IRRADIANCE,
	SETTINGS_FIELD_LUMINANCE,    /* cd/m^2, of a photometric scene */
	SETTINGS_FIELD_ILLUMINANCE,  /* lx, of a photometric scene */
	SETTINGS_FIELD_ROI,          /* side of the region of influence */
	SETTINGS_FIELD_AO,           /* ambient occlusion: ambient light, 0..1 */
	SETTINGS_FIELD_BENT_NORMALS, /* where ambient light comes from */
	SETTINGS_FIELD_NORMALS,      /* the normals that the bake used */
	SETTINGS_FIELD_ERROR,        /* how far records disagree */
	SETTINGS_FIELD_UNKNOWN,      /* share of what is gathered that comes through gaps */
	SETTINGS_FIELD_LIGHTS,       /* radiance by lamp */
	SETTINGS_FIELD_GROUPS,       /* radiance by group of lamps, and by those of none */
	SETTINGS_FIELD_COUNT
} settings_field;

/* Those for which light is told apart by its lamp. */
#define SETTINGS_FIELDS_OF_LAMPS (1u << SETTINGS_FIELD_LIGHTS | 1u << SETTINGS_FIELD_GROUPS)

/* Effects that the program knows of, after those of the library (gw_effect_kind). */
typedef enum settings_effect {
	SETTINGS_EFFECT_GLOSS = GW_EFFECT_KIND_COUNT, /* points reflect by their gloss, too */
	SETTINGS_EFFECT_MOTION,                       /* inputs and lamps follow their paths */
	SETTINGS_EFFECT_COUNT
} settings_effect;

/* 1 << settings_effect of those that are forced, or forbidden; those of the library are in
 * gw_bake_options. */
typedef struct settings_effects {
	uint32_t forced, forbidden;
} settings_effects;

/* How much stronger one lamp shall be. */
typedef struct settings_gain {
	const char *name; /* of the lamp, or "rest"; or of a group */
	float factor[3];
	bool group;
	const char *setup; /* of page: the set-up that it belongs to; NULL: of mix */
} settings_gain;
/* What a picture shows. */
typedef enum settings_view {
	SETTINGS_VIEW_AUTO, /* radiance of a lit cloud, else shaded */
	SETTINGS_VIEW_RADIANCE,
	SETTINGS_VIEW_SHADED, /* albedo in the light of a lamp at the camera */
	SETTINGS_VIEW_ALBEDO,
	SETTINGS_VIEW_NORMAL,
	SETTINGS_VIEW_DEPTH,
	SETTINGS_VIEW_DIRECT, /* radiance, as SETTINGS_FIELD_DIRECT */
	SETTINGS_VIEW_INDIRECT,
	SETTINGS_VIEW_IRRADIANCE,
	SETTINGS_VIEW_ILLUMINANCE, /* its luminance, lx; of a photometric scene */
	SETTINGS_VIEW_ROI,         /* size of the region of influence */
	SETTINGS_VIEW_NDF,         /* length of the normals */
	SETTINGS_VIEW_POINTS,      /* auto, with discs so small that each point is seen */
	SETTINGS_VIEW_CELLS,       /* of the octree; settings_render.detail says the level */
	SETTINGS_VIEW_BORDER,      /* its border tiles, likewise */
	SETTINGS_VIEW_OCTREE,      /* both at once, likewise */
	SETTINGS_VIEW_OPACITY,     /* of voxels to one side; detail is LEVEL:SIDE */
	SETTINGS_VIEW_VOXELS,      /* their radiance, likewise */
	SETTINGS_VIEW_SHADOW,      /* what a lamp sees; detail is its name or number */
	SETTINGS_VIEW_RECORDS,     /* where a bake gathers light */
	SETTINGS_VIEW_SAMPLES,     /* regions of influence as boxes, NDFs as discs in them */
	SETTINGS_VIEW_ERROR,       /* of a cloud that compare wrote */
	SETTINGS_VIEW_GAPS,        /* how much of a point's light would come through gaps */
	SETTINGS_VIEW_COUNT
} settings_view;

/* How the glossy bounce is found. */
typedef enum settings_glossy {
	SETTINGS_GLOSSY_OFF,
	SETTINGS_GLOSSY_RAYS,
	SETTINGS_GLOSSY_CONES,
	SETTINGS_GLOSSY_CACHES,
	SETTINGS_GLOSSY_PROBES,
	SETTINGS_GLOSSY_COUNT
} settings_glossy;

/* Where the radiance of a picture is read. */
typedef enum settings_radiance {
	SETTINGS_RADIANCE_POINTS,
	SETTINGS_RADIANCE_TRILINEAR, /* in the octree's bricks */
	SETTINGS_RADIANCE_TRICUBIC,
	SETTINGS_RADIANCE_COUNT
} settings_radiance;

/* Pictures. */
typedef struct settings_render {
	const char *camera, *path, *size, *background; /* as given, NULL for the defaults */
	const char *mesh;                              /* as given, NULL: none */
	const char *scale, *isolux;                    /* as given, NULL: fitted; none */
	uint32_t orbit, samples;
	int view, tone;     /* settings_view, preview_tone */
	const char *detail; /* what stands behind the view's name and colon, or NULL */
	int glossy;         /* settings_glossy */
	int radiance;       /* settings_radiance */
	uint32_t glossy_rays;
	settings_effects effects; /* of pictures: gloss */
	bool false_color, cull, row;
} settings_render;

/* Who said what an option is to be; who stands lower down wins. */
typedef enum settings_source {
	SETTINGS_BY_DEFAULT,
	SETTINGS_BY_SCENE,
	SETTINGS_BY_COMMAND,
} settings_source;

/* Room for options, at least as many as options[] has. */
#define SETTINGS_OPTIONS 192

typedef struct settings {
	gw_bake_options bake;
	scan_points_options points;
	settings_input *input; /* owned; input_count */
	size_t input_count;
	lamp *light; /* owned; light_count */
	size_t light_count;
	luminaire **luminaire; /* owned, each and the list; luminaire_count: files that lights name */
	size_t luminaire_count;
	double *scanner; /* owned; 3 * scanner_count, metres: where scanners stood, whatever the
						inputs say */
	size_t scanner_count;
	bool scanner_none; /* nobody knows where scanners stood, whatever the inputs say */
	motion_path *path; /* owned; path_count */
	size_t path_count;
	uint32_t frame_count; /* 0: the scene says nothing of frames */
	const char *frames;   /* which of them to bake, as given; NULL: none */
	bool rebuild, independent;
	light_units units;               /* of the scene file, or of its lights */
	bool units_said;                 /* in the scene file */
	int length;                      /* a coordinates_unit: what coordinates are in */
	int up, colors, gamma, progress; /* values of enums and choices */
	int strays;                      /* settings_strays */
	uint32_t fields;                 /* 1 << settings_field */
	settings_effects effects;        /* of bakes: gloss and motion */
	float density;                   /* of meshes, points/m^2; 0: see settings.count */
	uint32_t count;                  /* points for all meshes without a density together */
	int capture;                     /* a settings_capture */
	float capture_scale;             /* colour, linear, of radiance 1; 0: unknown */
	int remainder;                   /* a settings_remainder */
	int las_radiance;                /* a settings_las_radiance */
	float las_step;                  /* of coordinates, at most; 0: they come back exactly;
									   -1: to be chosen */
	int quality;                     /* a gw_quality */
	float opacity;                   /* of all points, 0..1; -1: as columns say */
	float exposure;                  /* EV; NAN: from the picture */
	const char *scene;               /* the scene file that was read, or NULL */
	const char *transport, *save_transport;
	const char *shift;     /* as given; NULL: none */
	output_shift shifting; /* what becomes of it: of bake */
	const char *output, *vdb, *vdb_sh, *report, *format, *columns, *output_format;
	float vdb_voxel; /* metres; 0: the octree's cells */
	settings_render render;
	bool vdb_half, vdb_points, force, resume, quiet, verbose, explain, profile, print_scene, json,
		devices;
	bool places, stats; /* of info */
	bool help;
	const char *csv, *svg;         /* of tradeoff */
	gw_probes_options probes;      /* but for their seed, which is that of the bake */
	const char *worst, *json_file; /* of compare, and of probes */
	const char *picture;           /* of probes */
	uint32_t worst_count;          /* points that worst holds */
	uint32_t page_points;          /* points that a page shows at most */
	const char *title;             /* of a page; NULL: its input's name */
	const char **view;             /* owned; view_count cameras of a page, as given */
	size_t view_count;
	float max_rel_rmse, max_best_99, max_bias; /* limits; NAN: none */
	const char *region;                        /* of bake, as given; NULL: all */
	uint32_t tiles;                            /* of a cloud, at least; 0: it has none */
	const char *measure_box, *measure_path;    /* as given; NULL: everywhere */
	float measure_reach;                       /* from that path, metres */
	settings_gain *gain;                       /* owned; of mix and page */
	size_t gain_count;
	uint8_t given[SETTINGS_OPTIONS]; /* by index in options[]: a settings_source */
	char *command; /* owned; the command line, without what cannot change the points */
	char **text;   /* owned; text_count strings that others point to */
	size_t text_count;
} settings;

/* The letter of an axis, as gw_camera_up has it; z for SETTINGS_UP_AUTO. And its name as an option:
 * "-y". */
char settings_up_axis(int up);
const char *settings_up_name(char axis);

/* The name of an effect, of the library or a settings_effect; NULL beyond them. */
const char *settings_effect_name(int effect);

/* Whether glossy points are glossy in a bake; and in a picture, which may have its own say. */
bool settings_bakes_gloss(const settings *settings);
bool settings_shows_gloss(const settings *settings);

settings settings_default(void);
void settings_clear(settings *settings);

/* Adds an input, a light or a gain; copies, but a gain's name is kept by settings_keep. */
gw_status settings_add_input(settings *settings, const settings_input *input, gw_error *error);
gw_status settings_add_light(settings *settings, const lamp *light, gw_error *error);

/* Reads the files of luminaires that lights name. Errors as luminaire_read. */
gw_status settings_read_luminaires(settings *settings, gw_error *error);

/* Adds the place of a scanner, metres, in the scene's coordinates. */
gw_status settings_add_scanner(settings *settings, const double place[3], gw_error *error);

/* Says that nobody knows where scanners stood: no place is taken, neither before nor after. */
void settings_set_scanner_none(settings *settings);

/* Adds a path, which then belongs to the settings; its number, from 1, goes to *number. */
gw_status settings_add_path(settings *settings, motion_path *path, size_t *number, gw_error *error);

gw_status settings_add_gain(settings *settings, const settings_gain *gain, gw_error *error);

/* Adds a camera of a page; text is kept by settings_keep. */
gw_status settings_add_view(settings *settings, const char *text, gw_error *error);

/* Keeps a copy of a text until settings_clear; NULL when memory is short. */
const char *settings_keep(settings *settings, const char *text, gw_error *error);

#endif
