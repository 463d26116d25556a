#include "verbs/verbs.h"
#include "glowworm_host.h"
#include "files/output_file.h"
#include "lamps/light_preset.h"
#include "lamps/polar_picture.h"
#include "luminaires/luminaire_reader.h"
#include "program/json_writer.h"
#include "scene/file_roles.h"
#include "scene/loaded_scene.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* All that lives as long as one luminaire is shown. */
typedef struct lamp_show {
	const settings *settings;
	const char *path;
	bool exr;
	output_file *out; /* of the picture */
	luminaire lamp;
	luminaire_facts facts;
	gw_error *error;
} lamp_show;

static gw_status check(lamp_show *w)
{
	const settings *s = w->settings;
	if (s->input_count != 1)
		return gw_fail(w->error, GW_ERROR_USAGE,
					   "which lamp? Name one IES (LM-63) or EULUMDAT file%s",
					   s->output ? "" : ", or none for a list of lamps that have names");
	w->path = s->input[0].path;
	const char *dot = s->output ? strrchr(s->output, '.') : NULL;
	w->exr = dot && strcasecmp(dot, ".exr") == 0;
	if (s->output && !w->exr && !(dot && strcasecmp(dot, ".png") == 0))
		return gw_fail(w->error, GW_ERROR_USAGE, "%s: a polar picture ends in .png or .exr",
					   s->output);
	return file_roles_check(VERB_LAMP, s, NULL, w->error);
}

/* ----------------------------------------------------------------------------------- figures */

/* Words for --light, with what of it is not in the file left to be said. A path with blanks fits a
 * scene file alone. */
static void write_words(const lamp_show *w, FILE *out)
{
	const luminaire *l = &w->lamp;
	bool scene = strpbrk(w->path, " \t") != NULL || strcmp(w->path, "-") == 0;
	bool area = l->size[0] > 0.0 && l->size[1] > 0.0;
	const char *form = l->photometry == 'C' ? "" : " to X,Y,Z";
	if (scene)
		fprintf(out,
				"in a scene file: {\"type\": \"point\", \"position\": [X, Y, Z], \"ies\": FILE}");
	else
		fprintf(out, "--light 'point at X,Y,Z ies %s%s'", w->path, form);
	if (area)
		fprintf(out, "; %s in place of point for its size", l->round ? "disc" : "rectangle");
}

/* Lumens that the file states, and of what. */
static double stated(const luminaire *l, const char **of)
{
	*of = l->stated_lumens > 0.0 ? "stated" : l->lamp_lumens > 0.0 ? "of its lamps" : NULL;
	return l->stated_lumens > 0.0 ? l->stated_lumens : l->lamp_lumens;
}

/* More flux than the lamps have that make it, by more than the rounding of a data sheet and the
 * summing of few planes come to: a luminaire keeps some of it. */
#define LUMENS_SLACK 1.03

static bool exceeds_its_lamps(const lamp_show *w)
{
	return w->lamp.lamp_lumens > 0.0 && w->facts.lumens > LUMENS_SLACK * w->lamp.lamp_lumens;
}

static void write_flux(const lamp_show *w, FILE *out)
{
	const luminaire *l = &w->lamp;
	const char *of;
	double lumens = stated(l, &of);
	fprintf(out, "  flux       %s lm by its intensities", GW_SAID(w->facts.lumens, 6));
	if (of)
		fprintf(out, ", %.1f %% of the %s lm %s", 100.0 * w->facts.lumens / lumens,
				GW_SAID(lumens, 6), of);
	else
		fprintf(out, "; the file states none");
	fprintf(out, "; %.1f %% downward\n", 100.0 * w->facts.downward);
	if (exceeds_its_lamps(w))
		fprintf(out,
				"  doubt      no luminaire gives more than its lamps, here %s lm: ask its maker "
				"which "
				"is right, and give the light's lumens with --light '... lumens N'\n",
				GW_SAID(l->lamp_lumens, 6));
	if (l->watts > 0.0)
		fprintf(out, "  input      %s W, %s lm/W\n", GW_SAID(l->watts, 4),
				GW_SAID(w->facts.lumens / l->watts, 4));
}

static void write_size(const luminaire *l, FILE *out)
{
	if (l->size[0] <= 0.0 && l->size[1] <= 0.0)
		fprintf(out, "  opening    a point\n");
	else if (l->round)
		fprintf(out, "  opening    round, %.3g m wide, %.3g m high\n", l->size[0], l->size[2]);
	else
		fprintf(out, "  opening    %.3g m along C 0, %.3g m along C 90, %.3g m high\n", l->size[0],
				l->size[1], l->size[2]);
}

static void write_text(const lamp_show *w, FILE *out)
{
	const luminaire *l = &w->lamp;
	const luminaire_facts *f = &w->facts;
	fprintf(out, "%s: %s, type %c, %u planes of %u intensities\n", loaded_scene_input_name(w->path),
			l->format, l->photometry, l->horizontals, l->verticals);
	if (l->maker[0])
		fprintf(out, "  maker      %s\n", l->maker);
	if (l->model[0])
		fprintf(out, "  luminaire  %s\n", l->model);
	if (l->lamp[0])
		fprintf(out, "  lamp       %s\n", l->lamp);
	write_flux(w, out);
	fprintf(out, "  largest    %s cd, %.4g degrees from the axis in plane C %.4g\n",
			GW_SAID(l->candela, 6), f->peak_gamma, f->peak_c);
	fprintf(out, "  beam       %.1f degrees (50 %%) in C 0-180, %.1f in C 90-270\n", f->beam[0],
			f->beam[1]);
	fprintf(out, "  field      %.1f degrees (10 %%) in C 0-180, %.1f in C 90-270\n", f->field[0],
			f->field[1]);
	write_size(l, out);
	for (size_t i = 0; i < l->tilts; i++)
		fprintf(out, "  tilted     %g degrees: %.4g of its light\n", l->tilt[i], l->tilt_factor[i]);
	fprintf(out, "  use        ");
	write_words(w, out);
	fputc('\n', out);
}

