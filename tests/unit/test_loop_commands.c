/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_loop_commands.c - what edmd does with a command from the socket
 *
 * The test steps the loop.  Each test sends something that a service should not
 * send, and looks at the answer, at the record of it, and whether an axis has
 * moved.
 */
#include "resume_help.h"

#include "clock.h"
#include "clocks.h"
#include "places.h"
#include "stop_act.h"

#include <errno.h>
#include <poll.h>
#include <stdio.h>
#include <sys/socket.h>

#define SOON_NS	INT64_C(60000000000)	/* a busy machine is no late command */

struct desk {
	struct world w;
	uint32_t instance;
	int fd;
	uint64_t id;			/* of the last command */
	struct program *ahead;
};

/* -EAGAIN: the thread that answers is held up, by a busy machine. */
static void connect_to(struct desk *d)
{
	int err;

	do
		err = shm_command_open(&d->fd, d->w.config.name, &d->instance);
	while (err == -EAGAIN);
	assert_int_equal(err, 0);
}

static void begin_loop(struct desk *d)
{
	struct loop *l = &d->w.l;

	loop_make(&d->w);
	crossing_init(&l->crossing);
	assert_int_equal(shm_command_create(&l->commands, d->w.config.name,
					    l->status->head.instance), 0);
	assert_int_equal(shm_stop_create(&l->stops, d->w.config.name,
					 l->status), 0);
	connect_to(d);
}

static void end_loop(struct desk *d)
{
	shm_command_destroy(d->w.l.commands);
	d->w.l.commands = NULL;
	shm_stop_destroy(d->w.l.stops);
	d->w.l.stops = NULL;
	close(d->fd);
}

static int setup(void **state)
{
	struct desk *d = calloc(1, sizeof(*d));

	assert_non_null(d);
	world_init(&d->w);
	d->w.k.dry_run = true;
	d->w.k.axis[INTERP_X] = (struct manual_axis) {
		.present = true, .pulse_mm = PULSE_MM, .v_max_mm_s = 50,
		.a_max_mm_s2 = 1000, .j_max_mm_s3 = 20000, .jog_mm_s = 20,
	};
	begin_loop(d);
	*state = d;
	return 0;
}

static int teardown(void **state)
{
	struct desk *d = *state;

	end_loop(d);
	program_close(d->ahead);
	world_free(&d->w);
	free(d);
	return 0;
}

static struct shm_command command(struct desk *d, uint32_t verb)
{
	return (struct shm_command) {
		.id = ++d->id, .verb = verb, .instance = d->instance,
		.until_ns = clock_ns(CLOCK_MONOTONIC) + SOON_NS,
	};
}

/* A period of edmd: both threads of it. */
static void turn(struct desk *d)
{
	loop_commands(&d->w.l);
	programs_serve(&d->w.l.crossing, &d->w.config, &d->ahead);
	loop_replies(&d->w.l);
	period(&d->w, OPEN_V);
}

/* Until it is answered. */
static int32_t code_of(struct desk *d, uint64_t id)
{
	struct shm_done done;

	while (!shm_done(d->w.l.status, id, &done) || done.code == SHM_TAKEN) {
		usleep(100);
		turn(d);
	}
	return done.code;
}

static int32_t give(struct desk *d, const struct shm_command *c)
{
	assert_int_equal(shm_command_put(d->fd, c), 0);
	return code_of(d, c->id);
}

static int32_t ask_verb(struct desk *d, uint32_t verb)
{
	const struct shm_command c = command(d, verb);

	return give(d, &c);
}

/* What came before a command was taken before it, a repeat too. */
static int32_t give_again(struct desk *d, const struct shm_command *c)
{
	assert_int_equal(shm_command_put(d->fd, c), 0);
	assert_int_equal(ask_verb(d, SHM_DO_START), SHM_NO_PROGRAM);
	return code_of(d, c->id);
}

static struct shm_command jog(struct desk *d, double mm)
{
	struct shm_command c = command(d, SHM_DO_JOG);

	c.arg = INTERP_X;
	c.arg_mm = mm;
	return c;
}

static int32_t x_after(struct desk *d, int periods_more)
{
	for (int i = 0; i < periods_more; i++)
		turn(d);
	return d->w.out.target[INTERP_X];
}

