/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_generator_modbus.c - a whole cycle with a generator on Modbus: no spark
 * before the slave has the condition of the place, none after it is known to
 * have another
 */
#include "generator_help.h"

#include "clocks.h"

#include <arpa/inet.h>
#include <modbus.h>
#include <pthread.h>
#include <stdatomic.h>
#include <sys/socket.h>
#include <unistd.h>

#define NREGISTERS	8
#define NINPUTS		8
#define TURN_US		200		/* of wall time, for a period */
#define TURNS_MOST	200000

/* A slave of libmodbus' own server, in a thread. */
struct slave {
	modbus_t *link;
	int listens, port;
	_Atomic int served;		/* -1: nobody is there */
	modbus_mapping_t *map;
	pthread_t thread;
	pthread_mutex_t lock;		/* of `map`: an answer is whole */
	_Atomic bool quit, no_6;	/* no_6: it has function 16 alone */
	_Atomic bool waits;		/* for the lock */
	_Atomic bool does;		/* input 0 is what it does: what is
					 * written, or its panel says */
	_Atomic int late_us, refuses;	/* refuses: a register, or -1 */
	_Atomic bool needs_time;	/* it acknowledges each write */
	_Atomic uint32_t asked, written;
};

static void acknowledge(struct slave *s, const uint8_t *ask, int at)
{
	const int first = ask[at + 1] << 8 | ask[at + 2];
	const uint8_t *x = ask + at + 6;

	for (int i = 0; i < ask[at + 5] / 2; i++, x += 2)
		s->map->tab_registers[first + i] = (uint16_t)(x[0] << 8 | x[1]);
	modbus_reply_exception(s->link, ask, MODBUS_EXCEPTION_ACKNOWLEDGE);
}

static void answer(struct slave *s, const uint8_t *ask, int n)
{
	const int at = modbus_get_header_length(s->link);
	const int first = ask[at + 1] << 8 | ask[at + 2];
	const int count = ask[at] == 6 ? 1 : ask[at + 3] << 8 | ask[at + 4];
	const int no = atomic_load(&s->refuses);

	s->asked++;
	usleep((useconds_t)atomic_load(&s->late_us));
	s->waits = true;
	pthread_mutex_lock(&s->lock);
	s->waits = false;
	s->written += ask[at] == 6 || ask[at] == 16;
	if (ask[at] == 16 && atomic_load(&s->needs_time))
		acknowledge(s, ask, at);
	else if (ask[at] == 6 && atomic_load(&s->no_6))
		modbus_reply_exception(s->link, ask,
				       MODBUS_EXCEPTION_ILLEGAL_FUNCTION);
	else if ((ask[at] == 6 || ask[at] == 16) && no >= first &&
		 no < first + count)
		modbus_reply_exception(s->link, ask,
				       MODBUS_EXCEPTION_ILLEGAL_DATA_VALUE);
	else
		modbus_reply(s->link, ask, n, s->map);
	if (atomic_load(&s->does) && (ask[at] == 6 || ask[at] == 16) && !first)
		s->map->tab_input_registers[0] = s->map->tab_registers[0];
	pthread_mutex_unlock(&s->lock);
}

static void *serve(void *arg)
{
	struct slave *s = arg;
	uint8_t ask[MODBUS_TCP_MAX_ADU_LENGTH];

	while (!atomic_load(&s->quit)) {
		int fd = s->listens, n = 0;

		if (modbus_tcp_accept(s->link, &fd) < 0)
			break;
		while ((n = modbus_receive(s->link, ask)) >= 0)
			if (n > 0)
				answer(s, ask, n);
		modbus_close(s->link);
	}
	return NULL;
}

