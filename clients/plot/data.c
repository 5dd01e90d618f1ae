/* SPDX-License-Identifier: Apache-2.0 */
/* data.c - data blocks of the panels over time */
#include "script.h"

#include <math.h>

/* Marks closer than this share of the time are one mark. */
#define MARK_SPACE	(1.0 / 300)

static double bin_time(const struct thin *t, size_t i)
{
	const struct thin_survey *s = &t->survey;

	return s->t_min + (s->t_max - s->t_min) * ((double)i + 0.5) /
	       (double)t->nbins;
}

/*
 * Strips to take together: where jumps are many, a little more than from one
 * to the next, or strips with and without one would alternate.
 */
static size_t group_of(const struct thin *t)
{
	const struct thin_survey *s = &t->survey;

	if (s->jumps.n <= SCRIPT_FEW)
		return 1;
	return 2 + (size_t)(1.2 * (double)t->nbins / (double)s->jumps.n);
}

static struct thin_bin join(const struct thin_bin *bin, size_t n)
{
	struct thin_bin b = { 0 };

	for (size_t i = 0; i < n; i++) {
		if (bin[i].n == 0)
			continue;
		b.min = b.n ? fmin(b.min, bin[i].min) : bin[i].min;
		b.max = b.n ? fmax(b.max, bin[i].max) : bin[i].max;
		b.sum += bin[i].sum;
		b.n += bin[i].n;
	}
	return b;
}

/* A row of strips, @group of them to a line. */
struct strips {
	const struct thin *t;
	const struct thin_bin *bin;
	size_t group;
	double unit_s;
};

/* A line each, by @put; a blank line where there is nothing. */
static void write_strips(FILE *f, const struct strips *s,
			 void (*put)(FILE *f, double time,
				     const struct thin_bin *b))
{
	const size_t nbins = s->t->nbins;
	bool open = false;

	for (size_t i = 0; i < nbins; i += s->group) {
		const size_t n = s->group < nbins - i ? s->group : nbins - i;
		const struct thin_bin b = join(s->bin + i, n);

		if (b.n)
			put(f, bin_time(s->t, i + n / 2) / s->unit_s, &b);
		else if (open)
			fputc('\n', f);
		open = b.n > 0;
	}
}

static void put_band(FILE *f, double time, const struct thin_bin *b)
{
	fprintf(f, "%.9g %.9g %.9g\n", time, b->min, b->max);
}

static void put_mean(FILE *f, double time, const struct thin_bin *b)
{
	fprintf(f, "%.9g %.9g\n", time, b->sum / (double)b->n);
}

/* A quantity of the cut: its extremes strip by strip, its mean smoother. */
static void write_quantity(FILE *f, const struct thin *t, const char *name,
			   const struct thin_bin *bin, double unit_s)
{
	struct strips s = { t, bin, 1, unit_s };

	fprintf(f, "$%s << EOD\n", name);
	write_strips(f, &s, put_band);
	fprintf(f, "EOD\n$%smean << EOD\n", name);
	s.group = group_of(t);
	write_strips(f, &s, put_mean);
	fputs("EOD\n", f);
}

/*
 * A period's feed is whole pulses or none, so extremes fill the panel whatever
 * the gap does: the mean of each strip, and that from jump to jump.
 */
static void write_feed(FILE *f, const struct thin *t, double unit_s)
{
	struct strips s = { t, t->feed, 1, unit_s };

	fputs("$feed << EOD\n", f);
	write_strips(f, &s, put_mean);
	fputs("EOD\n$feedmean << EOD\n", f);
	s.group = group_of(t);
	write_strips(f, &s, put_mean);
	fputs("EOD\n", f);
}

static void write_far(FILE *f, const struct thin *t, double unit_s)
{
	fputs("$far << EOD\n", f);
	for (size_t i = 0; i < t->nbins; i++)
		if (t->place[i].n)
			fprintf(f, "%.9g %.9g\n", bin_time(t, i) / unit_s,
				t->far_mm[i]);
	fputs("EOD\n", f);
}

