/* SPDX-License-Identifier: Apache-2.0 */
/* twin.c - runs models of the axes beside the trace ring */
#include "twin.h"

#include <math.h>

#define MOST	2000			/* records that one poll reads at
					 * most */

static const struct twin_error unknown = { -1, -1 };

void twin_init(struct twin *t, const struct machine_config *c)
{
	*t = (struct twin) { .last = unknown };
	for (int i = 0; i < INTERP_NAXES; i++) {
		if (interp_axis_is_rotary((enum interp_axis)i) ||
		    !(c->axes.present & 1u << i) || !(c->loop[i].gain_1_s > 0))
			continue;
		t->axis[t->naxes] = i;
		t->loop[t->naxes++] = c->loop[i];
	}
}

static uint32_t instance_of(const struct shm_status *s)
{
	return __atomic_load_n(&s->head.instance, __ATOMIC_RELAXED);
}

/* The first edmd, or another one: take its period, and begin with new
 * records. */
static bool begin(struct twin *t, const struct shm_status *s,
		  const struct shm_snapshot *snap)
{
	t->last = unknown;
	t->instance = instance_of(s);
	t->period_ns = snap->period_ns;
	t->follow = (struct shm_follow) {
		.next = __atomic_load_n(&s->trace_next, __ATOMIC_ACQUIRE)
	};
	t->lost = 0;
	t->since_cycle = snap->cycle;
	t->now = (struct twin_error) { 0 };
	if (interp_shadow_init(&t->shadow, t->loop, t->naxes,
			       (double)t->period_ns * 1e-9) == 0)
		return true;
	t->naxes = 0;
	return false;
}

static void take(struct twin *t, const struct shm_snapshot *snap,
		 const struct shm_trace *r)
{
	double target[INTERP_NAXES], sent[INTERP_NAXES];
	double actual[INTERP_NAXES];
	struct interp_shadow_error e;

	for (int i = 0; i < t->naxes; i++) {
		const int axis = t->axis[i];

		target[i] = r->pos[axis] * snap->pulse_mm[axis];
		sent[i] = r->sent[axis] * snap->pulse_mm[axis];
		actual[i] = r->actual[axis] * snap->pulse_mm[axis];
	}
	interp_shadow_step(&t->shadow, target, sent, actual, &e);
	t->now.measured_mm = fmax(t->now.measured_mm, e.measured_mm);
	t->now.predicted_mm = fmax(t->now.predicted_mm, e.predicted_mm);
}

/* A second is over: publish what was found in it. */
static void turn(struct twin *t, uint64_t cycle)
{
	if ((int64_t)(cycle - t->since_cycle) * t->period_ns < 1000000000)
		return;
	t->since_cycle = cycle;
	t->last = t->now;
	t->now = (struct twin_error) { 0 };
}

void twin_poll(struct twin *t, const struct shm_status *s,
	       const struct shm_snapshot *snap)
{
	struct shm_trace r;

	if (t->naxes == 0 || snap->period_ns <= 0)
		return;
	if (!s) {
		t->instance = 0;
		t->last = unknown;
		return;
	}
	if (instance_of(s) != t->instance && !begin(t, s, snap))
		return;
	for (int i = 0; i < MOST && shm_trace_next(s, &t->follow, &r); i++) {
		if (t->follow.lost != t->lost)
			interp_shadow_forget(&t->shadow);
		t->lost = t->follow.lost;
		take(t, snap, &r);
		turn(t, r.cycle);
	}
}
