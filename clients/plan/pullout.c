/* SPDX-License-Identifier: Apache-2.0 */
/*
 * pullout.c - pull the electrode out of the cavity, step by step
 *
 * The air of the cavity tells for each of some points of the electrode where
 * out is.  A linear program finds the motion of all axes for a step: as far out
 * as possible, toward the middle of the cavity, and with all near pairs of
 * triangles kept apart.  A step counts only when it is proved.
 */
#include "pullout.h"

#include "air.h"
#include "check.h"
#include "lp.h"
#include "near_set.h"

#include <errno.h>
#include <float.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>

#define POINTS		150		/* of the electrode that are led */
#define STEPS_MAX	400
#define OUT_MM		5.0		/* so far from the part it is out */
#define ROOM_MM		2.0		/* of a step */
#define ROOM_LEAST_MM	0.02
#define MIDDLE_MM	0.4		/* more clearance than that is not
					 * looked for */
#define MIDDLE_WORTH	4.0		/* of it, to a mm outward */
#define TOUCH_MM	0.02		/* a way to be repaired keeps that */

struct pull {
	const struct job *j;
	struct air air;
	double keep_mm;
	double q[INTERP_NAXES];
	double left_mm;			/* to the open, mean of the points */
	struct job_axes axes;
	struct route out;		/* nodes, from the end outward */
	struct near_pair nearest;
};

static const double *point(const struct pull *p, uint32_t i)
{
	const struct mesh *m = &p->j->tool;

	return m->vert[(uint64_t)i * m->nverts / POINTS];
}

/* How each axis leads the points outward, per unit. Return: what is left. */
static double outward(const struct pull *p, const double q[INTERP_NAXES],
		      double ret[INTERP_NAXES])
{
	struct pose pose;
	double left = 0;

	memset(ret, 0, INTERP_NAXES * sizeof(*ret));
	motion_pose(&p->j->motion, q, &pose);
	for (uint32_t i = 0; i < POINTS; i++) {
		double at[3], to[3], jac[INTERP_NAXES][3];
		double way;

		rot_apply(&pose.r, point(p, i), at);
		v_add(at, pose.t, at);
		way = air_way(&p->air, at, to);
		if (!(way > 0))
			continue;
		left += way / POINTS;
		motion_jacobian(&p->j->motion, q, at, jac);
		for (int k = 0; k < INTERP_NAXES; k++)
			ret[k] += v_dot(jac[k], to) / POINTS;
	}
	return left;
}

static void add_limits(const struct pull *p, glp_prob *lp, double room_mm)
{
	const struct machine_config *c = &p->j->config;

	glp_add_cols(lp, (int)p->axes.n + 1);
	for (uint32_t a = 0; a < p->axes.n; a++) {
		const uint32_t x = p->axes.axis[a];
		const double room = room_mm / p->axes.reach_mm[x];
		const double low = fmax(-room, c->axes.axis[x].travel_min_mm -
					       p->q[x]);
		const double high = fmin(room, c->axes.axis[x].travel_max_mm -
					       p->q[x]);

		glp_set_col_bnds(lp, (int)a + 1, low < high ? GLP_DB : GLP_FX,
				 low < high ? low : 0, high);
	}
}

static void add_pairs(const struct pull *p, glp_prob *lp,
		      const struct near_set *set)
{
	for (uint32_t i = 0; i < set->n; i++) {
		const struct near_pair *x = &set->pair[i];
		double jac[INTERP_NAXES][3], n[3], value[INTERP_NAXES + 2];
		int index[INTERP_NAXES + 2], row;

		if (!(x->mm > 1e-9))
			continue;
		v_sub(x->q, x->p, n);
		motion_jacobian(&p->j->motion, p->q, x->q, jac);
		for (uint32_t a = 0; a < p->axes.n; a++) {
			index[a + 1] = (int)a + 1;
			value[a + 1] = v_dot(n, jac[p->axes.axis[a]]) / x->mm;
		}
		index[p->axes.n + 1] = (int)p->axes.n + 1;
		value[p->axes.n + 1] = -1;
		row = glp_add_rows(lp, 1);
		glp_set_row_bnds(lp, row, GLP_LO, -x->mm, 0);
		glp_set_mat_row(lp, row, (int)p->axes.n + 1, index, value);
	}
}

