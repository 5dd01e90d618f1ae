/* SPDX-License-Identifier: Apache-2.0 */
/*
 * can402.c - the master of CiA 402 drives
 *
 * A drive in trouble stops at once.  The other drives keep following their
 * targets while the cycle brakes on the path.  When the bus is off or the
 * interface is down, all drives stop: by a quick stop if they still hear edmd,
 * else because they miss its heartbeat.  Nothing moves again before a reset.
 */
#include "can402_bus.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define GAP_NONE	0xffff
#define RX_MAX		512		/* frames taken in a period: a bus does
					 * not carry more in the longest one */

/* -- The bus -------------------------------------------------------------- */

/* Trouble on the bus stops everything until a reset.  The end of the trouble is
 * reported, and changes nothing. */
static void bus_is(struct can402 *s, enum can_got state)
{
	if (state == s->bus)
		return;
	s->bus = state;
	s->stopped = s->stopped || state != CAN_NOTHING;
	can402_tell(s, &(struct can402_note) {
		.kind = state == CAN_NOTHING ? NOTE_BACK :
			state == CAN_BUS_OFF ? NOTE_BUS_OFF : NOTE_DOWN
	});
}

static void send(struct can402 *s, const struct can_msg *m)
{
	const int err = can_socket_send(s->fd, m);

	if (err == -ENOBUFS)
		can402_count(s, NOTE_FULL, ++s->lost);
	else if (err < 0)
		bus_is(s, CAN_DOWN);
	else if (s->bus == CAN_DOWN)
		bus_is(s, CAN_NOTHING);
}

/* A frame came, so the bus works. */
static void bus_is_back(struct can402 *s)
{
	if (s->bus == CAN_BUS_OFF)
		bus_is(s, CAN_NOTHING);
}

static void hear_gap(struct can402 *s, const struct can_msg *m)
{
	if (m->len != 2 && m->len != 6) {
		can402_count(s, NOTE_MALFORMED, ++s->malformed);
		return;
	}
	/* The sensor says that it has no reading: this counts as no sensor. */
	if (can_get(m->data, 2) == GAP_NONE) {
		s->gap_age = CAN402_STALE;
		return;
	}
	s->gap_v = can_get(m->data, 2) * 0.01;
	s->has_shares = m->len == 6;
	s->shares = (struct io_shares) {
		(float)m->data[2] / 255, (float)m->data[3] / 255,
		(float)m->data[4] / 255, (float)m->data[5] / 255,
	};
	s->gap_age = 0;
}

/* A PLC on this bus may send NMT to all nodes at once, and to each single node
 * that is not a drive. */
static bool is_the_plcs(const struct can402 *s, const struct can_msg *m)
{
	bool drives = false;

	for (uint32_t i = 0; i < s->n; i++)
		drives = drives || m->data[1] == s->drive[i].c.node;
	return m->id == CAN_NMT && s->plc_node > 0 && !drives;
}

/* Only edmd, the master, may send NMT, SYNC, targets and its own heartbeat. */
static bool is_foreign(const struct can402 *s, const struct can_msg *m)
{
	if (is_the_plcs(s, m))
		return false;
	if (m->id == CAN_NMT || m->id == CAN_SYNC ||
	    m->id == CAN_HEARTBEAT + (int)s->c.master_node)
		return true;
	for (uint32_t i = 0; i < s->n; i++) {
		if (m->id == CAN_RPDO1 + s->drive[i].c.node)
			return true;
	}
	return false;
}

/*
 * A command to all nodes may have started drives that are still being set up,
 * and these refuse the rest of the set-up then.  So it begins again.
 */
static void hear_plc(struct can402 *s, const struct can_msg *m)
{
	for (uint32_t i = 0; i < s->n && m->data[1] == 0; i++)
		if (s->drive[i].phase < DRIVE_RUNNING)
			drive_setup_again(&s->drive[i]);
}

static void hear(struct can402 *s, const struct can_msg *m)
{
	if (m->id == CAN_NMT && m->len != 2) {
		can402_count(s, NOTE_MALFORMED, ++s->malformed);
		return;
	}
	if (s->c.gap_id > 0 && m->id == (uint16_t)s->c.gap_id) {
		hear_gap(s, m);
		return;
	}
	if (is_foreign(s, m)) {
		s->foreign_id = m->id;
		can402_count(s, NOTE_FOREIGN, ++s->foreign);
		s->stopped = true;
		return;
	}
	if (m->id == CAN_NMT)
		hear_plc(s, m);
	for (uint32_t i = 0; i < s->n; i++) {
		const uint32_t before = s->drive[i].malformed;

		if (!drive_receive(&s->drive[i], m))
			continue;
		if (s->drive[i].malformed != before)
			can402_count(s, NOTE_MALFORMED, ++s->malformed);
		/* At once: the next emergency replaces the code of this one. */
		can402_watch(s, i);
		return;
	}
}

