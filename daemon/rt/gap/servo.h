/* SPDX-License-Identifier: Apache-2.0 */
/*
 * servo.h - what the gap servo keeps from cycle to cycle
 *
 * Window and PI: above the window forward, gain * (v - high) and an integral
 * that is reset in integral_s; inside it stands and keeps the integral; below
 * it creeps back, gain * (v - low), no faster than creep_mm_s and no farther
 * than a retract may go.  The integral stays between 0 and the feed's limit;
 * it stands while the feed is at its limit, or asked for and not walked.
 *
 * When the values in force change, the feed does not step: what it would step
 * by is carried on and fades.
 *
 * In approach, erode and retract the speed changes by feed_a_mm_s2 at the
 * most.  After a contact it goes on for v * period + v * v / (2 * feed_a): no
 * more than one cycle's distance up to a speed of feed_a * period.
 *
 * Threads: RT-safe.
 */
#ifndef RT_SERVO_H
#define RT_SERVO_H

#include <stdbool.h>

/* The values a feed came of. */
struct servo_law {
	double gain_mm_s_v, low_v, high_v;
};

struct servo {
	struct servo_law law;		/* as last used; gain 0: not yet */
	double integral_mm_s;
	double fade_mm_s;		/* carried on over a change */
	double asked_mm_s;		/* the cycle before */
};

struct cycle;

/** servo_reset() - forget the integral; where erosion was left for good. */
void servo_reset(struct cycle *c);

/** servo_dv_mm_s() - change of speed in a cycle; INFINITY: any. */
double servo_dv_mm_s(const struct cycle *c);

#endif /* RT_SERVO_H */
