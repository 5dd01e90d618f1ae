/* SPDX-License-Identifier: Apache-2.0 */
/*
 * build_fit.c - joins consecutive cut lines into curves within a tolerance
 *
 * Lines of the same feed and condition are held back, at most a few thousand.
 * They are divided at corners.  Each part becomes a curve if one is found that
 * stays within the tolerance.  Otherwise its halves are tried.  What is left
 * stays as lines.
 */
#include "interp/nurbs_fit.h"
#include "path/build_arc.h"
#include "path/builder.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Shorter rows of lines stay as they are. */
#define PART_MIN	8

struct part {
	struct interp_build *b;
	struct interp_diag *diag;
	struct interp_fit fit;		/* of all points held */
	uint8_t axis[INTERP_NAXES];
};

/* -- Collecting
 * ------------------------------------------------------------- */

static bool same_word(const struct interp_build_word *a,
		      const struct interp_build_word *b)
{
	return a->feed_mm_s == b->feed_mm_s &&
	       a->cond_letter == b->cond_letter &&
	       a->cond_number == b->cond_number;
}

static int keep(struct build_fit *f, const double at_mm[INTERP_NAXES],
		uint32_t line)
{
	if (!f->end_mm) {
		f->end_mm = malloc(INTERP_FIT_POINTS_MAX * INTERP_NAXES *
				   sizeof(*f->end_mm));
		f->lines = malloc(INTERP_FIT_POINTS_MAX * sizeof(*f->lines));
	}
	if (!f->end_mm || !f->lines)
		return -ENOMEM;
	memcpy(f->end_mm + (size_t)f->n * INTERP_NAXES, at_mm,
	       INTERP_NAXES * sizeof(*at_mm));
	f->lines[f->n++] = line;
	return 0;
}

/* Hold a line back. */
static int build_fit_add(struct interp_build *b,
			 const double end_mm[INTERP_NAXES],
			 const struct interp_build_word *w,
			 struct interp_diag *diag)
{
	const double *here = interp_build_here(b);
	struct build_fit *f = &b->fit;
	int err = 0;

	for (int i = 0; i < INTERP_NAXES; i++) {
		if (end_mm[i] != here[i] &&
		    !build_axis_ok(b, i, end_mm[i]))
			return build_refuse_travel(b, i, end_mm[i], diag);
	}
	if (f->n == INTERP_FIT_POINTS_MAX ||
	    (f->n > 0 && !same_word(&f->word, w)))
		err = interp_build_flush(b, diag);
	if (err == 0 && f->n == 0) {
		f->word = *w;
		err = keep(f, b->here_mm, w->line);
	}
	if (err == 0 && memcmp(end_mm, interp_build_here(b),
			     INTERP_NAXES * sizeof(*end_mm)) != 0)
		err = keep(f, end_mm, w->line);
	return err;
}

/* -- Writing
 * ---------------------------------------------------------------- */

static int lay_lines(struct part *p, uint32_t from, uint32_t to)
{
	const struct build_fit *f = &p->b->fit;
	int err = 0;

	for (uint32_t i = from + 1; err == 0 && i <= to; i++) {
		struct interp_build_word w = f->word;

		w.line = f->lines[i];
		err = build_line(p->b, f->end_mm + (size_t)i * INTERP_NAXES, &w,
			       p->diag);
	}
	return err;
}

/* The state of the builder before a curve, to return to it. */
struct before {
	size_t segs, curves, pieces, stops, numbers;
	double here_mm[INTERP_NAXES], length_mm;
	int64_t here[INTERP_NAXES];
	struct build_descent descent;
	uint16_t stand_escape;
};

static struct before before(const struct interp_build *b)
{
	struct before was = {
		.segs = b->segs.n, .curves = b->curves.n,
		.pieces = b->pieces.n, .stops = b->stops.n,
		.numbers = b->numbers.n, .length_mm = b->length_mm,
		.descent = b->descent, .stand_escape = b->stand_escape,
	};

	memcpy(was.here_mm, b->here_mm, sizeof(was.here_mm));
	memcpy(was.here, b->here, sizeof(was.here));
	return was;
}

static void undo(struct interp_build *b, const struct before *was)
{
	b->segs.n = was->segs;
	b->nodes.n = b->naxes ? (was->segs + 1) * b->naxes : 0;
	b->curves.n = was->curves;
	b->pieces.n = was->pieces;
	b->stops.n = was->stops;
	b->numbers.n = was->numbers;
	b->length_mm = was->length_mm;
	b->descent = was->descent;
	b->stand_escape = was->stand_escape;
	memcpy(b->here_mm, was->here_mm, sizeof(was->here_mm));
	memcpy(b->here, was->here, sizeof(was->here));
}

/* The parameter of the curve is the length along the polygon. */
static void set_marks(const struct part *p, uint32_t from, uint32_t n,
		      struct interp_build_mark *marks)
{
	const uint32_t axes = p->fit.naxes;
	const double *a = p->fit.points + (size_t)from * axes;
	double u = 0;

