/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_can402_moods.c - two drives that do whatever the standards let a drive
 * do, at any time, and an operator who resets, starts and homes at any time
 *
 * They boot as slowly as they like, lose power, take their time for each
 * transition, leave a state by themselves, fault with and without an emergency
 * message, warn by one, show mode and bit 12 late, lose frames.  However that
 * goes together: a drive that lost its count is not enabled before the operator
 * has said where it is, one that is enabled is not sent far, and no spark goes
 * on while an axis is not under power and in its place.
 */
#include "can402_bus.h"
#include "generator_own.h"

#include <linux/can.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cmocka.h>

#define NDRIVES		2
#define GAP		1008
#define GENERATOR	1009
#define OBJECTS		96
#define RESYNC		200		/* pulses */
#define BLIND		8		/* periods until it must be known */

enum { NOT_READY, DISABLED, READY, ON, ENABLED, STOPPING, FAULT };

static const uint16_t words[] = {
	0x0200, 0x0250, 0x0231, 0x0233, 0x0237, 0x0217, 0x0218
};

struct drive_peer {
	bool powered, running, gone;	/* gone: count lost, no home since */
	int state, born, busy, mode_in, follows_in, mute, bad_for;
	int32_t place, offset;		/* increments; of the count */
	int32_t target, was;
	uint16_t control, taken;
	uint8_t mode;
	bool sent;			/* a target since it is enabled */
	uint32_t key[OBJECTS], value[OBJECTS];
	size_t n;
};

struct rig {
	struct machine_config c;
	struct io_machine m;
	struct io_inputs in;
	struct io_outputs out;
	int fd, generator_fd;
	struct drive_peer p[NDRIVES];
	uint64_t s;
	uint32_t unplaced;		/* as the cycle keeps it */
	bool sparks, begun;
	long period;
	struct { long enabled, sparks, lost, homed, resets; } seen;
};

static uint32_t rnd(struct rig *r, uint32_t n)
{
	r->s = r->s * UINT64_C(6364136223846793005) + 1442695040888963407u;
	return (uint32_t)(r->s >> 33) % n;
}

static bool chance(struct rig *r, uint32_t n)
{
	return rnd(r, n) == 0;
}

static void put(struct rig *r, uint32_t id, const void *data, size_t len)
{
	struct can_frame f = { .can_id = id, .can_dlc = (uint8_t)len };

	memcpy(f.data, data, len);
	assert_int_equal(write(r->fd, &f, sizeof(f)), sizeof(f));
}

static int32_t count_of(const struct drive_peer *p)
{
	return p->state == NOT_READY ? 0 : p->place - p->offset;
}

/* -- A drive's life ------------------------------------------------------- */

static void power_on(struct rig *r, struct drive_peer *p)
{
	p->powered = true;
	p->running = false;
	p->state = NOT_READY;
	p->born = 1 + (int)rnd(r, 40);
	p->n = 0;
	p->mode = 1;
	p->control = p->taken = 0;
	p->offset = p->place;		/* an incremental encoder */
	p->gone = true;
	r->seen.lost++;
}

static void emergency(struct rig *r, int i, uint16_t code)
{
	uint8_t d[8] = { (uint8_t)code, (uint8_t)(code >> 8), code != 0 };

	put(r, (uint32_t)(CAN_EMCY + 1 + i), d, 8);
}

static void break_down(struct rig *r, int i)
{
	if (chance(r, 2))
		emergency(r, i, 0x2310);
	r->p[i].state = FAULT;
}

