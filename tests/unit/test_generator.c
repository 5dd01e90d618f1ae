/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_generator.c - what is asked for as frames, what is told, and what of a
 * condition reaches the generator
 */
#include "generator_frames.h"

#include <errno.h>
#include <math.h>

/* 8 us, 20 us, 6 A, servo 15 V, 180 V of the published experiment. */
static void a_condition_reaches_it_whole(void **state)
{
	struct rig r;

	(void)state;
	make(&r, "");
	ask(&r, 6);
	r.out.pulse[INTERP_TECH_ON_US] = 8;
	r.out.pulse[INTERP_TECH_OFF_US] = 20;
	r.out.pulse[INTERP_TECH_IGNITION_V] = 180;
	r.out.pulse[INTERP_TECH_SERVO_V] = 15;
	r.out.pulse[INTERP_TECH_POLARITY] = -1;
	r.out.power = r.out.pump = true;
	period(&r);
	assert_int_equal(r.usual.can_dlc, 8);
	assert_int_equal(r.usual.data[0], 7);
	assert_int_equal(can_get(r.usual.data + 2, 2), 60);
	assert_int_equal(can_get(r.usual.data + 4, 2), 80);
	assert_int_equal(can_get(r.usual.data + 6, 2), 200);
	assert_int_equal(r.own.can_dlc, 4);
	assert_int_equal(can_get(r.own.data, 2), 720);
	assert_int_equal(can_get(r.own.data + 2, 2), 150);
	r.out.pulse[INTERP_TECH_ISO] = 1;
	r.out.sense = true;
	r.out.pulse[INTERP_TECH_IGNITION_V] = NAN;
	r.out.pulse[INTERP_TECH_OFF_US] = NAN;
	period(&r);
	assert_int_equal(can_get(r.own.data, 2), 0xcfff);
	assert_int_equal(can_get(r.usual.data + 6, 2), 0xffff);
	frames_close(&r);
}

static void what_changes_is_sent_at_once_and_all_of_it_again(void **state)
{
	struct rig r;
	uint8_t count;

	(void)state;
	make(&r, "");
	period(&r);
	assert_int_equal(r.frames, 2);
	count = r.usual.data[1];
	r.out.power = true;
	period(&r);
	assert_int_equal(r.frames, 3);
	assert_int_equal(r.usual.data[0], 1);
	for (int i = 0; i < 20; i++)
		period(&r);
	assert_in_range(r.frames, 3 + 18, 3 + 20);
	assert_in_range((uint8_t)(r.usual.data[1] - count), 10, 12);
	frames_close(&r);
}

/* Its sparks may be a line's. */
static void what_the_queue_does_not_take_is_not_in_force(void **state)
{
	const struct can_frame f = { 0 };
	struct generator *g;
	struct rig r;

	(void)state;
	make(&r, "settle_ms = 5\n");
	g = r.m.self;
	ask(&r, 6);
	for (int i = 0; i < 10; i++)
		period(&r);
	assert_int_equal(r.in.generator.in_force, r.out.asked);
	while (write(g->fd, &f, sizeof(f)) > 0)
		;
	ask(&r, 12);
	for (int i = 0; i < 25; i++) {
		r.m.write(r.m.self, &r.out);
		r.m.read(r.m.self, &r.in);
		assert_int_not_equal(r.in.generator.in_force, r.out.asked);
		assert_int_equal(r.in.generator.trouble, i >= 20);
	}
	take_frames(&r);
	for (int i = 0; i < 10; i++) {
		period(&r);
		assert_int_equal(r.in.generator.in_force == r.out.asked,
				 i >= 5);
	}
	assert_int_equal(can_get(r.usual.data + 2, 2), 120);
	assert_false(r.in.generator.trouble);
	frames_close(&r);
}

static void what_it_tells_is_in_force_when_it_agrees(void **state)
{
	struct rig r;

	(void)state;
	make(&r, frames_tells);
	ask(&r, 6);
	for (int i = 0; i < 10; i++) {
		tell(&r, 8, false);
		period(&r);
		assert_int_not_equal(r.in.generator.in_force, r.out.asked);
	}
	tell(&r, 12, false);
	period(&r);
	assert_int_equal(r.in.generator.in_force, r.out.asked);
	assert_false(r.in.generator.trouble);
	frames_close(&r);
}

