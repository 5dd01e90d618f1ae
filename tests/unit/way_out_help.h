/* SPDX-License-Identifier: Apache-2.0 */
/*
 * way_out_help.h - the real cycle with the real backends, and axes that an
 * obstacle holds
 *
 * Drives are on a bus that is a socket; lines move axes with encoders, which
 * lose the pulses that they cannot go.
 */
#ifndef WAY_OUT_HELP_H
#define WAY_OUT_HELP_H

#include "can402_bus.h"
#include "gpio_own.h"
#include "restore.h"
#include "cycle_help.h"
#include "axes/axis_state.h"

#include <linux/can.h>
#include <sys/socket.h>
#include <unistd.h>

#define NAXES		2
#define NONE		INT32_MAX

#define DELAY_MAX	32

struct axis {
	int32_t at, wall, floor;	/* pulses; nothing goes beyond wall, nor
					 * below floor */
	int32_t pressed;		/* pulses that it was sent beyond one,
					 * the most, since the last look */
	int32_t springs;		/* back from the wall without power */
	bool clips, sto, had_power;
	/* A drive follows so many periods late, and goes 1 / (1 + tau) of the
	 * way that is left in each: */
	int delay;
	double tau, place;
	int32_t asked[DELAY_MAX];
	/* A drive of increments that are pulses: */
	uint16_t status, control;
	int32_t target;
	bool running;
	uint32_t beat;
	/* Lines: */
	bool high;
	FILE *count;
};

struct world {
	bool lines;			/* gpio, or else can402 */
	struct made m;
	struct machine_config c;
	struct cycle_config k;
	struct io_machine io;
	struct gpio g;
	struct cycle cycle;
	struct io_inputs in;
	struct io_outputs out;
	struct axis axis[NAXES];
	int fd;
	uint32_t syncs;
	bool estop;
	int32_t most;			/* X was sent there, since the last
					 * look */
	int32_t leap;			/* the longest way in a period */
};

/* -- Drives ---------------------------------------------------------------- */

static void put(struct world *w, uint32_t id, const void *data, size_t len)
{
	struct can_frame f = { .can_id = id, .can_dlc = (uint8_t)len };

	memcpy(f.data, data, len);
	assert_int_equal(write(w->fd, &f, sizeof(f)), sizeof(f));
}

/* The controlword of CiA 402, table 32; no transition under safe torque off. */
static void obey(struct axis *a)
{
	static const struct { uint16_t from, control, to; } moves[] = {
		{ 0x40, 0x06, 0x31 }, { 0x31, 0x07, 0x33 },
		{ 0x33, 0x0f, 0x1037 }, { 0x1037, 0x02, 0x40 },
		{ 0x33, 0x06, 0x31 }, { 0x31, 0x00, 0x40 },
		{ 0x33, 0x00, 0x40 },
	};

	if (a->sto) {
		a->status = 0x40;
		return;
	}
	for (size_t i = 0; i < sizeof(moves) / sizeof(moves[0]); i++)
		if (a->status == moves[i].from &&
		    a->control == moves[i].control) {
			a->status = moves[i].to;
			return;
		}
}

static int32_t between(int32_t at, int32_t low, int32_t high)
{
	return at < low ? low : at > high ? high : at;
}

static void follow(struct axis *a, uint32_t n)
{
	a->asked[n % DELAY_MAX] = a->target;
	if (a->status != 0x1037) {
		if (a->had_power && a->at == a->wall)
			a->at -= a->springs;
		a->had_power = false;
		for (int i = 0; i < DELAY_MAX; i++)
			a->asked[i] = a->at;
		a->place = a->at;
		return;
	}
	a->had_power = true;
	a->place += (a->asked[(n - (uint32_t)a->delay) % DELAY_MAX] -
		     a->place) / (1 + a->tau);
	a->place = fmin(fmax(a->place, a->floor), a->wall);
	a->at = (int32_t)lround(a->place);
}

static void on_sync(struct world *w)
{
	w->syncs++;
	for (uint32_t i = 0; i < NAXES; i++) {
		struct axis *a = &w->axis[i];
		const bool clip = a->clips && a->at >= a->wall;
		uint8_t d[7];

		if (!a->running)
			continue;
		can_put(d, a->status | (clip ? 0x800u : 0), 2);
		can_put(d + 2, (uint32_t)a->at, 4);
		d[6] = 8;
		put(w, CAN_TPDO1 + 1 + i, d, 7);
		if (w->syncs % 20 == 0)
			put(w, CAN_HEARTBEAT + 1 + i, "\x05", 1);
		obey(a);
		follow(a, w->syncs);
	}
}

