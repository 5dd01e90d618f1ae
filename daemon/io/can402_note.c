/* SPDX-License-Identifier: Apache-2.0 */
/*
 * can402_note.c - what the cycle sees on the bus, as lines of the log
 */
#include "can402_bus.h"

#include <stdio.h>
#include <string.h>

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

/* The first, second, fourth, eighth ...: a flood makes few lines. */
static bool is_round(uint32_t n)
{
	return (n & (n - 1)) == 0;
}

void can402_count(struct can402 *s, enum can402_note_kind kind, uint32_t n)
{
	if (is_round(n))
		can402_tell(s, &(struct can402_note) {
			.kind = kind, .number = n, .more = s->foreign_id
		});
}

static void say_drive(const struct can402_note *n, char *buf, size_t size)
{
	const char axis = INTERP_AXIS_LETTERS[n->axis];
	const unsigned int index = n->more >> 8, sub = n->more & 0xff;
	static const char *const passed[] = {
		[DRIVE_NOT_PASSED] = "refused",
		[DRIVE_WITHOUT] = "goes on without",
		[DRIVE_ALREADY] = "it has that already",
		[DRIVE_ANOTHER] = "another is tried",
		[DRIVE_LATER] = "asked again",
	};

	switch (n->kind) {
	case NOTE_TROUBLE:
		snprintf(buf, size, "drive %c (node %u) %s", axis, n->node,
			 cia402_trouble_name(n->number));
		break;
	case NOTE_ABORT:
		if (n->number != 0)
			snprintf(buf, size, "drive %c (node %u) refuses object "
				 "%04x:%02x, value %x, code %08x: %s", axis,
				 n->node, index, sub, n->value, n->number,
				 cia402_abort_text(n->number));
		else
			snprintf(buf, size, "drive %c (node %u): object "
				 "%04x:%02x is %x, which does not go with the "
				 "machine file", axis, n->node, index, sub,
				 n->value);
		break;
	case NOTE_PASSED:
		snprintf(buf, size, "drive %c (node %u): object %04x:%02x, "
			 "value %x, code %08x: %s; %s", axis, n->node, index,
			 sub, n->value, n->number,
			 n->number ? cia402_abort_text(n->number) : "not ours",
			 passed[n->passed]);
		break;
	case NOTE_EMERGENCY:
		snprintf(buf, size, "drive %c (node %u): emergency %04x, its "
			 "%u.: %s; register %02x, the maker's field %02x %02x "
			 "%02x %02x %02x", axis, n->node, n->number, n->more,
			 cia402_emergency_text((uint16_t)n->number), n->value,
			 n->maker[0], n->maker[1], n->maker[2], n->maker[3],
			 n->maker[4]);
		break;
	case NOTE_SILENT:
		snprintf(buf, size, "drive %c (node %u) does not answer; is it "
			 "switched on, its node and its bit rate right?", axis,
			 n->node);
		break;
	case NOTE_LOST:
		snprintf(buf, size, "drive %c (node %u) was switched off: its "
			 "place is lost; end the job, then edmctl home %c",
			 axis, n->node, axis);
		break;
	case NOTE_WARNING:
		snprintf(buf, size, "drive %c (node %u) warns: statusword "
			 "%04x%s%s", axis, n->node, n->number,
			 n->number & 0x80 ? ", bit 7: a warning of the maker" :
					    "",
			 n->number & 0x800 ? ", bit 11: at an internal limit" :
					     "");
		break;
	case NOTE_UNMAPPED:
		snprintf(buf, size, "drive %c (node %u) does not send its mode "
			 "(6061): another mode is seen by bit 12 only", axis,
			 n->node);
		break;
	default:
		snprintf(buf, size, "drive %c (node %u) is up at %d increments",
			 axis, n->node, (int32_t)n->number);
		break;
	}
}

