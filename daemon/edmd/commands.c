/* SPDX-License-Identifier: Apache-2.0 */
/*
 * commands.c - takes commands from the ring, and answers them
 *
 * The other side is another process with fewer rights: every field is checked
 * here or in the cycle.  A command for an edmd that has ended never moves
 * anything.
 */
#include "loop.h"

#include "clock.h"
#include "clocks.h"

#include <string.h>

/* So many commands are taken in one period.  The ring may hold more. */
#define COMMANDS_A_PERIOD	4

static enum cycle_answer load_ask(struct loop *l, const struct shm_command *c)
{
	struct ask a = { .id = c->id, .n = c->arg };

	if (c->arg == 0)
		return ANSWER_BAD_ARGUMENT;
	if (l->opening || l->unloading || l->cycle.state != STATE_IDLE ||
	    !crossing_ask(&l->crossing, &a))
		return ANSWER_WRONG_STATE;
	l->opening = true;
	return ANSWER_DONE;
}

/* Only what an idle machine has memory for.  It is answered before it is done,
 * because nothing depends on it. */
static enum cycle_answer ahead_ask(struct loop *l, const struct shm_command *c)
{
	const struct ask a = { .n = c->arg, .ahead = true };

	if (c->arg == 0)
		return ANSWER_BAD_ARGUMENT;
	if (l->program || l->opening || l->ahead ||
	    l->cycle.state != STATE_IDLE || !crossing_ask(&l->crossing, &a))
		return ANSWER_WRONG_STATE;
	l->ahead = true;
	return ANSWER_DONE;
}

/* The ring has room: at most one program is open, and two more are asked
 * for. */
static void program_retire(struct loop *l, struct program *p)
{
	struct ask a = { .close = p };

	if (p)
		crossing_ask(&l->crossing, &a);
}

/* A held job is stopped first; the cycle needs a period for that. */
static enum cycle_answer unload_ask(struct loop *l,
				    const struct shm_command *c)
{
	static const struct cycle_command stop = { .verb = CYCLE_STOP };

	if (!l->program || (c->arg && c->arg != l->program->n))
		return ANSWER_NO_PROGRAM;
	if (l->opening || l->unloading || !loop_stands(l))
		return ANSWER_WRONG_STATE;
	if (l->cycle.loaded && l->cycle.state == STATE_FAULT)
		return ANSWER_WRONG_STATE;
	if (l->cycle.loaded)
		cycle_command(&l->cycle, &stop);
	l->unloading = c->id;
	return ANSWER_DONE;
}

static void unload_finish(struct loop *l)
{
	enum cycle_answer answer = ANSWER_DONE;
	uint64_t id = l->unloading;

	if (id == 0 || (l->cycle.loaded && l->cycle.state != STATE_FAULT))
		return;
	l->unloading = 0;
	if (l->cycle.loaded) {
		answer = ANSWER_WRONG_STATE;
	} else {
		program_retire(l, l->program);
		l->program = NULL;
	}
	loop_answer(l, id, (int32_t)answer);
}

/* What a drive is told must not meet a job, nor motion.  A machine with a fault
 * stands, and may need it. */
static bool may_set(const struct loop *l)
{
	return !l->program && !l->opening && loop_stands(l);
}

static enum cycle_answer object_ask(struct loop *l, const struct shm_command *c)
{
	struct cia402_request r = {
		.axis = (uint8_t)(c->arg >> 24),
		.index = (uint16_t)(c->arg >> 8), .sub = (uint8_t)c->arg,
		.sets = c->verb == SHM_OBJECT_SET,
	};

	if (!l->io.object || !(c->arg_mm >= 0 && c->arg_mm <= UINT32_MAX))
		return ANSWER_BAD_ARGUMENT;
	r.value = (uint32_t)c->arg_mm;
	if ((r.sets && !may_set(l)) || l->asking ||
	    !l->io.object(l->io.self, &r))
		return ANSWER_WRONG_STATE;
	l->asking = c->id;
	return ANSWER_DONE;
}

void loop_drives(struct loop *l)
{
	struct cia402_told told;
	const uint64_t id = l->asking;

	if (!l->io.drives)
		return;
	l->io.drives(l->io.self, &told);
	shm_drives_put(l->status, &told);
	if (id == 0 || told.answer.end == CIA402_UNDER_WAY)
		return;
	l->asking = 0;
	loop_answer(l, id, (int32_t)ANSWER_DONE);
}

/* Such a motion is answered when it begins: rt/moved.h. */
static bool verb_moves(uint32_t verb)
{
	return verb == CYCLE_RETRACT || verb == CYCLE_STEP ||
	       verb == CYCLE_JOG || verb == CYCLE_HOME ||
	       verb == CYCLE_JOG_ON;
}

static enum cycle_answer pass_on(struct loop *l, const struct shm_command *c)
{
	struct cycle_command m = {
		.id = (uint32_t)c->id, .verb = c->verb, .arg = c->arg,
		.arg_mm = c->arg_mm,
	};
	const double was = conditions_value(&l->cycle, c->arg);
	enum cycle_answer answer;

