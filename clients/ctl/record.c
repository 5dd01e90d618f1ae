/* SPDX-License-Identifier: Apache-2.0 */
/*
 * record.c - writes the cycles of a running machine to a trace CSV
 *
 * It follows the trace ring in edmd's shared memory, so it runs on the
 * machine's own host.  It never slows the cycle.  If it is too slow, it loses
 * records and is told how many.
 */
#include "ctl.h"
#include "plot.h"
#include "shm.h"
#include "output.h"
#include "shm_csv.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sysexits.h>
#include <unistd.h>

#define PAUSE_US	20000		/* far less than the ring holds */
#define ALIVE_S		0.5

struct recording {
	const struct shm_status *status;
	FILE *f;
	struct plot *plot;		/* NULL: none is wanted */
	struct shm_follow trace, events;
	struct shm_snapshot about;	/* the period, and the size of a
					 * pulse */
	uint64_t first_cycle, written;
	uint32_t state;			/* of the last record */
	bool begun;			/* a record was seen */
	bool ended;			/* the job; @outcome and @end_cycle */
	int32_t outcome;
	uint64_t end_cycle;
	bool dead;			/* edmd is no longer there */
	double looked_s;
	struct line line;
};

static int refuse(const struct ctl *c, const char *what, const char *why,
		  int code)
{
	fprintf(stderr, "edmctl: %s: %s: %s\n", c->verb, what, why);
	return code;
}

int ctl_shm_open(const struct ctl *c, const struct shm_status **ret)
{
	int err = shm_status_open(ret, c->machine);

	if (err == -EPROTO)
		return refuse(c, c->machine, "its edmd is of another release; "
			      "an edmctl of the same is wanted", EX_PROTOCOL);
	if (err == -EACCES)
		return refuse(c, c->machine, "its shared memory is not yours "
			      "to read; the group edm is wanted", EX_NOPERM);
	if (err < 0 || !shm_alive(*ret))
		return refuse(c, c->machine, "no edmd runs on this host; "
			      "systemctl start edmd", EX_UNAVAILABLE);
	return 0;
}

static int open_status(const struct ctl *c, struct recording *r)
{
	int err = ctl_shm_open(c, &r->status);

	if (err)
		return err;
	if (!shm_snapshot(r->status, &r->about))
		return refuse(c, c->machine, "no whole status",
			      EX_UNAVAILABLE);

	/* Begin with the next new record. */
	r->trace.next = __atomic_load_n(&r->status->trace_next,
					__ATOMIC_ACQUIRE);
	r->events.next = __atomic_load_n(&r->status->event_next,
					 __ATOMIC_ACQUIRE);
	return 0;
}

static int open_csv(const struct ctl *c, struct recording *r)
{
	r->f = fopen(c->arg, "we");
	if (!r->f)
		return refuse(c, c->arg, strerror(errno), EX_CANTCREAT);
	shm_csv_head(r->f);
	return 0;
}

static void plot_row(struct recording *r, const struct shm_trace *t, double t_s)
{
	struct plot_row row = {
		.t_s = t_s, .s_mm = t->place_mm, .feed_mm_s = t->feed_mm_s,
		.gap_v = t->gap_v, .state = (int)t->state,
		.cut = t->state == SHM_APPROACH || t->state == SHM_ERODE,
	};

	for (int i = 0; i < SHM_NAXES; i++)
		row.axis_mm[i] = t->pos[i] * r->about.pulse_mm[i];
	plot_add(r->plot, &row);
}

static void write_row(struct recording *r, const struct shm_trace *t)
{
	double t_s = (double)(t->cycle - r->first_cycle) *
		     (double)r->about.period_ns * 1e-9;

	shm_csv_row(r->f, t, t_s, r->about.pulse_mm);
	r->written++;
	if (r->plot)
		plot_row(r, t, t_s);
}

/* Take every n-th cycle, and each cycle in which the state changes. */
static void take(const struct ctl *c, struct recording *r,
		 const struct shm_trace *t)
{
	bool changed = !r->begun || t->state != r->state;

	if (!r->begun)
		r->first_cycle = t->cycle;
	r->begun = true;
	r->state = t->state;
	if (changed || (t->cycle - r->first_cycle) % c->every == 0)
		write_row(r, t);
}

