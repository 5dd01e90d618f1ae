/* SPDX-License-Identifier: Apache-2.0 */
/* test_threeb_round.c - random ISO code to 3B and back to ISO code */
#include "compile_help.h"

#define NCONTOURS	10000

/* Text that grows in place. */
struct text {
	char s[8192];
	size_t n;
};

__attribute__((format(printf, 2, 3)))
static void add(struct text *t, const char *format, ...)
{
	va_list ap;

	va_start(ap, format);
	t->n += (size_t)vsnprintf(t->s + t->n, sizeof(t->s) - t->n, format, ap);
	va_end(ap);
	assert_true(t->n < sizeof(t->s));
}

static double uniform(uint64_t *seed, double from, double to)
{
	return from + (to - from) * (nc_random(seed) / 2147483648.0);
}

/* Where a contour is, and the grid its points lie on. */
struct pen {
	double x, y;			/* mm */
	double grid_mm;
	double least_mm;		/* shorter ones are left out */
	uint64_t *seed;
};

static double on_grid(const struct pen *p, double v)
{
	return round(v / p->grid_mm) * p->grid_mm;
}

static void add_line(struct text *t, struct pen *p)
{
	const double size = pow(10, uniform(p->seed, -2, 1));
	const double dx = uniform(p->seed, -size, size);
	const double dy = uniform(p->seed, -size, size);
	const uint32_t axis = nc_random(p->seed) % 5;

	if (fabs(dx) < p->least_mm || fabs(dy) < p->least_mm)
		return;
	if (axis != 0)
		p->x = on_grid(p, p->x + dx);
	if (axis != 1)
		p->y = on_grid(p, p->y + (axis == 2 ? dx : dy));
	add(t, "G1 X%.6f Y%.6f\n", p->x, p->y);
}

static void add_arc(struct text *t, struct pen *p)
{
	const double r = pow(10, uniform(p->seed, -1.5, 1));
	const double from = uniform(p->seed, 0, 2 * M_PI);
	const bool cw = nc_random(p->seed) % 2,
		   full = nc_random(p->seed) % 8 == 0;
	const double sweep = (full ? 2 * M_PI : uniform(p->seed, .05, 6.2)) *
			     (cw ? -1 : 1);
	const double i = on_grid(p, -r * cos(from));
	const double j = on_grid(p, -r * sin(from));
	const double rr = hypot(i, j), f = atan2(-j, -i);

	if (rr == 0 || fabs(sweep) * rr < p->least_mm)
		return;
	if (!full) {
		const double x = on_grid(p, p->x + i + rr * cos(f + sweep));
		const double y = on_grid(p, p->y + j + rr * sin(f + sweep));

		if (x == p->x && y == p->y)
			return;
		add(t, "G%d X%.6f Y%.6f I%.6f J%.6f\n", cw ? 2 : 3, x, y, i, j);
		p->x = x;
		p->y = y;
	} else {
		add(t, "G%d X%.6f Y%.6f I%.6f J%.6f\n", cw ? 2 : 3, p->x, p->y,
		    i, j);
	}
}

static void random_contour(struct text *t, double grid_mm, uint64_t *seed)
{
	/* Between the pulses, what is short may round to nothing. */
	struct pen p = { 0, 0, grid_mm, grid_mm < .001 ? .005 : 0, seed };
	const uint32_t n = 1 + nc_random(seed) % 30;

	t->n = 0;
	add(t, "G90 F60\n");
	for (uint32_t k = 0; k < n; k++) {
		if (fabs(p.x) > 60 || fabs(p.y) > 60) {
			p.x = p.y = 0;
			add(t, "G1 X0 Y0\n");
		}
		if (nc_random(seed) % 2)
			add_line(t, &p);
		else
			add_arc(t, &p);
	}
	add(t, "G1 X0 Y0.5\n");
}

/* How far apart the ends of two programs were. */
struct spread {
	uint64_t ends, off, cut;	/* off: not the same pulse; cut: an arc
					 * became two */
	int worst;
};

