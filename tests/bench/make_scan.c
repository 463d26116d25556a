/*
 * make_scan - writes what scanners bring home from a scene of known light, with the faults of real
 * scans, and the light that a path tracer finds where the beams met the surface.
 *
 *   build/tests/bench/make_scan KIND -o PREFIX [option]...
 *   build/tests/bench/make_scan --errors LIT.ply PREFIX.truth.ply
 *
 * The cloud is PREFIX.ply, .ptx or .e57, or PREFIX-1.pcd and so on, one for each station;
 * PREFIX.scene.json has its lamps, PREFIX.stations.txt a line X Y Z for each station, and
 * PREFIX.truth.ply the light of a random part of the points (the columns of make_truth) and the
 * true normals, true_nx true_ny true_nz. Mixed pixels and strays are on no surface and have no
 * truth. Points are matched by a column `index`, or, in PTX and E57, which have no room for one,
 * by position.
 *
 * The second form prints three numbers, in percent: the RMS error of these points' radiance in a
 * lit cloud, over the truth's mean, of all and without the worst hundredth; and the share whose
 * normal faces as the true one does. What the truth itself is off, which its column scalar_stderr
 * tells without bias, is taken off the squares of the errors.
 */
#include "comparison/matched_scans.h"
#include "files/file_status.h"
#include "files/number_text.h"
#include "program/exit_code.h"
#include "sample_scans.h"
#include "simulated_scan.h"
#include "table/format_table.h"

#include "truth_files.h"

#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define PI 3.14159265358979323846

typedef struct maker {
	mesh_kind kind;
	const char *prefix, *format;
	scan_setup setup;
	size_t truth_count;
	uint32_t paths;
	bool normals, no_poses;
	mesh_scene scene;
	simulated_scan scan;
	truth_places truth;
	gw_error error;
} maker;

static const char usage[] =
	"Usage: make_scan KIND -o PREFIX [option]...\n"
	"       make_scan --errors LIT.ply PREFIX.truth.ply\n"
	"KIND is cornell, rooms, corridor, hole, ruin, cave, ball, carton, torus, terrain, fence or\n"
	"tree.\n"
	"  -o, --output PREFIX     write PREFIX.ply, PREFIX.scene.json, PREFIX.truth.ply and so on\n"
	"  -f, --format NAME       ply, pcd (grids, a file for each station), ptx or e57 (ply)\n"
	"  -n, --points N          points of the cloud, about (50000)\n"
	"  -t, --truth N           points of the truth (2000)\n"
	"  -p, --paths N           paths a point of the truth (256)\n"
	"      --camera            depth cameras instead of scanners\n"
	"      --rows N            of each station, as beams of scanners that turn (as even as "
	"columns)\n"
	"      --carried N         one scanner of N poses on a way through the scene, in PLY (0)\n"
	"      --normals           write the true normals, in PLY and PCD\n"
	"      --no-poses          E57 in the world's frame, and PCD without a viewpoint\n"
	"      --noise X           standard deviation of the range, mm (0)\n"
	"      --noise-growth X    mm more of it a metre of range (0)\n"
	"      --beam X            diameter of the beam, mm, for mixed pixels (0)\n"
	"      --divergence X      of the beam, mrad (0)\n"
	"      --step X            ranges come in steps, mm; of a camera, at 1 m (0)\n"
	"      --registration X    each station is off by so many mm (0)\n"
	"      --turn X            each station is turned by so many degrees, about (0)\n"
	"      --strays X          share of points that lie anywhere along their beams (0)\n"
	"      --holes N           places of which no beam comes back (0)\n"
	"      --seed N            (1)\n";

/* ------------------------------------------------------------------------------ arguments */

/* Options that are a number, where it goes and what it is multiplied by. */
typedef struct number_option {
	const char *name;
	double *to, scale;
} number_option;

static bool read_number(const char *text, double *value)
{
	size_t length = strlen(text), used = number_read(text, length, value);
	return used > 0 && used == length && *value >= 0.0 && *value <= 1e9;
}

