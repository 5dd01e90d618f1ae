/* SPDX-License-Identifier: Apache-2.0 */
/* columns.h - a trace in memory, and the contour error in it */
#ifndef CTL_COLUMNS_H
#define CTL_COLUMNS_H

#include "csv.h"

#include "interp/axis.h"
#include "interp/axis_model.h"

/* A row for each cycle; grown by identify.c. */
struct columns {
	double *target[CSV_NAXES], *actual[CSV_NAXES];	/* mm */
	double first_s, last_s, longest_s;
	size_t n, room;
};

static inline double columns_period_s(const struct columns *t)
{
	return (t->last_s - t->first_s) / (double)(t->n - 1);
}

/* Contour errors of one cycle. */
struct contour_row {
	float measured_mm, predicted_mm, missed_mm;
};

struct contour_errors {
	struct contour_row *row;
	size_t n;
	double period_s;
};

/**
 * ctl_contour_make() - the linear axes of @loop that have a gain, beside the
 * trace.
 *
 * Return: 0; -ENOENT if there are fewer than two of them; -ENOMEM.
 */
int ctl_contour_make(struct contour_errors *k, const struct columns *t,
		     const struct interp_axis_loop *loop);
void ctl_contour_free(struct contour_errors *k);

/** ctl_contour_print() - the largest and the mean error, for a person. */
void ctl_contour_print(const struct contour_errors *k);

/**
 * ctl_contour_draw() - the error over time, to a .png or .svg. Return: 0; or <
 * 0, and the reason was printed.
 */
int ctl_contour_draw(const struct contour_errors *k, const char *output);

#endif /* CTL_COLUMNS_H */
