/*
 * alias_table.c - see alias_table.h.
 */
#include "base/alias_table.h"

#include "base/memory.h"

#include <stdlib.h>

/* Vose's construction: rows poorer than the mean are topped up by one richer row each. */
static void fill(gw_alias_row *rows, double *share, uint32_t *stack, uint32_t count)
{
	uint32_t poor = 0, rich = count; /* poor rows from the bottom of the stack, rich from its top */
	for (uint32_t i = 0; i < count; i++) {
		rows[i] = (gw_alias_row){ .alias = i };
		if (share[i] < 1.0)
			stack[poor++] = i;
		else
			stack[--rich] = i;
	}
	while (poor > 0 && rich < count) {
		uint32_t low = stack[--poor], high = stack[rich];
		rows[low].probability = (float)share[low];
		rows[low].alias = high;
		share[high] -= 1.0 - share[low];
		if (share[high] < 1.0) {
			rich++;
			stack[poor++] = high;
		}
	}
	/* What is left is 1 but for rounding: it keeps its own row. */
	while (poor > 0)
		rows[stack[--poor]].probability = 1.0f;
	while (rich < count)
		rows[stack[rich++]].probability = 1.0f;
}

gw_status gw_alias_table_fill(gw_alias_row *rows, double *weight, uint32_t count, gw_error *error)
{
	uint32_t *stack = gw_allocate_array(count, sizeof *stack);
	if (!stack)
		return gw_fail(error, GW_ERROR_MEMORY, "no memory for a table of %u rows", count);
	double total = 0.0;
	for (uint32_t i = 0; i < count; i++)
		total += weight[i];
	for (uint32_t i = 0; i < count; i++)
		weight[i] *= (double)count / total;
	fill(rows, weight, stack, count);
	free(stack);
	return GW_OK;
}
