/* SPDX-License-Identifier: Apache-2.0 */
/*
 * drive_object.c - an object of a drive that somebody asks for, or sets
 *
 * It takes the way of the set-up, one request at a time, so there is one SDO
 * client on the bus.  An object is set with the size that it has: it is read
 * first.
 */
#include "drive.h"
#include "drive_sdo.h"
#include "drive_steps.h"

#include <stdlib.h>

#define TRIES		3
#define STORE		0x1010
#define STORE_WAITS	50		/* times as long, and asked once: a
					 * drive writes its memory */
#define GENERAL_ERROR	0x08000000u

enum object_step {
	STEP_NONE, STEP_GIVE_UP, STEP_READ, STEP_WRITE, STEP_READ_BACK
};

static bool is_there(const struct drive *d)
{
	return d->phase == DRIVE_RUNNING || d->phase == DRIVE_REFUSED;
}

/* Its count has another scale, sign or zero now. */
static bool is_recounted(const struct drive *d)
{
	const int64_t off = (int32_t)((uint32_t)d->actual -
				      (uint32_t)d->object_from);

	return llabs(off) * llabs(d->c.pulses) >
	       (int64_t)d->c.following_max * llabs(d->c.increments);
}

static void end(struct drive *d, enum cia402_end how)
{
	if (d->object_step >= STEP_WRITE && d->homed && is_recounted(d))
		d->lost = true;
	d->object.end = how;
	d->object_step = STEP_NONE;
	d->asked = false;
	d->tries = 0;
}

static enum cia402_end refusal(const struct drive *d,
			       const struct cia402_request *r)
{
	if (!is_there(d))
		return CIA402_NOT_UP;
	if (r->sets && drive_step_owns(d, r->index))
		return CIA402_OWN;
	return r->sets && cia402_has_torque(d->state) ? CIA402_POWERED :
							CIA402_UNDER_WAY;
}

void drive_object_ask(struct drive *d, const struct cia402_request *r)
{
	d->object = (struct cia402_answer) { .of = *r, .end = refusal(d, r) };
	d->object_from = d->actual;
	if (d->object.end == CIA402_UNDER_WAY)
		d->object_step = STEP_READ;
}

static struct drive_write request_of(const struct drive *d)
{
	const struct cia402_request *r = &d->object.of;

	return (struct drive_write) { r->index, r->sub,
				      (uint8_t)d->object.bytes, r->value,
				      false };
}

static bool is_storing(const struct drive *d)
{
	return d->object_step == STEP_WRITE && d->object.of.index == STORE;
}

/* Somebody may have given it power since it was asked. */
static bool is_forbidden(const struct drive *d)
{
	return d->object_step == STEP_WRITE && cia402_has_torque(d->state);
}

/* It has more than four bytes, and the drive waits to send them. */
static size_t give_up(struct drive *d, struct can_msg *ret)
{
	const struct cia402_request *r = &d->object.of;

	*ret = (struct can_msg) { .id = (uint16_t)(CAN_SDO_ASK + d->c.node),
				  .len = 8, .data = { SDO_ABORT } };
	can_put(ret->data + 1, r->index, 2);
	ret->data[3] = r->sub;
	can_put(ret->data + 4, GENERAL_ERROR, 4);
	end(d, CIA402_LONG);
	return 1;
}

size_t drive_object_emit(struct drive *d, struct can_msg *ret)
{
	const uint32_t wait = d->c.answer_cycles *
			      (is_storing(d) ? STORE_WAITS : 1);
	const struct drive_write w = request_of(d);

	if (!d->object_step || (d->asked && d->waited++ < wait))
		return 0;
	if (d->asked && (++d->tries >= TRIES || is_storing(d))) {
		end(d, CIA402_SILENT);
		return 0;
	}
	if (d->object_step == STEP_GIVE_UP)
		return give_up(d, ret);
	if (is_forbidden(d)) {
		end(d, CIA402_POWERED);
		return 0;
	}
	d->asked = true;
	d->waited = 0;
	*ret = d->object_step == STEP_WRITE ? drive_download(d, &w) :
					      drive_upload(d, &w);
	return 1;
}

static void take_value(struct drive *d, const struct can_msg *m)
{
	struct cia402_answer *o = &d->object;
	const uint8_t bytes = drive_sdo_bytes(m);

	o->bytes = bytes;
	o->now = can_get(m->data + 4, bytes);
	if (d->object_step == STEP_READ)
		o->was = o->now;
	if (d->object_step == STEP_READ_BACK || !o->of.sets)
		end(d, CIA402_DONE);
	else
		d->object_step = STEP_WRITE;
}

static void take_answer(struct drive *d, const struct can_msg *m)
{
	const uint8_t what = m->data[0];

	d->tries = 0;
	d->asked = false;
	if (what == SDO_ABORT) {
		d->object.code = can_get(m->data + 4, 4);
		end(d, CIA402_ABORTED);
	} else if (d->object_step == STEP_WRITE) {
		d->object_step = STEP_READ_BACK;
	} else if ((what & SDO_UPLOADED) == SDO_EXPEDITED) {
		take_value(d, m);
	} else {
		d->object_step = STEP_GIVE_UP;
	}
}

bool drive_object_receive(struct drive *d, const struct can_msg *m)
{
	const struct cia402_request *r = &d->object.of;
	const bool writes = d->object_step == STEP_WRITE;
	const uint8_t what = m->data[0];

	if (d->object_step < STEP_READ || !d->asked ||
	    can_get(m->data + 1, 2) != r->index || m->data[3] != r->sub)
		return false;
	if (what != SDO_ABORT && (writes ? what != SDO_STORED :
	    (what & 0xe0) != SDO_SEGMENTED))
		return false;
	take_answer(d, m);
	return true;
}

void drive_object_drop(struct drive *d)
{
	if (d->object_step)
		end(d, CIA402_NOT_UP);
}
