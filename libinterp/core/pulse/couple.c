/* SPDX-License-Identifier: Apache-2.0 */
/*
 * couple.c - trees and stars of pairs
 */
#include "pulse/couple.h"
#include "pulse/strategy.h"

#include <string.h>

/* The input with more pulses is the main one; if they are equal, the first. */
static struct couple_input join(struct interp_pair *pair, uint32_t i,
				struct couple_input p, struct couple_input q)
{
	const bool swap = q.pulses > p.pulses;
	const struct couple_input a = swap ? q : p, b = swap ? p : q;

	pair[i] = (struct interp_pair) {
		.a = a.pulses, .b = b.pulses, .in_a = a.code, .in_b = b.code,
	};
	return (struct couple_input) { (int8_t)~i, a.pulses + b.pulses };
}

struct couple_input couple_tree(struct interp_pair *pair,
				struct couple_input *in, uint32_t n)
{
	uint32_t pairs = 0;

	while (n > 1) {
		uint32_t m = 0;

		for (uint32_t i = 0; i + 1 < n; i += 2, pairs++)
			in[m++] = join(pair, pairs, in[i], in[i + 1]);
		if (n % 2)
			in[m++] = in[n - 1];
		n = m;
	}
	return in[0];
}

uint32_t couple_star(struct interp_pair *pair, const struct couple_input *in,
		     uint32_t n)
{
	uint32_t main = 0, pairs = 0;

	for (uint32_t i = 1; i < n; i++)
		main = in[i].pulses > in[main].pulses ? i : main;
	for (uint32_t i = 0; i < n; i++) {
		if (i == main)
			continue;
		pair[pairs++] = (struct interp_pair) {
			.a = in[main].pulses, .b = in[i].pulses,
			.in_a = in[main].code, .in_b = in[i].code,
		};
	}
	return main;
}

void couple_set(struct interp_pair *pair, uint32_t npairs,
		const struct couple_rule *r, bool at_end)
{
	for (uint32_t i = 0; i < npairs; i++)
		pair_set(&pair[i], r->strategy, r->tube, at_end);
}

/* mu of one axis of a star: several errors at right angles add up. */
static struct pair_tube axis_tube(struct pair_tube t, uint32_t npairs)
{
	if (!t.perpendicular || npairs < 2)
		return t;
	/* floor(sqrt(x/n)) is floor(sqrt(floor(x/n))). */
	return (struct pair_tube) {
		.milli = (uint32_t)pair_isqrt(1, (uint64_t)t.milli * t.milli /
					      npairs),
	};
}

struct pair_tube couple_tube(const struct couple_rule *r, uint32_t npairs)
{
	return r->coupling == INTERP_TREE ? r->tube :
					    axis_tube(r->tube, npairs);
}

void couple_set_star(struct interp_pair *pair, uint32_t npairs,
		     const struct couple_rule *r, bool at_end)
{
	struct couple_rule axis = *r;

	axis.tube = axis_tube(r->tube, npairs);
	couple_set(pair, npairs, &axis, at_end);
}

/* -- Which mu a line allows ------------------------------------------------ */

static bool couple_ok(const struct couple_rule *r,
		      const struct couple_input *in, uint32_t n)
{
	struct couple_input inputs[INTERP_NAXES];
	struct interp_pair pair[INTERP_NAXES];
	struct pair_tube t = r->tube;

	if (t.milli < pulse_strategy(r->strategy)->least_milli)
		return false;
	memcpy(inputs, in, n * sizeof(*in));
	if (r->coupling == INTERP_TREE) {
		couple_tree(pair, inputs, n);
	} else {
		couple_star(pair, inputs, n);
		t = axis_tube(t, n - 1);
	}
	for (uint32_t i = 0; i + 1 < n; i++) {
		if (!pair_tube_ok(pair[i].a, pair[i].b, t))
			return false;
	}
	return true;
}

uint32_t couple_smallest_milli(const struct couple_rule *r,
			       const struct couple_input *in, uint32_t n)
{
	struct couple_rule try = *r;
	uint32_t lo = r->tube.milli, hi = INTERP_TOLERANCE_MAX;

	if (n < 2 || couple_ok(r, in, n))
		return lo;
	while (hi - lo > 1) {
		try.tube.milli = lo + (hi - lo) / 2;
		if (couple_ok(&try, in, n))
			hi = try.tube.milli;
		else
			lo = try.tube.milli;
	}
	return hi;
}
