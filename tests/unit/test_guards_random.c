/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_guards_random.c - what must hold for any order of inputs, commands and
 * faults
 *
 * All inputs come and go by themselves, every verb is given at any time, and
 * jobs are loaded and stopped.  The test decides from the inputs alone what is
 * forbidden.  EDM_RUNS is the number of machines, of 4000 cycles each.
 */
#include "plc_help.h"
#include "seed.h"

#include "fault.h"

#define CYCLES		4000
#define RUNS		SEED_ROUNDS(60)
#define BRAKES_IN	600		/* cycles, from any speed here */

static uint64_t seed;
static uint64_t latched[CYCLE_NFAULTS];
static uint64_t powered, enabled, moved, resets, kept;

struct world {
	struct rig r;
	struct made probing;
	bool job;			/* of the two, the one that cuts */
	int32_t was[INTERP_NAXES];
	uint64_t latched_before;
	bool reset_went;		/* out to the drives, a cycle ago */
	int forbidden, faulty;		/* cycles in a row */
	int off;			/* cycles until the drives are on */
	bool stopped;			/* a stop of this job was accepted */
};

static bool one_in(uint64_t *s, unsigned int n)
{
	return rnd(s) % n == 0;
}

/* -- The machine ---------------------------------------------------------- */

static struct cycle_config any_config(uint64_t *s)
{
	struct cycle_config k = usual_config();

	k.gap.source = GAP_VOLTAGE;
	k.gap.process = one_in(s, 3) ? PROCESS_WIRE : PROCESS_SINK;
	k.gap.wire_retract_mm = 0.1;
	k.gap.wire_retreat_to = (enum retreat_to)(rnd(s) % RETREAT_NPLACES);
	k.gap.wire_retreat_mm = 0.3;
	k.gap.arcing_share = one_in(s, 2) ? 0.3 : 0;
	k.gap.arcing_cycles = 10;
	k.jump.height_mm = one_in(s, 2) ? 0.5 : 0;
	k.axes_wait_cycles = 50;
	k.dry_run = one_in(s, 8);
	k.require_home = one_in(s, 8);
	k.probe = (struct probe_config) { .feed_mm_s = 1, .fine_mm_s = 0.5,
					  .back_mm = 0.1, .settle.cycles = 5 };
	for (int i = 0; i < 3; i++)
		k.axis[i] = (struct manual_axis) {
			.present = true, .method = HOME_SWITCH,
			.pulse_mm = PULSE_MM, .v_max_mm_s = 50,
			.a_max_mm_s2 = 1000, .j_max_mm_s3 = 20000,
			.jog_mm_s = 20, .home_toward = -1,
			.home_fast_mm_s = 20, .home_slow_mm_s = 1,
			.home_back_mm = 0.5,
		};
	return k;
}

static struct made cutting(void)
{
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);

	rapid_to(b, -0.5);
	cut_to(b, -0.8);
	action(b, INTERP_AUX, INTERP_AUX_POWER_OFF);
	cut_to(b, -0.9);
	action(b, INTERP_AUX, INTERP_AUX_POWER_POSITIVE);
	cut_to(b, -2);
	return finish(b);
}

static struct made probing(void)
{
	const struct interp_build_word w = {
		.line = 1, .rapid = true, .ends = INTERP_SEG_PROBE,
	};
	double end[INTERP_NAXES] = { [INTERP_X] = -3 };
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	struct interp_diag d;

	assert_int_equal(interp_build_line(b, end, &w, &d), 0);
	rapid_to(b, 1);
	return finish(b);
}

/* -- What comes and goes -------------------------------------------------- */

static void flip(bool *b, bool rest, uint64_t *s, unsigned int seldom)
{
	if (*b == rest ? one_in(s, 3 * seldom) : one_in(s, 30))
		*b = !*b;
}

