/* SPDX-License-Identifier: Apache-2.0 */
/*
 * tip_way.c - cuts a way of the tool's tip into straight lines of the axes
 *
 * As soon as a rotary axis turns, a line of the tip is a curve of the axes; a
 * curve of the tip always is.  Each piece is so short that the tip stays within
 * the tolerance of its way.  This is tested: the axes are put on the piece, and
 * the place of the tip is computed.
 */
#include "code/tip_way.h"

#include <math.h>
#include <string.h>

/* So many places of a piece are looked at.  Between them the way of the tip is
 * smooth as long as a piece turns by no more than this.  If it made whole
 * turns, every look might meet the same place. */
#define LOOKS		15
#define TURN_MAX_DEG	180.0

/* One way makes at most so many pieces, and none is shorter.  A curve may bend
 * within a millionth of its length; a rounding error is not a bend. */
#define PIECES_MAX	100000
#define PIECE_MIN	1e-10

/* A quarter of the tolerance lies between the ends of a turn in place.  They
 * are on the way: no place between them is farther from it than half of
 * that. */
#define IN_PLACE	(7.0 / 8)

#define STANDS_MM	1e-7
#define STILL_MM	1e-9		/* of a whole way: a rounding */

/* How far a part of a way leads. */
struct extent {
	double tip_mm;
	double turn_deg;		/* the farthest of the rotaries */
	double other_mm;		/* of U and V, which belong to no
					 * joint */
};

static double lerp(double a, double b, double t)
{
	return a + (b - a) * t;
}

static void place_at(const struct nc_tip_way *w, double t,
		     double ret_mm[INTERP_NAXES])
{
	w->at(w->of, t, ret_mm);
	for (int i = 0; i < INTERP_NAXES; i++)
		ret_mm[i] += lerp(w->off_mm[0][i], w->off_mm[1][i], t);
}

/* The axes at @t.  Axes that belong to no joint are as named. */
static int axes_at(const struct nc_reader *r, const struct nc_tip_way *w,
		   double t, double q[INTERP_NAXES])
{
	double tip[3];

	place_at(w, t, q);
	memcpy(tip, q, sizeof(tip));
	return interp_kin_place(&r->tool.k, tip, q);
}

/* The length from @a to @b along @n axes, from @first on. */
static double span(const double *a, const double *b, int first, int n)
{
	double sum = 0;

	for (int i = first; i < first + n; i++)
		sum += (b[i] - a[i]) * (b[i] - a[i]);
	return sqrt(sum);
}

/* How far the tip, where the axes at @q put it, is from where it should be. */
static double off_mm(const struct interp_kinematics *k,
		     const double q[INTERP_NAXES],
		     const double want_mm[INTERP_NAXES])
{
	struct interp_kin_pose p;
	double off;

	interp_kin_forward(k, q, &p);
	off = span(p.tip_mm, want_mm, 0, 3);
	for (int i = 3; i < INTERP_NAXES; i++)
		off = fmax(off, fabs(q[i] - want_mm[i]));
	return off;
}

/* A piece: a part of the way, and the axes at its ends. */
struct piece {
	double t0, t1;
	double q0[INTERP_NAXES], q1[INTERP_NAXES];
};

/* How far the tip leaves its way while the axes go straight. */
static double stray_mm(const struct nc_reader *r, const struct nc_tip_way *w,
		       const struct piece *p)
{
	double most = 0;

	for (int n = 1; n <= LOOKS; n++) {
		const double u = n / (LOOKS + 1.0);
		double q[INTERP_NAXES], want[INTERP_NAXES];

		place_at(w, lerp(p->t0, p->t1, u), want);
		for (int i = 0; i < INTERP_NAXES; i++)
			q[i] = lerp(p->q0[i], p->q1[i], u);
		most = fmax(most, off_mm(&r->tool.k, q, want));
	}
	return most;
}

/* Linear axes that move only by a rounding error stand still. */
static void settle(const double q0[INTERP_NAXES], double q1[INTERP_NAXES])
{
	for (int i = 0; i < 3; i++) {
		if (fabs(q1[i] - q0[i]) > STANDS_MM)
			return;
	}
	memcpy(q1, q0, 3 * sizeof(*q1));
}

static struct extent measure(const struct nc_tip_way *w, double t0, double t1)
{
	double a[INTERP_NAXES], b[INTERP_NAXES], turn[3] = { 0 };
	struct extent e = { 0 };

