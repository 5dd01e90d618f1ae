/* SPDX-License-Identifier: Apache-2.0 */
/*
 * build_count.c - a text that asks for more walking than is allowed is refused
 * before all of that is done
 *
 * 5 * 10^8 points take a minute and more.  So, when a part of them has been
 * walked, the text is read once more, into a builder that only counts: of each
 * arc and curve no more than it certainly has, from its length.  Reading it
 * takes less than a microsecond a line.
 */
#include "path/build_bits.h"
#include "path/build_curve.h"
#include "path/build_rule.h"
#include "path/builder.h"
#include "interp/smaller.h"
#include "pulse/strategy.h"

#include <errno.h>
#include <math.h>
#include <string.h>

/* So many looks along a span of a curve: no way is shorter than its chords. */
#define LOOKS		8

/* Of what is allowed, before the rest is counted. */
#define WALKED_PART	50

/* One that is too long for a segment is refused where it is built. */
static int count_planned(struct interp_build *b, const int64_t *to,
			 struct build_measure *m, struct interp_diag *diag)
{
	const struct build_way way = build_way_to(b, to, m);
	const uint64_t ticks = build_rule_pulses(&way);
	uint32_t arg;

	return ticks > INTERP_PULSES_MAX ? 0 :
	       build_bits_add(b, &way, (uint32_t)ticks, &arg, diag);
}

int build_count_line(struct interp_build *b, const double end_mm[INTERP_NAXES],
		     const struct interp_build_word *w,
		     struct interp_diag *diag)
{
	int64_t to[INTERP_NAXES];
	struct build_measure m;
	int err;

	/* From there on places are not known: these few are built. */
	if (w->ends)
		return build_line(b, end_mm, w, diag);
	err = build_measure(b, end_mm, to, &m, diag);
	if (err < 0)
		return err;
	if (m.moved && pulse_strategy(b->o.strategy)->runs)
		err = count_planned(b, to, &m, diag);
	if (m.moved)
		build_descend(b, m.moved, end_mm);
	build_stand_at(b, end_mm, to);
	return err;
}

/* The longest way of an axis between two places, pulses. */
static double pulses(const struct interp_build *b,
		     const struct interp_build_curve *c, const double *from,
		     const double *to)
{
	double most = 0;

	for (uint32_t k = 0; k < c->nurbs.naxes; k++)
		most = larger(most, fabs(to[k] - from[k]) *
				    b->sub_mm[c->axis[k]]);
	return most / INTERP_SUB;
}

static double chords(const struct interp_build *b,
		     const struct interp_build_curve *c,
		     struct interp_nurbs_point *at)
{
	const double end = interp_nurbs_last(&c->nurbs);
	double u = interp_nurbs_first(&c->nurbs), sum = 0;
	struct interp_nurbs_eval e;

	interp_nurbs_open(&e, &c->nurbs);
	interp_nurbs_at(&e, u, 0, at);
	while (u < end) {
		const double from = u, to = e.to;

		for (int i = 1; i <= LOOKS; i++) {
			const struct interp_nurbs_point was = *at;

			u = i < LOOKS ? from + (to - from) * i / LOOKS : to;
			interp_nurbs_at(&e, u, 0, at);
			sum += pulses(b, c, was.d[0], at->d[0]);
		}
	}
	return sum;
}

int build_count_curve(struct interp_build *b,
		      const struct interp_build_curve *c,
		      struct interp_diag *diag)
{
	struct interp_nurbs_point at;
	double end_mm[INTERP_NAXES];
	int64_t to[INTERP_NAXES];
	const int err = build_walk(b, floor(chords(b, c, &at)), diag);

	memcpy(end_mm, b->here_mm, sizeof(end_mm));
	for (uint32_t k = 0; k < c->nurbs.naxes; k++)
		end_mm[c->axis[k]] = at.d[0][k];
	for (int i = 0; i < INTERP_NAXES; i++)
		to[i] = llround(end_mm[i] * b->sub_mm[i]);
	build_stand_at(b, end_mm, to);
	return err;
}

/* -- The text once more --------------------------------------------------- */

void interp_build_again(struct interp_build *b, interp_build_again_fn *read,
			void *arg)
{
	b->again = (struct build_again) { .read = read, .arg = arg };
}

int interp_build_refused(const struct interp_build *b, struct interp_diag *diag)
{
	if (!b->again.refused)
		return 0;
	*diag = b->again.diag;
	return -EINVAL;
}

int build_count_rest(struct interp_build *b)
{
	struct build_again *k = &b->again;
	struct interp_build_options o = b->o;
	interp_build_again_fn *read = k->read;
	struct interp_build *counter;

	/* Lines that become curves may be lines as well. */
	if (!read || b->o.fit_mm > 0 ||
	    b->walked < b->o.walked_max / WALKED_PART)
		return 0;
	k->read = NULL;
	o.from = NULL;
	o.memory = NULL;
	o.begins_inside = false;
	/* Lines take the way of those that may be held back. */
	o.fit_mm = INFINITY;
	counter = interp_build_create(&o);
	if (!counter)
		return -ENOMEM;
	counter->again.counts = true;
	k->refused = read(k->arg, counter, &k->diag) < 0 &&
		     counter->again.refused;
	interp_build_destroy(counter);
	return k->refused ? -E2BIG : 0;
}
