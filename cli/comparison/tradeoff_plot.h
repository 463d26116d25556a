/*
 * tradeoff_plot.h - error against seconds and against memory, as a picture.
 */
#ifndef TRADEOFF_PLOT_H
#define TRADEOFF_PLOT_H

#include "comparison/tradeoff_runs.h"

#include <stdio.h>

/* Writes an SVG with two panels, both axes logarithmic. The runs that no other one beats are joined
 * by a line; the reference, whose difference from itself is none, is left out. */
void tradeoff_plot_write(const tradeoff *tradeoff, FILE *out);

#endif
