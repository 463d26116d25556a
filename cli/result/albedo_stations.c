/* albedo_stations.c - see albedo_stations.h. */
#include "result/albedo_stations.h"

#include "result/albedo_places.h"

#include <math.h>
#include <stdlib.h>

#define SWEEPS 200

/* So many points of a station in a place have a level. */
#define MEMBERS_LEAST 3

/* A scanner on a tripod stood at so many places at most; more are the way of one that was carried,
   whose camera kept its exposure. */
#define STATIONS_MOST 64

/* Pairs of stations: how often they meet, and by how much the first is brighter, in logarithms. */
typedef struct meeting {
	double places, more[3];
} meeting;

bool albedo_stations_are_a_way(const loaded_scene *scene)
{
	const gw_points *p = &scene->points.points;
	return p->scanner_of && p->scanner_count > STATIONS_MOST;
}

static size_t station_count(const loaded_scene *scene)
{
	const gw_points *p = &scene->points.points;
	bool known = p->scanner_of && !albedo_stations_are_a_way(scene);
	return scene->input_count + (known ? p->scanner_count : 0);
}

/* From which station each point was photographed: its scanner, or without one its input. */
static void find_stations(const loaded_scene *scene, size_t stations, uint32_t *station)
{
	const uint32_t *scanner_of = scene->points.points.scanner_of;
	size_t point = 0, scanners = stations - scene->input_count;
	for (uint32_t input = 0; input < scene->input_count; input++)
		for (size_t end = point + scene->input[input].points; point < end; point++) {
			bool known = scanners > 0 && scanner_of[point] < scanners;
			station[point] = known ? (uint32_t)scene->input_count + scanner_of[point] : input;
		}
}

static size_t list_members(const gw_points *p, const uint8_t *ends, const float *level,
						   const uint32_t *station, albedo_member *list)
{
	double low[3], width = albedo_place_width(p, low);
	size_t used = 0;
	for (size_t i = 0; i < p->count; i++) {
		list[used] = (albedo_member){ .group = station[i], .point = i };
		bool known = !ends[i] && albedo_level_known(level + 3 * i);
		used += known && albedo_place_find(p->position + 3 * i, low, width, list[used].at);
	}
	albedo_members_sort(list, used);
	return used;
}

/* What the points of one station have in one place, in logarithms. */
typedef struct presence {
	uint32_t station;
	double mean[3];
} presence;

/* The stations with points enough in one place. Returns how many. */
static size_t list_presences(const albedo_member *list, size_t count, const float *level,
							 presence *here)
{
	size_t used = 0;
	for (size_t first = 0, last; first < count; first = last) {
		double sum[3] = { 0 };
		for (last = first; last < count && list[last].group == list[first].group; last++)
			for (size_t k = 0; k < 3; k++)
				sum[k] += log((double)level[3 * list[last].point + k]);
		here[used].station = list[first].group;
		for (int k = 0; k < 3; k++)
			here[used].mean[k] = sum[k] / (double)(last - first);
		used += last - first >= MEMBERS_LEAST;
	}
	return used;
}

/* One place: all pairs of its stations. */
static void meet(const presence *here, size_t count, size_t stations, meeting *meetings)
{
	for (size_t a = 0; a < count; a++)
		for (size_t b = 0; b < count; b++) {
			meeting *to = &meetings[here[a].station * stations + here[b].station];
			if (a == b)
				continue;
			to->places++;
			for (int k = 0; k < 3; k++)
				to->more[k] += here[a].mean[k] - here[b].mean[k];
		}
}

/* Gauss and Seidel: each station is moved to where those that it meets want it; the first stays. */
static void settle(const meeting *meetings, size_t stations, size_t first, double *shift)
{
	for (int sweep = 0; sweep < SWEEPS; sweep++)
		for (size_t a = 0; a < stations; a++)
			for (size_t k = 0; k < 3 && a != first; k++) {
				double sum = 0, places = 0;
				for (size_t b = 0; b < stations; b++) {
					const meeting *m = &meetings[a * stations + b];
					sum += m->places * shift[3 * b + k] - m->more[k];
					places += m->places;
				}
				if (places > 0)
					shift[3 * a + k] = sum / places;
			}
}

static void apply(const gw_points *p, const uint32_t *station, const double *shift, float *level)
{
	for (size_t i = 0; i < 3 * p->count; i++)
		level[i] *= (float)exp(shift[3 * station[i / 3] + i % 3]);
}

/* Memory for all of it. */
typedef struct leveling {
	albedo_member *list; /* count */
	uint32_t *station;   /* count */
	meeting *meetings;   /* stations squared */
	presence *here;      /* stations + 1 */
	double *shift;       /* 3 * stations */
} leveling;

static void level_stations(const gw_points *p, const uint8_t *ends, size_t stations, leveling *w,
						   float *level)
{
	size_t used = list_members(p, ends, level, w->station, w->list);
	for (size_t first = 0, last; first < used; first = last) {
		last = albedo_members_end(w->list, first, used);
		size_t here = list_presences(w->list + first, last - first, level, w->here);
		meet(w->here, here, stations, w->meetings);
	}
	settle(w->meetings, stations, p->count ? w->station[0] : 0, w->shift);
	apply(p, w->station, w->shift, level);
}

gw_status albedo_stations_level(const loaded_scene *scene, const uint8_t *ends, float *level,
								gw_error *error)
{
	size_t stations = station_count(scene), count = scene->cloud.count;
	if (stations < 2)
		return GW_OK;
	leveling w = { reallocarray(NULL, count, sizeof *w.list),
				   reallocarray(NULL, count, sizeof *w.station),
				   calloc(stations * stations, sizeof *w.meetings),
				   calloc(stations + 1, sizeof *w.here), calloc(stations, 3 * sizeof *w.shift) };
	bool good = w.list && w.station && w.meetings && w.here && w.shift;
	if (good) {
		find_stations(scene, stations, w.station);
		level_stations(&scene->points.points, ends, stations, &w, level);
	}
	free(w.list);
	free(w.station);
	free(w.meetings);
	free(w.here);
	free(w.shift);
	return good ? GW_OK
				: gw_fail(error, GW_ERROR_MEMORY, "no memory for the exposures of the stations");
}
