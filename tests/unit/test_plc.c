/* SPDX-License-Identifier: Apache-2.0 */
/*
 * What io/plc.h promises, frame by frame, without a socket.
 */
#include "plc.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define NODE		7
#define ALIVE_CYCLES	20
#define GOOD		(PLC_PERMIT | PLC_ALIVE)

static struct plc begun(void)
{
	struct can_msg out[PLC_EMITS];
	struct plc p;

	plc_init(&p, NODE);
	p.beat_cycles = 50;
	p.send_cycles = 10;
	p.alive_cycles = ALIVE_CYCLES;
	plc_emit(&p, out);
	return p;
}

static bool hear(struct plc *p, uint16_t id, uint8_t len, const uint8_t *data)
{
	struct can_msg m = { .id = id, .len = len };

	memcpy(m.data, data, 8);
	return plc_receive(p, &m);
}

static void nmt(struct plc *p, uint8_t what, uint8_t node)
{
	hear(p, CAN_NMT, 2, (const uint8_t[8]) { what, node });
}

/* The PLC's request: command, locks, override, program, M code done. */
static void request(struct plc *p, uint8_t command, uint8_t locks,
		    uint16_t override)
{
	hear(p, CAN_RPDO1 + NODE, 8, (const uint8_t[8]) {
		command, locks, (uint8_t)override, (uint8_t)(override >> 8)
	});
}

static struct plc working(void)
{
	struct plc p = begun();

	nmt(&p, 0x01, NODE);
	request(&p, GOOD, PLC_LOCKS, 1000);
	assert_true(plc_alive(&p));
	return p;
}

/* An SDO request and the first four and last four bytes of the answer. */
static uint32_t ask(struct plc *p, uint8_t first, uint32_t object,
		    uint32_t value, uint8_t *ret_first)
{
	uint8_t data[8] = { first, (uint8_t)(object >> 8),
			    (uint8_t)(object >> 16), (uint8_t)object };
	struct can_msg out[PLC_EMITS];

	can_put(data + 4, value, 4);
	assert_true(hear(p, CAN_SDO_ASK + NODE, 8, data));
	for (size_t i = 0, n = plc_emit(p, out); i < n; i++) {
		if (out[i].id != CAN_SDO_ANSWER + NODE)
			continue;
		assert_int_equal(out[i].len, 8);
		assert_memory_equal(out[i].data + 1, data + 1, 3);
		*ret_first = out[i].data[0];
		return can_get(out[i].data + 4, 4);
	}
	fail_msg("no answer to SDO %06x", object);
	return 0;
}

#define OBJECT(index, sub)	((uint32_t)(index) << 8 | (sub))

static void its_first_frame_is_the_boot_up_message(void **state)
{
	struct can_msg out[PLC_EMITS];
	struct plc p;

	(void)state;
	plc_init(&p, NODE);
	assert_int_equal(plc_emit(&p, out), 1);
	assert_int_equal(out[0].id, CAN_HEARTBEAT + NODE);
	assert_int_equal(out[0].len, 1);
	assert_int_equal(out[0].data[0], 0);
}

static void its_heartbeat_comes_in_time_and_says_the_nmt_state(void **state)
{
	struct plc p = begun();
	struct can_msg out[PLC_EMITS];
	int beats = 0;

	(void)state;
	for (int i = 0; i < 500; i++) {
		for (size_t k = 0, n = plc_emit(&p, out); k < n; k++) {
			if (out[k].id != CAN_HEARTBEAT + NODE)
				continue;
			beats++;
			assert_int_equal(out[k].data[0],
					 p.operational ? 0x05 : 0x7f);
		}
		if (i == 250)
			nmt(&p, 0x01, 0);
	}
	assert_in_range(beats, 9, 10);
}

static void nmt_of_another_node_is_not_obeyed(void **state)
{
	struct plc p = begun();

	(void)state;
	nmt(&p, 0x01, NODE + 1);
	assert_false(p.operational);
	nmt(&p, 0x01, 0);
	assert_true(p.operational);
	nmt(&p, 0x80, NODE + 1);
	assert_true(p.operational);
	nmt(&p, 0x80, NODE);
	assert_false(p.operational);
}

