/* SPDX-License-Identifier: Apache-2.0 */
/*
 * step.h - by command, from node to node of the path, while held
 *
 * It goes back over what was passed, and forward again as far as it was before;
 * in a dry run to any node.  No action is done on the way: it stops in front of
 * the first one that was not done yet.
 *
 * Threads: RT-safe; looks at a bounded number of segments.
 */
#ifndef RT_STEP_H
#define RT_STEP_H

struct cycle;

#define STEP_NODES_MAX	100

/**
 * step_to() - the place of the node @n ahead, or -@n behind.
 *
 * Nodes at the same place count as one.
 * Return: enum cycle_answer; @ret_mm set if it is ANSWER_DONE.
 */
int step_to(const struct cycle *c, double n, double *ret_mm);

/** step_watch() - a short on the way forward ends the motion. */
void step_watch(struct cycle *c);

#endif /* RT_STEP_H */
