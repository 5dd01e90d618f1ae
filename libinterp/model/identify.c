/* SPDX-License-Identifier: Apache-2.0 */
/*
 * identify.c - finds the numbers of an axis model, from rough to certain
 *
 * First only the loops are fitted, from several bandwidths.  Then everything is
 * fitted from the best of them, and then the kind of noise is found.  At the
 * end the numbers that the trace does not show are left out.
 */
#include "identify_fit.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#define LEAST	200			/* rows of a trace */
#define STANDS_MM_S	0.01
#define TELLS	0.25			/* sigma over value, at most */
#define EXCITED	10			/* the error varies over the rest */
#define WORTH	30			/* gain that justifies one more unknown,
					 * in variances */
#define WORTH_PART	0.01		/* and as a share of the rest: it is
					 * never white */
#define ROUGH	1e-5			/* gain of a round of the search */
#define SHAKES	4
#define SHAKEN	1			/* variances gained: do it once more */
#define FINE	1e-9			/* and gain of the last round */

const struct interp_identify_field interp_identify_field[INTERP_NIDENTIFY] = {
	[INTERP_IDENTIFY_GAIN] = { "position gain", "1/s" },
	[INTERP_IDENTIFY_VELOCITY] = { "velocity loop", "Hz" },
	[INTERP_IDENTIFY_DAMPING] = { "its damping", "" },
	[INTERP_IDENTIFY_DELAY] = { "delay", "s" },
	[INTERP_IDENTIFY_FEEDFORWARD] = { "feedforward", "" },
	[INTERP_IDENTIFY_KICK] = { "friction kick", "mm/s" },
	[INTERP_IDENTIFY_KICK_TIME] = { "it decays in", "s" },
	[INTERP_IDENTIFY_BACKLASH] = { "backlash", "mm" },
};

/* Only the lag: p' = gain (target - p), summed over the trace. */
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

/* The loops, and then friction and backlash, from several bandwidths. */
static int fit_plain(struct identify_fit *best, struct identify_normal *ret,
		     bool reversals)
{
	static const double hz[] = { 15, 40, 100, 250 };
	const double gain = rough_gain(best->t);
	int found = -EDOM;

	for (size_t i = 0; i < sizeof(hz) / sizeof(hz[0]); i++) {
		struct identify_fit f = { .t = best->t, .x = {
			[INTERP_IDENTIFY_GAIN] = gain,
			[INTERP_IDENTIFY_VELOCITY] = hz[i],
			[INTERP_IDENTIFY_DAMPING] = 0.7,
			[INTERP_IDENTIFY_KICK_TIME] = 0.02,
		} };
		struct identify_normal r;
		int err;

		identify_free(&f, INTERP_IDENTIFY_GAIN, INTERP_IDENTIFY_DELAY);
		err = identify_refine(&f, &r, ROUGH);
		if (reversals)
			identify_free(&f, INTERP_IDENTIFY_KICK,
				      INTERP_NIDENTIFY);
		if (err == 0 && reversals)
			err = identify_refine(&f, &r, ROUGH);
		if (err < 0 || !isfinite(r.ee) ||
		    (found == 0 && r.ee >= ret->ee))
			continue;
		*best = f;
		*ret = r;
		found = 0;
	}
	return found;
}

/*
 * What is left of a loop over a noisy encoder is not white noise, because the
 * loop turns the noise's low frequencies into motion.  If the model is told
 * what the encoder said, it follows that motion.  Errors of the model then add
 * up instead of being corrected, so they show more clearly.  A drive that
 * measures in another way, or that is pushed, is better explained by a model
 * that is drawn toward the encoder.  The trace decides: how strongly it is
 * drawn is an unknown, and the better of the two is kept.
 */
static int fit_noise(struct identify_fit *f, struct identify_normal *r)
{
	struct identify_fit g;
	struct identify_normal s;
	int err;

	identify_free(f, IDENTIFY_START, IDENTIFY_N);
	g = *f;
	g.encoder = true;
	g.x[IDENTIFY_PULL] = g.x[INTERP_IDENTIFY_GAIN] * g.t->period_s;
	err = identify_refine(f, r, ROUGH);
	if (err == 0 && identify_refine(&g, &s, ROUGH) == 0 && s.ee < r->ee) {
		*f = g;
		*r = s;
	}
	return err;
}

