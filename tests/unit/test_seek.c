/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_seek.c - to stand at a tick at once is to walk there
 *
 * Random texts of every dialect, by every strategy and coupling, and long lines
 * and circles.  A cursor that was sent to a tick stands where one that walked
 * there does, with the same numbers inside, and goes on, forward and back, by
 * the same pulses.  The seed is printed; EDM_RUNS is the number of texts.
 *
 * The longest segments cannot be walked.  There the places at both ends are
 * known, and each place sought is walked to from another place sought.
 */
#include "interp/angle.h"
#include "random_compile.h"
#include "seed.h"

#include "pulse/pulse.h"

#include <errno.h>

#define RUNS		150
#define PLACES		6		/* in each segment */
#define ON		150		/* ticks from there, each way */

#define DAMAGES		50		/* of each program */
#define LONGEST_MM	500		/* of 1e-6 mm a pulse */

#define ROWS_R2		1000		/* circles of all rows */
#define ROWS_R		100000		/* and some of larger ones */
#define ROWS_RUNS	SEED_ROUNDS(1000)

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

static int runs(void)
{
	const char *given = getenv("EDM_RUNS");

	return given ? atoi(given) : SEED_ROUNDS(RUNS);
}

static bool same_pair(const struct interp_pair *a, const struct interp_pair *b)
{
	return a->m == b->m && a->s == b->s && a->dev == b->dev &&
	       (!a->bursts ||
		(a->burst == b->burst && a->from == b->from &&
		 a->to == b->to && a->due == b->due && a->done == b->done));
}

static bool same_circle(const struct interp_circle *a,
			const struct interp_circle *b)
{
	return a->x == b->x && a->y == b->y && a->dev == b->dev &&
	       a->tick == b->tick &&
	       (a->runs ? a->run == b->run && a->sent == b->sent :
			  a->left == b->left && a->quad == b->quad);
}

static bool same_side(const struct interp_side *a, const struct interp_side *b)
{
	return a->tick == b->tick && a->dev == b->dev &&
	       same_circle(&a->circle, &b->circle);
}

/* The numbers from which the next pulse follows. */
static bool same_inside(const struct interp_cursor *a,
			const struct interp_cursor *b)
{
	bool same = same_circle(&a->circle, &b->circle) &&
		    a->circle_at == b->circle_at &&
		    same_side(&a->side[0], &b->side[0]) &&
		    same_side(&a->side[1], &b->side[1]);

	for (int i = 0; i < INTERP_NAXES; i++)
		same &= a->dda[i].err == b->dda[i].err &&
			same_pair(&a->pair[i], &b->pair[i]);
	return same;
}

