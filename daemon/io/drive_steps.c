/* SPDX-License-Identifier: Apache-2.0 */
/*
 * drive_steps.c - the table of all steps of the set-up
 */
#include "drive_steps.h"

#define PDO_OFF		0x80000000u
#define PDO_EXTENDED	0x20000000u
#define PDO_ID		0x1fffffffu
#define SYNC_PRODUCES	0x40000000u
#define EVERY_SYNC	1
#define PROFILE_402	0x0192u
#define MODE_BIT(mode)	(1u << ((mode) - 1))	/* of the supported modes */
#define MODE_HOMING	6

enum what {
	/* Reads. */
	IS_402, HAS_MODES, IDENTITY,
	WAS_ON,				/* is our node still in it? */
	COB_READ,			/* of a PDO, for the next steps */
	SYNC_READ, COUNTER_READ,
	INDEX_READ,			/* of interpolation time */
	INDEX_CHECK, VALUE_CHECK,
	STILL_ON,			/* was it switched off meanwhile? */
	LAST_READ = STILL_ON,
	/* Writes. */
	NUMBER,				/* the number beside it */
	BEAT_MS,			/* time between its heartbeats */
	MASTER_BEAT,			/* whose heartbeat it watches */
	COB_OFF,			/* the same identifier, disabled */
	COB_RPDO, COB_TPDO,		/* another identifier, if need be */
	COB_RPDO_ON, COB_TPDO_ON,
	INPUTS,				/* its digital inputs, ... */
	COB_INPUTS, COB_INPUTS_ON,	/* ... in TPDO2 */
	MODE_MAPPED,			/* it can send 6061 */
	TPDO_COUNT,
	SYNC_ID,			/* if it is not 080 */
	CYCLE_OFF, COUNTER_OFF,		/* if it expects counted SYNCs */
	CYCLE_US,
	TARGET,				/* the object that it follows */
	MODE, SUB_MODE,			/* sub-mode: one point at a time */
	FILE_WRITES,			/* those of the machine file */
	LATCH_OFF,			/* touch probe, if it is used */
	TIME_INDEX, TIME_VALUE,		/* interpolation: value * 10^index s */
};

struct row {
	uint16_t index;
	uint8_t sub, bytes;
	enum what what;
	uint32_t number;
	bool may_miss;
};

#define OTHER_PDO(at) \
	{ at, 1, 4, COB_READ,    0,          true }, \
	{ at, 1, 4, COB_OFF,     0,          true }