/* Whatever comes to its mind. */
static void mood(struct rig *r, int i)
{
	struct drive_peer *p = &r->p[i];

	switch (rnd(r, 1500)) {
	case 0:
		p->powered = false;
		p->born = 1 + (int)rnd(r, 60);
		p->state = NOT_READY;
		break;
	case 1:
		break_down(r, i);
		break;
	case 2:
		emergency(r, i, 0x4390);	/* it only warns */
		break;
	case 3:
		if (p->state > DISABLED && p->state < FAULT)
			p->state = DISABLED;
		break;
	case 4:
		if (p->state == ENABLED)
			p->state = STOPPING;
		break;
	case 5:
		p->mute = (int)rnd(r, 6);
		break;
	case 6:
		p->mode = 6;
		break;
	case 7:
		p->place += (int32_t)rnd(r, 400) - 200;	/* it is pushed */
		break;
	default:
		break;
	}
}

static void obey(struct rig *r, struct drive_peer *p)
{
	const uint16_t c = p->control, rises = p->control & ~p->taken;

	p->taken = c;
	if (p->busy > 0) {
		p->busy--;
		return;
	}
	if (p->state == FAULT) {
		if (rises & 0x80)
			p->state = DISABLED;
		return;
	}
	if (p->state == STOPPING || (p->state > DISABLED && !(c & 2)) ||
	    (p->state > DISABLED && !(c & 4) && p->state != ENABLED)) {
		p->state = DISABLED;
	} else if (p->state == ENABLED && !(c & 4)) {
		p->state = STOPPING;
	} else if ((c & 7) == 6 && p->state != DISABLED + 1) {
		p->state = READY;
	} else if ((c & 0xf) == 7 && p->state == READY) {
		p->state = ON;
	} else if ((c & 0xf) == 0xf && p->state == ON) {
		p->state = ENABLED;
		p->follows_in = (int)rnd(r, 30);
		p->sent = false;
	}
	p->busy = chance(r, 4) ? (int)rnd(r, 12) : 0;
}

static bool follows(const struct drive_peer *p)
{
	return p->state == ENABLED && p->mode == 8 && p->follows_in == 0;
}

static void answer(struct rig *r, int i)
{
	struct drive_peer *p = &r->p[i];
	uint8_t d[7];

	p->follows_in -= p->follows_in > 0;
	p->mute -= p->mute > 0;
	can_put(d, words[p->state] | (follows(p) ? 0x1000u : 0), 2);
	can_put(d + 2, (uint32_t)count_of(p), 4);
	d[6] = p->mode;
	if (p->running && !p->mute && !chance(r, 300))
		put(r, (uint32_t)(CAN_TPDO1 + 1 + i), d, 7);
	if (p->running)
		obey(r, p);
	if (follows(p))
		p->place = p->target + p->offset;
}

static void live(struct rig *r, int i)
{
	struct drive_peer *p = &r->p[i];

	if (!p->powered) {
		if (--p->born <= 0)
			power_on(r, p);
		return;
	}
	if (p->born > 0) {
		if (--p->born == 0 && !chance(r, 4))
			put(r, (uint32_t)(CAN_HEARTBEAT + 1 + i), "\0", 1);
		return;
	}
	if (p->state == NOT_READY && chance(r, 10))
		p->state = DISABLED;
	if (r->period % 20 == 0)
		put(r, (uint32_t)(CAN_HEARTBEAT + 1 + i),
		    p->running ? "\x05" : "\x7f", 1);
	mood(r, i);
	if (p->powered)
		answer(r, i);
}

/* -- What it is told ------------------------------------------------------ */

static uint32_t *object(struct drive_peer *p, uint32_t key)
{
	static const struct {
		uint32_t key, value;
	} box[] = {
		{ 0x001000, 0x20192 }, { 0x006502, 0x80 }, { 0x001005, 0x80 },
		{ 0x0160c2, 2 }, { 0x0260c2, 0xfd },
	};

	for (size_t i = 0; i < p->n; i++)
		if (p->key[i] == key)
			return &p->value[i];
	assert_true(p->n < OBJECTS);
	p->key[p->n] = key;
	p->value[p->n] = 0;
	for (size_t i = 0; i < sizeof(box) / sizeof(box[0]); i++)
		if (box[i].key == key)
			p->value[p->n] = box[i].value;
	return &p->value[p->n++];
}

