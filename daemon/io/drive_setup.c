/* SPDX-License-Identifier: Apache-2.0 */
/*
 * drive_setup.c - bring a drive up by SDO, as a table of steps
 *
 * Expedited transfers of CiA 301, one in flight, in state pre-operational:
 * what PDOs carry may not change while they flow.  A step that is not answered
 * is repeated; after SETUP_TRIES the drive is asked from the first one on, so
 * that one which is switched on later is found.
 */
#include "drive.h"

#define SETUP_TRIES	3

#define NMT_START	0x01
#define NMT_QUIET	0x80		/* pre-operational */

#define SDO_UPLOAD	0x40
#define SDO_STORED	0x60
#define SDO_ABORT	0x80

#define PDO_OFF		0x80000000u
#define PDO_NO_RTR	0x40000000u
#define EVERY_SYNC	1
#define MODE_CSP	8
#define PROFILE_402	0x0192u
#define CSP_BIT		0x80u		/* of the supported modes */
#define ABORT_STOPS	3		/* quick stop, when we are lost */

/* What a step writes. */
enum what {
	IS_402,				/* reads, and looks for the profile, */
	HAS_CSP,			/* ... or for the mode */
	NUMBER,				/* the number beside it */
	BEAT_MS,			/* how often it is to be heard */
	MASTER_BEAT,			/* whose heartbeat it is to miss */
	RPDO_OFF, RPDO_ON, TPDO_OFF, TPDO_ON,
	TIME_VALUE, TIME_INDEX,		/* of interpolation: value * 10^index s */
};

struct step {
	uint16_t index;
	uint8_t sub, bytes;
	enum what what;
	uint32_t number;
	bool may_miss;			/* a drive may not have it */
};

/* clang-format off */
static const struct step steps[] = {
	{ 0x1000, 0, 4, IS_402,      0,          false },
	{ 0x6502, 0, 4, HAS_CSP,     0,          true },
	{ 0x1017, 0, 2, BEAT_MS,     0,          false },
	{ 0x1016, 1, 4, MASTER_BEAT, 0,          true },
	{ 0x1400, 1, 4, RPDO_OFF,    0,          false },
	{ 0x1400, 2, 1, NUMBER,      EVERY_SYNC, false },
	{ 0x1600, 0, 1, NUMBER,      0,          false },
	{ 0x1600, 1, 4, NUMBER,      0x60400010, false },
	{ 0x1600, 2, 4, NUMBER,      0x607a0020, false },
	{ 0x1600, 0, 1, NUMBER,      2,          false },
	{ 0x1400, 1, 4, RPDO_ON,     0,          false },
	{ 0x1800, 1, 4, TPDO_OFF,    0,          false },
	{ 0x1800, 2, 1, NUMBER,      EVERY_SYNC, false },
	{ 0x1a00, 0, 1, NUMBER,      0,          false },
	{ 0x1a00, 1, 4, NUMBER,      0x60410010, false },
	{ 0x1a00, 2, 4, NUMBER,      0x60640020, false },
	{ 0x1a00, 0, 1, NUMBER,      2,          false },
	{ 0x1800, 1, 4, TPDO_ON,     0,          false },
	{ 0x1401, 1, 4, NUMBER,      PDO_OFF,    true },
	{ 0x1402, 1, 4, NUMBER,      PDO_OFF,    true },
	{ 0x1403, 1, 4, NUMBER,      PDO_OFF,    true },
	{ 0x1801, 1, 4, NUMBER,      PDO_OFF,    true },
	{ 0x1802, 1, 4, NUMBER,      PDO_OFF,    true },
	{ 0x1803, 1, 4, NUMBER,      PDO_OFF,    true },
	{ 0x6007, 0, 2, NUMBER,      ABORT_STOPS, true },
	{ 0x6060, 0, 1, NUMBER,      MODE_CSP,   false },
	{ 0x60c2, 1, 1, TIME_VALUE,  0,          true },
	{ 0x60c2, 2, 1, TIME_INDEX,  0,          true },
};
/* clang-format on */

#define NSTEPS	(sizeof(steps) / sizeof(steps[0]))

/* The period as value * 10^index seconds, value one byte: 2, -3 is 2 ms. */
static void interpolation_time(uint32_t period_us, uint32_t *value, int *index)
{
	*value = period_us;
	*index = -6;
	while (*value > 255 || (*value % 10 == 0 && *index < -3)) {
		*value /= 10;
		(*index)++;
	}
}

