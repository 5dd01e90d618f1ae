/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_kill_anywhere.c - edmd is killed in any cycle of a job, many times, and
 * the job comes to the same end
 */
#include "compile_help.h"

#undef assert_near			/* not with a fixed bound */
#include "resume_help.h"

#include "path/walk.h"
#include "seed.h"

#define CYCLES_MAX	400000
#define SETTLE		20
#define WALL		(-500)		/* of Z, pulses */

struct job {
	const char *text;
	enum interp_strategy strategy;
	bool wire;
};

static const struct job jobs[] = {
	/* Wire: an arc under a line, there, back without power, and again. */
	{ "F300\nG1 X0.3 U0.4\nG3 X0.5 Y0.2 I0 J0.2 : "
	  "G1 X0.7 Y0.3\nM5\nG1 X0 Y0 U0 V0\nM3\nG4 P0.02\n"
	  "G1 X0.2 U0.1\nM2\n", INTERP_POINT_BY_POINT, true },
	/* Multi-pass: the same kerf three times, back by G0 and by M5. */
	{ "F600\nG1 X0.4\nX0.4 Y0.3\nG0 X0 Y0\nG1 X0.4\nX0.4 Y0.3\nM5\n"
	  "G1 X0 Y0\nM4\nG1 X0.41\nG4 P0.05\nG0 Z0.5\nM2\n",
	  INTERP_CENTRED, false },
	/* Orbits, the second ended by its time. */
	{ "F300\nG0 Z0.1\nG130 Z-0.2 R0.15 Q0.1 P1\nG0 Z0.2\n"
	  "G130 Z-0.3 R0.1 Q0.1 P1 S0.2\nG0 X1 Z0.3\nM2\n",
	  INTERP_SIMULTANEOUS, false },
	/* A helix and a curve with C, there and back. */
	{ "F300\nG3 X0 Y0 I0.1 J0 Z-0.2 C20.\nM5\nG2 X0 Y0 I0.1 J0 Z0 C0.\n"
	  "M3\nG6.2 P3 K0 X0 Y0 C0\nK0 X0.3 Y0.3 C8\nK0 X0.6 Y0 C4\nK1\nK1\n"
	  "K1\nM2\n", INTERP_MIN_SWITCH, false },
	/* Lifts to the centre, beside the path, out of a pocket. */
	{ "F300\nG0 Z0.1\nG141\nG130 Z-0.2 R0.2 Q0.1 P2\nG140\n"
	  "G0 X0.5\nG1 Z-0.1\nG4 P0.3\nG0 Z0.1\nM2\n",
	  INTERP_POINT_BY_POINT, false },
	/* A cone around a corner whose point stands, there and back. */
	{ "F300\nH1=0.1\nG51 A2.\nG41 D1\nG1 X1\nG1 Y1\nX2\nG40 G50 G1 X2.5\n"
	  "M5\nG1 X0 Y0\nM2\n", INTERP_CENTRED, true },
	/* Contacts, and what is cut from them. */
	{ "F300\nG80 Z-\nG92 Z0\nG90 G0 Z0.3\nM3\nG1 Z-0.2\nG0 Z0.3\n"
	  "G0 X0.5\nG1 Z-0.2\nM5\nG1 Z0.3\nM2\n",
	  INTERP_SIMULTANEOUS, false },
};

static void load_job(struct world *w, const struct job *j)
{
	static const struct interp_wire wire = {
		.guides = INTERP_GUIDES_RELATIVE, .z_lower_mm = -20,
		.z_upper_mm = 80, .z_second_mm = 40, .angle_max_deg = 30,
		.corner_angle_deg = 180,
	};
	struct compiled c = compile_ready("generic");

	c.bo.strategy = j->strategy;
	c.bo.tolerance_milli = j->strategy == INTERP_MIN_SWITCH ? 2000 : 0;
	c.o.nc.wire = j->wire ? &wire : NULL;
	compile(&c, j->text);
	load_made(w, (struct made) { .block = c.block, .p = c.p,
				     .bytes = c.p.head->bytes });
}

