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
#define TURN_US		200		/* of wall time, for a period */
#define TURNS_MOST	200000

/* A slave of libmodbus' own server, in a thread. */
struct slave {
	modbus_t *link;
	int listens, port;
	_Atomic int served;		/* -1: nobody is there */
	modbus_mapping_t *map;
	pthread_t thread;
	_Atomic bool quit;
	_Atomic int late_us, refuses;	/* refuses: a register, or -1 */
	_Atomic uint32_t asked;
};

static void answer(struct slave *s, const uint8_t *ask, int n)
{
	const int at = modbus_get_header_length(s->link);
	const int first = ask[at + 1] << 8 | ask[at + 2];
	const int count = ask[at] == 6 ? 1 : ask[at + 3] << 8 | ask[at + 4];
	const int no = atomic_load(&s->refuses);

	s->asked++;
	usleep((useconds_t)atomic_load(&s->late_us));
	if ((ask[at] == 6 || ask[at] == 16) && no >= first &&
	    no < first + count)
		modbus_reply_exception(s->link, ask,
				       MODBUS_EXCEPTION_ILLEGAL_DATA_VALUE);
	else
		modbus_reply(s->link, ask, n, s->map);
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

	*s = (struct slave) { .refuses = -1 };
	s->map = modbus_mapping_new(0, 0, NREGISTERS, 0);
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
	"polarity = register 5 bit 0\n";

static struct slave slave;

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

static void shop_open(struct shop *s, int cuts)
{
	shop_open_with(s, cuts, "");
}

static void shop_close(struct shop *s)
{
	rig_free(&s->r);
	s->axes.close(s->axes.self);
	slave_end(&slave);
}

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
	struct shop s;

	(void)state;
	shop_open(&s, 1);
	for (int i = 0; i < TURNS_MOST && !s.sparks; i++)
		turn(&s);
	assert_int_equal(slave.map->tab_registers[0], 60);
	assert_int_equal(slave.map->tab_registers[1], 80);
	assert_int_equal(slave.map->tab_registers[2], 200);
	assert_int_equal(slave.map->tab_registers[3], 180);
	assert_true(s.waits > 0);
	shop_close(&s);
}

/* It tells the others.  It has its voltage so long after it has taken it. */
static void what_it_does_not_tell_has_settle_ms(void **state)
{
	struct shop s;
	int64_t from_ns;

	(void)state;
	shop_open_with(&s, 1, "told_ignition_v = none\nsettle_ms = 200\n");
	from_ns = clock_ns(CLOCK_MONOTONIC);
	for (int i = 0; i < TURNS_MOST && !s.sparks; i++)
		turn(&s);
	assert_true(s.sparks > 0);
	assert_true(clock_ns(CLOCK_MONOTONIC) - from_ns >= 200 * 1000000);
	shop_close(&s);
}

static void no_spark_has_another_condition_however_late_it_is(void **state)
{
	uint64_t seed = seed_take();
	struct shop s;

	(void)state;
	shop_open(&s, 30);
	for (int i = 0; i < TURNS_MOST && s.r.c.loaded; i++) {
		if (rnd(&seed) % 50 == 0)
			slave.late_us = (int)(rnd(&seed) % 8000);
		turn(&s);
	}
	assert_int_equal(s.r.c.outcome, OUTCOME_DONE);
	assert_true(s.sparks > 1000 && s.waits > 30);
	shop_close(&s);
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
	struct shop s;

	(void)state;
	shop_open(&s, 3);
	slave.refuses = 2;
	until_fault(&s);
	assert_int_equal(s.sparks, 0);
	/* Once it takes it, an operator goes on. */
	slave.refuses = -1;
	s.r.in.generator.trouble = false;
	assert_int_equal(tell(&s.r, CYCLE_RESET), ANSWER_DONE);
	for (int i = 0; i < 50; i++)
		turn(&s);
	assert_int_equal(tell(&s.r, CYCLE_START), ANSWER_DONE);
	for (int i = 0; i < TURNS_MOST && !s.sparks; i++)
		turn(&s);
	assert_true(s.sparks > 0);
	shop_close(&s);
}

static void one_that_loses_its_values_ends_the_sparks(void **state)
{
	struct shop s;

	(void)state;
	shop_open(&s, 1);
	for (int i = 0; i < TURNS_MOST && !s.sparks; i++)
		turn(&s);
	slave.map->tab_registers[0] = 0;
	/* What it tells is the evidence. */
	for (int i = 0; i < TURNS_MOST && !s.r.in.generator.trouble; i++) {
		s.axes.read(s.axes.self, &s.r.in);
		usleep(TURN_US);
	}
	step(&s.r, SPARKING_V);
	assert_false(s.r.out.power);
	assert_int_equal(s.r.c.fault.first, FAULT_GENERATOR);
	shop_close(&s);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(c200_reaches_it_whole_before_the_first_spark),
		cmocka_unit_test(what_it_does_not_tell_has_settle_ms),
		cmocka_unit_test(no_spark_has_another_condition_however_late_it_is),
		cmocka_unit_test(what_it_refuses_never_sparks_and_is_a_fault),
		cmocka_unit_test(one_that_loses_its_values_ends_the_sparks),
	};

	return cmocka_run_group_tests_name("io/generator_modbus", tests,
					   make_file, remove_file);
}
