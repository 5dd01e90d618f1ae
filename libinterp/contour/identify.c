/* SPDX-License-Identifier: Apache-2.0 */
/*
 * identify.c - least squares of the actual places over the axis model
 *
 * The derivatives of the model's places are taken by running it once more for
 * each unknown, a little off, all in one pass over the trace; so no room is
 * needed that grows with it.  First the loops alone, from several bandwidths,
 * then everything from the best of them.
 */
#include "interp/identify.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#define N	INTERP_NIDENTIFY
#define ROUNDS	40
#define LEAST	200			/* rows of a trace */
#define SETTLES_S	0.2		/* what the start was is forgotten */
#define STANDS_MM_S	0.01
#define TELLS	0.25			/* sigma over value, at most */
#define EXCITED	10			/* the error varies over what is left */
#define WORTH	30			/* an unknown more, in variances */

const struct interp_identify_field interp_identify_field[N] = {
	[INTERP_IDENTIFY_GAIN] = { "position gain", "1/s" },
	[INTERP_IDENTIFY_VELOCITY] = { "velocity loop", "Hz" },
	[INTERP_IDENTIFY_DAMPING] = { "its damping", "" },
	[INTERP_IDENTIFY_DELAY] = { "delay", "s" },
	[INTERP_IDENTIFY_FEEDFORWARD] = { "feedforward", "" },
	[INTERP_IDENTIFY_KICK] = { "friction kick", "mm/s" },
	[INTERP_IDENTIFY_KICK_TIME] = { "it decays in", "s" },
	[INTERP_IDENTIFY_BACKLASH] = { "backlash", "mm" },
};

/* How a number is varied, and the range it is kept in. */
static const struct {
	double step, low, high;
} vary[N] = {
	[INTERP_IDENTIFY_GAIN] = { 1e-3, 0.1, 1000 },
	[INTERP_IDENTIFY_VELOCITY] = { 1e-2, 1, 1000 },
	[INTERP_IDENTIFY_DAMPING] = { 1e-3, 0.1, 3 },
	[INTERP_IDENTIFY_DELAY] = { 1e-5, 0, 0.012 },
	[INTERP_IDENTIFY_FEEDFORWARD] = { 1e-4, -0.5, 1.5 },
	[INTERP_IDENTIFY_KICK] = { 1e-3, -10, 10 },
	[INTERP_IDENTIFY_KICK_TIME] = { 1e-4, 0.002, 0.2 },
	[INTERP_IDENTIFY_BACKLASH] = { 1e-4, 0, 1 },
};

/* The least squares of one pass: J^T J, J^T e, e^T e. */
struct normal {
	double jj[N][N], je[N], ee;
	size_t rows;
	bool untold[N];			/* nothing depends on it */
};

struct fit {
	const struct interp_identify_trace *t;
	double x[N];
	int which[N], n;		/* the unknowns */
};

static void free_number(struct fit *f, enum interp_identify_id id)
{
	f->which[f->n++] = (int)id;
}

static struct interp_axis_loop loop_of(const double *x)
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

/* Of the range's inside: a number at its end is varied away from it. */
static double step_of(const double *x, int i)
{
	return x[i] + vary[i].step > vary[i].high ? -vary[i].step :
						    vary[i].step;
}

static int begin(const struct fit *f, struct interp_axis_model *m, int off)
{
	double x[N];
	struct interp_axis_loop loop;

	memcpy(x, f->x, sizeof(x));
	if (off >= 0)
		x[f->which[off]] += step_of(x, f->which[off]);
	loop = loop_of(x);
	return interp_axis_model_init(m, &loop, f->t->period_s,
				      f->t->actual_mm[0]);
}

