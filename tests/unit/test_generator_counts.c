/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_generator_counts.c - the gap servo by what a generator counts: shares of
 * two tellings, what is too old for them, and cuts in the simulated gap by
 * counts that come seldom and late
 */
#include "config_help.h"
#include "cycle_help.h"
#include "seed.h"

#include "generator_own.h"

#include <linux/can.h>
#include <sys/socket.h>

#define LATE_MOST	64		/* periods; a power of two */

struct bed {
	struct machine_config c;
	struct io_machine m;		/* the generator in front of it */
	struct io_inputs in;
	struct io_outputs out;
	struct generator *g;
	int fd;
	/* What it has counted, now and periods ago. */
	double count[GENERATOR_NCOUNTS];
	double past[LATE_MOST][GENERATOR_NCOUNTS];
	uint32_t periods;
};

static const char counting[] =
	"[generator]\ninterface = can\nspark = can 1009 byte 0 bit 0\n"
	"told_opens = can 1012 byte 0 bits 32\n"
	"told_sparks = can 1012 byte 4 bits 32\n"
	"told_arcs = can 1013 byte 0 bits 32\n"
	"told_shorts = can 1013 byte 4 bits 32\nsilent_ms = 2000\n";

/* @m is what it stands before. */
static void bed_generator(struct bed *b, struct io_machine m)
{
	int fd[2];

	b->m = m;
	b->c.gap.source = GAP_COUNTS;
	assert_int_equal(socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK, 0,
				    fd), 0);
	b->g = generator_attach(&b->m, &b->c, fd[0]);
	assert_non_null(b->g);
	b->fd = fd[1];
	io_pulse_own(&b->out);
}

static void bed_make(struct bed *b, const char *more)
{
	char text[1024];
	struct io_machine m;
	struct interp_diag d;

	memset(b, 0, sizeof(*b));
	snprintf(text, sizeof(text), "[machine]\nbackend = null\n"
		 "period_us = 1000\n%s[gap]\n%s", counting, more);
	assert_int_equal(read_text(text, &b->c, &d), 0);
	assert_int_equal(io_null_open(&m, &b->c, &d), 0);
	bed_generator(b, m);
}

static void bed_unmake(struct bed *b)
{
	b->m.close(b->m.self);
	close(b->fd);
}

static void send_pair(struct bed *b, uint16_t id, double first, double second)
{
	struct can_frame f = { .can_id = id, .can_dlc = 8 };

	can_put(f.data, (uint32_t)(uint64_t)first, 4);
	can_put(f.data + 4, (uint32_t)(uint64_t)second, 4);
	assert_int_equal(write(b->fd, &f, sizeof(f)), sizeof(f));
}

/* Two frames, as the count was @late periods ago. */
static void tell_counts(struct bed *b, uint32_t late)
{
	const double *n = b->past[(b->periods - late) % LATE_MOST];

	send_pair(b, 1012, n[0], n[1]);
	send_pair(b, 1013, n[2], n[3]);
}

static void count(struct bed *b, double open, double spark, double arc,
		  double shorted)
{
	const double more[] = { open, spark, arc, shorted };

	b->periods++;
	for (int i = 0; i < GENERATOR_NCOUNTS; i++)
		b->past[b->periods % LATE_MOST][i] = b->count[i] += more[i];
}

static void drain(struct bed *b)
{
	struct can_frame f;

	while (read(b->fd, &f, sizeof(f)) == sizeof(f))
		;
}

static void period(struct bed *b)
{
	b->m.read(b->m.self, &b->in);
	b->m.write(b->m.self, &b->out);
	drain(b);
}

static bool log_has(struct bed *b, const char *text)
{
	char line[160];
	bool any = false;

	while (b->m.note(b->m.self, line, sizeof(line)))
		any = any || strstr(line, text);
	return any;
}

/* -- Readings -------------------------------------------------------------- */

