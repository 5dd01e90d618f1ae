/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_limits_threads.c - the limits of a long program do not depend on who
 * finds them
 *
 * Random programs of lines, dense and long, arcs, two contours, curves, rapids,
 * actions and axes that come late are put together twice: by one thread, and
 * with one that follows.  Each byte is compared.  This is also run under the
 * thread sanitizer.  The seed is printed.
 */
#include "walk_help.h"

#include "seed.h"

#include "interp/build_from.h"
#include "path/builder.h"

#define ROUNDS	SEED_ROUNDS(6)
#define SEGS	24000			/* of which a thread sees some
					 * thousand */
#define PART	200			/* segments of one kind */

static uint64_t seed;
static const struct interp_build_memory *memory;	/* NULL: the heap */

/* Where the path goes, and how. */
struct going {
	double mm, turn, way;
	double rate[INTERP_NAXES], wave;	/* of the axes beside X Y */
	bool rapid;
	uint32_t arcs, pairs, actions;	/* one in so many; 0: none */
};

static struct going some_way(uint64_t *s, bool late)
{
	struct going g = {
		.mm = exp(uniform(s, -7, 1)), .turn = uniform(s, -0.3, 0.3),
		.way = uniform(s, 0, 6.28), .wave = uniform(s, 0, 2),
		.rapid = rnd(s) % 8 == 0,
		.arcs = rnd(s) % 3 ? 0 : 5,
		.pairs = late && rnd(s) % 6 == 0 ? 9 : 0,
		.actions = rnd(s) % 4 ? 0 : 20,
	};
	const uint32_t beside = (uint32_t)(rnd(s) & rnd(s)) & 0xfc;

	for (int a = 2; a < INTERP_NAXES; a++)
		if (beside & 1u << a && (late || a == INTERP_C))
			g.rate[a] = uniform(s, -5, 5);
	return g;
}

static void stop_here(struct interp_build *b)
{
	struct interp_diag d = { 0 };

	assert_int_equal(interp_build_action(b, INTERP_DWELL, 1, &help_word,
					     &d), 0);
}

static void arc_to(struct interp_build *b, double *end)
{
	const double *at = interp_build_here(b);

	if (hypot(end[0] - at[0], end[1] - at[1]) < 0.01)
		line(b, end);
	else
		arc(b, end, (at[0] + end[0]) / 2, (at[1] + end[1]) / 2, true);
}

static void pair_to(struct interp_build *b, double *end)
{
	const struct interp_build_contour way[2] = { { .arc = false } };
	struct interp_diag d = { 0 };
	double to[INTERP_NAXES];

	memcpy(to, interp_build_here(b), sizeof(to));
	to[INTERP_X] = end[0];
	to[INTERP_Y] = end[1];
	to[INTERP_U] = fmod(to[INTERP_U] + 0.1, 180);
	assert_int_equal(interp_build_pair(b, to, way, &help_word, &d), 0);
	memcpy(end, to, sizeof(to));
}

/* A bow, from here to near here. */
static void curve_to(struct interp_build *b, double *end)
{
	static const double knots[] = { 0, 0, 0, 0, 1, 1, 1, 1 };
	const double *at = interp_build_here(b);
	double points[4][3];
	struct interp_build_curve c = {
		.nurbs = { .degree = 3, .naxes = 2, .npoints = 4, .counted = 2,
			   .knots = knots, .points = points[0] },
		.axis = { INTERP_X, INTERP_Y },
	};
	struct interp_diag d = { 0 };

	for (int i = 0; i < 4; i++) {
		points[i][0] = at[0] + i;
		points[i][1] = at[1] + (i == 1 || i == 2 ? 2 : 0);
		points[i][2] = 1;
	}
	assert_int_equal(interp_build_curve(b, &c, &help_word, &d), 0);
	memcpy(end, interp_build_here(b), sizeof(points[0]));
}

