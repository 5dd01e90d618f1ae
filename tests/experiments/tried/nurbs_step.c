/* SPDX-License-Identifier: Apache-2.0 */
/*
 * nurbs_step.c - along a curve by steps of time
 *
 * A step is a search for du > 0 along the direction walked.  On most of a
 * curve Taylor's du is a good guess and one or two of Newton's corrections make
 * it exact; what may go wrong is seen by a few dot products:
 *
 *	C'(u0) . C'(u1) <= 0	a turn of more than 90 degrees: the chord may
 *				lead over a tip, and a nearer point at the same
 *				distance may lie before it
 *	turn * L / 4 > limit	the curve may leave the chord too far.  An arc
 *				that bends one way by an angle a is within
 *				L/2 tan(a/2) of its chord
 *
 * Then the slow search goes forward from u0 in small steps to the first place
 * that is too far or too curved, and halves from there.  Its steps are counted,
 * so is each correction.
 */
#include "tried/nurbs_step.h"

#include <errno.h>
#include <math.h>
#include <string.h>

#define CORRECTIONS	6
#define HALVINGS	60
#define MARCH		64		/* small steps of the slow search */
#define INNER		8		/* intervals of a checked chord */
#define TIP_HALVINGS	24
/* Of the limit: between inner points of a bend of one sense the error may be
 * 1/64 larger than at them. */
#define SEEN		0.984
#define EXACT		1e-9		/* of the step, chord against it */
#define CLOSE		0.999		/* of the limit, once it limits */

static const char *const names[INTERP_NURBS_NMETHODS] = {
	[INTERP_NURBS_EQUAL_PARAMETER]		= "equal-parameter",
	[INTERP_NURBS_EQUAL_CHORD]		= "equal-chord",
	[INTERP_NURBS_TAYLOR2]			= "taylor2",
	[INTERP_NURBS_PREDICTOR_CORRECTOR]	= "predictor-corrector",
};

const char *interp_nurbs_method_name(enum interp_nurbs_method m)
{
	return m < INTERP_NURBS_NMETHODS ? names[m] : NULL;
}

int interp_nurbs_method_parse(const char *name)
{
	for (int i = 0; i < INTERP_NURBS_NMETHODS; i++) {
		if (strcmp(names[i], name) == 0)
			return i;
	}
	return -EINVAL;
}

void interp_nurbs_stepper_init(struct interp_nurbs_stepper *s,
			       const struct interp_nurbs *c, double u,
			       enum interp_nurbs_method m)
{
	*s = (struct interp_nurbs_stepper) { .method = m };
	interp_nurbs_open(&s->e, c);
	s->u = fmin(fmax(u, interp_nurbs_first(c)), interp_nurbs_last(c));
	interp_nurbs_at(&s->e, s->u, 2, &s->p);
}

/* -- Distances ------------------------------------------------------------ */

static double distance(const struct interp_nurbs *c, const double *a,
		       const double *b)
{
	double d[INTERP_NAXES];

	for (uint32_t j = 0; j < c->naxes; j++)
		d[j] = a[j] - b[j];
	return sqrt(interp_nurbs_dot(c, d, d));
}

/* Of @p from the straight line between @a and @b, squared. */
static double off_chord2(const struct interp_nurbs *c, const double *a,
			 const double *b, const double *p)
{
	double ab[INTERP_NAXES], ap[INTERP_NAXES], along, ab2;

	for (uint32_t j = 0; j < c->naxes; j++) {
		ab[j] = b[j] - a[j];
		ap[j] = p[j] - a[j];
	}
	ab2 = interp_nurbs_dot(c, ab, ab);
	along = ab2 > 0 ? interp_nurbs_dot(c, ab, ap) / ab2 : 0;
	along = along > 0 ? along : 0;
	along = along < 1 ? along : 1;
	for (uint32_t j = 0; j < c->naxes; j++)
		ap[j] -= along * ab[j];
	return interp_nurbs_dot(c, ap, ap);
}

/* Between @from and @to the curve turns back: how far off the chord the tip
 * is, squared. */
static double off_tip2(struct interp_nurbs_eval *e, double from, double to,
		       const double *a, const double *b)
{
	struct interp_nurbs_point p, q;

	interp_nurbs_at(e, from, 1, &p);
	for (int i = 0; i < TIP_HALVINGS; i++) {
		const double middle = (from + to) / 2;

		interp_nurbs_at(e, middle, 1, &q);
		if (interp_nurbs_dot(&e->c, p.d[1], q.d[1]) > 0)
			from = middle;
		else
			to = middle;
	}
	return off_chord2(&e->c, a, b, q.d[0]);
}