static void inputs(struct world *w, uint64_t *s)
{
	struct io_inputs *in = &w->r.in;
	struct io_plc *p = &in->plc;

	flip(&in->estop, false, s, 1500);
	flip(&in->lost, false, s, 3000);
	flip(&in->door_open, false, s, 1000);
	flip(&in->dielectric_low, false, s, 800);
	flip(&in->gap_valid, true, s, 1500);
	flip(&in->wire_broken, false, s, 1500);
	flip(&in->busy, false, s, 300);
	flip(&p->alive, true, s, 2500);
	flip(&p->permit, true, s, 2500);
	flip(&p->door_closed, true, s, 2500);
	flip(&p->level_ok, true, s, 2500);
	flip(&p->temperature_ok, true, s, 2500);
	flip(&p->no_fire, true, s, 3000);
	flip(&p->wire_whole, true, s, 2500);
	flip(&p->hold, false, s, 600);
	p->start = p->alive && one_in(s, 80);
	p->reset = p->alive && one_in(s, 80);
	p->override = one_in(s, 3000) ? 0 : 1;
	in->limit = one_in(s, 3000) ? 1u << rnd(s) % 3 : 0;
	in->home = one_in(s, 4) ? 7 : 0;
	in->shares_valid = true;
	in->shares.arc = one_in(s, 3) ? 1 : 0;
	if (w->r.out.reset && one_in(s, 2))
		in->trouble = IO_WELL;
	else if (one_in(s, 2500))
		in->trouble = (enum io_trouble)(rnd(s) % IO_NTROUBLES);
	/* Drives take their time, and some come never. */
	if (!w->r.out.enable)
		w->off = (int)(rnd(s) % 80);
	else if (w->off > 0)
		w->off--;
	in->axes_off = !w->r.out.enable || w->off > 0 || one_in(s, 2000);
	flip(&in->steers, true, s, 500);
	in->starting = one_in(s, 1000);
}

static void command(struct world *w, uint64_t *s)
{
	static const double args[] = { 0.05, 0.5, -1, 1, 3, -3 };
	const struct cycle_command m = {
		.verb = (uint32_t)(rnd(s) % CYCLE_NVERBS),
		.arg = (uint32_t)(rnd(s) % 4), .arg_mm = args[rnd(s) % 6],
	};
	const uint64_t before = w->r.c.fault.latched;
	const bool reset = m.verb == CYCLE_RESET;

	/* They would end what the others are to break. */
	if ((m.verb == CYCLE_STOP || m.verb == CYCLE_ESTOP) && !one_in(s, 40))
		return;
	if (cycle_command(&w->r.c, &m) == ANSWER_DONE) {
		resets += reset;
		w->stopped = w->stopped || m.verb == CYCLE_STOP;
	}
	if (reset && w->r.c.fault.latched == before && before)
		kept++;
}

static void load(struct world *w, uint64_t *s)
{
	if (w->r.c.state != STATE_IDLE || w->r.c.loaded || !one_in(s, 100))
		return;
	w->job = one_in(s, 2);
	cycle_load(&w->r.c, w->job ? &w->r.m.p : &w->probing.p);
}

/* -- What must hold: told from the inputs alone --------------------------- */

struct forbidden {
	uint64_t always;		/* bits that must be latched */
	bool motion, power;
};

static struct forbidden forbidden(const struct world *w)
{
	static const enum cycle_fault troubles[] = {
		[IO_DRIVE] = FAULT_DRIVE, [IO_FOLLOWING] = FAULT_FOLLOWING,
		[IO_BUS] = FAULT_BUS,
	};
	const struct io_inputs *in = &w->r.in;
	const struct io_plc *p = &in->plc;
	struct forbidden f = { 0, false, in->dielectric_low };

	f.always |= in->estop ? fault_bit(FAULT_ESTOP) : 0;
	f.always |= in->lost ? fault_bit(FAULT_IO_LOST) : 0;
	f.always |= p->alive && !p->no_fire ? fault_bit(FAULT_FIRE) : 0;
	if (in->trouble != IO_WELL && !w->reset_went)
		f.always |= fault_bit(troubles[in->trouble]);
	f.motion = f.always || in->door_open || !p->alive || !p->permit ||
		   !p->door_closed || !p->level_ok || !p->temperature_ok ||
		   (!in->gap_valid && !w->r.c.config.dry_run);
	f.power = f.power || f.motion || in->axes_off ||
		  (w->r.c.gap.process == PROCESS_WIRE &&
		   (in->wire_broken || !p->wire_whole));
	return f;
}

static void check_sparks(const struct world *w, const struct forbidden *f)
{
	powered += w->r.out.power;
	if (!w->r.out.power)
		return;
	assert_false(f->power);
	assert_true(w->r.c.fault.latched == 0);
	assert_false(w->r.c.config.dry_run);
}

/* Those that end a motion at once. */
static uint64_t ending(const struct world *w, const struct forbidden *f)
{
	const uint64_t brake = fault_bit(FAULT_FIRE) |
			       (w->r.in.steers ? fault_bit(FAULT_DRIVE) |
						 fault_bit(FAULT_FOLLOWING) :
						 0);

	return f->always & ~brake;
}