static void one_that_lies_is_trouble_in_its_period(void **state)
{
	struct rig r;

	(void)state;
	make(&r, frames_tells);
	ask(&r, 6);
	r.out.power = true;
	period(&r);
	tell(&r, 12, false);
	period(&r);
	assert_int_equal(r.usual.data[0], 1);
	tell(&r, 24, false);
	period(&r);
	assert_true(r.in.generator.trouble);
	assert_int_equal(r.usual.data[0], 0);
	assert_true(log_has(&r, "peak_a was in force and is no more: asked 6, "
				"told 12"));
	tell(&r, 12, false);
	period(&r);
	assert_true(r.in.generator.trouble);
	r.out.reset = true;
	tell(&r, 12, false);
	period(&r);
	tell(&r, 12, false);
	period(&r);
	assert_false(r.in.generator.trouble);
	frames_close(&r);
}

/* The off time alone is on its way then. */
static void what_it_loses_in_a_step_against_arcs_is_seen_at_once(void **state)
{
	struct rig r;

	(void)state;
	make(&r, "told_peak_a = can 1011 byte 0 bits 8 scale 0.5\n"
		 "told_off_us = can 1011 byte 1 bits 8\n");
	ask(&r, 6);
	r.out.pulse[INTERP_TECH_OFF_US] = 0;
	period(&r);
	tell(&r, 12, false);
	period(&r);
	r.out.power = true;
	period(&r);
	r.out.asked++;
	r.out.pulse[INTERP_TECH_OFF_US] = 40;
	period(&r);
	tell(&r, 12, false);
	period(&r);
	assert_false(r.in.generator.trouble);
	tell(&r, 24, false);
	period(&r);
	assert_true(r.in.generator.trouble);
	assert_int_equal(r.usual.data[0], 0);
	assert_true(log_has(&r, "peak_a was in force and is no more: asked 6, "
				"told 12"));
	frames_close(&r);
}

/* The place needs what was asked before the step. */
static void after_a_reset_it_has_nothing_until_it_tells_it(void **state)
{
	struct rig r;
	uint32_t needed;

	(void)state;
	make(&r, "told_peak_a = can 1011 byte 0 bits 8 scale 0.5\n");
	ask(&r, 6);
	needed = r.out.asked;
	period(&r);
	tell(&r, 12, false);
	period(&r);
	assert_int_equal(r.in.generator.in_force, needed);
	r.out.power = true;
	r.out.asked += 3;
	for (int i = 0; i < 2; i++) {
		tell(&r, 24, false);
		period(&r);
	}
	assert_true(r.in.generator.trouble);
	r.out.power = false;
	r.out.asked++;			/* the step ends with the sparks */
	r.out.reset = true;
	for (int i = 0; i < 10; i++) {
		tell(&r, 24, false);
		period(&r);
		assert_true((int32_t)(r.in.generator.in_force - needed) < 0);
	}
	for (int i = 0; i < 20; i++) {
		tell(&r, 12, false);
		period(&r);
	}
	assert_int_equal(r.in.generator.in_force, r.out.asked);
	frames_close(&r);
}

static int periods_until_in_force(struct rig *r, uint8_t halves)
{
	int n = 0;

	do {
		tell(r, halves, false);
		period(r);
	} while (r->in.generator.in_force != r->out.asked && n++ < 100);
	return n;
}

/* It tells its peak current, and neither on time nor voltage. */
static void what_it_does_not_tell_has_settle_ms(void **state)
{
	struct rig r;

	(void)state;
	make(&r, "told_peak_a = can 1011 byte 0 bits 8 scale 0.5\n"
		 "settle_ms = 30\n");
	ask(&r, 6);
	r.out.pulse[INTERP_TECH_ON_US] = 8;
	assert_int_equal(periods_until_in_force(&r, 12), 30);
	ask(&r, 9);
	period(&r);
	assert_int_equal(periods_until_in_force(&r, 18), 0);
	ask(&r, 6);
	r.out.pulse[INTERP_TECH_IGNITION_V] = 180;
	assert_int_equal(periods_until_in_force(&r, 12), 30);
	assert_false(r.in.generator.trouble);
	frames_close(&r);
}

static void one_that_refuses_is_trouble_in_confirm_s(void **state)
{
	struct rig r;
	int n = 0;

	(void)state;
	make(&r, frames_tells);
	tell(&r, 12, false);
	period(&r);
	ask(&r, 9);
	while (!r.in.generator.trouble && n++ < 100) {
		tell(&r, 12, false);
		period(&r);
	}
	assert_in_range(n, 50, 53);
	assert_true(log_has(&r, "peak_a is not in force in confirm_s: asked 9, "
				"told 6"));
	frames_close(&r);
}