static bool set_fault(scan_faults *f, const char *name, double value)
{
	const number_option known[] = {
		{ "noise", &f->range_noise, 1e-3 },
		{ "noise-growth", &f->noise_growth, 1e-3 },
		{ "beam", &f->beam_width, 1e-3 },
		{ "divergence", &f->beam_divergence, 1e-3 },
		{ "step", &f->step, 1e-3 },
		{ "registration", &f->registration, 1e-3 },
		{ "turn", &f->registration_turn, 1.0 },
		{ "strays", &f->strays, 1.0 },
	};
	for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
		if (strcmp(known[i].name, name) != 0)
			continue;
		*known[i].to = value * known[i].scale;
		return true;
	}
	return false;
}

static bool set_option(maker *m, const char *name, const char *text)
{
	double value = 0.0;
	if (strcmp(name, "output") == 0)
		m->prefix = text;
	else if (strcmp(name, "format") == 0)
		m->format = text;
	else if (strcmp(name, "camera") == 0)
		m->setup.camera = true;
	else if (strcmp(name, "normals") == 0)
		m->normals = true;
	else if (strcmp(name, "no-poses") == 0)
		m->no_poses = true;
	else if (!text || !read_number(text, &value))
		return false;
	else if (strcmp(name, "points") == 0)
		m->setup.count = (size_t)value;
	else if (strcmp(name, "truth") == 0)
		m->truth_count = (size_t)value;
	else if (strcmp(name, "paths") == 0)
		m->paths = (uint32_t)value;
	else if (strcmp(name, "rows") == 0)
		m->setup.rows = (size_t)value;
	else if (strcmp(name, "carried") == 0)
		m->setup.poses = (size_t)value;
	else if (strcmp(name, "holes") == 0)
		m->setup.faults.holes = (uint32_t)value;
	else if (strcmp(name, "seed") == 0)
		m->setup.seed = (uint64_t)value;
	else
		return set_fault(&m->setup.faults, name, value);
	return true;
}

static bool is_one_of(const char *text, const char *const *list)
{
	while (*list && strcmp(*list, text) != 0)
		list++;
	return *list;
}

static bool read_arguments(maker *m, int count, char **argument)
{
	static const char *const formats_known[] = { "ply", "pcd", "ptx", "e57", NULL };
	static const struct option long_option[] = {
		{ "output", required_argument, NULL, 'o' },
		{ "format", required_argument, NULL, 'f' },
		{ "points", required_argument, NULL, 'n' },
		{ "truth", required_argument, NULL, 't' },
		{ "paths", required_argument, NULL, 'p' },
		{ "camera", no_argument, NULL, 1 },
		{ "rows", required_argument, NULL, 1 },
		{ "normals", no_argument, NULL, 1 },
		{ "carried", required_argument, NULL, 1 },
		{ "no-poses", no_argument, NULL, 1 },
		{ "noise", required_argument, NULL, 1 },
		{ "noise-growth", required_argument, NULL, 1 },
		{ "beam", required_argument, NULL, 1 },
		{ "divergence", required_argument, NULL, 1 },
		{ "step", required_argument, NULL, 1 },
		{ "registration", required_argument, NULL, 1 },
		{ "turn", required_argument, NULL, 1 },
		{ "strays", required_argument, NULL, 1 },
		{ "holes", required_argument, NULL, 1 },
		{ "seed", required_argument, NULL, 1 },
		{ NULL, 0, NULL, 0 },
	};
	int option, which = 0, kind = 0;
	while ((option = getopt_long(count, argument, "o:f:n:t:p:", long_option, &which)) != -1) {
		for (int i = 0; option > 1 && long_option[i].name; i++)
			which = long_option[i].val == option ? i : which;
		if (option == '?' || !set_option(m, long_option[which].name, optarg))
			return false;
	}
	while (optind < count && mesh_kind_name(kind) &&
		   strcmp(mesh_kind_name(kind), argument[optind]) != 0)
		kind++;
	m->kind = (mesh_kind)kind;
	return m->prefix && m->setup.count > 0 && optind == count - 1 && kind < MESH_KINDS &&
		   is_one_of(m->format, formats_known);
}

static bool is_grid(const maker *m)
{
	return strcmp(m->format, "ptx") == 0 || strcmp(m->format, "e57") == 0;
}