/* It stays inside the travel. */
static void go_on(struct interp_build *b, struct going *g, double *end,
		  uint64_t *s)
{
	const bool bends = g->mm > 0.1 && g->arcs && rnd(s) % g->arcs == 0;
	const bool pairs = g->pairs && rnd(s) % g->pairs == 0;

	g->way += g->turn + (rnd(s) % 60 == 0 ? uniform(s, -2, 2) : 0);
	end[0] = round((end[0] * 0.98 + g->mm * cos(g->way)) * 1e4) * 1e-4;
	end[1] = round((end[1] * 0.98 + g->mm * sin(g->way)) * 1e4) * 1e-4;
	for (int a = 2; a < INTERP_NAXES && !bends && !pairs; a++)
		if (g->rate[a] != 0)
			end[a] = fmod(end[a] + g->mm * g->rate[a] *
				      (1 + g->wave * sin(g->way)), 180);
	if (g->actions && rnd(s) % g->actions == 0)
		stop_here(b);
	help_word.rapid = g->rapid && !bends && !pairs;
	if (bends)
		arc_to(b, end);
	else if (pairs)
		pair_to(b, end);
	else
		line(b, end);
}

static struct interp_build *program_from(uint64_t s, uint32_t threads,
					 const struct interp_build_from *from)
{
	struct interp_build_options o = { .machine = &help_machine,
					  .threads = threads,
					  .begins_inside = from != NULL,
					  .from = from, .memory = memory };
	const uint32_t curve_at = rnd(&s) % 2 ? SEGS * 3 / 4 : 0;
	double end[INTERP_NAXES] = { 0 };
	struct interp_build *b;
	struct going g;

	interp_build_destroy(begin(INTERP_SIMULTANEOUS));
	o.corner_mm = rnd(&s) % 2 ? 0 : 0.001;
	b = interp_build_create(&o);
	assert_non_null(b);
	for (uint32_t i = 0; i < SEGS; i++) {
		if (i % PART == 0)
			g = some_way(&s, i > SEGS / 2);
		if (i && i == curve_at)
			curve_to(b, end);
		go_on(b, &g, end, &s);
	}
	return b;
}

static struct interp_build *program(uint64_t s, uint32_t threads)
{
	return program_from(s, threads, NULL);
}

static void same(const struct made *a, const struct made *b)
{
	assert_int_equal(a->bytes, b->bytes);
	for (uint32_t i = 0; i < a->p.head->nsegs; i++) {
		const struct interp_seg *s = &a->p.segs[i], *t = &b->p.segs[i];

		if (memcmp(s, t, sizeof(*s)) != 0)
			fail_msg("segment %u of %u: node %g, not %g; at most "
				 "%g, not %g", i, a->p.head->nsegs,
				 (double)t->node_mm_s, (double)s->node_mm_s,
				 (double)t->feed_max_mm_s,
				 (double)s->feed_max_mm_s);
	}
	assert_memory_equal(a->block, b->block, a->bytes);
}

static void limits_do_not_depend_on_the_number_of_threads(void **st)
{
	(void)st;
	for (uint64_t r = 0; r < ROUNDS; r++) {
		struct made a = finish(program(seed + r, 1));
		struct made b = finish(program(seed + r, 2));

		same(&a, &b);
		unmake(&a);
		unmake(&b);
	}
}

static struct interp_build *rest_of(struct interp_build *b,
				    const struct interp_build_from *from,
				    struct interp_build_entry *ret)
{
	struct interp_diag d = { 0 };

	if (interp_build_from(b, from, ret, &d) != 0)
		fail_msg("%s; %s", d.found, d.wanted);
	return b;
}

