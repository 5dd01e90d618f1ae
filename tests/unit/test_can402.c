/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_can402.c - promises of the master, on a bus that is a pair of sockets:
 * at the other end are drives, a gap sensor, and others that talk
 */
#include "can402_bus.h"
#include "generator_own.h"

#include <errno.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cmocka.h>

#define GAP		1008
#define GENERATOR	1009
#define NDRIVES		2

struct peer {
	uint16_t status;
	int32_t actual, target;
	uint16_t control;
	bool running, mute;
	uint32_t beat;			/* object 1016:1 */
};

struct rig {
	struct machine_config c;
	struct io_machine m;
	struct io_inputs in;
	struct io_outputs out;
	int fd;				/* the other end; -1: cut */
	struct peer p[NDRIVES];		/* nodes 1, 2: axes X, Y */
	int generator_fd;		/* its bus, another one */
	struct can_frame generator;	/* its last frame */
	uint32_t syncs, sdos;
	bool beats;			/* they send heartbeats */
	bool alone;			/* the master is gone */
};

static void put(struct rig *r, uint32_t id, const void *data, size_t len)
{
	struct can_frame f = { .can_id = id, .can_dlc = (uint8_t)len };

	if (r->alone)
		return;
	if (len > 0)
		memcpy(f.data, data, len);
	assert_int_equal(write(r->fd, &f, sizeof(f)), sizeof(f));
}

static void make(struct rig *r)
{
	int fd[2];

	memset(r, 0, sizeof(*r));
	config_defaults(&r->c);
	r->c.backend = BACKEND_CAN402;
	r->c.can402.node[INTERP_X] = 1;
	r->c.can402.node[INTERP_Y] = 2;
	r->c.drive[INTERP_X].increments = 10;
	r->c.can402.resync_mm = 0.5;
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
	r->beats = true;
	for (int i = 0; i < NDRIVES; i++)
		r->p[i] = (struct peer) { .status = 0x40, .actual = 777 };
}

/* The generator stands in front of it. */
static struct can402 *master(struct rig *r)
{
	return ((struct generator *)r->m.self)->axes.self;
}

static void unmake(struct rig *r)
{
	r->m.close(r->m.self);
	if (r->fd >= 0)
		close(r->fd);
	close(r->generator_fd);
}

static void obey(struct peer *p)
{
	static const struct {
		uint16_t from, control, to;
	} moves[] = {
		{ 0x40, 0x06, 0x21 }, { 0x21, 0x07, 0x23 },
		{ 0x23, 0x0f, 0x1027 }, { 0x1027, 0x02, 0x40 },
		{ 0x23, 0x06, 0x21 }, { 0x08, 0x80, 0x40 },
	};

	for (size_t i = 0; i < sizeof(moves) / sizeof(moves[0]); i++) {
		if (p->status == moves[i].from &&
		    p->control == moves[i].control) {
			p->status = moves[i].to;
			return;
		}
	}
}

static void on_sync(struct rig *r)
{
	r->syncs++;
	for (uint32_t i = 0; i < NDRIVES; i++) {
		struct peer *p = &r->p[i];
		uint8_t d[7];

		if (!p->running)
			continue;
		can_put(d, p->status, 2);
		can_put(d + 2, (uint32_t)p->actual, 4);
		d[6] = 8;
		if (!p->mute)
			put(r, CAN_TPDO1 + 1 + i, d, 7);
		if (!p->mute && r->beats && r->syncs % 20 == 0)
			put(r, CAN_HEARTBEAT + 1 + i, "\x05", 1);
		obey(p);
		if (p->status == 0x1027)
			p->actual = p->target;
	}
}

static uint32_t value_of(const struct rig *r, const struct can_frame *f)
{
	switch (can_get(f->data + 1, 3)) {
	case 0x001000:
		return 0x20192;
	case 0x006502:
		return 0x80;
	case 0x001005:
		return 0x80;
	case 0x011016:
		return r->p[f->can_id - CAN_SDO_ASK - 1].beat;
	case 0x0160c2:
		return 2;
	case 0x0260c2:
		return 0xfd;
	default:
		return 0;
	}
}

static void on_sdo(struct rig *r, const struct can_frame *f)
{
	uint8_t d[8] = { 0x60 };

	memcpy(d + 1, f->data + 1, 3);
	if (f->data[0] == 0x40) {
		d[0] = 0x43;
		can_put(d + 4, value_of(r, f), 4);
	} else if (can_get(f->data + 1, 3) == 0x011016) {
		r->p[f->can_id - CAN_SDO_ASK - 1].beat =
			can_get(f->data + 4, 4);
	}
	r->sdos++;
	put(r, f->can_id - CAN_SDO_ASK + CAN_SDO_ANSWER, d, 8);
}

