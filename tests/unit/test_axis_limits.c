/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_axis_limits.c - every axis keeps its own speed, acceleration and jerk, in
 * positioning, in jumps and in moves by command
 *
 * By differences of where each axis is from cycle to cycle, along random paths;
 * the seed is printed.  A node steps, by the corner that it is passed as: what
 * spans one is not looked at.
 */
#include "cycle_help.h"
#include "seed.h"

#include "interp/limits.h"

#define ROUNDS	40
#define SEGS	12

static uint64_t seed;
static struct interp_machine axes_machine;

/* Axes as unequal as they come; C is slow to set off. */
static void set_machine(uint64_t *s)
{
	axes_machine = (struct interp_machine) { .present = 0xff };
	for (int i = 0; i < INTERP_NAXES; i++)
		axes_machine.axis[i] = (struct interp_axis_limits) {
			0.001, -1000, 1000, uniform(s, 20, 90),
			pow(10, uniform(s, 2, 3.5)), pow(10, uniform(s, 3.5, 5))
		};
}

static void random_line(struct interp_build *b, uint64_t *s)
{
	const struct interp_build_word w = {
		.line = 1, .feed_mm_s = 60, .rapid = rnd(s) % 3 == 0,
	};
	double end[INTERP_NAXES];
	struct interp_diag d;

	memcpy(end, interp_build_here(b), sizeof(end));
	for (int i = 0; i < INTERP_NAXES; i++)
		if (rnd(s) % 3 == 0)
			end[i] += uniform(s, -6, 6);
	assert_int_equal(interp_build_line(b, end, &w, &d), 0);
}

static void random_arc(struct interp_build *b, uint64_t *s)
{
	const struct interp_build_word w = { .line = 1, .feed_mm_s = 60 };
	const double *here = interp_build_here(b);
	const double r = pow(10, uniform(s, -0.5, 1)), t = uniform(s, 0, 6.28);
	const struct interp_build_arc a = {
		.axis_a = INTERP_X, .axis_b = INTERP_Y,
		.centre_a_mm = here[0] + r * cos(t),
		.centre_b_mm = here[1] + r * sin(t), .clockwise = rnd(s) % 2,
	};
	const double to = uniform(s, 0, 6.28);
	double end[INTERP_NAXES];
	struct interp_diag d;

	memcpy(end, here, sizeof(end));
	end[0] = a.centre_a_mm + r * cos(to);
	end[1] = a.centre_b_mm + r * sin(to);
	end[INTERP_C] += rnd(s) % 2 ? uniform(s, -9, 9) : 0;
	assert_int_equal(interp_build_arc(b, end, &a, &w, &d), 0);
}

static struct made random_path(uint64_t *s)
{
	const struct interp_build_options o = {
		.machine = &axes_machine, .strategy = INTERP_SIMULTANEOUS,
	};
	struct interp_build *b = interp_build_create(&o);

	for (int i = 0; i < SEGS; i++) {
		if (rnd(s) % 4 == 0)
			random_arc(b, s);
		else
			random_line(b, s);
		if (rnd(s) % 6 == 0)
			action(b, INTERP_DWELL, 1);
	}
	return finish(b);
}

/* Where the axes are in four cycles; on one segment, in one kind of move. */
struct track {
	double at[4][INTERP_NAXES];
	uint32_t index[4];
	enum cycle_state state[4];
	int n;
};

/* Of one axis, not by pulses: from where the cursor says it is. */
static void places_of(const struct rig *r, double ret[INTERP_NAXES])
{
	const struct interp_cursor *at = &r->c.cursor;
	const struct interp_program *p = &at->p;
	const double t = at->seg.length_mm > 0 ? at->s_mm / at->seg.length_mm :
						 0;

	memset(ret, 0, INTERP_NAXES * sizeof(*ret));
	for (uint32_t j = 0; j < p->head->naxes; j++) {
		const int64_t *a = p->nodes + (uint64_t)at->index *
					      p->head->naxes;
		const int64_t *b = a + p->head->naxes;
		const uint8_t axis = p->head->column[j];

		ret[axis] = ((double)a[j] + t * (double)(b[j] - a[j])) /
			    INTERP_SUB * p->head->pulse_mm[axis];
	}
	if (at->seg.kind == INTERP_ARC) {
		const struct interp_arc *k = &p->arcs[at->seg.arg];
		const double angle = k->theta + t * k->sweep;
		const double rr = k->r_mm + t * k->dr_mm;

		ret[k->axis_a] = k->a_mm + rr * cos(angle);
		ret[k->axis_b] = k->b_mm + rr * sin(angle);
	}
}

static void note(struct track *k, const struct rig *r)
{
	for (int i = 0; i < 3; i++) {
		memcpy(k->at[i], k->at[i + 1], sizeof(k->at[i]));
		k->index[i] = k->index[i + 1];
		k->state[i] = k->state[i + 1];
	}
	places_of(r, k->at[3]);
	k->index[3] = r->c.cursor.index;
	k->state[3] = r->c.state;
	k->n++;
}

