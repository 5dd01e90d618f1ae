/* SPDX-License-Identifier: Apache-2.0 */
/*
 * cycle.h - one period of the machine: (state, inputs) -> (state, outputs)
 *
 * The real-time thread calls cycle_step() once in each period with the inputs
 * of the hardware.  edmsim calls the same object code with the inputs of a
 * simulated machine.  A step does these things in this order: it reads the gap,
 * asks the guards, chooses the state, reacts to faults, walks along the path,
 * reacts to faults again, and fills the outputs.
 *
 * The states, and which event leads from one to another, are tables in state.c.
 * Sparks are allowed only in approach and in erode.
 *
 * Units: in every name; time is counted in cycles.  Feed is signed along the
 * path: + toward the program's end, - back along it.
 * Threads: all calls but cycle_init() are RT-safe.  One object belongs to one
 * thread.
 */
#ifndef RT_CYCLE_H
#define RT_CYCLE_H

#include "interp/cursor.h"
#include "gap/arcing.h"
#include "gap/asking.h"
#include "axes/axes.h"
#include "axes/comp.h"
#include "axes/contouring.h"
#include "path/depth.h"
#include "path/escape.h"
#include "fault.h"
#include "gap/flush.h"
#include "gap/gap.h"
#include "axes/manual.h"
#include "interlock.h"
#include "io.h"
#include "axes/limit.h"
#include "path/ground.h"
#include "path/mcode.h"
#include "path/mover.h"
#include "moved.h"
#include "gap/conditions.h"
#include "gap/retract.h"
#include "gap/servo.h"
#include "settings.h"
#include "stand.h"
#include "state.h"
#include "path/probe.h"
#include "path/progress.h"
#include "path/resync.h"
#include "verbs.h"

/* How the last job ended. */
enum cycle_outcome {
	OUTCOME_NONE,			/* no job yet, or the job still runs */
	OUTCOME_DONE,
	OUTCOME_FAULT,
	OUTCOME_STOPPED,		/* by command */
};

struct cycle_config {
	int64_t period_ns;
	struct cycle_gap_config gap;
	struct cycle_jump_config jump;
	struct probe_config probe;
	double travel_a_mm_s2;		/* of positioning, starts and stops */
	double travel_j_mm_s3;
	bool stop_at_nodes;		/* of a jump; only to compare with */
	int32_t travel_min[INTERP_NAXES];	/* soft limits, pulses */
	int32_t travel_max[INTERP_NAXES];
	int32_t start[INTERP_NAXES];	/* where the axes stand first, pulses */
	uint64_t axes_wait_cycles;	/* longest wait until the axes have
					 * power; then it is a fault */
	uint32_t overrun_limit;		/* missed periods in a row; 0: no
					 * fault */
	uint32_t points_max;		/* most lattice points in one cycle */
	bool dry_run;			/* without a gap: walk at the programmed
					 * feed */
	bool optional_stop;		/* M1 holds */
	uint64_t mcode_cycles;		/* longest wait for the PLC; 0: no
					 * limit */
	bool hold_at_end;		/* hold at the end of the program; the
					 * job does not end */
	bool require_home;		/* start only if all axes are homed */
	struct manual_axis axis[INTERP_NAXES];
	uint64_t press_cycles;		/* VERB_PRESS_S, in real time */
	struct comp_config comp;
	struct contouring_config contouring;
	struct resync_config resync;
	struct asking_config asking;
};

/* The verbs of words/verbs.h: CYCLE_START and so on. */
#define CYCLE_VERB(verb)	CYCLE_##verb,
enum cycle_verb {
	VERB_ROWS(CYCLE_VERB)
	CYCLE_NVERBS
};

struct cycle_command {
	uint32_t id;			/* chosen by the sender; the answer
					 * bears it */
	uint32_t verb;			/* enum cycle_verb */
	uint32_t arg;			/* set: enum interp_tech_id; jog, home:
					 * enum interp_axis; start, confirm: the
					 * stand that it is for, or 0 */
	double arg_mm;			/* set: the field's own unit; override:
					 * a factor; step, confirm: a number */
};

