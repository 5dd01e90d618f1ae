/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_build_from.c - a program that begins inside another one is the same from
 * there on
 *
 * Random texts of every dialect, with every strategy, begin at a random place,
 * with the axes anywhere.  The pulses behind the way in are those of the whole
 * program.  The seed is printed; EDM_RUNS is the number of texts.
 */
#include "compile_help.h"
#include "random_compile.h"
#include "seed.h"

#include "interp/build_from.h"
#include "interp/cursor.h"
#include "interp/mcode_arg.h"
#include "path/builder.h"

#define RUNS		SEED_ROUNDS(150)
#define POINTS_MAX	400000
#define AXIS		{ 0.001, -200, 200, 100, 500, 1e5 }

static uint64_t seed;
static uint32_t nearly;			/* that left out before they were
					 * whole */

static const struct interp_machine machine = {
	.present = 0xff,
	.axis = {
		AXIS, AXIS, AXIS, AXIS, AXIS, AXIS, AXIS, AXIS,
	},
};

/* Where every lattice point is, and every action: as one number. */
struct tale {
	uint64_t hash;
	uint32_t points, actions;
	int32_t end[INTERP_NAXES];
};

static void mix(struct tale *t, uint64_t word)
{
	t->hash = (t->hash ^ word) * 0x100000001b3ull;
}

static bool is_done_again(const struct interp_seg *s)
{
	return s->kind != INTERP_DWELL || s->arg != 0;
}

static struct tale walk(const struct interp_program *p, uint32_t from)
{
	struct tale t = { .hash = 1469598103934665603ull };
	struct interp_cursor c;
	enum interp_step what;

	assert_int_equal(interp_cursor_init(&c, p), 0);
	assert_int_equal(interp_cursor_seek_end(&c, from), 0);
	interp_cursor_aim(&c, 1e12);
	while ((what = interp_cursor_step(&c)) != INTERP_AT_END &&
	       t.points < POINTS_MAX) {
		if (what == INTERP_AT_ACTION) {
			interp_cursor_pass(&c);
			interp_cursor_aim(&c, 1e12);
			t.actions += is_done_again(&c.seg);
			continue;
		}
		if (what == INTERP_ARRIVED) {	/* too early: many nodes */
			interp_cursor_aim(&c, 1e12);
			continue;
		}
		assert_int_equal(what, INTERP_MOVED);
		for (int i = 0; i < INTERP_NAXES; i++)
			mix(&t, (uint64_t)(uint32_t)c.pos[i]);
		mix(&t, c.seg.line);
		mix(&t, c.seg.cond);
		t.points++;
	}
	memcpy(t.end, c.pos, sizeof(t.end));
	return t;
}

/* What became of a program that begins inside. */
struct told {
	int rc;
	struct interp_diag d;
	struct interp_build_entry e;
	struct tale tale;
};

/* Of the way in: it starts here, ends there, and is positioned. */
static uint32_t check_way(const struct interp_program *p,
			  const struct interp_build_from *o,
			  const struct interp_build_entry *e)
{
	struct interp_cursor c;
	uint32_t i = 1;
	int stops = 0;

	for (int k = 0; k < INTERP_NAXES; k++)
		assert_int_equal(p->head->start_pulses[k],
				 lround(o->now_mm[k] * 1000) -
				 o->probed.shift[k]);
	while (p->segs[i].length_mm > 0 && p->segs[i].s_mm < e->way_mm)
		assert_int_equal(p->segs[i++].flags & ~INTERP_SEG_STAND,
				 INTERP_SEG_RAPID);
	while (i < p->head->nsegs && p->segs[i].line == e->line &&
	       (p->segs[i].kind == INTERP_AUX ||
		(p->segs[i].kind == INTERP_STOP && o->up < 0 && !stops &&
		 ++stops)))
		i++;
	assert_int_equal(stops, o->up < 0);
	assert_int_equal(interp_cursor_init(&c, p), 0);
	assert_int_equal(interp_cursor_seek_end(&c, i - 1), 0);
	for (int k = 0; k < INTERP_NAXES; k++)
		assert_int_equal(c.pos[k] + o->probed.shift[k],
				 (int32_t)floor(e->entry_mm[k] * 1000 + 0.5 +
						1e-9));
	assert_memory_equal(&p->head->probed, &o->probed, sizeof(o->probed));
	return i - 1;
}

static uint32_t first_left(const struct interp_program *p, double from_mm)
{
	uint32_t last = 0;

	for (uint32_t i = 0; i < p->head->nsegs; i++)
		if (p->segs[i].length_mm > 0 &&
		    p->segs[i].flags & INTERP_SEG_RAPID &&
		    p->segs[i].s_mm + p->segs[i].length_mm <= from_mm + 1e-12)
			last = i;
	return last;
}

