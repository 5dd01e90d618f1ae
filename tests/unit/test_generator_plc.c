/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_generator_plc.c - a whole cycle with a generator that a PLC sets: frames
 * out, frames in, a PLC that scans, and a generator behind it that needs time
 */
#include "generator_help.h"

#define NODE		32
#define ALIVE_MS	40
#define SILENT_MS	60
#define BOX		64		/* frames on their way */
#define LOST		999.0		/* of a generator that was switched
					 * off */

static const char machine[] =
	"[machine]\nbackend = null\nperiod_us = 1000\n"
	"[plc]\ninterface = can1\nnode = 32\nalive_ms = 40\n"
	"[generator]\ninterface = plc\npolarity_ms = 3\nsilent_ms = 60\n"
	"confirm_s = 0.5\nfault_words = 7 no water\n";

struct box {
	struct can_msg m[BOX];
	int n;
};

#define NVALUES		PLC_NPULSES

/* Current, on, off, voltage, servo; negative and iso are 1 or 0. */
struct pulse {
	double v[NVALUES];
	bool negative, iso;
};

/* What the page of signals says of each, in a PLC that is programmed as
 * docs/plc.md has it. */
struct far_end {
	struct pulse image, real, next;	/* received, at the generator */
	uint16_t asked, set, in_force;	/* numbers */
	uint16_t read_of;		/* what was asked when the servo's
					 * voltage was asked for by SDO */
	bool reads, has_read;
	bool plain;			/* it knows nothing of that voltage */
	uint16_t fault;
	int left;			/* periods until real is next; -1: is */
	int to_scan, scan_most, slow_most;
	bool toggle, lies, mute, dead, hasty;
	uint64_t seed, losses;
	bool evidence;			/* what it lost was told */
};

struct plant {
	struct shop s;
	struct plc plc;
	struct far_end far;
	struct box to, from;
};

static void put(struct box *b, const struct can_msg *m)
{
	assert_true(b->n < BOX);
	b->m[b->n++] = *m;
}

static struct can_msg take(struct box *b)
{
	const struct can_msg m = b->m[0];

	memmove(b->m, b->m + 1, (size_t)--b->n * sizeof(m));
	return m;
}

/* -- The PLC --------------------------------------------------------------- */

static double value_at(const struct can_msg *m, int byte)
{
	const uint32_t count = can_get(m->data + byte, 2);

	return count == 65535 ? (double)NAN : count * 0.1;
}

static void plc_takes(struct far_end *f, const struct can_msg *m)
{
	if (m->id == 0x680 + NODE) {
		for (int i = 0; i < 4; i++)
			f->image.v[i] = value_at(m, 2 * i);
	} else if (m->id == 0x500 + NODE) {
		f->asked = (uint16_t)can_get(m->data + 5, 2);
		f->image.negative = m->data[7] & 1;
		f->image.iso = m->data[7] & 2;
	} else if (m->id == 0x580 + NODE) {
		assert_int_equal(m->data[0], 0x4b);
		f->image.v[4] = value_at(m, 4);
		f->reads = false;
		f->has_read = true;
	}
}

/* What comes may be of a number before: it is read until none came between. */
static bool plc_has_read(struct plant *p)
{
	struct far_end *f = &p->far;
	const struct can_msg ask = { .id = 0x600 + NODE, .len = 8,
				     .data = { 0x40, 0x02, 0x20, 5 } };
	const bool has = f->has_read && f->read_of == f->asked;

	if (has || f->reads || f->plain) {
		f->has_read = false;
		return has || f->plain;
	}
	f->has_read = false;
	f->reads = true;
	f->read_of = f->asked;
	put(&p->from, &ask);
	return false;
}

static void plc_program(struct plant *p)
{
	struct far_end *f = &p->far;

	if (f->asked == 0) {
		f->in_force = f->set = 0;
	} else if (f->asked != f->set) {
		if (!plc_has_read(p))
			return;
		f->next = f->image;
		f->set = f->asked;
		f->left = (int)(rnd(&f->seed) % (uint64_t)(f->slow_most + 1));
		f->in_force = f->hasty ? f->set : f->in_force;
	} else if (f->left < 0) {
		f->in_force = f->set;
	}
}

static uint32_t count_of(double v)
{
	return isnan(v) ? 65535 : (uint32_t)lround(v * 10);
}