static gw_status check_format(maker *m)
{
	if (m->setup.poses > 0 && (m->setup.camera || strcmp(m->format, "ply") != 0))
		return gw_fail(&m->error, GW_ERROR_USAGE, "a scanner that is carried has no grid; use ply");
	if (is_grid(m) && truth_has_emission(&m->scene))
		return gw_fail(&m->error, GW_ERROR_USAGE,
					   "surfaces of this scene glow, which %s files can't say; use ply or pcd",
					   m->format);
	if (is_grid(m) && m->normals)
		return gw_fail(&m->error, GW_ERROR_USAGE, "%s files have no normals; use ply or pcd",
					   m->format);
	return GW_OK;
}

/* --------------------------------------------------------------------------------- points */

/* A cell's place in its station's frame. */
static void cell_place(const maker *m, const station_scan *s, size_t cell, double own[3])
{
	station_scan_direction(s, &m->setup, cell / s->rows, cell % s->rows, own);
	for (size_t k = 0; k < 3; k++)
		own[k] *= s->cell[cell].range;
}

/* Cells of one or all stations as points of a cloud. */
typedef struct cell_list {
	size_t count;
	const station_scan **station; /* owned, as are the next */
	size_t *cell;
	double *position;   /* 3 each; NaN where empty */
	uint32_t *triangle; /* 0 where empty */
} cell_list;

static void clear_cells(cell_list *l)
{
	free(l->station);
	free(l->cell);
	free(l->position);
	free(l->triangle);
	*l = (cell_list){ 0 };
}

static void take_cell(const maker *m, const station_scan *s, size_t cell, cell_list *l)
{
	size_t i = l->count++;
	double own[3], *world = l->position + 3 * i;
	l->station[i] = s;
	l->cell[i] = cell;
	l->triangle[i] = s->cell[cell].triangle;
	world[0] = world[1] = world[2] = NAN;
	if (s->cell[cell].kind == CELL_EMPTY)
		return;
	cell_place(m, s, cell, own);
	station_scan_to_world(s, own, world);
}

/* Stations [first, last), column after column, or row after row with the uppermost first, as
 * pictures are. */
static gw_status list_cells(maker *m, size_t first, size_t last, bool picture, cell_list *l)
{
	size_t most = 1;
	*l = (cell_list){ 0 };
	for (size_t i = first; i < last; i++)
		most += m->scan.station[i].columns * m->scan.station[i].rows;
	l->station = reallocarray(NULL, most, sizeof *l->station);
	l->cell = reallocarray(NULL, most, sizeof *l->cell);
	l->position = reallocarray(NULL, most, 3 * sizeof *l->position);
	l->triangle = reallocarray(NULL, most, sizeof *l->triangle);
	if (!l->station || !l->cell || !l->position || !l->triangle) {
		clear_cells(l);
		return gw_fail(&m->error, GW_ERROR_MEMORY, "no memory for %zu points", most);
	}
	for (size_t i = first; i < last; i++) {
		const station_scan *s = &m->scan.station[i];
		for (size_t c = 0; c < s->columns * s->rows; c++) {
			size_t column = s->columns - 1 - c % s->columns, row = s->rows - 1 - c / s->columns;
			size_t cell = picture ? column * s->rows + row : c;
			if (picture || s->cell[cell].kind != CELL_EMPTY)
				take_cell(m, s, cell, l);
		}
	}
	return GW_OK;
}

static gw_status add_triple(maker *m, scan *cloud, const char *const name[3], const double *value)
{
	for (size_t k = 0; k < 3; k++) {
		scan_column *to = scan_add_column(cloud, name[k], SCAN_FLOAT64, &m->error);
		if (!to)
			return m->error.status;
		for (size_t i = 0; i < cloud->count; i++)
			((double *)to->data)[i] = value[3 * i + k];
	}
	return GW_OK;
}

static gw_status add_positions(maker *m, scan *cloud, const double *position)
{
	static const char *const name[3] = { "x", "y", "z" };
	return add_triple(m, cloud, name, position);
}

