/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_way_out.c - a way out of every stop: the real cycle with the real
 * backends, axes that an obstacle holds, and every verb
 *
 * A line goes to X 3 Y 1.5.  At X 1 something stops X that does not yield; Y
 * goes on for as long as the machine needs to stop.
 */
#include "can402_bus.h"
#include "gpio_own.h"
#include "restore.h"
#include "cycle_help.h"
#include "axes/axis_state.h"

#include <linux/can.h>
#include <sys/socket.h>
#include <unistd.h>

#define NAXES		2
#define WALL		1000
#define NONE		INT32_MAX
#define PATH_PER_X	1.1180339887498949	/* mm of path for a mm of X */

enum stopped { BY_FOLLOWING, BY_LIMIT, BY_STO, BY_ESTOP, BY_KILL, NSTOPS };

static const char *const stop_names[NSTOPS] = {
	"following error", "drive limit", "safe torque off", "e-stop",
	"restart"
};

struct axis {
	int32_t at, wall;		/* pulses; nothing goes beyond wall */
	bool clips, sto;
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
		if (a->status == 0x1037)
			a->at = a->target < a->wall ? a->target : a->wall;
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

static void on_target(struct world *w, uint32_t i, const struct can_frame *f)
{
	struct axis *a = &w->axis[i];
	const int32_t to = (int32_t)can_get(f->data + 2, 4);

	a->control = (uint16_t)can_get(f->data, 2);
	if (a->status == 0x1037 && a->control == 0x0f && abs(to - a->target) >
	    w->leap)
		w->leap = abs(to - a->target);
	a->target = to;
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

		if (high && !a->high && a->at + by <= a->wall)
			a->at += by;
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

/* @peak_mm: there the path turns X round; 0: the line. */
static void path_make(struct world *w, double peak_mm)
{
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	const double end[INTERP_NAXES] = { 3, 1.5 };
	const double peak[INTERP_NAXES] = { peak_mm, 0.6 };
	const double behind[INTERP_NAXES] = { 0, 1.2 };

	help_word.feed_mm_s = 8;
	if (peak_mm > 0)
		line(b, peak);
	line(b, peak_mm > 0 ? behind : end);
	w->m = finish(b);
}

static void world_make_path(struct world *w, bool lines, double peak_mm)
{
	memset(w, 0, sizeof(*w));
	w->lines = lines;
	path_make(w, peak_mm);
	config_defaults(&w->c);
	w->c.backend = lines ? BACKEND_GPIO : BACKEND_CAN402;
	w->c.axes = help_machine;
	w->c.can402.node[INTERP_X] = 1;
	w->c.can402.node[INTERP_Y] = 2;
	config_cycle(&w->c, &w->k);
	w->k.dry_run = true;
	for (int i = 0; i < NAXES; i++)
		w->axis[i] = (struct axis) { .wall = NONE, .status = 0x40,
					     .count = tmpfile() };
	machine_open(w);
	run_for(w, 1);
	assert_false(w->in.starting);
	assert_int_equal(cycle_load(&w->cycle, &w->m.p), ANSWER_DONE);
}

static void world_make(struct world *w, bool lines)
{
	world_make_path(w, lines, 0);
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
	};
	const uint32_t seg = w->cycle.cursor.index, tick = w->cycle.cursor.tick;
	int32_t zero[IO_NAXES] = { 0 };
	enum cycle_answer answer;
	struct interp_cursor at;
	struct axis_state s;

	memcpy(past.moved_mm, w->cycle.resync.moved_mm, sizeof(past.moved_mm));
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

static void run_until_x(struct world *w, int32_t x)
{
	for (int i = 0; i < 1000000 && w->axis[INTERP_X].at < x; i++)
		period(w);
	assert_true(w->axis[INTERP_X].at >= x);
}

/* Then it is held, X stands at an obstacle, and no drive has power. */
static void stop(struct world *w, enum stopped by)
{
	struct axis *x = &w->axis[INTERP_X];

	if (by == BY_FOLLOWING || by == BY_LIMIT || by == BY_KILL)
		x->wall = WALL;
	x->clips = by == BY_LIMIT;
	assert_int_equal(ask(w, CYCLE_START, 0), ANSWER_DONE);
	run_until_x(w, WALL);
	if (by == BY_KILL) {
		for (int i = 0; i < 4; i++)
			period(w);
		killed(w);
		return;
	}
	x->sto = by == BY_STO;
	w->estop = by == BY_ESTOP;
	for (int i = 0; i < 100000 && w->cycle.state != STATE_FAULT; i++)
		period(w);
	run_for(w, 0.5);
	x->wall = x->at;
	x->sto = w->estop = false;
	assert_int_equal(w->cycle.state, STATE_FAULT);
	run_for(w, 0.3);
	assert_int_equal(ask(w, CYCLE_RESET, 0), ANSWER_DONE);
	run_for(w, 0.3);
	assert_int_equal(w->cycle.state, STATE_HOLD);
	assert_int_equal(x->at, x->wall);
}

/* -- The table ------------------------------------------------------------- */

static bool is_met(bool lines, enum stopped by)
{
	return !lines || by == BY_FOLLOWING || by == BY_ESTOP || by == BY_KILL;
}

/* Where X is on the path, or stands, whichever is nearer to the start. */
static int32_t begins_at(const struct world *w)
{
	const int32_t path = w->cycle.out.target[INTERP_X];
	const int32_t at = w->axis[INTERP_X].at;

	return at < path ? at : path;
}

static void is_at(const struct world *w, int32_t x)
{
	assert_in_range(w->axis[INTERP_X].at - x + 4, 0, 8);
	assert_in_range(w->axis[INTERP_Y].at - x / 2 + 4, 0, 8);
}

static void look_anew(struct world *w)
{
	w->most = INT32_MIN;
	w->leap = 0;
}

/* X was not sent on toward the obstacle, and leaps nowhere. */
static void was_kind(const struct world *w, int32_t stood)
{
	assert_true(w->most <= stood + 2);
	assert_true(w->leap <= 80e3 * (double)w->k.period_ns * 1e-9 + 2);
}

static void retracts(struct world *w)
{
	const int32_t stood = w->axis[INTERP_X].at, from = begins_at(w);

	assert_int_equal(ask(w, CYCLE_RETRACT, 0.3 * PATH_PER_X), ANSWER_DONE);
	stands(w);
	is_at(w, from - 300);
	was_kind(w, stood);
	/* And again, and it begins there. */
	assert_int_equal(ask(w, CYCLE_RETRACT, 0.3 * PATH_PER_X), ANSWER_DONE);
	stands(w);
	is_at(w, from - 600);
}

static void steps_back(struct world *w)
{
	const int32_t stood = w->axis[INTERP_X].at;

	assert_int_equal(ask(w, CYCLE_STEP, -1), ANSWER_DONE);
	stands(w);
	is_at(w, 0);
	was_kind(w, stood);
}

static void jogs_away(struct world *w)
{
	const int32_t stood = w->axis[INTERP_X].at;

	assert_int_equal(ask(w, CYCLE_STOP, 0), ANSWER_DONE);
	run_for(w, 0.1);
	assert_int_equal(ask(w, CYCLE_JOG, -0.05), ANSWER_DONE);
	stands(w);
	assert_int_equal(w->cycle.state, STATE_IDLE);
	assert_in_range(w->axis[INTERP_X].at - stood + 50 + 2, 0, 4);
	was_kind(w, stood);
}

/* The obstacle is gone: the job ends. */
static void goes_on(struct world *w)
{
	const int32_t stood = w->axis[INTERP_X].at;

	w->axis[INTERP_X].wall = NONE;
	assert_int_equal(ask(w, CYCLE_START, 0), ANSWER_DONE);
	while (w->cycle.axes.phase != AXES_FREE)
		period(w);
	was_kind(w, stood);
	stands(w);
	assert_int_equal(w->cycle.outcome, OUTCOME_DONE);
	is_at(w, 3000);
}

/* It is still there: the same stop again, where it was, and the same way out.
 */
static void tries_again(struct world *w)
{
	const int32_t stood = w->axis[INTERP_X].at;

	assert_int_equal(ask(w, CYCLE_START, 0), ANSWER_DONE);
	while (w->cycle.axes.phase != AXES_FREE)
		period(w);
	was_kind(w, stood);
	stands(w);
	assert_int_equal(w->cycle.state, STATE_FAULT);
	run_for(w, 0.3);
	assert_int_equal(ask(w, CYCLE_RESET, 0), ANSWER_DONE);
	run_for(w, 0.3);
	look_anew(w);
	retracts(w);
}

static void (*const verbs[])(struct world *) = {
	retracts, steps_back, jogs_away, goes_on, tries_again
};

static void every_stop_has_a_way_out_by_every_verb(void **st)
{
	(void)st;
	for (int lines = 0; lines < 2; lines++) {
		for (int by = 0; by < NSTOPS; by++) {
			for (size_t v = 0; v < sizeof(verbs) /
			     sizeof(verbs[0]); v++) {
				struct world w;

				if (!is_met(lines, (enum stopped)by))
					continue;
				print_message("%s, %s, verb %zu\n", lines ?
					      "gpio" : "can402",
					      stop_names[by], v);
				world_make(&w, lines);
				stop(&w, (enum stopped)by);
				look_anew(&w);
				verbs[v](&w);
				world_free(&w);
			}
		}
	}
}

/* X was blocked in front of the place where the path turns it round; when the
 * machine stands, the path is behind that place. */
static void stop_behind_the_peak(struct world *w, bool kill)
{
	struct axis *x = &w->axis[INTERP_X];
	int32_t top = WALL;

	x->wall = WALL;
	assert_int_equal(ask(w, CYCLE_START, 0), ANSWER_DONE);
	run_until_x(w, WALL);
	while (w->cycle.out.target[INTERP_X] >= top - 2 &&
	       w->cycle.state != STATE_FAULT) {
		if (w->cycle.out.target[INTERP_X] > top)
			top = w->cycle.out.target[INTERP_X];
		period(w);
	}
	if (kill) {
		for (int i = 0; i < 4; i++)
			period(w);
		killed(w);
		return;
	}
	w->estop = true;
	run_for(w, 0.5);
	w->estop = false;
	run_for(w, 0.3);
	assert_int_equal(ask(w, CYCLE_RESET, 0), ANSWER_DONE);
	run_for(w, 0.3);
	/* A motor that has lost its pulses goes back with the path. */
	assert_in_range(x->at, WALL - (w->lines ? 9 : 0), WALL);
}

/* Killed: drives tell the next edmd where they stand.  An encoder that counts
 * from where it is does not tell what was lost before. */
static void an_axis_blocked_before_its_path_turns_is_met_before_that(void **st)
{
	static const double peaks_mm[] = { 1.02, 1.04, 1.1, 1.2 };
	static const char *const hows[] = { "drives", "drives, killed",
					    "lines" };

	(void)st;
	for (int i = 0; i < 12; i++) {
		struct world w;

		print_message("%s, peak %g\n", hows[i % 3], peaks_mm[i / 3]);
		world_make_path(&w, i % 3 == 2, peaks_mm[i / 3]);
		stop_behind_the_peak(&w, i % 3 == 1);
		look_anew(&w);
		assert_int_equal(ask(&w, CYCLE_RETRACT, 0.3), ANSWER_DONE);
		stands(&w);
		was_kind(&w, WALL);
		assert_true(w.axis[INTERP_X].at < WALL);
		assert_int_equal(w.axis[INTERP_X].at,
				 w.cycle.out.target[INTERP_X]);
		world_free(&w);
	}
}

/* In each period of its way back it is held once, and then retracts. */
static void a_way_back_that_was_held_ends_before_a_retract(void **st)
{
	bool walked = true;

	(void)st;
	for (int periods = 1; walked; periods++) {
		struct world w;

		world_make(&w, false);
		stop(&w, BY_FOLLOWING);
		w.axis[INTERP_X].wall = NONE;
		assert_int_equal(ask(&w, CYCLE_START, 0), ANSWER_DONE);
		for (int i = 0; i < periods ||
		     w.cycle.axes.phase == AXES_POWER; i++)
			period(&w);
		walked = w.cycle.axes.phase != AXES_FREE;
		assert_int_equal(ask(&w, CYCLE_HOLD, 0), ANSWER_DONE);
		stands(&w);
		assert_int_equal(ask(&w, CYCLE_RETRACT, 0.3), ANSWER_DONE);
		stands(&w);
		assert_int_equal(w.axis[INTERP_X].at,
				 w.cycle.out.target[INTERP_X]);
		world_free(&w);
	}
}

/* Nobody knows what is in the way there; without the job an axis is free. */
static void an_axis_that_was_moved_far_by_hand_is_not_driven_back(void **st)
{
	(void)st;
	for (int lines = 0; lines < 2; lines++) {
		struct world w;

		world_make(&w, lines);
		stop(&w, BY_ESTOP);
		w.axis[INTERP_Y].at += 700;
		run_for(&w, 0.3);
		for (int i = 0; i < 3; i++) {
			const int32_t x = w.axis[INTERP_X].at;
			const int32_t y = w.axis[INTERP_Y].at;

			assert_int_equal(ask(&w, i ? CYCLE_RETRACT :
					     CYCLE_START, 0.1), ANSWER_DONE);
			stands(&w);
			assert_int_equal(w.cycle.fault.first, FAULT_FOLLOWING);
			assert_int_equal(w.axis[INTERP_X].at, x);
			assert_int_equal(w.axis[INTERP_Y].at, y);
			assert_int_equal(ask(&w, CYCLE_RESET, 0), ANSWER_DONE);
			run_for(&w, 0.3);
		}
		look_anew(&w);
		jogs_away(&w);
		world_free(&w);
	}
}

/* A hand on the STO button: nothing is accepted, and its release moves
 * nothing. */
static void without_power_a_verb_is_refused_and_its_return_starts_nothing(
	void **st)
{
	(void)st;
	for (int job = 0; job < 2; job++) {
		struct world w;

		world_make(&w, false);
		if (!job)
			assert_int_equal(ask(&w, CYCLE_STOP, 0), ANSWER_DONE);
		w.axis[INTERP_Y].sto = true;
		run_for(&w, 0.5);
		assert_int_equal(ask(&w, job ? CYCLE_START : CYCLE_JOG, 1),
				 ANSWER_NO_POWER);
		run_for(&w, 3.5);
		w.axis[INTERP_Y].sto = false;
		run_for(&w, 1);
		assert_int_equal(w.axis[INTERP_X].at, 0);
		assert_int_equal(w.axis[INTERP_X].status, 0x31);
		assert_int_equal(w.cycle.fault.latched, 0);
		assert_int_equal(ask(&w, job ? CYCLE_START : CYCLE_JOG, 1),
				 ANSWER_DONE);
		/* Pressed while the axes get power: over, too. */
		w.axis[INTERP_Y].sto = true;
		run_for(&w, 0.3);
		w.axis[INTERP_Y].sto = false;
		run_for(&w, 1);
		assert_int_equal(w.cycle.fault.first, FAULT_DRIVE);
		assert_int_equal(w.axis[INTERP_X].at, 0);
		world_free(&w);
	}
}

/* It stands: what is watched in motion, such as axes without power or the
 * door, is no fault any more. */
static void a_fault_ends_a_way_by_command(void **st)
{
	static const enum cycle_verb ways[] = { CYCLE_RETRACT, CYCLE_STEP };

	(void)st;
	for (int lines = 0; lines < 2; lines++) {
		for (int i = 0; i < 2; i++) {
			struct world w;

			world_make(&w, lines);
			assert_int_equal(ask(&w, CYCLE_START, 0), ANSWER_DONE);
			run_until_x(&w, WALL);
			assert_int_equal(ask(&w, CYCLE_HOLD, 0), ANSWER_DONE);
			stands(&w);
			assert_int_equal(ask(&w, ways[i], i ? -1 : 0.9),
					 ANSWER_DONE);
			run_for(&w, 0.05);
			assert_true(w.cycle.hold.moving);
			assert_int_equal(ask(&w, CYCLE_ESTOP, 0), ANSWER_DONE);
			run_for(&w, 1);
			assert_int_equal(w.cycle.state, STATE_FAULT);
			assert_false(cycle_moves(&w.cycle));
			assert_int_equal(w.cycle.fault.latched,
					 fault_bit(FAULT_ESTOP));
			world_free(&w);
		}
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_fault_ends_a_way_by_command),
		cmocka_unit_test(every_stop_has_a_way_out_by_every_verb),
		cmocka_unit_test(an_axis_blocked_before_its_path_turns_is_met_before_that),
		cmocka_unit_test(a_way_back_that_was_held_ends_before_a_retract),
		cmocka_unit_test(an_axis_that_was_moved_far_by_hand_is_not_driven_back),
		cmocka_unit_test(without_power_a_verb_is_refused_and_its_return_starts_nothing),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