static void on_frame(struct rig *r, const struct can_frame *f)
{
	if (f->can_id == CAN_SYNC)
		on_sync(r);
	else if (f->can_id == CAN_NMT)
		r->p[f->data[1] - 1].running = f->data[0] == 1;
	else if (f->can_id == GENERATOR)
		r->generator = *f;
	else if (f->can_id > CAN_SDO_ASK && f->can_id < CAN_HEARTBEAT)
		on_sdo(r, f);
	else if (f->can_id > CAN_RPDO1 && f->can_id <= CAN_RPDO1 + NDRIVES) {
		struct peer *p = &r->p[f->can_id - CAN_RPDO1 - 1];

		p->control = (uint16_t)can_get(f->data, 2);
		p->target = (int32_t)can_get(f->data + 2, 4);
	}
}

static void period(struct rig *r)
{
	struct can_frame f;

	r->m.read(r->m.self, &r->in);
	/* As the cycle does. */
	if (r->in.axes_off && !r->in.steers && !r->in.starting)
		memcpy(r->out.target, r->in.stands_at, sizeof(r->out.target));
	r->m.write(r->m.self, &r->out);
	r->out.reset = false;
	while (r->fd >= 0 && read(r->fd, &f, sizeof(f)) == sizeof(f))
		on_frame(r, &f);
	while (read(r->generator_fd, &f, sizeof(f)) == sizeof(f))
		on_frame(r, &f);
}

static void run(struct rig *r, int cycles)
{
	while (cycles-- > 0) {
		if (r->fd >= 0)
			put(r, GAP, "\xc4\x09", 2);
		period(r);
	}
}

/* Up and enabled. */
static void begin(struct rig *r)
{
	make(r);
	run(r, 150);
	assert_false(r->in.starting);
	assert_true(r->in.axes_off);
	r->out.enable = true;
	run(r, 20);
	assert_false(r->in.axes_off);
	assert_int_equal(r->in.trouble, IO_WELL);
	r->out.power = true;
	run(r, 2);
	assert_int_equal(r->generator.data[0] & 1, 1);
}

/* Sparks go off in the period it is heard, whatever the cycle says. */
static void ends_with(struct rig *r, enum io_trouble t)
{
	assert_int_equal(r->in.trouble, t);
	assert_int_equal(r->generator.data[0] & 3, 0);
	/* As the cycle does where nothing moves, or where none can brake. */
	r->out.enable = false;
	run(r, 3);
	for (int i = 0; i < NDRIVES; i++)
		assert_int_not_equal(r->p[i].status, 0x1027);
}

static bool said(struct rig *r, const char *what)
{
	char line[160];
	bool found = false;

	while (r->m.note(r->m.self, line, sizeof(line)))
		found = found || strstr(line, what);
	return found;
}

static void resets(struct rig *r)
{
	r->out.enable = r->out.power = false;
	r->out.reset = true;
	run(r, 150);
	assert_int_equal(r->in.trouble, IO_WELL);
	for (int i = 0; i < NDRIVES; i++)
		assert_int_not_equal(r->p[i].status, 0x1027);
	r->out.enable = true;
	run(r, 20);
	assert_false(r->in.axes_off);
}

static void it_brings_up_all_drives_and_enables_by_command_only(void **st)
{
	struct rig r;

	(void)st;
	make(&r);
	run(&r, 1);
	assert_true(r.in.starting && r.in.axes_off);
	run(&r, 200);
	assert_false(r.in.starting);
	/* Ready to switch on: this gives no torque. */
	assert_int_equal(r.p[0].status, 0x21);
	assert_true(said(&r, "is up at 777 increments"));
	unmake(&r);
	begin(&r);
	unmake(&r);
}

static void targets_reach_the_drives_as_increments_from_where_they_stood(
	void **st)
{
	struct rig r;

	(void)st;
	begin(&r);
	for (int i = 1; i <= 50; i++) {
		r.out.target[INTERP_X] = i;
		r.out.target[INTERP_Y] = -i;
		run(&r, 1);
	}
	run(&r, 4);
	assert_int_equal(r.p[0].actual, 777 + 500);
	assert_int_equal(r.p[1].actual, 777 - 50);
	assert_int_equal(r.in.actual[INTERP_X], 50);
	assert_int_equal(r.in.actual[INTERP_Y], -50);
	unmake(&r);
}

static void drives_stand_where_the_targets_begin(void **st)
{
	struct rig r;

	(void)st;
	make(&r);
	r.out.target[INTERP_X] = 5000;
	run(&r, 150);
	r.out.enable = true;
	run(&r, 20);
	assert_false(r.in.axes_off);
	assert_int_equal(r.p[0].actual, 777);
	assert_int_equal(r.in.actual[INTERP_X], 5000);
	unmake(&r);
}

