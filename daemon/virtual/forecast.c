/* SPDX-License-Identifier: Apache-2.0 */
/* forecast.c - how long a job will take, and to each place of its path */
#include "forecast.h"
#include "virtual.h"

#include "interp/cursor.h"
#include "interp/tech_table.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LOOK_CYCLES	4096		/* between two looks at `ends` */
#define STEP_S		0.01		/* of a part, at first */

static const double removes[] = {
	[FORECAST_ALL] = 1, [FORECAST_HALF] = 0.5, [FORECAST_TWICE] = 2,
};

struct run {
	struct virtual v;
	struct machine_config config;
	struct forecast *to;
	enum forecast_removal of;
	const atomic_bool *ends;
	double period_s, step_s;
	struct forecast_part now;	/* the part that is being measured */
	struct cycle_totals counted;	/* of the job */
	uint32_t at;			/* in this part, if they are known */
	double far_mm;
	double most_s, stuck_s;
	char why_not[sizeof(((struct forecast *)0)->why_not)];
};

static void put_together(struct run *r)
{
	struct forecast *f = r->to;
	uint32_t n = 0;

	for (uint32_t i = 0; i + 1 < f->nparts; i += 2) {
		const struct forecast_part *a = &f->part[i];
		const struct forecast_part *b = &f->part[i + 1];

		f->part[n++] = (struct forecast_part) {
			.to_mm = b->to_mm, .cut_s = { *a->cut_s + *b->cut_s },
			.moved_s = a->moved_s + b->moved_s,
			.other_s = a->other_s + b->other_s,
			.cond = *a->cut_s > *b->cut_s ? a->cond : b->cond,
		};
	}
	f->nparts = n;
	r->step_s *= 2;
}

static void end_part(struct run *r, double at_mm)
{
	struct forecast *f = r->to;

	r->now.to_mm = at_mm;
	f->cut_s += *r->now.cut_s;
	f->moved_s += r->now.moved_s;
	f->other_s += r->now.other_s;
	f->part[f->nparts++] = r->now;
	r->now = (struct forecast_part) { .cond = r->now.cond };
	if (f->nparts == FORECAST_PARTS)
		put_together(r);
}

/* A part ends where the path goes on, so that the time for which it stands at a
 * place belongs to one part; it has one kind of time, if it is not short. */
static void divide(struct run *r, double *to, double s)
{
	const struct cycle *c = &r->v.cycle;
	struct forecast_part *p = &r->now;
	const bool cut = to == p->cut_s;
	const bool other = !(*to > 0) || (cut && c->cursor.seg.cond != p->cond);

	if (c->far_mm > r->far_mm && *p->cut_s + p->moved_s + p->other_s >=
				     (other ? r->step_s / 8 : r->step_s))
		end_part(r, r->far_mm);
	r->far_mm = fmax(r->far_mm, c->far_mm);
	*to += s;
	if (cut)
		p->cond = c->cursor.seg.cond;
}

static void measure(struct run *r)
{
	const struct cycle_totals *t = &r->v.cycle.totals;
	const struct cycle_totals was = r->counted;
	const bool cut = t->cut_cycles > was.cut_cycles;

	r->counted = *t;
	if (r->of != FORECAST_ALL) {
		r->at = forecast_part_at(r->to, r->at, r->v.cycle.far_mm);
		if (cut)
			r->to->part[r->at].cut_s[r->of] += r->period_s;
	} else if (cut) {
		divide(r, r->now.cut_s, r->period_s);
	} else if (t->moved_cycles > was.moved_cycles) {
		divide(r, &r->now.moved_s, r->period_s);
	} else if (t->other_cycles > was.other_cycles) {
		divide(r, &r->now.other_s, r->period_s);
	}
}

static void say_why_not(struct run *r, const char *what)
{
	snprintf(r->why_not, sizeof(r->why_not), "%s", what);
}

/* A dwell, and what ends by time, say themselves how long they stand. */
static bool is_stuck(struct run *r, double was_mm)
{
	const struct cycle *c = &r->v.cycle;

	r->stuck_s = c->far_mm > was_mm || c->job.dwelling || c->timed.end ? 0 :
		     r->stuck_s + r->period_s;
	if (r->stuck_s <= FORECAST_STUCK_S)
		return false;
	snprintf(r->why_not, sizeof(r->why_not), "it does not get on behind "
		 "%.3f mm, in line %u, for %.0f min", c->far_mm,
		 c->cursor.seg.line, FORECAST_STUCK_S / 60);
	return true;
}

