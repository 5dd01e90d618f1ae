/* SPDX-License-Identifier: Apache-2.0 */
/*
 * drive.c - one drive: what it says, and what it is told
 *
 * A drive takes a target at the SYNC after it was sent.  Its answer to that
 * SYNC shows where the target before has led.  So the measured place of a drive
 * that is well lies between the last few targets, and the following error is
 * how far it lies outside of them.
 */
#include "drive.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define FAULT_RESET	0x80
#define RESET_MS	1000		/* so long bit 7 goes up and down, */
#define EDGE_MS		20		/* ... and stays for so long */
#define FOLLOWS		0x1000u		/* bits of the statusword in mode 8, */
#define FOLLOWING_ERROR	0x2000u		/* ... not of mode 7 */
#define AT_LIMIT	0x0800u
#define ENABLED		0x0fu		/* controlword */
#define INTERPOLATE	0x10u
#define VOLTAGE		0x0010u
#define POWER_MS	200		/* a drive is ready to switch on after
					 * so long, if it can be */
#define NMT_OPERATIONAL	0x05
#define ALARM_SYNCS	2		/* an answer under way may be older */
#define SURPLUS_MAX	2		/* answers more than SYNCs */

void drive_init(struct drive *d, const struct drive_config *c)
{
	*d = (struct drive) { .c = *c, .goal = DRIVE_GO_OFF };
}

/* What the set-up wrote may be gone, or the drive may not run any more. */
static bool ends_setup(enum drive_trouble t)
{
	return t == DRIVE_REBOOTED || t == DRIVE_MUTE ||
	       t == DRIVE_NO_ANSWER || t == DRIVE_NOT_STARTED;
}

/* The first trouble is reported.  A later one that ends the set-up still counts
 * for the set-up. */
static void trouble(struct drive *d, enum drive_trouble t)
{
	d->unset = d->unset || ends_setup(t);
	if (d->trouble == DRIVE_WELL)
		d->trouble = t;
}

/* -- Places --------------------------------------------------------------- */

/* Rounded down, so that pulses and increments go up and down together. */
static int64_t floor_div(int64_t a, int64_t b)
{
	const int64_t q = a / b;

	return a % b != 0 && (a < 0) != (b < 0) ? q - 1 : q;
}

int32_t drive_to_increments(const struct drive_config *c, int32_t pulses)
{
	return (int32_t)floor_div((int64_t)pulses * c->increments, c->pulses);
}

/* The count of increments wraps at 2^32, as the drive's own number does. */
static int32_t wrapped(int64_t x)
{
	return (int32_t)(uint32_t)(uint64_t)x;
}

/* Rounded. */
static int64_t to_pulses(const struct drive *d, int32_t increments)
{
	const int64_t twice = 2 * (int64_t)increments * d->c.pulses +
			      d->c.increments;

	return floor_div(twice, 2 * (int64_t)d->c.increments);
}

static int32_t place_of(const struct drive *d, int32_t increments)
{
	return (int32_t)to_pulses(d, wrapped((int64_t)increments - d->zero));
}

/* One that does not go into 32 bits must not look like another one. */
int32_t drive_own_place(const struct drive *d)
{
	const int64_t at = to_pulses(d, d->actual);

	return at > INT32_MAX ? INT32_MAX : at < INT32_MIN ? INT32_MIN :
	       (int32_t)at;
}

int32_t drive_latched_at(const struct drive *d)
{
	return place_of(d, d->latch_at);
}

int32_t drive_place(const struct drive *d)
{
	return place_of(d, d->actual);
}

int32_t drive_stands_at(const struct drive *d)
{
	return place_of(d, d->led ? d->target : d->actual);
}

static int64_t in_pulses(const struct drive *d, int64_t increments)
{
	return llabs(increments) * llabs(d->c.pulses) /
	       llabs(d->c.increments);
}

void drive_set_zero(struct drive *d, int32_t pulses)
{
	d->zero = wrapped((int64_t)d->actual -
			  drive_to_increments(&d->c, pulses));
	d->homed = true;
	d->lost = false;
}