static uint32_t value_of(const struct world *w, const struct can_frame *f)
{
	switch (can_get(f->data + 1, 3)) {
	case 0x001000:
		return 0x20192;
	case 0x006502:
	case 0x001005:
		return 0x80;
	case 0x011016:
		return w->axis[f->can_id - CAN_SDO_ASK - 1].beat;
	case 0x0160c2:
		return 2;
	case 0x0260c2:
		return 0xfd;
	default:
		return 0;
	}
}

static void on_sdo(struct world *w, const struct can_frame *f)
{
	uint8_t d[8] = { 0x60 };

	memcpy(d + 1, f->data + 1, 3);
	if (f->data[0] == 0x40) {
		d[0] = 0x43;
		can_put(d + 4, value_of(w, f), 4);
	} else if (can_get(f->data + 1, 3) == 0x011016) {
		w->axis[f->can_id - CAN_SDO_ASK - 1].beat =
			can_get(f->data + 4, 4);
	}
	put(w, f->can_id - CAN_SDO_ASK + CAN_SDO_ANSWER, d, 8);
}

static int32_t imax(int32_t a, int32_t b)
{
	return a > b ? a : b;
}

static void on_target(struct world *w, uint32_t i, const struct can_frame *f)
{
	struct axis *a = &w->axis[i];
	const int32_t to = (int32_t)can_get(f->data + 2, 4);

	a->control = (uint16_t)can_get(f->data, 2);
	if (a->status == 0x1037 && a->control == 0x0f && abs(to - a->target) >
	    w->leap)
		w->leap = abs(to - a->target);
	a->target = to;
	if (a->status == 0x1037 && a->control == 0x0f)
		a->pressed = imax(a->pressed,
				  abs(to - between(to, a->floor, a->wall)));
	if (i == INTERP_X && a->status == 0x1037 && a->control == 0x0f &&
	    to > w->most)
		w->most = to;
}

static void on_frame(struct world *w, const struct can_frame *f)
{
	if (f->can_id == CAN_SYNC)
		on_sync(w);
	else if (f->can_id == CAN_NMT)
		w->axis[f->data[1] - 1].running = f->data[0] == 1;
	else if (f->can_id > CAN_SDO_ASK && f->can_id < CAN_HEARTBEAT)
		on_sdo(w, f);
	else if (f->can_id > CAN_RPDO1 && f->can_id <= CAN_RPDO1 + NAXES)
		on_target(w, f->can_id - CAN_RPDO1 - 1, f);
}

/* -- Lines, with an encoder on each axis ----------------------------------- */

static void count_out(const struct axis *a)
{
	rewind(a->count);
	fprintf(a->count, "%d\n", a->at + 100000);
	fflush(a->count);
}

/* A stepper loses what it cannot go; the pulse goes out all the same. */
static void on_lines(struct world *w)
{
	for (uint32_t i = 0; i < NAXES; i++) {
		struct axis *a = &w->axis[i];
		const bool high = w->g.pulser.step >> i & 1;
		const int by = w->g.pulser.dir >> i & 1 ? 1 : -1;

		if (high && !a->high &&
		    between(a->at + by, a->floor, a->wall) == a->at + by)
			a->at += by;
		else if (high && !a->high)
			a->pressed++;
		/* The wall is met by all pulses toward it. */
		if (high && !a->high && i == INTERP_X && by > 0)
			w->most = a->at + 1 > w->most ? a->at + 1 : w->most;
		a->high = high;
		count_out(a);
	}
}

static void lines_open(struct world *w)
{
	const struct encoder_config e = { .counts = 1, .pulses = 1,
					  .following_max = 50 };
	const struct pulser_config p = { 1, 1, 1, 1, false, 0, 0, 0 };
	struct gpio *g = &w->g;

	memset(g, 0, sizeof(*g));
	for (int i = 0; i < CONFIG_NLINES; i++)
		g->at[i].chip = -1;
	for (int i = 0; i < IO_NAXES; i++)
		g->quadrature[i].fd = -1;
	g->adc.fd = -1;
	pulser_init(&g->pulser, &p);
	for (int i = 0; i < NAXES; i++) {
		count_out(&w->axis[i]);
		g->encoders |= 1u << i;
		g->quadrature[i] = (struct quadrature) {
			.fd = fileno(w->axis[i].count),
			.round = UINT64_C(1) << 32,
			.raw = (uint64_t)(w->axis[i].at + 100000),
		};
		encoder_init(&g->encoder[i], &e);
	}
	w->io = (struct io_machine) {
		.self = g, .read = gpio_read, .write = gpio_write
	};
}

/* -- The machine ----------------------------------------------------------- */

static void drives_open(struct world *w)
{
	int fd[2];

	assert_int_equal(socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK, 0,
				    fd), 0);
	assert_int_equal(can402_attach(&w->io, &w->c, fd[0]), 0);
	w->fd = fd[1];
	for (int i = 0; i < NAXES; i++)
		w->axis[i].running = false;
}