static void slave_begin(struct slave *s)
{
	struct sockaddr_in at;
	socklen_t size = sizeof(at);

	*s = (struct slave) { .refuses = -1,
			      .lock = PTHREAD_MUTEX_INITIALIZER };
	s->map = modbus_mapping_new(0, 0, NREGISTERS, NINPUTS);
	/* Any port that is free. */
	s->listens = socket(AF_INET, SOCK_STREAM, 0);
	at = (struct sockaddr_in) { .sin_family = AF_INET,
				    .sin_addr.s_addr = htonl(INADDR_LOOPBACK) };
	assert_int_equal(bind(s->listens, (struct sockaddr *)&at, size), 0);
	assert_int_equal(listen(s->listens, 2), 0);
	assert_int_equal(getsockname(s->listens, (struct sockaddr *)&at, &size),
			 0);
	s->port = ntohs(at.sin_port);
	s->link = modbus_new_tcp("127.0.0.1", s->port);
	assert_int_equal(pthread_create(&s->thread, NULL, serve, s), 0);
}

static void slave_end(struct slave *s)
{
	atomic_store(&s->quit, true);
	shutdown(s->listens, SHUT_RDWR);
	pthread_join(s->thread, NULL);
	close(s->listens);
	modbus_free(s->link);
	modbus_mapping_free(s->map);
}

/* -- A cycle with that generator ------------------------------------------- */

static const char layout[] =
	"peak_a = register 0 scale 0.1\non_us = register 1 scale 0.1\n"
	"off_us = register 2 scale 0.1\nignition_v = register 3\n"
	"polarity = register 5 bit 0\nservo_v = register 6 scale 0.1\n";

static struct slave slave;
static struct shop shop;

static void shop_open_with(struct shop *s, int cuts, const char *more)
{
	struct interp_diag d = { .line = 0 };
	struct cycle_config k;
	struct generator *g;
	char text[700];

	slave_begin(&slave);
	snprintf(text, sizeof(text), "[machine]\nbackend = null\n"
		"period_us = 1000\n[generator]\ninterface = modbus\n"
		"modbus = 127.0.0.1:%d\nmodbus_every_ms = 2\n"
		"modbus_timeout_ms = 400\nsilent_ms = 60000\n"
		"confirm_s = 600\npolarity_ms = 3\n%s%s", slave.port, layout,
		more);
	g = shop_generator(s, text);
	assert_int_equal(generator_modbus_open(g, &s->c, &d), 0);
	k = shop_config(s);
	shop_load(s, cuts, &k);
}

static void set_registers(const uint16_t to[NREGISTERS])
{
	pthread_mutex_lock(&slave.lock);
	memcpy(slave.map->tab_registers, to, NREGISTERS * sizeof(*to));
	pthread_mutex_unlock(&slave.lock);
}

static void shop_open(struct shop *s, int cuts)
{
	shop_open_with(s, cuts, "");
}

/* Also of a test that failed: its threads would go on in the next one. */
static int shop_close(void **state)
{
	(void)state;
	rig_free(&shop.r);
	if (shop.axes.close)
		shop.axes.close(shop.axes.self);
	slave_end(&slave);
	memset(&shop, 0, sizeof(shop));
	return 0;
}

#define WITH_SHOP(test)	cmocka_unit_test_teardown(test, shop_close)

/* Nobody writes it while there are sparks: it is the condition of the place. */
static void check_spark(struct shop *s)
{
	const struct interp_tech *t = place_of(s);
	const uint16_t *has = slave.map->tab_registers;

	if (!s->r.out.power)
		return;
	s->sparks++;
	assert_int_equal(has[0], lround(10 * t->v[INTERP_TECH_PEAK_A]));
	assert_int_equal(has[1], lround(10 * t->v[INTERP_TECH_ON_US]));
	assert_int_equal(has[2], lround(10 * t->v[INTERP_TECH_OFF_US]));
	assert_int_equal(has[3], lround(t->v[INTERP_TECH_IGNITION_V]));
	assert_int_equal(has[6], lround(10 * t->v[INTERP_TECH_SERVO_V]));
	if (!isnan(t->v[INTERP_TECH_POLARITY]))
		assert_int_equal(has[5], t->v[INTERP_TECH_POLARITY] < 0);
}

static void turn(struct shop *s)
{
	const bool waits = asking_waits(&s->r.c);

	s->axes.read(s->axes.self, &s->r.in);
	step(&s->r, waits ? 0 : SPARKING_V + 5);
	check_spark(s);
	s->axes.write(s->axes.self, &s->r.out);
	s->waits += waits;
	if (waits)
		usleep(TURN_US);
}