static gw_status add_normals(maker *m, scan *cloud, const char *const name[3],
							 const uint32_t *triangle)
{
	for (size_t k = 0; k < 3; k++) {
		scan_column *to = scan_add_column(cloud, name[k], SCAN_FLOAT32, &m->error);
		if (!to)
			return m->error.status;
		for (size_t i = 0; i < cloud->count; i++)
			((float *)to->data)[i] = (float)m->scene.triangle[triangle[i]].normal[k];
	}
	return GW_OK;
}

static gw_status add_colors(maker *m, scan *cloud, const uint32_t *triangle)
{
	static const char *const name[3] = { "red", "green", "blue" };
	for (size_t k = 0; k < 3; k++) {
		scan_column *to = scan_add_column(cloud, name[k], SCAN_UINT8, &m->error);
		if (!to)
			return m->error.status;
		for (size_t i = 0; i < cloud->count; i++)
			((uint8_t *)to->data)[i] = m->scene.triangle[triangle[i]].color[k];
	}
	return GW_OK;
}

static gw_status add_index(maker *m, scan *cloud, const uint32_t *index, size_t first)
{
	scan_column *to = scan_add_column(cloud, "index", SCAN_UINT32, &m->error);
	for (size_t i = 0; to && i < cloud->count; i++)
		((uint32_t *)to->data)[i] = index ? index[i] : (uint32_t)(first + i);
	return to ? GW_OK : m->error.status;
}

/* ----------------------------------------------------------------------------------- truth */

/*
 * Chooses about as many of a list's points on surface as are due, each with the same chance.
 *   first    index of the list's first point in the cloud
 *   position of the list's points as the cloud's file has them
 */
static void choose(maker *m, const cell_list *l, size_t first, const double *position)
{
	double share = (double)m->truth_count / (double)m->scan.count;
	uint64_t state = m->setup.seed + 99 + first;
	for (size_t i = 0; i < l->count && m->truth.count < m->truth_count; i++) {
		const scan_cell *cell = &l->station[i]->cell[l->cell[i]];
		state = state * 6364136223846793005u + 1442695040888963407u;
		if (cell->kind != CELL_SURFACE || (double)(state >> 11) * 0x1p-53 >= share)
			continue;
		size_t n = m->truth.count++;
		m->truth.index[n] = (uint32_t)(first + i);
		memcpy(m->truth.position + 3 * n, position + 3 * i, 3 * sizeof *position);
		memcpy(m->truth.surface + 3 * n, cell->surface, sizeof cell->surface);
		m->truth.triangle[n] = cell->triangle;
	}
}

static gw_status write_truth(maker *m)
{
	static const char *const name[3] = { "true_nx", "true_ny", "true_nz" };
	const truth_tracing how = { m->paths, 0, m->setup.seed };
	gw_status status = truth_trace(&m->scene, &how, m->prefix, &m->truth, &m->error);
	scan cloud = { .count = m->truth.count, .up = 'z' };
	if (status == GW_OK)
		status = add_positions(m, &cloud, m->truth.position);
	if (status == GW_OK && !is_grid(m))
		status = add_index(m, &cloud, m->truth.index, 0);
	if (status == GW_OK)
		status = add_normals(m, &cloud, name, m->truth.triangle);
	if (status == GW_OK)
		status = truth_add_emission(&m->scene, m->truth.triangle, &cloud, &m->error);
	if (status == GW_OK)
		status = truth_add_light(&m->scene, &m->truth, &cloud, &m->error);
	if (status == GW_OK)
		return truth_write_cloud(m->prefix, ".truth.ply", "ply", &cloud, &m->error);
	scan_clear(&cloud);
	return status;
}

/* --------------------------------------------------------------------------------- clouds */

/* Writes a list of cells as PLY or PCD. */
static gw_status write_cells(maker *m, const cell_list *l, size_t first, const char *suffix)
{
	static const char *const normal[3] = { "nx", "ny", "nz" };
	bool picture = strcmp(m->format, "pcd") == 0;
	scan cloud = { .count = l->count, .up = 'z' };
	gw_status status = add_positions(m, &cloud, l->position);
	if (status == GW_OK && m->normals)
		status = add_normals(m, &cloud, normal, l->triangle);
	if (status == GW_OK)
		status = add_colors(m, &cloud, l->triangle);
	if (status == GW_OK)
		status = add_index(m, &cloud, NULL, first);
	if (status == GW_OK && truth_has_emission(&m->scene))
		status = truth_add_emission(&m->scene, l->triangle, &cloud, &m->error);
	if (status == GW_OK && picture && !m->no_poses)
		status = scan_add_scanner(&cloud, l->station[0]->own, 0, cloud.count, &m->error);
	if (status == GW_OK)
		return truth_write_cloud(m->prefix, suffix, m->format, &cloud, &m->error);
	scan_clear(&cloud);
	return status;
}

