/* SPDX-License-Identifier: Apache-2.0 */
/* greedy.c - the fewest changes of axis that a line in a tube can have */
#include "pulse/greedy.h"
#include "interp/smaller.h"

#include <stdlib.h>

/* How many pulses @main may give in a row from (m, s). */
static int64_t reach(const struct greedy_line *l, bool main, int64_t m,
		     int64_t s)
{
	const int64_t e = l->b * m - l->a * s;

	if (!main)
		return fewer(l->b - s, (l->half_width + e) / l->a);
	return l->b == 0 ? l->a - m :
	       fewer(l->a - m, (l->half_width - e) / l->b);
}

/* If neither may pulse: which axis goes less far astray?  An axis at its end
 * gives no pulse. */
static bool lesser_evil(const struct greedy_line *l, int64_t m, int64_t s)
{
	const int64_t e = l->b * m - l->a * s;

	if (m == l->a || s == l->b)
		return s == l->b;
	return llabs(e + l->b) <= llabs(e - l->a);
}

static void run_add(struct greedy_runs *r, bool main, int64_t pulses)
{
	const bool same = r->n > 0 &&
			  (r->n % 2 == 1) == (main == r->main_first);

	if (r->n == 0)
		r->main_first = main;
	if (!same)
		r->n++;
	if (r->n > r->room)
		return;
	if (!same)
		r->run[r->n - 1] = 0;
	r->run[r->n - 1] += (uint32_t)pulses;
}

/* The path that begins on the given axis. */
static void greedy_plan_from(const struct greedy_line *l, bool main_first,
			     struct greedy_runs *r)
{
	int64_t m = 0, s = 0;
	bool main = main_first;

	r->n = 0;
	while (m < l->a || s < l->b) {
		int64_t n = reach(l, main, m, s);

		if (n <= 0) {
			main = !main;
			n = reach(l, main, m, s);
		}
		if (n <= 0) {
			main = lesser_evil(l, m, s);
			n = 1;
		}
		run_add(r, main, n);
		m += main ? n : 0;
		s += main ? 0 : n;
	}
}

void greedy_plan(const struct greedy_line *l, struct greedy_runs *r)
{
	struct greedy_runs second = { .run = NULL };

	greedy_plan_from(l, false, &second);
	greedy_plan_from(l, true, r);
	if (second.n < r->n)
		greedy_plan_from(l, false, r);
}