/* Wherever the machine begins: an absolute drive is homed by this. */
static void a_drive_tells_its_own_place_too(void **st)
{
	struct rig r;

	(void)st;
	make(&r);
	r.out.target[INTERP_X] = 5000;
	r.p[0].actual = -12340;
	run(&r, 150);
	assert_int_equal(r.in.actual[INTERP_X], 5000);
	assert_int_equal(r.in.own[INTERP_X], -1234);
	assert_int_equal(r.in.own[INTERP_Y], 777);
	unmake(&r);
}

/* The master is killed at X 5000; the drives come to a stand @off further. */
static void begin_after_a_crash(struct rig *r, int32_t off, bool remember)
{
	int32_t zero[IO_NAXES];

	begin(r);
	for (int i = 0; i < 5000; i += 10) {
		r->out.target[INTERP_X] += 10;
		run(r, 1);
	}
	run(r, 4);
	assert_true(r->m.origin(r->m.self, zero));
	unmake(r);
	make(r);
	r->m.originate(r->m.self, zero);
	r->p[0].actual = 777 + 50000 + off;
	for (int i = 0; i < NDRIVES; i++)
		r->p[i].beat = remember ? 127 << 16 | 250 : 0;
	r->out.target[INTERP_X] = 5000;
	run(r, 150);
	assert_int_equal(r->in.trouble, IO_WELL);
	r->out.enable = true;
}

static void after_a_crash_an_axis_stands_where_it_stands(void **st)
{
	const int32_t off[] = { 300, 100000, -100000 };

	(void)st;
	for (int i = 0; i < 3; i++) {
		struct rig r;

		begin_after_a_crash(&r, off[i], true);
		assert_int_equal(r.in.actual[INTERP_X], 5000 + off[i] / 10);
		run(&r, 200);
		assert_false(r.in.axes_off);
		assert_int_equal(r.p[0].actual, 777 + 50000 + off[i]);
		assert_int_equal(r.in.stands_at[INTERP_X], 5000 + off[i] / 10);
		unmake(&r);
	}
}

/* Switched off with the master away, near its place by chance. */
static void after_a_crash_a_drive_that_was_off_has_no_place(void **st)
{
	struct rig r;

	(void)st;
	begin_after_a_crash(&r, 300, false);
	assert_true(said(&r, "drive X (node 1) was switched off: its place "
			     "is lost"));
	run(&r, 200);
	assert_int_equal(r.p[0].actual, 777 + 50300);
	unmake(&r);
}

static void a_restart_tells_that_the_place_is_lost_and_moves_nothing(void **st)
{
	uint32_t unplaced = 0;
	struct rig r;

	(void)st;
	begin(&r);
	r.out.target[INTERP_X] = 30;
	run(&r, 5);
	r.p[0] = (struct peer) { .status = 0x40, .actual = 5 };
	put(&r, CAN_HEARTBEAT + 1, "\0", 1);
	run(&r, 1);
	assert_int_equal(r.in.unplaced, 1 << INTERP_X);
	ends_with(&r, IO_DRIVE);
	r.out.enable = r.out.power = false;
	r.out.reset = true;
	for (int i = 0; i < 150; i++) {
		run(&r, 1);
		unplaced |= r.in.unplaced;
	}
	assert_int_equal(unplaced, 1 << INTERP_X);
	assert_int_equal(r.in.unplaced, 0);
	r.out.enable = true;
	run(&r, 50);
	assert_int_equal(r.p[0].actual, 5);
	assert_int_equal(r.in.actual[INTERP_X], 30);
	unmake(&r);
}

/* X at 10 increments a pulse, Y at 1; both at 1 pulse a period. */
static void what_is_stopped_brakes_along_the_path(void **st)
{
	struct rig r;
	int32_t x, y;

	(void)st;
	begin(&r);
	for (int i = 0; i < NDRIVES; i++)
		master(&r)->stop[i].a /= 10;
	for (int i = 1; i <= 200; i++) {
		r.out.target[INTERP_X] = 8 * i;
		r.out.target[INTERP_Y] = 4 * i;
		run(&r, 1);
	}
	put(&r, CAN_RPDO1 + 99, "", 0);
	r.out.enable = false;
	run(&r, 40);
	x = r.p[0].actual - 777 - 16000;
	y = r.p[1].actual - 777 - 800;
	assert_true(x > 500 && y > 25);
	assert_true(abs(x - 20 * y) <= 20);
	assert_true(r.in.ran_on[INTERP_X] >= x / 10);
	assert_true(r.in.ran_on[INTERP_Y] >= y);
	r.out.enable = true;
	run(&r, 100);
	assert_false(r.in.axes_off);
	assert_int_equal(r.p[0].actual - 777 - 16000, x);
	assert_int_equal(r.p[1].actual - 777 - 800, y);
	unmake(&r);
}

