/* SPDX-License-Identifier: Apache-2.0 */
/*
 * What io/drive.h promises, against a drive that follows CiA 402.
 */
#include "drive.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#define NODE	5

/* The other end: a drive with an object dictionary as it comes from a box. */
struct peer {
	uint16_t status;
	bool operational, mapped, fault, mute, deaf;
	uint32_t refuses;		/* index << 8 | sub: aborted, */
	uint32_t code;			/* ... so; 0: there is no such object */
	uint8_t ntpdo;			/* objects in its TPDO */
	uint32_t cob;			/* of its TPDO */
	bool rude;			/* ... has another mode, all the same */
	bool wide;			/* 60C2:2 has two bytes, as some have */
	uint16_t wide_index;
	uint32_t index_writes;
	int32_t actual, target, latched;
	uint16_t control;
	uint8_t mode;
	uint32_t profile, modes, abort_option;
	uint32_t rpdo[2], tpdo[3], beat_ms, master_beat;
	uint8_t time_value;
	int8_t time_index;
	uint32_t window;		/* 6065 */
	uint8_t polarity;		/* 607E, of one byte: its count has the
					 * other sign */
	uint32_t given_up;		/* SDO transfers that were aborted */
	struct {
		uint16_t asked, seen;	/* 60B8 as written, as looked at */
		uint16_t status;	/* 60B9 */
		int32_t place, mark;	/* 60BA; where the mark is */
		int every, in;		/* it looks once in so many periods */
		bool early;		/* it stores when it is switched on */
		uint16_t toggle;	/* bit 6 is another with each mark */
		bool held;		/* its status stays as it is */
		int offs;		/* times that it was switched off */
	} probe;
};

static struct drive_config config(void)
{
	return (struct drive_config) {
		.node = NODE, .master = 127, .increments = 10, .pulses = 1,
		.period_us = 2000, .heartbeat_ms = 100, .beat_cycles = 125,
		.answer_cycles = 50, .missing_max = 2, .following_max = 50,
		.limited_cycles = 50,
		.write = { { 0x6007, 0, 2, 3, true } }, .nwrites = 1,
	};
}

static void peer_state(struct peer *p)
{
	static const struct {
		uint16_t from, control, to;
	} moves[] = {
		{ 0x40, 0x06, 0x21 }, { 0x21, 0x07, 0x23 },
		{ 0x23, 0x0f, 0x1027 }, { 0x27, 0x02, 0x07 },
		{ 0x27, 0x06, 0x21 }, { 0x23, 0x06, 0x21 },
		{ 0x07, 0x00, 0x40 }, { 0x27, 0x00, 0x40 },
		{ 0x23, 0x00, 0x40 }, { 0x21, 0x00, 0x40 },
	};

	if (p->fault) {
		p->status = 0x08;
		if (p->control & 0x80)
			p->fault = false, p->status = 0x40;
		return;
	}
	for (size_t i = 0; i < sizeof(moves) / sizeof(moves[0]); i++) {
		if ((p->status & 0x6f) == moves[i].from &&
		    (p->control & 0x8f) == moves[i].control) {
			p->status = moves[i].to;
			return;
		}
	}
}

static void peer_write(struct peer *p, const uint8_t *d)
{
	const uint32_t at = can_get(d + 1, 2) << 8 | d[3];
	const uint32_t x = can_get(d + 4, 4);

	switch (at) {
	case 0x101700: p->beat_ms = x; break;
	case 0x101601: p->master_beat = x; break;
	case 0x160001: p->rpdo[0] = x; break;
	case 0x160002: p->rpdo[1] = x; break;
	case 0x1a0001: p->tpdo[0] = x; break;
	case 0x1a0002: p->tpdo[1] = x; break;
	case 0x1a0003: p->tpdo[2] = x; break;
	case 0x1a0000: p->ntpdo = (uint8_t)x; break;
	case 0x180001:
		p->mapped = !(x & 0x80000000u);
		p->cob = x;
		break;
	case 0x600700: p->abort_option = x; break;
	case 0x606000: p->mode = (uint8_t)x; break;
	case 0x606500: p->window = x; break;
	case 0x60b800: p->probe.asked = (uint16_t)x; break;
	case 0x607e00:
		if (p->polarity != (uint8_t)x)
			p->actual = p->latched = p->target = -p->actual;
		p->polarity = (uint8_t)x;
		break;
	case 0x60c201: p->time_value = (uint8_t)x; break;
	case 0x60c202: p->time_index = (int8_t)x; break;
	default: break;
	}
}

static uint32_t peer_read(const struct peer *p, uint32_t at)
{
	switch (at) {
	case 0x100000: return p->profile;
	case 0x650200: return p->modes;
	case 0x100500: return 0x80;
	case 0x101601: return p->master_beat;
	case 0x140001: return 0x200 + NODE;
	case 0x180001: return p->cob;
	case 0x60c201: return p->time_value;
	case 0x606500: return p->window;
	case 0x60b900: return p->probe.status;
	case 0x60ba00: return (uint32_t)p->probe.place;
	case 0x607e00: return p->polarity;
	case 0x60c202: return (uint8_t)p->time_index;
	default: return at >> 8 >= 0x1400 && at >> 8 < 0x1900 ? 0x80000000u : 0;
	}
}

static void wide_index(struct peer *p, const struct can_msg *m,
		       struct can_msg *a)
{
	if (m->data[0] == 0x40) {
		a->data[0] = 0x4b;
		can_put(a->data + 4, p->wide_index, 2);
	} else if (m->data[0] != 0x2b) {
		a->data[0] = 0x80;
		can_put(a->data + 4, 0x06070010, 4);
	} else {
		a->data[0] = 0x60;
		p->wide_index = (uint16_t)can_get(m->data + 4, 2);
		p->index_writes++;
	}
}

static void sdo(struct peer *p, struct drive *d, const struct can_msg *m)
{
	struct can_msg a = { .id = CAN_SDO_ANSWER + NODE, .len = 8 };
	const uint32_t at = can_get(m->data + 1, 2) << 8 | m->data[3];

	memcpy(a.data + 1, m->data + 1, 3);
	if (m->data[0] == 0x80) {
		p->given_up++;
		return;
	}
	if (p->wide && at == 0x60c202) {
		wide_index(p, m, &a);
	} else if (at == p->refuses &&
	    (p->code != 0x06010002 || m->data[0] != 0x40)) {
		a.data[0] = 0x80;
		can_put(a.data + 4, p->code ? p->code : 0x06020000, 4);
	} else if (m->data[0] == 0x40 && at == 0x100800) {
		a.data[0] = 0x41;
		can_put(a.data + 4, 11, 4);
	} else if (m->data[0] == 0x40) {
		a.data[0] = at == 0x607e00 ? 0x4f : 0x43;
		can_put(a.data + 4, peer_read(p, at), 4);
	} else if (at == 0x607e00 && m->data[0] != 0x2f) {
		a.data[0] = 0x80;
		can_put(a.data + 4, 0x06070010, 4);
	} else {
		a.data[0] = 0x60;
		peer_write(p, m->data);
	}
	drive_receive(d, &a);
}

/* One that looks at 60B8 seldom, and forgets what it stored when it sees that
 * it is switched off, and only then. */