static void an_unknown_nmt_command_is_counted_and_changes_nothing(void **state)
{
	struct plc p = working();

	(void)state;
	nmt(&p, 0x33, NODE);
	assert_true(p.operational);
	assert_int_equal(p.refused, 1);
}

static void a_reset_takes_the_permit_and_boots_again(void **state)
{
	struct plc p = working();
	struct can_msg out[PLC_EMITS];

	(void)state;
	nmt(&p, 0x81, NODE);
	assert_int_equal(p.ask.command, 0);
	assert_int_equal(plc_emit(&p, out), 1);
	assert_int_equal(out[0].data[0], 0);
	/* Nobody is there who could say that there is a fire. */
	assert_false(plc_alive(&p));
}

static void a_stop_takes_the_permit_at_once(void **state)
{
	static const uint8_t stops[] = { 0x02, 0x80 };

	(void)state;
	for (size_t i = 0; i < sizeof(stops); i++) {
		struct plc p = working();

		nmt(&p, stops[i], NODE);
		plc_period(&p);
		assert_false(plc_alive(&p));
		assert_int_equal(p.ask.command & PLC_PERMIT, 0);
		nmt(&p, 0x01, NODE);
		plc_period(&p);
		assert_false(plc_alive(&p));
		request(&p, p.ask.command ^ (PLC_ALIVE | PLC_PERMIT), PLC_LOCKS,
			1000);
		assert_true(plc_alive(&p));
	}
}

static void one_that_is_stopped_only_beats(void **state)
{
	struct plc p = working();
	struct can_msg out[PLC_EMITS];

	(void)state;
	nmt(&p, 0x02, NODE);
	p.tell.fault = 7;
	plc_receive(&p, &(struct can_msg) { .id = CAN_SDO_ASK + NODE, .len = 8,
					    .data = { 0x40, 0x00, 0x10 } });
	for (int i = 0; i < 300; i++) {
		const size_t n = plc_emit(&p, out);

		for (size_t k = 0; k < n; k++) {
			assert_int_equal(out[k].id, CAN_HEARTBEAT + NODE);
			assert_int_equal(out[k].data[0], 0x04);
		}
	}
	nmt(&p, 0x80, NODE);
	assert_true(plc_emit(&p, out) >= 1);
}

/* A fault and its end, each once, and what 1001 and 1003 say of it. */
static void a_fault_is_an_emergency_and_in_the_history(void **state)
{
	struct plc p = working();
	struct can_msg out[PLC_EMITS];
	int emergencies = 0;
	uint8_t first;

	(void)state;
	assert_int_equal(ask(&p, 0x40, OBJECT(0x1014, 0), 0, &first),
			 CAN_EMCY + NODE);
	for (int i = 0; i < 100; i++) {
		const size_t n = plc_emit(&p, out);

		p.tell.fault = (uint8_t)(i < 20 ? 0 :
					 i < 50 ? 7 :
					 i < 70 ? 0 :
						  9);
		for (size_t k = 0; k < n; k++) {
			if (out[k].id != CAN_EMCY + NODE)
				continue;
			emergencies++;
			assert_int_equal(can_get(out[k].data, 2),
					 emergencies == 1 ? 0xff07 :
					 emergencies == 2 ? 0 : 0xff09);
			assert_int_equal(out[k].data[2], emergencies != 2);
		}
	}
	assert_int_equal(emergencies, 3);
	assert_int_equal(ask(&p, 0x40, OBJECT(0x1001, 0), 0, &first), 1);
	assert_int_equal(ask(&p, 0x40, OBJECT(0x1003, 0), 0, &first), 2);
	assert_int_equal(ask(&p, 0x40, OBJECT(0x1003, 1), 0, &first), 0xff09);
	assert_int_equal(ask(&p, 0x40, OBJECT(0x1003, 2), 0, &first), 0xff07);
	assert_int_equal(ask(&p, 0x40, OBJECT(0x1003, 3), 0, &first),
			 0x08000024);
	/* No value but 0, not even the one that it has. */
	for (uint32_t i = 1; i <= 3; i++)
		assert_int_equal(ask(&p, 0x2f, OBJECT(0x1003, 0), i, &first),
				 0x06090030);
	assert_int_equal(ask(&p, 0x40, OBJECT(0x1003, 0), 0, &first), 2);
	ask(&p, 0x2f, OBJECT(0x1003, 0), 0, &first);
	assert_int_equal(first, 0x60);
	assert_int_equal(ask(&p, 0x40, OBJECT(0x1003, 0), 0, &first), 0);
}

