/* SPDX-License-Identifier: Apache-2.0 */
/* geometry.c - error maps, estimates of the contour error, and the pictures */
#include "contour_try.h"
#include "interp/errormap.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define COUNT(x)	(sizeof(x) / sizeof((x)[0]))

/* -- Error maps ----------------------------------------------------------- */

/* A worn machine: pitch, straightness, a lean, and 3 K of growth. */
static void worn(struct interp_errormap *m, double part)
{
	*m = (struct interp_errormap) { .nrows = 3, .nleans = 1 };
	for (int r = 0; r < 3; r++) {
		m->row[r] = (struct interp_errormap_row) {
			.along = r == 1, .across = r > 0, .n = 41,
		};
		m->row[r].across = r == 2 ? 1 : r == 1;
		for (int i = 0; i < 41; i++) {
			m->row[r].at_mm[i] = -100 + i * 5;
			m->row[r].error_mm[i] = part *
						(r == 2 ? 0.004 : 0.012) *
						sin(i * (r == 2 ? 0.15 : 0.35) +
						    r);
		}
	}
	m->lean[0] = (struct interp_errormap_lean) { 0, 1, part * 500e-6 };
	for (int i = 0; i < 2; i++)
		m->growth[i] = (struct interp_errormap_growth) {
			11.5e-6, 0, part * 3
		};
}

/* Where the tool is when the encoders say @mm. */
static void tool_at(const struct interp_errormap *m, const double *mm,
		    double *ret)
{
	double error[INTERP_NAXES];

	interp_errormap_error(m, mm, error);
	for (int i = 0; i < INTERP_NAXES; i++)
		ret[i] = mm[i] + error[i];
}

static void map_set(struct bench *b, const struct interp_errormap *m)
{
	const long from = -INTERP_COMPENSATE_BEHIND;
	const long to = (long)b->feed->n + INTERP_COMPENSATE_AHEAD;

	for (long i = from; i < to; i++) {
		double place[INTERP_NAXES] = { b->set[0][i], b->set[1][i] };
		double add[INTERP_NAXES];

		interp_errormap_apply(m, place, add);
		for (int k = 0; k < 2; k++)
			b->set[k][i] += add[k];
	}
}

/* Largest and mean contour error of the tool. */
static struct interp_trial_result tool_run(struct bench *b,
					   const struct interp_errormap *true_m)
{
	double (*is)[INTERP_NAXES] = must(calloc(b->trial.n, sizeof(*is)));
	struct interp_trial_result r = { 0 };
	struct interp_contour foot;

	b->trial.actual_mm = is;
	bench_run(b);
	interp_contour_begin(&foot, b->trial.path, b->trial.path->u_min, 0.02);
	for (size_t i = 0; i < b->trial.n; i++) {
		struct interp_contour_error e;
		double tool[INTERP_NAXES];

		tool_at(true_m, is[i], tool);
		interp_contour_step(&foot, tool, b->feed->u[i], &e);
		r.max_mm = fmax(r.max_mm, e.mm);
		r.mean_mm += e.mm / (double)b->trial.n;
	}
	free(is);
	return r;
}

void table_maps(struct speeds *s)
{
	static const char *const methods[] = { "none", "feedforward", "zpetc" };
	static const double parts[] = { 0, 0.8, 1 };

	printf("## Geometric errors\n\nThe largest and the mean contour error "
	       "of the tool, um, at 1000 mm/min. The\nreal machine has pitch "
	       "errors of 12 um, straightness errors of 4 um, axes that\nare "
	       "500 urad out of square, and is 3 K too warm.\n\n| method | no "
	       "map | a map of 80 %% | the whole map |\n|---|---|---|---|\n");
	for (size_t i = 0; i < COUNT(methods); i++) {
		printf("| %s |", methods[i]);
		for (size_t k = 0; k < COUNT(parts); k++) {
			struct interp_errormap m, is;
			struct interp_trial_result r;
			struct bench b;

			worn(&is, 1);
			worn(&m, parts[k]);
			bench_make(&b, &s->feed[1], true);
			b.config.methods = (uint32_t)
				interp_compensate_parse(methods[i]);
			map_set(&b, &m);
			r = tool_run(&b, &is);
			printf(" %.1f / %.2f |", r.max_mm * 1e3,
			       r.mean_mm * 1e3);
			bench_free(&b);
		}
		printf("\n");
	}
	printf("\n");
}

