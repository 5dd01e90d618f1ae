/* SPDX-License-Identifier: Apache-2.0 */
/*
 * couple.c - trees, stars and tubes of pairs
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

/* -- Shared stops ---------------------------------------------------------- */

/* With @count bursts at the stops of @lead, would @p stay within its M of
 * @half? */
static bool shared_ok(const struct interp_pair *p,
		      const struct interp_pair *lead, int64_t count,
		      int64_t half)
{
	const int64_t n = lead->bursts;
	const int64_t stops = (n + count - 1) / count;
	const int64_t sent = (stops * lead->b + n - 1) / n;
	const int64_t gap = sent * p->a / lead->b + 1;
	const int64_t first = pair_stop(p->a, lead->b, n,
					pair_stop_shared(n, count, 0));
	const int64_t last = pair_stop(p->a, lead->b, n,
				       pair_stop_shared(n, count, count - 1));

	/* A single burst has no gap, and the widest tube has no bounds. */
	if (count > 1 && p->b * gap + p->a > 2 * half && half < p->a * p->b)
		return false;
	return p->b * first <= half && p->b * (p->a - last) <= half;
}

/* The smallest number of bursts at the stops of the lead that is enough for @p;
 * 0 if none is. */
static int64_t shared_bursts(const struct interp_pair *p,
			     const struct interp_pair *lead, int64_t half)
{
	const int64_t n = lead->bursts;
	const int64_t room = 2 * half - p->a;
	int64_t every;

	if (room <= 0)
		return 0;
	every = (int64_t)((pulse_wide)room * n / (p->a * p->b)) + 1;
	every = every < n ? every : n;
	for (int tries = 0; tries < 4 && every > 1; tries++, every--) {
		const int64_t count = (n + every - 1) / every;

		if (shared_ok(p, lead, count, half))
			return count;
	}
	return shared_ok(p, lead, n, half) ? n : 0;
}

static bool tube_set(struct interp_pair *pair, uint32_t npairs,
		     struct pair_tube t, int64_t burst, bool at_end)
{
	uint32_t lead = 0;

	for (uint32_t i = 1; i < npairs; i++)
		lead = pair[i].b > pair[lead].b ? i : lead;
	pair_set_bursts(&pair[lead], (pair[lead].b + burst - 1) / burst, NULL,
			at_end);
	for (uint32_t i = 0; i < npairs; i++) {
		struct interp_pair *p = &pair[i];
		int64_t count;

		if (i == lead)
			continue;
		if (p->b == pair[lead].b) {
			/* The same bursts, at the same places. */
			pair_set_bursts(p, pair[lead].bursts, NULL, at_end);
			continue;
		}
		count = shared_bursts(p, &pair[lead],
				      pair_half_width(p->a, p->b, t));
		if (count == 0)
			return false;
		pair_set_bursts(p, count, &pair[lead], at_end);
	}
	return true;
}

/* Changes of axis, at most: one to each burst, and one from each stop. */
static int64_t star_changes(const struct interp_pair *pair, uint32_t npairs,
			    struct pair_tube t)
{
	int64_t n = 0;

	for (uint32_t i = 0; i < npairs; i++) {
		const struct interp_pair *p = &pair[i];
		const int64_t burst = pair_burst(p->a, p->b,
				pair_half_width(p->a, p->b, t));

		n += 2 * ((p->b + burst - 1) / burst);
	}
	return n;
}

static int64_t tube_changes(const struct interp_pair *pair, uint32_t npairs)
{
	int64_t n = 0, stops = 0;

	for (uint32_t i = 0; i < npairs; i++) {
		n += pair[i].bursts;
		stops = pair[i].bursts > stops ? pair[i].bursts : stops;
	}
	return n + stops;
}

/* The longest bursts of the lead that still leave the others their
 * tolerance. */
static bool tube_plan(struct interp_pair *pair, uint32_t npairs,
		      struct pair_tube t, bool at_end)
{
	const int64_t star = star_changes(pair, npairs, t);
	int64_t b = 0, burst;

	for (uint32_t i = 0; i < npairs; i++)
		b = pair[i].b > b ? pair[i].b : b;
	burst = pair_burst(pair[0].a, b, pair_half_width(pair[0].a, b, t));
	/* Each pulse less gives an axis a pulse of room; two are enough. */
	for (int tries = 0; tries < 4 && burst >= 1; tries++, burst--) {
		if (tube_set(pair, npairs, t, burst, at_end))
			return tube_changes(pair, npairs) < star;
	}
	return false;
}

bool couple_set_flat(struct interp_pair *pair, uint32_t npairs,
		     const struct couple_rule *r, bool at_end)
{
	struct couple_rule axis = *r;

	axis.tube = axis_tube(r->tube, npairs);
	if (r->coupling == INTERP_TUBE && pulse_strategy(r->strategy)->runs &&
	    npairs > 1 && tube_plan(pair, npairs, axis.tube, at_end))
		return true;
	couple_set(pair, npairs, &axis, at_end);
	return false;
}

/* -- Which mu a line allows
 * ------------------------------------------------- */

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
