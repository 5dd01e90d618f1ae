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
	V(START)	/* from held: begin or go on */ \
	V(HOLD)		/* power off, stop on the path */ \
	V(RESUME)	/* the same as start, after a hold */ \
	V(STOP)		/* end the job here */ \
	V(RETRACT)	/* hold, go arg_mm back along the path */ \
	V(ESTOP)	/* the software e-stop */ \
	V(RESET)	/* leave the fault: held, or idle without a job */ \
	V(SET)		/* field arg to arg_mm; NAN: as it was */ \
	V(OVERRIDE)	/* of positioning, arg_mm: a factor of 0 ... 2 */ \
	V(STEP)		/* held: arg_mm nodes on, - back */ \
	V(JOG)		/* idle: axis arg by arg_mm */ \
	V(HOME)		/* idle: axis arg; 8: all axes */

#define VERB_ONE(verb)	+ 1

enum { VERB_COUNT = VERB_ROWS(VERB_ONE) };

#endif /* WORDS_VERBS_H */
