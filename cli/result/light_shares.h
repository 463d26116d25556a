/*
 * light_shares.h - a line a lamp at the end of a bake: its share of the light, or why it gives
 * none.
 */
#ifndef LIGHT_SHARES_H
#define LIGHT_SHARES_H

#include "program/json_writer.h"
#include "scene/loaded_scene.h"

/* Whose lights they are, and what they give. */
typedef struct light_shares {
	const settings *settings;
	const loaded_scene *scene;
	const gw_bake_result *result; /* of a bake, or of a plan */
	uint32_t frames;              /* over which shares are the mean; 0: it is a single bake */
} light_shares;

/* Prints the lines to standard error: of the strongest lamps, and of those that light nothing. */
void light_shares_print(const light_shares *shares);

/* Prints a line a light of a plan, as those of its effects are: the first of them, and how many
 * more there are. */
void light_shares_print_plan(const light_shares *shares, FILE *out);

/* Writes them all into a report, as "light_shares". */
void light_shares_write(json_writer *json, const light_shares *shares);

#endif