static void c200_reaches_it_whole_before_the_first_spark(void **state)
{

	(void)state;
	shop_open(&shop, 1);
	for (int i = 0; i < TURNS_MOST && !shop.sparks; i++)
		turn(&shop);
	assert_int_equal(slave.map->tab_registers[0], 60);
	assert_int_equal(slave.map->tab_registers[1], 80);
	assert_int_equal(slave.map->tab_registers[2], 200);
	assert_int_equal(slave.map->tab_registers[3], 180);
	assert_int_equal(slave.map->tab_registers[6], 150);
	assert_true(shop.waits > 0);
}

/* It tells the others.  It has its voltage so long after it has taken it. */
static void what_it_does_not_tell_has_settle_ms(void **state)
{
	int64_t from_ns;

	(void)state;
	shop_open_with(&shop, 1, "told_ignition_v = none\nsettle_ms = 200\n");
	from_ns = clock_ns(CLOCK_MONOTONIC);
	for (int i = 0; i < TURNS_MOST && !shop.sparks; i++)
		turn(&shop);
	assert_true(shop.sparks > 0);
	assert_true(clock_ns(CLOCK_MONOTONIC) - from_ns >= 200 * 1000000);
}

static void no_spark_has_another_condition_however_late_it_is(void **state)
{
	uint64_t seed = seed_take();

	(void)state;
	shop_open(&shop, 30);
	for (int i = 0; i < TURNS_MOST && shop.r.c.loaded; i++) {
		if (rnd(&seed) % 50 == 0)
			slave.late_us = (int)(rnd(&seed) % 8000);
		turn(&shop);
	}
	assert_int_equal(shop.r.c.outcome, OUTCOME_DONE);
	assert_true(shop.sparks > 1000 && shop.waits > 30);
}

static void ask_on(struct shop *s, double on_us)
{
	s->r.out.pulse[INTERP_TECH_ON_US] = on_us;
	s->r.out.asked++;
	s->axes.write(s->axes.self, &s->r.out);
}

static void until_register(int i, uint16_t value)
{
	for (int n = 0; n < TURNS_MOST &&
	     slave.map->tab_registers[i] != value; n++)
		usleep(TURN_US);
	assert_int_equal(slave.map->tab_registers[i], value);
}

/* It does not tell it, and edmd asked for the same before. */
static void what_a_person_set_meanwhile_is_set_anew(void **state)
{
	(void)state;
	shop_open_with(&shop, 1, "told_on_us = none\n");
	ask_on(&shop, 8);
	until_register(1, 80);
	ask_on(&shop, NAN);
	set_registers((const uint16_t[NREGISTERS]) { 0, 555 });
	ask_on(&shop, 8);
	until_register(1, 80);
}

/* Before the first period of the cycle. */
static void until_told(struct shop *s, int field, double value)
{
	for (int i = 0; i < TURNS_MOST &&
	     s->r.in.generator.told[field] != value; i++) {
		s->axes.read(s->axes.self, &s->r.in);
		s->axes.write(s->axes.self, &s->r.out);
		usleep(TURN_US);
	}
	assert_true(s->r.in.generator.told[field] == value);
}

static void until_done(struct shop *s)
{
	for (int i = 0; i < TURNS_MOST && s->r.c.loaded; i++)
		turn(s);
	assert_int_equal(s->r.c.outcome, OUTCOME_DONE);
}

static void until_trouble(struct shop *s)
{
	for (int i = 0; i < TURNS_MOST && !s->r.in.generator.trouble; i++) {
		turn(s);
		usleep(TURN_US);
	}
	assert_true(s->r.in.generator.trouble);
}

/* It has what the job asks for before any job: so nothing is asked between two
 * of them. */
