/* SPDX-License-Identifier: Apache-2.0 */
/*
 * states.h - the one table of the machine's states
 *
 * The cycle, the snapshot in shared memory, edmctl and the PLC's files take
 * number and name of a state from here.  The numbers begin at 1 and are in
 * shared memory and on the PLC's bus: rows keep their order.
 *
 * S(id, name, power, running): @power, sparks may be on; @running, a job is
 * under way.
 *
 * Threads: any; the table is constant.
 */
#ifndef WORDS_STATES_H
#define WORDS_STATES_H

/* clang-format off */
#define STATE_ROWS(S) \
S(IDLE,     "idle",     false, false)	/* no job */ \
S(TRAVEL,   "travel",   false, true)	/* positioning, or a dry run */ \
S(APPROACH, "approach", true,  true)	/* feeds until it sparks */ \
S(ERODE,    "erode",    true,  true)	/* the gap servo decides the feed */ \
S(RETRACT,  "retract",  false, true)	/* back along the path from a short */ \
S(JUMP,     "jump",     false, true)	/* a flushing lift, and the return */ \
S(HOLD,     "hold",     false, false)	/* stands, or walks by command */ \
S(FAULT,    "fault",    false, false)	/* a fault is latched; no motion */ \
S(JOG,      "jog",      false, false)	/* no job: an axis moves by command */ \
S(HOME,     "home",     false, false)	/* no job: axes look for switches */ \
S(PROBE,    "probe",    false, true)	/* looks for the work by contact */
/* clang-format on */

#define STATE_NUMBER(id, name, power, running) STATE_##id,
enum cycle_state {
	STATE_STAY,		/* only in tables: no transition */
	STATE_ROWS(STATE_NUMBER)
	CYCLE_NSTATES
};
#undef STATE_NUMBER

#endif /* WORDS_STATES_H */