static void say_bus(const struct can402 *s, const struct can402_note *n,
		    char *buf, size_t size)
{
	const char *name = s->c.interface;

	switch (n->kind) {
	case NOTE_BUS_OFF:
		snprintf(buf, size, "%s: bus off; check cable and termination, "
			 "then: ip link set %s type can restart", name, name);
		break;
	case NOTE_BUS_WARNING:
		snprintf(buf, size, "%s: many errors on the bus (error "
			 "warning, %u times); check cable and termination",
			 name, n->number);
		break;
	case NOTE_BUS_PASSIVE:
		snprintf(buf, size, "%s: the controller is error passive (%u "
			 "times); bus off is next; check cable, termination "
			 "and bit rate", name, n->number);
		break;
	case NOTE_BUS_ACTIVE:
		snprintf(buf, size, "%s: the controller is error active again "
			 "(%u times): few errors", name, n->number);
		break;
	case NOTE_RX_OVERFLOW:
		snprintf(buf, size, "%s: the controller lost frames that came, "
			 "%u times; it was not read in time: give its "
			 "interrupt a higher priority", name, n->number);
		break;
	case NOTE_TX_OVERFLOW:
		snprintf(buf, size, "%s: the controller lost frames that it "
			 "was to send, %u times; a longer period, or fewer "
			 "nodes", name, n->number);
		break;
	case NOTE_DOWN:
		snprintf(buf, size, "%s is down; ip link set %s up", name,
			 name);
		break;
	case NOTE_BACK:
		snprintf(buf, size, "%s is back", name);
		break;
	case NOTE_FULL:
		snprintf(buf, size, "%s: %u frames not sent, its queue is "
			 "full; nobody takes them, or ip link set %s "
			 "txqueuelen 100", name, n->number, name);
		break;
	case NOTE_FOREIGN:
		snprintf(buf, size, "%s: another master on the bus, %u frames "
			 "of it, the last has identifier %03x; end it%s", name,
			 n->number, n->more, n->more > CAN_HEARTBEAT ?
			 ", or give master_node another number" : "");
		break;
	default:
		snprintf(buf, size, "%s: %u frames of a wrong length, "
			 "statuswords that are no state, or answers nobody "
			 "asked for", name, n->number);
		break;
	}
}

static void say(const struct can402 *s, const struct can402_note *n, char *buf,
		size_t size)
{
	if (n->node != 0)
		say_drive(n, buf, size);
	else
		say_bus(s, n, buf, size);
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

static void tell_abort(struct can402 *s, uint32_t i)
{
	const struct drive *d = &s->drive[i];

	tell_of(s, i, (struct can402_note) {
		.kind = d->passed ? NOTE_PASSED : NOTE_ABORT,
		.passed = (uint8_t)d->passed,
		.number = d->abort, .value = d->abort_value,
		.more = (uint32_t)d->abort_index << 8 | d->abort_sub
	});
}

static void tell_up(struct can402 *s, uint32_t i)
{
	const struct drive *d = &s->drive[i];

	tell_of(s, i, (struct can402_note) { .kind = NOTE_UP,
				      .number = (uint32_t)d->actual });
	if (!d->shows_mode)
		tell_of(s, i, (struct can402_note) { .kind = NOTE_UNMAPPED });
}

static void tell_emergency(struct can402 *s, uint32_t i)
{
	const struct drive *d = &s->drive[i];
	const struct cia402_emergency *e =
		&d->history[(d->came - 1) % CIA402_EMERGENCIES];
	struct can402_note n = { .kind = NOTE_EMERGENCY, .number = e->code,
				 .more = d->emergencies,
				 .value = e->error_register };

	memcpy(n.maker, e->maker, sizeof(n.maker));
	tell_of(s, i, n);
}

/* These may come in a flood, so only a few of them are told. */
static void tell_counts(struct can402 *s, uint32_t i,
			const struct can402_told *was)
{
	const struct drive *d = &s->drive[i];

	if (d->emergencies != was->emergencies && is_round(d->emergencies))
		tell_emergency(s, i);
	if (d->unanswered != was->unanswered && is_round(d->unanswered))
		tell_of(s, i, (struct can402_note) { .kind = NOTE_SILENT });
	if (d->warnings != was->warnings && is_round(d->warnings))
		tell_of(s, i, (struct can402_note) { .kind = NOTE_WARNING,
					      .number = d->status });
}

void can402_watch(struct can402 *s, uint32_t i)
{
	const struct drive *d = &s->drive[i];
	const struct can402_told was = s->told[i];

	s->told[i] = (struct can402_told) {
		.up = d->phase == DRIVE_RUNNING && d->stands, .lost = d->lost,
		.trouble = d->trouble, .emergencies = d->emergencies,
		.unanswered = d->unanswered, .aborts = d->aborts,
		.warnings = d->warnings,
	};
	if (d->aborts != was.aborts)
		tell_abort(s, i);
	if (s->told[i].up && !was.up)
		tell_up(s, i);
	if (d->trouble != was.trouble && d->trouble != DRIVE_WELL)
		tell_of(s, i, (struct can402_note) { .kind = NOTE_TROUBLE,
					      .number = d->trouble });
	if (d->lost && !was.lost)
		tell_of(s, i, (struct can402_note) { .kind = NOTE_LOST });
	tell_counts(s, i, &was);
}
