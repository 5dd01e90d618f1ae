/* SPDX-License-Identifier: Apache-2.0 */
/* data.c - writes a thinned run as gnuplot's variables and data blocks */
#include "data.h"

#include <math.h>
#include <stdlib.h>

/* Two marks that are closer than this share of the time, or of the path, become
 * one. */
#define MARK_TIME	(1.0 / 300)
#define MARK_PATH	(1.0 / 150)
#define FEW_JUMPS	60u		/* so few that each can be seen */
#define COLUMNS		240		/* of the states' shares */

/* In single quotes gnuplot knows one escape: a doubled quote. */
static void write_text(FILE *f, const char *name, const char *s)
{
	fprintf(f, "%s = '", name);
	for (; *s; s++) {
		if (*s == '\'')
			fputc('\'', f);
		fputc((unsigned char)*s < ' ' ? ' ' : *s, f);
	}
	fputs("'\n", f);
}

static int by_value(const void *a, const void *b)
{
	const double x = *(const double *)a, y = *(const double *)b;

	return (x > y) - (x < y);
}

/* Choose the range that is shown, so that a rare spike does not flatten
 * everything else: leave out one mean in a hundred on either side, and then add
 * as much again. */
static void write_span(FILE *f, const struct thin *t, const char *name,
		       size_t member)
{
	struct thin_range all = { 0 };
	double mean[THIN_STRIPS], low = 0, high = 0;
	size_t n = 0;

	for (size_t i = 0; i < t->nstrips; i++) {
		const struct thin_range *r = (const void *)
			((const char *)&t->strip[i] + member);

		thin_range_join(&all, r);
		if (r->n)
			mean[n++] = r->sum / (double)r->n;
	}
	if (n) {
		qsort(mean, n, sizeof(mean[0]), by_value);
		low = fmax(all.min, fmin(0, 2 * mean[n / 100]));
		high = fmin(all.max, fmax(0, 2 * mean[n - 1 - n / 100]));
	}
	fprintf(f, "%s_min = %.9g\n%s_max = %.9g\n%s_low = %.9g\n"
		"%s_high = %.9g\n%s_n = %lu\n", name, all.min, name, all.max,
		name, low, name, high, name, all.n);
}

static bool has_pieces(const struct thin *t, bool cut)
{
	for (size_t i = 1; i < t->npath; i++)
		if (t->path[i].cut == cut)
			return true;
	return false;
}

static void write_states(FILE *f, const struct data *d)
{
	const struct thin_zoom *z = &d->t->zoom;
	unsigned long zoomed = 0;
	int n = 0;

	while (n < PLOT_NSTATES && d->o->state_name(n))
		n++;
	for (size_t i = 0; i < z->n; i++)
		if (z->at[i].place.n)
			zoomed |= 1ul << z->at[i].state;
	fprintf(f, "nstates = %d\narray in_state[%d]\narray in_zoom[%d]\n"
		"states = ''\n", n, n, n);
	for (int i = 0; i < n; i++)
		fprintf(f, "states = states.'%s '\nin_state[%d] = %lu\n"
			"in_zoom[%d] = %lu\n", d->o->state_name(i), i + 1,
			d->t->in_state[i], i + 1, zoomed >> i & 1);
}

