/* SPDX-License-Identifier: Apache-2.0 */
/* path.c - the panel of the path: from above, from a side, or in space */
#include "script.h"

#include <math.h>

/* Marks closer than this share of the path are one mark. */
#define MARK_SPACE	(1.0 / 150)

/* Up to three axes the picture is drawn in. */
struct view {
	int axis[3];
	int n;				/* that move; at least 2 are drawn */
};

static const char letter[] = "XYZABCUV";

static double range(const struct thin_survey *s, int axis)
{
	return s->axis_max[axis] - s->axis_min[axis];
}

/* The axes from @first to @last that move worth seeing, in their order. */
static bool view_of(struct view *v, const struct thin_survey *s, int first,
		    int last)
{
	double most = 0;

	v->n = 0;
	for (int a = first; a <= last; a++)
		most = fmax(most, range(s, a));
	for (int a = first; a <= last; a++)
		if (most > 0 && range(s, a) > most / 200 && v->n < 3)
			v->axis[v->n++] = a;
	if (v->n == 1) {
		/* A lone axis stands upright on a neighbour that rests. */
		v->axis[1] = v->axis[0];
		v->axis[0] = v->axis[1] == first ? first + 1 : first;
	}
	return v->n > 0;
}

/* The group that path length is counted in: X Y Z, else U V, else A B C. */
static void view_choose(struct view *v, const struct thin_survey *s)
{
	if (!view_of(v, s, 0, 2) && !view_of(v, s, 6, 7) &&
	    !view_of(v, s, 3, 5))
		*v = (struct view) { .axis = { 0, 1, 2 } };
}

static int columns(const struct view *v)
{
	return v->n == 3 ? 3 : 2;
}

static void write_point(FILE *f, const struct view *v, const double *axis_mm)
{
	for (int i = 0; i < columns(v); i++)
		fprintf(f, "%.7g ", axis_mm[v->axis[i]]);
	fputc('\n', f);
}

/* Pieces of one kind, each begun where the piece before it ended. */
static void write_pieces(FILE *f, const struct thin *t, const struct view *v,
			 bool cut)
{
	bool open = false;

	fprintf(f, "$path%d << EOD\n", cut);
	for (size_t i = 1; i < t->npath; i++) {
		if (t->path[i].cut == cut) {
			if (!open)
				write_point(f, v, t->path[i - 1].axis_mm);
			write_point(f, v, t->path[i].axis_mm);
		} else if (open) {
			fputs("\n\n", f);
		}
		open = t->path[i].cut == cut;
	}
	fputs("EOD\n", f);
}

static bool is_near(const struct thin_event *a, const struct thin_event *b,
		    double space_mm)
{
	return fabs(a->s_mm - b->s_mm) < space_mm;
}

static void write_marks(FILE *f, const struct thin *t, const struct view *v,
			const char *name, const struct thin_events *e)
{
	double space = (t->survey.s_max - t->survey.s_min) * MARK_SPACE;
	const struct thin_event *last = NULL;

	fprintf(f, "$%s << EOD\n", name);
	for (size_t i = 0; i < e->n; i++) {
		if (last && is_near(last, &e->at[i], space))
			continue;
		last = &e->at[i];
		write_point(f, v, last->axis_mm);
	}
	fputs("EOD\n", f);
}

static void write_ends(FILE *f, const struct thin *t, const struct view *v)
{
	fputs("$begin << EOD\n", f);
	write_point(f, v, t->path[0].axis_mm);
	fputs("EOD\n$end << EOD\n", f);
	write_point(f, v, t->path[t->npath - 1].axis_mm);
	fputs("EOD\n", f);
}

static const char *unit(int axis)
{
	return axis >= 3 && axis <= 5 ? "degree" : "mm";
}

/* Room about the path, and equal scales where they do not waste the panel. */
static void write_scales(FILE *f, const struct thin *t, const struct view *v)
{
	const struct thin_survey *s = &t->survey;
	double most = 0, least = INFINITY;

	for (int i = 0; i < columns(v); i++) {
		most = fmax(most, range(s, v->axis[i]));
		least = fmin(least, range(s, v->axis[i]));
	}
	for (int i = 0; i < columns(v); i++) {
		int a = v->axis[i];
		double room = fmax(range(s, a) * 0.06, most * 0.02);

		if (range(s, a) <= most / 200)
			room = most > 0 ? most / 2 : 1;
		fprintf(f, "set %crange [%.7g:%.7g]\nset %clabel '%c, %s'\n",
			"xyz"[i], s->axis_min[a] - room, s->axis_max[a] + room,
			"xyz"[i], letter[a], unit(a));
	}
	if (columns(v) == 3)
		fprintf(f, "set view 62, 38, 1, 1\nset xyplane 0\n"
		      "set lmargin at screen 0.100\n"
		      "set rmargin at screen 0.325\n"
		      "set bmargin at screen %.3f\n"
		      "set tmargin at screen %.3f\n"
		      "set zlabel rotate by 90 offset 0.2,0\n"
		      "set xlabel offset -1,-0.8\nset ylabel offset 1,-0.8\n"
		      "set xtics offset 0,-0.3\nset ytics offset 0,-0.3\n"
		      "set border 4095 lc rgb '#d0d0d0'\n",
			t->nzoom ? 0.515 : 0.30,
			t->nzoom ? 0.770 : 0.70);
	else if (least > most / 4)
		fputs("set size ratio -1\n", f);
}

static bool has_pieces(const struct thin *t, bool cut)
{
	for (size_t i = 1; i < t->npath; i++)
		if (t->path[i].cut == cut)
			return true;
	return false;
}

static void write_curves(FILE *f, const struct thin *t)
{
	const struct thin_survey *s = &t->survey;

	if (s->jumps.n)
		fprintf(f, "  $jumpsat with points pt 6 ps %.1f lw 1.3 "
			"lc rgb '%s' title 'jumps: %zu', \\\n",
			script_mark_size(s->jumps.n),
			script_colour[CSV_JUMP], s->jumps.n);
	if (s->retracts.n)
		fprintf(f, "  $retractsat with points pt 9 ps %.1f "
			"lc rgb '%s' title 'retracts: %zu', \\\n",
			script_mark_size(s->retracts.n),
			script_colour[CSV_RETRACT], s->retracts.n);
	if (has_pieces(t, false))
		fprintf(f, "  $path0 with lines lw 1.4 dt (6,4) lc rgb '%s' "
			"title 'positioned', \\\n", script_colour[CSV_TRAVEL]);
	if (has_pieces(t, true))
		fprintf(f, "  $path1 with lines lw 2.2 lc rgb '%s' "
			"title 'cut', \\\n", script_colour[CSV_ERODE]);
	fputs("  $begin with points pt 7 ps 1.3 lc rgb '#202020' "
	      "title 'start', \\\n"
	      "  $end with points pt 5 ps 1.2 lc rgb '#202020' "
	      "title 'farthest'\n", f);
}

void path_write(FILE *f, const struct thin *t)
{
	struct view v;

	view_choose(&v, &t->survey);
	write_pieces(f, t, &v, false);
	write_pieces(f, t, &v, true);
	write_marks(f, t, &v, "jumpsat", &t->survey.jumps);
	write_marks(f, t, &v, "retractsat", &t->survey.retracts);
	write_ends(f, t, &v);
	write_scales(f, t, &v);
	fprintf(f, "%s \\\n", columns(&v) == 3 ? "splot" : "plot");
	write_curves(f, t);
}