/* X has the fault.  Y follows until its power is taken; then it stops too. */
static void the_drive_that_is_well_follows_while_the_cycle_brakes(void **st)
{
	struct rig r;
	int32_t x;

	(void)st;
	begin(&r);
	for (int i = 1; i <= 100; i++) {
		r.out.target[INTERP_X] = 8 * i;
		r.out.target[INTERP_Y] = 4 * i;
		run(&r, 1);
	}
	r.p[0].status = 0x08;
	run(&r, 2);
	x = r.p[0].actual;
	assert_int_equal(r.in.trouble, IO_DRIVE);
	assert_true(r.in.steers);
	assert_int_equal(r.generator.data[0] & 3, 0);
	for (int i = 0; i < 40; i++) {
		r.out.target[INTERP_X] += 4;
		r.out.target[INTERP_Y] += 2;
		run(&r, 1);
	}
	run(&r, 3);
	assert_int_equal(r.p[0].actual, x);
	assert_int_equal(r.p[1].actual, 777 + 480);
	assert_int_equal(r.p[1].status, 0x1027);
	ends_with(&r, IO_DRIVE);
	assert_false(r.in.steers);
	r.out.reset = true;
	run(&r, 150);
	r.out.enable = true;
	run(&r, 400);
	assert_int_equal(r.in.trouble, IO_WELL);
	assert_false(r.in.axes_off);
	assert_int_equal(r.p[0].actual, x);
	assert_int_equal(r.in.ran_on[INTERP_X], 0);
	unmake(&r);
}

/* -- Brakes on lines ------------------------------------------------------ */

static uint32_t brakes_open;
static bool brakes_answer;

static bool brake(void *arg, uint32_t axes)
{
	(void)arg;
	brakes_open = axes;
	return brakes_answer;
}

#define BRAKE_PERIODS	10

/* Drives that are up; Y's brake is on a line. */
static void begin_braked(struct rig *r)
{
	struct can402 *s;

	begin(r);
	r->out.enable = r->out.power = false;
	run(r, 20);
	s = master(r);
	s->braked = 1 << INTERP_Y;
	s->brake = brake;
	s->brake_periods = BRAKE_PERIODS;
	brakes_open = 0;
	brakes_answer = true;
	run(r, 2);
	assert_int_equal(brakes_open, 0);
}

static void enable_braked(struct rig *r)
{
	int n = 0;

	r->out.enable = true;
	for (; !brakes_open; n++) {
		run(r, 1);
		assert_true(r->in.axes_off && n < 50);
	}
	assert_int_equal(brakes_open, 1 << INTERP_Y);
	assert_int_equal(r->p[1].status, 0x1027);
	for (n = 0; r->in.axes_off; n++)
		run(r, 1);
	assert_in_range(n, BRAKE_PERIODS, BRAKE_PERIODS + 3);
}

static void a_brake_opens_under_torque_and_closes_before_it_ends(void **st)
{
	struct rig r;
	int n = 0;

	(void)st;
	begin_braked(&r);
	enable_braked(&r);
	r.out.enable = false;
	run(&r, 1);
	assert_int_equal(brakes_open, 0);
	for (; r.p[1].status == 0x1027; n++)
		run(&r, 1);
	assert_in_range(n, BRAKE_PERIODS - 1, BRAKE_PERIODS + 3);
	run(&r, 3);
	/* And again, with a start before it is closed. */
	enable_braked(&r);
	r.out.enable = false;
	run(&r, 3);
	enable_braked(&r);
	assert_int_equal(r.in.trouble, IO_WELL);
	unmake(&r);
}

static void the_brake_of_a_drive_in_trouble_closes_at_once(void **st)
{
	struct rig r;

	(void)st;
	begin_braked(&r);
	enable_braked(&r);
	r.p[0].status = 0x08;
	run(&r, 2);
	/* X has no brake; Y holds on, and the cycle may brake on the path. */
	assert_int_equal(r.in.trouble, IO_DRIVE);
	assert_int_equal(brakes_open, 1 << INTERP_Y);
	r.p[1].status = 0x08;
	run(&r, 2);
	assert_int_equal(brakes_open, 0);
	unmake(&r);
}

static void brakes_that_do_not_answer_are_a_lost_machine(void **st)
{
	struct rig r;

	(void)st;
	begin_braked(&r);
	enable_braked(&r);
	brakes_answer = false;
	run(&r, 2);
	assert_true(r.in.lost);
	unmake(&r);
}

static void none_steers_where_the_bus_is_at_fault(void **st)
{
	struct rig r;

	(void)st;
	begin(&r);
	assert_true(r.in.steers);
	put(&r, CAN_NMT, "\x02\x01", 2);
	run(&r, 1);
	assert_false(r.in.steers);
	unmake(&r);
}