static void check_drives(const struct world *w, const struct forbidden *f)
{
	enabled += w->r.out.enable;
	if (ending(w, f) ||
	    (f->always & ~fault_bit(FAULT_FIRE) &&
	     w->r.c.state == STATE_FAULT))
		assert_false(w->r.out.enable);
}

static void check_motion(struct world *w, const struct forbidden *f)
{
	const bool stands = memcmp(w->was, w->r.c.out.target,
				   sizeof(w->was)) == 0;

	moved += !stands;
	w->forbidden = f->motion ? w->forbidden + 1 : 0;
	if (w->forbidden > BRAKES_IN || ending(w, f))
		assert_true(stands);
}

/* On its way there, or there. */
static bool goes_to_fault(const struct cycle *c)
{
	return c->state == STATE_FAULT ||
	       (c->state == STATE_HOLD && c->hold.fails) ||
	       (cycle_is_manual(c) && c->manual.halt);
}

static void check_latch(struct world *w, const struct forbidden *f)
{
	struct fault *s = &w->r.c.fault;
	const uint64_t came = s->latched & ~w->latched_before;

	assert_true((f->always & ~s->latched) == 0);
	assert_true((came & ~s->untold) == 0);
	assert_true(s->fresh == 0);
	assert_int_equal(s->latched != 0, s->first != FAULT_NONE);
	if (s->latched)
		assert_true(goes_to_fault(&w->r.c));
	else
		assert_int_not_equal(w->r.c.state, STATE_FAULT);
	w->faulty = s->latched ? w->faulty + 1 : 0;
	if (w->faulty > BRAKES_IN)
		assert_int_equal(w->r.c.state, STATE_FAULT);
	for (uint64_t m = s->untold; m; m &= m - 1)
		latched[__builtin_ctzll(m)]++;
	s->untold = 0;
	w->latched_before = s->latched;
}

/* No start takes a stop back, and no fault with its reset does. */
static void check_stop(struct world *w)
{
	if (!w->r.c.loaded)
		w->stopped = false;
	if (w->stopped)
		assert_int_equal(w->r.c.state, STATE_HOLD);
}

/* -- A machine's life ----------------------------------------------------- */

static void period(struct world *w, uint64_t *s)
{
	static const double volts[] = { SHORTED_V, NARROW_V, SPARKING_V,
					SPARKING_V, OPEN_V, OPEN_V };
	struct forbidden f;

	inputs(w, s);
	load(w, s);
	while (one_in(s, 12))
		command(w, s);
	memcpy(w->was, w->r.c.out.target, sizeof(w->was));
	w->reset_went = w->r.c.out.reset;
	if (one_in(s, 400))
		cycle_overrun(&w->r.c, 1 + (uint32_t)(rnd(s) % 12));
	if (one_in(s, 15))
		w->r.in.gap_v = volts[rnd(s) % 6];
	memcpy(w->r.in.stands_at, w->r.out.target, sizeof(w->was));
	cycle_step(&w->r.c, &w->r.in, &w->r.out);
	w->reset_went = w->reset_went || w->r.out.reset;
	f = forbidden(w);
	check_sparks(w, &f);
	check_drives(w, &f);
	check_motion(w, &f);
	check_latch(w, &f);
	check_stop(w);
}

static void live(uint64_t *s)
{
	const struct cycle_config k = any_config(s);
	struct world w = { .job = true };

	rig_take(&w.r, cutting(), &k);
	w.probing = probing();
	w.r.in.plc = well();
	for (int i = 0; i < CYCLES; i++)
		period(&w, s);
	unmake(&w.probing);
	rig_free(&w.r);
}

static void nothing_breaks_the_guards(void **st)
{
	const char *given = getenv("EDM_RUNS");
	const int runs = given ? atoi(given) : RUNS;
	uint64_t s = seed;

	(void)st;
	for (int i = 0; i < runs; i++)
		live(&s);
	print_message("    with power %llu, enabled %llu, moved %llu, reset "
		      "%llu, refused %llu\n", (unsigned long long)powered,
		      (unsigned long long)enabled, (unsigned long long)moved,
		      (unsigned long long)resets, (unsigned long long)kept);
	for (int i = FAULT_NONE + 1; i < CYCLE_NFAULTS; i++)
		print_message("    %-18s %llu\n", fault_name((uint32_t)i),
			      (unsigned long long)latched[i]);
	assert_true(powered > 0 && moved > 0 && resets > 0 && kept > 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(nothing_breaks_the_guards),
	};

	seed = seed_take();
	return cmocka_run_group_tests(tests, NULL, NULL);
}