void drive_keep_zero(struct drive *d, int32_t zero)
{
	d->zero = zero;
	d->homed = true;
}

/* -- What it says --------------------------------------------------------- */

/* Its count begins anew, and its settings are gone. */
static void hear_restart(struct drive *d)
{
	if (d->homed && !d->c.absolute)
		d->lost = true;
	d->state = DRIVE_NOT_READY;
	d->heard = d->stands = false;
	if (d->phase == DRIVE_RUNNING)
		trouble(d, DRIVE_REBOOTED);
	else if (d->phase < DRIVE_RUNNING)
		drive_setup_again(d);
}

static void hear_fault(struct drive *d)
{
	if (d->resetting == 0)
		trouble(d, DRIVE_EMERGENCY);
	else
		d->resetting--;
}

static void hear_state(struct drive *d, const struct can_msg *m)
{
	const uint16_t was = d->status;
	const uint16_t now = (uint16_t)can_get(m->data, 2);
	const enum drive_state state = drive_state_of(now);

	d->answers++;
	d->strange = state == DRIVE_NO_STATE;
	/* This counts as an answer that was lost: the next answer may make
	 * sense again. */
	if (d->strange) {
		d->malformed++;
		return;
	}
	/* It is in this state only after its power came on. */
	if (state == DRIVE_NOT_READY && d->stands) {
		hear_restart(d);
		return;
	}
	d->status = now;
	d->state = state;
	d->heard = true;
	d->answered = true;
	d->warnings += (now & ~was & DRIVE_WARNS) != 0;
	if (m->len > 6)
		d->mode = m->data[6];
	if (drive_has_place(state)) {
		d->stands = true;
		d->actual = (int32_t)can_get(m->data + 2, 4);
	}
	if (state == DRIVE_FAULT || state == DRIVE_FAULT_REACTION)
		hear_fault(d);
	else
		d->resetting = 0;
}

static void hear_inputs(struct drive *d, const struct can_msg *m)
{
	d->inputs = can_get(m->data, 4);
	d->told_inputs = d->has_inputs = true;
}

static void hear_emergency(struct drive *d, const struct can_msg *m)
{
	struct cia402_emergency *e = &d->history[d->came++ %
						 CIA402_EMERGENCIES];

	d->emergency = (uint16_t)can_get(m->data, 2);
	*e = (struct cia402_emergency) { .code = d->emergency,
		.error_register = m->data[2], .at = d->periods };
	memcpy(e->maker, m->data + 3, sizeof(e->maker));
	if (d->emergency == 0) {
		d->alarmed = 0;
		return;
	}
	d->emergencies++;
	d->alarmed = ALARM_SYNCS;
}

/* State 0 is the boot-up message; only 5 is operational. */
static void hear_heartbeat(struct drive *d, const struct can_msg *m)
{
	const uint8_t state = m->data[0] & 0x7f;

	d->silent = 0;
	if (state == 0)
		hear_restart(d);
	else if (state != NMT_OPERATIONAL && d->phase == DRIVE_RUNNING &&
		 d->heard)
		trouble(d, DRIVE_NOT_STARTED);
}

/* Its TPDO has one byte more if 6061 could be mapped. */
static uint8_t length_of(const struct drive *d, uint16_t id, uint8_t len)
{
	return id == CAN_TPDO1 && d->shows_mode ? (uint8_t)(len + 1) : len;
}

static bool is_pdo(uint16_t id)
{
	return id == CAN_TPDO1 || id == CAN_TPDO2;
}