	for (uint32_t i = 0; i + 1 < n; i++) {
		double d2 = 0;

		marks[i] = (struct interp_build_mark) {
			u, p->b->fit.lines[from + i + 1]
		};
		for (uint32_t j = 0; j < axes; j++, a++)
			d2 += (a[axes] - a[0]) * (a[axes] - a[0]);
		u += sqrt(d2);
	}
}

/* Return: 1: no curve fits, or the lines need less memory. */
static int lay_curve(struct part *p, uint32_t from, uint32_t to)
{
	const uint32_t n = to - from + 1, axes = p->fit.naxes;
	const struct interp_fit fit = {
		p->fit.points + (size_t)from * axes, n, axes,
		p->fit.tolerance_mm
	};
	struct interp_nurbs_own own = {
		.knots = malloc((n + 4) * sizeof(double)),
		.points = malloc((size_t)n * (axes + 1) * sizeof(double)),
		.room = n,
	};
	struct interp_build_mark *marks = malloc(n * sizeof(*marks));
	const struct before was = before(p->b);
	int err = own.knots && own.points && marks ?
		interp_nurbs_fit(&fit, &own) : -ENOMEM;

	if (err == 0 && own.c.npoints * 2 > n)
		err = -ERANGE;
	if (err == 0) {
		struct interp_build_curve c = { .nurbs = own.c, .marks = marks,
						.nmarks = n - 1 };

		memcpy(c.axis, p->axis, sizeof(c.axis));
		set_marks(p, from, n, marks);
		err = interp_build_curve(p->b, &c, &p->b->fit.word, p->diag);
	}
	if (err < 0 && err != -ENOMEM) {
		undo(p->b, &was);
		p->diag->line = 0;
	}
	free(own.knots);
	free(own.points);
	free(marks);
	return err == -ENOMEM ? err : err < 0;
}

static int lay_part(struct part *p, uint32_t from, uint32_t to)
{
	const uint32_t middle = from + (to - from) / 2;
	int err = 1;

	if (to - from >= PART_MIN)
		err = lay_curve(p, from, to);
	if (err <= 0)
		return err;
	if (to - from < 2 * PART_MIN)
		return lay_lines(p, from, to);
	err = lay_part(p, from, middle);
	return err == 0 ? lay_part(p, middle, to) : err;
}

/* Keep only the axes that move. */
static int take_axes(struct part *p, uint32_t n)
{
	const double *all = p->b->fit.end_mm;
	double *points;

	p->fit.naxes = 0;
	for (uint8_t a = 0; a < INTERP_NAXES; a++) {
		bool moves = false;

		for (uint32_t i = 1; i < n && !moves; i++)
			moves = all[(size_t)i * INTERP_NAXES + a] != all[a];
		if (moves)
			p->axis[p->fit.naxes++] = a;
	}
	points = malloc(((size_t)n * p->fit.naxes + 1) * sizeof(*points));
	p->fit.points = points;
	for (uint32_t i = 0; points && i < n; i++) {
		for (uint32_t j = 0; j < p->fit.naxes; j++)
			*points++ = all[(size_t)i * INTERP_NAXES + p->axis[j]];
	}
	return p->fit.points ? 0 : -ENOMEM;
}

/* At least two points. */
static int flush(struct interp_build *b, struct interp_diag *diag)
{
	struct part p = { .b = b, .diag = diag,
			  .fit = { .npoints = b->fit.n,
				   .tolerance_mm = b->o.fit_mm } };
	const uint32_t n = b->fit.n;
	uint32_t from = 0;
	int err;

	b->fit.n = 0;
	err = take_axes(&p, n);
	for (uint32_t i = 1; err == 0 && i < n; i++) {
		if (i + 1 < n && !interp_fit_corner(&p.fit, i))
			continue;
		err = lay_part(&p, from, i);
		from = i;
	}
	free((void *)p.fit.points);
	return err;
}

int interp_build_flush(struct interp_build *b, struct interp_diag *diag)
{
	if (b->fit.n >= 2)
		return flush(b, diag);
	b->fit.n = 0;
	return 0;
}

/* A builder that may hold lines back.  What few need is not in the way of all
 * others. */
__attribute__((noinline))
static int fit_line(struct interp_build *b, const double end_mm[INTERP_NAXES],
		    const struct interp_build_word *w, struct interp_diag *diag)
{
	int err;

	if (b->again.counts)
		return build_count_line(b, end_mm, w, diag);
	if (!w->rapid && !w->ends && !b->escape && b->lift_axis < 0)
		return build_fit_add(b, end_mm, w, diag);
	err = interp_build_flush(b, diag);
	return err ? err : build_line(b, end_mm, w, diag);
}

int interp_build_line(struct interp_build *b, const double end_mm[INTERP_NAXES],
		      const struct interp_build_word *w,
		      struct interp_diag *diag)
{
	return b->o.fit_mm > 0 ? fit_line(b, end_mm, w, diag) :
				 build_line(b, end_mm, w, diag);
}
