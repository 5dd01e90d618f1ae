/* SPDX-License-Identifier: Apache-2.0 */
/*
 * random_drives.h - random maps, backlash and leads, drives that lag or report
 * wrong places, and what must hold for the pulses that they are sent
 */
#ifndef RANDOM_DRIVES_H
#define RANDOM_DRIVES_H

#include "cycle_help.h"

#include "interp/errormap.h"

#include <stdlib.h>

/* Measured places, pulses; and what was seen a period ago. */
struct random_drives {
	double actual[INTERP_NAXES];
	int32_t place[INTERP_NAXES];	/* on the path */
	int32_t added[INTERP_NAXES];	/* by contouring */
	int32_t cured[INTERP_NAXES];	/* by maps and backlash */
	int stood, unfrozen;		/* periods in a row, at rest */
	bool begun;
};

/* -- Any there can be ----------------------------------------------------- */

static inline void random_row(struct interp_errormap_row *r, uint64_t *s)
{
	double at = uniform(s, -5, 0), error = uniform(s, -0.02, 0.02);

	r->along = (uint8_t)(rnd(s) % INTERP_NAXES);
	r->across = (uint8_t)(rnd(s) % INTERP_NAXES);
	r->n = (uint16_t)(2 + rnd(s) % (INTERP_ERRORMAP_POINTS - 1));
	for (int i = 0; i < r->n; i++) {
		const double way = uniform(s, 1e-3, 10.0 / r->n);

		r->at_mm[i] = at += way;
		r->error_mm[i] = error += uniform(s, -0.99, 0.99) * way *
					  INTERP_ERRORMAP_SLOPE_MAX;
	}
}

static inline void random_maps(struct interp_errormap *m, uint64_t *s)
{
	m->nrows = (int)(rnd(s) % (INTERP_ERRORMAP_ROWS + 1));
	for (int i = 0; i < m->nrows; i++)
		random_row(&m->row[i], s);
	m->nleans = (int)(rnd(s) % (INTERP_ERRORMAP_LEANS + 1));
	for (int i = 0; i < m->nleans; i++) {
		const uint64_t along = rnd(s) % INTERP_NAXES;
		const uint64_t off = 1 + rnd(s) % (INTERP_NAXES - 1);

		m->lean[i] = (struct interp_errormap_lean) {
			(uint8_t)along, (uint8_t)((along + off) % INTERP_NAXES),
			uniform(s, -1, 1) * INTERP_ERRORMAP_SLOPE_MAX
		};
	}
	for (int i = 0; i < INTERP_NAXES && rnd(s) % 2; i++)
		m->growth[i] = (struct interp_errormap_growth) {
			uniform(s, -1e-4, 1e-4), uniform(s, -5, 5),
			uniform(s, -50, 50)
		};
	assert_int_equal(interp_errormap_check(m), 0);
}

static inline void random_comp(struct comp_config *k, uint64_t *s)
{
	if (rnd(s) % 2)
		random_maps(&k->maps, s);
	k->mapped = !interp_errormap_is_empty(&k->maps);
	k->maps_c = 20;
	for (int i = 0; i < INTERP_NAXES; i++) {
		k->axis[i].pulse_mm = PULSE_MM;
		k->axis[i].backlash = rnd(s) % 2 ? (int32_t)(rnd(s) % 30) : 0;
		k->axis[i].take_up = rnd(s) % 2 ? uniform(s, 0.05, 1) :
						  uniform(s, 1, 20);
	}
}

static inline void random_loop(struct contouring_config *k, int i, uint64_t *s)
{
	struct interp_axis_loop *l = &k->loop[i];
	int ahead;

	*l = (struct interp_axis_loop) {
		.gain_1_s = uniform(s, 5, 300), .damping = uniform(s, 0.1, 3),
		.velocity_hz = uniform(s, 1, 300),
		.delay_s = rnd(s) % 2 ? uniform(s, 0, 5.9) * PERIOD_S : 0,
		.feedforward = rnd(s) % 2 ? uniform(s, -0.5, 1.5) : 0,
	};
	k->most_mm[i] = uniform(s, 1, 100) / l->gain_1_s;
	ahead = (int)floor(k->gains.lead_periods + l->delay_s / PERIOD_S) + 2;
	k->ahead = ahead > k->ahead ? ahead : k->ahead;
}

static inline void random_contouring(struct contouring_config *k, uint64_t *s)
{
	k->methods = (uint32_t)(rnd(s) % 4);
	k->axes = (uint32_t)(rnd(s) % 256);
	k->gains = (struct interp_compensate_gains) {
		.velocity = uniform(s, 0, 2), .acceleration = uniform(s, 0, 3),
		.lead_periods = uniform(s, 0, 1),
		.cross_1_s = rnd(s) % 2 ? uniform(s, 0, 1000) : 0,
	};
	for (int i = 0; i < INTERP_NAXES; i++) {
		k->pulse_mm[i] = PULSE_MM;
		random_loop(k, i, s);
	}
}

/* They lag by some periods; now and then a scale says anything at all. */
static inline void random_actual(struct random_drives *d, struct rig *r,
				 uint64_t *s)
{
	for (int i = 0; i < INTERP_NAXES; i++) {
		d->actual[i] += 0.05 * (r->out.target[i] - d->actual[i]);
		r->in.actual[i] = rnd(s) % 5000 ? (int32_t)d->actual[i] :
						  (int32_t)rnd(s);
	}
	r->in.plc.axes_c = rnd(s) % 200 ? r->c.plc.axes_c :
					  uniform(s, -10, 60);
}

