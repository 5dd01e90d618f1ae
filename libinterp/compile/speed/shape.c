/* SPDX-License-Identifier: Apache-2.0 */
/* shape.c - the curve that a run of short lines stands for */
#include "speed/shape.h"

#include "speed/band.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#define DEGREE		5
#define ORDER		(DEGREE + 1)	/* functions on an interval */

#define LONGEST_MM	8.0
#define SHORTEST_MM	0.01		/* shorter, a bend is a corner */
#define POINTS_LEAST	3		/* of an interval that is halved */
#define HALVINGS	24
#define GRADE		4.1		/* an interval to its neighbour */

/* It only keeps the equations regular: of the third derivative, over so much
 * of an interval. */
#define STIFF		0.05

/* -- Functions of an interval ---------------------------------------------- */

/* The polynomials, by the share u of the interval. */
struct basis {
	double of[ORDER][ORDER];	/* function, power of u */
};

/* To functions of one more degree, over interval @k. */
static void raise_degree(const double *t, size_t k, int degree,
			 struct basis *b)
{
	const double h = t[k + 1] - t[k];
	struct basis up = { { { 0 } } };

	for (int r = 0; r < degree; r++) {
		const size_t i = k + (size_t)(r + 1) - (size_t)degree;
		const double by = 1 / (t[i + (size_t)degree] - t[i]);
		const double from = (t[k] - t[i]) * by;

		/* It is a part of the next function, and of the one before. */
		for (int e = 0; e < degree; e++) {
			up.of[r + 1][e] += from * b->of[r][e];
			up.of[r + 1][e + 1] += h * by * b->of[r][e];
			up.of[r][e] += (1 - from) * b->of[r][e];
			up.of[r][e + 1] -= h * by * b->of[r][e];
		}
	}
	*b = up;
}

static void basis_of(const struct shape *f, size_t interval, struct basis *ret)
{
	*ret = (struct basis) { { { 1 } } };
	for (int d = 1; d <= DEGREE; d++)
		raise_degree(f->knot_mm, interval + DEGREE, d, ret);
}

static double polynomial(const double c[ORDER], double u)
{
	double y = c[DEGREE];

	for (int e = DEGREE - 1; e >= 0; e--)
		y = y * u + c[e];
	return y;
}

static double begin_mm(const struct shape *f, size_t interval)
{
	return f->knot_mm[interval + DEGREE];
}

/* Column @k of an interval, by the share u of it. */
static double *column_of(const struct shape *f, size_t interval, uint32_t k)
{
	return f->c + (interval * f->columns + k) * ORDER;
}

/* From @by, so much of each function in each column. */
static int to_polynomials(struct shape *f, const double *by)
{
	double *c = calloc(f->n * f->columns, ORDER * sizeof(*c));
	struct basis b;

	if (!c)
		return -ENOMEM;
	free(f->c);
	f->c = c;
	for (size_t i = 0; i < f->n; i++) {
		basis_of(f, i, &b);
		for (uint32_t k = 0; k < f->columns; k++, c += ORDER)
			for (size_t r = 0; r < ORDER; r++)
				for (int e = 0; e < ORDER; e++)
					c[e] += b.of[r][e] *
						by[(i + r) * f->columns + k];
	}
	return 0;
}

/* -- Least squares --------------------------------------------------------- */

static void add_point(const struct shape_points *p, size_t i,
		      const double by[ORDER], struct band *eq, size_t interval)
{
	const double *x = p->x + i * p->columns;

	for (size_t r = 0; r < ORDER; r++) {
		const double w = p->weight[i] * by[r];
		double *row = eq->a + (interval + r) * BAND_WIDTH;

		for (size_t q = r; q < ORDER; q++)
			row[q - r] += w * by[q];
		for (uint32_t k = 0; k < p->columns; k++)
			eq->b[(interval + r) * p->columns + k] += w * x[k];
	}
}

/* STIFF^6 h times the integral of the third derivative's square, by u, at three
 * places. */
static void add_stiffness(const struct basis *b, size_t interval, double h,
			  struct band *eq)
{
	static const double at[] = { 0.1127016653792583, 0.5,
				     0.8872983346207417 };
	static const double share[] = { 5 / 18., 8 / 18., 5 / 18. };
	const double stiff = pow(STIFF, 6) * h;

