/*
 * scan.h - a point cloud as it stood in a file: every attribute of every point, in order, in the
 * type and with the digits that came in.
 *
 * A scan is a table of columns. Readers fill it, writers take it, and `scan_points` derives from
 * it what the light needs. Column names are the project's canonical ones where a meaning is known
 * (x y z, nx ny nz, red green blue, alpha, opacity, intensity, emission_r emission_g emission_b,
 * albedo_r albedo_g albedo_b, specular, roughness; of splats also those of scan_splats.h) and the
 * file's own otherwise.
 */
#ifndef SCAN_H
#define SCAN_H

#include "glowworm.h"

typedef enum scan_type {
	SCAN_INT8,
	SCAN_UINT8,
	SCAN_INT16,
	SCAN_UINT16,
	SCAN_INT32,
	SCAN_UINT32,
	SCAN_FLOAT32,
	SCAN_FLOAT64,
	SCAN_TYPE_COUNT
} scan_type;

/* Bytes of one value. */
size_t scan_type_size(scan_type type);

typedef struct scan_column {
	char *name; /* owned */
	scan_type type;
	void *data; /* owned; count values of the type, native byte order */
} scan_column;

/* A comment that begins with this is about the input: something that its reader found wrong or took
 * for granted. Users see it; it does not go into results. */
#define SCAN_NOTE "note: "
/* What is said of a mesh whose vertices are taken as points. */
#define MESH_VERTICES_NOTE                                                                         \
	SCAN_NOTE "its vertices were read, not its faces; `glowworm sample` puts points on them"

/* And one that begins with this names the axis that points up: "y" or "-y". */
#define SCAN_UP "glowworm up: "
/* Of a file whose format has no place for it: where a scanner stood, three numbers; at most so many
 * of them. */
#define SCAN_SCANNER "glowworm scanner: "
#define SCAN_SCANNERS_SAID 64
/* A lit file's: its points enclose a space to look at from within, whatever its normals say. */
#define SCAN_ENCLOSED "glowworm space: enclosed"
#define SCAN_NO_SCANNER UINT32_MAX

typedef struct scan {
	size_t count;        /* points */
	scan_column *column; /* owned */
	size_t column_count;
	char **comment; /* owned; comment_count lines of text without the format's keyword */
	size_t comment_count;
	uint64_t left_out; /* rows without a point: empty cells of a scanner's grid */
	char up;           /* which axis the format calls up, as gw_camera_up has it */
	bool says_up;      /* the file itself has a line about that (SCAN_UP) */
	double step;       /* formats that keep coordinates on a grid may take one as coarse as this;
						  0: one that gives them back, where they can */
	unsigned noise_classes; /* bits: values of `classification` that mean noise; and points that are
							   `withheld` are not to be used where any bit is set */
	double *scanner;        /* owned; 3 * scanner_count: where scanners stood, in the cloud's
							   coordinates */
	size_t scanner_count;
	uint32_t *scanner_of;  /* owned; count: which of them saw each point, or SCAN_NO_SCANNER;
							  NULL when there is none, or the one saw them all */
	gw_range_image *image; /* owned; image_count: which points are whole pictures of a scanner */
	size_t image_count;
	uint32_t *image_cell; /* owned; count: the cell of each point of an image; NULL without one */
} scan;

/*
 * Which axis of a cloud is up, as gw_camera_up has it: what its format or it itself says, or where
 * neither a line in it nor a scanner tells, y if its points stand on a base there (gw_likely_up),
 * or seem to have y up for another reason and that is the custom, too.
 *   position   3 * count
 *   custom     custom_up of its format
 *   doubtful   receives whether z is taken, but y may be meant
 */
char scan_up(const scan *cloud, const double *position, char custom, bool *doubtful);

/* Frees all that a scan holds and empties it. An empty (zeroed) scan is accepted. */
void scan_clear(scan *scan);

/* Adds a column of scan->count zeroed values. Returns it (valid until the next add), or NULL with
 * *error filled when memory is short or the name exists. name is copied. */
scan_column *scan_add_column(scan *scan, const char *name, scan_type type, gw_error *error);

/* Adds a comment line; text is copied. */
gw_status scan_add_comment(scan *scan, const char *text, gw_error *error);

/* Comments of `to` say where the scanners of `from`, which may be the same, stood: all, or where
 * they are more than SCAN_SCANNERS_SAID, none. Those that say it already stay alone.
 * GW_ERROR_MEMORY. */
gw_status scan_say_scanners(const scan *from, scan *to, gw_error *error);

/*
 * Says that a scanner at `position` saw the points [first, first + count); the same position said
 * soon again is the same scanner. GW_ERROR_MEMORY.
 */
