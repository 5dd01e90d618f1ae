/* SPDX-License-Identifier: Apache-2.0 */
/* data.h - a thinned run as gnuplot's variables and data blocks */
#ifndef PLOT_DATA_H
#define PLOT_DATA_H

#include "thin.h"

struct data {
	const struct thin *t;
	const struct plot_options *o;
};

/** data_write() - @arg is a struct data; trace.gp lists what it finds. */
void data_write(FILE *f, const void *arg);

#endif /* PLOT_DATA_H */
