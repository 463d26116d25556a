#include "fuzz_reader.h"
#include "e57_file.h"
#include "table/format_table.h"
#include "luminaires/luminaire.h"
#include "panoramas/panorama.h"
#include "scan_sum.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Maps of the sky hold no scan; what is left of it is empty. */
static gw_status use_map(gw_status status, panorama *map, scan *cloud)
{
	volatile float sum = 0.0f;
	*cloud = (scan){ 0 };
	for (size_t i = 0; status == GW_OK && i < 3 * (size_t)map->width * map->height; i++)
		sum += map->pixels[i];
	panorama_clear(map);
	return status;
}

static gw_status read_hdr(input_file *in, scan *cloud, gw_error *error)
{
	panorama map;
	gw_status status = panorama_hdr_read(in, &map, error);
	return use_map(status, &map, cloud);
}

static gw_status read_exr(input_file *in, scan *cloud, gw_error *error)
{
	panorama map;
	gw_status status = panorama_exr_read(in, &map, error);
	return use_map(status, &map, cloud);
}

/* So do luminaires; all that is worked out of them is. */
static gw_status use_luminaire(gw_status status, luminaire *l, scan *cloud)
{
	*cloud = (scan){ 0 };
	if (status == GW_OK) {
		volatile double sum = luminaire_measure(l).lumens + luminaire_tilt_factor(l, 33.0);
		(void)sum;
	}
	luminaire_clear(l);
	return status;
}

static gw_status read_ies(input_file *in, scan *cloud, gw_error *error)
{
	luminaire l;
	gw_status status = luminaire_ies_read(in, &l, error);
	return use_luminaire(status, &l, cloud);
}

static gw_status read_ldt(input_file *in, scan *cloud, gw_error *error)
{
	luminaire l;
	gw_status status = luminaire_eulumdat_read(in, &l, error);
	return use_luminaire(status, &l, cloud);
}

static const fuzz_reader others[] = {
	{ "hdr", read_hdr, false },           { "exr", read_exr, false },
	{ "mesh-obj", seed_read_obj, false }, { "mesh-off", seed_read_off, false },
	{ "mtl", seed_read_mtl, false },      { "mesh-ply", seed_read_mesh_ply, false },
	{ "mesh-glb", seed_read_glb, false }, { "ies", read_ies, false },
	{ "ldt", read_ldt, false },
};

bool fuzz_reader_at(size_t index, fuzz_reader *reader)
{
	for (size_t f = 0; formats[f]; f++) {
		if (!formats[f]->read)
			continue;
		if (index-- == 0) {
			const char *name = formats[f]->name;
			*reader = (fuzz_reader){ name, formats[f]->read, strcmp(name, "e57") == 0 };
			return true;
		}
	}
	if (index >= sizeof others / sizeof *others)
		return false;
	*reader = others[index];
	return true;
}

bool fuzz_reader_find(const char *name, fuzz_reader *reader)
{
	for (size_t i = 0; fuzz_reader_at(i, reader); i++)
		if (strcmp(reader->name, name) == 0)
			return true;
	return false;
}

static void check_refusal(const scan *cloud, gw_status status, const gw_error *error,
						  char complaint[GW_ERROR_TEXT])
{
	if (cloud->column || cloud->comment || cloud->scanner || cloud->count)
		snprintf(complaint, GW_ERROR_TEXT, "refused, but something is left in the scan");
	else if (status == GW_ERROR_DATA && !strstr(error->text, "seed.file"))
		snprintf(complaint, GW_ERROR_TEXT, "refused without the file's name: %.900s", error->text);
}

gw_status fuzz_reader_attempt(const fuzz_reader *reader, const uint8_t *data, size_t length,
							  char complaint[GW_ERROR_TEXT])
{
	complaint[0] = '\0';
	uint8_t *copy = malloc(reader->sealed ? E57_FILE_PAGES(length) : length + !length);
	if (!copy)
		return GW_ERROR_MEMORY;
	if (reader->sealed)
		length = e57_file_pages(data, length, SIZE_MAX, copy);
	else if (length > 0)
		memcpy(copy, data, length);
	input_file in = { .name = "seed.file", .data = copy, .length = length, .threads = 1 };
	scan cloud = { 0 };
	gw_error error = { 0 };
	gw_status status = reader->read(&in, &cloud, &error);
	free(copy);
	if (status == GW_OK) {
		volatile double sum = scan_sum_of_all(&cloud);
		(void)sum;
		scan_clear(&cloud);
	} else {
		check_refusal(&cloud, status, &error, complaint);
	}
	return status;
}