bool drive_receive(struct drive *d, const struct can_msg *m)
{
	static const struct {
		uint16_t id;
		uint8_t len;
		void (*hear)(struct drive *, const struct can_msg *);
	} kinds[] = {
		{ CAN_TPDO1, 6, hear_state },
		{ CAN_TPDO2, 4, hear_inputs },
		{ CAN_EMCY, 8, hear_emergency },
		{ CAN_HEARTBEAT, 1, hear_heartbeat },
		{ CAN_SDO_ANSWER, 8, drive_setup_receive },
	};

	for (size_t i = 0; i < sizeof(kinds) / sizeof(kinds[0]); i++) {
		if (m->id != kinds[i].id + d->c.node)
			continue;
		if (m->len != length_of(d, kinds[i].id, kinds[i].len))
			d->malformed++;
		else if (!is_pdo(kinds[i].id) || d->phase == DRIVE_RUNNING)
			kinds[i].hear(d, m);
		return true;
	}
	return false;
}

/* -- What did not come ---------------------------------------------------- */

/*
 * The lag of an axis goes away as slowly as it came.  A drive that does not
 * follow targets yet has no lag: its target is the place that it reports.
 */
static void watch_lag(struct drive *d)
{
	const int64_t way = d->led ? llabs(wrapped((int64_t)d->sent[0] -
						   d->sent[1])) : 0;
	const double k = d->c.lag_cycles;
	const double left = k > 0 ? d->lag * k / (k + 1) : 0;

	d->lag = fmax(left, k * (double)way);
}

/* Pulses from the measured place to the nearest of the targets that it may
 * belong to, less @lag increments. */
static int64_t outside(const struct drive *d, int64_t lag)
{
	int64_t low = INT32_MAX, high = INT32_MIN;

	/* Differences from the place are taken, because places wrap at 2^32. */
	for (int i = 0; i < DRIVE_SENT; i++) {
		const int64_t off = wrapped((int64_t)d->sent[i] - d->actual);

		low = off < low ? off : low;
		high = off > high ? off : high;
	}
	low = (low > 0 ? low : high < 0 ? -high : 0) - lag;
	return low > 0 ? in_pulses(d, low) : 0;
}

static void watch_following(struct drive *d)
{
	watch_lag(d);
	if (d->c.following_max > 0 && d->enabled_for > DRIVE_SENT &&
	    outside(d, (int64_t)d->lag) > d->c.following_max)
		trouble(d, DRIVE_FOLLOWING);
}

/*
 * Bit 11 stays on while an axis leaves the limit that it stands on.  Its target
 * is clipped only if it is beside its target and does not go along with it.
 */
static bool is_clipped(const struct drive *d)
{
	const int64_t asked = llabs(wrapped((int64_t)d->sent[0] - d->sent[1]));
	const int64_t left = wrapped((int64_t)d->sent[0] - d->actual);
	const int64_t gone = wrapped((int64_t)d->actual - d->was);

	if (!(d->status & AT_LIMIT) || outside(d, 0) <= 1)
		return false;
	return left * gone <= 0 || 2 * llabs(gone) < asked;
}

bool drive_is_in_mode(const struct drive *d)
{
	return !d->shows_mode || d->mode == drive_mode(&d->c);
}

bool drive_follows(const struct drive *d)
{
	return d->state == DRIVE_ENABLED && drive_is_in_mode(d) &&
	       (d->c.no_follow_bit || d->status & FOLLOWS);
}

/* The bits of mode 8 mean something once the drive has followed. */
static void watch_bits(struct drive *d)
{
	if (drive_follows(d))
		d->led = true;
	else if (d->led || d->enabled_for > d->c.answer_cycles)
		trouble(d, drive_is_in_mode(d) ? DRIVE_NOT_LED :
						 DRIVE_OTHER_MODE);
	if (!d->led)
		return;
	if (d->status & FOLLOWING_ERROR && !d->c.interpolates)
		trouble(d, DRIVE_FOLLOWING);
	d->limited_for = is_clipped(d) ? d->limited_for + 1 : 0;
	if (d->limited_for > d->c.limited_cycles)
		trouble(d, DRIVE_LIMITED);
}

uint32_t drive_cycles(const struct drive *d, uint32_t ms)
{
	const uint32_t n = ms * 1000 / d->c.period_us;

	return n > 0 ? n : 1;
}

bool drive_lacks_power(const struct drive *d)
{
	return d->lacking > drive_cycles(d, POWER_MS);
}

