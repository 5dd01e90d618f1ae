/* SPDX-License-Identifier: Apache-2.0 */
/*
 * couple.h - any number of axes by pairs, one axis at a time
 *
 * Tree: pairs make inputs of pairs, level by level, (((X,Y),(Z,A)),(B,C)), as
 * the paper on the main-direction rule couples axes step by step (its section
 * 1.3).  A pair's inputs are within D = max|e|/(a + b) of their shares of what
 * the pair has given, so a leaf is within the sum over its levels of D times
 * the shares below.  Nothing is promised against the longest axis: that may be
 * twice mu off.
 *
 * Star: every axis is the secondary of a pair with the longest one, so each
 * is within its own rule's bound of the line; the whole within
 * sqrt(n - 1) of it.  With mu square to the line each gets mu/sqrt(n - 1).
 *
 * Threads: RT-safe but for couple_smallest_milli().
 */
#ifndef PULSE_COUPLE_H
#define PULSE_COUPLE_H

#include "pulse/pair.h"

struct couple_input {
	int8_t code;			/* an axis, or ~pair */
	int64_t pulses;			/* > 0 */
};

struct couple_rule {
	enum interp_strategy strategy;
	enum interp_coupling coupling;
	struct pair_tube tube;
};

/**
 * couple_tree() - couple @n >= 1 inputs, which are overwritten.  Return: the
 * root.
 */
struct couple_input couple_tree(struct interp_pair *pair,
				struct couple_input *in, uint32_t n);

/**
 * couple_star() - pair every input with the longest one; if several are equal,
 * with the first of these.
 *
 * Return: the place of the longest in @in; the n - 1 pairs are in order.
 */
uint32_t couple_star(struct interp_pair *pair, const struct couple_input *in,
		     uint32_t n);

/** couple_set() - set every pair to its start or end, by the rule of a tree. */
void couple_set(struct interp_pair *pair, uint32_t npairs,
		const struct couple_rule *r, bool at_end);

/** couple_set_star() - the same for a star. */
void couple_set_star(struct interp_pair *pair, uint32_t npairs,
		     const struct couple_rule *r, bool at_end);

/** couple_tube() - the tube of each of @npairs pairs by the rule. */
struct pair_tube couple_tube(const struct couple_rule *r, uint32_t npairs);

/**
 * couple_smallest_milli() - the smallest mu that a line of these inputs allows.
 *
 * Return: the rule's own mu if that is enough, else more, in 1/1000 pulse.
 */
uint32_t couple_smallest_milli(const struct couple_rule *r,
			       const struct couple_input *in, uint32_t n);

#endif /* PULSE_COUPLE_H */
