/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_seek.c - to stand at a tick at once is to walk there
 *
 * Random texts of every dialect, by every strategy and coupling, and long lines
 * and circles.  A cursor that was sent to a tick stands where one that walked
 * there does, and goes on, forward and back, by the same pulses.  The seed is
 * printed; EDM_RUNS is the number of texts.
 */
#include "random_compile.h"
#include "seed.h"

#include "pulse/pulse.h"

#define RUNS		SEED_ROUNDS(150)
#define PLACES		6		/* in each segment */
#define ON		150		/* ticks from there, each way */

static uint64_t seed;
static uint64_t seen[INTERP_BEGIN];	/* places, by kind */

struct job {
	struct script text;
	const char *dialect;
	struct interp_build_options o;
};

static void say(const struct job *j, const struct interp_cursor *c,
		const char *what)
{
	fail_msg("%s at tick %u of %u of segment %u, kind %d: --dialect %s "
		 "--strategy %s, coupling %d, mu %u%s\n%s", what, c->tick,
		 c->seg.ticks, c->index, c->seg.kind, j->dialect,
		 interp_strategy_name(j->o.strategy), j->o.coupling,
		 j->o.tolerance_milli, j->o.perpendicular ? " square" : "",
		 j->text.at);
}

static void compare(const struct job *j, const struct interp_cursor *a,
		    const struct interp_cursor *b)
{
	if (memcmp(a->pos, b->pos, sizeof(a->pos)) != 0)
		say(j, a, "another point");
	if (a->tick != b->tick || a->measure != b->measure)
		say(j, a, "another place");
	if (a->walk->last && a->walk->last(a) != b->walk->last(b))
		say(j, a, "another last tick");
}

static void walk(const struct job *j, struct interp_cursor *c, bool back,
		 uint16_t *ret)
{
	c->backward = back;
	*ret = 0;
	if ((back ? c->walk->back : c->walk->forward)(c, 1, ret) == PULSE_BAD)
		say(j, c, "it cannot walk");
}

/* Both go the same way, as far as the segment has ticks. */
static void go_on(const struct job *j, struct interp_cursor a,
		  struct interp_cursor b, bool back)
{
	for (int i = 0; i < ON && a.tick != (back ? 0 : a.seg.ticks); i++) {
		uint16_t of_a, of_b;

		walk(j, &a, back, &of_a);
		walk(j, &b, back, &of_b);
		if (of_a != of_b)
			say(j, &a, "other pulses");
		compare(j, &a, &b);
	}
}

static void seek_in(const struct job *j, const struct interp_program *p,
		    uint32_t i)
{
	struct interp_cursor walked, sought;
	const uint32_t ticks = p->segs[i].ticks;
	uint16_t pulses;

	assert_int_equal(interp_cursor_init(&walked, p), 0);
	sought = walked;
	assert_int_equal(interp_cursor_seek(&walked, i, 0), 0);
	for (uint32_t n = 0; n <= PLACES; n++) {
		const uint32_t from = (uint32_t)((uint64_t)ticks * n / PLACES);
		const uint32_t to = from + (n < PLACES ?
			(uint32_t)(rnd(&seed) % (ticks / PLACES + 1)) : 0);

		while (walked.tick < to)
			walk(j, &walked, false, &pulses);
		if (interp_cursor_seek(&sought, i, to) != 0)
			say(j, &walked, "no such place");
		compare(j, &walked, &sought);
		go_on(j, walked, sought, false);
		go_on(j, walked, sought, true);
		seen[walked.seg.kind]++;
	}
}

static void seek_everywhere(const struct job *j, const struct made *m)
{
	for (uint32_t i = 0; i < m->p.head->nsegs; i++)
		if (m->p.segs[i].kind < INTERP_BEGIN && m->p.segs[i].ticks > 0)
			seek_in(j, &m->p, i);
}

static void set_machine(struct interp_machine *m)
{
	*m = (struct interp_machine) { .present = 0xff };
	for (int i = 0; i < INTERP_NAXES; i++)
		m->axis[i] = (struct interp_axis_limits) {
			0.001, -200, 200, 100, 1000, 1e6
		};
}