static void counts_between_two_tellings_are_shares(void **state)
{
	struct bed b;

	(void)state;
	bed_make(&b, "");
	b.out.power = true;
	period(&b);
	count(&b, 3, 4, 5, 6);
	tell_counts(&b, 0);
	period(&b);
	assert_true(b.in.shares_due && !b.in.shares_valid);
	count(&b, 1, 2, 3, 14);
	tell_counts(&b, 0);
	period(&b);
	assert_true(b.in.shares_valid && !b.in.shares_due && !b.in.shares_old);
	assert_near(b.in.shares.open, 0.05, 1e-6);
	assert_near(b.in.shares.spark, 0.1, 1e-6);
	assert_near(b.in.shares.arc, 0.15, 1e-6);
	assert_near(b.in.shares.shorted, 0.7, 1e-6);
	period(&b);
	assert_true(b.in.shares_valid && b.in.shares_old);
	bed_unmake(&b);
}

/* Half of a telling is none: its parts are of other times. */
static void a_reading_is_of_all_sums(void **state)
{
	struct bed b;

	(void)state;
	bed_make(&b, "");
	b.out.power = true;
	period(&b);
	tell_counts(&b, 0);
	period(&b);
	count(&b, 10, 10, 0, 0);
	send_pair(&b, 1012, 10, 10);
	period(&b);
	assert_false(b.in.shares_valid);
	send_pair(&b, 1013, 0, 0);
	period(&b);
	assert_true(b.in.shares_valid);
	assert_near(b.in.shares.open, 0.5, 1e-6);
	bed_unmake(&b);
}

/* The shorts that made it retract are not those of the next sparks, also if
 * they are told after these have begun. */
static void no_pulse_of_before_a_jump_is_in_a_reading(void **state)
{
	struct bed b;

	(void)state;
	bed_make(&b, "");
	b.out.power = true;
	period(&b);
	for (int i = 0; i < 4; i++) {
		count(&b, 0, 0, 0, 20);
		tell_counts(&b, 0);
		period(&b);
	}
	assert_true(b.in.shares.shorted == 1);
	b.out.power = false;
	count(&b, 0, 0, 0, 20);
	period(&b);
	count(&b, 0, 0, 0, 0);
	period(&b);
	assert_false(b.in.shares_valid || b.in.shares_due);
	b.out.power = true;
	period(&b);
	tell_counts(&b, 0);
	period(&b);
	assert_true(b.in.shares_due);
	count(&b, 20, 0, 0, 0);
	tell_counts(&b, 0);
	period(&b);
	assert_true(b.in.shares_valid && b.in.shares.open == 1);
	bed_unmake(&b);
}

static void a_reading_is_of_enough_pulses_or_of_enough_time(void **state)
{
	struct bed b;
	int i = 0;

	(void)state;
	bed_make(&b, "share_pulses = 10\nshare_stale_ms = 40\n");
	b.out.power = true;
	period(&b);
	tell_counts(&b, 0);
	period(&b);
	for (i = 0; i < 9; i++) {
		count(&b, 0, 1, 0, 0);
		tell_counts(&b, 0);
		period(&b);
		assert_false(b.in.shares_valid);
	}
	count(&b, 0, 1, 0, 0);
	tell_counts(&b, 0);
	period(&b);
	assert_true(b.in.shares_valid);
	/* A pulse each 8 ms. */
	for (i = 0; i < 100; i++) {
		count(&b, 0, i % 8 == 0, 0, 0);
		tell_counts(&b, 0);
		period(&b);
		assert_true(b.in.shares_valid);
	}
	bed_unmake(&b);
}

static void counts_that_stop_are_none_in_share_stale_ms(void **state)
{
	for (int silent = 0; silent < 2; silent++) {
		struct bed b;

		(void)state;
		bed_make(&b, "share_stale_ms = 40\n");
		b.out.power = true;
		period(&b);
		for (int i = 0; i < 3; i++) {
			count(&b, 0, 20, 0, 0);
			tell_counts(&b, 0);
			period(&b);
		}
		for (int i = 0; i < 40; i++) {
			assert_true(b.in.shares_valid);
			if (!silent)
				tell_counts(&b, 0);
			period(&b);
		}
		assert_true(b.in.shares_valid);
		period(&b);
		assert_false(b.in.shares_valid || b.in.shares_due);
		assert_true(log_has(&b, silent ? "does not tell its opens" :
						 "stand still or jump"));
		bed_unmake(&b);
	}
}