static void what_it_loses_between_jobs_is_no_fault(void **state)
{
	static const uint16_t c200[NREGISTERS] = {
		60, 80, 200, 180, 0, 0, 150
	};
	struct shop *s = &shop;

	(void)state;
	shop_open(s, 1);
	s->r.c.config.gap.servo_v = 15;
	set_registers(c200);
	until_told(s, INTERP_TECH_PEAK_A, 6);
	until_done(s);
	set_registers((const uint16_t[NREGISTERS]) { 0 });
	until_trouble(s);
	assert_int_equal(cycle_load(&s->r.c, &s->r.m.p), ANSWER_DONE);
	for (int i = 0; i < 3; i++)
		turn(s);
	assert_int_equal(tell(&s->r, CYCLE_START), ANSWER_DONE);
	until_done(s);
}

static void until_fault(struct shop *s)
{
	for (int i = 0; i < TURNS_MOST && !s->r.c.fault.latched; i++) {
		turn(s);
		usleep(TURN_US);
	}
	assert_int_equal(s->r.c.fault.first, FAULT_GENERATOR);
	assert_false(s->r.out.power);
}

static void what_it_refuses_never_sparks_and_is_a_fault(void **state)
{

	(void)state;
	shop_open(&shop, 3);
	slave.refuses = 2;
	until_fault(&shop);
	assert_int_equal(shop.sparks, 0);
	/* Once it takes it, an operator goes on. */
	slave.refuses = -1;
	shop.r.in.generator.trouble = false;
	assert_int_equal(tell(&shop.r, CYCLE_RESET), ANSWER_DONE);
	for (int i = 0; i < 50; i++)
		turn(&shop);
	assert_int_equal(tell(&shop.r, CYCLE_START), ANSWER_DONE);
	for (int i = 0; i < TURNS_MOST && !shop.sparks; i++)
		turn(&shop);
	assert_true(shop.sparks > 0);
}

static void one_that_loses_its_values_ends_the_sparks(void **state)
{

	(void)state;
	shop_open(&shop, 1);
	for (int i = 0; i < TURNS_MOST && !shop.sparks; i++)
		turn(&shop);
	slave.map->tab_registers[0] = 0;
	/* What it tells is the evidence. */
	for (int i = 0; i < TURNS_MOST && !shop.r.in.generator.trouble; i++) {
		shop.axes.read(shop.axes.self, &shop.r.in);
		usleep(TURN_US);
	}
	step(&shop.r, SPARKING_V);
	assert_false(shop.r.out.power);
	assert_int_equal(shop.r.c.fault.first, FAULT_GENERATOR);
}

/* -- A link that is cut ---------------------------------------------------- */

static void restart(void)
{
	pthread_mutex_lock(&slave.lock);
	memset(slave.map->tab_registers, 0, NREGISTERS * sizeof(uint16_t));
	shutdown(modbus_get_socket(slave.link), SHUT_RDWR);
	pthread_mutex_unlock(&slave.lock);
}

/* It is switched off and on while it sparks, and the link is cut by that.  What
 * it has lost is not given back to it in secret: until the sparks are off it
 * has nothing. */
static void restarts_and_has_nothing_until_it_is_known(const char *more)
{
	shop_open_with(&shop, 1, more);
	for (int i = 0; i < TURNS_MOST && !shop.sparks; i++)
		turn(&shop);
	restart();
	for (int i = 0; i < TURNS_MOST / 10 && !shop.r.in.generator.trouble;
	     i++) {
		shop.axes.read(shop.axes.self, &shop.r.in);
		assert_int_equal(slave.map->tab_registers[0], 0);
		usleep(TURN_US);
	}
	assert_true(shop.r.in.generator.trouble);
	step(&shop.r, SPARKING_V);
	assert_false(shop.r.out.power);
	/* An operator looks at it, and it has all of it again. */
	for (int i = 0; i < TURNS_MOST && shop.r.c.fault.latched; i++) {
		tell(&shop.r, CYCLE_RESET);
		turn(&shop);
	}
	for (int i = 0; i < 50; i++)
		turn(&shop);
	assert_int_equal(tell(&shop.r, CYCLE_START), ANSWER_DONE);
	shop.sparks = 0;
	for (int i = 0; i < TURNS_MOST && !shop.sparks; i++)
		turn(&shop);
	assert_true(shop.sparks > 0);
}