/* On the bus of the drives: it commands our own node, or all. */
static void a_plc_on_the_same_bus_is_no_other_master(void **st)
{
	struct rig r;

	(void)st;
	begin(&r);
	master(&r)->plc_node = 32;
	put(&r, CAN_NMT, "\x01\x20", 2);
	put(&r, CAN_NMT, "\x02\x20", 2);
	put(&r, CAN_NMT, "\x01\x00", 2);
	put(&r, CAN_NMT, "\x81\x21", 2);	/* another slave of its */
	put(&r, CAN_NMT, "\x02", 1);		/* is no NMT */
	put(&r, CAN_NMT, "\x02\x01\x00", 3);
	run(&r, 5);
	assert_int_equal(r.in.trouble, IO_WELL);
	put(&r, CAN_NMT, "\x02\x01", 2);
	run(&r, 1);
	ends_with(&r, IO_BUS);
	unmake(&r);
}

/* It does so when it is switched on, at the same time as the drives. */
static void drives_that_a_plc_starts_too_early_are_set_up_all_the_same(
	void **st)
{
	struct can402 *s;
	struct rig r;

	(void)st;
	make(&r);
	s = master(&r);
	s->plc_node = 32;
	run(&r, 20);
	assert_true(s->drive[0].step > 5);
	put(&r, CAN_NMT, "\x01\x00", 2);
	run(&r, 1);
	assert_int_equal(s->drive[0].step, 0);
	assert_int_equal(s->drive[1].step, 0);
	run(&r, 200);
	assert_int_equal(s->drive[0].phase, DRIVE_RUNNING);
	assert_int_equal(s->drive[1].phase, DRIVE_RUNNING);
	unmake(&r);
}

static void errors_on_the_bus_are_told_and_stop_nothing(void **st)
{
	static const struct {
		uint8_t control;
		const char *told;
	} rows[] = {
		{ CAN_ERR_CRTL_RX_WARNING, "error warning" },
		{ CAN_ERR_CRTL_TX_WARNING, "error warning" },
		{ CAN_ERR_CRTL_TX_PASSIVE, "error passive" },
		{ CAN_ERR_CRTL_ACTIVE, "error active again" },
		{ CAN_ERR_CRTL_RX_OVERFLOW, "lost frames that came" },
		{ CAN_ERR_CRTL_TX_OVERFLOW, "lost frames that it was to send" },
	};
	struct rig r;

	(void)st;
	begin(&r);
	said(&r, "");
	for (size_t i = 0; i < sizeof(rows) / sizeof(rows[0]); i++) {
		const uint8_t d[8] = { 0, rows[i].control };

		put(&r, CAN_ERR_FLAG | CAN_ERR_CRTL, d, 8);
		run(&r, 1);
		assert_true(said(&r, rows[i].told));
	}
	assert_int_equal(r.in.trouble, IO_WELL);
	unmake(&r);
}

static void the_gap_is_what_its_frames_say_until_they_stop(void **st)
{
	struct rig r;

	(void)st;
	begin(&r);
	assert_true(r.in.gap_valid);
	assert_false(r.in.shares_valid);
	assert_float_equal(r.in.gap_v, 25, 1e-9);
	put(&r, GAP, "\x10\x27\x00\xff\x33\x00", 6);
	period(&r);
	assert_true(r.in.shares_valid);
	assert_float_equal(r.in.gap_v, 100, 1e-9);
	assert_float_equal(r.in.shares.spark, 1, 1e-6);
	assert_float_equal(r.in.shares.arc, 0.2, 1e-6);
	for (int i = 0; i < CAN402_STALE; i++)
		period(&r);
	assert_false(r.in.gap_valid);
	assert_false(r.in.shares_valid);
	unmake(&r);
}

static void a_gap_sensor_without_a_reading_is_a_lost_gap_at_once(void **st)
{
	struct rig r;

	(void)st;
	begin(&r);
	assert_true(r.in.gap_valid);
	put(&r, GAP, "\xff\xff", 2);
	period(&r);
	assert_false(r.in.gap_valid);
	run(&r, 1);
	assert_true(r.in.gap_valid);
	unmake(&r);
}

static void the_generator_is_told_each_period(void **st)
{
	struct rig r;
	uint8_t count;

	(void)st;
	begin(&r);
	io_pulse_own(&r.out);
	r.out.pulse[INTERP_TECH_POLARITY] = -1;
	r.out.pulse[INTERP_TECH_PEAK_A] = 6.4;
	r.out.pulse[INTERP_TECH_ON_US] = 12.5;
	run(&r, 1);
	assert_int_equal(r.generator.data[0], 5);
	assert_int_equal(can_get(r.generator.data + 2, 2), 64);
	assert_int_equal(can_get(r.generator.data + 4, 2), 125);
	assert_int_equal(can_get(r.generator.data + 6, 2), 0xffff);
	count = r.generator.data[1];
	run(&r, 3);
	assert_int_equal(r.generator.data[1], (uint8_t)(count + 3));
	unmake(&r);
}