/* A program that begins at @x pulses, as program.7. */
static void put_program(struct desk *d, double x_mm)
{
	struct interp_build_options o = { .machine = &help_machine };
	struct interp_build *b = begin(INTERP_SIMULTANEOUS);
	double end[INTERP_NAXES] = { [INTERP_X] = x_mm + 3 };

	interp_build_destroy(b);
	o.start_mm[INTERP_X] = x_mm;
	b = interp_build_create(&o);
	assert_non_null(b);
	line(b, end);
	if (d->w.m.block)
		unmake(&d->w.m);
	d->w.m = finish(b);
	program_put(&d->w, &d->w.m);
}

static int32_t load_it(struct desk *d)
{
	struct shm_command c = command(d, SHM_LOAD);

	c.arg = N;
	return give(d, &c);
}

static void a_program_that_begins_elsewhere_is_not_loaded(void **state)
{
	struct desk *d = *state;

	put_program(d, 5);
	assert_int_equal(x_after(d, 3), 0);
	assert_int_equal(load_it(d), SHM_ELSEWHERE);
	assert_int_equal(x_after(d, 50), 0);
	assert_null(d->w.l.program);
	assert_int_equal(ask_verb(d, SHM_DO_START), SHM_NO_PROGRAM);
	assert_int_equal(x_after(d, 50), 0);
	put_program(d, 0);
	assert_int_equal(load_it(d), SHM_DONE);
	assert_int_equal(x_after(d, 50), 0);
	assert_int_equal(ask_verb(d, SHM_DO_START), SHM_DONE);
	assert_true(x_after(d, 50) > 0);
}

/* The file of program.7, under its name for later. */
static void name_ahead(struct desk *d)
{
	char of[SHM_PATH_MAX], to[SHM_PATH_MAX], what[24];

	snprintf(what, sizeof(what), "program.%u", N);
	shm_path(of, d->w.config.name, what);
	snprintf(what, sizeof(what), "program.%u", SHM_PROGRAM_AHEAD);
	shm_path(to, d->w.config.name, what);
	unlink(to);
	assert_int_equal(link(of, to), 0);
}

/* Whoever reads the file after that finds no program. */
static void spoil(struct desk *d)
{
	char path[SHM_PATH_MAX], what[24];

	snprintf(what, sizeof(what), "program.%u", N);
	shm_path(path, d->w.config.name, what);
	assert_int_equal(truncate(path, 8), 0);
}

static int32_t copy_it_ahead(struct desk *d)
{
	struct shm_command c = command(d, SHM_AHEAD);
	int32_t code;

	name_ahead(d);
	c.arg = SHM_PROGRAM_AHEAD;
	code = give(d, &c);
	shm_program_remove(d->w.config.name, SHM_PROGRAM_AHEAD);
	return code;
}

static void a_program_copied_ahead_is_not_read_again(void **state)
{
	struct desk *d = *state;
	const void *block;

	put_program(d, 0);
	assert_int_equal(copy_it_ahead(d), SHM_DONE);
	assert_non_null(d->ahead);
	block = d->ahead->block;
	assert_int_equal(load_it(d), SHM_DONE);
	assert_null(d->ahead);
	assert_ptr_equal(d->w.l.program->block, block);
	assert_int_equal(d->w.l.program->n, N);
	assert_int_equal(ask_verb(d, SHM_DO_START), SHM_DONE);
	assert_true(x_after(d, 50) > 0);
}

static void another_one_than_that_copied_ahead_is_read(void **state)
{
	struct desk *d = *state;

	put_program(d, 5);
	assert_int_equal(copy_it_ahead(d), SHM_DONE);
	put_program(d, 0);
	assert_int_equal(load_it(d), SHM_DONE);
	assert_null(d->ahead);
	assert_int_equal(copy_it_ahead(d), SHM_WRONG_STATE);
	assert_null(d->ahead);
}

static void one_copied_ahead_and_spoiled_is_read_and_refused(void **state)
{
	struct desk *d = *state;

	put_program(d, 0);
	assert_int_equal(copy_it_ahead(d), SHM_DONE);
	spoil(d);
	assert_int_equal(load_it(d), SHM_BAD_ARGUMENT);
	assert_null(d->ahead);
	assert_null(d->w.l.program);
	assert_int_equal(copy_it_ahead(d), SHM_DONE);
	assert_null(d->ahead);
}

