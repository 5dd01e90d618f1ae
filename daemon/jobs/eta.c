/* SPDX-License-Identifier: Apache-2.0 */
/* eta.c - how long the job in the machine will still take */
#include "eta.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>

/* So much of the forecast has the weight of what was cut: of the whole job, and
 * of a condition. */
#define JOB_PART	0.01
#define COND_PART	0.04
#define LATE_PART	0.1		/* of the job: what was cut before that,
					 * and the forecast, counts for less
					 * than half */
#define FACTOR_MAX	8.0
#define UNSURE		2.0		/* the forecast may be wrong by this */
#define LEARNT_UNSURE	1.25		/* ... if it was corrected before */
#define ROSE		1.1
#define WHOLE_PART	0.01		/* ... and by this of the whole job */

void eta_fini(struct eta *l)
{
	forecast_free(&l->forecast);
	free(l->cond);
	*l = (struct eta) { .n = 0 };
}

int eta_give(struct eta *l, struct forecast *of, uint32_t n)
{
	const struct forecast *f = &l->forecast;

	eta_fini(l);
	l->n = n;
	l->forecast = *of;
	*of = (struct forecast) { .nparts = 0 };
	l->least_s = INFINITY;
	if (!f->nparts)
		return 0;
	l->cond = calloc(f->nconds, sizeof(*l->cond));
	if (!l->cond) {
		eta_fini(l);
		l->n = n;
		return -ENOMEM;
	}
	for (uint32_t i = 0; i < f->nparts; i++)
		l->cond[f->part[i].cond].all_s += f->part[i].cut_s;
	return 0;
}

static double bounded(double factor)
{
	return fmin(fmax(factor, 1 / FACTOR_MAX), FACTOR_MAX);
}

void eta_learnt(struct eta *l, uint32_t cond, double factor)
{
	if (l->cond && factor > 0)
		l->cond[cond].learnt = bounded(factor);
}

static double learnt(const struct eta_cond *c)
{
	return c->learnt > 0 ? c->learnt : 1;
}

/* -- What was cut ---------------------------------------------------------- */

/* A gap that is deep behaves otherwise than one at the surface. */
static double forget(const struct eta *l, double expected_s)
{
	return l->forecast.cut_s > 0 ?
	       exp(-expected_s / (LATE_PART * l->forecast.cut_s)) : 1;
}

static void count(const struct eta *l, struct eta_cond *c, double expected_s,
		  double passed_s)
{
	const double keep = forget(l, expected_s);

	c->expected_s += expected_s;
	c->passed_s += passed_s;
	c->late_expected_s = c->late_expected_s * keep + expected_s;
	c->late_passed_s = c->late_passed_s * keep + passed_s;
}

/* Parts up to @to are done: what they have taken is shared out to their
 * conditions as the forecast has it. */
static void leave(struct eta *l, uint32_t to, double job_s)
{
	const struct forecast *f = &l->forecast;
	double cut_s = 0, other_s = 0, passed_s;

	for (uint32_t i = l->at; i < to; i++) {
		other_s += f->part[i].other_s;
		cut_s += f->part[i].cut_s * learnt(&l->cond[f->part[i].cond]);
	}
	passed_s = fmax(0, job_s - l->entered_s - other_s);
	for (uint32_t i = l->at; i < to && cut_s > 0; i++) {
		struct eta_cond *c = &l->cond[f->part[i].cond];

		count(l, c, f->part[i].cut_s, passed_s * f->part[i].cut_s *
		      learnt(c) / cut_s);
	}
	l->at = to;
	l->entered_s = job_s;
}

void eta_look(struct eta *l, double far_mm, double job_s)
{
	const struct forecast *f = &l->forecast;
	uint32_t to = l->at;

	if (!f->nparts)
		return;
	while (to + 1 < f->nparts && far_mm >= f->part[to].to_mm)
		to++;
	if (to > l->at)
		leave(l, to, job_s);
	l->job_s = job_s;
}

/* -- What that says of the parts to come ----------------------------------- */

/* Of the job as a whole: what its cutting takes of what it was expected to. */
struct sums {
	double passed_s, expected_s, all_s;
	double open_s;			/* of them in the present part */
	double factor;			/* for what was not cut yet */
};

/* The present part takes longer than it should. */
static double over_s(const struct eta *l, double part_s)
{
	return fmax(0, l->job_s - l->entered_s - part_s);
}

static struct sums sums_of(const struct eta *l)
{
	const struct forecast_part *p = &l->forecast.part[l->at];
	const double want_s = p->cut_s * learnt(&l->cond[p->cond]);
	struct sums s = { .open_s = over_s(l, want_s + p->other_s) };
	double weight_s, done_s = 0;