static void add_row(const struct fit *f, struct normal *r,
		    const struct interp_axis_model *m, double actual)
{
	const double e = actual - m[0].actual_mm;
	double j[N];

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

static int pass(const struct fit *f, struct normal *r)
{
	const struct interp_identify_trace *t = f->t;
	const size_t settled = (size_t)(SETTLES_S / t->period_s);
	struct interp_axis_model m[N + 1];

	*r = (struct normal) { 0 };
	for (int i = 0; i <= f->n; i++) {
		const int err = begin(f, &m[i], i - 1);

		if (err)
			return err;
	}
	for (size_t k = 0; k < t->n; k++) {
		if (k >= settled)
			add_row(f, r, m, t->actual_mm[k]);
		for (int i = 0; i <= f->n; i++)
			interp_axis_model_follow(&m[i], t->target_mm[k],
						 t->target_mm[k ? k - 1 : 0]);
	}
	return 0;
}

/* Symmetric @a x = @b by Gauss and Jordan; @inverse too.  False: singular. */
static bool solve(const struct normal *r, int n, double damp, double *x,
		  double inverse[N][N])
{
	double a[N][2 * N + 1] = { 0 };

	for (int i = 0; i < n; i++) {
		for (int k = 0; k < n; k++)
			a[i][k] = k <= i ? r->jj[i][k] : r->jj[k][i];
		a[i][i] *= 1 + damp;
		a[i][N + i] = 1;
		a[i][2 * N] = r->je[i];
	}
	for (int p = 0; p < n; p++) {
		const double pivot = a[p][p];

		if (!(pivot > 1e-14 * r->jj[p][p]) || !(pivot > 0))
			return false;
		for (int c = 0; c <= 2 * N; c++)
			a[p][c] /= pivot;
		for (int i = 0; i < n; i++) {
			const double by = a[i][p];

			for (int c = 0; i != p && c <= 2 * N; c++)
				a[i][c] -= by * a[p][c];
		}
	}
	for (int i = 0; i < n; i++) {
		x[i] = a[i][2 * N];
		for (int k = 0; k < n; k++)
			inverse[i][k] = a[i][N + k];
	}
	return true;
}

/* One number alone cannot stop the rest: what nothing tells is left out. */
static void leave_out_untold(struct normal *r, int n)
{
	for (int i = 0; i < n; i++)
		if (!(r->jj[i][i] > 0)) {
			r->untold[i] = true;
			r->jj[i][i] = 1;
		}
}

static void take_step(const struct fit *f, const double *dx, double *x)
{
	memcpy(x, f->x, sizeof(f->x));
	for (int i = 0; i < f->n; i++) {
		const int k = f->which[i];

		x[k] = fmin(fmax(x[k] + dx[i], vary[k].low), vary[k].high);
	}
}

/* Levenberg and Marquardt: @f->x to the least, its squares in @r. */
static int refine(struct fit *f, struct normal *r)
{
	double damp = 1e-2, dx[N], inverse[N][N];
	int err = pass(f, r);

	leave_out_untold(r, f->n);
	for (int i = 0; i < ROUNDS && err == 0; i++) {
		struct fit next = *f;
		struct normal s;
		double gain;

		if (!solve(r, f->n, damp, dx, inverse)) {
			damp = fmax(damp * 10, 1e-6);
			continue;
		}
		take_step(f, dx, next.x);
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
		if (gain < 1e-9 * s.ee)
			break;
	}
	return err;
}

/* The lag alone: p' = gain (target - p), summed over the trace. */
static double rough_gain(const struct interp_identify_trace *t)
{
	double ev = 0, ee = 0;

	for (size_t k = 1; k + 1 < t->n; k++) {
		const double e = t->target_mm[k] - t->actual_mm[k];
		const double v = (t->target_mm[k + 1] - t->target_mm[k - 1]) /
				 (2 * t->period_s);

		ev += e * v;
		ee += e * e;
	}
	return fmin(fmax(ee > 0 ? ev / ee : 0, 1), 300);
}

/* The loops, then friction and backlash, from several bandwidths. */
static int fit_plain(struct fit *best, struct normal *ret, bool reversals)
{
	static const double hz[] = { 15, 40, 100, 250 };
	const double gain = rough_gain(best->t);
	int found = -EDOM;

	for (size_t i = 0; i < sizeof(hz) / sizeof(hz[0]); i++) {
		struct fit f = { .t = best->t, .x = {
			[INTERP_IDENTIFY_GAIN] = gain,
			[INTERP_IDENTIFY_VELOCITY] = hz[i],
			[INTERP_IDENTIFY_DAMPING] = 0.7,
			[INTERP_IDENTIFY_KICK_TIME] = 0.02,
		} };
		struct normal r;
		int err;

		free_number(&f, INTERP_IDENTIFY_GAIN);
		free_number(&f, INTERP_IDENTIFY_VELOCITY);
		free_number(&f, INTERP_IDENTIFY_DAMPING);
		err = refine(&f, &r);
		for (int k = INTERP_IDENTIFY_KICK; reversals && k < N; k++)
			free_number(&f, (enum interp_identify_id)k);
		if (err == 0 && reversals)
			err = refine(&f, &r);
		if (err < 0 || !isfinite(r.ee) ||
		    (found == 0 && r.ee >= ret->ee))
			continue;
		*best = f;
		*ret = r;
		found = 0;
	}
	return found;
}

/* One unknown more, if the trace wants it. */
static void try_number(struct fit *f, struct normal *r,
		       enum interp_identify_id id)
{
	struct fit more = *f;
	struct normal s;

	free_number(&more, id);
	if (refine(&more, &s) < 0 ||
	    !(r->ee - s.ee > WORTH * s.ee / (double)s.rows))
		return;
	*f = more;
	*r = s;
}

static void survey(const struct interp_identify_trace *t,
		   struct interp_identified *ret)
{
	const size_t settled = (size_t)(SETTLES_S / t->period_s);
	double sum = 0, squares = 0, n = 0;
	int direction = 0;

	for (size_t k = 1; k < t->n; k++) {
		const double v = (t->target_mm[k] - t->target_mm[k - 1]) /
				 t->period_s;
		const double e = t->target_mm[k] - t->actual_mm[k];
		const int now = v > 0 ? 1 : -1;

		if (k >= settled) {
			sum += e;
			squares += e * e;
			n++;
		}
		if (fabs(v) < STANDS_MM_S)
			continue;
		ret->reversals += direction != 0 && now != direction;
		direction = now;
	}
	ret->varies_mm = sqrt(fmax(0, squares / n - sum / n * (sum / n)));
}

static int check(const struct interp_identify_trace *t)
{
	double low = INFINITY, high = -INFINITY;

	if (!(t->period_s > 0))
		return -EINVAL;
	for (size_t k = 0; k < t->n; k++) {
		if (!isfinite(t->target_mm[k]) || !isfinite(t->actual_mm[k]))
			return -EINVAL;
		low = fmin(low, t->target_mm[k]);
		high = fmax(high, t->target_mm[k]);
	}
	if (t->n < LEAST || (double)t->n * t->period_s < 2 * SETTLES_S ||
	    !(high > low))
		return -ENODATA;
	return 0;
}

static void report(const struct fit *f, const struct normal *r,
		   struct interp_identified *ret)
{
	double dx[N], inverse[N][N];
	const double left = r->ee / (double)(r->rows - (size_t)f->n);
	const bool known = solve(r, f->n, 0, dx, inverse);

	ret->loop = loop_of(f->x);
	ret->left_mm = sqrt(r->ee / (double)r->rows);
	memcpy(ret->value, f->x, sizeof(ret->value));
	for (int i = 0; i < f->n; i++) {
		const int k = f->which[i];

		ret->sought[k] = true;
		ret->sigma[k] = known && !r->untold[i] ?
				sqrt(left * inverse[i][i]) : INFINITY;
		ret->told[k] = ret->sigma[k] <= TELLS * fabs(f->x[k]);
	}
}

int interp_identify(const struct interp_identify_trace *t,
		    struct interp_identified *ret)
{
	struct fit f = { .t = t };
	struct normal r;
	int err = check(t);

	if (err)
		return err;
	*ret = (struct interp_identified) { 0 };
	survey(t, ret);
	err = fit_plain(&f, &r, ret->reversals > 0);
	if (err)
		return err;
	try_number(&f, &r, INTERP_IDENTIFY_DELAY);
	try_number(&f, &r, INTERP_IDENTIFY_FEEDFORWARD);
	report(&f, &r, ret);
	return ret->varies_mm >= EXCITED * ret->left_mm &&
	       ret->told[INTERP_IDENTIFY_GAIN] &&
	       ret->told[INTERP_IDENTIFY_VELOCITY] ? 0 : -EDOM;
}