static void plc_answers(struct plant *p)
{
	struct far_end *f = &p->far;
	const struct pulse *told = f->lies ? &f->next : &f->real;
	struct can_msg ask = { .id = 0x200 + NODE, .len = 8,
			       .data = { 1, 0x1f, 0xe8, 3 } };
	struct can_msg generator = { .id = 0x300 + NODE,
				     .len = f->plain ? 5 : 7 };
	struct can_msg pulse = { .id = 0x400 + NODE, .len = 8 };
	const bool first = rnd(&f->seed) % 2;

	f->toggle = !f->toggle;
	ask.data[0] |= (uint8_t)(f->toggle << 7);
	put(&p->from, &ask);
	can_put(generator.data, f->in_force, 2);
	can_put(generator.data + 2, f->fault, 2);
	generator.data[4] = (uint8_t)(told->negative | told->iso << 1);
	if (!f->plain)
		can_put(generator.data + 5, count_of(told->v[4]), 2);
	for (int i = 0; i < 4; i++)
		can_put(pulse.data + 2 * i, count_of(told->v[i]), 2);
	if (f->mute)
		return;
	put(&p->from, first ? &generator : &pulse);
	put(&p->from, first ? &pulse : &generator);
	f->evidence = told->v[0] == LOST;
}

/* What had come when the scan began: some frames may be behind that. */
static void plc_scans(struct plant *p)
{
	struct far_end *f = &p->far;
	const int later = p->to.n ? (int)(rnd(&f->seed) % 2) : 0;

	while (p->to.n > later) {
		const struct can_msg m = take(&p->to);

		plc_takes(f, &m);
	}
	if (f->dead)
		return;
	plc_program(p);
	plc_answers(p);
	f->to_scan = (int)(rnd(&f->seed) % (uint64_t)(f->scan_most + 1));
}

static void far_period(struct plant *p)
{
	struct far_end *f = &p->far;

	if (f->left == 0)
		f->real = f->next;
	f->left -= f->left >= 0;
	if (f->to_scan-- <= 0)
		plc_scans(p);
}

/* -- The machine ----------------------------------------------------------- */

static void plant_open_with(struct plant *p, int cuts, uint64_t seed,
			    bool servo)
{
	struct cycle_config k;
	struct generator *g;
	char text[400];

	memset(&p->plc, 0, sizeof(*p) - sizeof(p->s));
	snprintf(text, sizeof(text), "%s%s", machine, servo ?
		 "servo_v = plc\n" : "");
	g = shop_generator(&p->s, text);
	plc_init(&p->plc, NODE);
	p->plc.sets = true;
	p->plc.send_cycles = 20;
	p->plc.alive_cycles = ALIVE_MS;
	g->takes = true;
	g->plc = &p->plc;
	p->far = (struct far_end) { .seed = seed, .left = -1, .scan_most = 4,
				    .slow_most = 9, .plain = !servo };
	k = shop_config(&p->s);
	shop_load(&p->s, cuts, &k);
	put(&p->from, &(struct can_msg) { .len = 2, .data = { 1, NODE } });
}

static void plant_open(struct plant *p, int cuts, uint64_t seed)
{
	plant_open_with(p, cuts, seed, true);
}

static void plant_close(struct plant *p)
{
	rig_free(&p->s.r);
	p->s.axes.close(p->s.axes.self);
}

static bool same(double has, double asked)
{
	return fabs(has - asked) < 0.06;
}

static bool has_the_places(const struct plant *p)
{
	static const enum interp_tech_id field[NVALUES] = {
		INTERP_TECH_PEAK_A, INTERP_TECH_ON_US, INTERP_TECH_OFF_US,
		INTERP_TECH_IGNITION_V, INTERP_TECH_SERVO_V
	};
	const struct interp_tech *t = place_of(&p->s);
	const struct pulse *real = &p->far.real;
	bool all = real->negative == (t->v[INTERP_TECH_POLARITY] < 0);

	for (int i = 0; i < NVALUES - p->far.plain; i++)
		all = all && same(real->v[i], t->v[field[i]]);
	return all;
}