static void a_program_of_other_pulses_is_not_loaded(void **state)
{
	struct desk *d = *state;

	put_program(d, 0);
	d->w.config.axes.axis[INTERP_X].pulse_mm *= 2;
	assert_int_equal(load_it(d), SHM_BAD_ARGUMENT);
	assert_int_equal(ask_verb(d, SHM_DO_START), SHM_NO_PROGRAM);
	assert_int_equal(x_after(d, 50), 0);
}

static void a_command_is_done_once(void **state)
{
	struct desk *d = *state;
	const struct shm_command c = jog(d, 0.1);

	assert_int_equal(give(d, &c), SHM_DONE);
	for (int i = 0; i < 3; i++) {
		assert_int_equal(x_after(d, 500), 100);
		assert_int_equal(give_again(d, &c), SHM_DONE);
	}
	assert_int_equal(x_after(d, 500), 100);
}

/* The next edmd has the record of the one before: the same status. */
static void nor_is_it_done_again_by_the_next_edmd(void **state)
{
	struct desk *d = *state;
	struct shm_command c = jog(d, 0.1);
	struct shm_done done;

	assert_int_equal(give(d, &c), SHM_DONE);
	x_after(d, 500);
	end_loop(d);
	d->w.l.status->head.instance++;
	begin_loop(d);
	c.instance = d->instance;
	assert_int_equal(give_again(d, &c), SHM_DONE);
	assert_int_equal(x_after(d, 100), 0);
	/* One that the edmd before began, and ended over. */
	c = jog(d, 0.1);
	shm_done_begin(d->w.l.status, c.id);
	end_loop(d);
	d->w.l.status->head.instance++;
	begin_loop(d);
	c.instance = d->instance;
	assert_int_equal(give_again(d, &c), SHM_CUT_SHORT);
	assert_int_equal(x_after(d, 100), 0);
	assert_true(shm_done(d->w.l.status, c.id, &done));
	assert_int_equal(done.code, SHM_CUT_SHORT);
}

static void a_late_one_is_not_done(void **state)
{
	struct desk *d = *state;
	struct shm_command c = jog(d, 0.1);

	c.until_ns = clock_ns(CLOCK_MONOTONIC) - 1;
	assert_int_equal(give(d, &c), SHM_LATE);
	c = jog(d, 0.1);
	c.until_ns = INT64_MIN;
	assert_int_equal(give(d, &c), SHM_LATE);
	assert_int_equal(x_after(d, 100), 0);
}

static void one_for_another_edmd_or_without_an_id_is_not_done(void **state)
{
	struct desk *d = *state;
	struct shm_command c = jog(d, 0.1);

	c.instance++;
	assert_int_equal(give(d, &c), SHM_WRONG_STATE);
	c = jog(d, 0.1);
	c.id = 0;
	assert_int_equal(shm_command_put(d->fd, &c), 0);
	assert_int_equal(ask_verb(d, SHM_DO_START), SHM_NO_PROGRAM);
	c = command(d, SHM_LOAD);
	c.arg = N;
	c.instance++;
	put_program(d, 0);
	assert_int_equal(give(d, &c), SHM_WRONG_STATE);
	assert_int_equal(x_after(d, 100), 0);
	assert_null(d->w.l.program);
}

static void no_verb_is_no_command(void **state)
{
	static const uint32_t none[] = {
		CYCLE_NVERBS, 99, SHM_AHEAD + 1, 0x80000000u, UINT32_MAX,
	};
	struct desk *d = *state;

	for (size_t i = 0; i < sizeof(none) / sizeof(none[0]); i++)
		assert_int_equal(ask_verb(d, none[i]), SHM_BAD_ARGUMENT);
	assert_int_equal(x_after(d, 100), 0);
}

/* -- A start that is refused ---------------------------------------------- */

struct cause {
	const char *what;
	int32_t answer;
	void (*make)(struct desk *d, bool there);
};

static void fault(struct desk *d, bool there)
{
	assert_int_equal(ask_verb(d, there ? SHM_DO_ESTOP : SHM_DO_RESET),
			 SHM_DONE);
	x_after(d, 2);
}

static void drives_down(struct desk *d, bool there)
{
	d->w.in.starting = there;
	x_after(d, 2);
}

static void on_switch(struct desk *d, bool there)
{
	d->w.in.limit = there ? 1u << INTERP_X : 0;
	x_after(d, 2);
}

