/* SPDX-License-Identifier: Apache-2.0 */
/*
 * sim.c - a simulated sinker: axes without inertia, a gap with a seed
 *
 * The workpiece is a front on the path: what lies beyond it is solid.  The
 * gap is the way from the electrode to that front,
 *
 *	gap = front + wear - place
 *
 * so every cut meets fresh material after [sim] standoff_mm of air, and
 * positioning (rapid) moves through free space and leaves the front there.
 *
 *	effective gap = gap - debris_gap_mm * debris
 *	u             = (effective - short_gap) / (open_gap - short_gap)
 *	mean voltage  = spark plateau rising to the open voltage with u
 *	removal       = the most at best_gap, none at a short or when open
 *
 * Debris is made by erosion, settles by itself, and is washed out by the
 * stroke of the electrode; it narrows the gap and builds bridges: shorts that
 * last until the gap has opened beyond their length, or they have dissolved.
 *
 * The generator's on and off time and peak current scale the removal.
 */
#include "config.h"
#include "io.h"
#include "rng.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct sim {
	struct config_sim p;
	double period_s;
	struct rng rng;
	struct io_outputs out;		/* as last written */
	double front_mm;		/* on the path: solid from here on */
	double wear_mm;			/* electrode length lost */
	double debris;			/* 0 clean ... 1 choked */
	double bridge_mm;		/* a bridge of debris; 0: none */
	double place_mm;		/* the cycle before */
	double removed_mm3;
	double rate_mm_s;		/* front's speed at the best gap */
};

static double effective_gap(const struct sim *s)
{
	return s->front_mm + s->wear_mm - s->out.place_mm -
	       s->p.debris_gap_mm * s->debris;
}

static bool is_short(const struct sim *s, double gap_mm)
{
	const double real = s->front_mm + s->wear_mm - s->out.place_mm;

	return gap_mm <= s->p.short_gap_mm || real < s->bridge_mm;
}

/*
 * Sparks hold about spark_v; the wider the gap, the more pulses find no
 * spark and stand at open_v, all of them from open_gap on.
 */
static double mean_voltage(const struct sim *s, double gap_mm)
{
	const double u = (gap_mm - s->p.short_gap_mm) /
			 (s->p.open_gap_mm - s->p.short_gap_mm);
	const double rise = u < 0.2 ? u / 0.2 : 1;
	const double open = u < 0.4 ? 0 : u > 1 ? 1 : (u - 0.4) / 0.6;

	return s->p.spark_v * rise + (s->p.open_v - s->p.spark_v) * open * open;
}

/* Share of the best removal: x * exp(1 - x), cut to nothing when open. */
static double removal_share(const struct sim *s, double gap_mm)
{
	const double x = (gap_mm - s->p.short_gap_mm) /
			 (s->p.best_gap_mm - s->p.short_gap_mm);

	if (x <= 0 || gap_mm >= s->p.open_gap_mm)
		return 0;
	return x * exp(1 - x);
}

static void erode(struct sim *s, double gap_mm)
{
	const double d = s->rate_mm_s * removal_share(s, gap_mm) * s->period_s;

	s->front_mm += d;
	s->wear_mm += d * s->p.wear_ratio;
	s->removed_mm3 += d * s->p.area_mm2;
	s->debris += d * s->p.debris_per_mm;
	if (s->debris > 1)
		s->debris = 1;
}

/* Settling by time, washing by stroke; a stroke of flush_mm halves it. */
static void wash(struct sim *s, double stroke_mm)
{
	s->debris -= s->debris * s->period_s / s->p.debris_settle_s;
	if (!s->out.power && stroke_mm > 0)
		s->debris *= exp2(-stroke_mm / s->p.flush_mm);
}

/* A bridge is born of debris, and breaks when the gap outgrows it. */
static void bridge(struct sim *s)
{
	const double real = s->front_mm + s->wear_mm - s->out.place_mm;
	const double chance = s->p.bridge_per_s * s->debris * s->debris *
			      s->period_s;

	s->bridge_mm -= s->bridge_mm * s->period_s / s->p.bridge_settle_s;
	if (real > s->bridge_mm)
		s->bridge_mm = 0;
	if (s->out.power && s->bridge_mm == 0 && rng_uniform(&s->rng) < chance)
		s->bridge_mm = real - s->p.bridge_mm *
			       log(1 - rng_uniform(&s->rng));
}

static void sim_write(void *self, const struct io_outputs *out)
{
	struct sim *s = self;
	double stroke;

	/* Another program is another path, and a workpiece of its own. */
	if (out->path != s->out.path) {
		s->place_mm = out->place_mm;
		s->front_mm = out->place_mm - s->wear_mm + s->p.standoff_mm;
		s->bridge_mm = 0;
	}
	stroke = fabs(out->place_mm - s->place_mm);
	s->place_mm = out->place_mm;
	s->out = *out;
	if (out->rapid)
		s->front_mm = fmax(s->front_mm, out->place_mm - s->wear_mm +
						s->p.standoff_mm);
	wash(s, stroke);
}

static void sim_read(void *self, struct io_inputs *in)
{
	struct sim *s = self;
	double gap, v;

	bridge(s);
	gap = effective_gap(s);
	v = is_short(s, gap) ? 0 : mean_voltage(s, gap);
	if (s->out.power && v > 0)
		erode(s, gap);
	v += s->p.noise_v * rng_normal(&s->rng);
	*in = (struct io_inputs) {
		.gap_v = v < 0 ? 0 : v,
		.gap_valid = true,
	};
	memcpy(in->actual, s->out.target, sizeof(in->actual));
}

static void sim_close(void *self)
{
	free(self);
}

void io_sim_result(const struct io_machine *m, struct io_sim_result *ret)
{
	const struct sim *s = m->self;

	*ret = (struct io_sim_result) {
		.removed_mm3 = s->removed_mm3, .wear_mm = s->wear_mm,
		.debris = s->debris,
	};
}

/*
 * Charge per second relative to the pulse that removal_mm3_min is given for:
 * 6 A, 8 us on, 20 us off (Liu et al. 2025, table 1).
 */
static double pulse_strength(const struct config_sim *p)
{
	const double reference = 6.0 * 8 / (8 + 20);

	return p->peak_a * p->on_us / (p->on_us + p->off_us) / reference;
}

int io_sim_open(struct io_machine *m, const struct machine_config *c,
		uint64_t seed)
{
	struct sim *s = calloc(1, sizeof(*s));

	if (!s)
		return -ENOMEM;
	s->p = c->sim;
	s->period_s = (double)config_period_ns(c) * 1e-9;
	s->rate_mm_s = s->p.removal_mm3_min * pulse_strength(&s->p) / 60 /
		       s->p.area_mm2;
	rng_seed(&s->rng, seed);
	*m = (struct io_machine) {
		.name = "sim", .self = s, .read = sim_read,
		.write = sim_write, .close = sim_close,
	};
	return 0;
}
