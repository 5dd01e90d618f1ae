/* SPDX-License-Identifier: Apache-2.0 */
/*
 * plc.c - the frames between edmd and a PLC
 *
 * If one value of a frame is out of range, the whole frame is dropped.
 */
#include "plc.h"

#include <math.h>
#include <string.h>

#define BEAT_MS		100		/* object 1017 begins with it */
#define NTPDO		6
#define CONDITION	5		/* EdmdCondition */
#define PULSE		6		/* EdmdPulse */
#define STATE_OPERATES	0x05
#define STATE_READY	0x7f		/* pre-operational */
#define STATE_STOPPED	0x04
#define FAULT_CODE	0xff00u		/* + number of the fault */

static const uint16_t tpdo_id[NTPDO + 1] = { 0, 0x180, 0x280, 0x380, 0x480,
					     0x500, 0x680 };

/*
 * The objects that the PLC may write, as an NMT reset sets them. What had been
 * told is told again: the PLC may have been switched on only now.
 */
static void reset(struct plc *p)
{
	p->emcy_id = CAN_EMCY + p->node;
	p->fault_sent = p->nhistory = 0;
	plc_beat(p, BEAT_MS);
}

void plc_init(struct plc *p, uint8_t node)
{
	*p = (struct plc) { .node = node, .send_cycles = 1, .alive_cycles = 1,
			    .cycles_per_ms = 0.01 };
	reset(p);
}

void plc_beat(struct plc *p, uint16_t ms)
{
	p->beat_ms = ms;
	p->beat_cycles = ms > 0 ? (uint32_t)fmax(1, round(ms *
						p->cycles_per_ms)) : 0;
	p->beat_in = p->beat_cycles > 0 ? p->beat_cycles - 1 : 0;
}

/* -- From the PLC --------------------------------------------------------- */

/* It ends before this one: that is not told, as with all bits set. */
static bool at_end(const struct can_msg *m, const struct plc_signal *s)
{
	return s->byte >= m->len;
}

static void hear_rpdo(struct plc *p, const struct can_msg *m, int n)
{
	struct plc whole = { .ask = p->ask };

	if (!p->operational)
		return;
	for (size_t i = 0; i < plc_nsignals; i++) {
		const struct plc_signal *s = &plc_signal[i];

		if (!s->asked || s->pdo != n)
			continue;
		if (!plc_take(&whole, s, at_end(m, s) ? (uint32_t)s->max :
			      can_get(m->data + s->byte,
				      (int)plc_bytes(s->type)))) {
			p->refused++;
			return;
		}
	}
	p->ask = whole.ask;
	p->heard[n]++;
}

static void hear_request(struct plc *p, const struct can_msg *m)
{
	const uint8_t before = p->ask.command;

	hear_rpdo(p, m, 1);
	if ((p->ask.command ^ before) & PLC_ALIVE) {
		p->since_turn = 0;
		p->alive = true;
	}
}

static void hear_generator(struct plc *p, const struct can_msg *m)
{
	hear_rpdo(p, m, 2);
}

static void hear_pulse(struct plc *p, const struct can_msg *m)
{
	hear_rpdo(p, m, 3);
}

/* What it asked for is void, until its toggle turns. */
static void forget(struct plc *p)
{
	p->alive = false;
	p->since_turn = p->alive_cycles;
}

static void hear_nmt(struct plc *p, const struct can_msg *m)
{
	if (m->data[1] != 0 && m->data[1] != p->node)
		return;
	switch (m->data[0]) {
	case 0x01:
	case 0x02:
	case 0x80:
		p->operational = m->data[0] == 0x01;
		p->stopped = m->data[0] == 0x02;
		/* Its requests do not reach us any more. */
		if (!p->operational)
			forget(p);
		break;
	case 0x81:
	case 0x82:
		p->operational = p->stopped = p->booted = false;
		p->ask = (struct plc_ask) { 0 };
		reset(p);
		forget(p);
		break;
	default:
		p->refused++;
		break;
	}
}

/* Another device has our node, so its frames mean nothing to us. */
static void hear_twin(struct plc *p, const struct can_msg *m)
{
	(void)m;
	p->twins++;
}

