/* SPDX-License-Identifier: Apache-2.0 */
/*
 * axis_model.c - an axis and its drive, period by period
 *
 * The input is held during a period, so the exact discretisation is one matrix
 * exponential.  With the input as a fourth state that stands still, exp([A B; 0
 * 0] t) contains phi(t) and gamma(t).  If the delay is not a whole number of
 * periods, u changes within the period: the old value acts in the first part,
 * and the new one in the rest.
 */
#include "interp/axis_model.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#define N	INTERP_AXIS_NSTATES
#define M	(N + 1)			/* with the input */
#define TERMS	12			/* of the series, for a norm below
					 * 1/2 */
#define STANDS_MM_S	0.01		/* a slower motion counts as none */
#define SEARCH	200			/* halvings and looks; not in the
					 * cycle */

struct matrix {
	double at[M][M];
};

static struct matrix multiply(struct matrix b, struct matrix c)
{
	struct matrix r = { 0 };

	for (int i = 0; i < M; i++)
		for (int j = 0; j < M; j++)
			for (int k = 0; k < M; k++)
				r.at[i][j] += b.at[i][k] * c.at[k][j];
	return r;
}

static struct matrix scale(struct matrix a, double by)
{
	for (int i = 0; i < M; i++)
		for (int j = 0; j < M; j++)
			a.at[i][j] *= by;
	return a;
}

static double norm(struct matrix a)
{
	double most = 0;

	for (int i = 0; i < M; i++) {
		double sum = 0;

		for (int j = 0; j < M; j++)
			sum += fabs(a.at[i][j]);
		most = fmax(most, sum);
	}
	return most;
}

/* The series of a small part of the matrix, squared until it is whole. */
static struct matrix exponential(struct matrix a)
{
	struct matrix sum = { 0 }, term;
	int halvings = 0;

	for (double n = norm(a); n > 0.5 && halvings < 60; n /= 2)
		halvings++;
	a = scale(a, ldexp(1, -halvings));
	for (int i = 0; i < M; i++)
		sum.at[i][i] = 1;
	term = sum;
	for (int n = 1; n <= TERMS; n++) {
		term = scale(multiply(term, a), 1.0 / n);
		for (int i = 0; i < M; i++)
			for (int j = 0; j < M; j++)
				sum.at[i][j] += term.at[i][j];
	}
	while (halvings--)
		sum = multiply(sum, sum);
	return sum;
}

/* In natural units, with w t for the time, so that the series is well
 * scaled. */
static void transition(const struct interp_axis_loop *l, double t,
		       double phi[N][N], double gamma[N])
{
	const double w = 2 * M_PI * l->velocity_hz;
	const struct matrix a = { {
		{ 0, 1, 0, 0 },
		{ 0, 0, 1, 0 },
		{ 0, -1, -2 * l->damping, 1 },
	} };
	/* The place in units of 1/w and the acceleration in units of w, both
	 * per mm/s. */
	const double unit[N] = { 1 / w, 1, w };
	const struct matrix e = exponential(scale(a, w * t));

	for (int i = 0; i < N; i++) {
		for (int j = 0; j < N; j++)
			phi[i][j] = e.at[i][j] * unit[i] / unit[j];
		gamma[i] = e.at[i][N] * unit[i];
	}
}

static void discretise(struct interp_axis_model *m)
{
	const double periods = m->loop.delay_s / m->period_s;
	double part_s, phi_new[N][N], phi_old[N][N], old[N];

	m->whole = (int)floor(periods + 1e-9);
	part_s = fmax(0, m->loop.delay_s - m->whole * m->period_s);
	transition(&m->loop, m->period_s, m->phi, m->gamma_new);
	transition(&m->loop, part_s, phi_old, old);
	transition(&m->loop, m->period_s - part_s, phi_new, m->gamma_new);
	for (int i = 0; i < N; i++) {
		m->gamma_old[i] = 0;
		for (int j = 0; j < N; j++)
			m->gamma_old[i] += phi_new[i][j] * old[j];
	}
	m->kick_keeps = m->loop.kick_s > 0 ?
			exp(-m->period_s / m->loop.kick_s) : 0;
	m->kick_way_s = m->loop.kick_s * (1 - m->kick_keeps);
}

static int check(const struct interp_axis_loop *l, double period_s)
{
	if (!(period_s > 0 && l->gain_1_s > 0 && l->velocity_hz > 0 &&
	      l->damping > 0 && l->delay_s >= 0 && l->kick_s >= 0 &&
	      l->backlash_mm >= 0 && isfinite(l->feedforward) &&
	      isfinite(l->kick_mm_s)))
		return -EINVAL;
	return l->delay_s > INTERP_AXIS_DELAY_MAX * period_s ? -ERANGE : 0;
}

int interp_axis_model_init(struct interp_axis_model *m,
			   const struct interp_axis_loop *loop,
			   double period_s, double place_mm)
{
	const int err = check(loop, period_s);

	if (err)
		return err;
	*m = (struct interp_axis_model) {
		.loop = *loop, .period_s = period_s,
		.x = { place_mm }, .actual_mm = place_mm,
	};
	discretise(m);
	return 0;
}

void interp_axis_model_stand(struct interp_axis_model *m, double place_mm)
{
	memset(m->x, 0, sizeof(m->x));
	memset(m->past, 0, sizeof(m->past));
	m->x[0] = m->actual_mm = place_mm;
	m->kick_mm_s = 0;
	m->direction = 0;
}

/* A turn of the motion gives a kick.  A motion slower than STANDS_MM_S has not
 * turned. */
static int turns(const struct interp_axis_model *m)
{
	const double v = m->x[1];

	return fabs(v) < STANDS_MM_S ? m->direction : v > 0 ? 1 : -1;
}

