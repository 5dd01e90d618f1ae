/* SPDX-License-Identifier: Apache-2.0 */
/*
 * identify_fit.c - passes over a trace, and steps of Levenberg and Marquardt
 *
 * To get the derivatives of the model's places, the model is run once more for
 * each unknown, with the unknown a little changed, all in one pass over the
 * trace.  So the memory does not grow with the trace.
 */
#include "identify_fit.h"

#include <math.h>
#include <string.h>

#define ROUNDS	40

/* How a number is varied, and the range in which it is kept. */
static const struct {
	double step, low, high;
} vary[IDENTIFY_N] = {
	[INTERP_IDENTIFY_GAIN] = { 1e-3, 0.1, 1000 },
	[INTERP_IDENTIFY_VELOCITY] = { 1e-2, 1, 1000 },
	[INTERP_IDENTIFY_DAMPING] = { 1e-3, 0.1, 3 },
	[INTERP_IDENTIFY_DELAY] = { 1e-5, 0, 0.012 },
	[INTERP_IDENTIFY_FEEDFORWARD] = { 1e-4, -0.5, 1.5 },
	[INTERP_IDENTIFY_KICK] = { 1e-3, -10, 10 },
	[INTERP_IDENTIFY_KICK_TIME] = { 1e-4, 0.002, 0.2 },
	[INTERP_IDENTIFY_BACKLASH] = { 1e-4, 0, 1 },
	[IDENTIFY_START] = { 1e-4, -0.1, 0.1 },
	[IDENTIFY_PULL] = { 1e-4, 0, 0.9 },
};

struct interp_axis_loop identify_loop(const double *x)
{
	return (struct interp_axis_loop) {
		.gain_1_s = x[INTERP_IDENTIFY_GAIN],
		.velocity_hz = x[INTERP_IDENTIFY_VELOCITY],
		.damping = x[INTERP_IDENTIFY_DAMPING],
		.delay_s = x[INTERP_IDENTIFY_DELAY],
		.feedforward = x[INTERP_IDENTIFY_FEEDFORWARD],
		.kick_mm_s = x[INTERP_IDENTIFY_KICK],
		.kick_s = x[INTERP_IDENTIFY_KICK_TIME],
		.backlash_mm = x[INTERP_IDENTIFY_BACKLASH],
	};
}

/* Toward the inside of the range: a number at its end is varied away from the
 * end. */
static double step_of(const double *x, int i)
{
	return x[i] + vary[i].step > vary[i].high ? -vary[i].step :
						    vary[i].step;
}

static int begin(const struct identify_fit *f, struct interp_axis_model *m,
		 int off, double *ret_pull)
{
	double x[IDENTIFY_N];
	struct interp_axis_loop loop;

	memcpy(x, f->x, sizeof(x));
	if (off >= 0)
		x[f->which[off]] += step_of(x, f->which[off]);
	loop = identify_loop(x);
	*ret_pull = x[IDENTIFY_PULL];
	return interp_axis_model_init(m, &loop, f->t->period_s,
				      f->t->actual_mm[0] + x[IDENTIFY_START]);
}

/*
 * Where the drive closes its loop over the encoder, noise included, the trace
 * shows the speed that the drive demanded, and so the time when it turned.
 *
 * The row for which the derivatives are taken leads.  Otherwise a turn one
 * period earlier would be a step in them.
 */
static void follow(const struct identify_fit *f, struct interp_axis_model *m,
		   size_t k, const struct interp_axis_model *leader)
{
	const struct interp_identify_trace *t = f->t;
	const struct interp_axis_loop *l = &m->loop;
	const double set = t->target_mm[k];
	const double before = t->target_mm[k ? k - 1 : 0];
	const double at = f->encoder ? t->actual_mm[k] : m->actual_mm;

	interp_axis_model_step_beside(m, l->gain_1_s * (set - at) +
		l->feedforward * (set - before) / t->period_s, leader);
}

static void add_row(const struct identify_fit *f, struct identify_normal *r,
		    const struct interp_axis_model *m, double actual)
{
	const double e = actual - m[0].actual_mm;
	double j[IDENTIFY_N];

	for (int i = 0; i < f->n; i++)
		j[i] = (m[i + 1].actual_mm - m[0].actual_mm) /
		       step_of(f->x, f->which[i]);
	for (int i = 0; i < f->n; i++) {
		for (int k = 0; k <= i; k++)
			r->jj[i][k] += j[i] * j[k];
		r->je[i] += j[i] * e;
	}
	r->ee += e * e;
	r->rows++;
}

