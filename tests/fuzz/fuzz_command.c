/* SPDX-License-Identifier: Apache-2.0 */
/*
 * fuzz_command.c - send any packets to edmd's command socket
 *
 * The input is a row of records: a kind, and its contents.  There are whole
 * commands with any values, packets that are not commands, periods that pass,
 * programs that edmd's main thread opens meanwhile, and other states of the
 * machine's switches.  No target of a drive may change unless a verb of motion
 * was answered "done", and no axis may leave its travel.
 */
#include "command.c"

#include "resume_help.h"

#include "fuzz_help.h"

#define STILL_PERIODS	3
#define MOTIONS		256

static struct {
	struct loop l;
	struct io_inputs in;
	struct io_outputs out;
	int fd;				/* the service's end */
	struct shm_follow events;
	uint64_t motion[MOTIONS]; /* ids that asked for it, the last ones */
	unsigned int motions;
	bool asked;			/* something may move */
} w;

/* There is no PLC. */
void loop_plc_read(struct loop *l)
{
	(void)l;
}

void loop_plc_write(struct loop *l)
{
	(void)l;
}

void loop_plc_input(struct loop *l, struct io_inputs *in)
{
	(void)l, (void)in;
}

struct input {
	const uint8_t *at;
	size_t left;
};

static void take(struct input *i, void *to, size_t bytes)
{
	const size_t n = bytes < i->left ? bytes : i->left;

	memset(to, 0, bytes);
	memcpy(to, i->at, n);
	i->at += n;
	i->left -= n;
}

static uint8_t take_byte(struct input *i)
{
	uint8_t b;

	take(i, &b, 1);
	return b;
}

/* -- The programs there are: 1 begins at zero, the others elsewhere ------- */

static const struct interp_program *program_of(uint32_t n)
{
	static struct made made[2];
	const int elsewhere = n % 2 == 0;
	struct interp_build_options o = { .machine = &help_machine };
	double end[INTERP_NAXES] = { [INTERP_X] = 2, [INTERP_Z] = -1 };
	struct interp_build *b;

	if (!made[elsewhere].block) {
		interp_build_destroy(begin(INTERP_SIMULTANEOUS));
		o.start_mm[INTERP_X] = elsewhere;
		b = interp_build_create(&o);
		assert(b);
		line(b, end);
		made[elsewhere] = finish(b);
	}
	return &made[elsewhere].p;
}

/* edmd's main thread. */
static void serve(void)
{
	struct reply r;
	struct ask a;

	while (crossing_ask_take(&w.l.crossing, &a)) {
		if (a.close) {
			free(a.close);
			continue;
		}
		r = (struct reply){ .id = a.id, .answer = ANSWER_BAD_ARGUMENT };
		if (a.n % 3) {
			r.program = calloc(1, sizeof(*r.program));
			assert(r.program);
			r.program->n = a.n;
			r.program->key = 1;
			assert(interp_cursor_init(&r.program->cursor,
						  program_of(a.n)) == 0);
			r.answer = ANSWER_DONE;
		}
		assert(crossing_reply(&w.l.crossing, &r));
	}
}

/* -- The property --------------------------------------------------------- */

static void note_motion(const struct shm_command *c)
{
	const uint32_t v = c->verb;

	if (v == SHM_DO_START || v == SHM_DO_RESUME || v == SHM_DO_RETRACT ||
	    v == SHM_DO_STEP || v == SHM_DO_JOG || v == SHM_DO_HOME ||
	    v == SHM_DO_JOG_ON)
		w.motion[w.motions++ % MOTIONS] = c->id;
}

static bool is_motion(uint64_t id)
{
	for (unsigned int i = 0; i < MOTIONS; i++)
		if (w.motion[i] == id && id)
			return true;
	return false;
}

/* Since the last look. */
static bool motion_was_granted(void)
{
	struct shm_event e;
	bool any = false;

	while (shm_event_next(w.l.status, &w.events, &e))
		any = any || (e.kind == SHM_EV_ANSWER && e.code == SHM_DONE &&
			      is_motion(e.id));
	return any;
}

static void turn(void)
{
	int32_t before[INTERP_NAXES];

	memcpy(before, w.out.target, sizeof(before));
	loop_commands(&w.l);
	serve();
	loop_replies(&w.l);
	w.asked = motion_was_granted() || w.asked;
	cycle_step(&w.l.cycle, &w.in, &w.out);
	loop_notice(&w.l);
	for (int i = 0; i < INTERP_NAXES; i++) {
		const int32_t at = w.l.cycle.out.target[i];

		assert(at >= w.l.cycle.config.travel_min[i]);
		assert(at <= w.l.cycle.config.travel_max[i]);
		assert(w.asked || w.out.target[i] == before[i]);
	}
	assert(w.asked || !w.out.power);
	/* It came to an end: from here on somebody must ask again. */
	if (loop_stands(&w.l) && !w.l.cycle.loaded)
		w.asked = false;
}

/* -- The records ---------------------------------------------------------- */