static bool step_to(const struct pull *p, double room_mm,
		    const double lead[INTERP_NAXES], double to[INTERP_NAXES])
{
	static struct near_set set = { .max = NEAR_SET_MAX };
	glp_prob *lp = glp_create_prob();
	struct near_pair pair = p->nearest;
	struct pose pose;
	double mm, keep;
	bool ok;

	motion_pose(&p->j->motion, p->q, &pose);
	mm = near_distance(&p->j->bodies, &pose, &pair);
	near_set_collect(&p->j->bodies, &pose, mm + 1.0, &set);
	keep = fmin(p->keep_mm + 0.01, mm);
	glp_set_obj_dir(lp, GLP_MAX);
	add_limits(p, lp, room_mm);
	for (uint32_t a = 0; a < p->axes.n; a++)
		glp_set_obj_coef(lp, (int)a + 1, lead[p->axes.axis[a]]);
	glp_set_obj_coef(lp, (int)p->axes.n + 1, MIDDLE_WORTH * room_mm /
						ROOM_MM);
	glp_set_col_bnds(lp, (int)p->axes.n + 1, GLP_DB, keep,
			 keep + MIDDLE_MM);
	add_pairs(p, lp, &set);
	ok = lp_solve(lp, bar_interrupted);
	memcpy(to, p->q, sizeof(p->q));
	for (uint32_t a = 0; a < p->axes.n && ok; a++)
		to[p->axes.axis[a]] += glp_get_col_prim(lp, (int)a + 1);
	glp_delete_prob(lp);
	free_round(&p->j->config, to);
	return ok;
}

/* The block is proved inward, as the machine will go. */
static bool is_free(struct pull *p, const double from[INTERP_NAXES],
		    const double to[INTERP_NAXES], const struct clearance *c)
{
	return check_block(p->j, to, from, c, &p->nearest);
}

static int add_node(struct pull *p, bool rapid)
{
	struct route_node n = { .rapid = rapid, .feed_mm_s = 0.5 };

	memcpy(n.q, p->q, sizeof(n.q));
	return route_add(&p->out, &n);
}

/* No point of it is in the part's box, or it is far from the part. */
static bool is_out(struct pull *p)
{
	const struct mesh *m = &p->j->part;
	bool within = false;
	struct pose pose;

	motion_pose(&p->j->motion, p->q, &pose);
	if (near_distance(&p->j->bodies, &pose, &p->nearest) > OUT_MM)
		return true;
	for (uint32_t i = 0; i < POINTS && !within; i++) {
		double at[3];

		rot_apply(&pose.r, point(p, i), at);
		v_add(at, pose.t, at);
		within = at[0] > m->min[0] && at[0] < m->max[0] &&
			 at[1] > m->min[1] && at[1] < m->max[1] &&
			 at[2] > m->min[2] && at[2] < m->max[2];
	}
	return !within;
}

/* Return: 0 out, 1 stuck, -ENOMEM. */
static int pull(struct pull *p, const struct clearance *c)
{
	double lead[INTERP_NAXES], room = ROOM_MM, first;

	p->left_mm = first = outward(p, p->q, lead);
	if (add_node(p, false))
		return -ENOMEM;
	for (int i = 0; i < STEPS_MAX && !bar_interrupted(); i++) {
		double to[INTERP_NAXES], next[INTERP_NAXES], left;
		char text[80];

		if (!(p->left_mm > 0) || is_out(p))
			return 0;
		snprintf(text, sizeof(text), "pulling out: %.1f mm of %.1f "
			 "left", p->left_mm, first);
		bar_show(p->j, 1 - p->left_mm / first, text);
		if (room < ROOM_LEAST_MM)
			return 1;
		left = step_to(p, room, lead, to) ? outward(p, to, next) :
						    DBL_MAX;
		if (left > p->left_mm + 0.02 || !is_free(p, p->q, to, c)) {
			room /= 2;
			continue;
		}
		/* Toward the middle is good, too, but not for ever. */
		room = left > p->left_mm - 0.005 ? room * 0.7 :
						   fmin(room * 1.5, ROOM_MM);
		memcpy(p->q, to, sizeof(p->q));
		memcpy(lead, next, sizeof(lead));
		p->left_mm = left;
		if (add_node(p, false))
			return -ENOMEM;
	}
	return 1;
}

static void say_stuck(const struct pull *p)
{
	fprintf(stderr, "edm-plan: no way out found: %.2f mm are left of the "
		"way through the cavity, at", p->left_mm);
	for (uint32_t a = 0; a < p->axes.n; a++)
		fprintf(stderr, " %c%.3f", INTERP_AXIS_LETTERS[p->axes.axis[a]],
			p->q[p->axes.axis[a]]);
	fprintf(stderr, "; a thinner electrode, less --clearance, or a program "
		"to begin with.  It is narrowest, %.3f mm, between\n",
		p->nearest.mm);
	job_say_pair(p->j, &p->nearest, stderr);
}

/* From where the machine stands to the mouth: straight, or X Y and the rotaries
 * first and Z then. */