static int pass(const struct identify_fit *f, struct identify_normal *r)
{
	const struct interp_identify_trace *t = f->t;
	const size_t settled = (size_t)(IDENTIFY_SETTLES_S / t->period_s);
	struct interp_axis_model m[IDENTIFY_N + 1];
	double pull[IDENTIFY_N + 1];

	if (t->on_pass)
		t->on_pass(t->on_pass_arg);
	*r = (struct identify_normal) { 0 };
	for (int i = 0; i <= f->n; i++) {
		const int err = begin(f, &m[i], i - 1, &pull[i]);

		if (err)
			return err;
	}
	for (size_t k = 0; k < t->n; k++) {
		if (k >= settled)
			add_row(f, r, m, t->actual_mm[k]);
		for (int i = 0; i <= f->n; i++) {
			interp_axis_model_shift(&m[i], pull[i] *
				(t->actual_mm[k] - m[i].actual_mm));
			follow(f, &m[i], k, m);
		}
	}
	return 0;
}

/* By the method of Gauss and Jordan. */
bool identify_solve(const struct identify_normal *r, int n, double damp,
		    double *x, double inverse[IDENTIFY_N][IDENTIFY_N])
{
	double a[IDENTIFY_N][2 * IDENTIFY_N + 1] = { 0 };

	for (int i = 0; i < n; i++) {
		for (int k = 0; k < n; k++)
			a[i][k] = k <= i ? r->jj[i][k] : r->jj[k][i];
		a[i][i] *= 1 + damp;
		a[i][IDENTIFY_N + i] = 1;
		a[i][2 * IDENTIFY_N] = r->je[i];
	}
	for (int p = 0; p < n; p++) {
		const double pivot = a[p][p];

		if (!(pivot > 1e-14 * r->jj[p][p]) || !(pivot > 0))
			return false;
		for (int c = 0; c <= 2 * IDENTIFY_N; c++)
			a[p][c] /= pivot;
		for (int i = 0; i < n; i++) {
			const double by = a[i][p];

			for (int c = 0; i != p && c <= 2 * IDENTIFY_N; c++)
				a[i][c] -= by * a[p][c];
		}
	}
	for (int i = 0; i < n; i++) {
		x[i] = a[i][2 * IDENTIFY_N];
		for (int k = 0; k < n; k++)
			inverse[i][k] = a[i][IDENTIFY_N + k];
	}
	return true;
}

/* One unknown must not stop the others: an unknown on which nothing depends is
 * left out. */
static void leave_out_untold(struct identify_normal *r, int n)
{
	for (int i = 0; i < n; i++)
		if (!(r->jj[i][i] > 0)) {
			r->untold[i] = true;
			r->jj[i][i] = 1;
		}
}

void identify_step(const struct identify_fit *f, const double *dx, double *x)
{
	memmove(x, f->x, sizeof(f->x));
	for (int i = 0; i < f->n; i++) {
		const int k = f->which[i];

		x[k] = fmin(fmax(x[k] + dx[i], vary[k].low), vary[k].high);
	}
}

int identify_refine(struct identify_fit *f, struct identify_normal *r,
		    double enough)
{
	double damp = 1e-2, dx[IDENTIFY_N], inverse[IDENTIFY_N][IDENTIFY_N];
	int err = pass(f, r);

	leave_out_untold(r, f->n);
	for (int i = 0; i < ROUNDS && err == 0; i++) {
		struct identify_fit next = *f;
		struct identify_normal s;
		double gain;

		if (!identify_solve(r, f->n, damp, dx, inverse)) {
			damp = fmax(damp * 10, 1e-6);
			continue;
		}
		identify_step(f, dx, next.x);
		err = pass(&next, &s);
		gain = r->ee - s.ee;
		if (err || !(gain > 0)) {
			damp *= 10;
			err = 0;
			if (damp > 1e8)
				break;
			continue;
		}
		*f = next;
		*r = s;
		leave_out_untold(r, f->n);
		damp = fmax(damp / 10, 1e-9);
		if (gain < enough * s.ee)
			break;
	}
	return err;
}

void identify_free(struct identify_fit *f, int first, int end)
{
	while (first < end)
		f->which[f->n++] = first++;
}

void identify_fix(struct identify_fit *f, int id, double value)
{
	for (int i = 0; i < f->n; i++)
		if (f->which[i] == id)
			f->which[i--] = f->which[--f->n];
	f->x[id] = value;
}
