/* SPDX-License-Identifier: Apache-2.0 */
/*
 * script.c - the sheet: where each panel lies and what it draws
 *
 * Left the path and, below it, three jumps in detail; right the place, gap
 * voltage, feed and states over one common time.
 */
#include "script.h"

#include <math.h>
#include <string.h>

#define LEFT	"0.055", "0.375"	/* of the sheet, from the left */
#define RIGHT	"0.455", "0.885"

const char *const script_colour[CSV_NSTATES] = {
	[CSV_IDLE]	= "#d8d8d8",
	[CSV_TRAVEL]	= "#999999",
	[CSV_APPROACH]	= "#009e73",
	[CSV_ERODE]	= "#0072b2",
	[CSV_RETRACT]	= "#d55e00",
	[CSV_JUMP]	= "#e69f00",
	[CSV_HOLD]	= "#cc79a7",
	[CSV_FAULT]	= "#000000",
	[CSV_JOG]	= "#56b4e9",
	[CSV_HOME]	= "#f0e442",
	[CSV_PROBE]	= "#8c564b",
};

double script_mark_size(size_t n)
{
	return n <= 30 ? 1.3 : n <= 120 ? 0.9 : 0.6;
}

struct time_unit {
	const char *name;
	double s;
};

static struct time_unit time_unit(double span_s)
{
	if (span_s > 3 * 3600)
		return (struct time_unit) { "h", 3600 };
	if (span_s > 600)
		return (struct time_unit) { "min", 60 };
	return (struct time_unit) { "s", 1 };
}

/* In single quotes gnuplot knows one escape: the quote, doubled. */
static void write_quoted(FILE *f, const char *s)
{
	fputc('\'', f);
	for (; *s; s++) {
		if (*s == '\'')
			fputc('\'', f);
		fputc((unsigned char)*s < ' ' ? ' ' : *s, f);
	}
	fputc('\'', f);
}

static void write_head(FILE *f, bool svg)
{
	if (svg)
		fputs("set terminal svg size 1600,1100 dynamic "
		      "font 'DejaVu Sans,13' background '#ffffff'\n", f);
	else
		fputs("set terminal pngcairo size 1600,1100 "
		      "font 'DejaVu Sans,11' background '#ffffff'\n", f);
	fputs("set encoding utf8\n"
	      "set border lw 0.8 lc rgb '#606060'\n"
	      "set tics nomirror out scale 0.6 textcolor rgb '#303030'\n"
	      "set grid lc rgb '#e4e4e4' lt 1 lw 0.6\n"
	      "set key noenhanced\n", f);
}

static void write_title(FILE *f, const struct thin *t,
			const struct plot_options *o)
{
	const struct thin_survey *s = &t->survey;
	const char *name = strrchr(o->trace, '/');

	fputs("set multiplot\nset label 1 ", f);
	write_quoted(f, o->title ? o->title : name ? name + 1 : o->trace);
	fputs(" at screen 0.02,0.972 left noenhanced "
	      "font ',17' front\n", f);
	fprintf(f, "set label 2 '%.1f s,  farthest %.3f mm,  jumps: %zu,  "
		"retracts: %zu,  %lu records' at screen 0.98,0.972 right "
		"font ',12' tc rgb '#404040'\n", s->t_max - s->t_min,
		s->s_max, s->jumps.n, s->retracts.n, s->rows);
}

struct panel {
	const char *left, *right;
	double bottom, top;		/* of the sheet */
	double name_at;			/* height of its name */
	const char *name;
};

static void write_panel(FILE *f, const struct panel *p)
{
	fprintf(f, "set lmargin at screen %s\nset rmargin at screen %s\n"
		"set bmargin at screen %.3f\nset tmargin at screen %.3f\n"
		"set label 3 '%s' at screen %s,%.3f left font ',13' front\n",
		p->left, p->right, p->bottom, p->top, p->name, p->left,
		p->name_at);
}

/* A key of several columns under the name of a panel on the left. */
static void key_below(FILE *f, double name_at)
{
	fprintf(f, "set key at screen 0.05,%.3f left top horizontal "
		"Left reverse maxrows 2 samplen 2 width -1 font ',10'\n",
		name_at - 0.012);
}

