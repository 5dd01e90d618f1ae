/* SPDX-License-Identifier: Apache-2.0 */
/*
 * tip_turn.c - a way of the tool's tip and direction: the rotary axes are found
 */
#include "code/tip_turn.h"
#include "code/tip_way.h"
#include "kinematics/vector.h"

#include "interp/angle.h"
#include "grow.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* In one step along the way no rotary axis turns farther than this; otherwise
 * the step is made shorter. */
#define STEP_DEG	3.0
#define UNEVEN		0.9		/* of a turn, on half of a step */
#define STEP_MOST	(1.0 / 256)
#define STEP_LEAST	1e-13
#define NODES_MAX	1000000

/* -- Rotations ------------------------------------------------------------ */

void nc_pose_turn(const double q[4], double v[3])
{
	double once[3], twice[3];

	vec_cross(q + 1, v, once);
	vec_cross(q + 1, once, twice);
	for (int i = 0; i < 3; i++)
		v[i] += 2 * (q[0] * once[i] + twice[i]);
}

static void multiply(const double a[4], const double b[4], double ret[4])
{
	double x[3];

	vec_cross(a + 1, b + 1, x);
	ret[0] = a[0] * b[0] - vec_dot(a + 1, b + 1);
	for (int i = 1; i < 4; i++)
		ret[i] = a[0] * b[i] + b[0] * a[i] + x[i - 1];
}

void nc_pose_turned(const struct interp_kinematics *k,
		    const double axes[INTERP_NAXES], double ret[4])
{
	double q[4] = { 1, 0, 0, 0 };

	for (uint32_t i = 0; i < k->njoints; i++) {
		const struct interp_kin_joint *j = &k->joint[i];
		const double half = axes[j->axis] / ANGLE_RADIAN / 2;
		const double turn[4] = { cos(half), sin(half) * j->dir[0],
					 sin(half) * j->dir[1],
					 sin(half) * j->dir[2] };

		if (!interp_axis_is_rotary(j->axis))
			continue;
		multiply(q, turn, ret);
		memcpy(q, ret, sizeof(q));
	}
	for (int i = 0; i < 4; i++)
		ret[i] = q[0] < 0 ? -q[i] : q[i];
}

int nc_pose_roll(const struct interp_kinematics *k)
{
	for (uint32_t i = 0; i < k->njoints; i++) {
		bool turns = !interp_axis_is_rotary(k->joint[i].axis);

		for (uint32_t n = 0; n < k->nturn; n++)
			turns = turns || k->turn[n] == i;
		if (!turns)
			return (int)i;
	}
	return -1;
}

/* Set the axis that rolls the tool.  The roll is what is left of the rotation
 * @want after the other axes have turned; any vector that is square to the tool
 * shows it. */
static void roll(const struct interp_kinematics *k, const double want[4],
		 double axes[INTERP_NAXES])
{
	const int last = nc_pose_roll(k);
	const struct interp_kin_joint *j = &k->joint[last];
	double e[3], v[3], x[3], deg;

	vec_cross(j->dir, fabs(j->dir[0]) < 0.7 ? (double[3]){ 1, 0, 0 } :
						  (double[3]){ 0, 1, 0 }, e);
	memcpy(v, e, sizeof(v));
	nc_pose_turn(want, v);
	for (int i = 0; i < last; i++) {
		const struct interp_kin_joint *o = &k->joint[i];

		if (interp_axis_is_rotary(o->axis))
			vec_turn(o->dir, -axes[o->axis] / ANGLE_RADIAN, v);
	}
	vec_cross(e, v, x);
	deg = atan2(vec_dot(j->dir, x), vec_dot(e, v)) * ANGLE_RADIAN;
	axes[j->axis] = deg + 360 * round((axes[j->axis] - deg) / 360);
}

/* -- The rotary axes along a way
 * -------------------------------------------- */

struct node {
	double t, deg[3];
};

struct track {
	struct nc_reader *r;
	const struct nc_pose_way *w;
	struct node *node;
	size_t n, room;
	double t0, t1;			/* of the present section */
	bool free;			/* at its end a rotary axis may have
					 * any angle: it keeps its last one */
};

/* Find the axes at @t.  Of several solutions, take the one nearest to @q.
 * Return: 1 if a rotary axis may have any angle there, 0, or an error. */
