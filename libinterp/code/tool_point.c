/* SPDX-License-Identifier: Apache-2.0 */
/*
 * tool_point.c - G43.4: X Y Z are places of the tool's tip, seen from the work
 *
 * A straight line of the tip is a curve of the axes as soon as a rotary turns.
 * It is cut into straight lines of the axes, each so short that the tip stays
 * within the tolerance of its own line: tried by putting the axes on the piece
 * and looking where the tip is.  The rotaries go in proportion to the tip.
 */
#include "code/reader.h"

#include <errno.h>
#include <math.h>
#include <string.h>

/* Places of a piece that are looked at; between them the tip's way is smooth,
 * as long as a piece turns by no more than this: of whole turns every look may
 * meet the same place. */
#define LOOKS		7
#define TURN_MAX_DEG	180.0

/* One line of the text makes no more pieces than this. */
#define PIECES_MAX	100000

#define STANDS_MM	1e-7

struct tip_line {
	const struct interp_kinematics *k;
	double from_mm[INTERP_NAXES], to_mm[INTERP_NAXES];	/* tip, rotaries */
	double tip_mm;			/* length of the tip's way */
	double turn_deg;		/* the farthest of the rotaries */
	double other_mm;		/* of U and V, which no joint has */
};

static double lerp(double a, double b, double t)
{
	return a + (b - a) * t;
}

/* The axes at part @t of the line: those that no joint has are as named. */
static int axes_at(const struct tip_line *l, double t, double q[INTERP_NAXES])
{
	double tip[3];

	for (int i = 0; i < INTERP_NAXES; i++)
		q[i] = t < 1 ? lerp(l->from_mm[i], l->to_mm[i], t) :
			       l->to_mm[i];
	memcpy(tip, q, sizeof(tip));
	return interp_kin_place(l->k, tip, q);
}

/* How far the tip strays from its line while the axes go straight. */
static double stray_mm(const struct tip_line *l, double t0, double t1,
		       const double q0[INTERP_NAXES],
		       const double q1[INTERP_NAXES])
{
	double most = 0;

	for (int n = 1; n <= LOOKS; n++) {
		const double u = n / (LOOKS + 1.0), t = lerp(t0, t1, u);
		double q[INTERP_NAXES], off = 0;
		struct interp_kin_pose p;

		for (int i = 0; i < INTERP_NAXES; i++)
			q[i] = lerp(q0[i], q1[i], u);
		interp_kin_forward(l->k, q, &p);
		for (int i = 0; i < 3; i++) {
			const double d = p.tip_mm[i] -
					 lerp(l->from_mm[i], l->to_mm[i], t);

			off += d * d;
		}
		most = fmax(most, sqrt(off));
	}
	return most;
}

/* Linear axes that stand but for a rounding: they stand. */
static void settle(const double q0[INTERP_NAXES], double q1[INTERP_NAXES])
{
	for (int i = 0; i < 3; i++) {
		if (fabs(q1[i] - q0[i]) > STANDS_MM)
			return;
	}
	memcpy(q1, q0, 3 * sizeof(*q1));
}

/* Length from @a to @b along @n axes, @first and on. */
static double span(const double *a, const double *b, int first, int n)
{
	double sum = 0;

	for (int i = first; i < first + n; i++)
		sum += (b[i] - a[i]) * (b[i] - a[i]);
	return sqrt(sum);
}

/* F is that of the tip; the path's length is counted on the linear axes. */
static double piece_feed(const struct tip_line *l, double part,
			 const double q0[INTERP_NAXES],
			 const double q1[INTERP_NAXES],
			 const struct nc_reader *r)
{
	const double s = l->tip_mm > 0 ? l->tip_mm / r->feed_mm_s :
			 l->turn_deg > 0 ? l->turn_deg / r->feed_deg_s :
					   l->other_mm / r->feed_mm_s;
	double path = span(q0, q1, INTERP_X, 3);

	if (!(path > 0))
		path = span(q0, q1, INTERP_U, 2);
	if (!(path > 0))
		path = span(q0, q1, INTERP_A, 3);
	return path / (s * part);
}

static int refuse_pieces(struct nc_reader *r)
{
	return nc_refuse(r, r->line_at, "a shorter turn, or a larger "
			 "kinematics.tolerance_um",
			 "more than %d pieces in one line", PIECES_MAX);
}

static int refuse_place(struct nc_reader *r)
{
	return nc_refuse(r, r->line_at, "rotaries at which the linear axes "
			 "span space", "a pose that the linear axes cannot "
			 "reach");
}

/* The piece from @t0, as long as it may be: its end in @t1, axes in @q1. */
static int cut_piece(struct nc_reader *r, const struct tip_line *l, double t0,
		     const double q0[INTERP_NAXES], double *t1)
{
	double q1[INTERP_NAXES];

	for (;;) {
		if (axes_at(l, *t1, q1))
			return refuse_place(r);
		if (stray_mm(l, t0, *t1, q0, q1) <= r->o->tip_tolerance_mm)
			return 0;
		if (*t1 - t0 < 1.0 / PIECES_MAX)
			return refuse_pieces(r);
		*t1 = (t0 + *t1) / 2;
	}
}