static uint32_t lines_of(const struct script *text)
{
	uint32_t n = 0;

	for (int i = 0; i < text->n; i++)
		n += text->at[i] == '\n';
	return n;
}

/* Nobody knows what stands where a probing motion would end. */
static void check_entry(const struct interp_program *whole,
			const struct interp_build_entry *e)
{
	for (uint32_t i = 0; i < whole->head->nsegs; i++) {
		const struct interp_seg *s = &whole->segs[i];
		const double end_mm = s->s_mm + s->length_mm;

		if (s->flags & INTERP_SEG_SENSED && s->length_mm > 0)
			assert_true(fabs(e->from_mm - end_mm) > 1e-9);
	}
}

/* Whoever is told the place before the text leaves out the same. */
static bool check_early(const struct script *text, const char *dialect,
			struct interp_build_options bo,
			const struct interp_build_from *o,
			const struct told *late)
{
	struct interp_build *part;
	struct told told = { .d.line = 0 };
	struct made b;
	struct tale is;
	bool early;

	bo.begins_inside = true;
	bo.from = o;
	part = random_build(text, dialect, &bo);
	assert_non_null(part);
	early = part->inside.done;
	told.rc = interp_build_from(part, o, &told.e, &told.d);
	assert_int_equal(told.rc, late->rc);
	if (told.rc != 0) {
		assert_memory_equal(&told.d, &late->d, sizeof(told.d));
		interp_build_destroy(part);
		return early;
	}
	/* Behind its last field there may be anything. */
	assert_memory_equal(&told.e, &late->e,
			    offsetof(struct interp_build_entry, electrode));
	assert_int_equal(told.e.electrode, late->e.electrode);
	b = finish(part);
	is = walk(&b.p, check_way(&b.p, o, &told.e));
	assert_memory_equal(&is, &late->tale, sizeof(is));
	free(b.block);
	return early;
}

/* Return: was it taken? */
static bool try_one(const struct script *text, const char *dialect,
		    enum interp_strategy how, uint64_t *s)
{
	const struct interp_build_options bo = {
		.machine = &machine, .strategy = how, .tolerance_milli = 2000,
		.fit_mm = rnd(text->seed) % 4 ? 0 : 0.01,
	};
	struct interp_build *whole = random_build(text, dialect, &bo), *part;
	struct interp_build_from o = { .up = rnd(s) % 2 ? INTERP_Z : -1 };
	struct told told = { .d.line = 0 };
	struct made a, b;
	struct tale was, is;
	uint32_t first;

	if (!whole)
		return false;
	a = finish(whole);
	if (rnd(s) % 2)
		o.line = 1 + (uint32_t)(rnd(s) % (lines_of(text) + 2));
	else
		o.far_mm = uniform(s, 0, 1.02 * a.p.head->length_mm);
	for (int i = 0; i < INTERP_NAXES; i++)
		o.now_mm[i] = rnd(s) % 2 ? 0 :
					   round(uniform(s, -9e3, 9e3)) / 1e3;
	o.probed_known = rnd(s) % 2;
	for (int i = 0; o.probed_known && i < INTERP_NAXES; i++)
		o.probed.shift[i] = (int32_t)uniform(s, -4e5, 4e5);
	part = random_build(text, dialect, &bo);
	assert_non_null(part);
	told.rc = interp_build_from(part, &o, &told.e, &told.d);
	if (told.rc != 0) {
		assert_true(told.d.found[0] && told.d.wanted[0]);
		nearly += check_early(text, dialect, bo, &o, &told);
		interp_build_destroy(part);
		free(a.block);
		return false;
	}
	b = finish(part);
	check_entry(&a.p, &told.e);
	first = check_way(&b.p, &o, &told.e);
	was = walk(&a.p, first_left(&a.p, told.e.from_mm));
	is = told.tale = walk(&b.p, first);
	if (was.points < POINTS_MAX) {
		assert_int_equal(is.points, was.points);
		assert_true(is.hash == was.hash);
		assert_memory_equal(is.end, was.end, sizeof(is.end));
		assert_true(is.actions <= was.actions);
	}
	assert_true(fabs(b.p.head->length_mm - told.e.way_mm -
			 (a.p.head->length_mm - told.e.from_mm)) < 1e-6);
	nearly += check_early(text, dialect, bo, &o, &told);
	free(a.block);
	free(b.block);
	return true;
}

static void from_a_place_on_it_is_the_same(void **st)
{
	const char *given = getenv("EDM_RUNS");
	const int runs = given ? atoi(given) : RUNS;
	int taken = 0;

	(void)st;
	for (int i = 0; i < runs; i++) {
		uint64_t s = seed + (uint64_t)i * 1000003;
		static struct script text;
		const char *dialect = random_text(&text, &s);

		for (int how = 0; how < INTERP_NSTRATEGIES; how++)
			taken += try_one(&text, dialect,
					 (enum interp_strategy)how, &s);
	}
	print_message("    %d of %d programs were taken\n", taken,
		      runs * INTERP_NSTRATEGIES);
	print_message("    %u began before they were whole\n", nearly);
	assert_true(taken > runs);
	/* Of a few texts there may be none. */
	assert_true(nearly > 0 || runs < 30);
}

