/*
 * light_shares.h - a line a lamp at the end of a bake: its share of the light, or why it gives
 * none.
 */
#ifndef LIGHT_SHARES_H
#define LIGHT_SHARES_H

#include "program/json_writer.h"
#include "result/bake_report.h"

/* Prints the lines to standard error: of the strongest lamps, and of those that light nothing. */
void light_shares_print(const bake_facts *facts);

/* Writes them all into a report, as "light_shares". */
void light_shares_write(json_writer *json, const bake_facts *facts);

#endif
