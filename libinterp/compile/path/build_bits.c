/* SPDX-License-Identifier: Apache-2.0 */
/* build_bits.c - lines whose changes of axis are planned and stored */
#include "path/build_bits.h"
#include "pulse/couple.h"
#include "pulse/greedy.h"
#include "pulse/strategy.h"

#include <errno.h>
#include <stdlib.h>

struct plan {
	struct interp_pair pair[INTERP_NAXES];
	uint32_t npairs;
	struct pair_tube tube;
};

/* The pairs as the cursor will have them; false: there are none. */
static bool plan_pairs(struct plan *p, const struct interp_build_options *o,
		       const struct build_way *w)
{
	const struct couple_rule rule = build_rule_of(o, w);
	struct couple_input in[INTERP_NAXES];
	const uint32_t n = build_rule_inputs(w, in);

	if (n < 2)
		return false;
	p->npairs = n - 1;
	p->tube = couple_tube(&rule, p->npairs);
	if (n == 2 || rule.coupling == INTERP_TREE) {
		couple_tree(p->pair, in, n);
		couple_set(p->pair, p->npairs, &rule, false);
		return true;
	}
	couple_star(p->pair, in, n);
	couple_set_star(p->pair, p->npairs, &rule, false);
	return true;
}

static struct greedy_line line_of(const struct plan *p, uint32_t i)
{
	const struct interp_pair *q = &p->pair[i];

	return (struct greedy_line) {
		.a = q->a, .b = q->b,
		.half_width = pair_half_width(q->a, q->b, p->tube),
	};
}

static bool worth_it(const struct plan *p)
{
	int64_t bursts = 0, fewest = 0;

	for (uint32_t i = 0; i < p->npairs; i++) {
		const struct greedy_line l = line_of(p, i);
		struct greedy_runs r = { .run = NULL };

		greedy_plan(&l, &r);
		fewest += (int64_t)r.n - 1;
		bursts += pair_burst_changes(&p->pair[i]);
	}
	return 100 * bursts > BUILD_BITS_ENOUGH * fewest;
}

static size_t words_of(const struct plan *p)
{
	size_t words = 0;

	for (uint32_t i = 0; i < p->npairs; i++)
		words += pair_words(&p->pair[i]);
	return words;
}

static void bits_set(uint64_t *bits, uint64_t at, uint64_t n)
{
	for (uint64_t k = at; k < at + n; k++)
		bits[k / 64] |= UINT64_C(1) << k % 64;
}

/* Return: 0 or -ENOMEM. */
static int bits_write(const struct greedy_line *l, uint64_t *bits)
{
	struct greedy_runs r = { .run = NULL };
	uint64_t at = 0;

	greedy_plan(l, &r);
	r.room = r.n;
	r.run = calloc(r.room, sizeof(*r.run));
	if (!r.run)
		return -ENOMEM;
	greedy_plan(l, &r);
	for (size_t i = 0; i < r.n; at += r.run[i++]) {
		if (r.main_first == (i % 2 == 1))
			bits_set(bits, at, r.run[i]);
	}
	free(r.run);
	pulse_string_count(bits, at);
	return 0;
}

/* Add @n words of 0 at the end of the table.  Return: them, or NULL. */
static uint64_t *words_add(struct table *t, size_t n)
{
	const size_t from = t->n;

	while (n-- > 0) {
		uint64_t *w = build_table_add(t);

		if (!w)
			return NULL;
		*w = 0;
	}
	return (uint64_t *)t->at + from;
}

static int plan_add(struct interp_build *b, const struct plan *p,
		    uint32_t *ret_arg)
{
	const size_t at = b->bits.n, words = words_of(p);
	uint64_t *bits;
	int err = 0;

	if (at + words >= UINT32_MAX)
		return 0;
	bits = words_add(&b->bits, words);
	if (!bits)
		return -ENOMEM;
	for (uint32_t i = 0; i < p->npairs && err == 0; i++) {
		const struct greedy_line l = line_of(p, i);

		err = bits_write(&l, bits);
		bits += pair_words(&p->pair[i]);
	}
	*ret_arg = (uint32_t)at + 1;
	return err;
}

int build_bits_add(struct interp_build *b, const struct build_way *w,
		   uint32_t ticks, uint32_t *ret_arg, struct interp_diag *diag)
{
	struct plan p;
	int err;

	*ret_arg = 0;
	if (!pulse_strategy(b->o.strategy)->runs || !plan_pairs(&p, &b->o, w))
		return 0;
	/* To find that bursts are as good takes as long. */
	err = build_walk(b, ticks, diag);
	return err < 0 || b->again.counts || !worth_it(&p) ?
		       err : plan_add(b, &p, ret_arg);
}