bool plc_receive(struct plc *p, const struct can_msg *m)
{
	static const struct {
		uint16_t id;
		uint8_t len, plus_node;
		void (*hear)(struct plc *, const struct can_msg *);
	} kinds[] = {
		{ CAN_NMT, 2, 0, hear_nmt },
		{ CAN_RPDO1, 8, 1, hear_request },
		{ CAN_RPDO2, 7, 1, hear_generator },
		{ CAN_RPDO2, 5, 1, hear_generator },	/* no ToldServo */
		{ CAN_RPDO3, 8, 1, hear_pulse },
		{ CAN_SDO_ASK, 8, 1, plc_sdo },
		{ CAN_TPDO1, 8, 1, hear_twin },
		{ CAN_HEARTBEAT, 1, 1, hear_twin },
	};

	bool ours = false;

	for (size_t i = 0; i < sizeof(kinds) / sizeof(kinds[0]); i++) {
		if (m->id != kinds[i].id + kinds[i].plus_node * p->node)
			continue;
		if (p->stopped && m->id == CAN_SDO_ASK + p->node)
			return true;
		ours = true;
		if (m->len == kinds[i].len) {
			kinds[i].hear(p, m);
			return true;
		}
	}
	p->malformed += ours;
	return ours;
}

/* Lost until its toggle turns again; what it asked for last is void. */
void plc_period(struct plc *p)
{
	if (p->since_turn < p->alive_cycles) {
		p->since_turn++;
		return;
	}
	p->alive = false;
	p->ask.command &= PLC_ALIVE;
}

/* -- To the PLC ----------------------------------------------------------- */

static struct can_msg tpdo(struct plc *p, int n)
{
	struct can_msg m = { .id = (uint16_t)(tpdo_id[n] + p->node),
			     .len = 8 };

	if (n == 1) {
		p->toggle = !p->toggle;
		p->tell.flags = (uint8_t)((p->tell.flags & ~PLC_TOGGLE) |
					  (p->toggle ? PLC_TOGGLE : 0));
	}
	for (size_t i = 0; i < plc_nsignals; i++) {
		const struct plc_signal *s = &plc_signal[i];

		if (!s->asked && s->pdo == n)
			can_put(m.data + s->byte, plc_value(p, s),
				(int)plc_bytes(s->type));
	}
	return m;
}

static struct can_msg beat(const struct plc *p, uint8_t state)
{
	return (struct can_msg) { .id = (uint16_t)(CAN_HEARTBEAT + p->node),
				  .len = 1, .data = { state } };
}

/* A fault is told once, and its end too; nothing is sent while stopped. */
static bool emergency_due(struct plc *p, struct can_msg *ret)
{
	const uint8_t fault = p->tell.fault;
	const uint32_t code = fault ? FAULT_CODE | fault : 0;

	p->register_1001 = fault != 0;
	if (fault == p->fault_sent || p->stopped || !p->booted)
		return false;
	p->fault_sent = fault;
	*ret = (struct can_msg) { .id = (uint16_t)(p->emcy_id & 0x7ff),
				  .len = 8 };
	can_put(ret->data, code, 2);
	ret->data[2] = p->register_1001;
	if (fault) {
		memmove(p->history + 1, p->history,
			sizeof(p->history) - sizeof(p->history[0]));
		p->history[0] = code;
		p->nhistory = (uint8_t)(p->nhistory < PLC_HISTORY ?
					p->nhistory + 1 : PLC_HISTORY);
	}
	return !(p->emcy_id & PLC_EMCY_OFF);
}

/* The condition, behind the values that its number is of. */
static size_t put_condition(struct plc *p, struct can_msg *ret)
{
	size_t n = 0;

	if (p->sets)
		ret[n++] = tpdo(p, PULSE);
	ret[n++] = tpdo(p, CONDITION);
	p->sent = p->tell.pulse.number;
	return n;
}

/* One TPDO a period, so that the bus is not flooded at once.  But no M code is
 * told before what EdmdCondition says of it: that goes with EdmdStatus, and in
 * the period in which the generator is asked for something else. */
static bool send_next(struct plc *p)
{
	if (p->send_in-- == 0) {
		p->send_in = p->send_cycles - 1;
		p->next = p->next == 0 ? 1 : p->next;
	}
	if (!p->operational)
		p->next = 0;
	return p->next > 0;
}

size_t plc_emit(struct plc *p, struct can_msg *ret)
{
	size_t n = 0;
	bool due;

	if (!p->booted) {
		p->booted = true;
		p->beat_in = p->beat_cycles;
		ret[n++] = beat(p, 0);
	} else if (p->beat_cycles > 0 && p->beat_in-- == 0) {
		p->beat_in = p->beat_cycles - 1;
		ret[n++] = beat(p, p->operational ? STATE_OPERATES :
				p->stopped ? STATE_STOPPED : STATE_READY);
	}
	if (emergency_due(p, &ret[n]))
		n++;
	if (p->answers)
		ret[n++] = p->answer;
	p->answers = false;
	due = send_next(p);
	if (p->operational && ((due && p->next == 1) ||
			       p->sent != p->tell.pulse.number))
		n += put_condition(p, &ret[n]);
	if (due) {
		ret[n++] = tpdo(p, p->next);
		p->next = p->next == CONDITION - 1 ? 0 : (uint8_t)(p->next + 1);
	}
	return n;
}
