/* SPDX-License-Identifier: Apache-2.0 */
/*
 * pullout.c - a way in, of the end pose alone: the way out, turned round
 */
#include "pullout.h"

#include "check.h"
#include "closed.h"
#include "mouth.h"
#include "middle.h"
#include "wayout.h"

#include <errno.h>
#include <string.h>
#include <sysexits.h>

#define TOUCH_MM	0.02		/* a way to be repaired keeps that */
#define CELLS_FIRST	20000		/* to prove soon that there is none */
#define CELLS_LAST	1000000

struct pull {
	const struct job *j;
	struct outward outward;
	double q[INTERP_NAXES];		/* the end pose */
	struct route out;		/* nodes, from the end outward */
	struct wayout_tried tried;
};

static void say_stuck(const struct pull *p, double mm)
{
	const struct wayout_tried *t = &p->tried;
	const uint32_t moves = motion_moves(&p->j->motion);

	fprintf(stderr, "edm-plan: no way out found that keeps %.3f mm, in %u "
		"slides from %u places.  The farthest one leaves %.2f mm of "
		"the way through the cavity, at", mm, t->slides, t->states,
		t->left_mm);
	for (int k = 0; k < INTERP_NAXES; k++)
		if (moves & 1u << k)
			fprintf(stderr, " %c%.3f", INTERP_AXIS_LETTERS[k],
				t->q[k]);
	fprintf(stderr, "; a thinner electrode, less --clearance, more "
		"--budget, another axis, a turned work, or a program to begin "
		"with.  It is narrowest there, %.3f mm, between\n",
		t->nearest.mm);
	job_say_pair(p->j, &t->nearest, stderr);
	if (t->unreached)
		fprintf(stderr, "edm-plan: %u ways lead out to where nothing "
			"straight leads from start_mm of the machine file; "
			"start_mm elsewhere\n", t->unreached);
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

static int say_closed(const struct pull *u)
{
	bar_end(u->j);
	fprintf(stderr, "edm-plan: it is proved that no way leads out of the "
		"end pose that keeps %.3f mm, within the travel; a thinner "
		"electrode, less --clearance, a rotary axis, or an end pose "
		"elsewhere\n", u->j->clear_mm);
	return 1;
}

/* @in: of the positioning. */
static int search(struct pull *u, const struct clearance *c,
		  const struct clearance *in)
{
	const struct wayout_asked asked = {
		.j = u->j, .outward = &u->outward, .c = c, .in = in,
		.end = u->q, .seconds = u->j->o->budget_s / 2,
	};
	int rc = wayout_find(&asked, &u->out, &u->tried);

	if (rc == 0 && !middle_straighten(&asked, &u->out)) {
		rc = middle_lead(&asked, &u->out);
		if (rc == 0)
			middle_straighten(&asked, &u->out);
	}
	bar_end(u->j);
	return rc;
}

/* A way that only just does not touch is repaired like a program. */
static int search_touching(struct pull *u, const struct clearance *c)
{
	struct clearance touch = *c;

	say_stuck(u, c->mm);
	fprintf(stderr, "edm-plan: looking for a way that keeps less, to widen "
		"it\n");
	touch.mm = TOUCH_MM - u->j->chord_mm;
	touch.end_mm = fmin(touch.end_mm, touch.mm);
	return search(u, &touch, c);
}

/* Return: 0 out; 1 no way, which is said; -ENOMEM. */
static int find_out(struct pull *u, const struct clearance *c)
{
	int rc = closed_prove(u->j, c, u->q, CELLS_FIRST);

	if (rc)
		return rc < 0 ? rc : say_closed(u);
	rc = search(u, c, c);
	if (rc != 1 || bar_interrupted())
		return rc;
	rc = closed_prove(u->j, c, u->q, CELLS_LAST);
	if (rc)
		return rc < 0 ? rc : say_closed(u);
	rc = search_touching(u, c);
	if (rc == 1 && !bar_interrupted())
		say_stuck(u, TOUCH_MM - u->j->chord_mm);
	return rc;
}

static int refuse_outside(void)
{
	fprintf(stderr, "edm-plan: --end-pose: the electrode is outside of the "
		"part there; an end pose in the cavity\n");
	return EX_DATAERR;
}

/* The least distance at the nodes of the way. */
static double least_at_nodes(const struct plan *p)
{
	struct near_pair pair = { 0 };
	double least = p->end_mm;

	for (uint32_t i = 0; i < p->dense.n; i++) {
		struct pose pose;

		motion_pose(&p->j->motion, p->dense.node[i].q, &pose);
		if (near_less(&p->j->bodies, &pose, least, &pair))
			least = pair.mm;
	}
	return least;
}

static int turn_round(struct plan *p, const struct pull *u,
		      const struct clearance *c)
{
	const struct route *out = &u->out;
	struct mouth_lead in;
	int err;

	if (!mouth_find(p->j, c, out->node[out->n - 1].q, &in))
		return EX_SOFTWARE;	/* the search had found it */
	err = mouth_put(&in, &p->dense);
	for (uint32_t i = out->n - 1; i-- > 0 && err == 0;)
		err = route_add(&p->dense, &out->node[i]);
	p->dense.lines = p->dense.n;
	route_lattice(&p->j->config, p->dense.lattice);
	p->dense_least_mm = least_at_nodes(p);
	return err ? EX_OSERR : 0;
}

int pullout_way(struct plan *p)
{
	struct pull u = { .j = p->j };
	struct clearance c;
	int err;

	memcpy(u.q, p->j->o->end, sizeof(u.q));
	if (!has_axes(p->j) || !in_travel(p->j, u.q))
		return EX_DATAERR;
	err = plan_check_end(p, u.q);
	if (err)
		return err;
	if (outward_is_out(p->j, u.q))
		return refuse_outside();
	check_clearance(p->j, u.q, &c);
	if (outward_init(&u.outward, p->j, u.q))
		return EX_OSERR;
	err = find_out(&u, &c);
	if (err == 0)
		err = turn_round(p, &u, &c);
	else if (err < 0)
		err = EX_OSERR;
	outward_free(&u.outward);
	route_free(&u.out);
	return err;
}