static void look_for_end(struct recording *r)
{
	struct shm_event e;

	while (!r->ended && shm_event_next(r->status, &r->events, &e)) {
		if (e.kind != SHM_EV_ENDED)
			continue;
		r->ended = true;
		r->outcome = e.code;
		r->end_cycle = e.cycle;
	}
}

static void look_for_life(struct recording *r)
{
	if (talk_now_s() - r->looked_s < ALIVE_S)
		return;
	r->looked_s = talk_now_s();
	r->dead = !shm_alive(r->status);
}

static void tell(struct recording *r)
{
	struct shm_snapshot s;
	char text[80];

	if (!r->line.tty || !shm_snapshot(r->status, &s))
		return;
	snprintf(text, sizeof(text), "%-8s %.3f mm, %llu rows, %llu lost",
		 shm_state_name(s.state), s.place_mm,
		 (unsigned long long)r->written,
		 (unsigned long long)r->trace.lost);
	line_bar(&r->line, s.length_mm > 0 ? s.far_mm / s.length_mm : 0, text);
}

/* Take what is in the ring now; if the aim is the job's end, up to there. */
static void drain(const struct ctl *c, struct recording *r)
{
	struct shm_trace t;

	while (shm_trace_next(r->status, &r->trace, &t)) {
		if (c->until_end && r->ended && t.cycle > r->end_cycle)
			return;
		take(c, r, &t);
	}
}

static void follow(const struct ctl *c, struct recording *r)
{
	line_init(&r->line);
	do {
		look_for_end(r);
		drain(c, r);
		look_for_life(r);
		tell(r);
		if (r->dead || ferror(r->f) || (c->until_end && r->ended))
			break;
		usleep(PAUSE_US);
	} while (!talk_interrupted());
	line_end(&r->line);
}

static int close_csv(const struct ctl *c, struct recording *r)
{
	const int err = output_close(r->f);

	return err ? refuse(c, c->arg, strerror(-err), EX_IOERR) : 0;
}

static const char *why_ended(const struct ctl *c, const struct recording *r)
{
	if (r->dead)
		return "edmd is gone";
	if (!c->until_end || !r->ended)
		return "interrupted";
	return r->outcome == SHM_OUTCOME_DONE ? "the job is done" :
	       r->outcome == SHM_OUTCOME_FAULT ? "the job faulted" :
	       "the job was stopped";
}

static void report(const struct ctl *c, const struct recording *r)
{
	if (c->json)
		printf("{\"rows\": %llu, \"lost\": %llu, \"ended\": \"%s\"}\n",
		       (unsigned long long)r->written,
		       (unsigned long long)r->trace.lost, why_ended(c, r));
	else
		printf("%s: %llu rows, %llu cycles lost; %s\n", c->arg,
		       (unsigned long long)r->written,
		       (unsigned long long)r->trace.lost, why_ended(c, r));
	fflush(stdout);
}

static const char *state_name(int state)
{
	return state <= SHM_PROBE ? shm_state_name((uint32_t)state) : NULL;
}

/* If nothing was recorded, no picture is drawn. */
static int draw(struct recording *r)
{
	struct plot *p = r->plot;

	r->plot = NULL;
	if (r->written == 0) {
		free(p);
		return 0;
	}
	return plot_finish(p) < 0 ? EX_CANTCREAT : 0;
}

static int record(const struct ctl *c, struct recording *r)
{
	const char *folder = c->arg ? strrchr(c->arg, '/') : NULL;
	const struct plot_options o = {
		.program = "edmctl", .output = c->plot,
		.title = folder ? folder + 1 : c->arg,
		.state_name = state_name,
	};
	int err = open_csv(c, r);

	if (err)
		return err;
	r->plot = c->plot ? plot_begin(&o) : NULL;
	if (c->plot && !r->plot)
		return refuse(c, c->plot, "no memory", EX_OSERR);
	follow(c, r);
	err = close_csv(c, r);
	if (err)
		return err;
	report(c, r);
	err = draw(r);
	if (err == 0 && r->dead)
		return EX_UNAVAILABLE;
	return err ? err : r->ended && r->outcome != SHM_OUTCOME_DONE;
}

int ctl_record(struct ctl *c)
{
	struct recording r = { 0 };
	int err;

	if (c->every == 0)
		c->every = 1;
	if (c->plot && plot_check("edmctl", c->plot) < 0)
		return EX_USAGE;
	err = open_status(c, &r);
	if (err == 0)
		err = record(c, &r);
	free(r.plot);
	shm_close(r.status, sizeof(*r.status));
	return err;
}
