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

/* Positioning, whatever is removed. */
struct moved {
	double s[FORECAST_REMOVALS];
};

static struct moved moved(const struct forecast_part *p)
{
	return (struct moved) { { p->moved_s, p->moved_s, p->moved_s } };
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
	l->cond = calloc(f->nconds + 1, sizeof(*l->cond));
	if (!l->cond) {
		eta_fini(l);
		l->n = n;
		return -ENOMEM;
	}
	for (uint32_t i = 0; i < f->nparts; i++) {
		const struct forecast_part *p = &f->part[i];

		add(l->cond[p->cond].all_s, p->cut_s, 1);
		add(l->cond[f->nconds].all_s, moved(p).s, 1);
	}
	for (uint32_t i = 0; i <= f->nconds; i++)
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

/* A gap that is deep behaves otherwise than one at the surface; and an override
 * may be another one now. */
static double forget(const struct eta *l, uint32_t cond, double expected_s)
{
	const double all_s = cond == l->forecast.nconds ? l->forecast.moved_s :
							  l->forecast.cut_s;

	return all_s > 0 ? exp(-expected_s / (LATE_PART * all_s)) : 1;
}

static void count(struct eta *l, uint32_t cond, const double expected_s[],
		  double passed_s)
{
	struct eta_cond *c = &l->cond[cond];
	const double keep = forget(l, cond, *expected_s);

	c->expected_s += *expected_s;
	c->passed_s += passed_s;
	add(c->late_s, c->late_s, keep - 1);
	add(c->late_s, expected_s, 1);
	add(c->left_s, expected_s, -1);
	c->late_passed_s = c->late_passed_s * keep + passed_s;
}

static struct eta_spent in_part(const struct eta *l)
{
	return (struct eta_spent) {
		.cut_s = l->now.cut_s - l->entered.cut_s,
		.moved_s = l->now.moved_s - l->entered.moved_s,
		.other_s = l->now.other_s - l->entered.other_s,
	};
}

/* Parts up to @to are done: what they have taken is shared out to them as the
 * forecast has it. */
static void leave(struct eta *l, uint32_t to)
{
	const struct forecast *f = &l->forecast;
	const struct eta_spent took = in_part(l);
	double cut_s = 0, moved_s = 0;

	for (uint32_t i = l->at; i < to; i++) {
		cut_s += *f->part[i].cut_s * learnt(&l->cond[f->part[i].cond]);
		moved_s += f->part[i].moved_s;
	}
	for (uint32_t i = l->at; i < to; i++) {
		const struct forecast_part *p = &f->part[i];

		if (cut_s > 0)
			count(l, p->cond, p->cut_s, took.cut_s * *p->cut_s *
			      learnt(&l->cond[p->cond]) / cut_s);
		if (moved_s > 0)
			count(l, f->nconds, moved(p).s,
			      took.moved_s * p->moved_s / moved_s);
	}
	l->at = to;
	l->entered = l->now;
}

void eta_look(struct eta *l, double far_mm, const struct eta_spent *spent)
{
	const uint32_t to = forecast_part_at(&l->forecast, l->at, far_mm);

	if (!l->forecast.nparts)
		return;
	l->now = *spent;
	if (to > l->at)
		leave(l, to);
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
	best.factor = (s->passed_s + s->weight_s * before->factor) /
		      (takes_s(s->expected_s, &b) + s->weight_s);
	return best;
}

/* The present part takes longer than it should. */
static void see_open(struct seen *s, const double expected_s[], double known,
		     double passed_s)
{
	if (!(*expected_s > 0) || passed_s <= *expected_s * known)
		return;
	s->passed_s += passed_s;
	add(s->expected_s, expected_s, known);
}

/* Of the job as a whole. */
static struct seen see_all(const struct eta *l)
{
	const struct forecast_part *p = &l->forecast.part[l->at];
	struct seen s = { .passed_s = 0 };
	double all_s = 0, done_s = 0;