static void counts_that_never_come_are_none_in_share_stale_ms(void **st)
{
	struct bed b;

	(void)st;
	bed_make(&b, "share_stale_ms = 40\n");
	b.out.power = true;
	for (int i = 0; i < 41; i++) {
		period(&b);
		assert_true(i == 0 || b.in.shares_due);
	}
	period(&b);
	assert_false(b.in.shares_due || b.in.shares_valid);
	bed_unmake(&b);
}

/* From @from on all of them; what it counted between is not known. */
static void check_counting_anew(double from)
{
	struct bed b;

	bed_make(&b, "");
	b.out.power = true;
	count(&b, from, from, from, from);
	period(&b);
	for (int i = 0; i < 3; i++) {
		count(&b, 1000, 3000, 0, 0);
		tell_counts(&b, 0);
		period(&b);
	}
	assert_near(b.in.shares.open, 0.25, 1e-6);
	memset(b.count, 0, sizeof(b.count));
	count(&b, 50, 0, 0, 0);
	tell_counts(&b, 0);
	period(&b);
	assert_true(b.in.shares_old);
	assert_near(b.in.shares.open, 0.25, 1e-6);
	count(&b, 0, 50, 0, 0);
	tell_counts(&b, 0);
	period(&b);
	assert_true(!b.in.shares_old && b.in.shares.spark == 1);
	assert_true(b.g->heard[PROCESS_SPARKS] < 10000);
	bed_unmake(&b);
}

/* From high up, 0 is not far ahead of it. */
static void one_that_counts_anew_gives_no_reading_of_that(void **state)
{
	(void)state;
	check_counting_anew(0);
	check_counting_anew(3e9);
	check_counting_anew(UINT32_MAX - 1e8);
}

/* -- Whatever it does ------------------------------------------------------ */

#define PERIODS		1000000

/* What was told with sparks since they came on. */
struct witness {
	double first[GENERATOR_NCOUNTS], last[GENERATOR_NCOUNTS];
	int tellings;
	uint32_t lit, since;		/* periods */
};

static void check_reading(const struct bed *b, const struct witness *w)
{
	const struct io_shares *s = &b->in.shares;
	const double part[] = { (double)s->open, (double)s->spark,
				(double)s->arc, (double)s->shorted };
	double sum = 0;

	assert_false(b->in.shares_valid && b->in.shares_due);
	if (!b->in.shares_valid)
		return;
	/* Two tellings with sparks at the least, and not too long ago. */
	assert_true(w->lit > 1 && w->tellings > 1);
	assert_true(w->since <= b->g->counts.stale + 1);
	for (int i = 0; i < GENERATOR_NCOUNTS; i++) {
		assert_true(part[i] >= 0 && part[i] <= 1);
		assert_true(part[i] == 0 || w->last[i] > w->first[i]);
		sum += part[i];
	}
	assert_near(sum, 1, 1e-5);
}

static void witness_telling(struct bed *b, struct witness *w)
{
	if (w->tellings++ == 0)
		memcpy(w->first, b->count, sizeof(w->first));
	memcpy(w->last, b->count, sizeof(w->last));
	w->since = 0;
}

/* Now and then: whole, half of one, or it was switched off and on. */
static void random_telling(struct bed *b, struct witness *w, uint64_t *seed)
{
	switch (rnd(seed) % 24) {
	case 0:
		send_pair(b, 1012, b->count[0], b->count[1]);
		break;
	case 1:
		/* So far that it is seen: it cannot come so far again. */
		if (fmin(b->count[2], b->count[3]) < 20000)
			break;
		for (int i = 0; i < GENERATOR_NCOUNTS; i++) {
			b->count[i] = 0;
			w->first[i] = -1;
		}
		break;
	case 2: case 3: case 4: case 5: case 6:
		tell_counts(b, 0);
		witness_telling(b, w);
		break;
	default:
		break;
	}
}