static void peer_probe(struct peer *p, int32_t was)
{
	const bool passed = (was - p->probe.mark) * (int64_t)(p->actual -
			    p->probe.mark) <= 0 && was != p->actual;
	const bool rises = p->probe.asked & ~p->probe.seen & 1;

	if (p->probe.held)
		return;
	if (--p->probe.in <= 0) {
		p->probe.offs += p->probe.seen && !p->probe.asked;
		p->probe.in = p->probe.every;
		if (rises && p->probe.early) {
			p->probe.status |= 2;
			p->probe.place = p->actual;
		}
		p->probe.seen = p->probe.asked;
		if (!(p->probe.seen & 1))
			p->probe.status = p->probe.toggle;
	}
	if (!(p->probe.seen & 1))
		return;
	p->probe.status |= 1;
	if (!passed || p->probe.status & 2)
		return;
	p->probe.place = p->probe.mark;
	p->probe.toggle ^= 0x40;
	p->probe.status ^= 0x40 | 2;
}

static void hear(struct peer *p, struct drive *d, const struct can_msg *m)
{
	if (m->id == CAN_SDO_ASK + NODE) {
		sdo(p, d, m);
	} else if (m->id == CAN_NMT) {
		p->operational = m->data[0] == 1;
	} else if (m->id == CAN_RPDO1 + NODE) {
		p->control = (uint16_t)can_get(m->data, 2);
		p->target = (int32_t)can_get(m->data + 2, 4);
		peer_state(p);
	}
}

/* One period: what the master sends reaches the drive, and the other way. */
static void period(struct drive *d, struct peer *p, int32_t target)
{
	struct can_msg m[DRIVE_EMITS];
	struct can_msg a = { .id = CAN_TPDO1 + NODE,
			     .len = (uint8_t)(p->ntpdo == 3 ? 7 : 6) };
	const int32_t was = p->actual;
	size_t n;

	if (p->operational && p->mapped && !p->mute) {
		can_put(a.data, p->status, 2);
		can_put(a.data + 2, (uint32_t)p->actual, 4);
		a.data[6] = p->rude ? 6 : p->mode;
		drive_receive(d, &a);
	}
	drive_sync(d);
	if ((p->status & 0x6f) == 0x27)
		p->actual = p->latched;
	p->latched = p->target;
	peer_probe(p, was);
	n = drive_emit(d, target, m);
	for (size_t i = 0; i < n && !p->deaf; i++)
		hear(p, d, &m[i]);
}

static void beat(struct drive *d)
{
	const struct can_msg m = { .id = CAN_HEARTBEAT + NODE, .len = 1,
				   .data = { 0x05 } };

	drive_receive(d, &m);
}

struct rig {
	struct drive d;
	struct peer p;
};

static void make(struct rig *r)
{
	const struct drive_config c = config();

	memset(r, 0, sizeof(*r));
	drive_init(&r->d, &c);
	r->p = (struct peer) {
		.status = 0x40, .profile = 0x20192, .modes = 0x3ff,
		.time_value = 1, .time_index = -3, .cob = 0x40000180 + NODE,
		.actual = 123456, .target = 123456, .latched = 123456,
	};
}

static void run(struct rig *r, int cycles, int32_t target)
{
	for (int i = 0; i < cycles; i++) {
		if (i % 20 == 0)
			beat(&r->d);
		period(&r->d, &r->p, target);
	}
}

/* Up, enabled, and at pulse 0. */
static void enable(struct rig *r)
{
	make(r);
	run(r, 80, 0);
	drive_set_zero(&r->d, 0);
	drive_aim(&r->d, DRIVE_GO_ON);
	run(r, 20, 0);
	assert_int_equal(r->d.state, DRIVE_ENABLED);
	assert_true(r->d.led);
	r->d.joined = true;		/* as the master does */
}

static void a_drive_is_brought_up_as_cia_402_wants(void **state)
{
	struct rig r;

	(void)state;
	make(&r);
	run(&r, 80, 0);
	assert_int_equal(r.d.phase, DRIVE_RUNNING);
	assert_true(r.p.operational);
	assert_int_equal(r.p.tpdo[2], 0x60610008);
	assert_int_equal(r.p.ntpdo, 3);
	assert_int_equal(r.p.cob, 0x40000180 + NODE);
	assert_int_equal(r.p.rpdo[0], 0x60400010);
	assert_int_equal(r.p.rpdo[1], 0x607a0020);
	assert_int_equal(r.p.tpdo[0], 0x60410010);
	assert_int_equal(r.p.tpdo[1], 0x60640020);
	assert_int_equal(r.p.mode, 8);
	assert_int_equal(r.p.abort_option, 3);
	assert_int_equal(r.p.beat_ms, 100);
	assert_int_equal(r.p.master_beat, 127 << 16 | 250);
	assert_int_equal(r.p.time_value, 2);
	assert_int_equal(r.p.time_index, -3);
	assert_int_equal(r.d.actual, 123456);
	assert_int_equal(r.d.state, DRIVE_DISABLED);
}

static void enabling_moves_nothing(void **state)
{
	struct rig r;

	(void)state;
	make(&r);
	run(&r, 80, 0);
	drive_set_zero(&r.d, 0);
	drive_aim(&r.d, DRIVE_GO_ON);
	for (int i = 0; i < 40; i++) {
		run(&r, 1, 0);
		assert_int_equal(r.p.actual, 123456);
	}
	assert_int_equal(r.d.state, DRIVE_ENABLED);
	assert_int_equal(r.d.trouble, DRIVE_WELL);
}

static void it_follows_to_the_increment(void **state)
{
	struct rig r;

	(void)state;
	enable(&r);
	for (int32_t at = 0; at <= 5000; at += 7) {
		beat(&r.d);
		period(&r.d, &r.p, at);
	}
	run(&r, 4, 4998);
	assert_int_equal(r.p.actual, 123456 + 49980);
	assert_int_equal(drive_place(&r.d), 4998);
	assert_int_equal(r.d.trouble, DRIVE_WELL);
}

static void one_that_was_pushed_stays_there_until_it_joins(void **state)
{
	struct rig r;
	(void)state;
	enable(&r);
	drive_aim(&r.d, DRIVE_GO_OFF);
	run(&r, 10, 0);
	r.p.actual = r.p.target = r.p.latched += 400;
	run(&r, 5, 0);
	drive_aim(&r.d, DRIVE_GO_ON);
	run(&r, 40, 0);
	assert_true(r.d.led && !r.d.joined);
	assert_int_equal(r.p.actual, 123456 + 400);
	assert_int_equal(drive_stands_at(&r.d), 40);
	r.d.joined = true;
	run(&r, 3, 40);
	assert_int_equal(r.p.actual, 123456 + 400);
	assert_int_equal(r.d.trouble, DRIVE_WELL);
}

static void troubles_are_seen_latched_and_end_by_reset(void **state)
{
	struct rig r;

	(void)state;
	enable(&r);
	r.p.fault = true;
	r.p.status = 0x08;
	run(&r, 5, 0);
	assert_int_equal(r.d.trouble, DRIVE_EMERGENCY);
	run(&r, 200, 0);
	assert_true(r.p.fault);
	drive_aim(&r.d, DRIVE_GO_OFF);
	drive_reset(&r.d);
	run(&r, 20, 0);
	assert_false(r.p.fault);
	drive_aim(&r.d, DRIVE_GO_ON);
	run(&r, 20, 0);
	assert_int_equal(r.d.state, DRIVE_ENABLED);
	assert_int_equal(r.d.trouble, DRIVE_WELL);
}

static void one_that_leaves_its_state_is_not_enabled_again(void **state)
{
	struct rig r;

	(void)state;
	enable(&r);
	r.p.status = 0x40;
	run(&r, 100, 0);
	assert_int_equal(r.d.trouble, DRIVE_FELL_OFF);
	assert_int_not_equal(r.d.state, DRIVE_ENABLED);
}

