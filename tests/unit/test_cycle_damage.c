/* SPDX-License-Identifier: Apache-2.0 */
/* test_cycle_damage.c - a program with a sound head and a damaged segment */
#include "cycle_help.h"

static void spoil(struct interp_seg *s, int how)
{
	switch (how) {
	case 0:
		s->length_mm = NAN;
		break;
	case 1:
		s->length_mm = -1e9;
		break;
	case 2:
		s->kind = 250;
		break;
	case 3:
		s->ticks += 7;
		break;
	case 4:
		s->feed_mm_s = -1;
		break;
	case 5:
		s->kind = INTERP_ARC;
		break;
	case 6:
		s->cond = 999;
		break;
	default:
		s->kind = INTERP_BEGIN;
		break;
	}
}

/* What looks ahead on the path meets the damage before the walk does. */
static void lead(struct cycle_config *k)
{
	k->contouring = (struct contouring_config) {
		.methods = INTERP_COMPENSATE_FEEDFORWARD |
			   INTERP_COMPENSATE_CROSS,
		.axes = 1u << INTERP_Z, .ahead = CONTOURING_AHEAD,
		.gains = { .velocity = 1, .lead_periods = 0.5,
			   .cross_1_s = 50 },
		.loop[INTERP_Z] = { .gain_1_s = 1000, .velocity_hz = 60,
				    .damping = 0.7 },
		.most_mm[INTERP_Z] = 0.05,
	};
	for (int i = 0; i < INTERP_NAXES; i++)
		k->contouring.pulse_mm[i] = PULSE_MM;
}

static void check_damaged(bool dry, int how)
{
	struct cycle_config k = usual_config();
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	struct interp_seg *segs;
	struct rig r;

	k.dry_run = dry;
	lead(&k);
	for (int i = 1; i <= 5; i++)
		cut_to(b, -0.5 * i);
	rig_load(&r, b, &k);
	segs = (void *)((char *)r.m.block + r.m.p.head->segs_at);
	spoil(&segs[4], how);
	assert_int_equal(interp_program_map(&r.m.p, r.m.block, r.m.bytes), 0);
	assert_int_equal(cycle_load(&r.c, &r.m.p), ANSWER_WRONG_STATE);
	tell(&r, CYCLE_START);
	until(&r, STATE_FAULT, SPARKING_V, 20000);
	assert_int_equal(r.c.fault.first, FAULT_PROGRAM);
	assert_in_range(-r.out.target[INTERP_Z], 1500 - 20, 1500);
	tell(&r, CYCLE_RESET);
	tell(&r, CYCLE_START);
	steps(&r, SPARKING_V, 100);
	assert_in_range(-r.out.target[INTERP_Z], 1500 - 20, 1500);
	rig_free(&r);
}

static void
a_damaged_segment_is_a_fault_and_the_last_good_target_stays(void **st)
{
	(void)st;
	for (int how = 0; how < 8; how++) {
		check_damaged(true, how);
		check_damaged(false, how);
	}
}

/* An action has no length: its two nodes are one place. */
static void an_action_whose_nodes_differ_is_no_jump(void **st)
{
	const enum interp_kind kinds[] = { INTERP_DWELL, INTERP_AUX };

	(void)st;
	for (int i = 0; i < 2; i++) {
		struct cycle_config k = usual_config();
		struct interp_build *b = begin(INTERP_SIMULTANEOUS);
		int64_t *nodes;
		struct rig r;

		k.dry_run = true;
		cut_to(b, -0.5);
		action(b, kinds[i], INTERP_AUX_PUMP_ON);
		cut_to(b, -1);
		rig_load(&r, b, &k);
		/* Begin, line, action: the node behind it, one axis. */
		assert_int_equal(r.m.p.head->naxes, 1);
		assert_int_equal(r.m.p.segs[2].kind, kinds[i]);
		nodes = (void *)((char *)r.m.block + r.m.p.head->nodes_at);
		nodes[3] += INT64_C(90000) << INTERP_SUB_BITS;
		nodes[4] += INT64_C(90000) << INTERP_SUB_BITS;
		tell(&r, CYCLE_START);
		until(&r, STATE_FAULT, SPARKING_V, 20000);
		assert_int_equal(r.c.fault.first, FAULT_PROGRAM);
		assert_int_equal(r.out.target[INTERP_Z], -500);
		tell(&r, CYCLE_RESET);
		tell(&r, CYCLE_START);
		tell_mm(&r, CYCLE_RETRACT, 0.1);
		steps(&r, SPARKING_V, 500);
		assert_in_range(-r.out.target[INTERP_Z], 400, 500);
		rig_free(&r);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(an_action_whose_nodes_differ_is_no_jump),
		cmocka_unit_test(a_damaged_segment_is_a_fault_and_the_last_good_target_stays),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