/* The labels of the sheet are drawn with the first panel only. */
static void write_reset(FILE *f)
{
	fputs("unset label\nset autoscale\nunset xlabel\nunset ylabel\n"
	      "set size noratio\nset format '%g'\n"
	      "set xtics auto offset 0,0\nset ytics auto offset 0,0\n"
	      "set border 3 lw 0.8 lc rgb '#606060'\n", f);
}

static void panel_path(FILE *f, const struct thin *t)
{
	bool zoom = t->nzoom > 0;

	write_panel(f, &(struct panel) { LEFT, zoom ? 0.46 : 0.10, 0.845,
					 0.920, "Path" });
	key_below(f, 0.920);
	path_write(f, t);
	write_reset(f);
}

static void panel_zoom(FILE *f, const struct thin *t)
{
	const struct thin_survey *s = &t->survey;
	unsigned long seen = 0;

	if (t->nzoom == 0)
		return;
	for (size_t i = 0; i < t->nzoom; i++)
		if (t->zoom[i].place.n)
			seen |= 1ul << t->zoom[i].state;
	write_panel(f, &(struct panel) { LEFT, 0.065, 0.325, 0.378,
			s->jumps.n > 2 ? "Three jumps in detail" :
			s->jumps.n ? "A jump in detail" :
			"A retract in detail" });
	key_below(f, 0.378);
	fprintf(f, "set xrange [%.9g:%.9g]\nset xlabel 'time, s'\n"
		"set ylabel 'place along the path, mm'\nplot ",
		s->zoom_from_s, s->zoom_to_s);
	for (int i = 0, n = 0; i < CSV_NSTATES; i++)
		if (seen >> i & 1)
			fprintf(f, "%s$zoom%d with lines lw 2.4 lc rgb '%s' "
				"title '%s'", n++ ? ", \\\n  " : "", i,
				script_colour[i], csv_state_word[i]);
	fputc('\n', f);
	write_reset(f);
}

static void time_axis(FILE *f, const struct thin *t, struct time_unit u,
		      bool last)
{
	const struct thin_survey *s = &t->survey;
	double room = s->t_max > s->t_min ? 0 : 0.5;

	fprintf(f, "set xrange [%.9g:%.9g]\n", (s->t_min - room) / u.s,
		(s->t_max + room) / u.s);
	if (last)
		fprintf(f, "set format x '%%g'\nset xlabel 'time, %s'\n",
			u.name);
	else
		fputs("set format x ''\n", f);
	fputs("set key at graph 1.015,1 left top vertical Left reverse "
	      "maxrows auto maxcols auto samplen 1.5 width -2 font ',10'\n", f);
}

/* With a little room. */
static void write_range(FILE *f, double low, double high)
{
	double room = high > low ? 0.05 * (high - low) : 1;

	fprintf(f, "set yrange [%.9g:%.9g]\n", low < 0 ? low - room : low,
		high + room);
}

static void panel_place(FILE *f, const struct thin *t, struct time_unit u)
{
	const struct thin_survey *s = &t->survey;
	bool few = s->jumps.n <= SCRIPT_FEW;
	double low;

	write_panel(f, &(struct panel) { RIGHT, 0.665, 0.895, 0.920,
			s->cuts ? "Place along the path, from the first cut" :
			"Place along the path" });
	time_axis(f, t, u, false);
	low = s->cuts ? s->cut_min : s->s_min;
	write_range(f, low - 0.05 * (s->s_max - low), s->s_max);
	fprintf(f, "set ylabel 'mm'\n"
		"plot $place using 1:2:3 with filledcurves "
		"fc rgb '#f6dfae' title '%s', \\\n", few ? "swept" :
		"swept by jumps");
	if (few)
		fputs("  $place using 1:2 with lines lw 0.9 "
		      "lc rgb '#e69f00' notitle, \\\n", f);
	fputs("  $far with lines lw 2.2 lc rgb '#0072b2' "
	      "title 'farthest'", f);
	if (s->jumps.n && few)
		fprintf(f, ", \\\n  $jumps with points pt 6 ps 0.9 lw 1.3 "
			"lc rgb '%s' title 'jumps: %zu'",
			script_colour[CSV_JUMP], s->jumps.n);
	if (s->retracts.n)
		fprintf(f, ", \\\n  $retracts with points pt 9 ps %.1f "
			"lc rgb '%s' title 'retracts: %zu'",
			script_mark_size(s->retracts.n),
			script_colour[CSV_RETRACT], s->retracts.n);
	fputc('\n', f);
	write_reset(f);
}

