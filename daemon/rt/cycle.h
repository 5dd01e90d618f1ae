/* SPDX-License-Identifier: Apache-2.0 */
/*
 * cycle.h - one period of the machine: (state, inputs) -> (state, outputs)
 *
 * The real-time thread calls cycle_step() once a period with the hardware's
 * inputs; edmsim calls the same object code with a simulated machine's.  The
 * order within: guard, gap, state, mover, walk along the path, outputs.
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
#include "io.h"
#include "mover.h"
#include "state.h"

/* Why a fault is latched. */
enum cycle_fault {
	FAULT_NONE,
	FAULT_ESTOP,			/* the e-stop input, or the command */
	FAULT_SHORT_NOT_CLEARED,	/* retracted the whole limit, still short */
	FAULT_GAP_LOST,			/* the gap voltage is not valid */
	FAULT_IO_LOST,			/* the machine does not answer */
	FAULT_CONTACT,			/* a short while positioning */
	FAULT_SOFT_LIMIT,		/* the path leaves the travel */
	FAULT_PROGRAM,			/* a segment failed its check */
	FAULT_OVERRUN,			/* too many periods missed in a row */
	CYCLE_NFAULTS
};

/* How the last job ended. */
enum cycle_outcome {
	OUTCOME_NONE,			/* none yet, or it runs */
	OUTCOME_DONE,
	OUTCOME_FAULT,
	OUTCOME_STOPPED,		/* by command */
};

struct cycle_gap_config {
	double servo_v;			/* hold this mean gap voltage */
	double short_v;			/* below: short circuit */
	double open_v;			/* above: nothing to cut yet */
	double gain_mm_s_v;		/* feed per volt above servo_v */
	double feed_max_mm_s;		/* fastest feed while eroding */
	double approach_mm_s;		/* feed until the first spark */
	double retract_mm_s;		/* back along the path on a short */
	double retract_limit_mm;	/* then stand, and wait ... */
	uint64_t retract_wait_cycles;	/* ... then fault short-not-cleared */
};

struct cycle_jump_config {
	double height_mm;		/* 0: never */
	uint64_t every_cycles;		/* of erosion between two jumps */
	double v_max_mm_s, a_max_mm_s2, j_max_mm_s3;
	double short_of_mm;		/* come back to this far above the cut */
};

struct cycle_config {
	int64_t period_ns;
	struct cycle_gap_config gap;
	struct cycle_jump_config jump;
	double travel_a_mm_s2;		/* to start and stop positioning */
	double travel_j_mm_s3;
	int32_t travel_min[INTERP_NAXES];	/* soft limits, pulses */
	int32_t travel_max[INTERP_NAXES];
	uint32_t overrun_limit;		/* missed periods in a row; 0: no fault */
	uint32_t points_max;		/* lattice points in one cycle */
	bool dry_run;			/* no gap: walk at the programmed feed */
	bool optional_stop;		/* M1 holds */
	bool hold_at_end;		/* stand held at the end; no job's end */
};

enum cycle_verb {
	CYCLE_START,			/* from held: begin or go on */
	CYCLE_HOLD,			/* power off, stop on the path */
	CYCLE_RESUME,			/* the same as start, after a hold */
	CYCLE_STOP,			/* end the job here */
	CYCLE_RETRACT,			/* hold, arg_mm back along the path */
	CYCLE_ESTOP,			/* the software e-stop */
	CYCLE_RESET,			/* leave fault: held, or idle */
	CYCLE_NVERBS
};

struct cycle_command {
	uint32_t id;			/* the sender's; answered with it */
	uint32_t verb;			/* enum cycle_verb */
	double arg_mm;
};

/* What a command came to. */
enum cycle_answer {
	ANSWER_DONE,
	ANSWER_NO_PROGRAM,		/* nothing is loaded */
	ANSWER_WRONG_STATE,		/* not in this state */
	ANSWER_BAD_ARGUMENT,		/* out of range, or not finite */
	CYCLE_NANSWERS
};

/* Sums of one job, for status and report. */
struct cycle_totals {
	uint64_t cycles;		/* since start */
	uint64_t erode_cycles, jump_cycles;
	uint64_t pulses[INTERP_NAXES];
	uint32_t retracts, jumps, shorts, overruns;
	double retract_mm_max;
};

/* What positioning saw ahead. */
struct cycle_ahead {
	uint32_t slow_for;		/* a slower segment; 0: none */
	double slow_mm_s;		/* its speed */
	double v_mm_s, a_mm_s2;		/* the two below are for these; */
	double need_mm;			/* look so far; 0: not known */
	struct interp_scurve_state next;	/* a cycle on, at most */
};

struct cycle {
	struct cycle_config config;
	struct interp_cursor cursor;
	bool loaded;			/* cursor stands on a program */
	enum cycle_state state;
	enum cycle_fault fault;
	enum cycle_outcome outcome;
	uint64_t count;			/* cycles since cycle_init() */
	struct cycle_totals totals;
	double feed_mm_s;		/* of this cycle, as walked */
	double gap_v;			/* as read */
	double far_mm;			/* farthest place eroded or passed */
	double jump_from_mm;		/* place the jump began */
	double jump_to_mm;		/* place the lift or the return leads to */
	double move_to_mm;		/* place a retract by command leads to */
	double retract_from_mm;		/* place the retract began */
	uint64_t retract_waited;	/* cycles stood at its limit */
	struct mover mover;		/* speed along the path */
	struct cycle_ahead ahead;	/* while positioning */
	bool lifting;			/* a jump on its way up */
	bool moving;			/* held, but walking back by command */
	enum cycle_state after_stand;	/* held: where to, once it stands */
	uint64_t since_jump;		/* cycles of erosion */
	uint64_t dwell_left;		/* cycles */
	uint32_t overruns_in_row;
	bool overran;			/* since the last step */
	uint32_t action_done;		/* actions up to this index are done */
	bool dwelling;
	bool power_off;			/* the program switched it off (M5) */
	bool gap_short, gap_open;	/* this cycle's gap */
	bool short_before;		/* it was short the cycle before */
	bool free_seen;			/* open since positioning began */
	bool at_start;			/* the walk met the program's start */
	struct io_outputs out;		/* as last given */

	/* Called after every lattice point with the cursor on it; may be NULL. */
	void (*on_point)(void *arg, const struct cycle *c);
	void *on_point_arg;
};

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

/** Names for logs, messages and reports: "short-not-cleared", ... Any thread. */
const char *cycle_fault_name(enum cycle_fault f);
const char *cycle_outcome_name(enum cycle_outcome o);
const char *cycle_answer_text(enum cycle_answer a);

#endif /* RT_CYCLE_H */