static void every_reading_is_of_sparks_since_they_came_on(void **state)
{
	uint64_t seed = seed_take(), readings = 0, none = 0;
	struct witness w = { .tellings = 0 };
	struct bed b;

	(void)state;
	bed_make(&b, "share_stale_ms = 60\n");
	for (int i = 0; i < SEED_ROUNDS(PERIODS); i++) {
		const bool sparks = b.out.power;
		const bool silent = i / 500 % 10 == 4;

		if (rnd(&seed) % 100 == 0)
			b.out.power = !b.out.power;
		count(&b, sparks * (double)(rnd(&seed) % 9),
		      sparks * (double)(rnd(&seed) % 9),
		      sparks * (double)(rnd(&seed) % 3),
		      sparks * (double)(rnd(&seed) % 3));
		w.since++;
		w.lit = sparks ? w.lit + 1 : 0;
		w.tellings = sparks ? w.tellings : 0;
		if (!silent)
			random_telling(&b, &w, &seed);
		period(&b);
		check_reading(&b, &w);
		readings += b.in.shares_valid && !b.in.shares_old;
		none += sparks && !b.in.shares_valid && !b.in.shares_due;
		while (log_has(&b, "generator"))
			;
	}
	print_message("%llu readings; %llu periods with sparks and none\n",
		      (unsigned long long)readings, (unsigned long long)none);
	assert_true(readings > 1000 && none > 100);
	bed_unmake(&b);
}

/* -- A cut ----------------------------------------------------------------- */

struct counter {
	struct bed *b;
	struct io_machine sim;
	uint32_t every, late;		/* periods */
};

/* The simulated generator's own shares, as sums. */
static void counter_read(void *self, struct io_inputs *in)
{
	struct counter *k = self;
	const struct io_shares *s = &in->shares;
	const double pulses = 25;

	k->sim.read(k->sim.self, in);
	if (in->shares_valid)
		count(k->b, pulses * (double)s->open, pulses * (double)s->spark,
		      pulses * (double)s->arc, pulses * (double)s->shorted);
	else
		count(k->b, 0, 0, 0, 0);
	in->shares_valid = false;
	if (k->b->periods % k->every == 0 && k->b->periods > k->late)
		tell_counts(k->b, k->late);
}

static void counter_write(void *self, const struct io_outputs *out)
{
	struct counter *k = self;

	k->sim.write(k->sim.self, out);
}

static void counter_close(void *self)
{
	struct counter *k = self;

	k->sim.close(k->sim.self);
}

struct cut {
	double mm, forward_um;	/* the farthest of one reading */
	uint64_t retracts;
	enum cycle_fault fault;
};

static struct made deep_cut(void)
{
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);

	cut_to(b, -20);
	return finish(b);
}

/* The way forward since the last reading is no more than it is good for. */
static void watch_way(struct cut *ret, const struct cycle *c,
		      const struct io_inputs *in, double *at_mm)
{
	const double place = interp_cursor_place_mm(&c->cursor);

	if (!in->shares_old || !c->out.power)
		*at_mm = place;
	ret->forward_um = fmax(ret->forward_um, 1000 * (place - *at_mm));
}

/* A machine of the simulator, but for its generator. */
static void cut_open(struct bed *b, struct counter *k, double share_mm,
		     struct cycle_config *ret)
{
	static const char *const told[] = {
		"can 1012 byte 0 bits 32", "can 1012 byte 4 bits 32",
		"can 1013 byte 0 bits 32", "can 1013 byte 4 bits 32",
	};
	struct interp_diag d;
	char text[300];

