/* SPDX-License-Identifier: Apache-2.0 */
/*
 * cycle.h - one period of the machine: (state, inputs) -> (state, outputs)
 *
 * The real-time thread calls cycle_step() once a period with the hardware's
 * inputs; edmsim calls the same object code with a simulated machine's.  The
 * order within: gap, guards, state, faults, walk along the path, faults,
 * outputs.
 *
 * States and what leads from one to the next are tables in state.c.  Spark
 * power is on in approach and erode only.
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
#include "axes/axes.h"
#include "axes/comp.h"
#include "axes/contouring.h"
#include "path/escape.h"
#include "fault.h"
#include "gap/flush.h"
#include "gap/gap.h"
#include "axes/manual.h"
#include "interlock.h"
#include "io.h"
#include "axes/limit.h"
#include "path/mcode.h"
#include "path/mover.h"
#include "gap/conditions.h"
#include "gap/retract.h"
#include "gap/servo.h"
#include "settings.h"
#include "state.h"
#include "path/probe.h"
#include "path/progress.h"
#include "verbs.h"

/* How the last job ended. */
enum cycle_outcome {
	OUTCOME_NONE,			/* none yet, or it runs */
	OUTCOME_DONE,
	OUTCOME_FAULT,
	OUTCOME_STOPPED,		/* by command */
};

struct cycle_config {
	int64_t period_ns;
	struct cycle_gap_config gap;
	struct cycle_jump_config jump;
	struct probe_config probe;
	double travel_a_mm_s2;		/* to start and stop positioning */
	double travel_j_mm_s3;
	bool stop_at_nodes;		/* in a jump; for comparison */
	int32_t travel_min[INTERP_NAXES];	/* soft limits, pulses */
	int32_t travel_max[INTERP_NAXES];
	int32_t start[INTERP_NAXES];	/* where it stands at first, pulses */
	uint64_t axes_wait_cycles;	/* for power on the axes, then a fault */
	uint32_t overrun_limit;		/* missed periods in a row; 0: no fault */
	uint32_t points_max;		/* lattice points in one cycle */
	bool dry_run;			/* no gap: walk at the programmed feed */
	bool optional_stop;		/* M1 holds */
	uint64_t mcode_cycles;		/* longest wait for the PLC; 0: any */
	bool hold_at_end;		/* at the end hold; the job does not end */
	bool require_home;		/* no start before all are homed */
	struct manual_axis axis[INTERP_NAXES];
	uint64_t press_cycles;		/* VERB_PRESS_S of a person's time */
	struct comp_config comp;
	struct contouring_config contouring;
};

/* The verbs of words/verbs.h: CYCLE_START and so on. */
#define CYCLE_VERB(verb)	CYCLE_##verb,
enum cycle_verb {
	VERB_ROWS(CYCLE_VERB)
	CYCLE_NVERBS
};

struct cycle_command {
	uint32_t id;			/* the sender's; answered with it */
	uint32_t verb;			/* enum cycle_verb */
	uint32_t arg;			/* set: enum interp_tech_id; jog, home:
					 * enum interp_axis */
	double arg_mm;			/* set: the field's own unit; override:
					 * a factor; step: a number */
};

/* What a command came to. */
enum cycle_answer {
	ANSWER_DONE,
	ANSWER_NO_PROGRAM,		/* nothing is loaded */
	ANSWER_WRONG_STATE,		/* not in this state */
	ANSWER_BAD_ARGUMENT,		/* out of range, or not finite */
	ANSWER_NOT_HOMED,		/* start, and [machine] require_home */
	ANSWER_AT_LIMIT,		/* an axis is on its limit switch */
	ANSWER_BEYOND,			/* a jog out of the travel */
	ANSWER_NO_NODE,			/* fewer on the path, that way */
	ANSWER_NOT_PASSED,		/* a step over ground not cut yet */
	ANSWER_ELSEWHERE,		/* a program begins where it is not */
	ANSWER_NOT_UP,			/* the drives are not up yet */
	ANSWER_LOCKED,			/* a guard, or the PLC, is against it */
	ANSWER_STILL_THERE,		/* reset: its cause is still there */
	CYCLE_NANSWERS
};

/* Sums of one job, for status and report. */
struct cycle_totals {
	uint64_t cycles;		/* since start */
	uint64_t erode_cycles, jump_cycles;
	uint64_t pulses[INTERP_NAXES];
	uint32_t retracts, jumps, shorts, arcs, overruns;
	double energy_j;		/* of the discharges; NAN: the machine
					 * does not count it */
	uint32_t hunts;			/* rows of HUNTING_ROW retracts */
	uint32_t in_row_max;		/* retracts without progress between */
	double retract_mm_max;
};

/* A move along the path, while it lasts; ahead.c. */
struct cycle_ahead {
	enum cycle_state state;		/* it belongs to */
	int toward;			/* +1 or -1 */
	double goal_mm, override;
	struct mover_limits l;		/* as they were when it began */
	double entered_mm_s;		/* the fastest that it began with */
	double room_mm;			/* so far nothing limits it, at constant
					 * speed */
	bool to_place;			/* the plan is for a place: */
	double place_mm, v_max_mm_s;
};

/* A jump: up, then down to just above the cut. */
struct cycle_lift {
	double from_mm, to_mm;		/* places: where it began, leads to */
	bool up;			/* on its way up */
	bool leaving;			/* the time of a part is up: it does not
					 * come back */
};

