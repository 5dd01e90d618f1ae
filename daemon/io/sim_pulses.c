/* SPDX-License-Identifier: Apache-2.0 */
/*
 * sim_pulses.c - what a train of pulses does in a gap
 *
 * Every pulse of the generator comes out in one of four ways.  It meets
 * metal (short); it ignites at once where the last one burnt (arc); it
 * ignites after a delay (spark); or it finds no way through (open).  With x
 * the gap above contact in units of the peaks, and u the same in units of the
 * reach of the ignition voltage:
 *
 *	P(short) = exp(-3 x)
 *	delay    = delay at the best gap * u^2 / (1 - u), by its value there
 *	P(open)  = exp(-longest wait / delay)		delays are exponential
 *
 * Expected values follow in closed form; nothing is looped over pulses.
 */
#include "sim_process.h"

#include <math.h>

#define PEAKS		3.0	/* P(short) = exp(-PEAKS) at the best gap */
#define ARC_V		0.8	/* an arc's voltage, of a spark's */
#define LATE		5.0	/* one in so many waits is late at best_gap */
#define DIRTY_DELAY	0.5	/* debris 1 shortens the delay by so much */

/* The pulse [sim] removal_mm3_min is given for: Liu et al. 2025, table 1. */
#define REFERENCE_A	6.0
#define REFERENCE_ON_US	8.0
#define REFERENCE_OFF_US 20.0

/*
 * The delay that makes best_gap_mm the best gap, in parts of on + off time.
 * The removal is (1 - P(short)) / (delay + on + off); its slope at x = 1 is 0
 * where PEAKS / (exp(PEAKS) - 1) = slope * delay / (delay + on + off), with
 * slope that of log(delay) over log(x).
 */
static double best_delay(double best_u)
{
	const double gain = PEAKS / expm1(PEAKS);
	const double slope = 2 + best_u / (1 - best_u);

	return gain / (slope - gain);
}

/* Volume of a spark of the reference pulse, from the rate at its best gap. */
static double reference_crater_mm3(double removal_mm3_min, double delay)
{
	const double pulses_s = 1e6 / ((REFERENCE_ON_US + REFERENCE_OFF_US) *
				       (1 + delay));

	return removal_mm3_min / 60 / (pulses_s * -expm1(-PEAKS));
}

static double given(double asked, double own)
{
	return isfinite(asked) && asked > 0 ? asked : own;
}

static double crater_mm3(const struct sim *s, double peak_a, double on_us)
{
	return s->reference_mm3 *
	       pow(peak_a / REFERENCE_A, s->p.crater_peak_power) *
	       pow(on_us / REFERENCE_ON_US, s->p.crater_on_power);
}

void sim_pulses_set(struct sim *s)
{
	const double *o = s->out.pulse;
	const struct config_sim *p = &s->p;
	const double peak_a = given(o[INTERP_TECH_PEAK_A], p->peak_a);
	struct pulse_set *q = &s->pulse;
	double larger;

	q->on_us = given(o[INTERP_TECH_ON_US], p->on_us);
	q->off_us = given(o[INTERP_TECH_OFF_US], p->off_us);
	q->open_v = given(o[INTERP_TECH_IGNITION_V], p->open_v);
	q->iso = isfinite(o[INTERP_TECH_ON_US]) ?
		 o[INTERP_TECH_ISO] > 0 : p->iso != 0;
	q->crater_mm3 = crater_mm3(s, peak_a, q->on_us);
	q->channel = exp(-q->off_us / p->deion_us);
	q->crater_j = peak_a * p->spark_v * q->on_us * 1e-6;
	/* Larger craters, higher peaks. */
	larger = cbrt(q->crater_mm3 / crater_mm3(s, p->peak_a, p->on_us));
	q->short_mm = p->short_gap_mm * larger;
	q->peaks_mm = (p->best_gap_mm - p->short_gap_mm) * larger;
	q->reach_mm = (p->open_gap_mm - p->short_gap_mm) * q->open_v /
		      p->open_v;
}

void sim_pulses_init(struct sim *s)
{
	const struct config_sim *p = &s->p;
	double delay;

	s->best_u = (p->best_gap_mm - p->short_gap_mm) /
		    (p->open_gap_mm - p->short_gap_mm);
	delay = best_delay(s->best_u);
	s->delay_us = delay * (p->on_us + p->off_us);
	s->late_us = p->open_us > 0 ? p->open_us : s->delay_us * log(LATE);
	s->reference_mm3 = reference_crater_mm3(p->removal_mm3_min, delay);
	sim_pulses_set(s);
}

/* Mean delay of an ignition; no end of it beyond the reach. */
static double delay_us(const struct sim *s, double gap_mm)
{
	const double u = (gap_mm - s->pulse.short_mm) / s->pulse.reach_mm;
	const double of_best = u / s->best_u;

	if (!(u < 1))
		return INFINITY;
	return s->delay_us * (1 - DIRTY_DELAY * s->debris) * of_best *
	       of_best * (1 - s->best_u) / (1 - u);
}

/*
 * Of the pulses that ignite, those in the last one's channel: it had not
 * recovered and debris lay in it, or it has become hot.
 */
static double arc_part(const struct sim *s)
{
	const double left = exp(-s->pulse.off_us /
				(s->p.deion_us * (1 + s->debris)));

	return 1 - (1 - left * s->debris) * (1 - s->hot);
}