static int emergencies_in(struct plc *p, int periods, uint32_t *ret_code)
{
	struct can_msg out[PLC_EMITS];
	int n = 0;

	for (int i = 0; i < periods; i++) {
		const size_t frames = plc_emit(p, out);

		for (size_t k = 0; k < frames; k++) {
			if (out[k].id != CAN_EMCY + NODE)
				continue;
			n++;
			*ret_code = can_get(out[k].data, 2);
		}
	}
	return n;
}

static void after_a_reset_a_fault_that_stands_is_told_again(void **state)
{
	static const uint8_t resets[] = { 0x81, 0x82 };

	(void)state;
	for (size_t i = 0; i < sizeof(resets); i++) {
		struct plc p = working();
		uint32_t code = 0;
		uint8_t first;

		p.tell.fault = 7;
		assert_int_equal(emergencies_in(&p, 50, &code), 1);
		p.tell.fault = 9;
		assert_int_equal(emergencies_in(&p, 50, &code), 1);
		nmt(&p, resets[i], NODE);
		assert_int_equal(emergencies_in(&p, 50, &code), 1);
		assert_int_equal(code, 0xff09);
		assert_int_equal(ask(&p, 0x40, OBJECT(0x1003, 0), 0, &first),
				 1);
		p.tell.fault = 0;
		assert_int_equal(emergencies_in(&p, 50, &code), 1);
		assert_int_equal(code, 0);
		/* And one that is over is not told. */
		nmt(&p, resets[i], NODE);
		assert_int_equal(emergencies_in(&p, 50, &code), 0);
	}
}

/* Tools write all they know of a node. */
static void what_an_object_has_may_be_written(void **state)
{
	struct plc p = begun();
	uint8_t first;

	(void)state;
	for (size_t i = 0; i < plc_nconstants; i++) {
		const struct plc_constant *c = &plc_constant[i];
		const uint32_t object = OBJECT(c->index, c->sub);
		const uint8_t write = (uint8_t)(0x23 |
				      (4 - plc_bytes(c->type)) << 2);
		uint32_t value;

		if (c->live == PLC_ERROR || c->live == PLC_BEAT)
			continue;
		value = ask(&p, 0x40, object, 0, &first);
		ask(&p, write, object, value, &first);
		assert_int_equal(first, 0x60);
		ask(&p, write, object, value ^ 1, &first);
		assert_int_equal(first, 0x80);
	}
}

static void requests_count_when_operational_only(void **state)
{
	struct plc p = begun();

	(void)state;
	request(&p, GOOD, PLC_LOCKS, 1000);
	assert_int_equal(p.ask.command, 0);
	assert_false(plc_alive(&p));
	nmt(&p, 0x01, NODE);
	request(&p, GOOD, PLC_LOCKS, 1000);
	assert_int_equal(p.ask.command, GOOD);
	assert_true(plc_alive(&p));
}

static void frames_of_a_wrong_length_change_nothing(void **state)
{
	static const uint16_t ids[] = { CAN_NMT, CAN_RPDO1 + NODE,
					CAN_SDO_ASK + NODE };
	static const uint8_t right[] = { 2, 8, 8 };
	uint8_t data[8] = { 0x80, 0, 1 };
	struct plc p = working();
	const struct plc before = p;
	uint32_t n = 0;

	(void)state;
	for (size_t i = 0; i < 3; i++) {
		for (uint8_t len = 0; len <= 8; len++) {
			if (len == right[i])
				continue;
			assert_true(hear(&p, ids[i], len, data));
			assert_int_equal(p.malformed, ++n);
		}
	}
	p.malformed = 0;
	assert_memory_equal(&p, &before, sizeof(p));
}

