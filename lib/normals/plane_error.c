/*
 * plane_error.c - see plane_error.h.
 */
#include "normals/plane_error.h"

#include "base/memory.h"
#include "base/nth_element.h"

#include <math.h>
#include <stdlib.h>

/* Variance of a normal, both axes together, in slopes of squared heights over squared distances: it
 * would be 4 if errors of neighbours had nothing in common and the line were straight.
 * Measured: 7.4 on a cave of facets, 9.1 in rooms. */
#define SLOPE_FACTOR 8.0

/*
 * What noise does to the slope: neighbours are the nearest in space, so those that it moved far are
 * missing among the near ones. With a variance t of normals by noise, rad^2, the slope is wrong by
 * NOISE_CUBED t^3 - NOISE_SLOPE t, and t itself by NOISE_TURN t^2, since the furthest are missing
 * everywhere. Measured on the same scenes with noise of 0.05 to 0.4 spacings.
 */
#define NOISE_SLOPE 0.41
#define NOISE_CUBED 43000.0
#define NOISE_TURN 160.0

/*
 * A surfel that lies in the plane of a neighbour is of its surface, so its normal should be the
 * neighbour's, but for what the surface bends between them: normals of a circle differ by twice the
 * slope of the way from one plane to the other place. What normals differ beyond that is counted as
 * error, the more the smaller the slope is beside IN_PLANE. Its own normal is one of those that are
 * compared. Where a plane is fitted over a crease this tells of up to 90 degrees, at places where
 * no line through heights of many surfels shows them.
 */
#define IN_PLANE 0.05

/* Mean squared heights of one surfel's neighbours are this many times the median in a region, where
 * they are more than chance: its own height is in each of them. */
#define ABOVE_MEDIAN 6.0

/* Squared, in the neighbours' reach: where most heights are less than that, planes through
 * neighbours keep to one face of a crease. Those of rows and columns may not. */
#define HEIGHT_LEAST 1e-6

/* Sums over the neighbours of a surfel, by which a line is fitted to those of all in a region: x is
 * the squared distance, y the squared height. */
typedef struct line_sums {
	float count, x, y, xx, xy, yy;
	float others, height, turn; /* of neighbours on another face: sums of the surfel's height over
								   it and of the squared difference of the normals */
	float reach;                /* metres: of the neighbours */
	/* Weights of neighbours in whose plane the surfel lies, and sums over them, of the squared
	 * difference of the normals that is error and of the square of that. */
	float in_plane, differs, differs_squared;
} line_sums;

typedef struct plane_step {
	const gw_surfels *surfels;
	line_sums *sums; /* count */
} plane_step;

static void add_other(const gw_surfels *s, size_t surfel, size_t other, double reach,
					  line_sums *sums)
{
	const float *p = s->position + 3 * surfel, *q = s->position + 3 * other;
	const float *n = s->normal + 3 * surfel, *m = s->normal + 3 * other;
	double height = 0, cosine = 0;
	for (size_t k = 0; k < 3; k++) {
		height += (double)m[k] * ((double)p[k] - (double)q[k]) / reach;
		cosine += (double)n[k] * (double)m[k];
	}
	sums->others += 1;
	sums->height += (float)height;
	sums->turn += (float)(2 - 2 * cosine);
}

static void add_in_plane(const gw_surfels *s, size_t surfel, size_t other, line_sums *sums)
{
	const float *p = s->position + 3 * surfel, *q = s->position + 3 * other;
	const float *n = s->normal + 3 * surfel, *m = s->normal + 3 * other;
	bool unsigned_normals = s->two_sided[surfel] || s->two_sided[other];
	double height = 0, squared = 0, cosine = 0;
	for (size_t k = 0; k < 3; k++) {
		double d = (double)p[k] - (double)q[k];
		height += (double)m[k] * d;
		squared += d * d;
		cosine += (double)n[k] * (double)m[k];
	}
	if (!(squared > 0))
		return;
	double slope = height * height / squared, weight = exp(-0.5 * slope / (IN_PLANE * IN_PLANE));
	cosine = unsigned_normals ? fabs(cosine) : cosine;
	sums->in_plane += (float)weight;
	double differs = fmax(2 - 2 * cosine, 0) - 4 * slope;
	sums->differs += (float)(weight * differs);
	sums->differs_squared += (float)(weight * differs * differs);
}