/* A drive that is to have power and could be switched on is watched: if it
 * cannot be any more, it must not go on by itself when it can be again. */
static void watch_power(struct drive *d)
{
	const bool ready = d->state == DRIVE_READY ||
			   d->state == DRIVE_SWITCHED_ON;
	const bool on = d->goal == DRIVE_GO_ON && !d->led;

	d->shows_voltage = d->shows_voltage ||
			   (d->state == DRIVE_READY && d->status & VOLTAGE);
	if (d->state == DRIVE_DISABLED ||
	    (ready && d->shows_voltage && !(d->status & VOLTAGE)))
		d->lacking++;
	else
		d->lacking = 0;
	if (on && d->lacking > 0 && (d->readied || drive_lacks_power(d)))
		trouble(d, DRIVE_POWERLESS);
	d->readied = on && (d->readied || (ready && d->lacking == 0));
}

static void watch_state(struct drive *d)
{
	watch_power(d);
	if (drive_home_step(d))
		return;
	if (d->state == DRIVE_ENABLED) {
		d->enabled_for++;
		if (d->goal == DRIVE_GO_ON)
			watch_bits(d);
		return;
	}
	if (d->enabled_for > 0 && d->goal == DRIVE_GO_ON)
		trouble(d, DRIVE_FELL_OFF);
	d->enabled_for = 0;
	d->limited_for = 0;
	d->led = false;
}

/*
 * Many drives send an emergency for a warning too.  Their statusword tells
 * whether it is a fault, so this must follow at once.
 */
static void watch_alarm(struct drive *d)
{
	if (d->alarmed == 0)
		return;
	d->alarmed--;
	if (!d->answered)
		trouble(d, DRIVE_EMERGENCY);
}

/*
 * Late answers come together, and were missing before.  If there is more than
 * one answer to each SYNC and none was missing, two drives have this node.
 * Answers that never came are forgotten as slowly as they were lost.
 */
static void watch_answers(struct drive *d)
{
	const int32_t owed = (int32_t)d->c.answer_cycles;

	d->surplus += (int32_t)d->answers - 1;
	if (d->surplus < -owed ||
	    (d->answers == 1 && d->surplus < -SURPLUS_MAX))
		d->surplus++;
	if (d->surplus > SURPLUS_MAX)
		trouble(d, DRIVE_TWICE);
	d->answers = 0;
}

void drive_sync(struct drive *d)
{
	d->periods++;
	if (d->phase != DRIVE_RUNNING)
		return;
	watch_answers(d);
	if (++d->silent > d->c.beat_cycles)
		trouble(d, DRIVE_MUTE);
	watch_alarm(d);
	if (d->answered && (d->told_inputs || !d->c.reads_inputs)) {
		d->missing = 0;
		watch_state(d);
		if (!drive_is_homing(d))
			watch_following(d);
	} else if (++d->missing > (d->heard ? d->c.missing_max :
				   d->c.answer_cycles)) {
		/* Its state stays as last heard, so it is sent a quick stop. */
		trouble(d, d->strange ? DRIVE_STRANGE : DRIVE_NO_ANSWER);
	}
	if (d->trouble != DRIVE_WELL)
		drive_home_drop(d);
	d->answered = d->told_inputs = false;
	d->was = d->actual;
	for (int i = DRIVE_SENT - 1; i > 0; i--)
		d->sent[i] = d->sent[i - 1];
	d->sent[0] = d->target;
}

/* -- What it is told ------------------------------------------------------ */

/* Wait for mode 8 before enabling; some drives show it only when enabled. */
static bool waits_for_mode(struct drive *d)
{
	if (d->state != DRIVE_SWITCHED_ON || drive_is_in_mode(d)) {
		d->mode_waited = 0;
		return false;
	}
	return d->mode_waited++ < d->c.answer_cycles;
}

/*
 * A rising edge of bit 7, after an operator's reset only.  Drives look at the
 * controlword more rarely than a SYNC comes, so both levels stay for a while.
 */