static int off_pulses(const struct compiled *a, uint32_t i,
		      const struct compiled *b, uint32_t k)
{
	const int x = abs(compiled_pulse(a, i, INTERP_X) -
			  compiled_pulse(b, k, INTERP_X));
	const int y = abs(compiled_pulse(a, i, INTERP_Y) -
			  compiled_pulse(b, k, INTERP_Y));

	return x > y ? x : y;
}

/* An arc so short or flat that a line within a micrometre stands for it. */
static bool is_straight(const struct compiled *c, uint32_t i)
{
	const struct interp_seg *s = compiled_seg(c, i);
	const struct interp_arc *a = &c->p.arcs[s->arg];

	return s->kind == INTERP_LINE || s->length_mm < .005 ||
	       a->r_mm * (1 - cos(a->sweep / 2)) < .001;
}

/* Each segment of @a ends where one of @b does, in order; an arc may have
 * become two. */
static void compare(const struct compiled *a, const struct compiled *b,
		    struct spread *s)
{
	uint32_t k = 0;

	for (uint32_t i = 0; i < compiled_count(a); i++, k++) {
		int off = off_pulses(a, i, b, k);

		while (off > 1 && k + 1 < compiled_count(b) &&
		       compiled_seg(a, i)->kind == INTERP_ARC) {
			k++;
			s->cut++;
			off = off_pulses(a, i, b, k);
		}
		if (compiled_seg(a, i)->kind != compiled_seg(b, k)->kind &&
		    !is_straight(a, i))
			fail_msg("segment %u of line %u: now of another kind",
				 i, compiled_seg(a, i)->line);
		s->ends++;
		s->off += off > 0;
		s->worst = off > s->worst ? off : s->worst;
	}
	assert_int_equal(k, compiled_count(b));
}

static void round_trip(const char *text, double unit_um, struct spread *s)
{
	struct compiled iso = compile_ready("generic");
	struct compiled records = compile_ready("3b");
	struct compiled again = compile_ready("generic");
	struct emitted threeb = { 0 }, back = { 0 };

	compile(&iso, text);
	iso.o.threeb.unit_um = records.o.threeb.unit_um = unit_um;
	emit_threeb(&threeb, &iso);
	if (threeb.rc)
		fail_msg("%s\n%u: %s", text, threeb.diag.line,
			 threeb.diag.found);
	compile(&records, threeb.text);
	emit_iso(&back, &records);
	assert_int_equal(back.rc, 0);
	compile(&again, back.text);
	compare(&iso, &again, s);
	emit_done(&threeb);
	emit_done(&back);
	compile_done(&iso);
	compile_done(&records);
	compile_done(&again);
}

static struct spread round_trips(double grid_mm, double unit_um, uint64_t seed)
{
	static struct text t;
	struct spread s = { 0 };

	print_message("seed %llu\n", (unsigned long long)seed);
	for (int k = 0; k < NCONTOURS; k++) {
		random_contour(&t, grid_mm, &seed);
		round_trip(t.s, unit_um, &s);
	}
	print_message("%llu ends, %llu of them off, by %d pulses at most; "
		      "%llu arcs cut in two\n", (unsigned long long)s.ends,
		      (unsigned long long)s.off, s.worst,
		      (unsigned long long)s.cut);
	return s;
}

static void whole_micrometres_come_back_to_the_pulse(void **state)
{
	const struct spread s = round_trips(.001, 1, 2026);

	(void)state;
	assert_true(s.ends > 10 * NCONTOURS);
	assert_int_equal(s.off, 0);
}

/* Points between the pulses, rounded once on the way. */
static void places_between_pulses_come_back_to_the_nearest(void **state)
{
	const struct spread s = round_trips(.0001, 1, 31);

	(void)state;
	assert_int_equal(s.off, 0);
}