static void silence_is_trouble(void **state)
{
	struct rig r;

	(void)state;
	enable(&r);
	r.p.mute = true;
	run(&r, 1, 0);
	r.p.mute = false;
	run(&r, 5, 0);
	assert_int_equal(r.d.trouble, DRIVE_WELL);
	r.p.mute = true;
	run(&r, 3, 0);
	assert_int_equal(r.d.trouble, DRIVE_NO_ANSWER);

	enable(&r);
	for (int i = 0; i < 130; i++)
		period(&r.d, &r.p, 0);
	assert_int_equal(r.d.trouble, DRIVE_MUTE);
}

static void a_statusword_that_is_no_state_costs_no_place(void **state)
{
	struct rig r;

	(void)state;
	enable(&r);
	r.p.status = 0x1067;
	run(&r, 2, 0);
	r.p.status = 0x1027;
	run(&r, 5, 0);
	assert_int_equal(r.d.trouble, DRIVE_WELL);
	r.p.status = 0x1067;
	run(&r, 3, 0);
	assert_int_equal(r.d.trouble, DRIVE_STRANGE);
	assert_false(r.d.lost);
	r.p.status = 0x40;
	run(&r, 2, 0);
	drive_reset(&r.d);
	run(&r, 20, 0);
	assert_int_equal(r.d.trouble, DRIVE_WELL);
	assert_int_equal(r.d.state, DRIVE_ENABLED);
}

/* Some drives stop following for a while when their mode is written. */
static void a_reset_writes_no_mode_to_one_that_follows(void **state)
{
	struct rig r;

	(void)state;
	enable(&r);
	drive_reset(&r.d);
	assert_false(r.d.remode);
	r.p.status = 0x27;
	run(&r, 2, 0);
	drive_reset(&r.d);
	assert_true(r.d.remode);
}

/* Its own task runs once in up to eight SYNCs, which is in 16 ms here. */
static void one_that_looks_seldom_sees_the_fault_reset(void **state)
{
	struct rig r;

	(void)state;
	for (int every = 2; every <= 8; every++) {
		bool was = true, seen = false;

		enable(&r);
		r.p.fault = true;
		r.p.status = 0x08;
		run(&r, 5, 0);
		drive_reset(&r.d);
		for (int i = 0; i < 400 && !seen; i++) {
			/* The peer takes no reset by itself. */
			r.p.fault = true;
			r.p.status = 0x08;
			run(&r, 1, 0);
			if (i % every != 0)
				continue;
			seen = !was && r.p.control & 0x80;
			was = r.p.control & 0x80;
		}
		assert_true(seen);
		assert_int_equal(r.d.trouble, DRIVE_WELL);
	}
}

/* Just switched on, it is not ready for this yet. */
static void one_that_is_busy_is_asked_again(void **state)
{
	struct rig r;

	(void)state;
	make(&r);
	r.p.refuses = 0x606000;
	r.p.code = 0x08000022;
	run(&r, 200, 0);
	assert_int_equal(r.d.phase, DRIVE_CONFIGURED_NEXT);
	assert_int_equal(r.d.passed, DRIVE_LATER);
	r.p.refuses = 0;
	run(&r, 100, 0);
	assert_int_equal(r.d.phase, DRIVE_RUNNING);
	assert_int_equal(r.p.mode, 8);

	make(&r);
	r.p.refuses = 0x606000;
	r.p.code = 0x08000022;
	run(&r, 1000, 0);
	assert_int_equal(r.d.phase, DRIVE_REFUSED);
	assert_int_equal(r.d.abort, 0x08000022);
}

static void a_drive_that_lags_is_stopped(void **state)
{
	struct rig r;
	int32_t at = 0;

	(void)state;
	enable(&r);
	/* Jammed: it does not move though it is told to. */
	for (int i = 0; i < 30 && r.d.trouble == DRIVE_WELL; i++) {
		r.p.latched = 123456;
		beat(&r.d);
		period(&r.d, &r.p, at += 10);
	}
	assert_int_equal(r.d.trouble, DRIVE_FOLLOWING);
	assert_true(at <= 50 + 10 * (DRIVE_SENT + 3));
	run(&r, 2, at);
	assert_int_equal(r.p.control, 0x02);
}

/* As it comes from its maker, and it sends nothing. */
static void lose_power(struct rig *r)
{
	const struct can_msg boot = { .id = CAN_HEARTBEAT + NODE, .len = 1 };

	r->p.operational = r->p.mapped = r->p.fault = false;
	r->p.mode = 0;
	r->p.status = 0x40;
	drive_receive(&r->d, &boot);
}

static void one_that_reboots_is_brought_up_again_after_reset(void **state)
{
	struct rig r;

	(void)state;
	enable(&r);
	lose_power(&r);
	run(&r, 100, 0);
	assert_int_equal(r.d.trouble, DRIVE_REBOOTED);
	assert_int_equal(r.p.mode, 0);
	drive_aim(&r.d, DRIVE_GO_OFF);
	drive_reset(&r.d);
	run(&r, 100, 0);
	assert_int_equal(r.p.mode, 8);
	drive_aim(&r.d, DRIVE_GO_ON);
	run(&r, 20, 0);
	assert_int_equal(r.d.state, DRIVE_ENABLED);
}

/* Supply too low, a fault, and then no supply: that is how power goes. */
static void a_fault_before_it_reboots_does_not_cost_a_second_reset(void **state)
{
	struct rig r;

	(void)state;
	enable(&r);
	r.p.fault = true;
	run(&r, 3, 0);
	assert_int_equal(r.d.trouble, DRIVE_EMERGENCY);
	lose_power(&r);
	run(&r, 3, 0);
	assert_int_equal(r.d.trouble, DRIVE_EMERGENCY);
	drive_aim(&r.d, DRIVE_GO_OFF);
	drive_reset(&r.d);
	run(&r, 100, 0);
	assert_int_equal(r.d.trouble, DRIVE_WELL);
	assert_int_equal(r.p.mode, 8);
	assert_true(r.d.lost);
}

static void what_a_drive_may_not_have_is_no_trouble(void **state)
{
	struct rig r;

	(void)state;
	make(&r);
	r.p.refuses = 0x600700;
	run(&r, 80, 0);
	assert_int_equal(r.d.phase, DRIVE_RUNNING);
	assert_int_equal(r.d.passed, DRIVE_WITHOUT);
	make(&r);
	r.p.refuses = 0x600700;
	r.p.code = 0x06090030;
	run(&r, 80, 0);
	assert_int_equal(r.d.phase, DRIVE_REFUSED);
	assert_int_equal(r.d.abort, 0x06090030);
	assert_int_equal(r.d.abort_value, 3);
	make(&r);
	r.p.refuses = 0x606000;
	run(&r, 60, 0);
	assert_int_equal(r.d.phase, DRIVE_REFUSED);
	assert_int_equal(r.d.trouble, DRIVE_MISCONFIGURED);
	assert_int_equal(r.d.abort_index, 0x6060);
	assert_int_equal(r.d.abort, 0x06020000);
	make(&r);
	r.p.profile = 0x191;
	run(&r, 60, 0);
	assert_int_equal(r.d.abort_index, 0x1000);
	make(&r);
	r.p.modes = 0x7f;
	run(&r, 60, 0);
	assert_int_equal(r.d.abort_index, 0x6502);
}