static void what_it_lost_behind_a_cut_link_ends_the_sparks(void **state)
{
	(void)state;
	restarts_and_has_nothing_until_it_is_known("");
}

static void what_it_does_not_tell_may_be_lost_behind_a_cut_link(void **state)
{
	(void)state;
	restarts_and_has_nothing_until_it_is_known(
		"told_peak_a = none\ntold_on_us = none\ntold_off_us = none\n"
		"told_ignition_v = none\ntold_polarity = none\n");
}

/* It may be slow, or on a bad line: it has all of it, and is asked again. */
static void a_link_that_is_cut_is_no_fault_by_itself(void **state)
{
	(void)state;
	shop_open(&shop, 1);
	for (int i = 0; i < TURNS_MOST && !shop.sparks; i++)
		turn(&shop);
	for (int n = 0; n < 5; n++) {
		const uint32_t asked = slave.asked;

		shutdown(modbus_get_socket(slave.link), SHUT_RDWR);
		for (int i = 0; i < TURNS_MOST && slave.asked < asked + 4; i++)
			usleep(TURN_US);
		turn(&shop);
		turn(&shop);
	}
	assert_false(shop.r.in.generator.trouble);
	assert_true(shop.r.out.power);
}

static void one_without_function_6_is_written_by_16(void **state)
{
	(void)state;
	shop_open(&shop, 3);
	slave.no_6 = true;
	for (int i = 0; i < TURNS_MOST && shop.r.c.loaded; i++)
		turn(&shop);
	assert_int_equal(shop.r.c.outcome, OUTCOME_DONE);
}

static void what_one_without_function_6_refuses_is_told_as_it_is(void **state)
{
	char text[160];

	(void)state;
	shop_open(&shop, 3);
	slave.no_6 = true;
	slave.refuses = 1;
	until_fault(&shop);
	assert_true(shop.axes.note(shop.axes.self, text, sizeof(text)));
	assert_non_null(strstr(text, "refuses on_us: asked 8, answered "
			       "exception 3, no such value"));
}

/* Exception 5: it has accepted what was written, and needs time for it. */
static void what_it_acknowledges_is_not_written_again(void **state)
{
	uint32_t written;

	(void)state;
	shop_open(&shop, 1);
	slave.needs_time = true;
	for (int i = 0; i < TURNS_MOST && !shop.sparks; i++)
		turn(&shop);
	assert_true(shop.sparks > 0);
	written = slave.written;
	slave.asked = 0;
	for (int i = 0; i < TURNS_MOST && slave.asked < 20; i++)
		usleep(TURN_US);
	assert_int_equal(slave.written, written);
}

/* -- Values that are asked for one behind the other ------------------------ */

static void ask_peak(double a)
{
	shop.r.out.pulse[INTERP_TECH_PEAK_A] = a;
	shop.r.out.asked++;
}

static bool is_in_force(void)
{
	return shop.r.in.generator.in_force == shop.r.out.asked;
}

static uint16_t peak_register(void)
{
	uint16_t x;

	pthread_mutex_lock(&slave.lock);
	x = slave.map->tab_registers[0];
	pthread_mutex_unlock(&slave.lock);
	return x;
}

static void until_peak_is(uint16_t tenths)
{
	for (int i = 0; i < TURNS_MOST && peak_register() != tenths; i++)
		usleep(TURN_US);
	assert_int_equal(peak_register(), tenths);
}

static void period(void)
{
	shop.axes.read(shop.axes.self, &shop.r.in);
	shop.axes.write(shop.axes.self, &shop.r.out);
}

/* It tells what it has, and has a value some time after it was written.  So it
 * tells 6 A while 11 A is on its way, and still when 6 A is asked for anew. */