static void write_variables(FILE *f, const struct data *d)
{
	const struct thin *t = d->t;

	write_text(f, "title_text", d->o->title);
	fprintf(f, "rows = %lu.0\nt_min = %.9g\nt_max = %.9g\ns_min = %.9g\n"
		"s_max = %.9g\ncuts = %d\ncut_min = %.9g\njumps = %lu\n"
		"retracts = %lu\nfew = %d\n", t->rows, t->time.min,
		t->time.max, t->place.min, t->place.max, t->cuts,
		t->cuts ? t->cut_min : t->place.min, t->jumps.seen,
		t->retracts.seen, t->jumps.seen <= FEW_JUMPS);
	fprintf(f, "rides = %d\n", !d->o->upper_by_places);
	fprintf(f, "has_cut = %d\nhas_positioned = %d\nservo_v = %.9g\n"
		"short_v = %.9g\nopen_v = %.9g\n", has_pieces(t, true),
		has_pieces(t, false), d->o->servo_v, d->o->short_v,
		d->o->open_v);
	fprintf(f, "strip_s = %.9g\nzoom_n = %zu\nzoom_jumps = %lu\n"
		"zoom_from = %.9g\nzoom_to = %.9g\n", t->width_s, t->zoom.n,
		t->zoom.jumps, t->zoom.from_s,
		t->zoom.from_s + (double)t->zoom.n * t->zoom.width_s);
	fputs("array axis_min[8]\narray axis_max[8]\n", f);
	for (int i = 0; i < PLOT_NAXES; i++)
		fprintf(f, "axis_min[%d] = %.9g\naxis_max[%d] = %.9g\n", i + 1,
			t->axis[i].min, i + 1, t->axis[i].max);
	write_states(f, d);
	write_span(f, t, "gap", offsetof(struct thin_strip, gap));
	write_span(f, t, "feed", offsetof(struct thin_strip, feed));
}

static double strip_time(const struct thin *t, double i)
{
	return fmin(t->time.min + (i + 0.5) * t->width_s, t->time.max);
}

/*
 * How many strips are averaged for a smooth curve.  Where there are many jumps,
 * it is a little more than the distance between two jumps; otherwise strips
 * with and without a jump would alternate.
 */
static size_t group_of(const struct thin *t)
{
	if (t->jumps.seen <= FEW_JUMPS)
		return 1;
	return 2 + (size_t)(1.2 * (double)t->nstrips / (double)t->jumps.seen);
}

/* Time, smallest, largest and mean value of a quantity; a blank line where
 * there is nothing. */
static void write_strips(FILE *f, const struct thin *t, size_t member,
			 size_t group)
{
	bool open = false;

	for (size_t i = 0; i < t->nstrips; i += group) {
		struct thin_range r = { 0 };

		for (size_t j = i; j < i + group && j < t->nstrips; j++)
			thin_range_join(&r, (const void *)
					((const char *)&t->strip[j] + member));
		if (r.n)
			fprintf(f, "%.9g %.9g %.9g %.9g\n", strip_time(t,
				(double)i + ((double)group - 1) / 2), r.min,
				r.max, r.sum / (double)r.n);
		else if (open)
			fputc('\n', f);
		open = r.n > 0;
	}
}

static void write_quantity(FILE *f, const struct thin *t, const char *name,
			   size_t member)
{
	fprintf(f, "$%s << EOD\n", name);
	write_strips(f, t, member, 1);
	fprintf(f, "EOD\n$%smean << EOD\n", name);
	write_strips(f, t, member, group_of(t));
	fputs("EOD\n", f);
}

/* Time, farthest place, and the mean place of each axis. */
static void write_axes(FILE *f, const struct thin *t)
{
	fputs("$axes << EOD\n", f);
	for (size_t i = 0; i < t->nstrips; i++) {
		const struct thin_strip *s = &t->strip[i];

		if (s->place.n == 0)
			continue;
		fprintf(f, "%.9g %.9g", strip_time(t, (double)i), s->far_mm);
		for (int a = 0; a < PLOT_NAXES; a++)
			fprintf(f, " %.7g", s->axis[a].sum /
				(double)s->axis[a].n);
		fputc('\n', f);
	}
	fputs("EOD\n", f);
}

static void write_place(FILE *f, const double axis_mm[PLOT_NAXES])
{
	for (int i = 0; i < PLOT_NAXES; i++)
		fprintf(f, "%.7g ", axis_mm[i]);
	fputc('\n', f);
}

/* Events over time, and on the path. */
static void write_events(FILE *f, const struct thin *t, const char *name,
			 const struct thin_events *e)
{
	const double time_s = (t->time.max - t->time.min) * MARK_TIME;
	const double way_mm = (t->place.max - t->place.min) * MARK_PATH;
	const struct thin_event *last = NULL;

	fprintf(f, "$%s << EOD\n", name);
	for (size_t i = 0; i < e->n; i++) {
		if (last && e->at[i].t_s - last->t_s < time_s)
			continue;
		last = &e->at[i];
		fprintf(f, "%.9g %.9g\n", last->t_s, last->s_mm);
	}
	fprintf(f, "EOD\n$%sat << EOD\n", name);
	last = NULL;
	for (size_t i = 0; i < e->n; i++) {
		if (last && fabs(e->at[i].s_mm - last->s_mm) < way_mm)
			continue;
		last = &e->at[i];
		write_place(f, last->axis_mm);
	}
	fputs("EOD\n", f);
}