/* What the generator loses by itself is not known before the PLC tells it. */
static void check_spark(struct plant *p, bool evidence)
{
	const bool lost = p->far.real.v[0] == LOST;

	if (!p->s.r.out.power)
		return;
	p->s.sparks++;
	if (lost)
		assert_false(evidence);
	else
		assert_true(has_the_places(p));
}

static void turn_at(struct plant *p, double gap_v)
{
	struct can_msg out[PLC_EMITS];
	struct shop *s = &p->s;
	const bool waits = asking_waits(&s->r.c);
	const bool evidence = p->far.evidence;
	size_t n;

	while (p->from.n) {
		const struct can_msg m = take(&p->from);

		plc_receive(&p->plc, &m);
	}
	plc_period(&p->plc);
	s->axes.read(s->axes.self, &s->r.in);
	step(&s->r, waits ? 0 : gap_v);
	s->waits += waits;
	check_spark(p, evidence);
	s->axes.write(s->axes.self, &s->r.out);
	n = plc_emit(&p->plc, out);
	for (size_t i = 0; i < n; i++)
		put(&p->to, &out[i]);
	far_period(p);
}

static void turn(struct plant *p)
{
	turn_at(p, SPARKING_V + 5);
}

static void until_sparks(struct plant *p)
{
	const uint64_t had = p->s.sparks;

	for (int i = 0; i < 3000 && p->s.sparks == had; i++)
		turn(p);
	assert_true(p->s.sparks > had);
}

static void until_fault(struct plant *p, int most)
{
	for (int i = 0; i < most && !p->s.r.c.fault.latched; i++)
		turn(p);
	assert_int_equal(p->s.r.c.fault.first, FAULT_GENERATOR);
	assert_false(p->s.r.out.power);
}

static void log_is(struct plant *p, const char *text)
{
	char line[160] = "";

	assert_true(p->s.axes.note(p->s.axes.self, line, sizeof(line)));
	assert_string_equal(line, text);
}

/* -- The promises ---------------------------------------------------------- */

static void c200_reaches_it_whole_before_the_first_spark(void **state)
{
	struct plant p;

	(void)state;
	plant_open(&p, 1, 1);
	until_sparks(&p);
	assert_true(p.s.waits > 0);
	assert_true(fabs(p.far.real.v[0] - 6) < 1e-9);
	assert_true(fabs(p.far.real.v[1] - 8) < 1e-9);
	assert_true(fabs(p.far.real.v[2] - 20) < 1e-9);
	assert_true(fabs(p.far.real.v[3] - 180) < 1e-9);
	assert_true(fabs(p.far.real.v[4] - 15) < 1e-9);
	plant_close(&p);
}

/* Its PlcGenerator ends before ToldServo, and nothing is missed. */
static void one_without_a_servo_of_its_own_is_good_as_it_is(void **state)
{
	struct plant p;

	(void)state;
	plant_open_with(&p, 3, 1, false);
	until_sparks(&p);
	assert_true(isnan(p.s.r.out.pulse[INTERP_TECH_SERVO_V]));
	assert_int_equal(p.plc.tell.pulse.value[4], UINT16_MAX);
	assert_int_equal(p.plc.malformed, 0);
	assert_true(p.s.r.c.gap.servo_v == 15);
	/* Where it is laid out, what is not told any more is a lie. */
	plant_close(&p);
	plant_open(&p, 3, 1);
	until_sparks(&p);
	p.far.plain = true;
	until_fault(&p, 20);
	log_is(&p, "generator: servo_v was in force and is no more: asked 15, "
	       "told 6553.5");
	plant_close(&p);
}

/* A scan, the generator's time, a scan that tells it, and two periods. */
static void a_change_takes_a_round_trip_and_two_periods(void **state)
{
	struct plant p;
	uint32_t asked;
	int n = 0;

	(void)state;
	plant_open(&p, 3, 1);
	p.far.scan_most = p.far.slow_most = 0;
	until_sparks(&p);
	asked = p.s.r.out.asked;
	while (p.s.r.out.asked == asked)
		turn(&p);
	assert_false(p.s.r.out.power);
	for (; !p.s.r.out.power; n++)
		turn(&p);
	print_message("from asking to sparks: %d periods\n", n);
	assert_in_range(n, 2, 4);
	plant_close(&p);
}