static void settle_ms_is_from_when_it_was_taken(void **state)
{
	const int settle = 200;		/* periods */
	struct generator *g;
	int n = 0;

	(void)state;
	shop_open_with(&shop, 1, "told_peak_a = input 0 scale 0.1\n"
		       "settle_ms = 200\n");
	slave.map->tab_input_registers[0] = 60;
	shop.r.out = (struct io_outputs) { .power = false };
	io_pulse_own(&shop.r.out);
	ask_peak(6);
	for (int i = 0; i < TURNS_MOST && !is_in_force(); i++, usleep(TURN_US))
		period();
	assert_true(is_in_force());
	ask_peak(11);
	period();
	until_peak_is(110);
	ask_peak(6);
	/* All periods of settle_ms pass while it waits for the slave. */
	pthread_mutex_lock(&slave.lock);
	for (int i = 0; i < 2 * settle; i++)
		period();
	pthread_mutex_unlock(&slave.lock);
	g = shop.axes.self;
	for (int i = 0; i < TURNS_MOST && g->taken_version != g->asked; i++) {
		assert_false(is_in_force());
		usleep(TURN_US);
		period();
	}
	for (; n < TURNS_MOST && !is_in_force(); n++)
		period();
	assert_in_range(n, settle - 1, settle + 1);
}

static double told_peak_a(void)
{
	return shop.r.in.generator.told[INTERP_TECH_PEAK_A];
}

static void until_in_force(void)
{
	for (int i = 0; i < TURNS_MOST && !is_in_force(); i++, usleep(TURN_US))
		period();
	assert_true(is_in_force());
}

/* Between two jobs, and its register has what the next one asks for. */
static void what_a_person_set_at_its_panel_is_set_anew(void **state)
{
	(void)state;
	shop_open_with(&shop, 1, "told_peak_a = input 0 scale 0.1\n");
	slave.does = true;
	shop.r.out = (struct io_outputs) { .power = false };
	io_pulse_own(&shop.r.out);
	ask_peak(6);
	until_in_force();
	ask_peak((double)NAN);
	until_in_force();
	pthread_mutex_lock(&slave.lock);
	slave.map->tab_input_registers[0] = 70;
	pthread_mutex_unlock(&slave.lock);
	for (int i = 0; i < TURNS_MOST && told_peak_a() != 7; i++) {
		period();
		usleep(TURN_US);
	}
	ask_peak(6);
	until_in_force();
	assert_int_equal(slave.map->tab_input_registers[0], 60);
}

/* -- Counts ---------------------------------------------------------------- */

#define STALE	100			/* periods */

static void counts_open(void)
{
	struct generator *g;

	shop_open_with(&shop, 1,
		       "told_opens = input 0 bits 32\n"
		       "told_sparks = input 2 bits 32 first low\n"
		       "told_arcs = input 4 bits 32\n"
		       "told_shorts = input 6 bits 32\n");
	g = shop.axes.self;
	shop.c.gap.source = GAP_COUNTS;
	generator_counts_init(g, &shop.c, STALE);
	shop.r.out = (struct io_outputs) { .power = true };
	io_pulse_own(&shop.r.out);
	shop.axes.write(shop.axes.self, &shop.r.out);
}

static void count(const uint32_t sum[GENERATOR_NCOUNTS])
{
	uint16_t *to = slave.map->tab_input_registers;

	pthread_mutex_lock(&slave.lock);
	for (int i = 0; i < GENERATOR_NCOUNTS; i++) {
		to[2 * i + (i == 1)] = (uint16_t)(sum[i] >> 16);
		to[2 * i + (i != 1)] = (uint16_t)sum[i];
	}
	pthread_mutex_unlock(&slave.lock);
}

/* Three requests are an exchange: one that has begun by now, a whole one, and
 * the begin of one more. */
static void hear_all(void)
{
	const uint32_t from = slave.asked;

	for (int i = 0; i < TURNS_MOST && slave.asked - from < 7; i++)
		usleep(TURN_US);
	assert_true(slave.asked - from >= 7);
	period();
}

/* Those since the last reading, as shares. */
static void reads(const uint32_t sum[GENERATOR_NCOUNTS], double open,
		  double spark, double arc, double shorted)
{
	const struct io_shares *s = &shop.r.in.shares;

	count(sum);
	hear_all();
	assert_true(shop.r.in.shares_valid && !shop.r.in.shares_due);
	assert_near((double)s->open, open, 1e-6);
	assert_near((double)s->spark, spark, 1e-6);
	assert_near((double)s->arc, arc, 1e-6);
	assert_near((double)s->shorted, shorted, 1e-6);
}