/* clang-format off */
static const struct row rows[] = {
	{ 0x1000, 0, 4, IS_402,      0,          false },
	{ 0x6502, 0, 4, HAS_MODES,   0,          true },
	{ 0x1018, 1, 4, IDENTITY,    0,          false },
	{ 0x1018, 2, 4, IDENTITY,    1,          false },
	{ 0x1018, 3, 4, IDENTITY,    2,          false },
	{ 0x1018, 4, 4, IDENTITY,    3,          false },
	{ 0x1016, 1, 4, WAS_ON,      0,          false },
	{ 0x1017, 0, 2, BEAT_MS,     0,          false },
	{ 0x1016, 1, 4, MASTER_BEAT, 0,          false },
	{ 0x1005, 0, 4, SYNC_READ,   0,          true },
	{ 0x1005, 0, 4, SYNC_ID,     CAN_SYNC,   true },
	{ 0x1019, 0, 1, COUNTER_READ, 0,         true },
	{ 0x1006, 0, 4, CYCLE_OFF,   0,          true },
	{ 0x1019, 0, 1, COUNTER_OFF, 0,          true },
	{ 0x1006, 0, 4, CYCLE_US,    0,          true },
	{ 0x1007, 0, 4, NUMBER,      0,          true },
	{ 0x1400, 1, 4, COB_READ,    0,          false },
	{ 0x1400, 1, 4, COB_OFF,     0,          false },
	{ 0x1400, 1, 4, COB_RPDO,    0,          false },
	{ 0x1400, 2, 1, NUMBER,      EVERY_SYNC, false },
	{ 0x1600, 0, 1, NUMBER,      0,          false },
	{ 0x1600, 1, 4, NUMBER,      0x60400010, false },
	{ 0x1600, 2, 4, TARGET,      0,          false },
	{ 0x1600, 0, 1, NUMBER,      2,          false },
	{ 0x1400, 1, 4, COB_RPDO_ON, 0,          false },
	{ 0x1800, 1, 4, COB_READ,    0,          false },
	{ 0x1800, 1, 4, COB_OFF,     0,          false },
	{ 0x1800, 1, 4, COB_TPDO,    0,          false },
	{ 0x1800, 2, 1, NUMBER,      EVERY_SYNC, false },
	{ 0x1a00, 0, 1, NUMBER,      0,          false },
	{ 0x1a00, 1, 4, NUMBER,      0x60410010, false },
	{ 0x1a00, 2, 4, NUMBER,      0x60640020, false },
	{ 0x1a00, 3, 4, MODE_MAPPED, 0x60610008, true },
	{ 0x1a00, 0, 1, TPDO_COUNT,  0,          false },
	{ 0x1800, 1, 4, COB_TPDO_ON, 0,          false },
	OTHER_PDO(0x1401), OTHER_PDO(0x1402), OTHER_PDO(0x1403),
	OTHER_PDO(0x1404), OTHER_PDO(0x1405), OTHER_PDO(0x1406),
	OTHER_PDO(0x1407),
	OTHER_PDO(0x1801),
	{ 0x1801, 1, 4, COB_INPUTS,  0,          false },
	{ 0x1801, 2, 1, INPUTS,      EVERY_SYNC, false },
	{ 0x1a01, 0, 1, INPUTS,      0,          false },
	{ 0x1a01, 1, 4, INPUTS,      0x60fd0020, false },
	{ 0x1a01, 0, 1, INPUTS,      1,          false },
	{ 0x1801, 1, 4, COB_INPUTS_ON, 0,        false },
	OTHER_PDO(0x1802), OTHER_PDO(0x1803),
	OTHER_PDO(0x1804), OTHER_PDO(0x1805), OTHER_PDO(0x1806),
	OTHER_PDO(0x1807),
	{ 0x60b8, 0, 2, LATCH_OFF,   0,          false },
	{ 0,      0, 0, FILE_WRITES, 0,          false },
	{ 0x60c2, 2, 1, INDEX_READ,  0,          false },
	{ 0x60c2, 2, 1, TIME_INDEX,  0,          false },
	{ 0x60c2, 1, 1, TIME_VALUE,  0,          false },
	{ 0x60c2, 2, 1, INDEX_CHECK, 0,          false },
	{ 0x60c2, 1, 1, VALUE_CHECK, 0,          false },
	{ 0x60c0, 0, 2, SUB_MODE,    0,          true },
	{ 0x6060, 0, 1, MODE,        0,          false },
	{ 0x1016, 1, 4, STILL_ON,    0,          false },
};
/* clang-format on */

#define NROWS		(sizeof(rows) / sizeof(rows[0]))

/* -- Where we are: rows before the machine file's, those, rows behind ----- */

static uint32_t file_row(void)
{
	uint32_t i = 0;

	while (rows[i].what != FILE_WRITES)
		i++;
	return i;
}

/* NULL: write *ret_file of the machine file, or (UINT32_MAX) past the end. */
static const struct row *row_at(const struct drive *d, uint32_t step,
				uint32_t *ret_file)
{
	const uint32_t first = file_row(), n = d->c.nwrites;

	*ret_file = UINT32_MAX;
	if (step < first)
		return &rows[step];
	if (step < first + n) {
		*ret_file = step - first;
		return NULL;
	}
	step = step - n + 1;
	return step < NROWS ? &rows[step] : NULL;
}

/* -- Interpolation time --------------------------------------------------- */

#define NCHOICES	5		/* the drive's own, then ms ... us */

/* The period as value * 10^index s, one byte; 0: it does not fit. */
static uint32_t time_value(uint32_t period_us, int index)
{
	uint32_t unit = 1;

	for (int i = -6; i < index; i++)
		unit *= 10;
	return index < -6 || index > -3 || period_us % unit != 0 ||
	       period_us / unit > 255 ? 0 : period_us / unit;
}