static bool is_whole(const struct track *k)
{
	for (int i = 0; i < 3; i++)
		if (k->index[i] != k->index[3] || k->state[i] != k->state[3])
			return false;
	return k->n >= 4 && (k->state[3] == STATE_TRAVEL ||
			     k->state[3] == STATE_JUMP ||
			     k->state[3] == STATE_HOLD);
}

/* A stop less than 1e-9 mm ahead is met: the last bit of time is cut. */
static void check_axes(const struct track *k, const struct rig *r)
{
	const double t = PERIOD_S;
	const bool bends = r->c.cursor.seg.kind == INTERP_ARC;

	for (int i = 0; i < INTERP_NAXES; i++) {
		const struct interp_axis_limits *l = &axes_machine.axis[i];
		const double v[3] = { (k->at[1][i] - k->at[0][i]) / t,
				      (k->at[2][i] - k->at[1][i]) / t,
				      (k->at[3][i] - k->at[2][i]) / t };
		const double a[2] = { (v[1] - v[0]) / t, (v[2] - v[1]) / t };
		const double jerk = (a[1] - a[0]) / t;
		const double cut = cbrt(6e-9 * l->j_max_mm_s3 *
					l->j_max_mm_s3) + 1e-5 / t / t * 1e-3;

		if (fabs(v[0]) > l->v_max_mm_s * (1 + 1e-6) ||
		    fabs(a[0]) > l->a_max_mm_s2 * (1 + 1e-6) + cut ||
		    (!bends && fabs(jerk) > l->j_max_mm_s3 * (1 + 1e-6) +
					    2 * cut / t))
			fail_msg("axis %c, %s, segment %u: %g mm/s, %g of %g "
				 "mm/s2, %g of %g mm/s3",
				 INTERP_AXIS_LETTERS[i],
				 state_duty[r->c.state].name,
				 (unsigned)k->index[3], v[0], a[0],
				 l->a_max_mm_s2, jerk, l->j_max_mm_s3);
	}
}

static void watch(struct rig *r, struct track *k, double gap_v)
{
	step(r, gap_v);
	note(k, r);
	if (is_whole(k))
		check_axes(k, r);
}

static struct cycle_config config_of(uint64_t *s)
{
	struct cycle_config k = usual_config();

	for (int i = 0; i < INTERP_NAXES; i++) {
		k.travel_min[i] = -1000000;
		k.travel_max[i] = 1000000;
	}
	/* The path's own are the higher ones. */
	k.travel_a_mm_s2 = k.jump.a_max_mm_s2 = 4000;
	k.travel_j_mm_s3 = k.jump.j_max_mm_s3 = 2e5;
	k.jump.height_mm = uniform(s, 0.5, 6);
	k.jump.every_cycles = 300;
	k.jump.v_max_mm_s = 80;
	k.gap.feed_max_mm_s = k.gap.approach_mm_s = 8;
	k.gap.gain_mm_s_v = 1;
	return k;
}

static void there_and_back_every_axis_keeps_its_limits(void **st)
{
	uint64_t s = seed;

	(void)st;
	for (int i = 0; i < ROUNDS; i++) {
		struct cycle_config k;
		struct track t = { .n = 0 };
		struct rig r;

		set_machine(&s);
		k = config_of(&s);
		k.dry_run = k.hold_at_end = true;
		k.gap.retract_mm_s = 1000;
		rig_take(&r, random_path(&s), &k);
		tell(&r, CYCLE_START);
		for (int n = 0; n < 100000 && r.c.state == STATE_TRAVEL; n++)
			watch(&r, &t, OPEN_V);
		assert_int_equal(r.c.state, STATE_HOLD);
		tell_mm(&r, CYCLE_RETRACT, 1e9);
		for (int n = 0; n < 100000 && r.c.hold.moving; n++)
			watch(&r, &t, OPEN_V);
		assert_true(place(&r) == 0);
		rig_free(&r);
	}
}

static void in_jumps_every_axis_keeps_its_limits(void **st)
{
	uint64_t s = seed + 1;
	uint32_t jumps = 0;

	(void)st;
	for (int i = 0; i < ROUNDS; i++) {
		struct cycle_config k;
		struct track t = { .n = 0 };
		struct rig r;

		set_machine(&s);
		k = config_of(&s);
		rig_take(&r, random_path(&s), &k);
		tell(&r, CYCLE_START);
		for (int n = 0; n < 20000 && state_duty[r.c.state].running;
		     n++) {
			/* From the cut it first comes to a stand. */
			if (r.c.state != STATE_JUMP ||
			    (r.c.lift.up && r.c.mover.v_mm_s > 0))
				t.n = 0;
			watch(&r, &t, SPARKING_V);
		}
		jumps += r.c.totals.jumps;
		rig_free(&r);
	}
	assert_true(jumps > ROUNDS);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(there_and_back_every_axis_keeps_its_limits),
		cmocka_unit_test(in_jumps_every_axis_keeps_its_limits),
	};

	seed = seed_take();
	return cmocka_run_group_tests(tests, NULL, NULL);
}