static int emit_piece(struct nc_reader *r, const struct tip_line *l,
		      double part, const double q0[INTERP_NAXES],
		      const double q1[INTERP_NAXES])
{
	int rc = nc_room(r);

	if (rc)
		return rc;
	if (!r->word.rapid)
		r->word.feed_mm_s = piece_feed(l, part, q0, q1, r);
	rc = contour_line(&r->contour, q1, &r->word, r->diag);
	return nc_placed(r, rc, q1);
}

static void measure_line(struct tip_line *l)
{
	for (int i = INTERP_A; i <= INTERP_C; i++)
		l->turn_deg = fmax(l->turn_deg,
				   fabs(l->to_mm[i] - l->from_mm[i]));
	l->tip_mm = span(l->from_mm, l->to_mm, INTERP_X, 3);
	l->other_mm = span(l->from_mm, l->to_mm, INTERP_U, 2);
}

int nc_tip_line(struct nc_reader *r, const double end_mm[INTERP_NAXES],
		bool rapid)
{
	struct tip_line l = { .k = &r->tool.k };
	double q0[INTERP_NAXES], q1[INTERP_NAXES], t0 = 0, step, most;

	r->word.rapid = rapid;
	memcpy(l.from_mm, r->tool.here_mm, sizeof(l.from_mm));
	memcpy(l.to_mm, end_mm, sizeof(l.to_mm));
	measure_line(&l);
	step = most = fmin(1, TURN_MAX_DEG / l.turn_deg);
	if (most < 1.0 / PIECES_MAX)
		return refuse_pieces(r);
	memcpy(q0, r->contour.here_mm, sizeof(q0));
	while (t0 < 1) {
		double t1 = fmin(1, t0 + step);
		int rc = cut_piece(r, &l, t0, q0, &t1);

		if (rc)
			return rc;
		axes_at(&l, t1, q1);
		settle(q0, q1);
		rc = emit_piece(r, &l, t1 - t0, q0, q1);
		if (rc)
			return rc;
		/* What was long enough here may do, or more. */
		step = fmin(2 * (t1 - t0), most);
		t0 = t1;
		memcpy(q0, q1, sizeof(q0));
	}
	memcpy(r->tool.here_mm, end_mm, sizeof(r->tool.here_mm));
	return 0;
}

/* -- On and off --------------------------------------------------------------- */

static int refuse_on(struct nc_reader *r, const char *wanted,
		     const char *found)
{
	return nc_refuse(r, r->block.code_at[NC_TOOL_POINT], wanted, "%s",
			 found);
}

static bool has_xyz(const struct interp_kinematics *k)
{
	uint32_t axes = 0;

	for (uint32_t i = 0; i < k->nlinear; i++)
		axes |= NC_BIT(k->joint[k->linear[i]].axis);
	return axes == (NC_BIT(NC_X) | NC_BIT(NC_Y) | NC_BIT(NC_Z));
}

/* The tool longer by a register: the tip farther from the holder. */
static int lengthen(struct nc_reader *r)
{
	const uint32_t n = nc_has(r, NC_H) ? (uint32_t)r->block.value[NC_H] : 0;

	if (!nc_has(r, NC_H))
		return 0;
	if (!r->registers[n].known)
		return nc_refuse(r, r->block.at[NC_H], "a register filled "
				 "before, as in H1=75 and G43.4 H1",
				 "the tool's length in register %u, which is "
				 "not defined", n);
	for (int i = 0; i < 3; i++)
		r->tool.k.tip_mm[i] -= r->registers[n].mm *
				       r->tool.k.tool_dir[i];
	return 0;
}

static int switch_on(struct nc_reader *r)
{
	struct interp_kin_pose p;
	int rc;

	if (!r->o->kinematics)
		return refuse_on(r, "kinematics.chain in the machine file",
				 "G43.4 on a machine whose joints are not "
				 "known");
	if (!has_xyz(r->o->kinematics))
		return refuse_on(r, "a kinematics.chain with X Y Z",
				 "G43.4 on a machine without X Y Z in its "
				 "chain");
	if (r->offset_side || r->taper_side || nc_has_guides(r))
		return refuse_on(r, "G40 and G50 before it, and no guides",
				 "G43.4 with a wire's offset or taper");
	r->tool.k = *r->o->kinematics;
	rc = lengthen(r);
	if (rc)
		return rc;
	memcpy(r->tool.here_mm, r->contour.here_mm, sizeof(r->tool.here_mm));
	interp_kin_forward(&r->tool.k, r->contour.here_mm, &p);
	memcpy(r->tool.here_mm, p.tip_mm, sizeof(p.tip_mm));
	r->tool.on = true;
	return 0;
}

int nc_run_tool_point(struct nc_reader *r)
{
	if (r->block.code[NC_TOOL_POINT]->value)
		return switch_on(r);
	r->tool.on = false;
	return 0;
}
