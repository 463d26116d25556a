/* output_columns.h - columns that the format of the output has no room for. */
#ifndef OUTPUT_COLUMNS_H
#define OUTPUT_COLUMNS_H

#include "points/format.h"

/* Says on standard error how many columns of a cloud are left out, and one of them: the first of
 * light, if there are some. Nothing where the format has room for all, or if quiet. */
void output_columns_note(const format *to, const scan *cloud, bool quiet);

#endif