/* It has the same number from before, and the same values. */
static void a_number_of_before_is_not_taken_for_an_answer(void **state)
{
	struct plant p;

	(void)state;
	plant_open(&p, 1, 1);
	p.far.dead = true;
	for (int i = 0; i < 3; i++)
		turn(&p);
	p.far.dead = false;
	p.far.asked = p.far.set = p.far.in_force =
		(uint16_t)(p.s.r.out.asked + 1);
	p.far.real = p.far.next = p.far.image = (struct pulse) {
		.v = { 6, 8, 20, 180 } };
	p.far.scan_most = 0;
	plc_answers(&p);
	turn(&p);
	assert_false(p.s.r.out.power);
	assert_int_equal(p.plc.tell.pulse.number, 0);
	until_sparks(&p);
	assert_int_equal(p.far.in_force, p.s.r.out.asked % 65535 + 1);
	plant_close(&p);
}

/* Trouble while it was away is none for the first job. */
static void a_plc_may_come_after_edmd(void **state)
{
	struct plant p;

	(void)state;
	plant_open(&p, 1, 1);
	tell(&p.s.r, CYCLE_HOLD);
	p.far.dead = true;
	for (int i = 0; i < 700; i++)
		turn(&p);
	assert_true(p.s.r.in.generator.trouble);
	p.far.dead = false;
	for (int i = 0; i < 50; i++)
		turn(&p);
	tell(&p.s.r, CYCLE_RESET);
	assert_false(p.s.r.in.generator.trouble);
	assert_int_equal(tell(&p.s.r, CYCLE_START), ANSWER_DONE);
	until_sparks(&p);
	plant_close(&p);
}

static void one_that_lies_ends_the_sparks_in_its_period(void **state)
{
	struct plant p;

	(void)state;
	plant_open(&p, 1, 1);
	p.far.scan_most = 0;
	until_sparks(&p);
	p.far.real.v[0] = 12;
	p.far.next = p.far.real;
	plc_answers(&p);
	turn(&p);
	assert_false(p.s.r.out.power);
	assert_int_equal(p.s.r.c.fault.first, FAULT_GENERATOR);
	log_is(&p, "generator: peak_a was in force and is no more: asked 6, "
		   "told 12");
	plant_close(&p);
}

static void a_plc_that_starts_anew_ends_the_sparks(void **state)
{
	struct plant p;

	(void)state;
	plant_open(&p, 1, 1);
	p.far.scan_most = 0;
	until_sparks(&p);
	p.far.in_force = 0;
	plc_answers(&p);
	turn(&p);
	assert_false(p.s.r.out.power);
	log_is(&p, "generator: peak_a was in force and is no more: asked 6, "
		   "told 6, not taken");
	plant_close(&p);
}

static void one_that_is_late_never_sparks_and_is_a_fault(void **state)
{
	struct plant p;

	(void)state;
	plant_open(&p, 1, 1);
	p.far.slow_most = 0;
	p.far.lies = true;		/* it tells what it was asked for */
	for (int i = 0; i < 600 && !p.s.r.c.fault.latched; i++) {
		p.far.left = 5;		/* ... and never has it */
		turn(&p);
		assert_false(p.s.r.out.power);
	}
	assert_int_equal(p.s.r.c.fault.first, FAULT_GENERATOR);
	log_is(&p, "generator: peak_a is not in force in confirm_s: asked 6, "
		   "told 6, not taken");
	plant_close(&p);
}

/* Its other frames still come, and Alive turns. */
static void one_that_is_silent_is_a_fault_in_silent_ms(void **state)
{
	struct plant p;
	int n = 0;

	(void)state;
	plant_open(&p, 1, 1);
	until_sparks(&p);
	p.far.mute = true;
	/* At the servo's voltage the machine stands, and sparks. */
	for (; !p.s.r.c.fault.latched && n < 200; n++)
		turn_at(&p, 15);
	assert_in_range(n, SILENT_MS - 6, SILENT_MS + 2);
	log_is(&p, "generator: it does not tell its peak_a any more");
	plant_close(&p);
}

