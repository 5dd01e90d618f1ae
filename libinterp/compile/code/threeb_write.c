/* SPDX-License-Identifier: Apache-2.0 */
/*
 * threeb_write.c - writes a program as 3B records
 *
 * Every record is read back by the reader's own rule, and the next one starts
 * where that leads.  A line always ends where it should.  An arc gives its end
 * only by J: one coordinate is free, and the other must be on the circle around
 * the rounded centre.  If it is a unit off, the centre is searched among the
 * units around the nearest place that is equally far from both ends.  If none
 * fits, or if an arc of more than half a circle would move the centre far, the
 * arc is cut in two, until the parts are as straight as a line.
 */
#include "code/emitter.h"
#include "code/threeb_reader.h"

#include "interp/angle.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* A shorter arc can just as well be a line. */
#define ARC_MIN_UNITS	4.0

/* If no record can say an arc, and it bends less than this, it can be a
 * line. */
#define BEND_MAX_UNITS	0.5

/* No short arc is written if its end would be farther off; a long arc must
 * fit. */
#define MISS_MAX_UNITS	2

struct place {
	int64_t x, y;			/* units from the start */
};

struct threeb_writer {
	const struct interp_program *p;
	const struct interp_sink *to;
	struct interp_threeb_left *left;
	struct interp_diag *diag;
	double unit_mm;
	double x0_mm, y0_mm;		/* the start */
	struct place at;		/* where a reader would be now */
	uint32_t line;			/* of the source, in hand */
	uint16_t cond;
	bool fourb;			/* with the radius and the shape of
					 * arcs */
	bool clockwise;			/* the whole contour goes round
					 * clockwise */
};

/* An arc from w->at to `end`. */
struct wanted {
	struct place end;
	double cx, cy;			/* centre, units from the start */
	double sweep;			/* radian, signed */
	bool full;
};

/* A choice for the centre that records can express. */
struct attempt {
	struct threeb_arc arc;
	struct threeb_end end;
	int64_t j;
	int64_t miss;			/* squared distance from the end,
					 * units */
};

static const char *direction(bool count_y)
{
	return count_y ? "GY" : "GX";
}

static int put_line(struct threeb_writer *w, struct place to)
{
	const int64_t dx = to.x - w->at.x, dy = to.y - w->at.y;
	const int64_t x = llabs(dx), y = llabs(dy);
	/* At 45 degrees it is GY in quadrants 1 and 3, and GX in 2 and 4. */
	const bool count_y = x == y ? (dx > 0) == (dy > 0) : y > x;

	if (dx == 0 && dy == 0)
		return 0;
	if (x > INTERP_THREEB_MAX || y > INTERP_THREEB_MAX)
		return emit_refuse(w->diag, w->line, "up to 999999999 units",
				   "a line of %lld by %lld units",
				   (long long)x, (long long)y);
	w->at = to;
	return emit_line(w->to, "B%lld B%lld B%lld %s%s L%u\n", (long long)x,
			 (long long)y, (long long)(count_y ? y : x),
			 w->fourb ? "B0 " : "", direction(count_y),
			 threeb_quadrant(THREEB_LINE, dx, dy));
}

/* -- Arcs ------------------------------------------------------------------ */

static struct attempt try_centre(const struct threeb_writer *w,
				 const struct wanted *want, int64_t cx,
				 int64_t cy)
{
	struct attempt t = {
		.arc = { .x = w->at.x - cx, .y = w->at.y - cy,
			 .clockwise = want->sweep < 0 },
		.end = { want->end.x - cx, want->end.y - cy, want->full },
		.miss = INT64_MAX,
	};
	const bool far = fabs(want->sweep) > ANGLE_TURN / 2;
	struct threeb_end back;
	int64_t dx, dy;

	if ((t.arc.x == 0 && t.arc.y == 0) ||
	    (t.end.x == 0 && t.end.y == 0) ||
	    llabs(t.arc.x) + llabs(t.arc.y) > INTERP_THREEB_MAX / 4)
		return t;
	t.arc.count_y = threeb_count_y(t.end.x, t.end.y);
	t.j = threeb_arc_j(&t.arc, &t.end, far);
	if (t.j <= 0 || threeb_arc_end(&t.arc, t.j, &back) ||
	    back.full != want->full)
		return t;
	dx = back.x - t.end.x;
	dy = back.y - t.end.y;
	t.miss = dx * dx + dy * dy;
	t.end = back;
	return t;
}

