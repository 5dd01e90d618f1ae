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
#define SLOW_STEP	0.0625
#define PLAIN		10.0		/* it is so much likelier that the
					 * process differs than all else */
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

static void add(double to[], const double s[], double times)
{
	for (int i = 0; i < FORECAST_REMOVALS; i++)
		to[i] += s[i] * times;
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
		add(l->cond[f->part[i].cond].all_s, f->part[i].cut_s, 1);
	for (uint32_t i = 0; i < f->nconds; i++)
		add(l->cond[i].left_s, l->cond[i].all_s, 1);
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

static void count(const struct eta *l, const struct forecast_part *p,
		  double passed_s)
{
	struct eta_cond *c = &l->cond[p->cond];
	const double keep = forget(l, *p->cut_s);

	c->expected_s += *p->cut_s;
	c->passed_s += passed_s;
	add(c->late_s, c->late_s, keep - 1);
	add(c->late_s, p->cut_s, 1);
	add(c->left_s, p->cut_s, -1);
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
		cut_s += *f->part[i].cut_s * learnt(&l->cond[f->part[i].cond]);
	}
	passed_s = fmax(0, job_s - l->entered_s - other_s);
	for (uint32_t i = l->at; i < to && cut_s > 0; i++)
		count(l, &f->part[i], passed_s * *f->part[i].cut_s *
		      learnt(&l->cond[f->part[i].cond]) / cut_s);
	l->at = to;
	l->entered_s = job_s;
}

void eta_wait(struct eta *l, double job_s)
{
	/* What was before the first look is not known. */
	if (l->job_s > 0)
		l->waited_s = job_s - l->job_s;
}

void eta_look(struct eta *l, double far_mm, double job_s)
{
	const uint32_t to = forecast_part_at(&l->forecast, l->at, far_mm);

	if (!l->forecast.nparts)
		return;
	job_s = fmax(0, job_s - l->waited_s);
	if (to > l->at)
		leave(l, to, job_s);
	l->job_s = job_s;
}

/* -- What that says of the parts to come ----------------------------------- */

/* What was seen, what it was expected to take, and the weight of what is
 * believed without it. */
struct seen {
	double passed_s, expected_s[FORECAST_REMOVALS];
	double weight_s;
};

/* What is made of it: the process removes 2^-@slow of what was believed (-1 to
 * 1), and what comes takes @factor times as long as that makes it. */
struct belief {
	double slow, factor;
};

/* By the forecasts of half and twice. */
static double takes_s(const double s[], const struct belief *b)
{
	const double other_s = s[b->slow > 0 ? FORECAST_HALF : FORECAST_TWICE];

	if (!(*s > 0))
		return 0;
	return *s * pow(bounded(other_s / *s), fabs(b->slow)) * b->factor;
}

/* The most probable one: the process is near to what was believed @before, and
 * so is what else there may be, which is less likely to differ. */
static struct belief believe(const struct seen *s, const struct belief *before)
{
	const double known = *s->expected_s / (*s->expected_s + s->weight_s);
	struct belief best = *before, b = { .factor = before->factor };
	double least = INFINITY;

	if (!(s->passed_s > 0 && *s->expected_s > 0))
		return best;
	for (b.slow = -1; b.slow <= 1; b.slow += SLOW_STEP) {
		const double else_ = log2(s->passed_s /
					  takes_s(s->expected_s, &b));
		const double more = b.slow - before->slow;
		const double bad = more * more + PLAIN * known * else_ * else_;

		if (bad < least) {
			least = bad;
			best.slow = b.slow;
		}
	}
	b = (struct belief) { .slow = best.slow, .factor = 1 };
	best.factor = bounded((s->passed_s + s->weight_s * before->factor) /
			      (takes_s(s->expected_s, &b) + s->weight_s));
	return best;
}

/* The present part takes longer than it should. */
static void see_open(const struct eta *l, struct seen *s)
{
	const struct forecast_part *p = &l->forecast.part[l->at];
	const double known = learnt(&l->cond[p->cond]);
	const double want_s = *p->cut_s * known;
	const double over_s = l->job_s - l->entered_s - want_s - p->other_s;

	if (!(*p->cut_s > 0) || over_s <= 0)
		return;
	s->passed_s += want_s + over_s;
	add(s->expected_s, p->cut_s, known);
}