static void frames_to_other_nodes_are_not_for_us(void **state)
{
	struct plc p = working();
	const struct plc before = p;
	const uint8_t data[8] = { 0 };

	(void)state;
	assert_false(hear(&p, CAN_RPDO1 + NODE + 1, 8, data));
	assert_false(hear(&p, CAN_SDO_ASK + NODE - 1, 8, data));
	assert_false(hear(&p, 0x7ff, 8, data));
	assert_memory_equal(&p, &before, sizeof(p));
}

static void another_device_of_our_node_is_counted(void **state)
{
	struct plc p = working();
	const uint8_t data[8] = { 0x05 };

	(void)state;
	assert_true(hear(&p, CAN_HEARTBEAT + NODE, 1, data));
	assert_true(hear(&p, CAN_TPDO1 + NODE, 8, data));
	assert_int_equal(p.twins, 2);
	assert_int_equal(p.ask.command, GOOD);
}

/* Half a request is none. */
static void a_request_with_a_value_out_of_range_is_dropped_whole(void **state)
{
	struct plc p = working();

	(void)state;
	request(&p, PLC_PERMIT, PLC_LOCKS, 2001);
	assert_int_equal(p.ask.command, GOOD);
	request(&p, PLC_PERMIT, PLC_LOCKS + 1, 500);
	assert_int_equal(p.ask.command, GOOD);
	assert_int_equal(p.ask.override, 1000);
	assert_int_equal(p.refused, 2);
	request(&p, PLC_PERMIT, PLC_LOCKS, 2000);
	assert_int_equal(p.ask.command, PLC_PERMIT);
	assert_int_equal(p.ask.override, 2000);
}

static void without_a_turn_of_its_toggle_the_plc_is_dead(void **state)
{
	struct plc p = working();

	(void)state;
	for (int i = 0; i < ALIVE_CYCLES; i++) {
		assert_true(plc_alive(&p));
		request(&p, GOOD, PLC_LOCKS, 1000);
		plc_period(&p);
	}
	plc_period(&p);
	assert_false(plc_alive(&p));
	assert_int_equal(p.ask.command & PLC_PERMIT, 0);

	request(&p, GOOD, PLC_LOCKS, 1000);
	assert_false(plc_alive(&p));
	request(&p, PLC_PERMIT, PLC_LOCKS, 1000);
	assert_true(plc_alive(&p));
	assert_int_equal(p.ask.command, PLC_PERMIT);
}

static void a_turn_in_time_keeps_it_alive(void **state)
{
	struct plc p = working();
	uint8_t toggle = 0;

	(void)state;
	for (int i = 0; i < 50 * ALIVE_CYCLES; i++) {
		plc_period(&p);
		assert_true(plc_alive(&p));
		if (i % ALIVE_CYCLES == 0) {
			request(&p, PLC_PERMIT | toggle, PLC_LOCKS, 1000);
			toggle ^= PLC_ALIVE;
		}
	}
}

/* Each TPDO once a round, one a period, and the toggle turns with each. */
static void tpdos_go_round_with_what_is_told(void **state)
{
	struct plc p = working();
	struct can_msg out[PLC_EMITS];
	int seen[6] = { 0 }, toggle = -1;

	(void)state;
	p.tell = (struct plc_tell) { .state = 4, .gap = 4321, .feed = -17,
				     .job = 9, .line = 77, .electrode = 3,
				     .condition = 120, .letter = 'C',
				     .pos = { -1, 2, -300000 } };
	for (int i = 0; i < 1000; i++) {
		int here = 0;

		for (size_t k = 0, n = plc_emit(&p, out); k < n; k++) {
			const struct can_msg *m = &out[k];

			if ((m->id & 0xff) != 0x80 + NODE &&
			    m->id != 0x500 + NODE)
				continue;
			here++;
			seen[m->id >> 8]++;
			assert_int_equal(m->len, 8);
			if (m->id == 0x500 + NODE) {
				assert_int_equal(can_get(m->data, 2), 3);
				assert_int_equal(can_get(m->data + 2, 2), 120);
				assert_int_equal(m->data[4], 'C');
			} else if (m->id == 0x180 + NODE) {
				assert_int_not_equal(m->data[1] & 1, toggle);
				toggle = m->data[1] & 1;
				assert_int_equal(m->data[0], 4);
				assert_int_equal(can_get(m->data + 4, 2), 4321);
				assert_int_equal(can_get(m->data + 6, 2),
						 0xffef);
			} else if (m->id == 0x280 + NODE) {
				assert_int_equal(can_get(m->data, 4), 9);
				assert_int_equal(can_get(m->data + 4, 4), 77);
			} else if (m->id == 0x480 + NODE) {
				assert_int_equal((int32_t)can_get(m->data, 4),
						 -300000);
			}
		}
		assert_true(here <= 2);
	}
	for (int i = 1; i <= 5; i++)
		assert_in_range(seen[i], 99, 101);
}