static void not_homed(struct desk *d, bool there)
{
	d->w.l.cycle.config.require_home = there;
	d->w.l.cycle.config.axis[INTERP_X].method = there ? HOME_SWITCH :
							    HOME_NONE;
	x_after(d, 2);
}

static void no_permit(struct desk *d, bool there)
{
	d->w.l.cycle.plc.present = true;
	d->w.in.plc = well();
	d->w.in.plc.permit = !there;
	x_after(d, 2);
}

/* The cause ends, and nothing moves until somebody starts it then. */
static void a_refused_start_leaves_nothing_behind(void **state)
{
	static const struct cause causes[] = {
		{ "fault", SHM_WRONG_STATE, fault },
		{ "drives", SHM_NOT_UP, drives_down },
		{ "switch", SHM_AT_LIMIT, on_switch },
		{ "home", SHM_NOT_HOMED, not_homed },
		{ "permit", SHM_SEEN + FAULT_PERMIT, no_permit },
	};
	struct desk *d = *state;

	for (size_t i = 0; i < sizeof(causes) / sizeof(causes[0]); i++) {
		const struct cause *c = &causes[i];
		const int verb = i % 2 ? SHM_DO_START : SHM_DO_RESUME;

		print_message("%s\n", c->what);
		put_program(d, 0);
		assert_int_equal(load_it(d), SHM_DONE);
		c->make(d, true);
		assert_int_equal(ask_verb(d, SHM_DO_START), c->answer);
		assert_int_equal(ask_verb(d, (uint32_t)verb), c->answer);
		c->make(d, false);
		assert_int_equal(x_after(d, 300), 0);
		assert_int_equal(ask_verb(d, SHM_DO_START), SHM_DONE);
		assert_true(x_after(d, 50) > 0);
		end_loop(d);
		program_close(d->w.l.program);
		begin_loop(d);
		d->w.in = (struct io_inputs) { .gap_valid = true };
	}
}

/* -- Acts that end motion, by their own socket ----------------------------- */

#define PERIODS_BEHIND	5

static int stop_open(const struct desk *d)
{
	struct sockaddr_un at;
	int fd;

	assert_int_equal(places_address(&at, d->w.config.name, "stop"), 0);
	fd = places_connect(&at, PLACES_EDMD);
	assert_true(fd >= 0);
	return fd;
}

static void stop_put(int fd, uint32_t verb, uint64_t id)
{
	const struct stop_act a = {
		.magic = STOP_ACT_MAGIC, .verb = verb, .id = id,
	};

	assert_int_equal(send(fd, &a, sizeof(a), 0), sizeof(a));
}

/* Both threads run on: the cycle is stepped until there is an answer. */
static int stop_code(struct desk *d, int fd)
{
	struct pollfd p = { .fd = fd, .events = POLLIN };
	struct stop_answer a;

	while (poll(&p, 1, 1) == 0)
		turn(d);
	assert_int_equal(recv(fd, &a, sizeof(a), 0), sizeof(a));
	assert_int_equal(a.magic, STOP_ACT_MAGIC);
	close(fd);
	return a.code;
}

static int stop_ask(struct desk *d, uint32_t verb, uint64_t id)
{
	const int fd = stop_open(d);

	stop_put(fd, verb, id);
	return stop_code(d, fd);
}

static void run_a_job(struct desk *d)
{
	put_program(d, 0);
	assert_int_equal(load_it(d), SHM_DONE);
	assert_int_equal(ask_verb(d, SHM_DO_START), SHM_DONE);
	assert_true(x_after(d, 50) > 0);
}

/* So long as an act is in edmd's ring, and the ring is full of others. */
static void an_act_is_done_a_few_periods_behind_the_socket(void **state)
{
	struct desk *d = *state;
	struct shm_done done;
	int fd, periods = 0;

	run_a_job(d);
	for (int i = 0; i < SHM_COMMAND_SLOTS / 2; i++) {
		const struct shm_command c = command(d, SHM_DO_STEP);

		assert_int_equal(shm_command_put(d->fd, &c), 0);
	}
	fd = stop_open(d);
	stop_put(fd, STOP_ACT_ESTOP, 4711);
	/* The thread hands it over; no period passes meanwhile. */
	while (shm_stop_waits(d->w.l.stops) == 0)
		usleep(100);
	while (!shm_done(d->w.l.status, 4711, &done)) {
		turn(d);
		periods++;
	}
	print_message("%d periods behind the socket\n", periods);
	assert_true(periods <= PERIODS_BEHIND);
	assert_int_equal(d->w.l.cycle.state, STATE_FAULT);
	assert_false(d->w.out.power);
	assert_int_equal(stop_code(d, fd), 0);
}