static void one_that_takes_its_time_to_begin_is_no_trouble(void **state)
{
	struct rig r;

	(void)state;
	make(&r);
	r.p.mute = true;
	run(&r, 80, 0);
	assert_int_equal(r.d.phase, DRIVE_RUNNING);
	assert_int_equal(r.d.trouble, DRIVE_WELL);
	run(&r, 60, 0);
	assert_int_equal(r.d.trouble, DRIVE_NO_ANSWER);
}

/* The other one stands elsewhere, and says so after each answer. */
static void answer_of_another(struct rig *r)
{
	struct can_msg a = { .id = CAN_TPDO1 + NODE,
			     .len = (uint8_t)(r->p.ntpdo == 3 ? 7 : 6) };

	can_put(a.data, 0x1237, 2);
	can_put(a.data + 2, 500000, 4);
	a.data[6] = 8;
	drive_receive(&r->d, &a);
}

static void two_drives_with_one_node_never_get_power(void **state)
{
	struct rig r;

	(void)state;
	make(&r);
	for (int i = 0; i < 200; i++) {
		if (r.d.phase == DRIVE_RUNNING)
			answer_of_another(&r);
		drive_aim(&r.d, DRIVE_GO_ON);
		run(&r, 1, 0);
		assert_int_not_equal(r.p.status & 0x6f, 0x27);
	}
	assert_int_equal(r.d.trouble, DRIVE_TWICE);
}

static void answers_that_come_late_are_not_of_two_drives(void **state)
{
	struct rig r;

	(void)state;
	enable(&r);
	r.d.c.missing_max = 20;
	for (int i = 0; i < 50; i++) {
		r.p.mute = true;
		run(&r, 1 + i % 15, 0);
		r.p.mute = false;
		/* One, and those that were late. */
		for (int k = 0; k <= i % 15; k++) {
			struct can_msg a = { .id = CAN_TPDO1 + NODE, .len = 7 };

			can_put(a.data, r.p.status, 2);
			can_put(a.data + 2, (uint32_t)r.p.actual, 4);
			a.data[6] = r.p.mode;
			drive_receive(&r.d, &a);
		}
		run(&r, 5, 0);
		assert_int_equal(r.d.trouble, DRIVE_WELL);
	}
}

static void one_switched_on_late_is_found(void **state)
{
	struct rig r;

	(void)state;
	make(&r);
	r.p.deaf = true;
	run(&r, 1000, 0);
	assert_int_equal(r.d.phase, DRIVE_SILENT);
	r.p.deaf = false;
	run(&r, 200, 0);
	assert_int_equal(r.d.phase, DRIVE_RUNNING);
}

static void frames_of_a_wrong_length_are_counted_not_believed(void **state)
{
	struct rig r;

	(void)state;
	enable(&r);
	for (uint8_t len = 0; len <= 8; len++) {
		struct can_msg m = { .id = CAN_TPDO1 + NODE, .len = len };

		if (len != 7)
			assert_true(drive_receive(&r.d, &m));
	}
	assert_int_equal(r.d.malformed, 8);
	assert_int_equal(r.d.actual, 123456);
	assert_int_equal(r.d.trouble, DRIVE_WELL);
	assert_false(drive_receive(&r.d, &(struct can_msg) {
		.id = CAN_TPDO1 + NODE + 1, .len = 6 }));
}

static void a_restart_loses_the_place_unless_it_is_absolute(void **state)
{
	const struct can_msg boot = { .id = CAN_HEARTBEAT + NODE, .len = 1 };

	(void)state;
	for (int absolute = 0; absolute < 2; absolute++) {
		struct rig r;

		enable(&r);
		r.d.c.absolute = absolute;
		r.p.operational = r.p.mapped = false;
		r.p.status = 0x40;
		r.p.actual = r.p.latched = r.p.target = 37;
		r.p.master_beat = 0;
		drive_receive(&r.d, &boot);
		assert_int_equal(r.d.trouble, DRIVE_REBOOTED);
		assert_int_equal(r.d.lost, !absolute);
		drive_reset(&r.d);
		run(&r, 100, 0);
		assert_int_equal(r.d.lost, !absolute);
		drive_aim(&r.d, DRIVE_GO_ON);
		run(&r, 50, 0);
		assert_int_equal(r.p.actual, 37);
		/* It goes where it is sent, or does not move at all. */
		r.d.joined = r.d.led;
		run(&r, 50, 0);
		assert_true(absolute ? r.p.actual > 37 : r.p.actual == 37);
	}
}

static void a_restart_nobody_heard_is_seen_when_it_is_brought_up(void **state)
{
	struct rig r;

	(void)state;
	enable(&r);
	drive_setup_again(&r.d);
	run(&r, 100, 0);
	assert_false(r.d.lost);
	r.p.master_beat = 0;
	drive_setup_again(&r.d);
	run(&r, 100, 0);
	assert_true(r.d.lost);
	drive_set_zero(&r.d, 0);
	assert_false(r.d.lost);
	/* Left in order, it still names us. */
	r.p.master_beat = 127 << 16;
	drive_setup_again(&r.d);
	run(&r, 100, 0);
	assert_false(r.d.lost);
}

/* Off too short for an SDO to stay unanswered three times. */
static void a_restart_nobody_heard_in_the_set_up_is_seen_too(void **state)
{
	struct rig r;
	int missed = 0;

	(void)state;
	for (int after = 1; after < 100; after++) {
		enable(&r);
		drive_setup_again(&r.d);
		run(&r, after, 0);
		if (r.d.phase == DRIVE_RUNNING)
			break;
		missed++;
		r.p.master_beat = 0;
		for (int off = 0; off < 5; off++) {
			struct can_msg unheard[DRIVE_EMITS];

			drive_emit(&r.d, 0, unheard);
			drive_sync(&r.d);
		}
		/* Behind the last step it misses the start: no answers. */
		if (r.d.phase == DRIVE_RUNNING)
			break;
		run(&r, 300, 0);
		assert_int_equal(r.d.phase, DRIVE_RUNNING);
		assert_true(r.d.lost);
		assert_int_equal(r.p.master_beat, 127 << 16 | 250);
	}
	assert_true(missed > 20);
}

static void a_place_counts_only_in_a_state_that_has_one(void **state)
{
	struct rig r;

	(void)state;
	make(&r);
	r.p.status = 0;
	r.p.actual = 0;
	run(&r, 100, 0);
	assert_int_equal(r.d.phase, DRIVE_RUNNING);
	assert_true(r.d.heard);
	assert_false(r.d.stands);
	r.p.status = 0x40;
	r.p.actual = 123456;
	run(&r, 1, 0);
	assert_true(r.d.stands);
	assert_int_equal(r.d.actual, 123456);
}

static void a_restart_in_the_set_up_begins_it_again(void **state)
{
	const struct can_msg boot = { .id = CAN_HEARTBEAT + NODE, .len = 1 };
	struct rig r;

	(void)state;
	for (int after = 1; after < 60; after++) {
		make(&r);
		run(&r, after, 0);
		if (r.d.phase == DRIVE_RUNNING)
			break;
		r.p.mode = 0;
		r.p.ntpdo = 0;
		r.p.mapped = false;
		r.p.beat_ms = r.p.master_beat = 0;
		drive_receive(&r.d, &boot);
		run(&r, 80, 0);
		assert_int_equal(r.d.phase, DRIVE_RUNNING);
		assert_int_equal(r.p.mode, 8);
		assert_int_equal(r.p.ntpdo, 3);
		assert_int_equal(r.p.beat_ms, 100);
		assert_int_equal(r.p.master_beat, 127 << 16 | 250);
	}
}