static void its_own_fault_is_told_in_words(void **state)
{
	struct plant p;

	(void)state;
	plant_open(&p, 1, 1);
	until_sparks(&p);
	p.far.fault = 7;
	until_fault(&p, 10);
	log_is(&p, "generator: its own fault 7 no water");
	/* Gone, an operator resets, and it is asked once more. */
	p.far.fault = 0;
	for (int i = 0; i < 20; i++)
		turn(&p);
	assert_int_equal(tell(&p.s.r, CYCLE_RESET), ANSWER_DONE);
	for (int i = 0; i < 200; i++)
		turn(&p);
	assert_int_equal(tell(&p.s.r, CYCLE_START), ANSWER_DONE);
	until_sparks(&p);
	plant_close(&p);
}

/* The generator is switched off and on, the PLC starts anew, or is away. */
static void trouble_at_times(struct plant *p)
{
	struct far_end *f = &p->far;
	const uint64_t x = rnd(&f->seed) % 2000;

	if (x == 0) {
		f->real.v[0] = f->next.v[0] = LOST;
		f->losses++;
	} else if (x == 1) {
		f->asked = f->set = f->in_force = 0;
	}
	if (f->dead || f->mute) {
		f->dead = f->dead && x > 30;
		f->mute = f->mute && x > 30;
	} else {
		f->dead = x == 2;
		f->mute = x == 3;
	}
}

/* An operator who holds, goes back, and starts again. */
static void operate(struct plant *p)
{
	struct rig *r = &p->s.r;
	const uint64_t x = rnd(&p->far.seed) % 1000;
	const bool stands = r->c.state == STATE_HOLD && !r->c.hold.moving;

	if (x < 3)
		tell(r, CYCLE_HOLD);
	else if (x < 6 && stands)
		tell_mm(r, CYCLE_RETRACT, 0.3);
	else if (x < 100 && stands)
		tell(r, CYCLE_START);
	else if (x < 100 && r->c.state == STATE_FAULT)
		tell(r, CYCLE_RESET);
}

static uint64_t random_job(uint64_t seed, int periods, uint64_t *ret_losses)
{
	static const double volts[] = {
		SPARKING_V, OPEN_V, NARROW_V, SHORTED_V
	};
	struct plant p;
	uint64_t sparks;

	plant_open(&p, 400, seed);
	p.s.r.c.config.jump.height_mm = seed % 2 ? 0.4 : 0;
	p.far.scan_most = (int)(seed / 2 % 10);
	p.far.slow_most = (int)(seed / 20 % 30);
	for (int i = 0; i < periods && p.s.r.c.loaded; i++) {
		const uint64_t x = rnd(&p.far.seed) % 1000;

		operate(&p);
		if (seed / 600 % 2)
			trouble_at_times(&p);
		turn_at(&p, volts[x < 900 ? x % 2 : 2 + x % 2]);
	}
	sparks = p.s.sparks;
	*ret_losses += p.far.losses;
	plant_close(&p);
	return sparks;
}

static void never_a_spark_with_another_condition_than_the_places(void **state)
{
	const char *text = getenv("EDM_RUNS");
	const int rounds = text ? atoi(text) : SEED_ROUNDS(200);
	uint64_t seed = seed_take(), sparks = 0, losses = 0;

	(void)state;
	for (int i = 0; i < rounds; i++)
		sparks += random_job(rnd(&seed), 5000, &losses);
	print_message("%d jobs: %llu periods with sparks, %llu losses\n",
		      rounds, (unsigned long long)sparks,
		      (unsigned long long)losses);
	assert_true(sparks > (uint64_t)rounds * 500 && losses > 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(c200_reaches_it_whole_before_the_first_spark),
		cmocka_unit_test(one_without_a_servo_of_its_own_is_good_as_it_is),
		cmocka_unit_test(a_change_takes_a_round_trip_and_two_periods),
		cmocka_unit_test(a_number_of_before_is_not_taken_for_an_answer),
		cmocka_unit_test(a_plc_may_come_after_edmd),
		cmocka_unit_test(one_that_lies_ends_the_sparks_in_its_period),
		cmocka_unit_test(a_plc_that_starts_anew_ends_the_sparks),
		cmocka_unit_test(one_that_is_late_never_sparks_and_is_a_fault),
		cmocka_unit_test(one_that_is_silent_is_a_fault_in_silent_ms),
		cmocka_unit_test(its_own_fault_is_told_in_words),
		cmocka_unit_test(never_a_spark_with_another_condition_than_the_places),
	};

	return cmocka_run_group_tests_name("io/generator_plc", tests,
					   make_file, remove_file);
}