static void what_records_cannot_say_is_refused_with_its_line(void **state)
{
	static const struct {
		const char *text, *found;
	} cases[] = {
		{ "F60\nG1 X1\nZ1\n", "a line with a move of Z" },
		{ "F60\nG1 X1\nG2 X0 Y0 I-.5 J0 Z2\n", "an arc with a move" },
		{ "F60\nG1 X1\nG18 G2 X2 Z0 I.5 K0\n", "an arc" },
		{ "F60\nG1 X1\nX2 U1\n", "a line with a move of U" },
		{ "F60\nG1 X1\nX2 C9\n", "a line with a move of C" },
	};

	(void)state;
	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		struct compiled c = compile_ready("generic");
		struct emitted e = { 0 };

		compile(&c, cases[i].text);
		emit_threeb(&e, &c);
		assert_int_equal(e.rc, -EINVAL);
		assert_int_equal(e.diag.line, 3);
		assert_non_null(strstr(e.diag.found, cases[i].found));
		emit_done(&e);
		compile_done(&c);
	}
}

static void what_is_left_out_is_counted(void **state)
{
	struct compiled c = compile_ready("generic");
	struct emitted e = { 0 };

	(void)state;
	compile(&c, "F60 M3\nT84\nG0 X1\nE001 G1 X2\nG4 P1\nM1\nM0\nX3\nM2\n");
	emit_threeb(&e, &c);
	assert_int_equal(e.rc, 0);
	assert_string_equal(e.text, "B1000 B0 B1000 GX L1\n"
			    "B1000 B0 B1000 GX L1\nD\n"
			    "B1000 B0 B1000 GX L1\nDD\n");
	assert_int_equal(e.left.rapids, 1);
	assert_int_equal(e.left.outputs, 2);
	assert_int_equal(e.left.waits, 2);
	assert_int_equal(e.left.conditions, 1);
	emit_done(&e);
	compile_done(&c);
}

/* At 45 degrees: lines GY in 1 and 3, GX in 2 and 4; arcs the mirror of it. */
static void at_45_degrees_the_direction_is_fixed(void **state)
{
	struct compiled c = compile_ready("generic");
	struct emitted e = { 0 };

	(void)state;
	compile(&c, "G91 F60 G1 X1 Y1\nX-1 Y1\nX-1 Y-1\nX1 Y-1\n"
		"G3 X-2 Y0 I-1 J-1\nX0 Y-2 I1 J-1\nX2 Y0 I1 J1\nX0Y2I-1J1\n");
	emit_threeb(&e, &c);
	assert_int_equal(e.rc, 0);
	assert_string_equal(e.text,
			    "B1000 B1000 B1000 GY L1\n"
			    "B1000 B1000 B1000 GX L2\n"
			    "B1000 B1000 B1000 GY L3\n"
			    "B1000 B1000 B1000 GX L4\n"
			    "B1000 B1000 B828 GY NR1\n"
			    "B1000 B1000 B828 GX NR2\n"
			    "B1000 B1000 B828 GY NR3\n"
			    "B1000 B1000 B828 GX NR4\nDD\n");
	emit_done(&e);
	compile_done(&c);
}

/* ISO code of what records do not have: it is the same program again. */
static void iso_code_is_the_same_program_again(void **state)
{
	static const char text[] =
		"G21 F60 M3\nT84 C120\nG0 Z5\nG1 X1.0005 Y2 Z-.25 U3 C45 F30\n"
		"G2 X3 Y2 I1 J0 Z1\nG18 G3 X3 Z1 I-1 K0\nG19 G2 Y4 Z1 J1 K0\n"
		"E007 G1 A5 F90\nG4 P1.5\nM0\nM1\nT85 M5\nG0 X0 Y0\nM2\n";
	struct compiled a = compile_ready("generic");
	struct compiled b = compile_ready("generic");
	struct emitted e = { 0 };

	(void)state;
	compile(&a, text);
	emit_iso(&e, &a);
	assert_int_equal(e.rc, 0);
	compile(&b, e.text);
	assert_int_equal(compiled_count(&a), compiled_count(&b));
	for (uint32_t i = 0; i < compiled_count(&a); i++) {
		const struct interp_seg *s = compiled_seg(&a, i);
		const struct interp_seg *t = compiled_seg(&b, i);

		assert_int_equal(s->kind, t->kind);
		assert_int_equal(s->flags, t->flags);
		assert_near(s->feed_mm_s, t->feed_mm_s);
		assert_int_equal(a.p.conds[s->cond].letter,
				 b.p.conds[t->cond].letter);
		assert_int_equal(a.p.conds[s->cond].number,
				 b.p.conds[t->cond].number);
		if (s->kind == INTERP_ARC)
			assert_near(a.p.arcs[s->arg].sweep,
				    b.p.arcs[t->arg].sweep);
		else
			assert_int_equal(s->arg, t->arg);
		assert_same_end(&a, i, &b, i, 0);
	}
	emit_done(&e);
	compile_done(&a);
	compile_done(&b);
}