/* The same for the curve between two of its points.  A tip that lies on the
 * chord's line, beyond an end, is between points that are on the chord. */
static double chord_error(struct interp_nurbs_eval *e, double from, double to,
			  const double *a, const double *b)
{
	const double step = (to - from) / INNER;
	struct interp_nurbs_point p[2];
	double most = 0;

	interp_nurbs_at(e, from, 1, &p[0]);
	for (int i = 1; i <= INNER; i++) {
		struct interp_nurbs_point *q = &p[i % 2];
		double d2 = 0;

		interp_nurbs_at(e, i < INNER ? from + i * step : to, 1, q);
		if (i < INNER)
			d2 = off_chord2(&e->c, a, b, q->d[0]);
		most = d2 > most ? d2 : most;
		if (interp_nurbs_dot(&e->c, p[0].d[1], p[1].d[1]) > 0)
			continue;
		d2 = off_tip2(e, from + (i - 1) * step, from + i * step, a, b);
		most = d2 > most ? d2 : most;
	}
	return sqrt(most);
}

double interp_nurbs_chord_error_mm(struct interp_nurbs_eval *e, double from,
				   double to)
{
	struct interp_nurbs_point a, b;

	interp_nurbs_at(e, from, 0, &a);
	interp_nurbs_at(e, to, 0, &b);
	return chord_error(e, from, to, a.d[0], b.d[0]);
}

/* -- A step in hand ------------------------------------------------------- */

struct search {
	struct interp_nurbs_stepper *s;
	double length_mm;		/* of the step, > 0 */
	double room;			/* du to the end of the curve */
	double sign;			/* of du */
	/* Where it has come to: */
	double du, chord_mm;
	struct interp_nurbs_point p;
};

static void try(struct search *k, double du)
{
	k->du = du < k->room ? du : k->room;
	interp_nurbs_at(&k->s->e, k->s->u + k->sign * k->du, 2, &k->p);
	k->chord_mm = distance(&k->s->e.c, k->s->p.d[0], k->p.d[0]);
}

/* du = L/|C'| - L^2 (C'.C'')/(2 |C'|^4); what is no step forward is taken by
 * the first term alone. */
static double taylor2(const struct search *k)
{
	const struct interp_nurbs *c = &k->s->e.c;
	const double *d1 = k->s->p.d[1], *d2 = k->s->p.d[2];
	const double speed2 = interp_nurbs_dot(c, d1, d1);
	const double bend = k->sign * interp_nurbs_dot(c, d1, d2);
	double first, du;

	if (!(speed2 > 0))
		return k->room / MARCH;
	first = k->length_mm / sqrt(speed2);
	du = first - first * first * bend / (2 * speed2);
	return du > 0 && isfinite(du) ? du : first;
}

/* Turned by less than 90 degrees since the step began? */
static bool ahead(const struct search *k)
{
	return interp_nurbs_dot(&k->s->e.c, k->s->p.d[1], k->p.d[1]) > 0;
}

/* Is the chord within the limit?  Where the turn is so small that it must be,
 * that is seen from the ends. */
static bool within(struct search *k)
{
	const double limit = SEEN * k->s->chord_error_mm;
	const struct interp_nurbs *c = &k->s->e.c;
	const double *a = k->s->p.d[1], *b = k->p.d[1];
	double ab, cos2;

	if (!(limit > 0))
		return true;
	ab = interp_nurbs_dot(c, a, b);
	cos2 = ab * ab /
	       (interp_nurbs_dot(c, a, a) * interp_nurbs_dot(c, b, b));
	/* tan(a/2) < sin a for a below 90 degrees. */
	if (ab > 0 && k->chord_mm * k->chord_mm / 4 * (1 - cos2) <
		      limit * limit / 4)
		return true;
	return chord_error(&k->s->e, k->s->u, k->s->u + k->sign * k->du,
			   k->s->p.d[0], k->p.d[0]) <= limit;
}

/* Neither too far nor too curved? */
static bool short_enough(struct search *k)
{
	return k->chord_mm <= k->length_mm && within(k);
}