/* The writer knows no grids: says in a PCD file that it is one. */
static gw_status say_grid(maker *m, const char *suffix, const station_scan *s)
{
	char path[4096], text[64];
	snprintf(path, sizeof path, "%s%s", m->prefix, suffix);
	FILE *file = fopen(path, "r+b"), *copy = file ? tmpfile() : NULL;
	bool good = copy;
	char *line = NULL;
	size_t room = 0;
	ssize_t length;
	while (good && (length = getline(&line, &room, file)) > 0) {
		if (strncmp(line, "WIDTH ", 6) == 0)
			length = snprintf(text, sizeof text, "WIDTH %zu\n", s->columns);
		else if (strncmp(line, "HEIGHT ", 7) == 0)
			length = snprintf(text, sizeof text, "HEIGHT %zu\n", s->rows);
		else
			text[0] = '\0';
		good = fwrite(text[0] ? text : line, 1, (size_t)length, copy) == (size_t)length;
	}
	free(line);
	good = good && fseek(copy, 0, SEEK_SET) == 0 && fseek(file, 0, SEEK_SET) == 0;
	for (int c; good && (c = getc(copy)) != EOF;)
		good = putc(c, file) != EOF;
	good = good && fflush(file) == 0 && ftruncate(fileno(file), ftell(file)) == 0;
	if (copy)
		fclose(copy);
	if (file)
		fclose(file);
	return good ? GW_OK : gw_fail(&m->error, FILE_ERROR_IO, "could not write %s", path);
}

static gw_status write_lists(maker *m)
{
	bool pcd = strcmp(m->format, "pcd") == 0;
	static char text[MESH_STATIONS][16];
	const char *suffix[MESH_STATIONS] = { ".ply" };
	size_t parts = pcd ? m->scan.station_count : 1, first = 0;
	gw_status status = GW_OK;
	for (size_t i = 0; i < parts && status == GW_OK; i++) {
		cell_list l;
		if (pcd)
			snprintf(text[i], sizeof text[i], "-%zu.pcd", i + 1);
		suffix[i] = pcd ? text[i] : ".ply";
		status = list_cells(m, i, pcd ? i + 1 : m->scan.station_count, pcd, &l);
		if (status == GW_OK)
			status = write_cells(m, &l, first, suffix[i]);
		if (status == GW_OK && pcd)
			status = say_grid(m, suffix[i], &m->scan.station[i]);
		if (status == GW_OK)
			choose(m, &l, first, l.position);
		first += l.count;
		clear_cells(&l);
	}
	const double origin[3] = { 0 };
	return status == GW_OK
			   ? truth_write_scene(m->prefix, suffix, parts, &m->scene, origin, &m->error)
			   : status;
}

static void fill_grid(const maker *m, const station_scan *s, sample_scan *to)
{
	bool own_frame = !m->no_poses || strcmp(m->format, "e57") != 0;
	for (size_t k = 0; k < 9; k++)
		to->rotation[k] = own_frame ? s->axes[k] : k % 4 == 0;
	for (size_t k = 0; k < 3; k++)
		to->translation[k] = own_frame ? s->own[k] : 0.0;
	for (size_t c = 0; c < s->columns * s->rows; c++) {
		sample_cell *cell = &to->cell[c];
		double own[3];
		*cell = (sample_cell){ .hole = s->cell[c].kind == CELL_EMPTY, .intensity = 0.5f };
		if (cell->hole)
			continue;
		cell_place(m, s, c, own);
		if (own_frame)
			memcpy(cell->position, own, sizeof own);
		else
			station_scan_to_world(s, own, cell->position);
		memcpy(cell->color, m->scene.triangle[s->cell[c].triangle].color, sizeof cell->color);
	}
}