/* How far around a good centre others are tried. */
#define RINGS	2

/* Try the units around @centre, the near ones first, until one fits. */
static struct attempt try_around(const struct threeb_writer *w,
				 const struct wanted *want,
				 const int64_t centre[2], struct attempt best)
{
	for (int ring = 0; ring <= RINGS && best.miss > 0; ring++) {
		for (int dx = -ring; dx <= ring; dx++) {
			for (int dy = -ring; dy <= ring; dy++) {
				struct attempt t;

				if (abs(dx) != ring && abs(dy) != ring)
					continue;
				t = try_centre(w, want, centre[0] + dx,
					       centre[1] + dy);
				if (t.miss < best.miss)
					best = t;
			}
		}
	}
	return best;
}

/* Try those around the nearest place that is equally far from both ends. */
static struct attempt try_bisector(const struct threeb_writer *w,
				   const struct wanted *want,
				   struct attempt best)
{
	const double x0 = (double)w->at.x - want->cx;
	const double y0 = (double)w->at.y - want->cy;
	const double x1 = (double)want->end.x - want->cx;
	const double y1 = (double)want->end.y - want->cy;
	const double chord = hypot(x1 - x0, y1 - y0);
	const double shift = (hypot(x1, y1) - hypot(x0, y0)) *
			     (hypot(x1, y1) + hypot(x0, y0)) / (2 * chord);
	int64_t centre[2];

	if ((fabs(want->sweep) > ANGLE_TURN / 2 && fabs(shift) > 1) ||
	    !(fabs(shift) < INTERP_THREEB_MAX))	/* nor from end to same end */
		return best;
	centre[0] = llround(want->cx + shift * (x1 - x0) / chord);
	centre[1] = llround(want->cy + shift * (y1 - y0) / chord);
	return try_around(w, want, centre, best);
}

static int put_attempt(struct threeb_writer *w, const struct attempt *t)
{
	const enum threeb_kind kind = t->arc.clockwise ? THREEB_CW :
							 THREEB_CCW;
	const double r = hypot((double)t->arc.x, (double)t->arc.y);
	char shape[40] = "";

	if (w->fourb)
		snprintf(shape, sizeof(shape), "B%lld %s ", llround(r),
			 t->arc.clockwise == w->clockwise ? "D" : "DD");
	w->at.x += t->end.x - t->arc.x;
	w->at.y += t->end.y - t->arc.y;
	return emit_line(w->to, "B%lld B%lld B%lld %s%s %s%u\n",
			 llabs(t->arc.x), llabs(t->arc.y), (long long)t->j,
			 shape, direction(t->arc.count_y),
			 t->arc.clockwise ? "SR" : "NR",
			 threeb_quadrant(kind, t->arc.x, t->arc.y));
}

static int put_arc(struct threeb_writer *w, const struct wanted *want);

/* Write two arcs of half the sweep, which meet at a whole unit. */
static int put_halves(struct threeb_writer *w, const struct wanted *want)
{
	const double x = (double)w->at.x - want->cx;
	const double y = (double)w->at.y - want->cy;
	const double c = cos(want->sweep / 2), s = sin(want->sweep / 2);
	struct wanted half = *want;
	int err;

	half.full = false;
	half.sweep = want->sweep / 2;
	half.end.x = llround(want->cx + c * x - s * y);
	half.end.y = llround(want->cy + s * x + c * y);
	err = put_arc(w, &half);
	half.end = want->end;
	return err ? err : put_arc(w, &half);
}

