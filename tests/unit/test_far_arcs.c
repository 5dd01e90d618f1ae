/* SPDX-License-Identifier: Apache-2.0 */
/*
 * test_far_arcs.c - short arcs of any radius
 *
 * What the builder takes, the cursor walks: to the exact end and back, near the
 * circle, whatever the radius is.  What it does not take is refused in words.
 * The seed is printed.
 */
#include "walk_help.h"
#include "seed.h"

#define ARCS		SEED_ROUNDS(4000)
#define FARTHEST	12.5		/* of the radius, in powers of ten of a
					 * pulse */
#define LONGEST		400		/* from end to end, pulses */
/* From its circle: of min-switch by its tolerance more, and by the rounding of
 * ends and centre. */
#define NEAR		3.5
#define TOLERANCE	2.0

static uint64_t seed;

struct far {
	double to[2], centre[2];	/* pulses, from the start */
	bool clockwise;
	enum interp_strategy how;
};

static void say(const struct far *f, const char *what)
{
	fail_msg("%s: %s to %.17g %.17g round %.17g %.17g %s", what,
		 interp_strategy_name(f->how), f->to[0], f->to[1],
		 f->centre[0], f->centre[1],
		 f->clockwise ? "clockwise" : "ccw");
}

/* The shorter arc between two places. */
static struct far draw(uint64_t *s)
{
	const double half = round(uniform(s, 1, LONGEST)) / 2;
	const double r = half + pow(10, uniform(s, 0, FARTHEST));
	const double along = uniform(s, 0, 6.3);
	const double off = sqrt((r - half) * (r + half));
	struct far f = {
		.to = { 2 * half * cos(along), 2 * half * sin(along) },
		.how = (enum interp_strategy)(rnd(s) % INTERP_NSTRATEGIES),
		.clockwise = rnd(s) % 2,
	};
	const double left = f.clockwise ? -off : off;

	f.centre[0] = half * cos(along) - left * sin(along);
	f.centre[1] = half * sin(along) + left * cos(along);
	return f;
}

static double from_circle(const struct far *f, const int32_t *pos)
{
	const double r = hypot(f->centre[0], f->centre[1]);

	return hypot(pos[0] - f->centre[0], pos[1] - f->centre[1]) - r;
}

static void check_walk(const struct far *f, const struct made *m, uint64_t *s)
{
	struct points p;
	struct interp_cursor c;

	for (uint32_t i = 0; i + 1 < m->p.head->nsegs; i++) {
		if (interp_cursor_init(&c, &m->p) != 0 ||
		    interp_cursor_seek(&c, i, 0) != 0)
			say(f, "taken, and not walked");
	}
	p = walk_all(m, 1);
	for (size_t i = 0; i < p.n; i++) {
		if (fabs(from_circle(f, p.at[i].pos)) > NEAR + TOLERANCE)
			say(f, "off its circle");
	}
	for (int a = 0; a < 2; a++) {
		if (fabs(p.at[p.n - 1].pos[a] - f->to[a]) > 0.51)
			say(f, "not at its end");
	}
	if (!wander(m, &p, s, 4))
		say(f, "another way back");
	points_free(&p);
}

static struct interp_build *begin_by(enum interp_strategy how)
{
	const struct interp_build_options o = {
		.machine = &help_machine, .strategy = how,
		.tolerance_milli = (uint32_t)(TOLERANCE * 1000),
	};

	interp_build_destroy(begin(how));
	return interp_build_create(&o);
}

/* Return: was it taken? */
static bool try_one(const struct far *f, uint64_t *s)
{
	struct interp_build_arc word = {
		.axis_a = INTERP_X, .axis_b = INTERP_Y,
		.centre_a_mm = f->centre[0] * 1e-3,
		.centre_b_mm = f->centre[1] * 1e-3,
	};
	const double end[INTERP_NAXES] = { f->to[0] * 1e-3, f->to[1] * 1e-3 };
	struct interp_build *b = begin_by(f->how);
	struct interp_diag d = { 0 };
	struct made m;

	arc_turn(&word, b, end, f->clockwise);
	if (interp_build_arc(b, end, &word, &help_word, &d) != 0) {
		assert_true(d.found[0] && d.wanted[0]);
		interp_build_destroy(b);
		return false;
	}
	m = finish(b);
	check_walk(f, &m, s);
	unmake(&m);
	return true;
}

static void a_short_arc_of_any_radius_is_walked_or_refused(void **st)
{
	uint64_t s = seed;
	int taken = 0;

	(void)st;
	for (int i = 0; i < ARCS; i++) {
		const struct far f = draw(&s);

		taken += try_one(&f, &s);
	}
	print_message("    %d of %d taken\n", taken, ARCS);
	assert_true(taken > ARCS / 2);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_short_arc_of_any_radius_is_walked_or_refused),
	};

	seed = seed_take();
	return cmocka_run_group_tests(tests, NULL, NULL);
}
