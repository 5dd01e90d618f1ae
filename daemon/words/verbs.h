/* SPDX-License-Identifier: Apache-2.0 */
/*
 * verbs.h - the one table of an operator's verbs
 *
 * Shared memory and the cycle take their numbers from here.  A new verb is a
 * new last row, its function in rt/command.c, and its rows in jobs/verbs.c and
 * ctl/main.c.  The numbers are in shared memory: rows keep their order.
 *
 * Threads: any; plain data.
 */
#ifndef WORDS_VERBS_H
#define WORDS_VERBS_H

#define VERB_ROWS(V) \
	V(START)	/* from held: begin or go on; arg: the stand that it is \
			 * for, 0: whichever */ \
	V(HOLD)		/* power off, stop on the path */ \
	V(RESUME)	/* the same as start, after a hold */ \
	V(STOP)		/* end the job here */ \
	V(RETRACT)	/* hold, go arg_mm back along the path */ \
	V(ESTOP)	/* the software e-stop */ \
	V(RESET)	/* leave the fault: held, or idle without a job */ \
	V(SET)		/* field arg gets arg_mm; NAN: remove the set value */ \
	V(OVERRIDE)	/* of positioning; arg_mm is a factor, 0 ... 2 */ \
	V(STEP)		/* held: go on by arg_mm nodes; - goes back */ \
	V(JOG)		/* idle: axis arg by arg_mm */ \
	V(HOME)		/* idle: axis arg; 8: all axes */ \
	V(JOG_ON)	/* axis at arg_mm mm/s while this is repeated */ \
	V(CONFIRM)	/* what a stand asks for is done; arg_mm: its number; \
			 * arg: as of START */ \
	V(TRY)		/* idle: ask the generator for field VERB_TRY_FIELD(arg) \
			 * as arg_mm; NAN: no more; beyond the last: all */ \
	V(PLACE)	/* idle: axis arg, which nothing homes, stands at \
			 * arg_mm */

/*
 * The argument of JOG_ON.  Only a sign that says so begins a motion.  A press
 * that has ended is never continued, so each press has a number of its own, 1
 * or more.
 */
#define VERB_PRESS_AXIS(arg)	((arg) & 0x7f)
#define VERB_PRESS_BEGINS	0x80u
#define VERB_PRESS(arg)		((arg) >> 8)
#define VERB_PRESS_MAX		0xffffffu
/* The axis stands still this long after the last sign of the press. */
#define VERB_PRESS_S		0.2

/*
 * The argument of TRY.  What is leased is asked for until [generator] confirm_s
 * and VERB_TRY_S are over since the last leased value: who walks through many
 * of them may vanish.
 */
#define VERB_TRY_FIELD(arg)	((arg) & 0xff)
#define VERB_TRY_LEASED		0x100u
#define VERB_TRY_S		10.0

#define VERB_ONE(verb)	+ 1

enum { VERB_COUNT = VERB_ROWS(VERB_ONE) };

#endif /* WORDS_VERBS_H */