	if (c->verb >= CYCLE_NVERBS)
		return ANSWER_BAD_ARGUMENT;
	/* A program that is being opened begins where the axes stand now. */
	if ((c->verb == CYCLE_JOG || c->verb == CYCLE_HOME ||
	     c->verb == CYCLE_JOG_ON || c->verb == CYCLE_PLACE) && l->opening)
		return ANSWER_WRONG_STATE;
	answer = cycle_command(&l->cycle, &m);
	if (answer == ANSWER_DONE && verb_moves(c->verb))
		l->moved_by = c->id;
	if (c->verb == CYCLE_SET && answer == ANSWER_DONE) {
		loop_sets(l);
		loop_event_set(l, c->arg, was,
			       conditions_value(&l->cycle, c->arg));
	}
	return answer;
}

static bool is_for_us(const struct loop *l, const struct shm_command *c)
{
	return c->instance == l->status->head.instance && !l->ending;
}

/* It was taken before, by this edmd or an earlier one.  It is answered and not
 * carried out again. */
static bool is_repeat(struct loop *l, const struct shm_command *c)
{
	struct shm_done d;

	if (!shm_done(l->status, c->id, &d))
		return false;
	if (d.code != SHM_TAKEN)
		loop_event(l, SHM_EV_ANSWER, c->id, d.code);
	else if (d.instance != l->status->head.instance)
		loop_answer(l, c->id, SHM_CUT_SHORT);
	return true;
}

/* An edmd that was stopped finds old commands, whose senders do not wait any
 * more. */
static bool is_late(const struct shm_command *c)
{
	return clock_ns(CLOCK_MONOTONIC) > c->until_ns;
}

/* There are many signs in a second, each is new, and a repeated one does no
 * harm.  So they are not recorded, to leave room for the other commands. */
static bool is_sign(const struct shm_command *c)
{
	return c->verb == SHM_DO_JOG_ON;
}

static bool is_ending(const struct shm_command *c)
{
	return c->verb == SHM_DO_HOLD || c->verb == SHM_DO_STOP ||
	       c->verb == SHM_DO_ESTOP;
}

/*
 * An act that ends motion comes by two ways, and the slower copy may find that
 * a start went between: then it ends the motion once more.  Otherwise it is
 * done already.
 */
static void end_again(struct loop *l, const struct shm_command *c)
{
	if (is_ending(c) && is_for_us(l, c) && !loop_stands(l))
		pass_on(l, c);
}

static void carry_out(struct loop *l, const struct shm_command *c)
{
	bool later = c->verb == SHM_LOAD || c->verb == SHM_UNLOAD ||
		     c->verb == SHM_OBJECT_GET || c->verb == SHM_OBJECT_SET;
	enum cycle_answer answer = ANSWER_WRONG_STATE;

	/* A command without an id cannot be answered. */
	if (c->id == 0)
		return;
	if (is_repeat(l, c)) {
		end_again(l, c);
		return;
	}
	if (!is_sign(c))
		shm_done_begin(l->status, c->id);
	if (is_late(c)) {
		loop_answer(l, c->id, SHM_LATE);
		return;
	}
	if (!is_for_us(l, c))
		later = false;
	else if (c->verb == SHM_LOAD)
		answer = load_ask(l, c);
	else if (c->verb == SHM_UNLOAD)
		answer = unload_ask(l, c);
	else if (c->verb == SHM_AHEAD)
		answer = ahead_ask(l, c);
	else if (later)
		answer = object_ask(l, c);
	else
		answer = pass_on(l, c);

	/* A command that is under way is answered when it is done. */
	if (later && answer == ANSWER_DONE)
		return;
	loop_answer(l, c->id, (int32_t)answer);
	loop_notice(l);
}

void loop_commands(struct loop *l)
{
	struct shm_command c;

	unload_finish(l);
	for (int i = 0; i < COMMANDS_A_PERIOD; i++) {
		if (!shm_stop_take(l->stops, &c) &&
		    !shm_command_take(l->commands, &c))
			return;
		carry_out(l, &c);
	}
}

/* There may have been a fault while the program was opened. */
static enum cycle_answer load(struct loop *l, struct program *p)
{
	enum cycle_answer answer;

	if (l->ending)
		return ANSWER_WRONG_STATE;
	/* Loading moves nothing, not even to the place where the program
	 * begins. */
	if (!probe_is_start(&l->cycle, &p->cursor))
		return ANSWER_ELSEWHERE;
	answer = cycle_load(&l->cycle, &p->cursor.p);
	if (answer != ANSWER_DONE)
		return answer;
	program_retire(l, l->program);
	l->program = p;
	loop_sets(l);
	return ANSWER_DONE;
}

void loop_replies(struct loop *l)
{
	struct reply r;

	if (!crossing_reply_take(&l->crossing, &r))
		return;
	if (r.ahead) {
		l->ahead = false;
		return;
	}
	l->opening = false;
	if (r.answer == ANSWER_DONE) {
		r.answer = load(l, r.program);
		if (r.answer != ANSWER_DONE)
			program_retire(l, r.program);
	}
	loop_answer(l, r.id, (int32_t)r.answer);
	if (r.answer == ANSWER_DONE)
		loop_event(l, SHM_EV_LOADED, r.id, (int32_t)l->program->n);
	loop_notice(l);
}