static int lead_in(struct plan *p, struct pull *u, const struct clearance *c)
{
	const double *start = p->j->config.start_mm;
	const struct route_node *mouth = &u->out.node[u->out.n - 1];
	struct route_node n = { .rapid = true };

	memcpy(n.q, start, sizeof(n.q));
	if (route_add(&p->dense, &n))
		return EX_OSERR;
	memcpy(n.q, mouth->q, sizeof(n.q));
	if (!is_free(u, mouth->q, start, c)) {
		n.q[INTERP_Z] = start[INTERP_Z];
		if (!is_free(u, mouth->q, n.q, c) ||
		    !is_free(u, n.q, start, c)) {
			fprintf(stderr, "edm-plan: the way is found, but "
				"nothing straight leads from start_mm of the "
				"machine file to its mouth; start_mm "
				"elsewhere\n");
			return 1;
		}
		if (route_add(&p->dense, &n))
			return EX_OSERR;
		n.q[INTERP_Z] = mouth->q[INTERP_Z];
	}
	return route_add(&p->dense, &n) ? EX_OSERR : 0;
}

static int turn_round(struct plan *p, struct pull *u, const struct clearance *c)
{
	int err = lead_in(p, u, c);

	for (uint32_t i = u->out.n - 1; i-- > 0 && err == 0;)
		err = route_add(&p->dense, &u->out.node[i]) ? EX_OSERR : 0;
	p->dense.lines = p->dense.n;
	route_lattice(&p->j->config, p->dense.lattice);
	return err;
}

/* Where the stem is at the end pose is out; a channel may have two ends. */
static void open_air(struct pull *u)
{
	struct pose pose;

	motion_pose(&u->j->motion, u->q, &pose);
	for (uint32_t i = 0; i < u->j->tool.nverts; i++) {
		double at[3];

		rot_apply(&pose.r, u->j->tool.vert[i], at);
		v_add(at, pose.t, at);
		air_open(&u->air, at);
	}
	air_fill(&u->air);
}

static bool has_axes(const struct job *j)
{
	const uint32_t has = motion_moves(&j->motion) & j->config.axes.present;

	for (int k = 0; k < INTERP_NAXES; k++) {
		if (!(j->o->end_axes & ~has & 1u << k))
			continue;
		fprintf(stderr, "edm-plan: --end-pose: axis %c; an axis that "
			"the machine has and that moves the electrode or the "
			"part, by chain of [kinematics]\n",
			INTERP_AXIS_LETTERS[k]);
		return false;
	}
	return true;
}

static bool in_travel(const struct job *j, const double q[INTERP_NAXES])
{
	for (int k = 0; k < INTERP_NAXES; k++) {
		const struct interp_axis_limits *a = &j->config.axes.axis[k];

		if (!(j->config.axes.present & 1u << k) ||
		    (q[k] >= a->travel_min_mm && q[k] <= a->travel_max_mm))
			continue;
		fprintf(stderr, "edm-plan: --end-pose: %c%g; from %g to %g, "
			"the travel of the axis\n", INTERP_AXIS_LETTERS[k],
			q[k], a->travel_min_mm, a->travel_max_mm);
		return false;
	}
	return true;
}

/* First with the clearance.  If the electrode gets stuck, once more, so that
 * it only just does not touch; that way is then repaired like a program.
 * Return: as pull(). */
static int pull_twice(struct pull *u, const struct clearance *c)
{
	struct clearance touch = *c;
	struct pull again = *u;
	int err = pull(u, c);

	if (err != 1 || bar_interrupted())
		return err;
	bar_end(u->j);
	say_stuck(u);
	fprintf(stderr, "edm-plan: trying to come out with less, and to widen "
		"that way\n");
	touch.mm = TOUCH_MM - u->j->chord_mm;
	touch.end_mm = fmin(touch.end_mm, touch.mm);
	again.keep_mm = TOUCH_MM;
	route_free(&u->out);
	*u = again;
	return pull(u, &touch);
}

static int refuse_outside(void)
{
	fprintf(stderr, "edm-plan: --end-pose: the electrode is outside of the "
		"part there; an end pose in the cavity\n");
	return EX_DATAERR;
}

int pullout_way(struct plan *p)
{
	struct pull u = { .j = p->j, .keep_mm = p->j->clear_mm +
						p->j->chord_mm };
	struct clearance c;
	int err;

	memcpy(u.q, p->j->o->end, sizeof(u.q));
	if (!has_axes(p->j) || !in_travel(p->j, u.q))
		return EX_DATAERR;
	err = plan_check_end(p, u.q);
	if (err)
		return err;
	check_clearance(p->j, u.q, &c);
	if (air_cut(&u.air, &p->j->part))
		return EX_OSERR;
	open_air(&u);
	job_axes_find(p->j, u.q, u.q, &u.axes);
	err = pull_twice(&u, &c);
	bar_end(p->j);
	if (err == 1 && !bar_interrupted())
		say_stuck(&u);
	if (err == 0)
		err = u.out.n < 2 ? refuse_outside() : turn_round(p, &u, &c);
	else if (err < 0)
		err = EX_OSERR;
	air_free(&u.air);
	route_free(&u.out);
	return err;
}