static struct cycle_config config_of(uint64_t seed)
{
	struct cycle_config k = usual_config();

	k.probe = (struct probe_config) {
		.feed_mm_s = 5, .fine_mm_s = 0.5, .back_mm = 0.1,
		.settle.cycles = SETTLE,
	};
	k.gap.retract_escape = seed % 2;
	k.gap.retract_to = seed % 3 ? RETRACT_LIMIT : RETRACT_MOTION;
	k.jump.every.cycles = seed % 5 ? 150 : 0;
	return k;
}

/* What the gap says: shorts in a cut only, and the wall where it probes. */
static double gap_of(const struct world *w, uint64_t *s, int *shorted)
{
	const struct cycle *c = &w->l.cycle;

	if (c->state == STATE_PROBE)
		return c->out.target[INTERP_Z] <= WALL ? SHORTED_V : OPEN_V;
	if (state_duty[c->state].power && *shorted == 0 && rnd(s) % 150 == 0)
		*shorted = 1 + (int)(rnd(s) % 30);
	if (*shorted > 0 && (*shorted)-- > 0 &&
	    (state_duty[c->state].power || c->state == STATE_RETRACT))
		return SHORTED_V;
	return c->state == STATE_RETRACT || c->state == STATE_JUMP ? OPEN_V :
	       state_duty[c->state].power ? SPARKING_V : OPEN_V;
}

static unsigned int kills, states[CYCLE_NSTATES];

/* Is M5 in force where the program comes to segment @n first? */
static bool is_off(const struct interp_program *p, uint32_t n)
{
	bool off = false;

	for (uint32_t i = 0; i < n; i++)
		if (p->segs[i].kind == INTERP_AUX &&
		    INTERP_AUX_OF(p->segs[i].arg) <= INTERP_AUX_POWER_NEGATIVE)
			off = INTERP_AUX_OF(p->segs[i].arg) ==
			      INTERP_AUX_POWER_OFF;
	return off;
}

/* Sparks only within a cut, told by the program's text alone. */
static void check_power(const struct world *w)
{
	const struct interp_cursor *at = &w->l.cycle.cursor;

	if (!w->out.power || !w->l.cycle.loaded || at->s_mm < 2e-9 ||
	    at->s_mm > at->seg.length_mm - 2e-9)
		return;
	assert_false(at->seg.flags & (INTERP_SEG_RAPID | INTERP_SEG_SENSED));
	assert_false(is_off(&at->p, at->index));
}

/* It stands where it stood, held, and goes on when it is told to. */
static void kill(struct world *w)
{
	const struct cycle was = w->l.cycle;
	const struct cycle *c = &w->l.cycle;

	kills++;
	states[was.state]++;
	crash(w);
	if (!c->loaded)
		fail_msg("not taken up in %s at %.4f",
			 state_duty[was.state].name,
			 interp_cursor_place_mm(&was.cursor));
	assert_int_equal(c->state, STATE_HOLD);
	assert_int_equal(c->fault.first, FAULT_NONE);
	assert_memory_equal(c->out.target, was.out.target,
			    sizeof(was.out.target));
	assert_memory_equal(c->probe.shift, was.probe.shift,
			    sizeof(was.probe.shift));
	assert_true(fabs(c->far_mm - was.far_mm) < 1e-9);
	period(w, OPEN_V);
	assert_false(w->out.power);
	assert_int_equal(ask(w, CYCLE_START, 0, 0), ANSWER_DONE);
}

/* Somebody holds it, leads it back and lets it go on, or pushes e-stop; and it
 * may be killed in any cycle of that, too. */