static void one_that_is_silent_is_trouble_in_silent_ms(void **state)
{
	struct rig r;
	int n = 0;

	(void)state;
	make(&r, frames_tells);
	ask(&r, 6);
	period(&r);
	tell(&r, 12, false);
	period(&r);
	while (!r.in.generator.trouble && n++ < 100)
		period(&r);
	assert_in_range(n, 19, 22);
	assert_true(log_has(&r, "it does not tell its peak_a any more"));
	frames_close(&r);
}

/* It comes back with its own settings, another polarity among them. */
static void one_that_restarts_is_trouble(void **state)
{
	struct rig r;

	(void)state;
	make(&r, frames_tells);
	ask(&r, 6);
	r.out.pulse[INTERP_TECH_POLARITY] = -1;
	period(&r);
	tell(&r, 12, true);
	period(&r);
	assert_false(r.in.generator.trouble);
	tell(&r, 12, false);
	period(&r);
	assert_true(r.in.generator.trouble);
	assert_true(log_has(&r, "polarity was in force and is no more: asked "
				"-1, told 1"));
	frames_close(&r);
}

static void what_is_asked_anew_is_judged_anew(void **state)
{
	struct rig r;

	(void)state;
	make(&r, frames_tells);
	ask(&r, 6);
	period(&r);
	tell(&r, 12, false);
	period(&r);
	tell(&r, 24, false);
	period(&r);
	assert_true(r.in.generator.trouble);
	assert_int_equal(r.in.generator.tells, 1u << INTERP_TECH_PEAK_A |
			 1u << INTERP_TECH_POLARITY);
	assert_true(r.in.generator.told[INTERP_TECH_PEAK_A] == 12);
	ask(&r, 12);
	assert_in_range(periods_until_in_force(&r, 24), 20, 21);
	assert_false(r.in.generator.trouble);
	frames_close(&r);
}

static void tell_sums(struct rig *r, uint16_t sparks, uint16_t mj,
		      uint8_t fault)
{
	struct can_frame f = { .can_id = 1012, .can_dlc = 5 };

	can_put(f.data, sparks, 2);
	can_put(f.data + 2, mj, 2);
	f.data[4] = fault;
	assert_int_equal(write(r->fd, &f, sizeof(f)), sizeof(f));
	period(r);
}

static const char sums[] =
	"told_sparks = can 1012 byte 0 bits 16\n"
	"told_energy_j = can 1012 byte 2 bits 16 scale 0.001\n"
	"told_fault = can 1012 byte 4 bits 8\n"
	"fault_words = 1 no water, 3 much too warm\n";

/* Over the last bit, and anew at 0 when it was switched off. */
static void sums_run_on_and_only_up(void **state)
{
	struct rig r;
	const struct io_generator *says = &r.in.generator;

	(void)state;
	make(&r, sums);
	period(&r);
	assert_true(isnan(says->told[PROCESS_SPARKS]));
	assert_false(r.in.energy_valid);
	tell_sums(&r, 65000, 100, 0);
	assert_true(says->told[PROCESS_SPARKS] == 0);
	tell_sums(&r, 464, 100, 0);
	assert_true(says->told[PROCESS_SPARKS] == 1000);
	tell_sums(&r, 50000, 100, 0);
	assert_true(says->told[PROCESS_SPARKS] == 1000);
	tell_sums(&r, 50010, 100, 0);
	assert_true(says->told[PROCESS_SPARKS] == 1010);
	assert_true(isnan(says->told[PROCESS_ARCS]));
	frames_close(&r);
}

/* What comes in the dark is of the sparks before it: none of it is lost. */
static void energy_is_handed_on_with_the_sparks(void **state)
{
	struct rig r;
	double sum_j = 0;

	(void)state;
	make(&r, sums);
	tell_sums(&r, 0, 100, 0);
	for (int i = 0; i < 8; i++) {
		r.out.power = i % 3 != 0;
		tell_sums(&r, 0, (uint16_t)(110 + 10 * i), 0);
		assert_true(r.in.energy_valid);
		sum_j += r.in.energy_j;
	}
	period(&r);
	assert_true(fabs(sum_j + r.in.energy_j - 0.08) < 1e-9);
	assert_true(fabs(r.in.generator.told[PROCESS_ENERGY_J] - 0.08) < 1e-9);
	frames_close(&r);
}

