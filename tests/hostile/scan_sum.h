/*
 * scan_sum.h - uses every value of a scan, so that a sanitizer sees columns that are too short.
 */
#ifndef SCAN_SUM_H
#define SCAN_SUM_H

#include "points/scan.h"

/* The sum of all numbers, and of the lengths of the comments. */
double scan_sum_of_all(const scan *cloud);

#endif