/* It begins at 0, or at Z1; the place is 0.9 mm behind that, or its line. */
static void a_probing_motion_is_made_again(void **st)
{
	static const char *const words[] = {
		"G80 Z-\nG92 Z0", "G38.2 Z-5 F60\nG92 Z0",
		"G80 X+\nG92 X0", "G81 Y-\nG92 Y0",
	};
	const struct interp_build_options bo = {
		.machine = &machine, .strategy = INTERP_SIMULTANEOUS,
	};

	(void)st;
	for (size_t i = 0; i < 4 * sizeof(words) / sizeof(*words); i++) {
		static struct script text;
		struct interp_build_from o = {
			.up = INTERP_Z, .probed_known = true,
		};
		struct interp_build_entry e;
		struct interp_diag d = { 0 };
		struct interp_build *b;

		text.n = 0;
		put(&text, "G21 G90\n%s%s\nG0 Z9\nG1 Z8 F60\nM30\n",
		    i % 2 ? "G0 Z1\n" : "", words[i / 4]);
		if (i / 2 % 2)
			o.line = i % 2 ? 3 : 2;
		else
			o.far_mm = i % 2 ? 1.9 : 0.9;
		b = random_build(&text, "generic", &bo);
		assert_non_null(b);
		assert_int_equal(interp_build_from(b, &o, &e, &d), 0);
		assert_true(e.entry_mm[INTERP_Z] == (i % 2 ? 1 : 0));
		assert_true(e.entry_mm[INTERP_X] == 0);
		assert_int_equal(e.next_line, i % 2 ? 3 : 2);
		interp_build_destroy(b);
	}
}

/* 0 G0 to Z1, M63, 1 mm down, G0 up and over, 2 mm down. */
static struct interp_build *with_codes(uint32_t first, uint32_t second)
{
	const struct interp_build_options bo = {
		.machine = &machine, .strategy = INTERP_SIMULTANEOUS,
	};
	static const double to[][INTERP_NAXES] = {
		{ 0, 0, 1 }, { 0, 0, 0 },  { 0, 0, 1 },
		{ 5, 0, 1 }, { 5, 0, -1 },
	};
	struct interp_build *b = interp_build_create(&bo);
	struct interp_diag d;

	assert_non_null(b);
	for (uint32_t i = 0; i < 5; i++) {
		const struct interp_build_word w = {
			.line = i + 1, .rapid = i != 1 && i != 4,
		};
		const uint32_t code = i == 1 ? first : i == 4 ? second : 0;

		if (code)
			assert_int_equal(interp_build_action(b, INTERP_MCODE,
							     code, &w, &d), 0);
		assert_int_equal(interp_build_line(b, to[i], &w, &d), 0);
	}
	return b;
}

/* Nobody knows whether the PLC heard it: it is told at the end of the
 * positioning, before anything else, and not a second time. */
static void an_unanswered_code_is_told_again(void **st)
{
	const struct interp_mcode m = { INTERP_MCODE_FREE, INTERP_MCODE_SKIP };
	const uint32_t pump = interp_mcode_arg(63, m);
	const uint32_t light = interp_mcode_arg(64, m);

	(void)st;
	for (uint32_t i = 0; i < 8; i++) {
		const bool left_out = i & 1, asked = i & 2, other = i & 4;
		struct interp_build *b = with_codes(left_out ? pump : light,
						    left_out ? light : pump);
		const struct interp_build_from o = {
			/* 9 mm are before the second cut. */
			.far_mm = 9.5, .up = INTERP_Z, .probed_known = true,
			.unanswered = other ? 65 : asked ? 63 : 0,
		};
		struct interp_build_entry e;
		struct interp_diag d;
		struct made part;
		uint32_t told = 0;

		assert_int_equal(interp_build_from(b, &o, &e, &d), 0);
		part = finish(b);
		for (uint32_t k = 0; k < part.p.head->nsegs; k++) {
			const struct interp_seg *s = &part.p.segs[k];

			if (s->kind != INTERP_MCODE)
				continue;
			told++;
			assert_int_equal(s->arg, pump);
			assert_true(s->s_mm == e.way_mm);
		}
		assert_int_equal(told, asked && !other);
		assert_int_equal(e.again, told ? pump : 0);
		free(part.block);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(from_a_place_on_it_is_the_same),
		cmocka_unit_test(a_probing_motion_is_made_again),
		cmocka_unit_test(an_unanswered_code_is_told_again),
	};

	seed = seed_take();
	return cmocka_run_group_tests(tests, NULL, NULL);
}
