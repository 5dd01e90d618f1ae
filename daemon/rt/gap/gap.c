/* SPDX-License-Identifier: Apache-2.0 */
/* gap.c - from what the machine says, whatever its sensor, to one reading */
#include "gap/gap.h"
#include "path/laws.h"
#include "path/place.h"

#include "interp/smaller.h"

#include <math.h>
#include <string.h>

#define BELOW_MAX_V	5.0		/* the offset that an amplifier may
					 * have */
#define ABOVE_MAX	1.5		/* of the ignition voltage */
#define SHARES_SLACK	0.01		/* rounding by the sensor that counts */
#define CHANGE_CYCLES	1000.0		/* cycles over which the mean of the
					 * noise is taken */
#define MOVED_MM	0.001		/* a smaller change is not a change of
					 * the gap */

double gap_window_high_v(const struct cycle *c)
{
	return c->gap.window_high_v > 0 ? c->gap.window_high_v :
					  c->gap.servo_v;
}

/* If it is derived, it is halfway from the servo voltage down to the short. */
double gap_window_low_v(const struct cycle *c)
{
	const double high = gap_window_high_v(c);
	const double low = c->gap.window_low_v > 0 ? c->gap.window_low_v :
			   (c->gap.short_v + c->gap.servo_v) / 2;

	return smaller(low, high);
}

/* -- Can it be true? ------------------------------------------------------- */

/* A reading is of the pulses that were, not of those of the place. */
static bool voltage_ok(const struct cycle *c, const struct io_inputs *in)
{
	const double most = ABOVE_MAX * c->asking.ignition_v;

	return in->gap_valid && isfinite(in->gap_v) &&
	       in->gap_v >= -BELOW_MAX_V && (most <= 0 || in->gap_v <= most);
}

/* None of them is over their sum. */
static bool shares_ok(const struct io_inputs *in)
{
	const struct io_shares *s = &in->shares;

	return in->shares_valid && s->open >= 0 && s->spark >= 0 &&
	       s->arc >= 0 && s->shorted >= 0 &&
	       (double)s->open + (double)s->spark + (double)s->arc +
	       (double)s->shorted <= 1 + SHARES_SLACK;
}

/* -- The signal, by source ------------------------------------------------- */

static void from_voltage(struct cycle *c, const struct io_inputs *in,
			 struct gap_reading *r)
{
	r->valid = voltage_ok(c, in);
	r->v = r->valid ? larger(in->gap_v, 0) : 0;
	r->now_v = r->v;
	r->contact = r->valid && r->v < c->gap.short_v;
	r->is_open = r->valid && r->v > c->gap.open_v;
}

static void weigh(const struct cycle *c, const struct io_inputs *in,
		  struct gap_reading *r)
{
	const struct cycle_gap_config *g = &c->gap;
	const double open = (double)in->shares.open;
	const double bad = (double)in->shares.shorted + (double)in->shares.arc;

	r->valid = shares_ok(in);
	if (!r->valid)
		return;
	r->now_v = g->servo_v + g->share_v *
		   (open - g->share_weight * bad - g->share_set);
	r->contact = (double)in->shares.shorted >= g->share_short;
	r->is_open = open >= g->share_open;
}

/* If there were no pulses to count, the sensing voltage is used. */
static void from_shares(struct cycle *c, const struct io_inputs *in,
			struct gap_reading *r)
{
	from_voltage(c, in, r);
	if (c->gap_past.powered >= 2 || !in->gap_valid)
		weigh(c, in, r);
}

/* Nothing is known yet.  It is open, and it stands: it is blind. */
static void await(struct cycle *c, struct gap_reading *r)
{
	r->valid = r->is_open = r->blind = true;
	r->contact = false;
	r->now_v = 2 * c->gap.open_v;
	c->gap_past.awaits = true;
}

/* The filter begins with the first reading, and each is good for some way. */
static void from_counts(struct cycle *c, const struct io_inputs *in,
			struct gap_reading *r)
{
	struct gap_memory *m = &c->gap_past;