/* The part of this period in which it moved the other way; @before: its speed
 * before, mm/s. */
static double part_of(const struct interp_axis_model *m, int direction,
		      double before)
{
	const double part = (direction * m->x[1] - STANDS_MM_S) /
			    (direction * (m->x[1] - before));

	return part > 0 ? fmin(part, 1) : 0;
}

static void rub(struct interp_axis_model *m, int direction, double before)
{
	double part;

	if (direction == m->direction)
		return;
	if (m->direction != 0) {
		part = part_of(m, direction, before);
		m->kick_mm_s = -direction * m->loop.kick_mm_s;
		m->x[0] += part * m->kick_mm_s * m->kick_way_s;
		m->kick_mm_s *= 1 - part * (1 - m->kick_keeps);
	}
	m->direction = direction;
}

static void give_play(struct interp_axis_model *m)
{
	const double half = m->loop.backlash_mm / 2;

	m->actual_mm = fmin(fmax(m->actual_mm, m->x[0] - half), m->x[0] + half);
}

static void advance_period(struct interp_axis_model *m, double u_mm_s)
{
	double x[N], fresh, old;

	for (int i = m->whole + 1; i > 0; i--)
		m->past[i] = m->past[i - 1];
	m->past[0] = u_mm_s;
	fresh = m->past[m->whole];
	old = m->past[m->whole + 1];
	for (int i = 0; i < N; i++) {
		x[i] = m->gamma_new[i] * fresh + m->gamma_old[i] * old;
		for (int j = 0; j < N; j++)
			x[i] += m->phi[i][j] * m->x[j];
	}
	x[0] += m->kick_mm_s * m->kick_way_s;
	m->kick_mm_s *= m->kick_keeps;
	memcpy(m->x, x, sizeof(x));
}

void interp_axis_model_step_beside(struct interp_axis_model *m, double u_mm_s,
				   const struct interp_axis_model *leader)
{
	const double before = m->x[1];

	advance_period(m, u_mm_s);
	rub(m, leader == m ? turns(m) : leader->direction, before);
	give_play(m);
}

void interp_axis_model_step(struct interp_axis_model *m, double u_mm_s)
{
	interp_axis_model_step_beside(m, u_mm_s, m);
}

double interp_axis_model_follow(struct interp_axis_model *m, double target_mm,
				double before_mm)
{
	const double u = m->loop.gain_1_s * (target_mm - m->actual_mm) +
			 m->loop.feedforward * (target_mm - before_mm) /
				 m->period_s;

	interp_axis_model_step(m, u);
	return u;
}

/* -- In z ----------------------------------------------------------------- */

/* One step of x = phi x. */
static void advance(const struct interp_axis_model *m, double x[N])
{
	double y[N] = { 0 };

	for (int i = 0; i < N; i++)
		for (int j = 0; j < N; j++)
			y[i] += m->phi[i][j] * x[j];
	memcpy(x, y, sizeof(y));
}

void interp_axis_model_quotient(const struct interp_axis_model *m,
				struct interp_axis_quotient *ret)
{
	const double (*f)[N] = m->phi;
	double phi[N][N], x[N], h[N];

	/* phi[0][0] is 1 and nothing depends on the place, so one pole is at
	 * 1. */
	const double sum = f[1][1] + f[2][2];
	const double det = f[1][1] * f[2][2] - f[1][2] * f[2][1];

	ret->a[0] = -1 - sum;
	ret->a[1] = sum + det;
	ret->a[2] = -det;
	transition(&m->loop, m->period_s, phi, x);
	for (int i = 0; i < N; i++) {
		h[i] = x[0];		/* the place, so many periods later */
		advance(m, x);
	}
	ret->b[0] = h[0];
	ret->b[1] = h[1] + ret->a[0] * h[0];
	ret->b[2] = h[2] + ret->a[0] * h[1] + ret->a[1] * h[0];
}

/* The sum of c[i] z^(n - 1 - i) on the unit circle. */
static void on_circle(const double *c, int n, double angle, double ret[2])
{
	ret[0] = ret[1] = 0;
	for (int i = 0; i < n; i++) {
		ret[0] += c[i] * cos(angle * (n - 1 - i));
		ret[1] += c[i] * sin(angle * (n - 1 - i));
	}
}

/* The lag of the open loop beyond the quarter turn of its integrator, and its
 * size. */
static double lag_at(const struct interp_axis_quotient *q, double delay,
		     double angle, double *size)
{
	const double a[N + 1] = { 1, q->a[0], q->a[1], q->a[2] };
	double num[2], den[2], re, im, square;

	on_circle(q->b, N, angle, num);
	on_circle(a, N + 1, angle, den);
	square = den[0] * den[0] + den[1] * den[1];
	re = (num[0] * den[0] + num[1] * den[1]) / square;
	im = (num[1] * den[0] - num[0] * den[1]) / square;
	*size = hypot(re, im);
	return delay * angle + atan2(-re, -im);
}

double interp_axis_model_gain_max_1_s(const struct interp_axis_model *m)
{
	const double delay = m->loop.delay_s / m->period_s;
	struct interp_axis_quotient q;
	double low = 0, high = M_PI, size = 0;

	interp_axis_model_quotient(m, &q);
	/* The first angle at which the whole lag is half a turn. */
	for (int i = 1; i <= SEARCH; i++) {
		const double angle = M_PI * i / SEARCH;

		if (lag_at(&q, delay, angle, &size) >= M_PI / 2) {
			high = angle;
			break;
		}
		low = angle;
	}
	for (int i = 0; i < SEARCH; i++) {
		const double mid = (low + high) / 2;

		if (lag_at(&q, delay, mid, &size) >= M_PI / 2)
			high = mid;
		else
			low = mid;
	}
	return 1 / size;
}