/* First the drive's own index, because many drives allow no other. */
static int choice_index(const struct drive *d)
{
	return d->choice == 0 ? (int8_t)d->time_index : -2 - (int)d->choice;
}

bool drive_step_choose(struct drive *d)
{
	uint32_t file;

	d->choice++;
	while (d->choice < NCHOICES &&
	       (time_value(d->c.period_us, choice_index(d)) == 0 ||
		choice_index(d) == (int8_t)d->time_index))
		d->choice++;
	if (d->choice >= NCHOICES)
		return false;
	for (d->step = 0; ; d->step++) {
		const struct row *r = row_at(d, d->step, &file);

		if (r && r->what == TIME_INDEX)
			return true;
	}
}

/* -- Which steps are due -------------------------------------------------- */

static bool is_left(const struct drive *d, uint16_t index)
{
	for (uint32_t i = 0; i < d->c.nleaves; i++)
		if (d->c.leave[i] == index)
			return true;
	return false;
}

static uint32_t own_id(const struct drive *d, enum what what)
{
	return (what == COB_RPDO || what == COB_RPDO_ON ? CAN_RPDO1 :
		what == COB_TPDO || what == COB_TPDO_ON ? CAN_TPDO1 :
		CAN_TPDO2) + (uint32_t)d->c.node;
}

static bool has_another_id(const struct drive *d, enum what what)
{
	return (d->word & PDO_ID) != own_id(d, what) || d->word & PDO_EXTENDED;
}

static bool is_due(const struct drive *d, const struct row *r)
{
	if (is_left(d, r->index))
		return false;
	switch (r->what) {
	case IDENTITY:
		return d->c.identified >> r->number & 1;
	case COB_OFF:
		return !(d->word & PDO_OFF);
	case COB_RPDO:
	case COB_TPDO:
		return has_another_id(d, r->what);
	case COB_INPUTS:
		return d->c.reads_inputs && has_another_id(d, r->what);
	case INPUTS:
	case COB_INPUTS_ON:
		return d->c.reads_inputs;
	case SYNC_ID:
		return (d->word & PDO_ID) != CAN_SYNC ||
		       d->word & (SYNC_PRODUCES | PDO_EXTENDED);
	case CYCLE_OFF:
	case COUNTER_OFF:
		return d->word != 0;
	case SUB_MODE:
		return d->c.interpolates;
	case LATCH_OFF:
		return d->c.latches;
	default:
		return true;
	}
}

static uint32_t value_of(const struct drive *d, const struct row *r)
{
	const struct drive_config *c = &d->c;
	const uint32_t cob = d->word & ~(PDO_OFF | PDO_EXTENDED | PDO_ID);

	switch (r->what) {
	case BEAT_MS:
		return c->heartbeat_ms;
	case MASTER_BEAT:
		return (uint32_t)c->master << 16 | c->heartbeat_ms * 5 / 2;
	case COB_OFF:
		return d->word | PDO_OFF;
	case COB_RPDO:
	case COB_TPDO:
	case COB_INPUTS:
		return PDO_OFF | cob | own_id(d, r->what);
	case COB_RPDO_ON:
	case COB_TPDO_ON:
	case COB_INPUTS_ON:
		return cob | own_id(d, r->what);
	case TPDO_COUNT:
		return 2 + d->shows_mode;
	case CYCLE_US:
		return c->period_us;
	case TARGET:
		return c->interpolates ? 0x60c10120 : 0x607a0020;
	case MODE:
		return drive_mode(c);
	case TIME_INDEX:
		return (uint32_t)choice_index(d);
	case TIME_VALUE:
		return time_value(c->period_us, choice_index(d));
	default:
		return r->number;
	}
}

static struct drive_step step_of(const struct drive *d, const struct row *r)
{
	const uint8_t bytes = d->bytes > 0 && d->sized == d->step ? d->bytes :
			      r->bytes;