/* At 5 ms and cycle_ms = 20: none of them waits for the next round. */
static void a_round_takes_four_periods(void **state)
{
	struct plc p = working();
	struct can_msg out[PLC_EMITS];
	int seen = 0;

	(void)state;
	p.send_cycles = 4;
	for (int i = 0; i < 400; i++)
		for (size_t k = 0, n = plc_emit(&p, out); k < n; k++)
			seen += out[k].id == 0x180 + NODE;
	assert_in_range(seen, 97, 101);
}

/* A changer must not be told M6 with the electrode of the one before, whenever
 * in a round both change. */
static void an_m_code_is_told_behind_its_electrode(void **state)
{
	struct can_msg out[PLC_EMITS];

	(void)state;
	for (int at = 0; at < 30; at++) {
		struct plc p = working();
		uint32_t electrode = 99;
		bool told = false;

		for (int i = 0; i < 60; i++) {
			p.tell.electrode = i < at ? 2 : 3;
			p.tell.mcode = i < at ? 0 : 6;
			for (size_t k = 0, n = plc_emit(&p, out); k < n; k++) {
				if (out[k].id == 0x500 + NODE)
					electrode = can_get(out[k].data, 2);
				if (out[k].id != 0x180 + NODE ||
				    out[k].data[3] == 0)
					continue;
				assert_int_equal(out[k].data[3], 6);
				assert_int_equal(electrode, 3);
				told = true;
			}
		}
		assert_true(told);
	}
}

/* Values, then their number, and both in the period of the change. */
static void what_a_generator_is_asked_for_is_sent_at_once(void **state)
{
	struct can_msg out[PLC_EMITS];
	struct plc p = working();

	(void)state;
	p.sets = true;
	for (int i = 1; i < 100; i++) {
		uint32_t current = 0, number = 0;

		p.tell.pulse = (struct plc_pulse) {
			.number = (uint16_t)(i / 7 + 1), .bits = PLC_ASKED_ISO,
			.value = { (uint16_t)(i / 7 + 60) }
		};
		for (size_t k = 0, n = plc_emit(&p, out); k < n; k++) {
			if (out[k].id == 0x680 + NODE) {
				current = can_get(out[k].data, 2);
			} else if (out[k].id == 0x500 + NODE) {
				number = can_get(out[k].data + 5, 2);
				assert_int_equal(current, number + 59);
				assert_int_equal(out[k].data[7], 2);
			}
		}
		assert_true(i % 7 || number == p.tell.pulse.number);
	}
}

static void tpdos_are_sent_when_operational_only(void **state)
{
	struct plc p = begun();
	struct can_msg out[PLC_EMITS];

	(void)state;
	for (int i = 0; i < 100; i++) {
		for (size_t k = 0, n = plc_emit(&p, out); k < n; k++)
			assert_int_equal(out[k].id, CAN_HEARTBEAT + NODE);
	}
}

