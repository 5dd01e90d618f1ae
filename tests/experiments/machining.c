/* SPDX-License-Identifier: Apache-2.0 */
/*
 * machining.c - the published machining times, beside a model of them
 *
 * The measured figures are those of tables 2 to 5 of the paper on the
 * main-direction perturbation algorithm (2025).
 */
#include "make_program.h"

static void change_point(const struct interp_cursor *c, void *arg)
{
	count_change(arg, c->moved);
}

static struct changes count(const int32_t to[INTERP_NAXES], struct how h)
{
	struct interp_build *b = build_as(h);
	struct changes t = { 0 };

	build_line(b, to);
	program_walk(b, change_point, &t);
	return t;
}

/* -- Tables 4 and 5: removal rate ----------------------------------------- */

#define RATE_ALONE	12.75		/* mm3/min, one axis */
#define VOLUME_2	598.125		/* mm3, two axes */
#define VOLUME_3	596.156
#define MINUTES_2	55.04		/* point-by-point, two axes, measured */

struct removal {
	const char *name;
	struct how h;
};

static const struct removal removals[] = {
	{ "point-by-point", { INTERP_POINT_BY_POINT, 0, INTERP_TREE } },
	{ "centred, tree", { INTERP_CENTRED, 0, INTERP_TREE } },
	{ "main-direction, mu 1, tree",
	  { INTERP_MAIN_DIRECTION, 1000, INTERP_TREE } },
	{ "main-direction, mu 5, tree",
	  { INTERP_MAIN_DIRECTION, 5000, INTERP_TREE } },
	{ "min-switch, mu 1.5, star",
	  { INTERP_MIN_SWITCH, 1500, INTERP_STAR } },
	{ "min-switch, mu 2, tree", { INTERP_MIN_SWITCH, 2000, INTERP_TREE } },
	{ "min-switch, mu 2, star", { INTERP_MIN_SWITCH, 2000, INTERP_STAR } },
	{ "min-switch, mu 5, star", { INTERP_MIN_SWITCH, 5000, INTERP_STAR } },
	{ "simultaneous", { INTERP_SIMULTANEOUS, 0, INTERP_STAR } },
};

static double rate(double volume, double changes, double tau_min)
{
	return volume / (volume / RATE_ALONE + tau_min * changes);
}

static void removal_row(const struct removal *r, double tau_min)
{
	static const int32_t two[INTERP_NAXES] = { 20000, 10000 };
	static const int32_t three[INTERP_NAXES] = { 17320, 10000, 10000 };
	const struct changes s2 = count(two, r->h), s3 = count(three, r->h);

	printf("| %s | %zu | %zu | %.2f | %.2f |\n", r->name, s2.n, s3.n,
	       rate(VOLUME_2, (double)s2.n, tau_min),
	       rate(VOLUME_3, (double)s3.n, tau_min));
}

static void removal_table(void)
{
	const double tau_min = (MINUTES_2 - VOLUME_2 / RATE_ALONE) / 20000;

	printf("\n## Removal rate, tables 4 and 5\n\nThe time is T = V/Q + "
	       "tau*S. V is the volume, Q = %g mm3/min is the rate with\none "
	       "axis alone, and S is the number of changes of axis on the net "
	       "path. tau =\n%.1f ms follows from one figure, the time of "
	       "point-by-point with two axes. From\nthis tau, the rate of "
	       "point-by-point with three axes follows within 1 %%. The\nrule "
	       "of the paper, as it is printed, has as many changes as "
	       "point-by-point. So\nit cannot give the published rates of "
	       "11.73 and 11.26, but half as many changes\nwould give them. "
	       "Rates are in mm3/min.\n\n| rule | S, two axes | S, three | "
	       "rate, two axes | rate, three |\n|---|---|---|---|---|\n| "
	       "measured, one axis | 0 | 0 | 12.75 | 12.75 |\n| measured, "
	       "point-by-point | | | 10.87 | 10.06 |\n| measured, the paper's "
	       "rule | | | 11.73 | 11.26 |\n",
	       RATE_ALONE, tau_min * 60000);
	printf("| half the changes of point-by-point | 10000 | 15000 | %.2f | "
	       "%.2f |\n", rate(VOLUME_2, 10000, tau_min),
	       rate(VOLUME_3, 15000, tau_min));
	for (size_t i = 0; i < COUNT(removals); i++)
		removal_row(&removals[i], tau_min);
}

/* -- Tables 2 and 3: time without sparks ---------------------------------- */

struct row {
	double mm[3];
	double linked_s, alone_s;	/* measured */
};

