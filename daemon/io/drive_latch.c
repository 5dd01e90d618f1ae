/* SPDX-License-Identifier: Apache-2.0 */
/*
 * drive_latch.c - a drive keeps the place where its index mark passes, by touch
 * probe 1: 60B8, 60B9, 60BA
 *
 * Some drives keep what they stored before until 60B8 was 0, and look at it so
 * seldom that they miss a short 0.  So it is written 0, 60B9 must say so, and
 * only then it is switched on; a mark is new if 60B9 had none after that.  A
 * place that the axis did not pass since then is none.
 */
#include "drive.h"
#include "drive_sdo.h"

#include <stdlib.h>

#define FUNCTION	0x60b8
#define STATUS		0x60b9
#define PLACE		0x60ba
#define INDEX_MARK	0x0015u		/* on; first; zero pulse; rising edge */
#define IS_ON		0x0001u		/* bits of the status */
#define STORED		0x0002u
#define TRIES		3		/* of a request, and of the whole */

enum latch_step {
	STEP_NONE, STEP_OFF, STEP_IS_OFF, STEP_ON, STEP_IS_ON, STEP_WAIT,
	STEP_PLACE, STEP_KEPT, STEP_END,
	NSTEPS
};

/* What each step asks for; those without an object ask for nothing. */
static const struct {
	uint16_t index;
	uint8_t bytes;			/* 0: it is read */
	uint16_t value;
} requests[NSTEPS] = {
	[STEP_OFF]	= { FUNCTION, 2, 0 },
	[STEP_IS_OFF]	= { STATUS, 0, 0 },
	[STEP_ON]	= { FUNCTION, 2, INDEX_MARK },
	[STEP_IS_ON]	= { STATUS, 0, 0 },
	[STEP_WAIT]	= { STATUS, 0, 0 },
	[STEP_PLACE]	= { PLACE, 0, 0 },
	[STEP_END]	= { FUNCTION, 2, 0 },
};

static void go_to(struct drive *d, enum latch_step step)
{
	d->latch_step = step;
	d->latch_for = 0;
}

static void fail(struct drive *d)
{
	d->latch = DRIVE_LATCH_FAILED;
	go_to(d, STEP_END);
}

/* It said this, and that will not do. */
static void refuse(struct drive *d, uint32_t value, uint32_t code)
{
	drive_note_abort(d, &(struct drive_write) {
		requests[d->latch_step].index, 0, 4, value, false
	}, code, DRIVE_NOT_PASSED);
	fail(d);
}

void drive_latch_drop(struct drive *d)
{
	if (d->latch != DRIVE_LATCH_OFF)
		d->latch = DRIVE_LATCH_FAILED;
	d->latch_step = STEP_NONE;
	d->latch_sent = false;
}

void drive_latch_ask(struct drive *d, bool asked)
{
	if (asked && d->latch == DRIVE_LATCH_OFF) {
		d->latch = DRIVE_LATCH_BEGINS;
		d->latch_tries = 0;
		go_to(d, STEP_OFF);
	} else if (!asked && d->latch != DRIVE_LATCH_OFF) {
		d->latch = DRIVE_LATCH_OFF;
		if (d->latch_step)
			go_to(d, STEP_END);
	}
	if (d->latch != DRIVE_LATCH_OFF && (d->phase != DRIVE_RUNNING ||
					    d->trouble != DRIVE_WELL))
		drive_latch_drop(d);
}

static struct drive_write request_of(const struct drive *d)
{
	return (struct drive_write) {
		requests[d->latch_step].index, 0,
		requests[d->latch_step].bytes,
		requests[d->latch_step].value, false
	};
}

/* A mark may be far, a request may not. */
static bool takes_too_long(struct drive *d)
{
	const bool waits = d->latch_step == STEP_WAIT && !d->latch_sent;

	d->latch_for = waits ? 0 : d->latch_for + 1;
	return d->latch_for > TRIES * (d->c.answer_cycles + 1);
}

size_t drive_latch_emit(struct drive *d, struct can_msg *ret)
{
	const struct drive_write w = request_of(d);

	if (w.index == 0)
		return 0;
	if (takes_too_long(d)) {
		d->latch_sent = false;
		if (d->latch_step == STEP_END)
			go_to(d, STEP_NONE);
		else
			refuse(d, d->latch_status, 0);
		return 0;
	}
	if (d->latch_sent && d->waited++ < d->c.answer_cycles)
		return 0;
	d->latch_sent = true;
	d->waited = 0;
	*ret = w.bytes ? drive_download(d, &w) : drive_upload(d, &w);
	return 1;
}

/* What was stored before is still there. */
static void begin_again(struct drive *d)
{
	if (++d->latch_tries < TRIES)
		go_to(d, STEP_OFF);
	else
		refuse(d, d->latch_status, 0);
}

static void hear_status(struct drive *d)
{
	const uint32_t is = d->latch_status;

	if (d->latch_step == STEP_IS_OFF) {
		if (!(is & IS_ON))
			go_to(d, STEP_ON);
	} else if (!(is & IS_ON)) {
		if (d->latch_step == STEP_WAIT)
			refuse(d, is, 0);
	} else if (d->latch_step == STEP_IS_ON && is & STORED) {
		begin_again(d);
	} else if (d->latch_step == STEP_IS_ON) {
		d->latch = DRIVE_LATCH_READY;
		d->latch_from = d->actual;
		go_to(d, STEP_WAIT);
	} else if (is & STORED) {
		go_to(d, STEP_PLACE);
	}
}

/* Was it there since the latch is on?  Counts wrap at 2^32. */
static bool was_passed(const struct drive *d, uint32_t at)
{
	const int64_t gone = (int32_t)((uint32_t)d->actual -
				       (uint32_t)d->latch_from);
	const int64_t off = (int32_t)(at - (uint32_t)d->latch_from);
	const int64_t more = drive_dither(d);

	return off >= (gone < 0 ? gone : 0) - more &&
	       off <= (gone > 0 ? gone : 0) + more;
}

static void hear_place(struct drive *d, uint32_t at)
{
	if (!was_passed(d, at)) {
		refuse(d, at, 0);
		return;
	}
	d->latch_at = (int32_t)at;
	d->latch = DRIVE_LATCH_KEPT;
	go_to(d, STEP_KEPT);
}

static void hear_stored(struct drive *d)
{
	go_to(d, d->latch_step == STEP_END ? STEP_NONE :
		 (enum latch_step)(d->latch_step + 1));
}

bool drive_latch_receive(struct drive *d, const struct can_msg *m)
{
	const struct drive_write w = request_of(d);
	const uint32_t value = can_get(m->data + 4, 4);
	const uint8_t what = m->data[0];

	if (!d->latch_sent || can_get(m->data + 1, 2) != w.index ||
	    m->data[3] != 0 || (what != SDO_ABORT &&
	    (w.bytes ? what != SDO_STORED :
		       (what & SDO_UPLOADED) != SDO_EXPEDITED)))
		return false;
	/* What may pass is asked once more, after a while. */
	if (what == SDO_ABORT && drive_abort_passes(value))
		return true;
	d->latch_sent = false;
	if (what == SDO_ABORT && d->latch_step != STEP_END) {
		refuse(d, value, value);
	} else if (w.bytes || what == SDO_ABORT) {
		hear_stored(d);
	} else if (w.index == STATUS) {
		d->latch_status = value & 0xffff;
		hear_status(d);
	} else {
		hear_place(d, value);
	}
	return true;
}
