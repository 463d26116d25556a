/* input_notes.c - see input_notes.h. */
#include "scene/input_notes.h"

#include "program/text_quote.h"
#include "scene/mesh_notes.h"

#include <stdio.h>
#include <string.h>

#define ALBEDO_DARK 0.03   /* mean of charcoal; no scan of a place is darker */
#define ALBEDO_BRIGHT 0.85 /* of fresh snow */
#define ALBEDO_USUAL 0.2   /* of most places */

/* What was told of colours by their values alone, and what looks wrong with them as a whole. */
static void note_colors(const settings *s, const loaded_input *input)
{
	const char *name = loaded_scene_input_name(input->path);
	double mean = input->albedo_mean;
	if (input->albedo_told)
		text_message(stderr, "glowworm: note: %s: the albedo is from %s\n", name,
					 input->albedo_source);
	if (input->albedo_missing || input->is_mesh || input->lit || s->points.scale != 1.0f ||
		s->points.white > 0.0f)
		return;
	if (mean < ALBEDO_DARK && mean > 0.0)
		text_message(stderr,
					 "glowworm: note: %s: the albedo is %.2g on average, which is darker than "
					 "charcoal; --albedo-scale %.2g makes it %g, and --input-gamma linear does not "
					 "decode it\n",
					 name, mean, ALBEDO_USUAL / mean, ALBEDO_USUAL);
	if (mean > ALBEDO_BRIGHT)
		text_message(
			stderr,
			"glowworm: note: %s: the albedo is %.2g on average, as bright as snow, so that "
			"light hardly ends; --albedo-scale %.2g makes it 0.5\n",
			name, mean, 0.5 / mean);
}

/* A lamp without units beside one that has some: nobody said that its numbers are in the same. */
static void note_units(const settings *s)
{
	size_t with = 0, without = 0;
	while (with < s->light_count && s->light[with].units == LIGHT_UNITS_UNSAID)
		with++;
	while (without < s->light_count && s->light[without].units != LIGHT_UNITS_UNSAID)
		without++;
	if (s->units_said || with == s->light_count || without == s->light_count)
		return;
	const char *unit =
		s->units == LIGHT_UNITS_PHOTOMETRIC ? "lm, cd, lx or cd/m^2" : "W, W/sr, W/m^2 or W/sr/m^2";
	fprintf(stderr,
			"glowworm: note: light %zu has no units; its numbers are taken for %s, as those of "
			"light %zu are\n",
			without + 1, unit, with + 1);
}

static void note_each(const settings *s, const loaded_scene *scene)
{
	for (size_t i = 0; i < scene->input_count; i++) {
		const loaded_input *input = &scene->input[i];
		mesh_notes_print(&input->mesh, loaded_scene_input_name(input->path),
						 s->points.albedo != SCAN_ALBEDO_AUTO || s->input[i].has_albedo);
		if (input->albedo_missing)
			text_message(stderr, "glowworm: note: %s: the albedo is %s\n",
						 loaded_scene_input_name(input->path), input->albedo_source);
		note_colors(s, input);
	}
}

void input_notes_print(const settings *s, const loaded_scene *scene)
{
	note_each(s, scene);
	if (scene->place.changes)
		text_message(stderr,
					 "glowworm: note: the coordinates are %s, %s; the places of lamps are too, all "
					 "other lengths are metres; points keep their coordinates%s\n",
					 scene->place.name, scene->place.by_file ? "as the file says" : "as asked for",
					 s->vdb ? ", grids are in metres" : "");
	for (size_t c = 0; c < scene->cloud.comment_count; c++)
		if (strncmp(scene->cloud.comment[c], SCAN_NOTE, strlen(SCAN_NOTE)) == 0)
			text_message(stderr, "glowworm: %s\n", scene->cloud.comment[c]);
	note_units(s);
}