static void neither_do_those_of_the_rest_of_a_program(void **st)
{
	const struct interp_build_from from = { .far_mm = 20,
						.probed_known = true,
						.up = INTERP_Z };
	struct interp_build_entry entry[4];
	struct made made[4];

	(void)st;
	for (uint32_t i = 0; i < 4; i++) {
		struct interp_build *b = i < 2 ? program(seed, i + 1) :
			program_from(seed, i - 1, &from);

		assert_int_equal(b->inside.done, i >= 2);
		made[i] = finish(rest_of(b, &from, &entry[i]));
	}
	same(&made[0], &made[1]);
	same(&made[2], &made[3]);
	for (uint32_t i = 0; i < 4; i++)
		unmake(&made[i]);
}

/* Memory that is never where it was. */
struct moving {
	void *at;
	size_t bytes, most;		/* 0: as much as is wanted */
	int moves;
};

static void *move_on(void *arg, void *at, size_t bytes)
{
	struct moving *m = arg;
	void *to = m->most && bytes > m->most ? NULL : malloc(bytes);

	if (!to)
		return NULL;
	assert_ptr_equal(at, m->at);
	if (at) {
		memcpy(to, at, bytes < m->bytes ? bytes : m->bytes);
		memset(at, 0xa5, m->bytes);
		free(at);
	}
	*m = (struct moving) { to, bytes, m->most, m->moves + 1 };
	return to;
}

static void nor_on_the_memory_that_becomes_the_program(void **st)
{
	const struct interp_build_from from = { .far_mm = 20,
						.probed_known = true,
						.up = INTERP_Z };
	struct interp_build_entry entry;

	(void)st;
	for (uint32_t i = 0; i < 4; i++) {
		const struct interp_build_from *f = i < 2 ? NULL : &from;
		struct moving m = { .moves = 0 };
		const struct interp_build_memory lent = { move_on, &m };
		struct interp_build *b[2];
		struct made made[2];

		for (int k = 0; k < 2; k++) {
			memory = k ? &lent : NULL;
			b[k] = program_from(seed + i, i % 2 + 1, f);
			if (f)
				rest_of(b[k], f, &entry);
			made[k] = finish(b[k]);
		}
		memory = NULL;
		assert_true(m.moves > 2);
		assert_ptr_equal(made[1].block, m.at);
		assert_int_equal(made[1].bytes, m.bytes);
		same(&made[0], &made[1]);
		unmake(&made[0]);
		unmake(&made[1]);
	}
}

static struct made to_and_fro(uint32_t lines)
{
	const struct interp_build_options o = { .machine = &help_machine,
						.threads = 1,
						.memory = memory };
	double end[INTERP_NAXES] = { 0 };
	struct interp_build *b;

	interp_build_destroy(begin(INTERP_SIMULTANEOUS));
	b = interp_build_create(&o);
	assert_non_null(b);
	for (uint32_t i = 0; i < lines; i++) {
		end[0] = i % 2;
		line(b, end);
	}
	return finish(b);
}

static void a_program_needs_no_more_memory_than_it_comes_to(void **st)
{
	(void)st;
	for (uint32_t lines = 2000; lines <= SEGS; lines += 2000) {
		struct made made[2] = { to_and_fro(lines) };
		struct moving m = { .most = made[0].bytes };
		const struct interp_build_memory lent = { move_on, &m };

		memory = &lent;
		made[1] = to_and_fro(lines);
		memory = NULL;
		same(&made[0], &made[1]);
		unmake(&made[0]);
		unmake(&made[1]);
	}
}

static void a_program_may_be_given_up(void **st)
{
	(void)st;
	interp_build_destroy(program(seed, 2));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(limits_do_not_depend_on_the_number_of_threads),
		cmocka_unit_test(neither_do_those_of_the_rest_of_a_program),
		cmocka_unit_test(nor_on_the_memory_that_becomes_the_program),
		cmocka_unit_test(
			a_program_needs_no_more_memory_than_it_comes_to),
		cmocka_unit_test(a_program_may_be_given_up),
	};

	seed = seed_take();
	return cmocka_run_group_tests(tests, NULL, NULL);
}
