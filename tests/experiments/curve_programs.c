/* SPDX-License-Identifier: Apache-2.0 */
/*
 * curve_programs.c - curves in programs: there and back, and how large
 *
 *	curve_programs examples/blade.ngc
 *	curve_programs lines examples/blade.ngc 0.001	its curve as G1 lines
 */
#include "interp/nc.h"
#include "tried/nurbs_step.h"
#include "make_program.h"

#include <stdint.h>

#define POINTS		16
#define TEXT_MAX	(1 << 20)

/* -- A closed path of six axes -------------------------------------------- */

struct closed {
	double knots[POINTS + 6], points[POINTS * 7];
	struct interp_nurbs c;
};

/* Ends where it begins, in the same direction. */
static void closed_set(struct closed *k, uint32_t degree)
{
	static const double reach[] = { 8, 6, 3, 12, 9, 25 };

	k->c = (struct interp_nurbs) { degree, 6, POINTS, 3, 0, k->knots,
				       k->points };
	for (uint32_t i = 0; i < POINTS + degree + 1; i++)
		k->knots[i] = i <= degree ? 0 : i >= POINTS ? 1 :
			      (i - degree) / (double)(POINTS - degree);
	for (uint32_t i = 0; i < POINTS; i++) {
		const double a = 6.283185307179586 * i / (POINTS - 1);
		const double w = i % (POINTS - 1) ? 1 + 0.5 * (i % 3) : 1;

		for (uint32_t j = 0; j < 6; j++)
			k->points[7 * i + j] = w * reach[j] *
					       sin((1 + j % 2) * a + j);
		k->points[7 * i + 6] = w;
	}
}

struct trail {
	int32_t (*pos)[INTERP_NAXES];
	size_t n, room, i;
	size_t off;
};

static void trail_add(struct trail *t, const struct interp_cursor *c)
{
	if (t->n == t->room) {
		t->room = t->room ? 2 * t->room : 65536;
		t->pos = realloc(t->pos, t->room * sizeof(*t->pos));
		if (!t->pos)
			abort();
	}
	memcpy(t->pos[t->n++], c->pos, sizeof(c->pos));
}

static void walk_both_ways(struct interp_build *b, struct trail *t,
			   double *ret_deviation_mm)
{
	const struct interp_build_about about = { .lines = 1 };
	size_t bytes;
	void *block = interp_build_take(b, &about, &bytes);
	struct interp_deviation d = { 0 };
	struct interp_program p;
	struct interp_cursor c;

	if (!block || interp_program_map(&p, block, bytes) < 0 ||
	    interp_cursor_init(&c, &p) < 0)
		abort();
	trail_add(t, &c);
	interp_cursor_aim(&c, 1e9);
	while (interp_cursor_step(&c) == INTERP_MOVED) {
		trail_add(t, &c);
		if (t->n % 11 == 0 && c.seg.kind == INTERP_CURVE)
			*ret_deviation_mm = fmax(*ret_deviation_mm,
				interp_cursor_deviation_mm(&c, &d));
	}
	/* Back by steps of another length. */
	t->i = t->n - 1;
	while (t->i > 0) {
		interp_cursor_aim(&c, -0.0137);
		while (interp_cursor_step(&c) == INTERP_MOVED && t->i > 0)
			t->off += memcmp(c.pos, t->pos[--t->i],
					 sizeof(c.pos)) != 0;
		if (interp_cursor_place_mm(&c) <= 0)
			break;
	}
	t->off += t->i;
	free(block);
}

static void print_closed(enum interp_strategy strategy, uint32_t degree)
{
	const struct how how = { .strategy = strategy, .milli = 2000 };
	struct interp_build_curve bc = { .axis = { 0, 1, 2, 3, 4, 5 } };
	double deviation_mm = 0, start[INTERP_NAXES] = { 0 };
	struct interp_diag d = { .found = "" };
	struct trail t = { 0 };
	struct interp_build *b = build_as(how);
	struct closed k;

	closed_set(&k, degree);
	bc.nurbs = k.c;
	for (int i = 0; i < 6; i++)
		start[i] = k.points[i];
	must(interp_build_line(b, start, &word, &d), &d);
	must(interp_build_curve(b, &bc, &word, &d), &d);
	walk_both_ways(b, &t, &deviation_mm);
	interp_build_destroy(b);
	printf("| %s | %u | %zu | %zu | %.3f |\n",
	       interp_strategy_name(strategy), degree, t.n, t.off,
	       deviation_mm * 1000);
	free(t.pos);
}

/* -- A blade's section, as a curve and as lines --------------------------- */

static struct interp_build *compile(const char *text, size_t bytes)
{
	static const struct interp_build_options bo = { .machine = &machine };
	const struct interp_nc_options o = { .machine = &machine };
	struct interp_build *b = interp_build_create(&bo);
	struct interp_nc_result done;
	struct interp_diag d = { .found = "" };