/* -- Estimates ------------------------------------------------------------ */

/* Following error square to the tangent at the set values. */
static double tangent_mm(const struct feed *f, size_t i, const double *is)
{
	double d[3][2], e[2];

	spline_at(f->curve, f->u[i], d);
	for (int k = 0; k < 2; k++)
		e[k] = is[k] - d[0][k];
	return fabs(d[1][0] * e[1] - d[1][1] * e[0]) /
	       hypot(d[1][0], d[1][1]);
}

static double chord_mm(const struct feed *f, size_t j, const double *is)
{
	double d[2], e[2], part;

	for (int k = 0; k < 2; k++) {
		d[k] = f->mm[k][j + 1] - f->mm[k][j];
		e[k] = is[k] - f->mm[k][j];
	}
	part = (d[0] * e[0] + d[1] * e[1]) /
	       fmax(d[0] * d[0] + d[1] * d[1], 1e-18);
	part = fmin(fmax(part, 0), 1);
	return hypot(e[0] - part * d[0], e[1] - part * d[1]);
}

/* The nearest of all chords near the set values, looked for one by one. */
static double nearest_mm(const struct feed *f, size_t i, const double *is)
{
	const size_t from = i > 120 ? i - 120 : 0;
	double least = INFINITY;

	for (size_t j = from; j <= i; j++)
		least = fmin(least, chord_mm(f, j, is));
	return least;
}

void table_foot(struct speeds *s)
{
	printf("## Estimates of the contour error\n\nWithout compensation. The "
	       "cells tell how far each estimate is from the nearest\npoint of "
	       "the last 120 ms of the path, um, largest and mean. The foot is "
	       "wrong\nonly at tips, where the nearest point is on the branch "
	       "that was left already.\n\n| mm/min | tangent at the set values "
	       "| foot |\n|---|---|---|\n");
	for (int v = 0; v < 3; v++) {
		struct feed *f = &s->feed[v];
		double (*is)[INTERP_NAXES] = must(calloc(f->n, sizeof(*is)));
		double (*e)[INTERP_NAXES] = must(calloc(f->n, sizeof(*e)));
		double most[2] = { 0 }, sum[2] = { 0 };
		struct bench b;

		bench_make(&b, f, false);
		b.trial.actual_mm = is;
		b.trial.error_mm = e;
		bench_run(&b);
		for (size_t i = 0; i < f->n; i++) {
			const double is_mm = nearest_mm(f, i, is[i]);
			const double off[2] = {
				fabs(tangent_mm(f, i, is[i]) - is_mm),
				fabs(hypot(e[i][0], e[i][1]) - is_mm),
			};

			for (int k = 0; k < 2; k++) {
				most[k] = fmax(most[k], off[k]);
				sum[k] += off[k] / (double)f->n;
			}
		}
		printf("| %g | %.1f / %.2f | %.1f / %.3f |\n", speed_mm_min[v],
		       most[0] * 1e3, sum[0] * 1e3, most[1] * 1e3,
		       sum[1] * 1e3);
		bench_free(&b);
		free(is);
		free(e);
	}
	printf("\n");
}

/* -- Pictures ------------------------------------------------------------- */

#define MAGNIFIED	20

static const struct {
	const char *title, *methods;
} drawn[] = {
	{ "none", "none" },
	{ "feedforward", "feedforward" },
	{ "feedforward, cross-coupled", "feedforward+cross-coupled" },
};