static int solve(const struct track *k, double t, struct nc_pose *p,
		 double q[INTERP_NAXES])
{
	const struct interp_kinematics *kin = &k->r->tool.k;
	const double was[3] = { q[INTERP_A], q[INTERP_B], q[INTERP_C] };
	struct interp_kin_pose want;
	int err, any;

	k->w->at(k->w->of, t, p);
	memcpy(q, p->mm, INTERP_NAXES * sizeof(*q));
	for (uint32_t i = 0; i < kin->nturn; i++) {
		const int axis = (int)kin->joint[kin->turn[i]].axis;

		q[axis] = was[axis - INTERP_A];
	}
	memcpy(want.tip_mm, p->mm, sizeof(want.tip_mm));
	memcpy(want.dir, p->dir, sizeof(want.dir));
	err = interp_kin_inverse(kin, &want, q);
	any = err == -ESRCH;
	if (err && !any)
		return err;
	if (k->w->body && nc_pose_roll(kin) >= 0) {
		q[kin->joint[nc_pose_roll(kin)].axis] =
			was[kin->joint[nc_pose_roll(kin)].axis - INTERP_A];
		roll(kin, p->q, q);
		err = interp_kin_place(kin, p->mm, q);
	}
	return err && err != -ESRCH ? err : any;
}

static int refuse(struct nc_reader *r, const char *wanted, const char *found)
{
	nc_refuse_at(r, r->word.line, wanted, "%s", found);
	return -EINVAL;
}

static int refuse_pose(struct nc_reader *r)
{
	return refuse(r, "directions that its rotaries can give, of a length "
		      "above 0", "a direction in which the machine cannot "
		      "point its tool");
}

static int node_add(struct track *k, double t, const double q[INTERP_NAXES])
{
	struct node *n;

	if (k->n == NODES_MAX)
		return refuse(k->r, "fewer turns in one line",
			      "too many turns of the rotaries");
	if (k->n == k->room && grow_array(&k->node, &k->room, sizeof(*k->node)))
		return -ENOMEM;
	n = &k->node[k->n++];
	n->t = t;
	memcpy(n->deg, q + INTERP_A, sizeof(n->deg));
	return 0;
}

static double turn_of(const double a[INTERP_NAXES],
		      const double b[INTERP_NAXES])
{
	double most = 0;

	for (int i = INTERP_A; i <= INTERP_C; i++)
		most = fmax(most, fabs(b[i] - a[i]));
	return most;
}

/* Are two poses the same, as far as anybody can see? */
static bool same(const struct track *k, const struct nc_pose *a,
		 const struct nc_pose *b)
{
	const double bound = k->r->o->tip_tolerance_mm / 4;
	double x[3], turn, tip = 0;

	vec_cross(a->dir, b->dir, x);
	for (int i = 0; i < 3; i++)
		tip += (a->mm[i] - b->mm[i]) * (a->mm[i] - b->mm[i]);
	turn = asin(fmin(1, vec_length(x) /
			    (vec_length(a->dir) * vec_length(b->dir))));
	return sqrt(tip) < bound && turn * ANGLE_RADIAN < bound;
}

/* Nearly all of an axis's turn on one half of a step: a pole may lie there, and
 * the axis jumps at it, however short the step is.  @t: the middle. */
static bool hides_jump(const struct track *k, double t,
		       const double here[INTERP_NAXES],
		       const double next[INTERP_NAXES])
{
	const double bound = k->r->o->tip_tolerance_mm / 4;
	double middle[INTERP_NAXES];
	struct nc_pose p;

	memcpy(middle, here, sizeof(middle));
	if (turn_of(here, next) < bound || solve(k, t, &p, middle) < 0)
		return false;
	for (int i = INTERP_A; i <= INTERP_C; i++) {
		const double turn = fabs(next[i] - here[i]);

		if (turn > bound && fmax(fabs(middle[i] - here[i]),
					 fabs(next[i] - middle[i])) >
				    UNEVEN * turn)
			return true;
	}
	return false;
}

/* Make a step of at most @h from @t, where the axes are @q.  Afterwards @q has
 * the next place, which may be a turn in place.  It always is one between a
 * place where a rotary axis may have any angle and one where it may not: what
 * the axis keeps is not what it has on the other side.  Return: 1 if it is one,
 * 0, or an error. */