/* Try one unknown more.  Return: true if the trace needs it. */
static bool try_from(const struct identify_normal *r, int id,
		     struct identify_fit *more, struct identify_normal *s)
{
	identify_free(more, id, id + 1);
	return identify_refine(more, s, ROUGH) == 0 &&
	       r->ee - s->ee > s->ee * fmax(WORTH / (double)s->rows,
					    WORTH_PART);
}

/*
 * A delay lets the axis lag as much as a slower loop does, 2 damping / w.  So
 * each try begins with a loop that is faster by as much: from no delay, the way
 * there would be too far.
 */
static void try_delay(struct identify_fit *f, struct identify_normal *r)
{
	const struct identify_fit none = *f;
	const double w = 2 * M_PI * f->x[INTERP_IDENTIFY_VELOCITY];
	const double lag_s = 2 * f->x[INTERP_IDENTIFY_DAMPING] / w;

	for (int i = 0; i < 4; i++) {
		static const double part[] = { 0, 0.2, 0.4, 0.6 };
		struct identify_fit g = none;
		struct identify_normal s;

		g.x[INTERP_IDENTIFY_DELAY] = part[i] * lag_s;
		g.x[INTERP_IDENTIFY_VELOCITY] /= 1 - part[i];
		if (!try_from(r, INTERP_IDENTIFY_DELAY, &g, &s))
			continue;
		*f = g;
		*r = s;
	}
}

static void try_feedforward(struct identify_fit *f, struct identify_normal *r)
{
	struct identify_fit g = *f;
	struct identify_normal s;

	if (!try_from(r, INTERP_IDENTIFY_FEEDFORWARD, &g, &s))
		return;
	*f = g;
	*r = s;
}

/* Go along the valley of one unknown, by @sigmas of it, and adjust the
 * others. */
static bool stand_off(struct identify_fit *f, const struct identify_normal *r,
		      int id, double sigmas)
{
	double dx[IDENTIFY_N], inverse[IDENTIFY_N][IDENTIFY_N], off[IDENTIFY_N];
	int at = 0;

	while (at < f->n && f->which[at] != id)
		at++;
	if (at == f->n || !identify_solve(r, f->n, 0, dx, inverse))
		return false;
	sigmas *= sqrt(r->ee / (double)r->rows / inverse[at][at]);
	for (int i = 0; i < f->n; i++)
		off[i] = sigmas * inverse[at][i];
	identify_step(f, off, f->x);
	return true;
}

/*
 * Where an axis almost stands still, noise may let it turn many times.  Each
 * turn that the model makes and the axis does not make is a hill in the sum of
 * squares.  So the minimum is searched again from a place beside it.
 */
static bool shake_once(struct identify_fit *f, struct identify_normal *r)
{
	static const int ids[] = {
		INTERP_IDENTIFY_VELOCITY, INTERP_IDENTIFY_KICK_TIME,
		INTERP_IDENTIFY_DELAY,
	};
	static const double sigmas[] = { 1, -1, 2, -2, 3, -3 };
	bool better = false;

	for (int i = 0; i < 3 * 6; i++) {
		struct identify_fit g = *f;
		struct identify_normal s;

		if (!stand_off(&g, r, ids[i / 6], sigmas[i % 6]) ||
		    identify_refine(&g, &s, ROUGH) < 0 || s.ee >= r->ee)
			continue;
		better |= r->ee - s.ee > SHAKEN * r->ee / (double)r->rows;
		*f = g;
		*r = s;
	}
	return better;
}

static int shake(struct identify_fit *f, struct identify_normal *r)
{
	for (int i = 0; i < SHAKES && shake_once(f, r); i++)
		;
	return identify_refine(f, r, FINE);
}

