/* SPDX-License-Identifier: Apache-2.0 */
/*
 * manual.h - one axis moved by an operator without a program: jogged or homed
 *
 * Only from idle.  The move is an S-curve with the axis's own limits.  A jog is
 * of a given length, or goes on while a person presses a key: then a sign of
 * that press comes again and again, and the axis stands VERB_PRESS_S after the
 * last one, whatever became of the person, the page or the network.  A hold
 * or a stop brakes it; so does a fault that leaves the axes good, but for a
 * contact, which ends the move at once.
 *
 * Homing, one axis at a time, by method (docs/homing.md):
 *
 * 	switch		fast toward the switch, off it and home_back_mm
 * 			further, slowly onto it again: that edge is home_at_mm
 * 	switch-index	the same, and slowly on to the index mark: that mark is
 * 	absolute	no motion: the drive says where it stands
 * 	none		the place where it starts is good
 *
 * What homing found is a shift between places and pulses (comp.h). Giving a
 * place another number makes no pulse.
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

/* So long a jog that is pressed brakes at most, of the VERB_PRESS_S that it has
 * to stand in: it is no faster than that. */
#define MANUAL_BRAKE_S	0.1

enum home_phase {
	HOME_BEGIN,
	HOME_SEEK,			/* fast, toward the switch */
	HOME_BRAKE,			/* on it */
	HOME_LEAVE,			/* back, until it is off */
	HOME_CLEAR,			/* ... and home_back_mm further */
	HOME_ONTO,			/* slowly, on it again */
	HOME_INDEX,			/* slowly, on to the index mark */
	HOME_STAND,			/* brake, and call the place */
	HOME_NPHASES
};

struct manual {
	uint32_t axis;
	int32_t from;			/* its place when the move began */
	double gone_mm;			/* since */
	double goal_mm;			/* jog: to go, from there */
	bool halt;			/* brake, then idle */
	bool free_seen;			/* jog: the gap has been open */
	bool pressed;			/* jog: only while its press lasts */
	uint32_t press;			/* the last one, over or not */
	double press_mm_s;		/* the speed that it asks for */
	uint64_t until;			/* cycle in which it begins to brake */
	struct mover mover;
	uint32_t todo;			/* home: bit per axis still to do */
	enum home_phase phase;
	double phase_mm;		/* gone_mm where the phase began */
	int32_t met;			/* pulses at the switch or mark */
	uint32_t homed;			/* bit per axis */
	uint32_t unplaced;		/* ... whose drive lost its place; until
					 * it is homed */
	bool used;			/* places and programs may disagree */
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
 * Return: enum cycle_answer; the state is the caller's.
 */
int manual_jog(struct cycle *c, uint32_t axis, double mm);

/**
 * manual_press() - a sign of a press: begin a jog at @mm_s, let it go on, or
 * end it (0).  @arg: words/verbs.h.
 *
 * @may: what a guard says of a motion that begins.
 * Return: enum cycle_answer; *@ret_begun: the state is the caller's to change.
 */
int manual_press(struct cycle *c, uint32_t arg, double mm_s, int may,
		 bool *ret_begun);

/** manual_home() - begin to home @axis, or MANUAL_ALL_AXES. */
int manual_home(struct cycle *c, uint32_t axis);

/** manual_go() - one period of what was begun. Return: true once it is over. */
bool manual_go(struct cycle *c, const struct io_inputs *in);

/* home.c, for manual.c: one period of homing. */
bool home_go(struct cycle *c, const struct io_inputs *in);

/* manual.c, for home.c. */
void manual_begin(struct cycle *c, uint32_t axis);
const struct manual_axis *manual_axis(const struct cycle *c);
void manual_move(struct cycle *c, double ds_mm);
struct mover_limits manual_limits(const struct cycle *c, double v_mm_s);

#endif /* RT_MANUAL_H */