	for (uint32_t i = 0; i < l->forecast.nconds; i++) {
		const struct eta_cond *c = &l->cond[i];

		s.passed_s += c->late_passed_s;
		add(s.expected_s, c->late_s, learnt(c));
		all_s += *c->all_s * learnt(c);
		done_s += c->expected_s;
	}
	see_open(&s, p->cut_s, learnt(&l->cond[p->cond]), in_part(l).cut_s);
	s.weight_s = JOB_PART * all_s * forget(l, 0, done_s);
	return s;
}

static struct belief of_cond(const struct eta *l, const struct belief *all,
			     uint32_t i)
{
	const struct forecast_part *p = &l->forecast.part[l->at];
	const struct eta_cond *c = &l->cond[i];
	struct seen s = {
		.passed_s = c->late_passed_s,
		.weight_s = COND_PART * *c->all_s * learnt(c) *
			    forget(l, i, c->expected_s),
	};
	struct belief b;

	add(s.expected_s, c->late_s, learnt(c));
	if (i == l->forecast.nconds)
		see_open(&s, moved(p).s, 1, in_part(l).moved_s);
	else if (i == p->cond)
		see_open(&s, p->cut_s, learnt(c), in_part(l).cut_s);
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

/* What is left of what @i is of, where @expected_s and @passed_s are those of
 * the present part. */
static double left_s(const struct eta *l, uint32_t i, const struct belief *b,
		     const double expected_s[], double passed_s)
{
	return takes_s(l->cond[i].left_s, b) -
	       fmin(takes_s(expected_s, b), passed_s);
}

static double cut_s(const struct eta *l, const struct seen *s,
		    struct eta_told *ret)
{
	const struct forecast_part *p = &l->forecast.part[l->at];
	const struct belief all = believe(s, &(struct belief) { .factor = 1 });
	double sum_s = 0;

	for (uint32_t i = 0; i < l->forecast.nconds; i++) {
		const struct belief b = of_cond(l, &all, i);

		sum_s += i == p->cond ?
			 left_s(l, i, &b, p->cut_s, in_part(l).cut_s) :
			 takes_s(l->cond[i].left_s, &b);
		name_cause(&l->cond[i], &b, i, ret);
	}
	return sum_s;
}

/* What is not cut. */
static double rest_s(const struct eta *l, struct eta_told *ret)
{
	const struct forecast *f = &l->forecast;
	const struct forecast_part *p = &f->part[l->at];
	const struct belief b = of_cond(l, &(struct belief) { .factor = 1 },
					f->nconds);
	double s = left_s(l, f->nconds, &b, moved(p).s, in_part(l).moved_s);

	name_cause(&l->cond[f->nconds], &b, f->nconds, ret);
	for (uint32_t i = l->at; i < f->nparts; i++)
		s += f->part[i].other_s;
	return s - fmin(p->other_s, in_part(l).other_s);
}

void eta_tell(const struct eta *l, struct eta_told *ret)
{
	double cut, rest, wide;
	struct seen s;

	*ret = (struct eta_told) { .left_s = -1, .min_s = -1, .max_s = -1,
				   .factor = 1 };
	if (!l->forecast.nparts)
		return;
	s = see_all(l);
	cut = cut_s(l, &s, ret);
	rest = rest_s(l, ret);
	ret->by = by_what(l, &s);
	wide = pow(ret->by == ETA_LEARNT ? LEARNT_UNSURE : UNSURE,
		   s.weight_s > 0 ? s.weight_s / (s.weight_s + *s.expected_s) :
		   0);
	ret->left_s = fmax(0, cut + rest);
	ret->min_s = fmax(0, cut / wide + rest);
	ret->max_s = fmax(0, cut * wide + rest);
}

double eta_passed_s(const struct eta *l)
{
	return l->now.cut_s + l->now.moved_s + l->now.other_s;
}

bool eta_rose(struct eta *l, struct eta_told *ret)
{
	bool is_news;

	eta_tell(l, ret);
	if (ret->left_s < 0)
		return false;
	if (ret->left_s <= l->least_s * ROSE +
			   WHOLE_PART * (eta_passed_s(l) + ret->left_s)) {
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