static void an_emergency_stops_all_drives_and_is_told_with_its_code(void **st)
{
	struct rig r;

	(void)st;
	begin(&r);
	put(&r, CAN_EMCY + 2, "\x10\x23\x01\0\0\0\0\0", 8);
	r.p[1].status = 0x08;
	run(&r, 2);
	ends_with(&r, IO_DRIVE);
	assert_true(said(&r, "drive Y (node 2): emergency 2310"));
	resets(&r);
	/* Two in a period: the first is the cause. */
	for (int i = 0; i < 3; i++) {
		put(&r, CAN_EMCY + 2, "\x00\x87\x01\0\0\0\0\0", 8);
		put(&r, CAN_EMCY + 2, "\x30\x81\x11\0\0\0\0\0", 8);
		r.p[1].status = 0x08;
		run(&r, 2);
		ends_with(&r, IO_DRIVE);
		assert_true(said(&r, "drive Y (node 2): emergency 8700"));
		resets(&r);
	}
	unmake(&r);
}

static void an_emergency_of_a_warning_is_told_and_stops_nothing(void **st)
{
	struct rig r;

	(void)st;
	begin(&r);
	put(&r, CAN_EMCY + 2, "\x82\x32\x04\0\0\0\0\0", 8);
	run(&r, 5);
	assert_true(said(&r, "drive Y (node 2): emergency 3282"));
	assert_int_equal(r.in.trouble, IO_WELL);
	/* From a drive that is silent then it is no warning. */
	put(&r, CAN_EMCY + 2, "\x82\x32\x04\0\0\0\0\0", 8);
	r.p[1].mute = true;
	run(&r, 2);
	assert_int_equal(r.in.trouble, IO_DRIVE);
	unmake(&r);
}

static void a_flood_of_emergencies_is_told_a_few_times(void **st)
{
	struct rig r;
	char line[160];
	int lines = 0;

	(void)st;
	begin(&r);
	said(&r, "");
	for (int i = 0; i < 1000; i++) {
		put(&r, CAN_EMCY + 1, "\x10\x23\x01\0\0\0\0\0", 8);
		run(&r, 1);
		while (r.m.note(r.m.self, line, sizeof(line)))
			lines++;
	}
	assert_in_range(lines, 2, 12);
	unmake(&r);
}

static void a_bus_that_is_off_or_gone_is_told_and_comes_back_by_reset(
	void **st)
{
	struct rig r;

	(void)st;
	begin(&r);
	put(&r, CAN_ERR_FLAG | CAN_ERR_BUSOFF, "\0\0\0\0\0\0\0\0", 8);
	r.m.read(r.m.self, &r.in);
	assert_int_equal(r.in.trouble, IO_BUS);
	period(&r);
	ends_with(&r, IO_BUS);
	assert_true(said(&r, "bus off"));
	resets(&r);
	unmake(&r);

	begin(&r);
	close(r.fd);
	r.fd = -1;
	run(&r, 1);
	assert_int_equal(r.in.trouble, IO_BUS);
	r.out.reset = true;
	run(&r, 2);
	assert_int_equal(r.in.trouble, IO_BUS);
	assert_true(said(&r, "is down"));
	unmake(&r);
}

static void another_master_is_a_fault(void **st)
{
	const struct {
		uint32_t id;
		const char *data;
		size_t len;
	} foreign[] = {
		{ CAN_NMT, "\x02\x05", 2 }, { CAN_SYNC, "", 0 },
		{ CAN_RPDO1 + 1, "\x0f\0\0\0\0\0", 6 },
		{ CAN_HEARTBEAT + 127, "\x05", 1 },
	};

	(void)st;
	for (int i = 0; i < 4; i++) {
		struct rig r;

		begin(&r);
		put(&r, foreign[i].id, foreign[i].data, foreign[i].len);
		run(&r, 1);
		ends_with(&r, IO_BUS);
		assert_true(said(&r, "another master"));
		resets(&r);
		unmake(&r);
	}
}

