/* SPDX-License-Identifier: Apache-2.0 */
/*
 * rule_help.h - two-axis rules by themselves: their bounds, and a walk
 */
#ifndef RULE_HELP_H
#define RULE_HELP_H

#include "tried/greedy_walk.h"
#include "pulse/pair.h"

/* The range of e that pulse/pair.h promises. */
struct range {
	int64_t lo, hi;
};

static inline struct range rule_range(enum interp_strategy rule, int64_t a,
				      int64_t b, struct pair_tube t)
{
	const int64_t m = pair_half_width(a, b, t);

	switch (rule) {
	case INTERP_CENTRED:
		return (struct range) { -((a + b) / 2), (a + b) / 2 };
	case INTERP_MAIN_DIRECTION:
		return (struct range) { m + 1 - a - b < 0 ? m + 1 - a - b : 0,
					m };
	case INTERP_MIN_SWITCH:
		return (struct range) { -m, m };
	default:
		return (struct range) { 1 - a, b };
	}
}

static inline struct interp_pair rule_pair(enum interp_strategy rule,
					   int64_t a, int64_t b,
					   struct pair_tube t, bool at_end)
{
	struct interp_pair p = { .a = a, .b = b };

	pair_set(&p, rule, t, at_end);
	return p;
}

static inline bool pair_same(const struct interp_pair *p,
			     const struct interp_pair *q)
{
	if (p->m != q->m || p->s != q->s || p->dev != q->dev)
		return false;
	return p->bursts == 0 ||
	       (p->burst == q->burst && p->from == q->from &&
		p->to == q->to && p->due == q->due && p->done == q->done);
}

#endif /* RULE_HELP_H */
