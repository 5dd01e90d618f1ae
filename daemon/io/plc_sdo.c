/* SPDX-License-Identifier: Apache-2.0 */
/*
 * plc_sdo.c - the SDO server: expedited transfers of CiA 301
 */
#include "plc.h"

#include <string.h>

enum abort_code {
	ABORT_COMMAND	= 0x05040001,	/* command not known */
	ABORT_NO_OBJECT	= 0x06020000,
	ABORT_READ_ONLY	= 0x06010002,
	ABORT_NO_SUB	= 0x06090011,
	ABORT_LENGTH	= 0x06070010,
	ABORT_RANGE	= 0x06090030,
	ABORT_STATE	= 0x08000022,	/* PDOs write it now */
	ABORT_NO_DATA	= 0x08000024,
};

#define DOWNLOAD	1		/* command specifiers, bits 7 ... 5 */
#define UPLOAD		2
#define ABORT		4

size_t plc_bytes(enum plc_type t)
{
	static const uint8_t bytes[] = {
		[PLC_U8] = 1, [PLC_U16] = 2, [PLC_U32] = 4, [PLC_I16] = 2,
		[PLC_I32] = 4, [PLC_TEXT] = 4,
	};

	return bytes[t];
}

uint32_t plc_value(const struct plc *p, const struct plc_signal *s)
{
	const uint8_t *base = s->asked ? (const uint8_t *)&p->ask :
					 (const uint8_t *)&p->tell;
	uint32_t x = 0;
	uint16_t half;

	if (plc_bytes(s->type) == 1) {
		x = base[s->offset];
	} else if (plc_bytes(s->type) == 2) {
		memcpy(&half, base + s->offset, sizeof(half));
		x = half;
	} else {
		memcpy(&x, base + s->offset, sizeof(x));
	}
	return x;
}

static int64_t as_number(enum plc_type t, uint32_t raw)
{
	return t == PLC_I16 ? (int16_t)(uint16_t)raw :
	       t == PLC_I32 ? (int32_t)raw : (int64_t)raw;
}

bool plc_take(struct plc *p, const struct plc_signal *s, uint32_t raw)
{
	const int64_t x = as_number(s->type, raw);
	uint8_t *to = (uint8_t *)&p->ask + s->offset;
	const uint16_t half = (uint16_t)raw;

	if (x < s->min || x > s->max)
		return false;
	if (plc_bytes(s->type) == 1)
		*to = (uint8_t)raw;
	else if (plc_bytes(s->type) == 2)
		memcpy(to, &half, sizeof(half));
	else
		memcpy(to, &raw, sizeof(raw));
	return true;
}

static const struct plc_signal *signal_at(uint16_t index, uint8_t sub)
{
	for (size_t i = 0; i < plc_nsignals; i++) {
		if (plc_signal[i].index == index && plc_signal[i].sub == sub)
			return &plc_signal[i];
	}
	return NULL;
}

/* What a frame carries: how many signals, and then each of them. */
static bool mapping_at(uint16_t index, uint8_t sub, struct plc_constant *ret)
{
	const bool asked = index >> 8 == 0x16;
	uint32_t n = 0;

	*ret = (struct plc_constant) {
		.index = index, .sub = sub, .type = sub ? PLC_U32 : PLC_U8,
	};
	if (!asked && index >> 8 != 0x1a)
		return false;
	for (size_t i = 0; i < plc_nsignals; i++) {
		const struct plc_signal *s = &plc_signal[i];

		if (s->asked != asked || s->pdo != (index & 0xff) + 1 ||
		    ++n != sub)
			continue;
		ret->value = (uint32_t)s->index << 16 |
			     (uint32_t)s->sub << 8 |
			     (uint32_t)(8 * plc_bytes(s->type));
		return true;
	}
	ret->value = n;
	return sub == 0 && n > 0;
}

static bool constant_at(uint16_t index, uint8_t sub, struct plc_constant *ret)
{
	for (size_t i = 0; i < plc_nconstants; i++) {
		if (plc_constant[i].index != index ||
		    plc_constant[i].sub != sub)
			continue;
		*ret = plc_constant[i];
		return true;
	}
	return mapping_at(index, sub, ret);
}

static uint32_t constant_value(const struct plc *p,
			       const struct plc_constant *c)
{
	switch (c->live) {
	case PLC_PLUS_NODE:
		return c->value + p->node;
	case PLC_REGISTER:
		return p->register_1001;
	case PLC_ERRORS:
		return p->nhistory;
	case PLC_ERROR:
		return p->history[c->sub - 1];
	case PLC_EMCY:
		return p->emcy_id;
	case PLC_BEAT:
		return p->beat_ms;
	default:
		return c->value;
	}
}

static void say_abort(struct plc *p, uint32_t code)
{
	p->answer.data[0] = ABORT << 5;
	can_put(p->answer.data + 4, code, 4);
}

