/* SPDX-License-Identifier: Apache-2.0 */
/*
 * pace.h - speeds that a law sets anew in each cycle, within what the axes can
 * do
 *
 * The gap servo and the touches of a probe do not plan: each cycle they say how
 * fast to go now.  pace_go() comes as near to that speed as the axes allow.
 * Along the path the speed changes by no more than feed_a_mm_s2 and than the
 * acceleration of every axis that moves here.  It is never so high that a node,
 * a bend, the end of the cut, an action or a corner of an escape could not be
 * met by braking at once with that acceleration.
 *
 * There is no limit of jerk: a gap closes within some micrometres, and a ramp of
 * the acceleration would take longer than the whole way out of a short.
 *
 * Units: mm along the path, + toward the program's end.
 * Threads: RT-safe; looks at a bounded number of segments.
 */
#ifndef RT_PACE_H
#define RT_PACE_H

struct cycle;

/** pace_dv_mm_s() - the most that the speed may change in this cycle. */
double pace_dv_mm_s(const struct cycle *c);

/**
 * pace_go() - the distance of this cycle, at @v_mm_s or as near to it as can be.
 *
 * @to_mm: a place to stand at, if it is met; INFINITY or -INFINITY: none.
 */
double pace_go(struct cycle *c, double v_mm_s, double to_mm);

#endif /* RT_PACE_H */
