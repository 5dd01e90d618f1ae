/* SPDX-License-Identifier: Apache-2.0 */
/*
 * axes.c - three and more axes by each coupling, and circles by each rule
 */
#include "interp/angle.h"
#include "make_program.h"

/* -- Lines in several axes ------------------------------------------------ */

struct line_tally {
	struct changes changes;
	const int32_t *to;
	int64_t sum, main;
	double share, axial, distance;	/* pulses, the worst */
};

static void line_point(const struct interp_cursor *c, void *arg)
{
	struct line_tally *t = arg;
	double r2 = 0, rd = 0, d2 = 0;
	int main = 0;

	count_change(&t->changes, c->moved);
	for (int i = 1; i < INTERP_NAXES; i++)
		main = t->to[i] > t->to[main] ? i : main;
	for (int i = 0; i < INTERP_NAXES; i++) {
		const double at = c->pos[i], to = t->to[i];

		t->share = fmax(t->share, fabs(at - to * c->tick /
					       c->seg.ticks));
		t->axial = fmax(t->axial, fabs(at - to * c->pos[main] /
					       t->to[main]));
		r2 += at * at;
		rd += at * to;
		d2 += to * to;
	}
	t->distance = fmax(t->distance, sqrt(fmax(r2 - rd * rd / d2, 0)));
}

static void line_row(const int32_t to[INTERP_NAXES], struct how h,
		     const char *name)
{
	struct interp_build *b = build_as(h);
	struct line_tally t = { .to = to };
	const bool together = h.strategy == INTERP_SIMULTANEOUS;

	build_line(b, to);
	program_walk(b, line_point, &t);
	printf("| %s | ", name);
	if (h.strategy >= INTERP_MAIN_DIRECTION)
		printf("%g", h.milli / 1000.0);
	if (together)
		printf(" | %zu | - | %.2f | - | ", t.changes.n, t.distance);
	else
		printf(" | %zu | %.2f | %.2f | %.2f | ", t.changes.n,
		       (double)t.changes.points / (double)(t.changes.n + 1),
		       t.distance, t.share);
	printf("%.2f |\n", t.axial);
}

static void line_table(const int32_t to[INTERP_NAXES])
{
	static const uint32_t mus[] = { 1500, 2000, 5000 };
	static const struct { struct how h; const char *name; } rows[] = {
		{ { INTERP_POINT_BY_POINT, 0, INTERP_TREE },
		  "point-by-point (tree)" },
		{ { INTERP_CENTRED, 0, INTERP_TREE }, "centred, tree" },
		{ { INTERP_CENTRED, 0, INTERP_STAR }, "centred, star" },
		{ { INTERP_SIMULTANEOUS, 0, INTERP_STAR }, "simultaneous" },
	};
	static const char *const names[] = {
		[INTERP_STAR] = "min-switch, star",
		[INTERP_TREE] = "min-switch, tree",
	};

	printf("\n### Totals");
	for (int i = 0; i < INTERP_NAXES; i++) {
		if (to[i] != 0)
			printf(" %d", to[i]);
	}
	printf("\n\n| rule | mu | changes | mean run | farthest from the line "
	       "| worst share | worst against the longest axis |\n"
	       "|---|---|---|---|---|---|---|\n");
	for (size_t i = 0; i < COUNT(rows); i++)
		line_row(to, rows[i].h, rows[i].name);
	for (size_t i = 0; i < COUNT(mus); i++)
		line_row(to, (struct how) { INTERP_MAIN_DIRECTION, mus[i],
					    INTERP_STAR },
			 "main-direction, star");
	for (int k = 0; k < INTERP_NCOUPLINGS; k++) {
		for (size_t i = 0; i < COUNT(mus); i++)
			line_row(to, (struct how) {
				INTERP_MIN_SWITCH, mus[i],
				(enum interp_coupling)k }, names[k]);
	}
}

/* -- Circles -------------------------------------------------------------- */

struct circle_tally {
	struct changes changes;
	int r;
	double lo, hi;
};

static void circle_point(const struct interp_cursor *c, void *arg)
{
	struct circle_tally *t = arg;
	const double off = hypot(c->pos[0], c->pos[1]) - t->r;

	if (c->seg.kind != INTERP_ARC)
		return;
	count_change(&t->changes, c->moved);
	t->lo = fmin(t->lo, off);
	t->hi = fmax(t->hi, off);
}

/* Clockwise from the axis, once round. */
static void circle_row(int r, struct how h)
{
	struct interp_build *b = build_as(h);
	const struct interp_build_arc arc = {
		.axis_a = INTERP_X, .axis_b = INTERP_Y, .sweep = -ANGLE_TURN,
	};
	const double end[INTERP_NAXES] = { r * 0.001 };
	const int32_t start[INTERP_NAXES] = { r };
	struct circle_tally t = { .r = r };
	struct interp_diag d = { .found = "" };

	build_line(b, start);
	must(interp_build_arc(b, end, &arc, &word, &d), &d);
	program_walk(b, circle_point, &t);
	printf("| %d | %s", r, interp_strategy_name(h.strategy));
	if (h.strategy == INTERP_MIN_SWITCH)
		printf(", mu %g", h.milli / 1000.0);
	printf(" | %zu | %.3f | %.3f | %zu |\n", t.changes.points, t.lo, t.hi,
	       t.changes.n);
}

static void circle_table(void)
{
	static const int radii[] = { 10, 100, 1000, 10000 };
	static const uint32_t mus[] = { 1000, 1500, 2000, 5000 };

	printf("\n## Circles\n\nEach circle is walked once, clockwise, and "
	       "begins on an axis. *Inward* and\n*outward* are the greatest "
	       "distances from the circle, in pulses.\n\n| radius | rule | "
	       "points | inward | outward | changes |\n"
	       "|---|---|---|---|---|---|\n");
	for (size_t i = 0; i < COUNT(radii); i++) {
		circle_row(radii[i], (struct how) { INTERP_POINT_BY_POINT, 0,
						    INTERP_STAR });
		circle_row(radii[i], (struct how) { INTERP_SIMULTANEOUS, 0,
						    INTERP_STAR });
		for (size_t j = 0; j < COUNT(mus); j++)
			circle_row(radii[i], (struct how) {
				INTERP_MIN_SWITCH, mus[j], INTERP_STAR });
	}
}

int main(void)
{
	static const int32_t lines[][INTERP_NAXES] = {
		{ 3000, 4000, 5000 },
		{ 5000, 4100, 2900, 1700, 600 },
		{ 5000, 4700, 3100, 1900, 800, 333 },
	};

	printf("\n## Three and more axes\n\nThe couplings are those of "
	       "`libinterp/core/pulse/couple.h`. *Share* is how far\nan axis "
	       "is from its part of the pulses that were given so far; a tree "
	       "keeps\nthis small. *Against the longest axis* is how far it is "
	       "from its part of the\npulses of the longest axis; a star keeps "
	       "this small. A change of axis is\ncounted where none "
	       "of the axes that have just moved moves again.\n");
	for (size_t i = 0; i < COUNT(lines); i++)
		line_table(lines[i]);
	circle_table();
	return 0;
}