static void find_sigmas(const struct identify_fit *f,
			const struct identify_normal *r,
			double sigma[IDENTIFY_N])
{
	double dx[IDENTIFY_N], inverse[IDENTIFY_N][IDENTIFY_N];
	const double left = r->ee / (double)(r->rows - (size_t)f->n);
	const bool known = identify_solve(r, f->n, 0, dx, inverse);

	for (int i = 0; i < f->n; i++)
		sigma[f->which[i]] = known && !r->untold[i] ?
				     sqrt(left * inverse[i][i]) : INFINITY;
}

static bool is_told(const struct identify_fit *f, const double *sigma, int id)
{
	return sigma[id] <= TELLS * fabs(f->x[id]);
}

/* An unknown that the trace does not show makes the others less certain. */
static int leave_out(struct identify_fit *f, struct identify_normal *r,
		     const double *sigma)
{
	const int n = f->n;

	if (!is_told(f, sigma, INTERP_IDENTIFY_BACKLASH))
		identify_fix(f, INTERP_IDENTIFY_BACKLASH, 0);
	if (!is_told(f, sigma, INTERP_IDENTIFY_KICK)) {
		identify_fix(f, INTERP_IDENTIFY_KICK, 0);
		identify_fix(f, INTERP_IDENTIFY_KICK_TIME, 0);
	}
	return n == f->n ? 0 : identify_refine(f, r, FINE);
}

static void survey(const struct interp_identify_trace *t,
		   struct interp_identified *ret)
{
	const size_t settled = (size_t)(IDENTIFY_SETTLES_S / t->period_s);
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
	if (t->n < LEAST ||
	    (double)t->n * t->period_s < 2 * IDENTIFY_SETTLES_S ||
	    !(high > low))
		return -ENODATA;
	return 0;
}

static void report(const struct identify_fit *f,
		   const struct identify_normal *r,
		   struct interp_identified *ret)
{
	double sigma[IDENTIFY_N];

	find_sigmas(f, r, sigma);
	ret->loop = identify_loop(f->x);
	ret->left_mm = sqrt(r->ee / (double)r->rows);
	memcpy(ret->value, f->x, sizeof(ret->value));
	for (int i = 0; i < f->n; i++) {
		const int id = f->which[i];

		if (id >= INTERP_NIDENTIFY)
			continue;
		ret->sought[id] = true;
		ret->sigma[id] = sigma[id];
		ret->told[id] = is_told(f, sigma, id);
	}
}

/* Try delay and feedforward against the best result without them. */
static int fit_more(struct identify_fit *f, struct identify_normal *r)
{
	const int n = f->n;
	int err = shake(f, r);

	if (err)
		return err;
	try_delay(f, r);
	try_feedforward(f, r);
	return f->n == n ? 0 : shake(f, r);
}

/* Fit all unknowns, and then leave out those that the trace does not show. */
static int fit_all(struct identify_fit *f, struct identify_normal *r,
		   struct interp_identified *ret)
{
	double sigma[IDENTIFY_N];
	int err = fit_plain(f, r, ret->reversals > 0);

	if (err == 0)
		err = fit_noise(f, r);
	if (err == 0)
		err = fit_more(f, r);
	if (err || ret->reversals == 0)
		return err;
	for (int i = INTERP_IDENTIFY_KICK; i < INTERP_NIDENTIFY; i++)
		ret->sought[i] = true;
	find_sigmas(f, r, sigma);
	return leave_out(f, r, sigma);
}

int interp_identify(const struct interp_identify_trace *t,
		    struct interp_identified *ret)
{
	struct identify_fit f = { .t = t };
	struct identify_normal r;
	int err = check(t);

	if (err)
		return err;
	*ret = (struct interp_identified) { 0 };
	survey(t, ret);
	err = fit_all(&f, &r, ret);
	if (err)
		return err;
	report(&f, &r, ret);
	return ret->varies_mm >= EXCITED * ret->left_mm &&
	       ret->told[INTERP_IDENTIFY_GAIN] &&
	       ret->told[INTERP_IDENTIFY_VELOCITY] ? 0 : -EDOM;
}