/* Positions as a reader finds them, for matching. */
static gw_status read_back(maker *m, const char *path, cell_list *l)
{
	static const char *const name[3] = { "x", "y", "z" };
	scan cloud;
	gw_status status = format_read(path, NULL, &cloud, &m->error);
	if (status != GW_OK)
		return status;
	if (cloud.count != l->count)
		status = gw_fail(&m->error, GW_ERROR_INTERNAL, "%s has %zu points, not %zu", path,
						 cloud.count, l->count);
	for (size_t k = 0; k < 3 && status == GW_OK; k++)
		for (size_t i = 0; i < l->count; i++)
			l->position[3 * i + k] = scan_value(scan_find(&cloud, name[k]), i);
	scan_clear(&cloud);
	return status;
}

static gw_status write_grids(maker *m)
{
	char path[4096], suffix_text[8];
	bool ptx = strcmp(m->format, "ptx") == 0;
	size_t count = m->scan.station_count;
	sample_scan grid[MESH_STATIONS] = { 0 };
	for (size_t i = 0; i < count; i++) {
		const station_scan *s = &m->scan.station[i];
		grid[i] = (sample_scan){ .name = "station", .columns = s->columns, .rows = s->rows };
		grid[i].cell = calloc(s->columns * s->rows, sizeof *grid[i].cell);
		if (grid[i].cell)
			fill_grid(m, s, &grid[i]);
		else
			m->error.status = GW_ERROR_MEMORY;
	}
	snprintf(suffix_text, sizeof suffix_text, ".%s", m->format);
	snprintf(path, sizeof path, "%s%s", m->prefix, suffix_text);
	if (m->error.status == GW_OK && (ptx ? sample_write_ptx(grid, count, path)
										 : sample_write_e57(grid, count, path, "make_scan")) != 0)
		gw_fail(&m->error, FILE_ERROR_IO, "could not write %s", path);
	sample_scans_clear(grid, count);
	const char *const suffix[1] = { suffix_text };
	const double origin[3] = { 0 };
	cell_list l = { 0 };
	gw_status status = m->error.status;
	if (status == GW_OK)
		status = list_cells(m, 0, count, false, &l);
	if (status == GW_OK)
		status = read_back(m, path, &l);
	if (status == GW_OK)
		choose(m, &l, 0, l.position);
	clear_cells(&l);
	return status == GW_OK ? truth_write_scene(m->prefix, suffix, 1, &m->scene, origin, &m->error)
						   : status;
}

static gw_status write_stations(maker *m)
{
	char path[4096];
	snprintf(path, sizeof path, "%s.stations.txt", m->prefix);
	FILE *file = fopen(path, "w");
	for (size_t i = 0; file && i < m->scan.station_count; i++) {
		const double *p = m->scan.station[i].own;
		fprintf(file, "%.6f %.6f %.6f\n", p[0], p[1], p[2]);
	}
	return file && fclose(file) == 0
			   ? GW_OK
			   : gw_fail(&m->error, FILE_ERROR_IO, "could not write %s", path);
}

static void report(const maker *m)
{
	size_t kind[4] = { 0 };
	for (size_t i = 0; i < m->scan.station_count; i++)
		for (size_t c = 0; c < m->scan.station[i].columns * m->scan.station[i].rows; c++)
			kind[m->scan.station[i].cell[c].kind]++;
	fprintf(stderr, "%s: %zu points, %zu mixed pixels and %zu strays among them\n", m->prefix,
			m->scan.count, kind[CELL_MIXED], kind[CELL_STRAY]);
}

static gw_status run(maker *m)
{
	gw_status status = mesh_scene_make(m->kind, &m->scene, &m->error);
	if (status == GW_OK)
		status = check_format(m);
	if (status == GW_OK)
		status = simulated_scan_make(&m->scene, &m->setup, &m->scan, &m->error);
	if (status == GW_OK)
		status = truth_places_make(&m->truth, m->truth_count, &m->error);
	m->truth.count = 0;
	if (status == GW_OK)
		status = write_stations(m);
	if (status == GW_OK)
		status = is_grid(m) ? write_grids(m) : write_lists(m);
	if (status != GW_OK)
		return status;
	report(m);
	return write_truth(m);
}