static void write_json(const lamp_show *w, FILE *out)
{
	const luminaire *l = &w->lamp;
	json_writer json = { .out = out };
	json_put_open(&json, NULL, '{');
	json_put_text(&json, "file", loaded_scene_input_name(w->path));
	json_put_text(&json, "format", l->format);
	json_put_text(&json, "type", (const char[]){ l->photometry, '\0' });
	json_put_text(&json, "maker", l->maker);
	json_put_text(&json, "luminaire", l->model);
	json_put_text(&json, "lamp", l->lamp);
	json_put_count(&json, "planes", l->horizontals);
	json_put_count(&json, "angles", l->verticals);
	json_put_real(&json, "lumens", w->facts.lumens);
	json_put_real(&json, "stated_lumens", l->stated_lumens > 0.0 ? l->stated_lumens : NAN);
	json_put_real(&json, "lamp_lumens", l->lamp_lumens > 0.0 ? l->lamp_lumens : NAN);
	json_put_bool(&json, "exceeds_lamps", exceeds_its_lamps(w));
	json_put_real(&json, "downward", w->facts.downward);
	json_put_real(&json, "watts", l->watts > 0.0 ? l->watts : NAN);
	json_put_real(&json, "candela", l->candela);
	json_put_real(&json, "peak_gamma", w->facts.peak_gamma);
	json_put_real(&json, "peak_c", w->facts.peak_c);
	json_put_reals(&json, "beam", w->facts.beam, 2);
	json_put_reals(&json, "field", w->facts.field, 2);
	json_put_bool(&json, "round", l->round);
	json_put_reals(&json, "size", l->size, 3);
	json_put_close(&json, '}');
	fputc('\n', out);
}

/* ------------------------------------------------------------------------------------- names */

/* Where the lamp is to be, which no name says, and what else is needed. */
static void write_preset_words(const light_preset *p, FILE *out)
{
	fprintf(out, "--light '%s at X,Y,Z%s", p->name, p->type == GW_LIGHT_SPOT ? " to X,Y,Z" : "");
	for (int k = 0; k < LIGHT_KEY_COUNT; k++)
		if (p->needed & 1u << k)
			fprintf(out, " %s N", light_keys[k].name);
	fprintf(out, "'");
}

static void write_presets(FILE *out)
{
	for (const light_preset *p = light_presets; p->name; p++) {
		fprintf(out, "%s: %s\n  is         %s%s%s\n  use        ", p->name, p->about,
				gw_light_type_name(p->type), *p->keys ? " " : "", p->keys);
		write_preset_words(p, out);
		if (p->estimated)
			fprintf(out, "\n  estimate   intensity from %s", p->estimated);
		fprintf(out, "\n  source     %s\n", p->source);
	}
}

static void write_presets_json(FILE *out)
{
	json_writer json = { .out = out };
	json_put_open(&json, NULL, '[');
	for (const light_preset *p = light_presets; p->name; p++) {
		json_put_open(&json, NULL, '{');
		json_put_text(&json, "name", p->name);
		json_put_text(&json, "type", gw_light_type_name(p->type));
		json_put_text(&json, "keys", p->keys);
		json_put_text(&json, "about", p->about);
		if (p->estimated)
			json_put_text(&json, "estimated_from", p->estimated);
		json_put_text(&json, "source", p->source);
		json_put_close(&json, '}');
	}
	json_put_close(&json, ']');
	fputc('\n', out);
}

/* ----------------------------------------------------------------------------------- picture */

static gw_status draw(lamp_show *w)
{
	GW_TRY(w->exr ? polar_picture_write_exr(w->out, &w->lamp, w->error)
				  : polar_picture_write_png(w->out, &w->lamp, w->error));
	return output_file_commit(&w->out, w->error);
}

static gw_status run(lamp_show *w)
{
	const settings *s = w->settings;
	if (s->input_count == 0 && !s->output) {
		s->json ? write_presets_json(stdout) : write_presets(stdout);
		return GW_OK;
	}
	GW_TRY(check(w));
	if (s->output)
		GW_TRY(output_file_create(&w->out, s->output, s->force, w->error));
	GW_TRY(luminaire_read(w->path, &w->lamp, w->error));
	w->facts = luminaire_measure(&w->lamp);
	if (s->output)
		GW_TRY(draw(w));
	if (s->json)
		write_json(w, stdout);
	else
		write_text(w, stdout);
	return GW_OK;
}

gw_status verb_lamp(const settings *s, gw_error *error)
{
	lamp_show w = { .settings = s, .error = error };
	gw_status status = run(&w);
	output_file_abandon(&w.out);
	luminaire_clear(&w.lamp);
	return status;
}