static uint32_t number_of(const struct drive *d, const struct step *s)
{
	const struct drive_config *c = &d->c;
	uint32_t value;
	int index;

	interpolation_time(c->period_us, &value, &index);
	switch (s->what) {
	case BEAT_MS:
		return c->heartbeat_ms;
	case MASTER_BEAT:
		return (uint32_t)c->master << 16 | c->heartbeat_ms * 5 / 2;
	case RPDO_OFF:
		return PDO_OFF | (CAN_RPDO1 + (uint32_t)c->node);
	case RPDO_ON:
		return CAN_RPDO1 + (uint32_t)c->node;
	case TPDO_OFF:
		return PDO_OFF | PDO_NO_RTR | (CAN_TPDO1 + (uint32_t)c->node);
	case TPDO_ON:
		return PDO_NO_RTR | (CAN_TPDO1 + (uint32_t)c->node);
	case TIME_VALUE:
		return value;
	case TIME_INDEX:
		return (uint8_t)index;
	default:
		return s->number;
	}
}

/* Expedited, with its size: CiA 301. */
static struct can_msg download(const struct drive *d, const struct step *s,
			       uint32_t number)
{
	struct can_msg m = { .id = (uint16_t)(CAN_SDO_ASK + d->c.node),
			     .len = 8 };

	m.data[0] = (uint8_t)(0x23 | (4 - s->bytes) << 2);
	can_put(m.data + 1, s->index, 2);
	m.data[3] = s->sub;
	can_put(m.data + 4, number, s->bytes);
	return m;
}

static bool reads(const struct step *s)
{
	return s->what == IS_402 || s->what == HAS_CSP;
}

static struct can_msg request(const struct drive *d, const struct step *s)
{
	struct can_msg m = download(d, s, 0);

	if (!reads(s))
		return download(d, s, number_of(d, s));
	m.data[0] = SDO_UPLOAD;
	return m;
}

static struct can_msg nmt(const struct drive *d, uint8_t command)
{
	return (struct can_msg) { .id = CAN_NMT, .len = 2,
				  .data = { command, d->c.node } };
}

void drive_setup_again(struct drive *d)
{
	d->phase = DRIVE_SILENT;
	d->step = d->tries = 0;
	d->quiet = d->asked = false;
}

size_t drive_setup_end(const struct drive *d, struct can_msg *ret)
{
	static const struct step beat = { 0x1016, 1, 4, MASTER_BEAT, 0, true };

	if (d->phase == DRIVE_SILENT)
		return 0;
	ret[0] = download(d, &beat, 0);
	ret[1] = nmt(d, NMT_QUIET);
	return DRIVE_ENDS;
}

size_t drive_setup_emit(struct drive *d, struct can_msg *ret)
{
	if (d->phase == DRIVE_REFUSED)
		return 0;
	if (!d->quiet) {
		d->quiet = true;
		*ret = nmt(d, NMT_QUIET);
		return 1;
	}
	if (d->step == NSTEPS) {
		d->phase = DRIVE_RUNNING;
		d->silent = 0;
		d->missing = 0;
		d->heard = false;
		*ret = nmt(d, NMT_START);
		return 1;
	}
	if (d->asked && d->waited++ < d->c.answer_cycles)
		return 0;
	if (d->asked && ++d->tries >= SETUP_TRIES) {
		d->unanswered++;
		drive_setup_again(d);
		return 0;
	}
	d->asked = true;
	d->waited = 0;
	*ret = request(d, &steps[d->step]);
	return 1;
}

static void refuse(struct drive *d, const struct step *s, uint32_t code)
{
	d->phase = DRIVE_REFUSED;
	d->abort = code;
	d->abort_index = s->index;
	d->abort_sub = s->sub;
	if (d->trouble == DRIVE_WELL)
		d->trouble = DRIVE_MISCONFIGURED;
}

static bool is_answer(const struct drive *d, const struct step *s,
		      const struct can_msg *m)
{
	if (!d->asked || can_get(m->data + 1, 2) != s->index ||
	    m->data[3] != s->sub)
		return false;
	if (m->data[0] == SDO_ABORT)
		return true;
	return reads(s) ? (m->data[0] & 0xe0) == SDO_UPLOAD :
			  m->data[0] == SDO_STORED;
}

/* What was read is what a drive must have. */
static bool is_fit(const struct step *s, uint32_t word)
{
	return s->what == IS_402 ? (word & 0xffff) == PROFILE_402 :
	       s->what == HAS_CSP ? (word & CSP_BIT) != 0 : true;
}

void drive_setup_receive(struct drive *d, const struct can_msg *m)
{
	const struct step *s = &steps[d->step < NSTEPS ? d->step : 0];
	uint32_t word;

	if (d->phase > DRIVE_CONFIGURED_NEXT || d->step >= NSTEPS ||
	    !is_answer(d, s, m)) {
		d->malformed++;
		return;
	}
	word = can_get(m->data + 4, 4);
	if (m->data[0] == SDO_ABORT ? !s->may_miss : !is_fit(s, word)) {
		refuse(d, s, word);
		return;
	}
	d->phase = DRIVE_CONFIGURED_NEXT;
	d->step++;
	d->tries = 0;
	d->asked = false;
}
