/*
 * scan_sum.c - see scan_sum.h.
 */
#include "scan_sum.h"

#include <string.h>

double scan_sum_of_all(const scan *cloud)
{
	double sum = 0.0;
	for (size_t c = 0; c < cloud->column_count; c++)
		for (size_t i = 0; i < cloud->count; i++)
			sum += scan_value(&cloud->column[c], i);
	for (size_t c = 0; c < cloud->comment_count; c++)
		sum += (double)strlen(cloud->comment[c]);
	for (size_t s = 0; s < 3 * cloud->scanner_count; s++)
		sum += cloud->scanner[s];
	for (size_t i = 0; cloud->scanner_of && i < cloud->count; i++)
		sum += cloud->scanner_of[i];
	return sum;
}
