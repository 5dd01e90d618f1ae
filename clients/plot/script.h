/* SPDX-License-Identifier: Apache-2.0 */
/* script.h - a thinned trace as a gnuplot script, data and all */
#ifndef PLOT_SCRIPT_H
#define PLOT_SCRIPT_H

#include "plot.h"
#include "thin.h"

/* Up to so many jumps are drawn one by one over time. */
#define SCRIPT_FEW	60

/** script_write() - @svg: for an SVG, else a PNG; the picture to stdout. */
void script_write(FILE *f, const struct thin *t, const struct plot_options *o,
		  bool svg);

/* The parts of it, in a file each. */

/** data_write() - every data block the panels draw from. */
void data_write(FILE *f, const struct thin *t, double unit_s);

/** path_write() - the panel of the path, and its data. */
void path_write(FILE *f, const struct thin *t);

/** script_mark_size() - of one of @n marks: many are drawn small. */
double script_mark_size(size_t n);

/** Colours of the states, from Okabe and Ito: told apart by everyone. */
extern const char *const script_colour[CSV_NSTATES];

#endif /* PLOT_SCRIPT_H */