/* Return: 1: it goes on; 0: there is a reason; -errno. */
static int may_go_on(const struct run *r, uint64_t n)
{
	if (n % LOOK_CYCLES == 0 && atomic_load(r->ends))
		return -ECANCELED;
	if ((double)n * r->period_s <= r->most_s)
		return 1;
	return r->most_s < FORECAST_S_MAX ? -ETIME : 0;
}

static int go(struct run *r)
{
	const struct cycle *c = &r->v.cycle;

	for (uint64_t n = 1; !virtual_is_over(&r->v); n++) {
		const double was_mm = c->far_mm;
		const int on = may_go_on(r, n);

		if (on == 0)
			say_why_not(r, "it takes longer than 277 hours");
		if (on <= 0)
			return on;
		if (virtual_stands(&r->v))
			virtual_go_on(&r->v);
		virtual_step(&r->v);
		measure(r);
		if (is_stuck(r, was_mm))
			return 0;
	}
	if (c->state == STATE_FAULT)
		say_why_not(r, fault_name(c->fault.first));
	return 0;
}

static void suppose(struct forecast *f, enum forecast_removal of)
{
	for (uint32_t i = 0; i < f->nparts; i++)
		f->part[i].cut_s[of] = *f->part[i].cut_s / removes[of];
}

static int begin(struct forecast *f, const struct interp_program *p)
{
	f->nconds = p->head->nconds;
	f->part = calloc(FORECAST_PARTS, sizeof(*f->part));
	f->cond = calloc(f->nconds + 1, sizeof(*f->cond));
	if (!f->part || !f->cond)
		return -ENOMEM;
	for (uint32_t i = 0; i < f->nconds; i++)
		if (p->conds[i].letter)
			interp_tech_name(p->conds[i].letter,
					 p->conds[i].number, f->cond[i],
					 sizeof(f->cond[i]));
	snprintf(f->cond[f->nconds], sizeof(*f->cond), "positioning");
	return 0;
}

/* @r has `to`, `of`, `ends` and `most_s`. */
static int run(struct run *r, const struct machine_config *c,
	       const struct interp_program *p)
{
	int err;

	r->config = *c;
	r->config.sim.removal_mm3_min *= removes[r->of];
	r->period_s = (double)config_period_ns(c) * 1e-9;
	r->step_s = STEP_S;
	err = virtual_open(&r->v, &(struct virtual_options) {
		.config = &r->config, .program = p,
		.seed = (uint64_t)c->sim.seed,
	});
	if (err == 0)
		err = go(r);
	virtual_close(&r->v);
	return err;
}

int forecast_make(struct forecast *ret, const struct machine_config *c,
		  const struct interp_program *p, double most_s,
		  const atomic_bool *ends)
{
	struct run *r = calloc(1, sizeof(*r));
	int err;

	*ret = (struct forecast) { .nparts = 0 };
	if (!r)
		return -ENOMEM;
	r->to = ret;
	r->ends = ends;
	r->most_s = fmin(most_s, FORECAST_S_MAX);
	err = begin(ret, p);
	if (err == 0)
		err = run(r, c, p);
	if (err == 0)
		end_part(r, INFINITY);
	memcpy(ret->why_not, r->why_not, sizeof(ret->why_not));
	free(r);
	if (err)
		forecast_free(ret);
	else if (*ret->why_not)
		ret->nparts = 0;
	else
		suppose(ret, FORECAST_HALF), suppose(ret, FORECAST_TWICE);
	return err;
}

int forecast_vary(struct forecast *f, const struct machine_config *c,
		  const struct interp_program *p, const atomic_bool *ends)
{
	struct run *r = calloc(1, sizeof(*r));
	int err = r ? 0 : -ENOMEM;

	for (enum forecast_removal of = FORECAST_HALF; f->nparts && !err &&
	     of < FORECAST_REMOVALS; of++) {
		memset(r, 0, sizeof(*r));
		r->to = f;
		r->of = of;
		r->ends = ends;
		r->most_s = FORECAST_S_MAX;
		for (uint32_t i = 0; i < f->nparts; i++)
			f->part[i].cut_s[of] = 0;
		err = run(r, c, p);
		if (err || *r->why_not)
			suppose(f, of);
	}
	free(r);
	return err;
}

uint32_t forecast_part_at(const struct forecast *f, uint32_t at, double far_mm)
{
	while (at + 1 < f->nparts && far_mm > f->part[at].to_mm)
		at++;
	return at;
}

void forecast_free(struct forecast *f)
{
	free(f->part);
	free(f->cond);
	*f = (struct forecast) { .nparts = 0 };
}