static void compare(const struct job *j, const struct interp_cursor *a,
		    const struct interp_cursor *b)
{
	if (!same_inside(a, b))
		say(j, a, "other numbers inside");
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
	c->want = back ? INT64_MIN / 2 : INT64_MAX;
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

static void set_machine(struct interp_machine *m, double pulse_mm,
			double travel_mm)
{
	*m = (struct interp_machine) { .present = 0xff };
	for (int i = 0; i < INTERP_NAXES; i++)
		m->axis[i] = (struct interp_axis_limits) {
			pulse_mm, -travel_mm, travel_mm, 100, 1000, 1e6
		};
}

static void choose(struct job *j, const struct interp_machine *m)
{
	static const uint32_t mus[] = { 1000, 1500, 2000, 5000, 20000 };

	j->o = (struct interp_build_options) {
		.machine = m,
		.strategy = (enum interp_strategy)
			    (rnd(&seed) % INTERP_NSTRATEGIES),
		.coupling = (enum interp_coupling)
			    (rnd(&seed) % INTERP_NCOUPLINGS),
		.tolerance_milli = rnd(&seed) % 2 ? mus[rnd(&seed) % 5] :
				   1000 + (uint32_t)(rnd(&seed) % 5000),
		.perpendicular = rnd(&seed) % 2,
	};
}

static void a_place_sought_is_the_place_walked_to(void **state)
{
	struct interp_machine m;
	static struct job j;
	struct made made;
	int taken = 0;

	(void)state;
	seed = seed_take();
	set_machine(&m, 0.001, 200);
	for (int i = 0; i < runs(); i++) {
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
	struct interp_build_arc a = {
		.axis_a = INTERP_X, .axis_b = INTERP_Y,
		.centre_a_mm = uniform(&seed, -20, 20),
		.centre_b_mm = uniform(&seed, -20, 20),
	};
	const bool clockwise = rnd(&seed) % 2;
	const double more = ANGLE_TURN * (double)(rnd(&seed) % 4);
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
	arc_turn(&a, b, to, clockwise);
	a.sweep += a.sweep < 0 ? -more : more;
	return interp_build_arc(b, to, &a, &help_word, &d);
}

static void a_place_in_a_long_segment_is_the_same_too(void **state)
{
	struct interp_machine m;
	static struct job j;
	int taken = 0;

	(void)state;
	j.dialect = "generic";
	set_machine(&m, 0.001, 200);
	for (int i = 0; i < runs() / 3; i++) {
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
	assert_true(taken > runs() / 3);
}

/* -- The longest ----------------------------------------------------------- */

/* Two to eight axes, together about half as many pulses as a segment may have.
 * For min-switch, the compiler plans each of them. */
static int add_longest_line(struct interp_build *b, enum interp_strategy s)
{
	const double way_mm = s == INTERP_MIN_SWITCH ? LONGEST_MM / 50 :
						       LONGEST_MM;
	const double *here = interp_build_here(b);
	const uint64_t axes = 2 + rnd(&seed) % 7;
	double to[INTERP_NAXES], sum_mm = 0;
	struct interp_diag d = { 0 };

	memcpy(to, here, sizeof(to));
	for (uint64_t i = 0; i < axes; i++) {
		to[i] = uniform(&seed, -1, 1);
		sum_mm += fabs(to[i]);
	}
	for (uint64_t i = 0; i < axes; i++)
		to[i] *= way_mm / sum_mm;
	return interp_build_line(b, to, &help_word, &d);
}

/* The compiler walks each circle but those of all axes at once. */
static int add_longest_circle(struct interp_build *b, enum interp_strategy s)
{
	const double r_mm = s == INTERP_SIMULTANEOUS ? LONGEST_MM / 9 : 0.02;
	const double *here = interp_build_here(b);
	const struct interp_build_arc a = {
		.axis_a = INTERP_X, .axis_b = INTERP_Y,
		.centre_a_mm = here[0] - uniform(&seed, r_mm / 2, r_mm),
		.centre_b_mm = here[1] + uniform(&seed, r_mm / 2, r_mm),
		.sweep = (rnd(&seed) % 2 ? -2 : 2) * ANGLE_TURN,
	};
	struct interp_diag d = { 0 };
	double to[INTERP_NAXES];

	memcpy(to, here, sizeof(to));
	if (rnd(&seed) % 2)
		to[2] += r_mm;
	return interp_build_arc(b, to, &a, &help_word, &d);
}

static struct interp_cursor sought(const struct job *j,
				   const struct interp_program *p, uint32_t i,
				   uint32_t tick)
{
	struct interp_cursor c;

	assert_int_equal(interp_cursor_init(&c, p), 0);
	if (interp_cursor_seek(&c, i, tick) != 0)
		say(j, &c, "no such place");
	return c;
}

/* From @tick, what is walked to is what is sought. */
static void seek_beside(const struct job *j, const struct interp_program *p,
			uint32_t i, uint32_t tick, bool back)
{
	struct interp_cursor c = sought(j, p, i, tick);
	uint16_t pulses;

	for (int n = 0; n < ON && c.tick != (back ? 0 : c.seg.ticks); n++) {
		struct interp_cursor there;

		walk(j, &c, back, &pulses);
		if (n % 10 != 0 && n != ON - 1)
			continue;
		there = sought(j, p, i, c.tick);
		compare(j, &c, &there);
	}
}

static void seek_along(const struct job *j, const struct interp_program *p,
		       uint32_t i)
{
	const uint32_t ticks = p->segs[i].ticks;
	struct interp_cursor end, last = sought(j, p, i, ticks);

	assert_int_equal(interp_cursor_init(&end, p), 0);
	assert_int_equal(interp_cursor_seek_end(&end, i), 0);
	compare(j, &end, &last);
	assert_int_equal(interp_cursor_seek(&end, i, ticks + 1), -ERANGE);
	seek_beside(j, p, i, 0, false);
	seek_beside(j, p, i, ticks, true);
	for (int n = 0; n < PLACES; n++) {
		const uint32_t at = (uint32_t)(rnd(&seed) % ticks);

		seek_beside(j, p, i, at, false);
		seek_beside(j, p, i, at, true);
	}
}

static void a_place_in_the_longest_segment_is_found(void **state)
{
	static const enum interp_coupling by[] = { INTERP_STAR, INTERP_TREE };
	static struct job j;
	struct interp_machine m;
	uint32_t most = 0;

	(void)state;
	j.dialect = "generic";
	set_machine(&m, 1e-6, 2 * LONGEST_MM);
	for (int i = 0; i < 2 * INTERP_NSTRATEGIES; i++) {
		struct interp_build *b;
		struct made made;

		choose(&j, &m);
		j.o.strategy = (enum interp_strategy)(i / 2);
		j.o.coupling = by[i % 2];
		/* Others are stored, bit by bit. */
		j.o.tolerance_milli = 2000;
		j.o.perpendicular = false;
		b = interp_build_create(&j.o);
		assert_int_equal(add_longest_line(b, j.o.strategy), 0);
		assert_int_equal(add_longest_circle(b, j.o.strategy), 0);
		made = finish(b);
		for (uint32_t k = 0; k < made.p.head->nsegs; k++) {
			const struct interp_seg *s = &made.p.segs[k];

			if (s->kind < INTERP_BEGIN)
				seek_along(&j, &made.p, k);
			most = s->ticks > most ? s->ticks : most;
		}
		unmake(&made);
	}
	print_message("%u ticks in the longest\n", most);
	assert_true(most > LONGEST_MM * 900000);
}

/* -- Damaged --------------------------------------------------------------- */

/* Whatever the numbers are, a place is found or refused. */
static int seek_damaged(struct made m)
{
	void *sound = malloc(m.bytes);
	int found = 0;

	assert_non_null(sound);
	memcpy(sound, m.block, m.bytes);
	for (int k = 0; k < DAMAGES; k++) {
		struct interp_cursor c;
		uint32_t i;

		damage(&m, &seed);
		if (interp_program_map(&m.p, m.block, m.bytes) == 0 &&
		    interp_cursor_init(&c, &m.p) == 0) {
			i = (uint32_t)rnd(&seed) % m.p.head->nsegs;
			found += interp_cursor_seek(&c, i,
				(uint32_t)rnd(&seed) % 5000) == 0;
		}
		memcpy(m.block, sound, m.bytes);
	}
	free(sound);
	return found;
}

static void a_place_in_a_damaged_segment_is_found_or_refused(void **state)
{
	struct interp_machine m;
	static struct job j;
	int found = 0;

	(void)state;
	set_machine(&m, 0.001, 200);
	for (int i = 0; i < runs(); i++) {
		struct made made;

		j.dialect = random_text(&j.text, &seed);
		choose(&j, &m);
		if (!random_compile(&j.text, j.dialect, &j.o, &made))
			continue;
		found += seek_damaged(made);
		unmake(&made);
	}
	print_message("%d places found\n", found);
	assert_true(found > 0);
}

/* Row by row: the greatest `in` of each, from that of the one before. */
static int64_t rows_one_by_one(int64_t r2, int64_t from, int64_t to)
{
	int64_t in = 0, sum = 0;

	for (int64_t out = to - 1; out >= from; out--) {
		while ((in + 1) * (in + 1) + out * out < r2)
			in++;
		sum += in;
	}
	return sum;
}

static void compare_rows(int64_t r2, int64_t from, int64_t to)
{
	const int64_t one_by_one = rows_one_by_one(r2, from, to);
	const int64_t at_once = circle_rows(r2, from, to);

	if (one_by_one != at_once)
		fail_msg("rows %lld ... %lld of r2 %lld: %lld, not %lld",
			 (long long)from, (long long)to, (long long)r2,
			 (long long)at_once, (long long)one_by_one);
}

static void rows_of_a_circle_are_counted_as_one_by_one(void **state)
{
	(void)state;
	seed = seed_take();
	for (int64_t r2 = 2, rows = 1; r2 < ROWS_R2; r2++) {
		while (rows * rows < r2 - 1)
			rows++;
		for (int64_t from = 0; from < rows; from++)
			for (int64_t to = from; to <= rows; to++)
				compare_rows(r2, from, to);
	}
	for (int i = 0; i < ROWS_RUNS; i++) {
		const int64_t r = 2 + (int64_t)(rnd(&seed) % ROWS_R);
		const int64_t r2 = r * r + (int64_t)(rnd(&seed) % (uint64_t)r);
		const int64_t from = (int64_t)(rnd(&seed) % (uint64_t)r);

		compare_rows(r2, from, from + (int64_t)(rnd(&seed) %
						(uint64_t)(r - from + 1)));
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_place_sought_is_the_place_walked_to),
		cmocka_unit_test(a_place_in_a_long_segment_is_the_same_too),
		cmocka_unit_test(a_place_in_the_longest_segment_is_found),
		cmocka_unit_test(a_place_in_a_damaged_segment_is_found_or_refused),
		cmocka_unit_test(rows_of_a_circle_are_counted_as_one_by_one),
	};

	return cmocka_run_group_tests_name("interp/seek", tests, NULL, NULL);
}
