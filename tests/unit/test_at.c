/* SPDX-License-Identifier: Apache-2.0 */
/* test_at.c - the programmed point at a place is where the walk is */
#include "nc_read.h"

#include "interp/at.h"
#include "interp/cursor.h"

static const char JOB[] =
	"G21 G90 G17 F300\n"
	"G1 X1.0004 C7.0003\n"
	"G1 X3 Y-1.5\n"
	"G3 X5 Y0.5 I0 J2 Z0.7\n"
	"G2 X4 Y1.5 I0 J1\n"
	"G4 P0.1\n"
	"G6.2 P3 K0 X4 Y1.5\n"
	"K0 X6 Y5 R0.7\n"
	"K0 X9 Y1\n"
	"K1 X11 Y3\nK2\nK2\nK2\n"
	"G1 Z-1\n"
	"M2\n";

static void must_be_near(double a, double b, double eps)
{
	if (!(fabs(a - b) <= eps))
		fail_msg("%.9g is not %.9g", a, b);
}

/* Half a pulse on each axis is what the walk keeps to. */
static void look(const struct interp_cursor *c, struct interp_at_curve *last)
{
	const struct interp_program_head *h = c->p.head;
	const double d_mm = 1e-6;
	struct interp_contour_point at, before, after;

	if (!interp_program_at(&c->p, c->index, c->s_mm, last, &at)) {
		assert_true(c->seg.kind >= INTERP_BEGIN);
		return;
	}
	assert_true(interp_program_at(&c->p, c->index, c->s_mm - d_mm, last,
				      &before));
	assert_true(interp_program_at(&c->p, c->index, c->s_mm + d_mm, last,
				      &after));
	for (uint32_t j = 0; j < h->naxes; j++) {
		must_be_near(at.mm[j] / 0.001, c->pos[h->column[j]], 1.01);
		if (c->s_mm < 2 * d_mm ||
		    c->s_mm > c->seg.length_mm - 2 * d_mm)
			continue;
		must_be_near(at.per_u[j],
			     (after.mm[j] - before.mm[j]) / (2 * d_mm), 1e-3);
	}
}

static void it_is_where_the_walk_is_and_leads_where_it_goes(void **state)
{
	static struct interp_at_curve last;
	struct nc_read n = nc_ready();
	struct interp_cursor c;
	enum interp_step s = INTERP_MOVED;
	int kinds = 0;

	(void)state;
	nc_read(&n, JOB);
	assert_int_equal(interp_cursor_init(&c, &n.p), 0);
	while (s != INTERP_AT_END) {
		interp_cursor_aim(&c, 0.0137);
		while ((s = interp_cursor_step(&c)) == INTERP_MOVED)
			;
		look(&c, &last);
		kinds |= 1 << c.seg.kind;
		if (s == INTERP_AT_ACTION)
			interp_cursor_pass(&c);
	}
	assert_int_equal(kinds & 0xf, 1 << INTERP_LINE | 1 << INTERP_ARC |
				      1 << INTERP_CURVE);
	nc_done(&n);
}

/* From anywhere, by the place alone. */
static void the_whole_path_is_one_path(void **state)
{
	static struct interp_at_curve last;
	struct nc_read n = nc_ready();
	const struct interp_at_path w = { &n.p, &last };
	struct interp_contour_path path;
	struct interp_contour_point a, b;

	(void)state;
	nc_read(&n, JOB);
	assert_true(interp_program_path(&w, &path));
	assert_int_equal(path.naxes, n.p.head->naxes);
	for (int i = 0; i < 5000; i++) {
		const double u = path.u_max * i / 5000, d = path.u_max / 5000;
		double way = 0;

		path.at(path.arg, u, &a);
		path.at(path.arg, u + d, &b);
		for (int j = 0; j < path.naxes; j++)
			if (n.p.head->column[j] != INTERP_C)
				way += (a.mm[j] - b.mm[j]) *
				       (a.mm[j] - b.mm[j]);
		assert_true(sqrt(way) <= d * 1.001);
	}
	nc_done(&n);
}

static void what_does_not_move_has_no_point(void **state)
{
	static struct interp_at_curve last;
	struct nc_read n = nc_ready();
	const struct interp_at_path w = { &n.p, &last };
	struct interp_contour_path path;
	struct interp_contour_point at;

	(void)state;
	nc_read(&n, "G21\nG4 P1\nM2\n");
	assert_false(interp_program_path(&w, &path));
	for (uint32_t i = 0; i < n.p.head->nsegs + 2; i++)
		assert_false(interp_program_at(&n.p, i, 0, &last, &at));
	nc_done(&n);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(it_is_where_the_walk_is_and_leads_where_it_goes),
		cmocka_unit_test(the_whole_path_is_one_path),
		cmocka_unit_test(what_does_not_move_has_no_point),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