	place_at(w, t0, a);
	for (int n = 1; n <= LOOKS + 1; n++) {
		place_at(w, lerp(t0, t1, n / (LOOKS + 1.0)), b);
		e.tip_mm += span(a, b, INTERP_X, 3);
		e.other_mm += span(a, b, INTERP_U, 2);
		for (int i = 0; i < 3; i++)
			turn[i] += fabs(b[INTERP_A + i] - a[INTERP_A + i]);
		memcpy(a, b, sizeof(a));
	}
	e.turn_deg = fmax(turn[0], fmax(turn[1], turn[2]));
	return e;
}

/* F is the feed of the tip.  If the tip stands still on the whole way, as in a
 * turn in place, F belongs to what moves. */
static double seconds(const struct nc_reader *r, const struct nc_tip_way *w,
		      const struct extent *whole, const struct extent *part)
{
	const bool turns = whole->turn_deg > STILL_MM;

	if (whole->tip_mm > STILL_MM && !(w->in_place && turns))
		return part->tip_mm / r->feed_mm_s;
	if (turns)
		return part->turn_deg / r->feed_deg_s;
	return part->other_mm / r->feed_mm_s;
}

/* The way may have begun in an earlier line. */
static int blame_way(struct nc_reader *r, int rc)
{
	if (r->word.line != r->line) {
		r->diag->line = r->word.line;
		r->diag->column = 0;
	}
	return rc;
}

static int refuse_pieces(struct nc_reader *r)
{
	return blame_way(r, nc_refuse(r, r->line_at, "a shorter way or turn, "
				      "or a larger kinematics.tolerance_um",
				      "more than %d pieces in one line",
				      PIECES_MAX));
}

static int refuse_place(struct nc_reader *r)
{
	return blame_way(r, nc_refuse(r, r->line_at, "rotaries at which the "
				      "linear axes span space", "a pose that "
				      "the linear axes cannot reach"));
}

/* Make @p as long as possible, at most up to its t1.  Set its end, and the axes
 * in q1. */
static int cut_piece(struct nc_reader *r, const struct nc_tip_way *w,
		     struct piece *p)
{
	const double most = r->o->tip_tolerance_mm *
			    (w->in_place ? IN_PLACE : 1);

	for (;;) {
		if (axes_at(r, w, p->t1, p->q1))
			return refuse_place(r);
		if (stray_mm(r, w, p) <= most)
			break;
		if (p->t1 - p->t0 < PIECE_MIN)
			return refuse_pieces(r);
		p->t1 = (p->t0 + p->t1) / 2;
	}
	settle(p->q0, p->q1);
	return 0;
}

static int emit_piece(struct nc_reader *r, const struct nc_tip_way *w,
		      const struct extent *whole, const struct piece *p)
{
	int err = nc_room(r);

	if (err)
		return err;
	if (!r->word.rapid) {
		const struct extent part = measure(w, p->t0, p->t1);
		const double s = seconds(r, w, whole, &part);
		const double fed = interp_build_fed_mm(r->contour.guides.build,
						       p->q0, p->q1);

		if (s > 0 && fed > 0)
			r->word.feed_mm_s = fed / s;
	}
	err = contour_line(&r->contour, p->q1, &r->word, r->diag);
	return nc_placed(r, err, p->q1);
}

int nc_tip_way(struct nc_reader *r, const struct nc_tip_way *w)
{
	const struct extent whole = measure(w, 0, 1);
	const double most = fmin(1, TURN_MAX_DEG / w->turn_deg);
	struct piece p = { .t0 = 0 };
	double step = most;
	uint32_t pieces = 0;
	int err = most < 1.0 / PIECES_MAX ? refuse_pieces(r) : 0;

	memcpy(p.q0, r->contour.here_mm, sizeof(p.q0));
	while (!err && p.t0 < 1) {
		p.t1 = fmin(1, p.t0 + step);
		err = pieces++ == PIECES_MAX ? refuse_pieces(r) :
					      cut_piece(r, w, &p);
		if (!err)
			err = emit_piece(r, w, &whole, &p);
		/* The length that was right here may be right again, or
		 * more. */
		step = fmin(2 * (p.t1 - p.t0), most);
		p.t0 = p.t1;
		memcpy(p.q0, p.q1, sizeof(p.q0));
	}
	return err;
}