static void bits_and_mode_are_watched_in_every_answer(void **state)
{
	struct rig r;

	(void)state;
	enable(&r);
	r.p.rude = true;
	run(&r, 1, 0);
	assert_int_equal(r.d.trouble, DRIVE_OTHER_MODE);
	enable(&r);
	r.p.status = 0x27;
	run(&r, 1, 0);
	assert_int_equal(r.d.trouble, DRIVE_NOT_LED);
	enable(&r);
	r.p.status = 0x3027;
	run(&r, 1, 0);
	assert_int_equal(r.d.trouble, DRIVE_FOLLOWING);
	enable(&r);
	r.p.status = 0x18a7;
	run(&r, 40, 0);
	assert_int_equal(r.d.trouble, DRIVE_WELL);
	assert_int_equal(r.d.warnings, 1);
	run(&r, 140, 0);
	assert_int_equal(r.d.trouble, DRIVE_WELL);
}

/* An emergency while it was set up is over; one answer is lost later. */
static void an_emergency_that_has_ended_is_no_fault_later(void **state)
{
	const struct can_msg came = { .id = CAN_EMCY + NODE, .len = 8,
				      .data = { 0x20, 0x31 } };
	const struct can_msg ended = { .id = CAN_EMCY + NODE, .len = 8 };

	(void)state;
	for (int i = 0; i < 2; i++) {
		struct rig r;

		if (i == 0) {
			enable(&r);
			drive_receive(&r.d, &came);
			drive_receive(&r.d, &ended);
		} else {
			make(&r);
			run(&r, 5, 0);
			assert_true(r.d.phase < DRIVE_RUNNING);
			drive_receive(&r.d, &came);
			run(&r, 80, 0);
			assert_int_equal(r.d.phase, DRIVE_RUNNING);
		}
		assert_int_equal(r.d.emergency, i ? 0x3120 : 0);
		drive_sync(&r.d);
		drive_sync(&r.d);
		assert_int_equal(r.d.trouble, DRIVE_WELL);
	}
}

/* An axis on its limit goes away from it as slowly as it likes. */
static void a_target_is_clipped_only_if_the_axis_does_not_go_there(void **state)
{
	for (int away = 0; away < 2; away++) {
		struct rig r;

		(void)state;
		enable(&r);
		r.p.status = 0x18a7;
		for (int i = 1; i <= 80; i++) {
			const int32_t to = i < 30 ? i : 30;

			run(&r, 1, away ? -i : to);
			if (!away)
				r.p.actual = r.p.latched = 123456;
		}
		assert_int_equal(r.d.trouble, away ? DRIVE_WELL :
						     DRIVE_LIMITED);
	}
}

static void a_reset_writes_the_mode_again(void **state)
{
	struct rig r;

	(void)state;
	enable(&r);
	r.p.mode = 6;
	run(&r, 2, 0);
	assert_int_equal(r.d.trouble, DRIVE_OTHER_MODE);
	drive_aim(&r.d, DRIVE_GO_STOP);
	run(&r, 5, 0);
	assert_int_equal(r.p.mode, 6);
	drive_reset(&r.d);
	run(&r, 5, 0);
	assert_int_equal(r.p.mode, 8);
	drive_aim(&r.d, DRIVE_GO_ON);
	r.p.status = 0x40;
	run(&r, 20, 0);
	assert_true(r.d.led);
}

static void one_that_is_not_in_mode_8_is_not_moved(void **state)
{
	struct rig r;

	(void)state;
	make(&r);
	run(&r, 80, 0);
	drive_set_zero(&r.d, 0);
	r.p.rude = true;
	drive_aim(&r.d, DRIVE_GO_ON);
	for (int i = 0; i < 150; i++) {
		run(&r, 1, 40);
		assert_int_equal(r.p.actual, 123456);
	}
	assert_int_equal(r.d.trouble, DRIVE_OTHER_MODE);
}

static void one_stopped_by_nmt_is_trouble(void **state)
{
	const struct can_msg m = { .id = CAN_HEARTBEAT + NODE, .len = 1,
				   .data = { 0x04 } };
	struct rig r;

	(void)state;
	enable(&r);
	drive_receive(&r.d, &m);
	assert_int_equal(r.d.trouble, DRIVE_NOT_STARTED);
}

/* Increments of time a drive may have, and what period fits. */
static void the_period_is_told_in_a_unit_the_drive_has(void **state)
{
	static const struct {
		int8_t index;		/* as it is; -7 is none of ours */
		uint32_t period_us;
		bool fixed, fits;
		uint8_t value;
		int8_t end;
	} rows[] = {
		{ -3, 2000, true, true, 2, -3 },
		{ -3, 500, true, false, 0, 0 },
		{ -3, 500, false, true, 5, -4 },
		{ -3, 1500, false, true, 15, -4 },
		{ -4, 2000, true, true, 20, -4 },
		{ -4, 30000, false, true, 30, -3 },
		{ -6, 250, true, true, 250, -6 },
		{ -7, 1000, false, true, 1, -3 },
		{ -3, 1234, false, false, 0, 0 },
	};

	(void)state;
	for (size_t i = 0; i < sizeof(rows) / sizeof(rows[0]); i++) {
		struct rig r;

		make(&r);
		r.d.c.period_us = rows[i].period_us;
		r.p.time_index = rows[i].index;
		r.p.refuses = rows[i].fixed ? 0x60c202 : 0;
		r.p.code = 0x06010002;
		r.p.time_value = 99;
		run(&r, 120, 0);
		assert_int_equal(r.d.phase, rows[i].fits ? DRIVE_RUNNING :
							   DRIVE_REFUSED);
		if (!rows[i].fits)
			continue;
		assert_int_equal(r.p.time_value, rows[i].value);
		assert_int_equal(r.p.time_index, rows[i].end);
	}
}

/* A maker may give an object another size than the standard does. */
static void an_object_of_another_size_is_written_with_that_size(void **state)
{
	static const uint16_t before[] = { 1, 0xfffd };

	(void)state;
	for (int i = 0; i < 2; i++) {
		struct rig r;

		make(&r);
		r.p.wide = true;
		r.p.wide_index = before[i];
		run(&r, 200, 0);
		assert_int_equal(r.d.phase, DRIVE_RUNNING);
		assert_int_equal(r.p.wide_index, 0xfffd);
		assert_int_equal(r.p.time_value, 2);
		assert_int_equal(r.p.index_writes, 1);
	}
}

/* The axis stands until the latch is ready, then goes on by a pulse a period.
 * Return: where it is then. */
static int32_t go_to_mark(struct rig *r, int32_t from, int32_t to)
{
	int32_t at = from;

	for (int i = 0; i < 3000 && r->d.latch < DRIVE_LATCH_KEPT; i++) {
		drive_latch_ask(&r->d, true);
		at += r->d.latch == DRIVE_LATCH_READY && at != to ?
		      (to > at ? 1 : -1) : 0;
		run(r, 1, at);
	}
	return at;
}

static void a_drive_keeps_the_place_of_its_mark(void **state)
{
	static const int every[] = { 1, 7, 40 };
	struct rig r;
	int32_t at = 0;

	(void)state;
	for (size_t i = 0; i < 3; i++) {
		enable(&r);
		r.p.probe.every = every[i];
		for (int n = 0; n < 5; n++) {
			const int32_t mark = n % 2 ? -37 : 55 + n;

			r.p.probe.mark = 123456 + 10 * mark + 3;
			at = go_to_mark(&r, n ? at : 0, n % 2 ? -90 : 90);
			assert_int_equal(r.d.latch, DRIVE_LATCH_KEPT);
			assert_int_equal(drive_latched_at(&r.d), mark);
			drive_latch_ask(&r.d, false);
			assert_int_equal(r.d.latch, DRIVE_LATCH_OFF);
			run(&r, n == 4 ? 100 : 1, at);
		}
		assert_int_equal(r.p.probe.asked, 0);
		assert_int_equal(r.d.malformed, 0);
		assert_int_equal(r.d.trouble, DRIVE_WELL);
	}
}

