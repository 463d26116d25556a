#include "verbs/info_facts.h"
#include "verbs/verbs.h"
#include "program/json_writer.h"
#include "program/text_quote.h"
#include "scene/floor_places.h"

#include <inttypes.h>
#include <stdlib.h>

/* ---------------------------------------------------------------------------------- places */

static void print_place(const settings *s, json_writer *json, const char *kind, size_t number,
						const double at[3])
{
	char name[64];
	snprintf(name, sizeof name, "%s:%zu", kind, number);
	if (!s->json) {
		printf("  %-12s %.12g %.12g %.12g\n", name, at[0], at[1], at[2]);
		return;
	}
	json_put_open_flat(json, NULL, '{');
	json_put_text(json, "name", name);
	json_put_reals(json, "position", at, 3);
	json_put_close(json, '}');
}

/* Scanners, and floor where somebody can stand, in the file's coordinates. */
static gw_status list_places(const settings *s, const info_facts *f, gw_error *error)
{
	double floor_at[3 * FLOOR_PLACES_MAX];
	size_t floors;
	json_writer json = { .out = stdout };
	GW_TRY(
		floor_places_find(f->of_points.position, f->cloud.count, f->up, floor_at, &floors, error));
	if (s->json) {
		json_put_open(&json, NULL, '{');
		json_put_text(&json, "file", f->name);
		json_put_open(&json, "places", '[');
	} else {
		text_message(stdout, "%s\n", f->name);
	}
	for (size_t i = 0; i < f->cloud.scanner_count; i++)
		print_place(s, &json, "scanner", i + 1, f->cloud.scanner + 3 * i);
	for (size_t i = 0; i < floors; i++) {
		coordinates_from_metres(&f->place, floor_at + 3 * i);
		print_place(s, &json, "floor", i + 1, floor_at + 3 * i);
	}
	if (s->json) {
		json_put_close(&json, ']');
		json_put_close(&json, '}');
		putchar('\n');
	} else if (f->cloud.scanner_count + floors == 0) {
		printf("  none: no scanner is known, and no floor is free to %g m\n", FLOOR_HEAD);
	}
	return GW_OK;
}

/* --------------------------------------------------------------------------------- the verb */

static gw_status describe_file(const settings *s, const char *path, gw_error *error)
{
	info_facts facts;
	gw_status status = info_facts_find(s, path, &facts, error);
	if (status == GW_OK && s->places)
		status = list_places(s, &facts, error);
	else if (status == GW_OK && s->json)
		info_facts_print_json(&facts);
	else if (status == GW_OK)
		info_facts_print(&facts);
	info_facts_clear(&facts);
	return status;
}

static void print_device(const gw_device_info *d, size_t index, bool as_json)
{
	if (!as_json) {
		printf("%zu  %s (%s), %.1f GB, %s%s%s\n", index, d->name, d->type, (double)d->memory * 1e-9,
			   d->driver, d->usable ? "" : "; not usable: ", d->usable ? "" : d->missing);
		return;
	}
	json_writer json = { .out = stdout };
	json_put_open(&json, NULL, '{');
	json_put_count(&json, "index", index);
	json_put_text(&json, "name", d->name);
	json_put_text(&json, "type", d->type);
	json_put_text(&json, "driver", d->driver);
	json_put_count(&json, "memory", d->memory);
	json_put_count(&json, "subgroup_size", d->subgroup_size);
	json_put_bool(&json, "usable", d->usable);
	if (!d->usable)
		json_put_text(&json, "missing", d->missing);
	json_put_close(&json, '}');
	putchar('\n');
}

static gw_status list_devices(const settings *s, gw_error *error)
{
	gw_device_info *device;
	size_t count;
	GW_TRY(gw_devices(&device, &count, error));
	for (size_t i = 0; i < count; i++)
		print_device(&device[i], i, s->json);
	free(device);
	if (count == 0)
		return gw_fail(error, GW_ERROR_NO_DEVICE,
					   "there is no Vulkan device; the package mesa-vulkan-drivers has one that "
					   "runs on any processor");
	return GW_OK;
}

gw_status verb_info(const settings *s, gw_error *error)
{
	if (s->devices && (s->input_count > 0 || s->places))
		return gw_fail(error, GW_ERROR_USAGE, "--devices takes no files and lists no places");
	if (s->places && s->stats)
		return gw_fail(error, GW_ERROR_USAGE,
					   "--places lists places and nothing else; --stats is for another run");
	if (s->devices)
		return list_devices(s, error);
	if (s->input_count == 0)
		return gw_fail(error, GW_ERROR_USAGE,
					   "describe what? Name files, - for standard input, or --devices");
	for (size_t i = 0; i < s->input_count; i++)
		GW_TRY(describe_file(s, s->input[i].path, error));
	return GW_OK;
}
