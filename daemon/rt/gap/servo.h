/* SPDX-License-Identifier: Apache-2.0 */
/*
 * servo.h - what the gap servo keeps from cycle to cycle
 *
 * Above the window it feeds forward at gain * (v - high) plus an integral with
 * the reset time integral_s.  Inside the window it stands and keeps the
 * integral.  Below the window it creeps back at gain * (v - low), no faster
 * than creep_mm_s, no farther than a retract may go, and not off the cut.  The
 * integral stays between 0 and the limit of the feed.  It does not grow while
 * the feed is at its limit, or while a feed is asked for but not walked.
 *
 * When the values in force change, the feed makes no step: the difference is
 * kept and fades.
 *
 * In approach, erode and retract the speed changes by no more than feed_a_mm_s2
 * and than what the axes allow (path/pace.h).  So after a contact it goes on
 * for v * period + v * v / (2 * a); up to a speed of a * period that is no more
 * than the distance of one cycle.
 *
 * Threads: RT-safe.
 */
#ifndef RT_SERVO_H
#define RT_SERVO_H

#include <stdbool.h>

/* The values that a feed was computed from. */
struct servo_law {
	double gain_mm_s_v, low_v, high_v;
};

struct servo {
	struct servo_law law;		/* as last used; gain 0: not yet */
	double integral_mm_s;
	double fade_mm_s;		/* what a change of values would have
					 * been as a step */
	double asked_mm_s;		/* in the cycle before */
};

struct cycle;

/**
 * servo_rests() - it stands, or can within a cycle: a lift may begin.  While
 * one is due, the servo brakes.
 */
bool servo_rests(const struct cycle *c);

/** servo_reset() - forget the integral; a retract or positioning begins. */
void servo_reset(struct cycle *c);

#endif /* RT_SERVO_H */