/* A mark is none that was stored before, or that the axis did not pass. */
static void a_mark_that_was_not_passed_is_none(void **state)
{
	struct rig r;

	(void)state;
	enable(&r);
	r.p.probe.early = true;
	go_to_mark(&r, 0, 90);
	assert_int_equal(r.d.latch, DRIVE_LATCH_FAILED);
	assert_in_range(r.p.probe.offs, 2, 3);
	assert_int_equal(r.d.abort_index, 0x60b9);

	enable(&r);
	r.p.probe.mark = 123456 + 500;
	r.p.probe.held = true;
	r.p.probe.status = 2;		/* stuck: never on */
	go_to_mark(&r, 0, 90);
	assert_int_equal(r.d.latch, DRIVE_LATCH_FAILED);

	enable(&r);
	r.p.probe.mark = 123456 + 500;
	for (int i = 0; i < 40 && r.d.latch != DRIVE_LATCH_READY; i++) {
		drive_latch_ask(&r.d, true);
		run(&r, 1, 0);
	}
	r.p.probe.held = true;
	r.p.probe.status = 3;
	r.p.probe.place = 123456 + 500;	/* not there yet */
	go_to_mark(&r, 0, 20);
	assert_int_equal(r.d.latch, DRIVE_LATCH_FAILED);
	assert_int_equal(r.d.abort_index, 0x60ba);
	assert_int_equal(r.d.abort_value, 123456 + 500);
}

/* It is told, and so is what it lost on the way: the axis goes nowhere. */
static void one_that_cannot_latch_says_so(void **state)
{
	static const uint32_t refuses[] = { 0x60b800, 0x60b900, 0x60ba00 };
	struct rig r;

	(void)state;
	for (size_t i = 0; i < 3; i++) {
		enable(&r);
		r.p.probe.mark = 123456 + 55;
		r.p.refuses = refuses[i];
		r.p.code = 0x08000020;
		go_to_mark(&r, 0, 90);
		assert_int_equal(r.d.latch, DRIVE_LATCH_FAILED);
		assert_int_equal(r.d.abort_index, refuses[i] >> 8);
		assert_int_equal(r.d.trouble, DRIVE_WELL);
	}
	enable(&r);
	r.p.deaf = true;
	go_to_mark(&r, 0, 90);
	assert_int_equal(r.d.latch, DRIVE_LATCH_FAILED);
	enable(&r);
	drive_latch_ask(&r.d, true);
	run(&r, 3, 0);
	lose_power(&r);
	drive_latch_ask(&r.d, true);
	assert_int_equal(r.d.latch, DRIVE_LATCH_FAILED);
}

static enum cia402_end object(struct rig *r, struct cia402_request q,
			      int cycles)
{
	drive_object_ask(&r->d, &q);
	run(r, cycles, 0);
	return (enum cia402_end)r->d.object.end;
}

/* One request at a time: each gets its own answer. */
static void a_person_reads_an_object_while_a_mark_is_sought(void **state)
{
	static const uint16_t objects[] = { 0x6065, 0x60b9, 0x60ba };
	struct rig r;
	int32_t at = 0;

	(void)state;
	for (int shift = 0; shift < 30; shift++) {
		const struct cia402_request q = { .index = objects[shift % 3] };

		enable(&r);
		r.p.probe.mark = 123456 + 10 * 60;
		for (int i = 0; i < 400 && r.d.latch < DRIVE_LATCH_KEPT; i++) {
			drive_latch_ask(&r.d, true);
			if (i == shift)
				drive_object_ask(&r.d, &q);
			at += r.d.latch == DRIVE_LATCH_READY;
			run(&r, 1, at);
		}
		assert_int_equal(r.d.latch, DRIVE_LATCH_KEPT);
		assert_int_equal(drive_latched_at(&r.d), 60);
		assert_int_equal(r.d.object.end, CIA402_DONE);
		assert_int_equal(r.d.malformed, 0);
		at = 0;
	}
}

static void an_object_is_read_while_the_drive_runs(void **state)
{
	struct rig r;

	(void)state;
	make(&r);
	assert_int_equal(object(&r, (struct cia402_request) { .index = 0x6065 },
				1), CIA402_NOT_UP);
	enable(&r);
	r.p.window = 2000;
	assert_int_equal(object(&r, (struct cia402_request) { .index = 0x6065 },
				3), CIA402_DONE);
	assert_int_equal(r.d.object.now, 2000);
	assert_int_equal(r.d.object.bytes, 4);
	assert_int_equal(object(&r, (struct cia402_request) { .index = 0x607e },
				3), CIA402_DONE);
	assert_int_equal(r.d.object.bytes, 1);
	assert_int_equal(r.d.trouble, DRIVE_WELL);
	assert_int_equal(r.d.malformed, 0);
}

static void an_object_is_set_with_the_size_it_has_and_read_back(void **state)
{
	const struct cia402_request q = { .index = 0x6065, .sets = true,
					  .value = 1500 };
	struct rig r;

	(void)state;
	make(&r);
	run(&r, 80, 0);
	r.p.window = 2000;
	assert_int_equal(object(&r, q, 4), CIA402_DONE);
	assert_int_equal(r.p.window, 1500);
	assert_int_equal(r.d.object.was, 2000);
	assert_int_equal(r.d.object.now, 1500);
}

static void what_moves_an_axis_is_not_set(void **state)
{
	static const uint16_t own[] = {
		0x6040, 0x607a, 0x6060, 0x60c2, 0x1016, 0x1400, 0x1a00, 0x6007
	};
	struct rig r;

	(void)state;
	enable(&r);
	for (size_t i = 0; i < sizeof(own) / sizeof(own[0]); i++)
		assert_int_equal(object(&r, (struct cia402_request) {
			.index = own[i], .sub = 1, .sets = true }, 5),
			CIA402_OWN);
	assert_int_equal(object(&r, (struct cia402_request) {
		.index = 0x6065, .sets = true }, 5), CIA402_POWERED);
	assert_int_equal(r.p.window, 0);
	r.d.c.leave[r.d.c.nleaves++] = 0x1016;
	assert_int_equal(object(&r, (struct cia402_request) {
		.index = 0x1016, .sub = 1, .sets = true }, 5), CIA402_POWERED);
}

/* Between the look at the object and the write. */
static void power_that_comes_meanwhile_ends_a_set(void **state)
{
	const struct cia402_request q = { .index = 0x6065, .sets = true,
					  .value = 1500 };
	struct rig r;

	(void)state;
	make(&r);
	run(&r, 80, 0);
	drive_set_zero(&r.d, 0);
	r.p.deaf = true;
	assert_int_equal(object(&r, q, 1), CIA402_UNDER_WAY);
	r.p.deaf = false;
	drive_aim(&r.d, DRIVE_GO_ON);
	run(&r, 60, 0);
	assert_int_equal(r.d.object.end, CIA402_POWERED);
	assert_int_equal(r.p.window, 0);
}