/* Heights are taken along the mean of both normals: they are 0 on circles, and the sign of the
 * neighbour's is made to fit. */
static void measure_heights(void *user, size_t surfel, const gw_neighbour_list *list)
{
	const plane_step *step = user;
	const gw_surfels *s = step->surfels;
	line_sums *sums = &step->sums[surfel];
	const float *p = s->position + 3 * surfel, *n = s->normal + 3 * surfel;
	double reach = list->count ? (double)list->distance[list->count - 1] : 0;
	*sums = (line_sums){ .reach = (float)reach };
	for (uint32_t j = 0; j < list->count && reach > 0; j++) {
		size_t other = list->index[j];
		const float *q = s->position + 3 * other, *m = s->normal + 3 * other;
		double sign, height = 0, near = (double)list->distance[j] / reach;
		add_in_plane(s, surfel, other, sums);
		if (isnan(gw_normal_difference(s, surfel, other, &sign))) {
			add_other(s, surfel, other, reach, sums);
			continue;
		}
		for (size_t k = 0; k < 3; k++)
			height += 0.5 * ((double)n[k] + sign * (double)m[k]) * ((double)q[k] - (double)p[k]);
		float x = (float)(near * near), y = (float)(height * height / (reach * reach));
		sums->count += 1;
		sums->x += x;
		sums->y += y;
		sums->xx += x * x;
		sums->xy += x * y;
		sums->yy += y * y;
	}
}

/* What all surfels of a region have in common. Distances and heights are in units of the
 * neighbours' reach. */
typedef struct region_line {
	double slope, noise; /* of the squared heights, by shape and at no distance */
	double turn;         /* variance of the normals by that noise */
	double excess;       /* mean of what mean squared heights of surfels are above the noise */
	double median;       /* of mean squared heights: of most surfels, whatever creases there are */
	bool crosses;        /* planes may be fitted over creases */
	double taken;        /* metres: noise that was taken out of places */
} region_line;

/* Mean squared height of a surfel's neighbours above what noise makes of it. */
static double excess_of(const line_sums *sums, double noise)
{
	return sums->count > 0 ? fmax((double)(sums->y / sums->count) - noise, 0) : 0;
}

static region_line fit_line(const line_sums *sums, size_t count)
{
	double n = 0, x = 0, y = 0, xx = 0, xy = 0, used = 0;
	region_line line = { 0 };
	for (size_t i = 0; i < count; i++) {
		n += (double)sums[i].count;
		x += (double)sums[i].x;
		y += (double)sums[i].y;
		xx += (double)sums[i].xx;
		xy += (double)sums[i].xy;
	}
	double determinant = n * xx - x * x;
	if (!(determinant > 0))
		return line;
	line.slope = fmax((n * xy - x * y) / determinant, 0);
	line.noise = fmax((y - line.slope * x) / n, 0);
	/* Over a disc of radius 1 the mean of x^2 is a quarter, and noise of a height is half of that
	 * of a difference of two; a normal has two axes. */
	line.turn = 2 * 0.5 * line.noise / (0.25 * (GW_NEIGHBOURS + 1));
	double t = line.turn;
	line.slope = fmax(line.slope + NOISE_SLOPE * t - NOISE_CUBED * t * t * t, 0);
	line.turn = t + NOISE_TURN * t * t;
	for (size_t i = 0; i < count; i++) {
		line.excess += excess_of(&sums[i], line.noise);
		used += sums[i].count > 0;
	}
	line.excess /= used;
	return line;
}

static double median_height(const line_sums *sums, size_t count)
{
	float height[GW_NOISE_REGION];
	size_t used = 0;
	for (size_t i = 0; i < count; i++)
		if (sums[i].count > 0)
			height[used++] = sums[i].y / sums[i].count;
	return used > 0 ? (double)gw_nth_element(height, used, used / 2) : 0;
}