gw_status scan_add_scanner(scan *scan, const double position[3], size_t first, size_t count,
						   gw_error *error);

/*
 * Says that the points [first, first + count), which lie behind all those of earlier images, are a
 * picture of columns * rows cells seen from `position`. Cells, row * columns + column, are to be
 * put into image_cell[first] and following. GW_ERROR_MEMORY.
 */
gw_status scan_add_image(scan *scan, const gw_range_image *image, gw_error *error);

/* Index of the scanner at a position, which is added unless it is one of the last; SCAN_NO_SCANNER
 * when memory is short. A file may have a million, so that not all are compared. */
uint32_t scan_scanner_at(scan *scan, const double position[3]);

/* Makes room for which scanner saw each point: the first all of them, or none. GW_ERROR_MEMORY. */
gw_status scan_part_scanners(scan *scan, gw_error *error);

/* The column of that name, or NULL. */
scan_column *scan_find(const scan *scan, const char *name);

/* Removes the column of that name, if there is one. */
void scan_remove_column(scan *scan, const char *name);

/*
 * Removes points: their values of all columns, and which scanner saw them.
 *   gone  count, not 0 for those that go
 */
void scan_remove_points(scan *scan, const uint8_t *gone);

/* Points of a cloud as one of their own, in the order in which they are named, without comments,
 * scanners and images.
 *   point   count numbers below cloud->count
 *   some    the caller's on success, empty on failure: GW_ERROR_MEMORY */
gw_status scan_take_points(const scan *cloud, const uint32_t *point, size_t count, scan *some,
						   gw_error *error);

/* Whether all bits of a column's values are 0, of the first `count` points. */
bool scan_is_zero(const scan_column *column, size_t count);

/* Value of point i as a double. */
double scan_value(const scan_column *column, size_t i);

/* Stores a value that the column's type is known to hold as point i. */
void scan_store(scan_column *column, size_t i, double value);

/* ---------------------------------------------------------------------- from scan to points */

/* Where the albedo comes from. */
typedef enum scan_albedo {
	SCAN_ALBEDO_AUTO,      /* albedo_*, else colours, else constant GW_ALBEDO_DEFAULT */
	SCAN_ALBEDO_COLOR,     /* red green blue (or albedo_*) */
	SCAN_ALBEDO_INTENSITY, /* the scanner's intensity, scaled to its 99th percentile */
	SCAN_ALBEDO_CONSTANT,
	SCAN_ALBEDO_PROPERTY, /* any column, taken as linear */
	SCAN_ALBEDO_COUNT
} scan_albedo;

typedef struct scan_points_options {
	scan_albedo albedo;
	float constant;       /* of SCAN_ALBEDO_CONSTANT, 0..1 */
	const char *property; /* of SCAN_ALBEDO_PROPERTY */
	float scale;          /* every albedo is multiplied by this; 1 leaves it */
	float white;          /* 0..1: blend towards white, rho + white * (1 - rho) (Salm 5.1) */
	bool linear_colors;   /* colours are linear already, not sRGB-encoded */
	float intensity_full; /* what intensity counts to, after scan_intensity_make; 0: its 99th
							 percentile */
	uint32_t threads;     /* 0: one a core */
	const struct scan_told *told; /* NULL; or what the whole tells of which this is a part */
} scan_points_options;

#define SCAN_POINTS_OPTIONS_DEFAULT                                                                \
	((scan_points_options){ .constant = GW_ALBEDO_DEFAULT, .scale = 1.0f })

/* gw_points with the memory behind them. */
typedef struct scan_points {
	gw_points points;        /* what gw_bake takes; its pointers lead into this struct's memory */
	char albedo_source[240]; /* a phrase: which albedo was used and why */
	bool albedo_told;        /* only their values tell what colours count to, or which are none */
	double *position;
	float *normal;
	float *albedo;
	float *emission;
	float *opacity;    /* NULL where all are opaque */
	float *beam_share; /* NULL where no beam met several points */
	uint8_t *stray;    /* owned */
} scan_points;

/*
 * Derives positions, normals, or else axes as normals of either side, linear albedo, emission,
 * opacity, and which points a file calls noise or withholds, or are splats of haze. What colours
 * count up to, from 1 to 65535, their values tell; see scan_color_find. With SCAN_ALBEDO_AUTO,
 * colours that are all black count as none. CloudCompare's prefix scalar_ is understood. A lit
 * file's own albedo_* columns go before its preview colours. out   on success owned by the caller,
 * freed with scan_points_clear; its scanners are those of the scan, which has to live as long
 */
gw_status scan_points_make(const scan *scan, const scan_points_options *options, scan_points *out,
						   gw_error *error);
void scan_points_clear(scan_points *points);

#endif
