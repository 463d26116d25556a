/*
 * nth_element.h - the element that would stand at a place if an array were sorted.
 */
#ifndef NTH_ELEMENT_H
#define NTH_ELEMENT_H

#include <stddef.h>

/*
 * Value of rank `rank` (0 is the smallest) among count non-negative floats, without sorting them.
 *   rank  below count
 */
float gw_nth_element(const float *values, size_t count, size_t rank);

#endif