/* Write the pieces of one kind; each begins where the previous piece ended. */
static void write_pieces(FILE *f, const struct thin *t, bool cut)
{
	bool open = false;

	fprintf(f, "$path%d << EOD\n", cut);
	for (size_t i = 1; i < t->npath; i++) {
		if (t->path[i].cut == cut) {
			if (!open)
				write_place(f, t->path[i - 1].axis_mm);
			write_place(f, t->path[i].axis_mm);
		} else if (open) {
			fputs("\n\n", f);
		}
		open = t->path[i].cut == cut;
	}
	fputs("EOD\n", f);
}

static void write_ends(FILE *f, const struct thin *t)
{
	fputs("$begin << EOD\n", f);
	write_place(f, t->path[0].axis_mm);
	fputs("EOD\n$end << EOD\n", f);
	write_place(f, t->path[t->npath - 1].axis_mm);
	fputs("EOD\n", f);
}

/* Stacked: the time, then the upper edges of all states, at both sides of a
 * column. */
static void write_column(FILE *f, const struct data *d, size_t from, size_t to)
{
	double all = 0, top[PLOT_NSTATES] = { 0 };

	for (int s = 0; s < PLOT_NSTATES; s++) {
		for (size_t i = from; i < to; i++)
			all += (double)d->t->strip[i].share[s];
		top[s] = all;
	}
	for (int edge = 0; edge < 2 && all > 0; edge++) {
		fprintf(f, "%.9g 0", d->t->time.min + d->t->width_s *
			(double)(edge ? to : from));
		for (int s = 0; s < PLOT_NSTATES; s++)
			fprintf(f, " %.4f", 100 * top[s] / all);
		fputc('\n', f);
	}
}

static void write_shares(FILE *f, const struct data *d)
{
	const size_t n = d->t->nstrips, wide = n / COLUMNS + 1;

	fputs("$share << EOD\n", f);
	for (size_t i = 0; i < n; i += wide)
		write_column(f, d, i, i + wide < n ? i + wide : n);
	fputs("EOD\n", f);
}

/*
 * A strip is two points; the one nearer to the present end of the line comes
 * first.  The third column is the state; gnuplot separates the lines by it.
 */
static void write_zoom(FILE *f, const struct thin_zoom *z)
{
	double at = z->n ? z->at[0].place.min : 0;

	fputs("$zoom << EOD\n", f);
	for (size_t i = 0; i < z->n; i++) {
		const struct thin_range *r = &z->at[i].place;
		const double t_s = z->from_s + ((double)i + 0.5) * z->width_s;
		const bool up = at - r->min < r->max - at;

		if (r->n == 0)
			continue;
		at = up ? r->max : r->min;
		fprintf(f, "%.9g %.9g %d\n%.9g %.9g %d\n", t_s,
			up ? r->min : r->max, z->at[i].state, t_s, at,
			z->at[i].state);
	}
	fputs("EOD\n", f);
}

void data_write(FILE *f, const void *arg)
{
	const struct data *d = arg;
	const struct thin *t = d->t;

	write_variables(f, d);
	write_quantity(f, t, "place", offsetof(struct thin_strip, place));
	write_quantity(f, t, "gap", offsetof(struct thin_strip, gap));
	write_quantity(f, t, "feed", offsetof(struct thin_strip, feed));
	write_axes(f, t);
	write_events(f, t, "jump", &t->jumps);
	write_events(f, t, "retract", &t->retracts);
	write_pieces(f, t, false);
	write_pieces(f, t, true);
	write_ends(f, t);
	write_shares(f, d);
	write_zoom(f, &t->zoom);
}