/* Where a surfel and a neighbour disagree, either may be wrong: who is wrong disagrees with most of
 * its neighbours, who is right with few. Twice the share that do, at most 1, from a sum over all
 * and one of squares. */
static double fault(double count, double sum, double squares)
{
	return squares > 0 ? fmin(2 * sum * sum / (count * squares), 1) : 0;
}

/* What a surfel's own heights say of its normal, where they are far above noise: over a plane with
 * a normal that is off by a, mean squared heights along the mean of the right and the wrong normal
 * are a^2 / 8 of the squared distance. */
static double own_tilt(const line_sums *sums, double median)
{
	double above = (double)sums->y - ABOVE_MEDIAN * median * (double)sums->count;
	double own = fault((double)sums->count, (double)sums->y, (double)sums->yy);
	return above > 0 && sums->x > 0 ? own * 8 * above / (double)sums->x : 0;
}

static double of_planes(const line_sums *sums)
{
	double weight = 1 + (double)sums->in_plane, differs = fmax((double)sums->differs, 0);
	return fault(weight, differs, (double)sums->differs_squared) * differs / weight;
}

/*
 * What a surfel's normal is off because it may be the other face's of a crease: it can lie on that
 * face when it is no higher above than noise makes it, or made it before that was taken out. Halves
 * of the variance between two heights are of each of the two; of the others here the mean is taken.
 */
static double other_turn(const line_sums *sums, const region_line *line)
{
	double taken = sums->reach > 0 ? line->taken / (double)sums->reach : 0;
	double own = 0.5 * line->noise + taken * taken;
	if (!(sums->others > 0) || !(own > 0))
		return 0;
	double count = (double)sums->others, height = (double)sums->height / count;
	double variance = own * (1 + 1 / count);
	double wrong = 0.5 * exp(-0.5 * height * height / variance);
	return wrong * (double)sums->turn / count;
}

/* The slope is shared out by where the heights are: beside creases. Its own heights and
 * the planes of neighbours tell of the same, where they tell more. A plane that was found by rows
 * and columns has other noise than one through these neighbours. */
static float error_of(const line_sums *sums, const region_line *line, bool by_grid)
{
	double share = line->excess > 0 ? excess_of(sums, line->noise) / line->excess : 1;
	double bent = SLOPE_FACTOR * line->slope * share + line->turn + other_turn(sums, line);
	double planes = fmax(of_planes(sums), own_tilt(sums, line->median));
	planes = line->crosses ? planes : 0;
	return (float)sqrt(by_grid ? planes : fmax(bent, planes));
}

static bool has_grids(const gw_surfels *s, size_t first, size_t last)
{
	while (first < last && s->shading_normal_off[first] != GW_PLANE_BY_GRID)
		first++;
	return first < last;
}

gw_status gw_plane_error(gw_neighbours *search, gw_surfels *surfels, gw_error *error)
{
	size_t n = surfels->count;
	plane_step step = { surfels, gw_allocate_array(n, sizeof *step.sums) };
	if (!step.sums)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for the normals of %zu points", n);
	gw_status status = gw_neighbours_visit(search, measure_heights, &step, error);
	for (size_t first = 0; first < n && status == GW_OK; first += GW_NOISE_REGION) {
		size_t last = n - first < GW_NOISE_REGION ? n : first + GW_NOISE_REGION;
		region_line line = fit_line(step.sums + first, last - first);
		line.median = median_height(step.sums + first, last - first);
		line.taken = (double)surfels->noise_taken;
		line.crosses = line.median > HEIGHT_LEAST || has_grids(surfels, first, last);
		for (size_t i = first; i < last; i++)
			if (surfels->shading_normal_off[i] > 0)
				surfels->shading_normal_off[i] = error_of(
					&step.sums[i], &line, surfels->shading_normal_off[i] == GW_PLANE_BY_GRID);
	}
	free(step.sums);
	return status;
}