	if (in->shares_due && m->powered >= 2) {
		from_voltage(c, in, r);
		await(c, r);
		return;
	}
	if (m->awaits)
		m->npast = m->next = 0;
	m->awaits = false;
	from_shares(c, in, r);
	if (!in->shares_old)
		m->read_mm = place_mm(c);
	r->blind = c->out.power &&
		   fabs(place_mm(c) - m->read_mm) >= c->gap.share_mm;
}

/* Three comparators, each of them a line that is 0 or 1. */
static void from_lines(struct cycle *c, const struct io_inputs *in,
		       struct gap_reading *r)
{
	const struct io_shares *s = &in->shares;

	r->contact = s->shorted > 0;
	r->is_open = s->open > 0 && !r->contact && !(s->spark > 0);
	r->now_v = r->contact ? 0 :
		   r->is_open ? 2 * c->gap.open_v :
		   (gap_window_low_v(c) + gap_window_high_v(c)) / 2;
	/* In a retract nothing sparks, so a gap that is not shorted is
	 * clear. */
	if (!c->out.power && !r->contact)
		r->now_v = 2 * c->gap.open_v;
	r->valid = in->shares_valid &&
		   (s->open > 0 || s->spark > 0 || s->shorted > 0);
	r->contact = r->contact && r->valid;
	if (!in->shares_valid)
		r->now_v = 0;
	r->v = in->gap_valid && isfinite(in->gap_v) ? in->gap_v : r->now_v;
}

static void from_can(struct cycle *c, const struct io_inputs *in,
		     struct gap_reading *r)
{
	if (in->shares_valid)
		from_shares(c, in, r);
	else
		from_voltage(c, in, r);
}

static void (*const sources[GAP_NSOURCES])(struct cycle *,
					   const struct io_inputs *,
					   struct gap_reading *) = {
	[GAP_SIM]	= from_voltage,
	[GAP_VOLTAGE]	= from_voltage,
	[GAP_SHARES]	= from_shares,
	[GAP_LINES]	= from_lines,
	[GAP_CAN]	= from_can,
	[GAP_COUNTS]	= from_counts,
};

/* -- Filters --------------------------------------------------------------- */

/* Sort by insertion: there are at most 15 values. */
static double median(const double *v, uint32_t n)
{
	double sorted[GAP_FILTER_MAX];

	for (uint32_t i = 0; i < n; i++) {
		uint32_t k = i;

		for (; k > 0 && sorted[k - 1] > v[i]; k--)
			sorted[k] = sorted[k - 1];
		sorted[k] = v[i];
	}
	return n % 2 ? sorted[n / 2] :
		       (sorted[n / 2 - 1] + sorted[n / 2]) / 2;
}

static double filtered(struct gap_memory *m, const struct cycle_gap_config *g,
		       double v)
{
	const uint32_t n = g->filter_cycles < GAP_FILTER_MAX ?
			   g->filter_cycles : GAP_FILTER_MAX;

	if (n < 2)
		return v;
	m->low_v += m->npast ? (v - m->low_v) / n : v - m->low_v;
	m->past_v[m->next % n] = v;
	m->next = (m->next + 1) % n;
	m->npast = m->npast < n ? m->npast + 1 : n;
	return g->filter == GAP_FIRST_ORDER ? m->low_v :
					      median(m->past_v, m->npast);
}

/* With power on, the same gap gives another signal; so the readings before say
 * nothing. */
static void forget(struct gap_memory *m, bool power)
{
	const bool same = (m->powered > 0) == power;

	m->powered = power ? m->powered + 1 : 0;
	if (same)
		return;
	m->npast = m->next = 0;
	m->arcing_cycles = 0;
	m->same_cycles = 0;
}

/* -- Arcs ------------------------------------------------------------------ */

/*
 * The voltage of sparks scatters with their ignition delay. An arc has no such
 * delay, and its voltage stays on the plateau. This is only for a machine that
 * does not count pulses.
 */