	if (!(p->cut_s > 0))
		s.open_s = 0;
	for (uint32_t i = 0; i < l->forecast.nconds; i++) {
		const struct eta_cond *c = &l->cond[i];

		s.passed_s += c->late_passed_s;
		s.expected_s += c->late_expected_s * learnt(c);
		s.all_s += c->all_s * learnt(c);
		done_s += c->expected_s;
	}
	if (s.open_s > 0) {
		s.passed_s += want_s + s.open_s;
		s.expected_s += want_s;
	}
	weight_s = JOB_PART * s.all_s * forget(l, done_s);
	s.factor = weight_s > 0 ? (s.passed_s + weight_s) /
				 (s.expected_s + weight_s) : 1;
	return s;
}

static double factor_of(const struct eta *l, const struct sums *s, uint32_t i)
{
	const struct forecast_part *p = &l->forecast.part[l->at];
	const struct eta_cond *c = &l->cond[i];
	const double weight_s = COND_PART * c->all_s * learnt(c) *
				forget(l, c->expected_s);
	double passed_s = c->late_passed_s;
	double expected_s = c->late_expected_s * learnt(c);

	if (p->cond == i && s->open_s > 0) {
		passed_s += p->cut_s * learnt(c) + s->open_s;
		expected_s += p->cut_s * learnt(c);
	}
	if (!(weight_s > 0))
		return learnt(c);
	return bounded(learnt(c) * (passed_s + weight_s * s->factor) /
		       (expected_s + weight_s));
}

/* The condition that makes the greatest difference to the forecast. */
static void name_cause(const struct eta *l, const struct sums *s,
		       struct eta_told *ret)
{
	double most = -1;

	for (uint32_t i = 0; i < l->forecast.nconds; i++) {
		const double factor = factor_of(l, s, i);
		const double by = l->cond[i].all_s * fabs(factor - 1);

		if (by > most) {
			most = by;
			ret->cond = i;
			ret->factor = factor;
		}
	}
}

static enum eta_by by_what(const struct eta *l, const struct sums *s)
{
	if (s->expected_s > 0)
		return ETA_CUT;
	for (uint32_t i = 0; i < l->forecast.nconds; i++)
		if (l->cond[i].learnt > 0 && l->cond[i].all_s > 0)
			return ETA_LEARNT;
	return ETA_FORECAST;
}

void eta_tell(const struct eta *l, struct eta_told *ret)
{
	const struct forecast *f = &l->forecast;
	double cut_s = 0, other_s = 0, part_s, weight_s, wide;
	struct sums s;

	*ret = (struct eta_told) { .left_s = -1, .min_s = -1, .max_s = -1 };
	if (!f->nparts)
		return;
	s = sums_of(l);
	for (uint32_t i = l->at; i < f->nparts; i++) {
		other_s += f->part[i].other_s;
		cut_s += f->part[i].cut_s * factor_of(l, &s, f->part[i].cond);
	}
	part_s = f->part[l->at].other_s + f->part[l->at].cut_s *
		 factor_of(l, &s, f->part[l->at].cond);
	part_s = fmin(part_s, l->job_s - l->entered_s);
	ret->by = by_what(l, &s);
	weight_s = JOB_PART * s.all_s;
	wide = pow(ret->by == ETA_LEARNT ? LEARNT_UNSURE : UNSURE,
		   weight_s > 0 ? weight_s / (weight_s + s.expected_s) : 0);
	ret->left_s = fmax(0, cut_s + other_s - part_s);
	ret->min_s = fmax(0, cut_s / wide + other_s - part_s);
	ret->max_s = fmax(0, cut_s * wide + other_s - part_s);
	name_cause(l, &s, ret);
}

bool eta_rose(struct eta *l, struct eta_told *ret)
{
	bool is_news;

	eta_tell(l, ret);
	if (ret->left_s < 0)
		return false;
	if (ret->left_s <= l->least_s * ROSE +
			   WHOLE_PART * (l->job_s + ret->left_s)) {
		l->least_s = fmin(l->least_s, ret->left_s);
		return false;
	}
	l->least_s = ret->left_s;
	is_news = !l->cond[ret->cond].told;
	l->cond[ret->cond].told = true;
	return is_news;
}

const char *eta_word(enum eta_by by)
{
	static const char *const words[] = {
		[ETA_NONE]	= "",
		[ETA_FORECAST]	= "forecast",
		[ETA_LEARNT]	= "learnt",
		[ETA_CUT]	= "cut",
	};

	return words[by];
}