	return (struct drive_step) {
		.write = { r->index, r->sub, bytes,
			   value_of(d, r) & UINT32_MAX >> (32 - 8 * bytes),
			   r->may_miss },
		.what = (uint8_t)r->what,
		.reads = r->what <= LAST_READ,
		.has_choice = r->what == TIME_INDEX || r->what == TIME_VALUE ||
			      r->what == INDEX_CHECK ||
			      r->what == VALUE_CHECK,
		.kept = r->what == TIME_INDEX && d->choice == 0,
	};
}

bool drive_step_due(struct drive *d, struct drive_step *ret)
{
	for (;; d->step++) {
		uint32_t file;
		const struct row *r = row_at(d, d->step, &file);

		if (r && is_due(d, r)) {
			*ret = step_of(d, r);
			return true;
		}
		if (!r && file == UINT32_MAX)
			return false;
		if (!r && !is_left(d, d->c.write[file].index)) {
			*ret = (struct drive_step) {
				.write = d->c.write[file], .what = NUMBER
			};
			return true;
		}
	}
}

/* -- What came of them ---------------------------------------------------- */

static bool names_us(const struct drive *d)
{
	return (d->word >> 16 & 0x7f) == d->c.master;
}

/* If it was switched off since the last set-up, its count is another one. */
static void heed_memory(struct drive *d)
{
	if (d->homed && !names_us(d) && !d->c.absolute)
		d->lost = true;
}

bool drive_step_forgets(const struct drive_step *s)
{
	return s->what == BEAT_MS || s->what == MASTER_BEAT;
}

bool drive_step_finds_restart(const struct drive *d, const struct drive_step *s)
{
	return s->what == STILL_ON && !names_us(d);
}

static bool interpolates(const struct drive *d)
{
	return d->word != 0 &&
	       d->word == time_value(d->c.period_us, (int8_t)d->time_index);
}

bool drive_step_fits(struct drive *d, const struct drive_step *s)
{
	switch ((enum what)s->what) {
	case IS_402:
		return (d->word & 0xffff) == PROFILE_402;
	case HAS_MODES:
		return d->word & MODE_BIT(drive_mode(&d->c)) &&
		       (!d->c.homes || d->word & MODE_BIT(MODE_HOMING));
	case IDENTITY:
		return d->word == d->c.identity[s->write.sub - 1];
	case WAS_ON:
		heed_memory(d);
		return true;
	case INDEX_READ:
		d->time_index = (int8_t)d->word;
		d->choice = 0;
		if (time_value(d->c.period_us, d->time_index) == 0)
			d->choice = 1;
		while (d->choice > 0 && d->choice < NCHOICES &&
		       time_value(d->c.period_us, choice_index(d)) == 0)
			d->choice++;
		return d->choice < NCHOICES;
	case INDEX_CHECK:
		d->time_index = (int8_t)d->word;
		return true;
	case VALUE_CHECK:
		return interpolates(d);
	default:
		return true;
	}
}

void drive_step_done(struct drive *d, const struct drive_step *s)
{
	if (s->what == MODE_MAPPED)
		d->shows_mode = true;
	d->step++;
}

void drive_step_missing(struct drive *d, const struct drive_step *s)
{
	uint32_t file;
	const struct row *r = row_at(d, d->step, &file);

	if (s->what == COUNTER_READ)
		d->word = 0;
	/* Here only this entry or value is missing, not the whole object. */
	if (!r || s->what == MODE_MAPPED || s->what == COUNTER_READ ||
	    s->what == CYCLE_OFF) {
		d->step++;
		return;
	}
	while (r && r->index == s->write.index)
		r = row_at(d, ++d->step, &file);
}

/* What the machine file leaves to somebody else may be written. */
bool drive_step_owns(const struct drive *d, uint16_t index)
{
	bool owns = index == 0x6040 || index == 0x607a || index == 0x60c1;

	for (size_t i = 0; i < NROWS; i++)
		owns = owns || (rows[i].index == index &&
				rows[i].what > LAST_READ);
	for (uint32_t i = 0; i < d->c.nwrites; i++)
		owns = owns || d->c.write[i].index == index;
	return owns && !is_left(d, index);
}