/* Ends and centres on each unit around: an end may be where a centre is. */
static void arcs_of_some_units_are_written(void **state)
{
	struct compiled c = compile_ready("generic");
	struct emitted e = { 0 };
	uint32_t written = 0;

	(void)state;
	for (int k = 0; k < 2 * 5 * 5 * 7 * 7; k++) {
		const int i = k / 2 % 5 - 2, j = k / 10 % 5 - 2;
		const int dx = k / 50 % 7 - 3, dy = k / 350 - 3;
		char text[200];

		snprintf(text, sizeof(text), "G17 F60\nG%d X%.3f Y%.3f I%.3f "
			 "J%.3f\n", 2 + k % 2, dx * .001, dy * .001, i * .001,
			 j * .001);
		compile_bytes(&c, text, strlen(text));
		if (c.rc == 0) {
			emit_threeb(&e, &c);
			assert_int_equal(e.rc, 0);
			written++;
		}
		emit_done(&e);
		compile_done(&c);
	}
	assert_true(written > 500);
}

/* The radius may be off by some pulses; the end is still the end. */
static void a_turn_of_two_radii_ends_where_it_should(void **state)
{
	struct compiled c = compile_ready("generic"), again;
	struct emitted e = { 0 };

	(void)state;
	compile(&c, "G17 F60\nG3 X0.003 Y0 I-4 J0\n");
	emit_threeb(&e, &c);
	again = compile_ready("3b");
	compile(&again, e.text);
	assert_same_end(&c, compiled_count(&c) - 1, &again,
			compiled_count(&again) - 1, 0);
	emit_done(&e);
	compile_done(&c);
	compile_done(&again);
}

/* What may lead 400 mm but ends at contact must not become a cut of 400 mm. */
static void a_move_until_contact_is_not_written(void **state)
{
	struct compiled c = compile_ready("generic");
	struct emitted e = { 0 };

	(void)state;
	compile(&c, "G1 X1 F60\nG80 X-\n");
	emit_threeb(&e, &c);
	assert_int_equal(e.rc, -EINVAL);
	assert_int_equal(e.diag.line, 2);
	assert_non_null(strstr(e.diag.found, "contact"));
	emit_done(&e);
	emit_iso(&e, &c);
	assert_int_equal(e.rc, -EINVAL);
	assert_non_null(strstr(e.diag.found, "contact"));
	emit_done(&e);
	compile_done(&c);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(whole_micrometres_come_back_to_the_pulse),
		cmocka_unit_test(places_between_pulses_come_back_to_the_nearest),
		cmocka_unit_test(what_records_cannot_say_is_refused_with_its_line),
		cmocka_unit_test(what_is_left_out_is_counted),
		cmocka_unit_test(at_45_degrees_the_direction_is_fixed),
		cmocka_unit_test(iso_code_is_the_same_program_again),
		cmocka_unit_test(arcs_of_some_units_are_written),
		cmocka_unit_test(a_turn_of_two_radii_ends_where_it_should),
		cmocka_unit_test(a_move_until_contact_is_not_written),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
