/* SPDX-License-Identifier: Apache-2.0 */
/*
 * nearby.h - what most lines need: the ways around a node, the rates of a line,
 * and the speed over a node that a near look settles
 *
 * It is here because it is compiled into the walk over the segments, for a
 * constant number of columns.  What few nodes need is called (node.c).
 *
 * Private to compile/speed.
 */
#ifndef SPEED_NEARBY_H
#define SPEED_NEARBY_H

#include "speed/pass.h"

#include <math.h>

/* Nodes that turn by less are on a line: (2*sin(phi/2))^2. */
#define NEAR_STRAIGHT	1e-12

/* of the windows, to see the direction of a line itself */
#define NEAR_AROUND	1

/* Columns 0 to @n - 1. */
static inline uint32_t near_all(uint32_t n)
{
	return (1u << n) - 1;
}

/* The columns that make the length, mostly: X Y Z are the first. */
static inline uint32_t near_usual(uint32_t n)
{
	return near_all(n < 3 ? n : 3);
}

COLUMNS_INLINE void near_chord(const struct pass *w, uint32_t from, uint32_t to,
			       uint32_t along, struct chord *ret, uint32_t n)
{
	const int64_t *a = w->p->nodes + (uint64_t)from * n;
	const int64_t *b = w->p->nodes + (uint64_t)to * n;
	double mm[INTERP_NAXES], sum = 0, path;

	ret->from = from;
	ret->to = to;
	ret->h.along = along;
	for (uint32_t j = 0; j < n; j++) {
		mm[j] = (double)(b[j] - a[j]) * w->ways.sub_mm[j];
		sum += along >> j & 1 ? mm[j] * mm[j] : 0;
	}
	ret->mm = sqrt(sum);
	ret->way_mm = ret->mm;
	ret->per_mm = ret->mm > 0 ? 1 / ret->mm : 0;
	for (uint32_t j = 0; j < n; j++)
		ret->h.rate[j] = mm[j] * ret->per_mm;
	if ((along & near_all(n)) == near_all(n))
		return;
	/* A chord cuts corners.  What is beside it goes all of the way. */
	ret->way_mm = path = w->segs[to].s_mm - w->segs[from].s_mm;
	for (uint32_t j = 0; j < n; j++)
		if (!(along >> j & 1))
			ret->h.rate[j] = path > 0 ? mm[j] / path : 0;
}

static inline bool near_chord_is(const struct chord *c, uint32_t from,
				 uint32_t to, uint32_t along)
{
	return c->from == from && c->to == to && c->h.along == along;
}

/* The same along the path.  Between nodes that are rounded it goes to and fro,
 * and is longer than the straight line. */
COLUMNS_INLINE void near_way(const struct pass *w, uint32_t from, uint32_t to,
			     struct chord *ret, uint32_t n)
{
	const int64_t *a = w->p->nodes + (uint64_t)from * n;
	const int64_t *b = w->p->nodes + (uint64_t)to * n;

	ret->per_mm = 1 / (w->segs[to].s_mm - w->segs[from].s_mm);
	for (uint32_t j = 0; j < n; j++)
		ret->h.rate[j] = (double)(b[j] - a[j]) * w->ways.sub_mm[j] *
				 ret->per_mm;
}

/* Are the next nodes to both sides far enough away, and ahead of those of the
 * node before? */
static inline bool near_look_next(const struct pass *w, uint32_t i,
				  const struct around *k)
{
	const struct interp_seg *s = &w->segs[i];

	return k->ahead <= i + 1 && k->behind < i && w->run < i &&
	       i < w->run_end && s->s_mm - s[-1].s_mm >= k->mm &&
	       s[1].s_mm - s->s_mm >= k->mm;
}

/* Not over a place from which the length is in other columns. */
static inline void near_look(const struct pass *w, uint32_t i, struct around *k)
{
	const struct interp_seg *s = w->segs;
	const double here = s[i].s_mm, mm = k->mm;
	uint32_t behind = k->behind;
	/* From itself a node is not as far as that. */
	uint32_t ahead = k->ahead > i ? k->ahead : i + (i < w->run_end);

	if (behind < w->run)
		behind = w->run;
	while (behind + 1 < i && here - s[behind + 1].s_mm >= mm)
		behind++;
	while (ahead < w->run_end && s[ahead].s_mm - here < mm)
		ahead++;
	k->behind = behind;
	k->ahead = ahead;
}