/* It may tell what it had before it was asked for the one on its way. */
static void one_that_comes_back_to_what_it_tells_has_settle_ms(void **state)
{
	struct rig r;

	(void)state;
	make(&r, frames_tells);
	ask(&r, 6);
	period(&r);
	assert_int_equal(periods_until_in_force(&r, 12), 0);
	ask(&r, 9);
	period(&r);
	ask(&r, 6);
	period(&r);
	assert_in_range(periods_until_in_force(&r, 12), 19, 20);
	frames_close(&r);
}

static void its_own_fault_is_trouble_until_it_is_gone_and_reset(void **state)
{
	struct rig r;

	(void)state;
	make(&r, sums);
	tell_sums(&r, 0, 0, 0);
	assert_false(r.in.generator.trouble);
	tell_sums(&r, 0, 0, 3);
	assert_true(r.in.generator.trouble);
	assert_true(log_has(&r, "generator: its own fault 3 much too warm"));
	r.out.reset = true;
	tell_sums(&r, 0, 0, 3);
	tell_sums(&r, 0, 0, 2);
	assert_true(r.in.generator.trouble);
	assert_true(log_has(&r, "generator: its own fault 2"));
	tell_sums(&r, 0, 0, 0);
	assert_true(r.in.generator.trouble);
	r.out.reset = true;
	period(&r);
	tell_sums(&r, 0, 0, 0);
	assert_false(r.in.generator.trouble);
	frames_close(&r);
}

/* -- What of a condition is delivered -------------------------------------- */

#define BY_LINES	"spark = 9\nwatchdog_by = its own\n" \
	"estop_by = its own\n[generator]\ninterface = lines\n"
#define BY_PLC	"spark = 9\nwatchdog_by = its own\nestop_by = its own\n" \
	"[plc]\ninterface = can1\n[generator]\ninterface = plc\n"
#define MODBUS	"spark = 9\nwatchdog_by = its own\nestop_by = its own\n" \
	"[generator]\ninterface = modbus\nmodbus = /dev/ttyS0\n" \
	"peak_a = register 1 bits 8 scale 0.1\n" \
	"on_us = register 2 codes 2 4 8 16\noff_us = register 3\n" \
	"ignition_v = register 4\npolarity = register 5 bit 3\n"