static void counts_become_shares_over_the_ends_of_registers(void **st)
{
	const uint32_t top = UINT32_MAX - 99;

	(void)st;
	counts_open();
	count((uint32_t[]) { top, 0xffff, 0x1ffff, 7 });
	hear_all();
	assert_true(shop.r.in.shares_due && !shop.r.in.shares_valid);
	/* Over a register's end, and over that of both. */
	reads((uint32_t[]) { top + 200, 0xffff + 400, 0x1ffff + 300, 107 },
	      0.2, 0.4, 0.3, 0.1);
	/* Nothing more is counted: the last reading, and older. */
	hear_all();
	assert_true(shop.r.in.shares_valid && shop.r.in.shares_old);
	/* They jump back: one telling is none, the next one is a reading. */
	count((uint32_t[]) { 0, 0, 0, 0 });
	hear_all();
	assert_near((double)shop.r.in.shares.spark, 0.4, 1e-6);
	reads((uint32_t[]) { 0, 500, 0, 500 }, 0, 0.5, 0, 0.5);
	/* As late as an answer may be. */
	slave.late_us = 20000;
	reads((uint32_t[]) { 1000, 500, 0, 500 }, 1, 0, 0, 0);
}

static void counts_that_stand_or_are_silent_are_none(void **state)
{
	char text[160];

	(void)state;
	for (int silent = 0; silent < 2; silent++) {
		if (silent)
			shop_close(state);
		counts_open();
		count((uint32_t[]) { 0, 0, 0, 0 });
		hear_all();
		hear_all();
		reads((uint32_t[]) { 0, 100, 0, 100 }, 0, 0.5, 0, 0.5);
		if (silent)
			pthread_mutex_lock(&slave.lock);
		/* All that it has told before is there. */
		for (int i = 0; silent && i < TURNS_MOST && !slave.waits; i++)
			usleep(TURN_US);
		for (int i = 0; i <= STALE; i++) {
			if (silent)
				period();
			else
				hear_all();
		}
		if (silent)
			pthread_mutex_unlock(&slave.lock);
		assert_false(shop.r.in.shares_valid || shop.r.in.shares_due);
		assert_true(shop.axes.note(shop.axes.self, text, sizeof(text)));
		assert_non_null(strstr(text, silent ? "does not tell its opens"
						    : "stand still or jump"));
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		WITH_SHOP(c200_reaches_it_whole_before_the_first_spark),
		WITH_SHOP(what_it_does_not_tell_has_settle_ms),
		WITH_SHOP(no_spark_has_another_condition_however_late_it_is),
		WITH_SHOP(what_a_person_set_meanwhile_is_set_anew),
		WITH_SHOP(what_it_loses_between_jobs_is_no_fault),
		WITH_SHOP(what_it_refuses_never_sparks_and_is_a_fault),
		WITH_SHOP(one_that_loses_its_values_ends_the_sparks),
		WITH_SHOP(what_it_lost_behind_a_cut_link_ends_the_sparks),
		WITH_SHOP(what_it_does_not_tell_may_be_lost_behind_a_cut_link),
		WITH_SHOP(a_link_that_is_cut_is_no_fault_by_itself),
		WITH_SHOP(one_without_function_6_is_written_by_16),
		WITH_SHOP(what_it_acknowledges_is_not_written_again),
		WITH_SHOP(settle_ms_is_from_when_it_was_taken),
		WITH_SHOP(what_a_person_set_at_its_panel_is_set_anew),
		WITH_SHOP(what_one_without_function_6_refuses_is_told_as_it_is),
		WITH_SHOP(counts_become_shares_over_the_ends_of_registers),
		WITH_SHOP(counts_that_stand_or_are_silent_are_none),
	};

	return cmocka_run_group_tests_name("io/generator_modbus", tests,
					   make_file, remove_file);
}