static struct attempt best_attempt(const struct threeb_writer *w,
				   const struct wanted *want)
{
	const struct attempt t = try_centre(w, want, llround(want->cx),
					    llround(want->cy));

	return t.miss > 0 && !want->full ? try_bisector(w, want, t) : t;
}

static int put_arc(struct threeb_writer *w, const struct wanted *want)
{
	const double radius = hypot((double)w->at.x - want->cx,
				    (double)w->at.y - want->cy);
	const double length = fabs(want->sweep) * radius;
	struct attempt t = { .miss = INT64_MAX };

	if (length < ARC_MIN_UNITS)
		return put_line(w, want->end);
	if (radius < INTERP_THREEB_MAX)
		t = best_attempt(w, want);
	if (t.miss > 0 && !want->full &&
	    radius * (1 - cos(want->sweep / 2)) < BEND_MAX_UNITS)
		return put_line(w, want->end);
	if (t.miss > (length > 4 * ARC_MIN_UNITS ? 0 : MISS_MAX_UNITS))
		return put_halves(w, want);
	return put_attempt(w, &t);
}

/* A half is rounded up, like a pulse between two units, except for the noise of
 * a double. */
static int64_t to_units(const struct threeb_writer *w, double mm)
{
	return (int64_t)floor(mm / w->unit_mm + 0.5 + 1e-4);
}

static struct place place_of(const struct threeb_writer *w, size_t node)
{
	const double x = emit_mm(w->p, INTERP_X,
				 emit_node_sub(w->p, node, INTERP_X));
	const double y = emit_mm(w->p, INTERP_Y,
				 emit_node_sub(w->p, node, INTERP_Y));

	return (struct place) { to_units(w, x - w->x0_mm),
				to_units(w, y - w->y0_mm) };
}

/* The sweep from where the reader is to the end; near the programmed sweep. */
static double sweep_of(const struct threeb_writer *w,
		       const struct wanted *want, double near)
{
	const double from = atan2((double)w->at.y - want->cy,
				  (double)w->at.x - want->cx);
	const double to = atan2((double)want->end.y - want->cy,
				(double)want->end.x - want->cx);

	return angle_nearest(to - from, near);
}

static int arc(struct threeb_writer *w, uint32_t i)
{
	const struct interp_arc *a = &w->p->arcs[w->p->segs[i].arg];
	struct wanted want = {
		.end = place_of(w, (size_t)i + 1),
		.cx = (a->a_mm - w->x0_mm) / w->unit_mm,
		.cy = (a->b_mm - w->y0_mm) / w->unit_mm,
	};
	const double way = a->sweep < 0 ? -ANGLE_TURN : ANGLE_TURN;
	double rest = a->sweep;

	if (a->axis_a != INTERP_X || a->axis_b != INTERP_Y)
		return emit_refuse(w->diag, w->line, "arcs in XY",
				   "an arc in another plane");
	for (; fabs(rest) > ANGLE_TURN * (1 - 1e-9); rest -= way) {
		struct wanted turn = want;
		int err;

		turn.end = w->at;
		turn.sweep = way;
		turn.full = true;
		err = put_arc(w, &turn);
		if (err)
			return err;
	}
	if (fabs(rest) * a->r_mm < 1e-3 * w->unit_mm)
		return put_line(w, want.end);	/* the radius may have grown */
	want.sweep = sweep_of(w, &want, rest);
	if (want.sweep * rest <= 0)
		return put_line(w, want.end);
	return put_arc(w, &want);
}

/* -- The program ----------------------------------------------------------- */

static int motion(struct threeb_writer *w, uint32_t i)
{
	const struct interp_seg *seg = &w->p->segs[i];
	const uint32_t beside = emit_moved(w->p, i) &
				~(1u << INTERP_X | 1u << INTERP_Y);
	const int err = emit_refuse_sensed(w->diag, seg);

	if (err)
		return err;
	if (beside)
		return emit_refuse(w->diag, w->line, "lines and arcs in XY",
				   "%s with a move of %c",
				   emit_kind_name(seg->kind),
				   INTERP_AXIS_LETTERS[__builtin_ctz(beside)]);
	w->left->rapids += (seg->flags & INTERP_SEG_RAPID) != 0;
	w->left->conditions += seg->cond != w->cond;
	w->cond = seg->cond;
	if (seg->kind == INTERP_LINE)
		return put_line(w, place_of(w, (size_t)i + 1));
	return arc(w, i);
}