static void each_ends_motion_and_nothing_else_is_taken(void **state)
{
	struct desk *d = *state;
	char junk[64] = "stop";
	int fd;

	assert_int_not_equal(stop_ask(d, STOP_ACT_HOLD, 1001), 0);
	run_a_job(d);
	assert_int_equal(stop_ask(d, STOP_ACT_HOLD, 1002), 0);
	assert_int_equal(d->w.l.cycle.state, STATE_HOLD);
	assert_int_equal(stop_ask(d, STOP_ACT_STOP, 1003), 0);
	x_after(d, 300);
	assert_false(d->w.l.cycle.loaded);
	for (uint32_t verb = STOP_ACT_NVERBS; verb < 300; verb += 97) {
		fd = stop_open(d);
		stop_put(fd, verb, 1004);
		for (ssize_t n = -1; n != 0; )
			n = recv(fd, junk, 1, 0);
		close(fd);
	}
	fd = stop_open(d);
	assert_int_equal(send(fd, junk, sizeof(junk), 0), sizeof(junk));
	for (ssize_t n = -1; n != 0; )
		n = recv(fd, junk, 1, 0);
	close(fd);
	assert_int_equal(stop_ask(d, STOP_ACT_ESTOP, 1005), 0);
}

/* By edmd-jobs with the same id, later: a start that was given meanwhile is
 * nobody's mistake as long as it stands; but what moves is ended. */
static void the_copy_that_comes_later_does_it_once(void **state)
{
	struct desk *d = *state;
	struct shm_command copy;
	int32_t x;

	run_a_job(d);
	assert_int_equal(stop_ask(d, STOP_ACT_HOLD, 1001), 0);
	x = x_after(d, 300);
	copy = command(d, SHM_DO_HOLD);
	copy.id = 1001;
	assert_int_equal(give(d, &copy), SHM_DONE);
	assert_int_equal(x_after(d, 50), x);
	/* A start that was on its way when the hold came. */
	assert_int_equal(ask_verb(d, SHM_DO_START), SHM_DONE);
	assert_true(x_after(d, 50) > x);
	assert_int_equal(shm_command_put(d->fd, &copy), 0);
	assert_int_equal(ask_verb(d, SHM_DO_JOG), SHM_WRONG_STATE);
	x = x_after(d, 300);
	assert_int_equal(d->w.l.cycle.state, STATE_HOLD);
	assert_int_equal(x_after(d, 50), x);
}

/* Who connects and says nothing takes nobody's place for long. */
static void silent_ones_keep_no_act_away(void **state)
{
	struct desk *d = *state;
	int silent[40];

	run_a_job(d);
	for (int i = 0; i < 40; i++)
		silent[i] = stop_open(d);
	assert_int_equal(stop_ask(d, STOP_ACT_ESTOP, 1001), 0);
	assert_int_equal(d->w.l.cycle.state, STATE_FAULT);
	for (int i = 0; i < 40; i++)
		close(silent[i]);
}

int main(void)
{
#define T(f)	cmocka_unit_test_setup_teardown(f, setup, teardown)
	const struct CMUnitTest tests[] = {
		T(a_program_that_begins_elsewhere_is_not_loaded),
		T(a_program_copied_ahead_is_not_read_again),
		T(another_one_than_that_copied_ahead_is_read),
		T(one_copied_ahead_and_spoiled_is_read_and_refused),
		T(a_program_of_other_pulses_is_not_loaded),
		T(a_command_is_done_once),
		T(nor_is_it_done_again_by_the_next_edmd),
		T(a_late_one_is_not_done),
		T(one_for_another_edmd_or_without_an_id_is_not_done),
		T(no_verb_is_no_command),
		T(a_refused_start_leaves_nothing_behind),
		T(an_act_is_done_a_few_periods_behind_the_socket),
		T(each_ends_motion_and_nothing_else_is_taken),
		T(the_copy_that_comes_later_does_it_once),
		T(silent_ones_keep_no_act_away),
	};

	return cmocka_run_group_tests_name("loop_commands", tests, NULL, NULL);
}