/* Each length of each kind, other nodes', other formats, unasked answers. */
static void what_is_malformed_or_strange_is_told_and_changes_nothing(void **st)
{
	static const struct {
		uint32_t base;
		size_t len;
	} kinds[] = {
		{ CAN_TPDO1, 7 }, { CAN_EMCY, 8 }, { CAN_HEARTBEAT, 1 },
		{ CAN_SDO_ANSWER, 9 },
	};
	static const uint8_t ones[8] = { 255, 255, 255, 255,
					 255, 255, 255, 255 };
	char line[160];
	int lines = 0;
	struct rig r;

	(void)st;
	begin(&r);
	said(&r, "");
	for (int i = 0; i < 4; i++) {
		for (size_t len = 0; len <= 8; len++) {
			if (len != kinds[i].len)
				put(&r, kinds[i].base + 1, ones, len);
			put(&r, kinds[i].base + 77, ones, len);
			put(&r, (kinds[i].base + 1) | CAN_EFF_FLAG, ones, len);
			put(&r, (kinds[i].base + 1) | CAN_RTR_FLAG, ones, len);
			run(&r, 1);
		}
	}
	for (size_t len = 0; len <= 8; len++) {
		if (len != 2 && len != 6)
			put(&r, GAP, ones, len);
		period(&r);
		assert_float_equal(r.in.gap_v, 25, 1e-9);
	}
	put(&r, CAN_SDO_ANSWER + 1, "\x80\x40\x60\0\0\0\x02\x06", 8);
	run(&r, 5);
	assert_int_equal(r.in.trouble, IO_WELL);
	assert_false(r.in.axes_off);
	assert_int_equal(r.p[0].actual, 777);
	while (r.m.note(r.m.self, line, sizeof(line)))
		lines++;
	assert_in_range(lines, 1, 9);
	unmake(&r);
}

/* Any identifier, any length, any data, and a reset now and then. */
static void random_frames_never_move_what_has_no_power(void **st)
{
	struct rig r;

	(void)st;
	srand(1);
	make(&r);
	for (int n = 0; n < 40000; n++) {
		uint8_t data[8];
		const uint32_t node = (uint32_t)rand() % 4;
		const uint32_t id = rand() % 2 ? (uint32_t)rand() % 0x800 :
			(uint32_t)(rand() % 16) << 7 | node;

		for (int i = 0; i < 8; i++)
			data[i] = (uint8_t)rand();
		put(&r, id, data, (size_t)rand() % 9);
		r.out.reset = rand() % 50 == 0;
		r.out.power = r.out.pump = true;
		period(&r);
		assert_true(r.in.trouble < IO_NTROUBLES);
		assert_int_equal(r.p[0].actual, 777);
		assert_int_equal(r.p[1].actual, 777);
	}
	unmake(&r);
}

static void silence_of_one_stops_both(void **st)
{
	struct rig r;

	(void)st;
	begin(&r);
	r.p[0].mute = true;
	run(&r, 2);
	r.p[0].mute = false;
	run(&r, 5);
	assert_int_equal(r.in.trouble, IO_WELL);
	r.p[0].mute = true;
	run(&r, 5);
	ends_with(&r, IO_DRIVE);
	assert_true(said(&r, "drive X (node 1)"));
	r.p[0].mute = false;
	resets(&r);
	r.beats = false;
	run(&r, 200);
	ends_with(&r, IO_DRIVE);
	r.beats = true;
	resets(&r);
	unmake(&r);
}

static void a_drive_that_never_answers_is_named(void **st)
{
	struct rig r;

	(void)st;
	make(&r);
	close(r.fd);
	r.fd = -1;
	run(&r, 2000);
	assert_true(r.in.starting);
	assert_true(said(&r, "drive X (node 1) does not answer"));
	unmake(&r);
}

static void it_leaves_the_drives_stopped_and_quiet(void **st)
{
	struct can_frame f;
	struct rig r;

	(void)st;
	begin(&r);
	r.alone = true;
	r.m.close(r.m.self);
	/* The first read tells that what was sent to it was not read. */
	assert_int_equal(read(r.fd, &f, sizeof(f)), -1);
	while (read(r.fd, &f, sizeof(f)) == sizeof(f)) {
		if (f.can_id == CAN_NMT)
			assert_int_equal(f.data[0], 0x80);
		if (f.can_id == CAN_SYNC)
			assert_int_equal(r.p[0].control, 0x02);
		on_frame(&r, &f);
	}
	for (int i = 0; i < NDRIVES; i++) {
		assert_false(r.p[i].running);
		assert_int_not_equal(r.p[i].status, 0x1027);
		assert_int_equal(r.p[i].actual, 777);
	}
	while (read(r.generator_fd, &f, sizeof(f)) == sizeof(f))
		on_frame(&r, &f);
	assert_int_equal(r.generator.data[0], 0);
	close(r.generator_fd);
	close(r.fd);
}

static void a_bus_too_full_is_refused_with_the_period_that_fits(void **st)
{
	struct machine_config c;
	struct interp_diag d;
	struct io_machine m;

	(void)st;
	config_defaults(&c);
	c.backend = BACKEND_CAN402;
	for (int i = 0; i < IO_NAXES; i++)
		c.can402.node[i] = 10 + i;
	c.period_us = 1000;
	assert_int_equal(io_can402_open(&m, &c, &d), -EINVAL);
	assert_non_null(strstr(d.found, "8 drives every 1000 us take 19"));
	assert_non_null(strstr(d.wanted, "period_us 2500 or more"));
	c.period_us = 2500;
	strcpy(c.can402.interface, "none");
	assert_int_not_equal(io_can402_open(&m, &c, &d), 0);
	assert_non_null(strstr(d.found, "can402.interface none"));
}