static int step(struct track *k, double *t, double h, double q[INTERP_NAXES])
{
	double next[INTERP_NAXES], here[INTERP_NAXES];
	struct nc_pose p, was;
	bool jumps = false;
	int any;

	memcpy(here, q, sizeof(here));
	k->w->at(k->w->of, *t, &was);
	for (;;) {
		const double to = fmin(1, *t + h);

		memcpy(next, here, sizeof(next));
		any = solve(k, to, &p, next);
		if (any < 0)
			return any;
		if (any == k->free && turn_of(here, next) <= STEP_DEG &&
		    !hides_jump(k, (*t + to) / 2, here, next))
			break;
		jumps = same(k, &was, &p);
		if (jumps)
			break;
		/* The direction itself jumps, not only the rotary axes. */
		if (h < STEP_LEAST)
			return -EDOM;
		h /= 2;
	}
	memcpy(q, next, sizeof(next));
	*t = fmin(1, *t + h);
	k->free = any;
	return jumps;
}

/* Write nodes from @t on, to the end of the way or to a turn in place, which is
 * then in @q; @t is behind it.  Return: 1 if there is one, 0, or an error. */
static int follow(struct track *k, double *t, double q[INTERP_NAXES])
{
	double h = STEP_MOST, at[INTERP_NAXES];
	struct nc_pose p;
	int err;

	memcpy(at, q, sizeof(at));
	k->free = solve(k, *t, &p, at) > 0;
	k->n = 0;
	k->t0 = k->t1 = *t;
	err = node_add(k, *t, q);
	while (err == 0 && *t < 1) {
		const double from = *t;

		err = step(k, t, h, q);
		if (err == -EDOM)
			return refuse_pose(k->r);
		if (err)
			break;
		k->t1 = *t;
		h = fmin(STEP_MOST, 2 * (*t - from));
		err = node_add(k, *t, q);
	}
	return err;
}

static void section_at(const void *of, double u, double ret_mm[INTERP_NAXES])
{
	const struct track *k = of;
	const double t = u < 1 ? k->t0 + (k->t1 - k->t0) * u : k->t1;
	size_t lo = 0, hi = k->n;
	struct nc_pose p;

	while (hi - lo > 1) {
		const size_t mid = (lo + hi) / 2;

		if (k->node[mid].t <= t)
			lo = mid;
		else
			hi = mid;
	}
	memcpy(ret_mm + INTERP_A, k->node[lo].deg, sizeof(k->node[lo].deg));
	/* Almost the same place was solved before. */
	(void)solve(k, t, &p, ret_mm);
	memcpy(ret_mm, p.mm, 3 * sizeof(*ret_mm));
}

/* How far the rotary axis turns that turns most, with all its turns added. */
static double turn_deg(const struct track *k)
{
	double sum[3] = { 0 };

	for (size_t n = 1; n < k->n; n++) {
		for (int i = 0; i < 3; i++)
			sum[i] += fabs(k->node[n].deg[i] -
				       k->node[n - 1].deg[i]);
	}
	return fmax(sum[0], fmax(sum[1], sum[2]));
}

static int go_section(struct track *k)
{
	struct nc_reader *r = k->r;
	struct nc_tip_way w = { .at = section_at, .of = k,
				.turn_deg = turn_deg(k) };
	double at[INTERP_NAXES];
	int err;

	section_at(k, 0, at);
	for (int i = 0; i < INTERP_NAXES; i++)
		w.off_mm[0][i] = r->tool.here_mm[i] - at[i];
	section_at(k, 1, at);
	err = nc_tip_way(r, &w);
	memcpy(r->tool.here_mm, at, sizeof(at));
	return err;
}

/* The rotary axes turn to @q.  The tip goes on to the place at @t, which is not
 * to be told from where it stands.  If it stood still, what it leaves out would
 * add up over several turns one behind the other. */
static int turn_in_place(struct track *k, double t,
			 const double q[INTERP_NAXES])
{
	struct nc_pose end;

	k->w->at(k->w->of, t, &end);
	memcpy(end.mm + INTERP_A, q + INTERP_A, 3 * sizeof(*end.mm));
	return nc_tip_turn(k->r, end.mm);
}

int nc_pose_way(struct nc_reader *r, const struct nc_pose_way *w)
{
	struct track k = { .r = r, .w = w };
	double q[INTERP_NAXES], t = 0;
	int err, jumps;

	memcpy(q, r->contour.here_mm, sizeof(q));
	do {
		err = jumps = follow(&k, &t, q);
		if (err >= 0)
			err = k.t1 > k.t0 ? go_section(&k) : 0;
		if (err == 0 && jumps)
			err = turn_in_place(&k, t, q);
	} while (err == 0 && jumps);
	for (uint32_t i = 0; i < r->tool.k.njoints; i++)
		r->moved |= NC_BIT(r->tool.k.joint[i].axis);
	free(k.node);
	return err;
}