static void write_level(FILE *f, const char *name, double v,
			const char *colour)
{
	if (v > 0)
		fprintf(f, ", \\\n  %.9g with lines lw 1.4 dt (8,5) "
			"lc rgb '%s' title '%s: %.4g V'", v, colour, name, v);
}

static void panel_gap(FILE *f, const struct thin *t, struct time_unit u,
		      const struct plot_options *o)
{
	struct thin_span v;
	char name[80];

	if (!t->survey.gap)
		return;
	thin_span_of(&v, t->gap, t->nbins);
	snprintf(name, sizeof(name), "Gap voltage%s, %.4g to %.4g V",
		 t->survey.cuts ? " while eroding" : "", v.min, v.max);
	write_panel(f, &(struct panel) { RIGHT, 0.445, 0.605, 0.630, name });
	time_axis(f, t, u, false);
	write_range(f, 0, fmax(v.high, 1.15 * o->open_v));
	fputs("set ylabel 'V'\n"
	      "plot $gap using 1:2:3 with filledcurves fc rgb '#cfe3f1' "
	      "title 'least to most', \\\n"
	      "  $gapmean with lines lw 1.6 lc rgb '#0072b2' "
	      "title 'mean'", f);
	write_level(f, "open", o->open_v, "#009e73");
	write_level(f, "servo", o->servo_v, "#202020");
	write_level(f, "short", o->short_v, "#d55e00");
	fputc('\n', f);
	write_reset(f);
}

static void panel_feed(FILE *f, const struct thin *t, struct time_unit u)
{
	struct thin_span v;
	char name[80];

	thin_span_of(&v, t->feed, t->nbins);
	snprintf(name, sizeof(name), "Feed%s, %.4g to %.4g mm/min",
		 t->survey.cuts ? " while eroding" : "", v.min * 60,
		 v.max * 60);
	write_panel(f, &(struct panel) { RIGHT, 0.235, 0.385, 0.410, name });
	time_axis(f, t, u, false);
	write_range(f, v.low * 60, v.high * 60);
	fputs("set ylabel 'mm/min'\nplot ", f);
	if (t->survey.jumps.n > SCRIPT_FEW)
		fprintf(f, "$feed using 1:(60*$2) with lines lw 1 "
			"lc rgb '#9ec5e3' title 'mean of %.2g s', \\\n  ",
			(t->survey.t_max - t->survey.t_min) /
			(double)t->nbins);
	fputs("$feedmean using 1:(60*$2) with lines lw 1.6 lc rgb '#0072b2' "
	      "title 'mean', \\\n"
	      "  0 with lines lw 0.8 lc rgb '#606060' notitle\n", f);
	write_reset(f);
}

static void panel_states(FILE *f, const struct thin *t, struct time_unit u)
{
	const struct thin_survey *s = &t->survey;
	bool first = true;

	write_panel(f, &(struct panel) { RIGHT, 0.065, 0.175, 0.200,
					 "Share of each state" });
	time_axis(f, t, u, true);
	fputs("set ylabel '%'\nset yrange [0:100]\nset ytics 50\nplot ", f);
	for (int i = CSV_NSTATES - 1; i >= 0; i--) {
		if (s->in_state[i] == 0)
			continue;
		fprintf(f, "%s$share using 1:%d:%d with filledcurves "
			"fc rgb '%s' title '%s: %.1f %%'",
			first ? "" : ", \\\n  ", i + 2, i + 3,
			script_colour[i], csv_state_word[i],
			100 * (double)s->in_state[i] / (double)s->rows);
		first = false;
	}
	fputc('\n', f);
	write_reset(f);
}

void script_write(FILE *f, const struct thin *t, const struct plot_options *o,
		  bool svg)
{
	struct time_unit u = time_unit(t->survey.t_max - t->survey.t_min);

	write_head(f, svg);
	data_write(f, t, u.s);
	write_title(f, t, o);
	panel_path(f, t);
	panel_zoom(f, t);
	panel_place(f, t, u);
	panel_gap(f, t, u, o);
	panel_feed(f, t, u);
	panel_states(f, t, u);
	fputs("unset multiplot\n", f);
}