static void put_command(struct input *i)
{
	const uint8_t how = take_byte(i), verb = take_byte(i);
	struct shm_command c = {
		.id = take_byte(i), .verb = verb,
		.instance = w.l.status->head.instance, .until_ns = INT64_MAX,
	};

	if (how & 1)
		c.arg = take_byte(i) % 9;
	else
		take(i, &c.arg, sizeof(c.arg));
	if (how & 2)
		c.arg_mm = (int8_t)take_byte(i) * 0.1;
	else
		take(i, &c.arg_mm, sizeof(c.arg_mm));
	if ((how & 0x1c) == 0x04)
		take(i, &c.until_ns, sizeof(c.until_ns));
	if ((how & 0x1c) == 0x08)
		take(i, &c.instance, sizeof(c.instance));
	if ((how & 0x1c) == 0x0c)
		take(i, &c.verb, sizeof(c.verb));
	if ((how & 0x1c) == 0x10)
		take(i, &c.id, sizeof(c.id));
	assert(send(w.fd, &c, sizeof(c), MSG_DONTWAIT) == sizeof(c));
	note_motion(&c);
	commands_receive(w.l.commands);
}

static void connect_again(void)
{
	int pair[2];

	if (w.l.commands->connected >= 0)
		close(w.l.commands->connected);
	if (w.fd >= 0)
		close(w.fd);
	assert(socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK, 0, pair) ==
	       0);
	w.l.commands->connected = pair[0];
	w.fd = pair[1];
}

/* Of any length; what is no command ends the connection. */
static void put_packet(struct input *i)
{
	uint8_t packet[255];
	const size_t n = take_byte(i);
	struct shm_command c;

	take(i, packet, n);
	if (n == 0 || send(w.fd, packet, n, MSG_DONTWAIT) != (ssize_t)n)
		return;
	if (n == sizeof(c)) {
		memcpy(&c, packet, sizeof(c));
		note_motion(&c);
	}
	commands_receive(w.l.commands);
	if (n != sizeof(c)) {
		assert(w.l.commands->connected < 0);
		connect_again();
	}
}

static void change_inputs(uint8_t b)
{
	w.in.estop = (b & 0x83) == 0x83;
	w.in.limit = b & 4 ? 1u << INTERP_X : 0;
	w.in.starting = (b & 8) != 0;
	w.in.gap_v = b & 16 ? SHORTED_V : b & 32 ? OPEN_V : SPARKING_V;
}

/* -- One machine ---------------------------------------------------------- */

static void begin_machine(bool dry)
{
	struct cycle_config k = usual_config();
	struct shm_status *status = w.l.status;
	struct shm_commands *commands = w.l.commands;

	k.dry_run = dry;
	for (int i = 0; i < 3; i++)
		k.axis[i] = (struct manual_axis) {
			.present = true, .pulse_mm = PULSE_MM,
			.v_max_mm_s = 50, .a_max_mm_s2 = 1000,
			.j_max_mm_s3 = 20000, .jog_mm_s = 20,
			.method = i ? HOME_NONE : HOME_SWITCH,
			.home_toward = -1, .home_fast_mm_s = 20,
			.home_slow_mm_s = 1, .home_back_mm = 0.5,
		};
	if (!status)
		status = malloc(sizeof(*status));
	if (!commands)
		commands = calloc(1, sizeof(*commands));
	assert(status && commands);
	memset(status, 0, offsetof(struct shm_status, trace));
	memset(status->event, 0, sizeof(status->event));
	status->head.instance = 77;
	w.l = (struct loop) { .status = status, .commands = commands };
	cycle_init(&w.l.cycle, &k);
	crossing_init(&w.l.crossing);
	ck_ring_init(&commands->ring, SHM_COMMAND_SLOTS);
	commands->connected = -1;
	w.out = (struct io_outputs) { .place_mm = 0 };
	w.in = (struct io_inputs) { .gap_valid = true, .gap_v = OPEN_V };
	w.events = (struct shm_follow) { .next = 0 };
	w.motions = 0;
	memset(w.motion, 0, sizeof(w.motion));
	w.asked = false;
	w.fd = -1;
	connect_again();
}

static void end_machine(void)
{
	struct reply r;

	serve();
	while (crossing_reply_take(&w.l.crossing, &r))
		free(r.program);
	free(w.l.program);
	close(w.fd);
	close(w.l.commands->connected);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct input i = { data, size };

	begin_machine(take_byte(&i) & 1);
	while (i.left) {
		const uint8_t kind = take_byte(&i);

		if (kind % 4 == 0) {
			put_packet(&i);
		} else if (kind % 4 < 3 && !ring_is_full(w.l.commands)) {
			put_command(&i);
			continue;	/* several in a period */
		} else if (kind % 4 == 3) {
			change_inputs(take_byte(&i));
		}
		for (int n = kind / 4; n >= 0; n--)
			turn();
	}
	for (int n = 0; n < STILL_PERIODS; n++)
		turn();
	end_machine();
	return 0;
}