static void disturb(struct world *w, uint64_t *s, unsigned int every)
{
	const bool estop = rnd(s) % 3 == 0;
	int n = (int)(rnd(s) % 120);

	if (estop)
		w->in.estop = true;
	else
		ask(w, CYCLE_HOLD, 0, 0);
	period(w, OPEN_V);
	w->in.estop = false;
	while (n-- > 0) {
		period(w, OPEN_V);
		assert_false(w->out.power);
		if (rnd(s) % 40 == 0)
			ask(w, CYCLE_RETRACT, 0, uniform(s, 0.01, 0.5));
		if (rnd(s) % 60 == 0)
			ask(w, CYCLE_STEP, 0, rnd(s) % 2 ? 1 : -1);
		if (every && rnd(s) % (20 * every) == 0)
			crash(w);
	}
	assert_true(w->l.cycle.loaded);
	for (n = 0; n < 6000 && (cycle_moves(&w->l.cycle) ||
				 w->l.cycle.fault.latched); n++) {
		ask(w, CYCLE_RESET, 0, 0);
		period(w, OPEN_V);
	}
	assert_int_equal(ask(w, CYCLE_START, 0, 0), ANSWER_DONE);
}

static bool is_at_node(const struct cycle *c)
{
	return c->cursor.s_mm < 2e-9 ||
	       c->cursor.s_mm > c->cursor.seg.length_mm - 2e-9;
}

/* What may go wrong, and just after a change of state or at an end of a segment
 * more often than elsewhere. */
static void attack(struct world *w, const struct cycle *was, uint64_t *s,
		   unsigned int every)
{
	const struct cycle *c = &w->l.cycle;
	const bool edge = c->state != was->state ||
			  (is_at_node(c) && !is_at_node(was));
	const uint64_t one_in = edge ? 6 : every;

	if (every && c->loaded && rnd(s) % one_in == 0)
		kill(w);
	if (every && c->loaded && rnd(s) % one_in == 0)
		disturb(w, s, every);
}

/* Return: the cycles of it. */
static int live(const struct job *j, uint64_t seed, unsigned int every,
		int32_t ret[INTERP_NAXES])
{
	uint64_t s = seed;
	int shorted = 0, n = 0;
	struct world w;

	print_on_failure("seed", seed);
	world_init(&w);
	w.k = config_of(seed);
	loop_make(&w);
	load_job(&w, j);
	assert_int_equal(ask(&w, CYCLE_START, 0, 0), ANSWER_DONE);
	for (; n < CYCLES_MAX && w.l.cycle.loaded; n++) {
		const struct cycle was = w.l.cycle;

		period(&w, gap_of(&w, &s, &shorted));
		check_power(&w);
		if (w.l.cycle.fault.first != FAULT_NONE)
			fail_msg("fault %d at %.4f in %s",
				 w.l.cycle.fault.first, at_mm(&w),
				 state_duty[w.l.cycle.state].name);
		attack(&w, &was, &s, every);
	}
	if (w.l.cycle.outcome != OUTCOME_DONE)
		fail_msg("not done, at %.4f in %s", at_mm(&w),
			 state_duty[w.l.cycle.state].name);
	memcpy(ret, w.l.cycle.out.target, sizeof(w.l.cycle.out.target));
	world_free(&w);
	return n;
}

static void killed_anywhere_it_comes_to_the_same_end(void **st)
{
	(void)st;
	for (size_t i = 0; i < sizeof(jobs) / sizeof(jobs[0]); i++) {
		int32_t whole[INTERP_NAXES], killed[INTERP_NAXES];
		const int n = live(&jobs[i], 1, 0, whole);

		for (int k = 0; k < SEED_ROUNDS(12); k++) {
			live(&jobs[i], 100 * i + (uint64_t)k,
			     (unsigned int)(n / 12 + 1), killed);
			assert_memory_equal(killed, whole, sizeof(whole));
		}
		print_message("    %d cycles, killed %u times\n", n, kills);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(killed_anywhere_it_comes_to_the_same_end),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
