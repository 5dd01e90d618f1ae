/* SPDX-License-Identifier: Apache-2.0 */
/*
 * manual.h - one axis moved by an operator without a program: jogged or homed
 *
 * It begins only from idle.  The move is an S-curve with the axis's own limits.
 * A jog has a given length, or it goes on while a person presses a key.  In the
 * second case a sign of that press comes again and again, and the axis stands
 * VERB_PRESS_S after the last sign, whatever happened to the person, the page
 * or the network.  A hold or a stop brakes the axis.  A fault that leaves the
 * axes good brakes it too; a contact ends the move at once.
 *
 * Homing, one axis at a time, by method (docs/homing.md):
 *
 * 	switch		fast toward the switch, off it and home_back_mm
 * 			further, slowly onto it again: that edge is home_at_mm
 * 	switch-index	the same, and slowly on to the index mark: that mark is
 * 	absolute	no motion: the drive says where it stands
 * 	drive		the drive finds its zero by itself, as its own homing
 * 			method says; until then its place is lost
 * 	none		the operator says that the place shown is right
 *
 * What homing found is a shift between places and pulses (comp.h).  Only the
 * number of the place changes; the drive gets no pulse.
 *
 * Units: mm of the axis, deg if rotary; pulses.  Sign: + as the axis.
 * Threads: RT-safe.
 */
#ifndef RT_MANUAL_H
#define RT_MANUAL_H

#include "interp/axis.h"
#include "path/mover.h"

#include "settings.h"

#include <stdbool.h>
#include <stdint.h>

#define MANUAL_ALL_AXES	INTERP_NAXES	/* home: each that has a method */

/* A jog by a pressed key must stand within VERB_PRESS_S.  Of this time it may
 * brake for so long, which limits its speed. */
#define MANUAL_BRAKE_S	0.1

enum home_phase {
	HOME_BEGIN,
	HOME_SEEK,			/* fast, toward the switch */
	HOME_BRAKE,			/* on it */
	HOME_LEAVE,			/* back, until it is off */
	HOME_CLEAR,			/* ... and home_back_mm further */
	HOME_ONTO,			/* slowly, on it again */
	HOME_INDEX,			/* slowly, on to the next index mark */
	HOME_STAND,			/* brake, and call the place */
	HOME_BY_DRIVE,			/* the drive moves by itself */
	HOME_NPHASES
};

struct manual {
	uint32_t axis;
	int32_t from;			/* its place when the move began */
	double gone_mm;			/* since then */
	double goal_mm;			/* jog: the distance from there */
	bool halt;			/* brake, then idle */
	bool free_seen;			/* jog: the gap was open since it
					 * began */
	bool pressed;			/* jog: only while its press lasts */
	uint32_t press;			/* number of the last press */
	double press_mm_s;		/* the speed that it asks for */
	uint64_t until;			/* the cycle in which it brakes */
	struct mover mover;
	uint32_t todo;			/* home: bit per axis still to do */
	enum home_phase phase;
	double phase_mm;		/* gone_mm when the phase began */
	int64_t end[INTERP_NAXES];	/* pulses: there its search ends */
	uint32_t aimed;			/* bit per axis: it has such an end */
	int64_t end_off;		/* the same, off the switch */
	int32_t met;			/* pulses at the switch or mark */
	uint32_t homed;			/* bit per axis */
	uint32_t unplaced;		/* bit per axis whose drive lost its
					 * place, until it is homed */
	bool used;			/* an axis was moved: a program may not
					 * begin where the axes stand */
};

struct cycle;
struct io_inputs;

/**
 * manual_unhomed() - bits of the axes that have a method and were not homed,
 * and of those whose place is lost, whatever their method.
 */
uint32_t manual_unhomed(const struct cycle *c);

/**
 * manual_jog() - begin to move axis @axis by @mm.
 * Return: enum cycle_answer.  The caller changes the state.
 */
int manual_jog(struct cycle *c, uint32_t axis, double mm);

/**
 * manual_press() - a sign of a press: begin a jog at @mm_s, let it go on, or
 * end it (0).  @arg is described in words/verbs.h.  @may is what the guards say
 * about a motion that begins.
 *
 * Return: enum cycle_answer.  If *@ret_begun is set, the caller has to change
 * the state.
 */
int manual_press(struct cycle *c, uint32_t arg, double mm_s, int may,
		 bool *ret_begun);

/** manual_home() - begin to home @axis, or MANUAL_ALL_AXES. */
int manual_home(struct cycle *c, uint32_t axis);

/**
 * manual_place() - axis @axis stands at @mm: a person says so.  Nothing moves.
 * For an axis that nothing homes.  Return: enum cycle_answer.
 */
int manual_place(struct cycle *c, uint32_t axis, double mm);

/** manual_in_phase() - bit of the axis that is in this phase of homing. */
uint32_t manual_in_phase(const struct cycle *c, enum home_phase phase);

/** manual_ends() - is it told to end, or the time of its press over? */
bool manual_ends(const struct cycle *c);

/** manual_go() - one period of what was begun. Return: true once it is over. */
bool manual_go(struct cycle *c, const struct io_inputs *in);

/* home.c, for manual.c: @axis stands at @place while its drive stands at
 * @drive, in pulses; where its search ends; one period of it. */
void home_place(struct cycle *c, uint32_t axis, int32_t place, int32_t drive);
void home_aim(struct cycle *c, uint32_t axis);
bool home_go(struct cycle *c, const struct io_inputs *in);

/* manual.c, for home.c. */
void manual_begin(struct cycle *c, uint32_t axis);
const struct manual_axis *manual_axis(const struct cycle *c);
void manual_move(struct cycle *c, double ds_mm);
struct mover_limits manual_limits(const struct cycle *c, double v_mm_s);
/** manual_stop() - brake. Return: does it stand? */
bool manual_stop(struct cycle *c);

#endif /* RT_MANUAL_H */
