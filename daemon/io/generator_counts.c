/* SPDX-License-Identifier: Apache-2.0 */
/*
 * generator_counts.c - from the sums of pulses that a generator tells to the
 * shares that the gap servo goes by
 *
 * A reading lies between two tellings with sparks, so that no pulse of before a
 * jump is in it.  It is of a least number of pulses, or of those of half of the
 * time in which it must come.
 */
#include "generator_own.h"

#include <math.h>

#define COUNT_OF(i)	(PROCESS_OPENS + (i))

static bool has_told_all(const struct generator *g)
{
	const uint32_t all = (1u << GENERATOR_NCOUNTS) - 1;

	return (g->says.tells >> PROCESS_OPENS & all & ~g->counts.told) == 0;
}

/* What it does not count is 0. */
static double sum_of(const struct generator *g, int i)
{
	const double sum = g->heard[COUNT_OF(i)];

	return isnan(sum) ? 0 : sum;
}

static void begin_anew(struct generator *g)
{
	struct generator_counts *n = &g->counts;

	for (int i = 0; i < GENERATOR_NCOUNTS; i++)
		n->from[i] = sum_of(g, i);
	n->begun = true;
	n->reset = false;
}

static void take(struct generator *g)
{
	struct generator_counts *n = &g->counts;
	double more[GENERATOR_NCOUNTS], all = 0;

	n->told = 0;
	for (int i = 0; i < GENERATOR_NCOUNTS; i++) {
		more[i] = sum_of(g, i) - n->from[i];
		all += more[i];
	}
	if (!n->begun || n->reset) {
		begin_anew(g);
		return;
	}
	if (!(all > 0) || (all < n->least && n->age < n->stale / 2))
		return;
	n->shares = (struct io_shares) {
		.open = (float)(more[0] / all), .spark = (float)(more[1] / all),
		.arc = (float)(more[2] / all),
		.shorted = (float)(more[3] / all),
	};
	n->read = true;
	n->age = 0;
	begin_anew(g);
}

/* The first sum that it does not tell any more; PROCESS_FAULT: it tells all,
 * and they stand still or jump. */
static int missing(const struct generator *g)
{
	for (int i = 0; i < GENERATOR_NCOUNTS; i++)
		if (g->says.tells >> COUNT_OF(i) & 1 &&
		    g->age[COUNT_OF(i)] >= g->counts.stale)
			return COUNT_OF(i);
	return PROCESS_FAULT;
}

void generator_counts_hear(struct generator *g, int field, bool reset)
{
	const int i = field - PROCESS_OPENS;

	if (i < 0 || i >= GENERATOR_NCOUNTS)
		return;
	g->counts.told |= 1u << i;
	g->counts.reset = g->counts.reset || reset;
}

void generator_counts_read(struct generator *g, struct io_inputs *in)
{
	struct generator_counts *n = &g->counts;
	const bool sparks = g->value[PROCESS_SPARK] > 0;

	if (!n->wanted)
		return;
	if (!sparks) {
		n->begun = n->read = n->reset = false;
		n->told = n->age = 0;
	} else {
		n->age++;
		if (has_told_all(g))
			take(g);
		if (n->age == n->stale + 1)
			generator_tell(g, &(struct generator_note) {
				.kind = GENERATOR_UNCOUNTED,
				.field = missing(g) });
	}
	in->shares = n->shares;
	in->shares_valid = n->read && n->age <= n->stale;
	in->shares_old = n->age > 0;
	in->shares_due = sparks && !n->read && n->age <= n->stale;
}

void generator_counts_init(struct generator *g, const struct machine_config *c,
			   uint32_t stale)
{
	g->counts = (struct generator_counts) {
		.wanted = c->gap.source == GAP_COUNTS,
		.least = c->gap.share_pulses, .stale = stale,
	};
}
