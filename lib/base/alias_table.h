/*
 * alias_table.h - drawing one of many things by their shares in constant time (Walker 1977, Vose
 * 1991): a thing is chosen evenly; with a chance of 1 - probability its alias is taken instead.
 */
#ifndef ALIAS_TABLE_H
#define ALIAS_TABLE_H

#include "glowworm.h"

typedef struct gw_alias_row {
	uint32_t alias;
	float probability;
} gw_alias_row;

/*
 * Fills the table.
 *   rows    receives count rows
 *   weight  count, at least 0, their sum above 0 and finite; changed by the call
 */
gw_status gw_alias_table_fill(gw_alias_row *rows, double *weight, uint32_t count, gw_error *error);

#endif