static void on_sdo(struct rig *r, int i, const struct can_frame *f)
{
	struct drive_peer *p = &r->p[i];
	const uint32_t key = can_get(f->data + 1, 3);
	uint32_t *o = object(p, key);
	uint8_t d[8] = { 0x60 };

	memcpy(d + 1, f->data + 1, 3);
	if (f->data[0] == 0x40) {
		d[0] = 0x43;
		can_put(d + 4, *o, 4);
	} else if (key == 0x001006 && chance(r, 2)) {
		d[0] = 0x80;
		can_put(d + 4, 0x06020000, 4);
	} else {
		*o = can_get(f->data + 4, 4);
		if (key == 0x006060)
			p->mode = f->data[4];
	}
	if (!chance(r, 40))
		put(r, (uint32_t)(CAN_SDO_ANSWER + 1 + i), d, 8);
}

/* Never far from where it stands when it begins to follow, never a jump. */
static void judge_target(struct rig *r, int i)
{
	const struct drive_peer *p = &r->p[i];
	const int64_t first = llabs((int64_t)p->target - count_of(p));
	const int64_t step = llabs((int64_t)p->target - p->was);

	if (!follows(p) || p->mute || p->control != 0x0f)
		return;
	if (p->sent ? step > 40 : first > 200 + 40)
		fail_msg("period %ld, drive %d: target %d after %d, at %d",
			 r->period, i, p->target, p->was, count_of(p));
}

static void on_target(struct rig *r, int i, const struct can_frame *f)
{
	struct drive_peer *p = &r->p[i];

	p->control = (uint16_t)can_get(f->data, 2);
	p->target = (int32_t)can_get(f->data + 2, 4);
	judge_target(r, i);
	p->sent = follows(p);
	p->was = p->target;
}

static void on_frame(struct rig *r, const struct can_frame *f)
{
	const int node = (int)(f->can_id & 0x7f);

	if (f->can_id == GENERATOR)
		r->sparks = f->data[0] & 1;
	for (int i = 0; i < NDRIVES; i++) {
		struct drive_peer *p = &r->p[i];

		if (!p->powered || p->born > 0)
			continue;
		if (f->can_id == CAN_NMT && f->data[1] == i + 1)
			p->running = f->data[0] == 1;
		else if (node == i + 1 && f->can_id >> 7 == CAN_SDO_ASK >> 7)
			on_sdo(r, i, f);
		else if (node == i + 1 && f->can_id >> 7 == CAN_RPDO1 >> 7 &&
			 p->running)
			on_target(r, i, f);
	}
}

/* -- The cycle and the operator ------------------------------------------- */

/* A home without a method is the operator's word that it stands where it is. */
static void operate(struct rig *r)
{
	/* Where they stand when all are up is where the machine begins. */
	for (int i = 0; i < NDRIVES && !r->begun && !r->in.starting; i++)
		r->p[i].gone = false;
	r->begun = r->begun || !r->in.starting;
	if (r->in.axes_off && !r->in.starting)
		memcpy(r->out.target, r->in.stands_at, sizeof(r->out.target));
	r->out.reset = false;
	if (r->in.trouble != IO_WELL) {
		r->out.enable = false;
		r->out.reset = chance(r, 60);
		r->seen.resets += r->out.reset;
	} else if (r->in.starting) {
		r->out.enable = false;
	} else if (r->unplaced) {
		r->out.enable = false;
		if (chance(r, 100)) {
			for (int i = 0; i < NDRIVES; i++)
				if (r->unplaced >> i & 1)
					r->p[i].gone = false;
			r->seen.homed++;
			r->unplaced = 0;
		}
	} else if (chance(r, 50)) {
		r->out.enable = true;
	}
	if (!r->in.axes_off && r->out.enable)
		for (int i = 0; i < NDRIVES; i++)
			r->out.target[i] += (int32_t)rnd(r, 3) - 1;
	r->out.power = r->out.enable && !r->in.axes_off &&
		       r->in.trouble == IO_WELL;
}