static const struct row rows[] = {
	{ { 30, 40 }, 2.14, 1.81 }, { { 60, 80 }, 4.28, 3.42 },
	{ { 50, 120 }, 5.38, 4.01 }, { { 80, 150 }, 6.67, 5.33 },
	{ { 200, 120 }, 9.12, 6.85 }, { { 280, 200 }, 12.92, 9.81 },
	{ { 30, 40, 50 }, 3.21, 2.52 }, { { 45, 45, 30.8 }, 3.76, 2.52 },
	{ { 60, 80, 100 }, 7.15, 3.84 }, { { 70, 90, 82.95 }, 5.81, 3.84 },
	{ { 100, 80, 100 }, 8.05, 4.78 }, { { 120, 60, 90.8 }, 6.67, 4.78 },
	{ { 80, 150, 170 }, 11.31, 7.01 },
	{ { 95, 130, 177.97 }, 9.44, 7.01 },
	{ { 200, 120, 100 }, 10.72, 7.26 },
	{ { 140, 160, 137 }, 12.18, 7.26 },
	{ { 120, 160, 200 }, 13.34, 8.02 },
};

#define TWO_AXES	6		/* rows of table 2 */

static double along(const struct row *r)
{
	return sqrt(r->mm[0] * r->mm[0] + r->mm[1] * r->mm[1] +
		    r->mm[2] * r->mm[2]);
}

static double around(const struct row *r)
{
	return r->mm[0] + r->mm[1] + r->mm[2];
}

struct fit {
	double s_mm, s;			/* time = s_mm * length + s */
};

/* Least squares over both columns of table 2. */
static struct fit fit_times(void)
{
	double n = 0, x = 0, y = 0, xx = 0, xy = 0;
	struct fit f;

	for (int i = 0; i < 2 * TWO_AXES; i++) {
		const struct row *r = &rows[i / 2];
		const double l = i % 2 ? along(r) : around(r);
		const double t = i % 2 ? r->alone_s : r->linked_s;

		n++;
		x += l;
		y += t;
		xx += l * l;
		xy += l * t;
	}
	f.s_mm = (n * xy - x * y) / (n * xx - x * x);
	f.s = (y - f.s_mm * x) / n;
	return f;
}

/* A pulse at a time takes as long as its pulses; else the path counts. */
static double time_s(const struct row *r, struct how h, struct fit f)
{
	const bool together = h.strategy == INTERP_SIMULTANEOUS;
	int32_t to[INTERP_NAXES] = { 0 };
	double mm;

	for (int i = 0; i < 3; i++)
		to[i] = (int32_t)lround(r->mm[i] * 1000);
	mm = (double)count(to, h).points * 0.001;
	return f.s_mm * (together ? along(r) : mm) + f.s;
}

static void efficiency_row(const struct row *r, struct fit f)
{
	printf("| %g, %g, %g | %.2f | %.1f |", r->mm[0], r->mm[1], r->mm[2],
	       r->linked_s, 100 * r->alone_s / r->linked_s);
	for (int s = INTERP_SIMULTANEOUS; s < INTERP_NSTRATEGIES; s++) {
		const struct how h = { (enum interp_strategy)s, 2000,
				       INTERP_STAR };
		const double t = time_s(r, h, f);

		printf(" %.2f (%.1f) |", t, 100 * (f.s_mm * along(r) + f.s) /
					    t);
	}
	printf("\n");
}

static void efficiency_table(void)
{
	const struct fit f = fit_times();

	printf("\n## Linkage efficiency, tables 2 and 3\n\nThe time is t = L/v "
	       "+ c, where 1/v = %.6f s/mm and c = %.3f s are fitted to the\n"
	       "twelve times of table 2. If the axes pulse one at a time, L is "
	       "the sum of all\npulses; if they pulse together, L is the "
	       "length of the path. The loss that the\npaper measured is the "
	       "ratio of the two, and no rule that moves one axis at a\ntime "
	       "can avoid it. The cells have seconds and, in brackets, the "
	       "efficiency in\n%%: a single axis that goes the same length has "
	       "100. mu is 2.\n\n| row, mm | measured s | measured %% |",
	       f.s_mm, f.s);
	for (int s = 0; s < INTERP_NSTRATEGIES; s++)
		printf(" %s |", interp_strategy_name((enum interp_strategy)s));
	printf("\n|---|---|---|");
	for (int s = 0; s < INTERP_NSTRATEGIES; s++)
		printf("---|");
	printf("\n");
	for (size_t i = 0; i < COUNT(rows); i++)
		efficiency_row(&rows[i], f);
}

int main(void)
{
	removal_table();
	efficiency_table();
	return 0;
}
