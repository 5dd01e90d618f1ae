/* SPDX-License-Identifier: Apache-2.0 */
/*
 * can402_note.c - what the master has to say, from the cycle to the log
 */
#include "can402_bus.h"

#include <stdio.h>

void can402_tell(struct can402 *s, const struct can402_note *n)
{
	const uint32_t put = atomic_load_explicit(&s->put,
						  memory_order_relaxed);

	if (put - atomic_load_explicit(&s->taken, memory_order_acquire) ==
	    CAN402_NOTES)
		return;
	s->notes[put % CAN402_NOTES] = *n;
	atomic_store_explicit(&s->put, put + 1, memory_order_release);
}

/* The first, the second, the fourth ... of its kind: a flood says little. */
static bool is_round(uint32_t n)
{
	return (n & (n - 1)) == 0;
}

void can402_count(struct can402 *s, enum can402_note_kind kind, uint32_t n)
{
	if (is_round(n))
		can402_tell(s, &(struct can402_note) { .kind = kind, .number = n });
}

static void say(const struct can402 *s, const struct can402_note *n, char *buf,
		size_t size)
{
	const char axis = INTERP_AXIS_LETTERS[n->axis];

	switch (n->kind) {
	case NOTE_TROUBLE:
		snprintf(buf, size, "drive %c (node %u) %s", axis, n->node,
			 drive_trouble_name((enum drive_trouble)n->number));
		break;
	case NOTE_ABORT:
		snprintf(buf, size, "drive %c (node %u) refuses object "
			 "%04x:%02x, code %08x", axis, n->node, n->more >> 8,
			 n->more & 0xff, n->number);
		break;
	case NOTE_EMERGENCY:
		snprintf(buf, size, "drive %c (node %u): emergency %04x, its "
			 "%u.", axis, n->node, n->number, n->more);
		break;
	case NOTE_SILENT:
		snprintf(buf, size, "drive %c (node %u) does not answer; is it "
			 "switched on, its node and its bit rate right?", axis,
			 n->node);
		break;
	case NOTE_UP:
		snprintf(buf, size, "drive %c (node %u) is up at %d increments",
			 axis, n->node, (int32_t)n->number);
		break;
	case NOTE_BUS_OFF:
		snprintf(buf, size, "%s: bus off; check cable and termination, "
			 "then: ip link set %s type can restart",
			 s->c.interface, s->c.interface);
		break;
	case NOTE_DOWN:
		snprintf(buf, size, "%s is down; ip link set %s up",
			 s->c.interface, s->c.interface);
		break;
	case NOTE_BACK:
		snprintf(buf, size, "%s is back", s->c.interface);
		break;
	case NOTE_FULL:
		snprintf(buf, size, "%s: %u frames not sent, its queue is full; "
			 "ip link set %s txqueuelen 100", s->c.interface,
			 n->number, s->c.interface);
		break;
	case NOTE_FOREIGN:
		snprintf(buf, size, "%s: another master on the bus, %u frames "
			 "of it", s->c.interface, n->number);
		break;
	default:
		snprintf(buf, size, "%s: %u frames of a wrong length, or answers "
			 "nobody asked for", s->c.interface, n->number);
		break;
	}
}

bool can402_note(void *self, char *buf, size_t size)
{
	struct can402 *s = self;
	const uint32_t taken = atomic_load_explicit(&s->taken,
						    memory_order_relaxed);

	if (taken == atomic_load_explicit(&s->put, memory_order_acquire))
		return false;
	say(s, &s->notes[taken % CAN402_NOTES], buf, size);
	atomic_store_explicit(&s->taken, taken + 1, memory_order_release);
	return true;
}

static void tell_of(struct can402 *s, uint32_t i, struct can402_note n)
{
	n.node = s->drive[i].c.node;
	n.axis = s->axis[i];
	can402_tell(s, &n);
}

static void tell_trouble(struct can402 *s, uint32_t i)
{
	const struct drive *d = &s->drive[i];

	tell_of(s, i, (struct can402_note) { .kind = NOTE_TROUBLE,
				      .number = d->trouble });
	if (d->trouble == DRIVE_MISCONFIGURED)
		tell_of(s, i, (struct can402_note) {
			.kind = NOTE_ABORT, .number = d->abort,
			.more = (uint32_t)d->abort_index << 8 | d->abort_sub
		});
}

void can402_watch(struct can402 *s, uint32_t i)
{
	const struct drive *d = &s->drive[i];
	const struct can402_told was = s->told[i];

	s->told[i] = (struct can402_told) {
		d->phase == DRIVE_RUNNING && d->heard, d->trouble,
		d->emergencies, d->unanswered
	};
	if (s->told[i].up && !was.up)
		tell_of(s, i, (struct can402_note) { .kind = NOTE_UP,
					      .number = (uint32_t)d->actual });
	if (d->trouble != was.trouble && d->trouble != DRIVE_WELL)
		tell_trouble(s, i);
	if (d->emergencies != was.emergencies && is_round(d->emergencies))
		tell_of(s, i, (struct can402_note) { .kind = NOTE_EMERGENCY,
					      .number = d->emergency,
					      .more = d->emergencies });
	if (d->unanswered != was.unanswered && is_round(d->unanswered))
		tell_of(s, i, (struct can402_note) { .kind = NOTE_SILENT });
}
