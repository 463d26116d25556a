/* scan_origin.c - see scan_origin.h. */
#include "points/scan_origin.h"

#include <math.h>
#include <stdlib.h>

/* Rows and columns of a grid, at least and at most. */
#define LINES_LEAST 8
#define LINES_MOST (1u << 20)

/* Spread of a line's angles over that of all, both squared: a scanner's mirror wobbles less. */
#define SPREAD_MOST 1e-3

/* Sums of one row or column. */
typedef struct line {
	double count, elevation, squared, cosine, sine;
} line;

static bool add_point(line *lines, const double p[3], double index)
{
	double flat = hypot(p[0], p[1]), elevation = atan2(p[2], flat);
	if (!(flat > 0.0) || !isfinite(flat) || !isfinite(p[2]))
		return true;
	if (!(index >= 0.0 && index < LINES_MOST))
		return false;
	line *to = &lines[(size_t)index];
	to->count++;
	to->elevation += elevation;
	to->squared += elevation * elevation;
	to->cosine += p[0] / flat;
	to->sine += p[1] / flat;
	return true;
}

/* Sums by the index of one column; NULL when that makes no sense or memory is short. */
static line *sum_lines(const scan *cloud, const scan_grid *grid, const scan_column *by)
{
	const scan_column *position[3] = { scan_find(cloud, "x"), scan_find(cloud, "y"),
									   scan_find(cloud, "z") };
	line *lines = calloc(LINES_MOST, sizeof *lines);
	bool good = lines && position[0] && position[1] && position[2];
	for (size_t i = grid->first; good && i < grid->first + grid->count; i++) {
		double p[3];
		for (int k = 0; k < 3; k++)
			p[k] = scan_value(position[k], i);
		good = add_point(lines, p, scan_value(by, i));
	}
	if (good)
		return lines;
	free(lines);
	return NULL;
}

/* Spread within lines over the spread of all: of elevations, or of azimuths as unit vectors. */
static double relative_spread(const line *lines, bool azimuth)
{
	line all = { 0 };
	double within = 0.0, total;
	size_t used = 0;
	for (size_t i = 0; i < LINES_MOST; i++) {
		const line *l = &lines[i];
		if (l->count == 0.0)
			continue;
		within += azimuth ? l->count - hypot(l->cosine, l->sine)
						  : l->squared - l->elevation * l->elevation / l->count;
		all.count += l->count;
		all.elevation += l->elevation;
		all.squared += l->squared;
		all.cosine += l->cosine;
		all.sine += l->sine;
		used++;
	}
	total = azimuth ? all.count - hypot(all.cosine, all.sine)
					: all.squared - all.elevation * all.elevation / all.count;
	return used >= LINES_LEAST && total > 1e-6 * all.count ? within / total : 1.0;
}

bool scan_grid_faces_origin(const scan *cloud, const scan_grid *grid)
{
	line *rows = sum_lines(cloud, grid, grid->row);
	line *columns = rows ? sum_lines(cloud, grid, grid->column) : NULL;
	bool faces = false;
	if (rows && columns)
		faces = (relative_spread(rows, false) < SPREAD_MOST &&
				 relative_spread(columns, true) < SPREAD_MOST) ||
				(relative_spread(columns, false) < SPREAD_MOST &&
				 relative_spread(rows, true) < SPREAD_MOST);
	free(rows);
	free(columns);
	return faces;
}