static void judge(struct rig *r)
{
	for (int i = 0; i < NDRIVES; i++) {
		struct drive_peer *p = &r->p[i];

		if (p->state == ENABLED && p->gone)
			fail_msg("period %ld: drive %d under power, its place "
				 "lost", r->period, i);
		p->bad_for = p->powered && p->state == ENABLED ?
			     0 : p->bad_for + 1;
		if (r->sparks && p->bad_for > BLIND)
			fail_msg("period %ld: sparks, drive %d in state %d",
				 r->period, i, p->state);
		r->seen.enabled += p->state == ENABLED;
	}
	r->seen.sparks += r->sparks;
}

static void make(struct rig *r, uint64_t seed)
{
	int fd[2];

	memset(r, 0, sizeof(*r));
	r->s = seed;
	config_defaults(&r->c);
	r->c.backend = BACKEND_CAN402;
	r->c.can402.node[INTERP_X] = 1;
	r->c.can402.node[INTERP_Y] = 2;
	r->c.can402.resync_mm = RESYNC * 1e-3;
	r->c.can402.sdo_ms = 50;
	r->c.can402.gap_id = GAP;
	r->c.generator.interface = GENERATOR_CAN;
	r->c.generator.can_id = GENERATOR;
	assert_int_equal(socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK, 0,
				    fd), 0);
	assert_int_equal(can402_attach(&r->m, &r->c, fd[0]), 0);
	r->fd = fd[1];
	assert_int_equal(socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK, 0,
				    fd), 0);
	assert_non_null(generator_attach(&r->m, &r->c, fd[0]));
	r->generator_fd = fd[1];
	for (int i = 0; i < NDRIVES; i++) {
		r->p[i].place = 1000 * i;
		power_on(r, &r->p[i]);
	}
}

static void period(struct rig *r)
{
	struct can_frame f;
	char line[160];

	r->period++;
	put(r, GAP, "\xc4\x09", 2);
	r->m.read(r->m.self, &r->in);
	r->unplaced |= r->in.unplaced;
	operate(r);
	r->m.write(r->m.self, &r->out);
	while (r->m.note(r->m.self, line, sizeof(line)))
		if (getenv("EDM_TRACE"))
			printf("%ld: %s\n", r->period, line);
	while (read(r->fd, &f, sizeof(f)) == sizeof(f) ||
	       read(r->generator_fd, &f, sizeof(f)) == sizeof(f))
		on_frame(r, &f);
	judge(r);
	for (int i = 0; i < NDRIVES; i++)
		live(r, i);
}

static uint64_t number(const char *name, uint64_t without)
{
	const char *text = getenv(name);

	return text ? strtoull(text, NULL, 10) : without;
}

static void whatever_they_do_nothing_moves_unplaced_or_sparks(void **state)
{
	const uint64_t seed = number("EDM_SEED", 1);
	const long runs = (long)number("EDM_RUNS", 4);
	static struct rig r;

	(void)state;
	for (long k = 0; k < runs; k++) {
		make(&r, seed * 1000003 + (uint64_t)k);
		for (int i = 0; i < 20000; i++)
			period(&r);
		if (k == 0)
			printf("enabled %ld, sparks %ld, power-ons %ld, homed "
			       "%ld, resets %ld\n", r.seen.enabled,
			       r.seen.sparks, r.seen.lost, r.seen.homed,
			       r.seen.resets);
		assert_true(r.seen.sparks > 100 && r.seen.homed > 3);
		r.m.close(r.m.self);
		close(r.generator_fd);
		close(r.fd);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(whatever_they_do_nothing_moves_unplaced_or_sparks),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