static FILE *plot_open(const char *folder, const char *name, const char *size)
{
	FILE *p = popen("gnuplot", "w");

	if (!p) {
		fputs("gnuplot does not run\n", stderr);
		exit(1);
	}
	fprintf(p,
		"set terminal svg size %s font 'sans,12' "
		"background 'white'\nset output '%s/%s'\nset grid lc '#dddddd'\n"
		"set style line 1 lc '#d55e00'\nset style line 2 lc '#0072b2'\n"
		"set style line 3 lc '#009e73'\n",
		size, folder, name);
	return p;
}

static void draw_errors(struct speeds *s, const char *folder)
{
	struct feed *f = &s->feed[1];
	double (*e)[INTERP_NAXES] = must(calloc(f->n, sizeof(*e)));
	FILE *p = plot_open(folder, "contour-error.svg", "900,420");

	for (size_t m = 0; m < COUNT(drawn); m++) {
		struct bench b;

		bench_make(&b, f, true);
		b.config.methods = (uint32_t)
			interp_compensate_parse(drawn[m].methods);
		b.trial.error_mm = e;
		bench_run(&b);
		fprintf(p, "$m%zu << EOD\n", m);
		for (size_t i = 0; i < f->n; i += 20) {
			double most = 0;

			for (size_t j = i; j < i + 20 && j < f->n; j++)
				most = fmax(most, hypot(e[j][0], e[j][1]));
			fprintf(p, "%g %g\n", (double)i * PERIOD_S,
				fmax(most * 1e3, 0.01));
		}
		fprintf(p, "EOD\n");
		bench_free(&b);
	}
	fprintf(p, "set logscale y\nset xlabel 'time, s'\n"
		"set ylabel 'contour error, um'\nset yrange [0.05:400]\n"
		"set key above\nplot ");
	for (size_t m = 0; m < COUNT(drawn); m++)
		fprintf(p, "$m%zu with lines ls %zu title '%s'%s", m, m + 1,
			drawn[m].title, m + 1 < COUNT(drawn) ? ", " : "\n");
	pclose(p);
	free(e);
}

static void draw_path(struct speeds *s, const char *folder)
{
	struct feed *f = &s->feed[1];
	double (*e)[INTERP_NAXES] = must(calloc(f->n, sizeof(*e)));
	double *u = must(calloc(f->n, sizeof(*u)));
	FILE *p = plot_open(folder, "contour-path.svg", "900,700");

	fprintf(p, "$path << EOD\n");
	for (size_t i = 0; i < f->n; i += 10)
		fprintf(p, "%g %g\n", f->mm[0][i], f->mm[1][i]);
	fprintf(p, "EOD\n");
	for (size_t m = 0; m < COUNT(drawn); m += 2) {
		struct bench b;

		bench_make(&b, f, true);
		b.config.methods = (uint32_t)
			interp_compensate_parse(drawn[m].methods);
		b.trial.error_mm = e;
		b.trial.u = u;
		bench_run(&b);
		fprintf(p, "$m%zu << EOD\n", m);
		for (size_t i = 0; i < f->n; i += 10) {
			double d[3][2];

			spline_at(f->curve, u[i], d);
			fprintf(p, "%g %g\n", d[0][0] - MAGNIFIED * e[i][0],
				d[0][1] - MAGNIFIED * e[i][1]);
		}
		fprintf(p, "EOD\n");
		bench_free(&b);
	}
	fprintf(p, "set size ratio -1\nset key above\nset xlabel 'X, mm'\n"
		"set ylabel 'Y, mm'\nplot $m0 with lines ls 1 title "
		"'none, error magnified %d times', $m2 with lines ls 3 lw 2 "
		"title 'feedforward, cross-coupled, the same', $path with "
		"lines lc 'black' dt 2 title 'path'\n", MAGNIFIED);
	pclose(p);
	free(e);
	free(u);
}

void draw(struct speeds *s, const char *folder)
{
	draw_errors(s, folder);
	draw_path(s, folder);
}