static void write_events(FILE *f, const struct thin *t, const char *name,
			 const struct thin_events *e, double unit_s)
{
	double space = (t->survey.t_max - t->survey.t_min) * MARK_SPACE;
	double last = -1e300;

	fprintf(f, "$%s << EOD\n", name);
	for (size_t i = 0; i < e->n; i++) {
		if (e->at[i].t_s - last < space)
			continue;
		last = e->at[i].t_s;
		fprintf(f, "%.9g %.9g\n", last / unit_s, e->at[i].s_mm);
	}
	fputs("EOD\n", f);
}

static void write_share(FILE *f, const struct thin *t, size_t c, double time)
{
	unsigned long all = 0, sum = 0;

	for (int i = 0; i < CSV_NSTATES; i++)
		all += t->share[c][i];
	if (all == 0)
		return;
	fprintf(f, "%.9g 0", time);
	for (int i = 0; i < CSV_NSTATES; i++) {
		sum += t->share[c][i];
		fprintf(f, " %.4f", 100 * (double)sum / (double)all);
	}
	fputc('\n', f);
}

/* Stacked: time, then the tops of all states, at each column's two edges. */
static void write_shares(FILE *f, const struct thin *t, double unit_s)
{
	const struct thin_survey *s = &t->survey;
	double width = (s->t_max - s->t_min) / THIN_COLUMNS;

	fputs("$share << EOD\n", f);
	for (size_t c = 0; c < THIN_COLUMNS; c++) {
		double from = s->t_min + (double)c * width;

		write_share(f, t, c, from / unit_s);
		write_share(f, t, c, (from + width) / unit_s);
	}
	fputs("EOD\n", f);
}

/* A strip as two points, the one nearer to where the line stands first. */
static double write_swept(FILE *f, double time_s, const struct thin_bin *b,
			  double at)
{
	bool up = at - b->min < b->max - at;
	double first = up ? b->min : b->max, last = up ? b->max : b->min;

	fprintf(f, "%.9g %.9g\n%.9g %.9g\n", time_s, first, time_s, last);
	return last;
}

/* The pieces of one state, each begun where the piece before it ended. */
static void write_zoom(FILE *f, const struct thin *t, enum csv_state state)
{
	const struct thin_survey *s = &t->survey;
	double width = (s->zoom_to_s - s->zoom_from_s) / (double)t->nzoom;
	double at = t->zoom[0].place.min, before_s = s->zoom_from_s;
	bool open = false;

	fprintf(f, "$zoom%d << EOD\n", (int)state);
	for (size_t i = 0; i < t->nzoom; i++) {
		const struct thin_zoom *z = &t->zoom[i];
		double time_s = s->zoom_from_s + ((double)i + 0.5) * width;
		bool mine = z->state == state;

		if (z->place.n == 0)
			continue;
		if (mine && !open && i)
			fprintf(f, "\n%.9g %.9g\n", before_s, at);
		if (mine)
			at = write_swept(f, time_s, &z->place, at);
		else
			at = z->place.sum / (double)z->place.n;
		open = mine;
		before_s = time_s;
	}
	fputs("EOD\n", f);
}

void data_write(FILE *f, const struct thin *t, double unit_s)
{
	fputs("$place << EOD\n", f);
	write_strips(f, &(struct strips) { t, t->place, group_of(t), unit_s },
		     put_band);
	fputs("EOD\n", f);
	write_quantity(f, t, "gap", t->gap, unit_s);
	write_feed(f, t, unit_s);
	write_far(f, t, unit_s);
	write_events(f, t, "jumps", &t->survey.jumps, unit_s);
	write_events(f, t, "retracts", &t->survey.retracts, unit_s);
	write_shares(f, t, unit_s);
	for (int i = 0; t->nzoom && i < CSV_NSTATES; i++)
		write_zoom(f, t, (enum csv_state)i);
}