static uint16_t fault_word(struct drive *d)
{
	if (d->resetting == 0)
		return 0;
	return d->edge_for++ / drive_cycles(d, EDGE_MS) % 2 ? 0 : FAULT_RESET;
}

/* In mode 7 bit 4 says that targets are to be followed.  In another mode it
 * would begin something else. */
static uint16_t with_interpolation(const struct drive *d, uint16_t word)
{
	return d->c.interpolates && d->state == DRIVE_ENABLED &&
	       word == ENABLED && drive_is_in_mode(d) ?
	       word | INTERPOLATE : word;
}

static uint16_t state_word(struct drive *d)
{
	const bool on = d->goal == DRIVE_GO_ON && d->trouble == DRIVE_WELL;

	if (d->state == DRIVE_FAULT)
		return fault_word(d);
	if (on && drive_is_homing(d))
		return drive_home_control(d);
	if (on && waits_for_mode(d))
		return drive_control(DRIVE_GO_ON, DRIVE_READY);
	/* An axis without a brake would fall if it lost torque in between. */
	if (on && d->c.held && d->state == DRIVE_QUICK_STOP)
		return drive_control(DRIVE_GO_ON, DRIVE_SWITCHED_ON);
	return drive_control(on || d->goal != DRIVE_GO_ON ? d->goal :
			     DRIVE_GO_STOP, d->state);
}

int32_t drive_wanted(const struct drive *d, int32_t target)
{
	return wrapped((int64_t)d->zero + drive_to_increments(&d->c, target));
}

static void aim_at(struct drive *d, int32_t target)
{
	const bool follows = d->led && d->state == DRIVE_ENABLED &&
			     d->homed && !d->lost;

	if (drive_is_homing(d)) {
		d->target = d->actual;
		return;
	}
	d->joined = d->joined && follows && d->goal == DRIVE_GO_ON;
	/* One that is slow to obey a stop still goes to its last target. */
	if (!follows)
		d->target = d->actual;
	else if (d->joined)
		d->target = drive_wanted(d, target);
}

static uint16_t control_word(struct drive *d)
{
	return with_interpolation(d, state_word(d));
}

size_t drive_emit(struct drive *d, int32_t target, struct can_msg *ret)
{
	d->told_pulses = target;
	if (d->phase != DRIVE_RUNNING)
		return drive_setup_emit(d, ret);
	if (!d->heard)
		return 0;
	aim_at(d, target);
	*ret = (struct can_msg) { .id = (uint16_t)(CAN_RPDO1 + d->c.node),
				  .len = 6 };
	can_put(ret->data, control_word(d), 2);
	can_put(ret->data + 2, (uint32_t)d->target, 4);
	return 1 + drive_setup_remode(d, ret + 1);
}

void drive_aim(struct drive *d, enum drive_goal goal)
{
	d->goal = goal;
}

/* Mode 8 is not written then: some drives stop following for that while. */
static bool surely_follows(const struct drive *d)
{
	return drive_follows(d) && (d->shows_mode || !d->c.no_follow_bit);
}

void drive_reset(struct drive *d)
{
	const bool anew = d->unset || d->phase == DRIVE_REFUSED;

	d->trouble = DRIVE_WELL;
	d->emergency = 0;
	d->emergencies = 0;
	d->alarmed = 0;
	d->enabled_for = 0;
	d->missing = 0;
	d->surplus = 0;
	d->silent = 0;
	d->resetting = anew || d->state == DRIVE_FAULT ||
		       d->state == DRIVE_FAULT_REACTION ?
		       drive_cycles(d, RESET_MS) : 0;
	d->edge_for = 0;
	d->busy = 0;
	d->strange = false;
	d->led = false;
	d->mode_wanted = drive_mode(&d->c);
	drive_home_drop(d);
	if (!anew) {
		d->remode = d->phase == DRIVE_RUNNING && !surely_follows(d);
		return;
	}
	drive_setup_again(d);
	d->state = DRIVE_NOT_READY;
	d->heard = d->stands = false;
}