/* Of the job as a whole. */
static struct seen see_all(const struct eta *l)
{
	struct seen s = { .passed_s = 0 };
	double all_s = 0, done_s = 0;

	for (uint32_t i = 0; i < l->forecast.nconds; i++) {
		const struct eta_cond *c = &l->cond[i];

		s.passed_s += c->late_passed_s;
		add(s.expected_s, c->late_s, learnt(c));
		all_s += *c->all_s * learnt(c);
		done_s += c->expected_s;
	}
	see_open(l, &s);
	s.weight_s = JOB_PART * all_s * forget(l, done_s);
	return s;
}

static struct belief of_cond(const struct eta *l, const struct belief *all,
			     uint32_t i)
{
	const struct eta_cond *c = &l->cond[i];
	struct seen s = {
		.passed_s = c->late_passed_s,
		.weight_s = COND_PART * *c->all_s * learnt(c) *
			    forget(l, c->expected_s),
	};
	struct belief b;

	add(s.expected_s, c->late_s, learnt(c));
	if (l->forecast.part[l->at].cond == i)
		see_open(l, &s);
	b = believe(&s, all);
	b.factor *= learnt(c);
	return b;
}

/* The condition that makes the greatest difference to the forecast. */
static void name_cause(const struct eta_cond *c, const struct belief *b,
		       uint32_t i, struct eta_told *ret)
{
	const double takes = takes_s(c->all_s, b);

	if (fabs(takes - *c->all_s) <= ret->by_s)
		return;
	ret->by_s = fabs(takes - *c->all_s);
	ret->cond = i;
	ret->factor = takes / *c->all_s;
}

static enum eta_by by_what(const struct eta *l, const struct seen *s)
{
	if (*s->expected_s > 0)
		return ETA_CUT;
	for (uint32_t i = 0; i < l->forecast.nconds; i++)
		if (l->cond[i].learnt > 0 && *l->cond[i].all_s > 0)
			return ETA_LEARNT;
	return ETA_FORECAST;
}

/* Return: what is to be cut from the begin of the present part on; and of it,
 * @part_s. */
static double cut_s(const struct eta *l, const struct seen *s,
		    double *part_s, struct eta_told *ret)
{
	const struct forecast_part *p = &l->forecast.part[l->at];
	const struct belief all = believe(s, &(struct belief) { .factor = 1 });
	double sum_s = 0;

	for (uint32_t i = 0; i < l->forecast.nconds; i++) {
		const struct belief b = of_cond(l, &all, i);

		sum_s += takes_s(l->cond[i].left_s, &b);
		if (i == p->cond)
			*part_s = takes_s(p->cut_s, &b);
		name_cause(&l->cond[i], &b, i, ret);
	}
	return sum_s;
}

void eta_tell(const struct eta *l, struct eta_told *ret)
{
	const struct forecast *f = &l->forecast;
	double cut, other_s = 0, part_s = 0, wide;
	struct seen s;

	*ret = (struct eta_told) { .left_s = -1, .min_s = -1, .max_s = -1,
				   .factor = 1 };
	if (!f->nparts)
		return;
	s = see_all(l);
	for (uint32_t i = l->at; i < f->nparts; i++)
		other_s += f->part[i].other_s;
	cut = cut_s(l, &s, &part_s, ret);
	other_s -= fmin(part_s + f->part[l->at].other_s,
			l->job_s - l->entered_s);
	ret->by = by_what(l, &s);
	wide = pow(ret->by == ETA_LEARNT ? LEARNT_UNSURE : UNSURE,
		   s.weight_s > 0 ? s.weight_s / (s.weight_s + *s.expected_s) :
		   0);
	ret->left_s = fmax(0, cut + other_s);
	ret->min_s = fmax(0, cut / wide + other_s);
	ret->max_s = fmax(0, cut * wide + other_s);
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
