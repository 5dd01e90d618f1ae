/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_walkable.c - a program that is accepted can be walked to its end, there
 * and back
 *
 * Random texts of every dialect, with every strategy, in periods of 50 us to 20
 * ms, with jerks of 1e4 to 1e8 mm/s3.  The seed is printed; EDM_RUNS is the
 * number of texts.
 */
#include "cycle_help.h"
#include "random_compile.h"
#include "seed.h"

#define RUNS		SEED_ROUNDS(120)

/* As many cycles may pass without a way while it should move. */
#define STILL_MAX	2000
#define CYCLES_MAX	4000000

static uint64_t seed;

struct job {
	struct script text;
	const char *dialect;
	enum interp_strategy how;
	double period_us, a_mm_s2, j_mm_s3;
};

static void say(const struct job *j, const struct rig *r, const char *what)
{
	fail_msg("%s, at %g mm of %g, state %s %s: --dialect %s --strategy %s "
		 "--period-us %g, a %g, j %g\n%s", what,
		 place(r), r->m.p.head->length_mm,
		 state_duty[r->c.state].name,
		 fault_name(r->c.fault.first), j->dialect,
		 interp_strategy_name(j->how), j->period_us, j->a_mm_s2,
		 j->j_mm_s3, j->text.at);
}

/* -- The machine ----------------------------------------------------------- */

static void machine(struct interp_machine *m, const struct job *j)
{
	*m = (struct interp_machine) { .present = 0xff };
	for (int i = 0; i < INTERP_NAXES; i++)
		m->axis[i] = (struct interp_axis_limits) {
			0.001, -200, 200, 100, j->a_mm_s2, j->j_mm_s3
		};
}

/* Return: was it taken? */
static bool compile(struct job *j, const struct interp_machine *m,
		    struct made *ret)
{
	const struct interp_build_options o = {
		.machine = m, .strategy = j->how, .tolerance_milli = 2000,
		.fit_mm = rnd(j->text.seed) % 4 ? 0 : 0.01,
	};

	return random_compile(&j->text, j->dialect, &o, ret);
}

/* -- The walk -------------------------------------------------------------- */

static bool stands(const struct rig *r)
{
	return !r->c.hold.moving && r->c.mover.v_mm_s == 0 &&
	       !r->c.hold.fails && !r->c.job.stopped;
}

/* A cycle; it comes on, or it waits for what it should. */
static void watch(const struct job *j, struct rig *r, int *still)
{
	const double was = place(r);
	const uint32_t done = r->c.job.action_done;

	step(r, OPEN_V);
	if (r->c.state == STATE_FAULT)
		say(j, r, "a fault");
	*still = place(r) != was || r->c.job.action_done != done ||
		 r->c.job.dwelling ? 0 : *still + 1;
	if (*still > STILL_MAX)
		say(j, r, "it stands");
	if (r->c.count > CYCLES_MAX)
		say(j, r, "it creeps");
}

static void check_end(const struct job *j, const struct rig *r)
{
	const struct interp_program *p = &r->m.p;

	for (uint32_t k = 0; k < p->head->naxes; k++) {
		const int64_t end = p->nodes[(uint64_t)p->head->nsegs *
					     p->head->naxes + k];

		if (r->c.cursor.pos[p->head->column[k]] !=
		    interp_round_sub(end))
			say(j, r, "not at its end");
	}
}

static void to_the_end(const struct job *j, struct rig *r)
{
	const double end = r->m.p.head->length_mm;
	int still = 0;

	tell(r, CYCLE_START);
	while (r->c.state != STATE_IDLE) {
		if (r->c.state == STATE_HOLD && stands(r)) {
			if (r->c.config.hold_at_end && place(r) >= end - 1e-9)
				return;
			tell_mm(r, CYCLE_CONFIRM, r->c.stand.of);
			tell(r, CYCLE_START);
		}
		watch(j, r, &still);
	}
}

static void there_and_back(const struct job *j, struct rig *r)
{
	int still = 0;

	r->c.config.hold_at_end = true;
	to_the_end(j, r);
	check_end(j, r);
	tell_mm(r, CYCLE_RETRACT, 1e9);
	while (!(r->c.state == STATE_HOLD && stands(r)))
		watch(j, r, &still);
	if (place(r) > 1e-6 + r->c.back_mm)
		say(j, r, "not back at its start");
	r->c.config.hold_at_end = false;
	to_the_end(j, r);
	check_end(j, r);
}

