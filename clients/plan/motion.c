/* SPDX-License-Identifier: Apache-2.0 */
/*
 * motion.c - poses of a chain of joints, and bounds of a block's motion
 */
#include "motion.h"

#include <math.h>
#include <string.h>

static bool is_turn(const struct interp_kin_joint *j)
{
	return interp_axis_is_rotary(j->axis);
}

void motion_init(struct machine_motion *m, const struct interp_kinematics *kin,
		 const struct mesh *tool)
{
	m->kin = kin;
	m->ball_r_mm = 0;
	for (int k = 0; k < 3; k++)
		m->ball_mm[k] = (tool->min[k] + tool->max[k]) / 2;
	m->corner_mm = v_distance(tool->max, m->ball_mm);
	for (uint32_t i = 0; i < tool->nverts; i++) {
		const double r = v_distance(tool->vert[i], m->ball_mm);

		m->ball_r_mm = r > m->ball_r_mm ? r : m->ball_r_mm;
	}
}

uint32_t motion_moves(const struct machine_motion *m)
{
	uint32_t set = 0;

	for (uint32_t i = 0; i < m->kin->njoints; i++)
		set |= 1u << m->kin->joint[i].axis;
	return set;
}

/* -- Poses ---------------------------------------------------------------- */

/* pose = pose . joint at @q */
static void append(struct pose *p, const struct interp_kin_joint *j, double q)
{
	struct rot turn, r;
	double d[3], at[3], back[3];

	if (!is_turn(j)) {
		rot_apply(&p->r, j->dir, d);
		v_madd(p->t, q, d, p->t);
		return;
	}
	turn = rot_about(j->dir, q * PLAN_RADIAN);
	r = rot_mul(&p->r, &turn);
	rot_apply(&p->r, j->at_mm, at);
	rot_apply(&r, j->at_mm, back);
	for (int i = 0; i < 3; i++)
		p->t[i] += at[i] - back[i];
	p->r = r;
}

/* The joint's way as seen from the part: of a rotary, a line through @at. */
static void seen(const struct pose *before, const struct interp_kin_joint *j,
		 double dir[3], double at[3])
{
	rot_apply(&before->r, j->dir, dir);
	rot_apply(&before->r, j->at_mm, at);
	v_add(at, before->t, at);
}

static void add_rate(const struct pose *before,
		     const struct interp_kin_joint *j, double dq,
		     struct pose_rate *rate)
{
	double dir[3], at[3], x[3];

	seen(before, j, dir, at);
	if (!is_turn(j)) {
		v_madd(rate->v, dq, dir, rate->v);
		return;
	}
	dq *= PLAN_RADIAN;
	v_cross(dir, at, x);
	v_madd(rate->v, -dq, x, rate->v);
	v_madd(rate->w, dq, dir, rate->w);
}

static const struct pose none = {
	.r = { { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } } },
};

void motion_pose(const struct machine_motion *m, const double q[INTERP_NAXES],
		 struct pose *pose)
{
	*pose = none;
	for (uint32_t i = 0; i < m->kin->njoints; i++)
		append(pose, &m->kin->joint[i], q[m->kin->joint[i].axis]);
}

void block_at(const struct block *b, double t, double q[INTERP_NAXES])
{
	for (int i = 0; i < INTERP_NAXES; i++)
		q[i] = t < 1 ? b->from[i] + t * (b->to[i] - b->from[i]) :
			       b->to[i];
}

void block_pose(const struct block *b, double t, struct pose *pose,
		struct pose_rate *rate)
{
	const struct interp_kinematics *k = b->m->kin;
	double q[INTERP_NAXES];

	block_at(b, t, q);
	*pose = none;
	if (rate)
		*rate = (struct pose_rate) { .accel = b->accel_mm };
	for (uint32_t i = 0; i < k->njoints; i++) {
		const struct interp_kin_joint *j = &k->joint[i];

		if (rate)
			add_rate(pose, j, b->to[j->axis] - b->from[j->axis],
				 rate);
		append(pose, j, q[j->axis]);
	}
}