	must(interp_nc_compile(&(struct interp_text) {
		.at = text, .bytes = bytes }, &o, b, &done, &d), &d);
	return b;
}

static void print_size(const char *what, size_t text, struct interp_build *b,
		       const size_t whole[2])
{
	const size_t bytes = interp_build_bytes(b);

	printf("| %s | %zu | %.3f | %zu | %.3f |\n", what, text,
	       (double)text / (double)whole[0], bytes,
	       (double)bytes / (double)whole[1]);
	interp_build_destroy(b);
}

/* The curve of @p as lines, each as long as @error_mm lets it be. */
static size_t lines_of(const struct interp_program *p, double error_mm,
		       char *text)
{
	struct interp_nurbs_stepper s;
	struct interp_nurbs c;
	size_t n;

	if (!interp_program_curve(p, 0, &c))
		abort();
	interp_nurbs_stepper_init(&s, &c, interp_nurbs_first(&c),
				  INTERP_NURBS_PREDICTOR_CORRECTOR);
	s.chord_error_mm = error_mm;
	n = (size_t)sprintf(text, "G21 G90 G17 F300\nG0 X%.4f Y%.4f\n",
			    s.p.d[0][0], s.p.d[0][1]);
	while (!interp_nurbs_step(&s, 10).ended && n < TEXT_MAX - 64)
		n += (size_t)sprintf(text + n, "G1 X%.4f Y%.4f\n",
				     s.p.d[0][0], s.p.d[0][1]);
	return n + (size_t)sprintf(text + n, "G1 X%.4f Y%.4f\n", s.p.d[0][0],
				   s.p.d[0][1]);
}

struct blade {
	char text[TEXT_MAX];
	size_t n;
	void *block;
	struct interp_program p;
};

static void read_blade(struct blade *ret, const char *path)
{
	const struct interp_build_about about = { .lines = 1 };
	FILE *f = fopen(path, "rb");
	struct interp_build *b;
	size_t bytes;

	ret->n = f ? fread(ret->text, 1, sizeof(ret->text), f) : 0;
	if (ret->n == 0) {
		fprintf(stderr, "experiment: cannot read %s\n", path);
		exit(1);
	}
	fclose(f);
	b = compile(ret->text, ret->n);
	ret->block = interp_build_take(b, &about, &bytes);
	interp_program_map(&ret->p, ret->block, bytes);
	interp_build_destroy(b);
}

/* Its curve alone, as lines. */
static int print_lines(const char *path, double error_mm)
{
	static char lines[TEXT_MAX];
	static struct blade blade;

	read_blade(&blade, path);
	lines_of(&blade.p, error_mm, lines);
	fputs(lines, stdout);
	free(blade.block);
	return 0;
}

static void print_blade(const char *path)
{
	static const double errors_mm[] = { 0.001, 0.0005, 0.0001 };
	static char lines[TEXT_MAX];
	static struct blade blade;

	read_blade(&blade, path);
	for (size_t i = 0; i < COUNT(errors_mm); i++) {
		const size_t m = lines_of(&blade.p, errors_mm[i], lines);
		struct interp_build *l = compile(lines, m);
		const size_t whole[2] = { m, interp_build_bytes(l) };
		char what[64];

		snprintf(what, sizeof(what), "lines, %g um off",
			 errors_mm[i] * 1000);
		print_size(what, m, l, whole);
		snprintf(what, sizeof(what), "G6.2, beside those");
		print_size(what, blade.n, compile(blade.text, blade.n), whole);
	}
	free(blade.block);
}

int main(int argc, char **argv)
{
	machine_set();
	if (argc == 4 && strcmp(argv[1], "lines") == 0)
		return print_lines(argv[2], atof(argv[3]));
	printf("\n## A closed path of six axes\n\nX Y Z A B C go from 0 to a "
	       "NURBS of 16 control points that ends where it\nbegins, and "
	       "then along it: forward at once, and back by 0.0137 mm at a "
	       "time.\n*Differ* is how many points of the way back are not "
	       "points of the way there.\n*Deviation* is the greatest distance "
	       "of X Y Z from the curve.\n\n| strategy | degree | points | "
	       "differ | deviation, most um |\n|---|---|---|---|---|\n");
	for (uint32_t degree = 3; degree <= 5; degree += 2) {
		print_closed(INTERP_SIMULTANEOUS, degree);
		print_closed(INTERP_POINT_BY_POINT, degree);
		print_closed(INTERP_CENTRED, degree);
		print_closed(INTERP_MAIN_DIRECTION, degree);
		print_closed(INTERP_MIN_SWITCH, degree);
	}
	printf("\n## A blade's section\n\nThe table compares "
	       "`examples/blade.ngc` with its curve as G1 lines. Each line\nis "
	       "as long as the chord error allows.\n\n| written as | text, "
	       "bytes | share | program, bytes | share |\n"
	       "|---|---|---|---|---|\n");
	print_blade(argc > 1 ? argv[1] : "examples/blade.ngc");
	return 0;
}