/* What one pulse is likely to be, before time comes into it. */
struct odds {
	double free;			/* no short */
	double ignites;			/* of those */
	double arc;			/* of those that ignite */
	double wait_us;			/* for an ignition, arcs apart */
	double late;			/* longer than a count's open_us */
};

static struct odds odds(const struct sim *s, double gap_mm)
{
	const double x = (gap_mm - s->pulse.short_mm) / s->pulse.peaks_mm;
	struct odds o = { .free = x > 0 ? -expm1(-PEAKS * x) : 0 };
	const double limit = s->pulse.iso ? s->p.wait_us : s->pulse.on_us;
	const double delay = delay_us(s, gap_mm);
	const bool reaches = delay < INFINITY;

	if (!reaches || !(o.free > 0)) {
		o.wait_us = reaches ? 0 : limit;
		o.ignites = reaches ? 1 : 0;
		o.late = 1 - o.ignites;
		return o;
	}
	o.ignites = -expm1(-limit / delay);
	o.wait_us = delay * o.ignites;
	o.late = exp(-smaller(limit, s->late_us) / delay);
	o.arc = arc_part(s);
	return o;
}

/* From pulses to time: the mean voltage is that of all of a pulse's time. */
void sim_pulses_train(struct sim *s, double gap_mm)
{
	const struct pulse_set *q = &s->pulse;
	const struct odds o = odds(s, gap_mm);
	const double spark = o.free * o.ignites * (1 - o.arc);
	const double arc = o.free * o.ignites * o.arc;
	const double open = o.free * (1 - o.ignites);
	const double wait_us = (o.free - arc) * o.wait_us;
	double total_us = q->on_us + q->off_us;
	double burn_us = spark * q->on_us;	/* of sparks, arcs apart */

	if (q->iso)
		total_us += wait_us - open * q->on_us;
	else
		burn_us = larger(0, (o.free - arc) * q->on_us - wait_us);
	s->train = (struct pulse_train) {
		.spark = spark, .arc = arc, .shorted = 1 - o.free,
		.late = (o.free - arc) * o.late,
		.volts = (q->open_v * wait_us + s->p.spark_v * burn_us +
			  ARC_V * s->p.spark_v * q->on_us * arc) / total_us,
		.total_us = total_us, .wait_us = wait_us, .ignites = o.ignites,
		.per_s = 1e6 / total_us,
		.burnt = spark > 0 ? burn_us / (spark * q->on_us) : 0,
	};
}

double sim_pulses_j(const struct sim *s)
{
	const struct pulse_train *t = &s->train;

	return t->per_s * s->period_s * s->pulse.crater_j *
	       (t->spark * t->burnt + ARC_V * t->arc);
}

/* -- As counted and read -------------------------------------------------- */

static double counted(struct sim *s, double part, double pulses)
{
	const double sigma = sqrt(part * (1 - part) / pulses);

	return larger(0, part + sigma * rng_normal(&s->rng));
}

static struct io_shares shares_of(double open, double spark, double arc,
				  double shorted)
{
	const double sum = open + spark + arc + shorted;

	if (sum <= 0)
		return (struct io_shares) { .spark = 1 };
	return (struct io_shares) {
		(float)(open / sum), (float)(spark / sum),
		(float)(arc / sum), (float)(shorted / sum),
	};
}

/* The sparks are what is left, and may be below 0 by rounding; the other parts
 * cannot. */
struct io_shares sim_pulses_shares(struct sim *s)
{
	const struct pulse_train *t = &s->train;
	const double pulses = t->per_s * s->period_s;
	const double spark = larger(0, 1 - t->late - t->arc - t->shorted);
	double n[4] = { t->late, spark, t->arc, t->shorted };

	if (!s->p.counted)
		return shares_of(t->late, spark, t->arc, t->shorted);
	for (int i = 0; i < 4; i++)
		n[i] = counted(s, n[i], pulses);
	return shares_of(n[0], n[1], n[2], n[3]);
}

struct io_shares sim_pulses_lines(struct sim *s, bool sparks)
{
	const struct io_shares n = sparks ? sim_pulses_shares(s) :
		(struct io_shares) { .open = (float)(1 - s->train.shorted),
				     .shorted = (float)s->train.shorted };

	return n.shorted > 0.5f ? (struct io_shares) { .shorted = 1 } :
	       n.open > 0.5f ? (struct io_shares) { .open = 1 } :
			       (struct io_shares) { .spark = 1 };
}

/*
 * A sum of n exponential waits, by its mean: a gamma deviate, near enough by
 * the cube of a normal one (Wilson and Hilferty, 1931).
 */
static double gamma_part(struct sim *s, double n)
{
	const double v = 1 / (9 * larger(n, 1));
	const double root = larger(0, 1 - v + sqrt(v) * rng_normal(&s->rng));

	return root * root * root;
}

/* A longer wait leaves less of the period to the rest. */
static double scattered(struct sim *s)
{
	const struct pulse_train *t = &s->train;
	const double waits = s->period_s * 1e6 / t->total_us /
			     larger(t->ignites, 1e-9);
	const double more = gamma_part(s, waits) - 1;

	return (t->volts + s->pulse.open_v * t->wait_us / t->total_us * more) /
	       (1 + t->wait_us / t->total_us * more);
}

double sim_pulses_volts(struct sim *s, bool sparks)
{
	const double v = sparks && s->p.counted ? scattered(s) : s->train.volts;

	return larger(0, v + s->p.noise_v * rng_normal(&s->rng));
}