/*
 * On a short line the share of an axis is rounded.  If the share is the same as
 * on the ways around the line, but for a rounding, then the share of those ways
 * is used.
 */
COLUMNS_INLINE void near_rates(struct pass *w, uint32_t i,
			       const struct heading *h, struct rates *ret,
			       uint32_t ways, uint32_t n)
{
	struct around *k = &w->windows[NEAR_AROUND];
	const double per_mm = 1 / w->segs[i].length_mm;
	const bool beside = (~ways & near_all(n)) != 0;
	const double along = beside ? pass_along_tol(w, ways) : 0;
	struct chord c = { .h.along = ways };
	struct peaks peaks;

	peaks.v_mm_s = INFINITY;
	if (near_look_next(w, i, k)) {
		k->behind = i - 1;
		k->ahead = i + 1;
	} else {
		near_look(w, i, k);
	}
	near_way(w, k->behind, k->ahead, &c, n);
	peaks.around = &c;
	if (beside)
		pass_peaks(w, i, &peaks);
	ret->v_mm_s = INFINITY;
	ret->top_mm_s = peaks.v_mm_s;
	for (uint32_t j = 0; j < n; j++) {
		/* So far the length and the axis may be off, if the share is
		 * that of the ways around. */
		const double off = ways >> j & 1 ? w->tol[j] : w->tol[j] +
			pass_off(w, j, along, fabs(c.h.rate[j]));
		const double d = fabs(h->rate[j] - c.h.rate[j]);
		double by = fabs(d > off * per_mm ? h->rate[j] : c.h.rate[j]);

		/* The line itself has the whole top, and a rounding. */
		if (beside && peaks.top[j] > 0)
			by = larger(by, smaller(by + peaks.top[j],
						fabs(h->rate[j])));
		ret->by[j] = by;
		if (by * ret->v_mm_s > w->v_mm_s[j])
			ret->v_mm_s = w->v_mm_s[j] / by;
	}
}

/* The rates of what is no short line. */
COLUMNS_INLINE void near_other_rates(const struct headings *h,
				     struct rates *ret, uint32_t n)
{
	ret->v_mm_s = 0;
	ret->top_mm_s = INFINITY;
	ret->bends = h->round;
	for (uint32_t j = 0; j < n; j++) {
		const double ends = larger(fabs(h->first.rate[j]),
					   fabs(h->last.rate[j]));

		/* On its way it may go in the direction of the axis alone. */
		ret->by[j] = h->round >> j & 1 ?
			     larger(ends, larger(h->share, 1)) : ends;
	}
}

/* The node in front of segment @i, as the segments to both sides show it. */
struct joint {
	const struct heading *a, *b;
	uint32_t last, i;		/* the segments */
	double mm;			/* half of both */
	double d[INTERP_NAXES];		/* how much rates change */
	double turn;			/* in the columns that make the length
					 * of both, squared */
	double least_mm;		/* the shorter one; 0: not two lines */
	bool own;			/* two lines, and no action between */
};

COLUMNS_INLINE void near_joint(const struct interp_seg *s, struct joint *k,
			       uint32_t both, uint32_t n)
{
	const struct interp_seg *a = &s[k->last], *b = &s[k->i];
	const bool lines = a->kind == INTERP_LINE && b->kind == INTERP_LINE;

	k->mm = (a->length_mm + b->length_mm) / 2;
	k->least_mm = lines ? smaller(a->length_mm, b->length_mm) : 0;
	k->own = lines && a + 1 == b;
	k->turn = 0;
	for (uint32_t j = 0; j < n; j++) {
		k->d[j] = k->b->rate[j] - k->a->rate[j];
		k->turn += both >> j & 1 ? k->d[j] * k->d[j] : 0;
	}
}

/* Lines as long as the window are their own chords. */
static inline bool near_is_own(const struct joint *k, double mm)
{
	return k->own && k->least_mm >= mm;
}

/* How the narrowest window shows a node. */
struct near_bow {
	const double *b;		/* the rates on from there */
	double mm;			/* half of both chords */
	double d[INTERP_NAXES];		/* how much rates change */
	double turn;			/* squared */
};

/* Return: false if there is no way to one of the sides. */
COLUMNS_INLINE bool near_bow_of(struct pass *w, uint32_t i,
				struct near_bow *ret, uint32_t n)
{
	struct around *k = &w->windows[0];
	struct chord *a = &k->chord[k->on], *b = &k->chord[!k->on];

