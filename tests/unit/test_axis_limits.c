/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_axis_limits.c - every axis keeps its own speed, acceleration and jerk,
 * in positioning, in jumps and in moves by command
 *
 * By differences of where each axis is from cycle to cycle, along random paths;
 * the seed is printed.
 */
#include "axis_track.h"

#include "path/place.h"

#define ROUNDS	SEED_ROUNDS(40)
/* An axis of little jerk goes at half a mm a second. */
#define CYCLES	1000000

static uint64_t seed;

/* Into segment @i; an action has no speed. */
static double into_mm_s(const struct interp_program *p, uint32_t i, int toward)
{
	if (p->segs[i].kind >= INTERP_BEGIN ||
	    p->segs[i - (uint32_t)toward].kind >= INTERP_BEGIN)
		return INFINITY;
	return toward > 0 ? interp_limits_into(p, i) :
			    interp_limits_back_into(p, i);
}

/* Each node that was passed since @was: its speed, between those of both
 * cycles.  A jerk bends that by this much. */
static void check_nodes(const struct rig *r, const struct cycle *was)
{
	const struct cycle *c = &r->c;
	const struct interp_program *p = &c->cursor.p;
	const double from = place_mm(was), way = place_mm(c) - from;
	const double v[2] = { was->mover.v_mm_s, c->mover.v_mm_s };
	const double bent = c->ahead.l.j_max_mm_s3 * PERIOD_S * PERIOD_S / 4;
	const int toward = c->cursor.index > was->cursor.index ? 1 : -1;

	for (uint32_t i = was->cursor.index; i != c->cursor.index;
	     i += (uint32_t)toward) {
		const uint32_t into = i + (uint32_t)toward;
		const double at = p->segs[toward > 0 ? into : i].s_mm;
		const double part = way == 0 ? 1 :
				    fmin(fmax((at - from) / way, 0), 1);
		const double v2 = v[0] * v[0] +
				  (v[1] * v[1] - v[0] * v[0]) * part;

		if (sqrt(v2) > into_mm_s(p, into, toward) + bent + 1e-6)
			fail_msg("segment %u is entered at %g of %g mm/s",
				 (unsigned)into, sqrt(v2),
				 into_mm_s(p, into, toward));
	}
}

static void watch(struct rig *r, struct track *k, double gap_v)
{
	static struct cycle was;

	was = r->c;
	step(r, gap_v);
	if (r->c.config.dry_run)
		check_nodes(r, &was);
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
	k.jump.every.cycles = 300;
	k.jump.v_max_mm_s = 80;
	k.gap.feed_max_mm_s = k.gap.approach_mm_s = 8;
	k.gap.gain_mm_s_v = 1;
	return k;
}

/* A random machine on a random path, without sparks. */
static void begin_dry(struct rig *r, uint64_t *s, bool hold_at_end)
{
	struct cycle_config k;

	set_machine(s);
	k = config_of(s);
	k.dry_run = true;
	k.hold_at_end = hold_at_end;
	k.gap.retract_mm_s = 1000;
	rig_take(r, random_path(s), &k);
	tell(r, CYCLE_START);
}

static void there_and_back_every_axis_keeps_its_limits(void **st)
{
	uint64_t s = seed;

	(void)st;
	for (int i = 0; i < ROUNDS; i++) {
		struct track t = { .n = 0 };
		struct rig r;

		begin_dry(&r, &s, true);
		for (int n = 0; n < CYCLES && r.c.state == STATE_TRAVEL; n++)
			watch(&r, &t, OPEN_V);
		assert_int_equal(r.c.state, STATE_HOLD);
		tell_mm(&r, CYCLE_RETRACT, 1e9);
		for (int n = 0; n < CYCLES && r.c.hold.moving; n++)
			watch(&r, &t, OPEN_V);
		assert_true(place(&r) == 0);
		rig_free(&r);
	}
}

static void held_at_any_moment_every_axis_keeps_its_limits(void **st)
{
	uint64_t s = seed + 2;

	(void)st;
	for (int i = 0; i < ROUNDS; i++) {
		struct track t = { .n = 0 };
		struct rig r;

		begin_dry(&r, &s, false);
		for (int n = 0; n < 20000 && r.c.loaded; n++) {
			disturb(&r, &s, 1000);
			watch(&r, &t, OPEN_V);
			assert_int_equal(r.c.fault.first, FAULT_NONE);
		}
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
	assert_true((int)jumps > ROUNDS);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(there_and_back_every_axis_keeps_its_limits),
		cmocka_unit_test(held_at_any_moment_every_axis_keeps_its_limits),
		cmocka_unit_test(in_jumps_every_axis_keeps_its_limits),
	};

	seed = seed_take();
	return cmocka_run_group_tests(tests, NULL, NULL);
}