static void every_object_of_the_table_can_be_read(void **state)
{
	struct plc p = working();
	uint8_t first;

	(void)state;
	for (size_t i = 0; i < plc_nsignals; i++) {
		const struct plc_signal *s = &plc_signal[i];

		ask(&p, 0x40, OBJECT(s->index, s->sub), 0, &first);
		assert_int_equal(first, 0x43 | (4 - plc_bytes(s->type)) << 2);
	}
	for (size_t i = 0; i < plc_nconstants; i++) {
		const struct plc_constant *c = &plc_constant[i];

		if (c->live == PLC_ERROR)
			continue;
		assert_int_equal(ask(&p, 0x40, OBJECT(c->index, c->sub), 0,
				     &first),
				 c->value + (c->live == PLC_PLUS_NODE ||
					     c->live == PLC_EMCY ? NODE : 0));
		assert_int_equal(first, 0x43 | (4 - plc_bytes(c->type)) << 2);
	}
	p.tell.line = 123456;
	assert_int_equal(ask(&p, 0x40, OBJECT(0x2000, 8), 0, &first), 123456);
	assert_int_equal(p.refused, 0);
}

static int beats_in(struct plc *p, int cycles)
{
	struct can_msg out[PLC_EMITS];
	int n = 0;

	for (int i = 0; i < cycles; i++) {
		const size_t got = plc_emit(p, out);

		for (size_t k = 0; k < got; k++)
			n += out[k].id == CAN_HEARTBEAT + NODE;
	}
	return n;
}

static void the_plc_sets_the_time_of_the_heartbeat(void **state)
{
	struct plc p = working();
	uint8_t first;

	(void)state;
	p.cycles_per_ms = 0.5;
	ask(&p, 0x2b, OBJECT(0x1017, 0), 20, &first);
	assert_int_equal(first, 0x60);
	assert_int_equal(ask(&p, 0x40, OBJECT(0x1017, 0), 0, &first), 20);
	assert_in_range(beats_in(&p, 1000), 99, 101);
	ask(&p, 0x2b, OBJECT(0x1017, 0), 0, &first);
	assert_int_equal(beats_in(&p, 1000), 0);
	plc_receive(&p, &(struct can_msg) { CAN_NMT, 2, { 0x82, NODE } });
	assert_int_equal(ask(&p, 0x40, OBJECT(0x1017, 0), 0, &first), 100);
}

/* Bit 31 off and on again, and another id in between. */
static void the_plc_sets_the_id_of_emergencies(void **state)
{
	static const uint32_t writes[] = {
		0x80000000u | (CAN_EMCY + NODE), 0x80000000u | 0x85, 0x85
	};
	struct plc p = working();
	struct can_msg out[PLC_EMITS];
	size_t found = 0;
	uint8_t first;

	(void)state;
	for (size_t i = 0; i < 3; i++) {
		ask(&p, 0x23, OBJECT(0x1014, 0), writes[i], &first);
		assert_int_equal(first, 0x60);
		assert_int_equal(ask(&p, 0x40, OBJECT(0x1014, 0), 0, &first),
				 writes[i]);
		p.tell.fault = (uint8_t)(i + 1);
		for (size_t k = 0, n = plc_emit(&p, out); k < n; k++)
			found += out[k].id == 0x85;
		assert_int_equal(found, i == 2);
	}
}

static void requests_may_be_written_before_the_pdos_come(void **state)
{
	struct plc p = begun();
	uint8_t first;

	(void)state;
	ask(&p, 0x2b, OBJECT(0x2100, 3), 1500, &first);
	assert_int_equal(first, 0x60);
	assert_int_equal(p.ask.override, 1500);
	ask(&p, 0x22, OBJECT(0x2100, 3), 700, &first);	/* no size said */
	assert_int_equal(first, 0x60);
	assert_int_equal(p.ask.override, 700);
}

static void a_permit_by_sdo_is_no_permit(void **state)
{
	struct plc p = begun();
	uint8_t first;

	(void)state;
	ask(&p, 0x2f, OBJECT(0x2100, 1), GOOD, &first);
	for (int i = 0; i <= ALIVE_CYCLES; i++)
		plc_period(&p);
	assert_false(plc_alive(&p));
	assert_int_equal(p.ask.command & PLC_PERMIT, 0);
}