/* -------------------------------------------------------------------------------- against truth */

/* A lit scan beside its truth, column by column; values of matched points. */
typedef struct light_pair {
	const matched_scans *match;
	const scan_column *normal[6], *radiance[6], *noise;
	gw_error *error;
} light_pair;

static gw_status find_columns(light_pair *p)
{
	static const char *const name[6] = { "nx", "ny", "nz", "true_nx", "true_ny", "true_nz" };
	static const char *const light[3] = { "scalar_radiance_r", "scalar_radiance_g",
										  "scalar_radiance_b" };
	const matched_scans *m = p->match;
	bool whole = true;
	for (size_t k = 0; k < 6; k++) {
		const scan *of = k < 3 ? m->found : m->truth;
		p->normal[k] = scan_find(of, name[k]);
		p->radiance[k] = scan_find(of, light[k % 3]);
		whole = whole && p->normal[k] && p->radiance[k];
	}
	p->noise = scan_find(m->truth, "scalar_stderr");
	return whole && p->noise ? GW_OK
							 : gw_fail(p->error, GW_ERROR_DATA,
									   "%s is not lit, or %s is no truth of this program",
									   m->found_name, m->truth_name);
}

static double luminance_of(const scan_column *const column[3], size_t i)
{
	return 0.2126 * scan_value(column[0], i) + 0.7152 * scan_value(column[1], i) +
		   0.0722 * scan_value(column[2], i);
}

static gw_status print_errors(light_pair *p)
{
	const matched_scans *m = p->match;
	double mean = 0.0, bias = 0.0, square = 0.0, right = 0.0;
	GW_TRY(find_columns(p));
	for (size_t i = 0; i < m->count; i++) {
		double cosine = 0.0, truth = luminance_of(p->radiance + 3, m->in_truth[i]);
		double off = luminance_of(p->radiance, m->in_found[i]) - truth;
		double noise = scan_value(p->noise, m->in_truth[i]);
		for (size_t k = 0; k < 3; k++)
			cosine += scan_value(p->normal[k], m->in_found[i]) *
					  scan_value(p->normal[k + 3], m->in_truth[i]);
		right += cosine > 0.0;
		mean += truth;
		bias += off;
		square += off * off - noise * noise;
	}
	double n = (double)m->count;
	printf("%.2f %.2f %.2f\n", 100.0 * sqrt(fmax(square * n, 0.0)) / mean, 100.0 * bias / mean,
		   100.0 * right / n);
	return GW_OK;
}

static gw_status compare_errors(const char *lit, const char *truth, gw_error *error)
{
	scan found = { 0 }, wanted = { 0 };
	gw_status status = format_read(lit, NULL, &found, error);
	if (status == GW_OK)
		status = format_read(truth, NULL, &wanted, error);
	matched_scans pair = {
		.found = &found, .truth = &wanted, .found_name = lit, .truth_name = truth
	};
	if (status == GW_OK)
		status = matched_scans_make(&pair, error);
	light_pair lights = { .match = &pair, .error = error };
	if (status == GW_OK)
		status = print_errors(&lights);
	matched_scans_clear(&pair);
	scan_clear(&found);
	scan_clear(&wanted);
	return status;
}

int main(int count, char **argument)
{
	maker m = {
		.format = "ply", .setup = { .count = 50000, .seed = 1 }, .truth_count = 2000, .paths = 256
	};
	gw_status status;
	if (count == 4 && strcmp(argument[1], "--errors") == 0) {
		status = compare_errors(argument[2], argument[3], &m.error);
	} else if (!read_arguments(&m, count, argument)) {
		fputs(usage, stderr);
		return EXIT_CODE_USAGE;
	} else {
		status = run(&m);
	}
	if (status != GW_OK)
		fprintf(stderr, "make_scan: %s\n", m.error.text);
	simulated_scan_clear(&m.scan);
	mesh_scene_clear(&m.scene);
	truth_places_clear(&m.truth);
	return exit_code_of(status, 0);
}