static void a_refusal_silence_and_a_long_object_are_told(void **state)
{
	struct rig r;

	(void)state;
	enable(&r);
	r.p.refuses = 0x606500;
	r.p.code = 0x06010001;
	assert_int_equal(object(&r, (struct cia402_request) { .index = 0x6065 },
				3), CIA402_ABORTED);
	assert_int_equal(r.d.object.code, 0x06010001);
	assert_int_equal(object(&r, (struct cia402_request) { .index = 0x1008 },
				4), CIA402_LONG);
	assert_int_equal(r.p.given_up, 1);
	assert_int_equal(r.d.trouble, DRIVE_WELL);
	drive_aim(&r.d, DRIVE_GO_OFF);
	r.p.deaf = true;
	assert_int_equal(object(&r, (struct cia402_request) { .index = 0x6064 },
				160), CIA402_SILENT);
}

static void a_set_that_changes_the_count_loses_the_place(void **state)
{
	const struct cia402_request q = { .index = 0x607e, .sets = true,
					  .value = 0x80 };
	struct rig r;

	(void)state;
	make(&r);
	run(&r, 80, 0);
	drive_set_zero(&r.d, 0);
	assert_int_equal(object(&r, (struct cia402_request) {
		.index = 0x6065, .sets = true, .value = 5 }, 8), CIA402_DONE);
	assert_false(r.d.lost);
	assert_int_equal(object(&r, q, 8), CIA402_DONE);
	assert_true(r.d.lost);
}

/* The set-up is the one that talks to the drive then. */
static void a_set_up_ends_what_is_asked(void **state)
{
	struct rig r;

	(void)state;
	make(&r);
	run(&r, 80, 0);
	r.p.deaf = true;
	assert_int_equal(object(&r, (struct cia402_request) { .index = 0x6065 },
				2), CIA402_UNDER_WAY);
	drive_setup_again(&r.d);
	assert_int_equal(r.d.object.end, CIA402_NOT_UP);
	r.p.deaf = false;
	r.p.operational = false;
	run(&r, 80, 0);
	assert_int_equal(r.d.phase, DRIVE_RUNNING);
	assert_int_equal(r.d.malformed, 0);
}

static void the_last_emergencies_are_kept(void **state)
{
	struct can_msg m = { .id = CAN_EMCY + NODE, .len = 8,
			     .data = { 0x10, 0x23, 0x03, 1, 2, 3, 4, 5 } };
	struct rig r;

	(void)state;
	enable(&r);
	for (int i = 0; i < CIA402_EMERGENCIES + 3; i++) {
		m.data[3] = (uint8_t)i;
		drive_receive(&r.d, &m);
	}
	assert_int_equal(r.d.came, CIA402_EMERGENCIES + 3);
	assert_int_equal(r.d.history[2].maker[0], CIA402_EMERGENCIES + 2);
	assert_int_equal(r.d.history[2].maker[4], 5);
	assert_int_equal(r.d.history[3].maker[0], 3);
	assert_string_equal(cia402_emergency_text(0x2310),
			    "continuous over-current, output side");
	assert_string_equal(cia402_emergency_text(0x2319),
			    "continuous over-current, output side");
	assert_string_equal(cia402_emergency_text(0x2399),
			    "current, output side");
	assert_string_equal(cia402_emergency_text(0xff42), "maker's own");
	assert_string_equal(cia402_emergency_text(0x0042), "code of the maker");
}

static void objects_have_numbers_and_names(void **state)
{
	static const struct {
		const char *text;
		uint16_t index;
		uint8_t sub;
	} good[] = {
		{ "6064", 0x6064, 0 }, { "0x6064", 0x6064, 0 },
		{ "60C2:2", 0x60c2, 2 }, { "1018:0x4", 0x1018, 4 },
		{ "position actual value", 0x6064, 0 },
		{ "Position-Actual_Value", 0x6064, 0 },
		{ "DC link circuit voltage", 0x6079, 0 },
	};
	static const char *const bad[] = {
		"", "60642", "6064:", "6064:256", "6064 1", "position",
		"position actual values", ":1",
	};
	uint16_t index;
	uint8_t sub;

	(void)state;
	for (size_t i = 0; i < sizeof(good) / sizeof(good[0]); i++) {
		assert_true(cia402_object_read(good[i].text, &index, &sub));
		assert_int_equal(index, good[i].index);
		assert_int_equal(sub, good[i].sub);
	}
	for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++)
		assert_false(cia402_object_read(bad[i], &index, &sub));
	for (size_t i = 0; cia402_object_row(i); i++) {
		const struct cia402_object *o = cia402_object_row(i);

		assert_true(cia402_object_read(o->name, &index, &sub));
		assert_ptr_equal(cia402_object_at(index, sub), o);
	}
}

static void one_without_mode_8_follows_in_mode_7(void **state)
{
	struct rig r;

	(void)state;
	make(&r);
	r.d.c.interpolates = true;
	r.p.modes = 0x65;
	run(&r, 80, 0);
	assert_int_equal(r.d.phase, DRIVE_RUNNING);
	assert_int_equal(r.p.rpdo[1], 0x60c10120);
	assert_int_equal(r.p.mode, 7);
	drive_set_zero(&r.d, 0);
	drive_aim(&r.d, DRIVE_GO_ON);
	run(&r, 20, 0);
	assert_true(r.d.led);
	assert_int_equal(r.p.control, 0x1f);
	r.d.joined = true;
	for (int32_t at = 0; at <= 700; at += 7) {
		beat(&r.d);
		period(&r.d, &r.p, at);
	}
	run(&r, 4, 700);
	assert_int_equal(r.p.actual, 123456 + 7000);
	drive_aim(&r.d, DRIVE_GO_STOP);
	run(&r, 1, 700);
	assert_int_equal(r.p.control, 0x02);
	assert_int_equal(r.d.trouble, DRIVE_WELL);
}

/* Its home is 5 increments before the place where it comes to stand. */
static void home_period(struct rig *r, uint32_t *runs, bool asked)
{
	struct peer *p = &r->p;

	if (p->mode == 6 && p->control == 0x1f) {
		(*runs)++;
		p->status = *runs > 30 ? 0x1027 : 0x0027;
	}
	if (*runs == 30)
		p->actual = p->latched = p->target = 5;
	drive_home_ask(&r->d, asked);
	run(r, 1, 70);
}

static void a_drive_homes_and_stands_where_it_was_sent(void **state)
{
	uint32_t runs = 0, left = 0;
	struct rig r;

	(void)state;
	enable(&r);
	r.d.c.homes = true;
	r.d.c.home_cycles = 1000;
	r.d.c.enable_cycles = 200;
	r.p.target = r.p.latched = r.p.actual = 123456 + 700;
	r.d.c.following_max = 0;
	run(&r, 3, 70);
	for (int i = 0; i < 400 && r.d.homed_now != DRIVE_HOMED; i++) {
		home_period(&r, &runs, true);
		left += r.d.state != DRIVE_ENABLED;
	}
	assert_true(left > 2);		/* its mode changed without torque */
	for (int i = 0; i < 100 && drive_is_homing(&r.d); i++)
		home_period(&r, &runs, true);
	assert_false(drive_is_homing(&r.d));
	assert_int_equal(r.d.trouble, DRIVE_WELL);
	assert_int_equal(r.p.mode, 8);
	assert_int_equal(drive_place(&r.d), 70);
	assert_int_equal(drive_own_place(&r.d), 1);
	run(&r, 5, 70);
	assert_int_equal(r.p.actual, 5);
	home_period(&r, &runs, false);
	assert_int_equal(r.d.homed_now, DRIVE_NOT_HOMED);
}