static const char *end_word(const struct interp_threeb_options *o)
{
	const uint32_t known = o->ends ? o->ends : INTERP_THREEB_ENDS;

	if (known & INTERP_THREEB_DD)
		return "DD";
	if (known & INTERP_THREEB_E)
		return "E";
	return known & INTERP_THREEB_MJ ? "MJ" : "D";
}

static int segment(struct threeb_writer *w,
		   const struct interp_threeb_options *o, uint32_t i)
{
	const struct interp_seg *seg = &w->p->segs[i];

	w->line = seg->line;
	switch (seg->kind) {
	case INTERP_LINE:
	case INTERP_ARC:
		return motion(w, i);
	case INTERP_BEGIN:
		return 0;
	case INTERP_DWELL:
	case INTERP_OPTIONAL_STOP:
		w->left->waits++;
		return 0;
	case INTERP_AUX:
	case INTERP_MCODE:
		w->left->outputs++;
		return 0;
	case INTERP_ELECTRODE:
		return seg->arg & INTERP_ELECTRODE_STOP ?
		       emit_line(w->to, "D\n") : 0;
	case INTERP_STOP:
		return emit_line(w->to, "D\n");
	case INTERP_END:
		return emit_line(w->to, "%s\n", end_word(o));
	case INTERP_PAIR:
		return emit_refuse(w->diag, w->line, "a contour without G51, U "
				   "and V, whose taper is set at the machine; "
				   "or the NC code itself",
				   "two contours at once, for which records "
				   "have no word");
	default:
		return emit_refuse(w->diag, w->line, "lines and arcs in XY",
				   "%s", emit_kind_name(seg->kind));
	}
}

/* Does the whole contour go round clockwise?  The sign of its area says so: the
 * area of its chords, and what each arc has beside its chord. */
static bool goes_clockwise(const struct interp_program *p)
{
	double twice = 0;

	for (uint32_t i = 0; i < p->head->nsegs; i++) {
		const struct interp_seg *seg = &p->segs[i];
		double at[4];

		for (size_t k = 0; k < 4; k++)
			at[k] = emit_mm(p, k % 2 ? INTERP_Y : INTERP_X,
					emit_node_sub(p, i + k / 2, k % 2 ?
						      INTERP_Y : INTERP_X));
		twice += at[0] * at[3] - at[2] * at[1];
		if (seg->kind == INTERP_ARC) {
			const struct interp_arc *a = &p->arcs[seg->arg];

			twice += a->r_mm * a->r_mm * (a->sweep - sin(a->sweep));
		}
	}
	return twice < 0;
}

int interp_threeb_write(const struct interp_program *p,
			const struct interp_threeb_options *o,
			const struct interp_sink *to,
			struct interp_threeb_left *left,
			struct interp_diag *diag)
{
	struct threeb_writer w = {
		.p = p, .to = to, .left = left, .diag = diag,
		.fourb = o->fourb,
		.unit_mm = (o->unit_um > 0 ? o->unit_um : 1) / 1000,
		.x0_mm = emit_mm(p, INTERP_X, emit_node_sub(p, 0, INTERP_X)),
		.y0_mm = emit_mm(p, INTERP_Y, emit_node_sub(p, 0, INTERP_Y)),
	};
	int err = 0;

	*left = (struct interp_threeb_left) { 0 };
	for (uint32_t i = 0; i < p->head->nsegs; i++) {
		if (!interp_program_seg_ok(p, i, &p->segs[i]))
			return -EBADMSG;
	}
	w.clockwise = w.fourb && goes_clockwise(p);
	for (uint32_t i = 0; !err && i < p->head->nsegs; i++) {
		err = segment(&w, o, i);
	}
	return err;
}