	snprintf(text, sizeof(text), "[machine]\nbackend = sim\n"
		 "period_us = 1000\n[gap]\nshare_mm = %g\n"
		 "share_stale_ms = 300\n[jump]\nheight_mm = 0\n", share_mm);
	assert_int_equal(read_text(text, &b->c, &d), 0);
	assert_int_equal(io_sim_open_seed(&k->sim, &b->c, 1), 0);
	b->c.gap.source = GAP_COUNTS;
	config_cycle(&b->c, ret);
	b->c.generator.interface = GENERATOR_CAN;
	strcpy(b->c.generator.field[PROCESS_SPARK], "can 1009 byte 0 bit 0");
	for (int i = 0; i < GENERATOR_NCOUNTS; i++)
		strcpy(b->c.generator.told[PROCESS_OPENS + i], told[i]);
	bed_generator(b, (struct io_machine) {
		.self = k, .read = counter_read, .write = counter_write,
		.close = counter_close });
}

static struct cut cut_by(uint32_t every, uint32_t late, double share_mm)
{
	struct bed b = { .periods = 0 };
	struct counter k = { .b = &b, .every = every, .late = late };
	struct cut ret = { .mm = 0 };
	struct cycle_config config;
	struct cycle c;
	struct made m = deep_cut();
	double at_mm = 0;

	cut_open(&b, &k, share_mm, &config);
	cycle_init(&c, &config);
	assert_int_equal(cycle_load(&c, &m.p), ANSWER_DONE);
	assert_int_equal(cycle_command(&c, &(struct cycle_command) {
		.verb = CYCLE_START }), ANSWER_DONE);
	for (int i = 0; i < 60000 && !c.fault.latched; i++) {
		b.m.read(b.m.self, &b.in);
		cycle_step(&c, &b.in, &b.out);
		watch_way(&ret, &c, &b.in, &at_mm);
		b.m.write(b.m.self, &b.out);
		drain(&b);
	}
	ret.mm = c.far_mm;
	ret.retracts = c.totals.retracts;
	ret.fault = c.fault.first;
	bed_unmake(&b);
	unmake(&m);
	return ret;
}

/* As the machine file has it, but for the way. */
static struct cut cut_each(uint32_t ms, double share_mm)
{
	const struct cut x = cut_by(ms, ms, share_mm);

	printf("told each %u ms, as late, good for %g mm: %.3f mm in 60 s, "
	       "%llu retracts, at most %.1f um by a reading\n", ms, share_mm,
	       x.mm, (unsigned long long)x.retracts, x.forward_um);
	assert_int_equal(x.fault, FAULT_NONE);
	return x;
}

static void it_cuts_on_by_counts_that_come_seldom_and_late(void **state)
{
	const struct cut often = cut_each(1, 0.002), ten = cut_each(10, 0.002);
	const struct cut seldom = cut_each(50, 0.002);
	const struct cut blind = cut_each(50, 10);

	(void)state;
	assert_true(ten.mm > often.mm * 0.9 && seldom.mm > often.mm * 0.9);
	assert_true(ten.retracts <= often.retracts &&
		    seldom.retracts <= often.retracts);
	/* A cycle is 0.5 um at the fastest. */
	assert_true(ten.forward_um < 3 && seldom.forward_um < 3);
	/* That is what the way is for. */
	assert_true(blind.forward_um > 15 &&
		    blind.retracts > 3 * often.retracts);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(counts_between_two_tellings_are_shares),
		cmocka_unit_test(a_reading_is_of_all_sums),
		cmocka_unit_test(no_pulse_of_before_a_jump_is_in_a_reading),
		cmocka_unit_test(
			a_reading_is_of_enough_pulses_or_of_enough_time),
		cmocka_unit_test(counts_that_stop_are_none_in_share_stale_ms),
		cmocka_unit_test(
			counts_that_never_come_are_none_in_share_stale_ms),
		cmocka_unit_test(
			one_that_counts_anew_gives_no_reading_of_that),
		cmocka_unit_test(
			every_reading_is_of_sparks_since_they_came_on),
		cmocka_unit_test(
			it_cuts_on_by_counts_that_come_seldom_and_late),
	};

	return cmocka_run_group_tests(tests, make_file, remove_file);
}