static void machine_open(struct world *w)
{
	if (w->lines)
		lines_open(w);
	else
		drives_open(w);
	cycle_init(&w->cycle, &w->k);
}

static void machine_close(struct world *w)
{
	if (w->lines)
		return;
	w->io.close(w->io.self);
	close(w->fd);
}

static void period(struct world *w)
{
	struct can_frame f;

	w->io.read(w->io.self, &w->in);
	w->in.estop = w->estop;
	w->in.gap_valid = true;
	w->in.gap_v = OPEN_V;
	cycle_step(&w->cycle, &w->in, &w->out);
	w->io.write(w->io.self, &w->out);
	if (w->lines)
		on_lines(w);
	while (!w->lines && read(w->fd, &f, sizeof(f)) == sizeof(f))
		on_frame(w, &f);
}

static void run_for(struct world *w, double s)
{
	for (double t = 0; t < s; t += (double)w->k.period_ns * 1e-9)
		period(w);
}

/* A path is made, and the machine is changed, in between. */
static void world_init(struct world *w, bool lines)
{
	memset(w, 0, sizeof(*w));
	w->lines = lines;
	config_defaults(&w->c);
	w->c.backend = lines ? BACKEND_GPIO : BACKEND_CAN402;
	w->c.can402.node[INTERP_X] = 1;
	w->c.can402.node[INTERP_Y] = 2;
	for (int i = 0; i < NAXES; i++)
		w->axis[i] = (struct axis) {
			.wall = NONE, .floor = -NONE, .status = 0x40,
			.count = tmpfile(),
		};
}

static void world_start(struct world *w)
{
	w->c.axes = help_machine;
	config_cycle(&w->c, &w->k);
	w->k.dry_run = true;
	machine_open(w);
	run_for(w, 1);
	assert_false(w->in.starting);
	assert_int_equal(cycle_load(&w->cycle, &w->m.p), ANSWER_DONE);
}

static void world_free(struct world *w)
{
	machine_close(w);
	for (int i = 0; i < NAXES; i++)
		fclose(w->axis[i].count);
	unmake(&w->m);
	help_word.feed_mm_s = 1;
}

static enum cycle_answer ask(struct world *w, enum cycle_verb v, double mm)
{
	const struct cycle_command m = { .verb = v, .arg = INTERP_X,
					 .arg_mm = mm };

	return cycle_command(&w->cycle, &m);
}

static void stands(struct world *w)
{
	double t = 0;

	do {
		period(w);
		t += (double)w->k.period_ns * 1e-9;
	} while (cycle_moves(&w->cycle) && t < 20);
	assert_false(cycle_moves(&w->cycle));
	run_for(w, 0.1);
}

/* Another edmd takes over what the one before has put down. */
static void killed(struct world *w)
{
	struct cycle_past past = {
		.far_mm = w->cycle.far_mm,
		.sure_mm = w->cycle.resync.sure_mm,
		.moved_beside = w->cycle.resync.moved_beside,
		.adrift = w->cycle.resync.adrift,
	};
	const uint32_t seg = w->cycle.cursor.index, tick = w->cycle.cursor.tick;
	int32_t zero[IO_NAXES] = { 0 };
	enum cycle_answer answer;
	struct interp_cursor at;
	struct axis_state s;

	memcpy(past.moved_mm, w->cycle.resync.moved_mm, sizeof(past.moved_mm));
	memcpy(past.seen, w->cycle.resync.seen, sizeof(past.seen));
	memcpy(past.moved_way, w->cycle.resync.moved_way,
	       sizeof(past.moved_way));
	memcpy(past.pos, w->cycle.out.target, sizeof(past.pos));
	axis_state_get(&w->cycle, &s);
	if (!w->lines)
		assert_true(w->io.origin(w->io.self, zero));
	machine_close(w);
	/* The drives miss their master. */
	for (int i = 0; i < NAXES; i++)
		w->axis[i].status = 0x40;
	machine_open(w);
	axis_state_set(&w->cycle, &s);
	if (!w->lines)
		w->io.originate(w->io.self, zero);
	assert_int_equal(interp_cursor_init(&at, &w->m.p), 0);
	assert_int_equal(interp_cursor_seek(&at, seg, tick), 0);
	assert_int_equal(cycle_restore(&w->cycle, &at, &past, &answer),
			 RESTORED);
	run_for(w, 1);
}

static void look_anew(struct world *w)
{
	w->most = INT32_MIN;
	w->leap = 0;
	for (int i = 0; i < NAXES; i++)
		w->axis[i].pressed = 0;
}

#endif /* WAY_OUT_HELP_H */
