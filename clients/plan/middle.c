/* SPDX-License-Identifier: Apache-2.0 */
/*
 * middle.c - a way out led through the middle of the air, and straight at last
 */
#include "middle.h"

#include "check.h"
#include "contact.h"
#include "free.h"
#include "mouth.h"

#include <errno.h>
#include <string.h>

#define ROOM_MM		1.0
#define ROOM_LEAST_MM	0.1
#define STEPS_MAX	6
#define WORTH_MM	0.005
#define OVER_EACH	10		/* so many later nodes are aimed at */

static bool is_free(const struct wayout_asked *a, const double *from,
		    const double *to)
{
	struct near_pair pair = { 0 };

	return check_block(a->j, to, from, a->c, &pair);
}

/* -- To the middle -------------------------------------------------------- */

/* The direction of the way at node @i. */
static void direction(const struct contact *c, const struct route *w,
		      uint32_t i, double ret[INTERP_NAXES])
{
	const double *before = w->node[i - 1].q;
	const double *behind = w->node[i + 1 < w->n ? i + 1 : i].q;
	const double mm = contact_apart_mm(c, before, behind);

	memset(ret, 0, INTERP_NAXES * sizeof(*ret));
	for (uint32_t a = 0; a < c->axes.n && mm > 0; a++)
		ret[a] = (behind[c->axes.axis[a]] - before[c->axes.axis[a]]) *
			 c->axes.reach_mm[c->axes.axis[a]] / mm;
}

static void to_middle(struct contact *c, const double along[INTERP_NAXES],
		      double q[INTERP_NAXES])
{
	double room_mm = ROOM_MM;

	for (int i = 0; i < STEPS_MAX && room_mm > ROOM_LEAST_MM; i++) {
		double s[INTERP_NAXES], to[INTERP_NAXES];
		struct near_pair pair = c->nearest;
		struct pose pose;

		contact_look(c, q, room_mm);
		if (!contact_centre(c, along, room_mm, s))
			return;
		contact_to(c, s, to);
		motion_pose(&c->j->motion, to, &pose);
		if (!near_less(&c->j->bodies, &pose, c->least_mm + WORTH_MM,
			       &pair))
			memcpy(q, to, sizeof(c->q));
		else
			room_mm /= 4;
	}
}

static int put(struct route *w, const double q[INTERP_NAXES])
{
	struct route_node n = { .feed_mm_s = 0.5 };

	memcpy(n.q, q, sizeof(n.q));
	return route_add(w, &n);
}

/* Node @i goes to @q, if the way to it is free; else by where it was. */
static int put_moved(const struct wayout_asked *a, const struct route *was,
		     uint32_t i, const double q[INTERP_NAXES],
		     struct route *ret)
{
	const double *at = ret->node[ret->n - 1].q;
	const double *old = was->node[i].q;

	if (is_free(a, at, q))
		return put(ret, q);
	if (!is_free(a, at, old) && put(ret, was->node[i - 1].q))
		return -ENOMEM;
	return put(ret, old);
}

int middle_lead(const struct wayout_asked *a, struct route *out)
{
	struct route moved = { 0 };
	struct contact c;
	int rc;

	contact_init(&c, a->j, a->end, a->c->mm);
	rc = put(&moved, out->node[0].q);
	for (uint32_t i = 1; i < out->n && rc == 0; i++) {
		double along[INTERP_NAXES], q[INTERP_NAXES];

		memcpy(q, out->node[i].q, sizeof(q));
		direction(&c, out, i, along);
		if (!bar_interrupted())
			to_middle(&c, along, q);
		rc = put_moved(a, out, i, q, &moved);
	}
	if (rc) {
		route_free(&moved);
		return rc;
	}
	route_free(out);
	*out = moved;
	return 0;
}

/* -- Straight at last ----------------------------------------------------- */

/* From @from over @over as far as is out, and within the travel. */
static bool reach(const struct job *j, const double *from, const double *over,
		  double q[INTERP_NAXES])
{
	static const double times[] = { 1, 1.15, 1.4, 2, 3, 5 };

	for (uint32_t i = 0; i < sizeof(times) / sizeof(times[0]); i++) {
		for (int k = 0; k < INTERP_NAXES; k++) {
			const struct interp_axis_limits *l =
				&j->config.axes.axis[k];

			q[k] = from[k] + times[i] * (over[k] - from[k]);
			if (j->config.axes.present & 1u << k &&
			    (q[k] < l->travel_min_mm ||
			     q[k] > l->travel_max_mm))
				return false;
		}
		free_round(&j->config, q);
		if (outward_is_out(j, q))
			return true;
	}
	return false;
}

/* One block from node @i out; toward some later node. */
static bool leads_out(const struct wayout_asked *a, const struct route *w,
		      uint32_t i, double q[INTERP_NAXES])
{
	struct mouth_lead in;

	for (uint32_t k = 0; k < OVER_EACH; k++) {
		const uint32_t over = w->n - 1 - k * (w->n - 1 - i) / OVER_EACH;

		if (over > i && reach(a->j, w->node[i].q, w->node[over].q, q) &&
		    is_free(a, w->node[i].q, q) &&
		    mouth_find(a->j, a->in, q, &in))
			return true;
	}
	return false;
}

bool middle_straighten(const struct wayout_asked *a, struct route *out)
{
	double q[INTERP_NAXES];

	for (uint32_t i = 0; i + 1 < out->n && !bar_interrupted(); i++) {
		if (!leads_out(a, out, i, q))
			continue;
		memcpy(out->node[i + 1].q, q, sizeof(q));
		out->n = i + 2;
		break;
	}
	return out->n == 2;
}