/* The answer to a command. */
enum cycle_answer {
	ANSWER_DONE,
	ANSWER_NO_PROGRAM,		/* nothing is loaded */
	ANSWER_WRONG_STATE,		/* not in this state */
	ANSWER_BAD_ARGUMENT,		/* out of range, or not finite */
	ANSWER_NOT_HOMED,		/* start, and [machine] require_home */
	ANSWER_AT_LIMIT,		/* an axis is on its limit switch */
	ANSWER_BEYOND,			/* the jog would leave the travel */
	ANSWER_NO_NODE,			/* the path has fewer nodes that way */
	ANSWER_NOT_PASSED,		/* the step would go over ground that is
					 * not cut yet */
	ANSWER_ELSEWHERE,		/* the program does not begin where the
					 * machine stands */
	ANSWER_NOT_UP,			/* the drives are not up yet */
	ANSWER_PLC_HOLDS,		/* nothing may begin */
	ANSWER_STILL_THERE,		/* reset: the cause is still there */
	ANSWER_NO_POWER,		/* an axis cannot have power now */
	ANSWER_ASKS,			/* start: what the stand asks for was
					 * not confirmed */
	ANSWER_NOT_ASKED,		/* confirm: the stand does not ask for
					 * that */
	ANSWER_OVER,			/* the stand that it is for is over */
	CYCLE_NANSWERS,
	/* And a fault: a guard sees it, so nothing may begin. */
	ANSWER_SEEN = 100
};

/* Sums of one job, for status and report. */
struct cycle_totals {
	uint64_t cycles;		/* since start */
	/* Of these, without what the job waited (stand_now()): cut, with its
	 * jumps and retracts; positioned; and the rest, as dwells, probing,
	 * and air in front of a cut. */
	uint64_t cut_cycles, moved_cycles, other_cycles;
	uint64_t erode_cycles, jump_cycles;
	uint64_t pulses[INTERP_NAXES];
	uint32_t retracts, jumps, shorts, arcs, overruns;
	double energy_j;		/* of the discharges; NAN: the machine
					 * does not count it */
	uint32_t hunts;			/* how often HUNTING_ROW retracts came
					 * in a row */
	uint32_t in_row_max;		/* most retracts in a row, without
					 * progress between them */
	double retract_mm_max;
};

/* A move along the path, kept while it lasts; ahead.c. */
struct cycle_ahead {
	enum cycle_state state;		/* that the move belongs to */
	int toward;			/* +1 or -1 */
	double goal_mm, override;
	struct mover_limits l;		/* as they were when the move began, up
					 * to the place where it stands: */
	double stand_mm;		/* INFINITY: its goal is nearer */
	double entered_mm_s;		/* greatest speed at which it began */
	double room_mm;			/* at constant speed nothing limits it
					 * for this distance */
	bool turns;			/* it went the other way, and has not
					 * stood since */
	bool to_place;			/* the plan is for a place: */
	double place_mm, v_max_mm_s;
};

/* A jump: up, then down to just above the cut. */
struct cycle_lift {
	double from_mm, to_mm;		/* the places where it began and ends */
	double height_mm;
	bool waits;			/* until it stands, and may leave the
					 * path */
	bool up;			/* on its way up */
	bool leaving;			/* the time of a timed part is over: it
					 * does not come back */
};

/* Held: standing, braking, or moved along the path by a command. */
struct cycle_hold {
	bool moving;
	double to_mm;			/* the place that it moves to */
	uint32_t seek;			/* that place is still searched for, in
					 * the segments before this one; 0: it
					 * is found */
	bool braked;			/* it stood at least once since */
	bool fails;			/* when it stands, the state is
					 * fault */
};

/* A part of the program that may also end by time: timed.h. */
struct timed {
	uint32_t end;			/* segment where it ends; 0: none */
	uint64_t left;			/* cycles */
	double from_mm;			/* place where it began */
};

/* Which actions of the program were done. */
struct cycle_job {
	uint32_t electrode;		/* that is to be in; 0: none */
	uint32_t action_done;		/* all actions up to this segment */
	bool dwelling;
	uint64_t dwell_left;		/* cycles */
	bool power_off;			/* the program switched it off (M5) */
	bool stopped;			/* by an operator: it is over where it
					 * stands */
	double rejoin_mm;		/* up to this place it was cut before
					 * the wire broke, so the machine
					 * positions there; 0: no break */
};