/* The first du that is too much, by small steps and then by halves. */
static void search_first(struct search *k)
{
	const struct interp_nurbs *c = &k->s->e.c;
	const double speed = sqrt(interp_nurbs_dot(c, k->s->p.d[1],
						   k->s->p.d[1]));
	double low = 0, high = k->room, small = k->room / MARCH;

	if (speed > 0 && k->length_mm / speed / 8 < small)
		small = k->length_mm / speed / 8;
	/* Growing, so that the end is met within the count. */
	for (int i = 0; i < MARCH && low < k->room; i++) {
		try(k, low + small);
		if (!short_enough(k)) {
			high = k->du;
			break;
		}
		low = k->du;
		small *= 1.25;
	}
	if (low >= k->room)
		return;
	for (int i = 0; i < HALVINGS && high - low > 1e-15 * k->room; i++) {
		try(k, (low + high) / 2);
		if (short_enough(k))
			low = k->du;
		else
			high = k->du;
	}
	try(k, low);
}

/* Shorten until the limit is kept, but not much more than needed. */
static void shorten(struct search *k)
{
	const double limit = SEEN * k->s->chord_error_mm;
	double low = 0, high = k->du;

	for (int i = 0; i < HALVINGS; i++) {
		const double error = chord_error(&k->s->e, k->s->u,
			k->s->u + k->sign * k->du, k->s->p.d[0], k->p.d[0]);
		double du;

		if (error <= limit && error >= CLOSE * limit)
			return;
		if (error <= limit)
			low = k->du;
		else
			high = k->du;
		du = k->du * sqrt((1 + CLOSE) / 2 * limit / error);
		if (!(du > low && du < high))
			du = (low + high) / 2;
		try(k, du);
	}
	try(k, low);
}

/* How fast the chord grows with du. */
static double chord_slope(const struct search *k)
{
	double chord[INTERP_NAXES];

	for (uint32_t j = 0; j < k->s->e.c.naxes; j++)
		chord[j] = k->p.d[0][j] - k->s->p.d[0][j];
	return k->sign * interp_nurbs_dot(&k->s->e.c, chord, k->p.d[1]) /
	       k->chord_mm;
}

static void correct(struct search *k)
{
	for (int i = 0; i < CORRECTIONS && k->du < k->room; i++) {
		const double off = k->length_mm - k->chord_mm;
		const double by = chord_slope(k);

		if (fabs(off) <= EXACT * k->length_mm || !(by > 0) ||
		    !(k->du + off / by > 0))
			return;
		try(k, k->du + off / by);
	}
}

/* The end of the curve counts as far enough. */
static bool corrected(const struct search *k)
{
	if (k->du >= k->room && k->chord_mm <= k->length_mm)
		return true;
	return fabs(k->chord_mm / k->length_mm - 1) <= 1e-7;
}

static bool step_checked(struct search *k)
{
	try(k, taylor2(k));
	correct(k);
	if (!corrected(k) || !ahead(k)) {
		search_first(k);
		return k->du < k->room &&
		       k->chord_mm < k->length_mm * (1 - 1e-7);
	}
	if (within(k))
		return false;
	shorten(k);
	if (!ahead(k))
		search_first(k);
	return true;
}

static void step_by_chord(struct search *k)
{
	const double limit = k->s->chord_error_mm;

	k->s->chord_error_mm = 0;
	search_first(k);
	k->s->chord_error_mm = limit;
}

struct interp_nurbs_step interp_nurbs_step(struct interp_nurbs_stepper *s,
					   double step_mm)
{
	const double last = step_mm > 0 ? interp_nurbs_last(&s->e.c) :
					  interp_nurbs_first(&s->e.c);
	struct search k = { .s = s, .length_mm = fabs(step_mm),
			    .sign = step_mm > 0 ? 1 : -1,
			    .room = fabs(last - s->u) };
	bool limited = false;

	if (!(k.length_mm > 0) || k.room == 0)
		return (struct interp_nurbs_step) { 0, false, k.room == 0 };
	if (s->method == INTERP_NURBS_EQUAL_PARAMETER)
		try(&k, k.length_mm / s->mm_per_u);
	else if (s->method == INTERP_NURBS_TAYLOR2)
		try(&k, taylor2(&k));
	else if (s->method == INTERP_NURBS_EQUAL_CHORD)
		step_by_chord(&k);
	else
		limited = step_checked(&k);
	s->u = k.du < k.room ? s->u + k.sign * k.du : last;
	s->p = k.p;
	return (struct interp_nurbs_step) { k.chord_mm, limited,
					    k.du >= k.room };
}