/* Axes, period, percent; by hand from frames of 55, 115, 125 and 65 bits. */
static void the_load_is_that_of_longest_frames(void **st)
{
	static const struct {
		uint32_t axes;
		double us, percent;
	} rows[] = {
		{ 2, 1000, 54 }, { 4, 1000, 102 }, { 6, 1000, 150 },
		{ 2, 2000, 27 }, { 4, 2000, 51 }, { 6, 2000, 75 },
		{ 8, 4000, 50 },
	};
	/* A PLC: four frames and its own, of 135 bits, each 20 ms. */
	struct can402_bus shared = { .bitrate = 1000000, .axes = 4,
				     .heartbeat_ms = 100 };
	double alone;

	(void)st;
	alone = can402_load(&shared, 2000);
	shared.plc_us = 20000;
	assert_true(fabs(can402_load(&shared, 2000) - alone -
			 (5 * 135 * 50 + 2 * 65 * 10) * 1e-6) < 1e-9);
	/* Sets that are closer than four periods: one frame in each. */
	shared.plc_us = 5000;
	assert_true(fabs(can402_load(&shared, 2000) - alone -
			 (135 * (500 + 200) + 2 * 65 * 10) * 1e-6) < 1e-9);
	/* Three that send their inputs, in frames of 97 bits. */
	shared.plc_us = 0;
	shared.inputs = 3;
	assert_true(fabs(can402_load(&shared, 2000) - alone -
			 3 * 95 * 500 * 1e-6) < 1e-9);
	for (size_t i = 0; i < sizeof(rows) / sizeof(rows[0]); i++) {
		const struct can402_bus b = { .bitrate = 1000000,
					      .axes = rows[i].axes,
					      .heartbeat_ms = 100 };
		const double load = can402_load(&b, rows[i].us);

		assert_true(fabs(100 * load - rows[i].percent) < 1);
		assert_true(can402_load(&b, can402_period_us(&b)) <=
			    CAN402_LOAD_MAX);
		assert_true(can402_load(&b, can402_period_us(&b) - 100) >
			    CAN402_LOAD_MAX);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(it_brings_up_all_drives_and_enables_by_command_only),
		cmocka_unit_test(targets_reach_the_drives_as_increments_from_where_they_stood),
		cmocka_unit_test(drives_stand_where_the_targets_begin),
		cmocka_unit_test(a_drive_tells_its_own_place_too),
		cmocka_unit_test(after_a_crash_an_axis_stands_where_it_stands),
		cmocka_unit_test(after_a_crash_a_drive_that_was_off_has_no_place),
		cmocka_unit_test(a_restart_tells_that_the_place_is_lost_and_moves_nothing),
		cmocka_unit_test(what_is_stopped_brakes_along_the_path),
		cmocka_unit_test(the_drive_that_is_well_follows_while_the_cycle_brakes),
		cmocka_unit_test(none_steers_where_the_bus_is_at_fault),
		cmocka_unit_test(a_brake_opens_under_torque_and_closes_before_it_ends),
		cmocka_unit_test(the_brake_of_a_drive_in_trouble_closes_at_once),
		cmocka_unit_test(brakes_that_do_not_answer_are_a_lost_machine),
		cmocka_unit_test(a_plc_on_the_same_bus_is_no_other_master),
		cmocka_unit_test(drives_that_a_plc_starts_too_early_are_set_up_all_the_same),
		cmocka_unit_test(errors_on_the_bus_are_told_and_stop_nothing),
		cmocka_unit_test(the_gap_is_what_its_frames_say_until_they_stop),
		cmocka_unit_test(a_gap_sensor_without_a_reading_is_a_lost_gap_at_once),
		cmocka_unit_test(the_generator_is_told_each_period),
		cmocka_unit_test(an_emergency_stops_all_drives_and_is_told_with_its_code),
		cmocka_unit_test(an_emergency_of_a_warning_is_told_and_stops_nothing),
		cmocka_unit_test(a_flood_of_emergencies_is_told_a_few_times),
		cmocka_unit_test(a_bus_that_is_off_or_gone_is_told_and_comes_back_by_reset),
		cmocka_unit_test(another_master_is_a_fault),
		cmocka_unit_test(what_is_malformed_or_strange_is_told_and_changes_nothing),
		cmocka_unit_test(random_frames_never_move_what_has_no_power),
		cmocka_unit_test(silence_of_one_stops_both),
		cmocka_unit_test(a_drive_that_never_answers_is_named),
		cmocka_unit_test(it_leaves_the_drives_stopped_and_quiet),
		cmocka_unit_test(a_bus_too_full_is_refused_with_the_period_that_fits),
		cmocka_unit_test(the_load_is_that_of_longest_frames),
	};

	return cmocka_run_group_tests_name("io/can402", tests, NULL, NULL);
}
