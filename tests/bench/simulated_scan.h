/*
 * simulated_scan.h - what laser scanners or depth cameras would bring home from a scene of
 * triangles, with the faults of real ones, each of which can be had alone.
 *
 * A beam has a width: it is seven rays, and its range is their mean, so that it lies in the air
 * where some of them pass an edge and others do not (a mixed pixel). Noise and steps of the range
 * are along the beam. A station's whole scan is shifted and turned by its registration error, its
 * own place included.
 *
 * A scanner that is carried is one of sixteen beams that turns, whose stations are its poses on the
 * way from one station of the scene to the next and back; its error is a drift along that way.
 */
#ifndef SIMULATED_SCAN_H
#define SIMULATED_SCAN_H

#include "reference_tracer.h"

/* How to scan; zeros leave a fault out. */
typedef struct scan_faults {
	double beam_width;        /* metres at the exit, diameter */
	double beam_divergence;   /* radians, of the whole beam */
	double range_noise;       /* standard deviation, metres */
	double noise_growth;      /* metres more of it a metre of range */
	double step;              /* metres: ranges are multiples; of a camera, at 1 m, and growing with
								 the square of the depth, as disparities do */
	double registration;      /* metres that each station is off, in a random direction; of one that
								 is carried, standard deviation of the drift along each axis */
	double registration_turn; /* degrees that each is turned about a random axis; likewise */
	double strays;            /* share of points that lie anywhere along their beams */
	uint32_t holes;           /* places of which no beam comes back */
} scan_faults;

typedef struct scan_setup {
	size_t count; /* points, about, of all stations together */
	bool camera;  /* each station is a depth camera that looks at the scene's middle, 58 x 45
					 degrees; else a scanner that looks all around, but not straight down */
	size_t rows;  /* of each station, as the beams of a scanner that turns; 0: rows are as far apart
					 as  columns */
	size_t poses; /* of a scanner that is carried; 0: scanners stand on the scene's stations */
	scan_faults faults;
	uint64_t seed;
} scan_setup;

/* What a cell of a station's grid brought back. */
typedef enum cell_kind {
	CELL_EMPTY,
	CELL_SURFACE,
	CELL_MIXED, /* between surfaces: further off its own than noise is */
	CELL_STRAY
} cell_kind;

typedef struct scan_cell {
	cell_kind kind;
	double range;      /* metres */
	double surface[3]; /* where the middle of the beam meets the scene, if it does */
	uint32_t triangle; /* that it meets */
} scan_cell;

/* One station's grid: columns from left to right or all around, each from below. */
typedef struct station_scan {
	double place[3];     /* where it stood */
	double own[3];       /* where it says that it stood */
	double axes[9];      /* columns: how its frame stands in the world, as it says */
	double true_axes[9]; /* and as it did */
	size_t columns, rows;
	double low, row_step, left, column_step; /* radians of a scanner's angles; tangents of a
												camera's */
	scan_cell *cell;                         /* owned; columns * rows */
} station_scan;

typedef struct simulated_scan {
	station_scan *station; /* owned, station_count */
	size_t station_count;
	size_t count; /* cells that are not empty */
} simulated_scan;

/* Scans a scene from its stations; freed with simulated_scan_clear. GW_ERROR_MEMORY or
 * GW_ERROR_INTERNAL. The same for the same setup. */
gw_status simulated_scan_make(const mesh_scene *scene, const scan_setup *setup,
							  simulated_scan *scan, gw_error *error);
void simulated_scan_clear(simulated_scan *scan);

/* Direction of a cell in its station's frame, unit length. */
void station_scan_direction(const station_scan *station, const scan_setup *setup, size_t column,
							size_t row, double direction[3]);

/* Takes a place in a station's frame to the world as the station sees it: with its error. */
void station_scan_to_world(const station_scan *station, const double own[3], double world[3]);

#endif