/* Each field with its value; "": it is taken. */
static const struct {
	const char *more;
	enum interp_tech_id field;
	double value;
	const char *found, *wanted;
} cells[] = {
	{ "", INTERP_TECH_PEAK_A, 6, "C1: peak_a 6 A does not reach",
	  "by_hand = peak_a" },
	{ "", INTERP_TECH_ON_US, 8, "on_us 8 us", "by_hand = on_us" },
	{ "", INTERP_TECH_OFF_US, 20, "off_us 20 us", "[generator] off_us" },
	{ "", INTERP_TECH_IGNITION_V, 180, "ignition_v 180 V", "" },
	{ "", INTERP_TECH_ISO, 1, "iso 1", "" },
	{ "", INTERP_TECH_POLARITY, -1, "polarity -1", "" },
	{ "", INTERP_TECH_POLARITY, 1, "", "" },
	{ "", INTERP_TECH_SERVO_V, 20, "", "" },
	{ "[generator]\nby_hand = peak_a\n", INTERP_TECH_PEAK_A, 6, "", "" },
	{ "[generator]\ninterface = can\ncan_id = 500\n",
	  INTERP_TECH_PEAK_A, 6, "", "" },
	{ "[generator]\ninterface = can\ncan_id = 500\n",
	  INTERP_TECH_POLARITY, -1, "", "" },
	{ "[generator]\ninterface = can\ncan_id = 500\n",
	  INTERP_TECH_OFF_US, 6553.4, "", "" },
	{ "[generator]\ninterface = can\ncan_id = 500\n",
	  INTERP_TECH_OFF_US, 6554, "C1: off_us 6554 us", "0.1 to 6553.4 us" },
	{ "[generator]\ninterface = can\ncan_id = 500\n",
	  INTERP_TECH_ON_US, 8, "", "" },
	{ "[generator]\ninterface = can\ncan_id = 500\n",
	  INTERP_TECH_IGNITION_V, 180, "ignition_v 180 V", "" },
	{ "[generator]\ninterface = can\ncan_id = 500\n"
	  "ignition_v = can 501 byte 0\n", INTERP_TECH_IGNITION_V, 180, "",
	  "" },
	{ "[generator]\ninterface = can\ncan_id = 500\n",
	  INTERP_TECH_ISO, 1, "iso 1", "[generator] iso" },
	{ "[generator]\ninterface = can\ncan_id = 500\n"
	  "iso = can 501 byte 2 bit 0\n", INTERP_TECH_ISO, 1, "", "" },
	{ "[generator]\ninterface = can\ncan_id = 500\n"
	  "ignition_v = dac dac1 voltage0 scale 30 to 10\n",
	  INTERP_TECH_IGNITION_V, 310, "ignition_v 310 V", "300 V" },
	{ BY_LINES
	  "peak_a = lines 20 21 26 weights 3 6 12\n",
	  INTERP_TECH_PEAK_A, 7, "", "" },
	{ BY_LINES
	  "peak_a = lines 20 21 26 weights 3 6 12\n",
	  INTERP_TECH_PEAK_A, 2, "peak_a 2 A", "3 6 9 12 15 18 21 A" },
	{ BY_LINES "on_us = lines 20 21 codes 2 4 8\n",
	  INTERP_TECH_ON_US, 20, "on_us 20 us", "2 4 8 us" },
	{ BY_LINES "polarity = line 20\n",
	  INTERP_TECH_POLARITY, -1, "", "" },
	{ BY_LINES "off_us = lines 20 21 codes 10 20 50\n",
	  INTERP_TECH_OFF_US, 20, "", "" },
	{ BY_LINES "ignition_v = lines 20 codes 90 180\n",
	  INTERP_TECH_IGNITION_V, 180, "", "" },
	{ BY_LINES "ignition_v = lines 20 codes 90 180\n",
	  INTERP_TECH_IGNITION_V, 250, "ignition_v 250 V", "90 180 V" },
	{ BY_LINES "servo_v = lines 20 21 codes 15 30 45\n",
	  INTERP_TECH_SERVO_V, 15, "", "" },
	{ BY_LINES "servo_v = lines 20 21 codes 15 30 45\n",
	  INTERP_TECH_SERVO_V, 50, "servo_v 50 V", "15 30 45 V" },
	{ BY_LINES "iso = line 20\n", INTERP_TECH_SERVO_V, 50, "", "" },
	{ BY_LINES "servo_v = dac dac1 voltage0 scale 10 to 5\n",
	  INTERP_TECH_SERVO_V, 51, "servo_v 51 V", "0.1 to 50 V" },
	{ "[generator]\ninterface = can\ncan_id = 500\n"
	  "servo_v = can 501 byte 0 scale 0.1\n", INTERP_TECH_SERVO_V, 15,
	  "", "" },
	{ "[generator]\nby_hand = servo_v\n", INTERP_TECH_SERVO_V, 15, "", "" },
	{ MODBUS "servo_v = register 6 bits 9 scale 0.1\n",
	  INTERP_TECH_SERVO_V, 15, "", "" },
	{ MODBUS "servo_v = register 6 bits 9 scale 0.1\n",
	  INTERP_TECH_SERVO_V, 60, "servo_v 60 V", "0.1 to 51.1 V" },
	{ BY_PLC "servo_v = plc\n", INTERP_TECH_SERVO_V, 15, "", "" },
	{ BY_LINES "iso = line 20\n", INTERP_TECH_ISO, 1, "", "" },
	{ BY_LINES "iso = line 20\n", INTERP_TECH_POLARITY, -1, "polarity -1",
	  "[generator] polarity" },
	{ MODBUS, INTERP_TECH_PEAK_A, 6, "", "" },
	{ MODBUS, INTERP_TECH_PEAK_A, 26, "peak_a 26 A", "0.1 to 25.5 A" },
	{ MODBUS, INTERP_TECH_ON_US, 8, "", "" },
	{ MODBUS, INTERP_TECH_ON_US, 40, "on_us 40 us", "2 4 8 16 us" },
	{ MODBUS, INTERP_TECH_OFF_US, 20, "", "" },
	/* What it cannot tell would never be in force. */
	{ MODBUS "told_off_us = input 9 bits 8\n", INTERP_TECH_OFF_US, 256,
	  "off_us 256 us", "1 to 255 us" },
	{ MODBUS "told_peak_a = input 9 codes 3 6 50\n", INTERP_TECH_PEAK_A, 7,
	  "peak_a 7 A", "3 6 A" },
	{ MODBUS "told_on_us = input 9 codes 2 4 9 16\n", INTERP_TECH_ON_US, 9,
	  "", "" },
	{ MODBUS "told_on_us = input 9 bits 3\n", INTERP_TECH_ON_US, 8,
	  "on_us 8 us", "2 4 us" },
	{ MODBUS, INTERP_TECH_IGNITION_V, 180, "", "" },
	{ MODBUS, INTERP_TECH_POLARITY, -1, "", "" },
	{ MODBUS, INTERP_TECH_ISO, 1, "iso 1", "[generator] iso" },
	{ MODBUS "iso = register 5 bit 4\n", INTERP_TECH_ISO, 1, "", "" },
	{ BY_PLC, INTERP_TECH_PEAK_A, 6, "", "" },
	{ BY_PLC, INTERP_TECH_ON_US, 8, "", "" },
	{ BY_PLC, INTERP_TECH_OFF_US, 20, "", "" },
	{ BY_PLC, INTERP_TECH_OFF_US, 6554, "off_us 6554 us",
	  "0.1 to 6553.4 us" },
	{ BY_PLC, INTERP_TECH_IGNITION_V, 180, "", "" },
	{ BY_PLC, INTERP_TECH_POLARITY, -1, "", "" },
	{ BY_PLC, INTERP_TECH_ISO, 1, "", "" },
	{ BY_PLC "iso = none\n", INTERP_TECH_ISO, 1, "iso 1",
	  "[generator] iso" },
};