/* Each mistake with the code CiA 301 has for it. */
static void what_cannot_be_is_aborted_with_its_code(void **state)
{
	static const struct {
		uint8_t first;
		uint32_t object, value, code;
		bool operational;
	} asks[] = {
		{ 0x40, OBJECT(0x3000, 0), 0, 0x06020000, true },
		{ 0x40, OBJECT(0x2000, 16), 0, 0x06090011, true },
		{ 0x40, OBJECT(0x1018, 4), 0, 0x06090011, true },
		{ 0x2f, OBJECT(0x3000, 0), 1, 0x06020000, false },
		{ 0x2f, OBJECT(0x2100, 7), 1, 0x06090011, false },
		{ 0x2f, OBJECT(0x2000, 1), 1, 0x06010002, false },
		{ 0x23, OBJECT(0x1018, 2), 1, 0x06010002, false },
		{ 0x2f, OBJECT(0x1017, 0), 1, 0x06070010, false },
		{ 0x23, OBJECT(0x1014, 0), 0x80, 0x06090030, false },
		{ 0x23, OBJECT(0x1014, 0), 0x100, 0x06090030, false },
		{ 0x23, OBJECT(0x1014, 0), 0x81, 0x06090030, false },
		{ 0x23, OBJECT(0x1014, 0), 0x40000081, 0x06090030, false },
		{ 0x2f, OBJECT(0x2100, 3), 1, 0x06070010, false },
		{ 0x23, OBJECT(0x2100, 3), 1, 0x06070010, false },
		{ 0x21, OBJECT(0x2100, 3), 2, 0x06070010, false },
		{ 0x2b, OBJECT(0x2100, 3), 2001, 0x06090030, false },
		{ 0x2f, OBJECT(0x2100, 2), 32, 0x06090030, false },
		{ 0x2b, OBJECT(0x2100, 4), 10000, 0x06090030, false },
		{ 0x2b, OBJECT(0x2100, 3), 500, 0x08000022, true },
		{ 0x60, OBJECT(0x2000, 1), 0, 0x05040001, true },
		{ 0x00, OBJECT(0x2000, 1), 0, 0x05040001, true },
		{ 0xa0, OBJECT(0x2000, 1), 0, 0x05040001, true },
		{ 0xc0, OBJECT(0x2000, 1), 0, 0x05040001, true },
	};
	uint8_t first;

	(void)state;
	for (size_t i = 0; i < sizeof(asks) / sizeof(asks[0]); i++) {
		struct plc p = begun();
		const struct plc_ask before = p.ask;

		p.operational = asks[i].operational;
		assert_int_equal(ask(&p, asks[i].first, asks[i].object,
				     asks[i].value, &first), asks[i].code);
		assert_int_equal(first, 0x80);
		assert_int_equal(p.refused, 1);
		assert_memory_equal(&p.ask, &before, sizeof(before));
	}
}

static void an_abort_is_not_answered(void **state)
{
	struct plc p = working();
	const uint8_t abort[8] = { 0x80, 0, 0x20, 1 };

	(void)state;
	assert_true(hear(&p, CAN_SDO_ASK + NODE, 8, abort));
	assert_false(p.answers);
}

/* Whatever comes: no more out than a period has room for, and no permit
 * from a PLC that is not there. */
static void nonsense_is_never_believed(void **state)
{
	struct plc p = begun();
	struct can_msg out[PLC_EMITS];
	uint32_t x = 12345;

	(void)state;
	for (int i = 0; i < 200000; i++) {
		uint8_t data[8];

		for (int k = 0; k < 8; k++)
			data[k] = (uint8_t)((x = x * 1664525 + 1013904223) >>
					    24);
		hear(&p, (uint16_t)((x >> 8 & 0x780) | (x >> 30 ? NODE : 0u)),
		     (uint8_t)(x >> 5 & 8), data);
		plc_period(&p);
		assert_true(plc_emit(&p, out) <= PLC_EMITS);
		assert_true(p.ask.override <= 2000 && p.ask.program <= 9999);
		assert_true(p.ask.locks <= PLC_LOCKS);
	}
	for (int i = 0; i <= ALIVE_CYCLES; i++)
		plc_period(&p);
	assert_false(p.ask.command & ~PLC_ALIVE);
}

static bool overlap(const struct plc_signal *a, const struct plc_signal *b)
{
	return a->asked == b->asked && a->pdo == b->pdo && a->pdo > 0 &&
	       a->byte < b->byte + plc_bytes(b->type) &&
	       b->byte < a->byte + plc_bytes(a->type);
}