/* Sub-index 0 is there wherever the object is. */
static void say_missing(struct plc *p, uint16_t index)
{
	struct plc_constant c;

	say_abort(p, constant_at(index, 0, &c) ? ABORT_NO_SUB :
						 ABORT_NO_OBJECT);
}

static void upload(struct plc *p, uint16_t index, uint8_t sub)
{
	const struct plc_signal *s = signal_at(index, sub);
	struct plc_constant c = { 0 };
	size_t bytes;

	if (!s && !constant_at(index, sub, &c)) {
		say_missing(p, index);
		return;
	}
	if (c.live == PLC_ERROR && c.sub > p->nhistory) {
		say_abort(p, ABORT_NO_DATA);
		return;
	}
	bytes = plc_bytes(s ? s->type : c.type);
	p->answer.data[0] = (uint8_t)(0x43 | (4 - bytes) << 2);
	can_put(p->answer.data + 4, s ? plc_value(p, s) :
		constant_value(p, &c), 4);
}

/* CiA 301: 0 alone may be written, also while there are errors. */
static bool take_history(struct plc *p, uint32_t x)
{
	if (x == 0)
		p->nhistory = 0;
	return x == 0;
}

/* CiA 301: the id may be changed only in a value that has bit 31 set. */
static bool take_emcy(struct plc *p, uint32_t x)
{
	const uint32_t id = x & ~PLC_EMCY_OFF;

	if (id <= CAN_EMCY || id > CAN_EMCY + CAN_NODE_MAX)
		return false;
	if (id != (p->emcy_id & ~PLC_EMCY_OFF) &&
	    !((p->emcy_id | x) & PLC_EMCY_OFF))
		return false;
	p->emcy_id = x;
	return true;
}

static bool take_beat(struct plc *p, uint32_t ms)
{
	plc_beat(p, (uint16_t)ms);
	return true;
}

/* The value that an object has may be written: tools write all they know. */
static void download_constant(struct plc *p, const struct plc_constant *c,
			      uint32_t x)
{
	static bool (*const take[PLC_NLIVE])(struct plc *, uint32_t) = {
		[PLC_ERRORS] = take_history, [PLC_EMCY] = take_emcy,
		[PLC_BEAT] = take_beat,
	};

	if (x == constant_value(p, c) && c->live != PLC_ERRORS)
		p->answer.data[0] = 3 << 5;
	else if (!take[c->live])
		say_abort(p, ABORT_READ_ONLY);
	else if (!take[c->live](p, x))
		say_abort(p, ABORT_RANGE);
	else
		p->answer.data[0] = 3 << 5;
}

static bool has_length(const struct can_msg *m, enum plc_type t)
{
	const bool sized = m->data[0] & 1, expedited = m->data[0] & 2;
	const size_t bytes = 4 - (m->data[0] >> 2 & 3u);

	return expedited && (!sized || bytes == plc_bytes(t));
}

static void download_signal(struct plc *p, const struct plc_signal *s,
			    uint32_t x)
{
	if (p->operational)
		say_abort(p, ABORT_STATE);
	else if (!plc_take(p, s, x))
		say_abort(p, ABORT_RANGE);
	else
		p->answer.data[0] = 3 << 5;
}

static void download(struct plc *p, const struct can_msg *m, uint16_t index,
		     uint8_t sub)
{
	const struct plc_signal *s = signal_at(index, sub);
	struct plc_constant c = { 0 };
	enum plc_type type;

	if (!s && !constant_at(index, sub, &c)) {
		say_missing(p, index);
		return;
	}
	type = s ? s->type : c.type;
	if (s && !s->asked)
		say_abort(p, ABORT_READ_ONLY);
	else if (!has_length(m, type))
		say_abort(p, ABORT_LENGTH);
	else if (s)
		download_signal(p, s, can_get(m->data + 4,
					      (int)plc_bytes(type)));
	else
		download_constant(p, &c, can_get(m->data + 4,
						 (int)plc_bytes(type)));
}

void plc_sdo(struct plc *p, const struct can_msg *m)
{
	const uint16_t index = (uint16_t)can_get(m->data + 1, 2);
	const uint8_t what = m->data[0] >> 5;

	if (what == ABORT)
		return;
	p->answer = (struct can_msg) {
		.id = (uint16_t)(CAN_SDO_ANSWER + p->node), .len = 8
	};
	memcpy(p->answer.data + 1, m->data + 1, 3);
	p->answers = true;
	if (what == UPLOAD)
		upload(p, index, m->data[3]);
	else if (what == DOWNLOAD)
		download(p, m, index, m->data[3]);
	else
		say_abort(p, ABORT_COMMAND);
	if (p->answer.data[0] == ABORT << 5)
		p->refused++;
}
