/* SPDX-License-Identifier: Apache-2.0 */
/* record.c - the files of lattice points and of cycles */
#include "plot.h"
#include "sim.h"
#include "path/place.h"
#include "output.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>
#include <unistd.h>

static int open_out(FILE **f, const char *path)
{
	*f = strcmp(path, "-") == 0 ? stdout : fopen(path, "w");
	if (*f)
		return 0;
	fprintf(stderr, "edmsim: %s: %s; a file that can be written\n", path,
		strerror(errno));
	return EX_CANTCREAT;
}

static char *put_int(char *p, int64_t v)
{
	char digits[24];
	int n = 0;
	uint64_t u = v < 0 ? 0 - (uint64_t)v : (uint64_t)v;

	if (v < 0)
		*p++ = '-';
	do {
		digits[n++] = (char)('0' + u % 10);
		u /= 10;
	} while (u);
	while (n)
		*p++ = digits[--n];
	return p;
}

/* cycle,line,X,...,V: printf would be slow for a million of these a second. */
static void put_point(FILE *f, const struct cycle *c)
{
	char row[160], *p = put_int(row, (int64_t)c->count);

	*p++ = ',';
	p = put_int(p, c->cursor.seg.line);
	for (int i = 0; i < INTERP_NAXES; i++) {
		*p++ = ',';
		p = put_int(p, place_axis(c, i));
	}
	*p++ = '\n';
	fwrite(row, 1, (size_t)(p - row), f);
}

static const char *state_name(int state)
{
	return state < CYCLE_NSTATES ? state_duty[state].name : NULL;
}

static struct plot *begin_plot(const struct sim_run *r)
{
	const struct cycle_gap_config *g = &r->v.cycle.config.gap;

	return plot_begin(&(struct plot_options) {
		.program = "edmsim", .output = r->o->plot, .title = r->o->job,
		.state_name = state_name, .servo_v = g->servo_v,
		.short_v = g->short_v, .open_v = g->open_v,
		.upper_by_places =
			r->config->wire.guides == INTERP_GUIDES_ABSOLUTE,
	});
}

int record_open(struct sim_run *r)
{
	const struct sim_options *o = r->o;
	const struct {
		const char *path;
		FILE **f;
	} out[] = {
		{ o->pulses, &r->pulses }, { o->trace, &r->trace },
		{ o->report, &r->report },
	};

	for (size_t i = 0; i < sizeof(out) / sizeof(out[0]); i++) {
		const int err = out[i].path ? open_out(out[i].f, out[i].path) :
					      0;

		if (err)
			return err;
	}
	if (o->plot && !(r->plot = begin_plot(r)))
		return EX_OSERR;
	if (r->pulses) {
		fprintf(r->pulses, "cycle,line,X,Y,Z,A,B,C,U,V\n");
		put_point(r->pulses, &r->v.cycle);
	}
	if (r->trace)
		fprintf(r->trace, "t_s,line,s_mm,feed_mm_s,gap_v,state,"
			"X,Y,Z,A,B,C,U,V,open,spark,arc,short,debris,"
			"X_sent,Y_sent,Z_sent,A_sent,B_sent,C_sent,U_sent,"
			"V_sent,X_is,Y_is,Z_is,A_is,B_is,C_is,U_is,V_is\n");
	return 0;
}

void record_point(void *arg, const struct cycle *c)
{
	struct sim_run *r = arg;
	struct sim_result *w = &r->result;

	w->points++;
	/* A change of axis: nothing that moved goes on moving. */
	w->switches += w->last_moved && !(place_moved(c) & w->last_moved);
	w->last_moved = place_moved(c);
	if (r->deviation && !escape_is_out(&c->escape)) {
		const double d = interp_cursor_deviation_mm(&c->cursor,
							    &r->from);

		w->deviation_mm_sum += d;
		if (d > w->deviation_mm_max)
			w->deviation_mm_max = d;
	}
	if (r->pulses)
		put_point(r->pulses, c);
}

static double time_s(const struct cycle *c)
{
	return (double)c->count * (double)c->config.period_ns * 1e-9;
}

/* How the simulated gap was; nothing if there is no gap. */
static void put_gap(const struct sim_run *r)
{
	const struct io_shares *s = &r->v.in.shares;
	struct io_sim_result g;

	if (r->v.in.shares_valid)
		fprintf(r->trace, ",%.4f,%.4f,%.4f,%.4f", (double)s->open,
			(double)s->spark, (double)s->arc, (double)s->shorted);
	else
		fputs(",,,,", r->trace);
	if (r->v.cycle.config.dry_run) {
		fputc(',', r->trace);
		return;
	}
	io_sim_result(&r->v.io, &g);
	fprintf(r->trace, ",%.4f", g.debris);
}

/* In a dry run, what is walked at a feed counts as cut. */
static bool cuts(const struct cycle *c)
{
	return c->state == STATE_APPROACH || c->state == STATE_ERODE ||
	       (c->config.dry_run && c->state == STATE_TRAVEL &&
		!(c->cursor.seg.flags & INTERP_SEG_RAPID));
}

static void plot_cycle(const struct sim_run *r)
{
	const struct cycle *c = &r->v.cycle;
	const double *pulse = c->cursor.p.head->pulse_mm;
	struct plot_row row = {
		.t_s = time_s(c), .s_mm = place_mm(c),
		.feed_mm_s = c->feed_mm_s,
		.gap_v = c->config.dry_run ? NAN : c->gap_v,
		.state = (int)c->state, .cut = cuts(c),
	};

	for (int i = 0; i < INTERP_NAXES; i++)
		row.axis_mm[i] = place_axis(c, i) * pulse[i];
	plot_add(r->plot, &row);
}

static void trace_cycle(const struct sim_run *r)
{
	const struct cycle *c = &r->v.cycle;
	const double *pulse = c->cursor.p.head->pulse_mm;

	fprintf(r->trace, "%.6f,%u,%.6f,%.6f,%.2f,%s",
		time_s(c), c->cursor.seg.line, place_mm(c),
		c->feed_mm_s, c->gap_v, state_duty[c->state].name);
	for (int i = 0; i < INTERP_NAXES; i++)
		fprintf(r->trace, ",%.10g", place_axis(c, i) * pulse[i]);
	put_gap(r);
	for (int i = 0; i < INTERP_NAXES; i++)
		fprintf(r->trace, ",%.10g", r->v.given.target[i] * pulse[i]);
	/* As the machine measured it in this cycle, before it was sent on. */
	for (int i = 0; i < INTERP_NAXES; i++)
		fprintf(r->trace, ",%.10g", r->v.in.actual[i] * pulse[i]);
	fputc('\n', r->trace);
}

void record_cycle(struct sim_run *r)
{
	if (r->trace)
		trace_cycle(r);
	if (r->plot)
		plot_cycle(r);
}

int record_shut(FILE *f, const char *path)
{
	const bool out = f == stdout;
	const int err = f ? output_close(f) : 0;

	if (err == 0)
		return 0;
	if (!out)		/* of that standard_guard() tells */
		fprintf(stderr, "edmsim: %s: %s; it is not whole\n", path,
			strerror(-err));
	return EX_IOERR;
}

int record_close(struct sim_run *r)
{
	const int err = record_shut(r->pulses, r->o->pulses);
	const int f = record_shut(r->trace, r->o->trace ? r->o->trace :
							  "trace");

	return err ? err : f;
}
