/* SPDX-License-Identifier: Apache-2.0 */
/* contour.c - the contour error along a trace: of the machine and of its
 * models */
#include "columns.h"
#include "plot.h"

#include "interp/shadow.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

#define STRIPS	1500			/* of time, in the picture */

/* The models of the axes that are followed, and which axes they are. */
struct twin {
	struct interp_shadow shadow;
	struct interp_axis_loop loop[INTERP_NAXES];
	int axis[INTERP_NAXES], naxes;
};

static int twin_make(struct twin *w, const struct interp_axis_loop *loop,
		     double period_s)
{
	*w = (struct twin) { .naxes = 0 };
	for (int i = 0; i < INTERP_NAXES; i++) {
		if (interp_axis_is_rotary((enum interp_axis)i) ||
		    !(loop[i].gain_1_s > 0))
			continue;
		w->axis[w->naxes] = i;
		w->loop[w->naxes++] = loop[i];
	}
	/* A single axis is always on its path. */
	if (w->naxes < 2)
		return -ENOENT;
	return interp_shadow_init(&w->shadow, w->loop, w->naxes, period_s);
}

static struct contour_row follow(struct twin *w, const struct columns *t,
				 size_t k)
{
	double target[INTERP_NAXES], actual[INTERP_NAXES];
	struct interp_shadow_error e;

	for (int i = 0; i < w->naxes; i++) {
		target[i] = t->target[w->axis[i]][k];
		actual[i] = t->actual[w->axis[i]][k];
	}
	interp_shadow_step(&w->shadow, target, target, actual, &e);
	return (struct contour_row) {
		(float)e.measured_mm, (float)e.predicted_mm, (float)e.missed_mm
	};
}

int ctl_contour_make(struct contour_errors *k, const struct columns *t,
		     const struct interp_axis_loop *loop)
{
	struct twin w;
	int err;

	*k = (struct contour_errors) {
		.n = t->n, .period_s = columns_period_s(t),
	};
	err = twin_make(&w, loop, k->period_s);
	if (err < 0)
		return err;
	k->row = calloc(k->n, sizeof(*k->row));
	if (!k->row)
		return -ENOMEM;
	for (size_t i = 0; i < k->n; i++)
		k->row[i] = follow(&w, t, i);
	return 0;
}

void ctl_contour_free(struct contour_errors *k)
{
	free(k->row);
}

void ctl_contour_print(const struct contour_errors *k)
{
	double most[3] = { 0 }, sum[3] = { 0 };

	for (size_t i = 0; i < k->n; i++) {
		const double mm[3] = {
			k->row[i].measured_mm, k->row[i].predicted_mm,
			k->row[i].missed_mm,
		};

		for (int j = 0; j < 3; j++) {
			most[j] = fmax(most[j], mm[j]);
			sum[j] += mm[j] / (double)k->n;
		}
	}
	printf("contour error, um: %.2f largest, %.2f mean; predicted %.2f, "
	       "%.2f; model off the machine by %.2f, %.2f\n", most[0] * 1e3,
	       sum[0] * 1e3, most[1] * 1e3, sum[1] * 1e3, most[2] * 1e3,
	       sum[2] * 1e3);
}

/* Write the largest value of each strip of time, so that a peak stays in the
 * picture. */
static void write_strips(FILE *f, const void *arg)
{
	const struct contour_errors *k = arg;
	const size_t wide = k->n / STRIPS + 1;

	fputs("$error << EOD\n", f);
	for (size_t i = 0; i < k->n; i += wide) {
		struct contour_row most = { 0 };

		for (size_t j = i; j < i + wide && j < k->n; j++) {
			const struct contour_row *r = &k->row[j];

			most.measured_mm = fmaxf(most.measured_mm,
						 r->measured_mm);
			most.predicted_mm = fmaxf(most.predicted_mm,
						  r->predicted_mm);
			most.missed_mm = fmaxf(most.missed_mm, r->missed_mm);
		}
		fprintf(f, "%g %g %g %g\n", (double)i * k->period_s,
			most.measured_mm * 1e3, most.predicted_mm * 1e3,
			most.missed_mm * 1e3);
	}
	fputs("EOD\n", f);
}

int ctl_contour_draw(const struct contour_errors *k, const char *output)
{
	return plot_draw(&(struct plot_sheet) {
		.program = "edmctl", .output = output,
		.script = "contour.gp", .write = write_strips, .arg = k,
	});
}