void motion_jacobian(const struct machine_motion *m,
		     const double q[INTERP_NAXES], const double p[3],
		     double ret[INTERP_NAXES][3])
{
	struct pose before = none;

	memset(ret, 0, INTERP_NAXES * sizeof(*ret));
	for (uint32_t i = 0; i < m->kin->njoints; i++) {
		const struct interp_kin_joint *j = &m->kin->joint[i];
		double dir[3], at[3], arm[3], x[3];

		seen(&before, j, dir, at);
		if (is_turn(j)) {
			v_sub(p, at, arm);
			v_cross(dir, arm, x);
			for (int k = 0; k < 3; k++)
				ret[j->axis][k] = x[k] * PLAN_RADIAN;
		} else {
			memcpy(ret[j->axis], dir, sizeof(dir));
		}
		append(&before, j, q[j->axis]);
	}
}

/* -- Bounds --------------------------------------------------------------- */

/*
 * A ball holds the electrode.  It is carried from the tool toward the work,
 * from joint to joint.  At each joint it grows by half of the way that its
 * centre makes over the block.  Before it passes a rotary joint, the ball
 * tells how far any point of the electrode ever is from the joint's line.
 */
struct ball {
	double centre[3], r;
};

static double from_line(const struct interp_kin_joint *j, const double p[3])
{
	double arm[3], x[3];

	v_sub(p, j->at_mm, arm);
	v_cross(j->dir, arm, x);
	return v_length(x);
}

static void pass_turn(struct ball *b, const struct interp_kin_joint *j,
		      double from, double to)
{
	const double half = fabs(to - from) / 2 * PLAN_RADIAN;
	const double chord = 2 * sin(fmin(half, M_PI) / 2);
	struct rot turn;
	double arm[3], turned[3];

	b->r += from_line(j, b->centre) * chord;
	turn = rot_about(j->dir, (from + to) / 2 * PLAN_RADIAN);
	v_sub(b->centre, j->at_mm, arm);
	rot_apply(&turn, arm, turned);
	v_add(j->at_mm, turned, b->centre);
}

static void bound_reach(struct block *b)
{
	const struct interp_kinematics *k = b->m->kin;
	struct ball ball = { .r = b->m->ball_r_mm };

	memcpy(ball.centre, b->m->ball_mm, sizeof(ball.centre));
	for (uint32_t i = k->njoints; i-- > 0;) {
		const struct interp_kin_joint *j = &k->joint[i];
		const double from = b->from[j->axis], to = b->to[j->axis];

		b->reach_mm[i] = is_turn(j) ?
				 from_line(j, ball.centre) + ball.r : 1;
		if (is_turn(j)) {
			pass_turn(&ball, j, from, to);
		} else {
			v_madd(ball.centre, (from + to) / 2, j->dir,
			       ball.centre);
			ball.r += fabs(to - from) / 2;
		}
	}
}

/* Of joint @i over the whole block: mm or radian. */
static double joint_way(const struct block *b, uint32_t i)
{
	const struct interp_kin_joint *j = &b->m->kin->joint[i];
	const double way = fabs(b->to[j->axis] - b->from[j->axis]);

	return is_turn(j) ? way * PLAN_RADIAN : way;
}

void block_init(struct block *b, const struct machine_motion *m,
		const double from[INTERP_NAXES], const double to[INTERP_NAXES])
{
	b->m = m;
	memcpy(b->from, from, sizeof(b->from));
	memcpy(b->to, to, sizeof(b->to));
	bound_reach(b);
	b->way_mm = b->corner_way_mm = b->accel_mm = 0;
	for (uint32_t i = 0; i < m->kin->njoints; i++) {
		const double way = joint_way(b, i);
		double later = 0;

		b->way_mm += way * b->reach_mm[i];
		b->corner_way_mm += way * b->reach_mm[i];
		if (!is_turn(&m->kin->joint[i]))
			continue;
		b->corner_way_mm += way * fmax(m->corner_mm - m->ball_r_mm, 0);
		for (uint32_t l = i + 1; l < m->kin->njoints; l++)
			later += joint_way(b, l) * b->reach_mm[l];
		b->accel_mm += way * (way * b->reach_mm[i] + 2 * later);
	}
}

double motion_strays_mm(const struct block *b, const double off[INTERP_NAXES])
{
	double sum = 0;

	for (uint32_t i = 0; i < b->m->kin->njoints; i++) {
		const struct interp_kin_joint *j = &b->m->kin->joint[i];

		sum += off[j->axis] * b->reach_mm[i] *
		       (is_turn(j) ? PLAN_RADIAN : 1);
	}
	return sum;
}