static void drain(struct can402 *s)
{
	struct can_msg m;

	for (int i = 0; i < RX_MAX; i++) {
		const enum can_got got = can_socket_receive(s->fd, &m);

		if (got == CAN_NOTHING)
			return;
		if (got == CAN_FRAME || got == CAN_RESTARTED)
			bus_is_back(s);
		if (got == CAN_FRAME)
			hear(s, &m);
		else if (got == CAN_ODD)
			can402_count(s, NOTE_MALFORMED, ++s->malformed);
		else if (got >= CAN_WARNING && got <= CAN_TX_OVERFLOW)
			can402_count(s, NOTE_BUS_WARNING + got - CAN_WARNING,
				     ++s->states[got - CAN_WARNING]);
		else if (got != CAN_RESTARTED)
			bus_is(s, got);
		if (got == CAN_DOWN)
			return;
	}
}

/* -- The drives ----------------------------------------------------------- */

static bool all_up(const struct can402 *s)
{
	for (uint32_t i = 0; i < s->n; i++) {
		const struct drive *d = &s->drive[i];

		if (d->phase != DRIVE_RUNNING || !d->stands ||
		    (d->c.reads_inputs && !d->has_inputs))
			return false;
	}
	return true;
}

/* From now on all go where the cycle says; it was told where they begin. */
static bool all_join(struct can402 *s)
{
	for (uint32_t i = 0; i < s->n; i++) {
		const struct drive *d = &s->drive[i];

		if (!drive_is_homing(d) && (d->state != DRIVE_ENABLED ||
		    !d->led || d->goal != DRIVE_GO_ON))
			return false;
	}
	if (can402_brake_opens(s))
		return false;
	for (uint32_t i = 0; i < s->n; i++)
		s->drive[i].joined = true;
	return true;
}

static enum io_trouble trouble(const struct can402 *s)
{
	if (s->stopped)
		return IO_BUS;
	for (uint32_t i = 0; i < s->n; i++) {
		if (s->drive[i].trouble == DRIVE_FOLLOWING)
			return IO_FOLLOWING;
		if (s->drive[i].trouble != DRIVE_WELL)
			return IO_DRIVE;
	}
	return IO_WELL;
}

/*
 * Does any drive still follow its targets?  Then the cycle can brake on the
 * path; a drive in trouble stops by itself.
 */
static bool steers(const struct can402 *s)
{
	bool any = false;

	for (uint32_t i = 0; i < s->n; i++)
		any = any || (s->drive[i].led && s->drive[i].joined &&
			      s->drive[i].trouble == DRIVE_WELL);
	return any && !s->stopped;
}

/*
 * When all drives are heard for the first time, they stand where the machine
 * begins.  A drive that lost its place gets the place that it was sent to last,
 * so that the numbers go on; the cycle was told that this axis is not homed.
 */
static void place(struct can402 *s)
{
	if (!all_up(s))
		return;
	for (uint32_t i = 0; i < s->n; i++) {
		struct drive *d = &s->drive[i];

		if (!s->placed || d->lost)
			drive_set_zero(d, s->out.target[s->axis[i]]);
	}
	s->placed = true;
}

static bool any_lacks(const struct can402 *s)
{
	for (uint32_t i = 0; i < s->n; i++)
		if (drive_lacks_power(&s->drive[i]))
			return true;
	return false;
}

static uint32_t lost_places(const struct can402 *s)
{
	uint32_t axes = 0;

	for (uint32_t i = 0; i < s->n; i++)
		axes |= (uint32_t)s->drive[i].lost << s->axis[i];
	return axes;
}

bool can402_origin(void *self, int32_t ret[IO_NAXES])
{
	const struct can402 *s = self;

	for (uint32_t i = 0; s->placed && i < s->n; i++)
		ret[s->axis[i]] = s->drive[i].zero;
	return s->placed;
}

void can402_originate(void *self, const int32_t zero[IO_NAXES])
{
	struct can402 *s = self;

	for (uint32_t i = 0; i < s->n; i++)
		drive_keep_zero(&s->drive[i], zero[s->axis[i]]);
	s->placed = true;
}

static void beat(struct can402 *s)
{
	const struct can_msg m = {
		.id = (uint16_t)(CAN_HEARTBEAT + (int)s->c.master_node),
		.len = 1, .data = { 0x05 }
	};

	if (s->beat_in-- > 0)
		return;
	s->beat_in = s->beat_every - 1;
	send(s, &m);
}

/* An axis's switches and its e-stop may be wired to its drive. */
static void fill_inputs(const struct can402 *s, uint32_t i,
			struct io_inputs *in)
{
	const struct drive *d = &s->drive[i];
	const uint32_t bit = 1u << s->axis[i];
	bool on[CONFIG_NINPUTS];