/* -- What must hold ------------------------------------------------------- */

/* Longer than the slowest take-up waits for its next pulse. */
#define SETTLED	25

/* At rest a lead comes off: as fast as the feedforward of the drive heeds it;
 * where the points of the path are not known, by a sixteenth in a period. */
static inline int off_cycles(const struct contouring_config *k, int i)
{
	const struct interp_axis_loop *l = &k->loop[i];

	return 16 * (int)ceil(log(fmax(2 * k->most_mm[i] / PULSE_MM, 8))) +
	       (int)(12 * fmax(l->feedforward, 0) / (l->gain_1_s * PERIOD_S));
}

static inline void check_lead(const struct random_drives *d,
			      const struct rig *r, int i, int32_t added)
{
	const struct contouring_config *k = &r->c.config.contouring;
	const double mm = added * PULSE_MM;
	const double leap = k->most_mm[i] * k->loop[i].gain_1_s * PERIOD_S;
	const int32_t at = r->c.out.target[i];

	if (added == 0)
		return;
	assert_true(k->methods != 0 && k->axes >> i & 1);
	assert_true(r->c.state == STATE_TRAVEL || r->c.state == STATE_HOLD);
	assert_true(!r->in.axes_off || r->in.steers);
	assert_true(fabs(mm) <= k->most_mm[i] + PULSE_MM);
	/* What is sent stands at the end of the travel while the path moves. */
	assert_true(fabs(mm - d->added[i] * PULSE_MM) <=
		    leap + (abs(at - d->place[i]) + 2) * PULSE_MM);
	if (at >= r->c.config.travel_min[i] && at <= r->c.config.travel_max[i])
		assert_true(at + added >= r->c.config.travel_min[i] &&
			    at + added <= r->c.config.travel_max[i]);
	assert_true(d->stood < off_cycles(k, i));
}

/* What was added is gone before a cut, a touch or the end of a job; what loses
 * its axes or a fault has may drop it. */
static inline void check_dropped(const struct random_drives *d,
				 const struct rig *r, int i)
{
	const struct contouring_config *k = &r->c.config.contouring;
	const double leap = k->most_mm[i] * k->loop[i].gain_1_s * PERIOD_S;

	if (r->c.contouring.on || r->c.state == STATE_FAULT ||
	    r->was == STATE_FAULT || r->in.axes_off || !r->c.out.enable)
		return;
	assert_true(fabs(d->added[i] * PULSE_MM) <= leap + 2 * PULSE_MM);
}

static inline void check_cure(const struct random_drives *d,
			      const struct rig *r, int i, int32_t cured)
{
	const struct comp_config *k = &r->c.config.comp;
	const double pace = fmax(k->axis[i].take_up, 1);

	assert_true(abs(cured - d->cured[i]) <= pace);
	if (r->c.state == STATE_FAULT || r->in.busy)
		assert_int_equal(cured, d->cured[i]);
	if (!k->mapped && k->axis[i].backlash == 0)
		assert_int_equal(cured, 0);
}

/* Told to stand there, it truly stands at the place, to a pulse. */
static inline void check_true_place(const struct rig *r,
				    const int32_t cured[INTERP_NAXES])
{
	const struct comp_config *k = &r->c.config.comp;
	double told[INTERP_NAXES], error[INTERP_NAXES];

	for (int i = 0; i < INTERP_NAXES; i++) {
		const int32_t back = r->c.comp.axis[i].toward < 0 ?
				     k->axis[i].backlash : 0;

		told[i] = (r->c.out.target[i] + cured[i] + back) * PULSE_MM;
	}
	interp_errormap_error(&k->maps, told, error);
	for (int i = 0; i < INTERP_NAXES; i++)
		assert_near(told[i] + error[i], r->c.out.target[i] * PULSE_MM,
			    0.6 * PULSE_MM);
}

static inline void count_rest(struct random_drives *d, const struct rig *r)
{
	const bool stands = r->c.feed_mm_s == 0 &&
			    memcmp(d->place, r->c.out.target,
				   sizeof(d->place)) == 0;
	const bool frozen = r->c.state == STATE_FAULT || r->in.busy;

	d->stood = stands ? d->stood + 1 : 0;
	d->unfrozen = stands && !frozen ? d->unfrozen + 1 : 0;
}

/* How far an axis is on its way back to the path. */
static inline int32_t off_path(const struct rig *r, int i)
{
	const struct resync *s = &r->c.resync;

	return s->walks || s->is_off ? s->off[i] : 0;
}

/* After each period.  Return: it was looked at where it stands. */
static inline bool check_drives(struct random_drives *d, const struct rig *r)
{
	int32_t cured[INTERP_NAXES];

	if (d->begun)
		count_rest(d, r);
	for (int i = 0; i < INTERP_NAXES; i++) {
		const int32_t added = r->c.contouring.on ?
				      r->c.contouring.added[i] : 0;

		cured[i] = r->out.target[i] - added - off_path(r, i) -
			   r->c.out.target[i];
		check_lead(d, r, i, added);
		check_dropped(d, r, i);
		if (d->begun)
			check_cure(d, r, i, cured[i]);
		if (cured[i] != d->cured[i])
			d->unfrozen = 0;
		d->added[i] = added;
		d->cured[i] = cured[i];
	}
	memcpy(d->place, r->c.out.target, sizeof(d->place));
	d->begun = true;
	if (d->unfrozen < SETTLED || r->in.plc.present)
		return false;
	check_true_place(r, cured);
	return true;
}

#endif /* RANDOM_DRIVES_H */