/* Not so short a period that it takes minutes. */
static void set_times(struct job *j, uint64_t *s)
{
	j->period_us = 50 * pow(400, uniform(s, 0, 1));
	j->a_mm_s2 = pow(10, uniform(s, 2, 4));
	j->j_mm_s3 = pow(10, uniform(s, 4, 8));
}

static void walk(const struct job *j, struct made m)
{
	struct cycle_config k = usual_config();
	struct rig r;

	k.dry_run = true;
	k.period_ns = (int64_t)(j->period_us * 1e3);
	k.travel_a_mm_s2 = j->a_mm_s2;
	k.travel_j_mm_s3 = j->j_mm_s3;
	k.gap.retract_mm_s = 1e3;
	k.points_max = 20000;
	rig_take(&r, m, &k);
	there_and_back(j, &r);
	rig_free(&r);
}

/* By every strategy.  Return: how many took it. */
static int try_all(struct job *j)
{
	struct interp_machine m;
	struct made made;
	int taken = 0;

	machine(&m, j);
	for (int how = 0; how < INTERP_NSTRATEGIES; how++) {
		j->how = (enum interp_strategy)how;
		if (!compile(j, &m, &made))
			continue;
		walk(j, made);
		taken++;
	}
	return taken;
}

static int try_text(uint64_t *s)
{
	static struct job j;

	j.dialect = random_text(&j.text, s);
	set_times(&j, s);
	return try_all(&j);
}

/* They stood for ever, or ended in a fault. */
static void these_are_walked_or_refused(void **st)
{
	static const char *const texts[] = {
		"G91 F6000\nG1 X-2.084 Y3.542\nG1 X0.003 Y0.001\n"
		"G1 X0.009 Y0.012\nG1 X-2.132 Y1.480\nG1 X-0.264 Y0.363\n"
		"G1 X-1.520 Y-1.520\nM2\n",
		"G91 F6000\nG1 X0.05\nG2 X0.001 Y0.001 I0.001 J0.001\nM2\n",
		"G90 F6000\nG1 X1.726\nG3 X1.727 Y-0.001 I-0.001 J0.001\n"
		"M2\n",
		"G90 F1521\nG1 Y2.43\nG3 X-0.109 Y2.09 I-0.014 J-0.183\n"
		"G92 X0 Y0\nG6.2 P4 K0 X0 Y0 R1\nK0 X0 Y0 R0.32\n"
		"K0 X1.958 Y-0.005 R2.81\nK0 X3.204 Y0.004 R2.39\n"
		"K1 X0.26 Y-0.017 R1.53\nK2 X0.006 Y-0.016 R2.91\n"
		"K3 X0.004 Y-0.286 R2.75\nK4\nK4\nK4\nK4\nM2\n",
	};
	uint64_t s = seed;

	(void)st;
	for (int i = 0; i < 4; i++) {
		static struct job j;

		j = (struct job) { .dialect = "generic", .a_mm_s2 = 500,
				   .j_mm_s3 = 10000, .text.seed = &s };
		put(&j.text, "%s", texts[i]);
		for (j.period_us = 50; j.period_us < 30000; j.period_us *= 20)
			assert_int_equal(try_all(&j), INTERP_NSTRATEGIES);
	}
}

static void what_is_accepted_is_walked(void **st)
{
	const char *given = getenv("EDM_RUNS");
	const int runs = given ? atoi(given) : RUNS;
	const uint64_t from = seed;
	int taken = 0;

	(void)st;
	for (int i = 0; i < runs; i++) {
		uint64_t s = from + (uint64_t)i * 1000003;

		taken += try_text(&s);
	}
	print_message("    %d of %d programs were taken\n", taken,
		      runs * INTERP_NSTRATEGIES);
	assert_true(taken > runs);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(these_are_walked_or_refused),
		cmocka_unit_test(what_is_accepted_is_walked),
	};

	seed = seed_take();
	return cmocka_run_group_tests(tests, NULL, NULL);
}