static void one_that_goes_silent_while_it_homes_homes_no_more(void **state)
{
	uint32_t runs = 0;
	struct rig r;

	(void)state;
	enable(&r);
	r.d.c.homes = true;
	r.d.c.home_cycles = 1000;
	r.d.c.enable_cycles = 200;
	for (int i = 0; i < 60; i++)
		home_period(&r, &runs, true);
	assert_true(runs > 0 && drive_is_homing(&r.d));
	r.p.mute = true;
	for (int i = 0; i < 10; i++)
		home_period(&r, &runs, true);
	assert_int_equal(r.d.trouble, DRIVE_NO_ANSWER);
	assert_false(drive_is_homing(&r.d));
	assert_int_equal(r.d.homed_now, DRIVE_UNFOUND);
}

static void what_no_brake_holds_is_not_let_go(void **state)
{
	struct rig r;

	(void)state;
	enable(&r);
	r.d.c.held = true;
	r.p.status = 0x07;
	drive_aim(&r.d, DRIVE_GO_STOP);
	run(&r, 5, 0);
	assert_int_equal(r.p.control, 0x02);
	drive_aim(&r.d, DRIVE_GO_ON);
	r.d.trouble = DRIVE_WELL;
	run(&r, 3, 0);
	assert_int_equal(r.p.control, 0x0f);
}

static void a_billion_pulses_do_not_drift(void **state)
{
	const struct drive_config c = { .increments = 524288, .pulses = 5000 };
	const struct drive_config back = { .increments = -3, .pulses = 7 };
	struct drive d = { .c = c };

	(void)state;
	for (int32_t p = -1000000000; p <= 1000000000; p += 999983) {
		const int32_t i = drive_to_increments(&back, p);
		const int64_t whole = (int64_t)-3 * p;

		assert_true((int64_t)i * 7 <= whole);
		assert_true(((int64_t)i + 1) * 7 > whole);
	}
	for (int32_t p = -20000000; p <= 20000000; p += 9973) {
		d.zero = 1 << 30;
		d.actual = (int32_t)(uint32_t)((1u << 30) +
			   (uint32_t)drive_to_increments(&c, p));
		assert_int_equal(drive_place(&d), p);
	}
}

static void bits_are_those_of_the_standard(void **state)
{
	(void)state;
	assert_int_equal(can_bits(8), 135);
	assert_int_equal(can_bits(0), 55);
}

static void statuswords_are_states_and_every_state_has_a_way_on(
	void **state)
{
	(void)state;
	for (uint32_t w = 0; w < 0x10000; w++)
		assert_true(drive_state_of((uint16_t)w) <= DRIVE_NO_STATE);
	/* Words that CiA 402 does not have are not taken for a restart. */
	assert_int_equal(drive_state_of(0x1267), DRIVE_NO_STATE);
	assert_int_equal(drive_state_of(0x0248), DRIVE_NO_STATE);
	assert_int_equal(drive_state_of(0x0000), DRIVE_NOT_READY);
	assert_int_equal(drive_state_of(0x0637), DRIVE_ENABLED);
	assert_int_equal(drive_state_of(0x0250), DRIVE_DISABLED);
	assert_int_equal(drive_state_of(0x0218), DRIVE_FAULT);
	for (int s = 0; s < DRIVE_NSTATES; s++)
		assert_true(drive_control(DRIVE_GO_STOP,
					  (enum drive_state)s) != 0x0f);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_drive_is_brought_up_as_cia_402_wants),
		cmocka_unit_test(enabling_moves_nothing),
		cmocka_unit_test(it_follows_to_the_increment),
		cmocka_unit_test(one_that_was_pushed_stays_there_until_it_joins),
		cmocka_unit_test(troubles_are_seen_latched_and_end_by_reset),
		cmocka_unit_test(one_that_leaves_its_state_is_not_enabled_again),
		cmocka_unit_test(silence_is_trouble),
		cmocka_unit_test(a_statusword_that_is_no_state_costs_no_place),
		cmocka_unit_test(a_reset_writes_no_mode_to_one_that_follows),
		cmocka_unit_test(one_that_looks_seldom_sees_the_fault_reset),
		cmocka_unit_test(one_that_is_busy_is_asked_again),
		cmocka_unit_test(a_drive_that_lags_is_stopped),
		cmocka_unit_test(one_that_reboots_is_brought_up_again_after_reset),
		cmocka_unit_test(a_fault_before_it_reboots_does_not_cost_a_second_reset),
		cmocka_unit_test(what_a_drive_may_not_have_is_no_trouble),
		cmocka_unit_test(one_that_takes_its_time_to_begin_is_no_trouble),
		cmocka_unit_test(two_drives_with_one_node_never_get_power),
		cmocka_unit_test(answers_that_come_late_are_not_of_two_drives),
		cmocka_unit_test(one_switched_on_late_is_found),
		cmocka_unit_test(frames_of_a_wrong_length_are_counted_not_believed),
		cmocka_unit_test(a_restart_loses_the_place_unless_it_is_absolute),
		cmocka_unit_test(a_restart_nobody_heard_is_seen_when_it_is_brought_up),
		cmocka_unit_test(a_restart_nobody_heard_in_the_set_up_is_seen_too),
		cmocka_unit_test(a_place_counts_only_in_a_state_that_has_one),
		cmocka_unit_test(a_restart_in_the_set_up_begins_it_again),
		cmocka_unit_test(bits_and_mode_are_watched_in_every_answer),
		cmocka_unit_test(an_emergency_that_has_ended_is_no_fault_later),
		cmocka_unit_test(a_target_is_clipped_only_if_the_axis_does_not_go_there),
		cmocka_unit_test(a_reset_writes_the_mode_again),
		cmocka_unit_test(one_that_is_not_in_mode_8_is_not_moved),
		cmocka_unit_test(one_stopped_by_nmt_is_trouble),
		cmocka_unit_test(the_period_is_told_in_a_unit_the_drive_has),
		cmocka_unit_test(an_object_of_another_size_is_written_with_that_size),
		cmocka_unit_test(a_drive_keeps_the_place_of_its_mark),
		cmocka_unit_test(a_mark_that_was_not_passed_is_none),
		cmocka_unit_test(one_that_cannot_latch_says_so),
		cmocka_unit_test(a_person_reads_an_object_while_a_mark_is_sought),
		cmocka_unit_test(an_object_is_read_while_the_drive_runs),
		cmocka_unit_test(an_object_is_set_with_the_size_it_has_and_read_back),
		cmocka_unit_test(what_moves_an_axis_is_not_set),
		cmocka_unit_test(power_that_comes_meanwhile_ends_a_set),
		cmocka_unit_test(a_refusal_silence_and_a_long_object_are_told),
		cmocka_unit_test(a_set_that_changes_the_count_loses_the_place),
		cmocka_unit_test(a_set_up_ends_what_is_asked),
		cmocka_unit_test(the_last_emergencies_are_kept),
		cmocka_unit_test(objects_have_numbers_and_names),
		cmocka_unit_test(one_without_mode_8_follows_in_mode_7),
		cmocka_unit_test(a_drive_homes_and_stands_where_it_was_sent),
		cmocka_unit_test(
			one_that_goes_silent_while_it_homes_homes_no_more),
		cmocka_unit_test(what_no_brake_holds_is_not_let_go),
		cmocka_unit_test(a_billion_pulses_do_not_drift),
		cmocka_unit_test(bits_are_those_of_the_standard),
		cmocka_unit_test(statuswords_are_states_and_every_state_has_a_way_on),
	};

	return cmocka_run_group_tests_name("io/drive", tests, NULL, NULL);
}