static void each_field_reaches_it_or_is_refused(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof(cells) / sizeof(cells[0]); i++) {
		struct machine_config c;
		struct interp_diag d = { .line = 0 };
		struct interp_tech t;
		char text[1200];

		snprintf(text, sizeof(text), "%s%s", LINES_MACHINE,
			 cells[i].more);
		assert_int_equal(read_text(text, &c, &d), 0);
		interp_tech_clear(&t);
		t.v[cells[i].field] = cells[i].value;
		assert_int_equal(config_generator_takes(&c, &t, "C1", &d),
				 *cells[i].found ? -EINVAL : 0);
		assert_non_null(strstr(d.found, cells[i].found));
		assert_non_null(strstr(d.wanted, cells[i].wanted));
	}
}

static void lines_have_the_code_of_the_value(void **state)
{
	struct machine_config c;
	struct interp_diag d;
	struct config_way w;

	(void)state;
	assert_int_equal(read_text(LINES_MACHINE BY_LINES
		"peak_a = lines 20 !21 26 weights 3 6 12\n"
		"on_us = lines 22 23 codes 2 4 8 16\n", &c, &d), 0);
	config_way(&c, INTERP_TECH_PEAK_A, false, &w);
	assert_int_equal(generator_code(&w, 15), 5);
	assert_int_equal(generator_code(&w, NAN), 0);
	assert_true(w.line[1].inverted);
	config_way(&c, INTERP_TECH_ON_US, false, &w);
	assert_int_equal(generator_code(&w, 8), 2);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_condition_reaches_it_whole),
		cmocka_unit_test(what_changes_is_sent_at_once_and_all_of_it_again),
		cmocka_unit_test(what_the_queue_does_not_take_is_not_in_force),
		cmocka_unit_test(what_it_tells_is_in_force_when_it_agrees),
		cmocka_unit_test(one_that_lies_is_trouble_in_its_period),
		cmocka_unit_test(what_it_loses_in_a_step_against_arcs_is_seen_at_once),
		cmocka_unit_test(after_a_reset_it_has_nothing_until_it_tells_it),
		cmocka_unit_test(what_it_does_not_tell_has_settle_ms),
		cmocka_unit_test(one_that_refuses_is_trouble_in_confirm_s),
		cmocka_unit_test(one_that_is_silent_is_trouble_in_silent_ms),
		cmocka_unit_test(one_that_restarts_is_trouble),
		cmocka_unit_test(what_is_asked_anew_is_judged_anew),
		cmocka_unit_test(sums_run_on_and_only_up),
		cmocka_unit_test(energy_is_handed_on_with_the_sparks),
		cmocka_unit_test(one_that_comes_back_to_what_it_tells_has_settle_ms),
		cmocka_unit_test(its_own_fault_is_trouble_until_it_is_gone_and_reset),
		cmocka_unit_test(each_field_reaches_it_or_is_refused),
		cmocka_unit_test(lines_have_the_code_of_the_value),
	};

	return cmocka_run_group_tests_name("io/generator", tests, make_file,
					   remove_file);
}