	for (int j = 0; j < CONFIG_NINPUTS; j++) {
		const struct config_input *c = &s->input[i][j];

		on[j] = d->has_inputs && c->wired &&
			(d->inputs & c->mask) != c->idle;
	}
	in->limit_low |= on[INPUT_LIMIT_LOW] * bit;
	in->limit_high |= on[INPUT_LIMIT_HIGH] * bit;
	in->limit = in->limit_low | in->limit_high;
	in->home |= on[INPUT_HOME] * bit;
	in->estop = in->estop || on[INPUT_ESTOP];
	in->contact = in->contact || on[INPUT_CONTACT];
}

static void fill(struct can402 *s, struct io_inputs *in, uint32_t unplaced)
{
	*in = (struct io_inputs) {
		.gap_v = s->gap_v,
		.gap_valid = s->c.gap_id > 0 && s->gap_age < CAN402_STALE,
		.shares = s->shares,
		.trouble = trouble(s),
		.starting = !all_up(s),
		.powerless = any_lacks(s),
		.axes_off = !all_join(s), .steers = steers(s),
		.unplaced = unplaced,
		.lost = s->brakes_lost,
	};
	in->shares_valid = in->gap_valid && s->has_shares;
	memcpy(in->actual, s->out.target, sizeof(in->actual));
	memcpy(in->stands_at, s->out.target, sizeof(in->stands_at));
	for (uint32_t i = 0; i < s->n; i++) {
		const struct drive *d = &s->drive[i];
		const uint32_t bit = 1u << s->axis[i];

		fill_inputs(s, i, in);
		/* While it homes its count says nothing of its place. */
		if (drive_is_homing(d)) {
			in->homing |= bit;
			continue;
		}
		in->actual[s->axis[i]] = drive_place(d);
		in->own[s->axis[i]] = drive_own_place(d);
		in->ran_on[s->axis[i]] = s->stop[i].coast;
		in->homed |= (d->homed_now == DRIVE_HOMED) * bit;
		in->unfound |= (d->homed_now == DRIVE_UNFOUND ||
				d->latch == DRIVE_LATCH_FAILED) * bit;
		in->latching |= (d->latch == DRIVE_LATCH_READY) * bit;
		in->latched |= (d->latch == DRIVE_LATCH_KEPT) * bit;
		in->latched_at[s->axis[i]] = drive_latched_at(d);
		if (d->stands && s->placed && !d->lost)
			in->stands_at[s->axis[i]] = drive_stands_at(d);
	}
}

static const struct can_msg sync_frame = { .id = CAN_SYNC };

void can402_read(void *self, struct io_inputs *in)
{
	struct can402 *s = self;
	uint32_t unplaced;

	send(s, &sync_frame);
	if (s->gap_age < CAN402_STALE)
		s->gap_age++;
	drain(s);
	for (uint32_t i = 0; i < s->n; i++) {
		drive_sync(&s->drive[i]);
		can402_watch(s, i);
	}
	unplaced = lost_places(s);
	place(s);
	beat(s);
	fill(s, in, unplaced);
}

/* -- What the cycle wants ------------------------------------------------- */

static void reset(struct can402 *s)
{
	s->stopped = s->bus != CAN_NOTHING;
	for (uint32_t i = 0; i < s->n; i++) {
		drive_reset(&s->drive[i]);
		s->told[i].emergencies = 0;
	}
}

static void tell_drive(struct can402 *s, uint32_t i, enum drive_goal goal)
{
	const bool braking = s->stopping > 0 ||
			     (!s->were_on && s->closing > 0);
	const int32_t target = braking ? can402_stop_target(s, i) :
			       s->out.target[s->axis[i]];
	struct can_msg m[DRIVE_EMITS];
	size_t n;

	drive_home_ask(&s->drive[i], s->out.enable &&
		       s->out.home >> s->axis[i] & 1);
	drive_latch_ask(&s->drive[i], s->out.latch >> s->axis[i] & 1);
	drive_aim(&s->drive[i], goal);
	n = drive_emit(&s->drive[i], target, m);
	for (size_t j = 0; j < n; j++)
		send(s, &m[j]);
}

void can402_write(void *self, const struct io_outputs *out)
{
	struct can402 *s = self;
	bool on;

	s->out = *out;
	if (out->reset)
		reset(s);
	on = can402_stop_step(s, out->enable && !s->stopped);
	on = can402_brake_step(s, on);
	for (uint32_t i = 0; i < s->n; i++)
		tell_drive(s, i, on ? DRIVE_GO_ON : DRIVE_GO_STOP);
}

/* Quick stop, and the drives stop waiting for a heartbeat of edmd. */
static void leave(struct can402 *s)
{
	struct can_msg m[DRIVE_ENDS];

	s->out.enable = s->were_on = false;
	s->stopping = 0;
	can402_write(s, &s->out);
	send(s, &sync_frame);
	for (uint32_t i = 0; i < s->n; i++) {
		const size_t n = drive_setup_end(&s->drive[i], m);

		for (size_t j = 0; j < n; j++)
			send(s, &m[j]);
	}
}

void can402_close(void *self)
{
	struct can402 *s = self;

	leave(s);
	close(s->fd);
	free(s);
}