	for (int g = 0; g < 3; g++) {
		double third[ORDER];

		for (int r = 0; r < ORDER; r++)
			third[r] = 6 * b->of[r][3] + 24 * b->of[r][4] * at[g] +
				   60 * b->of[r][5] * at[g] * at[g];
		for (size_t r = 0; r < ORDER; r++)
			for (size_t q = r; q < ORDER; q++)
				eq->a[(interval + r) * BAND_WIDTH + q - r] +=
					stiff * share[g] * third[r] * third[q];
	}
}

/* Is point @i on this interval?  The last one has the end. */
static bool is_on(const struct shape *f, const struct shape_points *p,
		  size_t interval, size_t i)
{
	return i < p->n && (interval + 1 == f->n ||
			    p->s_mm[i] < begin_mm(f, interval + 1));
}

static int solve(struct shape *f, const struct shape_points *p)
{
	struct band eq;
	size_t i = 0;
	int err;

	if (band_make(&eq, f->n + DEGREE, f->columns) < 0)
		return -ENOMEM;
	for (size_t k = 0; k < f->n; k++) {
		const double from = begin_mm(f, k);
		const double h = begin_mm(f, k + 1) - from;
		struct basis b;

		basis_of(f, k, &b);
		for (; is_on(f, p, k, i); i++) {
			double by[ORDER];

			for (int r = 0; r < ORDER; r++)
				by[r] = polynomial(b.of[r],
						   (p->s_mm[i] - from) / h);
			add_point(p, i, by, &eq, k);
		}
		add_stiffness(&b, k, h, &eq);
	}
	band_solve(&eq);
	err = to_polynomials(f, eq.b);
	band_free(&eq);
	return err;
}

/* -- Intervals ------------------------------------------------------------- */

/* Knots before the first and behind the last interval lie on its ends. */
static void clamp(struct shape *f)
{
	for (size_t i = 0; i < DEGREE; i++) {
		f->knot_mm[i] = f->knot_mm[DEGREE];
		f->knot_mm[f->n + DEGREE + 1 + i] = f->knot_mm[f->n + DEGREE];
	}
}

/* How far off the points of an interval are, as a share of their boxes. */
struct off {
	double most;
	size_t at, points;
};

static struct off off_of(const struct shape *f, const struct shape_points *p,
			 size_t interval, size_t first)
{
	const double from = begin_mm(f, interval);
	const double h = begin_mm(f, interval + 1) - from;
	struct off ret = { 0, first, 0 };

	for (uint32_t k = 0; k < f->columns; k++) {
		const double *c = column_of(f, interval, k);
		size_t i = first;

		for (; is_on(f, p, interval, i); i++) {
			const size_t at = i * p->columns + k;
			const double off = fabs(polynomial(
				c, (p->s_mm[i] - from) / h) - p->x[at]) /
					   p->box[at];

			if (off > ret.most) {
				ret.most = off;
				ret.at = i;
			}
		}
		ret.points = i - first;
	}
	return ret;
}

/* Which intervals to halve.  Return: how many; @ret_corner: a point beside
 * which none can be. */
static size_t look(const struct shape *f, const struct shape_points *p,
		   uint8_t *halve, size_t *ret_corner)
{
	size_t some = 0, i = 0;
	double most = 1;

	for (size_t k = 0; k < f->n; k++) {
		const double h = begin_mm(f, k + 1) - begin_mm(f, k);
		const struct off o = off_of(f, p, k, i);

		i += o.points;
		halve[k] = o.most > 1 && o.points >= POINTS_LEAST &&
			   h / 2 >= SHORTEST_MM;
		some += halve[k];
		if (o.most > most && !halve[k]) {
			most = o.most;
			*ret_corner = o.at;
		}
	}
	return some;
}

static double next_mm(const struct shape *f, const uint8_t *halve, size_t k)
{
	const double h = begin_mm(f, k + 1) - begin_mm(f, k);

	return halve[k] ? h / 2 : h;
}