struct cycle {
	struct cycle_config config;
	/* The values in force: those of `config`, changed by the condition and
	 * by `set`.  conditions.c writes them, and out.pulse. */
	struct cycle_gap_config gap;
	struct cycle_jump_config jump;
	struct conditions conditions;
	struct interp_cursor cursor;
	bool loaded;			/* the cursor stands on a program */
	enum cycle_state state;
	struct fault fault;		/* what is latched */
	enum cycle_outcome outcome;
	uint64_t count;			/* cycles since cycle_init() */
	struct cycle_totals totals;
	double feed_mm_s;		/* what this cycle really walked */
	double gap_v;			/* as read; it is sensed.v */
	struct gap_reading sensed;	/* this cycle's gap */
	struct gap_memory gap_past;
	double far_mm;			/* farthest place that was reached */
	struct cycle_lift lift;		/* of a jump, or of a return */
	struct cycle_hold hold;
	struct retract retract;		/* the one under way, or the last */
	struct servo servo;
	struct arcing arcing;
	struct asking asking;
	struct stand stand;
	struct flush flush;
	struct probe probe;
	struct mover mover;		/* speed along the path or the escape */
	struct escape escape;		/* the way out beside the path */
	struct axes axes;		/* their power */
	struct resync resync;		/* from where they stand to the path */
	struct cycle_ahead ahead;
	struct manual manual;		/* motion without a program */
	struct moved moved;		/* the motion asked for last */
	struct limit limit;
	struct comp comp;		/* from places to pulses */
	struct contouring contouring;	/* for axes that lag */
	double override;		/* factor on the speed of positioning */
	struct timed timed;
	struct io_plc plc;		/* what the PLC says, as read */
	bool plc_held;			/* one period ago it asked for a hold */
	double plc_axes_c;		/* the temperature that it said then */
	double plc_override;		/* the last one it asked for; NAN: none
					 * yet */
	struct mcode mcode;
	struct progress progress;
	struct depth depth;
	double back_mm;			/* the way back ends at this place */
	double turned_mm;		/* the farthest place that a retract or
					 * a jump left, since the start; it was
					 * passed by then */
	struct cycle_job job;
	uint32_t overruns_in_row;
	bool overran;			/* since the last step */
	bool free_seen;			/* the gap was open since positioning
					 * began */
	bool withdraws;			/* positioning, it met something over
					 * cut ground: it brakes, to retract */
	struct ground ground;		/* was it cut, where it met it? */
	bool at_start;			/* the walk met the program's start */
	bool busy;			/* the machine takes no point now */
	bool cut_short;			/* the last walk fell short of its
					 * way */
	struct io_outputs out;		/* its target: places on the path */

	/* It is called after every lattice point, with the cursor on that
	 * point; may be NULL. */
	void (*on_point)(void *arg, const struct cycle *c);
	void *on_point_arg;
};

/** cycle_is_manual() - is an axis moved without a program? */
static inline bool cycle_is_manual(const struct cycle *c)
{
	return c->state == STATE_JOG || c->state == STATE_HOME;
}

/**
 * cycle_moves() - does anything move or brake, or wait for power in order to
 * move?
 */
static inline bool cycle_moves(const struct cycle *c)
{
	return state_duty[c->state].running || c->hold.moving ||
	       cycle_is_manual(c) || c->axes.phase != AXES_FREE ||
	       c->mover.v_mm_s != 0;
}

/** cycle_init() - an idle machine without a program.  Startup only. */
void cycle_init(struct cycle *c, const struct cycle_config *config);

/**
 * cycle_load() - take a program; the machine is then held at its start.
 *
 * Return: ANSWER_DONE; ANSWER_WRONG_STATE while a job runs;
 * ANSWER_BAD_ARGUMENT if the first segment fails its check.
 */
enum cycle_answer cycle_load(struct cycle *c, const struct interp_program *p);

/**
 * cycle_load_at() - take a cursor that stands somewhere on its program; the
 * machine is then held there.
 *
 * This is for coming back after a crash: interp_cursor_seek() has placed @at
 * outside the cycle.
 */
enum cycle_answer cycle_load_at(struct cycle *c, const struct interp_cursor *at,
				double far_mm);

/** cycle_command() - carry out a command, between two steps. */
enum cycle_answer cycle_command(struct cycle *c, const struct cycle_command *m);

/** cycle_overrun() - say that @missed periods were missed. */
void cycle_overrun(struct cycle *c, uint32_t missed);

/** cycle_step() - one period.  All of @out is filled. */
void cycle_step(struct cycle *c, const struct io_inputs *in,
		struct io_outputs *out);

/* Names for logs, messages and reports.  Any thread. */
const char *cycle_outcome_name(enum cycle_outcome o);
const char *cycle_answer_text(enum cycle_answer a);

#endif /* RT_CYCLE_H */