/* Where the mapping objects of its frame have it, in bits; -1: nowhere. */
static int mapped_at(struct plc *p, const struct plc_signal *s)
{
	const uint16_t index = (uint16_t)((s->asked ? 0x1600 : 0x1a00) +
					  s->pdo - 1);
	const uint32_t map = (uint32_t)s->index << 16 | (uint32_t)s->sub << 8 |
			     8 * (uint32_t)plc_bytes(s->type);
	uint8_t first;
	const uint32_t n = ask(p, 0x40, OBJECT(index, 0), 0, &first);
	int at = 0;

	for (uint32_t k = 1; k <= n; k++) {
		const uint32_t x = ask(p, 0x40, OBJECT(index, k), 0, &first);

		if (x == map)
			return at;
		at += (int)(x & 0xff);
	}
	return -1;
}

/* As a PLC reads them. */
static void the_mapping_is_that_of_the_table(void **state)
{
	struct plc p = working();
	uint8_t first;

	(void)state;
	for (size_t i = 0; i < plc_nsignals; i++) {
		const struct plc_signal *s = &plc_signal[i];

		if (s->pdo)
			assert_int_equal(mapped_at(&p, s), 8 * s->byte);
		for (size_t k = 0; k < i; k++)
			assert_false(overlap(s, &plc_signal[k]));
	}
	assert_int_equal(p.refused, 0);
	/* No frame, and no signal of one. */
	ask(&p, 0x40, OBJECT(0x1603, 0), 0, &first);
	ask(&p, 0x40, OBJECT(0x1a00, 7), 0, &first);
	assert_int_equal(p.refused, 2);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(its_first_frame_is_the_boot_up_message),
		cmocka_unit_test(its_heartbeat_comes_in_time_and_says_the_nmt_state),
		cmocka_unit_test(nmt_of_another_node_is_not_obeyed),
		cmocka_unit_test(an_unknown_nmt_command_is_counted_and_changes_nothing),
		cmocka_unit_test(a_reset_takes_the_permit_and_boots_again),
		cmocka_unit_test(a_stop_takes_the_permit_at_once),
		cmocka_unit_test(one_that_is_stopped_only_beats),
		cmocka_unit_test(a_fault_is_an_emergency_and_in_the_history),
		cmocka_unit_test(after_a_reset_a_fault_that_stands_is_told_again),
		cmocka_unit_test(what_an_object_has_may_be_written),
		cmocka_unit_test(requests_count_when_operational_only),
		cmocka_unit_test(frames_of_a_wrong_length_change_nothing),
		cmocka_unit_test(frames_to_other_nodes_are_not_for_us),
		cmocka_unit_test(another_device_of_our_node_is_counted),
		cmocka_unit_test(a_request_with_a_value_out_of_range_is_dropped_whole),
		cmocka_unit_test(without_a_turn_of_its_toggle_the_plc_is_dead),
		cmocka_unit_test(a_turn_in_time_keeps_it_alive),
		cmocka_unit_test(tpdos_go_round_with_what_is_told),
		cmocka_unit_test(a_round_takes_four_periods),
		cmocka_unit_test(an_m_code_is_told_behind_its_electrode),
		cmocka_unit_test(what_a_generator_is_asked_for_is_sent_at_once),
		cmocka_unit_test(tpdos_are_sent_when_operational_only),
		cmocka_unit_test(every_object_of_the_table_can_be_read),
		cmocka_unit_test(the_plc_sets_the_time_of_the_heartbeat),
		cmocka_unit_test(the_plc_sets_the_id_of_emergencies),
		cmocka_unit_test(requests_may_be_written_before_the_pdos_come),
		cmocka_unit_test(a_permit_by_sdo_is_no_permit),
		cmocka_unit_test(what_cannot_be_is_aborted_with_its_code),
		cmocka_unit_test(an_abort_is_not_answered),
		cmocka_unit_test(nonsense_is_never_believed),
		cmocka_unit_test(the_mapping_is_that_of_the_table),
	};

	return cmocka_run_group_tests_name("io/plc", tests, NULL, NULL);
}