static void choose(struct job *j, const struct interp_machine *m)
{
	static const uint32_t mus[] = { 1000, 1500, 2000, 5000, 20000 };

	j->o = (struct interp_build_options) {
		.machine = m, .chord_error_mm = 0.001,
		.strategy = (enum interp_strategy)
			    (rnd(&seed) % INTERP_NSTRATEGIES),
		.coupling = (enum interp_coupling)
			    (rnd(&seed) % INTERP_NCOUPLINGS),
		.tolerance_milli = rnd(&seed) % 2 ? mus[rnd(&seed) % 5] :
				   1000 + (uint32_t)(rnd(&seed) % 5000),
		.perpendicular = rnd(&seed) % 2,
	};
	if (j->o.coupling == INTERP_TUBE &&
	    j->o.strategy != INTERP_MIN_SWITCH)
		j->o.coupling = INTERP_STAR;
}

static void a_place_sought_is_the_place_walked_to(void **state)
{
	struct interp_machine m;
	static struct job j;
	struct made made;
	int taken = 0;

	(void)state;
	seed = seed_take();
	set_machine(&m);
	for (int i = 0; i < RUNS; i++) {
		j.dialect = random_text(&j.text, &seed);
		for (int k = 0; k < 4; k++) {
			choose(&j, &m);
			if (!random_compile(&j.text, j.dialect, &j.o, &made))
				continue;
			seek_everywhere(&j, &made);
			unmake(&made);
			taken++;
		}
	}
	print_message("%d programs; places on lines %llu, arcs %llu, pairs "
		      "%llu, curves %llu\n", taken,
		      (unsigned long long)seen[INTERP_LINE],
		      (unsigned long long)seen[INTERP_ARC],
		      (unsigned long long)seen[INTERP_PAIR],
		      (unsigned long long)seen[INTERP_CURVE]);
}

/* A long line of two to eight axes. */
static int add_line(struct interp_build *b)
{
	struct interp_diag d = { 0 };
	double to[INTERP_NAXES] = { 0 };

	for (uint64_t i = 0, n = 2 + rnd(&seed) % 7; i < n; i++)
		to[i] = uniform(&seed, -15, 15);
	return interp_build_line(b, to, &help_word, &d);
}

/* A circle of several turns, or a helix. */
static int add_circle(struct interp_build *b)
{
	const struct interp_build_arc a = {
		.axis_a = INTERP_X, .axis_b = INTERP_Y,
		.centre_a_mm = uniform(&seed, -20, 20),
		.centre_b_mm = uniform(&seed, -20, 20),
		.clockwise = rnd(&seed) % 2,
		.turns = (uint32_t)(rnd(&seed) % 4),
	};
	const double *here = interp_build_here(b);
	const double x = here[0] - a.centre_a_mm, y = here[1] - a.centre_b_mm;
	const double turn = rnd(&seed) % 3 ? uniform(&seed, -3, 3) : 0;
	struct interp_diag d = { 0 };
	double to[INTERP_NAXES];

	memcpy(to, here, sizeof(to));
	to[0] = a.centre_a_mm + x * cos(turn) - y * sin(turn);
	to[1] = a.centre_b_mm + x * sin(turn) + y * cos(turn);
	if (rnd(&seed) % 2)
		to[2] += uniform(&seed, -9, 9);
	return interp_build_arc(b, to, &a, &help_word, &d);
}

static void a_place_in_a_long_segment_is_the_same_too(void **state)
{
	struct interp_machine m;
	static struct job j;
	int taken = 0;

	(void)state;
	j.dialect = "generic";
	set_machine(&m);
	for (int i = 0; i < RUNS / 3; i++) {
		struct interp_build *b;
		struct made made;

		choose(&j, &m);
		b = interp_build_create(&j.o);
		assert_non_null(b);
		taken += add_line(b) == 0;
		taken += add_circle(b) == 0;
		made = finish(b);
		seek_everywhere(&j, &made);
		unmake(&made);
	}
	print_message("%d long segments\n", taken);
	assert_true(taken > RUNS / 3);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_place_sought_is_the_place_walked_to),
		cmocka_unit_test(a_place_in_a_long_segment_is_the_same_too),
	};

	return cmocka_run_group_tests_name("interp/seek", tests, NULL, NULL);
}
