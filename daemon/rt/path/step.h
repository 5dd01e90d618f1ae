/* SPDX-License-Identifier: Apache-2.0 */
/*
 * step.h - held: from node to node of the path, by command
 *
 * Back over what was passed, and forward again over what was passed before;
 * in a dry run to any node.  Nothing is done on the way: it stands in front of
 * the first action that was not done yet.
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
 * Nodes that lie in one place count once.
 * Return: enum cycle_answer; @ret_mm set if it is ANSWER_DONE.
 */
int step_to(const struct cycle *c, double n, double *ret_mm);

/** step_watch() - a short on the way forward ends it where it is. */
void step_watch(struct cycle *c);

#endif /* RT_STEP_H */