/* Forward and back once: a neighbour of what is halved may be, too. */
static void grade(const struct shape *f, uint8_t *halve)
{
	for (size_t k = 1; k < f->n; k++)
		if (next_mm(f, halve, k) > GRADE * next_mm(f, halve, k - 1))
			halve[k] = 1;
	for (size_t k = f->n - 1; k-- > 0;)
		if (next_mm(f, halve, k) > GRADE * next_mm(f, halve, k + 1))
			halve[k] = 1;
}

static int halve_some(struct shape *f, const uint8_t *halve)
{
	double *knot;
	size_t n = 0;

	for (size_t k = 0; k < f->n; k++)
		n += 1u + halve[k];
	knot = malloc((n + 2 * DEGREE + 1) * sizeof(*knot));
	if (!knot)
		return -ENOMEM;
	n = DEGREE;
	for (size_t k = 0; k < f->n; k++) {
		knot[n++] = begin_mm(f, k);
		if (halve[k])
			knot[n++] = (begin_mm(f, k) + begin_mm(f, k + 1)) / 2;
	}
	knot[n] = begin_mm(f, f->n);
	free(f->knot_mm);
	f->knot_mm = knot;
	f->n = n - DEGREE;
	clamp(f);
	return 0;
}

/* Once: solve, look, and halve.  Return: 1: again, 0: it is found, or there is
 * a corner; -ENOMEM. */
static int fit_once(struct shape *f, const struct shape_points *p,
		    size_t *ret_corner)
{
	uint8_t *halve;
	int err = solve(f, p);

	if (err < 0)
		return err;
	halve = malloc(f->n);
	if (!halve)
		return -ENOMEM;
	if (look(f, p, halve, ret_corner) > 0 && *ret_corner == p->n) {
		grade(f, halve);
		err = halve_some(f, halve);
		err = err < 0 ? err : 1;
	}
	free(halve);
	return err;
}

int shape_fit(const struct shape_points *p, struct shape *ret,
	      size_t *ret_corner)
{
	const double from = p->s_mm[0], mm = p->s_mm[p->n - 1] - from;
	int more = 1;

	*ret_corner = p->n;
	*ret = (struct shape) { .columns = p->columns,
				.n = (size_t)ceil(mm / LONGEST_MM) };
	ret->knot_mm = malloc((ret->n + 2 * DEGREE + 1) * sizeof(double));
	if (!ret->knot_mm)
		return -ENOMEM;
	for (size_t k = 0; k <= ret->n; k++)
		ret->knot_mm[DEGREE + k] = from + mm * (double)k /
							(double)ret->n;
	clamp(ret);
	for (int i = 0; more > 0 && i < HALVINGS; i++)
		more = fit_once(ret, p, ret_corner);
	if (more < 0)
		shape_free(ret);
	return more < 0 ? more : 0;
}

void shape_free(struct shape *f)
{
	free(f->knot_mm);
	free(f->c);
	*f = (struct shape) { 0 };
}

/* -- At a place ------------------------------------------------------------ */

static size_t interval_at(const struct shape *f, double s_mm)
{
	size_t from = 0, to = f->n;

	while (to - from > 1) {
		const size_t k = (from + to) / 2;

		if (begin_mm(f, k) <= s_mm)
			from = k;
		else
			to = k;
	}
	return from;
}

/* Its value and its derivatives by u. */
static void derivatives(const double c[ORDER], double u, double ret[4])
{
	memset(ret, 0, 4 * sizeof(*ret));
	for (int e = DEGREE; e >= 0; e--) {
		ret[3] = ret[3] * u + 3 * ret[2];
		ret[2] = ret[2] * u + 2 * ret[1];
		ret[1] = ret[1] * u + ret[0];
		ret[0] = ret[0] * u + c[e];
	}
}

void shape_way(const struct shape *f, double s_mm, double *ret)
{
	const size_t k = interval_at(f, s_mm);
	const double h = begin_mm(f, k + 1) - begin_mm(f, k);

	for (uint32_t j = 0; j < f->columns; j++) {
		double d[4];

		derivatives(column_of(f, k, j), (s_mm - begin_mm(f, k)) / h, d);
		*ret++ = d[1] / h;
		*ret++ = d[2] / (h * h);
		*ret++ = d[3] / (h * h * h);
	}
}