	near_look(w, i, k);
	if (!near_chord_is(a, k->behind, i, near_all(n)))
		near_chord(w, k->behind, i, near_all(n), a, n);
	near_chord(w, i, k->ahead, near_all(n), b, n);
	ret->b = b->h.rate;
	ret->mm = (a->mm + b->mm) / 2;
	ret->turn = 0;
	for (uint32_t j = 0; j < n; j++) {
		ret->d[j] = b->h.rate[j] - a->h.rate[j];
		ret->turn += ret->d[j] * ret->d[j];
	}
	return a->mm > 0 && b->mm > 0;
}

/* Of the columns that move. */
COLUMNS_INLINE struct weakest near_weakest(const struct pass *w,
					   const double *d, const double *rate,
					   uint32_t n)
{
	struct weakest ret = { INFINITY, INFINITY };

	for (uint32_t j = 0; j < n; j++) {
		if (d[j] == 0 && rate[j] == 0)
			continue;
		ret.a_mm_s2 = smaller(ret.a_mm_s2, w->a_mm_s2[j]);
		ret.j_mm_s3 = smaller(ret.j_mm_s3, w->j_mm_s3[j]);
	}
	return ret;
}

/*
 * Where every column makes the length, the narrowest window mostly shows enough
 * speed, and nothing else has to be known.  Return: that, or less than @most.
 */
COLUMNS_INLINE double near_curve(struct pass *w, const struct joint *joint,
				 double most, uint32_t n)
{
	const bool own = near_is_own(joint, w->windows[0].mm);
	struct near_bow k = { joint->b->rate, joint->mm, .turn = joint->turn };
	struct weakest can = { w->gate.a_mm_s2, w->gate.jerk_mm_s3 };
	double v;

	for (uint32_t j = 0; j < n; j++)
		k.d[j] = joint->d[j];
	if (!own && !near_bow_of(w, joint->i, &k, n))
		return 0;
	if (!w->alike)
		can = near_weakest(w, k.d, k.b, n);
	v = k.turn < NEAR_STRAIGHT ? INFINITY :
	    pass_round_mm_s(larger(k.mm / sqrt(k.turn), w->corner_mm),
			    can.a_mm_s2, can.j_mm_s3);
	if (v >= most && !own)
		w->windows[0].on = !w->windows[0].on;
	return v;
}

/*
 * Does pass_turn() certainly allow @v_mm_s?  On most curves of lines it does,
 * and the answer costs less than pass_turn() itself.  All of a change counts
 * here, and of all axes the one that can do least.
 */
COLUMNS_INLINE bool near_turns_faster(const struct pass *w,
				      const struct joint *k, double v_mm_s,
				      uint32_t both, uint32_t n)
{
	const double v = v_mm_s, turn = k->turn;

	if (!(k->least_mm >= w->near.mm) || k->a->along != k->b->along)
		return false;
	for (uint32_t j = 0; j < n; j++)
		if (!(both >> j & 1) &&
		    !(fabs(k->d[j]) * v < 0.99 * w->step_mm_s[j]))
			return false;
	return turn < 1 && v * v * turn < w->turn_least[0] &&
	       v * v * v * turn * turn < w->turn_least[1];
}

/* Does a bend, squared, leave less for going along it? */
static inline bool near_leaves_less(const struct pass *w, double bend2,
				    double v)
{
	const double own = smaller(w->a_own_mm_s2[0], w->a_own_mm_s2[1]);
	const double a = PASS_HARDLY * w->gate.a_mm_s2;
	const double j = INTERP_ARC_JERK_BOTH / 3 * w->gate.jerk_mm_s3;

	return bend2 * v * v * own * own > j * j ||
	       bend2 * v * v * v * v > a * a;
}

/* At a node between lines that are their own chords: does the path go on
 * bending as it was noted last?  Mostly it does. */
static inline bool near_goes_on(const struct pass *w, uint32_t i, double bend2,
				double v)
{
	const struct way_on *k = &w->gate.way;

	return w->segs[i].s_mm < k->to_mm && bend2 >= k->bend2[0] &&
	       bend2 <= k->bend2[1] && v <= k->most_mm_s;
}

/* Then note that; the speed is the same. */
static inline double near_way_on(struct pass *w, const struct joint *k)
{
	if (w->segs[k->i].s_mm < w->gate.way.same_mm)
		w->bent_ways.behind = k->i;
	else
		pass_way_on(w, k->i, k->a, k->b);
	return w->gate.way.v_mm_s;
}

