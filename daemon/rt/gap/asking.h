/* SPDX-License-Identifier: Apache-2.0 */
/*
 * asking.h - what the generator is asked for, and whether it is in force
 *
 * The condition of the place where there will be sparks is turned into values
 * that the generator can do.  A jump or a retract over a change of condition
 * asks for nothing new: the place where it ends counts.  Each change of what a
 * place needs has a version.  It is in force when the generator has said so,
 * or, if it cannot, after settle_cycles.  There are no sparks before, forward
 * and on the way back; the machine stands at the place and waits.  A longer off
 * time against arcs is asked for while the sparks go on.
 *
 * A field that a person sets makes the job stand where it changes.  The start
 * that follows says that it is set.
 *
 * Without a job, values may be asked for to try the generator.  A job takes
 * them back, and so does the end of a lease.
 *
 * Each job asks anew where its first sparks are to be, also for what the one
 * before it asked for.  What the generator has lost by then is no trouble.
 *
 * A generator on registers keeps the last value that it was asked for.  Where
 * nobody asks any more (a condition that does not give it, a set that was taken
 * back, the end of a trial), it is asked for the one that it told before.  If
 * it did not tell it, a person must set it before the sparks.  Until the start
 * that follows, it is asked for no value of that field; behind it, no sparks
 * before it tells what it has.
 *
 * Threads: RT-safe.
 */
#ifndef RT_ASKING_H
#define RT_ASKING_H

#include "io.h"
#include "process.h"

struct cycle;

struct asking_config {
	bool limited;			/* false: all is in force at once */
	bool answers;			/* the generator says what is */
	uint64_t settle_cycles;		/* if it does not */
	uint64_t polarity_cycles;	/* without sparks, before a change */
	uint64_t lease_cycles;		/* of what is tried */
	struct process_delivers field[INTERP_NGENERATOR];
};

/* What is asked for without a job. */
struct asking_trial {
	uint32_t fields;		/* a bit of each */
	double value[INTERP_NGENERATOR];
};

struct asking {
	double now[INTERP_NGENERATOR];	/* asked; NAN: its own setting */
	double place[INTERP_NGENERATOR];	/* the same without steps
						 * against arcs */
	double arcing_off_us;		/* with them; and ... */
	bool anew;			/* ... look, though both are as before:
					 * where all is in force at once */
	uint32_t version;		/* of `now` */
	uint32_t needed;		/* of `place` */
	uint64_t age;			/* periods since `needed` */
	uint64_t dark;			/* periods without sparks */
	bool in_force;			/* of the place, in the last period */
	double hand[INTERP_NGENERATOR];	/* what a person has set */
	uint32_t stands;		/* ... or is to set, a bit of each: it
					 * stands */
	bool begun;			/* the job has asked, where sparks are
					 * to be: from then on trouble counts */
	struct asking_trial trial, leased;	/* this one goes first ... */
	uint64_t lease;			/* ... and ends in so many periods */
	uint32_t lent;			/* a bit of each that was asked for
					 * ... */
	double before[INTERP_NGENERATOR];	/* ... and what it had by then;
					 * NAN: nobody knows */
	struct io_generator says;	/* in the last period */
	bool has;			/* the generator has all of `now` */
	double ignition_v;		/* the highest that it may have */
};

/** asking_init() - nothing is asked yet. */
void asking_init(struct asking *a);

/** asking_begin() - another job: what was tried, and what a person has set, is
 *  over. */
void asking_begin(struct cycle *c);

/** asking_restore() - the job that is loaded was begun before a crash, and the
 *  generator may have any of its values. */
void asking_restore(struct cycle *c);

/** asking_step() - once a period, behind the walk and before the outputs. */
void asking_step(struct cycle *c, const struct io_inputs *in);

/** asking_waits() - would there be sparks if the condition were in force? */
bool asking_waits(const struct cycle *c);

/** asking_hand() - a person must set something before the sparks, once the
 *  generator has the rest, so that nothing is on its way to it.
 *  Return: true if the machine is to stand for it. */
bool asking_hand(struct cycle *c);

/** asking_takes() - can field @field be @value? */
bool asking_takes(const struct cycle *c, uint32_t field, double value);

/**
 * asking_try() - without a job, ask for @value of field @field; NAN: no more.
 * A @field beyond the last one is all of them.  @leased: for lease_cycles, of
 * all that is leased, since the last one; then for what is not leased.
 * Return: false if it cannot be asked for.
 */
bool asking_try(struct cycle *c, uint32_t field, double value, bool leased);

/** asking_off_us() - the off time that comes of asking for @off_us; NAN: it
 *  cannot be asked for. */
double asking_off_us(const struct cycle *c, double off_us);

#endif /* RT_ASKING_H */
