/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_generator_late.c - a generator on CAN that has all of it later, in the
 * order of the frames, and that is switched off and on
 */
#include "generator_frames.h"
#include "seed.h"
#include "walk_help.h"

#define LATE_MOST	15		/* periods; settle_ms is 20 */
#define WAYS_MOST	64
#define OWN		0xff		/* low byte of one that is not given */

struct set {
	uint8_t tenths;			/* A */
	bool negative;
};

struct late {
	uint64_t seed, sparks, changes, restarts;
	struct set has, way[WAYS_MOST];
	int due[WAYS_MOST], n, now;	/* in the order of the frames */
	int late;			/* periods; it changes now and then */
	int hurt;			/* periods since it has lost all, until
					 * it has what it is asked */
};

static void late_take(struct late *g, const struct can_frame *f)
{
	const int last = g->n ? g->due[g->n - 1] : 0;
	const int due = g->now + g->late;

	assert_true(g->n < WAYS_MOST);
	g->due[g->n] = due > last ? due : last;
	g->way[g->n++] = (struct set) { f->data[2], f->data[0] >> 2 & 1 };
}

static void late_turn(struct late *g)
{
	int n = 0;

	g->now++;
	if (rnd(&g->seed) % 50 == 0)
		g->late = (int)(rnd(&g->seed) % LATE_MOST);
	if (rnd(&g->seed) % 2000 == 0) {
		g->has = (struct set) { OWN, false };
		g->n = 0;
		g->hurt = 1;
		g->restarts++;
	}
	while (n < g->n && g->due[n] <= g->now)
		g->has = g->way[n++];
	g->n -= n;
	memmove(g->way, g->way + n, (size_t)g->n * sizeof(g->way[0]));
	memmove(g->due, g->due + n, (size_t)g->n * sizeof(g->due[0]));
}

/* It tells half amperes: some of these it tells alike.  NAN: its own. */
static double any_peak(uint64_t *seed)
{
	static const double peak[] = { 6, 6.2, 9, 12, 12.1, (double)NAN };

	return peak[rnd(seed) % 6];
}

/* As the cycle does: nothing is asked but in the dark, and nothing sparks but
 * with what is in force. */
static void cycle_turn(struct rig *r, struct late *g)
{
	const struct io_generator *says = &r->in.generator;

	if (says->trouble || rnd(&g->seed) % 40 == 0) {
		r->out.power = false;
		r->out.reset = says->trouble && rnd(&g->seed) % 8 == 0;
	} else if (!r->out.power && rnd(&g->seed) % 6 == 0) {
		ask(r, any_peak(&g->seed));
		r->out.pulse[INTERP_TECH_POLARITY] = rnd(&g->seed) % 2 ? -1 : 1;
		g->changes++;
	} else {
		r->out.power = says->in_force == r->out.asked;
	}
}

static void check_spark(const struct rig *r, struct late *g)
{
	const double peak_a = r->out.pulse[INTERP_TECH_PEAK_A];
	const bool as_asked = g->has.tenths == (isnan(peak_a) ? OWN :
						lround(10 * peak_a)) &&
			      g->has.negative ==
			      (r->out.pulse[INTERP_TECH_POLARITY] < 0);

	g->hurt = as_asked || !g->hurt ? 0 : g->hurt + 1;
	if (!(r->usual.data[0] & 1))
		return;
	g->sparks++;
	/* It tells it in that period, and the frame that ends them goes out. */
	assert_true(as_asked || g->hurt == 2);
}

static void no_spark_has_other_values_than_those_asked(void **state)
{
	struct late g = { .seed = seed_take() };
	struct rig r;

	(void)state;
	make(&r, frames_tells);
	ask(&r, 6);
	r.out.pulse[INTERP_TECH_POLARITY] = 1;
	for (int i = 0; i < SEED_ROUNDS(1000000); i++) {
		late_turn(&g);
		check_spark(&r, &g);
		tell(&r, g.has.tenths / 5, g.has.negative);
		r.m.read(r.m.self, &r.in);
		cycle_turn(&r, &g);
		r.m.write(r.m.self, &r.out);
		r.out.reset = false;
		r.frames = 0;
		take_frames(&r);
		if (r.frames)
			late_take(&g, &r.usual);
		while (log_has(&r, "generator"))
			;
	}
	assert_true(g.sparks > 1000 && g.changes > 1000 && g.restarts > 10);
	r.out.power = false;
	frames_close(&r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(no_spark_has_other_values_than_those_asked),
	};

	return cmocka_run_group_tests_name("io/generator late", tests,
					   make_file, remove_file);
}