/* So that turning a little does not ask again, more is asked for. */
#define NEAR_MORE	1.2

/*
 * As pass_change().  Where no window is narrower than the lines, the change
 * from the node before the last one shows whether it has to be asked.
 */
COLUMNS_INLINE double near_change(struct pass *w, const struct joint *joint,
				  double most_mm_s, uint32_t both, uint32_t n)
{
	const struct interp_seg *s = w->segs;
	struct change_gate *k = &w->gate;
	const uint32_t i = joint->i;
	const double v = most_mm_s;
	double *was = k->bend[i & 1];
	double sum = 0, bend2 = 0, per_mm, most;

	if (i < k->next && v <= k->most_mm_s)
		return k->v_mm_s;
	if (!near_is_own(joint, w->windows[PASS_CHANGE_FIRST].mm))
		return pass_change(w, i, both, v);
	if (k->node + 1 != i)
		k->first = i;
	k->node = i;
	per_mm = 1 / joint->mm;
	for (uint32_t j = 0; j < n; j++) {
		const double bend = joint->d[j] * per_mm;
		const double d = bend - was[j];

		was[j] = bend;
		if (both >> j & 1) {
			sum += d * d;
			bend2 += bend * bend;
		}
	}
	if (i < k->first + 2)
		return pass_change(w, i, both, v);
	most = k->jerk_mm_s3 * (s[i].s_mm - s[i - 2].s_mm);
	if (v * v * v * v * v * v * sum > most * most)
		return pass_change(w, i, both, v);
	if (!near_leaves_less(w, bend2, v))
		return INFINITY;
	return near_goes_on(w, i, bend2, v) ?
	       near_way_on(w, joint) : pass_change(w, i, both, NEAR_MORE * v);
}

/* As pass_arch(), of long lines. */
COLUMNS_INLINE double near_arch(struct pass *w, const struct joint *k, double v,
				uint32_t both)
{
	const double bend2 = k->turn / (k->mm * k->mm);

	if (!k->own || !near_leaves_less(w, bend2, v))
		return INFINITY;
	return near_goes_on(w, k->i, bend2, v) ?
	       near_way_on(w, k) : pass_arch(w, k->i, both, NEAR_MORE * v);
}

/* @both: the columns that make the length of both */
COLUMNS_INLINE double near_joint_mm_s(struct pass *w, struct joint *k,
				      uint32_t both, uint32_t n)
{
	const struct interp_seg *s = w->segs;
	const double most = smaller((double)s[k->last].feed_max_mm_s,
				    (double)s[k->i].feed_max_mm_s);
	const bool curves = pass_is_short(w, k->last) || pass_is_short(w, k->i);
	const bool all = both == near_all(n);
	double v = INFINITY, fast, turn;

	near_joint(s, k, both, n);
	if (!all)
		w->dip = (struct dip) {
			0, SHOWN_NONE, SHOWN_NONE, INFINITY
		};
	if (curves)
		v = all ? near_curve(w, k, most, n) : 0;
	if (curves && v < most)
		v = pass_curve(w, k->i, both, most);
	if (curves) {
		const double change = near_change(w, k, smaller(v, most), both,
						  n);

		v = smaller(v, change);
		if (!all)
			w->dip.firm_mm_s = pass_least(w->dip.firm_mm_s,
						      (float)change);
	}
	fast = curves ? smaller(v, most) : v;
	if (!near_turns_faster(w, k, fast, both, n)) {
		turn = pass_turn(w, k->last, k->i, k->a, k->b);
		w->dip.firm_mm_s = pass_least(w->dip.firm_mm_s, (float)turn);
		v = smaller(v, turn);
	}
	if (!curves)
		v = smaller(v, near_arch(w, k, smaller(v, most), both));
	if (!all && k->a->along == k->b->along &&
	    pass_is_known(w, k->last, k->i))
		pass_known(w, k->i, both);
	return v;
}

/* As pass_node_mm_s(); fill @k.  Mostly all columns make the length. */
COLUMNS_INLINE double near_node_mm_s(struct pass *w, struct joint *k,
				     uint32_t n)
{
	const uint32_t both = k->a->along & k->b->along;

	w->bends = 0;
	return both == near_all(n) ? near_joint_mm_s(w, k, near_all(n), n) :
				     near_joint_mm_s(w, k, both, n);
}

#endif /* SPEED_NEARBY_H */