/* Held: standing, braking, or moved along the path by a command. */
struct cycle_hold {
	bool moving;
	double to_mm;			/* place that it moves to */
	uint32_t seek;			/* segments in front of this one are not
					 * yet looked at for it; 0: all are */
	bool braked;			/* it has stood since */
	enum cycle_state then;		/* the state to follow the stand */
};

/* A part of the program that ends by time as well: timed.h. */
struct timed {
	uint32_t end;			/* segment where it ends; 0: none */
	uint64_t left;			/* cycles */
	double from_mm;			/* place where it began */
};

/* How far the program's actions are done. */
struct cycle_job {
	uint32_t action_done;		/* all up to this segment are */
	bool dwelling;
	uint64_t dwell_left;		/* cycles */
	bool power_off;			/* the program switched it off (M5) */
	double rejoin_mm;		/* cut before the wire broke: positioned
					 * up to here; 0: nothing is */
};

struct cycle {
	struct cycle_config config;
	struct cycle_gap_config gap;	/* in force: config's, and what the */
	struct cycle_jump_config jump;	/* condition and `set` made of it */
	struct conditions conditions;	/* gap, jump and out.pulse are theirs */
	struct interp_cursor cursor;
	bool loaded;			/* cursor stands on a program */
	enum cycle_state state;
	struct fault fault;		/* what is latched */
	enum cycle_outcome outcome;
	uint64_t count;			/* cycles since cycle_init() */
	struct cycle_totals totals;
	double feed_mm_s;		/* of this cycle, as walked */
	double gap_v;			/* as read; sensed.v */
	struct gap_reading sensed;	/* this cycle's gap */
	struct gap_memory gap_past;
	double far_mm;			/* farthest place eroded or passed */
	struct cycle_lift lift;		/* a jump's, or a return's */
	struct cycle_hold hold;
	struct retract retract;		/* the one under way, or the last */
	struct servo servo;
	struct arcing arcing;
	struct flush flush;
	struct probe probe;
	struct mover mover;		/* speed along the path, or along ... */
	struct escape escape;		/* ... the way out beside it */
	struct axes axes;		/* under power, or not yet */
	struct cycle_ahead ahead;
	struct manual manual;		/* without a program */
	struct limit limit;
	struct comp comp;		/* from places to pulses */
	struct contouring contouring;	/* for axes that lag */
	double override;		/* of positioning; 1: as programmed */
	struct timed timed;
	struct io_plc plc;		/* as read */
	bool plc_held;			/* it said so a period ago */
	double plc_axes_c;		/* the temperature that it told then */
	double plc_override;		/* it said last; NAN: nothing yet */
	struct mcode mcode;
	struct progress progress;
	double back_mm;			/* no way back beyond this place */
	struct cycle_job job;
	uint32_t overruns_in_row;
	bool overran;			/* since the last step */
	bool free_seen;			/* the gap was open since positioning
					 * began */
	bool withdraws;			/* positioning, it met something over cut
					 * ground: it brakes, to retract */
	bool at_start;			/* the walk met the program's start */
	bool busy;			/* the machine takes no point now */
	bool cut_short;			/* the last walk fell short of its way */
	struct io_outputs out;		/* its target: places on the path */
	struct io_outputs given;	/* its target: pulses of the drives */

	/* Called after every lattice point with the cursor on it; may be NULL. */
	void (*on_point)(void *arg, const struct cycle *c);
	void *on_point_arg;
};

/** cycle_is_manual() - it moves, and not by a program. */
static inline bool cycle_is_manual(const struct cycle *c)
{
	return c->state == STATE_JOG || c->state == STATE_HOME;
}

/** cycle_moves() - anything moves, is braking, or waits for power to move. */
static inline bool cycle_moves(const struct cycle *c)
{
	return state_duty[c->state].running || c->hold.moving ||
	       cycle_is_manual(c) || c->axes.awaited ||
	       c->mover.v_mm_s != 0;
}

/** cycle_init() - idle, nothing loaded.  Startup only. */
void cycle_init(struct cycle *c, const struct cycle_config *config);

/**
 * cycle_load() - take a program, stand held at its start.
 *
 * Return: ANSWER_DONE, ANSWER_WRONG_STATE while a job runs,
 * ANSWER_BAD_ARGUMENT if its first segment fails its check.
 */
enum cycle_answer cycle_load(struct cycle *c, const struct interp_program *p);

/**
 * cycle_load_at() - take a cursor that stands somewhere on its program, held.
 *
 * For coming back after a crash: @at was placed by interp_cursor_seek()
 * outside the cycle.
 */
enum cycle_answer cycle_load_at(struct cycle *c, const struct interp_cursor *at,
				double far_mm);

/** cycle_command() - between two steps. */
enum cycle_answer cycle_command(struct cycle *c, const struct cycle_command *m);

/** cycle_overrun() - tell of @missed periods that went by. */
void cycle_overrun(struct cycle *c, uint32_t missed);

/** cycle_step() - one period.  @out is filled whole. */
void cycle_step(struct cycle *c, const struct io_inputs *in,
		struct io_outputs *out);

/** Names for logs, messages and reports.  Any thread. */
const char *cycle_outcome_name(enum cycle_outcome o);
const char *cycle_answer_text(enum cycle_answer a);

#endif /* RT_CYCLE_H */