static double arcing_by_voltage(const struct cycle *c, struct gap_memory *m,
			     double v)
{
	const double n = fmax(1, c->gap.arcing_cycles);
	const double d = v - m->arcing_mean_v;

	if (!c->out.power || c->gap.arcing_sigma_v <= 0 ||
	    c->gap.source == GAP_COUNTS)
		return 0;
	if (m->arcing_cycles++ == 0) {
		m->arcing_mean_v = v;
		m->arcing_var_v2 = 0;
		return 0;
	}
	m->arcing_mean_v += d / n;
	m->arcing_var_v2 += (d * d - m->arcing_var_v2) / n;
	return (double)m->arcing_cycles > n &&
	       m->arcing_mean_v >= c->gap.short_v &&
	       m->arcing_mean_v <= gap_window_high_v(c) &&
	       m->arcing_var_v2 < c->gap.arcing_sigma_v *
				  c->gap.arcing_sigma_v ? 1 : 0;
}

/* -- Is it alive? ---------------------------------------------------------- */

/* Lines do not change by themselves, and neither do the shares of an open
 * gap. */
static bool may_stand(const struct cycle *c, const struct gap_reading *r)
{
	return c->gap.source == GAP_LINES ||
	       (r->is_open && (c->gap.source == GAP_SHARES ||
			       c->gap.source == GAP_CAN ||
			       c->gap.source == GAP_COUNTS));
}

static bool suspect(const struct cycle *c, struct gap_memory *m,
		    const struct gap_reading *r)
{
	const double place = place_mm(c);

	m->change_v += (fabs(r->now_v - m->before_v) - m->change_v) /
		       CHANGE_CYCLES;
	if (r->now_v != m->before_v || !c->out.power || may_stand(c, r)) {
		m->same_cycles = 0;
		m->same_mm = place;
	}
	m->before_v = r->now_v;
	m->same_cycles++;
	if (c->gap.noise_limit_v > 0 && m->change_v > c->gap.noise_limit_v)
		return true;
	return c->gap.stuck.cycles && m->same_cycles > c->gap.stuck.cycles &&
	       fabs(place - m->same_mm) >= MOVED_MM;
}

/* Lines say nothing while nothing sparks. But to probe, they must be read. */
static bool lines_unreadable(const struct cycle *c, const struct io_inputs *in)
{
	return c->out.power || (c->out.sense && !in->shares_valid);
}

/* A probe may have an input of its own; then that input is enough. */
bool gap_is_unreadable(const struct cycle *c, const struct io_inputs *in)
{
	if (c->config.dry_run || (c->state == STATE_PROBE && in->contact))
		return false;
	return c->gap.source != GAP_LINES || lines_unreadable(c, in);
}

void gap_forget(struct cycle *c)
{
	c->gap_past = (struct gap_memory) { .powered = 0 };
}

/* A sum of which a part was not counted would be a guess. */
static void sum_energy(struct cycle *c, const struct io_inputs *in)
{
	if (c->out.power)
		c->totals.energy_j += in->energy_valid ? in->energy_j : NAN;
}

void gap_sense(struct cycle *c, const struct io_inputs *in)
{
	struct gap_memory *m = &c->gap_past;
	struct gap_reading *r = &c->sensed;
	const bool before = r->contact;

	*r = (struct gap_reading) { .valid = false };
	forget(m, c->out.power);
	sources[c->gap.source](c, in, r);
	r->arc = shares_ok(in) ? (double)in->shares.arc :
				 arcing_by_voltage(c, m, r->now_v);
	m->contacts = r->contact ? m->contacts + 1 : 0;
	r->is_short = r->contact && m->contacts >= c->gap.short_cycles;
	r->signal_v = filtered(m, &c->gap, r->now_v);
	r->suspect = c->loaded && suspect(c, m, r);
	if (r->contact && !before && state_duty[c->state].power)
		c->totals.shorts++;
	sum_energy(c, in);
	c->gap_v = r->v;
}
